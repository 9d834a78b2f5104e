/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/truncation.h"

#include <math.h>

#include "plant/coil.h"

/* What a step counts in the line fades by this factor with each step behind it. */
static const double FADES = 0.8;
/* So many steps must be in the line. A step for which it is off by more than this share of v''
 * begins a new one. */
static const int LEAST_STEPS = 4;
static const double OTHER = 0.5;
/* The line is used once it has foretold so many steps in a row to this share of v''. */
static const int LEAST_GOOD = 4;
static const double OFF = 0.2;
/* v that hardly varies tells no slope: its variance is taken to be this share of v^2 more. */
static const double LEVEL = 1e-4;
/* The square of the longest step's angle on the swing, or of its share of a decay. */
static const double FARTHEST = 1;
/* The line's drift is followed over no more than this many steps. */
static const double FOLLOWS = 3;
/* The current outside the coil is looked at over so many radians of the swing. */
static const double OUTSIDE_RAD = 4;
/* The square of a swing's frequency may be so many times that of the coil with the capacitance that
 * it was seen with, or so many times that of the mains. */
static const double OWN = 1.5, SLOW = 4;
/* What was foretold amiss counts so many times: it comes and goes, and where it has gone the step
 * is longer. */
static const double CARE = 4;
/* At least this share of v'' counts as left out, so that steps are twice as long at most: another
 * inductance that rings with the coil, as that of a transformer, is given nothing back. */
static const double LEFT = 1.0 / 4;

vs_truncation vs_truncation_begin(const vs_setup *s, bool on) {
  double square = s->timeline.omega_rad_s * s->timeline.omega_rad_s;
  return (vs_truncation){.on = on && !s->run.gear, /* Gear's rule has another error */
                         .mains_1_s2 = SLOW * square};
}

void vs_truncation_restart(vs_truncation *a) {
  *a = (vs_truncation){.on = a->on, .mains_1_s2 = a->mains_1_s2, .outside = a->outside};
}

/* ---- the line ---- */

/* Returns false where too few steps are known. */
static bool fit_line(const vs_truncation_sums *s, vs_truncation_line *l) {
  if (s->count < LEAST_STEPS) return false;
  double v = s->v / s->weight, bend = s->bend / s->weight, square = s->v_v / s->weight;
  double variance = square - v * v + LEVEL * square;
  if (!(variance > 0)) return false;
  l->slope = (s->v_bend / s->weight - v * bend) / variance;
  l->rest = bend - l->slope * v;
  return true;
}

/* The weight is relative to the size of v'' of late: where a transient dies away, its beginning
 * would else outweigh all that comes behind it. */
static void add_to_line(vs_truncation *a, double v, double bend) {
  vs_truncation_sums *s = &a->sums;
  const vs_truncation_line *l = &a->line;
  if (a->fitted && !(fabs(bend - l->rest - l->slope * v) <= OTHER * a->size_v_s2))
    *s = (vs_truncation_sums){0};
  double weight = a->size_v_s2 > 0 ? 1 / (a->size_v_s2 * a->size_v_s2) : 0;
  s->count++;
  s->weight = FADES * s->weight + weight;
  s->v = FADES * s->v + weight * v;
  s->bend = FADES * s->bend + weight * bend;
  s->v_v = FADES * s->v_v + weight * v * v;
  s->v_bend = FADES * s->v_bend + weight * v * bend;
  a->fitted = fit_line(s, &a->line);
}

/* Takes in v and v'' at an instant that is at_s behind the last knot. */
static void see_curvature(vs_truncation *a, double v, double bend, double at_s) {
  add_to_line(a, v, bend);
  a->seen_v[1] = a->seen_v[0];
  a->seen_v_s2[1] = a->seen_v_s2[0];
  a->seen_v[0] = v;
  a->seen_v_s2[0] = bend;
  a->seen_s = at_s;
}

/* The size of v'' fades over a few times the step over which it showed. What was seen over steps of
 * a nanosecond is then forgotten once steps are longer. */
static void follow_size(vs_truncation *a, double bend, double h) {
  double steps = h / a->size_s; /* mostly 1 */
  double kept = a->size_s > 0 ? a->size_v_s2 * (steps == 1 ? FADES : pow(FADES, steps)) : 0;
  if (!(kept > fabs(bend))) a->size_s = h;
  a->size_v_s2 = fmax(fabs(bend), kept);
}

/* ---- what the coil rings with ---- */

