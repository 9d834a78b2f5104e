/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/section_cache.h"

#include <stdlib.h>
#include <string.h>

static void forget_section(vs_cached_section *r) {
  for (size_t k = 0; k < r->count; k++) free(r->word[k]);
  free(r->word);
  free(r->known);
  free(r->values);
  *r = (vs_cached_section){0};
}

void vs_section_cache_free(vs_section_cache *memo) {
  for (size_t k = 0; k < VS_SECTION_CACHE_MOST; k++) forget_section(&memo->section[k]);
}

/* The section as it was read last, or room for it; NULL: there is no room. */
static vs_cached_section *find_section(vs_section_cache *memo, const vs_section *section,
                                       size_t size) {
  size_t k = 0;
  while (k < VS_SECTION_CACHE_MOST && memo->section[k].fields &&
         memo->section[k].fields != section->fields)
    k++;
  if (k == VS_SECTION_CACHE_MOST) return NULL;
  vs_cached_section *r = &memo->section[k];
  if (!r->fields)
    *r = (vs_cached_section){.fields = section->fields,
                             .count = section->count,
                             .word = vs_alloc(section->count, sizeof *r->word),
                             .known = vs_alloc(section->count, sizeof *r->known),
                             .values = vs_alloc(1, size)};
  return r;
}

/* True if the key's value is known for what stands there now: one text, or nothing. */
static bool is_known(const vs_cached_section *r, size_t k, const vs_node *node) {
  if (!r->known[k] || (node && node->kind != VS_NODE_TEXT)) return false;
  return node ? r->word[k] && !strcmp(r->word[k], node->text) : !r->word[k];
}

static void note_key(vs_cached_section *r, size_t k, const vs_node *node) {
  free(r->word[k]);
  r->word[k] = node && node->kind == VS_NODE_TEXT ? vs_copy(node->text) : NULL;
  r->known[k] = !node || node->kind == VS_NODE_TEXT;
}

/* Reads the keys that are not known; err gathers no findings, so that an error ends it. */
static vs_status read_changed(vs_cached_section *r, const vs_section *section, const vs_node *map,
                              vs_error *err) {
  vs_status status = vs_field_section_keys(section, map, err);
  for (size_t k = 0; k < section->count && !status; k++) {
    const vs_node *node = vs_tree_child(map, section->fields[k].key);
    if (is_known(r, k, node)) continue;
    r->known[k] = false;
    status = vs_field_read_key(section, &section->fields[k], node, r->values, err);
    if (!status) note_key(r, k, node);
  }
  return status;
}

vs_status vs_section_cache_read(vs_section_cache *memo, const vs_section *section,
                                const vs_node *map, void *out, size_t size, vs_error *err) {
  bool plain = !map || map->kind == VS_NODE_MAP;
  vs_cached_section *r = memo && plain && !err->findings ? find_section(memo, section, size) : NULL;
  if (!r) return vs_field_section_read(section, map, out, err);
  vs_status status = read_changed(r, section, map, err);
  memcpy(out, r->values, size);
  return status;
}

void vs_section_cache_key(const vs_node *node, vs_text *out) {
  if (!node) {
    vs_text_add(out, "-");
    return;
  }
  const char *key = node->key ? node->key : "", *text = node->text ? node->text : "";
  vs_text_add(out, "%d %zu:%s %zu:%s[", (int)node->kind, strlen(key), key, strlen(text), text);
  for (const vs_node *n = node->child; n; n = n->next) vs_section_cache_key(n, out);
  vs_text_add(out, "]");
}
