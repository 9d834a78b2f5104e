/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ideal/taylor.h"

#include <math.h>
#include <string.h>

#include "plant/coil.h"

/* n-th term of a product of two series. The newest terms are added last, so that the sum over the
 * others need not wait for them. */
static double product_of_series(const double *x, const double *y, int n) {
  double sum = 0;
  for (int j = 1; j < n; j++) sum += x[j] * y[n - j];
  return n ? sum + x[0] * y[n] + x[n] * y[0] : x[0] * y[0];
}

static double larger_of(double a, double b) {
  return a > b ? a : b;
}

/* q[n+2] from q[n], q[n+1] and the n-th term of F: Eq. 54, order by order. Constant forces belong
 * to order 0. */
static inline __attribute__((always_inline)) void next_q(const vs_driven *driven, vs_taylor *s,
                                                         int n, double force, int dof) {
  const vs_model *m = driven->frame->model;
  double v[VS_MOST_DOF], acceleration[VS_MOST_DOF], h = s->span_s, rate = (n + 1) / h;
  for (int i = 0; i < dof; i++) v[i] = rate * s->q[n + 1][i];
  if (driven->touched) { /* k (g - at) + c g': the at belongs to order 0 */
    const vs_stop *stop = &m->stops.item[0];
    double g = vs_mechanics_travel(m, s->q[n]), depth = n ? g : g - stop->at_m;
    force += stop->stiffness * depth + stop->damping_ns_m * vs_mechanics_travel(m, v);
  }
  vs_mechanics_accelerations(m, s->q[n], v, force, acceleration);
  for (int i = 0; n && m->loaded && i < dof; i++) acceleration[i] -= m->m0[i];
  if (driven->held) vs_mechanics_hold(m, acceleration);
  double weight = h * h / ((n + 1) * (n + 2));
  for (int i = 0; i < dof; i++) s->q[n + 2][i] = weight * acceleration[i];
}

/* The terms of one of the mains' sines: those of its voltage u and, from which these follow, of the
 * cosine v beside it; wh is the angle that it turns over the span. */
typedef struct sine_terms {
  double wh, u, v;
} sine_terms;

static sine_terms begin_sine(const vs_sine *s, double since_s, double span_s) {
  double phase = s->phase_rad + s->omega_rad_s * since_s, wh = s->omega_rad_s * span_s;
  return (sine_terms){wh, s->peak_v * sin(phase),
                      s->peak_v * s->omega_rad_s * cos(phase) * span_s / wh};
}

/* Returns the n-th term of the mains' voltage, and takes each sine on to its next term. */
static double mains_term(sine_terms *sine, size_t count, int n) {
  double sum = sine->u;
  for (size_t k = 1; k < count; k++) sum += sine[k].u;
  for (size_t k = 0; k < count; k++) {
    double ratio = sine[k].wh / (n + 1), next = ratio * sine[k].v;
    sine[k].v = -ratio * sine[k].u;
    sine[k].u = next;
  }
  return sum;
}

/* ---- with eddy currents ---- */

/* The n-th term of lambda where nothing flows in the coil and no secondary is without leakage:
 * lambda (z/(2a) + leak_1_h) = sum k/L psi. */
static double faded_flux_term(const vs_coil *c, const vs_taylor *s, const double *z, int n) {
  double sum = -vs_coil_rungs_current(c, 0, s->psi[n]);
  for (int j = 0; j < n; j++) sum -= s->flux[j] * z[n - j] / (2 * c->a_hm);
  return sum / (z[0] / (2 * c->a_hm) + c->leak_1_h);
}

/* The n-th term of the current, and the next ones of lambda and psi; u: the mains' n-th. */
static void eddy_terms(const vs_driven *d, vs_taylor *s, const double *z, int n, double u) {
  const vs_coil *c = &s->model->coil;
  const double r = c->resistance_ohm, share = 1 + r * c->core_s;
  double base = product_of_series(s->flux, z, n) / (2 * c->a_hm) +
                vs_coil_rungs_current(c, s->flux[n], s->psi[n]);
  s->current[n] = d->conducting ? c->rest_h * (base + c->core_s * u) / share : 0;
  if (n == VS_SERIES_ORDER) return;
  double ratio = s->span_s / (n + 1);
  for (int k = 0; k < c->rungs; k++)
    s->psi[n + 1][k] = ratio * vs_coil_rung_rate(c, k, s->flux[n], s->psi[n]);
  if (d->conducting)
    s->flux[n + 1] = ratio * (u - r * base) / share;
  else if (c->core_s > 0)
    s->flux[n + 1] = -ratio * base / c->core_s;
}

