/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study file as it was read: which scene, what is varied and by which methods, what is reported.
 * study/study_file.h reads it. A plan knows its cases by number: case k is a point, which has one
 * number for each axis.
 *
 *   scene:   NAME or path                 the default: paper
 *   set:     {KEY: VALUE, ...}            over what the scene says
 *   threats: {NAME: {kind: KIND, ...}, ...}   study/method/threat_cases.c; spread: {KEY: SPREAD,
 * ...} vary:    {KEY: VALUES, ...}           study/method/grid.c: grid; or the name of a CSV file:
 * list sample:  {method: NAME, ...}          study/method/sample.c find:    {worst: max MEASURE,
 * ...}    study/method/worst.c snubber: {...}                        study/method/snubber.c steady:
 * {period: N}                  study/orbit_columns.h: each case is a period of its orbit report:
 * [MEASURE, ...]               the default: the measures of every run, or of every orbit
 *
 * A study that has vary and sample runs all pairs of their points, the last one's index running
 * fastest. A method that chooses its cases by earlier ones' results (find, snubber) uses all axes
 * itself, by their ranges, lists and spreads; the points of vary and sample are then not run. */
#pragma once

#include <stdint.h>

#include "measure/verdict.h"
#include "orbit/sensitivity.h"
#include "study/method.h"
#include "study/orbit_columns.h"

/* At most: axes; columns that the study asks for; and with the numbers of the verdict's lines. */
enum { VS_PLAN_AXES = 32, VS_PLAN_REPORT = 96, VS_PLAN_COLUMNS = VS_PLAN_REPORT + 3 * 128 };
#define VS_PLAN_CASES 100000000ull /* at most */

/* A column of study.csv behind the axes: a measure, or a number of a line of the verdict. */
typedef struct vs_report_column {
  char name[VS_JUDGED_NAME];        /* "thyristor.v_reverse" */
  char column[VS_JUDGED_NAME + 24]; /* "thyristor.v_reverse_v" */
  char of[VS_DECK_NAME];            /* see vs_column */
  char unit[16], text[2 * VS_DECK_TEXT];
  char limit_unit[16]; /* of a margin: of its limit; empty: it is none, or the limit has no unit */
  double rating;   /* the limit it is held against, in unit; of a margin: its limit, in limit_unit.
                      NaN: it has none, or not in every case the same one */
  bool at_least;   /* the limit is the least allowed; false: it is the most */
  bool own;        /* of a margin, see vs_listed_measure */
  unsigned unsure; /* the same, in any case */
  int left_out_by; /* the same */
  int sense;       /* of a margin, see vs_listed_measure; 0, too, where cases differ */
  vs_where where;
  int derivative; /* 1 + the number of the entry of plan->derivatives whose value this is, or, with
                     a minus, whose error; 0: it is a measure */
  bool line;      /* it is a number of a line of the verdict (vs_listed_line_at) */
} vs_report_column;
enum { VS_COLUMN_MARGIN = -1 }; /* margin_least, which every study has without asking for it */

/* A method at work in a plan. */
typedef struct vs_plan_stage {
  const vs_method *method;
  void *state;    /* the method's own */
  size_t axis, n; /* its axes: plan->axes[axis .. axis + n) */
  uint64_t count; /* its points; for a method that searches: the largest number of cases */
} vs_plan_stage;

/* A file the cases are made of, with the SHA-256 of its contents. */
typedef struct vs_input {
  char path[VS_PATH_SIZE], sha256[65];
} vs_input;

typedef struct vs_plan {
  char path[VS_PATH_SIZE]; /* of the study */
  vs_tree tree;
  char scene_name[VS_PATH_SIZE];
  vs_where scene_where; /* of that name */
  vs_scene *base;       /* the scene with `set` and --set; its sections have the axes' fields */
  vs_scene *first;      /* the same with the first case's point; columns are resolved by it */
  const vs_method *const *methods; /* all there are; NULL ends them; borrowed */
  char *const *sets;               /* --set; borrowed */
  size_t n_sets;
  bool allow_code; /* the cases may run code of their scene's own; set it once the plan is read */
  int periods;     /* firing periods of the orbits that the cases are; 0: the cases are runs */
  uint64_t seed;   /* what methods key their random numbers on; 0 unless one reads another */
  vs_axis axes[VS_PLAN_AXES];
  size_t n_axes;
  vs_report_column columns[VS_PLAN_COLUMNS];
  size_t n_columns;
  const vs_sensitivity_order *derivatives; /* that each case has as columns; a method's own; NULL:
                                              there are none */
  vs_plan_stage *stages; /* the methods the study asks for, in the table's order */
  size_t n_stages;
  const vs_plan_stage *adaptive; /* the one of stages that searches; NULL: none */
  uint64_t count;                /* of cases; where one searches, the most there may be */
  vs_input *inputs;              /* every file the cases are made of */
  size_t n_inputs;
} vs_plan;

