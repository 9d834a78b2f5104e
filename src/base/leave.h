/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the program ends when a signal asks for it: at once, taking away what it has begun, except
 * where somebody heeds the signal and ends in good order. */
#ifndef VS_BASE_LEAVE_H
#define VS_BASE_LEAVE_H

#include <signal.h>

/* INT, TERM and HUP set it; who heeds signals looks at it. */
extern volatile sig_atomic_t vs_leave_requested;

/* Handles INT, TERM, HUP (unless nohup had it ignored) and PIPE in this process, from now on. A
 * child that is forked inherits that, and takes nothing away. */
void vs_leave_begin(void);

/* What INT, TERM and HUP do. */
typedef enum vs_heed {
  VS_HEED_NOT,  /* the process ends with status 75; so it is to begin with */
  VS_HEED_SOON, /* vs_leave_requested is set; where the process goes on for VS_HEED_S, it ends */
  VS_HEED_KEEP  /* vs_leave_requested is set, and no more: results are being kept */
} vs_heed;
enum { VS_HEED_S = 3 };
/* Gives what held before, to be put back. */
vs_heed vs_leave_heed_set(vs_heed heed);

/* A file, or a folder that will be empty, to be taken away when the process ends by a signal or by
 * exit. Borrowed: the path lasts until vs_leave_forget. With more than VS_LEAVE_MOST of them the
 * others stay behind. */
enum { VS_LEAVE_MOST = 512 };
void vs_leave_remove(const char *path);
void vs_leave_forget(const char *path);

/* Between the two no signal is taken, so that what is made is known as soon as it is there. */
void vs_leave_hold(sigset_t *before);
void vs_leave_release(const sigset_t *before);

#endif
