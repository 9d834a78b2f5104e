/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "age.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "base/hash.h"

void wait_seconds(double s) {
  struct timespec t = {(time_t)s, (long)(1e9 * fmod(s, 1))};
  nanosleep(&t, NULL);
}

bool file_says(const char *path, const char *text) {
  char *all = read_file(path);
  const bool says = strstr(all, text);
  free(all);
  return says;
}

pid_t begin(const char *words) {
  return spawn_prepared(words, NULL, NULL);
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

static int by_text(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Cuts the text up into its whole lines, in alphabetical order, and a NULL behind them; free() the
 * list. */
static char **sorted_lines(char *text) {
  const size_t count = (size_t)count_lines(text);
  char **lines = vs_alloc(count + 1, sizeof *lines);
  for (size_t k = 0; k < count; k++) lines[k] = strsep(&text, "\n");
  qsort(lines, count, sizeof *lines, by_text);
  return lines;
}

int lines_lost(const char *before, const char *after) {
  char *text = vs_copy(before), *other_text = vs_copy(after);
  char **lines = sorted_lines(text), **others = sorted_lines(other_text), **other = others;
  int lost = 0;
  for (char **line = lines; *line; line++) {
    while (*other && strcmp(*other, *line) < 0) other++;
    if (*other && !strcmp(*other, *line))
      other++;
    else
      lost++;
  }
  free(lines), free(others);
  free(text), free(other_text);
  return lost;
}
