/* SPDX-License-Identifier: GPL-3.0-or-later
 * Multipliers of an orbit on tier circuit, by differences. At the orbit's beginning the process is
 * copied with all of the circuit's hidden state (ngspice/child.h). Each copy pushes one state of
 * the machine aside, runs on, and tells where the push has come to.
 *
 * A period later what the circuit forgets is gone. What is left of the pushes, z = (q, q', lambda)
 * behind the first period, shows all that the machine and one slow state of the circuit remember.
 * With Z1 the pushes behind the first period, a column for each copy, and Z2 those a period later,
 *   Z2 = R Z1;
 * the eigenvalues of R are the multipliers. There is one column more than states of the machine, as
 * one of the copies runs for a third period. */
#pragma once

#include "engine/step.h"
#include "ngspice/child.h"
#include "orbit/multipliers.h"

enum { VS_COPIES_MOST = VS_MOST_STATES, VS_COPIES_PERIODS = 3 };

/* Where one copy was at the end of each period: q, q', lambda. */
typedef struct vs_process_copies_told {
  double z[VS_COPIES_PERIODS][VS_COPIES_MOST + 1];
} vs_process_copies_told;

/* Start from {0}. */
typedef struct vs_process_copies {
  int count;  /* of the copies; where each pushes a state, of the machine's states */
  int leader; /* the copy that runs for the third period; -1: none does */
  double push[VS_COPIES_MOST];
  vs_child_copy copy[VS_COPIES_MOST];
  bool inside; /* this process is one of the copies */
  int mine;    /* which one */
  int periods; /* it has run */
  vs_process_copies_told told;
} vs_process_copies;

/* Makes the copies, at a state x of the machine. `part`: how far each state is pushed, in parts of
 * its scale. Behind it copies->inside tells who is who, and in a copy x is the pushed state. Error:
 * VS_RUN, there are no processes to be had; those made are gone then. */
vs_status vs_process_copies_fork(vs_process_copies *copies, const vs_model *model,
                                 const double *scale, double part, double *x, vs_error *err);

/* The same of so many copies that begin at start[0], start[1], ... and run for two periods. */
vs_status vs_process_copies_send(vs_process_copies *copies, int count,
                                 double start[][VS_MOST_STATES], double *x, vs_error *err);

/* In the parent: waits for such copies. Returns false for copy j in came[j] where its run has
 * failed. */
void vs_process_copies_await(const vs_process_copies *copies, vs_process_copies_told told[],
                             bool came[]);

/* In the parent: waits for copies that were sent from states each pushed aside in its own
 * direction, and sets R of the states, with Z2 = R Z1. base: where one that was not pushed was
 * behind each period. Error: VS_RUN, a copy has failed, or the pushes have become too much alike.
 */
vs_status vs_process_copies_map(const vs_process_copies *copies, double base[][VS_MOST_STATES],
                                const double *scale, double r[][VS_VARIATION_MOST], vs_error *err);

/* In a copy: takes in the end of a period. Does not return from the last one. */
void vs_process_copies_pass(vs_process_copies *copies, const vs_knot *end);

/* In a copy: ends it, as its run has failed. */
_Noreturn void vs_process_copies_fail(const vs_process_copies *copies);

/* In the parent: waits for the copies and finds the multipliers, the largest first. orbit: the
 * orbit at its beginning, q, q', lambda; scale: the largest sizes of these over it; what is less
 * than `lost` of them is lost in rounding. *found: how
 * many multipliers there are. Error: VS_RUN, a copy has failed, or the multipliers cannot be found.
 */
vs_status vs_process_copies_hear(const vs_process_copies *copies, const double *orbit,
                                 const double *scale, double lost, vs_multiplier *out, int *found,
                                 vs_error *err);
