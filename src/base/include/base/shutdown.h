/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the program ends when a signal asks for it. It removes the files it has begun and ends at
 * once, unless a command heeds the signal and ends in good order itself. */
#pragma once

#include <signal.h>

/* Set by INT, TERM and HUP while a command heeds signals; the command looks at it. */
extern volatile sig_atomic_t vs_shutdown_requested;

/* From now on handles INT, TERM, HUP (unless nohup had it ignored) and PIPE in this process. A
 * forked child inherits the handlers. */
void vs_shutdown_begin(void);

/* What INT, TERM and HUP do. */
typedef enum vs_shutdown_mode {
  VS_SHUTDOWN_AT_ONCE,      /* they end the process with status 75; this holds at first */
  VS_SHUTDOWN_WITH_TIMEOUT, /* they set vs_shutdown_requested, and end the process if it still runs
                             * VS_SHUTDOWN_TIMEOUT_S later
                             */
  VS_SHUTDOWN_WHEN_KEPT /* they only set vs_shutdown_requested, because results are being kept */
} vs_shutdown_mode;
enum { VS_SHUTDOWN_TIMEOUT_S = 3 }; /* s; who pressed Ctrl-C waits that long */
/* Returns what held before, so that the caller can put it back. */
vs_shutdown_mode vs_shutdown_mode_set(vs_shutdown_mode heed);

/* An open file in the place of standard error for saying that a signal has stopped the process. */
void vs_shutdown_report_to(int file);

/* Notes a file, or a folder that will be empty, which is removed when the process ends by a signal,
 * by exit or because there is no memory. A forked child removes none of its parent's. The path is
 * borrowed until vs_shutdown_forget. Beyond VS_SHUTDOWN_MOST notes, further files stay behind. */
enum { VS_SHUTDOWN_MOST = 512 };
void vs_shutdown_remove(const char *path);
void vs_shutdown_forget(const char *path);

/* Says from which open folder relative paths lead, while the process is in another one; AT_FDCWD:
 * from the one that it is in, as at first. */
void vs_shutdown_paths_from(int folder);

/* Removes all that is noted. A signal handler may call it. */
void vs_shutdown_remove_all(void);

/* Ends the process at once, after it has removed all that is noted and written the text of `size`
 * bytes where vs_shutdown_report_to says. What stands in buffers of streams is not written. A
 * forked child writes nothing, and ends with the other status. */
_Noreturn void vs_shutdown_now(int status, int child_status, const char *text, size_t size);

/* Between these two calls no signal is handled, so that a file can be made and noted in one step.
 */
void vs_shutdown_block_signals(sigset_t *before);
void vs_shutdown_unblock_signals(const sigset_t *before);
