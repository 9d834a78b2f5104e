/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the command `fit` prints. */
#pragma once

#include <stdio.h>

#include "fit/fit_result.h"

/* Prints the table. */
void vs_fit_printout_show(const vs_fit_result *outcome, FILE *out);

/* Error, VS_RATING: the model does not fit; the message says by how much. */
vs_status vs_fit_printout_judge(const vs_fit_result *outcome, vs_error *err);

/* Calls each(ctx, text) with every warning: the model fits better than the stated errors allow, an
 * unknown is on its bound, residuals have a pattern, columns were not used. */
void vs_fit_printout_warnings(const vs_fit_result *outcome,
                              void (*each)(void *ctx, const char *text), void *ctx);
