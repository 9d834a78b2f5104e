/* SPDX-License-Identifier: GPL-3.0-or-later
 * Newton's iteration for an orbit of machine and circuit as one, where the circuit's solver can
 * tell and set its whole state and knows the monodromy matrix Phi (vs_circuit_map). A pass that
 * began at z and ended at z' is followed by one from z + (I - Phi)^-1 (z' - z), or from a part of
 * the way there. A Phi costs several passes; one is kept for as long as corrections fall fast with
 * it. */
#pragma once

#include "ngspice/circuit.h"
#include "orbit/multipliers.h"

/* Begin with {0}, end with vs_full_newton_free. */
typedef struct vs_full_newton {
  bool failed;   /* it leads nowhere here, and is not to be asked any more */
  int passes;    /* so far */
  int phis;      /* that were found */
  int states;    /* of z */
  double *phi;   /* Phi, in parts of `scale`; owned, with the next: */
  double *scale; /* of each state, when Phi was taken */
  double *step;
  double *factors; /* of I - Phi, of the parts */
  size_t *order;
  int *part, parts;  /* the states that the machine hangs on, its own first; part is owned */
  double size;       /* of the last correction */
  double *from, *to; /* where the last correction leads; `from` is owned, with `to` */
  double taken;      /* so much of it was taken */
  int shorter;       /* and was made less so many times */
  double phi_off;    /* of that behind the pass that Phi is of: how far off it was taken */
} vs_full_newton;

void vs_full_newton_free(vs_full_newton *f);

/* A pass has ended. machine: the first states of z, which have their own sizes, `scale`. Sets where
 * the next pass begins, and *size, the largest of the correction as parts of the sizes; INFINITY:
 * the circuit is still to settle.
 * False, with `failed`: it leads nowhere. */
bool vs_full_newton_turn(vs_full_newton *f, vs_circuit_map *map, int machine, const double *x,
                         const double *scale, double *size);

/* A period has ended that began at the map's start, near the orbit that was found. Sets where the
 * next one begins, by the last Phi, and *size, as above. False: the map is another one. */
bool vs_full_newton_close(vs_full_newton *f, vs_circuit_map *map, int machine, const double *x,
                          double *size);

/* Behind such a pass: is the orbit found? closed: corrections are small enough. precise: its
 * multipliers are wanted, of a Phi that was taken near it. */
bool vs_full_newton_ends(const vs_full_newton *f, vs_circuit_map *map, bool closed, bool precise);

/* How much of a state is left in any behind a period, in parts of their sizes, by the last Phi. */
double vs_full_newton_kept(const vs_full_newton *f, int state);

/* Finds at most `most` multipliers of these parts, the largest first. Returns how many they are; 0:
 * GSL finds none. */
int vs_full_newton_multipliers(const vs_full_newton *f, int most, vs_multiplier *out);
