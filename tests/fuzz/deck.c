/* SPDX-License-Identifier: GPL-3.0-or-later
 * Decks with what they include, from their files to the netlist that ngspice would be given, and
 * what `check` says of them. ngspice itself is not asked. */
#include "netlist/deck.h"

#include <string.h>

#include "engine/macromodel/circuit_states.h"
#include "import/hint.h"
#include "netlist/location.h"
#include "netlist/netlist.h"
#include "netlist/parts.h"
#include "targets.h"

static const char *const FILES[] = {"a.inc", "b.inc", "c.lib", "d.inc", NULL};

static const vs_deck_value STANDARD[VS_STANDARD] = {
    {"u_rms", 440},     {"f_mains", 50},        {"phase", 0},     {"r_source", 0.5},
    {"l_source", 5e-4}, {"eva_resistance", 92}, {"eva_a", 5.2e-3}};

/* What ngspice may complain of: %s stands for a word of the deck's own lines. */
static void locate(const vs_deck *deck) {
  static const char *const SAYS[] = {"no such vector v(%s)", "Undefined parameter [%s]",
                                     "Error on line: %s 1 2 3", "unknown subckt: %s"};
  for (size_t k = 0; k < deck->n_lines && k < 4; k++) {
    vs_error err = {0};
    const char *line = deck->lines[k].text;
    vs_fail(&err, VS_INPUT, "ngspice: ");
    size_t n = strlen(err.text), length = strcspn(line, " \t");
    const char *says = SAYS[k % 4], *hole = strstr(says, "%s");
    if (length > 200) length = 200;
    snprintf(err.text + n, sizeof err.text - n, "%.*s%.*s%s", (int)(hole - says), says, (int)length,
             line, hole + 2);
    vs_location_locate(deck, k % 3 ? 0 : k, &err);
    FUZZ_HOLDS(*err.text);
  }
}

static void look(const vs_deck *deck, const char *path) {
  const vs_check_options options = {.name = path};
  vs_warnings warnings = {0};
  vs_check_bench bench = {.warnings = &warnings};
  vs_hint_look(&options, deck, &bench);
  vs_warnings_of_netlist(deck, &warnings);
  vs_warnings_of_limits(deck, &warnings);
  vs_warnings_without_mains(deck);
  vs_warnings_free(&warnings);
  vs_text_free(&bench.rows);
  vs_text_free(&bench.table);
}

static void use(vs_deck *deck, const char *path, vs_circuit_values *values) {
  static vs_circuit_states memories;
  vs_error err = {0};
  char **lines = NULL, text[VS_DECK_TEXT + VS_NAME_SIZE];
  size_t count = 0;
  vs_status status = vs_netlist_make(deck, values, STANDARD, VS_STANDARD, &lines, &count, &err);
  fuzz_judge(status, &err);
  if (!status) vs_netlist_free(lines, count);
  memories.count = 0;
  vs_circuit_states_list(deck, &memories);
  vs_circuit_states_are_hidden(deck);
  for (size_t p = 0; p < deck->n_parts; p++) vs_parts_below_mains(deck, p, 440, text, sizeof text);
  look(deck, path);
  locate(deck);
}

static vs_status read_once(const char *path, vs_findings *all) {
  static vs_deck of; /* too large to be made anew for each text, as the next are */
  static vs_circuit_values of_values;
  vs_deck *deck = &of;
  vs_circuit_values *values = &of_values;
  vs_error err = {.findings = all};
  memset(deck, 0, sizeof *deck);
  memset(values, 0, sizeof *values);
  vs_status status = vs_netlist_read(path, deck, &err);
  if (!status) status = vs_netlist_read_parts(deck, NULL, &err);
  if (!status) status = vs_field_section_read(&deck->section, NULL, values, &err);
  if (!status) status = vs_deck_bind(deck, values, STANDARD, VS_STANDARD, &err);
  if (!status) status = vs_parts_require_hold(deck, values, NULL, &err);
  fuzz_judge(status, &err);
  if (!status && !vs_error_count(&err)) use(deck, path, values);
  vs_deck_free(deck);
  return status;
}

static void take(const char *text, size_t size) {
  char path[VS_PATH_SIZE];
  fuzz_write_all(text, size, "deck.cir", FILES, path);
  fuzz_read(read_once, path, size);
}

const fuzz_target fuzz_deck = {"deck", take, &fuzz_grammar_deck, NULL};
