/* SPDX-License-Identifier: GPL-3.0-or-later
 * Deals cases out to workers. A worker that dies or does not answer in time costs no more than its
 * own case. It is replaced, and each case it had is run again in a worker that has nothing else. A
 * case that ends such a worker, too, has failed; its row says how. */
#pragma once

#include <signal.h>

#include "workers/worker.h"

/* Where cases come from and rows go to: functions of the caller's, all called with ctx. */
typedef struct vs_task_source {
  void *ctx;
  /* Writes the next task's index and point; false: there are no more. */
  bool (*next)(void *ctx, vs_task *task);
  /* How many tasks there are left, or more. */
  uint64_t (*left)(void *ctx);
  /* Takes the row of a case, in the order in which cases end. An error ends the jobs. */
  vs_status (*take)(void *ctx, const vs_answer *answer, vs_error *err);
  /* Is called at least ten times a second, for progress. An error ends the jobs. */
  vs_status (*beat)(void *ctx, vs_error *err);
} vs_task_source;

typedef struct vs_worker_pool vs_worker_pool;
typedef struct vs_worker_pool_options {
  const vs_plan *plan;
  const char *keep; /* as for vs_case_new */
  bool share;       /* cases may share their past (study/workers/shared_prefix.h) */
  int count;        /* of workers */
  double timeout_s; /* of one case; 0: none */
  const volatile sig_atomic_t *stop; /* a signal sets it; the jobs then end with VS_SIGNAL */
} vs_worker_pool_options;

/* Returns how many cores this process may use. */
int vs_worker_pool_cores(void);

/* The workers themselves are started when there is a case for them. The plan is borrowed. */
vs_worker_pool *vs_worker_pool_new(const vs_worker_pool_options *options);
/* Runs all cases the dealer has; it may be called again with others. Errors: VS_SIGNAL; what the
 * dealer returns; no process can be made. The cases under way are then dropped. */
vs_status vs_worker_pool_run(vs_worker_pool *jobs, const vs_task_source *dealer, vs_error *err);
void vs_worker_pool_free(vs_worker_pool *jobs);
