/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which names a machine and a deck must not give to what they show: those that are taken already.
 */
#ifndef VS_ENGINE_NAMING_H
#define VS_ENGINE_NAMING_H

#include "base/error.h"
#include "netlist/deck.h"
#include "plant/model.h"

/* Error, where it stands: a coordinate, a rate or a probe of the machine has the name of a channel
 * that every machine has. A check carries on. */
vs_status vs_naming_machine(const vs_machine *machine, vs_error *err);

/* Error, where it stands: a probe of the deck has the name of a channel that every tier has, or of
 * the machine's, or of the time; or two channels would have one column in a run's table. A check
 * carries on. */
vs_status vs_naming_deck(const vs_model *model, const vs_deck *deck, vs_error *err);

#endif
