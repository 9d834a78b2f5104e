/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `steady`: finds a scene's periodic orbit and reports one period of it. */
#ifndef VS_CLI_STEADY_H
#define VS_CLI_STEADY_H

#include "run/run.h"

/* options: those of `run`; raw is not looked at. periods: how many firing periods the orbit takes
 * to repeat. linear: the linear models about it are told, too. Errors: those of vs_run_command,
 * vs_steady_begin and vs_matrices_find. Where no orbit or no model is found nothing is written. */
vs_status vs_steady_command(const vs_run_options *options, int periods, bool linear, vs_error *err);

#endif
