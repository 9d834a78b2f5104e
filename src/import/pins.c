/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pins.h"

#include <ctype.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/cursor.h"
#include "netlist/cards.h"
#include "netlist/catalogue.h"
#include "netlist/kinds.h"
#include "netlist/netlist.h"

/* Kinds of ngspice's own elements, by their letter, that the table of kinds does not measure. */
static const struct letter {
  char letter;
  const char *kind;
  int from, to, gate;
} LETTERS[] = {{'q', "transistor", 0, 2, 1},
               {'j', "transistor", 0, 2, 1},
               {'s', "switch", 0, 1, -1},
               {'w', "switch", 0, 1, -1}};

/* Words for a diac, and those that makers' numbers begin with (DB3, HT32). It is no diode, whatever
 * its pins are called. */
static const char DIAC[] = " diac sidac ", DIAC_NUMBERS[] = " db smdb ht ";

const char *const vs_pins_said = "as --pins says";

static bool among(const char *list, const char *word, size_t n) {
  char spaced[VS_ELEMENTS_NAME + 2];
  snprintf(spaced, sizeof spaced, " %.*s ", (int)n, word);
  vs_cursor_lower(spaced);
  return n > 0 && n < VS_ELEMENTS_NAME && list && strstr(list, spaced);
}

/* ---- kinds ---- */

/* True where a kind can be told from the names of its pins. Other kinds have two equal pins; words
 * in a subcircuit's name or comment may tell them. */
static bool is_told_by_pins(const vs_kind *kind) {
  return kind->letters;
}

static bool is_told_by_name(const vs_kind *kind) {
  return kind->called && !is_told_by_pins(kind);
}

/* The n-th kind that can be told from its pins, from 0; NULL: there are no more. Kinds with more
 * pins come first, so that a MOSFET with the pins of its diode is not taken for a diode. */
static const vs_kind *kind_by_pins(size_t n) {
  for (int pins = VS_PINS; pins > 1; pins--)
    for (const vs_kind *kind = vs_kinds_all; kind->name; kind++)
      if (is_told_by_pins(kind) && vs_kinds_count_pins(kind) == pins && n-- == 0) return kind;
  return NULL;
}

static void take_kind(const vs_kind *kind, vs_pins *pins) {
  pins->kind = kind->name;
  pins->from = vs_kinds_pin(kind, VS_PIN_FROM);
  pins->to = vs_kinds_pin(kind, VS_PIN_TO);
  pins->gate = vs_kinds_pin(kind, VS_PIN_GATE);
}

/* ---- words of pins ---- */

enum { MOST_PINS = 32 };

/* Finds up to MOST_PINS words in a line from `s` on: runs of letters and digits. `assigned`: stops
 * at the first NAME=. */
static int words_of(const char *s, bool assigned, const char *words[MOST_PINS],
                    size_t sizes[MOST_PINS]) {
  int count = 0;
  while (*s && count < MOST_PINS) {
    while (*s && !isalnum((unsigned char)*s)) s++;
    size_t n = 0;
    while (isalnum((unsigned char)s[n])) n++;
    bool ends = s[n + strspn(s + n, " \t")] == '=' || !strncasecmp(s, "params:", 7);
    if (n == 0 || (assigned && ends)) break;
    words[count] = s;
    sizes[count++] = n;
    s += n;
  }
  return count;
}

/* True for a word that may stand between the names of pins: a number, "and". */
static bool is_filler(const char *word, size_t n) {
  return strspn(word, "0123456789") >= n || among(" and pin pins to is ", word, n);
}

/* Finds each pin of a kind once among the words from `start` on. `in_place`: each word stands for a
 * pin, so its index is the pin's. Otherwise the pins follow one another, with fillers between them.
 */
static bool run_of(const vs_kind *kind, const char *const *words, const size_t *sizes, int count,
                   bool in_place, int at[VS_PINS]) {
  int seen = 0, wanted = vs_kinds_count_pins(kind);
  at[VS_PIN_FROM] = at[VS_PIN_TO] = at[VS_PIN_GATE] = -1;
  for (int n = 0; n < count && seen < wanted; n++) {
    int which = 0;
    while (which < wanted && !among(kind->pins[which].words, words[n], sizes[n])) which++;
    if (which < wanted && at[kind->pins[which].role] >= 0) return false;
    if (which < wanted)
      at[kind->pins[which].role] = in_place ? n : seen, seen++;
    else if (!in_place && !is_filler(words[n], sizes[n]))
      return false;
  }
  return seen == wanted;
}

