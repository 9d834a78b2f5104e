/* SPDX-License-Identifier: GPL-3.0-or-later
 * Where methods tend to fail: ringing rules, stretches shorter than a step, grazing and stiff
 * contact, a thyristor at its holding current, late clocks, no damping. (Hysteresis and hammering:
 * test_stop.c. Edges of the timeline after a million cycles: test_timeline.c.) With tools/test
 * --long the million cycles are run, and million_cycles.csv written (committed in tests/long). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "bench.h"
#include "cli/export.h"
#include "plant/coil.h"
#include "suite.h"

static const double PEAK_V = 622.2539674441618; /* 440 V rms */

enum { ANALYTIC, SWITCHED, CIRCUIT };

/* A run on a tier; the circuit with nothing in it but the thyristor, all but ideal, and no
 * impedance of the mains: what the switched tier models. */
static vs_trial *run_ideal(int tier, const char *const *sets, const vs_observer *observer) {
  static const char *const IDEAL[] = {"circuit.deck=halfwave_bare",
                                      "circuit.on_voltage=0 V",
                                      "circuit.on_resistance=1e-4 ohm",
                                      "circuit.off_resistance=1000 Mohm",
                                      "supply.resistance=0",
                                      "supply.inductance=0"};
  const char *all[20] = {NULL};
  size_t n = 0;
  for (; sets[n]; n++) all[n] = sets[n];
  for (size_t k = 0; tier == CIRCUIT && k < COUNT(IDEAL); k++) all[n++] = IDEAL[k];
  return vs_trial_run("paper", vs_tiers_all[tier]->name, all, observer);
}

/* ---- a turn-off without a snubber ---- */

typedef struct after_turn_off {
  double extinct_s, most_v; /* largest |v_eva| from 0.2 ms after it on */
} after_turn_off;

static vs_status look_at_coil(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  after_turn_off *a = ctx;
  if (step->event[0] == VS_EV_EXTINCT) a->extinct_s = step->event_s[0];
  if (a->extinct_s > 0 && step->to->t_s > a->extinct_s + 2e-4)
    a->most_v = fmax(a->most_v, fabs(step->to->v_eva_v));
  return VS_OK;
}

/* The trapezoidal rule answers a current that is cut off with a voltage that changes its sign at
 * every step: here 573 V would stay for as long as 1.6 H / R_off is short beside a step. The steps
 * behind a turn-off are so short that it does not come to that: the coil's voltage is what the
 * leakage through R_off makes of it (0.4 V at 1 Mohm), and the thyristor's never more than the
 * mains' peak, to 1e-4; nor is it missed by more than a step in the crest leaves, 3e-4. */
static void ringing(void) {
  static const char *const OFF[] = {"circuit.off_resistance=1 Mohm",
                                    "circuit.off_resistance=10 Mohm"},
                           *const METHOD[] = {"run.method=trap", "run.method=gear"},
                           *const TOLERANCE[] = {"run.tolerance=1e-3", "run.tolerance=1e-5"};
  for (int k = 0; k < 8; k++) {
    const char *sets[] = {"circuit.deck=halfwave_bare", "run.until=40ms",  OFF[k & 1],
                          METHOD[k >> 1 & 1],           TOLERANCE[k >> 2], NULL};
    after_turn_off a = {0};
    vs_observer observer = {&a, look_at_coil};
    vs_trial *t = vs_trial_run("paper", "circuit", sets, &observer);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    double least = run_extreme(t, "v_ak", -1), largest = run_extreme(t, "v_ak", 1);
    printf(" %.2g", a.most_v);
    CU_ASSERT(a.most_v < (k & 1 ? 0.05 : 0.5));
    EXPECT(least > -PEAK_V * (1 + 1e-4) && least < -PEAK_V * (1 - 3e-4), "%s %s %s: %.8g V",
           OFF[k & 1], METHOD[k >> 1 & 1], TOLERANCE[k >> 2], least);
    EXPECT(largest < PEAK_V * (1 + 1e-4) && largest > PEAK_V * (1 - 3e-4), "%s %s %s: %.8g V",
           OFF[k & 1], METHOD[k >> 1 & 1], TOLERANCE[k >> 2], largest);
    vs_trial_free(t);
  }
}

