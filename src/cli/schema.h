/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `schema`: JSON Schemas (draft 2020-12) of the program's files, made from the tables
 * of keys, for editors that complete and check YAML. */
#ifndef VS_CLI_SCHEMA_H
#define VS_CLI_SCHEMA_H

#include "study/methods.h"

typedef struct vs_schema_options {
  const char *kind;           /* "scene", "study" or "machine"; NULL: "scene" */
  const char *deck, *machine; /* whose keys a scene has that names none; NULL: those of an empty
                                 scene */
} vs_schema_options;

/* Prints the schema. It tells unknown and missing keys, words, kinds of values and units of the
 * wrong dimension; ranges only of a scene's pure numbers. Of a scene that names a deck or a machine
 * of its own, it lets any key pass in the sections that these declare. It looks into no formula and
 * no name. Errors: there is no such kind; those of
 * reading deck and machine. */
vs_status vs_schema_command(const vs_schema_options *options, vs_error *err);

#endif
