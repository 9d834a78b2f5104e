/* SPDX-License-Identifier: GPL-3.0-or-later
 * Leaving ngspice when the circuit is quiet: what it is said to cost is a bound on what it costs,
 * over scenes drawn at random (6 here; 260, of which over 200 leave, with tools/test --long, which
 * writes quiet.csv, committed in tests/long); and it happens when it may, and only then. */
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "suite.h"

/* What run.tolerance is about: p, u, w, phi, force, i at samples 0.2 ms apart. */
static const int CHANNELS[] = {VS_CH_P, VS_CH_U, VS_CH_W, VS_CH_PHI, VS_CH_FORCE, VS_CH_I};
enum { N_CHANNELS = COUNT(CHANNELS), MOST_SAMPLES = 5001, N_SETS = 18 };
static const double SAMPLE_S = 2e-4;

typedef struct course {
  int count, times; /* samples; how often ngspice was left */
  double first_s, back_s, bound;
  double y[MOST_SAMPLES][N_CHANNELS];
} course;

static vs_status record(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  course *c = ctx;
  if (step->event[1] == VS_EV_QUIET) {
    if (!c->times++) c->first_s = step->event_s[1];
    c->bound = fmax(c->bound, step->bound);
  }
  if (step->event[1] == VS_EV_BACK) c->back_s = step->event_s[1];
  for (; c->count < MOST_SAMPLES && c->count * SAMPLE_S <= step->to->t_s; c->count++) {
    double all[VS_CH_MOST];
    vs_step_at(step, c->count * SAMPLE_S, all);
    for (int k = 0; k < N_CHANNELS; k++) c->y[c->count][k] = all[CHANNELS[k]];
  }
  return VS_OK;
}

/* leave: "when_quiet" or "never" */
static vs_trial *run(const char *const *sets, const char *leave, course *c) {
  const char *all[N_SETS + 2] = {NULL};
  char key[64];
  size_t n = 0;
  for (; sets[n]; n++) all[n] = sets[n];
  snprintf(key, sizeof key, "run.leave_circuit=%s", leave);
  all[n] = key;
  memset(c, 0, sizeof *c);
  const vs_observer observer = {c, record};
  vs_trial *t = vs_trial_run("paper", "circuit", all, &observer);
  EXPECT(t->status == VS_OK || strstr(t->err.text, "meets the pole cover"), "%s", t->err.text);
  return t;
}

static double difference(const course *a, const course *b) {
  double worst = 0;
  int count =
      a->count < b->count ? a->count : b->count; /* ngspice's end may be the rounding short */
  CU_ASSERT(abs(a->count - b->count) <= 1);
  for (int k = 0; k < N_CHANNELS; k++) {
    double peak = 0, off = 0;
    for (int n = 0; n < count; n++) {
      peak = fmax(peak, fabs(b->y[n][k]));
      off = fmax(off, fabs(a->y[n][k] - b->y[n][k]));
    }
    worst = fmax(worst, off / peak);
  }
  return worst;
}

static course left, stayed; /* of a scene: too large for the stack */

/* ---- scenes at random ---- */

enum { DIMENSIONS = 13, SCENES = 260, FEW = 6 };

static void scene_at(int number, char text[N_SETS][64], const char *sets[N_SETS + 1]) {
  static const char *const DECKS[] = {"halfwave_snubbed", "halfwave_snubbed",
                                      "halfwave_paper",   "fullwave_antiparallel",
                                      "halfwave_bare",    "halfwave_snubbed"};
  static const char *const TOLERANCES[] = {"1e-3", "1e-4", "3e-4", "1e-4", "3e-5"};
  double x[DIMENSIONS];
  gsl_qrng *sobol = gsl_qrng_alloc(gsl_qrng_sobol, DIMENSIONS);
  for (int k = 0; k <= number; k++) gsl_qrng_get(sobol, x);
  gsl_qrng_free(sobol);
  const char *deck = DECKS[(size_t)number % COUNT(DECKS)];
  int n = 0;
#define KEY(...) snprintf(text[n++], sizeof text[0], __VA_ARGS__)
  KEY("circuit.deck=%s", deck);
  KEY("run.tolerance=%s", TOLERANCES[(size_t)number % COUNT(TOLERANCES)]);
  KEY("run.until=%.4gs", 0.2 + 0.4 * x[0]);
  KEY("firing.angle=%.6gdeg", 85 + 70 * x[1]);
  KEY("firing.every=%s", x[2] < 0.6 ? "once" : x[2] < 0.8 ? "7" : "10");
  KEY("supply.frequency=%.6gHz", 45 + 20 * x[3]);
  KEY("supply.inductance=%.4gH", 10e-6 * pow(300, x[4]));
  KEY("actuator.resistance=%.4gohm", 40 * pow(5, x[5]));
  KEY("actuator.inductance=%.4gH", 1 + x[6]);
  KEY("load.density=1.6g/cm3");
  KEY("load.fraction=%.4g", 0.6 * x[7]);
  KEY("machine.spring_damping=%.4gN.s/m", 0.3 * pow(20, x[8]));
  if (strcmp(deck, "halfwave_bare")) {
    KEY("circuit.r1=%.4gohm", 30 * pow(100, x[9]));
    KEY("circuit.c1=%.4gnF", 10 * pow(30, x[10]));
    KEY("circuit.c2=%.4gnF", 10 * pow(30, x[11]));
    KEY("circuit.r2=%.4gohm", 50 * pow(100, x[12]));
  }
#undef KEY
  for (int k = 0; k < n; k++) sets[k] = text[k];
  sets[n] = NULL;
}

