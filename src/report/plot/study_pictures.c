/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/study_pictures.h"

#include <assert.h>
#include <string.h>

/* To add a kind of picture: write its const vs_chart, declare it in study_plot.h, and add a row
 * here. A method that wants it names it (vs_method.report). If its file is not named after its
 * column, add the name to study/cleanup.c too, which removes the pictures of an older study.
 * test_tables and test_report draw it. */
static const vs_chart *const CHARTS[] = {
    &vs_charts_curve, &vs_charts_cases,     &vs_charts_path,    &vs_charts_cloud,
    &vs_charts_pair,  &vs_map_chart,        &vs_feasible_chart, &vs_spread_histogram,
    &vs_spread_bars,  &vs_spread_influence, &vs_spread_effect};
enum { N_CHARTS = sizeof CHARTS / sizeof *CHARTS };

/* The row of that name; N_CHARTS: there is none. */
static size_t row_of(const char *name) {
  size_t k = 0;
  while (k < N_CHARTS && strcmp(CHARTS[k]->name, name)) k++;
  return k;
}

bool vs_study_pictures_knows(const char *name) {
  return row_of(name) < N_CHARTS;
}

static const vs_chart *find_chart(const char *name) {
  size_t k = row_of(name);
  assert(k < N_CHARTS); /* fails where a method names a picture that is not in the table */
  return CHARTS[k];
}

static bool chart_fits(const vs_chart *chart, const vs_study_plot *k) {
  return !chart->fits || chart->fits(k);
}

/* Returns the kind of picture for every column: the first kind of the last method's list that fits
 * the study. */
static const vs_chart *every_column(const vs_study_plot *k) {
  static const char *const UNKNOWN[] = {"curve", "map", "cases", NULL};
  const char *const *names = UNKNOWN;
  for (size_t m = 0; m < k->t->n_methods; m++)
    if (k->t->methods[m]->report.each) names = k->t->methods[m]->report.each;
  for (; *names; names++)
    if (chart_fits(find_chart(*names), k)) return find_chart(*names);
  return &vs_charts_cases;
}

static vs_picture *next_picture(vs_study_pictures *album) {
  if (album->count == VS_STUDY_PICTURES_MOST) {
    album->left_out++;
    return NULL;
  }
  return &album->item[album->count++];
}

static vs_status add_one(const vs_study_plot *k, const vs_chart *chart, size_t column,
                         vs_study_pictures *album, vs_error *err) {
  vs_picture *p = next_picture(album);
  vs_status status = p ? chart->draw(k, column, p, err) : VS_OK;
  if (p && !*p->name) album->count--; /* there was nothing to draw */
  return status;
}

static vs_status add_pictures_of(const vs_study_plot *k, const vs_chart *chart, size_t column,
                                 vs_study_pictures *album, vs_error *err) {
  vs_study_plot of_axis = *k;
  vs_status status = VS_OK;
  if (!chart->each_axis) return add_one(k, chart, column, album, err);
  for (size_t a = 0; a < k->n_axes && !status; a++) {
    if (k->s->profile[k->axis[a]].many) continue;
    of_axis.one = k->axis[a];
    status = add_one(&of_axis, chart, column, album, err);
  }
  return status;
}

/* Draws all pictures of the list that fit; sets *shown if one of them shows the column. */
static vs_status add_list(const vs_study_plot *k, const char *const *names, size_t column,
                          bool *shown, vs_study_pictures *album, vs_error *err) {
  vs_status status = VS_OK;
  for (; names && *names && !status; names++) {
    const vs_chart *chart = find_chart(*names);
    if (!chart_fits(chart, k)) continue;
    *shown = *shown || !chart->whole;
    status = add_pictures_of(k, chart, column, album, err);
  }
  return status;
}

/* Lists the columns with numbers; the one by which cases are judged comes first. */
static size_t list_columns(const vs_study_plot *k, size_t *column) {
  bool largest;
  size_t n = 0, aim = vs_folder_aim(k->t, &largest);
  if (aim && k->s->profile[aim].known) column[n++] = aim;
  for (size_t c = 1; c < k->t->count; c++) {
    vs_folder_role role = k->t->column[c].role;
    if ((role == VS_ROLE_MARGIN || role == VS_ROLE_REPORT) && c != aim && k->s->profile[c].known)
      column[n++] = c;
  }
  return n;
}

/* Lists the axes that have more than one value. */
static void list_axes(vs_study_plot *k) {
  for (size_t c = 0; c < k->t->count; c++)
    if (k->t->column[c].role == VS_ROLE_AXIS &&
        (k->s->profile[c].many || k->s->profile[c].count > 1))
      k->axis[k->n_axes++] = c;
}

vs_status vs_study_pictures_make(const vs_folder *t, const vs_study_results *s,
                                 vs_study_pictures *album, vs_error *err) {
  vs_study_plot k = {.t = t, .s = s};
  size_t column[VS_STUDY_COLUMNS];
  vs_status status = VS_OK;
  bool shown = false;
  list_axes(&k);
  size_t n = list_columns(&k, column);
  if (!n) return VS_OK;
  for (size_t m = t->n_methods; m-- > 0 && !status;)
    status = add_list(&k, t->methods[m]->report.lead, column[0], &shown, album, err);
  const vs_chart *chart = every_column(&k);
  for (size_t i = shown; i < n && !status; i++)
    status = add_pictures_of(&k, chart, column[i], album, err);
  if (!status && vs_charts_pair.fits(&k)) status = add_one(&k, &vs_charts_pair, 0, album, err);
  for (size_t m = t->n_methods; m-- > 0 && !status;)
    status = add_list(&k, t->methods[m]->report.last, column[0], &shown, album, err);
  return status;
}

void vs_study_pictures_free(vs_study_pictures *album) {
  for (size_t k = 0; k < album->count; k++) {
    vs_text_free(&album->item[k].title);
    vs_text_free(&album->item[k].caption);
    vs_gnuplot_free(&album->item[k].script);
  }
  album->count = 0;
}
