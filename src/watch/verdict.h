/* SPDX-License-Identifier: GPL-3.0-or-later
 * The deck's ratings held against what its probes did in a run. */
#ifndef VS_WATCH_VERDICT_H
#define VS_WATCH_VERDICT_H

#include "watch/measures.h"

typedef struct vs_judgement {
  const vs_rating *rating;
  const vs_probe *probe;
  vs_value least, largest; /* of the probe in the run */
  double margin;   /* what is left to the nearer limit, as a part of that limit; < 0: beyond */
  vs_value stress; /* the extreme that is nearer to its limit, or further beyond */
} vs_judgement;

/* Judges all ratings of the run's deck; none on a tier without one. Gives their number. */
size_t vs_verdict(const vs_measures *measures, vs_judgement judgements[VS_DECK_MOST]);

#endif
