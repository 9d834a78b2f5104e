/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "branches.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "netlist/cards.h"
#include "netlist/kinds.h"
#include "netlist/words.h"

/* ---- reading ---- */

typedef struct reading {
  vs_branches *b;
  const vs_cards *cards;
  const vs_events *events;
} reading;

static size_t add_signal(vs_branches *b, char *name) {
  b->signals = vs_alloc_grow(b->signals, b->n_signals, sizeof *b->signals);
  b->signals[b->n_signals] = name;
  return b->n_signals++;
}

/* A signal that no circuit has. */
static const char UNKNOWN[] = "i(?)";

/* What ngspice is asked for each end of an element with more than two of them, and of one without a
 * branch of its own among the circuit's vectors. */
static const struct quantity {
  char letter;
  const char *of[VS_BRANCH_ENDS]; /* one alone: it flows from the first end to the second */
} QUANTITIES[] = {{'r', {"i"}},        {'c', {"i"}},
                  {'i', {"current"}},  {'b', {"i"}},
                  {'f', {"i"}},        {'g', {"i"}},
                  {'s', {"i"}},        {'w', {"i"}},
                  {'d', {"id"}},       {'q', {"ic", "ib", "ie"}},
                  {'j', {"id", "ig"}}, {'m', {"id", "ig", "is", "ib"}},
                  {0, {NULL}}};

static const struct quantity *quantities_of(char letter) {
  const struct quantity *q = QUANTITIES;
  while (q->letter && q->letter != letter) q++;
  return q;
}

/* A source whose current is one of the circuit's vectors. */
static bool has_vector(const vs_cards *c, const vs_netlist_card *card) {
  return strchr("vleh", card->letter) || (card->letter == 'b' && vs_cards_value(c, card, "v").n);
}

static bool is_wire(const vs_cards *c, const vs_netlist_card *card) {
  vs_word w = vs_cards_word(c, card, 2);
  if (vs_words_is(w, "dc")) w = vs_cards_word(c, card, 3);
  return card->letter == 'v' && vs_words_is(w, "0");
}

static size_t number_of_node(reading *r, const vs_instance *in, vs_word word) {
  vs_text name = {0};
  size_t number;
  vs_cards_add_node(r->cards, in, word, &name);
  if (!vs_names_find(&r->b->nodes, name.text, name.length, &number)) {
    vs_text signal = {0};
    number = r->b->n_nodes++;
    vs_names_put(&r->b->nodes, name.text, name.length, number);
    vs_text_add(&signal, "v(%s)", name.text);
    add_signal(r->b, signal.text);
  }
  vs_text_free(&name);
  return number;
}

static int number_nodes(void *ctx, const vs_instance *in, size_t k) {
  reading *r = ctx;
  const vs_netlist_card *card = &r->cards->card[k];
  for (size_t n = 0; n < card->nodes; n++) number_of_node(r, in, vs_cards_word(r->cards, card, n));
  return card->letter == 'x' && vs_cards_called(r->cards, card) ? VS_CARDS_ENTER : VS_CARDS_PASS;
}

static void take_top(reading *r, const vs_instance *in, const vs_netlist_card *card) {
  vs_branches *b = r->b;
  b->top = vs_alloc_grow(b->top, b->n_tops, sizeof *b->top);
  vs_branch_top *t = &b->top[b->n_tops++];
  *t = (vs_branch_top){.letter = card->letter, .device = -1, .drive = -1, .event = -1};
  snprintf(t->name, sizeof t->name, "%.*s", (int)card->name.n, card->name.at);
  vs_cursor_lower(t->name);
  for (size_t n = 0; n < card->nodes && n < VS_BRANCH_PINS; n++)
    t->node[t->count++] = number_of_node(r, in, vs_cards_word(r->cards, card, n));
}

