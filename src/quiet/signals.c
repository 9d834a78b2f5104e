/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "quiet/signals.h"

#include <math.h>
#include <string.h>

#include "quiet/fit.h"

_Static_assert(VS_SIGNAL_COLUMNS <= (int)VS_FIT_COLUMNS, "a fit has room for every column");

void vs_signals_begin(vs_signals *s, double omega_rad_s, size_t count) {
  *s = (vs_signals){.omega_rad_s = omega_rad_s, .count = count};
}

double vs_signals_seen(const vs_frame *frame, const vs_seen *seen, size_t n) {
  size_t terms = frame->deck->n_terms;
  if (n < terms) return seen->knot.terms[n];
  return n == terms ? seen->knot.i_mains_a : seen->memory[n - terms - 1];
}

/* What a signal is combined of, at t_s for that coil. */
static void columns(const vs_signals *s, double t_s, const vs_coil_state *c,
                    double out[VS_SIGNAL_COLUMNS]) {
  double angle = s->omega_rad_s * t_s, cosine = cos(angle), sine = sin(angle);
  double *cosines = out + VS_TERM_OF_COSINES, *sines = out + VS_TERM_OF_SINES;
  cosines[0] = cosine;
  sines[0] = sine;
  for (int h = 1; h < VS_HARMONICS; h++) {
    cosines[h] = cosines[h - 1] * cosine - sines[h - 1] * sine;
    sines[h] = sines[h - 1] * cosine + cosines[h - 1] * sine;
  }
  out[VS_TERM_OF_MEAN] = 1;
  out[VS_TERM_OF_V] = c->v_v;
  out[VS_TERM_OF_I] = c->i_a;
  out[VS_TERM_OF_V_RATE] = c->v_rate_v_s;
  out[VS_TERM_OF_DRIFT] = t_s - s->from_s;
}

void vs_signals_at(const vs_signals *s, double t_s, const vs_coil_state *c,
                   double signal[VS_SIGNALS]) {
  double column[VS_SIGNAL_COLUMNS];
  columns(s, t_s, c, column);
  for (size_t n = 0; n < s->count; n++) {
    signal[n] = 0;
    for (size_t j = 0; j < VS_SIGNAL_COLUMNS; j++) signal[n] += s->weight[n][j] * column[j];
  }
}

bool vs_signals_hangs(const vs_signals *s, size_t n) {
  for (size_t j = VS_TERM_OF_V; j < VS_TERM_OF_DRIFT; j++)
    if (s->weight[n][j] != 0) return true;
  return false;
}

double vs_signals_drift(const vs_signals *s, size_t n) {
  return s->weight[n][VS_TERM_OF_DRIFT];
}

/* ---- fitted ---- */

/* A signal is taken to drift, as an integral does, only where a fit with a drift leaves less than a
 * tenth over of what the best one without leaves; and to hang on the coil where that leaves less
 * than 0.8. Over one cycle the coil's voltage is nearly a sine, and what it shares with the signal
 * beyond that may be chance, which does not last. */
static const double BETTER = 0.1, HANGS = 0.8;

/* The fits that are tried for a signal: with the columns of the coil or without, with the drift or
 * without. As bits; the plainest comes first. */
enum { WITH_COIL = 1, WITH_DRIFT = 2, FITS = 4 };

/* Which of a signal's columns is the j-th of this kind of fit. Without the coil's the drift, if
 * there is one, stands right behind the mean. */
static size_t column_at(int kind, size_t j) {
  if (!(kind & WITH_COIL) && j >= VS_TERM_OF_V) return VS_TERM_OF_DRIFT;
  return j;
}

static size_t columns_of(int kind) {
  size_t count = kind & WITH_COIL ? VS_TERM_OF_DRIFT : VS_TERM_OF_V;
  return kind & WITH_DRIFT ? count + 1 : count;
}

static bool begin_fit(const vs_signals *s, const vs_seen *const *seen, const vs_coil_state *coil,
                      int kind, vs_fit *f) {
  for (size_t k = 0; k < f->a->size1; k++) {
    double column[VS_SIGNAL_COLUMNS];
    columns(s, seen[k]->knot.t_s, &coil[k], column);
    for (size_t j = 0; j < f->a->size2; j++) gsl_matrix_set(f->a, k, j, column[column_at(kind, j)]);
  }
  return vs_fit_decompose(f);
}

/* Fits signal n in each way, and keeps the plainest that is good enough. Returns false where there
 * is none. */
static bool fit_signal(vs_signals *s, const vs_frame *frame, const vs_seen *const *seen, size_t n,
                       vs_fit fits[FITS]) {
  double x[VS_SIGNAL_COLUMNS], best = INFINITY;
  for (int kind = 0; kind < FITS; kind++) {
    vs_fit *f = &fits[kind];
    for (size_t k = 0; k < f->a->size1; k++)
      gsl_vector_set(f->b, k, vs_signals_seen(frame, seen[k], n));
    double left = vs_fit_solve(f, x);
    if (!(left < (kind & WITH_DRIFT ? BETTER : HANGS) * best) && kind) continue;
    best = left;
    memset(s->weight[n], 0, sizeof s->weight[n]);
    for (size_t j = 0; j < f->a->size2; j++) s->weight[n][column_at(kind, j)] = x[j];
  }
  return isfinite(best);
}

bool vs_signals_fit(vs_signals *s, const vs_frame *frame, const vs_seen *const *seen,
                    const vs_coil_state *coil, size_t knots) {
  vs_fit fits[FITS];
  bool good = true;
  s->from_s = seen[0]->knot.t_s;
  for (int kind = 0; kind < FITS; kind++) {
    fits[kind] = vs_fit_new(knots, columns_of(kind));
    good = begin_fit(s, seen, coil, kind, &fits[kind]) && good;
  }
  for (size_t n = 0; good && n < s->count; n++) good = fit_signal(s, frame, seen, n, fits);
  for (int kind = 0; kind < FITS; kind++) vs_fit_free(&fits[kind]);
  return good;
}
