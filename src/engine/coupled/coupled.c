/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier "circuit": the netlist in its solver, the mechanics in GSL, stepped together at every time
 * step.
 *
 * Mechanics -> circuit: the gap z at the candidate time of each of the solver's steps, foretold
 * from the last accepted step. Circuit -> mechanics: the flux linkage lambda of the accepted step,
 * under which the mechanics are integrated over it. The coil's current and force are functions of
 * lambda and z, in C as in the netlist (netlist/eva.h), so nothing else need be exchanged; what
 * else of the motion the deck names is foretold as the gap is.
 *
 * The solver owns the loop over time: ngspice proposes a step, solves it by Newton's method,
 * accepts or shortens it. What it needs for that it asks this file for, its host, in this order:
 *
 *   next_breakpoint     the instant that the step must not pass
 *   longest_step        how long it may be
 *   source_value        what drives the circuit at its end: once per port and candidate time
 *   accept_coupled_step the step is accepted, and the machine is taken over it
 *
 * The last one tells what a coupled step is. The others stand behind it, and run_coupled at the end
 * puts it all together. */
#include "engine/sim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "coupled/coupled.h"
#include "coupled/settling.h"
#include "coupled/signal_map.h"
#include "coupled/solver_switch.h"
#include "coupled/swing.h"
#include "coupled/trajectory.h"
#include "coupled/truncation.h"
#include "engine/events.h"
#include "engine/pace.h"
#include "engine/signals.h"
#include "engine/tiers.h"
#include "netlist/location.h"
#include "netlist/netlist.h"
#include "plant/coil.h"

/* A run under way. */
typedef struct coupling {
  const vs_setup *setup;
  const vs_run_order *order;
  vs_pace pace;
  bool measures_errors; /* the solver knows the errors of its own steps: none of the rules here for
                           a rule of second order holds */
  bool stands;          /* it begins at the circuit's operating point */
  vs_swing swing;
  vs_truncation truncation;
  vs_signal_map *names; /* owned */
  vs_trajectory trajectory;
  vs_solver_switch solver_switch;
  vs_settling settling;
  vs_signals_cache port[VS_DECK_MOST]; /* the deck's ports, as they were told last */
  /* What the sources were told at the candidate time that the solver asked for last: it asks for
   * each once per Newton iteration. */
  double asked_s;  /* by the solver's clock; NaN: at none since the last step */
  unsigned asking; /* the number of that time */
  struct {
    unsigned asking; /* when this was told */
    double value;
  } told[VS_DECK_MOST + VS_EVA_PORTS + VS_DECK_MOTIONS];
} coupling;

/* ---- one step ---- */

/* The parts of a step, in their order; each is defined below. */
static double run_time(const coupling *c, double solver_s);
static void forget_told_values(coupling *c);
static vs_status reach_fork_point(coupling *c, double t_s, vs_error *err);
static vs_status follow_macromodel(coupling *c, double t_s, const double *signals, vs_error *err);
static void look_into(const coupling *c, double t_s, const double *signals);
static void take_circuit_state(coupling *c, double t_s, const double *signals);
static vs_status take_operating_point(coupling *c, vs_error *err);
static void judge_step_length(coupling *c);
static vs_status end_settling_cycle(coupling *c, vs_error *err);

/* One coupled step. The solver has accepted a step that ends at solver_s, s by its clock; `signals`
 * are its node voltages, V, and branch currents, A, there, in the order of signal_map.h. */
