/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which values an axis can have, as a number u within 0..1 and as a number in the axis' unit. Under
 * `spread` a study says:
 *
 *   KEY: 5 % normal                   the standard deviation, as a share of what the scene has
 *   KEY: 5 % normal within 2 sigma    the same, cut off there
 *   KEY: 2 ohm uniform                half the width, about what the scene has
 *   KEY: -20 % .. 5 %                 even between these, in per cent of what the scene has
 *   KEY: tolerance and ageing         even between what the part's file states (run/keys.h)
 *   KEY: 90 deg .. 150 deg            even between these, as {from: A, to: B} (with {log: [a, b]},
 *                                     in the logarithm)
 *   KEY: [a, b, c]                    each as likely as the others
 *
 * Instead of a key a kind of device may stand: `varistor: 10 % uniform` is each varistor by itself.
 */
#pragma once

#include "study/plan.h"
#include "study/random.h"

/* A spread that has a shape. It is the axis' `own`; it is in the axis' unit and about its nominal
 * value. Of a range or a list the axis' `own` is NULL. */
typedef struct vs_span {
  vs_spread spread;
  double reach; /* how far corners and searches go from the nominal value */
} vs_span;

/* Adds the axes of a map of spreads. by: the study's key it stands under. sigmas is how far corners
 * and searches go, in standard deviations, where a normal spread is not cut off. Errors, with their
 * place: those of vs_plan_axis; a spread says nothing of the above; the nominal value is a word,
 * not known, or 0 where a share of it is asked for; the reach goes beyond the key's range; no
 * device of a kind has a key. */
vs_status vs_span_read_map(vs_plan *plan, const vs_node *map, const char *by, double sigmas,
                           vs_error *err);

/* Returns how many values the axis has; 0: it is a continuum. */
size_t vs_span_levels(const vs_axis *axis);
/* Returns the value below which the share u of all lies; 0 < u < 1. Ranges and lists are even. */
double vs_span_at(const vs_axis *axis, double u);
/* Returns the value at the share u, 0..1, of the way from one end of the reach to the other. */
double vs_span_between(const vs_axis *axis, double u);
/* Returns what the scene has; of a word, and where the scene has nothing, the first value. */
double vs_span_nominal(const vs_axis *axis);
/* Returns the period of what repeats along an instant or an angle of the mains, as a part of the
 * axis: of the gate pulse's sub-pulses, of the carrier of pulse-width modulation, else the mains'
 * cycle. Worst cases repeat with it. 0: nothing repeats, or the axis is shorter than two periods.
 */
double vs_span_period(const vs_plan *plan, const vs_axis *axis);
