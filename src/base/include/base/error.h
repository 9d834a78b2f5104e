/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a function says that it failed: it returns a status to act on, and fills a vs_error with one
 * line to show the user. A run ends at its first error. The command `check` carries on behind most
 * errors and gathers them all. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Each status: its name, the exit status of the program, what it means. */
#define VS_STATUS_LIST(X)                                                                          \
  X(VS_OK, 0, "done")                                                                              \
  X(VS_RUN, 1, "a run, a case or a validation failed")                                             \
  X(VS_INPUT, 2, "bad usage or input")                                                             \
  X(VS_RATING, 3, "done; a rating is violated or undecided, or a fit does not fit")                \
  X(VS_BUDGET, 4, "a search's budget is spent before its answer is proved")                        \
  X(VS_SIGNAL, 75, "stopped by a signal, start me again")

typedef enum vs_status {
#define VS_STATUS_ENUM(name, exit_status, text) name = exit_status,
  VS_STATUS_LIST(VS_STATUS_ENUM)
#undef VS_STATUS_ENUM
} vs_status;

typedef struct vs_findings vs_findings;

/* What went wrong. Start from {0}. */
typedef struct vs_error {
  char text[1024];       /* one line without a newline; empty while nothing has failed */
  int file_size;         /* how many bytes of text, from its start, name the file; 0: no file */
  int place_size;        /* how many bytes of text stand before the message: "file:line:column: " */
  int line, column;      /* of the place, from 1; 0: not known */
  bool gave_up;          /* the circuit's solver gave up; with other settings it might not have */
  bool conducts;         /* no run can begin: a part of the circuit conducts at rest */
  bool elsewhere;        /* a warning whose place is in another file than the command was given, and
                            is shown wherever the warning is */
  vs_findings *findings; /* a check keeps its errors here; NULL: the command ends at its first
                            error; borrowed */
} vs_error;

/* The errors that one check has found. They stand file by file, each file's in the order of its
 * lines, and none stands twice. */
enum { VS_MOST_FINDINGS = 100 };
struct vs_findings {
  size_t count;
  vs_error item[VS_MOST_FINDINGS];
};

/* A place in a text that the user wrote. The file's name is borrowed from what was read from it, a
 * tree or a deck, and lasts as long as that. */
typedef struct vs_where {
  const char *file; /* path, or what stands in for one ("--set"); NULL: no place is known */
  int line;         /* from 1; 0: the file as a whole */
  int column;       /* from 1 */
} vs_where;

/* Bytes of the name of the file that a message names. A part that stands in a table has the path
 * TABLE.tab#PART (netlist/catalogue.h), and messages name the table. */
size_t vs_error_file_size(const char *file);

/* Fills err and returns status, so that a caller can write `return vs_fail(...)`. */
vs_status vs_fail(vs_error *err, vs_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The same for input: the text begins with "file:line:column: ", the status is VS_INPUT. */
vs_status vs_fail_at(vs_error *err, vs_where where, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* For a caller that reads many things one after the other. When status is VS_INPUT and err has
 * findings with room, the error is kept there and the result is VS_OK: the caller goes on, and the
 * fields that failed to parse keep their defaults. Otherwise the result is status. */
vs_status vs_error_keep(vs_error *err, vs_status status);

/* Returns how many errors were kept so far; 0 without findings. A caller compares the count before
 * and after a step: what fails after a kept error may only be a consequence of it. */
size_t vs_error_count(const vs_error *err);
