/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/slips.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "lint/couplings.h"
#include "netlist/numbers.h"
#include "netlist/words.h"

/* ---- brackets ---- */

/* Deeper ones are left to ngspice. */
enum { MOST_OPEN = 256 };

static vs_status refuse_open(const vs_line *line, const char *at, vs_error *err) {
  return vs_fail_at(err, vs_line_place(line, at),
                    "this '%c' is not closed in its line; a '%c' is wanted", *at,
                    *at == '(' ? ')' : '}');
}

/* Looks at the line from s up to `end`. An expression in single quotes is looked at by itself. */
static vs_status check_brackets(const vs_line *line, const char *s, const char *end,
                                vs_error *err) {
  const char *open[MOST_OPEN];
  const bool model = vs_words_is(vs_words_at(line->text), ".model");
  size_t count = 0;
  for (; s < end; s++) {
    if (*s == '"' || *s == '\'') {
      const char *closing = strchr(s + 1, *s);
      if (!closing) break;
      vs_status status = *s == '"' ? VS_OK : check_brackets(line, s + 1, closing, err);
      if (status) return status;
      s = closing;
    } else if (*s == '{' || (*s == '(' && !model)) {
      if (count == MOST_OPEN) return VS_OK;
      open[count++] = s;
    } else if (*s == '}' || (*s == ')' && !model)) {
      if (count == 0)
        return vs_fail_at(err, vs_line_place(line, s),
                          "this '%c' is one too many: none is open; leave it out, or open it", *s);
      if ((*open[--count] == '(') != (*s == ')')) return refuse_open(line, open[count], err);
    }
  }
  return count ? refuse_open(line, open[count - 1], err) : VS_OK;
}

/* ---- values ---- */

static vs_status check_value(const vs_cards *one, vs_error *err) {
  const vs_netlist_card *card = one->card;
  if (!strchr("rcl", card->letter)) return VS_OK;
  if (*vs_words_next(vs_words_next(vs_words_next(card->name.at)))) return VS_OK;
  return vs_fail_at(err, one->lines->where,
                    "%.*s has no value; behind its two nodes its %s is wanted, or a model's name",
                    (int)card->name.n, card->name.at,
                    card->letter == 'r'   ? "resistance in ohm"
                    : card->letter == 'c' ? "capacitance in F"
                                          : "inductance in H");
}

/* ---- courses ---- */

/* Looks at the times up to the first word that is no plain number. Two that are the same are a
 * step, which ngspice takes. */
static vs_status check_course(const vs_cards *one, vs_error *err) {
  const vs_netlist_card *card = one->card;
  vs_word before = {0};
  double last = 0, time, value;
  size_t k = 2;
  if (!strchr("vi", card->letter)) return VS_OK;
  while (k < card->words && !vs_words_is(vs_cards_word(one, card, k), "pwl")) k++;
  for (k++; k + 1 < card->words; k += 2) {
    const vs_word at = vs_cards_word(one, card, k);
    if (!vs_numbers_read(at, &time)) break;
    if (!vs_numbers_read(vs_cards_word(one, card, k + 1), &value)) break;
    if (before.n && time < last)
      return vs_fail_at(err, vs_line_place(one->lines, at.at),
                        "PWL: the time %.*s stands behind %.*s; pairs TIME VALUE are wanted, of "
                        "times that rise",
                        (int)at.n, at.at, (int)before.n, before.at);
    before = at;
    last = time;
  }
  return VS_OK;
}

/* ---- polynomials ---- */

/* True for a word that is a number and no node's or source's name. Nodes may be called 1, 2, ... */
static bool is_value(vs_word w, bool of_nodes) {
  double value;
  if (*w.at == '{') return true;
  if (!vs_numbers_read(w, &value)) return false;
  return !of_nodes || strspn(w.at, "0123456789") < w.n;
}

/* Looks at "E1 p q POLY(2) a 0 b 0 0 1 1" and "F1 p q POLY(2) V1 V2 0 1 1": behind POLY(n) there
 * are n pairs of nodes, or n sources, and two coefficients at the least. */