/* ---- shorter than a step ---- */

/* Eq. 91: the current of R and L(0), A, at an angle of the mains, rad. */
static double current_91(double alpha, double angle) {
  double x = 100 * M_PI * 1.6, z = hypot(92, x), theta = atan(x / 92);
  return PEAK_V / z * (sin(angle - theta) - sin(alpha - theta) * exp((alpha - angle) / tan(theta)));
}

/* Its largest value, and where it ends. */
static double peak_91(double alpha, double *beta) {
  double lo = alpha, hi = 2 * M_PI, third;
  for (int n = 0; n < 200; n++) { /* one maximum between: halves of the bracket */
    double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;
    if (current_91(alpha, a) < current_91(alpha, b))
      lo = a;
    else
      hi = b;
  }
  third = lo;
  for (lo = third, hi = 2 * M_PI; hi - lo > 1e-15 * hi;) {
    double mid = (lo + hi) / 2;
    if (mid <= lo || mid >= hi) break;
    if (current_91(alpha, mid) > 0)
      lo = mid;
    else
      hi = mid;
  }
  *beta = lo;
  return current_91(alpha, third);
}

/* Conductions down to 11 us, on all tiers, whose longest steps are 0.4 ms (analytic, switched) and
 * 25 us. The machine hardly moves: one closed form for all. The circuit tier has its firing and
 * extinction from 10 uA on (test_small_conductions.c); its current has 0.6 uA of leakage (1 Gohm).
 */
static void conductions_shorter_than_a_step(void) {
  static const double ANGLE_DEG[] = {170, 175, 178, 179, 179.5, 179.9};
  for (size_t k = 0; k < COUNT(ANGLE_DEG); k++) {
    double alpha = ANGLE_DEG[k] * M_PI / 180, beta, peak = peak_91(alpha, &beta);
    char angle[64];
    snprintf(angle, sizeof angle, "firing.angle=%.17g deg", ANGLE_DEG[k]);
    for (int tier = ANALYTIC; tier <= CIRCUIT; tier++) {
      const char *sets[] = {angle, "run.until=20ms", "run.tolerance=1e-4", NULL};
      vs_trial *t = run_ideal(tier, sets, NULL);
      CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
      printf(" %.0e", fabs(t->result.values[VS_M_I_PEAK].value / peak - 1));
      CLOSE(t->result.values[VS_M_I_PEAK].value, peak, tier == CIRCUIT ? 1e-3 : 1e-6);
      if (tier < CIRCUIT) { /* to a nanosecond, or a part of itself */
        CLOSE_OF(t->result.values[VS_M_T_EXTINCTION].value, beta / (100 * M_PI), 1, 1e-9);
        CLOSE_OF(t->result.values[VS_M_CONDUCTION].value, (beta - alpha) / (100 * M_PI), 1, 1e-9);
      }
      vs_trial_free(t);
    }
  }
}

/* A gate pulse of a microsecond, or a tenth, in steps of a tenth of a millisecond: both its edges
 * are ends of steps, and the thyristor fires. */
static void a_pulse_shorter_than_a_step(void) {
  static const char *const WIDTH[] = {"firing.pulse_width=8 ms", "firing.pulse_width=1 us",
                                      "firing.pulse_width=0.1 us"};
  for (int deck = 0; deck < 2; deck++) {
    double first[3];
    for (int k = 0; k < 3; k++) {
      const char *sets[] = {WIDTH[k], "run.until=30ms", "run.max_step=100us",
                            deck ? "circuit.deck=halfwave_snubbed" : "circuit.deck=halfwave_bare",
                            NULL};
      vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
      CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
      first[k] = t->result.values[VS_M_GAP_FIRST].value;
      vs_trial_free(t);
    }
    CLOSE(first[1], first[0], 1e-4);
    CLOSE(first[2], first[0], 1e-4);
  }
}

/* ---- contact ---- */

