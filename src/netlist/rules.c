/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rules.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/cards.h"
#include "netlist/reserved.h"
#include "netlist/words.h"

/* The word, in lower case and cut to fit. */
static const char *copy_of(vs_word word, char copy[VS_DECK_NAME]) {
  snprintf(copy, VS_DECK_NAME, "%.*s", (int)word.n, word.at);
  vs_cursor_lower(copy);
  return copy;
}

/* True where a line knows the time by itself: a source with a course, or an expression of the time.
 */
static bool knows_time(const char *line) {
  static const char *const COURSES[] = {"pulse", "sin",     "exp",      "pwl", "sffm",
                                        "am",    "trnoise", "trrandom", "pat"};
  static const char *const CLOCKS[] = {"time", "hertz"};
  bool source = strchr("vViI", *line) && *line;
  for (const char *s = line; *s;) {
    size_t n = 0;
    while (vs_words_goes_on(s[n])) n++;
    const vs_word word = {s, n};
    if (VS_WORDS_AMONG(word, CLOCKS)) return true;
    if (source && s > line && VS_WORDS_AMONG(word, COURSES)) return true;
    s += n ? n : 1;
  }
  return false;
}

/* ---- chance ---- */

/* Finds the whole word in a text; with `call`, only where '(' follows it. NULL: it is not there. */
static const char *find_whole(const char *text, const char *word, bool call) {
  size_t n = strlen(word);
  if (call && !strchr(text, '(')) return NULL;
  for (const char *s = text; (s = strcasestr(s, word)); s++) { /* most lines have none of them */
    const bool within = s > text && (vs_words_goes_on(s[-1]) || strchr(".#", s[-1]));
    if (within || vs_words_goes_on(s[n])) continue;
    if (!call || s[n + strspn(s + n, " \t")] == '(') return s;
  }
  return NULL;
}

/* True for LIMIT(x, least, most) of PSpice's dialect, which cuts off and draws nothing: ngspice 39
 * has a .func of that name there, which it finds where '(' comes right behind it. */
static bool cuts_off(const char *call) {
  int depth = 0, commas = 0;
  if (call[strlen("limit")] != '(') return false;
  for (const char *s = strchr(call, '('); s && *s; s++) {
    depth += (*s == '(') - (*s == ')');
    commas += depth == 1 && *s == ',';
    if (depth == 0) break;
  }
  return commas == 2;
}

/* Finds the first word of chance in a line; NULL: there is none. In "V1 a b trnoise ..." the words
 * of a source's course stand behind its nodes; in ".model NAME limit(...)" the type, which is no
 * word of chance, stands behind the name. */
static const char *find_random(const char *line, bool pspice, const char **word) {
  static const char *const DRAWN[] = {"gauss", "agauss", "unif", "aunif", "limit"};
  static const char *const NOISES[] = {"trnoise", "trrandom"};
  bool model = !strncasecmp(line, ".model", 6), source = *line && strchr("vViI", *line);
  const char *from = line, *first = NULL;
  for (int n = 0; n < (model ? 2 : source ? 3 : 0); n++) {
    from += strcspn(from, " \t");
    from += strspn(from, " \t");
  }
  for (size_t k = 0; k < sizeof DRAWN / sizeof *DRAWN; k++) {
    const char *s = find_whole(model ? from + strcspn(from, " \t(") : line, DRAWN[k], true);
    while (s && pspice && *DRAWN[k] == 'l' && cuts_off(s)) s = find_whole(s + 1, DRAWN[k], true);
    if (s && (!first || s < first)) first = s, *word = DRAWN[k];
  }
  for (size_t k = 0; source && k < sizeof NOISES / sizeof *NOISES; k++) {
    const char *s = find_whole(from, NOISES[k], false);
    if (s && (!first || s < first)) first = s, *word = NOISES[k];
  }
  return first;
}