static vs_status check_polynomial(const vs_cards *one, vs_error *err) {
  const vs_netlist_card *card = one->card;
  const bool of_nodes = strchr("eg", card->letter);
  double n;
  if (!strchr("efgh", card->letter) || !vs_words_is(vs_cards_word(one, card, 2), "poly"))
    return VS_OK;
  vs_word w = vs_cards_word(one, card, 3);
  if (!vs_numbers_read(w, &n)) return VS_OK; /* a formula */
  if (n < 1 || n > VS_WORDS_MOST || n != floor(n))
    return vs_fail_at(err, vs_line_place(one->lines, w.at),
                      "POLY(%.*s): 1, 2, or another whole number of %s is wanted", (int)w.n, w.at,
                      of_nodes ? "pairs of nodes" : "sources V...");
  const size_t most = of_nodes ? 2 * (size_t)n : (size_t)n;
  bool brackets = false;
  for (size_t k = 0; k < most; k++) {
    const char *from = w.at + w.n;
    w = vs_cards_word(one, card, 4 + k);
    const bool open = w.n && memchr(from, '(', (size_t)(w.at - from));
    if (k == 0) brackets = of_nodes && open;
    if (!w.n || (brackets && k % 2 == 0 && !open) || is_value(w, of_nodes))
      return vs_fail_at(err, w.n ? vs_line_place(one->lines, w.at) : one->lines->where,
                        "POLY(%d) wants %zu %s before its coefficients, and has %zu", (int)n, most,
                        of_nodes   ? "nodes"
                        : most > 1 ? "sources V..."
                                   : "source V...",
                        k);
  }
  const vs_word first = vs_cards_word(one, card, 4 + most);
  if (vs_cards_word(one, card, 5 + most).n) return VS_OK;
  return vs_fail_at(err, first.n ? vs_line_place(one->lines, first.at) : one->lines->where,
                    "POLY(%d) has %s coefficient behind its %zu %s, and ngspice makes a constant "
                    "of it; two or more are wanted, as 0 1 for a gain of 1",
                    (int)n, first.n ? "a single" : "no", most,
                    of_nodes   ? "nodes"
                    : most > 1 ? "sources"
                               : "source");
}

/* ---- lines ---- */

/* The parameter of that name and its value, behind so many words of the line; a name of no bytes:
 * it is not there. ngspice takes '=' for a blank, and the last of several. */
static vs_argument last_given(const char *s, int words, const char *parameter) {
  static const char ENDS[] = VS_WORDS_BETWEEN "=";
  vs_argument last = {{s, 0}, {s, 0}};
  for (; words > 0; words--) s = vs_words_next(s);
  while (*s) {
    const vs_word name = {s, strcspn(s, ENDS)};
    s += name.n + strspn(s + name.n, ENDS);
    if (vs_words_is(name, parameter)) last = (vs_argument){name, {s, strcspn(s, ENDS)}};
  }
  return last;
}

/* Looks at "T1 a 0 b 0 Z0=50 TD=10n". Without TD and F ngspice takes 0.25 ns. A line without Z0 is
 * another program's, and ngspice refuses it. */
static vs_status check_delay(const vs_line *line, vs_error *err) {
  static const char *const DELAYS[] = {"td", "f"};
  bool has_delay = false;
  double value;
  if (tolower((unsigned char)*line->text) != 't') return VS_OK;
  for (size_t k = 0; k < sizeof DELAYS / sizeof *DELAYS; k++) {
    const vs_argument a = last_given(line->text, 5, DELAYS[k]);
    has_delay = has_delay || a.name.n;
    if (a.value.n && vs_numbers_read(a.value, &value) && value <= 0)
      return vs_fail_at(err, vs_line_place(line, a.value.at),
                        "%.*s=%.*s: a line has a delay above 0, TD=..., or a frequency above 0 at "
                        "which it has NL wavelengths, F=...",
                        (int)a.name.n, a.name.at, (int)a.value.n, a.value.at);
  }
  const bool has_z0 =
      last_given(line->text, 5, "z0").name.n || last_given(line->text, 5, "zo").name.n;
  return has_z0 && !has_delay
             ? vs_fail_at(err, line->where,
                          "%.*s has no delay, and ngspice would take 0.25 ns; TD=..., or F=... "
                          "with NL=..., is wanted",
                          (int)vs_words_at(line->text).n, line->text)
             : VS_OK;
}

/* The value of n in "U1 a b 0 MODEL L=1 N=10". */
static vs_word segments_of(const char *line) {
  return last_given(line, 5, "n").value;
}

