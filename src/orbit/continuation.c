/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "continuation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "branch_points.h"

/* ---- what is found ---- */

/* Puts a row behind the first `behind` of them. */
static void insert_row(vs_continuation *w, size_t behind, const vs_branch_point *at,
                       const vs_mark *mark) {
  if (w->count == w->room) {
    w->room = w->room ? 2 * w->room : 256;
    w->row = vs_resize(w->row, w->room, sizeof *w->row);
  }
  memmove(w->row + behind + 1, w->row + behind, (w->count - behind) * sizeof *w->row);
  w->row[behind] = (vs_continuation_row){*at, *mark};
  w->count++;
  w->marks += mark->kind != NULL;
}

static void add_point_of_walk(vs_continuation *w, const vs_branch_point *at) {
  const vs_mark none = {0};
  insert_row(w, w->count, at, &none);
}

static double distance_of_points(const vs_continuation *w, const vs_branch_point *a,
                                 const vs_branch_point *b) {
  double squared = 0;
  for (int j = 0; j <= w->path.count; j++) {
    double d = (b->z[j] - a->z[j]) / w->path.unit[j];
    squared += d * d;
  }
  return sqrt(squared);
}

/* Adds a mark behind the row of the point `first`, among other marks by how far they are from it.
 */
static void add_mark(vs_continuation *w, size_t first, const vs_branch_point *at,
                     const vs_mark *mark) {
  double s = distance_of_points(w, &w->row[first].at, at);
  size_t behind = first + 1;
  while (behind < w->count && w->row[behind].mark.kind &&
         distance_of_points(w, &w->row[first].at, &w->row[behind].at) < s)
    behind++;
  insert_row(w, behind, at, mark);
}

static vs_marks_span span_of(const vs_continuation *w, const vs_branch_point *a,
                             const vs_branch_point *b) {
  return (vs_marks_span){a, b, &w->along->scene->setup.model, w->path.count, w->along->at};
}

/* Adds the mark of this kind between two orbits, which lie behind the row `first`, if there is one.
 */
static void look_for(vs_continuation *w, size_t first, const vs_branch_point *a,
                     const vs_branch_point *b, vs_mark mark) {
  const vs_marks_span span = span_of(w, a, b);
  vs_branch_point at;
  if (vs_mark_between(&mark, &span) && vs_mark_locate(&w->path, &span, &mark, &at))
    add_mark(w, first, &at, &mark);
}

/* Adds the marks between the last point of the walk, whose row is `first`, and the next. */
static void add_marks(vs_continuation *w, size_t first, const vs_branch_point *b) {
  const vs_branch_point a = w->row[first].at;
  const vs_model *m = &w->along->scene->setup.model;
  for (const vs_mark_kind *const *kind = vs_mark_kinds; *kind; kind++) {
    int count = (*kind)->count ? (*kind)->count(m) : 1;
    for (int k = 0; k < count; k++) look_for(w, first, &a, b, (vs_mark){*kind, k, 0});
  }
}

/* ---- two marks of a kind within a step ---- */

/* A number and the two after it, of one sign, at distances s[0] and s[0] + s[1]. Where the parabola
 * through them has its bottom at less than half of the least of them, the number may be 0 twice in
 * between: returns how far the bottom is from the first. NaN: there is none. */
static double bottom_of_parabola(const double f[3], const double s[2]) {
  double sign = f[0] > 0 ? 1 : -1, least = fmin(fabs(f[0]), fmin(fabs(f[1]), fabs(f[2])));
  double first = (f[1] - f[0]) / s[0], second = (f[2] - f[1]) / s[1];
  double bend = (second - first) / (s[0] + s[1]), at = (s[0] - first / bend) / 2;
  if (!(f[0] * f[1] > 0 && f[1] * f[2] > 0 && bend * sign > 0)) return NAN;
  if (!(at > 0 && at < s[0] + s[1])) return NAN;
  double value = f[0] + first * at + bend * at * (at - s[0]);
  return value * sign < least / 2 ? at : NAN;
}

/* Has the step behind the row `first` a mark of this kind already? */
static bool is_marked(const vs_continuation *w, size_t first, const vs_mark_kind *kind) {
  for (size_t r = first + 1; r < w->count && w->row[r].mark.kind; r++)
    if (w->row[r].mark.kind == kind) return true;
  return false;
}

/* Comes nearer to the bottom between three orbits, the middle one of which is the lowest. Returns
 * false where it is none, or is not found. */
