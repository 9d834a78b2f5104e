/* SPDX-License-Identifier: GPL-3.0-or-later
 * All reductions: one plug for each vs_reduction that the deck's kinds name. */
#ifndef VS_STRESS_REDUCTIONS_H
#define VS_STRESS_REDUCTIONS_H

#include "stress/reducer.h"

/* The plugs, by vs_reduction. */
extern const vs_reducer *const vs_reductions_all[VS_REDUCTIONS];

/* The mean of a course over the run, where it is judged as means are. Returns why it is not, as
 * "not judged: one shot"; NULL: it is. */
const char *vs_reductions_mean(const vs_watched *w, int of, const vs_run_end *end, double *level);
/* True where the run is all that there is: the scene fires the device once, or fires once a device
 * of which no gate is known and that began to conduct once at most. It has no time to warm. */
bool vs_reductions_is_over(const vs_watched *w);

#endif
