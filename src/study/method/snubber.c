/* SPDX-License-Identifier: GPL-3.0-or-later
 * The cheapest snubber that holds: a search (study/method/search.h) over the axes under vary, R1
 * and C1 or more. A candidate is run with the scene as it is and, when it holds there, at every
 * point of sample (n of it, or its corners). It holds when in each of these runs no measure is more
 * than (1 - margin) of its rating and no rating of the deck is violated; a measure that a run does
 * not know is within none. What stands under vary may stand under sample.spread, too: its
 * tolerance, in %, is then one of the candidate's own value.
 *
 *   snubber:
 *     ratings: {thyristor.v_reverse: part, thyristor.di_dt: 100 A/us, r1.power: 2 W}
 *                            part: the limit in the part's file
 *     margin: 20 %
 *     n: 160                 candidates at most; 80 for each axis under vary
 *     seed: 7
 *     finest: 1 %            of each axis: shorter steps end the search
 *
 * Cheapest: the least energy that its parts must hold and burn in one cycle of the mains, in
 * joules: the sum of C*v_peak^2/2 over the capacitors under vary and of power/f over the resistors,
 * of the candidate's worst run. Of candidates that do not hold, the one that is over its ratings by
 * less is better; and all of them are worse than any that holds. */
#include "study/methods.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/units.h"
#include "method/search.h"
#include "method/span.h"
#include "report_columns.h"

enum { PER_AXIS = 80, MOST_CANDIDATES = 10000, RATINGS = 16 };

typedef struct rating {
  const vs_node *node;
  int column;
  double limit; /* in the column's unit; known once the columns are */
} rating;

/* What one axis adds to the energy. */
typedef struct price {
  int column;   /* the column of v_peak or power */
  double farad; /* the axis' unit in F; 0: the axis is a resistor */
} price;

typedef struct snubber {
  rating ratings[RATINGS];
  size_t n_ratings;
  price prices[VS_PLAN_AXES]; /* of each axis under vary */
  double cycle_s;
  double margin, finest;
  uint64_t n;                  /* 0: the study does not say */
  const vs_plan_stage *sample; /* the stage of sample; NULL: there is none */
  size_t n_design;             /* how many axes stand under vary; these come first */
} snubber;

/* ---- reading ---- */

static vs_status read_part_of_one(const vs_node *section, const char *key, double most,
                                  double *value, vs_error *err) {
  const vs_node *node = vs_tree_child(section, key);
  char why[256];
  if (!node) return VS_OK;
  if (node->kind == VS_NODE_TEXT && vs_units_read(node->text, "", value, why, sizeof why) &&
      *value >= 0 && *value < most)
    return VS_OK;
  return vs_fail_at(err, node->where, "snubber.%s: 0 or more and less than %g %% is wanted", key,
                    100 * most);
}

static vs_status read_ratings(vs_plan *plan, const vs_node *section, snubber *s, vs_error *err) {
  const vs_node *map = vs_tree_child(section, "ratings");
  if (!map || map->kind != VS_NODE_MAP || !map->child)
    return vs_fail_at(
        err, map ? map->where : section->where,
        "snubber.ratings: a map is wanted: {thyristor.v_reverse: part, r1.power: 2 W}");
  vs_status status = VS_OK;
  for (const vs_node *node = map->child; node && !status; node = node->next) {
    if (node->kind != VS_NODE_TEXT || strlen(node->key) >= VS_JUDGED_NAME ||
        s->n_ratings == RATINGS)
      status = vs_fail_at(err, node->where,
                          "snubber.ratings: up to %d of MEASURE: LIMIT or MEASURE: part are wanted",
                          RATINGS);
    else
      s->ratings[s->n_ratings++] =
          (rating){node, vs_report_columns_add(plan, node->key, node->where), NAN};
    status = vs_error_keep(err, status);
  }
  return status;
}

