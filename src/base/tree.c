/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/tree.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/jail.h"
#include "base/text.h"
#include "yaml.h"

/* Gives nodes that stand nowhere, as an empty list or map does, the place of what they stand in. */
static void stand_somewhere(vs_node *node, vs_where where) {
  for (; node; node = node->next) {
    if (!node->where.line) node->where = node->key_where.line ? node->key_where : where;
    if (!node->key_where.line) node->key_where = node->where;
    stand_somewhere(node->child, node->where);
  }
}

/* The longest text that is read. A byte of it takes some forty bytes of memory in the tree; a
 * megabyte holds some 60,000 keys. */
enum { LONGEST_TEXT = 1 << 23 };

static vs_status slurp(const char *path, char **text, size_t *length, vs_error *err) {
  const vs_where where = {.file = path};
  *text = NULL;
  vs_status status = vs_jail_check(path, where, err);
  if (status) return status;
  FILE *f;
  status = vs_hash_open(path, &f, err);
  if (status) return status;
  if (!f) return vs_fail_at(err, where, "cannot be opened: %s", strerror(errno));
  vs_text all = {0};
  char part[4096];
  size_t n;
  while ((n = fread(part, 1, sizeof part - 1, f)) > 0) {
    if (all.length > LONGEST_TEXT) {
      status =
          vs_fail_at(err, where,
                     "longer than %d bytes, and no scene or study is so long; many cases stand "
                     "in a CSV file, which a study's key list names",
                     LONGEST_TEXT);
      break;
    }
    part[n] = '\0';
    vs_text_add(&all, "%s", part);
    if (strlen(part) < n) {
      const char *before = all.text ? all.text : "";
      status = vs_fail_at(err, vs_yaml_place(before, before + all.length, path),
                          "a zero byte; this is no text");
      break;
    }
  }
  if (!status && ferror(f)) status = vs_fail_at(err, where, "cannot be read: %s", strerror(errno));
  fclose(f);
  *text = all.text ? all.text : vs_copy("");
  *length = all.length;
  return status;
}

static vs_status plant(const char *text, size_t length, vs_tree *tree, vs_error *err) {
  vs_status status = vs_yaml_read(text, length, tree->name, &tree->root, err);
  if (!status) stand_somewhere(tree->root, (vs_where){tree->name, 1, 1});
  if (!status && tree->root->kind == VS_NODE_TEXT && !*tree->root->text)
    tree->root->kind = VS_NODE_MAP; /* a file that is "~" says nothing */
  if (!status && tree->root->kind != VS_NODE_MAP)
    status = vs_fail_at(err, tree->root->where, "lines 'key: value' are wanted");
  return status;
}

vs_status vs_tree_read(const char *path, vs_tree *tree, vs_error *err) {
  *tree = (vs_tree){.name = vs_copy(path)};
  char *text;
  size_t length;
  vs_status status = slurp(path, &text, &length, err);
  if (!status) status = plant(text, length, tree, err);
  free(text);
  return status;
}

vs_status vs_tree_parse(const char *text, const char *name, vs_tree *tree, vs_error *err) {
  *tree = (vs_tree){.name = vs_copy(name)};
  return plant(text, strlen(text), tree, err);
}

vs_node vs_tree_word(const char *key, const char *text, vs_where where) {
  return (vs_node){.kind = VS_NODE_TEXT,
                   .key = (char *)(size_t)key,
                   .text = (char *)(size_t)text,
                   .where = where,
                   .key_where = where};
}

vs_node vs_tree_map(const char *key, vs_node *child) {
  vs_node map = vs_tree_word(key, NULL, child->where);
  map.kind = VS_NODE_MAP;
  map.child = child;
  return map;
}

vs_where vs_tree_place(const vs_node *map, const char *key) {
  vs_where where = map ? map->where : (vs_where){0};
  while (map && *key) {
    size_t n = strcspn(key, ".");
    const vs_node *child = map->kind == VS_NODE_MAP ? map->child : NULL;
    while (child && (strncmp(child->key, key, n) != 0 || child->key[n])) child = child->next;
    if (child && child->where.file) where = child->where;
    map = child;
    key += n + (key[n] == '.');
  }
  return where;
}

const vs_node *vs_tree_child(const vs_node *map, const char *key) {
  for (const vs_node *n = map ? map->child : NULL; n; n = n->next)
    if (n->key && !strcmp(n->key, key)) return n;
  return NULL;
}

static vs_node *child_or_new(vs_node *map, const char *key, vs_where where) {
  vs_node **link = &map->child;
  for (; *link; link = &(*link)->next)
    if ((*link)->key && !strcmp((*link)->key, key)) return *link;
  *link = vs_alloc(1, sizeof **link);
  (*link)->key = vs_copy(key);
  (*link)->kind = VS_NODE_MAP;
  (*link)->where = (*link)->key_where = where;
  return *link;
}

/* Gives the node, its siblings and all below them the place `where`. */
static void stand_at(vs_node *node, vs_where where) {
  for (; node; node = node->next) {
    node->where = node->key_where = where;
    stand_at(node->child, where);
  }
}

/* The element of that number, from 1, of a list; NULL: the node is no list, the key no number of
 * one. */
static vs_node *element(const vs_node *list, const char *key) {
  char *end;
  if (list->kind != VS_NODE_LIST || !isdigit((unsigned char)*key)) return NULL;
  unsigned long number = strtoul(key, &end, 10);
  vs_node *n = list->child;
  while (n && --number) n = n->next;
  return *end ? NULL : n;
}

/* Error: the dotted key goes through a list without the number of one of its elements. It would
 * throw the list away. */
