/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a fitted scene is run by itself. */
#ifndef VS_REPORT_RERUN_H
#define VS_REPORT_RERUN_H

#include "fit/outcome.h"

/* Prints, for each run of a fit, the command that runs its scene with the estimates: with what the
 * fit set over the scene, and the unknowns, to seven digits. */
void vs_rerun_show(const vs_outcome *outcome, FILE *out);

#endif
