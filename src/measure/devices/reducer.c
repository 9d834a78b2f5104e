/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/reducer.h"

#include <math.h>
#include <stdio.h>

void vs_reducer_watch(vs_reduced *r, const vs_course_step *c, double before, double after) {
  if (!r->limit || !isnan(r->failed_s) || !(after > r->limit->value)) return;
  double part = (r->limit->value - before) / (after - before);
  r->failed_s = c->t0_s + fmin(fmax(part, 0), 1) * c->h_s;
}

void vs_reducer_take_largest(vs_reduced *r, const vs_course_step *c, double before, double after) {
  if (after > r->value.value) r->value = (vs_value){true, after, c->t1_s};
  vs_reducer_watch(r, c, before, after);
}

void vs_reducer_offer(vs_reduced *r, vs_value v, bool least) {
  if (!v.known) return;
  if (!r->value.known || (least ? v.value < r->value.value : v.value > r->value.value))
    r->value = v;
  if (!r->limit || !isnan(r->failed_s)) return;
  if (r->measure->held == VS_AT_LEAST ? v.value < r->limit->value : v.value > r->limit->value)
    r->failed_s = v.at_s;
}

bool vs_reducer_is_held_from_below(const vs_reduced *r) {
  return r->measure->held == VS_AT_LEAST;
}

void vs_reducer_count(vs_reduced *r, double at_s) {
  if (r->value.value++ == 0) r->value.at_s = at_s;
}

char *vs_reducer_happens(vs_reduced *r, double at_s) {
  vs_happening *h = r->state;
  if (h->times++) return NULL;
  h->at_s = at_s;
  return h->cause;
}

const vs_happening *vs_reducer_happening(const vs_reduced *r) {
  return r->measure->held == VS_NEVER ? r->state : NULL;
}

const vs_reduced *vs_reducer_of(const vs_watched *w, vs_reduction how) {
  for (size_t k = 0; k < w->count; k++)
    if (w->reduced[k].measure->how == how) return &w->reduced[k];
  return NULL;
}

void vs_reducer_begin_at_zero(const vs_watched *w, vs_reduced *r, double t_s) {
  (void)w, (void)t_s;
  r->value = (vs_value){true, 0, NAN};
}

bool vs_reducer_has_limit(const vs_watched *w, const vs_reduced *r) {
  (void)w;
  return r->limit;
}

/* ---- a window ---- */

void vs_reducer_window_begin(vs_window *w, double width_s, double t_s) {
  *w = (vs_window){.part_s = width_s / VS_WINDOW_PARTS, .starts_s = t_s, .to = 1};
}

enum { RING = VS_WINDOW_PARTS + 1 };

/* The oldest part leaves: as it lies about its centre, or, where its sign changes, evenly. */
static void begin_to_leave(vs_window *w) {
  const vs_window_part *p = &w->part[(w->now + 1) % RING];
  const double centre = p->first / p->sum, square = p->second / p->sum - centre * centre;
  const bool one = centre > 0 && centre < 1 && square >= 0;
  const double half = one ? fmin(sqrt(3 * square), fmin(centre, 1 - centre)) : 0.5;
  w->from = one ? centre - half : 0;
  w->to = one ? centre + half : 1;
}

static void next_part(vs_window *w) {
  w->now = (w->now + 1) % RING;
  w->part[w->now] = (vs_window_part){0};
  w->whole = 0;
  for (size_t k = 2; k <= VS_WINDOW_PARTS; k++) w->whole += w->part[(w->now + k) % RING].sum;
  w->starts_s += w->part_s;
  begin_to_leave(w);
}

/* The window's integral at x of the present part, with `more` behind what that part has. */
static double sum_at(const vs_window *w, double x, double more) {
  const double oldest = w->part[(w->now + 1) % RING].sum;
  const double in = x <= w->from ? 1 : x >= w->to ? 0 : (w->to - x) / (w->to - w->from);
  return w->whole + w->part[w->now].sum + more + in * oldest;
}

/* Adds what lies evenly from x to y of the present part. */
static void add_stretch(vs_window *w, double x, double y, double more) {
  vs_window_part *p = &w->part[w->now];
  if (x < w->from && w->from < y)
    w->most = fmax(w->most, sum_at(w, w->from, more * (w->from - x) / (y - x)));
  p->sum += more;
  p->first += more * (x + y) / 2;
  p->second += more * (x * x + x * y + y * y) / 3;
  w->sum = sum_at(w, y, 0);
  w->most = fmax(w->most, w->sum);
}

