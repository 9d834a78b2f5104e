/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `cure`: finds single changes of a part after which the verdict on a scene is held. A
 * change gives a resistor or capacitor that the deck declares as a device another E value, or
 * replaces a part that the scene chooses by another one of its kind; a place whose kind the deck
 * leaves open takes any part that limits a voltage, a suppressor. Of each value the next one up and
 * the next one down are run first. Where one of them makes the verdict better, the values behind it
 * are tried, too. A change that seems to hold is proved by a run with the errors of its margins. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/file.h"
#include "base/json.h"
#include "base/units.h"
#include "commands.h"
#include "netlist/cards.h"
#include "netlist/catalogue.h"
#include "netlist/netlist.h"
#include "options.h"
#include "orbit/steady.h"
#include "run/version.h"
#include "study/price_list.h"

/* A value goes at most a decade of E12 to either side. Of the parts that come with the program
 * BEYOND are tried whose limit is next above the stress that breaks it, and NEXT of the next larger
 * and the next smaller ones. ROOM: bytes that a warning of a part may have. */
enum { DECADE = 12, BEYOND = 4, NEXT = 2, MOST_SHIPPED = 512, DIGITS = 9, ROOM = 512 };

/* A part, with what its file says of it. */
typedef struct known_part {
  char name[VS_DECK_NAME];
  size_t row;    /* of the list of prices; SIZE_MAX: none */
  vs_deck *deck; /* owned; NULL: its file is read by the run that tries it */
} known_part;

/* One change, and what came of it. */
typedef struct change {
  char what[VS_DECK_NAME], from[VS_DECK_NAME], to[VS_DECK_NAME]; /* "c1", "47", "68 nF" */
  char set[4 * VS_DECK_NAME];                                    /* "circuit.c1=68 nF" */
  size_t field;                                                  /* of a value; 0: it is a part */
  int steps;        /* values away from the scene's, up or down */
  double price;     /* more than before, or its own where that is not known; NaN: nothing says it */
  bool is_whole;    /* it is the price itself */
  char failed[256]; /* why there is no verdict on it; empty: there is one */
  double shortfall; /* sum of lack_of() over its lines; 0: all are held */
  double margin, error;        /* of the weakest line */
  char line[VS_JUDGED_NAME];   /* that line */
  char breaks[VS_JUDGED_NAME]; /* the worst line that is not held; empty: none */
  bool holds;                  /* proved */
} change;

typedef struct cure {
  const vs_run_options *o;
  const char *catalogue, *series;
  vs_scene *scene;
  vs_result *nominal;
  double shortfall; /* of the scene as it is */
  vs_price_list list;
  size_t price;     /* its column; SIZE_MAX: there is none */
  known_part *part; /* owned */
  size_t n_parts;
  change *item; /* owned */
  size_t count;
  long runs;
} cure;

/* ---- a run ---- */

/* How far a line is from being held, above 0 where vs_verdict_breach counts it: how far its margin
 * is below 0; 1 where it has no margin; little where only the margin's error is too large. */
static double lack_of(const vs_judgement *j) {
  const vs_finding word = vs_verdict_word(j);
  if (word == VS_WAIVED) return 0;
  if (j->margin < 0) return -j->margin;
  if (word != VS_UNDECIDED) return 0;
  return isnan(j->margin) ? 1 : 1e-3;
}

static double shortfall_of(const vs_verdict *v) {
  double sum = 0;
  for (size_t k = 0; k < v->count; k++) sum += lack_of(&v->item[k]);
  return sum;
}

/* True where a limit was judged that the changed deck's part does not state: the change would only
 * hide the line. A part of another kind has limits of its own, and states some. */
static bool hides_a_line(const cure *c, const vs_scene *changed, char *name) {
  const vs_verdict *v = &c->nominal->verdict;
  const vs_deck *own = &c->scene->setup.deck, *deck = &changed->setup.deck;
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    if (!j->device || !j->limit || vs_verdict_is_happening(j)) continue;
    const size_t d = (size_t)(j->device - own->devices);
    if (d >= deck->n_devices || !vs_devices_limit(own, j->device, j->measure)) continue;
    const vs_device *now = &deck->devices[d];
    if (now->kind == j->device->kind
            ? vs_devices_limit(deck, now, j->measure) != NULL
            : now->part >= 0 && vs_parts_is_real(deck, deck->parts[now->part].file))
      continue;
    vs_verdict_name(j, name);
    return true;
  }
  return false;
}

/* What a run warns of part number p: that it is rated for less than the mains, or that its series
 * has no such value. */
