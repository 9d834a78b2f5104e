/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit_extremes.h"

#include <math.h>

void vs_orbit_extremes_begin(vs_orbit_extremes *t, const vs_model *model) {
  *t = (vs_orbit_extremes){.least = {.channel = VS_CH_TRAVEL, .sense = -1},
                           .largest = {.channel = VS_CH_TRAVEL, .sense = 1}};
  for (int i = 0; i < 2 * model->dof; i++)
    t->of[i] = (vs_extreme){.channel = VS_CH_Q + i / 2, .sense = i % 2 ? 1 : -1};
  for (int k = 0; k < VS_MOST_STOPS; k++) t->nearest_m[k] = INFINITY;
}

/* The step ends where a stop is met: the one whose surface is there. */
static void meet_stop(vs_orbit_extremes *t, const vs_step *step) {
  const vs_model *m = step->frame->model;
  const vs_stops *stops = &m->stops;
  double g = vs_mechanics_travel(m, step->to->x), nearest = INFINITY;
  int found = 0;
  for (int k = 0; k < stops->count; k++) {
    double off = fabs(vs_stop_depth(&stops->item[k], g));
    if (off >= nearest) continue;
    nearest = off;
    found = k;
  }
  t->met[found]++;
  t->speed_m_s = fmax(t->speed_m_s, fabs(vs_mechanics_travel(m, step->to->x + m->dof)));
}

void vs_orbit_extremes_accept(vs_orbit_extremes *t, const vs_step *step) {
  const vs_model *m = step->frame->model;
  vs_value turn;
  t->fired += step->event[0] == VS_EV_FIRES;
  if (step->event[0] == VS_EV_MEETS_STOP) meet_stop(t, step);
  if (!(step->to->t_s > step->from->t_s)) return;
  vs_extreme_follow(&t->least, step, false);
  vs_extreme_follow(&t->largest, step, false);
  for (int i = 0; i < 2 * m->dof; i++) vs_extreme_follow(&t->of[i], step, false);
  if (!m->stops.count || !vs_extreme_turn_of_travel(step, &turn)) return;
  for (int k = 0; k < m->stops.count; k++)
    t->nearest_m[k] = fmin(t->nearest_m[k], fabs(vs_stop_depth(&m->stops.item[k], turn.value)));
}

int vs_orbit_extremes_contacts(const vs_orbit_extremes *t) {
  int contacts = 0;
  for (int k = 0; k < VS_MOST_STOPS; k++) contacts += t->met[k];
  return contacts;
}
