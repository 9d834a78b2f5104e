/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/growth.h"

#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "lint/cycles.h"

/* What a function comes to: characters of its own, and how many copies of each argument. */
typedef struct form {
  double own, *copies;
} form;

/* An expression that is read, and what it comes to. */
typedef struct reading {
  const vs_definitions *d;
  const form *of;              /* all functions' */
  const vs_definition *within; /* the function whose formula it is; NULL: of none */
  size_t scope;
  form *sum;
} reading;

enum { DEEPEST = 200 }; /* calls within calls; deeper ones count as they stand */

/* Adds `times` the text from `s` to before `end`. */
static void add_growth(const reading *r, const char *s, const char *end, double times, int depth) {
  vs_mention m;
  while (vs_definitions_mention(s, end, &m)) {
    const vs_definition *to = NULL;
    const char *behind = m.name.at + m.name.n;
    vs_word argument[VS_WORDS_MOST];
    size_t count = 0;
    const int k = r->within ? vs_definitions_argument(r->within, m.name) : -1;
    r->sum->own += times * (double)(m.name.at - s);
    if (k >= 0)
      r->sum->copies[k] += times;
    else if (m.call && depth < DEEPEST)
      to = vs_definitions_get(r->d, m, r->scope);
    if (to) count = vs_words_arguments(strchr(behind, '('), argument, &behind);
    if (count && behind <= end) {
      const form *f = &r->of[to - r->d->list];
      const size_t known = vs_definitions_arguments(to);
      r->sum->own += times * f->own;
      for (size_t j = 0; j < count && j < known; j++)
        add_growth(r, argument[j].at, argument[j].at + argument[j].n, times * f->copies[j],
                   depth + 1);
    } else {
      behind = m.name.at + m.name.n;
      if (k < 0) r->sum->own += times * (double)m.name.n;
    }
    s = behind;
  }
  r->sum->own += times * (double)(end - s);
}

static vs_status refuse_growth(vs_where where, double characters, vs_error *err) {
  return vs_fail_at(err, where,
                    "with its functions written out, as ngspice needs it, this line has %.3g "
                    "characters, and at most %d are taken; give inner functions sources of their "
                    "own: B1 x 0 V=..., and then v(x)",
                    characters, VS_GROWTH_MOST);
}

/* Sizes all functions, each behind those that it calls. */
static vs_status size_functions(const vs_definitions *d, form *of, vs_error *err) {
  size_t *order = vs_alloc(d->count + 1, sizeof *order);
  vs_status status = VS_OK;
  vs_cycles_order(d, order);
  for (size_t k = 0; k < d->count && !status; k++) {
    const vs_definition *f = &d->list[order[k]];
    form *sum = &of[order[k]];
    if (!f->function) continue;
    const size_t n = vs_definitions_arguments(f);
    sum->copies = vs_alloc(n, sizeof *sum->copies);
    const reading r = {d, of, f, f->scope, sum};
    add_growth(&r, f->body.at, f->body.at + f->body.n, 1, 0);
    double all = sum->own;
    for (size_t j = 0; j < n; j++) all += sum->copies[j];
    if (all > VS_GROWTH_MOST) status = refuse_growth(f->line->where, all, err);
  }
  free(order);
  return status;
}

static vs_status check_lines(const vs_definitions *d, const form *of, const vs_line *lines,
                             size_t count, vs_error *err) {
  size_t scope = 0, subcircuits = 0;
  for (size_t k = 0; k < count; k++) {
    const char *text = lines[k].text;
    form sum = {0};
    if (vs_words_begin(text, ".subckt")) scope = ++subcircuits;
    if (vs_words_begin(text, ".ends")) scope = d->outer[scope];
    if (!strchr(text, '(') || vs_words_begin(text, ".func")) continue;
    const reading r = {d, of, NULL, scope, &sum};
    add_growth(&r, text, text + strlen(text), 1, 0);
    if (sum.own > VS_GROWTH_MOST && sum.own > (double)strlen(text))
      return refuse_growth(lines[k].where, sum.own, err);
  }
  return VS_OK;
}

vs_status vs_growth_check(const vs_definitions *d, const vs_line *lines, size_t count,
                          vs_error *err) {
  bool any = false;
  for (size_t k = 0; k < d->count && !any; k++) any = d->list[k].function;
  if (!any) return VS_OK;
  form *of = vs_alloc(d->count, sizeof *of);
  vs_status status = size_functions(d, of, err);
  if (!status) status = check_lines(d, of, lines, count, err);
  for (size_t k = 0; k < d->count; k++) free(of[k].copies);
  free(of);
  return status;
}
