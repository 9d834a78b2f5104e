/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/build.h"

#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/section_cache.h"
#include "expression.h"
#include "plant/machine.h"
#include "plant/mechanics.h"
#include "plant/model.h"

/* A machine's formulas become numbers in this order: M, B and K of bodies and springs where it has
 * such; M, B, K, f0 and c of formulas; checks; and what follows from the matrices: M^-1 B, modes,
 * the speeds that step lengths follow. */

/* ---- M, B and K of bodies and springs in the plane (plant/machine_file.h), for small motion ----
 */

enum { X, Y, TURN, MOTIONS, DOF = VS_MACHINE_COORDINATES };

/* How a body moves, per coordinate: its centre of mass along x and y, and its turn. */
typedef struct motion {
  double at[2];
  double by[MOTIONS][DOF];
} motion;

static vs_status expression_value(vs_expression *e, const double *values, const char *what,
                                  double *value, vs_error *err) {
  if (vs_expression_value(e, values, value)) return VS_OK;
  return vs_fail_at(err, e->where, "%s: the value is not finite (%g) with these parameters", what,
                    *value);
}

/* A motion is linear in the coordinates but for this part of itself; a larger part is no rounding.
 */
static const double LINEAR_TO = 1e-12;

/* The slopes of a linear form of the coordinates, which are its terms: its values at unit
 * coordinates; 0 where it has no text. Error with its place: it is not linear, or not 0 at rest. */
static vs_status plane_slopes(vs_expression *e, const double values[VS_MACHINE_NAMES], int dof,
                              double out[DOF], vs_error *err) {
  double q[DOF] = {0}, sum = 0, scale = 0;
  memset(out, 0, DOF * sizeof *out);
  if (!e->text) return VS_OK;
  vs_formula_bind(&e->of, values);
  double rest = vs_formula_value(&e->of, q);
  for (int k = 0; k < dof; k++) {
    q[k] = 1;
    out[k] = vs_formula_value(&e->of, q) - rest;
    q[k] = 0;
  }
  for (int k = 0; k < dof; k++) {
    q[k] = (k % 2 ? 1 : -1) * (0.75 + k % 3); /* any other place */
    sum += q[k] * out[k];
    scale += fabs(q[k] * out[k]);
  }
  double off = fabs(vs_formula_value(&e->of, q) - sum);
  if (rest == 0 && off <= LINEAR_TO * scale) return VS_OK;
  return vs_fail_at(err, e->where,
                    "'%s' is not linear in the coordinates; motion is small here, and 0 at rest",
                    e->text);
}

/* Adds to a row what a motion of the body gives to a point (x, y) in that direction:
 *   x' = x'_c - (y - y_c) turn',  y' = y'_c + (x - x_c) turn' */
static void add_point(const motion *body, const double point[2], const double direction[2],
                      double sign, double row[DOF]) {
  double lever = direction[Y] * (point[X] - body->at[X]) - direction[X] * (point[Y] - body->at[Y]);
  for (int k = 0; k < DOF; k++)
    row[k] += sign * (direction[X] * body->by[X][k] + direction[Y] * body->by[Y][k] +
                      lever * body->by[TURN][k]);
}

/* What is summed up, and of what. */
typedef struct plane {
  vs_machine *machine;
  const double *values; /* of the machine's names */
  motion body[VS_MACHINE_BODIES];
  double (*out)[DOF];
} plane;

/* The motion of a body: that of the one it stands on, and its own. */
static vs_status find_motion(plane *p, int index, vs_error *err) {
  static const double AXIS[2][2] = {{1, 0}, {0, 1}};
  vs_body *b = &p->machine->bodies[index];
  motion *own = &p->body[index];
  vs_status s = VS_OK;
  for (int d = 0; d < MOTIONS && !s; d++) {
    s = plane_slopes(&b->moves[d], p->values, p->machine->dof, own->by[d], err);
    if (!s && d < 2) s = expression_value(&b->at[d], p->values, b->name, &own->at[d], err);
  }
  if (s || b->on < 0) return s;
  const motion *below = &p->body[b->on];
  for (int d = 0; d < 2; d++) add_point(below, own->at, AXIS[d], 1, own->by[d]);
  for (int k = 0; k < DOF; k++) own->by[TURN][k] += below->by[TURN][k];
  return VS_OK;
}

