/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/journal.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "plan/plan.h"

static const char NAME[] = "journal";
/* ---- the manifest ---- */

void vs_journal_manifest(const vs_journals *all, vs_text *text) {
  const vs_head *head = &all->item[0].head;
  uint64_t done = 0, failed = 0, violated = 0;
  for (uint64_t k = 0; k < all->count; k++) {
    done += all->item[k].done;
    failed += all->item[k].failed;
    violated += all->item[k].violated;
  }
  vs_text_add(text, "%s", head->manifest_begin);
  vs_json json = vs_json_inside(text);
  vs_json_whole(&json, "cases", (int64_t)all->cases);
  vs_json_whole(&json, "done", (int64_t)done);
  vs_json_whole(&json, "failed", (int64_t)failed);
  vs_json_whole(&json, "violated", (int64_t)violated);
  vs_text_add(text, "%s%s", head->manifest_end, all->more ? all->more : "");
  vs_json_array(&json, "shard", VS_JSON_ROW);
  vs_json_whole(&json, NULL, all->count > 1 ? 1 : (int64_t)head->shard);
  vs_json_whole(&json, NULL, all->count > 1 ? 1 : (int64_t)head->shards);
  vs_json_end(&json);
  vs_json_end(&json);
}

/* The head's two parts of it make one only together, with the counts between them. */
static bool has_manifest(vs_journal *j) {
  const vs_journals alone = {j, 1, 0, NULL};
  vs_text text = {0};
  vs_journal_manifest(&alone, &text);
  bool whole = vs_json_is_whole(text.text);
  vs_text_free(&text);
  return whole;
}

/* ---- opening ---- */

static void name_file(vs_journal *j, const char *folder) {
  snprintf(j->path, sizeof j->path, "%.4000s/%s", folder, NAME);
}

bool vs_journal_exists(const char *folder) {
  vs_journal j;
  name_file(&j, folder);
  return !access(j.path, F_OK);
}

/* Returns the index of a case among the shard's own. */
static uint64_t own(const vs_journal *j, uint64_t index) {
  return index / j->head.shards;
}

static bool is_own(const vs_journal *j, uint64_t index) {
  return index % j->head.shards + 1 == j->head.shard && (!j->head.cases || index < j->head.cases);
}

static void make_room(vs_journal *j, uint64_t cases) {
  if (cases <= j->room) return;
  uint64_t room = cases > 2 * j->room ? cases : 2 * j->room;
  j->place = vs_resize(j->place, room, sizeof *j->place);
  memset(j->place + j->room, 0, (room - j->room) * sizeof *j->place);
  j->room = room;
}

/* Makes room for all cases of a study that this process begins, whose count comes from its plan. */
static void reserve(vs_journal *j) {
  const vs_head *h = &j->head;
  if (h->cases) make_room(j, (h->cases + h->shards - h->shard) / h->shards);
}

/* Tries for a moment, as a worker that was just forked holds the lock, too, and may outlive its
 * killed parent by so long. */
static vs_status held(const vs_journal *j, bool (*try)(const vs_journal *), vs_error *err) {
  const struct timespec pause = {.tv_nsec = 20000000};
  for (int k = 0; k < 10 && !try(j); k++) {
    if (errno != EACCES && errno != EAGAIN) return VS_OK; /* a file system without locks */
    if (k == 9) return vs_fail(err, VS_INPUT, "%s: another process is at this study", j->path);
    nanosleep(&pause, NULL);
  }
  return VS_OK;
}

/* This descriptor's own lock: closing another one of the file, as read_lines does, keeps it. */
static bool try_file(const vs_journal *j) {
  struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  return !fcntl(j->fd, F_OFD_SETLK, &whole);
}

static bool try_folder(const vs_journal *j) {
  return !flock(j->folder, LOCK_EX | LOCK_NB);
}

static vs_status lock(vs_journal *j, vs_error *err) {
  return held(j, try_file, err);
}

