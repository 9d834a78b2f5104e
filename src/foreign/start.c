/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foreign/start.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* True where the line has one of the words of the dialects for a start without an operating point.
 * LTspice's startup has all sources at 0 there. */
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

/* The first source that is not 0 at t = 0. A gate's source without a pulse is left out: that the
 * program pulses it is the user's word. */
static const vs_element *find_source(const vs_elements *w, const vs_values *v, const vs_roles *r) {
  for (size_t k = 0; k < w->count; k++) {
    const vs_element *e = &w->elements[k];
    int gate = vs_roles_gate_of(r, e);
    if (!strchr("vi", e->letter) || (gate >= 0 && isnan(r->gates[gate].pulse.at_s))) continue;
    if (!vs_course_begins_at_0(w, v, e)) return e;
  }
  return NULL;
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
  s->source = find_source(w, v, r);
  if (s->source) list_stores(w, r, &s->stores);
  if (s->stores.text) s->tran = tran;
}

void vs_start_free(vs_start *s) {
  vs_text_free(&s->stores);
}
