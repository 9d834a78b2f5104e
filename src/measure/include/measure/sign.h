/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tells a device whose line in the deck has a wrong sign. The power v i of a device is what it
 * takes. So one that cannot store energy, and still gives more than it takes, has the sign of its
 * voltage or of its current wrong. A diode or a thyristor that conducts backwards has both wrong.
 */
#ifndef VS_MEASURE_SIGN_H
#define VS_MEASURE_SIGN_H

#include "measure/reducer.h"

/* True: the device's signs are wrong; text says which. whole_j: the energy of the run, against
 * which a small one says nothing. */
bool vs_sign_is_wrong(const vs_watched *w, double whole_j, char *text, size_t size);

#endif
