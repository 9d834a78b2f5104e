/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "schematic_circuit.h"

#include <stdlib.h>
#include <string.h>

/* ---- nets ---- */

static bool same_word(vs_word a, vs_word b) {
  return a.n == b.n && !strncasecmp(a.at, b.at, a.n);
}

/* The net of that name, which is added where it is new; -1: there is no room. */
static int net_of(vs_circuit *c, vs_word name) {
  const bool ground = vs_words_is_ground(name);
  if (ground && c->ground >= 0) return c->ground;
  for (int k = 0; k < c->n_nets && !ground; k++)
    if (same_word(c->net[k], name)) return k;
  if (c->n_nets == VS_CIRCUIT_MOST) return -1;
  c->joined[c->n_nets] = c->n_nets;
  if (ground) c->ground = c->n_nets;
  c->net[c->n_nets] = name;
  return c->n_nets++;
}

static int root_of(const vs_circuit *c, int net) {
  while (c->joined[net] != net) net = c->joined[net];
  return net;
}

static void add_name(vs_text *list, vs_word name) {
  vs_text_add(list, "%s%.*s", list->length ? ", " : "", (int)name.n, name.at);
}

/* ---- elements ---- */

/* The words of a line that are the element's two ends, by its letter; false: nothing is known of
 * such an element. Those of a transistor of ngspice's are collector and emitter. */
static bool ends_of(char letter, int end[2]) {
  end[0] = 0;
  end[1] = strchr("qmjz", letter) ? 2 : 1;
  return letter && strchr("rclvidefghbswxqmjz", letter);
}

/* The kind of the part that an instance is; NULL: the deck says none. */
static const vs_kind *kind_of(const vs_deck *deck, const vs_netlist_card *card) {
  for (size_t k = 0; k < deck->n_parts && card->letter == 'x'; k++)
    if (vs_words_is(card->model, deck->parts[k].name)) return vs_kinds_find(deck->parts[k].kind);
  return card->letter == 'd' ? vs_kinds_find("diode") : NULL;
}

/* True for a source of 0 V, through which a current is measured. */
static bool is_ammeter(const vs_cards *cards, const vs_netlist_card *card) {
  char *end;
  const vs_word value = vs_cards_word(cards, card, 2);
  return card->letter == 'v' && !vs_cards_is_external(cards, card) && card->words == 3 &&
         card->count == 3 && value.n && strtod(value.at, &end) == 0 && end == value.at + value.n;
}

static bool is_mains(const vs_deck *deck, const vs_netlist_card *card) {
  for (size_t k = 0; k < deck->n_ports; k++)
    if (deck->ports[k].signal.drive == VS_PORT_MAINS &&
        vs_words_is(card->name, deck->ports[k].source))
      return true;
  return false;
}

static bool read_element(const vs_deck *deck, vs_circuit *c, const vs_netlist_card *card,
                         vs_text *why) {
  int end[2];
  vs_circuit_element e = {.card = card, .kind = kind_of(deck, card), .device = -1};
  const bool is_drive = e.kind && card->letter == 'x' && vs_kinds_count_pins(e.kind) < 2;
  if (card->letter == 'k' || is_drive) {
    add_name(is_drive ? &c->aside : &c->couplings, card->name);
    return true;
  }
  if (card->conditional || !ends_of(card->letter, end)) {
    vs_text_add(why, "no symbol stands for %.*s", (int)card->name.n, card->name.at);
    return false;
  }
  if (e.kind && card->letter == 'x') {
    end[0] = vs_kinds_pin(e.kind, VS_PIN_FROM);
    end[1] = vs_kinds_pin(e.kind, VS_PIN_TO);
  }
  if (end[0] < 0 || end[1] < 0 || card->nodes <= (size_t)end[0] || card->nodes <= (size_t)end[1]) {
    vs_text_add(why, "%.*s has not two ends", (int)card->name.n, card->name.at);
    return false;
  }
  e.mains = is_mains(deck, card);
  e.coil = vs_words_is(card->name, deck->eva);
  for (int k = 0; k < 2; k++) e.end[k] = net_of(c, vs_cards_word(c->cards, card, (size_t)end[k]));
  for (size_t k = 2; k < card->nodes && card->letter == 'x' && !e.kind && !e.coil; k++) {
    if (e.n_pins == VS_CIRCUIT_PINS ||
        (e.pin[e.n_pins] = net_of(c, vs_cards_word(c->cards, card, k))) < 0) {
      vs_text_add(why, "%.*s has too many pins", (int)card->name.n, card->name.at);
      return false;
    }
    e.n_pins++;
  }
  if (e.end[0] < 0 || e.end[1] < 0 || c->n_elements == VS_CIRCUIT_MOST) {
    vs_text_add(why, "the circuit has more than %d elements or nets", VS_CIRCUIT_MOST);
    return false;
  }
  c->element[c->n_elements++] = e;
  return true;
}

