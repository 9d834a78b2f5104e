/* SPDX-License-Identifier: GPL-3.0-or-later
 * Expressions of ngspice as trees: what stands in braces or quotes, behind the V= or I= of a B
 * source, in a .param, and what a .func comes to. Operators bind as in ngspice's B sources: ?:, ||,
 * &&, == and !=, < and >, + and -, * and /, the signs before a value, and ^. Of like ones the left
 * is first: 2^3^2 is 64, in braces, too.
 *
 * Every text has a tree: what cannot be read is passed by, sign by sign, and the names behind it
 * are there all the same. */
#pragma once

#include "base/text.h"
#include "netlist/words.h"

/* What a node is. Its children are: SIGN one, OPERATOR two, CHOICE (a ? b : c) three, BRACKET those
 * within it, CALL its arguments. The arguments of v(...) and i(...) are of the kind SIGNAL: names
 * of nodes and elements, which may have other characters than names have. */
enum {
  VS_EXPR_NUMBER,
  VS_EXPR_NAME,
  VS_EXPR_TEXT, /* in double quotes */
  VS_EXPR_CALL,
  VS_EXPR_SIGNAL,
  VS_EXPR_SIGN,
  VS_EXPR_OPERATOR,
  VS_EXPR_CHOICE,
  VS_EXPR_BRACKET
};

typedef struct vs_expr_node {
  int kind;
  vs_word word;       /* the number, the name, the operator, the opening bracket */
  vs_word whole;      /* all of its text */
  size_t child, next; /* the first child, and the next one of the same parent; 0: there is none */
} vs_expr_node;

/* Begin with vs_expr_read; end with vs_expr_free. */
typedef struct vs_expr {
  vs_expr_node *node; /* node 0 is none: its child is the tree; where the text is not whole,
                               several stand beside each other there. The words are borrowed */
  size_t count;
  bool whole; /* the text is one expression, and nothing was passed by */
} vs_expr;

/* Reads a text, also one with its braces or quotes. */
void vs_expr_read(vs_expr *e, vs_word text);
void vs_expr_free(vs_expr *e);

/* For tests: adds the text of the node and of all below it, with a blank on each side of an
 * operator. */
void vs_expr_write(const vs_expr *e, size_t node, vs_text *out);
