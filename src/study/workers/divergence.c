/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/divergence.h"

#include <math.h>
#include <string.h>

#include "engine/events.h"
#include "engine/signals.h"

const double vs_divergence_near_s = 1e-9;

/* The first edge behind t, or the run's end where that comes before it. */
static double stretch_end(const vs_setup *s, double t_s) {
  return fmin(vs_setup_edge(s, t_s + vs_divergence_near_s), s->run.until_s);
}

static bool agree_at(const vs_setup *a, const vs_setup *b, double t_s) {
  bool same =
      vs_events_longest(&a->timeline.events, t_s) == vs_events_longest(&b->timeline.events, t_s);
  for (size_t k = 0; k < a->deck.n_ports && same; k++) {
    const vs_signal *s = &a->deck.ports[k].signal;
    same = vs_signals_voltage(&a->timeline, s, t_s) == vs_signals_voltage(&b->timeline, s, t_s);
  }
  return same;
}

/* Between two edges what drives a circuit is smooth, or a wave that decays. So two that differ
 * there do so near the beginning, if they ever do; these are the instants asked for, each half as
 * far behind the beginning as the one before it. */
enum { INSTANTS = 36 };

static bool agree_between(const vs_setup *a, const vs_setup *b, double from_s, double to_s) {
  double behind_s = to_s - from_s;
  for (int k = 0; k < INSTANTS; k++, behind_s /= 2)
    if (!agree_at(a, b, from_s + behind_s)) return false;
  return true;
}

static bool same_event(const vs_scene_event *a, const vs_scene_event *b) {
  return a->kind == b->kind && a->start_s == b->start_s && a->end_s == b->end_s &&
         !memcmp(&a->v, &b->v, sizeof a->v);
}

/* When an event first does something to the machine, s. That is done at the end of a step, so that
 * the runs part at the edge before it. */
static double moves_s(const vs_scene_event *e) {
  return e->kind->jams || e->kind->load ? e->start_s : INFINITY;
}

static bool move_alike(const vs_events *a, const vs_events *b, double to_s) {
  for (size_t k = 0; k < a->count; k++)
    if (!same_event(&a->item[k], &b->item[k]) &&
        fmin(moves_s(&a->item[k]), moves_s(&b->item[k])) <= to_s + vs_divergence_near_s)
      return false;
  return true;
}

/* When a generator's network first comes onto the line in one of the two and not in the other. */
static double on_line_s(const vs_scene_event *a, const vs_scene_event *b) {
  return a->on_line_s == b->on_line_s ? INFINITY : fmin(a->on_line_s, b->on_line_s);
}

/* When the first of the events begins that is not the same in both; INFINITY: there is none. */
static double first_difference(const vs_events *a, const vs_events *b) {
  double first_s = INFINITY;
  for (size_t k = 0; k < a->count; k++)
    if (!same_event(&a->item[k], &b->item[k]))
      first_s = fmin(first_s, fmin(fmin(a->item[k].start_s, b->item[k].start_s),
                                   on_line_s(&a->item[k], &b->item[k])));
  return first_s;
}

static double parting_behind(const vs_setup *a, const vs_setup *b, double t_s) {
  for (double to_s; t_s < a->run.until_s; t_s = to_s) {
    to_s = stretch_end(a, t_s);
    if (stretch_end(b, t_s) != to_s ||
        !move_alike(&a->timeline.events, &b->timeline.events, to_s) ||
        !agree_between(a, b, t_s, to_s))
      return t_s;
  }
  return INFINITY;
}

/* An event does nothing before it begins, or before its network comes onto the line. So a cycle
 * before the first difference the two agree, and where there is an edge in that cycle, what was
 * before need not be looked at. */
double vs_divergence_of(const vs_setup *a, const vs_setup *b) {
  double differ_s = first_difference(&a->timeline.events, &b->timeline.events);
  double from_s = fmax(differ_s - a->timeline.period_s, 0);
  if (isinf(differ_s)) return INFINITY;
  double parts_s = parting_behind(a, b, from_s);
  return parts_s == from_s && from_s > 0 ? parting_behind(a, b, 0) : parts_s;
}
