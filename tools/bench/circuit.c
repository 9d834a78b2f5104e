/* SPDX-License-Identifier: GPL-3.0-or-later
 * The part of tools/bench/speed that tells what a run on the circuit tier costs beside its circuit
 * alone.
 *
 *   bench_circuit ROUNDS [KEY=VALUE...]       the paper's scene with these keys, three ways in turn
 *   bench_circuit WAY ROUNDS [KEY=VALUE...]   one of the ways alone, for a profiler; prints nothing
 *
 * The ways are
 *   all     the tier with every watcher of the program
 *   idle    the tier with an observer that does nothing
 *   alone   the same netlist in the same solver, without machine and observer
 *
 * A first run, which is not counted, is taken down: each question that the solver asked its host,
 * with its instant, and the answer. The circuit alone is given these answers, in the same order. So
 * its sources have the gap z(t), the mains, the gates and what engine/coupled/truncation.h gave
 * back at every Newton iteration as they were, its steps end at the same edges, and are as long. It
 * takes the same steps to the bit, which is checked; an answer costs it no more than a look at the
 * next entry. ngspice's clocks stand still in all three (src/clocks.c).
 *
 * Each round is a line of CSV without a header. Of the three ways in the order above: seconds, and
 * seconds without loading; then the steps and the source calls, which are the same in all of them.
 */
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "measure/watchers.h"
#include "ngspice/ngspice.h"
#include "run/scene.h"

static _Noreturn void give_up(const char *what) {
  fprintf(stderr, "bench_circuit: %s\n", what);
  exit(1);
}

static void must(vs_status status, const vs_error *err) {
  if (status) give_up(err->text);
}

static double processor_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- questions and answers ---- */

/* The answers to one kind of question, in the order in which they were given. */
typedef struct tape {
  struct {
    double at_s, answer;
  } * item;
  size_t count, room, now;
} tape;

static double note(tape *t, double at_s, double answer) {
  if (t->count == t->room) {
    t->room = t->room ? 2 * t->room : 1024;
    t->item = realloc(t->item, t->room * sizeof *t->item);
    if (!t->item) give_up("out of memory");
  }
  t->item[t->count].at_s = at_s;
  t->item[t->count++].answer = answer;
  return answer;
}

static double next(tape *t, double at_s) {
  size_t k = t->now++;
  if (k >= t->count || t->item[k].at_s != at_s) give_up("the circuit alone takes other steps");
  return t->item[k].answer;
}

/* ---- the solver: ngspice, with a clock, or with a host of its own ---- */

enum { ALL, IDLE, ALONE, WAYS };

static struct {
  bool noting, alone;
  tape sources, edges, limits;
  size_t steps, now;    /* accepted steps; those of the present run of the circuit alone */
  double solving_s;     /* of the last run, without loading */
  vs_circuit_host host; /* the tier's */
} run_of;

static double noted_source(void *ctx, size_t port, double t_s) {
  return note(&run_of.sources, t_s, run_of.host.source(ctx, port, t_s));
}

static double noted_edge(void *ctx, double t_s) {
  return note(&run_of.edges, t_s, run_of.host.edge(ctx, t_s));
}

static double noted_longest(void *ctx, double t_s) {
  return note(&run_of.limits, t_s, run_of.host.longest(ctx, t_s));
}

static vs_status noted_accept(void *ctx, double t_s, const double *signals, vs_error *err) {
  run_of.steps++;
  return run_of.host.accept(ctx, t_s, signals, err);
}

static double same_source(void *ctx, size_t port, double t_s) {
  (void)ctx, (void)port;
  return next(&run_of.sources, t_s);
}

static double same_edge(void *ctx, double t_s) {
  (void)ctx;
  return next(&run_of.edges, t_s);
}

static double same_longest(void *ctx, double t_s) {
  (void)ctx;
  return next(&run_of.limits, t_s);
}

static vs_status same_accept(void *ctx, double t_s, const double *signals, vs_error *err) {
  (void)ctx, (void)t_s, (void)signals, (void)err;
  run_of.now++;
  return VS_OK;
}

