/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/location.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "message.h"
#include "netlist/cards.h"
#include "netlist/deck.h"
#include "netlist/netlist.h"
#include "netlist/reserved.h"
#include "netlist/words.h"

/* ---- which lines it may be in ---- */

/* In which lines of a deck that may stand which a complaint of ngspice's speaks of. */

/* True for text whose first word is those n bytes. */
static bool is_named(const char *line, const char *name, size_t n) {
  return !strncasecmp(line, name, n) && strchr(" \t", line[n]);
}

/* Finds the subcircuit of a path, as "b.xs.xq.bk" or "xs.xq.kk", by its instances. 0: there is
 * none.
 */
static size_t scope_of(const vs_cards *c, const char *path) {
  size_t scope = 0;
  const char *last = vs_message_behind_path(path);
  if (path[1] == '.') path += 2; /* the element's letter */
  while (path < last) {
    const size_t n = strcspn(path, ".");
    size_t k = c->scope[scope].first;
    while (k < c->scope[scope].last && !is_named(c->lines[k].text, path, n))
      k = vs_cards_next(c, k);
    scope = k < c->scope[scope].last ? vs_cards_called(c, &c->card[k]) : 0;
    if (!scope) return 0;
    path += n + 1;
  }
  return scope;
}

/* Finds the lines that a message is about: those of the subcircuit of the first path in it, such as
 * "b.xs.xq.bk"; else all of the deck. */
static size_t scope_find(const vs_cards *c, const char *message) {
  static const char *const BEFORE[] = {"check node ", "instance ", "trouble with node \"", ": "};
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++)
    for (const char *s = message; (s = strstr(s, BEFORE[k]));) {
      s += strlen(BEFORE[k]);
      if (!isalpha((unsigned char)*s) || vs_message_behind_path(s) == s) continue;
      const size_t scope = scope_of(c, s);
      if (scope) return scope;
    }
  return 0;
}

/* True where the subcircuit that line k stands in, or one around that, has the parameter or the
 * model whose lack the message is of. */
static bool scope_has_what_lacks(const vs_cards *c, size_t k, const char *message) {
  vs_word name = {NULL, 0};
  name.at = vs_message_parameter(message, &name.n);
  const int kind = name.at ? VS_CARDS_PARAM : VS_CARDS_MODEL;
  if (!name.at) name.at = vs_message_model(message, &name.n);
  const vs_netlist_definition *d =
      name.at ? vs_cards_resolve(c, c->card[k].scope, kind, name) : NULL;
  return d && d->scope;
}

/* ---- what it speaks of ---- */

/* What a complaint of ngspice's speaks of, looked for in one line of the netlist. Each function
 * returns where it begins in the line; NULL: it is not in this line. */

/* True where the message speaks of the line's element, by one of its ways: "...: r1 a b ...", "...:
 * r1: ...", "... instance r1 ...", "... check node r1#branch". */
static bool is_element_of(const char *line, const char *message) {
  static const char *const BEFORE[] = {": ", "instance ", "check node ", "(instance: x"};
  size_t n = strcspn(line, " \t");
  if (n < 2 || *line == '.' || *line == '+') return false;
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++)
    for (const char *s = message; (s = strstr(s, BEFORE[k]));) {
      s = vs_message_behind_path(s + strlen(BEFORE[k]));
      if (!strncasecmp(s, line, n) && strchr(" :#)", s[n])) return true;
    }
  return false;
}

/* The node that is named: "check node b", "trouble with node "xa.b"", of which the last part is
 * what its own subcircuit calls it. No bytes: none is. */
static vs_word named_node(const char *message) {
  static const char *const BEFORE[] = {"check node ", "trouble with node \""};
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++) {
    const char *s = strstr(message, BEFORE[k]);
    if (!s) continue;
    s += strlen(BEFORE[k]);
    size_t n = strcspn(s, " \"");
    for (size_t dot = 0; dot < n; dot++)
      if (s[dot] == '.') s += dot + 1, n -= dot + 1, dot = 0;
    return (vs_word){s, n};
  }
  return (vs_word){NULL, 0};
}

/* It is looked for in lines of elements. */
static const char *subject_node(const char *line, const char *message) {
  const vs_word node = named_node(message);
  return node.n && *line != '.' ? vs_words_find(line, line + strcspn(line, " \t"), node.at, node.n)
                                : NULL;
}

