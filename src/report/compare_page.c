/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/compare_page.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "members.h"
#include "report/html.h"
#include "run/engineering.h"
#include "study/folder.h"
#include "waveforms.h"

static double number_of(const vs_node *map, const char *key) {
  return vs_member_number(vs_tree_child(map, key));
}

/* ---- cells ---- */

/* A value with its unit; "-" where it is not known. */
static void add_amount(vs_html *html, double value, const char *unit) {
  char amount[VS_ENGINEERING_SIZE];
  vs_html_add(html, "<td class=\"n\">");
  vs_html_text(html, isnan(value) ? "-" : vs_engineering_text(value, unit, amount));
  vs_html_add(html, "</td>");
}

static void add_share(vs_html *html, double share, const char *format) {
  vs_html_add(html, "<td class=\"n\">");
  if (isnan(share))
    vs_html_add(html, "-");
  else
    vs_html_add(html, format, 100 * share);
  vs_html_add(html, "</td>");
}

static void begin_table(vs_html *html, const char *id, const char *title, const char *heads) {
  vs_html_add(html, "<section id=\"%s\">\n<h2>%s</h2>\n<div class=\"wide\"><table><tr>", id, title);
  vs_html_markup(html, heads);
  vs_html_add(html, "</tr>\n");
}

static void end_table(vs_html *html, long same, const char *what) {
  vs_html_add(html, "</table></div>\n");
  if (same)
    vs_html_add(html, "<p class=\"of\">%ld %s%s the same in both.</p>\n", same, what,
                same > 1 ? "s are" : " is");
  vs_html_add(html, "</section>\n");
}

/* ---- two runs ---- */

static void add_run(vs_html *html, const vs_node *side, char letter) {
  const char *word = vs_member_word(side, "verdict");
  char until[VS_ENGINEERING_SIZE];
  vs_html_add(html, "<section class=\"verdict %s\">\n<p>%c: ",
              !strcmp(word, "held")              ? "good"
              : !strcmp(word, "no limit stated") ? ""
                                                 : "bad",
              letter);
  vs_html_text(html, vs_member_word(side, "folder"));
  vs_html_add(html, "</p>\n<p class=\"big\">");
  vs_html_text(html, word);
  vs_html_add(html, "</p>\n<p>tier ");
  vs_html_text(html, vs_member_word(side, "tier"));
  vs_html_add(html, ", until %s</p>\n</section>\n",
              vs_engineering_text(number_of(side, "until_s"), "s", until));
}

/* A margin below 0 whose error is not known is shown as violated, too. */
static void add_margin(vs_html *html, const vs_node *line) {
  double margin = number_of(line, "margin");
  const char *word = vs_member_word(line, "word");
  add_share(html, margin, "%.1f %%");
  vs_html_cell(html, margin < 0 && !strcmp(word, "unverified") ? "violated, unverified" : word);
}

static void add_verdict(vs_html *html, const vs_node *lines) {
  if (!lines || !lines->child) return;
  begin_table(html, "verdict", "Margins",
              "<th>limit of</th><th>A</th><th></th><th>B</th><th></th>");
  for (const vs_node *m = lines->child; m; m = m->next) {
    vs_html_add(html, "<tr>");
    vs_html_cell(html, vs_member_word(m, "name"));
    add_margin(html, vs_tree_child(m, "a"));
    add_margin(html, vs_tree_child(m, "b"));
    vs_html_add(html, "</tr>\n");
  }
  end_table(html, 0, "");
}

static void add_key_side(vs_html *html, const vs_node *row, const char *side) {
  const char *word = vs_member_word(row, side);
  vs_html_cell(html, strcmp(word, "null") != 0 ? word : "-");
}

static void add_keys(vs_html *html, const vs_node *keys) {
  begin_table(html, "parameters", "Parameters that differ", "<th>key</th><th>A</th><th>B</th>");
  for (const vs_node *m = keys ? keys->child : NULL; m; m = m->next) {
    vs_html_add(html, "<tr>");
    vs_html_cell(html, vs_member_word(m, "key"));
    add_key_side(html, m, "a");
    add_key_side(html, m, "b");
    vs_html_add(html, "</tr>\n");
  }
  if (!keys || !keys->child) vs_html_add(html, "<tr><td colspan=\"3\">none</td></tr>\n");
  end_table(html, 0, "");
}

/* True if neither run has a value, or both have the same. */
static bool is_same(const vs_node *measure) {
  double apart = number_of(measure, "difference");
  return apart == 0 || (isnan(number_of(measure, "a")) && isnan(number_of(measure, "b")));
}

