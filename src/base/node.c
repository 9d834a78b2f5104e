/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/node.h"

#include <stdlib.h>

#include "base/alloc.h"

void vs_node_free(vs_node *node) {
  while (node) {
    vs_node *next = node->next;
    vs_node_free(node->child);
    free(node->key);
    free(node->text);
    free(node);
    node = next;
  }
}

vs_node *vs_node_copy(const vs_node *node) {
  vs_node *first = NULL, **tail = &first;
  for (; node; node = node->next, tail = &(*tail)->next) {
    *tail = vs_alloc(1, sizeof **tail);
    **tail = *node;
    (*tail)->next = NULL;
    (*tail)->key = node->key ? vs_copy(node->key) : NULL;
    (*tail)->text = node->text ? vs_copy(node->text) : NULL;
    (*tail)->child = vs_node_copy(node->child);
  }
  return first;
}