vs_status vs_rules_random(const vs_line *line, bool pspice, vs_error *err) {
  const char *word = NULL, *call = find_random(line->text, pspice, &word);
  if (!call) return VS_OK;
  const vs_where where = vs_line_place(line, call);
  bool noise = !strncmp(word, "tr", 2);
  if (pspice && !strcmp(word, "limit"))
    return vs_fail_at(
        err, where,
        "limit: in PSpice's dialect ngspice knows LIMIT(x, least, most), of three and "
        "with no blank before '('");
  if (!strcmp(word, "limit") && cuts_off(call))
    return vs_fail_at(err, where,
                      "limit: LIMIT(x, least, most), of three, is PSpice's; with a line '*$ compat "
                      "ps' the deck is read in that dialect. ngspice's own, of two, is random");
  return vs_fail_at(err, where,
                    noise ? "%s is random anew in each run; a course that is the same each time "
                            "would be right, or a study over a parameter"
                          : "%s(...) is random anew in each run of ngspice's; a number would be "
                            "right, or a '*$ param' that a study varies",
                    word);
}

/* ---- names ---- */

/* Refuses a name that the netlist may have in the place of one of ngspice's own; at the top of a
 * deck also one that is the program's or a '*$ param's. Within a subcircuit a name is the
 * subcircuit's own. */
static vs_status check_parameter(const vs_deck *deck, const char *name, bool top, vs_where where,
                                 vs_error *err) {
  if (vs_reserved_is_ours(name))
    return vs_fail_at(err, where,
                      "parameter %s: the program makes such names; give yours another name", name);
  if (top && vs_deck_is_standard(name))
    return vs_fail_at(err, where, "parameter %s is the program's; give yours another name", name);
  for (size_t k = 1; k < deck->section.count && top; k++)
    if (!strcasecmp(deck->section.fields[k].key, name))
      return vs_fail_at(err, where, "parameter %s stands in a '*$ param' line already", name);
  return VS_OK;
}

/* Refuses names that a line gives values to: of parameters, and of a model's that are files. */
static vs_status check_names(const vs_deck *deck, const vs_cards *c, const vs_netlist_card *card,
                             bool top, vs_where where, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = card->first; k < card->first + card->count && !status; k++) {
    const vs_word word = c->arguments[k].name;
    char name[VS_DECK_NAME];
    snprintf(name, sizeof name, "%.*s", (int)word.n, word.at);
    if (card->kind != VS_CARDS_MODEL)
      status = word.n ? check_parameter(deck, name, top, where, err) : VS_OK;
    else if (word.n >= 4 && !strncasecmp(word.at + word.n - 4, "file", 4))
      status = vs_fail_at(err, where, "a model may not read or write a file (%s=)", name);
  }
  return status;
}

vs_status vs_rules_params(const vs_deck *deck, vs_error *err) {
  const vs_cards *c = vs_deck_cards(deck);
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->count && !status; k = vs_cards_next(c, k)) {
    char within[VS_PATH_SIZE];
    if (c->card[k].kind != VS_CARDS_PARAM || c->card[k].conditional) continue;
    const vs_where where = vs_deck_mendable(deck, deck->lines[k].where, within, sizeof within);
    status = vs_error_keep(err, check_names(deck, c, &c->card[k], true, where, err));
  }
  return status;
}

/* ---- statements ---- */

/* Model types that need nothing but their parameters. Left out are ngspice's numerical devices and
 * code models that read or write files, and code models that step back in time or act on events,
 * which libngspice handles wrongly (oneshot, square, triangle, digital ones). */
