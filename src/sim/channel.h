/* SPDX-License-Identifier: GPL-3.0-or-later
 * Channels: the quantities that every step of a run offers, under the names and units that users
 * see as columns of the CSV files and as probes. */
#ifndef VS_SIM_CHANNEL_H
#define VS_SIM_CHANNEL_H

#include "sim/frame.h"

/* The channels of every tier, in the order of the CSV: id, name, unit, text.
 * The last one, the current drawn from the mains, is for the books of energy and in no list. */
#define VS_CHANNEL_LIST(X)                                                                         \
  X(VS_CH_P, "p", "m", "trough relative to base, along the springs' motion")                       \
  X(VS_CH_U, "u", "m", "base, horizontal")                                                         \
  X(VS_CH_W, "w", "m", "base, vertical")                                                           \
  X(VS_CH_PHI, "phi", "rad", "base, rotation, counter-clockwise")                                  \
  X(VS_CH_VP, "vp", "m/s", "velocity of p")                                                        \
  X(VS_CH_VU, "vu", "m/s", "velocity of u")                                                        \
  X(VS_CH_VW, "vw", "m/s", "velocity of w")                                                        \
  X(VS_CH_VPHI, "vphi", "rad/s", "velocity of phi")                                                \
  X(VS_CH_AP, "ap", "m/s2", "acceleration of p")                                                   \
  X(VS_CH_AU, "au", "m/s2", "acceleration of u")                                                   \
  X(VS_CH_AW, "aw", "m/s2", "acceleration of w")                                                   \
  X(VS_CH_APHI, "aphi", "rad/s2", "acceleration of phi")                                           \
  X(VS_CH_Z, "z", "m", "air gap D + d + p")                                                        \
  X(VS_CH_LAMBDA, "lambda", "Wb", "flux linkage of the EVA")                                       \
  X(VS_CH_I, "i", "A", "coil current of the EVA")                                                  \
  X(VS_CH_FORCE, "force", "N", "force on the armature")                                            \
  X(VS_CH_V_EVA, "v_eva", "V", "voltage across the EVA")                                           \
  X(VS_CH_V_MAINS, "v_mains", "V", "mains voltage behind its impedance")                           \
  X(VS_CH_I_MAINS, "i_mains", "A", "current drawn from the mains")

enum {
#define VS_CHANNEL_ID(id, name, unit, text) id,
  VS_CHANNEL_LIST(VS_CHANNEL_ID)
#undef VS_CHANNEL_ID
      VS_CH_DECK, /* the first of the deck's probes, which follow in the deck's order */
  VS_CH_MOST = VS_CH_DECK + VS_DECK_MOST
};

typedef struct vs_channel {
  const char *name, *unit, *text;
  bool listed; /* in CSV files and lists */
} vs_channel;
extern const vs_channel vs_channel_standard[VS_CH_DECK];

/* How many channels a run has, and the channel with that number; its strings belong to the deck or
 * to the program. */
int vs_channel_count(const vs_frame *frame);
vs_channel vs_channel_at(const vs_frame *frame, int index);
/* Returns the number of the listed channel of that name, or -1 where there is none. */
int vs_channel_find(const vs_frame *frame, const char *name);

/* Groups of channels that cost time of their own to compute, as bits. All other channels (p, u, w,
 * phi, z, lambda, i, force, i_mains) always come along. */
enum {
  VS_GROUP_VELOCITIES = 1,
  VS_GROUP_ACCELERATIONS = 2, /* needs the velocities as well */
  VS_GROUP_V_EVA = 4,
  VS_GROUP_V_MAINS = 8,
  VS_GROUP_DECK = 16, /* the deck's probes */
  VS_GROUP_ALL = 31
};
/* Returns the groups that these channels, given by their numbers, belong to. */
unsigned vs_channel_groups(const int *channels, int count);

#endif
