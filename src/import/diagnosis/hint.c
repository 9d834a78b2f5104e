/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/hint.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/disjoint_sets.h"
#include "diagnosis/judge.h"
#include "diagnosis/note.h"
#include "diagnosis/wiring.h"

/* ---- floating nodes ---- */

/* Nodes whose voltage nothing determines, elements with an unconnected end, and loops of voltage
 * sources.
 *
 * A run begins without an operating point: each capacitance and inductance begins as its ic= says,
 * or at 0. So a capacitance determines the voltage of its node as well as a resistance does. What
 * matters is only whether anything but current sources leads from a node to ground. */

/* Puts each node into a set of its own. */
static vs_disjoint_sets sets_of(const vs_wiring *w) {
  vs_disjoint_sets sets = {0};
  for (size_t k = 0; k < w->n_nodes; k++) vs_disjoint_sets_add(&sets);
  return sets;
}

/* Joins the sets of two pins; false: they were in one set already. */
static bool join(vs_disjoint_sets *sets, int a, int b) {
  return vs_disjoint_sets_join(sets, (size_t)a, (size_t)b);
}

/* ---- a way to ground ---- */

static bool looks_at(const vs_wire *wire, int node) {
  for (int k = 0; k < wire->n_looks; k++)
    if (wire->looks[k] == node) return true;
  return false;
}

/* True for an element that determines the voltage between its pins: by a conductance, a charge or a
 * source. A current source does so if its current depends on its own voltage. */
static bool holds(const vs_wire *wire) {
  if (wire->voltage || !strchr("bgif", wire->letter)) return true;
  for (int k = 0; k < wire->n_pins; k++)
    if (wire->pins[k] != 0 && looks_at(wire, wire->pins[k])) return true;
  return false;
}

static const vs_wire *first_at(const vs_wiring *w, vs_disjoint_sets *sets, size_t root) {
  for (size_t k = 0; k < w->count; k++)
    for (int p = 0; p < w->wires[k].n_pins; p++)
      if (vs_disjoint_sets_find(sets, (size_t)w->wires[k].pins[p]) == root) return &w->wires[k];
  return NULL;
}

static const vs_wire *first_looking(const vs_wiring *w, int node) {
  for (size_t k = 0; k < w->count; k++)
    if (looks_at(&w->wires[k], node)) return &w->wires[k];
  return NULL;
}

/* Adds the names of the first four nodes of a set. */
static void name_nodes(const vs_wiring *w, vs_disjoint_sets *sets, size_t root, vs_text *names) {
  int count = 0;
  for (size_t k = 1; k < w->n_nodes; k++)
    if (vs_disjoint_sets_find(sets, k) == root && count++ < 4)
      vs_text_add(names, "%s%s", count > 1 ? ", " : "", w->nodes[k]);
  if (count > 4) vs_text_add(names, " and %d more", count - 4);
}

/* True for a node inside the EVA, such as its gap. The EVA is the program's own subcircuit, which
 * is not opened. */
static bool is_in_eva(const vs_wiring *w, size_t node) {
  size_t n = strlen(w->deck->eva);
  return n > 0 && !strncmp(w->nodes[node], w->deck->eva, n) && w->nodes[node][n] == '.';
}

static void tell_group(const vs_wiring *w, vs_disjoint_sets *sets, size_t root, vs_notes *notes) {
  const vs_wire *at = first_at(w, sets, root), *looking = first_looking(w, (int)root);
  vs_text names = {0};
  name_nodes(w, sets, root, &names);
  if (at)
    vs_fail_at(&vs_note_add(notes, "floating", "warning")->text, vs_wiring_where(at),
               "%s: nothing but current sources leads to ground from node %s, so that no voltage "
               "there is right or wrong: ngspice ends with 'singular matrix', or takes any; one "
               "element mends it, as 'Rfloat %s 0 1G'",
               at->name, names.text, w->nodes[root]);
  else if (looking)
    vs_fail_at(&vs_note_add(notes, "floating", "warning")->text, vs_wiring_where(looking),
               "%s looks at node %s, which no element is connected to; is it misspelt?",
               looking->name, names.text);
  vs_text_free(&names);
}

