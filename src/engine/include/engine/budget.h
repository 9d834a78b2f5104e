/* SPDX-License-Identifier: GPL-3.0-or-later
 * How much a search of runs may take. A search for the share of the load consists of searches for
 * orbits, and each of these of runs over cycles of the mains. All of them count on one budget. It
 * counts cycles and not seconds, so that a search ends at the same cycle on every machine. */
#pragma once

#include "base/error.h"

/* Cycles of a run without a circuit, and with one, which take a hundred times as long and more. */
enum { VS_BUDGET_IDEAL, VS_BUDGET_CIRCUIT, VS_BUDGET_KINDS };

/* Start from {.what = ..., .most = ...}. */
typedef struct vs_budget {
  const char *what;            /* the search, as its messages name it */
  struct vs_budget *of;        /* that of the search that this one is a part of, on which it counts,
                                  too; NULL: it is a part of none; borrowed */
  long most[VS_BUDGET_KINDS];  /* cycles that may be run; at least 1 */
  long spent[VS_BUDGET_KINDS]; /* cycles that were run so far */
  bool out[VS_BUDGET_KINDS];   /* more of them was wanted than was left */
  bool shows;                  /* it shows on standard error how far it is, once it has lasted for a
                                  second, until vs_budget_end */
  char stage[96];              /* what it does at present, for that line; may be empty */
  double began_s, shown_s;     /* wall clock: 0, not yet */
} vs_budget;

/* Counts cycles that are to be run. Error: VS_BUDGET, there are none left of it, or of the one that
 * it is a part of; they are not to be run then. budget NULL: there is no limit. */
vs_status vs_budget_take(vs_budget *budget, bool has_circuit, long cycles, vs_error *err);

/* Takes the line of progress away. */
void vs_budget_end(vs_budget *budget);

/* Returns a time in s that only ever rises: the wall clock. */
double vs_budget_clock_s(void);