static bool is_warned_of(const vs_setup *s, size_t p, char *text, size_t size) {
  const double rms_v = s->timeline.supply.voltage_v / (s->timeline.supply.direct ? M_SQRT2 : 1);
  return vs_parts_below_mains(&s->deck, p, rms_v, text, size) ||
         vs_netlist_beyond_series(&s->deck, &s->circuit_values, p, text, size);
}

/* True where the change brings such a warning, or the one that a device does not protect another.
 * The verdict on a short run may be held with a part that does not last. */
static bool draws_a_warning(const cure *c, const vs_scene *changed, char *text, size_t size) {
  const vs_setup *before = &c->scene->setup, *now = &changed->setup;
  char was[ROOM];
  for (size_t p = 0; p < now->deck.n_parts && p < before->deck.n_parts; p++)
    if (is_warned_of(now, p, text, size) && !is_warned_of(before, p, was, sizeof was)) return true;
  for (size_t d = 0; d < now->deck.n_devices && d < before->deck.n_devices; d++)
    if (vs_devices_fails_ward(&now->deck, d, text, size) &&
        !vs_devices_fails_ward(&before->deck, d, was, sizeof was))
      return true;
  return false;
}

static void take_verdict(const vs_verdict *v, change *k) {
  const vs_judgement *breach = vs_verdict_breach(v), *weakest = v->weakest;
  k->shortfall = shortfall_of(v);
  k->margin = weakest ? weakest->margin : NAN;
  k->error = weakest ? weakest->margin_error : NAN;
  *k->line = *k->breaks = '\0';
  if (weakest) vs_verdict_name(weakest, k->line);
  if (breach) vs_verdict_name(breach, k->breaks);
}

/* Counts a run, and tells of it on a terminal. */
static void show_progress(cure *c, const char *what, const char *to) {
  c->runs++;
  if (!c->o->quiet && isatty(STDERR_FILENO))
    dprintf(STDERR_FILENO, "\rrun %ld: %s %s \033[K", c->runs, what, to);
}

/* Runs the scene with the change; proof: with the errors of its margins. A failure is noted in the
 * change. Error: VS_SIGNAL. */
static vs_status try_change(cure *c, change *k, bool proof, vs_error *err) {
  const bool always = c->scene->setup.run.verify == VS_VERIFY_ALWAYS;
  const char *errors = always ? "run.verify=always" : "run.verify=auto",
             *keys[] = {k->set, proof ? errors : "run.verify=never"};
  const vs_session session = {.verify = true, .stop = c->o->stop};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_result *result = vs_alloc(1, sizeof *result);
  vs_error why = {0};
  char text[ROOM] = "";
  vs_status status = vs_scene_with(c->scene, keys, 2, scene, &why);
  if (!status && draws_a_warning(c, scene, text, sizeof text))
    status = vs_fail(&why, VS_INPUT, "%s", text);
  if (!status && hides_a_line(c, scene, text))
    status = vs_fail(&why, VS_INPUT, "the part states no limit for %s", text);
  if (!status) show_progress(c, k->what, k->to);
  if (!status) status = vs_steady_run(&session, scene, result, &why);
  if (!status && result->second.stopped) status = vs_fail(&why, VS_SIGNAL, "stopped by a signal");
  if (!status) take_verdict(&result->verdict, k);
  k->holds = !status && proof && !*k->breaks && result->verdict.count;
  if (status)
    snprintf(k->failed, sizeof k->failed, "%.*s", (int)sizeof k->failed - 1,
             why.text + (why.place_size < 200 ? why.place_size : 0));
  vs_result_free(result);
  vs_scene_free(scene);
  free(result);
  free(scene);
  return status == VS_SIGNAL ? vs_fail(err, status, "%s", why.text) : VS_OK;
}

/* Tries the change, and proves it if it seems to hold. */
static vs_status take_change(cure *c, change *k, vs_error *err) {
  vs_status status = try_change(c, k, false, err);
  if (!status && !*k->failed && !*k->breaks) status = try_change(c, k, true, err);
  return status;
}

static change *add_change(cure *c) {
  c->item = vs_alloc_grow(c->item, c->count, sizeof *c->item);
  change *k = &c->item[c->count++];
  *k = (change){.price = NAN, .margin = NAN, .error = NAN, .shortfall = INFINITY};
  return k;
}

/* ---- prices ---- */

/* The price of a row; NaN: the list has none. */
static double price_of(const cure *c, size_t row) {
  double price;
  vs_error none = {0};
  if (row == SIZE_MAX || c->price == SIZE_MAX ||
      vs_price_list_number(&c->list, row, c->price, &price, &none))
    return NAN;
  return price;
}

