/* SPDX-License-Identifier: GPL-3.0-or-later
 * The seam of the laws of control. A regulator is shown what the instruments show, at every tick of
 * the control's clock, and is asked for the angle of each firing at the beginning of that firing's
 * cycle. It knows nothing else of the run, and is the same for every tier.
 *
 * A new one is a file with a constant struct, a line in control/regulators.h and a row in
 * control/regulators.c. */
#pragma once

#include <math.h>

#include "control/state_observer.h"
#include "measure/lowpass.h"

/* The keys of all regulators; each reads only those that its fields name. */
typedef struct vs_control_values {
  char law[VS_NAME_SIZE];
  double rate_hz;      /* of the control's clock */
  double angle_rad[2]; /* the least and the largest that is fired at */
  char sensor[VS_NAME_SIZE];
  vs_field_profile setpoint; /* in the sensor's unit, SI */
  double gain;               /* rad per sensor's unit */
  double integral;           /* rad per sensor's unit and s */
  double sensor_gain;        /* NaN: that of its low-pass where the machine works */
  double phase_rad;
  double threshold;                               /* in the sensor's unit, SI */
  char file[VS_NAME_SIZE], command[VS_NAME_SIZE]; /* a law of the user's own */
  char connect[VS_NAME_SIZE], output[VS_NAME_SIZE];
  double timeout_s;
} vs_control_values;

/* What a regulator is shown. Values are in SI. */
typedef struct vs_control_input {
  const vs_control_values *v;
  const vs_setup *setup; /* of the run; constant */
  const vs_instruments *instruments;
  const vs_state_observer *observing; /* whose estimates there are */
  const double *value; /* of the instruments' last samples, in their order, then of the estimates;
                          NaN: none */
  int sensor;          /* the number of v->sensor among them; -1: none is named */
  vs_where where;      /* of the key that names code, for a regulator that has one */
  double t_s;          /* now */
  long firing;         /* that is to be decided, from 0 */
  double last_rad;     /* angle of the firing before it; NaN: there was none */
} vs_control_input;

/* How a regulator answers to a sensor's amplitude m, half of what its samples go up and down by
 * from decision to decision, in the sensor's unit, SI: angle = start + proportional (m - wanted) +
 * integral (sum of m - wanted, this firing's included)
 */
typedef struct vs_regulator_pi {
  double wanted, start_rad, proportional, integral;
} vs_regulator_pi;

enum { VS_REGULATOR_OUTPUTS = 4 };

/* A number that a regulator shows of itself, as a column of run.csv. */
typedef struct vs_regulator_output {
  const char *name, *unit; /* a unit of "~" is the sensor's */
  bool set_point;          /* what the sensor shall show, not what it is taken to show */
} vs_regulator_output;

typedef struct vs_regulator {
  const char *name, *text;
  /* Its keys besides the common ones; they fill a vs_control_values. A unit may have "~" for the
   * sensor's. */
  const vs_field *fields;
  size_t n_fields;
  bool senses;                                       /* it has the key `sensor` */
  vs_regulator_output outputs[VS_REGULATOR_OUTPUTS]; /* up to the first without a name */
  size_t size;                                       /* of its state, bytes; begins as zeros */
  const char *code; /* its key that names code of the user's own, which runs only where the command
                       line allows it; NULL: it has none */
  /* Each may be NULL but `decide`. */
  /* Looks at the key `code`, which stands at `where`, without running what it names. */
  vs_status (*check)(const vs_control_values *v, vs_where where, vs_error *err);
  /* Writes the path of the k-th file, from 0, whose contents make the law. False: it is none. */
  bool (*file)(const vs_control_values *v, vs_where where, int k, char path[VS_PATH_SIZE]);
  vs_status (*begin)(void *self, const vs_control_input *sight, vs_error *err);
  void (*tick)(void *self, const vs_control_input *sight);
  /* Sets the angle of firing number sight->firing, rad; NaN: it is left out. What lies beyond
   * v->angle_rad becomes its nearer end. An error ends the run. */
  vs_status (*decide)(void *self, const vs_control_input *sight, double *angle_rad, vs_error *err);
  double (*output)(const void *self, int k);
  void (*end)(void *self);
  /* For those that are a PI controller of an amplitude, within the limits of the angle;
   * sight->value is not there. NULL: it is none, and its closed loop is not told
   * (orbit/closed_loop.h). */
  vs_regulator_pi (*pi)(const vs_control_input *sight);
} vs_regulator;

/* The low-pass of the one that is named; none of an estimate, which comes at once. */
static inline vs_lowpass vs_regulator_lowpass(const vs_control_input *s) {
  if (s->sensor >= s->instruments->count) return vs_lowpass_make(NAN, 1, 1);
  const vs_instrument_values *v = &s->instruments->item[s->sensor].v;
  return vs_lowpass_make(v->bandwidth_hz, v->order, v->damping);
}
