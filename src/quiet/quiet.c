/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "quiet/quiet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "machine/actuator.h"
#include "quiet/walk.h"

/* Cycles that the signals are fitted to: two, as over one a beat may look like the coil's share. */
enum { FIT_CYCLES = 2 };

/* Of run.tolerance: what leaving may cost p, u, w, phi, the force and i. The last quarter is for
 * what comes after: other steps of the solver once it is gone back to (coupling/coupled.c). */
static const double SHARE = 0.75;

/* How much worse than in the cycle that was looked at the one-port may be later. With five, the
 * bound held over the scenes of tests/long/quiet.csv. */
static const double SAFETY = 5;

/* What the integration without the solver may cost, relative to a peak: rkf45's error in the coil's
 * swing, the larger one at the substep that oneport.c takes. */
static const double INTEGRATION = 1e-7;

/* Of run.tolerance: by how much a run that stays in the solver differs from itself, as rounding
 * moves the ends of its steps. */
static const double ITS_OWN = 1e-3;

/* What the circuit remembers may be misfitted by its whole swing: nobody is shown it, and what it
 * does to the coil is in the coil's own misfit. It must only stay as it is. */
static const double HIDDEN_SHARE = 1;

/* A signal that only shows may drift to the end by so many times what it may be wrong by, as a
 * fuse's integral does. One in a store may not: its current would go on changing. */
static const double MOST_DRIFT = 100;

/* A look may cost as much as some of the solver's steps, of which a cycle has hundreds: so it is
 * taken four times a cycle, and later only after a sixteenth of the time that it was in vain. */
static const double LOOKS_PER_CYCLE = 4, IN_VAIN = 16;

/* A tenth more for what the force may add to the energy that is in the machine. */
static const double MAY_TOUCH = 1.1;

/* A step without the solver is at most so much of the fastest mode's swing, rad: the polynomials of
 * degree seven between two knots (sim/step.h) then leave far less than any tolerance. */
static const double STEP_RAD = 0.15;

typedef struct quiet {
  const vs_setup *setup;
  const vs_frame *frame;
  vs_memories memories; /* what the circuit remembers */
  bool blocks;          /* the thyristor, at the last knot */
  vs_record record;
  vs_modal modal;
  vs_oneport *port;
  vs_coil coil[VS_MOST_SEEN];           /* what the one-port says of the knots in view */
  double looked_s, blocks_s;            /* the last look, and since when the thyristor blocks */
  double bound_before[2];               /* of the last look, by law; INFINITY: there was none */
  double carried[VS_STATES], carried_s; /* each mode's error of having left before; as of then */
  double unfitted[VS_SIGNALS];          /* each signal's misfit of the law that it was left by */
  double stepped[VS_SIGNALS];           /* the signals where step() has come */
} quiet;

static void restart(void *self) {
  quiet *q = self;
  vs_record_clear(&q->record);
  q->bound_before[0] = q->bound_before[1] = INFINITY;
}

static void take(void *self, const vs_knot *k, const double *memory, bool blocks) {
  quiet *q = self;
  vs_record_take(&q->record, k, memory, blocks);
  q->blocks = blocks;
  if (blocks) return;
  restart(q);
  q->looked_s = q->blocks_s = k->t_s;
}

/* ---- the one-port beside the solver ---- */

/* By how much it is wrong over the cycle in view, from the state at its first knot. */
typedef struct misfit {
  double force_n, current_a, signal[VS_SIGNALS];
  double mode[VS_STATES]; /* largest share of each mode in the error of q, as vs_mode's shape */
} misfit;

static double electric_bound(const quiet *q, const misfit *wrong) {
  return SAFETY *
         fmax(wrong->force_n / q->record.peak_force_n, wrong->current_a / q->record.peak_a);
}

/* Runs the law beside the solver over the cycle in view. Returns false, and ends there, where force
 * or current are wrong by more than `most` of their peaks. */
