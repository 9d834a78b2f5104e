/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "chapters.h"

#include <math.h>
#include <string.h>

#include "members.h"
#include "run_pair.h"
#include "report/html.h"
#include "run/amount.h"

void vs_chapter_head(vs_html *html, const char *folder, const vs_node *summary, double until_s) {
  char until[VS_AMOUNT_SIZE];
  vs_html_begin(html, "Run", folder);
  vs_html_add(html, "<p class=\"of\">tier ");
  vs_html_text(html, vs_member_word(summary, "tier"));
  vs_html_add(html, ", %s</p>\n", vs_amount_text(until_s, "s", until));
}

/* ---- the verdict ---- */

static void add_number(vs_html *html, const vs_node *line, const char *key, double factor,
                       const char *unit) {
  double value = factor * vs_member_number(vs_tree_child(line, key));
  if (isnan(value))
    vs_html_add(html, "<td></td>");
  else
    vs_html_add(html,
                fabs(value) >= 1e4 && fabs(value) < 1e6 ? "<td class=\"n\">%.0f%s%s</td>"
                                                        : "<td class=\"n\">%.4g%s%s</td>",
                value, *unit ? " " : "", unit);
}

static void add_line(vs_html *html, const vs_node *line) {
  const char *device = vs_member_word(line, "device"), *unit = vs_member_word(line, "unit");
  vs_text name = {0};
  if (*device)
    vs_text_add(&name, "%s.%s", device, vs_member_word(line, "measure"));
  else
    vs_text_add(&name, "%s", vs_member_word(line, "rating"));
  vs_html_add(html, "<tr>");
  vs_html_cell(html, name.text);
  vs_text_free(&name);
  vs_html_cell(html, vs_run_pair_word(line));
  add_number(html, line, "margin", 100, "%");
  add_number(html, line, "margin_error", 100, "%");
  add_number(html, line, *device ? "stress" : "least", 1, unit);
  add_number(html, line, *device ? "limit" : "min", 1, unit);
  add_number(html, line, *device ? "" : "largest", 1, unit);
  add_number(html, line, *device ? "" : "max", 1, unit);
  vs_html_add(html, "<td class=\"text\">");
  vs_html_text(html, vs_member_word(line, "text"));
  if (*device) vs_html_text(html, vs_member_word(line, "unknown"));
  vs_html_add(html, "</td></tr>\n");
}

/* A line for each thing that happened, or did not though it was expected. */
static void add_happenings(vs_html *html, const vs_node *summary) {
  static const char *const LISTS[] = {"happened", "did_not_happen"};
  for (int k = 0; k < 2; k++) {
    const vs_node *list = vs_tree_child(summary, LISTS[k]);
    for (const vs_node *m = list ? list->child : NULL; m; m = m->next) {
      char at[VS_AMOUNT_SIZE];
      const double at_s = vs_member_number(vs_tree_child(m, "at_s"));
      const bool expected = !strcmp(vs_member_word(m, "expected"), "true");
      vs_html_add(html,
                  "<p class=\"happened\">%s: ", k ? "Did not happen, though expected" : "Happened");
      vs_html_text(html, vs_member_word(m, "what"));
      vs_html_add(html, " of ");
      vs_html_text(html, vs_member_word(m, "device"));
      if (!isnan(at_s)) vs_html_add(html, " at %s (", vs_amount_text(at_s, "s", at));
      if (!isnan(at_s)) vs_html_text(html, vs_member_word(m, "cause"));
      vs_html_add(html, "%s%s.</p>\n", isnan(at_s) ? "" : ")",
                  !k && expected ? ", as expected" : "");
    }
  }
}

static void add_left_out(vs_html *html, const char *what, const vs_node *list) {
  if (!list || !list->child) return;
  vs_html_add(html, "<p>%s: ", what);
  for (const vs_node *m = list->child; m; m = m->next) {
    vs_html_text(html, m->text ? m->text : "");
    vs_html_add(html, m->next ? ", " : ".</p>\n");
  }
}