/* Takes in a step in which no thyristor conducts, so that the coil is left to itself: over some
 * steps of its swing, y = rest + C s + G v, where a capacitance C and a conductance G draw the
 * current y from the coil at the voltage v with the slope s. */
static void look_outside(vs_truncation *a, const vs_truncation_step *step) {
  const vs_knot *from = step->from, *to = step->to;
  const vs_model *m = step->model;
  vs_truncation_outside *o = &a->outside;
  if (!a->fitted) return;
  double h = to->t_s - from->t_s, rad = sqrt(fabs(a->line.slope)) * h;
  double s = (to->v_eva_v - from->v_eva_v) / h, v = (to->v_eva_v + from->v_eva_v) / 2;
  double z = vs_mechanics_gap(m, from->x) + h / 2 * vs_mechanics_travel(m, from->x + m->dof);
  double y = -vs_coil_current(&m->coil, (from->flux_wb + to->flux_wb) / 2, z);
  double fade = exp(-rad / OUTSIDE_RAD);
  o->rad += rad;
  o->weight = fade * o->weight + h;
  o->s = fade * o->s + h * s;
  o->v = fade * o->v + h * v;
  o->y = fade * o->y + h * y;
  o->s_s = fade * o->s_s + h * s * s;
  o->s_v = fade * o->s_v + h * s * v;
  o->v_v = fade * o->v_v + h * v * v;
  o->s_y = fade * o->s_y + h * s * y;
  o->v_y = fade * o->v_y + h * v * y;
  o->y_y = fade * o->y_y + h * y * y;
}

/* Returns the share of the current that no capacitance explains, and sets *capacitance_f. What is
 * given at the terminals is right for a capacitance alone: in front of a resistance it would have
 * to be given behind that. 1 and NAN: not known yet. */
static double part_outside(const vs_truncation_outside *o, double *capacitance_f) {
  *capacitance_f = NAN;
  if (!(o->rad > 1)) return 1;
  double w = o->weight, s = o->s / w, v = o->v / w, y = o->y / w;
  double s_s = o->s_s / w - s * s, s_v = o->s_v / w - s * v, v_v = o->v_v / w - v * v;
  double s_y = o->s_y / w - s * y, v_y = o->v_y / w - v * y, y_y = o->y_y / w - y * y;
  double rest = v_v - s_v * s_v / s_s;
  *capacitance_f = s_y / s_s;
  double part = fabs(v_y - s_v * s_y / s_s) / sqrt(rest * y_y);
  return part < 1 ? part : 1;
}

/* True where the swing is the coil's own, or as slow as the mains. A faster one is that of some
 * other inductance with these capacitances: it goes on with the error that the rule makes there.
 * While a thyristor conducts, what the coil shows of the capacitances is little. */
static bool is_coils_own_swing(const vs_truncation *a, const vs_truncation_step *step,
                               double capacitance_f) {
  const vs_knot *k = step->from;
  const vs_model *m = step->model;
  if (step->driven || !a->fitted) return false;
  double per_wb = vs_coil_rates(&m->coil, k->flux_wb, 1, vs_mechanics_gap(m, k->x), 0).i_rate_a_s;
  double own = capacitance_f > 0 ? OWN * fabs(per_wb) / capacitance_f : 0;
  return fabs(a->line.slope) <= fmax(own, a->mains_1_s2);
}

/* By how much v'' was other than the rule was given, V/s^2. */
static double curvature_missed(vs_truncation *a, const vs_truncation_step *step, double bend) {
  double given = a->given_v_s2[1], capacitance_f, part = part_outside(&a->outside, &capacitance_f);
  bool own = given != 0 && is_coils_own_swing(a, step, capacitance_f);
  if (!own) return fmax(fabs(bend - given), fabs(bend));
  return fmax(CARE * fabs(bend - given) + part * fabs(given), LEFT * fabs(bend));
}

double vs_truncation_take_step(vs_truncation *a, const vs_truncation_step *step) {
  const vs_knot *from = step->from, *to = step->to;
  double h = to->t_s - from->t_s, rise = to->flux_rate2_v_s, off = 0;
  if (a->h_s > 0) {
    /* the second difference is v'' at the mean of the three instants */
    double both = h + a->h_s, bend = 2 * (rise - a->rise_v_s) / both;
    double behind = (h - a->h_s) / 3, slope = (a->h_s * rise + h * a->rise_v_s) / both;
    if (!step->driven) look_outside(a, step);
    off = curvature_missed(a, step, bend);
    follow_size(a, bend, fmin(h, a->h_s));
    a->good = fabs(bend - a->foretold_v_s2[1]) <= OFF * a->size_v_s2 ? a->good + 1 : 0;
    see_curvature(a, from->flux_rate_v + behind * (slope + behind * bend / 2), bend, behind - h);
  }
  a->driven = step->driven;
  a->foretold_v_s2[1] = a->foretold_v_s2[0];
  a->given_v_s2[1] = fabs(a->try_s - h) <= 1e-6 * h ? a->given_v_s2[0] : 0;
  a->v0_v = from->flux_rate_v;
  a->rise_v_s = rise;
  a->h_s = h;
  a->try_s = a->given_v_s2[0] = 0;
  return off;
}

