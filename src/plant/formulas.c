/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law "formula": current, energy and force from the formulas of a machine's file. The file writes
 * the force as -dW/dz at fixed lambda, which is negative where it closes the gap; the program's
 * force is +dW/dz.
 *
 * One of current and energy must be there. What is missing follows: the current is dW/dlambda, the
 * force -dW/dz, each as a formula; without a formula for the energy it is the integral of the
 * current over lambda, and the force without one the integral of di/dz. */
#include "plant/law.h"

#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "derivative.h"
#include "plant/b_source.h"
#include "plant/coil.h"
#include "plant/values.h"

enum { LAMBDA, Z, TERMS };             /* the terms of the formulas */
enum { CURRENT, ENERGY, FORCE };       /* the order of vs_law_formulas.where */
enum { NODES = 32, MOST_PANELS = 32 }; /* of Gauss and Legendre's rule */

typedef struct written {
  vs_formula current, energy, force; /* energy, force: empty where they are integrals */
  double sign;                       /* the force is this times its formula */
  vs_formula slope;                  /* di/dz, where the force is its integral */
  gsl_integration_glfixed_table *rule;
  int panels;
} written;

static double formula_at(const vs_formula *f, double flux_wb, double z_m) {
  const double terms[TERMS] = {flux_wb, z_m};
  return vs_formula_value(f, terms);
}

static double partial_at(const vs_formula *f, int to, double flux_wb, double z_m) {
  vs_jet terms[TERMS] = {{{flux_wb}}, {{z_m}}};
  terms[to].d[1] = 1;
  return vs_derivative_along(f, terms).d[1];
}

/* Adds to sum[k] the integral of a formula over one term, the other fixed: its value and, where
 * rates is true, its first two derivatives to z. */
static void integrate(const written *w, const vs_formula *f, int over, const double point[TERMS],
                      double from, bool rates, double sum[3]) {
  double width = (point[over] - from) / w->panels;
  double terms[TERMS] = {point[LAMBDA], point[Z]};
  for (int p = 0; p < w->panels; p++)
    for (size_t n = 0; n < NODES; n++) {
      double weight;
      gsl_integration_glfixed_point(from + p * width, from + (p + 1) * width, n, &terms[over],
                                    &weight, w->rule);
      const vs_jet jets[TERMS] = {{{terms[LAMBDA]}}, {{terms[Z], 1, 0}}};
      if (!rates) {
        sum[0] += weight * vs_formula_value(f, terms);
        continue;
      }
      vs_jet at = vs_derivative_along(f, jets);
      for (int k = 0; k < 3; k++) sum[k] += weight * at.d[k];
    }
}

static double formula_current(const vs_coil *c, double flux_wb, double z_m) {
  const written *w = c->own;
  return formula_at(&w->current, flux_wb, z_m);
}

static double formula_force(const vs_coil *c, double flux_wb, double z_m) {
  const written *w = c->own;
  return w->sign * formula_at(&w->force, flux_wb, z_m);
}

/* W = int_0^lambda i dlambda at z, plus the energy without flux: the integral of F(0, z) from the
 * gap at rest on, which is 0 but where there is a magnet. */
static double formula_energy(const vs_coil *c, double flux_wb, double z_m) {
  const written *w = c->own;
  if (w->energy.count) return formula_at(&w->energy, flux_wb, z_m);
  double sum[3] = {0}, idle[3] = {0};
  const double point[TERMS] = {flux_wb, z_m}, without[TERMS] = {0, z_m};
  integrate(w, &w->current, LAMBDA, point, 0, false, sum);
  if (w->force.count && formula_at(&w->force, 0, z_m) != 0)
    integrate(w, &w->force, Z, without, c->gap_rest_m, false, idle);
  return sum[0] + w->sign * idle[0];
}

/* A formula's value and rates on the path. */
static void path_of(const vs_formula *f, double sign, const double flux[3], const double z[3],
                    double out[3]) {
  const vs_jet terms[TERMS] = {{{flux[0], flux[1], flux[2]}}, {{z[0], z[1], z[2]}}};
  vs_jet found = vs_derivative_along(f, terms);
  for (int k = 0; k < 3; k++) out[k] = sign * found.d[k];
}

