/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_pair.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "curve_difference.h"
#include "members.h"
#include "run/engineering.h"

enum { DIGITS = 12 }; /* as summary.json has */

static vs_status read_summary(const char *folder, vs_tree *tree, vs_error *err) {
  char path[VS_PATH_SIZE];
  if (strlen(folder) > VS_PATH_SIZE / 2)
    return vs_fail(err, VS_INPUT, "%.100s...: too long a name", folder);
  snprintf(path, sizeof path, "%s/summary.json", folder);
  vs_status status = vs_tree_read(path, tree, err);
  if (status || vs_tree_child_map(tree->root, "measures")) return status;
  return vs_fail_at(err, (vs_where){path, 1, 1}, "has no member 'measures', so it is of no run");
}

vs_status vs_run_pair_open(vs_run_pair *p, const char *a, const char *b, vs_error *err) {
  const char *folders[] = {a, b};
  vs_status status = VS_OK;
  for (int k = 0; k < 2 && !status; k++) {
    p->folder[k] = folders[k];
    status = vs_traces_read(folders[k], &p->traces[k], err);
    if (!status) status = read_summary(folders[k], &p->summary[k], err);
  }
  return status;
}

void vs_run_pair_close(vs_run_pair *p) {
  for (int k = 0; k < 2; k++) {
    vs_tree_free(&p->summary[k]);
    vs_traces_free(&p->traces[k]);
  }
}

/* The output, a table or JSON, and how many rows were left out because both runs have the same. */
typedef struct writer {
  vs_text *out;
  vs_json *json;
  int rows, same;
} writer;

/* Calls visit for this member of both summaries. */
static void join_members(const vs_run_pair *p, const char *member, vs_member_visit visit,
                         writer *w) {
  vs_members_join(vs_tree_child_map(p->summary[0].root, member),
                  vs_tree_child_map(p->summary[1].root, member), visit, w);
}

/* Adds how many rows were left out because both runs have the same. */
static void say_same(writer *w, const char *what) {
  if (w->same)
    vs_text_add(w->out, "  %s%d %s%s the same in both\n", w->rows ? "and " : "", w->same, what,
                w->same > 1 ? "s are" : " is");
  else if (!w->rows)
    vs_text_add(w->out, "  there is none\n");
  w->rows = w->same = 0;
}

/* ---- keys of the scene ---- */

static void show_key(void *ctx, const char *key, const vs_node *a, const vs_node *b) {
  writer *w = ctx;
  vs_text one = {0}, other = {0};
  vs_member_text(a, &one);
  vs_member_text(b, &other);
  if (w->json) {
    vs_json_object(w->json, NULL, VS_JSON_ROW);
    vs_json_text(w->json, "key", key);
    vs_json_text(w->json, "a", a ? one.text : NULL);
    vs_json_text(w->json, "b", b ? other.text : NULL);
    vs_json_end(w->json);
  } else
    vs_text_add(w->out, "  %-26s %16s %16s\n", key, one.text, other.text);
  w->rows++;
  vs_text_free(&one);
  vs_text_free(&other);
}

/* ---- the verdict ---- */

/* The name of a line of the verdict: "thyristor.di_dt", or a rating's probe. */
static void name_line(const vs_node *line, vs_text *name) {
  const char *device = vs_member_word(line, "device");
  name->length = 0;
  if (*device)
    vs_text_add(name, "%s.%s", device, vs_member_word(line, "measure"));
  else
    vs_text_add(name, "%s", vs_member_word(line, "rating"));
}

static const vs_node *find_line(const vs_node *verdict, const char *name) {
  vs_text other = {0};
  const vs_node *found = NULL;
  for (const vs_node *m = verdict ? verdict->child : NULL; m && !found; m = m->next) {
    name_line(m, &other);
    if (!strcmp(other.text, name)) found = m;
  }
  vs_text_free(&other);
  return found;
}

