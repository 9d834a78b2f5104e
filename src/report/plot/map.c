/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/gnuplot.h"

enum { MOST_CELLS = 80 }; /* along each axis; if there are more values, several share a cell */

/* ---- the contour ---- */

static double place_between(double a, double b, double part, bool is_log) {
  return is_log ? a * pow(b / a, part) : a + part * (b - a);
}

/* A corner of a cell. */
typedef struct corner {
  double x, y, z;
} corner;

/* Finds the point between two corners at which the field is `level`; false: there is none. */
static bool level_crossing(const vs_field_grid *g, const corner *a, const corner *b, double level,
                           double at[2]) {
  if ((a->z < level) == (b->z < level)) return false;
  double part = (level - a->z) / (b->z - a->z);
  at[0] = place_between(a->x, b->x, part, g->x_log && a->x != b->x);
  at[1] = place_between(a->y, b->y, part, g->y_log && a->y != b->y);
  return true;
}

void vs_map_contour(const vs_field_grid *g, double level,
                    void (*each)(void *ctx, const double from[2], const double to[2]), void *ctx) {
  for (size_t j = 0; j + 1 < g->ny; j++)
    for (size_t i = 0; i + 1 < g->nx; i++) {
      const double *low = g->z + j * g->nx + i, *high = low + g->nx;
      const corner c[4] = {{g->x[i], g->y[j], low[0]},
                           {g->x[i + 1], g->y[j], low[1]},
                           {g->x[i + 1], g->y[j + 1], high[1]},
                           {g->x[i], g->y[j + 1], high[0]}};
      double at[4][2];
      int n = 0, first = 0;
      if (isnan(c[0].z + c[1].z + c[2].z + c[3].z)) continue;
      for (int k = 0; k < 4; k++) {
        bool met = level_crossing(g, &c[k], &c[(k + 1) % 4], level, at[n]);
        if (met && !n) first = k;
        n += met;
      }
      /* at a saddle the value in the middle decides which corners belong together */
      bool turn = n == 4 && first == 0 &&
                  (c[0].z < level) == ((c[0].z + c[1].z + c[2].z + c[3].z) / 4 < level);
      if (n == 2) each(ctx, at[0], at[1]);
      if (n == 4) {
        each(ctx, at[0], at[turn ? 1 : 3]);
        each(ctx, at[2], at[turn ? 3 : 1]);
      }
    }
}

/* ---- cells ---- */

/* An axis cut into at most MOST_CELLS cells. */
typedef struct map_side {
  size_t column, cells, each; /* each: how many values of the axis share a cell */
  const vs_profile *profile;
  vs_scale scale;
  double middle[MOST_CELLS], edge[MOST_CELLS + 1]; /* as shown */
} map_side;

typedef struct map {
  const vs_study_plot *k;
  map_side x, y;
  size_t column;
  bool margin;
  double factor, *z; /* [y.cells][x.cells], as shown; NAN: no case */
} map;

/* The k-th value of the axis as shown; of an axis of words its index. */
static double value_at(const map_side *s, size_t k) {
  return s->profile->is_number ? s->profile->value[k] * s->scale.factor : (double)k;
}

/* Cuts the axis' values into cells of `each` values (the last one may have fewer): finds the
 * middles of the cells, and the edges half way between the middles. The two outer edges lie as far
 * beyond their middle as the next edge lies within it. */
static void cut_side(map_side *s) {
  size_t count = s->profile->count;
  bool is_log = s->scale.log;
  s->each = (count + MOST_CELLS - 1) / MOST_CELLS;
  s->cells = (count + s->each - 1) / s->each;
  for (size_t c = 0; c < s->cells; c++) {
    size_t last = (c + 1) * s->each < count ? (c + 1) * s->each - 1 : count - 1;
    s->middle[c] = place_between(value_at(s, c * s->each), value_at(s, last), 0.5, is_log);
  }
  for (size_t c = 1; c < s->cells; c++)
    s->edge[c] = place_between(s->middle[c - 1], s->middle[c], 0.5, is_log);
  bool alone = s->cells < 2;
  s->edge[0] = alone ? s->middle[0] - 0.5 : place_between(s->middle[0], s->edge[1], -1, is_log);
  s->edge[s->cells] =
      alone ? s->middle[0] + 0.5
            : place_between(s->middle[s->cells - 1], s->edge[s->cells - 1], -1, is_log);
}

static vs_status fill_cell(void *ctx, const vs_folder_row *row, vs_error *err) {
  map *m = ctx;
  double z;
  (void)err;
  long i = vs_study_results_index(m->x.profile, row->cell[m->x.column]);
  long j = vs_study_results_index(m->y.profile, row->cell[m->y.column]);
  if (i < 0 || j < 0 || !vs_folder_number(row->cell[m->column], &z) || isnan(z)) return VS_OK;
  double *cell = &m->z[(size_t)j / m->y.each * m->x.cells + (size_t)i / m->x.each];
  z *= m->factor;
  if (isnan(*cell) || (m->margin ? z < *cell : fabs(z) > fabs(*cell))) *cell = z;
  return VS_OK;
}

