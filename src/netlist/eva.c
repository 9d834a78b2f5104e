/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/eva.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/hash.h"
#include "netlist/cards.h"

static const vs_shelf EVA_SHELF = {"subcircuit", "", ".inc"};

/* What the files have for the current, where the flux linkage begins, and how they end. */
static const char CURRENT[] = "v(lam)*v(z) m={1/(2*eva_a)}", BEGINS[] = " ic=0", ENDS[] = ".ends";

static void add_eddy(vs_deck *deck, double resistance_ohm, double inductance_h) {
  double *e = deck->eva_eddy[deck->n_eva_eddies++];
  e[0] = resistance_ohm;
  e[1] = inductance_h;
}

void vs_eva_take_law(vs_deck *deck, const vs_coil *coil) {
  vs_text force = {0};
  deck->n_eva_eddies = 0;
  if (coil->core_s > 0) add_eddy(deck, 1 / coil->core_s, 0);
  for (int n = 0; n < coil->rungs; n++) {
    const vs_rung *r = &coil->rung[n];
    add_eddy(deck, r->resistance_ohm / (r->share * r->share), 1 / (r->per_h * r->share));
  }
  vs_text_free(&deck->eva_lines);
  vs_text_free(&deck->eva_current);
  if (coil->square || !coil->law->netlist) return;
  coil->law->netlist(coil, "v(lam)", "v(z)", &deck->eva_lines, &deck->eva_current, &force);
  vs_text_free(&force);
}

vs_status vs_eva_check_names(const vs_deck *deck, const vs_coil *coil, vs_error *err) {
  const char *name = vs_deck_standard_names[VS_STANDARD_EVA_A];
  vs_where where = {0};
  if (coil->a_hm != 0) return VS_OK;
  for (size_t k = 0; k < deck->n_names && !where.file; k++)
    if (!strcasecmp(deck->names[k].name, name)) where = deck->names[k].where;
  for (size_t k = 0; k < deck->n_lines && !where.file; k++)
    if (vs_words_find(deck->lines[k].text, deck->lines[k].text, name, strlen(name)))
      where = deck->lines[k].where;
  if (!where.file) return VS_OK;
  return vs_fail_at(
      err, where,
      "%s: the actuator's law %s has no a (a = L z/2 of a plain reluctance); leave it "
      "out, or take actuator.law reluctance",
      name, coil->law->name);
}

/* ---- the machine's motion ---- */

_Static_assert(VS_DECK_MOTIONS == 2 * VS_MACHINE_COORDINATES + 1,
               "a node for the gap's rate, each coordinate and each coordinate's rate");

/* The nodes that every EVA has. */
static const char *const OWN[] = {"z", "lam"}; /* the second one is a state */
static const char RATE[] = "vz", COORDINATE[] = "q_", VELOCITY[] = "v_";

static bool is_part_of_a_name(char c) {
  return isalnum((unsigned char)c) || strchr("_.#", c);
}

/* Finds the next word "EVA.NODE" at or behind `from` and gives NODE in lower case; NULL: none. */
static const char *find_node(const char *eva, const char *line, const char *from,
                             char node[VS_DECK_NAME]) {
  size_t n = strlen(eva);
  for (const char *s = from; (s = vs_words_find(line, s, eva, n)); s++) {
    if (s[n] != '.' || (s > line && is_part_of_a_name(s[-1]))) continue;
    size_t length = 0;
    while (s[n + 1 + length] && is_part_of_a_name(s[n + 1 + length])) length++;
    snprintf(node, VS_DECK_NAME, "%.*s", (int)length, s + n + 1);
    vs_cursor_lower(node);
    return s;
  }
  return NULL;
}

/* The nodes' names: those of every EVA, the gap's rate, the machine's. */
typedef struct node_names {
  char text[VS_DECK_MOTIONS][VS_DECK_NAME];
  const char *all[VS_DECK_MOTIONS + sizeof OWN / sizeof *OWN];
  size_t count;
} node_names;

static void name_nodes(const vs_machine *machine, node_names *names) {
  size_t own = sizeof OWN / sizeof *OWN;
  names->count = own + 1 + 2 * (size_t)machine->dof;
  memcpy(names->all, OWN, sizeof OWN);
  for (size_t k = own; k < names->count; k++) names->all[k] = names->text[k - own];
  snprintf(names->text[0], VS_DECK_NAME, "%s", RATE);
  for (int k = 0; k < 2 * machine->dof; k++) {
    char *text = names->text[1 + k];
    snprintf(text, VS_DECK_NAME, "%s%s", k < machine->dof ? COORDINATE : VELOCITY,
             machine->coordinates[k % machine->dof].name);
    vs_cursor_lower(text);
  }
}

