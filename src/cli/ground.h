/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine and the deck whose keys are told, where no scene names them. */
#ifndef VS_CLI_GROUND_H
#define VS_CLI_GROUND_H

#include "run/scene.h"

typedef struct vs_ground {
  vs_deck *deck;
  vs_machine *machine;
} vs_ground;

/* Reads both; each is a path or a name, NULL: that of a scene that names none. Errors: those of
 * reading them. vs_ground_free even then. */
vs_status vs_ground_read(const char *deck, const char *machine, vs_ground *ground, vs_error *err);
void vs_ground_free(vs_ground *ground);

#endif