static void add_product(plane *p, double factor, const double row[DOF]) {
  for (int i = 0; i < p->machine->dof; i++)
    for (int j = 0; j < p->machine->dof; j++) p->out[i][j] += factor * row[i] * row[j];
}

/* The kinetic energy is the sum of m (x'^2 + y'^2)/2 + J turn'^2/2. */
static vs_status add_body(plane *p, int index, vs_error *err) {
  vs_body *b = &p->machine->bodies[index];
  double mass = 0, inertia = 0;
  vs_status s = expression_value(&b->mass, p->values, b->name, &mass, err);
  if (!s) s = expression_value(&b->inertia, p->values, b->name, &inertia, err);
  for (int d = 0; d < MOTIONS && !s; d++)
    add_product(p, d == TURN ? inertia : mass, p->body[index].by[d]);
  return s;
}

typedef double points[2][2];

/* The direction of a spring that has one, of length 1. */
static vs_status find_direction(const plane *p, vs_spring *s, points point, double direction[2],
                                vs_error *err) {
  vs_status status = VS_OK;
  for (int d = 0; d < 2 && !status; d++) {
    direction[d] = point[1][d] - point[0][d];
    if (s->directed)
      status = expression_value(&s->along[d], p->values, s->name, &direction[d], err);
  }
  if (status) return status;
  double length = hypot(direction[X], direction[Y]);
  if (!(length > 0))
    return vs_fail_at(err, s->where,
                      "spring %s: its points are one, so that it has no direction; give it one by "
                      "`along`, or stiffness: [x, y]",
                      s->name);
  direction[X] /= length;
  direction[Y] /= length;
  return VS_OK;
}

/* Adds what a spring or damper of that strength c does by its extension e along a direction, of
 * which the energy or half the power is c e^2/2. */
static void add_extension(plane *p, const vs_spring *s, points point, const double direction[2],
                          double strength) {
  double row[DOF] = {0};
  for (int end = 0; end < 2; end++)
    if (s->body[end] >= 0)
      add_point(&p->body[s->body[end]], point[end], direction, end ? 1 : -1, row);
  add_product(p, strength, row);
}

static vs_status add_spring(plane *p, int sum, vs_spring *s, vs_error *err) {
  vs_expression *of = sum == VS_MACHINE_DAMPING ? s->damping : s->stiffness;
  points point;
  double strength[2] = {0}, direction[2] = {1, 0};
  vs_status status = VS_OK;
  for (int d = 0; d < 2 && !status; d++) {
    status = expression_value(&s->point[1][d], p->values, s->name, &point[1][d], err);
    point[0][d] = point[1][d];
    if (!status && s->point[0][d].text)
      status = expression_value(&s->point[0][d], p->values, s->name, &point[0][d], err);
    if (!status) status = expression_value(&of[d], p->values, s->name, &strength[d], err);
  }
  if (!status && !s->apart) status = find_direction(p, s, point, direction, err);
  if (status) return status;
  add_extension(p, s, point, direction, strength[0]);
  if (s->apart) add_extension(p, s, point, (const double[2]){0, 1}, strength[1]);
  return VS_OK;
}

/* Fills one of the three with these values of the machine's names. sum: VS_MACHINE_MASS,
 * VS_MACHINE_DAMPING or VS_MACHINE_STIFFNESS. Errors with their place: a value that is not finite,
 * a motion that is not linear, a spring without a direction. */
static vs_status plane_matrix(vs_machine *m, int sum, const double values[VS_MACHINE_NAMES],
                              double out[DOF][DOF], vs_error *err) {
  plane p = {.machine = m, .values = values, .out = out};
  vs_status s = VS_OK;
  for (int k = 0; k < m->n_bodies && !s; k++) s = find_motion(&p, k, err);
  for (int k = 0; k < m->n_bodies && sum == VS_MACHINE_MASS && !s; k++) s = add_body(&p, k, err);
  for (int k = 0; k < m->n_springs && sum != VS_MACHINE_MASS && !s; k++)
    s = add_spring(&p, sum, &m->springs[k], err);
  return s;
}

/* ---- M, B, K, f0 and c ---- */

typedef double matrix[VS_MOST_DOF][VS_MOST_DOF];

/* ---- values of names ---- */

static vs_status not_finite(const vs_expression *e, double value, const char *what, const char *of,
                            vs_error *err) {
  return vs_fail_at(err, e->where, "%s%s: the value is not finite (%g) with these parameters", what,
                    of, value);
}

