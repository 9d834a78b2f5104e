/* SPDX-License-Identifier: GPL-3.0-or-later
 * The circuit of a deck as a schematic shows it: the elements that carry the main circuit's
 * current, in branches between the nets where three or more of them meet. */
#pragma once

#include "netlist/cards.h"
#include "netlist/deck.h"
#include "netlist/kinds.h"

enum { VS_CIRCUIT_MOST = 64, VS_BRANCH_MOST = 8 /* elements in series */, VS_CIRCUIT_PINS = 6 };

typedef struct vs_circuit_element {
  const vs_netlist_card *card;
  const vs_kind *kind; /* NULL: an element of ngspice's, or a subcircuit that nothing tells about */
  bool mains, coil;    /* the source that the mains drive; the EVA */
  int end[2];          /* nets; the current that counts flows from the first to the second */
  int pin[VS_CIRCUIT_PINS]; /* nets of further pins, where no kind says that they are gates */
  int n_pins;
  int device; /* index into vs_deck.devices; -1: it is none */
  bool drawn;
} vs_circuit_element;

/* Elements in series. */
typedef struct vs_circuit_branch {
  int end[2];
  int element[VS_BRANCH_MOST];
  bool reversed[VS_BRANCH_MOST]; /* it is passed from its second end to its first */
  int count;
} vs_circuit_branch;

typedef struct vs_circuit {
  const vs_cards *cards; /* borrowed from the deck */
  vs_circuit_element element[VS_CIRCUIT_MOST];
  int n_elements;
  vs_word net[VS_CIRCUIT_MOST]; /* names; borrowed likewise */
  int joined[VS_CIRCUIT_MOST];  /* the net that this one is the same as, behind ammeters; itself */
  int n_nets, ground;           /* ground: -1: there is none */
  int rail[2];                  /* top and bottom: those of a bridge; else -1 and the ground */
  vs_circuit_branch branch[VS_CIRCUIT_MOST];
  int n_branches;
  /* names of what is not drawn: sources of 0 V, through which a current is measured; couplings of
   * inductors; what lies outside of the main circuit */
  vs_text ammeters, couplings, aside;
} vs_circuit;

/* Reads the circuit of a deck whose parts are read. Returns false where it cannot be drawn; `why`
 * then says so. vs_schematic_circuit_free is due in either case. */
bool vs_schematic_circuit_read(const vs_deck *deck, vs_circuit *c, vs_text *why);
void vs_schematic_circuit_free(vs_circuit *c);
