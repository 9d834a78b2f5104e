/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "work/lines.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"

/* ---- all of them ---- */

vs_status vs_lines_each(const vs_lines *file, vs_lines_visit visit, void *ctx, vs_lines_seen *seen,
                        vs_error *err) {
  enum { AT_ONCE = 1 << 16 };
  *seen = (vs_lines_seen){0};
  int copy = dup(file->fd);
  FILE *f = copy < 0 ? NULL : fdopen(copy, "r");
  if (!f) return vs_fail(err, VS_RUN, "%s: cannot be read: %s", file->path, strerror(errno));
  char *text = NULL;
  size_t size = 0;
  ssize_t n;
  uint64_t at = 0;
  bool enough = false;
  vs_status status = VS_OK;
  rewind(f);
  char *room = vs_alloc(1, AT_ONCE);
  setvbuf(f, room, _IOFBF, AT_ONCE);
  while (!status && !enough && (n = vs_alloc_line(&text, &size, f)) > 0) {
    seen->count++;
    seen->torn = text[n - 1] != '\n';
    if (!seen->torn) {
      text[n - 1] = '\0';
      status = visit(ctx, &(vs_lines_entry){text, (size_t)n - 1, at, seen->count}, &enough, err);
      seen->end = at + (uint64_t)n;
    }
    at += (uint64_t)n;
  }
  if (!status) status = vs_file_was_read(f, file->path, err);
  free(text);
  fclose(f);
  free(room);
  return status;
}

/* ---- one of them ---- */

/* Rows are mostly asked for in the order in which they stand in the file. A merge has one part for
 * each shard. */
enum { PART = 4096 };
struct vs_lines_part {
  uint64_t at; /* of its first byte in the file */
  size_t size;
  char bytes[PART];
};

vs_lines_part *vs_lines_part_new(void) {
  return vs_alloc(1, sizeof(vs_lines_part));
}

void vs_lines_forget(vs_lines_part *part) {
  part->size = 0;
}

/* Reads the part from byte `at` on. Behind the file's end it is empty. */
static vs_status read_part(const vs_lines *file, uint64_t at, vs_error *err) {
  vs_lines_part *p = file->part;
  ssize_t n;
  do n = pread(file->fd, p->bytes, sizeof p->bytes, (off_t)at);
  while (n < 0 && errno == EINTR);
  p->at = at;
  p->size = n > 0 ? (size_t)n : 0;
  return n < 0 ? vs_fail(err, VS_RUN, "%s: cannot be read: %s", file->path, strerror(errno))
               : VS_OK;
}

vs_status vs_lines_read(const vs_lines *file, uint64_t at, vs_text *text, size_t *length,
                        vs_error *err) {
  const vs_lines_part *p = file->part;
  text->length = *length = 0;
  for (bool ended = false; !ended;) {
    vs_status status = VS_OK;
    if (at < p->at || at >= p->at + p->size) status = read_part(file, at, err);
    if (status) return status;
    const char *from = p->bytes + (at - p->at);
    const size_t left = p->size - (size_t)(at - p->at);
    const char *end = memchr(from, '\n', left);
    const size_t n = end ? (size_t)(end - from) : left;
    vs_text_add(text, "%.*s", (int)n, from);
    *length += n;
    at += n;
    ended = end || !left;
  }
  return VS_OK;
}
