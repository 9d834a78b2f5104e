/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "bodies.h"

#include <stdio.h>
#include <string.h>

#include "expression.h"

static const char GROUND[] = "ground";

/* Where an expression is read from and what it is for. */
typedef struct source {
  const char *owner, *key; /* "bodies.base", "mass" */
  const char *unit;
  vs_expression_kind kind;
} source;

static vs_status read_one(const vs_machine *m, const vs_node *node, source from, vs_expression *out,
                          vs_error *err) {
  char what[2 * VS_MACHINE_NAME + 32];
  const vs_dimension wanted = vs_dimension_of(from.unit);
  const vs_expression_use use = {from.kind, what, &wanted};
  snprintf(what, sizeof what, "%s.%s", from.owner, from.key);
  return vs_expression_read(m, node, &use, out, err);
}

/* [x, y] */
static vs_status read_two(const vs_machine *m, const vs_node *node, source from,
                          vs_expression out[2], vs_error *err) {
  const vs_node *x = node->kind == VS_NODE_LIST ? node->child : NULL;
  if (!x || !x->next || x->next->next)
    return vs_fail_at(err, node->where, "%s.%s: two values are wanted: [x, y]", from.owner,
                      from.key);
  vs_status s = read_one(m, x, from, &out[0], err);
  return s ? s : read_one(m, x->next, from, &out[1], err);
}

static vs_status refuse_missing(const vs_node *node, const char *owner, const char *key,
                                vs_error *err) {
  return vs_fail_at(err, node->key_where, "%s: %s is wanted", owner, key);
}