/* The parameters' values, with a mass of load_kg added where the load goes, and those of the lets
 * that follow from them. */
static vs_status fill_values(vs_machine *m, const vs_machine_values *v, double load_kg,
                             double values[VS_MACHINE_NAMES], vs_error *err) {
  for (int k = 0; k < m->n_parameters; k++) {
    int choice = m->names[k].choice;
    values[k] = choice < 0 ? v->real[k] : v->choice[choice];
  }
  if (m->load.adds >= 0) values[m->load.adds] += load_kg;
  for (int k = m->n_parameters; k < m->n_names; k++) {
    vs_expression *let = &m->lets[k - m->n_parameters];
    values[k] = 0;
    if (!let->of_gap && !vs_expression_value(let, values, &values[k]))
      return not_finite(let, values[k], "let ", m->names[k].name, err);
  }
  return VS_OK;
}

/* ---- sums ---- */

static vs_status fill_matrix(vs_machine *m, int sum, const double values[VS_MACHINE_NAMES],
                             matrix out, vs_error *err) {
  if (m->n_bodies) return plane_matrix(m, sum, values, out, err);
  char of[2 * VS_MACHINE_NAME + 8];
  for (int i = 0; i < m->dof; i++)
    for (int j = 0; j < m->dof; j++) {
      if (vs_expression_value(&m->sums[sum][i][j], values, &out[i][j])) continue;
      snprintf(of, sizeof of, " of %s, %s", m->coordinates[i].name, m->coordinates[j].name);
      return not_finite(&m->sums[sum][i][j], out[i][j], vs_machine_sum_words[sum], of, err);
    }
  return VS_OK;
}

/* along: how the coordinates open the gap, else the forces on them. */
static vs_status fill_vector(vs_machine *m, bool along, const double values[VS_MACHINE_NAMES],
                             double *out, vs_error *err) {
  for (int i = 0; i < m->dof; i++) {
    vs_expression *from = along ? &m->along[i] : &m->forces[i];
    if (!vs_expression_value(from, values, &out[i]))
      return not_finite(from, out[i], along ? "gap.along of " : "forces of ",
                        m->coordinates[i].name, err);
  }
  return VS_OK;
}

/* ---- checks ---- */

/* Where an entry of a matrix stands, or the coordinate of its row, where bodies make it. */
static vs_where place_of(const vs_machine *m, int sum, int row, int column) {
  const vs_expression *e = &m->sums[sum][row][column];
  return e->text ? e->where : m->coordinates[row].where;
}

/* Two formulas of the same value may be rounded differently; a larger difference is a mistake. */
static const double ROUNDING = 1e-9;

static vs_status check_symmetric(const vs_machine *m, int sum, matrix a, vs_error *err) {
  for (int i = 0; i < m->dof; i++)
    for (int j = 0; j < i; j++)
      if (fabs(a[i][j] - a[j][i]) > ROUNDING * fmax(fabs(a[i][j]), fabs(a[j][i])))
        return vs_fail_at(err, place_of(m, sum, i, j),
                          "%s is not symmetric: %s, %s is %.9g, and %s, %s is %.9g",
                          vs_machine_sum_words[sum], m->coordinates[i].name, m->coordinates[j].name,
                          a[i][j], m->coordinates[j].name, m->coordinates[i].name, a[j][i]);
  return VS_OK;
}

/* A pivot that is smaller than this, relative to the diagonal entry that it began as, is rounding
 * alone. */
static const double SMALLEST_PIVOT = 1e-14;

/* The first coordinate at which a symmetric matrix turns out not to be positive definite, by
 * Cholesky's pivots; -1: it is. Coordinates in `without` are left out. */
static int culprit_of(int dof, matrix a, const bool without[VS_MOST_DOF]) {
  matrix l;
  for (int i = 0; i < dof; i++) {
    if (without[i]) continue;
    for (int j = 0; j <= i; j++) {
      if (without[j]) continue;
      double sum = a[i][j];
      for (int k = 0; k < j; k++)
        if (!without[k]) sum -= l[i][k] * l[j][k];
      if (i == j && !(sum > SMALLEST_PIVOT * a[i][i])) return i;
      l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
    }
  }
  return -1;
}

/* True for a coordinate whose row and column are 0. */
static bool is_free(int dof, matrix a, int i) {
  for (int j = 0; j < dof; j++)
    if (a[i][j] != 0 || a[j][i] != 0) return false;
  return true;
}

