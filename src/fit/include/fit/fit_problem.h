/* SPDX-License-Identifier: GPL-3.0-or-later
 * A fit file as it was read: which runs of which scenes, what was measured of them, what is to be
 * found.
 *
 *   scene:    NAME or path               the default: paper
 *   set:      {KEY: VALUE, ...}          over what the scene says
 *   measures: {NAME: {value, error}}     fit/targets.h
 *   steady:   true | {period: N}         the measures are those of a period of the orbit, of N
 *                                        firing periods, and not those of the run
 *   impedance, core_loss: {file, ...}    fit/targets.h
 *   data:     {file, columns, ...}       fit/recording.h
 *   runs:     [{scene, set, free, measures, steady, data}, ...]
 *                                        several, in the place of measures, steady and data; scene
 *                                        and set above are the default of each
 *   free:     {KEY: {from, to, start, prior}, ...}
 *                                        fit/unknown.h; under a run: its own
 *   starts:   N                          searches, the first from the scene's values; default 8
 *   seed:     N                          of the other ones' places; default 1
 *   residual: logarithm | difference     of what has an error in per cent
 *   slopes:   auto | exact | differences how slopes are found (vs_jacobian_word)
 *   profile:  all | [KEY, ...]           whose profile likelihood is wanted
 *
 * The residual of a number that was measured, with the standard error sigma, is
 *
 *   ln(computed/measured)/sigma          sigma is a share, residual: logarithm
 *   (computed/measured - 1)/sigma        sigma is a share, residual: difference
 *   (computed - measured)/sigma          sigma is an amount
 */
#pragma once

#include "fit/recording.h"
#include "fit/targets.h"
#include "fit/unknown.h"

enum { VS_INQUIRY_UNKNOWNS = 32, VS_INQUIRY_RUNS = 64 }; /* at most */

/* One run that was measured. */
typedef struct vs_fit_problem_run {
  vs_scene *scene; /* settled with `set` and --set; whoever fits alters its tree */
  int periods;     /* 0: its measures are those of its run; else of a period of its orbit, of so
                      many firing periods */
  vs_targets aims;
  vs_recording recording;
  bool recorded;      /* it has one */
  size_t datum, data; /* the first of its data, and how many they are: aims, then samples */
} vs_fit_problem_run;

/* One number that was measured. */
typedef struct vs_datum {
  int run;
  int aim;             /* of the run's aims; -1: it is a sample */
  size_t sample;       /* of the run's recording */
  double value, error; /* SI, or a share */
  bool relative;       /* the error is a share */
  vs_where where;
} vs_datum;

/* Who finds slopes. */
typedef enum vs_jacobian_word {
  VS_SLOPES_AUTO,  /* differences on the way, exact ones at the minimum where the tier has them */
  VS_SLOPES_EXACT, /* exact ones everywhere, where the tier has them */
  VS_SLOPES_DIFFERENCES /* differences of runs everywhere */
} vs_jacobian_word;

typedef struct vs_fit_problem {
  char path[VS_PATH_SIZE];
  vs_tree tree;
  char *const *sets; /* --set; borrowed */
  size_t n_sets;
  vs_fit_problem_run runs[VS_INQUIRY_RUNS];
  size_t n_runs;
  vs_unknown unknowns[VS_INQUIRY_UNKNOWNS];
  size_t n_unknowns;
  vs_datum *data;
  size_t n_data;
  size_t n_priors; /* unknowns that have one: each counts as a residual, behind the data */
  uint64_t starts, seed;
  vs_jacobian_word slopes;
  bool difference;  /* residual: difference */
  long most_cycles; /* of the mains that its runs may take; 0: what a fit like it wants; for tests,
                       no key sets it */
  bool profiled[VS_INQUIRY_UNKNOWNS]; /* its profile is wanted */
} vs_fit_problem;

/* Reads the fit called name: a path, or the name of one that comes with the program. sets:
 * KEY=VALUE of each --set, of the fit's own keys or of every run's scene. profile: more of
 * `profile`, "all" or keys with commas; NULL: nothing. Errors: everything a fit can be wrong in but
 * for its rank. vs_fit_problem_free even then. */
vs_status vs_fit_problem_read(const char *name, char *const *sets, size_t n_sets,
                              const char *profile, vs_fit_problem *inquiry, vs_error *err);
void vs_fit_problem_free(vs_fit_problem *inquiry);

/* True if a --set, KEY=VALUE, is one of the fit's own keys (starts=1) and none of a scene's. */
bool vs_fit_problem_owns(const char *set);

/* True if the name is that of a fit alone, or of a file that has a key that only fits have. */
bool vs_fit_problem_is(const char *name);

/* How many residuals there are: the data and the priors. */
size_t vs_fit_problem_residuals(const vs_fit_problem *inquiry);

/* The name under which a datum is shown: of its measure or its column. */
const char *vs_fit_problem_name(const vs_fit_problem *inquiry, const vs_datum *datum);
/* The unit of its kind. */
const char *vs_fit_problem_unit(const vs_fit_problem *inquiry, const vs_datum *datum);
