/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/sequence.h"

#include <math.h>
#include <stdio.h>

static const char *const WORDS[VS_DEEDS] = {[VS_DEED_FIRES] = "fires",
                                            [VS_DEED_GOES_OUT] = "goes out",
                                            [VS_DEED_MISFIRES] = "misfires",
                                            [VS_DEED_UNINTENDED] = "fires without a gate pulse",
                                            [VS_DEED_FAILS] = "fails to commutate",
                                            [VS_DEED_MELTS] = "melts",
                                            [VS_DEED_CLEARS] = "has cleared",
                                            [VS_DEED_ARCS_AGAIN] = "arcs again"};

void vs_sequence_add(vs_sequence *s, vs_deed deed, double at_s) {
  s->count[deed]++;
  if (s->kept == VS_SEQUENCE_KEPT) return;
  s->item[s->kept].at_s = at_s;
  s->item[s->kept++].deed = deed;
}

static void say_count(char text[VS_SEQUENCE_SAYS], const char *word, long count) {
  if (count == 1)
    snprintf(text, VS_SEQUENCE_SAYS, "%s%sonce", word, *word ? " " : "");
  else
    snprintf(text, VS_SEQUENCE_SAYS, "%s%s%ld times", word, *word ? " " : "", count);
}

/* How many deeds of the two are the same, from the first one on. */
static size_t common(const vs_sequence *one, const vs_sequence *other, double window_s) {
  size_t k = 0;
  while (k < one->kept && k < other->kept && one->item[k].deed == other->item[k].deed &&
         fabs(one->item[k].at_s - other->item[k].at_s) <= window_s)
    k++;
  return k;
}

/* When the sequences part, behind `same` deeds that are the same in both. Behind all that are kept
 * it is told early. */
static double parting(const vs_sequence *one, const vs_sequence *other, size_t same) {
  double a_s = same < one->kept ? one->item[same].at_s : INFINITY;
  double b_s = same < other->kept ? other->item[same].at_s : INFINITY;
  double last_s = same ? one->item[same - 1].at_s : -INFINITY;
  return isinf(a_s) && isinf(b_s) ? last_s : fmin(a_s, b_s);
}

bool vs_sequence_agrees(const vs_sequence *one, const vs_sequence *other, double window_s,
                        vs_sequence_difference *d) {
  size_t same = common(one, other, window_s);
  d->parts_s = parting(one, other, same);
  for (int k = 0; k < VS_DEEDS; k++) {
    if (one->count[k] == other->count[k]) continue;
    say_count(d->one, WORDS[k], one->count[k]);
    say_count(d->other, "", other->count[k]);
    return false;
  }
  if (same == one->kept) return true; /* as many are kept of the other */
  snprintf(d->one, sizeof d->one, "%s at %.6g s", WORDS[one->item[same].deed],
           one->item[same].at_s);
  snprintf(d->other, sizeof d->other, "%s at %.6g s", WORDS[other->item[same].deed],
           other->item[same].at_s);
  return false;
}
