/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law of the user's own as a process on a pipe, in any language:
 *
 *   control: {law: pipe, command: python3 mylaw.py, timeout: 5 s}
 *
 * The command is started without a shell, in the folder of the file that names it. For each firing
 * it reads one line of JSON from its standard input,
 *
 *   {"t_s": 0.04, "firing": 3, "last_angle_deg": 95, "now": {"p_meas_m": 0.0004, ...},
 *    "least": {...}, "largest": {...}}
 *
 * which has no line break in it, and writes one to its standard output: {"angle_deg": 95},
 * {"angle_deg": null} for no firing, or {"error": "why"}, which ends the run. What is not known is
 * null. */
#ifndef VS_CONTROL_PIPE_H
#define VS_CONTROL_PIPE_H

#include "control/regulator.h"

extern const vs_regulator vs_pipe_regulator;

#endif