static bool come_nearer(vs_continuation *w, vs_branch_point t[3], const vs_mark_kind *kind) {
  const vs_marks_span all = span_of(w, &t[0], &t[2]);
  const double s[] = {distance_of_points(w, &t[0], &t[1]), distance_of_points(w, &t[1], &t[2])};
  double f[3];
  for (int k = 0; k < 3; k++) f[k] = kind->value(&all, &t[k], 0);
  double at = bottom_of_parabola(f, s);
  vs_branch_point x;
  if (isnan(at) || !vs_mark_middle(&w->path, &all, at / (s[0] + s[1]), &x)) return false;
  bool lower = fabs(kind->value(&all, &x, 0)) < fabs(f[1]), before = at < s[0];
  int moved = before == lower ? 2 : 0; /* which end gives way */
  if (lower) {
    t[moved] = t[1];
    t[1] = x;
  } else
    t[moved] = x;
  return true;
}

/* Looks for a pair behind the row `first`, where the bottom is `part` of the way to the point b. */
static void look_between(vs_continuation *w, size_t first, const vs_branch_point *b, double part,
                         const vs_mark_kind *kind) {
  enum { MOST_LOOKS = 4 };
  vs_branch_point t[3] = {w->row[first].at, {.z = {0}}, *b};
  const vs_branch_point a = t[0], to = t[2];
  const vs_marks_span span = span_of(w, &a, &to);
  const vs_mark mark = {kind, 0, 0};
  if (is_marked(w, first, kind) || !vs_mark_middle(&w->path, &span, part, &t[1])) return;
  for (int n = 0; n < MOST_LOOKS; n++) {
    const vs_marks_span left = span_of(w, &a, &t[1]);
    if (vs_mark_between(&mark, &left)) {
      const vs_branch_point middle = t[1];
      look_for(w, first, &a, &middle, mark);
      look_for(w, first, &middle, &to, mark);
      return;
    }
    if (!come_nearer(w, t, kind)) return;
  }
}

/* Adds the pairs of marks that lie within a step, which the signs at its ends do not show. b: the
 * point behind the row `last`, the row `before` is the point before that. Returns by how much the
 * former moves. */
static size_t add_pairs(vs_continuation *w, size_t before, size_t last, const vs_branch_point *b) {
  size_t moved = 0;
  for (const vs_mark_kind *const *kind = vs_mark_kinds; *kind; kind++) {
    const vs_branch_point p = w->row[before].at, a = w->row[last + moved].at;
    const vs_marks_span span = span_of(w, &a, b);
    if (!(*kind)->in_pairs) continue;
    const double f[] = {(*kind)->value(&span, &p, 0), (*kind)->value(&span, &a, 0),
                        (*kind)->value(&span, b, 0)};
    const double s[] = {distance_of_points(w, &p, &a), distance_of_points(w, &a, b)};
    double at = bottom_of_parabola(f, s);
    size_t count = w->count;
    if (at < s[0]) look_between(w, before, &a, at / s[0], *kind);
    if (at >= s[0]) look_between(w, last + moved, b, (at - s[0]) / s[1], *kind);
    if (at < s[0]) moved += w->count - count;
  }
  return moved;
}

/* Where the branch meets one of a smaller period its orbits come as near to that as the root of the
 * key's distance. So the mark there is MERGED of the motion away from it, as a step's ends are not;
 * and an orbit that is SAME away is one of it. */
static const double MERGED = 1e-2, NEARER = 0.1, SAME = 1e-7;

/* Cuts the rows behind the one, from `first` on, at which the branch ends in one of a smaller
 * period. Returns false where it does not. */
static bool cut_merged(vs_continuation *w, size_t first, const vs_branch_point *b) {
  double most = fmin(MERGED, NEARER * fmin(w->row[first].at.repeats, b->repeats));
  for (size_t r = first + 1; r < w->count; r++) {
    if (!w->row[r].mark.kind || !(w->row[r].at.repeats < most)) continue;
    for (size_t k = r + 1; k < w->count; k++) w->marks -= w->row[k].mark.kind != NULL;
    w->row[r].mark.kind = &vs_mark_merging;
    w->count = r + 1;
    return true;
  }
  return false;
}

/* ---- one step ---- */

/* Steps are lengths in the path's units, in which the key's range is 1 (path.c). A step that fails,
 * or turns by more than TURNS, is halved, down to SHORTEST; one that turns by less than EASES and
 * took few iterations lets the next one grow. */
