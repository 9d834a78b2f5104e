/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/spread.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/gnuplot.h"

/* ---- histograms ---- */

double vs_spread_percentile(const double *rising, size_t count, double percent) {
  if (!count) return NAN;
  double at = percent / 100 * (double)(count - 1);
  size_t k = (size_t)at;
  if (k + 1 >= count) return rising[count - 1];
  return rising[k] + (at - (double)k) * (rising[k + 1] - rising[k]);
}

static int compare_rising(const void *a, const void *b) {
  double one = *(const double *)a, other = *(const double *)b;
  return (one > other) - (one < other);
}

/* Returns the width of the bins by Freedman and Diaconis' rule (1981), 2 IQR / n^(1/3), limited so
 * that there are 8 to 60 bins. */
static double bin_width(const double *v, size_t n) {
  double span = v[n - 1] - v[0];
  if (span <= 1e-10 * fabs(v[0])) return v[0] != 0 ? 0.05 * fabs(v[0]) : 1;
  double width =
      2 * (vs_spread_percentile(v, n, 75) - vs_spread_percentile(v, n, 25)) / cbrt((double)n);
  return fmin(span / 8, fmax(span / 60, width));
}

vs_bins vs_spread_bins(const double *v, size_t n, double joint) {
  vs_bins b = {.width = bin_width(v, n)};
  if (!(joint > v[0] && joint < v[n - 1])) joint = v[0];
  double first = floor((v[0] - joint) / b.width);
  for (size_t k = 0; k < n && b.count < VS_BINS; b.count++) {
    size_t begin = k;
    double end = joint + (first + (double)b.count + 1) * b.width;
    bool last = b.count == VS_BINS - 1 || v[n - 1] <= end;
    while (k < n && (last || v[k] < end)) k++;
    b.item[b.count].middle = end - b.width / 2;
    b.item[b.count].cases = k - begin;
  }
  return b;
}

static void add_bins(vs_script *script, const vs_bins *b, size_t n) {
  vs_gnuplot_add(script, "width = %.9g\n$bins << EOD\n", b->width);
  for (size_t k = 0; k < b->count; k++)
    vs_gnuplot_add(script, "%.9g %.9g\n", b->item[k].middle,
                   100 * (double)b->item[k].cases / (double)n);
  vs_gnuplot_add(script, "EOD\n");
}

static void add_percentiles(const double *v, size_t n, const char *unit, vs_picture *p) {
  static const struct {
    double percent;
    const char *place;
  } LINES[] = {
      {5, "right offset -0.3,0.95"}, {50, "center offset 0,1.75"}, {95, "left offset 0.3,0.95"}};
  vs_text_add(&p->caption, "%zu cases; ", n);
  for (size_t k = 0; k < 3; k++) {
    double at = vs_spread_percentile(v, n, LINES[k].percent);
    vs_gnuplot_add(
        &p->script,
        "set arrow from first %.9g, graph 0 to first %.9g, graph 1 nohead lw 1.5 dt %d lc "
        "rgb 'black' front\nset label '%g %%: %.4g' at first %.9g, graph 1 ",
        at, at, k == 1 ? 1 : 3, LINES[k].percent, at, at);
    vs_gnuplot_code(&p->script, LINES[k].place);
    vs_gnuplot_add(&p->script, "\n");
    vs_text_add(&p->caption, "%s%g %% of them lie below %.4g%s%s", k ? ", " : "", LINES[k].percent,
                at, *unit ? " " : "", unit);
  }
  vs_text_add(&p->caption, ". ");
}

static void add_histogram(const vs_study_plot *k, size_t column, double *v, size_t n,
                          vs_picture *p) {
  bool margin = k->t->column[column].role == VS_ROLE_MARGIN;
  double limit = vs_study_plot_limit(k, column);
  vs_study_plot_range(k, column, 'x', false, p);
  add_percentiles(v, n, vs_study_plot_scale(k, column).unit, p);
  const vs_bins bins = vs_spread_bins(v, n, limit);
  add_bins(&p->script, &bins, n);
  vs_gnuplot_add(&p->script, "set ylabel 'share of cases / %%'\nset yrange [0:*]\n"
                             "set style fill solid 0.8 border lc rgb 'white'\n");
  vs_gnuplot_add(&p->script, "bad(x) = %d && x < 0 ? 0x", margin);
  vs_gnuplot_code(&p->script, vs_scale_colour_bad + 1);
  vs_gnuplot_add(&p->script, " : 0x");
  vs_gnuplot_code(&p->script, vs_scale_colour_good + 1);
  vs_gnuplot_add(&p->script, "\n");
  vs_gnuplot_add(&p->script, "plot $bins using 1:2:(width):(bad($1)) with boxes lc rgb variable\n");
  if (margin) vs_text_add(&p->caption, "Left of 0, in orange: a rating is violated. ");
}

