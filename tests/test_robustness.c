/* SPDX-License-Identifier: GPL-3.0-or-later
 * The paper's converter over angles, snubbers, sources, thyristors and tolerances: every case comes
 * to its end, and gives the same whatever the tolerance. A few cases here; all of them with
 * tools/test --long, which writes robustness.csv (committed in tests/long), and beside each how its
 * exported deck does under plain ngspice. */
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "command/export.h"
#include "scene/ladder.h"
#include "suite.h"

static const char *const THYRISTORS[] = {"latch",   "thyristor_2t", "BT151-800R",
                                         "TYN1012", "TYN1212",      "12TTS08S"};
static const char *const TOLERANCES[] = {"1e-3", "1e-4", "1e-5", "1e-6"};
enum { CIRCUITS = 120, N_TOLERANCES = COUNT(TOLERANCES), N_SETS = 10 };

/* A quasi-random point of the ranges that an engineer would sweep. */
typedef struct circuit {
  double angle_deg, r1_ohm, c1_f, l_source_h;
  const char *thyristor;
} circuit;

static circuit circuit_at(int number) {
  double x[4];
  gsl_qrng *sobol = gsl_qrng_alloc(gsl_qrng_sobol, 4);
  for (int k = 0; k <= number; k++) gsl_qrng_get(sobol, x);
  gsl_qrng_free(sobol);
  return (circuit){80 + 90 * x[0], 10 * pow(400, x[1]), 10e-9 * pow(100, x[2]),
                   10e-6 * pow(500, x[3]), THYRISTORS[(size_t)number % COUNT(THYRISTORS)]};
}

/* Two shots, in the first and the third cycle. */
static void keys(const circuit *c, const char *tolerance, char text[N_SETS][64],
                 const char *sets[N_SETS + 1]) {
  int n = 0;
#define KEY(...) snprintf(text[n++], sizeof text[0], __VA_ARGS__)
  KEY("circuit.deck=halfwave_paper");
  KEY("run.until=60ms");
  KEY("firing.every=2");
  KEY("firing.angle=%.9gdeg", c->angle_deg);
  KEY("circuit.r1=%.9gohm", c->r1_ohm);
  KEY("circuit.c1=%.9gF", c->c1_f);
  KEY("supply.inductance=%.9gH", c->l_source_h);
  KEY("circuit.thyristor=%s", c->thyristor);
  KEY("run.tolerance=%s", tolerance);
#undef KEY
  for (int k = 0; k < n; k++) sets[k] = text[k];
  sets[n] = NULL;
}

typedef struct outcome {
  vs_status status;
  int rung; /* of the ladder */
  long steps;
  double p_first_peak_m, v_ak_min_v, v_ak_max_v;
  char why[200]; /* it had to climb, or failed */
} outcome;

static double extreme_of(const vs_trial *t, const char *probe, int sense) {
  for (int k = 0; k < t->result.watchers.measures->n_extremes; k++) {
    const vs_extreme *e = &t->result.watchers.measures->extremes[k];
    if (!strcmp(vs_channel_at(&t->result.scene->frame, e->channel).name, probe) &&
        e->sense * sense > 0)
      return e->best.value;
  }
  return NAN;
}

static outcome run_case(const char *const *sets) {
  const char *all[N_SETS + 2] = {"run.ladder=ideal"};
  for (size_t n = 0; sets[n]; n++) all[n + 1] = sets[n];
  vs_trial *t = vs_trial_run("paper", "circuit", all, NULL);
  outcome o = {.status = t->status,
               .rung = t->result.ladder.rung,
               .steps = t->result.steps,
               .p_first_peak_m = t->result.values[VS_M_GAP_FIRST].value,
               .v_ak_min_v = t->status ? NAN : extreme_of(t, "v_ak", -1),
               .v_ak_max_v = t->status ? NAN : extreme_of(t, "v_ak", 1)};
  const char *why = o.rung ? t->result.ladder.failed : t->err.text;
  snprintf(o.why, sizeof o.why, "%.*s", 199, why);
  vs_trial_free(t);
  return o;
}

/* Does plain ngspice come to the end of the exported deck? */
static bool exported_runs(const char *const *sets) {
  size_t n = 0;
  vs_error err = {0};
  while (sets[n]) n++;
  remove("x.txt");
  vs_status status = vs_export_command("paper", (char *const *)(size_t)sets, n, "x.cir", &err);
  EXPECT(status == VS_OK, "%s", err.text);
  int how = system("timeout 30 ngspice -b x.cir >x.log 2>&1");
  return WIFEXITED(how) && WEXITSTATUS(how) == 0;
}

