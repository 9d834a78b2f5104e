/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/reserved.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"

/* ---- the list ---- */

/* tests/netlist/test_dialects.c tries each of them, and others, as ".param NAME=1000" in all places
 * of ngspice 39 that have expressions. What its commands know besides (c, i, kelvin, boltz, ...) no
 * expression of a netlist does. `var` is kept by ngspice 46, and free in 39. */
static const struct {
  const char *name;
  bool pspice; /* in PSpice's dialect alone, where ngspice adds a .param of its own */
} NAMES[] = {
    {"e", 0},     {"pi", 0},     {"time", 0},        {"temper", 0}, {"hertz", 0}, {"sqr", 0},
    {"sqrt", 0},  {"sin", 0},    {"cos", 0},         {"exp", 0},    {"ln", 0},    {"log", 0},
    {"log10", 0}, {"arctan", 0}, {"abs", 0},         {"pow", 0},    {"pwr", 0},   {"max", 0},
    {"min", 0},   {"int", 0},    {"sinh", 0},        {"cosh", 0},   {"tanh", 0},  {"sgn", 0},
    {"ceil", 0},  {"floor", 0},  {"asin", 0},        {"acos", 0},   {"atan", 0},  {"asinh", 0},
    {"acosh", 0}, {"atanh", 0},  {"tan", 0},         {"nint", 0},   {"gauss", 0}, {"unif", 0},
    {"aunif", 0}, {"limit", 0},  {"ternary_fcn", 0}, {"agauss", 0}, {"pwl", 0},   {"value", 0},
    {"table", 0}, {"var", 0},    {"temp", 1},        {"vt", 1}};
enum { COUNT = sizeof NAMES / sizeof *NAMES, E = 0, PI = 1 };
static const char OURS[] = "__own";

/* Which of the names, a bit for each. */
typedef uint64_t names;
_Static_assert(COUNT <= 64, "a bit for each name");

/* The number of the name; COUNT: it is none of them. */
static size_t number_of(vs_word word, bool pspice) {
  for (size_t k = 0; k < COUNT; k++)
    if (vs_words_is(word, NAMES[k].name)) return pspice || !NAMES[k].pspice ? k : COUNT;
  return COUNT;
}

const char *vs_reserved_at(size_t n, bool *pspice) {
  if (n >= COUNT) return NULL;
  *pspice = NAMES[n].pspice;
  return NAMES[n].name;
}

bool vs_reserved_is(const char *name, bool pspice) {
  return number_of(vs_words_of(name), pspice) < COUNT;
}

bool vs_reserved_is_ours(const char *name) {
  const size_t n = strlen(name), own = sizeof OURS - 1;
  return n > own && !strcasecmp(name + n - own, OURS) &&
         number_of((vs_word){name, n - own}, true) < COUNT;
}

double vs_reserved_constant(const char *name) {
  const size_t k = number_of(vs_words_of(name), false);
  return k == E ? M_E : k == PI ? M_PI : NAN;
}

void vs_reserved_write(const char *name, bool pspice, vs_text *out) {
  vs_text_add(out, "%s%s", name, vs_reserved_is(name, pspice) ? OURS : "");
}

void vs_reserved_restore(char *message) {
  for (char *s = message; (s = strcasestr(s, OURS));) {
    const char *begin = s, *end = s + sizeof OURS - 1;
    while (begin > message && vs_words_goes_on(begin[-1])) begin--;
    if (vs_words_goes_on(*end) || number_of((vs_word){begin, (size_t)(s - begin)}, true) == COUNT)
      s++;
    else
      memmove(s, end, strlen(end) + 1);
  }
}

/* ---- where names are defined ---- */

/* The scopes of a netlist, each with the names that it defines. */
typedef struct scopes {
  const vs_cards *cards;
  struct {
    names own;
    names lent;   /* what those know that have instances of it: in braces it does, too */
  } * item;       /* owned */
  names anywhere; /* what any of them defines */
  bool pspice;
} scopes;

/* The scope of a line. That of a .subckt is its own. */
static size_t scope_of(const scopes *s, size_t line) {
  const vs_netlist_card *card = &s->cards->card[line];
  return card->opens ? card->opens : card->scope;
}

/* The length of the name at s, which is no part of a longer word or number; 0: none begins there.
 */
static size_t name_at(const char *line, const char *s) {
  size_t n = 0;
  if (!isalpha((unsigned char)*s) && *s != '_') return 0;
  if (s > line && (vs_words_goes_on(s[-1]) || strchr(".#", s[-1]))) return 0;
  while (vs_words_goes_on(s[n])) n++;
  return n;
}

static void find_scopes(scopes *s, vs_reserved_given given) {
  s->item = vs_alloc(s->cards->n_scopes, sizeof *s->item);
  for (size_t k = 0; k < given.count; k++) {
    const size_t n = number_of(vs_words_of(given.name[k]), s->pspice);
    if (n < COUNT) s->item[0].own |= (names)1 << n;
  }
  for (size_t k = 0; k < s->cards->n_definitions; k++) {
    const vs_netlist_definition *d = &s->cards->definition[k];
    const size_t n = d->kind == VS_CARDS_PARAM ? number_of(d->name, s->pspice) : COUNT;
    if (n < COUNT) s->item[d->scope].own |= (names)1 << n;
  }
  for (size_t k = 0; k < s->cards->n_scopes; k++) s->anywhere |= s->item[k].own;
}

