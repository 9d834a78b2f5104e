/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lines.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/cursor.h"
#include "copying.h"
#include "fate.h"
#include "netlist/kinds.h"

/* ---- sources ---- */

/* Declares the sources of a deck: the ports, the mains' terminals, and for the energy audit what
 * each source delivers to the circuit. */

/* Adds the loss of the mains' series resistance (LTspice's Rser), which the deck has as an element
 * of its own. That of another source is contained in what the source delivers at its nodes. */
static void add_series(vs_fate *p, const vs_element *e) {
  char v[VS_DECK_TEXT], inner[VS_ELEMENTS_NAME];
  double ohm;
  if (vs_elements_number(p->wiring, p->values, e, "rser", &ohm) && ohm > 0) {
    snprintf(inner, sizeof inner, "%.50s_ser", vs_fate_of(p, e)->stem);
    vs_declared_voltage(vs_elements_node_of(p->wiring, e, 0), inner, v);
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s_ser = %s^2/%.15g", e->key,
                    *v == '-' ? v + 1 : v, ohm);
  }
}

/* Adds the energy in the capacitor that shapes a gate's edges, some 1e-10 J, so that the audit
 * misses nothing. */
static void add_edge(vs_fate *p, const vs_roles_gate *g, const char *two) {
  const char *key = g->source->key, *stem = vs_fate_of(p, g->source)->stem;
  if (vs_copying_has_edges(&g->pulse))
    vs_declared_add(&p->sheet, VS_DECLARED_STORE, "%s_edge%s = 1n*v(%s_edge%s)^2/2", key, two, stem,
                    two);
}

/* Adds what a gate's current source delivers, as a loss below zero: the level times its pulses, and
 * the current between them. (The current of voltage sources is known without this.) */
static void add_gate_loss(vs_fate *p, const vs_roles_gate *g) {
  const vs_element *e = g->source;
  char v[VS_DECK_TEXT];
  const vs_fate_element *own = vs_fate_of(p, e);
  const char *node = vs_copying_has_edges(&g->pulse) ? "edge" : "on";
  if (e->letter != 'i') return;
  vs_declared_voltage(vs_elements_node_of(p->wiring, e, 0), vs_elements_node_of(p->wiring, e, 1),
                      v);
  if (g->each == 1)
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s = %s*({%s}*v(%s_%s)+%.15g)", e->key, v,
                    own->level, own->stem, node, g->pulse.low);
  else
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s = %s*({%s}*(v(%s_%s)+v(%s_%s2))+%.15g)",
                    e->key, v, own->level, own->stem, node, own->stem, node, g->pulse.low);
}

static void add_sources(vs_fate *p) {
  const vs_roles *r = p->roles;
  const vs_elements *w = p->wiring;
  if (r->mains) {
    vs_declared_add(&p->sheet, VS_DECLARED_PORT, "mains = %s", r->mains->name);
    vs_declared_add(&p->sheet, VS_DECLARED_PROBE,
                    "i_source = -i(%s) A \"current drawn from the mains\"", r->mains->name);
    char name[VS_DECK_NAME];
    vs_declared_name(&p->sheet, "i_source", name);
  }
  for (size_t g = 0; g < r->n_gates; g++)
    for (int n = 0; n < r->gates[g].each; n++) {
      add_edge(p, &r->gates[g], n ? "2" : "");
      double shift_deg = r->gates[g].shift_deg + 180 * n;
      const char *stem = vs_fate_of(p, r->gates[g].source)->stem;
      if (shift_deg != 0)
        vs_declared_add(&p->sheet, VS_DECLARED_PORT, "gate+%.9gdeg = Vgate%s_%s", shift_deg,
                        n ? "2" : "", stem);
      else
        vs_declared_add(&p->sheet, VS_DECLARED_PORT, "gate = Vgate%s_%s", n ? "2" : "", stem);
    }
  if (r->mains) add_series(p, r->mains);
  for (size_t g = 0; g < r->n_gates; g++) add_gate_loss(p, &r->gates[g]);
  for (size_t k = 0; k < w->count; k++) { /* what sources deliver is a negative loss */
    const vs_element *e = &w->elements[k];
    char v[VS_DECK_TEXT];
    if (e->letter != 'v' || e == r->mains) continue;
    vs_declared_voltage(vs_elements_node_of(w, e, 0), vs_elements_node_of(w, e, 1), v);
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s = %s*i(%s)", e->key, v, e->name);
  }
}

