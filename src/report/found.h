/* SPDX-License-Identifier: GPL-3.0-or-later
 * What `fit` writes for programs: fit.json, residuals.csv and profile.csv. */
#ifndef VS_REPORT_FOUND_H
#define VS_REPORT_FOUND_H

#include <stdio.h>

#include "fit/outcome.h"

/* Adds the JSON of a fit, with a line end. */
void vs_found_json(const vs_outcome *outcome, vs_text *text);

/* Writes residuals.csv: run, name, unit, t_s, measured, computed, error, residual; SI. Measures,
 * which belong to no instant, have no t_s. */
void vs_found_residuals(const vs_outcome *outcome, int digits, FILE *out);

/* Writes profile.csv: unknown, unit, value, chi2. */
void vs_found_profiles(const vs_outcome *outcome, int digits, FILE *out);

#endif
