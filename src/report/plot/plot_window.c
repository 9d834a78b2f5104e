/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/plot_window.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/file.h"
#include "base/gnuplot.h"
#include "base/units.h"
#include "members.h"
#include "plot/fourier.h"
#include "plot/strips.h"
#include "plot/time_window.h"
#include "report/plot.h"
#include "run/engineering.h"

/* ---- orbits: a coordinate and its rate over one another ---- */

static vs_status add_curve(const vs_time_window *s, const vs_probe_shown *p, size_t run,
                           vs_script *script, vs_error *err) {
  const vs_traces *t = &s->run[run].traces;
  vs_probe_shown rate;
  if (!vs_time_window_probe_rate(p, t, &rate))
    return vs_fail(err, VS_INPUT,
                   "--orbit: %s has no column of the rate of '%s', which coordinates have", t->path,
                   p->column);
  if (!run) {
    vs_gnuplot_add(script, "set xlabel ");
    vs_gnuplot_quoted(script, p->label);
    vs_gnuplot_add(script, "\nset ylabel ");
    vs_gnuplot_quoted(script, rate.label);
    vs_gnuplot_add(script, "\nplot ");
  }
  vs_gnuplot_add(script, run ? ", " : "");
  vs_gnuplot_path(script, t->path);
  vs_gnuplot_add(script,
                 " using ($1 >= %.12g && $1 <= %.12g ? $%d*%g : NaN):($%d*%g) skip 1 with lines lc "
                 "rgb %s lw 1.2 title ",
                 s->from_s, s->to_s, vs_traces_find(t, p->column) + 1, p->scale,
                 vs_traces_find(t, rate.column) + 1, rate.scale, vs_time_window_colour(run));
  vs_gnuplot_quoted(script, s->run[run].folder);
  return VS_OK;
}

/* Adds the orbits to a gnuplot script. Error, VS_INPUT: a run has no column for a probe's rate. */
static vs_status phase_plane_add(const vs_time_window *s, vs_script *script, vs_error *err) {
  vs_status status = VS_OK;
  vs_time_window_begin(script);
  vs_gnuplot_add(script, "set multiplot layout %d,1\n", s->probes.count);
  vs_time_window_legend(s, script);
  for (int k = 0; k < s->probes.count; k++) {
    for (size_t r = 0; r < s->runs && !status; r++)
      status = add_curve(s, &s->probes.item[k], r, script, err);
    vs_gnuplot_add(script, "\n");
  }
  vs_gnuplot_add(script, "unset multiplot\n");
  return status;
}

enum { WIDTH = 940, HEAD = 70, SQUARE = 420 }; /* pixels */

static const char *name_of(const vs_plot_window_options *o) {
  return o->fft ? "spectrum" : o->orbit ? "orbit" : "closeup";
}

/* ---- runs and time ---- */

/* The length of a cycle of the mains, s, from summary.json; 20 ms where it does not say. */
static double cycle_of(const char *folder) {
  char path[VS_PATH_SIZE];
  vs_tree tree = {0};
  vs_error unread = {0};
  snprintf(path, sizeof path, "%s/summary.json", folder);
  bool known = !vs_tree_read(path, &tree, &unread);
  const vs_node *scene = known ? vs_tree_child_map(tree.root, "scene") : NULL;
  const vs_node *frequency = vs_tree_child(vs_tree_child(scene, "supply"), "frequency");
  double hertz = vs_member_number(vs_tree_child(frequency, "value")) *
                 (frequency ? vs_units_factor(vs_member_word(frequency, "unit")) : 1);
  vs_tree_free(&tree);
  return hertz > 0 ? 1 / hertz : 0.02;
}

