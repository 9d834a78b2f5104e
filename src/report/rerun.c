/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rerun.h"

#include <string.h>

/* ---- values ---- */

/* Writes a value as it may stand behind `--set KEY=`. */
static void add_value(const vs_node *node, vs_text *text) {
  const bool map = node->kind == VS_NODE_MAP;
  if (node->kind == VS_NODE_TEXT) {
    vs_text_add(text, "%s", node->text);
    return;
  }
  vs_text_add(text, map ? "{" : "[");
  for (const vs_node *n = node->child; n; n = n->next) {
    if (map) vs_text_add(text, "%s: ", n->key);
    add_value(n, text);
    if (n->next) vs_text_add(text, ", ");
  }
  vs_text_add(text, map ? "}" : "]");
}

/* Prints a word of the command, in quotes where a shell would take it apart. */
static void print_set(const char *set, FILE *out) {
  static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                              "_.,:/%+-=@";
  const char *quote = set[strspn(set, PLAIN)] ? "'" : "";
  fprintf(out, " --set %s%s%s", quote, set, quote);
}

/* ---- what the fit set ---- */

/* A map is told key by key, as it goes over the scene's own map key by key. */
static void show_node(const char *key, const vs_node *node, FILE *out) {
  vs_text set = {0};
  if (node->kind == VS_NODE_MAP && node->child) {
    for (const vs_node *n = node->child; n; n = n->next) {
      vs_text below = {0};
      vs_text_add(&below, "%s.%s", key, n->key);
      show_node(below.text, n, out);
      vs_text_free(&below);
    }
    return;
  }
  vs_text_add(&set, "%s=", key);
  add_value(node, &set);
  print_set(set.text, out);
  vs_text_free(&set);
}

static void show_map(const vs_node *map, FILE *out) {
  for (const vs_node *n = map ? map->child : NULL; n; n = n->next) show_node(n->key, n, out);
}

/* ---- a run ---- */

/* The map of the run with that number; NULL: the fit has but one, at its root. */
static const vs_node *find_run(const vs_inquiry *q, size_t number) {
  const vs_node *runs = vs_tree_child(q->tree.root, "runs");
  const vs_node *own = runs ? runs->child : NULL;
  for (size_t k = 0; own && k < number; k++) own = own->next;
  return own;
}

static void show_run(const vs_outcome *o, size_t number, FILE *out) {
  const vs_inquiry *q = o->inquiry;
  const vs_node *root = q->tree.root, *own = find_run(q, number);
  const vs_node *scene = vs_tree_child(own, "scene");
  if (!scene) scene = vs_tree_child(root, "scene");
  int periods = q->runs[number].periods;
  fprintf(out, "vibrospice %s %s", periods ? "steady" : "run",
          scene && scene->text ? scene->text : "paper");
  if (periods > 1) fprintf(out, " --period %d", periods);
  show_map(vs_tree_child(root, "set"), out);
  show_map(vs_tree_child(own, "set"), out);
  for (size_t k = 0; k < q->n_sets; k++)
    if (!vs_inquiry_owns(q->sets[k])) print_set(q->sets[k], out);
  for (size_t k = 0; k < q->n_unknowns; k++) {
    const vs_unknown *u = &q->unknowns[k];
    if (u->run < 0 || u->run == (int)number)
      fprintf(out, " --set %s=%.7g%s", u->axis.key, o->estimate.value[k], u->axis.unit);
  }
  fputc('\n', out);
}

void vs_rerun_show(const vs_outcome *o, FILE *out) {
  for (size_t r = 0; r < o->inquiry->n_runs; r++) {
    fputs(r ? "        " : "\nrun it  ", out);
    show_run(o, r, out);
  }
}
