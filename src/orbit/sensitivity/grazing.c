/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/grazing.h"

#include <math.h>

#include "parameter_rates.h"

/* It turns at the zero of the travel's rate, which is found by bisection. */
double vs_grazing_depth(const vs_step *step, const vs_stop *stop) {
  const vs_model *m = step->frame->model;
  double lo = step->from->t_s, hi = step->to->t_s, y[VS_CH_MOST];
  double before = stop->side * vs_mechanics_travel(m, step->from->x + m->dof);
  double after = stop->side * vs_mechanics_travel(m, step->to->x + m->dof);
  if (!(before < 0 && after >= 0)) return NAN;
  for (int n = 0; n < 50; n++) {
    double mid = (lo + hi) / 2;
    vs_step_groups_at(step, mid, VS_GROUP_VELOCITIES, y);
    if (stop->side * vs_mechanics_travel(m, y + vs_channel_rates(m)) < 0)
      lo = mid;
    else
      hi = mid;
  }
  vs_step_groups_at(step, hi, 0, y);
  return vs_stop_depth(stop, y[VS_CH_TRAVEL]);
}

void vs_grazing_accept(vs_grazing *g, const vs_variation *v, const vs_step *step) {
  const vs_model *m = step->frame->model;
  for (int n = 0; n < m->stops.count && step->to->t_s > step->from->t_s; n++) {
    double depth = vs_grazing_depth(step, &m->stops.item[n]);
    if (isnan(depth)) continue;
    double way =
        vs_mechanics_travel(m, v->s) + vs_parameter_rates_surface(v->parameter, n, step->to->x);
    double by = fabs(depth / way);
    if (by < g->by) *g = (vs_grazing){by, step->to->t_s};
  }
}