static vs_status check_lists(const vs_tree *tree, const char *dotted, vs_where where,
                             vs_error *err) {
  const vs_node *at = tree->root;
  char *path = vs_copy(dotted), *rest = path;
  vs_status status = VS_OK;
  for (char *key; at && !status && (key = strsep(&rest, "."));) {
    const vs_node *next = element(at, key);
    if (at->kind == VS_NODE_LIST && at->child && !next) {
      int count = 0, before = (int)(key - path) - 1;
      for (const vs_node *n = at->child; n; n = n->next) count++;
      status =
          vs_fail_at(err, where, "%s: %.*s is a list of %d; its elements are %.*s.1 to %.*s.%d",
                     dotted, before, dotted, count, before, dotted, before, dotted, count);
    }
    at = next ? next : vs_tree_child(at, key);
  }
  free(path);
  return status;
}

/* The child whose own key is this one, dots and all: "r1.power" is a key of a scene's ratings.
 * NULL: there is none. */
static vs_node *child_with_dots(const vs_node *map, const char *key) {
  if (!strchr(key, '.')) return NULL;
  for (vs_node *n = map->child; n; n = n->next)
    if (n->key && !strcmp(n->key, key)) return n;
  return NULL;
}

/* Returns the node of a dotted key; one of its words may be the number of a list's element. It is
 * made where it is missing, and so are the maps above it. */
static vs_node *reach(vs_tree *tree, const char *dotted, vs_where where) {
  vs_node *at = tree->root;
  char *path = vs_copy(dotted), *rest = path;
  for (char *key; rest;) {
    vs_node *whole = at->kind == VS_NODE_MAP ? child_with_dots(at, rest) : NULL;
    if (whole) at = whole;
    if (whole) break;
    key = strsep(&rest, ".");
    vs_node *numbered = element(at, key);
    if (numbered) {
      at = numbered;
      continue;
    }
    if (at->kind != VS_NODE_MAP) { /* a text stands where a map is wanted: the newer value wins */
      vs_node_free(at->child);
      free(at->text);
      at->text = NULL;
      at->child = NULL;
      at->kind = VS_NODE_MAP;
      at->where = at->key_where = where;
    }
    at = child_or_new(at, key, where);
  }
  free(path);
  return at;
}

void vs_tree_copy(const vs_tree *tree, vs_tree *copy) {
  *copy = (vs_tree){.root = vs_node_copy(tree->root), .name = vs_copy(tree->name)};
}

static void graft(vs_tree *tree, const char *key, const vs_node *value) {
  vs_node *at = reach(tree, key, value->key_where);
  vs_node_free(at->child);
  free(at->text);
  at->kind = value->kind;
  at->text = value->text ? vs_copy(value->text) : NULL;
  at->child = vs_node_copy(value->child);
  at->where = value->where;
  at->key_where = value->key_where;
}

vs_status vs_tree_graft(vs_tree *tree, const char *key, const vs_node *value, vs_error *err) {
  vs_status status = check_lists(tree, key, value->key_where, err);
  if (!status) graft(tree, key, value);
  return status;
}

void vs_tree_put(vs_tree *tree, const char *key, const char *text, vs_where where) {
  const vs_node value = vs_tree_word(NULL, text, where);
  graft(tree, key, &value);
}

/* Reads the text behind the sign as YAML. */
static vs_status parse_value(const char *text, vs_where where, vs_node **value, vs_error *err) {
  const char *yaml = strcmp(text, "-") ? text : "'-'"; /* a lone - is a text here, no list */
  vs_status status = vs_yaml_read(yaml, strlen(yaml), "--set", value, err);
  if (status) {
    const vs_error why = *err;
    return vs_fail_at(err, where, "the value cannot be read: %s", why.text + why.place_size);
  }
  if (!*text) { /* nothing after the sign: an empty text, not an empty map */
    (*value)->kind = VS_NODE_TEXT;
    (*value)->text = vs_copy("");
  }
  return VS_OK;
}

/* Moves the value's contents to the node, and frees what is left of the value. */
static void take_value(vs_node *at, vs_node *value, vs_where where) {
  vs_node_free(at->child);
  free(at->text);
  at->kind = value->kind;
  at->text = value->text;
  at->child = value->child;
  at->where = at->key_where = where;
  stand_at(at->child, where);
  free(value->key);
  free(value);
}

vs_status vs_tree_set(vs_tree *tree, const char *assignment, vs_error *err) {
  const char *equals = strchr(assignment, '=');
  vs_text label = {0};
  vs_text_add(&label, "--set %s", assignment);
  vs_where where = {.file = label.text}; /* kept in tree->labels as long as the tree */
  vs_node *value = NULL;
  vs_status status = !equals || equals == assignment
                         ? vs_fail_at(err, where, "write KEY=VALUE, for example firing.angle=95deg")
                         : parse_value(equals + 1, where, &value, err);
  char *path = vs_alloc_part(assignment, equals ? (size_t)(equals - assignment) : 0);
  if (!status) status = check_lists(tree, path, where, err);
  if (!status) take_value(reach(tree, path, where), value, where);
  free(path);
  if (status) {
    vs_node_free(value);
    vs_text_free(&label);
    return status;
  }
  vs_node *keep = vs_alloc(1, sizeof *keep); /* it owns the label */
  keep->text = label.text;
  keep->next = tree->labels;
  tree->labels = keep;
  return VS_OK;
}

void vs_tree_free(vs_tree *tree) {
  vs_node_free(tree->root);
  vs_node_free(tree->labels);
  free(tree->name);
  *tree = (vs_tree){0};
}
