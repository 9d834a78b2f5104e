/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "yaml.h"

#include <libfyaml.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static vs_where place(struct fy_node *node, const char *file) {
  vs_where where = {.file = file};
  if (!node) return where;
  struct fy_token *token = fy_node_is_scalar(node) ? fy_node_get_scalar_token(node) : NULL;
  const struct fy_mark *mark = token ? fy_token_start_mark(token) : NULL;
  if (!mark) { /* a list or map begins where its first element does */
    struct fy_node *first = NULL;
    if (fy_node_is_sequence(node))
      first = fy_node_sequence_get_by_index(node, 0);
    else if (fy_node_is_mapping(node)) {
      struct fy_node_pair *pair = fy_node_mapping_get_by_index(node, 0);
      first = pair ? fy_node_pair_key(pair) : NULL;
    }
    return first ? place(first, file) : where;
  }
  where.line = mark->line + 1;
  where.column = mark->column + 1;
  return where;
}

typedef struct ranked_key {
  const vs_node *node;
  size_t rank; /* the how-manieth key of the map it is */
} ranked_key;

static int by_key(const void *a, const void *b) {
  const ranked_key *x = a, *y = b;
  int order = strcmp(x->node->key, y->node->key);
  return order ? order : x->rank < y->rank ? -1 : x->rank > y->rank;
}

/* Returns the first key that the map has twice; NULL: there is none. The keys are sorted for that,
 * because libfyaml's own check compares each key with all before it, which takes 4 s for 10,000
 * keys and minutes for 60,000. */
static const vs_node *second_of_a_key(const vs_node *map) {
  size_t count = 0, first = SIZE_MAX;
  for (const vs_node *n = map->child; n; n = n->next) count++;
  ranked_key *keys = vs_alloc(count, sizeof *keys);
  size_t k = 0;
  for (const vs_node *n = map->child; n; n = n->next, k++) keys[k] = (ranked_key){n, k};
  qsort(keys, count, sizeof *keys, by_key);
  const vs_node *second = NULL;
  for (k = 1; k < count; k++)
    if (!strcmp(keys[k - 1].node->key, keys[k].node->key) && keys[k].rank < first) {
      first = keys[k].rank;
      second = keys[k].node;
    }
  free(keys);
  return second;
}

/* Of what stands nowhere, the file's begin. */
static vs_where or_begin(vs_where where) {
  return where.line ? where : (vs_where){where.file, 1, 1};
}

/* Refuses a decimal comma: of {until: 0,1 s} YAML makes the number 0 and a key "1 s" that has
 * nothing. */
static vs_status check_comma(const vs_node *before, const char *key, vs_where where,
                             vs_error *err) {
  const char *whole = before && before->kind == VS_NODE_TEXT ? before->text : "";
  const size_t n = strlen(whole), sign = n && strchr("+-", *whole) ? 1 : 0;
  if (n == sign || strspn(whole + sign, "0123456789") < n - sign) return VS_OK;
  if (*key < '0' || *key > '9' || before->where.line != where.line ||
      before->where.column + (int)n + 1 != where.column)
    return VS_OK;
  return vs_fail_at(err, before->where,
                    "'%s,%s': a comma ends a value here, as the decimal sign is a point; write "
                    "%s.%s",
                    whole, key, whole, key);
}

static vs_status convert(struct fy_node *fy, const char *file, vs_node **out, vs_error *err);