typedef struct contacts {
  int met, left;
  double meets_s, in_m_s, out_m_s; /* the first: when; velocities of p there and as it leaves */
} contacts;

static vs_status note(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  contacts *c = ctx;
  for (int k = 0; k < 2; k++) {
    double v = step->to->x[VS_DOF + P]; /* a contact is the end of a step */
    if (step->event[k] == VS_EV_MEETS_STOP && !c->met++)
      c->in_m_s = v, c->meets_s = step->event_s[k];
    if (step->event[k] == VS_EV_LEAVES_STOP && !c->left++) c->out_m_s = v;
  }
  return VS_OK;
}

/* Fired in every cycle, 0.1 s: least p. stop: NULL, or what it is. */
static double least_p(int tier, double angle_deg, const char *stop, contacts *c) {
  char angle[64];
  snprintf(angle, sizeof angle, "firing.angle=%.17g deg", angle_deg);
  const char *sets[] = {angle,
                        "firing.every=1",
                        "run.until=0.1s",
                        tier == CIRCUIT ? "run.tolerance=1e-4" : "run.tolerance=1e-8",
                        stop ? stop : "actuator.stop={stiffness: 1 N/m, damping: 0}",
                        NULL};
  vs_observer observer = {c, note};
  vs_trial *t = run_ideal(tier, sets, &observer);
  EXPECT(t->status == VS_OK, "%s: %s", angle, t->err.text);
  double p = t->result.values[VS_M_GAP_MIN].value;
  CU_ASSERT(fabs(t->result.watchers.energy.residual[VS_B_MECHANICAL]) < 1e-6);
  vs_trial_free(t);
  return p;
}

/* From 88.998 degrees down the start-up transient reaches the pole cover. On either side of that
 * angle, ever nearer to it, p dips below -D by as much as it should or not at all: the contact is
 * found although p lies above -D at both ends of the steps around it, it is left again, and its
 * depth goes to zero in proportion. */
static void grazing_contact(void) {
  static const char STOP[] = "actuator.stop={stiffness: 1e7 N/m, damping: 300 N.s/m}";
  double lo = 88.9, hi = 89.1;
  for (int n = 0; n < 40; n++) { /* with a stop that is hardly there */
    contacts c = {0};
    double mid = (lo + hi) / 2, p = least_p(SWITCHED, mid, NULL, &c);
    if (p < -6e-3)
      lo = mid;
    else
      hi = mid;
  }
  CLOSE_OF(lo, 88.998, 1, 1e-3); /* the reference's digits */
  for (double by = 1e-2; by > 1e-8; by /= 10) {
    contacts in = {0}, out = {0}, soft = {0};
    double p = least_p(SWITCHED, lo - by, STOP, &in) + 6e-3;
    double q = least_p(SWITCHED, lo - by, NULL, &soft) + 6e-3;
    CU_ASSERT(in.met == 1 && in.left == 1);
    CU_ASSERT(soft.met == 1 && soft.left == 1);
    CLOSE(q, -2.458e-4 * by, 0.01); /* m per degree */
    CU_ASSERT(p < 0 && p > q);
    CU_ASSERT(least_p(SWITCHED, hi + by, STOP, &out) > -6e-3);
    CU_ASSERT_EQUAL(out.met, 0);
  }
  for (double by = 1e-3; by > 1e-6; by /= 10) { /* to the circuit tier's own accuracy */
    contacts c = {0};
    CLOSE(least_p(CIRCUIT, lo - by, STOP, &c), -6e-3, 1e-4);
    CU_ASSERT_EQUAL(c.met, c.left);
  }
}

/* Through stiff stops, each tier with an explicit integrator, whose steps must follow (they would
 * be unstable beyond some 3/w). Against the contact of one mass with spring and damper, which is
 * the more exact the shorter it is: depth v/w e^(-zeta phi/sqrt(1-zeta^2)), tan phi =
 * sqrt(1-zeta^2)/zeta, and the velocity comes back as e^(-pi zeta/sqrt(1-zeta^2)). (The hardest
 * is touched for 3 us, which is one step of the circuit tier's: its dense output, not the
 * integration, is 2 % off in the depth, a millionth of a metre.) */
