/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/import.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/jail.h"
#include "base/path.h"
#include "copying.h"
#include "import/roles.h"
#include "lines.h"
#include "netlist/cards.h"
#include "netlist/kinds.h"
#include "netlist/words.h"
#include "run/session.h"
#include "settings.h"

/* ---- how it begins ---- */

/* How a netlist's run begins. A .tran without uic begins at the operating point. A run of this
 * program begins with every capacitor and inductor at 0 that has no IC=. */

/* True where the line has a dialect's word for a start without an operating point. LTspice's
 * `startup` begins with all sources at 0. */
static bool begins_at_0(const vs_card *tran) {
  static const char *const WORDS[] = {"uic", "skipbp", "startup"};
  for (const char *s = tran->text; *s; s = vs_words_next(s))
    if (VS_WORDS_AMONG(vs_words_at(s), WORDS)) return true;
  return false;
}

/* The netlist's last .tran; NULL: it has none. */
static const vs_card *find_tran(const vs_listing *l) {
  const vs_card *tran = NULL;
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *c = &l->cards[k];
    if (c->kind == VS_CARD_STATEMENT && !c->included && vs_listing_is(c, ".tran")) tran = c;
  }
  return tran;
}

/* The first source that is not 0 at t = 0. A gate's source without a pulse is left out, as the user
 * said that the program pulses it. */
static const vs_element *find_source(const vs_elements *w, const vs_values *v, const vs_roles *r) {
  for (size_t k = 0; k < w->count; k++) {
    const vs_element *e = &w->elements[k];
    int gate = vs_roles_gate_of(r, e);
    if (!strchr("vi", e->letter) || (gate >= 0 && isnan(r->gates[gate].pulse.at_s))) continue;
    if (!vs_course_begins_at_0(w, v, e)) return e;
  }
  return NULL;
}

/* True where an element of the netlist itself is an instance of the subcircuit of that scope. */
static bool is_instantiated(const vs_listing *l, size_t scope) {
  bool is = false;
  for (size_t k = 0; k < l->count && !is; k++)
    is = !l->cards[k].included && vs_cards_called(&l->netlist, &l->netlist.card[k]) == scope;
  return is;
}

/* Adds the name of the first source that is not 0 at t = 0 in a subcircuit that the netlist defines
 * and uses. Nested subcircuits are not examined. */
static void find_inner_source(const vs_elements *w, const vs_values *v, vs_text *name) {
  const vs_listing *l = w->listing;
  const vs_cards *c = &l->netlist;
  for (size_t scope = 1; scope < c->n_scopes; scope++) {
    const vs_netlist_scope *in = &c->scope[scope];
    if (in->outer || l->cards[in->first].included || !is_instantiated(l, scope)) continue;
    for (size_t k = in->first; k < in->last; k = vs_cards_next(c, k)) {
      vs_element e;
      if (c->card[k].kind != VS_CARDS_ELEMENT || !strchr("vi", c->card[k].letter)) continue;
      vs_elements_source_of(l, k, &e);
      if (vs_course_begins_at_0(w, v, &e)) continue;
      vs_text_add(name, "%s of subcircuit %.*s", e.name, (int)in->name.n, in->name.at);
      return;
    }
  }
}

static void list_stores(const vs_elements *w, const vs_roles *r, vs_text *names) {
  enum { SHOWN = 6 };
  int count = 0;
  for (size_t k = 0; k < w->count; k++) {
    const vs_element *e = &w->elements[k];
    if (!strchr("cl", e->letter) || e == r->coil || vs_elements_option(w, e, "ic").n) continue;
    if (count < SHOWN) vs_text_add(names, "%s%s", count ? ", " : "", e->name);
    if (count++ == SHOWN) vs_text_add(names, ", ...");
  }
}

/* ---- all of it ---- */

/* Netlists that come with the program, as examples. */
static const vs_shelf SHELF = {"netlist", "import", ""};

/* All of one import. */
typedef struct work {
  const vs_import_options *o;
  vs_listing listing;
  vs_values values;
  vs_elements wiring;
  vs_roles roles;
  vs_fate plan;
  vs_copying body;
  vs_settings settings;
  vs_text deck;
  int head; /* lines of the deck before the netlist */
} work;

static void free_work(work *w) {
  vs_text_free(&w->deck);
  vs_copying_free(&w->body);
  vs_fate_free(&w->plan);
  vs_elements_free(&w->wiring);
  vs_values_free(&w->values);
  vs_listing_free(&w->listing);
  free(w);
}

