/* SPDX-License-Identifier: GPL-3.0-or-later
 * The parameters NAME=VALUE of a line of a netlist, and gains that are names of parameters. */
#ifndef VS_NETLIST_PARAMETERS_H
#define VS_NETLIST_PARAMETERS_H

#include <stdbool.h>
#include <stddef.h>

#include "netlist/cards.h"

/* Errors: in lines X... a parameter that has no value, as "r= c=7", which ngspice reads as
 * something else; a name behind the last value, which ngspice leaves out. */
vs_status vs_parameters_check(const vs_cards *cards, vs_error *err);

/* Errors, each with its place: the gain of an E, F, G or H is a bare name that ngspice takes for 0,
 * as no .param or .subckt defines it, wherever that stands, or as it stands in brackets or in a
 * line with commas. `known` has the names that are defined besides, and gets the others. */
vs_status vs_parameters_check_gains(const vs_cards *cards, vs_names *known, vs_error *err);

#endif
