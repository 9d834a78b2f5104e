/* SPDX-License-Identifier: GPL-3.0-or-later
 * A deck as the netlist that the solver is given, and the way back from what it says to the deck.
 */
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "deck/rules.h"

static const vs_shelf EVA_SHELF = {"subcircuit", "", ".inc"};

static void add_text(char ***lines, size_t *count, const char *text) {
  *lines = realloc(*lines, (*count + 1) * sizeof **lines);
  (*lines)[(*count)++] = vs_copy(text);
}

/* The deck's line, with the part's subcircuit where it names the parameter. */
static void add_deck_line(const vs_deck *deck, const char *line, char ***lines, size_t *count) {
  size_t n = 0;
  const char *name = vs_rules_instance_of(line, &n);
  for (size_t p = 0; name && p < deck->n_parts; p++) {
    if (strlen(deck->parts[p].name) != n || strncasecmp(name, deck->parts[p].name, n)) continue;
    vs_text text = {0};
    vs_text_add(&text, "%.*s%s%s", (int)(name - line), line, deck->parts[p].subcircuit, name + n);
    add_text(lines, count, text.text);
    vs_text_free(&text);
    return;
  }
  add_text(lines, count, line);
}

vs_status vs_netlist_make(const vs_deck *deck, const vs_circuit_values *values,
                          const vs_deck_value *standard, size_t n_standard, char ***lines,
                          size_t *count, vs_error *err) {
  *lines = NULL;
  *count = 0;
  char path[VS_PATH_SIZE], param[128];
  const char *own = deck->eva_led ? "eva_led" : "eva";
  vs_status status =
      vs_path_find(&EVA_SHELF, deck->eva_file ? deck->eva_file : own, (vs_where){0}, path, err);
  if (status) return status;
  FILE *eva = fopen(path, "r");
  if (!eva) return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
  add_text(lines, count, "vibrospice"); /* the first line of a netlist is its title */
  for (size_t k = 0; k < n_standard; k++) {
    snprintf(param, sizeof param, ".param %s=%.17g", standard[k].name, standard[k].value);
    add_text(lines, count, param);
  }
  for (size_t k = 1; k < deck->section.count; k++) {
    const vs_field *field = &deck->section.fields[k];
    if (field->kind != VS_REAL) continue;
    snprintf(param, sizeof param, ".param %s=%.17g", field->key,
             *(const double *)(const void *)((const char *)values + field->offset));
    add_text(lines, count, param);
  }
  for (size_t k = 0; k < deck->n_lines; k++) add_deck_line(deck, deck->lines[k].text, lines, count);
  char *line = NULL;
  size_t size = 0;
  while (getline(&line, &size, eva) >= 0) {
    line[strcspn(line, "\r\n")] = '\0';
    if (*line && *line != '*') add_text(lines, count, line);
  }
  free(line);
  fclose(eva);
  return VS_OK;
}

static bool has_term_at(const vs_deck *deck, const char *node) {
  char signal[VS_DECK_NAME + 4];
  snprintf(signal, sizeof signal, "v(%s)", node);
  for (size_t k = 0; k < deck->n_terms; k++)
    if (!strcasecmp(deck->terms[k].plus, signal) || !strcasecmp(deck->terms[k].minus, signal))
      return strcmp(node, "0") != 0;
  return false;
}

/* Does a store name a parameter that the line has, too? */
static bool has_store_of(const vs_deck *deck, const char *line) {
  for (size_t k = 0; k < deck->stores.count; k++) {
    const vs_formula *f = &deck->stores.item[k].formula;
    for (size_t n = 0; n < f->count; n++) {
      int name = vs_formula_name_of(&f->ops[n]);
      char braced[VS_DECK_NAME + 3];
      if (name < 0) continue;
      snprintf(braced, sizeof braced, "{%s}", deck->names[name].name);
      if (strcasestr(line, braced)) return true;
    }
  }
  return false;
}

