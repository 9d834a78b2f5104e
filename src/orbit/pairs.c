/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pairs.h"

#include <math.h>
#include <string.h>

enum { MOST = VS_MOST_STATES };

/* A copy's state is pushed by this part of its scale. */
static const double PUSHED = 3e-4;
/* The parts of Newton's step that are tried: 1, 1/3, 1/9, ... */
enum { TRIALS = 4 };
static const double SHORTER = 1.0 / 3;
/* With a residual below this the Phi found is kept, and passes are steered again. */
static const double NEAR = 1e-3;
/* How near, in parts of the largest travel, the armature is to come to where it was, behind the
 * long one. Slow modes are still on their way then. */
static const double COMES_BACK = 0.03;

vs_status vs_pairs_begin(vs_search *s, vs_error *err) {
  double start[MOST][MOST];
  vs_status status = vs_search_take(s, 2 * s->count, err);
  if (status) return status;
  for (int j = 0; j < s->count; j++) {
    memcpy(start[j], s->x, sizeof s->x);
    start[j][j] += PUSHED * s->scale[j];
  }
  s->pass = VS_SEARCH_FIRST;
  vs_search_go_on(s, s->x);
  return vs_copies_send(&s->copies, s->count, start, s->next, err);
}

static double residual(const vs_search *s, const double *from, const double *to) {
  double most = 0;
  for (int j = 0; j < s->count; j++) most = fmax(most, fabs(to[j] - from[j]) / s->scale[j]);
  return most;
}

/* Tries parts of Newton's step from where the first pass ended, and sets s->x to the best. Returns
 * the residual there; INFINITY: all have failed. *inside: this is a copy. */
static double try_steps(vs_search *s, const double *step, bool *inside, vs_error *err) {
  double start[TRIALS][MOST], part = 1, best = INFINITY;
  vs_copies_told told[VS_COPIES_MOST];
  bool came[VS_COPIES_MOST];
  for (int k = 0; k < TRIALS; k++, part *= SHORTER)
    for (int j = 0; j < s->count; j++) start[k][j] = s->pair[0][j] + part * step[j];
  *inside = false;
  if (vs_search_take(s, 2 * TRIALS, err)) return INFINITY;
  if (vs_copies_send(&s->copies, TRIALS, start, s->next, err)) return INFINITY;
  *inside = s->copies.inside;
  if (*inside) return 0;
  vs_copies_await(&s->copies, told, came);
  for (int k = 0; k < TRIALS; k++) {
    double off = came[k] ? residual(s, told[k].z[0], told[k].z[1]) : INFINITY;
    if (!(off < best)) continue;
    best = off;
    memcpy(s->x, start[k], sizeof s->x);
  }
  return best;
}

/* Passes are steered again: corrections before count no more. */
static void steer_again(vs_search *s) {
  s->pass = VS_SEARCH_STEERED;
  vs_corrections_begin(&s->corrections, s->setup->run.tolerance);
  vs_creep_begin(&s->creep, s->creep.deck, s->creep.tolerance, s->creep.period_s);
}

/* Pairs have come to nothing: is the machine on another orbit? */
static vs_status leave_alone(vs_search *s, vs_error *err) {
  if (s->marched)
    return vs_fail(
        err, VS_RUN,
        "with the circuit's own derivatives, too, the residual is still %.2g of the motion",
        s->corrections.last);
  s->marched = true;
  s->pass = VS_SEARCH_FREE;
  s->left = VS_PAIRS_LONG_MARCH / s->orbit->n + 1;
  if (s->guessed) memcpy(s->x, s->orbit->x, sizeof s->x);
  vs_search_go_on(s, s->x);
  return VS_OK;
}

/* The least number of firing periods after which the machine comes back to about where it was; 0:
 * there is none up to VS_SEARCH_LONGEST. */
static int comes_back_after(const vs_search *s) {
  for (int k = 1; k <= VS_SEARCH_LONGEST; k++) {
    double off = 0;
    for (int back = 0; back < VS_SEARCH_LONGEST; back++)
      off = fmax(off, fabs(s->past_m[(s->cycles - back) % (2 * VS_SEARCH_LONGEST)] -
                           s->past_m[(s->cycles - back - k) % (2 * VS_SEARCH_LONGEST)]));
    off /= s->travel_m;
    if (off < COMES_BACK) return k;
  }
  return 0;
}

/* The long march has ended. */
static vs_status look_around(vs_search *s, vs_error *err) {
  int k = comes_back_after(s), n = s->orbit->n;
  if (k == n) return vs_pairs_begin(s, err);
  if (k)
    return vs_fail(err, VS_INPUT,
                   "--period %d: no such orbit is found, and the machine, left to itself, comes "
                   "back to about where it was after %d periods; try --period %d",
                   n, k, k);
  return vs_fail(err, VS_RUN,
                 "no orbit of period %d is found; nor does the machine, left to itself, come back "
                 "to where it was after up to %d periods",
                 n, VS_SEARCH_LONGEST);
}

/* The pair has ended. */
static vs_status end_pair(vs_search *s, vs_error *err) {
  bool inside;
  vs_error why = {0};
  double before = residual(s, s->pair[0], s->pair[1]), step[MOST] = {0};
  vs_status status = vs_copies_map(&s->copies, s->pair, s->scale, s->orbit->monodromy, &why);
  memcpy(s->orbit->scale, s->scale, sizeof s->scale);
  memcpy(s->x, s->pair[1], sizeof s->x);
  s->corrections.last = before;
  if (status || !vs_search_invert(s)) return leave_alone(s, err);
  s->own_phi = true;
  for (int i = 0; i < s->count; i++)
    for (int j = 0; j < s->count; j++)
      step[i] += s->inverse[i][j] * (s->pair[1][j] - s->pair[0][j]);
  double after = try_steps(s, step, &inside, err);
  if (inside) return VS_OK;
  s->corrections.last = after;
  if (after < NEAR) {
    steer_again(s);
    return VS_OK;
  }
  if (!isfinite(after) || ++s->pairs == VS_PAIRS) return leave_alone(s, err);
  return vs_pairs_begin(s, err);
}

vs_status vs_pairs_turn(vs_search *s, const vs_knot *end, vs_error *err) {
  vs_status status = VS_OK;
  vs_search_scale(s);
  if (s->pass == VS_SEARCH_FREE) {
    memcpy(s->x, end->x, sizeof s->x);
    vs_search_go_on(s, s->x);
    if (--s->left > 0) return VS_OK;
    s->pairs = 0;
    return s->marched ? look_around(s, err) : vs_pairs_begin(s, err);
  }
  memcpy(s->pair[s->pass == VS_SEARCH_SECOND], end->x, sizeof s->x);
  if (s->pass == VS_SEARCH_FIRST) {
    s->pass = VS_SEARCH_SECOND;
    vs_search_go_on(s, end->x);
    return VS_OK;
  }
  status = end_pair(s, err);
  if (!s->copies.inside) vs_search_go_on(s, s->x);
  return status;
}
