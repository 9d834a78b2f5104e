/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/method.h"

#include <string.h>

size_t vs_method_count(const vs_method *const *methods) {
  size_t n = 0;
  while (methods[n]) n++;
  return n;
}

const vs_method *vs_method_named(const vs_method *const *methods, const char *name, size_t length) {
  for (; *methods; methods++)
    if (strlen((*methods)->name) == length && !strncmp((*methods)->name, name, length))
      return *methods;
  return NULL;
}

const vs_method *vs_method_claiming(const vs_method *const *methods, const vs_node *section,
                                    vs_error *err) {
  vs_text names = {0};
  const vs_method *found = NULL;
  for (; *methods && !found; methods++) {
    if (strcmp((*methods)->key, section->key)) continue;
    if (!(*methods)->claims || (*methods)->claims(section)) found = *methods;
    vs_text_add(&names, "%s%s", names.length ? ", " : "", (*methods)->name);
  }
  const vs_node *word = vs_tree_child(section, "method");
  if (!found)
    vs_fail_at(err, word ? word->where : section->where, "%s: no method '%s'; there are: %s",
               section->key, word && word->text ? word->text : "",
               names.text ? names.text : "none");
  vs_text_free(&names);
  return found;
}

size_t vs_method_keys(const vs_method *const *methods, const char **keys) {
  size_t n = 0;
  for (; *methods; methods++) {
    size_t k = 0;
    while (k < n && strcmp(keys[k], (*methods)->key)) k++;
    if (k == n) keys[n++] = (*methods)->key;
  }
  return n;
}