static void formula_along(const vs_coil *c, const double flux[3], const double z[3],
                          double current[3], double force[3]) {
  const written *w = c->own;
  path_of(&w->current, 1, flux, z, current);
  path_of(&w->force, w->sign, flux, z, force);
}

static double integrated_force(const vs_coil *c, double flux_wb, double z_m) {
  const written *w = c->own;
  const double point[TERMS] = {flux_wb, z_m};
  double sum[3] = {0};
  integrate(w, &w->slope, LAMBDA, point, 0, false, sum);
  return sum[0];
}

/* With g = di/dz, F = int_0^lambda g dlambda and its derivatives to z, F_z and F_zz:
 *   F' = g lambda' + F_z z'
 *   F" = g lambda" + g_lambda lambda'^2 + 2 g_z lambda' z' + F_zz z'^2 + F_z z" */
static void integrated_along(const vs_coil *c, const double flux[3], const double z[3],
                             double current[3], double force[3]) {
  const written *w = c->own;
  const double point[TERMS] = {flux[0], z[0]};
  double sum[3] = {0};
  path_of(&w->current, 1, flux, z, current);
  integrate(w, &w->slope, LAMBDA, point, 0, true, sum);
  double g = formula_at(&w->slope, flux[0], z[0]);
  double g_lambda = partial_at(&w->slope, LAMBDA, flux[0], z[0]);
  double g_z = partial_at(&w->slope, Z, flux[0], z[0]);
  force[0] = sum[0];
  force[1] = g * flux[1] + sum[1] * z[1];
  force[2] = g * flux[2] + g_lambda * flux[1] * flux[1] + 2 * g_z * flux[1] * z[1] +
             sum[2] * z[1] * z[1] + sum[1] * z[2];
}

static const char *formula_beyond(const vs_coil *c, double flux_wb, double z_m, char *text,
                                  size_t size) {
  if (isfinite(formula_current(c, flux_wb, z_m))) return NULL;
  snprintf(text, size,
           "the formula of the current is no finite number at lambda = %.6g Wb, "
           "z = %.6g mm",
           flux_wb, 1e3 * z_m);
  return text;
}

static void formula_netlist(const vs_coil *c, const char *flux, const char *gap, vs_text *lines,
                            vs_text *current, vs_text *force) {
  (void)lines;
  const written *w = c->own;
  const char *const terms[TERMS] = {flux, gap};
  vs_b_source_formula(current, &w->current, terms);
  if (w->sign < 0) vs_text_add(force, "(-");
  vs_b_source_formula(force, &w->force, terms);
  if (w->sign < 0) vs_text_add(force, ")");
}

/* ---- building ---- */

static vs_formula copy(const vs_formula *f) {
  vs_formula out = {vs_alloc(f->count, sizeof *f->ops), f->count};
  memcpy(out.ops, f->ops, f->count * sizeof *f->ops);
  return out;
}

/* The formula as it stands in the file, or else the derivative of another one. */
static vs_status take_or_derive(const vs_formula *own, const vs_formula *other, int term,
                                vs_where where, vs_formula *out, vs_error *err) {
  if (own) *out = copy(own);
  if (own || !other || vs_derivative_to(other, term, out)) return VS_OK;
  return vs_fail_at(err, where,
                    "the derivative of this formula grows too long; write the file's current and "
                    "force as formulas, too");
}

static vs_status take_all(const vs_law_formulas *f, const vs_node *map, written *w, vs_error *err) {
  if (!f || !(f->current || f->energy)) {
    vs_where at = f && f->force ? f->where[FORCE] : map ? map->where : (vs_where){0};
    return vs_fail_at(err, at,
                      "law formula wants the machine file's 'actuator: {current: ...}' or "
                      "'energy', as formulas in lambda and z");
  }
  if (f->energy) w->energy = copy(f->energy);
  w->sign = f->force ? -1 : 1;
  vs_status status =
      take_or_derive(f->current, f->energy, LAMBDA, f->where[ENERGY], &w->current, err);
  if (status) return status;
  if (f->force || f->energy)
    return take_or_derive(f->force, f->energy, Z, f->where[ENERGY], &w->force, err);
  return take_or_derive(NULL, &w->current, Z, f->where[CURRENT], &w->slope, err);
}

