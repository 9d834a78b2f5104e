/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coined.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* True where a node, an element, a parameter or a function of the netlist has this name. */
static bool is_taken(const vs_coined *c, const char *name) {
  const vs_cards *n = &c->wiring->listing->netlist;
  bool taken = vs_elements_is_taken(c->wiring, name) || vs_values_find(c->values, name) ||
               vs_names_find(&n->globals, name, strlen(name), NULL);
  for (size_t k = 0; k < n->n_definitions && !taken; k++)
    taken = n->definition[k].kind == VS_CARDS_FUNC && vs_words_is(n->definition[k].name, name);
  return taken;
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
