/* SPDX-License-Identifier: GPL-3.0-or-later
 * The picture of a run's harmonics: bars for the mains current of `steady` and for the currents
 * that a scene names under `quality`, and marks for the limits of IEC 61000-3-2. */
#pragma once

#include <stdbool.h>

#include "base/error.h"

/* Draws harmonics.png and harmonics.svg from the folder's summary.json; draws nothing if that file
 * is missing or has no current. Errors: it cannot be read; gnuplot is missing or fails. */
vs_status vs_harmonics_draw(const char *folder, bool quiet, vs_error *err);
