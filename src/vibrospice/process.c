/* SPDX-License-Identifier: MIT */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* dladdr */
#endif
#include "process.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "vibrospice/protocol.h"

extern char **environ;

static __thread char last_error[1024];

vibrospice_status vibrospice_fail(vibrospice_status status, const char *format, ...) {
  va_list list;
  va_start(list, format);
  vsnprintf(last_error, sizeof last_error, format, list);
  va_end(list);
  return status;
}

vibrospice_status vibrospice_no_memory(void) {
  return vibrospice_fail(VIBROSPICE_MEMORY, "there is no memory");
}

const char *vibrospice_error(void) {
  return last_error;
}

/* ---- messages ---- */

vibrospice_status vibrospice_process_died(vibrospice_process *p) {
  char says[512] = "";
  int how = 0;
  const pid_t pid = p->pid > 0 ? p->pid : 0;
  if (p->socket >= 0) close(p->socket);
  p->socket = -1;
  if (pid)
    while (waitpid(pid, &how, 0) < 0 && errno == EINTR) {
    }
  p->pid = 0;
  if (p->says) {
    rewind(p->says);
    for (char row[512]; fgets(row, sizeof row, p->says);) memcpy(says, row, sizeof says);
  }
  says[strcspn(says, "\n")] = '\0';
  if (*says) return vibrospice_fail(VIBROSPICE_ENGINE, "the engine has ended: %s", says);
  if (pid && WIFSIGNALED(how))
    return vibrospice_fail(VIBROSPICE_ENGINE, "the engine was ended by signal %d", WTERMSIG(how));
  if (pid && WEXITSTATUS(how) == 127)
    return vibrospice_fail(VIBROSPICE_ENGINE, "the program vibrospice cannot be started");
  return vibrospice_fail(VIBROSPICE_ENGINE, "the engine has ended");
}

static int say(int socket, const void *data, size_t size, int beside) {
  const char *at = data;
  union {
    struct cmsghdr head;
    char room[CMSG_SPACE(sizeof(int))];
  } control;
  while (size > 0) {
    struct iovec part = {(void *)(uintptr_t)at, size};
    struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
    if (beside >= 0) {
      memset(&control, 0, sizeof control);
      message.msg_control = control.room;
      message.msg_controllen = sizeof control.room;
      struct cmsghdr *c = CMSG_FIRSTHDR(&message);
      c->cmsg_level = SOL_SOCKET;
      c->cmsg_type = SCM_RIGHTS;
      c->cmsg_len = CMSG_LEN(sizeof beside);
      memcpy(CMSG_DATA(c), &beside, sizeof beside);
    }
    ssize_t n = sendmsg(socket, &message, MSG_NOSIGNAL);
    if (n < 0 && errno != EINTR) return 0;
    if (n > 0) at += n, size -= (size_t)n, beside = -1;
  }
  return 1;
}

static int hear(int socket, void *data, size_t size) {
  char *at = data;
  while (size > 0) {
    ssize_t n = recv(socket, at, size, 0);
    if (n == 0 || (n < 0 && errno != EINTR)) return 0;
    if (n > 0) at += n, size -= (size_t)n;
  }
  return 1;
}

int vibrospice_process_ask(int socket, uint32_t kind, const void *data, size_t size,
                           const char *more, int beside) {
  const size_t rest = more ? strlen(more) : 0;
  const vibrospice_head head = {kind, (uint32_t)(size + rest)};
  return say(socket, &head, sizeof head, beside) && say(socket, data, size, -1) &&
         say(socket, more, rest, -1);
}