static vs_status draw_histogram(const vs_study_plot *k, size_t column, vs_picture *p,
                                vs_error *err) {
  vs_dots s;
  vs_study_plot_title(k, column, ": how it is spread", p);
  p->width = 720;
  p->height = 470;
  p->labels_above = true;
  vs_study_plot_begin(k, column, column, p);
  vs_gnuplot_add(&p->script, "unset logscale x\nset rmargin 10\n"); /* a percentile's label */
  vs_status status = vs_study_plot_dots_load(k, 0, column, &s, err);
  size_t n = s.count;
  double *v = vs_alloc(n, sizeof *v);
  for (size_t i = 0; i < n; i++) v[i] = s.item[i].y;
  vs_study_plot_dots_free(&s);
  qsort(v, n, sizeof *v, compare_rising);
  if (!status && n) add_histogram(k, column, v, n, p);
  free(v);
  return status;
}

/* "histogram": the distribution of the column's values with its 5th, 50th and 95th percentile; for
 * a margin also the yield. */
const vs_chart vs_spread_histogram = {.name = "histogram", .draw = draw_histogram};

/* ---- corners ---- */

enum { MOST_BARS = 32 };

typedef struct chosen {
  const vs_study_plot *k;
  size_t column, n;
  vs_kept kept[MOST_BARS];
} chosen;

static vs_status choose_corner(void *ctx, const vs_folder_row *row, vs_error *err) {
  chosen *c = ctx;
  double y;
  (void)err;
  if (!vs_folder_number(row->cell[c->column], &y) || isnan(y)) return VS_OK;
  bool margin = c->k->t->column[c->column].role == VS_ROLE_MARGIN;
  vs_study_results_keep(c->kept, &c->n, MOST_BARS, margin ? y : -fabs(y), row);
  return VS_OK;
}

/* Adds at which end of its range each axis is: "+−+". */
static void add_corner(const vs_study_plot *k, char **cell, vs_text *label) {
  vs_text_add(label, "case %s  ", cell[0]);
  for (size_t a = 0; a < k->n_axes; a++) {
    const vs_profile *p = &k->s->profile[k->axis[a]];
    double value;
    if (!p->is_number) {
      vs_text_add(label, " %s", cell[k->axis[a]]);
      continue;
    }
    vs_folder_number(cell[k->axis[a]], &value);
    vs_text_add(label, "%s", value <= p->least ? "−" : value >= p->largest ? "+" : "0");
  }
}

static void add_bars(const chosen *c, vs_picture *p) {
  double factor = vs_study_plot_scale(c->k, c->column).factor, y;
  vs_gnuplot_add(&p->script, "set ytics (");
  for (size_t n = 0; n < c->n; n++) {
    vs_text label = {0};
    add_corner(c->k, c->kept[n].cell, &label);
    vs_gnuplot_add(&p->script, n ? ", " : "");
    vs_gnuplot_quoted(&p->script, label.text);
    vs_gnuplot_add(&p->script, " %zu", n);
    vs_text_free(&label);
  }
  vs_gnuplot_add(&p->script, ")\nset yrange [%g:-0.6]\n$bars << EOD\n", (double)c->n - 0.4);
  for (size_t n = 0; n < c->n; n++) {
    vs_folder_number(c->kept[n].cell[c->column], &y);
    vs_gnuplot_add(&p->script, "%zu %.9g\n", n, y * factor);
  }
  bool margin = c->k->t->column[c->column].role == VS_ROLE_MARGIN;
  vs_gnuplot_add(
      &p->script,
      "EOD\nunset key\nset style fill solid 0.8 noborder\nset grid noytics\n"
      "plot $bars using (0):1:(0):($2 < 0 ? 0 : $2):($1-0.38):($1+0.38) with boxxyerror lc "
      "rgb %s, $bars using (0):1:($2 < 0 ? $2 : 0):(0):($1-0.38):($1+0.38) with "
      "boxxyerror lc rgb %s\n",
      vs_scale_colour_good, margin ? vs_scale_colour_bad : vs_scale_colour_good);
}

