/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/swing.h"

#include <math.h>

#include "engine/firing.h"
#include "plant/coil.h"

/* The trapezoidal rule makes an error of lambda of h^2/12 of its third derivative in each second.
 * While the coil rings with the snubbers, these errors add up to an error of the ring's phase. At
 * the next firing that is an error of the flux linkage from which the whole conduction starts, and
 * in between it is the current's own. So a step is as long as keeps
 *
 *   h^2/12 |lambda'''| T <= SHARE run.tolerance max |lambda|
 *
 * with what of lambda''' the rule is not given back (truncation.h), over the time T that the ring
 * may last: LASTS radians of its own, and no more than a cycle of the mains, in which the coil's
 * resistance, if nothing else, has damped it. Measured over the 100 scenes of
 * tests/engine/test_tolerance_grid.c: with SHARE 0.3 an error is up to 2 times the tolerance, with
 * 1 up to 4.8 times. With half of LASTS, or less of T, it is more. */
static const double SHARE = 0.2, LASTS = 100;

/* The sizes of the derivatives fade by this factor a step of a run at 1e-4, and so are remembered
 * over some ten steps: a step must not become longer only because the swing is just where a
 * derivative is zero. At a finer tolerance they are remembered over as long a time: over ten steps
 * of a finer run the error grew against the tolerance, 1.6 times from 1e-4 to 1e-7. */
static const double FADES = 0.9, FADES_AT = 1e-4;

/* A firing at the very end of the half cycle brings next to no flux linkage. Errors are then
 * relative to this share of the most that the mains may bring. */
static const double LEAST = 1e-3;

/* The share of the most that the mains may bring that the run's firings do, up to the end of a run
 * that ends behind the first of them: 0.2 ms behind it the force was off by 10 tolerances at 1e-4.
 * Where the coil is cut off before the first of them can come, they bring nothing to it, and what
 * it has from its snubber rings with the contact's capacitance: by 90 kHz, for 40 radians and more,
 * which a 12 V solenoid's current was 53 tolerances off by at 1e-4. */
static double fired(const vs_setup *s) {
  const vs_timeline *t = &s->timeline;
  double range[2];
  vs_firing_range(t, range);
  double cycle_s = vs_firing_cycle_s(t, 0), ends_rad = t->omega_rad_s * (s->run.until_s - cycle_s);
  if (vs_setup_coil_cut(s) <= cycle_s + range[0] / t->omega_rad_s) return LEAST;
  if (!(ends_rad > range[0] && ends_rad < M_PI)) ends_rad = M_PI;
  return fmax((cos(range[0]) - cos(ends_rad)) / 2, LEAST);
}

vs_swing vs_swing_of(const vs_setup *s) {
  const vs_timeline *t = &s->timeline;
  return (vs_swing){.model = &s->model,
                    .gear = s->run.gear,
                    .amplifies = 1,
                    .current_wb = INFINITY,
                    .peak_a = LEAST * t->peak_v / s->model.coil.resistance_ohm,
                    .tolerance = s->run.tolerance * (s->run.gear ? 0.25 : 1),
                    .share = (s->run.gear ? SHARE / 4 : SHARE) * s->run.tolerance,
                    .fades = pow(FADES, fmin(1, sqrt(s->run.tolerance / FADES_AT))),
                    .period_s = t->period_s,
                    .peak_v = t->peak_v,
                    .flux_wb = fired(s) * t->peak_v / t->omega_rad_s};
}

/* A voltage whose slope changes within a step by more than this share is no swing that steps
 * resolve: it jumped, as a thyristor switched, or the rest of a jump alternates from step to step.
 * Shorter steps would only make more of it; what is true of it the solver's own step control
 * follows. */
static const double RESOLVED = 0.5;

/* The trapezoidal rule does not damp what of v alternates from step to step. It does not put it
 * into lambda at the knots either, but the cubic between two knots has it in its slopes, +-a, and
 * is off by a h/4 half way. An inductance in series with the coil has it from the first steps after
 * a firing: at 1e-14 s its voltage is the rounding of its current. A rule that begins anew, of
 * order one and with a step that is no more so short, is rid of it. It begins anew after ALTERNATES
 * kicks in a row, which no swing that steps resolve makes, and not again before PAUSE steps have
 * passed, so that it costs a few per cent at most. */
static const int ALTERNATES = 6, PAUSE = 200;

static void follow_alternation(vs_swing *w, const vs_knot *from, const vs_knot *to) {
  double rise = to->flux_rate_v - from->flux_rate_v, kick = rise - w->rise_v;
  double off_wb = fabs(kick) / 4 * (to->t_s - from->t_s) / 4; /* a kick is 4 a */
  bool back = kick * w->kick_v < 0 && fabs(kick) > fabs(w->kick_v) / 2;
  w->alternations = back ? w->alternations + 1 : 0;
  w->since_anew++;
  w->anew =
      w->alternations >= ALTERNATES && w->since_anew >= PAUSE && off_wb > w->share * w->flux_wb;
  if (w->anew) w->since_anew = 0;
  w->rise_v = rise;
  w->kick_v = kick;
}

