/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "circuit/rules.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "circuit/contract.h"

static bool among(const char *word, const char *const *list, size_t count) {
  for (size_t k = 0; k < count; k++)
    if (!strcasecmp(word, list[k])) return true;
  return false;
}
#define AMONG(word, list) among(word, list, sizeof(list) / sizeof *(list))

bool vs_is_standard(const char *name) {
  return AMONG(name, vs_standard_names);
}

/* Each was tried as ".param NAME=1000" and "R1 a b {NAME}" in ngspice 39. */
bool vs_is_reserved(const char *name) {
  static const char *const FUNCTIONS[] = {
      "sqr",   "sqrt", "sin",   "cos",  "exp",         "ln",     "arctan", "abs",   "pow",
      "pwr",   "max",  "min",   "int",  "log",         "log10",  "sinh",   "cosh",  "tanh",
      "sgn",   "ceil", "floor", "asin", "acos",        "atan",   "asinh",  "acosh", "atanh",
      "tan",   "nint", "gauss", "unif", "ternary_fcn", "agauss", "aunif",  "limit"};
  static const char *const VARIABLES[] = {"time", "temper", "hertz"};
  return AMONG(name, FUNCTIONS) || AMONG(name, VARIABLES);
}

/* What parts words, as for ngspice. */
static const char PARTING[] = " \t(),";