static vs_status convert_children(struct fy_node *fy, const char *file, vs_node *parent,
                                  vs_error *err) {
  vs_node **tail = &parent->child;
  void *position = NULL;
  if (parent->kind == VS_NODE_LIST) {
    struct fy_node *item;
    while ((item = fy_node_sequence_iterate(fy, &position))) {
      vs_status status = convert(item, file, tail, err);
      if (status) return status;
      if (!(*tail)->where.line) (*tail)->where = parent->where; /* an empty item stands nowhere */
      tail = &(*tail)->next;
    }
    return VS_OK;
  }
  struct fy_node_pair *pair;
  const vs_node *before = NULL;
  while ((pair = fy_node_mapping_iterate(fy, &position))) {
    struct fy_node *key = fy_node_pair_key(pair);
    if (!key || !fy_node_is_scalar(key))
      return vs_fail_at(err, or_begin(parent->where), "a key must be a plain name");
    vs_where key_where = place(key, file);
    size_t length;
    const char *name = fy_node_get_scalar(key, &length);
    char *copy = vs_alloc_part(name ? name : "", length);
    vs_status status = convert(fy_node_pair_value(pair), file, tail, err);
    if (!status && (*tail)->kind == VS_NODE_TEXT && !*(*tail)->text)
      status = check_comma(before, copy, key_where, err);
    if (status) {
      free(copy);
      return status;
    }
    (*tail)->key = copy;
    if (!key_where.line) key_where = (*tail)->where; /* an empty key stands nowhere */
    if (!(*tail)->where.line) (*tail)->where = key_where;
    (*tail)->key_where = key_where;
    before = *tail;
    tail = &(*tail)->next;
  }
  const vs_node *second = second_of_a_key(parent);
  return second ? vs_fail_at(err, second->key_where,
                             "not YAML: duplicate key; a map has each key once")
                : VS_OK;
}

static vs_status convert(struct fy_node *fy, const char *file, vs_node **out, vs_error *err) {
  vs_node *node = vs_alloc(1, sizeof *node);
  *out = node;
  node->where = (vs_where){.file = file};
  if (fy) node->where = place(fy, file);
  if (fy && fy_node_is_alias(fy))
    return vs_fail_at(err, node->where, "aliases (*name) are not read here; write the value out");
  if (fy && !fy_node_is_scalar(fy)) {
    node->kind = fy_node_is_sequence(fy) ? VS_NODE_LIST : VS_NODE_MAP;
    return convert_children(fy, file, node, err);
  }
  size_t length = 0;
  const char *text = fy ? fy_node_get_scalar(fy, &length) : NULL;
  bool nothing = !text || (length == 1 && *text == '~'); /* YAML's way to say so */
  node->text = nothing ? vs_copy("") : vs_alloc_part(text, length);
  return VS_OK;
}

/* What would be right where the parser complains so. */
static const char *instead_of(const char *complaint) {
  static const struct {
    const char *says, *instead;
  } ROWS[] = {
      {"'-'", "a - that begins no list is written in quotes: '-'"},
      {"block sequence on the same line", "a - that begins no list is written in quotes: '-'"},
      {"tab", "blanks are wanted in its place"},
      {"quote", "a quote that is opened is closed on its line"},
      {"closing", "what [ or { opens, ] or } closes"},
      {"comma", "between [ and ], or { and }, commas stand between values"}};
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++)
    if (strstr(complaint, ROWS[k].says)) return ROWS[k].instead;
  return "lines 'key: value' are wanted, and what belongs to a key stands farther to the right";
}

/* Makes the parser's first complaint an error of this program. */
static vs_status report(struct fy_diag *diag, const char *file, vs_error *err) {
  void *position = NULL;
  struct fy_diag_error *first = fy_diag_errors_iterate(diag, &position);
  if (!first) return vs_fail_at(err, (vs_where){file, 1, 1}, "cannot be read as YAML");
  vs_where where = {file, first->line > 0 ? first->line : 1, first->column > 0 ? first->column : 1};
  return vs_fail_at(err, where, "not YAML: %s; %s", first->msg, instead_of(first->msg));
}

vs_where vs_yaml_place(const char *text, const char *at, const char *file) {
  vs_where where = {.file = file, .line = 1};
  const char *line = text;
  for (const char *end; (end = memchr(line, '\n', (size_t)(at - line))); where.line++)
    line = end + 1;
  where.column = vs_text_column(line, at);
  return where;
}

