/* SPDX-License-Identifier: GPL-3.0-or-later
 * The worst case: the largest or least value of one measure, searched for (study/method/search.h)
 * over all axes: where vary has a range, all of it; of a list, what it lists; of a spread of
 * sample's, its whole reach, whatever their correlation. What was found is the worst case that was
 * looked at, no bound. How far restarts from other places agree on it is told beside it.
 *
 *   find:
 *     worst: max thyristor.v_reverse     or min MEASURE
 *     n: 400                             cases at most; 100 for each axis
 *     restarts: 8                        local searches that share these
 *     seed: 7
 *     finest: 0.1 %                      of each axis: shorter steps end the search
 */
#include "study/methods.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/text.h"
#include "base/units.h"
#include "method/search.h"
#include "method/span.h"
#include "report_columns.h"

enum { PER_AXIS = 100, MOST_CASES = 100000, RESTARTS = 8, MOST_RESTARTS = 1000 };

typedef struct worst {
  int sense; /* 1: the least value is searched for; -1: the largest */
  int column;
  char measure[VS_JUDGED_NAME];
  uint64_t n; /* 0: the study does not say */
  uint64_t restarts;
  double finest;
  vs_search *search; /* it has been told of `done` results; NULL: it has not begun */
  uint64_t done;
} worst;

static void free_worst(void *state) {
  worst *w = state;
  if (w) vs_search_free(w->search);
  free(w);
}

static vs_status read_aim(vs_plan *plan, const vs_node *section, worst *w, vs_error *err) {
  const vs_node *node = vs_tree_child(section, "worst");
  const char *text = node && node->kind == VS_NODE_TEXT ? node->text : NULL;
  w->sense = !text ? 0 : !strncmp(text, "max ", 4) ? -1 : !strncmp(text, "min ", 4) ? 1 : 0;
  const char *measure = w->sense ? text + 4 + strspn(text + 4, " ") : "";
  if (!*measure || strchr(measure, ' ') || strlen(measure) >= sizeof w->measure)
    return vs_fail_at(err, node ? node->where : section->where,
                      "find.worst: 'max MEASURE' or 'min MEASURE' is wanted, for example 'max "
                      "thyristor.v_reverse'");
  snprintf(w->measure, sizeof w->measure, "%s", measure);
  w->column = vs_report_columns_add(plan, w->measure, node->where);
  return VS_OK;
}

static const vs_inside KEYS = {
    .rows = VS_ROWS({"worst", .kind = VS_NEEDED | VS_TEXT}, {"n", .kind = VS_COUNT},
                    {"restarts", .kind = VS_COUNT}, {"seed", .kind = VS_COUNT},
                    {"finest", .kind = VS_PART})};
static const vs_field FIND = {"find", VS_MAP, .inside = &KEYS};

static vs_status read_worst(vs_plan *plan, const vs_node *section, void **state, vs_error *err) {
  worst *w = *state = vs_alloc(1, sizeof *w);
  const vs_node *finest = vs_tree_child(section, "finest");
  char why[256];
  w->finest = 1e-3;
  w->restarts = RESTARTS;
  vs_status status = vs_field_map_keys(section, "find", &KEYS, err);
  if (!status) status = vs_error_keep(err, read_aim(plan, section, w, err));
  if (!status) status = vs_error_keep(err, vs_axis_whole(section, "n", 1, MOST_CASES, &w->n, err));
  if (!status)
    status =
        vs_error_keep(err, vs_axis_whole(section, "restarts", 1, MOST_RESTARTS, &w->restarts, err));
  if (!status)
    status =
        vs_error_keep(err, vs_axis_whole(section, "seed", 0, UINT64_MAX >> 12, &plan->seed, err));
  if (!status && finest &&
      (finest->kind != VS_NODE_TEXT ||
       !vs_units_read(finest->text, "", &w->finest, why, sizeof why) ||
       !(w->finest >= 1e-9 && w->finest <= 0.1)))
    status =
        vs_error_keep(err, vs_fail_at(err, finest->where,
                                      "find.finest: a part of each axis is wanted, 1e-9 to 10 %%"));
  if (!status && !plan->n_axes)
    status = vs_fail_at(err, section->where,
                        "find: nowhere to look; name axes under vary or sample.spread");
  return status;
}

