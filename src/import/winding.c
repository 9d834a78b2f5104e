/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "winding.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "netlist/words.h"

/* The value of an R, L or C: its first word after the nodes, or R=, L=, C=. */
static bool value_of(const vs_roles_search *f, const vs_element *e, double *value) {
  char *word = vs_elements_word_of(f->w, e, e->n_nodes + 1);
  char *option = vs_elements_option(f->w, e, (char[]){e->letter, '\0'});
  bool known = vs_values_of(f->v, option ? option : word, value);
  free(word);
  free(option);
  return known;
}

/* True where the inductor's own line puts something across it: LTspice's Rpar= or Cpar=. */
static bool has_across(const vs_roles_search *f, const vs_element *coil) {
  return vs_elements_sets(f->w, f->v, coil, "rpar") || vs_elements_sets(f->w, f->v, coil, "cpar");
}

/* True where an expression, or a statement, asks for that voltage or current: v(NODE), v(a,NODE),
 * i(ELEMENT). */
static bool is_asked_for(const vs_roles_search *f, char quantity, const char *name) {
  const vs_listing *l = f->w->listing;
  size_t n = strcspn(name, " \t");
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *card = &l->cards[k];
    if (card->depth > 0 || card->kind == VS_CARD_COMMENT || vs_listing_is(card, ".save")) continue;
    for (const char *at = card->text; (at = vs_words_find(card->text, at, name, n)); at += n) {
      const char *open = at;
      while (open > card->text && !strchr("()", open[-1])) open--;
      if (open > card->text + 1 && open[-1] == '(' && tolower((unsigned char)open[-2]) == quantity)
        return true;
    }
  }
  return false;
}

/* The resistor in series with an inductor, at either end; NULL: there is none, or it does not
 * belong to the coil because something is connected across the inductor alone, or because the
 * netlist asks for the voltage between the two or for the resistor's current. */
static const vs_element *resistor_of(const vs_roles_search *f, const vs_element *coil) {
  if (has_across(f, coil)) return NULL;
  for (int n = 1; n >= 0; n--) {
    const vs_element *next = vs_elements_next(f->w, coil, coil->nodes[n]);
    if (!next || next->letter != 'r' || is_asked_for(f, 'v', f->w->nodes[coil->nodes[n]].said) ||
        is_asked_for(f, 'i', f->w->listing->cards[next->card].text))
      continue;
    return next;
  }
  return NULL;
}

/* Sets the ends of the coil. Its current flows as the inductor's, from the first node on. */
static vs_status join(vs_roles_search *f, const vs_element *l, const vs_element *r) {
  vs_roles *roles = f->roles;
  roles->coil = l;
  roles->coil_r = r;
  roles->coil_plus = l->nodes[0];
  roles->coil_minus = l->nodes[1];
  for (int n = 0; n < 2 && r; n++) {
    if (vs_elements_next(f->w, l, l->nodes[n]) != r) continue;
    int far = r->nodes[0] == l->nodes[n] ? r->nodes[1] : r->nodes[0];
    *(n ? &roles->coil_minus : &roles->coil_plus) = far;
    return VS_OK;
  }
  return r ? vs_fail_at(f->err, vs_elements_where(f->w, r, 0),
                        "--coil %s+%s: they are not in series, one node alone between them",
                        l->name, r->name)
           : VS_OK;
}

/* Error: the element has an option that multiplies it or sets its temperature. */
static vs_status check_options(const vs_roles_search *f, const vs_element *e) {
  static const char *const OPTIONS[] = {"m", "scale", "temp", "dtemp"};
  vs_status status = VS_OK;
  for (size_t k = 0; k < sizeof OPTIONS / sizeof *OPTIONS && !status; k++) {
    char *value = vs_elements_option(f->w, e, OPTIONS[k]);
    if (value)
      status = vs_fail_at(f->err, vs_elements_where(f->w, e, 0),
                          "%s: the coil's %s=%s is not taken; write the value that it makes",
                          e->name, OPTIONS[k], value);
    free(value);
  }
  return status;
}

/* True where the element's value depends on temperature. */
static bool follows_temperature(const vs_roles_search *f, const vs_element *e) {
  return vs_elements_sets(f->w, f->v, e, "tc") || vs_elements_sets(f->w, f->v, e, "tc1") ||
         vs_elements_sets(f->w, f->v, e, "tc2");
}

