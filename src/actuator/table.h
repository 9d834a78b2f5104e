/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law of a file: flux linkage over gap and current as a table, from a field solver or measured
 * (tables/grid.h). Its column of forces, if it has one, is compared only, in size. */
#ifndef VS_ACTUATOR_TABLE_H
#define VS_ACTUATOR_TABLE_H

#include "actuator/law.h"

extern const vs_law vs_table_law;

#endif