/* Finds the kind whose pins these words are, in the same way. */
static bool kind_of(const char *const *words, const size_t *sizes, int count, bool in_place,
                    vs_pins *pins) {
  const vs_kind *kind;
  for (size_t k = 0; (kind = kind_by_pins(k)); k++)
    for (int start = 0; start < (in_place ? 1 : count); start++) {
      int at[VS_PINS];
      if (!run_of(kind, words + start, sizes + start, count - start, in_place, at)) continue;
      pins->kind = kind->name;
      pins->from = at[VS_PIN_FROM];
      pins->to = at[VS_PIN_TO];
      pins->gate = at[VS_PIN_GATE];
      return true;
    }
  return false;
}

/* ---- a subcircuit of the netlist ---- */

/* True where this comment may explain the .subckt line: it stands right before it or inside the
 * subcircuit, at most NEAR cards away. */
static bool explains(const vs_listing *l, size_t comment, size_t subckt) {
  enum { NEAR = 12 };
  const vs_card *card = &l->cards[comment];
  if (card->kind != VS_CARD_COMMENT || card->where.file != l->cards[subckt].where.file)
    return false;
  if (comment > subckt) return comment - subckt <= NEAR && card->depth > 0;
  if (subckt - comment > NEAR) return false;
  for (size_t k = comment; k < subckt; k++)
    if (l->cards[k].kind != VS_CARD_COMMENT) return false;
  return true;
}

/* True where a word of the text is one of the hints. */
static bool hints_at(const char *text, const char *hints) {
  for (const char *s = text; *s;) {
    size_t n = 0;
    while (isalpha((unsigned char)s[n])) n++;
    if (among(hints, s, n)) return true;
    s += n ? n : 1;
  }
  return false;
}

static bool subcircuit_hints(const vs_listing *l, size_t subckt, const char *name,
                             const char *hints) {
  bool hinted = hints_at(name, hints);
  for (size_t k = subckt < 12 ? 0 : subckt - 12; k < l->count && k < subckt + 12 && !hinted; k++)
    hinted = explains(l, k, subckt) && hints_at(l->cards[k].text, hints);
  return hinted;
}

/* Finds the pins by the names in the .subckt line, else by a comment that names all of them. */
static bool pins_of(const vs_listing *l, size_t subckt, int n_nodes, vs_pins *pins) {
  const char *words[MOST_PINS];
  size_t sizes[MOST_PINS];
  const char *s = l->cards[subckt].text;
  for (int k = 0; k < 2; k++) {
    s += strcspn(s, " \t");
    s += strspn(s, " \t");
  }
  int count = words_of(s, true, words, sizes);
  bool digits = count > 0 && isdigit((unsigned char)*words[0]);
  pins->by = "by the names of its subcircuit's pins";
  if (!digits && kind_of(words, sizes, count < n_nodes ? count : n_nodes, true, pins)) return true;
  pins->by = "by the comment of its subcircuit, which names its pins in their order";
  for (size_t k = subckt < 12 ? 0 : subckt - 12; k < l->count && k < subckt + 12; k++) {
    if (!explains(l, k, subckt)) continue;
    count = words_of(l->cards[k].text, false, words, sizes);
    bool is = kind_of(words, sizes, count, false, pins);
    int seen = pins->gate >= 0 ? 3 : 2;
    if (is && seen == n_nodes) return true;
    *pins = (vs_pins){.gate = -1, .by = pins->by};
  }
  return false;
}

static vs_status ask(const vs_elements *w, const vs_element *e, const vs_kind *kind,
                     const char *model, vs_error *err) {
  return vs_fail_at(err, vs_elements_where(w, e, 0),
                    "%s (%s) looks like a %s, and nothing says which of its pins is what: --pins "
                    "%s=%s, the letters in the order of its nodes; --pins %s=none measures nothing "
                    "of it",
                    e->name, model, kind->name, e->name, kind->letters, e->name);
}

/* ---- a triac ---- */

/* What the subcircuit is by what is within it, of which `gate` is known to be the gate (-1: not);
 * whether it calls a subcircuit whose name hints at the kind. */
