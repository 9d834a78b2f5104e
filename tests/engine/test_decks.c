/* SPDX-License-Identifier: GPL-3.0-or-later
 * The decks that come with the program beside the two of test_circuit: all of Fig. 12 against the
 * reference of circuit T3A, two thyristors back to back against the closed form of phase control, a
 * half-controlled bridge against an integration of its own. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/export.h"
#include "program.h"
#include "suite.h"

enum { MOST_SETS = 40 };

/* Settings, up to a NULL each, one list behind the other. */
typedef struct settings {
  const char *item[MOST_SETS];
  size_t count;
} settings;

static void add(settings *s, const char *const *more) {
  for (; *more; more++) {
    CU_ASSERT_FATAL(s->count < MOST_SETS - 1);
    s->item[s->count++] = *more;
  }
}
#define ADD(s, ...) add(s, (const char *const[]){__VA_ARGS__, NULL})

/* A run that must go well; its energy books close within so many times the limit. */
static vs_trial *trial(const settings *s, const vs_observer *also, double limits, int line) {
  vs_trial *t = vs_trial_run("paper", "circuit", s->item, also);
  char why[512];
  expect(t->status == VS_OK, line, "%s", t->err.text);
  if (t->status) return t;
  double tolerance = limits * t->scene.setup.run.tolerance;
  const char *open = vs_energy_open(&t->result.watchers.energy, tolerance, why, sizeof why);
  expect(!open, line, "%s", open);
  return t;
}
#define TRIAL(s, also) trial(s, also, 1, __LINE__)

/* The armature all but nailed down, so that L stays 1.6 H: under 100 N it moves 1e-7 m. */
static void nail_down(settings *s) {
  ADD(s, "machine.trough_mass=10000 kg", "machine.base_mass=100000 kg",
      "machine.trough_inertia=10000 kg.m2", "machine.base_inertia=100000 kg.m2",
      "machine.spring_stiffness=1e9 N/m");
}

/* ---- halfwave_paper ---- */

/* The extra parts ideal, and R, C and varistors those of T3A; a varistor needs some capacitance.
 * Two milliohms of fuses are nothing beside the half ohm of the line. */
static settings as_t3a(void) {
  settings s = {.count = 0};
  ADD(&s, "circuit.deck=halfwave_paper", "circuit.thyristor=latch", "circuit.fuse_1=fuse_ideal",
      "circuit.fuse_2=fuse_ideal", "circuit.gate_drive=gate_ideal",
      "circuit.transformer=autotransformer_ideal", "circuit.varistor_1=varistor_power",
      "circuit.varistor_2=varistor_power", "circuit.varistor_3=varistor_power",
      "circuit.varistor_capacitance=1 pF", "circuit.r1=100 ohm", "circuit.c1=100 nF",
      "circuit.r2=220 ohm", "circuit.c2=47 nF");
  return s;
}

static vs_status at_100ms(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  if (step->from->t_s <= 0.1 && step->to->t_s >= 0.1)
    *(double *)ctx = vs_step_channel(step, 0.1, VS_CH_P);
  return VS_OK;
}

/* Measured: 2e-5 of each. */
static void ideal_parts_give_t3a(void) {
  double p = NAN;
  vs_observer observer = {&p, at_100ms};
  settings s = as_t3a();
  ADD(&s, "run.until=0.1001s");
  vs_trial *t = TRIAL(&s, &observer);
  CLOSE(t->result.values[VS_M_I_PEAK].value, 0.83336808722, 1e-4);
  CLOSE(t->result.values[VS_M_GAP_FIRST].value, -1.3771464192e-3, 1e-4);
  CLOSE_OF(p, -7.4366149576e-4, -1.3771464192e-3, 1e-4);
  CLOSE(run_extreme(t, "v_ak", -1), -1048.7, 1e-3);
  CLOSE(run_extreme(t, "v_ak", 1), 829.3, 1e-3);
  vs_trial_free(t);
}