static bool compare(quiet *q, double most, misfit *wrong) {
  const vs_model *m = &q->setup->model;
  const vs_record *r = &q->record;
  double y[VS_ONEPORT_STATES];
  *wrong = (misfit){0};
  vs_oneport_state(&r->seen[0]->knot, y);
  for (size_t k = 0; k < r->n_seen; k++) {
    const vs_knot *seen = &r->seen[k]->knot;
    if (k && !vs_oneport_advance(q->port, r->seen[k - 1]->knot.t_s, seen->t_s, y)) return false;
    const vs_coil c = q->coil[k] = vs_oneport_coil(q->port, seen->t_s, y);
    double error[VS_STATES], share[VS_STATES];
    double force = vs_actuator_force(m, c.flux_wb) - vs_actuator_force(m, seen->flux_wb);
    wrong->force_n = fmax(wrong->force_n, fabs(force));
    wrong->current_a = fmax(wrong->current_a, fabs(c.i_a - vs_oneport_knot_current(m, seen)));
    if (!(electric_bound(q, wrong) <= most)) return false;
    for (int n = 0; n < VS_STATES; n++) error[n] = y[n] - seen->x[n];
    vs_modal_shares(&q->modal, error, share);
    for (int n = 0; n < VS_STATES; n++) wrong->mode[n] = fmax(wrong->mode[n], share[n]);
  }
  return true;
}

static void compare_signals(const quiet *q, misfit *wrong) {
  double signal[VS_SIGNALS];
  for (size_t k = 0; k < q->record.n_seen; k++) {
    const vs_seen *seen = q->record.seen[k];
    vs_oneport_signals(q->port, seen->knot.t_s, &q->coil[k], signal);
    for (size_t n = 0; n < vs_record_signals(&q->record); n++)
      wrong->signal[n] =
          fmax(wrong->signal[n], fabs(signal[n] - vs_oneport_seen_signal(q->frame, seen, n)));
  }
}

/* ---- what may come of it ---- */

/* Ten cycles of 50 Hz hold the slowest beats of the mains with a machine that is driven near its
 * resonance. In each 100 instants, 3.6 degrees apart, meet a peak to 5e-4 of it. */
enum { CYCLES_AHEAD = 10, STEPS_AHEAD = 100 };

/* What the one-port says of the cycles to come: its largest flux linkage in each, relative to what
 * was seen, as an error of the flux linkage makes one of the force in proportion to it; and how far
 * they lie beyond what it was fitted to. */
typedef struct outlook {
  double ratio[CYCLES_AHEAD];
  double reach; /* at least 1 */
} outlook;

/* Where the signals and the EVA's voltage were. A law found in there says nothing of what lies
 * outside: there a diode may conduct that did not, or block. */
typedef struct range {
  double least[VS_SIGNALS + 1], most[VS_SIGNALS + 1]; /* the last one: of the EVA */
} range;

/* Sets the range of signal n over the cycle in view, or of the EVA behind the last one: half of how
 * far it went more at either end, for the beat. A signal that drifts has no limits. */
static void see_range_of(const quiet *q, size_t n, range *out) {
  const vs_record *r = &q->record;
  bool of_eva = n == vs_record_signals(r);
  double least = INFINITY, most = -INFINITY;
  for (size_t k = 0; k < r->n_seen; k++) {
    const vs_seen *seen = r->seen[k];
    double value = of_eva ? seen->knot.v_eva_v : vs_oneport_seen_signal(q->frame, seen, n);
    least = fmin(least, value);
    most = fmax(most, value);
  }
  double slack = (most - least) / 2 + (of_eva ? 0 : vs_record_allowed(r, n));
  bool drifts = !of_eva && vs_oneport_drift(q->port, n) != 0;
  out->least[n] = drifts ? -INFINITY : least - slack;
  out->most[n] = drifts ? INFINITY : most + slack;
}

static void see_range(const quiet *q, range *out) {
  for (size_t n = 0; n <= vs_record_signals(&q->record); n++) see_range_of(q, n, out);
}

