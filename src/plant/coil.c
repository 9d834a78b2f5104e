/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/coil.h"

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