/* ---- what was done ---- */

static void note_roles(work *w) {
  const vs_roles *r = &w->roles;
  vs_declared_notes *did = &w->plan.sheet.did, *left = &w->plan.sheet.left;
  if (r->mains)
    vs_declared_note(did, "%s is the mains, %s: %.6g V rms, %.6g Hz", r->mains->name,
                     r->found_mains ? "the only sine" : "as said", r->rms_v, r->hz);
  else
    vs_declared_note(did, "nothing is the mains: no source is driven by the program");
  for (size_t g = 0; g < r->n_gates; g++) {
    const vs_roles_gate *gate = &r->gates[g];
    const vs_element *next = vs_elements_next(&w->wiring, gate->source, gate->source->nodes[0]);
    bool resistor = next && next->letter == 'r';
    vs_declared_note(did, "%s fires, %s: its %.6g %s become %s, behind the program's pulse; %s%s",
                     gate->source->name, r->found_gate ? "the only pulse" : "as said",
                     gate->pulse.high - gate->pulse.low, gate->source->letter == 'v' ? "V" : "A",
                     vs_fate_of(&w->plan, gate->source)->level,
                     resistor ? "in series: " : "no resistor is in series with it",
                     resistor ? next->name : "");
  }
  if (!r->n_gates) vs_declared_note(did, "no source fires anything");
  vs_declared_note(did, "%s%s%s is the EVA's coil, %s: %.6g H, %.6g ohm", r->coil->name,
                   r->coil_r ? "+" : "", r->coil_r ? r->coil_r->name : "",
                   r->found_coil ? "the only inductor that is coupled with none" : "as said",
                   r->inductance_h, r->resistance_ohm);
  if (r->resistance_ohm < 1e-3)
    vs_declared_note(left,
                     "the coil has no resistance: give actuator.resistance (1 mohm is taken)");
  if (r->begins_with_current)
    vs_declared_note(left, "%s begins with a current, IC=; the program's coil begins without one",
                     r->coil->name);
  if (r->heats)
    vs_declared_note(left,
                     "%s has a coefficient of temperature, tc1= or tc2=; the program's coil keeps "
                     "the value of 27 degC: give actuator.%s that of a warm one",
                     r->heats->name, r->heats == r->coil ? "inductance" : "resistance");
  if (r->modelled)
    vs_declared_note(
        left,
        "%s has a .model, which the program's coil has not: give actuator.%s the value "
        "that both make",
        r->modelled->name, r->modelled == r->coil ? "inductance" : "resistance");
  if (r->delayed)
    vs_declared_note(
        left,
        "%s begins with a delay; the program's mains are there from t = 0 on, in the same phase",
        r->mains->name);
  if (r->at_zero)
    vs_declared_note(left,
                     "the gate fires at the mains' zero, where firing.angle cannot be: 0.001 deg "
                     "is taken");
}

/* Notes what a gate's source does that the deck's pulses do not do. */
static void note_turned(work *w) {
  vs_declared *s = &w->plan.sheet;
  for (size_t k = 0; k < w->roles.n_gates; k++) {
    const vs_roles_gate *g = &w->roles.gates[k];
    const vs_course_pulse *p = &g->pulse;
    if (g->turned)
      vs_declared_note(&s->did,
                       "%s rests at %.6g, and is pulsed to %.6g: it fires between its own "
                       "pulses",
                       g->source->name, p->high, p->low);
    if (g->early_s > 0)
      vs_declared_note(&s->left,
                       "line %d: %s also fires from t = 0 to %.6g s, before its first pulse; the "
                       "deck's gate fires first at %.6g s, as a scene's pulses are all alike",
                       vs_elements_where(&w->wiring, g->source, 0).line, g->source->name,
                       g->early_s, p->at_s);
  }
}

/* Looks at capacitors and inductors outside of subcircuits, but not at the coil, and at sources
 * there and in subcircuits that the netlist defines and uses. */
static void note_start(work *w) {
  const vs_card *tran = find_tran(&w->listing);
  vs_text source = {0}, stores = {0};
  if (!tran || begins_at_0(tran)) return;
  const vs_element *first = find_source(&w->wiring, &w->values, &w->roles);
  if (first)
    vs_text_add(&source, "%s", first->name);
  else
    find_inner_source(&w->wiring, &w->values, &source);
  if (source.text) list_stores(&w->wiring, &w->roles, &stores);
  if (stores.text)
    vs_declared_note(
        &w->plan.sheet.left,
        "line %d: '%s' has no uic: the netlist begins at its operating point, and %s "
        "is not 0 there; the deck begins with %s at 0: give each an IC=, or its node a "
        "line .ic; where 0 is right, write uic",
        tran->where.line, tran->text, source.text, stores.text);
  vs_text_free(&source);
  vs_text_free(&stores);
}

