/* SPDX-License-Identifier: GPL-3.0-or-later
 * What becomes of each element of a netlist in its deck: the parameter for its value, where its
 * current is sensed, what it is measured as. */
#pragma once

#include "declared.h"
#include "import/elements.h"
#include "pins.h"

/* One element. */
typedef struct vs_fate_element {
  vs_pins pins;
  char param[VS_ELEMENTS_NAME]; /* the deck's parameter that its value becomes; empty: none */
  char *value; /* its value as a formula of the deck's parameters; NULL: there is none */
  char sense[VS_ELEMENTS_NAME];      /* the source of 0 V that senses its current; empty: none */
  char inner[VS_ELEMENTS_NAME];      /* the node between that source and the element */
  int sensed_at;                     /* at which of its nodes, from 0 */
  char gate_sense[VS_ELEMENTS_NAME]; /* the same two for its gate */
  char gate_inner[VS_ELEMENTS_NAME];
  char
      part[VS_ELEMENTS_NAME]; /* the deck's parameter that selects its part; empty: it is no part */
  char stem[VS_ELEMENTS_NAME]; /* of the mains and gates: the stem of all names that replace it,
                                  such as STEM_on and Egate_STEM */
  char level[VS_DECK_NAME]; /* of a gate: the deck's parameter that is the height of its pulses */
} vs_fate_element;

/* Begins as {0}; ends with vs_fate_free. */
typedef struct vs_fate {
  const vs_elements *wiring; /* borrowed, as the next two are */
  const vs_values *values;
  const vs_roles *roles;
  vs_fate_element *of;        /* of each element; owned */
  char sum[VS_ELEMENTS_NAME]; /* the node whose voltage is the sum of the thyristors' currents */
  char eva[VS_ELEMENTS_NAME]; /* the EVA */
  char eva_sense[VS_ELEMENTS_NAME], eva_in[VS_ELEMENTS_NAME]; /* the source of 0 V that senses its
                                current, which the netlist asks for as that of its coil, i(L1), and
                                the node between the two; empty: it does not ask */
  vs_declared sheet;
} vs_fate;

/* Finds out what each element is, names its sources and parameters, and adds the `param` lines.
 * `pins` is what --pins says. Errors with their place, after each of which a check carries on: pins
 * that cannot be told apart, a model that is defined nowhere. */
vs_status vs_fate_make(vs_fate *plan, const char *pins, vs_error *err);
void vs_fate_free(vs_fate *plan);

/* True for an element that the deck does not have because it belongs to the coil. */
bool vs_fate_is_coil(const vs_fate *plan, const vs_element *element);

/* Finds the first "i(NAME)" in a text that is the current of the coil or of its resistor; NULL:
 * there is none. */
const char *vs_fate_coil_current(const vs_fate *plan, const char *text);

/* What becomes of an element. */
const vs_fate_element *vs_fate_of(const vs_fate *plan, const vs_element *element);
