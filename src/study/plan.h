/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study file, read: which scene, what is varied and by which methods, what is reported. A plan
 * knows its cases by number: case k is a point, which has one number for each axis.
 *
 *   scene:   NAME or path                 the default: paper
 *   set:     {KEY: VALUE, ...}            over what the scene says
 *   vary:    {KEY: VALUES, ...}           methods_grid.c: grid; or the name of a CSV file: list
 *   sample:  {method: NAME, ...}          methods_sample.c
 *   find:    {worst: max MEASURE, ...}    methods_worst.c
 *   snubber: {...}                        methods_snubber.c
 *   report:  [MEASURE, ...]               the default: the measures of every run
 *
 * A study that has vary and sample runs all pairs of their points, the last one's index running
 * fastest. A method that chooses its cases by earlier ones' results (find, snubber) uses all axes
 * itself, by their ranges, lists and spreads; the points of vary and sample are then not run. */
#ifndef VS_STUDY_PLAN_H
#define VS_STUDY_PLAN_H

#include <stdint.h>

#include "base/json.h"
#include "scene/scene.h"
#include "watch/verdict.h"

enum { VS_PLAN_AXES = 32, VS_PLAN_COLUMNS = 96, VS_PLAN_STAGES = 4, VS_KEY_SIZE = 192 };
#define VS_PLAN_CASES 100000000ull /* at most */

/* One scene key that differs from case to case. All its numbers are in `unit`. */
typedef struct vs_axis {
  char key[VS_KEY_SIZE];         /* "circuit.r1" */
  char column[VS_KEY_SIZE + 24]; /* "circuit.r1_ohm" */
  char section[VS_KEY_SIZE];     /* "circuit" */
  const vs_field *field;         /* the key's; lives as long as the plan */
  const char *unit;              /* the field's; "" for words and pure numbers */
  const char *by;                /* the study's key it stands under: "vary", "sample", ... */
  vs_where where;                /* of the key in the study */
  bool is_word;   /* a choice or a name: its numbers are indices into word, and it has no range */
  double nominal; /* as the scene and `set` have it; NaN: a word, or the scene has none */
  char **word;
  vs_where *word_where;
  size_t n_words;
  double *value; /* those listed, or those its range is cut into; NULL: none */
  size_t n_values;
  bool ranged; /* from..to is meant, and value cuts it */
  bool log;    /* evenly in the logarithm */
  double from, to;
  void *own; /* what the method that made the axis keeps of it; freed with free() */
} vs_axis;

/* A column of study.csv behind the axes. */
typedef struct vs_report_column {
  char name[VS_JUDGED_NAME];        /* "thyristor.v_reverse" */
  char column[VS_JUDGED_NAME + 24]; /* "thyristor.v_reverse_v" */
  char unit[16], text[VS_DECK_TEXT];
  double rating; /* the limit it is held against, in unit; NaN: none */
  bool at_least; /* that is the least allowed, not the most */
  vs_where where;
} vs_report_column;
enum { VS_COLUMN_MARGIN = -1 }; /* margin_least: in every study, though not asked for */

typedef struct vs_plan vs_plan;
typedef struct vs_method vs_method;

/* A method at work in a plan. */
typedef struct vs_plan_stage {
  const vs_method *method;
  void *state;    /* the method's own */
  size_t axis, n; /* its axes: plan->axes[axis .. axis + n) */
  uint64_t count; /* its points; an adaptive method's: the most it may run */
} vs_plan_stage;

/* What an adaptive method is shown: cases 0..count-1, in order. */
typedef struct vs_results {
  const vs_plan *plan;
  uint64_t count;
  const double *points; /* [count][plan->n_axes] */
  /* [count][1 + n_columns]: margin_least first. As study.csv has them, 12 digits. NaN: not known.
   */
  const double *values;
  const int *status; /* 0; 3: a rating is violated; 1: the case failed, its values are NaN */
} vs_results;
double vs_plan_results_value(const vs_results *results, uint64_t index, int column);

/* The points an adaptive method asks for next. */
typedef struct vs_generation {
  double *points; /* [count][n_axes]; grows by vs_plan_generation_add */
  size_t n_axes, count, capacity;
} vs_generation;
void vs_plan_generation_add(vs_generation *generation, const double *point);

/* A way to choose cases: one const struct, in the table vs_methods_all. */
struct vs_method {
  const char *name; /* "grid" */
  const char *key;  /* the study's key it stands under */
  const char *text; /* what it does, one line */
  /* Is it this one that the section under `key` asks for? The first in the table that says so is
   * taken. */
  bool (*claims)(const vs_node *section);
  /* Reads the section: adds axes (vs_axis_new, vs_axis_values, ...), registers the columns it
   * needs (vs_plan_column), keeps what else it wants in *state, which may stay NULL. Errors with
   * their place, by vs_fail_at; a check carries on from each (vs_error_carry_on). */
  vs_status (*read)(vs_plan *plan, const vs_node *section, void **state, vs_error *err);
  /* Looks at the plan once its columns have their units and ratings. NULL: it has no need to. */
  vs_status (*ready)(const vs_plan *plan, const vs_plan_stage *part, vs_error *err);
  void (*free)(void *state); /* NULL: there is nothing to free */
  /* How many points; 0: an axis of its own has no values. */
  uint64_t (*count)(const vs_plan *plan, const vs_plan_stage *part);
  /* Point `index` of the method's own axes, value[part->n], a pure function of index and seed: any
   * shard, worker and order gives the same. NULL: it is adaptive. */
  void (*point)(const vs_plan *plan, const vs_plan_stage *part, uint64_t index, double *value);
  /* Adaptive methods: asks for the next generation by the results of all earlier ones (count 0 at
   * first); all axes are its own. Adds nothing: it has ended. A pure function of results and seed,
   * called once a generation; after --resume again from the first. NULL: it is not adaptive. */
  vs_status (*next)(const vs_plan *plan, const vs_plan_stage *part, const vs_results *results,
                    vs_generation *generation, vs_error *err);
  /* Adds to an axis of its own, in the manifest, what it knows of it. NULL: nothing. */
  void (*axis_json)(const vs_axis *axis, vs_json *json);
  /* Adds to the manifest the one member that says what it was asked and, once results are there
   * (else NULL), what it found. NULL: nothing. */
  void (*json)(const vs_plan *plan, const vs_plan_stage *part, const vs_results *results,
               vs_json *json);
};