/* Finds the mains' terminals: beyond the resistors and inductors in series with the source. */
static void add_line(vs_fate *p) {
  const vs_element *e = p->roles->mains;
  if (!e) return;
  int node = e->nodes[0], end = e->nodes[1];
  if (!strcmp(p->wiring->nodes[node].name, "0")) node = end, end = e->nodes[0];
  for (const vs_element *next; (next = vs_elements_next(p->wiring, e, node)); e = next) {
    if (!strchr("rl", next->letter) || vs_fate_is_coil(p, next)) break;
    node = next->nodes[next->nodes[0] == node];
  }
  const char *other = p->wiring->nodes[end].name;
  vs_declared_add(&p->sheet, VS_DECLARED_LINE, "%s%s%s", p->wiring->nodes[node].name,
                  strcmp(other, "0") ? " " : "", strcmp(other, "0") ? other : "");
}

/* Writes the voltage of an element. It begins at the node between the element and the source that
 * senses its current, if there is one. */
static void voltage_of(const vs_fate *p, const vs_element *e, const vs_fate_element *own,
                       char text[VS_DECK_TEXT]) {
  int from = own->pins.kind ? own->pins.from : 0, to = own->pins.kind ? own->pins.to : 1;
  vs_declared_voltage(vs_elements_node_of(p->wiring, e, from),
                      vs_elements_node_of(p->wiring, e, to), text);
}

/* ---- gates ---- */

/* Marks the nodes that resistors and diodes connect to a node, without passing node 0. */
static void spread(const vs_fate *p, int node, bool *reached) {
  const vs_elements *w = p->wiring;
  reached[node] = true;
  if (!strcmp(w->nodes[node].name, "0")) return;
  for (size_t k = 0; k < w->count; k++) {
    const vs_element *e = &w->elements[k];
    for (int n = 0; n < 2 && strchr("rd", e->letter); n++)
      if (e->nodes[n] == node && !reached[e->nodes[1 - n]]) spread(p, e->nodes[1 - n], reached);
  }
}

/* Marks the gates that can be seen to drive a node of an element, and returns how many there are.
 * Only the first node of a gate's source counts, not its reference. */
static size_t gates_at(const vs_fate *p, int node, bool drives[VS_ROLES_GATES]) {
  bool *reached = vs_alloc(p->wiring->n_nodes + 1, sizeof *reached);
  size_t count = 0;
  spread(p, node, reached);
  for (size_t g = 0; g < p->roles->n_gates; g++) {
    int plus = p->roles->gates[g].source->nodes[0];
    drives[g] = reached[plus] && strcmp(p->wiring->nodes[plus].name, "0");
    count += drives[g];
  }
  free(reached);
  return count;
}

/* Error: no gate's source drives the pin that the part of this name has for a gate. The netlist was
 * probably written for another part with other pins. */
static vs_status check_part(const vs_fate *p, const vs_element *e, const vs_fate_element *own,
                            vs_error *err) {
  bool gated = *own->pins.part && vs_kinds_latches(own->pins.kind) && p->roles->n_gates;
  bool drives[VS_ROLES_GATES];
  if (!gated || own->pins.by == vs_pins_said || gates_at(p, e->nodes[2], drives)) return VS_OK;
  const vs_kind *kind = vs_kinds_find(own->pins.kind);
  return vs_fail_at(err, vs_elements_where(p->wiring, e, 0),
                    "%s: the part %s has the pins %s %s %s, and no gate's source drives the "
                    "third node here; --pins %s=%s, the letters in the order of the nodes, says "
                    "which node is what",
                    e->name, own->pins.part, kind->pins[0].node, kind->pins[1].node,
                    kind->pins[2].node, e->name, kind->letters);
}

