/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a study's manifest says, but for the counts of its cases: the same for every worker count,
 * shard and machine speed. */
#include <gsl/gsl_version.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "solver/ng.h"
#include "study/case.h"
#include "study/study.h"

enum { MOST_VALUES_SHOWN = 1000 };

/* The plan and all it is made of, by content: paths may differ from machine to machine. columns:
 * the header of study.csv, as rows of another make do not go with them. */
static char *identify(const vs_plan *plan, const char *columns) {
  vs_hash hash;
  vs_text text = {0};
  char digits[VS_HASH_TEXT];
  vs_text_add(&text, "%s\n%s\n%s\n%s\n", VS_VERSION, vs_ng_version(), gsl_version, columns);
  for (size_t k = 0; k < plan->n_inputs; k++) vs_text_add(&text, "%s\n", plan->inputs[k].sha256);
  for (size_t k = 0; k < plan->n_sets; k++) vs_text_add(&text, "--set %s\n", plan->sets[k]);
  vs_hash_begin(&hash);
  vs_hash_add(&hash, text.text, text.length);
  vs_hash_end(&hash, digits);
  vs_text_free(&text);
  return vs_copy(digits);
}

static void add_begin(const vs_plan *plan, const char *name, vs_text *json) {
  char method[128];
  vs_plan_method(plan, method, sizeof method);
  vs_text_add(json,
              "{\n  \"program\": {\"version\": \"%s\", \"ngspice\": \"%s\", \"gsl\": \"%s\"},\n"
              "  \"study\": ",
              VS_VERSION, vs_ng_version(), gsl_version);
  vs_json_string(json, name);
  vs_text_add(json, ",\n  \"method\": \"%s\",\n  \"seed\": %llu", method,
              (unsigned long long)plan->seed);
}

static void add_number(const vs_axis *axis, double number, vs_text *json) {
  char text[VS_NAME_SIZE];
  vs_axis_print(axis, number, text, sizeof text);
  char *end;
  strtod(text, &end);
  if (*end || end == text)
    vs_json_string(json, text);
  else
    vs_text_add(json, "%s", text);
}

static const vs_plan_stage *part_of(const vs_plan *plan, size_t axis) {
  for (size_t p = 0; p < plan->n_parts; p++)
    if (axis >= plan->parts[p].axis && axis < plan->parts[p].axis + plan->parts[p].n)
      return &plan->parts[p];
  return NULL;
}

static void add_axis(const vs_plan *plan, size_t k, vs_text *json) {
  const vs_axis *axis = &plan->axes[k];
  const vs_plan_stage *part = part_of(plan, k);
  vs_text_add(json, "\n    {\"key\": ");
  vs_json_string(json, axis->key);
  vs_text_add(json, ", \"column\": ");
  vs_json_string(json, axis->column);
  vs_text_add(json, ", \"unit\": \"%s\", \"by\": \"%s\", \"text\": ", axis->unit,
              part ? part->method->name : axis->by);
  vs_json_string(json, axis->field->text);
  if (isfinite(axis->nominal)) {
    vs_text_add(json, ", \"nominal\": ");
    add_number(axis, axis->nominal, json);
  }
  if (axis->ranged) {
    vs_text_add(json, ", \"from\": %.12g, \"to\": %.12g, \"log\": %s", axis->from, axis->to,
                axis->log ? "true" : "false");
  }
  if (axis->n_values && axis->n_values <= MOST_VALUES_SHOWN) {
    vs_text_add(json, ", \"values\": [");
    for (size_t v = 0; v < axis->n_values; v++) {
      vs_text_add(json, "%s", v ? ", " : "");
      add_number(axis, axis->value[v], json);
    }
    vs_text_add(json, "]");
  }
  if (part && part->method->axis_json) part->method->axis_json(axis, json);
  vs_text_add(json, "}");
}

static void add_column(const vs_report_column *column, vs_text *json) {
  vs_text_add(json, "\n    {\"name\": ");
  vs_json_string(json, column->name);
  vs_text_add(json, ", \"column\": ");
  vs_json_string(json, column->column);
  vs_text_add(json, ", \"unit\": \"%s\", \"rating\": ", column->unit);
  if (isfinite(column->rating))
    vs_text_add(json, "%.12g, \"side\": \"%s\"", column->rating, column->at_least ? "min" : "max");
  else
    vs_text_add(json, "null, \"side\": null");
  vs_text_add(json, ", \"text\": ");
  vs_json_string(json, column->text);
  vs_text_add(json, "}");
}

static void add_end(const vs_plan *plan, const char *name, vs_text *json) {
  vs_text_add(json, ",\n  \"axes\": [");
  for (size_t k = 0; k < plan->n_axes; k++) {
    vs_text_add(json, "%s", k ? "," : "");
    add_axis(plan, k, json);
  }
  vs_text_add(json, "\n  ],\n  \"report\": [");
  for (size_t k = 0; k < plan->n_columns; k++) {
    vs_text_add(json, "%s", k ? "," : "");
    add_column(&plan->columns[k], json);
  }
  vs_text_add(json, "\n  ],\n  \"inputs\": [");
  for (size_t k = 0; k < plan->n_inputs; k++) {
    vs_text_add(json, "%s\n    {\"path\": ", k ? "," : "");
    vs_json_string(json, plan->inputs[k].path);
    vs_text_add(json, ", \"sha256\": \"%s\"}", plan->inputs[k].sha256);
  }
  vs_text_add(json, "\n  ],\n  \"command\": [\"vibrospice\", \"study\", ");
  vs_json_string(json, name);
  for (size_t k = 0; k < plan->n_sets; k++) {
    vs_text_add(json, ", \"--set\", ");
    vs_json_string(json, plan->sets[k]);
  }
  vs_text_add(json, "]");
  for (size_t p = 0; p < plan->n_parts; p++)
    if (plan->parts[p].method->json && !plan->adaptive)
      plan->parts[p].method->json(plan, &plan->parts[p], NULL, json);
}

void vs_manifest_head(const vs_plan *plan, const char *name, vs_journal_head *head) {
  vs_text text[4] = {{0}};
  vs_case_header(plan, &text[0]);
  vs_case_failure_header(plan, &text[1]);
  add_begin(plan, name, &text[2]);
  add_end(plan, name, &text[3]);
  *head = (vs_journal_head){.identity = identify(plan, text[0].text),
                            .columns = text[0].text,
                            .failures = text[1].text,
                            .manifest_begin = text[2].text,
                            .manifest_end = text[3].text,
                            .cases = plan->adaptive ? 0 : plan->count,
                            .shard = 1,
                            .shards = 1};
}
