/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `judge`: the rows of a study, held against other limits without another run. Each row
 * has the margin of every line of its verdict (run/listed_line.h), and what happened. So a
 * line's limit, a margin of the house, a waiver and a criterion can be others than those of the
 * scene; what would change the waveforms cannot. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/json.h"
#include "base/units.h"
#include "commands.h"
#include "measure/expect.h"
#include "options.h"
#include "study/folder.h"
#include "study/methods.h"

/* ---- what is asked ---- */

/* A line of the verdict: its columns, its limit, and what is asked of it. */
typedef struct line {
  const char *name;     /* of the manifest, borrowed */
  size_t margin, error; /* columns of study.csv */
  double limit; /* as the study had it, SI; NaN: it has two ends, or may differ between cases */
  const char *unit;
  bool own;    /* the scene itself rates it: what the scene waives is another line of that name */
  int sense;   /* of vs_folder_margins, less 1; 0: the margin is no part of a limit */
  double part; /* the new limit as a part of the old one */
  bool waived;
  size_t broken[2]; /* how many cases it breaks: as stored, now */
} line;

typedef struct judge {
  vs_folder folder;
  vs_tree asked;
  line *lines;
  size_t n_lines;
  double house;                       /* the least margin that holds */
  int criterion;                      /* of vs_expect_criteria; -1: as the study's scene has it */
  size_t cases, changed, count[2][3]; /* as stored and now: held, violated, undecided */
  size_t unverified;                  /* of those held now: the weakest margin has no error */
  double least, least_error;          /* the weakest line of all rows, now */
  const char *weakest;
  long weakest_case;
  vs_file csv;
} judge;

static line *find_line(judge *j, const char *name) {
  for (size_t k = 0; k < j->n_lines; k++)
    if (!strcmp(j->lines[k].name, name)) return &j->lines[k];
  return NULL;
}

static vs_status unknown_line(const judge *j, const char *key, const char *name, vs_where where,
                              vs_error *err) {
  const char **names = vs_alloc(j->n_lines + 1, sizeof *names);
  for (size_t k = 0; k < j->n_lines; k++) names[k] = j->lines[k].name;
  vs_fail_at(err, where, "%s: the verdicts of this study have no line '%s'%s", key, name,
             vs_text_hint(name, names, j->n_lines, "; manifest.json lists them").text);
  free(names);
  return VS_INPUT;
}

/* Calls take for each text below the map, by its dotted name: hold.thyristor.v_reverse=0.8 stands
 * there as {thyristor: {v_reverse: 0.8}}. */
typedef vs_status (*take_one)(judge *j, const char *name, const vs_node *value, vs_error *err);
static vs_status each_below(judge *j, const char *key, take_one take, vs_error *err) {
  const vs_node *map = vs_tree_child(j->asked.root, key);
  char name[2 * VS_KEY_SIZE];
  vs_status status = VS_OK;
  if (map && map->kind != VS_NODE_MAP)
    return vs_fail_at(err, map->where, "%s: a line is wanted: %s.thyristor.v_reverse=...%s", key,
                      key, *key == 'h' ? ", or hold.margin=..." : "");
  for (const vs_node *n = map ? map->child : NULL; n && !status; n = n->next) {
    if (n->kind != VS_NODE_MAP) status = take(j, n->key, n, err);
    for (const vs_node *m = n->kind == VS_NODE_MAP ? n->child : NULL; m && !status; m = m->next) {
      snprintf(name, sizeof name, "%.90s.%.90s", n->key, m->key);
      status = take(j, name, m, err);
    }
  }
  return status;
}

/* Error: the margin is no part of a limit that could be another one. */
static vs_status check_sense(const line *l, const char *key, vs_where where, vs_error *err) {
  if (l->sense) return VS_OK;
  return vs_fail_at(err, where,
                    "%s.%s: a limit of 0, two ends on one side of 0 or limits that differ in kind "
                    "have no part; give `vibrospice study` another rating",
                    key, l->name);
}