static vs_status draw_bars(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err) {
  chosen c = {.k = k, .column = column};
  vs_status status = vs_folder_each(k->t, choose_corner, &c, err);
  vs_study_plot_title(k, column, " at the corners", p);
  p->width = 720;
  p->height = 120 + 24 * (int)c.n;
  vs_study_plot_begin(k, column, column, p);
  vs_study_plot_range(k, column, 'x', true, p);
  if ((size_t)k->s->rows > c.n) vs_text_add(&p->caption, "The %zu worst of %ld. ", c.n, k->s->rows);
  vs_text_add(&p->caption, "−, +: the axis at its least, its largest value; in the order ");
  for (size_t a = 0; a < k->n_axes; a++)
    vs_text_add(&p->caption, "%s%s", a ? ", " : "", k->t->column[k->axis[a]].name);
  vs_text_add(&p->caption, ". ");
  if (c.n) add_bars(&c, p);
  vs_study_results_kept_free(c.kept, c.n, k->t->count);
  return status;
}

/* "bars": the worst corners as bars: those with the least margin, or for other columns with the
 * largest amounts. */
const vs_chart vs_spread_bars = {.name = "bars", .draw = draw_bars};

/* ---- what moves it ---- */

typedef struct moments {
  const vs_study_plot *k;
  size_t column;
  long n[VS_STUDY_COLUMNS]; /* by column, like all the following; running means and products */
  double x[VS_STUDY_COLUMNS], y[VS_STUDY_COLUMNS];
  double xx[VS_STUDY_COLUMNS], yy[VS_STUDY_COLUMNS], xy[VS_STUDY_COLUMNS];
} moments;

static vs_status add_moments(void *ctx, const vs_folder_row *row, vs_error *err) {
  moments *m = ctx;
  double y, x;
  (void)err;
  if (!vs_folder_number(row->cell[m->column], &y) || isnan(y)) return VS_OK;
  for (size_t a = 0; a < m->k->n_axes; a++) {
    size_t c = m->k->axis[a];
    if (!m->k->s->profile[c].is_number || !vs_folder_number(row->cell[c], &x) || isnan(x)) continue;
    double dx = x - m->x[c], dy = y - m->y[c], n = (double)++m->n[c];
    m->x[c] += dx / n;
    m->y[c] += dy / n;
    m->xx[c] += dx * (x - m->x[c]);
    m->yy[c] += dy * (y - m->y[c]);
    m->xy[c] += dx * (y - m->y[c]);
  }
  return VS_OK;
}

typedef struct influence {
  size_t column;
  double r;
} influence;

static int by_strength(const void *a, const void *b) {
  const influence *one = a, *other = b;
  double more = fabs(other->r) - fabs(one->r);
  if (more != 0) return more < 0 ? -1 : 1;
  return (one->column > other->column) - (one->column < other->column);
}

/* Finds the *count strongest influences on the column, the strongest first. */
static vs_status find_influences(const vs_study_plot *k, size_t column,
                                 influence all[VS_STUDY_COLUMNS], size_t *count, vs_error *err) {
  moments *m = vs_alloc(1, sizeof *m);
  size_t n = 0;
  m->k = k;
  m->column = column;
  vs_status status = vs_folder_each(k->t, add_moments, m, err);
  for (size_t a = 0; a < k->n_axes; a++) {
    size_t c = k->axis[a];
    double scale = sqrt(m->xx[c]) * sqrt(m->yy[c]);
    if (scale > 0) all[n++] = (influence){c, m->xy[c] / scale};
  }
  free(m);
  qsort(all, n, sizeof *all, by_strength);
  *count = n > MOST_BARS ? MOST_BARS : n;
  return status;
}

static vs_status draw_influence(const vs_study_plot *k, size_t column, vs_picture *p,
                                vs_error *err) {
  influence all[VS_STUDY_COLUMNS];
  size_t n;
  vs_status status = find_influences(k, column, all, &n, err);
  if (!n) return status;
  snprintf(p->name, sizeof p->name, "influence");
  p->width = 720;
  p->height = 120 + 28 * (int)n;
  vs_text_add(&p->title, "What moves %s", k->t->column[column].name);
  vs_text_add(&p->caption, "Linear correlation with each axis, over all cases: 1 or -1 where it "
                           "alone decides, 0 where it has no part that is linear. ");
  vs_study_plot_begin(k, 0, column, p);
  vs_gnuplot_add(
      &p->script,
      "unset key\nset xlabel 'correlation'\nset xrange [-1:1]\nset grid noytics\nset ytics (");
  for (size_t i = 0; i < n; i++) {
    vs_gnuplot_add(&p->script, i ? ", " : "");
    vs_gnuplot_quoted(&p->script, k->t->column[all[i].column].name);
    vs_gnuplot_add(&p->script, " %zu", i);
  }
  vs_gnuplot_add(&p->script, ")\nset yrange [%g:-0.6]\n$bars << EOD\n", (double)n - 0.4);
  for (size_t i = 0; i < n; i++) vs_gnuplot_add(&p->script, "%zu %.9g\n", i, all[i].r);
  vs_gnuplot_add(
      &p->script,
      "EOD\nset style fill solid 0.8 noborder\nset yzeroaxis lt 1\n"
      "plot $bars using (0):1:($2 < 0 ? $2 : 0):($2 < 0 ? 0 : $2):($1-0.36):($1+0.36) with "
      "boxxyerror lc rgb %s\n",
      vs_scale_colour_good);
  return status;
}

