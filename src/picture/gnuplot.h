/* SPDX-License-Identifier: GPL-3.0-or-later
 * gnuplot as a child process: a script goes in, a picture comes out. */
#ifndef VS_PICTURE_GNUPLOT_H
#define VS_PICTURE_GNUPLOT_H

#include <stdbool.h>

#include "base/error.h"
#include "base/text.h"

/* Appends a text in gnuplot's single quotes. Control characters become blanks, as a line break
 * would begin a command. */
void vs_gnuplot_quoted(vs_text *script, const char *text);
/* Appends the name of a file, quoted. A relative name gets "./" before it: gnuplot would run a name
 * that begins with '<' or '|'. */
void vs_gnuplot_path(vs_text *script, const char *path);

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

#endif
