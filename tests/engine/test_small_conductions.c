/* SPDX-License-Identifier: GPL-3.0-or-later
 * Conductions that are small or begin slowly, leakage that is as large as they are, and thyristors
 * that let go by their holding current: when they fire and go out. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "oracle.h"
#include "program.h"

typedef struct instants {
  double fires_s[ORACLE_EVENTS], extinct_s[ORACLE_EVENTS];
  size_t fired, ended;
} instants;

static vs_status note_step(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  instants *n = ctx;
  if (step->from->t_s == 0) *n = (instants){.fired = 0}; /* the ladder may begin anew */
  for (int k = 0; k < 2; k++) {
    if (step->event[k] == VS_EV_FIRES && n->fired < ORACLE_EVENTS)
      n->fires_s[n->fired++] = step->event_s[k];
    if (step->event[k] == VS_EV_EXTINCT && n->ended < ORACLE_EVENTS)
      n->extinct_s[n->ended++] = step->event_s[k];
  }
  return VS_OK;
}

static void instants_of(const char *const *scene, const char *tolerance, instants *seen) {
  char set[40];
  const char *sets[12];
  size_t n = 0;
  for (; scene[n]; n++) sets[n] = scene[n];
  snprintf(set, sizeof set, "run.tolerance=%s", tolerance);
  sets[n++] = set;
  sets[n++] = "run.verify=never";
  sets[n] = NULL;
  *seen = (instants){.fired = 0};
  const vs_observer observer = {seen, note_step};
  vs_trial *t = vs_trial_run("paper", "circuit", sets, &observer);
  EXPECT(t->status == VS_OK, "%s: %s", scene[1], t->err.text);
  vs_trial_free(t);
}

/* Firing within 0.1 us. Extinction within 0.1 us and what the tolerance allows of the current, over
 * its fall: below 1e-5 of the peak, over 1 % of the fall of a sine, it is a microsecond at 1e-4;
 * errors of these scenes are 0.08 us at 1e-3. */
