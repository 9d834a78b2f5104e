/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "study/session.h"

/* ---- print-out ---- */

/* The line a place speaks of and a caret below the column; nothing when it cannot be read again. */
static void print_source(const char *path, int number, int column) {
  struct stat s;
  FILE *f = !stat(path, &s) && S_ISREG(s.st_mode) ? fopen(path, "r") : NULL;
  char *line = NULL;
  size_t size = 0;
  bool there = f;
  for (int k = 0; k < number && there; k++) there = getline(&line, &size, f) >= 0;
  if (there) {
    line[strcspn(line, "\r\n")] = '\0';
    for (char *c = line; *c; c++)
      if ((unsigned char)*c < ' ' && *c != '\t') *c = ' '; /* nothing a terminal would obey */
    fprintf(stderr, " %s\n ", line);
    for (const char *c = line; *c && column > 1; c++) {
      if ((*c & 0xc0) != 0x80) fputc(*c == '\t' ? '\t' : ' ', stderr); /* a character begins */
      if ((c[1] & 0xc0) != 0x80) column--;
    }
    fputs("^\n", stderr);
  }
  free(line);
  if (f) fclose(f);
}

/* name: of what was checked, for an error that knows no place of its own */
static void print_finding(const char *name, const char *kind, const vs_error *e) {
  char file[sizeof e->text];
  snprintf(file, sizeof file, "%.*s", e->file_size, e->text);
  if (e->place_size)
    fprintf(stderr, "%.*s", e->place_size, e->text);
  else
    fprintf(stderr, "%s: ", name);
  fprintf(stderr, "%s%s\n", kind, e->text + e->place_size);
  if (e->line) print_source(file, e->line, e->column);
}

static void add_json(const char *name, const vs_error *e, vs_text *json) {
  char file[sizeof e->text], number[2][16] = {"null", "null"};
  snprintf(file, sizeof file, "%.*s", e->file_size, e->text);
  if (e->line) {
    snprintf(number[0], sizeof number[0], "%d", e->line);
    snprintf(number[1], sizeof number[1], "%d", e->column);
  }
  vs_text_add(json, "%s\n  {\"file\": ", json->length > 1 ? "," : "");
  vs_text_json(json, e->place_size ? file : name);
  vs_text_add(json, ", \"line\": %s, \"column\": %s, \"message\": ", number[0], number[1]);
  vs_text_json(json, e->text + e->place_size);
  vs_text_add(json, "}");
}

/* ---- what is checked ---- */

typedef struct report {
  const vs_check_options *options;
  vs_text good; /* what it is, when nothing was found */
  vs_error warnings[VS_WARNINGS + 3];
  size_t n_warnings;
} report;

static vs_error *warning(report *r) {
  return &r->warnings[r->n_warnings++];
}

static void warn_of_deck(report *r, const vs_deck *deck) {
  const vs_where file = {.file = deck->files[0]};
  const char *mains = vs_scene_without_mains(deck);
  bool fires = false;
  for (size_t k = 0; k < deck->n_probes; k++)
    fires = fires || !strcmp(deck->probes[k].name, "i_thyristor");
  if (!fires)
    vs_fail_at(warning(r), file,
               "no probe i_thyristor, so that firing and extinction will not be found");
  if (mains) vs_fail_at(warning(r), file, "%s", mains);
}

/* Where the mains drive less than this no junction of silicon conducts. */
static const double FAINT_V = 0.7;

/* When a pulse of that gate first meets mains that can fire something, or 0; INFINITY: never.
 * Which way is forward is known of the thyristor that is fired without a delay. */
static double first_chance(const vs_scene *s, double shift_rad) {
  enum { POINTS = 32 }; /* of a cycle's sine: its top is missed by 1 % at most */
  enum { MOST = 100000 }; /* pulses looked at, some tenths of a second; behind them nothing is said */
  const vs_timeline *t = &s->setup.timeline;
  double until_s = s->setup.run.until_s, from_s, to_s;
  double at_s = 0;
  for (int n = 0; n < MOST; n++, at_s = fmax(to_s, nextafter(at_s, INFINITY))) {
    if (!vs_gate_stretch(t, shift_rad, at_s, until_s, &from_s, &to_s)) return INFINITY;
    double end_s = fmin(fmin(to_s, until_s), from_s + t->period_s), u_v = 0;
    for (int k = 0; k <= POINTS; k++) {
      double now_v = vs_mains(t, from_s + (end_s - from_s) * k / POINTS);
      u_v = fmax(u_v, shift_rad != 0 ? fabs(now_v) : now_v);
    }
    if (u_v > (s->frame.deck ? FAINT_V : 0)) return from_s;
  }
  return 0;
}

