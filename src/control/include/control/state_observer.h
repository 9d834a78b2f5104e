/* SPDX-License-Identifier: GPL-3.0-or-later
 * The key `observer` of a scene's section `control`: which motion a control is told of that no
 * instrument shows. An observer computes the machine's motion along with the run, from the measured
 * current, and corrects it by what some instruments show; control/estimator.h does so in a run.
 *
 *   observer: {kind: luenberger, sensors: [p, ap], poles: [-200, [-150, 300], [-150, -300], ...]}
 *   observer: {kind: kalman, sensors: [p, ap], force_noise: 1 N}
 *
 * Of the sampled system x(k+1) = A x(k) + ... with the sensors y = C x + ... the estimate is
 * corrected by L (y - C x), so that its error e goes on as e(k+1) = (I - L C) A e(k). Its poles s,
 * 1/s, are those for which exp(s T) is an eigenvalue of (I - L C) A. */
#pragma once

#include "base/field.h"
#include "control/sampled_system.h"

/* The values of the keys that not all kinds of observers have. */
typedef struct vs_gain_values {
  double force_noise_n; /* kalman: by how much F is wrong, root mean square in each period */
  double spread; /* kalman: what other forces add to each coordinate's rate, as a part of what the
                    force noise adds to all rates, by energy */
} vs_gain_values;

/* The words of the kinds, in the order of their rows (state_observer.c). */
#define VS_GAIN_WORDS "kalman|luenberger"

typedef struct vs_state_observer_values {
  int kind;                   /* which of the kinds, in the order of VS_GAIN_WORDS */
  char current[VS_NAME_SIZE]; /* the instrument that measures the coil's current; "auto" */
  vs_gain_values gain;
  int knows_start; /* 1: the estimate begins where the run begins; 0: at rest */
} vs_state_observer_values;

/* What is estimated, as a column of run.csv. */
typedef struct vs_estimated {
  char column[VS_MACHINE_NAME + 8]; /* "NAME_est" */
  const char *of, *unit;            /* the coordinate or its rate, borrowed from the machine */
} vs_estimated;

/* Start from {0}; vs_state_observer_free at the end, also after an error. Constant once it is read.
 */
typedef struct vs_state_observer {
  vs_state_observer_values v;
  vs_sampled_system *system;                    /* owned; NULL: the scene has no observer */
  const vs_instrument *current;                 /* borrowed */
  int of_current, of_sensor[VS_SENSOR_MOST];    /* their numbers among the scene's instruments */
  double gain[VS_SAMPLED_MOST][VS_SENSOR_MOST]; /* L; [state][sensor] */
  vs_pole pole[VS_SAMPLED_MOST]; /* of the error, system->states of them, the slowest first */
  vs_estimated estimate[VS_MOST_STATES]; /* of q, then of q' */
  int estimates;                         /* how many there are; 0 without an observer */
  double settling_s; /* until a hundredth of the slowest part of an error is left */
} vs_state_observer;

/* Its keys that are one value, with their units; and the key that it stands under, with all below.
 */
extern const vs_section vs_state_observer_section;
extern const vs_field vs_state_observer_key;

/* Reads the key's map and finds the gain. model: of the scene; rate_hz: of the control.
 * Errors: an instrument that is none, or that shows no motion; none for the current; sensors that
 * depend on each other, or that do not see a mode; poles that are not as many as wanted, not a
 * conjugate set, do not decay, are beyond what the rate allows, stand too often, or cannot be
 * reached; and what any key can be wrong in. */
vs_status vs_state_observer_read(const vs_node *map, const vs_model *model,
                                 const vs_instruments *instruments, double rate_hz,
                                 vs_state_observer *observing, vs_error *err);
/* Writes what whoever runs the scene should know of its observer. NULL: nothing. */
const char *vs_state_observer_note(const vs_state_observer *observing, const vs_setup *setup,
                                   char *text, size_t size);
void vs_state_observer_free(vs_state_observer *observing);
