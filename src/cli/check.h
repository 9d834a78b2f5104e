/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `check`: tells all that can be known of a scene, a deck or a part before a run. */
#ifndef VS_CLI_CHECK_H
#define VS_CLI_CHECK_H

#include "run/findings.h"

/* Reads the file to its end, and takes the first step of a run and no more. Prints all findings to
 * standard error, each with its line of the file, or as JSON to standard output. Without findings
 * it prints one line that describes the file, and warnings, and of a part what the bench found.
 * Errors: VS_INPUT where there are findings, with an empty err, or with one line more where there
 * were too many to keep; VS_RUN where a part does not do what its file asks. */
vs_status vs_check_command(const vs_check_options *options, vs_error *err);

#endif