static vs_cards_latch look_within(const vs_listing *l, const char *model, int gate,
                                  const char *hints, bool *hinted) {
  vs_cards c;
  vs_cards_latch latch = {.gate = -1, .near = -1};
  vs_line *lines = vs_alloc(l->count + 1, sizeof *lines);
  size_t n = 0;
  for (size_t k = 0; k < l->count; k++)
    if (l->cards[k].kind != VS_CARD_COMMENT)
      vs_line_join(&lines[n++], l->cards[k].text, l->cards[k].where);
  vs_cards_read(&c, lines, n);
  for (size_t k = c.n_scopes; k-- > 1;) { /* of several the first counts */
    if (!vs_words_is(c.scope[k].name, model)) continue;
    latch = vs_cards_see_latch(&c, k, gate);
    *hinted = false;
    for (size_t m = c.scope[k].first; m < c.scope[k].last; m++) {
      char *called = vs_alloc_part(c.card[m].model.at, c.card[m].model.n);
      *hinted = *hinted || (c.card[m].letter == 'x' && hints_at(called, hints));
      free(called);
    }
  }
  vs_cards_free(&c);
  while (n > 0) vs_line_free(&lines[--n]);
  free(lines);
  return latch;
}

/* True for a triac: by its name, or as it conducts both ways. Its pins are then told by their
 * names, by the junctions that they stand on, or as A, K and G are. `pins`: what the names say; its
 * kind stays NULL where none of these tells. */
static bool find_triac(const vs_listing *l, size_t subckt, const char *model, vs_pins *pins) {
  const vs_kind *triac = vs_kinds_find("triac");
  bool by_names = pins->kind, hinted = false;
  if (by_names && !strcmp(pins->kind, triac->name)) return true;
  if (by_names && strcmp(pins->kind, "thyristor")) return false;
  vs_cards_latch latch = look_within(l, model, by_names ? pins->gate : -1, triac->called, &hinted);
  /* BT131 to BT139 are triacs; BT151, as an instance, is a thyristor. */
  if (!latch.two_ways && !hinted && strncasecmp(model, "bt13", 4) &&
      !subcircuit_hints(l, subckt, model, triac->called))
    return false;
  pins->kind = NULL;
  if (latch.near >= 0) {
    *pins = (vs_pins){.kind = triac->name,
                      .from = 3 - latch.gate - latch.near,
                      .to = latch.near,
                      .gate = latch.gate,
                      .by = "by the junctions that its subcircuit's pins stand on"};
  } else if (by_names)
    pins->kind = triac->name; /* A is main terminal 2, K is 1 */
  return true;
}

static vs_status find_in_netlist(const vs_elements *w, const vs_element *e, const char *model,
                                 size_t subckt, vs_pins *pins, vs_error *err) {
  const vs_listing *l = w->listing;
  for (const vs_kind *kind = vs_kinds_all; kind->name && e->n_nodes == 2; kind++)
    if (is_told_by_name(kind) && subcircuit_hints(l, subckt, model, kind->called)) {
      pins->by = "by its name";
      take_kind(kind, pins);
      return VS_OK;
    }
  if (e->n_nodes == 2 &&
      (subcircuit_hints(l, subckt, model, DIAC) || hints_at(model, DIAC_NUMBERS))) {
    *pins = (vs_pins){.kind = "diac", .from = 0, .to = 1, .gate = -1, .by = "by its name"};
    return VS_OK;
  }
  bool told = pins_of(l, subckt, e->n_nodes, pins);
  if (e->n_nodes == 3 && find_triac(l, subckt, model, pins))
    return pins->kind ? VS_OK : ask(w, e, vs_kinds_find("triac"), model, err);
  if (told) return VS_OK;
  for (const vs_kind *kind = vs_kinds_all; kind->name && e->n_nodes == 3; kind++)
    if (kind->called && vs_kinds_count_pins(kind) == 3 &&
        subcircuit_hints(l, subckt, model, kind->called))
      return ask(w, e, kind, model, err);
  return VS_OK;
}

/* ---- a part ---- */

typedef struct search {
  const char *name;
  char path[VS_PATH_SIZE], found[VS_ELEMENTS_NAME];
} search;

