/* SPDX-License-Identifier: GPL-3.0-or-later
 * The netlist contract: the lines of an ngspice netlist that begin with "*$". ngspice takes them
 * for comments; the program reads from them what it must know of the netlist.
 *
 *   *$ title  TEXT
 *   *$ param  NAME = VALUE UNIT  MIN..MAX [assumed | typical] "TEXT"
 *       becomes .param NAME, and the scene's key circuit.NAME
 *   *$ param  NAME = PART part [KIND] "TEXT"
 *       a part by name: its file, or its row of a table (netlist/catalogue.h), is included, and
 *       subcircuit NAME in the deck means the part's. A part DEVICE_part says what the device
 *       DEVICE is, for its limits. A scene may give that key to a resistor or capacitor whose deck
 *       has no such line
 *   *$ port   mains = SOURCE
 *       "SOURCE n m external" has the mains' voltage
 *   *$ port   gate[+ANGLE] = SOURCE
 *       1 V while the (delayed) gate pulse is there
 *   *$ port   burst[+ANGLE] = SOURCE
 *       1 V during each of the sub-pulses of the gate pulse
 *   *$ line   NODE [NODE]
 *       the mains' terminals, where surges couple in
 *   *$ earth  NODE
 *       the protective earth, which generators may be coupled to
 *   *$ probe  NAME = [-]v(n) | v(n,m) | i(Vx)  UNIT  "TEXT"
 *       a channel; the one called i_thyristor is the anode current
 *   *$ loss   NAME = FORMULA
 *       power that leaves the circuit, W
 *   *$ store  NAME = FORMULA
 *       energy held in the circuit, J
 *   *$ rating PROBE MIN..MAX UNIT  "TEXT"
 *       allowed for a probe; enters the verdict. Each end is a number or a limit of a part, as
 *       -thyristor.v_rrm. An end of 0 says which sign the probe may have, and is no margin while it
 *       is kept
 *   *$ require A <= B  "TEXT"
 *       a condition between parameters (or A < B)
 *   *$ device NAME [PART or KIND] [PORT]... [protects DEVICE] = FORMULA, FORMULA [, FORMULA]
 *             "TEXT"
 *       its voltage and current, and (of a gate drive) its core's flux linkage, V.s. Its measures
 *       are NAME.what, and enter the verdict against the limits of the part of that name
 *       (netlist/kinds.h). PORT: what its gate pulses come from, as gate+ANGLE. A triac that is
 * fired in both half cycles names two, gate gate+180deg. Where none is named it goes by the deck's
 *       first gate port, a triac by all of them. A mosfet or an igbt may name the port that drives
 *       it; of these nobody judges whether they obey
 *       protects: what it lets through is held against that device's limit
 *   *$ compat ps
 *       the netlist is read as PSpice's dialect
 *   Xeva n m eva
 *       the actuator, once (no line of the contract, but wanted in every deck)
 *
 * The file of a part, or the head of a table, says besides what it is and what its maker allows:
 *
 *   *$ part   KIND "TEXT"
 *       thyristor, varistor, fuse, ...
 *   *$ limit  NAME = VALUE UNIT [assumed | typical] "TEXT"
 *       by the names of the field: v_drm, i2t, ...; assumed: no source says it; typical: its source
 *       guarantees nothing. The lines below may say so, too
 *   *$ limit  NAME = none "TEXT"
 *       an ideal part has none
 *   *$ time_current TIME s CURRENT A "TEXT"
 *       of a fuse: its element melts no sooner at that current. One line a point of its curve, from
 *       short to long
 *   *$ derate LIMIT TEMPERATURE degC FACTOR % "TEXT"
 *       what is left of the limit at that ambient temperature; one line a point, from cold to hot
 *   *$ zth    R K/W  TAU s "TEXT"
 *       a term of its junction's transient thermal impedance, sum of R (1 - exp(-t/TAU)) (a Foster
 *       network)
 *   *$ pulse  WIDTH us  NUMBER  CURRENT A "TEXT"
 *       the peak current it bears in that many pulses of that width (netlist/devices.h)
 *   *$ surge  NUMBER  CURRENT A "TEXT"
 *       the peak of half sines that it bears once in that many consecutive cycles of the mains,
 *       I_TSM over n cycles; of a triac, of whole sines
 *   *$ at     TEMPERATURE degC  NAME = VALUE UNIT "TEXT"
 *       what limit NAME is while the junction is at that temperature; the line `limit` has what it
 *       is at t_j_max
 *   *$ model  FIGURE = DEVIATION % "TEXT"
 *       how far the model's figure is from the data sheet's, as `check` of the part finds it; a
 *       verdict shows it beside the margins that hang on it (vs_kinds_hanging)
 *
 * A FORMULA is as base/formula.h has it. It may name the deck's parameters and the program's:
 * u_rms, f_mains, phase (rad), r_source, l_source. */
#pragma once

#include "netlist/deck.h"

/* True where the text, from behind "*$" and blanks on, begins with a word of the contract. */
bool vs_contract_knows(const char *text);

/* Reads one line of the contract into the deck. `begin` is the place of its "*$" in `line`. Error,
 * with its place: the line cannot be read; deck->lost then has its kind. */
vs_status vs_contract_line(vs_deck *deck, const char *line, vs_where begin, vs_error *err);
