/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deck/netlist.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/jail.h"
#include "base/text.h"
#include "deck/devices.h"
#include "deck/eva.h"
#include "deck/files.h"
#include "deck/parts.h"
#include "deck/rules.h"

/* ---- files ---- */

/* Holds ports and external sources against each other: each port drives one source, and a source
 * that no port drives would stay at 0 V. */
static vs_status match_sources(const vs_deck *deck, vs_error *err) {
  bool driven[VS_DECK_MOST] = {false};
  vs_status status = VS_OK;
  for (size_t k = 0; k < deck->n_lines && !status; k++) {
    char name[VS_DECK_NAME];
    if (!vs_rules_is_external(deck->lines[k].text, name)) continue;
    size_t p = 0;
    while (p < deck->n_ports && strcmp(deck->ports[p].source, name)) p++;
    if (p < deck->n_ports)
      driven[p] = true;
    else if (!(deck->lost & VS_LOST_PORT))
      status = vs_error_carry_on(
          err, vs_fail_at(err, deck->lines[k].where,
                          "the external source %s has no line '*$ port ... = %s'", name, name));
  }
  for (size_t p = 0; p < deck->n_ports && !status; p++)
    if (!driven[p] && !(deck->lost & VS_LOST_ELEMENT))
      status = vs_error_carry_on(err, vs_fail_at(err, deck->ports[p].where,
                                                 "port: the deck has no source '%s n m external'",
                                                 deck->ports[p].source));
  return status;
}

vs_status vs_netlist_read(const char *path, vs_deck *deck, vs_error *err) {
  vs_deck_begin(deck);
  deck->has_title_line = true;
  vs_status status = vs_files_read(deck, path, false, err);
  if (!status && deck->n_part_files)
    status = vs_error_carry_on(
        err, vs_fail_at(err, deck->part_files[0].where,
                        "'*$ part' belongs into a part's file, not into a deck; a deck takes "
                        "a part by a line '*$ param thyristor = NAME part thyristor'"));
  if (!status && !*deck->eva && !(deck->lost & VS_LOST_ELEMENT))
    status = vs_error_carry_on(err, vs_fail_at(err, (vs_where){.file = path},
                                               "has no EVA; a deck has one line 'Xeva n m eva'"));
  return status;
}

vs_status vs_netlist_read_part(const char *path, vs_deck *part, vs_error *err) {
  vs_deck_begin(part);
  return vs_files_read(part, path, false, err);
}

vs_status vs_netlist_read_library(const char *path, vs_deck *library, vs_error *err) {
  vs_deck_begin(library);
  return vs_files_read(library, path, true, err);
}

/* ---- parts ---- */

/* Finds the file of a part: at the path given, or in the deck's folder, or on the shelf of parts.
 */
static vs_status find_part(const vs_deck *deck, const char *name, vs_where where,
                           char path[VS_PATH_SIZE], vs_error *err) {
  const char *slash = strrchr(deck->files[0], '/');
  int folder = slash ? (int)(slash - deck->files[0] + 1) : 0;
  for (int ending = 0; ending < 2; ending++) {
    snprintf(path, VS_PATH_SIZE, "%.*s%s%s", *name == '/' ? 0 : folder, deck->files[0], name,
             ending ? vs_deck_parts_shelf.ending : "");
    struct stat s;
    vs_status status = vs_jail_check(path, where, err);
    if (status) return status;
    if (!stat(path, &s) && S_ISREG(s.st_mode)) return VS_OK;
  }
  return vs_path_find(&vs_deck_parts_shelf, name, where, path, err);
}

/* Gives the name of the subcircuit that a part's file must define: the file's own, without folders
 * and ending, in lower case. */
static void subcircuit_of(const char *path, char name[VS_DECK_NAME]) {
  const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
  snprintf(name, VS_DECK_NAME, "%.*s", (int)strcspn(base, "."), base);
  vs_cursor_lower(name);
}

static bool defines(const vs_deck *deck, const char *subcircuit) {
  for (size_t k = 0; k < deck->n_lines; k++) {
    const char *text = deck->lines[k].text;
    char name[VS_DECK_NAME];
    if (strncasecmp(text, ".subckt", 7) || !strchr(" \t", text[7]) ||
        sscanf(text + 7, " %63s", name) != 1)
      continue;
    if (!strcasecmp(name, subcircuit)) return true;
  }
  return false;
}

