/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/compare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/json.h"
#include "base/text.h"
#include "run_pair.h"
#include "study/folder.h"

/* ---- two studies: which cases changed their verdict, how far columns lie apart ---- */

enum { MOST_LISTED = 10 }; /* cases with another verdict that are listed */

/* A column that both studies report, and how far its values differ. */
typedef struct study_pair_column {
  size_t at[2];                /* the column's number in either study */
  double least[2], largest[2]; /* of all rows of that study; NaN: none has a number */
  double apart;                /* B - A where it is largest in size; NaN: in no joined row */
  long apart_case[2];          /* the cases of that row */
  double sum;                  /* of B - A over the joined rows in which both have a number */
  long joined;                 /* how many rows these are */
  long alone[2];               /* joined rows in which only A, or only B, has a number */
} study_pair_column;

/* A pair of joined rows with different verdicts. */
typedef struct study_pair_change {
  long number[2]; /* its cases */
  char word[2][12];
} study_pair_change;

/* Begins as {0}; study_pair_close is due even after an error. Index 0 is study A, 1 is study B. */
typedef struct study_pair {
  vs_folder folder[2];
  bool by_axes; /* rows are joined by the values of their axes; false: by the numbers of their cases
                 */
  long rows[2], held[2], judged[2], joined;
  study_pair_column column[VS_STUDY_COLUMNS];
  size_t columns;
  study_pair_change change[MOST_LISTED];
  long changes;               /* all of them */
  struct study_pair_row *row; /* the rows of A, sorted by key; owned */
} study_pair;

enum { DIGITS = 12 };

/* A row of study A. */
struct study_pair_row {
  char *key; /* by which rows are joined; owned */
  long number;
  const char *word; /* of its verdict */
  double *value;    /* of the columns of the pair; owned */
};

/* The state of reading one study. */
typedef struct reader {
  study_pair *pair;
  int side;
  size_t room; /* rows of A that there is memory for */
} reader;

/* ---- columns ---- */

static size_t find_column(const vs_folder *t, const char *title) {
  for (size_t c = 0; c < t->count; c++)
    if (!strcmp(t->column[c].title, title)) return c;
  return 0;
}

/* Collects the columns that both studies report. */
static void find_common(study_pair *p) {
  for (size_t c = 0; c < p->folder[0].count; c++) {
    const vs_folder_column *column = &p->folder[0].column[c];
    size_t other = find_column(&p->folder[1], column->title);
    if (!other || (column->role != VS_ROLE_REPORT && column->role != VS_ROLE_MARGIN)) continue;
    p->column[p->columns++] = (study_pair_column){
        .at = {c, other}, .least = {NAN, NAN}, .largest = {NAN, NAN}, .apart = NAN};
  }
}

static size_t count_axes(const vs_folder *t) {
  size_t n = 0;
  for (size_t c = 0; c < t->count; c++) n += t->column[c].role == VS_ROLE_AXIS;
  return n;
}

static bool have_same_axes(const study_pair *p) {
  const vs_folder *a = &p->folder[0], *b = &p->folder[1];
  for (size_t c = 0; c < a->count; c++) {
    if (a->column[c].role != VS_ROLE_AXIS) continue;
    size_t other = find_column(b, a->column[c].title);
    if (!other || b->column[other].role != VS_ROLE_AXIS) return false;
  }
  return count_axes(a) && count_axes(a) == count_axes(b);
}

/* ---- rows ---- */

/* The key by which rows of A and B are joined: the cells of the axes in A's order, or the number of
 * the case. */
static char *key_of(const study_pair *p, int side, const vs_folder_row *row) {
  const vs_folder *a = &p->folder[0];
  vs_text key = {0};
  if (!p->by_axes) vs_text_add(&key, "%ld", row->number);
  for (size_t c = 0; p->by_axes && c < a->count; c++) {
    if (a->column[c].role != VS_ROLE_AXIS) continue;
    size_t at = side ? find_column(&p->folder[1], a->column[c].title) : c;
    vs_csv_cell(&key, row->cell[at]);
    vs_text_add(&key, ",");
  }
  return key.text;
}

static double number_in(const vs_folder_row *row, int column) {
  double value;
  return column >= 0 && vs_folder_number(row->cell[column], &value) ? value : NAN;
}

