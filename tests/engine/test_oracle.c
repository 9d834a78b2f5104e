/* SPDX-License-Identifier: GPL-3.0-or-later
 * The tests' own reference solver against solutions that others made. */
#include "oracle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "suite.h"

static double *solve(const char *tier, oracle_kind kind, const char *const *sets,
                     oracle_scene *scene, oracle_events *events) {
  vs_trial *t = vs_trial_read("paper", tier, sets);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  *scene = oracle_of(&t->scene.setup, kind);
  scene->circuit.leaks_on = false; /* as T3A has it */
  double *table = vs_alloc(scene->rows * ORACLE_COLUMNS, sizeof *table);
  CU_ASSERT_TRUE_FATAL(oracle_run(scene, table, events));
  vs_trial_free(t);
  return table;
}

/* Worst difference of each column from a file's, in parts of that column's peak. */
static void compare(const char *file, const double *table, size_t stride, double tolerance) {
  char path[512], line[1024];
  snprintf(path, sizeof path, "%s/reference/%s", VS_TEST_FOLDER, file);
  FILE *f = fopen(path, "r");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  double worst[ORACLE_COLUMNS] = {0}, peak[ORACLE_COLUMNS] = {0};
  size_t rows = 0;
  CU_ASSERT_PTR_NOT_NULL(fgets(line, sizeof line, f));
  while (fgets(line, sizeof line, f)) {
    char *rest = strchr(line, ',');
    rows++;
    for (int k = 0; k < ORACLE_COLUMNS && rest; k++) {
      double expected = strtod(rest + 1, &rest);
      double got = table[rows * stride * ORACLE_COLUMNS + (size_t)k];
      peak[k] = fmax(peak[k], fabs(expected));
      worst[k] = fmax(worst[k], fabs(got - expected));
    }
  }
  fclose(f);
  CU_ASSERT_EQUAL(rows, 2000);
  for (int k = 0; k < ORACLE_COLUMNS; k++)
    EXPECT(worst[k] <= tolerance * peak[k], "%s: column %d is off by %.2e of its peak", file, k,
           worst[k] / peak[k]);
}

/* The files have 12 digits. Two seconds take the oracle three, and more with sanitizers. */
static void circuit_t3a(void) {
  bool whole = getenv("VS_LONG") != NULL;
  const char *sets[] = {"circuit.deck=halfwave_snubbed", whole ? "run.until=2s" : "run.until=0.2s",
                        NULL};
  oracle_scene scene;
  oracle_events events;
  double *table = solve("circuit", ORACLE_SNUBBED, sets, &scene, &events);
  compare("T3A_200ms_every_100us.csv", table, 1, 2e-11);
  if (whole) compare("T3A_2s_every_1ms.csv", table, 10, 2e-11);
  CLOSE(events.extinct_s[0], 0.01372641535, 5e-10);
  CU_ASSERT_EQUAL(events.fired, 1);
  free(table);
}

/* Known digits of p at 0.1, 1 and 2 s (half a unit of the last is 5e-13 m, 4e-10 of the peak), and
 * of the extinction. */
static void ideal_tiers(void) {
  static const struct {
    const char *tier;
    oracle_kind kind;
    double extinct_s, p[3];
  } KNOWN[] = {{"analytic",
                ORACLE_ANALYTIC,
                0.0137254833604,
                {-7.82689909e-4, -5.67661043e-5, 2.94302354e-5}},
               {"switched",
                ORACLE_SWITCHED,
                0.0137708354356,
                {-7.83281597e-4, -5.53583399e-5, 2.94788565e-5}}};
  for (size_t k = 0; k < COUNT(KNOWN); k++) {
    oracle_scene scene;
    oracle_events events;
    double *table = solve(KNOWN[k].tier, KNOWN[k].kind, NULL, &scene, &events);
    CLOSE(events.extinct_s[0], KNOWN[k].extinct_s, 4e-12);
    for (int n = 0; n < 3; n++)
      CLOSE_OF(table[(n ? n * 10000 : 1000) * ORACLE_COLUMNS], KNOWN[k].p[n], 1.4e-3, 4e-10);
    free(table);
  }
}

/* A hundred times finer steps give the same: fired in every second cycle, with a load and a stop
 * that is met. */
static void finer_steps_change_nothing(void) {
  static const oracle_kind KINDS[] = {ORACLE_SWITCHED, ORACLE_BARE, ORACLE_SNUBBED};
  static const char *const DECKS[] = {"circuit.deck=halfwave_bare", "circuit.deck=halfwave_bare",
                                      "circuit.deck=halfwave_snubbed"};
  for (size_t k = 0; k < COUNT(KINDS); k++) {
    const char *sets[] = {DECKS[k],
                          "run.until=0.1s",
                          "firing.every=2",
                          "load.density=1 g/cm3",
                          "load.fraction=0.3",
                          "firing.angle=80deg",
                          "start.p=-5mm",
                          "actuator.stop={stiffness: 2e7 N/m, damping: 500 N.s/m}",
                          NULL};
    oracle_scene scene;
    oracle_events events;
    double *table = solve("circuit", KINDS[k], sets, &scene, &events);
    double *finer = vs_alloc(scene.rows * ORACLE_COLUMNS, sizeof *finer);
    scene.tolerance = 1e-15;
    CU_ASSERT_TRUE_FATAL(oracle_run(&scene, finer, NULL));
    CU_ASSERT(events.fired >= 2 && events.met >= 1);
    for (size_t n = 0; n < scene.rows * ORACLE_COLUMNS; n += ORACLE_COLUMNS) {
      CLOSE_OF(table[n + ORACLE_P], finer[n + ORACLE_P], 5e-3, 1e-11);
      CLOSE_OF(table[n + ORACLE_LAMBDA], finer[n + ORACLE_LAMBDA], 1, 1e-11);
    }
    free(finer);
    free(table);
  }
}

static const vs_test TESTS[] = {
    {"the circuit T3A", circuit_t3a},
    {"the ideal tiers", ideal_tiers},
    {"finer steps change nothing", finer_steps_change_nothing},
};
VS_SUITE_MAIN("oracle", TESTS)
