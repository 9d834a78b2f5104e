/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `steady`: finds a scene's periodic orbit and reports one period of it. */
#ifndef VS_COMMAND_STEADY_H
#define VS_COMMAND_STEADY_H

#include "command/run.h"

/* options: those of `run`; raw is not looked at. periods: how many firing periods the orbit takes
 * to repeat. Errors: those of vs_run_command and vs_steady_begin. Where no orbit is found nothing
 * is written. */
vs_status vs_steady_command(const vs_run_options *options, int periods, vs_error *err);

#endif