/* hold.margin=10%, hold.LINE=0.8: the limit times 0.8; of a least one the limit over 0.8. */
static vs_status take_hold(judge *j, const char *name, const vs_node *value, vs_error *err) {
  char why[160];
  double number;
  if (value->kind != VS_NODE_TEXT || !vs_units_read(value->text, "", &number, why, sizeof why))
    return vs_fail_at(err, value->where, "hold.%s: a number is wanted, as 10 %% or 0.8", name);
  if (!strcmp(name, "margin")) {
    if (!(number >= 0 && number < 1))
      return vs_fail_at(err, value->where, "hold.margin: a part of the limit is wanted, 0 to 1");
    j->house = number;
    return VS_OK;
  }
  line *l = find_line(j, name);
  if (!l) return unknown_line(j, "hold", name, value->key_where, err);
  if (!(number > 0 && isfinite(number)))
    return vs_fail_at(err, value->where, "hold.%s: a part of the limit is wanted, above 0", name);
  l->part = l->sense < 0 ? 1 / number : number;
  return check_sense(l, "hold", value->where, err);
}

/* limits.LINE=900 V */
static vs_status take_limit(judge *j, const char *name, const vs_node *value, vs_error *err) {
  char why[160];
  double si;
  line *l = find_line(j, name);
  if (!l) return unknown_line(j, "limits", name, value->key_where, err);
  if (isnan(l->limit))
    return vs_fail_at(err, value->where,
                      "limits.%s: the line has two ends, or another limit from case to case; write "
                      "hold.%s, a part of the limit, instead",
                      name, name);
  if (value->kind != VS_NODE_TEXT || !vs_units_read(value->text, l->unit, &si, why, sizeof why))
    return vs_fail_at(err, value->where, "limits.%s: one limit is wanted, in %s", name, l->unit);
  vs_status status = check_sense(l, "limits", value->where, err);
  if (status) return status;
  if (!(si / l->limit > 0 && isfinite(si)))
    return vs_fail_at(err, value->where,
                      "limits.%s: a limit with the sign of the study's is wanted", name);
  l->part = si / l->limit;
  return VS_OK;
}

static vs_status take_waivers(judge *j, vs_error *err) {
  const vs_node *list = vs_tree_child(j->asked.root, "waive");
  vs_status status = VS_OK;
  if (list && list->kind == VS_NODE_MAP)
    return vs_fail_at(err, list->where, "waive: lines are wanted: [varistor_1.power, ...]");
  for (const vs_node *n = !list                        ? NULL
                          : list->kind == VS_NODE_LIST ? list->child
                                                       : list;
       n && !status; n = list->kind == VS_NODE_LIST ? n->next : NULL) {
    line *l = n->kind == VS_NODE_TEXT ? find_line(j, n->text) : NULL;
    if (l)
      l->waived = true;
    else
      status = unknown_line(j, "waive", n->kind == VS_NODE_TEXT ? n->text : "", n->where, err);
  }
  return status;
}

