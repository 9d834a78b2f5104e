/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study_page.h"

#include <math.h>
#include <string.h>

#include "members.h"
#include "report/html.h"
#include "study/study_results.h"

/* ---- tables ---- */

enum { MOST_ITEMS = 24 };

/* Adds a node of the manifest on one line: a text as it is, a list as "a, b", a map as "key: a",
 * nested ones in brackets. Of a long list the first MOST_ITEMS and the last are shown, with how
 * many there are. */
static void add_node_text(vs_html *html, const vs_node *node) {
  if (node->kind == VS_NODE_TEXT) {
    vs_html_text(html, node->text);
    return;
  }
  size_t n = 0;
  for (const vs_node *c = node->child; c; c = c->next, n++) {
    if (n >= MOST_ITEMS && c->next) continue;
    vs_html_add(html, n >= MOST_ITEMS ? ", ... " : n ? ", " : "");
    if (c->key) {
      vs_html_text(html, c->key);
      vs_html_add(html, ": ");
    }
    bool nested = c->kind != VS_NODE_TEXT;
    if (nested) vs_html_add(html, "(");
    add_node_text(html, c);
    if (nested) vs_html_add(html, ")");
  }
  if (n > MOST_ITEMS + 1) vs_html_add(html, " (%zu of them)", n);
}

/* True for the cases' numbers, and where one of the listed cases has more than a 0. */
static bool says_anything(const vs_study_results *s, size_t column) {
  for (size_t k = 0; k < s->n_worst; k++)
    if (*s->worst[k].cell[column] && strcmp(s->worst[k].cell[column], "0") != 0) return true;
  return !column;
}

/* Adds the worst cases, or the first ones if nothing ranks them. */
static void tables_cases(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  if (!s->n_worst) return;
  vs_html_add(html,
              "<section id=\"cases\">\n<h2>The %s cases</h2>\n<div class=\"wide\"><table><tr>",
              vs_study_results_ranked(t, s) ? "worst" : "first");
  for (size_t c = 0; c < t->count; c++) {
    if (!says_anything(s, c)) continue;
    vs_html_add(html, "<th>");
    vs_html_text(html, t->column[c].title);
    vs_html_add(html, "</th>");
  }
  vs_html_add(html, "</tr>\n");
  for (size_t k = 0; k < s->n_worst; k++) {
    vs_html_add(html, "<tr>");
    for (size_t c = 0; c < t->count; c++) {
      if (!says_anything(s, c)) continue;
      double value;
      bool number = c && s->profile[c].is_number && vs_folder_number(s->worst[k].cell[c], &value);
      if (number)
        vs_html_number(html, value);
      else
        vs_html_cell(html, s->worst[k].cell[c]);
    }
    vs_html_add(html, "</tr>\n");
  }
  vs_html_add(html, "</table></div>\n</section>\n");
}

/* True if the table of axes has a column for this key. */
static bool is_said(const char *key) {
  static const char *const SAID[] = {"key", "unit", "column", "text"};
  for (size_t k = 0; k < sizeof SAID / sizeof *SAID; k++)
    if (!strcmp(key, SAID[k])) return true;
  return false;
}

/* Adds the table of what was varied. */
static void tables_axes(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  vs_html_add(html, "<section id=\"axes\">\n<h2>What was varied</h2>\n<div class=\"wide "
                    "prose\"><table><tr><th>key</th>"
                    "<th>unit</th><th>least</th><th>largest</th><th>asked for</th><th>what it is"
                    "</th></tr>\n");
  for (size_t c = 0; c < t->count; c++) {
    if (t->column[c].role != VS_ROLE_AXIS) continue;
    vs_html_add(html, "<tr>");
    vs_html_cell(html, t->column[c].name);
    vs_html_cell(html, t->column[c].unit);
    vs_html_number(html, s->profile[c].least);
    vs_html_number(html, s->profile[c].largest);
    vs_html_add(html, "<td>");
    size_t n = 0;
    for (const vs_node *v = t->column[c].node->child; v; v = v->next) {
      if (!v->key || is_said(v->key)) continue;
      vs_html_add(html, "%s", n++ ? "; " : "");
      vs_html_text(html, v->key);
      vs_html_add(html, ": ");
      add_node_text(html, v);
    }
    vs_html_add(html, "</td>");
    vs_html_cell(html, t->column[c].text);
    vs_html_add(html, "</tr>\n");
  }
  vs_html_add(html, "</table></div>\n</section>\n");
}

