/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/netlist.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/jail.h"
#include "base/text.h"
#include "base/units.h"
#include "files.h"
#include "lint/couplings.h"
#include "lint/definitions.h"
#include "lint/slips.h"
#include "lint/subcircuits.h"
#include "netlist/cards.h"
#include "netlist/catalogue.h"
#include "netlist/devices.h"
#include "netlist/eva.h"
#include "netlist/kinds.h"
#include "netlist/numbers.h"
#include "netlist/parts.h"
#include "netlist/reserved.h"
#include "netlist/words.h"
#include "probes.h"
#include "rules.h"

/* ---- files ---- */

/* Holds ports and external sources against each other: each port drives one source, and a source
 * that no port drives would stay at 0 V. */
static vs_status match_sources(const vs_deck *deck, vs_error *err) {
  bool driven[VS_DECK_MOST] = {false};
  const vs_cards *c = vs_deck_cards(deck);
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->count && !status; k++) {
    if (!vs_cards_is_external(c, &c->card[k])) continue;
    char *name = vs_alloc_part(c->card[k].name.at, c->card[k].name.n);
    vs_cursor_lower(name);
    size_t p = 0;
    while (p < deck->n_ports && strcmp(deck->ports[p].source, name)) p++;
    if (p < deck->n_ports)
      driven[p] = true;
    else if (!(deck->lost & VS_LOST_PORT))
      status = vs_error_keep(
          err, vs_fail_at(err, deck->lines[k].where,
                          "the external source %s has no line '*$ port ... = %s'", name, name));
    free(name);
  }
  for (size_t p = 0; p < deck->n_ports && !status; p++)
    if (!driven[p] && !(deck->lost & VS_LOST_ELEMENT))
      status = vs_error_keep(err, vs_fail_at(err, deck->ports[p].where,
                                             "port: the deck has no source '%s n m external'",
                                             deck->ports[p].source));
  return status;
}

/* Holds the gains of controlled sources to the parameters that the deck has. */
static vs_status check_gains(const vs_deck *deck, vs_error *err) {
  vs_names names = {0};
  for (size_t k = 0; k < VS_STANDARD; k++)
    vs_names_put(&names, vs_deck_standard_names[k], strlen(vs_deck_standard_names[k]), k);
  for (size_t k = 1; k < deck->section.count; k++)
    vs_names_put(&names, deck->section.fields[k].key, strlen(deck->section.fields[k].key), k);
  vs_status status = vs_slips_gains(vs_deck_cards(deck), &names, err);
  vs_names_free(&names);
  return status;
}

/* Who is told of doubles. */
typedef struct doubles {
  vs_deck *deck;
  vs_error *err;
  vs_status status;
} doubles;

/* Refuses one name in two files: one of them, as a part, would get what the other says, while its
 * limits are judged. Warns of what else stands in the deck's own file, and of a second subcircuit
 * wherever it is: only what is called is read, so that one of two models is the one meant. Other
 * such lines of vendors' libraries do no harm to a circuit that was made with them. */
static void tell_double(void *ctx, vs_where where, bool apart, const char *text) {
  static const char SUBCKT[] = "a second .subckt";
  doubles *d = ctx;
  const bool own = where.file == d->deck->files[0];
  if (!apart && (own || !strncmp(text, SUBCKT, sizeof SUBCKT - 1)))
    vs_deck_remark(d->deck, where, "%s", text);
  if (!apart || d->status) return;
  char within[VS_PATH_SIZE];
  where = vs_deck_mendable(d->deck, where, within, sizeof within);
  d->status = vs_error_keep(d->err, vs_fail_at(d->err, where, "%s%s", text, within));
}

static vs_status check_doubles(vs_deck *deck, vs_error *err) {
  doubles d = {deck, err, VS_OK};
  vs_subcircuits_doubles(vs_deck_cards(deck), tell_double, &d);
  return d.status;
}

/* Gives other names to parameters that have one of ngspice's own. */
static void rename_reserved(vs_deck *deck) {
  const char **given = vs_alloc(deck->section.count + 1, sizeof *given);
  size_t count = 0;
  for (size_t k = 1; k < deck->section.count; k++)
    if (deck->section.fields[k].kind == VS_REAL) given[count++] = deck->section.fields[k].key;
  if (vs_reserved_rename(vs_deck_cards(deck), deck->lines, (vs_reserved_given){given, count},
                         *deck->compat != 0))
    vs_deck_changed(deck);
  free(given);
}

