/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "slips/slips.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dialect/numbers.h"
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

vs_status vs_slips_line(const vs_line *line, vs_error *err) {
  vs_status status = check_brackets(line, line->text, line->text + strlen(line->text), err);
  if (!status) status = check_value(line, err);
  if (!status) status = vs_parameters_check(line, err);
  return status ? status : check_course(line, err);
}

vs_status vs_slips_conditions(const vs_line *lines, size_t count, vs_error *err) {
  size_t depth = 0;
  vs_where outermost = {0};
  for (size_t k = 0; k < count; k++) {
    if (*lines[k].text != '.') continue;
    if (is_statement(lines[k].text, ".if") && depth++ == 0) outermost = lines[k].where;
    if (is_statement(lines[k].text, ".endif") && depth > 0) depth--;
  }
  return depth ? vs_fail_at(err, outermost,
                            "this .if has no .endif that closes it; write one behind its last line")
               : VS_OK;
}
