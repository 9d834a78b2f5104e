/* SPDX-License-Identifier: GPL-3.0-or-later
 * The netlist between files and solver: reads the files of a deck and of its parts into a vs_deck,
 * and makes of it the lines that the solver is given.
 *
 * Reading takes three calls: vs_netlist_read for the deck's own files; vs_netlist_read_parts once
 * the scene has named its parts; vs_deck_bind once the parameters have values. vs_deck_free is due
 * also after an error. */
#pragma once

#include "netlist/deck.h"

/* Reads a deck and what it includes. Errors with file:line, each of which a check carries on from:
 * a line of the contract that cannot be read, a name declared twice, an unknown port, no or a
 * second EVA, a statement that is the program's own. */
vs_status vs_netlist_read(const char *path, vs_deck *deck, vs_error *err);

/* Reads the files of the parts: of those that the scene's section circuit names (NULL: there is no
 * such section), else of the deck's defaults. They may add to the contract. Then gives ratings and
 * devices what their parts say, and sees to it that ports and external sources match. A device
 * whose part multiplies its voltage by varistor_scale gets a key NAME_scale, a factor of its own:
 * vs_netlist_make then writes the part's subcircuit once more, for it alone. It gets none where the
 * netlist does not tell which instance is the device. */
vs_status vs_netlist_read_parts(vs_deck *deck, const vs_node *section, vs_error *err);

/* Reads the file of one part alone, for what it says of itself, and holds the parameters of its
 * instances to its subcircuits. */
vs_status vs_netlist_read_part(const char *path, vs_deck *part, vs_error *err);

/* The same for a library of subcircuits and models, which need not be a deck. */
vs_status vs_netlist_read_library(const char *path, vs_deck *library, vs_error *err);

/* The key NAME_part of the deck's device of this number, a resistor or capacitor of the netlist: it
 * says of which series that is, which gives it the series' limits. False: it has no such key, or
 * the deck's section has it already. */
enum { VS_SERIES_KEY = VS_DECK_NAME + 8 }; /* bytes */
bool vs_netlist_series_key(const vs_deck *deck, size_t device, char key[VS_SERIES_KEY],
                           vs_field *field);

/* True where part number `part` says of which series a resistor or capacitor of the deck is, as
 * r1_part of r1, and the series has no such value: a resistance beyond the limits r_least and
 * r_most, a capacitance more than 20 % from c_rated. The value is that of the parameter r1, else of
 * the netlist's element r1, else, of a name as r1_t1, of the parameter r1. `text` then says so, with
 * what the series has. False also where the value, or the series' own, is not known. */
bool vs_netlist_beyond_series(const vs_deck *deck, const vs_circuit_values *values, size_t part,
                              char *text, size_t size);

/* Makes the netlist that the solver loads: title, .param lines, the deck's own lines, the EVA's
 * subcircuit. The caller owns the lines; vs_netlist_free frees them. Error: the EVA's file is not
 * there. */
vs_status vs_netlist_make(const vs_deck *deck, const vs_circuit_values *values,
                          const vs_deck_value *standard, size_t n_standard, char ***lines,
                          size_t *count, vs_error *err);
void vs_netlist_free(char **lines, size_t count);

/* The deck's line that line `number` of such a netlist, from 0, is made of; NULL: it is none of the
 * deck's own. */
const vs_line *vs_netlist_line(const vs_deck *deck, size_t number);
