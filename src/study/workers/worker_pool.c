/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/worker_pool.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/budget.h"
#include "ngspice/child.h"

/* libngspice leaks about a kilobyte a run, so a worker is replaced after this many. */
enum { MOST_CIRCUITS = 500 };
/* How much work a worker is given in advance, as time. It must outlast a pause of this process,
 * such as a write that waits for the disk. */
static const double AHEAD_S = 0.1;
/* How long a turn of vs_worker_pool_run may take and still count for the workers, s: with 50 ms of
 * waiting, and what a busy machine adds. */
static const double TURN_S = 1;
/* How often a case may end a worker that runs nothing else. Once is not enough to blame the case,
 * as a worker may also be ended from outside. */
enum { MOST_TRIES = 2 };

struct vs_worker_pool {
  vs_worker_pool_options o;
  vs_worker *workers;
  struct pollfd *polls;
  vs_task tasks[VS_TASK_PIPE_MOST]; /* those just chosen for one worker */
  vs_task *again;                   /* cases of workers that died, to be run alone */
  size_t n_again, room;
  const vs_task_source *dealer;
  bool dealt;    /* the dealer has no more */
  double turn_s; /* when the clock was looked at last, by vs_budget_clock_s */
};

int vs_worker_pool_cores(void) {
  cpu_set_t set;
  int n = sched_getaffinity(0, sizeof set, &set) ? 1 : CPU_COUNT(&set);
  return n > 0 ? n : 1;
}

vs_worker_pool *vs_worker_pool_new(const vs_worker_pool_options *options) {
  vs_worker_pool *j = vs_alloc(1, sizeof *j);
  j->o = *options;
  j->workers = vs_alloc((size_t)options->count, sizeof *j->workers);
  j->polls = vs_alloc((size_t)options->count, sizeof *j->polls);
  return j;
}

void vs_worker_pool_free(vs_worker_pool *j) {
  for (int k = 0; k < j->o.count; k++) {
    vs_worker_kill(&j->workers[k]);
    free(j->workers[k].in);
  }
  free(j->workers);
  free(j->polls);
  free(j->again);
  free(j);
}

static void put_back(vs_worker_pool *j, const vs_task *task) {
  if (j->n_again == j->room) {
    j->room = j->room ? 2 * j->room : 16;
    j->again = vs_resize(j->again, j->room, sizeof *j->again);
  }
  j->again[j->n_again++] = *task;
}

static vs_status fail_case(vs_worker_pool *j, const vs_task *task, const char *why, vs_error *err) {
  vs_text row = {0};
  vs_case_failure(j->o.plan, task->index, task->point, why, &row);
  const vs_answer answer = {
      .index = task->index, .status = VS_CASE_FAILED, .row = row.text, .length = row.length};
  vs_status status = j->dealer->take(j->dealer->ctx, &answer, err);
  vs_text_free(&row);
  return status;
}

/* Ends a worker that is gone, or that, with `slow`, took too long; the next case starts another.
 * The cases it had are run again, except one that was alone with it often enough: that has failed.
 */
static vs_status replace_worker(vs_worker_pool *j, vs_worker *w, bool slow, vs_error *err) {
  char why[256];
  int how = vs_worker_kill(w);
  bool alone = w->queued == 1;
  vs_status status = VS_OK;
  if (slow)
    snprintf(why, sizeof why, "no end after %g s (--case-timeout)", j->o.timeout_s);
  else if (WIFSIGNALED(how) && WTERMSIG(how) == SIGSYS)
    snprintf(why, sizeof why, "its process was %s", vs_child_forbidden);
  else if (WIFSIGNALED(how))
    snprintf(why, sizeof why, "its process died: signal %d (%s)", WTERMSIG(how),
             strsignal(WTERMSIG(how)));
  else if (WEXITSTATUS(how) == VS_ALLOC_STATUS)
    snprintf(why, sizeof why, "its process ran out of memory");
  else
    snprintf(why, sizeof why, "its process ended itself: exit status %d", WEXITSTATUS(how));
  for (; w->queued; w->queued--, w->first = (w->first + 1) % VS_TASK_PIPE_MOST) {
    vs_task *task = &w->queue[w->first];
    task->tries += alone;
    if (alone && (slow || task->tries >= MOST_TRIES))
      status = status ? status : fail_case(j, task, why, err);
    else
      put_back(j, task);
  }
  return status;
}

/* ---- dealing ---- */

static size_t wanted_ahead(const vs_worker *w) {
  if (!(w->case_s > 0)) return 1;
  double n = ceil(AHEAD_S / w->case_s);
  return n > VS_TASK_PIPE_MOST ? VS_TASK_PIPE_MOST : (size_t)n;
}

/* How many cases a worker is given that may share their past: the more there are, the more they
 * share. All workers are to end at about the same time, so each gets half of its part of what is
 * left. */
static size_t wanted_together(const vs_worker_pool *j) {
  uint64_t left = j->dealer->left(j->dealer->ctx),
           parts = j->o.count > 1 ? 2 * (uint64_t)j->o.count : 1;
  uint64_t n = (left + parts - 1) / parts;
  return n > VS_TASK_PIPE_MOST ? VS_TASK_PIPE_MOST : n > 0 ? (size_t)n : 1;
}

