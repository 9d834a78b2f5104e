/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/hint.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "diagnosis/floating.h"
#include "diagnosis/judge.h"

/* ---- before a run ---- */

void vs_hint_look(const vs_check_options *o, const vs_deck *deck, vs_check_bench *bench) {
  vs_wiring wiring;
  vs_notes *notes = vs_alloc(1, sizeof *notes);
  vs_comparators *comparators = vs_alloc(1, sizeof *comparators);
  vs_wiring_open(&wiring, deck);
  vs_floating_find(&wiring, notes);
  vs_comparator_find(&wiring, comparators);
  if (!o->deep) vs_comparator_note(comparators, notes); /* a trial measures them */
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
  vs_comparator_find(&wiring, comparators);
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
