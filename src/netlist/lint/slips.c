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

static vs_status check_value(const vs_line *line, vs_error *err) {
  const int letter = tolower((unsigned char)*line->text);
  if (letter != 'r' && letter != 'c' && letter != 'l') return VS_OK;
  if (*vs_words_next(vs_words_next(vs_words_next(line->text)))) return VS_OK;
  return vs_fail_at(err, line->where,
                    "%.*s has no value; behind its two nodes its %s is wanted, or a model's name",
                    (int)vs_words_at(line->text).n, line->text,
                    letter == 'r'   ? "resistance in ohm"
                    : letter == 'c' ? "capacitance in F"
                                    : "inductance in H");
}

/* ---- courses ---- */

/* Looks at the times up to the first word that is no plain number. Two that are the same are a
 * step, which ngspice takes. */
static vs_status check_course(const vs_line *line, vs_error *err) {
  if (!strchr("vViI", *line->text)) return VS_OK;
  const char *s = vs_words_next(vs_words_next(vs_words_next(line->text)));
  while (*s && !vs_words_is(vs_words_at(s), "pwl")) s = vs_words_next(s);
  double last = 0, time, value;
  for (const char *from = NULL, *at = *s ? vs_words_next(s) : s; *at;
       at = vs_words_next(vs_words_next(at))) {
    const size_t n = vs_words_at(at).n;
    const char *second = vs_words_next(at);
    if (!vs_numbers_read((vs_word){at, n}, &time)) break;
    if (!vs_numbers_read(vs_words_at(second), &value)) break;
    if (from && time < last)
      return vs_fail_at(err, vs_line_place(line, at),
                        "PWL: the time %.*s stands behind %.*s; pairs TIME VALUE are wanted, of "
                        "times that rise",
                        (int)n, at, (int)vs_words_at(from).n, from);
    from = at;
    last = time;
  }
  return VS_OK;
}

/* ---- polynomials ---- */

/* The next word behind s that is no bracket, as ngspice cuts a line; empty: there is none. */
static vs_word word_behind(const char *s) {
  s += strspn(s, VS_WORDS_BETWEEN);
  if (*s != '{') return vs_words_at(s);
  return (vs_word){s, strcspn(s, "}") + (strchr(s, '}') != NULL)};
}

/* True for a word that is a number and no node's or source's name. Nodes may be called 1, 2, ... */
static bool is_value(vs_word w, bool of_nodes) {
  double value;
  if (*w.at == '{') return true;
  if (!vs_numbers_read(w, &value)) return false;
  return !of_nodes || strspn(w.at, "0123456789") < w.n;
}

/* Looks at "E1 p q POLY(2) a 0 b 0 0 1 1" and "F1 p q POLY(2) V1 V2 0 1 1": behind POLY(n) there
 * are n pairs of nodes, or n sources, and two coefficients at the least. */
static vs_status check_polynomial(const vs_line *line, vs_error *err) {
  const int letter = tolower((unsigned char)*line->text);
  if (!*line->text || !strchr("efgh", letter)) return VS_OK;
  const bool of_nodes = letter == 'e' || letter == 'g';
  const char *at = vs_words_next(vs_words_next(vs_words_next(line->text)));
  if (!vs_words_is(vs_words_at(at), "poly")) return VS_OK;
  vs_word w = word_behind(at + 4);
  double n;
  if (!vs_numbers_read(w, &n)) return VS_OK; /* a formula */
  if (n < 1 || n > VS_WORDS_MOST || n != floor(n))
    return vs_fail_at(err, vs_line_place(line, w.at),
                      "POLY(%.*s): 1, 2, or another whole number of %s is wanted", (int)w.n, w.at,
                      of_nodes ? "pairs of nodes" : "sources V...");
  const int most = of_nodes ? 2 * (int)n : (int)n;
  const char *s = w.at + w.n + strspn(w.at + w.n, " \t)");
  const bool brackets = of_nodes && *s == '(';
  for (int k = 0; k < most; k++) {
    const bool opens = brackets && k % 2 == 0;
    const bool open = memchr(s, '(', strspn(s, VS_WORDS_BETWEEN)) != NULL;
    w = word_behind(s);
    if (!w.n || (opens && !open) || is_value(w, of_nodes))
      return vs_fail_at(err, w.n ? vs_line_place(line, w.at) : line->where,
                        "POLY(%d) wants %d %s before its coefficients, and has %d", (int)n, most,
                        of_nodes   ? "nodes"
                        : most > 1 ? "sources V..."
                                   : "source V...",
                        k);
    s = w.at + w.n;
  }
  const vs_word first = word_behind(s);
  if (first.n && word_behind(first.at + first.n).n) return VS_OK;
  return vs_fail_at(err, first.n ? vs_line_place(line, first.at) : line->where,
                    "POLY(%d) has %s coefficient behind its %d %s, and ngspice makes a constant of "
                    "it; two or more are wanted, as 0 1 for a gain of 1",
                    (int)n, first.n ? "a single" : "no", most,
                    of_nodes   ? "nodes"
                    : most > 1 ? "sources"
                               : "source");
}

