/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law of a file: flux linkage over gap and current as a table, from a field solver or measured
 * (plant/grid.h). Its column of forces, if it has one, is compared only, in size. */
#ifndef VS_PLANT_TABLE_H
#define VS_PLANT_TABLE_H

#include "plant/law.h"

extern const vs_law vs_table_law;

#endif
