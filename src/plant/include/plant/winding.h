/* SPDX-License-Identifier: GPL-3.0-or-later
 * How warm the coil's winding becomes: winding, core and ambient, with a thermal resistance between
 * each two and a heat capacity of each of the first two. */
#pragma once

#include "plant/values.h"

typedef struct vs_winding_state {
  double winding_degc, core_degc;
  bool settled; /* the losses keep these temperatures */
} vs_winding_state;

/* Beyond what any winding bears, degC. */
enum { VS_WINDING_BURNT_DEGC = 500 };
/* The coil's resistance at this temperature, ohm, from that at 20 degC. */
double vs_winding_ohm(const vs_winding_values *winding, double cold_ohm, double t_degc);
/* Where it begins: the winding at its own temperature, the core between that and the ambient. */
vs_winding_state vs_winding_begin(const vs_winding_values *winding);
/* Goes on by a time with constant losses, W. Without capacities nothing changes. */
void vs_winding_go(const vs_winding_values *winding, double copper_w, double core_w, double by_s,
                   vs_winding_state *state);
/* The shorter of its time constants, s; 0: there is none. */
double vs_winding_fastest(const vs_winding_values *winding);
