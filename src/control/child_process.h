/* SPDX-License-Identifier: GPL-3.0-or-later
 * A child process that is asked, again and again, and answers each question within a time of the
 * wall's clock: a law of the user's own at work. What it may do wrong (crash, end, hang, talk out
 * of turn) becomes one line. Neither it nor what it has started, unless that has left its process
 * group, outlives this process: vs_child_process_end ends them, and a watchman where this process
 * dies before that. So it is with a folder that the process works in. */
#pragma once

#include "base/error.h"

enum { VS_REMOTE_MOST = 4096 }; /* bytes of the longest answer */

/* Start from {0} and fill the first two members, and the third if it is wanted. All other members
 * are the remote's own. */
typedef struct vs_child_process {
  const char *name;   /* what messages call the process, borrowed */
  double timeout_s;   /* within which it answers, s of the wall's clock */
  const char *folder; /* is removed, with all that is in it, when the process has ended; borrowed.
                         NULL: there is none */

  int pid;                     /* of the child; 0: there is none */
  int watchman;                /* a process that ends the child's group where this one dies */
  int owner;                   /* the process that started it, which alone may ask it */
  int to, from;                /* ends of the pipes to and from the child; neither blocks */
  double t_s;                  /* the run's time of the present question, for messages */
  double until_s;              /* when its answer is due, on the wall's clock */
  size_t n_in;                 /* how many bytes of `in` the answer has so far */
  char in[VS_REMOTE_MOST + 1]; /* the answer, a zero byte behind it */
} vs_child_process;

/* Starts a copy of this process that calls work(ctx, in, out) and ends when that returns. It reads
 * questions from `in`, which ends when nobody will ask any more, and writes answers to `out`. Its
 * standard input is empty; what it prints goes to standard error. Error: VS_RUN, there is no
 * process to be had. */
vs_status vs_child_process_fork(vs_child_process *remote, void (*work)(void *ctx, int in, int out),
                                void *ctx, vs_error *err);

/* Starts a program, without a shell. words: its name, which is looked for in $PATH unless it has a
 * slash, and its arguments, ended by NULL. folder: where it runs; "": here. It reads questions from
 * its standard input and writes answers to its standard output; its standard error is this
 * process's. Errors: VS_INPUT at `where`, there is no such program; VS_RUN, no process. */
vs_status vs_child_process_exec(vs_child_process *remote, char *const *words, const char *folder,
                                vs_where where, vs_error *err);

/* Asks, at time t_s of the run. Errors, VS_RUN: the process has ended; it does not read; it has
 * answered before it was asked. VS_SIGNAL: a signal asks this process to end. */
vs_status vs_child_process_ask(vs_child_process *remote, double t_s, const void *question,
                               size_t size, vs_error *err);

/* Takes the answer into remote->in: so many bytes, or one line without its end where size is 0.
 * Errors as those of vs_child_process_ask; VS_RUN, the answer is too long or does not come in time.
 */
vs_status vs_child_process_answer(vs_child_process *remote, size_t size, vs_error *err);

/* Tells the process that nobody will ask it any more, waits a second for its end, and else ends it
 * with all that it has started. Does nothing where there is none. */
void vs_child_process_end(vs_child_process *remote);
