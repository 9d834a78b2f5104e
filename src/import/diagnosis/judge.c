/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnosis/judge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "netlist/expr.h"

static const char *const RULES[] = {"trap", "gear"};

static double peak_of(const vs_attempt *t, int channel) {
  return fmax(fabs(t->least[channel]), fabs(t->largest[channel]));
}

/* ---- the rule ---- */

/* A change of rule pays if it divides the number of steps by this or more; a step by either costs
 * much the same. */
static const double PAYS = 1.5;
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

/* ---- comparators: feedback ---- */

/* Marks the nodes that voltage sources alone connect to ground: no element can move their voltage.
 */
static void mark_fixed(const vs_wiring *w, bool *fixed) {
  bool changed = true;
  fixed[0] = true;
  while (changed) {
    changed = false;
    for (size_t k = 0; k < w->count; k++) {
      const vs_wire *wire = &w->wires[k];
      if (wire->letter != 'v' || fixed[wire->pins[0]] == fixed[wire->pins[1]]) continue;
      fixed[wire->pins[0]] = fixed[wire->pins[1]] = changed = true;
    }
  }
}

/* True where a node that has moved so far affects the element: as a pin, as a controlling node, or
 * through a controlling current. */
static bool feels(const vs_wiring *w, const vs_wire *wire, const bool *moved) {
  for (int k = 0; k < wire->n_pins; k++)
    if (moved[wire->pins[k]]) return true;
  for (int k = 0; k < wire->n_looks; k++)
    if (moved[wire->looks[k]]) return true;
  for (size_t k = 0; k < w->count && wire->law && strstr(wire->law, "i("); k++)
    if (vs_wiring_senses(wire, &w->wires[k]))
      for (int p = 0; p < w->wires[k].n_pins; p++)
        if (moved[w->wires[k].pins[p]]) return true;
  return false;
}

static bool move_pins(const vs_wire *wire, const bool *fixed, bool *moved) {
  bool changed = false;
  for (int p = 0; p < wire->n_pins; p++) {
    int node = wire->pins[p];
    changed = changed || (!fixed[node] && !moved[node]);
    moved[node] = moved[node] || !fixed[node];
  }
  return changed;
}

/* True where the element's effect on its pins comes back to what controls it. */
static bool is_fed_back(const vs_wiring *w, const vs_wire *from) {
  bool *fixed = vs_alloc(w->n_nodes, 1), *moved = vs_alloc(w->n_nodes, 1), found = false;
  mark_fixed(w, fixed);
  bool changed = move_pins(from, fixed, moved);
  while (changed) {
    changed = false;
    for (size_t k = 0; k < w->count; k++)
      if (feels(w, &w->wires[k], moved) && move_pins(&w->wires[k], fixed, moved)) changed = true;
  }
  for (int k = 0; k < from->n_looks; k++) found = found || moved[from->looks[k]];
  for (size_t k = 0; k < w->count && !found; k++)
    if (vs_wiring_senses(from, &w->wires[k]))
      for (int p = 0; p < w->wires[k].n_pins; p++) found = found || moved[w->wires[k].pins[p]];
  free(fixed);
  free(moved);
  return found;
}

/* True where the element is controlled by the voltage across itself. */
static bool looks_at_itself(const vs_wire *wire) {
  return wire->n_looks == 2 && wire->n_pins == 2 && wire->looks[0] == wire->pins[0] &&
         wire->looks[1] == wire->pins[1];
}

static void add(const vs_wiring *w, const vs_wire *wire, const char *text, vs_comparators *all) {
  if (all->count == VS_COMPARATORS_MOST || !is_fed_back(w, wire)) return;
  vs_comparator *c = &all->item[all->count++];
  *c = (vs_comparator){.wire = wire, .own = looks_at_itself(wire)};
  snprintf(c->text, sizeof c->text, "%s", text);
}

/* ---- switches ---- */

