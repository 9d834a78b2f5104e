/* SPDX-License-Identifier: GPL-3.0-or-later
 * What ngspice says of what went wrong. Its return codes say nothing, so the lines of its log are
 * searched for signs of trouble, and those that tell most are kept. */
#ifndef VS_SOLVER_COMPLAINTS_H
#define VS_SOLVER_COMPLAINTS_H

#include <stdbool.h>
#include <stddef.h>

#include "solver/circuit.h"

enum { VS_COMPLAINTS_LINE = 256, VS_COMPLAINTS_MOST = 16 };

/* What an error ends with that has a file, and no line that is known. */
extern const char vs_complaints_nowhere[];

/* Start from {0}. */
typedef struct vs_complaints {
  char item[VS_COMPLAINTS_MOST][VS_COMPLAINTS_LINE]; /* texts without newline */
  size_t count;
  int expected;   /* how many lines of the last one are still to come */
  size_t culprit; /* the line of the job's netlist that the first one was found to be of; 0: none */
} vs_complaints;

/* Forgets all complaints. */
void vs_complaints_clear(vs_complaints *complaints);

/* Takes a line of the log, and keeps it if it is a complaint. `runs` says that the circuit has
 * passed t = 0: that ngspice gives up its step counts for more then than what it said before. */
void vs_complaints_hear(vs_complaints *complaints, const char *line, bool runs);

/* The first complaint; never NULL. */
const char *vs_complaints_first(const vs_complaints *complaints);

/* Adds words to the first complaint, or to what stands for none. */
void vs_complaints_add(vs_complaints *complaints, const char *words);

/* Gives an error that quotes the netlist, or is of its line `culprit` (0: not known), the place
 * that job->locate finds. Where it finds the file alone, the place is the file's begin, and the
 * text says that the line is not known. */
void vs_complaints_place(const vs_circuit_job *job, size_t culprit, vs_error *err);

/* Makes each complaint an error, with the place that job->locate finds: "ngspice cannot WHAT the
 * circuit: COMPLAINT". `what` is "load" or "run". A run ends with the first of them; a check
 * carries on. */
vs_status vs_complaints_tell(const vs_complaints *complaints, const vs_circuit_job *job,
                             const char *what, vs_error *err);

#endif
