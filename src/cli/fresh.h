/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `new`: a scene that names every key, made from the tables of keys. */
#ifndef VS_CLI_FRESH_H
#define VS_CLI_FRESH_H

#include <stdbool.h>

#include "base/error.h"

typedef struct vs_fresh_options {
  const char *path;           /* of the scene; its name ends in .yaml */
  const char *deck, *machine; /* the scene's, a path or a name; NULL: those of an empty scene */
  bool quiet;                 /* does not say what was written */
} vs_fresh_options;

/* Writes a scene in which every key stands behind a '#', with its default, what is allowed and what
 * it means; only the deck and the machine asked for are set. So it runs as it is. Where the program
 * is installed the first line names the schema. Errors: VS_INPUT, the file is there already, or has
 * another ending; those of reading deck and machine. */
vs_status vs_fresh_command(const vs_fresh_options *options, vs_error *err);

#endif