/* Adds the table of what is reported. */
static void tables_columns(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  vs_html_add(html, "<section id=\"columns\">\n<h2>What is reported</h2>\n<div class=\"wide "
                    "prose\"><table><tr><th>column</th>"
                    "<th>unit</th><th>rating</th><th>least</th><th>largest</th><th>cases</th>"
                    "<th>what it is</th></tr>\n");
  for (size_t c = 0; c < t->count; c++) {
    vs_folder_role role = t->column[c].role;
    if (role != VS_ROLE_REPORT && role != VS_ROLE_MARGIN) continue;
    vs_html_add(html, "<tr>");
    vs_html_cell(html, t->column[c].name);
    vs_html_cell(html, t->column[c].unit);
    vs_html_number(html, role == VS_ROLE_MARGIN ? 0 : t->column[c].rating);
    vs_html_number(html, s->profile[c].least);
    vs_html_number(html, s->profile[c].largest);
    vs_html_add(html, "<td class=\"n\">%ld</td>", s->profile[c].known);
    vs_html_cell(html, role == VS_ROLE_MARGIN && !*t->column[c].text
                           ? "least margin of the verdict, as a part of the limit"
                           : t->column[c].text);
    vs_html_add(html, "</tr>\n");
  }
  vs_html_add(html, "</table></div>\n</section>\n");
}

/* Adds what the manifest says besides the columns: scene, fixed keys, versions, seed, hashes of the
 * inputs. */
static void tables_manifest(vs_html *html, const vs_folder *t) {
  vs_html_add(
      html,
      "<section id=\"manifest\">\n<h2>How it was made</h2>\n<div class=\"wide fold\"><table>\n");
  for (const vs_node *n = t->manifest.root->child; n; n = n->next) {
    if (!n->key || !strcmp(n->key, "axes") || !strcmp(n->key, "report") ||
        !strcmp(n->key, "lines") || !strcmp(n->key, "columns"))
      continue;
    bool lines = n->kind == VS_NODE_LIST && !strcmp(n->key, "inputs");
    vs_html_add(html, "<tr><th>");
    vs_html_text(html, n->key);
    vs_html_add(html, "</th><td>");
    for (const vs_node *c = n->child; lines && c; c = c->next) {
      add_node_text(html, c);
      vs_html_add(html, "<br>");
    }
    if (!lines && !strcmp(n->key, "command"))
      for (const vs_node *c = n->child; c; c = c->next) {
        vs_html_text(html, c->text ? c->text : "");
        vs_html_add(html, " ");
      }
    else if (!lines)
      add_node_text(html, n);
    vs_html_add(html, "</td></tr>\n");
  }
  vs_html_add(html, "</table></div>\n</section>\n");
}

static const char *manifest_text(const vs_folder *t, const char *key) {
  const vs_node *node = vs_tree_child(t->manifest.root, key);
  return node && node->kind == VS_NODE_TEXT ? node->text : "";
}

/* ---- the verdict ---- */

void vs_study_page_wilson(double good, double n, double *least, double *largest) {
  const double z = 1.959963984540054; /* the normal distribution's quantile with 2.5 % beyond it */
  double p = good / n, middle = p + z * z / (2 * n);
  double half = z * sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  *least = (middle - half) / (1 + z * z / n);
  *largest = (middle + half) / (1 + z * z / n);
}

double vs_study_page_share(long part, long whole) {
  return whole ? floor(1e4 * (double)part / (double)whole) / 100 : 0;
}

static void add_weakest(vs_html *html, const vs_counts *weakest, long judged) {
  if (!weakest->count) return;
  vs_html_add(html, "<p>Weakest part:</p>\n<div "
                    "class=\"wide\"><table><tr><th>part</th><th>cases</th><th>share</th>"
                    "<th></th></tr>\n");
  for (size_t k = 0; k < weakest->count; k++) {
    double share = vs_study_page_share(weakest->item[k].times, judged);
    vs_html_add(html, "<tr>");
    vs_html_cell(html, weakest->item[k].name);
    vs_html_add(html,
                "<td class=\"n\">%ld</td><td class=\"n\">%.4g %%</td><td class=\"bars\"><span "
                "class=\"bar\" "
                "style=\"width:%.2f%%\"></span></td></tr>\n",
                weakest->item[k].times, share, share);
  }
  vs_html_add(html, "</table></div>\n");
}

