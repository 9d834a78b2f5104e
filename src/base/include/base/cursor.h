/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reading a line of the netlist contract from left to right, word by word. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

typedef struct vs_cursor {
  const char *start, *at; /* the line as a whole, and what is to be read next; borrowed */
  vs_where line;          /* the line's place; the column is that of its beginning */
  const int *column; /* for each byte of the line, the column it has in the file; NULL: its own */
} vs_cursor;

/* The place of what is to be read next. */
vs_where vs_cursor_here(const vs_cursor *c);

/* Goes on to the next character that is no blank. */
void vs_cursor_skip(vs_cursor *c);

/* The following four skip blanks first. Those that return false leave the cursor there. */

/* Takes the symbol. Returns false where another character stands. */
bool vs_cursor_take(vs_cursor *c, char symbol);
/* Takes the word, which must be whole. Returns false where another stands. */
bool vs_cursor_is(vs_cursor *c, const char *word);
/* Takes a word of letters, digits, '_' and the characters in `also`. Returns false where there is
 * none, or where it does not fit into size bytes. */
bool vs_cursor_word(vs_cursor *c, const char *also, char *word, size_t size);
/* Takes everything up to the next blank; what does not fit into size bytes is cut off. */
void vs_cursor_token(vs_cursor *c, char *token, size_t size);

/* Takes a "TEXT" that ends the line, or nothing where the line ends already; the text is empty
 * then. Errors with their place: something else stands there, or behind the text. */
vs_status vs_cursor_text(vs_cursor *c, char *text, size_t size, vs_error *err);
/* Takes "NAME =". Error with its place: something else stands there. */
vs_status vs_cursor_name(vs_cursor *c, char *name, size_t size, vs_error *err);

/* Turns a text into lower case, in place: ngspice knows no capitals. */
void vs_cursor_lower(char *text);
