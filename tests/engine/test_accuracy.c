/* SPDX-License-Identifier: GPL-3.0-or-later
 * The error that is asked for is the error that is got: every tier over a matrix of scenes and
 * tolerances against the tests' own solver of the same equations. The norm is run.tolerance's: the
 * largest error over the samples of p, u, w, phi, force and i, each in parts of its own peak in the
 * run. Decks with the two-transistor thyristor, of which the oracle knows nothing, are held against
 * themselves at 1e-6. A part of the matrix here; all of it with tools/test --long, which writes
 * accuracy.csv and accuracy_decks.csv (committed in tests/long). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "compare.h"
#include "suite.h"

enum { MOST_SETS = 8 };

/* What is promised: run.tolerance; what is held here: three times that. */
static const double ALLOWED = 3;

typedef struct scene {
  const char *name;
  const char *sets[MOST_SETS];
} scene;
static const scene SCENES[] = {
    {"single shot", {"run.until=1s"}},
    {"every cycle 95 deg", {"run.until=0.3s", "firing.every=1", "firing.angle=95deg"}},
    {"every cycle 100 deg", {"run.until=0.3s", "firing.every=1", "firing.angle=100deg"}},
    {"every cycle 120 deg", {"run.until=0.3s", "firing.every=1", "firing.angle=120deg"}},
    {"every cycle 150 deg", {"run.until=0.3s", "firing.every=1", "firing.angle=150deg"}},
    {"loaded",
     {"run.until=0.3s", "firing.every=2", "firing.angle=95deg", "load.density=1.6 g/cm3",
      "load.fraction=0.3"}},
    {"near resonance",
     {"run.until=0.5s", "firing.every=1", "firing.angle=135deg", "supply.frequency=56.5Hz"}},
    {"stop",
     {"run.until=0.3s", "firing.every=1", "firing.angle=90deg", "supply.frequency=60Hz",
      "start.vp=-1 m/s", "actuator.stop={stiffness: 1e7 N/m, damping: 300 N.s/m}"}},
};
enum { N_SCENES = COUNT(SCENES) };

/* A tier, and the circuit where it has one. */
typedef struct way {
  const char *name, *tier, *set; /* set: NULL, none */
  oracle_kind kind;
  int finest; /* decade */
} way;
static const way WAYS[] = {
    {"analytic", "analytic", NULL, ORACLE_ANALYTIC, -8},
    {"switched", "switched", NULL, ORACLE_SWITCHED, -8},
    {"circuit, bare", "circuit", "circuit.deck=halfwave_bare", ORACLE_BARE, -6},
    {"circuit, snubbed", "circuit", "circuit.deck=halfwave_snubbed", ORACLE_SNUBBED, -6},
    {"circuit, 2 kohm 22 nF", "circuit", "circuit={r1: 2 kohm, c1: 22 nF, r2: 1 kohm}",
     ORACLE_SNUBBED, -6},
};
enum { N_WAYS = COUNT(WAYS) };

/* When such a thyristor lets go of its current decides over the ring behind it, and where cycles
 * follow on each other over the next one too. */
static const scene DECKS[] = {
    {"snubbed, every 4th", {"run.until=0.1s", "firing.every=4", "circuit.thyristor=thyristor_2t"}},
    {"snubbed, every cycle",
     {"run.until=0.2s", "firing.every=1", "circuit.thyristor=thyristor_2t"}},
    {"full wave, every cycle",
     {"run.until=0.2s", "firing.every=1", "circuit.deck=fullwave_antiparallel"}},
    {"paper's, every cycle", {"run.until=0.2s", "firing.every=1", "circuit.deck=halfwave_paper"}},
};
enum { N_DECKS = COUNT(DECKS) };
/* Its reference is a run a decade finer than the finest. */
static const way ITSELF = {"circuit, two transistors", "circuit", "run.leave_circuit=never",
                           ORACLE_SWITCHED, -5};

/* ---- one run beside its reference ---- */

typedef struct cell {
  double error;      /* the worst, in parts of the tolerance */
  const char *probe; /* which has it */
  long steps;
  double wall_s;
} cell;

static void all_sets(const scene *s, const way *w, const char *more, const char **sets) {
  size_t n = 0;
  for (; n < MOST_SETS && s->sets[n]; n++) sets[n] = s->sets[n];
  if (w->set) sets[n++] = w->set;
  if (more) sets[n++] = more;
  sets[n] = NULL;
}

