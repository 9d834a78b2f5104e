/* SPDX-License-Identifier: GPL-3.0-or-later
 * The desk of a worker process (study/workers/worker.h): where tasks come in through one pipe, some
 * at a time, and answers go out through another. */
#pragma once

#include <stdint.h>

#include "workers/case.h"

enum { VS_TASK_PIPE_MOST = 256 }; /* that a worker may have at a time */

/* A case that is to be run. */
typedef struct vs_task {
  uint64_t index;
  int tries; /* how often a worker that had nothing else has died of it */
  double point[VS_PLAN_AXES];
} vs_task;

/* Precedes each row in the pipe. Both ends are the same program, so the struct is sent as it is in
 * memory. */
typedef struct vs_task_pipe_head {
  uint64_t index;  /* of the case */
  size_t length;   /* of the row, bytes */
  int32_t status;  /* VS_CASE_... */
  int32_t circuit; /* ngspice was used, in the worker's own process */
  int32_t shared;  /* the case's run began as a copy of another's (shared_prefix.h) */
  int32_t spare;   /* 0 */
} vs_task_pipe_head;

typedef struct vs_task_pipe {
  const vs_plan *plan;
  int in, out;
  vs_task *tasks; /* [VS_TASK_PIPE_MOST], those that came last */
  size_t count;
  char *box; /* answers that are not delivered yet */
  size_t size, room;
  double since_s; /* when the oldest of these was put there */
  vs_text row;    /* of the last case that was run here */
} vs_task_pipe;

/* The plan is borrowed. Nobody frees a desk, as its process ends with it. */
vs_task_pipe *vs_task_pipe_new(const vs_plan *plan, int in, int out);

/* Waits for tasks, which replace those before. Ends the process where none will come. */
void vs_task_pipe_wait(vs_task_pipe *desk);

/* Runs task k as a case of its own and answers it. Where ngspice has asked to be unloaded, this
 * ends the process; another worker then runs what is left. */
void vs_task_pipe_run(vs_task_pipe *desk, vs_case *c, size_t k);

/* Puts an answer into the box. An answer may wait there for others, so that many quick cases cost
 * one write; who has run the last case at hand delivers the box. That ends the process where nobody
 * takes the answers. */
void vs_task_pipe_answer(vs_task_pipe *desk, const vs_task_pipe_head *head, const char *row);
void vs_task_pipe_deliver(vs_task_pipe *desk);
