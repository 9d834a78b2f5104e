/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law "reluctance": the gap alone holds the field. i = lambda z/(2a), F = lambda^2/(4a) (Eqs. 66-73
 * and 81). Iron that saturates may be added, with r = |lambda|/lambda_s:
 *
 *   series          i = lambda z/(2a) + I_s sign(lambda) r^n       F = lambda^2/(4a)
 *                   W = lambda^2 z/(4a) + I_s lambda_s/(n+1) r^(n+1)
 *   multiplicative  i = lambda z/(2a) (1 + r^n)                    F = W/z
 *                   W = z/(2a) lambda^2 (1/2 + r^n/(n+2))
 *
 * and leakage. coil->a_hm is the gap's number in all of these. */
#include "plant/law.h"

#include <math.h>
#include <stdlib.h>

#include "plant/b_source.h"
#include "plant/coil.h"
#include "plant/values.h"

/* ---- plain: the gap alone ---- */

/* Adds a number for the netlist, with what stands around it. */
static void add_number_between(vs_text *text, const char *before, double number,
                               const char *after) {
  vs_text_add(text, "%s", before);
  vs_b_source_number(text, number);
  vs_text_add(text, "%s", after);
}

static double gap_current(const vs_coil *c, double flux_wb, double z_m) {
  return flux_wb * z_m / (2 * c->a_hm);
}

static double gap_force(const vs_coil *c, double flux_wb, double z_m) {
  (void)z_m;
  return flux_wb * flux_wb / (4 * c->a_hm);
}

static double gap_energy(const vs_coil *c, double flux_wb, double z_m) {
  return flux_wb * flux_wb * z_m / (4 * c->a_hm);
}

static void gap_along(const vs_coil *c, const double flux[3], const double z[3], double current[3],
                      double force[3]) {
  double per_2a = 1 / (2 * c->a_hm);
  current[0] = flux[0] * z[0] * per_2a;
  current[1] = (flux[1] * z[0] + flux[0] * z[1]) * per_2a;
  current[2] = (flux[2] * z[0] + 2 * flux[1] * z[1] + flux[0] * z[2]) * per_2a;
  force[0] = flux[0] * flux[0] * per_2a / 2;
  force[1] = flux[0] * flux[1] * per_2a;
  force[2] = (flux[1] * flux[1] + flux[0] * flux[2]) * per_2a;
}

static void gap_netlist(const vs_coil *c, const char *flux, const char *gap, vs_text *lines,
                        vs_text *current, vs_text *force) {
  (void)lines;
  vs_text_add(current, "(%s*%s", flux, gap);
  add_number_between(current, "/", 2 * c->a_hm, ")");
  vs_text_add(force, "(%s*%s", flux, flux);
  add_number_between(force, "/", 4 * c->a_hm, ")");
}

/* ---- with iron that saturates ---- */

typedef struct saturation {
  double flux_wb, exponent, current_a; /* lambda_s, n, I_s */
} saturation;

/* Both laws have an energy of the form W = z P(lambda) + E(lambda). Derivatives of P and E: p[k]
 * and e[k] are the k-th. */
typedef struct energies {
  double p[4], e[4];
} energies;

/* r^(n-2), from which higher powers follow. Below an exponent of 2 it is infinite at r = 0, where
 * all that it is a factor of counts as 0. */
static double low_power(double r, double n) {
  return n >= 2 || r > 0 ? vs_formula_power(r, n - 2) : 0;
}

/* P = lambda^2/(4a), E = I_s lambda_s/(n+1) r^(n+1). */
static energies series_energies(const vs_coil *c, double flux_wb) {
  const saturation *s = c->own;
  double r = fabs(flux_wb) / s->flux_wb, n = s->exponent, sign = copysign(1, flux_wb);
  double q = s->current_a * low_power(r, n), per_2a = 1 / (2 * c->a_hm);
  return (energies){{flux_wb * flux_wb * per_2a / 2, flux_wb * per_2a, per_2a, 0},
                    {q * r * r * r * s->flux_wb / (n + 1), sign * q * r * r, n * q * r / s->flux_wb,
                     sign * n * (n - 1) * q / (s->flux_wb * s->flux_wb)}};
}

