/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/blocks.h"

#include <string.h>

/* Takes VS_ROWS columns from j on off as many rows of a sum. */
static inline void take_block(const vs_model *m, int first, int j, const double *q, const double *v,
                              double *restrict sum) {
  const double(*k)[VS_MOST_DOF] = m->mk_column + j, (*b)[VS_MOST_DOF] = m->mb_column + j;
  for (int i = 0; i < VS_ROWS; i++) {
    int row = first + i;
    sum[i] = sum[i] - (k[0][row] * q[0] + b[0][row] * v[0]) -
             (k[1][row] * q[1] + b[1][row] * v[1]) - (k[2][row] * q[2] + b[2][row] * v[2]) -
             (k[3][row] * q[3] + b[3][row] * v[3]);
  }
}

void vs_block_accelerations(const vs_model *m, const double *q, const double *v, double force_n,
                            double acceleration[VS_MOST_DOF]) {
  for (int first = 0; first < m->dof; first += VS_ROWS) {
    double sum[VS_ROWS];
    int j = 0;
    for (int i = 0; i < VS_ROWS; i++) sum[i] = m->mf[first + i] * force_n;
    for (; j + VS_ROWS <= m->dof; j += VS_ROWS) take_block(m, first, j, q + j, v + j, sum);
    for (; j < m->dof; j++)
      for (int i = 0; i < VS_ROWS; i++)
        sum[i] -= m->mk_column[j][first + i] * q[j] + m->mb_column[j][first + i] * v[j];
    for (int i = 0; m->loaded && i < VS_ROWS; i++) sum[i] += m->m0[first + i];
    memcpy(acceleration + first, sum, sizeof sum);
  }
}
