/* SPDX-License-Identifier: GPL-3.0-or-later
 * A netlist may crash ngspice, end the process or keep it for ever. A trial in a child process
 * (ngspice/child.h) finds that, and costs a load and a fork. A process that has done nothing yet
 * which a second process could not do again needs no trial: it takes the netlist under guard. If
 * that goes wrong, the process begins anew with the same words, and tries first. */
#pragma once

#include <stdbool.h>

/* Begins the guard. From now on, until vs_crash_guard_end(), a crash, a call of exit and the end of
 * the time that a trial has (VS_CHILD_SECONDS) remove the files that the process has begun and
 * start the program anew. Returns false where that cannot be, or where the process has begun anew
 * already: a trial is needed then. */
bool vs_crash_guard_begin(void);

/* Begins anew at once, as after a crash. Returns only where there is no guard. */
void vs_crash_guard_retry(void);

/* Ends the guard; nothing happens where there is none. */
void vs_crash_guard_end(void);

/* True in a process that has begun anew. Its warnings were told before. */
bool vs_crash_guard_again(void);
