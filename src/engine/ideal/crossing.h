/* SPDX-License-Identifier: GPL-3.0-or-later
 * What may end a stretch of motion on an ideal tier: a quantity that falls through zero. It is the
 * flux linkage of a conduction, or how far the armature is from a stop or inside it. */
#ifndef VS_ENGINE_CROSSING_H
#define VS_ENGINE_CROSSING_H

#include "ideal/series.h"

/* A step that was just taken, before its end is shown to the observers. All is borrowed. */
typedef struct vs_taken {
  const vs_driven *driven; /* what drives the machine; since_s is that of `from` */
  const vs_series *series; /* from `from` on */
  const vs_knot *from, *to;
  bool valve;     /* a thyristor stands between mains and coil */
  bool disturbed; /* the scene has events */
} vs_taken;

typedef struct vs_crossing {
  enum { VS_GOES_ON, VS_FLUX_ENDS, VS_CONTACT_BEGINS, VS_CONTACT_ENDS } kind;
  int stop; /* of a contact, which of the model's */
} vs_crossing;

/* Returns which one comes first in a step along the series, which is *length_s long. *length_s
 * becomes the time from the step's beginning to it. */
vs_crossing vs_crossing_find(const vs_taken *taken, double *length_s);

/* Returns true if the armature meets a stop in the step. It does not read the series and since_s,
 * so that the step may be one that the propagator took. */
bool vs_crossing_meets(const vs_taken *taken);

#endif
