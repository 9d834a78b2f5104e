/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/study_plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/gnuplot.h"

vs_scale vs_study_plot_scale(const vs_study_plot *k, size_t column) {
  if (column)
    return vs_scale_of(&k->t->column[column], vs_study_results_extent(&k->s->profile[column]));
  return (vs_scale){.factor = 1, .label = "case"};
}

double vs_study_plot_limit(const vs_study_plot *k, size_t column) {
  const vs_folder_column *c = &k->t->column[column];
  if (c->role == VS_ROLE_MARGIN) return 0;
  return c->rating * vs_study_plot_scale(k, column).factor;
}

/* ---- columns ---- */

typedef struct loader {
  const vs_profile *x_profile;
  size_t x, y;
  double x_factor, y_factor;
  vs_dots *series;
  size_t capacity;
} loader;

static vs_status load_row(void *ctx, const vs_folder_row *row, vs_error *err) {
  loader *l = ctx;
  double x = (double)row->number, y;
  (void)err;
  if (l->x && l->x_profile->is_number)
    vs_folder_number(row->cell[l->x], &x);
  else if (l->x)
    x = (double)vs_study_results_index(l->x_profile, row->cell[l->x]);
  if (!vs_folder_number(row->cell[l->y], &y) || isnan(x) || isnan(y)) return VS_OK;
  if (l->series->count < l->capacity)
    l->series->item[l->series->count++] = (vs_dot){x * l->x_factor, y * l->y_factor, row->number};
  return VS_OK;
}

vs_status vs_study_plot_dots_load(const vs_study_plot *k, size_t x, size_t y, vs_dots *series,
                                  vs_error *err) {
  size_t rows = (size_t)k->s->rows;
  bool number = x && k->s->profile[x].is_number;
  *series = (vs_dots){.item = vs_alloc(rows, sizeof *series->item)};
  loader l = {&k->s->profile[x],
              x,
              y,
              number ? vs_study_plot_scale(k, x).factor : 1,
              vs_study_plot_scale(k, y).factor,
              series,
              rows};
  return vs_folder_each(k->t, load_row, &l, err);
}

void vs_study_plot_dots_free(vs_dots *series) {
  free(series->item);
  *series = (vs_dots){0};
}

static int by_x(const void *a, const void *b) {
  const vs_dot *one = a, *other = b;
  if (one->x != other->x) return one->x < other->x ? -1 : 1;
  return (one->number > other->number) - (one->number < other->number);
}

void vs_study_plot_dots_sort(vs_dots *series) {
  qsort(series->item, series->count, sizeof *series->item, by_x);
}

void vs_study_plot_dots_thin(vs_dots *s, size_t most) {
  if (s->count <= most) return;
  size_t kept = 0, stretch = 2 * s->count / most + 1;
  for (size_t begin = 0; begin < s->count; begin += stretch) {
    size_t least = begin, largest = begin;
    for (size_t k = begin; k < begin + stretch && k < s->count; k++) {
      if (s->item[k].y < s->item[least].y) least = k;
      if (s->item[k].y > s->item[largest].y) largest = k;
    }
    vs_dot first = s->item[least < largest ? least : largest];
    vs_dot second = s->item[least < largest ? largest : least];
    s->item[kept++] = first;
    if (least != largest) s->item[kept++] = second;
  }
  s->count = kept;
}

/* ---- scripts ---- */

void vs_study_plot_title(const vs_study_plot *k, size_t column, const char *what, vs_picture *p) {
  const vs_folder_column *c = &k->t->column[column];
  vs_text_add(&p->title, "%s%s", c->name, what);
  if (*c->text && strcmp(c->text, "null")) vs_text_add(&p->caption, "%s. ", c->text);
}