static void add_failures(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  if (!t->failed) {
    vs_html_add(html, "<p>No case failed.</p>\n");
    return;
  }
  vs_html_add(html, "<p>Failed, and in no figure here: %ld of %ld cases.</p>\n", t->failed,
              t->done + t->failed);
  if (!s->why.count) {
    vs_html_add(html, "<p>Why is not known: failures.csv is not there.</p>\n");
    return;
  }
  vs_html_add(html, "<div class=\"wide prose\"><table><tr><th>cases</th><th>why</th></tr>\n");
  for (size_t k = 0; k < s->why.count; k++) {
    vs_html_add(html, "<tr><td class=\"n\">%ld</td>", s->why.item[k].times);
    vs_html_cell(html, s->why.item[k].name);
    vs_html_add(html, "</tr>\n");
  }
  vs_html_add(html, "</table></div>\n");
}

/* Adds where a case lies: "circuit.r1 = 330 Ω, circuit.c1 = 47 nF". With `ranged` only the axes
 * that have a range, without those that have a spread. */
static void add_place(vs_html *html, const vs_folder *t, char *const *cell, bool ranged) {
  size_t n = 0;
  for (size_t c = 0; c < t->count; c++) {
    if (t->column[c].role != VS_ROLE_AXIS || !*cell[c]) continue;
    if (ranged && !vs_tree_child(t->column[c].node, "from")) continue;
    char unit[64];
    vs_scale_unit(t->column[c].unit, unit, sizeof unit);
    vs_html_add(html, n++ ? ", " : "");
    vs_html_text(html, t->column[c].name);
    vs_html_add(html, " = ");
    double value;
    if (vs_folder_number(cell[c], &value) && !isnan(value))
      vs_html_add(html, "%.5g", value);
    else
      vs_html_text(html, cell[c]);
    vs_html_add(html, *unit ? " " : "");
    vs_html_text(html, unit);
  }
}

/* Adds the result of a search that judges a case by several measures; false: there was no such
 * search. */
static bool add_best(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  if (!t->search || t->search->report.aim || !vs_folder_search(t)) return false;
  const char *none = t->search->report.none;
  if (!s->found.cell && none) vs_html_add(html, "<p class=\"big\">%s</p>\n", none);
  if (!s->found.cell) return none != NULL;
  bool ranged = false; /* a design's axes are lists, without ranges */
  for (size_t c = 0; c < t->count; c++)
    ranged =
        ranged || (t->column[c].role == VS_ROLE_AXIS && vs_tree_child(t->column[c].node, "from"));
  vs_html_add(html, "<p class=\"big\">%s: ", t->search->report.best);
  add_place(html, t, s->found.cell, ranged);
  vs_html_add(html, "; case %s</p>\n<p>What follows is of all that was tried.</p>\n",
              s->found.cell[0]);
  return true;
}

/* Adds the largest or least value that a search has found; false: there was no such search. */
static bool add_found(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  bool largest;
  size_t aim = vs_folder_aim(t, &largest);
  if (!t->search || !t->search->report.aim || !aim || !s->profile[aim].known) return false;
  vs_scale scale = vs_scale_of(&t->column[aim], vs_study_results_extent(&s->profile[aim]));
  double found = scale.factor * (largest ? s->profile[aim].largest : s->profile[aim].least);
  vs_html_add(html, "<p class=\"big\">%s: ", t->search->report.best);
  vs_html_text(html, t->column[aim].name);
  vs_html_add(html, " %.6g %s, case %s</p>\n", found, scale.unit, s->worst[0].cell[0]);
  const vs_node *says = vs_tree_child(vs_folder_search(t), "says");
  if (says && says->text) {
    vs_html_add(html, "<p>");
    vs_html_text(html, says->text);
    vs_html_add(html, "</p>\n");
  }
  return true;
}