static vs_status model_rule(const vs_deck *deck, const vs_cards *one, vs_error *err) {
  static const char *const DEVICES[] = {
      "d",       "npn",     "pnp", "njf", "pjf",    "nmf",    "pmf",   "nmos", "pmos",
      "vdmos",   "r",       "res", "c",   "cap",    "l",      "ind",   "sw",   "csw",
      "vswitch", "iswitch", "urc", "txl", "vdmosn", "vdmosp", "nhfet", "phfet"};
  static const char *const CODE_MODELS[] = {
      "gain",   "summer",     "mult",    "divide",       "limit", "climit",
      "ilimit", "cntl_limit", "pwl",     "hyst",         "slew",  "s_xfer",
      "int",    "d_dt",       "lcouple", "core",         "delay", "multi_input_pwl",
      "zener",  "aswitch",    "pswitch", "potentiometer"};
  static const char *const LEVELS[] = {"1", "2", "3", "4", "6", "9"};
  const vs_netlist_card *card = one->card;
  const vs_where where = one->lines->where;
  char type[VS_DECK_NAME];
  copy_of(card->model, type);
  if (!strncmp(type, "ako:", 4)) /* "a kind of" another */
    copy_of(vs_cards_word(one, card, type[4] ? 1 : 2), type);
  const char *behind = vs_words_next(card->model.at);
  if (!*type || *behind == '=')
    return vs_fail_at(
        err, where,
        "a model has a name and a type: '.model NAME TYPE(PARAMETER=VALUE ...)'; here "
        "one of them is missing");
  if (!VS_WORDS_AMONG(vs_words_of(type), DEVICES) &&
      !VS_WORDS_AMONG(vs_words_of(type), CODE_MODELS))
    return vs_fail_at(err, where,
                      "model type '%s' does not belong in a deck: allowed are d, bipolar, field "
                      "effect and vdmos transistors, r, c, l, switches and analog code models "
                      "without files",
                      type);
  bool transistor = strchr("np", *type) && *type;
  const char *level = transistor ? strcasestr(one->lines->text, "level") : NULL;
  if (level) {
    char number[8];
    level += 5 + strspn(level + 5, " \t");
    if (*level == '=') level += 1 + strspn(level + 1, " \t");
    snprintf(number, sizeof number, "%.*s", (int)strcspn(level, " \t)"), level);
    bool mos = strstr(type, "mos");
    if (!VS_WORDS_AMONG(vs_words_of(number), LEVELS) || (mos && !strcmp(number, "4")))
      return vs_fail_at(err, where,
                        "model level '%s' does not belong in a deck: allowed are %s (others write "
                        "files); its maker may have one of these, or 'vibrospice part' a template",
                        number, mos ? "1, 2, 3, 6, 9" : "1, 2, 3, 4, 6, 9");
  }
  return check_names(deck, one, card, false, where, err);
}

/* Takes a line .title as the deck's title, unless it has one. */
static vs_status title(vs_deck *deck, const char *text, vs_where where, bool *skip) {
  *skip = true;
  text += strspn(text, " \t");
  if (*deck->title)
    vs_statements_skip(&deck->skipped, "'.title'", where);
  else
    snprintf(deck->title, sizeof deck->title, "%s", text);
  return VS_OK;
}

/* Refuses .ic I(L1)=0.1, LTspice's, of which ngspice says that its syntax is wrong, and not where.
 */
static vs_status initial_rule(const char *line, vs_where where, vs_error *err) {
  for (const char *s = line; *(s = vs_words_next(s));) {
    const char *open = s + 1 + strspn(s + 1, " \t");
    if (tolower((unsigned char)*s) != 'i' || *open != '(') continue;
    const char *name = open + 1 + strspn(open + 1, " \t");
    int n = (int)strcspn(name, " \t)=");
    return vs_fail_at(err, where,
                      "I(%.*s): .ic gives nodes their voltages, V(NODE)=...; a current begins at "
                      "its inductor, by IC=... in the line of %.*s",
                      n, name, n, name);
  }
  return VS_OK;
}

vs_status vs_rules_statement(vs_deck *deck, const vs_cards *one, bool *skip, vs_error *err) {
  static const char *const ALLOWED[] = {".param", ".model",  ".subckt", ".ends",
                                        ".func",  ".global", ".ic",     ".nodeset",
                                        ".if",    ".elseif", ".else",   ".endif"};
  const char *line = one->lines->text;
  const vs_where where = one->lines->where;
  vs_status judged = vs_statements_judge(line, where, &deck->skipped, skip, err);
  if (judged || *skip) return judged;
  deck->own_clock = deck->own_clock || knows_time(line);
  char word[VS_DECK_NAME];
  copy_of((vs_word){line, strcspn(line, " \t=(")}, word);
  if (!strcmp(word, ".title")) return title(deck, line + strlen(word), where, skip);
  /* ngspice takes any statement that begins with one of its own, so the whole word must be known */
  if (!VS_WORDS_AMONG(vs_words_of(word), ALLOWED))
    return vs_fail_at(err, where,
                      "%s does not belong in a deck: a circuit is made of .param, .model, .subckt, "
                      ".func, .global, .ic, .nodeset, .if and .include",
                      word);
  if (!strcmp(word, ".model")) return model_rule(deck, one, err);
  if (!strcmp(word, ".ic")) return initial_rule(line, where, err);
  if (!strcmp(word, ".param") || !strcmp(word, ".subckt")) {
    const bool top = one->card->kind == VS_CARDS_PARAM && deck->subcircuits == 0;
    vs_status status = check_names(deck, one, one->card, top, where, err);
    if (status) return status;
  }
  if (!strcmp(word, ".ends") && deck->subcircuits == 0 && !(deck->lost & VS_LOST_ELEMENT))
    return vs_fail_at(err, where, ".ends closes a .subckt, and none is open here");
  if (!strcmp(word, ".ends") && deck->subcircuits > 0) deck->subcircuits--;
  if (strcmp(word, ".subckt")) return VS_OK;
  if (deck->subcircuits++ == 0) deck->subcircuit = where;
  return !vs_words_is(one->card->name, "eva")
             ? VS_OK
             : vs_fail_at(err, where, "subcircuit eva is the program's; give yours another name");
}

