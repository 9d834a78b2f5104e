/* SPDX-License-Identifier: GPL-3.0-or-later
 * Whether a mean or rms value of a run is one of operation, over which stretch it then is, and what
 * stands in the way where it is not. */
#pragma once

#include "measure/reducer.h"

/* Holds the measure, whose value over the run is known, to its limit, up to end_s: fills judged,
 * doubt and failed_s, or unjudged, and then leaves the limit. */
void vs_means_judge(const vs_watched *w, vs_reduced *r, double end_s);
/* Where the stretch begins over which the measure would be judged, whatever its limit. */
double vs_means_from_s(const vs_watched *w, const vs_reduced *r, const vs_run_end *end);
/* The mean of a course over the run, where it is judged as means are. Returns why it is not, as
 * "not judged: one shot"; NULL: it is. */
const char *vs_means_of(const vs_watched *w, int of, const vs_run_end *end, double *level);
/* True where the run is all that there is: the scene fires the device once, or fires once a device
 * of which no gate is known and that began to conduct once at most. It has no time to warm. */
bool vs_means_is_over(const vs_watched *w);
