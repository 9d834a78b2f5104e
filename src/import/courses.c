/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/courses.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { MOST_NUMBERS = 256 };

/* The numbers of a course, read from the text after its word. Blanks, commas and brackets separate
 * them. */
static const char *begin_of(const vs_element *e, const char *word) {
  size_t n = strlen(word);
  if (e->letter != 'v' && e->letter != 'i') return NULL;
  for (int k = e->n_nodes + 1; k < e->n_words; k++) {
    const char *s = e->words[k].at;
    if (!strncasecmp(s, word, n) && (s[n] == '(' || s[n] == ' ' || s[n] == '\t')) return s + n;
  }
  return NULL;
}

bool vs_course_has(const vs_element *e, const char *word) {
  return begin_of(e, word);
}

typedef struct numbers {
  double item[MOST_NUMBERS];
  int count;
} numbers;

/* In LTspice's PWL, a time with a plus sign counts from the time before it. */
static void add_time(numbers *n, vs_word word) {
  if (*word.at == '+' && n->count >= 2 && n->count % 2 == 0)
    n->item[n->count] += n->item[n->count - 2];
}

/* Reads the numbers up to an option NAME=VALUE or the closing bracket. Error: one is not known.
 * `points`: they are the points of a PWL. */
static vs_status read_numbers(const vs_elements *w, const vs_values *v, const vs_element *e,
                              const char *s, bool points, numbers *n, vs_error *err) {
  s += strspn(s, " \t");
  const bool bracket = *s == '(';
  vs_word word;
  for (s += bracket; n->count < MOST_NUMBERS && (s = vs_words_number(s, &word)); n->count++) {
    if (!strchr("{'", *word.at) && memchr(word.at, '=', word.n)) break;
    const bool known = vs_values_of(v, word, &n->item[n->count]);
    if (!known && bracket)
      return vs_fail_at(err, vs_elements_where(w, e, 0),
                        "%s: '%.*s' is not known before a run; write a number, or a .param of "
                        "numbers",
                        e->name, (int)word.n, word.at);
    if (!known) break; /* such as AC 1, after a course without brackets */
    if (points) add_time(n, word);
  }
  return VS_OK;
}

static double nth(const numbers *n, int k, double otherwise) {
  return k < n->count ? n->item[k] : otherwise;
}

/* The number of cycles at place k. None, or 0, means without end. */
static double cycles_at(const numbers *n, int k) {
  double cycles = nth(n, k, 0);
  return cycles > 0 ? cycles : INFINITY;
}

vs_status vs_course_read_sine(const vs_elements *w, const vs_values *v, const vs_element *e,
                              vs_course_sine *sine, vs_error *err) {
  const char *s = begin_of(e, "sin");
  numbers n = {.count = 0};
  if (!s) s = begin_of(e, "sine");
  if (!s)
    return vs_fail_at(err, vs_elements_where(w, e, 0),
                      "%s has no SIN(offset amplitude frequency), so it cannot be the mains; "
                      "--mains names another source, or none",
                      e->name);
  vs_status status = read_numbers(w, v, e, s, false, &n, err);
  *sine = (vs_course_sine){nth(&n, 0, 0), nth(&n, 1, 0), nth(&n, 2, NAN), nth(&n, 3, 0),
                           nth(&n, 4, 0), nth(&n, 5, 0), cycles_at(&n, 6)};
  return status;
}

/* Finds the next pair of PWL points, from *k on, between which the course crosses `level`. Returns
 * when this edge begins, and *length_s is how long it takes; NaN: there is none. *k moves past it.
 */
static double edge(const double *points, int count, double level, int *k, double *length_s) {
  for (; *k < count; ++*k) {
    const double *a = points + 2 * (*k - 1), *b = points + 2 * *k;
    if ((a[1] < level) == (b[1] < level)) continue;
    *length_s = b[0] - a[0];
    ++*k;
    return a[0];
  }
  return NAN;
}

/* Skips REPEAT FOREVER, after which the points of a PWL stand in brackets. */
static const char *passed_repeat(const char *points, bool *repeats) {
  const char *s = points + strspn(points, " \t");
  *repeats = !strncasecmp(s, "repeat", 6) && strchr(s, '(');
  return *repeats ? strchr(s, '(') : points;
}

/* The value that differs most from the first one. */
static double farthest(const double *points, int count) {
  double high = points[1];
  for (int i = 0; i < count; i++)
    if (fabs(points[2 * i + 1] - points[1]) > fabs(high - points[1])) high = points[2 * i + 1];
  return high;
}

/* Reads the pulse of a PWL. Error: it has a second pulse, which may come at any time and have any
 * shape. */
static vs_status of_points(const vs_elements *w, const vs_element *e, const numbers *n,
                           vs_course_pulse *p, vs_error *err) {
  int count = n->count / 2, k = 1;
  double high = farthest(n->item, count);
  *p = (vs_course_pulse){n->item[1], high, NAN, NAN, 0, 0, INFINITY, INFINITY};
  double level = (p->low + p->high) / 2, rise_s;
  p->at_s = edge(n->item, count, level, &k, &p->rise_s);
  double off_s = edge(n->item, count, level, &k, &p->fall_s);
  p->width_s = isnan(off_s) ? INFINITY : off_s - p->at_s;
  return isnan(edge(n->item, count, level, &k, &rise_s))
             ? VS_OK
             : vs_fail_at(err, vs_elements_where(w, e, 0),
                          "%s: its PWL has more than one pulse, and a scene's are alike and come "
                          "until its run ends; write PULSE(low high delay rise fall width period), "
                          "or say --gate none, which leaves %s as it is",
                          e->name, e->name);
}