/* The word of a line. A margin below 0 whose error is not known is violated, too. */
const char *vs_run_pair_word(const vs_node *line) {
  const char *word = vs_member_word(line, "word");
  bool below = !strcmp(vs_member_word(line, "violated"), "true");
  return below && !strcmp(word, "unverified") ? "violated, unverified" : word;
}

/* The word of the whole verdict: that of its worst line. */
const char *vs_run_pair_whole(const vs_node *verdict) {
  static const char *const RISING[] = {
      "waived", "held", "unverified", "undecided", "violated, unverified", "violated"};
  size_t worst = 0;
  if (!verdict || !verdict->child) return "no limit stated";
  for (const vs_node *m = verdict->child; m; m = m->next)
    for (size_t k = worst; k < sizeof RISING / sizeof *RISING; k++)
      if (!strcmp(vs_run_pair_word(m), RISING[k])) worst = k;
  return RISING[worst];
}

static void add_margin(const vs_node *line, vs_text *out) {
  char cell[96] = "-";
  const double margin = line ? vs_member_number(vs_tree_child(line, "margin")) : NAN;
  if (line && isnan(margin))
    snprintf(cell, sizeof cell, "- %s", vs_run_pair_word(line));
  else if (line)
    snprintf(cell, sizeof cell, "%.1f %% %s", 100 * margin, vs_run_pair_word(line));
  vs_text_add(out, " %24s", cell);
}

static void add_side(vs_json *json, const char *key, const vs_node *line) {
  if (!line) {
    vs_json_null(json, key);
    return;
  }
  static const char *const NUMBERS[] = {"stress", "least", "largest", "limit",
                                        "min",    "max",   "margin",  "margin_error"};
  vs_json_object(json, key, VS_JSON_ROW);
  for (size_t k = 0; k < sizeof NUMBERS / sizeof *NUMBERS; k++)
    if (vs_tree_child(line, NUMBERS[k]))
      vs_json_number(json, NUMBERS[k], vs_member_number(vs_tree_child(line, NUMBERS[k])), DIGITS);
  vs_json_text(json, "unit", vs_member_word(line, "unit"));
  vs_json_text(json, "word", vs_member_word(line, "word"));
  vs_json_end(json);
}

static void show_line(writer *w, const char *name, const vs_node *a, const vs_node *b) {
  if (w->json) {
    vs_json_object(w->json, NULL, VS_JSON_ROW);
    vs_json_text(w->json, "name", name);
    add_side(w->json, "a", a);
    add_side(w->json, "b", b);
    vs_json_end(w->json);
    return;
  }
  vs_text_add(w->out, "  %-26s", name);
  add_margin(a, w->out);
  add_margin(b, w->out);
  vs_text_add(w->out, "\n");
}

static void show_lines(writer *w, const vs_node *a, const vs_node *b) {
  vs_text name = {0};
  for (const vs_node *m = a ? a->child : NULL; m; m = m->next) {
    name_line(m, &name);
    show_line(w, name.text, m, find_line(b, name.text));
  }
  for (const vs_node *m = b ? b->child : NULL; m; m = m->next) {
    name_line(m, &name);
    if (!find_line(a, name.text)) show_line(w, name.text, NULL, m);
  }
  vs_text_free(&name);
}

/* ---- measures ---- */

