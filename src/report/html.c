/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/html.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"

/* On narrow paper a table scrolls in its own frame (.wide), never the page. */
static const char STYLE[] =
    ":root{color-scheme:light "
    "dark;--paper:#fff;--ink:#1a1a1a;--dim:#555;--line:#ccc;--head:#f2f2f2;--good:#0072b2;--bad:#"
    "d55e00}@media(prefers-color-scheme:dark){:root{--paper:#16181c;--ink:#e6e6e6;--dim:#a8a8a8;--"
    "line:#444;--head:#23262c;--good:#56b4e9;--bad:#e8834a}}body{margin:0;background:var(--paper);"
    "color:var(--ink);font:15px/1.45 system-ui,'Liberation "
    "Sans',Arial,sans-serif}main{max-width:1180px;margin:0 auto;padding:1.2rem 1.1rem "
    "3rem}h1{font-size:1.5rem;margin:.2rem "
    "0;overflow-wrap:anywhere}h2{font-size:1.15rem;margin:2rem 0 .6rem;border-bottom:1px solid "
    "var(--line)}.of{color:var(--dim);margin:0 0 1rem}.verdict{border:1px solid "
    "var(--line);border-left:10px solid #777;padding:.7rem 1.1rem;margin:1rem "
    "0;overflow-wrap:break-word;min-width:0}.good{border-left-color:var(--good)}.bad{border-left-"
    "color:var(--bad)}.big{font-size:1.5rem;font-weight:600;margin:.1rem 0}p{margin:.35rem "
    "0}.two{display:grid;grid-template-columns:1fr "
    "1fr;gap:1rem}.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,"
    "500px),1fr));gap:1.2rem}figure{margin:0;max-width:820px;break-inside:avoid}iframe{box-sizing:"
    "border-box;width:100%;border:1px solid "
    "var(--line);display:block;background:#fff}figcaption{font-size:.88rem;color:var(--dim);"
    "padding:.3rem "
    ".1rem}.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.88rem;margin:.4rem "
    "0}th,td{border:1px solid var(--line);padding:.2rem "
    ".55rem;text-align:left;vertical-align:top}th,.wide td,td.n{white-space:nowrap}.wide "
    "td.text{white-space:normal;min-width:14rem}.prose "
    "td:not(.n){white-space:normal;min-width:5rem}.fold "
    "td{white-space:normal;overflow-wrap:anywhere}th{background:var(--head)}td.n{text-align:right}."
    "bars{min-width:9rem;width:100%}.verdict "
    ".bars{min-width:12rem;width:auto}.bar{display:block;height:.8em;background:var(--good)}.bars "
    ".verdict "
    ".bar{max-width:40vw}.bar{display:block}.back{background:var(--bad)}@media(max-width:600px){."
    "big{font-size:1.25rem}.two{grid-template-columns:1fr;gap:0}#energy td,#energy "
    "th{padding:.15rem .3rem}#energy td:first-child{white-space:normal}#energy .bars,.verdict "
    ".bars{min-width:3.5rem}}@media print{main{max-width:none}.screen{display:none}}";

void vs_html_begin(vs_html *html, const char *what, const char *name) {
  vs_html_add(html,
              "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
              "<meta name=\"viewport\" content=\"width=device-width\">\n<title>%s ",
              what);
  vs_html_text(html, name);
  vs_html_add(html, "</title>\n<style>");
  vs_html_markup(html, STYLE);
  vs_html_add(html, "</style>\n</head>\n<body>\n<main>\n<h1>%s ", what);
  vs_html_text(html, name);
  vs_html_add(html, "</h1>\n");
}

void vs_html_end(vs_html *html) {
  vs_html_add(html, "</main>\n</body>\n</html>\n");
}

vs_status vs_html_write(const vs_html *html, const char *folder, bool quiet, vs_error *err) {
  vs_file file = {0};
  vs_status status = vs_file_open(&file, folder, "report.html", err);
  if (status) return status;
  fwrite(html->text.text, 1, html->text.length, file.stream); /* an error stays in the stream */
  status = vs_file_commit(&file, err);
  if (!status && !quiet) printf("%s\n", file.path);
  return status;
}

void vs_html_markup(vs_html *html, const char *markup) {
  vs_text_add(&html->text, "%s", markup);
}

void vs_html_text(vs_html *html, const char *text) {
  char shown[VS_SHOWN_SIZE];
  while (*text) {
    text += vs_text_next(text, shown);
    vs_html_markup(html, *shown == '&'   ? "&amp;"
                         : *shown == '<' ? "&lt;"
                         : *shown == '>' ? "&gt;"
                         : *shown == '"' ? "&quot;"
                                         : shown);
  }
}

static void write_text(void *html, const char *text) {
  vs_html_text(html, text);
}

void vs_html_add(vs_html *html, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vs_text_add_by(&html->text, write_text, html, format, args);
  va_end(args);
}

void vs_html_free(vs_html *html) {
  vs_text_free(&html->text);
}

void vs_html_cell(vs_html *html, const char *text) {
  vs_html_add(html, "<td>");
  vs_html_text(html, text);
  vs_html_add(html, "</td>");
}

void vs_html_number(vs_html *html, double value) {
  if (isnan(value))
    vs_html_add(html, "<td class=\"n\"></td>");
  else
    vs_html_add(html, "<td class=\"n\">%.6g</td>", value);
}

/* The script before each picture. It enlarges the letters where the picture is shown small, and
 * lets the wheel scroll the page unless Ctrl is pressed. */
static const char FRAME[] = "<style>body{margin:0;overflow:hidden}svg{display:block;width:100%}"
                            "polygon{shape-rendering:crispEdges}"
                            "@media(max-width:480px){g[font-size='15.00']{font-size:18px}g[font-"
                            "size='8.00']{font-size:13px}}"
                            "</style><script>addEventListener('wheel',function(e){"
                            "if(!e.ctrlKey)e.stopImmediatePropagation()},true)</script>";

void vs_html_picture_add(vs_html *html, const vs_html_picture *p) {
  const char *from = strstr(p->svg, "<svg");
  vs_html_add(html, "<figure>\n<iframe title=\"");
  vs_html_text(html, p->title);
  vs_html_add(html, "\" style=\"aspect-ratio:%d/%d\" srcdoc=\"", p->width, p->height);
  vs_html_markup(html, FRAME);
  for (from = from ? from : p->svg; *from;) {
    int n = (int)strcspn(from, "&\"");
    vs_text_add(&html->text, "%.*s", n, from);
    from += n;
    if (*from) vs_html_markup(html, *from++ == '&' ? "&amp;" : "&quot;");
  }
  vs_html_add(html, "\"></iframe>\n<figcaption>");
  vs_html_text(html, p->caption ? p->caption : "");
  vs_html_add(html, "</figcaption>\n</figure>\n");
}
