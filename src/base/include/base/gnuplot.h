/* SPDX-License-Identifier: GPL-3.0-or-later
 * gnuplot as a child process: a script goes in, a picture comes out. */
#pragma once

#include <stdbool.h>

#include "base/error.h"
#include "base/text.h"

/* A script that is being written. Start from {0}. It is a type of its own so that nothing but the
 * functions of this file writes to it: no text of a user's can become a command. */
typedef struct vs_script {
  vs_text text; /* the script so far; to be read */
} vs_script;
void vs_gnuplot_free(vs_script *script);

/* Appends as printf does, with the conversions d, ld, zu, c, f, e, g and s. The format is gnuplot's
 * language, and no user's. What %s stands for is text, of whomever it may be:
 * it is written as a quoted string, with its quotes, and must stand where one may stand. */
void vs_gnuplot_add(vs_script *script, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Appends commands, or parts of them, of the program's own. */
void vs_gnuplot_code(vs_script *script, const char *code);
/* Appends a text as a string of gnuplot's. Tabs and line ends become blanks; what else would be
 * obeyed is shown as its number (vs_text_next). */
void vs_gnuplot_quoted(vs_script *script, const char *text);
/* The same for a caption that has room for so many pixels, of letters of that size: gnuplot would
 * cut a longer one at the picture's edge. It ends at a word's end, with three dots
 * (vs_text_shorten). */
void vs_gnuplot_caption(vs_script *script, const char *text, int pixels, int size);
/* Appends a text as a word of a row of data, in double quotes; a quote in it becomes a single one.
 */
void vs_gnuplot_word(vs_script *script, const char *text);
/* Appends the name of a file, quoted. A relative name gets "./" before it: gnuplot would run a name
 * that begins with '<' or '|'. */
void vs_gnuplot_path(vs_script *script, const char *path);

/* Runs gnuplot on the script, which sets no output, and gives what it writes to standard output:
 * `size` bytes and a zero behind them, to be freed by the caller. gnuplot itself writes no file.
 * Its complaints go to standard error as they are. Errors, with *picture NULL: VS_RUN, gnuplot is
 * not installed or failed. */
vs_status vs_gnuplot_picture(const char *script, char **picture, size_t *size, vs_error *err);

/* Draws the script's picture into a file of that name in the folder, which appears whole, and
 * prints where it is unless `quiet`. Errors: those of vs_gnuplot_picture; the file cannot be
 * written. */
vs_status vs_gnuplot_draw(const char *script, const char *folder, const char *name, bool quiet,
                          vs_error *err);
