/* SPDX-License-Identifier: GPL-3.0-or-later
 * An event: something that goes wrong in a scene, by name and from a given instant on: on the
 * mains, at the gate, in the circuit, at the machine. Its kind (vs_event_kind) is a constant struct
 * that has all that belongs to such events. Kinds are defined in generators.c, disturbances.c,
 * pulses.c and faults.c, each file with a table of its own; nothing else asks which kind an event
 * is of. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/field.h"
#include "netlist/deck.h"

enum { VS_EVENTS_MOST = 32, VS_EVENT_NAME = 64 };

/* The values of the keys of all kinds; each kind reads only those that its fields name. */
typedef struct vs_event_values {
  double at_s, angle_rad, duration_s;
  int cycle; /* of the mains, from 1 */
  int count; /* repetitions, cycle by cycle */
  int off;   /* 1: the event is not built */
  double level_v;
  double fraction; /* of the mains' amplitude, of a gate pulse's voltage, of the coil's turns, or of
                      the conveyed material; NaN: it stays */
  double volume_m3; /* of the conveyed material; NaN: it stays */
  int polarity;     /* 1: negative */
  double impedance_ohm, frequency_hz, phase_rad;
  int order;
  int earth;      /* 1: a generator is coupled from the line to earth, else from line to line */
  int times;      /* pulses of a generator, of which the run has the first */
  double every_s; /* from one of these pulses to the next */
  char kind[VS_NAME_SIZE], element[VS_NAME_SIZE], gate[VS_NAME_SIZE];
  char from[VS_NAME_SIZE]; /* "start", "strike" or a time: since when a generator's network lies on
                              the line */
} vs_event_values;

/* How the value of `mains` acts: it is added to the mains' angle (rad), or, times their peak, to
 * their voltage, or it is a factor of that voltage. */
typedef enum vs_mains_stage { VS_MAINS_ANGLE, VS_MAINS_ADDED, VS_MAINS_FACTOR } vs_mains_stage;

/* One event of a scene. */
typedef struct vs_scene_event {
  char name[VS_EVENT_NAME];
  const struct vs_event_kind *kind;
  vs_event_values v;
  double start_s, end_s; /* end: INFINITY where it lasts */
  double on_line_s;      /* since when a generator's network lies on the line; 0: since the run's
                            start, without a switch. Other kinds have 0 */
  double period_s;       /* of the mains; repetitions come a period apart */
  double gate_rad;       /* delay of the one gate it acts on; NaN: it acts on all */
  vs_where where;        /* of its name in the scene */
} vs_scene_event;

/* The events of a scene, in the order of their lines. Those that are off, and those that would
 * begin at or behind the run's end, are not built: the run is the one that it is without their
 * lines. Only what is told of the scene has them. */
typedef struct vs_events {
  vs_scene_event item[VS_EVENTS_MOST];
  size_t count;
  vs_scene_event unbuilt[VS_EVENTS_MOST];
  size_t n_unbuilt;
} vs_events;

/* A kind. Members that are NULL, 0 or false say that its events do no such thing. */
typedef struct vs_event_kind {
  const char *name, *text;
  const vs_field *fields; /* its keys; they fill a vs_event_values. The first is `kind` */
  size_t n_fields;
  bool at_cycle;      /* its instant is told by the key cycle alone, without an angle */
  bool wants_element; /* its key element has no default and must be given */
  bool ideal;         /* it means the same to an ideal thyristor between mains and coil */
  bool adds_up;       /* two of them at the same time on the mains add up; else they clash */
  bool adds_pulse;    /* it is a gate pulse from its start to its end */
  bool jams;          /* the armature stays where it is from its start on */
  bool cuts;          /* its element carries nothing from its start on */
  /* Sets what the scene's load becomes at its start; what the event does not name stays as it is.
   */
  void (*load)(const vs_scene_event *e, double *fraction, double *volume_m3);
  /* The number that the event has for the mains at t; `angle_rad` is the angle of the mains then,
   * with all jumps. `stage` says what becomes of the number. */
  double (*mains)(const vs_scene_event *e, double t_s, double angle_rad);
  vs_mains_stage stage;
  /* Changes the length (s) and the voltage (V) of the gate pulse of its cycle. */
  void (*pulse)(const vs_scene_event *e, double *width_s, double *voltage);
  /* The first instant after t that must be the end of a step; INFINITY: none. */
  double (*edge)(const vs_scene_event *e, double t_s);
  /* The longest step allowed from t on, s; INFINITY: any. */
  double (*longest)(const vs_scene_event *e, double t_s);
  /* The element of the deck that it changes, whose loss is then no longer what the deck says. */
  const char *(*element)(const vs_scene_event *e, const vs_deck *deck);
  /* Writes the name of the n-th part of the deck that `element` may name, from 0: an element that a
   * parameter of the deck chooses or gives its value. False: there are no more. */
  bool (*part)(const vs_deck *deck, size_t n, char name[VS_DECK_NAME]);
  /* Puts the event, number `index` of the scene, into the deck: lines, and a source that it drives.
   * Errors have the event's place. */
  vs_status (*wire)(const vs_scene_event *e, size_t index, vs_deck *deck, vs_error *err);
  /* The voltage of that source, V. */
  double (*source)(const vs_scene_event *e, double t_s);
  /* Of a generator: what of it lies on the line, "18 uF + 2 ohm". */
  void (*network)(const vs_scene_event *e, char *text, size_t size);
} vs_event_kind;

