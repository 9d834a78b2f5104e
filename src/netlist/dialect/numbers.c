/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/numbers.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "netlist/words.h"

double vs_numbers_factor(const char *s, size_t *length) {
  static const struct {
    const char *suffix;
    double factor;
  } ROWS[] = {{"meg", 1e6},       {"mil", 25.4e-6}, {"t", 1e12},  {"g", 1e9},
              {"k", 1e3},         {"m", 1e-3},      {"u", 1e-6},  {"\xc2\xb5", 1e-6},
              {"\xce\xbc", 1e-6}, {"n", 1e-9},      {"p", 1e-12}, {"f", 1e-15}};
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    *length = strlen(ROWS[k].suffix);
    if (!strncasecmp(s, ROWS[k].suffix, *length)) return ROWS[k].factor;
  }
  *length = 0;
  return 1;
}

bool vs_numbers_read(vs_word w, double *value) {
  const size_t decimal = strspn(w.at, "-.0123456789eE+"); /* C also reads 0x10 */
  size_t length;
  if (!w.n || !strchr("-.0123456789", *w.at)) return false;
  char *end;
  *value = strtod(w.at, &end);
  if (end == w.at || end > w.at + decimal) return false;
  for (const char *c = end; c < w.at + w.n; c++)
    if (!isalpha((unsigned char)*c)) return false;
  *value *= vs_numbers_factor(end, &length);
  return true;
}

static size_t digits(const char *s) {
  return strspn(s, "0123456789");
}

/* Returns the length of a factor at s, as in 4k7, 2meg2 or 0R47; 0: there is none. An exponent is
 * no factor. */
static size_t factor(const char *s) {
  if (!strncasecmp(s, "meg", 3)) return 3;
  return *s && strchr("rRkKmMuUnNpPfFgGtT", *s) ? 1 : 0;
}

/* A number at s whose factor stands in the place of its point, as 4k7. *n is its length. */
static bool has_factor_as_point(const char *s, size_t *n) {
  size_t before = digits(s), f = factor(s + before), after = digits(s + before + f);
  *n = before + f + after;
  return before && f && after && !vs_words_goes_on(s[*n]) && s[*n] != '.';
}

static vs_status refuse_factor(const vs_line *line, const char *at, size_t n, vs_error *err) {
  size_t before = digits(at), f = factor(at + before);
  bool ohms = f == 1 && tolower((unsigned char)at[before]) == 'r';
  return vs_fail_at(err, vs_line_place(line, at),
                    "'%.*s': ngspice reads %.*s and leaves the rest out; write %.*s.%.*s%.*s",
                    (int)n, at, (int)(before + (ohms ? 0 : f)), at, (int)before, at,
                    (int)(n - before - f), at + before + f, ohms ? 0 : (int)f, at + before);
}

/* Returns how much of the number at s ngspice reads: digits, a point, an exponent and letters. *n
 * is how long the whole word is; where that is more, the rest is left out, as in 0x10 or 4k7ohm. */
static size_t read_of(const char *s, size_t *n) {
  size_t k = digits(s);
  if (s[k] == '.') k += 1 + digits(s + k + 1);
  if (tolower((unsigned char)s[k]) == 'e') {
    size_t sign = strchr("+-", s[k + 1]) && s[k + 1] ? 1 : 0, power = digits(s + k + 1 + sign);
    if (power) k += 1 + sign + power;
  }
  while (isalpha((unsigned char)s[k])) k++;
  *n = k;
  while (vs_words_goes_on(s[*n]) || s[*n] == '.') ++*n;
  return k;
}

/* What is wrong with a number beyond what a computer's number can be, as 1e400, which ngspice takes
 * for infinity, and 1e-400, which it takes for 0. n is the length of the word. NULL: nothing. */