static void look(void *ctx, const char *path) {
  search *s = ctx;
  size_t n;
  const char *base = vs_catalogue_name(path, &n);
  if (*s->found || strlen(s->name) != n || strncasecmp(base, s->name, n)) return;
  snprintf(s->path, sizeof s->path, "%.*s", (int)sizeof s->path - 1, path);
  snprintf(s->found, sizeof s->found, "%.*s", (int)n, base);
}

/* Looks for a part's file of that name in the netlist's folder, ignoring case. */
static void look_beside(const vs_elements *w, search *s) {
  const char *own = w->listing->files[0], *slash = strrchr(own, '/');
  char folder[VS_PATH_SIZE], path[VS_PATH_SIZE + 256];
  const char *ending = vs_deck_parts_shelf.ending;
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - own + 1) : 0, own);
  DIR *dir = opendir(*folder ? folder : ".");
  for (struct dirent *entry; dir && (entry = readdir(dir));) {
    const char *last = strrchr(entry->d_name, '.');
    if (!last || strcmp(last, ending)) continue;
    snprintf(path, sizeof path, "%s%s", folder, entry->d_name);
    look(s, path);
  }
  if (dir) closedir(dir);
}

/* The kind of the part in a file; NULL: none that is known here. */
static const vs_kind *kind_of_part(const char *path) {
  vs_deck *part = vs_alloc(1, sizeof *part);
  vs_error unread = {0};
  const vs_kind *kind = NULL;
  if (!vs_netlist_read_part(path, part, &unread) && part->n_part_files)
    kind = vs_kinds_find(part->part_files[0].kind);
  vs_deck_free(part);
  free(part);
  return kind && (is_told_by_pins(kind) || is_told_by_name(kind)) ? kind : NULL;
}

/* A subcircuit that the netlist does not define may be a part: one in a file beside the netlist, or
 * one that ships. */
static void find_part(const vs_elements *w, const char *model, const vs_element *e, vs_pins *pins) {
  const vs_kind *kind = NULL;
  search s = {.name = model};
  pins->by = "a part beside the netlist";
  look_beside(w, &s);
  if (*s.found) kind = kind_of_part(s.path);
  if (!kind) {
    s = (search){.name = model};
    pins->by = "a shipped part";
    vs_catalogue_list(&vs_deck_parts_shelf, look, &s);
    if (*s.found) kind = kind_of_part(s.path);
  }
  if (!kind || e->n_nodes != vs_kinds_count_pins(kind)) return;
  take_kind(kind, pins);
  snprintf(pins->part, sizeof pins->part, "%s", s.found);
}

/* ---- what the user says ---- */

/* The WORD of this element's NAME=WORD; NULL: there is none. free() it. */
static char *said_of(const vs_elements *w, const char *asked, const vs_element *e) {
  char *all = vs_copy(asked ? asked : ""), *rest = all, *found = NULL;
  for (char *entry; (entry = strsep(&rest, ","));) {
    char *equal = strchr(entry, '=');
    if (!equal || found) continue;
    *equal = '\0';
    if (vs_elements_find(w, entry) == e) found = vs_copy(equal + 1);
  }
  free(all);
  return found;
}

/* Reads "akg" or a kind's word; false: it is neither. */
static bool read_said(const char *said, vs_pins *pins) {
  const char *words[MOST_PINS];
  size_t sizes[MOST_PINS];
  int count = (int)strlen(said);
  *pins = (vs_pins){.gate = -1, .by = vs_pins_said};
  if (!strcmp(said, "none")) return true;
  const vs_kind *kind = vs_kinds_find(said);
  if (kind && is_told_by_name(kind)) {
    take_kind(kind, pins);
    return true;
  }
  for (int k = 0; k < count && count <= MOST_PINS; k++) {
    bool main = said[k] == '1' || said[k] == '2'; /* terminal of a triac */
    words[k] = main ? said[k] == '1' ? "t1" : "t2" : said + k;
    sizes[k] = main ? 2 : 1;
  }
  return count <= MOST_PINS && kind_of(words, sizes, count, true, pins);
}

