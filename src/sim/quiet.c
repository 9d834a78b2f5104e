/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/quiet.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "machine/actuator.h"

enum { PER_CYCLE = 200, LOOKS_PER_CYCLE = 4 };

/* Cycles kept: the last one, to which a law is fitted, and those before, by which it is told
 * whether a law walks away. */
enum { FIT_CYCLES = 2, CYCLES_KEPT = 4, MOST_KEPT = 1024 };

/* Of run.tolerance, for having left the circuit; how much worse than in the cycle in which it was
 * looked at the one-port may be later; what the integration without the solver may cost; and of
 * run.tolerance, by how much a run that stays differs from itself. */
static const double SHARE = 0.75, SAFETY = 5, WALK_SAFETY = 2, SAMPLING = 0.02, INTEGRATION = 1e-7,
                    ITS_OWN = 1e-3;

/* By how many run.tolerance of its peak one of the deck's signals may be wrong, or of 1 V or 0.1 A,
 * which is what the solver tells apart; how many times that it may drift to the end, as a fuse's
 * integral does (a store may not at all: its current would go on changing). */
static const double SIGNAL_SHARE = 3, HIDDEN_SHARE = 1, LEAST_HIDDEN = 1e-3, EXTREMES = 0.2,
                    LEAST_V = 1, LEAST_A = 0.1, MOST_DRIFT = 100;

struct vs_quiet {
  const vs_setup *setup;
  const vs_frame *frame;
  const vs_memories *memories;
  vs_mode modes[VS_STATES];
  gsl_matrix_complex *vectors; /* of the modes, (shape, s shape), decomposed */
  gsl_permutation *order;
  gsl_vector_complex *share;
  vs_seen *kept;  /* a ring: first, count */
  double *memory; /* of each of them */
  size_t first, count;
  const vs_seen *seen[VS_MOST_SEEN]; /* a cycle of it in order, while it is looked at that */
  size_t n_seen;
  vs_coil coil[VS_MOST_SEEN]; /* what the one-port says of them */
  vs_seen last;               /* knot taken, also when it is not kept */
  bool any, blind;            /* blind: the solver does not show what it remembers */
  double looked_s, blocks_s;  /* when it was last looked, and since when the thyristor blocks */
  double bound_before[2];     /* with either law, when it was last looked; infinite: not yet */
  double carried[VS_STATES], carried_s; /* each mode's error of having left before; as of then */
  double peak_x[VS_DOF], peak_force_n, peak_a, peak_signal[VS_SIGNALS];
  double least[VS_MEMORIES], most[VS_MEMORIES]; /* of each memory, so far */
  double unfitted[VS_SIGNALS]; /* what the law by which it was left did not say of each signal */
  double stepped[VS_SIGNALS];  /* the signals where vs_quiet_step has come */
  vs_oneport *port;
};

static size_t n_terms(const vs_quiet *q) {
  return q->frame->deck->n_terms;
}

/* The deck's terms, the mains current, what else the circuit remembers. */
static size_t n_signals(const vs_quiet *q) {
  return n_terms(q) + 1 + q->memories->count;
}

static bool is_current(const vs_quiet *q, size_t n) {
  size_t terms = n_terms(q);
  if (n < terms) return *q->frame->deck->terms[n].plus == 'i';
  return n == terms || *q->memories->item[n - terms - 1].plus == 'i';
}

static vs_seen *kept_at(const vs_quiet *q, size_t k) {
  return &q->kept[(q->first + k) % MOST_KEPT];
}

/* ---- what was seen ---- */

