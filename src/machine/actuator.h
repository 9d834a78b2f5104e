/* SPDX-License-Identifier: GPL-3.0-or-later
 * The electromagnetic vibratory actuator (EVA): Eqs. 66-73 and 81, with the flux linkage lambda as
 * its state. The force depends on the flux linkage alone: F = a i^2/z^2 = lambda^2/(4a). */
#ifndef VS_MACHINE_ACTUATOR_H
#define VS_MACHINE_ACTUATOR_H

#include "machine/model.h"

/* The air gap z = D + d + p, m. */
static inline double vs_actuator_gap(const vs_model *m, double p_m) {
  return m->gap_rest_m + p_m;
}
/* The current i = lambda z/(2a), A (Eqs. 66, 81). */
static inline double vs_actuator_current(const vs_model *m, double flux_wb, double z_m) {
  return flux_wb * z_m / (2 * m->a_hm);
}
/* Its rate di/dt = (dlambda/dt z + lambda dz/dt)/(2a), A/s. */
static inline double vs_actuator_current_rate(const vs_model *m, double flux_wb, double flux_rate_v,
                                              double z_m, double z_rate_m_s) {
  return (flux_rate_v * z_m + flux_wb * z_rate_m_s) / (2 * m->a_hm);
}
/* The force F = lambda^2/(4a), N (Eqs. 71, 72). It pulls the armature towards the pole. */
static inline double vs_actuator_force(const vs_model *m, double flux_wb) {
  return flux_wb * flux_wb / (4 * m->a_hm);
}
/* Its rate dF/dt = lambda dlambda/dt/(2a), N/s. */
static inline double vs_actuator_force_rate(const vs_model *m, double flux_wb, double flux_rate_v) {
  return flux_wb * flux_rate_v / (2 * m->a_hm);
}
/* The energy stored in the air gap, lambda^2 z/(4a), J. It equals the co-energy of Eq. 69, as the
 * EVA is linear. */
static inline double vs_actuator_energy(const vs_model *m, double flux_wb, double z_m) {
  return flux_wb * flux_wb * z_m / (4 * m->a_hm);
}

#endif
