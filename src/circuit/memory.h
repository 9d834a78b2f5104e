/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a circuit remembers: every capacitor's and junction's voltage, every inductor's current and
 * every switch's control, of the whole netlist with its subcircuits taken apart. */
#ifndef VS_CIRCUIT_MEMORY_H
#define VS_CIRCUIT_MEMORY_H

#include "circuit/deck.h"

enum { VS_MEMORIES = 192, VS_MEMORY_NAME = 160 };

/* The difference of two of the circuit's signals, named as the solver knows them. */
typedef struct vs_memory {
  char plus[VS_MEMORY_NAME], minus[VS_MEMORY_NAME]; /* "v(xf1.i2t)", "v(0)"; "i(l.xt.lleak)" */
} vs_memory;

typedef struct vs_memories {
  vs_memory item[VS_MEMORIES];
  size_t count;
} vs_memories;

/* Fills an empty list; false: the netlist remembers what no signal of it shows (a transmission
 * line, a code model with a state of its own, ...), or cannot be taken apart for certain, or has
 * too many. The EVA is left out: its flux linkage is known. */
bool vs_memories_of(const vs_deck *deck, vs_memories *all);

#endif
