/* SPDX-License-Identifier: GPL-3.0-or-later
 * The kind of picture that shows the candidates that a search has tried for one that holds. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/gnuplot.h"
#include "members.h"
#include "plot/study_plot.h"

typedef struct candidate {
  long number; /* the case's */
  bool holds;
  double x, y; /* as shown; NaN: not read yet */
} candidate;

typedef struct region {
  const vs_study_plot *k;
  size_t column[2]; /* the first two axes that have a range */
  double factor[2];
  candidate *item;
  size_t count;
} region;

static int by_number(const void *a, const void *b) {
  const candidate *one = a, *other = b;
  return (one->number > other->number) - (one->number < other->number);
}

static const vs_node *candidates_of(const vs_folder *t) {
  return vs_tree_child(vs_folder_search(t), "candidates");
}

/* Reads the candidates that the manifest names. false: it names none, or there are not two axes to
 * draw them over. */
static bool find_candidates(region *r) {
  const vs_folder *t = r->k->t;
  const vs_node *list = candidates_of(t);
  size_t n = 0, axes = 0;
  for (size_t c = 0; c < t->count && axes < 2; c++)
    if (t->column[c].role == VS_ROLE_AXIS && vs_tree_child(t->column[c].node, "from") &&
        r->k->s->profile[c].is_number)
      r->column[axes++] = c;
  for (const vs_node *c = list ? list->child : NULL; c; c = c->next) n++;
  if (axes < 2 || !n) return false;
  r->item = vs_alloc(n, sizeof *r->item);
  for (const vs_node *c = list->child; c; c = c->next)
    r->item[r->count++] = (candidate){strtol(vs_member_word(c, "case"), NULL, 10),
                                      !strcmp(vs_member_word(c, "holds"), "true"), NAN, NAN};
  qsort(r->item, r->count, sizeof *r->item, by_number);
  for (int n_axis = 0; n_axis < 2; n_axis++)
    r->factor[n_axis] = vs_study_plot_scale(r->k, r->column[n_axis]).factor;
  return true;
}

static vs_status place_candidate(void *ctx, const vs_folder_row *row, vs_error *err) {
  region *r = ctx;
  const candidate key = {.number = row->number};
  candidate *c = bsearch(&key, r->item, r->count, sizeof key, by_number);
  (void)err;
  if (!c) return VS_OK;
  vs_folder_number(row->cell[r->column[0]], &c->x);
  vs_folder_number(row->cell[r->column[1]], &c->y);
  c->x *= r->factor[0];
  c->y *= r->factor[1];
  return VS_OK;
}

/* Draws the candidates of one kind, by its index in the tables below. */
static void add_points(const region *r, int kind, bool *any, vs_picture *p) {
  static const char *const STYLES[] = {"pt 2 ps 0.9 lw 1.6", "pt 7 ps 1", "pt 6 ps 2.4 lw 2.4"};
  static const char *const TITLES[] = {"does not hold", "holds", "cheapest"};
  const char *const colours[] = {vs_scale_colour_bad, vs_scale_colour_good, "#000000"};
  const long found = vs_folder_found(r->k->t);
  vs_script points = {0};
  for (size_t k = 0; k < r->count; k++) {
    const candidate *c = &r->item[k];
    bool in = kind == 2 ? c->number == found : c->holds == (kind == 1);
    if (in && !isnan(c->x) && !isnan(c->y)) vs_gnuplot_add(&points, "%.9g %.9g\n", c->x, c->y);
  }
  if (points.text.length) {
    vs_script data = {0};
    vs_gnuplot_add(&data, "$kind%d << EOD\n", kind);
    vs_gnuplot_code(&data, points.text.text);
    vs_gnuplot_add(&data, "EOD\n");
    vs_gnuplot_code(&data, p->script.text.text); /* data go before the plot command */
    vs_gnuplot_free(&p->script);
    p->script = data;
    vs_gnuplot_add(&p->script, *any ? ", " : "plot ");
    vs_gnuplot_add(&p->script, "$kind%d using 1:2 with points ", kind);
    vs_gnuplot_code(&p->script, STYLES[kind]);
    vs_gnuplot_add(&p->script, " lc rgb %s title %s", colours[kind], TITLES[kind]);
    *any = true;
  }
  vs_gnuplot_free(&points);
}

/* Sets the axis' range to everything that was tried, with a small border. */
static void add_range(const vs_study_plot *k, size_t column, char axis, vs_script *script) {
  const vs_profile *f = &k->s->profile[column];
  const vs_scale scale = vs_study_plot_scale(k, column);
  double least = f->least * scale.factor, largest = f->largest * scale.factor;
  double room = 0.05 * (largest - least);
  if (largest > least)
    vs_gnuplot_add(script, "set %crange [%.9g:%.9g]\n", axis,
                   scale.log ? least / 1.3 : least - room,
                   scale.log ? largest * 1.3 : largest + room);
}

static vs_status draw_feasible(const vs_study_plot *k, size_t column, vs_picture *p,
                               vs_error *err) {
  region r = {.k = k};
  bool any = false;
  if (!find_candidates(&r)) return VS_OK;
  vs_status status = vs_folder_each(k->t, place_candidate, &r, err);
  snprintf(p->name, sizeof p->name, "feasible");
  p->width = 720;
  p->height = 520;
  vs_text_add(&p->title, "What was tried, and what holds over the spread");
  vs_study_plot_begin(k, r.column[0], column, p);
  vs_study_plot_axis(k, r.column[1], 'y', &p->script);
  vs_gnuplot_add(&p->script, "set key tmargin center horizontal samplen 1\n");
  add_range(k, r.column[0], 'x', &p->script);
  add_range(k, r.column[1], 'y', &p->script);
  for (int kind = 0; kind < 3; kind++) add_points(&r, kind, &any, p);
  if (!any) *p->name = '\0';
  vs_gnuplot_add(&p->script, "\n");
  free(r.item);
  return status;
}

/* "feasible": the candidates that the manifest names, over the first two axes that have a range:
 * which of them hold, and which is the answer. The picture is the same for every column. There is
 * none if the manifest names no candidates. */
const vs_chart vs_feasible_chart = {.name = "feasible", .whole = true, .draw = draw_feasible};
