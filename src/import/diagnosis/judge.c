/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnosis/judge.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const RULES[] = {"trap", "gear"};

static double peak_of(const vs_attempt *t, int channel) {
  return fmax(fabs(t->least[channel]), fabs(t->largest[channel]));
}

/* ---- the rule ---- */

/* A change of rule pays if it divides the number of steps by this or more. */
static const double PAYS = 3;
/* Each number of a run may be off by three times run.tolerance (run/session.c), so two runs may
 * differ by six times. */
static const double SAME = 6;

/* Where the present rule fails, the other one helps if it gets this many times as far. */
static const double FURTHER = 1.1;

/* True for a channel whose error run.tolerance bounds at each instant: motion, force and the coil's
 * current. The deck's own quantities may jump, and the trapezoidal rule's ringing shows there
 * first. */
static bool is_bounded(const vs_judge_case *c, int channel) {
  return channel != VS_CH_V_EVA && channel != VS_CH_V_MAINS &&
         channel < vs_channel_deck(c->scene->frame.model);
}

/* A voltage below this, V, is only the error of the solver's iteration: its absolute tolerance of
 * voltages at run.tolerance = 1e-4 (engine/coupled/pace.c). */
static const double NO_VOLTAGE_V = 1e-4;

static bool has_no_voltage(const vs_judge_case *c, int channel) {
  return fmax(peak_of(c->now, channel), peak_of(c->other, channel)) < NO_VOLTAGE_V;
}

/* True for a channel that shows rounding alone: a voltage that is practically 0, or anything about
 * a coil without voltage. */
static bool is_idle(const vs_judge_case *c, int channel) {
  if (is_bounded(c, channel)) return has_no_voltage(c, VS_CH_V_EVA);
  return !strcmp(vs_channel_at(&c->scene->frame, channel).unit, "V") && has_no_voltage(c, channel);
}

/* The largest difference of the two trials' extremes, relative to the channel's peak. */
typedef struct gap {
  double bounded, other;  /* of channels that run.tolerance bounds, and of the others */
  int which, which_other; /* the channels; -1: all are alike */
} gap;

static gap compare_extremes(const vs_judge_case *c) {
  const vs_attempt *a = c->now, *b = c->other;
  gap g = {.which = -1, .which_other = -1};
  int listed[VS_CH_MOST], count = vs_channel_listed(&c->scene->frame, listed);
  for (int n = 0; n < count; n++) {
    int k = listed[n];
    double peak = fmax(peak_of(a, k), peak_of(b, k));
    double off = fmax(fabs(a->least[k] - b->least[k]), fabs(a->largest[k] - b->largest[k])) / peak;
    if (!(peak > 0) || is_idle(c, k)) continue;
    if (is_bounded(c, k) && off > g.bounded) g.bounded = off, g.which = k;
    if (!is_bounded(c, k) && off > g.other) g.other = off, g.which_other = k;
  }
  return g;
}

