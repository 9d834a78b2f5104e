/* SPDX-License-Identifier: GPL-3.0-or-later
 * The lines of a journal's file, as bytes: all of them in their order, or the one that begins at a
 * known byte. Many are read at a time, as each read may have to go over a network. */
#ifndef VS_STUDY_LINES_H
#define VS_STUDY_LINES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "base/text.h"

/* The part of the file that vs_lines_read has read last. */
typedef struct vs_lines_part vs_lines_part;
vs_lines_part *vs_lines_part_new(void); /* free() it */
/* Forgets what was read: the file is about to change there. */
void vs_lines_forget(vs_lines_part *part);

/* An open file. All is borrowed; path is for messages. */
typedef struct vs_lines {
  int fd;
  const char *path;
  vs_lines_part *part; /* only vs_lines_read needs it */
} vs_lines;

/* A line that was read. */
typedef struct vs_lines_entry {
  const char *text;
  size_t length;       /* in bytes, without its end; more than the text's if one of them is zero */
  uint64_t at, number; /* where it begins, in bytes; which it is, from 1 */
} vs_lines_entry;

/* What vs_lines_each has seen. */
typedef struct vs_lines_seen {
  uint64_t count; /* lines */
  uint64_t end;   /* where the last whole one ends, in bytes */
  bool torn;      /* the last one has no line end; it is counted, and was not shown */
} vs_lines_seen;

/* Shows all lines to `visit`, from the first on, until the file or *enough ends it. Errors: that of
 * visit; the file cannot be read. */
typedef vs_status (*vs_lines_visit)(void *ctx, const vs_lines_entry *line, bool *enough,
                                    vs_error *err);
vs_status vs_lines_each(const vs_lines *file, vs_lines_visit visit, void *ctx, vs_lines_seen *seen,
                        vs_error *err);

/* Reads the line that begins at byte `at` into text, without its end; behind the file's end it is
 * empty. *length is how many bytes stand there: more than the text's if one of them is zero. Error:
 * the file cannot be read. */
vs_status vs_lines_read(const vs_lines *file, uint64_t at, vs_text *text, size_t *length,
                        vs_error *err);

#endif
