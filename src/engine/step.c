/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/step.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "plant/coil.h"

/* ---- knots ---- */

static inline void copy_coordinates(const vs_knot *from, int dof, vs_knot *to) {
  size_t one = (size_t)dof * sizeof *to->x;
  memcpy(to->x, from->x, 2 * one);
  memcpy(to->a, from->a, one);
  memcpy(to->j, from->j, one);
}

void vs_step_copy_knot(const vs_frame *frame, const vs_knot *from, vs_knot *to) {
  if (frame->model->dof == VS_ROWS)
    copy_coordinates(from, VS_ROWS, to);
  else
    copy_coordinates(from, frame->model->dof, to);
  to->t_s = from->t_s;
  memcpy(&to->flux_wb, &from->flux_wb, offsetof(vs_knot, terms) - offsetof(vs_knot, flux_wb));
  if (frame->deck) memcpy(to->terms, from->terms, frame->deck->n_terms * sizeof *from->terms);
}

void vs_step_complete_knot(const vs_frame *frame, vs_knot *k, unsigned touched) {
  const vs_model *m = frame->model;
  const double *q = k->x, *v = k->x + m->dof;
  double g = vs_mechanics_travel(m, q), g1 = vs_mechanics_travel(m, v);
  vs_law_rates law =
      vs_coil_rates(&m->coil, k->flux_wb, k->flux_rate_v, vs_coil_gap(&m->coil, g), g1);
  double stop = touched ? vs_stops_force(&m->stops, touched, g, g1) : 0;
  vs_mechanics_accelerations(m, q, v, law.force_n + stop, k->a);
  if (touched) stop = vs_stops_force_rate(&m->stops, touched, g, g1, vs_mechanics_travel(m, k->a));
  vs_mechanics_jerks(m, v, k->a, law.force_rate_n_s + stop, k->j);
}

void vs_step_hold_knot(const vs_frame *frame, vs_knot *k) {
  const vs_model *m = frame->model;
  const double *q = k->x, *v = k->x + m->dof;
  double force = vs_coil_force(&m->coil, k->flux_wb, vs_mechanics_gap(m, q));
  vs_mechanics_accelerations(m, q, v, force, k->a);
  vs_mechanics_hold(m, k->a);
  vs_mechanics_jerks(m, v, k->a, 0, k->j); /* what acts along the gap is held */
  vs_mechanics_hold(m, k->j);
}

/* ---- channels between two knots ---- */

/* Weights of value, slope, curvature and third derivative at the two ends of a step, by which a
 * Hermite polynomial is their sum. */
typedef struct weights {
  double y[2], d[2], e[2], f[2];
} weights;

/* An instant as each end of the step sees it: its distance s from that end and r to the other one,
 * both relative to the step's length, and the length h, which is negative at the far end, as time
 * runs backwards from there. */
typedef struct views {
  double s[2], r[2], h[2];
} views;
static inline views views_of(double s, double h) {
  return (views){{s, 1 - s}, {1 - s, s}, {h, -h}};
}

/* The polynomial of degree seven through value and three derivatives at either end. */
static inline weights septic(views v) {
  weights w;
  for (int k = 0; k < 2; k++) {
    double s = v.s[k], r2 = v.r[k] * v.r[k], c = 1 + s * (4 + 10 * s), d = v.h[k] * r2 * r2 * s;
    w.y[k] = r2 * r2 * (c + 20 * s * s * s);
    w.d[k] = d * c;
    w.e[k] = d * v.h[k] * s * (0.5 + 2 * s);
    w.f[k] = d * v.h[k] * v.h[k] * (s * s * (1.0 / 6));
  }
  return w;
}

