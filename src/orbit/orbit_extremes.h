/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher of one period of an orbit: the extremes of its motion, how often and how fast it meets
 * each stop, and how near it comes to one that it does not meet. */
#pragma once

#include "measure/extremes.h"

/* Begin with vs_orbit_extremes_begin; it owns nothing. */
typedef struct vs_orbit_extremes {
  vs_extreme least, largest;       /* of the travel g = c.q, m */
  vs_extreme of[2 * VS_MOST_DOF];  /* of each coordinate, its least and its largest value */
  int met[VS_MOST_STOPS];          /* how often each stop was met */
  double nearest_m[VS_MOST_STOPS]; /* how far from each stop's surface the travel turns where it
                                      turns nearest to it, m, whether in the stop or before it;
                                      INFINITY: it turns nowhere */
  double speed_m_s;                /* the largest speed at which a stop was met; 0: none was */
  int fired;                       /* how often the thyristor fired */
} vs_orbit_extremes;

void vs_orbit_extremes_begin(vs_orbit_extremes *turns, const vs_model *model);
/* Takes one accepted step. */
void vs_orbit_extremes_accept(vs_orbit_extremes *turns, const vs_step *step);
/* How often all stops together were met. */
int vs_orbit_extremes_contacts(const vs_orbit_extremes *turns);
