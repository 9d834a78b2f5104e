/* SPDX-License-Identifier: GPL-3.0-or-later
 * The cheapest parts that hold: the study's keys, and what is made of them. The search is in
 * method/design_search.c, its answer in method/design_answer.c.
 *
 *   catalogue:
 *     prices: catalogue.csv              study/price_list.h
 *     choose:
 *       circuit.thyristor:  {kind: thyristor}                      all parts of that kind in it
 *       circuit.varistor_1: {kind: varistor, parts: [s20k510]}     these
 *       circuit.varistor_2: {same_as: circuit.varistor_1}
 *       circuit.varistor_3: {kind: varistor, or: none}           none: it is left out
 *       circuit.r1: {kind: resistor, series: E12, from: 47 ohm, to: 10 kohm}
 *       circuit.c1: {kind: capacitor}                              all values in the list
 *       circuit.r2: {kind: resistor, values: [1 kohm, 2.2 kohm], number: 2}
 *   aim: {least: price_eur + 0.02 * volume_cm3}    columns of the list; the default: price
 *   operation: {high: {supply.voltage: 484 V}}     the machine at work; threats come besides
 *   hold: {margin: 10 %, thyristor.v_reverse: 0.8, waive: [{line: thyristor.di_dt, because: ...}]}
 *   proof: {verify: true, search: {n: 400, restarts: 8}, random: 1000, neighbours: true}
 *   budget: {runs: 5000, jobs: 2}
 *
 * The list may have several rows for a resistor or a capacitor of one value. Their columns LIMIT
 * (p_rated_w, v_class_v) say what they bear; the cheapest that bears what the runs show is taken.
 * A row without a value is sold in any. */
#include "method/design_choices.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "method/design_answer.h"
#include "method/design_search.h"
#include "study/methods.h"

enum {
  DEFAULT_RANDOM = 1000,
  DEFAULT_SEARCHED = 400, /* within 1 % of dense grids (tests/long/worst.csv) */
  MOST_SEARCHED = 100000,
  DEFAULT_RESTARTS = 8,
  MOST_RESTARTS = 1000
};

/* ---- keys ---- */

static const vs_inside
    CATALOGUE = {.rows =
                     VS_ROWS({"prices", .kind = VS_NEEDED | VS_TEXT},
                             {"choose", VS_NEEDED | VS_MAP, .inside = &vs_design_choices_keys})},
    AIM = {.rows = VS_ROWS({"least", .kind = VS_NEEDED | VS_TEXT})},
    LINES = {.rows = VS_ROWS({.kind = VS_TEXT | VS_MAP, .inside = &vs_hold_waiver})},
    OF_DEVICE = {.rows = VS_ROWS({.kind = VS_PART})},
    HOLD = {.rows =
                VS_ROWS({"margin", .kind = VS_PART}, {"waive", VS_TEXT | VS_LIST, .inside = &LINES},
                        {.kind = VS_PART | VS_MAP, .inside = &OF_DEVICE})},
    SEARCH = {.rows = VS_ROWS({"n", .kind = VS_COUNT}, {"restarts", .kind = VS_COUNT})},
    PROOF = {.rows = VS_ROWS({"verify", .kind = VS_FLAG}, {"search", VS_MAP, .inside = &SEARCH},
                             {"random", .kind = VS_COUNT}, {"neighbours", .kind = VS_FLAG})},
    BUDGET = {.rows = VS_ROWS({"runs", .kind = VS_COUNT}, {"jobs", .kind = VS_COUNT})};
static const vs_field SECTION = {"catalogue", VS_MAP, .inside = &CATALOGUE};
static const vs_field BESIDES[] = {{"aim", VS_MAP, .inside = &AIM},
                                   {"operation", VS_MAP, .inside = &vs_design_cases_operation},
                                   {"hold", VS_MAP, .inside = &HOLD},
                                   {"proof", VS_MAP, .inside = &PROOF},
                                   {"budget", VS_MAP, .inside = &BUDGET},
                                   {0}};

static vs_status read_flag(const vs_node *map, const char *key, bool *flag, vs_error *err) {
  const vs_node *node = vs_tree_child(map, key);
  if (!node) return VS_OK;
  *flag = node->kind == VS_NODE_TEXT && !strcmp(node->text, "true");
  if (*flag || (node->kind == VS_NODE_TEXT && !strcmp(node->text, "false"))) return VS_OK;
  return vs_fail_at(err, node->where, "%s: true or false is wanted", key);
}