/* The signals of an element's currents. */
static void take_currents(reading *r, vs_branch *e, const vs_netlist_card *card) {
  const struct quantity *q = quantities_of(card->letter);
  const bool vector = has_vector(r->cards, card), pair = vector || !q->of[1];
  size_t n = 0;
  if (pair) e->count = e->count < 2 ? e->count : 2;
  for (; n < e->count; n++) {
    vs_text name = {0};
    e->sign[n] = pair && n ? -1 : 1;
    if (pair && n) {
      e->signal[n] = e->signal[0];
      continue;
    }
    if (vector)
      vs_text_add(&name, "i(%s)", e->name);
    else if (q->of[n])
      vs_text_add(&name, "@%s[%s]", e->name, q->of[n]);
    else
      vs_text_add(&name, "%s", UNKNOWN);
    e->signal[n] = add_signal(r->b, name.text);
  }
  if (vector || card->letter != 'b') return;
  vs_text factor = {0};
  vs_text_add(&factor, "@%s[m]", e->name);
  e->factor = add_signal(r->b, factor.text);
}

static int take_element(void *ctx, const vs_instance *in, size_t k) {
  reading *r = ctx;
  vs_branches *b = r->b;
  const vs_netlist_card *card = &r->cards->card[k];
  vs_text name = {0};
  if (!in->outer) take_top(r, in, card);
  if (card->letter == 'x' && vs_cards_called(r->cards, card)) return VS_CARDS_ENTER;
  b->item = vs_alloc_grow(b->item, b->count, sizeof *b->item);
  vs_branch *e = &b->item[b->count++];
  *e = (vs_branch){.letter = card->letter, .top = b->n_tops - 1, .wire = is_wire(r->cards, card)};
  if (in->outer) vs_text_add(&name, "%c.", card->letter);
  vs_cards_add_name(in, card->name, &name);
  e->name = name.text;
  for (size_t n = 0; n < card->nodes && n < VS_BRANCH_ENDS; n++)
    e->node[e->count++] = number_of_node(r, in, vs_cards_word(r->cards, card, n));
  take_currents(r, e, card);
  return VS_CARDS_PASS;
}

/* ---- what people call an element ---- */

/* The number of the event that has put an element of that name into the deck (drive/wiring.h): a
 * letter, "vs_", a letter and the number; -1: none has. */
static int event_of(const char *name, const vs_events *events) {
  if (strncmp(name + 1, "vs_", 3) || !isalpha((unsigned char)name[4])) return -1;
  const int number = isdigit((unsigned char)name[5]) ? atoi(name + 5) : -1;
  return number < (int)events->count ? number : -1;
}

/* True where the device's current is that of the source alone. */
static bool is_sensed(const vs_deck *deck, const vs_device *d, const char *source) {
  char signal[VS_DECK_NAME + 4];
  int term;
  double factor;
  snprintf(signal, sizeof signal, "i(%s)", source);
  return vs_formula_is_term(&d->current, &term, &factor) &&
         !strcmp(deck->terms[term].plus, signal) && !strcmp(deck->terms[term].minus, "v(0)");
}

/* True where the device's voltage is that between the first two pins. */
static bool is_across(const vs_branches *b, const vs_device *d, const vs_branch_top *t) {
  int term;
  double factor;
  if (t->count < 2 || !vs_formula_is_term(&d->voltage, &term, &factor)) return false;
  const char *plus = b->signals[t->node[0]], *minus = b->signals[t->node[1]];
  const vs_term *v = &b->deck->terms[term];
  return (!strcmp(v->plus, plus) && !strcmp(v->minus, minus)) ||
         (!strcmp(v->plus, minus) && !strcmp(v->minus, plus));
}

/* How many instances the deck has of a part. */
static size_t count_instances(const vs_deck *deck, size_t part) {
  const vs_cards *c = vs_deck_cards(deck);
  size_t count = 0;
  for (size_t k = 0; k < c->count; k = vs_cards_next(c, k))
    count += c->card[k].letter == 'x' && vs_words_is(c->card[k].model, deck->parts[part].name);
  return count;
}

