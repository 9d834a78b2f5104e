/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law of a file: flux linkage over gap and current as a table, from a field solver or measured. Its
 * column of forces, if it has one, is compared only, in size.
 *
 * From the co-energy Wc(z, i) of the table's flux linkages (plant/coenergy.h) follow, with i from
 * lambda = dWc/di,
 *
 *   W = lambda i - Wc     F = dW/dz at constant lambda = -dWc/dz at constant i
 *
 * so that the books of energy close whatever the table says. A current below 0 is the mirror of one
 * above: lambda is odd in i, F even. */
#include "plant/law.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/jail.h"
#include "base/path.h"
#include "base/text.h"
#include "base/units.h"
#include "coenergy.h"
#include "plant/coil.h"
#include "plant/values.h"

/* ---- the grid of a file ---- */

/* Reads a table of an actuator: a CSV file whose first line names its columns in any order, z_m,
 * i_a, lambda_wb and, if wanted, force_n. Other prefixes of the units are taken (z_mm, i_ma). Its
 * gaps and currents form a grid: every gap has the same currents. */

/* The table in SI; grid_free it. flux_wb and force_n at z_m[k], i_a[n] are item k*n_i + n. */
typedef struct vs_grid {
  size_t n_z, n_i; /* gaps and currents, at least 4 each */
  double *z_m;     /* > 0, rising; owns the memory of all four */
  double *i_a;     /* from 0 on, rising */
  double *flux_wb; /* rises with i, 0 where i is */
  double *force_n; /* as in the file, of either sign; NULL: it has no such column */
  bool added_zero; /* the file has no rows of i = 0; lambda = 0 is taken there */
} vs_grid;

enum { LEAST = 4, MOST = 1000 }; /* of gaps and of currents, 0 included */

enum { Z, I, LAMBDA, FORCE, COLUMNS };
static const struct {
  const char *name, *unit, *example;
} COLUMN[COLUMNS] = {
    {"z", "m", "z_m"}, {"i", "A", "i_a"}, {"lambda", "Wb", "lambda_wb"}, {"force", "N", "force_n"}};

typedef struct row {
  double value[COLUMNS]; /* SI */
  int line;
} row;

typedef struct rows {
  row *item; /* owned */
  size_t count, room;
  int column[COLUMNS]; /* where in a line; -1: it is not there */
  double factor[COLUMNS];
} rows;

/* Finds out which column is which. */
static vs_status read_grid_head(vs_csv *csv, rows *r, vs_error *err) {
  for (int c = 0; c < COLUMNS; c++) r->column[c] = -1;
  for (size_t k = 0; k < csv->count; k++) {
    const char *word = csv->cell[k], *bar = strchr(word, '_');
    size_t length = bar ? (size_t)(bar - word) : strlen(word);
    int c = 0;
    while (c < COLUMNS &&
           (strlen(COLUMN[c].name) != length || strncmp(COLUMN[c].name, word, length) != 0))
      c++;
    double factor = c < COLUMNS && bar ? vs_units_suffix_factor(bar + 1, COLUMN[c].unit) : NAN;
    if (isnan(factor))
      return vs_fail_at(err, csv->where[k],
                        "column '%s' is not known in a table of an actuator; there are: z_m, i_a, "
                        "lambda_wb and force_n",
                        word);
    if (r->column[c] >= 0)
      return vs_fail_at(err, csv->where[k], "column %s stands here a second time; leave one out",
                        word);
    r->column[c] = (int)k;
    r->factor[c] = factor;
  }
  for (int c = 0; c < FORCE; c++)
    if (r->column[c] < 0)
      return vs_fail_at(err, (vs_where){csv->file, csv->line, 1},
                        "there is no column %s; a table of an actuator has z_m, i_a, lambda_wb "
                        "and, if wanted, force_n",
                        COLUMN[c].example);
  return VS_OK;
}