static vs_status set_coil(vs_roles_search *f, const vs_element *l, const vs_element *r) {
  vs_roles *roles = f->roles;
  vs_where where = vs_elements_where(f->w, l, 0);
  double own = 0;
  if (l->coupled)
    return vs_fail_at(f->err, where,
                      "%s is coupled with another inductor (K...); the EVA's coil is a branch of "
                      "its own: --coil names it",
                      l->name);
  if (!value_of(f, l, &roles->inductance_h) || !(roles->inductance_h > 0))
    return vs_fail_at(f->err, where, "%s: its inductance is not known before a run, as a number",
                      l->name);
  roles->resistance_ohm = 0;
  if (r && (!value_of(f, r, &roles->resistance_ohm) || roles->resistance_ohm < 0))
    return vs_fail_at(f->err, vs_elements_where(f->w, r, 0),
                      "%s: its resistance is not known before a run, as a number", r->name);
  char *rser = vs_elements_option(f->w, l, "rser");
  bool known = !rser || vs_values_of(f->v, rser, &own);
  free(rser);
  if (!known)
    return vs_fail_at(f->err, where, "%s: Rser is not known before a run, as a number", l->name);
  if (r && has_across(f, l))
    return vs_fail_at(f->err, where,
                      "%s has Rpar or Cpar, which %s is not across; --coil %s takes the inductor "
                      "alone, and %s stays in the circuit",
                      l->name, r->name, l->name, r->name);
  roles->resistance_ohm += own;
  roles->begins_with_current = vs_elements_sets(f->w, f->v, l, "ic");
  roles->heats = follows_temperature(f, l) ? l : r && follows_temperature(f, r) ? r : NULL;
  roles->modelled = vs_elements_has_model(f->w, l)        ? l
                    : r && vs_elements_has_model(f->w, r) ? r
                                                          : NULL;
  vs_status status = check_options(f, l);
  if (!status && r) status = check_options(f, r);
  return status ? status : join(f, l, r);
}

/* --coil L1+R4 */
static vs_status set_named_coil(vs_roles_search *f, const char *asked) {
  const vs_element *l = NULL, *r = NULL;
  char *all = vs_copy(asked), *rest = all;
  vs_status status = VS_OK;
  for (char *name; !status && (name = strsep(&rest, "+,"));) {
    const vs_element *e = NULL;
    status = vs_roles_named(f, "coil", name, &e);
    if (status) break;
    const vs_element **role = e->letter == 'l' ? &l : &r;
    if ((e->letter != 'l' && e->letter != 'r') || *role)
      status = vs_fail_at(f->err, vs_elements_where(f->w, e, 0),
                          "--coil %s: an inductor is wanted, and one resistor at most in series "
                          "with it",
                          asked);
    *role = e;
  }
  free(all);
  if (!status && !l)
    status = vs_fail_at(f->err, vs_elements_where(f->w, r, 0),
                        "--coil %s: the inductor is missing, as in L1+%s", asked, asked);
  return status ? status : set_coil(f, l, r);
}

vs_status vs_winding_find(vs_roles_search *f, const char *asked) {
  const vs_element *found = NULL;
  vs_text all = {0};
  size_t count = 0;
  if (asked) return set_named_coil(f, asked);
  for (size_t k = 0; k < f->w->count; k++) {
    const vs_element *e = &f->w->elements[k];
    if (e->letter != 'l' || e->coupled) continue;
    const vs_element *r = resistor_of(f, e);
    vs_text_add(&all, "%s%s%s%s", count++ ? ", " : "", e->name, r ? "+" : "", r ? r->name : "");
    found = e;
  }
  vs_status status = VS_OK;
  if (count > 1)
    status = vs_fail_at(f->err, vs_elements_where(f->w, found, 0),
                        "%zu inductors could be the EVA's coil: --coil says which, one of %s",
                        count, all.text);
  else if (!found)
    status = vs_fail_at(f->err, vs_roles_file(f),
                        "no inductor, L..., outside of subcircuits and not coupled: the EVA's coil "
                        "is missing; --coil L1+R4 names one with its series resistor");
  else
    status = set_coil(f, found, resistor_of(f, found));
  f->roles->found_coil = found;
  vs_text_free(&all);
  return status;
}
