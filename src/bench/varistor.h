/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a varistor, tried. */
#ifndef VS_BENCH_VARISTOR_H
#define VS_BENCH_VARISTOR_H

#include "figures.h"

/* Its voltage at three currents. */
extern const vs_figures_kind vs_varistor_kind;

#endif