/* Chooses the two axes with the most values, in the order of their columns. */
static void choose_sides(const vs_study_plot *k, size_t side[2]) {
  side[0] = side[1] = 0;
  for (int n = 0; n < 2; n++) {
    size_t most = 0;
    for (size_t a = 0; a < k->n_axes; a++) {
      const vs_profile *p = &k->s->profile[k->axis[a]];
      if (p->many || p->count <= most || (n && k->axis[a] == side[0])) continue;
      most = p->count;
      side[n] = k->axis[a];
    }
  }
  if (side[0] > side[1]) {
    size_t first = side[1];
    side[1] = side[0];
    side[0] = first;
  }
}

static bool map_fits(const vs_study_plot *k) {
  size_t side[2];
  choose_sides(k, side);
  if (!side[0] || !side[1]) return false;
  for (size_t a = 0; a < k->n_axes; a++)
    if (k->s->profile[k->axis[a]].many) return false;
  double cells = (double)k->s->profile[side[0]].count * (double)k->s->profile[side[1]].count;
  return (double)(k->s->rows + k->t->failed) >= 0.5 * cells;
}

static vs_status make_map(map *m, const vs_study_plot *k, size_t column, vs_error *err) {
  size_t side[2];
  choose_sides(k, side);
  *m = (map){.k = k, .column = column, .margin = k->t->column[column].role == VS_ROLE_MARGIN};
  m->x = (map_side){.column = side[0],
                    .profile = &k->s->profile[side[0]],
                    .scale = vs_study_plot_scale(k, side[0])};
  m->y = (map_side){.column = side[1],
                    .profile = &k->s->profile[side[1]],
                    .scale = vs_study_plot_scale(k, side[1])};
  cut_side(&m->x);
  cut_side(&m->y);
  m->factor = vs_study_plot_scale(k, column).factor;
  m->z = vs_alloc(m->x.cells * m->y.cells, sizeof *m->z);
  for (size_t n = 0; n < m->x.cells * m->y.cells; n++) m->z[n] = NAN;
  return vs_folder_each(k->t, fill_cell, m, err);
}

/* ---- the picture ---- */

/* Adds the cells. Each reaches a little into the next ones, which are drawn over it, so that there
 * are no gaps. */
static void add_cells(const map *m, vs_script *script) {
  vs_gnuplot_add(script, "$cells << EOD\n");
  for (size_t j = 0; j < m->y.cells; j++)
    for (size_t i = 0; i < m->x.cells; i++) {
      double z = m->z[j * m->x.cells + i];
      if (isnan(z)) continue;
      bool more_x = i + 1 < m->x.cells && !isnan(m->z[j * m->x.cells + i + 1]);
      bool more_y = j + 1 < m->y.cells && !isnan(m->z[(j + 1) * m->x.cells + i]);
      if (more_x && more_y && isnan(m->z[(j + 1) * m->x.cells + i + 1])) more_y = false;
      double right = more_x ? place_between(m->x.edge[i + 1], m->x.edge[i + 2], 0.2, m->x.scale.log)
                            : m->x.edge[i + 1];
      double top = more_y ? place_between(m->y.edge[j + 1], m->y.edge[j + 2], 0.2, m->y.scale.log)
                          : m->y.edge[j + 1];
      vs_gnuplot_add(script, "%.7g %.7g %.7g %.7g %.7g %.7g %.7g\n", m->x.middle[i], m->y.middle[j],
                     m->x.edge[i], right, m->y.edge[j], top, z);
    }
  vs_gnuplot_add(script, "EOD\n");
}

static void add_piece(void *ctx, const double from[2], const double to[2]) {
  vs_gnuplot_add(ctx, "%.7g %.7g\n%.7g %.7g\n\n", from[0], from[1], to[0], to[1]);
}

/* Draws the line on which the column is at its limit; false: there is none. */
static bool add_contour(const map *m, double level, vs_script *script) {
  const vs_field_grid grid = {m->x.cells, m->y.cells,     m->x.middle,   m->y.middle,
                              m->z,       m->x.scale.log, m->y.scale.log};
  vs_script pieces = {0};
  if (!isnan(level)) vs_map_contour(&grid, level, add_piece, &pieces);
  bool any = pieces.text.length > 0;
  if (any) {
    vs_gnuplot_add(script, "$limit << EOD\n");
    vs_gnuplot_code(script, pieces.text.text);
    vs_gnuplot_add(script, "EOD\n");
  }
  vs_gnuplot_free(&pieces);
  return any;
}

enum {
  MOST_EVEN = 30
}; /* if the largest is this many times the least, colours follow the logarithm */