/* The subcircuit that an instance of the deck is of, as the deck calls it; no bytes: none. */
static vs_word subcircuit_of(const vs_deck *deck, const vs_branch_top *t) {
  const vs_cards *c = vs_deck_cards(deck);
  for (size_t k = 0; k < c->count && t->letter == 'x'; k = vs_cards_next(c, k))
    if (vs_words_is(c->card[k].name, t->name)) return c->card[k].model;
  return (vs_word){"", 0};
}

/* The device that an element of the circuit is: of its name, or measured by it, or of its part, or
 * a varistor across its nodes. */
static int device_of(const vs_branches *b, const vs_branch_top *t, const char *called,
                     size_t part) {
  const vs_deck *deck = b->deck;
  int of_part = -1, across = -1;
  size_t n_part = 0;
  for (size_t k = 0; k < deck->n_devices; k++) {
    const vs_device *d = &deck->devices[k];
    if (!strcasecmp(d->name, t->name) || is_sensed(deck, d, t->name)) return (int)k;
    if (part < deck->n_parts && d->part == (int)part) of_part = (int)k, n_part++;
    if (d->kind && d->kind->clamps && strcasestr(called, d->kind->name) && is_across(b, d, t))
      across = (int)k;
  }
  return n_part == 1 ? of_part : across;
}

static void name_top(const vs_branches *b, vs_branch_top *t, const vs_events *events) {
  const vs_deck *deck = b->deck;
  const vs_word of = subcircuit_of(deck, t);
  char *called = vs_alloc_part(of.at, of.n);
  size_t part = 0;
  while (part < deck->n_parts && strcasecmp(deck->parts[part].name, called)) part++;
  if (part < deck->n_parts && count_instances(deck, part) > 1) part = deck->n_parts;
  t->device = device_of(b, t, called, part);
  free(called);
  t->event = event_of(t->name, events);
  for (size_t p = 0; p < deck->n_ports; p++)
    if (!strcmp(deck->ports[p].source, t->name)) t->drive = deck->ports[p].signal.drive;
  if (t->drive != VS_PORT_MAINS && t->drive != VS_PORT_EVENT) t->drive = -1;
  const char *label = t->name;
  if (part < deck->n_parts) label = deck->parts[part].name;
  if (!strcmp(t->name, deck->eva)) label = "the coil";
  if (t->device >= 0) label = deck->devices[t->device].name;
  if (t->event >= 0) label = events->item[t->event].name;
  if (t->drive == VS_PORT_MAINS) label = "the mains";
  snprintf(t->label, sizeof t->label, "%s", label);
}

/* An instance that alone lies in series with the source that measures a device is the device's
 * body, and has its name. */
static void name_body(vs_branches *b, const vs_branch_top *source) {
  if (source->letter != 'v' || source->device < 0) return;
  for (size_t p = 0; p < source->count; p++) {
    vs_branch_top *beside = NULL;
    size_t others = 0;
    for (size_t k = 0; k < b->n_tops; k++)
      for (size_t n = 0; n < b->top[k].count && &b->top[k] != source; n++)
        if (b->top[k].node[n] == source->node[p]) beside = &b->top[k], others++;
    if (others != 1 || beside->letter != 'x' || beside->device >= 0) continue;
    beside->device = source->device;
    memcpy(beside->label, source->label, sizeof beside->label);
  }
}

void vs_branches_read(const vs_circuit_job *job, const vs_deck *deck, const vs_events *events,
                      vs_branches *b) {
  vs_line *lines = vs_alloc(job->lines + 1, sizeof *lines);
  vs_cards cards = {0};
  reading r = {b, &cards, events};
  for (size_t k = 0; k < job->lines; k++) lines[k].text = job->netlist[k];
  if (job->lines) lines[0].text = "*";
  vs_cards_read(&cards, lines, job->lines);
  *b = (vs_branches){.deck = deck};
  vs_instance whole = {0};
  number_of_node(&r, &whole, vs_words_of("0"));
  vs_cards_expand(&cards, number_nodes, &r);
  vs_cards_expand(&cards, take_element, &r);
  for (size_t k = 0; k < b->n_tops; k++) name_top(b, &b->top[k], events);
  for (size_t k = 0; k < b->n_tops; k++) name_body(b, &b->top[k]);
  vs_cards_free(&cards);
  free(lines);
}

