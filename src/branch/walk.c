/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "branch/walk.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is found ---- */

static void add(vs_walk *w, const vs_path_point *at, const vs_mark *mark) {
  if (w->count == w->room) {
    w->room = w->room ? 2 * w->room : 256;
    w->row = realloc(w->row, w->room * sizeof *w->row);
    if (!w->row) vs_out_of_memory();
  }
  w->row[w->count++] = (vs_walk_row){*at, *mark};
  w->marks += mark->kind != NULL;
}

/* A mark with its orbit and its place along the branch. */
typedef struct found {
  vs_mark mark;
  vs_path_point at;
  double s;
} found;

static int by_place(const void *left, const void *right) {
  const found *a = left, *b = right;
  return (a->s > b->s) - (a->s < b->s);
}

/* An orbit of the period asked for comes this near to one of a smaller period, in parts of the
 * motion, where the two branches meet; and a fold of theirs is where they do. */
static const double MERGED = 1e-4, SAME = 1e-7;

/* Adds the marks between two neighbours, in their order; *merged: one is where this branch ends in
 * one of a smaller period. */
static void add_marks(vs_walk *w, const vs_path_point *a, const vs_path_point *b, bool *merged) {
  enum { MOST = 32 };
  const vs_marks_span span = {a, b, &w->along->scene->setup.model, w->path.count};
  const vs_path_plane across = {a->way, a->z, 0};
  found *all = vs_alloc(MOST, sizeof *all);
  size_t n = 0;
  for (const vs_mark_kind *const *kind = vs_mark_kinds; *kind; kind++) {
    int count = (*kind)->count ? (*kind)->count(span.model) : 1;
    for (int k = 0; k < count && n < MOST; k++) {
      found *f = &all[n];
      f->mark = (vs_mark){.kind = *kind, .which = k};
      if (!vs_mark_between(&f->mark, &span)) continue;
      if (!vs_mark_locate(&w->path, &span, &f->mark, &f->at)) continue;
      f->s = vs_path_offset(&w->path, &across, f->at.z);
      n++;
    }
  }
  qsort(all, n, sizeof *all, by_place);
  for (size_t k = 0; k < n && !*merged; k++) {
    add(w, &all[k].at, &all[k].mark);
    *merged = all[k].at.repeats < MERGED;
  }
  free(all);
}

/* ---- one step ---- */

/* Steps are lengths in the path's units, in which the key's range is 1 (path.c). A step that fails,
 * or turns by more than TURNS, is halved, down to SHORTEST; one that turns by less than EASES and
 * took few iterations lets the next one grow. */
static const double SHORTEST = 1e-8, TURNS = 0.94, EASES = 0.995;
enum { FEW = 4, MOST_ROWS = 20000 };

static double turn(const vs_path *p, const vs_path_point *a, const vs_path_point *b) {
  double cosine = 0;
  for (int j = 0; j <= p->count; j++) cosine += a->way[j] * b->way[j];
  return cosine;
}

/* Tries a step of that length. Returns false where it fails, and says why. */
static bool try(vs_walk *w, const vs_path_point *a, double length, vs_path_point *b) {
  const vs_path_plane plane = {a->way, a->z, length};
  vs_error err = {0};
  *b = *a;
  for (int j = 0; j <= w->path.count; j++) b->z[j] += length * a->way[j] * w->path.unit[j];
  if (!vs_path_solve(&w->path, &plane, b, &err)) return true;
  snprintf(w->why, sizeof w->why, "%.500s", err.text);
  return false;
}

/* Goes one step on from a; *length: how long it is tried, and then how long the next one may be.
 * Returns false where even the shortest fails. */
static bool step(vs_walk *w, const vs_path_point *a, double *length, vs_path_point *b) {
  double longest = w->along->step / w->path.unit[w->path.count];
  for (double h = fmin(*length, longest);; h /= 2) {
    bool there = try(w, a, h, b), shortest = h / 2 < SHORTEST;
    double cosine = there ? turn(&w->path, a, b) : -1;
    if (!there && shortest) return false;
    if (!there || (cosine < TURNS && !shortest)) continue;
    *length = cosine > EASES && b->iterations <= FEW ? 1.5 * h : h;
    return true;
  }
}

/* ---- the ends ---- */

/* Puts b, which lies beyond the bound, on it: between a and b. */
static bool land(vs_walk *w, const vs_path_point *a, double bound, vs_path_point *b) {
  int k = w->path.count;
  double normal[VS_PATH_MOST] = {0}, origin[VS_PATH_MOST], part;
  vs_error err = {0};
  vs_path_point on = *b;
  part = (bound - a->z[k]) / (b->z[k] - a->z[k]);
  for (int j = 0; j <= k; j++) on.z[j] = a->z[j] + part * (b->z[j] - a->z[j]);
  on.z[k] = bound;
  memcpy(origin, on.z, sizeof origin);
  normal[k] = b->way[k] > 0 ? 1 : -1;
  const vs_path_plane plane = {normal, origin, 0};
  if (vs_path_solve(&w->path, &plane, &on, &err)) {
    snprintf(w->why, sizeof w->why, "%.500s", err.text);
    return false;
  }
  on.z[k] = bound;
  *b = on;
  return true;
}

/* Is the key beyond that end of the range, seen from the other? */
static bool is_beyond(double key, double other, double end) {
  return end > other ? key >= end : key <= end;
}

/* Takes the step from the last point of the walk. Returns true where the walk ends. */
static bool go_on(vs_walk *w, vs_path_point *a, double *length) {
  const vs_along *along = w->along;
  const vs_mark none = {0};
  vs_path_point b;
  bool merged = false;
  w->end = VS_WALK_STUCK;
  if (!step(w, a, length, &b)) return true;
  double key = b.z[w->path.count];
  bool there = is_beyond(key, along->from, along->to),
       back = is_beyond(key, along->to, along->from);
  if (there && !land(w, a, along->to, &b)) return true;
  if (back && !land(w, a, along->from, &b)) return true;
  add_marks(w, a, &b, &merged);
  w->end = merged || b.repeats < SAME ? VS_WALK_MERGED : there ? VS_WALK_REACHED : VS_WALK_BACK;
  if (w->end == VS_WALK_MERGED) return true;
  add(w, &b, &none);
  vs_path_rescale(&w->path, &b);
  *a = b;
  return there || back;
}

vs_status vs_walk_go(vs_walk *w, vs_along *along, int periods, const volatile sig_atomic_t *stop,
                     vs_error *err) {
  const vs_mark none = {0};
  vs_path_point a;
  *w = (vs_walk){.along = along};
  vs_status status = vs_path_begin(&w->path, along, periods, &a, err);
  if (status) return status;
  add(w, &a, &none);
  vs_path_rescale(&w->path, &a);
  double length = along->step / w->path.unit[w->path.count] / 4;
  while (!go_on(w, &a, &length)) {
    if (stop && *stop) return vs_fail(err, VS_SIGNAL, "stopped by a signal");
    if (w->count < MOST_ROWS) continue;
    snprintf(w->why, sizeof w->why,
             "it has %d points already; with a larger --step there are fewer", MOST_ROWS);
    w->end = VS_WALK_STUCK;
    break;
  }
  return VS_OK;
}

void vs_walk_free(vs_walk *w) {
  free(w->row);
}