typedef struct tally {
  int cases, failed, climbed, exported, exported_failed;
  double worst_p, worst_v; /* furthest from the tightest tolerance's, of 1e-4 and 1e-5 */
} tally;

static void add_row(FILE *table, const circuit *c, const char *tolerance, const outcome *o,
                    const outcome *tight, const char *exported) {
  fprintf(table, "%.4g,%.4g,%.4g,%.4g,%s,%s,%d,%d,%ld,%.7g,%.6g,%.6g,%.1e,%s,\"%s\"\n",
          c->angle_deg, c->r1_ohm, 1e9 * c->c1_f, 1e3 * c->l_source_h, c->thyristor, tolerance,
          (int)o->status, o->rung, o->steps, o->p_first_peak_m, o->v_ak_min_v, o->v_ak_max_v,
          o->p_first_peak_m / tight->p_first_peak_m - 1, exported, o->why);
  fflush(table);
}

static void run_circuit(int number, FILE *table, tally *sum) {
  circuit c = circuit_at(number);
  outcome o[N_TOLERANCES];
  const char *exported[N_TOLERANCES];
  for (int k = 0; k < N_TOLERANCES; k++) {
    char text[N_SETS][64];
    const char *sets[N_SETS + 1];
    keys(&c, TOLERANCES[k], text, sets);
    o[k] = run_case(sets);
    sum->cases++;
    sum->failed += o[k].status != VS_OK;
    sum->climbed += o[k].rung > 0;
    EXPECT(o[k].status == VS_OK, "circuit %d, tolerance %s: %s", number, TOLERANCES[k], o[k].why);
    exported[k] = "";
    if (!table) continue;
    bool good = exported_runs(sets);
    sum->exported++;
    sum->exported_failed += !good;
    exported[k] = good ? "done" : "failed";
  }
  const outcome *tight = &o[N_TOLERANCES - 1];
  for (int k = 0; k < N_TOLERANCES; k++) {
    if (table) add_row(table, &c, TOLERANCES[k], &o[k], tight, exported[k]);
    if (o[k].status || tight->status || k == 0) continue;
    double scale = fabs(tight->v_ak_min_v);
    sum->worst_p = fmax(sum->worst_p, fabs(o[k].p_first_peak_m / tight->p_first_peak_m - 1));
    sum->worst_v = fmax(sum->worst_v, fabs(o[k].v_ak_min_v - tight->v_ak_min_v) / scale);
  }
}

/* 5 of the circuits; 1 % is what the commutation overvoltage may change from 1e-4 to 1e-6. */
static void a_few(void) {
  tally sum = {0};
  if (getenv("VS_LONG")) return;
  for (int k = 1; k < 30; k += 7) run_circuit(k, NULL, &sum);
  printf(" %d cases, %d on a higher rung, v_ak_min within %.1e ", sum.cases, sum.climbed,
         sum.worst_v);
  CU_ASSERT_EQUAL(sum.climbed, 0);
  CU_ASSERT(sum.worst_v < 0.01);
}

static void all_of_them(void) {
  tally sum = {0};
  if (!getenv("VS_LONG")) return;
  FILE *table = fopen("robustness.csv", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(table);
  fputs("angle_deg,r1_ohm,c1_nf,l_source_mh,thyristor,tolerance,status,rung,steps,p_first_peak_m,"
        "v_ak_min_v,v_ak_max_v,p_first_peak_from_1e-6,exported,why\n",
        table);
  for (int k = 0; k < CIRCUITS; k++) run_circuit(k, table, &sum);
  fclose(table);
  printf(" %d cases: %d failed, %d on a higher rung; p_first_peak within %.1e, v_ak_min %.1e; "
         "%d exported: %d failed ",
         sum.cases, sum.failed, sum.climbed, sum.worst_p, sum.worst_v, sum.exported,
         sum.exported_failed);
  CU_ASSERT_EQUAL(sum.failed, 0);
}

static const vs_test TESTS[] = {
    {"a few circuits", a_few},
    {"all circuits (long)", all_of_them},
};
VS_SUITE_MAIN("robustness", TESTS)