static vs_status check_mass(const vs_machine *m, vs_model *model, vs_error *err) {
  static const bool NONE[VS_MOST_DOF];
  vs_status s = check_symmetric(m, VS_MACHINE_MASS, model->mass, err);
  if (s) return s;
  for (int i = 0; i < m->dof; i++)
    if (is_free(m->dof, model->mass, i))
      return vs_fail_at(err, place_of(m, VS_MACHINE_MASS, i, i),
                        "mass: coordinate %s has no mass; each needs one", m->coordinates[i].name);
  int i = culprit_of(m->dof, model->mass, NONE);
  return i < 0 ? VS_OK
               : vs_fail_at(err, place_of(m, VS_MACHINE_MASS, i, i),
                            "mass is not positive definite: the row of %s has %.9g in its diagonal "
                            "(look at masses, inertias and centres of mass)",
                            m->coordinates[i].name, model->mass[i][i]);
}

static vs_status check_stiffness(const vs_machine *m, vs_model *model, vs_error *err) {
  bool without[VS_MOST_DOF];
  vs_status s = check_symmetric(m, VS_MACHINE_STIFFNESS, model->stiffness, err);
  if (s) return s;
  for (int i = 0; i < m->dof; i++) without[i] = is_free(m->dof, model->stiffness, i);
  int i = culprit_of(m->dof, model->stiffness, without);
  return i < 0 ? VS_OK
               : vs_fail_at(err, place_of(m, VS_MACHINE_STIFFNESS, i, i),
                            "stiffness is not positive definite, so that the machine has no stable "
                            "place to rest: nothing is left of the row of %s, %.9g in its "
                            "diagonal, once the rows above are taken off (look at the springs and "
                            "where they stand)",
                            m->coordinates[i].name, model->stiffness[i][i]);
}

static vs_status check_gap(const vs_machine *m, const vs_model *model, vs_error *err) {
  for (int i = 0; i < m->dof; i++)
    if (model->along[i] != 0) return VS_OK;
  return vs_fail_at(err, m->where_along,
                    "gap.along: no coordinate moves the gap; one at least is wanted, as {%s: 1}",
                    m->coordinates[0].name);
}

/* ---- all of it ---- */

static void bind_others(vs_machine *m, const double values[VS_MACHINE_NAMES]) {
  for (int k = 0; k < m->n_probes; k++) vs_formula_bind(&m->probes[k].of, values);
  for (int k = 0; k < VS_MACHINE_LAWS; k++) vs_formula_bind(&m->law[k].of, values);
}

/* As vs_model.alone has it: 0 unless one coordinate alone opens the gap, by as much as it moves. */
static int sole_opener(const vs_model *model) {
  int sole = 0, n = 0;
  for (int i = 0; i < model->dof; i++)
    if (model->along[i] != 0) sole = i + 1, n++;
  return n == 1 && model->along[sole - 1] == 1 ? sole : 0;
}

/* Fills the model's matrices and vectors from the machine's formulas with the model's parameters
 * and load, and binds the formulas of the probes and of the law. Errors with their place in the
 * machine's file: a value that is not finite; an M or a K that is not symmetric or not positive
 * definite (a coordinate without any spring aside); a gap that no coordinate opens. */
static vs_status assemble_model(vs_machine *m, vs_model *model, vs_error *err) {
  const vs_load_values *load = &model->load;
  double plain[VS_MACHINE_NAMES], loaded[VS_MACHINE_NAMES];
  double load_kg = model->riding * load->density_kg_m3 * load->volume_m3; /* Eq. 88 */
  const double *of[VS_MACHINE_SUMS];
  for (int k = 0; k < VS_MACHINE_SUMS; k++) of[k] = m->load.to[k] && load_kg != 0 ? loaded : plain;
  model->dof = m->dof;
  vs_status s = fill_values(m, &model->parameters, 0, plain, err);
  if (!s && load_kg != 0) s = fill_values(m, &model->parameters, load_kg, loaded, err);
  if (!s) s = fill_matrix(m, VS_MACHINE_MASS, of[VS_MACHINE_MASS], model->mass, err);
  if (!s) s = fill_matrix(m, VS_MACHINE_DAMPING, of[VS_MACHINE_DAMPING], model->damping, err);
  if (!s) s = fill_matrix(m, VS_MACHINE_STIFFNESS, of[VS_MACHINE_STIFFNESS], model->stiffness, err);
  if (!s) s = fill_vector(m, false, of[VS_MACHINE_FORCES], model->constant, err);
  if (!s) s = fill_vector(m, true, plain, model->along, err);
  for (int k = 0; k < VS_MACHINE_WAYS && !s; k++)
    s = plane_slopes(&m->load.way[k], plain, m->dof, model->way[k], err);
  if (s) return s;
  bind_others(m, plain);
  model->alone = sole_opener(model);
  model->loaded = false;
  for (int i = 0; i < m->dof; i++) model->loaded = model->loaded || model->constant[i] != 0;
  s = vs_error_keep(err, check_mass(m, model, err));
  if (!s) s = vs_error_keep(err, check_stiffness(m, model, err));
  return s ? s : check_gap(m, model, err);
}

