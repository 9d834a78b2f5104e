/* SPDX-License-Identifier: GPL-3.0-or-later
 * How large may become what a run makes. A slip of a key, or a stranger's file, asks for hours and
 * gigabytes as easily as for milliseconds; so it is told before anything is written. The limits
 * stand in a scene's section `limits`, where they can be raised. They never change a result. */
#pragma once

#include "base/field.h"
#include "netlist/deck.h"

typedef struct vs_limits_values {
  double csv_bytes;  /* of one run.csv */
  double raw_bytes;  /* of one run.raw */
  double kept_bytes; /* of all run.csv that a study keeps */
  double devices;    /* of the circuit, each instance of a subcircuit taken apart */
} vs_limits_values;

extern const vs_section vs_limits_section;

/* Writes a number of bytes to two or three digits in the unit that fits, as "5.3 GB" or "800
 * bytes". */
enum { VS_LIMITS_SIZE = 24 };
void vs_limits_write(double bytes, char text[VS_LIMITS_SIZE]);

/* Error, with the place of the line that comes to most: the deck comes to more than `most` elements
 * and models when the solver takes its subcircuits apart, with its parts in their places. Ten
 * lines, each ten instances of the one before, are as many as ten thousand million, for which the
 * solver would take all of the machine's memory; here they are counted without being made. Each
 * segment of a line U counts as two devices, a subcircuit that is not defined or has itself within
 * as one. */
vs_status vs_limits_devices(const vs_deck *deck, double most, vs_error *err);
