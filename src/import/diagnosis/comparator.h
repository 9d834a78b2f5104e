/* SPDX-License-Identifier: GPL-3.0-or-later
 * Comparators of a circuit: switches without hysteresis, and expressions that jump where one
 * quantity passes another. One whose jump moves that very quantity back may be at it for ever: each
 * step of the solver turns it over. */
#ifndef VS_IMPORT_COMPARATOR_H
#define VS_IMPORT_COMPARATOR_H

#include "diagnosis/note.h"
#include "diagnosis/wiring.h"

enum { VS_COMPARATORS_MOST = 32 };

/* What is compared by one element; what the element does reaches what it looks at. */
typedef struct vs_comparator {
  const vs_wire *wire; /* borrowed from the wiring */
  char text[256];      /* what changes its sign where the element jumps: "(v(a,0))-({level})" */
  bool own; /* it looks at the voltage across itself, so that its jump moves that at once */
} vs_comparator;

typedef struct vs_comparators {
  vs_comparator item[VS_COMPARATORS_MOST];
  size_t count;
} vs_comparators;

/* Finds those that are fed back; beyond VS_COMPARATORS_MOST the rest is left out. */
void vs_comparator_find(const vs_wiring *wiring, vs_comparators *all);

/* Adds a note for each that turns itself over without any memory between: its own voltage, which it
 * lowers by conducting, is what it conducts by. */
void vs_comparator_note(const vs_comparators *all, vs_notes *notes);

/* What to write in the element's place; a part of a sentence. */
const char *vs_comparator_cure(const vs_comparator *comparator);

#endif