/* ---- thyristors and triacs ---- */

static void add_port(char words[VS_DECK_NAME], double shift_deg) {
  size_t n = strlen(words);
  if (shift_deg != 0)
    snprintf(words + n, VS_DECK_NAME - n, " gate+%.9gdeg", shift_deg);
  else
    snprintf(words + n, VS_DECK_NAME - n, " gate");
}

/* Writes the ports that fire the element, each after a blank; empty where it is the deck's only
 * port, or where it is not known. A thyristor is fired by the first pulse of a cycle alone. */
static void gate_words(const vs_fate *p, const vs_element *e, const vs_fate_element *own,
                       bool both_ways, char words[VS_DECK_NAME]) {
  bool drives[VS_ROLES_GATES];
  size_t count = own->pins.gate < 0 ? 0 : gates_at(p, e->nodes[own->pins.gate], drives), ports = 0;
  *words = '\0';
  for (size_t g = 0; g < p->roles->n_gates; g++)
    ports += both_ways ? (size_t)p->roles->gates[g].each : 1;
  for (size_t g = 0; g < p->roles->n_gates && count && ports > 1; g++) {
    const vs_roles_gate *gate = &p->roles->gates[g];
    for (int n = 0; drives[g] && n < (both_ways ? gate->each : 1); n++)
      add_port(words, gate->shift_deg + 180 * n);
    if (drives[g] && !both_ways) break;
  }
}

/* Writes what stands in a `device` line between the name and '='. */
static void device_kind(const vs_fate *p, const vs_element *e, const vs_fate_element *own,
                        char text[VS_DECK_TEXT]) {
  const vs_kind *kind = vs_kinds_find(own->pins.kind);
  char gate[VS_DECK_NAME] = "";
  if (kind->gated) gate_words(p, e, own, kind->both_ways, gate);
  snprintf(text, VS_DECK_TEXT, "%s%s%s", *own->part ? "" : " ", *own->part ? "" : own->pins.kind,
           gate);
}

/* Adds the device, its loss and the probe of its current, for an element of a known kind. */
static void add_device(vs_fate *p, const vs_element *e, const vs_fate_element *own,
                       const char *name, const char *probe) {
  char v[VS_DECK_TEXT], kind[VS_DECK_TEXT], gate[VS_DECK_TEXT];
  voltage_of(p, e, own, v);
  if (vs_kinds_find(own->pins.kind)) {
    device_kind(p, e, own, kind);
    vs_declared_add(&p->sheet, VS_DECLARED_DEVICE, "%s%s = %s, i(%s)", name, kind, v, own->sense);
  }
  if (*own->gate_sense) {
    vs_declared_voltage(vs_elements_node_of(p->wiring, e, own->pins.gate),
                        vs_elements_node_of(p->wiring, e, own->pins.to), gate);
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s = %s*i(%s)+%s*i(%s)", name, v, own->sense,
                    gate, own->gate_sense);
  } else
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s = %s*i(%s)", name, v, own->sense);
  if (probe)
    vs_declared_add(&p->sheet, VS_DECLARED_PROBE, "%s = i(%s) A \"current of %s\"", probe,
                    own->sense, e->name);
}