static comparison *reference(const scene *s, const way *w) {
  char tolerance[64];
  const char *sets[MOST_SETS + 3];
  snprintf(tolerance, sizeof tolerance, "run.tolerance=1e%d", w->finest - 1);
  all_sets(s, w, w == &ITSELF ? tolerance : NULL, sets);
  vs_trial *t = vs_trial_read("paper", w->tier, sets);
  EXPECT(t->status == VS_OK, "%s, %s: %s", s->name, w->name, t->err.text);
  oracle_scene o = oracle_of(&t->scene.setup, w->kind);
  comparison *c = w == &ITSELF ? compare_with_run(&o) : compare_with(&o);
  EXPECT(c != NULL, "%s, %s: the oracle has no solution", s->name, w->name);
  CU_ASSERT_PTR_NOT_NULL_FATAL(c);
  if (w == &ITSELF) {
    vs_observer observer = {c, compare_accept};
    vs_trial_go(t, &observer);
    EXPECT(t->status == VS_OK && c->next == c->rows, "%s, %s: %s", s->name, w->name, t->err.text);
  }
  vs_trial_free(t);
  return c;
}

static cell run_cell(const scene *s, const way *w, int decade, comparison *c) {
  char tolerance[64];
  const char *sets[MOST_SETS + 3];
  snprintf(tolerance, sizeof tolerance, "run.tolerance=1e%d", decade);
  all_sets(s, w, tolerance, sets);
  compare_again(c);
  vs_observer observer = {c, compare_accept};
  vs_trial *t = vs_trial_read("paper", w->tier, sets);
  struct timespec began, ended;
  clock_gettime(CLOCK_MONOTONIC, &began);
  vs_trial_go(t, &observer);
  clock_gettime(CLOCK_MONOTONIC, &ended);
  EXPECT(t->status == VS_OK, "%s, %s, %s: %s", s->name, w->name, tolerance, t->err.text);
  cell out = {.steps = t->result.steps, .probe = "none"};
  out.wall_s =
      (double)(ended.tv_sec - began.tv_sec) + 1e-9 * (double)(ended.tv_nsec - began.tv_nsec);
  out.error = compare_error(c, &out.probe) / pow(10, decade);
  vs_trial_free(t);
  return out;
}

/* The cells of one scene and way, from coarse to fine. A finer tolerance may cost little more, but
 * never less (2 % are left for where events cut the steps). */
static void run_row(const scene *s, const way *w, int coarsest, int finest, FILE *csv) {
  comparison *reference_run = reference(s, w);
  long before = 0;
  for (int decade = coarsest; decade >= finest; decade--) {
    cell c = run_cell(s, w, decade, reference_run);
    EXPECT(c.error <= ALLOWED, "%s, %s, tolerance 1e%d: %s is off by %.3g times that", s->name,
           w->name, decade, c.probe, c.error);
    EXPECT((double)c.steps >= 0.98 * (double)before,
           "%s, %s, tolerance 1e%d: %ld steps, and %ld for the coarser", s->name, w->name, decade,
           c.steps, before);
    before = c.steps;
    if (!csv) continue;
    fprintf(csv, "%s,\"%s\",1e%d,%.3g,%s,%ld,%.3g\n", s->name, w->name, decade, c.error, c.probe,
            c.steps, c.wall_s);
    fflush(csv);
  }
  compare_free(reference_run);
}

/* Half of the ideal tiers' matrix, and the circuit where it is cheap. */
static void a_part(void) {
  if (getenv("VS_LONG")) return;
  for (size_t n = 0; n < N_SCENES; n += 2)
    for (size_t k = 0; k < 2; k++) run_row(&SCENES[n], &WAYS[k], -2, WAYS[k].finest, NULL);
  for (size_t k = 2; k < 4; k++) run_row(&SCENES[0], &WAYS[k], -2, -4, NULL);
  run_row(&SCENES[N_SCENES - 1], &WAYS[3], -3, -3, NULL);
  run_row(&DECKS[0], &ITSELF, -4, -4, NULL);
}

static FILE *begin_table(const char *path) {
  FILE *csv = fopen(path, "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(csv);
  fputs("scene,tier,tolerance,worst_error_per_tolerance,probe,steps,wall_s\n", csv);
  return csv;
}

static void all_of_it(void) {
  if (!getenv("VS_LONG")) return;
  FILE *csv = begin_table("accuracy.csv");
  for (size_t k = 0; k < N_WAYS; k++)
    for (size_t n = 0; n < N_SCENES; n++) run_row(&SCENES[n], &WAYS[k], -2, WAYS[k].finest, csv);
  fclose(csv);
}

static void all_decks(void) {
  if (!getenv("VS_LONG")) return;
  FILE *csv = begin_table("accuracy_decks.csv");
  for (size_t n = 0; n < N_DECKS; n++) run_row(&DECKS[n], &ITSELF, -2, ITSELF.finest, csv);
  fclose(csv);
}

static const vs_test TESTS[] = {
    {"a part of the matrix", a_part},
    {"all of the matrix (long)", all_of_it},
    {"decks with two transistors (long)", all_decks},
};
VS_SUITE_MAIN("accuracy", TESTS)