static void add_measures(vs_html *html, const vs_node *measures) {
  long same = 0;
  begin_table(html, "measures", "Measures that differ",
              "<th>measure</th><th>A</th><th>B</th><th>B - A</th><th>of |A|</th>");
  for (const vs_node *m = measures ? measures->child : NULL; m; m = m->next) {
    const char *unit = vs_member_word(m, "unit"), *other = vs_member_word(m, "unit_b");
    same += is_same(m);
    if (is_same(m)) continue;
    vs_html_add(html, "<tr>");
    vs_html_cell(html, m->key);
    add_amount(html, number_of(m, "a"), unit);
    add_amount(html, number_of(m, "b"), *other ? other : unit);
    add_amount(html, number_of(m, "difference"), unit);
    add_share(html, number_of(m, "relative"), "%+.3g %%");
    vs_html_add(html, "</tr>\n");
  }
  end_table(html, same, "measure");
}

static void add_alone(vs_html *html, const vs_node *names, char letter) {
  if (!names || !names->child) return;
  vs_html_add(html, "<p>Only %c has ", letter);
  for (const vs_node *m = names->child; m; m = m->next) {
    vs_html_text(html, m->text);
    vs_html_add(html, m->next ? ", " : ".</p>\n");
  }
}

static void add_curves(vs_html *html, const vs_node *root) {
  const vs_node *curves = vs_tree_child(root, "curves");
  long same = 0;
  begin_table(html, "curves", "How far the curves lie apart",
              "<th>column</th><th>peak</th><th>largest B - A</th><th>at</th><th>of the peak</th>"
              "<th>rms</th>");
  for (const vs_node *m = curves ? curves->child : NULL; m; m = m->next) {
    same += number_of(m, "largest") == 0;
    if (number_of(m, "largest") == 0) continue;
    vs_html_add(html, "<tr>");
    vs_html_cell(html, m->key);
    vs_html_number(html, number_of(m, "peak"));
    vs_html_number(html, number_of(m, "largest"));
    add_amount(html, number_of(m, "at_s"), "s");
    add_share(html, number_of(m, "largest_relative"), "%.3g %%");
    add_share(html, number_of(m, "rms_relative"), "%.3g %%");
    vs_html_add(html, "</tr>\n");
  }
  end_table(html, same, "curve");
  add_alone(html, vs_tree_child(root, "only_a"), 'A');
  add_alone(html, vs_tree_child(root, "only_b"), 'B');
}

static vs_status add_waves(vs_html *html, const char *a, const char *b, vs_error *err) {
  const char *const folders[] = {a, b};
  vs_time_window *s = vs_alloc(1, sizeof *s);
  vs_status status = vs_waveforms_open(s, folders, 2, err);
  if (!status) status = vs_waveforms_add(s, html, err);
  vs_waveforms_close(s);
  free(s);
  return status;
}

static vs_status add_runs(vs_html *html, const vs_node *root, vs_error *err) {
  const vs_node *a = vs_tree_child(root, "a"), *b = vs_tree_child(root, "b");
  vs_html_add(html, "<div class=\"two\">\n");
  add_run(html, a, 'A');
  add_run(html, b, 'B');
  vs_html_add(html, "</div>\n");
  add_keys(html, vs_tree_child(root, "keys"));
  add_verdict(html, vs_tree_child(root, "verdict"));
  vs_status status = add_waves(html, vs_member_word(a, "folder"), vs_member_word(b, "folder"), err);
  add_measures(html, vs_tree_child(root, "measures"));
  add_curves(html, root);
  return status;
}

/* ---- two studies ---- */

static void add_study(vs_html *html, const vs_node *side, char letter) {
  double judged = number_of(side, "judged"), held = number_of(side, "held");
  vs_html_add(html, "<section class=\"verdict %s\">\n<p>%c: ",
              judged == 0      ? ""
              : held == judged ? "good"
                               : "bad",
              letter);
  vs_html_text(html, vs_member_word(side, "folder"));
  vs_html_add(html,
              "</p>\n<p class=\"big\">%.0f of %.0f judged are held</p>\n<p>%.0f cases with a "
              "result, %.0f failed</p>\n</section>\n",
              held, judged, number_of(side, "rows"), number_of(side, "failed"));
}

