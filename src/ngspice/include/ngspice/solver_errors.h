/* SPDX-License-Identifier: GPL-3.0-or-later
 * The errors in ngspice's log. Its return codes say nothing, so the lines of its log are searched
 * for known phrases of errors, and the most telling ones are kept. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "ngspice/circuit.h"

enum { VS_SOLVER_ERRORS_LINE = 256, VS_SOLVER_ERRORS_MOST = 16 };

/* The last words of an error whose file is known, and whose line is not. */
extern const char vs_solver_errors_nowhere[];

/* Start from {0}. */
typedef struct vs_solver_errors {
  char item[VS_SOLVER_ERRORS_MOST][VS_SOLVER_ERRORS_LINE]; /* texts without newline */
  size_t count;
  int expected;   /* how many lines of the last one are still to come */
  size_t culprit; /* the line of the job's netlist that was found to cause the first one; 0: none */
} vs_solver_errors;

/* Forgets all complaints. */
void vs_solver_errors_clear(vs_solver_errors *complaints);

/* Takes a line of the log, and keeps it if it is a complaint. `runs` says that the circuit has
 * passed t = 0: that ngspice gives up its step counts for more then than what it said before. */
void vs_solver_errors_hear(vs_solver_errors *complaints, const char *line, bool runs);

/* The first complaint; never NULL. */
const char *vs_solver_errors_first(const vs_solver_errors *complaints);

/* True where the first complaint is of one iteration of a step, as of a function whose argument is
 * out of its range at a first guess: with other settings ngspice may not come by there. */
bool vs_solver_errors_of_iteration(const vs_solver_errors *complaints);

/* Adds words to the first complaint; if there is none, to the text that takes its place. */
void vs_solver_errors_add(vs_solver_errors *complaints, const char *words);

/* Gives an error the place that job->locate finds. The error quotes the netlist, or line `culprit`
 * of it caused the error (0: not known). If only the file is found, the place is its first line,
 * and the text says that the line is not known. */
void vs_solver_errors_place(const vs_circuit_job *job, size_t culprit, vs_error *err);

/* Makes each complaint an error, with the place that job->locate finds: "ngspice cannot WHAT the
 * circuit: COMPLAINT". `what` is "load" or "run". A run ends with the first of them; a check
 * carries on. */
vs_status vs_solver_errors_tell(const vs_solver_errors *complaints, const vs_circuit_job *job,
                                const char *what, vs_error *err);
