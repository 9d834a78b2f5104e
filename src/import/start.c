/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "start.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/cards.h"
#include "netlist/words.h"

/* True where the line has a dialect's word for a start without an operating point. LTspice's
 * `startup` begins with all sources at 0. */
static bool begins_at_0(const vs_card *tran) {
  static const char *const WORDS[] = {"uic", "skipbp", "startup"};
  char *text = vs_copy(tran->text), *rest = text;
  bool found = false;
  for (char *word; (word = strsep(&rest, " \t,"));)
    for (size_t k = 0; k < sizeof WORDS / sizeof *WORDS; k++)
      found = found || !strcasecmp(word, WORDS[k]);
  free(text);
  return found;
}

/* The netlist's last .tran; NULL: it has none. */
static const vs_card *find_tran(const vs_listing *l) {
  const vs_card *tran = NULL;
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *c = &l->cards[k];
    if (c->kind == VS_CARD_STATEMENT && !c->included && vs_listing_is(c, ".tran")) tran = c;
  }
  return tran;
}

/* The first source that is not 0 at t = 0. A gate's source without a pulse is left out, as the user
 * said that the program pulses it. */
static const vs_element *find_source(const vs_elements *w, const vs_values *v, const vs_roles *r) {
  for (size_t k = 0; k < w->count; k++) {
    const vs_element *e = &w->elements[k];
    int gate = vs_roles_gate_of(r, e);
    if (!strchr("vi", e->letter) || (gate >= 0 && isnan(r->gates[gate].pulse.at_s))) continue;
    if (!vs_course_begins_at_0(w, v, e)) return e;
  }
  return NULL;
}

/* True where an element of the netlist itself is an instance of the subcircuit of that scope. */
static bool is_instantiated(const vs_listing *l, size_t scope) {
  bool is = false;
  for (size_t k = 0; k < l->count && !is; k++)
    is = !l->cards[k].included && vs_cards_called(&l->netlist, &l->netlist.card[k]) == scope;
  return is;
}

/* Adds the name of the first source that is not 0 at t = 0 in a subcircuit that the netlist defines
 * and uses. Nested subcircuits are not examined. */
static void find_inner_source(const vs_elements *w, const vs_values *v, vs_text *name) {
  const vs_listing *l = w->listing;
  const vs_cards *c = &l->netlist;
  for (size_t scope = 1; scope < c->n_scopes; scope++) {
    const vs_netlist_scope *in = &c->scope[scope];
    if (in->outer || l->cards[in->first].included || !is_instantiated(l, scope)) continue;
    for (size_t k = in->first; k < in->last; k = vs_cards_next(c, k)) {
      vs_element e;
      if (c->card[k].kind != VS_CARDS_ELEMENT || !strchr("vi", c->card[k].letter)) continue;
      vs_elements_source_of(l, k, &e);
      if (vs_course_begins_at_0(w, v, &e)) continue;
      vs_text_add(name, "%s of subcircuit %.*s", e.name, (int)in->name.n, in->name.at);
      return;
    }
  }
}

static bool has_initial(const vs_elements *w, const vs_element *e) {
  char *ic = vs_elements_option(w, e, "ic");
  free(ic);
  return ic != NULL;
}

static void list_stores(const vs_elements *w, const vs_roles *r, vs_text *names) {
  enum { SHOWN = 6 };
  int count = 0;
  for (size_t k = 0; k < w->count; k++) {
    const vs_element *e = &w->elements[k];
    if (!strchr("cl", e->letter) || e == r->coil || has_initial(w, e)) continue;
    if (count < SHOWN) vs_text_add(names, "%s%s", count ? ", " : "", e->name);
    if (count++ == SHOWN) vs_text_add(names, ", ...");
  }
}

void vs_start_find(const vs_elements *w, const vs_values *v, const vs_roles *r, vs_start *s) {
  const vs_card *tran = find_tran(w->listing);
  *s = (vs_start){0};
  if (!tran || begins_at_0(tran)) return;
  const vs_element *source = find_source(w, v, r);
  if (source)
    vs_text_add(&s->source, "%s", source->name);
  else
    find_inner_source(w, v, &s->source);
  if (s->source.text) list_stores(w, r, &s->stores);
  if (s->stores.text) s->tran = tran;
}

void vs_start_free(vs_start *s) {
  vs_text_free(&s->source);
  vs_text_free(&s->stores);
}
