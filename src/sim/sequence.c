/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/sequence.h"

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

bool vs_sequence_agrees(const vs_sequence *one, const vs_sequence *other, double window_s,
                        vs_sequence_difference *d) {
  for (int k = 0; k < VS_DEEDS; k++) {
    if (one->count[k] == other->count[k]) continue;
    say_count(d->one, WORDS[k], one->count[k]);
    say_count(d->other, "", other->count[k]);
    return false;
  }
  for (size_t k = 0; k < one->kept && k < other->kept; k++) {
    double a_s = one->item[k].at_s, b_s = other->item[k].at_s;
    if (one->item[k].deed == other->item[k].deed && !(fabs(a_s - b_s) > window_s)) continue;
    snprintf(d->one, sizeof d->one, "%s at %.6g s", WORDS[one->item[k].deed], a_s);
    snprintf(d->other, sizeof d->other, "%s at %.6g s", WORDS[other->item[k].deed], b_s);
    return false;
  }
  return true;
}