/* ---- lines ---- */

/* Looks at "T1 a 0 b 0 Z0=50 TD=10n". Without TD and F ngspice takes 0.25 ns. A line without Z0 is
 * another program's, and ngspice refuses it. */
static vs_status check_delay(const vs_line *line, vs_error *err) {
  static const char ENDS[] = VS_WORDS_BETWEEN "=";
  bool has_z0 = false, has_delay = false;
  const char *s = line->text;
  double value;
  if (tolower((unsigned char)*s) != 't') return VS_OK;
  for (int nodes = 0; nodes < 5; nodes++) s = vs_words_next(s);
  while (*s) {
    const size_t n = strcspn(s, ENDS);
    const vs_word name = {s, n};
    s += n + strspn(s + n, ENDS);
    has_z0 = has_z0 || vs_words_is(name, "z0") || vs_words_is(name, "zo");
    if (!vs_words_is(name, "td") && !vs_words_is(name, "f")) continue;
    has_delay = true;
    const size_t length = strcspn(s, ENDS);
    if (vs_numbers_read((vs_word){s, length}, &value) && value <= 0)
      return vs_fail_at(err, vs_line_place(line, s),
                        "%.*s=%.*s: a line has a delay above 0, TD=..., or a frequency above 0 at "
                        "which it has NL wavelengths, F=...",
                        (int)n, name.at, (int)length, s);
  }
  return has_z0 && !has_delay
             ? vs_fail_at(err, line->where,
                          "%.*s has no delay, and ngspice would take 0.25 ns; TD=..., or F=... "
                          "with NL=..., is wanted",
                          (int)vs_words_at(line->text).n, line->text)
             : VS_OK;
}

/* The value of a parameter, behind so many words of the line; no bytes: it is not there. ngspice
 * takes '=' for a blank, and the last of several. */
static vs_word value_behind(const char *s, int words, const char *parameter) {
  static const char ENDS[] = VS_WORDS_BETWEEN "=";
  vs_word last = {s, 0};
  for (; words > 0; words--) s = vs_words_next(s);
  while (*s) {
    const vs_word name = {s, strcspn(s, ENDS)};
    s += name.n + strspn(s + name.n, ENDS);
    if (vs_words_is(name, parameter)) last = (vs_word){s, strcspn(s, ENDS)};
  }
  return last;
}

/* The value of n in "U1 a b 0 MODEL L=1 N=10". */
static vs_word segments_of(const char *line) {
  return value_behind(line, 5, "n");
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
    const vs_word k = value_behind(line->text, 3, "k");
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

vs_status vs_slips_line(const vs_line *line, vs_error *err) {
  vs_status status = check_brackets(line, line->text, end_of_brackets(line->text), err);
  if (!status) status = check_value(line, err);
  if (!status) status = vs_couplings_line(line, err);
  if (!status) status = check_polynomial(line, err);
  if (!status) status = check_delay(line, err);
  if (!status) status = check_segments(line, err);
  return status ? status : check_course(line, err);
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

/* ---- conditions ---- */

vs_status vs_slips_conditions(const vs_line *lines, size_t count, vs_error *err) {
  static const char *const WITHIN[] = {".else", ".elseif", ".endif"};
  size_t depth = 0;
  vs_where outermost = {0};
  for (size_t k = 0; k < count; k++) {
    const char *text = lines[k].text;
    if (*text != '.') continue;
    for (size_t w = 0; depth == 0 && w < sizeof WITHIN / sizeof *WITHIN; w++)
      if (vs_words_is(vs_words_at(text), WITHIN[w]))
        return vs_fail_at(err, lines[k].where,
                          "%s stands here without an .if before it; write one, or leave this line "
                          "out",
                          WITHIN[w]);
    if (vs_words_is(vs_words_at(text), ".if") && depth++ == 0) outermost = lines[k].where;
    if (vs_words_is(vs_words_at(text), ".endif")) depth--;
  }
  return depth ? vs_fail_at(err, outermost,
                            "this .if has no .endif that closes it; write one behind its last line")
               : VS_OK;
}
