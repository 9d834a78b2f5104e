/* SPDX-License-Identifier: GPL-3.0-or-later
 * Probes over time, one strip each, with vertical lines where something happened. */
#pragma once

#include "plot/time_window.h"

/* Adds the strips to a gnuplot script. Moments of the first run have their text beside their lines,
 * while there is room; those of the other runs have lines in their colour. */
void vs_strips_add(const vs_time_window *stretch, vs_script *script);

/* Adds one probe's strip alone, as a picture of its own. */
void vs_strips_one(const vs_time_window *stretch, int probe, vs_script *script);

/* The unit of the time axis, "ms" or "s". */
const char *vs_strips_time_unit(const vs_time_window *stretch);
