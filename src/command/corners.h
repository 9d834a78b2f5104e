/* SPDX-License-Identifier: GPL-3.0-or-later
 * The corners of a scene: runs at all ends of what its key `spread` says is not known exactly, and
 * the worst line of each one's verdict. */
#ifndef VS_COMMAND_CORNERS_H
#define VS_COMMAND_CORNERS_H

#include "command/run.h"

/* Runs them, one behind the other, each with a second run for the errors of its margins. Nothing is
 * written or printed but progress. Errors: those of the scene's reading and of its runs, which name
 * the corner; VS_SIGNAL. */
vs_status vs_corners_run(const vs_run_options *options, const vs_scene *nominal,
                         vs_corners *corners, vs_error *err);

#endif
