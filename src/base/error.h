/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a function says that it failed: a status to act on and one line to show the user. In a run
 * the first error is the last; a check carries on and gathers them all. */
#ifndef VS_BASE_ERROR_H
#define VS_BASE_ERROR_H

#include <stdbool.h>
#include <stddef.h>

/* name, exit status of the program, what it means */
#define VS_STATUS_LIST(X)                                                                          \
  X(VS_OK, 0, "done")                                                                              \
  X(VS_RUN, 1, "a run, a case or a validation failed")                                             \
  X(VS_INPUT, 2, "bad usage or input")                                                             \
  X(VS_RATING, 3, "done and a rating is violated or undecided")                                    \
  X(VS_SIGNAL, 75, "stopped by a signal, start me again")

typedef enum vs_status {
#define VS_STATUS_ENUM(name, exit_status, text) name = exit_status,
  VS_STATUS_LIST(VS_STATUS_ENUM)
#undef VS_STATUS_ENUM
} vs_status;

typedef struct vs_findings vs_findings;

/* Begin with {0}. */
typedef struct vs_error {
  char text[1024];       /* one line, no newline; empty while nothing failed */
  int file_size;         /* bytes of text that name the file; 0: it names none */
  int place_size;        /* bytes of text before the message itself */
  int line, column;      /* of the place, from 1; 0: not known */
  bool gave_up;          /* the circuit's solver did, and might not have with other settings */
  vs_findings *findings; /* where vs_error_carry_on keeps what it carries on from; NULL: nowhere */
} vs_error;

/* The errors of one check: file by file, each in the order of its lines, none twice. */
enum { VS_MOST_FINDINGS = 100 };
struct vs_findings {
  size_t count;
  vs_error item[VS_MOST_FINDINGS];
};

/* A place in a text the user wrote. Borrowed: the name lives as long as what it was read from. */
typedef struct vs_where {
  const char *file; /* path, or what stands in for one ("--set"); NULL: no place is known */
  int line;         /* from 1; 0: the file as a whole */
  int column;       /* from 1 */
} vs_where;

/* Both fill err and return status, so that a caller can write `return vs_fail(...)`. */
vs_status vs_fail(vs_error *err, vs_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
vs_status vs_fail_at(vs_error *err, vs_where where, const char *format, ...)
    __attribute__((format(printf, 3, 4))); /* always VS_INPUT; "file:line:column: " first */

/* For those who read many things one after the other: gives VS_OK in place of VS_INPUT when err has
 * room to keep the error, else the status as it is. What could not be read is then as by default.
 */
vs_status vs_error_carry_on(vs_error *err, vs_status status);

/* How many errors were kept so far. Where some were, a further one may be nothing but their echo.
 */
size_t vs_error_count(const vs_error *err);

#endif
