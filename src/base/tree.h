/* SPDX-License-Identifier: GPL-3.0-or-later
 * A scene or study file as a tree of keys, lists and texts that remember where they stood. */
#ifndef VS_BASE_TREE_H
#define VS_BASE_TREE_H

#include "base/error.h"

typedef enum vs_node_kind { VS_NODE_TEXT, VS_NODE_LIST, VS_NODE_MAP } vs_node_kind;

typedef struct vs_node {
  vs_node_kind kind;
  char *key;             /* its name inside a map, else NULL */
  char *text;            /* a VS_NODE_TEXT's text, else NULL */
  struct vs_node *child; /* first element of a list or map */
  struct vs_node *next;  /* next sibling */
  vs_where where;        /* where the value stands */
  vs_where key_where;    /* where its key stands */
} vs_node;

typedef struct vs_tree {
  vs_node *root;   /* always a map; empty for an empty file, which is a valid scene */
  char *name;      /* the file's */
  vs_node *labels; /* what --set values call their place; owned here */
} vs_tree;

/* Errors: unreadable file, YAML that does not parse, a root that is no map, aliases, a second
 * document. */
vs_status vs_tree_read(const char *path, vs_tree *tree, vs_error *err);

/* A copy with nodes of its own. Their places name the original's file and labels, which must live
 * as long. */
void vs_tree_copy(const vs_tree *tree, vs_tree *copy);

/* Sets "a.b.c=value", the value read as YAML, over what stands there. Its place is "--set
 * a.b.c=value". */
vs_status vs_tree_set(vs_tree *tree, const char *assignment, vs_error *err);

/* Sets the dotted key to a copy of value, with its places, or to a plain text that stands there. */
void vs_tree_graft(vs_tree *tree, const char *key, const vs_node *value);
void vs_tree_put(vs_tree *tree, const char *key, const char *text, vs_where where);
void vs_tree_free(vs_tree *tree);

/* The map's value of that key; NULL when it has none or map is NULL. */
const vs_node *vs_tree_child(const vs_node *map, const char *key);

/* A text, and a map of one child, that belong to no tree, for readers that want a node where the
 * program itself has a word. They borrow what they are made of and must not be freed; key may be
 * NULL. */
vs_node vs_tree_word(const char *key, const char *text, vs_where where);
vs_node vs_tree_map(const char *key, vs_node *child);

#endif
