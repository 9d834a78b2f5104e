/* SPDX-License-Identifier: GPL-3.0-or-later
 * Shards: which part of a study one process does, and how the parts become one. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "batch/stale.h"
#include "batch/study.h"

/* ---- which ---- */

static bool number(const char *text, uint64_t *value) {
  char *end;
  if (!text || *text < '0' || *text > '9') return false;
  *value = strtoull(text, &end, 10);
  return !*end;
}

/* Slurm numbers the tasks of an array MIN, MIN + STEP, ..., COUNT of them. */
static vs_status read_slurm(uint64_t *shard, uint64_t *shards, vs_error *err) {
  uint64_t id, min = 0, step = 1;
  if (!number(getenv("SLURM_ARRAY_TASK_ID"), &id) ||
      !number(getenv("SLURM_ARRAY_TASK_COUNT"), shards) ||
      !number(getenv("SLURM_ARRAY_TASK_MIN"), &min))
    return vs_fail(err, VS_INPUT,
                   "--shard auto: wants the variables of a Slurm job array (SLURM_ARRAY_TASK_ID, "
                   "_COUNT, _MIN); without one write --shard I/N");
  number(getenv("SLURM_ARRAY_TASK_STEP"), &step);
  *shard = id < min || !step || (id - min) % step ? 0 : (id - min) / step + 1;
  return VS_OK;
}

vs_status vs_shard_read(const char *text, uint64_t *shard, uint64_t *shards, vs_error *err) {
  vs_status status = VS_OK;
  const char *slash = strchr(text, '/');
  char first[32];
  snprintf(first, sizeof first, "%.*s", slash ? (int)(slash - text) : 0, text);
  if (!strcmp(text, "auto"))
    status = read_slurm(shard, shards, err);
  else if (!slash || !number(first, shard) || !number(slash + 1, shards))
    *shard = 0;
  if (!status && (!*shard || *shard > *shards || *shards > VS_MOST_SHARDS))
    status =
        vs_fail(err, VS_INPUT, "--shard %s: I/N is wanted, from 1/N to N/N, N at most %d; or auto",
                text, VS_MOST_SHARDS);
  return status;
}

/* ---- merge ---- */

typedef struct shards {
  vs_journal *item;
  size_t count;
} shards;

static vs_status take_folder(shards *all, const char *folder, vs_error *err) {
  all->item = realloc(all->item, (all->count + 1) * sizeof *all->item);
  if (!all->item) abort();
  return vs_journal_open(&all->item[all->count++], folder, false, err);
}

/* A folder of a shard, or one that holds such folders. */
static vs_status take_folders(shards *all, const char *folder, vs_error *err) {
  struct dirent **entries;
  char path[2 * VS_PATH_SIZE];
  vs_status status = VS_OK;
  size_t before = all->count;
  int n = scandir(folder, &entries, NULL, alphasort);
  for (int k = 0; k < n; k++) {
    snprintf(path, sizeof path, "%.4000s/%s", folder, entries[k]->d_name);
    bool inner = strcmp(entries[k]->d_name, ".") && strcmp(entries[k]->d_name, "..");
    if (!status && inner && vs_journal_exists(path)) status = take_folder(all, path, err);
    free(entries[k]);
  }
  if (n >= 0) free(entries);
  if (status || all->count > before) return status;
  return take_folder(all, folder, err);
}

static int by_shard(const void *a, const void *b) {
  const vs_journal *x = a, *y = b;
  return x->head.shard < y->head.shard ? -1 : x->head.shard > y->head.shard;
}

/* The first case of the shard's own that has no row; cases: none. */
static uint64_t first_gap(const vs_journal *j) {
  uint64_t k = j->head.shard - 1;
  while (k < j->head.cases && vs_journal_has(j, k)) k += j->head.shards;
  return k < j->head.cases ? k : j->head.cases;
}

static bool is_same_study(const vs_journal_head *a, const vs_journal_head *b) {
  return !strcmp(a->identity, b->identity) && !strcmp(a->columns, b->columns) &&
         !strcmp(a->failures, b->failures) && a->cases == b->cases && a->shards == b->shards;
}

