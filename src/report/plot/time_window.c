/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/time_window.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/path.h"
#include "base/text.h"
#include "base/units.h"

/* ---- what happened, and the stretch of time that shows it ---- */

enum {
  FEW = 8,        /* up to this many moments are all shown */
  OFTEN = 4,      /* a moment that happens once is rare where another one happens this many times */
  LAST_CYCLES = 3 /* shown of a run in which nothing stands out */
};

static vs_status read_moment(vs_moments *m, const vs_csv *csv, vs_error *err) {
  char *end = csv->cell[0];
  double at = strtod(csv->cell[0], &end);
  vs_where where = {csv->file, csv->line, 1};
  if (csv->count != 2 || *end || end == csv->cell[0] || !isfinite(at))
    return vs_fail_at(err, where, "a time in s and what happened are wanted");
  m->item = vs_alloc_grow(m->item, m->count, sizeof *m->item);
  m->item[m->count++] =
      (vs_moment){at, vs_copy(csv->cell[1]), strstr(csv->cell[1], " begins (") != NULL};
  return VS_OK;
}

vs_status vs_time_window_read_moments(const char *folder, vs_moments *m, vs_error *err) {
  char path[VS_PATH_SIZE];
  if (strlen(folder) > VS_PATH_SIZE / 2)
    return vs_fail(err, VS_INPUT, "%.100s...: too long a name", folder);
  snprintf(path, sizeof path, "%s/events.csv", folder);
  vs_status status = vs_path_check_result(path, err);
  if (status) return status;
  FILE *f = fopen(path, "r");
  if (!f) return VS_OK;
  vs_csv csv = {.file = path, .stream = f, .comments = true};
  status = vs_csv_next(&csv, err); /* the header */
  while (!status && csv.count) {
    status = vs_csv_next(&csv, err);
    if (!status && csv.count) status = read_moment(m, &csv, err);
  }
  vs_csv_free(&csv);
  fclose(f);
  return status;
}

void vs_time_window_free_moments(vs_moments *m) {
  for (size_t k = 0; k < m->count; k++) free(m->item[k].what);
  free(m->item);
  *m = (vs_moments){0};
}

double vs_time_window_first_event(const vs_moments *m) {
  double first_s = NAN;
  for (size_t k = 0; k < m->count; k++)
    if (m->item[k].is_event) first_s = fmin(first_s, m->item[k].at_s); /* of NaN and x: x */
  return first_s;
}

/* The number of moments with this text. */
static size_t count_kind(const vs_moments *m, const char *what) {
  size_t n = 0;
  for (size_t k = 0; k < m->count; k++) n += !strcmp(m->item[k].what, what);
  return n;
}

/* True if the moment's text occurs once, and another one OFTEN times or more. */
static bool is_rare(const vs_moments *m, size_t k) {
  if (count_kind(m, m->item[k].what) > 1) return false;
  for (size_t other = 0; other < m->count && other < 64; other++)
    if (count_kind(m, m->item[other].what) >= OFTEN) return true;
  return false;
}

static bool is_any(const vs_moments *m, size_t k) {
  (void)k;
  return m->count <= FEW;
}

static bool is_event(const vs_moments *m, size_t k) {
  return m->item[k].is_event;
}

const char *vs_time_window_choose(const vs_moments *m, double cycle_s, double until_s,
                                  double *from_s, double *to_s) {
  static const struct {
    bool (*chosen)(const vs_moments *m, size_t k);
    const char *why;
  } RULES[] = {{is_event, "around the scene's events"},
               {is_rare, "around what happens once"},
               {is_any, "around what happens"}};
  for (size_t r = 0; r < sizeof RULES / sizeof *RULES; r++) {
    double first = INFINITY, last = -INFINITY;
    for (size_t k = 0; k < m->count; k++)
      if (RULES[r].chosen(m, k)) {
        first = fmin(first, m->item[k].at_s);
        last = fmax(last, m->item[k].at_s);
      }
    if (first > last) continue;
    *from_s = fmax(0, first - cycle_s);
    *to_s = fmin(until_s, last + 2 * cycle_s);
    return RULES[r].why;
  }
  *from_s = fmax(0, until_s - LAST_CYCLES * cycle_s);
  *to_s = until_s;
  return "the last cycles, as nothing stands out";
}

/* ---- probes ---- */