static void add_colours(const map *m, vs_picture *p) {
  double least = INFINITY, largest = -INFINITY;
  for (size_t n = 0; n < m->x.cells * m->y.cells; n++) {
    if (isnan(m->z[n])) continue;
    least = fmin(least, m->z[n]);
    largest = fmax(largest, m->z[n]);
  }
  if (m->margin && least < -100 && largest > -100) {
    vs_text_add(&p->caption, "All below -100 %% are in one colour; the least is %.4g %%. ", least);
    least = -100;
  }
  vs_study_plot_widen(m->k, m->column, &least, &largest);
  double room = largest > least ? 0 : least != 0 ? 0.01 * fabs(least) : 1;
  vs_gnuplot_code(&p->script, vs_scale_palette);
  vs_gnuplot_add(&p->script, "set cbrange [%.9g:%.9g]\nset cblabel ", least - room, largest + room);
  vs_gnuplot_quoted(&p->script, vs_study_plot_scale(m->k, m->column).label);
  vs_gnuplot_add(&p->script, " offset 1.5,0"); /* room for letters, which grow on narrow pages */
  if (least > 0 && largest > MOST_EVEN * least) vs_gnuplot_add(&p->script, "\nset logscale cb");
  vs_gnuplot_add(&p->script, "\nset colorbox user origin 0.81,0.15 size 0.025,0.72\nset rmargin "
                             "screen 0.79\nset cbtics nomirror in\n");
}

/* Adds the title. With more than two axes it says which of its cases a cell shows. */
static void add_title(const map *m, vs_picture *p) {
  const vs_study_plot *k = m->k;
  vs_text what = {0};
  vs_text_add(&what, "%s", "");
  if (k->n_axes > 2) {
    vs_text_add(&what, ": the %s over ", m->margin ? "least" : "largest amount");
    for (size_t a = 0, n = 0; a < k->n_axes; a++)
      if (k->axis[a] != m->x.column && k->axis[a] != m->y.column)
        vs_text_add(&what, "%s%s", n++ ? ", " : "", k->t->column[k->axis[a]].name);
  }
  vs_study_plot_title(k, m->column, what.text, p);
  vs_text_free(&what);
  if (m->x.each > 1 || m->y.each > 1)
    vs_text_add(&p->caption, "A cell holds %zu by %zu values of its axes. ", m->x.each, m->y.each);
}

static bool has_holes(const map *m) {
  for (size_t n = 0; n < m->x.cells * m->y.cells; n++)
    if (isnan(m->z[n])) return true;
  return false;
}

static void add_map(const map *m, vs_picture *p) {
  double limit = vs_study_plot_limit(m->k, m->column);
  vs_gnuplot_add(&p->script, "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n", m->x.edge[0],
                 m->x.edge[m->x.cells], m->y.edge[0], m->y.edge[m->y.cells]);
  add_colours(m, p);
  add_cells(m, &p->script);
  bool met = add_contour(m, limit, &p->script);
  vs_gnuplot_add(
      &p->script,
      "set object 1 rectangle from graph 0,0 to graph 1,1 fc rgb '#d9d9d9' "
      "fs solid noborder behind\nunset grid\nset tics out nomirror\nset key tmargin right "
      "samplen 2\n"
      "plot $cells using 1:2:3:4:5:6:7 with boxxyerror fs solid noborder lc palette");
  const char *unit = vs_study_plot_scale(m->k, m->column).unit;
  if (met) {
    vs_text line = {0};
    vs_text_add(&line, "%s %.4g %s", m->margin ? "margin" : "limit", limit, unit);
    vs_text_add(&p->caption, "The line: %s. ", line.text);
    vs_gnuplot_add(
        &p->script,
        ", $limit using 1:2 with lines lw 7 lc rgb 'white', $limit using 1:2 with lines lw "
        "3 lc rgb %s title ",
        vs_scale_colour_bad);
    vs_gnuplot_quoted(&p->script, line.text);
    vs_text_free(&line);
  }
  vs_gnuplot_add(&p->script, "\n");
  if (!met && !isnan(limit))
    vs_text_add(&p->caption, "%s %.4g %s%s is met nowhere between the cells. ",
                m->margin ? "Margin" : "The limit,", limit, unit, m->margin ? "" : ",");
  if (has_holes(m)) vs_text_add(&p->caption, "Grey: no case, or one that failed. ");
}

static vs_status draw_map(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err) {
  map m;
  vs_status status = make_map(&m, k, column, err);
  add_title(&m, p);
  p->width = 720;
  p->height = 520;
  vs_study_plot_begin(k, m.x.column, column, p);
  vs_study_plot_axis(k, m.y.column, 'y', &p->script);
  add_map(&m, p);
  free(m.z);
  return status;
}

/* "map": over the two axes with the most values. With further axes, or where several values share a
 * cell, a cell shows the least margin, or the largest amount, of its cases. It is for axes with so
 * few values that the cases fill at least half of the map. */
const vs_chart vs_map_chart = {.name = "map", .fits = map_fits, .draw = draw_map};
