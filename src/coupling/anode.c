/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupling/anode.h"

#include <math.h>
#include <string.h>

#include "deck/devices.h"
#include "drive/gate.h"

static double current_at(const vs_anode *a, const vs_knot *k) {
  return a->current->sign * k->terms[a->current->term];
}

static double voltage_at(const vs_anode *a, const vs_knot *k) {
  return a->voltage < 0 ? 0 : k->terms[a->voltage];
}

/* The current without leakage. At its zero an ideal latch lets go. */
static double forward_current(const vs_anode *a, const vs_knot *k) {
  return vs_conduction_current(&a->conduction, current_at(a, k), voltage_at(a, k));
}

/* When that current passes zero, if it goes on to fall as over the last step; INFINITY: it does not
 * fall. */
static double zero_of_current(const vs_anode *a, const vs_knot *before, const vs_knot *last) {
  double i0 = forward_current(a, before), i1 = forward_current(a, last);
  return i1 < i0 ? last->t_s + (last->t_s - before->t_s) * i1 / (i0 - i1) : INFINITY;
}

/* The step that passes the zero begins and ends this near to it. Nearer than some 1e-13 s rounding
 * would decide whether the thyristor conducts. Further away more would be chopped off the current:
 * here 20 nA where it falls by 200 A/s, which makes 20 V at an off_resistance of 1 Gohm. */
static const double NEAR_S = 1e-10;
/* A step that does not pass the zero goes this share of the way to it. The current is straight
 * enough over that not to pass the zero early. */
static const double NEARER = 0.9;

/* At the zero the current has a kink, and a kink inside a step spoils the second order of the
 * solver's rule. A step that the solver tries and rejects because of that is worse: its end stays
 * in Newton's iteration, so that a latch that has let go there lets go at the beginning of the next
 * try. So a step that would pass the zero is tried only from close by. */
double vs_anode_longest(vs_anode *a, const vs_knot *before, const vs_knot *last,
                        double max_step_s) {
  a->crosses_s = INFINITY;
  if (!a->nearing) return INFINITY;
  double now = last->t_s, left = zero_of_current(a, before, last) - now;
  if (!(left > 0 && left < 2 * max_step_s)) return INFINITY;
  if (left > NEAR_S) return fmax(NEARER * left, NEAR_S / 2);
  a->crosses_s = now + left + NEAR_S / 2;
  return left + NEAR_S;
}

void vs_anode_take(vs_anode *a, const vs_knot *last, bool conducted) {
  if (!a->current) return;
  a->crossed = a->nearing && last->t_s >= a->crosses_s;
  if (a->conduction.conducts)
    a->nearing = true;
  else if (a->crossed || (!conducted && !(forward_current(a, last) > 0)))
    a->nearing = false;
}

vs_event vs_anode_follow(vs_anode *a, const vs_knot *from, const vs_knot *to, double *event_s) {
  if (!a->current || to->t_s == from->t_s) return VS_EV_NONE;
  const vs_conduction_step step = {from->t_s,           to->t_s,
                                   current_at(a, from), current_at(a, to),
                                   voltage_at(a, from), voltage_at(a, to)};
  a->conduction.gated =
      !a->conduction.conducts && step.v1_v > 0 && !isnan(a->gate_rad) &&
      vs_gate_is_on(a->timeline, a->gate_rad, vs_gate_of_step(from->t_s, to->t_s));
  return vs_conduction_follow(&a->conduction, &step, event_s);
}

/* A voltage is known only where a thyristor has just this current for its own; the sum of two
 * thyristors' currents belongs to neither. */
void vs_anode_begin(vs_anode *a, const vs_deck *deck, const vs_timeline *timeline) {
  int current, voltage;
  double factor = 0;
  *a = (vs_anode){.timeline = timeline, .gate_rad = NAN, .voltage = -1, .crosses_s = INFINITY};
  vs_conduction_begin(&a->conduction);
  for (size_t k = 0; k < deck->n_probes; k++)
    if (!strcmp(deck->probes[k].name, "i_thyristor")) a->current = &deck->probes[k];
  for (size_t k = 0; a->current && k < deck->n_devices; k++)
    if (deck->devices[k].kind->switches &&
        vs_formula_is_term(&deck->devices[k].current, &current, &factor) &&
        current == a->current->term &&
        vs_formula_is_term(&deck->devices[k].voltage, &voltage, &factor)) {
      a->voltage = voltage;
      a->gate_rad = deck->devices[k].gate_rad;
    }
}