/* The function whose argument was out of its range. */
static const char *subject_function(const char *line, const char *message) {
  static const char *const POWERS[] = {"pow", "pwr", "pwrs"};
  const char *name = vs_message_function(message), *found = NULL;
  if (!name || *line == '.') return NULL;
  found = vs_words_find(line, line, name, strcspn(name, " "));
  if (found || !vs_message_is_of_power(message) || !strchr("bBeEgG", *line)) return found;
  found = strstr(line, "**");
  if (!found) found = strchr(line, '^');
  for (size_t k = 0; k < sizeof POWERS / sizeof *POWERS && !found; k++)
    found = vs_words_find(line, line, POWERS[k], strlen(POWERS[k]));
  return found;
}

/* The same where it is a power, as the user wrote it: a line with '^' is more likely meant by a
 * complaint of '^' than one with pwr(). The complaint has the exponent, "X, Y out of range for ^":
 * a power with another number for it is not meant. */
static const char *subject_power(const char *line, const char *message) {
  const char *name = vs_message_function(message), *comma = name ? strstr(message, ", ") : NULL;
  if (!comma || *name != '^' || !strchr("bBeEgG", *line)) return NULL;
  for (const char *at = line; (at = strpbrk(at, "^*")); at++) {
    if (*at == '*' && at[1] != '*') continue;
    const char *behind = at + 1 + (*at == '*');
    char *end;
    double exponent = strtod(behind, &end);
    if (end == behind || exponent == strtod(comma + 2, NULL)) return at;
    at = behind - 1;
  }
  return NULL;
}

/* Finds a '=' with nothing behind it, which ngspice takes for an expression of no characters, or of
 * the next bracket. */
static const char *find_no_value(const char *line) {
  for (const char *s = line; (s = strchr(s, '=')); s++)
    if (strchr(")}", s[1 + strspn(s + 1, " \t")])) return s; /* or the end */
  return NULL;
}

/* The parameter that is not defined, the expression that cannot be read, the element or the word
 * that is named. */
static const char *subject_find(const char *line, const char *message) {
  size_t n = 0;
  const char *name = vs_message_parameter(message, &n);
  if (name) { /* a parameter stands in an expression, and so behind the first '{', quote or '=' */
    const char *from = *line == '.' ? strpbrk(line, "{'=( ") : strpbrk(line, "{'=");
    from = from ? vs_words_find(line, from, name, n) : NULL;
    while (from && vs_words_is_given(from + n)) from = vs_words_find(line, from + n, name, n);
    return from;
  }
  const char *expression = strstr(message, "xpression err: ");
  if (expression) {
    expression += 15;
    if (strlen(expression) < 2) return find_no_value(line); /* it may stand in any line */
    const char *whole = strcasestr(line, expression);
    while (vs_words_goes_on(expression[n])) n++;
    return whole || n < 2 ? whole : vs_words_find(line, line, expression, n);
  }
  name = vs_message_between(message, " '", '\'', &n);
  const char *word = name ? vs_words_find(line, line, name, n) : NULL;
  if (is_element_of(line, message)) return word ? word : line;
  return strstr(message, "circuit: no such function '") ? word : NULL;
}

/* True where the message quotes that line of an element, all of it. */
static bool subject_is_quoted(const char *line, const char *message) {
  const char *at = isalpha((unsigned char)*line) ? strcasestr(message, line) : NULL;
  return at && !vs_words_goes_on(at[strlen(line)]);
}

/* ---- where that stands ---- */

/* Finds the first line in which `find` finds what a message speaks of. */
static vs_where place_in_lines(const vs_deck *deck, const char *message,
                               const char *(*find)(const char *line, const char *message)) {
  const vs_cards *c = vs_deck_cards(deck);
  const vs_netlist_scope *in = &c->scope[scope_find(c, message)];
  const vs_word node = named_node(message);
  const bool local = find == subject_node && node.n && (in->name.n || node.at[-1] != '.');
  bool quoted = false; /* the message has a line as a whole, which is not another one then */
  for (size_t k = in->first; k < in->last && !quoted; k++)
    quoted = subject_is_quoted(deck->lines[k].text, message);
  for (size_t k = in->first; k < in->last; k++) {
    const vs_line *line = &deck->lines[k];
    if (quoted && !subject_is_quoted(line->text, message)) continue;
    if (local && &c->scope[c->card[k].scope] != in) continue;
    const char *at = find(line->written ? line->written : line->text, message);
    if (!at && !(line->written && find(line->text, message))) continue;
    if (!scope_has_what_lacks(c, k, message)) return at ? vs_line_place(line, at) : line->where;
  }
  return (vs_where){0};
}

