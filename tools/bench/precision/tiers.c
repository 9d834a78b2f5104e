/* SPDX-License-Identifier: GPL-3.0-or-later
 * Part b of tools/bench/work_precision: the tiers, each against an independent solution of its own
 * equations, over run.tolerance (the paper's single shot, 0.2 s) and over run.max_step (the circuit
 * tier fired in every cycle). Error: run.tolerance's norm. */
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/text.h"
#include "ngspice/ngspice.h"
#include "race.h"

typedef struct lap {
  const char *tier;
  comparison *reference;
  const vs_circuit_kind *solver;    /* NULL: the product's */
  char tolerance[48], max_step[48]; /* max_step: empty, or fired in every cycle */
} lap;

/* ngspice, but with the steps' limit the same everywhere: no shorter ones while the coil rings. */
static vs_circuit_host told; /* vs_circuit_kind has no place for it */
static double even_s;

static double evenly(void *ctx, double t_s) {
  (void)ctx, (void)t_s;
  return even_s;
}

static vs_status load_even(const vs_circuit_job *job, const vs_circuit_host *host, void **circuit,
                           vs_error *err) {
  told = *host;
  told.longest = evenly;
  even_s = job->max_step_s;
  return vs_ngspice_kind.load(job, &told, circuit, err);
}
static vs_status run_even(void *circuit, vs_error *err) {
  return vs_ngspice_kind.run(circuit, err);
}
static void free_even(void *circuit) {
  vs_ngspice_kind.free(circuit);
}
static const vs_circuit_kind EVEN = {
    .name = "ngspice, even steps", .load = load_even, .run = run_even, .free = free_even};

#define UNTIL "run.until=0.2s"
#define EVERY "firing.every=1"

static void run_lap(attempt *self) {
  const lap *l = self->with;
  const char *sets[] = {UNTIL, l->tolerance, *l->max_step ? l->max_step : NULL, EVERY, NULL};
  vs_scene *scene = race_scene(l->tier, sets);
  if (l->solver) scene->order.solver = l->solver;
  self->error = race_compare(scene, l->reference, &self->steps);
  vs_scene_free(scene);
  free(scene);
}

enum { MOST = 100 };
static lap laps[MOST];
static attempt attempts[MOST];
static size_t n;

static void add(const char *method, const char *tier, comparison *reference, double tolerance,
                double max_step_s) {
  if (n == MOST) race_give_up("too many attempts");
  lap *l = &laps[n];
  attempt *a = &attempts[n++];
  *l = (lap){.tier = tier, .reference = reference};
  snprintf(l->tolerance, sizeof l->tolerance, "run.tolerance=%g", tolerance);
  if (max_step_s > 0) snprintf(l->max_step, sizeof l->max_step, "run.max_step=%gs", max_step_s);
  *a = (attempt){.method = method, .value = tolerance, .varied = "run.tolerance"};
  if (max_step_s > 0) a->value = max_step_s, a->varied = "run.max_step_s";
  a->with = l;
  a->run = run_lap;
}

static comparison *reference_of(const char *tier, oracle_kind kind, const char *set) {
  const char *sets[] = {UNTIL, set, NULL};
  vs_scene *scene = race_scene(tier, sets);
  oracle_scene o = oracle_of(&scene->setup, kind);
  comparison *c = compare_with(&o);
  if (!c) race_give_up("the reference has no solution");
  vs_scene_free(scene);
  free(scene);
  return c;
}

int main(void) {
  static const double STEPS_US[] = {250, 125, 64, 32, 16, 8, 4, 2};
  gsl_set_error_handler_off();
  comparison *analytic = reference_of("analytic", ORACLE_ANALYTIC, NULL);
  comparison *switched = reference_of("switched", ORACLE_SWITCHED, NULL);
  comparison *circuit = reference_of("circuit", ORACLE_SNUBBED, NULL);
  comparison *every = reference_of("circuit", ORACLE_SNUBBED, EVERY);
  for (int decade = -2; decade >= -10; decade--) {
    add("analytic", "analytic", analytic, pow(10, decade), 0);
    add("switched", "switched", switched, pow(10, decade), 0);
    if (decade >= -7) add("circuit", "circuit", circuit, pow(10, decade), 0);
  }
  for (size_t k = 0; k < sizeof STEPS_US / sizeof *STEPS_US; k++) {
    double step = 1e-6 * STEPS_US[k];
    add("circuit every cycle", "circuit", every, 1e-5, step);
    add("circuit every cycle even steps", "circuit", every, 1e-5, step);
    laps[n - 1].solver = &EVEN;
  }
  race r = {"b", attempts, n, 7, 3, 2};
  race_run(&r);
  race_print(&r);
  compare_free(analytic);
  compare_free(switched);
  compare_free(circuit);
  compare_free(every);
  return 0;
}
