/* SPDX-License-Identifier: GPL-3.0-or-later
 * What goes wrong in a scene, by name and from a given instant on: on the mains, at the gate, in
 * the circuit. The section `events` is a map of names; each says its kind and the keys of that
 * kind.
 *
 * A kind is one row of a table: what it does to the mains' voltage, to the gate's pulses, to the
 * netlist.
 *
 * Several at once act on the mains in fixed stages, whatever the order of their lines: phases are
 * added to the undisturbed sine's; harmonics, of that sine's phase, to its voltage; what is left of
 * the sum is multiplied by each factor, those of sag, swell and interruption, and then the notch's.
 * So there is no voltage within an interruption. Generators (surge, ring_wave, eft) may come
 * together, and closer than their waves last: each is one of its own, coupled to the line from the
 * beginning, and what they bring adds up. */
#ifndef VS_DRIVE_EVENTS_H
#define VS_DRIVE_EVENTS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/field.h"
#include "base/text.h"

struct vs_timeline;
struct vs_deck;

enum { VS_EVENTS_MOST = 32, VS_EVENT_NAME = 64 };

/* The keys of all kinds; each kind reads its own. */
typedef struct vs_event_values {
  double at_s, angle_rad, duration_s;
  int cycle; /* from 1 */
  int count; /* repetitions, cycle by cycle */
  double level_v;
  double part;  /* of the mains' amplitude; of a gate pulse's; of the coil's turns */
  int polarity; /* negative: odd */
  double impedance_ohm, frequency_hz, phase_rad;
  int order;
  char kind[VS_NAME_SIZE], element[VS_NAME_SIZE], gate[VS_NAME_SIZE];
} vs_event_values;

/* What a kind's number does to the mains: is added to their angle, rad; times their peak, to their
 * voltage; is a factor of that. */
typedef enum vs_mains_stage { VS_MAINS_ANGLE, VS_MAINS_ADDED, VS_MAINS_FACTOR } vs_mains_stage;

typedef struct vs_event_kind vs_event_kind;
typedef struct vs_occurrence {
  char name[VS_EVENT_NAME];
  const vs_event_kind *kind;
  vs_event_values v;
  double start_s, end_s; /* end: INFINITY where it lasts */
  double gate_rad;       /* of the one gate it acts on; NaN: on all */
  vs_where where;        /* of its name */
} vs_occurrence;

typedef struct vs_events {
  vs_occurrence item[VS_EVENTS_MOST];
  size_t count;
} vs_events;

struct vs_event_kind {
  const char *name, *text;
  const vs_field *fields;
  size_t n_fields;
  bool at_cycle; /* it is told by its cycle alone */
  /* Its number, while it is on; angle_rad: of the mains, with all jumps. NULL: it leaves the mains
   * alone. */
  double (*mains)(const vs_occurrence *e, const struct vs_timeline *t, double t_s,
                  double angle_rad);
  vs_mains_stage stage;
  /* The gate pulse of its cycle: its length and its voltage. */
  void (*pulse)(const vs_occurrence *e, double *width_s, double *voltage);
  bool adds_pulse; /* from its start to its end */
  bool jams;       /* the armature stays where it is */
  bool ideal;      /* it means the same to an ideal thyristor between mains and coil */
  /* Voltage of the source it puts into the netlist, V. */
  double (*source)(const vs_occurrence *e, double t_s);
  /* First instant after t that must be the end of a step; INFINITY: none. */
  double (*edge)(const vs_occurrence *e, double t_s);
  /* Longest step from t on; INFINITY: as without it. */
  double (*longest)(const vs_occurrence *e, double t_s);
  /* Puts it into the deck: lines, and a source it drives. Errors with its place. */
  vs_status (*wire)(const vs_occurrence *e, size_t index, struct vs_deck *deck, vs_error *err);
};

enum { VS_EVENT_KINDS = 17 };
extern const vs_event_kind vs_events_kinds[VS_EVENT_KINDS];

/* Reads the section, a map of names. until_s: end of the run. Errors, each of which a check carries
 * on from: an unknown kind or key, a level its generator does not have, an instant outside the run,
 * an element that is not said, a repetition that overlaps itself, two that contradict each other.
 */
vs_status vs_events_read(const vs_node *map, const struct vs_timeline *timeline, double until_s,
                         vs_events *events, vs_error *err);

/* Has it begun at t, and not ended? On its edges, to rounding, it still is what it was before. */
bool vs_occurrence_is_on(const vs_occurrence *e, double t_s);

/* Does it act on the gate whose pulses are delayed so? */
bool vs_occurrence_at_gate(const vs_occurrence *e, double shift_rad);

/* Puts those that are circuits into the deck. Errors, besides: a gate that the deck has not, two
 * that switch one element. */
vs_status vs_events_wire(const vs_events *events, struct vs_deck *deck, vs_error *err);

double vs_events_edge(const vs_events *events, double t_s);
double vs_events_longest(const vs_events *events, double t_s);

#endif
