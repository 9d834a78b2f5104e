/* SPDX-License-Identifier: GPL-3.0-or-later
 * What all pictures of a study share. A picture is a gnuplot script with its data in it. Columns
 * are read and thinned out here, and titles, axes and limits are drawn. */
#ifndef VS_REPORT_STUDY_PLOT_H
#define VS_REPORT_STUDY_PLOT_H

#include "base/gnuplot.h"
#include "base/text.h"
#include "report/scale.h"
#include "study/study_results.h"

typedef struct vs_picture {
  char name[256]; /* of its file, without the ending */
  vs_text title, caption;
  vs_script script;  /* for gnuplot, without terminal and output */
  int width, height; /* pixels */
  bool labels_above; /* two lines of labels stand above the frame, between the limit's and the title
                      */
} vs_picture;

/* What is drawn from. */
typedef struct vs_study_plot {
  const vs_folder *t;
  const vs_study_results *s;
  size_t axis[VS_STUDY_COLUMNS]; /* the columns that are axes and have more than one value */
  size_t n_axes;
  size_t one; /* the axis whose turn it is, for a chart that is drawn for each */
} vs_study_plot;

/* A kind of picture: one const struct, and a row in the table in study_pictures.c. */
typedef struct vs_chart {
  const char *name; /* as methods name it */
  /* Says whether the study's axes and cases allow it. NULL: whatever they are. */
  bool (*fits)(const vs_study_plot *k);
  bool whole;     /* it shows a search as a whole: the column it is drawn for is still to show */
  bool each_axis; /* it is drawn once for each axis of few values, which is k->one then */
  /* Draws the column. Leaves p->name empty where there is nothing to draw. Errors: study.csv can no
   * longer be read. */
  vs_status (*draw)(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err);
} vs_chart;

/* All kinds of picture. charts.c: a column over the one axis, with a line for each word of a second
 * one ("curve"); over the number of the case ("cases"), for a search with the worst so far
 * ("path"); points in colour, for cases that lie anywhere between two axes that are numbers
 * ("cloud"). map.c: cells in colour over two axes ("map"). feasible.c: what a search for something
 * that holds has tried ("feasible"). spread.c: how a column is spread over many cases
 * ("histogram"), its worst corners ("bars"), and what moves it ("influence", "effect"). */
extern const vs_chart vs_charts_curve, vs_charts_cases, vs_charts_path, vs_charts_cloud,
    vs_map_chart, vs_feasible_chart, vs_spread_histogram, vs_spread_bars, vs_spread_influence,
    vs_spread_effect;

/* How the column is shown; column 0 is the number of the case. */
vs_scale vs_study_plot_scale(const vs_study_plot *k, size_t column);

/* Returns the column's rating in the unit shown; of a margin it is 0. NaN: it has none. */
double vs_study_plot_limit(const vs_study_plot *k, size_t column);

/* A point of a picture, in the units shown. Of a column of words it has the word's index. */
typedef struct vs_dot {
  double x, y;
  long number; /* the case's */
} vs_dot;
typedef struct vs_dots {
  vs_dot *item;
  size_t count;
} vs_dots;
/* Reads column y over column x, or over the number of the case where x is 0. Rows in which one of
 * the two is not known are left out. vs_study_plot_dots_free even after an error. */
vs_status vs_study_plot_dots_load(const vs_study_plot *k, size_t x, size_t y, vs_dots *series,
                                  vs_error *err);
void vs_study_plot_dots_sort(vs_dots *series); /* by x, then by case */
/* Leaves about `most` points, so that a curve looks the same: of each stretch of sorted points it
 * keeps the least and the largest. */
void vs_study_plot_dots_thin(vs_dots *series, size_t most);
void vs_study_plot_dots_free(vs_dots *series);

/* Makes the column's name and `what` the title, and what the manifest says of it the caption. */
void vs_study_plot_title(const vs_study_plot *k, size_t column, const char *what, vs_picture *p);
/* Begins the script with the style, the title and the x axis. A picture that has no name yet gets
 * that of column y. */
void vs_study_plot_begin(const vs_study_plot *k, size_t x, size_t y, vs_picture *p);
/* Adds what an axis ('x' or 'y') that shows the column needs: label, logscale, words in place of
 * numbers. */
void vs_study_plot_axis(const vs_study_plot *k, size_t column, char axis, vs_script *script);
/* Sets the axis' range to what is drawn, with 0 where asked, and with the column's limit where that
 * lies near; the limit is drawn as a line. */
void vs_study_plot_range(const vs_study_plot *k, size_t column, char axis, bool from_zero,
                         vs_picture *p);
/* Adds the points as the data block $NAME. With `gaps` the line is broken wherever cases are
 * missing. */
void vs_study_plot_data(vs_script *script, const char *name, const vs_dots *series, bool gaps);

#endif
