/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/case.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/file.h"
#include "measure/unjudged.h"
#include "run/listed_line.h"
#include "run/session.h"
#include "run/table.h"
#include "study/folder.h"
#include "workers/identity.h"

/* Columns before the axes: case, id; and behind the measures. */
enum { HEAD = VS_ROLE_AXIS, TAIL = VS_ROLE_STATUS + 1 - VS_ROLE_MARGIN };

/* A case: its number, its point, and its id. */
typedef struct which {
  uint64_t index;
  const double *point;
  char id[VS_ID_SIZE]; /* empty while the scene is not read, and where it is refused */
} which;

/* Where a result has a value of the machine, and what makes the column's number of it. */
typedef struct vs_slot {
  int slot;
  double factor;
} vs_slot;

struct vs_case {
  const vs_plan *plan;
  const char *keep;
  vs_scene *scene;
  bool begun; /* the scene's tree has been read */
  vs_identity *identity;
  which present;
  bool circuit;                  /* the last case used ngspice */
  char machine[VS_NAME_SIZE];    /* the machine of `wants` */
  vs_measure_set wants;          /* the values that the columns are made of */
  bool wants_all;                /* a column is no such value */
  vs_slot slot[VS_PLAN_COLUMNS]; /* where the machine's values stand; factor 0: it is none */
  int shown[VS_PLAN_COLUMNS];    /* where each other column was found the last time */
  vs_propagator_memo memo;       /* of the cases' runs, one after the other */
  vs_result *result;             /* too large for the stack */
  vs_steady *steady;             /* of a study of orbits, the case's; else NULL */
  vs_sensitivity derived;        /* of a study with derivatives, the case's; else empty */
};

vs_case *vs_case_new(const vs_plan *plan, const char *keep) {
  vs_case *c = vs_alloc(1, sizeof *c);
  c->plan = plan;
  c->keep = keep;
  c->scene = vs_alloc(1, sizeof *c->scene);
  c->identity = vs_identity_new(plan);
  c->result = vs_alloc(1, sizeof *c->result);
  if (plan->periods) c->steady = vs_alloc(1, sizeof *c->steady);
  return c;
}

void vs_case_free(vs_case *c) {
  if (c->begun) vs_scene_free(c->scene);
  free(c->scene);
  vs_identity_free(c->identity);
  free(c->result);
  free(c->steady);
  free(c);
}

/* ---- rows ---- */

/* Columns are written as cells, because an event's name, which its user gives, may hold anything.
 */
static void begin_header(const vs_plan *plan, vs_text *row) {
  for (int r = 0; r < HEAD; r++) vs_text_add(row, "%s%s", r ? "," : "", vs_folder_kinds[r].word);
  for (size_t k = 0; k < plan->n_axes; k++) {
    vs_text_put(row, ",", 1);
    vs_csv_cell(row, plan->axes[k].column);
  }
}

void vs_case_header(const vs_plan *plan, vs_text *row) {
  begin_header(plan, row);
  for (size_t k = 0; k < plan->n_columns; k++) vs_text_add(row, ",%s", plan->columns[k].column);
  for (int r = VS_ROLE_MARGIN; r <= VS_ROLE_STATUS; r++)
    vs_text_add(row, ",%s", vs_folder_kinds[r].word);
}

bool vs_case_values(const vs_plan *plan, char *row, double *values, int *status, char **words) {
  static const vs_folder_role ROLE[] = {[VS_RESULT_HAPPENED] = VS_ROLE_HAPPENED,
                                        [VS_RESULT_NOT_JUDGED] = VS_ROLE_NOT_JUDGED,
                                        [VS_RESULT_WARNINGS] = VS_ROLE_WARNINGS};
  enum { MOST = HEAD + VS_PLAN_AXES + VS_PLAN_COLUMNS + TAIL };
  char *cells[MOST];
  const size_t n = plan->n_columns;
  if (vs_csv_split(row, cells, MOST, NULL) != HEAD + plan->n_axes + n + TAIL) return false;
  char **measure = cells + HEAD + plan->n_axes, **tail = measure + n;
  values[0] = **tail ? strtod(*tail, NULL) : NAN; /* the least margin comes first */
  for (size_t k = 0; k < n; k++) values[1 + k] = *measure[k] ? strtod(measure[k], NULL) : NAN;
  *status = atoi(tail[TAIL - 1]);
  for (size_t k = 0; k < sizeof ROLE / sizeof *ROLE; k++)
    if (*tail[ROLE[k] - VS_ROLE_MARGIN]) words[k] = vs_copy(tail[ROLE[k] - VS_ROLE_MARGIN]);
  return true;
}

