/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/engineering.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Units that take a prefix. */
static const char *const PREFIXED[] = {"A", "V", "W",  "J",   "N", "m",  "s",  "F",
                                       "H", "C", "Wb", "ohm", "S", "Hz", "VA", NULL};

/* Of four digits the largest below 1000 is 999.9; from here on a value rounds to 1000. */
static const double ROUNDS_UP = 999.95;

/* An end of a range that is less than this part of the other end is shown as 0: that is two digits
 * less than the larger end is shown with, and a sum's rounding error is far below it. */
static const double ZERO_BESIDE = 1e-6;

/* The power of 1000 that the value is shown in, -5 (f) to 3 (G); 0 where the unit has no prefix. */
static int power_of(double value, const char *unit) {
  bool prefixed = false;
  for (const char *const *p = PREFIXED; *p; p++) prefixed = prefixed || !strcmp(*p, unit);
  if (!prefixed || !isfinite(value) || value == 0) return 0;
  int power = (int)floor(log10(fabs(value)) / 3 + 1e-12);
  if (power >= -5 && fabs(value) / pow(1000, power) >= ROUNDS_UP) power++;
  return power < -5 ? -5 : power > 3 ? 3 : power;
}

static const char *prefix_of_power(int power) {
  static const char *const PREFIXES[] = {"f", "p", "n", "u", "m", "", "k", "M", "G"};
  return PREFIXES[power + 5];
}

const char *vs_engineering_text(double value, const char *unit, char text[VS_ENGINEERING_SIZE]) {
  int power = power_of(value, unit);
  snprintf(text, VS_ENGINEERING_SIZE, "%.4g%s%s%s", value / pow(1000, power), *unit ? " " : "",
           prefix_of_power(power), unit);
  return text;
}

const char *vs_engineering_range(double least, double largest, const char *unit,
                                 char text[2 * VS_ENGINEERING_SIZE]) {
  int power = power_of(fmax(fabs(least), fabs(largest)), unit);
  double scale = pow(1000, power), next_to_nothing = fmax(fabs(least), fabs(largest)) * ZERO_BESIDE;
  if (fabs(least) < next_to_nothing) least = 0;
  if (fabs(largest) < next_to_nothing) largest = 0;
  const char *space = *unit ? " " : "", *prefix = prefix_of_power(power);
  snprintf(text, (size_t)(2 * VS_ENGINEERING_SIZE), "%.4g%s%s%s .. %.4g%s%s%s", least / scale,
           space, prefix, unit, largest / scale, space, prefix, unit);
  return text;
}
