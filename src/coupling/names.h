/* SPDX-License-Identifier: GPL-3.0-or-later
 * The names by which the coupling and the deck's terms know the circuit, and their order. */
#ifndef VS_COUPLING_NAMES_H
#define VS_COUPLING_NAMES_H

#include "deck/deck.h"

/* Signals: the EVA's, the mains current, then two of each term, whose difference it is. */
enum {
  VS_SIG_FLUX,
  VS_SIG_COIL,
  VS_SIG_MINUS,
  VS_SIG_PLUS,
  VS_SIG_I_MAINS,
  VS_SIG_TERMS,
  VS_SIG_MOST = VS_SIG_TERMS + 2 * VS_DECK_MOST
};
/* Ports: the deck's, then the EVA's; all but the gap's only where it can be led (eva_led.inc). */
enum {
  VS_PORT_GAP,
  VS_PORT_FLUX,
  VS_PORT_VOLTAGE,
  VS_PORT_RATE,
  VS_PORT_CONDUCTANCE,
  VS_EVA_PORTS
};

typedef struct vs_names {
  char text[VS_SIG_MOST + VS_DECK_MOST + VS_EVA_PORTS][2 * VS_DECK_NAME];
  const char *signals[VS_SIG_MOST], *ports[VS_DECK_MOST + VS_EVA_PORTS];
  size_t n_signals, n_ports;
} vs_names;

/* Fills an empty one, which stays where it is. */
void vs_names_of(const vs_deck *deck, vs_names *names);

#endif
