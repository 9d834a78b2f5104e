/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a house asks of the lines of a verdict besides their limits, and what a row of a study comes
 * to by it: a margin of every limit, a part of a limit, waived lines, a criterion for what happens.
 * Rows have all the numbers that it takes, so that nothing is run again. */
#pragma once

#include "base/error.h"
#include "base/field.h"
#include "base/tree.h"
#include "measure/expect.h"

/* What a line or a row comes to. */
typedef enum vs_hold_word { VS_HOLD_HELD, VS_HOLD_VIOLATED, VS_HOLD_UNDECIDED } vs_hold_word;
extern const char *const vs_hold_words[];

/* A line of the verdict, and what is asked of it. */
typedef struct vs_hold_line {
  const char *name; /* "thyristor.v_reverse"; borrowed */
  double limit;     /* as run, SI; NaN: it has two ends, or may differ between cases */
  const char *unit; /* of the limit */
  bool own;         /* the scene itself rates it: what the scene waives is another line */
  int sense;        /* of vs_folder_margins, less 1; 0: the margin is no part of a limit */
  double part;      /* the limit asked for as a part of the one as run; 1: the same */
  int left_out_by;  /* see vs_expect_left_out_by; 0 of a line that the scene rates */
  bool waived;
  const char *because; /* why it is waived, as people said it; borrowed; NULL: they did not */
} vs_hold_line;

typedef struct vs_hold {
  vs_hold_line *line; /* [count], owned */
  size_t count;
  double margin;                 /* of the house: the least margin that holds */
  const vs_criterion *criterion; /* asked for, whatever the rows were run with; NULL: theirs */
  const char *where; /* where lines are looked for, for messages: "the verdicts of this study" */
  const char *hint;  /* what a message adds where no line's name is near */
} vs_hold;

/* Returns the line of that name; SIZE_MAX: there is none. */
size_t vs_hold_find(const vs_hold *hold, const char *name);
/* Error: there is no such line. key: the section that names it. */
vs_status vs_hold_need(const vs_hold *hold, const char *key, const char *name, vs_where where,
                       size_t *line, vs_error *err);
/* Error: no other limit can be asked for, as the margin is no part of one. */
vs_status vs_hold_check_sense(const vs_hold_line *line, const char *key, vs_where where,
                              vs_error *err);

/* Calls take for each text below the map of that key, by its dotted name. */
typedef vs_status (*vs_hold_take)(vs_hold *hold, const char *name, const vs_node *value,
                                  vs_error *err);
vs_status vs_hold_each(vs_hold *hold, const vs_node *map, const char *key, vs_hold_take take,
                       vs_error *err);

/* Takes `margin: 10 %`, or LINE: 0.8, which is the limit times 0.8; of a least one the limit over
 * 0.8. */
vs_status vs_hold_one(vs_hold *hold, const char *name, const vs_node *value, vs_error *err);
/* Reads a list of lines that are waived, or one, each as LINE or {line: LINE, because: TEXT}. NULL:
 * there are none. */
extern const vs_inside vs_hold_waiver; /* the keys of such a map */
vs_status vs_hold_waive(vs_hold *hold, const vs_node *list, vs_error *err);

/* ---- rows ---- */

/* What a row comes to: as it was run, and as it is held. Begin with VS_HOLD_ROW, and set `happened`
 * before the row's lines are taken. */
typedef struct vs_hold_row {
  const char *happened; /* the row's cell of that name; borrowed */
  vs_hold_word stored, now;
  double margin, error; /* of the weakest line, now; NaN: there is none */
  size_t weakest;       /* SIZE_MAX: none */
} vs_hold_row;
#define VS_HOLD_ROW                                                                                \
  ((vs_hold_row){.happened = "", .margin = NAN, .error = NAN, .weakest = SIZE_MAX})

/* Takes a line of the row: its margin and its error as they were run (error NaN: it was not
 * computed). not_judged is the row's cell. Tells in `came` what the line came to, as run and now.
 */
void vs_hold_judge(const vs_hold *hold, size_t line, double margin, double error,
                   const char *not_judged, vs_hold_row *row, vs_hold_word came[2]);

/* Takes what happened. */
void vs_hold_happened(const vs_hold *hold, vs_hold_row *row);

/* Takes the row's status and its warnings, once all else is taken. A line may have no column: what
 * it breaks the status has alone. false: the status is 0, and lines are broken; the row was
 * changed. */
bool vs_hold_rest(const vs_hold *hold, bool broken, const char *warnings, vs_hold_row *row);

/* True if the first margin is weaker than the other, as vs_verdict_is_weaker has it. */
bool vs_hold_is_weaker(double margin, double error, double other, double of_other);
