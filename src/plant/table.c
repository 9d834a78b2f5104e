/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * From the co-energy Wc(z, i) of the table's flux linkages (plant/surface.h) follow, with i from
 * lambda = dWc/di,
 *
 *   W = lambda i - Wc     F = dW/dz at constant lambda = -dWc/dz at constant i
 *
 * so that the books of energy close whatever the table says. A current below 0 is the mirror of one
 * above: lambda is odd in i, F even. */
#include "table.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/jail.h"
#include "base/path.h"
#include "grid.h"
#include "plant/coil.h"
#include "plant/values.h"
#include "surface.h"

typedef struct table {
  vs_surface surface;
  double most_a;                        /* the largest current */
  bool has_force;                       /* the column is there */
  bool added_zero;                      /* rows of i = 0 were not */
  double worst_n, worst_z_m, worst_i_a; /* of the column: its largest deviation, and where */
  double largest_n;                     /* its largest value */
  char file[VS_PATH_SIZE];
} table;

/* ---- what the file has ---- */

/* Finds the largest deviation of the column of forces from those of the energy. */
static void compare_forces(const vs_grid *g, table *t) {
  t->has_force = g->force_n != NULL;
  for (size_t n = 0; t->has_force && n < g->n_i; n++) {
    vs_surface_line line = vs_surface_line_new(&t->surface, g->i_a[n]);
    for (size_t k = 0; k < g->n_z; k++) {
      const double given = fabs(g->force_n[k * g->n_i + n]);
      const double own = vs_surface_line_at(&line, g->z_m[k]).c[0][1];
      const double off = fabs(given - fabs(own));
      t->largest_n = fmax(t->largest_n, given);
      if (off <= t->worst_n) continue;
      t->worst_n = off;
      t->worst_z_m = g->z_m[k];
      t->worst_i_a = g->i_a[n];
    }
    vs_surface_line_free(&line);
  }
}

static vs_status read_table(FILE *stream, table *t, vs_error *err) {
  vs_grid g;
  double at_z, at_i;
  vs_status s = vs_grid_read(t->file, stream, &g, err);
  if (s) return s;
  t->surface = vs_surface_new(g.z_m, g.n_z, g.i_a, g.n_i, g.flux_wb);
  t->most_a = g.i_a[g.n_i - 1];
  t->added_zero = g.added_zero;
  compare_forces(&g, t);
  vs_grid_free(&g);
  if (vs_surface_rises(&t->surface, &at_z, &at_i)) return VS_OK;
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
  s = read_table(stream, t, err);
  fclose(stream);
  if (s) return s;
  const double *z = t->surface.z_m, least_m = z[0], most_m = z[t->surface.n_z - 1];
  double slack = 1e-9 * most_m;
  if (c->gap_rest_m < least_m - slack || c->gap_rest_m > most_m + slack)
    return vs_fail_at(err, where,
                      "actuator.law: the gap at rest, gap + pole_cover = %.9g mm, is not within "
                      "those of the table, %.9g..%.9g mm",
                      1e3 * c->gap_rest_m, 1e3 * least_m, 1e3 * most_m);
  c->rest_h = 2 * vs_surface_at(&t->surface, 0, c->gap_rest_m).c[2][0];
  return VS_OK;
}

static void table_end(vs_coil *c) {
  table *t = c->own;
  if (t) vs_surface_free(&t->surface);
  free(t);
  c->own = NULL;
}

static const vs_surface *surface_of(const vs_coil *c) {
  return &((const table *)c->own)->surface;
}

/* The size of the current, A, and the co-energy there. */
static vs_surface_point point_at(const vs_coil *c, double flux_wb, double z_m, double *size_a) {
  *size_a = vs_surface_current(surface_of(c), fabs(flux_wb), z_m);
  return vs_surface_at(surface_of(c), *size_a, z_m);
}

static double table_current(const vs_coil *c, double flux_wb, double z_m) {
  return copysign(vs_surface_current(surface_of(c), fabs(flux_wb), z_m), flux_wb);
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
  const vs_surface_point p = point_at(c, flux[0], z[0], size);
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
  const vs_surface *s = &t->surface;
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