static vs_status read_grid_row(const vs_csv *csv, const rows *r, row *out, vs_error *err) {
  *out = (row){.line = csv->line};
  for (int c = 0; c < COLUMNS; c++) {
    char *end;
    if (r->column[c] < 0) continue;
    size_t k = (size_t)r->column[c];
    if (k >= csv->count)
      return vs_fail_at(err, (vs_where){csv->file, csv->line, 1},
                        "the row has %zu cells, and its column %s is the %zu.", csv->count,
                        COLUMN[c].example, k + 1);
    double value = vs_text_to_number(csv->cell[k], &end);
    if (vs_text_out_of_range(csv->cell[k]))
      return vs_fail_at(err, csv->where[k], "'%s': %s", csv->cell[k],
                        vs_text_out_of_range(csv->cell[k]));
    if (end == csv->cell[k] || *end || !isfinite(value))
      return vs_fail_at(err, csv->where[k], "'%s' is not a number; write one as 1.5e-3",
                        csv->cell[k]);
    out->value[c] = value * r->factor[c];
    bool low = c == Z ? value <= 0 : c == I && value < 0;
    if (low)
      return vs_fail_at(err, csv->where[k],
                        c == Z ? "%s: a gap must be above 0"
                               : "%s: a current must not be below 0; the table is taken as "
                                 "symmetric, lambda as odd in i",
                        csv->cell[k]);
  }
  return VS_OK;
}

static vs_status read_grid_rows(vs_csv *csv, rows *r, vs_error *err) {
  vs_status s = vs_csv_next(csv, err);
  if (!s && !csv->count)
    s = vs_fail_at(err, (vs_where){csv->file, 1, 1},
                   "the table is empty; its first line names its "
                   "columns: z_m,i_a,lambda_wb,force_n");
  if (!s) s = read_grid_head(csv, r, err);
  while (!s) {
    s = vs_csv_next(csv, err);
    if (s || !csv->count) break;
    if (r->count == (size_t)MOST * MOST)
      return vs_fail_at(err, (vs_where){csv->file, csv->line, 1}, "more than %d rows", MOST * MOST);
    if (r->count == r->room) {
      r->room = 2 * r->room + 64;
      r->item = vs_resize(r->item, r->room, sizeof *r->item);
    }
    s = read_grid_row(csv, r, &r->item[r->count], err);
    r->count++;
  }
  return s;
}

static int by_gap_and_current(const void *a, const void *b) {
  const row *x = a, *y = b;
  for (int c = Z; c <= I; c++)
    if (x->value[c] != y->value[c]) return x->value[c] < y->value[c] ? -1 : 1;
  return x->line - y->line;
}

/* Gives each gap a row of i = 0, lambda = 0, where the file has none; returns whether it did. */
static bool add_zeros(rows *r) {
  for (size_t k = 0; k < r->count; k++)
    if (r->item[k].value[I] == 0) return false;
  size_t old = r->count;
  row *more = vs_alloc(2 * old, sizeof *more);
  memcpy(more, r->item, old * sizeof *more);
  for (size_t k = 0; k < old; k++)
    if (!k || r->item[k].value[Z] != r->item[k - 1].value[Z])
      more[r->count++] = (row){.value = {[Z] = r->item[k].value[Z]}, .line = r->item[k].line};
  free(r->item);
  r->item = more;
  qsort(r->item, r->count, sizeof *r->item, by_gap_and_current);
  return true;
}

/* Error, with the line: the rows, which are sorted, are no grid of n_i currents at each gap.
 */
static vs_status check_grid(const rows *r, size_t n_i, const char *file, vs_error *err) {
  for (size_t k = 0; k < r->count; k++) {
    const row *at = &r->item[k], *first = &r->item[k % n_i], *left = k ? at - 1 : NULL;
    const vs_where where = {file, at->line, 1};
    if (left && left->value[Z] == at->value[Z] && left->value[I] == at->value[I])
      return vs_fail_at(err, where,
                        "z = %.9g m, i = %.9g A stands in line %d already; leave one out",
                        at->value[Z], at->value[I], left->line);
    bool begins = !left || left->value[Z] != at->value[Z];
    if (at->value[I] != first->value[I] || begins != (k % n_i == 0))
      return vs_fail_at(err, where,
                        "the table is no grid: at z = %.9g m the currents are not those at z = "
                        "%.9g m; give every gap the same ones",
                        begins && left ? left->value[Z] : at->value[Z], r->item[0].value[Z]);
  }
  if (r->count % n_i)
    return vs_fail_at(err, (vs_where){file, r->item[r->count - 1].line, 1},
                      "the table is no grid: at z = %.9g m currents are missing; give every gap "
                      "the same ones",
                      r->item[r->count - 1].value[Z]);
  return VS_OK;
}