/* Each axis under vary must be a resistor or a capacitor of the deck, and a device of it, so that
 * it has a price. */
static vs_status read_prices(vs_plan *plan, const vs_node *section, snubber *s, vs_error *err) {
  char measure[VS_KEY_SIZE + 16];
  s->cycle_s = 1 / plan->base->setup.timeline.supply.frequency_hz;
  const size_t n = s->sample ? s->sample->axis : plan->n_axes;
  for (; s->n_design < n; s->n_design++) {
    const vs_axis *axis = &plan->axes[s->n_design];
    const bool c = vs_units_same_kind(axis->unit, "F"), r = vs_units_same_kind(axis->unit, "ohm");
    const char *name = strrchr(axis->key, '.');
    if (axis->is_word || strncmp(axis->key, "circuit.", 8) || !(c || r))
      return vs_fail_at(err, axis->where,
                        "snubber: vary holds its resistors and capacitors, as circuit.r1 and "
                        "circuit.c1 are; what else is uncertain stands under sample.spread");
    snprintf(measure, sizeof measure, "%s.%s", name + 1, c ? "v_peak" : "power");
    if (strlen(measure) >= VS_JUDGED_NAME)
      return vs_fail_at(err, axis->where, "snubber: the name is too long");
    s->prices[s->n_design] = (price){vs_report_columns_add(plan, measure, axis->where),
                                     c ? vs_units_factor(axis->unit) : 0};
  }
  if (s->n_design) return VS_OK;
  return vs_fail_at(err, section->where,
                    "snubber: vary is wanted, with the ranges of circuit.r1 and circuit.c1");
}

static const vs_inside LIMITS = {.rows = VS_ROWS({.kind = VS_TEXT})};
static const vs_inside KEYS = {.rows = VS_ROWS({"ratings", VS_NEEDED | VS_MAP, .inside = &LIMITS},
                                               {"margin", .kind = VS_PART}, {"n", .kind = VS_COUNT},
                                               {"seed", .kind = VS_COUNT},
                                               {"finest", .kind = VS_PART})};
static const vs_field SNUBBER = {"snubber", VS_MAP, .inside = &KEYS};

static vs_status read_snubber(vs_plan *plan, const vs_node *section, void **state, vs_error *err) {
  snubber *s = *state = vs_alloc(1, sizeof *s);
  s->margin = 0.2;
  s->finest = 0.01;
  for (size_t p = 0; p < plan->n_stages; p++)
    if (plan->stages[p].method->uncertain) s->sample = &plan->stages[p];
  vs_status status = vs_field_map_keys(section, "snubber", &KEYS, err);
  if (!status) status = vs_error_keep(err, read_ratings(plan, section, s, err));
  if (!status) status = vs_error_keep(err, read_part_of_one(section, "margin", 1, &s->margin, err));
  if (!status)
    status = vs_error_keep(err, read_part_of_one(section, "finest", 0.1, &s->finest, err));
  if (!status)
    status = vs_error_keep(err, vs_axis_whole(section, "n", 1, MOST_CANDIDATES, &s->n, err));
  if (!status)
    status =
        vs_error_keep(err, vs_axis_whole(section, "seed", 0, UINT64_MAX >> 12, &plan->seed, err));
  return status ? status : read_prices(plan, section, s, err);
}

static vs_status take_limit(const vs_plan *plan, rating *r, vs_error *err) {
  char why[256];
  double si;
  if (r->column == VS_COLUMN_MARGIN)
    return vs_fail_at(err, r->node->key_where,
                      "snubber.ratings: margin_least is no measure; what "
                      "it says is asked for anyway");
  const vs_report_column *column = &plan->columns[r->column];
  if (!strcmp(r->node->text, "part")) {
    r->limit = column->rating;
    if (!isnan(r->limit)) return VS_OK;
    return vs_fail_at(err, r->node->where,
                      "snubber.ratings: no part's file has a limit for %s; write one, in %s",
                      column->name, *column->unit ? column->unit : "a plain number");
  }
  if (!vs_units_read(r->node->text, column->unit, &si, why, sizeof why))
    return vs_fail_at(err, r->node->where, "snubber.ratings: %s: %s", column->name, why);
  r->limit = si / vs_units_factor(column->unit);
  if (r->limit != 0) return VS_OK;
  return vs_fail_at(err, r->node->where, "snubber.ratings: %s: nothing holds a limit of 0",
                    column->name);
}

