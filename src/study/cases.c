/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cases.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "work/case.h"

void vs_cases_free(vs_cases *c) {
  free(c->points);
  free(c->values);
  free(c->status);
  *c = (vs_cases){0};
}

void vs_cases_point(const vs_cases *c, uint64_t index, double *point) {
  const size_t axes = c->plan->n_axes;
  if (c->plan->adaptive)
    memcpy(point, c->points + index * axes, axes * sizeof *point);
  else
    vs_plan_point(c->plan, index, point);
}

/* ---- rows that are there already ---- */

static vs_status check_row(const vs_cases *c, vs_case *one, uint64_t index, vs_error *err) {
  double point[VS_PLAN_AXES];
  vs_text row = {0};
  char why[256];
  bool failed;
  vs_cases_point(c, index, point);
  vs_status status = vs_journal_row(c->journal, index, &row, &failed, err);
  if (!status && !vs_case_is_row(one, index, point, failed, row.text, why, sizeof why))
    status = vs_fail_at(err, (vs_where){c->journal->path, 1, 1},
                        "case %llu: %s; this record is of another study, or was changed",
                        (unsigned long long)index, why);
  vs_text_free(&row);
  return status;
}

vs_status vs_cases_check(const vs_cases *c, uint64_t first, uint64_t until, vs_error *err) {
  const vs_head *head = &c->journal->head;
  vs_case *one = vs_case_new(c->plan, NULL);
  vs_status status = VS_OK;
  for (uint64_t k = first; k < until && !status; k++)
    if (k % head->shards + 1 == head->shard && vs_journal_has(c->journal, k))
      status = check_row(c, one, k, err);
  vs_case_free(one);
  return status;
}

/* ---- a search ---- */

void vs_cases_ask(vs_cases *c, uint64_t count, const vs_generation *g) {
  const size_t axes = c->plan->n_axes, width = 1 + c->plan->n_columns;
  const uint64_t need = count + g->count;
  if (need > c->room) {
    c->room = 2 * need;
    c->points = vs_resize(c->points, c->room * axes, sizeof *c->points);
    c->values = vs_resize(c->values, c->room * width, sizeof *c->values);
    c->status = vs_resize(c->status, c->room, sizeof *c->status);
  }
  memcpy(c->points + count * axes, g->points, g->count * axes * sizeof *c->points);
}

static vs_status take_answer(vs_cases *c, uint64_t index, vs_error *err) {
  const size_t width = 1 + c->plan->n_columns;
  double *value = c->values + index * width;
  vs_text row = {0};
  bool failed = false;
  vs_status status = vs_journal_row(c->journal, index, &row, &failed, err);
  for (size_t k = 0; k < width; k++) value[k] = NAN;
  c->status[index] = VS_CASE_FAILED;
  if (!status && !failed) vs_case_values(c->plan, row.text, value, &c->status[index]);
  vs_text_free(&row);
  return status;
}

vs_status vs_cases_answer(vs_cases *c, uint64_t first, uint64_t until, vs_error *err) {
  vs_status status = VS_OK;
  for (uint64_t k = first; k < until && !status; k++) status = take_answer(c, k, err);
  return status;
}

vs_results vs_cases_results(const vs_cases *c, uint64_t count) {
  return (vs_results){c->plan, count, c->points, c->values, c->status};
}