/* Refuses bytes that are not UTF-8, with which libfyaml 0.7 does anything: behind a '%' it never
 * returns. */
static vs_status check_bytes(const char *text, size_t length, const char *file, vs_error *err) {
  const char *bad = vs_text_not_utf8(text, length);
  if (!bad) return VS_OK;
  return vs_fail_at(err, vs_yaml_place(text, bad, file),
                    "the byte 0x%02x is not UTF8; what is read here is written in UTF-8",
                    (unsigned char)*bad);
}

/* The time libfyaml 0.7 takes for two things grows with the square of their number: anchors (it
 * compares each with all before it; 30,000 take a minute) and empty lines in a row (30,000 in a
 * text block take 4 s). So many as are allowed here take less than half a second, and no scene
 * needs more. */
enum { MOST_ANCHORS = 1000, MOST_EMPTY_LINES = 10000 };

static vs_status check_patience(const char *text, size_t length, const char *file, vs_error *err) {
  int anchors = 0, empty = 0;
  vs_where where = {.file = file, .line = 1, .column = 1};
  char before = '\n';
  for (size_t k = 0; k < length; before = text[k++]) {
    bool breaks = text[k] == '\n' || text[k] == '\r';
    anchors += text[k] == '&' && strchr(" \t\r\n[{,:-?", before);
    empty = breaks ? empty + 1 : text[k] == ' ' || text[k] == '\t' ? empty : 0;
    where.line += text[k] == '\n';
    if (anchors > MOST_ANCHORS)
      return vs_fail_at(err, where, "more than %d anchors (&name); none are of use here",
                        MOST_ANCHORS);
    if (empty > MOST_EMPTY_LINES)
      return vs_fail_at(err, where, "more than %d empty lines in a row", MOST_EMPTY_LINES);
  }
  return VS_OK;
}

vs_status vs_yaml_read(const char *text, size_t length, const char *file, vs_node **root,
                       vs_error *err) {
  vs_status status = check_bytes(text, length, file, err);
  if (!status) status = check_patience(text, length, file, err);
  if (status) return status;
  struct fy_diag_cfg diag_cfg;
  fy_diag_cfg_default(&diag_cfg);
  diag_cfg.fp = NULL;
  diag_cfg.level = FYET_ERROR;
  struct fy_diag *diag = fy_diag_create(&diag_cfg);
  fy_diag_set_collect_errors(diag, true);
  struct fy_parse_cfg cfg = {.flags = FYPCF_QUIET | FYPCF_ALLOW_DUPLICATE_KEYS, .diag = diag};
  struct fy_parser *parser = fy_parser_create(&cfg);
  struct fy_document *document = NULL, *second = NULL;
  if (!parser || fy_parser_set_string(parser, text, length))
    status = vs_fail_at(err, (vs_where){file, 1, 1}, "cannot be read as YAML");
  if (!status) {
    document = fy_parse_load_document(parser);
    if (fy_parser_get_stream_error(parser)) status = report(diag, file, err);
  }
  struct fy_node *fy = document ? fy_document_root(document) : NULL;
  if (!status) {
    if (fy)
      status = convert(fy, file, root, err);
    else {
      *root = vs_alloc(1, sizeof **root);
      (*root)->kind = VS_NODE_MAP;
      (*root)->where = (vs_where){.file = file};
    }
  }
  if (!status && document) {
    second = fy_parse_load_document(parser);
    if (second)
      status = vs_fail_at(err, or_begin(place(fy_document_root(second), file)),
                          "a second document (after '---') begins here; a file holds one");
    else if (fy_parser_get_stream_error(parser))
      status = report(diag, file, err);
  }
  fy_parse_document_destroy(parser, second);
  fy_parse_document_destroy(parser, document);
  fy_parser_destroy(parser);
  fy_diag_destroy(diag);
  return status;
}