/* With i = lambda z/(2a) the current's relative error is lambda's. Where iron saturates, or where
 * the armature's motion makes most of lambda, it is larger: by lambda/i di/dlambda. What counts is
 * the error at the largest current, to which errors are relative; a current below LEAST of what the
 * mains could drive through the coil's resistance is not looked at. */
static void follow_current(vs_swing *w, const vs_knot *k) {
  const vs_coil *c = &w->model->coil;
  if (c->square) return;
  const double flux[3] = {k->flux_wb, 1, 0}, z[3] = {vs_mechanics_gap(w->model, k->x), 0, 0};
  double i[3], f[3];
  c->law->along(c, flux, z, i, f); /* the current's rate is then di/dlambda */
  if (!(fabs(i[0]) > w->peak_a)) return;
  w->peak_a = fabs(i[0]);
  w->current_wb = fabs(i[0] / i[1]);
  w->amplifies = fmax(1, fabs(k->flux_wb) / w->current_wb);
}

/* The slope that two steps have in common. A jump has none, nor has what alternates. */
static double common_slope(const vs_knot *from, const vs_knot *to) {
  double before = from->flux_rate2_v_s, now = to->flux_rate2_v_s;
  return before * now > 0 ? fmin(fabs(before), fabs(now)) : 0;
}

/* In a swing the errors of a rule's steps add up to one of its phase. A step is as long as keeps
 * that over LASTS radians of it. A fast swing may last longer, as where a coil is cut off and rings
 * with the contact. The trapezoidal rule is given back most of the error (truncation.h). Gear's
 * rule makes four times as much and is given nothing: over 1500 radians the current was 73
 * tolerances off. */
static void follow_strays(vs_swing *w, double h, double bend, bool driven) {
  w->strays_wb = driven ? 0 : w->strays_wb + h * h * h / 3 * bend;
  w->strayed_wb = fmax(w->strayed_wb, w->amplifies * w->strays_wb);
}

void vs_swing_take(vs_swing *w, const vs_knot *from, const vs_knot *to, double missed_v_s2,
                   bool driven) {
  double h = to->t_s - from->t_s;
  double bend = fabs(to->flux_rate2_v_s - from->flux_rate2_v_s) / ((h + w->before_s) / 2);
  w->before_s = h;
  w->slope_v_s = fmax(w->fades * w->slope_v_s, common_slope(from, to));
  bool resolved = bend * h <= RESOLVED * w->slope_v_s;
  w->bend_v_s2 = fmax(w->fades * w->bend_v_s2, resolved ? bend : 0);
  w->missed_v_s2 = fmax(w->fades * w->missed_v_s2, resolved ? missed_v_s2 : 0);
  w->flux_wb = fmax(w->flux_wb, fabs(to->flux_wb));
  w->seen_wb = fmax(w->seen_wb, fabs(to->flux_wb));
  follow_current(w, from);
  follow_alternation(w, from, to);
  if (w->gear) follow_strays(w, h, resolved ? bend : 0, driven);
}

double vs_swing_longest(const vs_swing *w) {
  if (!(w->missed_v_s2 > 0))
    return INFINITY; /* a NaN as well, of which the machine's motion will tell */
  double lasts_s = fmin(w->period_s, LASTS * w->slope_v_s / w->bend_v_s2);
  return sqrt(12 * w->share * w->flux_wb / (w->amplifies * w->missed_v_s2 * lasts_s));
}

double vs_swing_strays(const vs_swing *w) {
  return w->strayed_wb > 0 ? w->strayed_wb / (4 * w->tolerance * w->seen_wb) : 0;
}

double vs_swing_charge(const vs_swing *w, double t_s) {
  double flux_wb = fmax(w->seen_wb, w->peak_v * t_s);
  return w->tolerance * flux_wb * flux_wb / (w->model->coil.rest_h * w->peak_v);
}

/* As a thyristor lets go, the coil's current goes on through a snubber, whose resistance is below
 * SNUBBER_OHM, or stops within the same time. The voltage across the coil changes by no more than
 * that makes of the current, nor than the mains have; times an error of the instant it is one of
 * lambda. A shaker of 0.8 mH was off by 26 tolerances at 1e-4 for 2 us, and by 0.3 with this. With
 * twice OF_TOLERANCE it was off by 1, and the rate at which the voltage then came back, by 10 % at
 * 1e-3 and by 7 % at 1e-4, where this leaves 6 and 1 %. A coil of 1 H takes twenty-five steps more
 * in 0.1 s. Where the armature's motion makes most of lambda, OF_CURRENT of what the current stands
 * for counts: the current of a shaker was off by 4.8 tolerances, and is by 2.85. */
static const double SNUBBER_OHM = 1e3, OF_TOLERANCE = 0.5, OF_CURRENT = 0.5;

double vs_swing_instant(const vs_swing *w, double i_a, double t_s) {
  double most_v = fmin(fmin(w->peak_v, SNUBBER_OHM * i_a), w->model->coil.rest_h * i_a / t_s);
  double flux_wb = fmin(fmax(w->seen_wb, w->peak_v * t_s), OF_CURRENT * w->current_wb);
  return OF_TOLERANCE * w->tolerance * flux_wb / most_v;
}
