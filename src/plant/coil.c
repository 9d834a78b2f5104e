/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/coil.h"

#include <complex.h>
#include <math.h>

/* Newton's iteration. The current rises with lambda, so that it has one zero; a law that is linear
 * in lambda is there after one step. */
double vs_coil_idle_flux(const vs_coil *c, double z_m) {
  double flux = 0, i[3], f[3];
  const double z[3] = {z_m, 0, 0};
  if (c->square) return 0;
  for (int n = 0; n < 100; n++) {
    const double rising[3] = {flux, 1, 0}; /* the current's rate is then di/dlambda */
    c->law->along(c, rising, z, i, f);
    double step = i[0] / i[1];
    if (!isfinite(step) || fabs(step) <= 1e-15 * fabs(flux)) break;
    flux -= step;
  }
  return flux;
}

void vs_coil_impedance(const vs_coil *c, double z_m, double omega_rad_s, double ohm[2]) {
  const double complex s = I * omega_rad_s;
  const vs_law_rates law = vs_coil_rates(c, vs_coil_idle_flux(c, z_m), 1, z_m, 0);
  double complex y = law.i_rate_a_s / s + c->core_s;
  for (int n = 0; n < c->rungs; n++) {
    const vs_rung *r = &c->rung[n];
    y += r->share * r->share / (r->resistance_ohm * (1 + s / r->rate_1_s));
  }
  const double complex z = c->resistance_ohm + 1 / y;
  ohm[0] = creal(z);
  ohm[1] = cimag(z);
}

/* Re Y of each secondary at the voltage omega lambda. */
double vs_coil_core_loss(const vs_coil *c, double flux_wb, double omega_rad_s) {
  double s = c->core_s;
  for (int n = 0; n < c->rungs; n++) {
    const vs_rung *r = &c->rung[n];
    const double ratio = omega_rad_s / r->rate_1_s;
    s += r->share * r->share / (r->resistance_ohm * (1 + ratio * ratio));
  }
  return s * pow(omega_rad_s * flux_wb, 2) / 2;
}
