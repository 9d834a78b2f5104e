/* SPDX-License-Identifier: GPL-3.0-or-later
 * The elements of a netlist outside of subcircuits, and the nodes between them. */
#pragma once

#include "base/names.h"
#include "base/text.h"
#include "import/values.h"

enum { VS_ELEMENTS_NODES = 24, VS_ELEMENTS_WORDS = 64, VS_ELEMENTS_NAME = 64 };

typedef struct vs_element {
  size_t card;                 /* index of its line */
  char letter;                 /* its name's first, in lower case, which tells its kind */
  char name[VS_ELEMENTS_NAME]; /* as the deck calls it */
  char key[VS_ELEMENTS_NAME];  /* the same in lower case, without the R_ of PSpice's R_R1: its name
                                  in lines of the contract */
  vs_word words[VS_ELEMENTS_WORDS]; /* of its line; brackets with their contents belong to the
                                       word before them: SINE(0 325 50) */
  int n_words;
  bool coupled;                 /* a K element couples it */
  int n_nodes;                  /* words 1 to n_nodes are nodes */
  int nodes[VS_ELEMENTS_NODES]; /* indices into vs_elements.nodes */
} vs_element;

typedef struct vs_elements_node {
  char said[VS_ELEMENTS_NAME]; /* as the netlist calls it, in lower case */
  char name[VS_ELEMENTS_NAME]; /* as the deck does: lower case, letters and digits and '_'; "0" */
  bool named;                  /* by a person, not by the program that wrote the netlist */
  int ends;                    /* how many ends of elements meet there */
  size_t at[2];                /* the elements of the first and the last of these ends */
} vs_elements_node;

/* Begins as {0}; ends with vs_elements_free. */
typedef struct vs_elements {
  const vs_listing *listing; /* borrowed */
  vs_element *elements;      /* owned, as nodes are */
  size_t count;
  vs_elements_node *nodes;
  size_t n_nodes;
  vs_names said, names;              /* indices of nodes by what netlist and deck call them */
  vs_names by_said, by_name, by_key; /* the same of elements; of several, the first */
} vs_elements;

/* Error, with its place: a line is not an element. */
vs_status vs_elements_read(vs_elements *wiring, const vs_listing *listing, vs_error *err);
void vs_elements_free(vs_elements *wiring);

/* Reads the line of a source, V or I, which may stand in a subcircuit: its words and name, but not
 * its nodes. */
void vs_elements_source_of(const vs_listing *listing, size_t card, vs_element *element);

/* The element's n-th word (0: its name), or the line from that word on; no bytes: there is none. */
vs_word vs_elements_word(const vs_element *element, int n);
vs_word vs_elements_rest(const vs_element *element, int n);
/* The value of NAME=VALUE in the element's line; no bytes: there is none. */
vs_word vs_elements_option(const vs_elements *wiring, const vs_element *element, const char *name);
/* The number that this value is, known before a run; false: there is none. */
bool vs_elements_number(const vs_elements *wiring, const vs_values *values,
                        const vs_element *element, const char *name, double *value);
/* True where the element's line has that NAME=VALUE, and the value is not 0. */
bool vs_elements_sets(const vs_elements *wiring, const vs_values *values, const vs_element *element,
                      const char *name);
/* True where the element's value depends on temperature. */
bool vs_elements_heats(const vs_elements *wiring, const vs_values *values,
                       const vs_element *element);
/* True where a .model stands before or after the element's value. */
bool vs_elements_has_model(const vs_elements *wiring, const vs_element *element);
/* The place of the element's n-th word, if the word is in the first of the element's lines. */
vs_where vs_elements_where(const vs_elements *wiring, const vs_element *element, int n);

/* The element with the netlist's or the deck's name, ignoring case. NULL: none. */
const vs_element *vs_elements_find(const vs_elements *wiring, vs_word name);
/* The deck's name of the element's n-th node, from 0. */
const char *vs_elements_node_of(const vs_elements *wiring, const vs_element *element, int n);
/* The other element at a node that joins this element and exactly one other; NULL: there are more
 * or fewer, or it is node 0. */
const vs_element *vs_elements_next(const vs_elements *wiring, const vs_element *element, int node);

/* The name of the model or subcircuit of an element that has one, in lower case; NULL: it has none.
 * free() it. */
char *vs_elements_model(const vs_elements *wiring, const vs_element *element);
/* The index in the listing of the .model or .subckt line that defines it; -1: there is none. */
int vs_elements_defined(const vs_listing *listing, vs_word model);

/* Adds the card's text with the deck's names of nodes. */
void vs_elements_rename(const vs_elements *wiring, const char *text, vs_text *out);

/* True where an element or node of the deck has this name. */
bool vs_elements_is_taken(const vs_elements *wiring, const char *name);
