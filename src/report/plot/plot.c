/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/plot.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/gnuplot.h"
#include "plot/overlay.h"
#include "plot/sheets.h"
#include "traces.h"

enum { MOST_POINTS = 100 }; /* up to so many measured points each get a mark */

const char *const vs_plot_pictures[] = {
    "motion_run", "motion_100ms", "pulse_50ms", "measured_run", "measured_100ms", "control_run",
    "harmonics",  "closeup",      "spectrum",   "orbit",        "verdict",        NULL};

typedef struct run_file {
  char path[VS_PATH_SIZE];
  char drawn[VS_PATH_SIZE]; /* the file that is drawn, with the same columns */
  char *header;             /* its first line */
  double until_s;           /* of its last row */
  vs_overlay overlay;
  const vs_sheets *sheets; /* borrowed */
} run_file;

static vs_status open_run(const char *folder, run_file *run, vs_error *err) {
  snprintf(run->path, sizeof run->path, "%s/run.csv", folder);
  vs_status status = vs_path_check_result(run->path, err);
  if (status) return status;
  FILE *f = fopen(run->path, "r");
  int why = errno;
  if (!f) return vs_traces_none(folder, why, err);
  size_t size = 0, row_size = 0;
  char *row = NULL;
  if (vs_alloc_row(&run->header, &size, VS_CSV_LONGEST, f) < 0) {
    free(run->header); /* the call allocates it even when it fails */
    run->header = vs_copy("");
  }
  int rows = 0;
  while (vs_alloc_row(&row, &row_size, VS_CSV_LONGEST, f) > 0)
    run->until_s = strtod(row, NULL), rows++;
  status = vs_file_was_read(f, run->path, err);
  run->header[strcspn(run->header, "\r\n")] = '\0';
  free(row);
  fclose(f);
  if (status) return status;
  size_t drawn_rows;
  if (run->until_s > 0) return vs_traces_drawn(folder, run->header, run->drawn, &drawn_rows, err);
  if (rows != 1)
    return vs_fail_at(err, (vs_where){run->path, 1, 1},
                      rows ? "no row has a time above 0" : "holds no rows");
  return vs_fail_at(
      err, (vs_where){run->path, 2, 1},
      "this row, of t = 0, is the only one, and a picture wants two; run with a larger "
      "run.until, or a smaller run.sample");
}

/* The number of a column, from 1; 0: there is no such column. */
static int find_column(const char *header, const char *name) {
  size_t n = strlen(name);
  int column = 1;
  for (const char *s = header; *s; column++) {
    size_t length = strcspn(s, ",");
    if (length == n && !strncmp(s, name, n)) return column;
    s += length + (s[length] == ',');
  }
  return 0;
}

static void add_terminal(vs_script *script, const vs_sheet *s, int rows, const char *output) {
  bool svg = strlen(output) > 4 && !strcmp(output + strlen(output) - 4, ".svg");
  vs_gnuplot_code(script,
                  svg ? "set terminal svg noenhanced dynamic" : "set terminal pngcairo noenhanced");
  vs_gnuplot_add(script, " size %d,%d font 'sans,%d' background rgb 'white'\n", 420 * s->columns,
                 60 + 260 * rows, 11);
  vs_gnuplot_add(script, "set multiplot layout %d,%d title ", rows, s->columns);
  vs_gnuplot_caption(script, s->title, 420 * s->columns, 13);
  vs_gnuplot_add(script, " font 'sans,13'\n");
}

static void add_title(vs_script *script, const char *title) {
  vs_gnuplot_add(script, " title ");
  vs_gnuplot_quoted(script, title);
}

/* Adds what instruments show of the panel's curve, constant from sample to sample. */
static void add_instruments(vs_script *script, const run_file *run, const vs_panel *p,
                            double time_scale) {
  static const char *const COLOURS[] = {"#e08e1b", "#2a9d6f", "#8e5ea2"};
  const vs_sheet_shown *s;
  for (int n = 0; (s = vs_sheets_shown(run->sheets, p->column, n)); n++) {
    if (!strcmp(s->column, p->column)) continue;
    vs_gnuplot_add(script, ", ");
    vs_gnuplot_path(script, run->drawn);
    vs_gnuplot_add(script, " using ($1*%g):($%d*%g) skip 1 with steps lc rgb %s lw 1", time_scale,
                   find_column(run->header, s->column), p->scale, COLOURS[n % 3]);
    add_title(script, s->name);
  }
}

