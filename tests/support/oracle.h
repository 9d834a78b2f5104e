/* SPDX-License-Identifier: GPL-3.0-or-later
 * An independent solution of a scene: the whole system in one set of differential equations, by
 * GSL's rk8pd in steps whose error is near rounding, thyristor and stop switched at instants found
 * to rounding. Nothing of the program is used but the numbers of its scene: mechanics, actuator and
 * circuit are written down a second time here. */
#pragma once

#include <stddef.h>

#include "conveyor.h"
#include "engine/sim.h"

enum {
  ORACLE_P,
  ORACLE_U,
  ORACLE_W,
  ORACLE_PHI,
  ORACLE_LAMBDA,
  ORACLE_I,
  ORACLE_FORCE,
  ORACLE_V_AK,
  ORACLE_V_EVA,
  ORACLE_I_THYRISTOR,
  ORACLE_V_C1,
  ORACLE_V_C2,
  ORACLE_I_SOURCE,
  ORACLE_COLUMNS /* SI, as tests/reference has them */
};

typedef enum oracle_kind {
  ORACLE_ANALYTIC, /* L(0) di/dt = u - R i, F = k_i i^2 */
  ORACLE_SWITCHED, /* dlambda/dt = u - R i while conducting, F = lambda^2/(4a) */
  ORACLE_BARE,     /* source R L, thyristor, EVA in series (halfwave_bare) */
  ORACLE_SNUBBED   /* the circuit of T3A (halfwave_snubbed) */
} oracle_kind;

/* A thyristor of two slopes and a threshold, snubbers, varistors of a power law without
 * capacitance. */
typedef struct oracle_circuit {
  double r1_ohm, c1_f, r2_ohm, c2_f, varistor_v, varistor_exponent;
  double on_v, on_ohm, off_ohm;
  bool leaks_on; /* off_ohm stays across the thyristor that conducts, as in the part `latch` */
} oracle_circuit;

typedef struct oracle_scene {
  oracle_kind kind;
  conveyor_values machine;
  vs_actuator_values actuator;
  vs_load_values load;
  vs_supply_values supply;
  vs_firing_values firing;
  vs_start_values start;
  oracle_circuit circuit;
  double sample_s;
  size_t rows;      /* at 0, sample_s, 2 sample_s ... */
  double tolerance; /* of one step, in parts of typical values; 0: 1e-13 */
} oracle_scene;

enum { ORACLE_EVENTS = 64 };
typedef struct oracle_events {
  double fires_s[ORACLE_EVENTS], extinct_s[ORACLE_EVENTS], meets_s[ORACLE_EVENTS];
  size_t fired, ended, met; /* may be more than are kept */
  long steps;
} oracle_events;

/* The scene of a set-up, which has the deck halfwave_bare or halfwave_snubbed where the kind is of
 * a circuit. */
oracle_scene oracle_of(const vs_setup *setup, oracle_kind kind);

/* Fills rows x ORACLE_COLUMNS; events may be NULL. false: the gap closed, or GSL gave up. */
bool oracle_run(const oracle_scene *scene, double *table, oracle_events *events);
