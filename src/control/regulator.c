/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/regulator.h"

#include <math.h>
#include <string.h>

#include "control/amplitude.h"
#include "control/object.h"
#include "control/phase.h"
#include "control/pipe.h"
#include "control/profile.h"

const vs_regulator *const vs_regulators[] = {&vs_profile_regulator, &vs_amplitude_regulator,
                                             &vs_phase_regulator,   &vs_object_regulator,
                                             &vs_pipe_regulator,    NULL};

vs_lowpass vs_regulator_lowpass(const vs_sight *s) {
  if (s->sensor >= s->instruments->count) return vs_lowpass_make(NAN, 1, 1);
  const vs_instrument_values *v = &s->instruments->item[s->sensor].v;
  return vs_lowpass_make(v->bandwidth_hz, v->order, v->damping);
}

const vs_regulator *vs_regulator_find(const char *name) {
  for (const vs_regulator *const *r = vs_regulators; *r; r++)
    if (!strcmp((*r)->name, name)) return *r;
  return NULL;
}
