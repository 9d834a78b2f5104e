/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/law_drift.h"

#include <math.h>
#include <string.h>

/* The drift counts twice: it is known from a few cycles alone, in which a beat of the machine with
 * the mains may hide some of it. Two is a choice, not a proof. */
static const double SAFETY = 2;

/* Relative to its misfit, so much of a signal's drift is only made by where the knots lie: at
 * either end of a cycle one of the 200 may count or not, and in a harmonic it counts twice. */
static const double SAMPLING = 0.02;

/* Relative to run.tolerance: how much an extreme of a signal may be off besides, as it is read from
 * other knots than the solver's would be. A choice that holds over the scenes of test_leaving. */
static const double EXTREMES = 0.2;

/* ---- the shares of a signal's error ---- */

/* How much the error at knot k in view counts for each share: the sum over all knots is the share.
 */
static void weights_of_shares(const vs_record *r, size_t k, double weight[VS_LAW_DRIFT_SHARES]) {
  size_t last = r->n_seen - 1;
  double span_s = r->seen[last]->knot.t_s - r->seen[0]->knot.t_s;
  double h = r->seen[k < last ? k + 1 : last]->knot.t_s - r->seen[k ? k - 1 : 0]->knot.t_s;
  double angle = r->setup->timeline.omega_rad_s * r->seen[k]->knot.t_s, w = h / 2 / span_s;
  weight[0] = w;
  for (int n = 1; n <= VS_HARMONICS; n++) {
    weight[2 * n - 1] = 2 * w * cos(n * angle);
    weight[2 * n] = 2 * w * sin(n * angle);
  }
}

static void add_shares(const double weight[VS_LAW_DRIFT_SHARES], double error,
                       double share[VS_LAW_DRIFT_SHARES]) {
  for (int n = 0; n < VS_LAW_DRIFT_SHARES; n++) share[n] += weight[n] * error;
}

/* The largest value that the difference of two errors with these shares can have. */
static double distance_of_shares(const double a[VS_LAW_DRIFT_SHARES],
                                 const double b[VS_LAW_DRIFT_SHARES]) {
  double sum = fabs(a[0] - b[0]);
  for (int n = 1; n < VS_LAW_DRIFT_SHARES; n += 2) sum += hypot(a[n] - b[n], a[n + 1] - b[n + 1]);
  return sum;
}

void vs_law_drift_shares_of(const vs_record *r, const vs_oneport *port, vs_law_drift_shares *all) {
  double signal[VS_SIGNALS], weight[VS_LAW_DRIFT_SHARES], y[VS_ONEPORT_STATES];
  size_t count = vs_record_signals(r);
  memset(all, 0, sizeof *all);
  for (size_t k = 0; k < r->n_seen; k++) {
    const vs_observation *seen = r->seen[k];
    vs_oneport_state(&seen->knot, y);
    vs_coil_state c = vs_oneport_coil(port, seen->knot.t_s, y);
    vs_responses_at(vs_oneport_responses(port), seen->knot.t_s, &c, signal);
    weights_of_shares(r, k, weight);
    for (size_t n = 0; n < count; n++)
      add_shares(weight, signal[n] - vs_responses_seen(r->frame, seen, n), all->of[n]);
  }
}

/* ---- the drift from an earlier cycle ---- */

/* How much more a mode takes from the cycle in view if the flux linkage is larger by a sine of the
 * mains' frequency, of any phase, and by a mean. The force is then larger in proportion to the
 * product of that and of the flux linkage; the return value is the size of that product's integral,
 * in the mode's own phase. */
static double force_swing_of_mode(const vs_record *r, const vs_mode *m, double sine, double mean) {
  double sum[3][2] = {{0}}, w = r->setup->timeline.omega_rad_s, t0 = r->seen[0]->knot.t_s;
  for (size_t k = 1; k < r->n_seen; k++) {
    const vs_knot *a = &r->seen[k - 1]->knot, *b = &r->seen[k]->knot;
    double t = (a->t_s + b->t_s) / 2, angle = m->im_rad_s * (t - t0);
    double flux = (a->flux_wb + b->flux_wb) / 2 * (b->t_s - a->t_s);
    const double more[3] = {flux * cos(w * t), flux * sin(w * t), flux};
    for (int n = 0; n < 3; n++) {
      sum[n][0] += more[n] * cos(angle);
      sum[n][1] += more[n] * sin(angle);
    }
  }
  return sine * hypot(hypot(sum[0][0], sum[0][1]), hypot(sum[1][0], sum[1][1])) +
         mean * hypot(sum[2][0], sum[2][1]);
}