static vs_status accept_coupled_step(void *ctx, double solver_s, const double *signals,
                                     vs_error *err) {
  coupling *c = ctx;

  /* What the sources were told held for candidates of this step. */
  forget_told_values(c);

  /* The run's clock, s, differs from the solver's by the cycles that it settled for, and by those
   * for which a macromodel stood in for it. */
  double t_s = run_time(c, solver_s);

  /* A study may go on from here with other events, as another run (study/workers/shared_prefix.c).
   */
  vs_status status = reach_fork_point(c, t_s, err);
  if (status) return status;

  /* After a quiet stretch the solver is led to where the macromodel is. As long as it is, the
   * macromodel's steps are the run's (solver_switch.c). */
  if (c->solver_switch.follows) return follow_macromodel(c, t_s, signals, err);

  look_into(c, t_s, signals);

  /* Circuit -> mechanics: lambda, Wb, and its rate, V, at the step's end (signal_map.c). */
  take_circuit_state(c, t_s, signals);
  status = take_operating_point(c, err);
  if (status) return status;

  /* The truncation error of the solver's rule in lambda bounds the next step's length
   * (truncation.c, swing.c). */
  judge_step_length(c);

  /* The machine moves over the same step, by Eq. 54 with F = lambda^2/(4a). Contacts with a stop
   * cut it, a device fires or goes out in it, and the observer is shown it (trajectory.c, anode.c).
   */
  status = vs_trajectory_move(&c->trajectory, err);
  if (status) return status;

  /* A run that begins on a periodic orbit settles first: the end of each cycle is the beginning of
   * the next, with another state of the machine (settling.c). */
  if (c->settling.on) return end_settling_cycle(c, err);

  /* Where only small currents flow, a macromodel of the circuit goes on without the solver, which
   * is quicker (solver_switch.c, macromodel/oneport_macromodel.c). */
  return vs_solver_switch_consider(&c->solver_switch, signals, err);
}

/* An instant within a step that the solver has accepted, by its clock. Whoever looks at the
 * solver's own steps, or may change what is to come, is shown a step that ends there. */
static bool pass_coupled_step(void *ctx, double solver_s, const double *signals) {
  coupling *c = ctx;
  const bool each = c->order->look || c->order->fork || c->settling.on ||
                    c->solver_switch.follows || c->setup->timeline.program ||
                    (c->stands && c->trajectory.blank);
  vs_knot *part = each ? NULL : vs_trajectory_part(&c->trajectory);
  if (!part) return false;
  part->t_s = run_time(c, solver_s);
  vs_signal_map_take_coil(signals, part);
  vs_signal_map_take_terms(&c->setup->deck, signals, part);
  return vs_trajectory_pass(&c->trajectory);
}

/* ---- what a step consists of ---- */

static double run_time(const coupling *c, double solver_s) {
  return vs_settling_time(&c->settling, solver_s, c->solver_switch.shift_s);
}

/* What was told does not hold any more, and where events may change on the way, or another part of
 * the run may have begun, neither does what is told from edge to edge. */
static void forget_told_values(coupling *c) {
  c->asked_s = NAN;
  if (!c->settling.on && !c->order->fork) return;
  c->trajectory.edge = (vs_signals_cache){0};
  memset(c->port, 0, sizeof c->port);
}

/* Tells the fork that t_s is reached. It may change the events of the setup, which are
 * asked for whenever they are needed; only the instant of the jam is kept in the trajectory. It is
 * not called while the run settles, as events come behind that. */
static vs_status reach_fork_point(coupling *c, double t_s, vs_error *err) {
  const vs_fork_point *fork = c->order->fork;
  if (!fork || c->settling.on) return VS_OK;
  vs_status status = fork->reach(fork->ctx, t_s, err);
  c->trajectory.jams_s = vs_setup_jams(c->setup);
  return status;
}

/* What the solver's rule leaves out is not known from steps in which it is led. */
static vs_status follow_macromodel(coupling *c, double t_s, const double *signals, vs_error *err) {
  vs_truncation_restart(&c->truncation);
  return vs_solver_switch_follow(&c->solver_switch, t_s, signals, err);
}

/* Shows the step to the listener, if there is one. Settling is not part of the run. */
static void look_into(const coupling *c, double t_s, const double *signals) {
  const vs_circuit_look *look = c->order->look;
  if (look && !c->settling.on) look->take(look->ctx, t_s, signals + c->names->n_signals);
}

/* Fills the next knot with what the circuit knows of it. Its second derivative of lambda, V/s, is
 * the mean slope of v = dlambda/dt over the step, which is as much as a rule of second order has.
 */
