/* SPDX-License-Identifier: GPL-3.0-or-later
 * When a fuse melts and when it has cleared, told from its voltage and current.
 *
 * A whole fuse is a resistor. Its resistance R is told from all that it has carried so far, as
 * int v i dt over int i^2 dt. (IEC 60269-1 speaks of the instant at which the arc begins, which an
 * oscillogram shows by the step of the voltage.)
 *
 *   it melts          |v| goes beyond 3 R |i| + 10 V: an arc carries the current. The factor leaves
 *                     room for a resistance that grows with heat, the 10 V for a fuse at its
 *                     fusing current, which may be hot. A step that brings a tenth or more of the
 *                     int i^2 dt so far is not asked, as R is not known before it
 *   it has cleared    behind that, |i| has stayed for 1 ms at most 1 mA plus what 100 kohm would
 *                     carry. The instant told is the beginning of that millisecond
 *   it arcs again     behind that, |i| is above that once more */
#pragma once

#include "measure/switching.h"

/* Start from {0}. */
typedef struct vs_melting {
  bool melted, cleared;
  double i2_s, vi_s; /* integrals of i^2 and v i while it was whole */
  double melted_s;   /* when it melted */
  double gone_s;     /* since when there is no current; NaN: there is one */
  double arc_v;      /* largest voltage across it that went with a current behind its melting */
  bool again;        /* it has cleared, and a current has flown behind that */
} vs_melting;

/* What a step brought; instants, NaN where it brought no such thing. */
typedef struct vs_melting_news {
  double melts_s, cleared_s, again_s;
  double i_a;  /* the size of the current at the step's end, A */
  double i2_s; /* int i^2 dt before it melted, A2.s */
} vs_melting_news;

/* Takes the next step. */
vs_melting_news vs_melting_follow(vs_melting *m, const vs_course_step *c);
