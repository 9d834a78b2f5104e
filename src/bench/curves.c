/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "curves.h"

#include "base/gnuplot.h"
#include "report/scale.h"

/* A gnuplot data block of at most MOST points: steps are dense where nothing shows. */
static void add_points(const vs_figures_curve *c, size_t number, vs_script *script) {
  enum { MOST = 4000 };
  size_t every = 1 + c->points / MOST;
  vs_gnuplot_add(script, "$curve%zu << EOD\n", number);
  for (size_t k = 0; k < c->points; k += every)
    vs_gnuplot_add(script, "%.6g %.6g\n", c->x[k], c->y[k]);
  vs_gnuplot_add(script, "EOD\n");
}

static void add_panel(const vs_figures_curve *c, size_t number, vs_script *script) {
  vs_gnuplot_add(script, c->log_x ? "set logscale x\nset title " : "unset logscale x\nset title ");
  vs_gnuplot_caption(script, c->title, 380, 10);
  vs_gnuplot_add(script, "\nset xlabel ");
  vs_gnuplot_quoted(script, c->x_label);
  vs_gnuplot_add(script, "\nset ylabel ");
  vs_gnuplot_quoted(script, c->y_label);
  vs_gnuplot_add(script, "\nplot $curve%zu using 1:2 with lines lw 1.5 lc rgb %s notitle\n", number,
                 vs_scale_colours[number % VS_COLOURS]);
}

vs_status vs_curves_draw(const vs_figures *f, const char *title, char **picture, size_t *size,
                         vs_error *err) {
  vs_script script = {0};
  for (size_t k = 0; k < f->n_curves; k++) add_points(&f->curve[k], k, &script);
  vs_gnuplot_add(&script,
                 "set terminal pngcairo noenhanced size %zu,360 font 'sans,10' background rgb "
                 "'white'\nset multiplot layout 1,%zu title ",
                 420 * f->n_curves, f->n_curves);
  vs_gnuplot_caption(&script, title, (int)(420 * f->n_curves), 10);
  vs_gnuplot_add(&script,
                 "\nset grid lt 1 lw 0.5 lc rgb '#d0d0d0'\nset border 3\nset tics nomirror\n");
  for (size_t k = 0; k < f->n_curves; k++) add_panel(&f->curve[k], k, &script);
  vs_gnuplot_add(&script, "unset multiplot\n");
  vs_status status = vs_gnuplot_picture(script.text.text, picture, size, err);
  vs_gnuplot_free(&script);
  return status;
}
