/* SPDX-License-Identifier: GPL-3.0-or-later
 * How large may become what a run makes. A slip of a key, or a stranger's file, asks for hours and
 * gigabytes as easily as for milliseconds; so it is told before anything is written. The limits
 * stand in a scene's section `limits`, where they can be raised. They never change a result. */
#ifndef VS_BOUNDS_LIMITS_H
#define VS_BOUNDS_LIMITS_H

#include "syntax/field.h"

typedef struct vs_limits_values {
  double csv_bytes; /* of one run.csv */
  double devices;   /* of the circuit, each instance of a subcircuit taken apart */
} vs_limits_values;

extern const vs_section vs_limits_section;

#endif
