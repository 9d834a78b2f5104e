/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/shutdown.h"

#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"

volatile sig_atomic_t vs_shutdown_requested;

/* The paths to be removed, and the process that has noted each: a forked child removes its own
 * alone. The signal handler may read them between any two instructions of this process' only
 * thread; each is one word, and so is never half written. */
static const char *volatile removed[VS_SHUTDOWN_MOST];
static volatile pid_t noted_by[VS_SHUTDOWN_MOST];
static volatile int home = AT_FDCWD; /* the folder from which relative paths lead */
static volatile sig_atomic_t heed = VS_SHUTDOWN_AT_ONCE;
static volatile int told = STDERR_FILENO; /* where is said that a signal has stopped the process */
static volatile pid_t owner; /* the process that has called vs_shutdown_begin; 0: none has */

void vs_shutdown_remove_all(void) {
  const pid_t self = getpid();
  for (int k = 0; k < VS_SHUTDOWN_MOST; k++)
    if (removed[k] && noted_by[k] == self) unlinkat(home, removed[k], 0);
  for (int k = 0; k < VS_SHUTDOWN_MOST; k++) /* fails where the path is a file */
    if (removed[k] && noted_by[k] == self) unlinkat(home, removed[k], AT_REMOVEDIR);
}

/* In a program over the library that has not called vs_shutdown_begin, every process is one of its
 * own. */
void vs_shutdown_now(int status, int child_status, const char *text, size_t size) {
  const bool child = owner && getpid() != owner;
  vs_shutdown_remove_all();
  if (child || write(told, text, size) < 0) _exit(child ? child_status : status);
  _exit(status);
}

static _Noreturn void leave_process(void) {
  static const char TEXT[] = "vibrospice: stopped by a signal\n";
  vs_shutdown_now(VS_SIGNAL, VS_SIGNAL, TEXT, sizeof TEXT - 1);
}

/* The grace time is over: nobody heeded the signal. */
static void on_alarm(int number) {
  (void)number;
  if (heed == VS_SHUTDOWN_WITH_TIMEOUT) leave_process();
}

static void set_alarm(void) {
  signal(SIGALRM, on_alarm);
  alarm(VS_SHUTDOWN_TIMEOUT_S);
}

/* Ends the process as the signal does without a handler, after its files were removed. */
static void on_end(int number) {
  vs_shutdown_remove_all();
  signal(number, SIG_DFL);
  raise(number); /* the signal is taken when this handler has returned */
}

static void on_stop(int number) {
  bool again = vs_shutdown_requested;
  vs_shutdown_requested = 1;
  if (heed == VS_SHUTDOWN_AT_ONCE || getpid() != owner) leave_process();
  if (again && number != SIGTERM) on_end(number); /* a second Ctrl-C ends the process at once */
  if (!again && heed == VS_SHUTDOWN_WITH_TIMEOUT) set_alarm();
}

/* A second TERM does not end the process at once: Slurm, systemd and GNU parallel may send several
 * in a row, and have KILL for what does not end. */
void vs_shutdown_begin(void) {
  const struct sigaction stop = {.sa_handler = on_stop}, pipe = {.sa_handler = on_end};
  struct sigaction before;
  owner = getpid();
  sigaction(SIGINT, &stop, NULL);
  sigaction(SIGTERM, &stop, NULL);
  sigaction(SIGHUP, NULL, &before);
  if (before.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &stop, NULL); /* under nohup HUP stays ignored */
  sigaction(SIGPIPE, NULL, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGPIPE, &pipe, NULL);
  atexit(vs_shutdown_remove_all);
}

void vs_shutdown_report_to(int file) {
  told = file;
}

void vs_shutdown_paths_from(int folder) {
  home = folder;
}

vs_shutdown_mode vs_shutdown_mode_set(vs_shutdown_mode next) {
  vs_shutdown_mode before = (vs_shutdown_mode)heed;
  heed = (sig_atomic_t)next;
  if (before == VS_SHUTDOWN_WITH_TIMEOUT && vs_shutdown_requested) alarm(0);
  if (next == VS_SHUTDOWN_WITH_TIMEOUT && vs_shutdown_requested) set_alarm();
  return before;
}

void vs_shutdown_remove(const char *path) {
  for (int k = 0; k < VS_SHUTDOWN_MOST; k++)
    if (!removed[k]) {
      noted_by[k] = getpid();
      removed[k] = path;
      return;
    }
}

void vs_shutdown_forget(const char *path) {
  for (int k = 0; k < VS_SHUTDOWN_MOST; k++)
    if (removed[k] == path) removed[k] = NULL;
}

void vs_shutdown_block_signals(sigset_t *before) {
  static const int ENDING[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGALRM};
  sigset_t held;
  sigemptyset(&held);
  for (size_t k = 0; k < sizeof ENDING / sizeof *ENDING; k++) sigaddset(&held, ENDING[k]);
  sigprocmask(SIG_BLOCK, &held, before);
}

void vs_shutdown_unblock_signals(const sigset_t *before) {
  sigprocmask(SIG_SETMASK, before, NULL);
}
