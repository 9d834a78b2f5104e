/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deck/netlist.h"

#include <ctype.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/jail.h"
#include "base/text.h"
#include "catalogue/catalogue.h"
#include "deck/contract.h"
#include "deck/devices.h"
#include "deck/eva.h"
#include "deck/files.h"
#include "deck/parts.h"
#include "deck/probes.h"
#include "deck/rules.h"
#include "dialect/words.h"
#include "slips/couplings.h"
#include "slips/cycles.h"
#include "slips/doubles.h"
#include "slips/growth.h"
#include "slips/nesting.h"
#include "slips/parameters.h"
#include "slips/slips.h"
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

/* Looks for functions and parameters that need themselves, or come to too much. */
static vs_status check_definitions(const vs_deck *deck, vs_error *err) {
  vs_definitions definitions;
  vs_definitions_find(&definitions, deck->lines, deck->n_lines);
  vs_status status = vs_cycles_check(&definitions, err);
  if (!status) status = vs_cycles_check_depth(&definitions, err);
  if (!status) status = vs_growth_check(&definitions, deck->lines, deck->n_lines, err);
  status = vs_error_carry_on(err, status);
  vs_definitions_free(&definitions);
  return status;
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

/* Looks for subcircuits that have themselves within. */
static vs_status check_nesting(const vs_deck *deck, vs_error *err) {
  vs_word *called = vs_alloc(deck->n_lines + 1, sizeof *called);
  for (size_t k = 0; k < deck->n_lines; k++) {
    called[k].at = vs_rules_instance_of(deck->lines[k].text, &called[k].n);
    for (size_t p = 0; p < deck->n_parts && called[k].n; p++) {
      const char *subcircuit = deck->parts[p].subcircuit;
      if (!vs_words_is(called[k], deck->parts[p].name)) continue;
      called[k] = (vs_word){subcircuit, strlen(subcircuit)};
      break;
    }
  }
  vs_status status =
      vs_error_carry_on(err, vs_nesting_check(deck->lines, called, deck->n_lines, err));
  free(called);
  return status;
}

/* Holds the gains of controlled sources to the parameters that the deck has. */
static vs_status check_gains(const vs_deck *deck, vs_error *err) {
  vs_parameters names = {0};
  vs_status status = VS_OK;
  for (size_t k = 0; k < VS_STANDARD; k++) vs_parameters_add(&names, vs_deck_standard_names[k]);
  for (size_t k = 1; k < deck->section.count; k++)
    vs_parameters_add(&names, deck->section.fields[k].key);
  vs_parameters_find(&names, deck->lines, deck->n_lines);
  for (size_t k = 0; k < deck->n_lines && !status; k++)
    status = vs_error_carry_on(err, vs_parameters_check_gain(&names, &deck->lines[k], err));
  vs_parameters_free(&names);
  return status;
}

/* Who is told of doubles. */
typedef struct doubles {
  vs_deck *deck;
  vs_error *err;
  vs_status status;
} doubles;

/* Refuses one name in two files: one of them, as a part, would get what the other says, while its
 * limits are judged. Warns of what else stands in the deck's own file. Libraries of vendors have
 * many such lines, which do no harm to a circuit that was made with them. */
static void tell_double(void *ctx, vs_where where, bool apart, const char *text) {
  doubles *d = ctx;
  if (!apart && where.file == d->deck->files[0]) vs_deck_remark(d->deck, where, "%s", text);
  if (!apart || d->status) return;
  char within[VS_PATH_SIZE];
  where = vs_deck_mendable(d->deck, where, within, sizeof within);
  d->status = vs_error_carry_on(d->err, vs_fail_at(d->err, where, "%s%s", text, within));
}

static vs_status check_doubles(vs_deck *deck, vs_error *err) {
  doubles d = {deck, err, VS_OK};
  vs_doubles_look(deck->lines, deck->n_lines, tell_double, &d);
  return d.status;
}

/* What can be told once all lines are there. */
static vs_status check_whole(vs_deck *deck, vs_error *err) {
  vs_status status = vs_rules_params(deck, err);
  if (!status) status = check_definitions(deck, err);
  if (!status) status = check_nesting(deck, err);
  if (!status) status = check_instances(deck, err);
  if (!status) status = check_gains(deck, err);
  if (!status) status = vs_error_carry_on(err, vs_slips_names(deck->lines, deck->n_lines, err));
  if (!status) status = vs_couplings_check(deck->lines, deck->n_lines, err);
  if (!status) status = vs_probes_check_units(deck, err);
  if (!status) status = check_doubles(deck, err);
  return status;
}

static bool defines(const vs_deck *deck, const char *subcircuit) {
  for (size_t k = 0; k < deck->n_lines; k++) {
    const char *text = deck->lines[k].text;
    char name[VS_DECK_NAME];
    if (vs_words_begin(text, ".subckt") && sscanf(text + 7, " %63s", name) == 1 &&
        !strcasecmp(name, subcircuit))
      return true;
  }
  return false;
}

/* True for the name of a part or of a subcircuit. */
static bool knows(const vs_deck *deck, const char *name) {
  for (size_t p = 0; p < deck->n_parts; p++)
    if (!strcasecmp(deck->parts[p].name, name)) return true;
  return defines(deck, name);
}

/* A deck without an EVA has misspelt it where an instance's subcircuit is not there and has nearly
 * that name. */
static vs_status refuse_no_eva(const vs_deck *deck, vs_error *err) {
  static const char *const EVA[] = {"eva"};
  for (size_t k = 0; k < deck->n_lines; k++) {
    size_t n = 0;
    const char *at = vs_rules_instance_of(deck->lines[k].text, &n);
    char name[VS_DECK_NAME];
    if (!at || n >= sizeof name || deck->lines[k].written) continue;
    snprintf(name, sizeof name, "%.*s", (int)n, at);
    if (vs_text_nearest(name, EVA, 1) && !knows(deck, name))
      return vs_fail_at(err, vs_line_place(&deck->lines[k], at),
                        "no subcircuit %s, and the deck has no EVA; did you mean 'eva'?", name);
  }
  return vs_fail_at(err, (vs_where){deck->files[0], 1, 1},
                    "has no EVA; a deck has one line 'Xeva n m eva'");
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
    status = vs_error_carry_on(err, refuse_no_eva(deck, err));
  return status;
}

static vs_status read_alone(vs_deck *deck, const char *path, bool library, vs_error *err) {
  vs_status status = vs_files_read(deck, path, library, err);
  return status || deck->lost ? status : check_whole(deck, err);
}

vs_status vs_netlist_read_part(const char *path, vs_deck *part, vs_error *err) {
  vs_deck_begin(part);
  return read_alone(part, path, false, err);
}

vs_status vs_netlist_read_library(const char *path, vs_deck *library, vs_error *err) {
  vs_deck_begin(library);
  return read_alone(library, path, true, err);
}

/* ---- parts ---- */

/* Finds the file of a part: beside the file that names it, or in the deck's folder, or at the path
 * given, or on the shelf of parts, where it may be a row of a table. */
static vs_status find_part(const vs_deck *deck, const char *name, vs_where where,
                           char path[VS_PATH_SIZE], vs_error *err) {
  const char *slash = strrchr(deck->files[0], '/');
  int folder = slash ? (int)(slash - deck->files[0] + 1) : 0;
  for (int k = 0; k < 4; k++) { /* beside, in the deck's folder; each without and with the ending */
    char whole[VS_PATH_SIZE];
    snprintf(whole, sizeof whole, "%.4000s%s", name, k % 2 ? vs_deck_parts_shelf.ending : "");
    if (k < 2 && !vs_path_beside(whole, where, path)) continue;
    if (k >= 2 && snprintf(path, VS_PATH_SIZE, "%.*s%s", *name == '/' ? 0 : folder, deck->files[0],
                           whole) >= VS_PATH_SIZE)
      continue;
    struct stat s;
    char file[VS_PATH_SIZE];
    vs_catalogue_file(path, file);
    vs_status status = vs_jail_check(file, where, err);
    if (status) return status;
    if (!stat(file, &s) && S_ISREG(s.st_mode)) return VS_OK;
  }
  return vs_catalogue_find(&vs_deck_parts_shelf, name, where, path, err);
}

/* Gives the name of the subcircuit that a part's file must define: the file's own, without folders
 * and ending, in lower case. */
static void subcircuit_of(const char *path, char name[VS_DECK_NAME]) {
  size_t n;
  const char *base = vs_catalogue_name(path, &n);
  snprintf(name, VS_DECK_NAME, "%.*s", (int)n, base);
  vs_cursor_lower(name);
}

/* Where the file defines its first subcircuit; its begin where it defines none. */
static vs_where first_subcircuit(const vs_deck *deck, const char *file) {
  for (size_t k = 0; k < deck->n_lines; k++)
    if (deck->lines[k].where.file == file && vs_words_begin(deck->lines[k].text, ".subckt"))
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

/* Warns where a file of the user's has the name of a part that comes with the program. */
static void tell_hidden_part(vs_deck *deck, const char *name, const char *path, vs_where where) {
  char shipped[VS_PATH_SIZE];
  struct stat a, b;
  if (strchr(name, '/') || vs_catalogue_is_row(path)) return;
  if (!vs_catalogue_shipped(&vs_deck_parts_shelf, name, shipped)) return;
  const bool row = vs_catalogue_is_row(shipped);
  if (!row && (stat(path, &a) || stat(shipped, &b))) return;
  if (!row && a.st_dev == b.st_dev && a.st_ino == b.st_ino) return;
  vs_deck_remark(deck, where,
                 "part %s is taken from %s; the one of that name that comes with the program is "
                 "not; if that is meant, give the file another name",
                 name, path);
}

static vs_status take_part(vs_deck *deck, vs_part *part, const char *name, vs_where where,
                           vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_status status = find_part(deck, name, where, path, err);
  if (!status) tell_hidden_part(deck, name, path, where);
  if (!status && !vs_files_has(deck, path)) {
    /* the deck is to be mended where it takes a part of the program's, and not what a scene says */
    const bool own = where.file == part->where.file && !vs_deck_is_shipped(where.file);
    if (own && deck->n_files < VS_DECK_FILES && vs_deck_is_shipped(path))
      deck->included[deck->n_files] = where;
    status = vs_files_read(deck, path, false, err);
  }
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

/* True for a device whose line says what kind it is, of which series have limits: it is an element
 * of the netlist with a value, and no part. */
static bool is_of_series(const vs_device *d) {
  static const char *const KINDS[] = {"resistor", "capacitor", "electrolytic"};
  for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS; k++)
    if (!strcmp(d->of, KINDS[k])) return true;
  return false;
}

/* Adds the keys NAME_part that the scene gives: they say of which series a resistor or capacitor of
 * the netlist is, which gives it that series' limits. */
static vs_status add_series(vs_deck *deck, const vs_node *section, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t d = 0; d < deck->n_devices && !status; d++) {
    char key[VS_DECK_NAME + sizeof VS_DEVICE_PART];
    snprintf(key, sizeof key, "%s%s", deck->devices[d].name, VS_DEVICE_PART);
    const vs_node *node = vs_tree_child(section, key);
    bool known = !node || !is_of_series(&deck->devices[d]);
    for (size_t k = 0; k < deck->section.count; k++)
      known = known || !strcmp(deck->section.fields[k].key, key);
    if (known || node->kind != VS_NODE_TEXT) continue;
    if (deck->n_parts >= VS_DECK_PARTS)
      return vs_fail_at(err, node->where, "more than %d parts", VS_DECK_PARTS);
    const vs_field field = {.key = key,
                            .kind = VS_NAME,
                            .unit = "",
                            .default_text = node->text,
                            .text = "the series that it is of, for its limits",
                            .offset =
                                offsetof(vs_circuit_values, parts) + deck->n_parts * VS_NAME_SIZE};
    status = vs_deck_add_field(deck, &field, node->where, err);
    if (status) return status;
    vs_part *part = &deck->parts[deck->n_parts++];
    *part =
        (vs_part){.name = deck->section.fields[deck->section.count - 1].key, .where = node->where};
    snprintf(part->kind, sizeof part->kind, "%s", deck->devices[d].of);
  }
  return status;
}

vs_status vs_netlist_read_parts(vs_deck *deck, const vs_node *section, vs_error *err) {
  vs_status status = vs_error_carry_on(err, add_series(deck, section, err));
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
  if (!status && !deck->lost) status = check_whole(deck, err);
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

const vs_line *vs_netlist_line(const vs_deck *deck, size_t number) {
  size_t before = 1 + VS_STANDARD; /* as vs_netlist_make has it: the title, the parameters */
  for (size_t k = 1; k < deck->section.count; k++)
    before += deck->section.fields[k].kind == VS_REAL;
  return number >= before && number - before < deck->n_lines ? &deck->lines[number - before] : NULL;
}

void vs_netlist_free(char **lines, size_t count) {
  for (size_t k = 0; k < count; k++) free(lines[k]);
  free(lines);
}
