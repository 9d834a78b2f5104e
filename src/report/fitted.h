/* SPDX-License-Identifier: GPL-3.0-or-later
 * What `fit` prints. */
#ifndef VS_REPORT_FITTED_H
#define VS_REPORT_FITTED_H

#include <stdio.h>

#include "fit/outcome.h"

/* Prints the table. */
void vs_fitted_show(const vs_outcome *outcome, FILE *out);

/* Error, VS_RATING: the model does not fit; the text says by how much. */
vs_status vs_fitted_judge(const vs_outcome *outcome, vs_error *err);

/* Calls each(ctx, text) with every warning: the model fits far too well, an unknown is on its
 * bound, residuals have a pattern, columns were not used. */
void vs_fitted_warnings(const vs_outcome *outcome, void (*each)(void *ctx, const char *text),
                        void *ctx);

#endif