static void find_groups(const vs_wiring *w, vs_notes *notes) {
  vs_disjoint_sets sets = sets_of(w);
  for (size_t k = 0; k < w->count; k++)
    for (int p = 1; p < w->wires[k].n_pins && holds(&w->wires[k]); p++)
      join(&sets, w->wires[k].pins[0], w->wires[k].pins[p]);
  for (size_t k = 1; k < w->n_nodes; k++)
    if (vs_disjoint_sets_find(&sets, k) == k && !is_in_eva(w, k)) tell_group(w, &sets, k, notes);
  vs_disjoint_sets_free(&sets);
}

/* ---- open ends ---- */

/* True where the deck itself uses the node's voltage. */
static bool is_probed(const vs_deck *deck, const char *node) {
  char signal[VS_DECK_NAME + 4];
  snprintf(signal, sizeof signal, "v(%.60s)", node);
  for (size_t k = 0; k < deck->n_terms; k++)
    if (!strcmp(deck->terms[k].plus, signal) || !strcmp(deck->terms[k].minus, signal)) return true;
  return false;
}

/* Notes elements with two pins of which one is connected to nothing else: they carry no current.
 * Open ends inside an instance are left to the author of the subcircuit. */
static void find_open_ends(const vs_wiring *w, vs_notes *notes) {
  int *ends = vs_alloc(w->n_nodes, sizeof *ends);
  for (size_t k = 0; k < w->count; k++) {
    for (int p = 0; p < w->wires[k].n_pins; p++) ends[w->wires[k].pins[p]]++;
    for (int p = 0; p < w->wires[k].n_looks; p++) ends[w->wires[k].looks[p]]++;
  }
  for (size_t k = 0; k < w->count; k++) {
    const vs_wire *wire = &w->wires[k];
    for (int p = 0; p < wire->n_pins && strchr("rlcds", wire->letter); p++) {
      const char *node = w->nodes[wire->pins[p]];
      if (!wire->pins[p] || ends[wire->pins[p]] > 1 || strchr(node, '.') ||
          is_probed(w->deck, node))
        continue;
      vs_fail_at(&vs_note_add(notes, "open", "warning")->text, vs_wiring_where(wire),
                 "%s: nothing else is connected to node %s, so that it carries no current; is the "
                 "node misspelt?",
                 wire->name, node);
    }
  }
  free(ends);
}

/* ---- loops ---- */

/* Notes loops that consist of voltage sources alone: their currents have no solution, or infinitely
 * many. */
static void find_loops(const vs_wiring *w, vs_notes *notes) {
  vs_disjoint_sets sets = sets_of(w);
  for (size_t k = 0; k < w->count; k++) {
    const vs_wire *wire = &w->wires[k];
    if (!wire->voltage || wire->n_pins < 2 || join(&sets, wire->pins[0], wire->pins[1])) continue;
    vs_fail_at(
        &vs_note_add(notes, "loop", "warning")->text, vs_wiring_where(wire),
        "%s closes a loop of voltage sources, nodes %s and %s: no current there is right or "
        "wrong, and ngspice ends with 'singular matrix'; a resistance in series mends it, as "
        "1 mohm",
        wire->name, w->nodes[wire->pins[0]], w->nodes[wire->pins[1]]);
  }
  vs_disjoint_sets_free(&sets);
}

/* Adds a note for each group of nodes without a path to ground, each unconnected end, and each loop
 * of sources. */
static void find_floating(const vs_wiring *w, vs_notes *notes) {
  if (!w->whole) return;
  find_groups(w, notes);
  find_open_ends(w, notes);
  find_loops(w, notes);
}

/* ---- before a run ---- */

