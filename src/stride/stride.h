/* SPDX-License-Identifier: GPL-3.0-or-later
 * How long the solver's next try of a step should be, where its own proposal wastes tries. The
 * solver still judges each try by its own truncation error, so that no step is accepted which it
 * would not accept otherwise. */
#ifndef VS_STRIDE_STRIDE_H
#define VS_STRIDE_STRIDE_H

#include <stdbool.h>

/* What is remembered of the steps so far. Begins with vs_stride_begin. */
typedef struct vs_stride {
  bool first;        /* the next step, or the one under way, begins at an edge of a source */
  bool failed;       /* a try of that step was rejected */
  bool held;         /* it was proposed shorter here than the solver had it */
  double first_s[2]; /* lengths of the last two such steps, the later one first; INFINITY: its first
                        try was as the solver proposed it, and was accepted */
} vs_stride;

void vs_stride_begin(vs_stride *stride);

/* A step begins. Returns its length, s, at most what the solver proposes. */
double vs_stride_start(vs_stride *stride, double proposed_s);

/* A try of tried_s was rejected. Returns the length of the next try, s, at least what the solver
 * proposes. */
double vs_stride_again(vs_stride *stride, double tried_s, double proposed_s);

/* A step of that length was accepted. at_edge: it ends at an edge of a source. */
void vs_stride_done(vs_stride *stride, double step_s, bool at_edge);

#endif