/* ---- what follows from the matrices ---- */

/* M^-1 B, M^-1 K, -M^-1 c and M^-1 f0 by Cholesky, which works, as M is positive definite. */
static void solve_mass(vs_model *model) {
  double m[VS_MOST_DOF * VS_MOST_DOF], column[VS_MOST_DOF];
  size_t n = (size_t)model->dof;
  for (int i = 0; i < model->dof; i++)
    for (int j = 0; j < model->dof; j++) m[i * model->dof + j] = model->mass[i][j];
  gsl_matrix_view mv = gsl_matrix_view_array(m, n, n);
  gsl_vector_view cv = gsl_vector_view_array(column, n);
  gsl_linalg_cholesky_decomp1(&mv.matrix);
  for (int j = 0; j < 2 * model->dof + 2; j++) {
    int of_k = j - model->dof, other = j - 2 * model->dof;
    double *into = other == 1   ? model->m0
                   : other == 0 ? model->mf
                   : of_k >= 0  ? model->mk_column[of_k]
                                : model->mb_column[j];
    for (int i = 0; i < model->dof; i++)
      column[i] = other == 1   ? model->constant[i]
                  : other == 0 ? -model->along[i]
                  : of_k >= 0  ? model->stiffness[i][of_k]
                               : model->damping[i][j];
    gsl_linalg_cholesky_svx(&mv.matrix, &cv.vector);
    memcpy(into, column, n * sizeof *column);
  }
}

/* c.K^-1 c; INFINITY where a coordinate has no spring, and K no inverse. */
static double compliance(const vs_model *model) {
  double k[VS_MOST_DOF * VS_MOST_DOF], x[VS_MOST_DOF];
  size_t n = (size_t)model->dof;
  memcpy(x, model->along, sizeof x);
  for (int i = 0; i < model->dof; i++)
    if (model->stiffness[i][i] == 0) return INFINITY;
  for (int i = 0; i < model->dof; i++)
    for (int j = 0; j < model->dof; j++) k[i * model->dof + j] = model->stiffness[i][j];
  gsl_matrix_view kv = gsl_matrix_view_array(k, n, n);
  gsl_vector_view xv = gsl_vector_view_array(x, n);
  gsl_linalg_cholesky_decomp1(&kv.matrix);
  gsl_linalg_cholesky_svx(&kv.matrix, &xv.vector);
  return vs_mechanics_travel(model, x);
}

/* Of the fastest mode's |s|: a mode that grows more slowly has no damping but for rounding. */
static const double GROWS = 1e-9;

/* What follows from the modes, for step lengths and warnings. */
static vs_status find_speeds(vs_model *model, vs_error *err) {
  vs_mode *modes = model->mode;
  if (!vs_mechanics_modes(model, modes))
    return vs_fail_at(
        err, (vs_where){model->machine->path, 1, 1},
        "the eigenvalues of the mechanics cannot be found; masses or springs are too unlike");
  double drive = 0;
  model->fastest_rad_s = model->working_rad_s = model->growth_1_s = 0;
  for (int m = 0; m < 2 * model->dof; m++) {
    double size = hypot(modes[m].re_1_s, modes[m].im_rad_s);
    if (size > model->fastest_rad_s) model->fastest_rad_s = size;
    if (modes[m].drive > drive) {
      drive = modes[m].drive;
      model->working_rad_s = size;
    }
  }
  for (int m = 0; m < 2 * model->dof; m++)
    if (modes[m].re_1_s > GROWS * model->fastest_rad_s)
      model->growth_1_s = fmax(model->growth_1_s, modes[m].re_1_s);
  model->contact_rad_s = model->fastest_rad_s;
  for (int k = 0; k < model->stops.count; k++) {
    const vs_stop *stop = &model->stops.item[k];
    double per_newton = fabs(model->per_newton_m_s2);
    double rad_s = model->fastest_rad_s + sqrt(stop->kind->steepest(stop) * per_newton) +
                   stop->damping_ns_m * per_newton;
    model->contact_rad_s = fmax(model->contact_rad_s, rad_s);
  }
  return VS_OK;
}