static void against_the_oracle(void) {
  static const char *const SCENES[][6] = {
      {"circuit.deck=halfwave_bare", "firing.angle=172.38 deg", "supply.voltage=246.9 V"},
      {"circuit.deck=halfwave_bare", "firing.angle=176 deg", "supply.voltage=55 V"},
      {"circuit.deck=halfwave_bare", "firing.angle=172.5 deg", "circuit.off_resistance=60 kohm",
       "supply.voltage=258 V"},
      {"circuit.deck=halfwave_bare", "firing.angle=2 deg", "circuit.off_resistance=10 kohm",
       "supply.voltage=100 V"},
      {"circuit.deck=halfwave_bare", "firing.angle=5 deg", "circuit.off_resistance=5 kohm",
       "supply.voltage=100 V"},
      {"circuit.deck=halfwave_snubbed", "firing.angle=2.25 deg", "supply.voltage=268.8 V",
       "circuit.r1=421.7 ohm", "circuit.c1=562.3 nF"},
  };
  static const char *const TOLERANCES[] = {"1e-3", "1e-4", "1e-6"};
  for (size_t k = 0; k < COUNT(SCENES); k++) {
    const char *sets[8] = {NULL};
    size_t n = 0;
    for (; n < 6 && SCENES[k][n]; n++) sets[n] = SCENES[k][n];
    sets[n] = "run.until=20 ms";
    vs_trial *t = vs_trial_read("paper", "circuit", sets);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    oracle_scene scene = oracle_of(&t->scene.setup, k < 5 ? ORACLE_BARE : ORACLE_SNUBBED);
    oracle_events truth;
    double *table = vs_alloc(scene.rows * ORACLE_COLUMNS, sizeof *table);
    CU_ASSERT_TRUE_FATAL(oracle_run(&scene, table, &truth));
    for (size_t m = 0; m < COUNT(TOLERANCES); m++) {
      instants seen;
      instants_of(sets, TOLERANCES[m], &seen);
      EXPECT(seen.fired == truth.fired && seen.ended == truth.ended, "%s at %s: %zu, %zu events",
             sets[1], TOLERANCES[m], seen.fired, seen.ended);
      EXPECT(fabs(seen.fires_s[0] - truth.fires_s[0]) < 1e-7, "%s at %s: fires %+.3f us late",
             sets[1], TOLERANCES[m], 1e6 * (seen.fires_s[0] - truth.fires_s[0]));
      EXPECT(fabs(seen.extinct_s[0] - truth.extinct_s[0]) < 2e-7, "%s at %s: ends %+.3f us late",
             sets[1], TOLERANCES[m], 1e6 * (seen.extinct_s[0] - truth.extinct_s[0]));
    }
    free(table);
    vs_trial_free(t);
  }
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* A thyristor of two transistors whose current falls slower than its charge decays lets go at its
 * holding current. What is left decays without a zero, so that only the firing is compared. The
 * pair takes 0.33 us to fire. Where no step ends within that time it is told to fire at its gate's
 * edge, as at 2 of 55 angles: the median of five counts. */
static void letting_go(void) {
  enum { ANGLES = 5 };
  double off_s[ANGLES];
  for (int k = 0; k < ANGLES; k++) {
    char angle[40];
    snprintf(angle, sizeof angle, "firing.angle=%d.188 deg", 32 + k);
    const char *scene[] = {"circuit.deck=halfwave_snubbed",
                           "circuit.thyristor=TYN1212",
                           angle,
                           "supply.voltage=159.4 V",
                           "circuit.r1=8.66 ohm",
                           "circuit.c1=237.1 nF",
                           "run.until=16 ms",
                           NULL};
    instants coarse, fine;
    instants_of(scene, "1e-4", &coarse);
    instants_of(scene, "1e-5", &fine);
    EXPECT(coarse.ended == 1 && fine.ended == 1, "%s: %zu, %zu extinctions", angle, coarse.ended,
           fine.ended);
    off_s[k] = coarse.fires_s[0] - fine.fires_s[0];
    EXPECT(fabs(off_s[k]) < 3.3e-7, "%s: fires %+.3f us late", angle, 1e6 * off_s[k]);
  }
  qsort(off_s, ANGLES, sizeof *off_s, by_size);
  CLOSE_OF(off_s[ANGLES / 2], 0, 1, 1e-7);
}

/* Compares a run at a tolerance of 1e-4 with one at 1e-6: returns by how much later its conduction
 * ends, s. It fires at `fires_s` or up to `delay_s` later. */
static double apart_of(const char *deck, const char *angle, const char *voltage, double fires_s,
                       double delay_s) {
  char sets[3][64];
  snprintf(sets[0], sizeof sets[0], "circuit.deck=%s", deck);
  snprintf(sets[1], sizeof sets[1], "firing.angle=%s", angle);
  snprintf(sets[2], sizeof sets[2], "supply.voltage=%s", voltage);
  const char *scene[] = {sets[0], sets[1], sets[2], "run.until=15 ms", NULL};
  instants coarse, fine;
  instants_of(scene, "1e-4", &coarse);
  instants_of(scene, "1e-6", &fine);
  EXPECT(coarse.fired == 1 && coarse.ended == 1 && fine.fired == 1 && fine.ended == 1,
         "%s at %s, %s: %zu, %zu firings", deck, angle, voltage, coarse.fired, fine.fired);
  double late_s = coarse.fires_s[0] - fires_s;
  EXPECT(late_s > -1e-7 && late_s < delay_s + 1e-7, "%s at %s: fires %+.3f us late", deck, angle,
         1e6 * late_s);
  return coarse.extinct_s[0] - fine.extinct_s[0];
}

/* Where the anode probe is the sum of two thyristors' currents, each is followed by its own: small
 * conductions are seen, the firing lies at the gate pulse (a pair of transistors takes 0.3 us), and
 * the end is the thyristor's own zero, which no tolerance moves. What two transistors have stored
 * decays without a zero, so that their small conductions are compared to 0.3 us. A long
 * conduction's end scatters by 0.16 us with where the steps fall, which is 2e-5 of it; so that a
 * zero which is looked for at the wrong place shows, the mean of fifteen voltages, which that
 * scatters by 0.04 us, is compared to 0.1 us. */
static void one_of_two(void) {
  static const struct {
    const char *deck, *angle, *voltage;
    double fires_s, delay_s, apart_s;
  } ROWS[] = {
      {"bridge_halfcontrolled", "175 deg", "100 V", 9.7222222e-3, 0, 1e-7},
      {"bridge_halfcontrolled", "177 deg", "50 V", 9.8333333e-3, 0, 1e-7},
      {"fullwave_antiparallel", "177 deg", "50 V", 9.8333333e-3, 3e-7, 3e-7},
      {"fullwave_antiparallel", "177 deg", "100 V", 9.8333333e-3, 3e-7, 3e-7},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double apart_s =
        apart_of(ROWS[k].deck, ROWS[k].angle, ROWS[k].voltage, ROWS[k].fires_s, ROWS[k].delay_s);
    EXPECT(fabs(apart_s) < ROWS[k].apart_s, "%s at %s, %s: ends %.3f us apart", ROWS[k].deck,
           ROWS[k].angle, ROWS[k].voltage, 1e6 * apart_s);
  }
  enum { VOLTAGES = 15 };
  double sum_s = 0;
  for (int k = 0; k < VOLTAGES; k++) {
    char voltage[32];
    snprintf(voltage, sizeof voltage, "%.2f V", 430 + 1.37 * k);
    sum_s += apart_of("fullwave_antiparallel", "100 deg", voltage, 5.5555556e-3, 3e-7);
  }
  EXPECT(fabs(sum_s / VOLTAGES) < 1e-7, "ends %.3f us apart in the mean", 1e6 * sum_s / VOLTAGES);
}

typedef struct peaks {
  double i_a, force_n;
} peaks;

static vs_status note_peaks(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  peaks *p = ctx;
  if (step->from->t_s == 0) *p = (peaks){.i_a = 0}; /* the ladder may begin anew */
  p->i_a = fmax(p->i_a, fabs(vs_step_channel(step, step->to->t_s, VS_CH_I)));
  p->force_n = fmax(p->force_n, vs_step_channel(step, step->to->t_s, VS_CH_FORCE));
  return VS_OK;
}

static peaks peaks_of(const char *r1, double tolerance) {
  peaks seen = {.i_a = 0};
  char sets[2][40];
  snprintf(sets[0], sizeof sets[0], "circuit.r1=%s", r1);
  snprintf(sets[1], sizeof sets[1], "run.tolerance=%g", tolerance);
  const char *scene[] = {"circuit.deck=halfwave_paper",
                         "supply.phase=90 deg",
                         "firing.angle=161.783 deg",
                         "circuit.c1=9.4668 nF",
                         "events.e0.kind=short_pulse",
                         "events.e0.cycle=1",
                         "run.until=25 ms",
                         "run.verify=never",
                         sets[0],
                         sets[1],
                         NULL};
  const vs_observer observer = {&seen, note_peaks};
  vs_trial *t = vs_trial_run("paper", "circuit", scene, &observer);
  EXPECT(t->status == VS_OK, "r1 = %s at %g: %s", r1, tolerance, t->err.text);
  vs_trial_free(t);
  return seen;
}

/* Behind a short pulse the thyristor does not latch, and lets go after 0.1 ms. The peaks of the
 * coil's ring hang on that instant: the force was 14 and 24 tolerances off at 1e-4, and 9 at 1e-5,
 * from one at 1e-6. 2.4 is what docs/accuracy.md promises. */
static void behind_a_short_pulse(void) {
  static const char *const R1[] = {"4.52304 ohm", "100 ohm"};
  static const double TOLERANCES[] = {1e-3, 1e-4, 1e-5};
  for (size_t k = 0; k < COUNT(R1); k++) {
    peaks fine = peaks_of(R1[k], 1e-6);
    for (size_t m = 0; m < COUNT(TOLERANCES); m++) {
      peaks seen = peaks_of(R1[k], TOLERANCES[m]);
      double i_off = fabs(seen.i_a / fine.i_a - 1) / TOLERANCES[m];
      double force_off = fabs(seen.force_n / fine.force_n - 1) / TOLERANCES[m];
      EXPECT(fmax(i_off, force_off) <= 2.4,
             "r1 = %s at %g: i is off by %.3g of that, force by %.3g", R1[k], TOLERANCES[m], i_off,
             force_off);
    }
  }
}

static const vs_test TESTS[] = {
    {"against the oracle", against_the_oracle},
    {"letting go", letting_go},
    {"one of two", one_of_two},
    {"behind a short pulse", behind_a_short_pulse},
};
int main(void) {
  return program_suite("small_conductions", TESTS, COUNT(TESTS));
}