/* The range over which the formulas are checked and the integrals are tried. */
typedef struct range {
  double flux_wb, from_m, to_m;
} range;
enum { FLUXES = 12, GAPS = 7 };

/* Gaps from the pole cover to half as far again as at rest, and flux linkages up to where the
 * current at rest is some 10 A, or as far as the formula is finite. */
static range working_range(const vs_actuator_values *v, const vs_coil *c) {
  range r = {1e-9, v->pole_cover_m > 0 ? v->pole_cover_m : c->gap_rest_m / 50, 1.5 * c->gap_rest_m};
  while (r.flux_wb < 1e6 && fabs(formula_current(c, r.flux_wb, c->gap_rest_m)) < 10 &&
         isfinite(formula_current(c, 2 * r.flux_wb, c->gap_rest_m)))
    r.flux_wb *= 2;
  return r;
}

/* The k-th of FLUXES values of both signs, each half of the one before. */
static double flux_of(const range *r, int k) {
  return (k % 2 ? -1 : 1) * r->flux_wb * pow(0.5, k / 2);
}
static double gap_of(const range *r, int k) {
  return r->from_m + (r->to_m - r->from_m) * k / (GAPS - 1);
}

/* lambda without current, at the gap at rest, by Newton's method; the inductance there. */
static vs_status find_rest(vs_coil *c, vs_where where, vs_error *err) {
  const written *w = c->own;
  double flux = 0, slope = 0, i = 0;
  for (int k = 0; k < 50; k++) {
    slope = partial_at(&w->current, LAMBDA, flux, c->gap_rest_m);
    i = formula_at(&w->current, flux, c->gap_rest_m);
    if (!(slope > 0) || !isfinite(slope) || fabs(i) <= 1e-14 * fabs(slope * flux) || i == 0) break;
    flux -= i / slope;
  }
  c->rest_h = 1 / slope;
  if (slope > 0 && isfinite(slope) && isfinite(i)) return VS_OK;
  if (!isfinite(slope) || !isfinite(i))
    return vs_fail_at(err, where,
                      "the current or di/dlambda is no finite number at lambda = %g Wb, z = %g m; "
                      "write a formula that has both around lambda = 0",
                      flux, c->gap_rest_m);
  return vs_fail_at(err, where,
                    "the current must grow with lambda; at lambda = %g Wb, z = %g m it is %g A "
                    "and di/dlambda = %g A/Wb",
                    flux, c->gap_rest_m, i, slope);
}

/* One check over the range: two functions that must agree to 1e-6, or to 1e-9 of the largest at the
 * same gap, as both come from few operations. */
typedef struct check {
  const char *left, *right; /* what they are */
  const vs_formula *of_left, *of_right;
  int to_left, to_right; /* the term to which each is derived; TERMS: it is the value itself */
  double sign;           /* left must be this times right */
  vs_where where;
} check;

static double side(const vs_formula *f, int to, double flux_wb, double z_m) {
  return to == TERMS ? formula_at(f, flux_wb, z_m) : partial_at(f, to, flux_wb, z_m);
}

static vs_status compare_with_difference(const check *c, const range *r, vs_error *err) {
  for (int n = 0; n < GAPS; n++) {
    double z = gap_of(r, n), largest = 0;
    for (int k = 0; k < FLUXES; k++) {
      double flux = flux_of(r, k);
      double left = side(c->of_left, c->to_left, flux, z);
      double right = c->sign * side(c->of_right, c->to_right, flux, z);
      largest = fmax(largest, fmax(fabs(left), fabs(right)));
      if (fabs(left - right) <= fmax(1e-6 * fmax(fabs(left), fabs(right)), 1e-9 * largest))
        continue;
      bool turned = c->sign < 0 && fabs(left + right) <= 1e-6 * fabs(left);
      return vs_fail_at(err, c->where,
                        "%s is %.9g at lambda = %.6g Wb, z = %.6g m, but %s is %.9g%s", c->left,
                        left, flux, z, c->right, right,
                        turned ? "; turn the force's sign: what closes the gap is negative" : "");
    }
  }
  return VS_OK;
}