static void take_peaks(vs_quiet *q, const vs_knot *k) {
  const vs_model *m = &q->setup->model;
  for (int n = 0; n < VS_DOF; n++) q->peak_x[n] = fmax(q->peak_x[n], fabs(k->x[n]));
  q->peak_force_n = fmax(q->peak_force_n, vs_force(m, k->flux_wb));
  q->peak_a = fmax(q->peak_a, fabs(vs_knot_current(m, k)));
  for (size_t n = 0; n < n_terms(q); n++)
    q->peak_signal[n] = fmax(q->peak_signal[n], fabs(k->terms[n]));
  q->peak_signal[n_terms(q)] = fmax(q->peak_signal[n_terms(q)], fabs(k->i_mains_a));
}

/* Of what the circuit remembers the peak is half of how far it went: there may be a bias. */
static void take_memory(vs_quiet *q, const double *memory) {
  for (size_t n = 0; n < q->memories->count; n++) {
    q->least[n] = fmin(q->least[n], memory[n]);
    q->most[n] = fmax(q->most[n], memory[n]);
    q->peak_signal[n_terms(q) + 1 + n] = (q->most[n] - q->least[n]) / 2;
    q->blind = q->blind || !isfinite(memory[n]);
  }
}

/* The integral of i by its values and slopes at both ends of a step, and of v = R i + dlambda/dt.
 */
static void integrate_port(vs_quiet *q, const vs_knot *k) {
  const vs_model *m = &q->setup->model;
  const vs_knot *from = &q->last.knot;
  double h = k->t_s - from->t_s,
         charge = h / 2 * (vs_knot_current(m, from) + vs_knot_current(m, k)) -
                  h * h / 12 * (vs_knot_current_rate(m, k) - vs_knot_current_rate(m, from));
  q->last.charge_c += charge;
  q->last.flux_in_wb += m->actuator.resistance_ohm * charge + k->flux_wb - from->flux_wb;
}

void vs_quiet_restart(vs_quiet *q) {
  q->any = false;
  q->count = 0;
  q->bound_before[0] = q->bound_before[1] = INFINITY;
}

void vs_quiet_take(vs_quiet *q, const vs_knot *k, const double *memory, bool blocks) {
  double period = q->setup->timeline.period_s;
  if (q->any) integrate_port(q, k);
  vs_knot_copy(q->frame, k, &q->last.knot);
  q->any = true;
  take_peaks(q, k);
  take_memory(q, memory);
  if (!blocks) {
    vs_quiet_restart(q);
    q->looked_s = q->blocks_s = k->t_s;
    return;
  }
  if (q->count && k->t_s < kept_at(q, q->count - 1)->knot.t_s + period / PER_CYCLE) return;
  while (q->count &&
         (q->count == MOST_KEPT || kept_at(q, 0)->knot.t_s < k->t_s - CYCLES_KEPT * period)) {
    q->first = (q->first + 1) % MOST_KEPT;
    q->count--;
  }
  vs_seen *seen = kept_at(q, q->count++);
  double *own = q->memory + (size_t)(seen - q->kept) * VS_MEMORIES;
  memcpy(own, memory, q->memories->count * sizeof *memory);
  *seen = q->last;
  seen->memory = own;
}

/* Takes some cycles into view that ended so many before the last knot; false: they are not all
 * there. */
static bool view(vs_quiet *q, int some, int cycles) {
  double period = q->setup->timeline.period_s, end = q->last.knot.t_s - cycles * period,
         from = end - some * period;
  size_t k = 0;
  q->n_seen = 0;
  while (k < q->count && kept_at(q, k)->knot.t_s < from) k++;
  if (k == q->count || kept_at(q, k)->knot.t_s > from + 0.02 * period) return false;
  for (; k < q->count && q->n_seen < VS_MOST_SEEN && kept_at(q, k)->knot.t_s <= end; k++)
    q->seen[q->n_seen++] = kept_at(q, k);
  return q->n_seen >= VS_LEAST_SEEN;
}

/* ---- the one-port beside the solver ---- */

/* What an error of the mains' frequency and of some harmonics is of: a mean, cosines and sines. */
enum { HARMONICS = 3, PARTS = 1 + 2 * HARMONICS };