static void stiff_stops(void) {
  static const struct {
    const char *text;
    double k, c, tolerance; /* the mains and the other springs meanwhile */
  } ROWS[] = {{"actuator.stop={stiffness: 1e8 N/m, damping: 300 N.s/m}", 1e8, 300, 0.06},
              {"actuator.stop={stiffness: 1e9 N/m, damping: 20000 N.s/m}", 1e9, 2e4, 0.05},
              {"actuator.stop={stiffness: 1e10 N/m, damping: 300 N.s/m}", 1e10, 300, 0.006},
              {"actuator.stop={stiffness: 9e11 N/m, damping: 300 N.s/m}", 9e11, 300, 0.03}};
  for (size_t k = 0; k < COUNT(ROWS); k++)
    for (int tier = SWITCHED; tier <= CIRCUIT; tier++) {
      const char *sets[] = {"firing.angle=80 deg", "firing.every=1", "run.until=55ms", ROWS[k].text,
                            NULL};
      contacts c = {0};
      vs_observer observer = {&c, note};
      vs_trial *t = run_ideal(tier, sets, &observer);
      CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
      CU_ASSERT_FATAL(c.met == 1 && c.left == 1);
      double inverse = fabs(t->scene.setup.model.mf[P]), w = sqrt(ROWS[k].k * inverse);
      double zeta = ROWS[k].c * inverse / (2 * w), root = sqrt(1 - zeta * zeta);
      double depth = -c.in_m_s / w * exp(-zeta / root * atan2(root, zeta));
      printf(" %.1e/%.1e", fabs((-6e-3 - t->result.values[VS_M_GAP_MIN].value) / depth - 1),
             fabs(c.out_m_s / -c.in_m_s / exp(-M_PI * zeta / root) - 1));
      CLOSE(-6e-3 - t->result.values[VS_M_GAP_MIN].value, depth, ROWS[k].tolerance);
      CLOSE(c.out_m_s / -c.in_m_s, exp(-M_PI * zeta / root), ROWS[k].tolerance);
      CU_ASSERT(fabs(t->result.watchers.energy.residual[VS_B_MECHANICAL]) <
                (tier == CIRCUIT ? 1e-3 : 1e-8));
      vs_trial_free(t);
    }
}

/* ---- a thyristor at its holding current ---- */

typedef struct flips {
  long steps, times; /* how often the voltage passes half of the supply */
  bool off;
} flips;

static void count_flips(void *ctx, double t_s, const double *signals) {
  (void)t_s;
  flips *f = ctx;
  bool off = signals[0] > 6;
  if (f->steps++ && off != f->off) f->times++;
  f->off = off;
}

/* 12 V through a resistance: four times the latching current for 1 ms, then `part` of the holding
 * current, with a ripple of a fifth at 5 kHz on it, for 4 ms. */
static flips hold_at(const char *part, double ratio, double gate) {
  char deck[512];
  flips f = {0};
  vs_error err = {0};
  bench look = {.deck = "", .signals = {"v(a)"}};
  snprintf(deck, sizeof deck, "*$ param thyristor = %s part\nXthy a 0 g thyristor\nRg g 0 1e6\n",
           part);
  look.deck = deck;
  double hold = bench_value_of(&look, "holding_current");
  double latch = bench_value_of(&look, "latching_current");
  double trigger = 3 * bench_value_of(&look, "gate_current");
  char circuit[1024];
  snprintf(circuit, sizeof circuit,
           "%sB1 0 a I = (time < 1m ? %.9g : %.9g*(1+0.2*sin(31415.9*time)))*(1-v(a)/12)\n"
           "Ig 0 g pwl(0 %.9g 0.2m %.9g 0.201m %.9g)\n",
           deck, 4 * latch, ratio * hold, trigger, trigger, gate * trigger);
  bench b = {.deck = circuit,
             .signals = {"v(a)"},
             .until_s = 5e-3,
             .max_step_s = 5e-6,
             .relative_tolerance = 1e-4,
             .current_tolerance_a = 1e-9,
             .gear = true,
             .see = count_flips,
             .ctx = &f};
  vs_status s = bench_run(&b, &err);
  EXPECT(s == VS_OK, "%s at %g of its holding current: %s", part, ratio, err.text);
  return f;
}