/* The modes' shares in what one newton of the coil's force changes of the state's rate. */
static void unit_force(const vs_record *r, const vs_modal *modal, double share[VS_MOST_STATES]) {
  const vs_model *m = &r->setup->model;
  double unit[VS_MOST_STATES] = {0};
  memcpy(unit + m->dof, m->mf, (size_t)m->dof * sizeof *unit);
  vs_modal_shares(modal, unit, share);
}

/* The drift of the coil and of the machine. A current that is larger makes the force larger in
 * proportion to the flux linkage that the coil has. */
static void drift_of_machine(const vs_record *r, const vs_oneport *port, const vs_modal *modal,
                             int cycles, vs_law_drift *w) {
  const vs_model *m = &r->setup->model;
  double flux = 0, sine, mean;
  vs_oneport_drifted(port, r->seen, r->n_seen, &sine, &mean);
  const double to_flux =
      2 * m->coil.a_hm / m->coil.gap_rest_m / cycles; /* Wb/A at the gap at rest, for one cycle */
  for (size_t k = 0; k < r->n_seen; k++) flux = fmax(flux, fabs(r->seen[k]->knot.flux_wb));
  w->current_a = (sine + mean) / cycles;
  w->force_n = flux * to_flux * (sine + mean) / (2 * m->coil.a_hm);
  unit_force(r, modal, w->mode);
  for (int k = 0; k < 2 * m->dof; k++)
    w->mode[k] *=
        to_flux / (2 * m->coil.a_hm) * force_swing_of_mode(r, &modal->mode[k], sine, mean);
}

bool vs_law_drift_find(vs_record *r, const vs_oneport *port, const vs_modal *modal,
                       const vs_law_drift_shares *fitted, int ago, vs_law_drift *w) {
  vs_law_drift_shares earlier;
  if (!vs_record_view(r, 1, ago)) return false;
  drift_of_machine(r, port, modal, ago, w);
  vs_law_drift_shares_of(r, port, &earlier);
  for (size_t n = 0; n < vs_record_signals(r); n++)
    w->signal[n] = distance_of_shares(earlier.of[n], fitted->of[n]) / ago;
  return true;
}

/* ---- extrapolated ---- */

double vs_law_drift_electric(const vs_record *r, const vs_law_drift *w, double cycles) {
  return SAFETY * cycles * fmax(w->force_n / r->peak_force_n, w->current_a / r->peak_a);
}

/* A beat of the machine with the mains changes a signal by so much from one cycle to the next; this
 * is how many such changes lie between its two ends. A mode turns by s T in a cycle, which makes it
 * 2/|1 - exp(s T)|, of the slowest beat. */
static double beat_cycles(const vs_modal *modal, double period) {
  double most = 0;
  for (size_t k = 0; k < modal->share->size; k++) {
    double size = exp(modal->mode[k].re_1_s * period), angle = modal->mode[k].im_rad_s * period;
    most = fmax(most, 2 / hypot(1 - size * cos(angle), size * sin(angle)));
  }
  return most;
}

/* What the circuit remembers is shown to nobody: only its drift counts, less what sampling makes of
 * it. The error of a signal that hangs on the coil grows as long as a beat of the machine with the
 * mains and no longer, as the source's own drift is known better, by vs_law_drift_electric. */
double vs_law_drift_signals(const vs_record *r, const vs_oneport *port, const vs_modal *modal,
                            const double misfit_now[VS_SIGNALS], const vs_law_drift *w,
                            double cycles) {
  double worst = 0, beat = beat_cycles(modal, r->setup->timeline.period_s);
  for (size_t n = 0; n < vs_record_signals(r); n++) {
    if (vs_record_is_control(r, n)) continue;
    bool shown = n <= vs_record_terms(r);
    double times =
        vs_responses_hangs(vs_oneport_responses(port), n) ? fmin(cycles, beat) : SAFETY * cycles;
    double each = shown ? w->signal[n] : fmax(w->signal[n] - SAMPLING * misfit_now[n], 0);
    double error = (shown ? misfit_now[n] : 0) + times * each, allowed = vs_record_allowed(r, n);
    if (!shown && !(error <= allowed)) return INFINITY;
    if (shown) worst = fmax(worst, error / (allowed / vs_record_share(r)));
  }
  return worst + EXTREMES * r->setup->run.tolerance;
}