static void add_valve(vs_fate *p, const vs_element *e, const vs_fate_element *own, size_t count,
                      bool first) {
  char name[VS_DECK_NAME], v_ak[VS_DECK_NAME], i[VS_DECK_NAME], v[VS_DECK_TEXT];
  const char *key = count == 1 ? own->pins.kind : e->key;
  if (*own->part) key = own->part;
  snprintf(name, sizeof name, "%s", key);
  if (first)
    snprintf(v_ak, sizeof v_ak, "v_ak");
  else
    snprintf(v_ak, sizeof v_ak, "v_ak_%.50s", e->key);
  snprintf(i, sizeof i, "i_%.50s", count == 1 ? "thyristor" : e->key);
  voltage_of(p, e, own, v);
  vs_declared_add(&p->sheet, VS_DECLARED_PROBE, "%s = %s V \"voltage of %s\"", v_ak, v, e->name);
  if (*own->part)
    vs_declared_add(&p->sheet, VS_DECLARED_RATING, "%s -%s.%s..%s.v_drm V", v_ak, own->part,
                    vs_kinds_find(own->pins.kind)->both_ways ? "v_drm" : "v_rrm", own->part);
  vs_declared_name(&p->sheet, v_ak, v_ak);
  vs_declared_name(&p->sheet, i, i);
  add_device(p, e, own, name, i);
}

/* Adds the thyristors and triacs. If there are several, i_thyristor is the sum of their currents,
 * which a node of the deck forms. */
static void add_valves(vs_fate *p) {
  size_t count = 0;
  bool first = true;
  for (size_t k = 0; k < p->wiring->count; k++) count += vs_kinds_latches(p->of[k].pins.kind);
  for (size_t k = 0; k < p->wiring->count; k++) {
    const vs_fate_element *own = &p->of[k];
    if (!vs_kinds_latches(own->pins.kind)) continue;
    add_valve(p, &p->wiring->elements[k], own, count, first);
    first = false;
  }
  if (count > 1)
    vs_declared_add(&p->sheet, VS_DECLARED_PROBE,
                    "i_thyristor = v(%s) A \"the sum of their currents\"", p->sum);
}

/* ---- everything else ---- */

static void add_others(vs_fate *p) {
  for (size_t k = 0; k < p->wiring->count; k++) {
    const vs_element *e = &p->wiring->elements[k];
    const vs_fate_element *own = &p->of[k];
    char i[VS_DECK_NAME];
    if (!own->pins.kind || vs_kinds_latches(own->pins.kind) || !*own->sense) continue;
    snprintf(i, sizeof i, "i_%.50s", e->key);
    vs_declared_name(&p->sheet, i, i);
    add_device(p, e, own, *own->part ? own->part : e->key, i);
  }
}

/* The voltage of the capacitor alone, without the Rser and Lser that LTspice puts in series with
 * it. It begins at the node that the reader of decks makes behind those. */
static void within(const vs_fate *p, const vs_element *e, const vs_fate_element *own,
                   char v[VS_DECK_TEXT]) {
  char inner[VS_ELEMENTS_NAME + 8];
  snprintf(inner, sizeof inner, "%s__ser", e->name);
  vs_cursor_lower(inner);
  if (vs_elements_sets(p->wiring, p->values, e, "rser") ||
      vs_elements_sets(p->wiring, p->values, e, "lser"))
    snprintf(v, VS_DECK_TEXT, "v(%s,%s)", own->inner, inner);
}

static void add_passive(vs_fate *p, const vs_element *e, const vs_fate_element *own) {
  char v[VS_DECK_TEXT];
  vs_declared_voltage(vs_elements_node_of(p->wiring, e, 0), vs_elements_node_of(p->wiring, e, 1),
                      v);
  if (e->letter == 'r' && own->value) {
    const char *square = *v == '-' ? v + 1 : v;
    vs_declared_add(&p->sheet, VS_DECLARED_DEVICE, "%s resistor = %s, %s/%s", e->key, v, v,
                    own->value);
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s = %s^2/%s", e->key, square, own->value);
  } else if (e->letter == 'r') {
    vs_declared_add(&p->sheet, VS_DECLARED_DEVICE, "%s resistor = %s, i(%s)", e->key, v,
                    own->sense);
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s = %s*i(%s)", e->key, v, own->sense);
  } else if (e->letter == 'c') {
    vs_declared_add(&p->sheet, VS_DECLARED_DEVICE, "%s capacitor = %s, i(%s)", e->key, v,
                    own->sense);
    within(p, e, own, v);
    if (own->value)
      vs_declared_add(&p->sheet, VS_DECLARED_STORE, "%s = %s*%s^2/2", e->key, own->value,
                      *v == '-' ? v + 1 : v);
  } else if (own->value)
    vs_declared_add(&p->sheet, VS_DECLARED_STORE, "%s = %s*i(%s)^2/2", e->key, own->value, e->name);
  if (e->letter != 'r' && !own->value)
    vs_declared_note(&p->sheet.left,
                     "%s: its value is not known before a run, so that the energy it holds is not "
                     "counted: a line '*$ store %s = ...' would",
                     e->name, e->key);
}

