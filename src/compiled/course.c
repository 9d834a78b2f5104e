/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "course.h"

#include <math.h>
#include <stdlib.h>

#include "base/alloc.h"

struct vs_course_kind {
  const char *word, *wanted; /* what stands behind the word */
  int least, most;
  bool (*fits)(const double *v, int count);
  double (*at)(const double *v, int count, double t_s);
  double (*edge)(const double *v, int count, double t_s);
  double (*radian)(const double *v, int count); /* NULL: it is of straight lines */
};

/* ---- pulse(v1 v2 delay rise fall width [period]) ---- */

static bool pulse_fits(const double *v, int count) {
  const double busy_s = v[3] + v[4] + v[5];
  return v[2] >= 0 && v[3] > 0 && v[4] > 0 && v[5] > 0 && (count < 7 || v[6] >= busy_s);
}

/* The beginning of the period at t_s. */
static double pulse_begins(const double *v, int count, double t_s) {
  return count < 7 || t_s < v[2] ? v[2] : v[2] + v[6] * floor((t_s - v[2]) / v[6]);
}

static double pulse_at(const double *v, int count, double t_s) {
  const double t = t_s - pulse_begins(v, count, t_s), rise = v[3], fall = v[4], high = v[3] + v[5];
  if (t <= 0 || t >= high + fall) return v[0];
  if (t < rise) return v[0] + (v[1] - v[0]) * t / rise;
  return t <= high ? v[1] : v[1] + (v[0] - v[1]) * (t - high) / fall;
}

static double pulse_edge(const double *v, int count, double t_s) {
  const double corner[] = {0, v[3], v[3] + v[5], v[3] + v[5] + v[4]};
  const double from_s = pulse_begins(v, count, t_s);
  for (int k = 0; k < 4; k++)
    if (from_s + corner[k] > t_s) return from_s + corner[k];
  return count < 7 ? INFINITY : from_s + v[6];
}

/* ---- sin(offset amplitude frequency [delay [damping [phase]]]) ---- */

static double part(const double *v, int count, int k) {
  return k < count ? v[k] : 0;
}

static bool sine_fits(const double *v, int count) {
  return v[2] > 0 && part(v, count, 3) >= 0;
}

static double sine_at(const double *v, int count, double t_s) {
  const double t = fmax(t_s - part(v, count, 3), 0), phase_rad = part(v, count, 5) * M_PI / 180;
  return v[0] + v[1] * sin(2 * M_PI * v[2] * t + phase_rad) * exp(-t * part(v, count, 4));
}

static double sine_edge(const double *v, int count, double t_s) {
  return part(v, count, 3) > t_s ? part(v, count, 3) : INFINITY;
}

/* With its damping, a part of whose time constant is one of its radians. */
static double sine_radian(const double *v, int count) {
  return 1 / hypot(2 * M_PI * v[2], part(v, count, 4));
}

/* ---- pwl(t1 v1 t2 v2 ...) ---- */

static bool line_fits(const double *v, int count) {
  bool rises = count % 2 == 0;
  for (int k = 2; k < count; k += 2) rises = rises && v[k] > v[k - 2];
  return rises;
}

static double line_at(const double *v, int count, double t_s) {
  int k = 0;
  while (k < count && v[k] <= t_s) k += 2;
  if (k == 0) return v[1];
  if (k == count) return v[count - 1];
  return v[k - 1] + (v[k + 1] - v[k - 1]) * (t_s - v[k - 2]) / (v[k] - v[k - 2]);
}

static double line_edge(const double *v, int count, double t_s) {
  for (int k = 0; k < count; k += 2)
    if (v[k] > t_s) return v[k];
  return INFINITY;
}

/* ---- all ---- */

enum { MOST = 2000 };
static const struct vs_course_kind KINDS[] = {
    {"pulse", "v1, v2, delay, rise, fall, width and maybe a period, the last four above 0", 6, 7,
     pulse_fits, pulse_at, pulse_edge, NULL},
    {"sin", "offset, amplitude and a frequency above 0, maybe delay, damping and phase", 3, 6,
     sine_fits, sine_at, sine_edge, sine_radian},
    {"pwl", "pairs of rising times and values", 2, MOST, line_fits, line_at, line_edge, NULL}};

static const struct vs_course_kind *kind_of(vs_word word) {
  for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS; k++)
    if (vs_words_is(word, KINDS[k].word)) return &KINDS[k];
  return NULL;
}

bool vs_course_is(vs_word word) {
  return kind_of(word) != NULL;
}

vs_status vs_course_read(const vs_cards *cards, vs_parameters *in, const vs_netlist_card *card,
                         size_t first, vs_course *w, vs_error *err) {
  const size_t count = card->words - first - 1;
  *w = (vs_course){kind_of(vs_cards_word(cards, card, first)), vs_alloc(count + 1, sizeof(double)),
                   (int)count};
  const struct vs_course_kind *kind = w->kind;
  vs_status status = VS_OK;
  for (size_t k = 0; k < count && !status; k++)
    status =
        vs_parameters_of(cards, in, vs_cards_word(cards, card, first + 1 + k), &w->value[k], err);
  if (status) return status;
  if (card->count == card->words && (int)count >= kind->least && (int)count <= kind->most &&
      kind->fits(w->value, w->count))
    return VS_OK;
  return vs_fail(err, VS_INPUT, "of %s only these are known here: %s", kind->word, kind->wanted);
}

void vs_course_free(vs_course *w) {
  free(w->value);
  *w = (vs_course){0};
}

double vs_course_at(const vs_course *w, double t_s) {
  return w->kind->at(w->value, w->count, t_s);
}

double vs_course_edge(const vs_course *w, double t_s) {
  return w->kind ? w->kind->edge(w->value, w->count, t_s) : INFINITY;
}

double vs_course_radian(const vs_course *w) {
  return w->kind && w->kind->radian ? w->kind->radian(w->value, w->count) : INFINITY;
}