static void take_circuit_state(coupling *c, double t_s, const double *signals) {
  const vs_knot *from = vs_trajectory_last(&c->trajectory);
  vs_knot *next = vs_trajectory_next(&c->trajectory); /* vs_trajectory_move gives it its state */
  next->t_s = t_s;
  vs_signal_map_take_coil(signals, next);
  vs_signal_map_take_terms(&c->setup->deck, signals, next);
  next->flux_rate2_v_s = (next->flux_rate_v - from->flux_rate_v) / (t_s - from->t_s);
  next->flux_rate3_v_s2 = 0; /* not known; a cubic's weight for it is 0 */
}

/* The first knot takes the coil's part of the operating point, which the solver does not show: the
 * leakage current of the switches that are off flows in the coil there. A flux linkage that began
 * at 0 would jump within picoseconds, and eddy currents follow its rate. Error: the coil has more
 * current than that. The machine begins without one, and neither it nor its energy could jump to
 * it. */
static vs_status take_operating_point(coupling *c, vs_error *err) {
  static const double LITTLE = 1e-3, MUCH = 10;
  const vs_knot *from = vs_trajectory_last(&c->trajectory);
  const vs_coil *coil = &c->setup->model.coil;
  vs_knot *next = vs_trajectory_next(&c->trajectory);
  const double peak_v = c->setup->timeline.peak_v,
               most_wb = MUCH * peak_v * (next->t_s - from->t_s) +
                         LITTLE * coil->rest_h * peak_v / coil->resistance_ohm;
  if (!c->stands || from->t_s > 0) return VS_OK;
  if (!(fabs(next->flux_wb - from->flux_wb) > most_wb)) {
    vs_trajectory_stand(&c->trajectory);
    return VS_OK;
  }
  vs_fail(err, VS_RUN,
          "%s, with its switches off, and a run begins without one; a part beside the switch "
          "conducts: is it the wrong way round, or does it break down at or below the supply's "
          "voltage?",
          vs_tiers_on_at_rest);
  err->conducts = true;
  return VS_RUN;
}

/* Takes the step's curvature of v, V/s^2, less what the rule was given back of it, for the length
 * of the steps to come. */
static void judge_step_length(coupling *c) {
  const vs_knot *from = vs_trajectory_last(&c->trajectory),
                *next = vs_trajectory_next(&c->trajectory);
  if (c->measures_errors) { /* when a thyristor fires again is known no better */
    c->swing.seen_wb = fmax(c->swing.seen_wb, fabs(next->flux_wb));
    c->trajectory.strays = vs_anode_strains(&c->trajectory.anode, &c->swing);
    return;
  }
  const vs_truncation_step step = {c->trajectory.frame.model, from, next,
                                   vs_anode_conducts(&c->trajectory.anode)};
  vs_swing_take(&c->swing, from, next, vs_truncation_take_step(&c->truncation, &step), step.driven);
  c->trajectory.strays =
      fmax(vs_swing_strays(&c->swing), vs_anode_strains(&c->trajectory.anode, &c->swing));
}

/* At the end of a settling cycle the clock goes back to 0. Once the orbit is found the run begins
 * there, which its fork is told. */
static vs_status end_settling_cycle(coupling *c, vs_error *err) {
  vs_status status =
      vs_settling_follow(&c->settling, &c->trajectory, &c->solver_switch.shift_s, err);
  return status ? status : reach_fork_point(c, 0, err);
}

/* ---- before a step: how far it may go ---- */

/* Events step a direct supply within this time, s (assumed). A step without a width charges the
 * capacitances of what blocks by a current that only the solver's steps limit. */
static const double SUPPLY_EDGE_S = 1e-6;

static bool supply_has_edges(const coupling *c) {
  const vs_timeline *t = &c->trajectory.setup->timeline;
  return t->supply.direct && t->events.count;
}

/* Where the next edge of a direct supply ends, s. */
static double supply_edge_end(const coupling *c, double now_s) {
  const vs_timeline *t = &c->trajectory.setup->timeline;
  const double behind_s = now_s + vs_signals_near(t, now_s) - SUPPLY_EDGE_S;
  return supply_has_edges(c) ? vs_events_edge(&t->events, behind_s) + SUPPLY_EDGE_S : INFINITY;
}