static vs_status refuse_said(const char *entry, const char *word, vs_error *err) {
  vs_text pins = {0}, names = {0};
  const vs_kind *kind;
  for (size_t k = 0; (kind = kind_by_pins(k)); k++)
    vs_text_add(&pins, "%s%s %s", k ? ", " : "", kind->letters, kind->name);
  for (kind = vs_kinds_all; kind->name; kind++)
    if (is_told_by_name(kind)) vs_text_add(&names, "%s%s", names.length ? ", " : "", kind->name);
  vs_status status = vs_fail(
      err, VS_INPUT,
      "--pins %s%s%s: wants NAME=LETTERS, the letters of its pins in the order of its nodes "
      "(%s), or NAME=%s or none",
      entry, word ? "=" : "", word ? word : "", pins.text, names.text);
  vs_text_free(&pins);
  vs_text_free(&names);
  return status;
}

vs_status vs_pins_check(const vs_elements *w, const char *asked, vs_error *err) {
  char *all = vs_copy(asked ? asked : ""), *rest = all;
  vs_status status = VS_OK;
  for (char *entry; !status && asked && (entry = strsep(&rest, ","));) {
    char *equal = strchr(entry, '=');
    vs_pins pins;
    if (equal) *equal = '\0';
    if (!equal || !read_said(equal + 1, &pins))
      status = refuse_said(entry, equal ? equal + 1 : NULL, err);
    else if (!vs_elements_find(w, entry))
      status = vs_fail(err, VS_INPUT, "--pins %s: there is no such element outside of subcircuits",
                       entry);
  }
  free(all);
  return status;
}

/* ---- a source that is a varistor ---- */

/* True for a current source that is controlled by a power of its own voltage alone: the law of a
 * varistor. */
static bool is_power_law(const vs_elements *w, const vs_element *e) {
  static const char *const POWERS[] = {"pwr(", "pwrs(", "pow(", "**", "^", "sinh("};
  char *law = vs_elements_rest_of(w, e, e->n_nodes + 1), own[2][2 * VS_ELEMENTS_NAME + 8];
  bool power = false, other = false, current = tolower((unsigned char)*law) == 'i';
  const char *a = w->nodes[e->nodes[0]].said, *b = w->nodes[e->nodes[1]].said;
  vs_cursor_lower(law);
  snprintf(own[0], sizeof own[0], "v(%s,%s)", a, b);
  snprintf(own[1], sizeof own[1], "v(%s)", strcmp(w->nodes[e->nodes[1]].name, "0") ? "?" : a);
  for (size_t k = 0; k < sizeof POWERS / sizeof *POWERS; k++)
    power = power || strstr(law, POWERS[k]);
  for (const char *s = law; (s = strstr(s, "v(")); s++)
    other = other || (strncmp(s, own[0], strlen(own[0])) && strncmp(s, own[1], strlen(own[1])));
  bool uses = strstr(law, own[0]) || strstr(law, own[1]);
  free(law);
  return current && power && uses && !other;
}

vs_status vs_pins_find(const vs_elements *w, const char *asked, const vs_element *e, vs_pins *pins,
                       vs_error *err) {
  *pins = (vs_pins){.gate = -1, .by = "by its letter"};
  char *said = said_of(w, asked, e), *model = vs_elements_model(w, e);
  int subckt = model ? vs_elements_defined(w->listing, model) : -1;
  vs_status status = VS_OK;
  if (e->letter == 'x' && subckt < 0 && model) find_part(w, model, e, pins);
  vs_pins part = *pins;
  if (said && read_said(said, pins))
    memcpy(pins->part, part.part, sizeof pins->part);
  else if (e->letter == 'x' && subckt >= 0)
    status = find_in_netlist(w, e, model, (size_t)subckt, pins, err);
  else if (e->letter == 'b' && is_power_law(w, e))
    take_kind(vs_kinds_find("varistor"), pins), pins->by = "by its law";
  for (const vs_kind *kind = vs_kinds_all; kind->name && !said; kind++)
    if (kind->letter == e->letter) take_kind(kind, pins);
  for (size_t k = 0; k < sizeof LETTERS / sizeof *LETTERS && !said; k++)
    if (LETTERS[k].letter == e->letter)
      *pins = (vs_pins){.kind = LETTERS[k].kind,
                        .from = LETTERS[k].from,
                        .to = LETTERS[k].to,
                        .gate = LETTERS[k].gate,
                        .by = pins->by};
  free(said);
  free(model);
  int most = pins->from > pins->to ? pins->from : pins->to;
  if (pins->kind && (most >= e->n_nodes || pins->gate >= e->n_nodes)) pins->kind = NULL;
  return status;
}