static void show_measure(void *ctx, const char *name, const vs_node *a, const vs_node *b) {
  writer *w = ctx;
  const vs_node *some = a ? a : b;
  const char *unit = vs_member_word(some, "unit");
  bool comparable = a && b && !strcmp(unit, vs_member_word(b, "unit"));
  double one = vs_member_number(vs_tree_child(a, "value")),
         other = vs_member_number(vs_tree_child(b, "value")),
         apart = comparable ? other - one : NAN, relative = one != 0 ? apart / fabs(one) : NAN;
  if (w->json) {
    vs_json_object(w->json, name, VS_JSON_ROW);
    vs_json_text(w->json, "unit", unit);
    if (a && b && !comparable) vs_json_text(w->json, "unit_b", vs_member_word(b, "unit"));
    vs_json_number(w->json, "a", one, DIGITS);
    vs_json_number(w->json, "b", other, DIGITS);
    vs_json_number(w->json, "difference", apart, DIGITS);
    vs_json_number(w->json, "relative", relative, DIGITS);
    vs_json_end(w->json);
    return;
  }
  if (apart == 0 || (comparable && isnan(one) && isnan(other))) {
    w->same++;
    return;
  }
  char cell[4][VS_ENGINEERING_SIZE] = {"-", "-", "-", "-"};
  if (!isnan(one)) vs_engineering_text(one, unit, cell[0]);
  if (!isnan(other)) vs_engineering_text(other, vs_member_word(b, "unit"), cell[1]);
  if (!isnan(apart)) vs_engineering_text(apart, unit, cell[2]);
  if (!isnan(relative)) snprintf(cell[3], sizeof cell[3], "%+.3g %%", 100 * relative);
  vs_text_add(w->out, "  %-26s %16s %16s %16s %11s\n", name, cell[0], cell[1], cell[2], cell[3]);
  w->rows++;
}

/* ---- curves ---- */

static void show_curve(writer *w, const char *name, const vs_curve_difference *d) {
  double share = d->peak > 0 ? d->largest / d->peak : NAN, rms = d->rms / d->peak;
  if (w->json) {
    vs_json_object(w->json, name, VS_JSON_ROW);
    vs_json_number(w->json, "peak", d->peak, DIGITS);
    vs_json_number(w->json, "largest", d->largest, DIGITS);
    vs_json_number(w->json, "at_s", d->at_s, DIGITS);
    vs_json_number(w->json, "rms", d->rms, DIGITS);
    vs_json_number(w->json, "largest_relative", share, DIGITS);
    vs_json_number(w->json, "rms_relative", d->peak > 0 ? rms : NAN, DIGITS);
    vs_json_end(w->json);
    return;
  }
  if (d->largest == 0) {
    w->same++;
    return;
  }
  char at[VS_ENGINEERING_SIZE] = "-";
  w->rows++;
  if (isnan(d->largest)) {
    vs_text_add(w->out, "  %-26s is never known in both at the same time\n", name);
    return;
  }
  vs_engineering_text(d->at_s, "s", at);
  vs_text_add(w->out, "  %-26s %11.4g %13.4g %12s %9.3g %% %9.3g %%\n", name, d->peak, d->largest,
              at, 100 * share, 100 * rms);
}

static void show_curves(const vs_run_pair *p, writer *w) {
  const vs_traces *a = &p->traces[0], *b = &p->traces[1];
  for (size_t c = 1; c < a->columns; c++) {
    int other = vs_traces_like(b, &a->column[c]);
    if (other < 1) continue;
    vs_curve_difference d = vs_curve_difference_of(a, (int)c, b, other);
    show_curve(w, a->name[c], &d);
  }
}

/* Returns how many columns only the first of the two runs has, and names them. */
static int list_alone(const vs_traces *a, const vs_traces *b, writer *w) {
  int n = 0;
  for (size_t c = 1; c < a->columns; c++) {
    if (vs_traces_like(b, &a->column[c]) >= 0) continue;
    if (w->json)
      vs_json_text(w->json, NULL, a->name[c]);
    else
      vs_text_add(w->out, "%s%s", n ? ", " : "", a->name[c]);
    n++;
  }
  return n;
}

static void say_alone(const vs_run_pair *p, int k, writer *w) {
  vs_text names = {0};
  writer inner = {.out = &names};
  if (list_alone(&p->traces[k], &p->traces[!k], &inner))
    vs_text_add(w->out, "  only %c has %s\n", "AB"[k], names.text);
  vs_text_free(&names);
}

/* ---- the whole ---- */

static double end_of(const vs_traces *t) {
  return vs_trace_time(t, t->rows - 1);
}

