/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/responses.h"

#include <math.h>
#include <string.h>

#include "macromodel/fit.h"

_Static_assert(VS_SIGNAL_COLUMNS <= (int)VS_FIT_COLUMNS, "a fit has room for every column");

void vs_responses_begin(vs_responses *s, double omega_rad_s, size_t count) {
  *s = (vs_responses){.omega_rad_s = omega_rad_s, .count = count};
}

double vs_responses_seen(const vs_frame *frame, const vs_observation *seen, size_t n) {
  size_t terms = frame->deck->n_terms;
  if (n < terms) return seen->knot.terms[n];
  return n == terms ? seen->knot.i_mains_a : seen->memory[n - terms - 1];
}

/* What a signal is combined of, at t_s for that coil. */
static void columns(const vs_responses *s, double t_s, const vs_coil_state *c,
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

void vs_responses_at(const vs_responses *s, double t_s, const vs_coil_state *c,
                     double signal[VS_SIGNALS]) {
  double column[VS_SIGNAL_COLUMNS];
  columns(s, t_s, c, column);
  for (size_t n = 0; n < s->count; n++) {
    signal[n] = 0;
    for (size_t j = 0; j < VS_SIGNAL_COLUMNS; j++) signal[n] += s->weight[n][j] * column[j];
  }
}

bool vs_responses_hangs(const vs_responses *s, size_t n) {
  for (size_t j = VS_TERM_OF_V; j < VS_TERM_OF_DRIFT; j++)
    if (s->weight[n][j] != 0) return true;
  return false;
}

double vs_responses_drift(const vs_responses *s, size_t n) {
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

/* Two fits of which one has all columns of the other leave the other less over but for rounding.
 * That rounding is far below this factor. */
static const double FAR = 2;

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

/* A kind of fit to knots that all signals share. It is decomposed when a signal first needs it. */
typedef struct kind_of_fit {
  vs_fit fit;
  bool decomposed, good;
} kind_of_fit;

/* What the signals are fitted to. */
typedef struct sight {
  const vs_frame *frame;
  const vs_observation *const *seen;
  const vs_coil_state *coil;
  size_t knots;
  kind_of_fit kind[FITS];
} sight;

static bool decompose_fit(const vs_responses *s, const sight *in, int kind, vs_fit *f) {
  *f = vs_fit_new(in->knots, columns_of(kind));
  for (size_t k = 0; k < in->knots; k++) {
    double column[VS_SIGNAL_COLUMNS];
    columns(s, in->seen[k]->knot.t_s, &in->coil[k], column);
    for (size_t j = 0; j < f->a->size2; j++) gsl_matrix_set(f->a, k, j, column[column_at(kind, j)]);
  }
  return vs_fit_decompose(f);
}

/* Fits signal n in one way. Returns what is left over, INFINITY where there is no fit. */
static double fit_kind(const vs_responses *s, sight *in, size_t n, int kind,
                       double x[VS_SIGNAL_COLUMNS]) {
  kind_of_fit *of = &in->kind[kind];
  if (!of->decomposed) of->good = decompose_fit(s, in, kind, &of->fit);
  of->decomposed = true;
  if (!of->good) return INFINITY;
  for (size_t k = 0; k < in->knots; k++)
    gsl_vector_set(of->fit.b, k, vs_responses_seen(in->frame, in->seen[k], n));
  return vs_fit_solve(&of->fit, x);
}

static void keep_weights(vs_responses *s, size_t n, int kind, const double x[VS_SIGNAL_COLUMNS]) {
  memset(s->weight[n], 0, sizeof s->weight[n]);
  for (size_t j = 0; j < columns_of(kind); j++) s->weight[n][column_at(kind, j)] = x[j];
}

/* Fits signal n in each way, and keeps the plainest that is good enough. Returns false where there
 * is none. The fit with all columns leaves the least over: where even that is far from good enough,
 * the one with the drift alone is not tried. */
static bool fit_signal(vs_responses *s, sight *in, size_t n) {
  double x[VS_SIGNAL_COLUMNS], all[VS_SIGNAL_COLUMNS];
  double best = fit_kind(s, in, n, 0, x);
  if (!isfinite(best)) return false;
  keep_weights(s, n, 0, x);
  double left = fit_kind(s, in, n, WITH_COIL, x);
  if (left < HANGS * best) {
    best = left;
    keep_weights(s, n, WITH_COIL, x);
  }
  double least = fit_kind(s, in, n, WITH_COIL | WITH_DRIFT, all);
  left = least < FAR * BETTER * best ? fit_kind(s, in, n, WITH_DRIFT, x) : INFINITY;
  if (left < BETTER * best) {
    best = left;
    keep_weights(s, n, WITH_DRIFT, x);
  }
  if (least < BETTER * best) keep_weights(s, n, WITH_COIL | WITH_DRIFT, all);
  return true;
}

bool vs_responses_fit(vs_responses *s, const vs_frame *frame, const vs_observation *const *seen,
                      const vs_coil_state *coil, size_t knots) {
  sight in = {.frame = frame, .seen = seen, .coil = coil, .knots = knots};
  bool good = true;
  s->from_s = seen[0]->knot.t_s;
  for (size_t n = 0; good && n < s->count; n++) good = fit_signal(s, &in, n);
  for (int kind = 0; kind < FITS; kind++)
    if (in.kind[kind].decomposed) vs_fit_free(&in.kind[kind].fit);
  return good;
}
