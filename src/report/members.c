/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "members.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"

void vs_members_join(const vs_node *a, const vs_node *b, vs_member_visit visit, void *ctx) {
  for (const vs_node *m = a ? a->child : NULL; m; m = m->next)
    if (m->key) visit(ctx, m->key, m, vs_tree_child(b, m->key)); /* none: of a list */
  for (const vs_node *m = b ? b->child : NULL; m; m = m->next)
    if (m->key && !vs_tree_child(a, m->key)) visit(ctx, m->key, NULL, m);
}

double vs_member_number(const vs_node *node) {
  if (!node || node->kind != VS_NODE_TEXT || !*node->text) return NAN;
  char *end;
  double value = strtod(node->text, &end);
  return *end ? NAN : value;
}

const char *vs_member_word(const vs_node *map, const char *key) {
  const vs_node *node = vs_tree_child(map, key);
  return node && node->kind == VS_NODE_TEXT ? node->text : "";
}

/* ---- texts ---- */

static bool is_map(const vs_node *node) {
  return node && node->kind == VS_NODE_MAP;
}

static bool is_value(const vs_node *node) {
  return !is_map(node) || vs_tree_child(node, "value");
}

static void add_list(const vs_node *node, vs_text *out) {
  bool map = node->kind == VS_NODE_MAP;
  vs_text_add(out, map ? "{" : "[");
  for (const vs_node *m = node->child; m; m = m->next) {
    if (map) vs_text_add(out, "%s: ", m->key);
    vs_member_text(m, out);
    if (m->next) vs_text_add(out, ", ");
  }
  vs_text_add(out, map ? "}" : "]");
}

void vs_member_text(const vs_node *node, vs_text *out) {
  if (!node)
    vs_text_add(out, "-");
  else if (node->kind == VS_NODE_TEXT)
    vs_text_add(out, "%s", node->text);
  else if (is_map(node) && is_value(node)) {
    const char *unit = vs_member_word(node, "unit");
    vs_member_text(vs_tree_child(node, "value"), out);
    vs_text_add(out, "%s%s", *unit ? " " : "", unit);
  } else
    add_list(node, out);
}

/* ---- what is unlike ---- */

typedef struct unlike {
  const char *prefix; /* of the keys: "firing." */
  vs_member_visit visit;
  void *ctx;
} unlike;

/* True for values such as 0.03 ohm and 30 mohm: both numbers come from their shortest texts, so
 * equal ones differ by rounding alone. */
static bool are_equal(const vs_node *a, const vs_node *b) {
  const char *one = vs_member_word(a, "unit"), *other = vs_member_word(b, "unit");
  double x = vs_member_number(vs_tree_child(a, "value")),
         y = vs_member_number(vs_tree_child(b, "value"));
  if (isnan(x) || isnan(y) || !vs_units_known(one) || !vs_units_known(other)) return false;
  if (!vs_units_same_kind(one, other)) return false;
  x *= vs_units_factor(one), y *= vs_units_factor(other);
  return fabs(x - y) <= 1e-14 * fabs(x);
}

static bool are_same(const vs_node *a, const vs_node *b) {
  vs_text one = {0}, other = {0};
  vs_member_text(a, &one);
  vs_member_text(b, &other);
  bool same = !strcmp(one.text, other.text);
  vs_text_free(&one);
  vs_text_free(&other);
  return same;
}

/* The recursion is as deep as the tree. */
static void look_into_member(void *ctx, const char *key, const vs_node *a, const vs_node *b) {
  const unlike *u = ctx;
  vs_text name = {0};
  vs_text_add(&name, "%s%s", u->prefix, key);
  if ((is_map(a) || is_map(b)) && !(a && is_value(a)) && !(b && is_value(b))) {
    vs_text_add(&name, ".");
    unlike inner = {name.text, u->visit, u->ctx};
    vs_members_join(a, b, look_into_member, &inner);
  } else if (!a != !b || !(are_same(a, b) || are_equal(a, b)))
    u->visit(u->ctx, name.text, a, b);
  vs_text_free(&name);
}

void vs_members_unlike(const vs_node *a, const vs_node *b, vs_member_visit visit, void *ctx) {
  unlike u = {"", visit, ctx};
  vs_members_join(a, b, look_into_member, &u);
}

const char *vs_member_amount(double value, const char *unit, char text[VS_ENGINEERING_SIZE]) {
  const bool plain = *unit && unit[1] && strchr("pnumkMG", *unit) && !strpbrk(unit, "/*.23");
  if (plain && vs_units_known(unit + 1) && vs_units_same_kind(unit, unit + 1)) {
    value *= vs_units_factor(unit) / vs_units_factor(unit + 1);
    unit++;
  }
  return vs_engineering_text(value, unit, text);
}
