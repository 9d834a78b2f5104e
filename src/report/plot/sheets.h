/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the pictures of a run show: each is a sheet of panels with one curve of run.csv each. For
 * the paper's scene they are its Figs. 9 to 11; other scenes have the same. A run with instruments
 * has two more, which show their curves as Figs. 13 and 14 do; a run with a control has one more
 * for that. */
#pragma once

#include <stddef.h>

enum {
  VS_SHEET_PANELS = 96, /* at most 36 of the program's own, then those an overlay asks for */
  VS_SHEET_NAME = 96,
  VS_SHEETS_OF_RUN = 3, /* of any run; the later ones show instruments */
  VS_SHEETS = 6,
  VS_SHEET_INSTRUMENTS = 32
};

typedef struct vs_panel {
  char column[VS_SHEET_NAME], label[VS_SHEET_NAME]; /* of run.csv; what the axis says */
  double scale;                                     /* from the column's unit to the axis' */
} vs_panel;

typedef struct vs_sheet {
  const char *name;               /* the picture's file name without its ending */
  char title[VS_SHEET_NAME + 32]; /* what stands above it */
  double from_s, until_s;         /* until: 0: the whole run */
  int columns;                    /* how many panels stand side by side */
  vs_panel panels[VS_SHEET_PANELS];
  int count;
} vs_sheet;

/* A column of run.csv that is drawn over another one: an instrument's, or a control's set point. */
typedef struct vs_sheet_shown {
  char name[VS_SHEET_NAME + 16]; /* "instrument p" */
  char column[VS_SHEET_NAME];    /* its own */
  char of[VS_SHEET_NAME]; /* the column that it is drawn over: its channel's, or its own if run.csv
                             does not have that one */
} vs_sheet_shown;

/* All pictures of one run. */
typedef struct vs_sheets {
  vs_sheet set[VS_SHEETS]; /* one file each; those of instruments and of a
                               control are empty without any */
  vs_sheet overview;       /* what `plot -o` draws on its one sheet */
  vs_sheet_shown shown[VS_SHEET_INSTRUMENTS];
  int n_shown;
} vs_sheets;

/* Returns the sheets of a run that ends at until_s, for the caller to free(). header: of run.csv,
 * whose columns vs_traces_columns knows. */
vs_sheets *vs_sheets_new(const char *folder, const char *header, double until_s);

/* The n-th column, from 0, that is drawn over this column of run.csv; NULL: there is none. */
const vs_sheet_shown *vs_sheets_shown(const vs_sheets *sheets, const char *column, int n);

/* Appends a panel; dropped where there is no room. */
void vs_sheet_add(vs_sheet *sheet, const char *column, const char *label, double scale);
/* The panel that shows the column; NULL: the sheet has none. */
const vs_panel *vs_sheet_find(const vs_sheet *sheet, const char *column);
