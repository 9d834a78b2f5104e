/* SPDX-License-Identifier: GPL-3.0-or-later
 * The elements of a deck and the nodes between them, with all subcircuits opened: the circuit as
 * the solver sees it. Each element knows the line that it comes from. */
#pragma once

#include "netlist/cards.h"
#include "netlist/deck.h"

enum { VS_WIRING_PINS = 24, VS_WIRING_LOOKS = 24, VS_WIRING_NAME = 128 };

/* An element. Its pins are the nodes that it is connected to. Its looks are the nodes whose voltage
 * controls it and that carry none of its current. Both are indices into vs_wiring.nodes. */
typedef struct vs_wire {
  const vs_line *line; /* borrowed from the deck */
  char letter; /* its name's first, in lower case, which tells its kind; 'x': an instance of what
                  the deck does not define, or the EVA */
  char name[VS_WIRING_NAME]; /* in lower case, after the instances that contain it: "xthy.r1" */
  int pins[VS_WIRING_PINS], n_pins;
  int looks[VS_WIRING_LOOKS], n_looks;
  char *law; /* the formula of its value or its switching, with the solver's names of nodes and
                sources: "v(xthy.c,0)"; owned; NULL: nothing controls it */
  const vs_netlist_card *model; /* the line of its model; NULL: it has none */
  bool voltage; /* it sets the voltage between its pins, as V, E, H and B with V= do */
} vs_wire;

/* Begins as {0}; ends with vs_wiring_free. Node 0 is ground. */
typedef struct vs_wiring {
  const vs_deck *deck;   /* borrowed */
  const vs_cards *cards; /* the deck's, borrowed */
  vs_wire *wires;        /* owned, as nodes are */
  size_t count;
  char (*nodes)[VS_WIRING_NAME]; /* their names as the solver has them, in lower case */
  size_t n_nodes;
  vs_names numbers; /* of the nodes */
  bool whole;       /* false: there were too many elements, or an instance contains itself */
} vs_wiring;

/* Opens the deck, whose parts must have been read. */
void vs_wiring_open(vs_wiring *wiring, const vs_deck *deck);
void vs_wiring_free(vs_wiring *wiring);

/* True where the current of that voltage source controls the element. */
bool vs_wiring_senses(const vs_wire *wire, const vs_wire *source);

/* The place of the element's first character. */
vs_where vs_wiring_where(const vs_wire *wire);