/* The word of a case's verdict. It is violated where its margin is negative by more than its error,
 * or by any amount if the error is not known. */
static const char *word_of(const vs_folder *t, const vs_folder_row *row) {
  double margin = number_in(row, t->margin), error = number_in(row, t->error);
  if (isnan(margin)) return "-";
  if (!strcmp(row->cell[t->status], "0")) return "held";
  return margin < 0 && !(fabs(margin) <= error) ? "violated" : "undecided";
}

/* Counts the row, and extends the columns' ranges by it. */
static void count_row(study_pair *p, int side, const vs_folder_row *row) {
  const char *word = word_of(&p->folder[side], row);
  p->rows[side]++;
  p->judged[side] += strcmp(word, "-") != 0;
  p->held[side] += !strcmp(word, "held");
  for (size_t k = 0; k < p->columns; k++) {
    double value = number_in(row, (int)p->column[k].at[side]);
    p->column[k].least[side] = fmin(p->column[k].least[side], value);
    p->column[k].largest[side] = fmax(p->column[k].largest[side], value);
  }
}

static vs_status keep_row(void *ctx, const vs_folder_row *row, vs_error *err) {
  reader *r = ctx;
  study_pair *p = r->pair;
  (void)err;
  if ((size_t)p->rows[0] == r->room) {
    r->room = r->room ? 2 * r->room : 256;
    p->row = vs_resize(p->row, r->room, sizeof *p->row);
  }
  struct study_pair_row *kept = &p->row[p->rows[0]];
  *kept = (struct study_pair_row){key_of(p, 0, row), row->number, word_of(&p->folder[0], row),
                                  vs_alloc(p->columns + 1, sizeof *kept->value)};
  for (size_t k = 0; k < p->columns; k++) kept->value[k] = number_in(row, (int)p->column[k].at[0]);
  count_row(p, 0, row);
  return VS_OK;
}

static int by_key(const void *a, const void *b) {
  const struct study_pair_row *one = a, *other = b;
  return strcmp(one->key, other->key);
}

static void join_values(study_pair *p, const struct study_pair_row *a, const vs_folder_row *b) {
  for (size_t k = 0; k < p->columns; k++) {
    study_pair_column *c = &p->column[k];
    double of_a = a->value[k], of_b = number_in(b, (int)c->at[1]), apart = of_b - of_a;
    if (isnan(of_a) != isnan(of_b)) c->alone[isnan(of_a) ? 1 : 0]++;
    if (isnan(apart)) continue;
    c->sum += apart;
    c->joined++;
    if (!isnan(c->apart) && fabs(apart) <= fabs(c->apart)) continue;
    c->apart = apart;
    c->apart_case[0] = a->number, c->apart_case[1] = b->number;
  }
}

static vs_status join_row(void *ctx, const vs_folder_row *row, vs_error *err) {
  study_pair *p = ((reader *)ctx)->pair;
  (void)err;
  count_row(p, 1, row);
  struct study_pair_row wanted = {.key = key_of(p, 1, row)};
  const struct study_pair_row *a =
      p->rows[0] ? bsearch(&wanted, p->row, (size_t)p->rows[0], sizeof *p->row, by_key) : NULL;
  free(wanted.key);
  if (!a) return VS_OK;
  const char *word = word_of(&p->folder[1], row);
  p->joined++;
  join_values(p, a, row);
  if (!strcmp(word, a->word)) return VS_OK;
  if (p->changes < MOST_LISTED) {
    study_pair_change *change = &p->change[p->changes];
    *change = (study_pair_change){.number = {a->number, row->number}};
    snprintf(change->word[0], sizeof change->word[0], "%s", a->word);
    snprintf(change->word[1], sizeof change->word[1], "%s", word);
  }
  p->changes++;
  return VS_OK;
}

static void rekey_by_number(study_pair *p) {
  p->by_axes = false;
  for (long k = 0; k < p->rows[0]; k++) {
    vs_text key = {0};
    vs_text_add(&key, "%ld", p->row[k].number);
    free(p->row[k].key);
    p->row[k].key = key.text;
  }
}

/* Sorts the rows of A. If two of them have the same key, all rows are joined by their number
 * instead. */