/* i = dW/dlambda and F = -dW/dz; without an energy dF/dlambda = -di/dz. */
static vs_status check_all(const written *w, const vs_law_formulas *f, const range *r,
                           vs_error *err) {
  const check current = {.left = "the current",
                         .right = "dW/dlambda of the energy",
                         .of_left = &w->current,
                         .of_right = &w->energy,
                         .to_left = TERMS,
                         .to_right = LAMBDA,
                         .sign = 1,
                         .where = f->where[CURRENT]};
  const check force = {.left = "the force",
                       .right = "-dW/dz of the energy",
                       .of_left = &w->force,
                       .of_right = &w->energy,
                       .to_left = TERMS,
                       .to_right = Z,
                       .sign = -1,
                       .where = f->where[FORCE]};
  const check both = {.left = "dF/dlambda of the force",
                      .right = "-di/dz of the current",
                      .of_left = &w->force,
                      .of_right = &w->current,
                      .to_left = LAMBDA,
                      .to_right = Z,
                      .sign = -1,
                      .where = f->where[FORCE]};
  vs_status status = VS_OK;
  if (f->current && f->energy) status = compare_with_difference(&current, r, err);
  if (!status && f->force && f->energy) status = compare_with_difference(&force, r, err);
  if (!status && f->force && !f->energy) status = compare_with_difference(&both, r, err);
  return status;
}

/* Doubles the panels until the integrals over the range stay the same to 1e-11, or as near as 32
 * panels come. */
static void choose_panels(vs_coil *c, const range *r) {
  written *w = c->own;
  double before[FLUXES][GAPS] = {{0}}, worst = 1;
  w->rule = vs_checked(gsl_integration_glfixed_table_alloc(NODES));
  for (w->panels = 1; worst > 1e-11 && w->panels <= MOST_PANELS; w->panels *= 2) {
    worst = 0;
    for (int k = 0; k < FLUXES; k++)
      for (int n = 0; n < GAPS; n++) {
        double flux = flux_of(r, k), z = gap_of(r, n);
        double now = w->slope.count ? integrated_force(c, flux, z) : formula_energy(c, flux, z);
        if (fabs(now) > 0) worst = fmax(worst, fabs(now - before[k][n]) / fabs(now));
        before[k][n] = now;
      }
  }
  w->panels /= 2;
}

static const vs_law INTEGRATED;

static void fold(written *w) {
  vs_formula_fold(&w->current);
  vs_formula_fold(&w->energy);
  vs_formula_fold(&w->force);
  vs_formula_fold(&w->slope);
}

static vs_status formula_build(const vs_actuator_values *v, const vs_node *map,
                               const vs_law_formulas *formulas, vs_coil *c, vs_error *err) {
  written *w = vs_alloc(1, sizeof *w);
  c->own = w;
  vs_status status = take_all(formulas, map, w, err);
  if (!status) status = find_rest(c, formulas->where[formulas->current ? CURRENT : ENERGY], err);
  if (status) return status;
  range r = working_range(v, c);
  status = check_all(w, formulas, &r, err);
  if (status) return status;
  fold(w);
  if (w->slope.count) c->law = &INTEGRATED;
  if (!w->energy.count) choose_panels(c, &r);
  return VS_OK;
}

static void formula_end(vs_coil *c) {
  written *w = c->own;
  if (!w) return;
  vs_formula_free(&w->current);
  vs_formula_free(&w->energy);
  vs_formula_free(&w->force);
  vs_formula_free(&w->slope);
  if (w->rule) gsl_integration_glfixed_table_free(w->rule);
  free(w);
}

/* The law whose force is an integral, which no netlist can hold. */
static const vs_law INTEGRATED = {.name = "formula",
                                  .text = "with the force as an integral of the current",
                                  .end = formula_end,
                                  .poles = true,
                                  .current = formula_current,
                                  .force = integrated_force,
                                  .energy = formula_energy,
                                  .along = integrated_along,
                                  .beyond = formula_beyond};

const vs_law vs_formulas_law = {.name = "formula",
                                .text = "the formulas of the machine's file: current, energy and "
                                        "force in lambda and z",
                                .build = formula_build,
                                .end = formula_end,
                                .poles = true,
                                .current = formula_current,
                                .force = formula_force,
                                .energy = formula_energy,
                                .along = formula_along,
                                .beyond = formula_beyond,
                                .netlist = formula_netlist};
