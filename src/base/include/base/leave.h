/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the program ends when a signal asks for it. It removes the files it has begun and ends at
 * once, unless a command heeds the signal and ends in good order itself. */
#ifndef VS_BASE_LEAVE_H
#define VS_BASE_LEAVE_H

#include <signal.h>

/* Set by INT, TERM and HUP while a command heeds signals; the command looks at it. */
extern volatile sig_atomic_t vs_leave_requested;

/* From now on handles INT, TERM, HUP (unless nohup had it ignored) and PIPE in this process. A
 * forked child inherits the handlers. */
void vs_leave_begin(void);

/* What INT, TERM and HUP do. */
typedef enum vs_heed {
  VS_HEED_NOT,  /* they end the process with status 75; this holds at first */
  VS_HEED_SOON, /* they set vs_leave_requested, and end the process if it still runs VS_HEED_S later
                 */
  VS_HEED_KEEP  /* they only set vs_leave_requested, because results are being kept */
} vs_heed;
enum { VS_HEED_S = 3 }; /* s; who pressed Ctrl-C waits that long */
/* Returns what held before, so that the caller can put it back. */
vs_heed vs_leave_heed_set(vs_heed heed);

/* An open file in the place of standard error for saying that a signal has stopped the process. */
void vs_leave_tell(int file);

/* Notes a file, or a folder that will be empty, which is removed when the process ends by a signal,
 * by exit or because there is no memory. A forked child removes none of its parent's. The path is
 * borrowed until vs_leave_forget. Beyond VS_LEAVE_MOST notes, further files stay behind. */
enum { VS_LEAVE_MOST = 512 };
void vs_leave_remove(const char *path);
void vs_leave_forget(const char *path);

/* Says from which open folder relative paths lead, while the process is in another one; AT_FDCWD:
 * from the one that it is in, as at first. */
void vs_leave_from(int folder);

/* Removes all that is noted. A signal handler may call it. */
void vs_leave_clean(void);

/* Ends the process at once, after it has removed all that is noted and written the text of `size`
 * bytes where vs_leave_tell says. What stands in buffers of streams is not written. A forked child
 * writes nothing, and ends with the other status. */
_Noreturn void vs_leave_now(int status, int child_status, const char *text, size_t size);

/* Between these two calls no signal is handled, so that a file can be made and noted in one step.
 */
void vs_leave_hold(sigset_t *before);
void vs_leave_release(const sigset_t *before);

#endif
