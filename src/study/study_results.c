/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study_results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- names and how often ---- */

static void count_name(vs_counts *c, const char *name) {
  size_t k = 0;
  while (k < c->count && strcmp(c->item[k].name, name)) k++;
  if (k == c->count && k == VS_COUNTS)
    k = VS_COUNTS - 1;
  else if (k == c->count)
    c->item[c->count++].name = vs_copy(k == VS_COUNTS - 1 ? "others" : name);
  c->item[k].times++;
}

static int by_times(const void *a, const void *b) {
  const vs_count *one = a, *other = b;
  if (one->times != other->times) return one->times < other->times ? 1 : -1;
  return strcmp(one->name, other->name);
}

static void counts_free(vs_counts *c) {
  for (size_t k = 0; k < c->count; k++) free(c->item[k].name);
  c->count = 0;
}

/* ---- cases kept ---- */

void vs_study_results_keep(vs_kept *kept, size_t *count, size_t most, double key,
                           const vs_folder_row *row) {
  if (*count == most && !(key < kept[most - 1].key)) return;
  if (*count == most) vs_study_results_kept_free(&kept[--*count], 1, row->count);
  size_t k = (*count)++;
  for (; k > 0 && key < kept[k - 1].key; k--) kept[k] = kept[k - 1];
  kept[k] = (vs_kept){key, vs_alloc(row->count, sizeof(char *))};
  for (size_t c = 0; c < row->count; c++) kept[k].cell[c] = vs_copy(row->cell[c]);
}

void vs_study_results_kept_free(vs_kept *kept, size_t count, size_t cells) {
  for (size_t k = 0; k < count; k++) {
    for (size_t c = 0; c < cells; c++) free(kept[k].cell[c]);
    free(kept[k].cell);
    kept[k].cell = NULL;
  }
}

/* ---- what a column holds ---- */

