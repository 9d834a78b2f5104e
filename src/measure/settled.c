/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/settled.h"

#include <math.h>

/* True if the value is the least (sense -1) or the largest (+1), whatever the rest brings. */
static bool is_beyond(const vs_value *v, int sense, const vs_range *range) {
  return v->known && sense * v->value > sense * range->middle + range->way;
}

/* True if no extremum of the rest makes a ripple of the first motion peak. */
static bool is_a_peak(const vs_measures *m, const vs_rest *rest) {
  double most = fabs(rest->travel.middle) + rest->travel.way;
  return m->first.known && fabs(m->first.value) > vs_measures_ripple * most;
}

/* What follows from the current, the firing and the energy drawn does not change any more; what is
 * left over by a balance is still to be found. */
void vs_settled_find(const vs_measures *m, const vs_rest *rest, vs_measure_set *s) {
  const vs_model *model = m->frame->model;
  const bool peak = is_a_peak(m, rest), swung = rest->from_s > vs_measures_swing_ends_s;
  vs_value v[VS_MEASURES];
  vs_measures_finish(m, v);
  for (int k = 0; k < VS_MEASURES; k++) s->has[k] = true;
  s->has[VS_M_GAP_FIRST] = peak;
  s->has[VS_M_GAP_SECOND] = peak && m->second.known;
  s->has[VS_M_GAP_MIN] = is_beyond(&v[VS_M_GAP_MIN], -1, &rest->travel);
  s->has[VS_M_GAP_MAX] = is_beyond(&v[VS_M_GAP_MAX], 1, &rest->travel);
  s->has[VS_M_STROKE] = s->has[VS_M_GAP_MIN] && s->has[VS_M_GAP_MAX];
  s->has[VS_M_F_RESONANCE] = s->has[VS_M_TAU_GAP] = swung;
  s->has[VS_M_ENERGY_RESIDUAL] = false;
  for (int i = 0; i < model->dof; i++) {
    const vs_value *of = &v[VS_M_OF_COORDINATE(i, 0)];
    const vs_range rate2 = {0, rest->rate2[i]};
    s->has[VS_M_OF_COORDINATE(i, VS_LEAST)] = is_beyond(&of[VS_LEAST], -1, &rest->q[i]);
    s->has[VS_M_OF_COORDINATE(i, VS_LARGEST)] = is_beyond(&of[VS_LARGEST], 1, &rest->q[i]);
    s->has[VS_M_OF_COORDINATE(i, VS_PEAK)] = is_beyond(&of[VS_PEAK], 1, &rate2);
  }
}

bool vs_settled_all(const vs_measure_set *s, const vs_measure_set *wanted) {
  for (int k = 0; k < VS_MEASURES; k++)
    if (wanted->has[k] && !s->has[k]) return false;
  return true;
}
