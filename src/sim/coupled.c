/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier "circuit": the netlist in its solver, the mechanics in GSL, stepped together at every time
 * step.
 *
 * Mechanics -> circuit: the gap z at the candidate time of each of the solver's steps, foretold
 * from the last accepted step. Circuit -> mechanics: the flux linkage lambda of the accepted step,
 * under which the mechanics are integrated over it. F = lambda^2/(4a) depends on lambda alone, so
 * nothing else need be exchanged. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "machine/actuator.h"
#include "sim/anode.h"
#include "sim/motion.h"
#include "sim/names.h"
#include "sim/pace.h"
#include "sim/quiet.h"
#include "sim/sim.h"
#include "sim/swing.h"

typedef struct coupling {
  const vs_setup *setup;
  vs_frame frame;
  const vs_observer *observer;
  vs_knot knots[2]; /* the last accepted one is knots[now] */
  int now;
  double step_s, max_step_s;           /* the last accepted step's length; the largest allowed */
  double candidate_s, candidate_gap_m; /* what the solver was last told */
  size_t gap_port;                     /* ports before it are the deck's */
  vs_anode anode;
  vs_motion motion;
  bool touching; /* the armature its stop, at the last accepted knot */
  double jams_s; /* INFINITY: it does not */
  bool jammed;
  double series_s; /* a cubic's error over it is below 5e-6 of the amplitude */
  vs_quiet *quiet; /* NULL: the solver goes on to the end */
  bool ends;       /* the solver is not needed any more */
  bool without;    /* the solver, the one-port in its place */
  bool follows;    /* the solver is led to where the one-port has come meanwhile */
  double shift_s;  /* the run's time less the solver's: whole cycles that it was left for */
  double led_s;    /* the one-port at that time, while the solver is led */
  vs_knot led;
  double followed_s; /* up to then */
  double bound;      /* on the error by having left it */
  vs_swing swing;    /* of the coil's voltage */
  vs_memories
      memories;        /* of the circuit, which the solver shows last of all; watched to leave it */
  size_t first_memory; /* among the signals */
} coupling;

/* Sets the flux linkage's course and the machine's state from which it is to be taken on. */
static void set_course(coupling *c, double f0, double f1, double f2, double f3) {
  const double flux[4] = {f0, f1, f2, f3};
  memcpy(c->motion.flux, flux, sizeof flux);
  c->motion.touching = c->touching;
  c->motion.jammed = c->jammed;
}

/* p at t by the mechanics' integration, in the stop or where it may be met: lambda goes on with the
 * slope it has, and its slope as it changed. */
static double integrated_p(coupling *c, double h) {
  const vs_knot *k = &c->knots[c->now];
  double x[VS_STATES];
  memcpy(x, k->x, sizeof x);
  set_course(c, k->flux_wb, k->flux_rate_v, k->flux_rate2_v_s / 2, 0);
  for (double at = 0; at < h; c->motion.touching = !c->motion.touching)
    at = vs_motion_advance(&c->motion, at, h, x); /* NaN ends it too; accept() will say so */
  return x[P];
}

/* Where the mechanics will be at t: along p's Taylor polynomial from the last knot, whose next term
 * is (w h)^4/24 of the amplitude at most; by integration where that or the stop asks for it. */
static double predicted_gap(coupling *c, double t_s) {
  const vs_knot *k = &c->knots[c->now];
  if (t_s == c->candidate_s) return c->candidate_gap_m;
  double h = t_s - k->t_s,
         p = k->x[P] + h * (k->x[VS_DOF + P] + h / 2 * (k->a[P] + h / 3 * k->j[P]));
  if (h > c->series_s || c->touching || vs_in_stop(&c->setup->model, p)) p = integrated_p(c, h);
  c->candidate_s = t_s;
  return c->candidate_gap_m = vs_gap(&c->setup->model, p);
}

/* Where the one-port is at t. */
static const vs_knot *one_port_at(coupling *c, double t_s) {
  vs_error err = {0};
  if (t_s == c->led_s) return &c->led;
  vs_knot_copy(&c->frame, &c->knots[c->now], &c->led);
  vs_quiet_step(c->quiet, &c->led, t_s, &err); /* if it fails, follow() fails too */
  c->led_s = t_s;
  return &c->led;
}

/* Both halves are led with the same time constant, of some of the largest steps. */
static double leading(coupling *c, size_t port, double t_s) {
  double rate_1_s = 1 / (4 * c->max_step_s);
  if (!c->follows) return 0;
  if (port == VS_PORT_FLUX) return one_port_at(c, t_s)->flux_wb;
  if (port == VS_PORT_VOLTAGE) return one_port_at(c, t_s)->v_eva_v;
  return port == VS_PORT_RATE ? rate_1_s : rate_1_s * vs_quiet_capacitance(c->quiet);
}

