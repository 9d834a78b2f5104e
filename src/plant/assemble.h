/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a machine's formulas become M, B, K, f0 and c. */
#ifndef VS_PLANT_ASSEMBLE_H
#define VS_PLANT_ASSEMBLE_H

#include "plant/model.h"

/* Fills the model's matrices and vectors from the machine's formulas with the model's parameters
 * and load, and binds the formulas of the probes and of the law. Errors with their place in the
 * machine's file: a value that is not finite; an M or a K that is not symmetric or not positive
 * definite (a coordinate without any spring aside); a gap that no coordinate opens. */
vs_status vs_assemble_model(vs_machine *machine, vs_model *model, vs_error *err);

#endif
