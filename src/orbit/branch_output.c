/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "branch_output.h"

#include <math.h>

#include "base/units.h"
#include "branch_points.h"
#include "orbit_extremes.h"
#include "run/summary.h"
#include "run/version.h"

enum { DIGITS = 12, SHOWN = 24 /* points in the table, besides the marks */ };

static const vs_model *model_of_walk(const vs_continuation *w) {
  return &w->along->scene->setup.model;
}

const char *vs_branch_output_beyond(const vs_branch_point *at) {
  if (at->iron_m <= 0) return "iron";
  return at->pole_m < 0 ? "pole_cover" : "";
}

/* The key of a fold is known better by far than its multiplier, which goes with the square root of
 * the key's distance. */
static const double ABOUT_ONE = 1e-2;

/* What becomes of a machine that is put on the orbit. */
static const char *state_of(const vs_continuation *w, const vs_continuation_row *row) {
  const vs_branch_point *at = &row->at;
  bool neutral = row->mark.kind && row->mark.kind->neutral;
  for (int k = 0; k < w->path.count && neutral; k++)
    neutral = hypot(at->multiplier[k].re, at->multiplier[k].im) < 1 + ABOUT_ONE;
  return neutral ? "neutral" : at->unstable ? "unstable" : "stable";
}

/* ---- the columns ---- */

/* A number of a point, besides the key and those of the coordinates. */
typedef struct column {
  const char *name, *unit;
  double (*value)(const vs_branch_point *at);
} column;

static double least(const vs_branch_point *at) {
  return at->turns.least.best.value;
}
static double largest(const vs_branch_point *at) {
  return at->turns.largest.best.value;
}
static double contacts(const vs_branch_point *at) {
  return vs_orbit_extremes_contacts(&at->turns);
}
static double speed(const vs_branch_point *at) {
  return at->turns.speed_m_s;
}
static double firings(const vs_branch_point *at) {
  return at->turns.fired;
}
static double period(const vs_branch_point *at) {
  return at->period_s;
}
static double re(const vs_branch_point *at) {
  return at->multiplier[0].re;
}
static double im(const vs_branch_point *at) {
  return at->multiplier[0].im;
}
static double size(const vs_branch_point *at) {
  return hypot(at->multiplier[0].re, at->multiplier[0].im);
}
static double unstable(const vs_branch_point *at) {
  return at->unstable;
}

static const column COLUMNS[] = {{"gap_min", "m", least},       {"gap_max", "m", largest},
                                 {"contacts", "", contacts},    {"contact_speed", "m/s", speed},
                                 {"firings", "", firings},      {"period", "s", period},
                                 {"multiplier_re", "", re},     {"multiplier_im", "", im},
                                 {"multiplier_size", "", size}, {"unstable", "", unstable}};
enum { N_COLUMNS = sizeof COLUMNS / sizeof *COLUMNS };

static const char *mark_of(const vs_continuation_row *row) {
  return row->mark.kind ? row->mark.kind->name : "";
}

/* ---- CSV ---- */

static void add_header(const vs_continuation *w, FILE *out) {
  const vs_model *m = model_of_walk(w);
  char suffix[64];
  fprintf(out, "%s", w->along->axis.column);
  for (int i = 0; i < 2 * m->dof; i++) {
    const vs_coordinate *c = &m->machine->coordinates[i / 2];
    vs_units_suffix(c->unit, suffix, sizeof suffix);
    fprintf(out, ",%s_%s%s%s", c->name, i % 2 ? "max" : "min", *suffix ? "_" : "", suffix);
  }
  for (int k = 0; k < N_COLUMNS; k++) {
    vs_units_suffix(COLUMNS[k].unit, suffix, sizeof suffix);
    fprintf(out, ",%s%s%s", COLUMNS[k].name, *suffix ? "_" : "", suffix);
  }
  fputs(",state,beyond,mark,error\n", out);
}

