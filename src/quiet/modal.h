/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine's free modes as a basis: any small change of its state is a sum of them, and each
 * then goes its own way. The test whether the circuit's solver may be left (quiet.h) needs this, as
 * an error in a mode that hardly decays stays to the end of the run. */
#ifndef VS_QUIET_MODAL_H
#define VS_QUIET_MODAL_H

#include <gsl/gsl_matrix_complex_double.h>
#include <gsl/gsl_permutation.h>

#include "machine/mechanics.h"

/* Start with vs_modal_begin, and end with vs_modal_end in any case. Only `mode` is to be read. */
typedef struct vs_modal {
  vs_mode mode[VS_STATES];     /* shapes are scaled to a largest component of 1 m or 1 rad */
  gsl_matrix_complex *vectors; /* columns (shape, s shape), LU-decomposed */
  gsl_permutation *order;
  gsl_vector_complex *share; /* room for one solution */
} vs_modal;

/* Finds the modes of a machine. Returns false where GSL finds none, or where they are no basis. */
bool vs_modal_begin(vs_modal *modal, const vs_model *model);
void vs_modal_end(vs_modal *modal);

/* Sizes of the modes' shares in a state x = (q, q'), in units of their shapes. Overwrites the room
 * for one solution in *modal. */
void vs_modal_shares(const vs_modal *modal, const double x[VS_STATES], double share[VS_STATES]);

#endif
