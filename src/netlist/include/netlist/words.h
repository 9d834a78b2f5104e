/* SPDX-License-Identifier: GPL-3.0-or-later
 * The words of a line of a netlist, the parameters NAME=VALUE among them, and the arguments of a
 * call. Braces, brackets and quotes keep together what stands between them. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* A stretch of a text, borrowed from it. */
typedef struct vs_word {
  const char *at;
  size_t n;
} vs_word;

enum { VS_WORDS_MOST = 64 };

/* Splits a text at blanks into at most VS_WORDS_MOST words; the rest is left out. Returns how many
 * there are. */
size_t vs_words_split(const char *text, vs_word words[VS_WORDS_MOST]);

/* True for the word of that text, in capitals or not. */
bool vs_words_is(vs_word word, const char *text);

/* True for one of `count` such texts. */
bool vs_words_among(vs_word word, const char *const *list, size_t count);
#define VS_WORDS_AMONG(word, list) vs_words_among(word, list, sizeof(list) / sizeof *(list))

/* All of that text as a word. */
vs_word vs_words_of(const char *text);

/* Orders words by their letters, in capitals or not, a shorter one before what it begins; less than
 * 0, 0 or more. */
int vs_words_compare(vs_word a, vs_word b);

/* True for a line whose first word is that one, in capitals or not. */
bool vs_words_begin(const char *line, const char *word);

/* Finds the first whole name of n bytes in the text, at or behind `from`, in capitals or not; NULL:
 * there is none. */
const char *vs_words_find(const char *text, const char *from, const char *name, size_t n);

/* True where a name that ends here is given a value: "=" comes next. */
bool vs_words_is_given(const char *end);

/* Finds the parameter "NAME = VALUE" at or behind `from`, outside of braces and brackets. *whole is
 * all of it, *value what stands behind '='. False: it is not there. */
bool vs_words_parameter(const char *from, const char *name, vs_word *whole, vs_word *value);

/* Splits what stands between '(' at `open` and its ')' at commas of that depth. *end is behind the
 * ')'. Returns how many arguments there are; 0 where the bracket is not closed or there are more
 * than VS_WORDS_MOST. */
size_t vs_words_arguments(const char *open, vs_word arguments[VS_WORDS_MOST], const char **end);

/* Goes through the numbers of a source's course, as those of PULSE, up to a ')'. Returns what is
 * behind the next one from s on; NULL: there is none. Braces, brackets and quotes are kept together.
 */
const char *vs_words_number(const char *s, vs_word *number);

/* Writes blanks for the braces of ".subckt F a b {T=1 C=1p}" and "X1 a b F {T=2}", IsSpice's. */
void vs_words_unbrace(char *line);

/* True for a character that a name goes on with. */
bool vs_words_goes_on(char c);

/* ---- words of an element ---- */

/* What ngspice takes for the space between the words of an element. */
#define VS_WORDS_BETWEEN " \t(),"

/* The word at s, up to such space; empty where s is at some, or at the text's end. */
vs_word vs_words_at(const char *s);

/* Where the next word behind the one at s begins; the text's end where there is none. */
const char *vs_words_next(const char *s);

/* True for a name of the node ground, 0 or gnd. */
bool vs_words_is_ground(vs_word node);
