/* SPDX-License-Identifier: GPL-3.0-or-later
 * Numbers with units: the first line is the unit that is wanted, what follows is the number. */
#include "base/units.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "targets.h"

static void take_pair(const char *unit, const char *text) {
  char why[200] = "", suffix[32];
  int power[VS_UNIT_POWERS];
  double si = 0;
  bool known = vs_units_known(unit);
  FUZZ_HOLDS(known == vs_units_powers(unit, power));
  vs_units_suffix(unit, suffix, sizeof suffix);
  FUZZ_HOLDS(strlen(suffix) < sizeof suffix);
  if (!known) return;
  FUZZ_HOLDS(vs_units_factor(unit) > 0);
  FUZZ_HOLDS(vs_units_same_kind(unit, unit));
  FUZZ_HOLDS(vs_units_same_kind(unit, text) == vs_units_same_kind(text, unit));
  vs_units_suffix_factor(text, unit);
  if (vs_units_read(text, unit, &si, why, sizeof why))
    FUZZ_HOLDS(!isnan(si));
  else
    FUZZ_HOLDS(*why && strlen(why) < sizeof why);
}

static void take(const char *text, size_t size) {
  const char *line = memchr(text, '\n', size);
  char *unit = line ? strndup(text, (size_t)(line - text)) : NULL;
  take_pair(unit ? unit : "", line ? line + 1 : text);
  free(unit);
}

const fuzz_target fuzz_units = {"units", take, NULL, NULL};
