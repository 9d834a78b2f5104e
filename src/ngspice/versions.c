/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "versions.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"

/* ---- pulses ---- */

/* The arguments of PULSE(V1 V2 TD TR TF PW PER). The third to the fifth may be 0, which every
 * version takes for "as usual". */
enum { WIDTH = 5, PERIOD = 6, ARGUMENTS };

static bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == ',';
}

/* Where the arguments of a source's pulse begin, its parenthesis included if it has one; NULL: it
 * has no pulse. A source has a name and two nodes before its value; a node may be called pulse. */
static const char *find_pulse(const char *line) {
  static const char WORD[] = "pulse", BLANKS[] = " \t,";
  const char *value = line;
  for (int k = 0; k < 3; k++) {
    value += strspn(value, BLANKS);
    value += strcspn(value, BLANKS);
  }
  for (const char *at = value; (at = strcasestr(at, WORD)); at++) {
    const char *behind = at + sizeof WORD - 1;
    if (is_blank(at[-1]) && (is_blank(*behind) || *behind == '('))
      return behind + strspn(behind, " \t");
  }
  return NULL;
}

/* The end of the argument that begins there: a number, a name, or an expression. */
static const char *end_of_argument(const char *at) {
  if (*at == '\'') {
    const char *end = strchr(at + 1, '\'');
    return end ? end + 1 : at + strlen(at);
  }
  int depth = 0;
  for (; *at; at++) {
    if (*at == '{') depth++;
    if (*at == '}' && !--depth) return at + 1;
    if (!depth && (is_blank(*at) || *at == '(' || *at == ')')) return at;
  }
  return at;
}

/* True for the number 0, with or without a unit. */
static bool is_zero(const char *text, size_t size) {
  size_t digits = 0, zeros = 0, k = 0;
  for (; k < size && strchr("+-.0123456789", text[k]); k++) {
    digits += isdigit((unsigned char)text[k]) != 0;
    zeros += text[k] == '0';
  }
  return digits && digits == zeros && (k == size || isalpha((unsigned char)text[k]));
}

/* The line with all arguments of its pulse; NULL: it has them, or no pulse. */
static char *complete_pulse(const char *line, double until_s) {
  const char *begin = find_pulse(line), *at = begin;
  vs_text text = {0};
  int count = 0;
  bool lacks = false, closed = begin && *begin == '(';
  if (!begin) return NULL;
  if (closed) at++;
  vs_text_add(&text, "%.*s(", (int)(begin - line), line);
  for (;; count++) {
    at += strspn(at, " \t,");
    if (!*at || *at == ')' || (!closed && isalpha((unsigned char)*at))) break;
    const char *end = end_of_argument(at);
    if (end == at) break;
    bool none = (count == WIDTH || count == PERIOD) && is_zero(at, (size_t)(end - at));
    if (none)
      vs_text_add(&text, " %.17g", until_s);
    else
      vs_text_add(&text, " %.*s", (int)(end - at), at);
    lacks = lacks || none;
    at = end;
  }
  lacks = lacks || (count >= 2 && count < ARGUMENTS);
  for (; count < ARGUMENTS; count++) {
    if (count < WIDTH)
      vs_text_add(&text, " 0");
    else
      vs_text_add(&text, " %.17g", until_s);
  }
  vs_text_add(&text, ")%s%s", *at && *at != ')' ? " " : "", *at == ')' ? at + 1 : at);
  if (lacks) return text.text;
  vs_text_free(&text);
  return NULL;
}

void vs_versions_complete(char **lines, size_t count, double until_s) {
  for (size_t k = 1; k < count; k++) {
    char letter = lines[k][strspn(lines[k], " \t")];
    char *completed = letter && strchr("vViI", letter) ? complete_pulse(lines[k], until_s) : NULL;
    if (completed) lines[k] = completed;
  }
}

void vs_versions_free(char **lines, char *const *netlist, size_t count) {
  for (size_t k = 0; k < count; k++)
    if (lines[k] != netlist[k]) free(lines[k]);
}

/* ---- powers ---- */

/* The call of pow, or in PSpice's dialect of what is made of it; its bytes up to the base, 0: none.
 */
static size_t call_at(const char *at, bool pspice) {
  static const char *const NAMES[] = {"pow(", "pwr(", "pwrs("};
  for (size_t k = 0; k < (pspice ? 3 : 1); k++)
    if (!strncasecmp(at, NAMES[k], strlen(NAMES[k]))) return strlen(NAMES[k]);
  return 0;
}

/* The base is what a function of no negative value gives. */
static bool is_safe_base(const char *at) {
  at += strspn(at, " \t");
  return !strncasecmp(at, "abs(", 4) || !strncasecmp(at, "max(", 4);
}

/* The exponent is 2 or 4. */
static bool is_even(const char *at) {
  at += strspn(at, " \t*^");
  return (*at == '2' || *at == '4') && !isalnum((unsigned char)at[1]) && at[1] != '.';
}

bool vs_versions_differ(const char *line, bool pspice) {
  int depth = 0;
  if (!*line || !strchr("bBeEgG", *line)) return false;
  for (const char *at = line + 1; *at; at++) {
    if (*at == '{') depth++;
    if (*at == '}') depth--;
    if (depth > 0) continue;
    size_t call = isalnum((unsigned char)at[-1]) ? 0 : call_at(at, pspice);
    if (call && !is_safe_base(at + call)) return true;
    bool power = *at == '^' || (*at == '*' && at[1] == '*');
    if (power && !is_even(at)) return true;
    if (power) at += strspn(at, "*^") - 1;
  }
  return false;
}

/* ---- the end of a run ---- */

/* In parts of the largest step; ngspice's own measure, ten times its shortest step. */
static const double NEAR = 1e-10;
/* How exactly a half is a half. */
static const double ALIKE = 1e-6;

bool vs_versions_at_end(double left_s, double max_step_s) {
  return left_s < NEAR * max_step_s;
}

double vs_versions_step(vs_last_steps *ending, double left_s, double step_s) {
  bool half = fabs(2 * step_s - left_s) < ALIKE * left_s;
  ending->halves = half ? ending->halves + 1 : 0;
  return ending->halves > 1 ? left_s : step_s;
}
