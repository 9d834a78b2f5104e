/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of events in the plant: an element of the deck opens or is shorted, the coil's turns are
 * shorted, the armature is stuck, the load changes. */
#include "engine/scene_event.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "drive/wiring.h"
#include "netlist/cards.h"
#include "netlist/kinds.h"

/* ---- keys ---- */

#define ELEMENT                                                                                    \
  {                                                                                                \
    "element", VS_NAME, "", "-", 0, 0, false, VS_EVENT_V_(element),                                \
        "the deck's, of two nodes: R1, Xeva, Xf2", NULL, NULL                                      \
  }

static const vs_field OPEN[] = {
    VS_EVENT_KIND, VS_EVENT_AT, ELEMENT,
    VS_EVENT_LEVEL("1 kV", 0.01, 100, "at which the contact arcs (assumed)")};
static const vs_field SHORT[] = {VS_EVENT_KIND, VS_EVENT_AT, ELEMENT};
static const vs_field COIL_SHORT[] = {
    VS_EVENT_KIND, VS_EVENT_AT, VS_EVENT_FRACTION("fraction", "100 %", 1, 100, "of the turns")};
static const vs_field JAM[] = {VS_EVENT_KIND, VS_EVENT_AT};
static const vs_field LOAD[] = {
    VS_EVENT_KIND,
    VS_EVENT_AT,
    {"fraction", VS_REAL, "", "unchanged", 0, 1, false, VS_EVENT_V_(fraction),
     "lambda_t, the share of the material that rides from then on", "unchanged", NULL},
    {"volume", VS_REAL, "cm3", "unchanged", 0, 1e9, false, VS_EVENT_V_(volume_m3),
     "V_k, the volume of the material from then on", "unchanged", NULL}};

static const char *element_named(const vs_scene_event *e, const vs_deck *deck) {
  (void)deck;
  return e->v.element;
}

static const char *the_coil(const vs_scene_event *e, const vs_deck *deck) {
  (void)e;
  return deck->eva;
}

/* ---- the load ---- */

static void becomes(const vs_scene_event *e, double *fraction, double *volume_m3) {
  if (!isnan(e->v.fraction)) *fraction = e->v.fraction;
  if (!isnan(e->v.volume_m3)) *volume_m3 = e->v.volume_m3;
}

/* ---- the switch ----
 * An element is opened by a switch in series, of 1 mohm or 1 Gohm, whose control conducts above
 * zero. So are turns of the coil shorted, which the EVA of the deck does by itself. */

static double closing(const vs_scene_event *e, double t_s) {
  return t_s > e->start_s + vs_scene_event_rounding(t_s) ? 1 : -1;
}

static double opening(const vs_scene_event *e, double t_s) {
  return -closing(e, t_s);
}

/* ---- the short ----
 * It lies across an element. Its resistance falls within CLOSES_S from OPEN_OHM to CLOSED_OHM, by
 * equal factors in equal times, as a spark's does. In no time at all it would empty a capacitance,
 * as every varistor has one, in picoseconds and with hundreds of kiloamperes: a peak of which each
 * step length makes another one. */

static const double CLOSES_S = 1e-6, OPEN_OHM = 1e9, CLOSED_OHM = 1e-3;

/* The logarithm of its conductance in S. */
static double short_source(const vs_scene_event *e, double t_s) {
  double part = fmin(fmax((t_s - e->start_s) / CLOSES_S, 0), 1);
  return -log(OPEN_OHM) + part * log(OPEN_OHM / CLOSED_OHM);
}

static double short_edge(const vs_scene_event *e, double t_s) {
  double closed_s = e->start_s + CLOSES_S;
  return t_s < e->start_s ? e->start_s : t_s < closed_s ? closed_s : INFINITY;
}

static double short_longest(const vs_scene_event *e, double t_s) {
  double since_s = t_s - e->start_s, near_s = vs_scene_event_rounding(t_s);
  return since_s > -near_s && since_s < CLOSES_S ? CLOSES_S / 150 : INFINITY;
}

