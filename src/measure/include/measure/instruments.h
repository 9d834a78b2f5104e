/* SPDX-License-Identifier: GPL-3.0-or-later
 * The instruments of a scene: what its section `instruments` says of sensors that measure a run's
 * channels, each with the converter behind it that makes numbers of what the sensor shows (the
 * A/D). How one works is in measure/meter.h.
 *
 *   instruments: {set: own, seed: 1, NAME: {range: [-3 mm, 3 mm], ...}, ...}
 *
 * A set is a file in spice/instruments/ or of the user's own, a map {title: TEXT, instruments:
 * {NAME: {...}, ...}}. A machine's file may name one, or have such a map, under its key
 * `instruments`: that is the machine's own set. What the scene says of a NAME of the set is put
 * over what the set says; `NAME: none` leaves it out. */
#pragma once

#include "base/field.h"
#include "base/path.h"
#include "engine/setup.h"

enum {
  VS_INSTRUMENT_MOST = 32,
  VS_INSTRUMENT_NAME = 32,
  VS_INSTRUMENT_FIELDS = 9 /* keys that an instrument has */
};

/* The keys of one instrument. */
typedef struct vs_instrument_values {
  char channel[VS_NAME_SIZE]; /* what it measures */
  double range[2];            /* what the sensor can show, in SI: from, to */
  double bandwidth_hz;        /* at which it shows 3 dB less; NaN: it is as fast as any signal */
  int order;                  /* of its low-pass, 1 or 2 */
  double damping;             /* zeta of the second order */
  double noise;               /* root mean square, SI */
  double rate_hz;             /* samples in a second */
  int bits;                   /* of the A/D; 0: there is none */
  char text[VS_NAME_SIZE];
} vs_instrument_values;

/* Not to be moved: its section points into it. */
typedef struct vs_instrument {
  char name[VS_INSTRUMENT_NAME];
  char column[VS_INSTRUMENT_NAME + 8]; /* "NAME_meas" */
  vs_where where;                      /* of its name */
  int channel;                         /* the channel's number in the scene's frame */
  const char *unit;                    /* of the channel, borrowed */
  vs_instrument_values v;
  bool on_orbit;      /* the run begins on an orbit, with its low-pass in this state at t = 0 */
  double x[2];        /* in the channel's unit */
  vs_section section; /* its keys with their units; it fills `v` */
  vs_field fields[VS_INSTRUMENT_FIELDS];
  char path[VS_INSTRUMENT_NAME + 16]; /* "instruments.NAME", the section's name */
} vs_instrument;

/* The keys that are no instrument. */
typedef struct vs_instruments_values {
  char set[VS_NAME_SIZE]; /* a set's file or name; "own": the machine's; "none" */
  int seed;
} vs_instruments_values;

/* Start from {0}; vs_instruments_free at the end, also after an error. Not to be moved. Constant
 * once it is read, but for `on_orbit` and `x`, which orbit/steady.h sets, or measure/meter.h.
 */
typedef struct vs_instruments {
  vs_instruments_values v;
  vs_instrument item[VS_INSTRUMENT_MOST];
  int count;    /* 0 for a scene without the section */
  vs_tree tree; /* of the set's file; places point into it */
} vs_instruments;

/* Where sets that come with the program are; the keys `set` and `seed`; and the keys of any
 * instrument, where units that follow from the channel are left out. */
extern const vs_shelf vs_instrument_shelf;
extern const vs_section vs_instruments_section, vs_instrument_section;
/* What the scene says of an instrument of the set that it has not. */
extern const char vs_instruments_left_out[];
/* True for a key of an instrument whose unit is the channel's. */
bool vs_instruments_follows(const vs_field *key);

/* Reads the scene's section (NULL: there is none, and no instrument). setup: the scene's, whose
 * machine and deck have the channels; frame: of its tier. Errors, each of which a check carries on
 * from: no such set; a name that no column can have; an unknown channel (the nearest is named), or
 * one that this tier has not; no range, or an empty one; more samples than a run can have; and what
 * any key can be wrong in. */
vs_status vs_instruments_read(const vs_node *section, const vs_setup *setup, const vs_frame *frame,
                              vs_instruments *instruments, vs_error *err);
void vs_instruments_free(vs_instruments *instruments);

/* The channel that the section's next instrument names, without reading anything else; NULL: the
 * section names no more. Those of its set are left out. *at keeps the place of the search between
 * two calls; it begins as NULL. */
const char *vs_instruments_names(const vs_node *section, const vs_node **at);

/* The frequency at which the scene's machine works, Hz: that of the firings, or of the mains where
 * nothing fires or only once. */
double vs_instruments_working_hz(const vs_setup *setup);

/* Writes what is to be said of instruments whose samples come too seldom for their bandwidth, so
 * that fast parts of a signal show as slow ones. Returns the first of them; NULL: there is none. */
const vs_instrument *vs_instruments_alias(const vs_instruments *instruments, char *text,
                                          size_t size);