vibrospice_status vibrospice_process_answer(vibrospice_process *p, uint32_t *kind, char **text,
                                            size_t *size) {
  vibrospice_head head;
  *text = NULL;
  if (!hear(p->socket, &head, sizeof head)) return vibrospice_process_died(p);
  *text = malloc((size_t)head.size + 1);
  if (!*text) {
    vibrospice_process_end(p); /* what it says cannot be taken */
    return vibrospice_no_memory();
  }
  if (!hear(p->socket, *text, head.size)) {
    free(*text);
    *text = NULL;
    return vibrospice_process_died(p);
  }
  (*text)[head.size] = '\0';
  *kind = head.kind;
  *size = head.size;
  if (head.kind == VIBROSPICE_OK || head.kind == VIBROSPICE_ROW) return VIBROSPICE_OK;
  vibrospice_fail((vibrospice_status)head.kind, "%s", *text);
  free(*text);
  *text = NULL;
  return (vibrospice_status)head.kind;
}

vibrospice_status vibrospice_process_ask_for(vibrospice_process *p, uint32_t kind, const void *data,
                                             size_t size, const char *more, char **text) {
  char *answer;
  if (p->socket < 0) return vibrospice_fail(VIBROSPICE_ENGINE, "the engine has ended");
  if (more && strlen(more) > INT32_MAX - size)
    return vibrospice_fail(VIBROSPICE_INPUT, "a text of more than 2 GB");
  if (!vibrospice_process_ask(p->socket, kind, data, size, more, -1))
    return vibrospice_process_died(p);
  vibrospice_status status = vibrospice_process_answer(p, &kind, &answer, &size);
  if (text)
    *text = answer;
  else
    free(answer);
  return status;
}

void vibrospice_process_end(vibrospice_process *p) {
  if (p->socket >= 0) {
    shutdown(p->socket, SHUT_RDWR); /* a copy of this process may have the socket open, too */
    close(p->socket);
  }
  if (p->pid > 0)
    while (waitpid(p->pid, NULL, 0) < 0 && errno == EINTR) {
    }
  if (p->says) fclose(p->says);
  p->socket = -1;
  p->pid = 0;
  p->says = NULL;
}

/* ---- the process ---- */

/* The program's path: as the environment says, beside the library, in ../bin, or its name. */
static const char *find_program(char path[4096]) {
  static const char *const PLACES[] = {"vibrospice", "../bin/vibrospice", "../../bin/vibrospice"};
  const char *named = getenv("VIBROSPICE_PROGRAM");
  Dl_info self;
  struct stat found; /* lib/vibrospice is a folder */
  if (named && *named) return named;
  for (size_t k = 0; k < sizeof PLACES / sizeof *PLACES; k++) {
    if (!dladdr(PLACES, &self) || !self.dli_fname) break;
    const char *slash = strrchr(self.dli_fname, '/');
    snprintf(path, 4096, "%.*s%s", slash ? (int)(slash - self.dli_fname) + 1 : 0, self.dli_fname,
             PLACES[k]);
    if (!stat(path, &found) && S_ISREG(found.st_mode) && !access(path, X_OK)) return path;
  }
  return "vibrospice";
}

/* The environment in which a program that was brought along finds its libraries, to be freed; NULL:
 * no memory. `library` has room for the variable. */
static char **environment_with(const char *program, char library[4200]) {
  static const char NAME[] = "LD_LIBRARY_PATH=";
  size_t count = 0, n = 0;
  const char *slash = strrchr(program, '/');
  while (environ && environ[count]) count++;
  char **all = malloc((count + 2) * sizeof *all);
  if (!all) return NULL;
  snprintf(library, 4200, "%s%.*s../lib", NAME, slash ? (int)(slash + 1 - program) : 0, program);
  for (size_t k = 0; k < count; k++)
    if (strncmp(environ[k], NAME, sizeof NAME - 1) != 0) all[n++] = environ[k];
  all[n++] = library;
  all[n] = NULL;
  return all;
}

/* Starts the engine with one end of a socket as its standard input. It is in a process group of its
 * own, so that a key of the terminal's does not end it, and heeds signals as usual. */