static const double SHORTEST = 1e-8, TURNS = 0.94, EASES = 0.995;
enum { FEW = 4, MOST_ROWS = 20000 };
/* Its runs take so many cycles of the mains at most for each in the period, which is a minute or
 * two for a period of one; then the walk is stuck. */
enum { MOST_CYCLES = 100000, MOST_WITH_CIRCUIT = 20000 };

static double turn_of_branch(const vs_branch_points *p, const vs_branch_point *a,
                             const vs_branch_point *b) {
  double cosine = 0;
  for (int j = 0; j <= p->count; j++) cosine += a->way[j] * b->way[j];
  return cosine;
}

/* Tries a step of that length. Returns false where it fails, and says why: also where the iteration
 * ends farther from its beginning than the step is long, which is on another branch. */
static bool try_step_of_branch(vs_continuation *w, const vs_branch_point *a, double length,
                               vs_branch_point *b) {
  const vs_branch_plane plane = {a->way, a->z, length};
  vs_error err = {0};
  double guess[VS_BRANCH_POINT_NUMBERS], off = 0;
  *b = *a;
  for (int j = 0; j <= w->path.count; j++)
    guess[j] = b->z[j] += length * a->way[j] * w->path.unit[j];
  if (vs_branch_points_solve(&w->path, &plane, b, &err)) {
    snprintf(w->why, sizeof w->why, "%.500s", err.text);
    return false;
  }
  for (int j = 0; j <= w->path.count; j++) off = hypot(off, (b->z[j] - guess[j]) / w->path.unit[j]);
  if (off <= length) return true;
  snprintf(w->why, sizeof w->why, "no orbit is near the last one");
  return false;
}

/* Goes one step on from a; *length: how long it is tried, and then how long the next one may be.
 * Returns false where even the shortest fails. */
static bool step_along_branch(vs_continuation *w, const vs_branch_point *a, double *length,
                              vs_branch_point *b) {
  double longest = w->along->step / w->path.unit[w->path.count];
  for (double h = fmin(*length, longest);; h /= 2) {
    bool there = try_step_of_branch(w, a, h, b), shortest = h / 2 < SHORTEST;
    double cosine = there ? turn_of_branch(&w->path, a, b) : -1;
    if (!there && shortest) return false;
    if (!there || (cosine < TURNS && !shortest)) continue;
    *length = cosine > EASES && b->iterations <= FEW ? 1.5 * h : h;
    return true;
  }
}

/* ---- the ends ---- */

/* A walk whose steps have become shorter than this part of the key's range looks as far ahead.
 * Before a value at which the mass matrix is singular a machine has ever faster modes: each run
 * takes longer than the one before, and steps halve without an end. */
static const double AHEAD = 1e-3;

/* Does the scene allow values of the key ahead of the point, within the range? Says why not. */
static bool is_allowed_ahead(vs_continuation *w, const vs_branch_point *a) {
  const vs_branch_parameter *along = w->along;
  int k = w->path.count;
  double key = a->z[k] + copysign(AHEAD * w->path.unit[k], a->way[k]);
  vs_error err = {0};
  if (key < fmin(along->from, along->to) || key > fmax(along->from, along->to)) return true;
  if (!vs_branch_parameter_move(w->along, key, &err)) return true;
  snprintf(w->why, sizeof w->why, "behind it the scene is refused: %.450s", err.text);
  return false;
}

/* Puts b, which lies beyond the bound, on it: between a and b. */
static bool land_on_bound(vs_continuation *w, const vs_branch_point *a, double bound,
                          vs_branch_point *b) {
  int k = w->path.count;
  double normal[VS_BRANCH_POINT_NUMBERS] = {0}, origin[VS_BRANCH_POINT_NUMBERS], part;
  vs_error err = {0};
  vs_branch_point on = *b;
  part = (bound - a->z[k]) / (b->z[k] - a->z[k]);
  for (int j = 0; j <= k; j++) on.z[j] = a->z[j] + part * (b->z[j] - a->z[j]);
  on.z[k] = bound;
  memcpy(origin, on.z, sizeof origin);
  normal[k] = b->way[k] > 0 ? 1 : -1;
  const vs_branch_plane plane = {normal, origin, 0};
  if (vs_branch_points_solve(&w->path, &plane, &on, &err)) {
    snprintf(w->why, sizeof w->why, "%.500s", err.text);
    return false;
  }
  on.z[k] = bound;
  *b = on;
  return true;
}

