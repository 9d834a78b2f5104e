/* SPDX-License-Identifier: GPL-3.0-or-later
 * A machine at work: the periodic orbit of a scene, and one period of it as a run. What makes the
 * run is run/session.h, as of any other run; what is known of the orbit besides its measures
 * stands here. */
#pragma once

#include "engine/step.h"
#include "measure/devices.h"
#include "measure/extremes.h"
#include "measure/quality.h"
#include "measure/spectrum.h"
#include "measure/throw.h"
#include "orbit/picard.h"
#include "orbit/shooting.h"
#include "run/session.h"

/* The reactions of springs and dampers along each coordinate. Start from {0}. */
typedef struct vs_reaction {
  vs_value peak[VS_MOST_DOF];  /* the largest size, N or N m, and when */
  double squared[VS_MOST_DOF]; /* int (reaction)^2 dt, N^2 s or N^2 m^2 s */
  double span_s;               /* what was taken in so far */
} vs_reaction;

/* What a period tells besides the measures of every run: member, name, unit, text. */
#define VS_STEADY_LIST(X)                                                                          \
  X(power_in_w, "power_in", "W", "mean power drawn from the mains")                                \
  X(i_rms_a, "i_rms", "A", "root mean square of the current drawn from the mains")                 \
  X(i_mean_a, "i_mean", "A", "its mean, the direct current")                                       \
  X(power_factor, "power_factor", "", "power_in over the product of the mains' voltage and i_rms") \
  X(displacement_factor, "displacement_factor", "",                                                \
    "cosine of the angle between harmonic 1 of the current and the mains' voltage")                \
  X(thd, "thd", "", "root of the sum of squares of harmonics 2 to 40, over harmonic 1")            \
  X(energy_stored_j, "energy_stored", "J",                                                         \
    "gained in a period by the coil's field and by the machine: 0 on an orbit")

/* What it tells of the material, where the machine's file says how the trough moves: function of
 * measure/throw.h, name, unit, text. */
#define VS_STEADY_THROW_LIST(X)                                                                    \
  X(vs_throw_coefficient, "throw_coefficient", "",                                                 \
    "the paper's K, largest trough acceleration over g")                                           \
  X(vs_throw_number, "throw_number", "", "largest vertical acceleration of the trough over g")     \
  X(vs_throw_down, "throw_down", "",                                                               \
    "largest acceleration downwards over g: above 1 the material is thrown")                       \
  X(vs_throw_speed, "conveying_speed", "m/s", "theoretical, VDI 2333")

/* Begin with vs_steady_begin, end with vs_steady_end. */
typedef struct vs_steady {
  vs_orbit orbit;
  vs_picard *picard; /* found it, on tier circuit; NULL: on an ideal tier. Owned */
  vs_spectrum spectrum;
  vs_reaction reaction;
  vs_throw thrown;
  vs_warnings *warnings;     /* the scene's; NULL: nobody is to be warned */
  const vs_model *model;     /* the scene's; NULL: there is none yet */
  const vs_devices *devices; /* those of the run's watchers, as long as its result is there; NULL:
                                there are none, or the run is not finished */
#define VS_STEADY_MEMBER(member, name, unit, text) double member;
  VS_STEADY_LIST(VS_STEADY_MEMBER)
#undef VS_STEADY_MEMBER
} vs_steady;

/* One of these measures, or of the reactions along the coordinates. */
typedef struct vs_steady_measure {
  char name[VS_DECK_NAME + 24], text[VS_MACHINE_TEXT];
  const char *unit; /* of the program's */
  vs_value value;   /* SI */
} vs_steady_measure;

/* Finds the orbit of that many firing periods, and makes the scene the one whose run is a period of
 * it: run.until is the period, the start is the orbit's, t = 0 is the mains' rise through zero. On
 * tier circuit the run itself finds the orbit, while it settles (orbit/picard.h). Errors: VS_INPUT,
 * the scene's tier knows no orbits; those of vs_shooting_find and vs_picard_new. */
vs_status vs_steady_begin(vs_steady *steady, vs_scene *scene, int periods, vs_error *err);
void vs_steady_end(vs_steady *steady);

/* The same of an orbit that is known, where this is the setup of a run along a whole period. */
void vs_steady_follow(vs_steady *steady, const vs_orbit *orbit, const vs_setup *setup);

/* Makes the setup of a run of the scene along the orbit, as vs_shooting_setup does. The pulse of
 * the firing period before t = 0 is only kept where it is so long that it counts. */
vs_setup vs_steady_setup(const vs_scene *scene, const vs_run_values *run, const vs_orbit *orbit);

/* The errors of vs_steady_begin that are known before any search. */
vs_status vs_steady_check(const vs_scene *scene, int periods, vs_error *err);

/* Before each attempt at that run: makes the scene, which may be another reading of the one that
 * was begun with, the one to be run. */
void vs_steady_again(vs_steady *steady, vs_scene *scene);

/* How many multipliers are known. On tier circuit there may be one more than states of the machine,
 * or none. */
int vs_steady_multipliers(const vs_steady *steady);

/* False where it is not known whether the orbit is stable: on tier circuit there may be no
 * multipliers, or their error may hide on which side of 1 the largest lies. */
bool vs_steady_is_judged(const vs_steady *steady);

/* Takes a step of that run, and completes what is known from its result. */
void vs_steady_accept(vs_steady *steady, const vs_step *step);
void vs_steady_finish(vs_steady *steady, const vs_result *result);

/* Fills `measure` with the k-th measure, from 0, and returns true; false: there are no more. First
 * come those of VS_STEADY_LIST; then, of each coordinate NAME, reaction_NAME, the largest size of
 * the reaction along it, and reaction_NAME_rms; then those of VS_STEADY_THROW_LIST, of which some
 * are not known; then those of the devices (heat.h). */
bool vs_steady_at(const vs_steady *steady, int k, vs_steady_measure *measure);

/* Makes the scene without events, and as if it began at rest: what `start: steady` means the orbit
 * of. It borrows what the scene owns; the caller frees it with free(). */
vs_scene *vs_steady_undisturbed(const vs_scene *scene);

/* vs_session_run, also for scenes with `start: steady` or `load.fraction: auto`: before each
 * attempt the scene's orbit and the share of its load that rides are found. Behind it the scene's
 * order has no pilot. Errors besides: those of vs_shooting_find, vs_picard_new and
 * vs_fraction_settle. */
vs_status vs_steady_run(const vs_session *session, vs_scene *scene, vs_result *result,
                        vs_error *err);