/* With the parts it comes with nothing is overloaded, and there is nothing to warn of. */
static void default_parts_hold(void) {
  RUN_GOOD("run paper --set circuit.deck=halfwave_paper --set run.until=0.1s --quiet");
}

/* The reverse voltage behind the first extinction. Measured: 3e-5 apart. */
static void commutation_overvoltage_holds(void) {
  static const char *const TOLERANCES[] = {"run.tolerance=1e-4", "run.tolerance=1e-6"};
  double v[2];
  for (int k = 0; k < 2; k++) {
    settings s = {.count = 0};
    ADD(&s, "circuit.deck=halfwave_paper", "run.until=0.017s", TOLERANCES[k]);
    vs_trial *t = TRIAL(&s, NULL);
    v[k] = run_extreme(t, "v_ak", -1);
    vs_trial_free(t);
  }
  printf(" %.3f V, %.3f V", v[0], v[1]);
  EXPECT(v[1] < -700, "no overvoltage: %g V", v[1]);
  CLOSE(v[0], v[1], 1e-2);
}

/* With R2 = 220 ohm the ring of R2-C2 takes the thyristor's current through zero some 45 us behind
 * the firing; the next sub-pulse fires it again. That is one conduction, of some 8.1 ms. */
static void a_drop_out_does_not_end_the_conduction(void) {
  settings s = {.count = 0};
  ADD(&s, "circuit.deck=halfwave_paper", "run.until=0.02s", "circuit.r2=220ohm");
  vs_trial *t = TRIAL(&s, NULL);
  CLOSE(t->result.values[VS_M_CONDUCTION].value, 8.1e-3, 0.01);
  CLOSE(t->result.values[VS_M_T_FIRE].value, 5.556e-3, 1e-3);
  vs_trial_free(t);
}

/* What the gate gets in one conduction of 8 ms, with a sub-pulse every 0.2 ms. */
typedef struct gated {
  int pulses;
  double first_s, last_s, peak_v;
} gated;

static vs_status note_gate(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  gated *g = ctx;
  const vs_deck *deck = step->frame->deck;
  int k = vs_channel_deck(step->frame->model);
  for (size_t n = 0; strcmp(deck->probes[n].name, "v_gate"); n++) k++;
  double from_v = vs_step_channel(step, step->from->t_s, k);
  double to_v = vs_step_channel(step, step->to->t_s, k);
  g->peak_v = fmax(g->peak_v, to_v);
  if (!(from_v < 0.5 && to_v >= 0.5)) return VS_OK;
  if (!g->pulses++) g->first_s = step->to->t_s;
  g->last_s = step->to->t_s;
  return VS_OK;
}

static gated gate_of(const char *thyristor, bool *spares, long *steps) {
  settings s = {.count = 0};
  gated g = {.pulses = 0};
  const vs_observer observer = {&g, note_gate};
  ADD(&s, "circuit.deck=halfwave_paper", "run.until=16ms", "run.verify=never", thyristor);
  vs_trial *t = vs_trial_read("paper", "circuit", s.item);
  t->scene.setup.timeline.spares = t->scene.order.spares = spares;
  vs_trial_go(t, &observer);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  *steps = t->result.steps;
  vs_trial_free(t);
  return g;
}

/* A run that may spare sub-pulses leaves them out while the current is above three times the
 * latching current, 0.18 A, which it is for some 6 ms. Measured: 40 sub-pulses in 3374 steps, and 5
 * in 1777. Where steps grow behind an edge as slowly as with a factor a step, all 40 take 4013. Of
 * a latch no I_L is known: it gets all sub-pulses. */