void vs_hint_look(const vs_check_options *o, const vs_deck *deck, vs_check_bench *bench) {
  vs_wiring wiring;
  vs_notes *notes = vs_alloc(1, sizeof *notes);
  vs_comparators *comparators = vs_alloc(1, sizeof *comparators);
  vs_wiring_open(&wiring, deck);
  find_floating(&wiring, notes);
  vs_judge_find_comparators(&wiring, comparators);
  if (!o->deep) vs_judge_note_comparators(comparators, notes); /* a trial measures them */
  for (size_t k = 0; k < notes->count; k++) *vs_warnings_add(bench->warnings) = notes->item[k].text;
  vs_note_rows(notes, o->name, &bench->rows);
  vs_wiring_free(&wiring);
  free(comparators);
  free(notes);
}

/* ---- the scene that is tried ---- */

/* Reads the shipped scene with this deck and defaults otherwise. If the deck has a gate, it is
 * fired in each cycle. */
static vs_status read_deck(const char *name, vs_scene *scene, vs_error *err) {
  vs_text deck = {0};
  vs_text_add(&deck, "circuit.deck=%s", name);
  char every[] = "firing.every=1", *sets[] = {deck.text, every};
  vs_status status = vs_scene_read("paper", sets, 1, "circuit", scene, err);
  if (!status && vs_deck_has_port(&scene->setup.deck, vs_port_is_gated)) {
    vs_scene_free(scene);
    status = vs_scene_read("paper", sets, 2, "circuit", scene, err);
  }
  vs_text_free(&deck);
  return status;
}

/* Reads the scene itself, or for a deck the shipped scene with it. */
static vs_status read_scene(const vs_check_options *o, bool is_deck, vs_scene *scene,
                            vs_error *err) {
  return is_deck ? read_deck(o->name, scene, err)
                 : vs_scene_read(o->name, o->sets, o->n_sets, NULL, scene, err);
}

/* The processor time that a trial may take, s. */
static const double LIMIT_S = 5;

/* The end of a trial: one cycle after the first firing, but no later than the run's own end. */
static double trial_end(const vs_setup *s) {
  double cycles = fmax(s->timeline.firing.first_cycle, 1) + 1;
  return fmin(s->run.until_s, cycles * s->timeline.period_s);
}

/* ---- what is watched ---- */

typedef struct watch_list {
  vs_formula formula[VS_ATTEMPT_WATCHES];
  const vs_comparator *of[VS_ATTEMPT_WATCHES];
  size_t count;
} watch_list;

/* Replaces the names in a formula by their values; false: one of them has no value here. */
static bool bind_names(const vs_setup *s, vs_formula *formula) {
  double values[VS_DECK_MOST];
  vs_deck_value standard[VS_STANDARD];
  const vs_deck *deck = &s->deck;
  vs_setup_standard(s, standard);
  for (size_t n = 0; n < deck->n_names; n++) {
    values[n] = NAN;
    for (size_t k = 1; k < deck->section.count; k++) {
      const vs_field *f = &deck->section.fields[k];
      const char *at = (const char *)&s->circuit_values + f->offset;
      if (f->kind == VS_REAL && !strcasecmp(f->key, deck->names[n].name))
        values[n] = *(const double *)(const void *)at;
    }
    for (size_t k = 0; k < VS_STANDARD; k++)
      if (!strcasecmp(standard[k].name, deck->names[n].name)) values[n] = standard[k].value;
  }
  for (size_t k = 0; k < formula->count; k++) {
    int name = vs_formula_name_of(&formula->ops[k]);
    if (name >= 0 && isnan(values[name])) return false;
  }
  vs_formula_bind(formula, values);
  return true;
}

/* Adds the comparator's input to what is watched at each step. An input that cannot be read here,
 * such as a parameter of a subcircuit, is not watched. */
static void watch(vs_scene *scene, const vs_comparator *c, watch_list *list) {
  vs_deck *deck = &scene->setup.deck;
  vs_cursor cursor = {.start = c->text, .at = c->text};
  vs_formula formula = {0};
  vs_error unread = {0};
  size_t terms = deck->n_terms, names = deck->n_names;
  if (list->count == VS_ATTEMPT_WATCHES ||
      vs_deck_add_formula(deck, &cursor, "", &formula, &unread))
    return;
  if (vs_formula_has_terms(&formula) && bind_names(&scene->setup, &formula)) {
    list->of[list->count] = c;
    list->formula[list->count++] = formula;
    return;
  }
  vs_formula_free(&formula);
  deck->n_terms = terms;
  deck->n_names = names;
}

