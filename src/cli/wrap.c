/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "wrap.h"

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
  vs_line *lines = vs_alloc(source.count + 1, sizeof *lines);
  size_t count = 0;
  for (size_t k = 0; k < source.count && !status; k++) {
    char *text = source.line[k] + strspn(source.line[k], " \t");
    text[strcspn(text, ";")] = '\0';
    if (!*text || *text == '*') continue;
    count += *text != '+' || !count;
    vs_line_join(&lines[count - 1], text + (*text == '+'), (vs_where){path, (int)k + 1, 1});
  }
  for (size_t k = 0; k < count; k++) vs_words_unbrace(lines[k].text);
  vs_cards cards;
  vs_cards_read(&cards, lines, count);
  for (size_t k = 0; k < count; k++) {
    f->pspice = f->pspice || is_of_pspice(lines[k].text);
    if (cards.card[k].kind == VS_CARDS_SUBCKT) take_subcircuit(f, &cards, &cards.card[k]);
  }
  vs_cards_free(&cards);
  for (size_t k = 0; k < count; k++) vs_line_free(&lines[k]);
  free(lines);
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

/* The node that a pin of this name is; -1: its name does not say. */
static int node_of(const vs_kind *kind, const char *pin) {
  for (int k = 0; k < vs_kinds_count_pins(kind); k++)
    if (begins(pin, kind->pins[k].words) || begins(pin, kind->pins[k].also)) return k;
  return -1;
}

/* Pins by their names, or else with the gate in the middle, as most vendors have it; of two that
 * are alike in the order they have. */
static void map_pins(const subcircuit *s, const vs_kind *kind, vs_wrap *w) {
  static const int USUAL[VS_PINS] = {VS_PIN_FROM, VS_PIN_GATE, VS_PIN_TO};
  int node[VS_PINS] = {-1, -1, -1};
  size_t n = 0, call = 0;
  bool alike = !kind->pins[0].text, named = !alike;
  for (size_t k = 0; k < s->pins; k++) {
    node[k] = node_of(kind, s->pin[k]);
    named = named && node[k] >= 0;
    for (size_t other = 0; other < k; other++) named = named && node[other] != node[k];
  }
  for (int k = 0, to = 0; k < VS_PINS && !named; k++)
    if (vs_kinds_pin(kind, USUAL[k]) >= 0) node[to++] = vs_kinds_pin(kind, USUAL[k]);
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
  if (n < sizeof w->pins)
    snprintf(w->pins + n, sizeof w->pins - n, "%s",
             alike   ? "."
             : named ? ", by their names."
                     : ": assumed, as the names do not say; look at the vendor's text.");
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

vs_status vs_wrap_find(const char *word, const char *kind, const char *output, vs_wrap *w,
                       vs_error *err) {
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
    map_pins(&f.best, known, w);
    name_file(path, output, w);
  }
  vs_text_free(&f.names);
  return status;
}
