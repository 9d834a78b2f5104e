/* SPDX-License-Identifier: GPL-3.0-or-later
 * Events that are circuits of their own (drive/events.h has their table): generators that couple
 * into the deck's line, and switches that open or short one of its elements. */
#ifndef VS_DRIVE_FAULTS_H
#define VS_DRIVE_FAULTS_H

#include "deck/deck.h"
#include "drive/events.h"

/* Surge 1.2/50-8/20 us, 2 ohm (IEC 61000-4-5): a capacitor of 5.9302 uF, charged to 1.06044 of the
 * level, beside 20.154 ohm; then 10.871 uH and 0.81412 ohm to the output, across which lie 26.151
 * ohm; 18 uF to the line. The charge comes as a step of the voltage below the capacitor. */
double vs_faults_surge_source(const vs_occurrence *e, double t_s);
double vs_faults_surge_longest(const vs_occurrence *e, double t_s);
vs_status vs_faults_surge_wire(const vs_occurrence *e, size_t index, vs_deck *deck, vs_error *err);

/* Ring wave 0.5 us - 100 kHz (IEEE C62.41): 1.590 V (1 - exp(-t/0.533 us)) exp(-t/9.788 us)
 * cos(2 pi 100 kHz t) behind its impedance; 18 uF to the line (assumed). */
double vs_faults_ring_source(const vs_occurrence *e, double t_s);
double vs_faults_ring_longest(const vs_occurrence *e, double t_s);
vs_status vs_faults_ring_wire(const vs_occurrence *e, size_t index, vs_deck *deck, vs_error *err);

/* Burst of 5/50 ns pulses (IEC 61000-4-4): by the equation of the pulse that the standard has,
 * behind 50 ohm; 33 nF to the line. */
double vs_faults_eft_source(const vs_occurrence *e, double t_s);
double vs_faults_eft_edge(const vs_occurrence *e, double t_s);
double vs_faults_eft_longest(const vs_occurrence *e, double t_s);
vs_status vs_faults_eft_wire(const vs_occurrence *e, size_t index, vs_deck *deck, vs_error *err);

/* A switch of 1 mohm and 1 Gohm in series with an element, or across it. In series it arcs as it
 * opens: i = 1 A (v/level)^30, straight above, beside 100 pF. */
double vs_faults_source(const vs_occurrence *e, double t_s);
vs_status vs_faults_open_wire(const vs_occurrence *e, size_t index, vs_deck *deck, vs_error *err);
vs_status vs_faults_short_wire(const vs_occurrence *e, size_t index, vs_deck *deck, vs_error *err);

vs_status vs_faults_turns_wire(const vs_occurrence *e, size_t index, vs_deck *deck, vs_error *err);

#endif
