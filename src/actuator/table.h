/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law of a file: flux linkage over gap and current as a table, from a field solver or measured. The
 * file is CSV with the columns z_m, i_a, lambda_wb and, to be compared, force_n; other prefixes of
 * the units are taken (z_mm, i_ma). Its gaps and currents form a grid: every gap has the same
 * currents, from 0 on. The force's sign is not looked at. */
#ifndef VS_ACTUATOR_TABLE_H
#define VS_ACTUATOR_TABLE_H

#include "actuator/law.h"

extern const vs_law vs_table_law;

#endif
