/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law "reluctance": the gap alone holds the field. i = lambda z/(2a), F = lambda^2/(4a) (Eqs. 66-73
 * and 81). Iron that saturates may be added, with r = |lambda|/lambda_s:
 *
 *   series          i = lambda z/(2a) + I_s sign(lambda) r^n       F = lambda^2/(4a)
 *                   W = lambda^2 z/(4a) + I_s lambda_s/(n+1) r^(n+1)
 *   multiplicative  i = lambda z/(2a) (1 + r^n)                    F = W/z
 *                   W = z/(2a) lambda^2 (1/2 + r^n/(n+2))
 *
 * and leakage (plant/leakage.h). coil->a_hm is the gap's number in all of these. */
#ifndef VS_PLANT_RELUCTANCE_H
#define VS_PLANT_RELUCTANCE_H

#include "plant/law.h"

extern const vs_law vs_reluctance_law;

#endif
