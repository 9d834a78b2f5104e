/* SPDX-License-Identifier: GPL-3.0-or-later
 * The signals and the ports of a circuit: by which names its solver knows them, in which order it
 * shows and asks for them, and what they mean in a knot. */
#pragma once

#include "engine/step.h"
#include "macromodel/circuit_states.h"

/* Signals: those of the EVA, the mains current, then two for each of the deck's terms, whose
 * difference the term is. Behind these stand two for each value that the circuit remembers. */
enum {
  VS_SIG_FLUX,  /* lambda, Wb, as a voltage */
  VS_SIG_COIL,  /* voltage between the coil's resistance and its flux */
  VS_SIG_MINUS, /* the EVA's two nodes */
  VS_SIG_PLUS,
  VS_SIG_I_MAINS, /* current into the mains' source */
  VS_SIG_TERMS,
  VS_SIG_MOST = VS_SIG_TERMS + 2 * VS_DECK_MOST
};
/* Ports: the deck's, then the EVA's. Those that lead are there only where the EVA can be led
 * (eva_led.inc). Last come the machine's motions that the deck names, in vs_deck.motions' order. */
enum {
  VS_EVA_PORT_GAP,           /* z, m */
  VS_EVA_PORT_CORRECTS_FLUX, /* what is added to the rate of lambda, V (engine/coupled/truncation.h)
                              */
  VS_EVA_PORT_CORRECTS_CURRENT,            /* what is added to the coil's current, A */
  VS_EVA_PORTS_LEADING,                    /* the first of those that lead */
  VS_EVA_PORT_FLUX = VS_EVA_PORTS_LEADING, /* lambda that the EVA is led to, Wb */
  VS_EVA_PORT_VOLTAGE,                     /* voltage that it is led to, V */
  VS_EVA_PORT_RATE,                        /* how fast lambda is led, 1/s; 0: it is not */
  VS_EVA_PORT_CONDUCTANCE,                 /* through which the voltage is led, S; 0: it is not */
  VS_EVA_PORTS
};

typedef struct vs_signal_map {
  char text[VS_SIG_MOST + VS_DECK_MOST + VS_EVA_PORTS + VS_DECK_MOTIONS]
           [2 * VS_DECK_NAME + 8]; /* room for the names */
  const char *signals[VS_SIG_MOST + 2 * VS_CIRCUIT_STATES_MOST];
  const char *ports[VS_DECK_MOST + VS_EVA_PORTS + VS_DECK_MOTIONS];
  size_t n_signals, n_ports;
  size_t n_memories; /* the last 2 n_memories signals are theirs */
} vs_signal_map;

/* Fills names that are all zero, and that stay where they are made, as they point into themselves.
 * The memories' own names are borrowed. memories NULL: none are to be shown. */
void vs_signal_map_of(const vs_deck *deck, const vs_circuit_states *memories, vs_signal_map *names);

/* Puts the deck's terms and the mains current into a knot. */
void vs_signal_map_take_terms(const vs_deck *deck, const double *signals, vs_knot *knot);
/* Puts lambda, its rate and the EVA's voltage into a knot. */
void vs_signal_map_take_coil(const double *signals, vs_knot *knot);
/* Gives the values that the circuit remembers, V or A. */
void vs_signal_map_take_memory(const vs_signal_map *names, const double *signals,
                               double memory[VS_CIRCUIT_STATES_MOST]);
