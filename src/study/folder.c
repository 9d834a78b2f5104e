/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/folder.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/compressed.h"
#include "base/csv.h"
#include "base/path.h"
#include "base/text.h"
#include "base/units.h"
#include "run/listed_line.h"
#include "study/format.h"
#include "study/plan.h"

const char *const vs_folder_cell_words[] = {
    [VS_CELLS_TEXT] = "text",    [VS_CELLS_EITHER] = "either", [VS_CELLS_NUMBER] = "number",
    [VS_CELLS_VALUE] = "number", [VS_CELLS_LINE] = "number",   [VS_CELLS_COUNT] = "count",
    [VS_CELLS_STATUS] = "count"};

const char *const vs_folder_margins[3] = {"stress/limit - 1", NULL, "1 - stress/limit"};

const vs_folder_kind vs_folder_kinds[VS_ROLES] = {
    [VS_ROLE_CASE] = {"case", VS_CELLS_COUNT},
    [VS_ROLE_ID] = {"id", VS_CELLS_TEXT},
    [VS_ROLE_AXIS] = {"axis", VS_CELLS_EITHER},
    [VS_ROLE_REPORT] = {VS_COLUMN_MEASURE, VS_CELLS_VALUE},
    [VS_ROLE_LINE] = {"line", VS_CELLS_LINE},
    [VS_ROLE_MARGIN] = {"margin_least", VS_CELLS_VALUE},
    [VS_ROLE_ERROR] = {"margin_error", VS_CELLS_VALUE},
    [VS_ROLE_WEAKEST] = {"weakest", VS_CELLS_TEXT},
    [VS_ROLE_RUNG] = {"rung", VS_CELLS_COUNT},
    [VS_ROLE_LEAVING] = {"leaving_bound", VS_CELLS_VALUE},
    [VS_ROLE_HAPPENED] = {"happened", VS_CELLS_TEXT},
    [VS_ROLE_NOT_JUDGED] = {"not_judged", VS_CELLS_TEXT},
    [VS_ROLE_WARNINGS] = {"warnings", VS_CELLS_TEXT},
    [VS_ROLE_STATUS] = {"status", VS_CELLS_STATUS},
    [VS_ROLE_WHY] = {"why", VS_CELLS_TEXT}};

vs_folder_cells vs_folder_axis_cells(const char *title, bool no_unit) {
  const bool empty = !strncmp(title, "threat.", 7) || !strncmp(title, "with.", 5);
  if (empty) return no_unit ? VS_CELLS_TEXT : VS_CELLS_VALUE;
  return no_unit ? VS_CELLS_EITHER : VS_CELLS_NUMBER;
}

vs_folder_role vs_folder_role_of(const char *title) {
  if (vs_listed_line_is(title)) return VS_ROLE_LINE;
  for (int r = 0; r < VS_ROLES; r++)
    if (r != VS_ROLE_AXIS && r != VS_ROLE_LINE && !strcmp(title, vs_folder_kinds[r].word))
      return (vs_folder_role)r;
  return VS_ROLE_REPORT;
}