/* A subcircuit with parameters may have been given another name (dialect/translate.h). */
static void take_plain_name(const vs_deck *deck, char subcircuit[VS_DECK_NAME]) {
  char plain[VS_DECK_NAME];
  snprintf(plain, sizeof plain, "%s", subcircuit);
  for (char *c = plain; *c; c++)
    if (!isalnum((unsigned char)*c)) *c = '_';
  if (defines(deck, plain)) snprintf(subcircuit, VS_DECK_NAME, "%s", plain);
}

static vs_status take_part(vs_deck *deck, vs_part *part, const char *name, vs_where where,
                           vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_status status = find_part(deck, name, where, path, err);
  if (!status && !vs_files_has(deck, path)) status = vs_files_read(deck, path, false, err);
  if (status) return status;
  for (size_t k = 0; k < deck->n_files; k++)
    if (!strcmp(deck->files[k], path)) part->file = deck->files[k];
  subcircuit_of(path, part->subcircuit);
  if (!defines(deck, part->subcircuit)) take_plain_name(deck, part->subcircuit);
  return defines(deck, part->subcircuit) || deck->lost & VS_LOST_ELEMENT
             ? vs_parts_check_kind(deck, part, where, err)
             : vs_fail_at(err, where, "circuit.%s: %s defines no subcircuit '%s' (the file's name)",
                          part->name, path, part->subcircuit);
}

vs_status vs_netlist_read_parts(vs_deck *deck, const vs_node *section, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t p = 0, k = 1; p < deck->n_parts && !status; k++) {
    const vs_field *field = &deck->section.fields[k];
    if (field->kind != VS_NAME) continue;
    const vs_node *node = vs_tree_child(section, field->key);
    bool given = node && node->kind == VS_NODE_TEXT;
    vs_where where = given ? node->where : (vs_where){deck->files[0], 0, 0};
    status =
        vs_error_carry_on(err, take_part(deck, &deck->parts[p++],
                                         given ? node->text : field->default_text, where, err));
  }
  if (!status) status = vs_parts_resolve(deck, err);
  if (!status) status = vs_devices_resolve(deck, err);
  return status ? status : match_sources(deck, err);
}

/* ---- for the solver ---- */

static void add_text(char ***lines, size_t *count, const char *text) {
  *lines = vs_resize(*lines, *count + 1, sizeof **lines);
  (*lines)[(*count)++] = vs_copy(text);
}

/* Adds a line of the deck. Where it is an instance of a parameter that is a part, the part's
 * subcircuit takes the parameter's place. */
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
  char param[128], *rest;
  vs_text eva = {0};
  vs_status status = vs_eva_write(deck, &eva, err);
  if (status) return status;
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
  rest = eva.text;
  for (char *line; (line = strsep(&rest, "\n"));)
    if (*line) add_text(lines, count, line);
  vs_text_free(&eva);
  return VS_OK;
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

static const char PARAMETER[] =
    "ndefined parameter ["; /* from ngspice's message of an undefined parameter */

/* Finds what a message puts between `open` and `close`; NULL: nothing. */
static const char *find_quoted(const char *message, const char *open, char close, size_t *length) {
  const char *begin = strstr(message, open), *end;
  if (!begin) return NULL;
  begin += strlen(open);
  end = strchr(begin, close);
  *length = end ? (size_t)(end - begin) : 0;
  return end ? begin : NULL;
}

/* True where the message speaks of the line's element, by one of its ways: "...: r1 a b ...", "...:
 * r1: ...", "... instance r1 ...", "... check node r1#branch". */
static bool is_element_of(const char *line, const char *message) {
  static const char *const BEFORE[] = {": ", "instance ", "check node ", "(instance: x"};
  size_t n = strcspn(line, " \t");
  if (n < 2 || *line == '.' || *line == '+') return false;
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++)
    for (const char *s = message; (s = strstr(s, BEFORE[k]));) {
      s += strlen(BEFORE[k]);
      if (!strncasecmp(s, line, n) && strchr(" :#)", s[n])) return true;
    }
  return false;
}