/* By how much it is wrong over the cycle in view, from the state at its first knot. */
typedef struct misfit {
  double force_n, current_a, signal[VS_SIGNALS];
  double mode[VS_STATES]; /* largest share of each mode in the error of q, as vs_mode's shape */
} misfit;

/* Of knot k in view: what its error counts for each part, so that their sum is the part. */
static void weights(const vs_quiet *q, size_t k, double weight[PARTS]) {
  size_t last = q->n_seen - 1;
  double span_s = q->seen[last]->knot.t_s - q->seen[0]->knot.t_s;
  double h = q->seen[k < last ? k + 1 : last]->knot.t_s - q->seen[k ? k - 1 : 0]->knot.t_s;
  double angle = q->setup->timeline.omega_rad_s * q->seen[k]->knot.t_s, w = h / 2 / span_s;
  weight[0] = w;
  for (int n = 1; n <= HARMONICS; n++) {
    weight[2 * n - 1] = 2 * w * cos(n * angle);
    weight[2 * n] = 2 * w * sin(n * angle);
  }
}

static void add_parts(const double weight[PARTS], double error, double part[PARTS]) {
  for (int n = 0; n < PARTS; n++) part[n] += weight[n] * error;
}

static double electric_bound(const vs_quiet *q, const misfit *wrong) {
  return SAFETY * fmax(wrong->force_n / q->peak_force_n, wrong->current_a / q->peak_a);
}

/* |shares| of the modes in x: V^-1 x, V's columns (shape, s shape). */
static void shares(const vs_quiet *q, const double x[VS_STATES], double share[VS_STATES]) {
  for (size_t n = 0; n < VS_STATES; n++)
    gsl_vector_complex_set(q->share, n, gsl_complex_rect(x[n], 0));
  gsl_linalg_complex_LU_svx(q->vectors, q->order, q->share);
  for (size_t n = 0; n < VS_STATES; n++)
    share[n] = gsl_complex_abs(gsl_vector_complex_get(q->share, n));
}

/* Up to where force or current are wrong by more than that; then false. */
static bool compare(vs_quiet *q, double most, misfit *wrong) {
  const vs_model *m = &q->setup->model;
  double y[VS_ONEPORT_STATES];
  *wrong = (misfit){0};
  vs_oneport_state(&q->seen[0]->knot, y);
  for (size_t k = 0; k < q->n_seen; k++) {
    const vs_knot *seen = &q->seen[k]->knot;
    if (k && !vs_oneport_advance(q->port, q->seen[k - 1]->knot.t_s, seen->t_s, y)) return false;
    const vs_coil c = q->coil[k] = vs_oneport_coil(q->port, seen->t_s, y);
    double error[VS_STATES], share[VS_STATES];
    double force = vs_force(m, c.flux_wb) - vs_force(m, seen->flux_wb);
    wrong->force_n = fmax(wrong->force_n, fabs(force));
    wrong->current_a = fmax(wrong->current_a, fabs(c.i_a - vs_knot_current(m, seen)));
    if (!(electric_bound(q, wrong) <= most)) return false;
    for (int n = 0; n < VS_STATES; n++) error[n] = y[n] - seen->x[n];
    shares(q, error, share);
    for (int n = 0; n < VS_STATES; n++) wrong->mode[n] = fmax(wrong->mode[n], share[n]);
  }
  return true;
}

static void compare_signals(const vs_quiet *q, misfit *wrong) {
  double signal[VS_SIGNALS];
  for (size_t k = 0; k < q->n_seen; k++) {
    const vs_seen *seen = q->seen[k];
    vs_oneport_signals(q->port, seen->knot.t_s, &q->coil[k], signal);
    for (size_t n = 0; n < n_signals(q); n++)
      wrong->signal[n] =
          fmax(wrong->signal[n], fabs(signal[n] - vs_seen_signal(q->frame, seen, n)));
  }
}

/* ---- what may come of it ---- */