/* The price of row `now` less that of row `before`. */
static void set_price(const cure *c, change *k, size_t before, size_t now) {
  const double old = price_of(c, before);
  k->price = price_of(c, now);
  k->is_whole = isnan(old);
  if (!k->is_whole) k->price -= old;
}

/* The value of a row in SI; NaN: the row stands for any value. */
static double value_of_row(const cure *c, size_t row, const char *unit) {
  char why[128];
  double si;
  if (c->list.value == SIZE_MAX) return NAN;
  const char *text = vs_price_list_cell(&c->list, row, c->list.value)->text;
  return *text && vs_units_read(text, unit, &si, why, sizeof why) ? si : NAN;
}

static bool is_value(double a, double b) {
  return fabs(a - b) <= 1e-9 * fabs(b);
}

/* The cheapest row of that kind which has that value or stands for any; SIZE_MAX: there is none. */
static size_t row_of_value(const cure *c, const char *kind, double si, const char *unit) {
  size_t best = SIZE_MAX;
  for (size_t r = 0; (r = vs_price_list_next(&c->list, kind, r)) != SIZE_MAX; r++) {
    const double value = value_of_row(c, r, unit);
    if (!isnan(value) && !is_value(value, si)) continue;
    if (best == SIZE_MAX || price_of(c, r) < price_of(c, best)) best = r;
  }
  return best;
}

/* ---- values ---- */

/* True if the deck has a device NAME, or NAME_1 and so on for each of several, that is bought by
 * its value. What is no device is no part: a stray resistance, a core's loss. */
static bool is_device(const vs_deck *deck, const char *name) {
  const size_t n = strlen(name);
  for (size_t k = 0; k < deck->n_devices; k++) {
    const vs_device *d = &deck->devices[k];
    if (d->kind && d->kind->of_series && !strncmp(d->name, name, n) &&
        (!d->name[n] || d->name[n] == '_'))
      return true;
  }
  return false;
}

/* The kind of the elements whose value is this parameter of the deck, which has a device of it;
 * NULL: there are none. An instance may take the value as r= or c=. */
static const char *kind_of_value(const vs_deck *deck, const vs_field *field) {
  static const char *const KINDS[] = {"resistor", "capacitor"};
  static const char LETTERS[] = "rc", *const UNITS[] = {"ohm", "F"}, *const NAMES[] = {"r", "c"};
  const vs_cards *c = vs_deck_cards(deck);
  char braces[VS_DECK_NAME + 2];
  snprintf(braces, sizeof braces, "{%.60s}", field->key);
  for (size_t k = 0; k < c->count && field->kind == VS_REAL && is_device(deck, field->key); k++)
    for (size_t n = 0; n < 2; n++) {
      const vs_netlist_card *card = &c->card[k];
      const vs_word value =
          card->letter == 'x' ? vs_cards_value(c, card, NAMES[n]) : vs_cards_word(c, card, 2);
      if (card->kind == VS_CARDS_ELEMENT && (card->letter == LETTERS[n] || card->letter == 'x') &&
          deck->lines[k].where.file == deck->files[0] && vs_words_is(value, braces) &&
          vs_units_same_kind(field->unit, UNITS[n]))
        return KINDS[n];
    }
  return NULL;
}

static double field_value(const cure *c, const vs_field *field) {
  return *(const double *)(const void *)((const char *)&c->scene->setup.circuit_values +
                                         field->offset);
}

/* The value next to `si`, up (way 1) or down (-1): from the list of prices if that has values of
 * the kind, else from the series. NaN: there is none. */
static double next_value(const cure *c, const char *kind, double si, const char *unit, int way) {
  const double factor = vs_units_factor(unit);
  double best = NAN;
  bool any = false;
  for (size_t r = 0; (r = vs_price_list_next(&c->list, kind, r)) != SIZE_MAX; r++) {
    const double value = value_of_row(c, r, unit);
    any = any || !isnan(value);
    if (isnan(value) || is_value(value, si) || way * (value - si) < 0) continue;
    if (isnan(best) || way * (value - best) < 0) best = value;
  }
  if (any) return best;
  return vs_price_list_neighbour(c->series, vs_text_rounded(si / factor, DIGITS), way) * factor;
}

/* Adds the value next to that of another change, or to the scene's (from: NULL), and tries it.
 * *added is NULL where there is none. */
