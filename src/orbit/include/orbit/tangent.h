/* SPDX-License-Identifier: GPL-3.0-or-later
 * Derivatives of the measures of a run on an ideal tier, exact but for the rounding of their
 * integration. The run's own derivative Y = dy/dp goes through every firing, extinction and stop
 * (orbit/variation.h). Its neighbours are the motions
 *   y + p Y   with every instant t_e moved to t_e + p dt_e/dp,
 * to first order the runs with other values of the key, for small p. They are shown to the same
 * watchers as the run is; so every measure there is has its derivative, whatever it is made of.
 *
 * The neighbours' p are so small that what is left out, of second order and higher, is below
 * rounding after a difference of sixth order. Between two instants all knots move along in
 * proportion. */
#pragma once

#include "orbit/stencil.h"

/* Begins the fan and fills it with the neighbours of the subject's run. known: as for
 * vs_parameter_begin. again: another attempt,
 * with other knots and smaller p, where a measure was not resolved by the first. vs_stencil_end
 * only after VS_OK. Errors: those of vs_stencil_begin and of the run; VS_RUN, the run has no
 * derivative: the orbit turns back here, a firing comes or goes, or the armature touches its stop
 * without a speed.
 */
vs_status vs_tangent_find(vs_stencil *fan, const vs_sensitivity_problem *subject,
                          const vs_asked *key, const vs_parameter *known, bool again,
                          vs_error *err);
