/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/channel.h"

#include <string.h>

const vs_channel vs_channel_standard[VS_CH_DECK] = {
#define VS_CHANNEL_ROW(id, name, unit, text) {name, unit, text, id != VS_CH_I_MAINS},
    VS_CHANNEL_LIST(VS_CHANNEL_ROW)
#undef VS_CHANNEL_ROW
};

int vs_channel_count(const vs_frame *frame) {
  return VS_CH_DECK + (frame->deck ? (int)frame->deck->n_probes : 0);
}

vs_channel vs_channel_at(const vs_frame *frame, int index) {
  if (index < VS_CH_DECK) return vs_channel_standard[index];
  const vs_probe *probe = &frame->deck->probes[index - VS_CH_DECK];
  return (vs_channel){probe->name, probe->unit, probe->text, true};
}

int vs_channel_find(const vs_frame *frame, const char *name) {
  for (int k = 0; k < vs_channel_count(frame); k++) {
    vs_channel c = vs_channel_at(frame, k);
    if (c.listed && !strcmp(c.name, name)) return k;
  }
  return -1;
}

unsigned vs_channel_groups(const int *channels, int count) {
  unsigned groups = 0;
  for (int k = 0; k < count; k++) {
    int c = channels[k];
    if (c >= VS_CH_DECK)
      groups |= VS_GROUP_DECK;
    else if (c == VS_CH_V_MAINS)
      groups |= VS_GROUP_V_MAINS;
    else if (c == VS_CH_V_EVA)
      groups |= VS_GROUP_V_EVA;
    else if (c >= VS_CH_AP && c <= VS_CH_APHI)
      groups |= VS_GROUP_ACCELERATIONS | VS_GROUP_VELOCITIES;
    else if (c >= VS_CH_VP && c <= VS_CH_VPHI)
      groups |= VS_GROUP_VELOCITIES;
  }
  return groups;
}
