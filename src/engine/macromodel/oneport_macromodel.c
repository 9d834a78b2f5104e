/* SPDX-License-Identifier: GPL-3.0-or-later
 * Decides when the circuit tier may leave the circuit's solver, and goes on in its place: the
 * macromodel that the program has (macromodel.h).
 *
 * Behind the last firing a scene is quiet: all that flows is a small current through the snubbers.
 * That current follows a simple law, a one-port with a periodic source (oneport.h), which is far
 * quicker to integrate than the netlist. The law is fitted to the last cycle of the mains. The
 * solver is left only if the law's error is bounded up to the time at which the solver comes back:
 *
 *  - The law is run beside the solver over the last cycle, from the same state. Its error there,
 *    times five for what that cycle may not show, is added up over all the cycles to come, always
 *    in the same sense. It is added up less as the flux linkage falls and as the machine's modes
 *    decay.
 *  - The law is compared with earlier cycles, which shows how fast it goes wrong (law_drift.h).
 *  - Every signal must stay in the range in which the solver showed it, widened at either end by
 *    half of that range.
 *  - The bound must hold at two looks in a row, as one alone may look right by chance.
 *
 * The solver is never left where the armature jams or the load changes; where the deck tells the
 * time by itself; where it has no store, or a state that nobody sees; or where the machine has
 * springs between p and the other coordinates. It is not left while the thyristor conducts, a gate
 * is on, or an event needs short steps.
 *
 * A look costs as much as some of the solver's steps, so the question is answered at most four
 * times a cycle, and only where two cycles are known and at least one is to come. The bound on the
 * machine and the coil is within three quarters of run.tolerance; the rest is left to the other
 * steps that the solver takes when it is gone back to. A signal of the deck may
 * be wrong by three times run.tolerance in all: linear interpolation between knots uses one of the
 * three already.
 *
 * record.h keeps what the solver showed; modal.h splits the machine's error into its modes. */
#include "macromodel/macromodel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/events.h"
#include "engine/gate.h"
#include "macromodel/law_drift.h"
#include "macromodel/modal.h"
#include "macromodel/record.h"
#include "plant/coil.h"

/* ---- what the law says of the time to come ----
 *
 * What a one-port's law (oneport.h) says of the cycles of the mains to come, and what its errors
 * may add up to in them. */

/* Ten cycles of 50 Hz hold the slowest beats of the mains with a machine that is driven near its
 * resonance. In each of them 100 instants, 3.6 degrees apart, meet a peak to 5e-4 of it. */
enum { FORECAST_CYCLES = 10, FORECAST_STEPS = 100 };

typedef struct forecast {
  /* The largest flux linkage in each cycle, relative to the largest in view: an error of the flux
   * linkage makes one of the force in proportion to it. 0 for a cycle behind the end. */
  double ratio[FORECAST_CYCLES];
  double reach; /* how far these cycles lie beyond what the law was fitted to (vs_oneport_reach);
                   at least 1 */
} forecast;

/* Where the signals may go, and behind the last of them the EVA's voltage. */
typedef struct range {
  double least[VS_SIGNALS + 1], most[VS_SIGNALS + 1];
} range;

/* Sets the range of signal n, or of the EVA's voltage behind the last one: as far as it went over
 * the cycle in view, and half of that more at either end, for the beat of the machine with the
 * mains. A signal that drifts has no limits. */
static void see_range_of(const vs_record *r, const vs_oneport *port, size_t n, range *out) {
  bool of_eva = n == vs_record_signals(r);
  double least = INFINITY, most = -INFINITY;
  for (size_t k = 0; k < r->n_seen; k++) {
    const vs_observation *seen = r->seen[k];
    double value = of_eva ? seen->knot.v_eva_v : vs_responses_seen(r->frame, seen, n);
    least = fmin(least, value);
    most = fmax(most, value);
  }
  double slack = (most - least) / 2 + (of_eva ? 0 : vs_record_allowed(r, n));
  bool drifts = !of_eva && vs_responses_drift(vs_oneport_responses(port), n) != 0;
  out->least[n] = drifts ? -INFINITY : least - slack;
  out->most[n] = drifts ? INFINITY : most + slack;
}

static void see_range(const vs_record *r, const vs_oneport *port, range *out) {
  for (size_t n = 0; n <= vs_record_signals(r); n++) see_range_of(r, port, n, out);
}

