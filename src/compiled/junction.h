/* SPDX-License-Identifier: GPL-3.0-or-later
 * Diodes and bipolar transistors, by ngspice's own equations at 27 degC (its manual, chapters 7 and
 * 8; src/spicelib/devices/dio and bjt), as far as the shipped parts use them. */
#pragma once

#include <stdbool.h>

#include "parameters.h"

/* k T/q at 27 degC, V, of the constants that ngspice 39 has (CODATA 2014). A thyristor that lets go
 * makes 3e-4 of its current of the 3e-7 that today's are beside them. */
#define VS_JUNCTION_VT 0.025864917007157463
#define VS_JUNCTION_GMIN 1e-12 /* S, across every junction */

/* A diode's model. */
typedef struct vs_diode {
  double saturation_a, n; /* is, n */
  double breakdown_v;     /* bv, as the solver corrects it for ibv; INFINITY: none */
  double nbv;
  double resistance_ohm; /* rs */
  double transit_s;      /* tt */
} vs_diode;

/* Reads a .model of the type d. Errors: a parameter that is not known here. */
vs_status vs_junction_diode(const vs_cards *cards, vs_parameters *in, const vs_netlist_card *model,
                            vs_diode *diode, vs_error *err);

/* The current at v, A, with gmin; *slope: its conductance, S. */
double vs_junction_current(const vs_diode *d, double v, double *slope);

/* A voltage for the next iteration of Newton's that goes no further from `before` to v than the
 * junction's exponential allows (Nagel's pnjlim). */
double vs_junction_limit(const vs_diode *d, double v, double before);

/* A transistor's model: forward and reverse gains, Early's voltage. */
typedef struct vs_bipolar {
  vs_diode junction; /* of both junctions */
  double forward, reverse;
  double early_v; /* vaf; INFINITY: none */
  double way;     /* +1: npn, -1: pnp */
} vs_bipolar;

vs_status vs_junction_bipolar(const vs_cards *cards, vs_parameters *in,
                              const vs_netlist_card *model, vs_bipolar *bipolar, vs_error *err);

/* The currents into collector and base, A, for an npn at vbe and vbc; dc, db: their slopes by vbe
 * and vbc. */
void vs_junction_transistor(const vs_bipolar *q, double vbe, double vbc, double *ic, double *ib,
                            double dc[2], double db[2]);

/* A power MOSFET's model, type vdmos (its manual, section 11.3): a channel of square law with a
 * smooth threshold, a constant capacitance at the gate, one that falls with the voltage between
 * gate and drain, and a body diode. */
typedef struct vs_vdmos {
  double vto_v, kp, lambda, subthreshold_v; /* V, A/V^2, 1/V, V */
  double cgs_f, cgd_min_f, cgd_max_f, a;    /* F, F, F, 1/V */
  double cjo_f, vj_v, m;                    /* of the body diode's depletion layer */
  vs_diode body;
} vs_vdmos;

vs_status vs_junction_vdmos(const vs_cards *cards, vs_parameters *in, const vs_netlist_card *model,
                            vs_vdmos *mosfet, vs_error *err);

/* The current from drain to source through the channel, A; slope: by vgs and by vds. */
double vs_junction_channel(const vs_vdmos *q, double vgs, double vds, double slope[2]);

/* The charge between gate and drain, C, at vgd, and that of the body diode at vsd; *capacitance:
 * its slope, F. */
double vs_junction_gate_charge(const vs_vdmos *q, double vgd, double *capacitance);
double vs_junction_body_charge(const vs_vdmos *q, double vsd, double *capacitance);
