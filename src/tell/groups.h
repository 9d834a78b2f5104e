/* SPDX-License-Identifier: GPL-3.0-or-later
 * The measures of a run in groups: what the scene asks for, motion, electrical, devices, energy. */
#ifndef VS_TELL_GROUPS_H
#define VS_TELL_GROUPS_H

#include <stdio.h>

#include "scene/result.h"

typedef struct vs_groups_options {
  bool all;      /* also what is zero, unknown, or stands under another name already */
  bool measured; /* the scene's `measured` is shown: nothing was set that it does not speak of */
} vs_groups_options;

/* Prints the groups. Asked for is what `measured` names, and, where `record` is a list, each
 * measure whose name begins with that of a recorded channel. The last line tells how many measures
 * are left out. */
void vs_groups_print(const vs_result *result, const vs_groups_options *options, FILE *out);

#endif