/* The key of section firing that comes first in the scene's text, or the scene. */
static vs_where where_of_firing(const vs_scene *s) {
  const vs_node *firing = vs_node_child(s->tree.root, "firing");
  return firing && firing->child ? firing->child->key_where : (vs_where){0};
}

/* What a run would say once it is over. */
static void warn_of_firing(report *r, const vs_scene *s) {
  const vs_deck *deck = s->frame.deck;
  double first_s = deck ? INFINITY : first_chance(s, 0);
  bool asked = !deck;
  for (size_t k = 0; deck && k < deck->n_ports; k++) {
    const vs_signal *signal = &deck->ports[k].signal;
    if (signal->drive != VS_DRIVE_GATE && signal->drive != VS_DRIVE_BURST) continue;
    asked = true;
    first_s = fmin(first_s, first_chance(s, signal->shift_rad));
  }
  if (asked && isinf(first_s))
    vs_fail_at(warning(r), where_of_firing(s),
               "nothing can fire: no gate pulse meets forward mains voltage before run.until = %.9g "
               "s; look at firing.first_cycle, firing.angle and firing.pulse_width",
               s->setup.run.until_s);
}

static vs_status check_scene(report *r, vs_error *err) {
  const vs_check_options *o = r->options;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_scene_read(o->name, o->sets, o->n_sets, NULL, scene, err);
  if (!status && !vs_found(err)) status = vs_session_try(scene->tier, &scene->setup, err);
  if (!status && !vs_found(err)) {
    vs_text_add(&r->good, "a good scene: tier %s (%s)", scene->tier->name, scene->why);
    for (size_t w = 0; w < scene->n_warnings; w++) *warning(r) = scene->warnings[w];
    if (scene->frame.deck) warn_of_deck(r, scene->frame.deck);
    warn_of_firing(r, scene);
  }
  vs_scene_free(scene);
  free(scene);
  return status;
}

static void describe_deck(const vs_deck *deck, vs_text *good) {
  const struct {
    const char *what;
    size_t count;
  } COUNTS[] = {{"parameter", deck->section.count - 1 - deck->n_parts},
                {"part", deck->n_parts},
                {"port", deck->n_ports},
                {"probe", deck->n_probes},
                {"loss", deck->losses.count},
                {"store", deck->stores.count},
                {"rating", deck->n_ratings},
                {"device", deck->n_devices}};
  vs_text_add(good, "a good deck: %s%sEVA between %s and %s", deck->title, *deck->title ? "; " : "",
              deck->eva_plus, deck->eva_minus);
  for (size_t k = 0; k < sizeof COUNTS / sizeof *COUNTS; k++)
    if (COUNTS[k].count)
      vs_text_add(good, ", %zu %s%s", COUNTS[k].count, COUNTS[k].what,
                  COUNTS[k].count == 1              ? ""
                  : !strcmp(COUNTS[k].what, "loss") ? "es"
                                                    : "s");
}

static void warn_of_limits(report *r, const vs_deck *deck) {
  char text[VS_DECK_TEXT + VS_NAME_SIZE];
  size_t said = 0;
  for (size_t k = 0; k < deck->n_limits && said < VS_IDLE_LIMITS; k++)
    if (vs_limit_is_idle(deck, k, text, sizeof text)) {
      vs_fail_at(warning(r), deck->limits[k].where, "%s", text);
      said++;
    }
}