/* Is the key beyond that end of the range, seen from the other? */
static bool is_beyond_end(double key, double other, double end) {
  return end > other ? key >= end : key <= end;
}

/* The row of the last point before the row `behind`, which is no mark. */
static size_t point_before(const vs_continuation *w, size_t behind) {
  while (behind > 0 && w->row[--behind].mark.kind) {
  }
  return behind;
}

/* Looks for marks before the new point b, and adds both. Returns false where the branch merges. */
static bool take_point_of_walk(vs_continuation *w, const vs_branch_point *b) {
  size_t last = point_before(w, w->count), before = point_before(w, last);
  if (last > before) last += add_pairs(w, before, last, b);
  add_marks(w, last, b);
  if (cut_merged(w, last, b) || b->repeats < SAME) return false;
  add_point_of_walk(w, b);
  return true;
}

/* Takes the step from the last point of the walk. Returns true where the walk ends. */
static bool walk_on(vs_continuation *w, vs_branch_point *a, double *length) {
  const vs_branch_parameter *along = w->along;
  vs_branch_point b;
  w->end = VS_CONTINUATION_STUCK;
  if (*length < AHEAD && !is_allowed_ahead(w, a)) return true;
  if (!step_along_branch(w, a, length, &b)) return true;
  double key = b.z[w->path.count];
  bool there = is_beyond_end(key, along->from, along->to),
       back = is_beyond_end(key, along->to, along->from);
  if (there && !land_on_bound(w, a, along->to, &b)) return true;
  if (back && !land_on_bound(w, a, along->from, &b)) return true;
  if (!take_point_of_walk(w, &b)) return w->end = VS_CONTINUATION_MERGED, true;
  w->end = there ? VS_CONTINUATION_REACHED : VS_CONTINUATION_BACK;
  vs_branch_points_rescale(&w->path, &b);
  *a = b;
  return there || back;
}

/* Where the budget is spent, no step fails for another reason, and a mark before the last point may
 * be missing. */
static void look_at_budget(vs_continuation *w) {
  const vs_budget *b = &w->path.budget;
  const int kind = w->along->scene->tier->has_circuit ? VS_BUDGET_CIRCUIT : VS_BUDGET_IDEAL;
  if (b->of && b->of->out[kind]) b = b->of;
  if (!b->out[kind] || w->end == VS_CONTINUATION_STOPPED) return;
  w->end = VS_CONTINUATION_SPENT;
  snprintf(w->why, sizeof w->why,
           "the search's budget of %ld cycles of the mains is spent, after %zu points",
           b->most[kind], w->count - w->marks);
}

vs_status vs_continuation_go(vs_continuation *w, vs_branch_parameter *along, int periods,
                             const volatile sig_atomic_t *stop, vs_error *err) {
  vs_branch_point a;
  *w = (vs_continuation){.along = along};
  along->scene->order.stop = stop;
  const bool shows = along->scene->order.shows;
  vs_status status = vs_branch_points_begin(&w->path, along, periods, &a, err);
  if (status) return status;
  const int every = along->scene->setup.timeline.firing.every;
  const long cycles = (long)periods * (every > 1 ? every : 1);
  vs_budget *budget = &w->path.budget;
  *budget = (vs_budget){.what = "branch",
                        .of = along->scene->order.budget,
                        .most = {MOST_CYCLES * cycles, MOST_WITH_CIRCUIT * cycles},
                        .shows = shows};
  add_point_of_walk(w, &a);
  vs_branch_points_rescale(&w->path, &a);
  double length = along->step / w->path.unit[w->path.count] / 4;
  while (!walk_on(w, &a, &length)) {
    if (stop && *stop) {
      w->end = VS_CONTINUATION_STOPPED;
      break;
    }
    snprintf(budget->stage, sizeof budget->stage, "point %zu, at %.6g%s%s", w->count,
             a.z[w->path.count], *along->axis.unit ? " " : "", along->axis.unit);
    if (w->count < MOST_ROWS) continue;
    snprintf(w->why, sizeof w->why,
             "it has %d points already; with a larger --step there are fewer", MOST_ROWS);
    w->end = VS_CONTINUATION_SPENT;
    break;
  }
  if (stop && *stop && w->end == VS_CONTINUATION_STUCK) w->end = VS_CONTINUATION_STOPPED;
  look_at_budget(w);
  vs_budget_end(budget);
  return VS_OK;
}

void vs_continuation_free(vs_continuation *w) {
  vs_branch_points_end(&w->path);
  free(w->row);
}
