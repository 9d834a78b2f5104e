/* SPDX-License-Identifier: GPL-3.0-or-later
 * Conclusions from two trials of one scene: whether the solver's other rule is worth while, whether
 * the present rule rings, and which comparators oscillate. */
#ifndef VS_IMPORT_JUDGE_H
#define VS_IMPORT_JUDGE_H

#include "diagnosis/attempt.h"
#include "diagnosis/comparator.h"

/* Two trials of one scene from 0 s to the same instant, or to where one of them ended. */
typedef struct vs_judge_case {
  const vs_scene *scene;
  bool gear;                           /* the present rule is Gear's */
  const vs_attempt *now;               /* with the present rule */
  const vs_attempt *other;             /* with the other one */
  const vs_comparator *const *watched; /* the comparator of each of the trials' watches */
  size_t n_watched;
} vs_judge_case;

/* Adds at least one note on what the other rule would do. */
void vs_judge_method(const vs_judge_case *c, vs_notes *notes);
/* Adds a note on the channel that oscillates from step to step with the present rule but not with
 * the other one. */
void vs_judge_ringing(const vs_judge_case *c, vs_notes *notes);
/* Adds a note for each comparator, whether it oscillates or not. */
void vs_judge_comparators(const vs_judge_case *c, vs_notes *notes);

#endif
