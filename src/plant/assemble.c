/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "assemble.h"

#include <math.h>
#include <stdio.h>

#include "expression.h"
#include "plane.h"

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
  if (m->n_bodies) return vs_plane_matrix(m, sum, values, out, err);
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

/* Two formulas of the same value may be rounded differently; what differs by more is a slip. */
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

/* Of a pivot smaller than this, relative to what it was, only rounding is left. */
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

vs_status vs_assemble_model(vs_machine *m, vs_model *model, vs_error *err) {
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
    s = vs_plane_slopes(&m->load.way[k], plain, m->dof, model->way[k], err);
  if (s) return s;
  bind_others(m, plain);
  model->alone = sole_opener(model);
  model->loaded = false;
  for (int i = 0; i < m->dof; i++) model->loaded = model->loaded || model->constant[i] != 0;
  s = vs_error_carry_on(err, check_mass(m, model, err));
  if (!s) s = vs_error_carry_on(err, check_stiffness(m, model, err));
  return s ? s : check_gap(m, model, err);
}