static const char *beyond(const char *s, size_t n) {
  char *end;
  size_t length;
  if (!memchr(s, 'e', n) && !memchr(s, 'E', n)) return NULL;
  const double number = strtod(s, &end), value = number * vs_numbers_factor(end, &length);
  const char *of_number = vs_text_out_of_range(s);
  if (!isfinite(value))
    return "is too large: ngspice takes it for infinity; a number below 1e308 is wanted";
  if (of_number || (number != 0 && fabs(value) < DBL_MIN))
    return "is too small: ngspice takes it for 0; 0, or a number above 1e-300, is wanted";
  return NULL;
}

/* Looks for numbers such as 4k7 from `from` on. What stands in v() and i() are names. */
static vs_status check_factors(const vs_line *line, const char *from, vs_error *err) {
  for (const char *s = from; *s; s++) {
    size_t n = 0;
    bool begins = s == line->text || (!vs_words_goes_on(s[-1]) && !strchr(".#$:", s[-1]));
    if (begins && strchr("vViI", *s) && s[1] == '(') {
      s += strcspn(s, ")");
      if (!*s) break;
    } else if (begins && isdigit((unsigned char)*s) && has_factor_as_point(s, &n))
      return refuse_factor(line, s, n, err);
    else if (begins && isdigit((unsigned char)*s) && read_of(s, &n) < n)
      return vs_fail_at(err, vs_line_place(line, s),
                        "'%.*s' is no number: ngspice reads %.*s and leaves the rest out", (int)n,
                        s, (int)read_of(s, &n), s);
    else if (begins && isdigit((unsigned char)s[*s == '.']) && read_of(s, &n) && beyond(s, n))
      return vs_fail_at(err, vs_line_place(line, s), "'%.*s' %s", (int)n, s, beyond(s, n));
  }
  return VS_OK;
}

static bool has_two_points(vs_word w) {
  int points = 0;
  for (size_t k = 0; k < w.n && strchr("+-0123456789.", w.at[k]); k++) points += w.at[k] == '.';
  return points > 1;
}

/* True for a unit, with or without its factor: k, kohm, uF, ohm. */
static bool is_unit(vs_word w) {
  static const char *const UNITS[] = {"",  "ohm", "ohms", "\xce\xa9", "\xe2\x84\xa6",
                                      "f", "h",   "v",    "a"};
  size_t f = factor(w.at);
  for (size_t skip = 0; skip <= f && w.n; skip += f ? f : 1)
    for (size_t k = 0; k < sizeof UNITS / sizeof *UNITS; k++)
      if (w.n == skip + strlen(UNITS[k]) && !strncasecmp(w.at + skip, UNITS[k], w.n - skip))
        return true;
  return false;
}

/* Returns the length of a number with a comma at s, as 1,5 or 4,7k; 0: there is none, or a name
 * follows the comma. */
static size_t decimal_comma(const char *s) {
  size_t n = strspn(s, "+-"), before = digits(s + n);
  n += before;
  size_t after = s[n] == ',' ? digits(s + n + 1) : 0;
  if (!before || !after) return 0;
  n += 1 + after;
  if (s[n] == '.') n += 1 + digits(s + n + 1);
  const size_t exponent = tolower((unsigned char)s[n]) == 'e' ? 1 + strspn(s + n + 1, "+-") : 0;
  if (exponent && digits(s + n + exponent)) n += exponent + digits(s + n + exponent);
  while (isalpha((unsigned char)s[n])) n++;
  return vs_words_goes_on(s[n]) || vs_words_is_given(s + n) ? 0 : n;
}

/* A value of its own, not in an expression. */
static vs_status check_value(const vs_line *line, vs_word w, vs_error *err) {
  int n = (int)w.n;
  if (w.n && decimal_comma(w.at) == w.n) {
    size_t whole = strcspn(w.at, ",");
    return vs_fail_at(err, vs_line_place(line, w.at),
                      "'%.*s': ngspice reads %.*s and leaves the rest out; the decimal sign is a "
                      "point",
                      n, w.at, (int)whole, w.at);
  }
  return has_two_points(w) ? vs_fail_at(err, vs_line_place(line, w.at),
                                        "'%.*s': a number has one point; ngspice leaves out what "
                                        "is behind the second",
                                        n, w.at)
                           : VS_OK;
}

