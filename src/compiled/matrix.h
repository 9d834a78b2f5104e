/* SPDX-License-Identifier: GPL-3.0-or-later
 * A sparse matrix of fixed pattern, and its LU factors in an order of pivots that is found once:
 * Markowitz', among the pivots that are not small beside their row and column. Factors and
 * solutions are lists of operations that a loop goes through. */
#pragma once

#include <stdbool.h>

enum { VS_MATRIX_MOST = 1000 }; /* rows */

/* Numbers that a loop goes along. */
typedef struct vs_matrix_list {
  int *at; /* owned */
  int count;
} vs_matrix_list;

typedef struct vs_matrix {
  int n;
  int *place; /* n x n: where the value of a row and column is; -1: it is 0. Owned */
  int count;  /* values of the pattern, before fill-in */
  int filled; /* with fill-in */
  vs_matrix_list eliminate, forward, back; /* what they say stands in matrix.c */
  int *row, *column;                       /* of each pivot; owned */
} vs_matrix;

/* Begins an empty pattern of n rows. */
void vs_matrix_begin(vs_matrix *m, int n);
/* Where the value of a row and column stands; adds it to the pattern. */
int vs_matrix_place(vs_matrix *m, int row, int column);

/* Finds the pivots for these values, of which there are m->count. False: the matrix is singular,
 * and *culprit is a column without a pivot. */
bool vs_matrix_order(vs_matrix *m, const double *values, int *culprit);

/* Factors values, which has room for m->filled of them, in place. False: a pivot is small by now,
 * and the matrix wants another order. */
bool vs_matrix_factor(const vs_matrix *m, double *values);
/* Solves with the factors: x from b, which is used up. */
void vs_matrix_solve(const vs_matrix *m, const double *restrict factors, double *restrict b,
                     double *restrict x);

/* The same for as many right sides as `count`, with those of a row beside each other. */
void vs_matrix_solve_many(const vs_matrix *m, const double *factors, int count, double *b,
                          double *x);

void vs_matrix_free(vs_matrix *m);