/* The tier may have left the solver before the end. */
static bool same_enough(void *ctx) {
  (void)ctx;
  return run_of.now == run_of.steps;
}

static vs_status load(const vs_circuit_job *job, const vs_circuit_host *host, void **circuit,
                      vs_error *err) {
  static const vs_circuit_host alone = {.source = same_source,
                                        .edge = same_edge,
                                        .longest = same_longest,
                                        .accept = same_accept,
                                        .enough = same_enough};
  static vs_circuit_host noted;
  noted = *host;
  noted.source = noted_source;
  noted.edge = noted_edge;
  noted.longest = noted_longest;
  noted.accept = noted_accept;
  run_of.host = *host;
  run_of.sources.now = run_of.edges.now = run_of.limits.now = run_of.now = 0;
  return vs_ngspice_kind.load(job,
                              run_of.alone    ? &alone
                              : run_of.noting ? &noted
                                              : host,
                              circuit, err);
}

static vs_status solve(void *circuit, vs_error *err) {
  double began_s = processor_s();
  vs_status status = vs_ngspice_kind.run(circuit, err);
  run_of.solving_s = processor_s() - began_s;
  if (run_of.alone && run_of.now != run_of.steps) give_up("the circuit alone takes other steps");
  return status;
}

static void release(void *circuit) {
  vs_ngspice_kind.free(circuit);
}

/* ---- the runs ---- */

static vs_status nothing(void *ctx, const vs_step *step, vs_error *err) {
  (void)ctx, (void)step, (void)err;
  return VS_OK;
}

static vs_status watch(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  vs_watchers_accept(ctx, step);
  return VS_OK;
}

static double run_timed(vs_scene *scene, int way) {
  static vs_watchers watchers;
  vs_error err = {0};
  vs_value values[VS_MEASURES];
  const vs_observer observer = {&watchers, way == ALL ? watch : nothing};
  run_of.alone = way == ALONE;
  double began_s = processor_s();
  if (way == ALL) vs_watchers_begin(&watchers, &scene->frame, NULL);
  must(vs_sim_run(scene->tier, &scene->setup, &scene->order, &observer, &err), &err);
  if (way == ALL) vs_watchers_finish(&watchers, scene->setup.run.until_s, values);
  if (way == ALL) vs_watchers_free(&watchers);
  return processor_s() - began_s;
}

static void time_rounds(vs_scene *scene, int rounds) {
  for (int round = 0; round < rounds; round++) {
    for (int way = 0; way < WAYS; way++) {
      double spent_s = run_timed(scene, way);
      printf("%.9f,%.9f,", spent_s, run_of.solving_s);
    }
    printf("%zu,%zu\n", run_of.steps, run_of.sources.count);
  }
}

int main(int argc, char **argv) {
  static const char *const NAMES[WAYS] = {"all", "idle", "alone"};
  const vs_circuit_kind solver = {
      .name = "ngspice, timed", .load = load, .run = solve, .free = release};
  static vs_scene scene;
  vs_error err = {0};
  int way = 0, at = 1;
  gsl_set_error_handler_off();
  while (way < WAYS && argc > 1 && strcmp(argv[1], NAMES[way]) != 0) way++;
  if (way < WAYS) at = 2;
  int rounds = argc > at ? atoi(argv[at]) : 0;
  if (rounds <= 0) {
    fputs("usage: bench_circuit [all|idle|alone] ROUNDS [KEY=VALUE...]\n", stderr);
    return 2;
  }
  must(vs_scene_read("paper", argv + at + 1, (size_t)(argc - at - 1), "circuit", &scene, &err),
       &err);
  scene.order.solver = &solver;
  run_of.noting = true;
  run_timed(&scene, IDLE); /* ngspice begins in it, too */
  run_of.noting = false;
  if (way == WAYS)
    time_rounds(&scene, rounds);
  else
    for (int round = 0; round < rounds; round++) run_timed(&scene, way);
  vs_scene_free(&scene);
  return 0;
}