char *vs_case_why(char *row) {
  char *cells[HEAD + VS_PLAN_AXES + 2];
  const size_t n = vs_csv_split(row, cells, sizeof cells / sizeof *cells, NULL);
  return vs_copy(n ? cells[n - 1] : "");
}

void vs_case_failure_header(const vs_plan *plan, vs_text *row) {
  begin_header(plan, row);
  for (int r = VS_ROLE_STATUS; r <= VS_ROLE_WHY; r++)
    vs_text_add(row, ",%s", vs_folder_kinds[r].word);
}

static void begin_row(const vs_plan *plan, const which *w, vs_text *row) {
  char cell[VS_NAME_SIZE];
  vs_text_add(row, "%llu,%s", (unsigned long long)w->index, w->id);
  for (size_t k = 0; k < plan->n_axes; k++) {
    vs_axis_print(&plan->axes[k], w->point[k], cell, sizeof cell);
    vs_text_put(row, ",", 1);
    vs_csv_cell(row, cell);
  }
}

static void add_failure(const vs_case *c, const char *why, vs_text *row) {
  begin_row(c->plan, &c->present, row);
  vs_text_add(row, ",%d,", VS_CASE_FAILED);
  vs_csv_cell(row, why);
}

static void add_number(vs_text *row, double value) {
  if (isfinite(value)) vs_text_add_number(row, value, 12);
}

/* A margin is infinite where a limit of 0 is kept, and NaN where the line has nothing to judge; its
 * error is infinite where it could not be found. */
static void add_line_number(vs_text *row, vs_value v) {
  if (!v.known) return;
  if (isfinite(v.value))
    add_number(row, v.value);
  else
    vs_text_add(row, "%s", isnan(v.value) ? "nan" : "inf");
}

/* Returns the case's value in column k. A deck with other devices may have the measure elsewhere or
 * not at all. */
static vs_value find_value(vs_case *c, size_t k) {
  int derivative = c->plan->columns[k].derivative;
  if (derivative) {
    const vs_sensitivity_entry *e = &c->derived.entry[abs(derivative) - 1];
    return (vs_value){!isnan(e->value), derivative < 0 ? e->error : e->value, NAN};
  }
  const vs_slot *own = &c->slot[k];
  if (own->factor != 0) {
    vs_value v = c->result->values[own->slot];
    v.value *= own->factor;
    return v;
  }
  const char *name = c->plan->columns[k].name;
  const vs_orbit_columns of = {&c->result->scene->frame, c->result, c->steady};
  vs_listed_measure m;
  if (vs_orbit_columns_at(&of, c->shown[k], &m) && !strcmp(m.name, name)) return m.value;
  for (int n = 0; vs_orbit_columns_at(&of, n, &m); n++)
    if (!strcmp(m.name, name)) {
      c->shown[k] = n;
      return m.value;
    }
  return (vs_value){0};
}

/* Adds a warning to the one cell that holds all. */
static void add_warning_to_cell(void *ctx, const char *text) {
  vs_text *all = ctx;
  vs_text_add(all, "%s%s", all->length ? " | " : "", text);
}

