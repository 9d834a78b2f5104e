/* SPDX-License-Identifier: GPL-3.0-or-later
 * What in a circuit forgets slowly, while its orbit is searched for (orbit/picard.h). A core's
 * flux linkage may creep for a hundred cycles, as that of a transformer which a thyristor loads
 * with direct current. Such a flux is moved: in a firing period of its own the mains get a voltage
 * of a known area, v(t) = A/T (1 - cos 2 pi t/T). The next period is a clean one again and tells by
 * how much the flux still creeps; where it would not creep any more is then found by secants.
 *
 * A flux linkage is known by its probe, whose unit is Wb. What else creeps, by a probe in V or A,
 * is only waited for. */
#pragma once

#include "engine/setup.h"
#include "engine/step.h"

/* A clean pass: the flux linkage at its beginning, and by how much it changed, Wb. */
typedef struct vs_slow_modes_point {
  double flux_wb, change_wb;
} vs_slow_modes_point;

/* One probe from pass to pass. */
typedef struct vs_slow_modes_probe {
  double value;       /* at the end of the last pass */
  double change;      /* over it */
  double ratio;       /* of this change to the one before; NaN: not known */
  int steady;         /* for how many passes that ratio has been about the same */
  double peak, scale; /* largest size: in this pass; in the last one */
  double remains;     /* how far it will still creep; 0: it does not, or that is not known */
} vs_slow_modes_probe;

/* Begins with vs_slow_modes_begin. */
typedef struct vs_slow_modes {
  const vs_deck *deck;
  double tolerance; /* of what remains, relative to each probe's scale */
  double period_s;  /* of a push */
  int passes;       /* clean ones since the last push, or the beginning */
  vs_slow_modes_probe probe[VS_DECK_MOST];
  int moved;                        /* the probe that is moved; -1: none yet */
  double area_v_s;                  /* of the push in the present pass; 0: it is a clean one */
  double gain;                      /* how much flux linkage a push brings for its area */
  double from_wb;                   /* the flux linkage where the push began */
  double nature_wb;                 /* what it would have crept meanwhile */
  vs_slow_modes_point last, before; /* the last clean pass with a change that was taken in, and the
                                  one before */
  vs_slow_modes_point across;       /* the latest one that crept the other way than the last one */
  int points;                       /* how many were taken in */
  bool bracketed;                   /* there is one across: what is sought lies between */
} vs_slow_modes;

/* tolerance: as in the struct. period_s: a firing period. The deck must outlive it. */
void vs_slow_modes_begin(vs_slow_modes *creep, const vs_deck *deck, double tolerance,
                         double period_s);

/* Takes in a step of the present pass. */
void vs_slow_modes_accept(vs_slow_modes *creep, const vs_step *step);

/* Takes in the end of a pass, and decides on the next one. Returns true if the pass that ended was
 * a clean one, false if it was pushed. */
bool vs_slow_modes_turn(vs_slow_modes *creep, const vs_knot *end);

/* True once enough passes were seen to tell what creeps. */
bool vs_slow_modes_is_told(const vs_slow_modes *creep);

/* The voltage, V, that is added to the mains at t_s of the present pass. */
double vs_slow_modes_push(const vs_slow_modes *creep, double t_s);

/* The probe that creeps most, for its scale, with more than the tolerance; NULL: none does. */
const vs_slow_modes_probe *vs_slow_modes_worst(const vs_slow_modes *creep, const char **name);
