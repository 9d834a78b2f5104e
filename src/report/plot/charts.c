/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of picture that show a column case by case, or over one or two axes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/gnuplot.h"
#include "plot/study_plot.h"

enum { FAMILY = 7 /* lines at most */, MOST_POINTS = 2000, FEW_POINTS = 100 };

/* ---- curves ---- */

/* Sorts the rows into lines, one for each word of the second axis. */
typedef struct picker {
  const vs_study_plot *k;
  size_t x, y, words; /* columns */
  double x_factor, y_factor;
  vs_dots line[FAMILY];
} picker;

static vs_status pick_row(void *ctx, const vs_folder_row *row, vs_error *err) {
  picker *m = ctx;
  double x, y;
  (void)err;
  long line = vs_study_results_index(&m->k->s->profile[m->words], row->cell[m->words]);
  if (line < 0 || line >= FAMILY) return VS_OK;
  if (!vs_folder_number(row->cell[m->x], &x) || !vs_folder_number(row->cell[m->y], &y))
    return VS_OK;
  if (isnan(x) || isnan(y)) return VS_OK;
  vs_dots *s = &m->line[line];
  s->item[s->count++] = (vs_dot){x * m->x_factor, y * m->y_factor, row->number};
  return VS_OK;
}

static void add_line(vs_script *script, const char *name, int colour, bool points,
                     const char *title) {
  static const int POINTS[VS_COLOURS] = {7, 5, 9, 13, 6, 4, 8};
  vs_gnuplot_code(script, "$");
  vs_gnuplot_code(script, name);
  vs_gnuplot_add(script, points ? " using 1:2 with linespoints" : " using 1:2 with lines");
  vs_gnuplot_add(script, " lc rgb %s lw 1.8 dt %d pt %d ps 0.6 title ",
                 vs_scale_colours[colour % VS_COLOURS], colour % 4 + 1,
                 POINTS[colour % VS_COLOURS]);
  vs_gnuplot_quoted(script, title);
}

static vs_status draw_family(const vs_study_plot *k, size_t x, size_t words, size_t y,
                             vs_picture *p, vs_error *err) {
  picker m = {.k = k, .x = x, .y = y, .words = words};
  m.x_factor = vs_study_plot_scale(k, x).factor;
  m.y_factor = vs_study_plot_scale(k, y).factor;
  const vs_profile *w = &k->s->profile[words];
  char name[32];
  for (size_t n = 0; n < w->count; n++)
    m.line[n].item = vs_alloc((size_t)k->s->rows, sizeof(vs_dot));
  vs_status status = vs_folder_each(k->t, pick_row, &m, err);
  for (size_t n = 0; n < w->count; n++) {
    vs_study_plot_dots_sort(&m.line[n]);
    vs_study_plot_dots_thin(&m.line[n], MOST_POINTS);
    snprintf(name, sizeof name, "line%zu", n);
    vs_study_plot_data(&p->script, name, &m.line[n], false);
  }
  vs_text_add(&p->caption, "A line for each %s. ", k->t->column[words].name);
  vs_gnuplot_add(&p->script, "set key tmargin center horizontal samplen 2\nplot ");
  for (size_t n = 0, drawn = 0; n < w->count; n++) {
    if (!m.line[n].count) continue;
    vs_gnuplot_add(&p->script, drawn++ ? ", " : "");
    snprintf(name, sizeof name, "line%zu", n);
    add_line(&p->script, name, (int)n, m.line[n].count <= FEW_POINTS, w->word[n]);
  }
  vs_gnuplot_add(&p->script, "\n");
  for (size_t n = 0; n < w->count; n++) vs_study_plot_dots_free(&m.line[n]);
  return status;
}