/* Adds what is to be said of the derivatives. */
static void add_notes_of_derivatives(const vs_sensitivity *derived, vs_text *warnings) {
  const char *line = derived->notes.text;
  for (const char *end; line && (end = strchr(line, '\n')); line = end + 1)
    vs_text_add(warnings, "%s%.*s", warnings->length ? " | " : "", (int)(end - line), line);
}

static void add_margin(const vs_case *c, vs_text *row) {
  const vs_judgement *weakest = c->result->verdict.weakest;
  add_number(row, weakest ? weakest->margin : NAN);
}

static void add_margin_error(const vs_case *c, vs_text *row) {
  const vs_judgement *weakest = c->result->verdict.weakest;
  add_number(row, weakest ? weakest->margin_error : NAN);
}

static void add_weakest(const vs_case *c, vs_text *row) {
  const vs_judgement *weakest = c->result->verdict.weakest;
  char name[VS_JUDGED_NAME];
  vs_text_add(row, "%s", weakest ? vs_verdict_name(weakest, name) : "");
}

static void add_rung(const vs_case *c, vs_text *row) {
  vs_text_add(row, "%d", c->result->ladder.rung);
}

static void add_leaving(const vs_case *c, vs_text *row) {
  add_number(row, c->result->watchers.absence.bound);
}

/* "unintended_firing of thyristor at 0.0408342 s (dv/dt of 324 V/us up to 406 V)". */
static void add_happened(const vs_case *c, vs_text *row) {
  const vs_verdict *v = &c->result->verdict;
  vs_text all = {0};
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    if (!vs_verdict_is_happening(j)) continue;
    vs_text_add(&all, "%s%s of %s", all.length ? " | " : "", vs_kinds_happening(j->measure)->what,
                j->device->name);
    if (j->stress.value > 0)
      vs_text_add(&all, " at %.6g s (%s)%s", j->stress.at_s, j->cause,
                  j->expected ? ", as expected" : "");
    else
      vs_text_add(&all, " did not happen, though expected");
    if (vs_verdict_word(j) == VS_UNDECIDED) vs_text_add(&all, ", in one of two runs");
  }
  vs_csv_cell(row, all.text ? all.text : "");
  vs_text_free(&all);
}

static void add_not_judged(const vs_case *c, vs_text *row) {
  const vs_result *r = c->result;
  vs_text all = {0};
  const vs_expects *expects = &r->scene->expects;
  if (vs_unjudged_is_told(r->watchers.devices, &r->verdict))
    vs_unjudged_write(r->watchers.devices, &r->verdict, &all);
  char name[2 * VS_DECK_NAME];
  for (size_t k = 0; k < expects->n_waivers; k++)
    vs_text_add(&all, "%s%s",
                k            ? ", "
                : all.length ? "; "
                             : "",
                vs_expect_waiver_name(&expects->waiver[k], name));
  if (expects->n_waivers) vs_text_add(&all, " (waived)");
  vs_csv_cell(row, all.text ? all.text : "");
  vs_text_free(&all);
}

static bool has_columns(const vs_plan *plan, const vs_judgement *line) {
  for (size_t k = 0; k < plan->n_columns; k++)
    if (plan->columns[k].line && vs_listed_line_is_of(plan->columns[k].name, line)) return true;
  return false;
}

/* Lines come with a deck's devices and a part's limits. Those of the first case, and of each deck,
 * part and tier that is varied, have columns; two that are varied together may bring others. */
static void add_lines_without_columns(const vs_case *c, vs_text *warnings) {
  const vs_verdict *v = &c->result->verdict;
  char name[VS_JUDGED_NAME];
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    if (vs_verdict_is_happening(j) || j->unknown || has_columns(c->plan, j)) continue;
    vs_text_add(warnings, "%s%s has no column: its margin is %.3g", warnings->length ? " | " : "",
                vs_verdict_name(j, name), j->margin);
  }
}

static void add_warnings(const vs_case *c, vs_text *row) {
  vs_text all = {0};
  vs_result_warnings(c->result, add_warning_to_cell, &all);
  add_lines_without_columns(c, &all);
  add_notes_of_derivatives(&c->derived, &all);
  vs_csv_cell(row, all.text ? all.text : "");
  vs_text_free(&all);
}

