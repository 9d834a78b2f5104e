/* SPDX-License-Identifier: GPL-3.0-or-later
 * Cases dealt out to workers. A worker that dies or does not answer in time costs no more than its
 * own case: it is replaced, the cases it had are run again, each alone, and the one that ends a
 * worker again fails with a row that says so. */
#ifndef VS_STUDY_JOBS_H
#define VS_STUDY_JOBS_H

#include <signal.h>

#include "study/worker.h"

/* Whose cases they are, and who takes the rows. */
typedef struct vs_dealer {
  void *ctx;
  bool (*next)(void *ctx, vs_task *task); /* its index and point; false: there are no more */
  vs_status (*take)(void *ctx, const vs_answer *answer, vs_error *err);
  vs_status (*beat)(void *ctx, vs_error *err); /* ten times a second at least */
} vs_dealer;

typedef struct vs_jobs vs_jobs;
typedef struct vs_jobs_options {
  const vs_plan *plan;
  const char *keep;                  /* as for vs_case_new */
  int count;                         /* of workers */
  double timeout_s;                  /* of one case; 0: none */
  const volatile sig_atomic_t *stop; /* set by a signal: end */
} vs_jobs_options;

/* The cores this process may use. */
int vs_jobs_cores(void);

vs_jobs *vs_jobs_new(const vs_jobs_options *options);
/* Runs all cases the dealer has. Errors: VS_SIGNAL; what the dealer says; no process. Cases in
 * flight are then dropped. May be called again. */
vs_status vs_jobs_run(vs_jobs *jobs, const vs_dealer *dealer, vs_error *err);
void vs_jobs_free(vs_jobs *jobs);

#endif