static bool in_range(const vs_record *r, const vs_oneport *port, const range *seen, double t_s,
                     const vs_coil_state *c) {
  double signal[VS_SIGNALS];
  size_t count = vs_record_signals(r);
  vs_responses_at(vs_oneport_responses(port), t_s, c, signal);
  for (size_t n = 0; n < count; n++)
    if (!(signal[n] >= seen->least[n] && signal[n] <= seen->most[n])) return false;
  return c->v_v >= seen->least[count] && c->v_v <= seen->most[count];
}

static double largest_flux(const vs_record *r) {
  double most = 0;
  for (size_t k = 0; k < r->n_seen; k++) most = fmax(most, fabs(r->seen[k]->knot.flux_wb));
  return most;
}

/* Follows the law from the record's last knot on, but not beyond until_s. Returns false where GSL
 * cannot integrate, or where a signal or the EVA's voltage leaves the range that it had over the
 * cycle in view: a law found there says nothing of what lies outside, as a diode may conduct there
 * that did not, or block. */
static bool find_forecast(const vs_record *r, vs_oneport *port, double until_s, forecast *o) {
  double y[VS_ONEPORT_STATES], t = r->last.knot.t_s, now = largest_flux(r);
  double h = r->setup->timeline.period_s / FORECAST_STEPS;
  range seen;
  see_range(r, port, &seen);
  vs_oneport_state(&r->last.knot, y);
  *o = (forecast){.reach = 1};
  for (int cycle = 0; cycle < FORECAST_CYCLES && t < until_s; cycle++)
    for (int n = 0; n < FORECAST_STEPS; n++, t += h) {
      if (!vs_oneport_advance(port, t, t + h, y)) return false;
      vs_coil_state c = vs_oneport_coil(port, t + h, y);
      if (!in_range(r, port, &seen, t + h, &c)) return false;
      o->ratio[cycle] = fmax(o->ratio[cycle], fabs(c.flux_wb) / now);
      o->reach = fmax(o->reach, vs_oneport_reach(port, t + h, &c));
    }
  return true;
}

/* Behind the cycles that were looked at, the last one's ratio goes on. A mode that decays holds no
 * more than its errors of 1/(1 - exp(-T/tau)) cycles: the sum of a geometric series. */
static double forecast_times(const forecast *o, const vs_mode *m, double cycles, double period_s,
                             double *drifted) {
  double sum = 0, rest = fmax(cycles - FORECAST_CYCLES, 0);
  double last = o->ratio[FORECAST_CYCLES - 1], from = FORECAST_CYCLES;
  *drifted = 0;
  for (int n = 0; n < FORECAST_CYCLES && n < cycles; n++) {
    sum += o->ratio[n];
    *drifted += (n + 1) * o->ratio[n];
  }
  double held = -1 / expm1(-period_s / m->time_constant_s);
  if (isfinite(m->time_constant_s) && held < rest) {
    from = cycles - held;
    rest = held;
  }
  *drifted = o->reach * (*drifted + rest * (from + cycles) / 2 * last);
  return o->reach * (sum + rest * last);
}

/* ---- how wrong the law is now ----
 *
 * How wrong a one-port's law (oneport.h) is over the cycle of the mains that is in view (record.h),
 * where it is run beside the solver from the same state. */

/* The largest errors at any knot in view. */
typedef struct misfit {
  double force_n, current_a; /* of the coil */
  double
      mode[VS_MOST_STATES];  /* share of each mode in the error of (q, q'), in units of its shape */
  double signal[VS_SIGNALS]; /* V or A */
  vs_coil_state coil[VS_MOST_SEEN]; /* what the law says of the coil at each knot in view */
} misfit;

/* That multiple: how much worse than in the cycle in view the law may be later. With five, the
 * bound on leaving the solver held over the scenes of tests/long/quiet.csv. */
static const double misfit_safety = 5;

/* The error of the coil's force or current, whichever is worse, relative to its peak, that the law
 * may make later: a multiple of the one found. */
static double electric_misfit(const vs_record *r, const misfit *wrong) {
  return misfit_safety * fmax(wrong->force_n / r->peak_force_n, wrong->current_a / r->peak_a);
}

