/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/regulator.h"

#include <math.h>

vs_lowpass vs_regulator_lowpass(const vs_sight *s) {
  if (s->sensor >= s->instruments->count) return vs_lowpass_make(NAN, 1, 1);
  const vs_instrument_values *v = &s->instruments->item[s->sensor].v;
  return vs_lowpass_make(v->bandwidth_hz, v->order, v->damping);
}
