/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `judge`: the rows of a study, held against other limits without another run. Each row
 * has the margin of every line of its verdict (run/listed_line.h), and what happened. So a
 * line's limit, a margin of the house, a waiver and a criterion can be others than those of the
 * scene; what would change the waveforms cannot. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/units.h"
#include "commands.h"
#include "options.h"
#include "study/folder.h"
#include "study/hold.h"
#include "study/methods.h"

/* ---- what is asked ---- */

/* A line of the verdict: its columns of study.csv, and how many cases it breaks, as stored and now.
 * Its limit and what is asked of it has the line of the same number of `hold`. */
typedef struct line {
  size_t margin, error, broken[2];
} line;

typedef struct judge {
  vs_folder folder;
  vs_tree asked;
  vs_hold hold;
  line *lines;
  size_t cases, changed, count[2][3]; /* as stored and now: held, violated, undecided */
  size_t unverified;                  /* of those held now: the weakest margin has no error */
  double least, least_error;          /* the weakest line of all rows, now */
  const char *weakest;
  long weakest_case;
  vs_file csv;
} judge;

/* limits.LINE=900 V */
static vs_status take_limit(vs_hold *hold, const char *name, const vs_node *value, vs_error *err) {
  char why[160];
  double si;
  size_t k;
  vs_status status = vs_hold_need(hold, "limits", name, value->key_where, &k, err);
  if (status) return status;
  vs_hold_line *l = &hold->line[k];
  if (isnan(l->limit))
    return vs_fail_at(err, value->where,
                      "limits.%s: the line has two ends, or another limit from case to case; write "
                      "hold.%s, a part of the limit, instead",
                      name, name);
  if (value->kind != VS_NODE_TEXT || !vs_units_read(value->text, l->unit, &si, why, sizeof why))
    return vs_fail_at(err, value->where, "limits.%s: one limit is wanted, in %s", name, l->unit);
  status = vs_hold_check_sense(l, "limits", value->where, err);
  if (status) return status;
  if (!(si / l->limit > 0 && isfinite(si)))
    return vs_fail_at(err, value->where,
                      "limits.%s: a limit with the sign of the study's is wanted", name);
  l->part = si / l->limit;
  return VS_OK;
}

static vs_status take_criterion(judge *j, vs_error *err) {
  const vs_node *node = vs_tree_child(j->asked.root, "criterion");
  if (!node) return VS_OK;
  const int number = node->kind == VS_NODE_TEXT ? vs_expect_criterion(node->text) : -1;
  if (number >= 0) j->hold.criterion = &vs_expect_criteria[number];
  if (number >= 0) return VS_OK;
  return vs_fail_at(err, node->where,
                    "criterion: A (nothing happens), B (it may fire or misfire) or C (a fuse may "
                    "open, too) is wanted");
}

/* Error: a key that would change more than how rows are judged. */
static vs_status check_keys(const judge *j, vs_error *err) {
  for (const vs_node *n = j->asked.root->child; n; n = n->next) {
    if (!strcmp(n->key, "hold") || !strcmp(n->key, "limits") || !strcmp(n->key, "waive") ||
        !strcmp(n->key, "criterion"))
      continue;
    return vs_fail_at(
        err, n->key_where,
        "judge: %s changes the run itself%s; set it in `vibrospice study`. Here hold, "
        "limits, waive and criterion can be set",
        n->key, !strcmp(n->key, "circuit") ? ", as another part has another model" : "");
  }
  return VS_OK;
}

static vs_status read_asked(judge *j, const vs_arguments *a, vs_error *err) {
  vs_status status = vs_tree_parse("", "judge", &j->asked, err);
  for (size_t k = 0; k < a->n_sets && !status; k++)
    status = vs_tree_set(&j->asked, a->sets[k], err);
  if (!status) status = check_keys(j, err);
  const vs_node *root = j->asked.root;
  if (!status)
    status = vs_hold_each(&j->hold, vs_tree_child(root, "hold"), "hold", vs_hold_one, err);
  if (!status)
    status = vs_hold_each(&j->hold, vs_tree_child(root, "limits"), "limits", take_limit, err);
  if (!status) status = vs_hold_waive(&j->hold, vs_tree_child(root, "waive"), err);
  return status ? status : take_criterion(j, err);
}

