/* SPDX-License-Identifier: GPL-3.0-or-later
 * The interface to a circuit solver: ngspice in the product (ngspice/ngspice.h), a formula in
 * tests. The circuit owns its time loop and asks its host for what it needs. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/error.h"

/* A step of a run, or a restart behind a jump. */
typedef struct vs_circuit_step {
  double length_s; /* as it was tried; 0: none was short enough */
  double left_s;   /* from its beginning to the next edge; NaN: it is a restart */
  int parts;       /* in which it was shown */
  bool jumps;      /* a branch or a switch is another one behind it */
  bool cut;        /* the step ends there; of a restart: branches were chosen in its iteration */
} vs_circuit_step;

/* All steps of a run, for runs of scenes that are nearly the same: these take the same ones, so
 * that what differs between the runs is smooth. Begin with {0}; the caller frees `step`. */
typedef struct vs_circuit_steps {
  vs_circuit_step *step;
  size_t count, room, next;
  enum {
    VS_STEPS_OWN,
    VS_STEPS_NOTED,
    VS_STEPS_TAKEN
  } are; /* the run has steps of its own; and
           these become them; it takes these */
} vs_circuit_steps;

/* What is to be solved. All is borrowed. */
typedef struct vs_circuit_job {
  char *const *netlist; /* lines without analysis, options and .end */
  size_t lines;
  const char *const *ports; /* the external sources, voltages or currents, by the names that the
                               circuit calls them by, in lower case: "vgate" */
  size_t n_ports;
  const char *const *signals; /* what accept() is given, in lower case: "v(a)", "i(vth)"; "v(0)" is
                                 0 */
  size_t n_signals;
  size_t n_wanted;  /* how many of these, the last ones, may be missing: one that is not
                       there is NaN. Others are an error then. With ngspice one of these may be a
                       quantity of an element, "@c.x1.c2[i]" */
  double tolerance; /* run.tolerance: for a solver that measures the errors of its own steps */
  double until_s, max_step_s; /* the run goes from 0 to until_s in steps of at most max_step_s */
  bool stands; /* it begins at the operating point that the sources have at t = 0, whatever the
                  netlist says with ic=, and not from that */
  bool gear;   /* Gear's rule of second order in the place of the trapezoidal */
  const char *dialect; /* how the netlist is to be read: "ps", or "" for ngspice's own */
  /* Newton's iteration and the local truncation error are held to these: a fraction of each value,
   * and a difference that counts as none. */
  double relative_tolerance, current_tolerance_a;
  double voltage_tolerance_v; /* as of currents; 0: ngspice's own 1e-6 */
  double charge_tolerance_c;  /* a capacitor's charge below it is none; 0: ngspice's own 1e-14 */
  /* The least fraction of a column's largest entry that a pivot may be (ngspice's pivrel); 0: its
   * own 1e-3. It decides the order of elimination, and so how rounding errors add up. */
  double pivot_threshold;
  double truncation_factor; /* how many times its tolerance the truncation error may be (ngspice's
                               trtol); 0: its own 7 */
  /* Gives an error that quotes the netlist its place; may be NULL. `culprit` is the index of the
   * line that was found to cause the error; 0: none was found. */
  void (*locate)(const void *author, size_t culprit, vs_error *err);
  const void *author; /* of the netlist */
  bool tried;         /* this process has run a netlist that differs in parameters' values at most:
                         no trial in a child */
  bool unbegun;       /* this process can begin anew without harm: a guard in the place of a trial
                         (ngspice/crash_guard.h) */
  long *tries;        /* counts the steps that are tried, rejected ones too; NULL: nobody asks */
  vs_circuit_steps *steps; /* for a solver that measures the errors of its steps; NULL: none */
  FILE *raw;               /* gets all the circuit's vectors at every accepted step as a rawfile
                              (ngspice/rawfile.h); its head is filled in also when the run fails. NULL: none */
  double raw_most;         /* bytes that it may have; 0: any number */
  vs_where raw_where;      /* the key to blame if it would have more */
} vs_circuit_job;

