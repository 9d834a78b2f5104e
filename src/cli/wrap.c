/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "wrap.h"

#include <ctype.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/path.h"
#include "base/text.h"
#include "netlist/cards.h"
#include "netlist/kinds.h"
#include "netlist/source.h"

enum { MOST_PINS = 8 };

/* One subcircuit's head. */
typedef struct subcircuit {
  char name[VS_WRAP_NAME], pin[MOST_PINS][VS_WRAP_NAME];
  size_t pins;
} subcircuit;

/* What is gone through. */
typedef struct search {
  const char *wanted; /* the subcircuit's name; NULL: any */
  size_t pins;        /* how many it must have */
  subcircuit best;
  size_t fitting, all;
  vs_text names; /* of all that fit, for the message */
  bool pspice;
  vs_line *lines; /* of the file; owned */
  size_t n_lines;
  vs_cards cards; /* they taken apart */
} search;

/* ---- the vendor's file ---- */

/* Takes a subcircuit by its head. One with too many pins is no part. */
static void take_subcircuit(search *f, const vs_cards *c, const vs_netlist_card *head) {
  subcircuit s = {.pins = head->nodes};
  if (!head->name.n || s.pins > MOST_PINS) return;
  snprintf(s.name, sizeof s.name, "%.*s", (int)head->name.n, head->name.at);
  for (size_t k = 0; k < s.pins; k++) {
    const vs_word pin = vs_cards_word(c, head, k);
    snprintf(s.pin[k], sizeof s.pin[k], "%.*s", (int)pin.n, pin.at);
  }
  f->all++;
  if (f->wanted ? strcasecmp(s.name, f->wanted) != 0 : s.pins != f->pins) return;
  vs_text_add(&f->names, "%s%s", f->fitting ? ", " : "", s.name);
  if (!f->fitting++) f->best = s;
}

static bool is_of_pspice(const char *line) {
  static const char *const PSPICE[] = {"params:", "value={", "value {",  "value = {", "if(",
                                       "table {", "*temp",   "(temp",    "t_abs",     "t_measured",
                                       "t_rel_",  "ako:",    " vswitch", " iswitch"};
  bool is = false;
  for (size_t k = 0; k < sizeof PSPICE / sizeof *PSPICE; k++)
    is = is || strcasestr(line, PSPICE[k]);
  return is;
}

/* Lines are joined with those that go on with '+'; comments are left out. */
static vs_status take_file(search *f, const char *path, vs_error *err) {
  vs_source source;
  vs_status status = vs_source_read(path, &source, err);
  f->lines = vs_alloc(source.count + 1, sizeof *f->lines);
  for (size_t k = 0; k < source.count && !status; k++) {
    char *text = source.line[k] + strspn(source.line[k], " \t");
    text[strcspn(text, ";")] = '\0';
    if (!*text || *text == '*') continue;
    f->n_lines += *text != '+' || !f->n_lines;
    vs_line_join(&f->lines[f->n_lines - 1], text + (*text == '+'), (vs_where){path, (int)k + 1, 1});
  }
  for (size_t k = 0; k < f->n_lines; k++) vs_words_unbrace(f->lines[k].text);
  vs_cards_read(&f->cards, f->lines, f->n_lines);
  for (size_t k = 0; k < f->n_lines; k++) {
    f->pspice = f->pspice || is_of_pspice(f->lines[k].text);
    const vs_netlist_card *card = &f->cards.card[k];
    if (card->kind == VS_CARDS_SUBCKT) take_subcircuit(f, &f->cards, card);
  }
  vs_source_free(&source);
  return status;
}

/* ---- pins ---- */

/* True where the pin's name begins with one of the words, capitals aside. */
static bool begins(const char *pin, const char *words) {
  for (const char *at = words; at && *at == ' ' && at[1];) {
    size_t n = strcspn(at + 1, " ");
    if (!strncasecmp(pin, at + 1, n)) return true;
    at += 1 + n;
  }
  return false;
}

/* The node that a pin of this name is; -1: its name does not say. also: words that may mean
 * something else, too. */