static vs_status read_map(const vs_plan *plan, const char *key, const vs_inside *inside,
                          const vs_node **map, vs_error *err) {
  *map = vs_tree_child(plan->tree.root, key);
  if (!*map) return VS_OK;
  if ((*map)->kind != VS_NODE_MAP)
    return vs_fail_at(err, (*map)->where, "%s: a map of keys is wanted", key);
  return vs_field_map_keys(*map, key, inside, err);
}

static vs_status read_search(const vs_node *proof, vs_design *d, vs_error *err) {
  const vs_node *search = proof ? vs_tree_child(proof, "search") : NULL;
  if (!search) return VS_OK;
  if (search->kind != VS_NODE_MAP)
    return vs_fail_at(err, search->where, "proof.search: {n: 400, restarts: 8} is wanted, or {}");
  d->searched = DEFAULT_SEARCHED;
  d->restarts = DEFAULT_RESTARTS;
  vs_status status = vs_axis_whole(search, "n", 1, MOST_SEARCHED, &d->searched, err);
  return status ? status : vs_axis_whole(search, "restarts", 1, MOST_RESTARTS, &d->restarts, err);
}

static vs_status read_besides(vs_plan *plan, vs_design *d, vs_error *err) {
  const vs_node *aim, *proof, *budget;
  vs_status status = read_map(plan, "aim", &AIM, &aim, err);
  if (!status) status = read_map(plan, "proof", &PROOF, &proof, err);
  if (!status) status = read_map(plan, "budget", &BUDGET, &budget, err);
  if (status) return status;
  d->aim = vs_tree_child(aim, "least");
  if (aim && (!d->aim || d->aim->kind != VS_NODE_TEXT))
    return vs_fail_at(err, aim->where, "aim: {least: price} is wanted, with a column of %s",
                      d->list.path);
  d->usual_aim = vs_tree_word(NULL, "price", vs_tree_place(plan->tree.root, "catalogue.prices"));
  if (!d->aim) d->aim = &d->usual_aim;
  status = vs_axis_whole(proof, "random", 0, 1000000, &d->random, err);
  if (!status) status = read_search(proof, d, err);
  if (!status) status = read_flag(proof, "neighbours", &d->neighbours, err);
  if (!status) status = read_flag(proof, "verify", &d->verify, err);
  if (!status) status = vs_axis_whole(budget, "runs", 1, VS_PLAN_CASES, &d->most_runs, err);
  return status ? status : vs_axis_whole(budget, "jobs", 1, 64, &d->width, err);
}

static vs_status read_prices(vs_plan *plan, vs_design *d, const vs_node *section, vs_error *err) {
  const vs_node *prices = vs_tree_child(section, "prices");
  char path[VS_PATH_SIZE];
  if (!prices)
    return vs_fail_at(err, section->where,
                      "catalogue: prices is wanted, a CSV file of parts with what they cost");
  vs_status status = vs_plan_find(prices, path, err);
  if (!status) status = vs_price_list_read(path, prices->where, &d->list, err);
  return status ? status : vs_plan_input(plan, path, err);
}

/* Adds the axis of run.verify, unless the scene asks for all errors, or the study for none. */
static vs_status add_verify(vs_plan *plan, vs_design *d, vs_error *err) {
  static const char KEY[] = "run.verify", *const WORDS[] = {"auto", "always"};
  const vs_where where = {plan->tree.name, 1, 1};
  const vs_node *run = vs_tree_child(plan->base->tree.root, "run"),
                *own = run ? vs_tree_child(run, "verify") : NULL;
  vs_axis *axis;
  const vs_node key = vs_tree_word(KEY, "", where);
  if (own && own->text && !strcmp(own->text, WORDS[1])) d->verify = false;
  if (!d->verify) return VS_OK;
  vs_status status = vs_plan_axis(plan, &key, "catalogue", &axis, err);
  if (status) return status;
  d->verify_axis = (size_t)(axis - plan->axes);
  axis->where = where;
  for (int w = 0; w < 2 && !status; w++) {
    const vs_node word = vs_tree_word(NULL, !w && own && own->text ? own->text : WORDS[w], where);
    status = vs_axis_values(axis, &word, err);
  }
  return status;
}

