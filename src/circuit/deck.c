/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "circuit/deck.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "circuit/contract.h"
#include "circuit/devices.h"
#include "circuit/limits.h"
#include "circuit/rules.h"

const vs_shelf vs_deck_shelf = {"deck", "", ".cir"}, vs_part_shelf = {"part", "parts", ".inc"};
static const vs_shelf INCLUDE_SHELF = {"include file", "", ""};

const vs_field vs_deck_key = {"deck",
                              VS_NAME,
                              "",
                              "halfwave_snubbed",
                              0,
                              0,
                              false,
                              offsetof(vs_circuit_values, deck),
                              "netlist: a file, or the name of one that comes with the program",
                              NULL,
                              NULL};

const char *const vs_standard_names[VS_STANDARD] = {
    "u_rms", "f_mains", "phase", "r_source", "l_source", "eva_resistance", "eva_a"};

/* ---- the netlist's own lines ---- */

/* Ports and external sources belong together, one to one: a source nobody drives would stay at 0 V.
 */
static vs_status match_sources(const vs_deck *deck, vs_error *err) {
  bool driven[VS_DECK_MOST] = {false};
  vs_status status = VS_OK;
  for (size_t k = 0; k < deck->n_lines && !status; k++) {
    char name[VS_DECK_NAME];
    if (!vs_is_external(deck->lines[k].text, name)) continue;
    size_t p = 0;
    while (p < deck->n_ports && strcmp(deck->ports[p].source, name)) p++;
    if (p < deck->n_ports)
      driven[p] = true;
    else if (!(deck->lost & VS_LOST_PORT))
      status = vs_carry_on(err, vs_fail_at(err, deck->lines[k].where,
                                           "the external source %s has no line '*$ port ... = %s'",
                                           name, name));
  }
  for (size_t p = 0; p < deck->n_ports && !status; p++)
    if (!driven[p] && !(deck->lost & VS_LOST_ELEMENT))
      status = vs_carry_on(err, vs_fail_at(err, deck->ports[p].where,
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

/* ".include FILE": from the folder of the file it stands in, else one that comes with the program.
 * The lines are taken in here, so that they are held to the same rules; once only, as two parts may
 * rest on the same file. Within a subcircuit they are its own, each time. */
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
    vs_status status = vs_find(&INCLUDE_SHELF, name, where, path, err);
    if (status) return status;
  }
  if (!strcmp(path, where.file)) return vs_fail_at(err, where, "%s includes itself", path);
  if (deck->subcircuits == 0 && is_taken(deck, path)) return VS_OK;
  return read_file(deck, path, err);
}

/* A line that is whole. The deck keeps its text, or frees it. */
static vs_status take_line(vs_deck *deck, vs_line line, vs_error *err) {
  const char *text = line.text;
  char word[16];
  snprintf(word, sizeof word, "%.*s", (int)strcspn(text, " \t"), text);
  vs_lower(word);
  bool other_file = !strcmp(word, ".include") || !strcmp(word, ".inc") || !strcmp(word, ".lib");
  vs_status random = other_file ? VS_OK : vs_rule_random(text, *deck->compat != 0, line.where, err);
  vs_status status = random         ? random
                     : other_file   ? include(deck, text, line.where, err)
                     : *text == '.' ? vs_rule_statement(deck, text, line.where, err)
                                    : vs_rule_element(deck, text, line.where, err);
  if (status && (other_file || (*text != '.' && !isalpha((unsigned char)*text))))
    deck->lost |= VS_LOST_ALL; /* it may have been anything */
  else if (status && *text != '.')
    deck->lost |= VS_LOST_ELEMENT;
  if (status || other_file) {
    free(line.text);
    return status;
  }
  deck->lines = realloc(deck->lines, (deck->n_lines + 1) * sizeof *deck->lines);
  deck->lines[deck->n_lines++] = line;
  return VS_OK;
}

/* A line that may go on: its text so far (NULL: there is none), how much of that stands in its
 * first line, and where that is. */
typedef struct begun_line {
  vs_text text;
  size_t first;
  vs_where where;
} begun_line;

/* Takes the line begun, if any. */
static vs_status end_line(vs_deck *deck, begun_line *begun, vs_error *err) {
  vs_line line = {begun->text.text, begun->first, begun->where};
  *begun = (begun_line){0};
  return line.text ? vs_carry_on(err, take_line(deck, line, err)) : VS_OK;
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

/* A line of a file. What it begins goes on as long as lines with '+' follow. */
static vs_status read_line(vs_deck *deck, char *line, vs_where where, begun_line *begun,
                           vs_error *err) {
  char *text = line + where.column - 1;
  for (const char *c = line; *c; c++)
    if ((unsigned char)*c < ' ' && *c != '\t') {
      where.column = vs_column(line, c);
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
    status = vs_carry_on(err, status);
  }
  if (!status) status = end_line(deck, &begun, err);
  vs_text_free(&begun.text);
  free(line);
  return status;
}

/* The dialect says how every line is read, those before its own too. What else that line may say is
 * found when it is read. */
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

static void begin_deck(vs_deck *deck) {
  *deck = (vs_deck){0};
  deck->section =
      (vs_section){"circuit", vs_alloc(1 + VS_DECK_MOST + VS_DECK_PARTS, sizeof(vs_field)), 1};
  vs_deck_fields(deck)[0] = vs_deck_key;
}

vs_status vs_deck_read(const char *path, vs_deck *deck, vs_error *err) {
  begin_deck(deck);
  vs_status status = read_file(deck, path, err);
  if (!status && deck->n_part_files)
    status = vs_carry_on(err, vs_fail_at(err, deck->part_files[0].where,
                                         "'*$ part' belongs into a part's file, not into a deck"));
  if (!status && !*deck->eva && !(deck->lost & VS_LOST_ELEMENT))
    status = vs_carry_on(err, vs_fail_at(err, (vs_where){.file = path},
                                         "has no EVA; a deck has one line 'Xeva n m eva'"));
  return status;
}

vs_status vs_deck_read_part(const char *path, vs_deck *part, vs_error *err) {
  begin_deck(part);
  return read_file(part, path, err);
}

/* ---- parts ---- */

/* Where a part's file is: the path given, or in the deck's folder, or on the shelf of parts. */
static vs_status find_part(const vs_deck *deck, const char *name, vs_where where,
                           char path[VS_PATH_SIZE], vs_error *err) {
  const char *slash = strrchr(deck->files[0], '/');
  int folder = slash ? (int)(slash - deck->files[0] + 1) : 0;
  for (int ending = 0; ending < 2; ending++) {
    snprintf(path, VS_PATH_SIZE, "%.*s%s%s", *name == '/' ? 0 : folder, deck->files[0], name,
             ending ? vs_part_shelf.ending : "");
    struct stat s;
    if (!stat(path, &s) && S_ISREG(s.st_mode)) return VS_OK;
  }
  return vs_find(&vs_part_shelf, name, where, path, err);
}

/* The file's name without folders and ending, in lower case: the subcircuit it must define. */
static void subcircuit_of(const char *path, char name[VS_DECK_NAME]) {
  const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
  snprintf(name, VS_DECK_NAME, "%.*s", (int)strcspn(base, "."), base);
  vs_lower(name);
}

static bool defines(const vs_deck *deck, const char *subcircuit) {
  for (size_t k = 0; k < deck->n_lines; k++) {
    char word[16], name[VS_DECK_NAME];
    if (sscanf(deck->lines[k].text, "%15s %63s", word, name) != 2) continue;
    vs_lower(word);
    vs_lower(name);
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
             ? vs_limits_check_kind(deck, part, where, err)
             : vs_fail_at(err, where, "circuit.%s: %s defines no subcircuit '%s' (the file's name)",
                          part->name, path, part->subcircuit);
}

vs_status vs_deck_read_parts(vs_deck *deck, const vs_node *section, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t p = 0, k = 1; p < deck->n_parts && !status; k++) {
    const vs_field *field = &deck->section.fields[k];
    if (field->kind != VS_NAME) continue;
    const vs_node *node = vs_node_child(section, field->key);
    bool given = node && node->kind == VS_NODE_TEXT;
    vs_where where = given ? node->where : (vs_where){deck->files[0], 0, 0};
    status = vs_carry_on(err, take_part(deck, &deck->parts[p++],
                                        given ? node->text : field->default_text, where, err));
  }
  if (!status) status = vs_limits_resolve(deck, err);
  if (!status) status = vs_devices_resolve(deck, err);
  return status ? status : match_sources(deck, err);
}

/* ---- formulas ---- */

vs_status vs_deck_bind(vs_deck *deck, const vs_circuit_values *values,
                       const vs_deck_value *standard, size_t n_standard, vs_error *err) {
  if (deck->lost & VS_LOST_PARAM) return VS_OK;
  vs_status status = VS_OK;
  double of_name[VS_DECK_MOST];
  const char *known[2 * VS_DECK_MOST];
  for (size_t n = 0; n < deck->n_names && !status; n++) {
    size_t count = 0;
    of_name[n] = NAN;
    for (size_t k = 1; k < deck->section.count; k++) {
      const vs_field *field = &deck->section.fields[k];
      if (field->kind != VS_REAL) continue;
      known[count++] = field->key;
      if (!strcasecmp(field->key, deck->names[n].name))
        of_name[n] = *(const double *)(const void *)((const char *)values + field->offset);
    }
    for (size_t k = 0; k < n_standard; k++) {
      known[count++] = standard[k].name;
      if (!strcmp(standard[k].name, deck->names[n].name)) of_name[n] = standard[k].value;
    }
    if (!isnan(of_name[n])) continue;
    const char *nearest = vs_nearest(deck->names[n].name, known, count);
    status = vs_fail_at(err, deck->names[n].where, "no parameter '%s' is declared%s%s%s",
                        deck->names[n].name, nearest ? "; did you mean '" : " by '*$ param'",
                        nearest ? nearest : "", nearest ? "'?" : "");
    status = vs_carry_on(err, status);
  }
  for (size_t k = 0; k < deck->losses.count; k++)
    vs_formula_bind(&deck->losses.item[k].formula, of_name);
  for (size_t k = 0; k < deck->stores.count; k++)
    vs_formula_bind(&deck->stores.item[k].formula, of_name);
  for (size_t k = 0; k < deck->n_requirements; k++) {
    vs_formula_bind(&deck->requirements[k].left, of_name);
    vs_formula_bind(&deck->requirements[k].right, of_name);
  }
  for (size_t k = 0; k < deck->n_devices; k++) {
    vs_formula_bind(&deck->devices[k].voltage, of_name);
    vs_formula_bind(&deck->devices[k].current, of_name);
    vs_formula_bind(&deck->devices[k].flux, of_name);
  }
  return status;
}

static void free_accounts(vs_accounts *accounts) {
  for (size_t k = 0; k < accounts->count; k++) vs_formula_free(&accounts->item[k].formula);
}

void vs_deck_free(vs_deck *deck) {
  for (size_t k = 1; k < deck->section.count; k++) {
    free((char *)(size_t)deck->section.fields[k].key);
    free((char *)(size_t)deck->section.fields[k].unit);
    free((char *)(size_t)deck->section.fields[k].default_text);
    free((char *)(size_t)deck->section.fields[k].text);
  }
  free(vs_deck_fields(deck));
  for (size_t k = 0; k < deck->n_lines; k++) free(deck->lines[k].text);
  free(deck->lines);
  free_accounts(&deck->losses);
  free_accounts(&deck->stores);
  for (size_t k = 0; k < deck->n_requirements; k++) {
    vs_formula_free(&deck->requirements[k].left);
    vs_formula_free(&deck->requirements[k].right);
  }
  for (size_t k = 0; k < deck->n_devices; k++) {
    vs_formula_free(&deck->devices[k].voltage);
    vs_formula_free(&deck->devices[k].current);
    vs_formula_free(&deck->devices[k].flux);
  }
  for (size_t k = 0; k < deck->n_files; k++) free(deck->files[k]);
  *deck = (vs_deck){0};
}
