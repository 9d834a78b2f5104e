/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "judge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/csv.h"
#include "run/session.h"
#include "study/hold.h"
#include "study/random.h"

/* ---- which studies ---- */

bool vs_judge_applies(const vs_plan *plan) {
  const vs_tier *tier = plan->first->tier;
  return tier->has_circuit && !tier->by_ngspice;
}

vs_status vs_judge_check(const vs_plan *plan, vs_error *err) {
  static const char *const KEYS[] = {"run.tier", "run.tolerance"};
  for (size_t k = 0; k < plan->n_axes && vs_judge_applies(plan); k++)
    for (size_t n = 0; n < sizeof KEYS / sizeof *KEYS; n++)
      if (!strcmp(plan->axes[k].key, KEYS[n]))
        return vs_fail_at(err, plan->axes[k].where,
                          "%s is an axis: the cases of a study on tier %s are judged by runs that "
                          "have another one; leave it out, or take tier %s",
                          KEYS[n], plan->first->tier->name, vs_tiers_circuit());
  return VS_OK;
}

/* The head's only member of this name; merge reads the tolerance back. */
static const char BEGINS[] = "\"judged_by\": {\"solver\": \"ngspice\", \"tolerance\": ";

void vs_judge_begin_json(const vs_plan *plan, vs_json *json) {
  if (!vs_judge_applies(plan)) return;
  vs_json_object(json, "judged_by", VS_JSON_ROW);
  vs_json_text(json, "solver", "ngspice");
  vs_json_number(json, "tolerance", plan->first->setup.run.tolerance, 12);
  vs_json_end(json);
}

/* NaN: the study is not judged. */
static double tolerance_of(const vs_journal_head *head) {
  const char *at = strstr(head->manifest_begin, BEGINS);
  return at ? strtod(at + strlen(BEGINS), NULL) : NAN;
}

vs_plan vs_judge_plan(const vs_plan *plan, int way, vs_judge_way *room) {
  vs_plan other = *plan;
  const double tolerance = vs_session_other_tolerance(plan->first->setup.run.tolerance);
  size_t n = 0;
  if (way != VS_JUDGE_OWN_OTHER)
    snprintf(room->key[n++], sizeof room->key[0], "run.tier=%s", vs_tiers_circuit());
  if (way != VS_JUDGE_NGSPICE)
    snprintf(room->key[n++], sizeof room->key[0], "run.tolerance=%.9g", tolerance);
  room->sets = vs_alloc(plan->n_sets + n, sizeof *room->sets);
  if (plan->n_sets) memcpy(room->sets, plan->sets, plan->n_sets * sizeof *room->sets);
  for (size_t k = 0; k < n; k++) room->sets[plan->n_sets + k] = room->key[k];
  other.sets = room->sets;
  other.n_sets += n;
  return other;
}

/* ---- which cases ---- */

static const vs_journal *journal_of(const vs_journals *all, uint64_t index) {
  return &all->item[all->count > 1 ? index % all->count : 0];
}

enum { SHARE = 100, LEAST = 3 };

static uint64_t count_of_sample(uint64_t cases) {
  const uint64_t n = (cases + SHARE - 1) / SHARE;
  return n < LEAST ? (cases < LEAST ? cases : LEAST) : n;
}

/* Adds a case, unless it is there already, has no row yet, or has failed. */
static vs_status pick(const vs_journals *all, uint64_t index, vs_judge *judge, vs_error *err) {
  const vs_journal *j = index < all->cases ? journal_of(all, index) : NULL;
  bool failed = false;
  if (!j || !vs_journal_had(j, index) || !vs_journal_has(j, index)) return VS_OK;
  size_t at = 0;
  while (at < judge->count && judge->picked[at] < index) at++;
  if (at < judge->count && judge->picked[at] == index) return VS_OK;
  vs_text row = {0};
  vs_status status = vs_journal_row(j, index, &row, &failed, err);
  vs_text_free(&row);
  if (status || failed) return status;
  judge->picked = vs_alloc_grow(judge->picked, judge->count, sizeof *judge->picked);
  memmove(judge->picked + at + 1, judge->picked + at, (judge->count - at) * sizeof *judge->picked);
  judge->picked[at] = index;
  judge->count++;
  return VS_OK;
}

/* Adds one from each of n stretches of the cases. Where so many of these failed, or are another
 * shard's, that fewer than LEAST are left, it adds more until they are as many: those of a whole
 * study are the first of one of its shards. */
