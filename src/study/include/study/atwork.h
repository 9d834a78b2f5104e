/* SPDX-License-Identifier: GPL-3.0-or-later
 * Studies of machines at work. A study with the key
 *
 *   steady: {period: N}          N firing periods, 1 where it is left out; `true` is the same as {}
 *
 * runs in each case what `vibrospice steady` runs: one period of the orbit. Its cases have the
 * measures of the orbit (orbit/steady.h) as columns, too, and some that stand for lists there. */
#ifndef VS_STUDY_ATWORK_H
#define VS_STUDY_ATWORK_H

#include "run/shown.h"
#include "orbit/steady.h"
#include "base/field.h"

/* The column that tells whether the orbit is stable, 1, or not, 0. */
#define VS_ATWORK_STABLE "stable"

/* Reads the key from the map that may have it: *periods is 0 where there are no orbits. Errors: it
 * is neither true, false nor a map; it has another key; period is not a whole number above 0. */
extern const vs_outline vs_atwork_keys[]; /* where it is a map */
vs_status vs_atwork_read(const vs_node *holder, int *periods, vs_error *err);

/* What a case's columns are taken from. */
typedef struct vs_atwork {
  const vs_frame *frame;
  const vs_result *result;
  const vs_steady *steady; /* NULL: the case is a run. Of an orbit that is not found yet only its
                              model is read, and no value is known */
} vs_atwork;

/* As vs_shown_at; behind a run's measures come those of the orbit, and the harmonics of currents
 * whose quality the scene asks for. */
bool vs_atwork_at(const vs_atwork *of, int k, vs_shown *shown);

/* The k-th measure that an orbit's case reports unasked, besides those of every run; false: there
 * are no more. They are all of the orbit's but the harmonics. */
bool vs_atwork_usual(const vs_steady *steady, int k, vs_shown *shown);

#endif
