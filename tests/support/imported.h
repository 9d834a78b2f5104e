/* SPDX-License-Identifier: GPL-3.0-or-later
 * The netlists of tests/cases/import/ORIGIN, each brought in by `vibrospice import` and held
 * against plain ngspice. The folder has these files besides the netlists:
 *
 *   decks.txt       one line per netlist, in fields parted by '|':
 *                     netlist | options of import | settings of run | options of ngspice |
 *                     end of the reference, as .tran takes it, and its reltol and largest step if
 *                     not 1e-5 and 0.5 us |
 *                     PROBE=EXPRESSION ...
 *                   An expression is of ngspice and the netlist's own names, without blanks. The
 *                   probe i_peak stands for the coil's current, whose peak either way counts.
 *                   Behind another '|' may stand columns of the export that are known to be missed.
 *                   A netlist with `-` for an end has no reference: ngspice does not read it.
 *                   Lines that begin with '#' are comments.
 *   NETLIST.sed     where ngspice does not read the netlist as it is: the edits that make it do so
 *   references.csv  netlist,probe,min,max,error: what tools/import_references wrote; error is the
 *                   change by halving the step, relative to the peak
 */
#pragma once

/* Each netlist is imported, its deck passes `check`, and runs with the gap held, which is a coil of
 * constant inductance: extremes of the probes that decks.txt names are those of plain ngspice on
 * the netlist itself, within 1e-3 of each probe's peak. Prints the worst of each. All of them run
 * with VS_LONG, else every second one, from that of the number `first` on, 0 or 1: the origins have
 * much the same circuits in the same order. */
void imported_held(const char *origin, int first);

/* Each deck with a machine that moves: the extremes of each column are those of plain ngspice on
 * the exported netlist, within 1e-3 of its peak, where ngspice itself is certain of them. Writes
 * ORIGIN's rows of tests/long/imports.csv to imports_ORIGIN.csv in the folder that VS_ROWS names.
 * Does nothing unless VS_LONG is set and ngspice is on the PATH. */
void imported_exported(const char *origin);
