/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `import`: makes a deck of a SPICE netlist that LTspice, KiCad, PSpice or a person
 * wrote. */
#pragma once

#include "import/roles.h"

typedef struct vs_import_options {
  const char *name;    /* the netlist's path */
  const char *output;  /* the deck's path, which ends in .cir */
  const char *scene;   /* the path of a scene with the netlist's own values; NULL: none */
  const char *pins;    /* --pins; NULL: nothing is said */
  const char *library; /* a further file of models; NULL: none */
  vs_roles_asked asked;
  bool json;  /* what was done as JSON on standard output */
  bool quiet; /* does not print what was done */
} vs_import_options;

/* Writes the deck if its first step succeeds in the scene that the netlist describes. What was done
 * and what is left to decide is told on standard error and at the head of the deck. Error: prints
 * each open question with its place in the netlist and the option that answers it, writes nothing,
 * and returns VS_INPUT with an empty err. */
vs_status vs_import_command(const vs_import_options *options, vs_error *err);
