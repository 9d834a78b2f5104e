/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/merge.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/path.h"
#include "cleanup.h"
#include "judge.h"
#include "publish.h"
#include "workers/journal.h"
#include "workers/journal_head.h"
#include "workers/platform.h"
#include "workers/row_shape.h"

/* ---- which ---- */

static bool read_task_number(const char *text, uint64_t *value) {
  char *end;
  if (!text || *text < '0' || *text > '9') return false;
  *value = strtoull(text, &end, 10);
  return !*end;
}

/* Slurm numbers the tasks of an array MIN, MIN + STEP, ..., COUNT of them. */
static vs_status read_slurm(uint64_t *shard, uint64_t *shards, vs_error *err) {
  uint64_t id, min = 0, step = 1;
  if (!read_task_number(getenv("SLURM_ARRAY_TASK_ID"), &id) ||
      !read_task_number(getenv("SLURM_ARRAY_TASK_COUNT"), shards) ||
      !read_task_number(getenv("SLURM_ARRAY_TASK_MIN"), &min))
    return vs_fail(err, VS_INPUT,
                   "--shard auto: wants the variables of a Slurm job array (SLURM_ARRAY_TASK_ID, "
                   "_COUNT, _MIN); without one write --shard I/N");
  read_task_number(getenv("SLURM_ARRAY_TASK_STEP"), &step);
  *shard = id < min || !step || (id - min) % step ? 0 : (id - min) / step + 1;
  return VS_OK;
}

vs_status vs_merge_shard_read(const char *text, uint64_t *shard, uint64_t *shards, vs_error *err) {
  vs_status status = VS_OK;
  const char *slash = strchr(text, '/');
  char first[32];
  snprintf(first, sizeof first, "%.*s", slash ? (int)(slash - text) : 0, text);
  if (!strcmp(text, "auto"))
    status = read_slurm(shard, shards, err);
  else if (!slash || !read_task_number(first, shard) || !read_task_number(slash + 1, shards))
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
  all->item = vs_alloc_grow(all->item, all->count, sizeof *all->item);
  return vs_journal_open(&all->item[all->count++], folder, false, err);
}

/* Opens the journal in the folder, or else those in the folders it holds. */
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

/* Returns the first of the shard's cases that has no row; head.cases: all have one. */
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
    char one[160], other[160];
    if (strcmp(h->identity, first->head.identity) != 0 &&
        vs_journal_head_programs(h, &first->head, one, other, sizeof one))
      return vs_fail(err, VS_INPUT,
                     "%s: was made by %s, and %s by %s; rows of two programs are not mixed",
                     j->path, one, first->path, other);
    if (!is_same_study(h, &first->head))
      return vs_fail_at(err, (vs_where){j->path, 1, 1}, "is of another study than %s", first->path);
    if (k && h->shard == all->item[k - 1].head.shard)
      return vs_fail_at(err, (vs_where){j->path, 1, 1}, "is shard %llu, as %s is",
                        (unsigned long long)h->shard, all->item[k - 1].path);
    if (h->shard != k + 1)
      return vs_fail(err, VS_INPUT, "merge: shard %zu of %llu is missing; name its folder, too",
                     k + 1, (unsigned long long)h->shards);
    uint64_t gap = first_gap(j);
    if (gap < h->cases)
      return vs_fail_at(err, (vs_where){j->path, 1, 1},
                        "case %llu is missing; study --resume goes on there",
                        (unsigned long long)gap);
  }
  if (all->count < first->head.shards)
    return vs_fail(err, VS_INPUT, "merge: shard %zu of %llu is missing; name its folder, too",
                   all->count + 1, (unsigned long long)first->head.shards);
  if (!first->head.cases)
    return vs_fail_at(err, (vs_where){first->path, 1, 1}, "is of a study that has no shards");
  return VS_OK;
}

static vs_status say_merged(const vs_journals *all, const vs_judge *judge,
                            const vs_merge_options *o, const char *folder, vs_error *err) {
  const vs_journal_head_counts counts = vs_publish_count(all);
  const unsigned long long done = counts.done, failed = counts.failed, violated = counts.violated;
  if (!o->quiet)
    printf("shards %zu\ncases  %llu done, %llu failed, in %llu a rating is violated or undecided\n"
           "written: %s in %s\n",
           (size_t)all->count, done, failed, violated, o->format->written, folder);
  if (!o->quiet) vs_judge_say(judge, all->cases, stdout);
  if (!o->quiet) vs_publish_warn(all);
  const vs_status judged = vs_judge_result(judge, err);
  if (judged) return judged;
  if (failed)
    return vs_fail(err, VS_RUN, "%llu of %llu cases failed; why stands in %s/failures.csv", failed,
                   done + failed, folder);
  return violated ? vs_judge_ratings(all, err) : VS_OK;
}

