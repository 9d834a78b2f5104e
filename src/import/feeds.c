/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "feeds.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "copying.h"

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

void vs_feeds_add(vs_fate *p) {
  add_line(p);
  add_sources(p);
}
