/* SPDX-License-Identifier: GPL-3.0-or-later
 * Lists what a circuit remembers, so that all of it can be watched: every capacitor's and every
 * junction's voltage and every inductor's current, in the whole netlist, with each instance of a
 * subcircuit taken apart. When all of these do as they did a cycle ago, so does the circuit; that
 * is what leaving its solver depends on (engine/macromodel/oneport_macromodel.c). What turns over
 * at a threshold does something else once what it reads has drifted there, so that is listed, too:
 * the control of every switch, and every signal in a formula that is not linear in its signals. */
#pragma once

#include "netlist/deck.h"

/* Room for 192 values is several times what any deck needs that comes with the program. A name has
 * room for a path of 80 characters and a node. */
enum { VS_CIRCUIT_STATES_MOST = 192, VS_CIRCUIT_STATE_NAME = 160 };

/* What depends on a value besides the element that remembers it. */
typedef enum vs_threshold {
  VS_THRESHOLD_NONE,
  VS_THRESHOLD_KNOWN,  /* a switch turns over at `level` */
  VS_THRESHOLD_UNKNOWN /* a formula that has branches, or makes more of what its signals drift by; a
                          transistor; a switch whose levels are not plain numbers */
} vs_threshold;

/* One value, V or A: the signal `plus` less the signal `minus`, as ngspice names them. A voltage
 * is "v(xf1.i2t)" less "v(0)"; a current is "i(l.xt.lleak)" less "v(0)". */
typedef struct vs_circuit_state {
  char plus[VS_CIRCUIT_STATE_NAME], minus[VS_CIRCUIT_STATE_NAME];
  vs_threshold threshold;
  double level[2]; /* V or A: where a switch turns on and where it turns off; else 0 */
} vs_circuit_state;

/* The caller owns it; it needs no freeing. */
typedef struct vs_circuit_states {
  vs_circuit_state item[VS_CIRCUIT_STATES_MOST];
  size_t count;
} vs_circuit_states;

/* Fills *all, which must be empty (count 0). The EVA itself is left out: its flux linkage is known.
 * Returns false where the list cannot be complete; *all is void then. That is so where an element
 * keeps a state that no signal shows (a transmission line, a code model such as `int`), where the
 * netlist cannot be taken apart for certain (a name defined twice), and where there are too many
 * values. */
bool vs_circuit_states_list(const vs_deck *deck, vs_circuit_states *all);

/* True where a capacitor or an inductor of the deck's own file, as opposed to its parts' files,
 * stands at no node that a probe, a loss, a store or a device names. Nobody sees the energy it
 * holds. */
bool vs_circuit_states_are_hidden(const vs_deck *deck);