/* All turns of a coil are shorted at its terminals, some of them by a switch. */
static bool is_whole(const vs_scene_event *e) {
  return e->v.fraction >= 1;
}
static double coil_source(const vs_scene_event *e, double t_s) {
  return is_whole(e) ? short_source(e, t_s) : closing(e, t_s);
}
static double coil_edge(const vs_scene_event *e, double t_s) {
  return is_whole(e) ? short_edge(e, t_s) : vs_scene_event_edge(e, t_s);
}
static double coil_longest(const vs_scene_event *e, double t_s) {
  return is_whole(e) ? short_longest(e, t_s) : INFINITY;
}

/* ---- elements ---- */

typedef struct element {
  size_t line; /* index into deck->lines */
  char name[VS_DECK_NAME], node[2][VS_DECK_NAME];
  const char *rest; /* what follows the first node in its line */
} element;

static void copy_name(char to[VS_DECK_NAME], vs_word word) {
  snprintf(to, VS_DECK_NAME, "%.*s", (int)word.n, word.at);
}

static const vs_part *part_of(const vs_deck *deck, const vs_netlist_card *card) {
  for (size_t p = 0; p < deck->n_parts && card->letter == 'x'; p++)
    if (vs_words_is(card->model, deck->parts[p].name)) return &deck->parts[p];
  return NULL;
}

/* True for an element with two ends: its first node and, of a part with more nodes, such as a
 * thyristor's, that out of which its current flows. *end is the number of the other one. */
static bool has_ends(const vs_deck *deck, const vs_netlist_card *card, size_t *end) {
  *end = 1;
  if (card->letter != 'x') return strchr("rclbdvi", card->letter) != NULL;
  if (card->nodes == 2) return true;
  const vs_part *part = part_of(deck, card);
  const vs_kind *kind = part ? vs_kinds_find(part->kind) : NULL;
  if (!kind || vs_kinds_count_pins(kind) != (int)card->nodes) return false;
  *end = (size_t)vs_kinds_pin(kind, VS_PIN_TO);
  return vs_kinds_pin(kind, VS_PIN_FROM) == 0;
}

/* True for an element that a parameter of the deck chooses, or gives its value. */
static bool is_part(const vs_deck *deck, const vs_cards *c, const vs_netlist_card *card) {
  char value[256];
  const vs_word word = vs_cards_word(c, card, 2);
  if (card->letter == 'x') return part_of(deck, card) != NULL;
  if (!strchr("rcl", card->letter) || !word.n) return false;
  snprintf(value, sizeof value, "%.*s", (int)word.n, word.at);
  for (size_t k = 0; k < deck->n_names; k++)
    if (!vs_deck_is_standard(deck->names[k].name) &&
        vs_words_find(value, value, deck->names[k].name, strlen(deck->names[k].name)))
      return true;
  return false;
}

static bool nth_part(const vs_deck *deck, size_t n, char name[VS_DECK_NAME]) {
  const vs_cards *c = vs_deck_cards(deck);
  size_t end;
  for (size_t k = 0; k < c->count; k = vs_cards_next(c, k)) {
    const vs_netlist_card *card = &c->card[k];
    bool listed = card->kind == VS_CARDS_ELEMENT && card->words >= 2 &&
                  has_ends(deck, card, &end) && is_part(deck, c, card);
    if (!listed || n-- > 0) continue;
    copy_name(name, card->name);
    return true;
  }
  return false;
}

static vs_status find_element(vs_deck *deck, const vs_scene_event *e, const char *wanted,
                              element *found, vs_error *err) {
  enum { MOST = 4 * VS_DECK_MOST }; /* names to choose the nearest from */
  const char *names[MOST];
  char text[MOST][VS_DECK_NAME];
  size_t count = 0;
  const vs_cards *c = vs_deck_cards(deck);
  for (size_t k = 0; k < c->count && count < MOST; k = vs_cards_next(c, k)) {
    const vs_netlist_card *card = &c->card[k];
    if (card->kind != VS_CARDS_ELEMENT || card->words < 2) continue;
    if (!vs_words_is(card->name, wanted)) {
      copy_name(text[count], card->name);
      names[count] = text[count];
      count++;
      continue;
    }
    size_t end;
    if (!has_ends(deck, card, &end))
      return vs_fail_at(err, e->where,
                        "events.%s: %s is no element of two nodes, nor a part with two main pins",
                        e->name, wanted);
    const vs_word first = vs_cards_word(c, card, 0);
    *found = (element){.line = k, .rest = first.at + first.n};
    copy_name(found->name, card->name);
    copy_name(found->node[0], first);
    copy_name(found->node[1], vs_cards_word(c, card, end));
    return VS_OK;
  }
  return vs_fail_at(err, e->where, "events.%s.element: the deck has no element '%s'%s", e->name,
                    wanted, vs_text_hint(wanted, names, count, "").text);
}

