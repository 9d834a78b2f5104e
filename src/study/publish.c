/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "publish.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/compressed.h"
#include "base/file.h"
#include "base/path.h"
#include "npy.h"
#include "workers/row_shape.h"

static const char FAILURES[] = "failures.csv", MANIFEST[] = "manifest.json";
const char *const vs_publish_files[VS_PUBLISH_FILES] = {MANIFEST, "study.csv", FAILURES};

/* ---- what is there ---- */

static bool is_result_there(const char *folder, const char *name) {
  char path[VS_PATH_SIZE + 32];
  struct stat s;
  snprintf(path, sizeof path, "%.4000s/%s", folder, name);
  return !lstat(path, &s);
}

static void remove_file(const char *folder, const char *name) {
  char path[VS_PATH_SIZE + 32];
  snprintf(path, sizeof path, "%.4000s/%s", folder, name);
  unlink(path);
}

const char *vs_publish_found(const char *folder) {
  for (size_t k = 0; k < VS_PUBLISH_FILES; k++)
    if (is_result_there(folder, vs_publish_files[k])) return vs_publish_files[k];
  for (const vs_format *f = vs_format_all; f->name; f++)
    if (is_result_there(folder, f->rows)) return f->rows;
  return is_result_there(folder, VS_ARRAY_LIST) ? VS_ARRAY_LIST : NULL;
}

void vs_publish_remove(const char *folder) {
  for (const vs_format *f = vs_format_all; f->name; f++) remove_file(folder, f->rows);
  remove_file(folder, FAILURES);
  remove_file(folder, MANIFEST);
}

vs_status vs_publish_check(const char *folder, const vs_format *format, vs_error *err) {
  char path[VS_PATH_SIZE + 16];
  struct stat s;
  snprintf(path, sizeof path, "%.4000s/" VS_ARRAY_FOLDER, folder);
  if (!format->columns || lstat(path, &s) || S_ISDIR(s.st_mode)) return VS_OK;
  return vs_fail(err, VS_INPUT,
                 "%s: is no folder; --format %s writes the columns into a folder of that name; "
                 "remove it, or take another DIR",
                 path, format->name);
}

/* ---- writing ---- */

/* A result under way. Its members are in the order in which they are committed. */
typedef struct result {
  vs_file study, failures, manifest;
  FILE *rows;       /* what packs into `study`, or its stream; NULL: it has ended */
  vs_npy *columns;  /* NULL: none are written */
  uint64_t lacking; /* cases of which a warning says that something is not built */
  vs_text first;    /* the first of them, with its warning */
} result;

/* Takes one row, which may be cut up. */
typedef vs_status (*visit)(result *r, bool failed, char *row, vs_error *err);

static vs_status each_row(const vs_journals *all, visit take, result *r, vs_error *err) {
  vs_text row = {0};
  vs_status status = VS_OK;
  for (uint64_t k = 0; k < all->cases && !status; k++) {
    const vs_journal *j = &all->item[all->count > 1 ? k % all->count : 0];
    bool failed;
    if (!vs_journal_had(j, k)) continue;
    status = vs_journal_row(j, k, &row, &failed, err);
    if (!status) status = take(r, failed, row.text, err);
  }
  vs_text_free(&row);
  return status;
}

/* The next line of the file that is read must be this row, as far as it belongs there. */
static vs_status meet_row(result *r, bool failed, char *row, vs_error *err) {
  (void)err;
  char *line = NULL;
  size_t size = 0;
  bool same = failed;
  if (!failed) {
    const ssize_t n = vs_alloc_line(&line, &size, r->rows);
    same = n > 0 && !strncmp(line, row, (size_t)n - 1) && !row[n - 1] && line[n - 1] == '\n';
  }
  free(line);
  return same ? VS_OK : VS_INPUT;
}