static void add_status(const vs_case *c, vs_text *row) {
  vs_text_add(row, "%d", vs_verdict_breach(&c->result->verdict) ? VS_CASE_VIOLATED : VS_CASE_DONE);
}

/* The line of the verdict of which column k is a number. `before` is that of column k - 1, which
 * mostly is the same. */
static const vs_judgement *find_line(const vs_case *c, size_t k, const vs_judgement *before) {
  const vs_report_column *column = &c->plan->columns[k];
  if (k && column[-1].line && !strcmp(strchr(column[-1].name, '.'), strchr(column->name, '.')))
    return before;
  return vs_listed_line_find(&c->result->verdict, column->name);
}

static void add_case_row(vs_case *c, vs_text *row) {
  static void (*const ADD[VS_ROLES])(const vs_case *c, vs_text *row) = {
      [VS_ROLE_MARGIN] = add_margin,         [VS_ROLE_ERROR] = add_margin_error,
      [VS_ROLE_WEAKEST] = add_weakest,       [VS_ROLE_RUNG] = add_rung,
      [VS_ROLE_LEAVING] = add_leaving,       [VS_ROLE_HAPPENED] = add_happened,
      [VS_ROLE_NOT_JUDGED] = add_not_judged, [VS_ROLE_WARNINGS] = add_warnings,
      [VS_ROLE_STATUS] = add_status};
  const vs_judgement *line = NULL;
  begin_row(c->plan, &c->present, row);
  for (size_t k = 0; k < c->plan->n_columns; k++) {
    vs_text_put(row, ",", 1);
    if (c->plan->columns[k].line) {
      line = find_line(c, k, line);
      add_line_number(row, vs_listed_line_value(line, c->plan->columns[k].name));
      continue;
    }
    vs_value v = find_value(c, k);
    add_number(row, v.known ? v.value : NAN);
  }
  for (int r = VS_ROLE_MARGIN; r <= VS_ROLE_STATUS; r++) {
    vs_text_put(row, ",", 1);
    ADD[r](c, row);
  }
}

/* ---- observers of the run: the run.csv that --keep runs asks for, and the orbit ---- */

typedef struct keeper {
  const vs_case *c;
  vs_file csv, peaks; /* closed where no run.csv is stored */
  vs_table table;
} keeper;

/* The table of all channels, without a stream. */
static vs_table table_of(const vs_scene *s) {
  vs_table table = vs_table_of(s);
  table.count = vs_channel_listed(&s->frame, table.channels);
  return table;
}

vs_status vs_case_check_csv(const vs_scene *s, uint64_t cases, vs_error *err) {
  const vs_table table = table_of(s);
  const double each = vs_table_bytes(&table), most = s->setup.limits.kept_bytes;
  char one[VS_LIMITS_SIZE], all[VS_LIMITS_SIZE];
  vs_status status = vs_table_check(&table, s->tree.root, s->setup.limits.csv_bytes, err);
  if (status || each * (double)cases <= most) return status;
  vs_limits_write(each, one);
  vs_limits_write(each * (double)cases, all);
  return vs_fail_at(err, vs_table_where(s->tree.root),
                    "--keep runs: %llu run.csv of about %s each would have %s; limits.kept = %.9g "
                    "bytes allows no more: take a longer run.sample, fewer cases, or raise it",
                    (unsigned long long)cases, one, all, most);
}

/* What limits.csv and this case's part of limits.kept leave to its peaks.csv, bytes. */
static double most_of_peaks(const keeper *k, const vs_scene *s) {
  const vs_limits_values *l = &s->setup.limits;
  double part = l->kept_bytes / (double)k->c->plan->count - vs_table_bytes(&k->table);
  return fmin(l->csv_bytes, part);
}

