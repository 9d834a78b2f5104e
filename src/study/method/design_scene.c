/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/design_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/json.h"
#include "base/path.h"

/* Adds a text in double quotes, which YAML reads as JSON has it. One that names a file beside the
 * one that it stands in, or in the working folder, becomes the file's whole path. */
static void add_word(const vs_node *node, vs_text *text) {
  char path[2 * VS_PATH_SIZE];
  const char *file = node->where.file, *slash = file ? strrchr(file, '/') : NULL;
  char *whole = NULL;
  if (strchr(node->text, '.') && *node->text != '/') {
    snprintf(path, sizeof path, "%.*s%s", slash ? (int)(slash + 1 - file) : 0, slash ? file : "",
             node->text);
    whole = realpath(path, NULL);
    if (!whole) whole = realpath(node->text, NULL);
  }
  if (whole && access(whole, R_OK)) {
    free(whole);
    whole = NULL;
  }
  vs_json_string(text, whole ? whole : node->text);
  free(whole);
}

static void add_node(const vs_node *node, vs_text *text) {
  const bool map = node->kind == VS_NODE_MAP;
  if (node->kind == VS_NODE_TEXT) {
    if (*node->text) add_word(node, text);
    return;
  }
  vs_text_add(text, "%s", map ? "{" : "[");
  for (const vs_node *n = node->child; n; n = n->next) {
    if (map) vs_json_string(text, n->key);
    if (map) vs_text_add(text, ": ");
    add_node(n, text);
    if (n->next) vs_text_add(text, ", ");
  }
  vs_text_add(text, "%s", map ? "}" : "]");
}

vs_status vs_design_scene_add(const vs_plan *plan, const double *point, vs_text *text,
                              vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_plan_scene(plan, scene, err);
  if (!status) vs_plan_put(plan, point, &scene->tree);
  for (const vs_node *n = status ? NULL : scene->tree.root->child; n; n = n->next) {
    vs_text_add(text, "%s: ", n->key);
    add_node(n, text);
    vs_text_add(text, "\n");
  }
  vs_scene_free(scene);
  free(scene);
  return status;
}