/* P = lambda^2/(2a) (1/2 + r^n/(n+2)), E = 0. */
static energies multiplicative_energies(const vs_coil *c, double flux_wb) {
  const saturation *s = c->own;
  double r = fabs(flux_wb) / s->flux_wb, n = s->exponent, sign = copysign(1, flux_wb);
  double q = low_power(r, n), rn = q * r * r, per_2a = 1 / (2 * c->a_hm);
  return (energies){{flux_wb * flux_wb * per_2a * (0.5 + rn / (n + 2)), flux_wb * per_2a * (1 + rn),
                     per_2a * (1 + (n + 1) * rn), sign * per_2a * n * (n + 1) * q * r / s->flux_wb},
                    {0}};
}

/* i = z P' + E' and F = P with their rates, from lambda = flux[0] and so on. */
static void rates(const energies *w, const double flux[3], const double z[3], double current[3],
                  double force[3]) {
  const double *p = w->p, *e = w->e, square = flux[1] * flux[1];
  current[0] = z[0] * p[1] + e[1];
  current[1] = (z[0] * p[2] + e[2]) * flux[1] + z[1] * p[1];
  current[2] = (z[0] * p[2] + e[2]) * flux[2] + (z[0] * p[3] + e[3]) * square +
               2 * z[1] * p[2] * flux[1] + z[2] * p[1];
  force[0] = p[0];
  force[1] = p[1] * flux[1];
  force[2] = p[1] * flux[2] + p[2] * square;
}

static double series_current(const vs_coil *c, double flux_wb, double z_m) {
  energies w = series_energies(c, flux_wb);
  return z_m * w.p[1] + w.e[1];
}
static double series_energy(const vs_coil *c, double flux_wb, double z_m) {
  energies w = series_energies(c, flux_wb);
  return z_m * w.p[0] + w.e[0];
}
static void series_along(const vs_coil *c, const double flux[3], const double z[3],
                         double current[3], double force[3]) {
  energies w = series_energies(c, flux[0]);
  rates(&w, flux, z, current, force);
}
static double multiplicative_current(const vs_coil *c, double flux_wb, double z_m) {
  return z_m * multiplicative_energies(c, flux_wb).p[1];
}
static double multiplicative_force(const vs_coil *c, double flux_wb, double z_m) {
  (void)z_m;
  return multiplicative_energies(c, flux_wb).p[0];
}
static double multiplicative_energy(const vs_coil *c, double flux_wb, double z_m) {
  return z_m * multiplicative_energies(c, flux_wb).p[0];
}
static void multiplicative_along(const vs_coil *c, const double flux[3], const double z[3],
                                 double current[3], double force[3]) {
  energies w = multiplicative_energies(c, flux[0]);
  rates(&w, flux, z, current, force);
}

/* Adds "pow(abs(lambda/lambda_s),n)". */
static void put_power(vs_text *text, const saturation *s, const char *flux) {
  vs_text_add(text, "pow(abs(%s", flux);
  add_number_between(text, "/", s->flux_wb, "),");
  add_number_between(text, "", s->exponent, ")");
}

static void series_netlist(const vs_coil *c, const char *flux, const char *gap, vs_text *lines,
                           vs_text *current, vs_text *force) {
  (void)lines;
  const saturation *s = c->own;
  vs_text_add(current, "(%s*%s", flux, gap);
  add_number_between(current, "/", 2 * c->a_hm, "+");
  add_number_between(current, "", s->current_a, "*");
  vs_text_add(current, "sgn(%s)*", flux);
  put_power(current, s, flux);
  vs_text_add(current, ")");
  vs_text_add(force, "(%s*%s", flux, flux);
  add_number_between(force, "/", 4 * c->a_hm, ")");
}
static void multiplicative_netlist(const vs_coil *c, const char *flux, const char *gap,
                                   vs_text *lines, vs_text *current, vs_text *force) {
  (void)lines;
  const saturation *s = c->own;
  vs_text raised = {0};
  put_power(&raised, s, flux);
  vs_text_add(current, "(%s*%s*(1+%s)", flux, gap, raised.text);
  add_number_between(current, "/", 2 * c->a_hm, ")");
  vs_text_add(force, "(%s*%s*(0.5+%s", flux, flux, raised.text);
  add_number_between(force, "/", s->exponent + 2, ")");
  add_number_between(force, "/", 2 * c->a_hm, ")");
  vs_text_free(&raised);
}