static double source(void *ctx, size_t port, double solver_s) {
  coupling *c = ctx;
  double t_s = solver_s + c->shift_s;
  if (port == c->gap_port + VS_PORT_GAP) return predicted_gap(c, t_s);
  if (port > c->gap_port) return leading(c, port - c->gap_port, t_s);
  const vs_port *p = &c->setup->deck.ports[port];
  return vs_drives[p->signal.drive].voltage(&c->setup->timeline, &p->signal, t_s);
}

/* First gate edge or event after t; INFINITY: none. */
static double next_edge(const coupling *c, double t_s) {
  double next = vs_events_edge(&c->setup->timeline.events, t_s);
  for (size_t k = 0; k < c->setup->deck.n_ports; k++) {
    const vs_signal *s = &c->setup->deck.ports[k].signal;
    next = fmin(next, vs_drives[s->drive].edge(&c->setup->timeline, s, t_s));
  }
  return next;
}

static double edge(void *ctx, double solver_s) {
  coupling *c = ctx;
  if (c->anode.crossed || c->swing.anew) return solver_s; /* the rule begins anew */
  double next = next_edge(c, solver_s + c->shift_s);
  if (c->shift_s > 0) next = fmin(next, c->setup->run.until_s);
  return next - c->shift_s;
}

static double longest(void *ctx, double solver_s) {
  coupling *c = ctx;
  double part = fmin(c->max_step_s, vs_swing_longest(&c->swing));
  part = fmin(part,
              vs_anode_longest(&c->anode, &c->knots[1 - c->now], &c->knots[c->now], c->max_step_s));
  return fmin(part, vs_events_longest(&c->setup->timeline.events, solver_s + c->shift_s));
}

static void complete(const coupling *c, vs_knot *k) {
  if (c->jammed)
    vs_knot_hold(&c->frame, k);
  else
    vs_knot_complete(&c->frame, k, c->touching);
}

/* Shows the step to a knot. */
static vs_status show(coupling *c, const vs_knot *k, vs_event contact, vs_error *err) {
  vs_knot *from = &c->knots[c->now], *to = &c->knots[1 - c->now];
  if (from->t_s == 0)
    memcpy(from->terms, k->terms, sizeof k->terms); /* the solver shows none at t = 0 */
  vs_step step = {.frame = &c->frame,
                  .from = from,
                  .to = to,
                  .cubic_flux = true,
                  .periodic = c->without,
                  .held = c->jammed};
  step.event[0] = vs_anode_follow(&c->anode, from, k, &step.event_s[0]);
  vs_knot_copy(&c->frame, k, to);
  step.event[1] = contact;
  step.event_s[1] = to->t_s;
  step.bound = c->bound;
  c->now = 1 - c->now;
  return c->observer->accept(c->observer->ctx, &step, err);
}

/* The knot `at` seconds behind a, on the way to b, under the present course of the flux. */
static vs_knot between(const coupling *c, const vs_knot *a, const vs_knot *b, double at_s) {
  const double *f = c->motion.flux, part = at_s / (b->t_s - a->t_s);
  vs_knot k = *b;
  k.t_s = a->t_s + at_s;
  k.flux_wb = f[0] + at_s * (f[1] + at_s * (f[2] + at_s * f[3]));
  k.flux_rate_v = f[1] + at_s * (2 * f[2] + at_s * 3 * f[3]);
  k.v_eva_v = a->v_eva_v + part * (b->v_eva_v - a->v_eva_v);
  k.i_mains_a = a->i_mains_a + part * (b->i_mains_a - a->i_mains_a);
  for (size_t n = 0; n < c->setup->deck.n_terms; n++)
    k.terms[n] = a->terms[n] + part * (b->terms[n] - a->terms[n]);
  return k;
}

/* Integrates the machine over the step whose end is known of the circuit, and shows it: in one
 * piece, or cut where the armature meets or leaves its stop, such an instant shown from both its
 * sides. */
