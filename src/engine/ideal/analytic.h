/* SPDX-License-Identifier: GPL-3.0-or-later
 * The tier "analytic": the paper's own simulation. analytic.c says which equations it solves. */
#ifndef VS_ENGINE_ANALYTIC_H
#define VS_ENGINE_ANALYTIC_H

#include "engine/sim.h"

extern const vs_tier vs_analytic_tier;

#endif