static void add_changes(vs_html *html, const vs_node *root) {
  const vs_node *list = vs_tree_child(root, "changes");
  double changed = number_of(root, "changed"), shown = 0;
  if (!(changed > 0)) return;
  begin_table(html, "verdict", "Cases with another verdict",
              "<th>case of A</th><th>A</th><th>case of B</th><th>B</th>");
  for (const vs_node *m = list ? list->child : NULL; m; m = m->next, shown++) {
    vs_html_add(html, "<tr><td class=\"n\">%.0f</td>", number_of(m, "case_a"));
    vs_html_cell(html, vs_member_word(m, "word_a"));
    vs_html_add(html, "<td class=\"n\">%.0f</td>", number_of(m, "case_b"));
    vs_html_cell(html, vs_member_word(m, "word_b"));
    vs_html_add(html, "</tr>\n");
  }
  vs_html_add(html, "</table></div>\n");
  if (changed > shown) vs_html_add(html, "<p class=\"of\">And %.0f more.</p>\n", changed - shown);
  vs_html_add(html, "</section>\n");
}

static void add_columns(vs_html *html, const vs_node *columns) {
  static const char *const NUMBERS[] = {"least_a",   "largest_a",       "least_b",
                                        "largest_b", "mean_difference", "largest_difference",
                                        "at_case_b", "only_a",          "only_b"};
  begin_table(html, "columns", "Columns",
              "<th>column</th><th>least of A</th><th>largest of A</th><th>least of B</th>"
              "<th>largest of B</th><th>mean B - A</th><th>largest B - A</th><th>at B's case</th>"
              "<th>rows in A alone</th><th>in B alone</th>");
  for (const vs_node *m = columns ? columns->child : NULL; m; m = m->next) {
    vs_html_add(html, "<tr>");
    vs_html_cell(html, m->key);
    for (size_t k = 0; k < sizeof NUMBERS / sizeof *NUMBERS; k++)
      vs_html_number(html, number_of(m, NUMBERS[k]));
    vs_html_add(html, "</tr>\n");
  }
  end_table(html, 0, "");
}

static vs_status add_studies(vs_html *html, const vs_node *root, vs_error *err) {
  const vs_node *a = vs_tree_child(root, "a"), *b = vs_tree_child(root, "b");
  double joined = number_of(root, "joined");
  (void)err;
  vs_html_add(html, "<div class=\"two\">\n");
  add_study(html, a, 'A');
  add_study(html, b, 'B');
  vs_html_add(html,
              "</div>\n<p>%.0f rows joined by %s; %.0f in A alone, %.0f in B alone. %.0f of the "
              "joined have another verdict.</p>\n",
              joined,
              !strcmp(vs_member_word(root, "joined_by"), "axes") ? "the values of their axes"
                                                                 : "the number of the case",
              number_of(a, "rows") - joined, number_of(b, "rows") - joined,
              number_of(root, "changed"));
  add_changes(html, root);
  add_columns(html, vs_tree_child(root, "columns"));
  return VS_OK;
}

/* ---- the page ---- */

vs_status vs_compare_page_check(const char *folder, vs_error *err) {
  const char *what = vs_folder_here(folder) ? "study" : vs_traces_here(folder) ? "run" : NULL;
  return what ? vs_fail(err, VS_INPUT,
                        "-o %.500s: holds a %s, whose own report.html the page would replace; name "
                        "another folder",
                        folder, what)
              : VS_OK;
}

static vs_status write_page(const vs_html *html, const char *folder, vs_error *err) {
  int made = 0;
  vs_status status = vs_file_folder_make(folder, &made, err);
  if (!status) status = vs_html_write(html, folder, true, err);
  if (status) vs_file_folder_unmake(folder, made);
  return status;
}

vs_status vs_compare_page_write(const char *json, const char *folder, vs_error *err) {
  vs_tree told = {0};
  vs_html html = {0};
  vs_text name = {0};
  vs_status status = vs_tree_parse(json, "compare --json", &told, err);
  if (!status) {
    const vs_node *a = vs_tree_child(told.root, "a"), *b = vs_tree_child(told.root, "b");
    bool runs = !strcmp(vs_member_word(told.root, "compared"), "runs");
    vs_text_add(&name, "%s and %s", vs_member_word(a, "folder"), vs_member_word(b, "folder"));
    vs_html_begin(&html, "Compare", name.text);
    status = (runs ? add_runs : add_studies)(&html, told.root, err);
    vs_html_end(&html);
  }
  if (!status) status = write_page(&html, folder, err);
  vs_tree_free(&told);
  vs_html_free(&html);
  vs_text_free(&name);
  return status;
}