/* Errors: lambda does not rise with i, or is not 0 without current. */
static vs_status check_rising(const rows *r, const char *file, vs_error *err) {
  for (size_t k = 0; k < r->count; k++) {
    const row *at = &r->item[k], *left = at - 1;
    if (at->value[I] == 0 && at->value[LAMBDA] != 0)
      return vs_fail_at(err, (vs_where){file, at->line, 1},
                        "lambda is %.9g Wb without current; it must be 0 there, as the table is "
                        "taken as symmetric",
                        at->value[LAMBDA]);
    if (at->value[I] > 0 && !(at->value[LAMBDA] > left->value[LAMBDA]))
      return vs_fail_at(err, (vs_where){file, at->line, 1},
                        "lambda does not rise with i at z = %.9g m: %.9g Wb at %.9g A and %.9g Wb "
                        "at %.9g A",
                        at->value[Z], left->value[LAMBDA], left->value[I], at->value[LAMBDA],
                        at->value[I]);
  }
  return VS_OK;
}

static vs_status check_size(const char *what, size_t n, const char *file, vs_error *err) {
  if (n >= LEAST && n <= MOST) return VS_OK;
  return vs_fail_at(err, (vs_where){file, 1, 1}, "the number of %s is %zu; a table has %d to %d",
                    what, n, LEAST, MOST);
}

/* Makes the grid of sorted rows. */
static vs_status make_grid(const rows *r, const char *file, vs_grid *g, vs_error *err) {
  size_t n_i = 0, n_z = 0;
  while (n_i < r->count && r->item[n_i].value[Z] == r->item[0].value[Z]) n_i++;
  for (size_t k = 0; k < r->count; k++) n_z += !k || r->item[k].value[Z] != r->item[k - 1].value[Z];
  vs_status s = check_size("gaps", n_z, file, err);
  if (!s) s = check_size("currents, 0 included,", n_i, file, err);
  if (!s) s = check_grid(r, n_i, file, err);
  if (!s) s = check_rising(r, file, err);
  if (s) return s;
  g->n_z = n_z;
  g->n_i = n_i;
  g->z_m = vs_alloc(n_z + n_i + 2 * r->count, sizeof *g->z_m);
  g->i_a = g->z_m + n_z;
  g->flux_wb = g->i_a + n_i;
  double *force = g->flux_wb + r->count;
  if (r->column[FORCE] >= 0) g->force_n = force;
  for (size_t k = 0; k < r->count; k++) {
    g->z_m[k / n_i] = r->item[k].value[Z];
    g->i_a[k % n_i] = r->item[k].value[I];
    g->flux_wb[k] = r->item[k].value[LAMBDA];
    force[k] = r->item[k].value[FORCE];
  }
  return VS_OK;
}

/* file: its name, for errors, which are all told with their line: an unknown or missing column, no
 * number, a gap or a current below 0, no grid, flux linkages that do not rise with the current. */
static vs_status grid_read(const char *file, FILE *stream, vs_grid *g, vs_error *err) {
  vs_csv csv = {.file = file, .stream = stream, .trim = true, .comments = true};
  rows r = {0};
  *g = (vs_grid){0};
  vs_status s = read_grid_rows(&csv, &r, err);
  if (r.count) qsort(r.item, r.count, sizeof *r.item, by_gap_and_current);
  if (!s && r.count) g->added_zero = add_zeros(&r);
  if (!s) s = make_grid(&r, file, g, err);
  free(r.item);
  vs_csv_free(&csv);
  return s;
}

static void grid_free(vs_grid *g) {
  free(g->z_m);
  *g = (vs_grid){0};
}

/* ---- the coil of a grid ---- */

typedef struct table {
  vs_coenergy surface;
  double most_a;                        /* the largest current */
  bool has_force;                       /* the column is there */
  bool added_zero;                      /* rows of i = 0 were not */
  double worst_n, worst_z_m, worst_i_a; /* of the column: its largest deviation, and where */
  double largest_n;                     /* its largest value */
  char file[VS_PATH_SIZE];
} table;

/* Finds the largest deviation of the column of forces from those of the energy. */
static void compare_forces(const vs_grid *g, table *t) {
  t->has_force = g->force_n != NULL;
  for (size_t n = 0; t->has_force && n < g->n_i; n++) {
    vs_coenergy_line line = vs_coenergy_line_new(&t->surface, g->i_a[n]);
    for (size_t k = 0; k < g->n_z; k++) {
      const double given = fabs(g->force_n[k * g->n_i + n]);
      const double own = vs_coenergy_line_at(&line, g->z_m[k]).c[0][1];
      const double off = fabs(given - fabs(own));
      t->largest_n = fmax(t->largest_n, given);
      if (off <= t->worst_n) continue;
      t->worst_n = off;
      t->worst_z_m = g->z_m[k];
      t->worst_i_a = g->i_a[n];
    }
    vs_coenergy_line_free(&line);
  }
}

