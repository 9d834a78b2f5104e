/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/anode.h"

#include <math.h>
#include <string.h>

#include "engine/events.h"
#include "engine/gate.h"
#include "netlist/cards.h"
#include "netlist/kinds.h"

static double current_at(const vs_anode_current *m, const vs_knot *k) {
  return m->way * vs_formula_prepared_value(&m->i, k->terms);
}

static double voltage_at(const vs_anode_current *m, const vs_knot *k) {
  return m->device ? m->way * vs_formula_prepared_value(&m->v, k->terms) : 0;
}

/* The current without leakage. At its zero an ideal latch lets go. */
static double forward_current(const vs_anode_current *m) {
  return vs_conduction_current(&m->conduction, m->last_a, m->last_v);
}

/* When that current passes zero, if it goes on to fall as over the last step; INFINITY: it does not
 * fall. */
static double zero_of_current(const vs_anode *a, const vs_anode_current *m) {
  double i0 = vs_conduction_current(&m->conduction, m->before_a, m->before_v);
  double i1 = forward_current(m);
  return i1 < i0 ? a->last_s + (a->last_s - a->before_s) * i1 / (i0 - i1) : INFINITY;
}

/* The step that passes the zero begins and ends this near to it. Nearer than some 1e-13 s rounding
 * would decide whether the thyristor conducts. Further away more would be chopped off the current:
 * here 20 nA where it falls by 200 A/s, which makes 20 V at an off_resistance of 1 Gohm.
 *
 * The current of a thyristor that recovers goes on through zero, so nothing is chopped off. In
 * steps of less than some 1e-10 s the voltage across the source's inductance is the rounding of its
 * current. Behind that alone, without a snubber, Newton's iteration then had no end, and 14 of some
 * 350 scenes at 1e-3 and 1e-4 climbed the ladder, one to its end. From 1e-9 s on none did. */
static const double NEAR_S = 1e-10, NEAR_RECOVERING_S = 1e-9;
/* A step that does not pass the zero goes this share of the way to it. The current is straight
 * enough over that not to pass the zero early. */
static const double NEARER = 0.9;

/* At the zero the current has a kink, and a kink inside a step spoils the second order of the
 * solver's rule. A step that the solver tries and rejects because of that is worse: its end stays
 * in Newton's iteration, so that a latch that has let go there lets go at the beginning of the next
 * try. So a step that would pass the zero is tried only from close by. */
static double longest(const vs_anode *a, vs_anode_current *m, double max_step_s) {
  m->crosses_s = INFINITY;
  if (!m->nearing) return INFINITY;
  double now = a->last_s, left = zero_of_current(a, m) - now;
  if (!(left > 0 && left < 2 * max_step_s)) return INFINITY;
  if (left > m->near_s) return fmax(NEARER * left, m->near_s / 2);
  m->crosses_s = now + left + m->near_s / 2;
  return left + m->near_s;
}

static bool is_gated(const vs_device *d, const vs_timeline *timeline, double t_s) {
  for (size_t g = 0; g < d->gates.count; g++)
    if (vs_gate_is_on(timeline, d->gates.rad[g], t_s)) return true;
  return false;
}

/* True within a gate pulse of the device; where gates are driven with sub-pulses, within one. */
static bool is_driven(const vs_anode *a, const vs_device *d, double t_s) {
  for (size_t g = 0; g < d->gates.count; g++)
    if (vs_gate_is_on(a->timeline, d->gates.rad[g], t_s) &&
        (!a->bursts || vs_gate_burst(a->timeline, d->gates.rad[g], t_s)))
      return true;
  return false;
}

/* A gate's edge counts as reached from here on, s: rounding. */
static const double REACHED_S = 1e-12;

/* A gate drive counts as giving its current while that is above this share of its largest so far.
 * The current dies away behind a pulse, or before its end where a transformer's core saturates. */
static const double GIVES = 0.5;

/* True while the thyristor's gate pulse is there and all gate drives give their current. Where the
 * deck declares no gate drive, the pulse alone tells. */
static bool is_fed(const vs_anode *a, const vs_device *d) {
  for (size_t k = 0; k < a->drives; k++)
    if (!(a->drive[k].last_a > GIVES * a->drive[k].most_a)) return false;
  return is_driven(a, d, a->last_s + REACHED_S);
}

