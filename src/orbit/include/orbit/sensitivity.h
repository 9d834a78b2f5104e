/* SPDX-License-Identifier: GPL-3.0-or-later
 * Logarithmic derivatives of a scene's measures with respect to its keys, each with its error. On
 * the ideal tiers they are exact (orbit/tangent.h); elsewhere, and where a measure is not smooth
 * enough for that, they are Richardson's differences of runs (orbit/stencil.h). */
#pragma once

#include <signal.h>

#include "orbit/stencil.h"

/* What is asked for. */
typedef struct vs_sensitivity_order {
  const vs_asked *of, *to; /* measures and keys */
  size_t n_of, n_to;       /* 1 or more */
  int periods;             /* of the orbit, a period of which is measured; 0: the scene's run is */
  const volatile sig_atomic_t *stop; /* set by a signal: it ends; NULL: none */
  long most_cycles; /* of the mains that its runs may take; 0: some more than so many keys want;
                       for tests */
} vs_sensitivity_order;

/* One derivative. Where neither the measure nor the key is 0 it is d ln|measure|/d ln key. */
typedef struct vs_sensitivity_entry {
  double value; /* NaN: it is not known, and `note` of the table says why */
  double error; /* what it may be off by */
  bool exact;   /* false: by differences of runs */
} vs_sensitivity_entry;

typedef struct vs_sensitivity_name {
  char name[VS_KEY_SIZE], unit[24];
  double value; /* in that unit */
} vs_sensitivity_name;

/* Free with vs_sensitivity_free also after an error. */
typedef struct vs_sensitivity {
  size_t n_of, n_to;
  vs_sensitivity_name *of, *to; /* owned. Where the value of a measure is 0, its derivatives are
                                   those of the measure itself, in its unit; where a key's is 0,
                                   they are per unit of the key */
  vs_sensitivity_entry *entry;  /* [n_of][n_to]; owned */
  size_t told;                  /* the keys up to here are done: all but after an error */
  vs_text notes; /* what is to be said of them: lines, each with a line break behind it; owned */
} vs_sensitivity;

/* Finds them. Errors. VS_INPUT, at the place of the name: no such measure or key, the nearest is
 * named; a key that has no derivative; a measure that this run does not have; what refuses an
 * orbit. VS_RUN: those of the run. VS_BUDGET: its budget is spent; the derivatives to the keys that
 * are told stand, the others are NaN. VS_SIGNAL. */
vs_status vs_sensitivity_find(const vs_scene *scene, const vs_sensitivity_order *order,
                              vs_sensitivity *out, vs_error *err);
void vs_sensitivity_free(vs_sensitivity *sensitivity);

/* Error, at the name's place: it is none of a scene's measures (periods: 0) or of a period's; no
 * run is made. */
vs_status vs_sensitivity_check(const vs_scene *scene, const vs_sensitivity_order *order,
                               vs_error *err);

static inline vs_sensitivity_entry *vs_sensitivity_at(const vs_sensitivity *s, size_t of,
                                                      size_t to) {
  return &s->entry[of * s->n_to + to];
}
