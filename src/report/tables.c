/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tables.h"

#include <string.h>

#include "report/html.h"

enum { MOST_ITEMS = 24 };

/* Adds what a node of the manifest says, on one line. */
static void add_node(vs_html *html, const vs_node *node) {
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
    add_node(html, c);
    if (nested) vs_html_add(html, ")");
  }
  if (n > MOST_ITEMS + 1) vs_html_add(html, " (%zu of them)", n);
}

void vs_tables_cases(vs_html *html, const vs_folder *t, const vs_survey *s) {
  if (!s->n_worst) return;
  vs_html_add(html,
              "<section id=\"cases\">\n<h2>The %s cases</h2>\n<div class=\"wide\"><table><tr>",
              vs_survey_ranked(t, s) ? "worst" : "first");
  for (size_t c = 0; c < t->count; c++) {
    vs_html_add(html, "<th>");
    vs_html_text(html, t->column[c].title);
    vs_html_add(html, "</th>");
  }
  vs_html_add(html, "</tr>\n");
  for (size_t k = 0; k < s->n_worst; k++) {
    vs_html_add(html, "<tr>");
    for (size_t c = 0; c < t->count; c++) {
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

/* True if the table says that of an axis in a column of its own. */
static bool is_said(const char *key) {
  static const char *const SAID[] = {"key", "unit", "column", "text"};
  for (size_t k = 0; k < sizeof SAID / sizeof *SAID; k++)
    if (!strcmp(key, SAID[k])) return true;
  return false;
}

void vs_tables_axes(vs_html *html, const vs_folder *t, const vs_survey *s) {
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
      add_node(html, v);
    }
    vs_html_add(html, "</td>");
    vs_html_cell(html, t->column[c].text);
    vs_html_add(html, "</tr>\n");
  }
  vs_html_add(html, "</table></div>\n</section>\n");
}

void vs_tables_columns(vs_html *html, const vs_folder *t, const vs_survey *s) {
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

void vs_tables_manifest(vs_html *html, const vs_folder *t) {
  vs_html_add(
      html,
      "<section id=\"manifest\">\n<h2>How it was made</h2>\n<div class=\"wide fold\"><table>\n");
  for (const vs_node *n = t->manifest.root->child; n; n = n->next) {
    if (!n->key || !strcmp(n->key, "axes") || !strcmp(n->key, "report")) continue;
    bool lines = n->kind == VS_NODE_LIST && !strcmp(n->key, "inputs");
    vs_html_add(html, "<tr><th>");
    vs_html_text(html, n->key);
    vs_html_add(html, "</th><td>");
    for (const vs_node *c = n->child; lines && c; c = c->next) {
      add_node(html, c);
      vs_html_add(html, "<br>");
    }
    if (!lines && !strcmp(n->key, "command"))
      for (const vs_node *c = n->child; c; c = c->next) {
        vs_html_text(html, c->text ? c->text : "");
        vs_html_add(html, " ");
      }
    else if (!lines)
      add_node(html, n);
    vs_html_add(html, "</td></tr>\n");
  }
  vs_html_add(html, "</table></div>\n</section>\n");
}