static names known_in(const scopes *s, size_t scope) {
  names known = s->item[scope].own;
  for (; scope; scope = s->cards->scope[scope].outer)
    known |= s->item[s->cards->scope[scope].outer].own;
  return known;
}

/* Lends what the scope of an instance knows to its subcircuit. Returns whether there was more to
 * lend than before. */
static bool lend(scopes *s, const vs_netlist_card *instance) {
  const names known = known_in(s, instance->scope) | s->item[instance->scope].lent;
  const size_t called = known ? vs_cards_called(s->cards, instance) : 0;
  const bool more = called && (known & ~s->item[called].lent);
  if (called) s->item[called].lent |= known;
  return more;
}

static void lend_all(scopes *s) {
  bool more = s->anywhere & ~s->item[0].own;
  while (more) {
    more = false;
    for (size_t k = 0; k < s->cards->count; k++)
      if (s->cards->card[k].scope && s->cards->card[k].letter == 'x')
        more = lend(s, &s->cards->card[k]) || more;
  }
}

/* ---- the places in a line ---- */

/* A line while it is written anew. */
typedef struct pen {
  const char *line;
  const scopes *scopes;
  names known;    /* in this line */
  names inner;    /* the same in braces, with what is lent */
  bool constants; /* pi and e get numbers in this line's expressions */
  vs_text out;
  bool changed;
} pen;

/* Adds a name of n characters at s, renamed if it is among `which`. */
static void add_name(pen *p, const char *s, size_t n, names which, bool constants) {
  const size_t k = number_of((vs_word){s, n}, p->scopes->pspice);
  const bool own = k < COUNT && which >> k & 1;
  const bool number = !own && constants && p->constants && (k == E || k == PI);
  p->changed = p->changed || own || number;
  if (number)
    vs_text_add(&p->out, "%.17g", vs_reserved_constant(NAMES[k].name));
  else
    vs_text_add(&p->out, "%.*s%s", (int)n, s, own ? OURS : "");
}

/* Copies the text from s to `end` as it is; returns `end`. */
static const char *add_up_to(pen *p, const char *s, const char *end) {
  vs_text_add(&p->out, "%.*s", (int)(end - s), s);
  return end;
}

/* The end of what stands at s and has no names of parameters: a text in double quotes,
 * @device[...], a number with its unit, v(...) or i(...). s: there is none. */
static const char *behind_others(const char *line, const char *s) {
  const char *end = s;
  if (*s == '"' || *s == '@') {
    end = strchr(s + 1, *s == '"' ? '"' : ']');
    return end ? end + 1 : s + 1;
  }
  const bool within = s > line && (vs_words_goes_on(s[-1]) || s[-1] == '.');
  if (isdigit((unsigned char)*s) && !within) {
    while (vs_words_goes_on(*end) || *end == '.') end++;
    return end;
  }
  if (!strchr("vViI", *s) || name_at(line, s) != 1) return s;
  end = s + 1 + strspn(s + 1, " \t");
  end = *end == '(' ? strchr(end, ')') : NULL;
  return end ? end + 1 : s;
}

/* Adds the expression from s up to `end`. "NAME =" is a parameter's with `assigns`. */
static void add_expression(pen *p, const char *s, const char *end, names which, bool assigns) {
  while (s < end) {
    const char *other = behind_others(p->line, s);
    const size_t n = name_at(p->line, s);
    if (other > s)
      s = add_up_to(p, s, other < end ? other : end);
    else if (n == 0)
      s = add_up_to(p, s, s + 1);
    else {
      const bool call = s[n + strspn(s + n, " \t")] == '(', given = vs_words_is_given(s + n);
      add_name(p, s, n, call ? 0 : !given ? which : assigns ? ~(names)0 : 0, !call && !given);
      s += n;
    }
  }
}

/* True for a bare word of an element that ngspice takes for a parameter: a value of R, C, L, V, I
 * behind its nodes, or a gain. Of other elements it is a node, a model or another element. */
static bool is_value(const char *line, const char *word, size_t position) {
  static const char *const COURSES[] = {"sin", "exp", "pwl"};
  const char letter = (char)tolower((unsigned char)*line);
  for (size_t k = 0; strchr("vi", letter) && k < sizeof COURSES / sizeof *COURSES; k++)
    if (vs_words_is(vs_words_at(word), COURSES[k])) return false;
  if (strchr("rclkvi", letter)) return position >= 3;
  if (strcasestr(line, "poly")) return false;
  return (strchr("eg", letter) && position == 5) || (strchr("fh", letter) && position == 4);
}

