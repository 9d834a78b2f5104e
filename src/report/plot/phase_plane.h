/* SPDX-License-Identifier: GPL-3.0-or-later
 * Orbits: a coordinate and its rate over one another, for each coordinate among the probes. */
#ifndef VS_REPORT_PHASE_PLANE_H
#define VS_REPORT_PHASE_PLANE_H

#include "base/error.h"
#include "plot/stretch.h"

/* Adds the orbits to a script for gnuplot. Error, VS_INPUT: a run has no column of a probe's rate.
 */
vs_status vs_phase_plane_add(const vs_stretch *stretch, vs_script *script, vs_error *err);

#endif
