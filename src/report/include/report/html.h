/* SPDX-License-Identifier: GPL-3.0-or-later
 * What all HTML pages share: their beginning and end, style, texts, cells and pictures. */
#pragma once

#include <stdbool.h>

#include "base/error.h"
#include "base/text.h"

/* A page under way. Begins as {0}. It is a type of its own so that only the functions of this file
 * write to it: whatever a file of results says is shown as text. */
typedef struct vs_html {
  vs_text text; /* the page so far; to be read */
} vs_html;
void vs_html_free(vs_html *html);

/* Adds as printf does, with the conversions d, ld, zu, c, f, e, g and s. The format is markup and
 * must not come from a user. What %s stands for is text from anywhere, and is escaped. */
void vs_html_add(vs_html *html, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Adds markup of the program's own. */
void vs_html_markup(vs_html *html, const char *markup);

/* Adds everything before the first section: the style, and the title, "WHAT NAME". Colours are
 * light or dark as the reader's browser asks for; pictures stay on white. A page needs no other
 * file. */
void vs_html_begin(vs_html *html, const char *what, const char *name);
void vs_html_end(vs_html *html);

/* Writes the page as report.html into the folder, and prints its path unless `quiet`. Error: it
 * cannot be written. */
vs_status vs_html_write(const vs_html *html, const char *folder, bool quiet, vs_error *err);

/* Adds the text, escaped: whatever it holds is shown as it is. */
void vs_html_text(vs_html *html, const char *text);
/* Adds a table's cell (<td>) with the text, escaped. */
void vs_html_cell(vs_html *html, const char *text);
/* Adds a table's cell with a number to 6 digits; the cell is empty for NaN. */
void vs_html_number(vs_html *html, double value);

/* A picture as gnuplot's terminal "svg dynamic mousing standalone" draws it. */
typedef struct vs_html_picture {
  const char *title, *caption; /* NULL for no caption */
  const char *svg;
  int width, height;     /* pixels */
  const char *time_unit; /* of a waveform's axis, "ms": a click sets cursors in it; NULL: none */
} vs_html_picture;

/* Adds a figure with the picture in a frame. Each picture is a document of its own, so that their
 * scripts do not interfere; cursors stand at the same time in all of a page. */
void vs_html_picture_add(vs_html *html, const vs_html_picture *picture);