/* Locks the folder, so that of two processes that begin a study in it only one goes on. */
static vs_status lock_folder(vs_journal *j, const char *folder, vs_error *err) {
  j->folder = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  return j->folder < 0 ? VS_OK : held(j, try_folder, err);
}

vs_status vs_journal_remove(const char *folder, vs_error *err) {
  vs_journal j = {.fd = -1, .folder = -1};
  name_file(&j, folder);
  vs_status status = lock_folder(&j, folder, err);
  if (!status) j.fd = open(j.path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (j.fd >= 0) status = lock(&j, err);
  if (!status && unlink(j.path))
    status = vs_fail(err, VS_RUN, "%s: cannot be removed: %s", j.path, strerror(errno));
  vs_journal_close(&j);
  return status;
}

vs_status vs_journal_create(vs_journal *j, const char *folder, vs_head *head, vs_error *err) {
  vs_file file = {0};
  vs_text text = {0};
  *j = (vs_journal){.fd = -1, .folder = -1, .head = *head};
  *head = (vs_head){0};
  name_file(j, folder);
  vs_status status = lock_folder(j, folder, err);
  if (!status) status = vs_file_open(&file, folder, NAME, err);
  vs_head_print(&text, &j->head);
  if (!status) {
    fputs(text.text, file.stream);
    status = vs_file_commit(&file, err);
  }
  j->end = text.length;
  vs_text_free(&text);
  if (status) return status;
  j->fd = open(j->path, O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  if (j->fd < 0) return vs_fail(err, VS_RUN, "%s: cannot be opened: %s", j->path, strerror(errno));
  reserve(j);
  return lock(j, err);
}

/* False where a study cannot have written that case at byte `at`, so that no memory is taken for
 * it. Cases may be done out of order by as many as all workers have at a time (VS_WORKER_QUEUE
 * each, of at most 4096 workers); the others have their lines before it, which are longer than
 * SHORTEST_LINE. */
static bool is_in_reach(const vs_journal *j, uint64_t index, uint64_t at) {
  enum { AHEAD = 4096 * 256, SHORTEST_LINE = 12 };
  return own(j, index) <= at / SHORTEST_LINE + AHEAD;
}

/* A line that is read. */
typedef struct entry {
  const char *line;
  size_t length;       /* without its end */
  uint64_t at, number; /* where it begins, in bytes; which it is, from 1 */
} entry;

/* Its sum, "=" or "!", and blanks. */
enum { BEFORE_ROW = 11 };

static vs_status refuse_row(const vs_journal *j, const entry *e, size_t at, const char *why,
                            vs_error *err) {
  const vs_where where = {j->path, (int)e->number,
                          vs_text_column(e->line, e->line + BEFORE_ROW + at)};
  return vs_fail_at(err, where, "%s; this record is of no study, or was changed", why);
}

static vs_status read_row(vs_journal *j, const entry *e, vs_row_counts *counts, vs_error *err) {
  const vs_head *h = &j->head;
  char why[256];
  size_t at;
  if (!j->shape) j->shape = vs_row_new(h->columns, h->failures, h->manifest_end);
  if (vs_row_read(j->shape, e->line[9] == '!', e->line + BEFORE_ROW, counts, &at, why, sizeof why))
    return VS_OK;
  return refuse_row(j, e, at, why, err);
}

/* The row of a case that the journal's study does not have, or that another shard has. */
static vs_status refuse_case(const vs_journal *j, const entry *e, vs_error *err) {
  const vs_head *h = &j->head;
  char why[160];
  snprintf(why, sizeof why,
           "its case is none of this journal's, which is shard %" PRIu64 "/%" PRIu64
           " of %s%llu cases",
           h->shard, h->shards, h->cases ? "" : "at most ",
           h->cases ? (unsigned long long)h->cases : VS_PLAN_CASES);
  return refuse_row(j, e, 0, why, err);
}

/* A study that goes on leaves out the cases that have a row, so that none has two. Where a file
 * system has no locks two processes may have done the same work; that tells nothing else. */
static vs_status check_double(vs_journal *j, const entry *e, uint64_t index, vs_error *err) {
  vs_text row = {0};
  char why[96];
  bool failed;
  vs_status status = vs_journal_row(j, index, &row, &failed, err);
  bool same = !status && failed == (e->line[9] == '!') && !strcmp(row.text, e->line + BEFORE_ROW);
  vs_text_free(&row);
  if (status || same) return status;
  snprintf(why, sizeof why, "case %" PRIu64 " has another row before this one", index);
  return refuse_row(j, e, 0, why, err);
}

static vs_status count_row(vs_journal *j, const entry *e, vs_error *err) {
  const char kind = e->line[9];
  vs_row_counts counts;
  vs_status status = read_row(j, e, &counts, err);
  if (status) return status;
  const uint64_t index = counts.index;
  if (!is_own(j, index) || !is_in_reach(j, index, e->at)) return refuse_case(j, e, err);
  make_room(j, own(j, index) + 1);
  if (j->place[own(j, index)]) return check_double(j, e, index, err);
  j->place[own(j, index)] = e->at + 1;
  j->done += kind == '=';
  j->failed += kind == '!';
  j->violated += kind == '=' && counts.violated;
  return VS_OK;
}

static vs_status take_line(vs_journal *j, const entry *e, vs_error *err) {
  const char *line = e->line;
  char *after;
  bool good = e->length > BEFORE_ROW &&
              strtoull(line, &after, 16) == vs_hash_crc32(line + 9, e->length - 9) &&
              after == line + 8;
  if (!good || strlen(line) != e->length)
    j->bad++;
  else if (line[9] == 'h')
    j->bad += !vs_head_read(&j->head, line + BEFORE_ROW, !(e->at), &j->two_heads);
  else if ((line[9] == '=' || line[9] == '!') && vs_head_is_whole(&j->head))
    return count_row(j, e, err);
  else
    j->bad++;
  return VS_OK;
}

/* Reads all lines; *end is where the last whole one ends. */
static vs_status read_lines(vs_journal *j, uint64_t *whole, vs_error *err) {
  int copy = dup(j->fd);
  FILE *f = copy < 0 ? NULL : fdopen(copy, "r");
  if (!f) return vs_fail(err, VS_RUN, "%s: cannot be read: %s", j->path, strerror(errno));
  char *line = NULL;
  size_t size = 0;
  ssize_t n;
  uint64_t at = 0, number = 0;
  vs_status status = VS_OK;
  while (!status && !j->two_heads && (n = vs_alloc_line(&line, &size, f)) > 0) {
    number++;
    if (line[n - 1] == '\n') {
      line[n - 1] = '\0';
      status = take_line(j, &(entry){line, (size_t)n - 1, at, number}, err);
      *whole = at + (uint64_t)n;
    } else
      j->bad++;
    at += (uint64_t)n;
  }
  if (!status) status = vs_file_was_read(f, j->path, err);
  free(line);
  fclose(f);
  return status;
}

vs_status vs_journal_open(vs_journal *j, const char *folder, bool mend, vs_error *err) {
  *j = (vs_journal){.fd = -1, .folder = -1};
  name_file(j, folder);
  vs_status status = mend ? lock_folder(j, folder, err) : VS_OK;
  if (status) return status;
  j->fd = open(j->path, (mend ? O_RDWR | O_NOFOLLOW : O_RDONLY) | O_CLOEXEC);
  if (j->fd < 0)
    return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", j->path, strerror(errno));
  if (mend)
    status =
        lock(j, err); /* locked before it is read, as whoever had the lock may have added lines */
  if (!status) status = read_lines(j, &j->end, err);
  if (!status && j->two_heads)
    status =
        vs_fail(err, VS_INPUT,
                "%s: has two heads, so that its rows may be of two studies; a journal has one, "
                "in its first lines",
                j->path);
  if (!status && !vs_head_is_whole(&j->head))
    status = vs_fail(err, VS_INPUT,
                     "%s: is no journal of a study: its head lacks a line, or has counts that no "
                     "study has (at most %llu cases and %d shards)",
                     j->path, VS_PLAN_CASES, VS_MOST_SHARDS);
  if (!status && !has_manifest(j))
    status = vs_fail(err, VS_INPUT,
                     "%s: manifest_begin and manifest_end of its head are not the two parts of a "
                     "manifest.json; this record is of no study, or was changed",
                     j->path);
  if (!status && mend && ftruncate(j->fd, (off_t)j->end))
    status = vs_fail(err, VS_RUN, "%s: cannot be written: %s", j->path, strerror(errno));
  return status;
}

bool vs_journal_peek(vs_journal *j, const char *folder) {
  struct stat s;
  vs_error none = {0};
  *j = (vs_journal){.fd = -1, .folder = -1};
  name_file(j, folder);
  return !stat(j->path, &s) && S_ISREG(s.st_mode) && !vs_journal_open(j, folder, false, &none);
}

void vs_journal_close(vs_journal *j) {
  if (j->fd >= 0) close(j->fd);
  if (j->folder >= 0) close(j->folder);
  vs_head_free(&j->head);
  free(j->place);
  vs_row_free(j->shape);
  vs_text_free(&j->fresh);
  *j = (vs_journal){.fd = -1, .folder = -1};
}

/* ---- rows ---- */

bool vs_journal_has(const vs_journal *j, uint64_t index) {
  return own(j, index) < j->room && j->place[own(j, index)];
}

bool vs_journal_had(const vs_journal *j, uint64_t index) {
  return is_own(j, index) && (j->head.cases || vs_journal_has(j, index));
}

vs_status vs_journal_add(vs_journal *j, uint64_t index, int status, const char *row, size_t length,
                         vs_error *err) {
  const bool failed = status == 1;
  make_room(j, own(j, index) + 1);
  j->place[own(j, index)] = j->end + j->fresh.length + 1;
  vs_head_line(&j->fresh, failed ? '!' : '=', row, length);
  j->done += !failed;
  j->failed += failed;
  j->violated += status == 3;
  return j->fresh.length < 1 << 16 ? VS_OK : vs_journal_flush(j, false, err);
}

vs_status vs_journal_flush(vs_journal *j, bool sync, vs_error *err) {
  size_t done = 0;
  while (done < j->fresh.length) {
    ssize_t n = pwrite(j->fd, j->fresh.text + done, j->fresh.length - done, (off_t)(j->end + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      return vs_fail(err, VS_RUN, "%s: cannot be written: %s; --resume goes on with it", j->path,
                     n ? strerror(errno) : "no room");
    done += (size_t)n;
  }
  j->unsynced = j->unsynced || done;
  j->end += done;
  j->fresh.length = 0;
  if (sync && j->unsynced && fdatasync(j->fd))
    return vs_fail(err, VS_RUN, "%s: cannot be written: %s; --resume goes on with it", j->path,
                   strerror(errno));
  if (sync) j->unsynced = false;
  return VS_OK;
}

vs_status vs_journal_row(const vs_journal *j, uint64_t index, vs_text *row, bool *failed,
                         vs_error *err) {
  uint64_t at = j->place[own(j, index)] - 1;
  char part[1024];
  row->length = 0;
  for (bool ended = false; !ended;) {
    ssize_t n = pread(j->fd, part, sizeof part - 1, (off_t)at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return vs_fail(err, VS_RUN, "%s: cannot be read: %s", j->path, strerror(errno));
    part[n] = '\0';
    char *end = strchr(part, '\n');
    ended = end;
    if (end) *end = '\0';
    vs_text_add(row, "%s", part);
    at += (uint64_t)n;
  }
  *failed = row->text[9] == '!';
  row->length -= 11;
  memmove(row->text, row->text + 11, row->length + 1);
  return VS_OK;
}