/* What follows from the matrices. */
static vs_status derive_from_matrices(vs_model *model, vs_error *err) {
  solve_mass(model);
  model->compliance_m_n = compliance(model);
  model->per_newton_m_s2 = 0;
  for (int i = 0; i < model->dof; i++) model->per_newton_m_s2 += model->along[i] * model->mf[i];
  return find_speeds(model, err);
}

/* ---- the section actuator ---- */

/* Nodes of the scene's section actuator over those of the machine's. */
typedef struct merged {
  vs_node node[96];
  size_t count;
} merged;

static vs_node *add_node(merged *all, const vs_node *from) {
  if (all->count >= sizeof all->node / sizeof *all->node) return NULL;
  vs_node *node = &all->node[all->count++];
  *node = *from;
  node->next = NULL;
  return node;
}

/* The map `over` with the keys of `under` that it lacks, down to the last map. What has no room is
 * left out. */
static vs_node *merge_maps(merged *all, const vs_node *under, const vs_node *over) {
  vs_node *map = add_node(all, over);
  if (!map) return NULL;
  vs_node **tail = &map->child;
  *tail = NULL;
  for (const vs_node *n = over->child; n; n = n->next) {
    const vs_node *low = vs_tree_child(under, n->key);
    bool maps = low && low->kind == VS_NODE_MAP && n->kind == VS_NODE_MAP;
    *tail = maps ? merge_maps(all, low, n) : add_node(all, n);
    if (*tail) tail = &(*tail)->next;
  }
  for (const vs_node *n = under->child; n; n = n->next) {
    if (vs_tree_child(over, n->key)) continue;
    *tail = add_node(all, n);
    if (*tail) tail = &(*tail)->next;
  }
  return map;
}

/* The machine's map without the formulas of its law, which are no keys of the scene. */
static const vs_node *without_law(merged *all, const vs_node *own) {
  if (!own) return NULL;
  vs_node *map = add_node(all, own), **tail = &map->child;
  *tail = NULL;
  for (const vs_node *n = own->child; n; n = n->next) {
    bool law = false;
    for (int k = 0; k < VS_MACHINE_LAWS; k++) law = law || !strcmp(n->key, vs_machine_law_words[k]);
    if (!law) *tail = add_node(all, n);
    if (*tail) tail = &(*tail)->next;
  }
  return map;
}

/* True where the scene takes another law than the machine's own: the machine's keys, which may be
 * of its law alone, then say nothing. */
static bool names_other_law(const vs_node *scene, const vs_node *own) {
  const vs_node *law = vs_tree_child(vs_tree_child(scene, "actuator"), "law"),
                *standard = vs_tree_child(own, "law");
  if (!law || law->kind != VS_NODE_TEXT) return false;
  return !standard || standard->kind != VS_NODE_TEXT || strcmp(law->text, standard->text) != 0;
}

static vs_status build_actuator(const vs_node *map, vs_model *model, vs_error *err) {
  const vs_expression *law = model->machine->law;
  const vs_formula *of[VS_MACHINE_LAWS];
  vs_law_formulas formulas = {0};
  for (int k = 0; k < VS_MACHINE_LAWS; k++) {
    of[k] = law[k].text ? &law[k].of : NULL;
    formulas.where[k] = law[k].where;
  }
  formulas.current = of[VS_MACHINE_CURRENT];
  formulas.energy = of[VS_MACHINE_ENERGY];
  formulas.force = of[VS_MACHINE_FORCE];
  return vs_actuator_build(&model->actuator, map, &formulas, &model->coil, &model->stops, err);
}

/* ---- the sections ---- */

/* Error: the scene has a load, and the machine has no place for it. */
static vs_status check_load(const vs_machine *machine, const vs_node *load, vs_error *err) {
  if (machine->load.adds >= 0 || !load || !load->child) return VS_OK;
  return vs_fail_at(err, load->child->key_where,
                    "load.%s: machine %s has no load (its file has no key load); leave it out",
                    load->child->key, machine->path);
}