/* A thyristor of transistors takes up to FIRES_S from its gate's edge to fire, in which the
 * solver's first steps were up to 0.3 us. The firing was 30 ns late by that, which is 0.1 % of a
 * conduction that ends 25 us later without having latched: the force was off by 23 tolerances at
 * 1e-4. With steps of FIRING_S, or half or a quarter of that, by 3. At finer tolerances the step
 * goes with their root.
 *
 * Then the snubber's capacitor discharges through it. A current that rises by more than RISES_A_S
 * is not the coil's, which rises by some 1e3 A/s. Its steepest 0.1 us is di/dt: with the solver's
 * own steps that was off by up to 4 % at a tolerance of 1e-3, and by 1 % at 1e-4, without an order
 * in them; with steps of RISING_S by 0.2 %. */
static const double FIRES_S = 2e-6, FIRING_S = 2e-8, RISING_S = 1e-8, RISES_A_S = 1e5,
                    FIRING_AT = 1e-4;

static double longest_firing(const vs_anode *a, const vs_anode_current *m, const vs_swing *swing) {
  const bool rises = m->last_a - m->before_a > RISES_A_S * (a->last_s - a->before_s);
  if (!(m->last_v > 0) || !m->device || (m->conduction.conducts && !rises)) return INFINITY;
  bool begins = is_driven(a, m->device, a->last_s + REACHED_S) &&
                !is_driven(a, m->device, a->last_s - FIRES_S);
  const double longest_s = rises ? RISING_S : FIRING_S;
  return begins ? longest_s * sqrt(fmin(1, swing->tolerance / FIRING_AT)) : INFINITY;
}

/* A latch fires as its gate drive's voltage has risen, 0.2 us behind the edge. Where the solver's
 * first step goes beyond that and is rejected, the latch has fired at the beginning of the next try
 * (longest), early by up to that step. Times the mains' peak that is an error of the flux linkage,
 * for which there is the share of a swing's: the instant was off by 0.24 us at 1e-6, and a
 * conduction of 31 us by 16 tolerances at 1e-4. The share is of what the mains might bring, and a
 * snubber may end a conduction long before: with all of it conductions of 35 us were off by up to
 * 3 tolerances, with LATCHES of it by 1. A firing takes some ten steps more. */
static const double LATCHES = 0.25;

static double longest_latching(const vs_anode *a, const vs_anode_current *m,
                               const vs_swing *swing) {
  if (!a->delays || m->conduction.conducts || !isfinite(longest_firing(a, m, swing)))
    return INFINITY;
  return LATCHES * swing->share * swing->flux_wb / swing->peak_v;
}

/* Where the mains jump, as at the edge of a sag, the current of a small conduction may be gone
 * within a microsecond, at a slope of which the steps before know nothing. The solver's first step
 * behind the edge then passes the zero, is rejected, and the latch has let go at its beginning: it
 * was chopped off, a microsecond early, and the force was off by 10 tolerances at 1e-4. After a
 * first step of NEAR_S the slope is known. Steps double from there on, so that it costs fifteen. */
static double longest_behind_an_edge(const vs_anode *a, const vs_anode_current *m) {
  if (!m->conduction.conducts || m->t_q_s > 0) return INFINITY;
  double edge_s = vs_events_edge(&a->timeline->events, a->last_s - REACHED_S);
  return edge_s <= a->last_s + REACHED_S ? NEAR_S : INFINITY;
}

/* Where the voltage comes back within t_q of a conduction, as where the thyristor's current rings
 * with a snubber, what is left of the conduction's charge decides over some microseconds whether
 * and when it fires again. That charge grows by a factor with each microsecond, and so does its
 * error. With steps of 0.5 us the force was off by 5 tolerances at 1e-4, with steps of STRAINED_S
 * for as long as STRAINS_S, and as their root at other tolerances, by 2. */
static const double STRAINS_S = 5e-6, STRAINED_S = 5e-8;

/* The instant of a firing by what charge is left was off by up to so much at 1e-4: by 0.2, 0.4 and
 * 0.5 us one behind the other, where a snubber's current of 0.4 A rang by 40 kHz. Whether there is
 * one may be another in a finer run. Sooner than CERTAIN of t_q, as within a sub-pulse of its gate,
 * most of the charge is there, and it goes on for certain: off by 0.3 tolerances. Until the voltage
 * comes back, and where it is back for long, steps are the solver's own, as ten times as many left
 * half of that. */
static const double REFIRES_S = 5e-7, CERTAIN = 0.2;