static vs_status pick_sample(const vs_journals *all, uint64_t seed, uint64_t n, vs_judge *judge,
                             vs_error *err) {
  const uint64_t cases = all->cases;
  vs_status status = VS_OK;
  for (uint64_t k = 0; k < n && !status; k++) {
    const uint64_t from = k * cases / n, to = (k + 1) * cases / n;
    status = pick(all, from + vs_random_bits(seed, k, cases) % (to - from), judge, err);
  }
  const uint64_t first = cases ? vs_random_bits(seed, n, cases) % cases : 0;
  for (uint64_t k = 0; k < cases && judge->count < LEAST && !status; k++)
    status = pick(all, (first + k) % cases, judge, err);
  return status;
}

static double number_of(const char *cell) {
  return *cell ? strtod(cell, NULL) : NAN;
}

/* The column of that role; SIZE_MAX: there is none. */
static size_t column_of(const vs_row_shape *shape, vs_folder_role role) {
  for (size_t k = 0; k < vs_row_shape_columns(shape); k++)
    if (vs_row_shape_column_at(shape, k).role == role) return k;
  return SIZE_MAX;
}

/* The case with the least margin; UINT64_MAX: none has a margin. */
static vs_status find_worst(const vs_journals *all, const vs_row_shape *shape, uint64_t *worst,
                            vs_error *err) {
  const size_t columns = vs_row_shape_columns(shape), margin = column_of(shape, VS_ROLE_MARGIN);
  char **cell = vs_alloc(columns, sizeof *cell);
  double least = INFINITY;
  vs_text row = {0};
  vs_status status = VS_OK;
  *worst = UINT64_MAX;
  for (uint64_t k = 0; k < all->cases && !status; k++) {
    const vs_journal *j = journal_of(all, k);
    bool failed = false;
    if (!vs_journal_had(j, k) || !vs_journal_has(j, k)) continue;
    status = vs_journal_row(j, k, &row, &failed, err);
    if (status || failed || vs_csv_split(row.text, cell, columns, NULL) <= margin) continue;
    if (!(number_of(cell[margin]) < least)) continue;
    least = number_of(cell[margin]);
    *worst = k;
  }
  vs_text_free(&row);
  free(cell);
  return status;
}

static vs_row_shape *shape_of(const vs_journals *all) {
  const vs_journal_head *h = &all->item[0].head;
  return vs_row_shape_new(h->columns, h->failures, h->manifest_end);
}

vs_status vs_judge_pick(const vs_journals *all, uint64_t found, vs_judge *judge, vs_error *err) {
  *judge = (vs_judge){0};
  char digits[16];
  snprintf(digits, sizeof digits, "%.15s", all->item[0].head.identity);
  const uint64_t seed = strtoull(digits, NULL, 16), n = count_of_sample(all->cases);
  vs_row_shape *shape = shape_of(all);
  uint64_t worst;
  vs_status status = find_worst(all, shape, &worst, err);
  if (!status) status = pick_sample(all, seed, n, judge, err);
  if (!status) status = pick(all, worst, judge, err);
  if (!status) status = pick(all, found, judge, err);
  vs_row_shape_free(shape);
  return status;
}

/* ---- compared ---- */

/* The rows of a case: its own, and those that judge it. */
enum { OWN = VS_JUDGE_WAYS, ROWS };
typedef struct judged_rows {
  vs_text text[ROWS];
  char **cell[ROWS]; /* NULL: it failed there */
} judged_rows;

static vs_status read_rows(const vs_journals *all, uint64_t index, size_t columns, judged_rows *r,
                           vs_judge *judge, vs_error *err) {
  const vs_journal *j = journal_of(all, index);
  vs_status status = VS_OK;
  bool unfinished = false;
  for (int way = 0; way < ROWS && !status; way++) {
    bool failed = false;
    if (way != OWN && !vs_journal_has_judged(j, index, way))
      return vs_fail_at(err, (vs_where){j->path, 1, 1},
                        "case %llu is not judged yet; study --resume goes on there",
                        (unsigned long long)index);
    status = way == OWN ? vs_journal_row(j, index, &r->text[way], &failed, err)
                        : vs_journal_judged_row(j, index, way, &r->text[way], &failed, err);
    if (status) return status;
    char **cell = vs_alloc(columns, sizeof *cell);
    const size_t n = vs_csv_split(r->text[way].text, cell, columns, NULL);
    if (!failed) {
      r->cell[way] = cell;
      continue;
    }
    if (!unfinished && judge->failed++ == 0) {
      judge->first_failed = index;
      snprintf(judge->why, sizeof judge->why, "%s", cell[n - 1]);
    }
    unfinished = true;
    free(cell);
  }
  return status;
}

static void free_rows(judged_rows *r) {
  for (int way = 0; way < ROWS; way++) {
    vs_text_free(&r->text[way]);
    free(r->cell[way]);
  }
}

/* The error of a cell on one tier, whose other row is at another tolerance. */
static double told_of(const judged_rows *r, int way, int other, size_t column, double resolution) {
  const double x = number_of(r->cell[way][column]), y = number_of(r->cell[other][column]);
  if (isnan(x) != isnan(y)) return INFINITY;
  return isnan(x) ? 0 : fabs(x - y) + resolution * fabs(x);
}

