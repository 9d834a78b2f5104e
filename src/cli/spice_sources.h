/* SPDX-License-Identifier: GPL-3.0-or-later
 * The signals of a deck's ports as sources of plain ngspice, for `export`. */
#ifndef VS_CLI_SPICE_SOURCES_H
#define VS_CLI_SPICE_SOURCES_H

#include "base/text.h"
#include "engine/timeline.h"
#include "netlist/deck.h"

/* Errors, VS_INPUT, of what such sources cannot say: an angle that changes over time; sub-pulses
 * that do not fit into the time between gate pulses; more edges of modulated pulses up to until_s
 * than a netlist should have. */
vs_status vs_spice_sources_check(const vs_timeline *timeline, const vs_deck *deck, double until_s,
                                 vs_error *err);

/* Writes the .param lines that the sources of gates use: instants of the pulses, as engine/gate.h
 * has them, from the scene's parameters vs_angle, vs_pulse, vs_first, vs_every, ...; and vs_fired,
 * when the first pulse of the deck's gates begins that does not end before t = 0. */
void vs_spice_sources_timing(vs_text *text, const vs_timeline *timeline, const vs_deck *deck);

/* A voltage source of the deck. */
typedef struct vs_spice_sources_source {
  const char *name, *plus, *minus; /* it and its nodes */
  const vs_signal *signal;         /* what drives it */
} vs_spice_sources_source;

/* Writes the source with that signal up to until_s. */
void vs_spice_sources_write(vs_text *text, const vs_spice_sources_source *source,
                            const vs_timeline *timeline, double until_s);

#endif
