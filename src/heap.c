/* SPDX-License-Identifier: GPL-3.0-or-later
 * Memory that is there or ends the process, for the libraries.
 *
 * What this program itself allocates goes through base/alloc.h. The C library, GSL, libfyaml,
 * libzstd and ngspice ask malloc(), and many of their callers within those libraries do not look at
 * what they get: they would crash, or go on without what they wanted. The dynamic linker takes a
 * function of the program before one of the C library's, so that they call these three, which end
 * the process as vs_alloc does. Only the program has them: no library that others link has. A
 * sanitizer brings functions of its own, and then these are left out. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/alloc.h"

#ifndef __has_feature
#define __has_feature(name) 0
#endif

#if !defined __SANITIZE_ADDRESS__ && !__has_feature(address_sanitizer)

/* The C library's own, which are asked as long as the next ones are being looked for. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);

/* The functions that the linker would have taken otherwise. */
static struct {
  void *(*malloc)(size_t);
  void *(*calloc)(size_t, size_t);
  void *(*realloc)(void *, size_t);
} next = {__libc_malloc, __libc_calloc, __libc_realloc};
static int looked;

/* A pointer to data cannot be cast to one to a function in standard C, but it can be copied. */
static void look_for(const char *name, void *function) {
  void *found = dlsym(RTLD_NEXT, name);
  if (found) *(void **)function = found;
}

static void look(void) {
  looked = 1; /* dlsym may ask for memory itself */
  look_for("malloc", &next.malloc);
  look_for("calloc", &next.calloc);
  look_for("realloc", &next.realloc);
}

void *malloc(size_t size) {
  if (!looked) look();
  void *memory = next.malloc(size);
  if (!memory) vs_alloc_failed(size);
  return memory;
}

/* ngspice asks for some nineteen short strings at each step, and gives them back. glibc's calloc()
 * (2.36) does not take what the thread gave back last, as its malloc() does, and the next free() is
 * the slower for that. */
enum { SHORT = 1024 };

void *calloc(size_t count, size_t size) {
  if (!looked) look();
  size_t bytes;
  bool beyond = __builtin_mul_overflow(count, size, &bytes), is_short = !beyond && bytes <= SHORT;
  void *memory = is_short ? next.malloc(bytes) : next.calloc(count, size);
  if (!memory) vs_alloc_failed(beyond ? (size_t)-1 : bytes);
  return is_short ? memset(memory, 0, bytes) : memory;
}

/* With a size of 0 it frees the memory, and NULL is no failure. */
void *realloc(void *memory, size_t size) {
  if (!looked) look();
  void *resized = next.realloc(memory, size);
  if (!resized && size) vs_alloc_failed(size);
  return resized;
}

#endif