double vs_anode_strains(const vs_anode *a, const vs_swing *w) {
  double late_s = REFIRES_S * sqrt(w->tolerance / FIRING_AT);
  return a->most_strained ? a->most_strained * late_s * w->peak_v / (w->tolerance * w->seen_wb) : 0;
}

static void count_strained(vs_anode *a) {
  if (!(a->last_s < a->strained_s + a->timeline->period_s)) {
    a->strained_s = a->last_s;
    a->strained = 0;
  }
  if (++a->strained > a->most_strained) a->most_strained = a->strained;
}

static double longest_strained(const vs_anode *a, const vs_anode_current *m,
                               const vs_swing *swing) {
  bool strained = m->forward_s < m->out_s + m->t_q_s && a->last_s < m->forward_s + STRAINS_S;
  return strained ? STRAINED_S * sqrt(swing->tolerance / FIRING_AT) : INFINITY;
}

/* A thyristor of transistors goes out before its current is zero: below its latching current it may
 * let go by itself, and what it carried is gone within a few microseconds, whatever the rest of the
 * circuit does. The solver's error of a step bounds the thyristor's own charges. These grow from
 * almost nothing as it lets go, so that a small error of one is a large one of the instant. What
 * the thyristor carries too long or too short charges the capacitances that the coil rings with. A
 * conduction of 0.1 ms that a short gate pulse left was off by 14 tolerances in the force, with
 * steps of 1.3 us before the current fell.
 *
 * An error of the instant is h^2 over LETS_GO t_q, as measured; times the current it is a charge,
 * which may be SHARE of vs_swing_charge. Measured on that conduction, with 1e-3 to 1e-5: an error
 * of half a tolerance for each unit of SHARE. In a coil that rings fast the instant itself counts
 * (vs_swing_instant). Once the current falls it is too late to begin, so that steps are short from
 * BARELY_A on, of the order of a latching current. Where the coil has had more than the rest of a
 * conduction, steps are seldom as long.
 *
 * A current that rises is let go, too, where the gate's ended before it latched: in steps of 0.5 us
 * that began there a solenoid's 9 mA were let go 0.1 us early, 27 tolerances of the force at 1e-4.
 * So steps are short from the end of the gate's current on. A transformer whose core saturates
 * takes that away within some COLLAPSES_S / 6, in the midst of a pulse. The solver's steps of 2.7
 * us over the bend of its flux linkage made that 0.1 us late, 18 tolerances; with an error of h^2
 * over COLLAPSES_S as large as that of letting go, 0.6 are left. */
static const double BARELY_A = 0.1, LETS_GO = 1.0 / 20, SHARE = 1, COLLAPSES_S = 6e-5;

static double longest_letting_go(const vs_anode *a, const vs_anode_current *m,
                                 const vs_swing *swing) {
  double i_a = forward_current(m), goes_s = LETS_GO * m->t_q_s;
  if (!m->conduction.conducts || !(i_a > 0 && i_a < BARELY_A)) return INFINITY;
  bool may_let_go = m->last_a < m->before_a || (m->device && !is_fed(a, m->device));
  double charge_s = SHARE * vs_swing_charge(swing, goes_s) / i_a;
  double off_s = fmin(charge_s, vs_swing_instant(swing, i_a, goes_s));
  return may_let_go ? sqrt(goes_s * off_s) : a->cores ? sqrt(COLLAPSES_S * off_s) : INFINITY;
}

/* Where a gate's voltage jumps, its current jumps with it, and is back within some 50 ns, the time
 * constant of a gate (thyristor_law.inc). With the steps above its peak was 0.44 A where it is
 * 0.60 A. Steps that begin with EDGE_S, and are as long as what has passed since the edge, leave
 * half a per cent of it. A gate drive with an inductance or a resistance of its own needs none. */
static const double EDGE_S = 2.5e-10;

static double longest_behind_edge(vs_anode *a, const vs_anode_current *m) {
  if (!a->jumps || !m->device) return INFINITY;
  if (is_gated(m->device, a->timeline, a->last_s + REACHED_S) !=
      is_gated(m->device, a->timeline, a->last_s - REACHED_S))
    a->edge_s = a->last_s;
  const double since_s = a->last_s - a->edge_s;
  return since_s < FIRES_S ? fmax(since_s, EDGE_S) : INFINITY;
}

