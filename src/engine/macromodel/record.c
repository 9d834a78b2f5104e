/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plant/coil.h"

/* At most so many knots are kept of a cycle: that leaves 66 for a period of the third harmonic, the
 * highest that is fitted. The ring then has room for five cycles. */
enum { PER_CYCLE = 200, MOST_KEPT = 1024 };
_Static_assert(MOST_KEPT >= (VS_CYCLES_KEPT + 1) * PER_CYCLE, "the ring has room for its cycles");
_Static_assert(VS_MOST_SEEN >= 2 * PER_CYCLE, "a view has room for the two cycles of a fit");

/* A view may begin late by this share of a cycle, which is four of the knots kept. */
static const double LATE = 0.02;

/* A signal may be wrong by three times run.tolerance, relative to its peak. The deck's signals run
 * straight from knot to knot, which alone takes one of the three (oneport_macromodel.c, longest()).
 */
static const double SIGNAL_SHARE = 3;

/* In any case a signal may be wrong by run.tolerance of 1 V or 0.1 A: that is the size below which
 * the solver's own tolerances end. For what the circuit remembers it is a thousandth of that, as a
 * small voltage inside a component may decide what a large one does. */
static const double LEAST_V = 1, LEAST_A = 0.1, LEAST_HIDDEN = 1e-3;

size_t vs_record_terms(const vs_record *r) {
  return r->frame->deck->n_terms;
}

size_t vs_record_signals(const vs_record *r) {
  return vs_record_terms(r) + 1 + r->memories->count;
}

static bool is_current(const vs_record *r, size_t n) {
  size_t terms = vs_record_terms(r);
  if (n < terms) return *r->frame->deck->terms[n].plus == 'i';
  return n == terms || *r->memories->item[n - terms - 1].plus == 'i';
}

bool vs_record_is_control(const vs_record *r, size_t n) {
  size_t terms = vs_record_terms(r);
  return n > terms && r->memories->item[n - terms - 1].threshold != VS_THRESHOLD_NONE;
}

double vs_record_share(const vs_record *r) {
  return SIGNAL_SHARE * r->setup->run.tolerance;
}

double vs_record_allowed(const vs_record *r, size_t n) {
  double least = is_current(r, n) ? LEAST_A : LEAST_V;
  if (n > vs_record_terms(r)) least *= LEAST_HIDDEN;
  return r->setup->run.tolerance * fmax(SIGNAL_SHARE * r->peak_signal[n], least);
}

static vs_observation *kept_at(const vs_record *r, size_t k) {
  return &r->kept[(r->first + k) % MOST_KEPT];
}

static void take_peaks(vs_record *r, const vs_knot *k) {
  const vs_model *m = &r->setup->model;
  size_t terms = vs_record_terms(r);
  for (int n = 0; n < m->dof; n++) r->peak_x[n] = fmax(r->peak_x[n], fabs(k->x[n]));
  r->peak_force_n =
      fmax(r->peak_force_n, vs_coil_force(&m->coil, k->flux_wb, vs_mechanics_gap(m, k->x)));
  r->peak_a = fmax(r->peak_a, fabs(vs_oneport_knot_current(m, k)));
  for (size_t n = 0; n < terms; n++) r->peak_signal[n] = fmax(r->peak_signal[n], fabs(k->terms[n]));
  r->peak_signal[terms] = fmax(r->peak_signal[terms], fabs(k->i_mains_a));
}

/* The peak of what the circuit remembers is half of the range it went over, as there may be a bias.
 */
static void take_memory(vs_record *r, const double *memory) {
  for (size_t n = 0; n < r->memories->count; n++) {
    r->least[n] = fmin(r->least[n], memory[n]);
    r->most[n] = fmax(r->most[n], memory[n]);
    r->peak_signal[vs_record_terms(r) + 1 + n] = (r->most[n] - r->least[n]) / 2;
    r->blind = r->blind || !isfinite(memory[n]);
  }
}

/* Adds the step to k to the integrals of i, by values and slopes at both ends, and of
 * v = R i + dlambda/dt. */
static void integrate_port(vs_record *r, const vs_knot *k) {
  const vs_model *m = &r->setup->model;
  const vs_knot *from = &r->last.knot;
  double h = k->t_s - from->t_s,
         charge = h / 2 * (vs_oneport_knot_current(m, from) + vs_oneport_knot_current(m, k)) -
                  h * h / 12 *
                      (vs_oneport_knot_current_rate(m, k) - vs_oneport_knot_current_rate(m, from));
  r->last.charge_c += charge;
  r->last.flux_in_wb += m->coil.resistance_ohm * charge + k->flux_wb - from->flux_wb;
}

void vs_record_clear(vs_record *r) {
  r->any = false;
  r->count = 0;
}

/* Puts the last knot into the ring, and drops what is older than four cycles. */
static void keep_last(vs_record *r, const double *memory) {
  double period = r->setup->timeline.period_s, now = r->last.knot.t_s;
  if (r->count && now < kept_at(r, r->count - 1)->knot.t_s + period / PER_CYCLE) return;
  while (r->count &&
         (r->count == MOST_KEPT || kept_at(r, 0)->knot.t_s < now - VS_CYCLES_KEPT * period)) {
    r->first = (r->first + 1) % MOST_KEPT;
    r->count--;
  }
  vs_observation *seen = kept_at(r, r->count++);
  double *own = r->memory + (size_t)(seen - r->kept) * VS_CIRCUIT_STATES_MOST;
  memcpy(own, memory, r->memories->count * sizeof *memory);
  *seen = r->last;
  seen->memory = own;
}

void vs_record_take(vs_record *r, const vs_knot *k, const double *memory, bool keep) {
  if (r->any) integrate_port(r, k);
  vs_step_copy_knot(r->frame, k, &r->last.knot);
  r->any = true;
  take_peaks(r, k);
  take_memory(r, memory);
  if (keep)
    keep_last(r, memory);
  else
    vs_record_clear(r);
}

bool vs_record_two_cycles(const vs_record *r) {
  double from_s = r->last.knot.t_s - (2 - LATE) * r->setup->timeline.period_s;
  return r->count && kept_at(r, 0)->knot.t_s <= from_s;
}

bool vs_record_view(vs_record *r, int some, int ago) {
  double period = r->setup->timeline.period_s, end = r->last.knot.t_s - ago * period,
         from = end - some * period;
  size_t k = 0;
  r->n_seen = 0;
  while (k < r->count && kept_at(r, k)->knot.t_s < from) k++;
  if (k == r->count || kept_at(r, k)->knot.t_s > from + LATE * period) return false;
  for (; k < r->count && r->n_seen < VS_MOST_SEEN && kept_at(r, k)->knot.t_s <= end; k++)
    r->seen[r->n_seen++] = kept_at(r, k);
  return r->n_seen >= VS_LEAST_SEEN;
}

void vs_record_begin(vs_record *r, const vs_setup *setup, const vs_frame *frame,
                     const vs_circuit_states *memories) {
  *r = (vs_record){.setup = setup, .frame = frame, .memories = memories};
  r->kept = vs_alloc(MOST_KEPT, sizeof *r->kept);
  r->memory = vs_alloc(MOST_KEPT * VS_CIRCUIT_STATES_MOST, sizeof *r->memory);
  for (size_t n = 0; n < VS_CIRCUIT_STATES_MOST; n++)
    r->least[n] = INFINITY, r->most[n] = -INFINITY;
}

void vs_record_end(vs_record *r) {
  free(r->kept);
  free(r->memory);
}
