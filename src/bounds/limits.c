/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "bounds/limits.h"

#include <stddef.h>

#define L_(member) offsetof(vs_limits_values, member)

static const vs_field LIMITS[] = {
    {"csv", VS_REAL, "", "1e9", 1e3, 1e15, false, L_(csv_bytes),
     "bytes that run.csv may have; a run that would write more is refused before it begins", NULL,
     NULL},
    {"devices", VS_REAL, "", "1e5", 1, 1e9, false, L_(devices),
     "elements that the circuit may have, those of each instance of a subcircuit counted", NULL,
     NULL},
};
const vs_section vs_limits_section = {"limits", LIMITS, sizeof LIMITS / sizeof *LIMITS};