typedef struct tally {
  int cases, left, beyond;
  double worst; /* largest part of its bound that a difference was */
} tally;

static void run_scene(int number, FILE *table, tally *sum) {
  char text[N_SETS][64];
  const char *sets[N_SETS + 1];
  scene_at(number, text, sets);
  double off = 0, part = 0;
  vs_trial *a = run(sets, "when_quiet", &left);
  if (left.times) {
    vs_trial *b = run(sets, "never", &stayed);
    off = difference(&left, &stayed);
    part = off / left.bound;
    CU_ASSERT_EQUAL(stayed.times, 0);
    CU_ASSERT_EQUAL(a->status, b->status); /* one drawn is driven into the pole cover */
    vs_trial_free(b);
  }
  vs_trial_free(a);
  sum->cases++;
  sum->left += left.times > 0;
  sum->beyond += part > 1;
  sum->worst = fmax(sum->worst, part);
  EXPECT(part <= 1, "scene %d: off by %.2g, bound %.2g", number, off, left.bound);
  if (table) {
    fprintf(table, "%d,%d,%.4f,%.2e,%.2e", number, left.times, left.first_s, left.bound, off);
    for (int k = 0; sets[k]; k++) fprintf(table, ",%s", strchr(sets[k], '=') + 1);
    fputs("\n", table);
    fflush(table);
  }
}

static void a_few(void) {
  tally sum = {0};
  if (getenv("VS_LONG")) return;
  for (int k = 0; k < FEW; k++) run_scene(k, NULL, &sum);
  printf(" %d of %d scenes leave, off by %.2g of the bound at most ", sum.left, sum.cases,
         sum.worst);
  CU_ASSERT(sum.left >= FEW / 2);
}