static void sub_pulses_are_spared_behind_latching(void) {
  static const char TYN[] = "circuit.thyristor=TYN1212", LATCH[] = "circuit.thyristor=latch";
  bool spares = false;
  long steps[3];
  gated all = gate_of(TYN, NULL, &steps[0]), some = gate_of(TYN, &spares, &steps[1]),
        latch = gate_of(LATCH, &spares, &steps[2]);
  printf(" %d in %ld, %d in %ld, %d", all.pulses, steps[0], some.pulses, steps[1], latch.pulses);
  EXPECT(all.pulses == 40 && latch.pulses == 40, "%d and %d", all.pulses, latch.pulses);
  EXPECT(some.pulses >= 4 && some.pulses <= 8, "%d", some.pulses);
  EXPECT(steps[0] < 3700 && steps[1] < 2200, "%ld and %ld", steps[0], steps[1]);
  CLOSE(some.first_s, all.first_s, 1e-9);
  CLOSE(some.last_s, all.last_s, 1e-6); /* they are back before the current ends */
  CLOSE(some.peak_v, all.peak_v, 1e-2);
}

/* Integrals over time of a few probes, from from_s on. */
enum { INTEGRALS = 3 };
typedef struct integrals {
  double from_s, seconds;
  const char *probe[INTEGRALS];
  double sum[INTEGRALS];
} integrals;

static vs_status integrate(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  integrals *g = ctx;
  double a[VS_CH_MOST], b[VS_CH_MOST], h = step->to->t_s - step->from->t_s;
  if (step->from->t_s < g->from_s) return VS_OK;
  vs_step_at(step, step->from->t_s, a);
  vs_step_at(step, step->to->t_s, b);
  for (int k = 0; k < INTEGRALS; k++) {
    int c = vs_channel_find(step->frame, g->probe[k]);
    g->sum[k] += h * (a[c] + b[c]) / 2;
  }
  g->seconds += h;
  return VS_OK;
}

/* Fired in every cycle, the coil's current has a mean; a core that does not saturate, of 0.4 H to
 * be quick, carries most of it in the end, and the line what the winding's and its own resistance
 * leave it: test_parts_passive.c has the formulas. R is the source's half ohm seen from the
 * line, and a fuse of a milliohm. */
static void the_core_carries_the_mean(void) {
  integrals g = {.from_s = 1.48, .probe = {"i", "i_magnetising", "i_line"}};
  vs_observer observer = {&g, integrate};
  settings s = as_t3a();
  ADD(&s, "circuit.transformer=autotransformer", "circuit.transformer_inductance=0.4 H",
      "circuit.transformer_saturates=1e6 Wb", "circuit.transformer_saturated=2e6 Wb",
      "firing.every=1", "firing.angle=120 deg", "run.until=1.5s", "run.tolerance=1e-3");
  nail_down(&s);
  vs_trial *t = TRIAL(&s, &observer);
  double r = 0.5 * pow(230 / 440., 2) + 1e-3, r_c = 1.6, i = g.sum[0] / g.seconds;
  EXPECT(i > 0.05, "mean coil current %g A", i);
  CLOSE_OF(g.sum[1] / g.seconds, -(440 / 230. - 1 + r / (r + r_c)) * i, i, 0.02);
  CLOSE_OF(g.sum[2] / g.seconds, r_c / (r + r_c) * i, i, 0.02);
  vs_trial_free(t);
}

/* ---- phase control with the armature all but nailed down ---- */

/* Nothing but the thyristors and what the mains drive: L = 1.6 H, R = 92 ohm. */
static settings ideal_bridge(const char *deck) {
  settings s = {.count = 0};
  ADD(&s, deck, "circuit.thyristor=latch", "circuit.on_voltage=0 V",
      "circuit.on_resistance=1e-4 ohm", "circuit.off_resistance=1000 Mohm",
      "circuit.varistor_voltage=1e5 V", "circuit.varistor_capacitance=1 pF", "circuit.r1=1 Mohm",
      "circuit.c1=1 pF", "supply.resistance=0", "supply.inductance=0", "firing.every=1",
      "run.tolerance=1e-5");
  nail_down(&s);
  return s;
}

static const double PEAK_V = 440 * M_SQRT2, OMEGA = 2 * M_PI * 50, R_OHM = 92, L_H = 1.6;

/* i of one half wave, x the phase since its zero: it begins at alpha and ends where it would
 * reverse (Eq. 91). */
