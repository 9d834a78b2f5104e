/* SPDX-License-Identifier: GPL-3.0-or-later
 * What all pictures of a study share: a gnuplot script with its data in it, columns read and
 * thinned out, limits, labels. */
#ifndef VS_PICTURE_SKETCH_H
#define VS_PICTURE_SKETCH_H

#include "base/text.h"
#include "picture/scale.h"
#include "survey/survey.h"

typedef struct vs_picture {
  char name[256]; /* of its file, without the ending */
  vs_text title, caption;
  vs_text script; /* all but terminal and output */
  int width, height;
  bool labels_above; /* two lines of them above the frame; then a limit's, then the title */
} vs_picture;

/* What is drawn from. */
typedef struct vs_sketch {
  const vs_folder *t;
  const vs_survey *s;
  size_t axis[VS_STUDY_COLUMNS]; /* which columns are axes, and there is more than one value of */
  size_t n_axes;
  size_t one; /* the axis whose turn it is, for a chart that is drawn for each */
} vs_sketch;

/* A kind of picture: one const struct, and a row in the table in album.c. */
typedef struct vs_chart {
  const char *name; /* as methods name it */
  /* Says whether the study's axes and cases allow it. NULL: whatever they are. */
  bool (*fits)(const vs_sketch *k);
  bool whole;     /* it shows a search as a whole: the column it is drawn for is still to show */
  bool each_axis; /* it is drawn once for each axis of few values, which is k->one then */
  /* Draws the column. Leaves p->name empty where there is nothing to draw. Errors: study.csv can no
   * longer be read. */
  vs_status (*draw)(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);
} vs_chart;

vs_scale vs_sketch_scale(const vs_sketch *k, size_t column);

/* The column's rating as it is shown; of a margin 0. NAN: it has none. */
double vs_sketch_limit(const vs_sketch *k, size_t column);

/* A column over another, or over the number of the case (x: 0), in the units shown; only rows where
 * both are known. */
typedef struct vs_dot {
  double x, y;
  long number; /* the case's */
} vs_dot;
typedef struct vs_dots {
  vs_dot *item;
  size_t count;
} vs_dots;
vs_status vs_sketch_dots_load(const vs_sketch *k, size_t x, size_t y, vs_dots *series,
                              vs_error *err);
void vs_sketch_dots_sort(vs_dots *series); /* by x, then by case */
/* At most about `most` points, of which those left out lie between the ones kept: of each stretch
 * its least and largest. Call it on a sorted one. */
void vs_sketch_dots_thin(vs_dots *series, size_t most);
void vs_sketch_dots_free(vs_dots *series);

/* The column's name and `what` as title; what the manifest says it is as caption. */
void vs_sketch_title(const vs_sketch *k, size_t column, const char *what, vs_picture *p);
/* Begins the script: style, title, both axes' labels. y 0: no such axis' column. */
void vs_sketch_begin(const vs_sketch *k, size_t x, size_t y, vs_picture *p);
/* "set xlabel 'circuit.r1 / Ω'", logscale, names in place of numbers; axis: 'x' or 'y' */
void vs_sketch_axis(const vs_sketch *k, size_t column, char axis, vs_text *script);
/* The range of what is drawn, with the limit when it lies near, and 0 where asked; draws the limit
 * as a line. */
void vs_sketch_range(const vs_sketch *k, size_t column, char axis, bool from_zero, vs_picture *p);
/* "$NAME << EOD", x y on a line, an empty line where `gaps` and the case numbers jump. */
void vs_sketch_data(vs_text *script, const char *name, const vs_dots *series, bool gaps);

#endif
