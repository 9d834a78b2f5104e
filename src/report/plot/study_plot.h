/* SPDX-License-Identifier: GPL-3.0-or-later
 * What all pictures of a study share. A picture is a gnuplot script that contains its data. Here
 * columns are read and thinned out, and titles, axes and limits are drawn. */
#pragma once

#include "base/gnuplot.h"
#include "base/text.h"
#include "report/scale.h"
#include "study/study_results.h"

typedef struct vs_picture {
  char name[256]; /* of its file, without the ending */
  vs_text title, caption;
  vs_script script;  /* for gnuplot, without terminal and output */
  int width, height; /* pixels */
  bool labels_above; /* two lines of labels stand above the frame, between the limit's label and the
                        title */
} vs_picture;

/* What a picture is made from. */
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
  /* True if the study's axes and cases allow the picture. NULL: all do. */
  bool (*fits)(const vs_study_plot *k);
  bool whole;     /* it shows a whole search, so the column it is drawn for still needs a picture */
  bool each_axis; /* it is drawn once for each axis with few values, which is then k->one */
  /* Draws the column. Leaves p->name empty if there is nothing to draw. Errors: study.csv can no
   * longer be read. */
  vs_status (*draw)(const vs_study_plot *k, size_t column, vs_picture *p, vs_error *err);
} vs_chart;

/* All kinds of picture. charts.c: a column over the only axis, with a line for each word of a
 * second one ("curve"); over the number of the case ("cases"), for a search with the worst so far
 * ("path"); coloured points for cases anywhere between two axes of numbers ("cloud"); one measure
 * over another, with named points ("pair"). map.c:
 * coloured cells over two axes ("map"). feasible.c: the candidates that a search for one that holds
 * has tried ("feasible"). spread.c: how a column is distributed over many cases ("histogram"), its
 * worst corners ("bars"), and what influences it ("influence", "effect"). */
extern const vs_chart vs_charts_curve, vs_charts_cases, vs_charts_path, vs_charts_cloud,
    vs_charts_pair, vs_map_chart, vs_feasible_chart, vs_spread_histogram, vs_spread_bars,
    vs_spread_influence, vs_spread_effect;

/* How the column is shown; column 0 is the number of the case. */
vs_scale vs_study_plot_scale(const vs_study_plot *k, size_t column);

/* Returns the column's limit in the unit shown; for a margin it is 0. NaN: it has none. */
double vs_study_plot_limit(const vs_study_plot *k, size_t column);

/* A point of a picture, in the units shown; for a column of words, with the word's index. */
typedef struct vs_dot {
  double x, y;
  long number; /* the case's */
} vs_dot;
typedef struct vs_dots {
  vs_dot *item;
  size_t count;
} vs_dots;
/* Reads column y over column x, or over the number of the case if x is 0. Rows in which either is
 * not known are left out. vs_study_plot_dots_free is due even after an error. */
vs_status vs_study_plot_dots_load(const vs_study_plot *k, size_t x, size_t y, vs_dots *series,
                                  vs_error *err);
void vs_study_plot_dots_sort(vs_dots *series); /* by x, then by case */
/* Keeps about `most` points without changing how the curve looks: the least and the largest of each
 * stretch of sorted points. */
void vs_study_plot_dots_thin(vs_dots *series, size_t most);
void vs_study_plot_dots_free(vs_dots *series);

/* Sets the title, the column's name and `what`, and the caption, the manifest's text of the column.
 */
void vs_study_plot_title(const vs_study_plot *k, size_t column, const char *what, vs_picture *p);
/* Begins the script with the style, the title and the x axis. A picture without a name gets that of
 * column y. */
void vs_study_plot_begin(const vs_study_plot *k, size_t x, size_t y, vs_picture *p);
/* Adds what the axis ('x' or 'y') of this column needs: label, logarithmic scale, words instead of
 * numbers. */
void vs_study_plot_axis(const vs_study_plot *k, size_t column, char axis, vs_script *script);
/* False where the column's values differ by no more than what numbers may be wrong by. */
bool vs_study_plot_varies(const vs_study_plot *k, size_t column);
/* Widens the ends of what is shown of a measure to its error at least, as pictures of smaller
 * differences would show what is none. */
void vs_study_plot_widen(const vs_study_plot *k, size_t column, double *least, double *largest);

/* Sets the axis' range to what is drawn, with 0 if asked, and with the column's limit if that is
 * near; the limit is drawn as a line. */
void vs_study_plot_range(const vs_study_plot *k, size_t column, char axis, bool from_zero,
                         vs_picture *p);
/* Puts the points that lie below the range at its lower end, each with its number. */
void vs_study_plot_below(const vs_study_plot *k, size_t column, vs_dots *series, vs_picture *p);
/* Adds the points as the data block $NAME. With `gaps` the line is interrupted where cases are
 * missing. */
void vs_study_plot_data(vs_script *script, const char *name, const vs_dots *series, bool gaps);
