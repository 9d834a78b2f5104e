/* SPDX-License-Identifier: GPL-3.0-or-later
 * Sums over the coordinates of a machine of any size, by blocks of VS_ROWS rows and columns. */
#pragma once

#include "plant/model.h"

/* Rows and columns are taken so many at a time, side by side, in half the time of one after the
 * other. Behind a matrix's last row its columns hold zeros. What is computed often has code of its
 * own for a machine that is just one block, where the compiler leaves no loop. */
enum { VS_ROWS = 4 };
_Static_assert(VS_MOST_DOF % VS_ROWS == 0, "columns are filled up with zeros");

/* What vs_mechanics_accelerations (plant/mechanics.h) gives, for any number of coordinates. */
void vs_block_accelerations(const vs_model *model, const double *q, const double *v, double force_n,
                            double acceleration[VS_MOST_DOF]);
