/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "profile.h"

static vs_status decide(void *self, const vs_sight *s, double *angle_rad, vs_error *err) {
  (void)self, (void)err;
  *angle_rad = vs_field_profile_at(&s->setup->timeline.firing.angle, s->t_s);
  return VS_OK;
}

const vs_regulator vs_profile_regulator = {
    .name = "none", .text = "open loop: fires at firing.angle", .decide = decide};