/* Its slope; h must not be 0. */
static inline weights septic_rate(views v) {
  weights w;
  for (int k = 0; k < 2; k++) {
    double s = v.s[k], r3 = v.r[k] * v.r[k] * v.r[k], hrs = v.h[k] * r3 * s;
    w.y[k] = -140 * r3 * s * s * s / v.h[k];
    w.d[k] = r3 * (1 + s * (3 + s * (6 - 70 * s)));
    w.e[k] = hrs * (1 + s * (3 - 14 * s));
    w.f[k] = hrs * v.h[k] * s * (0.5 - (7.0 / 6) * s);
  }
  return w;
}

/* The cubic through value and slope at either end, which is as much as a solver of second order
 * knows. */
static inline weights cubic(views v) {
  weights w = {.e = {0}};
  for (int k = 0; k < 2; k++) {
    w.y[k] = v.r[k] * v.r[k] * (1 + 2 * v.s[k]);
    w.d[k] = v.h[k] * v.r[k] * v.r[k] * v.s[k];
  }
  return w;
}
static inline weights cubic_rate(views v) {
  weights w = {.e = {0}};
  for (int k = 0; k < 2; k++) {
    w.y[k] = -6 * v.r[k] * v.s[k] / v.h[k];
    w.d[k] = v.r[k] * (1 - 3 * v.s[k]);
  }
  return w;
}

/* Some quantities at one end of the step, side by side, and their first three derivatives. */
typedef struct ends {
  const double *y, *d, *e, *f;
} ends;

static inline __attribute__((always_inline)) void apply_weights(const weights *w, ends a, ends b,
                                                                int n, double *restrict y) {
  for (int i = 0; i < n; i++)
    y[i] = (w->y[0] * a.y[i] + w->y[1] * b.y[i]) + (w->d[0] * a.d[i] + w->d[1] * b.d[i]) +
           ((w->e[0] * a.e[i] + w->e[1] * b.e[i]) + (w->f[0] * a.f[i] + w->f[1] * b.f[i]));
}

static inline ends coordinates_of(const vs_knot *k, int dof) {
  return (ends){k->x, k->x + dof, k->a, k->j};
}

static inline ends flux_of(const vs_knot *k) {
  return (ends){&k->flux_wb, &k->flux_rate_v, &k->flux_rate2_v_s, &k->flux_rate3_v_s2};
}

bool vs_step_is_quiet(const vs_step *step) {
  const vs_knot *a = step->from, *b = step->to;
  return a->flux_wb == 0 && b->flux_wb == 0 && a->flux_rate_v == 0 && b->flux_rate_v == 0;
}

int vs_step_parts(const vs_step *step, int least, int most) {
  const double radians = step->frame->model->contact_rad_s * (step->to->t_s - step->from->t_s);
  return (int)fmax(fmin(ceil(2 * radians * most), most), least);
}

/* q, and q' where `rate` is there; a step of no length has the velocities of its end. */
static inline __attribute__((always_inline)) void put_coordinates(const vs_step *step,
                                                                  const weights *w,
                                                                  const weights *rate, int dof,
                                                                  double *restrict q) {
  const ends from = coordinates_of(step->from, dof), to = coordinates_of(step->to, dof);
  apply_weights(w, from, to, dof, q);
  if (rate && step->to->t_s > step->from->t_s)
    apply_weights(rate, from, to, dof, q + dof);
  else
    for (int i = 0; rate && i < dof; i++) q[dof + i] = step->to->x[dof + i];
}

/* `septic` are the weights of the step's slopes. */
static inline __attribute__((always_inline)) double flux_rate(const vs_step *step, views at,
                                                              const weights *septic) {
  if (at.h[0] <= 0) return step->to->flux_rate_v;
  double rate;
  if (step->cubic_flux) {
    const weights own = cubic_rate(at);
    apply_weights(&own, flux_of(step->from), flux_of(step->to), 1, &rate);
  } else {
    apply_weights(septic, flux_of(step->from), flux_of(step->to), 1, &rate);
  }
  return rate;
}

/* The flux linkages of the secondaries and their derivatives, which follow from lambda's, at both
 * ends; rungs side by side. */
