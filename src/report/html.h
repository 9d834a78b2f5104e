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

/* A picture as gnuplot's terminal "svg dynamic mousing standalone" draws it. */
typedef struct vs_html_picture {
  const char *title, *caption; /* NULL for no caption */
  const char *svg;
  int width, height; /* pixels */
} vs_html_picture;

/* Adds a figure with the picture in a frame. Each is a document of its own, so that their scripts
 * do not meet. */
void vs_html_picture_add(vs_text *html, const vs_html_picture *picture);

#endif
