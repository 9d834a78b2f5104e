/* SPDX-License-Identifier: GPL-3.0-or-later
 * Lines .model as PSpice and LTspice write them. */
#ifndef VS_NETLIST_MODELS_H
#define VS_NETLIST_MODELS_H

#include "dialect/rewriting.h"

/* Leaves out ratings that a model tells besides (mfg, Vpk, ...), and tells it. Errors with their
 * place: what ngspice takes no notice of, or does not know, unless it reads PSpice's dialect; an
 * ideal diode of LTspice's. */
vs_status vs_models_rewrite(vs_rewriting *r);

#endif