/* ---- which element a device of the deck is ---- */

/* How many ends of elements lie at the net itself, ammeters included. */
static int count_at(const vs_circuit *c, int net) {
  int n = 0;
  for (int k = 0; k < c->n_elements; k++)
    n += (c->element[k].end[0] == net) + (c->element[k].end[1] == net);
  return n;
}

/* True where the element may be such a device: a resistor, a capacitor, a diode, or a part of no
 * other kind. */
static bool may_be(const vs_device *d, const vs_circuit_element *e) {
  const char letter = e->card->letter, *kind = d->kind ? d->kind->name : "";
  const char own = !strcmp(kind, "resistor") ? 'r' : !strcmp(kind, "capacitor") ? 'c' : 'x';
  return !e->coil && (letter == own || (letter == 'd' && own == 'x')) &&
         (!e->kind || e->kind == d->kind);
}

/* True where the device's current is that through the ammeter which only this element continues. */
static bool is_measured(const vs_deck *deck, const vs_circuit *c, const vs_device *d,
                        const vs_circuit_element *e) {
  const vs_op *op = d->current.ops;
  if (d->current.count != 1 || op->kind != VS_OP_TERM) return false;
  for (int k = 0; k < c->n_elements; k++) {
    const vs_circuit_element *m = &c->element[k];
    char term[VS_DECK_NAME];
    snprintf(term, sizeof term, "i(%.*s)", (int)m->card->name.n, m->card->name.at);
    if (strcasecmp(term, deck->terms[op->index].plus) || !is_ammeter(c->cards, m->card)) continue;
    for (int n = 0; n < 4; n++)
      if (m->end[n % 2] == e->end[n / 2] && count_at(c, m->end[n % 2]) == 2) return true;
  }
  return false;
}

/* True where the device's voltage is that between the ends of this element. */
static bool is_across(const vs_deck *deck, const vs_circuit *c, const vs_device *d,
                      const vs_circuit_element *e) {
  const vs_op *op = d->voltage.ops;
  if (d->voltage.count != 1 || op->kind != VS_OP_TERM) return false;
  int found = 0;
  for (int k = 0; k < 2; k++) {
    const char *term = k ? deck->terms[op->index].minus : deck->terms[op->index].plus;
    const vs_word node = {term + 2, strlen(term) - 3};
    for (int n = 0; n < 2 && strlen(term) > 3; n++) {
      const int root = root_of(c, e->end[n]);
      for (int other = 0; other < c->n_nets; other++)
        if (root_of(c, other) == root &&
            (same_word(c->net[other], node) || (other == c->ground && vs_words_is_ground(node))))
          found |= 1 << (2 * k + n);
    }
  }
  return found == (1 | 8) || found == (2 | 4); /* plus at one end, minus at the other */
}

/* Finds the only element that the device may be; -1: none, or it is not told which. */
static int element_of(const vs_deck *deck, const vs_circuit *c, const vs_device *d) {
  for (int way = 0; way < 2; way++) {
    int found = -1, count = 0;
    for (int k = 0; k < c->n_elements; k++)
      if (may_be(d, &c->element[k]) &&
          (way ? is_across(deck, c, d, &c->element[k]) : is_measured(deck, c, d, &c->element[k]))) {
        found = k;
        count++;
      }
    if (count == 1) return found;
    if (count) return -1;
  }
  return -1;
}

static void find_devices(const vs_deck *deck, vs_circuit *c) {
  for (size_t k = 0; k < deck->n_devices; k++) {
    const int n = element_of(deck, c, &deck->devices[k]);
    if (n < 0) continue;
    vs_circuit_element *e = &c->element[n];
    if (e->device < 0) e->device = (int)k;
    if (!e->kind) e->kind = deck->devices[k].kind;
  }
}

/* True where a pin besides the two ends of an element that is drawn lies at the net. */
static bool has_pin(const vs_circuit *c, int net) {
  for (int k = 0; k < c->n_elements; k++)
    for (int n = 0; n < c->element[k].n_pins && c->element[k].drawn; n++)
      if (root_of(c, c->element[k].pin[n]) == net) return true;
  return false;
}