typedef struct psi_ends {
  double d[2][4][VS_MOST_RUNGS];
} psi_ends;
static psi_ends psi_of(const vs_step *step) {
  const vs_coil *c = &step->frame->model->coil;
  const vs_knot *knot[2] = {step->from, step->to};
  psi_ends e;
  for (int end = 0; end < 2; end++) {
    const vs_knot *k = knot[end];
    const double flux[3] = {k->flux_wb, k->flux_rate_v, step->cubic_flux ? 0 : k->flux_rate2_v_s};
    memcpy(e.d[end][0], k->psi_wb, sizeof e.d[end][0]);
    for (int order = 0; order < 3; order++)
      for (int n = 0; n < c->rungs; n++)
        e.d[end][order + 1][n] = vs_coil_rung_rate(c, n, flux[order], e.d[end][order]);
  }
  return e;
}

static void put_psi(const vs_step *step, views at, const weights *septic, double *psi) {
  const weights w = step->cubic_flux ? cubic(at) : *septic;
  const psi_ends e = psi_of(step);
  apply_weights(&w, (ends){e.d[0][0], e.d[0][1], e.d[0][2], e.d[0][3]},
                (ends){e.d[1][0], e.d[1][1], e.d[1][2], e.d[1][3]}, step->frame->model->coil.rungs,
                psi);
}

void vs_step_psi_at(const vs_step *step, double t_s, double psi[VS_MOST_RUNGS]) {
  double h = step->to->t_s - step->from->t_s;
  const views at = views_of(h > 0 ? (t_s - step->from->t_s) / h : 1, h);
  const weights w = septic(at);
  memset(psi, 0, VS_MOST_RUNGS * sizeof *psi);
  if (step->frame->model->coil.rungs) put_psi(step, at, &w, psi);
}

vs_law_rates vs_step_coil_rates(const vs_frame *frame, const vs_knot *k) {
  const vs_model *m = frame->model;
  const vs_coil *c = &m->coil;
  double z = frame->gap_at_rest ? c->gap_rest_m : vs_mechanics_gap(m, k->x), rate[VS_MOST_RUNGS];
  double z_rate = frame->gap_at_rest ? 0 : vs_mechanics_travel(m, k->x + m->dof);
  vs_law_rates r = vs_coil_rates(c, k->flux_wb, k->flux_rate_v, z, z_rate);
  if (!c->eddies) return r;
  for (int n = 0; n < c->rungs; n++) rate[n] = vs_coil_rung_rate(c, n, k->flux_wb, k->psi_wb);
  r.i_a += vs_coil_rungs_current(c, k->flux_wb, k->psi_wb) + c->core_s * k->flux_rate_v;
  r.i_rate_a_s += vs_coil_rungs_current(c, k->flux_rate_v, rate) + c->core_s * k->flux_rate2_v_s;
  return r;
}

/* What eddy currents add to the coil's current, and what they lose; lambda is there already. Of the
 * weights it makes its own, so that those of a step without eddy currents stay in registers. */
static __attribute__((noinline)) void put_eddies(const vs_step *step, double s, double h,
                                                 double *y) {
  const vs_coil *c = &step->frame->model->coil;
  const views at = views_of(s, h);
  const weights w = septic(at);
  double psi[VS_MOST_RUNGS];
  if (c->rungs) put_psi(step, at, &w, psi);
  for (int n = 0; n < c->rungs; n++) {
    const double v = vs_coil_rung_rate(c, n, y[VS_CH_LAMBDA], psi);
    y[VS_CH_EDDY] += v * v / c->rung[n].resistance_ohm;
  }
  y[VS_CH_I] += vs_coil_rungs_current(c, y[VS_CH_LAMBDA], psi);
  if (c->core_s > 0) {
    const weights slope = at.h[0] > 0 ? septic_rate(at) : (weights){.e = {0}};
    const double rate = flux_rate(step, at, &slope);
    y[VS_CH_I] += c->core_s * rate;
    y[VS_CH_EDDY] += c->core_s * rate * rate;
  }
  if (step->open) y[VS_CH_I] = 0;
}