void vs_branch_output_csv(const vs_continuation *w, int digits, FILE *out) {
  int dof = model_of_walk(w)->dof;
  add_header(w, out);
  for (size_t r = 0; r < w->count; r++) {
    const vs_continuation_row *row = &w->row[r];
    /* a mark is known to more digits than a curve needs */
    fprintf(out, "%.*g", digits > DIGITS ? digits : DIGITS, row->at.z[w->path.count]);
    for (int i = 0; i < 2 * dof; i++) fprintf(out, ",%.*g", digits, row->at.turns.of[i].best.value);
    for (int k = 0; k < N_COLUMNS; k++) fprintf(out, ",%.*g", digits, COLUMNS[k].value(&row->at));
    fprintf(out, ",%s,%s,%s,", state_of(w, row), vs_branch_output_beyond(&row->at), mark_of(row));
    if (row->mark.kind) fprintf(out, "%.2g", row->mark.error);
    fputc('\n', out);
  }
}

/* ---- how it ended ---- */

static void add_end(const vs_continuation *w, vs_text *text) {
  const vs_branch_parameter *a = w->along;
  const char *blank = *a->axis.unit ? " " : "", *unit = a->axis.unit;
  double last = w->row[w->count - 1].at.z[w->path.count];
  vs_text_add(text, "the branch ");
  if (w->end == VS_CONTINUATION_REACHED)
    vs_text_add(text, "leaves the range at %.9g%s%s, its other end", a->to, blank, unit);
  else if (w->end == VS_CONTINUATION_BACK)
    vs_text_add(text, "turns, and leaves the range where it began, at %.9g%s%s", a->from, blank,
                unit);
  else if (w->end == VS_CONTINUATION_MERGED)
    vs_text_add(text, "of period %d ends at %.9g%s%s, in one of a smaller period", w->path.periods,
                last, blank, unit);
  else if (w->end == VS_CONTINUATION_STOPPED)
    vs_text_add(text, "was followed to %s = %.9g%s%s, where a signal stopped it", a->axis.key, last,
                blank, unit);
  else
    vs_text_add(text, "cannot be followed beyond %s = %.9g%s%s: %s", a->axis.key, last, blank, unit,
                w->why);
}

/* ---- JSON ---- */

static void add_row_of_branch(const vs_continuation *w, const vs_continuation_row *row,
                              vs_json *json) {
  const vs_model *m = model_of_walk(w);
  const char *beyond = vs_branch_output_beyond(&row->at);
  vs_json_object(json, NULL, VS_JSON_ROW);
  if (row->mark.kind) {
    vs_json_text(json, "kind", row->mark.kind->name);
    if (row->mark.kind->count) vs_json_whole(json, "stop", row->mark.which + 1);
  }
  vs_json_number(json, "key", row->at.z[w->path.count], DIGITS);
  if (row->mark.kind) vs_json_number(json, "error", row->mark.error, 3);
  for (int i = 0; i < 2 * m->dof; i++) {
    char name[VS_MACHINE_NAME + 16];
    snprintf(name, sizeof name, "%s_%s", m->machine->coordinates[i / 2].name,
             i % 2 ? "max" : "min");
    vs_json_number(json, name, row->at.turns.of[i].best.value, DIGITS);
  }
  for (int k = 0; k < N_COLUMNS; k++)
    vs_json_number(json, COLUMNS[k].name, COLUMNS[k].value(&row->at), DIGITS);
  vs_json_text(json, "state", state_of(w, row));
  vs_json_text(json, "beyond", *beyond ? beyond : NULL);
  vs_json_end(json);
}

static void add_rows(const vs_continuation *w, const char *name, bool marks, vs_json *json) {
  vs_json_array(json, name, VS_JSON_LINES);
  for (size_t r = 0; r < w->count; r++)
    if (marks == (w->row[r].mark.kind != NULL)) add_row_of_branch(w, &w->row[r], json);
  vs_json_end(json);
}