static vs_status step_value(cure *c, size_t field, const change *from, int way, change **added,
                            vs_error *err) {
  const vs_field *f = &c->scene->setup.deck.section.fields[field];
  const char *kind = kind_of_value(&c->scene->setup.deck, f);
  const double factor = vs_units_factor(f->unit), own = field_value(c, f);
  double si = own;
  char why[128];
  *added = NULL;
  if (from) vs_units_read(from->to, f->unit, &si, why, sizeof why);
  const int steps = (from ? from->steps : 0) + way;
  si = next_value(c, kind, si, f->unit, way);
  const double value = vs_text_rounded(si / factor, DIGITS);
  if (isnan(si) || value < f->min || value > f->max) return VS_OK;
  change *k = *added = add_change(c);
  k->field = field;
  k->steps = steps;
  snprintf(k->what, sizeof k->what, "%s", f->key);
  snprintf(k->from, sizeof k->from, "%.9g", vs_text_rounded(own / factor, DIGITS));
  snprintf(k->to, sizeof k->to, "%.9g %s", value, f->unit);
  snprintf(k->set, sizeof k->set, "circuit.%s=%s", f->key, k->to);
  set_price(c, k, row_of_value(c, kind, own, f->unit), row_of_value(c, kind, si, f->unit));
  return take_change(c, k, err);
}

static bool is_better(const change *k, double shortfall) {
  return !*k->failed && k->shortfall < shortfall * (1 - 1e-6);
}

/* Goes on from the first step of a value for as long as each step makes the verdict better, up to
 * one that holds. */
static vs_status follow_value(cure *c, size_t first, vs_error *err) {
  vs_status status = VS_OK;
  size_t at = first;
  const int way = c->item[first].steps > 0 ? 1 : -1;
  double before = c->shortfall;
  for (int n = 1; n < DECADE && !status; n++) {
    change last = c->item[at], *next;
    if (last.holds || !is_better(&last, before)) break;
    before = last.shortfall;
    status = step_value(c, last.field, &last, way, &next, err);
    if (!next) break;
    at = c->count - 1;
  }
  return status;
}

/* Tries the next value up and down of each. Those that make the verdict better are followed, the
 * one that does most first. */
static vs_status try_values(cure *c, vs_error *err) {
  const vs_deck *deck = &c->scene->setup.deck;
  vs_status status = VS_OK;
  change *added;
  for (size_t f = 1; f < deck->section.count && !status; f++)
    for (int way = 1; way >= -1 && !status && kind_of_value(deck, &deck->section.fields[f]);
         way -= 2)
      status = step_value(c, f, NULL, way, &added, err);
  const size_t firsts = c->count;
  bool *done = vs_alloc(firsts, sizeof *done);
  while (!status) {
    size_t best = firsts;
    for (size_t k = 0; k < firsts; k++)
      if (!done[k] && is_better(&c->item[k], c->shortfall) &&
          (best == firsts || c->item[k].shortfall < c->item[best].shortfall))
        best = k;
    if (best == firsts) break;
    done[best] = true;
    status = follow_value(c, best, err);
  }
  free(done);
  return status;
}

/* ---- parts ---- */

static void add_shipped(void *ctx, const char *path) {
  cure *c = ctx;
  size_t length;
  const char *name = vs_catalogue_name(path, &length);
  vs_error none = {0};
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  const bool read = c->n_parts < MOST_SHIPPED && !vs_netlist_read_part(path, deck, &none) &&
                    deck->n_part_files && vs_parts_is_real(deck, deck->files[0]);
  if (!read) {
    vs_deck_free(deck);
    free(deck);
    return;
  }
  c->part = vs_alloc_grow(c->part, c->n_parts, sizeof *c->part);
  known_part *p = &c->part[c->n_parts++];
  *p = (known_part){.row = SIZE_MAX, .deck = deck};
  snprintf(p->name, sizeof p->name, "%.*s", (int)length, name);
}

/* A limit that a part's file states, in SI; NaN: it states none. */
static double stated(const vs_deck *deck, const char *file, const char *name) {
  const vs_limit *l = file ? vs_parts_find_limit(deck, file, name) : NULL;
  return l && isfinite(l->value) ? l->value : NAN;
}

static double limit_of(const known_part *p, const char *name) {
  return stated(p->deck, p->deck->files[0], name);
}

/* The kind that the deck wants there, or that of the real part which is there; empty: neither is
 * known. */
static const char *kind_at(const vs_deck *deck, size_t part) {
  const vs_part *p = &deck->parts[part];
  const bool real = p->file && vs_parts_is_real(deck, p->file) && vs_parts_file(deck, p->file);
  return *p->kind || !real ? p->kind : vs_parts_file(deck, p->file)->kind;
}

/* True for a kind that limits a voltage: parts of these kinds take one another's place. */
static bool is_suppressor(const vs_kind *kind) {
  return kind && (kind->clamps || kind->rectifies);
}