enum { CYCLES_AHEAD = 10, STEPS_AHEAD = 100 };

/* What the one-port says of the cycles to come: its largest flux linkage in each, relative to what
 * was seen, as an error of the flux linkage makes one of the force in proportion to it; and how far
 * they lie beyond what it was fitted to. Ten cycles of 50 Hz hold the slowest beats of the mains
 * with a machine that is driven near its resonance. */
typedef struct outlook {
  double ratio[CYCLES_AHEAD];
  double reach; /* at least 1 */
} outlook;

/* What signal n may be wrong by. */
static double allowed(const vs_quiet *q, size_t n) {
  double least = is_current(q, n) ? LEAST_A : LEAST_V;
  if (n > n_terms(q)) least *= LEAST_HIDDEN;
  return q->setup->run.tolerance * fmax(SIGNAL_SHARE * q->peak_signal[n], least);
}

/* Where the signals and the EVA's voltage were. A law found in there says nothing of what lies
 * outside: there a diode may conduct that did not, or block. */
typedef struct range {
  double least[VS_SIGNALS + 1], most[VS_SIGNALS + 1]; /* the last one: of the EVA */
} range;

static void see_range(const vs_quiet *q, range *r) {
  size_t count = n_signals(q);
  for (size_t n = 0; n <= count; n++) {
    double least = INFINITY, most = -INFINITY;
    for (size_t k = 0; k < q->n_seen; k++) {
      const vs_seen *seen = q->seen[k];
      double value = n < count ? vs_seen_signal(q->frame, seen, n) : seen->knot.v_eva_v;
      least = fmin(least, value);
      most = fmax(most, value);
    }
    double slack = (most - least) / 2 + (n < count ? allowed(q, n) : 0); /* for the beat */
    bool drifts = n < count && vs_oneport_drift(q->port, n) != 0;
    r->least[n] = drifts ? -INFINITY : least - slack;
    r->most[n] = drifts ? INFINITY : most + slack;
  }
}

static bool in_range(const vs_quiet *q, const range *r, double t_s, const vs_coil *c) {
  double signal[VS_SIGNALS];
  size_t count = n_signals(q);
  vs_oneport_signals(q->port, t_s, c, signal);
  for (size_t n = 0; n < count; n++)
    if (!(signal[n] >= r->least[n] && signal[n] <= r->most[n])) return false;
  return c->v_v >= r->least[count] && c->v_v <= r->most[count];
}