static uint64_t worst_count(const vs_plan *plan, const vs_plan_stage *stage) {
  const worst *w = stage->state;
  return w->n ? w->n : PER_AXIS * plan->n_axes;
}

_Static_assert((int)VS_PLAN_AXES <= (int)VS_SEARCH_AXES, "all axes of a plan can be searched");

static vs_search *begin_worst_search(const vs_plan *plan, const vs_plan_stage *stage) {
  const worst *w = stage->state;
  vs_search_setup setup = {.axes = plan->n_axes,
                           .seed = plan->seed,
                           .most = (size_t)worst_count(plan, stage),
                           .restarts = (size_t)w->restarts,
                           .finest = w->finest};
  for (size_t d = 0; d < plan->n_axes; d++) {
    setup.levels[d] = (int)vs_span_levels(&plan->axes[d]);
    setup.period[d] = vs_span_period(plan, &plan->axes[d]);
  }
  return vs_search_new(&setup);
}

/* Tells the search of the results from `done` on, generation by generation, and returns how many of
 * them it then knows. phases: a list to which the search's phases are added, with the case each
 * began with; NULL: none is wanted. */
static uint64_t replay_results(vs_search *search, const worst *w, const vs_results *results,
                               uint64_t done, vs_json *phases) {
  const char *phase = "";
  for (size_t count; vs_search_ask(search, &count), count && done + count <= results->count;) {
    if (phases && strcmp(phase, vs_search_phase(search))) {
      phase = vs_search_phase(search);
      vs_json_object(phases, NULL, VS_JSON_ROW);
      vs_json_text(phases, "phase", phase);
      vs_json_whole(phases, "case", (int64_t)done);
      vs_json_end(phases);
    }
    double *values = vs_alloc(count, sizeof *values);
    for (size_t k = 0; k < count; k++)
      values[k] = w->sense * vs_plan_results_value(results, done + k, w->column);
    vs_search_tell(search, values);
    free(values);
    done += count;
  }
  return done;
}

static vs_status worst_next(const vs_plan *plan, const vs_plan_stage *stage,
                            const vs_results *results, vs_generation *generation, vs_error *err) {
  (void)err;
  worst *w = stage->state;
  size_t count;
  if (!w->search ||
      results->count < w->done) { /* begins anew; otherwise it goes on where it stands */
    vs_search_free(w->search);
    w->search = begin_worst_search(plan, stage);
    w->done = 0;
  }
  w->done = replay_results(w->search, w, results, w->done, NULL);
  const double *points = vs_search_ask(w->search, &count);
  for (size_t k = 0; k < count; k++) {
    double value[VS_PLAN_AXES];
    for (size_t d = 0; d < plan->n_axes; d++)
      value[d] = vs_span_between(&plan->axes[d], points[k * plan->n_axes + d]);
    vs_plan_generation_add(generation, value);
  }
  return VS_OK;
}

/* Returns the case whose value is the worst of all; UINT64_MAX: no case has a value. */
static uint64_t find_best(const worst *w, const vs_results *results) {
  uint64_t best = UINT64_MAX;
  double value = NAN;
  for (uint64_t k = 0; k < results->count; k++) {
    double now = w->sense * vs_plan_results_value(results, k, w->column);
    if (isnan(now) || !(isnan(value) || now < value)) continue;
    value = now;
    best = k;
  }
  return best;
}

/* What a search found, and how many of its restarts came there. */
typedef struct finding {
  uint64_t best;                /* its case; UINT64_MAX: no case has a value */
  double value;                 /* of its measure, in the column's unit */
  size_t restarts, place, near; /* begun; that ended at its place; whose value is near to it */
} finding;

static finding find_worst(const worst *w, const vs_search *search, const vs_results *results) {
  finding f = {.best = find_best(w, results), .restarts = vs_search_restarts(search)};
  if (f.best == UINT64_MAX) return f;
  f.value = vs_plan_results_value(results, f.best, w->column);
  f.place = vs_search_agree(search, &f.near);
  return f;
}

