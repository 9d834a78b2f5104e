/* SPDX-License-Identifier: GPL-3.0-or-later
 * The picture of a fit: data, fit, residuals. */
#ifndef VS_REPORT_PORTRAIT_H
#define VS_REPORT_PORTRAIT_H

#include "fit/outcome.h"

/* Draws, for each column that was recorded, what was measured with what the fit says over it, and
 * under it the residuals over the time; for the measures of a run, fitted over measured, each with
 * its standard error. name: of the picture, which ends in .png or .svg. Errors: gnuplot is missing
 * or fails; the file cannot be written. */
vs_status vs_portrait_draw(const vs_outcome *outcome, const char *folder, const char *name,
                           vs_error *err);

#endif