static void compare_modes(const vs_modal *modal, const double y[VS_ONEPORT_STATES],
                          const vs_knot *seen, misfit *wrong) {
  double error[VS_MOST_STATES], share[VS_MOST_STATES];
  int states = (int)modal->share->size;
  for (int n = 0; n < states; n++) error[n] = y[VS_ONEPORT_Q + n] - seen->x[n];
  vs_modal_shares(modal, error, share);
  for (int n = 0; n < states; n++) wrong->mode[n] = fmax(wrong->mode[n], share[n]);
}

/* Runs the law beside the solver, and fills all but `signal`. Returns false, and ends there, where
 * misfit_electric exceeds `most` or GSL cannot integrate. */
static bool find_misfit(const vs_record *r, vs_oneport *port, const vs_modal *modal, double most,
                        misfit *wrong) {
  const vs_model *m = &r->setup->model;
  double y[VS_ONEPORT_STATES];
  *wrong = (misfit){0};
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
    if (!(electric_misfit(r, wrong) <= most)) return false;
    compare_modes(modal, y, seen, wrong);
  }
  return true;
}

/* Then fills `signal`; needs vs_oneport_fit_signals. */
static void find_misfit_of_signals(const vs_record *r, const vs_oneport *port, misfit *wrong) {
  double signal[VS_SIGNALS];
  for (size_t k = 0; k < r->n_seen; k++) {
    const vs_observation *seen = r->seen[k];
    vs_responses_at(vs_oneport_responses(port), seen->knot.t_s, &wrong->coil[k], signal);
    for (size_t n = 0; n < vs_record_signals(r); n++)
      wrong->signal[n] =
          fmax(wrong->signal[n], fabs(signal[n] - vs_responses_seen(r->frame, seen, n)));
  }
}

/* ---- when the solver may be left ---- */

/* Cycles that the signals are fitted to. Over one alone a beat of the machine with the mains may
 * look like the coil's share in a signal. */
enum { FIT_CYCLES = 2 };

/* Relative to run.tolerance: what leaving may cost p, u, w, phi, the force and i. The last quarter
 * is for the other steps that the solver takes once it is gone back to
 * (engine/coupled/solver_switch.c). */
static const double SHARE = 0.75;

/* Relative to a peak: what the integration without the solver may cost. It is rkf45's error in the
 * coil's swing at the substep that oneport.c takes, which is larger than that in the machine's. */
static const double INTEGRATION = 1e-7;

/* Relative to run.tolerance: by how much a run that stays in the solver differs from another such
 * run, as rounding moves the ends of its steps. */
static const double ITS_OWN = 1e-3;

/* The law may be wrong of what the circuit remembers by as much as that swings: nobody is shown it,
 * and what it does to the coil is in the coil's own misfit. It must only stay as it is. */
static const double HIDDEN_SHARE = 1;

/* A signal that only shows, as a fuse's integral, may drift until the end by this many times what
 * it may be wrong by. A signal in a store may not: its current would go on changing. */
static const double MOST_DRIFT = 100;

/* There are four looks in a cycle at most, and never two within a sixteenth of the time since the
 * thyristor blocks. */
static const double LOOKS_PER_CYCLE = 4, IN_VAIN = 16;

/* A look costs as much as so many of the solver's steps. Counted in instructions, of
 * halfwave_snubbed: 190 with the knots of coarse steps, 270 with as many knots as are kept. */
static const double LOOK_STEPS = 200;

/* A tenth more for what the force may add to the energy that is in the machine. */
static const double MAY_TOUCH = 1.1;

/* A step without the solver is at most this much of the fastest mode's swing, rad. The polynomials
 * of degree seven between two knots (engine/step.h) then leave far less than any tolerance. */
static const double STEP_RAD = 0.15;

typedef struct quiet {
  const vs_setup *setup;
  const vs_frame *frame;
  vs_circuit_states memories; /* what the circuit remembers */
  bool blocks;                /* the thyristor, at the last knot */
  vs_record record;
  vs_modal modal;
  vs_oneport *port;
  misfit misfit;             /* of the law that is looked at */
  double looked_s, blocks_s; /* time of the last look; since when the thyristor blocks */
  double steps; /* of the solver, of late: a step a cycle ago counts for 1/e. In a steady pace that
                   is how many a cycle takes */
  double bound_before[2]; /* the bound at the last look, by the law without G and C [0] and with
                             them [1]; INFINITY: there was none */
  double
      carried[VS_MOST_STATES]; /* each mode's error of having left before, at the time carried_s */
  double carried_s;
  double unfitted[VS_SIGNALS]; /* each signal's misfit of the law by which the solver was left */
  double stepped[VS_SIGNALS];  /* the signals at the instant to which step_macromodel() has come */
} quiet;