static void note_devices(work *w) {
  vs_declared *s = &w->plan.sheet;
  for (size_t k = 0; k < w->wiring.count; k++) {
    const vs_element *e = &w->wiring.elements[k];
    const vs_fate_element *own = &w->plan.of[k];
    if (!own->pins.kind || e->letter == 'd') continue;
    vs_declared_note(&s->did, "%s is %s %s, %s%s%s", e->name,
                     strchr("aeio", *own->pins.kind) ? "an" : "a", own->pins.kind, own->pins.by,
                     *own->pins.part ? ": " : "", own->pins.part);
    if (!vs_kinds_latches(own->pins.kind) || vs_kinds_find(own->pins.kind)->both_ways ||
        *own->pins.part)
      continue;
    vs_declared_note(
        &s->left,
        "%s: what its maker allows is not known here: a line '*$ rating v_ak "
        "-V_RRM..V_DRM V'; or a part's file NAME.inc beside the netlist ('vibrospice part %s "
        "-o NAME.inc'), if the netlist names NAME and does not define it",
        e->name, own->pins.kind);
  }
  if (w->body.skipped)
    vs_declared_note(&s->did,
                     "%zu line%s of analysis and commands left out: the program runs its own",
                     w->body.skipped, w->body.skipped == 1 ? "" : "s");
  if (w->body.pspice) vs_declared_note(&s->did, "read in PSpice's dialect: *$ compat ps");
  if (s->left_out)
    vs_declared_note(&s->left,
                     "%zu probes, losses and the like are left out: a deck has no room for "
                     "more",
                     s->left_out);
}

/* ---- the deck ---- */