/* vs_taylor_make for a coil with or without eddy currents. */
static inline __attribute__((always_inline)) void make_series(const vs_driven *driven,
                                                              const vs_knot *knot, double span_s,
                                                              const bool eddies, vs_taylor *s) {
  const vs_model *m = driven->frame->model;
  const vs_wave *mains = &driven->mains;
  sine_terms sine[VS_WAVE_MOST];
  double per_2a = 1 / (2 * m->coil.a_hm);
  double z[VS_SERIES_ORDER + 1] = {m->coil.gap_rest_m}, force = 0; /* terms of the gap */
  const bool moves = !driven->frame->gap_at_rest,
             flows = driven->conducting || (eddies && driven->fades),
             faded = eddies && driven->fades && m->coil.core_s == 0;
  s->span_s = span_s;
  s->model = m;
  memset(s->flux, 0, sizeof s->flux);
  s->flux[0] = knot->flux_wb;
  if (eddies) { /* the others follow below, or are none */
    memset(s->psi, 0, sizeof s->psi);
    memcpy(s->psi[0], knot->psi_wb, sizeof s->psi[0]);
  }
  for (int i = 0; i < m->dof; i++) {
    s->q[0][i] = knot->x[i];
    s->q[1][i] = knot->x[m->dof + i] * span_s;
  }
  for (size_t k = 0; k < mains->count && driven->conducting; k++)
    sine[k] = begin_sine(&mains->sine[k], driven->since_s, span_s);
  for (int n = 0; n < VS_SERIES_ORDER; n++) {
    if (flows) { /* lambda[n+1] (Eqs. 80, 81), F[n] = lambda^2/(4a) */
      double ratio = span_s / (n + 1),
             u = !eddies || driven->conducting ? mains_term(sine, mains->count, n) : 0;
      z[n] += moves ? vs_mechanics_travel(m, s->q[n]) : 0;
      if (faded) s->flux[n] = faded_flux_term(&m->coil, s, z, n);
      force = product_of_series(s->flux, s->flux, n) * per_2a / 2;
      if (eddies)
        eddy_terms(driven, s, z, n, u);
      else
        s->flux[n + 1] =
            ratio * (u - m->coil.resistance_ohm * per_2a * product_of_series(s->flux, z, n));
    }
    if (n + 2 > VS_SERIES_ORDER) continue;
    if (m->dof == VS_ROWS)
      next_q(driven, s, n, force, VS_ROWS);
    else
      next_q(driven, s, n, force, m->dof);
  }
  if (!eddies || !flows) return;
  z[VS_SERIES_ORDER] += moves ? vs_mechanics_travel(m, s->q[VS_SERIES_ORDER]) : 0;
  if (faded) s->flux[VS_SERIES_ORDER] = faded_flux_term(&m->coil, s, z, VS_SERIES_ORDER);
  if (driven->conducting)
    eddy_terms(driven, s, z, VS_SERIES_ORDER, mains_term(sine, mains->count, VS_SERIES_ORDER));
}

void vs_taylor_make(const vs_driven *driven, const vs_knot *knot, double span_s, vs_taylor *s) {
  if (driven->frame->model->coil.eddies)
    make_series(driven, knot, span_s, true, s);
  else
    make_series(driven, knot, span_s, false, s);
}

double vs_taylor_term(const vs_driven *driven, const vs_taylor *s, int n) {
  const double flux = larger_of(driven->flux_wb, fabs(s->flux[0]));
  const vs_model *m = s->model;
  double largest = fabs(s->flux[n]) / flux;
  for (int k = 0; k < m->coil.rungs; k++)
    largest = larger_of(largest, fabs(s->psi[n][k]) / (m->coil.rung[k].share * flux));
  for (int i = 0; i < m->dof; i++) {
    double size = larger_of(driven->coordinate[i], fabs(s->q[0][i]) + fabs(s->q[1][i]));
    largest = larger_of(largest, fabs(s->q[n][i]) / size);
  }
  return largest;
}

static inline __attribute__((always_inline)) void state_at(const vs_taylor *s, double r, int dof,
                                                           double *y) {
  double q[VS_MOST_DOF], v[VS_MOST_DOF];
  for (int i = 0; i < dof; i++) {
    q[i] = s->q[VS_SERIES_ORDER][i];
    v[i] = 0;
  }
  for (int n = VS_SERIES_ORDER - 1; n >= 0; n--)
    for (int i = 0; i < dof; i++) {
      v[i] = v[i] * r + q[i];
      q[i] = q[i] * r + s->q[n][i];
    }
  for (int i = 0; i < dof; i++) {
    y[i] = q[i];
    y[dof + i] = v[i] / s->span_s;
  }
}

void vs_taylor_at(const vs_taylor *s, double at_s, double y[VS_CONDUCTING]) {
  double r = at_s / s->span_s, flux = s->flux[VS_SERIES_ORDER];
  for (int n = VS_SERIES_ORDER - 1; n >= 0; n--) flux = flux * r + s->flux[n];
  y[VS_FLUX] = flux;
  for (int k = 0; k < s->model->coil.rungs; k++) {
    y[VS_PSI + k] = 0;
    for (int n = VS_SERIES_ORDER; n >= 0; n--) y[VS_PSI + k] = y[VS_PSI + k] * r + s->psi[n][k];
  }
  if (s->model->dof == VS_ROWS)
    state_at(s, r, VS_ROWS, y);
  else
    state_at(s, r, s->model->dof, y);
}