static void add_heads(const vs_run_pair *p, vs_text *out) {
  for (int k = 0; k < 2; k++) {
    char from[VS_ENGINEERING_SIZE], until[VS_ENGINEERING_SIZE];
    const vs_traces *t = &p->traces[k];
    vs_text_add(out, "%c: %s, tier %s, from %s to %s\n", "AB"[k], p -> folder[k],
                vs_member_word(p->summary[k].root, "tier"),
                vs_engineering_text(vs_trace_time(t, 0), "s", from),
                vs_engineering_text(end_of(t), "s", until));
  }
}

void vs_run_pair_table(const vs_run_pair *p, vs_text *out) {
  const vs_node *a = vs_tree_child(p->summary[0].root, "verdict"),
                *b = vs_tree_child(p->summary[1].root, "verdict");
  writer w = {.out = out};
  add_heads(p, out);
  vs_text_add(out, "\n%-28s %24s %24s\n  %-26s %24s %24s\n", "verdict", "A", "B", "the whole",
              vs_run_pair_whole(a), vs_run_pair_whole(b));
  show_lines(&w, a, b);
  vs_text_add(out, "\n%-28s %16s %16s\n", "keys that differ", "A", "B");
  vs_members_unlike(vs_tree_child_map(p->summary[0].root, "scene"),
                    vs_tree_child_map(p->summary[1].root, "scene"), show_key, &w);
  say_same(&w, "key");
  vs_text_add(out, "\n%-28s %16s %16s %16s %11s\n", "measures", "A", "B", "B - A", "of |A|");
  join_members(p, "measures", show_measure, &w);
  say_same(&w, "measure");
  vs_text_add(out, "\n%-28s %11s %13s %12s %11s %11s\n", "curves", "peak", "largest B-A", "at",
              "of the peak", "rms");
  show_curves(p, &w);
  say_same(&w, "curve");
  for (int k = 0; k < 2; k++) say_alone(p, k, &w);
}

static void add_run(const vs_run_pair *p, int k, vs_json *json) {
  vs_json_object(json, k ? "b" : "a", VS_JSON_ROW);
  vs_json_text(json, "folder", p->folder[k]);
  vs_json_text(json, "tier", vs_member_word(p->summary[k].root, "tier"));
  vs_json_number(json, "until_s", end_of(&p->traces[k]), DIGITS);
  vs_json_text(json, "verdict", vs_run_pair_whole(vs_tree_child(p->summary[k].root, "verdict")));
  vs_json_end(json);
}

void vs_run_pair_json(const vs_run_pair *p, vs_text *out) {
  vs_json json = vs_json_new(out);
  writer w = {.out = out, .json = &json};
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_json_text(&json, "compared", "runs");
  for (int k = 0; k < 2; k++) add_run(p, k, &json);
  vs_json_array(&json, "keys", VS_JSON_LINES);
  vs_members_unlike(vs_tree_child_map(p->summary[0].root, "scene"),
                    vs_tree_child_map(p->summary[1].root, "scene"), show_key, &w);
  vs_json_end(&json);
  vs_json_array(&json, "verdict", VS_JSON_LINES);
  show_lines(&w, vs_tree_child(p->summary[0].root, "verdict"),
             vs_tree_child(p->summary[1].root, "verdict"));
  vs_json_end(&json);
  vs_json_object(&json, "measures", VS_JSON_LINES);
  join_members(p, "measures", show_measure, &w);
  vs_json_end(&json);
  vs_json_object(&json, "curves", VS_JSON_LINES);
  show_curves(p, &w);
  vs_json_end(&json);
  for (int k = 0; k < 2; k++) {
    vs_json_array(&json, k ? "only_b" : "only_a", VS_JSON_ROW);
    list_alone(&p->traces[k], &p->traces[!k], &w);
    vs_json_end(&json);
  }
  vs_json_end(&json);
  vs_text_add(out, "\n");
}