static vs_status move(coupling *c, const vs_knot *start, vs_knot *end, vs_error *err) {
  double h = end->t_s - start->t_s, x[VS_STATES];
  vs_knot cut, *k = &cut;
  memcpy(x, start->x, sizeof x);
  vs_status status = VS_OK;
  for (double at = 0; at < h && !status;) {
    at = vs_motion_advance(&c->motion, at, h, x);
    if (isnan(at)) return vs_fail(err, VS_RUN, "t = %.9g s: GSL cannot step on", end->t_s);
    if (at < h)
      cut = between(c, start, end, at);
    else
      k = end;
    memcpy(k->x, x, sizeof x);
    complete(c, k);
    if (k == end) break;
    status = show(c, k, c->touching ? VS_EV_LEAVES_STOP : VS_EV_MEETS_STOP, err);
    c->touching = c->motion.touching = !c->touching;
    complete(c, k);
    if (!status) status = show(c, k, VS_EV_NONE, err);
  }
  if (!status) status = show(c, end, VS_EV_NONE, err);
  if (status || c->jammed || end->t_s < c->jams_s - 1e-12) return status;
  c->jammed = c->motion.jammed = true; /* from one side of the instant to the other */
  vs_hold_p(&c->setup->model, end->x + VS_DOF);
  complete(c, end);
  return show(c, end, VS_EV_JAMS, err);
}

/* ---- without the solver ---- */

/* By the one-port from the last knot to t. */
static vs_status go_without(coupling *c, double t_s, vs_error *err) {
  double from_s = c->knots[c->now].t_s, gone_s = t_s - from_s;
  double n = ceil(gone_s / fmin(vs_quiet_longest(c->quiet), gone_s / 4));
  vs_knot next;
  vs_knot_copy(&c->frame, &c->knots[c->now], &next);
  vs_status status = show(c, &next, VS_EV_QUIET, err);
  c->without = true;
  for (double k = 1; k <= n && !status; k++) {
    status = vs_quiet_step(c->quiet, &next, k < n ? from_s + gone_s * (k / n) : t_s, err);
    if (!status) status = show(c, &next, VS_EV_NONE, err);
  }
  return status;
}

/* Back in the solver, it is led for this part of a cycle: what else the circuit holds than the
 * EVA's flux linkage and voltage follows with the lag of the snubbers, of which it shall have ten.
 */
static const double FOLLOWS = 0.9, MOST_LAG = 0.09;

/* Of run.tolerance: by how much a run may differ from one that stayed as the solver, once it is
 * gone back to, takes other steps. Over the scenes of tests/test_quiet.c it was beyond the rest
 * of the bound by 0.028 at most. */
static const double OTHER_STEPS = 0.1;

/* The solver stands at some phase of the mains while whole cycles pass by the one-port; then it
 * goes on with its clock moved on by them, and is led to where the machine, lambda and v have come.
 */
static vs_status go_without_for(coupling *c, double cycles, vs_error *err) {
  double away_s = cycles * c->setup->timeline.period_s, back_s = c->knots[c->now].t_s + away_s;
  c->bound += OTHER_STEPS * c->setup->run.tolerance;
  vs_status status = go_without(c, back_s, err);
  c->shift_s += away_s;
  c->follows = true;
  c->followed_s = back_s + FOLLOWS * c->setup->timeline.period_s;
  c->candidate_s = c->led_s = -1;
  return status;
}

static bool gate_is_on(const coupling *c, double t_s) {
  for (size_t k = 0; k < c->setup->deck.n_ports; k++) {
    const vs_signal *s = &c->setup->deck.ports[k].signal;
    if (s->drive != VS_DRIVE_GATE && s->drive != VS_DRIVE_BURST) continue;
    if (vs_gate(&c->setup->timeline, s->shift_rad, t_s)) return true;
  }
  return false;
}

/* Leaves the solver, for good or until shortly before the next edge, if the circuit is quiet. */
static vs_status leave_if_quiet(coupling *c, const double *memory, vs_error *err) {
  const vs_knot *k = &c->knots[c->now];
  double now = k->t_s, until = c->setup->run.until_s, next = next_edge(c, now);
  vs_quiet_take(c->quiet, k, memory, !c->anode.conduction.conducts);
  if (c->anode.conduction.conducts || c->touching || gate_is_on(c, now) ||
      isfinite(vs_events_longest(&c->setup->timeline.events, now)))
    return VS_OK;
  double cycles = INFINITY, most_lag_s = INFINITY, period_s = c->setup->timeline.period_s;
  if (next < until) {
    if (!c->setup->deck.eva_led) return VS_OK;
    cycles = floor((next - now) / period_s) - 1; /* one to be led back in */
    until = now + cycles * period_s;
    most_lag_s = MOST_LAG * period_s;
  }
  if (cycles < 1 || !vs_quiet_may_leave(c->quiet, until, most_lag_s, &c->bound)) return VS_OK;
  if (isfinite(cycles)) return go_without_for(c, cycles, err);
  c->ends = true;
  return VS_OK; /* the rest once the solver has come back from its run */
}

