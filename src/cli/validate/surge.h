/* SPDX-License-Identifier: GPL-3.0-or-later
 * Comparisons: generators against the standards they are made for, the surge into a varistor,
 * varistor laws, and the I2t of a half sine. */
#ifndef VS_CLI_SURGE_H
#define VS_CLI_SURGE_H

#include "validate/experiment.h"

extern const vs_comparisons vs_surge_comparisons;

#endif
