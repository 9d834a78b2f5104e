/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is the same for all steps of one run, so that a step need not carry it. */
#ifndef VS_ENGINE_FRAME_H
#define VS_ENGINE_FRAME_H

#include <stdbool.h>

#include "netlist/deck.h"
#include "engine/timeline.h"
#include "plant/model.h"
#include "engine/cooling.h"

/* A stretch of time, s. */
typedef struct vs_span_s {
  double from_s, to_s;
} vs_span_s;

/* vs_sim_frame (engine/sim.h) makes it. The pointers lead into the setup, which must outlive it. */
typedef struct vs_frame {
  const vs_model *model;
  const vs_timeline *timeline;
  const vs_cooling *cooling; /* of the deck's devices */
  const vs_deck *deck;       /* whose probes the run has; NULL on a tier without a circuit */
  bool gap_at_rest; /* tier analytic: i = lambda z(0)/(2a), so that L stays as at rest (Eq. 91) */
  vs_span_s means;  /* what means are taken over; from 0 to 0 stands for the whole run */
  bool at_work;     /* the run is whole periods of an orbit */
  bool from_work;   /* the run begins on an orbit, with devices that are warm */
  bool on_orbit;    /* the run begins on one: start: steady */
  double tolerance; /* run.tolerance */
  bool source_is_coil; /* no circuit stands between the mains and the coil: the mains current is
                          the coil's current, and v = R_c i + dlambda/dt is the EVA's voltage */
} vs_frame;

#endif
