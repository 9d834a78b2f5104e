/* SPDX-License-Identifier: GPL-3.0-or-later
 * The parts of tools/bench/speed that need the library or a child's resource usage; it says what
 * for.
 *
 * The paper's scene on the switched tier, EVERY: once, or 1 for a firing in every cycle:
 *   bench_runs error EVERY TOL REF       its errors against the reference
 *   bench_runs switched EVERY TOL REPEAT best and median wall time
 *   bench_runs measures TOL REPEAT       the same of a run for its measures alone
 * Others:
 *   bench_runs child PROGRAM ARG...  wall time and peak memory of a program
 *   bench_runs seconds N PROGRAM ARG...  least wall time of N runs of a program, its output dropped
 *
 * Each prints CSV without a header; the columns are said at each function. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "conveyor.h"
#include "engine/budget.h"
#include "measure/energy.h"
#include "run/scene.h"

/* The peers' record: p, u, w, phi, i every 0.1 ms of 2 s. */
enum { COLUMNS = 5, ROWS = 20001, ROWS_PER_SECOND = 10000 };
static const int RECORDED[COLUMNS] = {VS_CH_P, VS_CH_U, VS_CH_W, VS_CH_PHI, VS_CH_I};

typedef struct record {
  double y[ROWS][COLUMNS];
  int rows;
  long steps;
  unsigned parts; /* of a step that the columns need */
} record;

static _Noreturn void give_up(const char *what) {
  fprintf(stderr, "bench_runs: %s\n", what);
  exit(1);
}

static void must(vs_status status, const vs_error *err) {
  if (status) give_up(err->text);
}

static void *allocated(size_t size) {
  void *p = calloc(1, size);
  if (!p) give_up("out of memory");
  return p;
}

/* The paper's scene with some KEY=VALUE set. */
static vs_scene *read_scene(const char *tier, char *const *sets, size_t n_sets) {
  vs_scene *scene = allocated(sizeof *scene);
  vs_error err = {0};
  must(vs_scene_read("paper", sets, n_sets, tier, scene, &err), &err);
  return scene;
}

static vs_scene *read_switched(const char *every, const char *tolerance) {
  char words[2][64], *sets[] = {words[0], words[1]};
  snprintf(words[0], sizeof words[0], "firing.every=%s", every);
  snprintf(words[1], sizeof words[1], "run.tolerance=%s", tolerance);
  return read_scene("switched", sets, 2);
}

static void free_scene(vs_scene *scene) {
  vs_scene_free(scene);
  free(scene);
}

static double run_timed(const vs_scene *scene, const vs_observer *observer) {
  vs_error err = {0};
  double began = vs_budget_clock_s();
  must(vs_sim_run(scene->tier, &scene->setup, &scene->order, observer, &err), &err);
  return vs_budget_clock_s() - began;
}

/* ---- observers ---- */

static vs_status nothing(void *ctx, const vs_step *step, vs_error *err) {
  (void)ctx, (void)step, (void)err;
  return VS_OK;
}

static vs_status store(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  record *r = ctx;
  double y[VS_CH_MOST];
  r->steps++;
  for (; r->rows < ROWS && (double)r->rows / ROWS_PER_SECOND <= step->to->t_s; r->rows++) {
    vs_step_groups_at(step, (double)r->rows / ROWS_PER_SECOND, r->parts, y);
    for (int k = 0; k < COLUMNS; k++) r->y[r->rows][k] = y[RECORDED[k]];
  }
  return VS_OK;
}

typedef struct watchers {
  vs_measures *measures;
  vs_energy energy;
} watchers;

static vs_status watch(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  watchers *w = ctx;
  vs_measures_accept(w->measures, step);
  vs_energy_accept(&w->energy, step);
  return VS_OK;
}

/* ---- switched tier ---- */

static double run_stored(const vs_scene *scene, record *r) {
  vs_observer observer = {r, store};
  r->rows = 0;
  r->steps = 0;
  r->parts = vs_channel_groups(&scene->setup.model, RECORDED, COLUMNS);
  double spent = run_timed(scene, &observer);
  if (r->rows != ROWS) give_up("the run did not reach its end");
  return spent;
}

/* Largest error of a column, relative to the reference's peak. */
static double error_of(const record *r, const record *reference, int column) {
  double error = 0, peak = 0;
  for (int k = 0; k < ROWS; k++) {
    error = fmax(error, fabs(r->y[k][column] - reference->y[k][column]));
    peak = fmax(peak, fabs(reference->y[k][column]));
  }
  return error / peak;
}

/* error of p, largest error of p, u, w, phi, i, steps */
static void find_error(const char *every, const char *tolerance, const char *path) {
  record *reference = allocated(sizeof *reference), *r = allocated(sizeof *r);
  FILE *f = fopen(path, "rb");
  if (!f || fread(reference->y, sizeof reference->y, 1, f) != 1)
    give_up("the reference cannot be read");
  fclose(f);
  vs_scene *scene = read_switched(every, tolerance);
  run_stored(scene, r);
  free_scene(scene);
  double worst = 0;
  for (int k = 0; k < COLUMNS; k++) worst = fmax(worst, error_of(r, reference, k));
  printf("%.2e,%.2e,%ld\n", error_of(r, reference, 0), worst, r->steps);
  free(r);
  free(reference);
}