static void restart_macromodel(void *self) {
  quiet *q = self;
  vs_record_clear(&q->record);
  q->bound_before[0] = q->bound_before[1] = INFINITY;
}

static void record_solver_knot(void *self, const vs_knot *k, const double *memory, bool blocks) {
  quiet *q = self;
  double gone_s = q->record.any ? k->t_s - q->record.last.knot.t_s : 0;
  q->steps = 1 + q->steps * fmax(0, 1 - gone_s / q->setup->timeline.period_s);
  vs_record_take(&q->record, k, memory, blocks);
  q->blocks = blocks;
  if (blocks) return;
  restart_macromodel(q);
  q->looked_s = q->blocks_s = k->t_s;
}

/* ---- the errors until the solver is gone back to ---- */

/* Gives each mode's error at until_s: what is left of having left before, and what the mode takes
 * in a cycle, added up over all cycles in the same sense. Without `ahead` (NULL) that is added
 * once, and without w (NULL) the law does not drift. */
static void mode_errors(const quiet *q, const vs_law_drift *w, const forecast *ahead,
                        double until_s, double error[VS_MOST_STATES]) {
  double period = q->setup->timeline.period_s, now = q->record.last.knot.t_s;
  for (size_t k = 0; k < q->modal.share->size; k++) {
    const vs_mode *m = &q->modal.mode[k];
    double drifted = 0, times = 1;
    if (ahead) times = forecast_times(ahead, m, (until_s - now) / period, period, &drifted);
    error[k] = q->carried[k] * exp(m->re_1_s * (now - q->carried_s)) +
               misfit_safety * q->misfit.mode[k] * times + (w ? w->mode[k] * drifted : 0);
  }
}

