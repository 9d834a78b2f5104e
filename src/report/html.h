/* SPDX-License-Identifier: GPL-3.0-or-later
 * Texts and cells of an HTML page. */
#ifndef VS_REPORT_HTML_H
#define VS_REPORT_HTML_H

#include "base/text.h"

/* Adds the text, escaped: whatever it holds is shown as it is. */
void vs_html_text(vs_text *html, const char *text);
/* Adds a table's cell (<td>) with the text, escaped. */
void vs_html_cell(vs_text *html, const char *text);
/* Adds a table's cell with a number of 6 digits; the cell is empty for NaN. */
void vs_html_number(vs_text *html, double value);

#endif
