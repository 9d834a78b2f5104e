/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the sources of a deck are told to be: ports, the mains' terminals, and what each source
 * gives to the circuit, for the energy audit. */
#ifndef VS_IMPORT_FEEDS_H
#define VS_IMPORT_FEEDS_H

#include "fate.h"

/* Adds the lines to fate->sheet. */
void vs_feeds_add(vs_fate *fate);

#endif