static const char *name_of(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

static void add_comments(vs_text *t, const char *head, const vs_declared_notes *notes) {
  if (notes->count) vs_text_add(t, "* %s\n", head);
  for (size_t k = 0; k < notes->count; k++) vs_text_add(t, "*   %s\n", notes->item[k]);
}

static void compose(work *w) {
  const vs_declared *s = &w->plan.sheet;
  vs_text *t = &w->deck;
  const char *title = *w->listing.title ? w->listing.title : name_of(w->o->name);
  vs_text_add(t, "* %s\n* imported from %s (%s) by vibrospice %s\n", name_of(w->o->output),
              name_of(w->o->name), vs_listing_origins[w->listing.origin], VS_VERSION);
  add_comments(t, "What was done:", &s->did);
  add_comments(t, "What is left to decide:", &s->left);
  vs_text_add(t, "* A scene with the netlist's own values:\n");
  vs_settings_write(&w->settings, name_of(w->o->output), "*   ", t);
  vs_text_add(t, "*$ title  %.100s\n", title);
  if (w->body.pspice) vs_text_add(t, "*$ compat ps\n");
  vs_declared_write(s, t);
  for (const char *c = t->text; *c; c++) w->head += *c == '\n';
  vs_text_add(t, "%s", w->body.text.text ? w->body.text.text : "");
}

/* The folder of a path, as it is written and as an absolute path. */
static void folder_of(const char *path, char folder[VS_PATH_SIZE], char full[VS_PATH_SIZE]) {
  int n = (int)(name_of(path) - path);
  snprintf(folder, VS_PATH_SIZE, "%.*s", n > 1 ? n - 1 : n, path);
  if (!realpath(*folder ? folder : ".", full)) snprintf(full, VS_PATH_SIZE, "%s", folder);
}

static vs_status plan_all(work *w, const char *folder, vs_error *err) {
  const vs_import_options *o = w->o;
  vs_status status = vs_listing_read(&w->listing, o->name, o->library, err);
  if (status) return status;
  vs_values_read(&w->values, &w->listing);
  status = vs_elements_read(&w->wiring, &w->listing, err);
  if (!status && vs_error_count(err)) return VS_OK;
  if (!status) status = vs_roles_find(&w->wiring, &w->values, &o->asked, &w->roles, err);
  w->plan = (vs_fate){.wiring = &w->wiring, .values = &w->values, .roles = &w->roles};
  if (!status) status = vs_fate_make(&w->plan, o->pins, err);
  if (status || vs_error_count(err)) return status;
  note_roles(w);
  note_turned(w);
  note_start(w);
  status = vs_lines_add(&w->plan, err);
  vs_copying_write(&w->plan, folder, o->library, &w->body);
  note_devices(w);
  vs_settings_make(&w->settings, &w->roles, &w->values, w->body.until_s, w->body.gear);
  compose(w);
  return status;
}

/* ---- trying it ---- */

/* Gives an error in the deck the place of the netlist's line that the deck's line comes from. */
static void place_in_netlist(const work *w, const char *path, vs_error *e) {
  vs_error plain = *e;
  const vs_copying_origin *from = NULL;
  if (!e->place_size || strncmp(e->text, path, (size_t)e->file_size)) return;
  for (size_t k = 0; k < w->body.count && w->body.origins[k].line + w->head <= e->line; k++)
    from = &w->body.origins[k];
  vs_fail_at(e, from ? from->where : (vs_where){.file = w->listing.files[0]}, "%s",
             plain.text + plain.place_size);
}

/* Runs the first step of the deck at `path` in the scene that the netlist describes. */
static vs_status try_deck(const work *w, const char *path, vs_error *err) {
  vs_tree tree = {.root = vs_alloc(1, sizeof *tree.root)};
  tree.root->kind = VS_NODE_MAP;
  vs_tree_put(&tree, "circuit.deck", path, (vs_where){0});
  for (size_t k = 0; k < w->settings.count; k++) {
    const vs_setting *s = &w->settings.item[k];
    char key[64];
    snprintf(key, sizeof key, "%s.%s", s->section, s->key);
    vs_tree_put(&tree, key, s->value, (vs_where){0});
  }
  vs_setup *setup = vs_alloc(1, sizeof *setup);
  vs_status status = vs_setup_build(tree.root, setup, err);
  if (!status && !vs_error_count(err))
    status = vs_session_try(vs_tiers_automatic(true), setup, err);
  vs_setup_free(setup);
  free(setup);
  vs_tree_free(&tree);
  return status;
}

static vs_status write_file(const char *path, const char *text, vs_error *err) {
  char folder[VS_PATH_SIZE], full[VS_PATH_SIZE];
  vs_file file = {0};
  folder_of(path, folder, full);
  vs_status status = vs_file_open(&file, folder, name_of(path), err);
  if (status) return status;
  fputs(text, file.stream);
  return vs_file_commit(&file, err);
}

/* Writes the deck under a temporary name, tries it, and then renames it. */
static vs_status write_deck(work *w, const char *folder, vs_findings *all, vs_error *err) {
  vs_file file = {0};
  vs_error own = {.findings = all};
  vs_status status = vs_file_open(&file, folder, name_of(w->o->output), err);
  if (status) return status;
  fputs(w->deck.text, file.stream);
  fflush(file.stream);
  vs_jail_allow_named(file.temporary);
  status = vs_error_keep(&own, try_deck(w, file.temporary, &own));
  for (size_t k = 0; k < all->count; k++) place_in_netlist(w, file.temporary, &all->item[k]);
  if (status) *err = own;
  if (!status && !all->count) return vs_file_commit(&file, err);
  vs_file_discard(&file);
  return status;
}

/* ---- what is said ---- */

static void say(const work *w) {
  const vs_declared *s = &w->plan.sheet;
  fprintf(stderr, "%s: %s netlist\n", w->o->name, vs_listing_origins[w->listing.origin]);
  for (size_t k = 0; k < s->did.count; k++) fprintf(stderr, "  %s\n", s->did.item[k]);
  if (s->left.count) fprintf(stderr, "left to decide:\n");
  for (size_t k = 0; k < s->left.count; k++) fprintf(stderr, "  %s\n", s->left.item[k]);
}

static void add_notes(vs_json *json, const char *key, const vs_declared_notes *notes) {
  vs_json_array(json, key, notes->count ? VS_JSON_LINES : VS_JSON_ROW);
  for (size_t k = 0; k < notes->count; k++) vs_json_text(json, NULL, notes->item[k]);
  vs_json_end(json);
}

static void say_json(const work *w) {
  const vs_roles *r = &w->roles;
  vs_text text = {0};
  vs_json json = vs_json_new(&text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_json_text(&json, "written", w->o->output);
  vs_json_text(&json, "origin", vs_listing_origins[w->listing.origin]);
  vs_json_text(&json, "mains", r->mains ? r->mains->name : NULL);
  vs_json_array(&json, "gates", VS_JSON_ROW);
  for (size_t g = 0; g < r->n_gates; g++) vs_json_text(&json, NULL, r->gates[g].source->name);
  vs_json_end(&json);
  vs_json_array(&json, "coil", VS_JSON_ROW);
  vs_json_text(&json, NULL, r->coil->name);
  if (r->coil_r) vs_json_text(&json, NULL, r->coil_r->name);
  vs_json_end(&json);
  vs_settings_json(&w->settings, w->o->output, &json);
  add_notes(&json, "done", &w->plan.sheet.did);
  add_notes(&json, "left", &w->plan.sheet.left);
  vs_json_end(&json);
  puts(text.text);
  vs_text_free(&text);
}

static vs_status write_scene(const work *w, vs_error *err) {
  vs_text scene = {0};
  vs_text_add(&scene, "# the values of %s, for %s\n", name_of(w->o->name), name_of(w->o->output));
  vs_settings_write(&w->settings, w->o->output, "", &scene);
  vs_status status = write_file(w->o->scene, scene.text, err);
  vs_text_free(&scene);
  return status;
}

static void say_findings(const vs_import_options *o, const vs_findings *all) {
  vs_text text = {0};
  vs_json json = vs_json_new(&text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_json_null(&json, "written");
  vs_json_array(&json, "findings", VS_JSON_LINES);
  for (size_t k = 0; k < all->count; k++) {
    const vs_error *e = &all->item[k];
    fprintf(stderr, "%s\n", e->text);
    vs_json_object(&json, NULL, VS_JSON_ROW);
    char file[sizeof e->text];
    snprintf(file, sizeof file, "%.*s", e->file_size, e->text);
    vs_json_text(&json, "file", *file ? file : o->name);
    vs_json_number(&json, "line", e->line ? (double)e->line : (double)NAN, 12);
    vs_json_number(&json, "column", e->line ? (double)e->column : (double)NAN, 12);
    vs_json_text(&json, "message", e->text + e->place_size);
    vs_json_end(&json);
  }
  vs_json_end(&json);
  vs_json_end(&json);
  if (o->json) puts(text.text);
  vs_text_free(&text);
}

/* ---- the command ---- */

/* Error: the output is not a deck's name, or is the netlist itself. */
static vs_status check_output(const vs_import_options *o, vs_error *err) {
  const char *ending = o->output ? strrchr(o->output, '.') : NULL;
  char a[VS_PATH_SIZE], b[VS_PATH_SIZE];
  if (!o->output)
    return vs_fail(err, VS_INPUT, "import: wants -o FILE.cir; see vibrospice import --help");
  if (!ending || strcmp(ending, ".cir"))
    return vs_fail(err, VS_INPUT, "-o %s: a deck's name ends in .cir", o->output);
  if (o->scene && !strcmp(o->scene, o->output))
    return vs_fail(err, VS_INPUT, "--scene %s: that is the deck; give the scene another name",
                   o->scene);
  if (realpath(o->name, a) && realpath(o->output, b) && !strcmp(a, b))
    return vs_fail(err, VS_INPUT, "-o %s: that is the netlist itself; give the deck another name",
                   o->output);
  return VS_OK;
}

static vs_status import(const vs_import_options *o, vs_error *err) {
  work *w = vs_alloc(1, sizeof *w);
  vs_findings *all = vs_alloc(1, sizeof *all);
  vs_error own = {.findings = all};
  char folder[VS_PATH_SIZE], full[VS_PATH_SIZE];
  bool deck = !access(o->output, F_OK), scene = o->scene && !access(o->scene, F_OK);
  w->o = o;
  folder_of(o->output, folder, full);
  vs_status status = vs_error_keep(&own, plan_all(w, full, &own));
  if (status) *err = own;
  if (!status && !all->count) status = write_deck(w, folder, all, err);
  if (all->count) say_findings(o, all);
  if (!status && all->count) status = VS_INPUT;
  if (!status && o->scene) status = write_scene(w, err);
  if (!status && !o->quiet) say(w);
  if (!status && !o->quiet && (deck || scene))
    fprintf(stderr, "vibrospice: note: replaced %s%s%s\n", deck ? o->output : "",
            deck && scene ? ", " : "", scene ? o->scene : "");
  if (!status && o->json) say_json(w);
  free(all);
  free_work(w);
  return status;
}

vs_status vs_import_command(const vs_import_options *options, vs_error *err) {
  vs_import_options o = *options;
  char path[VS_PATH_SIZE];
  vs_status status = check_output(&o, err);
  if (!status) status = vs_path_find(&SHELF, o.name, (vs_where){0}, path, err);
  o.name = path;
  return status ? status : import(&o, err);
}