/* Adds the yield. A failed case counts as not holding, as it is not known to hold. */
static void add_yield(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  double least, largest;
  const long all = s->judged + t->failed;
  vs_html_add(html, "<p class=\"big\">Yield %.4g %%</p>\n<p>%ld of %ld cases keep every rating",
              vs_study_page_share(s->good, all), s->good, all);
  if (t->failed) vs_html_add(html, ", the failed counted as not holding");
  vs_study_page_wilson((double)s->good, (double)all, &least, &largest);
  bool independent = false;
  for (size_t k = 0; k < t->n_methods; k++)
    independent = independent || t->methods[k]->report.independent;
  if (independent)
    vs_html_add(html, "; with 95 %%, the true share lies between %.4g %% and %.4g %%", 100 * least,
                100 * largest);
  vs_html_add(html, ".</p>\n");
}

static void add_worst_margin(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  vs_html_add(html, "%.4g %%", 100 * s->profile[t->margin].least);
  if ((t->search && t->search->report.aim) || !s->n_worst || t->weakest < 0) return;
  vs_html_add(html, ": ");
  vs_html_text(html, s->worst[0].cell[t->weakest]);
  vs_html_add(html, ", case %s", s->worst[0].cell[0]);
}

static void add_count(vs_html *html, long count, const char *of_what) {
  if (!count) return;
  vs_html_add(html, "<p>%ld case%s ", count, count > 1 ? "s" : "");
  vs_html_text(html, of_what);
  vs_html_add(html, ".</p>\n");
}

/* Adds what makes the verdict less than certain. */
static void add_doubts(vs_html *html, const vs_study_results *s) {
  vs_text undecided = {0};
  vs_text_add(&undecided, "undecided: the sign of a margin is within its numerical error");
  for (size_t k = 0; k < s->doubtful.count; k++)
    vs_text_add(&undecided, "%s%s in %ld", k ? ", " : ", that of ", s->doubtful.item[k].name,
                s->doubtful.item[k].times);
  add_count(html, s->undecided, undecided.text);
  vs_text_free(&undecided);
  add_count(html, s->unverified,
            "unverified: the numerical error of the margins was not computed (run.verify: always "
            "does so)");
  add_count(
      html, s->climbed,
      "on a rung of the ladder beyond the first: the solver gave up on the scene as it is; see "
      "column rung");
  add_count(html, s->warned, "with warnings; see column warnings");
}

/* Adds what happened in how many cases. */
static void add_happened(vs_html *html, const vs_study_results *s) {
  for (size_t k = 0; k < s->happened.count; k++) {
    vs_html_add(html, "<p>Happened in %ld case%s: ", s->happened.item[k].times,
                s->happened.item[k].times > 1 ? "s" : "");
    vs_html_text(html, s->happened.item[k].name);
    vs_html_add(html, ".</p>\n");
  }
}

static void add_not_judged(vs_html *html, const vs_study_results *s) {
  if (!s->not_judged.count) return;
  vs_html_add(html, "<p>Not judged: ");
  vs_html_text(html, s->not_judged.item[0].name);
  vs_html_add(html, "%s.</p>\n",
              s->not_judged.count > 1 ? "; in other cases other limits: column not_judged" : "");
}

/* Adds which lines are judged by such figures: a verdict by them is as good as they are. */
static void add_unsure(vs_html *html, const vs_folder *t, const char *word, const char *says) {
  const vs_node *lines = vs_tree_child(t->manifest.root, "lines");
  bool any = false;
  for (const vs_node *n = lines ? lines->child : NULL; n; n = n->next) {
    if (strcmp(vs_member_word(n, word), "true") != 0) continue;
    if (any)
      vs_html_add(html, ", ");
    else
      vs_html_add(html, "<p>Judged by %s figures, which no source %s: ", word, says);
    vs_html_text(html, vs_member_word(n, "name"));
    any = true;
  }
  if (any) vs_html_add(html, ".</p>\n");
}

/* Adds how many cases hold and the worst margin. found: a search's result stands above in large
 * letters already. */
static void add_share(vs_html *html, const vs_folder *t, const vs_study_results *s, bool found) {
  const char *begin = found ? "<p>" : "<p class=\"big\">";
  if (!s->rows)
    vs_html_add(html, "<p class=\"big\">No case has a result</p>\n");
  else if (!s->judged) {
    vs_html_markup(html, begin);
    vs_html_add(html, "No rating was judged: what ran has none.</p>\n");
  } else if (vs_folder_is_sampled(t)) {
    add_yield(html, t, s);
    vs_html_add(html, "<p>Worst margin ");
    add_worst_margin(html, t, s);
    vs_html_add(html, ".</p>\n");
  } else {
    vs_html_markup(html, begin);
    vs_html_add(html, "Worst margin ");
    add_worst_margin(html, t, s);
    vs_html_add(html, "</p>\n<p>%ld of %ld cases keep every rating.</p>\n", s->good, s->judged);
  }
}