static double half_wave(double x, double alpha) {
  double theta = atan(OMEGA * L_H / R_OHM), z = hypot(R_OHM, OMEGA * L_H);
  if (x < alpha) return 0;
  double i = PEAK_V / z * (sin(x - theta) - sin(alpha - theta) * exp(-(x - alpha) / tan(theta)));
  return fmax(i, 0); /* once below zero: sin wins again only beyond the next firing */
}

typedef struct full_wave {
  double alpha, worst_a, most_a, least_a;
} full_wave;

static vs_status see_full_wave(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  full_wave *f = ctx;
  double x = OMEGA * step->to->t_s, i = vs_step_channel(step, step->to->t_s, VS_CH_I), expected = 0;
  for (int half = 0; half * M_PI < x; half++) /* at most one of them flows */
    if (x - half * M_PI < M_PI + f->alpha)
      expected += (half % 2 ? -1 : 1) * half_wave(x - half * M_PI, f->alpha);
  f->worst_a = fmax(f->worst_a, fabs(i - expected));
  f->most_a = fmax(f->most_a, i);
  f->least_a = fmin(f->least_a, i);
  return VS_OK;
}

/* Both half waves, against the closed form, at three angles. A varistor must have some capacitance;
 * the coil rings with these 4 pF behind each extinction, by 570 V/sqrt(L/C) = 0.9 mA, and the next
 * half wave begins with what it finds. */
static void full_wave_phase_control(void) {
  static const struct {
    const char *set;
    double angle_deg, peak_a; /* closed form's, to its last digit */
  } ROWS[] = {{"firing.angle=100 deg", 100, .87991},
              {"firing.angle=120 deg", 120, .55070},
              {"firing.angle=150 deg", 150, .15600}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    full_wave f = {.alpha = ROWS[k].angle_deg * M_PI / 180};
    vs_observer observer = {&f, see_full_wave};
    settings s = ideal_bridge("circuit.deck=fullwave_antiparallel");
    ADD(&s, "circuit.r2=1 Mohm", "circuit.c2=1 pF", "run.until=0.06s", ROWS[k].set);
    vs_trial *t = TRIAL(&s, &observer);
    CLOSE_OF(f.worst_a, 0, 1, 0.9e-3);
    CLOSE_OF(f.most_a, ROWS[k].peak_a, 1, 0.3e-3);
    CLOSE_OF(f.least_a, -ROWS[k].peak_a, 1, 0.3e-3);
    vs_trial_free(t);
  }
}

typedef struct instants {
  double fires_s[8], extinct_s[8];
  int firings, extinctions;
} instants;

static vs_status note(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  instants *n = ctx;
  for (int k = 0; k < 2; k++) {
    if (step->event[k] == VS_EV_FIRES && n->firings < 8)
      n->fires_s[n->firings++] = step->event_s[k];
    if (step->event[k] == VS_EV_EXTINCT && n->extinctions < 8)
      n->extinct_s[n->extinctions++] = step->event_s[k];
  }
  return VS_OK;
}

/* Each half wave's firing and extinction are events, as both anode currents are in i_thyristor: the
 * second half wave begins half a cycle after the first, and both conduct about as long. */
static void each_half_wave_is_an_event(void) {
  instants n = {.firings = 0};
  vs_observer observer = {&n, note};
  settings s = {.count = 0};
  ADD(&s, "circuit.deck=fullwave_antiparallel", "firing.angle=120 deg", "firing.every=1",
      "run.until=0.049s");
  vs_trial *t = TRIAL(&s, &observer);
  CU_ASSERT_EQUAL(n.firings, 5);
  CU_ASSERT_EQUAL_FATAL(n.extinctions, 4);
  for (int k = 0; k < n.extinctions; k++) {
    CLOSE_OF(n.fires_s[k], 0.01 * k + 0.02 / 3, 1, 2e-6); /* a real thyristor takes its time */
    CLOSE_OF(n.extinct_s[k] - n.fires_s[k], 6.2649e-3, 1, 3e-4); /* closed form's for L(0) */
  }
  vs_trial_free(t);
}

/* ---- the half-controlled bridge ---- */

