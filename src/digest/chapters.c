/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "digest/chapters.h"

#include <math.h>
#include <string.h>

#include "compare/members.h"
#include "compare/run_pair.h"
#include "report/html.h"
#include "tell/amount.h"

/* Colours follow the reader's: light or dark. Pictures stay on white. */
static const char STYLE[] =
    ":root{color-scheme:light "
    "dark;--paper:#fff;--ink:#1a1a1a;--dim:#555;--line:#ccc;--head:#f2f2f2;"
    "--good:#0072b2;--bad:#d55e00}"
    "@media(prefers-color-scheme:dark){:root{--paper:#16181c;--ink:#e6e6e6;--dim:#a8a8a8;"
    "--line:#444;--head:#23262c;--good:#56b4e9;--bad:#e8834a}}"
    "body{margin:0;background:var(--paper);color:var(--ink);font:15px/1.45 system-ui,'Liberation "
    "Sans',Arial,sans-serif}main{max-width:1180px;margin:0 auto;padding:1.2rem 1.1rem 3rem}"
    "h1{font-size:1.5rem;margin:.2rem 0;overflow-wrap:anywhere}h2{font-size:1.15rem;margin:2rem 0 "
    ".6rem;border-bottom:1px solid var(--line)}.of{color:var(--dim);margin:0 0 1rem}"
    ".verdict{border:1px solid var(--line);border-left:10px solid #777;padding:.7rem "
    "1.1rem;margin:1rem 0}.good{border-left-color:var(--good)}.bad{border-left-color:var(--bad)}"
    ".big{font-size:1.5rem;font-weight:600;margin:.1rem 0}p{margin:.35rem 0}"
    ".pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,500px),1fr));"
    "gap:1.2rem}figure{margin:0;break-inside:avoid}"
    "iframe{width:100%;border:1px solid var(--line);display:block;background:#fff}"
    "figcaption{font-size:.88rem;color:var(--dim);padding:.3rem .1rem}.wide{overflow-x:auto}"
    "table{border-collapse:collapse;font-size:.88rem;margin:.4rem 0}th,td{border:1px solid "
    "var(--line);padding:.2rem .55rem;text-align:left;white-space:nowrap}"
    "th{background:var(--head)}td.n{text-align:right}.bars{min-width:9rem;width:100%}"
    ".bar{display:block;height:.8em;background:var(--good)}.back{background:var(--bad)}"
    "@media(max-width:600px){#energy td,#energy th{padding:.15rem .3rem}#energy "
    "td:first-child{white-space:normal}"
    "#energy .bars{min-width:3.5rem}}"
    "@media print{main{max-width:none}.screen{display:none}}";

void vs_chapter_head(vs_text *html, const char *folder, const vs_node *summary, double until_s) {
  char until[VS_AMOUNT_SIZE];
  vs_text_add(html, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                    "<meta name=\"viewport\" content=\"width=device-width\">\n<title>Run ");
  vs_html_text(html, folder);
  vs_text_add(html, "</title>\n<style>%s</style>\n</head>\n<body>\n<main>\n<h1>Run ", STYLE);
  vs_html_text(html, folder);
  vs_text_add(html, "</h1>\n<p class=\"of\">tier ");
  vs_html_text(html, vs_member_word(summary, "tier"));
  vs_text_add(html, ", %s</p>\n", vs_amount_text(until_s, "s", until));
}

/* ---- the verdict ---- */

static void add_number(vs_text *html, const vs_node *line, const char *key, double factor,
                       const char *unit) {
  double value = factor * vs_member_number(vs_tree_child(line, key));
  if (isnan(value))
    vs_text_add(html, "<td></td>");
  else
    vs_text_add(html, "<td class=\"n\">%.4g%s%s</td>", value, *unit ? " " : "", unit);
}

static void add_line(vs_text *html, const vs_node *line) {
  const char *device = vs_member_word(line, "device"), *unit = vs_member_word(line, "unit");
  vs_text name = {0};
  if (*device)
    vs_text_add(&name, "%s.%s", device, vs_member_word(line, "measure"));
  else
    vs_text_add(&name, "%s", vs_member_word(line, "rating"));
  vs_text_add(html, "<tr>");
  vs_html_cell(html, name.text);
  vs_text_free(&name);
  vs_html_cell(html, vs_run_pair_word(line));
  add_number(html, line, "margin", 100, "%");
  add_number(html, line, "margin_error", 100, "%");
  add_number(html, line, *device ? "stress" : "least", 1, unit);
  add_number(html, line, *device ? "limit" : "min", 1, unit);
  add_number(html, line, *device ? "" : "largest", 1, unit);
  add_number(html, line, *device ? "" : "max", 1, unit);
  vs_html_cell(html, vs_member_word(line, "text"));
  vs_text_add(html, "</tr>\n");
}

