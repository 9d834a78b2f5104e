/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "hint/judge.h"

#include <math.h>
#include <stdio.h>

static const char *const RULES[] = {"trap", "gear"};

/* ---- the rule ---- */

/* Fewer steps than one in this many are worth a change. */
static const double PAYS = 3;
/* Any number of a run may be off by three times run.tolerance (scene/session.c), so two runs by six
 * times. */
static const double SAME = 6;

/* The largest difference of the trials' extremes, relative to the channel's peak; *worst is the
 * channel, -1: all are alike. */
static double difference(const vs_judge_case *c, int *worst) {
  const vs_tryout *a = c->now, *b = c->other;
  double most = 0;
  int listed[VS_CH_MOST], count = vs_channel_listed(&c->scene->frame, listed);
  *worst = -1;
  for (int n = 0; n < count; n++) {
    int k = listed[n];
    double peak = fmax(fmax(fabs(a->least[k]), fabs(a->largest[k])),
                       fmax(fabs(b->least[k]), fabs(b->largest[k])));
    double off = fmax(fabs(a->least[k] - b->least[k]), fabs(a->largest[k] - b->largest[k]));
    if (peak > 0 && off / peak > most) {
      most = off / peak;
      *worst = k;
    }
  }
  return most;
}

static void add_numbers(const vs_judge_case *c, double off, vs_note *note) {
  vs_note_number_add(note, "until_s", c->now->reached_s);
  vs_note_number_add(note, "steps", (double)c->now->steps);
  vs_note_number_add(note, "rejected", (double)(c->now->tries - c->now->steps));
  vs_note_number_add(note, "processor_s", c->now->processor_s);
  vs_note_number_add(note, "other_steps", (double)c->other->steps);
  vs_note_number_add(note, "other_rejected", (double)(c->other->tries - c->other->steps));
  vs_note_number_add(note, "other_processor_s", c->other->processor_s);
  vs_note_number_add(note, "difference", off);
}

/* The other rule went as far as the present one, or further. */
static void compare(const vs_judge_case *c, vs_notes *notes) {
  const char *now = RULES[c->gear], *other = RULES[!c->gear];
  int worst = -1;
  double off = difference(c, &worst), tolerance = c->scene->setup.run.tolerance;
  double fewer = (double)c->now->steps / (double)(c->other->steps ? c->other->steps : 1);
  bool pays = fewer >= PAYS, same = off <= SAME * tolerance;
  vs_note *note = vs_note_add(notes, "method", pays ? "hint" : "note");
  const char *channel = worst < 0 ? "" : vs_channel_at(&c->scene->frame, worst).name;
  if (pays && same)
    vs_fail(&note->text, VS_OK,
            "run.method: %s takes %ld steps in the place of %ld (%s), %.3g times fewer, with the "
            "same answer: no extreme differs by more than %.2g of its peak (%s), and run.tolerance "
            "is %g",
            other, c->other->steps, c->now->steps, now, fewer, off, channel, tolerance);
  else if (pays)
    vs_fail(&note->text, VS_OK,
            "run.method: %s takes %ld steps in the place of %ld (%s), %.3g times fewer, but %s "
            "differs by %.2g of its peak, and run.tolerance is %g: a smaller run.tolerance tells "
            "which of the two is right",
            other, c->other->steps, c->now->steps, now, fewer, channel, off, tolerance);
  else
    vs_fail(&note->text, VS_OK,
            "run.method: %s would not help: %ld steps in the place of %ld (%s); the extremes "
            "differ by %.2g of a peak at the most%s%s",
            other, c->other->steps, c->now->steps, now, off, worst < 0 ? "" : ", ", channel);
  add_numbers(c, off, note);
}

