/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/curve.h"

#include <float.h>
#include <math.h>

#include "plant/coil.h"

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

static vs_curve coordinate(const vs_step *step, int i) {
  const vs_knot *a = step->from, *b = step->to;
  int dof = step->frame->model->dof;
  const double from[] = {a->x[i], a->x[dof + i], a->a[i], a->j[i]};
  const double to[] = {b->x[i], b->x[dof + i], b->a[i], b->j[i]};
  return curve_between(from, to, b->t_s - a->t_s, false);
}

static vs_curve flux(const vs_step *step) {
  const vs_knot *a = step->from, *b = step->to;
  const double from[] = {a->flux_wb, a->flux_rate_v, a->flux_rate2_v_s, a->flux_rate3_v_s2};
  const double to[] = {b->flux_wb, b->flux_rate_v, b->flux_rate2_v_s, b->flux_rate3_v_s2};
  return curve_between(from, to, b->t_s - a->t_s, step->cubic_flux);
}

/* The same polynomial, said to be of one degree more. */
static void elevate(vs_curve *c) {
  int n = ++c->degree;
  c->b[n] = c->b[n - 1];
  for (int k = n - 1; k > 0; k--) c->b[k] = (k * c->b[k - 1] + (n - k) * c->b[k]) / n;
}

vs_curve vs_curve_slope(const vs_curve *c, double h) {
  vs_curve s = {.degree = c->degree - 1};
  for (int k = 0; k < c->degree; k++) s.b[k] = c->degree * (c->b[k + 1] - c->b[k]) / h;
  return s;
}

