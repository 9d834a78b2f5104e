/* SPDX-License-Identifier: GPL-3.0-or-later
 * A netlist taken apart: a card for each of its lines, the scopes that its subcircuits are, and
 * what is defined in each. It is made in one go, in a time proportional to the netlist. All words
 * are borrowed from the lines' texts, so that vs_line_place_of tells where each stands in the
 * user's file. */
#pragma once

#include "base/names.h"
#include "base/text.h"
#include "netlist/line.h"

/* What a line is. VS_CARDS_OTHER: a statement that nothing is to be known of but its text. */
enum {
  VS_CARDS_ELEMENT,
  VS_CARDS_SUBCKT,
  VS_CARDS_ENDS,
  VS_CARDS_MODEL,
  VS_CARDS_PARAM,
  VS_CARDS_FUNC,
  VS_CARDS_GLOBAL,
  VS_CARDS_IF,
  VS_CARDS_ENDIF,
  VS_CARDS_OTHER
};

/* What stands behind the name in a line: a word, or NAME=VALUE. The brackets and commas between
 * words are left out, as ngspice does; braces and quotes stay with what is in them. */
typedef struct vs_argument {
  vs_word name; /* no bytes: the value stands alone */
  vs_word value;
} vs_argument;

typedef struct vs_netlist_card {
  int kind;         /* VS_CARDS_... */
  char letter;      /* the line's first, in lower case: of an element its sort */
  bool conditional; /* it stands between .if and .endif */
  size_t scope;     /* that it stands in; of .ends: that it closes */
  size_t opens;     /* .subckt: the scope that begins with it; else 0 */
  vs_word name;     /* of the element, or what the statement defines */
  vs_word model; /* of an element its model, of an instance the subcircuit, of .model the type; no
                    bytes: it has none */
  size_t first;  /* the first of its arguments, an index into vs_cards.arguments */
  size_t words;  /* how many of these stand alone, before the first NAME=VALUE */
  size_t count;  /* of all of them */
  size_t nodes;  /* how many words are nodes: the first ones. Of a .subckt they are its own */
} vs_netlist_card;

/* A subcircuit. Scope 0 is the whole netlist, and has no name. */
typedef struct vs_netlist_scope {
  vs_word name;       /* borrowed from its .subckt, which is card first - 1 */
  size_t outer;       /* the scope that it is defined in; 0 of scope 0 */
  size_t first, last; /* its cards from first up to before last, with those of scopes within it;
                         `last` is its .ends, or the netlist's end where none closes it */
} vs_netlist_scope;

/* What is defined in a scope: VS_CARDS_SUBCKT, _MODEL, _PARAM or _FUNC. The parameters in the line
 * of a .subckt are defined in the scope that it opens. */
typedef struct vs_netlist_definition {
  int kind;
  size_t scope, card;
  vs_word name;
  vs_word arguments; /* FUNC: what stands in the brackets behind the name */
  vs_word body;      /* PARAM: the value; FUNC: the formula, with its braces */
  bool twin;         /* the scope has another one of this kind and name */
} vs_netlist_definition;

/* A name that means a subcircuit of another name, wherever it is called: a deck's parameter that is
 * a part. */
typedef struct vs_cards_choice {
  const char *name, *subcircuit; /* borrowed; an empty subcircuit: it is not chosen yet */
} vs_cards_choice;
enum { VS_CARDS_CHOICES = 16 };

/* Begin with vs_cards_read; end with vs_cards_free. */
typedef struct vs_cards {
  const vs_line *lines; /* borrowed */
  vs_netlist_card *card;
  size_t count; /* of lines and of cards: card k is of line k */
  vs_argument *arguments;
  size_t n_arguments;
  vs_netlist_scope *scope;
  size_t n_scopes;
  vs_netlist_definition *definition; /* in the order of the lines */
  size_t n_definitions;
  vs_names globals; /* nodes of lines .global, which are the same in all subcircuits */
  vs_names numbers; /* of the definitions, the first of each kind, name and scope */
  vs_cards_choice choice[VS_CARDS_CHOICES]; /* vs_cards_read leaves them to others */
  size_t n_choices;
} vs_cards;