void vs_judge_method(const vs_judge_case *c, vs_notes *notes) {
  const char *now = RULES[c->gear], *other = RULES[!c->gear];
  vs_note *note;
  if (!c->now->status && !c->other->status && c->other->reached_s >= 0.999 * c->now->reached_s) {
    compare(c, notes);
    return;
  }
  if (c->now->status && !c->other->status)
    vs_fail(&(note = vs_note_add(notes, "method", "hint"))->text, VS_OK,
            "run.method: %s gets to %.4g s in %ld steps, where %s fails: %.300s", other,
            c->other->reached_s, c->other->steps, now, c->now->why);
  else if (c->now->status)
    vs_fail(&(note = vs_note_add(notes, "method", "note"))->text, VS_OK,
            "run.method: %s would not help: both fail, %s: %.300s; %s: %.300s", other, now,
            c->now->why, other, c->other->why);
  else
    vs_fail(&(note = vs_note_add(notes, "method", "note"))->text, VS_OK,
            "run.method: %s would not help: it comes to %.4g s only, in %ld steps%s%.300s", other,
            c->other->reached_s, c->other->steps, *c->other->why ? ": " : "", c->other->why);
  add_numbers(c, NAN, note);
}

/* ---- ringing ---- */

/* So many steps in turn do not go up and down by chance. */
enum { RINGS = 8 };

void vs_judge_ringing(const vs_judge_case *c, vs_notes *notes) {
  int listed[VS_CH_MOST], count = vs_channel_listed(&c->scene->frame, listed), worst = -1;
  for (int n = 0; n < count; n++) {
    const vs_tryout_ring *now = &c->now->ring[listed[n]], *other = &c->other->ring[listed[n]];
    if (now->steps >= RINGS && 4 * other->steps < now->steps &&
        (worst < 0 || now->steps > c->now->ring[worst].steps))
      worst = listed[n];
  }
  if (worst < 0) return;
  const vs_tryout_ring *ring = &c->now->ring[worst];
  const vs_channel channel = vs_channel_at(&c->scene->frame, worst);
  vs_note *note = vs_note_add(notes, "ringing", "hint");
  vs_fail(&note->text, VS_OK,
          "run.method: %s rings: %s goes up and down by %.3g %s from step to step, %ld times until "
          "%.6g s, and with %s it does not (%ld times)",
          RULES[c->gear], channel.name, ring->swing, channel.unit, ring->steps, ring->end_s,
          RULES[!c->gear], c->other->ring[worst].steps);
  vs_note_number_add(note, "turns", (double)ring->steps);
  vs_note_number_add(note, "swing", ring->swing);
  vs_note_number_add(note, "at_s", ring->end_s);
}

/* ---- comparators ---- */

/* So many turns, each within a few steps after the one before, are no commutation. */
enum { CHATTERS = 20 };

static void judge_comparator(const vs_judge_case *c, size_t k, vs_notes *notes) {
  const vs_comparator *comparator = c->watched[k];
  const vs_tryout *t = c->now;
  const vs_tryout_watch *w = &t->watch[k];
  bool chatters = w->close >= CHATTERS;
  bool last = t->status && t->reached_s - w->last_s < 1e-3 * c->scene->setup.timeline.period_s;
  vs_note *note = vs_note_add(notes, "comparator", chatters || last ? "hint" : "note");
  vs_where where = vs_wiring_where(comparator->wire);
  if (chatters)
    vs_fail_at(&note->text, where,
               "%s goes to and fro: it turned over %ld times, %ld of them within four steps after "
               "the time before, from %.6g s to %.6g s; %s",
               comparator->wire->name, w->crossings, w->close, w->first_close_s, w->last_close_s,
               vs_comparator_cure(comparator));
  else if (last)
    vs_fail_at(&note->text, where,
               "%s turned over at %.9g s, just before the run failed at %.9g s; it may be what "
               "fails: %s",
               comparator->wire->name, w->last_s, t->reached_s, vs_comparator_cure(comparator));
  else
    vs_fail_at(&note->text, where,
               "%s has no hysteresis and is fed back, but does not go to and fro: it turned over "
               "%ld times until %.4g s",
               comparator->wire->name, w->crossings, t->reached_s);
  vs_note_number_add(note, "turns", (double)w->crossings);
  vs_note_number_add(note, "close_turns", (double)w->close);
}

void vs_judge_comparators(const vs_judge_case *c, vs_notes *notes) {
  for (size_t k = 0; k < c->n_watched; k++) judge_comparator(c, k, notes);
}