static double line(double from, double to, double s) {
  return from + s * (to - from);
}

/* lambda, i and the force; z is there already. `septic` are the weights of the step's values. */
static inline __attribute__((always_inline)) void put_flux(const vs_step *step, views at,
                                                           const weights *septic, double *y) {
  const vs_frame *frame = step->frame;
  const vs_model *m = frame->model;
  y[VS_CH_EDDY] = 0;
  if (vs_step_is_quiet(step)) {
    y[VS_CH_LAMBDA] = y[VS_CH_I] = y[VS_CH_FORCE] = 0;
    return;
  }
  if (step->cubic_flux) {
    const weights own = cubic(at);
    apply_weights(&own, flux_of(step->from), flux_of(step->to), 1, y + VS_CH_LAMBDA);
  } else {
    apply_weights(septic, flux_of(step->from), flux_of(step->to), 1, y + VS_CH_LAMBDA);
  }
  double z = frame->gap_at_rest ? m->coil.gap_rest_m : y[VS_CH_Z];
  y[VS_CH_I] = vs_coil_current(&m->coil, y[VS_CH_LAMBDA], z);
  if (m->coil.eddies) put_eddies(step, at.s[0], at.h[0], y);
  y[VS_CH_FORCE] = vs_coil_force(&m->coil, y[VS_CH_LAMBDA], z);
}

/* q, q' and the force are there already. */
static void put_accelerations(const vs_step *step, double *y) {
  const vs_model *m = step->frame->model;
  const double *q = y + VS_CH_Q, *v = y + vs_channel_rates(m);
  double a[VS_MOST_DOF], g = vs_mechanics_travel(m, q);
  unsigned touched = vs_stops_touched(&m->stops, g);
  double stop = touched ? vs_stops_force(&m->stops, touched, g, vs_mechanics_travel(m, v)) : 0;
  vs_mechanics_accelerations(m, q, v, y[VS_CH_FORCE] + stop, a);
  if (step->held) vs_mechanics_hold(m, a);
  for (int i = 0; i < m->dof; i++) y[vs_channel_rates2(m) + i] = a[i];
}

/* The machine's own probes. */
static void put_outputs(const vs_model *m, double *y) {
  _Static_assert((int)VS_MACHINE_TERM_Z == VS_CH_Z && (int)VS_MACHINE_TERM_LAMBDA == VS_CH_LAMBDA &&
                     (int)VS_MACHINE_TERM_I == VS_CH_I &&
                     (int)VS_MACHINE_TERM_FORCE == VS_CH_FORCE && (int)VS_MACHINE_TERM_Q == VS_CH_Q,
                 "terms of a machine's formulas are numbers of channels");
  for (int n = 0; n < m->machine->n_probes; n++)
    y[vs_channel_probes(m) + n] = vs_formula_value(&m->machine->probes[n].of, y);
}

/* The piece in which an instant is; *s: how far into it, 0..1. */
static inline vs_piece piece_at(const vs_step *step, double t_s, double *s) {
  int k = 0;
  while (k < step->parts && step->part[k].t_s < t_s) k++;
  const vs_piece p = vs_step_piece(step, k);
  const double h = p.to->t_s - p.from->t_s;
  *s = h > 0 ? (t_s - p.from->t_s) / h : 1;
  return p;
}

static void put_probes(const vs_step *step, const vs_piece *p, double s, double *y) {
  const vs_deck *deck = step->frame->deck;
  size_t first = (size_t)vs_channel_deck(step->frame->model);
  for (size_t n = 0; deck && n < deck->n_probes; n++) {
    const vs_probe *probe = &deck->probes[n];
    double from = p->from->terms[probe->term], to = p->to->terms[probe->term];
    y[first + n] = probe->sign * line(from, to, s);
  }
}

