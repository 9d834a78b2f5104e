/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/marks.h"

#include <math.h>
#include <string.h>

#include "branch_points.h"

/* ---- the kinds ---- */

/* A multiplier passes 1 where the key turns, as its part in the branch's direction changes sign. */
static double of_fold(const vs_marks_span *s, const vs_branch_point *at, int which) {
  (void)which;
  return at->way[s->count];
}

/* The product of 1 + mu over all multipliers; each of a complex pair gives the same size. */
static double of_flip(const vs_marks_span *s, const vs_branch_point *at, int which) {
  double product = 1;
  (void)which;
  for (int k = 0; k < s->count; k++) {
    const vs_multiplier *m = &at->multiplier[k];
    product *= m->im == 0 ? 1 + m->re : hypot(1 + m->re, m->im);
  }
  return product;
}

/* The product of mu_i mu_j - 1 over all i < j. It is real, as its factors are or come in pairs, and
 * 0 where two multipliers have the product 1. */
static double of_torus(const vs_marks_span *s, const vs_branch_point *at, int which) {
  double re = 1, im = 0;
  (void)which;
  for (int i = 0; i < s->count; i++)
    for (int j = 0; j < i; j++) {
      const vs_multiplier *a = &at->multiplier[i], *b = &at->multiplier[j];
      double x = a->re * b->re - a->im * b->im - 1, y = a->re * b->im + a->im * b->re;
      double was = re;
      re = was * x - im * y;
      im = was * y + im * x;
    }
  return re;
}

/* A pair lies on the circle; two real ones with the product 1 are no change of stability. */
static bool is_torus(const vs_branch_point *at, int count) {
  double nearest = INFINITY;
  bool pair = false;
  for (int i = 0; i < count; i++)
    for (int j = 0; j < i; j++) {
      const vs_multiplier *a = &at->multiplier[i], *b = &at->multiplier[j];
      double off = hypot(a->re * b->re - a->im * b->im - 1, a->re * b->im + a->im * b->re);
      if (off >= nearest) continue;
      nearest = off;
      pair = a->im != 0;
    }
  return pair;
}

/* How often the stop is met tells the sign, and how near to its surface the armature turns tells
 * how near the mark is. */
static double of_grazing(const vs_marks_span *s, const vs_branch_point *at, int which) {
  int from = s->a->turns.met[which], to = s->b->turns.met[which];
  double off = fmin(at->turns.nearest_m[which], s->model->stops.item[which].scale_m);
  if (from == to) return 1;
  bool as_behind =
      from < to ? 2 * at->turns.met[which] > from + to : 2 * at->turns.met[which] < from + to;
  return as_behind ? -off : off;
}

static int stops_of(const vs_model *m) {
  return m->stops.count;
}

static double of_pole(const vs_marks_span *s, const vs_branch_point *at, int which) {
  (void)s, (void)which;
  return at->pole_m;
}

static double of_iron(const vs_marks_span *s, const vs_branch_point *at, int which) {
  (void)s, (void)which;
  return at->iron_m;
}

static double of_firings(const vs_marks_span *s, const vs_branch_point *at, int which) {
  int from = s->a->turns.fired, to = s->b->turns.fired;
  (void)which;
  return from == to || 2 * abs(at->turns.fired - from) < abs(to - from) ? 1 : -1;
}

/* The key itself. */
static double of_key(const vs_marks_span *s, const vs_branch_point *at, int which) {
  (void)which;
  return at->z[s->count] - s->at;
}

static double of_nothing(const vs_marks_span *s, const vs_branch_point *at, int which) {
  (void)s, (void)at, (void)which;
  return NAN;
}

const vs_mark_kind vs_mark_merging = {
    .name = "merging",
    .text = "the branch ends in one of a smaller period, which has a flip here",
    .value = of_nothing,
    .neutral = true};
static const vs_mark_kind FOLD = {.name = "fold",
                                  .text = "the key turns back: a multiplier passes 1",
                                  .value = of_fold,
                                  .neutral = true},
                          FLIP = {.name = "flip",
                                  .text = "a multiplier passes -1: a branch of twice the period "
                                          "begins or ends",
                                  .value = of_flip,
                                  .neutral = true,
                                  .in_pairs = true},
                          TORUS = {.name = "torus",
                                   .text = "a pair of multipliers passes the unit circle: a beat "
                                           "begins or ends",
                                   .value = of_torus,
                                   .holds = is_torus,
                                   .neutral = true,
                                   .in_pairs = true},
                          GRAZING = {.name = "grazing",
                                     .text = "a stop is met with speed 0: a contact begins or ends",
                                     .value = of_grazing,
                                     .count = stops_of},
                          POLE = {.name = "pole_cover",
                                  .text = "the armature touches the pole cover, and there is no "
                                          "stop",
                                  .value = of_pole},
                          IRON = {.name = "iron",
                                  .text = "no gap is left, not even the pole cover's: beyond it "
                                          "the orbit is none of the machine's",
                                  .value = of_iron},
                          FIRING = {.name = "firing",
                                    .text = "the thyristor fires more or less often in a period",
                                    .value = of_firings},
                          AT = {.name = "at", .text = "what --at asks for", .value = of_key};

const vs_mark_kind *const vs_mark_kinds[] = {&FOLD, &FLIP,   &TORUS,           &GRAZING, &POLE,
                                             &IRON, &FIRING, &vs_mark_merging, &AT,      NULL};

bool vs_mark_between(const vs_mark *mark, const vs_marks_span *s) {
  double a = mark->kind->value(s, s->a, mark->which), b = mark->kind->value(s, s->b, mark->which);
  return (a > 0 && b <= 0) || (a < 0 && b >= 0);
}