void vs_chapter_verdict(vs_text *html, const vs_node *summary) {
  const vs_node *verdict = vs_tree_child(summary, "verdict");
  bool any = verdict && verdict->child;
  const char *word = vs_run_pair_whole(verdict), *weakest = vs_member_word(summary, "weakest"),
             *first = vs_member_word(summary, "first_to_fail");
  vs_text_add(html, "<section id=\"verdict\" class=\"verdict %s\">\n<p class=\"big\">%s</p>\n",
              !any                    ? ""
              : !strcmp(word, "held") ? "good"
                                      : "bad",
              word);
  if (any && *weakest && strcmp(weakest, "null") != 0) {
    vs_text_add(html, "<p>Weakest: ");
    vs_html_text(html, weakest);
    if (*first && strcmp(first, "null") != 0) {
      vs_text_add(html, "; first to fail: ");
      vs_html_text(html, first);
    }
    vs_text_add(html, ".</p>\n");
  }
  if (any) {
    vs_text_add(html, "<div class=\"wide\"><table><tr><th>what</th><th>word</th><th>margin</th>"
                      "<th>its error</th><th>stress, or least</th><th>limit, or min</th>"
                      "<th>largest</th><th>max</th><th></th></tr>\n");
    for (const vs_node *m = verdict->child; m; m = m->next) add_line(html, m);
    vs_text_add(html, "</table></div>\n");
  }
  const vs_node *warnings = vs_tree_child(summary, "warnings");
  for (const vs_node *m = warnings ? warnings->child : NULL; m; m = m->next) {
    vs_text_add(html, "<p>Warning: ");
    vs_html_text(html, m->text ? m->text : "");
    vs_text_add(html, "</p>\n");
  }
  vs_text_add(html, "</section>\n");
}

/* ---- measures and parameters ---- */

static void add_measure(void *ctx, const char *name, const vs_node *a, const vs_node *b) {
  vs_text *html = ctx;
  char amount[VS_AMOUNT_SIZE];
  double value = vs_member_number(vs_tree_child(a, "value")),
         at = vs_member_number(vs_tree_child(a, "at_s"));
  (void)b;
  vs_text_add(html, "<tr>");
  vs_html_cell(html, name);
  vs_text_add(html, "<td class=\"n\">");
  vs_html_text(html, isnan(value) ? "not known"
                                  : vs_amount_text(value, vs_member_word(a, "unit"), amount));
  vs_text_add(html, "</td><td class=\"n\">%s</td></tr>\n",
              isnan(at) ? "" : vs_amount_text(at, "s", amount));
}

void vs_chapter_measures(vs_text *html, const vs_node *summary) {
  vs_text_add(html, "<section id=\"measures\">\n<h2>Measures</h2>\n<div class=\"wide\"><table>"
                    "<tr><th>measure</th><th>value</th><th>at</th></tr>\n");
  vs_members_join(vs_tree_child(summary, "measures"), NULL, add_measure, html);
  vs_text_add(html, "</table></div>\n</section>\n");
}

static void add_parameter(void *ctx, const char *key, const vs_node *a, const vs_node *b) {
  vs_text *html = ctx, text = {0};
  (void)b;
  vs_member_text(a, &text);
  vs_text_add(html, "<tr>");
  vs_html_cell(html, key);
  vs_html_cell(html, text.text);
  vs_text_add(html, "</tr>\n");
  vs_text_free(&text);
}

void vs_chapter_parameters(vs_text *html, const vs_node *summary) {
  vs_text_add(html, "<section id=\"parameters\">\n<h2>Parameters</h2>\n<div class=\"wide\"><table>"
                    "<tr><th>key</th><th>value</th></tr>\n");
  vs_members_unlike(vs_tree_child(summary, "scene"), NULL, add_parameter, html);
  vs_text_add(html, "</table></div>\n</section>\n");
}