static vs_status check_shards(const shards *all, vs_error *err) {
  const vs_journal *first = &all->item[0];
  for (size_t k = 0; k < all->count; k++) {
    const vs_journal *j = &all->item[k];
    const vs_journal_head *h = &j->head;
    if (!is_same_study(h, &first->head))
      return vs_fail(err, VS_INPUT, "%s: is of another study than %s", j->path, first->path);
    if (k && h->shard == all->item[k - 1].head.shard)
      return vs_fail(err, VS_INPUT, "%s: is shard %llu, as %s is", j->path,
                     (unsigned long long)h->shard, all->item[k - 1].path);
    if (h->shard != k + 1)
      return vs_fail(err, VS_INPUT, "shard %zu of %llu is missing", k + 1,
                     (unsigned long long)h->shards);
    uint64_t gap = first_gap(j);
    if (gap < h->cases)
      return vs_fail(err, VS_INPUT, "%s: case %llu is missing; study --resume goes on there",
                     j->path, (unsigned long long)gap);
  }
  if (all->count < first->head.shards)
    return vs_fail(err, VS_INPUT, "shard %zu of %llu is missing", all->count + 1,
                   (unsigned long long)first->head.shards);
  if (!first->head.cases)
    return vs_fail(err, VS_INPUT, "%s: is of a study that has no shards", first->path);
  return VS_OK;
}

/* other: the folder holds another study's result. */
static vs_status write_merged(const shards *all, const char *folder, bool other, bool quiet,
                              vs_error *err) {
  int made;
  uint64_t done = 0, failed = 0, violated = 0;
  const vs_journals journals = {all->item, all->count, all->item[0].head.cases, NULL};
  vs_status status = vs_folder_make(folder, &made, err);
  if (status) return status;
  if (other) vs_stale_remove(folder);
  status = vs_journals_write(&journals, folder, err);
  if (status) vs_folder_unmake(folder, made);
  if (status) return status;
  for (size_t k = 0; k < all->count; k++) {
    done += all->item[k].done;
    failed += all->item[k].failed;
    violated += all->item[k].violated;
  }
  if (!quiet)
    printf("shards %zu\ncases  %llu done, %llu failed, in %llu a rating is violated or undecided\n"
           "written: study.csv, failures.csv, manifest.json in %s\n",
           all->count, (unsigned long long)done, (unsigned long long)failed,
           (unsigned long long)violated, folder);
  if (failed)
    return vs_fail(err, VS_RUN, "%llu of %llu cases failed; why stands in %s/failures.csv",
                   (unsigned long long)failed, (unsigned long long)(done + failed), folder);
  return violated
             ? vs_fail(err, VS_RATING, "a rating is violated or undecided in %llu of %llu cases",
                       (unsigned long long)violated, (unsigned long long)(done + failed))
             : VS_OK;
}

/* Does the manifest there say what these shards' does, but for the counts? */
static bool is_of(const char *manifest, const vs_journal_head *head) {
  size_t n = strlen(head->manifest_begin);
  return !strncmp(manifest, head->manifest_begin, n) &&
         strstr(manifest + n, head->manifest_end) != NULL;
}

/* Another study's result is not replaced unasked; that of these shards is what merge is for. */
static vs_status check_free(const char *folder, const vs_journal_head *head, vs_error *err) {
  char path[VS_PATH_SIZE + 16], *manifest = NULL;
  size_t size = 0;
  snprintf(path, sizeof path, "%.4000s/manifest.json", folder);
  FILE *f = fopen(path, "r");
  if (!f) return VS_OK;
  bool same = getdelim(&manifest, &size, '\0', f) > 0 && is_of(manifest, head);
  free(manifest);
  fclose(f);
  return same ? VS_OK
              : vs_fail(err, VS_INPUT,
                        "%s: is of another study than the shards; --overwrite replaces it, or take "
                        "another folder",
                        path);
}

vs_status vs_merge_command(const vs_merge_options *o, vs_error *err) {
  shards all = {0};
  vs_status status = VS_OK;
  for (size_t k = 0; k < o->count && !status; k++) status = take_folders(&all, o->folders[k], err);
  if (!status && !o->folder && o->count != 1)
    status = vs_fail(err, VS_INPUT,
                     "merge: more than one folder; name where the result goes with "
                     "-o DIR");
  const char *folder = o->folder ? o->folder : o->folders[0];
  if (!status) qsort(all.item, all.count, sizeof *all.item, by_shard);
  if (!status) status = check_shards(&all, err);
  vs_error taken = {0};
  bool other = !status && check_free(folder, &all.item[0].head, &taken);
  if (other && !o->overwrite) status = vs_fail(err, VS_INPUT, "%s", taken.text);
  if (!status) status = write_merged(&all, folder, other, o->quiet, err);
  for (size_t k = 0; k < all.count; k++) vs_journal_close(&all.item[k]);
  free(all.item);
  return status;
}