static const char *name_of(const vs_judge_case *c, int channel) {
  return channel < 0 ? "none" : vs_channel_at(&c->scene->frame, channel).name;
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

/* Compares the two rules, where the other one went at least as far as the present one. */
static void compare(const vs_judge_case *c, vs_notes *notes) {
  const gap g = compare_extremes(c);
  double tolerance = c->scene->setup.run.tolerance;
  double fewer = (double)c->now->steps / (double)(c->other->steps ? c->other->steps : 1);
  bool pays = fewer >= PAYS, same = g.bounded <= SAME * tolerance;
  vs_note *note = vs_note_add(notes, "method", pays || !same ? "hint" : "note");
  vs_text text = {0};
  vs_text_add(&text, "run.method: %s %s %ld steps in the place of %ld", RULES[!c->gear],
              pays   ? "takes"
              : same ? "would not help:"
                     : "gives something else, in",
              c->other->steps, c->now->steps);
  if (pays) vs_text_add(&text, ", %.3g times fewer", fewer);
  vs_text_add(&text,
              "; motion, force and current have %s extremes: they differ by %.2g of a peak (%s), "
              "run.tolerance is %g%s",
              same ? "the same" : "other", g.bounded, name_of(c, g.which), tolerance,
              same ? "" : ": a finer one may tell which is right");
  if (g.other > SAME * tolerance)
    vs_text_add(&text, "; %s differs by %.2g of its peak: a finer run.tolerance may tell why",
                name_of(c, g.which_other), g.other);
  vs_fail(&note->text, VS_OK, "%s", text.text);
  vs_text_free(&text);
  add_numbers(c, g.bounded, note);
  vs_note_number_add(note, "other_difference", g.other);
}

void vs_judge_method(const vs_judge_case *c, vs_notes *notes) {
  const char *now = RULES[c->gear], *other = RULES[!c->gear];
  vs_note *note;
  if (!c->now->status && !c->other->status && c->other->reached_s >= 0.999 * c->now->reached_s) {
    compare(c, notes);
    return;
  }
  if (c->now->status && !c->other->status && c->other->reached_s > FURTHER * c->now->reached_s)
    vs_fail(&(note = vs_note_add(notes, "method", "hint"))->text, VS_OK,
            "run.method: %s gets to %.4g s in %ld steps, where %s fails: %.300s", other,
            c->other->reached_s, c->other->steps, now, c->now->why);
  else if (c->now->status)
    vs_fail(&(note = vs_note_add(notes, "method", "note"))->text, VS_OK,
            "run.method: %s would not help: %s fails (%.300s), and %s comes to %.6g s%s%.300s",
            other, now, c->now->why, other, c->other->reached_s, *c->other->why ? ": " : "",
            c->other->why);
  else
    vs_fail(&(note = vs_note_add(notes, "method", "note"))->text, VS_OK,
            "run.method: %s would not help: it comes to %.4g s only, in %ld steps%s%.300s", other,
            c->other->reached_s, c->other->steps, *c->other->why ? ": " : "", c->other->why);
  add_numbers(c, NAN, note);
}

/* ---- ringing ---- */

/* This many alternating steps are no coincidence; a swing below a thousandth of the channel's peak
 * does not matter. */
enum { RINGS = 8 };

void vs_judge_ringing(const vs_judge_case *c, vs_notes *notes) {
  int listed[VS_CH_MOST], count = vs_channel_listed(&c->scene->frame, listed), worst = -1;
  for (int n = 0; n < count; n++) {
    const vs_attempt_ring *now = &c->now->ring[listed[n]], *other = &c->other->ring[listed[n]];
    if (now->steps >= RINGS && !is_idle(c, listed[n]) &&
        now->swing > 1e-3 * peak_of(c->now, listed[n]) && 4 * other->steps < now->steps &&
        (worst < 0 || now->steps > c->now->ring[worst].steps))
      worst = listed[n];
  }
  if (worst < 0) return;
  const vs_attempt_ring *ring = &c->now->ring[worst];
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

/* This many turns, each within a few steps of the last, cannot be a commutation. */
enum { CHATTERS = 20 };

/* True where the run ended with the comparator within a hundredth of its switching point. */
static bool is_at_edge(const vs_attempt_watch *w) {
  return fabs(w->last) <= 1e-2 * w->largest;
}

/* True where ngspice's message about its failure names the element's place. */
static bool is_named(const char *why, const vs_wire *wire) {
  vs_error place = {0};
  vs_fail_at(&place, vs_wiring_where(wire), "%s", "");
  char at[sizeof place.text];
  snprintf(at, sizeof at, "(%.*s)", place.place_size - 2, place.text);
  return strstr(why, at) != NULL;
}

static void judge_comparator(const vs_judge_case *c, size_t k, vs_notes *notes) {
  const vs_comparator *comparator = c->watched[k];
  const vs_attempt *t = c->now;
  const vs_attempt_watch *w = &t->watch[k];
  bool chatters = w->close >= CHATTERS;
  bool last = (t->status || t->cut) && (is_at_edge(w) || is_named(t->why, comparator->wire));
  vs_note *note = vs_note_add(notes, "comparator", chatters || last ? "hint" : "note");
  vs_where where = vs_wiring_where(comparator->wire);
  if (chatters)
    vs_fail_at(&note->text, where,
               "%s goes to and fro: it turned over %ld times, %ld of them within four steps after "
               "the time before, from %.6g s to %.6g s; %s",
               comparator->wire->name, w->crossings, w->close, w->first_close_s, w->last_close_s,
               vs_comparator_cure(comparator));
  else if (last)
    vs_fail_at(
        &note->text, where,
        "%s is about to turn over when the run ends at %.9g s, after %ld turns: neither of its "
        "two states may be a solution there; %s",
        comparator->wire->name, t->reached_s, w->crossings, vs_comparator_cure(comparator));
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