static vs_status find_body(const vs_machine *m, const char *name, vs_where where, int *body,
                           vs_error *err) {
  const char *names[VS_MACHINE_BODIES + 1] = {GROUND};
  *body = -1;
  if (!strcmp(name, GROUND)) return VS_OK;
  for (int k = 0; k < m->n_bodies; k++) {
    names[k + 1] = m->bodies[k].name;
    if (!strcmp(name, names[k + 1])) *body = k;
  }
  if (*body >= 0) return VS_OK;
  const char *nearest = vs_text_nearest(name, names, (size_t)m->n_bodies + 1);
  return vs_fail_at(err, where, "no body '%s' stands above%s%s%s", name,
                    nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}

/* ---- their keys ---- */

static const vs_outline FORMULA = {.takes = VS_OUTLINE_TEXT},
                        POINT[] = {{.takes = VS_OUTLINE_LIST, .of = &FORMULA, .count = 2}, {0}};
static const vs_outline MOVES[] = {{"x", .takes = VS_OUTLINE_TEXT},
                                   {"y", .takes = VS_OUTLINE_TEXT},
                                   {"turn", .takes = VS_OUTLINE_TEXT},
                                   {0}};
const vs_outline vs_bodies_keys[] = {
    {"mass", .takes = VS_OUTLINE_NEEDED | VS_OUTLINE_TEXT},
    {"inertia", .takes = VS_OUTLINE_TEXT},
    {"at", .takes = VS_OUTLINE_NEEDED | VS_OUTLINE_LIST, .of = &FORMULA, .count = 2},
    {"on", .takes = VS_OUTLINE_TEXT},
    {"moves", .takes = VS_OUTLINE_MAP, .of = MOVES},
    {0}};
const vs_outline vs_bodies_spring_keys[] = {
    {"from", .takes = VS_OUTLINE_MAP, .of = POINT, .count = 1},
    {"to", .takes = VS_OUTLINE_NEEDED | VS_OUTLINE_MAP, .of = POINT, .count = 1},
    {"along", .takes = VS_OUTLINE_LIST, .of = &FORMULA, .count = 2},
    {"stiffness", .takes = VS_OUTLINE_TEXT | VS_OUTLINE_LIST, .of = &FORMULA, .count = 2},
    {"damping", .takes = VS_OUTLINE_TEXT | VS_OUTLINE_LIST, .of = &FORMULA, .count = 2},
    {0}};

/* ---- bodies ---- */

static vs_status read_moves(const vs_machine *m, const vs_node *map, const char *owner,
                            vs_expression moves[3], vs_error *err) {
  static const char *const WORDS[] = {"moves.x", "moves.y", "moves.turn"}, *const UNITS[] = {
                                                                               "m", "m", "rad"};
  if (map && map->kind != VS_NODE_MAP)
    return vs_fail_at(err, map->where, "%s.moves: {x: ..., y: ..., turn: ...} is wanted", owner);
  vs_status s = vs_field_outline_keys(map, "moves", MOVES, err);
  for (int k = 0; k < 3 && !s; k++) {
    const vs_node *node = vs_tree_child(map, MOVES[k].key);
    const source from = {owner, WORDS[k], UNITS[k], VS_EXPRESSION_MOTION};
    if (node) s = read_one(m, node, from, &moves[k], err);
  }
  return s;
}

static vs_status fill_body(vs_machine *m, const vs_node *node, const char *owner, vs_body *b,
                           vs_error *err) {
  const vs_node *mass = vs_tree_child(node, "mass"), *inertia = vs_tree_child(node, "inertia"),
                *at = vs_tree_child(node, "at"), *on = vs_tree_child(node, "on");
  if (!mass || !at) return refuse_missing(node, owner, mass ? "at: [x, y]" : "mass", err);
  vs_status s =
      read_one(m, mass, (source){owner, "mass", "kg", VS_EXPRESSION_CONSTANT}, &b->mass, err);
  if (!s && inertia)
    s = read_one(m, inertia, (source){owner, "inertia", "kg.m2", VS_EXPRESSION_CONSTANT},
                 &b->inertia, err);
  if (!s) s = read_two(m, at, (source){owner, "at", "m", VS_EXPRESSION_CONSTANT}, b->at, err);
  if (!s && on) s = find_body(m, on->text ? on->text : "", on->where, &b->on, err);
  return s ? s : read_moves(m, vs_tree_child(node, "moves"), owner, b->moves, err);
}

static vs_status read_body(vs_machine *m, const vs_node *node, vs_error *err) {
  char owner[VS_MACHINE_NAME + 16];
  snprintf(owner, sizeof owner, "bodies.%.*s", VS_MACHINE_NAME - 1, node->key);
  if (m->n_bodies >= VS_MACHINE_BODIES)
    return vs_fail_at(err, node->key_where, "more than %d bodies", VS_MACHINE_BODIES);
  if (!strcmp(node->key, GROUND))
    return vs_fail_at(err, node->key_where, "%s: that name is the program's", owner);
  if (node->kind != VS_NODE_MAP)
    return vs_fail_at(err, node->where, "%s: {mass: ..., at: [x, y], moves: ...} is wanted", owner);
  vs_status s = vs_field_outline_keys(node, owner, vs_bodies_keys, err);
  vs_body *b = &m->bodies[m->n_bodies];
  b->on = -1;
  if (!s) s = fill_body(m, node, owner, b, err);
  snprintf(b->name, sizeof b->name, "%.*s", VS_MACHINE_NAME - 1, node->key);
  m->n_bodies++; /* it is freed with the machine, also where it is not good */
  return s;
}

/* ---- springs ---- */

/* {BODY: [x, y]} */
static vs_status read_end(const vs_machine *m, const vs_node *node, const char *owner, vs_spring *s,
                          vs_error *err) {
  int end = !strcmp(node->key, "to");
  if (node->kind != VS_NODE_MAP || !node->child || node->child->next)
    return vs_fail_at(err, node->where, "%s.%s: one body with a point is wanted: {BODY: [x, y]}",
                      owner, node->key);
  vs_status status = find_body(m, node->child->key, node->child->key_where, &s->body[end], err);
  const source from = {owner, node->key, "m", VS_EXPRESSION_CONSTANT};
  return status ? status : read_two(m, node->child, from, s->point[end], err);
}

static vs_status read_strength(const vs_machine *m, const vs_node *node, source from,
                               const vs_spring *s, vs_error *err) {
  vs_expression *out =
      (vs_expression *)(size_t)(!strcmp(from.key, "damping") ? s->damping : s->stiffness);
  if (s->apart) return read_two(m, node, from, out, err);
  return read_one(m, node, from, out, err);
}

static vs_status fill_spring(const vs_machine *m, const vs_node *node, const char *owner,
                             vs_spring *s, vs_error *err) {
  const vs_node *from = vs_tree_child(node, "from"), *to = vs_tree_child(node, "to"),
                *along = vs_tree_child(node, "along"),
                *stiffness = vs_tree_child(node, "stiffness"),
                *damping = vs_tree_child(node, "damping"),
                *strong = stiffness ? stiffness : damping;
  if (!to || !strong)
    return refuse_missing(node, owner, to ? "stiffness or damping" : "to: {BODY: [x, y]}", err);
  s->apart = strong->kind == VS_NODE_LIST;
  s->directed = along != NULL;
  s->where = node->key_where;
  if (s->apart && along)
    return vs_fail_at(err, along->key_where,
                      "%s.along: with [x, y] for its stiffness a spring has no direction", owner);
  if (!s->apart && !along && !from)
    return refuse_missing(node, owner, "a direction, by `from` or `along`, or stiffness: [x, y],",
                          err);
  vs_status status = read_end(m, to, owner, s, err);
  if (!status && from) status = read_end(m, from, owner, s, err);
  if (!status && along)
    status =
        read_two(m, along, (source){owner, "along", NULL, VS_EXPRESSION_CONSTANT}, s->along, err);
  if (!status && stiffness)
    status = read_strength(m, stiffness,
                           (source){owner, "stiffness", "N/m", VS_EXPRESSION_CONSTANT}, s, err);
  if (!status && damping)
    status = read_strength(m, damping, (source){owner, "damping", "N.s/m", VS_EXPRESSION_CONSTANT},
                           s, err);
  return status;
}

static vs_status read_spring(vs_machine *m, const vs_node *node, vs_error *err) {
  char owner[VS_MACHINE_NAME + 16];
  snprintf(owner, sizeof owner, "springs.%.*s", VS_MACHINE_NAME - 1, node->key);
  if (m->n_springs >= VS_MACHINE_SPRINGS)
    return vs_fail_at(err, node->key_where, "more than %d springs", VS_MACHINE_SPRINGS);
  if (node->kind != VS_NODE_MAP)
    return vs_fail_at(err, node->where, "%s: {from: ..., to: ..., stiffness: ...} is wanted",
                      owner);
  vs_status status = vs_field_outline_keys(node, owner, vs_bodies_spring_keys, err);
  vs_spring *s = &m->springs[m->n_springs++];
  s->body[0] = s->body[1] = -1;
  snprintf(s->name, sizeof s->name, "%.*s", VS_MACHINE_NAME - 1, node->key);
  return status ? status : fill_spring(m, node, owner, s, err);
}

/* ---- both ---- */

static vs_status read_each(vs_machine *m, const char *key,
                           vs_status (*read)(vs_machine *, const vs_node *, vs_error *),
                           vs_error *err) {
  const vs_node *map = vs_tree_child(m->tree.root, key);
  vs_status s = VS_OK;
  if (map && map->kind != VS_NODE_MAP)
    return vs_error_carry_on(
        err, vs_fail_at(err, map->where, "%s: a map is wanted: {NAME: {...}, ...}", key));
  for (const vs_node *n = map ? map->child : NULL; n && !s; n = n->next)
    s = vs_error_carry_on(err, read(m, n, err));
  return s;
}

vs_status vs_bodies_read(vs_machine *m, vs_error *err) {
  const vs_node *springs = vs_tree_child(m->tree.root, "springs");
  vs_status s = read_each(m, "bodies", read_body, err);
  if (!s && springs && !m->n_bodies)
    return vs_fail_at(err, springs->key_where, "springs: there are no bodies to hold");
  return s ? s : read_each(m, "springs", read_spring, err);
}
