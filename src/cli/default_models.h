/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine and the deck whose keys are told, where no scene names them. */
#pragma once

#include "run/scene.h"

typedef struct vs_default_models {
  vs_deck *deck;
  vs_machine *machine;
} vs_default_models;

/* Reads both; each is a path or a name, NULL: that of a scene that names none. Errors: those of
 * reading them. vs_default_models_free even then. */
vs_status vs_default_models_read(const char *deck, const char *machine, vs_default_models *ground,
                                 vs_error *err);
void vs_default_models_free(vs_default_models *ground);
