/* SPDX-License-Identifier: GPL-3.0-or-later
 * A deck's main circuit as a schematic, an SVG picture that is made from the parsed netlist. */
#pragma once

#include "base/tree.h"
#include "netlist/deck.h"
#include "report/html.h"

/* What a run says of a device: the least margin, as a part of its limit, and the word. */
typedef struct vs_schematic_mark {
  char device[VS_DECK_NAME], measure[VS_DECK_NAME];
  double margin;
  bool bad; /* violated, or undecided */
} vs_schematic_mark;

/* Adds the picture, "<svg ...</svg>". The deck's parts are read. values: the scene's section
 * circuit, or that of summary.json; NULL: the deck's defaults stand beside the elements. Devices
 * that have a mark are coloured by it. What is not drawn is named below the picture. Returns false
 * where the circuit cannot be drawn truly; `why` then says so, and nothing is added.
 * Exported for tests. */
bool vs_schematic_draw(const vs_deck *deck, const vs_node *values, const vs_schematic_mark *marks,
                       size_t n_marks, vs_html *out, vs_text *why);

/* Reads the deck of that name and its parts, with the defaults, and draws it. Errors: the deck
 * cannot be read; its circuit cannot be drawn. */
vs_status vs_schematic_of_deck(const char *name, vs_html *out, vs_error *err);

/* Adds the schematic to the page of a run: its deck's, coloured by the verdict. Adds nothing where
 * the run had no circuit, or where the deck is not one that comes with the program: another file
 * may have changed since. */
void vs_schematic_add(const vs_node *summary, vs_html *html);