/* A machine that a circuit's flux linkage drives, for a solver that takes both as one system. */
typedef struct vs_circuit_machine {
  size_t states; /* of x: coordinates, then the rate of each */
  size_t flux;   /* the signal that is the flux linkage, Wb */
  /* Where it is, at the end of the last step that was accepted. */
  void (*state)(void *ctx, double *x);
  /* x' at x and a flux linkage. */
  void (*rates)(void *ctx, const double *x, double flux_wb, double *rate);
  /* Where x' is linear in x, the same as long as this is the same; NULL: it is not, there. */
  const void *(*linear)(void *ctx, const double *x);
  /* What a port is that hangs on x alone, V; false: the port hangs on something else. */
  bool (*port)(void *ctx, size_t port, const double *x, double *value);
} vs_circuit_machine;

enum { VS_STATE_NAME = 64 };

/* The whole state of circuit and machine, as numbers z that do not hang on each other: the
 * machine's come first. A solver that can tell and set it lets its host begin stretches of the run
 * at any z, as a search for an orbit does. */
typedef struct vs_circuit_map {
  int states;                 /* of z; 0: the solver cannot */
  const double *start;        /* z where the stretch under way began */
  double *end;                /* and where it is, as `tell` was told last */
  double *size;               /* about how large each is over a run, > 0 */
  double *slope;              /* d end/d start, row by row, where it is known */
  bool knows_slope;           /* it was wanted, and nothing in the stretch hid it */
  void (*tell)(void *solver); /* sets end, size and slope; to be called from accept() */
  void (*name)(void *solver, int state, char name[VS_STATE_NAME], const char **unit);
  void *solver;
  bool begins; /* set by the host in accept(): another stretch begins there, at `next` */
  double *next;
  bool wants_slope; /* of that stretch; set with it, as is: */
  bool returns;     /* switches are to be as they were where the last one began */
} vs_circuit_map;

/* What the circuit asks. */
typedef struct vs_circuit_host {
  void *ctx;
  /* The voltage or current of a port at a candidate time, V or A. Asked several times per step;
   * time may go back after a step that was rejected, but never before the last accepted one. */
  double (*source)(void *ctx, size_t port, double t_s);
  /* The first instant after t_s that must be the end of a step; INFINITY: none. Asked after each
   * accepted step. */
  double (*edge)(void *ctx, double t_s);
  /* The longest step wanted from t_s on; the job's max_step_s holds besides. */
  double (*longest)(void *ctx, double t_s);
  /* Told of each accepted step. A status other than VS_OK ends the run, which then returns it. */
  vs_status (*accept)(void *ctx, double t_s, const double *signals, vs_error *err);
  /* Told, in their order, of instants within a step that is accepted, between which the signals run
   * nearly straight. False: accept() is to be told of this one, as of a step's end. NULL: so it is
   * of each. */
  bool (*passes)(void *ctx, double t_s, const double *signals);
  /* Asked after each accepted step: true ends the run there, with VS_OK. NULL: never. */
  bool (*enough)(void *ctx);
  /* What the host's own clock shows at t_s; messages and the rawfile have it. NULL: t_s. */
  double (*clock)(void *ctx, double t_s);
  /* Asked after each accepted step: true leaves it out of the rawfile. NULL: none is left out. */
  bool (*hides)(void *ctx);
  /* The machine, for a solver that has it in its equations; source() foretells it for others. */
  vs_circuit_machine machine;
  vs_circuit_map *map; /* gets what a solver that can tell its state has; NULL: nobody asks */
} vs_circuit_host;

/* A way to solve circuits. */
typedef struct vs_circuit_kind {
  const char *name;
  bool measures_errors; /* it knows the errors of its own steps, and has the host's machine in its
                           equations: the host need not shorten steps for a rule of second order */
  /* Loads a circuit. Job and host must last as long as it does. ngspice takes the circuit up to its
   * first accepted step in a child process first, which may die of it: there the host is asked, a
   * copy of it, and accept() is not called. Errors: VS_INPUT, the circuit cannot be loaded or kills
   * the solver; VS_SIGNAL, a signal that is handled came meanwhile. */
  vs_status (*load)(const vs_circuit_job *job, const vs_circuit_host *host, void **circuit,
                    vs_error *err);
  /* Runs it from 0 to until_s. Errors: accept()'s own; VS_INPUT, the circuit cannot be run, with
   * gave_up where one iteration of its first step is complained of; VS_RUN with gave_up, the solver
   * gave up or makes no progress. They name the time. */
  vs_status (*run)(void *circuit, vs_error *err);
  void (*free)(void *circuit); /* NULL is fine */
} vs_circuit_kind;
