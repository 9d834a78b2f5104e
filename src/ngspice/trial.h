/* SPDX-License-Identifier: GPL-3.0-or-later
 * The trial of a netlist in a child process (ngspice/child.h), and the search for the line that is
 * wrong in one that is no good. Some complaints of ngspice name the line. Where they do not, it is
 * found by leaving lines out. */
#pragma once

#include <stddef.h>

#include "ngspice/child.h"
#include "ngspice/circuit.h"
#include "ngspice/solver_errors.h"

/* All is borrowed. */
typedef struct vs_trial {
  /* In the child: loads the lines and runs them. It calls vs_child_finish once the circuit has gone
   * through its first step. If it does not come so far, it returns what went wrong; VS_CHILD_GOOD:
   * nothing that would harm this process. */
  vs_child_end (*attempt)(const struct vs_trial *trial);
  const vs_circuit_job *job;
  const vs_circuit_host *host;
  char **lines;                 /* of the job's netlist as ngspice gets it, and what follows them */
  vs_solver_errors *complaints; /* those that attempt() gathers */
} vs_trial;

/* Tries the netlist, where that is needed; else begins a guard (ngspice/crash_guard.h). Errors:
 * VS_INPUT, the netlist is no good, with the line where one is found; those of vs_child_try. */
vs_status vs_trial_first(vs_trial *trial, vs_error *err);

/* Adds to the first complaint the line that causes it, if its own words do not name the line. */
void vs_trial_blame(vs_trial *trial);

/* Writes " (FILE:LINE:COLUMN)", the place of the node or element that the first complaint names;
 * nothing where it names none that is found. */
void vs_trial_place(const vs_solver_errors *complaints, const vs_circuit_job *job, char *text,
                    size_t size);
