/* SPDX-License-Identifier: GPL-3.0-or-later
 * Flux that links the coil and not the gap. With the inner law's i(lambda_g, z), W_g and F_g:
 *
 *   lambda = lambda_g + L_k i(lambda_g, z),  W = W_g + L_k i^2/2,  F = F_g(lambda_g, z)
 */
#ifndef VS_PLANT_LEAKAGE_H
#define VS_PLANT_LEAKAGE_H

#include "plant/law.h"

/* Gives a coil, whose law is built, this leakage inductance. The current of its law must grow with
 * lambda and be 0 where lambda is 0. */
void vs_leakage_add(vs_coil *coil, double leakage_h);

#endif