double vs_slips_segments(const char *line) {
  double value;
  if (tolower((unsigned char)*line) != 'u') return 0;
  return vs_numbers_read(segments_of(line), &value) ? value : 3; /* the fewest that ngspice makes */
}

/* ngspice looks for each segment among all others. It took 1000 of one line in 0.1 s, and 10,000 in
 * half a minute. Without n it makes ln(x)/ln(k) of them, where x is seldom beyond 1e45: 1100 with
 * k=1.1. */
static vs_status check_segments(const vs_line *line, vs_error *err) {
  enum { MOST_SEGMENTS = 1000 };
  const double least_k = 1.1;
  double value;
  if (vs_words_begin(line->text, ".model") &&
      vs_words_is(vs_words_at(vs_words_next(vs_words_next(line->text))), "urc")) {
    const vs_word k = last_given(line->text, 3, "k").value;
    return !k.n || (vs_numbers_read(k, &value) && value >= least_k)
               ? VS_OK
               : vs_fail_at(err, vs_line_place(line, k.at),
                            "k=%.*s: ngspice makes lines U of very many segments with a k near 1; "
                            "a plain number of %g or more is wanted, as 1.5",
                            (int)k.n, k.at, least_k);
  }
  if (tolower((unsigned char)*line->text) != 'u') return VS_OK;
  const vs_word n = segments_of(line->text);
  if (!n.n || (vs_numbers_read(n, &value) && value >= 1 && value <= MOST_SEGMENTS)) return VS_OK;
  return vs_fail_at(err, vs_line_place(line, n.at),
                    "n=%.*s: a line U has 1 to %d segments here, as ngspice takes very long for "
                    "more; a plain number in that range is wanted",
                    (int)n.n, n.at, MOST_SEGMENTS);
}

/* Where a line's brackets mean something up to: those around the points behind TABLE {x} do not. */
static const char *end_of_brackets(const char *text) {
  const char *end = text + strlen(text), *s = vs_words_next(vs_words_next(vs_words_next(text)));
  if (!strchr("eEgG", *text) || strncasecmp(s, "table", 5)) return end;
  const char *open = strchr(s, '{'), *close = open ? strchr(open, '}') : NULL;
  return close ? close + 1 : end;
}

vs_status vs_slips_line(const vs_cards *one, vs_error *err) {
  const vs_line *line = one->lines;
  vs_status status = check_brackets(line, line->text, end_of_brackets(line->text), err);
  if (!status) status = check_value(one, err);
  if (!status) status = vs_couplings_line(one, err);
  if (!status) status = check_polynomial(one, err);
  if (!status) status = check_delay(line, err);
  if (!status) status = check_segments(line, err);
  return status ? status : check_course(one, err);
}

/* ---- names ---- */

/* Error: a node of this line has a name under which ngspice has a number of its own. */
static vs_status check_names(const vs_cards *c, size_t number, vs_error *err) {
  static const char *const TAKEN[] = {"time", "temper"};
  const vs_netlist_card *card = &c->card[number];
  for (size_t n = 0; n < 2; n++)
    for (size_t k = 0; k < sizeof TAKEN / sizeof *TAKEN; k++) {
      const vs_word node = vs_cards_word(c, card, n);
      if (vs_words_is(node, TAKEN[k]))
        return vs_fail_at(err, vs_line_place_of(&c->lines[number], node),
                          "a node of a circuit cannot be called %s, which is ngspice's own name "
                          "for the %s; another name is wanted",
                          TAKEN[k], k ? "temperature" : "time");
    }
  return VS_OK;
}

vs_status vs_slips_names(const vs_cards *c, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->count && !status; k = vs_cards_next(c, k))
    if (c->card[k].kind == VS_CARDS_ELEMENT && strchr("rlcdvibefghswqmjz", c->card[k].letter))
      status = check_names(c, k, err);
  return status;
}

/* ---- parameters of instances ---- */

/* Returns the length of the name at s; 0: none begins there. */
static size_t name_at(const char *s) {
  size_t n = 0;
  if (isdigit((unsigned char)*s)) return 0;
  while (vs_words_goes_on(s[n])) n++;
  return n;
}