static bool in_range(const quiet *q, const range *r, double t_s, const vs_coil *c) {
  double signal[VS_SIGNALS];
  size_t count = vs_record_signals(&q->record);
  vs_oneport_signals(q->port, t_s, c, signal);
  for (size_t n = 0; n < count; n++)
    if (!(signal[n] >= r->least[n] && signal[n] <= r->most[n])) return false;
  return c->v_v >= r->least[count] && c->v_v <= r->most[count];
}

/* Follows the law from the last knot on, but not beyond the end. Returns false where it leaves the
 * range that was seen. */
static bool look_ahead(quiet *q, double until_s, outlook *o) {
  double y[VS_ONEPORT_STATES], t = q->record.last.knot.t_s, now = 0;
  double h = q->setup->timeline.period_s / STEPS_AHEAD;
  for (size_t k = 0; k < q->record.n_seen; k++)
    now = fmax(now, fabs(q->record.seen[k]->knot.flux_wb));
  range seen;
  see_range(q, &seen);
  vs_oneport_state(&q->record.last.knot, y);
  *o = (outlook){.reach = 1};
  for (int cycle = 0; cycle < CYCLES_AHEAD && t < until_s; cycle++)
    for (int n = 0; n < STEPS_AHEAD; n++, t += h) {
      if (!vs_oneport_advance(q->port, t, t + h, y)) return false;
      vs_coil c = vs_oneport_coil(q->port, t + h, y);
      if (!in_range(q, &seen, t + h, &c)) return false;
      o->ratio[cycle] = fmax(o->ratio[cycle], fabs(c.flux_wb) / now);
      o->reach = fmax(o->reach, vs_oneport_reach(q->port, t + h, &c));
    }
  return true;
}

/* How often the error a mode took in one cycle may be added up in so many; and, if that error grows
 * by `walked` in each, how often that. */
static double times_added(const outlook *o, const vs_mode *m, double cycles, double period_s,
                          double *walked) {
  double sum = 0, rest = fmax(cycles - CYCLES_AHEAD, 0), last = o->ratio[CYCLES_AHEAD - 1];
  *walked = 0;
  for (int n = 0; n < CYCLES_AHEAD && n < cycles; n++) {
    sum += o->ratio[n];
    *walked += (n + 1) * o->ratio[n];
  }
  double held = -1 / expm1(-period_s / m->time_constant_s), from = CYCLES_AHEAD;
  if (isfinite(m->time_constant_s) && held < rest) {
    from = cycles - held;
    rest = held;
  }
  *walked = o->reach * (*walked + rest * (from + cycles) / 2 * last);
  return o->reach * (sum + rest * last);
}

/* Each mode's error until_s: what it still has of having left before, and what it takes in a cycle,
 * added up in the same sense. Without `ahead` it is added once; w may be NULL too. */
static void mode_errors(const quiet *q, const misfit *wrong, const vs_walk *w, const outlook *ahead,
                        double until_s, double error[VS_STATES]) {
  double period = q->setup->timeline.period_s, now = q->record.last.knot.t_s;
  for (size_t k = 0; k < VS_STATES; k++) {
    const vs_mode *m = &q->modal.mode[k];
    double walked = 0, times = 1;
    if (ahead) times = times_added(ahead, m, (until_s - now) / period, period, &walked);
    error[k] = q->carried[k] * exp(m->re_1_s * (now - q->carried_s)) +
               SAFETY * wrong->mode[k] * times + (w ? w->mode[k] * walked : 0);
  }
}

/* Largest part of its peak by which p, u, w or phi is wrong with these errors. */
static double motion_bound(const quiet *q, const double error[VS_STATES]) {
  double worst = 0;
  for (int n = 0; n < VS_DOF; n++) {
    double sum = 0;
    for (size_t k = 0; k < VS_STATES; k++)
      sum += hypot(q->modal.mode[k].shape_re[n], q->modal.mode[k].shape_im[n]) * error[k];
    worst = fmax(worst, sum / q->record.peak_x[n]);
  }
  return worst;
}

static bool in_a_store(const quiet *q, size_t term) {
  const vs_accounts *stores = &q->frame->deck->stores;
  for (size_t k = 0; k < stores->count; k++)
    if (vs_formula_uses(&stores->item[k].formula, (int)term)) return true;
  return false;
}

