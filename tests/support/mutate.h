/* SPDX-License-Identifier: GPL-3.0-or-later
 * Texts with one mistake, as a person, an editor or a broken disk makes it. Equal seeds make equal
 * mistakes on every machine. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* A number below n; the state goes on. n is at least 1. */
size_t mutate_below(uint64_t *state, size_t n);

typedef struct mutation {
  const char *name; /* that of the kind of mistake */
  int line;         /* that is wrong now, from 1; 0: it is not one line alone */
} mutation;

/* Returns the text with one mistake, which the caller frees, and its length in bytes; a zero byte
 * stands behind it. Where the mistake makes no difference, another one is taken. An empty text
 * stays empty. */
char *mutate(const char *text, size_t size, uint64_t *state, size_t *new_size, mutation *what);