void vs_branches_free(vs_branches *b) {
  for (size_t k = 0; k < b->count; k++) free(b->item[k].name);
  for (size_t k = 0; k < b->n_signals; k++) free(b->signals[k]);
  vs_names_free(&b->nodes);
  free(b->item);
  free(b->top);
  free(b->signals);
  *b = (vs_branches){0};
}

size_t vs_branches_signal(const vs_branches *b, const char *name) {
  size_t k = 0;
  while (k < b->n_signals && strcmp(b->signals[k], name)) k++;
  return k;
}

/* ---- shares ---- */

/* Behind the name of a part, of the current of a capacitor within it. */
static const char CAPACITANCE[] = "'s capacitance";

static void add_share(vs_shares *s, const char *of, double value) {
  size_t k = 0;
  while (k < s->count && strcmp(s->item[k].of, of)) k++;
  if (k == VS_SHARES_MOST) {
    k--;
    snprintf(s->item[k].of, sizeof s->item[k].of, "others");
  } else if (k == s->count) {
    s->item[s->count++].value = 0;
    snprintf(s->item[k].of, sizeof s->item[k].of, "%s", of);
  }
  s->item[k].value += value;
}

static int by_size(const void *left, const void *right) {
  const double a = fabs(((const vs_share *)left)->value),
               b = fabs(((const vs_share *)right)->value);
  return (a < b) - (a > b);
}

/* What flows to and fro between a part and its own capacitance is no share of either. */
static void join_capacitances(vs_shares *s) {
  for (size_t k = 0; k < s->count; k++)
    for (size_t n = 0; n < s->count; n++) {
      const size_t length = strlen(s->item[k].of);
      if (strncmp(s->item[n].of, s->item[k].of, length) ||
          strcmp(s->item[n].of + length, CAPACITANCE) || s->item[k].value * s->item[n].value >= 0)
        continue;
      s->item[k].value += s->item[n].value;
      s->item[n] = s->item[--s->count];
      k = 0;
      n = SIZE_MAX;
    }
}

/* ---- a current ---- */

/* The current into end n of a branch. */
static double into_end(const vs_branch *e, size_t n, const double *signals) {
  return e->sign[n] * signals[e->signal[n]];
}

/* Ends of field-effect transistors: ngspice tells the currents of their channels and junctions, and
 * those of the gate's capacitances only in sum. So each is what Kirchhoff's law leaves, at its node
 * or of its element, where it is the only one there that is not known. */
typedef struct unknown_ends {
  const vs_branches *b;
  double *signals;
  bool *known; /* [n_signals] */
  /* of the node or element that is looked at */
  double sum;    /* of the currents that are known */
  size_t signal; /* of an end that is not known */
  size_t count;  /* of such ends */
} unknown_ends;

static void count_end(unknown_ends *u, const vs_branch *e, size_t n) {
  if (u->known[e->signal[n]])
    u->sum += into_end(e, n, u->signals);
  else
    u->signal = e->signal[n], u->count++;
}

/* Gives the only end that is not known what the others leave for it, and begins anew. */
static bool solve(unknown_ends *u) {
  const bool solved = u->count == 1 && isfinite(u->sum);
  if (solved) {
    u->signals[u->signal] = -u->sum;
    u->known[u->signal] = true;
  }
  u->sum = 0;
  u->count = 0;
  return solved;
}

static bool solve_node(unknown_ends *u, size_t node) {
  for (size_t k = 0; k < u->b->count; k++)
    for (size_t n = 0; n < u->b->item[k].count; n++)
      if (u->b->item[k].node[n] == node) count_end(u, &u->b->item[k], n);
  return solve(u);
}

static bool solve_element(unknown_ends *u, const vs_branch *e) {
  for (size_t n = 0; n < e->count; n++) count_end(u, e, n);
  return solve(u);
}

