/* SPDX-License-Identifier: GPL-3.0-or-later
 * Strings that grow, nearest names, UTF-8, numbers. */
#pragma once

#include <stdarg.h>
#include <stddef.h>

#include "base/alloc.h"

/* A string that grows. Start from {0}; text is NULL until something is added. Adding ends the
 * process when there is no memory. */
typedef struct vs_text {
  char *text;
  size_t length, capacity;
} vs_text;

void vs_text_add(vs_text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Adds `length` bytes as they are, in a fraction of the time. */
void vs_text_put(vs_text *t, const char *bytes, size_t length);
void vs_text_free(vs_text *t);

/* For writers of a language, which write texts as that language quotes them. Adds as vprintf does,
 * with the conversions d, ld, zu, c, f, e, g and s, but calls write(ctx, text) for what %s
 * stands for. */
void vs_text_add_by(vs_text *t, void (*write)(void *ctx, const char *text), void *ctx,
                    const char *format, va_list args);

/* Returns the candidate nearest to name by Damerau and Levenshtein's distance, capitals aside; NULL
 * when none is near enough to be meant. */
const char *vs_text_nearest(const char *name, const char *const *candidates, size_t count);

/* Returns what a message adds of that candidate, "; did you mean 'firing'?", or `otherwise` where
 * none is near enough. */
typedef struct vs_text_hinted {
  char text[1024];
} vs_text_hinted;
vs_text_hinted vs_text_hint(const char *name, const char *const *candidates, size_t count,
                            const char *otherwise);

/* Returns the first byte that is not part of UTF-8 as RFC 3629 defines it, which allows nothing
 * overlong, no surrogate and at most U+10FFFF; NULL: the text is UTF-8. */
const char *vs_text_not_utf8(const char *text, size_t length);

/* Writes the character at `text`, which is not at its end, to `shown`, and returns how many bytes
 * it has. A character that a terminal or a page obeys in place of showing it is written as its
 * number in hexadecimal, as \u001b: controls but for tab and newline, and those of the direction of
 * writing, by which a line reads otherwise than it is. A byte that is no UTF-8 is written as \xff.
 */
enum { VS_SHOWN_SIZE = 8 }; /* bytes, the end included */
size_t vs_text_next(const char *text, char shown[VS_SHOWN_SIZE]);

/* How many UTF-8 characters the text has. */
size_t vs_text_characters(const char *text);
/* Ends a text that is longer than `most` characters, 4 or more, at the end of a word, with three
 * dots behind it. One word that is too long is cut where it must. */
void vs_text_shorten(vs_text *t, size_t most);

/* Returns the number, from 1, of the UTF-8 character that stands at `at` in the line. */
int vs_text_column(const char *line, const char *at);

/* Writes what "%.*g" would and returns its length. It takes a fifth of snprintf's time or less,
 * which matters for tables of a million numbers. */
enum { VS_NUMBER_SIZE = 32 }; /* bytes, the end included */
size_t vs_text_number(char text[VS_NUMBER_SIZE], double value, int digits);
/* Adds what it writes. */
void vs_text_add_number(vs_text *t, double value, int digits);

/* The number that so many significant digits of the value are. */
double vs_text_rounded(double value, int digits);

/* Reads the number that the text begins with as strtod does; *end is what is behind it, or the text
 * where there is none. A number that a double cannot hold is read as NaN: one beyond 1.8e308, and
 * one that is not 0 but below 2.3e-308, of which only some digits would be kept, or none. */
double vs_text_to_number(const char *text, char **end);
/* Says of a number that the text begins with why it is read as NaN, and what would be right, as
 * "too large a number: one below 1e300 is wanted"; NULL: it is not. */
const char *vs_text_out_of_range(const char *text);
