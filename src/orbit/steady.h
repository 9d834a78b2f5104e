/* SPDX-License-Identifier: GPL-3.0-or-later
 * A machine at work: the periodic orbit of a scene, and one period of it as a run. What makes the
 * run is scene/session.h, as of any other run; what is known of the orbit besides its measures
 * stands here. */
#ifndef VS_ORBIT_STEADY_H
#define VS_ORBIT_STEADY_H

#include "orbit/picard.h"
#include "orbit/reaction.h"
#include "orbit/shooting.h"
#include "orbit/spectrum.h"
#include "scene/result.h"

/* What a period tells besides the measures of every run: member, name, unit, text. */
#define VS_STEADY_LIST(X)                                                                          \
  X(power_in_w, "power_in", "W", "mean power drawn from the mains")                                \
  X(i_rms_a, "i_rms", "A", "root mean square of the current drawn from the mains")                 \
  X(i_mean_a, "i_mean", "A", "its mean, the direct current")                                       \
  X(power_factor, "power_factor", "", "power_in over the product of the mains' voltage and i_rms") \
  X(energy_stored_j, "energy_stored", "J",                                                         \
    "gained in a period by the coil's field and by the machine: 0 on an orbit")

/* Begin with vs_steady_begin, end with vs_steady_end. */
typedef struct vs_steady {
  vs_orbit orbit;
  vs_picard *picard; /* found it, on tier circuit; NULL: on an ideal tier. Owned */
  vs_spectrum spectrum;
  vs_reaction reaction;
  const vs_model *model; /* the scene's; NULL: there is none yet */
#define VS_STEADY_MEMBER(member, name, unit, text) double member;
  VS_STEADY_LIST(VS_STEADY_MEMBER)
#undef VS_STEADY_MEMBER
} vs_steady;

/* One of these measures, or of the reactions along the coordinates. */
typedef struct vs_steady_measure {
  char name[VS_MACHINE_NAME + 16], unit[24], text[VS_MACHINE_TEXT];
  vs_value value; /* SI */
} vs_steady_measure;

/* Finds the orbit of that many firing periods, and makes the scene the one whose run is a period of
 * it: run.until is the period, the start is the orbit's, t = 0 is the mains' rise through zero. On
 * tier circuit the run itself finds the orbit, in its prelude (orbit/picard.h). Errors: VS_INPUT,
 * the scene's tier knows no orbits; those of vs_shooting_find and vs_picard_new. */
vs_status vs_steady_begin(vs_steady *steady, vs_scene *scene, int periods, vs_error *err);
void vs_steady_end(vs_steady *steady);

/* Before each attempt at that run: makes the scene, which may be another reading of the one that
 * was begun with, the one to be run. */
void vs_steady_again(vs_steady *steady, vs_scene *scene);

/* Takes a step of that run, and completes what is known from its result. */
void vs_steady_accept(vs_steady *steady, const vs_step *step);
void vs_steady_finish(vs_steady *steady, const vs_result *result);

/* Fills `measure` with the k-th measure, from 0, and returns true; false: there are no more. First
 * come those of VS_STEADY_LIST; then, of each coordinate NAME, reaction_NAME, the largest size of
 * the reaction along it, and reaction_NAME_rms. */
bool vs_steady_at(const vs_steady *steady, int k, vs_steady_measure *measure);

/* For vs_session.steady: puts a scene with `start: steady` at the beginning of its orbit of one
 * firing period, that of the scene without its events. On tier circuit it gives the scene's order a
 * pilot for that. Errors: those of vs_shooting_find and vs_picard_new. */
vs_status vs_steady_start(vs_scene *scene, vs_error *err);

#endif
