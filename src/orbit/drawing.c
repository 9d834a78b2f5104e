/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drawing.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "rows.h"
#include "base/gnuplot.h"

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

static bool is_of(const vs_path_point *at, const part *p) {
  return (at->unstable > 0) == p->unstable && (*vs_rows_beyond(at) != 0) == p->beyond;
}

static void add_point(const vs_walk *w, const vs_path_point *at, bool largest, vs_script *script) {
  const vs_turns *t = &at->turns;
  vs_gnuplot_add(script, "%.9g %.9g\n", at->z[w->path.count],
                 1e3 * (largest ? t->largest : t->least).best.value);
}

/* A curve's pieces of one kind, cut by blank lines. A piece begins at the point before it, which
 * is a mark where the kind changes. */
static void add_pieces(const vs_walk *w, const part *p, bool largest, vs_script *script) {
  bool was = false;
  for (size_t r = 0; r < w->count; r++) {
    const vs_path_point *at = &w->row[r].at;
    bool is = is_of(at, p);
    if (is && !was && r) add_point(w, &w->row[r - 1].at, largest, script);
    if (is) add_point(w, at, largest, script);
    if (!is && was) vs_gnuplot_add(script, "\n");
    was = is;
  }
  vs_gnuplot_add(script, "\n");
}

static bool has_part(const vs_walk *w, const part *p) {
  for (size_t r = 0; r < w->count; r++)
    if (is_of(&w->row[r].at, p)) return true;
  return false;
}

static void add_data(const vs_walk *w, vs_script *script) {
  for (int p = 0; p < N_PARTS; p++)
    for (int largest = 0; largest < 2; largest++) {
      vs_gnuplot_add(script, "$part%d%d << EOD\n", p, largest);
      add_pieces(w, &PARTS[p], largest, script);
      vs_gnuplot_add(script, "EOD\n");
    }
  for (int k = 0; vs_mark_kinds[k]; k++) {
    vs_gnuplot_add(script, "$mark%d << EOD\n", k);
    for (size_t r = 0; r < w->count; r++)
      if (w->row[r].mark.kind == vs_mark_kinds[k]) add_point(w, &w->row[r].at, false, script);
    vs_gnuplot_add(script, "EOD\n");
  }
}

static bool has_mark(const vs_walk *w, const vs_mark_kind *kind) {
  for (size_t r = 0; r < w->count; r++)
    if (w->row[r].mark.kind == kind) return true;
  return false;
}

/* gnuplot's types of points, all of them full. */
static const int POINTS[] = {5, 7, 9, 11, 13, 15, 10, 8, 6};

static void add_plot(const vs_walk *w, vs_script *script) {
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

static void add_script(const vs_walk *w, vs_script *script) {
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
  add_data(w, script);
  add_plot(w, script);
  vs_text_free(&label);
}

vs_status vs_drawing_write(const vs_walk *w, const char *folder, vs_error *err) {
  vs_script script = {0};
  char *picture = NULL;
  size_t size = 0;
  vs_file file;
  add_script(w, &script);
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