/* ---- elements ---- */

/* Refuses "external" anywhere but as the fourth and last word; ngspice dies of some such lines. */
static vs_status source_rule(const vs_line *line, vs_error *err) {
  if (!strchr("vViI", *line->text)) return VS_OK;
  int n = 0; /* which word it is */
  for (const char *s = line->text, *next; *s; n++, s = next) {
    next = vs_words_next(s);
    if (vs_words_is(vs_words_at(s), "external") && (n > 3 || (n == 3 && *next)))
      return vs_fail_at(err, line->where,
                        "a source the program drives is 'NAME n m external' and no more");
  }
  return VS_OK;
}

/* Notes the EVA, "Xname n m eva" at the top of the deck, and refuses it anywhere else and
 * with both ends on one node. */
static vs_status eva_rule(vs_deck *deck, const vs_cards *one, vs_error *err) {
  const vs_netlist_card *card = one->card;
  const vs_where where = one->lines->where;
  if (card->letter != 'x' || !vs_words_is(card->model, "eva")) return VS_OK;
  if (*deck->eva) return vs_fail_at(err, where, "a second EVA; a deck has one line 'Xeva n m eva'");
  if (deck->subcircuits > 0)
    return vs_fail_at(err, where,
                      "the EVA is one line 'Xeva n m eva' at the top of the deck, in no "
                      "subcircuit, and the .subckt of %s:%d is not closed before it",
                      deck->subcircuit.file, deck->subcircuit.line);
  if (card->nodes != 2)
    return vs_fail_at(err, where, "the EVA is one line 'Xeva n m eva' at the top of the deck");
  copy_of(card->name, deck->eva);
  const vs_word plus = vs_cards_word(one, card, 0), minus = vs_cards_word(one, card, 1);
  copy_of(plus, deck->eva_plus);
  copy_of(minus, deck->eva_minus);
  return vs_words_compare(plus, minus) && !(vs_words_is_ground(plus) && vs_words_is_ground(minus))
             ? VS_OK
             : vs_fail_at(err, where,
                          "both ends of the EVA are on node %s, so that it has no current; two "
                          "nodes are wanted",
                          deck->eva_plus);
}

bool vs_rules_is_element(const char *line) {
  size_t n = 0;
  while (isalnum((unsigned char)line[n]) || (line[n] && strchr("_.#+-", line[n])) ||
         (unsigned char)line[n] >= 0x80) /* LTspice's blocks are X§X1 */
    n++;
  const char *second = line + n + strspn(line + n, " \t"), *third = second + strcspn(second, " \t");
  third += strspn(third, " \t");
  return isalpha((unsigned char)*line) && strchr(" \t", line[n]) && *second && *third;
}

vs_status vs_rules_element(vs_deck *deck, const vs_cards *one, vs_error *err) {
  const char *line = one->lines->text;
  if (!vs_rules_is_element(line))
    return vs_fail_at(
        err, one->lines->where,
        "an element is wanted here: 'NAME node node ...', or a statement, or a comment");
  deck->own_clock = deck->own_clock || knows_time(line);
  vs_status status = source_rule(one->lines, err);
  return status ? status : eva_rule(deck, one, err);
}
