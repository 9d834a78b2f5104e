/* SPDX-License-Identifier: GPL-3.0-or-later
 * The two tiers with an ideal thyristor: it conducts or it does not, and the instants between are
 * located exactly. */
#ifndef VS_SIM_PHASES_H
#define VS_SIM_PHASES_H

#include "sim/sim.h"

/* What differs between the two while the thyristor conducts; off, lambda = 0 and the machine swings
 * freely. */
typedef struct vs_conduction {
  const vs_frame *frame;
  double fired_s, fired_phase_rad; /* of the mains then, -pi..pi */
  /* dlambda/dt, V, and (when not NULL) d2lambda/dt2, V/s, with flux linkage lambda and state x.
   * Time counts from firing, so that it is as fine after hours as at the beginning. */
  double (*flux_rate)(const struct vs_conduction *c, double since_s, double flux_wb,
                      const double x[VS_STATES], double *rate2);
} vs_conduction;

/* mains voltage, V, and its rate, V/s, since_s after firing */
double vs_conduction_mains(const vs_conduction *c, double since_s);
double vs_conduction_mains_rate(const vs_conduction *c, double since_s);

vs_status vs_phases_run(const vs_setup *setup, const vs_conduction *conduction,
                        const vs_observer *observer, vs_error *err);

#endif
