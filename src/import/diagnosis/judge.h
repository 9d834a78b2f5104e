/* SPDX-License-Identifier: GPL-3.0-or-later
 * What two trials of one scene say: whether the solver's other rule pays, whether the present one
 * rings, and which comparators go to and fro. */
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
  const vs_comparator *const *watched; /* whose are the trials' watches, in their order */
  size_t n_watched;
} vs_judge_case;

/* Adds what the other rule would do, one note at the least. */
void vs_judge_method(const vs_judge_case *c, vs_notes *notes);
/* Adds the channel that goes to and fro from step to step with the present rule and not with the
 * other one. */
void vs_judge_ringing(const vs_judge_case *c, vs_notes *notes);
/* Adds a note for each comparator, whether it goes to and fro or not. */
void vs_judge_comparators(const vs_judge_case *c, vs_notes *notes);

#endif
