/* SPDX-License-Identifier: GPL-3.0-or-later
 * The lines of a text file, whatever program wrote it: UTF-8 with or without a byte order mark,
 * UTF-16 in either order of bytes, or one byte a character (Latin-1); lines that end in LF, CR LF
 * or CR; a Ctrl-Z at the end, as programs of CP/M's and DOS's days leave it. */
#pragma once

#include <stddef.h>

#include "base/error.h"
#include "base/text.h"

/* A file's lines in UTF-8. Line k of the file is line[k - 1]; it may be written into, but not
 * beyond its end. */
typedef struct vs_source {
  char *text, **line; /* owned; the lines lie in the text */
  size_t count;
} vs_source;

/* Reads a file; vs_source_free is due also after an error. A file that is no UTF-8 is taken as
 * Latin-1. Without a byte order mark it is taken as UTF-16 if of its first characters each has one
 * zero byte, all on the same side. Errors with their place: it is no file of text, it cannot be
 * read, a zero byte, half of a surrogate pair. */
vs_status vs_source_read(const char *path, vs_source *source, vs_error *err);
void vs_source_free(vs_source *source);

/* Where a line of a source has the points of its course in a file, "V1 a b PWL file=NAME", adds the
 * line with the points of that file, which lies beside the one that the line stands in; else adds
 * nothing. Errors with their place: no such file, or it is none of pairs of numbers. */
vs_status vs_source_points(const char *line, vs_where where, vs_text *out, vs_error *err);

/* Turns signs that ngspice does not know into those that it reads, in place: a micro sign or a
 * Greek mu becomes u, a blank that keeps words together becomes a blank, a typographic minus
 * becomes '-'. Each is one character before and after, so that columns stay. */
void vs_source_plain(char *line);