/* At an edge of a sub-pulse the solver begins anew, with a tenth of its step, 2.5 us. While a
 * thyristor conducts that is longer than the gate drive and the thyristor's base take to change: it
 * was tried in vain at each edge, by some ten iterations. With FIRST_S, by three parts and three
 * gate drives, a run takes 5 to 10 % fewer iterations; with half or twice of it 2 % more or less.
 * Within a sub-pulse a transformer's core may saturate, which the solver lets steps pass over: with
 * steps of 14 us its volt-seconds were 1.3 % too many at 1e-4, with CORE_S they are right to 2e-4.
 */
static const double FIRST_S = 1e-7, CORE_S = 5e-6;

static double longest_behind_sub_pulse(const vs_anode *a, const vs_anode_current *m,
                                       const vs_swing *swing) {
  if (!a->bursts || !a->delays || !m->device || !m->conduction.conducts) return INFINITY;
  bool within = is_driven(a, m->device, a->last_s + REACHED_S);
  if (within != is_driven(a, m->device, a->last_s - REACHED_S)) return FIRST_S;
  return within && a->cores ? CORE_S * fmin(1, sqrt(swing->tolerance / FIRING_AT)) : INFINITY;
}

double vs_anode_longest(vs_anode *a, const vs_swing *swing, double max_step_s) {
  double least = INFINITY;
  for (size_t k = 0; k < a->count; k++) {
    vs_anode_current *m = &a->item[k];
    least = fmin(least, fmin(longest(a, m, max_step_s), longest_behind_an_edge(a, m)));
    least = fmin(least, longest_behind_sub_pulse(a, m, swing));
    if (!(m->t_q_s > 0)) {
      least = fmin(least, longest_latching(a, m, swing));
      continue;
    }
    least = fmin(least, fmin(longest_firing(a, m, swing), longest_strained(a, m, swing)));
    least = fmin(least, longest_letting_go(a, m, swing));
    least = fmin(least, longest_behind_edge(a, m));
  }
  return least;
}

void vs_anode_leave(vs_anode *a) {
  for (size_t k = 0; k < a->count; k++) a->item[k].conducted = a->item[k].conduction.conducts;
}

/* A latch that fires behind its gate's edge does so within a step of the trapezoidal rule. Where it
 * discharges a capacitance, as a varistor's, through its few milliohms, over in picoseconds, that
 * rule has at the step's end twice the mean current, and goes back by as much in the next step: the
 * latch took that for a zero of its current, let go, and fired anew 0.15 us later. The force was
 * off by up to 7 tolerances at 1e-4. A rule that begins anew knows nothing of that current. At the
 * edge itself it does so anyway. */
static bool has_fired_late(const vs_anode *a, const vs_anode_current *m) {
  return a->delays && !(m->t_q_s > 0) && m->conduction.conducts && !m->conducted;
}

/* A thyristor needs no gate while its current, and what that falls to over a sub-pulse's period, is
 * above LATCHED of its latching current. Left out from twice I_L on, the sub-pulses of
 * halfwave_paper with a TYN1212 change p, u, w, phi, i and v_ak by up to 3e-5, the least of the
 * gate drive's peaks by 3e-3, and the thyristor's loss by 2e-3, as the gate's current lowers its
 * on-state voltage. That is too much for a run's own numbers, and little for what tells their
 * errors: it is done in the second, coarser run alone, and is then a part of these errors. */
static const double LATCHED = 3;

static bool is_latched(const vs_anode *a, const vs_anode_current *m) {
  double falls_a_s = fmax(0, (m->before_a - m->last_a) / (a->last_s - a->before_s));
  double then_a = m->last_a - falls_a_s / a->timeline->firing.burst_hz;
  return m->conduction.conducts && then_a > LATCHED * a->latching_a;
}

/* One thyristor is latched, and none has a gate pulse that is not. */
static bool are_latched(const vs_anode *a) {
  bool one = false;
  for (size_t k = 0; k < a->count; k++) {
    const vs_anode_current *m = &a->item[k];
    bool latched = is_latched(a, m);
    if (!m->device || (is_gated(m->device, a->timeline, a->last_s + REACHED_S) && !latched))
      return false;
    one = one || latched;
  }
  return one;
}

/* A sub-pulse that has begun is given to its end. */
static void spare_sub_pulses(vs_anode *a) {
  if (!a->spares) return;
  bool spares = are_latched(a);
  for (size_t k = 0; spares && k < a->count; k++)
    spares = !is_driven(a, a->item[k].device, a->last_s + REACHED_S);
  *a->spares = spares;
}