/* True if the file has these journals' rows and no others. */
static bool has_rows(const vs_journals *all, const char *folder, const char *name) {
  char path[VS_PATH_SIZE + 32];
  vs_error none = {0};
  snprintf(path, sizeof path, "%.4000s/%s", folder, name);
  if (vs_path_check_result(path, &none)) return false;
  result r = {.rows = vs_compressed_read(fopen(path, "r"), name)};
  if (!r.rows) return false;
  const bool same = !meet_row(&r, false, all->item[0].head.columns, &none) &&
                    !each_row(all, meet_row, &r, &none) && getc(r.rows) == EOF;
  fclose(r.rows);
  return same;
}

bool vs_publish_was_begun(const vs_journals *all, const char *folder) {
  bool found = false;
  if (is_result_there(folder, MANIFEST)) return false;
  for (const vs_format *f = vs_format_all; f->name; f++) {
    if (!is_result_there(folder, f->rows)) continue;
    if (!has_rows(all, folder, f->rows)) return false;
    found = true;
  }
  return found;
}

/* Shows the row to the columns that may be words or numbers (vs_npy_must_look). */
static vs_status look_at_row(result *r, bool failed, char *row, vs_error *err) {
  (void)err;
  if (!failed) vs_npy_look(r->columns, row);
  return VS_OK;
}

/* Writes the row into its file, as the journal has it. */
static vs_status publish_row(result *r, bool failed, char *row, vs_error *err) {
  fprintf(failed ? r->failures.stream : r->rows, "%s\n", row);
  return failed || !r->columns ? VS_OK : vs_npy_add(r->columns, row, err);
}

static vs_status open_columns(result *r, const vs_journals *all, const vs_row_shape *shape,
                              const char *folder, vs_error *err) {
  const uint64_t done = vs_publish_count(all).done;
  vs_status status = VS_OK;
  r->columns = vs_npy_new(shape);
  if (vs_npy_must_look(r->columns)) status = each_row(all, look_at_row, r, err);
  return status ? status : vs_npy_open(r->columns, folder, done, err);
}

static vs_status write_rows(result *r, const vs_journals *all, const char *name, vs_error *err) {
  const vs_journal_head *head = &all->item[0].head;
  fprintf(r->rows, "%s\n", head->columns);
  fprintf(r->failures.stream, "%s\n", head->failures);
  vs_status status = each_row(all, publish_row, r, err);
  FILE *rows = r->rows;
  r->rows = NULL;
  vs_error second = {0};
  const vs_status ended = vs_compressed_end(rows, r->study.stream, name, status ? &second : err);
  return status ? status : ended;
}

/* A search knows how many cases it has only at its end: rows beyond them would be counted, and
 * stand in no file. */
static vs_status check_count(const vs_journals *all, vs_error *err) {
  for (uint64_t k = 0; k < all->count; k++) {
    const vs_journal *j = &all->item[k];
    const uint64_t own = (all->cases + j->head.shards - j->head.shard) / j->head.shards;
    if (j->done + j->failed != own)
      return vs_fail_at(err, (vs_where){j->path, 1, 1},
                        "has rows of %llu cases, and the study %llu; this record is of another "
                        "study, or was changed",
                        (unsigned long long)(j->done + j->failed), (unsigned long long)own);
  }
  return VS_OK;
}

vs_journal_head_counts vs_publish_count(const vs_journals *all) {
  vs_journal_head_counts counts = {.cases = all->cases};
  for (uint64_t k = 0; k < all->count; k++) {
    counts.done += all->item[k].done;
    counts.failed += all->item[k].failed;
    counts.violated += all->item[k].violated;
  }
  return counts;
}

static vs_status commit_result(result *r, const vs_journals *all, vs_error *err) {
  vs_text text = {0};
  const vs_journal_head_counts counts = vs_publish_count(all);
  vs_journal_head_manifest(&all->item[0].head, &counts, all->count > 1, all->more, &text);
  fprintf(r->manifest.stream, "%s\n", text.text);
  vs_text_free(&text);
  vs_status status = vs_file_commit(&r->study, err);
  if (!status && r->columns) status = vs_npy_commit(r->columns, err);
  if (!status) status = vs_file_commit(&r->failures, err);
  return status ? status : vs_file_commit(&r->manifest, err);
}