/* ---- the study ---- */

static size_t find_column(const vs_folder *t, const char *number, const char *name) {
  char title[2 * VS_KEY_SIZE];
  snprintf(title, sizeof title, "%s.%s", number, name);
  for (size_t c = 1; c < t->count; c++)
    if (!strcmp(t->column[c].title, title)) return c;
  return 0;
}

static const char *text_of(const vs_node *map, const char *key) {
  const vs_node *node = vs_tree_child(map, key);
  return node && node->kind == VS_NODE_TEXT ? node->text : "";
}

static vs_status read_lines(judge *j, vs_error *err) {
  const vs_folder *t = &j->folder;
  const vs_node *all = vs_tree_child(t->manifest.root, "lines");
  if (!all || all->kind != VS_NODE_LIST)
    return vs_fail_at(
        err, (vs_where){t->manifest_path, 1, 1},
        "\"lines\" is missing: the study is of an earlier program, whose rows have only "
        "their least margin; run it again");
  vs_hold *hold = &j->hold;
  for (const vs_node *n = all->child; n; n = n->next) {
    vs_hold_line l = {.name = text_of(n, "name"), .unit = text_of(n, "unit"), .part = 1};
    line of = {find_column(t, "margin", l.name), find_column(t, "error", l.name), {0}};
    l.own = !strcmp(text_of(n, "rated_by_scene"), "true");
    l.left_out_by = vs_expect_criterion(text_of(n, "left_out_by"));
    if (l.left_out_by < 0) l.left_out_by = 0;
    for (int k = -1; k <= 1; k += 2)
      if (!strcmp(text_of(n, "margin"), vs_folder_margins[1 + k])) l.sense = k;
    if (!of.margin || !of.error || !vs_units_known(l.unit))
      return vs_fail_at(err, n->where, "line '%s' is not one of %s", l.name, t->path);
    if (!vs_folder_number(text_of(n, "limit"), &l.limit)) l.limit = NAN;
    l.limit *= vs_units_factor(l.unit);
    j->lines = vs_alloc_grow(j->lines, hold->count, sizeof *j->lines);
    hold->line = vs_alloc_grow(hold->line, hold->count, sizeof *hold->line);
    j->lines[hold->count] = of;
    hold->line[hold->count++] = l;
  }
  for (size_t c = 0; c < t->count; c++)
    if (!strncmp(t->column[c].title, "margin.", 7) &&
        vs_hold_find(hold, t->column[c].title + 7) == SIZE_MAX)
      return vs_fail_at(err, all->where, "\"lines\" has no line '%s', of which %s has a column",
                        t->column[c].title + 7, t->path);
  return VS_OK;
}

/* ---- a row ---- */

/* Error: the cell is not empty, and no number of a line. */
static vs_status read_number(const judge *j, const vs_folder_row *row, size_t column, double *value,
                             vs_error *err) {
  const char *cell = row->cell[column];
  char *end = NULL;
  *value = *cell ? strtod(cell, &end) : NAN;
  if (!end || (!*end && end != cell)) return VS_OK;
  return vs_fail_at(err, (vs_where){j->folder.path, (int)row->line, 1}, "%s: '%s' is no number",
                    j->folder.column[column].title, cell);
}

static vs_status judge_line(judge *j, size_t k, const vs_folder_row *row, vs_hold_row *r,
                            vs_error *err) {
  line *l = &j->lines[k];
  const char *not_judged = j->folder.not_judged >= 0 ? row->cell[j->folder.not_judged] : "";
  vs_hold_word came[2];
  double m, e;
  vs_status status = read_number(j, row, l->margin, &m, err);
  if (!status) status = read_number(j, row, l->error, &e, err);
  if (status || !*row->cell[l->margin]) return status; /* the case has no such line */
  vs_hold_judge(&j->hold, k, m, e, not_judged, r, came);
  for (int when = 0; when < 2; when++) l->broken[when] += came[when] != VS_HOLD_HELD;
  return VS_OK;
}

