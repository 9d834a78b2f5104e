/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/regulators.h"

#include <string.h>

#include "amplitude.h"
#include "object.h"
#include "phase.h"
#include "pipe.h"
#include "profile.h"

const vs_regulator *const vs_regulators[] = {&vs_profile_regulator, &vs_amplitude_regulator,
                                             &vs_phase_regulator,   &vs_object_regulator,
                                             &vs_pipe_regulator,    NULL};

const vs_regulator *vs_regulators_find(const char *name) {
  for (const vs_regulator *const *r = vs_regulators; *r; r++)
    if (!strcmp((*r)->name, name)) return *r;
  return NULL;
}