/* True for one axis, or for an axis of numbers with a second one of few words. */
static bool fits_curve(const vs_study_plot *k) {
  const vs_profile *profile = k->s->profile;
  if (k->n_axes == 1) return !profile[k->axis[0]].many;
  if (k->n_axes != 2) return false;
  const vs_profile *a = &profile[k->axis[0]], *b = &profile[k->axis[1]];
  const vs_profile *words = !a->is_number ? a : b, *numbers = !a->is_number ? b : a;
  return !words->is_number && words->count <= FAMILY && numbers->is_number;
}

static vs_status draw_curve(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err) {
  size_t x = k->n_axes ? k->axis[0] : 0, words = 0;
  if (k->n_axes > 1) {
    bool first = k->s->profile[x].is_number;
    words = k->axis[first ? 1 : 0];
    x = k->axis[first ? 0 : 1];
  }
  vs_study_plot_title(k, column, "", p);
  vs_study_plot_begin(k, x, column, p);
  vs_study_plot_axis(k, column, 'y', &p->script);
  vs_study_plot_range(k, column, 'y', false, p);
  if (words) return draw_family(k, x, words, column, p, err);
  vs_dots s;
  vs_status status = vs_study_plot_dots_load(k, x, column, &s, err);
  bool few = s.count <= FEW_POINTS;
  vs_study_plot_dots_sort(&s);
  vs_study_plot_dots_thin(&s, MOST_POINTS);
  vs_study_plot_below(k, column, &s, p);
  vs_study_plot_data(&p->script, "line", &s, k->t->failed > 0 && few);
  vs_gnuplot_add(&p->script, "plot ");
  if (x && !k->s->profile[x].is_number)
    vs_gnuplot_add(
        &p->script,
        "$line using 1:2 with impulses lw 10 lc rgb %s, $line using 1:2 with points pt 7 "
        "ps 0.9 lc rgb %s",
        vs_scale_colours[0], vs_scale_colours[0]);
  else
    add_line(&p->script, "line", 0, few, "");
  vs_gnuplot_add(&p->script, "\n");
  vs_study_plot_dots_free(&s);
  return status;
}

/* "curve": the column over the only axis. With a second axis of few words there is a line for each
 * word. */
const vs_chart vs_charts_curve = {.name = "curve", .fits = fits_curve, .draw = draw_curve};

/* ---- cases, and the path of a search ---- */

/* What cases are called that have few axes of words: "1N4007, open". */
typedef struct case_names {
  const vs_study_plot *k;
  size_t x, y; /* columns of the point at which a label is set; x 0: the case's tick has the name */
  vs_picture *p;
  int count;
  size_t length; /* of the last name */
} case_names;

/* True if the cases are few, and one of their axes is of words: parts, decks. */
static bool has_names(const vs_study_plot *k) {
  enum { NAMED = 24 }; /* cases whose names have room below a picture */
  bool words = false;
  for (size_t a = 0; a < k->n_axes; a++) words = words || !k->s->profile[k->axis[a]].is_number;
  return words && k->s->rows <= NAMED;
}

static vs_status name_case(void *ctx, const vs_folder_row *row, vs_error *err) {
  case_names *c = ctx;
  vs_script *script = &c->p->script;
  vs_text name = {0};
  const vs_profile *across = &c->k->s->profile[c->x];
  double at[2] = {(double)row->number, 0}, middle = (across->least + across->largest) / 2;
  (void)err;
  for (size_t a = 0; a < c->k->n_axes; a++)
    vs_text_add(&name, "%s%s", a ? ", " : "", row->cell[c->k->axis[a]]);
  for (int n = 0; n < 2 && c->x; n++) {
    const size_t column = n ? c->y : c->x;
    if (!vs_folder_number(row->cell[column], &at[n]) || isnan(at[n])) at[0] = NAN;
    at[n] *= vs_study_plot_scale(c->k, column).factor;
  }
  if (c->x) middle *= vs_study_plot_scale(c->k, c->x).factor;
  if (!isnan(at[0])) {
    vs_gnuplot_code(script, c->x ? "set label " : c->count ? ", " : "set xtics rotate by -35 (");
    vs_gnuplot_quoted(script, name.text);
    if (c->x && at[0] > middle)
      vs_gnuplot_add(script, " at first %.9g, first %.9g right offset -0.8,0.5 front\n", at[0],
                     at[1]);
    else if (c->x)
      vs_gnuplot_add(script, " at first %.9g, first %.9g offset 0.8,0.5 front\n", at[0], at[1]);
    else
      vs_gnuplot_add(script, " %ld", row->number);
    c->count++;
    c->length = name.length;
  }
  vs_text_free(&name);
  return VS_OK;
}

