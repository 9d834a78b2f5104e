/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of events that are generators of a standard, coupled to the deck's line ('*$ line NODE
 * NODE'): surge, ring wave, fast transients. Several may come together, and closer than their waves
 * last: each is one of its own, with a network of its own on the line, which loads the others'
 * waves; a run warns of that (run/warnings.c). */
#ifndef VS_ENGINE_GENERATORS_H
#define VS_ENGINE_GENERATORS_H

#include "engine/occurrence.h"

/* The kinds; the last row has no name. A new kind is one row of this table, with its keys and
 * functions above it in generators.c. */
extern const vs_event_kind vs_generators[];

/* The open-circuit voltages of two of them at t, V, for those who measure the waves (`validate`).
 * Of the event only v and start_s matter. */

/* Ring wave 0.5 us - 100 kHz (IEEE C62.41), per volt of its level: 1.590 (1 - exp(-t/0.533 us))
 * exp(-t/9.788 us) cos(2 pi 100 kHz t). */
double vs_generators_ring_source(const vs_occurrence *e, double t_s);

/* Burst of 5/50 ns pulses (IEC 61000-4-4), by the equation of the pulse that the standard gives. */
double vs_generators_eft_source(const vs_occurrence *e, double t_s);

/* The beginning of the burst's first pulse after t; INFINITY: none. For tests. */
double vs_generators_eft_edge(const vs_occurrence *e, double t_s);

#endif
