/* SPDX-License-Identifier: GPL-3.0-or-later
 * Conclusions from two trials of one scene: whether the solver's other rule is worth while, whether
 * the present rule rings, and which comparators oscillate. */
#pragma once

#include "diagnosis/attempt.h"
#include "diagnosis/note.h"
#include "diagnosis/wiring.h"

/* Comparators: switches without hysteresis, and expressions that jump where one quantity exceeds
 * another. If the jump moves that very quantity back, the comparator may switch at every step of
 * the solver without end. */
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

/* Two trials of one scene from 0 s to the same instant, or to where one of them ended. */
typedef struct vs_judge_case {
  const vs_scene *scene;
  bool gear;                           /* the present rule is Gear's */
  const vs_attempt *now;               /* with the present rule */
  const vs_attempt *other;             /* with the other one */
  const vs_comparator *const *watched; /* the comparator of each of the trials' watches */
  size_t n_watched;
} vs_judge_case;

/* Finds the comparators with feedback, up to VS_COMPARATORS_MOST of them. */
void vs_judge_find_comparators(const vs_wiring *wiring, vs_comparators *all);

/* Adds a note for each comparator that switches itself with no storage in between: it conducts
 * according to its own voltage, and conducting lowers that voltage. */
void vs_judge_note_comparators(const vs_comparators *all, vs_notes *notes);

/* Adds at least one note on what the other rule would do. */
void vs_judge_method(const vs_judge_case *c, vs_notes *notes);
/* Adds a note on the channel that oscillates from step to step with the present rule but not with
 * the other one. */
void vs_judge_ringing(const vs_judge_case *c, vs_notes *notes);
/* Adds a note for each comparator, whether it oscillates or not. */
void vs_judge_comparators(const vs_judge_case *c, vs_notes *notes);
