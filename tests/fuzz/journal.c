/* SPDX-License-Identifier: GPL-3.0-or-later
 * Journals of studies. Sums are mended after a change, as nothing else of a line is looked at where
 * its sum is wrong. */
#include "study/workers/journal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "targets.h"

static void read_rows(const vs_journal *j) {
  vs_text row = {0};
  vs_error err = {0};
  bool failed;
  uint64_t shards = j->head.shards, most = j->room < 64 ? j->room : 64;
  for (uint64_t k = 0; k < most; k++) {
    uint64_t index = k * shards + j->head.shard - 1;
    vs_journal_had(j, index);
    if (vs_journal_has(j, index)) fuzz_judge(vs_journal_row(j, index, &row, &failed, &err), &err);
  }
  vs_text_free(&row);
}

static void take(const char *text, size_t size) {
  char path[VS_PATH_SIZE];
  vs_journal j;
  vs_error err = {0};
  fuzz_write("journal", text, size, path);
  vs_status status = vs_journal_open(&j, fuzz_folder(), false, &err);
  fuzz_judge(status, &err);
  if (!status) {
    const vs_journal_head_counts counts = {j.head.cases, j.done, j.failed, j.violated};
    vs_text manifest = {0};
    read_rows(&j);
    vs_journal_head_manifest(&j.head, &counts, false, NULL, &manifest);
    FUZZ_HOLDS(!vs_journal_head_differs(&j.head, &j.head));
    vs_text_free(&manifest);
  }
  vs_journal_close(&j);
  if (size % 8) return;
  status = vs_journal_open(&j, fuzz_folder(), true, &err);
  fuzz_judge(status, &err);
  vs_journal_close(&j);
}

/* The line "SUM KIND TEXT" gets the sum of what stands behind it. A shorter one stays as it is. */
static void mend_line(char *line, size_t length) {
  char sum[9];
  if (length < 10) return;
  snprintf(sum, sizeof sum, "%08x", (unsigned)vs_hash_crc32(line + 9, length - 9));
  memcpy(line, sum, 8);
  line[8] = ' ';
}

static size_t mend(char *text, size_t size, size_t most) {
  (void)most;
  for (char *line = text, *end = text + size; line < end;) {
    char *stop = memchr(line, '\n', (size_t)(end - line));
    if (!stop) stop = end;
    mend_line(line, (size_t)(stop - line));
    line = stop + 1;
  }
  return size;
}

const fuzz_target fuzz_journal = {"journal", take, NULL, mend};
