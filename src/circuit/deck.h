/* SPDX-License-Identifier: GPL-3.0-or-later
 * The netlist contract: an ngspice netlist whose lines that start with "*$" say what the program
 * must know.
 *
 *   *$ title  TEXT
 *   *$ param  NAME = VALUE UNIT  MIN..MAX  "TEXT"      becomes .param NAME; scene key circuit.NAME,
 * in UNIT
 *   *$ port   mains = SOURCE                            a source "SOURCE n m external" with the
 * mains voltage
 *   *$ port   gate[+ANGLE] = SOURCE                     1 V while the (delayed) gate pulse is
 * there, else 0
 *   *$ probe  NAME = [-]v(n) | v(n,m) | i(Vx)  UNIT  "TEXT"   a channel; i_thyristor is the anode
 * current Xeva n m eva                                        the actuator, once
 *
 * Parameters every deck may use: u_rms, f_mains, phase (rad), r_source, l_source. */
#ifndef VS_CIRCUIT_DECK_H
#define VS_CIRCUIT_DECK_H

#include <stddef.h>

#include "base/error.h"
#include "base/field.h"
#include "base/path.h"

enum {
  VS_DECK_NAME = 64,
  VS_DECK_TEXT = 160,
  VS_DECK_FILES = 32,
  VS_DECK_MOST = 64 /* of params, ports, probes each */
};

typedef enum vs_port_kind { VS_PORT_MAINS, VS_PORT_GATE } vs_port_kind;
typedef struct vs_port {
  vs_port_kind kind;
  double shift_rad;          /* of a gate */
  char source[VS_DECK_NAME]; /* lower case */
  vs_where where;
} vs_port;

typedef struct vs_probe {
  char name[VS_DECK_NAME], unit[16], text[VS_DECK_TEXT];
  double sign;
  char plus[VS_DECK_NAME], minus[VS_DECK_NAME]; /* signals: "v(a)", "i(vth)", "v(0)" */
} vs_probe;

/* The scene's section circuit: the deck's name, then that deck's parameters in SI, in its order. */
typedef struct vs_circuit_values {
  char deck[VS_NAME_SIZE];
  double params[VS_DECK_MOST];
} vs_circuit_values;
extern const vs_field vs_deck_key; /* "deck"; the first field of every deck's section */

typedef struct vs_deck {
  char *files[VS_DECK_FILES]; /* the deck and what it includes, for messages */
  size_t n_files;
  char title[VS_DECK_TEXT];
  char **lines; /* the file's, comments and blank lines left out */
  size_t n_lines;
  vs_section section; /* "circuit": the key deck, then the parameters; fills a vs_circuit_values */
  vs_port ports[VS_DECK_MOST];
  size_t n_ports;
  vs_probe probes[VS_DECK_MOST];
  size_t n_probes;
  char eva[VS_DECK_NAME], eva_plus[VS_DECK_NAME],
      eva_minus[VS_DECK_NAME]; /* instance, its two nodes */
} vs_deck;

extern const vs_shelf vs_deck_shelf;

/* Errors, each with file:line: a line of the contract that cannot be read, a name declared twice,
 * an unknown port, no or a second EVA, a statement that is the program's own. vs_deck_free even
 * then. */
vs_status vs_deck_read(const char *path, vs_deck *deck, vs_error *err);
void vs_deck_free(vs_deck *deck);

typedef struct vs_deck_value {
  const char *name;
  double value;
} vs_deck_value;

/* The netlist ready to load: title, .param lines, the deck's own lines, the EVA's subcircuit.
 * standard: the program's parameters. Free with vs_netlist_free. */
vs_status vs_deck_netlist(const vs_deck *deck, const vs_circuit_values *values,
                          const vs_deck_value *standard, size_t n_standard, char ***lines,
                          size_t *count, vs_error *err);
void vs_netlist_free(char **lines, size_t count);

#endif
