/* SPDX-License-Identifier: GPL-3.0-or-later
 * Putting an event into the deck: lines of the netlist, a source that the event drives, and the
 * account of what the event takes. Names of nodes and elements that events add begin with "vs_"
 * and end with the event's index, so that two events never share one.
 *
 * Errors have the event's place. */
#pragma once

#include "engine/scene_event.h"

/* Adds a line to the netlist, formatted as printf does. */
void vs_wiring_line(vs_deck *deck, vs_where where, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds the source vvs_e<index> between two nodes, driven by the event. Error: too many ports. */
vs_status vs_wiring_source(vs_deck *deck, const vs_scene_event *e, size_t index, const char *plus,
                           const char *minus, vs_error *err);

/* Adds the source vvs_w<index> from node vs_w<index> to ground: 1 V once the event's network is to
 * lie on the line, before that 0 V. Error: too many ports. */
vs_status vs_wiring_on_line(vs_deck *deck, const vs_scene_event *e, size_t index, vs_error *err);

/* Adds a line of the contract ("*$ loss ..."). */
vs_status vs_wiring_account(vs_deck *deck, const vs_scene_event *e, const char *line,
                            vs_error *err);

/* Accounts for what goes into the event as a loss in the event's name, negative where the event
 * delivers energy: the voltage `between` its two nodes ("a,b") times the current of source
 * vvs_s<index>, which the caller adds. */
vs_status vs_wiring_loss(vs_deck *deck, const vs_scene_event *e, size_t index, const char *between,
                         vs_error *err);

/* An element of two nodes, of which `value` is what stands behind them in its line. inner: where it
 * is cut off, the node in the place of the first one; else NULL. past: the source of the current
 * through the event, from the first node on. */
typedef struct vs_wiring_element {
  const char *name, *node[2], *value, *inner, *past;
} vs_wiring_element;

/* Warns of the lines of the contract that reckon with an element's voltage and a parameter of its
 * value, as the current v(a,b)/{r1} of R1: once the event has begun, these do not give the current
 * any more. What is held against limits of such devices is then not known. Losses and stores are
 * mended instead where it is known how, so that the books close. */
void vs_wiring_doubt(vs_deck *deck, const vs_scene_event *e, const vs_wiring_element *element);
