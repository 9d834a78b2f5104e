/* SPDX-License-Identifier: GPL-3.0-or-later
 * Requests for memory fail in a shared object that is loaded before the others (tests/faults). A
 * system call is stopped by a filter of seccomp, which asks this process whether it is to go on:
 * that catches those within the C library, too, and the filter is inherited by all processes. */
#include "faults.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* Newer machines lack the older calls. */
#ifndef SYS_open
#define SYS_open SYS_openat
#define SYS_rename SYS_renameat2
#define SYS_renameat SYS_renameat2
#define SYS_fork SYS_clone
#define SYS_vfork SYS_clone
#define SYS_pipe SYS_pipe2
#define SYS_mkdir SYS_mkdirat
#endif

#define CALLS(...)                                                                                 \
  (const long[]) {                                                                                 \
    __VA_ARGS__, -1                                                                                \
  }
#define WRITE CALLS(SYS_write, SYS_pwrite64, SYS_writev)
#define FORK CALLS(SYS_fork, SYS_vfork, SYS_clone, SYS_clone3)
#define OPEN CALLS(SYS_open, SYS_openat)
#define RENAME CALLS(SYS_rename, SYS_renameat, SYS_renameat2)

const fault fault_all[] = {{"memory", 0, NULL, false, false},
                           {"memory from there on", 0, NULL, true, false},
                           {"write", ENOSPC, WRITE, false, false},
                           {"write", EIO, WRITE, false, false},
                           {"fsync", EIO, CALLS(SYS_fsync, SYS_fdatasync), false, false},
                           {"rename", ENOSPC, RENAME, false, false},
                           {"fork", EAGAIN, FORK, false, false},
                           {"pipe", EMFILE, CALLS(SYS_pipe, SYS_pipe2), false, false},
                           {"open", EMFILE, OPEN, false, false},
                           {"close", EIO, CALLS(SYS_close), false, false},
                           {"read", EIO, CALLS(SYS_read, SYS_pread64), false, false},
                           {"mkdir", ENOSPC, CALLS(SYS_mkdir, SYS_mkdirat), false, false},
                           {"flock", ENOLCK, CALLS(SYS_flock), false, false},
                           {"dup", EMFILE, CALLS(SYS_dup), false, false},
                           {"getdents", EIO, CALLS(SYS_getdents64), false, false},
                           {0}};

const fault fault_of_workers = {"memory of workers", 0, NULL, true, true};

/* ---- in the child, before it becomes the program ---- */

