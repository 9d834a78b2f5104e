/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/journal.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/error.h"
#include "base/file.h"
#include "base/path.h"
#include "base/text.h"
#include "study/plan.h"
#include "workers/platform.h"

/* ---- locks ---- */

/* Locks, by which a study belongs to one process at a time. They end with the process. Each waits a
 * moment, as a worker that was just forked holds the lock, too, and may outlive its killed parent
 * by so long. On a file system without locks there are none, and both succeed. */

static vs_status wait_for_lock(int fd, bool (*try)(int fd), const char *path, vs_error *err) {
  const struct timespec pause = {.tv_nsec = 20000000};
  for (int k = 0; k < 10 && !try(fd); k++) {
    if (errno != EACCES && errno != EAGAIN) return VS_OK; /* a file system without locks */
    if (k == 9) return vs_fail(err, VS_INPUT, "%s: another process is at this study", path);
    nanosleep(&pause, NULL);
  }
  return VS_OK;
}

static bool try_file(int fd) {
  struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  return !fcntl(fd, F_OFD_SETLK, &whole);
}

static bool try_folder(int fd) {
  return !flock(fd, LOCK_EX | LOCK_NB);
}

/* Locks the file that is open as fd, for this descriptor alone: closing another one of the same
 * file keeps the lock. path is for the message. Error: another process has it. */
static vs_status lock_file(int fd, const char *path, vs_error *err) {
  return wait_for_lock(fd, try_file, path, err);
}

/* Opens the folder as *fd and locks it, so that of two processes that begin a study in it only one
 * goes on. *fd is -1 where it cannot be opened. Error: another process has it. */
static vs_status lock_folder(const char *folder, const char *path, int *fd, vs_error *err) {
  *fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  return *fd < 0 ? VS_OK : wait_for_lock(*fd, try_folder, path, err);
}

/* On some network file systems a file's number changes; its length does not. */
static vs_status lock_keeps(int fd, const char *path, vs_error *err) {
  struct stat held, named;
  if (fstat(fd, &held)) return VS_OK;
  if (stat(path, &named) ? errno != ENOENT && errno != ENOTDIR && errno != ESTALE
                         : (named.st_ino == held.st_ino && named.st_dev == held.st_dev) ||
                               named.st_size == held.st_size)
    return VS_OK;
  return vs_fail(
      err, VS_RUN,
      "%s: is gone, or is another file: its folder was moved, removed or unmounted while "
      "the study ran; put it back, and --resume goes on with it",
      path);
}

/* ---- lines of the file ---- */

/* The lines of a journal's file, as bytes: all of them in their order, or the one that begins at a
 * known byte. Many are read at a time, as each read may have to go over a network. */
/* An open file. All is borrowed; path is for messages. */
typedef struct line_file {
  int fd;
  const char *path;
  vs_lines_part *part; /* only lines_read needs it */
} line_file;

/* A line that was read. */
typedef struct line_entry {
  const char *text;
  size_t length;       /* in bytes, without its end; more than the text's if one of them is zero */
  uint64_t at, number; /* where it begins, in bytes; which it is, from 1 */
} line_entry;

/* What lines_each has seen. */
typedef struct lines_seen {
  uint64_t count; /* lines */
  uint64_t end;   /* where the last whole one ends, in bytes */
  bool torn;      /* the last one has no line end; it is counted, and was not shown */
} lines_seen;

/* Shows all lines to `visit`, from the first on, until the file or *enough ends it. Errors: that of
 * visit; the file cannot be read. */
