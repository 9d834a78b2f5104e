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
#include "slips/subcircuits.h"

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
    status = vs_error_carry_on(err, vs_fail_at(err, (vs_where){deck->files[0], 1, 1},
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

/* Where the file defines its first subcircuit; its begin where it defines none. */
static vs_where first_subcircuit(const vs_deck *deck, const char *file) {
  for (size_t k = 0; k < deck->n_lines; k++)
    if (deck->lines[k].where.file == file && !strncasecmp(deck->lines[k].text, ".subckt", 7))
      return deck->lines[k].where;
  return (vs_where){file, 1, 1};
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
             : vs_fail_at(err, first_subcircuit(deck, part->file),
                          "defines no subcircuit '%s', as the file is called, which circuit.%s "
                          "asks for",
                          part->subcircuit, part->name);
}

/* Holds the parameters of all instances to their subcircuits. */
static vs_status check_instances(const vs_deck *deck, vs_error *err) {
  vs_subcircuits subcircuits;
  vs_status status = VS_OK;
  vs_subcircuits_find(&subcircuits, deck->lines, deck->n_lines);
  for (size_t k = 0; k < deck->n_lines && !status; k++) {
    size_t n = 0;
    const char *at = vs_rules_instance_of(deck->lines[k].text, &n);
    char name[VS_DECK_NAME];
    if (!at || !strchr(at, '=') || n >= sizeof name) continue;
    snprintf(name, sizeof name, "%.*s", (int)n, at);
    for (size_t p = 0; p < deck->n_parts; p++)
      if (!strcasecmp(deck->parts[p].name, name))
        snprintf(name, sizeof name, "%s", deck->parts[p].subcircuit);
    status = vs_error_carry_on(
        err, vs_subcircuits_check(&subcircuits, &deck->lines[k], at + n, name, err));
  }
  vs_subcircuits_free(&subcircuits);
  return status;
}

vs_status vs_netlist_read_parts(vs_deck *deck, const vs_node *section, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t p = 0, k = 1; p < deck->n_parts && !status; k++) {
    const vs_field *field = &deck->section.fields[k];
    if (field->kind != VS_NAME) continue;
    const vs_node *node = vs_tree_child(section, field->key);
    bool given = node && node->kind == VS_NODE_TEXT;
    vs_where where = given ? node->where : deck->parts[p].where;
    status =
        vs_error_carry_on(err, take_part(deck, &deck->parts[p++],
                                         given ? node->text : field->default_text, where, err));
  }
  if (!status) status = vs_parts_resolve(deck, err);
  if (!status) status = vs_devices_resolve(deck, err);
  if (!status && !deck->lost) status = check_instances(deck, err);
  return status ? status : match_sources(deck, err);
}

/* ---- for the solver ---- */

static void add_text(char ***lines, size_t *count, const char *text) {
  *lines = vs_alloc_grow(*lines, *count, sizeof **lines);
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

/* True where a name that ends here is given a value. */
static bool is_given(const char *end) {
  end += strspn(end, " \t");
  return *end == '=' && end[1] != '=';
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

/* Goes behind the path in an element's name, as ngspice gives it to one within a subcircuit: to
 * "bk" in "b.xs.bk". */
static const char *behind_path(const char *name) {
  const char *begin = name;
  for (; *name && !strchr(" :#)\"", *name); name++)
    if (*name == '.') begin = name + 1;
  return begin;
}

/* True where the message speaks of the line's element, by one of its ways: "...: r1 a b ...", "...:
 * r1: ...", "... instance r1 ...", "... check node r1#branch". */
static bool is_element_of(const char *line, const char *message) {
  static const char *const BEFORE[] = {": ", "instance ", "check node ", "(instance: x"};
  size_t n = strcspn(line, " \t");
  if (n < 2 || *line == '.' || *line == '+') return false;
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++)
    for (const char *s = message; (s = strstr(s, BEFORE[k]));) {
      s = behind_path(s + strlen(BEFORE[k]));
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

/* Finds a '=' with nothing behind it, which ngspice takes for an expression of no characters, or of
 * the next bracket. */
static const char *find_no_value(const char *line) {
  for (const char *s = line; (s = strchr(s, '=')); s++)
    if (strchr(")}", s[1 + strspn(s + 1, " \t")])) return s; /* or the end */
  return NULL;
}

/* Finds in the line what the message speaks of; NULL: it is not in this line. */
static const char *find_subject(const char *line, const char *message) {
  size_t n = 0;
  const char *name = find_quoted(message, PARAMETER, ']', &n);
  if (name) { /* a parameter stands in an expression, and so behind the first '{', quote or '=' */
    const char *from = *line == '.' ? strpbrk(line, "{'=( ") : strpbrk(line, "{'=");
    from = from ? find_word(line, from, name, n) : NULL;
    while (from && is_given(from + n)) from = find_word(line, from + n, name, n);
    return from;
  }
  const char *expression = strstr(message, "xpression err: ");
  if (expression) {
    expression += 15;
    if (strlen(expression) < 2) return find_no_value(line); /* it may stand in any line */
    const char *whole = strcasestr(line, expression);
    while (is_word(expression[n])) n++;
    return whole || n < 2 ? whole : find_word(line, line, expression, n);
  }
  name = find_quoted(message, " '", '\'', &n);
  const char *word = name ? find_word(line, line, name, n) : NULL;
  if (is_element_of(line, message)) return word ? word : line;
  return strstr(message, "circuit: no such function '") ? word : NULL;
}

/* The lines of a deck that a message is about. */
typedef struct scope {
  const vs_deck *deck;
  size_t begin, end;
} scope;

static bool begins(const char *line, const char *word) {
  size_t n = strlen(word);
  return !strncasecmp(line, word, n) && (!line[n] || strchr(" \t", line[n]));
}

/* The line behind the end of the subcircuit that begins in line k; 0: none does. */
static size_t end_of(const vs_deck *deck, size_t k) {
  size_t depth = begins(deck->lines[k].text, ".subckt"), end = depth ? k + 1 : 0;
  for (; depth && end < deck->n_lines; end++) {
    depth += begins(deck->lines[end].text, ".subckt");
    depth -= begins(deck->lines[end].text, ".ends");
  }
  return end;
}

/* Finds the lines of the subcircuit of that name. Returns false where there is none. */
static bool enter(scope *in, const char *name, size_t n) {
  const vs_deck *deck = in->deck;
  for (size_t p = 0; p < deck->n_parts; p++)
    if (strlen(deck->parts[p].name) == n && !strncasecmp(deck->parts[p].name, name, n))
      name = deck->parts[p].subcircuit, n = strlen(name);
  for (size_t k = 0; k < deck->n_lines; k++) {
    const char *text = deck->lines[k].text, *word = text + strcspn(text, " \t");
    word += strspn(word, " \t");
    if (begins(text, ".subckt") && !strncasecmp(word, name, n) && strchr(" \t", word[n])) {
      in->begin = k + 1;
      in->end = end_of(deck, k);
      return true;
    }
  }
  return false;
}

/* Finds the subcircuit of a path, as "b.xs.xq.bk" or "xs.xq.kk", by its instances. */
static scope scope_of(const vs_deck *deck, const char *path) {
  scope in = {deck, 0, deck->n_lines};
  const char *last = behind_path(path);
  if (path[1] == '.') path += 2; /* the element's letter */
  while (path < last) {
    size_t n = strcspn(path, "."), length = 0, k = in.begin;
    while (k < in.end && (strncasecmp(deck->lines[k].text, path, n) != 0 ||
                          !strchr(" \t", deck->lines[k].text[n])))
      k++;
    const char *name = k < in.end ? vs_rules_instance_of(deck->lines[k].text, &length) : NULL;
    if (!name || !enter(&in, name, length)) return (scope){deck, 0, deck->n_lines};
    path += n + 1;
  }
  return in;
}

/* Finds the lines that a message is about, by the first path in it; else all are. */
static scope find_scope(const vs_deck *deck, const char *message) {
  static const char *const BEFORE[] = {"check node ", "instance ", "trouble with node \"", ": "};
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++)
    for (const char *s = message; (s = strstr(s, BEFORE[k]));) {
      s += strlen(BEFORE[k]);
      if (!isalpha((unsigned char)*s) || behind_path(s) == s) continue;
      scope in = scope_of(deck, s);
      if (in.end - in.begin < deck->n_lines) return in;
    }
  return (scope){deck, 0, deck->n_lines};
}

/* Where that line of the netlist stands; no file: it is none of the deck's own. Before these stand
 * the title and the parameters (vs_netlist_make). */
static vs_where place_of_culprit(const vs_deck *deck, size_t culprit) {
  size_t before = 1 + VS_STANDARD;
  for (size_t k = 1; k < deck->section.count; k++)
    before += deck->section.fields[k].kind == VS_REAL;
  return culprit >= before && culprit - before < deck->n_lines ? deck->lines[culprit - before].where
                                                               : (vs_where){0};
}

/* True where the message quotes that line of an element, all of it, as its end. */
static bool is_quoted(const char *line, const char *message) {
  const char *at = isalpha((unsigned char)*line) ? strcasestr(message, line) : NULL;
  return at && !is_word(at[strlen(line)]);
}

/* True where a line gives a parameter of that name a value, or describes a model of that name. */
static bool declares(const char *line, const char *name, size_t n, bool parameter) {
  if (!parameter) {
    const char *word = line + strcspn(line, " \t");
    return begins(line, ".model") && find_word(word, word, name, n) == word + strspn(word, " \t");
  }
  if (!begins(line, ".param") && !begins(line, ".subckt")) return false;
  for (const char *at = line; (at = find_word(line, at, name, n)); at += n)
    if (is_given(at + n)) return true;
  return false;
}

/* True where the subcircuit that line k stands in, or one around that, has the parameter or the
 * model whose lack the message is of. */
static bool has_what_lacks(const vs_deck *deck, size_t k, const char *message) {
  size_t n = 0;
  const char *name = find_quoted(message, PARAMETER, ']', &n);
  const bool parameter = name;
  if (!name) name = find_quoted(message, "can't find model '", '\'', &n);
  for (size_t from = 0; from < k && name; from++) {
    size_t end = end_of(deck, from);
    if (end <= k) continue;
    for (size_t j = from; j < end; j++) {
      size_t inner = j > from ? end_of(deck, j) : 0;
      if (inner)
        j = inner - 1;
      else if (declares(deck->lines[j].text, name, n, parameter))
        return true;
    }
  }
  return false;
}

/* Finds the first line in which `find` finds what a message speaks of. */
static vs_where place_in_lines(const vs_deck *deck, const char *message,
                               const char *(*find)(const char *line, const char *message)) {
  const scope in = find_scope(deck, message);
  bool quoted = false; /* the message has a line as a whole, which is not another one then */
  for (size_t k = in.begin; k < in.end && !quoted; k++)
    quoted = is_quoted(deck->lines[k].text, message);
  for (size_t k = in.begin; k < in.end; k++) {
    const vs_line *line = &deck->lines[k];
    if (quoted && !is_quoted(line->text, message)) continue;
    const char *at = find(line->written ? line->written : line->text, message);
    if (!at && !(line->written && find(line->text, message))) continue;
    if (!has_what_lacks(deck, k, message)) return at ? vs_line_place(line, at) : line->where;
  }
  return (vs_where){0};
}

/* What would be right, with "; " before it; empty where the complaint says so itself. */
static const char *instead_of(const char *message) {
  static const struct {
    const char *says, *instead;
  } ROWS[] = {
      {PARAMETER, "; '.param NAME=...' or '*$ param NAME = ...' defines one"},
      {"can't find model", "; '.model NAME ...' defines one"},
      {"nknown subckt",
       "; '.subckt NAME ...' defines one, '.include FILE' takes in a file that does"},
      {"already exists", "; give one of the two another name"},
      {"singular matrix", "; wanted: from every node a path to node 0 on which direct current may "
                          "flow, and no loop of voltage sources"},
      {"parameters for subcircuit", "; wanted: as many nodes as the subcircuit has"},
      {"too few parameters", "; wanted: as many nodes and values as such an element has"},
      {"not enough parameters", "; wanted: as many nodes as the subcircuit has"},
      {"nknown controlling source", "; a source V... of that name is wanted"},
      {"nknown parameter", "; wanted: NAME=VALUE of a name that such an element or model has"},
      {"xpression err",
       "; look for a '=' with nothing behind it, a bracket or a sign that is missing"},
      {"Closing \"", "; close that bracket"},
      {"syntax error", "; look for a bracket, a comma or a sign that is missing"},
      {"YYparse", "; look for a bracket, a comma or a sign that is missing"},
      {"imestep too small", "; look at the values of that element"}};
  if (is_of_power(message))
    return "; a power below 0 has no value where x is 0, one below 1 no slope: write "
           "max(abs(x), 1u) for x";
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++)
    if (strcasestr(message, ROWS[k].says)) return ROWS[k].instead;
  return "";
}

/* True for a deck or a part that comes with the program. */
static bool is_shipped(const char *file) {
  const char *slash = strrchr(file, '/'), *name = slash ? slash + 1 : file;
  const vs_shelf parts = {"part", "parts", ""}, decks = {"deck", "", ""};
  char path[VS_PATH_SIZE];
  return (vs_path_shipped(&parts, name, path) && !strcmp(path, file)) ||
         (vs_path_shipped(&decks, name, path) && !strcmp(path, file));
}

/* A wrong number of nodes is told of the instance. Where that comes with the program, or is none of
 * the deck's lines, the user's subcircuit is what has to be mended: its place. */
static vs_where place_of_pins(const vs_deck *deck, const char *message, vs_where where) {
  size_t n = 0;
  const char *name = find_quoted(message, "parameters for subcircuit type \"", '"', &n);
  scope in = {deck, 0, 0};
  if (!name || (where.file && !is_shipped(where.file)) || !enter(&in, name, n)) return where;
  const vs_where its = deck->lines[in.begin - 1].where;
  return is_shipped(its.file) ? where : its;
}

void vs_netlist_locate(const vs_deck *deck, size_t culprit, vs_error *err) {
  const char *signal = strstr(err->text, "the circuit has no ");
  vs_where where = {0};
  for (size_t k = 0; k < deck->n_terms && signal; k++)
    if (!strcmp(signal + 19, deck->terms[k].plus) || !strcmp(signal + 19, deck->terms[k].minus))
      where = deck->terms[k].where;
  if (!where.file) where = place_of_culprit(deck, culprit);
  if (!where.file) where = place_in_lines(deck, err->text, find_subject);
  if (!where.file) where = place_in_lines(deck, err->text, find_node);
  if (!where.file) where = place_in_lines(deck, err->text, find_function);
  where = place_of_pins(deck, err->text, where);
  vs_error plain = *err;
  char within[VS_PATH_SIZE] = "";
  if (!where.file)
    where.file = deck->files[0];
  else
    where = vs_deck_mendable(deck, where, within, sizeof within);
  vs_fail_at(err, where, "%s%s%s", plain.text, within, instead_of(plain.text));
}
