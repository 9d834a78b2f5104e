/* SPDX-License-Identifier: GPL-3.0-or-later
 * A netlist as equations M y' = f(t, y) in modified nodal form. The unknowns y are the voltages of
 * the nodes, V, the currents through voltage sources and inductors, A, the charges of diodes, C,
 * and the machine's states, SI. A row of a node is the sum of the currents that leave it; M has the
 * capacitances there, F, and in an inductor's row its inductance, H. */
#pragma once

#include "base/names.h"
#include "course.h"
#include "junction.h"
#include "matrix.h"
#include "ngspice/circuit.h"
#include "program.h"

enum { VS_MACHINE_STATES = 64 }; /* at most */

/* A constant of M, or of df/dy. */
typedef struct vs_entry {
  int row, column, place; /* place: in the matrix' values */
  double value;
} vs_entry;

/* factor x a source that changes over time, of f's row. */
typedef struct vs_compiled_source {
  int row, port; /* port: of the job; -1: it is a course */
  double factor;
  int course; /* which course of the equations'; -1: none */
} vs_compiled_source;

enum { VS_DEVICE_PROGRAM, VS_DEVICE_DIODE, VS_DEVICE_BIPOLAR, VS_DEVICE_SWITCH, VS_DEVICE_VDMOS };

/* An element whose current is no linear function of y. */
typedef struct vs_compiled_device {
  int kind;
  int pin[3];    /* nodes: plus and minus; anode and cathode; collector, base, emitter; drain, gate,
                    source. -1: ground */
  int row[3];    /* of these nodes */
  int branch;    /* of a B source that is a voltage: its row; else -1 */
  int charge[2]; /* the row of a diode's charge, if it has a transit time; of those of a MOSFET
                    between gate and drain, and of its body diode; else -1 */
  int control[2]; /* of a switch: its controlling nodes, or an unknown current and -1 */
  double factor;  /* of a B source: m */
  vs_compiled_program program;
  vs_diode diode;
  vs_bipolar bipolar;
  vs_vdmos vdmos;
  double on_s, off_s, threshold, hysteresis; /* of a switch: conductances, S, and its limits */
  bool on, asks;                             /* asks: as vs_equations_choose found it last */
  double before[2];                          /* a junction's voltages in the last iteration, V */
  double peak_a[2]; /* the largest of its currents so far, and the last one that was looked at */
  double last_a[2];
} vs_compiled_device;

typedef struct vs_equations {
  int n;           /* unknowns */
  int rows;        /* equations, for as many of the unknowns, the first ones */
  int follow;      /* the first of those that are constant, behind the others; as `rest` has them */
  vs_entry *share; /* the others are what `rest` says and these shares of the first ones: row: the
                      unknown; in its order. Owned */
  int *first;      /* of each of them: the number of its first share; and one more. Owned */
  double *rest;    /* owned */
  char **name;     /* of each, as ngspice names signals: "v(a)", "i(v.x1.vs)"; owned */
  vs_names number; /* of these names */
  vs_matrix matrix;
  vs_entry *mass, *linear; /* owned */
  int masses, linears;
  double *constant; /* df/dy of what is linear, by place; owned */
  double *level;    /* f of the sources that are constant; owned */
  vs_compiled_source *source;
  int sources;
  vs_course *course; /* owned */
  int courses;
  vs_compiled_device *device;
  int devices;
  const vs_circuit_host *host; /* borrowed: its machine is a part of the equations */
  int machine, states, flux;   /* the machine's first unknown, how many it has, and the unknown that
                                  is its flux linkage */
  const void *law;             /* of the machine, whose slopes by x are known; NULL: none are */
  double *of_law;              /* df/dy of what is linear, and of these, by place; owned */
  double *charge;              /* M y at t = 0, of what the netlist says with ic=; owned */
} vs_equations;

/* Ends what vs_elements_make began. */
void vs_equations_free(vs_equations *e);

/* Makes the matrix' pattern, and what is constant in it, from entries and devices. */
void vs_equations_make_pattern(vs_equations *e);

/* The unknowns from `rows` to `follow`, from those before: of states, or, with `change`, of
 * differences between two. */
void vs_equations_follow(const vs_equations *e, double *y, bool change);

/* Which unknown a signal's name is; -1: "v(0)"; -2: there is none. */
int vs_equations_signal(const vs_equations *e, const char *name);

/* f at y. source[k]: what source k is, V or A. jacobian, if it is not NULL: df/dy by place. With
 * `limits` the junctions are taken no further from the iteration before than their exponentials
 * allow, and as straight lines from there; returns true where one was. */
bool vs_equations_value(vs_equations *e, const double *y, const double *source, bool limits,
                        double *f, double *jacobian);

/* By how much the currents at a junction do not add up to zero behind a step, as a part of the
 * junction's peak current; the most of all junctions, of which diodes count by a third. `change`
 * is that of the step's last stage, up to `next`, which takes the junctions for straight lines with
 * their slopes at y. */
double vs_equations_imbalance(vs_equations *e, const double *y, const double *next,
                              const double *change);
/* Takes the currents of the junctions at y for their peaks; NULL: those at `next`, as they were
 * looked at last. */
void vs_equations_note_peaks(vs_equations *e, const double *y);

/* r = M v; r += M v. */
void vs_equations_mass(const vs_equations *e, const double *v, double *r);
void vs_equations_add_mass(const vs_equations *e, const double *v, double *r);

/* Takes the branches and the switches' states that y asks for. Returns true where one is another
 * one than before; with `only_ask` none changes. */
bool vs_equations_choose(vs_equations *e, const double *y, bool only_ask);
/* Does y ask for another branch or state of one of those devices that asked for one the last time?
 */
bool vs_equations_still_asks(vs_equations *e, const double *y);
/* Does y ask for another branch or state of one of the devices? */
bool vs_equations_asks(vs_equations *e, int device, const double *y);
/* Makes its branches those of y, or its switch the other way round. */
void vs_equations_turn(vs_equations *e, int device, const double *y);
