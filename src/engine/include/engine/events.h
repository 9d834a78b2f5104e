/* SPDX-License-Identifier: GPL-3.0-or-later
 * The events of a scene: all the kinds there are, reading the scene's section `events`, and putting
 * those that are circuits into the deck. The section is a map of names; each event says its kind
 * and the keys of that kind.
 *
 * A new kind is a row of the table in one of the four files of kinds (generators.c, disturbances.c,
 * pulses.c, faults.c) and nothing else; a fifth such file is one row of the table in events.c. */
#pragma once

#include "base/error.h"
#include "engine/timeline.h"

/* The kinds by their number, from 0, in the order in which they are listed; NULL behind the last.
 */
const vs_event_kind *vs_events_kind(size_t number);

/* The kind of that name; NULL: there is none. */
const vs_event_kind *vs_events_find(const char *name);

/* Reads the section (NULL: there is none) into *events. until_s is the end of the run; an event
 * that begins there or later is not built. Errors, each of which a check carries on from: an
 * unknown kind or key, a level its generator does not have, a generator that comes onto the line
 * behind its wave or more than once in the run, a gate pulse that is not there or is shorter
 * already, an element that is not said, a repetition that overlaps itself, two events that
 * contradict each other. */
vs_status vs_events_read(const vs_node *map, const vs_timeline *timeline, double until_s,
                         vs_events *events, vs_error *err);

/* Puts events that are circuits into the deck. Errors, each of which a check carries on from: a
 * gate that the deck has not, two events that change one element, and what a kind's `wire` refuses.
 */
vs_status vs_events_wire(const vs_events *events, vs_deck *deck, vs_error *err);

/* The first instant after t that some event wants to be the end of a step; INFINITY: none. */
double vs_events_edge(const vs_events *events, double t_s);

/* The longest step from t on that all events allow, s; INFINITY: any. */
double vs_events_longest(const vs_events *events, double t_s);