static vibrospice_status spawn(vibrospice_process *p, const char *program) {
  static const int USUAL[] = {SIGPIPE, SIGCHLD, SIGINT, SIGTERM, SIGHUP};
  char path[4096], library[4200], word[] = "serve",
                                  self[] = "vibrospice", *const argv[] = {self, word, NULL};
  int ends[2];
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
    return vibrospice_fail(VIBROSPICE_MEMORY, "no socket can be made: %s", strerror(errno));
  p->socket = ends[0];
  p->says = tmpfile();
  if (p->says) fcntl(fileno(p->says), F_SETFD, FD_CLOEXEC);
  int wrong = posix_spawn_file_actions_init(&files);
  if (!wrong) wrong = posix_spawnattr_init(&attributes);
  if (wrong) {
    close(ends[1]);
    return vibrospice_no_memory();
  }
  posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", 1, 0);
  if (p->says)
    posix_spawn_file_actions_adddup2(&files, fileno(p->says), STDERR_FILENO);
  else
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", 1, 0);
  sigset_t none, usual;
  sigemptyset(&none);
  sigemptyset(&usual);
  for (size_t k = 0; k < sizeof USUAL / sizeof *USUAL; k++) sigaddset(&usual, USUAL[k]);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  char **environment = program ? environment_with(program, library) : NULL;
  if (!program) program = find_program(path);
  wrong = posix_spawnp(&p->pid, program, &files, &attributes, argv,
                       environment ? environment : environ);
  free(environment);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  close(ends[1]);
  if (!wrong) return VIBROSPICE_OK;
  p->pid = 0;
  return vibrospice_fail(VIBROSPICE_ENGINE, "the program %s cannot be started: %s", program,
                         strerror(wrong));
}

/* A program that says nothing for so long is another one. */
enum { PATIENCE_S = 30 };

static vibrospice_status greet(vibrospice_process *p) {
  char *hello;
  uint32_t kind;
  size_t size;
  struct pollfd said = {p->socket, POLLIN, 0};
  int n;
  while ((n = poll(&said, 1, 1000 * PATIENCE_S)) < 0 && errno == EINTR) {
  }
  if (n == 0) {
    kill(p->pid, SIGKILL); /* it need not end with the socket */
    return vibrospice_fail(VIBROSPICE_ENGINE,
                           "the program says nothing: it is not vibrospice, which says '%s'",
                           VIBROSPICE_PROTOCOL);
  }
  vibrospice_status status = vibrospice_process_answer(p, &kind, &hello, &size);
  if (!status && strcmp(hello, VIBROSPICE_PROTOCOL)) {
    kill(p->pid, SIGKILL);
    status = vibrospice_fail(VIBROSPICE_ENGINE,
                             "the program has another version: it says '%.100s', and the "
                             "library is '%s'",
                             hello, VIBROSPICE_PROTOCOL);
  }
  free(hello);
  return status;
}

vibrospice_status vibrospice_process_start(vibrospice_process *p, const char *program) {
  *p = (vibrospice_process){.socket = -1};
  vibrospice_status status = spawn(p, program);
  return status ? status : greet(p);
}

vibrospice_status vibrospice_process_copy(vibrospice_process *of, vibrospice_process *to) {
  int ends[2];
  uint32_t kind;
  size_t size;
  char *text;
  if (of->socket < 0) return vibrospice_fail(VIBROSPICE_ENGINE, "the engine has ended");
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
    return vibrospice_fail(VIBROSPICE_MEMORY, "no socket can be made: %s", strerror(errno));
  to->socket = ends[0];
  int asked = vibrospice_process_ask(of->socket, VIBROSPICE_ASK_COPY, NULL, 0, NULL, ends[1]);
  close(ends[1]);
  if (!asked) return vibrospice_process_died(of);
  vibrospice_status status = vibrospice_process_answer(of, &kind, &text, &size);
  free(text);
  if (!status) {
    status = vibrospice_process_answer(to, &kind, &text, &size); /* the copy's own */
    free(text);
  }
  return status;
}