static vs_status write_merged(const shards *all, const vs_merge_options *o, const char *folder,
                              vs_error *err) {
  int made;
  const vs_journal_head *head = &all->item[0].head;
  vs_text bits = {0}, more = {0};
  for (size_t k = 0; k < all->count; k++) vs_platform_add(&bits, all->item[k].bits.text);
  vs_json json = vs_json_inside(&more);
  vs_judge judge;
  vs_journals journals = {all->item, all->count, head->cases, NULL};
  vs_status status = vs_judge_find(&journals, UINT64_MAX, &judge, err);
  vs_judge_json(&judge, &json);
  vs_platform_json(&bits, &json);
  journals.more = more.text;
  vs_row_shape *shape = vs_row_shape_new(head->columns, head->failures, head->manifest_end);
  if (vs_platform_differ(&bits) && !o->quiet) vs_platform_warn(&bits, shape, folder);
  vs_row_shape_free(shape);
  if (!status) status = vs_file_folder_make(folder, &made, err);
  if (!status) {
    status = vs_publish_write(&journals, o->format, folder, err);
    if (status) vs_file_folder_unmake(folder, made);
  }
  vs_text_free(&bits);
  vs_text_free(&more);
  if (!status) status = say_merged(&journals, &judge, o, folder, err);
  vs_judge_free(&judge);
  return status;
}

/* True if the manifest says what these shards' does, except for the counts. */
static bool is_manifest_of(const char *manifest, const vs_journal_head *head) {
  size_t n = strlen(head->manifest_begin);
  return !strncmp(manifest, head->manifest_begin, n) &&
         strstr(manifest + n, head->manifest_end) != NULL;
}

/* Does the folder hold another study's journal, or one that cannot be read? */
static bool has_other_journal(const char *folder, const vs_journal_head *head) {
  vs_journal j;
  if (!vs_journal_exists(folder)) return false;
  bool other = !vs_journal_peek(&j, folder) || !is_same_study(&j.head, head);
  vs_journal_close(&j);
  return other;
}

/* Does it hold another study's manifest, or a result of which nobody knows whose it is? Beside the
 * shards' own journal a study was broken off as it wrote its result; and so was an earlier merge
 * that has left these same rows without a manifest. */
static bool has_other_result(const char *folder, const vs_journals *all) {
  const vs_journal_head *head = &all->item[0].head;
  char path[VS_PATH_SIZE + 16], *line = NULL;
  size_t size = 0;
  vs_text manifest = {0};
  snprintf(path, sizeof path, "%.4000s/manifest.json", folder);
  vs_error none = {0};
  if (vs_path_check_result(path, &none)) return true;
  FILE *f = fopen(path, "r");
  if (!f)
    return vs_publish_found(folder) && !vs_journal_exists(folder) &&
           !vs_publish_was_begun(all, folder);
  while (vs_alloc_line(&line, &size, f) > 0) vs_text_add(&manifest, "%s", line);
  bool same = manifest.length && is_manifest_of(manifest.text, head);
  vs_text_free(&manifest);
  free(line);
  fclose(f);
  return !same;
}

/* What the folder holds of another study. A result of these same shards may be replaced. */
typedef struct others {
  bool journal, result;
} others;

static others find_others(const char *folder, const shards *all) {
  const vs_journals journals = {all->item, all->count, all->item[0].head.cases, NULL};
  return (others){has_other_journal(folder, &all->item[0].head),
                  has_other_result(folder, &journals)};
}

/* Removes another study's journal, and what else it left there but its result, which is replaced.
 */
static vs_status remove_others(const char *folder, const others *o, vs_error *err) {
  vs_journal old;
  const bool known = vs_journal_peek(&old, folder);
  vs_status status = o->journal ? vs_journal_remove(folder, err) : VS_OK;
  if (!status) vs_cleanup_folder(folder, known && o->journal ? &old : NULL);
  vs_journal_close(&old);
  return status;
}

static vs_status check_free(const char *folder, const others *o, vs_error *err) {
  const char *name = o->journal ? "journal" : o->result ? vs_publish_found(folder) : NULL;
  return name ? vs_fail(err, VS_INPUT,
                        "%s/%s: is of another study than the shards; --overwrite replaces it, or "
                        "take another folder",
                        folder, name)
              : VS_OK;
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
  others other = {0};
  if (!status) other = find_others(folder, &all);
  if (!status && !o->overwrite) status = check_free(folder, &other, err);
  if (!status) status = vs_publish_check(folder, o->format, err);
  if (!status && (other.journal || other.result)) status = remove_others(folder, &other, err);
  if (!status) status = write_merged(&all, o, folder, err);
  for (size_t k = 0; k < all.count; k++) vs_journal_close(&all.item[k]);
  free(all.item);
  return status;
}
