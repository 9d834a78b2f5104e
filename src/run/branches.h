/* SPDX-License-Identifier: GPL-3.0-or-later
 * The branches of a circuit: its elements and those of its subcircuits, their nodes, and the
 * signals that are their currents. From the signals at one instant, or from the difference of two
 * instants, it is found which branches a device's current comes from, by Kirchhoff's law at its
 * node, and which elements along a loop a voltage is made of. */
#pragma once

#include "base/names.h"
#include "engine/timeline.h"
#include "ngspice/circuit.h"

/* An element other than an instance of a subcircuit. Its current into end k is sign[k] times
 * signal[k], once vs_branches_complete has been called. */
enum { VS_BRANCH_ENDS = 6, VS_BRANCH_PINS = 12 };
typedef struct vs_branch {
  char *name; /* as ngspice has it: "c.xv1.cpar"; owned */
  char letter;
  size_t top;   /* the element of the top level that it is, or lies in */
  size_t count; /* of the ends that carry a current */
  size_t node[VS_BRANCH_ENDS], signal[VS_BRANCH_ENDS];
  double sign[VS_BRANCH_ENDS];
  size_t factor; /* a signal: how many are in parallel, where the current is that of one of them;
                    0: the current is that of all */
  bool wire;     /* a source of 0 V */
} vs_branch;

/* An element of the top level, which may be an instance of a subcircuit. */
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

/* The number of the signal of that name, "v(a)" or "i(vth)"; n_signals: there is none. */
size_t vs_branches_signal(const vs_branches *branches, const char *name);

/* Completes the signals of a step. Multiplies currents that the solver gives for one of several
 * elements in parallel, and finds the currents of transistors that it does not give. */
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

/* The element of the top level that is a device of the deck, or the coil; n_tops: there is none. If
 * a source of 0 V measures the device it is that source, and *node becomes the one where the
 * current flows into it. Otherwise it is the device's element at *node. */
size_t vs_branches_device(const vs_branches *b, int device, size_t *node);
size_t vs_branches_coil(const vs_branches *b);
/* The current into an element at a node. */
double vs_branches_current(const vs_branches *b, const double *signals, size_t top, size_t node);

/* Finds which branches the current `a` into an element comes from, at its terminal `node`, through
 * sources of 0 V and fuses. The last share is the sum of those that there is no room for. One
 * current may be unknown: it is what the others leave. Returns false if more are, or there are no
 * shares. */
bool vs_branches_share_current(const vs_branches *b, const double *signals, size_t top, size_t node,
                               double a, vs_shares *shares);

/* Finds which elements the voltage from node `plus` to node `minus` is made of, along a loop
 * through a source: that of the event, else the mains'. The loop does not go through the device of
 * this number (-1: none is barred). Returns false if there is no such loop. */
bool vs_branches_share_voltage(const vs_branches *b, const double *signals, int device, int event,
                               size_t plus, size_t minus, vs_shares *shares);