static void write_row(judge *j, const vs_folder_row *row, const vs_hold_row *r) {
  FILE *out = j->csv.stream;
  fprintf(out, "%ld,%s,", row->number, vs_hold_words[r->now]);
  const char *weakest = r->weakest == SIZE_MAX ? NULL : j->hold.line[r->weakest].name;
  if (weakest) fprintf(out, "%.12g", r->margin);
  fputc(',', out);
  if (weakest && isfinite(r->error)) fprintf(out, "%.12g", r->error);
  fprintf(out, ",%s,%s,%d\n", weakest ? weakest : "", vs_hold_words[r->stored],
          r->now == VS_HOLD_HELD ? VS_OK : VS_RATING);
}

static vs_status judge_row(void *ctx, const vs_folder_row *row, vs_error *err) {
  judge *j = ctx;
  vs_hold_row r = VS_HOLD_ROW;
  vs_status status = VS_OK;
  if (j->folder.happened >= 0) r.happened = row->cell[j->folder.happened];
  for (size_t k = 0; k < j->hold.count && !status; k++) status = judge_line(j, k, row, &r, err);
  if (status) return status;
  vs_hold_happened(&j->hold, &r);
  const char *warnings = j->folder.warnings >= 0 ? row->cell[j->folder.warnings] : "",
             *cell = row->cell[j->folder.status];
  if (!vs_hold_rest(&j->hold, atoi(cell) != VS_OK, warnings, &r))
    return vs_fail_at(err, (vs_where){j->folder.path, (int)row->line, 1},
                      "the row's status is %s, and its lines are %s; run the study again", cell,
                      vs_hold_words[r.stored]);
  j->cases++;
  j->count[0][r.stored]++;
  j->count[1][r.now]++;
  j->changed += r.stored != r.now;
  const char *weakest = r.weakest == SIZE_MAX ? NULL : j->hold.line[r.weakest].name;
  j->unverified += r.now == VS_HOLD_HELD && weakest && isnan(r.error);
  if (weakest && (!j->weakest || vs_hold_is_weaker(r.margin, r.error, j->least, j->least_error))) {
    j->least = r.margin;
    j->least_error = r.error;
    j->weakest = weakest;
    j->weakest_case = row->number;
  }
  if (j->csv.stream) write_row(j, row, &r);
  return VS_OK;
}

/* ---- what it comes to ---- */

static void print_table(const judge *j) {
  printf("%s: %zu cases judged anew, %ld failed\n\n%-12s %10s %10s\n", j->folder.folder, j->cases,
         j->folder.failed, "", "as run", "now");
  for (int w = 0; w <= VS_HOLD_UNDECIDED; w++)
    printf("%-12s %10zu %10zu\n", vs_hold_words[w], j->count[0][w], j->count[1][w]);
  if (j->unverified)
    printf(
        "held now by a margin whose error was not computed: %zu; run.verify: always in the study "
        "computes it\n",
        j->unverified);
  if (j->weakest)
    printf("\nweakest: %s in case %ld, margin %.3g %%%s\n", j->weakest, j->weakest_case,
           100 * j->least, j->hold.margin > 0 ? " beyond hold.margin" : "");
  printf("\n%-28s %10s %10s\n", "lines not held, in cases", "as run", "now");
  for (size_t k = 0; k < j->hold.count; k++)
    if (j->lines[k].broken[0] || j->lines[k].broken[1])
      printf("%-28s %10zu %10zu\n", j->hold.line[k].name, j->lines[k].broken[0],
             j->lines[k].broken[1]);
}