/* vs_step_groups_at for a machine of so many coordinates. */
static inline __attribute__((always_inline)) void groups_at(const vs_step *step, double t_s,
                                                            unsigned groups, int dof, double *y) {
  const vs_knot *a = step->from, *b = step->to;
  const vs_model *m = step->frame->model;
  bool coil = step->frame->source_is_coil;
  double h = b->t_s - a->t_s, s = h > 0 ? (t_s - a->t_s) / h : 1, *q = y + VS_CH_Q;
  const views at = views_of(s, h);
  const weights w = septic(at);
  weights slope;
  if (h > 0 && groups & (VS_GROUP_VELOCITIES | VS_GROUP_V_EVA)) slope = septic_rate(at);
  const weights *rate = groups & VS_GROUP_VELOCITIES ? &slope : NULL;
  put_coordinates(step, &w, rate, dof, q);
  y[VS_CH_TRAVEL] = vs_mechanics_travel(m, q);
  y[VS_CH_Z] = vs_coil_gap(&m->coil, y[VS_CH_TRAVEL]);
  put_flux(step, at, &w, y);
  double of_piece;
  const vs_piece p = piece_at(step, t_s, &of_piece);
  y[VS_CH_I_MAINS] = coil ? y[VS_CH_I] : line(p.from->i_mains_a, p.to->i_mains_a, of_piece);
  if (groups & VS_GROUP_V_EVA)
    y[VS_CH_V_EVA] = coil ? m->coil.resistance_ohm * y[VS_CH_I] + flux_rate(step, at, &slope)
                          : line(p.from->v_eva_v, p.to->v_eva_v, of_piece);
  if (groups & VS_GROUP_V_MAINS) y[VS_CH_V_MAINS] = vs_timeline_voltage(step->frame->timeline, t_s);
  if (groups & VS_GROUP_ACCELERATIONS) put_accelerations(step, y);
  if (groups & VS_GROUP_MACHINE) put_outputs(m, y);
  if (groups & VS_GROUP_DECK) put_probes(step, &p, of_piece, y);
}

void vs_step_groups_at(const vs_step *step, double t_s, unsigned groups, double *y) {
  int dof = step->frame->model->dof;
  if (dof == VS_ROWS)
    groups_at(step, t_s, groups, VS_ROWS, y);
  else
    groups_at(step, t_s, groups, dof, y);
}

static inline __attribute__((always_inline)) void velocities_at(const vs_step *step, double t_s,
                                                                int dof, double *restrict v) {
  const vs_knot *a = step->from, *b = step->to;
  double h = b->t_s - a->t_s;
  if (h > 0) {
    const weights rate = septic_rate(views_of((t_s - a->t_s) / h, h));
    apply_weights(&rate, coordinates_of(a, dof), coordinates_of(b, dof), dof, v);
  } else {
    for (int i = 0; i < dof; i++) v[i] = b->x[dof + i];
  }
}

void vs_step_velocities_at(const vs_step *step, double t_s, double *v) {
  int dof = step->frame->model->dof;
  if (dof == VS_ROWS)
    velocities_at(step, t_s, VS_ROWS, v);
  else
    velocities_at(step, t_s, dof, v);
}

void vs_step_at(const vs_step *step, double t_s, double *y) {
  vs_step_groups_at(step, t_s, VS_GROUP_ALL, y);
}

double vs_step_channel(const vs_step *step, double t_s, int channel) {
  double y[VS_CH_MOST];
  vs_step_groups_at(step, t_s, vs_channel_groups(step->frame->model, &channel, 1), y);
  return y[channel];
}

/* ---- polynomials over a step, by their Bernstein coefficients ---- */

enum { SEPTIC = 7 };
_Static_assert(2 * SEPTIC <= VS_CURVE_MOST, "a product of two of degree seven");