/* Does signal n do as it did, to the end? An integral that only shows may drift on. */
static bool signal_holds(const quiet *q, size_t n, double misfit_now, double until_s) {
  const vs_record *r = &q->record;
  size_t terms = vs_record_terms(r);
  double most = vs_record_allowed(r, n), misfit_most = most;
  double drift = fabs(vs_oneport_drift(q->port, n)) * (until_s - r->last.knot.t_s);
  double times = n < terms && !in_a_store(q, n) ? MOST_DRIFT : 1;
  if (n > terms) { /* the bias of a capacitor that begins charged counts here */
    double bias = fmax(r->most[n - terms - 1], -r->least[n - terms - 1]);
    most = fmax(most, vs_record_share(r) * bias);
    misfit_most = fmax(most, HIDDEN_SHARE * r->peak_signal[n]);
  }
  return misfit_now <= misfit_most && drift <= times * most;
}

static bool signals_hold(const quiet *q, const misfit *wrong, double until_s) {
  for (size_t n = 0; n < vs_record_signals(&q->record); n++)
    if (!signal_holds(q, n, wrong->signal[n], until_s)) return false;
  return true;
}

/* ---- the bound ---- */

/* Fits the law to the last cycle, compares it there, and looks ahead. Returns false where the law
 * is not to be gone by. What costs most, the signals and the look ahead, comes last. */
static bool find_law(quiet *q, bool dynamic, double until_s, misfit *wrong, outlook *ahead) {
  vs_record *r = &q->record;
  double most = SHARE * q->setup->run.tolerance, error[VS_STATES];
  if (!vs_record_view(r, 1, 0) || !vs_oneport_fit(q->port, r->seen, r->n_seen, dynamic))
    return false;
  if (!compare(q, most, wrong)) return false;
  mode_errors(q, wrong, NULL, NULL, until_s, error);
  if (!(motion_bound(q, error) <= most)) return false;
  if (!vs_record_view(r, FIT_CYCLES, 0) || !vs_oneport_fit_signals(q->port, r->seen, r->n_seen))
    return false;
  vs_record_view(r, 1, 0);
  compare_signals(q, wrong);
  return signals_hold(q, wrong, until_s) && look_ahead(q, until_s, ahead);
}

/* The bound on p, u, w, phi, force and i if the law walks on like that, and each mode's error
 * until_s. Returns INFINITY where it is more than leaving may cost. */
static double machine_bound(const quiet *q, const misfit *wrong, const vs_walk *w,
                            const outlook *ahead, double until_s, double error[VS_STATES]) {
  double cycles = (until_s - q->record.last.knot.t_s) / q->setup->timeline.period_s;
  mode_errors(q, wrong, w, ahead, until_s, error);
  double electric =
      ahead->reach * electric_bound(q, wrong) + vs_walk_electric(&q->record, w, cycles);
  double bound = fmax(electric, motion_bound(q, error));
  return bound <= SHARE * q->setup->run.tolerance ? bound : INFINITY;
}

/* The bound with that law, and each mode's error until_s; INFINITY: it is not to be gone by. The
 * smallest of the bounds by the walks from each earlier cycle counts: one is enough to hold by. */
static double bound_of(quiet *q, bool dynamic, double until_s, double error[VS_STATES]) {
  double best = INFINITY, tried[VS_STATES];
  misfit wrong;
  outlook ahead;
  vs_walk_shares fitted;
  vs_walk walk;
  if (!find_law(q, dynamic, until_s, &wrong, &ahead)) return INFINITY;
  double cycles = (until_s - q->record.last.knot.t_s) / q->setup->timeline.period_s;
  vs_walk_shares_of(&q->record, q->port, &fitted);
  for (int ago = 1; ago < VS_CYCLES_KEPT && !(best <= vs_record_share(&q->record)); ago++) {
    if (!vs_walk_find(&q->record, q->port, &q->modal, &fitted, ago, &walk)) break;
    double bound = vs_walk_signals(&q->record, q->port, &q->modal, wrong.signal, &walk, cycles);
    if (isinf(bound)) break;
    bound = fmax(bound, machine_bound(q, &wrong, &walk, &ahead, until_s, tried));
    if (!(bound < best)) continue;
    best = bound;
    memcpy(error, tried, sizeof tried);
    memcpy(q->unfitted, wrong.signal, sizeof q->unfitted);
  }
  return best;
}

