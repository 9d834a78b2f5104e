/* SPDX-License-Identifier: GPL-3.0-or-later
 * gnuplot as a child process: a script in, pictures out. */
#ifndef VS_COMMAND_GNUPLOT_H
#define VS_COMMAND_GNUPLOT_H

#include "base/error.h"
#include "base/text.h"

/* gnuplot's quoting inside '...'; of a file, whose name would be a command if it began with '<' or
 * '|'. */
void vs_gnuplot_quoted(vs_text *script, const char *text);
void vs_gnuplot_path(vs_text *script, const char *path);

/* Runs gnuplot on the script, which sets no output, and gives what it writes to standard output:
 * size bytes, a zero behind them; free() it. gnuplot itself writes no file. Its complaints go to
 * standard error as they are. Errors, with NULL: it is not installed, it fails. */
vs_status vs_gnuplot_picture(const char *script, char **picture, size_t *size, vs_error *err);

#endif
