/* SPDX-License-Identifier: GPL-3.0-or-later
 * What may be bought: a list of parts with their prices, which is a CSV file of the user's, and the
 * E series of IEC 60063, in whose values resistors and capacitors are sold.
 *
 *   part,kind,value,price_eur,volume_cm3,p_rated_w
 *   TYN1212,thyristor,,1.30,0.9,
 *   R_3W,resistor,,0.15,0.8,3           of any value
 *   C_47n,capacitor,47 nF,0.25,1.5,     of this one
 *
 * The columns part and kind are wanted, value may be missing, all others are the user's own. */
#pragma once

#include "base/error.h"
#include "base/path.h"

/* A cell, with its place. An empty one has the text "". */
typedef struct vs_price_cell {
  char *text;
  vs_where where;
} vs_price_cell;

typedef struct vs_price_list {
  char path[VS_PATH_SIZE]; /* places point to it, so the struct stays where it was read */
  char **title;            /* [columns], as in the file's first row */
  vs_price_cell *cell;     /* [rows][columns] */
  size_t columns, rows;
  size_t part, kind, value; /* which columns these are; value SIZE_MAX: there is none */
} vs_price_list;

/* Reads the file, which is named at `where`. Errors, with their place: a column is missing or
 * stands there twice, a row has fewer or more cells, a part stands there twice, a kind is not
 * known. vs_price_list_free even then. */
vs_status vs_price_list_read(const char *path, vs_where where, vs_price_list *list, vs_error *err);
void vs_price_list_free(vs_price_list *list);

/* Returns the column of that title; SIZE_MAX: there is none. */
size_t vs_price_list_column(const vs_price_list *list, const char *title);
/* Returns the row of that part; SIZE_MAX: there is none. */
size_t vs_price_list_find(const vs_price_list *list, const char *part);
/* Returns the first row of that kind from row `from` on; SIZE_MAX: there are no more. */
size_t vs_price_list_next(const vs_price_list *list, const char *kind, size_t from);
const vs_price_cell *vs_price_list_cell(const vs_price_list *list, size_t row, size_t column);
/* Reads a cell as a number. Error: it is none, or the cell is empty. */
vs_status vs_price_list_number(const vs_price_list *list, size_t row, size_t column, double *value,
                               vs_error *err);

/* Fills values[most] with those of the series ("E12") from `from` to `to`, rising, and returns how
 * many there are, which may be more than `most`. 0: there is no such series, or it has none there.
 * Both ends must be above 0. */
size_t vs_price_list_series(const char *series, double from, double to, double *values,
                            size_t most);
/* Returns the value of the series next above the given one (step 1) or next below (-1). NaN: there
 * is no such series. */
double vs_price_list_neighbour(const char *series, double value, int step);