void vs_chapter_verdict(vs_html *html, const vs_node *summary) {
  const vs_node *verdict = vs_tree_child(summary, "verdict");
  bool any = verdict && verdict->child;
  const char *word = vs_run_pair_whole(verdict), *weakest = vs_member_word(summary, "weakest"),
             *first = vs_member_word(summary, "first_to_fail");
  vs_html_add(html, "<section id=\"verdict\" class=\"verdict %s\">\n<p class=\"big\">%s</p>\n",
              !any                    ? ""
              : !strcmp(word, "held") ? "good"
                                      : "bad",
              word);
  if (any && *weakest && strcmp(weakest, "null") != 0) {
    vs_html_add(html, "<p>Weakest: ");
    vs_html_text(html, weakest);
    if (*first && strcmp(first, "null") != 0) {
      vs_html_add(html, "; first to fail: ");
      vs_html_text(html, first);
    }
    vs_html_add(html, ".</p>\n");
  }
  add_happenings(html, summary);
  if (any) add_left_out(html, "Waived", vs_tree_child(summary, "waived"));
  if (any) add_left_out(html, "Not judged", vs_tree_child(summary, "not_judged"));
  if (any) {
    vs_html_add(html, "<div class=\"wide\"><table><tr><th>what</th><th>word</th><th>margin</th>"
                      "<th>its error</th><th>stress, or least</th><th>limit, or min</th>"
                      "<th>largest</th><th>max</th><th></th></tr>\n");
    for (const vs_node *m = verdict->child; m; m = m->next) add_line(html, m);
    vs_html_add(html, "</table></div>\n");
  }
  const vs_node *warnings = vs_tree_child(summary, "warnings");
  for (const vs_node *m = warnings ? warnings->child : NULL; m; m = m->next) {
    vs_html_add(html, "<p>Warning: ");
    vs_html_text(html, m->text ? m->text : "");
    vs_html_add(html, "</p>\n");
  }
  vs_html_add(html, "</section>\n");
}

/* ---- measures and parameters ---- */

static void add_measure(void *ctx, const char *name, const vs_node *a, const vs_node *b) {
  vs_html *html = ctx;
  char amount[VS_AMOUNT_SIZE];
  double value = vs_member_number(vs_tree_child(a, "value")),
         at = vs_member_number(vs_tree_child(a, "at_s"));
  (void)b;
  vs_html_add(html, "<tr>");
  vs_html_cell(html, name);
  vs_html_add(html, "<td class=\"n\">");
  vs_html_text(html, isnan(value) ? "not known"
                                  : vs_amount_text(value, vs_member_word(a, "unit"), amount));
  vs_html_add(html, "</td><td class=\"n\">%s</td></tr>\n",
              isnan(at) ? "" : vs_amount_text(at, "s", amount));
}

void vs_chapter_measures(vs_html *html, const vs_node *summary) {
  vs_html_add(html, "<section id=\"measures\">\n<h2>Measures</h2>\n<div class=\"wide\"><table>"
                    "<tr><th>measure</th><th>value</th><th>at</th></tr>\n");
  vs_members_join(vs_tree_child(summary, "measures"), NULL, add_measure, html);
  vs_html_add(html, "</table></div>\n</section>\n");
}

static void add_parameter(void *ctx, const char *key, const vs_node *a, const vs_node *b) {
  vs_html *html = ctx;
  vs_text text = {0};
  (void)b;
  vs_member_text(a, &text);
  vs_html_add(html, "<tr>");
  vs_html_cell(html, key);
  vs_html_cell(html, text.text);
  vs_html_add(html, "</tr>\n");
  vs_text_free(&text);
}

void vs_chapter_parameters(vs_html *html, const vs_node *summary) {
  vs_html_add(html, "<section id=\"parameters\">\n<h2>Parameters</h2>\n<div class=\"wide\"><table>"
                    "<tr><th>key</th><th>value</th></tr>\n");
  vs_members_unlike(vs_tree_child(summary, "scene"), NULL, add_parameter, html);
  vs_html_add(html, "</table></div>\n</section>\n");
}