/* Of degree seven, by value and three derivatives at both ends; or of degree three, by one. */
static vs_curve curve_between(const double from[4], const double to[4], double h, bool cubic) {
  vs_curve c = {.degree = cubic ? 3 : SEPTIC};
  for (int end = 0; end < 2; end++) {
    const double *y = end ? to : from, s = end ? -h : h;
    double d = s * y[1] / c.degree, e = s * s * y[2] / 42, f = s * s * s * y[3] / 210;
    double *b = end ? c.b + c.degree : c.b;
    int on = end ? -1 : 1;
    b[0] = y[0];
    b[on] = y[0] + d;
    if (cubic) continue;
    b[2 * on] = y[0] + 2 * d + e;
    b[3 * on] = y[0] + 3 * d + 3 * e + f;
  }
  return c;
}

static vs_curve curve_of_coordinate(const vs_step *step, int i) {
  const vs_knot *a = step->from, *b = step->to;
  int dof = step->frame->model->dof;
  const double from[] = {a->x[i], a->x[dof + i], a->a[i], a->j[i]};
  const double to[] = {b->x[i], b->x[dof + i], b->a[i], b->j[i]};
  return curve_between(from, to, b->t_s - a->t_s, false);
}

static vs_curve curve_of_flux(const vs_step *step) {
  const vs_knot *a = step->from, *b = step->to;
  const double from[] = {a->flux_wb, a->flux_rate_v, a->flux_rate2_v_s, a->flux_rate3_v_s2};
  const double to[] = {b->flux_wb, b->flux_rate_v, b->flux_rate2_v_s, b->flux_rate3_v_s2};
  return curve_between(from, to, b->t_s - a->t_s, step->cubic_flux);
}

/* The same polynomial, said to be of one degree more. */
static void elevate_curve(vs_curve *c) {
  int n = ++c->degree;
  c->b[n] = c->b[n - 1];
  for (int k = n - 1; k > 0; k--) c->b[k] = (k * c->b[k - 1] + (n - k) * c->b[k]) / n;
}

vs_curve vs_step_curve_slope(const vs_curve *c, double h) {
  vs_curve s = {.degree = c->degree - 1};
  for (int k = 0; k < c->degree; k++) s.b[k] = c->degree * (c->b[k + 1] - c->b[k]) / h;
  return s;
}

static vs_curve curve_product(const vs_curve *x, const vs_curve *y) {
  static const double CHOOSE[SEPTIC + 1][SEPTIC + 1] = {{1},
                                                        {1, 1},
                                                        {1, 2, 1},
                                                        {1, 3, 3, 1},
                                                        {1, 4, 6, 4, 1},
                                                        {1, 5, 10, 10, 5, 1},
                                                        {1, 6, 15, 20, 15, 6, 1},
                                                        {1, 7, 21, 35, 35, 21, 7, 1}};
  int m = x->degree, n = y->degree;
  vs_curve c = {.degree = m + n};
  for (int k = 0; k <= m + n; k++) {
    double sum = 0, all = 0;
    for (int i = k > n ? k - n : 0; i <= k && i <= m; i++) {
      double weight = CHOOSE[m][i] * CHOOSE[n][k - i];
      sum += weight * x->b[i] * y->b[k - i];
      all += weight;
    }
    c.b[k] = sum / all;
  }
  return c;
}

/* Its two halves; the first is returned. */
vs_curve vs_step_curve_halve(vs_curve *c) {
  vs_curve first = {.degree = c->degree};
  for (int k = 0; k <= c->degree; k++) {
    first.b[k] = c->b[0];
    for (int i = 0; i < c->degree - k; i++) c->b[i] = (c->b[i] + c->b[i + 1]) / 2;
  }
  return first;
}

double vs_step_curve_value(const vs_curve *c, double s) {
  vs_curve at = *c;
  for (int n = c->degree; n > 0; n--)
    for (int i = 0; i < n; i++) at.b[i] += s * (at.b[i + 1] - at.b[i]);
  return at.b[0];
}

/* ---- channels as such polynomials ---- */

