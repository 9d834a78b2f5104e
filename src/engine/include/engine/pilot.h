/* SPDX-License-Identifier: GPL-3.0-or-later
 * Who steers a run of tier "circuit" before it begins. The circuit's hidden state cannot be set,
 * but the machine's can. So a run that is to begin on a periodic orbit has a prelude: firing
 * periods without the scene's events, each of which goes from t = 0 to the period's end. At each
 * end the pilot puts the machine into another state, while the solver goes on. Once the pilot says
 * so, t = 0 is the beginning of the run that the observer sees.
 *
 * orbit/picard.h is one. */
#ifndef VS_ENGINE_PILOT_H
#define VS_ENGINE_PILOT_H

#include "engine/setup.h"
#include "engine/step.h"

typedef struct vs_pilot {
  void *self;
  double period_s;          /* of the prelude's parts, a number of whole cycles of the mains */
  int of_orbit;             /* so many of them make a period of the orbit */
  int most;                 /* so many of them there may be; then `turn` must end the run */
  double x[VS_MOST_STATES]; /* q, q' at the beginning of each part, and then of the run */
  /* A run of this setup begins: sets x. */
  void (*begin)(void *self, const vs_setup *setup);
  /* Is shown the steps of the prelude. */
  void (*accept)(void *self, const vs_step *step);
  /* A part of the prelude has ended, with this knot: sets x. *begins: the run begins. An error ends
   * the run with VS_RUN. VS_INPUT: an orbit of another period is to be asked for. */
  vs_status (*turn)(void *self, const vs_knot *end, bool *begins, vs_error *err);
  /* The voltage, V, that is added to the mains at t_s of this part of the prelude. */
  double (*push)(void *self, double t_s);
  /* The run has come to its end, or has failed. */
  void (*end)(void *self);
  /* Frees the pilot, where the run's session is to do that; NULL: its owner does. */
  void (*free)(void *self);
} vs_pilot;

#endif