static vs_status begin_csv(keeper *k, const vs_scene *s, vs_error *err) {
  char folder[VS_PATH_SIZE + 32];
  int made;
  snprintf(folder, sizeof folder, "%s/%llu", k->c->keep, (unsigned long long)k->c->present.index);
  vs_status status = vs_case_check_csv(s, 1, err);
  if (!status) status = vs_file_folder_make(folder, &made, err);
  if (!status) status = vs_file_open(&k->csv, folder, "run.csv", err);
  if (!status) status = vs_file_open(&k->peaks, folder, VS_TABLE_PEAKS_FILE, err);
  if (status) return status;
  k->table = table_of(s);
  k->table.stream = k->csv.stream;
  k->table.peaks = k->peaks.stream;
  k->table.peaks_most = most_of_peaks(k, s);
  vs_table_begin(&k->table);
  return VS_OK;
}

static vs_status begin_run_of_case(void *ctx, vs_scene *s, vs_error *err) {
  keeper *k = ctx;
  if (k->c->steady) vs_steady_again(k->c->steady, s);
  return k->c->keep ? begin_csv(k, s, err) : VS_OK;
}

static vs_status accept_step_of_case(void *ctx, const vs_step *step, const vs_result *result,
                                     vs_error *err) {
  keeper *k = ctx;
  k->table.meters = result->meters;
  k->table.loop = result->loop;
  k->table.measures = result->watchers.measures;
  if (k->c->steady) vs_steady_accept(k->c->steady, step);
  return k->csv.stream ? vs_table_accept(&k->table, step, err) : VS_OK;
}

static void discard_csv(keeper *k) {
  vs_file_discard(&k->csv);
  vs_file_discard(&k->peaks);
  vs_table_end(&k->table);
}

/* Puts the case's files in their place; peaks.csv where run.csv needs it beside. */
static vs_status commit_csv(keeper *k, vs_error *err) {
  vs_status status = k->csv.stream ? vs_file_commit(&k->csv, err) : VS_OK;
  if (!status && k->peaks.stream && vs_table_found(&k->table) == VS_TABLE_SOME)
    status = vs_file_commit(&k->peaks, err);
  return status;
}

static void discard_attempt(void *ctx, const char *failed, int next) {
  keeper *k = ctx;
  (void)failed, (void)next;
  discard_csv(k);
}

/* ---- the run ---- */

/* Error: the orbit is unstable, so that the machine does not stay on it. A study that reports
 * `stable` has the row nevertheless. */
static vs_status judge_orbit(const vs_case *c, vs_error *err) {
  const vs_orbit *orbit = &c->steady->orbit;
  for (size_t k = 0; k < c->plan->n_columns; k++)
    if (!strcmp(c->plan->columns[k].name, VS_ORBIT_COLUMNS_STABLE) &&
        c->plan->columns[k].where.file)
      return VS_OK;
  if (orbit->stable || !vs_steady_is_judged(c->steady)) return VS_OK;
  return vs_fail(err, VS_RUN,
                 "the orbit is unstable: its largest multiplier has the size %.6g, so the machine "
                 "does not stay on it; report: [%s, ...] has it in the table nevertheless",
                 hypot(orbit->multiplier[0].re, orbit->multiplier[0].im), VS_ORBIT_COLUMNS_STABLE);
}

/* Completes the measures of the orbit behind its run. */
static vs_status end_orbit(vs_case *c, vs_error *err) {
  if (!c->steady) return VS_OK;
  vs_steady_finish(c->steady, c->result);
  return judge_orbit(c, err);
}

/* Finds the derivatives of the case's measures, where the study has some: before the run, which
 * makes the scene its own. */
static vs_status derive_measures(vs_case *c, vs_error *err) {
  const vs_sensitivity_order *order = c->plan->derivatives;
  return order ? vs_sensitivity_find(c->scene, order, &c->derived, err) : VS_OK;
}

/* Marks the value of that name, and keeps where it stands. False: no value of the machine's has it.
 */
