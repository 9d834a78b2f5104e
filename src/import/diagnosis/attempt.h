/* SPDX-License-Identifier: GPL-3.0-or-later
 * A trial: the beginning of a scene's run with one of the solver's rules, in a process of its own
 * and with a limit on its processor time. It tells how many steps it took, what each channel came
 * to, and what went to and fro. */
#ifndef VS_IMPORT_ATTEMPT_H
#define VS_IMPORT_ATTEMPT_H

#include "run/session.h"

enum { VS_ATTEMPT_WATCHES = 32 };

/* How often a quantity changed its sign from one accepted step to a later one, its value at the
 * last step, and its largest magnitude. */
typedef struct vs_attempt_watch {
  double last, largest;
  long crossings;
  long close; /* of these, how many came within four steps after the one before */
  double first_close_s, last_close_s; /* instants of these; NaN: there are none */
  double last_s;                      /* of the last crossing; NaN: there is none */
} vs_attempt_watch;

/* A channel that goes up in one step and down in the next, by about as much: how many steps in
 * turn at the most, when that ended, and by how much. */
typedef struct vs_attempt_ring {
  long steps;
  double end_s, swing;
} vs_attempt_ring;

/* What is tried. */
typedef struct vs_attempt_plan {
  vs_scene *scene; /* borrowed, and left as it is */
  bool gear;       /* the solver's rule; false: the trapezoidal */
  double until_s;
  double limit_s;            /* of processor time; the trial ends there, and is whole up to there */
  const vs_formula *watched; /* over the deck's terms; may be NULL */
  size_t n_watched;          /* at most VS_ATTEMPT_WATCHES */
} vs_attempt_plan;

/* What comes of it. Numbers are in the order of channels (engine/channel.h), SI. */
typedef struct vs_attempt {
  vs_status status;  /* VS_OK: it went on to its end or its limit */
  bool cut;          /* by the limit */
  char why[256];     /* how it failed; empty: it did not */
  long steps, tries; /* accepted steps; steps that were tried, rejected ones too */
  double processor_s, reached_s;
  double shortest_s; /* the shortest accepted step */
  double least[VS_CH_MOST], largest[VS_CH_MOST];
  vs_attempt_ring ring[VS_CH_MOST];
  vs_attempt_watch watch[VS_ATTEMPT_WATCHES];
} vs_attempt;

/* Error, VS_RUN: there is no process to be had. A process that dies of the trial is told in
 * trial->why. */
vs_status vs_attempt_run(const vs_attempt_plan *plan, vs_attempt *trial, vs_error *err);

#endif
