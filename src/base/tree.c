/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/tree.h"

#include <ctype.h>
#include <errno.h>
#include <libfyaml.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/jail.h"
#include "base/text.h"

/* ---- nodes ---- */

/* Frees the node, its siblings behind it, and all below them; NULL: there is nothing to free. */
static void free_nodes(vs_node *node) {
  while (node) {
    vs_node *next = node->next;
    free_nodes(node->child);
    free(node->key);
    free(node->text);
    free(node);
    node = next;
  }
}

/* Copies the node, its siblings behind it, and all below them. Their places point to the same file
 * names. The caller frees the copy. */
static vs_node *copy_nodes(const vs_node *node) {
  vs_node *first = NULL, **tail = &first;
  for (; node; node = node->next, tail = &(*tail)->next) {
    *tail = vs_alloc(1, sizeof **tail);
    **tail = *node;
    (*tail)->next = NULL;
    (*tail)->key = node->key ? vs_copy(node->key) : NULL;
    (*tail)->text = node->text ? vs_copy(node->text) : NULL;
    (*tail)->child = copy_nodes(node->child);
  }
  return first;
}

/* ---- YAML: a text as libfyaml reads it, made into nodes ---- */

/* Text on which libfyaml 0.7 never returns, or takes minutes, is refused before it is parsed. */