/* True for a rate over microseconds, which is known less well: "thyristor.dv_dt". */
static bool is_rate(const char *name) {
  return strstr(name, "_dt") != NULL;
}

/* False where both cells are empty. */
static bool compare_cells(const judged_rows *r, const vs_row_shape *shape, size_t column,
                          double tolerance, vs_judged_column *c) {
  const vs_row_shape_column of = vs_row_shape_column_at(shape, column);
  const size_t weakest = column_of(shape, VS_ROLE_WEAKEST);
  const bool margin = of.role == VS_ROLE_MARGIN;
  const char *name = margin ? r->cell[OWN][weakest] : of.name;
  const double resolution = vs_session_resolution(tolerance, is_rate(name));
  c->own = number_of(r->cell[OWN][column]);
  c->ngspice = number_of(r->cell[VS_JUDGE_NGSPICE][column]);
  if (isnan(c->own) && isnan(c->ngspice)) return false;
  c->difference = isnan(c->own) || isnan(c->ngspice) ? INFINITY : fabs(c->own - c->ngspice);
  c->told = told_of(r, OWN, VS_JUDGE_OWN_OTHER, column, resolution) +
            told_of(r, VS_JUDGE_NGSPICE, VS_JUDGE_NGSPICE_OTHER, column, resolution);
  if (margin) c->told += 2 * resolution; /* a margin is what a value leaves of 1 */
  return true;
}

/* How much of what is told the difference is. */
static double share_of(const vs_judged_column *c) {
  if (c->difference == 0 || isinf(c->told)) return 0;
  return c->told > 0 ? c->difference / c->told : INFINITY;
}

static void take_column(vs_judge *judge, const vs_judged_column *c) {
  size_t k = 0;
  while (k < judge->columns && strcmp(judge->column[k].name, c->name)) k++;
  if (k == judge->columns) {
    judge->column = vs_alloc_grow(judge->column, judge->columns, sizeof *judge->column);
    judge->column[judge->columns] = *c;
    judge->column[judge->columns++].name = vs_copy(c->name);
  } else if (c->difference > judge->column[k].difference) {
    char *name = judge->column[k].name;
    judge->column[k] = *c;
    judge->column[k].name = name;
  }
  if (judge->worst.name && share_of(c) <= share_of(&judge->worst)) return;
  judge->worst = *c;
  judge->worst.name = judge->column[k].name;
}

static void compare_case(vs_judge *judge, const judged_rows *r, uint64_t index,
                         const vs_row_shape *shape, double tolerance) {
  bool beyond = false;
  for (int way = 0; way < VS_JUDGE_WAYS; way++)
    if (!r->cell[way]) return;
  for (size_t k = 0; k < vs_row_shape_columns(shape); k++) {
    const vs_row_shape_column of = vs_row_shape_column_at(shape, k);
    char *name = vs_copy(of.name);
    vs_judged_column c = {.name = name, .index = index};
    if ((of.role == VS_ROLE_REPORT || of.role == VS_ROLE_MARGIN) &&
        compare_cells(r, shape, k, tolerance, &c)) {
      take_column(judge, &c);
      beyond = beyond || share_of(&c) > 1;
    }
    free(name);
  }
  judge->beyond += beyond;
}

vs_status vs_judge_find(const vs_journals *all, uint64_t found, vs_judge *judge, vs_error *err) {
  const double tolerance = tolerance_of(&all->item[0].head);
  *judge = (vs_judge){0};
  if (isnan(tolerance)) return VS_OK;
  vs_row_shape *shape = shape_of(all);
  vs_status status = vs_judge_pick(all, found, judge, err);
  for (size_t k = 0; k < judge->count && !status; k++) {
    judged_rows r = {0};
    status = read_rows(all, judge->picked[k], vs_row_shape_columns(shape), &r, judge, err);
    if (!status) compare_case(judge, &r, judge->picked[k], shape, tolerance);
    free_rows(&r);
  }
  vs_row_shape_free(shape);
  return status;
}

void vs_judge_free(vs_judge *judge) {
  for (size_t k = 0; k < judge->columns; k++) free(judge->column[k].name);
  free(judge->column);
  free(judge->picked);
  *judge = (vs_judge){0};
}

/* ---- told ---- */

