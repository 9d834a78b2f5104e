/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/gain.h"

#include <math.h>

#include "place.h"
#include "poles.h"
#include "riccati.h"

/* By which part of its size a pole may miss the one that is wanted. */
static const double MISSED = 0.005;

static vs_status place(const vs_gain_ask *q, gsl_matrix *gain, vs_error *err) {
  const vs_sampled *p = q->system;
  const vs_scaled *s = q->scaled;
  vs_pole pole[VS_SAMPLED_MOST], reached[VS_SAMPLED_MOST];
  gsl_complex wanted[VS_SAMPLED_MOST];
  vs_status status = vs_poles_read(q->map, p, pole, err);
  if (status) return status;
  for (int k = 0; k < p->states; k++) wanted[k] = vs_sampled_difference(p, pole[k]);
  gsl_matrix *k = vs_checked(gsl_matrix_alloc(gain->size2, gain->size1));
  bool good = vs_place(s->at, s->cat, wanted, k);
  gsl_matrix_transpose_memcpy(gain, k);
  gsl_matrix_scale(gain, s->unit_s);
  gsl_matrix_free(k);
  good = good && vs_sampled_poles(p, s, gain, reached);
  double off = good ? vs_poles_missed(pole, reached, p->states) : INFINITY;
  if (off < MISSED) return VS_OK;
  return vs_fail_at(err, vs_tree_child(q->map, "poles")->key_where,
                    "control.observer.poles: rounding moves them by %.2g %% with the gain that is "
                    "found; set them further apart, nearer to the machine's own, or add a sensor",
                    100 * off);
}

/* What is not known of a sample, SI of the channel, squared: the noise, and a step of the A/D,
 * whose error is spread evenly over it. An instrument with neither is taken to be right to a
 * millionth of its range, as no instrument is free of errors. */
static double variance(const vs_sensor *s) {
  const vs_instrument_values *v = &s->instrument->v;
  double span = s->range[1] - s->range[0], unit = span / (v->range[1] - v->range[0]);
  double step = v->bits ? ldexp(span, -v->bits) : 0, noise = v->noise * unit;
  return fmax(noise * noise + step * step / 12, pow(1e-6 * span, 2));
}

static vs_status filter(const vs_gain_ask *q, gsl_matrix *gain, vs_error *err) {
  const vs_sampled *p = q->system;
  const vs_scaled *s = q->scaled;
  size_t n = (size_t)p->states, m = (size_t)p->sensors;
  gsl_matrix *w = vs_checked(gsl_matrix_alloc(n, n)), *v = vs_checked(gsl_matrix_calloc(m, m)),
             *c = vs_checked(gsl_matrix_alloc(n, n));
  double noise = q->v->force_noise_n, energy = 0, push[VS_SAMPLED_MOST];
  for (size_t i = 0; i < n; i++) push[i] = noise * (p->b[0][i] + p->b[1][i]) / p->scale[i];
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) gsl_matrix_set(w, i, j, push[i] * push[j]);
  for (int i = p->dof; i < 2 * p->dof; i++) energy += push[i] * push[i];
  for (size_t i = (size_t)p->dof; i < 2 * (size_t)p->dof; i++)
    *gsl_matrix_ptr(w, i, i) += energy * pow(q->v->spread, 2);
  for (size_t k = 0; k < m; k++)
    gsl_matrix_set(v, k, k,
                   (variance(&p->sensor[k]) + pow(p->d[k] * noise, 2)) / pow(p->y_scale[k], 2));
  bool good = vs_riccati(s->full, s->c, w, v, c);
  if (good) vs_riccati_gain(c, s->c, v, gain);
  gsl_matrix_free(w);
  gsl_matrix_free(v);
  gsl_matrix_free(c);
  if (good) return VS_OK;
  return vs_fail_at(err, q->map->key_where,
                    "control.observer: no steady gain is found; kind: luenberger takes poles");
}

const vs_gain_kind vs_gain_kinds[VS_GAIN_KINDS + 1] = {
    {"kalman", {"force_noise", "spread"}, filter}, {"luenberger", {"poles"}, place}, {NULL}};