/* Puts `line`, an element between the nodes vs_l<k> and `other`, next to a node of the deck, with
 * its control vs_c<k> and the account of the energy it takes. Both nodes are our own, as not every
 * name of a node can stand in a formula. */
static vs_status add_driven(vs_deck *deck, const vs_scene_event *e, size_t k, const char *node,
                            const char *other, const char *line, vs_error *err) {
  char control[VS_DECK_NAME], between[2 * VS_DECK_NAME];
  snprintf(control, sizeof control, "vs_c%zu", k);
  snprintf(between, sizeof between, "vs_l%zu,%s", k, other);
  vs_status status = vs_wiring_source(deck, e, k, control, "0", err);
  if (!status) status = vs_wiring_loss(deck, e, k, between, err);
  if (status) return status;
  vs_wiring_line(deck, e->where, "Vvs_s%zu %s vs_l%zu 0", k, node, k);
  vs_wiring_line(deck, e->where, "%s", line);
  return VS_OK;
}

/* What follows its second node is the element's value. */
static void doubt(vs_deck *deck, const vs_scene_event *e, size_t k, const element *at,
                  const char *inner) {
  char past[VS_DECK_NAME];
  const char *value = at->rest + strspn(at->rest, " \t");
  value += strcspn(value, " \t");
  snprintf(past, sizeof past, "vvs_s%zu", k);
  vs_wiring_doubt(deck, e,
                  &(vs_wiring_element){at->name, {at->node[0], at->node[1]}, value, inner, past});
}

/* Tells the devices whose current the k-th event cuts off: its element is their part, or the source
 * that alone shows their current, with a sign or without. */
static void tell_devices(vs_deck *deck, const element *at, size_t k) {
  char current[2 * VS_DECK_NAME];
  const vs_part *part = part_of(deck, &vs_deck_cards(deck)->card[at->line]);
  snprintf(current, sizeof current, "i(%s)", at->name);
  for (size_t n = 0; n < deck->n_devices; n++) {
    vs_device *d = &deck->devices[n];
    bool cut = part && d->part == (int)(part - deck->parts);
    for (size_t o = 0; d->current.count <= 2 && o < d->current.count; o++)
      cut = cut || (d->current.ops[o].kind == VS_OP_TERM &&
                    !strcasecmp(deck->terms[d->current.ops[o].index].plus, current));
    if (cut) d->opened_by = k + 1;
  }
}

static vs_status open_wire(const vs_scene_event *e, size_t k, vs_deck *deck, vs_error *err) {
  element at;
  char node[VS_DECK_NAME], line[1024];
  vs_status status = find_element(deck, e, e->kind->element(e, deck), &at, err);
  if (status) return status;
  tell_devices(deck, &at, k);
  snprintf(node, sizeof node, "vs_n%zu", k);
  snprintf(line, sizeof line, "%s vs_n%zu%s", at.name, k, at.rest);
  doubt(deck, e, k, &at, node);
  if (!strcasecmp(at.name, deck->eva))
    snprintf(deck->eva_plus, sizeof deck->eva_plus, "vs_n%zu", k);
  vs_line_change(&deck->lines[at.line], vs_copy(line));
  vs_deck_changed(deck);
  snprintf(line, sizeof line, "Svs_f%zu vs_l%zu %s vs_c%zu 0 vs_f%zu on", k, k, node, k, k);
  status = add_driven(deck, e, k, at.node[0], node, line, err);
  vs_wiring_line(deck, e->where, ".model vs_f%zu sw(ron=1m roff=1g vt=0 vh=0.5)", k);
  /* An opening contact arcs; otherwise a coil's current would have nowhere to go. The arc's current
   * is i = 1 A (v/level)^30 up to the level and goes on straight above; 100 pF lie beside it. */
  char v[64], power[192];
  snprintf(v, sizeof v, "v(vs_l%zu,vs_n%zu)", k, k);
  if (*deck->compat) /* PSpice's pwr() has no sign */
    snprintf(power, sizeof power, "sgn(%s)*pow(abs(%s)/%.17g,30)", v, v, e->v.level_v);
  else
    snprintf(power, sizeof power, "pwr(%s/%.17g,30)", v, e->v.level_v);
  vs_wiring_line(
      deck, e->where,
      "Bvs_a%zu vs_l%zu vs_n%zu I = abs(%s) < %.17g ? %s : sgn(%s)*(1+30*(abs(%s)/%.17g-1))", k, k,
      k, v, e->v.level_v, power, v, v, e->v.level_v);
  vs_wiring_line(deck, e->where, "Cvs_a%zu vs_l%zu vs_n%zu 100p ic=0", k, k, k);
  return status;
}

