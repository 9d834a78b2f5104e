/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ngspice/child.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/alloc.h"
#include "ngspice/sandbox.h"

/* A crash ends the child by its signal, without a message and without a core file. */
static void die_quietly(void) {
  static const int CRASHES[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
  const struct rlimit none = {0, 0};
  int null = open("/dev/null", O_WRONLY);
  dup2(null, STDOUT_FILENO);
  dup2(null, STDERR_FILENO);
  setrlimit(RLIMIT_CORE, &none);
  for (size_t k = 0; k < sizeof CRASHES / sizeof *CRASHES; k++) signal(CRASHES[k], SIG_DFL);
}

void vs_child_limit_time(void) {
  const struct itimerval limit = {.it_value.tv_sec = VS_CHILD_SECONDS};
  signal(SIGALRM, SIG_DFL);
  signal(SIGPROF, SIG_DFL);
  setitimer(ITIMER_PROF, &limit, NULL);
  alarm(10 * VS_CHILD_SECONDS);
}

bool vs_child_is_late(int how) {
  return WIFSIGNALED(how) && (WTERMSIG(how) == SIGPROF || WTERMSIG(how) == SIGALRM);
}

_Noreturn void vs_child_finish(void) {
  _exit(VS_CHILD_GOOD);
}

/* The complaints are written at once, as a pipe takes that many bytes whole. */
_Static_assert(sizeof((vs_solver_errors *)0)->item <= PIPE_BUF,
               "a pipe takes all complaints at once");

/* The child's own life. */
static _Noreturn void attempt_alone(vs_child_end (*attempt)(void *), void *ctx,
                                    const vs_solver_errors *complaints, int pipe_end) {
  prctl(PR_SET_PDEATHSIG, SIGKILL); /* nobody outlives the parent */
  vs_child_limit_time();
  die_quietly();
  vs_sandbox_process(VS_SANDBOX_TRIAL);
  vs_child_end end = attempt(ctx);
  if (end == VS_CHILD_GOOD) vs_child_finish();
  size_t size = complaints->count * VS_SOLVER_ERRORS_LINE;
  if (write(pipe_end, complaints->item, size) < 0) end = VS_CHILD_BAD_LOAD;
  _exit((int)end);
}

/* Takes what the child says and waits for its end, which it gives as waitpid does. A signal that
 * this process handles means that it is to stop. */
static vs_status hear_child(pid_t child, int pipe_end, vs_solver_errors *c, int *how,
                            vs_error *err) {
  ssize_t n = read(pipe_end, c->item, sizeof c->item);
  bool stopped = n < 0 && errno == EINTR;
  if (stopped) kill(child, SIGKILL);
  while (waitpid(child, how, 0) < 0 && errno == EINTR) {
  }
  c->count = n > 0 ? (size_t)n / VS_SOLVER_ERRORS_LINE : 0;
  return stopped ? vs_fail(err, VS_SIGNAL, "t = 0 s: stopped by a signal") : VS_OK;
}

const char vs_child_forbidden[] =
    "ended by signal SIGSYS: a filter of system calls outside of the program, as of a container, "
    "forbids a call that it makes; let that filter refuse calls with an error, or allow them";

static bool ran_out(int how) {
  return WIFEXITED(how) && WEXITSTATUS(how) == VS_ALLOC_STATUS;
}

static bool was_killed(int how) {
  return WIFSIGNALED(how) && WTERMSIG(how) == SIGKILL;
}

static vs_status try_once(vs_child_end (*attempt)(void *), void *ctx, vs_solver_errors *complaints,
                          int *how, vs_error *err) {
  int ends[2];
  if (pipe(ends)) return vs_fail(err, VS_RUN, "no pipe: %s", strerror(errno));
  fflush(NULL);
  pid_t child = fork();
  if (child == 0) attempt_alone(attempt, ctx, complaints, ends[1]);
  int why = errno;
  close(ends[1]);
  vs_status status = child < 0 ? vs_fail(err, VS_RUN, "no child process: %s", strerror(why))
                               : hear_child(child, ends[0], complaints, how, err);
  close(ends[0]);
  return status;
}

vs_status vs_child_try(vs_child_end (*attempt)(void *), void *ctx, vs_solver_errors *complaints,
                       vs_child_end *end, vs_error *err) {
  int how = 0;
  *end = VS_CHILD_GOOD;
  vs_status status = try_once(attempt, ctx, complaints, &how, err);
  /* a circuit does not cause a SIGKILL; the first one may have come from outside */
  if (!status && was_killed(how)) status = try_once(attempt, ctx, complaints, &how, err);
  if (status) return status;
  if (vs_child_is_late(how))
    return vs_fail(err, VS_INPUT, "ngspice cannot take the circuit: " VS_CHILD_HUNG " in %d s",
                   VS_CHILD_SECONDS);
  if (WIFSIGNALED(how) && WTERMSIG(how) == SIGSYS)
    return vs_fail(err, VS_RUN, "the trial of the circuit was %s", vs_child_forbidden);
  if (was_killed(how))
    return vs_fail(err, VS_RUN,
                   "ngspice cannot take the circuit: the process that tried it was killed (signal "
                   "9), as the kernel does where memory runs out");
  if (WIFSIGNALED(how))
    return vs_fail(err, VS_INPUT, "ngspice cannot take the circuit: " VS_CHILD_DIED " (signal %d)",
                   WTERMSIG(how));
  if (ran_out(how))
    return vs_fail(err, VS_RUN, "ngspice cannot take the circuit: it ran out of memory");
  if (how) *end = WEXITSTATUS(how) == VS_CHILD_BAD_RUN ? VS_CHILD_BAD_RUN : VS_CHILD_BAD_LOAD;
  return VS_OK;
}

/* ---- a copy ---- */

vs_status vs_child_fork(vs_child_copy *copy, vs_error *err) {
  int ends[2];
  if (pipe(ends)) return vs_fail(err, VS_RUN, "no pipe: %s", strerror(errno));
  fflush(NULL); /* what is not written yet would be written twice */
  pid_t parent = getpid(), child = fork();
  *copy = (vs_child_copy){child, ends[child == 0]};
  if (child < 0) {
    vs_fail(err, VS_RUN, "no child process: %s", strerror(errno));
    close(ends[0]);
    close(ends[1]);
    return VS_RUN;
  }
  close(ends[child != 0]);
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(VS_CHILD_BAD_RUN); /* it has died before that */
  }
  return VS_OK;
}

