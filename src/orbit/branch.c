/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/branch.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/gnuplot.h"
#include "base/shutdown.h"
#include "branch_output.h"
#include "branch_points.h"
#include "continuation.h"

/* ---- the picture ---- */

/* The picture of a branch shows the least and the largest travel over the key, stable parts as
 * solid lines, unstable ones dashed, and the marks as dots. */

/* How the parts of the curves are drawn: by whether they are stable, and possible at all. */
typedef struct part {
  bool unstable, beyond;
  const char *title, *line;
} part;
static const part PARTS[] = {
    {false, false, "stable", "lc rgb '#1f4e79' lw 2"},
    {true, false, "unstable", "lc rgb '#d1495b' lw 1.6 dt 2"},
    {false, true, "stable, beyond the gap", "lc rgb '#9fb8d0' lw 1.6"},
    {true, true, "unstable, beyond the gap", "lc rgb '#e8b4bc' lw 1.6 dt 2"},
};
enum { N_PARTS = sizeof PARTS / sizeof *PARTS };

static bool is_of_part(const vs_branch_point *at, const part *p) {
  return (at->unstable > 0) == p->unstable && (*vs_branch_output_beyond(at) != 0) == p->beyond;
}

static void add_point_of_branch(const vs_continuation *w, const vs_branch_point *at, bool largest,
                                vs_script *script) {
  const vs_orbit_extremes *t = &at->turns;
  vs_gnuplot_add(script, "%.9g %.9g\n", at->z[w->path.count],
                 1e3 * (largest ? t->largest : t->least).best.value);
}

/* A curve's pieces of one kind, cut by blank lines. A piece begins at the point before it, which
 * is a mark where the kind changes. */
static void add_pieces(const vs_continuation *w, const part *p, bool largest, vs_script *script) {
  bool was = false;
  for (size_t r = 0; r < w->count; r++) {
    const vs_branch_point *at = &w->row[r].at;
    bool is = is_of_part(at, p);
    if (is && !was && r) add_point_of_branch(w, &w->row[r - 1].at, largest, script);
    if (is) add_point_of_branch(w, at, largest, script);
    if (!is && was) vs_gnuplot_add(script, "\n");
    was = is;
  }
  vs_gnuplot_add(script, "\n");
}

static bool has_part(const vs_continuation *w, const part *p) {
  for (size_t r = 0; r < w->count; r++)
    if (is_of_part(&w->row[r].at, p)) return true;
  return false;
}

static void add_data_of_branch(const vs_continuation *w, vs_script *script) {
  for (int p = 0; p < N_PARTS; p++)
    for (int largest = 0; largest < 2; largest++) {
      vs_gnuplot_add(script, "$part%d%d << EOD\n", p, largest);
      add_pieces(w, &PARTS[p], largest, script);
      vs_gnuplot_add(script, "EOD\n");
    }
  for (int k = 0; vs_mark_kinds[k]; k++) {
    vs_gnuplot_add(script, "$mark%d << EOD\n", k);
    for (size_t r = 0; r < w->count; r++)
      if (w->row[r].mark.kind == vs_mark_kinds[k])
        add_point_of_branch(w, &w->row[r].at, false, script);
    vs_gnuplot_add(script, "EOD\n");
  }
}

static bool has_mark(const vs_continuation *w, const vs_mark_kind *kind) {
  for (size_t r = 0; r < w->count; r++)
    if (w->row[r].mark.kind == kind) return true;
  return false;
}

/* gnuplot's types of points, all of them full. */
static const int POINTS[] = {5, 7, 9, 11, 13, 15, 10, 8, 6};

static void add_plot_of_branch(const vs_continuation *w, vs_script *script) {
  const char *comma = "plot ";
  for (int p = 0; p < N_PARTS; p++) {
    if (!has_part(w, &PARTS[p])) continue;
    vs_gnuplot_code(script, comma);
    vs_gnuplot_add(script, "$part%d0 with lines ", p);
    vs_gnuplot_code(script, PARTS[p].line);
    vs_gnuplot_add(script, " title %s, $part%d1 with lines ", PARTS[p].title, p);
    vs_gnuplot_code(script, PARTS[p].line);
    vs_gnuplot_add(script, " notitle");
    comma = ", ";
  }
  for (int k = 0; vs_mark_kinds[k]; k++)
    if (has_mark(w, vs_mark_kinds[k]))
      vs_gnuplot_add(script, ", $mark%d with points pt %d ps 1.2 lc rgb '#202020' title %s", k,
                     POINTS[k % (int)(sizeof POINTS / sizeof *POINTS)], vs_mark_kinds[k]->name);
  vs_gnuplot_add(script, "\n");
}

static void add_script_of_branch(const vs_continuation *w, vs_script *script) {
  const vs_axis *axis = &w->along->axis;
  vs_text label = {0};
  vs_text_add(&label, "%s%s%s", axis->key, *axis->unit ? " / " : "", axis->unit);
  vs_gnuplot_add(script,
                 "set terminal pngcairo noenhanced size 840,560 font 'sans,11' background rgb "
                 "'white'\nset grid lt 1 lw 0.5 lc rgb '#d0d0d0'\nset border lc rgb "
                 "'#404040'\nset rmargin 3\nset key outside top center horizontal\n"
                 "set ylabel 'least and largest travel / mm'\nset xlabel ");
  vs_gnuplot_quoted(script, label.text);
  vs_gnuplot_add(script, "\n");
  add_data_of_branch(w, script);
  add_plot_of_branch(w, script);
  vs_text_free(&label);
}