void vs_study_plot_axis(const vs_study_plot *k, size_t column, char axis, vs_script *script) {
  vs_scale scale = vs_study_plot_scale(k, column);
  const vs_profile *p = &k->s->profile[column];
  vs_gnuplot_add(script, "set %clabel ", axis);
  vs_gnuplot_caption(script, scale.label, axis == 'y' ? 430 : 600, 12);
  vs_gnuplot_add(script, "\n");
  if (scale.log) vs_gnuplot_add(script, "set logscale %c\n", axis);
  if (!column || p->is_number) return;
  vs_gnuplot_add(script, "set %ctics (", axis);
  for (size_t w = 0; w < p->count; w++) {
    vs_gnuplot_add(script, w ? ", " : "");
    vs_gnuplot_quoted(script, p->word[w]);
    vs_gnuplot_add(script, " %zu", w);
  }
  vs_gnuplot_add(script, ")\nset %crange [-0.6:%g]\n", axis, (double)p->count - 0.4);
}

void vs_study_plot_begin(const vs_study_plot *k, size_t x, size_t y, vs_picture *p) {
  const vs_folder_column *c = &k->t->column[y];
  if (!*p->name) snprintf(p->name, sizeof p->name, "%.250s", c->title);
  for (char *s = p->name; *s; s++)
    if (*s == '/') *s = '_';
  if (!p->width) p->width = 720, p->height = 430;
  vs_gnuplot_add(&p->script, "set grid lt 1 lw 0.5 lc rgb '#d0d0d0'\nset border lc rgb '#404040'\n"
                             "set key noautotitle\nset rmargin 4\nset tics nomirror\nset title ");
  vs_gnuplot_caption(&p->script, p->title.text, p->width, 12);
  vs_gnuplot_add(&p->script,
                 p->labels_above ? " offset 0,1.9\nset tmargin 5.1\n" : " offset 0,0.7\n");
  vs_study_plot_axis(k, x, 'x', &p->script);
}

/* Draws a line across the picture at the limit, with a label. */
static void add_limit(const vs_study_plot *k, size_t column, char axis, double limit,
                      vs_picture *p) {
  vs_script *script = &p->script;
  vs_text label = {0};
  const double height = p->labels_above ? 2.55 : 0.5; /* of text lines */
  if (axis == 'x')
    vs_gnuplot_add(script, "set arrow from first %.9g, graph 0 to first %.9g, graph 1", limit,
                   limit);
  else
    vs_gnuplot_add(script, "set arrow from graph 0, first %.9g to graph 1, first %.9g", limit,
                   limit);
  vs_gnuplot_add(script, " nohead lc rgb %s lw 1.8 dt 2 front\n", vs_scale_colour_bad);
  vs_text_add(&label, "limit %.4g %s", limit, vs_study_plot_scale(k, column).unit);
  vs_gnuplot_add(script, "set label ");
  vs_gnuplot_quoted(script, label.text);
  vs_text_free(&label);
  if (axis == 'x')
    vs_gnuplot_add(script, " at first %.9g, graph 1 center offset 0,%g", limit, height);
  else
    vs_gnuplot_add(script, " at graph 0.99, first %.9g right offset 0,0.6", limit);
  vs_gnuplot_add(script, " tc rgb %s front\n", vs_scale_colour_bad);
}

enum { LOW_MARGIN = -150 }; /* %; what lies further below needs no exact place */

static bool is_cut(const vs_study_plot *k, size_t column, double least, double largest) {
  return k->t->column[column].role == VS_ROLE_MARGIN && least < LOW_MARGIN &&
         largest >= LOW_MARGIN / 2;
}