static vs_status read_grid_into(FILE *stream, table *t, vs_error *err) {
  vs_grid g;
  double at_z, at_i;
  vs_status s = grid_read(t->file, stream, &g, err);
  if (s) return s;
  t->surface = vs_coenergy_new(g.z_m, g.n_z, g.i_a, g.n_i, g.flux_wb);
  t->most_a = g.i_a[g.n_i - 1];
  t->added_zero = g.added_zero;
  compare_forces(&g, t);
  grid_free(&g);
  if (vs_coenergy_rises(&t->surface, &at_z, &at_i)) return VS_OK;
  return vs_fail_at(err, (vs_where){t->file, 1, 1},
                    "between the table's gaps, at z = %.6g m, lambda does not rise with i at %.6g "
                    "A; give more gaps there",
                    at_z, at_i);
}

/* ---- the law ---- */

/* Opens the file: in the folder of the file that names it, or as a path of its own. */
static vs_status open_table(const char *name, vs_where where, char path[VS_PATH_SIZE],
                            FILE **stream, vs_error *err) {
  const char *slash = where.file ? strrchr(where.file, '/') : NULL;
  vs_status status = VS_OK;
  *stream = NULL;
  if (slash && *name != '/') {
    snprintf(path, VS_PATH_SIZE, "%.*s%s", (int)(slash + 1 - where.file), where.file, name);
    status = vs_jail_check(path, where, err);
    if (!status) status = vs_path_check_plain(path, where, err);
    if (!status) status = vs_hash_open(path, stream, err);
  }
  if (status || *stream) return status;
  snprintf(path, VS_PATH_SIZE, "%s", name);
  status = vs_jail_check(path, where, err);
  if (!status) status = vs_path_check_plain(path, where, err);
  if (!status) status = vs_hash_open(path, stream, err);
  if (status || *stream) return status;
  return vs_fail_at(err, where, "actuator.law: the table %s cannot be read: %s", name,
                    strerror(errno));
}

static vs_status table_build(const vs_actuator_values *v, const vs_node *map,
                             const vs_law_formulas *formulas, vs_coil *c, vs_error *err) {
  (void)formulas;
  const vs_node *node = vs_tree_child(map, "law");
  const vs_where where = node ? node->where : (vs_where){0};
  table *t = vs_alloc(1, sizeof *t);
  c->own = t;
  FILE *stream;
  vs_status s = open_table(v->law, where, t->file, &stream, err);
  if (s) return s;
  s = read_grid_into(stream, t, err);
  fclose(stream);
  if (s) return s;
  const double *z = t->surface.z_m, least_m = z[0], most_m = z[t->surface.n_z - 1];
  double slack = 1e-9 * most_m;
  if (c->gap_rest_m < least_m - slack || c->gap_rest_m > most_m + slack)
    return vs_fail_at(err, where,
                      "actuator.law: the gap at rest, gap + pole_cover = %.9g mm, is not within "
                      "those of the table, %.9g..%.9g mm",
                      1e3 * c->gap_rest_m, 1e3 * least_m, 1e3 * most_m);
  c->rest_h = 2 * vs_coenergy_at(&t->surface, 0, c->gap_rest_m).c[2][0];
  return VS_OK;
}

static void table_end(vs_coil *c) {
  table *t = c->own;
  if (t) vs_coenergy_free(&t->surface);
  free(t);
  c->own = NULL;
}

static const vs_coenergy *surface_of(const vs_coil *c) {
  return &((const table *)c->own)->surface;
}

/* The size of the current, A, and the co-energy there. */
static vs_coenergy_point point_at(const vs_coil *c, double flux_wb, double z_m, double *size_a) {
  *size_a = vs_coenergy_current(surface_of(c), fabs(flux_wb), z_m);
  return vs_coenergy_at(surface_of(c), *size_a, z_m);
}

static double table_current(const vs_coil *c, double flux_wb, double z_m) {
  return copysign(vs_coenergy_current(surface_of(c), fabs(flux_wb), z_m), flux_wb);
}

