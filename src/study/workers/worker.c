/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/worker.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/budget.h"
#include "ngspice/sandbox.h"
#include "workers/shared_prefix.h"

static bool write_message(int fd, const void *from, size_t size) {
  for (const char *at = from; size;) {
    ssize_t n = write(fd, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= (size_t)n;
  }
  return true;
}

/* ---- the child ---- */

static _Noreturn void work_off_tasks(const vs_plan *plan, const char *keep, bool share, int in,
                                     int out) {
  vs_task_pipe *desk = vs_task_pipe_new(plan, in, out);
  vs_case *c = vs_case_new(plan, keep);
  vs_shared_prefix *past = share ? vs_shared_prefix_new(plan, c, desk) : NULL;
  /* Wait for a batch of tasks, run each, send the rows back. vs_task_pipe_wait ends the process
   * when the parent has closed the pipe. */
  for (;;) {
    vs_task_pipe_wait(desk);
    if (past)
      vs_shared_prefix_run(past);
    else
      for (size_t k = 0; k < desk->count; k++) vs_task_pipe_run(desk, c, k);
    vs_task_pipe_deliver(desk);
  }
}

/* Sets the child up: it leaves signals to the parent, dumps no core when it crashes, and dies with
 * the parent. */
static void settle_in(pid_t parent, int in, int out) {
  const struct rlimit none = {0, 0};
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);
  setpgid(0, 0);
  signal(SIGINT, SIG_IGN);
  signal(SIGTERM, SIG_IGN);
  signal(SIGHUP, SIG_IGN);
  signal(SIGPIPE, SIG_DFL);
  setrlimit(RLIMIT_CORE, &none);
  int low = in < out ? in : out, high = in < out ? out : in;
  if (low > 3)
    close_range(3, (unsigned)low - 1, 0); /* closes the journal and the other workers' pipes */
  if (high > low + 1) close_range((unsigned)low + 1, (unsigned)high - 1, 0);
  close_range((unsigned)high + 1, ~0u, 0);
}

/* A scene's own code may do whatever its user lets it do. */
static void confine_worker(const vs_plan *plan) {
  if (!plan->allow_code) vs_sandbox_process(VS_SANDBOX_WORKER);
}

/* ---- the parent ---- */

vs_status vs_worker_start(vs_worker *w, const vs_plan *plan, const char *keep, bool share,
                          vs_error *err) {
  int there[2], back[2];
  if (pipe2(there, O_CLOEXEC)) return vs_fail(err, VS_RUN, "no pipe: %s", strerror(errno));
  if (pipe2(back, O_CLOEXEC)) {
    close(there[0]), close(there[1]);
    return vs_fail(err, VS_RUN, "no pipe: %s", strerror(errno));
  }
  fflush(NULL);
  pid_t parent = getpid(), pid = fork();
  if (pid == 0) {
    settle_in(parent, there[0], back[1]);
    confine_worker(plan);
    work_off_tasks(plan, keep, share, there[0], back[1]);
  }
  int why = errno;
  close(there[0]), close(back[1]);
  if (pid < 0) {
    close(there[1]), close(back[0]);
    return vs_fail(err, VS_RUN, "no worker process: %s", strerror(why));
  }
  setpgid(pid, pid); /* both processes do this, and either may be first */
  fcntl(back[0], F_SETFL, O_NONBLOCK);
  w->pid = pid;
  w->to = there[1];
  w->from = back[0];
  w->circuits = 0;
  w->n_in = w->at = 0;
  w->heard_s = vs_budget_clock_s();
  return VS_OK;
}

bool vs_worker_send(vs_worker *w, const vs_plan *plan, const vs_task *tasks, size_t count) {
  const uint32_t n = (uint32_t)count;
  const size_t point = plan->n_axes * sizeof(double), each = sizeof(uint64_t) + point;
  char *message = vs_alloc(1, sizeof n + count * each), *at = message + sizeof n;
  memcpy(message, &n, sizeof n);
  for (size_t k = 0; k < count; k++, at += each) {
    memcpy(at, &tasks[k].index, sizeof(uint64_t));
    memcpy(at + sizeof(uint64_t), tasks[k].point, point);
    w->queue[(w->first + w->queued + k) % VS_TASK_PIPE_MOST] = tasks[k];
  }
  if (!w->queued) w->heard_s = vs_budget_clock_s();
  w->queued += count;
  bool sent = write_message(w->to, message, sizeof n + count * each);
  free(message);
  return sent;
}

bool vs_worker_hear(vs_worker *w) {
  if (w->at) memmove(w->in, w->in + w->at, w->n_in -= w->at);
  w->at = 0;
  for (;;) {
    if (w->room - w->n_in < 4096) {
      w->room = w->room ? 2 * w->room : 65536;
      w->in = vs_resize(w->in, w->room, 1);
    }
    ssize_t n = read(w->from, w->in + w->n_in, w->room - w->n_in);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno == EAGAIN;
    if (n == 0) return false;
    w->n_in += (size_t)n;
  }
}

/* Takes the task of that case out of the queue; cases that share their past are not answered in the
 * order in which they were sent. */
static void take_off(vs_worker *w, uint64_t index) {
  vs_task *first = &w->queue[w->first];
  for (size_t k = 0; k < w->queued; k++) {
    vs_task *task = &w->queue[(w->first + k) % VS_TASK_PIPE_MOST];
    if (task->index != index) continue;
    *task = *first;
    break;
  }
  w->first = (w->first + 1) % VS_TASK_PIPE_MOST;
  w->queued--;
}

bool vs_worker_take(vs_worker *w, vs_answer *answer) {
  vs_task_pipe_head head;
  if (w->n_in - w->at < sizeof head) return false;
  memcpy(&head, w->in + w->at, sizeof head);
  if (w->n_in - w->at - sizeof head < head.length) return false;
  *answer = (vs_answer){.index = head.index,
                        .status = head.status,
                        .circuit = head.circuit,
                        .shared = head.shared,
                        .row = w->in + w->at + sizeof head,
                        .length = head.length};
  w->at += sizeof head + head.length;
  take_off(w, head.index);
  w->circuits += answer->circuit;
  return true;
}

int vs_worker_kill(vs_worker *w) {
  int how = 0;
  if (!w->pid) return 0;
  kill(-w->pid, SIGKILL); /* the whole group, as a worker may have a child that tries a circuit */
  kill(w->pid, SIGKILL);
  while (waitpid(w->pid, &how, 0) < 0 && errno == EINTR) {
  }
  close(w->to);
  close(w->from);
  w->pid = 0;
  return how;
}