void vs_judge_json(const vs_judge *judge, vs_json *json) {
  if (!judge->count) return;
  vs_json_object(json, "judged", VS_JSON_LINES);
  vs_json_array(json, "cases", VS_JSON_ROW);
  for (size_t k = 0; k < judge->count; k++) vs_json_whole(json, NULL, (int64_t)judge->picked[k]);
  vs_json_end(json);
  vs_json_whole(json, "beyond", (int64_t)judge->beyond);
  vs_json_whole(json, "failed", (int64_t)judge->failed);
  vs_json_array(json, "columns", VS_JSON_LINES);
  for (size_t k = 0; k < judge->columns; k++) {
    const vs_judged_column *c = &judge->column[k];
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_text(json, "column", c->name);
    vs_json_whole(json, "case", (int64_t)c->index);
    vs_json_number(json, "value", c->own, 12);
    vs_json_number(json, "ngspice", c->ngspice, 12);
    vs_json_number(json, "difference", c->difference, 6);
    vs_json_number(json, "told", c->told, 6);
    vs_json_end(json);
  }
  vs_json_end(json);
  vs_json_end(json);
}

void vs_judge_say(const vs_judge *judge, uint64_t cases, FILE *out) {
  if (!judge->count) return;
  fprintf(out, "judged %zu of %llu cases in ngspice", judge->count - judge->failed,
          (unsigned long long)cases);
  if (judge->worst.name)
    fprintf(out, ": the largest difference is %.2g of the errors that both state (%s of case %llu)",
            share_of(&judge->worst), judge->worst.name, (unsigned long long)judge->worst.index);
  fputc('\n', out);
  if (judge->failed)
    fprintf(stderr,
            "vibrospice: warning: %zu of the cases that ngspice was to judge are not judged, as a "
            "run of theirs failed: case %llu: %s\n",
            judge->failed, (unsigned long long)judge->first_failed, judge->why);
}

static void write_cell(double value, char text[32]) {
  snprintf(text, 32, isnan(value) ? "nothing" : "%.9g", value);
}

vs_status vs_judge_result(const vs_judge *judge, vs_error *err) {
  const vs_judged_column *c = &judge->worst;
  char own[32], ngspice[32];
  if (!judge->beyond) return VS_OK;
  write_cell(c->own, own);
  write_cell(c->ngspice, ngspice);
  return vs_fail(
      err, VS_RUN,
      "case %llu: %s is %s, and %s in ngspice: off by %.3g, where both tell %.3g; so are "
      "%zu of %zu judged cases; run.tier: %s runs all of them in ngspice",
      (unsigned long long)c->index, c->name, own, ngspice, c->difference, c->told, judge->beyond,
      judge->count, vs_tiers_circuit());
}

/* ---- the limits ---- */

/* What a row comes to. A line that is violated for certain is its weakest, whose margin it has. */
static vs_hold_word word_of_row(char **cell, const size_t at[VS_ROLES]) {
  vs_hold_line weakest = {.name = "", .unit = "", .part = 1};
  const vs_hold hold = {.line = &weakest, .count = 1};
  vs_hold_word came[2] = {VS_HOLD_HELD};
  vs_hold_row row = VS_HOLD_ROW;
  row.happened = cell[at[VS_ROLE_HAPPENED]];
  const double margin = number_of(cell[at[VS_ROLE_MARGIN]]);
  if (!isnan(margin))
    vs_hold_judge(&hold, 0, margin, number_of(cell[at[VS_ROLE_ERROR]]), "", &row, came);
  vs_hold_happened(&hold, &row);
  vs_hold_rest(&hold, atoi(cell[at[VS_ROLE_STATUS]]) != VS_OK, cell[at[VS_ROLE_WARNINGS]], &row);
  return row.stored;
}

vs_status vs_judge_ratings(const vs_journals *all, vs_error *err) {
  vs_row_shape *shape = shape_of(all);
  const size_t columns = vs_row_shape_columns(shape);
  char **cell = vs_alloc(columns, sizeof *cell);
  unsigned long long count[VS_HOLD_UNDECIDED + 1] = {0};
  size_t at[VS_ROLES];
  for (int r = 0; r < VS_ROLES; r++) at[r] = column_of(shape, (vs_folder_role)r);
  vs_text row = {0};
  vs_status status = VS_OK;
  for (uint64_t k = 0; k < all->cases && !status; k++) {
    const vs_journal *j = journal_of(all, k);
    bool failed = false;
    if (!vs_journal_had(j, k) || !vs_journal_has(j, k)) continue;
    status = vs_journal_row(j, k, &row, &failed, err);
    if (status || failed || vs_csv_split(row.text, cell, columns, NULL) < columns) continue;
    count[word_of_row(cell, at)]++;
  }
  vs_text_free(&row);
  free(cell);
  vs_row_shape_free(shape);
  if (status) return status;
  return vs_fail(err, VS_RATING, "a rating is violated in %llu, undecided in %llu of %llu cases",
                 count[VS_HOLD_VIOLATED], count[VS_HOLD_UNDECIDED],
                 count[VS_HOLD_HELD] + count[VS_HOLD_VIOLATED] + count[VS_HOLD_UNDECIDED]);
}
