/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "child_process.h"

#include <errno.h>
#include <fcntl.h>
#include <fts.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/shutdown.h"
#include "engine/budget.h"

/* How long a process may take to end by itself, s of the wall's clock. It may have files to
 * close. */
static const double GRACE_S = 1;

/* How often who waits looks whether a signal asks this process to end, ms. */
enum { LOOK_MS = 100 };

/* A look that takes longer than this, s, is one in which this process stood still: a batch system
 * has stopped it, and the child perhaps with it. */
static const double PAUSE_S = 1;

/* ---- the child, before it does its work ---- */

/* The child's ends of the pipes, as numbers that no standard stream has. */
enum { CHILD_IN = 3, CHILD_OUT, CHILD_WHY, CHILD_FIRST_FREE };

/* The child heeds signals as a program does that was just started, and leaves no core file. A group
 * of its own lets the parent end it with all that it has started; and Ctrl-C, which the terminal
 * sends to the parent's group, is the parent's to heed. */
static void settle_child(pid_t parent) {
  const struct rlimit none = {0, 0};
  sigset_t nothing;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1); /* it has died before that */
  setpgid(0, 0);
  for (int number = 1; number < NSIG; number++) signal(number, SIG_DFL);
  sigemptyset(&nothing);
  sigprocmask(SIG_SETMASK, &nothing, NULL);
  setrlimit(RLIMIT_CORE, &none);
}

/* Gives the three ends their numbers, and closes all that is open beyond them: the files that the
 * parent writes, and its pipes to others. */
static void take_pipe_ends(int in, int out, int why) {
  in = fcntl(in, F_DUPFD, CHILD_FIRST_FREE);
  out = fcntl(out, F_DUPFD, CHILD_FIRST_FREE);
  why = fcntl(why, F_DUPFD, CHILD_FIRST_FREE);
  dup2(in, CHILD_IN);
  dup2(out, CHILD_OUT);
  dup2(why, CHILD_WHY);
  fcntl(CHILD_WHY, F_SETFD, FD_CLOEXEC);
  close_range(CHILD_FIRST_FREE, ~0u, 0);
}

