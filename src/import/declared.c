/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "declared.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* How many lines of each kind a deck may have. Some of the parameters are reserved for the files of
 * parts. */
static const struct {
  const char *word;
  size_t most;
} KINDS[VS_DECLARED_KINDS] = {
    {"param ", VS_DECK_MOST - 20}, {"port  ", VS_DECK_MOST}, {"line  ", 1},
    {"probe ", VS_DECK_MOST - 4},  {"rating", VS_DECK_MOST}, {"device", VS_DECK_DEVICES},
    {"loss  ", VS_DECK_MOST},      {"store ", VS_DECK_MOST}};

static void free_notes(vs_declared_notes *notes) {
  for (size_t k = 0; k < notes->count; k++) free(notes->item[k]);
  free(notes->item);
}

void vs_declared_free(vs_declared *s) {
  for (int k = 0; k < VS_DECLARED_KINDS; k++) vs_text_free(&s->lines[k]);
  free_notes(&s->did);
  free_notes(&s->left);
  vs_names_free(&s->names);
  *s = (vs_declared){0};
}

/* Finds the next term in a line, "v(...)" or "i(...)". Returns the text after it; NULL: there is
 * none. */
static const char *next_term(const char *line, char term[2 * VS_DECK_NAME]) {
  for (const char *s = line; *s; s++) {
    bool parted = s == line || !(isalnum((unsigned char)s[-1]) || strchr("_.", s[-1]));
    if (!parted || !strchr("vi", *s) || s[1] != '(') continue;
    size_t n = strcspn(s, ")") + 1;
    snprintf(term, 2 * VS_DECK_NAME, "%.*s", (int)n, s);
    return s + n;
  }
  return NULL;
}

static bool has_term(const vs_declared *s, const char *term) {
  for (size_t k = 0; k < s->n_terms; k++)
    if (!strcasecmp(s->terms[k], term)) return true;
  return false;
}

static bool has_room(const vs_declared *s, int kind, const char *line) {
  char term[2 * VS_DECK_NAME];
  size_t more = 0;
  if (s->counts[kind] >= KINDS[kind].most) return false;
  for (const char *at = line; (at = next_term(at, term));) more += !has_term(s, term);
  return s->n_terms + more <= VS_DECK_MOST;
}

bool vs_declared_add(vs_declared *s, int kind, const char *format, ...) {
  char line[1024], term[2 * VS_DECK_NAME];
  va_list list;
  va_start(list, format);
  int size = vsnprintf(line, sizeof line, format, list);
  va_end(list);
  if (size < 0 || (size_t)size >= sizeof line || !has_room(s, kind, line)) {
    s->left_out++;
    return false;
  }
  for (const char *at = line; (at = next_term(at, term));)
    if (!has_term(s, term)) memcpy(s->terms[s->n_terms++], term, sizeof term);
  vs_text_add(&s->lines[kind], "*$ %s %s\n", KINDS[kind].word, line);
  s->counts[kind]++;
  return true;
}

void vs_declared_param(vs_declared *s, const char *name, char letter, double value,
                       const char *text) {
  static const struct {
    char letter;
    const char *unit;
    double factor;
  } UNITS[] = {{'r', "mohm", 1e-3}, {'r', "ohm", 1},    {'r', "kohm", 1e3}, {'r', "Mohm", 1e6},
               {'c', "fF", 1e-15},  {'c', "pF", 1e-12}, {'c', "nF", 1e-9},  {'c', "uF", 1e-6},
               {'c', "mF", 1e-3},   {'l', "nH", 1e-9},  {'l', "uH", 1e-6},  {'l', "mH", 1e-3},
               {'l', "H", 1},       {'v', "V", 1},      {'i', "A", 1}};
  const char *unit = "";
  double factor = 1, least = INFINITY;
  for (size_t k = 0; k < sizeof UNITS / sizeof *UNITS; k++) {
    double shown = fabs(value) / UNITS[k].factor;
    if (UNITS[k].letter != letter || (shown < 1 && !isinf(least))) continue;
    unit = UNITS[k].unit;
    factor = UNITS[k].factor;
    least = shown;
  }
  double shown = value / factor, low = shown * (shown < 0 ? 1e3 : 1e-3),
         high = shown * (shown < 0 ? 1e-3 : 1e3);
  if (shown == 0) low = -1e3, high = 1e3;
  vs_declared_add(s, VS_DECLARED_PARAM, "%s = %.12g%s%s %.3g..%.3g \"%s\"", name, shown,
                  *unit ? " " : "", unit, low, high, text);
}

void vs_declared_name(vs_declared *s, const char *wanted, char name[VS_DECK_NAME]) {
  char made[VS_DECK_NAME];
  snprintf(made, sizeof made, "%.50s", wanted);
  for (int n = 2; vs_names_find(&s->names, made, strlen(made), NULL); n++)
    snprintf(made, sizeof made, "%.50s_%d", wanted, n);
  memcpy(name, made, sizeof made);
  vs_names_put(&s->names, made, strlen(made), 0);
}

void vs_declared_note(vs_declared_notes *notes, const char *format, ...) {
  char line[1024];
  va_list list;
  va_start(list, format);
  vsnprintf(line, sizeof line, format, list);
  va_end(list);
  notes->item = vs_alloc_grow(notes->item, notes->count, sizeof *notes->item);
  notes->item[notes->count++] = vs_copy(line);
}

void vs_declared_write(const vs_declared *s, vs_text *out) {
  for (int k = 0; k < VS_DECLARED_KINDS; k++)
    if (s->lines[k].text) vs_text_add(out, "%s", s->lines[k].text);
}

void vs_declared_voltage(const char *from, const char *to, char text[VS_DECK_TEXT]) {
  if (!strcmp(to, "0"))
    snprintf(text, VS_DECK_TEXT, "v(%s)", from);
  else if (!strcmp(from, "0"))
    snprintf(text, VS_DECK_TEXT, "-v(%s)", to);
  else
    snprintf(text, VS_DECK_TEXT, "v(%s,%s)", from, to);
}