/* The travel g = c.q. */
static vs_curve curve_of_travel(const vs_step *step) {
  const vs_model *m = step->frame->model;
  const vs_knot *a = step->from, *b = step->to;
  const double from[] = {vs_mechanics_travel(m, a->x), vs_mechanics_travel(m, a->x + m->dof),
                         vs_mechanics_travel(m, a->a), vs_mechanics_travel(m, a->j)};
  const double to[] = {vs_mechanics_travel(m, b->x), vs_mechanics_travel(m, b->x + m->dof),
                       vs_mechanics_travel(m, b->a), vs_mechanics_travel(m, b->j)};
  return curve_between(from, to, b->t_s - a->t_s, false);
}

/* Adds x times a polynomial of no higher degree. */
static void add_curve(vs_curve *sum, double x, const vs_curve *more) {
  vs_curve c = *more;
  while (c.degree < sum->degree) elevate_curve(&c);
  for (int k = 0; k <= c.degree; k++) sum->b[k] += x * c.b[k];
}

/* Adds what eddy currents draw. */
static __attribute__((noinline)) void add_eddy_curves(const vs_step *step, const vs_curve *flux,
                                                      vs_curve *sum) {
  const vs_coil *c = &step->frame->model->coil;
  const psi_ends e = psi_of(step);
  const double h = step->to->t_s - step->from->t_s;
  add_curve(sum, c->leak_1_h, flux);
  for (int n = 0; n < c->rungs; n++) {
    double d[2][4];
    for (int k = 0; k < 8; k++) d[k / 4][k % 4] = e.d[k / 4][k % 4][n];
    const vs_curve psi = curve_between(d[0], d[1], h, step->cubic_flux);
    add_curve(sum, -c->rung[n].per_h, &psi);
  }
  if (c->core_s == 0 || !(h > 0)) return;
  const vs_curve rate = vs_step_curve_slope(flux, h);
  add_curve(sum, c->core_s, &rate);
}

static vs_curve curve_of_current(const vs_step *step) {
  const vs_model *m = step->frame->model;
  if (step->open) return (vs_curve){0};
  const vs_curve flux = curve_of_flux(step);
  vs_curve z = step->frame->gap_at_rest ? (vs_curve){0} : curve_of_travel(step);
  for (int k = 0; k <= z.degree; k++) z.b[k] = (z.b[k] + m->coil.gap_rest_m) / (2 * m->coil.a_hm);
  if (!m->coil.eddies) return curve_product(&flux, &z);
  z = curve_product(&flux, &z);
  add_eddy_curves(step, &flux, &z);
  return z;
}

static vs_curve curve_of_force(const vs_step *step) {
  vs_curve c = curve_of_flux(step);
  c = curve_product(&c, &c);
  for (int k = 0; k <= c.degree; k++) c.b[k] /= 4 * step->frame->model->coil.a_hm;
  return c;
}

/* Eq. 54. Where the armature touches its stop it does so all over a step, as steps end there. */
static vs_curve curve_of_acceleration(const vs_step *step, int i) {
  const vs_model *m = step->frame->model;
  const vs_stop *stop = &m->stops.item[0];
  vs_curve sum = {.degree = SEPTIC}, g = curve_of_travel(step);
  double share = vs_stops_touched(&m->stops, vs_step_curve_value(&g, 0.5)) ? m->mf[i] : 0;
  for (int n = 0; n < m->dof; n++) {
    vs_curve q = curve_of_coordinate(step, n),
             v = vs_step_curve_slope(&q, step->to->t_s - step->from->t_s);
    double pull = share * m->along[n];
    add_curve(&sum, pull * stop->stiffness - m->mk_column[n][i], &q);
    add_curve(&sum, pull * stop->damping_ns_m - m->mb_column[n][i], &v);
  }
  for (int k = 0; k <= SEPTIC; k++) {
    if (share != 0) sum.b[k] -= share * stop->stiffness * stop->at_m;
    if (m->loaded) sum.b[k] += m->m0[i];
  }
  if (vs_step_is_quiet(step)) return sum;
  vs_curve f = curve_of_force(step);
  while (sum.degree < f.degree) elevate_curve(&sum);
  add_curve(&sum, m->mf[i], &f);
  return sum;
}

