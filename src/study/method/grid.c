/* SPDX-License-Identifier: GPL-3.0-or-later
 * What stands under vary: a grid, which is all combinations of the values listed, the last axis
 * running fastest; or a list, the rows of a CSV file. */
#include "study/methods.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/hash.h"
#include "study/plan.h"

/* ---- grid ---- */

static const vs_inside MANY = {.instead = &vs_axis_many},
                       AXES = {.rows = VS_ROWS({.kind = VS_VALUE, .inside = &MANY})};
static const vs_field VARY = {"vary", VS_TEXT | VS_MAP, .inside = &AXES};

static bool claims_grid(const vs_node *section) {
  return section->kind != VS_NODE_TEXT;
}

static vs_status read_grid(vs_plan *plan, const vs_node *section, void **state, vs_error *err) {
  (void)state;
  if (section->kind != VS_NODE_MAP || !section->child)
    return vs_fail_at(err, section->where,
                      "vary: a map of keys is wanted: {circuit.r1: [100 ohm, 1 kohm], ...}, or the "
                      "name of a CSV file");
  vs_status status = VS_OK;
  for (const vs_node *node = section->child; node && !status; node = node->next) {
    vs_axis *axis = NULL;
    status = vs_plan_axis(plan, node, "vary", &axis, err);
    if (!status) status = vs_axis_values(axis, node, err);
    status = vs_error_keep(err, status);
  }
  return status;
}

static uint64_t count_grid(const vs_plan *plan, const vs_plan_stage *stage) {
  uint64_t count = 1;
  for (size_t k = stage->axis; k < stage->axis + stage->n && count <= VS_PLAN_CASES; k++)
    count *= plan->axes[k].n_values;
  return count;
}

static void grid_point(const vs_plan *plan, const vs_plan_stage *stage, uint64_t index,
                       double *value) {
  for (size_t k = stage->n; k-- > 0;) {
    const vs_axis *axis = &plan->axes[stage->axis + k];
    value[k] = axis->value[index % axis->n_values];
    index /= axis->n_values;
  }
}

static const char *const GRID_EACH[] = {"curve", "map", "cases", NULL}, *const GRID_LAST[] = {
                                                                            "effect", NULL};

const vs_method vs_grid_method = {.name = "grid",
                                  .key = "vary",
                                  .keys = &VARY,
                                  .text = "all combinations of the values listed",
                                  .claims = claims_grid,
                                  .read = read_grid,
                                  .count = count_grid,
                                  .point = grid_point,
                                  .report = {.each = GRID_EACH, .last = GRID_LAST}};

/* ---- list ---- */

/* The file's rows are kept as the values of each axis. */
static bool is_text(const vs_node *section) {
  return section->kind == VS_NODE_TEXT && *section->text;
}

enum { MOST_CELLS = VS_PLAN_AXES };

/* A CSV file that is being read. */
typedef struct reader {
  vs_plan *plan;
  vs_csv csv;
  size_t columns;
  vs_axis *axis[MOST_CELLS];
  bool bare[MOST_CELLS]; /* the header names the unit, and the cells are numbers without one */
} reader;

/* Reads a title, which is a key ("circuit.r1") or what study.csv calls it ("circuit.r1_ohm"); cells
 * under the latter are plain numbers. */
static vs_status read_list_header(reader *c, size_t k, vs_error *err) {
  const char *cell = c->csv.cell[k];
  const vs_where where = c->csv.where[k];
  vs_node node = vs_tree_word(cell, NULL, where);
  vs_error first = {0};
  if (!vs_plan_axis(c->plan, &node, "vary", &c->axis[k], &first)) return VS_OK;
  char key[VS_KEY_SIZE];
  for (const char *s = cell; (s = strchr(s, '_')); s++) {
    vs_error none = {0};
    snprintf(key, sizeof key, "%.*s", (int)(s - cell), cell);
    node = vs_tree_word(key, NULL, where);
    if (vs_plan_axis(c->plan, &node, "vary", &c->axis[k], &none)) continue;
    c->bare[k] = true;
    if (!strcmp(c->axis[k]->column, cell)) return VS_OK;
    return vs_fail_at(err, where, "column %s: %s is wanted, or %s with units in its cells", cell,
                      c->axis[k]->column, key);
  }
  return vs_fail_at(err, where, "%s", first.text + first.place_size);
}