static int open_listener(const fault *f) {
  enum { MOST = 16 };
  struct sock_filter code[MOST];
  unsigned short n = 0;
  code[n++] =
      (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
  for (const long *call = f->calls; *call >= 0; call++) {
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

static void set_environment(const fault *f, unsigned long n) {
  char number[32];
  snprintf(number, sizeof number, "%lu", n);
  setenv("LD_PRELOAD", VS_FAULTS, 1);
  setenv("VS_FAULT_COUNT", "../count", 1);
  setenv("VS_FAULT_AT", number, 1);
  if (f->lasts) setenv("VS_FAULT_LASTS", "1", 1);
  if (f->workers) setenv("VS_FAULT_CHILDREN", "1", 1);
}

static pid_t start(const fault *f, unsigned long n, const char *words, int tell) {
  char copy[1024];
  const char *argv[MOST_WORDS];
  snprintf(copy, sizeof copy, "%s", words);
  split(copy, argv);
  fflush(NULL);
  pid_t child = fork();
  if (child) return child;
  enum { MOST_SECONDS = 20 };
  int out = open("../stdout", O_WRONLY | O_CREAT | O_TRUNC, 0600);
  int err = open("../stderr", O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0) _exit(126);
  close(out);
  close(err);
  alarm(MOST_SECONDS);
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1); /* looking for leaks makes calls of its own */
  if (!f->calls)
    set_environment(f, n);
  else if (!send_file(tell, open_listener(f)))
    _exit(126);
  execv(VS_PROGRAM, (char *const *)(size_t)argv);
  _exit(127);
}

/* ---- who answers the filter ---- */

/* Writes the name of the file that the process has open under that number, or of the one that it
 * wants to open. */
static void name_file(const struct seccomp_notif *q, bool opens, char name[256]) {
  char path[64];
  ssize_t n = -1;
  *name = '\0';
  if (opens) {
    snprintf(path, sizeof path, "/proc/%u/mem", q->pid);
    int memory = open(path, O_RDONLY | O_CLOEXEC);
    const off_t at = (off_t)q->data.args[q->data.nr == SYS_openat];
    if (memory >= 0) n = pread(memory, name, 255, at);
    if (memory >= 0) close(memory);
  } else {
    snprintf(path, sizeof path, "/proc/%u/fd/%d", q->pid, (int)q->data.args[0]);
    n = readlink(path, name, 255);
  }
  name[n > 0 ? n : 0] = '\0';
}

/* A message on standard error would not be seen if that failed. The calls of the
 * dynamic linker and of a sanitizer are none of the program's. ngspice 39 crashes, in a
 * handler of its own, where it cannot open the empty .spiceinit that was made for it a moment
 * before; as that file was just closed, a descriptor is free. A pipe is closed whatever close()
 * returns, while a call that fails here is not done at all; so only those of plain files fail. */
static bool counts(const fault *f, const struct seccomp_notif *q) {
  const bool opens = q->data.nr == SYS_open || q->data.nr == SYS_openat;
  char name[256];
  name_file(q, opens, name);
  if (strstr(name, ".so") || !strncmp(name, "/proc/", 6) || !strcmp(name, "/etc/ld.so.cache"))
    return false;
  if (opens && !strcmp(name, ".spiceinit") &&
      !(q->data.args[q->data.nr == SYS_openat ? 2 : 1] & O_CREAT))
    return false;
  if (f->calls[0] == SYS_write && strstr(name, "/stderr")) return false;
  return f->calls[0] != SYS_close || (*name == '/' && strcmp(name, "/dev/null") != 0);
}

static void answer(const fault *f, int listener, unsigned long n, unsigned long *calls) {
  struct seccomp_notif q = {0};
  if (ioctl(listener, SECCOMP_IOCTL_NOTIF_RECV, &q)) return;
  bool fails = counts(f, &q) && ++*calls == n;
  struct seccomp_notif_resp a = {.id = q.id,
                                 .error = fails ? -f->error : 0,
                                 .flags = fails ? 0 : SECCOMP_USER_NOTIF_FLAG_CONTINUE};
  ioctl(listener, SECCOMP_IOCTL_NOTIF_SEND, &a);
}

/* Answers until the program has ended; what it has left behind ends then, too. */
static void attend(const fault *f, pid_t child, int listener, unsigned long n,
                   unsigned long *calls) {
  int end = (int)syscall(SYS_pidfd_open, child, 0);
  struct pollfd polls[] = {{listener, POLLIN, 0}, {end, POLLIN, 0}};
  while (poll(polls, 2, -1) > 0 && !polls[1].revents)
    if (polls[0].revents & POLLIN) answer(f, listener, n, calls);
  close(end);
  close(listener);
}

/* ---- both ---- */

static void write_count(unsigned long n) {
  FILE *f = fopen("../count", "w");
  if (f) fwrite(&n, sizeof n, 1, f);
  if (f) fclose(f);
}

static unsigned long read_count(void) {
  unsigned long n = 0;
  FILE *f = fopen("../count", "r");
  if (f && fread(&n, sizeof n, 1, f) != 1) n = 0;
  if (f) fclose(f);
  return n;
}

ran fault_run(const fault *f, unsigned long n, const char *words, unsigned long *calls) {
  int ends[2] = {-1, -1};
  *calls = 0;
  write_count(0);
  if (f->calls && socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
    return (ran){126, vs_copy(""), vs_copy("no socket")};
  pid_t child = start(f, n, words, ends[1]);
  if (f->calls) {
    close(ends[1]);
    int listener = receive_file(ends[0]);
    if (listener >= 0) attend(f, child, listener, n, calls);
    close(ends[0]);
  }
  ran r = collect(child);
  if (!f->calls) *calls = read_count();
  return r;
}

bool fault_is_possible(const fault *f) {
#ifdef __SANITIZE_ADDRESS__
  if (!f->calls) return false;
#endif
  unsigned long calls;
  ran r = fault_run(f, 0, "--version", &calls);
  bool good = r.status == 0;
  free_ran(&r);
  return good;
}