/* Adds the losses of LTspice's Rser (in series) and Rpar (across) of an inductor or capacitor. The
 * reader of decks makes them elements of their own. */
static void add_parasitic(vs_fate *p, const vs_element *e, const vs_fate_element *own) {
  char v[VS_DECK_TEXT];
  double ohm;
  vs_declared_voltage(vs_elements_node_of(p->wiring, e, 0), vs_elements_node_of(p->wiring, e, 1),
                      v);
  if (vs_elements_number(p->wiring, p->values, e, "rser", &ohm))
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s_rser = %.15g*i(%s)^2", e->key, ohm,
                    e->letter == 'c' ? own->sense : e->name);
  if (vs_elements_number(p->wiring, p->values, e, "rpar", &ohm) && ohm > 0)
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s_rpar = %s^2/%.15g", e->key,
                    *v == '-' ? v + 1 : v, ohm);
}

/* Adds inductors, then capacitors, then resistors: if a deck has no room for all, those that store
 * energy are there. */
static void add_passives(vs_fate *p) {
  for (const char *letter = "lcr"; *letter; letter++)
    for (size_t k = 0; k < p->wiring->count; k++) {
      const vs_element *e = &p->wiring->elements[k];
      if (e->letter != *letter || vs_fate_is_coil(p, e)) continue;
      add_passive(p, e, &p->of[k]);
      if (e->letter != 'r') add_parasitic(p, e, &p->of[k]);
    }
}

/* The inductor that the n-th word of a K line names, and its value; NULL: its value is not known,
 * or is multiplied. */
static const vs_element *coupled(const vs_fate *p, const vs_element *e, int n, const char **value) {
  const vs_element *l = vs_elements_find(p->wiring, vs_elements_word(e, n));
  bool multiplied = l && (vs_elements_sets(p->wiring, p->values, l, "m") ||
                          vs_elements_sets(p->wiring, p->values, l, "scale")); /* K knows no m= */
  *value = l && !multiplied ? vs_fate_of(p, l)->value : NULL;
  return *value ? l : NULL;
}

/* Adds the energy of the coupling, for each two of the inductors: K sqrt(L1 L2) i1 i2. Returns
 * false where it is not known. */
static bool add_coupling(vs_fate *p, const vs_element *e) {
  double factor;
  int last = e->n_words - 1;
  char name[VS_DECK_NAME + 16];
  bool known = last > 2 && vs_values_of(p->values, vs_elements_word(e, last), &factor);
  for (int n = 1; n < last && known; n++)
    for (int m = n + 1; m < last && known; m++) {
      const char *a, *b;
      const vs_element *first = coupled(p, e, n, &a), *second = coupled(p, e, m, &b);
      snprintf(name, sizeof name, last == 3 ? "%.50s" : "%.50s_%d_%d", e->key, n, m);
      known = first && second &&
              vs_declared_add(&p->sheet, VS_DECLARED_STORE, "%s = %.15g*sqrt(%s*%s)*i(%s)*i(%s)",
                              name, factor, a, b, first->name, second->name);
    }
  return known;
}

/* Adds what controlled sources and current sources take, as a loss; it is negative where they
 * deliver. */
