/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rules.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "netlist/cards.h"
#include "netlist/reserved.h"
#include "netlist/source.h"
#include "netlist/words.h"

static bool is_rule_word(const char *word, const char *const *list, size_t count) {
  for (size_t k = 0; k < count; k++)
    if (!strcasecmp(word, list[k])) return true;
  return false;
}
#define AMONG(word, list) is_rule_word(word, list, sizeof(list) / sizeof *(list))

/* The same for the n characters at s. */
static bool begins_among(const char *s, size_t n, const char *const *list, size_t count) {
  for (size_t k = 0; k < count && n > 0; k++)
    if (!strncasecmp(s, list[k], n) && !list[k][n]) return true;
  return false;
}
#define BEGINS_AMONG(s, n, list) begins_among(s, n, list, sizeof(list) / sizeof *(list))

/* Gives the n-th word of a line, from 0, in lower case and cut to fit; empty where there is none.
 */
static const char *nth_word(const char *line, int n, char word[VS_DECK_NAME]) {
  const char *s = line + strspn(line, VS_WORDS_BETWEEN);
  for (; n > 0; n--) s = vs_words_next(s);
  snprintf(word, VS_DECK_NAME, "%.*s", (int)vs_words_at(s).n, s);
  vs_cursor_lower(word);
  return word;
}

/* Calls each(ctx, name) for what a line assigns: NAME = ..., not within braces or quotes. Ends with
 * the first status that is not VS_OK. */
static vs_status assignments(const char *line, vs_status (*each)(void *, const char *name),
                             void *ctx) {
  vs_status status = VS_OK;
  int depth = 0;
  bool quoted = false;
  for (const char *s = line; *s && !status; s++) {
    if (*s == '\'' || *s == '"') quoted = !quoted;
    depth += (*s == '{') - (*s == '}');
    if (*s != '=' || quoted || depth || s[1] == '=' || s == line || strchr("=<>!", s[-1])) continue;
    const char *end = s;
    while (end > line && strchr(" \t", end[-1])) end--;
    const char *begin = end;
    while (begin > line && (isalnum((unsigned char)begin[-1]) || begin[-1] == '_')) begin--;
    char name[VS_DECK_NAME];
    snprintf(name, sizeof name, "%.*s", (int)(end - begin), begin);
    status = each(ctx, name);
  }
  return status;
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
    while (isalnum((unsigned char)s[n]) || s[n] == '_') n++;
    if (BEGINS_AMONG(s, n, CLOCKS)) return true;
    if (source && s > line && BEGINS_AMONG(s, n, COURSES)) return true;
    s += n ? n : 1;
  }
  return false;
}

/* ---- chance ---- */

