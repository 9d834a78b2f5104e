/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reading a line of the netlist contract from left to right. */
#ifndef VS_DECK_CURSOR_H
#define VS_DECK_CURSOR_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

typedef struct vs_cursor {
  const char *start, *at; /* the line; what is to be read next */
  vs_where line;
} vs_cursor;

vs_where vs_cursor_here(const vs_cursor *c);
void vs_cursor_skip(vs_cursor *c); /* blanks */

/* Each skips blanks first. */
bool vs_cursor_take(vs_cursor *c, char symbol); /* it alone */
/* Letters, digits, '_' and what else `also` names; false: there are none, or too many. */
bool vs_cursor_word(vs_cursor *c, const char *also, char *word, size_t size);
void vs_cursor_token(vs_cursor *c, char *token, size_t size); /* up to the next blank */
bool vs_cursor_is(vs_cursor *c, const char *word); /* that word comes next: it is taken */

/* "TEXT" at the end of the line, or nothing. */
vs_status vs_cursor_text(vs_cursor *c, char *text, size_t size, vs_error *err);
/* NAME = */
vs_status vs_cursor_name(vs_cursor *c, char *name, size_t size, vs_error *err);

#endif
