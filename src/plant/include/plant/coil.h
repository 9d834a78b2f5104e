/* SPDX-License-Identifier: GPL-3.0-or-later
 * The actuator's coil as numbers. Its flux linkage lambda is a state; the current and the force
 * follow from lambda and the gap z by a law (plant/law.h). The paper's electromagnetic vibratory
 * actuator (EVA) has i = lambda z/(2a) and F = lambda^2/(4a) (Eqs. 66-73 and 81).
 *
 * Eddy currents are shorted secondaries n with a leakage inductance L and a resistance R, which
 * enclose the share k of lambda. Their flux linkages psi = L i + k lambda are states, too:
 *
 *   d psi/dt = -R i_n,   energy W(lambda, z) + sum (psi - k lambda)^2/(2 L),
 *   i = dW/dlambda - sum (k/L)(psi - k lambda),
 *
 * and the force is dW/dz, as without them. One without leakage adds the current k^2/R dlambda/dt.
 */
#pragma once

#include <stdbool.h>

#include "plant/law.h"
#include "plant/winding.h"

/* A secondary with leakage. */
typedef struct vs_rung {
  double share, resistance_ohm; /* k, R */
  double per_h;                 /* k/L */
  double rate_1_s;              /* R/L */
} vs_rung;

struct vs_coil {
  const vs_law *law;
  bool square;           /* i = lambda z/(2a) and F = lambda^2/(4a) hold exactly, and so all that is
                            derived from these two may be used instead of the law's functions */
  double resistance_ohm; /* R_c */
  double gap_rest_m;     /* z at rest: D + d */
  double a_hm;           /* a = L(0) (D + d)/2 (Eq. 72), H m; 0 where the law has no such number */
  double rest_h;         /* inductance without current and at rest, d lambda/d i, H */
  bool eddies;           /* there are secondaries */
  int rungs;             /* how many of them have leakage */
  vs_rung rung[VS_MOST_RUNGS];
  double leak_1_h;       /* sum of k^2/L */
  double core_s;         /* sum of k^2/R of those without leakage */
  double cold_ohm;       /* R_c at 20 degC; resistance_ohm is that of the winding as it is */
  vs_winding_state heat; /* as the run begins */
  void *own;             /* the law's own numbers; owned, constant once built; NULL: none */
};

/* The air gap, m, where the armature has moved by g_m along it: z = D + d + g. */
static inline double vs_coil_gap(const vs_coil *c, double g_m) {
  return c->gap_rest_m + g_m;
}
/* The current i, A (Eqs. 66, 81). */
static inline double vs_coil_current(const vs_coil *c, double flux_wb, double z_m) {
  return c->square ? flux_wb * z_m / (2 * c->a_hm) : c->law->current(c, flux_wb, z_m);
}
/* The force F, N (Eqs. 71, 72); positive where it closes the gap. */
static inline double vs_coil_force(const vs_coil *c, double flux_wb, double z_m) {
  return c->square ? flux_wb * flux_wb / (4 * c->a_hm) : c->law->force(c, flux_wb, z_m);
}
/* The energy stored in the magnetic field, J: int i dlambda at this gap, from no current on. */
static inline double vs_coil_energy(const vs_coil *c, double flux_wb, double z_m) {
  return c->square ? flux_wb * flux_wb * z_m / (4 * c->a_hm) : c->law->energy(c, flux_wb, z_m);
}
/* Current and force, and their rates, where lambda and z change at the given rates. */
static inline vs_law_rates vs_coil_rates(const vs_coil *c, double flux_wb, double flux_rate_v,
                                         double z_m, double z_rate_m_s) {
  if (c->square)
    return (vs_law_rates){flux_wb * z_m / (2 * c->a_hm),
                          (flux_rate_v * z_m + flux_wb * z_rate_m_s) / (2 * c->a_hm),
                          flux_wb * flux_wb / (4 * c->a_hm), flux_wb * flux_rate_v / (2 * c->a_hm)};
  const double flux[3] = {flux_wb, flux_rate_v, 0}, z[3] = {z_m, z_rate_m_s, 0};
  double i[3], f[3];
  c->law->along(c, flux, z, i, f);
  return (vs_law_rates){i[0], i[1], f[0], f[1]};
}

/* What the secondaries with leakage add to the current, A, where lambda and psi have these values;
 * of derivatives it gives the derivative. */
static inline double vs_coil_rungs_current(const vs_coil *c, double flux, const double *psi) {
  double i = c->leak_1_h * flux;
  for (int n = 0; n < c->rungs; n++) i -= c->rung[n].per_h * psi[n];
  return i;
}
/* d psi/dt of the n-th; of derivatives it gives the derivative. */
static inline double vs_coil_rung_rate(const vs_coil *c, int n, double flux, const double *psi) {
  return c->rung[n].rate_1_s * (c->rung[n].share * flux - psi[n]);
}

/* The coil's impedance at an angular frequency, real and imaginary part, ohm: of small currents
 * about none, at a gap that does not move. */
void vs_coil_impedance(const vs_coil *coil, double z_m, double omega_rad_s, double ohm[2]);

/* What the secondaries lose, W, on the average where the flux linkage is a sine of this peak. */
double vs_coil_core_loss(const vs_coil *coil, double flux_wb, double omega_rad_s);

/* The flux linkage, Wb, that the coil has at this gap while it carries no current; 0 but for a law
 * with a magnet or a moving coil. */
double vs_coil_idle_flux(const vs_coil *coil, double z_m);
