/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "leakage.h"

#include <math.h>
#include <stdlib.h>

#include "plant/coil.h"
#include "plant/spice.h"

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
  vs_spice_number(lines, l->leakage_h);
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

void vs_leakage_add(vs_coil *c, double leakage_h) {
  leaky_coil *l = vs_alloc(1, sizeof *l);
  *l = (leaky_coil){*c, leakage_h};
  c->own = l;
  c->square = false;
  c->law = &LEAKY;
  c->rest_h += leakage_h;
}
