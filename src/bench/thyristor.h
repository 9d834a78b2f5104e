/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a thyristor, tried. */
#ifndef VS_BENCH_THYRISTOR_H
#define VS_BENCH_THYRISTOR_H

#include "figures.h"

/* V_T, I_GT, V_GT, I_L, I_H, dv/dt, t_q, Q_rr, and how fast the model turns on. */
extern const vs_figures_kind vs_thyristor_kind;

#endif