void vs_branch_output_json(const vs_continuation *w, vs_text *text) {
  static const char *const ENDS[] = {
      [VS_CONTINUATION_REACHED] = "reached", [VS_CONTINUATION_BACK] = "back",
      [VS_CONTINUATION_MERGED] = "merged",   [VS_CONTINUATION_STUCK] = "stuck",
      [VS_CONTINUATION_SPENT] = "spent",     [VS_CONTINUATION_STOPPED] = "stopped"};
  const vs_branch_parameter *a = w->along;
  vs_text end = {0};
  add_end(w, &end);
  vs_json json = vs_json_new(text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_version_json(&json);
  vs_summary_scene(&json, a->scene);
  vs_json_text(&json, "tier", a->scene->tier->name);
  vs_json_text(&json, "along", a->axis.key);
  vs_json_text(&json, "unit", a->axis.unit);
  vs_json_number(&json, "from", a->from, DIGITS);
  vs_json_number(&json, "to", a->to, DIGITS);
  vs_json_whole(&json, "period", w->path.periods);
  vs_json_text(&json, "end", ENDS[w->end]);
  vs_json_text(&json, "why", end.text);
  add_rows(w, "marks", true, &json);
  add_rows(w, "points", false, &json);
  vs_json_end(&json);
  vs_text_add(text, "\n");
  vs_text_free(&end);
}

/* ---- the table ---- */

static void print_row_of_branch(const vs_continuation *w, const vs_continuation_row *row,
                                FILE *out) {
  const vs_branch_point *at = &row->at;
  const char *beyond = vs_branch_output_beyond(at);
  fprintf(out, "%18.12g %14.7g %14.7g %5.0f %12.5g %12.9f  %-9s %-10s", at->z[w->path.count],
          1e3 * least(at), 1e3 * largest(at), contacts(at), speed(at), size(at), state_of(w, row),
          beyond);
  if (row->mark.kind) fprintf(out, " %s +- %.1g", mark_of(row), row->mark.error);
  fputc('\n', out);
}

/* A line on each kind of mark that the branch has. */
static void print_kinds(const vs_continuation *w, FILE *out) {
  for (const vs_mark_kind *const *kind = vs_mark_kinds; *kind; kind++) {
    int count = 0;
    for (size_t r = 0; r < w->count; r++) count += w->row[r].mark.kind == *kind;
    if (count) fprintf(out, "%-10s %3d  %s\n", (*kind)->name, count, (*kind)->text);
  }
  for (size_t r = 0; r < w->count; r++)
    if (*vs_branch_output_beyond(&w->row[r].at)) {
      fputs("beyond: computed as if there were room; the machine has no such orbit\n", out);
      break;
    }
}

void vs_branch_output_print(const vs_continuation *w, FILE *out) {
  const vs_axis *axis = &w->along->axis;
  size_t points = w->count - w->marks, every = (points + SHOWN - 1) / SHOWN, n = 0;
  char head[VS_KEY_SIZE + 32];
  vs_text end = {0};
  snprintf(head, sizeof head, "%s%s%s", axis->key, *axis->unit ? " " : "", axis->unit);
  fprintf(out, "%18s %14s %14s %5s %12s %12s\n", head, "gap_min mm", "gap_max mm", "met",
          "speed m/s", "|multiplier|");
  for (size_t r = 0; r < w->count; r++) {
    bool mark = w->row[r].mark.kind != NULL;
    bool shown = mark || n % every == 0 || r + 1 == w->count;
    n += !mark;
    if (shown) print_row_of_branch(w, &w->row[r], out);
  }
  fputc('\n', out);
  print_kinds(w, out);
  add_end(w, &end);
  fprintf(out, "%s; %zu points, %ld runs over a period\n", end.text, points, w->path.runs);
  vs_text_free(&end);
}
