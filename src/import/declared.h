/* SPDX-License-Identifier: GPL-3.0-or-later
 * The "*$" lines of the deck that is being written, limited to what a deck may have, and the
 * messages for the user. */
#pragma once

#include <stdbool.h>

#include "base/names.h"
#include "base/text.h"
#include "netlist/deck.h"

/* Kinds of lines, in the order in which they stand in the deck. */
enum {
  VS_DECLARED_PARAM,
  VS_DECLARED_PORT,
  VS_DECLARED_LINE,
  VS_DECLARED_PROBE,
  VS_DECLARED_RATING,
  VS_DECLARED_DEVICE,
  VS_DECLARED_LOSS,
  VS_DECLARED_STORE,
  VS_DECLARED_KINDS
};

/* A sentence that tells what was done, or what is left to decide. */
typedef struct vs_declared_notes {
  char **item; /* owned, as each text is */
  size_t count;
} vs_declared_notes;

/* Begins as {0}; ends with vs_declared_free. */
typedef struct vs_declared {
  vs_text lines[VS_DECLARED_KINDS];
  size_t counts[VS_DECLARED_KINDS];
  size_t left_out;                            /* lines for which a deck has no room */
  char terms[VS_DECK_MOST][2 * VS_DECK_NAME]; /* "v(a,b)", "i(vx)" of all lines */
  size_t n_terms;
  vs_names names; /* names of parameters and probes so far, and the netlist's own */
  vs_declared_notes did, left;
} vs_declared;

void vs_declared_free(vs_declared *sheet);

/* Adds a line of this kind, without its "*$ KIND". Returns false where the deck has no more room
 * for it or for its terms; the line is then counted as left out. */
bool vs_declared_add(vs_declared *sheet, int kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds a parameter. Its value gets the unit of elements with this letter, "4.7 kohm", "100 nF", and
 * its range is from a thousandth to a thousand times the value. */
void vs_declared_param(vs_declared *sheet, const char *name, char letter, double value,
                       const char *text);

/* Makes a name that no line has yet: `wanted`, or `wanted` with "_2", "_3", ... appended. */
void vs_declared_name(vs_declared *sheet, const char *wanted, char name[VS_DECK_NAME]);

/* Writes the voltage between two nodes as formulas have it: "v(a,b)", "v(a)", "-v(b)". */
void vs_declared_voltage(const char *from, const char *to, char text[VS_DECK_TEXT]);

/* Notes a sentence. */
void vs_declared_note(vs_declared_notes *notes, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Adds all lines to the text of a deck. */
void vs_declared_write(const vs_declared *sheet, vs_text *out);
