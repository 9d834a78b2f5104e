/* SPDX-License-Identifier: GPL-3.0-or-later
 * Pole placement: the gain K with which the eigenvalues ("poles") of A - B K are those wanted. With
 * more than one column in B there are many such gains; taken is one whose eigenvectors are nearly
 * as far apart as they can be, so that the poles move least by what the model does not know
 * (J. Kautsky, N. K. Nichols, P. Van Dooren, 1985). */
#pragma once

#include <gsl/gsl_complex.h>
#include <gsl/gsl_matrix.h>
#include <stdbool.h>

/* Fills k (m x n) from a (n x n), b (n x m, m < n, with independent columns) and n poles. Complex
 * ones stand in pairs, one after the other, that with the positive imaginary part first; none
 * stands more than m times. All of A is to be of one order of magnitude, and so are the columns of
 * B. Returns false where the eigenvectors that are found do not span the states. */
bool vs_pole_placement(const gsl_matrix *a, const gsl_matrix *b, const gsl_complex *poles,
                       gsl_matrix *k);

/* How far an eigenvalue of A is from one that B cannot move: the least singular value of
 * [A - s I, B]. 0: no gain moves it. */
double vs_pole_placement_reach(const gsl_matrix *a, const gsl_matrix *b, gsl_complex s);

/* How nearly the columns of B depend on each other: the least of its singular values over the
 * largest. */
double vs_pole_placement_independence(const gsl_matrix *b);
