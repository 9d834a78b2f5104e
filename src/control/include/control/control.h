/* SPDX-License-Identifier: GPL-3.0-or-later
 * The control of a scene: what its section `control` says of a controller that reads instruments
 * and sets the angle of each next firing.
 *
 *   control: {law: amplitude, sensor: p, setpoint: 1 mm, gain: -5 deg/mm, integral: 60 deg/mm.s}
 *
 * How it works in a run is in control/loop.h. */
#pragma once

#include "control/regulator.h"

enum { VS_CONTROL_FIELDS = 16, VS_CONTROL_UNIT = 48 };

/* Not to be moved: its section points into it. Constant once it is read. */
typedef struct vs_control {
  const vs_regulator *regulator; /* NULL: the scene has no control */
  vs_control_values v;
  int sensor; /* its number among the scene's instruments, behind which stand the observer's
                 estimates; -1: none is named */
  vs_state_observer observing; /* its key `observer`; none where that is missing */
  const char *unit;            /* the sensor's; "" where there is none */
  vs_where code;               /* of the key that names code; no place: there is none */
  vs_section section;          /* its keys with their units; it fills `v` */
  vs_field fields[VS_CONTROL_FIELDS];
  char units[VS_CONTROL_FIELDS]
            [VS_CONTROL_UNIT]; /* of fields whose unit follows from the sensor's */
} vs_control;

/* The keys that every control has. */
extern const vs_section vs_control_section;

/* Writes the keys of a control with this law, and returns how many they are. A unit may have "~"
 * for the sensor's. Besides, each has the key `observer` (control/state_observer.h). */
size_t vs_control_keys(const vs_regulator *law, const vs_field *keys[VS_CONTROL_FIELDS]);
extern const char vs_control_sensor[];

/* Start from {0}; vs_control_free at the end, also after an error. Reads the scene's section (NULL:
 * there is none). The instruments are the scene's. Errors, each of
 * which a check carries on from: no such law, a key that this law has not, no such instrument; a
 * scene without a thyristor, or one that fires once; and what any key can be wrong in. */
vs_status vs_control_read(const vs_node *section, const vs_setup *setup,
                          const vs_instruments *instruments, vs_control *control, vs_error *err);

void vs_control_free(vs_control *control);

/* How many numbers its law shows: the columns from 1 on. */
int vs_control_outputs(const vs_control *control);

/* Error: the control runs code of the user's own, and the command line does not allow that. */
vs_status vs_control_allow(const vs_control *control, bool allowed, vs_error *err);

/* For a check, which runs no such code: adds that it was not tried, where there is some. */
void vs_control_describe(const vs_control *control, vs_text *text);

/* What is to be said of its sensor: that it is read so seldom that much of an amplitude may fall
 * between two readings. Returns `text`; NULL: there is nothing to say. */
const char *vs_control_note(const vs_control *control, const vs_setup *setup,
                            const vs_instruments *instruments, char *text, size_t size);

/* Writes the path of the k-th file, from 0, whose contents make the law. False: it is none. */
bool vs_control_file(const vs_control *control, int k, char path[VS_PATH_SIZE]);

/* A column of run.csv that shows what the control does. */
typedef struct vs_control_column {
  const char *name;
  char unit[VS_CONTROL_UNIT];
  const char *role;      /* its column's (engine/channel.h) */
  char of[VS_NAME_SIZE]; /* the sensor, or what is estimated; of the angle, "firing" */
} vs_control_column;

/* Its columns, from 0: the angle of the last firing that was decided, then what its law shows,
 * then the observer's estimates. False behind the last, and where there is no control. */
bool vs_control_column_at(const vs_control *control, int k, vs_control_column *column);
