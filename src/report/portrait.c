/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "portrait.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/gnuplot.h"
#include "report/scale.h"
#include "base/units.h"

enum { WIDTH = 900, HIGH = 290, LOW = 190, TOP = 50, UNDER = 26, UNDER_LABEL = 52 };

/* A picture that is being made: panels one under the other. */
typedef struct portrait {
  const vs_outcome *o;
  vs_script script;
  int panels_high, panels_low; /* of all there will be */
  int height, at;              /* pixels in all, and where the next panel begins, from above */
} portrait;

/* Places the next panel, of that height; `under` of it are for what stands below its frame. */
static void place(portrait *p, int high, int under) {
  double top = 1 - (double)p->at / p->height, bottom = 1 - (double)(p->at + high) / p->height;
  vs_gnuplot_add(&p->script, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n",
                 top - 8. / p->height, bottom + (double)under / p->height);
  p->at += high;
}

static void label(portrait *p, char axis, const char *name, const char *unit) {
  char pretty[64], text[VS_NAME_SIZE + 128];
  vs_scale_unit(unit, pretty, sizeof pretty);
  snprintf(text, sizeof text, "%s%s%s", name, *pretty ? " / " : "", pretty);
  vs_gnuplot_add(&p->script, "set %clabel ", axis);
  vs_gnuplot_quoted(&p->script, text);
  vs_gnuplot_add(&p->script, "\n");
}

/* ---- a column ---- */

/* Adds the column's samples as the data block $D: t in ms, measured, fitted, residual. */
static void add_samples(portrait *p, const vs_outcome_column *c, double factor) {
  const vs_inquiry_run *run = &p->o->inquiry->runs[c->run];
  vs_gnuplot_add(&p->script, "$D << EOD\n");
  for (size_t k = 0; k < run->recording.n_samples; k++) {
    const vs_sample *s = &run->recording.samples[k];
    size_t n = run->datum + run->aims.count + k;
    if ((size_t)s->column != c->column) continue;
    vs_gnuplot_add(&p->script, "%.9g %.9g %.9g %.6g\n", 1e3 * s->t_s, s->value * factor,
                   p->o->estimate.computed[n] * factor, p->o->estimate.residual[n]);
  }
  vs_gnuplot_add(&p->script, "EOD\n");
}

/* The prefix in which the largest amount has one to three digits before the point. */
static double prefix_of(const portrait *p, const vs_outcome_column *c, char *prefix) {
  const vs_recording *r = &p->o->inquiry->runs[c->run].recording;
  double most = 0;
  for (size_t k = 0; k < r->n_samples; k++)
    if ((size_t)r->samples[k].column == c->column) most = fmax(most, fabs(r->samples[k].value));
  *prefix = '\0';
  if (r->columns.item[c->column].si != 1) return 1 / r->columns.item[c->column].si;
  if (!most || most >= 1 || !vs_units_known(r->columns.item[c->column].unit)) return 1;
  snprintf(prefix, 8, "%s", most >= 1e-3 ? "m" : "u");
  return most >= 1e-3 ? 1e3 : 1e6;
}

static void draw_column(portrait *p, const vs_outcome_column *c) {
  const vs_recorded *column = &p->o->inquiry->runs[c->run].recording.columns.item[c->column];
  char prefix[8], unit[64], name[VS_NAME_SIZE + 32];
  double factor = prefix_of(p, c, prefix);
  snprintf(unit, sizeof unit, "%s%.40s", prefix, column->unit);
  if (!*column->unit || !vs_units_known(unit))
    snprintf(unit, sizeof unit, "%.40s", column->unit), factor = 1 / column->si;
  snprintf(name, sizeof name, "%s", column->name);
  if (p->o->inquiry->n_runs > 1)
    snprintf(name, sizeof name, "%s, run %zu", column->name, c->run + 1);
  add_samples(p, c, factor);
  place(p, HIGH, UNDER);
  label(p, 'y', name, unit);
  vs_gnuplot_add(
      &p->script,
      "set xlabel ''\nset key top right\nplot $D using 1:2 with points pt 7 ps 0.35 lc rgb "
      "%s title 'measured', $D using 1:3 with lines lw 1.4 lc rgb %s title 'fitted'\n",
      vs_scale_colour_bad, vs_scale_colour_good);
  place(p, LOW, UNDER_LABEL);
  vs_gnuplot_add(&p->script,
                 "set ylabel 'residual / std error'\nset xlabel 't / ms'\nplot 0 lt 1 lc rgb "
                 "'#404040' notitle, 2 lt 1 dt 2 lc rgb '#808080' notitle, -2 lt 1 dt 2 lc "
                 "rgb '#808080' notitle, $D using 1:4 with impulses lc rgb %s notitle\n",
                 vs_scale_colour_good);
}