static vs_status ready_snubber(const vs_plan *plan, const vs_plan_stage *stage, vs_error *err) {
  snubber *s = stage->state;
  vs_status status = VS_OK;
  for (size_t k = 0; k < s->n_ratings && !status; k++)
    status = vs_error_keep(err, take_limit(plan, &s->ratings[k], err));
  return status;
}

static uint64_t candidates(const vs_plan *plan, const snubber *s) {
  (void)plan;
  return s->n ? s->n : PER_AXIS * s->n_design;
}

static uint64_t spreads(const vs_plan *plan, const snubber *s) {
  return s->sample ? s->sample->method->count(plan, s->sample) : 0;
}

static uint64_t count_snubber(const vs_plan *plan, const vs_plan_stage *stage) {
  const snubber *s = stage->state;
  return candidates(plan, s) * (1 + spreads(plan, s));
}

/* ---- judging ---- */

/* What is known of one candidate. */
typedef struct candidate {
  uint64_t nominal, first; /* its cases: the one with the scene as it is; the first with a spread */
  uint64_t runs;           /* how many cases it has in all */
  double over; /* how much more than allowed it has in its worst run, relative to what is allowed */
  double cost_j; /* of its worst run */
  bool failed;   /* a run of it failed, or does not know one of the rated measures, or its verdict
                    is undecided */
} candidate;

/* Returns what is left of a rating, relative to its limit, as the verdict has it: a peak must be
 * below its limit, a turn-off time above. */
static double left_of(const rating *r, const vs_results *results, uint64_t index) {
  double value = vs_plan_results_value(results, index, r->column);
  bool at_least = results->plan->columns[r->column].at_least;
  return (at_least ? value - r->limit : r->limit - value) / fabs(r->limit);
}

static void judge_candidate(const snubber *s, const vs_results *results, uint64_t index,
                            candidate *c) {
  const double *point = &results->points[index * results->plan->n_axes];
  double margin = vs_plan_results_value(results, index, VS_COLUMN_MARGIN);
  double over = fmax(0, -margin), cost_j = 0;
  for (size_t k = 0; k < s->n_ratings; k++) {
    double left = left_of(&s->ratings[k], results, index);
    c->failed |= isnan(
        left); /* a measure that is not known is not held, as in a run that ends before turn-off */
    over += fmax(0, (s->margin - left) / (1 - s->margin));
  }
  for (size_t d = 0; d < s->n_design; d++) {
    double x = vs_plan_results_value(results, index, s->prices[d].column);
    cost_j += s->prices[d].farad != 0 ? s->prices[d].farad * point[d] * x * x / 2 : x * s->cycle_s;
  }
  c->runs++;
  c->failed |= results->status[index] == 1 || isnan(cost_j);
  c->failed |=
      results->status[index] == 3 && !(margin < 0); /* a line of the verdict is undecided */
  c->over = fmax(c->over, over);
  c->cost_j = fmax(c->cost_j, cost_j);
}

static bool candidate_holds(const candidate *c) {
  return !c->failed && c->over == 0;
}

/* What the search makes least. Below 1 the candidate holds, and its cost decides; from 1 on it does
 * not, and what it is over decides. */
static double merit(const candidate *c) {
  return c->failed ? NAN : c->over > 0 ? 1 + c->over : c->cost_j / (1 + c->cost_j);
}

/* ---- the search ---- */

