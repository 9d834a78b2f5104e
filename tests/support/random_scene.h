/* SPDX-License-Identifier: GPL-3.0-or-later
 * Scenes drawn at random from all that ships: decks, parts, machines, events, controls, tiers,
 * tolerances. A scene is a function of its number alone, so each can be made again. */
#pragma once

#include <stdbool.h>

#include "base/text.h"

/* Free it with random_scene_free. All words are the scene's own keys, or "" where it has none. */
typedef struct random_scene {
  int number;
  vs_text text; /* the scene as YAML, owned */
  bool ideal;   /* it has no circuit */
  bool judged;  /* its tier is circuit, and its deck's parts have limits */
  const char *deck, *part /* its thyristor */, *machine, *tier /* "auto" where none is asked for */;
  const char *extra; /* what else is in it: a kind of event, a law of control, ...; one word */
  bool has_stop, has_table, shifted /* its mains, in phase */;
  double tolerance, until_s, frequency_hz;
  int first_cycle, every; /* of its firings; every 0: once */
  double pulse_ms;
} random_scene;

/* Every tenth scene is to be judged. */
enum { RANDOM_JUDGED = 10 };

random_scene random_scene_at(int number);
void random_scene_free(random_scene *s);
