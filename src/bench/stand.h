/* SPDX-License-Identifier: GPL-3.0-or-later
 * A test stand for one part: small circuits around it, each solved by ngspice in a child process,
 * which may die of it. No machine takes part. */
#pragma once

#include <stdbool.h>

#include "netlist/deck.h"

/* A part and the netlist that defines it. Begin with vs_stand_open. */
typedef struct vs_stand {
  vs_deck deck;             /* the stand's deck with the part's file read into it */
  vs_circuit_values values; /* the part's parameters, SI */
  char **netlist;           /* owned */
  size_t lines;
  const char *subcircuit; /* the part's; the deck owns it */
  const char *file;       /* the part's path; the deck owns it */
  const char *name;       /* the path as it was given, for messages; borrowed */
} vs_stand;

/* What is tried. */
typedef struct vs_stand_circuit {
  const char *text;       /* lines of the netlist. The part's instance stands among them */
  double until_s, step_s; /* the run's end, and its longest step */
  double tolerance;       /* relative; 0: 1e-4 */
} vs_stand_circuit;

/* What was seen at every accepted step. */
typedef struct vs_stand_record {
  size_t points;
  double *t_s; /* these four are one block, which t_s owns */
  double *v;   /* V, of node a */
  double *i;   /* A, through the source Vm */
  double *g;   /* V, of node g */
} vs_stand_record;

/* Reads the part of this path. Errors: the part cannot be read, or defines no subcircuit of its
 * file's name, or its parameters contradict each other. vs_stand_close is due also then. */
vs_status vs_stand_open(const char *path, vs_stand *stand, vs_error *err);
void vs_stand_close(vs_stand *stand);

/* Runs the circuit, which has the nodes a and g and the source Vm. The record must be freed, also
 * after an error. Errors: VS_INPUT or VS_RUN, ngspice cannot take the circuit, gives it up, died of
 * it, or took more than 20 s of processor time. Where ngspice gives up, it is tried with other
 * settings, trapezoidal rule and coarser tolerances, before that is an error. */
extern const char *const vs_stand_late; /* what the error says of a run that took that long */
vs_status vs_stand_run(const vs_stand *stand, const vs_stand_circuit *circuit,
                       vs_stand_record *record, vs_error *err);
void vs_stand_free(vs_stand_record *record);

/* The value at t of a column of the record, straight between its steps. NaN: there are no two. */
double vs_stand_at(const vs_stand_record *record, const double *column, double t_s);
/* First instant after from_s at which v crosses level_v; NaN: none. */
double vs_stand_crosses(const vs_stand_record *record, double from_s, double level_v);
