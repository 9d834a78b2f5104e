/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is to be warned of in a scene, a deck or a part before any run. */
#pragma once

#include "control/control.h"
#include "measure/instruments.h"
#include "engine/sim.h"

/* A list of warnings, each with the place of what it warns of, if that was written somewhere. Start
 * from {0}. */
typedef struct vs_warnings {
  vs_error *item; /* owned */
  size_t count, capacity;
} vs_warnings;

void vs_warnings_free(vs_warnings *warnings);
/* Adds an empty warning, to be filled by the caller. */
vs_error *vs_warnings_add(vs_warnings *warnings);
/* The message of a warning, without its place unless that is elsewhere than in the scene. */
const char *vs_warnings_text(const vs_error *warning);

/* Adds all that can be warned of in a scene. root: the scene's tree, which knows the places; frame:
 * of the tier that the scene takes. */
void vs_warnings_of_scene(const vs_node *root, const vs_setup *setup, const vs_frame *frame,
                          vs_warnings *warnings);
/* Adds what can be warned of in a scene's control. */
void vs_warnings_of_control(const vs_node *root, const vs_setup *setup, const vs_control *control,
                            const vs_instruments *instruments, vs_warnings *warnings);
/* Adds what can be warned of in a scene's instruments. */
void vs_warnings_of_instruments(const vs_instruments *instruments, vs_warnings *warnings);
/* Adds what the deck's files were found to have that is skipped, changed or misread. */
void vs_warnings_of_netlist(const vs_deck *deck, vs_warnings *warnings);

/* Adds the limits of parts against which nothing of the deck, or of the part's file, is held; the
 * first eight. */
void vs_warnings_of_limits(const vs_deck *deck, vs_warnings *warnings);
/* What is to be said of a deck without the port mains. NULL: it has one, or its ports could not be
 * read. */
const char *vs_warnings_without_mains(const vs_deck *deck);

/* The first instant before until_s at which a pulse at a gate of the scene meets mains that can
 * fire something; INFINITY: no pulse does; NaN: nothing is driven by a gate. */
double vs_warnings_first_chance(const vs_setup *setup, const vs_frame *frame, double until_s);
/* What a check and a run say where that is INFINITY; a part of a sentence. */
const char *vs_warnings_no_chance(const vs_frame *frame);
