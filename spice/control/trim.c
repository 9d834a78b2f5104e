/* SPDX-License-Identifier: MIT
 * A law of control as a shared object: it holds the swing of p, half peak to peak, at 1 mm. As long
 * as the machine swings too little it fires a little earlier in each cycle, else a little later.
 *
 *   cc -shared -fPIC -I PREFIX/include -o trim.so trim.c */
#include <math.h>
#include <stdio.h>
#include <vibrospice/law.h>

static const double WANTED_M = 1e-3;   /* the swing */
static const double GAIN_DEG_M = 2000; /* by how much earlier, for each metre that is missing */
static const double FIRST_DEG = 150;   /* of the first firing */
static const double LEAST_DEG = 90, MOST_DEG = 170;

double vibrospice_law(const vibrospice_firing *firing, char *error) {
  static double angle_deg; /* its memory, which begins anew with each run */
  const vibrospice_channel *p = vibrospice_channel_named(firing, "p_meas_m");
  if (!p) {
    snprintf(error, VIBROSPICE_LAW_TEXT, "wants an instrument p, whose column is p_meas_m");
    return NAN;
  }
  if (firing->number == 1)
    angle_deg = FIRST_DEG;
  else
    angle_deg -= GAIN_DEG_M * (WANTED_M - (p->largest - p->least) / 2);
  angle_deg = fmax(LEAST_DEG, fmin(MOST_DEG, angle_deg));
  return angle_deg;
}
