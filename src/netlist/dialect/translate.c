/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dialect/translate.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "dialect/elements.h"
#include "dialect/functions.h"
#include "dialect/models.h"
#include "netlist/numbers.h"
#include "netlist/words.h"

/* Commas between assignments, "a=1, b=2", which ngspice never comes back from, become blanks. */
static void rewrite_commas(vs_rewriting *r) {
  int depth = 0;
  for (char *s = r->text.text; *s; s++) {
    depth += (strchr("({", *s) != NULL) - (strchr(")}", *s) != NULL);
    if (*s != ',' || depth) continue;
    const char *next = s + 1 + strspn(s + 1, " \t");
    if (!isalpha((unsigned char)*next)) continue;
    while (vs_words_goes_on(*next)) next++;
    next += strspn(next, " \t");
    if (*next == '=' && next[1] != '=') *s = ' ';
  }
}

/* SIN(offset amplitude frequency delay damping phase cycles): ngspice takes no notice of cycles. */
static vs_status check_sine(const vs_rewriting *r) {
  const char *sine = strcasestr(r->text.text, "sin"), *open = sine ? strchr(sine, '(') : NULL;
  vs_word w[VS_WORDS_MOST];
  if (!strchr("vViI", *r->text.text) || !open || sine[-1] > ' ') return VS_OK;
  vs_text inner = {0};
  vs_text_add(&inner, "%.*s", (int)strcspn(open + 1, ")"), open + 1);
  for (char *s = inner.text; *s; s++)
    if (*s == ',') *s = ' ';
  size_t count = vs_words_split(inner.text, w);
  vs_text_free(&inner);
  return count < 7 ? VS_OK
                   : vs_fail_at(r->err, vs_rewriting_place(r, sine, 3),
                                "SIN has six numbers in ngspice; the seventh, LTspice's number of "
                                "cycles, it leaves out: write a B source with u(time)");
}

/* PWL(0 0 1m 0 +1u 5): LTspice counts a time with a plus sign from the one before it, ngspice from
 * t = 0. */
static vs_status check_points(const vs_rewriting *r) {
  const char *pwl = strcasestr(r->text.text, "pwl"), *open = pwl ? strchr(pwl, '(') : NULL;
  if (!strchr("vViI", *r->text.text) || !open || pwl[-1] > ' ') return VS_OK;
  int n = 0; /* which number it is: times are those of even n */
  for (const char *s = open + 1; *(s += strspn(s, " \t,")) && *s != ')'; n++) {
    size_t length = strcspn(s, " \t,)");
    if (n > 0 && n % 2 == 0 && *s == '+')
      return vs_fail_at(r->err, vs_rewriting_place(r, s, length),
                        "%.*s: a time from the point before, LTspice's, which ngspice counts from "
                        "t = 0; write times from t = 0",
                        (int)length, s);
    s += length;
  }
  return VS_OK;
}

/* True where the n-th number of a course is 0 or not there, so that ngspice takes its own. */
static bool is_left_out(const vs_word *w, size_t count, size_t n) {
  double value;
  return count <= n || (vs_numbers_read(w[n], &value) && value == 0);
}

/* PULSE(low high delay rise fall width period): for a rise or fall of 0, or none, ngspice takes the
 * step of its .tran, which is the run's largest one here. Without a width nothing falls. */
static void tell_of_edges(vs_rewriting *r) {
  enum { RISE = 3, FALL, WIDTH, MOST };
  vs_word w[MOST];
  size_t count = 0;
  const char *pulse = r->text.text;
  if (!*pulse || !strchr("vViI", *pulse)) return;
  for (int n = 0; n < 3; n++) pulse = vs_words_next(pulse);
  while (*pulse && !vs_words_is(vs_words_at(pulse), "pulse")) pulse = vs_words_next(pulse);
  if (!*pulse) return;
  for (const char *s = pulse + 5; count < MOST; s += w[count++].n) {
    s += strspn(s, " \t,(");
    if (!*s || *s == ')') break;
    const char *end = strchr("{'", *s) ? strchr(s + 1, *s == '{' ? '}' : '\'') : NULL;
    w[count] = end ? (vs_word){s, (size_t)(end - s) + 1} : vs_words_at(s);
  }
  if (is_left_out(w, count, RISE) || (!is_left_out(w, count, WIDTH) && is_left_out(w, count, FALL)))
    vs_tally_add(r->tally,
                 "an edge of PULSE that is 0 or left out lasts as long as the run's largest step, "
                 "which goes with run.tolerance; write its time, as 10n",
                 vs_rewriting_place(r, pulse, 5));
}