static void add_controlled(vs_fate *p) {
  for (size_t k = 0; k < p->wiring->count; k++) {
    const vs_element *e = &p->wiring->elements[k];
    const vs_fate_element *own = &p->of[k];
    char v[VS_DECK_TEXT];
    if (own->pins.kind || !*own->sense || !strchr("befghi", e->letter)) continue;
    voltage_of(p, e, own, v);
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s = %s*i(%s)", e->key, v, own->sense);
  }
}

/* Adds the loss and the store of LTspice's Rpar and Cpar across the EVA's coil, which have become
 * elements of their own. */
static void add_across(vs_fate *p) {
  const vs_roles *r = p->roles;
  char v[VS_DECK_TEXT];
  double value;
  vs_declared_voltage(p->wiring->nodes[r->coil_plus].name, p->wiring->nodes[r->coil_minus].name, v);
  const char *square = *v == '-' ? v + 1 : v;
  if (vs_elements_number(p->wiring, p->values, r->coil, "rpar", &value) && value > 0)
    vs_declared_add(&p->sheet, VS_DECLARED_LOSS, "%s_rpar = %s^2/%.15g", r->coil->key, square,
                    value);
  if (vs_elements_number(p->wiring, p->values, r->coil, "cpar", &value))
    vs_declared_add(&p->sheet, VS_DECLARED_STORE, "%s_cpar = %.15g*%s^2/2", r->coil->key, value,
                    square);
}

/* Adds a voltage probe for each net that the netlist's author has named. */
static void add_nets(vs_fate *p) {
  const vs_elements *w = p->wiring;
  for (size_t k = 0; k < w->n_nodes; k++) {
    const vs_elements_node *n = &w->nodes[k];
    char wanted[VS_DECK_NAME], name[VS_DECK_NAME];
    if (!n->named || !strcmp(n->name, "0") ||
        (p->roles->coil_r && n->ends == 2 &&
         vs_elements_next(w, p->roles->coil, (int)k) == p->roles->coil_r))
      continue;
    snprintf(wanted, sizeof wanted, "v_%.50s", n->name);
    if (!strcmp(wanted, "v_eva") || !strcmp(wanted, "v_mains")) strcat(wanted, "_net");
    vs_declared_name(&p->sheet, wanted, name);
    vs_declared_add(&p->sheet, VS_DECLARED_PROBE, "%s = v(%s) V \"net %s\"", name, n->name,
                    n->said);
  }
}

/* Adds the energies of couplings, and notes which elements nothing is measured of. */
static void note_unmeasured(vs_fate *p) {
  vs_text unknown = {0}, together = {0};
  for (size_t k = 0; k < p->wiring->count; k++) {
    const vs_element *e = &p->wiring->elements[k];
    if (p->of[k].pins.kind || vs_roles_gate_of(p->roles, e) >= 0) continue;
    vs_text *t = e->letter == 'k' && !add_coupling(p, e) ? &together
                 : strchr("xatuo", e->letter)            ? &unknown
                                                         : NULL;
    if (t) vs_text_add(t, "%s%s", t->length ? ", " : "", e->name);
  }
  if (together.text)
    vs_declared_note(&p->sheet.left,
                     "%s: the energy of the coupling is not counted: a line '*$ store "
                     "NAME = K*sqrt(L1*L2)*i(L1)*i(L2)' would",
                     together.text);
  if (unknown.text)
    vs_declared_note(&p->sheet.left,
                     "%s: nothing is measured of these: --pins NAME=akg (or 21g, dgs, "
                     "cge, ak, varistor, fuse) says what one is",
                     unknown.text);
  vs_text_free(&unknown);
  vs_text_free(&together);
}

vs_status vs_lines_add(vs_fate *p, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < p->wiring->count && !status; k++)
    status = vs_error_keep(err, check_part(p, &p->wiring->elements[k], &p->of[k], err));
  add_valves(p);
  add_line(p);
  add_sources(p);
  add_others(p);
  add_controlled(p);
  add_passives(p);
  add_across(p);
  add_nets(p);
  note_unmeasured(p);
  return status;
}
