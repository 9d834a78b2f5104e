/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/reaction.h"

#include <math.h>

/* A step is at most half a radian of the fastest mode long, so that in one of its PARTS a reaction
 * turns once at most. Five points are exact to degree 9 in each of them. */
enum { PARTS = 8, POINTS = 5 };
static const double AT[POINTS] = {0.04691007703066800, 0.23076534494715845, 0.5,
                                  0.76923465505284155, 0.95308992296933200};
static const double WEIGHT[POINTS] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                      0.23931433524968324, 0.11846344252809454};

/* The row i of K a + B b. */
static double row(const vs_model *m, int i, const double *a, const double *b) {
  double sum = 0;
  for (int j = 0; j < m->dof; j++) sum += m->stiffness[i][j] * a[j] + m->damping[i][j] * b[j];
  return sum;
}

static double value_at(const vs_step *step, double t_s, int i) {
  double y[VS_CH_MOST];
  vs_step_groups_at(step, t_s, VS_GROUP_VELOCITIES, y);
  return row(step->frame->model, i, y + VS_CH_Q, y + vs_channel_rates(step->frame->model));
}

static double rate_at(const vs_step *step, double t_s, int i) {
  const vs_model *m = step->frame->model;
  double y[VS_CH_MOST];
  vs_step_groups_at(step, t_s, VS_GROUP_VELOCITIES | VS_GROUP_ACCELERATIONS, y);
  return row(m, i, y + vs_channel_rates(m), y + vs_channel_rates2(m));
}

static void take(vs_value *peak, double value, double t_s) {
  if (!peak->known || fabs(value) > peak->value) *peak = (vs_value){true, fabs(value), t_s};
}

/* Looks for the largest size between lo and hi: at the end, and where the rate is 0. */
static void follow(vs_reaction *r, const vs_step *step, int i, double lo, double hi) {
  double before = rate_at(step, lo, i), end = hi;
  bool turns = before * rate_at(step, hi, i) < 0;
  for (int n = 0; turns && n < 60; n++) {
    double mid = (lo + hi) / 2;
    if (rate_at(step, mid, i) * before > 0)
      lo = mid;
    else
      hi = mid;
  }
  if (turns) take(&r->peak[i], value_at(step, hi, i), hi);
  take(&r->peak[i], value_at(step, end, i), end);
}

void vs_reaction_accept(vs_reaction *r, const vs_step *step) {
  double from = step->from->t_s, part = (step->to->t_s - from) / PARTS;
  if (!(part > 0)) return; /* the other side of an instant */
  r->span_s += PARTS * part;
  for (int i = 0; i < step->frame->model->dof; i++)
    for (int p = 0; p < PARTS; p++) {
      double lo = from + p * part, hi = p + 1 < PARTS ? lo + part : step->to->t_s;
      follow(r, step, i, lo, hi);
      for (int k = 0; k < POINTS; k++) {
        double value = value_at(step, lo + AT[k] * part, i);
        r->squared[i] += WEIGHT[k] * part * value * value;
      }
    }
}

double vs_reaction_rms(const vs_reaction *r, int i) {
  return sqrt(r->squared[i] / r->span_s);
}