/* Error: another method has axes whose points would not be run. */
static vs_status refuse_others(const vs_plan *plan, const vs_node *section, vs_error *err) {
  for (size_t p = 0; p < plan->n_stages; p++) {
    const vs_method *m = plan->stages[p].method;
    if (m->draw || !strcmp(m->key, section->key)) continue;
    return vs_fail_at(err, section->key_where,
                      "catalogue: %s stands beside it; what is chosen stands under choose, what it "
                      "has to hold under operation, threats and spread",
                      m->key);
  }
  return VS_OK;
}

static vs_status read_design(vs_plan *plan, const vs_node *section, void **state, vs_error *err) {
  vs_design *d = *state = vs_alloc(1, sizeof *d);
  *d = (vs_design){.width = 2, .random = DEFAULT_RANDOM, .neighbours = true, .verify = true};
  d->most_runs = 1000000;
  const size_t kept = vs_error_count(err);
  vs_status status = vs_field_map_keys(section, "catalogue", &CATALOGUE, err);
  if (!status) status = refuse_others(plan, section, err);
  if (!status) status = read_prices(plan, d, section, err);
  if (!status) status = read_besides(plan, d, err);
  if (!status) status = vs_design_cases_read(plan, &d->cases, err);
  if (!status) status = add_verify(plan, d, err);
  if (!status && vs_error_count(err) == kept)
    status = vs_design_choices_read(plan, d, section, err);
  if (!status) status = vs_design_cases_check(plan, &d->cases, err);
  if (status || vs_error_count(err)) return status; /* the threats may be read in part */
  vs_design_cases_count(plan, &d->cases);
  return vs_design_choices_rank(section, d, err);
}

/* ---- lines ---- */

static size_t add_line(vs_design *d, const char *name, int column, vs_hold_line line) {
  vs_hold *h = &d->hold;
  d->line_name = vs_alloc_grow(d->line_name, h->count, sizeof *d->line_name);
  d->margin = vs_alloc_grow(d->margin, h->count, sizeof *d->margin);
  h->line = vs_alloc_grow(h->line, h->count, sizeof *h->line);
  snprintf(d->line_name[h->count], sizeof d->line_name[0], "%s", name);
  d->margin[h->count] = column;
  h->line[h->count] = line;
  h->line[h->count].part = 1;
  return h->count++;
}

/* The verdict's lines, then those that the list of prices has limits for. */
static void find_lines(const vs_plan *plan, vs_design *d) {
  char name[2 * VS_KEY_SIZE];
  for (size_t k = 0; k < plan->n_columns; k++) {
    const vs_report_column *c = &plan->columns[k];
    if (!c->line || strncmp(c->name, "margin.", 7)) continue;
    add_line(d, c->name + 7, (int)k,
             (vs_hold_line){
                 .limit = c->rating, .unit = c->limit_unit, .own = c->own, .sense = c->sense});
  }
  for (size_t k = 0; k < d->hold.count; k++) d->hold.line[k].name = d->line_name[k];
  for (size_t c = 0; c < d->n_choices; c++)
    for (size_t l = 0; l < d->choice[d->choice[c].leader].n_limits; l++) {
      snprintf(name, sizeof name, "%s.%s", d->choice[c].device,
               d->choice[d->choice[c].leader].measure[l]->name);
      d->choice[c].line[l] = vs_hold_find(&d->hold, name);
      if (d->choice[c].line[l] != SIZE_MAX) continue;
      d->choice[c].line[l] = add_line(d, name, -1, (vs_hold_line){.unit = "", .sense = 1});
      for (size_t k = 0; k < d->hold.count; k++) d->hold.line[k].name = d->line_name[k];
    }
}

static vs_status hold_or_waive(vs_hold *hold, const char *name, const vs_node *value,
                               vs_error *err) {
  return strcmp(name, "waive") ? vs_hold_one(hold, name, value, err) : VS_OK;
}

