/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the command `serve` tells of a scene, for others who tell it too. */
#pragma once

#include "run/scene.h"

/* Adds the description of a scene, lines of cells with tabs between (vibrospice/protocol.h):
 *   c name quantity unit role of       a column, in order
 *   i name unit least largest value text   an input, in order
 *   0 value ...                        the columns at t = 0; NaN: not known before the run
 *   u until                            the run's end */
void vs_serve_describe(const vs_scene *scene, vs_text *text);