/* A user's own subcircuit that stands at a node of the circuit itself. Those that come with the
 * program, and sources and resistors, are seldom what keeps Newton's iteration. */
static vs_where users_at(const vs_deck *deck, vs_word node) {
  const vs_cards *c = vs_deck_cards(deck);
  for (size_t k = 0; k < c->count; k = vs_cards_next(c, k)) {
    const size_t called =
        vs_cards_has_node(c, &c->card[k], node) ? vs_cards_called(c, &c->card[k]) : 0;
    const vs_where its = called ? deck->lines[c->scope[called].first - 1].where : (vs_where){0};
    if (its.file && !vs_deck_is_shipped(its.file)) return its;
  }
  return (vs_where){0};
}

/* The node that Newton's iteration did not find: a user's subcircuit at it, or behind a source of 0
 * V, which measures its current. */
static vs_where place_of_users(const vs_deck *deck, const char *message) {
  const vs_cards *c = vs_deck_cards(deck);
  const vs_word node = named_node(message);
  if (!strstr(message, "trouble with node") || !node.n || scope_find(c, message))
    return (vs_where){0};
  vs_where found = users_at(deck, node);
  for (size_t k = 0; k < c->count && !found.file; k = vs_cards_next(c, k)) {
    const vs_netlist_card *card = &c->card[k];
    if (card->letter != 'v' || !vs_cards_has_node(c, card, node)) continue;
    for (size_t n = 0; n < 2 && !found.file; n++)
      if (!vs_words_is(vs_cards_word(c, card, n), "0"))
        found = users_at(deck, vs_cards_word(c, card, n));
  }
  return found;
}

/* The place within a line of what a message speaks of; else the line's. */
static vs_where place_in_line(const vs_line *line, const char *message) {
  const char *at = subject_find(line->written ? line->written : line->text, message);
  return at ? vs_line_place(line, at) : line->where;
}

/* A wrong number of nodes is told of the instance. Where that comes with the program, or is none of
 * the deck's lines, the user's subcircuit is what has to be mended: its place. */
static vs_where place_of_pins(const vs_deck *deck, const char *message, vs_where where) {
  size_t n = 0;
  const char *name = vs_message_between(message, "parameters for subcircuit type \"", '"', &n);
  if (!name || (where.file && !vs_deck_is_shipped(where.file))) return where;
  const vs_netlist_definition *d =
      vs_cards_resolve(vs_deck_cards(deck), 0, VS_CARDS_SUBCKT, (vs_word){name, n});
  if (!d) return where;
  const vs_where its = deck->lines[d->card].where;
  return vs_deck_is_shipped(its.file) ? where : its;
}

/* Where a formula or a probe asks for the signal that is not there. */
static vs_where place_of_signal(const vs_deck *deck, const char *message) {
  static const char SAYS[] = "the circuit has no ";
  const char *signal = strstr(message, SAYS);
  if (signal) signal += strlen(SAYS);
  for (size_t k = deck->n_terms; signal && k-- > 0;)
    if (!strcmp(signal, deck->terms[k].plus) || !strcmp(signal, deck->terms[k].minus))
      return deck->terms[k].where;
  return (vs_where){0};
}

void vs_location_locate(const vs_deck *deck, size_t culprit, vs_error *err) {
  const vs_line *line = vs_netlist_line(deck, culprit);
  vs_reserved_restore(err->text);
  vs_where where = place_of_signal(deck, err->text);
  if (!where.file && line) where = place_in_line(line, err->text);
  if (!where.file) where = place_in_lines(deck, err->text, subject_find);
  if (!where.file) where = place_of_users(deck, err->text);
  if (!where.file) where = place_in_lines(deck, err->text, subject_node);
  if (!where.file) where = place_in_lines(deck, err->text, subject_power);
  if (!where.file) where = place_in_lines(deck, err->text, subject_function);
  where = place_of_pins(deck, err->text, where);
  vs_error plain = *err;
  char within[VS_PATH_SIZE] = "";
  if (!where.file)
    where.file = deck->files[0];
  else
    where = vs_deck_mendable(deck, where, within, sizeof within);
  vs_fail_at(err, where, "%s%s%s", plain.text, within, vs_message_remedy(plain.text));
}
