/* SPDX-License-Identifier: GPL-3.0-or-later
 * Requests for memory fail in a shared object that is loaded before the others (tests/faults).
 * System calls fail at the seam (seam.h). */
#include "faults.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "seam.h"

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

/* ---- system calls ---- */

/* A message on standard error would not be seen if that failed. The calls of the
 * dynamic linker and of a sanitizer are none of the program's. ngspice 39 crashes, in a
 * handler of its own, where it cannot open the empty .spiceinit that was made for it a moment
 * before; as that file was just closed, a descriptor is free. A pipe is closed whatever close()
 * returns, while a call that fails here is not done at all; so only those of plain files fail. */
static bool counts(const fault *f, const seam_call *call) {
  const char *name = call->name;
  const bool opens = call->number == SYS_open || call->number == SYS_openat;
  if (seam_is_library(call) || !strncmp(name, "/proc/", 6)) return false;
  if (opens && !strcmp(name, ".spiceinit") && !call->creates) return false;
  if (f->calls[0] == SYS_write && strstr(name, "/stderr")) return false;
  return f->calls[0] != SYS_close || (*name == '/' && strcmp(name, "/dev/null") != 0);
}

/* Which call of a kind fails. */
typedef struct turn {
  const fault *f;
  unsigned long n, calls;
} turn;

static int fail_one(void *ctx, const seam_call *call) {
  turn *t = ctx;
  return counts(t->f, call) && ++t->calls == t->n ? t->f->error : 0;
}

/* ---- requests for memory ---- */

static void fail_requests(void *ctx) {
  enum { MOST_SECONDS = 60 }; /* a fault may make the program hang */
  const turn *t = ctx;
  const fault *f = t->f;
  char number[32];
  snprintf(number, sizeof number, "%lu", t->n);
  alarm(MOST_SECONDS);
  setenv("LD_PRELOAD", VS_FAULTS, 1);
  setenv("VS_FAULT_COUNT", "../count", 1);
  setenv("VS_FAULT_AT", number, 1);
  if (f->lasts) setenv("VS_FAULT_LASTS", "1", 1);
  if (f->workers) setenv("VS_FAULT_CHILDREN", "1", 1);
}

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
  turn t = {f, n, 0};
  ran r;
  if (f->calls) {
    const seam s = {f->calls, fail_one, &t};
    r = seam_run(&s, words);
    *calls = t.calls;
    return r;
  }
  write_count(0);
  r = collect(spawn_prepared(words, fail_requests, &t));
  *calls = read_count();
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
