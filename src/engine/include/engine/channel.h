/* SPDX-License-Identifier: GPL-3.0-or-later
 * Channels: the quantities that every step of a run offers, under the names and units that users
 * see as columns of the CSV files and as probes; and the frame of a run, which says which there
 * are. */
#pragma once

#include <stdbool.h>

#include "base/json.h"
#include "engine/cooling.h"
#include "engine/timeline.h"
#include "netlist/deck.h"
#include "plant/model.h"

/* A stretch of time, s. */
typedef struct vs_span_s {
  double from_s, to_s;
} vs_span_s;

/* What is the same for all steps of one run, so that a step need not carry it. vs_sim_frame
 * (engine/sim.h) makes it. The pointers lead into the setup, which must outlive it. */
typedef struct vs_frame {
  const vs_model *model;
  const vs_timeline *timeline;
  const vs_cooling *cooling; /* of the deck's devices */
  const vs_deck *deck;       /* whose probes the run has; NULL on a tier without a circuit */
  bool gap_at_rest; /* tier analytic: i = lambda z(0)/(2a), so that L stays as at rest (Eq. 91) */
  vs_span_s means;  /* what means are taken over; from 0 to 0 stands for the whole run */
  bool at_work;     /* the run is whole periods of an orbit */
  bool from_work;   /* the run begins on an orbit, with devices that are warm */
  bool on_orbit;    /* the run begins on one: start: steady */
  double tolerance; /* run.tolerance */
  bool source_is_coil; /* no circuit stands between the mains and the coil: the mains current is
                          the coil's current, and v = R_c i + dlambda/dt is the EVA's voltage */
} vs_frame;

/* ---- what a column is ---- */

/* The role of a column of run.csv, in the word that summary.json has for it. The columns of
 * study.csv have words of their own besides (study/folder.h). */
#define VS_COLUMN_TIME "time"
#define VS_COLUMN_COORDINATE "coordinate"
#define VS_COLUMN_RATE "rate"
#define VS_COLUMN_ACCELERATION "acceleration"
#define VS_COLUMN_PROBE "probe"
#define VS_COLUMN_INSTRUMENT "instrument"
#define VS_COLUMN_ESTIMATE "estimate"
#define VS_COLUMN_SET_POINT "set_point"
#define VS_COLUMN_MEASURE "measure" /* of a study's case; of a run, what its control measures */

enum { VS_COLUMN_NAME = 224, VS_COLUMN_UNIT = 48, VS_COLUMN_ROLE = 16 };

/* What a column of a result is. No reader need guess it from the name of one that is told of. */
typedef struct vs_column {
  char name[VS_COLUMN_NAME];     /* as the header has it: "ap_m_s2" */
  char quantity[VS_COLUMN_NAME]; /* without its unit, as options and keys name it: "ap" */
  char unit[VS_COLUMN_UNIT];     /* "" of a pure number, of words, and where it is not known */
  char role[VS_COLUMN_ROLE];     /* "" where it is not known */
  char of[VS_COLUMN_NAME];       /* what has it: of a rate or an acceleration the coordinate, of an
                                    instrument its channel, of a set point the sensor, of a measure its
                                    device or channel, of a probe the section of the scene; "": nothing */
  bool is_guessed;               /* nobody has told of it: what is known follows from its name */
} vs_column;

/* Makes a column of that quantity, whose name joins it and the unit. of NULL is "". */
vs_column vs_channel_column(const char *quantity, const char *unit, const char *role,
                            const char *of);
/* Adds the column's members to the object that is open. */
void vs_channel_column_json(const vs_column *column, vs_json *json);

/* ---- channels ---- */

/* The channels that every machine has: id, name, unit, what has it, text. The last three are in no
 * list: the current drawn from the mains and the loss are for the books of energy, the travel for
 * measures. */
#define VS_CHANNEL_LIST(X)                                                                         \
  X(VS_CH_Z, "z", "m", "actuator", "air gap, D + d + travel")                                      \
  X(VS_CH_LAMBDA, "lambda", "Wb", "actuator", "flux linkage of the coil")                          \
  X(VS_CH_I, "i", "A", "actuator", "current of the coil")                                          \
  X(VS_CH_FORCE, "force", "N", "actuator", "force on the armature")                                \
  X(VS_CH_V_EVA, "v_eva", "V", "actuator", "voltage across the coil")                              \
  X(VS_CH_V_MAINS, "v_mains", "V", "supply", "mains voltage behind its impedance")                 \
  X(VS_CH_I_MAINS, "i_mains", "A", "supply", "current drawn from the mains")                       \
  X(VS_CH_TRAVEL, "travel", "m", "machine", "c.q, by which the gap is opened")                     \
  X(VS_CH_EDDY, "eddy", "W", "actuator", "lost by eddy currents and in the core")

/* A channel's number is its place in the array that vs_step_at fills: first these, then the
 * coordinates q, their rates q' and q", the machine's own probes, and the deck's. In lists and CSV
 * files the coordinates stand first (vs_channel_listed). */
enum {
#define VS_CHANNEL_ID(id, name, unit, of, text) id,
  VS_CHANNEL_LIST(VS_CHANNEL_ID)
#undef VS_CHANNEL_ID
      VS_CH_Q, /* the first coordinate */
  VS_CH_MOST = VS_CH_Q + 3 * VS_MOST_DOF + VS_MACHINE_PROBES + VS_DECK_MOST
};

/* Numbers of the first rate q', the first q", the first probe of the machine, and the first of the
 * deck. */
static inline int vs_channel_rates(const vs_model *model) {
  return VS_CH_Q + model->dof;
}
static inline int vs_channel_rates2(const vs_model *model) {
  return VS_CH_Q + 2 * model->dof;
}
static inline int vs_channel_probes(const vs_model *model) {
  return VS_CH_Q + 3 * model->dof;
}
static inline int vs_channel_deck(const vs_model *model) {
  return vs_channel_probes(model) + model->machine->n_probes;
}

typedef struct vs_channel {
  const char *name, *unit, *text;
  bool listed;           /* in CSV files and lists */
  const char *role, *of; /* of its column */
} vs_channel;

/* How many channels a run has, and the channel with that number; its strings belong to the machine,
 * to the deck or to the program. */
int vs_channel_count(const vs_frame *frame);
vs_channel vs_channel_at(const vs_frame *frame, int number);
/* Writes the numbers of the listed channels in the order of lists, and returns how many there are.
 */
int vs_channel_listed(const vs_frame *frame, int numbers[VS_CH_MOST]);
/* Returns the number of the listed channel of that name, or -1 where there is none. */
int vs_channel_find(const vs_frame *frame, const char *name);
/* True for a name that every machine's channels take. */
bool vs_channel_is_standard(const char *name);

/* Groups of channels that cost time of their own to compute, as bits. All other channels (q,
 * travel, z, lambda, i, force, i_mains) always come along. */
enum {
  VS_GROUP_VELOCITIES = 1,
  VS_GROUP_ACCELERATIONS = 2, /* needs the velocities as well */
  VS_GROUP_V_EVA = 4,
  VS_GROUP_V_MAINS = 8,
  VS_GROUP_DECK = 16,    /* the deck's probes */
  VS_GROUP_MACHINE = 32, /* the machine's own; needs velocities and accelerations as well */
  VS_GROUP_ALL = 63
};
/* Returns the groups that these channels, given by their numbers, belong to. */
unsigned vs_channel_groups(const vs_model *model, const int *channels, int count);