/* How wrong a coordinate is with these errors of the modes, relative to its peak; the worst. */
static double motion_bound(const quiet *q, const double error[VS_MOST_STATES]) {
  double worst = 0;
  for (int n = 0; n < q->setup->model.dof; n++) {
    double sum = 0;
    for (size_t k = 0; k < q->modal.share->size; k++)
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

/* Relative to a switch's control: how near to its level it may come besides its drift. A loose
 * tolerance says nothing of that. */
static const double REACH = 1e-3;

/* True where signal n, which turns something over at a threshold, could drift there, or back over a
 * threshold that it crosses in each cycle: where an extreme that the solver showed in the view lies
 * nearer to it than the drift, V or A, and a share of the signal. Where the threshold is unknown,
 * or a formula may make more of the drift, the signal may drift no further than a share of its
 * swing in the view: what it went through before, as a capacitor that was charged, says nothing of
 * what that makes of it. */
static bool may_turn_over(const quiet *q, size_t n, double drift) {
  const vs_record *r = &q->record;
  size_t memory = n - vs_record_terms(r) - 1;
  const vs_circuit_state *m = &q->memories.item[memory];
  double least = INFINITY, most = -INFINITY;
  for (size_t k = 0; k < r->n_seen; k++) {
    least = fmin(least, r->seen[k]->memory[memory]);
    most = fmax(most, r->seen[k]->memory[memory]);
  }
  if (m->threshold == VS_THRESHOLD_UNKNOWN) return drift > vs_record_share(r) * (most - least) / 2;
  const double reach = drift + fmin(vs_record_share(r), REACH) * fmax(most, -least);
  for (int k = 0; k < 2; k++)
    if (!(fabs(m->level[k] - least) > reach && fabs(m->level[k] - most) > reach)) return true;
  return false;
}

/* True if signal n goes on as it did, until the end. An integral that only shows may drift. */
static bool signal_holds(const quiet *q, size_t n, double until_s) {
  const vs_record *r = &q->record;
  double misfit_now = q->misfit.signal[n];
  size_t terms = vs_record_terms(r);
  double most = vs_record_allowed(r, n), misfit_most = most;
  double drift =
      fabs(vs_responses_drift(vs_oneport_responses(q->port), n)) * (until_s - r->last.knot.t_s);
  double times = n < terms && !in_a_store(q, n) ? MOST_DRIFT : 1;
  if (n > terms) { /* a memory: the bias of a capacitor that begins charged counts too */
    double bias = fmax(r->most[n - terms - 1], -r->least[n - terms - 1]);
    most = fmax(most, vs_record_share(r) * bias);
    misfit_most = fmax(most, HIDDEN_SHARE * r->peak_signal[n]);
    if (vs_record_is_control(r, n)) return !may_turn_over(q, n, drift);
  }
  return misfit_now <= misfit_most && drift <= times * most;
}

static bool signals_hold(const quiet *q, double until_s) {
  for (size_t n = 0; n < vs_record_signals(&q->record); n++)
    if (!signal_holds(q, n, until_s)) return false;
  return true;
}

/* ---- the bound ---- */

/* Fits the law to the last cycle, compares it with the solver there, and looks ahead. Returns false
 * where the law is not good enough. What costs most, the signals and the look ahead, comes last. */
static bool fit_law_of_circuit(quiet *q, bool dynamic, double until_s, forecast *ahead) {
  vs_record *r = &q->record;
  double most = SHARE * q->setup->run.tolerance, error[VS_MOST_STATES];
  if (!vs_record_view(r, 1, 0) || !vs_oneport_fit(q->port, r->seen, r->n_seen, dynamic))
    return false;
  if (!find_misfit(r, q->port, &q->modal, most, &q->misfit)) return false;
  mode_errors(q, NULL, NULL, until_s, error);
  if (!(motion_bound(q, error) <= most)) return false;
  if (!vs_record_view(r, FIT_CYCLES, 0) || !vs_oneport_fit_signals(q->port, r->seen, r->n_seen))
    return false;
  vs_record_view(r, 1, 0);
  find_misfit_of_signals(r, q->port, &q->misfit);
  return signals_hold(q, until_s) && find_forecast(r, q->port, until_s, ahead);
}

/* Returns the bound on p, u, w, phi, force and i if the law drifts on like that, and gives each
 * mode's error at until_s. The bound is INFINITY where it is more than leaving may cost. */
static double machine_bound(const quiet *q, const vs_law_drift *w, const forecast *ahead,
                            double until_s, double error[VS_MOST_STATES]) {
  double cycles = (until_s - q->record.last.knot.t_s) / q->setup->timeline.period_s;
  mode_errors(q, w, ahead, until_s, error);
  double electric = ahead->reach * electric_misfit(&q->record, &q->misfit) +
                    vs_law_drift_electric(&q->record, w, cycles);
  double bound = fmax(electric, motion_bound(q, error));
  return bound <= SHARE * q->setup->run.tolerance ? bound : INFINITY;
}

/* Returns the bound with the law with G and C (dynamic) or the one without, and gives each mode's
 * error at until_s. INFINITY: that law is not good enough. Each earlier cycle gives a drift, and
 * each drift a bound; as one bound is enough to hold by, the smallest counts. */
static double bound_of_law(quiet *q, bool dynamic, double until_s, double error[VS_MOST_STATES]) {
  double best = INFINITY, tried[VS_MOST_STATES];
  forecast ahead;
  vs_law_drift_shares fitted;
  vs_law_drift drift;
  if (!fit_law_of_circuit(q, dynamic, until_s, &ahead)) return INFINITY;
  double cycles = (until_s - q->record.last.knot.t_s) / q->setup->timeline.period_s;
  vs_law_drift_shares_of(&q->record, q->port, &fitted);
  for (int ago = 1; ago < VS_CYCLES_KEPT && !(best <= vs_record_share(&q->record)); ago++) {
    if (!vs_law_drift_find(&q->record, q->port, &q->modal, &fitted, ago, &drift)) break;
    double bound =
        vs_law_drift_signals(&q->record, q->port, &q->modal, q->misfit.signal, &drift, cycles);
    if (isinf(bound)) break;
    bound = fmax(bound, machine_bound(q, &drift, &ahead, until_s, tried));
    if (!(bound < best)) continue;
    best = bound;
    memcpy(error, tried, sizeof tried);
    memcpy(q->unfitted, q->misfit.signal, sizeof q->unfitted);
  }
  return best;
}

/* Can the armature come to a stop, or to the pole cover, with the energy E that is in the machine?
 * |g| = |c.q| <= sqrt(2 E c.K^-1 c), as E >= q.K q/2. */
static bool may_touch(const quiet *q, const vs_knot *k) {
  const vs_model *m = &q->setup->model;
  double energy =
      vs_mechanics_kinetic_energy(m, k->x + m->dof) + vs_mechanics_elastic_energy(m, k->x);
  double travel = MAY_TOUCH * sqrt(2 * energy * m->compliance_m_n);
  return travel > m->actuator.gap_m || vs_stops_nearness(&m->stops, travel) > 1 ||
         vs_stops_nearness(&m->stops, -travel) > 1;
}

static bool gate_is_on(const quiet *q, double t_s) {
  const vs_deck *deck = &q->setup->deck;
  for (size_t k = 0; k < deck->n_ports; k++) {
    const vs_signal *s = &deck->ports[k].signal;
    if (!vs_port_is_gated(s)) continue;
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

/* Does a look pay? The solver is left at the second good look in a row, a wait later. Until until_s
 * it would take steps as it has of late. */
static bool leaving_pays(const quiet *q, double wait_s, double until_s) {
  bool held = isfinite(fmin(q->bound_before[0], q->bound_before[1]));
  double away_s = until_s - q->record.last.knot.t_s - (held ? 0 : wait_s);
  return q->steps * away_s / q->setup->timeline.period_s >= (held ? 1 : 2) * LOOK_STEPS;
}

/* Is it time for a look? Only when two cycles are known, and at least one is to come. */
static bool look_is_due(const quiet *q, double until_s) {
  double period = q->setup->timeline.period_s, now = q->record.last.knot.t_s;
  if (q->record.blind || !vs_record_two_cycles(&q->record)) return false;
  double wait_s = fmax(period / LOOKS_PER_CYCLE, (now - q->blocks_s) / IN_VAIN);
  return !(now < q->looked_s + wait_s || until_s < now + period) &&
         leaving_pays(q, wait_s, until_s);
}

/* A bound must hold at two looks in a row, so the larger of the two counts. Where the law with G
 * and C holds for the first time, the law without them is not tried in its place. */
static bool solver_may_be_left(void *self, double until_s, double most_lag_s, double *bound) {
  quiet *q = self;
  double most = vs_record_share(&q->record), error[VS_MOST_STATES];
  if (something_is_on(q) || !look_is_due(q, until_s) || may_touch(q, &q->record.last.knot))
    return false;
  q->looked_s = q->record.last.knot.t_s;
  for (int dynamic = 1; dynamic >= 0; dynamic--) {
    double before = q->bound_before[dynamic];
    q->bound_before[dynamic] = bound_of_law(q, dynamic, until_s, error);
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

static vs_status step_macromodel(void *self, vs_knot *k, double t_s, vs_error *err) {
  quiet *q = self;
  double y[VS_ONEPORT_STATES], signal[VS_SIGNALS];
  vs_oneport_state(k, y);
  if (!vs_oneport_advance(q->port, k->t_s, t_s, y))
    return vs_fail(err, VS_RUN, "t = %.9g s: GSL cannot step on", t_s);
  vs_coil_state c = vs_oneport_coil(q->port, t_s, y);
  vs_responses_at(vs_oneport_responses(q->port), t_s, &c, signal);
  k->t_s = t_s;
  memcpy(k->x, y + VS_ONEPORT_Q, sizeof k->x);
  k->flux_wb = c.flux_wb;
  k->flux_rate_v = c.flux_rate_v;
  k->flux_rate2_v_s = c.v_rate_v_s - q->setup->model.coil.resistance_ohm * c.i_rate_a_s;
  k->v_eva_v = c.v_v;
  memcpy(k->terms, signal, vs_record_terms(&q->record) * sizeof *signal);
  k->i_mains_a = signal[vs_record_terms(&q->record)];
  memcpy(q->stepped, signal, vs_record_signals(&q->record) * sizeof *signal);
  vs_step_complete_knot(q->frame, k, 0);
  return VS_OK;
}

static double capacitance_at_eva(const void *self) {
  const quiet *q = self;
  return vs_oneport_capacitance(q->port);
}

/* What the circuit remembers may miss by twice its misfit of the law: the solver was left with such
 * an error, and comes back to one. */
static double difference_from_solver(const void *self, const vs_knot *own, const vs_knot *solver,
                                     const double *memory) {
  const quiet *q = self;
  size_t terms = vs_record_terms(&q->record);
  const vs_observation a = {.knot = *own, .memory = q->stepped + terms + 1},
                       b = {.knot = *solver, .memory = memory};
  double worst = 0;
  for (size_t n = 0; n < vs_record_signals(&q->record); n++) {
    if (vs_record_is_control(&q->record, n) ||
        vs_responses_drift(vs_oneport_responses(q->port), n) != 0)
      continue; /* an integral: the solver's own stood still */
    double off = vs_responses_seen(q->frame, &b, n) - vs_responses_seen(q->frame, &a, n);
    double hidden = n > terms ? 2 * q->unfitted[n] : 0;
    worst = fmax(worst, fabs(off) / fmax(vs_record_allowed(&q->record, n), hidden));
  }
  return worst;
}

/* The deck's terms run straight from knot to knot. Between two points of a sine, h apart, a
 * straight line is off by (w h)^2/8 of the peak. For the mains' w that shall be run.tolerance. */
static double longest_macromodel_step(const void *self) {
  const quiet *q = self;
  double h = sqrt(8 * q->setup->run.tolerance) / q->setup->timeline.omega_rad_s;
  return fmin(h, STEP_RAD / q->setup->model.fastest_rad_s);
}

/* ---- begun and ended ---- */

/* False where the armature jams, where the load changes, where the deck tells the time by itself,
 * where it has no store, or where it keeps a state that is not seen. */
static bool can_stand_in(const vs_setup *setup, vs_circuit_states *memories) {
  const vs_deck *deck = &setup->deck;
  return isinf(vs_setup_jams(setup)) && !setup->loads.count && !deck->own_clock &&
         deck->stores.count && !vs_circuit_states_are_hidden(deck) &&
         vs_circuit_states_list(deck, memories);
}

/* The one-port's law has i = lambda z/(2a), and may_touch() wants springs, and a rest at q = 0. An
 * element that reads the motion may do anything once that is where it has not been yet. */
static const char *why_declined(const vs_setup *setup) {
  const vs_model *m = &setup->model;
  if (setup->deck.reads_eva.file) return "an element of the deck reads the machine's motion";
  if (!m->coil.square) return "its law is fitted to a coil with i = lambda z/(2a) alone";
  if (m->coil.eddies) return "what would stand in for the circuit has no eddy currents";
  if (m->loaded) return "the machine has forces that never change";
  if (!isfinite(m->compliance_m_n)) return "a coordinate of the machine has no spring";
  return NULL;
}

static void end_macromodel(void *self) {
  quiet *q = self;
  if (!q) return;
  vs_modal_end(&q->modal);
  vs_oneport_free(q->port);
  vs_record_end(&q->record);
  free(q);
}

static void *begin_macromodel(const vs_setup *setup, const vs_frame *frame) {
  quiet *q = vs_alloc(1, sizeof *q);
  q->setup = setup;
  q->frame = frame;
  if (why_declined(setup) || !can_stand_in(setup, &q->memories)) {
    free(q);
    return NULL;
  }
  vs_record_begin(&q->record, setup, frame, &q->memories);
  q->port = vs_oneport_new(setup, frame, q->memories.count);
  restart_macromodel(q);
  if (vs_modal_begin(&q->modal, &setup->model)) return q;
  end_macromodel(q);
  return NULL;
}

static const vs_circuit_states *states_to_show(const void *self) {
  return &((const quiet *)self)->memories;
}

const vs_macromodel vs_oneport_macromodel = {.declines = why_declined,
                                             .begin = begin_macromodel,
                                             .end = end_macromodel,
                                             .memories = states_to_show,
                                             .take = record_solver_knot,
                                             .may_leave = solver_may_be_left,
                                             .longest = longest_macromodel_step,
                                             .step = step_macromodel,
                                             .capacitance = capacitance_at_eva,
                                             .missed = difference_from_solver,
                                             .restart = restart_macromodel};
