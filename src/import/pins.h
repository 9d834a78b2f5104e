/* SPDX-License-Identifier: GPL-3.0-or-later
 * Finds the kind of an element, such as thyristor or diode, and which of its nodes is which pin.
 * What the user says decides; otherwise the element's letter, the names of its subcircuit's pins, a
 * comment that explains them, or a part of its name, beside the netlist or shipped. */
#pragma once

#include "import/roles.h"

/* An element's kind, and its pins as indices of its own nodes, from 0. */
typedef struct vs_pins {
  const char *kind;            /* "thyristor", "triac", "diode", ...; NULL: it is nothing known */
  int from, to;                /* the current is positive from the first to the second */
  int gate;                    /* -1: it has none */
  char part[VS_ELEMENTS_NAME]; /* the part that its subcircuit stands for; empty: the netlist
                                  defines it */
  const char *by;              /* how the kind was found, in words for the user */
} vs_pins;

extern const char *const vs_pins_said; /* the value of vs_pins.by where --pins decided */

/* `asked` is what the user says, "X1=akg,X2=varistor" (NULL: nothing). It has the letters of the
 * pins in the order of the nodes (a k g of a thyristor, 2 1 g of a triac, d s g, c e g); for a kind
 * with two equal pins its word; or none. Error, with its place: by its name the element is of a
 * kind, such as thyristor, but its pins cannot be told apart. */
vs_status vs_pins_find(const vs_elements *wiring, const char *asked, const vs_element *element,
                       vs_pins *pins, vs_error *err);

/* Error: `asked` names elements that do not exist, or has letters and words without a meaning. */
vs_status vs_pins_check(const vs_elements *wiring, const char *asked, vs_error *err);
