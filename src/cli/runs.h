/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command line of runs, orbits and derivatives: options, words and what they call. */
#ifndef VS_CLI_RUNS_H
#define VS_CLI_RUNS_H

#include "command.h"

extern const vs_command vs_runs_run, vs_runs_steady, vs_runs_sensitivity;

#endif