/* Above it it stays on, below it goes off and stays off; about it, it goes once at the most: no
 * chatter, nor steps without end (1000 are asked for). */
static void at_the_holding_current(void) {
  static const char *const PARTS[] = {"thyristor_2t", "BT151-800R", "TYN1212"};
  for (size_t k = 0; k < COUNT(PARTS); k++) {
    double highest = 0; /* at which it goes off */
    for (double ratio = 0.6; ratio < 1.65; ratio += 0.1) {
      flips f = hold_at(PARTS[k], ratio, 0);
      EXPECT(f.times <= 2, "%s at %g: %ld flips", PARTS[k], ratio, f.times);
      if (f.off) highest = ratio;
      if (ratio < 0.75) CU_ASSERT(f.off);
      if (ratio > 1.35) CU_ASSERT_FALSE(f.off);
      CU_ASSERT(f.steps < 10000);
    }
    printf(" off up to %.1f", highest);
  }
}

typedef struct events_seen {
  int fires, extinct;
} events_seen;

static vs_status see_events(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  events_seen *seen = ctx;
  seen->fires += step->event[0] == VS_EV_FIRES;
  seen->extinct += step->event[0] == VS_EV_EXTINCT;
  return VS_OK;
}

/* Angles so late that the current of the coil is of the order of the latching and holding current,
 * with the snubber's discharge before it: at most one firing and one extinction in a cycle. */
static void late_firing_does_not_chatter(void) {
  static const char *const PARTS[] = {"circuit.thyristor=thyristor_2t",
                                      "circuit.thyristor=BT151-800R"},
                           *const ANGLES[] = {"firing.angle=165 deg", "firing.angle=174 deg"};
  for (int k = 0; k < 4; k++) {
    const char *sets[] = {PARTS[k & 1],     ANGLES[k >> 1],       "firing.every=1",
                          "run.until=60ms", "run.tolerance=1e-3", NULL};
    events_seen seen = {0};
    vs_observer observer = {&seen, see_events};
    vs_trial *t = vs_trial_run("paper", "circuit", sets, &observer);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    CU_ASSERT(seen.fires >= 2 && seen.fires <= 3);
    CU_ASSERT(seen.extinct <= seen.fires);
    CU_ASSERT(t->result.steps < 20000);
    vs_trial_free(t);
  }
}

/* ---- late clocks ---- */

static vs_status keep_last(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  vs_step_copy_knot(step->frame, step->to, ctx);
  return VS_OK;
}

/* One shot after many quiet cycles is the shot of the first cycle, all of it moved by whole
 * periods, as well as a double holds the time: half an ulp of it times the working mode's frequency
 * (1e-9 after a million cycles), and the reference's digits. */
static void shot_after(long cycles) {
  char first[64], until[64];
  snprintf(first, sizeof first, "firing.first_cycle=%ld", cycles + 1);
  snprintf(until, sizeof until, "run.until=%ld ms", 20 * (cycles + 1));
  const char *sets[] = {first, until, "run.tolerance=1e-8", NULL};
  vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  double later = 0.02 * (double)cycles, ulp = 2.3e-16 * later;
  CLOSE(t->result.values[VS_M_GAP_FIRST].value, -0.00141639233706, 1e-9 + 356 * ulp);
  CLOSE_OF(t->result.values[VS_M_T_FIRE].value - later, 0.02 * 100 / 360, 1, 1e-15 + 2 * ulp);
  CLOSE_OF(t->result.values[VS_M_T_EXTINCTION].value - later, 0.0137708354356, 1, 2e-13 + 2 * ulp);
  vs_trial_free(t);
}

static void late_shot(void) {
  shot_after(20000);
  if (getenv("VS_LONG")) shot_after(1000000);
}

/* Fired in each of a million cycles: every one fires, at its time, and the orbit is still the
 * reference's. */
