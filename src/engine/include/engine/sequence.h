/* SPDX-License-Identifier: GPL-3.0-or-later
 * The sequence of what a device did in a run: its firings and the ends of its conductions, in their
 * order and with their instants, and what went against its gate; of a fuse, when it melts, clears
 * and arcs again. Two runs of a scene that differ in how finely they are solved must have the same
 * sequence; where they do not, what hangs on it is not known from either of them.
 *
 * A single run, too, may show that its sequence is on edge: that something happened which a small
 * error may undo, or that was near to happening. */
#ifndef VS_ENGINE_SEQUENCE_H
#define VS_ENGINE_SEQUENCE_H

#include <stdbool.h>
#include <stddef.h>

/* What is counted. */
typedef enum vs_deed {
  VS_DEED_FIRES,
  VS_DEED_GOES_OUT,
  VS_DEED_MISFIRES,
  VS_DEED_UNINTENDED,
  VS_DEED_FAILS, /* to commutate */
  VS_DEED_MELTS,
  VS_DEED_CLEARS,
  VS_DEED_ARCS_AGAIN,
  VS_DEEDS
} vs_deed;

/* Start from {0}. */
enum { VS_SEQUENCE_KEPT = 512 };
typedef struct vs_sequence {
  long count[VS_DEEDS];
  size_t kept; /* how many deeds are kept with their instants: the first ones of the run */
  struct {
    double at_s;
    vs_deed deed;
  } item[VS_SEQUENCE_KEPT];
  bool edge; /* a sign was seen that the sequence is on edge */
} vs_sequence;

/* Adds a deed at its instant. */
void vs_sequence_add(vs_sequence *sequence, vs_deed deed, double at_s);

/* What two sequences have differently: "fires 3 times" and "once", or "fires at 0.1 s" and "at 0.2
 * s". */
enum { VS_SEQUENCE_SAYS = 64 };
typedef struct vs_sequence_difference {
  char one[VS_SEQUENCE_SAYS], other[VS_SEQUENCE_SAYS];
  double parts_s; /* instant of the first deed that is not the same in both */
} vs_sequence_difference;

/* Returns true where the two sequences are the same: as many deeds of each kind, in the same order,
 * and each within `window_s` of the other's. Else *difference tells the first that differs. */
bool vs_sequence_agrees(const vs_sequence *one, const vs_sequence *other, double window_s,
                        vs_sequence_difference *difference);

#endif