/* Sums up terms, and gives the slope of the sum. */
static double sum_up(const vs_taylor *s, const double terms[VS_SERIES_ORDER + 1], double at_s,
                     double *rate) {
  double r = at_s / s->span_s, value = 0, slope = 0;
  for (int n = VS_SERIES_ORDER; n >= 0; n--) {
    slope = slope * r + value;
    value = value * r + terms[n];
  }
  *rate = slope / s->span_s;
  return value;
}

/* What a conduction ends with. */
static const double *ending(const vs_taylor *s) {
  return s->model->coil.eddies ? s->current : s->flux;
}

double vs_taylor_travel(const vs_taylor *s, double at_s, double *rate) {
  double terms[VS_SERIES_ORDER + 1];
  for (int n = 0; n <= VS_SERIES_ORDER; n++) terms[n] = vs_mechanics_travel(s->model, s->q[n]);
  return sum_up(s, terms, at_s, rate);
}

double vs_taylor_flux(const vs_taylor *s, double at_s, double *rate) {
  return sum_up(s, ending(s), at_s, rate);
}

/* ---- the first fall of lambda ---- */

/* Bernstein's coefficients of a polynomial on a stretch of its argument, between the least and the
 * largest of which it lies. */
typedef struct stretch {
  double lower, upper; /* of 0..1 */
  double b[VS_SERIES_ORDER + 1];
} stretch;

/* The coefficients of sum c[n] x^n on 0..1: b[k] = sum over n of c[n] binomial(k, n)/binomial(N,
 * n), made by sums of neighbours. */
static void bernstein(const double c[VS_SERIES_ORDER + 1], stretch *s) {
  double choose = 1;
  s->lower = 0;
  s->upper = 1;
  for (int n = 0; n <= VS_SERIES_ORDER; n++) {
    s->b[n] = c[n] / choose;
    choose = choose * (VS_SERIES_ORDER - n) / (n + 1);
  }
  for (int round = 1; round <= VS_SERIES_ORDER; round++)
    for (int n = VS_SERIES_ORDER; n >= round; n--) s->b[n] += s->b[n - 1];
}

/* The coefficients on either half of the stretch, by de Casteljau's scheme. */
static void halve_series(const stretch *s, stretch *left, stretch *right) {
  *right = *s;
  left->lower = s->lower;
  left->upper = right->lower = (s->lower + s->upper) / 2;
  for (int n = 0; n <= VS_SERIES_ORDER; n++) {
    left->b[n] = right->b[0];
    for (int k = 0; k < VS_SERIES_ORDER - n; k++) right->b[k] = (right->b[k] + right->b[k + 1]) / 2;
  }
}

typedef enum falls { NEVER, ONCE, UNKNOWN } falls;

/* Tells by the signs of the coefficients whether the polynomial falls below zero: they change as
 * often as it has zeros, or an even number of times more. Between -nothing and nothing a
 * coefficient has the sign of the one before. */
static falls judge_series(const stretch *s, double nothing) {
  int changes = 0, sign = 1;
  bool below = false;
  for (int k = 0; k <= VS_SERIES_ORDER; k++) {
    int own = s->b[k] > nothing ? 1 : s->b[k] < -nothing ? -1 : sign;
    changes += own != sign;
    below = below || own < 0;
    sign = own;
  }
  return !below ? NEVER : changes == 1 && s->b[VS_SERIES_ORDER] < -nothing ? ONCE : UNKNOWN;
}

bool vs_taylor_flux_falls(const vs_taylor *series, double at_s, double nothing_wb, double *lower_s,
                          double *upper_s) {
  enum { DEEPEST = 48 }; /* halvings, which come near the rounding of the stretch's ends */
  stretch waiting[DEEPEST + 2];
  double c[VS_SERIES_ORDER + 1], r = at_s / series->span_s, power = 1, others = 0;
  for (int n = 0; n <= VS_SERIES_ORDER; n++, power *= r) c[n] = ending(series)[n] * power;
  for (int n = 1; n <= VS_SERIES_ORDER; n++) others += fabs(c[n]);
  if (c[0] > others) return false;
  bernstein(c, &waiting[0]);
  for (size_t count = 1; count;) {
    stretch s = waiting[--count];
    falls f = judge_series(&s, nothing_wb);
    if (f == UNKNOWN && s.upper - s.lower < ldexp(1, -DEEPEST))
      f = s.b[VS_SERIES_ORDER] < -nothing_wb ? ONCE : NEVER;
    *lower_s = s.lower * at_s;
    *upper_s = s.upper * at_s;
    if (f == ONCE) return true;
    if (f == NEVER) continue;
    halve_series(&s, &waiting[count + 1], &waiting[count]);
    count += 2;
  }
  return false;
}