/* True for a line whose values "NAME=..." are numbers of their own. Transistors and transmission
 * lines have lists with commas. */
static bool has_plain_values(const char *text) {
  static const char *const WORDS[] = {".model", ".param", ".subckt", ".ic", ".nodeset"};
  return VS_WORDS_AMONG(vs_words_at(text), WORDS) || strchr("rRcClLxX", *text);
}

/* Looks at the values "NAME=..." that stand in no brackets, but for those of a .model. The two
 * coefficients of "tc=1m,2u" are a list. */
static vs_status check_commas(const vs_line *line, vs_error *err) {
  const char *text = line->text;
  const bool model = vs_words_begin(text, ".model");
  int depth = 0;
  if (!strchr(text, ',') || !has_plain_values(text)) return VS_OK;
  for (const char *s = text; *s; s++) {
    if (*s == '"' || *s == '\'') {
      s = strchr(s + 1, *s);
      if (!s) break;
    }
    depth += strchr(model ? "{[" : "{[(", *s) != NULL;
    depth -= strchr(model ? "}]" : "}])", *s) != NULL;
    if (*s != '=' || depth) continue;
    const char *value = s + 1 + strspn(s + 1, " \t"), *end = s;
    const size_t n = decimal_comma(value);
    while (end > text && strchr(" \t", end[-1])) end--;
    const bool list = end - text > 2 && !strncasecmp(end - 2, "tc", 2);
    if (n && !list)
      return vs_fail_at(err, vs_line_place(line, value),
                        "'%.*s': a decimal point is wanted in the place of the comma", (int)n,
                        value);
  }
  return VS_OK;
}

/* True for a resistance such as 1M or 2.2MOhm. */
static bool is_milliohm(vs_word w) {
  size_t n = strspn(w.at, "0123456789.");
  if (n == 0 || n >= w.n || w.at[n] != 'M') return false;
  vs_word unit = {w.at + n + 1, w.n - n - 1};
  return unit.n == 0 || vs_words_is(unit, "ohm") || vs_words_is(unit, "ohms") ||
         vs_words_is(unit, "r");
}

/* Tells of a value such as 1M or {1M} in a line .param. */
static void tell_of_milli(const vs_line *line, vs_tally *tally) {
  if (!vs_words_begin(line->text, ".param")) return;
  for (const char *s = line->text; (s = strchr(s, '='));) {
    s++;
    s += strspn(s, " \t{'");
    const vs_word w = {s, strcspn(s, " \t,}'")};
    if (is_milliohm(w))
      vs_tally_add(tally,
                   "a number in M of a .param is one in milli, as SPICE knows no capitals; write "
                   "Meg for mega, or m",
                   vs_line_place(line, s));
  }
}

/* True for a capacitance such as 1F. */
static bool is_femto(vs_word w) {
  size_t n = strspn(w.at, "0123456789.");
  return n > 0 && n + 1 == w.n && w.at[n] == 'F';
}

/* Tells of a value of R, C or L that is seldom meant. */
static void tell_of_size(const vs_line *line, vs_word w, vs_tally *tally) {
  const int letter = tolower((unsigned char)*line->text);
  const char *what = NULL;
  double value;
  if (!vs_numbers_read(w, &value)) return;
  if (value < 0)
    what = letter == 'r' ? "a resistance below 0 is a source of energy; leave the sign out, unless "
                           "a model wants it so"
           : letter == 'c' ? "a capacitance below 0 is a source of energy; leave the sign out, "
                             "unless a model wants it so"
                           : "an inductance below 0 is a source of energy; leave the sign out, "
                             "unless a model wants it so";
  else if (letter == 'r' && value == 0)
    what = "ngspice has no resistance of 0 ohm and takes 1 mohm in its place; write a small one, "
           "or a source V of 0 V";
  else if (letter == 'c' && value > 1)
    what = "a capacitance above 1 F; u behind the number makes it microfarad, n nanofarad";
  if (what) vs_tally_add(tally, what, vs_line_place(line, w.at));
}

/* True where a second number follows a value, as in "100n 50V" or "5k 1%". ngspice takes the last
 * one for the value. */
