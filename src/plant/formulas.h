/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law "formula": current, energy and force from the formulas of a machine's file. The file writes
 * the force as -dW/dz at fixed lambda, which is negative where it closes the gap; the program's
 * force is +dW/dz.
 *
 * One of current and energy must be there. What is missing follows: the current is dW/dlambda, the
 * force -dW/dz, each as a formula; without a formula for the energy it is the integral of the
 * current over lambda, and the force without one the integral of di/dz. */
#ifndef VS_PLANT_FORMULAS_H
#define VS_PLANT_FORMULAS_H

#include "plant/law.h"

extern const vs_law vs_formulas_law;

#endif