/* What the solver shows of the deck's terms. */
static void take_terms(const coupling *c, const double *signals, vs_knot *k) {
  k->i_mains_a = -signals[VS_SIG_I_MAINS];
  for (size_t n = 0; n < c->setup->deck.n_terms; n++)
    k->terms[n] = signals[VS_SIG_TERMS + 2 * n] - signals[VS_SIG_TERMS + 2 * n + 1];
}

static void take_memory(const coupling *c, const double *signals, double *memory) {
  const double *s = signals + c->first_memory;
  for (size_t n = 0; n < c->memories.count; n++) memory[n] = s[2 * n] - s[2 * n + 1];
}

/* The solver's step, taken while it is led: the one-port's is shown. If the solver has not come to
 * it in the end, that is part of the bound, and the solver is not left again. */
static vs_status follow(coupling *c, double t_s, const double *signals, vs_error *err) {
  vs_knot next, solver;
  vs_knot_copy(&c->frame, &c->knots[c->now], &next);
  vs_status status = vs_quiet_step(c->quiet, &next, t_s, err);
  c->follows = t_s < c->followed_s;
  if (status || c->follows) return status ? status : show(c, &next, VS_EV_NONE, err);
  double memory[VS_MEMORIES];
  take_terms(c, signals, &solver);
  take_memory(c, signals, memory);
  double missed = vs_quiet_missed(c->quiet, &next, &solver, memory);
  c->without = false;
  vs_quiet_restart(c->quiet);
  if (missed > 1) {
    c->bound = fmax(c->bound, missed * c->setup->run.tolerance);
    vs_quiet_free(c->quiet);
    c->quiet = NULL;
  }
  return show(c, &next, VS_EV_BACK, err);
}

static vs_status accept(void *ctx, double solver_s, const double *signals, vs_error *err) {
  coupling *c = ctx;
  double t_s = solver_s + c->shift_s;
  if (c->follows) return follow(c, t_s, signals, err);
  vs_knot from, next; /* move() gives next its state */
  vs_knot_copy(&c->frame, &c->knots[c->now], &from);
  double h = t_s - from.t_s;
  next.t_s = t_s;
  next.flux_wb = signals[VS_SIG_FLUX];
  take_terms(c, signals, &next);
  next.flux_rate_v = signals[VS_SIG_COIL] - signals[VS_SIG_MINUS];
  next.v_eva_v = signals[VS_SIG_PLUS] - signals[VS_SIG_MINUS];
  next.flux_rate2_v_s = (next.flux_rate_v - from.flux_rate_v) / h;
  /* the cubic through both ends' values and slopes */
  double slope = (next.flux_wb - from.flux_wb) / h;
  set_course(c, from.flux_wb, from.flux_rate_v,
             (3 * slope - 2 * from.flux_rate_v - next.flux_rate_v) / h,
             (from.flux_rate_v + next.flux_rate_v - 2 * slope) / (h * h));
  vs_swing_take(&c->swing, &from, &next, c->step_s);
  c->step_s = h;
  c->candidate_s = -1;
  bool conducted = c->anode.conduction.conducts;
  vs_status status = move(c, &from, &next, err);
  vs_anode_take(&c->anode, &c->knots[c->now], conducted);
  if (status || !c->quiet) return status;
  double memory[VS_MEMORIES];
  take_memory(c, signals, memory);
  return leave_if_quiet(c, memory, err);
}

static bool enough(void *ctx) {
  const coupling *c = ctx;
  double until_s = c->setup->run.until_s;
  return c->ends || (c->shift_s > 0 && c->knots[c->now].t_s >= until_s - vs_rounding(until_s));
}

static vs_frame frame(const vs_setup *setup) {
  return (vs_frame){.model = &setup->model,
                    .timeline = &setup->timeline,
                    .deck = &setup->deck,
                    .means = setup->means,
                    .tolerance = setup->run.tolerance};
}

/* What the solver is to show: of the names' signals, then of the memories. */
static size_t list_signals(coupling *c, const vs_names *n, const char **signals) {
  size_t count = c->first_memory = n->n_signals;
  memcpy(signals, n->signals, count * sizeof *signals);
  for (size_t k = 0; k < c->memories.count; k++) {
    signals[count++] = c->memories.item[k].plus;
    signals[count++] = c->memories.item[k].minus;
  }
  return count;
}

static void locate(const void *deck, vs_error *err) {
  vs_deck_locate(deck, err);
}

static double first_jam(const vs_events *events) {
  double first_s = INFINITY;
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].kind->jams) first_s = fmin(first_s, events->item[k].start_s);
  return first_s;
}