vs_curve vs_step_curve_of(const vs_step *step, int channel) {
  if (channel == VS_CH_I) return curve_of_current(step);
  if (channel == VS_CH_FORCE) return curve_of_force(step);
  const vs_model *m = step->frame->model;
  int rate2 = channel - vs_channel_rates2(m);
  if (channel == VS_CH_TRAVEL) return curve_of_travel(step);
  return rate2 >= 0 ? curve_of_acceleration(step, rate2)
                    : curve_of_coordinate(step, channel - VS_CH_Q);
}

bool vs_step_curve_is_exact(const vs_model *m, int channel) {
  bool of_motion = channel == VS_CH_TRAVEL || (channel >= VS_CH_Q && channel < vs_channel_rates(m));
  return m->plain || of_motion;
}

/* ---- polynomials through values ---- */

double vs_step_curve_point(int k) {
  return (1 - cos(M_PI * k / VS_CURVE_MOST)) / 2;
}

/* Newton's form, turned into Bernstein's point by point (Ainsworth and Sanchez, 2016): what goes
 * through the first k + 1 points is what goes through k, said to be of one degree more, and the
 * divided difference times (s - s_0) ... (s - s_(k-1)). The product's coefficients follow as
 *   w_j <- (j (1 - s_(k-1)) w_(j-1) - (k - j) s_(k-1) w_j)/k */
vs_curve vs_step_curve_through(const double y[VS_CURVE_POINTS]) {
  vs_curve c = {.b = {y[0]}}, w = {.b = {1}};
  double s[VS_CURVE_POINTS], divided[VS_CURVE_POINTS];
  for (int k = 0; k < VS_CURVE_POINTS; k++) {
    s[k] = vs_step_curve_point(k);
    divided[k] = y[k];
  }
  for (int k = 1; k < VS_CURVE_POINTS; k++)
    for (int i = VS_CURVE_MOST; i >= k; i--)
      divided[i] = (divided[i] - divided[i - 1]) / (s[i] - s[i - k]);
  for (int k = 1; k < VS_CURVE_POINTS; k++) {
    double at = s[k - 1];
    for (int j = k; j >= 0; j--)
      w.b[j] = ((j ? j * (1 - at) * w.b[j - 1] : 0) - (j < k ? (k - j) * at * w.b[j] : 0)) / k;
    elevate_curve(&c);
    for (int j = 0; j <= k; j++) c.b[j] += divided[k] * w.b[j];
  }
  c.b[VS_CURVE_MOST] = y[VS_CURVE_MOST];
  return c;
}

/* ---- roots ---- */

/* Root of a curve that changes its sign once, from > 0 to < 0: Newton's, kept between bounds, on
 * its powers. What rounding makes of those of degree 13 moves the root by 1e-11 of the step. */
double vs_step_curve_root(vs_curve slope) {
  int n = slope.degree;
  double *a = slope.b, lo = 0, hi = 1, at = 0.5;
  for (int k = 1; k <= n; k++)
    for (int i = n; i >= k; i--) a[i] -= a[i - 1];
  double choose = 1;
  for (int k = 0; k <= n; k++) {
    a[k] *= choose;
    choose *= (double)(n - k) / (k + 1);
  }
  for (int turn = 0; turn < 60; turn++) {
    double y = a[n], rate = 0;
    for (int k = n - 1; k >= 0; k--) {
      rate = rate * at + y;
      y = y * at + a[k];
    }
    if (y > 0)
      lo = at;
    else
      hi = at;
    double next = at - y / rate;
    if (!(next > lo && next < hi)) next = (lo + hi) / 2;
    if (fabs(next - at) <= DBL_EPSILON) break;
    at = next;
  }
  return at;
}
