/* SPDX-License-Identifier: GPL-3.0-or-later
 * The measures of a run in groups: what the scene asks for, motion, electrical, devices, energy. */
#ifndef VS_RUN_GROUPS_H
#define VS_RUN_GROUPS_H

#include <stdio.h>

#include "run/result.h"

typedef struct vs_groups_options {
  int most;      /* lines that there is room for; INT_MAX: nothing is left out */
  bool measured; /* the scene's `measured` is shown: nothing was set that it does not speak of */
} vs_groups_options;

/* Prints the groups. Asked for is what `measured` names, and, where `record` is a list, each
 * measure whose name begins with that of a recorded channel. Where there is no room for all, what
 * is asked for is followed by the stroke, the currents, the extinction and the energy drawn, and by
 * the motion as far as there is room.
 * Returns how many measures are left out. */
int vs_groups_print(const vs_result *result, const vs_groups_options *options, FILE *out);

#endif
