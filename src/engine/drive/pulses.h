/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of events at the gate: a pulse that is missing, short, weak, or one too many. */
#ifndef VS_ENGINE_PULSES_H
#define VS_ENGINE_PULSES_H

#include "engine/occurrence.h"

/* The kinds; the last row has no name. A new kind is one row of this table, with its keys and
 * functions above it in pulses.c. */
extern const vs_event_kind vs_pulses[];

#endif
