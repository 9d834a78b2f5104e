/* SPDX-License-Identifier: GPL-3.0-or-later
 * DIR/journal: what a study has done so far, row by row in the order of their coming. Each line is
 *
 *   CRC32 KIND TEXT
 *
 * with the CRC-32 of "KIND TEXT" in 8 hexadecimal digits. KIND h: the head, NAME=VALUE; =: a row of
 * study.csv; !: a row of failures.csv. Lines are only ever added. One whose sum is wrong does not
 * count: its case is not done. The last one may be torn; it is cut off when the study goes on.
 * There is one head, and it comes first. A row whose sum is right and that is none by its header,
 * or that says of a case something else than an earlier one, is refused: nobody knows which of the
 * two is true. The same row twice is one row.
 *
 * The rows themselves stay on the disk; of each case 8 bytes are in memory. No count that stands in
 * a journal makes it take more than its length justifies. */
#ifndef VS_BATCH_JOURNAL_H
#define VS_BATCH_JOURNAL_H

#include <stdint.h>

#include "base/path.h"
#include "base/text.h"
#include "batch/shape.h"

enum { VS_MOST_SHARDS = 10000 };

/* What a study is told apart by, and what its files need besides the rows. */
typedef struct vs_journal_head {
  char *identity;           /* hash of the plan and of all it is made of */
  char *columns, *failures; /* header rows of study.csv and failures.csv */
  char *manifest_begin;     /* of manifest.json, up to the counts of cases */
  char *manifest_end;       /* from behind them to the shard */
  uint64_t cases;           /* of the whole study; 0: not known before its end */
  uint64_t shard, shards;   /* from 1; case k is shard 1 + k % shards' */
} vs_journal_head;
void vs_journal_head_free(vs_journal_head *head);

typedef struct vs_journal {
  char path[VS_PATH_SIZE];
  int fd;     /* -1: closed */
  int folder; /* locked as long as this process is at the study; -1: not */
  vs_journal_head head;
  uint64_t *place; /* of each of its cases: where its line begins, plus 1; 0: not done */
  uint64_t room;   /* cases place has room for */
  uint64_t end;    /* bytes in the file */
  uint64_t done, failed, violated; /* cases with a row in study.csv, in failures.csv; of the former
                                      those of status 3 */
  vs_shape *shape;                 /* of its rows; NULL: no row was read yet */
  bool two_heads;                  /* something of the head stands there twice, or behind rows */
  uint64_t bad;                    /* lines that did not count, when it was opened */
  vs_text fresh;                   /* lines not written yet */
  bool unsynced;                   /* written since the last fsync */
} vs_journal;

/* Is there one in the folder? */
bool vs_journal_exists(const char *folder);
/* A new one, over an older one; takes the head over. */
vs_status vs_journal_create(vs_journal *journal, const char *folder, vs_journal_head *head,
                            vs_error *err);
/* One that is there, with what it has done. mend: to go on with it: locked, and what is torn cut
 * off. Errors: no journal; one with two heads,
 * or with counts that no study has; a row that is none, or two of one case, with their place;
 * another process has it. vs_journal_close even then. */
vs_status vs_journal_open(vs_journal *journal, const char *folder, bool mend, vs_error *err);
void vs_journal_close(vs_journal *journal);

bool vs_journal_has(const vs_journal *journal, uint64_t index);
/* status: of the case; row: as it stands in the CSV file, without a newline. */
vs_status vs_journal_add(vs_journal *journal, uint64_t index, int status, const char *row,
                         size_t length, vs_error *err);
/* Hands what is fresh to the system; and, with sync, to the disk. */
vs_status vs_journal_flush(vs_journal *journal, bool sync, vs_error *err);
/* The row of a case that is done, and whether it failed. */
vs_status vs_journal_row(const vs_journal *journal, uint64_t index, vs_text *row, bool *failed,
                         vs_error *err);

/* Writes study.csv, failures.csv, manifest.json into the folder, from one journal or from all
 * shards' (item k is shard k + 1); cases: of the whole study. more: members of the manifest
 * besides, `, "name": value` each. */
typedef struct vs_journals {
  vs_journal *item;
  uint64_t count, cases;
  const char *more;
} vs_journals;
vs_status vs_journals_write(const vs_journals *journals, const char *folder, vs_error *err);

#endif