/* ---- the trials ---- */

static const char *const RULES[] = {"trap", "gear"};

static void add_line(const vs_attempt *t, bool gear, vs_text *table) {
  vs_text_add(table, "\n%-7s %9ld %9ld %10.2f s %10.2g s   %s %.6g s", RULES[gear], t->steps,
              t->tries - t->steps, t->processor_s, t->steps ? t->shortest_s : 0,
              t->status ? "fails at"
              : t->cut  ? "limit at"
                        : "whole, to",
              t->reached_s);
}

static void add_table(const vs_judge_case *c, double until_s, const vs_notes *notes,
                      vs_text *table) {
  vs_text_add(table,
              "\ntried: the first %.4g s, each in at most %g s of processor time"
              "\n%-7s %9s %9s %12s %12s   end",
              until_s, LIMIT_S, "method", "steps", "rejected", "processor", "shortest");
  add_line(c->now, c->gear, table);
  add_line(c->other, !c->gear, table);
  for (size_t k = 0; k < notes->count; k++)
    vs_text_add(table, "\n%s: %s", notes->item[k].level, notes->item[k].text.text);
}

/* Tries the scene with both rules and adds notes on the result. */
static vs_status try_both(const vs_check_options *o, vs_scene *scene, const watch_list *list,
                          vs_check_bench *bench, vs_error *err) {
  vs_attempt *trials = vs_alloc(2, sizeof *trials);
  vs_notes *notes = vs_alloc(1, sizeof *notes);
  bool gear = scene->setup.run.gear;
  double until_s = trial_end(&scene->setup);
  vs_attempt_plan plan = {.scene = scene,
                          .gear = gear,
                          .until_s = until_s,
                          .limit_s = LIMIT_S,
                          .watched = list->formula,
                          .n_watched = list->count};
  vs_status status = vs_attempt_run(&plan, &trials[0], err);
  plan.gear = !gear;
  if (trials[0].cut) plan.until_s = trials[0].reached_s;
  if (!status) status = vs_attempt_run(&plan, &trials[1], err);
  const vs_judge_case c = {.scene = scene,
                           .gear = gear,
                           .now = &trials[0],
                           .other = &trials[1],
                           .watched = list->of,
                           .n_watched = list->count};
  if (!status) {
    vs_judge_method(&c, notes);
    vs_judge_ringing(&c, notes);
    vs_judge_comparators(&c, notes);
    add_table(&c, until_s, notes, &bench->table);
    vs_note_rows(notes, o->name, &bench->rows);
  }
  free(trials);
  free(notes);
  return status;
}

static vs_status try_scene(const vs_check_options *o, vs_scene *scene, vs_check_bench *bench,
                           vs_error *err) {
  vs_wiring wiring;
  vs_comparators *comparators = vs_alloc(1, sizeof *comparators);
  watch_list *list = vs_alloc(1, sizeof *list);
  vs_wiring_open(&wiring, &scene->setup.deck);
  vs_judge_find_comparators(&wiring, comparators);
  for (size_t k = 0; k < comparators->count; k++) watch(scene, &comparators->item[k], list);
  vs_status status = try_both(o, scene, list, bench, err);
  for (size_t k = 0; k < list->count; k++) vs_formula_free(&list->formula[k]);
  vs_wiring_free(&wiring);
  free(comparators);
  free(list);
  return status;
}

vs_status vs_hint_try(const vs_check_options *o, bool is_deck, vs_check_bench *bench,
                      vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = read_scene(o, is_deck, scene, err);
  if (!status && !scene->tier->has_circuit)
    vs_text_add(&bench->table, "\nnothing is tried: tier %s has no circuit; --set run.tier=circuit",
                scene->tier->name);
  else if (!status)
    status = try_scene(o, scene, bench, err);
  vs_scene_free(scene);
  free(scene);
  return status;
}