typedef struct long_run {
  double period_s, fires_s; /* the cycle's length; the first firing */
  long fires;
  double worst_s; /* of all firings against n periods behind the first */
  double from_s, p_min_m;
} long_run;

static vs_status follow(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  long_run *r = ctx;
  if (step->event[0] == VS_EV_FIRES) {
    double due = r->fires_s + (double)r->fires++ * r->period_s;
    r->worst_s = fmax(r->worst_s, fabs(step->event_s[0] - due));
  }
  if (step->to->t_s < r->from_s) return VS_OK;
  enum { PARTS = 256 }; /* of a step of at most 1 ms: what is between two hides 2e-7 of p_min */
  for (int k = 1; k <= PARTS; k++)
    r->p_min_m =
        fmin(r->p_min_m,
             vs_step_channel(step, step->from->t_s + (step->to->t_s - step->from->t_s) * k / PARTS,
                             VS_CH_P));
  return VS_OK;
}

static void a_million_cycles(void) {
  long cycles = getenv("VS_LONG") ? 1000000 : 5000;
  char until[64];
  snprintf(until, sizeof until, "run.until=%ld ms", 20 * cycles);
  const char *sets[] = {"firing.every=1", until, NULL};
  long_run r = {0.02, 0.02 * 100 / 360, 0, 0, 0.02 * (double)cycles - 1, 0};
  vs_observer observer = {&r, follow};
  vs_trial *t = vs_trial_run("paper", "switched", sets, &observer);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  CU_ASSERT_EQUAL(r.fires, cycles);
  CU_ASSERT(r.worst_s < 3e-16 * 0.02 * (double)cycles + 1e-15);
  printf(" %ld firings, none off by more than %.1e s", r.fires, r.worst_s);
  if (getenv("VS_LONG")) {
    FILE *table = fopen("million_cycles.csv", "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(table);
    fprintf(table, "cycles,firings,worst_firing_s,p_min_m,reference_m\n%ld,%ld,%.2e,%.10e,%.10e\n",
            cycles, r.fires, r.worst_s, r.p_min_m, -2.137732828e-3);
    fclose(table);
  }
  /* 100 s leave exp(-100/58) of the slowest mode, which has hardly a part in p */
  CLOSE(r.p_min_m, -2.137732828e-3, cycles > 100000 ? 1e-6 : 1e-4);
  vs_trial_free(t);
}

/* ---- no damping ---- */

#define UNDAMPED                                                                                   \
  "machine.spring_damping=0", "machine.mount_damping_x=0", "machine.mount_damping_y=0",            \
      "firing.first_cycle=1000000000"

static double energy_of(const vs_model *m, const double x[VS_STATES]) {
  return vs_mechanics_kinetic_energy(m, x + VS_DOF) + vs_mechanics_elastic_energy(m, x);
}

/* Released in its working mode's shape: the amplitude after 10,000 periods, from the energy. */
static void free_oscillation(void) {
  const char *sets[] = {UNDAMPED, "run.until=176.7523 s", NULL};
  vs_trial *t = vs_trial_read("paper", "switched", sets);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  const vs_model *m = &t->scene.setup.model;
  vs_mode modes[VS_MOST_STATES];
  vs_mechanics_modes(m, modes);
  CLOSE(modes[6].frequency_hz, 56.577111, 1e-7);
  for (int i = 0; i < VS_DOF; i++) t->scene.setup.start.x[i] = 1e-3 * modes[6].shape_re[i];
  vs_knot *last = vs_alloc(1, sizeof *last);
  vs_observer observer = {last, keep_last};
  double before = energy_of(m, t->scene.setup.start.x);
  vs_trial_go(t, &observer);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  double error = (energy_of(m, last->x) - before) / (2 * before);
  printf(" %.1e", error);
  CU_ASSERT(fabs(error) < 1e-9);
  CU_ASSERT(last->t_s * modes[6].frequency_hz > 10000);
  free(last);
  vs_trial_free(t);
}

/* Amplitudes of the first and the last maximum of the second column that has both its neighbours in
 * the table, by the parabola through the three; and how many there are. */
static int maxima(const char *path, double *first, double *last) {
  double y[3] = {0};
  char line[1024];
  int rows = 0, count = 0;
  FILE *f = fopen(path, "r");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  while (fgets(line, sizeof line, f)) {
    y[0] = y[1], y[1] = y[2];
    if (sscanf(line, "%*g %lf", &y[2]) != 1 || ++rows < 3) continue;
    if (!(y[1] > y[0] && y[1] >= y[2])) continue;
    *last = y[1] + (y[2] - y[0]) * (y[2] - y[0]) / (8 * (2 * y[1] - y[0] - y[2]));
    if (!count++) *first = *last;
  }
  fclose(f);
  return count;
}

/* The same, exported for plain ngspice: Gear's rule in steps of 100 us loses pi/2 (w h)^3 of the
 * amplitude in every period, half of it in 10,000; 50 us leave 92 %, 25 us 99 %. */
static void gear_loses_it(void) {
  const char *sets[] = {UNDAMPED,
                        "start.p=1 mm",
                        "start.u=0.167715 mm",
                        "start.w=-0.0656824 mm",
                        "start.phi=0.000208731 rad",
                        "circuit.deck=halfwave_bare",
                        "run.method=gear",
                        "run.max_step=100us",
                        "run.until=1s"};
  double first = 0, last = 0, wh = 2 * M_PI * 56.577111 * 100e-6;
  vs_error err = {0};
  if (!on_path("ngspice")) return;
  remove("free.txt");
  CU_ASSERT_EQUAL_FATAL(
      vs_export_command("paper", (char *const *)(size_t)sets, COUNT(sets), "free.cir", &err),
      VS_OK);
  int how = system("ngspice -b free.cir >free.log 2>&1");
  CU_ASSERT_FATAL(WIFEXITED(how) && WEXITSTATUS(how) == 0);
  int n = maxima("free.txt", &first, &last);
  CU_ASSERT(n > 50);
  double loss = -log(last / first) / (n - 1);
  printf(" %.3e a period: %.3f after 10,000", loss, exp(-1e4 * loss));
  CLOSE(loss, M_PI / 2 * wh * wh * wh, 0.05);
}

static void note_gear(void *ctx, const char *text) {
  int *told = ctx;
  *told += strstr(text, "run.method: gear makes an error of its phase") != NULL;
}

static int told_of_gear(const char *const *sets) {
  int told = 0;
  vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  if (!t->status) vs_result_warnings(&t->result, note_gear, &told);
  vs_trial_free(t);
  return told;
}

/* A coil that is cut off rings with its contact by 12 kHz. After 15 ms Gear's rule has the current
 * 73 tolerances off, the trapezoidal one 1.7: the one tells it. What the snubbers damp it may take,
 * and tells nothing. */
static void gear_tells_of_a_long_ring(void) {
  const char *sets[] = {
      "run.until=16 ms",    "run.tolerance=1e-3",    "supply.voltage=290 V", "run.method=gear",
      "events.e.kind=open", "events.e.element=Xeva", "events.e.at=1 ms",     NULL};
  CU_ASSERT_EQUAL(told_of_gear(sets), 1);
  sets[3] = "run.method=trap";
  CU_ASSERT_EQUAL(told_of_gear(sets), 0);
  sets[3] = "run.method=gear";
  sets[4] = NULL;
  CU_ASSERT_EQUAL(told_of_gear(sets), 0);
}

static const vs_test TESTS[] = {
    {"ringing", ringing},
    {"conductions shorter than a step", conductions_shorter_than_a_step},
    {"a pulse shorter than a step", a_pulse_shorter_than_a_step},
    {"grazing contact", grazing_contact},
    {"stiff stops", stiff_stops},
    {"at the holding current", at_the_holding_current},
    {"late firing does not chatter", late_firing_does_not_chatter},
    {"late shot", late_shot},
    {"a million cycles", a_million_cycles},
    {"free oscillation", free_oscillation},
    {"gear loses it", gear_loses_it},
    {"gear tells of a long ring", gear_tells_of_a_long_ring},
};
VS_SUITE_MAIN("extremes", TESTS)
