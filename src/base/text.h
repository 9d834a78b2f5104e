/* SPDX-License-Identifier: GPL-3.0-or-later
 * Strings: growing buffers, nearest names. */
#ifndef VS_BASE_TEXT_H
#define VS_BASE_TEXT_H

#include <stddef.h>

/* A string that grows. Start from {0}; text is NULL until something is added. Ends the process when
 * memory ends. */
typedef struct vs_text {
  char *text;
  size_t length, capacity;
} vs_text;

void vs_text_add(vs_text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
void vs_text_free(vs_text *t);

_Noreturn void vs_out_of_memory(void);     /* says so and ends the process */
void *vs_alloc(size_t count, size_t size); /* zeroed; ends the process when memory ends */
char *vs_copy(const char *string);         /* the same for strings; free() both */

/* The candidate nearest to name (Damerau-Levenshtein), NULL when none is near enough to be meant.
 */
const char *vs_text_nearest(const char *name, const char *const *candidates, size_t count);

/* The first byte that does not belong to UTF-8 (as RFC 3629 has it: nothing overlong, no surrogate,
 * at most U+10FFFF); NULL: there is none. */
const char *vs_text_not_utf8(const char *text, size_t length);

/* Which character of the line (UTF-8) stands at `at`, from 1. */
int vs_text_column(const char *line, const char *at);

/* Writes what "%.*g" would, in a tenth of its time where digits <= 12; gives its length. */
enum { VS_NUMBER_SIZE = 32 };
size_t vs_text_number(char text[VS_NUMBER_SIZE], double value, int digits);

#endif
