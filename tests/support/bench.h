/* SPDX-License-Identifier: GPL-3.0-or-later
 * A bench for parts: a small deck, read by the netlist contract, solved by ngspice alone. No
 * machine, no tier: the EVA that every deck must have stands aside with nothing connected. */
#pragma once

#include "netlist/deck.h"
#include "ngspice/circuit.h"

enum { BENCH_SIGNALS = 4 };

/* A parameter of the deck or its parts, in SI units. */
typedef struct bench_value {
  const char *key; /* NULL ends a list */
  double value;
} bench_value;

typedef struct bench {
  const char *deck;       /* its lines; no EVA, no external sources */
  const bench_value *set; /* values that are not the files'; may be NULL */
  const char *signals[BENCH_SIGNALS];
  double until_s, max_step_s, relative_tolerance;
  double current_tolerance_a; /* 0: 1e-12 */
  bool gear;
  /* Shown every accepted step; may be NULL. */
  void (*see)(void *ctx, double t_s, const double *signals);
  void *ctx;
  double last[BENCH_SIGNALS]; /* filled in: the signals at the end */
  long steps;                 /* filled in: how many were accepted */
} bench;

vs_status bench_run(bench *b, vs_error *err);
/* The same, which must go well; what: the part, for the message. */
void bench_good(bench *b, const char *what, int line);

/* The value of a parameter, as the run would have it; fails the test when there is none. */
double bench_value_of(const bench *b, const char *key);