typedef struct bridge {
  gsl_odeiv2_system system;
  gsl_odeiv2_step *step;
  double alpha, t_s, i_a, worst_a, most_a, least_v_eva, free_s, both_s;
} bridge;

/* is 1 nA, n 1.8, 30 mohm, at ngspice's 27 degrees. */
static double diode_v(double i_a) {
  return 1.8 * 0.025864186 * log1p(fmax(i_a, 0) / 1e-9) + 0.03 * i_a;
}

/* The thyristor's path (one diode) or the free-wheeling one (two), whichever gives more. */
static double bridge_v(const bridge *b, double t_s, double i_a) {
  double x = fmod(OMEGA * t_s, M_PI), free_v = -2 * diode_v(i_a);
  double fed_v = PEAK_V * sin(x) - diode_v(i_a);
  return i_a <= 0 && x < b->alpha ? 0 : x >= b->alpha ? fmax(fed_v, free_v) : free_v;
}

static int bridge_rhs(double t_s, const double i[], double rate[], void *ctx) {
  rate[0] = (bridge_v(ctx, t_s, i[0]) - R_OHM * i[0]) / L_H;
  return GSL_SUCCESS;
}

static vs_status see_bridge(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  bridge *b = ctx;
  double h = step->to->t_s - b->t_s, y[VS_CH_MOST], error;
  for (int k = 0; k < 4; k++) /* the kinks cost nothing at this length of steps */
    gsl_odeiv2_step_apply(b->step, b->t_s + k * h / 4, h / 4, &b->i_a, &error, NULL, NULL,
                          &b->system);
  b->i_a = fmax(b->i_a, 0);
  b->t_s = step->to->t_s;
  vs_step_at(step, b->t_s, y);
  double d1 = y[vs_channel_find(step->frame, "i_d1")], d2 = y[vs_channel_find(step->frame, "i_d2")];
  b->worst_a = fmax(b->worst_a, fabs(y[VS_CH_I] - b->i_a));
  b->most_a = fmax(b->most_a, b->i_a);
  b->least_v_eva = fmin(b->least_v_eva, y[VS_CH_V_EVA]);
  if (d1 > 0.01 && d2 > 0.01) b->free_s += h;
  return VS_OK;
}

/* The coil's current is never chopped: behind each zero of the mains it goes on through both
 * diodes, and the EVA sees no more than their drops. */
static void bridge_free_wheels(void) {
  static const struct {
    const char *set;
    double angle_deg;
  } ROWS[] = {{"firing.angle=100 deg", 100}, {"firing.angle=150 deg", 150}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    bridge b = {.alpha = ROWS[k].angle_deg * M_PI / 180};
    b.system = (gsl_odeiv2_system){bridge_rhs, NULL, 1, &b};
    b.step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, 1);
    vs_observer observer = {&b, see_bridge};
    settings s = ideal_bridge("circuit.deck=bridge_halfcontrolled");
    ADD(&s, "run.until=0.06s", ROWS[k].set);
    vs_trial *t = TRIAL(&s, &observer);
    CLOSE_OF(b.worst_a, 0, b.most_a, 5e-4);
    EXPECT(b.least_v_eva > -2 * diode_v(b.most_a) - 0.05, "EVA at %g V", b.least_v_eva);
    double freely = (0.06 - 0.01) * ROWS[k].angle_deg / 180;
    CLOSE(b.free_s, freely, 0.1);
    gsl_odeiv2_step_free(b.step);
    vs_trial_free(t);
  }
}

/* ---- all of them ---- */

static const char *const DECKS[] = {"circuit.deck=halfwave_paper",
                                    "circuit.deck=fullwave_antiparallel",
                                    "circuit.deck=bridge_halfcontrolled"};

typedef struct way {
  const char *thyristor, *angle, *tolerance, *method;
} way;

static void complete(const char *deck, const way *w) {
  settings s = {.count = 0};
  ADD(&s, deck, w->thyristor, w->angle, w->tolerance, w->method, "firing.every=1",
      "run.until=0.017s");
  vs_trial *t = trial(&s, NULL, 2, __LINE__);
  if (t->status) printf(" %s %s %s %s %s\n", deck, w->thyristor, w->angle, w->tolerance, w->method);
  vs_trial_free(t);
}