/* A direct supply at t, V: straight from what it was one edge ago. */
static double direct_supply(const coupling *c, const vs_signal *signal, double t_s) {
  const vs_timeline *t = &c->trajectory.setup->timeline;
  const double before_s = t_s - SUPPLY_EDGE_S, edge_s = vs_events_edge(&t->events, before_s),
               v = vs_signals_voltage(t, signal, t_s);
  if (before_s < 0 || !(edge_s < t_s)) return v;
  const double before_v = vs_signals_voltage(t, signal, before_s);
  return before_v + (v - before_v) * (t_s - edge_s) / SUPPLY_EDGE_S;
}

/* An edge of the mains, of a gate, or of an event ends a step. At once: the solver's rule is to
 * begin anew, as a device has switched or v alternates from step to step. */
static double next_breakpoint(void *ctx, double solver_s) {
  coupling *c = ctx;
  if (c->trajectory.anode.crossed || c->swing.anew) return solver_s;
  double now_s = run_time(c, solver_s), next_s = vs_trajectory_edge(&c->trajectory, now_s);
  if (c->solver_switch.shift_s != 0 && !c->settling.on)
    next_s = fmin(next_s, c->setup->run.until_s);
  next_s = fmin(next_s, supply_edge_end(c, now_s));
  return vs_settling_edge(&c->settling, now_s, next_s) - c->solver_switch.shift_s;
}

/* At t = 0 the circuit is without currents, so mains that are not at their zero jump. What rings by
 * that may have nanoseconds, and the solver takes its first step whatever its error. With a first
 * step of 1e-4 of the largest the least voltage of a chopper's link was 95 V, with 1e-6 80 V, from
 * 1e-7 on, which is the default of run.first_step, 75.9 V at any tolerance. Steps double from there
 * on, so that it costs ten. */
static bool begins_with_a_jump(const coupling *c, double solver_s) {
  return solver_s == 0 && !c->settling.on &&
         vs_timeline_voltage(&c->trajectory.setup->timeline, 0) != 0;
}

/* The least of what run.tolerance (pace.c), the ringing of the coil (swing.c), a device that is
 * about to switch (anode.c) and the events allow, s. */
static double longest_step(void *ctx, double solver_s) {
  coupling *c = ctx;
  vs_trajectory *trajectory = &c->trajectory;
  if (c->measures_errors)
    return vs_events_longest(&trajectory->setup->timeline.events, run_time(c, solver_s));
  double most = fmin(c->pace.max_step_s, vs_swing_longest(&c->swing));
  if (begins_with_a_jump(c, solver_s)) most *= c->setup->run.first_step;
  most = fmin(most, vs_anode_longest(&trajectory->anode, &c->swing, c->pace.max_step_s));
  return fmin(most, vs_events_longest(&trajectory->setup->timeline.events, run_time(c, solver_s)));
}

/* ---- in a step: what drives the circuit ---- */

/* What is given back to the solver's rule, through one of the EVA's ports: V of dlambda/dt, or A of
 * the coil's current. */
static double truncation_correction(coupling *c, size_t port, double t_s) {
  const vs_truncation_try at = {c->trajectory.frame.model, vs_trajectory_last(&c->trajectory), t_s,
                                vs_trajectory_gap(&c->trajectory, t_s)};
  if (c->solver_switch.follows) return 0;
  return port == VS_EVA_PORT_CORRECTS_FLUX ? vs_truncation_flux_correction(&c->truncation, &at)
                                           : vs_truncation_current_correction(&c->truncation, &at);
}

/* A port of the deck, V: mains, a gate, a modulated switch, or an event. A direct supply that was
 * there before t = 0 has found all switches off. */