static void solve_ends(const vs_branches *b, double *signals) {
  unknown_ends u = {.b = b, .signals = signals, .known = vs_alloc(b->n_signals, sizeof(bool))};
  bool some = false;
  memset(u.known, true, b->n_signals * sizeof *u.known);
  for (size_t k = 0; k < b->count; k++)
    for (size_t n = 0; b->item[k].letter == 'm' && n < b->item[k].count; n++)
      some = true, u.known[b->item[k].signal[n]] = false;
  for (bool found = some; found;) {
    found = false;
    for (size_t node = 1; node < b->n_nodes; node++) found = solve_node(&u, node) || found;
    for (size_t k = 0; k < b->count; k++)
      if (b->item[k].letter == 'm') found = solve_element(&u, &b->item[k]) || found;
  }
  free(u.known);
}

void vs_branches_complete(const vs_branches *b, double *signals) {
  for (size_t k = 0; k < b->count; k++)
    if (b->item[k].factor) signals[b->item[k].signal[0]] *= signals[b->item[k].factor];
  solve_ends(b, signals);
}

/* The current out of a set of nodes into a branch. */
static double into_branch(const vs_branch *e, const bool *set, const double *signals) {
  double a = 0;
  for (size_t n = 0; n < e->count; n++)
    if (set[e->node[n]]) a += into_end(e, n, signals);
  return a;
}

/* The current out of a set of nodes into an element of the circuit itself. */
static double into_top(const vs_branches *b, size_t top, const bool *set, const double *signals) {
  double a = 0;
  for (size_t k = 0; k < b->count; k++)
    if (b->item[k].top == top) a += into_branch(&b->item[k], set, signals);
  return a;
}

/* How many ends a branch has within the set. */
static size_t ends_within(const vs_branch *e, const bool *set) {
  size_t within = 0;
  for (size_t n = 0; n < e->count; n++) within += set[e->node[n]];
  return within;
}

static bool is_passed(const vs_branches *b, const vs_branch_top *t, const vs_branch *only) {
  const vs_kind *kind = t->device < 0 ? NULL : b->deck->devices[t->device].kind;
  return (only && only->wire) || (t->letter == 'x' && kind && kind->melts);
}

/* Takes all nodes of an element into the set, those within it too. Returns true if one is new. */
static bool take_nodes(const vs_branches *b, size_t top, bool *set) {
  bool grown = false;
  for (size_t n = 0; n < b->count; n++)
    for (size_t e = 0; b->item[n].top == top && e < b->item[n].count; e++) {
      const size_t node = b->item[n].node[e];
      grown = grown || (node && !set[node]);
      if (node) set[node] = true;
    }
  return grown;
}

/* True for an element at the set that a current may be followed through: not the device itself, nor
 * one to a node that is barred. */
static bool leads_on(const vs_branch_top *t, const bool *set, const bool *barred) {
  bool touches = false, may = true, all = true;
  for (size_t n = 0; n < t->count; n++) {
    const bool within = set[t->node[n]];
    touches = touches || within;
    all = all && within;
    may = may && (within || !barred[t->node[n]]);
  }
  return touches && may && !all;
}

/* The only element besides the device that has nodes inside of the set and outside; n_tops: there
 * are more, or none. */
static size_t only_way(const vs_branches *b, size_t device, const bool *set) {
  size_t found = b->n_tops, count = 0;
  for (size_t k = 0; k < b->count; k++) {
    const size_t within = ends_within(&b->item[k], set);
    if (b->item[k].top == device || !within || within == b->item[k].count) continue;
    count += found != b->item[k].top;
    found = b->item[k].top;
  }
  return count == 1 ? found : b->n_tops;
}

/* Takes the nodes that are the same as those of the set but for a source of 0 V or a fuse, or that
 * a resistor or inductor alone leads to; never through the device itself, nor to its other
 * terminals, nor to ground. */
