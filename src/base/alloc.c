/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/alloc.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/shutdown.h"

void vs_alloc_failed(size_t bytes) {
  char text[96];
  int n = bytes
              ? snprintf(text, sizeof text, "vibrospice: out of memory: %zu bytes wanted\n", bytes)
              : snprintf(text, sizeof text, "vibrospice: out of memory\n");
  vs_shutdown_now(VS_RUN, VS_ALLOC_STATUS, text, (size_t)n);
}

/* The product; one too large for a size_t is more than there ever is. */
static size_t product(uint64_t count, size_t size) {
  size_t bytes;
  return __builtin_mul_overflow(count, size, &bytes) ? SIZE_MAX : bytes;
}

void *vs_alloc(size_t count, size_t size) {
  void *memory = calloc(count ? count : 1, size ? size : 1);
  if (!memory) vs_alloc_failed(product(count, size));
  return memory;
}

void *vs_resize(void *memory, uint64_t count, size_t size) {
  const size_t bytes = product(count, size);
  void *resized = bytes < SIZE_MAX ? realloc(memory, bytes ? bytes : 1) : NULL;
  if (!resized) vs_alloc_failed(bytes);
  return resized;
}

void *vs_alloc_grow(void *list, size_t count, size_t size) {
  bool full = (count & (count - 1)) == 0; /* 0 or a power of two: what it has room for */
  return full ? vs_resize(list, count ? 2 * count : 1, size) : list;
}

char *vs_copy(const char *string) {
  char *copy = strdup(string);
  if (!copy) vs_alloc_failed(strlen(string) + 1);
  return copy;
}

void *vs_checked(void *memory) {
  if (!memory) vs_alloc_failed(0);
  return memory;
}

FILE *vs_alloc_stream(char **text, size_t *size) {
  return vs_checked(open_memstream(text, size));
}

void vs_alloc_stream_close(FILE *stream) {
  if (fclose(stream)) vs_alloc_failed(0);
}

char *vs_alloc_part(const char *string, size_t length) {
  char *copy = strndup(string, length);
  if (!copy) vs_alloc_failed(strnlen(string, length) + 1);
  return copy;
}

ssize_t vs_alloc_row(char **line, size_t *size, size_t most, FILE *file) {
  size_t n = 0;
  int c = 0;
  errno = 0;
  while (c != '\n' && (c = getc_unlocked(file)) != EOF) {
    if (n == most) {
      errno = EFBIG;
      return -1;
    }
    if (!*line || n + 2 > *size) {
      *size = *line && *size > 60 ? 2 * *size : 120;
      *line = vs_resize(*line, *size, 1);
    }
    (*line)[n++] = (char)c;
  }
  if (!n) return -1;
  (*line)[n] = '\0';
  return (ssize_t)n;
}

ssize_t vs_alloc_line(char **line, size_t *size, FILE *file) {
  enum { LONGEST = 1 << 26 }; /* a study's journal has its manifest in two lines */
  return vs_alloc_row(line, size, LONGEST, file);
}