static bool is_none(vs_word value) {
  const char *s = value.at;
  while (s < value.at + value.n && strchr("0.+-{}eE", *s)) s++;
  return s == value.at + value.n;
}

/* A switch whose model states no hysteresis, or one of 0. */
static void look_at_switch(const vs_wiring *w, const vs_wire *wire, vs_comparators *all) {
  const bool current = wire->letter == 'w';
  char text[256];
  if (!wire->model || !wire->law) return;
  const vs_word hysteresis = vs_cards_value(w->cards, wire->model, current ? "ih" : "vh"),
                type = wire->model->model;
  vs_word level = vs_cards_value(w->cards, wire->model, current ? "it" : "vt");
  if (!level.n) level = vs_words_of("0");
  snprintf(text, sizeof text, "(%s)-(%.*s)", wire->law, (int)level.n, level.at);
  const bool ideal = vs_words_is(type, "vswitch") || vs_words_is(type, "iswitch");
  if (!ideal && (!hysteresis.n || is_none(hysteresis))) add(w, wire, text, all);
}

/* ---- expressions ---- */

/* Finds comparisons a > b, nested ones too, and arguments of functions that jump. */
static void look_at_law(const vs_wiring *w, const vs_wire *wire, vs_comparators *all) {
  static const char *const JUMPS[] = {"u", "sgn", "stp"};
  vs_expr e;
  char text[256];
  vs_expr_read(&e, vs_words_of(wire->law));
  for (size_t k = 1; k < e.count; k++) {
    const vs_expr_node *n = &e.node[k];
    const vs_word a = e.node[n->child].whole, b = e.node[e.node[n->child].next].whole;
    if (n->kind == VS_EXPR_OPERATOR && strchr("<>", *n->word.at)) {
      snprintf(text, sizeof text, "(%.*s)-(%.*s)", (int)a.n, a.at, (int)b.n, b.at);
      add(w, wire, text, all);
    }
    for (size_t j = 0; j < sizeof JUMPS / sizeof *JUMPS && n->kind == VS_EXPR_CALL; j++) {
      if (!vs_words_is(n->word, JUMPS[j]) || !n->child) continue;
      snprintf(text, sizeof text, "%.*s", (int)a.n, a.at);
      add(w, wire, text, all);
    }
  }
  vs_expr_free(&e);
}

void vs_judge_find_comparators(const vs_wiring *w, vs_comparators *all) {
  all->count = 0;
  for (size_t k = 0; k < w->count && w->whole; k++) {
    const vs_wire *wire = &w->wires[k];
    if (strchr("sw", wire->letter))
      look_at_switch(w, wire, all);
    else if (wire->law && strchr("begrc", wire->letter))
      look_at_law(w, wire, all);
  }
}

/* What to write instead of the element; a part of a sentence. */
static const char *cure_of(const vs_comparator *c) {
  return c->wire->letter == 's'   ? "give its model a hysteresis, as vh=0.1"
         : c->wire->letter == 'w' ? "give its model a hysteresis, as ih=1m"
                                  : "write a slope in the place of the jump, as "
                                    "(1+tanh((a-b)/0.01))/2 for a > b";
}

void vs_judge_note_comparators(const vs_comparators *all, vs_notes *notes) {
  for (size_t k = 0; k < all->count; k++) {
    const vs_comparator *c = &all->item[k];
    if (!c->own || c->wire->letter != 's') continue;
    vs_fail_at(&vs_note_add(notes, "comparator", "warning")->text, vs_wiring_where(c->wire),
               "%s conducts by its own voltage and has no hysteresis: conducting lowers that "
               "voltage, so that it may turn over at every step; %s",
               c->wire->name, cure_of(c));
  }
}

/* ---- comparators: their trials ---- */

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
               cure_of(comparator));
  else if (last)
    vs_fail_at(
        &note->text, where,
        "%s is about to turn over when the run ends at %.9g s, after %ld turns: neither of its "
        "two states may be a solution there; %s",
        comparator->wire->name, t->reached_s, w->crossings, cure_of(comparator));
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
