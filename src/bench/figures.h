/* SPDX-License-Identifier: GPL-3.0-or-later
 * Figures of a part: what its file asks for and what the test stand got, row by row, with curves of
 * what was seen. */
#pragma once

#include "stand.h"

/* How a figure is held to what is asked: it may be off by a tolerance either way, or it may be at
 * most or at least what is asked, but for the tolerance; or nothing is asked. */
typedef enum vs_held { VS_HELD_NEAR, VS_HELD_AT_MOST, VS_HELD_AT_LEAST, VS_HELD_NOT } vs_held;

/* One row. */
typedef struct vs_figure {
  const char *name, *unit; /* the unit is the one it is shown in */
  char text[96];           /* the conditions of the test */
  vs_held held;
  double asked, got; /* SI; NaN: nothing is asked; it could not be measured */
  double tolerance;  /* SI */
  vs_where where;    /* the line of the part's file that asks; no file: none does */
  char why[200];     /* why it could not be measured */
  const char *of;    /* the data sheet's name of it, as that of a limit; NULL: it has none */
  double sheet;      /* what the sheet says of that, SI: the file's limit of that name, else what is
                        asked; NaN: nothing */
} vs_figure;

/* One curve: points x, y, both owned, in the units of its labels. */
typedef struct vs_figures_curve {
  const char *title, *x_label, *y_label;
  bool log_x;
  size_t points;
  double *x, *y;
} vs_figures_curve;

/* All of one part. Start from {0}; end with vs_figures_free. */
enum { VS_MOST_FIGURES = 24, VS_MOST_CURVES = 6 };
typedef struct vs_figures {
  vs_figure row[VS_MOST_FIGURES];
  size_t count;
  vs_figures_curve curve[VS_MOST_CURVES];
  size_t n_curves;
  char shows[200]; /* that the part is of another kind, and of which; "": nothing tells that */
} vs_figures;

void vs_figures_free(vs_figures *figures);

/* What the part's file asks for. */
typedef struct vs_figures_asked {
  double value; /* SI; NaN: it does not say */
  vs_where where;
} vs_figures_asked;

/* A parameter of the part, or of a file that it includes. */
vs_figures_asked vs_figures_param(const vs_stand *stand, const char *name);
/* The parameter PART_WORD, as templates write those of a part's own. */
vs_figures_asked vs_figures_own(const vs_stand *stand, const char *word);
/* The parameter of that name, or PART_NAME, or KIND_NAME: the first there is. */
vs_figures_asked vs_figures_any(const vs_stand *stand, const char *name);
/* A limit of the part's file; "none" and a limit that is not there are NaN. */
vs_figures_asked vs_figures_limit(const vs_stand *stand, const char *name);
/* The first of these that is a number, each as a limit or as any parameter; `otherwise` where none
 * is. */
double vs_figures_first(const vs_stand *stand, const char *const *names, double otherwise);

/* A condition of a test, which a file gives by a limit or by a parameter: the model's own goes
 * first where what is asked is the model's own. */
double vs_figures_condition(const vs_stand *stand, bool own, const char *const limit_param[2],
                            double otherwise);

/* Adds a row, of which nothing is got yet. The caller fills it. tolerance: a fraction of what is
 * asked. A limit is held as `held` says. */
vs_figure *vs_figures_add(vs_figures *figures, const char *name, const char *unit,
                          vs_figures_asked asked, double tolerance, vs_held held);

/* The row is the data sheet's figure of that name, as that of a limit. */
void vs_figures_is(vs_figure *row, const vs_stand *stand, const char *name);
/* How far the model is from the sheet in the figure of that name, as a part of the sheet's: of
 * several rows the one that is furthest. NaN: there is no such row that has both, or it is
 * infinite. */
double vs_figures_deviation(const vs_figures *figures, const char *name);

/* Adds a curve of so many points, to be filled; NULL: there is no room. */
vs_figures_curve *vs_figures_add_curve(vs_figures *figures, size_t points);

/* The word of a row: "held", "off", "failed" (it could not be measured), "seen" (nothing is asked
 * for). */
const char *vs_figures_word(const vs_figure *row);

/* A test that a figure divides: true on one side of it. Errors: it could not be run. */
typedef vs_status (*vs_figures_test)(const vs_stand *stand, const void *ctx, double value,
                                     bool *yes, vs_error *err);

/* Finds the positive value from which on `test` is true, within 2 %, from a first guess on, by
 * doubling or halving it up to ten times and then by halving the interval. Fills row->got, or
 * row->why. */
void vs_figures_find(const vs_stand *stand, vs_figures_test test, const void *ctx, double guess,
                     vs_figure *row);

/* A kind of parts that can be tried: a plug. */
typedef struct vs_figures_kind {
  const char *name; /* as in `*$ part KIND` */
  void (*measure)(const vs_stand *stand, vs_figures *figures);
} vs_figures_kind;

/* All kinds that there are; the table of them stands in acceptance.c. */
extern const vs_figures_kind vs_thyristor_kind, vs_triac_kind, vs_diode_kind, vs_diac_kind,
    vs_transistor_mosfet, vs_transistor_igbt, vs_varistor_kind, vs_varistor_zener, vs_varistor_tvs,
    vs_fuse_kind, vs_passive_resistor, vs_passive_capacitor, vs_passive_snubber,
    vs_passive_electrolytic;
