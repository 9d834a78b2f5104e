/* SPDX-License-Identifier: GPL-3.0-or-later
 * A method chooses the cases of a study. Each is one const struct; the table of them, which NULL
 * ends, comes from main. What a report needs to know of the method stands in the struct, too. */
#pragma once

#include "base/json.h"
#include "run/axis.h"

struct vs_plan;
struct vs_plan_stage;
struct vs_results;
struct vs_generation;

/* What a report makes of the method's cases. */
typedef struct vs_method_report {
  /* Names of kinds of picture (the table in report/plot/study_pictures.c). NULL ends a list, or is
   * an empty one. lead and last are for the column by which cases are judged: all that fit are
   * drawn, those of lead before all other pictures, those of last behind them. */
  const char *const *lead, *const *last;
  const char *const *each; /* for every column: the first that fits is drawn */
  bool sampled;     /* the cases are random samples: the share of those that hold is a yield */
  bool independent; /* and each is drawn by itself: the yield has a confidence interval */
  /* Of a search. aim: which key of its member in the manifest says "max MEASURE" or "min MEASURE";
   * NULL: it aims at no single measure, and cases are judged by their least margin. */
  const char *aim;
  const char *best; /* how its answer is announced: "Worst found" */
  const char *none; /* what is said when it has none; NULL: it always has one */
} vs_method_report;

typedef struct vs_method {
  const char *name;        /* "grid" */
  const char *key;         /* the study's key it stands under, and its member's in the manifest */
  const char *text;        /* what it does, one line */
  const vs_field *keys;    /* what may stand under `key`, one row, the same for all methods of it */
  const vs_field *besides; /* further keys of the study, which stand beside `key` alone; an empty
                              row ends them; NULL: there are none */
  bool uncertain;          /* its axes are what is not known exactly; false: what may be chosen */
  bool tolerates; /* what it chooses may also stand under `sample`, with a tolerance: it gives each
                     such axis (vs_axis.about) its number */
  bool takes_cases; /* a search whose cases may be those of the study's threats */

  /* Says whether the section under `key` asks for this method. Of several the first in the table is
   * taken. NULL: it always does. */
  bool (*claims)(const vs_node *section);

  /* Reads the section: adds axes (vs_plan_axis, vs_axis_values), registers the columns it needs
   * (vs_report_columns_add), keeps what else it wants in *state, which may stay NULL. Errors carry
   * their place (vs_fail_at); a check carries on from each (vs_error_keep). */
  vs_status (*read)(struct vs_plan *plan, const vs_node *section, void **state, vs_error *err);

  /* Checks the section once the plan has the columns of all cases' lines, with units and ratings.
   * NULL: there is nothing to check. */
  vs_status (*ready)(const struct vs_plan *plan, const struct vs_plan_stage *stage, vs_error *err);

  /* Frees the state. NULL: there is nothing to free. */
  void (*free)(void *state);

  /* Returns how many points the method has; 0: an axis of its own has no values. Of one that
   * searches it is the most it may run. */
  uint64_t (*count)(const struct vs_plan *plan, const struct vs_plan_stage *stage);

  /* Writes point `index` of the method's own axes, value[stage->n]. It is a pure function of index
   * and seed, so that any shard, worker and order gives the same. NULL: the method searches. */
  void (*point)(const struct vs_plan *plan, const struct vs_plan_stage *stage, uint64_t index,
                double *value);

  /* Writes a random and independent point: it is a pure function of index and seed. False: nothing
   * is left to chance. NULL: there are no such points. */
  bool (*draw)(const struct vs_plan *plan, const struct vs_plan_stage *stage, uint64_t index,
               double *value);

  /* Of a method that draws: the ranges within which the which-th kind of its cases, from 0, can be
   * searched. Fills axis[VS_PLAN_AXES] and returns how many these are. 0: the method's points are
   * all there is of that kind. SIZE_MAX: there is no such kind. */
  size_t (*ranges)(const struct vs_plan *plan, const struct vs_plan_stage *stage, size_t which,
                   const vs_axis **axis);
  /* Writes the point of that kind that lies at share[k], 0 to 1, of range k. */
  void (*place)(const struct vs_plan *plan, const struct vs_plan_stage *stage, size_t which,
                const double *share, double *value);

  /* Puts such numbers into a scene's tree, which may have those of another case. NULL: each is its
   * axis' key (vs_axis_put). */
  void (*put)(const struct vs_plan *plan, const struct vs_plan_stage *stage, const double *value,
              vs_tree *tree);

  /* Error: the scene, which is settled with such numbers, is not the case that was meant. NULL: it
   * always is. */
  vs_status (*check)(const struct vs_plan_stage *stage, const double *value, const vs_scene *scene,
                     vs_error *err);

  /* Of a method that searches: asks for the next generation by the results of all earlier ones,
   * which are none at first. All axes are its own. It has ended when it adds nothing. It is a pure
   * function of results and seed; it is called once a generation and, after --resume, again from
   * the first. NULL: the method does not search. */
  vs_status (*next)(const struct vs_plan *plan, const struct vs_plan_stage *stage,
                    const struct vs_results *results, struct vs_generation *generation,
                    vs_error *err);

  /* Adds to an axis of its own, in the manifest, what it knows of it. NULL: nothing. */
  void (*axis_json)(const vs_axis *axis, vs_json *json);

  /* Adds to the manifest one member, called `key`: what the method was asked and, once there are
   * results (else NULL), what it found. NULL: nothing. */
  void (*json)(const struct vs_plan *plan, const struct vs_plan_stage *stage,
               const struct vs_results *results, vs_json *json);

  /* Says in a sentence what was found and how sure that is. The method's member of the manifest has
   * the same as `says`. NULL: nothing. */
  void (*say)(const struct vs_plan *plan, const struct vs_plan_stage *stage,
              const struct vs_results *results, vs_text *text);

  /* Writes files of its own into the study's folder (NULL: there is none) once the others are
   * there, says on standard output what it found unless quiet, and returns how the study ended.
   * NULL: there are none, and its rows tell how. */
  vs_status (*publish)(const struct vs_plan *plan, const struct vs_plan_stage *stage,
                       const struct vs_results *results, const char *folder, bool quiet,
                       vs_error *err);
  const char *const
      *files; /* their names, which go when such a study begins there; NULL ends them */

  vs_method_report report;
} vs_method;

size_t vs_method_count(const vs_method *const *methods);

/* The method of that name, of which `length` bytes are given; NULL: there is none. */
const vs_method *vs_method_named(const vs_method *const *methods, const char *name, size_t length);

/* The method that the section asks for. NULL is an error; its message names those there are. */
const vs_method *vs_method_claiming(const vs_method *const *methods, const vs_node *section,
                                    vs_error *err);

/* The keys that methods stand under, each once, in the table's order: fills keys[], which has room
 * for vs_method_count of them, and returns how many they are. */
size_t vs_method_keys(const vs_method *const *methods, const char **keys);
