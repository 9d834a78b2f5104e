/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "traces.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/text.h"
#include "base/tree.h"
#include "base/units.h"
#include "members.h"
#include "run/table.h"

static bool is_there(const char *folder, const char *name) {
  char path[VS_PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return !access(path, R_OK);
}

bool vs_traces_here(const char *folder) {
  if (strlen(folder) > VS_PATH_SIZE / 2 || is_there(folder, "manifest.json")) return false;
  return is_there(folder, "run.csv") || is_there(folder, "run.partial.csv") ||
         is_there(folder, "summary.json");
}

vs_status vs_traces_none(const char *folder, int why, vs_error *err) {
  if (is_there(folder, "run.partial.csv"))
    return vs_fail(err, VS_INPUT, "%s: the run did not end well; only run.partial.csv is there",
                   folder);
  if (is_there(folder, "journal"))
    return vs_fail(err, VS_INPUT,
                   "%s: this study is not finished; 'vibrospice study STUDY -o %s --resume' (of a "
                   "design: 'vibrospice design') goes on with it",
                   folder, folder);
  return vs_fail(err, VS_INPUT,
                 "%s/run.csv: cannot be opened: %s; 'vibrospice run SCENE -o %s' makes it", folder,
                 strerror(why), folder);
}

/* ---- what is drawn ---- */

/* Compares the file's header with `header`, and counts its rows. */
static vs_status count_rows(FILE *f, const char *path, const char *header, size_t *rows,
                            vs_error *err) {
  char *line = NULL;
  size_t size = 0;
  bool same = vs_alloc_row(&line, &size, VS_CSV_LONGEST, f) > 0;
  if (same) line[strcspn(line, "\r\n")] = '\0';
  same = same && !strcmp(line, header);
  while (same && vs_alloc_row(&line, &size, VS_CSV_LONGEST, f) > 0) ++*rows;
  vs_status status = vs_file_was_read(f, path, err);
  free(line);
  if (status || same) return status;
  return vs_fail_at(err, (vs_where){path, 1, 1},
                    "its columns are not those of run.csv beside it: it is of another run; remove "
                    "it, or run again");
}

vs_status vs_traces_drawn(const char *folder, const char *header, char drawn[VS_PATH_SIZE],
                          size_t *rows, vs_error *err) {
  *rows = 0;
  snprintf(drawn, VS_PATH_SIZE, "%s/" VS_TABLE_PEAKS_FILE, folder);
  if (access(drawn, F_OK)) {
    snprintf(drawn, VS_PATH_SIZE, "%s/run.csv", folder);
    return VS_OK;
  }
  vs_status status = vs_path_check_result(drawn, err);
  FILE *f = status ? NULL : fopen(drawn, "r");
  if (!status && !f)
    return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", drawn, strerror(errno));
  if (!status) status = count_rows(f, drawn, header, rows, err);
  if (f) fclose(f);
  return status;
}

/* ---- what columns are ---- */

/* Guesses the unit from the end of the column's name. */
static void guess_unit(vs_column *c) {
  static const char *const UNITS[] = {"m",   "rad", "m/s", "rad/s", "m/s2", "rad/s2", "Wb",
                                      "A",   "N",   "V",   "W",     "Hz",   "K",      "J",
                                      "ohm", "s",   "C",   "N.m",   "degC"};
  snprintf(c->quantity, sizeof c->quantity, "%s", c->name);
  for (const char *s = c->name; (s = strchr(s, '_')); s++)
    for (size_t k = 0; k < sizeof UNITS / sizeof *UNITS; k++) {
      char suffix[32];
      vs_units_suffix(UNITS[k], suffix, sizeof suffix);
      if (s == c->name || strcmp(s + 1, suffix) != 0) continue;
      c->quantity[s - c->name] = '\0';
      snprintf(c->unit, sizeof c->unit, "%s", UNITS[k]);
      return;
    }
}

/* The column of a coordinate's rate or acceleration, by name and unit. */
static vs_column *guess_derivative(vs_column *all, size_t n, const vs_column *of, char letter,
                                   const char *per) {
  const size_t length = strlen(of->unit);
  for (vs_column *c = all; *of->unit && c < all + n; c++)
    if (*c->quantity == letter && !strcmp(c->quantity + 1, of->quantity) &&
        !strncmp(c->unit, of->unit, length) && !strcmp(c->unit + length, per))
      return c;
  return NULL;
}

static void guess_role(vs_column *c, const char *role, const vs_column *of) {
  snprintf(c->role, sizeof c->role, "%s", role);
  snprintf(c->of, sizeof c->of, "%s", of ? of->quantity : "");
}

static void guess_roles(vs_column *all, size_t n) {
  static const char *const CONTROL[][2] = {{"firing_angle", VS_COLUMN_MEASURE},
                                           {"amplitude_meas", VS_COLUMN_MEASURE},
                                           {"f_motion", VS_COLUMN_MEASURE},
                                           {"swing_meas", VS_COLUMN_MEASURE},
                                           {"setpoint", VS_COLUMN_SET_POINT}};
  for (vs_column *c = all; c < all + n; c++) {
    vs_column *rate = guess_derivative(all, n, c, 'v', "/s"),
              *rate2 = guess_derivative(all, n, c, 'a', "/s2");
    for (size_t k = 0; k < sizeof CONTROL / sizeof *CONTROL; k++)
      if (!strcmp(c->quantity, CONTROL[k][0])) guess_role(c, CONTROL[k][1], NULL);
    if (!rate || !rate2) continue;
    guess_role(c, VS_COLUMN_COORDINATE, NULL);
    guess_role(rate, VS_COLUMN_RATE, c);
    guess_role(rate2, VS_COLUMN_ACCELERATION, c);
  }
}

/* Fills in what an entry of summary.json says. */
static void take_told(vs_column *c, const vs_node *entry) {
  snprintf(c->quantity, sizeof c->quantity, "%s", vs_member_word(entry, "quantity"));
  snprintf(c->unit, sizeof c->unit, "%s", vs_member_word(entry, "unit"));
  snprintf(c->role, sizeof c->role, "%s", vs_member_word(entry, "role"));
  snprintf(c->of, sizeof c->of, "%s", vs_member_word(entry, "of"));
  c->is_guessed = false;
}

vs_column *vs_traces_columns(const char *folder, const char *header, size_t *count) {
  char path[VS_PATH_SIZE], *line = vs_copy(header), *rest = line;
  vs_tree summary = {0};
  vs_error unread = {0};
  vs_column *all = NULL;
  *count = 0;
  for (char *cell; (cell = strsep(&rest, ","));) {
    all = vs_alloc_grow(all, *count, sizeof *all);
    all[*count] = (vs_column){.is_guessed = true};
    snprintf(all[*count].name, sizeof all->name, "%s", cell);
    guess_unit(&all[(*count)++]);
  }
  snprintf(path, sizeof path, "%s/summary.json", folder);
  bool known = !vs_tree_read(path, &summary, &unread);
  const vs_node *told = known ? vs_tree_child(summary.root, "columns") : NULL;
  if (!told) guess_roles(all, *count);
  for (const vs_node *entry = told ? told->child : NULL; entry; entry = entry->next)
    for (size_t k = 0; k < *count; k++)
      if (!strcmp(vs_member_word(entry, "name"), all[k].name)) take_told(&all[k], entry);
  vs_tree_free(&summary);
  free(line);
  return all;
}

/* ---- header ---- */

static vs_status read_header(vs_traces *t, char *line, vs_error *err) {
  size_t most = 1;
  for (const char *s = line; *s; s++) most += *s == ',';
  t->name = vs_alloc(most, sizeof *t->name);
  for (char *cell; (cell = strsep(&line, ","));) t->name[t->columns++] = vs_copy(cell);
  if (!strcmp(t->name[0], "t_s")) return VS_OK;
  return vs_fail_at(err, (vs_where){t->path, 1, 1},
                    "'%s': the first column of a run is t_s, its time", t->name[0]);
}

/* ---- rows ---- */

static vs_status read_row(vs_traces *t, char *line, int number, vs_error *err) {
  double *row = t->value + t->rows * t->columns;
  char *s = line;
  line[strcspn(line, "\r\n")] = '\0';
  for (size_t c = 0; c < t->columns; c++) {
    size_t length = strcspn(s, ",");
    char *end = s;
    row[c] = length ? strtod(s, &end) : NAN;
    vs_where where = {t->path, number, (int)(s - line) + 1};
    if (end != s + length || isinf(row[c]))
      return vs_fail_at(err, where, "'%.*s': a finite number is wanted", (int)length, s);
    s += length;
    if ((*s == ',') != (c + 1 < t->columns))
      return vs_fail_at(err, where, "the row has not %zu cells, as the header has", t->columns);
    s += *s == ',';
  }
  vs_where where = {t->path, number, 1};
  if (isnan(row[0])) return vs_fail_at(err, where, "a time is wanted, in s");
  if (t->rows && row[0] < vs_trace_time(t, t->rows - 1))
    return vs_fail_at(err, where, "the time, %.9g s, is before that of the row above", row[0]);
  t->rows++;
  return VS_OK;
}

static void make_room(vs_traces *t, size_t *room) {
  if (t->rows < *room) return;
  *room = *room ? 2 * *room : 1024;
  t->value = vs_resize(t->value, *room * t->columns, sizeof *t->value);
}

/* Reads line `number`; *more is false at the end of the file. Error: the line has a zero byte,
 * after which text would be ignored. */
static vs_status next_line(const vs_traces *t, FILE *f, vs_text *line, int number, bool *more,
                           vs_error *err) {
  ssize_t n = vs_alloc_row(&line->text, &line->capacity, VS_CSV_LONGEST, f);
  *more = n > 0;
  if (n <= 0 || strlen(line->text) == (size_t)n) return VS_OK;
  return vs_fail_at(err, (vs_where){t->path, number, (int)strlen(line->text) + 1},
                    "a zero byte; a run's table is text");
}

static vs_status read_rows(const char *folder, vs_traces *t, FILE *f, vs_error *err) {
  vs_text line = {0};
  size_t room = 0;
  bool more;
  int number = 1;
  vs_status status = next_line(t, f, &line, number, &more, err);
  if (!status && !more)
    status = vs_fail_at(err, (vs_where){t->path, 1, 1}, "holds no line; a run's begins with t_s");
  if (!status) line.text[strcspn(line.text, "\r\n")] = '\0';
  if (!status) status = vs_traces_drawn(folder, line.text, t->drawn, &t->drawn_rows, err);
  if (!status) t->column = vs_traces_columns(folder, line.text, &(size_t){0});
  if (!status) status = read_header(t, line.text, err);
  while (!status && !(status = next_line(t, f, &line, ++number, &more, err)) && more) {
    make_room(t, &room);
    status = read_row(t, line.text, number, err);
  }
  if (!status) status = vs_file_was_read(f, t->path, err);
  vs_text_free(&line);
  if (!status && !t->rows) status = vs_fail_at(err, (vs_where){t->path, 2, 1}, "holds no rows");
  if (t->drawn_rows < t->rows) t->drawn_rows = t->rows;
  return status;
}

vs_status vs_traces_read(const char *folder, vs_traces *t, vs_error *err) {
  if (strlen(folder) > VS_PATH_SIZE / 2)
    return vs_fail(err, VS_INPUT, "%.100s...: too long a name", folder);
  snprintf(t->path, sizeof t->path, "%s/run.csv", folder);
  vs_status status = vs_path_check_result(t->path, err);
  if (status) return status;
  FILE *f = fopen(t->path, "r");
  int why = errno;
  if (!f) return vs_traces_none(folder, why, err);
  status = read_rows(folder, t, f, err);
  fclose(f);
  return status;
}

void vs_traces_free(vs_traces *t) {
  for (size_t c = 0; c < t->columns; c++) free(t->name[c]);
  free(t->name);
  free(t->column);
  free(t->value);
  *t = (vs_traces){0};
}

int vs_traces_find(const vs_traces *t, const char *name) {
  for (size_t c = 0; c < t->columns; c++)
    if (!strcmp(t->name[c], name)) return (int)c;
  return -1;
}

int vs_traces_like(const vs_traces *t, const vs_column *other) {
  const int k = vs_traces_find(t, other->name);
  const vs_column *c = k < 0 ? NULL : &t->column[k];
  if (!c || c->is_guessed || other->is_guessed) return k;
  return strcmp(c->role, other->role) || strcmp(c->unit, other->unit) ? -1 : k;
}

double vs_trace_value(const vs_traces *t, size_t row, int column) {
  return t->value[row * t->columns + (size_t)column];
}

double vs_trace_time(const vs_traces *t, size_t row) {
  return t->value[row * t->columns];
}
