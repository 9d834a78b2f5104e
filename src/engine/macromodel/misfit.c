/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/misfit.h"

#include <math.h>

#include "plant/coil.h"

const double vs_misfit_safety = 5;

double vs_misfit_electric(const vs_record *r, const vs_misfit *wrong) {
  return vs_misfit_safety * fmax(wrong->force_n / r->peak_force_n, wrong->current_a / r->peak_a);
}

static void compare_modes(const vs_modal *modal, const double y[VS_ONEPORT_STATES],
                          const vs_knot *seen, vs_misfit *wrong) {
  double error[VS_MOST_STATES], share[VS_MOST_STATES];
  int states = (int)modal->share->size;
  for (int n = 0; n < states; n++) error[n] = y[VS_ONEPORT_Q + n] - seen->x[n];
  vs_modal_shares(modal, error, share);
  for (int n = 0; n < states; n++) wrong->mode[n] = fmax(wrong->mode[n], share[n]);
}

bool vs_misfit_find(const vs_record *r, vs_oneport *port, const vs_modal *modal, double most,
                    vs_misfit *wrong) {
  const vs_model *m = &r->setup->model;
  double y[VS_ONEPORT_STATES];
  *wrong = (vs_misfit){0};
  vs_oneport_state(&r->seen[0]->knot, y);
  for (size_t k = 0; k < r->n_seen; k++) {
    const vs_knot *seen = &r->seen[k]->knot;
    if (k && !vs_oneport_advance(port, r->seen[k - 1]->knot.t_s, seen->t_s, y)) return false;
    const vs_coil_state c = wrong->coil[k] = vs_oneport_coil(port, seen->t_s, y);
    double z = vs_mechanics_gap(m, seen->x);
    double force =
        vs_coil_force(&m->coil, c.flux_wb, z) - vs_coil_force(&m->coil, seen->flux_wb, z);
    wrong->force_n = fmax(wrong->force_n, fabs(force));
    wrong->current_a = fmax(wrong->current_a, fabs(c.i_a - vs_oneport_knot_current(m, seen)));
    if (!(vs_misfit_electric(r, wrong) <= most)) return false;
    compare_modes(modal, y, seen, wrong);
  }
  return true;
}

void vs_misfit_find_signals(const vs_record *r, const vs_oneport *port, vs_misfit *wrong) {
  double signal[VS_SIGNALS];
  for (size_t k = 0; k < r->n_seen; k++) {
    const vs_seen *seen = r->seen[k];
    vs_responses_at(vs_oneport_responses(port), seen->knot.t_s, &wrong->coil[k], signal);
    for (size_t n = 0; n < vs_record_signals(r); n++)
      wrong->signal[n] =
          fmax(wrong->signal[n], fabs(signal[n] - vs_responses_seen(r->frame, seen, n)));
  }
}
