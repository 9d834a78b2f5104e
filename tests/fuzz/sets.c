/* SPDX-License-Identifier: GPL-3.0-or-later
 * Overlays of the command line: each line is the KEY=VALUE of a --set over the shipped scene's
 * tree. */
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "run/scene.h"
#include "targets.h"

enum { MOST_SETS = 8 };

static const char BASE[] = "machine: {trough_mass: 0.83 kg}\n"
                           "run: {until: 2 s}\n"
                           "record: [p, i]\n"
                           "events: {dip: {kind: sag, at: 0.5 s}}\n";

/* What a copy of the tree must have, too. */
static void compare(const vs_node *a, const vs_node *b) {
  for (; a && b; a = a->next, b = b->next) {
    FUZZ_HOLDS(a->kind == b->kind && !a->key == !b->key && !a->text == !b->text);
    FUZZ_HOLDS(!a->key || !strcmp(a->key, b->key));
    FUZZ_HOLDS(!a->text || !strcmp(a->text, b->text));
    compare(a->child, b->child);
  }
  FUZZ_HOLDS(!a && !b);
}

/* The tree that all texts are set over. Copies of it point to its names. */
static const vs_tree *base(void) {
  static vs_tree tree;
  vs_error err = {0};
  if (!tree.root) FUZZ_HOLDS(!vs_tree_parse(BASE, "base", &tree, &err));
  return &tree;
}

static void take(const char *text, size_t size) {
  vs_tree tree, copy;
  vs_error err = {0};
  char *all = vs_copy(text), *rest = all, *line;
  (void)size;
  vs_tree_copy(base(), &tree);
  for (int k = 0; k < MOST_SETS && (line = strsep(&rest, "\n")); k++)
    fuzz_judge(vs_tree_set(&tree, line, &err), &err);
  vs_tree_copy(&tree, &copy);
  compare(tree.root, copy.root);
  vs_tree_free(&copy);
  vs_tree_free(&tree);
  free(all);
}

const fuzz_target fuzz_sets = {"sets", take, NULL, NULL};