void vs_cards_read(vs_cards *cards, const vs_line *lines, size_t count);
void vs_cards_free(vs_cards *cards);

/* The n-th word of a card behind its name, from 0; no bytes: it has none. */
vs_word vs_cards_word(const vs_cards *cards, const vs_netlist_card *card, size_t n);

/* For tests: adds the line that card k is, as ngspice reads it, in one way of writing: the words
 * with a blank between them. What is not taken apart is written as it stands. */
void vs_cards_write(const vs_cards *cards, size_t k, vs_text *out);

/* The value of the first NAME=VALUE of that name; no bytes: the card has none. */
vs_word vs_cards_value(const vs_cards *cards, const vs_netlist_card *card, const char *name);

/* True for a source that the program drives, "Vname n m external" (or Iname). */
bool vs_cards_is_external(const vs_cards *cards, const vs_netlist_card *card);

/* True for an element that is connected to the node of that name. Of a code model, A..., any word
 * may be a node. */
bool vs_cards_has_node(const vs_cards *cards, const vs_netlist_card *card, vs_word node);

/* The card behind card k in the same scope: behind a .subckt stands what follows its .ends. */
size_t vs_cards_next(const vs_cards *cards, size_t k);

/* The definition of that kind and name in the scope itself; NULL: it has none. */
const vs_netlist_definition *vs_cards_find(const vs_cards *cards, size_t scope, int kind,
                                           vs_word name);

/* What a name means to a line of a scope, by ngspice's own rule: the first of that name in the
 * scope, else in the one that this is defined in, and so on; who calls the scope makes no
 * difference. Of a subcircuit the name may be one of cards->choice. NULL: it is not defined. */
const vs_netlist_definition *vs_cards_resolve(const vs_cards *cards, size_t scope, int kind,
                                              vs_word name);

/* The scope of the subcircuit that a card is an instance of; 0: it is none, or not defined. */
size_t vs_cards_called(const vs_cards *cards, const vs_netlist_card *card);

/* ---- what a subcircuit of three pins is, by what is connected within it ---- */

typedef struct vs_cards_latch {
  bool two_ways; /* transistors of one type have their emitters at two of the pins: a triac */
  int gate;      /* the only pin at which no emitter is; -1: it is not told so */
  int near; /* the pin on which the gate stands: by resistors, else by junctions, it has at most
               half of the way to it; -1: neither, or the two contradict each other */
} vs_cards_latch;

/* Looks at a scope with what it calls. gate: the pin that is known to be it, from 0; -1: none. */
vs_cards_latch vs_cards_see_latch(const vs_cards *cards, size_t scope, int gate);

/* ---- unfolded ---- */

/* A subcircuit in the whole circuit, or the circuit itself. */
typedef struct vs_instance {
  const struct vs_instance *outer; /* that it stands in; NULL: it is the circuit */
  const vs_netlist_card *card;     /* its line X; NULL likewise */
  size_t scope;                    /* what is in it */
  int depth;                       /* 0 of the circuit */
} vs_instance;

/* What is to be done behind an element: nothing more at all; the next one; what the subcircuit has,
 * of which it is an instance. */
enum { VS_CARDS_STOP, VS_CARDS_PASS, VS_CARDS_ENTER };
typedef int vs_cards_visit(void *ctx, const vs_instance *in, size_t card);

/* Calls visit(ctx, in, card) for each element of the circuit, those of subcircuits where it enters
 * them. It must not enter one within itself without end. Returns false where it has stopped. */
bool vs_cards_expand(const vs_cards *cards, vs_cards_visit *visit, void *ctx);

/* Adds a name that the solver gives to what stands in an instance, in lower case: "xa.xb.r1" of the
 * element r1, and what a node is called there, which may be a node further out. */
void vs_cards_add_name(const vs_instance *in, vs_word name, vs_text *out);
void vs_cards_add_node(const vs_cards *cards, const vs_instance *in, vs_word node, vs_text *out);