static bool is_second_number(vs_word value, vs_word next) {
  const char *first = value.at + strspn(value.at, "+-.");
  return (isdigit((unsigned char)*first) || strchr("{'", *first)) &&
         isdigit((unsigned char)next.at[strspn(next.at, "+-.")]) && !memchr(next.at, '=', next.n);
}

/* R, C, L and K: "NAME node node VALUE". */
static vs_status check_element(const vs_line *line, const vs_word *w, size_t count, vs_tally *tally,
                               vs_error *err) {
  if (count < 4) return VS_OK;
  vs_status status = check_value(line, w[3], err);
  if (!status && count > 4 && isdigit((unsigned char)*w[3].at) && is_unit(w[4]) &&
      !strchr(w[4].at, '='))
    status = vs_fail_at(err, vs_line_place(line, w[4].at),
                        "'%.*s %.*s': a unit stands at its number without a blank: %.*s%.*s",
                        (int)w[3].n, w[3].at, (int)w[4].n, w[4].at, (int)w[3].n, w[3].at,
                        (int)w[4].n, w[4].at);
  if (!status && count > 4 && is_second_number(w[3], w[4]))
    status = vs_fail_at(err, vs_line_place(line, w[4].at),
                        "'%.*s %.*s': ngspice takes the second number for the value; leave it out",
                        (int)w[3].n, w[3].at, (int)w[4].n, w[4].at);
  if (!status && tolower((unsigned char)*line->text) != 'k') tell_of_size(line, w[3], tally);
  if (!status && tolower((unsigned char)*line->text) == 'r' && is_milliohm(w[3]))
    vs_tally_add(tally,
                 "a resistance in M is one in milliohm, as SPICE knows no capitals; write Meg for "
                 "megohm, or m",
                 vs_line_place(line, w[3].at));
  if (!status && tolower((unsigned char)*line->text) == 'c' && is_femto(w[3]))
    vs_tally_add(tally,
                 "a capacitance in F is one in femtofarad, as F is SPICE's factor of 1e-15; leave "
                 "the F out for farad, or write f",
                 vs_line_place(line, w[3].at));
  return status;
}

/* Sources whose arguments ngspice has changed: V and I with SFFM(...) or AM(...). */
static void tell_of_modulation(const vs_line *line, const vs_word *w, size_t count,
                               vs_tally *tally) {
  for (size_t k = 3; k < count; k++) {
    vs_word name = {w[k].at, strcspn(w[k].at, "( \t")};
    if (vs_words_is(name, "sffm") || vs_words_is(name, "am"))
      vs_tally_add(tally,
                   "the arguments of SFFM and AM mean other things in ngspice 39, 44 and 46; a B "
                   "source with sin(...) of time means the same in each",
                   vs_line_place(line, w[k].at));
  }
}

/* Returns where a line's values begin; NULL: it has none. */
static const char *values_of(const char *text, const vs_word *w, size_t count) {
  if (*text == '.') {
    if (vs_words_is(w[0], ".model")) return count > 2 ? strpbrk(w[2].at, "=(") : NULL;
    return strpbrk(text, "={");
  }
  if (strchr("rRcClLkKvViIbBeEgGfFhH", *text)) return count > 3 ? w[3].at : NULL;
  return strchr(text, '=');
}

vs_status vs_numbers_check(const vs_line *line, vs_tally *tally, vs_error *err) {
  vs_word w[VS_WORDS_MOST];
  const char *text = line->text;
  size_t count = vs_words_split(text, w);
  vs_status status = VS_OK;
  if (count == 0) return VS_OK;
  if (strchr("rRcClLkK", *text)) status = check_element(line, w, count, tally, err);
  if (strchr("vViI", *text) && count == 4) status = check_value(line, w[3], err);
  if (strchr("vViI", *text)) tell_of_modulation(line, w, count, tally);
  if (!status) status = check_commas(line, err);
  if (status) return status;
  tell_of_milli(line, tally);
  const char *values = values_of(text, w, count);
  return values ? check_factors(line, values, err) : VS_OK;
}
