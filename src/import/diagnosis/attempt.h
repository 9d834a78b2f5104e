/* SPDX-License-Identifier: GPL-3.0-or-later
 * A trial runs the beginning of a scene with one of the solver's two rules, in a process of its own
 * and with a limit on its processor time. It tells how many steps the run took, the extremes of
 * each channel, and what oscillated from step to step. */
#pragma once

#include "run/session.h"

enum { VS_ATTEMPT_WATCHES = 32 };

/* A watched quantity: how often it changed its sign from one accepted step to a later one, its
 * value at the last step, and its largest magnitude. */
typedef struct vs_attempt_watch {
  double last, largest;
  long crossings;
  long close; /* how many of these came within four steps after the last one */
  double first_close_s, last_close_s; /* instants of these; NaN: there are none */
  double last_s;                      /* of the last crossing; NaN: there is none */
} vs_attempt_watch;

/* The longest sequence of steps in which a channel went up and down in turn, by about the same
 * amount: how many steps, when it ended, and by how much. */
typedef struct vs_attempt_ring {
  long steps;
  double end_s, swing;
} vs_attempt_ring;

/* What is tried. */
typedef struct vs_attempt_plan {
  vs_scene *scene; /* borrowed, and left as it is */
  bool gear;       /* the solver's rule; false: the trapezoidal */
  double until_s;
  double limit_s; /* of processor time. The trial ends there, and its results hold up to there */
  const vs_formula *watched; /* over the deck's terms; may be NULL */
  size_t n_watched;          /* at most VS_ATTEMPT_WATCHES */
} vs_attempt_plan;

/* The result of a trial. Arrays are in the order of channels (engine/channel.h), in SI units. */
typedef struct vs_attempt {
  vs_status status;  /* VS_OK: it ran to its end or its limit */
  bool cut;          /* the limit of processor time ended it */
  char why[256];     /* how it failed; empty: it did not */
  long steps, tries; /* accepted steps; steps that were tried, rejected ones too */
  double processor_s, reached_s;
  double shortest_s; /* the shortest accepted step */
  double least[VS_CH_MOST], largest[VS_CH_MOST];
  vs_attempt_ring ring[VS_CH_MOST];
  vs_attempt_watch watch[VS_ATTEMPT_WATCHES];
} vs_attempt;

/* Error, VS_RUN: no process could be started. If the trial's process dies, trial->why tells. */
vs_status vs_attempt_run(const vs_attempt_plan *plan, vs_attempt *trial, vs_error *err);
