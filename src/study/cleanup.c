/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cleanup.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/compressed.h"
#include "base/csv.h"
#include "base/file.h"
#include "npy.h"
#include "run/table.h"
#include "study/folder.h"
#include "study/format.h"

/* ---- pictures ---- */

/* The columns of which pictures are drawn. */
typedef enum picture_of { AXIS, MEASURE } picture_of;

/* As picture/ names them: by the column, what stands before it, and as many bytes of it. A chart
 * that names its file otherwise has its row here. */
static const struct {
  picture_of of;
  const char *begin;
  int most;
} KINDS[] = {{MEASURE, "", 250}, {MEASURE, "cloud_", 200}, {AXIS, "over_", 200}};
static const char *const NAMES[] = {"report.html", "influence.png", "feasible.png"};

static void remove_pictures_of(int folder, picture_of of, const char *column) {
  for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS; k++) {
    char name[300];
    if (KINDS[k].of != of) continue;
    snprintf(name, sizeof name, "%s%.*s.png", KINDS[k].begin, KINDS[k].most, column);
    for (char *s = name; *s; s++)
      if (*s == '/') *s = '_';
    vs_file_remove(folder, name);
  }
}

static FILE *open_file(int folder, const char *name) {
  int fd = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  return fd < 0 ? NULL : vs_compressed_read(fdopen(fd, "r"), name);
}

/* Returns the name of the file of rows that is there. */
static const char *rows_of(int folder) {
  const vs_format *f = vs_format_all;
  while (f->name && faccessat(folder, f->rows, F_OK, AT_SYMLINK_NOFOLLOW)) f++;
  return f->name ? f->rows : vs_format_all->rows;
}

/* The first line of a file, cut into its cells; none where there is no such file. */
typedef struct header {
  char *line, **cell;
  size_t count;
} header;

static header read_old_header(int folder, const char *name) {
  header h = {0};
  size_t size = 0, most = 1;
  FILE *f = open_file(folder, name);
  bool there = f && vs_alloc_line(&h.line, &size, f) > 0;
  if (f) fclose(f);
  if (!there) {
    free(h.line);
    return (header){0};
  }
  h.line[strcspn(h.line, "\r\n")] = '\0';
  for (const char *s = h.line; *s; s++) most += *s == ',';
  h.cell = vs_alloc(most, sizeof *h.cell);
  h.count = vs_csv_split(h.line, h.cell, most, NULL);
  return h;
}

static void discard_old_header(header *h) {
  free(h->cell);
  free(h->line);
}

/* The axes stand behind case and id, in both files; the measures behind them, up to the least
 * margin. */
static void remove_report(int folder) {
  for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++) vs_file_remove(folder, NAMES[k]);
  header done = read_old_header(folder, rows_of(folder)),
         failed = read_old_header(folder, "failures.csv");
  bool axis = true, measure = failed.count;
  for (size_t k = 2; k < done.count && measure; k++) {
    axis = axis && k < failed.count && !strcmp(done.cell[k], failed.cell[k]);
    remove_pictures_of(folder, axis ? AXIS : MEASURE, done.cell[k]);
    measure = vs_folder_role_of(done.cell[k]) != VS_ROLE_MARGIN;
  }
  discard_old_header(&done);
  discard_old_header(&failed);
}

/* ---- columns ---- */

/* The header row stands in the file of rows; where that is not there, in the journal. */
static void remove_columns(int folder, const vs_journal *old) {
  char *line = NULL;
  size_t size = 0;
  FILE *f = open_file(folder, rows_of(folder));
  bool there = f && vs_alloc_line(&line, &size, f) > 0;
  if (there) line[strcspn(line, "\r\n")] = '\0';
  if (there || old) vs_npy_remove(folder, there ? line : old->head.columns);
  if (f) fclose(f);
  free(line);
}

/* ---- the study's cases ---- */

/* Those that have a row in its files, for a folder without a journal. */
typedef struct cases {
  uint64_t *index;
  size_t count, room;
} cases;

static void add_cases(int folder, const char *name, cases *all) {
  char *line = NULL;
  size_t size = 0;
  FILE *f = open_file(folder, name);
  while (f && vs_alloc_line(&line, &size, f) > 0) {
    if (*line < '0' || *line > '9') continue; /* the header */
    if (all->count == all->room) {
      all->room = all->room ? 2 * all->room : 64;
      all->index = vs_resize(all->index, all->room, sizeof *all->index);
    }
    all->index[all->count++] = strtoull(line, NULL, 10);
  }
  free(line);
  if (f) fclose(f);
}

static int by_index(const void *a, const void *b) {
  const uint64_t *x = a, *y = b;
  return *x < *y ? -1 : *x > *y;
}

static bool had_case(const vs_journal *old, const cases *listed, uint64_t index) {
  if (old) return vs_journal_had(old, index);
  return listed->count &&
         bsearch(&index, listed->index, listed->count, sizeof index, by_index) != NULL;
}

/* ---- kept runs ---- */

static int open_folder(int in, const char *name) {
  return openat(in, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

static bool is_case_number(const char *name) {
  return *name && !name[strspn(name, "0123456789")] && (*name != '0' || !name[1]);
}

static void remove_runs(int folder, const vs_journal *old, const cases *listed) {
  int runs = open_folder(folder, "runs");
  DIR *list = runs < 0 ? NULL : fdopendir(runs);
  for (struct dirent *entry; list && (entry = readdir(list));) {
    if (!is_case_number(entry->d_name)) continue;
    if (!had_case(old, listed, strtoull(entry->d_name, NULL, 10))) continue;
    int run = open_folder(runs, entry->d_name);
    if (run < 0) continue;
    vs_file_remove(run, "run.csv");
    vs_file_remove(run, VS_TABLE_PEAKS_FILE);
    close(run);
    unlinkat(runs, entry->d_name, AT_REMOVEDIR); /* if it is empty */
  }
  if (list) closedir(list);
  unlinkat(folder, "runs", AT_REMOVEDIR);
}

void vs_cleanup_folder(const char *path, const vs_journal *old) {
  cases listed = {0};
  int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  if (!old) add_cases(folder, rows_of(folder), &listed);
  if (!old) add_cases(folder, "failures.csv", &listed);
  if (listed.count) qsort(listed.index, listed.count, sizeof *listed.index, by_index);
  remove_report(folder);
  remove_columns(folder, old);
  remove_runs(folder, old, &listed);
  free(listed.index);
  close(folder);
}