static double median(double *values, size_t n) {
  gsl_sort(values, 1, n);
  return gsl_stats_median_from_sorted_data(values, 1, n);
}

/* seconds: best and median with 20,001 samples stored, best and median without an observer's work
 */
static void time_switched(const char *every, const char *tolerance, size_t repeat) {
  vs_scene *scene = read_switched(every, tolerance);
  record *r = allocated(sizeof *r);
  double *stored = allocated(repeat * sizeof *stored), *alone = allocated(repeat * sizeof *alone);
  const vs_observer idle = {NULL, nothing};
  for (size_t k = 0; k < repeat; k++) {
    stored[k] = run_stored(scene, r);
    alone[k] = run_timed(scene, &idle);
  }
  double middle[2] = {median(stored, repeat), median(alone, repeat)};
  printf("%.9f,%.9f,%.9f,%.9f\n", stored[0], middle[0], alone[0], middle[1]);
  free(stored);
  free(alone);
  free(r);
  free_scene(scene);
}

/* seconds: best and median of one pulse from the scene's tree to measures and energies, best and
 * median without the setup */
static void time_measures(const char *tolerance, size_t repeat) {
  vs_scene *scene = read_switched("once", tolerance);
  double *all = allocated(repeat * sizeof *all), *alone = allocated(repeat * sizeof *alone);
  for (size_t k = 0; k < repeat; k++) {
    vs_error err = {0};
    vs_value values[VS_MEASURES];
    double began = vs_budget_clock_s();
    vs_setup_free(&scene->setup);
    must(vs_setup_build(scene->tree.root, &scene->setup, &err), &err);
    double built = vs_budget_clock_s();
    watchers w = {.measures = vs_measures_new(&scene->frame, NULL),
                  .energy = {.frame = &scene->frame}};
    const vs_observer watching = {&w, watch};
    must(vs_sim_run(scene->tier, &scene->setup, &scene->order, &watching, &err), &err);
    vs_measures_finish(w.measures, values);
    vs_energy_finish(&w.energy);
    vs_measures_free(w.measures);
    double ended = vs_budget_clock_s();
    all[k] = ended - began;
    alone[k] = ended - built;
  }
  double middle[2] = {median(all, repeat), median(alone, repeat)};
  printf("%.9f,%.9f,%.9f,%.9f\n", all[0], middle[0], alone[0], middle[1]);
  free(all);
  free(alone);
  free_scene(scene);
}

/* ---- a child's peak memory ---- */

/* Runs the program to its end; gives its wall time, s. */
static double run_child(char *const *arguments, bool quiet, struct rusage *usage) {
  double began = vs_budget_clock_s();
  pid_t pid = fork();
  if (pid < 0) give_up("no process for the child");
  if (pid == 0) {
    if (quiet && (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)))
      _exit(127);
    execv(arguments[0], arguments);
    _exit(127);
  }
  int status;
  if (wait4(pid, &status, 0, usage) != pid || status) give_up("the child failed");
  return vs_budget_clock_s() - began;
}

/* seconds, MB; the memory is at least this program's own, which execv's child had before */
static void time_child(char *const *arguments) {
  struct rusage usage;
  double spent = run_child(arguments, false, &usage);
  printf("%.3f,%.1f\n", spent, (double)usage.ru_maxrss / 1024);
}

static void time_quiet(int times, char *const *arguments) {
  struct rusage usage;
  double best = INFINITY;
  for (int k = 0; k < times; k++) best = fmin(best, run_child(arguments, true, &usage));
  printf("%.9f\n", best);
}

int main(int argc, char **argv) {
  gsl_set_error_handler_off();
  if (argc == 5 && !strcmp(argv[1], "error"))
    find_error(argv[2], argv[3], argv[4]);
  else if (argc == 5 && !strcmp(argv[1], "switched") && atoi(argv[4]) > 0)
    time_switched(argv[2], argv[3], (size_t)atoi(argv[4]));
  else if (argc == 4 && !strcmp(argv[1], "measures") && atoi(argv[3]) > 0)
    time_measures(argv[2], (size_t)atoi(argv[3]));
  else if (argc > 2 && !strcmp(argv[1], "child"))
    time_child(argv + 2);
  else if (argc > 3 && !strcmp(argv[1], "seconds") && atoi(argv[2]) > 0)
    time_quiet(atoi(argv[2]), argv + 3);
  else {
    fputs(
        "usage: bench_runs error EVERY TOL REF | switched EVERY TOL REPEAT | measures TOL REPEAT | "
        "child PROGRAM [ARG...] | seconds N PROGRAM [ARG...]\n",
        stderr);
    return 2;
  }
  return 0;
}
