/* SPDX-License-Identifier: GPL-3.0-or-later
 * A fan: a run of the scene as it is, and six with other values of one key, each reduced to its
 * measures; and what follows, the derivatives of the measures. The six may be runs of their own, or
 * what the derivatives of the one run make of it (orbit/tangent.h). */
#pragma once

#include "orbit/grazing.h"
#include "orbit/measured.h"
#include "orbit/parameter.h"
#include "orbit/sensitivity_problem.h"

enum { VS_STENCIL_RUNS = 1 + VS_PARAMETER_NEAR };

/* Begin with vs_stencil_begin, end with vs_stencil_end. */
typedef struct vs_stencil {
  vs_parameter parameter;                 /* which key, and by how much each run differs */
  vs_scene *scene[VS_STENCIL_RUNS];       /* that are run; owned, but for what they borrow */
  vs_measured *measured[VS_STENCIL_RUNS]; /* owned */
  vs_grazing grazing; /* of neighbours: how little makes a contact come or go; else 0 */
  double unresolved;  /* what each slope may be off by besides, relative to the measure */
} vs_stencil;

/* The derivative of one measure m. */
typedef struct vs_slope_of {
  bool known;   /* every run has the measure */
  double value; /* m of the scene as it is, in its unit */
  double slope; /* dm/dp, with p as in orbit/parameter.h */
  double error; /* of the slope, as far as the differences tell it */
  double bend;  /* by how much the slopes on either side differ; 0 but where m has a kink here */
} vs_slope_of;

/* Makes the scenes, whose p are `step` apart, and their setups at run.tolerance. known, errors:
 * those of vs_parameter_begin. */
vs_status vs_stencil_begin(vs_stencil *fan, const vs_sensitivity_problem *subject, const char *key,
                           vs_where where, double step, double tolerance, const vs_parameter *known,
                           vs_error *err);
void vs_stencil_end(vs_stencil *fan);

/* Runs them all at run.tolerance, each from its own start or on its own orbit. alike: on tier
 * compiled, with the steps of the first, so that differences of small steps are smooth. Errors:
 * those of vs_session_run and vs_steady_begin; VS_RUN, with `alike`: one needs other steps. */
vs_status vs_stencil_run(vs_stencil *fan, const vs_sensitivity_problem *subject, double tolerance,
                         bool alike, vs_error *err);

/* The derivative of the measure of that name. */
vs_slope_of vs_stencil_slope(const vs_stencil *fan, const char *measure);