/* Error: load.fraction is auto, and the machine does not say which of its motions throws. */
static vs_status check_auto(const vs_machine *machine, const vs_load_values *load,
                            const vs_node *scene, vs_error *err) {
  const vs_node *node = vs_tree_child(vs_tree_child(scene, "load"), "fraction");
  if (machine->load.adds < 0 || !isnan(load->fraction) || !node ||
      machine->load.way[VS_MACHINE_ALONG].text)
    return VS_OK;
  return vs_fail_at(err, node->where,
                    "load.fraction: auto wants to know which motion throws, and machine %s does "
                    "not say (its file has no load.along); write a number",
                    machine->path);
}

/* Reads the sections of the scene; actuator is the scene's over the machine's. */
static vs_status read_sections(const vs_node *scene, const vs_node *actuator, vs_model *model,
                               vs_error *err) {
  const vs_machine *machine = model->machine;
  const vs_node *load = vs_tree_child(scene, "load");
  const vs_section *section = &machine->section;
  vs_status s = vs_error_keep(err, check_load(machine, load, err));
  if (!s)
    s = vs_field_section_read(section, vs_tree_child(scene, section->name), &model->parameters,
                              err);
  if (!s) s = vs_field_section_read(&machine->actuator, actuator, &model->actuator, err);
  return s ? s : vs_field_section_read(&vs_model_load_section, load, &model->load, err);
}

vs_status vs_build_model(const vs_node *scene, vs_machine *machine, vs_model *model,
                         vs_error *err) {
  *model = (vs_model){.machine = machine, .dof = machine->dof};
  size_t found = vs_error_count(err);
  if (machine->lost)
    return VS_OK; /* a check carries on elsewhere: further errors here may only be consequences */
  merged all = {.count = 0};
  const vs_node *map = vs_tree_child(scene, "actuator"),
                *own = without_law(&all, machine->own_actuator);
  bool both = own && map && map->kind == VS_NODE_MAP;
  if (both)
    map = merge_maps(&all, own, map);
  else if (own && (!map || (map->kind == VS_NODE_TEXT && !*map->text)))
    map = own;
  vs_status s = read_sections(scene, map, model, err);
  if (!s) s = vs_error_keep(err, check_auto(machine, &model->load, scene, err));
  if (s || vs_error_count(err) > found) return s;
  model->riding = isnan(model->load.fraction) ? vs_model_load_range.least : model->load.fraction;
  s = assemble_model(machine, model, err);
  if (!s && vs_error_count(err) == found)
    s = build_actuator(names_other_law(scene, own) ? vs_tree_child(scene, "actuator") : map, model,
                       err);
  if (s || vs_error_count(err) > found) return s;
  const vs_stop *first = model->stops.item;
  const vs_node *kind = vs_tree_child(machine->own_supply, "kind");
  model->pulls_in = vs_stops_closing(&model->stops) >= 0 && kind && kind->text &&
                    !strcmp(kind->text, "step"); /* a scene may say another one */
  model->plain =
      model->coil.square &&
      (!model->stops.count || (model->stops.count == 1 && first->kind->linear && first->side > 0));
  return derive_from_matrices(model, err);
}

vs_status vs_build_again(const vs_node *scene, vs_machine *machine, vs_model *model,
                         vs_text *written, vs_error *err) {
  const char *const sections[] = {machine->section.name, "actuator", "load"};
  vs_text now = {0};
  for (size_t k = 0; k < sizeof sections / sizeof *sections; k++)
    vs_section_cache_key(vs_tree_child(scene, sections[k]), &now);
  bool same = written->length == now.length && !memcmp(written->text, now.text, now.length);
  vs_text_free(written);
  if (same && model->machine == machine && !isnan(model->load.fraction)) {
    *written = now;
    return VS_OK;
  }
  vs_actuator_end(&model->coil);
  size_t found = vs_error_count(err);
  vs_status s = vs_build_model(scene, machine, model, err);
  if (s || vs_error_count(err) > found)
    vs_text_free(&now);
  else
    *written = now;
  return s;
}

vs_status vs_build_loaded(vs_machine *machine, const vs_model *from, const vs_load_values *load,
                          double riding, vs_model *out, vs_error *err) {
  if (out != from) *out = *from;
  out->load = *load;
  out->riding = riding;
  vs_status s = assemble_model(machine, out, err);
  return s ? s : derive_from_matrices(out, err);
}