/* Lengths and angles are shown in thousandths. */
static void fill_probe(vs_probe_shown *p, const vs_column *c) {
  bool small = !strcmp(c->unit, "m") || !strcmp(c->unit, "rad");
  p->of = c;
  snprintf(p->column, sizeof p->column, "%.*s", VS_PROBE_SIZE - 1, c->name);
  if (*c->unit)
    snprintf(p->label, sizeof p->label, "%.*s / %s%.20s", VS_PROBE_SIZE - 26, c->quantity,
             small ? "m" : "", c->unit);
  else
    snprintf(p->label, sizeof p->label, "%.*s", VS_PROBE_SIZE - 1, c->name);
  p->scale = small ? 1e3 : 1;
}

static vs_status find_one(const char *word, const vs_traces *t, vs_probes_shown *p, vs_error *err) {
  for (size_t c = 1; c < t->columns; c++)
    if ((!strcmp(t->name[c], word) || !strcmp(t->column[c].quantity, word)) &&
        strlen(t->name[c]) < VS_PROBE_SIZE) {
      if (p->count == VS_PROBES_MOST)
        return vs_fail(err, VS_INPUT, "--probe: at most %d probes fit a picture", VS_PROBES_MOST);
      fill_probe(&p->item[p->count++], &t->column[c]);
      return VS_OK;
    }
  return vs_fail(err, VS_INPUT, "--probe: %s has no column '%.100s'%s", t->path, word,
                 vs_text_hint(word, (const char *const *)t->name + 1, t->columns - 1, "").text);
}

/* Takes the first column, which is a coordinate if these were recorded, and those that every tier
 * has. */
static void take_usual(const vs_traces *t, vs_probes_shown *p) {
  static const char *const USUAL[] = {"force_n", "i_a",       "i_thyristor_a",
                                      "v_eva_v", "v_mains_v", "v_ds_v"};
  if (t->columns > 1 && strlen(t->name[1]) < VS_PROBE_SIZE)
    fill_probe(&p->item[p->count++], &t->column[1]);
  for (size_t k = 0; k < sizeof USUAL / sizeof *USUAL; k++) {
    const int c = vs_traces_find(t, USUAL[k]);
    if (c > 1) fill_probe(&p->item[p->count++], &t->column[c]);
  }
}

vs_status vs_time_window_find_probes(const char *words, const vs_traces *t, vs_probes_shown *p,
                                     vs_error *err) {
  vs_status status = VS_OK;
  if (!words) {
    take_usual(t, p);
    return p->count ? VS_OK : vs_fail_at(err, (vs_where){t->path, 1, 1}, "records nothing to draw");
  }
  char *copy = vs_copy(words), *rest = copy;
  for (char *word; !status && (word = strsep(&rest, ","));)
    status = find_one(word + strspn(word, " "), t, p, err);
  free(copy);
  return status;
}

bool vs_time_window_probe_rate(const vs_probe_shown *probe, const vs_traces *t,
                               vs_probe_shown *rate) {
  for (size_t c = 1; c < t->columns; c++)
    if (!strcmp(t->column[c].role, VS_COLUMN_RATE) &&
        !strcmp(t->column[c].of, probe->of->quantity) && strlen(t->name[c]) < VS_PROBE_SIZE) {
      fill_probe(rate, &t->column[c]);
      return true;
    }
  return false;
}

void vs_time_window_probe_named(const vs_probe_shown *probe, const char *word, char *name,
                                size_t size) {
  char suffix[VS_COLUMN_UNIT];
  vs_units_suffix(probe->of->unit, suffix, sizeof suffix);
  snprintf(name, size, "%s_%s%s%s", probe->of->quantity, word, *suffix ? "_" : "", suffix);
}

/* ---- style ---- */

void vs_time_window_begin(vs_script *script) {
  vs_gnuplot_add(script, "set grid lt 1 lw 0.5 lc rgb '#d0d0d0'\nset border lc rgb '#404040'\n"
                         "set lmargin 12\nset rmargin 4\nset datafile separator ','\n");
}

void vs_time_window_legend(const vs_time_window *s, vs_script *script) {
  vs_gnuplot_add(script, s->runs > 1 ? "set key tmargin right horizontal reverse Left samplen 2\n"
                                     : "unset key\n");
}

const char *vs_time_window_colour(size_t run) {
  static const char *const COLOURS[VS_TIME_WINDOW_RUNS] = {
      "#1f4e79", "#d1495b", "#2a9d6f", "#e08e1b", "#8e5ea2", "#17a2b8", "#7f5539", "#606060"};
  return COLOURS[run % VS_TIME_WINDOW_RUNS];
}