/* True if a part of that kind may stand there: the kind that is there, or where the deck names none
 * and no other part stands there, a suppressor. */
static bool may_hold(const vs_deck *deck, size_t part, const vs_kind *kind) {
  const char *own = kind_at(deck, part);
  if (!deck->parts[part].file) return false;
  if (!strcmp(own, kind->name)) return true;
  return !*deck->parts[part].kind && is_suppressor(kind) &&
         (!*own || is_suppressor(vs_kinds_find(own)));
}

/* The limit by which the part's size is told: the first one of the kind that its file states, as a
 * Zener diode's voltage. */
static const char *size_of(const vs_kind *kind, const vs_deck *deck, const char *file) {
  for (size_t k = 0; k < kind->n_limits; k++)
    if (!isnan(stated(deck, file, kind->limits[k].name))) return kind->limits[k].name;
  return NULL;
}

static bool is_tried(const cure *c, const char *what, const char *name) {
  for (size_t k = 0; k < c->count; k++)
    if (!strcmp(c->item[k].what, what) && !strcasecmp(c->item[k].to, name)) return true;
  return false;
}

static vs_status try_part(cure *c, size_t part, const char *name, size_t row, vs_error *err) {
  const vs_part *p = &c->scene->setup.deck.parts[part];
  const char *own = c->scene->setup.circuit_values.parts[part];
  if (is_tried(c, p->name, name) || !strcasecmp(own, name)) return VS_OK;
  change *k = add_change(c);
  snprintf(k->what, sizeof k->what, "%s", p->name);
  snprintf(k->from, sizeof k->from, "%.60s", own);
  snprintf(k->to, sizeof k->to, "%s", name);
  snprintf(k->set, sizeof k->set, "circuit.%s=%s", p->name, name);
  if (*c->list.path) set_price(c, k, vs_price_list_find(&c->list, own), row);
  return take_change(c, k, err);
}

/* The part whose limit is next to `from`, up (way 1) or down (-1); NULL: there is none. */
static const known_part *next_part(const cure *c, const char *kind, const char *limit, double from,
                                   int way) {
  const known_part *best = NULL;
  for (size_t k = 0; k < c->n_parts; k++) {
    const known_part *p = &c->part[k];
    const double value = limit_of(p, limit);
    if (strcmp(p->deck->part_files[0].kind, kind) || !(way * (value - from) > 0)) continue;
    if (!best || way * (value - limit_of(best, limit)) < 0) best = p;
  }
  return best;
}

/* Tries the parts whose limits are next to `from`, at most `most` of them. */
static vs_status try_next(cure *c, size_t part, const char *kind, const char *limit, double from,
                          int way, int most, vs_error *err) {
  vs_status status = VS_OK;
  const known_part *p;
  for (int n = 0; n < most && !status && (p = next_part(c, kind, limit, from, way)); n++) {
    from = limit_of(p, limit);
    status = try_part(c, part, p->name, SIZE_MAX, err);
  }
  return status;
}

/* Tries parts that come with the program: those with just enough of a limit that is broken, and the
 * next ones in size. */
static vs_status try_shipped(cure *c, size_t part, const vs_kind *kind, vs_error *err) {
  const vs_deck *deck = &c->scene->setup.deck;
  const vs_verdict *v = &c->nominal->verdict;
  const char *file = deck->parts[part].file;
  vs_status status = VS_OK;
  for (size_t k = 0; k < v->count && !status; k++) {
    const vs_judgement *j = &v->item[k];
    if (!(lack_of(j) > 0) || !j->device || j->device->part != (int)part || !j->limit) continue;
    const bool least = j->measure->held == VS_AT_LEAST;
    if (*j->limit->name && !j->ward)
      status = try_next(c, part, kind->name, j->limit->name, j->stress.value, least ? -1 : 1,
                        BEYOND, err);
  }
  const char *size = size_of(kind, deck, file);
  for (int way = 1; way >= -1 && !status && size; way -= 2)
    status = try_next(c, part, kind->name, size, stated(deck, file, size), way, NEXT, err);
  return status;
}

/* Tries parts that come with the program of a kind that is not there: the first ones that the
 * supply's peak leaves alone. */
static vs_status try_other_kind(cure *c, size_t part, const vs_kind *kind, vs_error *err) {
  const char *size = NULL;
  for (size_t k = 0; k < c->n_parts && !size; k++)
    if (!strcmp(c->part[k].deck->part_files[0].kind, kind->name))
      size = size_of(kind, c->part[k].deck, c->part[k].deck->files[0]);
  if (!size) return VS_OK;
  return try_next(c, part, kind->name, size, c->scene->setup.timeline.peak_v * (1 - 1e-9), 1,
                  BEYOND, err);
}