static void saturation_end(vs_coil *c) {
  free(c->own);
}

static const vs_law LAWS[] = {{.name = "reluctance",
                               .text = "with iron in series with the gap",
                               .end = saturation_end,
                               .poles = true,
                               .current = series_current,
                               .force = gap_force,
                               .energy = series_energy,
                               .along = series_along,
                               .netlist = series_netlist},
                              {.name = "reluctance",
                               .text = "with iron that multiplies the current",
                               .end = saturation_end,
                               .poles = true,
                               .current = multiplicative_current,
                               .force = multiplicative_force,
                               .energy = multiplicative_energy,
                               .along = multiplicative_along,
                               .netlist = multiplicative_netlist}};

static void saturate(vs_coil *c, const vs_saturation_values *v) {
  saturation *s = vs_alloc(1, sizeof *s);
  *s = (saturation){v->flux_wb, v->exponent, v->current_a};
  c->own = s;
  c->square = false;
  c->law = &LAWS[v->law];
  /* the inductance without current: an exponent of 1 or 0 adds to i even there */
  const double flux[3] = {0, 1, 0}, z[3] = {c->gap_rest_m, 0, 0};
  double current[3], force[3];
  c->law->along(c, flux, z, current, force);
  c->rest_h = 1 / current[1];
}

/* ---- leakage ---- */

/* Flux that links the coil and not the gap. With the inner law's i(lambda_g, z), W_g and F_g:
 *
 *   lambda = lambda_g + L_k i(lambda_g, z),  W = W_g + L_k i^2/2,  F = F_g(lambda_g, z)
 */

typedef struct leaky_coil {
  vs_coil inner; /* what is without leakage */
  double leakage_h;
} leaky_coil;

/* The inner law's current and force, and their slopes to lambda. */
typedef struct inner_slopes {
  double current, per_flux, force_per_flux;
} inner_slopes;

static inner_slopes inner_slopes_at(const vs_coil *inner, double flux_wb, double z_m) {
  const double flux[3] = {flux_wb, 1, 0}, z[3] = {z_m, 0, 0};
  double current[3], force[3];
  inner->law->along(inner, flux, z, current, force);
  return (inner_slopes){current[0], current[1], force[1]};
}

/* lambda_g by Newton's method. It lies between 0 and lambda, as i has the sign of lambda_g; a step
 * that leaves what is left of this interval becomes its middle. The steps end where they are
 * rounding: after some 6, or 12 far in saturation. */
static double inner_flux(const leaky_coil *l, double flux_wb, double z_m) {
  double low = fmin(0, flux_wb), high = fmax(0, flux_wb), least = INFINITY;
  double x = flux_wb / (1 + l->leakage_h * inner_slopes_at(&l->inner, 0, z_m).per_flux);
  for (int k = 0; k < 100; k++) {
    inner_slopes s = inner_slopes_at(&l->inner, x, z_m);
    double miss = x + l->leakage_h * s.current - flux_wb;
    double step = miss / (1 + l->leakage_h * s.per_flux);
    if (miss > 0) high = x;
    if (miss < 0) low = x;
    bool settled = fabs(step) <= 1e-9 * fabs(x) && fabs(step) >= least;
    if (settled || miss == 0) break;
    least = fabs(step);
    double next = x - step;
    if (next == x) break;
    x = next > low && next < high ? next : (low + high) / 2;
    if (x == low || x == high) break;
  }
  return x;
}