static void grow(const vs_branches *b, size_t device, bool *set) {
  bool *barred = vs_alloc(b->n_nodes, sizeof *barred);
  barred[0] = true;
  for (size_t n = 0; n < b->top[device].count; n++) barred[b->top[device].node[n]] = true;
  for (bool grown = true; grown;) {
    grown = false;
    for (size_t k = 0; k < b->n_tops; k++) {
      const vs_branch *only = NULL;
      for (size_t n = 0; n < b->count; n++)
        if (b->item[n].top == k) only = &b->item[n];
      if (k != device && leads_on(&b->top[k], set, barred) && is_passed(b, &b->top[k], only))
        grown = take_nodes(b, k, set) || grown;
    }
    const size_t way = grown ? b->n_tops : only_way(b, device, set);
    if (way < b->n_tops && strchr("rl", b->top[way].letter) && leads_on(&b->top[way], set, barred))
      grown = take_nodes(b, way, set);
  }
  free(barred);
}

/* The way of a current through elements in series. */
enum { CHAIN = 8 };
typedef struct chain {
  const vs_branches *b;
  const double *signals;
  size_t device; /* the element that is not passed */
  size_t top[CHAIN], count;
  vs_shares *shares;
  size_t unknown; /* currents that are not known */
  char missing[2 * VS_DECK_NAME + 16];
} chain;

/* "the mains", "c1", "varistor_1's capacitance": what a chain is called that ends in a branch. What
 * drives or holds a charge is told before what it is in series with. */
static void name_chain(const chain *c, const vs_branch *last, char *name, size_t size) {
  const vs_branches *b = c->b;
  const vs_branch_top *best = &b->top[last->top];
  for (size_t k = 0; k < c->count; k++) {
    const vs_branch_top *t = &b->top[c->top[k]];
    if (t->event >= 0 || t->drive == VS_PORT_MAINS) best = t;
  }
  for (size_t k = c->count; k-- > 0 && best->device < 0 && best->event < 0 && best->drive < 0 &&
                            strcmp(best->label, "the coil");)
    best = &b->top[c->top[k]];
  const bool inner = last->letter == 'c' && best->letter == 'x' && best == &b->top[last->top];
  snprintf(name, size, "%s%s", best->label, inner ? CAPACITANCE : "");
}

/* Follows the current of a branch, which flows from `node` into it. */
static void follow(chain *c, const vs_branch *e, size_t node, double a) {
  const vs_branches *b = c->b;
  char name[2 * VS_DECK_NAME + 16];
  size_t far = 0, others = 0, own = 0, before = c->count;
  const vs_branch *next = NULL;
  if (c->count < CHAIN) c->top[c->count++] = e->top;
  if (e->count == 2) far = e->node[0] == node ? e->node[1] : e->node[0];
  for (size_t k = 0; far && k < b->count; k++)
    for (size_t n = 0; n < b->item[k].count; n++)
      if (&b->item[k] != e && b->item[k].node[n] == far) {
        next = &b->item[k];
        own += b->item[k].top == e->top && b->item[k].top != c->device;
        others++;
      }
  const bool goes_on = far && others && strchr("rlv", e->letter) && c->count < CHAIN;
  if (goes_on && others == 1 && next->top != c->device) {
    follow(c, next, far, a);
  } else if (goes_on && own == others) { /* it parts within a subcircuit */
    bool *set = vs_alloc(b->n_nodes, sizeof *set);
    set[far] = true;
    for (size_t k = 0; k < b->count; k++)
      if (&b->item[k] != e && ends_within(&b->item[k], set))
        follow(c, &b->item[k], far, into_branch(&b->item[k], set, c->signals));
    free(set);
  } else {
    name_chain(c, e, name, sizeof name);
    if (isnan(a)) {
      c->unknown++;
      snprintf(c->missing, sizeof c->missing, "%s", name);
    } else {
      add_share(c->shares, name, -a);
    }
  }
  c->count = before;
}

