/* SPDX-License-Identifier: GPL-3.0-or-later
 * Child processes. Some try what a process may die of: ngspice ends the process it is in for an
 * undefined parameter; other nonsense crashes it, at loading or in its first step, or keeps it for
 * ever. Others are copies of a running process: a process that is forked within a callback of
 * ngspice has all of its hidden state, and goes on as the first one would have. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "ngspice/solver_errors.h"

/* What errors say of a child that died of a signal, and of one that did not come back. */
#define VS_CHILD_DIED "ngspice died of it"
#define VS_CHILD_HUNG "it did not come back from it"

/* The longest that a trial may take, s of its processor's time, so that a busy machine makes no
 * difference. A circuit takes a few milliseconds. */
enum { VS_CHILD_SECONDS = 20 };

/* Ends this process by a signal once it has had so much processor time, or ten times as long has
 * passed: it may wait for ever. */
void vs_child_limit_time(void);

/* True for the end, as waitpid tells it, of a process that took longer than that. */
bool vs_child_is_late(int how);

/* How the child ended by itself: the circuit can be loaded and begins to run (or what is wrong with
 * it does no harm to a process); it cannot be loaded; it cannot be run. */
typedef enum vs_child_end { VS_CHILD_GOOD, VS_CHILD_BAD_LOAD, VS_CHILD_BAD_RUN } vs_child_end;

/* The reason for a child process that SIGSYS ended. This program's own filter only refuses calls
 * (ngspice/sandbox.h), so another filter ended it. */
extern const char vs_child_forbidden[];

/* Calls attempt(ctx) in a child process, without standard output and error and confined as
 * ngspice/sandbox.h says, and waits for the child's end. *end is what attempt returned, or what it
 * gave to vs_child_finish; unless that is VS_CHILD_GOOD, the child's *complaints are then this
 * process's. Errors: VS_INPUT, the child died of a signal or did not come back in VS_CHILD_SECONDS;
 * VS_SIGNAL, a signal that is handled came meanwhile; VS_RUN, there is no child to be had, it
 * ran out of memory, or a filter of system calls killed it. */
vs_status vs_child_try(vs_child_end (*attempt)(void *ctx), void *ctx, vs_solver_errors *complaints,
                       vs_child_end *end, vs_error *err);

/* Ends the child at once from within the attempt, as VS_CHILD_GOOD. */
_Noreturn void vs_child_finish(void);

/* A copy of this process, which goes on by itself and tells what comes of it. */
typedef struct vs_child_copy {
  int pid;      /* 0 in the copy itself */
  int pipe_end; /* the parent reads from it, the copy writes into it */
} vs_child_copy;

/* Makes a copy of this process, which has one thread, and returns in both: copy->pid tells which is
 * which. The copy shares the parent's open files: it must not write to any, and must end by
 * vs_child_tell alone. It dies with its parent. Error, in the parent: VS_RUN, there is none. */
vs_status vs_child_fork(vs_child_copy *copy, vs_error *err);

/* In the copy: tells the parent so many bytes, and goes on. False: the parent does not hear it. */
bool vs_child_say(const vs_child_copy *copy, const void *data, size_t size);

/* In the copy: tells the parent so many bytes, and ends the copy. None: it has failed. */
_Noreturn void vs_child_tell(const vs_child_copy *copy, const void *data, size_t size);

/* In the parent: takes so many bytes of what the copy tells. False: it has ended before that. */
bool vs_child_listen(const vs_child_copy *copy, void *data, size_t size);

/* In the parent: waits for the copy's end, however that comes, and returns it as waitpid does. */
int vs_child_end_of(const vs_child_copy *copy);

/* In the parent: waits for the copy's end and takes what it told. Errors: VS_RUN, the copy ended
 * before it had told all of it. */
vs_status vs_child_hear(const vs_child_copy *copy, void *data, size_t size, vs_error *err);