static double deck_source(coupling *c, size_t port, double t_s) {
  const vs_port *p = &c->setup->deck.ports[port];
  double push_v =
      p->signal.drive == VS_PORT_MAINS ? vs_settling_extra_voltage(&c->settling, t_s) : 0;
  if (t_s == 0 && c->stands && vs_port_is_modulated(&p->signal)) return 0;
  if (p->signal.drive == VS_PORT_MAINS && supply_has_edges(c))
    return direct_supply(c, &p->signal, t_s);
  return push_v +
         vs_signals_voltage_cached(&c->port[port], &c->trajectory.setup->timeline, &p->signal, t_s);
}

/* Ports are in the order of signal_map.h: the deck's, the EVA's, and the motions that the deck
 * names. */
static double compute_source(coupling *c, size_t port, double t_s) {
  size_t of_deck = c->setup->deck.n_ports;
  if (port < of_deck) return deck_source(c, port, t_s);
  if (port == of_deck + VS_EVA_PORT_GAP) return vs_trajectory_gap(&c->trajectory, t_s);
  size_t motion = port + c->setup->deck.n_motions;
  if (motion >= c->names->n_ports)
    return vs_trajectory_motion(&c->trajectory,
                                c->setup->deck.motions[motion - c->names->n_ports].state, t_s);
  if (port >= of_deck + VS_EVA_PORTS_LEADING)
    return vs_solver_switch_lead(&c->solver_switch, port - of_deck, t_s);
  return truncation_correction(c, port - of_deck, t_s);
}

static __attribute__((noinline)) double tell_source(coupling *c, size_t port, double solver_s) {
  if (solver_s != c->asked_s) c->asking++;
  c->asked_s = solver_s;
  c->told[port].asking = c->asking;
  return c->told[port].value = compute_source(c, port, run_time(c, solver_s));
}

static double source_value(void *ctx, size_t port, double solver_s) {
  coupling *c = ctx;
  bool again = solver_s == c->asked_s && c->told[port].asking == c->asking;
  return again ? c->told[port].value : tell_source(c, port, solver_s);
}

/* The machine, for a solver that has it in its equations. */
static void machine_state(void *ctx, double *x) {
  const coupling *c = ctx;
  memcpy(x, vs_trajectory_last(&c->trajectory)->x,
         2 * (size_t)c->trajectory.frame.model->dof * sizeof *x);
}

static void machine_rates(void *ctx, const double *x, double flux_wb, double *rate) {
  const coupling *c = ctx;
  vs_trajectory_rates(&c->trajectory, x, flux_wb, rate);
}

/* The force hangs on the flux linkage alone, and the armature is in no stop and not held. */
static const void *machine_law(void *ctx, const double *x) {
  const vs_trajectory *t = &((const coupling *)ctx)->trajectory;
  const vs_model *m = t->motion.model;
  const bool free = !t->jammed && !vs_stops_touched(&m->stops, vs_mechanics_travel(m, x));
  return m->coil.square && free ? m : NULL;
}

static bool machine_port(void *ctx, size_t port, const double *x, double *value) {
  const coupling *c = ctx;
  const vs_model *m = c->trajectory.frame.model;
  const size_t of_deck = c->setup->deck.n_ports,
               first = c->names->n_ports - c->setup->deck.n_motions;
  if (port == of_deck + VS_EVA_PORT_GAP) {
    *value = vs_coil_gap(&m->coil, vs_mechanics_travel(m, x));
  } else if (port >= first) {
    const int state = c->setup->deck.motions[port - first].state;
    *value = state < 0 ? vs_mechanics_travel(m, x + m->dof) : x[state];
  } else if (port >= of_deck && port < of_deck + VS_EVA_PORTS_LEADING && !c->truncation.on) {
    *value = 0; /* nothing is given back */
  } else {
    return false;
  }
  return true;
}

/* ---- after a step ---- */

static bool run_is_complete(void *ctx) {
  const coupling *c = ctx;
  return !c->settling.on && vs_solver_switch_enough(&c->solver_switch);
}

static double run_time_of_solver(void *ctx, double solver_s) {
  return run_time(ctx, solver_s);
}

static bool step_is_hidden(void *ctx) {
  const coupling *c = ctx;
  return c->settling.on;
}

/* ---- a run ---- */

static void locate_culprit(const void *deck, size_t culprit, vs_error *err) {
  vs_location_locate(deck, culprit, err);
}

