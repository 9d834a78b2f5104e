/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scope.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "message.h"
#include "netlist/rules.h"
#include "netlist/words.h"

/* The line behind the end of the subcircuit that begins in line k; 0: none does. */
static size_t end_of(const vs_deck *deck, size_t k) {
  size_t depth = vs_words_begin(deck->lines[k].text, ".subckt"), end = depth ? k + 1 : 0;
  for (; depth && end < deck->n_lines; end++) {
    depth += vs_words_begin(deck->lines[end].text, ".subckt");
    depth -= vs_words_begin(deck->lines[end].text, ".ends");
  }
  return end;
}

/* True for text whose first word is those n bytes. */
static bool is_named(const char *line, const char *name, size_t n) {
  return !strncasecmp(line, name, n) && strchr(" \t", line[n]);
}

bool vs_scope_enter(vs_scope *in, const char *name, size_t n) {
  const vs_deck *deck = in->deck;
  for (size_t p = 0; p < deck->n_parts; p++)
    if (strlen(deck->parts[p].name) == n && !strncasecmp(deck->parts[p].name, name, n))
      name = deck->parts[p].subcircuit, n = strlen(name);
  for (size_t k = 0; k < deck->n_lines; k++) {
    const char *text = deck->lines[k].text, *word = text + strcspn(text, " \t");
    word += strspn(word, " \t");
    if (vs_words_begin(text, ".subckt") && is_named(word, name, n)) {
      in->begin = k + 1;
      in->end = end_of(deck, k);
      return true;
    }
  }
  return false;
}

/* Finds the subcircuit of a path, as "b.xs.xq.bk" or "xs.xq.kk", by its instances. */
static vs_scope scope_of(const vs_deck *deck, const char *path) {
  vs_scope in = {deck, 0, deck->n_lines};
  const char *last = vs_message_behind_path(path);
  if (path[1] == '.') path += 2; /* the element's letter */
  while (path < last) {
    size_t n = strcspn(path, "."), length = 0, k = in.begin;
    while (k < in.end && !is_named(deck->lines[k].text, path, n)) {
      const size_t inner = end_of(deck, k); /* what stands in there has a longer path */
      k = inner ? inner : k + 1;
    }
    const char *name = k < in.end ? vs_rules_instance_of(deck->lines[k].text, &length) : NULL;
    if (!name || !vs_scope_enter(&in, name, length)) return (vs_scope){deck, 0, deck->n_lines};
    path += n + 1;
  }
  return in;
}

vs_scope vs_scope_find(const vs_deck *deck, const char *message) {
  static const char *const BEFORE[] = {"check node ", "instance ", "trouble with node \"", ": "};
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++)
    for (const char *s = message; (s = strstr(s, BEFORE[k]));) {
      s += strlen(BEFORE[k]);
      if (!isalpha((unsigned char)*s) || vs_message_behind_path(s) == s) continue;
      vs_scope in = scope_of(deck, s);
      if (in.end - in.begin < deck->n_lines) return in;
    }
  return (vs_scope){deck, 0, deck->n_lines};
}

/* True where a line gives a parameter of that name a value, or describes a model of that name. */
static bool declares(const char *line, const char *name, size_t n, bool parameter) {
  if (!parameter) {
    const char *word = line + strcspn(line, " \t");
    return vs_words_begin(line, ".model") &&
           vs_words_find(word, word, name, n) == word + strspn(word, " \t");
  }
  if (!vs_words_begin(line, ".param") && !vs_words_begin(line, ".subckt")) return false;
  for (const char *at = line; (at = vs_words_find(line, at, name, n)); at += n)
    if (vs_words_is_given(at + n)) return true;
  return false;
}

bool vs_scope_has_what_lacks(const vs_deck *deck, size_t k, const char *message) {
  size_t n = 0;
  const char *name = vs_message_parameter(message, &n);
  const bool parameter = name;
  if (!name) name = vs_message_model(message, &n);
  for (size_t from = 0; from < k && name; from++) {
    size_t end = end_of(deck, from);
    if (end <= k) continue;
    for (size_t j = from; j < end; j++) {
      size_t inner = j > from ? end_of(deck, j) : 0;
      if (inner)
        j = inner - 1;
      else if (declares(deck->lines[j].text, name, n, parameter))
        return true;
    }
  }
  return false;
}
