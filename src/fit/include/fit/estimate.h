/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a minimum of chi2 tells of the unknowns: standard errors, correlations, and which
 * combinations of unknowns the data know well or hardly at all.
 *
 * With J = d residual/d s at the minimum, the covariance of s is (J^T J)^-1. In J = U S V^T each
 * column v of V is a combination sum v_k s_k that is known to 1/S. Where all s are logarithms the
 * combination is a product of powers, prod x_k^v_k, which is known to that share.
 *
 * An unknown on a bound has no standard error. It counts as held: the errors of the others are
 * those that they have while it stays there. */
#pragma once

#include "fit/minimizations.h"

/* A combination of unknowns with round numbers for exponents, scaled to a largest one of 1. */
typedef struct vs_combination {
  double singular; /* of the direction that it stands for; 0: it stands for a pair */
  double exact[VS_INQUIRY_UNKNOWNS];    /* that direction */
  double exponent[VS_INQUIRY_UNKNOWNS]; /* the round ones */
  double error;                         /* standard error of sum exponent_k s_k */
  bool product;                         /* all s in it are logarithms: it is a product of powers */
  char text[1024];                      /* "machine.trough_mass^0.5 * machine.spring_stiffness" */
} vs_combination;

typedef struct vs_estimate {
  const vs_fit_problem *inquiry;
  vs_minimization minimum;
  size_t n;                          /* unknowns */
  double value[VS_INQUIRY_UNKNOWNS]; /* in the unit of the key */
  double error[VS_INQUIRY_UNKNOWNS]; /* standard error of s; NaN: on a bound */
  double least[VS_INQUIRY_UNKNOWNS], most[VS_INQUIRY_UNKNOWNS]; /* 95 % interval, as value */
  double covariance[VS_INQUIRY_UNKNOWNS][VS_INQUIRY_UNKNOWNS];  /* of s; 0 on a bound */
  double *computed, *residual;                                  /* [n_data], [n_residuals]; owned */
  long freedom;       /* residuals less unknowns that are not on a bound */
  bool unstable;      /* an orbit is, of the runs that are a period of one */
  double probability; /* that a true model has a chi2 as large; NaN: freedom is 0 */
  vs_combination directions[VS_INQUIRY_UNKNOWNS]; /* from the best known to the least known */
  size_t n_directions;
  vs_combination *pairs; /* of two, which are known far better than either alone; owned */
  size_t n_pairs;
} vs_estimate;

/* The width of a 95 % interval in standard errors. */
#define VS_ESTIMATE_95 1.959963984540054

/* Finds all of it at a minimum. Errors: VS_RUN, the runs fail; VS_INPUT, the data do not carry so
 * many unknowns; the message names the combination that they do not know. vs_estimate_free even
 * then. */
vs_status vs_estimate_at(vs_minimizer *descender, const vs_minimization *minimum,
                         vs_estimate *estimate, vs_error *err);
void vs_estimate_free(vs_estimate *estimate);

/* False: a true model has a chi2 as large as this in less than one case of a thousand. */
bool vs_estimate_fits(const vs_estimate *estimate);

/* The correlation of two unknowns; NaN where one is on a bound. */
double vs_estimate_correlation(const vs_estimate *estimate, size_t i, size_t k);
