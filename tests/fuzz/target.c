/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "target.h"

#include <dirent.h>
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"

/* ---- files ---- */

static char folder[VS_PATH_SIZE];
static pid_t owner;

static void remove_folder(void) {
  DIR *all = getpid() == owner ? opendir(folder) : NULL;
  for (struct dirent *e; all && (e = readdir(all));)
    if (strcmp(e->d_name, ".") && strcmp(e->d_name, "..")) unlinkat(dirfd(all), e->d_name, 0);
  if (!all) return;
  closedir(all);
  rmdir(folder);
}

const char *fuzz_folder(void) {
  if (*folder) return folder;
  const char *tmp = getenv("TMPDIR");
  if (!tmp) tmp = access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm";
  snprintf(folder, sizeof folder, "%s/vibrospice-fuzz.XXXXXX", tmp);
  if (!mkdtemp(folder)) {
    perror(folder);
    exit(1);
  }
  owner = getpid();
  atexit(remove_folder);
  return folder;
}

void fuzz_write(const char *name, const char *text, size_t size, char path[VS_PATH_SIZE]) {
  snprintf(path, VS_PATH_SIZE, "%.4000s/%.60s", fuzz_folder(), name);
  int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0 || write(file, text, size) != (ssize_t)size || close(file)) {
    perror(path);
    exit(1);
  }
}

/* The one of the names that the line "%%% NAME" has; -1: it is no such line. */
static int named(const char *line, size_t length, const char *const *names) {
  if (length < 5 || strncmp(line, "%%% ", 4) != 0) return -1;
  for (int k = 0; names[k]; k++)
    if (strlen(names[k]) == length - 4 && !strncmp(line + 4, names[k], length - 4)) return k;
  return -1;
}

void fuzz_write_all(const char *text, size_t size, const char *first, const char *const *others,
                    char path[VS_PATH_SIZE]) {
  char other[VS_PATH_SIZE];
  const char *end = text + size, *begin = text, *name = first;
  for (int k = 0; others[k]; k++) {
    snprintf(other, sizeof other, "%.4000s/%.60s", fuzz_folder(), others[k]);
    unlink(other);
  }
  for (const char *line = text; line <= end;) {
    const char *stop = line < end ? memchr(line, '\n', (size_t)(end - line)) : NULL;
    size_t length = (size_t)((stop ? stop : end) - line);
    int next = named(line, length, others);
    if (next >= 0 || !stop) {
      const char *until = next >= 0 ? line : end;
      fuzz_write(name, begin, (size_t)(until - begin), name == first ? path : other);
    }
    if (!stop) {
      if (next >= 0) fuzz_write(others[next], "", 0, other);
      return;
    }
    line = stop + 1;
    if (next >= 0) name = others[next], begin = line;
  }
}

/* ---- what a reader returns ---- */

_Noreturn void fuzz_broken(const char *file, int line, const char *what) {
  fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, what);
  abort();
}

static void judge(const vs_error *err) {
  FUZZ_HOLDS(*err->text);
  FUZZ_HOLDS(strlen(err->text) < sizeof err->text && !strchr(err->text, '\n'));
  FUZZ_HOLDS(err->place_size >= err->file_size && (size_t)err->place_size <= strlen(err->text));
  if (!err->line && getenv("VS_FUZZ_PLACES")) fprintf(stderr, "no place: %s\n", err->text);
}

void fuzz_judge(vs_status status, const vs_error *err) {
  FUZZ_HOLDS(status == VS_OK || status == VS_INPUT);
  if (status) judge(err);
  for (size_t k = 0; err->findings && k < err->findings->count; k++) judge(&err->findings->item[k]);
}

/* Most texts are wrong, and every second of them is enough for `check`. */
void fuzz_read(vs_status (*read)(const char *path, vs_findings *all), const char *path,
               size_t size) {
  static vs_findings all;
  all.count = 0;
  if (read(path, NULL) && size % 2) read(path, &all);
}

void fuzz_begin(void) {
  setenv("VIBROSPICE_PATH", VS_FUZZ_LIBRARY, 1);
  gsl_set_error_handler_off(); /* as main() does */
}

void fuzz_take(const fuzz_target *target, const uint8_t *bytes, size_t size) {
  char *text = vs_alloc(size + 1, 1); /* so that a sanitizer sees who reads beyond its end */
  if (size) memcpy(text, bytes, size);
  target->take(text, size);
  free(text);
}
