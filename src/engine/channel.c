/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/channel.h"

#include <stdio.h>
#include <string.h>

#include "base/units.h"

static const vs_channel STANDARD[VS_CH_Q] = {
#define VS_CHANNEL_ROW(id, name, unit, of, text)                                                   \
  {name, unit, text, id < VS_CH_I_MAINS, VS_COLUMN_PROBE, of},
    VS_CHANNEL_LIST(VS_CHANNEL_ROW)
#undef VS_CHANNEL_ROW
};

bool vs_channel_is_standard(const char *name) {
  for (int c = 0; c < VS_CH_Q; c++)
    if (!strcmp(name, STANDARD[c].name)) return true;
  return false;
}

int vs_channel_count(const vs_frame *frame) {
  return vs_channel_deck(frame->model) + (frame->deck ? (int)frame->deck->n_probes : 0);
}

/* A coordinate, its rate or its second rate: n counts over all three, coordinates first. */
static vs_channel motion(const vs_model *model, int n) {
  const vs_coordinate *c = &model->machine->coordinates[n % model->dof];
  if (n < model->dof)
    return (vs_channel){c->name, c->unit, c->text, true, VS_COLUMN_COORDINATE, "machine"};
  if (n < 2 * model->dof)
    return (vs_channel){c->rate, c->rate_unit, c->rate_text, true, VS_COLUMN_RATE, c->name};
  return (vs_channel){c->rate2, c->rate2_unit,          c->rate2_text,
                      true,     VS_COLUMN_ACCELERATION, c->name};
}

vs_channel vs_channel_at(const vs_frame *frame, int number) {
  const vs_model *m = frame->model;
  int of_machine = number - vs_channel_probes(m), of_deck = number - vs_channel_deck(m);
  if (number < VS_CH_Q) return STANDARD[number];
  if (of_machine < 0) return motion(m, number - VS_CH_Q);
  if (of_deck < 0) {
    const vs_machine_probe *probe = &m->machine->probes[of_machine];
    return (vs_channel){probe->name, probe->unit, probe->text, true, VS_COLUMN_PROBE, "machine"};
  }
  const vs_probe *probe = &frame->deck->probes[of_deck];
  return (vs_channel){probe->name, probe->unit, probe->text, true, VS_COLUMN_PROBE, "circuit"};
}

int vs_channel_listed(const vs_frame *frame, int numbers[VS_CH_MOST]) {
  int n = 0, probes = vs_channel_probes(frame->model), all = vs_channel_count(frame);
  for (int k = VS_CH_Q; k < probes; k++) numbers[n++] = k;
  for (int k = 0; k < VS_CH_Q; k++)
    if (STANDARD[k].listed) numbers[n++] = k;
  for (int k = probes; k < all; k++) numbers[n++] = k;
  return n;
}

int vs_channel_find(const vs_frame *frame, const char *name) {
  int numbers[VS_CH_MOST], n = vs_channel_listed(frame, numbers);
  for (int k = 0; k < n; k++)
    if (!strcmp(vs_channel_at(frame, numbers[k]).name, name)) return numbers[k];
  return -1;
}

unsigned vs_channel_groups(const vs_model *model, const int *channels, int count) {
  unsigned groups = 0;
  for (int k = 0; k < count; k++) {
    int c = channels[k];
    if (c >= vs_channel_deck(model))
      groups |= VS_GROUP_DECK;
    else if (c >= vs_channel_probes(model))
      groups |= VS_GROUP_MACHINE | VS_GROUP_ACCELERATIONS | VS_GROUP_VELOCITIES;
    else if (c == VS_CH_V_MAINS)
      groups |= VS_GROUP_V_MAINS;
    else if (c == VS_CH_V_EVA)
      groups |= VS_GROUP_V_EVA;
    else if (c >= vs_channel_rates2(model))
      groups |= VS_GROUP_ACCELERATIONS | VS_GROUP_VELOCITIES;
    else if (c >= vs_channel_rates(model))
      groups |= VS_GROUP_VELOCITIES;
  }
  return groups;
}

/* ---- columns ---- */

vs_column vs_channel_column(const char *quantity, const char *unit, const char *role,
                            const char *of) {
  vs_column c = {.name = ""};
  char suffix[VS_COLUMN_UNIT];
  vs_units_suffix(unit, suffix, sizeof suffix);
  snprintf(c.name, sizeof c.name, "%s%s%s", quantity, *suffix ? "_" : "", suffix);
  snprintf(c.quantity, sizeof c.quantity, "%s", quantity);
  snprintf(c.unit, sizeof c.unit, "%s", unit);
  snprintf(c.role, sizeof c.role, "%s", role);
  snprintf(c.of, sizeof c.of, "%s", of ? of : "");
  return c;
}

void vs_channel_column_json(const vs_column *c, vs_json *json) {
  vs_json_text(json, "name", c->name);
  vs_json_text(json, "quantity", c->quantity);
  vs_json_text(json, "unit", c->unit);
  vs_json_text(json, "role", c->role);
  vs_json_text(json, "of", c->of);
}
