/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/regulators.h"

#include <string.h>

/* Regulator "none": fires at firing.angle, whatever the instruments show. For a scene whose control
 * has an observer alone. */
static vs_status decide_by_profile(void *self, const vs_control_input *s, double *angle_rad,
                                   vs_error *err) {
  (void)self, (void)err;
  *angle_rad = vs_field_profile_at(&s->setup->timeline.firing.angle, s->t_s);
  return VS_OK;
}

static const vs_regulator open_loop = {
    .name = "none", .text = "open loop: fires at firing.angle", .decide = decide_by_profile};

/* To add a law of control: a file with its vs_regulator (regulator.h), and a row here. It sees
 * instruments alone. With `pi`, `steady` tells its closed loop. test_control runs it. */
const vs_regulator *const vs_regulators[] = {&open_loop,
                                             &vs_amplitude_regulator,
                                             &vs_phase_regulator,
                                             &vs_object_regulator,
                                             &vs_pipe_regulator,
                                             &vs_fmu_regulator,
                                             NULL};

const vs_regulator *vs_regulators_find(const char *name) {
  for (const vs_regulator *const *r = vs_regulators; *r; r++)
    if (!strcmp((*r)->name, name)) return *r;
  return NULL;
}
