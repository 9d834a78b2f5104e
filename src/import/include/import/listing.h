/* SPDX-License-Identifier: GPL-3.0-or-later
 * A netlist as LTspice, KiCad, PSpice or a person wrote it: its lines, joined where they continue
 * each other, and those of the files that it includes. Nothing is understood here but what a line
 * is. */
#ifndef VS_IMPORT_LISTING_H
#define VS_IMPORT_LISTING_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

/* Who wrote a netlist, as far as its text shows. */
enum { VS_ORIGIN_PLAIN, VS_ORIGIN_LTSPICE, VS_ORIGIN_KICAD, VS_ORIGIN_PSPICE, VS_ORIGINS };
extern const char *const vs_listing_origins[VS_ORIGINS];

/* VS_CARD_COMMAND: of a block .control or .aliases, with its first and last line. */
enum { VS_CARD_COMMENT, VS_CARD_STATEMENT, VS_CARD_ELEMENT, VS_CARD_COMMAND };

/* One line with those that continue it. */
typedef struct vs_card {
  char *text; /* joined, without what ends a line as a comment; owned */
  char *raw;  /* as the file has it, with line breaks between its lines; owned */
  vs_where where;
  int kind;      /* VS_CARD_... */
  int depth;     /* how many subcircuits are open; a line .subckt counts itself, .ends does, too */
  bool included; /* it stands in a library that the netlist includes, and not in a part of it */
} vs_card;

enum { VS_LISTING_FILES = 32 };

/* Begins as {0}; ends with vs_listing_free. */
typedef struct vs_listing {
  char *files[VS_LISTING_FILES]; /* owned; the first is the netlist */
  size_t n_files;
  vs_card
      *cards; /* of all files; those of an included file stand behind the line that includes it */
  size_t count;
  char title[160];
  int origin; /* VS_ORIGIN_... */
} vs_listing;

/* Reads a netlist and what it includes, and `library` besides (NULL: nothing). Text is UTF-8,
 * UTF-16 with its mark, or else Windows-1252; a Ctrl-Z ends it. A file that is included and cannot
 * be read is passed over: vs_listing_finds tells. Errors with their place: the netlist cannot be
 * read, or is a drawing. */
vs_status vs_listing_read(vs_listing *listing, const char *path, const char *library,
                          vs_error *err);
void vs_listing_free(vs_listing *listing);

/* True for a line that includes a file. `path` is then where the file lies, which may be beside the
 * netlist where the line names a folder of another machine; empty: there is none. It holds
 * VS_PATH_SIZE bytes. */
bool vs_listing_finds(const vs_card *card, char *path);

/* True where the card's first word is this one, capitals aside. */
bool vs_listing_is(const vs_card *card, const char *word);

#endif
