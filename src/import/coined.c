/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/coined.h"

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

/* True where a line .func or .global has the name. */
static bool is_in_statement(const vs_listing *l, const char *name) {
  char function[VS_VALUES_NAME];
  const size_t n = strlen(name);
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *card = &l->cards[k];
    vs_coined_function(card, function);
    if (!strcasecmp(function, name)) return true;
    if (!vs_listing_is(card, ".global")) continue;
    for (const char *s = card->text; *(s += strspn(s, " \t,")); s += strcspn(s, " \t,"))
      if (strcspn(s, " \t,") == n && !strncasecmp(s, name, n)) return true;
  }
  return false;
}

/* True where the netlist calls a node, an element, a parameter or a function so, or has a node of
 * that name in all subcircuits (.global). */
static bool is_taken(const vs_elements *w, const vs_values *v, const char *name) {
  return vs_elements_is_taken(w, name) || vs_values_find(v, name) ||
         is_in_statement(w->listing, name);
}

void vs_coined_name(const vs_elements *w, const vs_values *v, const char *first, const char *key,
                    const char *last, char name[VS_ELEMENTS_NAME]) {
  snprintf(name, VS_ELEMENTS_NAME, "%s%.44s%s", first, key, last);
  for (int k = 2; is_taken(w, v, name); k++)
    snprintf(name, VS_ELEMENTS_NAME, "%s%.40s%s_%d", first, key, last, k);
}

/* True where one of the names that are made of a stem is the netlist's, or the stem is another
 * element's. */
static bool is_used(const vs_elements *w, const vs_values *v, const vs_element *source,
                    const char *stem) {
  static const char *const MADE[][2] = {
      {"", "_on"},     {"", "_on2"},    {"", "_edge"},   {"", "_edge2"},  {"", "_low"},
      {"", "_low2"},   {"", "_ser"},    {"Vgate_", ""},  {"Vgate2_", ""}, {"Egate_", ""},
      {"Egate2_", ""}, {"Ggate_", ""},  {"Ggate2_", ""}, {"Bedge_", ""},  {"Bedge2_", ""},
      {"Cedge_", ""},  {"Cedge2_", ""}, {"Rser_", ""}};
  const vs_element *other = vs_elements_find(w, stem);
  char name[VS_ELEMENTS_NAME];
  bool used = other && other != source;
  for (size_t k = 0; k < sizeof MADE / sizeof *MADE && !used; k++) {
    snprintf(name, sizeof name, "%s%.50s%s", MADE[k][0], stem, MADE[k][1]);
    used = is_taken(w, v, name);
  }
  return used;
}

void vs_coined_stem(const vs_elements *w, const vs_values *v, const vs_element *source,
                    char stem[VS_ELEMENTS_NAME]) {
  snprintf(stem, VS_ELEMENTS_NAME, "%.44s", source->key);
  for (int k = 2; is_used(w, v, source, stem); k++)
    snprintf(stem, VS_ELEMENTS_NAME, "%.40s_%d", source->key, k);
}