double vs_reducer_window_add(vs_window *w, const vs_course_step *c, double more) {
  double from_s = c->t0_s;
  double skipped = floor((c->t1_s - w->starts_s) / w->part_s) - VS_WINDOW_PARTS - 1;
  if (skipped > 0) w->starts_s += skipped * w->part_s; /* a step longer than all of it */
  from_s = fmax(from_s, w->starts_s);
  w->most = w->sum;
  while (c->t1_s > w->starts_s + w->part_s) {
    double end_s = fmax(w->starts_s + w->part_s, from_s);
    add_stretch(w, (from_s - w->starts_s) / w->part_s, 1, more * (end_s - from_s) / c->h_s);
    from_s = end_s;
    next_part(w);
  }
  add_stretch(w, (from_s - w->starts_s) / w->part_s, (c->t1_s - w->starts_s) / w->part_s,
              from_s > c->t0_s ? more * (c->t1_s - from_s) / c->h_s : more);
  return w->sum;
}

/* ---- what a device did ---- */

static const char *const WORDS[VS_DEEDS] = {[VS_DEED_FIRES] = "fires",
                                            [VS_DEED_GOES_OUT] = "goes out",
                                            [VS_DEED_MISFIRES] = "misfires",
                                            [VS_DEED_UNINTENDED] = "fires without a gate pulse",
                                            [VS_DEED_FAILS] = "fails to commutate",
                                            [VS_DEED_MELTS] = "melts",
                                            [VS_DEED_CLEARS] = "has cleared",
                                            [VS_DEED_ARCS_AGAIN] = "arcs again"};

void vs_reducer_add_deed(vs_sequence *s, vs_deed deed, double at_s) {
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

/* True: the device goes out, and its gate fires it again within the window, as the next of its
 * sub-pulses does while the current is hardly what it takes to stay on. */
static bool is_pause(const vs_sequence *s, size_t k, double window_s) {
  return k + 2 < s->kept && s->item[k].deed == VS_DEED_GOES_OUT &&
         s->item[k + 1].deed == VS_DEED_FIRES && s->item[k + 2].deed == VS_DEED_GOES_OUT &&
         s->item[k + 1].at_s - s->item[k].at_s <= window_s;
}

/* True: the pause is in `s` alone, as the other one's end is nearer to the end behind it. */
static bool pauses_alone(const vs_sequence *s, size_t k, const vs_sequence *other, size_t n,
                         double window_s) {
  const double at_s = other->item[n].at_s;
  return is_pause(s, k, window_s) && other->item[n].deed == VS_DEED_GOES_OUT &&
         fabs(s->item[k + 2].at_s - at_s) < fabs(s->item[k].at_s - at_s);
}

/* True where the sequences differ by pauses alone, with all else the same in both. Whichever of the
 * two is right, a run has it, and what hangs on it is the same behind it; the margins of the two
 * then tell the error. */
static bool differ_by_pauses(const vs_sequence *one, const vs_sequence *other, double window_s) {
  size_t a = 0, b = 0;
  if (!one->bursts || one->kept == VS_SEQUENCE_KEPT || other->kept == VS_SEQUENCE_KEPT)
    return false;
  while (a < one->kept && b < other->kept) {
    if (pauses_alone(one, a, other, b, window_s))
      a += 2;
    else if (pauses_alone(other, b, one, a, window_s))
      b += 2;
    else if (one->item[a].deed == other->item[b].deed &&
             fabs(one->item[a].at_s - other->item[b].at_s) <= window_s)
      a++, b++;
    else
      return false;
  }
  return a == one->kept && b == other->kept;
}

/* When the sequences part, behind `same` deeds that are the same in both. Behind all that are kept
 * it is told early. */
static double parting(const vs_sequence *one, const vs_sequence *other, size_t same) {
  double a_s = same < one->kept ? one->item[same].at_s : INFINITY;
  double b_s = same < other->kept ? other->item[same].at_s : INFINITY;
  double last_s = same ? one->item[same - 1].at_s : -INFINITY;
  return isinf(a_s) && isinf(b_s) ? last_s : fmin(a_s, b_s);
}

bool vs_reducer_sequences_agree(const vs_sequence *one, const vs_sequence *other, double window_s,
                                vs_sequence_difference *d) {
  size_t same = common(one, other, window_s);
  if (differ_by_pauses(one, other, window_s)) return true;
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
