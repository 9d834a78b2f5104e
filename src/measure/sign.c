/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/sign.h"

#include <math.h>
#include <stdio.h>

/* The wrong way must be this many times the right one: what a capacitance inside gives back is
 * about what it took before. */
static const double TIMES = 3;
/* Below this share of the run's energy a device's own says nothing: a capacitance inside that was
 * charged as the run began gives what it had. */
static const double LEAST_SHARE = 1e-4;
/* No diode and no thyristor drops as much while it conducts, V. What leaks backwards does so at
 * more. */
static const double ON_V = 10;

bool vs_sign_is_wrong(const vs_watched *w, double whole_j, char *text, size_t size) {
  const vs_kind *kind = w->device->kind;
  double net_j = w->sum[VS_OF_POWER], least_j = LEAST_SHARE * whole_j;
  double taken_j = net_j + w->given_j, forth_c = w->sum[VS_OF_I] + w->back_c;
  const char *name = w->device->name;
  if (kind->stores) return false;
  if (w->given_j > least_j && w->given_j > TIMES * taken_j) {
    snprintf(text, size,
             "device %s gives %.3g J, which no %s does: the sign of its voltage or of its current "
             "is wrong in its line, and so are its measures",
             name, -net_j, kind->name);
    return true;
  }
  bool one_way = kind->switches && !kind->both_ways;
  bool conducts = net_j > least_j && net_j < ON_V * w->back_c;
  if (!one_way || !conducts || !(w->back_c > TIMES * forth_c)) return false;
  snprintf(text, size,
           "device %s conducts backwards, which no %s does: its voltage and its current have the "
           "wrong sign in its line, and so have its measures",
           name, kind->name);
  return true;
}