static double table_force(const vs_coil *c, double flux_wb, double z_m) {
  double size;
  return -point_at(c, flux_wb, z_m, &size).c[0][1];
}

static double table_energy(const vs_coil *c, double flux_wb, double z_m) {
  double size, coenergy = point_at(c, flux_wb, z_m, &size).c[0][0];
  return fabs(flux_wb) * size - coenergy;
}

/* i' and i" from lambda = dWc/di along the path, differentiated once and twice in time; F' and F"
 * from F = -dWc/dz in the same way. */
static void table_along(const vs_coil *c, const double flux[3], const double z[3], double i[3],
                        double f[3]) {
  double sign = flux[0] < 0 ? -1 : 1, size[3];
  const vs_coenergy_point p = point_at(c, flux[0], z[0], size);
  const double w_ii = 2 * p.c[2][0], w_iz = p.c[1][1], w_zz = 2 * p.c[0][2], w_iii = 6 * p.c[3][0],
               w_iiz = 2 * p.c[2][1], w_izz = 2 * p.c[1][2], w_zzz = 6 * p.c[0][3];
  size[1] = (sign * flux[1] - w_iz * z[1]) / w_ii;
  size[2] = (sign * flux[2] - w_iii * size[1] * size[1] - 2 * w_iiz * size[1] * z[1] -
             w_izz * z[1] * z[1] - w_iz * z[2]) /
            w_ii;
  f[0] = -p.c[0][1];
  f[1] = -(w_iz * size[1] + w_zz * z[1]);
  f[2] = -(w_iiz * size[1] * size[1] + 2 * w_izz * size[1] * z[1] + w_zzz * z[1] * z[1] +
           w_iz * size[2] + w_zz * z[2]);
  for (int n = 0; n < 3; n++) i[n] = sign * size[n];
}

static const char *table_beyond(const vs_coil *c, double flux_wb, double z_m, char *text,
                                size_t size) {
  const table *t = c->own;
  const vs_coenergy *s = &t->surface;
  double least_m = s->z_m[0], most_m = s->z_m[s->n_z - 1], slack = 1e-9 * most_m;
  if (z_m < least_m - slack || z_m > most_m + slack) {
    snprintf(text, size, "the gap, %.6g mm, is outside the table %s, which has %.6g..%.6g mm",
             1e3 * z_m, t->file, 1e3 * least_m, 1e3 * most_m);
    return text;
  }
  double i = table_current(c, flux_wb, z_m);
  if (fabs(i) <= t->most_a * (1 + 1e-9)) return NULL;
  snprintf(text, size, "the current, %.6g A, is outside the table %s, which has up to %.6g A", i,
           t->file, t->most_a);
  return text;
}

static const char *table_file(const vs_coil *c) {
  return ((const table *)c->own)->file;
}

static const char *table_note(const vs_coil *c, char *text, size_t size) {
  const table *t = c->own;
  const char *slash = strrchr(t->file, '/'); /* the same words from whatever folder */
  if (!t->has_force && !t->added_zero) return NULL;
  int n = snprintf(text, size, "%s:", slash ? slash + 1 : t->file);
  if (t->has_force && n > 0 && (size_t)n < size)
    n += snprintf(text + n, size - (size_t)n,
                  " force_n differs from the slope of lambda's energy, which the run takes, by at "
                  "most %.3g N (%.2g %% of its largest), at z = %.4g mm, i = %.4g A",
                  t->worst_n, t->largest_n > 0 ? 100 * t->worst_n / t->largest_n : 0.0,
                  1e3 * t->worst_z_m, t->worst_i_a);
  if (t->added_zero && n > 0 && (size_t)n < size)
    snprintf(text + n, size - (size_t)n, "%s rows of i = 0 are missing, and lambda = 0 is taken",
             t->has_force ? ";" : "");
  return text;
}

const vs_law vs_table_law = {.name = "FILE.csv",
                             .text = "a table of lambda over gap and current, columns z_m, i_a, "
                                     "lambda_wb; force_n is compared",
                             .ending = ".csv",
                             .build = table_build,
                             .end = table_end,
                             .poles = true,
                             .current = table_current,
                             .force = table_force,
                             .energy = table_energy,
                             .along = table_along,
                             .beyond = table_beyond,
                             .file = table_file,
                             .note = table_note};
