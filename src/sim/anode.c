/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/anode.h"

#include <math.h>
#include <string.h>

#include "circuit/devices.h"

/* A step for an extinction ends a thousandth of the largest step behind it: at the zero itself
 * rounding would decide whether the thyristor conducts, and Newton's iteration find no end. */
static const double LATE = 1e-3;

static double current_at(const vs_anode *a, const vs_knot *k) {
  return a->current->sign * k->terms[a->current->term];
}

static double voltage_at(const vs_anode *a, const vs_knot *k) {
  return a->voltage < 0 ? 0 : k->terms[a->voltage];
}

/* When the current, falling as from knot `before` to knot `from`, passes zero; INFINITY: it does
 * not fall. */
static double zero_of_current(const vs_anode *a, const vs_knot *before, const vs_knot *from) {
  double i0 = current_at(a, before), i1 = current_at(a, from);
  return i1 < i0 ? from->t_s + (from->t_s - before->t_s) * i1 / (i0 - i1) : INFINITY;
}

/* A step that ends where the anode current passes zero keeps the second order of the solver's rule,
 * which a kink inside a step would spoil. One that was told stays an end, and nearly the same is
 * not told again: two a picosecond apart have ngspice give up. */
double vs_anode_extinction(vs_anode *a, const vs_knot *before, const vs_knot *last, double step_s,
                           double max_step_s) {
  if (!a->conduction.conducts) return INFINITY;
  double zero = zero_of_current(a, before, last), late = LATE * max_step_s;
  double reach = fmin(2 * step_s, max_step_s);
  if (!(zero > last->t_s && zero < last->t_s + reach)) return INFINITY;
  if (fabs(zero + late - a->expected_s) > late / 2) a->expected_s = zero + late;
  return a->expected_s;
}

vs_event vs_anode_follow(vs_anode *a, const vs_knot *from, const vs_knot *to, double *event_s) {
  if (!a->current || to->t_s == from->t_s) return VS_EV_NONE;
  const vs_conduction_step step = {from->t_s,           to->t_s,
                                   current_at(a, from), current_at(a, to),
                                   voltage_at(a, from), voltage_at(a, to)};
  return vs_conduction_follow(&a->conduction, &step, event_s);
}

/* A current that is the sum of two thyristors' is of neither. */
void vs_anode_begin(vs_anode *a, const vs_deck *deck) {
  int current, voltage;
  double factor = 0;
  *a = (vs_anode){.voltage = -1};
  vs_conduction_begin(&a->conduction);
  for (size_t k = 0; k < deck->n_probes; k++)
    if (!strcmp(deck->probes[k].name, "i_thyristor")) a->current = &deck->probes[k];
  for (size_t k = 0; a->current && k < deck->n_devices; k++)
    if (deck->devices[k].kind->switches &&
        vs_formula_is_term(&deck->devices[k].current, &current, &factor) &&
        current == a->current->term &&
        vs_formula_is_term(&deck->devices[k].voltage, &voltage, &factor))
      a->voltage = voltage;
}
