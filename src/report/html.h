/* SPDX-License-Identifier: GPL-3.0-or-later
 * Texts and cells of an HTML page. */
#ifndef VS_REPORT_HTML_H
#define VS_REPORT_HTML_H

#include "base/text.h"

void vs_html_text(vs_text *html, const char *text); /* whatever it holds, it is shown as it is */
void vs_html_cell(vs_text *html, const char *text); /* <td> */
void vs_html_number(vs_text *html, double value);   /* <td>, empty for NAN */

#endif
