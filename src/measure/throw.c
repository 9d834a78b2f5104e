/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/throw.h"

#include <math.h>

#include "engine/step.h"

/* ---- what is seen ---- */

static double along_way(const double *way, const double *rates, int dof) {
  double sum = 0;
  for (int i = 0; i < dof; i++) sum += way[i] * rates[i];
  return sum;
}

static void values_at(const vs_step *step, double s, double out[VS_THROW_COURSES]) {
  const vs_model *m = step->frame->model;
  double y[VS_CH_MOST], from = step->from->t_s, to = step->to->t_s;
  double t_s = s < 1 ? from + s * (to - from) : to;
  vs_step_groups_at(step, t_s, VS_GROUP_VELOCITIES | VS_GROUP_ACCELERATIONS, y);
  for (int k = 0; k < VS_MACHINE_WAYS; k++)
    out[k] = along_way(m->way[k], y + vs_channel_rates2(m), m->dof);
  out[VS_THROW_SPEED] = along_way(m->way[VS_MACHINE_UP], y + vs_channel_rates(m), m->dof);
}

static void keep_largest_throw(vs_throw *w, int k, double value, double t_s) {
  if (!w->least[k].known || value < w->least[k].value) w->least[k] = (vs_value){true, value, t_s};
  if (!w->most[k].known || value > w->most[k].value) w->most[k] = (vs_value){true, value, t_s};
}

static void take_throw_at(vs_throw *w, const vs_step *step, double s) {
  double value[VS_THROW_COURSES], from = step->from->t_s, to = step->to->t_s;
  values_at(step, s, value);
  for (int k = 0; k < VS_THROW_COURSES; k++)
    keep_largest_throw(w, k, value[k], from + s * (to - from));
}

/* A step is short against the fastest swing, so that a course turns once at most in each of these
 * parts of it, or of LEAST where it is much shorter. */
enum { PARTS = 16, LEAST = 4 };

/* Takes the places at which the slope of one course is 0. The slope is that of a polynomial through
 * the course's values: where it turns need not be known well, as its value hardly changes there. */
static void take_throw_turns(vs_throw *w, const vs_step *step, const vs_curve *slope) {
  const int parts = vs_step_parts(step, LEAST, PARTS);
  for (int p = 0; p < parts; p++) {
    double lo = (double)p / parts, hi = (p + 1.0) / parts, before = vs_step_curve_value(slope, lo);
    if (before * vs_step_curve_value(slope, hi) > 0) continue;
    for (int n = 0; n < 40; n++) {
      double mid = (lo + hi) / 2;
      if (vs_step_curve_value(slope, mid) * before > 0)
        lo = mid;
      else
        hi = mid;
    }
    take_throw_at(w, step, hi);
  }
}

void vs_throw_accept(vs_throw *w, const vs_step *step) {
  double value[VS_CURVE_POINTS][VS_THROW_COURSES], of[VS_CURVE_POINTS];
  w->model = step->frame->model;
  if (!(step->to->t_s > step->from->t_s)) return; /* the other side of an instant */
  for (int j = 0; j < VS_CURVE_POINTS; j++) values_at(step, vs_step_curve_point(j), value[j]);
  for (int k = 0; k < VS_THROW_COURSES; k++) {
    for (int j = 0; j < VS_CURVE_POINTS; j++) of[j] = value[j][k];
    const vs_curve curve = vs_step_curve_through(of), slope = vs_step_curve_slope(&curve, 1);
    take_throw_turns(w, step, &slope);
  }
  take_throw_at(w, step, 0);
  take_throw_at(w, step, 1);
}

/* ---- what follows ---- */

static bool knows_way(const vs_throw *w, int way) {
  return w->model && w->most[way].known && w->model->machine->load.way[way].text;
}

static vs_value unknown_throw(void) {
  return (vs_value){.at_s = NAN};
}

/* The larger of the two sizes, over g. */
static vs_value size_of_throw(const vs_throw *w, int way) {
  if (!knows_way(w, way)) return unknown_throw();
  vs_value v = fabs(w->least[way].value) > fabs(w->most[way].value) ? w->least[way] : w->most[way];
  v.value = fabs(v.value) / vs_model_gravity_m_s2;
  return v;
}

vs_value vs_throw_coefficient(const vs_throw *w) {
  return size_of_throw(w, VS_MACHINE_ALONG);
}

vs_value vs_throw_number(const vs_throw *w) {
  return size_of_throw(w, VS_MACHINE_UP);
}

vs_value vs_throw_down(const vs_throw *w) {
  if (!knows_way(w, VS_MACHINE_UP)) return unknown_throw();
  vs_value v = w->least[VS_MACHINE_UP];
  v.value = -v.value / vs_model_gravity_m_s2;
  return v;
}

const double vs_throw_most = 3.2969083094756; /* sqrt(1 + pi^2) */

/* n for the throw number G > 1, by bisection, as G grows with the flight; 1 beyond vs_throw_most.
 */
static double flight(double number) {
  double lo = 0, hi = 1;
  if (number >= vs_throw_most) return 1;
  for (int k = 0; k < 60; k++) {
    double n = (lo + hi) / 2, x = 2 * M_PI * n, s = sin(x / 2);
    double cotangent = (x * x / 2 - 2 * s * s) / (x - sin(x));
    if (hypot(1, cotangent) < number)
      lo = n;
    else
      hi = n;
  }
  return (lo + hi) / 2;
}

static double amplitude(const vs_throw *w, int k) {
  return (w->most[k].value - w->least[k].value) / 2;
}

/* The frequency is that at which a swing has these amplitudes of speed and acceleration: the trough
 * may swing several times in a period of the orbit. */
vs_value vs_throw_speed(const vs_throw *w) {
  const vs_value down = vs_throw_down(w);
  if (!down.known || !knows_way(w, VS_MACHINE_FORWARD) || !(down.value > 1)) return unknown_throw();
  double up = amplitude(w, VS_MACHINE_UP), n = flight(down.value);
  double frequency_hz = up / amplitude(w, VS_THROW_SPEED) / (2 * M_PI);
  double cotangent = amplitude(w, VS_MACHINE_FORWARD) / up;
  double v = vs_model_gravity_m_s2 * n * n * cotangent / (2 * frequency_hz);
  return (vs_value){true, v, NAN};
}