/* Can the armature come to its stop, or to the pole cover, with the energy that is in the machine?
 * |p| <= sqrt(2 E (K^-1)_pp). */
static bool may_touch(const quiet *q, const vs_knot *k) {
  const vs_model *m = &q->setup->model;
  double energy = vs_mechanics_kinetic_energy(m, k->x) + vs_mechanics_elastic_energy(m, k->x);
  double compliance = 1 / m->stiffness[P][P]; /* p is coupled to the others by mass alone */
  return MAY_TOUCH * sqrt(2 * energy * compliance) > m->actuator.gap_m;
}

static bool gate_is_on(const quiet *q, double t_s) {
  const vs_deck *deck = &q->setup->deck;
  for (size_t k = 0; k < deck->n_ports; k++) {
    const vs_signal *s = &deck->ports[k].signal;
    if (s->drive != VS_DRIVE_GATE && s->drive != VS_DRIVE_BURST) continue;
    if (vs_gate_is_on(&q->setup->timeline, s->shift_rad, t_s)) return true;
  }
  return false;
}

/* Does anything happen at the last knot that the law knows nothing of: does the thyristor conduct,
 * is a gate on, does an event go on? */
static bool something_is_on(const quiet *q) {
  double now = q->record.last.knot.t_s;
  return !q->blocks || gate_is_on(q, now) ||
         isfinite(vs_events_longest(&q->setup->timeline.events, now));
}

/* Is it time for a look? Only when two cycles are known, and one at least is to come. */
static bool is_due(const quiet *q, double until_s) {
  double period = q->setup->timeline.period_s, now = q->record.last.knot.t_s;
  if (q->record.blind || !vs_record_two_cycles(&q->record)) return false;
  double wait_s = fmax(period / LOOKS_PER_CYCLE, (now - q->blocks_s) / IN_VAIN);
  return !(now < q->looked_s + wait_s || until_s < now + period);
}

/* A bound must hold at two looks in a row, so the larger of the two counts. While the law with G
 * and C holds for the first time, the one without is not tried in its place. */
static bool may_leave(void *self, double until_s, double most_lag_s, double *bound) {
  quiet *q = self;
  double most = vs_record_share(&q->record), error[VS_STATES];
  if (something_is_on(q) || !is_due(q, until_s) || may_touch(q, &q->record.last.knot)) return false;
  q->looked_s = q->record.last.knot.t_s;
  for (int dynamic = 1; dynamic >= 0; dynamic--) {
    double before = q->bound_before[dynamic];
    q->bound_before[dynamic] = bound_of(q, dynamic, until_s, error);
    *bound =
        INTEGRATION + ITS_OWN * q->setup->run.tolerance + fmax(before, q->bound_before[dynamic]);
    if (vs_oneport_lag(q->port) > most_lag_s) continue;
    if (q->bound_before[dynamic] <= most && !(*bound <= most)) return false;
    if (!(*bound <= most)) continue;
    memcpy(q->carried, error, sizeof error);
    q->carried_s = until_s;
    return true;
  }
  return false;
}

/* ---- going by it ---- */

