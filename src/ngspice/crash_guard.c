/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ngspice/crash_guard.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/shutdown.h"
#include "ngspice/child.h"

/* By this variable of the environment a process knows that it has begun anew. It has the number of
 * the process, which stays the same; a child process that inherits it has another number. */
static const char AGAIN[] = "VIBROSPICE_BEGUN_ANEW";

static const int GUARDED[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM};
enum { SIGNALS = sizeof GUARDED / sizeof *GUARDED };

static struct {
  volatile sig_atomic_t on;
  bool once;                  /* the guard was begun before in this process */
  char words[1 << 16];        /* of the process to come, each with its final zero */
  char **argv, **environment; /* the environment has one more string, again */
  char again[64];
  char stack[1 << 16]; /* the handler's own, as a crash may be that the stack is full */
  stack_t stack_before;
  int stream[STDERR_FILENO + 1]; /* a copy of standard output and error; -1: there is none */
  struct sigaction before[SIGNALS];
} guard;

/* What a dying process prints is no message for a user: standard output and error go to /dev/null
 * while the guard is on. */
static void hush(void) {
  int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  fflush(NULL);
  for (int k = STDOUT_FILENO; k <= STDERR_FILENO; k++) {
    guard.stream[k] = nowhere >= 0 ? fcntl(k, F_DUPFD_CLOEXEC, STDERR_FILENO + 1) : -1;
    if (guard.stream[k] >= 0) dup2(nowhere, k);
  }
  if (guard.stream[STDERR_FILENO] >= 0) vs_shutdown_report_to(guard.stream[STDERR_FILENO]);
  if (nowhere >= 0) close(nowhere);
}

static void speak(void) {
  vs_shutdown_report_to(STDERR_FILENO);
  for (int k = STDOUT_FILENO; k <= STDERR_FILENO; k++) {
    if (guard.stream[k] >= 0) dup2(guard.stream[k], k);
    if (guard.stream[k] >= 0) close(guard.stream[k]);
  }
}

/* Starts the program anew by exec. Calls only what a signal handler may. */
static void begin_anew(void) {
  sigset_t none;
  if (!guard.on) return;
  guard.on = 0;
  speak();
  alarm(0);
  vs_shutdown_remove_all();
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  execve("/proc/self/exe", guard.argv, guard.environment);
}

static void on_crash(int number) {
  begin_anew();
  signal(number, SIG_DFL);
  raise(number);
}

/* Reads the words that the process was started with, each with its final zero. Returns their size
 * in bytes; 0: they cannot be read, or are too many. */
static size_t read_words(void) {
  size_t size = 0;
  ssize_t n = 0;
  int fd = open("/proc/self/cmdline", O_RDONLY | O_CLOEXEC);
  while (fd >= 0 && size < sizeof guard.words &&
         (n = read(fd, guard.words + size, sizeof guard.words - size)) > 0)
    size += (size_t)n;
  if (fd >= 0) close(fd);
  return fd >= 0 && n == 0 ? size : 0;
}

/* Makes the words and the environment of the process to come. */
static bool prepare_restart(void) {
  size_t size = read_words(), n = 0;
  if (size == 0 || guard.words[size - 1] != '\0') return false;
  for (size_t k = 0; k < size; k++) n += guard.words[k] == '\0';
  guard.argv = vs_alloc(n + 1, sizeof *guard.argv);
  char *word = guard.words;
  for (size_t k = 0; k < n; k++, word += strlen(word) + 1) guard.argv[k] = word;
  for (n = 0; environ[n];) n++;
  guard.environment = vs_alloc(n + 2, sizeof *guard.environment);
  n = 0;
  for (char **e = environ; *e; e++) /* all but an older word */
    if (strncmp(*e, AGAIN, strlen(AGAIN)) != 0) guard.environment[n++] = *e;
  guard.environment[n] = guard.again;
  snprintf(guard.again, sizeof guard.again, "%s=%ld", AGAIN, (long)getpid());
  return true;
}

static void put_on(void) {
  const stack_t stack = {.ss_sp = guard.stack, .ss_size = sizeof guard.stack};
  const struct sigaction crash = {.sa_handler = on_crash, .sa_flags = SA_ONSTACK};
  guard.once = true;
  hush();
  guard.on = 1;
  sigaltstack(&stack, &guard.stack_before);
  for (size_t k = 0; k < SIGNALS; k++) sigaction(GUARDED[k], &crash, &guard.before[k]);
  atexit(begin_anew);
  alarm(VS_CHILD_SECONDS);
}

/* A process that has been asked to stop uses the alarm for its grace period; it is left alone. */
bool vs_crash_guard_begin(void) {
  sigset_t before;
  if (guard.once || vs_crash_guard_again() || !prepare_restart()) return false;
  vs_shutdown_block_signals(&before);
  bool stopping = vs_shutdown_requested;
  if (!stopping) put_on();
  vs_shutdown_unblock_signals(&before);
  return !stopping;
}

void vs_crash_guard_retry(void) {
  if (guard.on) begin_anew();
}

void vs_crash_guard_end(void) {
  sigset_t before;
  if (!guard.on) return;
  vs_shutdown_block_signals(&before);
  guard.on = 0;
  speak();
  bool stopping = vs_shutdown_requested; /* the alarm is for that then */
  if (!stopping) alarm(0);
  for (size_t k = 0; k < SIGNALS; k++)
    if (GUARDED[k] != SIGALRM || !stopping) sigaction(GUARDED[k], &guard.before[k], NULL);
  sigaltstack(&guard.stack_before, NULL);
  vs_shutdown_unblock_signals(&before);
  free(guard.argv);
  free(guard.environment);
}

bool vs_crash_guard_again(void) {
  const char *number = getenv(AGAIN);
  return number && strtol(number, NULL, 10) == (long)getpid();
}