static bool is_file_there(const char *folder, const char *name) {
  char path[VS_PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return !access(path, F_OK);
}

bool vs_folder_here(const char *folder) {
  char path[VS_PATH_SIZE];
  return is_file_there(folder, "manifest.json") || vs_format_find_rows(folder, path);
}

bool vs_folder_number(const char *cell, double *value) {
  char *end;
  *value = NAN;
  if (!*cell) return true;
  double number = strtod(cell, &end);
  if (*end || end == cell) return false;
  if (isfinite(number)) *value = number;
  return true;
}

/* ---- rows of CSV ---- */

/* Makes a row of the file's present one. Its case must come after *before, and it must have as many
 * cells as `cells`. */
static vs_status take_folder_row(const vs_csv *csv, size_t cells, vs_folder_row *row, long *before,
                                 vs_error *err) {
  const vs_where at = {csv->file, csv->line, 1};
  char *end;
  *row = (vs_folder_row){.line = csv->line, .cell = csv->cell, .count = csv->count};
  if (row->count != cells)
    return vs_fail_at(err, at, "cells in this row: %zu; columns in the header: %zu", row->count,
                      cells);
  row->number = strtol(row->cell[0], &end, 10);
  if (*end || end == row->cell[0] || row->number < 0)
    return vs_fail_at(err, at, "'%s' is no case's number", row->cell[0]);
  if (row->number <= *before)
    return vs_fail_at(err, at, "case %ld stands after case %ld; rows come in case order",
                      row->number, *before);
  *before = row->number;
  return VS_OK;
}

/* Calls visit for all rows behind the header, and frees the reader. */
static vs_status visit_rows(vs_csv *csv, size_t cells, vs_folder_visit visit, void *ctx,
                            vs_error *err) {
  long before = -1;
  vs_folder_row row;
  vs_status status = vs_csv_next(csv, err);
  if (!status && !csv->count)
    status = vs_fail_at(err, (vs_where){csv->file, 1, 1},
                        "the file is empty; its first line names columns");
  while (!status && !(status = vs_csv_next(csv, err)) && csv->count) {
    status = take_folder_row(csv, cells, &row, &before, err);
    if (!status) status = visit(ctx, &row, err);
  }
  vs_csv_free(csv);
  return status;
}

vs_status vs_folder_each(const vs_folder *t, vs_folder_visit visit, void *ctx, vs_error *err) {
  vs_status status = vs_path_check_result(t->path, err);
  if (status) return status;
  FILE *f = vs_compressed_read(fopen(t->path, "r"), t->path);
  if (!f) return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", t->path, strerror(errno));
  status = visit_rows(&(vs_csv){.file = t->path, .stream = f}, t->count, visit, ctx, err);
  fclose(f);
  return status;
}

vs_status vs_folder_each_failure(const vs_folder *t, vs_folder_visit visit, void *ctx,
                                 vs_error *err) {
  char path[VS_PATH_SIZE];
  size_t cells = 3; /* case, status and why; the id and the axes come on top */
  for (size_t c = 0; c < t->count; c++)
    cells += t->column[c].role == VS_ROLE_AXIS || t->column[c].role == VS_ROLE_ID;
  snprintf(path, sizeof path, "%.*s/failures.csv", VS_PATH_SIZE - 32, t->folder);
  vs_status status = vs_path_check_result(path, err);
  if (status) return status;
  FILE *f = fopen(path, "r");
  if (!f && errno == ENOENT) return VS_OK;
  if (!f) return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
  status = visit_rows(&(vs_csv){.file = path, .stream = f}, cells, visit, ctx, err);
  fclose(f);
  return status;
}

/* ---- manifest.json ---- */

static const char *text_of_node(const vs_node *node) {
  return node && node->kind == VS_NODE_TEXT ? node->text : NULL;
}

static vs_status refuse_manifest(const vs_folder *t, const vs_node *node, const char *what,
                                 vs_error *err) {
  return vs_fail_at(err, node ? node->where : (vs_where){t->manifest_path, 1, 1},
                    "%s; this is no manifest of a study", what);
}

static vs_status take_count(const vs_folder *t, const char *key, long *count, vs_error *err) {
  const vs_node *node = vs_tree_child(t->manifest.root, key);
  const char *text = text_of_node(node);
  char *end = NULL, what[64];
  *count = text ? strtol(text, &end, 10) : -1;
  if (*count >= 0 && !*end && end != text) return VS_OK;
  snprintf(what, sizeof what, "\"%s\" must be a number of cases", key);
  return refuse_manifest(t, node, what, err);
}

/* Returns a column's title in study.csv where the manifest does not say it: name_unit. */
static char *title_of(const char *name, const char *unit) {
  char suffix[64];
  vs_text title = {0};
  vs_units_suffix(unit, suffix, sizeof suffix);
  vs_text_add(&title, "%s%s%s", name, *suffix ? "_" : "", suffix);
  return title.text;
}

static vs_folder_column *find_folder_column(vs_folder *t, const char *title) {
  for (size_t c = 0; c < t->count; c++)
    if (!strcmp(t->column[c].title, title)) return &t->column[c];
  return NULL;
}

static void describe_column(vs_folder_column *c, const vs_node *node, const char *name,
                            const char *unit) {
  const char *text = text_of_node(vs_tree_child(node, "text"));
  const char *rating = text_of_node(vs_tree_child(node, "rating"));
  free(c->name);
  free(c->unit);
  free(c->text);
  c->name = vs_copy(name);
  c->unit = vs_copy(unit);
  c->text = vs_copy(text ? text : "");
  c->node = node;
  if (!rating || !vs_folder_number(rating, &c->rating))
    c->rating = NAN; /* the manifest says null */
}

/* Notes what a list of the manifest says of the columns of study.csv. */
static vs_status take_list(vs_folder *t, const char *list, const char *key, vs_folder_role role,
                           vs_error *err) {
  const vs_node *all = vs_tree_child(t->manifest.root, list);
  char what[96];
  snprintf(what, sizeof what, "\"%s\" must be a list of {\"%s\", \"unit\", ...}", list, key);
  if (!all || all->kind != VS_NODE_LIST) return refuse_manifest(t, all, what, err);
  for (const vs_node *n = all->child; n; n = n->next) {
    const char *name = text_of_node(vs_tree_child(n, key)),
               *unit = text_of_node(vs_tree_child(n, "unit"));
    if (!name) return refuse_manifest(t, n, what, err);
    if (!unit || !strcmp(unit, "null")) unit = "";
    const char *column = text_of_node(vs_tree_child(n, "column"));
    char *title = column ? vs_copy(column) : title_of(name, unit);
    vs_folder_column *c = find_folder_column(t, title);
    if (!c)
      vs_fail_at(err, (vs_where){t->path, 1, 1}, "has no column '%s', which %s names", title,
                 t->manifest_path);
    free(title);
    if (!c) return VS_INPUT;
    describe_column(c, n, name, unit);
    if (c->role == VS_ROLE_REPORT || c->role == VS_ROLE_AXIS) c->role = role;
  }
  return VS_OK;
}

/* Numbers of the verdict's lines stand in the list of all columns alone. */
static void describe_lines(vs_folder *t) {
  const vs_node *all = vs_tree_child(t->manifest.root, "columns");
  for (const vs_node *n = all && all->kind == VS_NODE_LIST ? all->child : NULL; n; n = n->next) {
    const char *title = text_of_node(vs_tree_child(n, "name"));
    const char *name = text_of_node(vs_tree_child(n, "quantity"));
    const char *unit = text_of_node(vs_tree_child(n, "unit"));
    vs_folder_column *c = title ? find_folder_column(t, title) : NULL;
    if (c && c->role == VS_ROLE_LINE && name && unit) describe_column(c, n, name, unit);
  }
}

static vs_status read_manifest(vs_folder *t, vs_error *err) {
  vs_status status = vs_tree_read(t->manifest_path, &t->manifest, err);
  if (status && t->manifest.root) return refuse_manifest(t, t->manifest.root, "not {...}", err);
  if (status) return status;
  t->method = text_of_node(vs_tree_child(t->manifest.root, "method"));
  if (!t->method) return refuse_manifest(t, NULL, "\"method\" is missing", err);
  status = take_count(t, "cases", &t->cases, err);
  if (!status) status = take_count(t, "done", &t->done, err);
  if (!status) status = take_count(t, "failed", &t->failed, err);
  return status;
}

/* Finds the methods that the manifest names ("grid x sobol"), as far as this program has them. */
static void find_methods(vs_folder *t, const vs_method *const *methods) {
  static const char AND[] = " x ";
  size_t names = 1;
  for (const char *s = t->method; (s = strstr(s, AND)); s += strlen(AND)) names++;
  t->methods = vs_alloc(names, sizeof *t->methods);
  for (const char *s = t->method, *end; s; s = end ? end + strlen(AND) : NULL) {
    end = strstr(s, AND);
    const vs_method *m = vs_method_named(methods, s, end ? (size_t)(end - s) : strlen(s));
    if (!m) continue;
    t->methods[t->n_methods++] = m;
    if (m->next) t->search = m;
  }
}

/* ---- the header of study.csv ---- */

static int find_role(const vs_folder *t, vs_folder_role role) {
  for (size_t c = 0; c < t->count; c++)
    if (t->column[c].role == role) return (int)c;
  return -1;
}

_Static_assert(VS_PLAN_AXES + VS_PLAN_COLUMNS + VS_ROLES <= VS_STUDY_COLUMNS,
               "every study that can be run can be read");

static vs_status take_header(vs_folder *t, char *const *cell, size_t count, vs_error *err) {
  const vs_where at = {t->path, 1, 1};
  if (!count) return vs_fail_at(err, at, "the file is empty; its first line names columns");
  if (count > VS_STUDY_COLUMNS)
    return vs_fail_at(err, at, "more than %d columns", VS_STUDY_COLUMNS);
  t->count = count;
  for (size_t c = 0; c < t->count; c++)
    t->column[c] = (vs_folder_column){.title = vs_copy(cell[c]),
                                      .name = vs_copy(cell[c]),
                                      .unit = vs_copy(""),
                                      .text = vs_copy(""),
                                      .role = vs_folder_role_of(cell[c]),
                                      .rating = NAN};
  t->margin = find_role(t, VS_ROLE_MARGIN);
  t->error = find_role(t, VS_ROLE_ERROR);
  t->weakest = find_role(t, VS_ROLE_WEAKEST);
  t->rung = find_role(t, VS_ROLE_RUNG);
  t->happened = find_role(t, VS_ROLE_HAPPENED);
  t->not_judged = find_role(t, VS_ROLE_NOT_JUDGED);
  t->warnings = find_role(t, VS_ROLE_WARNINGS);
  t->status = find_role(t, VS_ROLE_STATUS);
  if (strcmp(cell[0], "case") || t->status < 0)
    return vs_fail_at(err, at, "a study's columns begin with 'case' and end with 'status'");
  for (size_t c = 1; c < t->count; c++)
    for (size_t d = 0; d < c; d++)
      if (!strcmp(cell[c], cell[d]))
        return vs_fail_at(err, at, "column '%s' stands here twice", cell[c]);
  return VS_OK;
}

static vs_status read_folder_header(vs_folder *t, vs_error *err) {
  vs_status status = vs_path_check_result(t->path, err);
  if (status) return status;
  FILE *f = vs_compressed_read(fopen(t->path, "r"), t->path);
  if (!f)
    return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s; a study that ended has one", t->path,
                   strerror(errno));
  vs_csv csv = {.file = t->path, .stream = f};
  status = vs_csv_next(&csv, err);
  if (!status) status = take_header(t, csv.cell, csv.count, err);
  vs_csv_free(&csv);
  fclose(f);
  return status;
}