static vs_status step(void *self, vs_knot *k, double t_s, vs_error *err) {
  quiet *q = self;
  double y[VS_ONEPORT_STATES], signal[VS_SIGNALS];
  vs_oneport_state(k, y);
  if (!vs_oneport_advance(q->port, k->t_s, t_s, y))
    return vs_fail(err, VS_RUN, "t = %.9g s: GSL cannot step on", t_s);
  vs_coil c = vs_oneport_coil(q->port, t_s, y);
  vs_oneport_signals(q->port, t_s, &c, signal);
  k->t_s = t_s;
  memcpy(k->x, y, sizeof k->x);
  k->flux_wb = c.flux_wb;
  k->flux_rate_v = c.flux_rate_v;
  k->flux_rate2_v_s = c.v_rate_v_s - q->setup->model.actuator.resistance_ohm * c.i_rate_a_s;
  k->v_eva_v = c.v_v;
  memcpy(k->terms, signal, vs_record_terms(&q->record) * sizeof *signal);
  k->i_mains_a = signal[vs_record_terms(&q->record)];
  memcpy(q->stepped, signal, vs_record_signals(&q->record) * sizeof *signal);
  vs_knot_complete(q->frame, k, false);
  return VS_OK;
}

static double capacitance(const void *self) {
  const quiet *q = self;
  return vs_oneport_capacitance(q->port);
}

/* A memory may miss by twice what the law said of it wrongly from the first: it left from such an
 * error, and comes back to one. */
static double missed(const void *self, const vs_knot *own, const vs_knot *solver,
                     const double *memory) {
  const quiet *q = self;
  size_t terms = vs_record_terms(&q->record);
  const vs_seen a = {.knot = *own, .memory = q->stepped + terms + 1},
                b = {.knot = *solver, .memory = memory};
  double worst = 0;
  for (size_t n = 0; n < vs_record_signals(&q->record); n++) {
    if (vs_oneport_drift(q->port, n) != 0) continue; /* an integral: the solver's stood still */
    double off = vs_oneport_seen_signal(q->frame, &b, n) - vs_oneport_seen_signal(q->frame, &a, n);
    double hidden = n > terms ? 2 * q->unfitted[n] : 0;
    worst = fmax(worst, fabs(off) / fmax(vs_record_allowed(&q->record, n), hidden));
  }
  return worst;
}

/* (w h)^2/8 is what a straight line leaves of a sine. */
static double longest(const void *self) {
  const quiet *q = self;
  double h = sqrt(8 * q->setup->run.tolerance) / q->setup->timeline.omega_rad_s;
  return fmin(h, STEP_RAD / q->setup->model.fastest_rad_s);
}

/* ---- begun and ended ---- */

/* Not where the armature jams, where the deck tells the time by itself, or where it keeps a state
 * or a store that is not seen. */
static bool can_stand_in(const vs_setup *setup, vs_memories *memories) {
  const vs_deck *deck = &setup->deck;
  return isinf(vs_setup_jams(setup)) && !deck->own_clock && deck->stores.count &&
         !vs_netlist_hides_state(deck) && vs_memory_list(deck, memories);
}

/* may_touch() takes (K^-1)_pp for 1/K_pp. */
static bool springs_leave_p_alone(const vs_model *m) {
  for (int k = 0; k < VS_DOF; k++)
    if (k != P && m->stiffness[P][k] != 0) return false;
  return true;
}

static void end(void *self) {
  quiet *q = self;
  if (!q) return;
  vs_modal_end(&q->modal);
  vs_oneport_free(q->port);
  vs_record_end(&q->record);
  free(q);
}

static void *begin(const vs_setup *setup, const vs_frame *frame) {
  quiet *q = vs_alloc(1, sizeof *q);
  *q = (quiet){.setup = setup, .frame = frame};
  if (!springs_leave_p_alone(&setup->model) || !can_stand_in(setup, &q->memories)) {
    free(q);
    return NULL;
  }
  vs_record_begin(&q->record, setup, frame, &q->memories);
  q->port = vs_oneport_new(setup, frame, q->memories.count);
  restart(q);
  if (vs_modal_begin(&q->modal, &setup->model)) return q;
  end(q);
  return NULL;
}

static const vs_memories *memories(const void *self) {
  return &((const quiet *)self)->memories;
}

const vs_stand_in vs_quiet_stand_in = {.begin = begin,
                                       .end = end,
                                       .memories = memories,
                                       .take = take,
                                       .may_leave = may_leave,
                                       .longest = longest,
                                       .step = step,
                                       .capacitance = capacitance,
                                       .missed = missed,
                                       .restart = restart};