typedef struct hunt {
  const vs_plan *plan;
  const snubber *s;
  const vs_results *results;
  vs_search *search;
  const double *points; /* the points of the present generation */
  candidate *candidate;
  size_t count;
  uint64_t used;             /* how many of the results were looked at */
  vs_generation *generation; /* where new cases are asked for; NULL: none are */
} hunt;

_Static_assert((int)VS_PLAN_AXES <= (int)VS_SEARCH_AXES, "all axes of a plan can be searched");

static vs_search *begin_snubber_search(const vs_plan *plan, const snubber *s) {
  vs_search_setup setup = {.axes = s->n_design,
                           .seed = plan->seed,
                           .most = (size_t)candidates(plan, s),
                           .finest = s->finest};
  for (size_t d = 0; d < s->n_design; d++) setup.levels[d] = (int)vs_span_levels(&plan->axes[d]);
  return vs_search_new(&setup);
}

/* Asks for a case of candidate k. sample is the index of a point of the spread; UINT64_MAX: the
 * scene is as it is. */
static void add_case(const hunt *h, size_t k, uint64_t sample) {
  double value[VS_PLAN_AXES];
  for (size_t d = 0; d < h->plan->n_axes; d++)
    value[d] = d < h->s->n_design
                   ? vs_span_between(&h->plan->axes[d], h->points[k * h->s->n_design + d])
                   : vs_span_nominal(&h->plan->axes[d]);
  if (sample != UINT64_MAX)
    h->s->sample->method->point(h->plan, h->s->sample, sample, value + h->s->sample->axis);
  for (size_t d = h->s->n_design; d < h->plan->n_axes; d++) {
    const vs_axis *axis = &h->plan->axes[d];
    if (axis->about) value[d] *= value[axis->about - 1] / vs_span_nominal(axis);
  }
  vs_plan_generation_add(h->generation, value);
}

/* Judges every candidate with the scene as it is. false: these cases are not run yet, and are asked
 * for. */
static bool nominal_runs(hunt *h) {
  const bool known = h->used + h->count <= h->results->count;
  for (size_t k = 0; k < h->count; k++) {
    h->candidate[k] = (candidate){.nominal = h->used + k};
    if (known)
      judge_candidate(h->s, h->results, h->used + k, &h->candidate[k]);
    else if (h->generation)
      add_case(h, k, UINT64_MAX);
  }
  if (known) h->used += h->count;
  return known;
}

/* Judges the candidates that held at all points of the spread. false: these cases are not run yet,
 * and are asked for. */
static bool spread_runs(hunt *h) {
  const uint64_t n = spreads(h->plan, h->s);
  uint64_t wanted = 0;
  for (size_t k = 0; k < h->count; k++) wanted += candidate_holds(&h->candidate[k]) ? n : 0;
  const bool known = h->used + wanted <= h->results->count;
  for (size_t k = 0; k < h->count; k++) {
    candidate *c = &h->candidate[k];
    if (!candidate_holds(c)) continue;
    c->first = h->used;
    for (uint64_t i = 0; i < n; i++)
      if (known)
        judge_candidate(h->s, h->results, h->used++, c);
      else if (h->generation)
        add_case(h, k, i);
  }
  return known;
}

/* Goes through the results, generation by generation, and calls each(ctx, candidate). At their end
 * it asks for the next cases. */
static void go_through_results(hunt *h, void (*each)(void *ctx, const candidate *), void *ctx) {
  bool known = true;
  h->search = begin_snubber_search(h->plan, h->s);
  while (known && (h->points = vs_search_ask(h->search, &h->count), h->count)) {
    double *values = vs_alloc(h->count, sizeof *values);
    h->candidate = vs_alloc(h->count, sizeof *h->candidate);
    known = nominal_runs(h) && spread_runs(h);
    for (size_t k = 0; k < h->count && known; k++) {
      values[k] = merit(&h->candidate[k]);
      if (each) each(ctx, &h->candidate[k]);
    }
    if (known) vs_search_tell(h->search, values);
    free(h->candidate);
    free(values);
  }
  vs_search_free(h->search);
}

