/* SPDX-License-Identifier: GPL-3.0-or-later
 * The course of a source over time, from its line: SIN, PULSE or PWL. */
#pragma once

#include "import/elements.h"

/* SIN(offset amplitude frequency delay damping phase cycles); only LTspice has the last number */
typedef struct vs_course_sine {
  double offset_v, peak_v, hz, delay_s, damping, phase_deg;
  double cycles; /* it ends after so many; INFINITY: it does not */
} vs_course_sine;

/* A pulse, from PULSE or from PWL. */
typedef struct vs_course_pulse {
  double low, high;      /* V, or A of a current source */
  double at_s, width_s;  /* when it begins to rise, and from then until it begins to fall */
  double rise_s, fall_s; /* how long its edges take */
  double period_s;       /* INFINITY: it comes once */
  double cycles;         /* how often it repeats if it has a period; INFINITY: without end */
} vs_course_pulse;

/* True for a source (V or I) with this word, such as SIN, PULSE or PWL, even where its numbers are
 * not known. */
bool vs_course_has(const vs_element *source, const char *word);

/* Reads the source's SIN or SINE. Error, with its place: it has none, or one of its numbers is not
 * known before a run. */
vs_status vs_course_read_sine(const vs_elements *wiring, const vs_values *values,
                              const vs_element *source, vs_course_sine *sine, vs_error *err);

/* Reads the source's PULSE or PWL, or a direct voltage as a pulse without times: at_s and width_s
 * are NaN then. Errors as above. */
vs_status vs_course_read_pulse(const vs_elements *wiring, const vs_values *values,
                               const vs_element *source, vs_course_pulse *pulse, vs_error *err);

/* True for a source that is 0 at t = 0, as far as can be told before a run. */
bool vs_course_begins_at_0(const vs_elements *wiring, const vs_values *values,
                           const vs_element *source);