/* Not beyond the end. */
static bool look_ahead(vs_quiet *q, double until_s, outlook *o) {
  double y[VS_ONEPORT_STATES], t = q->last.knot.t_s, now = 0;
  double h = q->setup->timeline.period_s / STEPS_AHEAD;
  for (size_t k = 0; k < q->n_seen; k++) now = fmax(now, fabs(q->seen[k]->knot.flux_wb));
  range seen;
  see_range(q, &seen);
  vs_oneport_state(&q->last.knot, y);
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

/* How fast the law goes wrong: by how much more in each cycle than in the one before. */
typedef struct walk {
  double current_a, force_n, electric, mode[VS_STATES], signal[VS_SIGNALS];
} walk;

typedef struct parts {
  double of[VS_SIGNALS][PARTS];
} parts;

static double distance(const double a[PARTS], const double b[PARTS]) {
  double sum = fabs(a[0] - b[0]);
  for (int n = 1; n < PARTS; n += 2) sum += hypot(a[n] - b[n], a[n + 1] - b[n + 1]);
  return sum;
}

/* Signal n's error where the coil is as the solver has it, in parts, over the cycle in view. */
static void see_parts(const vs_quiet *q, parts *all) {
  double signal[VS_SIGNALS], weight[PARTS], y[VS_ONEPORT_STATES];
  memset(all, 0, sizeof *all);
  for (size_t k = 0; k < q->n_seen; k++) {
    const vs_seen *seen = q->seen[k];
    vs_oneport_state(&seen->knot, y);
    vs_coil c = vs_oneport_coil(q->port, seen->knot.t_s, y);
    vs_oneport_signals(q->port, seen->knot.t_s, &c, signal);
    weights(q, k, weight);
    for (size_t n = 0; n < n_signals(q); n++)
      add_parts(weight, signal[n] - vs_seen_signal(q->frame, seen, n), all->of[n]);
  }
}

/* What a mode takes from the cycle in view if the flux linkage there is more by a sine of the
 * mains' frequency, of any phase, and a mean: the force is more in proportion to their product. */
static double swing(const vs_quiet *q, const vs_mode *m, double sine, double mean) {
  double sum[3][2] = {{0}}, w = q->setup->timeline.omega_rad_s, t0 = q->seen[0]->knot.t_s;
  for (size_t k = 1; k < q->n_seen; k++) {
    const vs_knot *a = &q->seen[k - 1]->knot, *b = &q->seen[k]->knot;
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

/* From the cycle it was fitted to to the one in view, so many before. What dies away there counts
 * as well, as if it came up. A coil that is driven so much more makes a force in proportion to the
 * flux linkage it has. */
static void find_walk(const vs_quiet *q, const parts *fitted, int cycles, walk *w) {
  static parts earlier; /* large */
  const vs_model *m = &q->setup->model;
  double unit[VS_STATES] = {0}, none[VS_STATES] = {0}, rest[VS_DOF], flux = 0, sine, mean;
  vs_oneport_walked(q->port, q->seen, q->n_seen, &sine, &mean);
  const double to_flux = 2 * m->a_hm / m->gap_rest_m / cycles;
  see_parts(q, &earlier);
  for (size_t k = 0; k < q->n_seen; k++) flux = fmax(flux, fabs(q->seen[k]->knot.flux_wb));
  w->current_a = (sine + mean) / cycles;
  vs_accelerations(m, none, 0, rest);
  vs_accelerations(m, none, 1, unit + VS_DOF);
  for (int k = 0; k < VS_DOF; k++) unit[VS_DOF + k] -= rest[k];
  shares(q, unit, w->mode);
  for (int k = 0; k < VS_STATES; k++)
    w->mode[k] *= to_flux / (2 * m->a_hm) * swing(q, &q->modes[k], sine, mean);
  for (size_t n = 0; n < n_signals(q); n++)
    w->signal[n] = distance(earlier.of[n], fitted->of[n]) / cycles;
  w->force_n = flux * to_flux * (sine + mean) / (2 * m->a_hm);
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
 * added up in the same sense; ahead NULL: once. */
static void mode_errors(const vs_quiet *q, const misfit *wrong, const walk *w, const outlook *ahead,
                        double until_s, double error[VS_STATES]) {
  double period = q->setup->timeline.period_s, now = q->last.knot.t_s;
  for (size_t k = 0; k < VS_STATES; k++) {
    const vs_mode *m = &q->modes[k];
    double walked = 0, times = 1;
    if (ahead) times = times_added(ahead, m, (until_s - now) / period, period, &walked);
    error[k] = q->carried[k] * exp(m->re_1_s * (now - q->carried_s)) +
               SAFETY * wrong->mode[k] * times + (w ? w->mode[k] * walked : 0);
  }
}

/* Largest part of its peak by which p, u, w or phi is wrong with these errors. */
static double motion_bound(const vs_quiet *q, const double error[VS_STATES]) {
  double worst = 0;
  for (int n = 0; n < VS_DOF; n++) {
    double sum = 0;
    for (size_t k = 0; k < VS_STATES; k++)
      sum += hypot(q->modes[k].shape_re[n], q->modes[k].shape_im[n]) * error[k];
    worst = fmax(worst, sum / q->peak_x[n]);
  }
  return worst;
}

static bool in_a_store(const vs_quiet *q, size_t term) {
  const vs_accounts *stores = &q->frame->deck->stores;
  for (size_t k = 0; k < stores->count; k++)
    if (vs_formula_uses(&stores->item[k].formula, (int)term)) return true;
  return false;
}

/* What signal n may be relative to: its peak, or what the solver tells apart. */
static double scale_of(const vs_quiet *q, size_t n) {
  return allowed(q, n) / (SIGNAL_SHARE * q->setup->run.tolerance);
}

/* Do the deck's signals, and all that the circuit remembers, do as they did, to the end? An
 * integral that only shows may drift on. */
static bool signals_hold(const vs_quiet *q, const misfit *wrong, double until_s) {
  for (size_t n = 0; n < n_signals(q); n++) {
    double most = allowed(q, n);
    double drift = fabs(vs_oneport_drift(q->port, n)) * (until_s - q->last.knot.t_s);
    double times = n < n_terms(q) && !in_a_store(q, n) ? MOST_DRIFT : 1;
    if (n > n_terms(q)) /* the bias of a capacitor that begins charged counts here */
      most = fmax(most, SIGNAL_SHARE * q->setup->run.tolerance *
                            fmax(q->most[n - n_terms(q) - 1], -q->least[n - n_terms(q) - 1]));
    double least_known = n > n_terms(q) ? HIDDEN_SHARE * q->peak_signal[n] : 0;
    if (!(wrong->signal[n] <= fmax(most, least_known)) || !(drift <= times * most)) return false;
  }
  return true;
}

/* In how many cycles a beat of the machine with the mains may take what it changes from one to the
 * next: a mode turns by s T in a cycle, so both ends lie apart by 2/|1 - exp(s T)| such changes. */
static double beat_cycles(const vs_quiet *q) {
  double most = 0, period = q->setup->timeline.period_s;
  for (int k = 0; k < VS_STATES; k++) {
    double size = exp(q->modes[k].re_1_s * period), angle = q->modes[k].im_rad_s * period;
    most = fmax(most, 2 / hypot(1 - size * cos(angle), size * sin(angle)));
  }
  return most;
}

/* What the signals are wrong by at the end, the worst of them relative to its peak. Of what nobody
 * is told only the walk counts, and of that what is more than the sampling of a law's misfit makes.
 * What a signal that hangs on the coil is wrong by, more in each cycle, is for the beat of the
 * machine with the mains, beyond which it grows no more: the source's own walk is known better. */
static double signals_bound(const vs_quiet *q, const misfit *wrong, const walk *w, double cycles) {
  double worst = 0, beat = beat_cycles(q);
  for (size_t n = 0; n < n_signals(q); n++) {
    bool told = n <= n_terms(q);
    double times = vs_oneport_hangs(q->port, n) ? fmin(cycles, beat) : WALK_SAFETY * cycles;
    double each = told ? w->signal[n] : fmax(w->signal[n] - SAMPLING * wrong->signal[n], 0);
    double error = (told ? wrong->signal[n] : 0) + times * each;
    if (!told && !(error <= allowed(q, n))) return INFINITY;
    if (told) worst = fmax(worst, error / scale_of(q, n));
  }
  return worst + EXTREMES * q->setup->run.tolerance;
}

/* The same with what the law says of the cycle that ended so many before the last knot, to which it
 * was not fitted. */
static double earlier_bound(vs_quiet *q, const misfit *wrong, const parts *fitted, int earlier,
                            double until_s, walk *w) {
  double cycles = (until_s - q->last.knot.t_s) / q->setup->timeline.period_s;
  if (!view(q, 1, earlier)) return INFINITY;
  find_walk(q, fitted, earlier, w);
  w->electric = cycles * fmax(w->force_n / q->peak_force_n, w->current_a / q->peak_a);
  return signals_bound(q, wrong, w, cycles);
}

/* The bound with that law, and each mode's error until_s; INFINITY: it is not to be gone by. What
 * costs most, the signals and the look ahead, comes last. */
static double bound_of(vs_quiet *q, bool dynamic, double until_s, double error[VS_STATES]) {
  double most = SHARE * q->setup->run.tolerance, told = SIGNAL_SHARE * q->setup->run.tolerance,
         best = INFINITY;
  static misfit wrong; /* large, as walk */
  static walk w;
  outlook ahead;
  if (!view(q, 1, 0) || !vs_oneport_fit(q->port, q->seen, q->n_seen, dynamic)) return INFINITY;
  if (!compare(q, most, &wrong)) return INFINITY;
  mode_errors(q, &wrong, NULL, NULL, until_s, error);
  if (!(motion_bound(q, error) <= most)) return INFINITY;
  if (!view(q, FIT_CYCLES, 0) || !vs_oneport_fit_signals(q->port, q->seen, q->n_seen))
    return INFINITY;
  view(q, 1, 0);
  compare_signals(q, &wrong);
  static parts fitted;
  see_parts(q, &fitted);
  if (!signals_hold(q, &wrong, until_s) || !look_ahead(q, until_s, &ahead)) return INFINITY;
  for (int earlier = 1; earlier < CYCLES_KEPT && !(best <= told); earlier++) {
    double bound = earlier_bound(q, &wrong, &fitted, earlier, until_s, &w);
    if (isinf(bound)) break;
    double tried[VS_STATES];
    mode_errors(q, &wrong, &w, &ahead, until_s, tried);
    double machine = fmax(ahead.reach * electric_bound(q, &wrong) + WALK_SAFETY * w.electric,
                          motion_bound(q, tried));
    if (!(machine <= most && fmax(machine, bound) < best)) continue;
    best = fmax(machine, bound);
    memcpy(error, tried, sizeof tried);
    memcpy(q->unfitted, wrong.signal, sizeof q->unfitted);
  }
  return best;
}

/* Can the armature come to its stop, or to the pole cover, with the energy that is in the machine?
 * |p| <= sqrt(2 E (K^-1)_pp); a tenth more for what the force may do. */
static bool may_touch(const vs_quiet *q, const vs_knot *k) {
  const vs_model *m = &q->setup->model;
  double energy = vs_kinetic_energy(m, k->x) + vs_elastic_energy(m, k->x);
  double compliance = 1 / m->stiffness[P][P]; /* p is coupled to the others by mass alone */
  return 1.1 * sqrt(2 * energy * compliance) > m->actuator.gap_m;
}

bool vs_quiet_may_leave(vs_quiet *q, double until_s, double most_lag_s, double *bound) {
  double period = q->setup->timeline.period_s, now = q->last.knot.t_s;
  if (q->blind || !q->count || kept_at(q, 0)->knot.t_s > now - 1.98 * period) return false;
  /* the less often, the longer it was in vain: a look may cost as much as some steps of the solver
   */
  double wait_s = fmax(period / LOOKS_PER_CYCLE, (now - q->blocks_s) / 16);
  if (now < q->looked_s + wait_s || until_s < now + period) return false;
  if (may_touch(q, &q->last.knot)) return false;
  q->looked_s = now;
  double error[VS_STATES];
  for (int dynamic = 1; dynamic >= 0; dynamic--) {
    double before = q->bound_before[dynamic], most = SIGNAL_SHARE * q->setup->run.tolerance;
    q->bound_before[dynamic] = bound_of(q, dynamic, until_s, error);
    *bound =
        INTEGRATION + ITS_OWN * q->setup->run.tolerance + fmax(before, q->bound_before[dynamic]);
    if (vs_oneport_lag(q->port) > most_lag_s) continue;
    if (q->bound_before[dynamic] <= most && !(*bound <= most)) return false; /* at the next look */
    if (!(*bound <= most)) continue;
    memcpy(q->carried, error, sizeof error);
    q->carried_s = until_s;
    return true;
  }
  return false;
}

/* ---- going by it ---- */

vs_status vs_quiet_step(vs_quiet *q, vs_knot *k, double t_s, vs_error *err) {
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
  memcpy(k->terms, signal, n_terms(q) * sizeof *signal);
  k->i_mains_a = signal[n_terms(q)];
  memcpy(q->stepped, signal, n_signals(q) * sizeof *signal);
  vs_knot_complete(q->frame, k, false);
  return VS_OK;
}

double vs_quiet_capacitance(const vs_quiet *q) {
  return vs_oneport_capacitance(q->port);
}

double vs_quiet_missed(const vs_quiet *q, const vs_knot *one_port, const vs_knot *solver,
                       const double *memory) {
  const vs_seen a = {.knot = *one_port, .memory = q->stepped + n_terms(q) + 1},
                b = {.knot = *solver, .memory = memory};
  double worst = 0;
  for (size_t n = 0; n < n_signals(q); n++) {
    double off = vs_seen_signal(q->frame, &b, n) - vs_seen_signal(q->frame, &a, n);
    if (vs_oneport_drift(q->port, n) != 0) continue; /* an integral: the solver's stood still */
    worst = fmax(worst, fabs(off) / fmax(allowed(q, n), n > n_terms(q) ? 2 * q->unfitted[n] : 0));
  }
  return worst;
}

/* (w h)^2/8 is what a straight line leaves of a sine. */
double vs_quiet_longest(const vs_quiet *q) {
  double h = sqrt(8 * q->setup->run.tolerance) / q->setup->timeline.omega_rad_s;
  return fmin(h, 0.15 / q->setup->model.fastest_rad_s);
}

static bool find_vectors(vs_quiet *q) {
  int sign;
  q->vectors = gsl_matrix_complex_alloc(VS_STATES, VS_STATES);
  q->order = gsl_permutation_alloc(VS_STATES);
  q->share = gsl_vector_complex_alloc(VS_STATES);
  if (!vs_modes(&q->setup->model, q->modes)) return false;
  for (size_t k = 0; k < VS_STATES; k++)
    for (size_t n = 0; n < VS_DOF; n++) {
      const vs_mode *m = &q->modes[k];
      gsl_complex shape = gsl_complex_rect(m->shape_re[n], m->shape_im[n]);
      gsl_matrix_complex_set(q->vectors, n, k, shape);
      gsl_matrix_complex_set(q->vectors, VS_DOF + n, k,
                             gsl_complex_mul(gsl_complex_rect(m->re_1_s, m->im_rad_s), shape));
    }
  gsl_linalg_complex_LU_decomp(q->vectors, q->order, &sign);
  return gsl_complex_abs(gsl_linalg_complex_LU_det(q->vectors, sign)) > 0;
}

vs_quiet *vs_quiet_new(const vs_setup *setup, const vs_frame *frame, const vs_memories *memories) {
  vs_quiet *q = vs_alloc(1, sizeof *q);
  *q = (vs_quiet){.setup = setup, .frame = frame, .memories = memories};
  q->kept = vs_alloc(MOST_KEPT, sizeof *q->kept);
  q->memory = vs_alloc(MOST_KEPT * VS_MEMORIES, sizeof *q->memory);
  for (size_t n = 0; n < VS_MEMORIES; n++) q->least[n] = INFINITY, q->most[n] = -INFINITY;
  q->port = vs_oneport_new(setup, frame, memories->count);
  vs_quiet_restart(q);
  if (find_vectors(q)) return q;
  vs_quiet_free(q);
  return NULL;
}

void vs_quiet_free(vs_quiet *q) {
  if (!q) return;
  gsl_matrix_complex_free(q->vectors);
  gsl_permutation_free(q->order);
  gsl_vector_complex_free(q->share);
  vs_oneport_free(q->port);
  free(q->kept);
  free(q->memory);
  free(q);
}