static vs_status try_parts(cure *c, vs_error *err) {
  const vs_deck *deck = &c->scene->setup.deck;
  const vs_price_list *list = &c->list;
  vs_status status = VS_OK;
  if (!*list->path) vs_catalogue_list(&vs_deck_parts_shelf, add_shipped, c);
  for (size_t p = 0; p < deck->n_parts; p++)
    for (const vs_kind *kind = vs_kinds_all; kind->name && !status; kind++) {
      if (!may_hold(deck, p, kind)) continue;
      const bool own = !strcmp(kind_at(deck, p), kind->name);
      if (!*list->path)
        status = own ? try_shipped(c, p, kind, err) : try_other_kind(c, p, kind, err);
      for (size_t r = 0;
           *list->path && !status && (r = vs_price_list_next(list, kind->name, r)) != SIZE_MAX; r++)
        status = try_part(c, p, vs_price_list_cell(list, r, list->part)->text, r, err);
    }
  return status;
}

/* ---- what comes out ---- */

/* Cures come first, the cheapest before all and those of unknown price last; then those of fewer
 * steps of a value, and parts behind values; then those of the larger margin. Other changes are
 * sorted by what they lack. */
static int by_worth(const void *left, const void *right) {
  const change *a = left, *b = right;
  const double pa = isnan(a->price) ? INFINITY : a->price,
               pb = isnan(b->price) ? INFINITY : b->price;
  const int sa = a->field ? abs(a->steps) : DECADE + 1, sb = b->field ? abs(b->steps) : DECADE + 1;
  if (a->holds != b->holds) return a->holds ? -1 : 1;
  if (!*a->failed != !*b->failed) return *a->failed ? 1 : -1;
  if (!a->holds && a->shortfall != b->shortfall) return a->shortfall < b->shortfall ? -1 : 1;
  if (pa != pb) return pa < pb ? -1 : 1;
  if (sa != sb) return sa - sb;
  if (a->margin > b->margin || a->margin < b->margin) return a->margin > b->margin ? -1 : 1;
  return strcmp(a->set, b->set);
}

static const char CAVEAT[] = "proved for this scene alone: other threats, tolerances, corners and "
                             "what the scene does not judge were not tried; use a study for these";

/* "price_eur" is in EUR. */
static void currency_of(const cure *c, char text[16]) {
  const char *title = c->price == SIZE_MAX ? "" : c->list.title[c->price];
  const char *behind = strchr(title, '_');
  snprintf(text, 16, "%s", behind ? behind + 1 : "");
  for (char *at = text; *at; at++)
    if (*at >= 'a' && *at <= 'z') *at = (char)(*at - 'a' + 'A');
}

static void show_change(const cure *c, const change *k) {
  char money[16];
  currency_of(c, money);
  printf("%s %s -> %s", k->what, k->from, k->to);
  if (!isnan(k->price))
    printf(k->is_whole ? " (%.4g%s%s)" : " (%+.4g%s%s)", k->price, *money ? " " : "", money);
  if (*k->failed)
    printf(": %s\n", k->failed);
  else if (k->holds)
    printf(": least margin %+.3g %% +- %.2g %% (%s), proved by a run\n", 100 * k->margin,
           100 * k->error, k->line);
  else if (*k->breaks)
    printf(": does not hold %s; least margin %+.3g %% (%s)\n", k->breaks, 100 * k->margin, k->line);
  else
    printf(": not proved\n");
}

/* How many changes of each key were tried, and what was not. */
static void show_tried(const cure *c) {
  const vs_section *keys = &c->scene->setup.deck.section;
  for (size_t f = 1; f < keys->count; f++) {
    size_t n = 0;
    for (size_t k = 0; k < c->count; k++) n += !strcmp(c->item[k].what, keys->fields[f].key);
    if (n) printf("%s: %zu tried\n", keys->fields[f].key, n);
    if (!n && keys->fields[f].kind != VS_REAL)
      printf("no other part for %s\n", keys->fields[f].key);
  }
  printf("not tried: two changes at once, other keys%s\n",
         *c->list.path ? "" : ", parts further in size (--catalogue FILE.csv tries a list)");
}