/* Error: study.csv has a column that the manifest does not name; the two are of different studies.
 */
static vs_status check_columns(const vs_folder *t, vs_error *err) {
  for (size_t c = 0; c < t->count; c++)
    if (t->column[c].role == VS_ROLE_REPORT && !t->column[c].node)
      return vs_fail_at(err, (vs_where){t->path, 1, 1}, "%s says nothing of column '%s'",
                        t->manifest_path, t->column[c].title);
  return VS_OK;
}

vs_status vs_folder_open(vs_folder *t, const char *folder, const vs_method *const *methods,
                         vs_error *err) {
  *t = (vs_folder){0};
  if (strlen(folder) > VS_PATH_SIZE / 2)
    return vs_fail(err, VS_INPUT, "%s: too long a name", folder);
  snprintf(t->folder, sizeof t->folder, "%s", folder);
  vs_format_find_rows(folder, t->path);
  snprintf(t->manifest_path, sizeof t->manifest_path, "%s/manifest.json", folder);
  vs_status status = read_manifest(t, err);
  if (!status) find_methods(t, methods);
  if (!status) status = read_folder_header(t, err);
  if (!status) status = take_list(t, "axes", "key", VS_ROLE_AXIS, err);
  if (!status) status = take_list(t, "report", "name", VS_ROLE_REPORT, err);
  if (!status) describe_lines(t);
  if (!status) status = check_columns(t, err);
  return status;
}

