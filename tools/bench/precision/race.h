/* SPDX-License-Identifier: GPL-3.0-or-later
 * For the parts of tools/bench/work_precision: attempts at one problem, timed in turn. */
#pragma once

#include <stddef.h>

#include "compare.h"
#include "run/scene.h"

typedef struct attempt attempt;
struct attempt {
  const char *method;
  double value;               /* of what is varied: a tolerance, or a step in s */
  const char *varied;         /* its name */
  double error;               /* filled by run, in parts of a peak; infinite: it failed */
  long steps;                 /* filled by run; 0: not counted */
  void (*run)(attempt *self); /* the same every time */
  const void *with;           /* the part's own */
  double best_s, middle_s;    /* filled by race: least and median wall time */
};

/* Runs the attempts, all in turn, over and over: at most `rounds` times each, and until each has
 * had its share of the seconds. Of one method, what is listed behind an attempt that took more than
 * longest_s is left out. */
typedef struct race {
  const char *part; /* the CSV's first column */
  attempt *list;
  size_t n;
  int rounds;
  double share_s, longest_s;
} race;
void race_run(race *r);
/* CSV, without a header: part, method, varied, value, error, best_s, middle_s, steps. */
void race_print(const race *r);

/* The scene `paper` with KEY=VALUEs set (a NULL-ended list); ends the program when it is refused.
 * free() it behind vs_scene_free. */
vs_scene *race_scene(const char *tier, const char *const *sets);
/* One run of it into the comparison; gives its error, and the number of steps. */
double race_compare(const vs_scene *scene, comparison *c, long *steps);

_Noreturn void race_give_up(const char *what);