/* A circuit that cannot make its first step is no circuit, unless that step is as short as behind a
 * jump: then the solver gave up, and may do with a longer one. */
static vs_status forgive_first_step(const coupling *c, vs_error *err) {
  const vs_error plain = *err;
  if (c->setup->run.first_step >= VS_SETUP_LONGER_FIRST_STEP || !begins_with_a_jump(c, 0) ||
      !strstr(plain.text, "imestep too small"))
    return VS_INPUT;
  vs_fail(err, VS_RUN, "t = 0 s: %s", plain.text);
  err->gave_up = true;
  return VS_RUN;
}

/* A solver that measures its errors has none of its own, but what the scene says. */
static double largest_step(const coupling *c) {
  const bool own = c->measures_errors && !(c->setup->run.max_step_s > 0);
  return own ? INFINITY : c->pace.max_step_s;
}

/* All of the solver's job but its netlist. */
static vs_circuit_job job_of(const coupling *c) {
  const vs_setup *setup = c->setup;
  return (vs_circuit_job){.ports = c->names->ports,
                          .n_ports = c->names->n_ports,
                          .signals = c->names->signals,
                          .n_signals = c->names->n_signals,
                          .n_wanted = 2 * c->names->n_memories,
                          .tolerance = setup->run.tolerance,
                          .until_s = vs_settling_until(&c->settling),
                          .stands = c->stands,
                          .gear = setup->run.gear,
                          .dialect = setup->deck.compat,
                          .max_step_s = largest_step(c),
                          .raw = c->order->raw,
                          .raw_most = setup->limits.raw_bytes,
                          .raw_where = c->order->raw_where,
                          .tried = c->order->tried,
                          .unbegun = c->order->unbegun,
                          .tries = c->order->tries,
                          .steps = c->order->steps,
                          .truncation_factor = c->pace.truncation,
                          .pivot_threshold = setup->run.pivrel,
                          .relative_tolerance = c->pace.relative,
                          .current_tolerance_a = c->pace.current_a,
                          .voltage_tolerance_v = c->pace.voltage_v,
                          .charge_tolerance_c = c->pace.charge_c,
                          .locate = locate_culprit,
                          .author = &setup->deck};
}

/* Appends the signals that the listener wants to the job's own. Returns the list of all, which is
 * to be freed after the run. */
static const char **add_looked_at(const coupling *c, vs_circuit_job *job) {
  const vs_circuit_look *look = c->order->look;
  const char *const *more = NULL;
  size_t count = 0;
  if (look) look->begin(look->ctx, job, &more, &count);
  const char **all = vs_alloc(job->n_signals + count, sizeof *all);
  memcpy(all, job->signals, job->n_signals * sizeof *all);
  if (count) memcpy(all + job->n_signals, more, count * sizeof *all);
  job->signals = all;
  job->n_signals += count;
  job->n_wanted += count;
  return all;
}

/* Takes the deck through the solver, and on to the end if the solver is left for good before it. */
static vs_status run_solver(coupling *c, vs_error *err) {
  const vs_setup *setup = c->setup;
  const vs_circuit_kind *solver = c->order->solver;
  vs_deck_value standard[VS_STANDARD];
  vs_circuit_job job = job_of(c);
  const vs_circuit_host host = {.ctx = c,
                                .source = source_value,
                                .edge = next_breakpoint,
                                .longest = longest_step,
                                .accept = accept_coupled_step,
                                .passes = pass_coupled_step,
                                .enough = run_is_complete,
                                .clock = run_time_of_solver,
                                .hides = step_is_hidden,
                                .machine = {.states = 2 * (size_t)setup->model.dof,
                                            .flux = VS_SIG_FLUX,
                                            .state = machine_state,
                                            .rates = machine_rates,
                                            .linear = machine_law,
                                            .port = machine_port},
                                .map = c->order->pilot ? c->order->pilot->map : NULL};
  char **netlist = NULL;
  void *circuit = NULL;
  vs_setup_standard(setup, standard);
  vs_status s = vs_netlist_make(&setup->deck, &setup->circuit_values, standard, VS_STANDARD,
                                &netlist, &job.lines, err);
  job.netlist = netlist;
  const char **signals = s ? NULL : add_looked_at(c, &job);
  double shortest_s = fmin(c->pace.max_step_s, c->trajectory.motion.substep_touching_s);
  if (!s) s = vs_sim_refuse_endless(setup, shortest_s, err);
  if (!s) s = solver->load(&job, &host, &circuit, err);
  if (!s) s = solver->run(circuit, err);
  if (s == VS_INPUT) s = forgive_first_step(c, err);
  if (!s) s = vs_solver_switch_finish(&c->solver_switch, err);
  solver->free(circuit);
  free(signals);
  vs_netlist_free(netlist, job.lines);
  return s;
}