/* Chooses tasks for the worker and returns how many; 0: it has enough, or there are none. */
static size_t choose_tasks(vs_worker_pool *j, const vs_worker *w, bool *alone) {
  size_t n = 0, most = j->o.share ? wanted_together(j) : wanted_ahead(w);
  *alone = j->n_again > 0;
  if (w->queued && j->o.share) return 0; /* what comes later shares with what it has then */
  if (w->queued && (*alone || w->alone || w->circuits >= MOST_CIRCUITS || 2 * w->queued > most))
    return 0; /* it has enough, or must be empty before it gets what comes */
  if (*alone) {
    j->tasks[n++] = j->again[--j->n_again];
    return n;
  }
  while (w->queued + n < most && !j->dealt) {
    j->tasks[n].tries = 0;
    if (j->dealer->next(j->dealer->ctx, &j->tasks[n]))
      n++;
    else
      j->dealt = true;
  }
  return n;
}

/* Fills the worker's queue up if it is half empty. A case that is run again gets a worker of its
 * own. */
static vs_status deal_to_worker(vs_worker_pool *j, vs_worker *w, vs_error *err) {
  bool alone;
  size_t n = choose_tasks(j, w, &alone);
  if (!n) return VS_OK;
  if (w->circuits >= MOST_CIRCUITS) vs_worker_kill(w);
  if (!w->pid) {
    vs_status status = vs_worker_start(w, j->o.plan, j->o.keep, j->o.share, err);
    if (status) return status;
  }
  w->alone = alone;
  if (!vs_worker_send(w, j->o.plan, j->tasks, n))
    kill(w->pid, SIGKILL); /* it may have got a part; that it is gone its pipe will tell */
  return VS_OK;
}

static vs_status deal_all(vs_worker_pool *j, vs_error *err) {
  vs_status status = VS_OK;
  for (int k = 0; k < j->o.count && !status; k++) status = deal_to_worker(j, &j->workers[k], err);
  return status;
}

/* ---- answers ---- */

static vs_status hear_worker(vs_worker_pool *j, vs_worker *w, vs_error *err) {
  vs_answer answer;
  vs_status status = VS_OK;
  bool alive = vs_worker_hear(w);
  size_t n = 0;
  while (!status && vs_worker_take(w, &answer)) {
    status = j->dealer->take(j->dealer->ctx, &answer, err);
    n++;
  }
  double now = vs_budget_clock_s();
  if (n) {
    double each = (now - w->heard_s) / (double)n;
    w->case_s = w->case_s > 0 ? 0.7 * w->case_s + 0.3 * each : each;
    w->heard_s = now;
  }
  return status || alive ? status : replace_worker(j, w, false, err);
}

/* While this process stands still, nobody hears the workers, and they may stand still, too: it
 * waits for a disk, or a batch system has stopped all of them. That time counts for none of them.
 */
static void leave_pause_out(vs_worker_pool *j) {
  const double now = vs_budget_clock_s(), pause = now - j->turn_s;
  j->turn_s = now;
  for (int k = 0; k < j->o.count && pause > TURN_S; k++)
    j->workers[k].heard_s = fmin(j->workers[k].heard_s + pause, now);
}

static vs_status check_time(vs_worker_pool *j, vs_worker *w, vs_error *err) {
  leave_pause_out(j);
  if (!w->pid || !w->queued || !(j->o.timeout_s > 0)) return VS_OK;
  return vs_budget_clock_s() - w->heard_s > j->o.timeout_s ? replace_worker(j, w, true, err)
                                                           : VS_OK;
}

static bool are_cases_over(const vs_worker_pool *j) {
  for (int k = 0; k < j->o.count; k++)
    if (j->workers[k].queued) return false;
  return j->dealt && !j->n_again;
}

static vs_status hear_all(vs_worker_pool *j, vs_error *err) {
  vs_status status = VS_OK;
  nfds_t n = 0;
  for (int k = 0; k < j->o.count; k++)
    if (j->workers[k].pid) j->polls[n++] = (struct pollfd){j->workers[k].from, POLLIN, 0};
  if (poll(j->polls, n, 50) < 0 && errno != EINTR)
    return vs_fail(err, VS_RUN, "no word from the workers: %s", strerror(errno));
  n = 0;
  for (int k = 0; k < j->o.count && !status; k++) {
    if (!j->workers[k].pid) continue;
    short events = j->polls[n++].revents;
    if (events) status = hear_worker(j, &j->workers[k], err);
    if (!status) status = check_time(j, &j->workers[k], err);
  }
  return status;
}

vs_status vs_worker_pool_run(vs_worker_pool *j, const vs_task_source *dealer, vs_error *err) {
  void (*before)(int) =
      signal(SIGPIPE, SIG_IGN); /* writing to a worker that is gone must not end this process */
  j->dealer = dealer;
  j->dealt = false;
  j->turn_s = vs_budget_clock_s();
  vs_status status = VS_OK;
  /* Fill the workers' queues, wait up to 50 ms for answers, hand these to the dealer; until every
   * case is answered, the user stops the study, or something cannot be written. */
  while (!status) {
    if (*j->o.stop) {
      status = vs_fail(err, VS_SIGNAL, "stopped by a signal");
      break;
    }
    status = deal_all(j, err);
    if (status || are_cases_over(j)) break;
    status = hear_all(j, err);
    if (!status) status = dealer->beat(dealer->ctx, err);
  }
  signal(SIGPIPE, before);
  return status;
}
