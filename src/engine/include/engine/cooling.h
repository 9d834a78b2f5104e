/* SPDX-License-Identifier: GPL-3.0-or-later
 * What cools the devices of a circuit: the scene's keys `ambient` and `heatsink`.
 *
 *   ambient: 40 degC
 *   heatsink: {thyristor: 12 K/W}
 *
 * A device heats its case, the case its heat sink, and that the ambient. */
#pragma once

#include "base/json.h"
#include "base/tree.h"
#include "netlist/deck.h"

typedef struct vs_cooling {
  bool stated;                          /* the scene has one of the two keys */
  double ambient_degc;                  /* 25 where the scene does not say */
  double sink_k_per_w[VS_DECK_DEVICES]; /* from the heat sink to the ambient, in the order of the
                                           deck's devices; 0: the device has none */
} vs_cooling;

/* The keys, as fields: what is allowed, the default and the text. */
extern const vs_field vs_cooling_ambient, vs_cooling_heatsink;

/* Reads both keys of the scene against the deck, whose devices must be resolved. Errors, each of
 * which a check carries on from: a value that is none; no such device; a heat sink for a device of
 * which no thermal resistance is known; an ambient at or above t_j_max of a part. Of a deck that
 * was not read whole the heat sinks are not looked at. */
vs_status vs_cooling_read(const vs_node *scene, const vs_deck *deck, vs_cooling *cooling,
                          vs_error *err);

/* True where the device has a heat sink, or its part states r_th_ja. */
bool vs_cooling_has(const vs_cooling *cooling, const vs_deck *deck, const vs_device *device);

/* The thermal resistance from the device's case to the ambient, K/W: of its heat sink, with r_th_cs
 * of its part where that states one; else r_th_ja of its part, less r_th_jc. NaN: neither is known.
 * *unsure gets what its figures lack, besides. */
double vs_cooling_to_ambient(const vs_cooling *cooling, const vs_deck *deck,
                             const vs_device *device, unsigned *unsure);

/* Adds what heats what: "thyristor: junction over case 1.8 K/W, over heat sink 12 K/W, over ambient
 * 40 degC". */
void vs_cooling_write(const vs_cooling *cooling, const vs_deck *deck, const vs_device *device,
                      vs_text *text);

/* Adds the members "ambient" and "heatsink" to a summary, where the scene has them. */
void vs_cooling_json(const vs_cooling *cooling, const vs_deck *deck, vs_json *json);
/* Adds what the keys say to a text that a run is known by. */
void vs_cooling_identify(const vs_cooling *cooling, const vs_deck *deck, vs_text *text);