/* methods.c: NULL ends it. */
extern const vs_method *const vs_methods_all[];

typedef struct vs_input {
  char path[VS_PATH_SIZE], sha256[65];
} vs_input;

struct vs_plan {
  char path[VS_PATH_SIZE]; /* of the study */
  vs_tree tree;
  char scene_name[VS_PATH_SIZE];
  vs_where scene_where; /* of that name */
  vs_scene *base;       /* the scene with `set` and --set; its sections have the axes' fields */
  vs_scene *first;      /* with the first case's point too: columns are resolved by it */
  char *const *sets;    /* --set; borrowed */
  size_t n_sets;
  uint64_t seed; /* what methods key their random numbers on; 0 unless one reads another */
  vs_axis axes[VS_PLAN_AXES];
  size_t n_axes;
  vs_report_column columns[VS_PLAN_COLUMNS];
  size_t n_columns;
  vs_plan_stage parts[VS_PLAN_STAGES];
  size_t n_parts;
  const vs_plan_stage *adaptive; /* one of parts; NULL: none */
  uint64_t count;                /* of cases; with an adaptive method the most there may be */
  vs_input *inputs;              /* every file the cases are made of */
  size_t n_inputs;
};

/* name: a path, or the name of a study that comes with the program. Errors: everything a study can
 * be wrong in, and the scene of its first case; a check carries on from most. vs_plan_free even
 * then. */
vs_status vs_plan_read(const char *name, char *const *sets, size_t n_sets, vs_plan *plan,
                       vs_error *err);
void vs_plan_free(vs_plan *plan);

/* "grid", "grid x sobol", "worst": the methods that choose the cases */
void vs_plan_method(const vs_plan *plan, char *text, size_t size);

/* Point of case `index`, point[n_axes]; not of an adaptive plan. */
void vs_plan_point(const vs_plan *plan, uint64_t index, double *point);

/* The scene with `set` and --set, to be altered and then settled (vs_scene_settle). */
vs_status vs_plan_scene(const vs_plan *plan, vs_scene *scene, vs_error *err);
/* Puts the axis' number into a scene's tree. */
void vs_axis_put(const vs_axis *axis, double number, vs_tree *tree);

/* The axis' number as it stands in study.csv, and as text that the scene reads ("330 ohm"). */
void vs_axis_print(const vs_axis *axis, double number, char *text, size_t size);
void vs_axis_text(const vs_axis *axis, double number, char *text, size_t size);

/* ---- for methods ---- */

/* A new axis; key: a node of the study whose key names a scene key ("circuit.r1"). Errors: no such
 * key (nearest named), one that is an axis already, one that is no single value. *axis: valid until
 * the plan is freed. */
vs_status vs_axis_new(vs_plan *plan, const vs_node *key, const char *by, vs_axis **axis,
                      vs_error *err);
/* The axis of that key; NULL: there is none. */
vs_axis *vs_axis_find(vs_plan *plan, const char *key);

/* Reads what a key under vary may say: one value; [a, b, ...]; {from, to, step};
 * {log: [a, b], n}; {lin: [a, b], n}. */
vs_status vs_axis_values(vs_axis *axis, const vs_node *node, vs_error *err);
/* One value, with its unit, within the key's range: its number, to 12 digits; of a word the index,
 * at which it is added when it is new. */
vs_status vs_axis_number(vs_axis *axis, const vs_node *node, double *number, vs_error *err);

/* Finds a file the study names: as it stands, else from the study's folder. */
vs_status vs_plan_find(const vs_plan *plan, const vs_node *name, char path[VS_PATH_SIZE],
                       vs_error *err);
/* A file that the cases are made of: it enters the manifest and what a study is told apart by. */
vs_status vs_plan_input(vs_plan *plan, const char *path, vs_error *err);

/* The index of that measure among the columns (VS_COLUMN_MARGIN for margin_least); a new one when
 * nobody asked for it before. Whether there is such a measure is found out later, with `where`. */
int vs_plan_column(vs_plan *plan, const char *measure, vs_where where);

/* For sections of a method's own keys: each may be read by these. Errors with the node's place. */
vs_status vs_axis_whole(const vs_node *map, const char *key, uint64_t least, uint64_t most,
                        uint64_t *value, vs_error *err); /* stays when the key is not there */

#endif
