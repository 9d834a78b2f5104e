/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/stale.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/text.h"
#include "work/case.h"

static void remove_file(int folder, const char *name) {
  struct stat s;
  if (!fstatat(folder, name, &s, AT_SYMLINK_NOFOLLOW) && S_ISREG(s.st_mode))
    unlinkat(folder, name, 0);
}

/* ---- pictures ---- */

/* As report/ names them: by the column, what there may be before it, and as many bytes of it. */
static void remove_pictures_of(int folder, const char *column) {
  static const struct {
    const char *begin;
    int most;
  } KINDS[] = {{"", 250}, {"cloud_", 200}, {"over_", 200}};
  for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS; k++) {
    char name[300];
    snprintf(name, sizeof name, "%s%.*s.png", KINDS[k].begin, KINDS[k].most, column);
    for (char *s = name; *s; s++)
      if (*s == '/') *s = '_';
    remove_file(folder, name);
  }
}

/* The first line of its study.csv, without its end; NULL: there is none. free() it. */
static char *read_header(int folder) {
  char *line = NULL;
  size_t size = 0;
  int fd = openat(folder, "study.csv", O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  FILE *f = fd < 0 ? NULL : fdopen(fd, "r");
  bool there = f && getline(&line, &size, f) > 0;
  if (f) fclose(f);
  if (there) line[strcspn(line, "\r\n")] = '\0';
  if (!there) free(line);
  return there ? line : NULL;
}

static void remove_report(int folder) {
  static const char *const NAMES[] = {"report.html", "influence.png", "feasible.png"};
  for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++) remove_file(folder, NAMES[k]);
  char *header = read_header(folder);
  if (!header) return;
  size_t most = 1;
  for (const char *s = header; *s; s++) most += *s == ',';
  char **column = vs_alloc(most, sizeof *column);
  size_t n = vs_csv_split(header, column, most, NULL);
  for (size_t k = 0; k < n; k++) remove_pictures_of(folder, column[k]);
  free(column);
  free(header);
}

/* ---- kept runs ---- */

static int open_folder(int in, const char *name) {
  return openat(in, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

static bool is_number(const char *name) {
  return *name && !name[strspn(name, "0123456789")];
}

static void remove_runs(int folder) {
  int runs = open_folder(folder, "runs");
  DIR *list = runs < 0 ? NULL : fdopendir(runs);
  for (struct dirent *entry; list && (entry = readdir(list));) {
    int run = is_number(entry->d_name) ? open_folder(runs, entry->d_name) : -1;
    if (run < 0) continue;
    remove_file(run, "run.csv");
    close(run);
    unlinkat(runs, entry->d_name, AT_REMOVEDIR); /* if it is empty */
  }
  if (list) closedir(list);
  unlinkat(folder, "runs", AT_REMOVEDIR);
}

void vs_stale_remove(const char *path) {
  int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  remove_report(folder);
  remove_runs(folder);
  close(folder);
}