/* Adds a panel: the computed curve, and over it the instruments' and the measured one, where there
 * are such. */
static void add_panel(vs_script *script, const run_file *run, const vs_panel *p,
                      double time_scale) {
  const vs_overlay *o = &run->overlay;
  const vs_overlay_curve *measured = vs_overlay_find(o, p->column);
  const vs_sheet_shown *shown = vs_sheets_shown(run->sheets, p->column, 0);
  bool legend = measured || shown, alone = shown && !strcmp(shown->column, p->column);
  if (o->count || run->sheets->n_shown)
    vs_gnuplot_add(script, legend ? "set key tmargin right horizontal reverse Left samplen 2\n"
                                  : "set key default\n");
  vs_gnuplot_add(script, "set ylabel ");
  vs_gnuplot_quoted(script, p->label);
  vs_gnuplot_add(script, "\nplot ");
  vs_gnuplot_path(script, run->drawn);
  vs_gnuplot_add(script, " using ($1*%g):($%d*%g) skip 1 with lines lc rgb '#1f4e79' lw 1.2",
                 time_scale, find_column(run->header, p->column), p->scale);
  if (alone)
    add_title(script, shown->name);
  else
    vs_gnuplot_add(script, legend ? " title 'computed'" : " notitle");
  add_instruments(script, run, p, time_scale);
  if (measured) {
    vs_gnuplot_add(script, ", ");
    vs_gnuplot_path(script, o->path);
    vs_gnuplot_add(script, " using ($1*%.17g):($%d*%.17g) skip 1 with ", time_scale * o->time_s,
                   measured->column, p->scale * measured->factor);
    vs_gnuplot_add(script, o->rows > MOST_POINTS ? "lines" : "linespoints pt 7 ps 0.4");
    vs_gnuplot_add(script, " lc rgb '#d1495b' lw 1.2 ");
    vs_gnuplot_add(script, "title 'measured'");
  }
  vs_gnuplot_add(script, "\n");
}

/* How many of the sheet's panels run.csv has columns for. */
static int count_panels(const run_file *run, const vs_sheet *s) {
  int there = 0;
  for (int k = 0; k < s->count; k++) there += find_column(run->header, s->panels[k].column) > 0;
  return there;
}

/* Adds the panels that run.csv has columns for, and returns their number. */
static int add_sheet(vs_script *script, const run_file *run, const vs_sheet *s,
                     const char *output) {
  int there = count_panels(run, s);
  if (!there) return 0;
  double until = s->until_s > 0 ? fmin(s->until_s, run->until_s) : run->until_s;
  bool ms = until <= 0.5;
  add_terminal(script, s, (there + s->columns - 1) / s->columns, output);
  vs_gnuplot_add(script,
                 ms ? "set xrange [%.9g:%.9g]\nset xlabel 't / ms'\n"
                    : "set xrange [%.9g:%.9g]\nset xlabel 't / s'\n",
                 (ms ? 1e3 : 1) * s->from_s, (ms ? 1e3 : 1) * until);
  for (int k = 0; k < s->count; k++)
    if (find_column(run->header, s->panels[k].column))
      add_panel(script, run, &s->panels[k], ms ? 1e3 : 1);
  vs_gnuplot_add(script, "unset multiplot\n");
  return there;
}

/* Writes the file. It appears only once it is complete, and replaces what had its name, even a
 * link. */
static vs_status write_picture(const char *output, const char *picture, size_t size,
                               vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, "", output, err);
  if (status) return status;
  fwrite(picture, 1, size, file.stream); /* an error stays in the stream */
  return vs_file_commit(&file, err);
}

static vs_status draw_sheets(const run_file *run, const vs_sheet *s, const char *output, bool quiet,
                             vs_error *err) {
  vs_script script = {0};
  char *picture = NULL;
  size_t size = 0;
  vs_gnuplot_add(&script, "set grid lt 1 lw 0.5 lc rgb '#d0d0d0'\nset border lc rgb '#404040'\n"
                          "set rmargin 3\nset datafile separator ','\n");
  if (!add_sheet(&script, run, s, output)) {
    vs_gnuplot_free(&script);
    return vs_fail_at(err, (vs_where){run->path, 1, 1}, "records nothing that '%s' shows",
                      s->title);
  }
  vs_status status = vs_gnuplot_picture(script.text.text, &picture, &size, err);
  vs_gnuplot_free(&script);
  if (!status) status = write_picture(output, picture, size, err);
  free(picture);
  if (!status && !quiet) printf("%s\n", output);
  return status;
}

