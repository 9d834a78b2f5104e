/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/firing.h"

#include <math.h>

double vs_firing_cycle_s(const vs_timeline *t, double n) {
  return t->first_zero_s + (t->firing.first_cycle - 1 + n * t->firing.every) * t->period_s;
}

bool vs_firing_is_even(const vs_timeline *t) {
  return !t->program && !t->firing.angle.count;
}

double vs_firing_angle(const vs_timeline *t, double n) {
  if (t->program) return t->program->angle_rad[(long)n];
  return vs_field_profile_at(&t->firing.angle, vs_firing_cycle_s(t, n));
}

bool vs_firing_is_decided(const vs_timeline *t, double n) {
  return !t->program || n < (double)t->program->count;
}

double vs_firing_known_s(const vs_timeline *t) {
  const vs_program *p = t->program;
  if (!p || p->count == p->size) return INFINITY;
  return vs_firing_cycle_s(t, (double)p->count);
}

void vs_firing_range(const vs_timeline *t, double range[2]) {
  const vs_field_profile *angle = &t->firing.angle;
  range[0] = range[1] = angle->first;
  for (int k = 1; k < angle->count; k++) {
    range[0] = fmin(range[0], angle->value[k]);
    range[1] = fmax(range[1], angle->value[k]);
  }
  if (t->program) range[0] = t->program->range[0], range[1] = t->program->range[1];
}
