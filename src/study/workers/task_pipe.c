/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/task_pipe.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/budget.h"
#include "ngspice/ngspice.h"

/* An answer waits this long for others, so that many quick cases cost one write. */
static const double PATIENCE_S = 0.01;

vs_task_pipe *vs_task_pipe_new(const vs_plan *plan, int in, int out) {
  vs_task_pipe *d = vs_alloc(1, sizeof *d);
  *d = (vs_task_pipe){.plan = plan, .in = in, .out = out};
  d->tasks = vs_alloc(VS_TASK_PIPE_MOST, sizeof *d->tasks);
  return d;
}

/* ---- tasks ---- */

static bool read_task_bytes(int fd, void *to, size_t size) {
  for (char *at = to; size;) {
    ssize_t n = read(fd, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= (size_t)n;
  }
  return true;
}

void vs_task_pipe_wait(vs_task_pipe *d) {
  uint32_t count;
  bool whole = read_task_bytes(d->in, &count, sizeof count);
  for (uint32_t k = 0; k < count && whole; k++)
    whole = read_task_bytes(d->in, &d->tasks[k].index, sizeof d->tasks[k].index) &&
            read_task_bytes(d->in, d->tasks[k].point, d->plan->n_axes * sizeof(double));
  if (!whole) _exit(0); /* exit() would flush and remove what is the parent's */
  d->count = count;
}

/* ---- answers ---- */

static void put_in_box(vs_task_pipe *d, const void *bytes, size_t size) {
  if (!d->size) d->since_s = vs_budget_clock_s();
  if (d->size + size > d->room) {
    d->room = 2 * (d->size + size);
    d->box = vs_resize(d->box, d->room, 1);
    if (!d->box) _exit(1);
  }
  memcpy(d->box + d->size, bytes, size);
  d->size += size;
}

void vs_task_pipe_answer(vs_task_pipe *d, const vs_task_pipe_head *head, const char *row) {
  put_in_box(d, head, sizeof *head);
  put_in_box(d, row, head->length);
}

void vs_task_pipe_deliver(vs_task_pipe *d) {
  const char *at = d->box;
  while (d->size) {
    ssize_t n = write(d->out, at, d->size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) _exit(0); /* the parent is gone */
    at += n;
    d->size -= (size_t)n;
  }
}

void vs_task_pipe_run(vs_task_pipe *d, vs_case *c, size_t k) {
  const vs_task *task = &d->tasks[k];
  bool circuit;
  if (d->size && vs_budget_clock_s() - d->since_s > PATIENCE_S) vs_task_pipe_deliver(d);
  d->row.length = 0;
  int status = vs_case_run(c, task->index, task->point, &d->row, &circuit);
  const vs_task_pipe_head head = {task->index, d->row.length, status, circuit, 0, 0};
  vs_task_pipe_answer(d, &head, d->row.text);
  if (vs_ngspice_usable()) return;
  vs_task_pipe_deliver(d);
  _exit(0);
}
