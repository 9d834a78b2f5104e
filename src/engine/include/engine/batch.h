/* SPDX-License-Identifier: GPL-3.0-or-later
 * Some steps of a circuit, one behind the other, with what the deck's terms had in them: for
 * watchers that evaluate formulas. An operation is looked up once for all of these steps, and then
 * done for one after the other. Each piece of a step between which terms run straight is one here,
 * so that their values half way and at its end say all. */
#pragma once

#include "engine/step.h"

/* A number half way through a step, and the same at its end. One instruction works on both. */
typedef double vs_pair __attribute__((vector_size(2 * sizeof(double))));

enum { VS_BATCH_STEPS = 32 };

/* Start from {0}; `count` is set to 0 once the steps were looked at. */
typedef struct vs_batch {
  size_t count, last;                                /* last: where the last step begins */
  double t0_s[VS_BATCH_STEPS], t1_s[VS_BATCH_STEPS]; /* their beginnings and ends */
  bool periodic[VS_BATCH_STEPS];                     /* as in vs_step */
  vs_pair term[VS_DECK_MOST][VS_BATCH_STEPS];        /* of each of the deck's terms, V or A */
} vs_batch;

/* Adds the pieces of a step of a tier with a circuit. There must be room for them. */
void vs_batch_take(vs_batch *batch, const vs_step *step);

/* Writes the formula's values in each step of the batch. They are those of
 * vs_formula_prepared_value to the bit. */
void vs_batch_evaluate(const vs_formula_prepared *formula, const vs_batch *batch,
                       vs_pair value[VS_BATCH_STEPS]);