/* The kinds, in FILE.c for vs_FILE; the last row of each has no name. A new kind is one row of one
 * of these tables, with its keys and functions above it. */
extern const vs_event_kind vs_generators[], vs_disturbances[], vs_pulses[], vs_faults[];

/* Returns the tolerance, s, within which a step that ends at t_s counts as ending on an edge. */
double vs_scene_event_rounding(double t_s);

/* True from behind its start up to its end. On an edge, to rounding, an event still is what it was
 * before, so that a step that ends on the edge sees that. */
bool vs_scene_event_is_on(const vs_scene_event *e, double t_s);

/* The next of its two edges, its start or its end: the `edge` of most kinds. */
double vs_scene_event_edge(const vs_scene_event *e, double t_s);

/* Puts the event off for ever: it begins at no time of any run. What it is in the deck stays, and a
 * generator's network comes onto the line when it does, but for one that comes with its wave.
 * `number` is another one for each event of a scene, as no two may change one thing at once. */
void vs_scene_event_put_off(vs_scene_event *e, size_t number);

/* What of a generator lies on the line, and where: "18 uF + 2 ohm, line to line". Returns false,
 * and writes nothing, for other kinds. */
bool vs_scene_event_network(const vs_scene_event *e, char *text, size_t size);

/* 1 from behind the instant on at which the generator's network comes onto the line, before that 0:
 * what drives the switch by which it does. */
double vs_scene_event_on_line(const vs_scene_event *e, double t_s);

/* The event whose pulse comes more than once, which is for the whole run; NULL: there is none. */
const vs_scene_event *vs_scene_event_repeated(const vs_events *events);

/* True where the event acts on the gate whose pulses are delayed by shift_rad. */
bool vs_scene_event_at_gate(const vs_scene_event *e, double shift_rad);

/* ---- keys that several kinds have, as rows of a table of fields ---- */

#define VS_EVENT_V_(member) offsetof(vs_event_values, member)
/* The rows that every kind begins with. */
#define VS_EVENT_KIND                                                                              \
  {"kind", VS_NAME, "", "-", 0, 0, false, VS_EVENT_V_(kind), "what happens", NULL, NULL}, {        \
    "off", VS_CHOICE, "", "false", 0, 0, false, VS_EVENT_V_(off),                                  \
        "true: the run is the one without this event", "false|true", NULL                          \
  }
#define VS_EVENT_CYCLE                                                                             \
  {                                                                                                \
    "cycle", VS_COUNT, "", "1", 1, 1e9, false, VS_EVENT_V_(cycle), "cycle of the mains, from 1",   \
        NULL, NULL                                                                                 \
  }
/* When it begins: three rows. */
#define VS_EVENT_AT                                                                                \
  {"at",                                                                                           \
   VS_REAL,                                                                                        \
   "ms",                                                                                           \
   "0 ms",                                                                                         \
   0,                                                                                              \
   1e9,                                                                                            \
   false,                                                                                          \
   VS_EVENT_V_(at_s),                                                                              \
   "when it begins; or cycle and angle",                                                           \
   NULL,                                                                                           \
   NULL},                                                                                          \
      VS_EVENT_CYCLE, {                                                                            \
    "angle", VS_REAL, "deg", "0 deg", 0, 360, false, VS_EVENT_V_(angle_rad),                       \
        "from the rising zero crossing of the mains", NULL, NULL                                   \
  }
#define VS_EVENT_DURATION(value)                                                                   \
  {                                                                                                \
    "duration", VS_REAL, "ms", value, 0, 1e9, true, VS_EVENT_V_(duration_s), "how long it lasts",  \
        NULL, NULL                                                                                 \
  }
#define VS_EVENT_LEVEL(value, min, max, text)                                                      \
  { "level", VS_REAL, "kV", value, min, max, false, VS_EVENT_V_(level_v), text, NULL, NULL }
#define VS_EVENT_FRACTION(key, value, min, max, text)                                              \
  { key, VS_REAL, "%", value, min, max, false, VS_EVENT_V_(fraction), text, NULL, NULL }

/* A table of fields as the members fields and n_fields of a kind. */
#define VS_EVENT_KEYS(rows) .fields = rows, .n_fields = sizeof rows / sizeof *rows