/* Says the finding in words, for the table and the report. */
static void say_finding(const vs_plan *plan, const worst *w, const finding *f, uint64_t count,
                        vs_text *text) {
  const vs_report_column *column = w->column == VS_COLUMN_MARGIN ? NULL : &plan->columns[w->column];
  if (f->best == UINT64_MAX) {
    vs_text_add(text, "no case of %llu has a value of %s", (unsigned long long)count, w->measure);
    return;
  }
  vs_text_add(text, "the worst found in %llu cases is %s %.6g%s%s, case %llu; ",
              (unsigned long long)count, w->measure, f->value, column && *column->unit ? " " : "",
              column ? column->unit : "", (unsigned long long)f->best);
  if (f->restarts > 1)
    vs_text_add(text,
                "of %zu restarts %zu came to its place and %zu to its value, within %g %% of each "
                "axis and of the value; ",
                f->restarts, f->place, f->near, 100 * VS_SEARCH_AGREE);
  else
    vs_text_add(text, "a single search tells nothing of other places: raise n or restarts; ");
  if (plan->base->tier->has_circuit && plan->base->setup.run.verify != VS_VERIFY_ALWAYS)
    vs_text_add(text, "its row may lack the error of the margin: run.verify: always finds it; ");
  vs_text_add(text, "this is no bound");
}

static void say_worst(const vs_plan *plan, const vs_plan_stage *stage, const vs_results *results,
                      vs_text *text) {
  const worst *w = stage->state;
  vs_search *search = begin_worst_search(plan, stage);
  replay_results(search, w, results, 0, NULL);
  const finding f = find_worst(w, search, results);
  say_finding(plan, w, &f, results->count, text);
  vs_search_free(search);
}

static void add_found(const vs_plan *plan, const vs_plan_stage *stage, const vs_results *results,
                      vs_json *json) {
  const worst *w = stage->state;
  vs_search *search = begin_worst_search(plan, stage);
  vs_text text = {0};
  vs_json_array(json, "phases", VS_JSON_ROW);
  replay_results(search, w, results, 0, json);
  vs_json_end(json);
  const finding f = find_worst(w, search, results);
  vs_search_free(search);
  vs_json_whole(json, "n", (int64_t)results->count);
  vs_json_whole(json, "restarts", (int64_t)f.restarts);
  if (f.best == UINT64_MAX) {
    vs_json_null(json, "found");
  } else {
    vs_json_object(json, "found", VS_JSON_ROW);
    vs_json_whole(json, "case", (int64_t)f.best);
    vs_json_number(json, "value", f.value, 12);
    vs_json_whole(json, "agree_place", (int64_t)f.place);
    vs_json_whole(json, "agree_value", (int64_t)f.near);
    vs_json_number(json, "agree_within", VS_SEARCH_AGREE, 12);
    vs_json_end(json);
  }
  say_worst(plan, stage, results, &text);
  vs_json_text(json, "says", text.text);
  vs_text_free(&text);
}

static void worst_json(const vs_plan *plan, const vs_plan_stage *stage, const vs_results *results,
                       vs_json *json) {
  const worst *w = stage->state;
  char aim[VS_JUDGED_NAME + 8];
  snprintf(aim, sizeof aim, "%s %s", w->sense < 0 ? "max" : "min", w->measure);
  vs_json_object(json, "find", VS_JSON_ROW);
  vs_json_text(json, "worst", aim);
  vs_json_number(json, "finest", w->finest, 12);
  if (results) add_found(plan, stage, results, json);
  vs_json_end(json);
}

static const char *const LEAD[] = {"path", "cloud", NULL}, *const EACH[] = {"cases", NULL};

const vs_method vs_worst_method = {
    .name = "worst",
    .key = "find",
    .keys = &FIND,
    .text = "search for the worst value from many places; no bound",
    .read = read_worst,
    .free = free_worst,
    .count = worst_count,
    .next = worst_next,
    .json = worst_json,
    .say = say_worst,
    .report = {.lead = LEAD, .each = EACH, .aim = "worst", .best = "Worst found"}};
