/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine's free modes as a basis of its states: any state is a sum of modes, and each mode
 * goes its own way. The test whether the circuit's solver may be left (oneport_macromodel.c) splits
 * errors into modes, as an error in a mode that hardly decays stays to the end of the run. */
#pragma once

#include <gsl/gsl_matrix_complex_double.h>
#include <gsl/gsl_permutation.h>

#include "plant/mechanics.h"

/* Begins with vs_modal_begin and ends with vs_modal_end, also where that returned false. Others
 * read `mode` alone. */
typedef struct vs_modal {
  vs_mode mode[VS_MOST_STATES]; /* shapes are scaled to a largest component of 1 m or 1 rad */
  gsl_matrix_complex *vectors;  /* columns (shape, s shape), LU-decomposed */
  gsl_permutation *order;
  gsl_vector_complex *share; /* room for the solution of vs_modal_shares */
} vs_modal;

/* Finds the modes of a machine. Returns false where GSL finds none, or where two are alike, so that
 * they are no basis. */
bool vs_modal_begin(vs_modal *modal, const vs_model *model);
void vs_modal_end(vs_modal *modal);

/* Gives the size of each mode's share in a state x = (q, q'), in units of the mode's shape. Needs
 * the room in *modal, and overwrites it. */
void vs_modal_shares(const vs_modal *modal, const double x[VS_MOST_STATES],
                     double share[VS_MOST_STATES]);
