/* SPDX-License-Identifier: GPL-3.0-or-later
 * A formula of the deck over all steps of a batch. */
#ifndef VS_ENGINE_SWEEP_H
#define VS_ENGINE_SWEEP_H

#include "engine/batch.h"

/* Writes the formula's values in each step of the batch. They are those of vs_formula_quick_value
 * to the bit. */
void vs_sweep(const vs_formula_quick *formula, const vs_batch *batch,
              vs_pair value[VS_BATCH_STEPS]);

#endif