static vs_status read_cell(reader *c, size_t k, vs_error *err) {
  vs_axis *axis = c->axis[k];
  vs_text text = {0};
  double number = 0;
  vs_text_add(&text, "%s%s%s", c->csv.cell[k], c->bare[k] ? " " : "", c->bare[k] ? axis->unit : "");
  const vs_node node = vs_tree_word(NULL, text.text, c->csv.where[k]);
  vs_status status = vs_axis_number(axis, &node, &number, err);
  vs_text_free(&text);
  if (status) return status;
  axis->value = vs_alloc_grow(axis->value, axis->n_values, sizeof *axis->value);
  axis->value[axis->n_values++] = number;
  return VS_OK;
}

static vs_status read_list_row(reader *c, vs_error *err) {
  const size_t n = c->csv.count;
  const bool header = !c->columns;
  const vs_where where = {c->csv.file, c->csv.line, 1};
  if (n > MOST_CELLS) return vs_fail_at(err, where, "more than %d columns", MOST_CELLS);
  if (!header && n != c->columns)
    return vs_fail_at(err, where, "%zu cells, and the header has %zu", n, c->columns);
  vs_status status = VS_OK;
  for (size_t k = 0; k < n && !status; k++)
    status = header ? read_list_header(c, k, err) : read_cell(c, k, err);
  if (header) c->columns = n;
  return status;
}

/* Reads all rows. An error in the header ends the reading, as no cell can be read without it; a
 * check goes on behind errors in other rows. */
static vs_status read_list_rows(reader *c, vs_error *err) {
  vs_status status = VS_OK;
  while (!status && !(status = vs_csv_next(&c->csv, err)) && c->csv.count) {
    bool header = !c->columns;
    status = read_list_row(c, err);
    if (!header) status = vs_error_keep(err, status);
  }
  return status;
}

static vs_status read_list(vs_plan *plan, const vs_node *section, void **state, vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_status status = vs_plan_find(section, path, err);
  if (status) return status;
  *state = vs_copy(path);
  FILE *f;
  status = vs_hash_open(path, &f, err);
  if (status) return status;
  reader c = {.plan = plan,
              .csv = {.file = *state /* lasts as long as the plan */,
                      .stream = f,
                      .trim = true,
                      .comments = true}};
  if (!f) return vs_fail_at(err, section->where, "%s: cannot be opened: %s", path, strerror(errno));
  size_t found = vs_error_count(err);
  status = read_list_rows(&c, err);
  vs_csv_free(&c.csv);
  fclose(f);
  if (!status && vs_error_count(err) == found && (!c.columns || !c.axis[0]->n_values))
    status = vs_fail_at(err, (vs_where){*state, 1, 1},
                        "a header row of scene keys and a row for each case are wanted");
  return status ? status : vs_plan_input(plan, path, err);
}

static uint64_t count_list(const vs_plan *plan, const vs_plan_stage *stage) {
  return plan->axes[stage->axis].n_values;
}

static void list_point(const vs_plan *plan, const vs_plan_stage *stage, uint64_t index,
                       double *value) {
  for (size_t k = 0; k < stage->n; k++) value[k] = plan->axes[stage->axis + k].value[index];
}

static const char *const LIST_EACH[] = {"cases", NULL};

const vs_method vs_grid_list = {.name = "list",
                                .key = "vary",
                                .keys = &VARY,
                                .text = "the rows of a CSV file, whose header names scene keys",
                                .claims = is_text,
                                .read = read_list,
                                .free = free,
                                .count = count_list,
                                .point = list_point,
                                .report = {.each = LIST_EACH}};