/* ---- gone on ---- */

/* The solution of v'' = rest + slope v, h seconds behind its beginning, is v = v0 even + v0' odd +
 * rest whole, with even = cos sqrt x, odd = h sin(sqrt x)/sqrt x and x = -slope h^2 as series. */
typedef struct solution {
  double even, odd, whole;
} solution;

static solution solve_line(double slope, double h) {
  double x = -slope * h * h, part = 1 - x / 12 * (1 - x / 30 * (1 - x / 56));
  return (solution){1 - x / 2 * part, h * (1 - x / 6 * (1 - x / 20 * (1 - x / 42))),
                    h * h / 2 * part};
}

/* The line with which the next step is foretold: it goes on to be off as it was of late. */
static bool predict_line(const vs_truncation *a, double h, vs_truncation_line *l) {
  if (!a->fitted) return false;
  *l = a->line;
  double off = a->seen_v_s2[0] - l->rest - l->slope * a->seen_v[0];
  double before = a->seen_v_s2[1] - l->rest - l->slope * a->seen_v[1];
  l->rest += off + (off - before) * fmin((h - a->seen_s) / a->h_s, FOLLOWS);
  double most = fmax(h, a->h_s);
  return fabs(l->slope) * most * most <= FARTHEST;
}

/* lambda, v and v' after h seconds on the line. */
static void extrapolate_on_line(const vs_truncation *a, const vs_knot *k, double h,
                                const vs_truncation_line *l, double flux[3]) {
  solution back = solve_line(l->slope, a->h_s), on = solve_line(l->slope, h);
  double v = k->flux_rate_v, rate = (v * back.even + l->rest * back.whole - a->v0_v) / back.odd;
  flux[1] = v * on.even + rate * on.odd + l->rest * on.whole;
  flux[2] = rate * on.even + (l->rest + l->slope * v) * on.odd;
  flux[0] = k->flux_wb + h / 2 * (v + flux[1]);
}

/* On a swing of the angle y over half a step the rule's error is the factor tan(y)/y: that is
 * h^2/12 (1 + x/10) of the second derivative, with x = 4 y^2. */
static void correct_step(vs_truncation *a, const vs_truncation_try *at, double h,
                         const vs_truncation_line *l, const double flux[3]) {
  const vs_model *m = at->model;
  const vs_knot *k = at->last;
  const double z[3] = {at->z_m, vs_mechanics_travel(m, k->x + m->dof),
                       vs_mechanics_travel(m, k->a)};
  double i[3], f[3], part = h * h / 12 * (1 - l->slope * h * h / 10);
  m->coil.law->along(&m->coil, flux, z, i, f);
  if (!isfinite(i[2])) return;
  a->given_v_s2[0] = a->foretold_v_s2[0];
  a->flux_v = -part * a->given_v_s2[0];
  a->current_a = -part * i[2];
}

static void predict_correction(vs_truncation *a, const vs_truncation_try *at) {
  double h = at->t_s - at->last->t_s, flux[3];
  vs_truncation_line l;
  if (h == a->try_s) return;
  a->try_s = h;
  a->flux_v = a->current_a = a->given_v_s2[0] = a->foretold_v_s2[0] = 0;
  if (!a->on || !(h > 0) || !predict_line(a, h, &l)) return;
  extrapolate_on_line(a, at->last, h, &l, flux);
  a->foretold_v_s2[0] = l.rest + l.slope * flux[1];
  if (a->good >= LEAST_GOOD && !a->driven) correct_step(a, at, h, &l, flux);
}

double vs_truncation_flux_correction(vs_truncation *a, const vs_truncation_try *at) {
  predict_correction(a, at);
  return a->flux_v;
}

double vs_truncation_current_correction(vs_truncation *a, const vs_truncation_try *at) {
  predict_correction(a, at);
  return a->current_a;
}