/* Frees what vs_study_file_read made (study/study_file.h). */
void vs_plan_free(vs_plan *plan);

/* The keys of a study's file besides those of methods, with all below them. */
extern const vs_field vs_plan_keys[];

/* True if the file has a key that only studies have. */
bool vs_plan_has_keys(const vs_tree *file, const vs_method *const *methods);

/* Returns the keys a study may have: its own, and those that methods stand under. The list is the
 * caller's to free(). */
const char **vs_plan_known_keys(const vs_method *const *methods, size_t *count);

/* True if a --set is one of the study itself (sample.n=4096) and none of its scene. */
bool vs_plan_is_own(const vs_plan *plan, const char *set);

/* Writes the methods that choose the cases: "grid", "grid x sobol", "worst". */
void vs_plan_method(const vs_plan *plan, char *text, size_t size);

/* Writes the point of case `index`, point[n_axes]. Not for a plan in which a method searches. */
void vs_plan_point(const vs_plan *plan, uint64_t index, double *point);

/* Puts a point, point[n_axes], into a scene's tree, which may have another's. */
void vs_plan_put(const vs_plan *plan, const double *point, vs_tree *tree);

/* Error: the settled scene of that point is not the case that a method meant. */
vs_status vs_plan_check_case(const vs_plan *plan, const double *point, const vs_scene *scene,
                             vs_error *err);

/* Reads the scene with `set` and --set, to be altered and then settled (vs_scene_read_sections). */
vs_status vs_plan_scene(const vs_plan *plan, vs_scene *scene, vs_error *err);

/* ---- for methods ---- */

/* Adds the axis of the scene key that the study's node has for its key. Errors: those of
 * vs_axis_init; the key is an axis already, or is set by --set. *axis is valid until the plan is
 * freed. */
vs_status vs_plan_axis(vs_plan *plan, const vs_node *node, const char *by, vs_axis **axis,
                       vs_error *err);

/* Finds a file the study names: beside the study, else from the working folder, else among those
 * that come with the program's studies. */
vs_status vs_plan_find(const vs_node *name, char path[VS_PATH_SIZE], vs_error *err);

/* Adds a file that the cases are made of: it enters the manifest, and what the study is told apart
 * by. */
vs_status vs_plan_input(vs_plan *plan, const char *path, vs_error *err);

/* Cells of a row that are words. */
enum {
  VS_RESULT_HAPPENED,
  VS_RESULT_NOT_JUDGED,
  VS_RESULT_WARNINGS,
  VS_RESULT_WHY, /* of a case that failed */
  VS_RESULT_WORDS
};

/* What a method that searches is shown: cases 0..count-1, in order. */
typedef struct vs_results {
  const vs_plan *plan;
  uint64_t count;
  const double *points; /* [count][plan->n_axes] */
  /* [count][1 + plan->n_columns], margin_least first; to 12 digits, as study.csv has them. NaN: not
   * known. */
  const double *values;
  const int *status;  /* 0; 3: a rating is violated; 1: the case failed, its values are NaN */
  char *const *words; /* [count][VS_RESULT_WORDS]; NULL: the cell is empty */
} vs_results;
/* The case's value in that column of the plan's, or in VS_COLUMN_MARGIN. */
double vs_plan_results_value(const vs_results *results, uint64_t index, int column);

/* The points a method that searches asks for next. */
typedef struct vs_generation {
  double *points; /* [count][n_axes]; grows by vs_plan_generation_add */
  size_t n_axes, count, capacity;
} vs_generation;
void vs_plan_generation_add(vs_generation *generation, const double *point);
