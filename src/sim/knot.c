/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/knot.h"

#include <stddef.h>
#include <string.h>

#include "machine/actuator.h"

_Static_assert(offsetof(vs_knot, terms) + sizeof(double[VS_DECK_MOST]) == sizeof(vs_knot),
               "vs_knot_copy leaves out what stands behind the deck's terms: nothing else may");

void vs_knot_copy(const vs_frame *frame, const vs_knot *from, vs_knot *to) {
  size_t terms = frame->deck ? frame->deck->n_terms : 0;
  memcpy(to, from, offsetof(vs_knot, terms) + terms * sizeof *from->terms);
}

void vs_knot_complete(const vs_frame *frame, vs_knot *k, bool touching) {
  const vs_model *m = frame->model;
  double va[VS_STATES], force = vs_actuator_force(m, k->flux_wb), rate;
  vs_mechanics_accelerations(m, k->x, force + (touching ? vs_mechanics_stop_force(m, k->x) : 0),
                             k->a);
  memcpy(va, k->x + VS_DOF, sizeof(double[VS_DOF]));
  memcpy(va + VS_DOF, k->a, sizeof(double[VS_DOF]));
  rate = vs_actuator_force_rate(m, k->flux_wb, k->flux_rate_v);
  vs_mechanics_jerks(m, va, rate + (touching ? vs_mechanics_stop_rate(m, k->x, k->a) : 0), k->j);
}

void vs_knot_hold(const vs_frame *frame, vs_knot *k) {
  const vs_model *m = frame->model;
  double va[VS_STATES];
  vs_mechanics_accelerations(m, k->x, vs_actuator_force(m, k->flux_wb), k->a);
  vs_mechanics_hold_p(m, k->a);
  memcpy(va, k->x + VS_DOF, sizeof(double[VS_DOF]));
  memcpy(va + VS_DOF, k->a, sizeof(double[VS_DOF]));
  vs_mechanics_jerks(m, va, 0, k->j); /* what acts along p is held */
  vs_mechanics_hold_p(m, k->j);
}
