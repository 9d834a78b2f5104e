/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/solver_switch.h"

#include <math.h>

/* ---- without the solver ---- */

/* From the last knot to t_s, in at least four steps. */
static vs_status go_without(vs_solver_switch *a, double t_s, vs_error *err) {
  vs_trajectory *c = a->trajectory;
  double from_s = vs_trajectory_last(c)->t_s, gone_s = t_s - from_s;
  double n = ceil(gone_s / fmin(a->kind->longest(a->law), gone_s / 4));
  vs_knot next;
  vs_step_copy_knot(&c->frame, vs_trajectory_last(c), &next);
  vs_status status = vs_trajectory_show(c, &next, VS_EV_QUIET, err);
  c->without = true;
  for (double k = 1; k <= n && !status; k++) {
    status = a->kind->step(a->law, &next, k < n ? from_s + gone_s * (k / n) : t_s, err);
    if (!status) status = vs_trajectory_show(c, &next, VS_EV_NONE, err);
  }
  return status;
}

vs_status vs_solver_switch_finish(vs_solver_switch *a, vs_error *err) {
  return a->ends ? go_without(a, a->trajectory->setup->run.until_s, err) : VS_OK;
}

/* ---- left and led back ---- */

/* Back in the solver, it is led for this share of a cycle. What the circuit holds besides the EVA's
 * flux linkage and voltage follows with the lag of the snubbers; for ten such lags to pass in that
 * time, the second is the longest lag, in cycles. */
static const double FOLLOWS = 0.9, MOST_LAG = 0.09;

/* Relative to run.tolerance: how much a run may differ from one that stayed in the solver, because
 * the solver takes other steps once it is gone back to. Over the scenes of
 * tests/engine/test_quiet.c this exceeded the rest of the bound by 0.028 at most. */
static const double OTHER_STEPS = 0.1;

static vs_status go_without_for(vs_solver_switch *a, double cycles, vs_error *err) {
  vs_trajectory *c = a->trajectory;
  double period_s = c->setup->timeline.period_s;
  double away_s = cycles * period_s, back_s = vs_trajectory_last(c)->t_s + away_s;
  c->bound += OTHER_STEPS * c->setup->run.tolerance;
  vs_status status = go_without(a, back_s, err);
  a->shift_s += away_s;
  a->follows = true;
  a->follows_until_s = back_s + FOLLOWS * period_s;
  c->candidate_s = a->goal_s = -1;
  return status;
}

vs_status vs_solver_switch_consider(vs_solver_switch *a, const double *signals, vs_error *err) {
  vs_trajectory *c = a->trajectory;
  const vs_setup *setup = c->setup;
  double now = vs_trajectory_last(c)->t_s, until = setup->run.until_s,
         memory[VS_CIRCUIT_STATES_MOST];
  bool conducts = vs_anode_conducts(&c->anode);
  if (!a->law || a->stays) return VS_OK;
  vs_signal_map_take_memory(a->names, signals, memory);
  a->kind->take(a->law, vs_trajectory_last(c), memory, !conducts);
  if (conducts || c->touched) return VS_OK;
  double cycles = INFINITY, most_lag_s = INFINITY, period_s = setup->timeline.period_s;
  double next = vs_trajectory_edge(c, now);
  if (next < until) {
    if (!setup->deck.eva_led) return VS_OK;
    cycles = floor((next - now) / period_s) - 1; /* the last of them is for being led back */
    until = now + cycles * period_s;
    most_lag_s = MOST_LAG * period_s;
  }
  if (cycles < 1 || !a->kind->may_leave(a->law, until, most_lag_s, &c->bound)) return VS_OK;
  if (isfinite(cycles)) return go_without_for(a, cycles, err);
  a->ends = true; /* vs_solver_switch_finish goes on once the solver has come back from its run */
  return VS_OK;
}

/* Where the macromodel is at t_s. If it cannot step there, follow() fails too. */
static const vs_knot *goal_at(vs_solver_switch *a, double t_s) {
  vs_error err = {0};
  if (t_s == a->goal_s) return &a->goal;
  vs_step_copy_knot(&a->trajectory->frame, vs_trajectory_last(a->trajectory), &a->goal);
  a->kind->step(a->law, &a->goal, t_s, &err);
  a->goal_s = t_s;
  return &a->goal;
}