/* Writes branch.png into the folder. Errors: those of vs_gnuplot_picture, and of the file. */
static vs_status write_branch_picture(const vs_continuation *w, const char *folder, vs_error *err) {
  vs_script script = {0};
  char *picture = NULL;
  size_t size = 0;
  vs_file file;
  add_script_of_branch(w, &script);
  vs_status status = vs_gnuplot_picture(script.text.text, &picture, &size, err);
  vs_gnuplot_free(&script);
  if (!status) status = vs_file_open(&file, folder, "branch.png", err);
  if (!status) {
    fwrite(picture, 1, size, file.stream); /* an error stays in the stream */
    status = vs_file_commit(&file, err);
  }
  free(picture);
  return status;
}

/* ---- files ---- */

static vs_status write_branch_csv(const vs_continuation *w, const char *folder, int digits,
                                  vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, folder, "branch.csv", err);
  if (status) return status;
  vs_branch_output_csv(w, digits, file.stream);
  return vs_file_commit(&file, err);
}

/* The picture comes last. Where gnuplot is missing the numbers are there all the same; *drawn says
 * so. */
static vs_status write_branch_files(const vs_continuation *w, const vs_branch_options *o,
                                    const char *json, bool *drawn, vs_error *err) {
  int made = 0;
  vs_error why = {0};
  vs_status status = vs_file_folder_make(o->folder, &made, err);
  if (!status) status = write_branch_csv(w, o->folder, o->digits, err);
  if (!status) status = vs_file_write(o->folder, "branch.json", json, err);
  if (status) vs_file_folder_unmake(o->folder, made);
  if (status) return status;
  *drawn = !write_branch_picture(w, o->folder, &why);
  if (!*drawn) fprintf(stderr, "vibrospice: warning: no branch.png: %s\n", why.text);
  return VS_OK;
}

/* ---- the command ---- */

static vs_status say_branch(const vs_continuation *w, const vs_branch_options *o, vs_error *err) {
  vs_text json = {0};
  bool drawn = false;
  vs_branch_output_json(w, &json);
  vs_status status = o->folder ? write_branch_files(w, o, json.text, &drawn, err) : VS_OK;
  if (!status && o->json)
    fputs(json.text, stdout);
  else if (!status && !o->quiet) {
    vs_branch_output_print(w, stdout);
    if (o->folder)
      printf("written: branch.csv, branch.json%s in %s\n", drawn ? ", branch.png" : "", o->folder);
  }
  vs_text_free(&json);
  if (!status && w->end == VS_CONTINUATION_STOPPED)
    status = vs_fail(err, VS_SIGNAL, "stopped by a signal; the branch is told up to %s = %.9g%s%s",
                     w->along->axis.key, w->row[w->count - 1].at.z[w->path.count],
                     *w->along->axis.unit ? " " : "", w->along->axis.unit);
  if (!status && (w->end == VS_CONTINUATION_STUCK || w->end == VS_CONTINUATION_SPENT))
    status = vs_fail(err, w->end == VS_CONTINUATION_SPENT ? VS_BUDGET : VS_RUN,
                     "the branch cannot be followed beyond %s = %.9g%s%s: %s", w->along->axis.key,
                     w->row[w->count - 1].at.z[w->path.count], *w->along->axis.unit ? " " : "",
                     w->along->axis.unit, w->why);
  return status;
}

/* A branch wants the run's exact derivatives, of which ngspice tells none. */
static vs_status refuse_tier(const vs_scene *s, vs_error *err) {
  const char *ideal = vs_tiers_automatic(false)->name, *circuit = vs_compiled_tier.name;
  const char *known = s->tier->by_ngspice ? circuit : ideal;
  if (!s->tier->by_ngspice && !s->tier->gap_at_rest) return VS_OK;
  return vs_fail_at(
      err, vs_tree_place(s->tree.root, "run.tier"),
      "steady --along: this is tier %s (%s), and branches are followed on tier %s, or with the "
      "circuit on tier %s; write --tier %s, or run.tier: %s",
      s->tier->name, s->why, ideal, circuit, known, known);
}

vs_status vs_branch_command(const vs_branch_options *o, vs_scene *scene, vs_error *err) {
  vs_branch_parameter along = {0};
  vs_continuation walk = {0};
  vs_status status = refuse_tier(scene, err);
  if (!status) status = vs_branch_parameter_read(&along, scene, &o->words, err);
  vs_shutdown_mode before = vs_shutdown_mode_set(VS_SHUTDOWN_WITH_TIMEOUT);
  if (!status) status = vs_continuation_go(&walk, &along, o->periods, o->stop, err);
  vs_shutdown_mode_set(VS_SHUTDOWN_WHEN_KEPT);
  if (!status)
    status = vs_branch_parameter_move(&along, along.from, err); /* which the files tell of */
  if (!status) status = say_branch(&walk, o, err);
  vs_shutdown_mode_set(before);
  vs_continuation_free(&walk);
  vs_branch_parameter_free(&along);
  return status;
}
