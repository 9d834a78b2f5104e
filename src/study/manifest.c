/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "manifest.h"

#include <gsl/gsl_version.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/json.h"
#include "judge.h"
#include "measure/expect.h"
#include "ngspice/ngspice.h"
#include "run/version.h"
#include "study/folder.h"
#include "workers/case.h"

enum { MOST_VALUES_SHOWN = 1000 };

/* Returns a SHA-256 over the plan and all it is made of. Files enter by their contents, as their
 * paths may differ from machine to machine. The header of study.csv (columns) enters, too, as rows
 * of another layout cannot be added. */
static char *identify_plan(const vs_plan *plan, const char *columns) {
  vs_hash hash;
  vs_text text = {0};
  char digits[VS_HASH_TEXT];
  vs_text_add(&text, "%s\n%s\n%s\n%s\n%s\n", VS_VERSION, vs_version_sources(), vs_ngspice_version(),
              gsl_version, columns);
  for (size_t k = 0; k < plan->n_inputs; k++) vs_text_add(&text, "%s\n", plan->inputs[k].sha256);
  for (size_t k = 0; k < plan->n_sets; k++) vs_text_add(&text, "--set %s\n", plan->sets[k]);
  vs_hash_begin(&hash);
  vs_hash_add(&hash, text.text, text.length);
  vs_hash_end(&hash, digits);
  vs_text_free(&text);
  return vs_copy(digits);
}