double vs_solver_switch_lead(vs_solver_switch *a, size_t port, double t_s) {
  if (!a->follows) return 0;
  if (port == VS_EVA_PORT_FLUX) return goal_at(a, t_s)->flux_wb;
  if (port == VS_EVA_PORT_VOLTAGE) return goal_at(a, t_s)->v_eva_v;
  if (port == VS_EVA_PORT_RATE) return a->lead_rate_1_s;
  return a->lead_rate_1_s * a->kind->capacitance(a->law); /* the same time constant for v */
}

/* The solver is gone back to. If it has not come to where the macromodel is, that difference
 * becomes part of the bound, and the solver is not left again. */
static void come_back(vs_solver_switch *a, const vs_knot *own, const double *signals) {
  vs_trajectory *c = a->trajectory;
  vs_knot solver;
  double memory[VS_CIRCUIT_STATES_MOST];
  vs_signal_map_take_terms(&c->setup->deck, signals, &solver);
  vs_signal_map_take_memory(a->names, signals, memory);
  double missed = a->kind->missed(a->law, own, &solver, memory);
  c->without = false;
  a->kind->restart(a->law);
  if (missed > 1) {
    c->bound = fmax(c->bound, missed * c->setup->run.tolerance);
    a->stays = true;
  }
}

vs_status vs_solver_switch_follow(vs_solver_switch *a, double t_s, const double *signals,
                                  vs_error *err) {
  vs_trajectory *c = a->trajectory;
  vs_knot next;
  vs_step_copy_knot(&c->frame, vs_trajectory_last(c), &next);
  vs_status status = a->kind->step(a->law, &next, t_s, err);
  if (status) return status;
  a->follows = t_s < a->follows_until_s;
  if (!a->follows) come_back(a, &next, signals);
  return vs_trajectory_show(c, &next, a->follows ? VS_EV_NONE : VS_EV_BACK, err);
}

bool vs_solver_switch_enough(const vs_solver_switch *a) {
  double until_s = a->trajectory->setup->run.until_s;
  return a->ends || (a->shift_s != 0 && vs_trajectory_last(a->trajectory)->t_s >=
                                            until_s - vs_scene_event_rounding(until_s));
}

/* ---- begun and ended ---- */

/* The solver is led with a time constant of this many of its largest steps. */
static const double LEADS_STEPS = 4;

/* False where edges are so near to one another, all along the run, that the solver cannot be left:
 * vs_solver_switch_consider wants two cycles of the mains up to the next edge, and may_leave
 * (macromodel/macromodel.h) one up to the run's end. A law would then be fed at each step for
 * nothing. Where edges are not known yet, or are too many to be looked at, the time may come. */
static bool may_come(const vs_setup *setup, const vs_run_order *order) {
  enum { MOST_EDGES = 100000 };
  double period_s = setup->timeline.period_s * (1 - 1e-6), until_s = setup->run.until_s, now_s = 0;
  if (setup->timeline.program || order->fork || order->pilot) return true;
  for (int k = 0; k < MOST_EDGES; k++) {
    double next_s = vs_setup_edge(setup, now_s);
    if (next_s >= until_s) return until_s - now_s >= period_s;
    if (next_s - now_s >= 2 * period_s) return true;
    now_s = next_s;
  }
  return true;
}

void vs_solver_switch_begin(vs_solver_switch *a, const vs_run_order *order,
                            vs_trajectory *trajectory, const vs_signal_map *names,
                            double max_step_s) {
  const vs_setup *setup = trajectory->setup;
  *a = (vs_solver_switch){.trajectory = trajectory,
                          .names = names,
                          .kind = order->stand_in,
                          .lead_rate_1_s = 1 / (LEADS_STEPS * max_step_s),
                          .goal_s = -1};
  /* not where the user forbids it, or wants all that the solver shows */
  if (order->stand_in && !setup->run.stays && !order->raw && may_come(setup, order))
    a->law = order->stand_in->begin(setup, &trajectory->frame);
}

void vs_solver_switch_end(vs_solver_switch *a) {
  if (a->law) a->kind->end(a->law);
}

const vs_circuit_states *vs_solver_switch_memories(const vs_solver_switch *a) {
  return a->law ? a->kind->memories(a->law) : NULL;
}
