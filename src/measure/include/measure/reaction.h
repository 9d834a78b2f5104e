/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher of the reactions: what springs and dampers do along each coordinate, the rows of
 * K q + B q'. Along a coordinate that moves the whole machine against the ground alone this is the
 * force that the mounts carry into the foundation. */
#ifndef VS_MEASURE_REACTION_H
#define VS_MEASURE_REACTION_H

#include "engine/step.h"
#include "measure/extremes.h"

/* Start from {0}. */
typedef struct vs_reaction {
  vs_value peak[VS_MOST_DOF];  /* the largest size, N or N m, and when */
  double squared[VS_MOST_DOF]; /* int (reaction)^2 dt, N^2 s or N^2 m^2 s */
  double span_s;               /* what was taken in so far */
} vs_reaction;

/* Takes one accepted step. */
void vs_reaction_accept(vs_reaction *reaction, const vs_step *step);

/* The root mean square along the coordinate i. */
double vs_reaction_rms(const vs_reaction *reaction, int i);

#endif
