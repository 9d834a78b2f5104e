/* SPDX-License-Identifier: GPL-3.0-or-later
 * What `validate` compares: an experiment is done once and gives numbers by name, in SI units; a
 * check is one of them beside what it should be. */
#ifndef VS_VALIDATE_EXPERIMENT_H
#define VS_VALIDATE_EXPERIMENT_H

#include "scene/trial.h"
#include "sim/sim.h"

typedef struct vs_number {
  char name[64];
  double value;
} vs_number;

/* Start from {0}. */
typedef struct vs_numbers {
  vs_number *item;
  size_t count, capacity;
} vs_numbers;
void vs_experiment_add(vs_numbers *numbers, double value, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
double vs_experiment_get(const vs_numbers *numbers, const char *name); /* NaN: there is none */
void vs_experiment_numbers_free(vs_numbers *numbers);

enum { VS_EXPERIMENT_SETS = 16, VS_EXPERIMENT_LOOKS = 3 };

typedef struct vs_experiment vs_experiment;
struct vs_experiment {
  /* also: to be shown every step of a run, which it may end. */
  vs_status (*perform)(const vs_experiment *experiment, const vs_observer *also, vs_numbers *out,
                       vs_error *err);
  double wall_s;                        /* about what it takes: for the time left, nothing else */
  const char *tier;                     /* NULL: as the scene says */
  const char *sets[VS_EXPERIMENT_SETS]; /* KEY=VALUE over a scene of defaults; NULL ends them */
  double look_s[VS_EXPERIMENT_LOOKS];   /* when to note p; 0: no more */
  const char *curve;                    /* a probe whose wave form is read; NULL: none */
};

/* One check, one line. */
typedef struct vs_comparison {
  const char *name, *unit;
  const vs_experiment *experiment;
  const char *what; /* number of the experiment */
  double expected;
  const vs_experiment *other; /* NULL; else `what` is expected to be as it is there */
  double tolerance;           /* of scale */
  double scale;               /* what errors are parts of; 0: of what is expected */
  const char *source, *why;   /* of the number; of the tolerance */
} vs_comparison;

typedef struct vs_comparisons {
  const vs_comparison *item;
  size_t count;
} vs_comparisons;

/* Runs a scene of defaults with the experiment's sets. Gives: every measure, and when it was
 * (NAME.at); energy.NAME, loss.NAME, NAME_min and NAME_max of probes, DEVICE.MEASURE; books, what
 * the worst energy balance leaves over, as a part of what was drawn; i_mean and i_rms of the coil
 * over the run; p@INSTANT; of the curve what vs_experiment_curve_numbers gives. */
vs_status vs_experiment_perform(const vs_experiment *experiment, const vs_observer *also,
                                vs_numbers *out, vs_error *err);

/* Reads the scene of an experiment; another KEY=VALUE goes over its sets (NULL: none).
 * vs_scene_free even after an error. */
vs_status vs_experiment_scene(const vs_experiment *experiment, const char *another, vs_scene *scene,
                              vs_error *err);

/* A curve, point by point; straight between them. Start from {0}. */
typedef struct vs_experiment_curve {
  double *t_s, *y;
  size_t count, capacity;
} vs_experiment_curve;
void vs_experiment_curve_add(vs_experiment_curve *curve, double t_s, double y);
void vs_experiment_curve_free(vs_experiment_curve *curve);
/* peak, least; rise (10 to 90 % of the peak), width (between the halves of it); front_v and half_v:
 * 1.67 times 30 to 90 %, and from the zero of the line through these to the half behind the peak
 * (of a voltage, IEC 61000-4-5); front_i and half_i: 1.25 times 10 to 90 %, the same. */
void vs_experiment_curve_numbers(const vs_experiment_curve *curve, vs_numbers *out);

#endif
