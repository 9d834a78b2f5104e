/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/tornado.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/gnuplot.h"
#include "report/scale.h"

enum { MOST_BARS = 4096 };

typedef struct bar {
  char measure[128], key[192];
  double value;
  int panel; /* the number of its measure, from 0 */
} bar;

typedef struct tornado {
  bar *item; /* owned */
  size_t count;
  int panels;
} tornado;

static void name_table(const char *folder, char path[VS_PATH_SIZE]) {
  snprintf(path, VS_PATH_SIZE, "%s/sensitivity.csv", folder);
}

bool vs_tornado_here(const char *folder) {
  char path[VS_PATH_SIZE];
  name_table(folder, path);
  return !access(path, F_OK);
}

/* ---- what is drawn ---- */

/* Adds a row of the file. Rows of one measure stand together; a row without a derivative is left
 * out. */
static void take_sensitivity_row(const vs_csv *csv, tornado *t) {
  bar *b = &t->item[t->count], *last = t->count ? b - 1 : NULL;
  if (!*csv->cell[2]) return;
  snprintf(b->measure, sizeof b->measure, "%s", csv->cell[0]);
  snprintf(b->key, sizeof b->key, "%s", csv->cell[1]);
  b->value = strtod(csv->cell[2], NULL);
  b->panel = last && !strcmp(last->measure, b->measure) ? last->panel : t->panels++;
  t->count++;
}

static vs_status read_sensitivity_table(const char *folder, tornado *t, vs_error *err) {
  enum { COLUMNS = 9 };
  char path[VS_PATH_SIZE];
  name_table(folder, path);
  vs_status status = vs_path_check_result(path, err);
  if (status) return status;
  FILE *f = fopen(path, "r");
  if (!f) return vs_fail(err, VS_INPUT, "%s: cannot be read: %s", path, strerror(errno));
  vs_csv csv = {.file = path, .stream = f};
  status = vs_csv_next(&csv, err); /* the header */
  while (!status && !(status = vs_csv_next(&csv, err)) && csv.count && t->count < MOST_BARS) {
    if (csv.count < COLUMNS)
      status =
          vs_fail_at(err, (vs_where){path, csv.line, 1}, "at least %d cells are wanted", COLUMNS);
    else
      take_sensitivity_row(&csv, t);
  }
  vs_csv_free(&csv);
  fclose(f);
  if (!status && !t->count)
    status = vs_fail_at(err, (vs_where){path, 1, 1}, "holds nothing to draw");
  return status;
}

/* Orders by measure, then the longest bar first. */
static int longest_first(const void *a, const void *b) {
  const bar *one = a, *other = b;
  double x = fabs(one->value), y = fabs(other->value);
  if (one->panel != other->panel) return one->panel - other->panel;
  return (x < y) - (x > y);
}

/* ---- the picture ---- */

enum { WIDTH = 900, EDGE = 90, BAR = 28 /* pixels */ };

/* Writes each bar's number at its end, on the side `side`, 1 or -1. A panel without such bars gets
 * no labels, as gnuplot 5.4 crashes if none of the labels has a place. */
static void add_numbers(vs_script *script, const bar *first, size_t count, int side) {
  bool any = false;
  for (size_t k = 0; k < count; k++) any = any || (first[k].value < 0) == (side < 0);
  if (any)
    vs_gnuplot_add(script,
                   side < 0 ? ", $bars%d using ($1<0?$1:0/0):2:(sprintf('%%+.4g',$1)) with labels "
                              "right offset %g,0 notitle"
                            : ", $bars%d using ($1<0?0/0:$1):2:(sprintf('%%+.4g',$1)) with labels "
                              "left offset %g,0 notitle",
                   first->panel, 0.7 * side);
}

static void add_panel(vs_script *script, const bar *first, size_t count, double top,
                      double height) {
  double longest = fabs(first->value) > 0 ? fabs(first->value) : 1;
  vs_gnuplot_add(script, "$bars%d << EOD\n", first->panel);
  for (size_t k = 0; k < count; k++) vs_gnuplot_add(script, "%.9g %d\n", first[k].value, -(int)k);
  vs_gnuplot_add(script, "EOD\nset tmargin at screen %.5f\nset bmargin at screen %.5f\nset title ",
                 top, top - height);
  vs_gnuplot_quoted(script, first->measure);
  vs_gnuplot_add(script, "\nset xrange [%.9g:%.9g]\nset yrange [%.1f:0.6]\nset ytics (",
                 -1.25 * longest, 1.25 * longest, 0.4 - (double)count);
  for (size_t k = 0; k < count; k++) {
    vs_gnuplot_add(script, k ? ", " : "");
    vs_gnuplot_quoted(script, first[k].key);
    vs_gnuplot_add(script, " %d", -(int)k);
  }
  vs_gnuplot_add(
      script,
      ")\nplot $bars%d using (0):2:(0):1:($2-0.36):($2+0.36) with boxxyerror fs solid 0.9 "
      "noborder fc rgb %s notitle",
      first->panel, vs_scale_colour_good);
  add_numbers(script, first, count, 1);
  add_numbers(script, first, count, -1);
  vs_gnuplot_add(script, "\n");
}

static void add_tornado_script(const tornado *t, bool svg, vs_script *script) {
  size_t bars = t->count + (size_t)t->panels; /* a title is as high as a bar */
  int height = EDGE + BAR * (int)bars + 40 * t->panels;
  double unit = (double)BAR / height, top = 1 - 45.0 / height;
  vs_gnuplot_code(script, svg ? "set terminal svg" : "set terminal pngcairo");
  vs_gnuplot_add(
      script,
      " noenhanced size %d,%d font 'sans,%d' background rgb 'white'\nset "
      "multiplot\nset lmargin at screen 0.28\nset rmargin at screen 0.96\nset border 1 lc "
      "rgb '#404040'\nset grid x lt 1 lw 0.5 lc rgb '#d0d0d0'\nset ytics scale 0\nset "
      "arrow from first 0, graph 0 to first 0, graph 1 nohead lc rgb "
      "'#404040' front\n",
      WIDTH, height, svg ? 13 : 10);
  for (size_t k = 0, n; k < t->count; k += n) {
    for (n = 1; k + n < t->count && t->item[k + n].panel == t->item[k].panel;) n++;
    bool last = k + n == t->count;
    if (last) vs_gnuplot_add(script, "set xlabel 'd ln|measure| / d ln key'\n");
    add_panel(script, &t->item[k], n, top, (double)n * unit);
    top -= (double)(n + 1) * unit + 40.0 / height;
  }
  vs_gnuplot_add(script, "unset multiplot\n");
}

static vs_status draw_tornado(const tornado *t, const char *folder, bool svg, bool quiet,
                              vs_error *err) {
  vs_script script = {0};
  add_tornado_script(t, svg, &script);
  vs_status status =
      vs_gnuplot_draw(script.text.text, folder, svg ? "tornado.svg" : "tornado.png", quiet, err);
  vs_gnuplot_free(&script);
  return status;
}

vs_status vs_tornado_draw(const char *folder, bool quiet, vs_error *err) {
  tornado t = {.item = vs_alloc(MOST_BARS, sizeof *t.item)};
  vs_status status = read_sensitivity_table(folder, &t, err);
  qsort(t.item, t.count, sizeof *t.item, longest_first);
  if (!status) status = draw_tornado(&t, folder, false, quiet, err);
  if (!status) status = draw_tornado(&t, folder, true, quiet, err);
  free(t.item);
  return status;
}
