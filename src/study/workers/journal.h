/* SPDX-License-Identifier: GPL-3.0-or-later
 * The file DIR/journal: what a study has done so far, one row after the other as they come. Each of
 * its lines is
 *
 *   CRC32 KIND TEXT
 *
 * where CRC32 is the CRC-32 of "KIND TEXT" in 8 hexadecimal digits, and KIND is
 *
 *   h   for a line NAME=VALUE of the head, which comes first and once;
 *   H   for the same line in a copy of the head: one stands behind the first rows, and one more
 *       whenever the journal has become twice as long;
 *   =   for a row of study.csv;
 *   !   for a row of failures.csv;
 *   ~   for the number of a case whose row of failures.csv does not count any more, as it is run
 *       again;
 *   j   for what came of a case that was run in another way, to judge the first (study/judge.h):
 *       the number of the way, = or !, and the row.
 *
 * A head that lacks a line takes it from the first copy that has it. Lines are only ever added. A
 * line whose sum is wrong does not count, and its case is not done. The last line may be torn, when
 * the process was killed; it is cut off when the study goes on. A row that does not fit its header
 * is refused, and so is one of a case that the head has not. So is a row that differs from an
 * earlier one of the same case, as nobody knows which of the two is true. The same row twice counts
 * as one.
 *
 * The rows stay on the disk; in memory are 8 bytes for each case. A count that stands in a journal
 * never makes this process take more memory than the journal's length justifies. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "base/path.h"
#include "base/text.h"
#include "workers/journal_head.h"
#include "workers/row_shape.h"

/* The part of the file that was read last. */
typedef struct vs_lines_part vs_lines_part;

/* A line of kind j. */
typedef struct vs_judged_line {
  uint64_t index, at; /* of the case; where the line begins in the file */
  int way;
} vs_judged_line;

typedef struct vs_journal {
  char path[VS_PATH_SIZE];
  int fd;     /* of the file; -1: closed */
  int folder; /* of the folder, locked as long as this process runs the study; -1: not locked */
  vs_journal_head head;
  uint64_t *place; /* [room], by the shard's cases: where the case's line begins, plus 1; 0: it is
                      not done */
  uint64_t room;
  uint64_t end;           /* bytes in the file, without `fresh` */
  uint64_t done;          /* cases with a row in study.csv */
  uint64_t failed;        /* cases with a row in failures.csv */
  uint64_t violated;      /* those of `done` that have status 3 */
  vs_judged_line *judged; /* owned */
  size_t n_judged;
  vs_row_shape *shape; /* that every row must have; NULL: no row was read yet */
  bool two_heads;   /* a line of the head stands there twice, or behind rows, or a copy of it says
                       something else */
  bool mended;      /* the head lacked a line, which a copy had */
  bool in_place;    /* what stands behind that head stands where it did */
  uint64_t copy_at; /* bytes from which on the next copy of the head is written */
  uint64_t bad;     /* lines that did not count when it was opened */
  vs_text fresh;    /* lines that are not written yet */
  vs_lines_part *part; /* of the file, as it was read last; NULL: closed */
  bool unsynced;       /* lines were written since the last fsync */
  vs_text bits;        /* on what its rows were made (study/workers/platform.h), a line each */
  bool says_bits;      /* the lines that this process adds stand behind one that says on what */
} vs_journal;

/* True if the folder holds a journal. */
bool vs_journal_exists(const char *folder);
/* Removes the folder's journal. Errors: another process is at the study; it cannot be removed. */
vs_status vs_journal_remove(const char *folder, vs_error *err);
/* Begins a new journal in place of an older one. It takes the head's strings over. Errors: another
 * process is at the study in that folder; the file cannot be written. */
vs_status vs_journal_create(vs_journal *journal, const char *folder, vs_journal_head *head,
                            vs_error *err);
/* Opens the journal that the folder holds and reads what is done. With `mend` the study goes on:
 * the folder is locked, and a torn last line is cut off. Errors: there is no journal; it is of a
 * version that this program does not know; it has two heads, or one whose manifest is no JSON, or
 * counts that no study has; a row does not fit its header, or a case has two different rows, or the
 * head lacks it, which the error names with their place; another process is at the study.
 * vs_journal_close even then. */
vs_status vs_journal_open(vs_journal *journal, const char *folder, bool mend, vs_error *err);
/* The same for one that gives way to another study, whatever stands there: false, it is no journal,
 * or no plain file. */
bool vs_journal_peek(vs_journal *journal, const char *folder);
void vs_journal_close(vs_journal *journal);

/* True if the journal's study has that case, as far as that is known: a search knows only those
 * that are done. */
bool vs_journal_had(const vs_journal *journal, uint64_t index);
/* True if the case is done. It must be one of the shard's. */
bool vs_journal_has(const vs_journal *journal, uint64_t index);
/* Calls all rows of failures.csv back, so that their cases are not done; *count is how many. They
 * are on the disk. Error: the file cannot be written. */
vs_status vs_journal_call_back(vs_journal *journal, uint64_t *count, vs_error *err);
/* Adds the row of a case, as the CSV file has it but without a newline. status is VS_CASE_... of
 * study/workers/case.h: it says to which of the two files the row belongs. Error: the file cannot
 * be written. */
vs_status vs_journal_add(vs_journal *journal, uint64_t index, int status, const char *row,
                         size_t length, vs_error *err);
/* Writes the fresh lines; with sync it also waits until they are on the disk. Errors: they cannot
 * be written; with sync, the journal's name has become that of another file, or of none. */
vs_status vs_journal_flush(vs_journal *journal, bool sync, vs_error *err);
/* Reads the row of a case that is done, and tells whether the case failed. Errors: the file cannot
 * be read; another program has changed the row since it was written, or read first. */
vs_status vs_journal_row(const vs_journal *journal, uint64_t index, vs_text *row, bool *failed,
                         vs_error *err);

/* The same for a case that was run in another way, numbered from 0 to 9. */
vs_status vs_journal_add_judged(vs_journal *journal, uint64_t index, int way, int status,
                                const char *row, size_t length, vs_error *err);
bool vs_journal_has_judged(const vs_journal *journal, uint64_t index, int way);
vs_status vs_journal_judged_row(const vs_journal *journal, uint64_t index, int way, vs_text *row,
                                bool *failed, vs_error *err);

/* The journals of a whole study. */
typedef struct vs_journals {
  vs_journal *item; /* one journal, or those of all shards: item k is shard k + 1 */
  uint64_t count;
  uint64_t cases;   /* of the whole study */
  const char *more; /* further members of the manifest, as a writer inside it (vs_json_inside) adds
                       them; NULL: none */
} vs_journals;
