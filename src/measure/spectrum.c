/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/spectrum.h"

#include <math.h>

/* Gauss' rule of POINTS points on pieces of at most a PIECES-th of a cycle. Over such a piece the
 * highest harmonic turns by 4 pi, which the rule integrates to rounding, together with a polynomial
 * of degree 14 in time: the current's, as a product of flux linkage and gap. */
enum { POINTS = 24, PIECES = 20 };

void vs_spectrum_begin(vs_spectrum *s, double omega_rad_s) {
  *s = (vs_spectrum){.omega_rad_s = omega_rad_s};
  s->rule = vs_checked(gsl_integration_glfixed_table_alloc(POINTS));
}

void vs_spectrum_end(vs_spectrum *s) {
  if (s->rule) gsl_integration_glfixed_table_free(s->rule);
  s->rule = NULL;
  vs_grouping_end(&s->grouping);
}

void vs_spectrum_begin_groups(vs_spectrum *s, double from_s, int cycles, int period) {
  vs_grouping_begin(&s->grouping, 2 * M_PI / s->omega_rad_s, from_s, cycles, period);
}

void vs_spectrum_add(vs_spectrum *s, double t_s, double weight_s, double current) {
  double part = weight_s * current;
  s->squared += part * current;
  for (int n = 0; n < VS_SPECTRUM_LINES; n++) {
    double angle = n * s->omega_rad_s * t_s;
    s->cosine[n] += part * cos(angle);
    s->sine[n] += part * sin(angle);
  }
  vs_grouping_add(&s->grouping, t_s, weight_s, current);
}

/* Takes a stretch of a step, which lies within one cycle where groups are told. */
static void add_stretch(vs_spectrum *s, const vs_step *step, double from, double length) {
  double y[VS_CH_MOST];
  int pieces = (int)ceil(length * s->omega_rad_s * PIECES / (2 * M_PI));
  for (int p = 0; p < pieces; p++)
    for (size_t k = 0; k < POINTS; k++) {
      double t, weight, lower = from + length * p / pieces,
                        upper = from + length * (p + 1) / pieces;
      gsl_integration_glfixed_point(lower, upper, k, &t, &weight, s->rule);
      vs_step_groups_at(step, t, 0, y);
      vs_spectrum_add(s, t, weight, y[VS_CH_I_MAINS]);
    }
}

void vs_spectrum_accept(vs_spectrum *s, const vs_step *step) {
  double from = step->from->t_s, length = step->to->t_s - from, cut;
  if (!(length > 0)) return; /* the other side of an instant */
  s->span_s += length;
  if (step->frame->source_is_coil && vs_step_is_quiet(step)) return;
  for (; (cut = vs_grouping_cut(&s->grouping, from)) < step->to->t_s; from = cut)
    add_stretch(s, step, from, cut - from);
  add_stretch(s, step, from, step->to->t_s - from);
}

double vs_spectrum_harmonic(const vs_spectrum *s, int n) {
  double size = hypot(s->cosine[n], s->sine[n]) / s->span_s;
  return n ? M_SQRT2 * size : size; /* amplitude 2 size; rms: over the root of 2 */
}

double vs_spectrum_judged(const vs_spectrum *s, int n) {
  return s->grouping.told ? vs_grouping_at(&s->grouping, n) : vs_spectrum_harmonic(s, n);
}

double vs_spectrum_mean(const vs_spectrum *s) {
  return s->cosine[0] / s->span_s;
}

double vs_spectrum_rms(const vs_spectrum *s) {
  return sqrt(s->squared / s->span_s);
}

/* Table 1 of the standard. From harmonic 15 on odd ones, from 8 on even ones are held to the 15th's
 * and the eighth's limit in inverse proportion to n. */
double vs_spectrum_limit(int n) {
  static const double FIRST[] = {NAN,  NAN,  1.08, 2.30, 0.43, 1.14, 0.30,
                                 0.77, 0.23, 0.40, NAN,  0.33, NAN,  0.21};
  if (n < (int)(sizeof FIRST / sizeof *FIRST) && (n % 2 || n < 8)) return FIRST[n];
  return n % 2 ? 0.15 * 15 / n : 0.23 * 8 / n;
}
