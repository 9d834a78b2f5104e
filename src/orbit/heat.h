/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the devices of a circuit turn into heat on an orbit, and how warm that makes a junction:
 * its mean rise over the case, and how warm the case may be. The largest rise over the period is a
 * measure of the device (netlist/kinds.c: t_j_rise). */
#pragma once

#include "measure/devices.h"

typedef struct vs_heat {
  char name[VS_DECK_NAME + 24]; /* "thyristor.power" */
  const char *unit, *text;      /* of the program's */
  vs_value value;               /* in unit */
} vs_heat;

/* Fills `heat` with the k-th measure, from 0, and returns true; false: there are no more. devices:
 * of a run of whole periods, whose length is span_s; not finished yet: the values mean nothing.
 * NULL: there are no devices. */
bool vs_heat_at(const vs_devices *devices, double span_s, int k, vs_heat *heat);