static void all_of_them(void) {
  tally sum = {0};
  if (!getenv("VS_LONG")) return;
  FILE *table = fopen("quiet.csv", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(table);
  fputs("scene,times_left,first_s,bound,off,deck,tolerance,until,angle,every,frequency,"
        "l_source,"
        "resistance,inductance,density,fraction,spring_damping,r1,c1,c2,r2\n",
        table);
  for (int k = 0; k < SCENES; k++) run_scene(k, table, &sum);
  fclose(table);
  printf(" %d of %d scenes leave, off by %.2g of the bound at most, %d beyond ", sum.left,
         sum.cases, sum.worst, sum.beyond);
}

/* ---- when it may, and only then ---- */

/* The paper's scene: what is reported is what the run that stays reports, within the tolerance. */
static void the_same_result(void) {
  static const char *const SETS[] = {"run.until=0.6s", NULL};
  vs_trial *a = run(SETS, "when_quiet", &left), *b = run(SETS, "never", &stayed);
  double tolerance = a->scene.setup.run.tolerance;
  CU_ASSERT_EQUAL(left.times, 1);
  CU_ASSERT(left.first_s < 0.15);
  /* that of p, u, w, phi, force and i is 0.75 at most; the deck's signals, which belong into it,
   * have 3 */
  CU_ASSERT(left.bound <= 3 * tolerance && left.bound > 0);
  CU_ASSERT(difference(&left, &stayed) <= left.bound);
  CU_ASSERT(a->result.steps < b->result.steps / 2);
  for (int k = 0; k < VS_MEASURES; k++)
    if (k < VS_M_ENERGY_IN) /* the others are the energies */
      CLOSE_OF(a->result.values[k].value, b->result.values[k].value, b->result.values[k].value,
               3 * tolerance);
  for (int k = 0; k < a->result.watchers.measures->n_extremes;
       k++) /* device voltages: of the first cycles */
    CLOSE_OF(a->result.watchers.measures->extremes[k].best.value,
             b->result.watchers.measures->extremes[k].best.value,
             b->result.watchers.measures->extremes[k].best.value, 3 * tolerance);
  for (size_t k = 0; k < a->scene.setup.deck.losses.count; k++)
    CLOSE_OF(a->result.watchers.energy.loss_j[k], b->result.watchers.energy.loss_j[k],
             b->result.watchers.energy.joule[VS_E_SOURCE], tolerance);
  vs_trial_free(a);
  vs_trial_free(b);
}

/* Back before the next firing, and before an event. */
static void and_back(void) {
  static const char *const SETS[] = {"run.until=0.5s", "firing.every=12",
                                     "events.sag1={kind: sag, at: 401 ms, level: 70 %, duration: "
                                     "20 ms}",
                                     NULL};
  vs_trial *a = run(SETS, "when_quiet", &left), *b = run(SETS, "never", &stayed);
  CU_ASSERT_EQUAL(left.times, 2); /* not behind the sag: there the run ends too soon */
  CU_ASSERT(left.back_s < 0.401);
  CU_ASSERT(difference(&left, &stayed) <= a->scene.setup.run.tolerance);
  CLOSE(run_extreme(a, "v_ak", 1), run_extreme(b, "v_ak", 1), 3e-4);
  vs_trial_free(a);
  vs_trial_free(b);
}

/* One of halfwave_snubbed's lines is put before the EVA's. */
static void add_to_deck(const char *line) {
  char text[16384];
  FILE *in = fopen(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir", "r");
  CU_ASSERT_PTR_NOT_NULL_FATAL(in);
  size_t n = fread(text, 1, sizeof text - 1, in);
  fclose(in);
  text[n] = '\0';
  char *eva = strstr(text, "Xeva ");
  FILE *out = fopen("d.cir", "w");
  fprintf(out, "%.*s%s\n%s", (int)(eva - text), text, line, eva);
  fclose(out);
}

/* The snubber across the EVA may have any resistance: led back in, no device sees a blow. */
static void led_gently(void) {
  static const char *const R2[] = {"circuit.r2=1 kohm", "circuit.r2=2.2 kohm",
                                   "circuit.r2=47 kohm"};
  for (size_t r = 0; r < COUNT(R2); r++) {
    const char *sets[] = {R2[r], "firing.every=12", "run.until=0.4s", NULL};
    vs_trial *a = run(sets, "when_quiet", &left), *b = run(sets, "never", &stayed);
    /* With 47 kohm the ring of coil and C2 dies slowly, and C2's voltage lags: gone by a law it was
     * 1.8e-3 of its peak off, 33 times what was told, so ngspice may be left later, or not. */
    CU_ASSERT(r == 2 ? left.times <= 2 : left.times == 2);
    CU_ASSERT(difference(&left, &stayed) <= (left.times ? left.bound : 0));
    for (size_t d = 0; d < a->result.watchers.devices->count; d++)
      for (size_t k = 0; k < a->result.watchers.devices->item[d].count; k++) {
        const vs_reduced *x = &a->result.watchers.devices->item[d].reduced[k],
                         *y = &b->result.watchers.devices->item[d].reduced[k];
        if (!y->value.known || fabs(y->value.value) < 1e-9) continue;
        EXPECT(fabs(x->value.value / y->value.value - 1) < 0.02, "%s: %s.%s is %g, and %g", R2[r],
               a->result.watchers.devices->item[d].device->name, x->measure->name, x->value.value,
               y->value.value);
      }
    vs_trial_free(a);
    vs_trial_free(b);
  }
}

static void not_left(void) {
  static const struct {
    const char *why, *line, *set;
  } ROWS[] = {
      {"a firing in every second cycle", NULL, "firing.every=2"},
      {"a clock of the deck's own", "Vown y 0 PULSE(0 1 0.3)\nRown y 0 1k", NULL},
      {"a formula that knows the time", "Bown y 0 V = time\nRown y 0 1k", NULL},
      {"a store that empties in half a second", "Rslow b y 500\nCslow y 0 1m ic=0", NULL},
      {"a store that nobody sees", "Rhid y 0 1k\nChid y 0 1u ic=0", NULL},
      {"a coil that still freewheels", "Dfree 0 b fast\n.model fast d(is=1n n=1.8 rs=50m)", NULL},
      {"a stop within reach", NULL, "start.vp=-2.5 m/s"},
  };
  for (size_t r = 0; r < COUNT(ROWS); r++) {
    const char *sets[] = {"run.until=0.15s", "run.tolerance=1e-3",
                          ROWS[r].set ? ROWS[r].set : "circuit.deck=d.cir",
                          "actuator.stop={stiffness: 1e7 N/m, damping: 50 N.s/m}", NULL};
    if (ROWS[r].line) add_to_deck(ROWS[r].line);
    vs_trial *t = run(sets, "when_quiet", &left);
    EXPECT(left.times == 0, "left in spite of %s", ROWS[r].why);
    vs_trial_free(t);
  }
}

static const vs_test TESTS[] = {
    {"the same result", the_same_result},
    {"and back", and_back},
    {"led gently", led_gently},
    {"not left", not_left},
    {"a few scenes", a_few},
    {"all scenes (long)", all_of_them},
};
VS_SUITE_MAIN("quiet", TESTS)
