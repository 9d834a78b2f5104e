/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "slips/slips.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dialect/numbers.h"
#include "dialect/words.h"
#include "slips/parameters.h"

/* What ngspice takes for the space between words. */
static const char BETWEEN[] = " \t(),";

static const char *next_word(const char *s) {
  s += strcspn(s, BETWEEN);
  return s + strspn(s, BETWEEN);
}

static bool is_statement(const char *text, const char *word) {
  size_t n = strlen(word);
  return !strncasecmp(text, word, n) && (!text[n] || strchr(BETWEEN, text[n]));
}

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
  const bool model = is_statement(line->text, ".model");
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
  if (*next_word(next_word(next_word(line->text)))) return VS_OK;
  return vs_fail_at(err, line->where,
                    "%.*s has no value; behind its two nodes its %s is wanted, or a model's name",
                    (int)strcspn(line->text, BETWEEN), line->text,
                    letter == 'r'   ? "resistance in ohm"
                    : letter == 'c' ? "capacitance in F"
                                    : "inductance in H");
}

/* ---- numbers ---- */

/* Reads a plain number as ngspice does: 1, -2.5e-3, 10us. False: it is anything else. */
static bool read_number(const char *s, size_t n, double *value) {
  size_t decimal = strspn(s, "-.0123456789eE+"), length; /* C also reads 0x10 */
  if (!strchr("-.0123456789", *s)) return false;
  char *end;
  *value = strtod(s, &end);
  if (end == s || end > s + decimal) return false;
  for (const char *c = end; c < s + n; c++)
    if (!isalpha((unsigned char)*c)) return false;
  *value *= vs_numbers_factor(end, &length);
  return true;
}

/* ---- courses ---- */

/* Looks at the times up to the first word that is no plain number. Two that are the same are a
 * step, which ngspice takes. */
static vs_status check_course(const vs_line *line, vs_error *err) {
  if (!strchr("vViI", *line->text)) return VS_OK;
  const char *s = next_word(next_word(next_word(line->text)));
  while (*s && !(!strncasecmp(s, "pwl", 3) && strchr(BETWEEN, s[3]))) s = next_word(s);
  double last = 0, time, value;
  for (const char *from = NULL, *at = *s ? next_word(s) : s; *at; at = next_word(next_word(at))) {
    const size_t n = strcspn(at, BETWEEN);
    const char *second = next_word(at);
    if (!read_number(at, n, &time)) break;
    if (!read_number(second, strcspn(second, BETWEEN), &value)) break;
    if (from && time < last)
      return vs_fail_at(err, vs_line_place(line, at),
                        "PWL: the time %.*s stands behind %.*s; pairs TIME VALUE are wanted, of "
                        "times that rise",
                        (int)n, at, (int)strcspn(from, BETWEEN), from);
    from = at;
    last = time;
  }
  return VS_OK;
}

/* ---- couplings ---- */

/* Looks at "K1 La Lb 0.9". A name with a point may be an inductor within a subcircuit. */
static vs_status check_coupling(const vs_line *line, vs_error *err) {
  const char *w[VS_WORDS_MOST];
  double factor;
  int n = 0;
  if (tolower((unsigned char)*line->text) != 'k') return VS_OK;
  for (const char *s = line->text; *s && n < VS_WORDS_MOST; s = next_word(s)) w[n++] = s;
  for (int k = 1; k < n && k <= 2 && n > 3; k++) {
    const int length = (int)strcspn(w[k], BETWEEN);
    if (isalpha((unsigned char)*w[k]) && tolower((unsigned char)*w[k]) != 'l' &&
        !memchr(w[k], '.', (size_t)length))
      return vs_fail_at(err, vs_line_place(line, w[k]),
                        "%.*s is no inductor; a K couples inductors, the names of which begin "
                        "with L",
                        length, w[k]);
  }
  if (n == 3 && tolower((unsigned char)*w[1]) == 'l' && tolower((unsigned char)*w[2]) == 'l')
    return vs_fail_at(err, line->where,
                      "%.*s has no coupling; behind its inductors a factor up to 1 is wanted",
                      (int)strcspn(w[0], BETWEEN), w[0]);
  for (int k = 2; k < n - 1; k++)
    for (int m = 1; m < k; m++) {
      const size_t length = strcspn(w[k], BETWEEN);
      if (length != strcspn(w[m], BETWEEN) || strncasecmp(w[k], w[m], length)) continue;
      return vs_fail_at(err, vs_line_place(line, w[k]),
                        "%.*s is coupled with itself; the names of two inductors are wanted",
                        (int)length, w[k]);
    }
  if (n < 4) return VS_OK;
  const size_t length = strcspn(w[n - 1], BETWEEN);
  const char *equals = memchr(w[n - 1], '=', length), *at = equals ? equals + 1 : w[n - 1];
  const size_t rest = length - (size_t)(at - w[n - 1]);
  return read_number(at, rest, &factor) && (factor > 1 || factor < -1)
             ? vs_fail_at(err, vs_line_place(line, at),
                          "a coupling of %.*s is not possible; -1 to 1 is wanted", (int)rest, at)
             : VS_OK;
}

/* ---- lines ---- */

/* Looks at "T1 a 0 b 0 Z0=50 TD=10n". Without TD and F ngspice takes 0.25 ns. A line without Z0 is
 * another program's, and ngspice refuses it. */
static vs_status check_delay(const vs_line *line, vs_error *err) {
  static const char ENDS[] = " \t(),=";
  bool has_z0 = false, has_delay = false;
  const char *s = line->text;
  double value;
  if (tolower((unsigned char)*s) != 't') return VS_OK;
  for (int nodes = 0; nodes < 5; nodes++) s = next_word(s);
  while (*s) {
    const size_t n = strcspn(s, ENDS);
    const vs_word name = {s, n};
    s += n + strspn(s + n, ENDS);
    has_z0 = has_z0 || vs_words_is(name, "z0") || vs_words_is(name, "zo");
    if (!vs_words_is(name, "td") && !vs_words_is(name, "f")) continue;
    has_delay = true;
    const size_t length = strcspn(s, ENDS);
    if (read_number(s, length, &value) && value <= 0)
      return vs_fail_at(err, vs_line_place(line, s),
                        "%.*s=%.*s: a line has a delay above 0, TD=..., or a frequency above 0 at "
                        "which it has NL wavelengths, F=...",
                        (int)n, name.at, (int)length, s);
  }
  return has_z0 && !has_delay
             ? vs_fail_at(err, line->where,
                          "%.*s has no delay, and ngspice would take 0.25 ns; TD=..., or F=... "
                          "with NL=..., is wanted",
                          (int)strcspn(line->text, BETWEEN), line->text)
             : VS_OK;
}

vs_status vs_slips_line(const vs_line *line, vs_error *err) {
  vs_status status = check_brackets(line, line->text, line->text + strlen(line->text), err);
  if (!status) status = check_value(line, err);
  if (!status) status = vs_parameters_check(line, err);
  if (!status) status = check_coupling(line, err);
  if (!status) status = check_delay(line, err);
  return status ? status : check_course(line, err);
}