static vs_status open_runs(const vs_plot_window_options *o, vs_time_window *s, vs_error *err) {
  vs_status status = VS_OK;
  if (o->n_folders > VS_TIME_WINDOW_RUNS)
    return vs_fail(err, VS_INPUT, "plot: at most %d runs fit over one another",
                   VS_TIME_WINDOW_RUNS);
  for (size_t k = 0; k < o->n_folders && !status; k++) {
    vs_time_window_run *run = &s->run[s->runs++];
    vs_probes_shown probes = {.count = 0};
    if (strpbrk(o->folders[k], "\r\n"))
      return vs_fail(err, VS_INPUT, "plot: a line break in a name");
    run->folder = o->folders[k];
    status = vs_traces_read(run->folder, &run->traces, err);
    if (!status) status = vs_time_window_read_moments(run->folder, &run->moments, err);
    if (!status) status = vs_time_window_find_probes(o->probes, &run->traces, &probes, err);
    if (!status && !k) s->probes = probes;
    if (!status) run->cycle_s = cycle_of(run->folder);
  }
  for (int p = 0; p < s->probes.count && !status; p++) /* the usual ones are the first run's */
    for (size_t k = 1; k < s->runs && !status; k++)
      if (vs_traces_like(&s->run[k].traces, s->probes.item[p].of) < 1)
        status = vs_fail(err, VS_INPUT, "%s has no column %s, as %s has; choose by --probe",
                         s->run[k].traces.path, s->probes.item[p].column, s->run[0].folder);
  return status;
}

static vs_status read_time(const char *option, const char *word, double *time_s, vs_error *err) {
  char why[256];
  if (!word || vs_units_read(word, "s", time_s, why, sizeof why)) return VS_OK;
  return vs_fail(err, VS_INPUT, "%s %.100s: a time is wanted, as 60ms", option, word);
}

/* True if any run has a row in the stretch of time; otherwise the picture would be empty. */
static bool has_rows(const vs_time_window *s) {
  for (size_t k = 0; k < s->runs; k++)
    for (size_t r = 0; r < s->run[k].traces.rows; r++) {
      double at = vs_trace_time(&s->run[k].traces, r);
      if (at >= s->from_s && at <= s->to_s) return true;
    }
  return false;
}

/* Finds the stretch to show. *why tells why it was chosen; NULL: the user asked for it. */
static vs_status find_window(const vs_plot_window_options *o, vs_time_window *s, const char **why,
                             vs_error *err) {
  double until = 0, from = INFINITY, to = -INFINITY, start = INFINITY;
  for (size_t k = 0; k < s->runs; k++) {
    const vs_traces *t = &s->run[k].traces;
    double a, b, end = vs_trace_time(t, t->rows - 1);
    const char *reason = vs_time_window_choose(&s->run[k].moments, s->run[k].cycle_s, end, &a, &b);
    if (!k) *why = reason;
    from = fmin(from, a), to = fmax(to, b), until = fmax(until, end);
    start = fmin(start, vs_trace_time(t, 0));
  }
  s->from_s = fmax(from, start);
  s->to_s = to;
  if (o->from && !o->to) s->to_s = until;
  if (o->to && !o->from) s->from_s = start;
  if (o->from || o->to) *why = NULL;
  vs_status status = read_time("--from", o->from, &s->from_s, err);
  if (!status) status = read_time("--to", o->to, &s->to_s, err);
  if (!status && !(s->from_s < s->to_s && s->from_s < until && s->to_s > start))
    status = vs_fail(err, VS_INPUT,
                     "plot: nothing is between %.6g s and %.6g s; recorded is %.6g "
                     "s to %.6g s",
                     s->from_s, s->to_s, start, until);
  if (!status && !has_rows(s))
    status = vs_fail(err, VS_INPUT,
                     "plot: no row of run.csv is between %.9g s and %.9g s; a smaller run.sample "
                     "gives more of them",
                     s->from_s, s->to_s);
  return status;
}

/* ---- pictures ---- */

static vs_status add_closeup_script(const vs_plot_window_options *o, const vs_time_window *s,
                                    bool svg, vs_script *script, vs_error *err) {
  int height = o->orbit ? SQUARE : VS_TIME_WINDOW_HEIGHT;
  vs_gnuplot_code(script,
                  svg ? "set terminal svg noenhanced dynamic" : "set terminal pngcairo noenhanced");
  vs_gnuplot_add(script, " size %d,%d font 'sans,11' background rgb 'white'\n",
                 o->orbit ? 560 : WIDTH, HEAD + height * s->probes.count);
  if (o->fft) return vs_fourier_add(s, script, err);
  if (o->orbit) return phase_plane_add(s, script, err);
  vs_strips_add(s, script);
  return VS_OK;
}