static bool want_measure(vs_case *c, const char *name, vs_slot *slot) {
  vs_measure m;
  *slot = (vs_slot){0};
  for (int k = 0; vs_measure_at(&c->scene->setup.model, k, &m); k++)
    if (!strcmp(m.name, name)) {
      *slot = (vs_slot){m.slot, m.factor};
      return c->wants.has[m.slot] = true;
    }
  return false;
}

/* Which values of the machine the case needs, so that the run computes no others: those of its
 * columns, and the two that tell that nothing fires. NULL: all of them. */
static const vs_measure_set *find_wants(vs_case *c) {
  const char *machine = c->scene->setup.model.parameters.model;
  if (c->plan->derivatives) return NULL;
  if (!strcmp(c->machine, machine)) return c->wants_all ? NULL : &c->wants;
  snprintf(c->machine, sizeof c->machine, "%s", machine);
  c->wants = (vs_measure_set){.has = {[VS_M_T_FIRE] = true, [VS_M_I_PEAK] = true}};
  c->wants_all = false;
  for (size_t k = 0; k < c->plan->n_columns; k++)
    if (!c->plan->columns[k].line)
      c->wants_all = !want_measure(c, c->plan->columns[k].name, &c->slot[k]) || c->wants_all;
  return c->wants_all ? NULL : &c->wants;
}

/* Runs the scene of the case that was begun, and adds its row. The row's values are those of the
 * result; the axes' cells are the plan's own numbers (begin_row), not read back from the scene. */
static vs_status run_scene(vs_case *c, vs_text *row, vs_error *err) {
  keeper k = {.c = c};
  const vs_session_listener guest = {.ctx = &k,
                                     .begin = begin_run_of_case,
                                     .accept = accept_step_of_case,
                                     .again = discard_attempt,
                                     .late = true};
  const vs_session session = {
      .guest = c->keep || c->steady ? &guest : NULL, .wants = find_wants(c), .verify_edges = true};
  c->scene->order.memo = &c->memo;
  /* Derivatives come first, as a run makes the scene its own; in a study of orbits the scene then
   * becomes one period of its orbit; the run itself is as of `run`. */
  vs_status status = derive_measures(c, err);
  if (!status && c->steady) status = vs_steady_begin(c->steady, c->scene, c->plan->periods, err);
  if (!status) status = vs_steady_run(&session, c->scene, c->result, err);
  if (!status) status = end_orbit(c, err);
  if (!status) add_case_row(c, row);
  if (!status) status = commit_csv(&k, err);
  discard_csv(&k);
  if (c->steady) vs_steady_end(c->steady);
  vs_sensitivity_free(&c->derived);
  return status;
}

/* Reads the scene with the case's keys put over it. The first case reads all of the scene; a later
 * one reads again only what its keys change (vs_scene_reread). An axis' value goes into the scene's
 * tree as text with its unit, so that a key means the same in a study as in the scene's file. */
static vs_status read_scene_of_case(vs_case *c, vs_error *err) {
  const vs_plan *plan = c->plan;
  bool again = c->begun;
  vs_status status = VS_OK;
  if (!again) {
    status = vs_plan_scene(plan, c->scene, err);
    c->begun = true;
  }
  if (status) return status;
  vs_plan_put(plan, c->present.point, &c->scene->tree);
  status = again ? vs_scene_reread(c->scene, err) : vs_scene_read_sections(c->scene, NULL, err);
  if (!status && plan->periods) vs_scene_disable_control(c->scene);
  return status ? status : vs_plan_check_case(plan, c->present.point, c->scene, err);
}

vs_status vs_case_begin(vs_case *c, uint64_t index, const double *point, vs_error *err) {
  c->present = (which){.index = index, .point = point};
  vs_status status = read_scene_of_case(c, err);
  if (!status) status = vs_identity_of(c->identity, c->scene, c->present.id, err);
  return status;
}

/* How well a row's cell is the axis' number, whose `text` is written: 2, to its last digit; 1, as
 * another machine's libm may have rounded that; 0, not. */