/* Each completes without the ladder's help, with the fast thyristor and the one for protection
 * work, loose and tight, by either rule in turn. The books close within twice the limit: what they
 * leave is measured by what was drawn in the end, which is little when the coil has just given it
 * back. At the two tighter tolerances, which take most of the time, each deck and thyristor has one
 * of the angles here, and all of them with VS_LONG. */
static void every_deck_completes(void) {
  static const char *const THYRISTORS[] = {"circuit.thyristor=latch",
                                           "circuit.thyristor=thyristor_2t"};
  static const char *const ANGLES[] = {"firing.angle=95 deg", "firing.angle=120 deg",
                                       "firing.angle=155 deg"};
  static const char *const TOLERANCES[] = {"run.tolerance=1e-3", "run.tolerance=1e-5",
                                           "run.tolerance=1e-6"};
  static const char *const METHODS[] = {"run.method=trap", "run.method=gear"};
  const bool all = getenv("VS_LONG");
  size_t n = 0;
  for (size_t thyristor = 0; thyristor < COUNT(THYRISTORS); thyristor++)
    for (size_t angle = 0; angle < COUNT(ANGLES); angle++)
      for (size_t tolerance = 0; tolerance < COUNT(TOLERANCES); tolerance++, n++) {
        way w = {THYRISTORS[thyristor], ANGLES[angle], TOLERANCES[tolerance], METHODS[n % 2]};
        for (size_t deck = 0; deck < COUNT(DECKS); deck++)
          if (all || !tolerance || (deck + thyristor + tolerance) % COUNT(ANGLES) == angle)
            complete(DECKS[deck], &w);
      }
}

static void every_deck_passes_check(void) {
  for (size_t k = 0; k < COUNT(DECKS); k++) {
    ran r = run("check %s/../spice/%s.cir", VS_TEST_FOLDER, strchr(DECKS[k], '=') + 1);
    expect_good(&r, DECKS[k], __LINE__);
    free_ran(&r);
  }
}

/* "name = VALUE" in a log of ngspice's; NaN: it is not there. */
static double measured(const char *log, const char *name) {
  const char *at = strstr(log, name);
  double value;
  return at && sscanf(at + strlen(name), " = %lf", &value) == 1 ? value : NAN;
}

static int lines_of(const char *text) {
  int n = 0;
  for (; *text; text++) n += *text == '\n';
  return n;
}

/* The table of each deck has at most 25 lines, and names the verdict and what was not judged; --all
 * has what the short one leaves out. No margin is told in hundreds of times, nor an end of a range
 * that is a sum's rounding error. */