void vs_anode_take(vs_anode *a) {
  a->crossed = false;
  spare_sub_pulses(a);
  for (size_t k = 0; k < a->count; k++) {
    vs_anode_current *m = &a->item[k];
    bool crossed = m->nearing && a->last_s >= m->crosses_s;
    a->crossed = a->crossed || crossed || has_fired_late(a, m);
    if (m->conduction.conducts)
      m->nearing = true;
    else if (crossed || (!m->conducted && !(forward_current(m) > 0)))
      m->nearing = false;
  }
}

void vs_anode_wind(vs_anode *a, double by_s) {
  a->out_s -= by_s;
  a->last_s -= by_s;
  a->before_s -= by_s;
  a->edge_s -= by_s;
  a->strained_s -= by_s;
  for (size_t k = 0; k < a->count; k++) {
    a->item[k].crosses_s -= by_s;
    a->item[k].forward_s -= by_s;
    a->item[k].out_s -= by_s;
    vs_conduction_wind(&a->item[k].conduction, by_s);
  }
}

/* Moves on to a knot. */
static void shift(vs_anode *a, const vs_knot *k) {
  a->before_s = a->last_s;
  a->last_s = k->t_s;
  for (size_t n = 0; n < a->drives; n++) {
    a->drive[n].last_a = fabs(vs_formula_prepared_value(&a->drive[n].i, k->terms));
    a->drive[n].most_a = fmax(a->drive[n].most_a, a->drive[n].last_a);
  }
  for (size_t n = 0; n < a->count; n++) {
    vs_anode_current *m = &a->item[n];
    m->before_a = m->last_a;
    m->before_v = m->last_v;
    m->last_a = current_at(m, k);
    m->last_v = voltage_at(m, k);
    if (m->before_v > 0 || !(m->last_v > 0)) continue;
    m->forward_s = k->t_s;
    double since_s = k->t_s - m->out_s;
    if (since_s > CERTAIN * m->t_q_s && since_s < m->t_q_s) count_strained(a);
  }
}

static vs_event follow(vs_anode_current *m, const vs_timeline *timeline, const vs_knot *from,
                       const vs_knot *to, double *event_s) {
  const vs_conduction_step step = {from->t_s, to->t_s,     m->before_a,
                                   m->last_a, m->before_v, m->last_v};
  bool asked = m->device && step.v1_v > 0 && vs_conduction_asks(&m->conduction, step.i1_a);
  m->conduction.gated = asked && is_gated(m->device, timeline, vs_gate_of_step(from->t_s, to->t_s));
  return vs_conduction_follow(&m->conduction, &step, event_s);
}

bool vs_anode_conducts(const vs_anode *a) {
  for (size_t k = 0; k < a->count; k++)
    if (a->item[k].conduction.conducts) return true;
  return false;
}

/* Where one thyristor takes over from another, the sum goes on. A current's foot may lie before the
 * end of the conduction before, where that was another thyristor's. */
vs_event vs_anode_follow(vs_anode *a, const vs_knot *from, const vs_knot *to, double *event_s) {
  if (isnan(a->last_s)) shift(a, from);
  shift(a, to);
  if (to->t_s == from->t_s) return VS_EV_NONE;
  bool was = vs_anode_conducts(a);
  double fires_s = INFINITY, at_s = NAN;
  for (size_t k = 0; k < a->count; k++) {
    vs_event event = follow(&a->item[k], a->timeline, from, to, &at_s);
    if (event == VS_EV_FIRES) fires_s = fmin(fires_s, at_s);
    if (event == VS_EV_EXTINCT) {
      a->item[k].out_s = at_s;
      a->out_s = fmax(a->out_s, at_s);
    }
  }
  if (vs_anode_conducts(a) == was) return VS_EV_NONE;
  *event_s = was ? a->out_s : fmax(fires_s, a->out_s);
  return was ? VS_EV_EXTINCT : VS_EV_FIRES;
}

static bool has_current(const vs_device *d, const vs_probe *probe) {
  int term;
  double factor = 0;
  return vs_formula_is_term(&d->current, &term, &factor) && term == probe->term &&
         factor == probe->sign;
}