static vs_status short_wire(const vs_scene_event *e, size_t k, vs_deck *deck, vs_error *err) {
  element at;
  char line[256], other[VS_DECK_NAME];
  vs_status status = find_element(deck, e, e->kind->element(e, deck), &at, err);
  if (status) return status;
  doubt(deck, e, k, &at, NULL);
  snprintf(other, sizeof other, "vs_m%zu", k);
  vs_wiring_line(deck, e->where, "Vvs_t%zu %s %s 0", k, other, at.node[1]);
  snprintf(line, sizeof line, "Bvs_f%zu vs_l%zu %s I = v(vs_l%zu,%s)*exp(v(vs_c%zu))", k, k, other,
           k, other, k);
  return add_driven(deck, e, k, at.node[0], other, line, err);
}

/* Where all turns are shorted, the coil is shorted at its terminals. Where some are, another EVA
 * takes the place of the deck's; the event's loss is then what goes in at the EVA's terminals
 * beyond what the energy audit counts as the coil's. */
static vs_status coil_wire(const vs_scene_event *e, size_t k, vs_deck *deck, vs_error *err) {
  element at;
  char line[1024], control[VS_DECK_NAME], plus[VS_DECK_NAME];
  if (is_whole(e)) return short_wire(e, k, deck, err);
  vs_status status = find_element(deck, e, deck->eva, &at, err);
  if (status) return status;
  deck->eva_file = "eva_shorted";
  snprintf(control, sizeof control, "vs_c%zu", k);
  snprintf(line, sizeof line, "%s %s %s %s eva", at.name, at.node[0], at.node[1], control);
  vs_line_change(&deck->lines[at.line], vs_copy(line));
  vs_deck_changed(deck);
  vs_wiring_line(deck, e->where, ".param vs_shorted_part=%.17g", e->v.fraction);
  snprintf(plus, sizeof plus, "%.50s.whole", deck->eva);
  snprintf(line, sizeof line, "*$ loss %s = v(%s,%s)*i(v.%s.vmain)-v(%s,%s)*i(v.%s.vcoil)", e->name,
           deck->eva_plus, deck->eva_minus, deck->eva, plus, deck->eva_minus, deck->eva);
  memcpy(deck->eva_plus, plus, sizeof plus);
  status = vs_wiring_account(deck, e, line, err);
  return status ? status : vs_wiring_source(deck, e, k, control, "0", err);
}

/* ---- the kinds ---- */

const vs_event_kind vs_faults[] = {
    {"open", "an element of the deck is cut off", VS_EVENT_KEYS(OPEN), .wants_element = true,
     .cuts = true, .edge = vs_scene_event_edge, .element = element_named, .part = nth_part,
     .wire = open_wire, .source = opening},
    {"short", "an element of the deck is shorted", VS_EVENT_KEYS(SHORT), .wants_element = true,
     .edge = short_edge, .longest = short_longest, .element = element_named, .part = nth_part,
     .wire = short_wire, .source = short_source},
    {"coil_short", "the EVA's coil is shorted, whole or in part", VS_EVENT_KEYS(COIL_SHORT),
     .edge = coil_edge, .longest = coil_longest, .element = the_coil, .wire = coil_wire,
     .source = coil_source},
    {"jam", "the armature is stuck: p stays what it is", VS_EVENT_KEYS(JAM), .ideal = true,
     .jams = true, .edge = vs_scene_event_edge},
    {"load", "the load changes; what is added arrives with the trough's velocity",
     VS_EVENT_KEYS(LOAD), .ideal = true, .load = becomes, .edge = vs_scene_event_edge},
    {.name = NULL}};