static void tables_are_short(void) {
  static const char *const WORDS[] = {
      "paper",       "paper --set circuit.deck=halfwave_paper --set circuit.thyristor=TYN1212",
      "chopper",     "paper --set circuit.deck=halfwave_paper --corners --set run.verify=never",
      "bridge_link", "paper --set circuit.deck=fullwave_antiparallel",
      "two_mass",    "paper --set circuit.deck=bridge_halfcontrolled",
      "solenoid",    "paper --set circuit.deck=halfwave_snubbed",
      "lds_v203",    "paper --set circuit.deck=halfwave_bare",
      "triac_feeder"};
  const size_t CORNERS = 3, CHOPS = 4; /* runs at all corners; bridge_link, whose 10 ms take 2 s */
  for (size_t k = 0; k < COUNT(WORDS); k++) {
    ran r = run("run %s --set run.until=%s", WORDS[k],
                k == CORNERS ? "6ms"
                : k == CHOPS ? "4ms"
                             : "30ms");
    EXPECT(!strncmp(r.out, "verdict: ", 9) && lines_of(r.out) <= 25, "%s: %d lines: %s%s", WORDS[k],
           lines_of(r.out), r.out, r.err);
    EXPECT(!strstr(r.out, "not judged: ") || strstr(r.out, " more (--all)\n"), "%s", r.out);
    free_ran(&r);
  }
  ran brief = run("run %s --set run.until=30ms", WORDS[1]);
  ran whole = run("run %s --set run.until=30ms --all", WORDS[1]);
  EXPECT(strstr(brief.out, "weakest: gate_drive.volt_seconds, ") &&
             strstr(brief.out, "\n  stroke ") && strstr(brief.out, " of them above 90 %; ") &&
             strstr(brief.out, ", varistor_1 99 %, ") && !strstr(brief.out, "thyristor.t_off"),
         "%s", brief.out);
  EXPECT(strstr(whole.out, "  thyristor.t_off ") && strstr(whole.out, "  >999 %  ") &&
             strstr(whole.out, "  i2t_f2 ") && !strstr(whole.out, "e-16 .. "),
         "%s", whole.out);
  free_ran(&brief);
  free_ran(&whole);
  ran far_off =
      run("run %s --set run.until=30ms --set circuit.c1=1uF --set circuit.r1=1ohm -o far_off",
          WORDS[1]);
  EXPECT(strstr(far_off.out, "margin <-999 %  violated\n"), "%s", far_off.out);
  free_ran(&far_off);
  /* a verdict that says much: rows of what is measured give way */
  ran crowded = run("run feeder --set circuit.c1=10nF --set run.verify=never --set "
                    "events.surge.level=4kV --set run.until=106ms -o far_off");
  EXPECT(lines_of(crowded.out) <= 25, "%d lines: %s", lines_of(crowded.out), crowded.out);
  free_ran(&crowded);
  ran fast = run("run feeder --set supply.voltage=230V --set circuit.c1=10nF --set "
                 "run.verify=never --set events.surge.level=4kV --set run.until=106ms -o far_off");
  EXPECT(strstr(fast.out, "happened: thyristor fires") && !strstr(fast.out, "e+0"), "%s", fast.out);
  free_ran(&fast);
  ran steady = run("steady paper --set firing.every=1 --set circuit.deck=halfwave_paper "
                   "--set circuit.thyristor=latch");
  EXPECT(lines_of(steady.out) <= 30 && strstr(steady.out, "\nstable: "), "%s%s", steady.out,
         steady.err);
  free_ran(&steady);
}

/* The exported netlist in plain ngspice, where it is installed. */
static void exported(void) {
  if (!on_path("ngspice")) return;
  settings s = as_t3a();
  ADD(&s, "run.until=0.03s");
  vs_error err = {0};
  CU_ASSERT_EQUAL_FATAL(
      vs_export_command("paper", (char *const *)(size_t)s.item, s.count, "x.cir", &err), VS_OK);
  CU_ASSERT_EQUAL(system("timeout 100 ngspice -b x.cir >x.log 2>&1"), 0);
  char *log = read_file("x.log");
  vs_trial *t = TRIAL(&s, NULL);
  CLOSE(measured(log, "p_first_peak_m"), t->result.values[VS_M_GAP_FIRST].value, 1e-3);
  CLOSE(measured(log, "i_peak_a"), t->result.values[VS_M_I_PEAK].value, 1e-3);
  vs_trial_free(t);
  free(log);
}

static const vs_test TESTS[] = {
    {"checked", every_deck_passes_check},
    {"ideal parts give T3A", ideal_parts_give_t3a},
    {"default parts hold", default_parts_hold},
    {"a drop-out does not end the conduction", a_drop_out_does_not_end_the_conduction},
    {"sub-pulses are spared behind latching", sub_pulses_are_spared_behind_latching},
    {"commutation overvoltage", commutation_overvoltage_holds},
    {"the core carries the mean", the_core_carries_the_mean},
    {"full wave phase control", full_wave_phase_control},
    {"each half wave is an event", each_half_wave_is_an_event},
    {"bridge free-wheels", bridge_free_wheels},
    {"every deck completes", every_deck_completes},
    {"tables are short", tables_are_short},
    {"exported", exported},
};

int main(void) {
  return program_suite("decks", TESTS, COUNT(TESTS));
}
