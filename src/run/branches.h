/* SPDX-License-Identifier: GPL-3.0-or-later
 * The branches of a circuit: its elements with those of its subcircuits, the nodes they lie at, and
 * the signals that their currents are. From these, at one instant or as a difference of two, comes
 * which branches a device's current is made of, by Kirchhoff's law at its node, and which elements
 * along a loop a voltage is made of. */
#ifndef VS_RUN_BRANCHES_H
#define VS_RUN_BRANCHES_H

#include "base/names.h"
#include "engine/timeline.h"
#include "ngspice/circuit.h"

/* An element that is none of a subcircuit's instances. Its current into end k is sign[k] times the
 * signal, once that was completed. */
enum { VS_BRANCH_ENDS = 6, VS_BRANCH_PINS = 12 };
typedef struct vs_branch {
  char *name; /* as ngspice has it: "c.xv1.cpar"; owned */
  char letter;
  size_t top;   /* the element of the circuit itself that it is, or is a part of */
  size_t count; /* of the ends that carry a current */
  size_t node[VS_BRANCH_ENDS], signal[VS_BRANCH_ENDS];
  double sign[VS_BRANCH_ENDS];
  size_t factor; /* a signal: how many of it are in parallel, where the current is that of one; 0:
                    the current is that of all */
  bool wire;     /* a source of 0 V */
} vs_branch;

/* An element of the circuit itself. */
typedef struct vs_branch_top {
  char name[VS_DECK_NAME];  /* in lower case */
  char label[VS_DECK_NAME]; /* what people call it: a device, "mains", "the coil", an event, or
                               its name */
  char letter;
  int device; /* of the deck; -1: it is none */
  int drive;  /* of the port that drives it, VS_PORT_MAINS or VS_PORT_EVENT; -1: none of these */
  int event;  /* of the timeline, that put it into the deck; -1: none */
  size_t count, node[VS_BRANCH_PINS];
} vs_branch_top;

/* Start from {0}; vs_branches_free frees them. */
typedef struct vs_branches {
  const vs_deck *deck;
  vs_branch *item; /* owned */
  size_t count;
  vs_branch_top *top; /* owned */
  size_t n_tops;
  vs_names nodes; /* their numbers; ground is 0 */
  char **signals; /* the first ones are the nodes' voltages, in the order of their numbers; owned */
  size_t n_nodes, n_signals;
} vs_branches;

void vs_branches_read(const vs_circuit_job *job, const vs_deck *deck, const vs_events *events,
                      vs_branches *branches);
void vs_branches_free(vs_branches *branches);

/* The signal that a term has for one of its two, "v(a)" or "i(vth)"; n_signals: there is none. */
size_t vs_branches_signal(const vs_branches *branches, const char *name);

/* Completes the signals of a step: multiplies currents that the solver tells for one of several in
 * parallel, and finds those of transistors that it does not tell. */
void vs_branches_complete(const vs_branches *branches, double *signals);

/* A part of a current or a voltage. */
typedef struct vs_share {
  char of[2 * VS_DECK_NAME + 16]; /* "varistor_1's capacitance" */
  double value;
} vs_share;
enum { VS_SHARES_MOST = 24 };
typedef struct vs_shares {
  vs_share item[VS_SHARES_MOST]; /* the largest first */
  size_t count;
} vs_shares;

/* The element of the circuit that is a device of the deck, or the coil; n_tops: none is. Of a
 * device that a source of 0 V measures it is that source, and *node becomes where the current flows
 * into it; of others it is what lies at *node. */
size_t vs_branches_device(const vs_branches *b, int device, size_t *node);
size_t vs_branches_coil(const vs_branches *b);
/* The current into an element at a node. */
double vs_branches_current(const vs_branches *b, const double *signals, size_t top, size_t node);

/* Which branches the current `a` into an element comes from, at its terminal `node`: sources of 0 V
 * and fuses are passed. Of more than there is room for the last one is the sum. A current that is
 * not known is what the others leave, if it is the only one. Returns false where nothing is told.
 */
bool vs_branches_share_current(const vs_branches *b, const double *signals, size_t top, size_t node,
                               double a, vs_shares *shares);

/* Of which elements a voltage from node `plus` to node `minus` is made, along a loop that goes
 * through a source: that of the event, else the mains'. Device number `device`, -1: none, is not
 * passed. Returns false where there is no such way. */
bool vs_branches_share_voltage(const vs_branches *b, const double *signals, int device, int event,
                               size_t plus, size_t minus, vs_shares *shares);

#endif
