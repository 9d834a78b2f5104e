/* SPDX-License-Identifier: GPL-3.0-or-later
 * A shared object for LD_PRELOAD, with which the n-th request for memory fails. What it reads from
 * the environment:
 *
 *   VS_FAULT_COUNT   a file of 8 bytes, in which requests are counted, those of all processes that
 *                    the first one starts together
 *   VS_FAULT_AT      n, from 1; 0: none fails
 *   VS_FAULT_LASTS   if set: those after the n-th fail, too
 *   VS_FAULT_CHILDREN if set: only requests of forked children count
 *
 * Counting begins when this object's constructor has run. */
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static _Atomic unsigned long *count;
static unsigned long at;
static bool lasts;
static pid_t spared; /* the process whose requests do not count */

__attribute__((constructor)) static void begin(void) {
  const char *file = getenv("VS_FAULT_COUNT"), *n = getenv("VS_FAULT_AT");
  int fd = file ? open(file, O_RDWR | O_CLOEXEC) : -1;
  if (fd < 0) return;
  void *shared = mmap(NULL, sizeof *count, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  close(fd);
  at = n ? strtoul(n, NULL, 10) : 0;
  lasts = getenv("VS_FAULT_LASTS");
  spared = getenv("VS_FAULT_CHILDREN") ? getpid() : 0;
  if (shared != MAP_FAILED) count = shared;
}

static bool fails(void) {
  if (!count || (spared && getpid() == spared)) return false;
  unsigned long n = ++*count;
  bool now = at && (n == at || (lasts && n > at));
  if (now) errno = ENOMEM;
  return now;
}

void *malloc(size_t size) {
  return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t number, size_t size) {
  return fails() ? NULL : __libc_calloc(number, size);
}

void *realloc(void *memory, size_t size) {
  return fails() ? NULL : __libc_realloc(memory, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
  return fails() ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size) {
  *memory = fails() ? NULL : __libc_memalign(alignment, size);
  return *memory ? 0 : ENOMEM;
}
