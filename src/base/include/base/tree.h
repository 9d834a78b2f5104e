/* SPDX-License-Identifier: GPL-3.0-or-later
 * A scene or study file, which is YAML, as a tree of keys, lists and texts that remember where they
 * stood. */
#pragma once

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

typedef struct vs_tree {
  vs_node *root;   /* always a map; empty for an empty file, which is a valid scene */
  char *name;      /* the file's */
  vs_node *labels; /* the texts "--set KEY=VALUE" that places of such values point to */
} vs_tree;

/* Reads the file. Errors: it cannot be read, is not YAML, has a root that is no map, an alias or a
 * second document. vs_tree_free even then. */
vs_status vs_tree_read(const char *path, vs_tree *tree, vs_error *err);

/* The same for a text in memory, which errors call by that name. */
vs_status vs_tree_parse(const char *text, const char *name, vs_tree *tree, vs_error *err);

/* Makes a copy with nodes of its own. Their places point to the file name and labels of the
 * original, which must live as long as the copy. */
void vs_tree_copy(const vs_tree *tree, vs_tree *copy);

/* Sets "a.b.c=value" over what stands there; "a.1.c" is c of the first element of a list a. The
 * value is read as YAML; its place is called "--set a.b.c=value". Error: there is no sign, the
 * value is not YAML, or the key goes through a list without the number of an element that it has.
 */
vs_status vs_tree_set(vs_tree *tree, const char *assignment, vs_error *err);

/* Both set the dotted key, and make the maps above it that are missing: to a copy of value with its
 * places, or to a plain text that stands at `where`. Error, with the place of the value's key: as
 * above, of a list; who puts a text knows the key. */
vs_status vs_tree_graft(vs_tree *tree, const char *key, const vs_node *value, vs_error *err);
void vs_tree_put(vs_tree *tree, const char *key, const char *text, vs_where where);
/* Takes the root's key out, if it is there. */
void vs_tree_drop(vs_tree *tree, const char *key);
/* Gives the dotted key, which goes through no list, what it has in the other tree. Where that has
 * not all of the maps above it, what is above goes, too: a section takes its defaults again. */
void vs_tree_put_back(vs_tree *tree, const vs_tree *own, const char *key);
void vs_tree_free(vs_tree *tree);

/* The map's value of that key; NULL when it has none or map is NULL. */
const vs_node *vs_tree_child(const vs_node *map, const char *key);
/* The same below the map, of a dotted key; the map itself of an empty one. */
const vs_node *vs_tree_find(const vs_node *map, const char *key);
/* vs_tree_child where that value is a map; else NULL. Each of its children has a key. */
const vs_node *vs_tree_child_map(const vs_node *map, const char *key);

/* Where the dotted key stands below the map: its value. Where there is none, the place of what is
 * nearest above it; so a message about a default points to where the key would have to be. No place
 * only where the map is NULL or stands nowhere itself. */
vs_where vs_tree_place(const vs_node *map, const char *key);

/* A text, and a map of one child, that belong to no tree, for readers that want a node where the
 * program itself has a word. They borrow what they are made of and must not be freed; key may be
 * NULL. */
vs_node vs_tree_word(const char *key, const char *text, vs_where where);
vs_node vs_tree_map(const char *key, vs_node *child);
