/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law "moving_coil": a coil that moves in the field of a magnet, as in a shaker or a loudspeaker.
 */
#ifndef VS_PLANT_MOVING_COIL_H
#define VS_PLANT_MOVING_COIL_H

#include "plant/law.h"

extern const vs_law vs_moving_coil_law;

#endif
