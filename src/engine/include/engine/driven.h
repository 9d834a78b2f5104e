/* SPDX-License-Identifier: GPL-3.0-or-later
 * What drives the machine on an ideal tier from a knot on, and the knot's derivatives that follow
 * from it. */
#pragma once

#include "engine/step.h"
#include "engine/wave.h"

/* The state as one vector: y = (q, q', lambda, psi), lambda and the secondaries' flux linkages in
 * the last places whatever the number of coordinates. */
enum { VS_FLUX = VS_MOST_STATES, VS_PSI, VS_CONDUCTING = VS_PSI + VS_MOST_RUNGS };

typedef struct vs_driven {
  const vs_frame *frame;
  bool conducting;  /* dlambda/dt = u - R_c i; else lambda = 0 */
  bool fades;       /* not conducting, and eddy currents keep a flux: i = 0, lambda is not */
  bool held;        /* the armature is jammed: the gap stays what it is */
  unsigned touched; /* the stops that the armature is in, as bits (plant/stops.h) */
  vs_wave mains;    /* u; looked at only while conducting */
  double since_s;   /* the knot's time, counted from the origin of u */
  /* The size that counts as large for q, m and rad, and for lambda, Wb. Errors are relative to it.
   */
  double coordinate[VS_MOST_DOF], flux_wb;
} vs_driven;

/* Sets the derivatives of a knot whose q, q' and lambda are there: q", q"' and the first three of
 * lambda. since_s is the knot's time, counted from the origin of u. */
void vs_driven_fill(const vs_driven *driven, double since_s, vs_knot *knot);

/* With eddy currents: gives dlambda/dt and the rates of psi at this state, of which z holds the gap
 * and its rate, and u is the mains' voltage. */
double vs_driven_flux_rate(const vs_driven *driven, double u, double flux, const double *psi,
                           const double z[2], double *psi_rate);
/* The coil's current and its first two derivatives at a knot that has its own while conducting; u:
 * the mains' voltage likewise, z: the gap. */
void vs_driven_current(const vs_driven *driven, const vs_knot *knot, double since_s, double i[3]);

/* Sets what is large: for lambda what the mains can build up from the firing angle on, or what
 * direct voltage builds up in the coil's time constant; for the coordinates what its force moves.
 * valve: a thyristor stands between mains and coil. */
void vs_driven_find_large(vs_driven *driven, bool valve);
/* Sets what is large for the coordinates: how far the force of a large flux linkage moves each of
 * them at the working mode, or where nothing holds the machine how far they go as the gap closes.
 * One that the force does not move gets 1e-6 of what the gap gets. */
void vs_driven_find_coordinates(vs_driven *driven);
/* What u builds up in lambda from t_s, where its wave begins, until it falls or changes, Wb; at
 * least a thousand millionth of what the mains build up. */
double vs_driven_built_up(const vs_driven *driven, double t_s);

/* Returns the next instant at which u falls through zero, s from u's origin. If `disturbed`, u may
 * be any wave: it is searched from since_s to most_s, and most_s is returned if it does not fall.
 * Else u is one sine that begins in its positive half wave. INFINITY: u has no sines. */
double vs_driven_mains_turn(const vs_driven *driven, bool disturbed, double most_s);