/* Makes one net of the two ends of each ammeter, which is then no element any more. */
static void join_ammeters(vs_circuit *c, bool drop) {
  int kept = 0;
  for (int k = 0; k < c->n_elements; k++) {
    const vs_circuit_element e = c->element[k];
    if (is_ammeter(c->cards, e.card)) {
      const int a = root_of(c, e.end[0]), b = root_of(c, e.end[1]);
      const bool first = a == c->ground || (b != c->ground && count_at(c, a) >= count_at(c, b));
      if (!drop && a != b) c->joined[first ? b : a] = first ? a : b;
      if (drop) add_name(&c->ammeters, e.card->name);
      if (drop) continue;
    }
    c->element[kept++] = e;
  }
  c->n_elements = kept;
  for (int k = 0; k < c->n_elements && drop; k++)
    for (int n = 0; n < 2; n++) c->element[k].end[n] = root_of(c, c->element[k].end[n]);
}

/* ---- the main circuit ---- */

static int degree_of(const vs_circuit *c, int net) {
  int n = 0;
  for (int k = 0; k < c->n_elements; k++)
    for (int m = 0; m < 2 && c->element[k].drawn; m++) n += c->element[k].end[m] == net;
  return n + has_pin(c, net);
}

/* Leaves out what a single lead connects to the rest: the drive of a gate ends at the gate, which
 * is no end here. */
static void leave_out_open(vs_circuit *c) {
  for (bool more = true; more;) {
    more = false;
    for (int k = 0; k < c->n_elements; k++) {
      vs_circuit_element *e = &c->element[k];
      if (!e->drawn ||
          (degree_of(c, e->end[0]) > 1 && degree_of(c, e->end[1]) > 1 && e->end[0] != e->end[1]))
        continue;
      e->drawn = false;
      more = true;
    }
  }
}

static bool is_rail(const vs_circuit *c, int net) {
  return net == c->rail[0] || net == c->rail[1];
}

/* The net of an end, or behind them of a pin. */
static int end_of(const vs_circuit *c, const vs_circuit_element *e, int n) {
  return n < 2 ? e->end[n] : root_of(c, e->pin[n - 2]);
}

/* Leaves out islands: what only the ground or the rails connect to the rest, and in which there is
 * neither the EVA, nor the mains, nor a device. */
static void leave_out_islands(vs_circuit *c) {
  bool main_net[VS_CIRCUIT_MOST] = {0};
  for (bool more = true; more;) {
    more = false;
    for (int k = 0; k < c->n_elements; k++) {
      const vs_circuit_element *e = &c->element[k];
      bool of_main = e->coil || e->mains || e->device >= 0;
      for (int n = 0; n < 2 + e->n_pins; n++) of_main = of_main || main_net[end_of(c, e, n)];
      for (int n = 0; n < 2 + e->n_pins && e->drawn && of_main; n++) {
        const int net = end_of(c, e, n);
        if (!main_net[net] && !is_rail(c, net) && net != c->ground) more = main_net[net] = true;
      }
    }
  }
  for (int k = 0; k < c->n_elements; k++) {
    vs_circuit_element *e = &c->element[k];
    bool far = true;
    for (int n = 0; n < 2; n++) far = far && !main_net[e->end[n]]; /* both ends may be rails */
    const bool between = (is_rail(c, e->end[0]) || e->end[0] == c->ground) &&
                         (is_rail(c, e->end[1]) || e->end[1] == c->ground);
    if (far && !between) e->drawn = false;
  }
}

static bool is_switch(const vs_circuit_element *e) {
  return e->drawn && e->kind && (e->kind->switches || e->kind->rectifies || e->kind->driven);
}

/* How many legs two nets have: nets that a semiconductor connects with either of them. */
static int count_legs(const vs_circuit *c, int top, int bottom) {
  int legs = 0;
  for (int net = 0; net < c->n_nets; net++) {
    int up = 0, down = 0;
    for (int k = 0; k < c->n_elements && net != top && net != bottom; k++) {
      const vs_circuit_element *e = &c->element[k];
      if (!is_switch(e) || (e->end[0] != net && e->end[1] != net)) continue;
      const int other = e->end[e->end[0] == net];
      up += other == top;
      down += other == bottom;
    }
    legs += up > 0 && down > 0;
  }
  return legs;
}

/* How many diodes and thyristors conduct into the net, less those that conduct out of it; of
 * transistors the other way round. */
static int count_inward(const vs_circuit *c, int net) {
  int n = 0;
  for (int k = 0; k < c->n_elements; k++) {
    const vs_circuit_element *e = &c->element[k];
    if (is_switch(e)) n += ((e->end[1] == net) - (e->end[0] == net)) * (e->kind->driven ? -1 : 2);
  }
  return n;
}

