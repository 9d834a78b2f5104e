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

/* True where an element of the netlist itself is an instance of this subcircuit. */
static bool is_instantiated(const vs_listing *l, vs_word name) {
  for (size_t k = 0; k < l->count; k++)
    if (l->cards[k].kind == VS_CARD_ELEMENT && !l->cards[k].included &&
        !vs_words_compare(vs_cards_instance_of(l->cards[k].text), name))
      return true;
  return false;
}

/* The name of the subcircuit that a .subckt line begins; empty for other lines. */
static vs_word subcircuit_of(const vs_card *card) {
  const char *s = card->text + strcspn(card->text, " \t");
  s += strspn(s, " \t");
  return (vs_word){s, vs_listing_is(card, ".subckt") ? strcspn(s, " \t(") : 0};
}

/* Adds the name of the first source that is not 0 at t = 0 in a subcircuit that the netlist defines
 * and uses. Nested subcircuits are not examined. */
static void find_inner_source(const vs_elements *w, const vs_values *v, vs_text *name) {
  const vs_listing *l = w->listing;
  vs_word in = {"", 0};
  bool used = false;
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *card = &l->cards[k];
    if (card->included || card->depth != 1) continue;
    vs_word begun = subcircuit_of(card);
    vs_element e;
    if (begun.n) in = begun, used = is_instantiated(l, in);
    if (!used || card->kind != VS_CARD_ELEMENT || !strchr("vViI", *card->text)) continue;
    vs_elements_source_of(l, k, &e);
    if (vs_course_begins_at_0(w, v, &e)) continue;
    vs_text_add(name, "%s of subcircuit %.*s", e.name, (int)in.n, in.at);
    return;
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
