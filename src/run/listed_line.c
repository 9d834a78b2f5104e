/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/listed_line.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "measure/expect.h"

/* A line that a scene may have: its name, whose it is, its limit where it has one alone, and the
 * unit of that. */
typedef struct line {
  char name[VS_JUDGED_NAME - 8]; /* "margin." goes before it */
  const char *of, *unit;
  double limit; /* in unit; NaN: two ends, or the part does not state it */
  bool at_least, own;
  int sense, left_out_by; /* see vs_listed_measure */
  unsigned unsure;        /* the same */
} line;

static bool is_first_of_probe(const vs_deck *deck, size_t k) {
  size_t first = 0;
  while (deck->ratings[first].probe != deck->ratings[k].probe) first++;
  return first == k;
}

static void name_line(line *l, const char *of, const char *measure) {
  snprintf(l->name, sizeof l->name, "%s%s%s", of, *measure ? "." : "", measure);
  l->of = of;
}

/* A stress has at most the size of an end on its side of 0, and at least that of one beyond 0. Two
 * ends are alike if 0 lies between them. */
static int sense_of(const vs_rating *r) {
  const int below = isinf(r->min) ? 0 : (r->min < 0) - (r->min > 0);
  const int above = isinf(r->max) ? 0 : (r->max > 0) - (r->max < 0);
  if (isinf(r->min) || isinf(r->max)) return below + above;
  return below > 0 && above > 0;
}

/* A rating of one end has this limit. */
static void take_ends(line *l, const vs_rating *r) {
  l->unit = r->unit;
  l->sense = sense_of(r);
  if (isinf(r->min) == isinf(r->max)) return;
  l->at_least = isinf(r->max);
  l->limit = (l->at_least ? r->min : r->max) / vs_units_factor(r->unit);
}

/* The n-th line of the deck's ratings, less those it has. False: *n is what is left of it. */
static bool deck_line_at(const vs_deck *deck, int *n, line *l) {
  for (size_t k = 0; deck && k < deck->n_ratings; k++)
    if (is_first_of_probe(deck, k) && (*n)-- == 0) {
      name_line(l, deck->probes[deck->ratings[k].probe].name, "");
      take_ends(l, &deck->ratings[k]);
      return true;
    }
  return false;
}

static bool own_line_at(const vs_ratings *ratings, int *n, line *l) {
  if (*n >= ratings->count) {
    *n -= ratings->count;
    return false;
  }
  name_line(l, ratings->item[*n].name, "");
  l->own = true;
  take_ends(l, &ratings->item[*n].rating);
  return true;
}

/* True if every case with that part has that limit, whatever its run or its ambient temperature. */
static bool is_fixed(const vs_watched *w, const vs_reduced *r, const vs_limit *stated) {
  enum { HOTTEST = 10000 };
  vs_limit own;
  double hot_degc;
  const bool settles =
      r->by->settle && vs_devices_limit_at(w->deck, w->device, stated->name, &hot_degc);
  return !settles && vs_devices_derated(w->deck, stated, HOTTEST, &own) == stated;
}

static bool device_line_at(const vs_devices *devices, int *n, line *l) {
  for (size_t d = 0; devices && d < devices->count; d++) {
    const vs_watched *w = &devices->item[d];
    for (size_t k = 0; k < w->count; k++) {
      const vs_reduced *r = &w->reduced[k];
      const vs_limit *stated = vs_devices_limit(w->deck, w->device, r->measure);
      const bool found = r->by->finds_limit && r->by->is_busy(w, r);
      const bool fixed = stated && !found && is_fixed(w, r, stated);
      if (!r->limit && !found && (!stated || fixed) &&
          !vs_devices_lacks(w->deck, w->device, r->measure))
        continue;
      if ((*n)-- > 0) continue;
      name_line(l, w->device->name, r->measure->name);
      l->unit = stated ? stated->unit : r->measure->unit;
      l->at_least = r->measure->held == VS_AT_LEAST;
      l->sense = l->at_least ? -1 : 1;
      l->unsure = r->unsure | (stated ? stated->unsure : 0) | (r->limit ? r->limit->unsure : 0);
      l->left_out_by = vs_expect_left_out_by(r);
      if (r->limit && fixed) l->limit = r->limit->value / vs_units_factor(l->unit);
      return true;
    }
  }
  return false;
}

static bool line_at(const vs_frame *frame, const vs_result *r, int n, line *l) {
  *l = (line){.limit = NAN};
  return deck_line_at(frame->deck, &n, l) || own_line_at(&r->scene->ratings, &n, l) ||
         device_line_at(r->watchers.devices, &n, l);
}

static const struct {
  const char *name, *text, *unit;
} NUMBERS[VS_LINE_NUMBERS] = {{"margin", "margin of %s, a part of its limit", ""},
                              {"error", "numerical error of the margin of %s", ""},
                              {"at", "instant of the stress that the margin of %s is of", "s"}};

bool vs_listed_line_is(const char *name) {
  for (int k = 0; k < VS_LINE_NUMBERS; k++) {
    const size_t n = strlen(NUMBERS[k].name);
    if (!strncmp(name, NUMBERS[k].name, n) && name[n] == '.') return true;
  }
  return false;
}

bool vs_listed_line_is_of(const char *number, const vs_judgement *j) {
  const char *name = strchr(number, '.') + 1;
  if (vs_verdict_is_happening(j)) return false;
  if (!j->device) return !strcmp(name, j->name ? j->name : j->probe->name);
  const size_t n = strlen(j->device->name);
  return !strncmp(name, j->device->name, n) && name[n] == '.' &&
         !strcmp(name + n + 1, j->measure->name);
}

const vs_judgement *vs_listed_line_find(const vs_verdict *v, const char *number) {
  const vs_judgement *found = NULL;
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    if (!vs_listed_line_is_of(number, j)) continue;
    if (!found || (j->waived == found->waived ? j->margin < found->margin : found->waived))
      found = j;
  }
  return found;
}

vs_value vs_listed_line_value(const vs_judgement *j, const char *number) {
  const bool is_margin = *number == *NUMBERS[0].name;
  if (!j) return (vs_value){false, NAN, NAN};
  const double value = is_margin                     ? j->margin
                       : *number == *NUMBERS[1].name ? j->margin_error
                                                     : j->stress.at_s;
  return (vs_value){is_margin || !isnan(value), value, NAN};
}

bool vs_listed_line_at(const vs_frame *frame, const vs_result *r, int k, vs_listed_measure *m) {
  const int which = k % VS_LINE_NUMBERS;
  line l;
  if (!line_at(frame, r, k / VS_LINE_NUMBERS, &l)) return false;
  *m = (vs_listed_measure){.unit = NUMBERS[which].unit,
                           .limit = which ? NAN : l.limit,
                           .limit_unit = which ? NULL : l.unit,
                           .at_least = l.at_least,
                           .own = l.own,
                           .unsure = l.unsure,
                           .left_out_by = l.left_out_by,
                           .sense = l.sense,
                           .group = VS_SHOWN_DEVICES,
                           .channel = -1};
  snprintf(m->name, sizeof m->name, "%s.%s", NUMBERS[which].name, l.name);
  snprintf(m->of, sizeof m->of, "%s", l.of);
  snprintf(m->text, sizeof m->text, NUMBERS[which].text, l.name);
  m->value = vs_listed_line_value(vs_listed_line_find(&r->verdict, m->name), m->name);
  return true;
}
