/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coined.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

void vs_coined_function(const vs_card *card, char name[VS_VALUES_NAME]) {
  const char *s = card->text + strcspn(card->text, " \t");
  *name = '\0';
  if (!vs_listing_is(card, ".func")) return;
  s += strspn(s, " \t");
  snprintf(name, VS_VALUES_NAME, "%.*s", (int)strcspn(s, " \t({"), s);
}

void vs_coined_begin(vs_coined *c, const vs_elements *w, const vs_values *v) {
  char function[VS_VALUES_NAME], node[VS_ELEMENTS_NAME];
  *c = (vs_coined){w, v, {0}};
  for (size_t k = 0; k < w->listing->count; k++) {
    const vs_card *card = &w->listing->cards[k];
    vs_coined_function(card, function);
    if (*function) vs_names_put(&c->said, function, k);
    if (!vs_listing_is(card, ".global")) continue;
    for (const char *s = card->text; *(s += strspn(s, " \t,")); s += strcspn(s, " \t,")) {
      snprintf(node, sizeof node, "%.*s", (int)strcspn(s, " \t,"), s);
      vs_names_put(&c->said, node, k);
    }
  }
}

void vs_coined_end(vs_coined *c) {
  vs_names_free(&c->said);
}

/* True where a node, an element, a parameter or a function of the netlist has this name. */
static bool is_taken(const vs_coined *c, const char *name) {
  return vs_elements_is_taken(c->wiring, name) || vs_values_find(c->values, name) ||
         vs_names_find(&c->said, name, strlen(name), NULL);
}

void vs_coined_name(const vs_coined *c, const char *first, const char *key, const char *last,
                    char name[VS_ELEMENTS_NAME]) {
  snprintf(name, VS_ELEMENTS_NAME, "%s%.44s%s", first, key, last);
  for (int k = 2; is_taken(c, name); k++)
    snprintf(name, VS_ELEMENTS_NAME, "%s%.40s%s_%d", first, key, last, k);
}

/* True where one of the names made of this stem is taken in the netlist, or the stem belongs to
 * another element already. */
static bool is_used(const vs_coined *c, const vs_element *source, const char *stem) {
  static const char *const MADE[][2] = {
      {"", "_on"},     {"", "_on2"},    {"", "_edge"},   {"", "_edge2"},  {"", "_low"},
      {"", "_low2"},   {"", "_ser"},    {"Vgate_", ""},  {"Vgate2_", ""}, {"Egate_", ""},
      {"Egate2_", ""}, {"Ggate_", ""},  {"Ggate2_", ""}, {"Bedge_", ""},  {"Bedge2_", ""},
      {"Cedge_", ""},  {"Cedge2_", ""}, {"Rser_", ""}};
  const vs_element *other = vs_elements_find(c->wiring, stem);
  char name[VS_ELEMENTS_NAME];
  bool used = other && other != source;
  for (size_t k = 0; k < sizeof MADE / sizeof *MADE && !used; k++) {
    snprintf(name, sizeof name, "%s%.50s%s", MADE[k][0], stem, MADE[k][1]);
    used = is_taken(c, name);
  }
  return used;
}

void vs_coined_stem(const vs_coined *c, const vs_element *source, char stem[VS_ELEMENTS_NAME]) {
  snprintf(stem, VS_ELEMENTS_NAME, "%.44s", source->key);
  for (int k = 2; is_used(c, source, stem); k++)
    snprintf(stem, VS_ELEMENTS_NAME, "%.40s_%d", source->key, k);
}
