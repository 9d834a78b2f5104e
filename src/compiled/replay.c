/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "replay.h"

#include <math.h>

#include "base/alloc.h"

void vs_replay_begin(vs_circuit_steps *s) {
  if (!s) return;
  s->next = 0;
  if (s->are == VS_STEPS_NOTED) s->count = 0;
}

void vs_replay_note(vs_circuit_steps *s, const vs_circuit_step *step) {
  if (!s || s->are != VS_STEPS_NOTED) return;
  if (s->count == s->room) {
    s->room = s->room ? 2 * s->room : 4096;
    s->step = vs_resize(s->step, s->room, sizeof *s->step);
  }
  s->step[s->count++] = *step;
}

int vs_replay_parts(vs_circuit_steps *s, int parts) {
  if (!vs_replay_is_on(s)) return parts;
  if (s->are == VS_STEPS_TAKEN) return s->step[s->next - 1].parts;
  return s->step[s->count - 1].parts = parts;
}

bool vs_replay_restarts(const vs_circuit_steps *s, bool due) {
  return vs_replay_follows(s) ? s->next < s->count && isnan(s->step[s->next].left_s) : due;
}

const vs_circuit_step *vs_replay_next(vs_circuit_steps *s, double left_s, double *length_s) {
  if (s->next == s->count) return NULL;
  const vs_circuit_step *step = &s->step[s->next++];
  if (isnan(step->left_s) != isnan(left_s)) return NULL;
  *length_s = step->length_s;
  if (!isnan(left_s) && isfinite(step->left_s))
    *length_s = step->length_s == step->left_s ? left_s : *length_s * (left_s / step->left_s);
  return step;
}