/* Sets the names of the cases: at their ticks, or at the points of two columns. */
static vs_status set_names(const vs_study_plot *k, size_t x, size_t y, vs_picture *p,
                           vs_error *err) {
  case_names c = {.k = k, .x = x, .y = y, .p = p};
  vs_status status = vs_folder_each(k->t, name_case, &c, err);
  /* a name goes down at 35 degrees: the last one goes on by 0.82 of its length */
  if (!x && c.count)
    vs_gnuplot_add(&p->script, ")\nset bmargin 9\nset xlabel ''\nset rmargin %g\n",
                   fmax(4, 0.82 * (double)c.length));
  return status;
}

/* The reported columns with numbers that vary: the first two; in the place of one that lacks the
 * least margin. False: there are fewer. */
static bool find_pair(const vs_study_plot *k, size_t pair[2]) {
  static const vs_folder_role ROLES[] = {VS_ROLE_REPORT, VS_ROLE_MARGIN};
  size_t n = 0;
  for (size_t r = 0; r < 2; r++)
    for (size_t c = 1; c < k->t->count && n < 2; c++)
      if (k->t->column[c].role == ROLES[r] && k->s->profile[c].known && vs_study_plot_varies(k, c))
        pair[n++] = c;
  return n == 2;
}

static bool fits_pair(const vs_study_plot *k) {
  size_t pair[2];
  return has_names(k) && find_pair(k, pair);
}

static vs_status draw_pair(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err) {
  size_t pair[2];
  vs_text over = {0};
  vs_dots s;
  (void)column;
  find_pair(k, pair);
  vs_text_add(&over, " over %s", k->t->column[pair[1]].name);
  vs_study_plot_title(k, pair[0], over.text, p);
  vs_text_free(&over);
  snprintf(p->name, sizeof p->name, "pair_%.200s", k->t->column[pair[0]].title);
  vs_study_plot_begin(k, pair[1], pair[0], p);
  vs_study_plot_axis(k, pair[0], 'y', &p->script);
  vs_study_plot_range(k, pair[1], 'x', false, p);
  vs_study_plot_range(k, pair[0], 'y', false, p);
  vs_status status = set_names(k, pair[1], pair[0], p, err);
  if (!status) status = vs_study_plot_dots_load(k, pair[1], pair[0], &s, err);
  if (status) return status;
  vs_study_plot_data(&p->script, "pair", &s, false);
  vs_gnuplot_add(&p->script, "plot $pair using 1:2 with points pt 7 ps 0.8 lc rgb %s\n",
                 vs_scale_colours[0]);
  vs_study_plot_dots_free(&s);
  return status;
}

/* "pair": a reported measure over the next one, a named point for each case. */
const vs_chart vs_charts_pair = {.name = "pair", .fits = fits_pair, .draw = draw_pair};

