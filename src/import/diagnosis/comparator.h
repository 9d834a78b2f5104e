/* SPDX-License-Identifier: GPL-3.0-or-later
 * Comparators of a circuit: switches without hysteresis, and expressions that jump where one
 * quantity exceeds another. If the jump moves that very quantity back, the comparator may switch at
 * every step of the solver without end. */
#ifndef VS_IMPORT_COMPARATOR_H
#define VS_IMPORT_COMPARATOR_H

#include "diagnosis/note.h"
#include "diagnosis/wiring.h"

enum { VS_COMPARATORS_MOST = 32 };

/* A comparator whose output acts back on its own input. */
typedef struct vs_comparator {
  const vs_wire *wire; /* borrowed from the wiring */
  char text[256];      /* what changes its sign where the element jumps: "(v(a,0))-({level})" */
  bool own; /* its own voltage controls it, so that its jump changes that voltage at once */
} vs_comparator;

typedef struct vs_comparators {
  vs_comparator item[VS_COMPARATORS_MOST];
  size_t count;
} vs_comparators;

/* Finds the comparators with feedback, up to VS_COMPARATORS_MOST of them. */
void vs_comparator_find(const vs_wiring *wiring, vs_comparators *all);

/* Adds a note for each comparator that switches itself with no storage in between: it conducts
 * according to its own voltage, and conducting lowers that voltage. */
void vs_comparator_note(const vs_comparators *all, vs_notes *notes);

/* What to write instead of the element; a part of a sentence. */
const char *vs_comparator_cure(const vs_comparator *comparator);

#endif
