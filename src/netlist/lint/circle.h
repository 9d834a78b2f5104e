/* SPDX-License-Identifier: GPL-3.0-or-later
 * Things that need each other: finds a circle among them. */
#pragma once

#include <stdbool.h>

#include "base/text.h"
#include "netlist/words.h"

/* A thing, by its number from 0, and where it names the next one. `line` is for who looks for it.
 */
typedef struct vs_circle_step {
  size_t thing, line;
  vs_word name; /* no bytes: nothing was found in it so far */
} vs_circle_step;

/* Moves a step on to the next name of a thing in it. Returns the number of that thing; `count` of
 * the things: there is none left. */
typedef size_t vs_circle_next(const void *ctx, vs_circle_step *step);

/* Looks for a circle among `count` things, and gives its steps in `path`, which has room for
 * `count`, from the thing of the least number on. Returns how many there are; 0: there is no
 * circle, and `order` (NULL: not asked for) has all things, each behind those that it names. */
size_t vs_circle_find(size_t count, vs_circle_next *next, const void *ctx, vs_circle_step *path,
                      size_t *order);

/* Adds what a circle says: " calls itself", " calls b, which needs c, which needs a". */
typedef const char *vs_circle_verb(const void *ctx, size_t thing, vs_word *name);
void vs_circle_tell(const vs_circle_step *path, size_t count, vs_circle_verb *verb, const void *ctx,
                    vs_text *text);