static vs_curve product(const vs_curve *x, const vs_curve *y) {
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
vs_curve vs_curve_halve(vs_curve *c) {
  vs_curve first = {.degree = c->degree};
  for (int k = 0; k <= c->degree; k++) {
    first.b[k] = c->b[0];
    for (int i = 0; i < c->degree - k; i++) c->b[i] = (c->b[i] + c->b[i + 1]) / 2;
  }
  return first;
}

double vs_curve_value(const vs_curve *c, double s) {
  vs_curve at = *c;
  for (int n = c->degree; n > 0; n--)
    for (int i = 0; i < n; i++) at.b[i] += s * (at.b[i + 1] - at.b[i]);
  return at.b[0];
}

/* ---- channels as such polynomials ---- */

/* The travel g = c.q. */
static vs_curve travel(const vs_step *step) {
  const vs_model *m = step->frame->model;
  const vs_knot *a = step->from, *b = step->to;
  const double from[] = {vs_mechanics_travel(m, a->x), vs_mechanics_travel(m, a->x + m->dof),
                         vs_mechanics_travel(m, a->a), vs_mechanics_travel(m, a->j)};
  const double to[] = {vs_mechanics_travel(m, b->x), vs_mechanics_travel(m, b->x + m->dof),
                       vs_mechanics_travel(m, b->a), vs_mechanics_travel(m, b->j)};
  return curve_between(from, to, b->t_s - a->t_s, false);
}

static vs_curve current(const vs_step *step) {
  const vs_model *m = step->frame->model;
  vs_curve c = flux(step), z = step->frame->gap_at_rest ? (vs_curve){0} : travel(step);
  for (int k = 0; k <= z.degree; k++) z.b[k] = (z.b[k] + m->coil.gap_rest_m) / (2 * m->coil.a_hm);
  return product(&c, &z);
}

static vs_curve force(const vs_step *step) {
  vs_curve c = flux(step);
  c = product(&c, &c);
  for (int k = 0; k <= c.degree; k++) c.b[k] /= 4 * step->frame->model->coil.a_hm;
  return c;
}

/* Adds x times a polynomial of no higher degree. */
static void add(vs_curve *sum, double x, const vs_curve *more) {
  vs_curve c = *more;
  while (c.degree < sum->degree) elevate(&c);
  for (int k = 0; k <= c.degree; k++) sum->b[k] += x * c.b[k];
}

/* Eq. 54. Where the armature touches its stop it does so all over a step, as steps end there. */
static vs_curve acceleration(const vs_step *step, int i) {
  const vs_model *m = step->frame->model;
  const vs_stop *stop = &m->stops.item[0];
  vs_curve sum = {.degree = SEPTIC}, g = travel(step);
  double share = vs_stops_touched(&m->stops, vs_curve_value(&g, 0.5)) ? m->mf[i] : 0;
  for (int n = 0; n < m->dof; n++) {
    vs_curve q = coordinate(step, n), v = vs_curve_slope(&q, step->to->t_s - step->from->t_s);
    double pull = share * m->along[n];
    add(&sum, pull * stop->stiffness - m->mk_column[n][i], &q);
    add(&sum, pull * stop->damping_ns_m - m->mb_column[n][i], &v);
  }
  for (int k = 0; k <= SEPTIC; k++) {
    if (share != 0) sum.b[k] -= share * stop->stiffness * stop->at_m;
    if (m->loaded) sum.b[k] += m->m0[i];
  }
  if (vs_step_is_quiet(step)) return sum;
  vs_curve f = force(step);
  while (sum.degree < f.degree) elevate(&sum);
  add(&sum, m->mf[i], &f);
  return sum;
}

vs_curve vs_curve_of(const vs_step *step, int channel) {
  if (channel == VS_CH_I) return current(step);
  if (channel == VS_CH_FORCE) return force(step);
  const vs_model *m = step->frame->model;
  int rate2 = channel - vs_channel_rates2(m);
  if (channel == VS_CH_TRAVEL) return travel(step);
  return rate2 >= 0 ? acceleration(step, rate2) : coordinate(step, channel - VS_CH_Q);
}

bool vs_curve_is_exact(const vs_model *m, int channel) {
  bool of_motion = channel == VS_CH_TRAVEL || (channel >= VS_CH_Q && channel < vs_channel_rates(m));
  return m->plain || of_motion;
}

/* ---- polynomials through values ---- */

double vs_curve_point(int k) {
  return (1 - cos(M_PI * k / VS_CURVE_MOST)) / 2;
}

/* Newton's form, turned into Bernstein's point by point (Ainsworth and Sanchez, 2016): what goes
 * through the first k + 1 points is what goes through k, said to be of one degree more, and the
 * divided difference times (s - s_0) ... (s - s_(k-1)). The product's coefficients follow as
 *   w_j <- (j (1 - s_(k-1)) w_(j-1) - (k - j) s_(k-1) w_j)/k */
vs_curve vs_curve_through(const double y[VS_CURVE_POINTS]) {
  vs_curve c = {.b = {y[0]}}, w = {.b = {1}};
  double s[VS_CURVE_POINTS], divided[VS_CURVE_POINTS];
  for (int k = 0; k < VS_CURVE_POINTS; k++) {
    s[k] = vs_curve_point(k);
    divided[k] = y[k];
  }
  for (int k = 1; k < VS_CURVE_POINTS; k++)
    for (int i = VS_CURVE_MOST; i >= k; i--)
      divided[i] = (divided[i] - divided[i - 1]) / (s[i] - s[i - k]);
  for (int k = 1; k < VS_CURVE_POINTS; k++) {
    double at = s[k - 1];
    for (int j = k; j >= 0; j--)
      w.b[j] = ((j ? j * (1 - at) * w.b[j - 1] : 0) - (j < k ? (k - j) * at * w.b[j] : 0)) / k;
    elevate(&c);
    for (int j = 0; j <= k; j++) c.b[j] += divided[k] * w.b[j];
  }
  c.b[VS_CURVE_MOST] = y[VS_CURVE_MOST];
  return c;
}

/* ---- roots ---- */

/* Root of a curve that changes its sign once, from > 0 to < 0: Newton's, kept between bounds, on
 * its powers. What rounding makes of those of degree 13 moves the root by 1e-11 of the step. */
double vs_curve_root(vs_curve slope) {
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