size_t vs_branches_device(const vs_branches *b, int device, size_t *node) {
  for (size_t k = 0; k < b->n_tops; k++) {
    const vs_branch_top *t = &b->top[k];
    if (t->device != device || t->letter != 'v') continue;
    *node = t->node[t->node[0] == 0];
    return k;
  }
  size_t k = 0;
  for (; k < b->n_tops; k++) {
    const vs_branch_top *t = &b->top[k];
    bool at = false;
    for (size_t n = 0; n < t->count; n++) at = at || t->node[n] == *node;
    if (at && t->device == device) return k;
  }
  return k;
}

size_t vs_branches_coil(const vs_branches *b) {
  size_t k = 0;
  while (k < b->n_tops && strcmp(b->top[k].name, b->deck->eva)) k++;
  return k;
}

double vs_branches_current(const vs_branches *b, const double *signals, size_t top, size_t node) {
  bool *set = vs_alloc(b->n_nodes, sizeof *set);
  set[node] = true;
  const double a = into_top(b, top, set, signals);
  free(set);
  return a;
}

/* What flows into the device besides what its formula in the deck counts, as into a capacitance
 * beside the law of a varistor. */
static void share_beside(chain *c, const bool *set, double a) {
  const vs_branches *b = c->b;
  char name[2 * VS_DECK_NAME + 16];
  const double whole = into_top(b, c->device, set, c->signals);
  if (!(fabs(whole - a) > 1e-6 * fabs(a))) return;
  for (size_t k = 0; k < b->count; k++)
    if (b->item[k].top == c->device && b->item[k].letter == 'c' &&
        b->top[c->device].letter == 'x') {
      snprintf(name, sizeof name, "%s's own capacitance", b->top[c->device].label);
      add_share(c->shares, name, -into_branch(&b->item[k], set, c->signals));
    }
}

bool vs_branches_share_current(const vs_branches *b, const double *signals, size_t top, size_t node,
                               double a, vs_shares *shares) {
  chain c = {.b = b, .signals = signals, .shares = shares};
  shares->count = 0;
  c.device = top;
  if (top == b->n_tops || !node) return false;
  bool *set = vs_alloc(b->n_nodes, sizeof *set);
  set[node] = true;
  grow(b, c.device, set);
  for (size_t k = 0; k < b->count; k++) {
    const vs_branch *e = &b->item[k];
    const size_t within = ends_within(e, set);
    if (e->top == c.device || !within || within == e->count) continue;
    size_t n = 0;
    while (!set[e->node[n]]) n++;
    follow(&c, e, e->node[n], into_branch(e, set, signals));
  }
  join_capacitances(shares);
  share_beside(&c, set, a);
  double sum = 0;
  for (size_t k = 0; k < shares->count; k++) sum += shares->item[k].value;
  if (c.unknown == 1) add_share(shares, c.missing, a - sum);
  free(set);
  qsort(shares->item, shares->count, sizeof *shares->item, by_size);
  return c.unknown < 2 && shares->count;
}

/* ---- a voltage ---- */

/* How reluctantly a loop goes through an element: what carries the mains' current goes before what
 * stands beside it, and a source of current is no way at all. */
static double reluctance(const vs_branches *b, const vs_branch_top *t) {
  const vs_kind *kind = t->device < 0 ? NULL : b->deck->devices[t->device].kind;
  if (kind && (kind->clamps || kind->stores)) return 100;
  if (kind && (kind->switches || kind->gated)) return 10;
  if (!strcmp(t->name, b->deck->eva)) return 0.5; /* before a resistor beside it */
  switch (t->letter) {
  case 'v':
    return 0.1;
  case 'r':
  case 'l':
    return 1;
  case 'x':
    return 2;
  case 'c':
    return 50;
  default:
    return 60;
  }
}

/* What led to a node on the shortest way there. */
typedef struct way {
  double length;
  bool done;
  size_t top, from;
} way;

/* Dijkstra's shortest ways from a node to all others, through elements and nodes that are not
 * barred. */
