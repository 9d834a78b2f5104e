/* SPDX-License-Identifier: GPL-3.0-or-later
 * Studies of machines at work. A study with the key
 *
 *   steady: {period: N}          N firing periods, 1 where it is left out; `true` is the same as {}
 *
 * runs in each case what `vibrospice steady` runs: one period of the orbit. Its cases have the
 * measures of the orbit (orbit/steady.h) as columns, too, and some that stand for lists there. */
#pragma once

#include "base/field.h"
#include "orbit/steady.h"
#include "run/listed_measure.h"

/* The column that tells whether the orbit is stable, 1, or not, 0. */
#define VS_ORBIT_COLUMNS_STABLE "stable"

/* Reads the key from the map that may have it: *periods is 0 where there are no orbits. Errors: it
 * is neither true, false nor a map; it has another key; period is not a whole number above 0. */
extern const vs_inside vs_orbit_columns_keys; /* where it is a map */
vs_status vs_orbit_columns_read(const vs_node *holder, int *periods, vs_error *err);

/* What a case's columns are taken from. */
typedef struct vs_orbit_columns {
  const vs_frame *frame;
  const vs_result *result;
  const vs_steady *steady; /* NULL: the case is a run. Of an orbit that is not found yet only its
                              model is read, and no value is known */
} vs_orbit_columns;

/* As vs_listed_measure_at; behind a run's measures come those of the orbit, and the harmonics of
 * currents whose quality the scene asks for. */
bool vs_orbit_columns_at(const vs_orbit_columns *of, int k, vs_listed_measure *shown);

/* The k-th measure that an orbit's case reports unasked, besides those of every run; false: there
 * are no more. They are all of the orbit's but the harmonics. */
bool vs_orbit_columns_default(const vs_steady *steady, int k, vs_listed_measure *shown);
