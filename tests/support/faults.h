/* SPDX-License-Identifier: GPL-3.0-or-later
 * The built program with one call of its own failing: a request for memory, or a system call. */
#pragma once

#include "program.h"

/* What fails, and how. */
typedef struct fault {
  const char *name;
  int error;         /* errno of a system call that fails */
  const long *calls; /* numbers of the system calls, up to -1; NULL: requests for memory fail */
  bool lasts;        /* of memory: the later ones fail, too */
  bool workers;      /* of memory: in child processes alone */
} fault;

/* Ends with a row without a name. */
extern const fault fault_all[];
/* Every request for memory of a child process fails from the n-th on. */
extern const fault fault_of_workers;

/* True where this machine and this build can have it: a sanitizer has a malloc of its own, and a
 * container may forbid seccomp. */
bool fault_is_possible(const fault *f);

/* Runs the program to its end, as run() does, while the n-th call of that kind fails; 0: none.
 * Calls are counted over the program and all processes that it starts. *calls is how many there
 * were. */
ran fault_run(const fault *f, unsigned long n, const char *words, unsigned long *calls);