static void find_ways(const vs_branches *b, const bool *barred, const bool *closed, size_t from,
                      way *w) {
  const size_t n = b->n_nodes;
  for (size_t k = 0; k < n; k++) w[k] = (way){.length = INFINITY};
  w[from].length = 0;
  for (;;) {
    size_t at = n;
    for (size_t k = 0; k < n; k++)
      if (!w[k].done && isfinite(w[k].length) && (at == n || w[k].length < w[at].length)) at = k;
    if (at == n) return;
    w[at].done = true;
    for (size_t k = 0; k < b->n_tops; k++) {
      const vs_branch_top *t = &b->top[k];
      const double length = w[at].length + reluctance(b, t);
      bool touches = false;
      for (size_t p = 0; p < t->count; p++) touches = touches || t->node[p] == at;
      for (size_t p = 0; touches && !barred[k] && p < t->count; p++)
        if (!closed[t->node[p]] && length < w[t->node[p]].length)
          w[t->node[p]] = (way){length, false, k, at};
    }
  }
}

/* A search for a loop. */
typedef struct loop {
  const vs_branches *b;
  const double *signals;
  bool *barred, *closed; /* elements and nodes that no way leads through; owned */
  vs_shares *shares;
} loop;

/* Adds the voltages along the shortest way, and closes its nodes. Returns its length; INFINITY:
 * there is none. */
static double take_way(loop *l, size_t from, size_t to) {
  const vs_branches *b = l->b;
  way *w = vs_alloc(b->n_nodes, sizeof *w);
  const bool closed = l->closed[to];
  l->closed[to] = false;
  find_ways(b, l->barred, l->closed, from, w);
  l->closed[to] = closed;
  const double length = w[to].length;
  for (size_t at = to; isfinite(length); at = w[at].from) {
    l->closed[at] = true;
    if (at == from) break;
    add_share(l->shares, b->top[w[at].top].label, l->signals[w[at].from] - l->signals[at]);
  }
  free(w);
  return length;
}

/* The loop through the source, entered at its pin `first`: the way to it, it, and the way from it,
 * which may not meet. */
static double try_loop(loop *l, size_t plus, size_t minus, const vs_branch_top *source,
                       size_t first) {
  const size_t in = source->node[first], out = source->node[!first];
  memset(l->closed, 0, l->b->n_nodes * sizeof *l->closed);
  l->shares->count = 0;
  l->closed[minus] = l->closed[out] = true;
  if (in == minus || out == plus) return INFINITY;
  double length = take_way(l, plus, in);
  if (!isfinite(length)) return INFINITY;
  add_share(l->shares, source->label, l->signals[in] - l->signals[out]);
  return length + take_way(l, out, minus);
}

bool vs_branches_share_voltage(const vs_branches *b, const double *signals, int device, int event,
                               size_t plus, size_t minus, vs_shares *shares) {
  vs_shares own;
  loop l = {b, signals, vs_alloc(b->n_tops + 1, sizeof(bool)), vs_alloc(b->n_nodes, sizeof(bool)),
            &own};
  size_t source = b->n_tops;
  double best = INFINITY;
  for (size_t k = 0; k < b->n_tops; k++) {
    const vs_branch_top *t = &b->top[k];
    size_t ends = 0;
    for (size_t p = 0; p < t->count; p++) ends += t->node[p] == plus || t->node[p] == minus;
    l.barred[k] = ends > 1 || (device >= 0 && t->device == device);
    if (t->drive == VS_PORT_MAINS && source == b->n_tops) source = k;
    if (t->drive == VS_PORT_EVENT && event >= 0 && t->event == event) source = k;
  }
  for (size_t first = 0; first < 2 && source < b->n_tops; first++) {
    l.barred[source] = true;
    const double length = try_loop(&l, plus, minus, &b->top[source], first);
    if (length < best) best = length, *shares = own;
  }
  if (!isfinite(best)) {
    memset(l.closed, 0, b->n_nodes * sizeof *l.closed);
    own.count = 0;
    if (source < b->n_tops) l.barred[source] = false;
    best = take_way(&l, plus, minus);
    *shares = own;
  }
  free(l.barred);
  free(l.closed);
  qsort(shares->item, shares->count, sizeof *shares->item, by_size);
  return isfinite(best) && shares->count;
}