void vs_folder_close(vs_folder *t) {
  for (size_t c = 0; c < t->count; c++) {
    free(t->column[c].title);
    free(t->column[c].name);
    free(t->column[c].unit);
    free(t->column[c].text);
  }
  vs_tree_free(&t->manifest);
  free(t->methods);
  *t = (vs_folder){0};
}

const vs_node *vs_folder_search(const vs_folder *t) {
  return t->search ? vs_tree_child(t->manifest.root, t->search->key) : NULL;
}

bool vs_folder_is_sampled(const vs_folder *t) {
  bool sampled = false;
  for (size_t k = 0; k < t->n_methods; k++) sampled = sampled || t->methods[k]->report.sampled;
  return sampled;
}

size_t vs_folder_aim(const vs_folder *t, bool *largest) {
  const vs_node *search = vs_folder_search(t);
  const char *key = search && search->kind == VS_NODE_MAP ? t->search->report.aim : NULL;
  const char *words = key ? text_of_node(vs_tree_child(search, key)) : NULL;
  const char *name = words ? strrchr(words, ' ') : NULL;
  *largest = name && !strncmp(words, "max", 3);
  for (size_t c = 1; name && c < t->count; c++)
    if (!strcmp(t->column[c].name, name + 1)) return c;
  *largest = false;
  return t->margin > 0 ? (size_t)t->margin : 0;
}

long vs_folder_found(const vs_folder *t) {
  const vs_node *search = vs_folder_search(t);
  const vs_node *found =
      search && search->kind == VS_NODE_MAP ? vs_tree_child(search, "found") : NULL;
  const char *number = text_of_node(vs_tree_child(found, "case"));
  return number && *number ? strtol(number, NULL, 10) : -1;
}