static double leaky_current(const vs_coil *c, double flux_wb, double z_m) {
  const leaky_coil *l = c->own;
  return l->inner.law->current(&l->inner, inner_flux(l, flux_wb, z_m), z_m);
}
static double leaky_force(const vs_coil *c, double flux_wb, double z_m) {
  const leaky_coil *l = c->own;
  return l->inner.law->force(&l->inner, inner_flux(l, flux_wb, z_m), z_m);
}
static double leaky_energy(const vs_coil *c, double flux_wb, double z_m) {
  const leaky_coil *l = c->own;
  double inner = inner_flux(l, flux_wb, z_m), i = l->inner.law->current(&l->inner, inner, z_m);
  return l->inner.law->energy(&l->inner, inner, z_m) + l->leakage_h * i * i / 2;
}

/* i and F are affine in the highest derivative of lambda_g: the k-th derivative of i is what it is
 * for lambda_g^(k) = 0, called b, plus i_lambda lambda_g^(k). So from lambda^(k) = lambda_g^(k) +
 * L_k i^(k) follows lambda_g^(k) = (lambda^(k) - L_k b)/(1 + L_k i_lambda). */
static void leaky_along(const vs_coil *c, const double flux[3], const double z[3],
                        double current[3], double force[3]) {
  const leaky_coil *l = c->own;
  const vs_law *law = l->inner.law;
  double inner[3] = {inner_flux(l, flux[0], z[0]), 0, 0};
  inner_slopes s = inner_slopes_at(&l->inner, inner[0], z[0]);
  double per = 1 / (1 + l->leakage_h * s.per_flux);
  law->along(&l->inner, inner, z, current, force);
  inner[1] = (flux[1] - l->leakage_h * current[1]) * per;
  law->along(&l->inner, inner, z, current, force);
  inner[2] = (flux[2] - l->leakage_h * current[2]) * per;
  current[2] += s.per_flux * inner[2];
  force[2] += s.force_per_flux * inner[2];
}

/* The node lamg holds lambda_g, V for Wb: no current flows into it, where the equation above holds.
 */
static void leaky_netlist(const vs_coil *c, const char *flux, const char *gap, vs_text *lines,
                          vs_text *current, vs_text *force) {
  const leaky_coil *l = c->own;
  l->inner.law->netlist(&l->inner, "v(lamg)", gap, lines, current, force);
  vs_text_add(lines, "Blamg 0 lamg I = %s-v(lamg)-", flux);
  vs_b_source_number(lines, l->leakage_h);
  vs_text_add(lines, "*(%s)\n", current->text);
}

static void leaky_end(vs_coil *c) {
  leaky_coil *l = c->own;
  if (l->inner.law->end) l->inner.law->end(&l->inner);
  free(l);
}

static const vs_law LEAKY = {.name = "reluctance",
                             .text = "with leakage",
                             .end = leaky_end,
                             .poles = true,
                             .current = leaky_current,
                             .force = leaky_force,
                             .energy = leaky_energy,
                             .along = leaky_along,
                             .netlist = leaky_netlist};

/* Gives a coil, whose law is built, this leakage inductance. The current of its law must grow with
 * lambda and be 0 where lambda is 0. */
static void leakage_add(vs_coil *c, double leakage_h) {
  leaky_coil *l = vs_alloc(1, sizeof *l);
  *l = (leaky_coil){*c, leakage_h};
  c->own = l;
  c->square = false;
  c->law = &LEAKY;
  c->rest_h += leakage_h;
}

/* ---- the law ---- */

static vs_status reluctance_build(const vs_actuator_values *v, const vs_node *map,
                                  const vs_law_formulas *formulas, vs_coil *c, vs_error *err) {
  (void)map, (void)formulas, (void)err;
  c->square = true;
  c->rest_h = v->inductance_h;
  c->a_hm = v->inductance_h * c->gap_rest_m / 2;
  if (v->saturation.present) saturate(c, &v->saturation);
  if (v->leakage_h > 0) leakage_add(c, v->leakage_h);
  return VS_OK;
}

const vs_law vs_reluctance_law = {.name = "reluctance",
                                  .text = "i = lambda z/(2a), F = lambda^2/(4a), with saturation "
                                          "and leakage where the scene has them",
                                  .keys = "inductance|leakage|saturation|linear_to",
                                  .build = reluctance_build,
                                  .poles = true,
                                  .current = gap_current,
                                  .force = gap_force,
                                  .energy = gap_energy,
                                  .along = gap_along,
                                  .netlist = gap_netlist};
