/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the model says in the place of each datum, and how far off that is. */
#pragma once

#include "fit/fit_problem.h"

typedef struct vs_prediction {
  const vs_fit_problem *inquiry; /* borrowed; its scenes are altered */
  vs_budget budget;              /* of its runs and of their searches for orbits, behind
                                    vs_prediction_limit */
  size_t n_unknowns, n_residuals;
  long runs;       /* how often a scene was run so far */
  long failures;   /* how many of these failed */
  long inexact;    /* how often an exact slope was asked for and told by differences */
  vs_error failed; /* how the last one of them did */
  bool rough;    /* one of the runs does not change smoothly with its scene: it has a circuit, whose
                    steps are not the same for all values, or a control that reads an A/D */
  bool unstable; /* the last run of all, or of one, was a period of an orbit that no machine stays
                    on */
} vs_prediction;

/* The inquiry must outlive it. */
vs_prediction vs_prediction_of(const vs_fit_problem *inquiry);

/* Gives the scenes' orders a budget, with which each of the inquiry's scenes can be run about so
 * often. The prediction must stay where it is until vs_prediction_unlimit. */
void vs_prediction_limit(vs_prediction *prediction, double often);
void vs_prediction_unlimit(vs_prediction *prediction);
/* True if that budget is spent: from then on every run fails. */
bool vs_prediction_spent(const vs_prediction *prediction);

/* Puts the values s[n_unknowns] into the scene number `run`, without a run of it. Error: it cannot
 * be read. */
vs_status vs_prediction_settle(const vs_prediction *prediction, int run, const double *s,
                               vs_error *err);

/* Runs the scene number `run`, or all where run < 0, with the values s[n_unknowns] and fills its
 * part of computed[n_data], SI. Error, also kept in `failed`: a run cannot be read or fails, or has
 * no such measure. */
vs_status vs_prediction_run(vs_prediction *prediction, int run, const double *s, double *computed,
                            vs_error *err);

/* d residual/d computed, for slopes. */
double vs_prediction_weight(const vs_fit_problem *inquiry, const vs_datum *datum, double computed);

/* Fills residual[n_residuals] by computed[n_data] and, for the priors, by s. A residual is NaN
 * where a logarithm is asked for of numbers of unlike signs. */
void vs_prediction_residuals(const vs_prediction *prediction, const double *s,
                             const double *computed, double *residual);

/* Error, with its place, where a logarithm is asked for of numbers of unlike signs. */
vs_status vs_prediction_check_signs(const vs_prediction *prediction, const double *computed,
                                    vs_error *err);
