/* SPDX-License-Identifier: MIT
 * What libvibrospice and the engine, `vibrospice serve`, say to each other over a socket; not
 * installed. Each message is a head and so many bytes. The client asks, and waits for one answer.
 * While rows are wanted, the engine may send rows before the answer, and waits after each one for
 * GO or HALT. Numbers are in the machine's own format, since both run on one machine. Both have the
 * same version (VIBROSPICE_PROTOCOL).
 *
 * Descriptions and results are lines of cells with tabs between; the first cell says what the line
 * is. A number is as %.17g prints it. */
#ifndef VIBROSPICE_PROTOCOL_H
#define VIBROSPICE_PROTOCOL_H

#include <stdint.h>

#include "vibrospice/vibrospice.h"

#define VIBROSPICE_TEXT_OF_(x) #x
#define VIBROSPICE_TEXT_OF(x) VIBROSPICE_TEXT_OF_(x)
#define VIBROSPICE_VERSION                                                                         \
  VIBROSPICE_TEXT_OF(VIBROSPICE_MAJOR)                                                             \
  "." VIBROSPICE_TEXT_OF(VIBROSPICE_MINOR) "." VIBROSPICE_TEXT_OF(VIBROSPICE_PATCH)
#define VIBROSPICE_PROTOCOL "vibrospice " VIBROSPICE_VERSION " protocol 1"

typedef struct vibrospice_head {
  uint32_t kind; /* of a question, or the status of an answer (vibrospice_status) */
  uint32_t size; /* of what follows, bytes */
} vibrospice_head;

/* Questions, and what follows each. */
enum {
  VIBROSPICE_ASK_OPEN = 'O',   /* the flags as a decimal number, a space, the scene */
  VIBROSPICE_ASK_SET = 'S',    /* KEY=VALUE */
  VIBROSPICE_ASK_FOLDER = 'D', /* its path */
  VIBROSPICE_ASK_INPUT = 'I',  /* a double, then the input's name */
  VIBROSPICE_ASK_RUN = 'R',    /* vibrospice_ask_run */
  VIBROSPICE_ASK_FINISH = 'F',
  VIBROSPICE_ASK_COPY = 'C', /* beside it comes the file descriptor of the copy's own socket */
  VIBROSPICE_GO = 'g',       /* after a row */
  VIBROSPICE_HALT = 'h',     /* after a row: stops there */
  VIBROSPICE_ROW = 'r'       /* the engine's: a double for each column */
};

typedef struct vibrospice_ask_run {
  double t_s;      /* up to here; INFINITY: the end */
  uint32_t rows;   /* 1: rows are wanted */
  uint32_t events; /* 1: up to the first firing, extinction, contact or release before that */
} vibrospice_ask_run;

/* Value references of a functional mock-up unit: 0 is the time, then come the scene's inputs and
 * its columns, each in their order. */
enum { VIBROSPICE_UNIT_INPUTS = 1, VIBROSPICE_UNIT_COLUMNS = 100 };

/* What follows an answer that is no error: to OPEN and SET a description, to FINISH a result, to
 * RUN a double for each column. An error is followed by its text. */

#endif
