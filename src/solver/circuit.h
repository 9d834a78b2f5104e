/* SPDX-License-Identifier: GPL-3.0-or-later
 * The seam behind which a circuit is solved: ngspice in the product, a formula in tests.
 * The circuit owns its time loop and asks its host for what it needs. */
#ifndef VS_SOLVER_CIRCUIT_H
#define VS_SOLVER_CIRCUIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/error.h"

typedef struct vs_circuit_job {
  char *const *netlist; /* lines without analysis, options and .end */
  size_t lines;
  const char *const *ports; /* external sources as the circuit calls them, lower case: "vgate";
                               voltages, or currents */
  size_t n_ports;
  const char *const
      *signals; /* what accept() is given: "v(a)", "i(vth)", lower case; "v(0)" is 0 */
  size_t n_signals;
  size_t n_wanted;            /* of these, the last ones: one that is not there is NaN, no error */
  double until_s, max_step_s; /* the run goes from 0 to until_s in steps of at most max_step_s */
  bool gear;                  /* Gear's rule of second order, not the trapezoidal */
  const char *dialect;        /* how the netlist is to be read: "ps", or "" for ngspice's own */
  /* of Newton's iteration and of the local truncation error: a part of each value; and below which
   * a difference of currents is none */
  double relative_tolerance, current_tolerance_a;
  double voltage_tolerance_v; /* as of currents; 0: ngspice's own 1e-6 */
  double charge_tolerance_c;  /* below it a capacitor's charge is none; 0: ngspice's own 1e-14 */
  /* Least part of a column's largest entry that a pivot may be (ngspice's pivrel); 0: its own 1e-3.
   * It decides the order of elimination, and so how rounding errors add up. */
  double pivot_threshold;
  double truncation_factor; /* by which that error may be more (ngspice's trtol); 0: its own 7 */
  /* Gives an error that quotes the netlist the place where that stands; may be NULL. */
  void (*locate)(const void *author, vs_error *err);
  const void *author; /* of the netlist */
  bool tried; /* another with the same netlist but for its parameters' values was run in this
                 process before: no trial in a child */
  FILE *raw;  /* gets all the circuit's vectors at every accepted step as a rawfile, its head filled
                 in also when the run fails (solver/rawfile.h); NULL: none */
} vs_circuit_job;

typedef struct vs_circuit_host {
  void *ctx;
  /* Voltage or current of a port at a candidate time, V or A. Asked several times per step; time
   * may go back after a step that was rejected, but never before the last accepted one. */
  double (*source)(void *ctx, size_t port, double t_s);
  /* First instant after t_s that must be the end of a step; INFINITY: none. Asked after each
   * accepted step. */
  double (*edge)(void *ctx, double t_s);
  /* Longest step wanted from t_s on; the job's max_step_s holds besides. */
  double (*longest)(void *ctx, double t_s);
  /* A step was accepted. A status other than VS_OK ends the run, which then returns it. */
  vs_status (*accept)(void *ctx, double t_s, const double *signals, vs_error *err);
  /* Asked after each accepted step: true ends the run there, with VS_OK. NULL: no. */
  bool (*enough)(void *ctx);
} vs_circuit_host;

typedef struct vs_circuit_kind {
  const char *name;
  /* Job and host must last as long as the circuit. ngspice takes the circuit up to its first
   * accepted step here, in a child process that may die of it: the host is asked there, by a copy
   * of its own, and accept() is not called. Errors: VS_INPUT, the circuit cannot be loaded or kills
   * the solver; VS_SIGNAL, a signal that is handled came meanwhile. */
  vs_status (*load)(const vs_circuit_job *job, const vs_circuit_host *host, void **circuit,
                    vs_error *err);
  /* Errors: accept()'s own; VS_INPUT, the circuit cannot be run; VS_RUN with gave_up, the solver
   * gave up or makes no progress. They name the time. */
  vs_status (*run)(void *circuit, vs_error *err);
  void (*free)(void *circuit); /* NULL is fine */
} vs_circuit_kind;

extern const vs_circuit_kind vs_ng_kind; /* one circuit at a time in a process */
const char *vs_ng_version(void);
/* Can this process still use it? Some nonsense makes ngspice end itself. */
bool vs_ng_usable(void);

#endif
