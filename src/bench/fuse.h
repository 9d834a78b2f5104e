/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a fuse, tried. */
#ifndef VS_BENCH_FUSE_H
#define VS_BENCH_FUSE_H

#include "figures.h"

/* Resistance, melting I2t, least melting current, clearing I2t, arc voltage. */
extern const vs_figures_kind vs_fuse_kind;

#endif