static vs_status draw_cases(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err) {
  vs_dots s;
  vs_study_plot_title(k, column, ", case by case", p);
  vs_study_plot_begin(k, 0, column, p);
  vs_study_plot_axis(k, column, 'y', &p->script);
  vs_study_plot_range(k, column, 'y', false, p);
  vs_status status = has_names(k) ? set_names(k, 0, column, p, err) : VS_OK;
  if (!status) status = vs_study_plot_dots_load(k, 0, column, &s, err);
  if (status) return status;
  if (s.count > MOST_POINTS)
    vs_text_add(&p->caption, "%zu cases; of each stretch the least and the largest. ", s.count);
  vs_study_plot_dots_thin(&s, MOST_POINTS);
  vs_study_plot_below(k, column, &s, p);
  vs_study_plot_data(&p->script, "cases", &s, false);
  vs_gnuplot_add(&p->script, "plot $cases using 1:2 with points pt 7 ps %g lc rgb %s\n",
                 s.count <= FEW_POINTS ? 0.8 : 0.4, vs_scale_colours[0]);
  vs_study_plot_dots_free(&s);
  return status;
}

/* "cases": the column over the number of the case. */
const vs_chart vs_charts_cases = {.name = "cases", .draw = draw_cases};

/* The points that are better than all before them, and one more at the end of the search. */
static vs_dots best_so_far(const vs_dots *s, bool largest) {
  vs_dots best = {.item = vs_alloc(s->count + 1, sizeof *best.item)};
  for (size_t n = 0; n < s->count; n++) {
    const vs_dot *last = best.count ? &best.item[best.count - 1] : NULL;
    bool better = !last || (largest ? s->item[n].y > last->y : s->item[n].y < last->y);
    if (better) best.item[best.count++] = s->item[n];
  }
  if (!best.count) return best;
  const vs_dot end = best.item[best.count - 1];
  best.item[best.count++] = (vs_dot){s->item[s->count - 1].x, end.y, end.number};
  return best;
}

static vs_status draw_path(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err) {
  bool largest;
  bool aim = vs_folder_aim(k->t, &largest) == column;
  if (!aim) largest = k->t->column[column].role != VS_ROLE_MARGIN;
  vs_dots s;
  vs_study_plot_title(k, column, largest ? ": search for the largest" : ": search for the least",
                      p);
  vs_study_plot_begin(k, 0, column, p);
  vs_study_plot_axis(k, column, 'y', &p->script);
  vs_study_plot_range(k, column, 'y', false, p);
  vs_gnuplot_add(&p->script,
                 "set xlabel 'evaluation'\nset key tmargin center horizontal samplen 2\n");
  vs_status status = vs_study_plot_dots_load(k, 0, column, &s, err);
  vs_dots best = best_so_far(&s, largest);
  if (best.count)
    vs_text_add(&p->caption, "The worst found, %.6g %s, at evaluation %ld of %zu. ",
                best.item[best.count - 1].y, vs_study_plot_scale(k, column).unit,
                best.item[best.count - 1].number, s.count);
  vs_study_plot_dots_thin(&s, MOST_POINTS);
  vs_study_plot_data(&p->script, "all", &s, false);
  vs_study_plot_data(&p->script, "best", &best, false);
  vs_gnuplot_add(
      &p->script,
      "plot $all using 1:2 with points pt 7 ps 0.4 lc rgb '#999999' title 'tried', $best "
      "using 1:2 with steps lw 2.4 lc rgb %s title 'worst so far'\n",
      vs_scale_colour_bad);
  vs_study_plot_dots_free(&s);
  vs_study_plot_dots_free(&best);
  return status;
}

/* "path": for a search, the same with the worst value so far. */
const vs_chart vs_charts_path = {.name = "path", .draw = draw_path};

/* ---- points in colour ---- */

/* Number of cells along each axis. Of the points in one cell only the worst is drawn. */
enum { CLOUD_CELLS = 100 };

typedef struct cloud {
  const vs_study_plot *k;
  size_t column[3];
  double factor[3], least[2], step[2];
  bool margin;
  /* [CLOUD_CELLS * CLOUD_CELLS]: x, y and the column's value; NaN: there is none */
  double (*point)[3];
} cloud;