static vs_status take_criterion(judge *j, vs_error *err) {
  const vs_node *node = vs_tree_child(j->asked.root, "criterion");
  if (!node) return VS_OK;
  if (node->kind == VS_NODE_TEXT) j->criterion = vs_expect_criterion(node->text);
  if (j->criterion >= 0) return VS_OK;
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
  if (!status) status = each_below(j, "hold", take_hold, err);
  if (!status) status = each_below(j, "limits", take_limit, err);
  if (!status) status = take_waivers(j, err);
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
  for (const vs_node *n = all->child; n; n = n->next) {
    line l = {.name = text_of(n, "name"), .unit = text_of(n, "unit"), .part = 1};
    l.margin = find_column(t, "margin", l.name);
    l.error = find_column(t, "error", l.name);
    l.own = !strcmp(text_of(n, "rated_by_scene"), "true");
    for (int k = -1; k <= 1; k += 2)
      if (!strcmp(text_of(n, "margin"), vs_folder_margins[1 + k])) l.sense = k;
    if (!l.margin || !l.error || !vs_units_known(l.unit))
      return vs_fail_at(err, n->where, "line '%s' is not one of %s", l.name, t->path);
    if (!vs_folder_number(text_of(n, "limit"), &l.limit)) l.limit = NAN;
    l.limit *= vs_units_factor(l.unit);
    j->lines = vs_alloc_grow(j->lines, j->n_lines, sizeof *j->lines);
    j->lines[j->n_lines++] = l;
  }
  for (size_t c = 0; c < t->count; c++)
    if (!strncmp(t->column[c].title, "margin.", 7) && !find_line(j, t->column[c].title + 7))
      return vs_fail_at(err, all->where, "\"lines\" has no line '%s', of which %s has a column",
                        t->column[c].title + 7, t->path);
  return VS_OK;
}

/* ---- a row ---- */

typedef enum word { HELD, VIOLATED, UNDECIDED } word;
static const char *const WORDS[] = {"held", "violated", "undecided"};

/* What a line comes to, as vs_verdict_word has it. error NaN: it was not computed. */
static word word_of(double margin, double error) {
  if (isnan(margin) || fabs(margin) <= error) return UNDECIDED;
  return margin < 0 ? VIOLATED : HELD;
}

static word worse(word a, word b) {
  return a == VIOLATED || b == VIOLATED     ? VIOLATED
         : a == UNDECIDED || b == UNDECIDED ? UNDECIDED
                                            : HELD;
}

/* True if the scene waived the line: not_judged ends with "a.b, c.d (waived)". */
static bool was_waived(const char *not_judged, const char *name) {
  static const char END[] = " (waived)";
  const size_t size = strlen(not_judged), n = strlen(name);
  if (size < strlen(END) || strcmp(not_judged + size - strlen(END), END) != 0) return false;
  const char *list = not_judged;
  for (const char *s; (s = strstr(list, "; "));) list = s + 2;
  for (const char *s = list; (s = strstr(s, name)); s += n)
    if ((s == list || s[-1] == ' ') && (s[n] == ',' || s[n] == ' ')) return true;
  const char *dot = strchr(name, '.');
  char device[VS_DECK_NAME];
  snprintf(device, sizeof device, "%.*s", dot ? (int)(dot - name) : 0, name);
  return dot && was_waived(not_judged, device); /* all of its limits were */
}

/* What happened: "WHAT of DEVICE at ... | ..." (study/workers/case.c). *now: under the criterion.
 */
static void judge_happened(const judge *j, const char *cell, word *stored, word *now) {
  static const char EXPECTED[] = ", as expected", UNSURE[] = ", in one of two runs",
                    NEVER[] = " did not happen, though expected";
  for (const char *s = cell; *s;) {
    const char *end = strstr(s, " | ");
    const size_t n = end ? (size_t)(end - s) : strlen(s), what = strcspn(s, " ");
    char *one = vs_alloc_part(s, n), *name = vs_alloc_part(s, what);
    const word w = strstr(one, UNSURE) ? UNDECIDED : VIOLATED;
    bool spared = strstr(one, EXPECTED) && w == VIOLATED;
    if (!spared) *stored = worse(*stored, w);
    if (j->criterion == 0)
      spared = strstr(one, NEVER) != NULL;
    else if (j->criterion > 0)
      spared = spared || vs_expect_spares(j->criterion, name) || strstr(one, NEVER);
    if (!spared) *now = worse(*now, w);
    free(one);
    free(name);
    s += n + (end ? strlen(" | ") : 0);
  }
}

/* The margin to the new limit. A margin m to a most limit L leaves the stress at L (1 - m), to a
 * least one at L (1 + m); of the new limit `part` L the house wants its share besides. */
