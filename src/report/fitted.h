/* SPDX-License-Identifier: GPL-3.0-or-later
 * What `fit` prints. */
#ifndef VS_REPORT_FITTED_H
#define VS_REPORT_FITTED_H

#include <stdio.h>

#include "fit/outcome.h"

/* Prints the table. */
void vs_fitted_show(const vs_outcome *outcome, FILE *out);

/* Calls each(ctx, text) with every warning: the model does not fit, or far too
 * well, an unknown is on its bound,
 * residuals have a pattern, columns were not used. */
void vs_fitted_warnings(const vs_outcome *outcome, void (*each)(void *ctx, const char *text),
                        void *ctx);

#endif