/* ---- the search ---- */

/* One end of what the mark lies in. */
typedef struct end {
  double s, value; /* how far along the way from the span's first point; the kind's number */
  vs_branch_point at;
} end;

/* Relative to the key: how near the ends of the search shall come, a tenth of what is promised. A
 * key below this part of its range counts as that much. Where runs choose their own steps they come
 * no nearer than twice the noise of that. */
static const double CLOSE = 1e-10, NEAR_ZERO = 1e-2;

/* By how much the key may differ between the ends: the search's own error. */
static double width_in_key(const vs_branch_points *p, const end *lo, const end *hi) {
  double steepest = fmax(fabs(lo->at.way[p->count]), fabs(hi->at.way[p->count]));
  double rounding = fmax(lo->at.change, hi->at.change);
  return (steepest * fabs(hi->s - lo->s) + rounding) * p->unit[p->count];
}

/* The plane across the straight way from one point to another, through the former. */
typedef struct chord {
  double normal[VS_BRANCH_POINT_NUMBERS];
  double length;
  const vs_branch_point *from;
} chord;

static chord chord_of(const vs_branch_points *p, const vs_marks_span *span) {
  chord c = {.from = span->a};
  for (int j = 0; j <= p->count; j++) {
    c.normal[j] = (span->b->z[j] - span->a->z[j]) / p->unit[j];
    c.length = hypot(c.length, c.normal[j]);
  }
  for (int j = 0; j <= p->count; j++) c.normal[j] /= c.length;
  return c;
}

/* Finds the orbit at s, beginning between those of the ends. */
static bool try_orbit_between(vs_branch_points *p, const chord *c, const end *lo, const end *hi,
                              end *at) {
  vs_error why = {0};
  const vs_branch_plane plane = {c->normal, c->from->z, at->s};
  double part = (at->s - lo->s) / (hi->s - lo->s);
  at->at = lo->at;
  for (int j = 0; j <= p->count; j++)
    at->at.z[j] = lo->at.z[j] + part * (hi->at.z[j] - lo->at.z[j]);
  return !vs_branch_points_solve(p, &plane, &at->at, &why);
}

/* The same where the iteration failed at a point between the ends: at others. */
static bool try_beside(vs_branch_points *p, const chord *c, const end *lo, const end *hi, end *at) {
  static const double PARTS[] = {0.5, 0.25, 0.75, 0.1, 0.9};
  for (size_t k = 0; k < sizeof PARTS / sizeof *PARTS; k++) {
    at->s = lo->s + PARTS[k] * (hi->s - lo->s);
    if (try_orbit_between(p, c, lo, hi, at)) return true;
  }
  return false;
}

bool vs_mark_middle(vs_branch_points *p, const vs_marks_span *span, double part,
                    vs_branch_point *at) {
  const chord c = chord_of(p, span);
  const end lo = {.at = *span->a}, hi = {.s = c.length, .at = *span->b};
  end middle = {.s = part * c.length};
  bool there = try_orbit_between(p, &c, &lo, &hi, &middle);
  *at = middle.at;
  return there;
}

/* The secant's point, drawn towards the middle so that the interval shrinks from both its ends
 * (the ITP method: Oliveira and Takahashi, ACM Transactions on Mathematical Software 47, 2020, with
 * kappa_1 = 0.2 over the first length, kappa_2 = 2). slack: by how much more than half of the
 * interval may remain. */
static double next_of_secant(const end *lo, const end *hi, double first, double slack) {
  double a = lo->s, b = hi->s, middle = (a + b) / 2;
  double secant = (hi->value * a - lo->value * b) / (hi->value - lo->value);
  double toward = middle > secant ? 1 : -1, draw = 0.2 / first * (b - a) * (b - a);
  double drawn = draw <= fabs(middle - secant) ? secant + toward * draw : middle;
  if (!isfinite(drawn)) return middle;
  return fabs(drawn - middle) <= slack ? drawn : middle - toward * slack;
}

bool vs_mark_locate(vs_branch_points *p, const vs_marks_span *span, vs_mark *mark,
                    vs_branch_point *at) {
  enum { MOST_TRIES = 60 };
  const chord c = chord_of(p, span);
  end lo = {0, mark->kind->value(span, span->a, mark->which), *span->a};
  end hi = {c.length, mark->kind->value(span, span->b, mark->which), *span->b};
  const double first = hi.s, key = fabs(span->a->z[p->count]),
               close = fmax(CLOSE * fmax(key, NEAR_ZERO * p->unit[p->count]),
                            2 * p->noise * p->unit[p->count]);
  for (int n = 0; n < MOST_TRIES && width_in_key(p, &lo, &hi) > close; n++) {
    end mid = {0};
    /* halving alone would have come down to first/2^n */
    double slack = fmax(ldexp(first, 1 - n) - (hi.s - lo.s) / 2, 0);
    mid.s = next_of_secant(&lo, &hi, first, slack);
    if (mid.s == lo.s || mid.s == hi.s) break;
    if (!try_orbit_between(p, &c, &lo, &hi, &mid) && !try_beside(p, &c, &lo, &hi, &mid)) break;
    mid.value = mark->kind->value(span, &mid.at, mark->which);
    if ((mid.value > 0) == (lo.value > 0))
      lo = mid;
    else
      hi = mid;
  }
  mark->error = width_in_key(p, &lo, &hi);
  *at = fabs(lo.value) < fabs(hi.value) ? lo.at : hi.at;
  return !mark->kind->holds || mark->kind->holds(at, p->count);
}