/* ngspice's r=0 repeats a PWL from its beginning once it has ended; td= delays it. Error: r is
 * another number, or there is a delay. */
static vs_status repeat_points(const vs_elements *w, const vs_values *v, const vs_element *e,
                               const numbers *n, vs_course_pulse *p, vs_error *err) {
  const vs_word from = vs_elements_option(w, e, "r"), delay = vs_elements_option(w, e, "td");
  double from_s = 0, delay_s = 0, end_s = n->item[2 * (n->count / 2) - 2];
  bool known = (!from.n || vs_values_of(v, from, &from_s)) &&
               (!delay.n || vs_values_of(v, delay, &delay_s)) && from_s == 0 && delay_s == 0;
  if (known && from.n) p->period_s = end_s;
  return known ? VS_OK
               : vs_fail_at(err, vs_elements_where(w, e, 0),
                            "%s: of a PWL with r= or td= a gate's pulse cannot be told; write "
                            "PULSE(...), or say --gate none, which leaves %s as it is",
                            e->name, e->name);
}

/* Reads PULSE(low high delay rise fall width period cycles); both LTspice and ngspice know the last
 * number. */
static vs_course_pulse of_pulse(const numbers *n) {
  double rise_s = nth(n, 3, 0), fall_s = nth(n, 4, 0), width_s = nth(n, 5, INFINITY);
  vs_course_pulse p = {nth(n, 0, 0), nth(n, 1, 0), nth(n, 2, 0),        width_s + rise_s,
                       rise_s,       fall_s,       nth(n, 6, INFINITY), cycles_at(n, 7)};
  if (!(p.period_s > 0) || p.cycles == 1) p.period_s = INFINITY;
  return p;
}

vs_status vs_course_read_pulse(const vs_elements *w, const vs_values *v, const vs_element *e,
                               vs_course_pulse *pulse, vs_error *err) {
  const char *s = begin_of(e, "pulse"), *points = begin_of(e, "pwl");
  numbers n = {.count = 0};
  bool repeats = false;
  if (points) points = passed_repeat(points, &repeats);
  vs_status status = s || points ? read_numbers(w, v, e, s ? s : points, !s, &n, err) : VS_OK;
  if (status) return status;
  if (s && n.count >= 2) {
    *pulse = of_pulse(&n);
    return VS_OK;
  }
  if (!s && points && n.count >= 4) {
    status = of_points(w, e, &n, pulse, err);
    if (repeats) pulse->period_s = n.item[n.count / 2 * 2 - 2];
    return status ? status : repeat_points(w, v, e, &n, pulse, err);
  }
  vs_word word = vs_elements_word(e, e->n_nodes + 1);
  if (vs_words_is(word, "dc")) word = vs_elements_word(e, e->n_nodes + 2);
  *pulse = (vs_course_pulse){0, NAN, NAN, NAN, 0, 0, INFINITY, INFINITY};
  return vs_values_of(v, word, &pulse->high) && !s && !points
             ? VS_OK
             : vs_fail_at(err, vs_elements_where(w, e, 0),
                          "%s has no PULSE(low high delay rise fall width period) whose numbers "
                          "are known, so it cannot be a gate's; --gate names another source, or "
                          "none",
                          e->name);
}

/* The value of a source without a course: what stands after DC, or its first word. Returns false
 * where it is not known. */
static bool direct(const vs_elements *w, const vs_values *v, const vs_element *e, double *value) {
  const vs_word first = vs_elements_word(e, e->n_nodes + 1);
  vs_word dc = vs_elements_option(w, e, "dc");
  for (int k = e->n_nodes + 1; k + 1 < e->n_words && !dc.n; k++)
    if (vs_words_is(e->words[k], "dc")) dc = e->words[k + 1];
  const bool none =
      vs_words_is(first, "ac") || (*first.at != '{' && memchr(first.at, '=', first.n));
  *value = 0;
  return dc.n ? vs_values_of(v, dc, value) : none || vs_values_of(v, first, value);
}

bool vs_course_begins_at_0(const vs_elements *w, const vs_values *v, const vs_element *e) {
  static const char *const WORDS[] = {"pulse", "exp", "pwl", "sin", "sine", "sffm", "am"};
  enum { PWL = 2, SIN, SINE };
  numbers n = {.count = 0};
  vs_error unread = {0};
  double value;
  for (size_t k = 0; k < sizeof WORDS / sizeof *WORDS; k++) {
    const char *s = begin_of(e, WORDS[k]);
    bool repeats;
    if (!s) continue;
    if (k == PWL) s = passed_repeat(s, &repeats);
    if (read_numbers(w, v, e, s, k == PWL, &n, &unread) || n.count < 2) return false;
    if (k == PWL) return n.item[1] == 0;
    if (k != SIN && k != SINE) return n.item[0] == 0 && k < PWL;
    return fabs(n.item[0] + n.item[1] * sin(nth(&n, 5, 0) * M_PI / 180)) <= 1e-9 * fabs(n.item[1]);
  }
  return direct(w, v, e, &value) && value == 0;
}