/* Removes what other formats than this one have left of the same study. */
static void remove_others(const vs_journal_head *head, const vs_format *format,
                          const char *folder) {
  for (const vs_format *f = vs_format_all; f->name; f++)
    if (strcmp(f->rows, format->rows)) remove_file(folder, f->rows);
  int fd = format->columns ? -1 : open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  vs_npy_remove(fd, head->columns);
  close(fd);
}

vs_status vs_publish_write(const vs_journals *all, const vs_format *format, const char *folder,
                           vs_error *err) {
  result r = {0};
  const vs_journal_head *head = &all->item[0].head;
  vs_row_shape *shape = vs_row_shape_new(head->columns, head->failures, head->manifest_end);
  /* All files are written under other names, and get their own at the end, the manifest last: a
   * folder with a manifest is whole. */
  vs_status status = check_count(all, err);
  if (!status) status = vs_publish_check(folder, format, err);
  if (!status) status = vs_file_open(&r.study, folder, format->rows, err);
  if (!status) status = vs_file_open(&r.failures, folder, FAILURES, err);
  if (!status) status = vs_file_open(&r.manifest, folder, MANIFEST, err);
  if (!status && format->columns) status = open_columns(&r, all, shape, folder, err);
  if (!status) {
    r.rows = vs_compressed_write(r.study.stream, format->rows);
    status = write_rows(&r, all, r.study.path, err);
  }
  if (!status) status = commit_result(&r, all, err);
  if (!status) remove_others(head, format, folder);
  vs_npy_free(r.columns);
  vs_row_shape_free(shape);
  vs_file_discard(&r.study);
  vs_file_discard(&r.failures);
  vs_file_discard(&r.manifest);
  return status;
}

/* Counts a row with such a warning, which stands in its cell in quotes, between others. */
static vs_status look_for_unbuilt(result *r, bool failed, char *row, vs_error *err) {
  (void)err;
  char *at = failed ? NULL : strstr(row, "it is not built");
  if (!at || r->lacking++) return VS_OK;
  const char *end = at + strcspn(at, "\"|");
  while (at > row && !strchr("\"|", at[-1])) at--;
  at += strspn(at, " ");
  while (end > at && end[-1] == ' ') end--;
  vs_text_add(&r->first, "case %.*s: %.*s", (int)strcspn(row, ","), row, (int)(end - at), at);
  return VS_OK;
}

void vs_publish_warn(const vs_journals *all) {
  result r = {0};
  vs_error none = {0};
  const vs_journal_head_counts counts = vs_publish_count(all);
  if (!each_row(all, look_for_unbuilt, &r, &none) && r.lacking)
    fprintf(stderr,
            "vibrospice: warning: %llu of %llu cases ran without something of their scene, as "
            "%s (column warnings)\n",
            (unsigned long long)r.lacking, (unsigned long long)(counts.done + counts.failed),
            r.first.text);
  vs_text_free(&r.first);
}

vs_status vs_publish_show(const char *folder, const char *name, bool header, FILE *out,
                          vs_error *err) {
  char path[VS_PATH_SIZE + 16], *line = NULL;
  size_t size = 0;
  snprintf(path, sizeof path, "%.4000s/%s", folder, name);
  FILE *f = fopen(path, "r");
  if (!f) return vs_fail(err, VS_RUN, "%s: cannot be opened: %s", path, strerror(errno));
  for (bool first = true; vs_alloc_line(&line, &size, f) > 0; first = false)
    if (header || !first) fputs(line, out);
  vs_status status = vs_file_was_read(f, path, err);
  free(line);
  fclose(f);
  return status;
}
