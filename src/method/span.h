/* SPDX-License-Identifier: GPL-3.0-or-later
 * Where an axis can be, as a number within 0..1 and as a number in the axis' unit. What stands
 * under `spread`:
 *
 *   KEY: 5 % normal                   standard deviation, of what the scene has
 *   KEY: 5 % normal within 2 sigma    cut off there
 *   KEY: 2 ohm uniform                half width, about what the scene has
 *   KEY: {from: 90 deg, to: 150 deg}  even between (or {log: [a, b]}: in the logarithm)
 *   KEY: [a, b, c]                    each as likely as the others */
#ifndef VS_METHOD_SPAN_H
#define VS_METHOD_SPAN_H

#include "method/random.h"
#include "study/plan.h"

/* What is kept of one, as the axis' `own`: in its unit, about its nominal value. */
typedef struct vs_span {
  vs_spread spread;
  double reach; /* how far corners and searches go from the nominal value */
} vs_span;

/* Reads it. sigmas: the reach of a normal one that is not cut off. Errors with their place: what it
 * may say; a value that is 0, a word or unknown; one beyond the key's range, within the reach. */
vs_status vs_span_read(vs_axis *axis, const vs_node *node, double sigmas, vs_error *err);

/* How many values it has; 0: a continuum. */
size_t vs_span_levels(const vs_axis *axis);
/* The value below which the part u of all lies; 0 < u < 1. Of a list or a range: evenly. */
double vs_span_at(const vs_axis *axis, double u);
/* The value at u of 0..1 of the way, by its whole reach. */
double vs_span_between(const vs_axis *axis, double u);
/* What the scene has; of a word, and where it has none, the first value. */
double vs_span_nominal(const vs_axis *axis);

#endif