/* The object stays open: the journal goes on with the counts of cases. */
static void add_begin(const vs_plan *plan, const char *name, vs_text *text) {
  char method[128];
  vs_plan_method(plan, method, sizeof method);
  vs_json json = vs_json_new(text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_version_json(&json);
  vs_json_text(&json, "study", name);
  vs_json_text(&json, "method", method);
  vs_json_whole(&json, "seed", (int64_t)plan->seed);
  vs_judge_begin_json(plan, &json);
}

/* Adds a number as study.csv has it, or a word. */
static void add_axis_number(const vs_axis *axis, const char *key, double number, vs_json *json) {
  char text[VS_NAME_SIZE];
  if (!vs_axis_print(axis, number, text, sizeof text)) {
    vs_json_text(json, key, text);
    return;
  }
  vs_json_key(json, key);
  vs_text_add(json->text, "%s", text);
}

static const vs_plan_stage *stage_of(const vs_plan *plan, size_t axis) {
  for (size_t p = 0; p < plan->n_stages; p++)
    if (axis >= plan->stages[p].axis && axis < plan->stages[p].axis + plan->stages[p].n)
      return &plan->stages[p];
  return NULL;
}

static void add_axis(const vs_plan *plan, size_t k, vs_json *json) {
  const vs_axis *axis = &plan->axes[k];
  const vs_plan_stage *stage = stage_of(plan, k);
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_text(json, "key", axis->key);
  vs_json_text(json, "column", axis->column);
  vs_json_text(json, "unit", axis->unit);
  vs_json_text(json, "by", stage ? stage->method->name : axis->by);
  vs_json_text(json, "text", axis->field->text);
  if (isfinite(axis->nominal)) add_axis_number(axis, "nominal", axis->nominal, json);
  if (axis->ranged) {
    vs_json_number(json, "from", axis->from, 12);
    vs_json_number(json, "to", axis->to, 12);
    vs_json_bool(json, "log", axis->log);
  }
  if (axis->n_values && axis->n_values <= MOST_VALUES_SHOWN) {
    vs_json_array(json, "values", VS_JSON_ROW);
    for (size_t v = 0; v < axis->n_values; v++) add_axis_number(axis, NULL, axis->value[v], json);
    vs_json_end(json);
  }
  if (stage && stage->method->axis_json) stage->method->axis_json(axis, json);
  vs_json_end(json);
}

static void add_report_column(const vs_report_column *column, vs_json *json) {
  const bool rated = isfinite(column->rating);
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_text(json, "name", column->name);
  vs_json_text(json, "column", column->column);
  vs_json_text(json, "unit", column->unit);
  vs_json_number(json, "rating", column->rating, 12);
  vs_json_text(json, "side", !rated ? NULL : column->at_least ? "min" : "max");
  vs_json_text(json, "text", column->text);
  vs_json_end(json);
}

/* A line of the verdict, by its margin: "margin.thyristor.v_reverse". */
static void add_line(const vs_report_column *margin, vs_json *json) {
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_text(json, "name", strchr(margin->name, '.') + 1);
  vs_json_text(json, "unit", margin->limit_unit);
  vs_json_number(json, "limit", margin->rating, 12);
  vs_json_text(json, "side", margin->at_least ? "min" : "max");
  vs_json_text(json, "margin", vs_folder_margins[1 + margin->sense]);
  vs_json_bool(json, "rated_by_scene", margin->own);
  vs_json_bool(json, "assumed", margin->unsure & VS_ASSUMED);
  if (margin->unsure & VS_TYPICAL) vs_json_bool(json, "typical", true);
  vs_json_text(json, "left_out_by",
               margin->left_out_by ? vs_expect_criteria[margin->left_out_by].name : NULL);
  vs_json_end(json);
}

static bool is_margin(const vs_report_column *column) {
  return column->line && *column->name == 'm';
}

/* What a column of study.csv is, as of a run's, and what its cells hold. column and quantity NULL:
 * the role's own title. */
static void add_column(vs_folder_role role, const char *column, const char *quantity,
                       const char *unit, const char *of, vs_json *json) {
  const vs_folder_kind *kind = &vs_folder_kinds[role];
  vs_folder_cells cells = role == VS_ROLE_AXIS ? vs_folder_axis_cells(column, !*unit) : kind->cells;
  vs_column c = vs_channel_column(quantity ? quantity : kind->word, unit, kind->word, of);
  snprintf(c.name, sizeof c.name, "%s", column ? column : kind->word);
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_channel_column_json(&c, json);
  vs_json_text(json, "cells", vs_folder_cell_words[cells]);
  vs_json_end(json);
}

static void add_columns(const vs_plan *plan, vs_json *json) {
  vs_json_array(json, "columns", VS_JSON_LINES);
  for (int r = 0; r <= VS_ROLE_STATUS; r++) {
    const vs_folder_role role = (vs_folder_role)r;
    if (role == VS_ROLE_AXIS)
      for (size_t k = 0; k < plan->n_axes; k++)
        add_column(role, plan->axes[k].column, plan->axes[k].key, plan->axes[k].unit, NULL, json);
    else if (role == VS_ROLE_REPORT)
      for (size_t k = 0; k < plan->n_columns; k++)
        add_column(plan->columns[k].line ? VS_ROLE_LINE : role, plan->columns[k].column,
                   plan->columns[k].name, plan->columns[k].unit, plan->columns[k].of, json);
    else if (role != VS_ROLE_LINE)
      add_column(role, NULL, NULL, "", NULL, json);
  }
  vs_json_end(json);
}

static void add_input(const vs_input *input, vs_json *json) {
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_text(json, "path", input->path);
  vs_json_text(json, "sha256", input->sha256);
  vs_json_end(json);
}

static void add_command(const vs_plan *plan, const char *name, vs_json *json) {
  vs_json_array(json, "command", VS_JSON_ROW);
  vs_json_text(json, NULL, "vibrospice");
  vs_json_text(json, NULL, "study");
  vs_json_text(json, NULL, name);
  for (size_t k = 0; k < plan->n_sets; k++) {
    vs_json_text(json, NULL, "--set");
    vs_json_text(json, NULL, plan->sets[k]);
  }
  vs_json_end(json);
}

static void add_end(const vs_plan *plan, const char *name, vs_text *text) {
  vs_json json = vs_json_inside(text);
  vs_json_array(&json, "axes", VS_JSON_LINES);
  for (size_t k = 0; k < plan->n_axes; k++) add_axis(plan, k, &json);
  vs_json_end(&json);
  vs_json_array(&json, "report", VS_JSON_LINES);
  for (size_t k = 0; k < plan->n_columns; k++)
    if (!plan->columns[k].line) add_report_column(&plan->columns[k], &json);
  vs_json_end(&json);
  vs_json_array(&json, "lines", VS_JSON_LINES);
  for (size_t k = 0; k < plan->n_columns; k++)
    if (is_margin(&plan->columns[k])) add_line(&plan->columns[k], &json);
  vs_json_end(&json);
  add_columns(plan, &json);
  vs_json_array(&json, "inputs", VS_JSON_LINES);
  for (size_t k = 0; k < plan->n_inputs; k++) add_input(&plan->inputs[k], &json);
  vs_json_end(&json);
  add_command(plan, name, &json);
  for (size_t p = 0; p < plan->n_stages && !plan->adaptive; p++) {
    if (!plan->stages[p].method->json) continue;
    vs_json_same_row(&json);
    plan->stages[p].method->json(plan, &plan->stages[p], NULL, &json);
  }
}

void vs_manifest_head(const vs_plan *plan, const char *name, vs_journal_head *head) {
  vs_text text[4] = {{0}};
  vs_case_header(plan, &text[0]);
  vs_case_failure_header(plan, &text[1]);
  add_begin(plan, name, &text[2]);
  add_end(plan, name, &text[3]);
  *head = (vs_journal_head){.identity = identify_plan(plan, text[0].text),
                            .columns = text[0].text,
                            .failures = text[1].text,
                            .manifest_begin = text[2].text,
                            .manifest_end = text[3].text,
                            .cases = plan->adaptive ? 0 : plan->count,
                            .shard = 1,
                            .shards = 1};
}
