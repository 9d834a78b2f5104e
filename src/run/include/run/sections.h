/* SPDX-License-Identifier: GPL-3.0-or-later
 * The sections of a scene: the one table that says which keys may stand at a scene's top, which of
 * them have fields, and where a setup keeps the values of these fields. */
#pragma once

#include "engine/sim.h"

/* One row for each key at the top of a scene, in the order in which a scene is shown.
 * SECTION(name, fields, member): fields is the vs_section, NULL for those of the scene's own
 * machine and deck; member is the one of vs_setup that the fields fill. OTHER(name, ): the key has
 * no fields of its own; run/scene.c, run/ratings.c, engine/drive/events.c, measure/instruments.c,
 * control/control.c, measure/quality.c, measure/expect.c and engine/cooling.c read such keys. */
#define VS_SECTION_LIST(SECTION, OTHER)                                                            \
  SECTION(machine, NULL, model.parameters)                                                         \
  SECTION(actuator, NULL, model.actuator)                                                          \
  SECTION(load, &vs_model_load_section, model.load)                                                \
  SECTION(supply, NULL, timeline.supply)                                                           \
  SECTION(firing, NULL, timeline.firing)                                                           \
  SECTION(pwm, &vs_pwm_section, timeline.pwm)                                                      \
  SECTION(circuit, NULL, circuit_values)                                                           \
  OTHER(events, )                                                                                  \
  OTHER(instruments, )                                                                             \
  OTHER(control, )                                                                                 \
  SECTION(run, &vs_setup_run_keys, run)                                                            \
  SECTION(start, NULL, start)                                                                      \
  OTHER(record, )                                                                                  \
  OTHER(measured, )                                                                                \
  OTHER(quality, )                                                                                 \
  OTHER(expect, )                                                                                  \
  OTHER(waive, )                                                                                   \
  OTHER(spread, )                                                                                  \
  OTHER(ratings, )                                                                                 \
  OTHER(ambient, )                                                                                 \
  OTHER(heatsink, )                                                                                \
  SECTION(measure, &vs_setup_measure_keys, measure)                                                \
  SECTION(limits, &vs_limits_section, limits)

/* How many sections have fields, and how many keys there are. */
enum {
#define VS_SECTION_ID(name, fields, member) VS_SECTION_NUMBER_##name,
#define VS_SECTION_NO_ID(name, none)
  VS_SECTION_LIST(VS_SECTION_ID, VS_SECTION_NO_ID) VS_SECTIONS
#undef VS_SECTION_ID
#undef VS_SECTION_NO_ID
};
enum {
#define VS_SECTION_KEY_ID(name, fields, member) VS_SECTION_KEY_##name,
#define VS_OTHER_KEY_ID(name, none) VS_SECTION_KEY_##name,
  VS_SECTION_LIST(VS_SECTION_KEY_ID, VS_OTHER_KEY_ID) VS_SECTION_KEYS
#undef VS_SECTION_KEY_ID
#undef VS_OTHER_KEY_ID
};

extern const char *const vs_section_keys[VS_SECTION_KEYS];

/* True for a section whose keys the scene, its machine or its deck names: by its number among those
 * with fields, and by that among all. The actuator's are the same for all machines. */
bool vs_section_is_named(int index);
bool vs_section_key_is_named(int key);

/* A section and the values that its fields have in one setup. */
typedef struct vs_filled_section {
  const vs_section *section;
  const void *values; /* borrowed from the setup */
  size_t size;        /* of the struct of values, bytes */
} vs_filled_section;

/* index: from 0, below VS_SECTIONS, in the table's order. */
vs_filled_section vs_section_at(const vs_setup *setup, int index);
/* True unless the section does nothing in this setup: `pwm`, where the deck has no port pwm, and
 * `limits`, which never changes a result. Such a section is no part of what a run is known by. */
bool vs_section_counts(const vs_setup *setup, int index);
/* The same section without a setup, with that machine and that deck for the scene's. */
const vs_section *vs_section_fields(const vs_machine *machine, const vs_deck *deck, int index);
