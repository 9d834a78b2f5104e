/* SPDX-License-Identifier: GPL-3.0-or-later
 * A part in one small circuit, and what of it becomes a figure or a curve: what the benches of all
 * kinds share. */
#pragma once

#include "figures.h"

/* How the part stands in the circuit, and how long it is tried. Node t is where the current that is
 * recorded enters it, behind the source Vm; node 0 is where it leaves. */
typedef struct vs_test_circuit {
  const char *wiring; /* lines, with the part's instance as "Xdut NODES %s"; one %s, its name */
  double until_s, step_s;
} vs_test_circuit;

/* The same part seen in a mirror: all voltages and currents at its nodes m and n have the other
 * sign than those at t and g. */
#define VS_TRYOUT_MIRROR                                                                           \
  "Emt mi 0 t 0 -1\nVmt mi m 0\nFmt t 0 Vmt -1\nRmt m 0 1e9\n"                                     \
  "Emg ni 0 g 0 -1\nVmg ni n 0\nFmg g 0 Vmg -1\nRmg n 0 1e9\n"

/* Runs the circuit whose other lines are given as for printf. */
vs_status vs_test_circuit_run(const vs_stand *stand, vs_test_circuit trial, vs_stand_record *record,
                              vs_error *err, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Runs a part of two pins behind a source: the circuit's lines, from node m to 0. */
vs_status vs_test_circuit_across(const vs_stand *stand, vs_stand_circuit source,
                                 vs_stand_record *record, vs_error *err);

/* The row says why it could not be measured. */
void vs_test_circuit_fail(vs_figure *row, const vs_error *err);

/* Where a figure of a maker's is asked: as a limit of the file, `held` as the maker means it, or as
 * a parameter that the model is made of, within a fraction of it. The limit goes first where the
 * file has both, unless `own_first`. */
typedef struct vs_test_circuit_source {
  const char *limit, *param; /* NULL: there is none */
  vs_held held;
  double tolerance; /* of the parameter */
  double slack;     /* of the limit */
  bool own_first;
} vs_test_circuit_source;

/* Adds a row. NULL: nothing is asked, and `only_asked`. */
vs_figure *vs_test_circuit_row(const vs_stand *stand, vs_figures *figures,
                               const char *const name_unit[2], vs_test_circuit_source source,
                               bool only_asked);

/* A curve of two columns of a record, each in a unit of its own, from one instant to another. */
typedef struct vs_test_circuit_view {
  const char *title, *x_label, *y_label;
  double from_s, to_s;
} vs_test_circuit_view;
void vs_test_circuit_draw(vs_figures *figures, const vs_stand_record *record,
                          vs_test_circuit_view view, const double *column[2], const double unit[2]);

/* The integral of v i over the record, J, within these instants. */
double vs_test_circuit_energy(const vs_stand_record *record, double from_s, double to_s);
