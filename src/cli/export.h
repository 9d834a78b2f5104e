/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `export`: the scene on its circuit tier as one netlist for plain ngspice. */
#pragma once

#include <stddef.h>

#include "base/error.h"

/* Writes the scene to the file `output`. The netlist is the deck's, with its external sources
 * replaced by ones that follow the supply and the firing, the machine as capacitors and B sources,
 * the analysis, and commands that measure and write a table. scene: as for vs_scene_read. sets:
 * KEY=VALUE of each --set. Errors: everything a scene can be wrong in; VS_INPUT, the deck uses the
 * export's own names, or firing.burst_frequency does not fit into the firing's period; the file
 * cannot be written. For tests. */
vs_status vs_export_command(const char *scene, char *const *sets, size_t n_sets, const char *output,
                            vs_error *err);
