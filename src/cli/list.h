/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `list`: what there is, printed from the tables that the program itself works from. */
#pragma once

#include <stdbool.h>

#include "base/error.h"
#include "default_models.h"

typedef struct vs_list_options {
  const char *kind;   /* "scenes", "probes", ...; "all" or NULL: every kind */
  const char *filter; /* only entries that have this text, capitals aside; NULL: every entry */
  const char *deck, *machine; /* whose probes, measures and parameters are listed, a path or a
                                 name; NULL: those of a scene that names none */
  bool json;                  /* prints an object with an array of entries for each kind */
} vs_list_options;

/* Prints the list. Where the filter lets nothing pass, one line on standard error says so. Errors:
 * VS_INPUT, there is no such kind; those of reading deck and machine. */
vs_status vs_list_command(const vs_list_options *options, vs_error *err);

/* The k-th kind and what it lists, from 0; NULL: there are no more. */
const char *vs_list_kind(int k);
const char *vs_list_heading(int k);
/* True if it is the name of a kind. */
bool vs_list_has(const char *kind);

/* Prints the keys of the scene's section of that name, and of those below it, as the kind
 * parameters has them. Returns false where there is no such section. */
bool vs_list_section(const char *name, const vs_default_models *ground);