static vs_status next_snubber(const vs_plan *plan, const vs_plan_stage *stage,
                              const vs_results *results, vs_generation *generation, vs_error *err) {
  (void)err;
  hunt h = {.plan = plan, .s = stage->state, .results = results, .generation = generation};
  go_through_results(&h, NULL, NULL);
  return VS_OK;
}

/* ---- manifest ---- */

typedef struct list {
  vs_json *json;
  candidate best; /* the cheapest of those that hold */
  uint64_t held;
} list;

static void list_candidate(void *ctx, const candidate *c) {
  list *l = ctx;
  vs_json_object(l->json, NULL, VS_JSON_ROW);
  vs_json_whole(l->json, "case", (int64_t)c->nominal);
  vs_json_whole(l->json, "spread", (int64_t)c->first);
  vs_json_whole(l->json, "runs", (int64_t)c->runs);
  vs_json_bool(l->json, "holds", candidate_holds(c));
  vs_json_number(l->json, "over", c->failed ? NAN : c->over, 12);
  vs_json_number(l->json, "cost_j", c->failed ? NAN : c->cost_j, 12);
  vs_json_end(l->json);
  if (candidate_holds(c) && (!l->held || c->cost_j < l->best.cost_j)) l->best = *c;
  l->held += candidate_holds(c);
}

static void add_ratings(const vs_plan *plan, const snubber *s, vs_json *json) {
  vs_json_array(json, "ratings", VS_JSON_ROW);
  for (size_t k = 0; k < s->n_ratings; k++) {
    const vs_report_column *c = &plan->columns[s->ratings[k].column];
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_text(json, "name", c->name);
    vs_json_text(json, "unit", c->unit);
    vs_json_number(json, "limit", s->ratings[k].limit, 12);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_candidates(const vs_plan *plan, const snubber *s, const vs_results *results,
                           vs_json *json) {
  list l = {.json = json};
  hunt h = {.plan = plan, .s = s, .results = results};
  vs_json_array(json, "candidates", VS_JSON_ROW);
  go_through_results(&h, list_candidate, &l);
  vs_json_end(json);
  if (!l.held) {
    vs_json_null(json, "found");
    return;
  }
  vs_json_object(json, "found", VS_JSON_ROW);
  vs_json_whole(json, "case", (int64_t)l.best.nominal);
  vs_json_number(json, "cost_j", l.best.cost_j, 12);
  vs_json_end(json);
}

static void json_snubber(const vs_plan *plan, const vs_plan_stage *stage, const vs_results *results,
                         vs_json *json) {
  const snubber *s = stage->state;
  vs_json_object(json, "snubber", VS_JSON_ROW);
  vs_json_number(json, "margin", s->margin, 12);
  vs_json_number(json, "finest", s->finest, 12);
  add_ratings(plan, s, json);
  vs_json_text(json, "cost",
               "energy that the varied parts hold and burn in one cycle: sum of C*v_peak^2/2 and "
               "power/f");
  vs_json_text(json, "cost_unit", "J");
  if (results) add_candidates(plan, s, results, json);
  vs_json_end(json);
}

static const char *const LEAD[] = {"feasible", NULL}, *const EACH[] = {"map", "cloud", "cases",
                                                                       NULL};

const vs_method vs_snubber_method = {
    .name = "snubber",
    .key = "snubber",
    .keys = &SNUBBER,
    .tolerates = true,
    .text = "search for the cheapest snubber that keeps its ratings over all spreads",
    .read = read_snubber,
    .ready = ready_snubber,
    .free = free,
    .count = count_snubber,
    .next = next_snubber,
    .json = json_snubber,
    .report = {.lead = LEAD,
               .each = EACH,
               .best = "Cheapest that holds",
               .none = "None found that holds over the spread"}};
