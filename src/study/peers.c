/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "peers.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The status of a row, which is its last cell. */
static int status_of(const char *row, bool failed) {
  const char *last = strrchr(row, ',');
  return failed ? 1 : last ? atoi(last + 1) : 0;
}

static vs_status take_rows(vs_journal *own, const vs_journal *other, uint64_t first, uint64_t until,
                           vs_error *err) {
  vs_text row = {0};
  vs_status status = VS_OK;
  for (uint64_t k = first; k < until && !status; k++) {
    bool failed = false;
    if (vs_journal_has(own, k) || !vs_journal_has(other, k)) continue;
    row.length = 0;
    status = vs_journal_row(other, k, &row, &failed, err);
    if (!status)
      status = vs_journal_add(own, k, status_of(row.text, failed), row.text, row.length, err);
  }
  vs_text_free(&row);
  return status;
}

vs_status vs_peers_take(const char *folder, vs_journal *own, uint64_t first, uint64_t until,
                        uint64_t *missing, vs_error *err) {
  struct dirent **entries;
  char path[2 * VS_PATH_SIZE];
  vs_status status = VS_OK;
  snprintf(path, sizeof path, "%.4000s/..", folder);
  const int n = scandir(path, &entries, NULL, alphasort);
  for (int k = 0; k < n; k++) {
    vs_journal other;
    snprintf(path, sizeof path, "%.4000s/../%s", folder, entries[k]->d_name);
    if (!status && entries[k]->d_name[0] != '.' && vs_journal_peek(&other, path)) {
      if (!strcmp(other.head.identity, own->head.identity) && other.head.shards == 1)
        status = take_rows(own, &other, first, until, err);
      vs_journal_close(&other);
    }
    free(entries[k]);
  }
  if (n >= 0) free(entries);
  *missing = 0;
  for (uint64_t k = first; k < until; k++) *missing += !vs_journal_has(own, k);
  return status ? status : vs_journal_flush(own, true, err);
}
