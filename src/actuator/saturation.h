/* SPDX-License-Identifier: GPL-3.0-or-later
 * Iron that saturates, beside the plain reluctance of the gap. With r = |lambda|/lambda_s:
 *
 *   series          i = lambda z/(2a) + I_s sign(lambda) r^n       F = lambda^2/(4a)
 *                   W = lambda^2 z/(4a) + I_s lambda_s/(n+1) r^(n+1)
 *   multiplicative  i = lambda z/(2a) (1 + r^n)                    F = W/z
 *                   W = z/(2a) lambda^2 (1/2 + r^n/(n+2)) */
#ifndef VS_ACTUATOR_SATURATION_H
#define VS_ACTUATOR_SATURATION_H

#include "actuator/law.h"

struct vs_saturation_values;

/* Gives a coil of the plain law the law with saturation. coil->a_hm stays the gap's number. */
void vs_saturation_add(vs_coil *coil, const struct vs_saturation_values *values);

#endif
