/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/html.h"

#include <math.h>
#include <string.h>

void vs_html_text(vs_text *html, const char *text) {
  while (*text) {
    int n = (int)strcspn(text, "&<>\"");
    vs_text_add(html, "%.*s", n, text);
    text += n;
    if (*text)
      vs_text_add(html, "%s",
                  *text == '&'   ? "&amp;"
                  : *text == '<' ? "&lt;"
                  : *text == '>' ? "&gt;"
                                 : "&quot;");
    text += *text != '\0';
  }
}

void vs_html_cell(vs_text *html, const char *text) {
  vs_text_add(html, "<td>");
  vs_html_text(html, text);
  vs_text_add(html, "</td>");
}

void vs_html_number(vs_text *html, double value) {
  if (isnan(value))
    vs_text_add(html, "<td class=\"n\"></td>");
  else
    vs_text_add(html, "<td class=\"n\">%.6g</td>", value);
}

/* What stands before each picture. The wheel goes on scrolling the page unless Ctrl is held. */
static const char FRAME[] =
    "<style>body{margin:0;overflow:hidden}svg{display:block;width:100%}"
    "polygon{shape-rendering:crispEdges}</style><script>addEventListener('wheel',function(e){"
    "if(!e.ctrlKey)e.stopImmediatePropagation()},true)</script>";

void vs_html_picture_add(vs_text *html, const vs_html_picture *p) {
  const char *from = strstr(p->svg, "<svg");
  vs_text_add(html, "<figure>\n<iframe title=\"");
  vs_html_text(html, p->title);
  vs_text_add(html, "\" style=\"aspect-ratio:%d/%d\" srcdoc=\"%s", p->width, p->height, FRAME);
  for (from = from ? from : p->svg; *from;) {
    int n = (int)strcspn(from, "&\"");
    vs_text_add(html, "%.*s", n, from);
    from += n;
    if (*from) vs_text_add(html, "%s", *from++ == '&' ? "&amp;" : "&quot;");
  }
  vs_text_add(html, "\"></iframe>\n<figcaption>");
  vs_html_text(html, p->caption ? p->caption : "");
  vs_text_add(html, "</figcaption>\n</figure>\n");
}
