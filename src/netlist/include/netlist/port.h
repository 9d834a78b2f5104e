/* SPDX-License-Identifier: GPL-3.0-or-later
 * What may drive a source of the circuit, and what a deck calls it in its lines
 * `*$ port NAME = SOURCE`: mains, gate[+ANGLE], burst[+ANGLE], pwm[+ANGLE], pwm_low[+ANGLE]. The
 * voltage that such a signal has
 * at an instant is computed in engine/signals.h. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

/* What drives a source: the mains' voltage; a gate pulse, 1 V while it lasts; the sub-pulses that
 * fill a gate pulse; the pulses of a modulated leg's upper and of its lower switch, 1 V while they
 * last; the wave of a generator or the control of a switch that an event puts into the deck; what
 * brings a generator's network onto the line, 1 V from then on.
 * VS_PORT_DRIVES is their number. */
enum {
  VS_PORT_MAINS,
  VS_PORT_GATE,
  VS_PORT_BURST,
  VS_PORT_PWM,
  VS_PORT_PWM_LOW,
  VS_PORT_EVENT,
  VS_PORT_ON_LINE,
  VS_PORT_DRIVES
};

/* One source's signal. */
typedef struct vs_signal {
  int drive;        /* VS_PORT_... */
  double shift_rad; /* gate and burst: how much later than the port `gate` its pulses come; pwm: how
                       much later the sine of its reference comes */
  size_t event;     /* VS_PORT_EVENT and VS_PORT_ON_LINE: the event's index in the scene's list */
} vs_signal;

/* Reads a port's name. `where` is the place of the name, for the errors: the name is of no port, or
 * its angle cannot be read. On error *signal is void. */
vs_status vs_port_read(const char *name, vs_where where, vs_signal *signal, vs_error *err);

/* Reads the name of a gate port alone, "gate" or "gate+180deg", and gives the delay of its pulses.
 * Returns false where the name is none of a gate port. */
bool vs_port_read_gate(const char *name, double *shift_rad);

/* True for a signal that follows gate pulses, whole or as sub-pulses. */
bool vs_port_is_gated(const vs_signal *signal);

/* True for a signal of pulse-width modulation. */
bool vs_port_is_modulated(const vs_signal *signal);
/* True where it is driven with the sub-pulses that fill a gate pulse. */
bool vs_port_is_burst(const vs_signal *signal);