/* Returns where value stands, or would stand, among the rising ones. */
static size_t place_of_value(const vs_profile *p, double value) {
  size_t low = 0, high = p->count;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (p->value[middle] < value)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void note_value(vs_profile *p, double value) {
  if (p->many) return;
  size_t k = place_of_value(p, value);
  if (k < p->count && p->value[k] == value) return;
  if (p->count == VS_DISTINCT) {
    p->many = true;
    return;
  }
  if (!p->value) p->value = vs_alloc(VS_DISTINCT, sizeof *p->value);
  memmove(p->value + k + 1, p->value + k, (p->count - k) * sizeof *p->value);
  p->value[k] = value;
  p->count++;
}

static void note_word(vs_profile *p, const char *word) {
  for (size_t k = 0; k < p->count; k++)
    if (!strcmp(p->word[k], word)) return;
  if (p->count == VS_DISTINCT) {
    p->many = true;
    return;
  }
  if (!p->word) p->word = vs_alloc(VS_DISTINCT, sizeof *p->word);
  p->word[p->count++] = vs_copy(word);
}

/* Turns the numbers so far into words, as a column may hold "1, 2, once". */
static void turn_to_words(vs_profile *p) {
  char text[32];
  size_t n = p->count;
  p->is_number = false;
  p->count = 0;
  for (size_t k = 0; k < n && p->value; k++) {
    snprintf(text, sizeof text, "%.12g", p->value[k]);
    note_word(p, text);
  }
  free(p->value);
  p->value = NULL;
}

long vs_study_results_index(const vs_profile *p, const char *cell) {
  double value;
  if (p->many) return -1;
  if (p->is_number) {
    if (!vs_folder_number(cell, &value) || isnan(value)) return -1;
    size_t k = place_of_value(p, value);
    return k < p->count && p->value[k] == value ? (long)k : -1;
  }
  for (size_t k = 0; k < p->count; k++)
    if (!strcmp(p->word[k], cell)) return (long)k;
  return -1;
}

bool vs_study_results_ranked(const vs_folder *t, const vs_study_results *s) {
  bool largest;
  size_t aim = vs_folder_aim(t, &largest);
  return aim && s->profile[aim].known > 0;
}

vs_extent vs_study_results_extent(const vs_profile *p) {
  return (vs_extent){p->least, p->largest, p->many ? NULL : p->value, p->count};
}

/* True if the column holds names rather than numbers. */
static bool holds_names(const vs_folder_column *column) {
  return vs_folder_kinds[column->role].cells == VS_CELLS_TEXT;
}

/* ---- the one reading ---- */

typedef struct reader {
  const vs_folder *t;
  vs_study_results *s;
  size_t aim; /* see vs_folder_aim */
  bool largest;
  long found;
} reader;

static vs_status note_cell(const reader *r, size_t c, const vs_folder_row *row, vs_error *err) {
  const vs_folder_column *column = &r->t->column[c];
  vs_profile *p = &r->s->profile[c];
  bool axis = column->role == VS_ROLE_AXIS;
  double value = NAN;
  if (!p->is_number) {
    note_word(p, row->cell[c]);
    return VS_OK;
  }
  if (!vs_folder_number(row->cell[c], &value)) {
    if (!axis || *column->unit)
      return vs_fail_at(err, (vs_where){r->t->path, (int)row->line, 1}, "%s: '%s' is no number",
                        column->title, row->cell[c]);
    turn_to_words(p);
    note_word(p, row->cell[c]);
    return VS_OK;
  }
  if (isnan(value)) return VS_OK;
  p->known++;
  p->least = fmin(p->least, value); /* fmin and fmax pass over the NaN that it is at first */
  p->largest = fmax(p->largest, value);
  if (axis) note_value(p, value);
  return VS_OK;
}

/* Counts each entry of the cell "WHAT of DEVICE at ... | WHAT of DEVICE did not happen, ...". */
static void note_happened(vs_study_results *s, const char *cell) {
  for (const char *entry = cell, *end; *entry; entry = *end ? end + 3 : end) {
    end = strstr(entry, " | ");
    if (!end) end = entry + strlen(entry);
    char name[160];
    snprintf(name, sizeof name, "%.*s", (int)(end - entry), entry);
    char *at = strstr(name, " at ");
    if (at) *at = '\0';
    count_name(&s->happened, name);
  }
}

/* Counts how the case ended, and how sure that is. */
static void note_verdict(vs_study_results *s, const vs_folder *t, const vs_folder_row *row,
                         double margin) {
  double error = NAN, rung = 0;
  bool breach = !strcmp(row->cell[t->status], "3");
  if (t->error >= 0) vs_folder_number(row->cell[t->error], &error);
  if (t->rung >= 0) vs_folder_number(row->cell[t->rung], &rung);
  bool sure = margin < 0 && !(fabs(margin) <= error);
  s->judged += !isnan(margin) || breach; /* what a rating names may have no value */
  s->good += !isnan(margin) && margin >= 0 && !breach;
  s->violated += breach && sure;
  s->undecided += breach && !sure;
  /* nothing is violated there, so that the line of the least margin less its error is undecided */
  if (breach && !sure && t->weakest >= 0 && *row->cell[t->weakest])
    count_name(&s->doubtful, row->cell[t->weakest]);
  s->unverified += !isnan(margin) && isnan(error);
  s->climbed += rung > 0;
  s->warned += t->warnings >= 0 && *row->cell[t->warnings];
  if (t->happened >= 0) note_happened(s, row->cell[t->happened]);
  if (t->not_judged >= 0 && *row->cell[t->not_judged])
    count_name(&s->not_judged, row->cell[t->not_judged]);
}

static vs_status note_row(void *ctx, const vs_folder_row *row, vs_error *err) {
  const reader *r = ctx;
  const vs_folder *t = r->t;
  vs_study_results *s = r->s;
  double margin = NAN;
  vs_status status = VS_OK;
  for (size_t c = 1; c < t->count && !status; c++)
    if (!holds_names(&t->column[c])) status = note_cell(r, c, row, err);
  if (status) return status;
  s->rows++;
  if (t->margin >= 0) vs_folder_number(row->cell[t->margin], &margin);
  note_verdict(s, t, row, margin);
  if (!isnan(margin)) {
    size_t kept = s->best.cell != NULL;
    if (t->weakest >= 0 && *row->cell[t->weakest]) count_name(&s->weakest, row->cell[t->weakest]);
    vs_study_results_keep(&s->best, &kept, 1, -margin, row);
  }
  if (row->number == r->found) {
    size_t none = 0;
    vs_study_results_keep(&s->found, &none, 1, 0, row);
  }
  double key = NAN;
  if (r->aim) vs_folder_number(row->cell[r->aim], &key);
  if (r->largest) key = -key;
  vs_study_results_keep(s->worst, &s->n_worst, VS_WORST, isnan(key) ? INFINITY : key, row);
  return VS_OK;
}

static vs_status note_failure(void *ctx, const vs_folder_row *row, vs_error *err) {
  vs_study_results *s = ctx;
  (void)err;
  s->failures++;
  count_name(&s->why, row->cell[row->count - 1]);
  return VS_OK;
}

vs_status vs_study_results_take(const vs_folder *t, vs_study_results *s, vs_error *err) {
  *s = (vs_study_results){0};
  for (size_t c = 0; c < t->count; c++)
    s->profile[c] =
        (vs_profile){.is_number = !holds_names(&t->column[c]), .least = NAN, .largest = NAN};
  reader r = {.t = t, .s = s};
  r.aim = vs_folder_aim(t, &r.largest);
  r.found = vs_folder_found(t);
  vs_status status = vs_folder_each(t, note_row, &r, err);
  if (!status) status = vs_folder_each_failure(t, note_failure, s, err);
  if (!status && s->rows != t->done)
    status = vs_fail_at(err, (vs_where){t->path, 1, 1}, "rows: %ld; cases done, says %s: %ld",
                        s->rows, t->manifest_path, t->done);
  qsort(s->doubtful.item, s->doubtful.count, sizeof *s->doubtful.item, by_times);
  qsort(s->happened.item, s->happened.count, sizeof *s->happened.item, by_times);
  qsort(s->not_judged.item, s->not_judged.count, sizeof *s->not_judged.item, by_times);
  qsort(s->weakest.item, s->weakest.count, sizeof *s->weakest.item, by_times);
  qsort(s->why.item, s->why.count, sizeof *s->why.item, by_times);
  return status;
}

void vs_study_results_free(const vs_folder *t, vs_study_results *s) {
  for (size_t c = 0; c < t->count; c++) {
    vs_profile *p = &s->profile[c];
    for (size_t k = 0; p->word && k < p->count; k++) free(p->word[k]);
    free(p->word);
    free(p->value);
  }
  vs_study_results_kept_free(s->worst, s->n_worst, t->count);
  if (s->best.cell) vs_study_results_kept_free(&s->best, 1, t->count);
  if (s->found.cell) vs_study_results_kept_free(&s->found, 1, t->count);
  counts_free(&s->doubtful);
  counts_free(&s->happened);
  counts_free(&s->not_judged);
  counts_free(&s->weakest);
  counts_free(&s->why);
}