/* Finds the node that a message speaks of in a line of an element: "check node b", "trouble with
 * node "xa.b"", of which the last part is looked for; NULL: it is not in this line. */
static const char *find_node(const char *line, const char *message) {
  static const char *const BEFORE[] = {"check node ", "trouble with node \""};
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE && *line != '.'; k++) {
    const char *s = strstr(message, BEFORE[k]);
    if (!s) continue;
    s += strlen(BEFORE[k]);
    size_t n = strcspn(s, " \"");
    for (size_t dot = 0; dot < n; dot++)
      if (s[dot] == '.') s += dot + 1, n -= dot + 1, dot = 0;
    const char *from = line + strcspn(line, " \t");
    return n ? find_word(line, from, s, n) : NULL;
  }
  return NULL;
}

static const char RANGE[] = "out of range for "; /* from ngspice's message of a function */

/* True where a message is of a power, x^y, however it is written. */
static bool is_of_power(const char *message) {
  const char *s = strstr(message, RANGE);
  return s && (s[strlen(RANGE)] == '^' || !strncmp(s + strlen(RANGE), "p", 1));
}

/* Finds the function whose argument was out of its range. */
static const char *find_function(const char *line, const char *message) {
  static const char *const POWERS[] = {"pow", "pwr", "pwrs"};
  const char *s = strstr(message, RANGE), *found = NULL;
  if (!s || *line == '.') return NULL;
  s += strlen(RANGE);
  found = find_word(line, line, s, strcspn(s, " "));
  if (found || !is_of_power(message) || !strchr("bBeEgG", *line)) return found;
  found = strstr(line, "**");
  if (!found) found = strchr(line, '^');
  for (size_t k = 0; k < sizeof POWERS / sizeof *POWERS && !found; k++)
    found = find_word(line, line, POWERS[k], strlen(POWERS[k]));
  return found;
}

/* Finds in the line what the message speaks of; NULL: it is not in this line. */
static const char *find_subject(const char *line, const char *message) {
  size_t n = 0;
  const char *name = find_quoted(message, PARAMETER, ']', &n);
  if (name) { /* a parameter stands in an expression, and so behind the first '{', quote or '=' */
    const char *from = *line == '.' ? strpbrk(line, "{'=( ") : strpbrk(line, "{'=");
    return from ? find_word(line, from, name, n) : NULL;
  }
  const char *expression = strstr(message, "xpression err: ");
  if (expression) return strcasestr(line, expression + 15);
  name = find_quoted(message, " '", '\'', &n);
  const char *word = name ? find_word(line, line, name, n) : NULL;
  if (is_element_of(line, message)) return word ? word : line;
  return strstr(message, "circuit: no such function '") ? word : NULL;
}

/* Finds the first line in which `find` finds what a message speaks of. */
static vs_where place_in_lines(const vs_deck *deck, const char *message,
                               const char *(*find)(const char *line, const char *message)) {
  for (size_t k = 0; k < deck->n_lines; k++) {
    const vs_line *line = &deck->lines[k];
    const char *at = find(line->written ? line->written : line->text, message);
    if (at) return vs_line_place(line, at);
    if (line->written && find(line->text, message)) return line->where;
  }
  return (vs_where){0};
}

void vs_netlist_locate(const vs_deck *deck, vs_error *err) {
  const char *signal = strstr(err->text, "the circuit has no ");
  vs_where where = {0};
  for (size_t k = 0; k < deck->n_terms && signal; k++)
    if (!strcmp(signal + 19, deck->terms[k].plus) || !strcmp(signal + 19, deck->terms[k].minus))
      where = deck->terms[k].where;
  if (!where.file) where = place_in_lines(deck, err->text, find_subject);
  if (!where.file) where = place_in_lines(deck, err->text, find_node);
  if (!where.file) where = place_in_lines(deck, err->text, find_function);
  if (!where.file) where.file = deck->files[0];
  vs_error plain = *err;
  vs_fail_at(err, where, "%s%s", plain.text,
             strstr(plain.text, PARAMETER)
                 ? "; '.param NAME=...' or '*$ param NAME = ...' defines one"
             : is_of_power(plain.text)
                 ? "; a power below 0 has no value where x is 0, one below 1 no slope: write "
                   "max(abs(x), 1u) for x"
                 : "");
}
