/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "age.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "base/hash.h"

double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void wait_seconds(double s) {
  struct timespec t = {(time_t)s, (long)(1e9 * fmod(s, 1))};
  nanosleep(&t, NULL);
}

pid_t begin(const char *words) {
  char copy[1024];
  const char *argv[MOST_WORDS];
  snprintf(copy, sizeof copy, "%s", words);
  split(copy, argv);
  return spawn(argv);
}

size_t children_of(pid_t parent, pid_t *found, size_t most) {
  char path[64], text[512] = "", *rest = text;
  size_t n = 0;
  snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)parent, (int)parent);
  FILE *f = fopen(path, "r");
  if (!f || !fgets(text, sizeof text, f)) *text = '\0';
  if (f) fclose(f);
  for (char *word; n < most && (word = strsep(&rest, " "));)
    if (*word) found[n++] = (pid_t)atoi(word);
  return n;
}

/* ---- files ---- */

typedef void (*visit)(vs_text *to, const char *path, const char *shown);

static void each_file(vs_text *to, const char *folder, const char *shown, visit show) {
  char *names = listing(folder), *rest = names, path[1024], below[1024];
  for (char *name; (name = strsep(&rest, " "));) {
    struct stat s;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    snprintf(below, sizeof below, "%s/%s", shown, name);
    if (!*name || stat(path, &s)) continue;
    if (S_ISDIR(s.st_mode))
      each_file(to, path, below, show);
    else
      show(to, path, below);
  }
  free(names);
}

static bool is_journal(const char *path) {
  return !strcmp(strrchr(path, '/'), "/journal");
}

static void add_sum(vs_text *to, const char *path, const char *shown) {
  struct stat s;
  FILE *f = is_journal(path) ? NULL : fopen(path, "rb");
  if (!f || fstat(fileno(f), &s)) return;
  char *bytes = vs_alloc((size_t)s.st_size + 1, 1);
  const size_t n = fread(bytes, 1, (size_t)s.st_size, f);
  vs_text_add(to, "%s %zu %08x\n", shown, n, vs_hash_crc32(bytes, n));
  free(bytes);
  fclose(f);
}

static void add_rows(vs_text *to, const char *path, const char *shown) {
  (void)shown;
  if (!is_journal(path)) return;
  char *text = read_file(path), *end = strrchr(text, '\n');
  if (end) vs_text_add(to, "%.*s", (int)(end + 1 - text), text);
  free(text);
}

static char *collect_files(const char *folder, visit show) {
  vs_text all = {0};
  vs_text_add(&all, "%s", "");
  each_file(&all, folder, "", show);
  return all.text;
}

char *tree_of(const char *folder) {
  return collect_files(folder, add_sum);
}

char *rows_of(const char *folder) {
  return collect_files(folder, add_rows);
}

int lines_lost(const char *before, const char *after) {
  char *copy = vs_copy(before), *rest = copy;
  int lost = 0;
  for (char *line; (line = strsep(&rest, "\n")) && rest;) lost += !strstr(after, line);
  free(copy);
  return lost;
}