static int cell_agrees(const char *cell, const vs_axis *axis, double number, char *text,
                       size_t size) {
  /* an axis has 12 digits, of which the last is at most 1e-11 of it; twice that for rounding */
  enum { DIGITS = 12 };
  const double most = 2 * pow(10, 1 - DIGITS);
  char *end;
  const bool is_word = !vs_axis_print(axis, number, text, size);
  if (!strcmp(cell, text)) return 2;
  return !is_word && fabs(strtod(cell, &end) - number) <= most * fabs(number) && end > cell &&
         !*end;
}

bool vs_case_is_row(vs_case *c, uint64_t index, const double *point, bool failed, char *row,
                    char *why, size_t size) {
  char *cell[HEAD + VS_PLAN_AXES], number[VS_NAME_SIZE];
  const vs_plan *plan = c->plan;
  vs_error refused = {0};
  bool exact = true;
  if (vs_csv_split(row, cell, HEAD + plan->n_axes, NULL) < HEAD + plan->n_axes) {
    snprintf(why, size, "its row is too short");
    return false;
  }
  for (size_t k = 0; k < plan->n_axes; k++) {
    const int agreed = cell_agrees(cell[HEAD + k], &plan->axes[k], point[k], number, sizeof number);
    exact = exact && agreed == 2;
    if (agreed) continue;
    snprintf(why, size, "its %.64s is %.64s; its row has '%.64s'", plan->axes[k].column, number,
             cell[HEAD + k]);
    return false;
  }
  vs_case_begin(c, index, point, &refused);
  /* the id follows from the last digits, too; a case that failed may not have come to it */
  if (!exact || (failed && !*cell[1]) || !strcmp(cell[1], c->present.id)) return true;
  snprintf(why, size, "its id is '%s'; its row has '%.64s'", c->present.id, cell[1]);
  return false;
}

int vs_case_end(vs_case *c, vs_status begun, vs_text *row, bool *circuit, vs_error *err) {
  size_t length = row->length;
  bool breach = false;
  vs_status status = begun;
  c->circuit = !status && c->scene->tier->by_ngspice;
  *circuit = c->circuit;
  if (!status) {
    status = run_scene(c, row, err);
    breach = !status && vs_verdict_breach(&c->result->verdict);
    vs_result_free(c->result);
  }
  if (!status) return breach ? VS_CASE_VIOLATED : VS_CASE_DONE;
  row->length = length; /* a row whose run.csv could not be stored is taken back */
  add_failure(c, err->text + err->place_size, row);
  return VS_CASE_FAILED;
}

int vs_case_run(vs_case *c, uint64_t index, const double *point, vs_text *row, bool *circuit) {
  vs_error err = {0};
  vs_status begun = vs_case_begin(c, index, point, &err);
  return vs_case_end(c, begun, row, circuit, &err);
}

vs_scene *vs_case_scene(vs_case *c) {
  return c->scene;
}

vs_status vs_case_become(vs_case *c, vs_case *other) {
  vs_scene *s = c->scene, *theirs = other->scene;
  const vs_tree tree = s->tree;
  const vs_warnings warnings = s->warnings;
  s->tree = theirs->tree;
  s->warnings = theirs->warnings;
  vs_setup *setup = &s->setup;
  vs_error err = {0};
  setup->run = theirs->setup.run;
  setup->timeline.events = theirs->setup.timeline.events;
  setup->loads = (vs_loads){0}; /* the run may be with one of those it had, which stay */
  theirs->tree = tree;
  theirs->warnings = warnings;
  c->present = other->present;
  return vs_setup_make_loads(&setup->timeline.events, setup->machine, &setup->model, &setup->loads,
                             &err);
}

void vs_case_failure(const vs_plan *plan, uint64_t index, const double *point, const char *why,
                     vs_text *row) {
  vs_error refused = {0};
  vs_case *c = vs_case_new(plan, NULL);
  vs_case_begin(c, index, point, &refused);
  add_failure(c, why, row);
  vs_case_free(c);
}
