/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/branch_parameter.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"

vs_status vs_branch_parameter_move(vs_branch_parameter *a, double key, vs_error *err) {
  vs_axis_put(&a->axis, key, 17, &a->scene->tree);
  return vs_scene_reread(a->scene, err);
}

/* Sections whose keys say where a run begins and what is shown of it: the orbit is the same. */
static vs_status refuse_key(const vs_branch_parameter *a, vs_error *err) {
  static const char *const IDLE[] = {"run", "start", "measure"};
  const vs_axis *axis = &a->axis;
  if (axis->is_word || axis->field->kind == VS_COUNT)
    return vs_fail_at(err, axis->where,
                      "%s has %s for values; a branch is followed over a key that changes "
                      "continuously, such as firing.angle",
                      axis->key, axis->is_word ? "words" : "whole numbers");
  for (size_t k = 0; k < sizeof IDLE / sizeof *IDLE; k++)
    if (!strcmp(axis->section, IDLE[k]))
      return vs_fail_at(err, axis->where,
                        "%s: no orbit depends on it; name a key of the machine, its actuator, "
                        "load, supply or firing",
                        axis->key);
  return VS_OK;
}

static vs_status read_end_of_range(vs_branch_parameter *a, const char *text, double *end,
                                   vs_error *err) {
  const vs_node node = vs_tree_word(NULL, text, a->axis.where);
  return vs_axis_number(&a->axis, &node, end, err);
}

static vs_status read_step(vs_branch_parameter *a, const char *step, vs_error *err) {
  double range = fabs(a->to - a->from);
  char why[256] = "";
  a->step = range / VS_ALONG_POINTS;
  if (!step) return VS_OK;
  bool known = vs_units_read(step, a->axis.unit, &a->step, why, sizeof why);
  a->step /= vs_units_factor(a->axis.unit);
  if (known && a->step > 0 && a->step <= range) return VS_OK;
  return vs_fail(err, VS_INPUT, "--step %s: %s%smore than 0 and at most the range, %g%s%s", step,
                 why, *why ? "; " : "allowed: ", range, *a->axis.unit ? " " : "", a->axis.unit);
}

static vs_status read_at(vs_branch_parameter *a, const char *at, vs_error *err) {
  vs_where where = {.file = "--at"};
  a->at = NAN;
  if (!at) return VS_OK;
  const vs_node node = vs_tree_word(NULL, at, where);
  vs_status status = vs_axis_number(&a->axis, &node, &a->at, err);
  if (status || (a->at - a->from) * (a->at - a->to) <= 0) return status;
  return vs_fail(err, VS_INPUT, "--at %s: allowed: in the range, %g..%g%s%s", at, a->from, a->to,
                 *a->axis.unit ? " " : "", a->axis.unit);
}

/* The key and its range, of which `words` is cut up. */
static vs_status read_range_of_key(vs_branch_parameter *a, char *words, vs_error *err) {
  const vs_where where = {.file = a->place};
  char *sign = strchr(words, '='), *dots = sign ? strstr(sign, "..") : NULL;
  if (!dots || sign == words)
    return vs_fail_at(err, where, "KEY=FROM..TO is wanted, as --along firing.angle=130deg..80deg");
  *sign = *dots = '\0';
  vs_node node = vs_tree_word(words, "", where);
  node.key_where = where;
  vs_status status = vs_axis_init(&a->axis, a->scene, &node, "along", err);
  if (!status) status = refuse_key(a, err);
  if (!status) status = read_end_of_range(a, sign + 1, &a->from, err);
  if (!status) status = read_end_of_range(a, dots + 2, &a->to, err);
  if (!status && a->from == a->to)
    status = vs_fail_at(err, where, "%s: the range ends where it begins", a->axis.key);
  return status;
}

vs_status vs_branch_parameter_read(vs_branch_parameter *a, vs_scene *scene,
                                   const vs_branch_parameter_words *w, vs_error *err) {
  *a = (vs_branch_parameter){.scene = scene};
  snprintf(a->place, sizeof a->place, "--along %s", w->range);
  char *words = vs_copy(w->range);
  vs_status status = read_range_of_key(a, words, err);
  free(words);
  if (!status) status = read_step(a, w->step, err);
  if (!status) status = read_at(a, w->at, err);
  /* vs_scene_reread chooses the tier anew, without --tier */
  if (!status) vs_tree_put(&scene->tree, "run.tier", scene->tier->name, (vs_where){a->place, 0, 0});
  return status ? status : vs_branch_parameter_move(a, a->from, err);
}

void vs_branch_parameter_free(vs_branch_parameter *a) {
  vs_axis_free(&a->axis);
}
