/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/limits.h"

#include <stddef.h>
#include <stdio.h>

/* A limit: its key, default, least and largest value, member, and what it limits. */
#define LIMIT_(key, default_text, least, most, member, text)                                       \
  {                                                                                                \
    key, VS_REAL, "", default_text, least, most, false, offsetof(vs_limits_values, member), text,  \
        NULL, NULL                                                                                 \
  }

static const vs_field LIMITS[] = {
    LIMIT_("csv", "1e9", 1e3, 1e15, csv_bytes,
           "bytes that run.csv may have; a run that would write more is refused before it begins; "
           "peaks.csv is left out where it would have more"),
    LIMIT_("raw", "1e9", 1e3, 1e15, raw_bytes,
           "bytes that run.raw may have; a run whose longest steps alone would write more is "
           "refused before it begins, another one ends there"),
    LIMIT_("kept", "1e10", 1e3, 1e18, kept_bytes,
           "bytes that all run.csv may have which study --keep runs writes; a study that would "
           "write more is refused before it begins; a case's peaks.csv is left out where it would "
           "have more than the case's part of the rest"),
    LIMIT_("devices", "1e5", 1, 1e9, devices,
           "elements that the circuit may have, those of each instance of a subcircuit counted"),
};
const vs_section vs_limits_section = {"limits", LIMITS, sizeof LIMITS / sizeof *LIMITS};

void vs_limits_write(double bytes, char text[VS_LIMITS_SIZE]) {
  static const char *const UNITS[] = {"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
  size_t unit = 0;
  /* 999.6 to three digits is 1000, which the next unit has */
  for (; bytes >= 999.5 && unit + 1 < sizeof UNITS / sizeof *UNITS; unit++) bytes /= 1000;
  snprintf(text, VS_LIMITS_SIZE, "%.*g %s", unit && bytes < 99.5 ? 2 : 3, bytes, UNITS[unit]);
}
