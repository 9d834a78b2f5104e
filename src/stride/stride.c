/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stride/stride.h"

#include <math.h>

/* The first step behind an edge, against the shorter one of the last two. Sub-pulses have two kinds
 * of edges, which may want steps of different lengths. A first step that is rejected costs ten of
 * Newton's iterations, as the junctions have to find their new state in each try. */
static const double GROWS = 1.1;

/* A try goes so far towards the length at which the solver is expected to find the error just
 * right. */
static const double CAREFUL = 0.9;

void vs_stride_begin(vs_stride *s) {
  *s = (vs_stride){.first_s = {INFINITY, INFINITY}};
}

double vs_stride_start(vs_stride *s, double proposed_s) {
  if (!s->first || isinf(s->first_s[0]) || isinf(s->first_s[1])) return proposed_s;
  double most_s = GROWS * fmin(s->first_s[0], s->first_s[1]);
  s->held = most_s < proposed_s;
  return fmin(most_s, proposed_s);
}

/* The solver's error of a capacitance's charge in a step h is c h^3 by the trapezoidal rule, and
 * what it allows is a share of the charge, e. It proposes sqrt(e/(c h)), but an h of (e/c)^(1/3) is
 * what meets e: that is (h proposed^2)^(1/3). Of order one it is sqrt(h proposed), and more.
 * Where Newton's iteration has failed it proposes an eighth, which is left as it is. */
double vs_stride_again(vs_stride *s, double tried_s, double proposed_s) {
  s->failed = true;
  if (!(proposed_s < tried_s) || 8 * proposed_s == tried_s) return proposed_s;
  return fmax(proposed_s, CAREFUL * cbrt(tried_s * proposed_s * proposed_s));
}

void vs_stride_done(vs_stride *s, double step_s, bool at_edge) {
  if (s->first) {
    s->first_s[1] = s->first_s[0];
    s->first_s[0] = s->failed || s->held ? step_s : INFINITY;
  }
  s->first = at_edge;
  s->failed = s->held = false;
}