/* The current is the probe's, or without one the device's by its formula. */
static void add(vs_anode *a, const vs_deck *deck, const vs_probe *probe, const vs_device *device) {
  for (double way = 1; way >= (device && device->kind->both_ways ? -1 : 1); way -= 2) {
    vs_anode_current *m = &a->item[a->count++];
    double t_q_s = vs_conduction_turn_off(deck, device);
    bool recovers = t_q_s > 0;
    *m = (vs_anode_current){.device = device,
                            .way = way,
                            .t_q_s = t_q_s,
                            .out_s = -INFINITY,
                            .forward_s = -INFINITY,
                            .near_s = recovers ? NEAR_RECOVERING_S : NEAR_S,
                            .crosses_s = INFINITY};
    if (device) m->v = vs_formula_prepare(&device->voltage);
    m->i = probe ? (vs_formula_prepared){.is_term = true,
                                         .term = (int)probe->term,
                                         .factor = probe->sign}
                 : vs_formula_prepare(&device->current);
    vs_conduction_begin(&m->conduction);
    m->conduction.recovers = recovers;
    m->conduction.both_ways = device && device->kind->both_ways;
  }
}

/* The parameter latching_current of the deck's thyristors, A; INFINITY: they have none. */
static double latching_current(const vs_setup *s) {
  const vs_section *circuit = &s->deck.section;
  for (size_t k = 0; k < circuit->count; k++)
    if (!strcmp(circuit->fields[k].key, "latching_current"))
      return *(const double *)((const char *)&s->circuit_values + circuit->fields[k].offset);
  return INFINITY;
}

static bool is_gate_drive(const vs_part *part) {
  const vs_kind *kind = vs_kinds_find(part->kind);
  return part->file && kind && kind->gated && !kind->switches;
}

/* True where a gate drive has a voltage source straight across its pins g and k, which are the
 * third and the fourth. */
static bool has_source_at_gate(const vs_deck *deck, const vs_part *part) {
  const vs_cards *c = vs_deck_cards(deck);
  const vs_netlist_definition *d =
      vs_cards_find(c, 0, VS_CARDS_SUBCKT, vs_words_of(part->subcircuit));
  if (!d || c->card[d->card].nodes < 4) return false;
  const vs_netlist_card *head = &c->card[d->card];
  const vs_netlist_scope *scope = &c->scope[head->opens];
  for (size_t k = scope->first; k < scope->last; k = vs_cards_next(c, k)) {
    const vs_netlist_card *card = &c->card[k];
    if (card->kind == VS_CARDS_ELEMENT && strchr("ev", card->letter) &&
        !vs_words_compare(vs_cards_word(c, card, 0), vs_cards_word(c, head, 2)) &&
        !vs_words_compare(vs_cards_word(c, card, 1), vs_cards_word(c, head, 3)))
      return true;
  }
  return false;
}

void vs_anode_begin(vs_anode *a, const vs_setup *setup) {
  const vs_deck *deck = &setup->deck;
  const vs_probe *probe = NULL;
  const vs_device *own = NULL, *d;
  size_t valves = 0;
  *a = (vs_anode){.timeline = &setup->timeline,
                  .latching_a = latching_current(setup),
                  .out_s = -INFINITY,
                  .last_s = NAN,
                  .before_s = NAN,
                  .edge_s = -INFINITY,
                  .strained_s = -INFINITY};
  for (size_t k = 0; k < deck->n_parts; k++) {
    if (!is_gate_drive(&deck->parts[k])) continue;
    bool jumps = has_source_at_gate(deck, &deck->parts[k]);
    a->jumps = a->jumps || jumps;
    a->delays = a->delays || !jumps;
  }
  for (size_t k = 0; k < deck->n_ports; k++)
    a->bursts = a->bursts || deck->ports[k].signal.drive == VS_PORT_BURST;
  for (size_t k = 0; k < deck->n_probes; k++)
    if (!strcmp(deck->probes[k].name, "i_thyristor")) probe = &deck->probes[k];
  if (!probe) return;
  for (size_t k = 0; k < deck->n_devices; k++) {
    d = &deck->devices[k];
    if (!d->kind->switches && d->kind->gated) {
      a->drive[a->drives++].i = vs_formula_prepare(&d->current);
      a->cores = a->cores || d->has_flux;
    }
    if (!d->kind->switches || !d->kind->gated) continue;
    valves++;
    if (has_current(d, probe)) own = d;
    add(a, deck, NULL, d);
  }
  if (!own && valves > 1) return;
  a->count = 0;
  add(a, deck, probe, own);
}
