/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "race.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "engine/budget.h"

enum { MOST_ROUNDS = 100 };

_Noreturn void race_give_up(const char *what) {
  fprintf(stderr, "work_precision: %s\n", what);
  exit(1);
}

typedef struct lane {
  double times[MOST_ROUNDS], spent_s;
  size_t n;
  bool out;
} lane;

static void run_once(race *r, lane *lanes, size_t k) {
  attempt *a = &r->list[k];
  lane *l = &lanes[k];
  double began = vs_budget_clock_s();
  a->run(a);
  double spent = vs_budget_clock_s() - began;
  l->times[l->n++] = spent;
  l->spent_s += spent;
  if (spent <= r->longest_s) return;
  for (size_t j = k + 1; j < r->n; j++)
    if (!strcmp(r->list[j].method, a->method)) lanes[j].out = true;
}

void race_run(race *r) {
  lane *lanes = vs_alloc(r->n, sizeof *lanes);
  for (int round = 0; round < r->rounds && round < MOST_ROUNDS; round++)
    for (size_t k = 0; k < r->n; k++)
      if (!lanes[k].out && (round < 2 || lanes[k].spent_s < r->share_s)) run_once(r, lanes, k);
  for (size_t k = 0; k < r->n; k++) {
    attempt *a = &r->list[k];
    lane *l = &lanes[k];
    a->best_s = a->middle_s = INFINITY;
    if (!l->n) continue;
    gsl_sort(l->times, 1, l->n);
    a->best_s = l->times[0];
    a->middle_s = gsl_stats_median_from_sorted_data(l->times, 1, l->n);
  }
  free(lanes);
}

void race_print(const race *r) {
  for (size_t k = 0; k < r->n; k++) {
    const attempt *a = &r->list[k];
    if (isinf(a->best_s)) continue;
    printf("%s,%s,%s,%g,%.3e,%.6g,%.6g,%ld\n", r->part, a->method, a->varied, a->value, a->error,
           a->best_s, a->middle_s, a->steps);
  }
  fflush(stdout);
}

vs_scene *race_scene(const char *tier, const char *const *sets) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_error err = {0};
  size_t n = 0;
  while (sets[n]) n++;
  if (vs_scene_read("paper", (char *const *)(size_t)sets, n, tier, scene, &err))
    race_give_up(err.text);
  return scene;
}

typedef struct counter {
  comparison *c;
  long steps;
} counter;

static vs_status accept(void *ctx, const vs_step *step, vs_error *err) {
  counter *n = ctx;
  n->steps++;
  return compare_accept(n->c, step, err);
}

double race_compare(const vs_scene *scene, comparison *c, long *steps) {
  vs_error err = {0};
  counter n = {.c = c};
  vs_observer observer = {&n, accept};
  compare_again(c);
  if (vs_sim_run(scene->tier, &scene->setup, &scene->order, &observer, &err)) return INFINITY;
  *steps = n.steps;
  return compare_error(c, NULL);
}
