/* SPDX-License-Identifier: GPL-3.0-or-later
 * Declares the sources of a deck: the ports, the mains' terminals, and for the energy audit what
 * each source delivers to the circuit. */
#ifndef VS_IMPORT_FEEDS_H
#define VS_IMPORT_FEEDS_H

#include "fate.h"

/* Adds the lines to fate->sheet. */
void vs_feeds_add(vs_fate *fate);

#endif
