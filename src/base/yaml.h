/* SPDX-License-Identifier: GPL-3.0-or-later
 * YAML as libfyaml reads it, made into nodes. What libfyaml 0.7 would not come back from, or takes
 * minutes for, is refused before. */
#ifndef VS_BASE_YAML_H
#define VS_BASE_YAML_H

#include "base/node.h"

/* Reads the text, which errors call `file`. A text that says nothing gives an empty map. Nodes that
 * YAML writes with no characters, as an empty list, may have no line. The caller frees *root by
 * vs_node_free, also after an error. Errors, with their place: the text is no YAML, is not UTF-8,
 * has a key twice, an alias or a second document. */
vs_status vs_yaml_read(const char *text, size_t length, const char *file, vs_node **root,
                       vs_error *err);

/* The place of a byte `at` of the text. */
vs_where vs_yaml_place(const char *text, const char *at, const char *file);

#endif