static vs_status draw_one(const vs_plot_window_options *o, const vs_time_window *s,
                          const char *folder, const char *name, vs_error *err) {
  vs_script script = {0};
  size_t length = strlen(name);
  bool svg = length > 4 && !strcmp(name + length - 4, ".svg");
  vs_status status = add_closeup_script(o, s, svg, &script, err);
  if (!status) status = vs_gnuplot_draw(script.text.text, folder, name, o->quiet, err);
  vs_gnuplot_free(&script);
  return status;
}

static vs_status draw_closeup(const vs_plot_window_options *o, const vs_time_window *s,
                              vs_error *err) {
  static const char *const ENDINGS[] = {"png", "svg"};
  vs_status status = VS_OK;
  if (o->output) return draw_one(o, s, "", o->output, err);
  for (size_t e = 0; e < sizeof ENDINGS / sizeof *ENDINGS && !status; e++) {
    char name[32];
    snprintf(name, sizeof name, "%s.%s", name_of(o), ENDINGS[e]);
    status = draw_one(o, s, o->folders[0], name, err);
  }
  return status;
}

/* Writes spectrum.csv beside spectrum.png, or FILE_spectrum.csv beside the FILE.png of -o, as
 * FILE.csv may be the user's data. */
static vs_status write_numbers(const vs_plot_window_options *o, const vs_time_window *s,
                               vs_error *err) {
  char name[VS_PATH_SIZE] = "spectrum.csv";
  vs_text csv = {0}, words = {0};
  vs_file file = {0};
  if (o->output) /* which ends in .png or .svg */
    snprintf(name, sizeof name, "%.*s_spectrum.csv", (int)strlen(o->output) - 4, o->output);
  vs_status status = vs_fourier_csv(s, &csv, err);
  if (!status) status = vs_fourier_say(s, &words, err);
  if (!status) status = vs_file_open(&file, o->output ? "" : o->folders[0], name, err);
  if (!status) {
    fwrite(csv.text, 1, csv.length, file.stream); /* an error stays in the stream */
    status = vs_file_commit(&file, err);
  }
  if (!status && !o->quiet) printf("%s\n%s", file.path, words.text);
  vs_text_free(&csv);
  vs_text_free(&words);
  return status;
}

static void say_window(const vs_time_window *s, const char *why) {
  char from[VS_ENGINEERING_SIZE], to[VS_ENGINEERING_SIZE];
  printf("shown: %s to %s, %s; --from and --to choose\n", vs_engineering_text(s->from_s, "s", from),
         vs_engineering_text(s->to_s, "s", to), why);
}

vs_status vs_plot_window_command(const vs_plot_window_options *o, vs_error *err) {
  const vs_plot_options names = {o->folders[0], o->output, NULL, o->quiet};
  const char *why = NULL;
  if (o->fft && o->orbit)
    return vs_fail(err, VS_INPUT, "plot: --fft and --orbit are two pictures; ask for one");
  vs_status status = vs_plot_check(&names, err);
  if (status) return status;
  vs_time_window *s = vs_alloc(1, sizeof *s);
  status = open_runs(o, s, err);
  if (!status && o->orbit && !o->probes) s->probes.count = 1;
  if (!status) status = find_window(o, s, &why, err);
  if (!status) status = draw_closeup(o, s, err);
  if (!status && o->fft) status = write_numbers(o, s, err);
  if (!status && why && !o->quiet) say_window(s, why);
  for (size_t k = 0; k < s->runs; k++) {
    vs_traces_free(&s->run[k].traces);
    vs_time_window_free_moments(&s->run[k].moments);
  }
  free(s);
  return status;
}

bool vs_plot_window_wanted(const char *folder) {
  vs_moments moments = {0};
  vs_error unread = {0};
  bool wanted = !vs_time_window_read_moments(folder, &moments, &unread) &&
                !isnan(vs_time_window_first_event(&moments));
  vs_time_window_free_moments(&moments);
  return wanted;
}