/* Adds the case whose least margin is largest: the one to choose. Not for a sample, whose cases are
 * random, and not for a search, which reports its own result. */
static void add_best_case(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  if (!s->best.cell || s->judged < 2 || t->search || vs_folder_is_sampled(t)) return;
  vs_html_add(html, "<p>The best case: ");
  add_place(html, t, s->best.cell, false);
  vs_html_add(html, "; its least margin is %.4g %%", -100 * s->best.key);
  if (t->weakest >= 0 && *s->best.cell[t->weakest]) {
    vs_html_add(html, ", of ");
    vs_html_text(html, s->best.cell[t->weakest]);
  }
  vs_html_add(html, ".</p>\n");
}

static void add_verdict(vs_html *html, const vs_folder *t, const vs_study_results *s) {
  bool good = s->good == s->judged && !t->failed;
  if (t->search && t->search->report.none && vs_folder_search(t)) good = s->found.cell != NULL;
  vs_html_add(html, "<section id=\"verdict\" class=\"verdict %s\">\n",
              !s->judged ? ""
              : good     ? "good"
                         : "bad");
  add_share(html, t, s, add_found(html, t, s) || add_best(html, t, s));
  if (s->n_worst && vs_study_results_ranked(t, s)) {
    vs_html_add(html, "<p>The worst case: ");
    add_place(html, t, s->worst[0].cell, false);
    vs_html_add(html, ".</p>\n");
  }
  add_best_case(html, t, s);
  add_happened(html, s);
  add_not_judged(html, s);
  if (s->judged) add_unsure(html, t, "assumed", "says");
  if (s->judged) add_unsure(html, t, "typical", "guarantees");
  add_doubts(html, s);
  if (s->judged && s->judged < s->rows)
    vs_html_add(html, "<p>Without a margin: %ld cases.</p>\n", s->rows - s->judged);
  if (t->done + t->failed < t->cases && !t->search)
    vs_html_add(html, "<p>Not complete: %ld of %ld cases have been run.</p>\n", t->done + t->failed,
                t->cases);
  add_weakest(html, &s->weakest, s->judged);
  add_failures(html, t, s);
  vs_html_add(html, "</section>\n");
}

/* ---- pictures ---- */

static void add_pictures(vs_html *html, const vs_study_pictures *album, char *const *svg) {
  vs_html_add(html, "<section id=\"pictures\">\n<h2>Pictures</h2>\n");
  vs_html_add(html, album->count
                        ? "<p class=\"of screen\">A click shows where the mouse is, one on "
                          "a line's name hides that line; Ctrl and the wheel zoom, the "
                          "right button goes back.</p>\n"
                        : "<p>There is nothing to draw.</p>\n");
  vs_html_add(html, "<div class=\"pictures\">\n");
  for (size_t k = 0; k < album->count; k++) {
    const vs_picture *p = &album->item[k];
    const vs_html_picture picture = {p->title.text, p->caption.text, svg[k],
                                     p->width,      p->height,       NULL};
    vs_html_picture_add(html, &picture);
  }
  vs_html_add(html, "</div>\n");
  if (album->left_out)
    vs_html_add(html, "<p>Not drawn, for there is no more room: %zu.</p>\n", album->left_out);
  vs_html_add(html, "</section>\n");
}

void vs_study_page_write(const vs_folder *t, const vs_study_results *s,
                         const vs_study_pictures *album, char *const *svg, vs_html *html) {
  const char *study = manifest_text(t, "study");
  if (!*study) study = "without a name";
  vs_html_begin(html, "Study", study);
  vs_html_add(html, "<p class=\"of\">");
  vs_html_text(html, t->method);
  vs_html_add(html, ", %ld cases</p>\n", t->done + t->failed);
  add_verdict(html, t, s);
  add_pictures(html, album, svg);
  tables_cases(html, t, s);
  vs_html_add(html, "<section id=\"parameters\">\n");
  tables_axes(html, t, s);
  tables_columns(html, t, s);
  tables_manifest(html, t);
  vs_html_add(html, "</section>\n");
  vs_html_end(html);
}