static vs_status ready_design(const vs_plan *plan, const vs_plan_stage *stage, vs_error *err) {
  vs_design *d = stage->state;
  const vs_tier *tier = plan->first->tier;
  const vs_node *hold = vs_tree_child(plan->tree.root, "hold");
  if (!tier->by_ngspice)
    return vs_fail_at(err, plan->scene_where,
                      "design: this scene runs on tier %s, and what decides is ngspice's; set: "
                      "{run.tier: circuit} is wanted, with a deck",
                      tier->name);
  if (plan->periods)
    return vs_fail_at(err, vs_tree_child(plan->tree.root, "steady")->where,
                      "design: its cases are runs; start: steady is wanted in place of steady");
  find_lines(plan, d);
  d->hold.where = "the verdicts of these candidates";
  d->hold.hint = "; no part that may be chosen states a limit for it, and no rating of the scene";
  d->waived = vs_tree_child(hold, "waive");
  vs_status status = vs_hold_each(&d->hold, hold, "hold", hold_or_waive, err);
  return status ? status : vs_hold_waive(&d->hold, d->waived, err);
}

/* ---- the method ---- */

static uint64_t count_design(const vs_plan *plan, const vs_plan_stage *stage) {
  const vs_design *d = stage->state;
  (void)plan;
  return d->most_runs;
}

static void free_design(void *state) {
  vs_design *d = state;
  for (size_t c = 0; d && c < d->n_choices + 1 && c < VS_DESIGN_CHOICES; c++) {
    for (size_t k = 0; k < d->choice[c].n_options; k++) free(d->choice[c].option[k].classes);
    free(d->choice[c].option);
  }
  if (!d) return;
  vs_price_list_free(&d->list);
  free(d->hold.line);
  free(d->line_name);
  free(d->margin);
  free(d->order);
  free(d);
}

/* The machine at work first: it may say keys that are chosen. */
static void put_design(const vs_plan *plan, const vs_plan_stage *stage, const double *value,
                       vs_tree *tree) {
  const vs_design *d = stage->state;
  const double *point = value - stage->axis;
  vs_design_choices_put_back(d, plan, tree);
  vs_design_cases_put(plan, &d->cases, point, tree);
  for (size_t c = 0; c < d->n_choices; c++) vs_design_choices_put(d, plan, c, point, tree);
  if (d->verify) vs_axis_put(&plan->axes[d->verify_axis], point[d->verify_axis], 12, tree);
}

static vs_status next_design(const vs_plan *plan, const vs_plan_stage *stage,
                             const vs_results *results, vs_generation *generation, vs_error *err) {
  vs_design_search s;
  (void)err;
  vs_design_search_run(&s, stage->state, plan, results, generation);
  vs_design_search_free(&s);
  return VS_OK;
}

/* How far a search has come that was stopped. */
static void say_design(const vs_plan *plan, const vs_plan_stage *stage, const vs_results *results,
                       vs_text *text) {
  vs_design_search s;
  vs_design_search_run(&s, stage->state, plan, results, NULL);
  vs_text_add(text, "nothing below %.6g holds", vs_design_search_bound(&s));
  if (s.answer)
    vs_text_add(text, "; a candidate of %.6g holds what it was run with", s.answer->price);
  vs_design_search_free(&s);
}

/* What pages and pictures go by: the run that came nearest to breaking the answer. */
static void json_design(const vs_plan *plan, const vs_plan_stage *stage, const vs_results *results,
                        vs_json *json) {
  vs_design_search s;
  vs_json_object(json, "catalogue", VS_JSON_ROW);
  vs_json_text(json, "least", ((const vs_design *)stage->state)->aim->text);
  if (results) {
    vs_design_search_run(&s, stage->state, plan, results, NULL);
    if (s.answer) {
      vs_json_object(json, "found", VS_JSON_ROW);
      vs_json_whole(json, "case", (int64_t)s.weakest_run);
      vs_json_end(json);
    } else
      vs_json_null(json, "found");
    vs_design_search_free(&s);
  }
  vs_json_end(json);
}

static const char *const LEAD[] = {NULL}, *const EACH[] = {"cloud", "cases", NULL};

const vs_method vs_design_method = {
    .name = "design",
    .key = "catalogue",
    .keys = &SECTION,
    .besides = BESIDES,
    .text = "search for the cheapest parts of a list of prices that hold all cases",
    .read = read_design,
    .ready = ready_design,
    .free = free_design,
    .count = count_design,
    .put = put_design,
    .takes_cases = true,
    .next = next_design,
    .json = json_design,
    .say = say_design,
    .publish = vs_design_answer_publish,
    .files = vs_design_answer_files,
    .report = {.lead = LEAD,
               .each = EACH,
               .best = "Cheapest that holds, its weakest case",
               .none = "None found that holds"}};