static void sort_rows(study_pair *p) {
  if (!p->rows[0]) return;
  qsort(p->row, (size_t)p->rows[0], sizeof *p->row, by_key);
  for (long k = 1; k < p->rows[0] && p->by_axes; k++)
    if (!by_key(&p->row[k - 1], &p->row[k])) rekey_by_number(p);
  if (!p->by_axes) qsort(p->row, (size_t)p->rows[0], sizeof *p->row, by_key);
}

/* Reads both studies and joins their rows: by the values of the axes if both studies have the same
 * axes and no two rows of A the same values, else by the number of the case. Errors, VS_INPUT: a
 * folder is not a study's, or a file in it is broken. */
static vs_status study_pair_open(study_pair *p, const char *a, const char *b,
                                 const vs_method *const *methods, vs_error *err) {
  const char *folders[] = {a, b};
  vs_status status = VS_OK;
  for (int k = 0; k < 2 && !status; k++)
    status = vs_folder_open(&p->folder[k], folders[k], methods, err);
  if (status) return status;
  find_common(p);
  p->by_axes = have_same_axes(p);
  reader first = {p, 0, 0}, second = {p, 1, 0};
  status = vs_folder_each(&p->folder[0], keep_row, &first, err);
  if (!status) sort_rows(p);
  if (!status) status = vs_folder_each(&p->folder[1], join_row, &second, err);
  return status;
}

static void study_pair_close(study_pair *p) {
  for (long k = 0; k < p->rows[0]; k++) {
    free(p->row[k].key);
    free(p->row[k].value);
  }
  free(p->row);
  for (int k = 0; k < 2; k++) vs_folder_close(&p->folder[k]);
}

/* ---- what is printed ---- */

static void add_column(const study_pair *p, const study_pair_column *c, vs_text *out) {
  char range[2][64];
  for (int k = 0; k < 2; k++)
    if (isnan(c->least[k]))
      snprintf(range[k], sizeof range[k], "-");
    else
      snprintf(range[k], sizeof range[k], "%.4g .. %.4g", c->least[k], c->largest[k]);
  vs_text_add(out, "  %-30s %24s %24s", p->folder[0].column[c->at[0]].title, range[0], range[1]);
  if (c->joined)
    vs_text_add(out, " %12.4g %12.4g  case %ld", c->sum / (double)c->joined, c->apart,
                c->apart_case[1]);
  else
    vs_text_add(out, " %12s %12s", "-", "-");
  for (int k = 0; k < 2; k++)
    if (c->alone[k]) vs_text_add(out, "; %ld in %c alone", c->alone[k], "AB"[k]);
  vs_text_add(out, "\n");
}

/* The first adds the table for people, the second the same as one JSON object. */
static void study_pair_table(const study_pair *p, vs_text *out) {
  for (int k = 0; k < 2; k++)
    vs_text_add(out, "%c: %s, %ld cases with a result, %ld failed; %ld of %ld judged are held\n",
                "AB"[k], p -> folder[k].folder, p->rows[k], p->folder[k].failed, p->held[k],
                p->judged[k]);
  vs_text_add(out, "%ld rows joined by %s; %ld in A alone, %ld in B alone\n", p->joined,
              p->by_axes ? "the values of their axes" : "the number of the case",
              p->rows[0] - p->joined, p->rows[1] - p->joined);
  vs_text_add(out, "\nverdict: %ld of the joined rows %s another word\n", p->changes,
              p->changes == 1 ? "has" : "have");
  for (long k = 0; k < p->changes && k < MOST_LISTED; k++)
    vs_text_add(out, "  case %ld: %s, B's case %ld: %s\n", p->change[k].number[0],
                p->change[k].word[0], p->change[k].number[1], p->change[k].word[1]);
  if (p->changes > MOST_LISTED) vs_text_add(out, "  and %ld more\n", p->changes - MOST_LISTED);
  vs_text_add(out, "\n%-32s %24s %24s %12s %12s  %s\n", "columns", "A", "B", "mean B - A",
              "largest", "at B's");
  for (size_t k = 0; k < p->columns; k++) add_column(p, &p->column[k], out);
  if (!p->columns) vs_text_add(out, "  none is in both\n");
}