/* The panel that shows the column; NULL: none of these sheets does. */
static const vs_panel *find_panel(const vs_sheet *sheets, size_t count, const char *column) {
  const vs_panel *found = NULL;
  for (size_t s = 0; s < count && !found; s++) found = vs_sheet_find(&sheets[s], column);
  return found;
}

/* Adds a panel to the last of the sheets for each measured curve that none of them shows. */
static void add_measured(vs_sheet *sheets, size_t count, const vs_sheets *all,
                         const vs_overlay *overlay) {
  for (size_t c = 0; c < overlay->count; c++) {
    const vs_overlay_curve *curve = &overlay->curves[c];
    if (find_panel(sheets, count, curve->name)) continue;
    const vs_panel *elsewhere = find_panel(all->set, VS_SHEETS, curve->name);
    vs_sheet_add(&sheets[count - 1], curve->name, elsewhere ? elsewhere->label : curve->label,
                 elsewhere ? elsewhere->scale : 1);
  }
}

/* Draws the sheets that run.csv has columns for. If it has none for any sheet, the error of the
 * first sheet tells. */
static vs_status draw_all(const char *folder, const run_file *run, const vs_sheets *all, bool quiet,
                          vs_error *err) {
  static const char *const ENDINGS[] = {"png", "svg"};
  vs_status status = VS_OK;
  int there = 0;
  for (size_t k = 0; k < VS_SHEETS; k++) /* a run over an older one removes what it knows by name */
    assert(vs_plot_pictures[k] && !strcmp(vs_plot_pictures[k], all->set[k].name));
  for (size_t k = 0; k < VS_SHEETS; k++) there += count_panels(run, &all->set[k]);
  for (size_t k = 0; k < VS_SHEETS; k++)
    for (size_t e = 0; e < sizeof ENDINGS / sizeof *ENDINGS && !status; e++) {
      char output[VS_PATH_SIZE];
      if (there && !count_panels(run, &all->set[k])) continue;
      snprintf(output, sizeof output, "%s/%s.%s", folder, all->set[k].name, ENDINGS[e]);
      status = draw_sheets(run, &all->set[k], output, quiet, err);
    }
  return status;
}

/* Error: the folder cannot be written to. gnuplot would take ten lines to say so. */
static vs_status check_writable(const char *output, vs_error *err) {
  char folder[VS_PATH_SIZE];
  const char *slash = strrchr(output, '/');
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - output + 1) : 1,
           slash ? output : ".");
  return access(folder, W_OK | X_OK)
             ? vs_fail(err, VS_INPUT, "-o %s: cannot be written: %s", output, strerror(errno))
             : VS_OK;
}

/* True for a name that a script can have: a line break would end its line there. */
static bool is_name(const char *name) {
  return !name || (strlen(name) <= VS_PATH_SIZE / 2 && !strpbrk(name, "\r\n"));
}

vs_status vs_plot_check(const vs_plot_options *o, vs_error *err) {
  const char *ending = o->output ? strrchr(o->output, '.') : NULL;
  if (!is_name(o->folder) || !is_name(o->output) || !is_name(o->overlay))
    return vs_fail(err, VS_INPUT, "plot: too long a name, or a line break in it");
  if (o->output && (!ending || (strcmp(ending, ".png") && strcmp(ending, ".svg"))))
    return vs_fail(err, VS_INPUT, "-o %s: the file's name must end in .png or .svg", o->output);
  return o->output ? check_writable(o->output, err) : VS_OK;
}

vs_status vs_plot_command(const vs_plot_options *o, vs_error *err) {
  run_file run = {0};
  vs_status status = vs_plot_check(o, err);
  if (!status) status = open_run(o->folder, &run, err);
  const vs_overlay_run against = {o->folder, run.path, run.header, run.until_s};
  if (!status && o->overlay) status = vs_overlay_read(o->overlay, &against, &run.overlay, err);
  vs_sheets *all = vs_sheets_new(o->folder, run.header ? run.header : "", run.until_s);
  run.sheets = all;
  if (!status && o->output) {
    add_measured(&all->overview, 1, all, &run.overlay);
    status = draw_sheets(&run, &all->overview, o->output, o->quiet, err);
  } else if (!status) {
    add_measured(all->set, VS_SHEETS_OF_RUN, all, &run.overlay);
    status = draw_all(o->folder, &run, all, o->quiet, err);
  }
  free(all);
  vs_overlay_free(&run.overlay);
  free(run.header);
  return status;
}