vs_status vs_translate(vs_rewriting *r) {
  vs_status status = vs_numbers_check(r->line, r->tally, r->err);
  if (status) return status;
  vs_text_add(&r->text, "%s", r->line->text);
  if (!strncasecmp(r->text.text, ".param", 6) || !strncasecmp(r->text.text, ".subckt", 7) ||
      tolower((unsigned char)*r->text.text) == 'x')
    rewrite_commas(r);
  status = check_sine(r);
  if (!status) status = check_points(r);
  if (!status) tell_of_edges(r);
  if (!status) status = vs_models_rewrite(r);
  if (!status) status = vs_elements_rewrite(r);
  if (!status) status = vs_functions_rewrite(r);
  return status;
}

/* ---- names of subcircuits ---- */

/* The second word of a line: a subcircuit's name in ".subckt NAME ..." and ".ends NAME". */
static vs_word second_word(const char *line) {
  vs_word w[VS_WORDS_MOST];
  return vs_words_split(line, w) > 1 ? w[1] : (vs_word){line, 0};
}

/* The subcircuit of an instance: the last word before its parameters. */
static vs_word instance_of(const char *line) {
  vs_word w[VS_WORDS_MOST], found = {line, 0};
  size_t count = vs_words_split(line, w);
  for (size_t k = 1; k < count; k++) {
    bool assigns = memchr(w[k].at, '=', w[k].n) || (k + 1 < count && *w[k + 1].at == '=');
    if (assigns || !strncasecmp(w[k].at, "params:", 7)) break;
    found = w[k];
  }
  return found;
}

static bool is_plain(vs_word name) {
  for (size_t k = 0; k < name.n; k++)
    if (!vs_words_goes_on(name.at[k])) return false;
  return true;
}

/* True for the line of a .subckt that has parameters, in its head or in a .param of its own. */
static bool has_parameters(const vs_line *line, const vs_line *end) {
  if (strchr(line->text, '=')) return true;
  for (line++; line < end && strncasecmp(line->text, ".ends", 5); line++)
    if (!strncasecmp(line->text, ".param", 6)) return true;
  return false;
}

static bool same(vs_word a, vs_word b) {
  return a.n == b.n && !strncasecmp(a.at, b.at, a.n);
}

/* Writes '_' for each character of the word that no name of ngspice's parameters has. */
static void write_plain(vs_line *line, vs_word word) {
  size_t at = (size_t)(word.at - line->text);
  char *text = vs_copy(line->text);
  for (size_t k = at; k < at + word.n; k++)
    if (!vs_words_goes_on(text[k])) text[k] = '_';
  if (line->written)
    free(line->text);
  else
    line->written = line->text;
  line->text = text;
}

/* Gives a subcircuit another name in its own line, that of its .ends, and in all instances. */
static void rename_all(vs_line *lines, size_t count, const char *name) {
  const vs_word wanted = {name, strlen(name)};
  for (size_t k = 0; k < count; k++) {
    const char *text = lines[k].text;
    bool named = !strncasecmp(text, ".subckt", 7) || !strncasecmp(text, ".ends", 5);
    vs_word word = named                                  ? second_word(text)
                   : tolower((unsigned char)*text) == 'x' ? instance_of(text)
                                                          : (vs_word){text, 0};
    if (same(word, wanted)) write_plain(&lines[k], word);
  }
}

/* True where a subcircuit has the name already that this one would be given. */
static bool is_taken(const vs_line *lines, size_t count, const char *name) {
  char *plain = vs_copy(name);
  bool taken = false;
  for (char *c = plain; *c; c++)
    if (!vs_words_goes_on(*c)) *c = '_';
  for (size_t k = 0; k < count && !taken; k++)
    taken =
        !strncasecmp(lines[k].text, ".subckt", 7) && vs_words_is(second_word(lines[k].text), plain);
  free(plain);
  return taken;
}

void vs_translate_names(vs_line *lines, size_t count, vs_tally *tally) {
  for (size_t k = 0; k < count; k++) {
    if (strncasecmp(lines[k].text, ".subckt", 7)) continue;
    vs_word word = second_word(lines[k].text);
    if (is_plain(word) || !has_parameters(&lines[k], lines + count)) continue;
    vs_text name = {0};
    vs_text_add(&name, "%.*s", (int)word.n, word.at);
    if (!is_taken(lines, count, name.text)) {
      vs_tally_add(tally,
                   "a subcircuit with parameters is found by ngspice if its name has letters, "
                   "digits and '_' only: other characters become '_'",
                   lines[k].where);
      rename_all(lines, count, name.text);
    }
    vs_text_free(&name);
  }
}