static double margin_now(const judge *j, const line *l, double m) {
  if (l->part == 1) return m - j->house;
  return (l->sense < 0 ? (1 + m) / l->part - 1 : 1 - (1 - m) / l->part) - j->house;
}

/* What the margin's error may be then. A part of it is of the stress, and grows with 1 / part, a
 * part is of the limit; which, a row does not say. So it is never made smaller than it was. */
static double error_now(const line *l, double e) {
  return e * fmax(1, 1 / l->part);
}

/* As vs_verdict_is_weaker has it. */
static bool is_weaker(double m, double e, double other, double of_other) {
  const bool sure = word_of(m, e) == VIOLATED, other_sure = word_of(other, of_other) == VIOLATED;
  if (sure != other_sure) return sure;
  return m - (sure || isnan(e) ? 0 : e) <= other - (sure || isnan(of_other) ? 0 : of_other);
}

typedef struct row_judged {
  word stored, now;
  double margin, error; /* of the weakest line, now; NaN: there is none */
  const char *weakest;
} row_judged;

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

static vs_status judge_line(judge *j, line *l, const vs_folder_row *row, row_judged *r,
                            vs_error *err) {
  double m, e;
  vs_status status = read_number(j, row, l->margin, &m, err);
  if (!status) status = read_number(j, row, l->error, &e, err);
  if (status || !*row->cell[l->margin]) return status; /* the case has no such line */
  const double now = margin_now(j, l, m), error = error_now(l, e);
  const char *not_judged = j->folder.not_judged >= 0 ? row->cell[j->folder.not_judged] : "";
  const bool waived = !l->own && was_waived(not_judged, l->name);
  const word stored = waived ? HELD : word_of(m, e);
  const word new = waived || l->waived ? HELD : word_of(now, error);
  l->broken[0] += stored != HELD;
  l->broken[1] += new != HELD;
  r->stored = worse(r->stored, stored);
  r->now = worse(r->now, new);
  if (waived || l->waived || !isfinite(now)) return VS_OK;
  if (r->weakest && !is_weaker(now, error, r->margin, r->error)) return VS_OK;
  r->margin = now;
  r->error = error;
  r->weakest = l->name;
  return VS_OK;
}

/* A line may have no column: of a part that nothing watches, or of a case that the study's first
 * ones do not tell of (study/workers/case.c). What it breaks the row's status has alone. */
static vs_status judge_rest(const judge *j, const vs_folder_row *row, row_judged *r,
                            vs_error *err) {
  const bool broken = atoi(row->cell[j->folder.status]) != VS_OK;
  const char *warnings = j->folder.warnings >= 0 ? row->cell[j->folder.warnings] : "";
  if (!broken && r->stored != HELD)
    return vs_fail_at(err, (vs_where){j->folder.path, (int)row->line, 1},
                      "the row's status is %s, and its lines are %s; run the study again",
                      row->cell[j->folder.status], WORDS[r->stored]);
  if (broken && r->stored == HELD) r->stored = r->now = worse(r->now, UNDECIDED);
  if (j->house > 0 && strstr(warnings, " has no column: its margin is "))
    r->now = worse(r->now, UNDECIDED);
  return VS_OK;
}

static void write_row(judge *j, const vs_folder_row *row, const row_judged *r) {
  FILE *out = j->csv.stream;
  fprintf(out, "%ld,%s,", row->number, WORDS[r->now]);
  if (r->weakest) fprintf(out, "%.12g", r->margin);
  fputc(',', out);
  if (r->weakest && isfinite(r->error)) fprintf(out, "%.12g", r->error);
  fprintf(out, ",%s,%s,%d\n", r->weakest ? r->weakest : "", WORDS[r->stored],
          r->now == HELD ? VS_OK : VS_RATING);
}

