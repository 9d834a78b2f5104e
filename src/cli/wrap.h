/* SPDX-License-Identifier: GPL-3.0-or-later
 * A vendor's subcircuit, found in the vendor's file. */
#pragma once

#include <stdbool.h>

#include "base/error.h"
#include "base/path.h"

enum { VS_WRAP_NAME = 64 };

typedef struct vs_wrap {
  char file[VS_PATH_SIZE + 4]; /* the vendor's, as the part's file is to include it */
  char called[VS_WRAP_NAME];   /* the subcircuit */
  char call[4 * VS_WRAP_NAME]; /* the part's nodes in the order of its pins, then its name */
  char pins[8 * VS_WRAP_NAME]; /* a sentence that says which pin is which, and how that is known */
  bool pspice;                 /* the file is written in PSpice's dialect */
  char path[VS_PATH_SIZE];     /* the vendor's file as it was given */
  int line, second;            /* of the subcircuit, and of a second one of its name, which ngspice
                                  leaves aside; 0: there is none */
} vs_wrap;

/* Finds in `word`, FILE or FILE:NAME, the subcircuit that is to be a part of this kind. Pins go by
 * `pins`, the kind's letters in their order (NULL: not said), by their names, those of a triac by
 * the junctions within, else by an order that is usual, and the sentence then says that this is
 * assumed. output_name: the part's file to be, and its subcircuit's name. Errors: the file cannot
 * be read; no subcircuit, or more than one, has as many pins; one has the part's own name; a
 * triac's pins cannot be told. */
vs_status vs_wrap_find(const char *word, const char *kind, const char *pins,
                       const char *const output_name[2], vs_wrap *wrap, vs_error *err);