static void print_json(const judge *j) {
  static const char *const WHEN[] = {"as_run", "now"};
  vs_text text = {0};
  vs_json json = vs_json_new(&text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_json_text(&json, "study", j->folder.folder);
  vs_json_whole(&json, "cases", (int64_t)j->cases);
  vs_json_whole(&json, "failed", j->folder.failed);
  vs_json_whole(&json, "changed", (int64_t)j->changed);
  vs_json_whole(&json, "unverified", (int64_t)j->unverified);
  for (int k = 0; k < 2; k++) {
    vs_json_object(&json, WHEN[k], VS_JSON_ROW);
    for (int w = 0; w <= VS_HOLD_UNDECIDED; w++)
      vs_json_whole(&json, vs_hold_words[w], (int64_t)j->count[k][w]);
    vs_json_end(&json);
  }
  vs_json_object(&json, "weakest", VS_JSON_ROW);
  vs_json_text(&json, "line", j->weakest);
  if (j->weakest) vs_json_whole(&json, "case", j->weakest_case);
  vs_json_number(&json, "margin", j->weakest ? j->least : NAN, 12);
  vs_json_number(&json, "margin_error", j->least_error, 12);
  vs_json_end(&json);
  vs_json_array(&json, "lines", VS_JSON_LINES);
  for (size_t k = 0; k < j->hold.count; k++) {
    vs_json_object(&json, NULL, VS_JSON_ROW);
    vs_json_text(&json, "name", j->hold.line[k].name);
    vs_json_number(&json, "part_of_limit", j->hold.line[k].part, 12);
    vs_json_bool(&json, "waived", j->hold.line[k].waived);
    for (int w = 0; w < 2; w++)
      vs_json_whole(&json, w ? "broken_now" : "broken_as_run", (int64_t)j->lines[k].broken[w]);
    vs_json_end(&json);
  }
  vs_json_end(&json);
  vs_json_end(&json);
  fputs(text.text, stdout);
  vs_text_free(&text);
}

/* How it ends: cases that failed could not be judged. */
static vs_status end_judge(const judge *j, vs_error *err) {
  const size_t violated = j->count[1][VS_HOLD_VIOLATED], undecided = j->count[1][VS_HOLD_UNDECIDED];
  if (j->folder.failed)
    return vs_fail(err, VS_RUN, "%ld cases had failed, and could not be judged", j->folder.failed);
  return violated + undecided
             ? vs_fail(err, VS_RATING, "a rating is violated in %zu, undecided in %zu of %zu cases",
                       violated, undecided, j->cases)
             : VS_OK;
}

static vs_status judge_folder(judge *j, const vs_arguments *a, vs_error *err) {
  static const char HEADER[] = "case,verdict,margin_least,margin_error,weakest,as_run,status\n";
  int made;
  vs_status status = vs_folder_open(&j->folder, a->names[0], vs_methods_all, err);
  if (!status) status = read_lines(j, err);
  if (!status) status = read_asked(j, a, err);
  if (!status && a->output) status = vs_file_folder_make(a->output, &made, err);
  if (!status && a->output) status = vs_file_open(&j->csv, a->output, "judged.csv", err);
  if (!status && j->csv.stream) fputs(HEADER, j->csv.stream);
  if (!status) status = vs_folder_each(&j->folder, judge_row, j, err);
  if (!status && j->csv.stream) status = vs_file_commit(&j->csv, err);
  vs_file_discard(&j->csv);
  if (status) return status;
  if (!a->quiet) (a->json ? print_json : print_table)(j);
  return end_judge(j, err);
}

static vs_status judge_command(const void *given, vs_error *err) {
  const vs_arguments *a = given;
  if (a->n_names != 1)
    return vs_fail(err, VS_INPUT,
                   "judge: wants the folder of one study; see vibrospice judge --help");
  judge *j = vs_alloc(1, sizeof *j);
  *j = (judge){.least = INFINITY, .least_error = NAN};
  j->hold.where = "the verdicts of this study";
  j->hold.hint = "; manifest.json lists them";
  vs_status status = judge_folder(j, a, err);
  vs_folder_close(&j->folder);
  vs_tree_free(&j->asked);
  free(j->lines);
  free(j->hold.line);
  free(j);
  return status;
}

static const vs_option JUDGE_OPTIONS[] = {
    {.name = "set",
     .value = "KEY=VALUE",
     .read = vs_command_set,
     .text = "hold.margin=10% (of every limit), hold.LINE=0.8 (of its limit), limits.LINE=900V, "
             "waive=[LINE, ...], criterion=A|B|C; may stand several times"},
    VS_OPTIONS_OUTPUT("DIR", "writes judged.csv there: a row a case"),
    VS_OPTIONS_JSON,
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "prints nothing"),
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_judge_cli = {
    .name = "judge",
    .argument = "DIR",
    .text = "holds the rows of a study against other limits, without another run",
    .examples = "  vibrospice judge out --set hold.margin=10%\n"
                "  vibrospice judge out --set hold.thyristor.v_reverse=0.8 --set criterion=B\n"
                "  vibrospice judge out --set limits.thyristor.v_reverse=1000V --json\n",
    .results = true,
    .options = JUDGE_OPTIONS,
    .size = sizeof(vs_arguments),
    .run = judge_command};
