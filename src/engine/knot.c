/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/knot.h"

#include <stddef.h>
#include <string.h>

#include "plant/coil.h"

static inline void copy_coordinates(const vs_knot *from, int dof, vs_knot *to) {
  size_t one = (size_t)dof * sizeof *to->x;
  memcpy(to->x, from->x, 2 * one);
  memcpy(to->a, from->a, one);
  memcpy(to->j, from->j, one);
}

void vs_knot_copy(const vs_frame *frame, const vs_knot *from, vs_knot *to) {
  if (frame->model->dof == VS_ROWS)
    copy_coordinates(from, VS_ROWS, to);
  else
    copy_coordinates(from, frame->model->dof, to);
  to->t_s = from->t_s;
  memcpy(&to->flux_wb, &from->flux_wb, offsetof(vs_knot, terms) - offsetof(vs_knot, flux_wb));
  if (frame->deck) memcpy(to->terms, from->terms, frame->deck->n_terms * sizeof *from->terms);
}

void vs_knot_complete(const vs_frame *frame, vs_knot *k, unsigned touched) {
  const vs_model *m = frame->model;
  const double *q = k->x, *v = k->x + m->dof;
  double g = vs_mechanics_travel(m, q), g1 = vs_mechanics_travel(m, v);
  vs_law_rates law =
      vs_coil_rates(&m->coil, k->flux_wb, k->flux_rate_v, vs_coil_gap(&m->coil, g), g1);
  double stop = touched ? vs_stops_force(&m->stops, touched, g, g1) : 0;
  vs_mechanics_accelerations(m, q, v, law.force_n + stop, k->a);
  if (touched) stop = vs_stops_force_rate(&m->stops, touched, g, g1, vs_mechanics_travel(m, k->a));
  vs_mechanics_jerks(m, v, k->a, law.force_rate_n_s + stop, k->j);
}

void vs_knot_hold(const vs_frame *frame, vs_knot *k) {
  const vs_model *m = frame->model;
  const double *q = k->x, *v = k->x + m->dof;
  double force = vs_coil_force(&m->coil, k->flux_wb, vs_mechanics_gap(m, q));
  vs_mechanics_accelerations(m, q, v, force, k->a);
  vs_mechanics_hold(m, k->a);
  vs_mechanics_jerks(m, v, k->a, 0, k->j); /* what acts along the gap is held */
  vs_mechanics_hold(m, k->j);
}