/* The rails are those two nets that have the most legs, two or more; of equal ones those that the
 * current of diodes and thyristors runs to and from. Else the ground alone. */
static void choose_rails(vs_circuit *c) {
  int most = 1, clearest = 0;
  c->rail[0] = -1;
  c->rail[1] = c->ground;
  for (int a = 0; a < c->n_nets; a++)
    for (int b = a + 1; b < c->n_nets; b++) {
      const int legs = count_legs(c, a, b), up = count_inward(c, a) - count_inward(c, b);
      if (legs < 2 || legs < most || (legs == most && abs(up) <= clearest)) continue;
      most = legs;
      clearest = abs(up);
      c->rail[0] = up >= 0 ? a : b;
      c->rail[1] = up >= 0 ? b : a;
    }
}

/* ---- branches ---- */

/* True for a net at which a branch ends: three elements meet, it is a rail, or a source or the EVA
 * stands between it and the lower rail. */
static bool is_joint(const vs_circuit *c, int net) {
  if (is_rail(c, net) || has_pin(c, net) || degree_of(c, net) != 2) return true;
  for (int k = 0; k < c->n_elements; k++) {
    const vs_circuit_element *e = &c->element[k];
    if (e->drawn && (e->coil || strchr("vibefgh", e->card->letter)) &&
        ((e->end[0] == net && e->end[1] == c->rail[1]) ||
         (e->end[1] == net && e->end[0] == c->rail[1])))
      return true;
  }
  return false;
}

/* Follows the elements from one on, which lies at the net. */
static bool follow(vs_circuit *c, int first, int net, bool *used, vs_text *why) {
  vs_circuit_branch *b = &c->branch[c->n_branches++];
  *b = (vs_circuit_branch){.end = {net, net}};
  for (int k = first; k >= 0;) {
    if (b->count == VS_BRANCH_MOST) {
      vs_text_add(why, "more than %d elements are in series", VS_BRANCH_MOST);
      return false;
    }
    const bool reversed = c->element[k].end[1] == b->end[1];
    b->element[b->count] = k;
    b->reversed[b->count++] = reversed;
    b->end[1] = c->element[k].end[!reversed];
    used[k] = true;
    if (is_joint(c, b->end[1])) break;
    for (k = c->n_elements - 1; k >= 0; k--)
      if (c->element[k].drawn && !used[k] &&
          (c->element[k].end[0] == b->end[1] || c->element[k].end[1] == b->end[1]))
        break;
  }
  if (b->end[0] != b->end[1]) return true;
  vs_text_add(why, "a loop of elements hangs at one net");
  return false;
}

static bool make_branches(vs_circuit *c, vs_text *why) {
  bool used[VS_CIRCUIT_MOST] = {0};
  for (int k = 0; k < c->n_elements; k++)
    for (int n = 0; n < 2; n++)
      if (c->element[k].drawn && !used[k] && is_joint(c, c->element[k].end[n]) &&
          !follow(c, k, c->element[k].end[n], used, why))
        return false;
  for (int k = 0; k < c->n_elements; k++)
    if (!c->element[k].drawn)
      add_name(&c->aside, c->element[k].card->name);
    else if (!used[k]) {
      vs_text_add(why, "the elements form one loop");
      return false;
    }
  if (!c->n_branches) vs_text_add(why, "nothing is connected");
  return c->n_branches > 0;
}

bool vs_schematic_circuit_read(const vs_deck *deck, vs_circuit *c, vs_text *why) {
  *c = (vs_circuit){.cards = vs_deck_cards(deck), .ground = -1};
  for (size_t k = 0; k < c->cards->count; k = vs_cards_next(c->cards, k)) {
    const vs_netlist_card *card = &c->cards->card[k];
    if (card->kind == VS_CARDS_IF) vs_text_add(why, "parts of the deck are conditional (.if)");
    if (card->kind == VS_CARDS_IF) return false;
    if (card->kind == VS_CARDS_ELEMENT && !read_element(deck, c, card, why)) return false;
  }
  join_ammeters(c, false);
  find_devices(deck, c);
  join_ammeters(c, true);
  for (int k = 0; k < c->n_elements; k++) c->element[k].drawn = true;
  leave_out_open(c);
  choose_rails(c);
  leave_out_islands(c);
  leave_out_open(c);
  return make_branches(c, why);
}

void vs_schematic_circuit_free(vs_circuit *c) {
  vs_text_free(&c->ammeters);
  vs_text_free(&c->couplings);
  vs_text_free(&c->aside);
}