static vs_status unknown_node(const vs_deck *deck, const char *node, const node_names *names,
                              vs_where where, vs_error *err) {
  vs_text all = {0}, hint = {0};
  for (size_t k = 0; k < names->count; k++)
    vs_text_add(&all, "%s%s.%s", k ? ", " : "", deck->eva, names->all[k]);
  const char *nearest = vs_text_nearest(node, names->all, names->count);
  if (nearest) vs_text_add(&hint, "; did you mean '%s.%s'?", deck->eva, nearest);
  vs_status status =
      vs_fail_at(err, where, "%s.%s: the EVA has no such node on this machine; there are: %s%s",
                 deck->eva, node, all.text, hint.text ? hint.text : "");
  vs_text_free(&all);
  vs_text_free(&hint);
  return status;
}

/* Notes a node that is named at a place. */
static vs_status take_node(vs_deck *deck, const char *node, const node_names *names, vs_where where,
                           vs_error *err) {
  size_t own = sizeof OWN / sizeof *OWN, found = names->count, count = 0;
  for (size_t k = names->count; k-- > 0;)
    if (!strcmp(names->all[k], node)) found = k, count++;
  if (!count) return unknown_node(deck, node, names, where, err);
  if (count > 1)
    return vs_fail_at(err, where,
                      "%s.%s: the machine has %zu coordinates of this name, as ngspice takes no "
                      "notice of capitals; give one of them another name",
                      deck->eva, node, count);
  for (size_t k = 0; k < deck->n_motions; k++)
    if (!strcmp(deck->motions[k].name, node)) return VS_OK;
  if (found < own) return VS_OK;
  vs_motion_node *motion = &deck->motions[deck->n_motions++];
  snprintf(motion->name, sizeof motion->name, "%s", node);
  motion->state = (int)(found - own) - 1;
  return VS_OK;
}

/* True where the node is known within subcircuits, too; or where some subcircuit has an instance of
 * the EVA's name, whose node it may be. */
static bool may_stand_within(const vs_deck *deck, const char *node) {
  char whole[2 * VS_DECK_NAME + 2];
  const vs_cards *c = vs_deck_cards(deck);
  snprintf(whole, sizeof whole, "%s.%s", deck->eva, node);
  for (size_t k = 0; k < c->count; k++) {
    const vs_netlist_card *card = &c->card[k];
    for (size_t n = 0; card->kind == VS_CARDS_GLOBAL && n < card->words; n++)
      if (vs_words_is(vs_cards_word(c, card, n), whole)) return true;
    if (card->scope && card->kind == VS_CARDS_ELEMENT && vs_words_is(card->name, deck->eva))
      return true;
  }
  return false;
}

static bool is_of_the_deck(const vs_deck *deck, vs_where where) {
  for (size_t k = 0; k < deck->n_files; k++)
    if (deck->files[k] == where.file) return true;
  return false;
}

/* True where the word at `at` draws no current from the node it names: it stands in a statement, or
 * behind the two nodes of an element that has only these, or only reads the others. */
static bool draws_nothing(const char *line, const char *at) {
  int words = 0;
  for (const char *s = line; s < at; s = vs_words_next(s)) words++;
  return *line == '.' || (strchr("rclvidbefghws", tolower((unsigned char)*line)) && words > 2);
}

/* Takes a node that a line names at `at`. */
static vs_status take_mention(vs_deck *deck, size_t line, const char *at, const char *node,
                              const node_names *names, vs_where where, vs_error *err) {
  const vs_netlist_card *card = &vs_deck_cards(deck)->card[line];
  const bool within = card->scope || card->opens;
  if (within && !may_stand_within(deck, node))
    return vs_fail_at(err, where,
                      "%s.%s within a subcircuit is a node of its own; hand the EVA's to it as one "
                      "of its nodes, or write .global %s.%s",
                      deck->eva, node, deck->eva, node);
  if (within) return VS_OK;
  if (!strcmp(node, OWN[1]) && !draws_nothing(deck->lines[line].text, at))
    return vs_fail_at(err, where,
                      "%s.%s: a current from this node would change the flux linkage; let a source "
                      "read it, as in E1 a 0 %s.%s 0 1",
                      deck->eva, node, deck->eva, node);
  return take_node(deck, node, names, where, err);
}

/* Takes the nodes that one line of the netlist names. */
static vs_status take_nodes_of_line(vs_deck *deck, size_t number, const node_names *names,
                                    vs_error *err) {
  static const char *const SAY_ONLY[] = {".ic", ".nodeset", ".global"};
  char node[VS_DECK_NAME], other[VS_DECK_NAME];
  const vs_line *line = &deck->lines[number];
  const char *text = line->text, *written = line->written ? line->written : text;
  bool reads = !VS_WORDS_AMONG(vs_words_at(text), SAY_ONLY);
  vs_status status = VS_OK;
  for (const char *at = text; !status && (at = find_node(deck->eva, text, at, node)); at++) {
    /* where the text was changed, the place is that of the first node */
    const char *in_file = line->written ? find_node(deck->eva, written, written, other) : at;
    vs_where where = vs_line_place(line, in_file ? in_file : written);
    status = vs_error_keep(err, take_mention(deck, number, at, node, names, where, err));
    if (reads && !deck->reads_eva.file) deck->reads_eva = where;
  }
  return status;
}