/* Finds the whole word in a text; with `call`, only where '(' follows it. NULL: it is not there. */
static const char *find_whole(const char *text, const char *word, bool call) {
  size_t n = strlen(word);
  if (call && !strchr(text, '(')) return NULL;
  for (const char *s = text; (s = strcasestr(s, word)); s++) {
    bool within = s > text && (isalnum((unsigned char)s[-1]) || strchr("_.#", s[-1]));
    if (within || isalnum((unsigned char)s[n]) || s[n] == '_') continue;
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

/* Finds the place of a word in its file, which is read again: the line at hand is joined from
 * several. */
static vs_where place_in_file(const char *word, bool call, vs_where where) {
  vs_source source;
  vs_error unread = {0};
  bool found = vs_source_read(where.file, &source, &unread) != VS_OK;
  for (int number = where.line; !found && number <= (int)source.count; number++) {
    const char *text = source.line[number - 1], *s = find_whole(text, word, call);
    if (number > where.line && !strchr("+*", text[strspn(text, " \t")])) break;
    if (!s || text[strspn(text, " \t")] == '*') continue;
    where.line = number;
    where.column = vs_text_column(text, s);
    found = true;
  }
  vs_source_free(&source);
  return where;
}

vs_status vs_rules_random(const char *line, bool pspice, vs_where where, vs_error *err) {
  const char *word = NULL, *call = find_random(line, pspice, &word);
  if (!call) return VS_OK;
  bool noise = !strncmp(word, "tr", 2);
  if (pspice && !strcmp(word, "limit"))
    return vs_fail_at(
        err, place_in_file(word, true, where),
        "limit: in PSpice's dialect ngspice knows LIMIT(x, least, most), of three and "
        "with no blank before '('");
  if (!strcmp(word, "limit") && cuts_off(call))
    return vs_fail_at(err, place_in_file(word, true, where),
                      "limit: LIMIT(x, least, most), of three, is PSpice's; with a line '*$ compat "
                      "ps' the deck is read in that dialect. ngspice's own, of two, is random");
  return vs_fail_at(err, place_in_file(word, !noise, where),
                    noise ? "%s is random anew in each run; a course that is the same each time "
                            "would be right, or a study over a parameter"
                          : "%s(...) is random anew in each run of ngspice's; a number would be "
                            "right, or a '*$ param' that a study varies",
                    word);
}

typedef struct place {
  const vs_deck *deck;
  vs_where where;
  vs_error *err;
} place;

/* Refuses a name that the netlist may have in the place of one of ngspice's own. */
static vs_status name_rule(void *ctx, const char *name) {
  const place *p = ctx;
  return vs_reserved_is_ours(name)
             ? vs_fail_at(p->err, p->where,
                          "parameter %s: the program makes such names; give yours another name",
                          name)
             : VS_OK;
}

/* Refuses a .param of a name that is the program's or a '*$ param's. For lines at the top of a
 * deck; within a subcircuit a name is the subcircuit's own. */
static vs_status param_rule(void *ctx, const char *name) {
  const place *p = ctx;
  if (vs_deck_is_standard(name))
    return vs_fail_at(p->err, p->where, "parameter %s is the program's; give yours another name",
                      name);
  for (size_t k = 1; k < p->deck->section.count; k++)
    if (!strcasecmp(p->deck->section.fields[k].key, name))
      return vs_fail_at(p->err, p->where, "parameter %s stands in a '*$ param' line already", name);
  return VS_OK;
}

vs_status vs_rules_params(const vs_deck *deck, vs_error *err) {
  const vs_cards *c = vs_deck_cards(deck);
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->count && !status; k = vs_cards_next(c, k)) {
    char within[VS_PATH_SIZE];
    if (c->card[k].kind != VS_CARDS_PARAM || c->card[k].conditional) continue;
    const place p = {deck, vs_deck_mendable(deck, deck->lines[k].where, within, sizeof within),
                     err};
    status = vs_error_keep(err, assignments(deck->lines[k].text, param_rule, (void *)(size_t)&p));
  }
  return status;
}

static vs_status model_name_rule(void *ctx, const char *name) {
  const place *p = ctx;
  size_t n = strlen(name);
  return n >= 4 && !strcasecmp(name + n - 4, "file")
             ? vs_fail_at(p->err, p->where, "a model may not read or write a file (%s=)", name)
             : VS_OK;
}

/* Model types that need nothing but their parameters. Left out are ngspice's numerical devices and
 * code models that read or write files, and code models that step back in time or act on events,
 * which libngspice handles wrongly (oneshot, square, triangle, digital ones). */
static vs_status model_rule(const place *p, const char *line) {
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
  char type[VS_DECK_NAME], after[VS_DECK_NAME];
  nth_word(line, 2, type);
  if (!strncmp(type, "ako:", 4)) nth_word(line, type[4] ? 3 : 4, type); /* "a kind of" another */
  nth_word(line, 3, after);
  if (!*type || strchr(type, '=') || *after == '=')
    return vs_fail_at(
        p->err, p->where,
        "a model has a name and a type: '.model NAME TYPE(PARAMETER=VALUE ...)'; here "
        "one of them is missing");
  if (!AMONG(type, DEVICES) && !AMONG(type, CODE_MODELS))
    return vs_fail_at(p->err, p->where,
                      "model type '%s' does not belong in a deck: allowed are d, bipolar, field "
                      "effect and vdmos transistors, r, c, l, switches and analog code models "
                      "without files",
                      type);
  bool transistor = strchr("np", *type) && *type;
  const char *level = transistor ? strcasestr(line, "level") : NULL;
  if (level) {
    char number[8];
    level += 5 + strspn(level + 5, " \t");
    if (*level == '=') level += 1 + strspn(level + 1, " \t");
    snprintf(number, sizeof number, "%.*s", (int)strcspn(level, " \t)"), level);
    bool mos = strstr(type, "mos");
    if (!AMONG(number, LEVELS) || (mos && !strcmp(number, "4")))
      return vs_fail_at(p->err, p->where,
                        "model level '%s' does not belong in a deck: allowed are %s (others write "
                        "files); its maker may have one of these, or 'vibrospice part' a template",
                        number, mos ? "1, 2, 3, 6, 9" : "1, 2, 3, 4, 6, 9");
  }
  return assignments(line, model_name_rule, (void *)(size_t)p);
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

vs_status vs_rules_statement(vs_deck *deck, const char *line, vs_where where, bool *skip,
                             vs_error *err) {
  static const char *const ALLOWED[] = {".param", ".model",  ".subckt", ".ends",
                                        ".func",  ".global", ".ic",     ".nodeset",
                                        ".if",    ".elseif", ".else",   ".endif"};
  const place p = {deck, where, err};
  vs_status judged = vs_statements_judge(line, where, &deck->skipped, skip, err);
  if (judged || *skip) return judged;
  deck->own_clock = deck->own_clock || knows_time(line);
  char word[VS_DECK_NAME], name[VS_DECK_NAME];
  snprintf(word, sizeof word, "%.*s", (int)strcspn(line, " \t=("), line);
  vs_cursor_lower(word);
  if (!strcmp(word, ".title")) return title(deck, line + strlen(word), where, skip);
  /* ngspice takes any statement that begins with one of its own, so the whole word must be known */
  if (!AMONG(word, ALLOWED))
    return vs_fail_at(err, where,
                      "%s does not belong in a deck: a circuit is made of .param, .model, .subckt, "
                      ".func, .global, .ic, .nodeset, .if and .include",
                      word);
  if (!strcmp(word, ".model")) return model_rule(&p, line);
  if (!strcmp(word, ".ic")) return initial_rule(line, where, err);
  if (!strcmp(word, ".param") || !strcmp(word, ".subckt")) {
    vs_status status = assignments(line, name_rule, (void *)(size_t)&p);
    if (status) return status;
  }
  if (!strcmp(word, ".param") && deck->subcircuits == 0)
    return assignments(line, param_rule, (void *)(size_t)&p);
  if (!strcmp(word, ".ends") && deck->subcircuits == 0 && !(deck->lost & VS_LOST_ELEMENT))
    return vs_fail_at(err, where, ".ends closes a .subckt, and none is open here");
  if (!strcmp(word, ".ends") && deck->subcircuits > 0) deck->subcircuits--;
  if (strcmp(word, ".subckt")) return VS_OK;
  if (deck->subcircuits++ == 0) deck->subcircuit = where;
  return strcmp(nth_word(line, 1, name), "eva")
             ? VS_OK
             : vs_fail_at(err, where, "subcircuit eva is the program's; give yours another name");
}

/* ---- elements ---- */

/* Refuses "external" anywhere but as the fourth and last word; ngspice dies of some such lines. */
static vs_status source_rule(const char *line, vs_where where, vs_error *err) {
  if (!strchr("vViI", *line)) return VS_OK;
  int n = 0; /* which word it is */
  for (const char *s = line + strspn(line, VS_WORDS_BETWEEN); *s; n++) {
    const char *next = vs_words_next(s);
    bool external = vs_words_is(vs_words_at(s), "external");
    if (external && (n > 3 || (n == 3 && *next)))
      return vs_fail_at(err, where,
                        "a source the program drives is 'NAME n m external' and no more");
    s = next;
  }
  return VS_OK;
}

/* Notes the EVA, "Xname n m eva" at the top of the deck, and refuses it anywhere else and
 * with both ends on one node. */
static vs_status eva_rule(vs_deck *deck, const char *line, vs_where where, vs_error *err) {
  char word[VS_DECK_NAME];
  if (!vs_words_find(line, line, "eva", 3)) return VS_OK;
  if (!vs_words_is(vs_cards_instance_of(line), "eva")) return VS_OK;
  if (*deck->eva) return vs_fail_at(err, where, "a second EVA; a deck has one line 'Xeva n m eva'");
  if (deck->subcircuits > 0)
    return vs_fail_at(err, where,
                      "the EVA is one line 'Xeva n m eva' at the top of the deck, in no "
                      "subcircuit, and the .subckt of %s:%d is not closed before it",
                      deck->subcircuit.file, deck->subcircuit.line);
  if (strcmp(nth_word(line, 3, word), "eva"))
    return vs_fail_at(err, where, "the EVA is one line 'Xeva n m eva' at the top of the deck");
  nth_word(line, 0, deck->eva);
  nth_word(line, 1, deck->eva_plus);
  nth_word(line, 2, deck->eva_minus);
  return strcmp(deck->eva_plus, deck->eva_minus) &&
                 !(vs_words_is_ground(vs_words_of(deck->eva_plus)) &&
                   vs_words_is_ground(vs_words_of(deck->eva_minus)))
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

vs_status vs_rules_element(vs_deck *deck, const char *line, vs_where where, vs_error *err) {
  if (!vs_rules_is_element(line))
    return vs_fail_at(
        err, where,
        "an element is wanted here: 'NAME node node ...', or a statement, or a comment");
  deck->own_clock = deck->own_clock || knows_time(line);
  vs_status status = source_rule(line, where, err);
  return status ? status : eva_rule(deck, line, where, err);
}
