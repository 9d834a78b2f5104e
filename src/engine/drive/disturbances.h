/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of events that disturb the mains: sag, swell, interruption, notch, jump of phase,
 * harmonic. */
#ifndef VS_ENGINE_DISTURBANCES_H
#define VS_ENGINE_DISTURBANCES_H

#include "engine/occurrence.h"

/* The kinds; the last row has no name. A new kind is one row of this table, with its keys and
 * functions above it in disturbances.c. */
extern const vs_event_kind vs_disturbances[];

#endif