/* Makes what decides when the solver may be left: not where the user forbids it or wants all that
 * the solver shows, where the armature jams, where the deck tells the time by itself or keeps a
 * state or a store that is not seen. */
static void begin_leaving(coupling *c) {
  const vs_setup *setup = c->setup;
  const vs_deck *deck = &setup->deck;
  if (!setup->run.stays && !setup->raw && isinf(c->jams_s) && !deck->own_clock &&
      deck->stores.count && !vs_deck_hides_state(deck) && vs_memories_of(deck, &c->memories))
    c->quiet = vs_quiet_new(setup, &c->frame, &c->memories);
  if (!c->quiet) c->memories.count = 0;
}

static void begin(coupling *c, const vs_setup *setup, const vs_observer *observer,
                  double max_step_s) {
  const vs_model *m = &setup->model;
  *c = (coupling){.setup = setup,
                  .frame = frame(setup),
                  .observer = observer,
                  .candidate_s = -1,
                  .gap_port = setup->deck.n_ports,
                  .jams_s = first_jam(&setup->timeline.events),
                  .max_step_s = max_step_s,
                  .swing = vs_swing_of(setup),
                  .series_s = 0.1 / m->fastest_rad_s};
  c->knots[0] = vs_sim_start(setup, &c->frame);
  c->touching = vs_in_stop(m, c->knots[0].x[P]);
  vs_anode_begin(&c->anode, &setup->deck, &setup->timeline);
  vs_motion_begin(&c->motion, m);
  begin_leaving(c);
}

static void end(coupling *c) {
  vs_motion_end(&c->motion);
  vs_quiet_free(c->quiet);
}

/* All of the solver's job but its ports, its signals and its netlist. */
static vs_circuit_job job_of(const coupling *c, const vs_pace *pace) {
  const vs_setup *setup = c->setup;
  return (vs_circuit_job){.n_wanted = 2 * c->memories.count,
                          .until_s = setup->run.until_s,
                          .gear = setup->run.gear,
                          .dialect = setup->deck.compat,
                          .max_step_s = c->max_step_s,
                          .raw = setup->raw,
                          .tried = setup->tried,
                          .truncation_factor = pace->truncation,
                          .pivot_threshold = setup->run.pivrel,
                          .relative_tolerance = pace->relative,
                          .current_tolerance_a = pace->current_a,
                          .voltage_tolerance_v = pace->voltage_v,
                          .charge_tolerance_c = pace->charge_c,
                          .locate = locate,
                          .author = &setup->deck};
}

/* Takes the deck through the solver, and on to the end if the solver is left for good before it. */
static vs_status go(coupling *c, vs_circuit_job *job, vs_error *err) {
  const vs_setup *setup = c->setup;
  vs_deck_value standard[VS_STANDARD];
  char **netlist = NULL;
  void *circuit = NULL;
  vs_circuit_host host = {c, source, edge, longest, accept, enough};
  vs_setup_standard(setup, standard);
  vs_status s = vs_deck_netlist(&setup->deck, &setup->circuit_values, standard, VS_STANDARD,
                                &netlist, &job->lines, err);
  job->netlist = netlist;
  if (!s) s = vs_sim_check_steps(setup, fmin(c->max_step_s, c->motion.substep_touching_s), err);
  if (!s) s = setup->solver->load(job, &host, &circuit, err);
  if (!s) s = setup->solver->run(circuit, err);
  if (!s && c->ends) s = go_without(c, setup->run.until_s, err);
  setup->solver->free(circuit);
  vs_netlist_free(netlist, job->lines);
  return s;
}

static vs_status run(const vs_setup *setup, const vs_observer *observer, vs_error *err) {
  const vs_pace pace = vs_pace_of(setup);
  const char *signals[VS_SIG_MOST + 2 * VS_MEMORIES];
  vs_names *n = vs_alloc(1, sizeof *n);
  vs_names_of(&setup->deck, n);
  coupling c; /* stays where it is: the solver's host and the motion point to it */
  begin(&c, setup, observer, pace.max_step_s);
  vs_circuit_job job = job_of(&c, &pace);
  job.ports = n->ports;
  job.n_ports = n->n_ports;
  job.signals = signals;
  job.n_signals = list_signals(&c, n, signals);
  vs_status s = go(&c, &job, err);
  end(&c);
  free(n);
  return s;
}

const vs_tier vs_tier_circuit = {
    "circuit", "the ngspice netlist, F = lambda^2/(4a) from it: anything about devices", 1e-8,
    frame, run};
