/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the devices of a deck are watched for: the kinds there are, what each kind's voltage and
 * current are reduced to, and which limit of its part's file that is held against. One table for
 * lists, summary and verdict; and the contract's lines device and zth. */
#ifndef VS_DECK_DEVICES_H
#define VS_DECK_DEVICES_H

#include "deck/cursor.h"
#include "deck/deck.h"

/* Of a device: V, V.s, A, W, A2. */
enum { VS_OF_V, VS_OF_FLUX, VS_OF_I, VS_OF_POWER, VS_OF_I2, VS_COURSES };

/* How a course becomes one number. Each row is an id and the name of its plug in
 * watch/reductions.c, which does it. Those from VS_R_RISE to VS_R_COMMUTATION_FAILURE are of a
 * device that conducts or blocks, VS_R_GATE_LEAST is of one with a gate.
 *   VS_R_PEAK         largest value, in the sense that the measure gives
 *   VS_R_MEAN         mean over the stretch that the scene's section measure says
 *   VS_R_RMS          root of the mean over that stretch
 *   VS_R_INTEGRAL     integral over the run
 *   VS_R_PULSE        largest integral over one conduction
 *   VS_R_HEAT         most that one pulse turned into heat: watch/pulse.h
 *   VS_R_WITHIN       largest integral within 10 ms
 *   VS_R_SURGE        peak of the half sine of 10 ms that has this integral
 *   VS_R_STEEPEST     largest rate, in the sense that the measure gives, over any 0.1 us
 *   VS_R_JUNCTION     rise of the junction's temperature, by the part's lines zth
 *   VS_R_RISE         steepest mean rate from 10 to 90 % of a rise of forward voltage
 *   VS_R_OFF_RATE     largest rising rate of blocked forward voltage, over any 0.1 us
 *   VS_R_ON_RATE      largest rate of current from firing to its first maximum, over any 0.1 us
 *   VS_R_OFFERED      shortest time between a conduction and forward voltage without a gate pulse
 *   VS_R_MISFIRE, VS_R_UNINTENDED, VS_R_COMMUTATION_FAILURE   how often: watch/switching.h
 *   VS_R_GATE_LEAST   smallest of all gate pulses' peaks */
#define VS_REDUCTION_LIST(X)                                                                       \
  X(VS_R_PEAK, peak)                                                                               \
  X(VS_R_MEAN, mean)                                                                               \
  X(VS_R_RMS, rms)                                                                                 \
  X(VS_R_INTEGRAL, integral)                                                                       \
  X(VS_R_PULSE, pulse)                                                                             \
  X(VS_R_HEAT, heat)                                                                               \
  X(VS_R_WITHIN, within)                                                                           \
  X(VS_R_SURGE, surge)                                                                             \
  X(VS_R_STEEPEST, steepest)                                                                       \
  X(VS_R_JUNCTION, junction)                                                                       \
  X(VS_R_RISE, rise)                                                                               \
  X(VS_R_OFF_RATE, off_rate)                                                                       \
  X(VS_R_ON_RATE, on_rate)                                                                         \
  X(VS_R_OFFERED, offered)                                                                         \
  X(VS_R_MISFIRE, misfire)                                                                         \
  X(VS_R_UNINTENDED, unintended)                                                                   \
  X(VS_R_COMMUTATION_FAILURE, commutation_failure)                                                 \
  X(VS_R_GATE_LEAST, gate_least)

typedef enum vs_reduction {
#define VS_REDUCTION_ID(id, plug) id,
  VS_REDUCTION_LIST(VS_REDUCTION_ID)
#undef VS_REDUCTION_ID
      VS_REDUCTIONS
} vs_reduction;

/* The limit is the most allowed, the least allowed, the most that the device bears which this one
 * protects. */
enum { VS_AT_MOST, VS_AT_LEAST, VS_WARD_AT_MOST };

/* A device's measure is called DEVICE.name. */
typedef struct vs_device_measure {
  const char *name, *unit, *text;
  vs_reduction how;
  int of;            /* VS_OF_... */
  int sense;         /* of a peak: +1 largest, -1 least with its sign turned, 0 magnitude */
  const char *limit; /* of the part's file that it is held against; NULL: none */
  int held;          /* to its limit: VS_AT_MOST, ... */
} vs_device_measure;

enum { VS_KIND_MEASURES = 16, VS_KIND_LIMITS = 10 }; /* at most, of one kind */
typedef struct vs_kind {
  const char *name;
  bool switches, gated; /* conducts or blocks; goes by the deck's gate pulses */
  vs_device_measure measures[VS_KIND_MEASURES];
  size_t n_measures;
} vs_kind;
extern const vs_kind vs_kinds_all[];
extern const size_t vs_n_kinds;

/* Each reads the rest of one line. */
vs_status vs_devices_line(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_devices_zth(vs_deck *deck, vs_cursor *c, vs_error *err);

/* Gives devices their kinds, parts and gates, once the parts are chosen. Errors with their place: a
 * device that is no part and of no kind, a gate no port has, a limit in a unit of another kind, one
 * to protect that is not there. */
vs_status vs_devices_resolve(vs_deck *deck, vs_error *err);

/* The limit that the device's measure is held against; NULL: the file of its part, or of the part
 * it protects, has none, or "none". */
const vs_limit *vs_devices_limit(const vs_deck *deck, const vs_device *device,
                                 const vs_device_measure *measure);

#endif
