/* SPDX-License-Identifier: GPL-3.0-or-later
 * What an element is whose stress can be measured, and which of its nodes is what: by its letter,
 * by the names of its subcircuit's pins or the comment that explains them, by a part of its name,
 * which lies beside the netlist or ships, or as the user says. */
#ifndef VS_IMPORT_PINS_H
#define VS_IMPORT_PINS_H

#include "import/roles.h"

/* An element's kind and its nodes, as indices into its own, from 0. */
typedef struct vs_pins {
  const char *kind;            /* "thyristor", "triac", "diode", ...; NULL: it is nothing known */
  int from, to;                /* the current that counts flows from the one to the other */
  int gate;                    /* -1: it has none */
  char part[VS_ELEMENTS_NAME]; /* the part that its subcircuit is; empty: the netlist's own */
  const char *by;              /* how it was told, for the reader; vs_pins_said: by the user */
} vs_pins;

extern const char *const vs_pins_said; /* what vs_pins.by is where --pins told it */

/* `asked` is what the user says, "X1=akg,X2=varistor" (NULL: nothing): the letters of the pins in
 * their order (a k g of a thyristor, 2 1 g of a triac, d s g, c e g), or a word for what has two
 * pins alike, or none. Error, with its place: an element looks like a kind by its name, as a
 * thyristor, and which pin is what does not show. */
vs_status vs_pins_find(const vs_elements *wiring, const char *asked, const vs_element *element,
                       vs_pins *pins, vs_error *err);

/* Refuses what cannot be in `asked`: elements that are not there, letters and words that say
 * nothing. */
vs_status vs_pins_check(const vs_elements *wiring, const char *asked, vs_error *err);

#endif
