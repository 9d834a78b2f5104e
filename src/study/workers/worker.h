/* SPDX-License-Identifier: GPL-3.0-or-later
 * A worker is a child process that runs cases. Tasks reach it through one pipe and answers come
 * back through another, several at once each way. It is forked before this process uses libngspice,
 * as a process can have only one. It ends when its pipe ends, or with this process. */
#pragma once

#include <stdint.h>
#include <sys/types.h>

#include "workers/task_pipe.h"

/* What came of a case. */
typedef struct vs_answer {
  uint64_t index;
  int status;      /* VS_CASE_... */
  bool circuit;    /* ngspice was used, in the worker's own process */
  bool shared;     /* the case's run began as a copy of another's (study/workers/shared_prefix.h) */
  const char *row; /* as vs_case_run adds it; lives until the next answer is taken */
  size_t length;   /* of row, in bytes */
} vs_answer;

/* A worker as its sender sees it. Start from {0}. */
typedef struct vs_worker {
  pid_t pid;                        /* 0: there is no process */
  int to, from;                     /* pipes; reading from the latter does not block */
  vs_task queue[VS_TASK_PIPE_MOST]; /* a ring of tasks sent and not answered, from `first` on */
  size_t first, queued;
  bool alone;     /* the task it has is one that is tried again */
  long circuits;  /* how many of the process' cases used ngspice */
  double heard_s; /* vs_budget_clock_s when it last answered, or got tasks while it had none */
  double case_s;  /* s a case takes, as a running mean; 0: not known yet */
  char *in;       /* bytes that came in; those from `at` on are not taken yet */
  size_t n_in, at, room;
} vs_worker;

/* Starts the process. keep: as for vs_case_new; share: cases may share their past
 * (study/workers/shared_prefix.h). Error: no process or no pipe can be made. */
vs_status vs_worker_start(vs_worker *worker, const vs_plan *plan, const char *keep, bool share,
                          vs_error *err);
/* Sends it tasks and queues them. false: the process is gone, and its pipe broken. */
bool vs_worker_send(vs_worker *worker, const vs_plan *plan, const vs_task *tasks, size_t count);
/* Reads what has come in. false: the pipe has ended. */
bool vs_worker_hear(vs_worker *worker);
/* Takes one whole answer out of what was read; false: there is none. */
bool vs_worker_take(vs_worker *worker, vs_answer *answer);
/* Ends the process and all it has started; returns how it ended, as waitpid does. The queue
 * stays. */
int vs_worker_kill(vs_worker *worker);