static vs_where place_of_node(struct fy_node *node, const char *file) {
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
    return first ? place_of_node(first, file) : where;
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

static vs_status convert_node(struct fy_node *fy, const char *file, vs_node **out, vs_error *err);

static vs_status convert_children_of(struct fy_node *fy, const char *file, vs_node *parent,
                                     vs_error *err) {
  vs_node **tail = &parent->child;
  void *position = NULL;
  if (parent->kind == VS_NODE_LIST) {
    struct fy_node *item;
    while ((item = fy_node_sequence_iterate(fy, &position))) {
      vs_status status = convert_node(item, file, tail, err);
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
    vs_where key_where = place_of_node(key, file);
    size_t length;
    const char *name = fy_node_get_scalar(key, &length);
    char *copy = vs_alloc_part(name ? name : "", length);
    vs_status status = convert_node(fy_node_pair_value(pair), file, tail, err);
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
  if (!second) return VS_OK;
  const vs_node *first = parent->child;
  while (strcmp(first->key, second->key) != 0) first = first->next;
  return vs_fail_at(
      err, second->key_where,
      "not YAML: duplicate key '%.100s', which stands in line %d, too; a map has each "
      "key once",
      second->key, first->key_where.line);
}

static vs_status convert_node(struct fy_node *fy, const char *file, vs_node **out, vs_error *err) {
  vs_node *node = vs_alloc(1, sizeof *node);
  *out = node;
  node->where = (vs_where){.file = file};
  if (fy) node->where = place_of_node(fy, file);
  if (fy && fy_node_is_alias(fy))
    return vs_fail_at(err, node->where, "aliases (*name) are not read here; write the value out");
  if (fy && !fy_node_is_scalar(fy)) {
    node->kind = fy_node_is_sequence(fy) ? VS_NODE_LIST : VS_NODE_MAP;
    return convert_children_of(fy, file, node, err);
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
static vs_status report_yaml(struct fy_diag *diag, const char *file, vs_error *err) {
  void *position = NULL;
  struct fy_diag_error *first = fy_diag_errors_iterate(diag, &position);
  if (!first) return vs_fail_at(err, (vs_where){file, 1, 1}, "cannot be read as YAML");
  vs_where where = {file, first->line > 0 ? first->line : 1, first->column > 0 ? first->column : 1};
  return vs_fail_at(err, where, "not YAML: %s; %s", first->msg, instead_of(first->msg));
}

/* The place of a byte `at` of the text. */
static vs_where place_of_byte(const char *text, const char *at, const char *file) {
  vs_where where = {.file = file, .line = 1};
  const char *line = text;
  for (const char *end; (end = memchr(line, '\n', (size_t)(at - line))); where.line++)
    line = end + 1;
  where.column = vs_text_column(line, at);
  return where;
}

/* Refuses bytes that are not UTF-8. libfyaml 0.7 does not check for them: behind a '%' it never
 * returns. */
static vs_status check_bytes(const char *text, size_t length, const char *file, vs_error *err) {
  const char *bad = vs_text_not_utf8(text, length);
  if (!bad) return VS_OK;
  return vs_fail_at(err, place_of_byte(text, bad, file),
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

/* Reads the text, which errors call `file`. A text that says nothing gives an empty map. Nodes that
 * YAML writes with no characters, as an empty list, may have no line. The caller frees *root by
 * free_nodes, also after an error. Errors, with their place: the text is no YAML, is not
 * UTF-8, has a key twice, an alias or a second document. */
static vs_status yaml_read(const char *text, size_t length, const char *file, vs_node **root,
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
    if (fy_parser_get_stream_error(parser)) status = report_yaml(diag, file, err);
  }
  struct fy_node *fy = document ? fy_document_root(document) : NULL;
  if (!status) {
    if (fy)
      status = convert_node(fy, file, root, err);
    else {
      *root = vs_alloc(1, sizeof **root);
      (*root)->kind = VS_NODE_MAP;
      (*root)->where = (vs_where){.file = file};
    }
  }
  if (!status && document) {
    second = fy_parse_load_document(parser);
    if (second)
      status = vs_fail_at(err, or_begin(place_of_node(fy_document_root(second), file)),
                          "a second document (after '---') begins here; a file holds one");
    else if (fy_parser_get_stream_error(parser))
      status = report_yaml(diag, file, err);
  }
  fy_parse_document_destroy(parser, second);
  fy_parse_document_destroy(parser, document);
  fy_parser_destroy(parser);
  fy_diag_destroy(diag);
  return status;
}

/* ---- files ---- */

/* Gives nodes without a place, such as an empty list or map, the place of the node around them. */
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

static vs_status read_text(const char *path, char **text, size_t *length, vs_error *err) {
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
      status = vs_fail_at(err, place_of_byte(before, before + all.length, path),
                          "a zero byte; text in UTF-8 is wanted");
      break;
    }
  }
  if (!status && ferror(f)) status = vs_fail_at(err, where, "cannot be read: %s", strerror(errno));
  fclose(f);
  *text = all.text ? all.text : vs_copy("");
  *length = all.length;
  return status;
}

static vs_status make_tree(const char *text, size_t length, vs_tree *tree, vs_error *err) {
  vs_status status = yaml_read(text, length, tree->name, &tree->root, err);
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
  vs_status status = read_text(path, &text, &length, err);
  if (!status) status = make_tree(text, length, tree, err);
  free(text);
  return status;
}

vs_status vs_tree_parse(const char *text, const char *name, vs_tree *tree, vs_error *err) {
  *tree = (vs_tree){.name = vs_copy(name)};
  return make_tree(text, strlen(text), tree, err);
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

/* The map's child whose key has these n letters; NULL: there is none, or no map. */
static vs_node *child_of(const vs_node *map, const char *key, size_t n) {
  vs_node *child = map && map->kind == VS_NODE_MAP ? map->child : NULL;
  while (child && (strncmp(child->key, key, n) != 0 || child->key[n])) child = child->next;
  return child;
}

vs_where vs_tree_place(const vs_node *map, const char *key) {
  vs_where where = map ? map->where : (vs_where){0};
  while (map && *key) {
    size_t n = strcspn(key, ".");
    const vs_node *child = child_of(map, key, n);
    if (child && child->where.file) where = child->where;
    map = child;
    key += n + (key[n] == '.');
  }
  return where;
}

const vs_node *vs_tree_find(const vs_node *map, const char *key) {
  for (size_t n; map && *key; key += n + (key[n] == '.')) {
    n = strcspn(key, ".");
    map = child_of(map, key, n);
  }
  return map;
}

const vs_node *vs_tree_child(const vs_node *map, const char *key) {
  for (const vs_node *n = map ? map->child : NULL; n; n = n->next)
    if (n->key && !strcmp(n->key, key)) return n;
  return NULL;
}

const vs_node *vs_tree_child_map(const vs_node *map, const char *key) {
  const vs_node *n = vs_tree_child(map, key);
  return n && n->kind == VS_NODE_MAP ? n : NULL;
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
static vs_node *reach_key(vs_tree *tree, const char *dotted, vs_where where) {
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
      free_nodes(at->child);
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
  *copy = (vs_tree){.root = copy_nodes(tree->root), .name = vs_copy(tree->name)};
}

static void graft(vs_tree *tree, const char *key, const vs_node *value) {
  vs_node *at = reach_key(tree, key, value->key_where);
  free_nodes(at->child);
  free(at->text);
  at->kind = value->kind;
  at->text = value->text ? vs_copy(value->text) : NULL;
  at->child = copy_nodes(value->child);
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

static void drop_child(vs_node *map, const char *key, size_t n) {
  vs_node **link = &map->child, *dropped = child_of(map, key, n);
  if (!dropped) return;
  while (*link != dropped) link = &(*link)->next;
  *link = dropped->next;
  dropped->next = NULL;
  free_nodes(dropped);
}

void vs_tree_drop(vs_tree *tree, const char *key) {
  drop_child(tree->root, key, strlen(key));
}

void vs_tree_put_back(vs_tree *tree, const vs_tree *own, const char *key) {
  const vs_node *from = own->root;
  vs_node *map = tree->root;
  vs_error never = {0};
  for (const char *s = key; *s;) {
    const size_t n = strcspn(s, ".");
    from = child_of(from, s, n);
    if (!from) {
      if (map) drop_child(map, s, n);
      return;
    }
    map = child_of(map, s, n);
    s += n + (s[n] == '.');
  }
  vs_tree_graft(tree, key, from, &never);
}

/* Reads the text behind the sign as YAML. */
static vs_status parse_value(const char *text, vs_where where, vs_node **value, vs_error *err) {
  const char *yaml = strcmp(text, "-") ? text : "'-'"; /* a lone - is a text here, no list */
  vs_status status = yaml_read(yaml, strlen(yaml), "--set", value, err);
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
  free_nodes(at->child);
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
  if (!status) take_value(reach_key(tree, path, where), value, where);
  free(path);
  if (status) {
    free_nodes(value);
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
  free_nodes(tree->root);
  free_nodes(tree->labels);
  free(tree->name);
  *tree = (vs_tree){0};
}