bool vs_child_say(const vs_child_copy *copy, const void *data, size_t size) {
  const char *at = data;
  while (size > 0) {
    ssize_t n = write(copy->pipe_end, at, size);
    if (n < 0 && errno != EINTR) break;
    if (n > 0) at += n, size -= (size_t)n;
  }
  return size == 0;
}

_Noreturn void vs_child_tell(const vs_child_copy *copy, const void *data, size_t size) {
  _exit(vs_child_say(copy, data, size) ? VS_CHILD_GOOD : VS_CHILD_BAD_RUN);
}

bool vs_child_listen(const vs_child_copy *copy, void *data, size_t size) {
  char *at = data;
  while (size > 0) {
    ssize_t n = read(copy->pipe_end, at, size);
    if (n == 0 || (n < 0 && errno != EINTR)) break;
    if (n > 0) at += n, size -= (size_t)n;
  }
  return size == 0;
}

int vs_child_end_of(const vs_child_copy *copy) {
  int how = 0;
  close(copy->pipe_end);
  while (waitpid(copy->pid, &how, 0) < 0 && errno == EINTR) {
  }
  return how;
}

vs_status vs_child_hear(const vs_child_copy *copy, void *data, size_t size, vs_error *err) {
  bool whole = vs_child_listen(copy, data, size);
  int how = vs_child_end_of(copy);
  if (ran_out(how)) return vs_fail(err, VS_RUN, "a copy of this process ran out of memory");
  return !whole || how ? vs_fail(err, VS_RUN, "a copy of this process did not come to its end")
                       : VS_OK;
}