static vs_status run_coupled(const vs_setup *setup, const vs_run_order *order,
                             const vs_observer *observer, vs_error *err) {
  const vs_frame frame = vs_sim_frame(&vs_coupled_tier, setup);
  /* Nothing is given back in a search for an orbit, which compares cycles from almost the same
   * state: what is given makes steps of their own in each, and the differences would show these.
   * Where the armature meets a stop within a step, what is given comes too late. */
  const vs_pace pace = vs_pace_of(setup);
  coupling c = {.setup = setup, /* stays where it is: the host and the motion point to it */
                .order = order,
                .pace = pace,
                .measures_errors = order->solver->measures_errors,
                .stands = vs_setup_stands(setup),
                .swing = vs_swing_of(setup),
                .truncation = vs_truncation_begin(setup, !order->pilot && !pace.blows &&
                                                             !order->solver->measures_errors),
                .asked_s = NAN,
                .names = vs_alloc(1, sizeof *c.names)};
  vs_settling_begin(&c.settling, setup, order, observer);
  vs_trajectory_begin(&c.trajectory, vs_settling_setup(&c.settling), &frame,
                      vs_settling_observer(&c.settling));
  c.trajectory.frame.timeline = &c.trajectory.setup->timeline;
  c.trajectory.anode.spares = order->spares;
  vs_solver_switch_begin(&c.solver_switch, order, &c.trajectory, c.names, c.pace.max_step_s);
  vs_signal_map_of(&setup->deck, vs_solver_switch_memories(&c.solver_switch), c.names);
  vs_status s = run_solver(&c, err);
  vs_solver_switch_end(&c.solver_switch);
  vs_trajectory_end(&c.trajectory);
  free(c.names);
  return vs_settling_end(&c.settling, s, err);
}

/* These tiers alone have a source's impedance, ngspice, a gate drive that is fed with bursts,
 * switches that are modulated, and devices with means and ratings. */
const vs_tier_key vs_coupled_keys[] = {
    {"supply", "resistance", NULL},
    {"supply", "inductance", NULL},
    {"supply", "decoupling", NULL},
    {"run", "method", NULL},
    {"run", "first_step", NULL},
    {"run", "trtol", NULL},
    {"run", "pivrel", NULL},
    {"run", "leave_circuit", NULL},
    {"run", "ladder", NULL},
    {"run", "verify", "always"},
    {"firing", "burst_frequency", NULL},
    {"firing", "burst_duty", NULL},
    {"pwm", "on", NULL},
    {"pwm", "off", NULL},
    {"pwm", "carrier", NULL},
    {"pwm", "duty", NULL},
    {"pwm", "depth", NULL},
    {"pwm", "frequency", NULL},
    {"pwm", "phase", NULL},
    {"pwm", "dead_time", NULL},
    {"measure", "from", NULL},
    {"measure", "to", NULL},
    {"measure", "last", NULL},
    {NULL, NULL, NULL},
};

const vs_tier vs_coupled_tier = {
    .name = vs_setup_tier_words[VS_TIER_CIRCUIT],
    .text = "the ngspice netlist, F = lambda^2/(4a) from it: anything about devices",
    .finest = 1e-8,
    .automatic = true,
    .has_circuit = true,
    .by_ngspice = true,
    .keys = vs_coupled_keys,
    .run = run_coupled};
