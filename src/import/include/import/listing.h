/* SPDX-License-Identifier: GPL-3.0-or-later
 * A netlist as LTspice, KiCad, PSpice or a person wrote it: its lines, with continued ones joined,
 * and those of the files that it includes. Here only the kind of a line is understood. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "netlist/cards.h"

/* The program that wrote a netlist, as far as its text shows. */
enum { VS_ORIGIN_PLAIN, VS_ORIGIN_LTSPICE, VS_ORIGIN_KICAD, VS_ORIGIN_PSPICE, VS_ORIGINS };
extern const char *const vs_listing_origins[VS_ORIGINS];

/* VS_CARD_COMMAND: a line of a .control or .aliases block, its first and last included. */
enum { VS_CARD_COMMENT, VS_CARD_STATEMENT, VS_CARD_ELEMENT, VS_CARD_COMMAND };

/* One line, with the lines that continue it. */
typedef struct vs_card {
  char *text; /* joined, without comments at the ends of lines; owned */
  char *raw;  /* as the file has it, with line breaks between its lines; owned */
  vs_where where;
  int kind;      /* VS_CARD_... */
  int depth;     /* how many subcircuits are open; .subckt and .ends lines count as inside */
  bool included; /* it stands in an included library, not in an included part of the netlist */
} vs_card;

enum { VS_LISTING_FILES = 32 };

/* Begins as {0}; ends with vs_listing_free. */
typedef struct vs_listing {
  char *files[VS_LISTING_FILES]; /* owned; the first is the netlist */
  size_t n_files;
  vs_card *cards; /* of all files; those of an included file follow the line that includes it */
  size_t count;
  vs_cards netlist; /* card k is of cards[k]; a comment or command is a card of no words */
  vs_line *lines;   /* that it is made of; owned, their texts are not */
  char title[160];
  int origin; /* VS_ORIGIN_... */
} vs_listing;

/* Reads a netlist with its included files, and `library` besides (NULL: nothing). Text is UTF-8,
 * UTF-16 with a byte order mark, or else Windows-1252; a Ctrl-Z ends it. An included file that
 * cannot be read is skipped (vs_listing_finds tells which). Errors with their place: the netlist
 * cannot be read, or is a drawing. */
vs_status vs_listing_read(vs_listing *listing, const char *path, const char *library,
                          vs_error *err);
void vs_listing_free(vs_listing *listing);

/* True for a line that includes a file. `path` becomes where the file lies, which may be beside the
 * netlist if the line names a folder of another computer; empty: the file was not found. It holds
 * VS_PATH_SIZE bytes. */
bool vs_listing_finds(const vs_card *card, char *path);

/* The place of `at` in the card's text, if that is in the first of its lines; else the card's. */
vs_where vs_listing_place(const vs_card *card, const char *at);

/* True where the card's first word is this one, ignoring case. */
bool vs_listing_is(const vs_card *card, const char *word);
