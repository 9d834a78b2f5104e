/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch/verdict.h"

#include <math.h>

/* What `room` to a limit is as a part of the limit; of the whole range where the limit is 0.
 * Infinite where there is no limit. */
static double part_of(double room, double limit, const vs_rating *rating) {
  double range = rating->max - rating->min;
  if (isinf(limit)) return INFINITY;
  return room / (limit != 0 ? fabs(limit) : isinf(range) ? 1 : range);
}

size_t vs_verdict(const vs_measures *m, vs_judgement judgements[VS_DECK_MOST]) {
  const vs_deck *deck = m->frame->deck;
  size_t count = deck ? deck->n_ratings : 0;
  for (size_t k = 0; k < count; k++) {
    const vs_rating *r = &deck->ratings[k];
    const vs_extreme *pair = &m->extremes[VS_STANDARD_EXTREMES + 2 * r->probe];
    vs_judgement *j = &judgements[k];
    *j = (vs_judgement){r, &deck->probes[r->probe], pair[0].best, pair[1].best, 0, pair[0].best};
    double below = part_of(j->least.value - r->min, r->min, r);
    double above = part_of(r->max - j->largest.value, r->max, r);
    j->margin = fmin(below, above);
    if (above < below) j->stress = j->largest;
  }
  return count;
}
