/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deck/netlist.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "deck/contract.h"
#include "deck/devices.h"
#include "deck/eva.h"
#include "deck/parts.h"
#include "deck/rules.h"

static const vs_shelf INCLUDE_SHELF = {"include file", "", ""};

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

static vs_status read_file(vs_deck *deck, const char *path, vs_error *err);

static bool is_taken(const vs_deck *deck, const char *path) {
  for (size_t k = 0; k < deck->n_files; k++)
    if (!strcmp(deck->files[k], path)) return true;
  return false;
}

/* Takes in the file of a line ".include FILE", from the folder of the file it stands in, else from
 * those that come with the program. ngspice does not include it itself, so that its lines are held
 * to the same rules. A file is taken in once, as two parts may rest on the same one; within a
 * subcircuit its lines are the subcircuit's own, and it is taken in each time. */
static vs_status include(vs_deck *deck, const char *line, vs_where where, vs_error *err) {
  char name[VS_PATH_SIZE / 2], path[VS_PATH_SIZE];
  const char *from = line + strcspn(line, " \t"), *slash = strrchr(where.file, '/');
  from += strspn(from, " \t");
  char quote = *from == '"' || *from == '\'' ? *from++ : '\0';
  size_t n = quote ? strcspn(from, (char[]){quote, '\0'}) : strcspn(from, " \t");
  const char *after = from + n + (quote && from[n] == quote);
  if (n == 0 || n >= sizeof name || after[strspn(after, " \t")])
    return vs_fail_at(err, where, "'.include FILE' is wanted here, one file and nothing more");
  snprintf(name, sizeof name, "%.*s", (int)n, from);
  snprintf(path, sizeof path, "%.*s%s", slash && *name != '/' ? (int)(slash - where.file + 1) : 0,
           where.file, name);
  if (access(path, R_OK)) {
    vs_status status = vs_path_find(&INCLUDE_SHELF, name, where, path, err);
    if (status) return status;
  }
  if (!strcmp(path, where.file)) return vs_fail_at(err, where, "%s includes itself", path);
  if (deck->subcircuits == 0 && is_taken(deck, path)) return VS_OK;
  return read_file(deck, path, err);
}

/* Takes a line, joined with those that continue it, into the deck. The line's text is the deck's
 * then, or freed. */
static vs_status take_line(vs_deck *deck, vs_line line, vs_error *err) {
  const char *text = line.text;
  char word[16];
  snprintf(word, sizeof word, "%.*s", (int)strcspn(text, " \t"), text);
  vs_cursor_lower(word);
  bool other_file = !strcmp(word, ".include") || !strcmp(word, ".inc") || !strcmp(word, ".lib");
  vs_status random =
      other_file ? VS_OK : vs_rules_random(text, *deck->compat != 0, line.where, err);
  vs_status status = random         ? random
                     : other_file   ? include(deck, text, line.where, err)
                     : *text == '.' ? vs_rules_statement(deck, text, line.where, err)
                                    : vs_rules_element(deck, text, line.where, err);
  if (status && (other_file || (*text != '.' && !isalpha((unsigned char)*text))))
    deck->lost |= VS_LOST_ALL; /* it may have been anything */
  else if (status && *text != '.')
    deck->lost |= VS_LOST_ELEMENT;
  if (status || other_file) {
    free(line.text);
    return status;
  }
  vs_deck_add_line(deck, line);
  return VS_OK;
}

/* A line that may still be continued: its text so far (NULL: there is no such line), how many bytes
 * of it stand in its first line, and where that line is. */
typedef struct begun_line {
  vs_text text;
  size_t first;
  vs_where where;
} begun_line;

/* Takes the line begun, if there is one, as whole. */
static vs_status end_line(vs_deck *deck, begun_line *begun, vs_error *err) {
  vs_line line = {begun->text.text, begun->first, begun->where};
  *begun = (begun_line){0};
  return line.text ? vs_error_carry_on(err, take_line(deck, line, err)) : VS_OK;
}

/* Cuts the end of a line that ngspice takes for a comment: from ';' or '//' on, or from a '$'
 * behind a blank or comma (in PSpice's dialect that is a name). */
static void cut_comment(const vs_deck *deck, char *text) {
  size_t n = 0;
  for (; text[n]; n++) {
    bool parted = n > 0 && strchr(" \t,", text[n - 1]);
    if (text[n] == ';' || (text[n] == '/' && text[n + 1] == '/') ||
        (text[n] == '$' && parted && !*deck->compat))
      break;
  }
  while (n > 0 && strchr(" \t", text[n - 1])) n--;
  text[n] = '\0';
}

/* Reads a line of a file. The line of the netlist that it begins lasts as long as lines with '+'
 * follow. */
