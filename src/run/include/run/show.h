/* SPDX-License-Identifier: GPL-3.0-or-later
 * The result of one run as a table for people. */
#pragma once

#include <stdio.h>

#include "run/result.h"

/* What of the measures is shown. They stand in groups. First is what the scene asks for: what its
 * key `measured` names, and, where `record` is a list, each measure whose name begins with that of
 * a recorded channel. Where there is no room for all, that is followed by the stroke, the currents,
 * the extinction and the energy drawn, and by the motion as far as there is room. */
typedef struct vs_show_options {
  int most;      /* lines that there is room for; INT_MAX: nothing is left out */
  bool measured; /* the scene's `measured` is shown: nothing was set that it does not speak of */
} vs_show_options;

/* What another command shows of a run of its own; `show` NULL: nothing. */
typedef struct vs_show_more {
  void (*show)(const void *ctx, FILE *out);
  const void *ctx;
} vs_show_more;

/* Prints the result in at most 25 lines, or 30 with what the command shows: the verdict with what
 * happened, the three weakest lines and the tightest line of each other device; scene and tier;
 * stroke, currents, extinction, energy; what was not judged. What leaves the verdict undecided is
 * always named, which may take more. Limits and stresses are in the unit that the rating's or the
 * limit's line was written in. */
void vs_show_brief(const vs_result *result, const vs_show_options *options,
                   const vs_show_more *more, FILE *out);

/* Prints all of it: the verdict, what the command shows, scene, tier, the measures in groups, the
 * cost. */
void vs_show_all(const vs_result *result, const vs_show_options *options, const vs_show_more *more,
                 FILE *out);

/* Of a current whose groups are told (measure/spectrum.h), prints the windows that they are over.
 */
void vs_show_windows(const vs_spectrum *current, FILE *out);
/* Prints for each class of apparatus which harmonic takes most of its limit, and how much. */
void vs_show_classes(const vs_drawn_current *drawn, FILE *out);

/* The line of a table's head that names the machine and what feeds it: "machine conveyor, supply
 * 440 V rms, 50 Hz". */
void vs_show_machine_and_supply(const vs_setup *setup, FILE *out);