/* Adds an element or another line: its expressions stand in braces or quotes, or behind "=". */
static void add_element(pen *p) {
  size_t position = 0; /* which word it is, the element's name being 0 */
  for (const char *s = p->line; *s;) {
    const char before = s > p->line ? s[-1] : 'x', *last = s;
    if (strchr(VS_WORDS_BETWEEN, before) && !strchr(VS_WORDS_BETWEEN, *s)) position++;
    while (last > p->line && strchr(" \t", last[-1])) last--;
    const bool behind = last > p->line && last[-1] == '=';
    const size_t n = name_at(p->line, s);
    const char *other = behind_others(p->line, s);
    if (*s == '{' || *s == '\'') {
      const char *end = strchr(s + 1, *s == '{' ? '}' : '\'');
      if (!end) end = s + strlen(s) - 1;
      add_expression(p, s, end + 1, p->inner, false);
      s = end + 1;
    } else if (other > s || n == 0) {
      s = add_up_to(p, s, other > s ? other : s + 1);
    } else {
      const bool parted = strchr(VS_WORDS_BETWEEN, before) && strchr(VS_WORDS_BETWEEN, s[n]);
      const bool value = behind || (parted && *p->line != '.' && is_value(p->line, s, position));
      const bool name = !value || s[n] == '(' || vs_words_is_given(s + n);
      add_name(p, s, n, name ? 0 : p->known, false);
      s += n;
    }
  }
}

/* The arguments of the function that a line ".func NAME(a, b) ..." or ".param NAME(a)=..." defines.
 */
static names arguments_of(const char *line, bool pspice) {
  names found = 0;
  const char *s = line + strcspn(line, " \t");
  s += strspn(s, " \t");
  while (vs_words_goes_on(*s)) s++;
  s += strspn(s, " \t");
  if (*s != '(') return 0;
  for (; *s && *s != ')'; s++) {
    const size_t n = name_at(line, s), k = n ? number_of((vs_word){s, n}, pspice) : COUNT;
    if (k < COUNT) found |= (names)1 << k;
    s += n ? n - 1 : 0;
  }
  return found;
}

/* Where the first "NAME =" of a line begins; the line's end where there is none. */
static const char *first_given(const char *line) {
  for (const char *s = line; *s;) {
    const size_t n = name_at(line, s);
    if (n && vs_words_is_given(s + n)) return s;
    s += n ? n : 1;
  }
  return line + strlen(line);
}

/* Writes the line anew, with a parameter that has a reserved name renamed. `from` is where the
 * line's one long expression begins: behind the word of .param, .func, .if and .elseif, behind the
 * nodes of a B source, at the first NAME= of an instance or .subckt. Other lines have their
 * expressions here and there, which add_element finds. */
static void rewrite_line(pen *p) {
  static const char *const WHOLE[] = {".param", ".func", ".if", ".elseif"};
  const char *line = p->line, *from = NULL;
  const char letter = (char)tolower((unsigned char)*line);
  const bool instance = letter == 'x' || vs_words_begin(line, ".subckt");
  bool assigns = instance;
  p->constants = !strchr("beg", letter); /* B, E and G sources know pi and e themselves */
  if (instance) from = first_given(line);
  if (letter == 'b') from = vs_words_next(vs_words_next(vs_words_next(line)));
  for (size_t k = 0; k < sizeof WHOLE / sizeof *WHOLE; k++) {
    const size_t n = strlen(WHOLE[k]);
    if (strncasecmp(line, WHOLE[k], n) || vs_words_goes_on(line[n])) continue;
    from = line + n;
    assigns = k == 0;
    if (k == 1) p->inner = p->known; /* its body may be a B source's */
    if (k < 2) p->inner |= arguments_of(line, p->scopes->pspice);
  }
  if (!p->constants) p->inner = p->known;
  if (!from) {
    add_element(p);
    return;
  }
  add_up_to(p, line, from);
  add_expression(p, from, line + strlen(line), p->inner, assigns);
}

/* True where a line may have one of the names: most lines of most netlists have none. */
static bool has_name(const scopes *s, const char *line) {
  const names which = s->anywhere | (vs_words_begin(line, ".func") ? ~(names)0 : 0);
  for (const char *c = line; *c;) {
    const size_t n = name_at(line, c);
    const size_t k = n ? number_of((vs_word){c, n}, s->pspice) : COUNT;
    if (k == E || k == PI || (k < COUNT && which >> k & 1)) return true;
    c += n ? n : 1;
  }
  return false;
}

bool vs_reserved_rename(const vs_cards *cards, vs_line *lines, vs_reserved_given given,
                        bool pspice) {
  scopes s = {.cards = cards, .pspice = pspice};
  bool changed = false;
  find_scopes(&s, given);
  lend_all(&s);
  for (size_t k = 0; k < cards->count; k++) {
    const size_t scope = scope_of(&s, k);
    if (!has_name(&s, lines[k].text)) continue;
    pen p = {.line = lines[k].text, .scopes = &s, .known = known_in(&s, scope)};
    p.inner = p.known | s.item[scope].lent;
    rewrite_line(&p);
    changed = changed || p.changed;
    if (p.changed)
      vs_line_change(&lines[k], p.out.text);
    else
      vs_text_free(&p.out);
  }
  free(s.item);
  return changed;
}
