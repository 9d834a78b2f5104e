/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/batch.h"

void vs_batch_take(vs_batch *b, const vs_step *step) {
  const double *from = step->from->terms, *to = step->to->terms;
  size_t n = b->count++;
  b->t0_s[n] = step->from->t_s;
  b->t1_s[n] = step->to->t_s;
  b->periodic[n] = step->periodic;
  for (size_t t = 0; t < step->frame->deck->n_terms; t++)
    b->term[t][n] = (vs_pair){(from[t] + to[t]) / 2, to[t]};
}