static void show_cures(const cure *c, size_t cures) {
  const vs_verdict *v = &c->nominal->verdict;
  char name[VS_JUDGED_NAME];
  size_t lines = 0;
  printf("not held:");
  for (size_t k = 0; k < v->count; k++)
    if (lack_of(&v->item[k]) > 0)
      printf("%s %s", lines++ ? "," : "", vs_verdict_name(&v->item[k], name));
  putchar('\n');
  for (size_t k = 0; k < (c->o->all ? c->count : cures); k++) show_change(c, &c->item[k]);
  printf("%zu of %zu changes cure it, in %ld run%s%s\n", cures, c->count, c->runs,
         c->runs == 1 ? "" : "s", c->o->all || cures == c->count ? "" : "; --all shows the others");
  show_tried(c);
  if (cures) puts(CAVEAT);
}

static void add_change_json(const change *k, vs_json *json) {
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_text(json, "set", k->set);
  vs_json_text(json, "what", k->what);
  vs_json_text(json, "from", k->from);
  vs_json_text(json, "to", k->to);
  vs_json_number(json, k->is_whole ? "price" : "price_more", k->price, DIGITS);
  if (*k->failed)
    vs_json_text(json, "failed", k->failed);
  else {
    vs_json_number(json, "margin_least", k->margin, DIGITS);
    vs_json_number(json, "margin_error", k->error, DIGITS);
    vs_json_text(json, "weakest", *k->line ? k->line : NULL);
    vs_json_text(json, "not_held", *k->breaks ? k->breaks : NULL);
  }
  vs_json_bool(json, "holds", k->holds);
  vs_json_end(json);
}