static vs_status check_instance(const vs_cards *c, size_t number, vs_error *err) {
  const vs_netlist_card *card = &c->card[number];
  const vs_line *line = &c->lines[number];
  for (size_t k = card->first; card->letter == 'x' && k < card->first + card->count; k++) {
    const vs_argument *a = &c->arguments[k];
    const int n = (int)a->name.n;
    if (n && isdigit((unsigned char)*a->name.at))
      return vs_fail_at(
          err, vs_line_place_of(line, a->name),
          "'%.*s' stands before a '=', where a parameter's name is wanted; write NAME=VALUE, in a "
          "copy of the file if it is a maker's",
          n, a->name.at);
    if (n && !a->value.n)
      return vs_fail_at(err, vs_line_place_of(line, a->name),
                        "%.*s has no value; write one behind its '=', or leave %.*s out", n,
                        a->name.at, n, a->name.at);
  }
  return VS_OK;
}

vs_status vs_slips_instances(const vs_cards *c, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->count && !status; k++)
    status = vs_error_keep(err, check_instance(c, k, err));
  return status;
}

/* ---- gains ---- */

/* The gain of "E1 a 0 b 0 gain" or "F1 a 0 Vx gain", alone or before "m=", where it is a name; its
 * length is 0 where it is none. */
static vs_word gain_of(const vs_cards *c, const vs_netlist_card *card) {
  static const char *const FORMS[] = {"poly", "value", "vol", "cur", "table", "laplace", "freq"};
  const vs_word none = {"", 0};
  if (card->kind != VS_CARDS_ELEMENT || !strchr("efgh", card->letter)) return none;
  if (strpbrk(card->name.at, "{'\"[")) return none;
  const size_t at = strchr("eg", card->letter) ? 4 : 3;
  for (size_t k = 0; k < at; k++)
    if (VS_WORDS_AMONG(vs_cards_word(c, card, k), FORMS)) return none;
  const vs_word gain = vs_cards_word(c, card, at);
  const bool last =
      card->words == at + 1 && (card->count == card->words ||
                                vs_words_is(c->arguments[card->first + card->words].name, "m"));
  return last && name_at(gain.at) == gain.n ? gain : none;
}

/* Error, with its place: the gain is a bare name that ngspice takes for 0. */
static vs_status check_gain(const vs_cards *c, size_t number, const vs_names *known,
                            vs_error *err) {
  const vs_line *line = &c->lines[number];
  const vs_word gain = gain_of(c, &c->card[number]);
  const int n = (int)gain.n;
  if (!n) return VS_OK;
  if (!vs_names_find(known, gain.at, gain.n, NULL))
    return vs_fail_at(err, vs_line_place_of(line, gain),
                      "ngspice takes the gain %.*s for 0, as no .param defines it; write a number, "
                      "or a line '.param %.*s=...'",
                      n, gain.at, n, gain.at);
  const char *comma = strchr(line->text, ',');
  if (gain.at[-1] != '(' && (!comma || comma > gain.at)) return VS_OK;
  return vs_fail_at(err, vs_line_place_of(line, gain),
                    "ngspice takes the gain %.*s for 0 beside brackets and commas; write {%.*s}", n,
                    gain.at, n, gain.at);
}

vs_status vs_slips_gains(const vs_cards *c, vs_names *known, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->n_definitions; k++)
    if (c->definition[k].kind == VS_CARDS_PARAM)
      vs_names_put(known, c->definition[k].name.at, c->definition[k].name.n, k);
  for (size_t k = 0; k < c->count && !status; k++)
    status = vs_error_keep(err, check_gain(c, k, known, err));
  return status;
}

/* ---- conditions ---- */

vs_status vs_slips_conditions(const vs_line *lines, size_t count, vs_error *err) {
  static const char *const WITHIN[] = {".else", ".elseif", ".endif"};
  size_t depth = 0;
  vs_where outermost = {0};
  for (size_t k = 0; k < count; k++) {
    const char *text = lines[k].text;
    if (*text != '.') continue;
    const vs_word word = vs_words_at(text);
    for (size_t w = 0; depth == 0 && w < sizeof WITHIN / sizeof *WITHIN; w++)
      if (vs_words_is(word, WITHIN[w]))
        return vs_fail_at(err, lines[k].where,
                          "%s stands here without an .if before it; write one, or leave this line "
                          "out",
                          WITHIN[w]);
    if (vs_words_is(word, ".if") && depth++ == 0) outermost = lines[k].where;
    if (vs_words_is(word, ".endif")) depth--;
  }
  return depth ? vs_fail_at(err, outermost,
                            "this .if has no .endif that closes it; write one behind its last line")
               : VS_OK;
}