static int node_of(const vs_kind *kind, const char *pin, bool also) {
  for (int k = 0; k < vs_kinds_count_pins(kind); k++)
    if (begins(pin, kind->pins[k].words) || (also && begins(pin, kind->pins[k].also))) return k;
  return -1;
}

/* True where each pin is another node by its name. */
static bool map_by_names(const subcircuit *s, const vs_kind *kind, bool also, int node[VS_PINS]) {
  bool named = true;
  for (size_t k = 0; k < s->pins; k++) {
    node[k] = node_of(kind, s->pin[k], also);
    named = named && node[k] >= 0;
    for (size_t other = 0; other < k; other++) named = named && node[other] != node[k];
  }
  return named;
}

/* The gate, by its name or as no emitter is at it, and main terminal 1, on which it stands. */
static bool map_by_junctions(const search *f, const vs_kind *kind, int node[VS_PINS]) {
  const vs_cards *c = &f->cards;
  vs_cards_latch latch = {.near = -1};
  int gate = -1;
  for (int k = 0; k < VS_PINS; k++)
    if (node_of(kind, f->best.pin[k], false) == vs_kinds_pin(kind, VS_PIN_GATE)) gate = k;
  for (size_t k = 1; k < c->n_scopes; k++)
    if (vs_words_is(c->scope[k].name, f->best.name)) latch = vs_cards_see_latch(c, k, gate);
  for (int k = 0; k < VS_PINS && latch.near >= 0; k++)
    node[k] = vs_kinds_pin(kind, k == latch.gate   ? VS_PIN_GATE
                                 : k == latch.near ? VS_PIN_TO
                                                   : VS_PIN_FROM);
  return latch.near >= 0;
}

/* By letters, as "2g1": those of the kind, each once. */
static bool map_by_letters(const char *letters, const vs_kind *kind, int node[VS_PINS]) {
  size_t n = strlen(letters);
  for (size_t k = 0; k < n; k++) {
    const char *at =
        kind->letters ? strchr(kind->letters, tolower((unsigned char)letters[k])) : NULL;
    if (!at || strchr(letters + k + 1, letters[k])) return false;
    node[k] = (int)(at - kind->letters);
  }
  return kind->letters && n == strlen(kind->letters);
}

/* Which pin is which node, and how that is known. Without another way the gate is in the middle, as
 * most vendors have it, and two that are alike have the order they have. Of what conducts both ways
 * nothing is assumed: swapped, it would fire, but not as it does. */
static const char *map_nodes(const search *f, const vs_kind *kind, const char *letters,
                             int node[VS_PINS], vs_error *err) {
  static const int USUAL[VS_PINS] = {VS_PIN_FROM, VS_PIN_GATE, VS_PIN_TO};
  const subcircuit *s = &f->best;
  if (letters && map_by_letters(letters, kind, node)) return ", as --pins says.";
  if (letters) {
    vs_fail(err, VS_INPUT, "--pins %s: the letters %s are wanted, in the order of the pins of %s",
            letters, kind->letters ? kind->letters : "of a kind that has such", s->name);
    return NULL;
  }
  bool alike = !kind->pins[0].text;
  if (!alike && map_by_names(s, kind, !kind->both_ways, node)) return ", by their names.";
  if (kind->both_ways && map_by_junctions(f, kind, node))
    return ", by the junctions that they stand on.";
  if (kind->both_ways && map_by_names(s, kind, true, node)) return ", by their names.";
  if (kind->both_ways) {
    vs_fail(
        err, VS_INPUT,
        "%s: neither names nor junctions tell which of its pins %s, %s and %s are main terminal "
        "2, main terminal 1 and the gate; --pins %s with the letters in the order of the pins "
        "says it",
        s->name, s->pin[0], s->pin[1], s->pin[2], kind->letters);
    return NULL;
  }
  for (int k = 0, to = 0; k < VS_PINS; k++)
    if (vs_kinds_pin(kind, USUAL[k]) >= 0) node[to++] = vs_kinds_pin(kind, USUAL[k]);
  return alike ? "." : ": assumed, as the names do not say; look at the vendor's text.";
}