static void write_json(const cure *c, size_t cures, vs_text *text) {
  const vs_verdict *v = &c->nominal->verdict;
  char name[VS_JUDGED_NAME];
  vs_json json = vs_json_new(text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_version_json(&json);
  vs_json_text(&json, "scene", c->o->scene);
  vs_json_array(&json, "not_held", VS_JSON_ROW);
  for (size_t k = 0; k < v->count; k++)
    if (lack_of(&v->item[k]) > 0) vs_json_text(&json, NULL, vs_verdict_name(&v->item[k], name));
  vs_json_end(&json);
  vs_json_whole(&json, "runs", c->runs);
  for (int other = 0; other < 2; other++) {
    vs_json_array(&json, other ? "others" : "cures", VS_JSON_LINES);
    for (size_t k = other ? cures : 0; k < (other ? c->count : cures); k++)
      add_change_json(&c->item[k], &json);
    vs_json_end(&json);
  }
  vs_json_text(&json, "not_tried", CAVEAT);
  vs_json_end(&json);
  vs_text_add(text, "\n");
}

static vs_status write_cure_file(const char *folder, const char *json, vs_error *err) {
  int made;
  vs_status status = vs_file_folder_make(folder, &made, err);
  if (!status) status = vs_file_write(folder, "cure.json", json, err);
  if (status) vs_file_folder_unmake(folder, made);
  return status;
}

/* Error, VS_RATING: nothing cures it. */
static vs_status tell(cure *c, vs_error *err) {
  vs_text json = {0};
  size_t cures = 0;
  if (c->count) qsort(c->item, c->count, sizeof *c->item, by_worth);
  while (cures < c->count && c->item[cures].holds) cures++;
  write_json(c, cures, &json);
  vs_status status = c->o->folder ? write_cure_file(c->o->folder, json.text, err) : VS_OK;
  if (!status && c->o->json)
    fputs(json.text, stdout);
  else if (!status && !c->o->quiet && c->shortfall > 0)
    show_cures(c, cures);
  else if (!status && !c->o->quiet)
    puts("the verdict is held: there is nothing to cure");
  vs_text_free(&json);
  if (status || cures || !(c->shortfall > 0)) return status;
  if (!c->count || *c->item[0].failed || !(c->item[0].shortfall < c->shortfall))
    return vs_fail(err, VS_RATING, "no single change of a part helps");
  return vs_fail(err, VS_RATING,
                 "no single change of a part cures it; nearest is %s %s -> %s, "
                 "which does not hold %s",
                 c->item[0].what, c->item[0].from, c->item[0].to, c->item[0].breaks);
}

/* ---- the command ---- */

static vs_status read_catalogue(cure *c, vs_error *err) {
  c->price = SIZE_MAX;
  if (!c->catalogue) return VS_OK;
  vs_status status =
      vs_price_list_read(c->catalogue, (vs_where){.file = "--catalogue"}, &c->list, err);
  for (size_t k = c->list.columns; k-- > 0 && !status;)
    if (!strncmp(c->list.title[k], "price", 5)) c->price = k;
  return status;
}

static vs_status check_series(const cure *c, vs_error *err) {
  if (!isnan(vs_price_list_neighbour(c->series, 1, 1))) return VS_OK;
  return vs_fail(err, VS_INPUT,
                 "--series %s: there is no such series; E3, E6, E12, E24, E48, E96 or "
                 "E192 is wanted",
                 c->series);
}

static vs_status run_nominal(cure *c, vs_error *err) {
  const vs_session session = {.verify = true, .stop = c->o->stop};
  int *verify = &c->scene->setup.run.verify;
  if (*verify == VS_VERIFY_NEVER)
    *verify = VS_VERIFY_AUTO; /* a margin without an error proves nothing */
  show_progress(c, "the scene", "as it is");
  vs_status status = vs_steady_run(&session, c->scene, c->nominal, err);
  if (!status && c->nominal->second.stopped)
    status = vs_fail(err, VS_SIGNAL, "stopped by a signal");
  if (!status && !c->nominal->verdict.count)
    status = vs_fail(err, VS_INPUT,
                     "%s: nothing is rated, so there is nothing to cure; choose "
                     "parts that have limits, or write ratings",
                     c->o->scene);
  if (!status) c->shortfall = shortfall_of(&c->nominal->verdict);
  return status;
}

static void free_cure(cure *c) {
  for (size_t k = 0; k < c->n_parts; k++) {
    vs_deck_free(c->part[k].deck);
    free(c->part[k].deck);
  }
  vs_price_list_free(&c->list);
  vs_result_free(c->nominal);
  vs_scene_free(c->scene);
  free(c->nominal);
  free(c->scene);
  free(c->part);
  free(c->item);
}

static vs_status run_cure(cure *c, vs_error *err) {
  const vs_run_options *o = c->o;
  vs_status status = check_series(c, err);
  if (!status) status = read_catalogue(c, err);
  if (!status) status = vs_scene_read(o->scene, o->sets, o->n_sets, o->tier, c->scene, err);
  if (!status && !c->scene->tier->has_circuit)
    status = vs_scene_take_circuit(c->scene, "cure", err);
  c->scene->allow_code = o->allow_code;
  if (!status) status = vs_control_allow(&c->scene->control, o->allow_code, err);
  if (!status && !o->quiet) vs_scene_warn(c->scene);
  if (!status) status = run_nominal(c, err);
  if (!status && c->shortfall > 0) status = try_values(c, err);
  if (!status && c->shortfall > 0) status = try_parts(c, err);
  if (!o->quiet && isatty(STDERR_FILENO)) dprintf(STDERR_FILENO, "\r\033[K");
  return status ? status : tell(c, err);
}

/* ---- the command line ---- */

typedef struct cure_line {
  vs_arguments common;
  vs_run_options run;
  const char *catalogue, *series;
} cure_line;

static vs_status cure_command(const void *given, vs_error *err) {
  const cure_line *line = given;
  const vs_run_options o = vs_options_of_run(&line->run, &line->common);
  cure c = {.o = &o,
            .catalogue = line->catalogue,
            .series = line->series,
            .scene = vs_alloc(1, sizeof(vs_scene)),
            .nominal = vs_alloc(1, sizeof(vs_result))};
  vs_status status = run_cure(&c, err);
  free_cure(&c);
  return status;
}

static const vs_option CURE_OPTIONS[] = {
    VS_OPTIONS_FILE(cure_line, catalogue, "catalogue", "FILE.csv",
                    "the parts that may be bought, with columns part, kind, value and price: these "
                    "are tried in place of those that come with the program; a value has the price "
                    "of its cheapest row, whatever the ratings there"),
    VS_OPTIONS_WORD(cure_line, series, "series", "E12",
                    "the E series, E3 to E192, from which values are taken of resistors and of "
                    "capacitors that the list has no values of (default E12)"),
    VS_OPTIONS_SET,
    VS_OPTIONS_TIER(cure_line, run.tier),
    VS_OPTIONS_OUTPUT("DIR", "writes cure.json there"),
    VS_OPTIONS_JSON,
    VS_OPTIONS_QUIET,
    VS_OPTIONS_FLAG(cure_line, run.all, "all", "also shows the changes that do not cure it"),
    VS_OPTIONS_ALLOW_CODE,
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_cure_cli = {
    .name = "cure",
    .argument = "SCENE",
    .text = "finds single changes of a part after which the verdict on the scene is held, the "
            "cheapest first: another E value of a resistor or capacitor that is a device of the "
            "deck, or another part of the same kind; each is proved by a run of this scene, and no "
            "other threat is tried",
    .examples = "  vibrospice cure my.yaml\n"
                "  vibrospice cure my.yaml --catalogue catalogue.csv -o cure --all\n",
    .options = CURE_OPTIONS,
    .size = sizeof(cure_line),
    .defaults = &(const cure_line){.series = "E12"},
    .run = cure_command};
