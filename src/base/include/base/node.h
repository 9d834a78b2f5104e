/* SPDX-License-Identifier: GPL-3.0-or-later
 * Keys, lists and texts that remember where they stood. */
#ifndef VS_BASE_NODE_H
#define VS_BASE_NODE_H

#include "base/error.h"

typedef enum vs_node_kind { VS_NODE_TEXT, VS_NODE_LIST, VS_NODE_MAP } vs_node_kind;

/* One key with its value, or one element of a list. Nodes of a tree own their strings and what
 * hangs below them. */
typedef struct vs_node {
  vs_node_kind kind;
  char *key;             /* its name inside a map, else NULL */
  char *text;            /* a VS_NODE_TEXT's text, else NULL */
  struct vs_node *child; /* first element of a list or map */
  struct vs_node *next;  /* next sibling */
  vs_where where;        /* where the value stands */
  vs_where key_where;    /* where its key stands */
} vs_node;

/* Frees the node, its siblings behind it, and all below them; NULL: there is nothing to free. */
void vs_node_free(vs_node *node);

/* Copies the node, its siblings behind it, and all below them. Their places point to the same file
 * names. The caller frees the copy. */
vs_node *vs_node_copy(const vs_node *node);

#endif
