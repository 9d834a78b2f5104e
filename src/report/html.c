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