bool vs_netlist_hides_state(const vs_deck *deck) {
  for (size_t k = 0; k < deck->n_lines; k++) {
    const vs_line *line = &deck->lines[k];
    char name[VS_DECK_NAME], plus[VS_DECK_NAME], minus[VS_DECK_NAME];
    if (line->where.file != deck->files[0] || !strchr("cClL", *line->text)) continue;
    if (sscanf(line->text, "%63s %63s %63s", name, plus, minus) != 3) continue;
    if (!has_term_at(deck, plus) && !has_term_at(deck, minus) && !has_store_of(deck, line->text))
      return true;
  }
  return false;
}

void vs_netlist_free(char **lines, size_t count) {
  for (size_t k = 0; k < count; k++) free(lines[k]);
  free(lines);
}

/* ---- where it is ---- */

static bool is_word(char c) {
  return isalnum((unsigned char)c) || c == '_';
}

/* The first whole word of that name in the line at or after `from`; NULL: none. */
static const char *find_word(const char *line, const char *from, const char *word, size_t n) {
  for (const char *s = from; *s; s++)
    if (!strncasecmp(s, word, n) && !is_word(s[n]) && (s == line || !is_word(s[-1]))) return s;
  return NULL;
}

static const char PARAMETER[] = "ndefined parameter ["; /* as ngspice says it */

/* What a message puts between two signs; NULL: nothing. */
static const char *find_quoted(const char *message, const char *open, char close, size_t *length) {
  const char *begin = strstr(message, open), *end;
  if (!begin) return NULL;
  begin += strlen(open);
  end = strchr(begin, close);
  *length = end ? (size_t)(end - begin) : 0;
  return end ? begin : NULL;
}

/* Is the line of the element that the message speaks of: "...: r1 a b ...", "...: r1: ...",
 * "... instance r1 ...", "... check node r1#branch"? */
static bool is_element_of(const char *line, const char *message) {
  static const char *const BEFORE[] = {": ", "instance ", "check node "};
  size_t n = strcspn(line, " \t");
  if (n < 2 || *line == '.' || *line == '+') return false;
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++)
    for (const char *s = message; (s = strstr(s, BEFORE[k]));) {
      s += strlen(BEFORE[k]);
      if (!strncasecmp(s, line, n) && strchr(" :#", s[n])) return true;
    }
  return false;
}

/* Where in the line stands what the message speaks of; NULL: not in this line. */
static const char *find_subject(const char *line, const char *message) {
  size_t n = 0;
  const char *name = find_quoted(message, PARAMETER, ']', &n);
  if (name) { /* a parameter: in an expression, so behind the first '{', quote or '=' */
    const char *from = strpbrk(line, "{'=");
    return from ? find_word(line, from, name, n) : NULL;
  }
  const char *expression = strstr(message, "xpression err: ");
  if (expression) return strcasestr(line, expression + 15);
  name = find_quoted(message, " '", '\'', &n);
  const char *word = name ? find_word(line, line, name, n) : NULL;
  if (is_element_of(line, message)) return word ? word : line;
  return strstr(message, "circuit: no such function '") ? word : NULL;
}

void vs_netlist_locate(const vs_deck *deck, vs_error *err) {
  const char *signal = strstr(err->text, "the circuit has no ");
  vs_where where = {0};
  for (size_t k = 0; k < deck->n_terms && signal; k++)
    if (!strcmp(signal + 19, deck->terms[k].plus) || !strcmp(signal + 19, deck->terms[k].minus))
      where = deck->terms[k].where;
  for (size_t k = 0; k < deck->n_lines && !where.file; k++) {
    const vs_line *line = &deck->lines[k];
    const char *at = find_subject(line->text, err->text);
    if (!at) continue;
    where = line->where;
    if ((size_t)(at - line->text) < line->first) where.column += vs_text_column(line->text, at) - 1;
  }
  if (!where.file) where.file = deck->files[0];
  vs_error plain = *err;
  vs_fail_at(err, where, "%s%s", plain.text,
             strstr(plain.text, PARAMETER)
                 ? "; '.param NAME=...' or '*$ param NAME = ...' defines one"
                 : "");
}
