/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/run_page.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/field.h"
#include "base/tree.h"
#include "members.h"
#include "report/html.h"
#include "report/margin_bars.h"
#include "run/engineering.h"
#include "run_pair.h"
#include "waveforms.h"

void vs_run_page_head(vs_html *html, const char *folder, const vs_node *summary, double until_s) {
  char until[VS_ENGINEERING_SIZE];
  vs_html_begin(html, "Run", folder);
  vs_html_add(html, "<p class=\"of\">tier ");
  vs_html_text(html, vs_member_word(summary, "tier"));
  vs_html_add(html, ", %s</p>\n", vs_engineering_text(until_s, "s", until));
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

static void add_verdict_line(vs_html *html, const vs_node *line) {
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

/* Adds a line for each thing that happened, or that was expected and did not happen. */
static void add_happenings(vs_html *html, const vs_node *summary) {
  static const char *const LISTS[] = {"happened", "did_not_happen"};
  for (int k = 0; k < 2; k++) {
    const vs_node *list = vs_tree_child(summary, LISTS[k]);
    for (const vs_node *m = list ? list->child : NULL; m; m = m->next) {
      char at[VS_ENGINEERING_SIZE];
      const double at_s = vs_member_number(vs_tree_child(m, "at_s"));
      const bool expected = !strcmp(vs_member_word(m, "expected"), "true");
      vs_html_add(html,
                  "<p class=\"happened\">%s: ", k ? "Did not happen, though expected" : "Happened");
      vs_html_text(html, vs_member_word(m, "what"));
      vs_html_add(html, " of ");
      vs_html_text(html, vs_member_word(m, "device"));
      if (!isnan(at_s)) vs_html_add(html, " at %s (", vs_engineering_text(at_s, "s", at));
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

/* Adds the verdict: the word of the whole, the weakest line, and all lines. */
static void add_verdict(vs_html *html, const vs_node *summary) {
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
    for (const vs_node *m = verdict->child; m; m = m->next) add_verdict_line(html, m);
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

/* The page, and all measures of the run, for the other end of an extreme. */
typedef struct measures {
  vs_html *html;
  const vs_node *all;
} measures;

/* An extreme smaller than this part of the opposite one is rounding, and shown as 0. */
static const double ZERO_BESIDE = 1e-6;

/* The value of NAME_max for NAME_min, and vice versa; NaN where there is none. */
static double other_end(const vs_node *all, const char *name) {
  char other[VS_NAME_SIZE];
  const size_t n = strlen(name);
  const bool is_min = n > 4 && !strcmp(name + n - 4, "_min");
  if (n >= sizeof other || n < 5 || (!is_min && strcmp(name + n - 4, "_max"))) return NAN;
  snprintf(other, sizeof other, "%.*s%s", (int)n - 4, name, is_min ? "_max" : "_min");
  return vs_member_number(vs_tree_child(vs_tree_child(all, other), "value"));
}

static void add_measure(void *ctx, const char *name, const vs_node *a, const vs_node *b) {
  const measures *m = ctx;
  vs_html *html = m->html;
  char amount[VS_ENGINEERING_SIZE];
  double value = vs_member_number(vs_tree_child(a, "value")),
         at = vs_member_number(vs_tree_child(a, "at_s"));
  (void)b;
  if (fabs(value) < ZERO_BESIDE * fabs(other_end(m->all, name))) value = 0;
  vs_html_add(html, "<tr>");
  vs_html_cell(html, name);
  vs_html_add(html, "<td class=\"n\">");
  vs_html_text(html, isnan(value) ? "not known"
                                  : vs_engineering_text(value, vs_member_word(a, "unit"), amount));
  vs_html_add(html, "</td><td class=\"n\">%s</td></tr>\n",
              isnan(at) ? "" : vs_engineering_text(at, "s", amount));
}

static void add_measures(vs_html *html, const vs_node *summary) {
  vs_html_add(html, "<section id=\"measures\">\n<h2>Measures</h2>\n<div class=\"wide\"><table>"
                    "<tr><th>measure</th><th>value</th><th>at</th></tr>\n");
  measures m = {html, vs_tree_child_map(summary, "measures")};
  vs_members_join(m.all, NULL, add_measure, &m);
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

/* Adds every effective key of the scene. */
static void add_parameters(vs_html *html, const vs_node *summary) {
  vs_html_add(html, "<section id=\"parameters\">\n<h2>Parameters</h2>\n<div class=\"wide\"><table>"
                    "<tr><th>key</th><th>value</th></tr>\n");
  vs_members_unlike(vs_tree_child_map(summary, "scene"), NULL, add_parameter, html);
  vs_html_add(html, "</table></div>\n</section>\n");
}

/* ---- energy flow: where the energy of a run went, as a table with bars ---- */

/* The flows of energy; an indented one is a part of the one above it. */
static const struct {
  const char *key, *text;
  int depth;
} FLOWS[] = {{"source_J", "from the source", 0},
             {"losses_J", NULL, 1},
             {"stores_J", NULL, 1},
             {"eva_J", "into the EVA", 1},
             {"copper_J", "heat in the winding", 2},
             {"magnetic_J", "stored in the field", 2},
             {"work_force_J", "work of the force", 2},
             {"damping_J", "lost in dampers", 3},
             {"stop_J", "lost in stops", 3},
             {"mechanical_J", "stored in motion and springs", 3}};

/* Adds a row, with its share of the largest flow as a bar. A flow of 0 is left out. */
static void add_energy_row(vs_html *html, const char *text, int depth, double joule, double whole) {
  char amount[VS_ENGINEERING_SIZE], part[32] = "< 0.01 %";
  double share = joule / whole;
  if (!(fabs(share) < 1e-4)) snprintf(part, sizeof part, "%.3g %%", 100 * share);
  if (isnan(joule) || joule == 0) return;
  vs_html_add(html, "<tr><td style=\"padding-left:%.1frem\">", 0.5 + 1.2 * depth);
  vs_html_text(html, text);
  vs_html_add(html,
              "</td><td class=\"n\">%s</td><td class=\"n\">%s</td><td class=\"bars\">"
              "<span class=\"bar%s\" style=\"width:%.2f%%\"></span></td></tr>\n",
              vs_engineering_text(joule, "J", amount), part, joule < 0 ? " back" : "",
              fmin(100, 100 * fabs(share)));
}

/* Adds each account of the deck: "losses_J": {"r1": ...}. */
static void add_accounts(vs_html *html, const vs_node *accounts, const char *what, double whole) {
  for (const vs_node *m = accounts ? accounts->child : NULL; m; m = m->next) {
    vs_text text = {0};
    vs_text_add(&text, "%s %s", what, m->key);
    add_energy_row(html, text.text, 1, vs_member_number(m), whole);
    vs_text_free(&text);
  }
}

/* Adds the section. energy: that member of summary.json; NULL: nothing is added. */
static void add_energy_flow(vs_html *html, const vs_node *energy) {
  double whole = 0;
  if (!energy) return;
  for (size_t k = 0; k < sizeof FLOWS / sizeof *FLOWS; k++)
    if (FLOWS[k].text)
      whole = fmax(whole, fabs(vs_member_number(vs_tree_child(energy, FLOWS[k].key))));
  vs_html_add(html,
              "<section id=\"energy\">\n<h2>Energy flow</h2>\n<div class=\"wide\"><table>"
              "<tr><th>what</th><th>energy</th><th>share</th><th class=\"bars\"></th></tr>\n");
  for (size_t k = 0; k < sizeof FLOWS / sizeof *FLOWS && whole > 0; k++) {
    const vs_node *node = vs_tree_child(energy, FLOWS[k].key);
    if (FLOWS[k].text)
      add_energy_row(html, FLOWS[k].text, FLOWS[k].depth, vs_member_number(node), whole);
    else
      add_accounts(html, vs_tree_child_map(energy, FLOWS[k].key),
                   !strcmp(FLOWS[k].key, "losses_J") ? "lost in" : "stored in", whole);
  }
  vs_html_add(html,
              "</table></div>\n<p class=\"of\">Shares are of the largest of these. What is 0 is "
              "left out. The audit: ");
  vs_html_text(html, vs_member_word(energy, "audit"));
  vs_html_add(html, ".</p>\n</section>\n");
}

/* ---- the page ---- */

void vs_run_page_verdict(vs_html *html, const vs_node *summary) {
  add_verdict(html, summary);
  add_energy_flow(html, vs_tree_child(summary, "energy"));
}

void vs_run_page_values(vs_html *html, const vs_node *summary) {
  add_measures(html, summary);
  add_parameters(html, summary);
}

vs_status vs_run_page_write(const char *folder, bool quiet, vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_tree summary = {0};
  vs_html html = {0};
  snprintf(path, sizeof path, "%s/summary.json", folder);
  if (access(path, R_OK)) return VS_OK;
  vs_time_window *s = vs_alloc(1, sizeof *s);
  vs_status status = vs_waveforms_open(s, &folder, 1, err);
  if (!status) status = vs_tree_read(path, &summary, err);
  if (!status) {
    vs_run_page_head(&html, folder, summary.root, s->to_s);
    status = vs_margin_bars_add(summary.root, &html, err);
  }
  if (!status) {
    vs_run_page_verdict(&html, summary.root);
    status = vs_waveforms_add(s, &html, err);
    vs_run_page_values(&html, summary.root);
    vs_html_end(&html);
  }
  if (!status) status = vs_html_write(&html, folder, quiet, err);
  vs_tree_free(&summary);
  vs_html_free(&html);
  vs_waveforms_close(s);
  free(s);
  return status;
}