static bool fits_influence(const vs_study_plot *k) {
  return k->n_axes > 0;
}

/* "influence": the column's correlation with each axis that is a number. There is no picture if
 * nothing influences the column. */
const vs_chart vs_spread_influence = {
    .name = "influence", .fits = fits_influence, .draw = draw_influence};

/* ---- one axis among many ---- */

typedef struct effects {
  const vs_study_plot *k;
  size_t axis, column;
  struct {
    double least, largest, sum;
    long n;
  } at[VS_DISTINCT];
} effects;

static vs_status add_effect(void *ctx, const vs_folder_row *row, vs_error *err) {
  effects *e = ctx;
  double y;
  (void)err;
  long k = vs_study_results_index(&e->k->s->profile[e->axis], row->cell[e->axis]);
  if (k < 0 || !vs_folder_number(row->cell[e->column], &y) || isnan(y)) return VS_OK;
  e->at[k].least = e->at[k].n ? fmin(e->at[k].least, y) : y;
  e->at[k].largest = e->at[k].n ? fmax(e->at[k].largest, y) : y;
  e->at[k].sum += y;
  e->at[k].n++;
  return VS_OK;
}

/* Adds the least, mean and largest value at each value of the axis, and the script that plots them.
 */
static void add_effects(const effects *e, vs_picture *p) {
  const vs_profile *profile = &e->k->s->profile[e->axis];
  const double x_factor = vs_study_plot_scale(e->k, e->axis).factor,
               factor = vs_study_plot_scale(e->k, e->column).factor;
  vs_gnuplot_add(&p->script, "$e << EOD\n");
  for (size_t i = 0; i < profile->count; i++)
    if (e->at[i].n)
      vs_gnuplot_add(&p->script, "%.9g %.9g %.9g %.9g\n",
                     profile->is_number ? profile->value[i] * x_factor : (double)i,
                     e->at[i].least * factor, e->at[i].sum / (double)e->at[i].n * factor,
                     e->at[i].largest * factor);
  vs_gnuplot_add(
      &p->script,
      "EOD\nset key tmargin center horizontal samplen 2\nplot $e using 1:4 with "
      "linespoints lc rgb %s lw "
      "1.8 dt 2 pt 5 ps 0.6 title 'largest', $e using 1:3 with linespoints lc rgb %s lw "
      "1.8 pt 7 ps 0.6 title 'mean', $e using 1:2 with linespoints lc rgb %s lw 1.8 dt 4 "
      "pt 9 ps 0.6 title 'least'\n",
      vs_scale_colours[2], vs_scale_colours[4], vs_scale_colours[0]);
}

/* With one or two axes and nothing random, other pictures show everything. */
static bool fits_effect(const vs_study_plot *k) {
  return k->n_axes > 2 || vs_folder_is_sampled(k->t);
}

static vs_status draw_effect(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err) {
  const size_t axis = k->one;
  effects *e = vs_alloc(1, sizeof *e);
  e->k = k;
  e->axis = axis;
  e->column = column;
  vs_status status = vs_folder_each(k->t, add_effect, e, err);
  vs_text_add(&p->title, "%s over %s, all else as it may be", k->t->column[column].name,
              k->t->column[axis].name);
  snprintf(p->name, sizeof p->name, "over_%.200s", k->t->column[axis].title);
  vs_study_plot_begin(k, axis, column, p);
  vs_study_plot_axis(k, column, 'y', &p->script);
  vs_study_plot_range(k, column, 'y', false, p);
  add_effects(e, p);
  free(e);
  return status;
}

/* "effect": the column's least, mean and largest value at each value of one axis, over all values
 * of the others. */
const vs_chart vs_spread_effect = {
    .name = "effect", .fits = fits_effect, .each_axis = true, .draw = draw_effect};
