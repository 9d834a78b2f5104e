/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/likelihood.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_STEPS = 24 };
/* How close to the rise of chi2 an end is found, as a share of its root, and how much lower than
 * the estimate's a chi2 must be to be another minimum's. */
static const double CLOSE = 1e-4, LOWER = 1e-3;

/* One side of a profile. */
typedef struct side {
  vs_descender *d;
  const vs_estimate *e;
  vs_likelihood *profile;
  size_t k;
  double near_s[VS_INQUIRY_UNKNOWNS]; /* the last point's unknowns, from which the next search
                                         starts */
} side;

/* The root of the rise of chi2 where the unknown is held at s; NaN: the search fails. */
static double rise(side *w, double s) {
  vs_descent found;
  double start[VS_INQUIRY_UNKNOWNS];
  memcpy(start, w->near_s, sizeof start);
  start[w->k] = s;
  vs_descent_from(w->d, start, &found);
  if (!found.converged) return NAN;
  memcpy(w->near_s, found.s, sizeof w->near_s);
  vs_likelihood *p = w->profile;
  double more = found.chi2 - w->e->minimum.chi2;
  if (p->count < VS_LIKELIHOOD_POINTS) p->point[p->count++] = (vs_likelihood_point){s, found.chi2};
  if (more < -LOWER * fmax(1, w->e->minimum.chi2)) p->lower_minimum = true;
  return sqrt(fmax(more, 0));
}

/* Goes from the estimate in steps until chi2 has risen by enough, then closes in: the root of the
 * rise is nearly straight over s. Returns s of the end; NaN: it is open. */
static double find_end(side *w, double sign, double bound) {
  const double wanted = sqrt(gsl_cdf_chisq_Pinv(0.95, 1));
  double centre = w->e->minimum.s[w->k], error = w->e->error[w->k];
  double step = isnan(error) ? 0.05 : wanted * error;
  double inner = 0, inner_rise = 0, outer = NAN, outer_rise = NAN, most = fabs(bound - centre);
  memcpy(w->near_s, w->e->minimum.s, sizeof w->near_s);
  for (int n = 0; n < MOST_STEPS; n++) {
    double part = n % 4 == 3 ? 0.5 : (wanted - inner_rise) / (outer_rise - inner_rise);
    double way = isnan(outer) ? fmin(inner + step, most) : inner + (outer - inner) * part;
    double r = rise(w, centre + sign * way);
    if (isnan(r)) return NAN;
    if (fabs(r - wanted) < CLOSE * wanted) return centre + sign * way;
    if (r > wanted)
      outer = way, outer_rise = r;
    else if (way >= most)
      return NAN;
    else
      inner = way, inner_rise = r;
    if (isnan(outer) && n) step *= 1.5;
  }
  return NAN;
}

static int by_s(const void *a, const void *b) {
  const vs_likelihood_point *x = a, *y = b;
  return (x->s > y->s) - (x->s < y->s);
}

void vs_likelihood_of(vs_descender *d, const vs_estimate *e, size_t k, vs_likelihood *p) {
  const vs_unknown *u = &e->inquiry->unknowns[k];
  side w = {.d = d, .e = e, .profile = p, .k = k};
  *p = (vs_likelihood){.unknown = k, .count = 1, .point = {{e->minimum.s[k], e->minimum.chi2}}};
  bool held = d->held[k];
  d->held[k] = true;
  p->least = vs_unknown_value(u, find_end(&w, -1, vs_unknown_least(u)));
  p->most = vs_unknown_value(u, find_end(&w, 1, vs_unknown_most(u)));
  d->held[k] = held;
  qsort(p->point, p->count, sizeof *p->point, by_s);
}