/* ---- the measures ---- */

/* Adds $M: place, residual, name; one row for each measure. */
static int add_measures(portrait *p) {
  const vs_inquiry *q = p->o->inquiry;
  int count = 0;
  vs_gnuplot_add(&p->script, "$M << EOD\n");
  for (size_t n = 0; n < q->n_data; n++) {
    if (q->data[n].aim < 0) continue;
    vs_text name = {0};
    vs_text_add(&name, "%s", vs_inquiry_name(q, &q->data[n]));
    if (q->n_runs > 1) vs_text_add(&name, ", run %d", q->data[n].run + 1);
    vs_gnuplot_add(&p->script, "%d %.6g ", ++count, p->o->estimate.residual[n]);
    vs_gnuplot_word(&p->script, name.text);
    vs_gnuplot_add(&p->script, "\n");
    vs_text_free(&name);
  }
  vs_gnuplot_add(&p->script, "EOD\n");
  return count;
}

static void draw_measures(portrait *p) {
  int count = add_measures(p);
  place(p, HIGH, UNDER_LABEL);
  vs_gnuplot_add(
      &p->script,
      "set ylabel 'residual / std error'\nset xlabel ''\nset xrange [0.3:%d.7]\n"
      "set rmargin 10\nset xtics rotate by -20 font 'sans,9'\n"
      "plot 0 lt 1 lc rgb '#404040' notitle, 2 lt 1 dt 2 lc rgb '#808080' notitle, -2 lt 1 "
      "dt 2 lc rgb '#808080' notitle, $M using 1:2:(1):xtic(3) with yerrorbars pt 7 ps 1 "
      "lc rgb %s title 'fitted less measured, in standard errors'\n"
      "set xrange [*:*]\nset xtics norotate autofreq font 'sans,11'\n",
      count, vs_scale_colour_good);
}

/* ---- the picture ---- */

static void begin(portrait *p, const char *name, bool measures) {
  bool svg = strlen(name) > 4 && !strcmp(name + strlen(name) - 4, ".svg");
  const char *slash = strrchr(p->o->inquiry->path, '/');
  char title[VS_PATH_SIZE + 64];
  p->height = TOP + (int)p->o->n_columns * (HIGH + LOW) + measures * HIGH;
  p->at = TOP;
  snprintf(title, sizeof title, "%s: chi2 = %.4g with %ld degrees of freedom%s",
           slash ? slash + 1 : p->o->inquiry->path, p->o->estimate.minimum.chi2,
           p->o->estimate.freedom, vs_estimate_fits(&p->o->estimate) ? "" : ": does not fit");
  vs_gnuplot_code(&p->script,
                  svg ? "set terminal svg noenhanced dynamic" : "set terminal pngcairo noenhanced");
  vs_gnuplot_add(&p->script, " size %d,%d font 'sans,11' background rgb 'white'\n", WIDTH,
                 p->height);
  vs_gnuplot_add(&p->script, "set grid lt 1 lw 0.5 lc rgb '#d0d0d0'\nset border lc rgb '#404040'\n"
                             "set lmargin 12\nset rmargin 3\nset multiplot title ");
  vs_gnuplot_caption(&p->script, title, WIDTH, 13);
  vs_gnuplot_add(&p->script, " font 'sans,13'\n");
}

vs_status vs_portrait_draw(const vs_outcome *o, const char *folder, const char *name,
                           vs_error *err) {
  portrait p = {.o = o};
  bool measures = false;
  char *picture = NULL;
  size_t size = 0;
  vs_file file = {0};
  for (size_t n = 0; n < o->inquiry->n_data; n++)
    measures = measures || o->inquiry->data[n].aim >= 0;
  begin(&p, name, measures);
  for (size_t k = 0; k < o->n_columns; k++) draw_column(&p, &o->columns[k]);
  if (measures) draw_measures(&p);
  vs_gnuplot_add(&p.script, "unset multiplot\n");
  vs_status status = vs_gnuplot_picture(p.script.text.text, &picture, &size, err);
  vs_gnuplot_free(&p.script);
  if (!status) status = vs_file_open(&file, folder, name, err);
  if (!status) {
    fwrite(picture, 1, size, file.stream); /* an error stays in the stream */
    status = vs_file_commit(&file, err);
  }
  free(picture);
  return status;
}