/* What can be told once all lines are there; messages have the user's names up to then. */
static vs_status check_whole(vs_deck *deck, vs_error *err) {
  const vs_cards *cards = vs_deck_cards(deck);
  vs_status status = vs_rules_params(deck, err);
  if (!status) status = vs_error_keep(err, vs_definitions_check(cards, err));
  if (!status) status = vs_error_keep(err, vs_subcircuits_circles(cards, err));
  if (!status) status = vs_slips_instances(cards, err);
  if (!status) status = vs_subcircuits_parameters(cards, err);
  if (!status) status = check_gains(deck, err);
  if (!status) status = vs_error_keep(err, vs_slips_names(cards, err));
  if (!status) status = vs_couplings_check(cards, err);
  if (!status) status = vs_probes_check_units(deck, err);
  if (!status) status = check_doubles(deck, err);
  if (!status) rename_reserved(deck);
  if (err->findings) vs_files_tell_unread(deck);
  return status;
}

/* True where a subcircuit has that name, be it within another one that is not closed. The cards are
 * not asked, as this is while files are read. */
static bool defines(const vs_deck *deck, const char *subcircuit) {
  for (size_t k = 0; k < deck->n_lines; k++) {
    const char *text = deck->lines[k].text;
    if (vs_words_begin(text, ".subckt") &&
        vs_words_is(vs_words_at(vs_words_next(text)), subcircuit))
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
  const vs_cards *c = vs_deck_cards(deck);
  for (size_t k = 0; k < c->count; k++) {
    const vs_word called = c->card[k].model;
    char name[VS_DECK_NAME];
    if (c->card[k].letter != 'x' || called.n >= sizeof name || deck->lines[k].written) continue;
    snprintf(name, sizeof name, "%.*s", (int)called.n, called.at);
    if (vs_text_nearest(name, EVA, 1) && !knows(deck, name))
      return vs_fail_at(err, vs_line_place(&deck->lines[k], called.at),
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
    status = vs_error_keep(
        err, vs_fail_at(err, deck->part_files[0].where,
                        "'*$ part' belongs into a part's file, not into a deck; a deck takes "
                        "a part by a line '*$ param thyristor = NAME part thyristor'"));
  if (!status && !*deck->eva && !(deck->lost & VS_LOST_ELEMENT))
    status = vs_error_keep(err, refuse_no_eva(deck, err));
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

/* ---- factors of single devices ---- */

/* What a part multiplies its voltage by, if it can be scaled: the key of all such devices. */
static const char SCALE[] = "varistor_scale";

/* Before the device's name: the subcircuit of a device with a factor of its own. */
static const char OWN_DISC[] = "vs_disc_";

/* The scope of a part's subcircuit; 0: it is not there. */
static size_t scope_of(const vs_cards *c, const char *subcircuit) {
  const vs_netlist_definition *d = vs_cards_find(c, 0, VS_CARDS_SUBCKT, vs_words_of(subcircuit));
  return d ? c->card[d->card].opens : 0;
}

/* True where the device's part has a voltage that SCALE multiplies. */
static bool is_scaled(const vs_deck *deck, const vs_device *d) {
  const vs_cards *c = vs_deck_cards(deck);
  const size_t scope = d->part < 0 ? 0 : scope_of(c, deck->parts[d->part].subcircuit);
  bool is = false;
  for (size_t k = c->scope[scope].first; scope && k < c->scope[scope].last && !is; k++)
    is = vs_words_find(deck->lines[k].text, deck->lines[k].text, SCALE, strlen(SCALE));
  return is;
}

/* True for an instance of that part of the deck. */
static bool is_instance(const vs_netlist_card *card, const vs_part *part) {
  return card->letter == 'x' && vs_words_is(card->model, part->name);
}

/* The source whose current alone is the device's, i(SOURCE); empty: there is none. */
static vs_word sense_of(const vs_deck *deck, const vs_device *d) {
  vs_word source = {"", 0};
  for (size_t t = 0; t < deck->n_terms; t++) {
    if (!vs_formula_uses(&d->current, (int)t)) continue;
    const char *text = deck->terms[t].plus;
    if (*text != 'i' || source.n) return (vs_word){"", 0};
    source = (vs_word){text + 2, strlen(text) - 3};
  }
  return source;
}

/* The instance of the part that alone shares a node with line `source`; n_lines: there is none. */
static size_t beside(const vs_cards *c, size_t source, const vs_part *part) {
  for (size_t n = 0; n < 2; n++) {
    const vs_word node = vs_cards_word(c, &c->card[source], n);
    size_t found = c->count, count = 0;
    for (size_t k = 0; k < c->count; k = vs_cards_next(c, k))
      if (k != source && c->card[k].kind == VS_CARDS_ELEMENT &&
          vs_cards_has_node(c, &c->card[k], node))
        found = k, count++;
    if (count == 1 && is_instance(&c->card[found], part)) return found;
  }
  return c->count;
}

/* The line of the netlist that is the device: the only instance of its part; of several the one in
 * series with the source that measures the device's current. n_lines: it cannot be told. */
static size_t instance_of(const vs_deck *deck, const vs_device *d) {
  const vs_cards *c = vs_deck_cards(deck);
  const vs_part *part = &deck->parts[d->part];
  const vs_word sense = sense_of(deck, d);
  size_t found = c->count, instances = 0, devices = 0, source = c->count;
  for (size_t k = 0; k < deck->n_devices; k++) devices += deck->devices[k].part == d->part;
  for (size_t k = 0; k < c->count; k = vs_cards_next(c, k)) {
    if (c->card[k].kind != VS_CARDS_ELEMENT) continue;
    if (is_instance(&c->card[k], part)) found = k, instances++;
    if (!vs_words_compare(c->card[k].name, sense)) source = k;
  }
  if (instances == 1 && devices == 1) return found;
  return source < c->count ? beside(c, source, part) : c->count;
}

/* Adds the keys NAME_scale of the devices whose parts can be scaled. A deck that has such a
 * parameter itself keeps its own. */
static void add_factors(vs_deck *deck) {
  const vs_field *all = NULL;
  for (size_t k = 1; k < deck->section.count; k++)
    if (!strcmp(deck->section.fields[k].key, SCALE)) all = &deck->section.fields[k];
  if (!all) return;
  for (size_t n = 0; n < deck->n_devices; n++) {
    vs_device *d = &deck->devices[n];
    char key[VS_DECK_NAME + sizeof "_scale"], text[VS_DECK_TEXT];
    const size_t params = deck->section.count - 1 - deck->n_parts;
    if (params >= VS_DECK_MOST || !is_scaled(deck, d)) continue;
    if (instance_of(deck, d) == deck->n_lines) continue;
    snprintf(key, sizeof key, "%s_scale", d->name);
    snprintf(text, sizeof text, "factor of the voltage of %s alone, besides %s", d->name, SCALE);
    const vs_field field = {.key = key,
                            .kind = VS_FACTOR,
                            .unit = "",
                            .default_text = "1",
                            .min = all->min,
                            .max = all->max,
                            .text = text,
                            .offset =
                                offsetof(vs_circuit_values, params) + params * sizeof(double)};
    vs_error none = {0};
    if (!vs_deck_add_field(deck, &field, d->where, &none)) d->scale_at = field.offset;
  }
}

static double factor_of(const vs_device *d, const vs_circuit_values *values) {
  return d->scale_at ? *(const double *)(const void *)((const char *)values + d->scale_at) : 1;
}

/* ---- parts ---- */

/* Finds a file of the user's that was meant by the name of a part: the file lies where the program
 * runs, or beside the scene, and the name lacks its ending or its folder. Writes the name that
 * would find it into `own`. The scene is known by the places of what its section says. */
static bool find_own_file(const vs_node *section, const char *name, vs_where where,
                          char own[VS_PATH_SIZE]) {
  vs_error unread = {0};
  for (int k = 0; k < 2 && !strchr(name, '/'); k++) { /* without and with the ending */
    char whole[VS_PATH_SIZE];
    struct stat s;
    snprintf(whole, sizeof whole, "%.4000s%s", name, k ? vs_deck_parts_shelf.ending : "");
    snprintf(own, VS_PATH_SIZE, "%s", whole);
    bool here = k && !stat(own, &s) && S_ISREG(s.st_mode);
    if (!here && section) here = vs_path_beside(whole, section->where, own);
    for (const vs_node *n = section ? section->child : NULL; n && !here; n = n->next)
      here = vs_path_beside(whole, n->where, own);
    if (here) return !vs_jail_check(own, where, &unread);
  }
  return false;
}

/* Finds the file of a part: beside the file that names it, or in the deck's folder, or at the path
 * given, or on the shelf of parts, where it may be a row of a table. */
static vs_status find_part(const vs_deck *deck, const vs_node *section, const char *name,
                           vs_where where, char path[VS_PATH_SIZE], vs_error *err) {
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
  char own[VS_PATH_SIZE];
  vs_status status = vs_catalogue_find(&vs_deck_parts_shelf, name, where, path, err);
  if (!status || !find_own_file(section, name, where, own)) return status;
  return vs_fail_at(err, where,
                    "no part '%s' comes with the program; the file %s is there: write %s", name,
                    own, own);
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

/* A subcircuit with parameters may have been given another name (netlist/dialect/translate.h). */
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

static vs_status take_part(vs_deck *deck, const vs_node *section, vs_part *part, const char *name,
                           vs_where where, vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_status status = find_part(deck, section, name, where, path, err);
  if (!status) tell_hidden_part(deck, name, path, where);
  if (!status && !vs_files_has(deck, path)) {
    /* the deck is to be mended where it takes a part of the program's, and not what a scene says */
    const bool own = where.file == part->where.file && !vs_deck_is_shipped(where.file);
    if (own && deck->n_files < VS_DECK_FILES && vs_deck_is_shipped(path))
      deck->included[deck->n_files] = where;
    status = vs_files_read(deck, path, false, err);
  } else if (!status) { /* it may have been included as a library */
    status = vs_files_call(deck, path, err);
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
  const vs_kind *kind = vs_kinds_find(d->of);
  return kind && kind->of_series;
}

bool vs_netlist_series_key(const vs_deck *deck, size_t device, char key[VS_SERIES_KEY],
                           vs_field *field) {
  const vs_device *d = &deck->devices[device];
  bool known = !is_of_series(d);
  snprintf(key, VS_SERIES_KEY, "%s%s", d->name, VS_DEVICE_PART);
  for (size_t k = 0; k < deck->section.count; k++)
    known = known || !strcmp(deck->section.fields[k].key, key);
  *field = (vs_field){.key = key,
                      .kind = VS_NAME,
                      .unit = "",
                      .default_text = "none",
                      .text = "the series that it is of, for its limits; or none"};
  return !known;
}

/* Adds the keys NAME_part that the scene gives. */
static vs_status add_series(vs_deck *deck, const vs_node *section, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t d = 0; d < deck->n_devices && !status; d++) {
    char key[VS_SERIES_KEY];
    vs_field field;
    const bool is_new = vs_netlist_series_key(deck, d, key, &field);
    const vs_node *node = vs_tree_child(section, key);
    if (!is_new || !node || node->kind != VS_NODE_TEXT) continue;
    if (!*node->text)
      return vs_fail_at(err, node->where, "circuit.%s: a part is wanted, or none", key);
    if (deck->n_parts >= VS_DECK_PARTS)
      return vs_fail_at(err, node->where, "more than %d parts", VS_DECK_PARTS);
    field.default_text = node->text;
    field.offset = offsetof(vs_circuit_values, parts) + deck->n_parts * VS_NAME_SIZE;
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
  const size_t declared = deck->n_parts; /* by the deck; the others are series */
  vs_status status = vs_error_keep(err, add_series(deck, section, err));
  for (size_t p = 0, k = 1; p < deck->n_parts && !status; k++) {
    const vs_field *field = &deck->section.fields[k];
    if (field->kind != VS_NAME) continue;
    const vs_node *node = vs_tree_child(section, field->key);
    bool given = node && node->kind == VS_NODE_TEXT;
    vs_where where = given ? node->where : deck->parts[p].where;
    if (p >= declared && !strcmp(given ? node->text : field->default_text, "none"))
      p++;
    else
      status = vs_error_keep(err, take_part(deck, section, &deck->parts[p++],
                                            given ? node->text : field->default_text, where, err));
  }
  if (!status) status = vs_parts_resolve(deck, err);
  if (!status) status = vs_devices_resolve(deck, err);
  if (!status) add_factors(deck);
  if (!status && !deck->lost) status = check_whole(deck, err);
  return status ? status : match_sources(deck, err);
}

/* ---- a value and its series ---- */

/* The value, SI, of the deck's parameter of that name and kind of unit; NaN: there is none. */
static double parameter(const vs_deck *deck, const vs_circuit_values *values, vs_word name,
                        const char *unit) {
  for (size_t k = 1; k < deck->section.count; k++) {
    const vs_field *field = &deck->section.fields[k];
    if (field->kind == VS_REAL && vs_words_is(name, field->key) &&
        vs_units_same_kind(field->unit, unit))
      return *(const double *)(const void *)((const char *)values + field->offset);
  }
  return NAN;
}

/* The value of the deck's element R or C of that name, where it is a number or a parameter in
 * braces; NaN: it is none of these, or there is no such element outside of subcircuits. */
static double element_value(const vs_deck *deck, const vs_circuit_values *values, const char *name,
                            const char *unit) {
  const vs_cards *c = vs_deck_cards(deck);
  double value;
  for (size_t k = 0; k < c->count; k = vs_cards_next(c, k)) {
    const vs_word w = vs_cards_word(c, &c->card[k], 2);
    if (c->card[k].kind != VS_CARDS_ELEMENT || !vs_words_is(c->card[k].name, name) || !w.n)
      continue;
    if (*w.at == '{' && w.n > 2) return parameter(deck, values, (vs_word){w.at + 1, w.n - 2}, unit);
    return vs_numbers_read(w, &value) ? value : NAN;
  }
  return NAN;
}

static double value_in_braces(const vs_deck *deck, const vs_circuit_values *values,
                              const char *name, const char *unit) {
  const char *underscore = strrchr(name, '_');
  double value = parameter(deck, values, vs_words_of(name), unit);
  if (isnan(value)) value = element_value(deck, values, name, unit);
  if (isnan(value) && underscore)
    value = parameter(deck, values, (vs_word){name, (size_t)(underscore - name)}, unit);
  return value;
}

bool vs_netlist_beyond_series(const vs_deck *deck, const vs_circuit_values *values, size_t part,
                              char *text, size_t size) {
  enum { SUFFIX = sizeof VS_DEVICE_PART - 1 };
  static const double TOLERANCE = 0.2; /* the widest of film capacitors, class M */
  const vs_part *p = &deck->parts[part];
  const size_t n = strlen(p->name);
  if (!p->file || n <= SUFFIX || strcmp(p->name + n - SUFFIX, VS_DEVICE_PART)) return false;
  char name[VS_DECK_NAME];
  snprintf(name, sizeof name, "%.*s", (int)(n - SUFFIX), p->name);
  const vs_limit *least = vs_parts_find_limit(deck, p->file, "r_least"),
                 *most = vs_parts_find_limit(deck, p->file, "r_most"),
                 *rated = vs_parts_find_limit(deck, p->file, "c_rated");
  if (rated && isfinite(rated->value)) {
    double c_f = value_in_braces(deck, values, name, rated->unit);
    if (isnan(c_f) || fabs(c_f - rated->value) <= TOLERANCE * rated->value) return false;
    snprintf(text, size, "circuit.%s: %s has %s, and %s is %.6g %s; a part of that value is wanted",
             p->name, p->subcircuit, rated->written, name, c_f / vs_units_factor(rated->unit),
             rated->unit);
    return true;
  }
  if (!least || !most || !isfinite(least->value) || !isfinite(most->value)) return false;
  double r_ohm = value_in_braces(deck, values, name, "ohm");
  if (isnan(r_ohm) || (r_ohm >= least->value && r_ohm <= most->value)) return false;
  const char *unit = r_ohm < least->value ? least->unit : most->unit;
  snprintf(text, size, "circuit.%s: %s is made from %s to %s, and %s is %.6g %s", p->name,
           p->subcircuit, least->written, most->written, name, r_ohm / vs_units_factor(unit), unit);
  return true;
}

/* ---- for the solver ---- */

static void add_text(char ***lines, size_t *count, const char *text) {
  *lines = vs_alloc_grow(*lines, *count, sizeof **lines);
  (*lines)[(*count)++] = vs_copy(text);
}

/* Where a netlist is written: the lines, and of each device the line that is an instance of a
 * subcircuit of its own. */
typedef struct writing {
  const vs_deck *deck;
  char **lines;
  size_t count;
  size_t own[VS_DECK_DEVICES]; /* n_lines: the device has none */
} writing;

/* Adds a line of the deck. Where it is an instance of a parameter that is a part, the part's
 * subcircuit takes the parameter's place, or the device's own. */
static void add_deck_line(writing *w, size_t number) {
  const vs_deck *deck = w->deck;
  const vs_netlist_card *card = &vs_deck_cards(deck)->card[number];
  const char *line = deck->lines[number].text, *takes = NULL;
  for (size_t p = 0; card->letter == 'x' && p < deck->n_parts && !takes; p++)
    if (vs_words_is(card->model, deck->parts[p].name)) takes = deck->parts[p].subcircuit;
  if (!takes) {
    add_text(&w->lines, &w->count, line);
    return;
  }
  vs_text text = {0};
  vs_text_add(&text, "%.*s", (int)(card->model.at - line), line);
  size_t d = 0;
  while (d < deck->n_devices && w->own[d] != number) d++;
  if (d < deck->n_devices)
    vs_text_add(&text, "%s%s", OWN_DISC, deck->devices[d].name);
  else
    vs_text_add(&text, "%s", takes);
  vs_text_add(&text, "%s", card->model.at + card->model.n);
  add_text(&w->lines, &w->count, text.text);
  vs_text_free(&text);
}

/* Adds the subcircuit of the device's part once more, by a name of the device's and with its factor
 * beside SCALE. */
static void add_own_disc(writing *w, const vs_device *d, double factor) {
  const vs_deck *deck = w->deck;
  const vs_cards *c = vs_deck_cards(deck);
  const vs_netlist_scope *scope = &c->scope[scope_of(c, deck->parts[d->part].subcircuit)];
  for (size_t k = scope->first - 1; k <= scope->last; k++) {
    const char *from = deck->lines[k].text, *at;
    vs_text text = {0};
    if (k == scope->first - 1) {
      vs_text_add(&text, ".subckt %s%s", OWN_DISC, d->name);
      from = scope->name.at + scope->name.n;
    } else if (k == scope->last) {
      vs_text_add(&text, ".ends");
      from = "";
    }
    for (; (at = vs_words_find(from, from, SCALE, strlen(SCALE))); from = at + strlen(SCALE))
      vs_text_add(&text, "%.*s(%s*%.17g)", (int)(at - from), from, SCALE, factor);
    vs_text_add(&text, "%s", from);
    add_text(&w->lines, &w->count, text.text);
    vs_text_free(&text);
  }
}

/* Finds the devices with a factor of their own that is not 1. */
static void find_own(writing *w, const vs_circuit_values *values) {
  for (size_t d = 0; d < w->deck->n_devices; d++) {
    const vs_device *device = &w->deck->devices[d];
    w->own[d] = factor_of(device, values) == 1 ? w->deck->n_lines : instance_of(w->deck, device);
  }
}

vs_status vs_netlist_make(const vs_deck *deck, const vs_circuit_values *values,
                          const vs_deck_value *standard, size_t n_standard, char ***lines,
                          size_t *count, vs_error *err) {
  writing w = {.deck = deck};
  *lines = NULL;
  *count = 0;
  char param[128], *rest;
  vs_text eva = {0};
  vs_status status = vs_eva_write(deck, &eva, err);
  if (status) return status;
  find_own(&w, values);
  add_text(&w.lines, &w.count, "vibrospice"); /* the first line of a netlist is its title */
  for (size_t k = 0; k < n_standard; k++) {
    snprintf(param, sizeof param, ".param %s=%.17g", standard[k].name, standard[k].value);
    add_text(&w.lines, &w.count, param);
  }
  for (size_t k = 1; k < deck->section.count; k++) {
    const vs_field *field = &deck->section.fields[k];
    if (field->kind != VS_REAL) continue;
    vs_text line = {0};
    vs_text_add(&line, ".param ");
    vs_reserved_write(field->key, *deck->compat != 0, &line);
    vs_text_add(&line, "=%.17g",
                *(const double *)(const void *)((const char *)values + field->offset));
    add_text(&w.lines, &w.count, line.text);
    vs_text_free(&line);
  }
  for (size_t k = 0; k < deck->n_lines; k++) add_deck_line(&w, k);
  rest = eva.text;
  for (char *line; (line = strsep(&rest, "\n"));)
    if (*line) add_text(&w.lines, &w.count, line);
  for (size_t d = 0; d < deck->n_devices; d++)
    if (w.own[d] < deck->n_lines)
      add_own_disc(&w, &deck->devices[d], factor_of(&deck->devices[d], values));
  vs_text_free(&eva);
  *lines = w.lines;
  *count = w.count;
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