/* The n-th word of a line, from 0, cut to fit. Empty: there is none. */
static const char *nth_word(const char *line, int n, char word[VS_DECK_NAME]) {
  const char *s = line + strspn(line, PARTING);
  for (; n > 0; n--) {
    s += strcspn(s, PARTING);
    s += strspn(s, PARTING);
  }
  snprintf(word, VS_DECK_NAME, "%.*s", (int)strcspn(s, PARTING), s);
  vs_lower(word);
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

/* Does a line say what happens when, besides what the program drives? */
static bool knows_time(const char *line) {
  static const char *const COURSES[] = {"pulse", "sin",     "exp",      "pwl", "sffm",
                                        "am",    "trnoise", "trrandom", "pat"};
  static const char *const CLOCKS[] = {"time", "hertz"};
  bool source = strchr("vViI", *line) && *line;
  for (const char *s = line; *s;) {
    char word[VS_DECK_NAME];
    size_t n = 0;
    while (isalnum((unsigned char)s[n]) || s[n] == '_') n++;
    snprintf(word, sizeof word, "%.*s", (int)n, s);
    if (AMONG(word, CLOCKS) || (source && s > line && AMONG(word, COURSES))) return true;
    s += n ? n : 1;
  }
  return false;
}

/* ---- chance ---- */

/* The word in a text, whole; with `call` only where '(' comes next, blanks aside. NULL: it is not
 * there. */
static const char *find_whole(const char *text, const char *word, bool call) {
  size_t n = strlen(word);
  for (const char *s = text; *s; s++) {
    bool within = s > text && (isalnum((unsigned char)s[-1]) || strchr("_.#", s[-1]));
    if (within || strncasecmp(s, word, n) || isalnum((unsigned char)s[n]) || s[n] == '_') continue;
    if (!call || s[n + strspn(s + n, " \t")] == '(') return s;
  }
  return NULL;
}

/* LIMIT(x, least, most) of PSpice's dialect cuts off and draws nothing: ngspice 39 has a .func of
 * that name there, which it finds where '(' comes right behind it. */
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

/* The first of the words that the line names; NULL: none. In "V1 a b trnoise ..." the words of a
 * source's course stand behind its nodes, in ".model NAME limit(...)" the type behind the name. */
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

/* Where it stands in its file, as the line may go on below: the line as it is kept is a joined one.
 */
static vs_where place_of(const char *word, bool call, vs_where where) {
  FILE *f = fopen(where.file, "r");
  char *text = NULL;
  size_t size = 0;
  bool found = false;
  for (int number = 1; f && !found && getline(&text, &size, f) >= 0; number++) {
    const char *s = number < where.line ? NULL : find_whole(text, word, call);
    if (number > where.line && !strchr("+*", text[strspn(text, " \t")])) break;
    if (!s || text[strspn(text, " \t")] == '*') continue;
    where.line = number;
    where.column = vs_column(text, s);
    found = true;
  }
  free(text);
  if (f) fclose(f);
  return where;
}

vs_status vs_rule_random(const char *line, bool pspice, vs_where where, vs_error *err) {
  const char *word = NULL;
  if (!find_random(line, pspice, &word)) return VS_OK;
  bool noise = !strncmp(word, "tr", 2);
  if (pspice && !strcmp(word, "limit"))
    return vs_fail_at(err, place_of(word, true, where),
                      "limit: in PSpice's dialect ngspice knows LIMIT(x, least, most), of three and "
                      "with no blank before '('");
  return vs_fail_at(err, place_of(word, !noise, where),
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

static vs_status name_rule(void *ctx, const char *name) {
  const place *p = ctx;
  return vs_is_reserved(name)
             ? vs_fail_at(p->err, p->where,
                          "parameter %s: ngspice has that name for itself in expressions; give yours "
                          "another name",
                          name)
             : VS_OK;
}

/* At the top of a deck: within a subcircuit a name is the subcircuit's own. */
static vs_status param_rule(void *ctx, const char *name) {
  const place *p = ctx;
  if (vs_is_standard(name))
    return vs_fail_at(p->err, p->where, "parameter %s is the program's; give yours another name",
                      name);
  for (size_t k = 1; k < p->deck->section.count; k++)
    if (!strcasecmp(p->deck->section.fields[k].key, name))
      return vs_fail_at(p->err, p->where, "parameter %s stands in a '*$ param' line already", name);
  return VS_OK;
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
  char type[VS_DECK_NAME];
  nth_word(line, 2, type);
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
                        "files)",
                        number, mos ? "1, 2, 3, 6, 9" : "1, 2, 3, 4, 6, 9");
  }
  return assignments(line, model_name_rule, (void *)(size_t)p);
}

vs_status vs_rule_statement(vs_deck *deck, const char *line, vs_where where, vs_error *err) {
  static const char *const ALLOWED[] = {".param", ".model",  ".subckt", ".ends",
                                        ".func",  ".global", ".ic",     ".nodeset",
                                        ".if",    ".elseif", ".else",   ".endif"};
  const place p = {deck, where, err};
  deck->own_clock = deck->own_clock || knows_time(line);
  char word[VS_DECK_NAME], name[VS_DECK_NAME];
  snprintf(word, sizeof word, "%.*s", (int)strcspn(line, " \t=("), line);
  vs_lower(word);
  /* ngspice takes any statement that begins with one of its own, so the whole word must be known */
  if (!AMONG(word, ALLOWED))
    return vs_fail_at(err, where,
                      "%s does not belong in a deck: analysis, options and commands are the "
                      "program's",
                      word);
  if (!strcmp(word, ".model")) return model_rule(&p, line);
  if (!strcmp(word, ".param") || !strcmp(word, ".subckt")) {
    vs_status status = assignments(line, name_rule, (void *)(size_t)&p);
    if (status) return status;
  }
  if (!strcmp(word, ".param") && deck->subcircuits == 0)
    return assignments(line, param_rule, (void *)(size_t)&p);
  if (!strcmp(word, ".ends") && deck->subcircuits > 0) deck->subcircuits--;
  if (strcmp(word, ".subckt")) return VS_OK;
  deck->subcircuits++;
  return strcmp(nth_word(line, 1, name), "eva")
             ? VS_OK
             : vs_fail_at(err, where, "subcircuit eva is the program's; give yours another name");
}

/* ---- elements ---- */

const char *vs_instance_of(const char *line, size_t *length) {
  const char *found = NULL;
  if (tolower((unsigned char)*line) != 'x') return NULL;
  for (const char *s = line; *s;) {
    s += strspn(s, " \t");
    size_t n = strcspn(s, " \t");
    const char *after = s + n + strspn(s + n, " \t");
    if (memchr(s, '=', n) || *after == '=' || !strncasecmp(s, "params:", 7)) break;
    if (n) found = s, *length = n;
    s += n;
  }
  return found;
}

bool vs_is_external(const char *line, char name[VS_DECK_NAME]) {
  char word[VS_DECK_NAME];
  nth_word(line, 0, name);
  return (*name == 'v' || *name == 'i') && !strcmp(nth_word(line, 3, word), "external");
}

/* "external" anywhere but as the fourth and last word: ngspice dies of some such lines. */
static vs_status source_rule(const char *line, vs_where where, vs_error *err) {
  static const char EXTERNAL[] = "external";
  if (!strchr("vViI", *line)) return VS_OK;
  int n = 0; /* which word it is */
  for (const char *s = line + strspn(line, PARTING); *s; n++) {
    size_t length = strcspn(s, PARTING);
    const char *next = s + length + strspn(s + length, PARTING);
    bool external = length == strlen(EXTERNAL) && !strncasecmp(s, EXTERNAL, length);
    if (external && (n > 3 || (n == 3 && *next)))
      return vs_fail_at(err, where,
                        "a source the program drives is 'NAME n m external' and no more");
    s = next;
  }
  return VS_OK;
}

/* "Xname n m eva", at the top of the deck */
static vs_status eva_rule(vs_deck *deck, const char *line, vs_where where, vs_error *err) {
  size_t n = 0;
  char word[VS_DECK_NAME];
  const char *kind = vs_instance_of(line, &n);
  if (!kind || n != 3 || strncasecmp(kind, "eva", 3)) return VS_OK;
  if (*deck->eva) return vs_fail_at(err, where, "a second EVA; a deck has one line 'Xeva n m eva'");
  if (deck->subcircuits > 0 || strcmp(nth_word(line, 3, word), "eva"))
    return vs_fail_at(
        err, where, "the EVA is one line 'Xeva n m eva' at the top of the deck, in no subcircuit");
  nth_word(line, 0, deck->eva);
  nth_word(line, 1, deck->eva_plus);
  nth_word(line, 2, deck->eva_minus);
  return VS_OK;
}

vs_status vs_rule_element(vs_deck *deck, const char *line, vs_where where, vs_error *err) {
  /* A name and at least two words. Others are refused here because libngspice, given them, may read
   * beyond its memory or never come back. */
  size_t n = 0;
  while (isalnum((unsigned char)line[n]) || line[n] == '_' || line[n] == '.' || line[n] == '#') n++;
  const char *second = line + n + strspn(line + n, " \t"), *third = second + strcspn(second, " \t");
  third += strspn(third, " \t");
  if (!isalpha((unsigned char)*line) || !strchr(" \t", line[n]) || !*second || !*third)
    return vs_fail_at(
        err, where,
        "an element is wanted here: 'NAME node node ...', or a statement, or a comment");
  deck->own_clock = deck->own_clock || knows_time(line);
  vs_status status = source_rule(line, where, err);
  return status ? status : eva_rule(deck, line, where, err);
}
