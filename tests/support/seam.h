/* SPDX-License-Identifier: GPL-3.0-or-later
 * The built program, stopped at each of some system calls: a filter of seccomp in the kernel asks
 * the test what is to come of the call. The filter is inherited, so that the calls of all processes
 * are seen, and those within the C library, too. */
#pragma once

#include "program.h"

/* A process stands at a call, which is not done yet. */
typedef struct seam_call {
  pid_t first;   /* the program's first process */
  pid_t process; /* the one that calls */
  long number;   /* SYS_... */
  bool creates;  /* an open that may make the file */
  /* the file that is open under its first argument, or that it names; else "" */
  char name[VS_PATH_SIZE];
} seam_call;

typedef struct seam {
  const long *calls; /* their numbers, up to -1 */
  /* 0: the call is done; else the errno with which it fails. It may also take its time, or end the
   * process. */
  int (*answer)(void *ctx, const seam_call *call);
  void *ctx;
} seam;

/* True for a call about a shared object, which is the dynamic linker's own, not the program's. */
bool seam_is_library(const seam_call *call);

/* Newer machines lack the older calls. */
#include <sys/syscall.h>
#ifndef SYS_open
#define SYS_open SYS_openat
#define SYS_rename SYS_renameat2
#define SYS_renameat SYS_renameat2
#define SYS_fork SYS_clone
#define SYS_vfork SYS_clone
#define SYS_pipe SYS_pipe2
#define SYS_mkdir SYS_mkdirat
#define SYS_unlink SYS_unlinkat
#endif

/* Runs the program to its end, as run() does. Status 126: this machine has no such filter. */
ran seam_run(const seam *s, const char *words);

/* True where seam_run can be had: a container may forbid it. */
bool seam_is_possible(void);