static vs_status add_point(void *ctx, const vs_folder_row *row, vs_error *err) {
  cloud *c = ctx;
  double v[3];
  size_t cell = 0;
  (void)err;
  for (int n = 0; n < 3; n++) {
    if (!vs_folder_number(row->cell[c->column[n]], &v[n]) || isnan(v[n])) return VS_OK;
    v[n] *= c->factor[n];
    if (n < 2 && c->step[n] > 0)
      cell += (n ? CLOUD_CELLS : 1) *
              (size_t)fmin(CLOUD_CELLS - 1, fmax(0, (v[n] - c->least[n]) / c->step[n]));
  }
  double *there = c->point[cell];
  if (isnan(there[2]) || (c->margin ? v[2] < there[2] : fabs(v[2]) > fabs(there[2])))
    memcpy(there, v, sizeof v);
  return VS_OK;
}

static bool fits_cloud(const vs_study_plot *k) {
  return k->n_axes == 2 && k->s->profile[k->axis[0]].is_number &&
         k->s->profile[k->axis[1]].is_number;
}

/* Adds the script that plots the points, with crosses on those that violate a rating. */
static void add_cloud(const cloud *c, vs_picture *p) {
  bool violated = false;
  vs_gnuplot_add(&p->script, "$points << EOD\n");
  for (size_t n = 0; n < CLOUD_CELLS * CLOUD_CELLS; n++) {
    const double *at = c->point[n];
    if (isnan(at[2])) continue;
    vs_gnuplot_add(&p->script, "%.9g %.9g %.9g\n", at[0], at[1], at[2]);
    violated = violated || (c->margin && at[2] < 0);
  }
  vs_gnuplot_add(&p->script, "EOD\nplot $points using 1:2:3 with points pt 7 ps 0.7 lc palette");
  if (violated)
    vs_gnuplot_add(&p->script,
                   ", $points using 1:($3 < 0 ? $2 : NaN) with points pt 2 ps 0.7 lc rgb "
                   "%s ",
                   vs_scale_colour_bad);
  if (violated) vs_text_add(&p->caption, "Crosses: a rating is violated. ");
  vs_gnuplot_add(&p->script, "\n");
}

static vs_status draw_cloud(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err) {
  cloud c = {.k = k, .column = {k->axis[0], k->axis[1], column}};
  c.margin = k->t->column[column].role == VS_ROLE_MARGIN;
  for (int n = 0; n < 3; n++) c.factor[n] = vs_study_plot_scale(k, c.column[n]).factor;
  for (int n = 0; n < 2; n++) {
    const vs_profile *f = &k->s->profile[c.column[n]];
    c.least[n] = f->least * c.factor[n];
    c.step[n] = (f->largest - f->least) * c.factor[n] / CLOUD_CELLS;
  }
  c.point = vs_alloc(CLOUD_CELLS * CLOUD_CELLS, sizeof *c.point);
  for (size_t n = 0; n < CLOUD_CELLS * CLOUD_CELLS; n++) c.point[n][2] = NAN;
  vs_status status = vs_folder_each(k->t, add_point, &c, err);
  vs_study_plot_title(k, column, " of each case", p);
  p->width = 720;
  p->height = 520;
  vs_study_plot_begin(k, c.column[0], column, p);
  snprintf(p->name, sizeof p->name, "cloud_%.200s", k->t->column[column].title);
  vs_study_plot_axis(k, c.column[1], 'y', &p->script);
  vs_gnuplot_code(&p->script, vs_scale_palette);
  vs_gnuplot_add(&p->script, "set cblabel ");
  vs_gnuplot_quoted(&p->script, vs_study_plot_scale(k, column).label);
  vs_gnuplot_add(&p->script, "\nset rmargin 16\n");
  add_cloud(&c, p);
  free(c.point);
  return status;
}

/* "cloud": points in colour over two axes of numbers, for cases anywhere between them. */
const vs_chart vs_charts_cloud = {.name = "cloud", .fits = fits_cloud, .draw = draw_cloud};