static void add_side(const study_pair *p, int k, vs_json *json) {
  vs_json_object(json, k ? "b" : "a", VS_JSON_ROW);
  vs_json_text(json, "folder", p->folder[k].folder);
  vs_json_whole(json, "rows", p->rows[k]);
  vs_json_whole(json, "failed", p->folder[k].failed);
  vs_json_whole(json, "judged", p->judged[k]);
  vs_json_whole(json, "held", p->held[k]);
  vs_json_end(json);
}

static void add_changes(const study_pair *p, vs_json *json) {
  vs_json_whole(json, "changed", p->changes);
  vs_json_array(json, "changes", VS_JSON_LINES);
  for (long k = 0; k < p->changes && k < MOST_LISTED; k++) {
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_whole(json, "case_a", p->change[k].number[0]);
    vs_json_text(json, "word_a", p->change[k].word[0]);
    vs_json_whole(json, "case_b", p->change[k].number[1]);
    vs_json_text(json, "word_b", p->change[k].word[1]);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void study_pair_json(const study_pair *p, vs_text *out) {
  vs_json json = vs_json_new(out);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_json_text(&json, "compared", "studies");
  for (int k = 0; k < 2; k++) add_side(p, k, &json);
  vs_json_text(&json, "joined_by", p->by_axes ? "axes" : "case");
  vs_json_whole(&json, "joined", p->joined);
  add_changes(p, &json);
  vs_json_object(&json, "columns", VS_JSON_LINES);
  for (size_t k = 0; k < p->columns; k++) {
    const study_pair_column *c = &p->column[k];
    vs_json_object(&json, p->folder[0].column[c->at[0]].title, VS_JSON_ROW);
    vs_json_number(&json, "least_a", c->least[0], DIGITS);
    vs_json_number(&json, "largest_a", c->largest[0], DIGITS);
    vs_json_number(&json, "least_b", c->least[1], DIGITS);
    vs_json_number(&json, "largest_b", c->largest[1], DIGITS);
    vs_json_number(&json, "mean_difference", c->joined ? c->sum / (double)c->joined : NAN, DIGITS);
    vs_json_number(&json, "largest_difference", c->apart, DIGITS);
    vs_json_whole(&json, "only_a", c->alone[0]);
    vs_json_whole(&json, "only_b", c->alone[1]);
    if (c->joined) vs_json_whole(&json, "at_case_a", c->apart_case[0]);
    if (c->joined) vs_json_whole(&json, "at_case_b", c->apart_case[1]);
    vs_json_end(&json);
  }
  vs_json_end(&json);
  vs_json_end(&json);
  vs_text_add(out, "\n");
}

/* ---- runs or studies ---- */

static vs_status compare_runs(const vs_compare_options *o, vs_text *out, vs_error *err) {
  vs_run_pair pair = {0};
  vs_status status = vs_run_pair_open(&pair, o->a, o->b, err);
  if (!status) (o->json ? vs_run_pair_json : vs_run_pair_table)(&pair, out);
  vs_run_pair_close(&pair);
  return status;
}

static vs_status compare_studies(const vs_compare_options *o, vs_text *out, vs_error *err) {
  study_pair *pair = vs_alloc(1, sizeof *pair); /* too large for the stack */
  vs_status status = study_pair_open(pair, o->a, o->b, o->methods, err);
  if (!status) (o->json ? study_pair_json : study_pair_table)(pair, out);
  study_pair_close(pair);
  free(pair);
  return status;
}

/* What the folder holds; NULL: neither a run nor a study. */
static const char *kind_of(const char *folder) {
  return vs_folder_here(folder) ? "study" : vs_traces_here(folder) ? "run" : NULL;
}

vs_status vs_compare_tell(const vs_compare_options *o, vs_text *out, vs_error *err) {
  const char *folders[] = {o->a, o->b}, *kinds[2];
  for (int k = 0; k < 2; k++)
    if (!(kinds[k] = kind_of(folders[k])))
      return vs_fail(err, VS_INPUT,
                     "%.500s: holds neither a run nor a study; 'vibrospice run "
                     "SCENE -o DIR' makes one",
                     folders[k]);
  if (strcmp(kinds[0], kinds[1]) != 0)
    return vs_fail(err, VS_INPUT,
                   "%.400s holds a %s and %.400s a %s; two of a kind can be compared", o->a,
                   kinds[0], o->b, kinds[1]);
  return (vs_folder_here(o->a) ? compare_studies : compare_runs)(o, out, err);
}
