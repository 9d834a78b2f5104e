/* SPDX-License-Identifier: GPL-3.0-or-later
 * Numbers of a part's file that no device of its kind has, each named with its line. */
#ifndef VS_BENCH_PLAUSIBILITY_H
#define VS_BENCH_PLAUSIBILITY_H

#include "figures.h"
#include "run/warnings.h"

/* Adds a warning for each implausible number: of the file's limits, parameters and thermal
 * impedance, and of what was measured. Says nothing of a part without any limit, which is ideal. */
void vs_plausibility_warn(const vs_stand *stand, const vs_figures *figures, vs_warnings *warnings);

#endif