/* Writes the call and the sentence on the pins. */
static vs_status map_pins(const search *f, const vs_kind *kind, const char *letters, vs_wrap *w,
                          vs_error *err) {
  const subcircuit *s = &f->best;
  int node[VS_PINS] = {-1, -1, -1};
  size_t n = 0, call = 0;
  const char *how = map_nodes(f, kind, letters, node, err);
  if (!how) return VS_INPUT;
  n += (size_t)snprintf(w->pins, sizeof w->pins, "Pins of %s: ", s->name);
  for (size_t k = 0; k < s->pins && n < sizeof w->pins; k++) {
    const char *what = kind->pins[node[k]].text;
    call +=
        (size_t)snprintf(w->call + call, sizeof w->call - call, "%s ", kind->pins[node[k]].node);
    n += (size_t)snprintf(w->pins + n, sizeof w->pins - n, "%s%s is %s%s%s%s", k ? ", " : "",
                          s->pin[k], kind->pins[node[k]].node, what ? " (" : "", what ? what : "",
                          what ? ")" : "");
  }
  snprintf(w->call + call, sizeof w->call - call, "%s", s->name);
  if (n < sizeof w->pins) snprintf(w->pins + n, sizeof w->pins - n, "%s", how);
  return VS_OK;
}

/* ---- all ---- */

/* The name that finds the vendor's file from where the part's file will be: its own name in the
 * same folder, else its whole path. */
static void name_file(const char *path, const char *output, vs_wrap *w) {
  char *whole = realpath(path, NULL), *one = vs_copy(whole ? whole : path),
       *other = vs_copy(output), *theirs = realpath(dirname(one), NULL),
       *ours = realpath(dirname(other), NULL);
  bool same = theirs && ours && !strcmp(theirs, ours);
  const char *slash = strrchr(path, '/');
  snprintf(w->file, sizeof w->file, "\"%s\"",
           same && slash ? slash + 1
           : same        ? path
           : whole       ? whole
                         : path);
  free(whole);
  free(one);
  free(other);
  free(theirs);
  free(ours);
}

static vs_status refuse_vendor_file(const search *f, const char *path, vs_error *err) {
  const vs_where file = {.file = path};
  if (f->wanted && !f->fitting) return vs_fail_at(err, file, "has no subcircuit '%s'", f->wanted);
  if (!f->fitting)
    return vs_fail_at(err, file, "none of its %zu subcircuits has %zu pins", f->all, f->pins);
  if (f->best.pins != f->pins)
    return vs_fail_at(err, file, "the subcircuit %s has %zu pins, and %zu are wanted", f->best.name,
                      f->best.pins, f->pins);
  return vs_fail_at(err, file, "has %zu subcircuits of %zu pins; say which: --wrap FILE:NAME of %s",
                    f->fitting, f->pins, f->names.text);
}

vs_status vs_wrap_find(const char *word, const char *kind, const char *pins, const char *output,
                       vs_wrap *w, vs_error *err) {
  char path[VS_PATH_SIZE];
  const char *colon = strrchr(word, ':');
  bool split = colon && access(word, R_OK);
  snprintf(path, sizeof path, "%.*s", split ? (int)(colon - word) : (int)strlen(word), word);
  const vs_kind *known = vs_kinds_find(kind);
  search f = {.wanted = split ? colon + 1 : NULL, .pins = (size_t)vs_kinds_count_pins(known)};
  vs_status status = take_file(&f, path, err);
  bool good = !status && f.fitting == 1 && f.best.pins == f.pins;
  if (!good && !status) status = refuse_vendor_file(&f, path, err);
  if (good) {
    *w = (vs_wrap){.pspice = f.pspice};
    memcpy(w->called, f.best.name, sizeof w->called);
    status = map_pins(&f, known, pins, w, err);
    name_file(path, output, w);
  }
  vs_text_free(&f.names);
  vs_cards_free(&f.cards);
  for (size_t k = 0; k < f.n_lines; k++) vs_line_free(&f.lines[k]);
  free(f.lines);
  return status;
}
