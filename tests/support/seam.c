/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "seam.h"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

/* ---- in the child, before it becomes the program ---- */

static int open_listener(const seam *s) {
  enum { MOST = 64 };
  struct sock_filter code[MOST];
  unsigned short n = 0;
  code[n++] =
      (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
  for (const long *call = s->calls; *call >= 0; call++) {
    code[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (unsigned)*call, 0, 1);
    code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF);
  }
  code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  const struct sock_fprog program = {n, code};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)) return -1;
  return (int)syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER,
                      &program);
}

/* One open file on its way from one process to another. */
typedef struct parcel {
  struct iovec bytes;
  struct msghdr message;
  char byte;
  _Alignas(struct cmsghdr) char room[CMSG_SPACE(sizeof(int))];
} parcel;

static void wrap(parcel *p) {
  *p = (parcel){.byte = 'f'};
  p->bytes = (struct iovec){&p->byte, 1};
  p->message = (struct msghdr){.msg_iov = &p->bytes,
                               .msg_iovlen = 1,
                               .msg_control = p->room,
                               .msg_controllen = sizeof p->room};
}

static bool send_file(int to, int file) {
  parcel p;
  wrap(&p);
  struct cmsghdr *c = CMSG_FIRSTHDR(&p.message);
  *c = (struct cmsghdr){
      .cmsg_level = SOL_SOCKET, .cmsg_type = SCM_RIGHTS, .cmsg_len = CMSG_LEN(sizeof file)};
  memcpy(CMSG_DATA(c), &file, sizeof file);
  return sendmsg(to, &p.message, 0) == 1;
}

/* Returns -1 where none comes. */
static int receive_file(int from) {
  parcel p;
  int file = -1;
  wrap(&p);
  if (recvmsg(from, &p.message, 0) != 1) return -1;
  const struct cmsghdr *c = CMSG_FIRSTHDR(&p.message);
  if (c) memcpy(&file, CMSG_DATA(c), sizeof file);
  return file;
}

typedef struct filtered {
  const seam *s;
  int tell; /* who answers is told of the filter here */
} filtered;

static void filter(void *ctx) {
  const filtered *f = ctx;
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1); /* looking for leaks makes calls of its own */
  if (!send_file(f->tell, open_listener(f->s))) _exit(126);
}

/* ---- who answers the filter ---- */

/* Which argument of a call is the name of a file; -1: none. */
static int argument_of(long number) {
  static const struct {
    long number;
    int argument;
  } NAMED[] = {{SYS_open, 0},     {SYS_rename, 0},  {SYS_mkdir, 0},     {SYS_unlink, 0},
               {SYS_openat, 1},   {SYS_mkdirat, 1}, {SYS_renameat, 1},  {SYS_renameat2, 1},
               {SYS_unlinkat, 1}, {SYS_statx, 1},   {SYS_newfstatat, 1}};
  int argument = -1; /* where an older call is missing, the last row of that number counts */
  for (size_t k = 0; k < COUNT(NAMED); k++)
    if (NAMED[k].number == number) argument = NAMED[k].argument;
  return argument;
}

static void name_file(const struct seccomp_notif *q, char name[VS_PATH_SIZE]) {
  char path[64];
  ssize_t n = -1;
  const int argument = argument_of(q->data.nr);
  *name = '\0';
  if (argument >= 0) {
    snprintf(path, sizeof path, "/proc/%u/mem", q->pid);
    int memory = open(path, O_RDONLY | O_CLOEXEC);
    if (memory >= 0) n = pread(memory, name, VS_PATH_SIZE - 1, (off_t)q->data.args[argument]);
    if (memory >= 0) close(memory);
  } else {
    snprintf(path, sizeof path, "/proc/%u/fd/%d", q->pid, (int)q->data.args[0]);
    n = readlink(path, name, VS_PATH_SIZE - 1);
  }
  name[n > 0 ? n : 0] = '\0';
}

static void answer(const seam *s, int listener, pid_t first) {
  struct seccomp_notif q = {0};
  if (ioctl(listener, SECCOMP_IOCTL_NOTIF_RECV, &q)) return;
  const bool opens = q.data.nr == SYS_open || q.data.nr == SYS_openat;
  seam_call call = {
      .first = first,
      .process = (pid_t)q.pid,
      .number = q.data.nr,
      .creates = opens && q.data.args[argument_of(q.data.nr) + 1] & O_CREAT,
  };
  name_file(&q, call.name);
  const int error = s->answer(s->ctx, &call);
  struct seccomp_notif_resp a = {.id = q.id,
                                 .error = -error,
                                 .flags = error ? 0u : (unsigned)SECCOMP_USER_NOTIF_FLAG_CONTINUE};
  ioctl(listener, SECCOMP_IOCTL_NOTIF_SEND, &a);
}

/* Answers until the program has ended; what it has left behind ends then, too. */
static void attend(const seam *s, pid_t child, int listener) {
  int end = (int)syscall(SYS_pidfd_open, child, 0);
  struct pollfd polls[] = {{listener, POLLIN, 0}, {end, POLLIN, 0}};
  while (poll(polls, 2, -1) > 0 && !polls[1].revents)
    if (polls[0].revents & POLLIN) answer(s, listener, child);
  close(end);
  close(listener);
}

ran seam_run(const seam *s, const char *words) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
    return (ran){126, vs_copy(""), vs_copy("no socket")};
  pid_t child = spawn_prepared(words, filter, &(filtered){s, ends[1]});
  close(ends[1]);
  int listener = receive_file(ends[0]);
  if (listener >= 0) attend(s, child, listener);
  close(ends[0]);
  return collect(child);
}

bool seam_is_library(const seam_call *call) {
  const char *slash = strrchr(call->name, '/');
  return strstr(slash ? slash : call->name, ".so") != NULL;
}

static int let(void *ctx, const seam_call *call) {
  (void)ctx, (void)call;
  return 0;
}

bool seam_is_possible(void) {
  const seam s = {(const long[]){SYS_rename, -1}, let, NULL};
  ran r = seam_run(&s, "--version");
  bool good = r.status == 0;
  free_ran(&r);
  return good;
}