static vs_status judge_row(void *ctx, const vs_folder_row *row, vs_error *err) {
  judge *j = ctx;
  row_judged r = {.margin = NAN, .error = NAN};
  vs_status status = VS_OK;
  for (size_t k = 0; k < j->n_lines && !status; k++)
    status = judge_line(j, &j->lines[k], row, &r, err);
  if (status) return status;
  if (j->folder.happened >= 0) judge_happened(j, row->cell[j->folder.happened], &r.stored, &r.now);
  status = judge_rest(j, row, &r, err);
  if (status) return status;
  j->cases++;
  j->count[0][r.stored]++;
  j->count[1][r.now]++;
  j->changed += r.stored != r.now;
  j->unverified += r.now == HELD && r.weakest && isnan(r.error);
  if (r.weakest && (!j->weakest || is_weaker(r.margin, r.error, j->least, j->least_error))) {
    j->least = r.margin;
    j->least_error = r.error;
    j->weakest = r.weakest;
    j->weakest_case = row->number;
  }
  if (j->csv.stream) write_row(j, row, &r);
  return VS_OK;
}

/* ---- what it comes to ---- */

static void print_table(const judge *j) {
  printf("%s: %zu cases judged anew, %ld failed\n\n%-12s %10s %10s\n", j->folder.folder, j->cases,
         j->folder.failed, "", "as run", "now");
  for (int w = 0; w <= UNDECIDED; w++)
    printf("%-12s %10zu %10zu\n", WORDS[w], j->count[0][w], j->count[1][w]);
  if (j->unverified)
    printf("of those held now, %zu by a margin whose error was not computed; run.verify: always in "
           "the study computes it\n",
           j->unverified);
  if (j->weakest)
    printf("\nweakest: %s in case %ld, margin %.3g %%%s\n", j->weakest, j->weakest_case,
           100 * j->least, j->house > 0 ? " beyond the house's" : "");
  printf("\n%-28s %10s %10s\n", "cases that a line breaks", "as run", "now");
  for (size_t k = 0; k < j->n_lines; k++)
    if (j->lines[k].broken[0] || j->lines[k].broken[1])
      printf("%-28s %10zu %10zu\n", j->lines[k].name, j->lines[k].broken[0], j->lines[k].broken[1]);
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
    for (int w = 0; w <= UNDECIDED; w++) vs_json_whole(&json, WORDS[w], (int64_t)j->count[k][w]);
    vs_json_end(&json);
  }
  vs_json_object(&json, "weakest", VS_JSON_ROW);
  vs_json_text(&json, "line", j->weakest);
  if (j->weakest) vs_json_whole(&json, "case", j->weakest_case);
  vs_json_number(&json, "margin", j->weakest ? j->least : NAN, 12);
  vs_json_number(&json, "margin_error", j->least_error, 12);
  vs_json_end(&json);
  vs_json_array(&json, "lines", VS_JSON_LINES);
  for (size_t k = 0; k < j->n_lines; k++) {
    vs_json_object(&json, NULL, VS_JSON_ROW);
    vs_json_text(&json, "name", j->lines[k].name);
    vs_json_number(&json, "part_of_limit", j->lines[k].part, 12);
    vs_json_bool(&json, "waived", j->lines[k].waived);
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
  const size_t broken = j->count[1][VIOLATED] + j->count[1][UNDECIDED];
  if (j->folder.failed)
    return vs_fail(err, VS_RUN, "%ld cases had failed, and could not be judged", j->folder.failed);
  return broken ? vs_fail(err, VS_RATING, "a rating is violated or undecided in %zu of %zu cases",
                          broken, j->cases)
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
  *j = (judge){.criterion = -1, .least = INFINITY, .least_error = NAN};
  vs_status status = judge_folder(j, a, err);
  vs_folder_close(&j->folder);
  vs_tree_free(&j->asked);
  free(j->lines);
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
    VS_OPTIONS_NO_JAIL,
    VS_OPTIONS_HELP,
    {0}};

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
