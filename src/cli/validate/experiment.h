/* SPDX-License-Identifier: GPL-3.0-or-later
 * What `validate` works from. An experiment is done once and gives numbers by name, in SI units. A
 * comparison holds one of these numbers against what it should be. */
#pragma once

#include "engine/sim.h"
#include "run/trial.h"

typedef struct vs_number {
  char name[64];
  double value;
} vs_number;

/* A list of numbers. Start from {0}; vs_experiment_numbers_free it. */
typedef struct vs_numbers {
  vs_number *item;
  size_t count, capacity;
} vs_numbers;
void vs_experiment_add(vs_numbers *numbers, double value, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The first number of that name; NaN: there is none. */
double vs_experiment_get(const vs_numbers *numbers, const char *name);
void vs_experiment_numbers_free(vs_numbers *numbers);

enum { VS_EXPERIMENT_SETS = 16, VS_EXPERIMENT_LOOKS = 3 };

typedef struct vs_experiment vs_experiment;
struct vs_experiment {
  /* Adds the experiment's numbers to `out`. `also` is shown every step of a run and may end it. */
  vs_status (*perform)(const vs_experiment *experiment, const vs_observer *also, vs_numbers *out,
                       vs_error *err);
  double wall_s;                        /* about what it takes, for the progress line alone */
  const char *scene;                    /* that comes with the program; NULL: one of defaults */
  const char *tier;                     /* NULL: the one that the scene takes */
  const char *sets[VS_EXPERIMENT_SETS]; /* KEY=VALUE over the scene; NULL ends them */
  double look_s[VS_EXPERIMENT_LOOKS];   /* instants at which channels are noted; 0 ends them */
  bool multipliers;                     /* an orbit's multipliers are wanted */
  const char *curve;                    /* a probe whose wave form is read; NULL: none */
};

/* One comparison: one line of what `validate` prints. */
typedef struct vs_comparison {
  const char *name, *unit;
  const vs_experiment *experiment;
  const char *what;           /* name of the experiment's number */
  double expected;            /* in SI; not read where there is `other` */
  const vs_experiment *other; /* the experiment whose number of that name is expected; NULL: none */
  double tolerance;           /* as a part of the scale */
  double scale;               /* what errors are parts of; 0: what is expected */
  const char *source, *why;   /* of the number expected; of the tolerance */
} vs_comparison;

typedef struct vs_comparisons {
  const vs_comparison *item;
  size_t count;
} vs_comparisons;

/* The program's own comparisons: one list a file, plugs of the command's table (validate.c). */
extern const vs_comparisons vs_single_shot_comparisons, vs_phase_control_comparisons,
    vs_continuous_comparisons, vs_tiers_comparisons, vs_snubber_comparisons, vs_surge_comparisons,
    vs_machines_comparisons;

/* Runs the experiment's scene with its sets, and adds: every measure, and its
 * instant as NAME.at; energy.NAME; loss.NAME; NAME_min and NAME_max of the deck's probes;
 * DEVICE.MEASURE; books, which is what the worst energy balance leaves over, as a part of what was
 * drawn; i_mean and i_rms of the coil over the run; CHANNEL@INSTANT; contact and release, when a
 * stop is first met and left [s], and CHANNEL@contact and CHANNEL@release; and what
 * vs_experiment_curve_numbers adds of the curve. Errors: those of the scene and of the run; VS_RUN,
 * the ladder had to be climbed. */
vs_status vs_experiment_perform(const vs_experiment *experiment, const vs_observer *also,
                                vs_numbers *out, vs_error *err);

/* Adds frequency and time constant of the modes of the experiment's machine, f1 [Hz], tau1 [s] and
 * so on, by rising frequency, one of each pair. */
vs_status vs_experiment_modes(const vs_experiment *experiment, const vs_observer *also,
                              vs_numbers *out, vs_error *err);

/* Adds every measure of a run that is known, and its instant as NAME.at. */
void vs_experiment_add_measures(const vs_model *model, const vs_result *result,
                                vs_numbers *numbers);

/* Reads the scene of an experiment. `another` is one more KEY=VALUE over its sets; NULL: none.
 * vs_scene_free it even after an error. */
vs_status vs_experiment_scene(const vs_experiment *experiment, const char *another, vs_scene *scene,
                              vs_error *err);

/* A curve, point by point, straight between them. Start from {0}; vs_experiment_curve_free it. */
typedef struct vs_experiment_curve {
  double *t_s, *y;
  size_t count, capacity;
} vs_experiment_curve;
void vs_experiment_curve_add(vs_experiment_curve *curve, double t_s, double y);
void vs_experiment_curve_free(vs_experiment_curve *curve);
/* Adds numbers of a curve's shape. peak, least: its extremes. rise: from 10 to 90 % of the peak.
 * width: between the two halves of the peak. front_v, half_v: front time and time to half value of
 * a voltage surge by IEC 61000-4-5: the front time is 1.67 times the rise from 30 to 90 %; the time
 * to half value counts from the zero of the line through these two points to half the peak behind
 * it. front_i, half_i: the same of a current surge, with 1.25 times the rise from 10 to 90 %. */
void vs_experiment_curve_numbers(const vs_experiment_curve *curve, vs_numbers *out);