void vs_study_plot_below(const vs_study_plot *k, size_t column, vs_dots *s, vs_picture *p) {
  enum { NUMBERS = 24 }; /* with more they would cover one another */
  const vs_profile *of = &k->s->profile[column];
  const double factor = vs_study_plot_scale(k, column).factor;
  size_t below = 0;
  if (!is_cut(k, column, of->least * factor, of->largest * factor)) return;
  for (size_t n = 0; n < s->count; n++) below += s->item[n].y < LOW_MARGIN;
  for (size_t n = 0; n < s->count; n++) {
    vs_dot *dot = &s->item[n];
    if (!(dot->y < LOW_MARGIN)) continue;
    if (below <= NUMBERS)
      vs_gnuplot_add(&p->script,
                     "set label \"%.3g\" at first %.9g, first %d center offset 0,0.8 tc rgb %s "
                     "front\n",
                     dot->y, dot->x, LOW_MARGIN, vs_scale_colour_bad);
    dot->y = LOW_MARGIN;
  }
}

/* The picture's lower end: LOW_MARGIN if some margins are below it and others well above, so that
 * those about 0 can be told apart. */
static double cut_low(const vs_study_plot *k, size_t column, double least, double largest,
                      vs_picture *p) {
  if (!is_cut(k, column, least, largest)) return least;
  vs_text_add(&p->caption, "It goes on below the picture, to %.4g %%. ", least);
  return LOW_MARGIN;
}

/* No difference in a measure is shown below this part of its value: run.tolerance is rarely finer.
 */
static const double LEAST_SPAN = 1e-3;

bool vs_study_plot_varies(const vs_study_plot *k, size_t column) {
  const vs_profile *p = &k->s->profile[column];
  return p->largest - p->least > LEAST_SPAN * fmax(fabs(p->least), fabs(p->largest));
}

void vs_study_plot_widen(const vs_study_plot *k, size_t column, double *least, double *largest) {
  const vs_folder *t = k->t;
  const bool margin = t->column[column].role == VS_ROLE_MARGIN;
  double span = LEAST_SPAN * fmax(fabs(*least), fabs(*largest));
  if (t->column[column].role == VS_ROLE_AXIS) return;
  if (margin && t->error > 0 && isfinite(k->s->profile[t->error].largest))
    span = fmax(span, 2 * k->s->profile[t->error].largest * vs_study_plot_scale(k, column).factor);
  const double more = (span - (*largest - *least)) / 2;
  if (!(more > 0)) return;
  *least -= more;
  *largest += more;
}

void vs_study_plot_range(const vs_study_plot *k, size_t column, char axis, bool from_zero,
                         vs_picture *p) {
  const vs_profile *profile = &k->s->profile[column];
  vs_scale scale = vs_study_plot_scale(k, column);
  double least = profile->least * scale.factor, largest = profile->largest * scale.factor;
  if (from_zero) least = fmin(least, 0), largest = fmax(largest, 0);
  if (axis == 'y') least = cut_low(k, column, least, largest, p);
  double limit = vs_study_plot_limit(k, column), span = largest - least;
  bool near = limit >= least - span && limit <= largest + span;
  if (near) {
    least = fmin(least, limit);
    largest = fmax(largest, limit);
    add_limit(k, column, axis, limit, p);
  } else if (!isnan(limit))
    vs_text_add(&p->caption, "The limit, %.6g %s, lies outside the picture. ", limit, scale.unit);
  vs_study_plot_widen(k, column, &least, &largest);
  double room = largest - least > 1e-10 * fabs(least) ? 0.06 * (largest - least)
                                                      : (least != 0 ? 0.05 * fabs(least) : 1);
  vs_gnuplot_add(&p->script, "set %crange [%.9g:%.9g]\n", axis, least - room, largest + room);
}

void vs_study_plot_data(vs_script *script, const char *name, const vs_dots *s, bool gaps) {
  vs_gnuplot_add(script, "$");
  vs_gnuplot_code(script, name);
  vs_gnuplot_add(script, " << EOD\n");
  for (size_t k = 0; k < s->count; k++) {
    if (gaps && k && labs(s->item[k].number - s->item[k - 1].number) > 1)
      vs_gnuplot_add(script, "\n");
    vs_gnuplot_add(script, "%.9g %.9g\n", s->item[k].x, s->item[k].y);
  }
  vs_gnuplot_add(script, "EOD\n");
}