static vs_status read_line(vs_deck *deck, char *line, vs_where where, begun_line *begun,
                           vs_error *err) {
  char *text = line + where.column - 1;
  for (const char *c = line; *c; c++)
    if ((unsigned char)*c < ' ' && *c != '\t') {
      where.column = vs_text_column(line, c);
      return vs_fail_at(err, where, "a control character (%d)", *c);
    }
  if (!strncmp(text, "*$", 2)) return vs_contract_line(deck, line, where, err);
  if (*text != '*') cut_comment(deck, text);
  if (!*text || *text == '*') return VS_OK;
  if (*text != '+') {
    vs_status status = end_line(deck, begun, err);
    *begun = (begun_line){.first = strlen(text), .where = where};
    vs_text_add(&begun->text, "%s", text);
    return status;
  }
  if (!begun->text.text)
    return vs_fail_at(err, where, "'+' goes on with a line, and there is none");
  vs_text_add(&begun->text, " %s", text + 1);
  return VS_OK;
}

static vs_status read_lines(vs_deck *deck, char *file, FILE *f, vs_error *err) {
  char *line = NULL;
  size_t size = 0;
  begun_line begun = {0};
  vs_status status = VS_OK;
  ssize_t n;
  for (int number = 1; !status && (n = getline(&line, &size, f)) >= 0; number++) {
    while (n > 0 && strchr("\r\n", line[n - 1])) line[--n] = '\0';
    vs_where where = {file, number, (int)strspn(line, " \t") + 1};
    status = strlen(line) < (size_t)n ? vs_fail_at(err, where, "a zero byte")
                                      : read_line(deck, line, where, &begun, err);
    status = vs_error_carry_on(err, status);
  }
  if (!status) status = end_line(deck, &begun, err);
  vs_text_free(&begun.text);
  free(line);
  return status;
}

/* Finds the dialect, which says how every line is read, those before its own too. What else that
 * line may say is found when it is read. */
static void find_dialect(vs_deck *deck, FILE *f) {
  char *line = NULL, word[8], name[8], more;
  size_t size = 0;
  while (getline(&line, &size, f) >= 0)
    if (sscanf(line, " *$ %7s %7s %c", word, name, &more) == 2 && !strcmp(word, "compat") &&
        !strcmp(name, "ps"))
      memcpy(deck->compat, "ps", sizeof "ps");
  free(line);
  rewind(f);
}

static vs_status read_file(vs_deck *deck, const char *path, vs_error *err) {
  const vs_where place = {.file = path};
  struct stat s;
  if (deck->n_files >= VS_DECK_FILES)
    return vs_fail_at(err, place, "more than %d files; does one include itself?", VS_DECK_FILES);
  char *file = deck->files[deck->n_files++] = vs_copy(path);
  if (!stat(path, &s) && !S_ISREG(s.st_mode)) return vs_fail_at(err, place, "is no file of text");
  FILE *f = fopen(path, "r");
  if (!f) return vs_fail_at(err, place, "cannot be opened: %s", strerror(errno));
  find_dialect(deck, f);
  vs_status status = read_lines(deck, file, f, err);
  if (!status && ferror(f)) status = vs_fail_at(err, place, "cannot be read: %s", strerror(errno));
  fclose(f);
  return status;
}

vs_status vs_netlist_read(const char *path, vs_deck *deck, vs_error *err) {
  vs_deck_begin(deck);
  vs_status status = read_file(deck, path, err);
  if (!status && deck->n_part_files)
    status =
        vs_error_carry_on(err, vs_fail_at(err, deck->part_files[0].where,
                                          "'*$ part' belongs into a part's file, not into a deck"));
  if (!status && !*deck->eva && !(deck->lost & VS_LOST_ELEMENT))
    status = vs_error_carry_on(err, vs_fail_at(err, (vs_where){.file = path},
                                               "has no EVA; a deck has one line 'Xeva n m eva'"));
  return status;
}

vs_status vs_netlist_read_part(const char *path, vs_deck *part, vs_error *err) {
  vs_deck_begin(part);
  return read_file(part, path, err);
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
    char word[16], name[VS_DECK_NAME];
    if (sscanf(deck->lines[k].text, "%15s %63s", word, name) != 2) continue;
    vs_cursor_lower(word);
    vs_cursor_lower(name);
    if (!strcmp(word, ".subckt") && !strcmp(name, subcircuit)) return true;
  }
  return false;
}

static vs_status take_part(vs_deck *deck, vs_part *part, const char *name, vs_where where,
                           vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_status status = find_part(deck, name, where, path, err);
  if (!status && !is_taken(deck, path)) status = read_file(deck, path, err);
  if (status) return status;
  for (size_t k = 0; k < deck->n_files; k++)
    if (!strcmp(deck->files[k], path)) part->file = deck->files[k];
  subcircuit_of(path, part->subcircuit);
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
  *lines = realloc(*lines, (*count + 1) * sizeof **lines);
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

/* Finds in the line what the message speaks of; NULL: it is not in this line. */
static const char *find_subject(const char *line, const char *message) {
  size_t n = 0;
  const char *name = find_quoted(message, PARAMETER, ']', &n);
  if (name) { /* a parameter stands in an expression, and so behind the first '{', quote or '=' */
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
