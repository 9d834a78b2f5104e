/* SPDX-License-Identifier: GPL-3.0-or-later
 * The seam of the laws of control. A regulator is shown what the instruments show, at every tick of
 * the control's clock, and is asked for the angle of each firing at the beginning of that firing's
 * cycle. It knows nothing else of the run, and is the same for every tier.
 *
 * A new one is a file with a constant struct, and a row in control/regulators.c. */
#ifndef VS_CONTROL_REGULATOR_H
#define VS_CONTROL_REGULATOR_H

#include "instrument/instruments.h"

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
  double threshold; /* in the sensor's unit, SI */
} vs_control_values;

/* What a regulator is shown. Values are in SI. */
typedef struct vs_sight {
  const vs_control_values *v;
  const vs_setup *setup; /* of the run; constant */
  const vs_instruments *instruments;
  const double *value; /* of the instruments' last samples, in their order; NaN: none */
  int sensor;          /* the number of v->sensor among them; -1: none is named */
  double t_s;          /* now */
  long firing;         /* that is to be decided, from 0 */
  double last_rad;     /* angle of the firing before it; NaN: there was none */
} vs_sight;

enum { VS_REGULATOR_OUTPUTS = 4 };

/* A number that a regulator shows of itself, as a column of run.csv. */
typedef struct vs_regulator_output {
  const char *name, *unit; /* a unit of "~" is the sensor's */
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
  /* Each may be NULL but `decide`. */
  vs_status (*begin)(void *self, const vs_sight *sight, vs_error *err);
  void (*tick)(void *self, const vs_sight *sight);
  /* Sets the angle of firing number sight->firing, rad; NaN: it is left out. What lies beyond
   * v->angle_rad becomes its nearer end. An error ends the run. */
  vs_status (*decide)(void *self, const vs_sight *sight, double *angle_rad, vs_error *err);
  double (*output)(const void *self, int k);
  void (*end)(void *self);
} vs_regulator;

#endif