typedef vs_status (*line_visit)(void *ctx, const line_entry *line, bool *enough, vs_error *err);
static vs_status lines_each(const line_file *file, line_visit visit, void *ctx, lines_seen *seen,
                            vs_error *err) {
  enum { AT_ONCE = 1 << 16 };
  *seen = (lines_seen){0};
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
      status = visit(ctx, &(line_entry){text, (size_t)n - 1, at, seen->count}, &enough, err);
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

/* Rows are mostly asked for in the order in which they stand in the file. A merge has one part for
 * each shard. */
enum { PART = 4096 };
struct vs_lines_part {
  uint64_t at; /* of its first byte in the file */
  size_t size;
  char bytes[PART];
};

static vs_lines_part *lines_part_new(void) {
  return vs_alloc(1, sizeof(vs_lines_part));
}

/* Forgets what was read: the file is about to change there. */
static void lines_forget(vs_lines_part *part) {
  part->size = 0;
}

/* Reads the part from byte `at` on. Behind the file's end it is empty. */
static vs_status read_part(const line_file *file, uint64_t at, vs_error *err) {
  vs_lines_part *p = file->part;
  ssize_t n;
  do n = pread(file->fd, p->bytes, sizeof p->bytes, (off_t)at);
  while (n < 0 && errno == EINTR);
  p->at = at;
  p->size = n > 0 ? (size_t)n : 0;
  return n < 0 ? vs_fail(err, VS_RUN, "%s: cannot be read: %s", file->path, strerror(errno))
               : VS_OK;
}

/* Reads the line that begins at byte `at` into text, without its end; behind the file's end it is
 * empty. *length is how many bytes stand there: more than the text's if one of them is zero. Error:
 * the file cannot be read. */
static vs_status lines_read(const line_file *file, uint64_t at, vs_text *text, size_t *length,
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

/* ---- opening ---- */

static const char NAME[] = "journal";

static line_file lines_of_journal(const vs_journal *j) {
  return (line_file){j->fd, j->path, j->part};
}

static void name_journal(vs_journal *j, const char *folder) {
  snprintf(j->path, sizeof j->path, "%.4000s/%s", folder, NAME);
}

bool vs_journal_exists(const char *folder) {
  vs_journal j;
  name_journal(&j, folder);
  return !access(j.path, F_OK);
}

/* Returns the index of a case among the shard's own. */
static uint64_t place_in_shard(const vs_journal *j, uint64_t index) {
  return index / j->head.shards;
}

static bool is_of_shard(const vs_journal *j, uint64_t index) {
  return index % j->head.shards + 1 == j->head.shard && (!j->head.cases || index < j->head.cases);
}

static void make_room_for_cases(vs_journal *j, uint64_t cases) {
  if (cases <= j->room) return;
  uint64_t room = cases > 2 * j->room ? cases : 2 * j->room;
  j->place = vs_resize(j->place, room, sizeof *j->place);
  memset(j->place + j->room, 0, (size_t)(room - j->room) * sizeof *j->place);
  j->room = room;
}

/* Makes room for all cases of a study that this process begins, whose count comes from its plan. */
static void reserve_places(vs_journal *j) {
  const vs_journal_head *h = &j->head;
  if (h->cases) make_room_for_cases(j, (h->cases + h->shards - h->shard) / h->shards);
}

vs_status vs_journal_remove(const char *folder, vs_error *err) {
  vs_journal j = {.fd = -1, .folder = -1};
  name_journal(&j, folder);
  vs_status status = lock_folder(folder, j.path, &j.folder, err);
  if (!status) j.fd = open(j.path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (j.fd >= 0) status = lock_file(j.fd, j.path, err);
  if (!status && unlink(j.path))
    status = vs_fail(err, VS_RUN, "%s: cannot be removed: %s", j.path, strerror(errno));
  vs_journal_close(&j);
  return status;
}

/* Adds the line that says on what the rows behind it were made. */
static void say_bits(vs_journal *j, vs_text *to) {
  if (j->says_bits) return;
  vs_journal_head_line(to, 'm', vs_platform_here(), strlen(vs_platform_here()));
  vs_platform_add(&j->bits, vs_platform_here());
  j->says_bits = true;
}

vs_status vs_journal_create(vs_journal *j, const char *folder, vs_journal_head *head,
                            vs_error *err) {
  vs_file file = {0};
  vs_text text = {0};
  *j = (vs_journal){.fd = -1, .folder = -1, .head = *head};
  j->part = lines_part_new();
  *head = (vs_journal_head){0};
  name_journal(j, folder);
  vs_status status = lock_folder(folder, j->path, &j->folder, err);
  if (!status) status = vs_file_open(&file, folder, NAME, err);
  vs_journal_head_print(&text, &j->head);
  say_bits(j, &text);
  if (!status) {
    fputs(text.text, file.stream);
    status = vs_file_commit(&file, err);
  }
  j->end = text.length;
  vs_text_free(&text);
  if (status) return status;
  j->fd = open(j->path, O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  if (j->fd < 0) return vs_fail(err, VS_RUN, "%s: cannot be opened: %s", j->path, strerror(errno));
  reserve_places(j);
  return lock_file(j->fd, j->path, err);
}

/* False where a study cannot have written that case at byte `at`, so that no memory is taken for
 * it. Cases may be done out of order by as many as all workers have at a time (VS_TASK_PIPE_MOST
 * each, of at most 4096 workers); the others have their lines before it, which are longer than
 * SHORTEST_LINE. */
static bool is_in_reach(const vs_journal *j, uint64_t index, uint64_t at) {
  enum { AHEAD = 4096 * 256, SHORTEST_LINE = 12 };
  return place_in_shard(j, index) <= at / SHORTEST_LINE + AHEAD;
}

static vs_status refuse_row(const vs_journal *j, const line_entry *e, size_t at, const char *why,
                            vs_error *err) {
  const vs_where where = {j->path, (int)e->number,
                          vs_text_column(e->text, e->text + VS_HEAD_TEXT + at)};
  return vs_fail_at(err, where, "%s; this record is of no study, or was changed", why);
}

static vs_status read_journal_row(vs_journal *j, const line_entry *e, vs_row_shape_counts *counts,
                                  vs_error *err) {
  const vs_journal_head *h = &j->head;
  char why[256];
  size_t at;
  if (!j->shape) j->shape = vs_row_shape_new(h->columns, h->failures, h->manifest_end);
  if (vs_row_shape_read(j->shape, e->text[VS_HEAD_KIND] == '!', e->text + VS_HEAD_TEXT, counts, &at,
                        why, sizeof why))
    return VS_OK;
  return refuse_row(j, e, at, why, err);
}

/* The row of a case that the journal's study does not have, or that another shard has. */
static vs_status refuse_case(const vs_journal *j, const line_entry *e, vs_error *err) {
  const vs_journal_head *h = &j->head;
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
static vs_status check_double(vs_journal *j, const line_entry *e, uint64_t index, vs_error *err) {
  vs_text row = {0};
  char why[96];
  bool failed;
  vs_status status = vs_journal_row(j, index, &row, &failed, err);
  bool same = !status && failed == (e->text[VS_HEAD_KIND] == '!') &&
              !strcmp(row.text, e->text + VS_HEAD_TEXT);
  vs_text_free(&row);
  if (status || same) return status;
  snprintf(why, sizeof why, "case %" PRIu64 " has another row before this one", index);
  return refuse_row(j, e, 0, why, err);
}

static vs_status count_journal_row(vs_journal *j, const line_entry *e, vs_error *err) {
  const char kind = e->text[VS_HEAD_KIND];
  vs_row_shape_counts counts;
  vs_status status = read_journal_row(j, e, &counts, err);
  if (status) return status;
  const uint64_t index = counts.index;
  if (!is_of_shard(j, index) || !is_in_reach(j, index, e->at)) return refuse_case(j, e, err);
  make_room_for_cases(j, place_in_shard(j, index) + 1);
  if (j->place[place_in_shard(j, index)]) return check_double(j, e, index, err);
  j->place[place_in_shard(j, index)] = e->at + 1;
  j->done += kind == '=';
  j->failed += kind == '!';
  j->violated += kind == '=' && counts.violated;
  return VS_OK;
}

static const vs_judged_line *find_judged(const vs_journal *j, uint64_t index, int way) {
  for (size_t k = 0; k < j->n_judged; k++)
    if (j->judged[k].index == index && j->judged[k].way == way) return &j->judged[k];
  return NULL;
}

static void note_judged(vs_journal *j, uint64_t index, int way, uint64_t at) {
  j->judged = vs_alloc_grow(j->judged, j->n_judged, sizeof *j->judged);
  j->judged[j->n_judged++] = (vs_judged_line){index, at, way};
}

/* In such a line: the way, and = or !, before the row. */
enum { JUDGED = 2 };

static vs_status take_judged(vs_journal *j, const line_entry *e, vs_error *err) {
  const char *text = e->text + VS_HEAD_TEXT;
  line_entry row = *e;
  vs_row_shape_counts counts = {0};
  char why[256];
  size_t at;
  const bool whole = isdigit((unsigned char)*text) && (text[1] == '=' || text[1] == '!');
  if (!j->shape)
    j->shape = vs_row_shape_new(j->head.columns, j->head.failures, j->head.manifest_end);
  if (!whole ||
      !vs_row_shape_read(j->shape, text[1] == '!', text + JUDGED, &counts, &at, why, sizeof why))
    return refuse_row(j, &row, JUDGED, whole ? why : "its way is not known", err);
  if (!is_of_shard(j, counts.index)) return refuse_case(j, e, err);
  if (find_judged(j, counts.index, *text - '0'))
    j->bad++; /* the first one counts */
  else
    note_judged(j, counts.index, *text - '0', e->at);
  return VS_OK;
}

/* What is known while a journal is read. */
typedef struct journal_reading {
  vs_journal *journal;
  vs_journal_head
      found; /* the head, each line from the first place that has it; whole, or of no use */
  vs_journal_head copy; /* the copy that is being read */
  bool foreign;         /* it is of a version that this program does not read */
} journal_reading;

/* Gives a head that lacks a line what copies have. Where the journal's lines still stand where they
 * were written, `at` is the place behind the head, and the head can be written again. */
static void mend_head(vs_journal *j, const journal_reading *r, uint64_t at) {
  vs_text head = {0};
  if (vs_journal_head_is_whole(&j->head) || !vs_journal_head_is_whole(&r->found)) return;
  vs_journal_head_fill(&j->head, &r->found);
  vs_journal_head_print(&head, &j->head);
  j->mended = true;
  j->in_place = head.length == at;
  j->bad = 0; /* these were the head's */
  vs_text_free(&head);
}

/* Takes a line of the head. A copy is there to be compared, once it is whole. A line that the copy
 * has already begins the next copy: the one before lacks a line, which was damaged. */
static void take_head(vs_journal *j, const line_entry *e, journal_reading *r) {
  const char *text = e->text + VS_HEAD_TEXT;
  bool other = false;
  if (e->text[VS_HEAD_KIND] == 'h') {
    j->bad += !vs_journal_head_read(&j->head, text, !e->at, &j->two_heads);
    return;
  }
  if (!vs_journal_head_read(&r->copy, text, false, &other) || other) {
    vs_journal_head_free(&r->copy);
    j->bad += !vs_journal_head_read(&r->copy, text, false, &other);
  }
  if (vs_journal_head_is_whole(&r->copy) && vs_journal_head_is_whole(&j->head) &&
      vs_journal_head_differs(&r->copy, &j->head))
    j->two_heads = true;
}

/* A case's row of failures.csv does not count any more. */
static void call_row_back(vs_journal *j, const line_entry *e) {
  char *end;
  const uint64_t index = strtoull(e->text + VS_HEAD_TEXT, &end, 10);
  const bool known = !*end && is_of_shard(j, index) && vs_journal_has(j, index);
  vs_text row = {0};
  vs_error none = {0};
  bool failed = false;
  if (known && !vs_journal_row(j, index, &row, &failed, &none) && failed) {
    j->place[place_in_shard(j, index)] = 0;
    j->failed--;
  } else
    j->bad++;
  vs_text_free(&row);
}

static vs_status take_journal_line(void *ctx, const line_entry *e, bool *enough, vs_error *err) {
  journal_reading *r = ctx;
  vs_journal *j = r->journal;
  const char kind = vs_journal_head_kind(e->text, e->length);
  if (kind && kind != 'h') mend_head(j, r, e->at);
  const bool headed = vs_journal_head_is_whole(&j->head);
  if (kind == 'h' || kind == 'H')
    take_head(j, e, r);
  else if (kind == 'm')
    vs_platform_add(&j->bits, e->text + VS_HEAD_TEXT);
  else if (kind == '~' && headed)
    call_row_back(j, e);
  else if (kind == 'j' && headed)
    return take_judged(j, e, err);
  else if ((kind == '=' || kind == '!') && headed)
    return count_journal_row(j, e, err);
  else
    j->bad++;
  *enough = j->two_heads;
  return VS_OK;
}

/* Looks for the head alone. */
static vs_status find_head(void *ctx, const line_entry *e, bool *enough, vs_error *err) {
  journal_reading *r = ctx;
  const char kind = vs_journal_head_kind(e->text, e->length);
  bool again = false;
  (void)err;
  if (kind != 'h' && kind != 'H') return VS_OK;
  r->foreign = r->foreign || (!e->at && vs_journal_head_is_foreign(e->text + VS_HEAD_TEXT));
  vs_journal_head_read(&r->found, e->text + VS_HEAD_TEXT, true, &again);
  *enough = vs_journal_head_is_whole(&r->found);
  return VS_OK;
}

/* Reads all lines. The head is looked for first, as a row cannot be read without it; in a journal
 * that is not damaged that takes its first lines. */
static vs_status read_journal(vs_journal *j, vs_error *err) {
  const line_file lines = lines_of_journal(j);
  lines_seen seen;
  journal_reading r = {.journal = j};
  vs_status status = lines_each(&lines, find_head, &r, &seen, err);
  if (!status && r.foreign)
    status = vs_fail_at(err, (vs_where){j->path, 1, 1},
                        "is of another version of the journal than this program reads; go on with "
                        "the program that began it, or take another folder");
  if (!status) status = lines_each(&lines, take_journal_line, &r, &seen, err);
  j->end = seen.end;
  j->bad += seen.torn;
  if (!status && !j->done && !j->failed) mend_head(j, &r, j->end);
  if (!status && j->two_heads)
    status = vs_fail_at(err, (vs_where){j->path, (int)seen.count, 1},
                        "has two heads, so that its rows may be of two studies; a journal has one, "
                        "in its first lines");
  vs_journal_head_free(&r.found);
  vs_journal_head_free(&r.copy);
  return status;
}

/* Errors: the head lacks a line, or its parts of the manifest are no JSON. */
static vs_status check_head(const vs_journal *j, vs_error *err) {
  if (!vs_journal_head_is_whole(&j->head))
    return vs_fail_at(
        err, (vs_where){j->path, 1, 1},
        "is no journal of a study: its head lacks a line, or has counts that no study has (at most "
        "%llu cases and %d shards); where it is damaged and nothing has a copy of it, as in a "
        "journal of version 1, put the file back from a backup, or begin the study anew: with "
        "--overwrite, or in another folder",
        VS_PLAN_CASES, VS_MOST_SHARDS);
  if (!vs_journal_head_has_manifest(&j->head))
    return vs_fail_at(err, (vs_where){j->path, 1, 1},
                      "manifest_begin and manifest_end of its head are not the two parts of a "
                      "manifest.json; this record is of no study, or was changed");
  return VS_OK;
}

/* Writes the head again where it is damaged and its lines have kept their places. Error: the file
 * cannot be written. */
static vs_status write_head(vs_journal *j, vs_error *err) {
  vs_text head = {0};
  vs_journal_head_print(&head, &j->head);
  bool written = pwrite(j->fd, head.text, head.length, 0) == (ssize_t)head.length;
  vs_text_free(&head);
  return written ? VS_OK
                 : vs_fail(err, VS_RUN, "%s: cannot be written: %s", j->path, strerror(errno));
}

vs_status vs_journal_open(vs_journal *j, const char *folder, bool mend, vs_error *err) {
  *j = (vs_journal){.fd = -1, .folder = -1};
  j->part = lines_part_new();
  name_journal(j, folder);
  vs_status status = mend ? lock_folder(folder, j->path, &j->folder, err) : VS_OK;
  if (status) return status;
  status = vs_path_check_result(j->path, err);
  if (status) return status;
  j->fd = open(j->path, (mend ? O_RDWR | O_NOFOLLOW : O_RDONLY) | O_CLOEXEC);
  if (j->fd < 0)
    return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", j->path, strerror(errno));
  /* locked before it is read, as whoever had the lock may have added lines */
  if (mend) status = lock_file(j->fd, j->path, err);
  if (!status) status = read_journal(j, err);
  if (!status) status = check_head(j, err);
  lines_forget(j->part); /* a torn line that it has is cut off, and others come in its place */
  if (!status && mend && ftruncate(j->fd, (off_t)j->end))
    status = vs_fail(err, VS_RUN, "%s: cannot be written: %s", j->path, strerror(errno));
  return !status && mend && j->mended && j->in_place ? write_head(j, err) : status;
}

bool vs_journal_peek(vs_journal *j, const char *folder) {
  struct stat s;
  vs_error none = {0};
  *j = (vs_journal){.fd = -1, .folder = -1};
  name_journal(j, folder);
  return !stat(j->path, &s) && S_ISREG(s.st_mode) && !vs_journal_open(j, folder, false, &none);
}

void vs_journal_close(vs_journal *j) {
  if (j->fd >= 0) close(j->fd);
  if (j->folder >= 0) close(j->folder);
  vs_journal_head_free(&j->head);
  free(j->place);
  free(j->judged);
  vs_row_shape_free(j->shape);
  vs_text_free(&j->fresh);
  vs_text_free(&j->bits);
  free(j->part);
  *j = (vs_journal){.fd = -1, .folder = -1};
}

/* ---- rows ---- */

bool vs_journal_has(const vs_journal *j, uint64_t index) {
  return place_in_shard(j, index) < j->room && j->place[place_in_shard(j, index)];
}

bool vs_journal_had(const vs_journal *j, uint64_t index) {
  return is_of_shard(j, index) && (j->head.cases || vs_journal_has(j, index));
}

vs_status vs_journal_add(vs_journal *j, uint64_t index, int status, const char *row, size_t length,
                         vs_error *err) {
  const bool failed = status == 1;
  say_bits(j, &j->fresh);
  make_room_for_cases(j, place_in_shard(j, index) + 1);
  j->place[place_in_shard(j, index)] = j->end + j->fresh.length + 1;
  vs_journal_head_line(&j->fresh, failed ? '!' : '=', row, length);
  j->done += !failed;
  j->failed += failed;
  j->violated += status == 3;
  return j->fresh.length < 1 << 16 ? VS_OK : vs_journal_flush(j, false, err);
}

/* Puts a copy of the head behind the fresh lines, once the journal is twice as long as it was at
 * the copy before. */
static void add_copy_of_head(vs_journal *j) {
  const uint64_t end = j->end + j->fresh.length;
  if (!j->fresh.length || end < j->copy_at) return;
  vs_journal_head_print_copy(&j->fresh, &j->head);
  j->copy_at = 2 * end;
}

vs_status vs_journal_flush(vs_journal *j, bool sync, vs_error *err) {
  size_t done = 0;
  add_copy_of_head(j);
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
  return sync ? lock_keeps(j->fd, j->path, err) : VS_OK;
}

vs_status vs_journal_call_back(vs_journal *j, uint64_t *count, vs_error *err) {
  vs_text row = {0};
  char number[24];
  bool failed = false;
  vs_status status = VS_OK;
  *count = 0;
  for (uint64_t k = 0; k < j->room && !status; k++) {
    const uint64_t index = k * j->head.shards + j->head.shard - 1;
    if (!j->place[k]) continue;
    status = vs_journal_row(j, index, &row, &failed, err);
    if (status || !failed) continue;
    int n = snprintf(number, sizeof number, "%" PRIu64, index);
    vs_journal_head_line(&j->fresh, '~', number, (size_t)n);
    j->place[k] = 0;
    j->failed--;
    ++*count;
  }
  vs_text_free(&row);
  return status ? status : vs_journal_flush(j, true, err);
}

/* Reads the row of a case whose line begins at byte `at`, behind `skip` bytes of its text. *kind is
 * the line's. */
static vs_status read_row(const vs_journal *j, uint64_t index, uint64_t at, size_t skip,
                          vs_text *row, char *kind, vs_error *err) {
  size_t length;
  const line_file lines = lines_of_journal(j);
  vs_status status = lines_read(&lines, at, row, &length, err);
  if (status) return status;
  *kind = vs_journal_head_kind(row->text, length);
  skip += VS_HEAD_TEXT;
  if ((skip == VS_HEAD_TEXT ? *kind != '=' && *kind != '!' : *kind != 'j') || length < skip ||
      !vs_row_shape_is_of(row->text + skip, index))
    return vs_fail(err, VS_RUN,
                   "%s: row of case %llu was changed while the study ran or was merged; let "
                   "nothing else write to this file, and --resume runs again what is lost",
                   j->path, (unsigned long long)index);
  if (*kind == 'j') *kind = row->text[skip - 1];
  row->length -= skip;
  memmove(row->text, row->text + skip, row->length + 1);
  return VS_OK;
}

vs_status vs_journal_row(const vs_journal *j, uint64_t index, vs_text *row, bool *failed,
                         vs_error *err) {
  char kind = 0;
  vs_status status = read_row(j, index, j->place[place_in_shard(j, index)] - 1, 0, row, &kind, err);
  *failed = kind == '!';
  return status;
}

vs_status vs_journal_add_judged(vs_journal *j, uint64_t index, int way, int status, const char *row,
                                size_t length, vs_error *err) {
  vs_text text = {0};
  say_bits(j, &j->fresh);
  note_judged(j, index, way, j->end + j->fresh.length);
  vs_text_add(&text, "%d%c", way, status == 1 ? '!' : '=');
  vs_text_put(&text, row, length);
  vs_journal_head_line(&j->fresh, 'j', text.text, text.length);
  vs_text_free(&text);
  return j->fresh.length < 1 << 16 ? VS_OK : vs_journal_flush(j, false, err);
}

bool vs_journal_has_judged(const vs_journal *j, uint64_t index, int way) {
  return find_judged(j, index, way) != NULL;
}

vs_status vs_journal_judged_row(const vs_journal *j, uint64_t index, int way, vs_text *row,
                                bool *failed, vs_error *err) {
  char kind = 0;
  vs_status status = read_row(j, index, find_judged(j, index, way)->at, JUDGED, row, &kind, err);
  *failed = kind == '!';
  return status;
}