static void remove_folder(const vs_child_process *r) {
  if (!r->folder || !*r->folder) return;
  char *const folder[] = {(char *)(uintptr_t)r->folder, NULL};
  FTS *tree = fts_open(folder, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
  for (const FTSENT *f; tree && (f = fts_read(tree));)
    if (f->fts_info != FTS_D) remove(f->fts_path);
  if (tree) fts_close(tree);
}

/* A second child, the watchman, lives in the group of the first and does nothing until this process
 * dies: then it ends the group. The kernel ends the first child alone, and not what that has
 * started. */
static _Noreturn void watch_over_group(const vs_child_process *r, pid_t owner, pid_t group) {
  sigset_t all, died;
  int number;
  sigfillset(&all);
  sigemptyset(&died);
  sigaddset(&died, SIGTERM);
  sigprocmask(SIG_SETMASK, &all, NULL);
  setpgid(0, group);
  close_range(0, ~0u, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  while (getppid() == owner) sigwait(&died, &number);
  remove_folder(r);
  kill(-group, SIGKILL);
  _exit(0);
}

/* ---- how it is started ---- */

/* What the child does: calls work, or becomes another program. */
typedef struct task {
  void (*work)(void *ctx, int in, int out); /* NULL: another program */
  void *ctx;
  char *const *words;
  const char *folder;
} task;

static _Noreturn void do_work(const task *t) {
  int null = open("/dev/null", O_RDONLY);
  dup2(null, STDIN_FILENO);
  close(null);
  close(CHILD_WHY);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  t->work(t->ctx, CHILD_IN, CHILD_OUT);
  fflush(NULL);
  _exit(0);
}

static _Noreturn void become(const task *t) {
  dup2(CHILD_IN, STDIN_FILENO);
  dup2(CHILD_OUT, STDOUT_FILENO);
  close(CHILD_IN);
  close(CHILD_OUT);
  if (!*t->folder || !chdir(t->folder)) execvp(t->words[0], t->words);
  int why = errno;
  _exit(write(CHILD_WHY, &why, sizeof why) < 0 ? 126 : 127);
}

static void close_both(const int ends[2]) {
  close(ends[0]);
  close(ends[1]);
}

/* Makes three pipes; false, with errno: there are none. */
static bool make_pipes(int there[2], int back[2], int why[2]) {
  if (pipe2(there, O_CLOEXEC)) return false;
  if (!pipe2(back, O_CLOEXEC)) {
    if (!pipe2(why, O_CLOEXEC)) return true;
    close_both(back);
  }
  close_both(there);
  return false;
}

/* Starts the child. *why is what kept it from becoming another program; 0: nothing did. */
static vs_status start(vs_child_process *r, const task *t, int *why, vs_error *err) {
  int there[2], back[2], trouble[2];
  *why = 0;
  if (!make_pipes(there, back, trouble))
    return vs_fail(err, VS_RUN, "control: no pipe: %s", strerror(errno));
  fflush(NULL); /* what is not written yet would be written twice */
  pid_t parent = getpid(), pid = fork();
  if (pid == 0) {
    settle_child(parent);
    take_pipe_ends(there[0], back[1], trouble[1]);
    t->work ? do_work(t) : become(t);
  }
  int no_process = errno;
  close(there[0]), close(back[1]), close(trouble[1]);
  if (pid < 0) {
    close(there[1]), close_both((int[2]){back[0], trouble[0]});
    return vs_fail(err, VS_RUN, "control: no process for %s: %s", r->name, strerror(no_process));
  }
  setpgid(pid, pid); /* both processes do this, and either may be first */
  r->watchman = fork();
  if (r->watchman == 0) watch_over_group(r, parent, pid);
  while (read(trouble[0], why, sizeof *why) < 0 && errno == EINTR) {
  }
  close(trouble[0]);
  fcntl(there[1], F_SETFL, O_NONBLOCK);
  fcntl(back[0], F_SETFL, O_NONBLOCK);
  r->pid = pid;
  r->owner = parent;
  r->to = there[1];
  r->from = back[0];
  r->t_s = 0;
  r->until_s = vs_budget_clock_s() + r->timeout_s;
  r->n_in = 0;
  return VS_OK;
}

vs_status vs_child_process_fork(vs_child_process *r, void (*work)(void *, int, int), void *ctx,
                                vs_error *err) {
  const task t = {.work = work, .ctx = ctx};
  int why;
  return start(r, &t, &why, err);
}

vs_status vs_child_process_exec(vs_child_process *r, char *const *words, const char *folder,
                                vs_where where, vs_error *err) {
  const task t = {.words = words, .folder = folder};
  int why;
  vs_status status = start(r, &t, &why, err);
  if (status || !why) return status;
  vs_child_process_end(r);
  return vs_fail_at(err, where, "control: the program %s cannot be started%s%s: %s", words[0],
                    *folder ? " in " : "", folder, strerror(why));
}

/* ---- how it ends ---- */

static void wait_for_end(pid_t pid, int *how) {
  while (waitpid(pid, how, 0) < 0 && errno == EINTR) {
  }
}

/* Ends the child and whatever is left of its group. True: it has ended by itself within the grace,
 * and *how is what waitpid gives. A child that has ended keeps its number, and that of its group,
 * until it is waited for. */
static bool finish_child(vs_child_process *r, double grace_s, int *how) {
  const double until_s = vs_budget_clock_s() + grace_s;
  const struct timespec pause = {0, 1000000};
  siginfo_t ended = {0};
  int unused;
  close(r->to);
  close(r->from);
  while (!waitid(P_PID, (id_t)r->pid, &ended, WEXITED | WNOHANG | WNOWAIT) && !ended.si_pid &&
         vs_budget_clock_s() < until_s)
    nanosleep(&pause, NULL);
  kill(-r->pid, SIGKILL);
  kill(r->pid, SIGKILL);
  if (r->watchman > 0) {
    kill(r->watchman, SIGKILL);
    wait_for_end(r->watchman, &unused);
  }
  wait_for_end(r->pid, how);
  r->pid = 0;
  return ended.si_pid;
}

/* Ends the child at once, for a reason that the caller tells. */
static void dismiss(vs_child_process *r) {
  int how;
  finish_child(r, 0, &how);
}

void vs_child_process_end(vs_child_process *r) {
  int how;
  const bool own = !r->owner || r->owner == getpid();
  if (r->pid && own) finish_child(r, GRACE_S, &how);
  if (own) remove_folder(r);
  if (r->pid) { /* a copy of the owner has the pipes, but the child is not its own */
    close(r->to);
    close(r->from);
    r->pid = 0;
  }
}

/* Says how the child ended. */
static vs_status tell_end(const vs_child_process *r, int how, vs_error *err) {
  if (WIFSIGNALED(how))
    return vs_fail(err, VS_RUN, "t = %.9g s: control: %s ended by signal %d (%s)", r->t_s, r->name,
                   WTERMSIG(how), strsignal(WTERMSIG(how)));
  return vs_fail(err, VS_RUN, "t = %.9g s: control: %s ended with status %d, without an answer",
                 r->t_s, r->name, WEXITSTATUS(how));
}

/* The child has closed a pipe: says how it ended, which it may be about to. */
static vs_status has_ended(vs_child_process *r, vs_error *err) {
  int how = 0;
  if (finish_child(r, GRACE_S, &how)) return tell_end(r, how, err);
  return vs_fail(err, VS_RUN, "t = %.9g s: control: %s closed its pipe, without an answer", r->t_s,
                 r->name);
}

/* No answer has come. The child may have ended, and something that it has started may hold its pipe
 * open. */
static vs_status is_late(vs_child_process *r, vs_error *err) {
  int how = 0;
  if (finish_child(r, 0, &how)) return tell_end(r, how, err);
  return vs_fail(err, VS_RUN, "t = %.9g s: control: %s gave no answer within control.timeout, %g s",
                 r->t_s, r->name, r->timeout_s);
}

/* ---- questions and answers ---- */

/* Waits until a pipe can be read (POLLIN) or written (POLLOUT), or was closed at its other end. */
static vs_status wait_for(vs_child_process *r, int end, short what, vs_error *err) {
  for (;;) {
    struct pollfd one = {.fd = end, .events = what};
    if (vs_shutdown_requested) {
      dismiss(r);
      return vs_fail(err, VS_SIGNAL, "t = %.9g s: stopped by a signal", r->t_s);
    }
    const double now_s = vs_budget_clock_s(), left_ms = 1e3 * (r->until_s - now_s);
    if (poll(&one, 1, (int)fmax(0, fmin(ceil(left_ms), LOOK_MS))) > 0) return VS_OK;
    if (left_ms <= 0) return is_late(r, err);
    if (vs_budget_clock_s() - now_s > PAUSE_S) r->until_s = vs_budget_clock_s() + r->timeout_s;
  }
}

/* Writes without SIGPIPE, which would end this process where the child has ended. */
static ssize_t write_quietly(int end, const void *data, size_t size) {
  const struct sigaction ignore = {.sa_handler = SIG_IGN};
  struct sigaction before;
  sigaction(SIGPIPE, &ignore, &before);
  ssize_t n = write(end, data, size);
  int why = errno;
  sigaction(SIGPIPE, &before, NULL);
  errno = why;
  return n;
}

static bool is_only_busy(void) {
  return errno == EAGAIN || errno == EINTR;
}

/* Error: there is an answer that nobody has asked for, so that it is not clear which question the
 * next one is for. */
static vs_status expect_silence(vs_child_process *r, vs_error *err) {
  char one;
  ssize_t n = read(r->from, &one, 1);
  if (n < 0 && is_only_busy()) return VS_OK;
  if (n <= 0) return has_ended(r, err);
  dismiss(r);
  return vs_fail(
      err, VS_RUN,
      "t = %.9g s: control: %s answered before it was asked; wanted: one answer for each "
      "question",
      r->t_s, r->name);
}

vs_status vs_child_process_ask(vs_child_process *r, double t_s, const void *question, size_t size,
                               vs_error *err) {
  const char *at = question;
  vs_status status = VS_OK;
  if (!r->pid || r->owner != getpid())
    return vs_fail(err, VS_RUN, "t = %.9g s: control: %s does not work for this process", t_s,
                   r->name);
  r->t_s = t_s;
  r->until_s = vs_budget_clock_s() + r->timeout_s;
  r->n_in = 0;
  status = expect_silence(r, err);
  while (size > 0 && !status) {
    ssize_t n = write_quietly(r->to, at, size);
    if (n < 0 && !is_only_busy()) return has_ended(r, err);
    if (n > 0) at += n, size -= (size_t)n;
    if (n < 0) status = wait_for(r, r->to, POLLOUT, err);
  }
  return status;
}

/* Where the answer ends; 0: it has not ended yet. */
static size_t end_of_answer(const vs_child_process *r, size_t size) {
  const char *end = memchr(r->in, '\n', r->n_in);
  if (size) return r->n_in >= size ? size : 0;
  return end ? (size_t)(end - r->in) + 1 : 0;
}

vs_status vs_child_process_answer(vs_child_process *r, size_t size, vs_error *err) {
  const size_t most = size ? size : VS_REMOTE_MOST;
  size_t end = 0;
  while (!(end = end_of_answer(r, size))) {
    if (r->n_in == most) {
      dismiss(r);
      return vs_fail(err, VS_RUN, "t = %.9g s: control: %s gave an answer longer than %zu bytes",
                     r->t_s, r->name, most);
    }
    ssize_t n = read(r->from, r->in + r->n_in, most - r->n_in);
    if (n > 0) r->n_in += (size_t)n;
    if (n == 0 || (n < 0 && !is_only_busy())) return has_ended(r, err);
    vs_status status = n < 0 ? wait_for(r, r->from, POLLIN, err) : VS_OK;
    if (status) return status;
  }
  if (end < r->n_in) {
    dismiss(r);
    return vs_fail(
        err, VS_RUN,
        "t = %.9g s: control: %s gave more than one line; wanted: one line for each question",
        r->t_s, r->name);
  }
  r->in[size ? end : end - 1] = '\0';
  return VS_OK;
}