/* In the scene that names this deck and nothing else. */
static vs_status check_deck(report *r, vs_error *err) {
  const vs_check_options *o = r->options;
  if (o->n_sets)
    return vs_fail(err, VS_INPUT, "--set %s: a deck has no keys to set; check a scene with it",
                   o->sets[0]);
  vs_node deck = {.kind = VS_NODE_TEXT,
                  .key = (char *)(size_t)vs_deck_key.key,
                  .text = (char *)(size_t)o->name};
  vs_node circuit = {.kind = VS_NODE_MAP, .key = (char *)(size_t) "circuit", .child = &deck};
  const vs_node scene = {.kind = VS_NODE_MAP, .child = &circuit};
  vs_setup *setup = vs_alloc(1, sizeof *setup);
  char text[VS_DECK_TEXT + VS_NAME_SIZE];
  vs_status status = vs_setup_build(&scene, setup, err);
  if (!status && !vs_found(err)) status = vs_session_try(&vs_tier_circuit, setup, err);
  if (!status && !vs_found(err)) {
    describe_deck(&setup->deck, &r->good);
    for (size_t p = 0; p < setup->deck.n_parts; p++)
      if (vs_part_below_mains(&setup->deck, p, setup->timeline.supply.voltage_v, text, sizeof text))
        vs_fail_at(warning(r), (vs_where){.file = setup->deck.files[0]}, "%s", text);
    warn_of_limits(r, &setup->deck);
    warn_of_deck(r, &setup->deck);
  }
  vs_setup_free(setup);
  free(setup);
  return status;
}

/* A part's file: its own lines. What a deck asks of it the deck's check says. */
static vs_status check_part(report *r, vs_error *err) {
  vs_deck *part = vs_alloc(1, sizeof *part);
  vs_status status = vs_deck_read_part(r->options->name, part, err);
  if (!status && !vs_found(err) && !part->n_part_files)
    status = vs_fail_at(err, (vs_where){.file = r->options->name},
                        "has no line '*$ part KIND \"TEXT\"'");
  if (!status && !vs_found(err))
    vs_text_add(&r->good, "a good part: %s, %s; %zu limits, %zu parameters",
                part->part_files[0].kind, part->part_files[0].text, part->n_limits,
                part->section.count - 1);
  if (!status && !vs_found(err)) warn_of_limits(r, part);
  vs_deck_free(part);
  free(part);
  return status;
}

static bool ends_in(const char *name, const char *ending) {
  size_t n = strlen(name), m = strlen(ending);
  return n > m && !strcmp(name + n - m, ending);
}

/* By its ending; a name without one is looked for among the scenes, then among the decks. */
static vs_status check(report *r, vs_error *err) {
  const char *name = r->options->name;
  char path[VS_PATH_SIZE];
  vs_error none = {0};
  if (r->options->other) return r->options->other(r->options, &r->good, err);
  if (ends_in(name, ".cir")) return check_deck(r, err);
  if (ends_in(name, ".inc")) return check_part(r, err);
  if (ends_in(name, ".yaml") || ends_in(name, ".yml") ||
      !vs_find(&vs_scene_shelf, name, (vs_where){0}, path, &none))
    return check_scene(r, err);
  if (!vs_find(&vs_deck_shelf, name, (vs_where){0}, path, &none)) return check_deck(r, err);
  vs_status status = vs_carry_on(err, vs_find(&vs_scene_shelf, name, (vs_where){0}, path, err));
  return status ? status : vs_find(&vs_deck_shelf, name, (vs_where){0}, path, err);
}

vs_status vs_check_command(const vs_check_options *o, vs_error *err) {
  vs_findings *all = vs_alloc(1, sizeof *all);
  report r = {.options = o};
  vs_error own = {.findings = all};
  vs_status status = vs_carry_on(&own, check(&r, &own));
  vs_text json = {0};
  vs_text_add(&json, "[");
  for (size_t k = 0; k < all->count; k++)
    if (o->json)
      add_json(o->name, &all->item[k], &json);
    else
      print_finding(o->name, "", &all->item[k]);
  for (size_t k = 0; k < r.n_warnings && !o->quiet; k++)
    print_finding(o->name, "warning: ", &r.warnings[k]);
  if (o->json)
    printf("%s%s]\n", json.text, all->count ? "\n" : "");
  else if (!status && !all->count && !o->quiet)
    printf("%s: %s\n", o->name, r.good.text);
  if (status == VS_INPUT) vs_fail(err, status, "%s: and more than these", o->name); /* no room */
  if (status && status != VS_INPUT) vs_fail(err, status, "%s", own.text);
  if (!status && all->count) status = VS_INPUT;
  vs_text_free(&json);
  vs_text_free(&r.good);
  free(all);
  return status;
}
