/* SPDX-License-Identifier: GPL-3.0-or-later
 * A worker: a child process that runs cases it is sent through a pipe and answers through another,
 * several at once each way. It is made by fork before this process uses libngspice, of which there
 * is one in a process, and ends when its pipe does, or with this process. */
#ifndef VS_STUDY_WORKER_H
#define VS_STUDY_WORKER_H

#include <stdint.h>
#include <sys/types.h>

#include "study/case.h"

enum { VS_WORKER_QUEUE = 256 }; /* cases it may have at a time */

/* A case that is to be run. */
typedef struct vs_task {
  uint64_t index;
  int tries; /* of it alone, by a worker that died */
  double point[VS_PLAN_AXES];
} vs_task;

typedef struct vs_answer {
  uint64_t index;
  int status; /* VS_CASE_... */
  bool circuit;
  const char *row; /* lives until the next answer is taken */
  size_t length;
} vs_answer;

/* The sender's view of one. Start from {0}. */
typedef struct vs_worker {
  pid_t pid;                      /* 0: there is none */
  int to, from;                   /* pipes; from does not block */
  vs_task queue[VS_WORKER_QUEUE]; /* sent and not answered, the oldest at `first` */
  size_t first, queued;
  bool alone;     /* what it has is a case that is tried again */
  long circuits;  /* cases that used ngspice */
  double heard_s; /* when it last answered, or was sent something while it had nothing; monotonic */
  double case_s;  /* what a case takes; 0: not known yet */
  char *in;       /* bytes come in, not taken yet */
  size_t n_in, at, room;
} vs_worker;

/* Error: no process or no pipe. keep: as for vs_case_new. */
vs_status vs_worker_start(vs_worker *worker, const vs_plan *plan, const char *keep, vs_error *err);
/* false: it is gone, and its pipe broken. */
bool vs_worker_send(vs_worker *worker, const vs_plan *plan, const vs_task *tasks, size_t count);
/* Takes what has come in; false: the pipe has ended. vs_worker_take then gives the answers. */
bool vs_worker_hear(vs_worker *worker);
bool vs_worker_take(vs_worker *worker, vs_answer *answer);
/* Ends it, and what it has started; gives how, as waitpid does. Its queue stays. */
int vs_worker_kill(vs_worker *worker);

double vs_worker_clock(void); /* monotonic, s */

#endif