vs_status vs_eva_take_motions(vs_deck *deck, const vs_machine *machine, vs_error *err) {
  node_names names;
  char node[VS_DECK_NAME];
  vs_status status = VS_OK;
  deck->n_motions = 0;
  deck->reads_eva = (vs_where){0};
  if (!*deck->eva) return VS_OK; /* a check carries on without it */
  name_nodes(machine, &names);
  for (size_t k = 0; k < deck->n_lines && !status; k++)
    if (is_of_the_deck(deck, deck->lines[k].where))
      status = take_nodes_of_line(deck, k, &names, err);
  for (size_t k = 0; k < deck->n_terms && !status; k++) {
    const vs_term *term = &deck->terms[k];
    const char *of[] = {term->plus, term->minus};
    for (int n = 0; n < 2 && is_of_the_deck(deck, term->where) && !status; n++)
      if (find_node(deck->eva, of[n], of[n], node))
        status = vs_error_keep(err, take_node(deck, node, &names, term->where, err));
  }
  return status;
}

/* ---- written ---- */

/* Adds the secondaries, which lie between the nodes of the source whose line this is. */
static void add_eddies(const vs_deck *deck, const char *line, vs_text *out) {
  char plus[VS_DECK_NAME], minus[VS_DECK_NAME];
  if (sscanf(line, "%*s %63s %63s", plus, minus) != 2) return;
  for (size_t n = 0; n < deck->n_eva_eddies; n++) {
    const double *e = deck->eva_eddy[n];
    if (e[1] == 0)
      vs_text_add(out, "Reddy%zu %s %s %.17g\n", n + 1, plus, minus, e[0]);
    else
      vs_text_add(out, "Reddy%zu %s eddy%zu %.17g\nLeddy%zu eddy%zu %s %.17g\n", n + 1, plus, n + 1,
                  e[0], n + 1, n + 1, minus, e[1]);
  }
}

void vs_eva_add_eddy_currents(const vs_deck *deck, vs_text *out) {
  for (size_t n = 0; n < deck->n_eva_eddies; n++) {
    const double *e = deck->eva_eddy[n];
    if (e[1] == 0)
      vs_text_add(out, "+(v(%s.x)-v(%s))/%.17g", deck->eva, deck->eva_minus, e[0]);
    else
      vs_text_add(out, "+(v(%s.x)-v(%s.eddy%zu))/%.17g", deck->eva, deck->eva, n + 1, e[0]);
  }
}

/* Adds a line of the file, with the law's texts in the place of the file's own, and before the last
 * one the sources of the machine's motion. Returns how often it took the law's current. */
static int add_line(const vs_deck *deck, const char *line, vs_text *out) {
  const char *at = strstr(line, CURRENT), *begins = strstr(line, BEGINS);
  if (deck->eva_current.text && !strncasecmp(line, ENDS, sizeof ENDS - 1) && deck->eva_lines.text)
    vs_text_add(out, "%s", deck->eva_lines.text);
  for (size_t k = 0; k < deck->n_motions && !strncasecmp(line, ENDS, sizeof ENDS - 1); k++)
    vs_text_add(out, "V%s %s 0 external\n", deck->motions[k].name, deck->motions[k].name);
  if (deck->eva_current.text && at)
    vs_text_add(out, "%.*s(%s)%s\n", (int)(at - line), line, deck->eva_current.text,
                at + sizeof CURRENT - 1);
  else if (deck->eva_flux_wb != 0 && begins)
    vs_text_add(out, "%.*s ic=%.17g%s\n", (int)(begins - line), line, deck->eva_flux_wb,
                begins + sizeof BEGINS - 1);
  else
    vs_text_add(out, "%s\n", line);
  if (at) add_eddies(deck, line, out);
  return deck->eva_current.text && at ? 1 : 0;
}

vs_status vs_eva_write(const vs_deck *deck, vs_text *out, vs_error *err) {
  char path[VS_PATH_SIZE], *line = NULL;
  size_t size = 0;
  int taken = 0;
  const char *own = deck->eva_led ? "eva_led" : "eva";
  vs_status status = vs_path_find_shipped(&EVA_SHELF, deck->eva_file ? deck->eva_file : own,
                                          (vs_where){0}, "not a file", path, err);
  if (status) return status;
  FILE *file;
  status = vs_hash_open(path, &file, err);
  if (status) return status;
  if (!file) return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
  while (vs_alloc_line(&line, &size, file) >= 0) {
    line[strcspn(line, "\r\n")] = '\0';
    if (*line && *line != '*') taken += add_line(deck, line, out);
  }
  status = vs_file_was_read(file, path, err);
  free(line);
  fclose(file);
  if (status) return status;
  if (deck->eva_current.text && !taken)
    return vs_fail(err, VS_INPUT, "%s: has no current '%s' for the law to take the place of", path,
                   CURRENT);
  return VS_OK;
}
