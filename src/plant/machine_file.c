/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/machine_file.h"

#include <stdio.h>
#include <string.h>

#include "base/field.h"
#include "base/units.h"
#include "declare.h"
#include "expression.h"
#include "plant/actuator.h"
#include "plant/feed.h"
#include "plant/machine.h"

/* ---- bodies and springs ---- */

/* Bodies and springs in the plane, which a machine's file may have instead of matrices:
 *
 *   bodies:  {NAME: {mass: FORMULA, inertia: FORMULA, at: [x, y], on: BODY,
 *                    moves: {x: FORMULA, y: FORMULA, turn: FORMULA}}, ...}
 *       at: its centre of mass at rest. moves: its small motion, linear in the coordinates; what is
 *       left out is 0, and so is the inertia. on: a body above it, whose motion it shares besides
 *   springs: {NAME: {from: {BODY: [x, y]}, to: {BODY: [x, y]}, along: [x, y],
 *                    stiffness: FORMULA, damping: FORMULA}, ...}
 *       from: without it, the ground at the same point; BODY may be `ground`. The spring pulls
 *       along the line between its points, or along the direction `along`; with stiffness: [x, y]
 *       and damping: [x, y] along both axes. Springs are without force at rest */

static const char GROUND[] = "ground";

/* Where an expression is read from and what it is for. */
typedef struct source {
  const char *owner, *key; /* "bodies.base", "mass" */
  const char *unit;        /* "~": any */
  vs_expression_kind kind;
  bool apart;   /* what may be one value or two is two */
  bool goes_on; /* a check carries on with the next key */
} source;

static vs_status read_component(const vs_machine *m, const vs_node *node, source from,
                                vs_expression *out, vs_error *err) {
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
  vs_status s = read_component(m, x, from, &out[0], err);
  return s ? s : read_component(m, x->next, from, &out[1], err);
}

/* Reads the map's formulas, which are the keys whose rows have a unit, each into its member of out.
 */
static vs_status read_formulas(const vs_machine *m, const vs_node *map, source from,
                               const vs_field *rows, void *out, vs_error *err) {
  vs_status s = VS_OK;
  for (const vs_field *row = rows; row->kind && !s; row++) {
    const vs_node *node = row->unit ? vs_tree_child(map, row->key) : NULL;
    vs_expression *to = (vs_expression *)(void *)((char *)out + row->offset);
    const bool two = row->kind & VS_LIST && (from.apart || !(row->kind & VS_TEXT));
    from.key = row->key;
    from.unit = row->unit;
    if (node) s = two ? read_two(m, node, from, to, err) : read_component(m, node, from, to, err);
    if (from.goes_on) s = vs_error_keep(err, s);
  }
  return s;
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
  return vs_fail_at(err, where, "no body '%s' stands above%s", name,
                    vs_text_hint(name, names, (size_t)m->n_bodies + 1, "").text);
}

static const vs_field FORMULA = {.kind = VS_TEXT};
static const vs_inside PLACE = {.rows = &FORMULA, .count = 2}, /* [x, y] */
    END = {.rows = VS_ROWS({.kind = VS_LIST, .inside = &PLACE}), .count = 1};
#define AT(member) .offset = offsetof(vs_body, member)
static const vs_inside MOVES = {.rows = VS_ROWS({"x", VS_TEXT, "m", AT(moves[0])},
                                                {"y", VS_TEXT, "m", AT(moves[1])},
                                                {"turn", VS_TEXT, "rad", AT(moves[2])})};
static const vs_inside BODY = {
    .rows = VS_ROWS({"mass", VS_NEEDED | VS_TEXT, "kg", AT(mass)},
                    {"inertia", VS_TEXT, "kg.m2", AT(inertia)},
                    {"at", VS_NEEDED | VS_LIST, "m", AT(at), .inside = &PLACE},
                    {"on", .kind = VS_TEXT}, {"moves", VS_MAP, .inside = &MOVES})};
#undef AT
#define AT(member) .offset = offsetof(vs_spring, member), .inside = &PLACE
static const vs_inside SPRING = {
    .rows = VS_ROWS({"from", VS_MAP, .inside = &END}, {"to", VS_NEEDED | VS_MAP, .inside = &END},
                    {"along", VS_LIST, "~", AT(along)},
                    {"stiffness", VS_TEXT | VS_LIST, "N/m", AT(stiffness)},
                    {"damping", VS_TEXT | VS_LIST, "N.s/m", AT(damping)})};
#undef AT

static vs_status read_moves(const vs_machine *m, const vs_node *map, const char *owner, vs_body *b,
                            vs_error *err) {
  char what[VS_MACHINE_NAME + 24];
  if (map && map->kind != VS_NODE_MAP)
    return vs_fail_at(err, map->where, "%s.moves: {x: ..., y: ..., turn: ...} is wanted", owner);
  snprintf(what, sizeof what, "%s.moves", owner);
  const source from = {.owner = what, .kind = VS_EXPRESSION_MOTION};
  vs_status s = vs_field_map_keys(map, "moves", &MOVES, err);
  return s ? s : read_formulas(m, map, from, MOVES.rows, b, err);
}

static vs_status fill_body(vs_machine *m, const vs_node *node, const char *owner, vs_body *b,
                           vs_error *err) {
  const vs_node *mass = vs_tree_child(node, "mass"), *at = vs_tree_child(node, "at"),
                *on = vs_tree_child(node, "on");
  const source from = {.owner = owner, .kind = VS_EXPRESSION_CONSTANT};
  if (!mass || !at) return refuse_missing(node, owner, mass ? "at: [x, y]" : "mass", err);
  vs_status s = read_formulas(m, node, from, BODY.rows, b, err);
  if (!s && on) s = find_body(m, on->text ? on->text : "", on->where, &b->on, err);
  return s ? s : read_moves(m, vs_tree_child(node, "moves"), owner, b, err);
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
  vs_status s = vs_field_map_keys(node, owner, &BODY, err);
  vs_body *b = &m->bodies[m->n_bodies];
  b->on = -1;
  if (!s) s = fill_body(m, node, owner, b, err);
  snprintf(b->name, sizeof b->name, "%.*s", VS_MACHINE_NAME - 1, node->key);
  m->n_bodies++; /* it is freed with the machine, also where it is not good */
  return s;
}

/* {BODY: [x, y]} */
static vs_status read_spring_end(const vs_machine *m, const vs_node *node, const char *owner,
                                 vs_spring *s, vs_error *err) {
  int end = !strcmp(node->key, "to");
  if (node->kind != VS_NODE_MAP || !node->child || node->child->next)
    return vs_fail_at(err, node->where, "%s.%s: one body with a point is wanted: {BODY: [x, y]}",
                      owner, node->key);
  vs_status status = find_body(m, node->child->key, node->child->key_where, &s->body[end], err);
  const source from = {owner, node->key, "m", .kind = VS_EXPRESSION_CONSTANT};
  return status ? status : read_two(m, node->child, from, s->point[end], err);
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
  const source formulas = {.owner = owner, .kind = VS_EXPRESSION_CONSTANT, .apart = s->apart};
  vs_status status = read_spring_end(m, to, owner, s, err);
  if (!status && from) status = read_spring_end(m, from, owner, s, err);
  return status ? status : read_formulas(m, node, formulas, SPRING.rows, s, err);
}

static vs_status read_spring(vs_machine *m, const vs_node *node, vs_error *err) {
  char owner[VS_MACHINE_NAME + 16];
  snprintf(owner, sizeof owner, "springs.%.*s", VS_MACHINE_NAME - 1, node->key);
  if (m->n_springs >= VS_MACHINE_SPRINGS)
    return vs_fail_at(err, node->key_where, "more than %d springs", VS_MACHINE_SPRINGS);
  if (node->kind != VS_NODE_MAP)
    return vs_fail_at(err, node->where, "%s: {from: ..., to: ..., stiffness: ...} is wanted",
                      owner);
  vs_status status = vs_field_map_keys(node, owner, &SPRING, err);
  vs_spring *s = &m->springs[m->n_springs++];
  s->body[0] = s->body[1] = -1;
  snprintf(s->name, sizeof s->name, "%.*s", VS_MACHINE_NAME - 1, node->key);
  return status ? status : fill_spring(m, node, owner, s, err);
}

static vs_status read_each(vs_machine *m, const char *key,
                           vs_status (*read)(vs_machine *, const vs_node *, vs_error *),
                           vs_error *err) {
  const vs_node *map = vs_tree_child(m->tree.root, key);
  vs_status s = VS_OK;
  if (map && map->kind != VS_NODE_MAP)
    return vs_error_keep(
        err, vs_fail_at(err, map->where, "%s: a map is wanted: {NAME: {...}, ...}", key));
  for (const vs_node *n = map ? map->child : NULL; n && !s; n = n->next)
    s = vs_error_keep(err, read(m, n, err));
  return s;
}

/* Reads both keys. Errors with their place; a check carries on. */
static vs_status read_bodies(vs_machine *m, vs_error *err) {
  const vs_node *springs = vs_tree_child(m->tree.root, "springs");
  vs_status s = read_each(m, "bodies", read_body, err);
  if (!s && springs && !m->n_bodies)
    return vs_fail_at(err, springs->key_where, "springs: there are no bodies to hold");
  return s ? s : read_each(m, "springs", read_spring, err);
}

/* ---- the keys of a machine's file ---- */

static const vs_field ROW = {.kind = VS_LIST, .inside = &(const vs_inside){.rows = &FORMULA}},
                      SUM = {.kind = VS_CHOICE, .choices = "mass|damping|stiffness|forces"};
static const vs_inside ROWS = {.rows = &ROW}, SUMS = {.rows = &SUM, .instead = &SUM},
                       FORMULAS = {.rows = VS_ROWS({.kind = VS_TEXT})},
                       GAP = {.rows = VS_ROWS({"along", VS_NEEDED | VS_MAP, .inside = &FORMULAS})};
#define AT(member) .offset = offsetof(vs_machine, member)
static const vs_inside LOAD = {
    .rows =
        VS_ROWS({"adds", .kind = VS_NEEDED | VS_TEXT}, {"to", VS_NEEDED | VS_LIST, .inside = &SUMS},
                {"along", VS_TEXT, "m", AT(load.way[VS_MACHINE_ALONG])},
                {"up", VS_TEXT, "m", AT(load.way[VS_MACHINE_UP])},
                {"forward", VS_TEXT, "m", AT(load.way[VS_MACHINE_FORWARD])})};
static const vs_inside ACTUATOR = {
    .rows = VS_ROWS({"current", VS_TEXT, "A", AT(law[VS_MACHINE_CURRENT])},
                    {"energy", VS_TEXT, "J", AT(law[VS_MACHINE_ENERGY])},
                    {"force", VS_TEXT, "N", AT(law[VS_MACHINE_FORCE])}),
    .besides = &vs_actuator_section};
#undef AT
static const vs_inside PROBE = {.rows = VS_ROWS({"of", .kind = VS_NEEDED | VS_TEXT},
                                                {"unit", .kind = VS_TEXT},
                                                {"text", .kind = VS_TEXT | VS_NOTHING})},
                       SUPPLY = {.besides = &vs_feed_supply}, FIRING = {.besides = &vs_feed_firing};

/* {NAME: {...}, ...} */
#define EACH(keys)                                                                                 \
  .inside = (&(const vs_inside){.rows = VS_ROWS({.kind = VS_MAP, .inside = &(keys)})})
/* To add a key: a row here and a function that reads it; the schema follows. */
static const vs_field KEYS[] = {
    {"title", .kind = VS_TEXT | VS_NOTHING},
    {"coordinates", VS_NEEDED | VS_MAP, EACH(vs_declare_coordinate_keys)},
    {"parameters", VS_NOTHING | VS_MAP, EACH(vs_declare_parameter_keys)},
    {"let", VS_NOTHING | VS_MAP, .inside = &FORMULAS},
    {"mass", VS_TEXT | VS_LIST, .inside = &ROWS},
    {"damping", VS_TEXT | VS_LIST, .inside = &ROWS},
    {"stiffness", VS_TEXT | VS_LIST, .inside = &ROWS},
    {"bodies", VS_MAP, EACH(BODY)},
    {"springs", VS_MAP, EACH(SPRING)},
    {"forces", VS_NOTHING | VS_MAP, .inside = &FORMULAS},
    {"gap", VS_NEEDED | VS_MAP, .inside = &GAP},
    {"load", VS_NOTHING | VS_MAP, .inside = &LOAD},
    {"probes", VS_NOTHING | VS_MAP, EACH(PROBE)},
    {"actuator", VS_NOTHING | VS_MAP, .inside = &ACTUATOR},
    {"supply", VS_NOTHING | VS_MAP, .inside = &SUPPLY},
    {"firing", VS_NOTHING | VS_MAP, .inside = &FIRING},
    {"instruments", .kind = VS_NOTHING | VS_SENSORS},
    {0}};
const vs_inside vs_machine_file_keys = {.rows = KEYS};
#undef EACH

/* ---- maps ---- */

static bool is_map(const vs_node *node) {
  return node && node->kind == VS_NODE_MAP;
}

/* The map of that key; NULL where the file has none, or none that can be read. */
static vs_status map_of(const vs_machine *m, const char *key, const vs_node **map, vs_error *err) {
  const vs_node *node = vs_tree_child(m->tree.root, key);
  *map = is_map(node) ? node : NULL;
  if (!node || *map || (node->kind == VS_NODE_TEXT && !*node->text)) return VS_OK;
  return vs_error_keep(err,
                       vs_fail_at(err, node->where, "%s: a map is wanted: {NAME: ..., ...}", key));
}

/* Reads each entry of such a map. */
static vs_status read_entries(vs_machine *m, const char *key,
                              vs_status (*read)(vs_machine *m, const vs_node *node, vs_error *err),
                              vs_error *err) {
  const vs_node *map;
  vs_status s = map_of(m, key, &map, err);
  for (const vs_node *n = map ? map->child : NULL; n && !s; n = n->next)
    s = vs_error_keep(err, read(m, n, err));
  return s;
}

/* ---- lets ---- */

static vs_status read_let(vs_machine *m, const vs_node *node, vs_error *err) {
  int k = m->n_names - m->n_parameters;
  char what[VS_MACHINE_NAME + 8];
  vs_expression let;
  if (k >= VS_MACHINE_LETS)
    return vs_fail_at(err, node->key_where, "more than %d lets", VS_MACHINE_LETS);
  snprintf(what, sizeof what, "let %.*s", VS_MACHINE_NAME - 1, node->key);
  const vs_expression_use use = {VS_EXPRESSION_LET, what, NULL};
  vs_status s = vs_expression_read(m, node, &use, &let, err);
  const vs_machine_name name = {.dimension = let.dimension, .choice = -1};
  if (!s) s = vs_declare_name(m, node->key, name, node->key_where, err);
  if (s)
    vs_formula_free(&let.of);
  else
    m->lets[k] = let;
  return s;
}

/* ---- matrices ---- */

/* An entry of a matrix. */
typedef struct cell {
  int sum, row, column;
} cell;

/* The dimension of an entry. Times q", q' or q it is a force on a coordinate, and such a force
 * times that coordinate is an energy. Column -1: the force itself. M: J s2/(u_i u_j);  B: J s/(u_i
 * u_j);  K: J/(u_i u_j);  f0: J/u_i */
static vs_dimension dimension_of(const vs_machine *m, cell c) {
  const int seconds[VS_MACHINE_SUMS] = {[VS_MACHINE_MASS] = 2, [VS_MACHINE_DAMPING] = 1};
  vs_dimension joule = vs_dimension_of("J"), second = vs_dimension_of("s"),
               by_row = vs_dimension_of(m->coordinates[c.row].unit),
               by_column = vs_dimension_of(c.column < 0 ? "" : m->coordinates[c.column].unit);
  vs_dimension force = vs_dimension_product(&joule, 1, &by_row, -1);
  vs_dimension slope = vs_dimension_product(&force, 1, &by_column, -1);
  return vs_dimension_product(&slope, 1, &second, seconds[c.sum]);
}

static vs_status read_entry(vs_machine *m, cell c, const vs_node *node, vs_error *err) {
  char what[2 * VS_MACHINE_NAME + 24];
  snprintf(what, sizeof what, "%s of %s, %s", vs_machine_sum_words[c.sum],
           m->coordinates[c.row].name, m->coordinates[c.column].name);
  const vs_dimension wanted = dimension_of(m, c);
  const vs_expression_use use = {VS_EXPRESSION_CONSTANT, what, &wanted};
  return vs_expression_read(m, node, &use, &m->sums[c.sum][c.row][c.column], err);
}

static int length_of(const vs_node *list) {
  int n = 0;
  for (const vs_node *c = list->child; c; c = c->next) n++;
  return n;
}

/* True where a comma inside a function's brackets has cut a formula in two. */
static bool is_cut(const vs_node *list) {
  for (const vs_node *n = list->child; n; n = n->next)
    if (n->kind == VS_NODE_TEXT && strchr(n->text, '(') && !strchr(n->text, ')')) return true;
  return false;
}

static vs_status read_matrix_row(vs_machine *m, int sum, int row, const vs_node *list,
                                 vs_error *err) {
  const char *word = vs_machine_sum_words[sum];
  if (list->kind != VS_NODE_LIST || length_of(list) != m->dof)
    return vs_fail_at(err, list->where, "%s, row of %s: values: %d; wanted: %d, by coordinate%s",
                      word, m->coordinates[row].name,
                      list->kind == VS_NODE_LIST ? length_of(list) : 1, m->dof,
                      is_cut(list) ? "; in a list a formula with a comma stands in quotes" : "");
  const vs_node *node = list->child;
  vs_status s = VS_OK;
  for (int j = 0; j < m->dof && !s; j++, node = node->next)
    s = vs_error_keep(err, read_entry(m, (cell){sum, row, j}, node, err));
  return s;
}

static vs_status read_matrix(vs_machine *m, int sum, vs_error *err) {
  const char *word = vs_machine_sum_words[sum];
  const vs_node *node = vs_tree_child(m->tree.root, word);
  if (node && m->n_bodies)
    return vs_fail_at(err, node->key_where,
                      "%s: bodies and springs give it already; leave it out, or those", word);
  if (m->n_bodies) return VS_OK;
  if (!node && sum == VS_MACHINE_DAMPING) return VS_OK;
  if (!node)
    return vs_fail_at(err, (vs_where){m->tree.name, 1, 1},
                      "%s is wanted: a list of rows, [[a, b], [c, d]], of a formula for each "
                      "pair of coordinates",
                      word);
  if (m->dof == 1 && node->kind == VS_NODE_TEXT) return read_entry(m, (cell){sum, 0, 0}, node, err);
  if (node->kind != VS_NODE_LIST || length_of(node) != m->dof)
    return vs_fail_at(err, node->where, "%s: rows: %d; wanted: %d, one for each coordinate", word,
                      node->kind == VS_NODE_LIST ? length_of(node) : 0, m->dof);
  const vs_node *row = node->child;
  vs_status s = VS_OK;
  for (int i = 0; i < m->dof && !s; i++, row = row->next)
    s = vs_error_keep(err, read_matrix_row(m, sum, i, row, err));
  return s;
}

/* ---- what stands by coordinates ---- */

/* {COORDINATE: FORMULA, ...}; along: it is how they open the gap, else they are forces. */
static vs_status read_by_coordinate(vs_machine *m, const vs_node *map, bool along, vs_error *err) {
  const char *names[VS_MACHINE_COORDINATES], *what = along ? "gap.along" : "forces";
  char each[2 * VS_MACHINE_NAME];
  for (int k = 0; k < m->dof; k++) names[k] = m->coordinates[k].name;
  vs_status s = vs_field_known_keys(map, what, names, (size_t)m->dof, err);
  for (int k = 0; k < m->dof && !s; k++) {
    const vs_node *node = vs_tree_child(map, names[k]);
    vs_dimension metre = vs_dimension_of("m"), unit = vs_dimension_of(m->coordinates[k].unit),
                 wanted = along ? vs_dimension_product(&metre, 1, &unit, -1)
                                : dimension_of(m, (cell){VS_MACHINE_FORCES, k, -1});
    const vs_expression_use use = {VS_EXPRESSION_CONSTANT, each, &wanted};
    snprintf(each, sizeof each, "%s of %s", what, names[k]);
    if (node)
      s = vs_error_keep(
          err, vs_expression_read(m, node, &use, along ? &m->along[k] : &m->forces[k], err));
  }
  return s;
}

static vs_status read_forces(vs_machine *m, vs_error *err) {
  const vs_node *map;
  vs_status s = map_of(m, "forces", &map, err);
  return s || !map ? s : read_by_coordinate(m, map, false, err);
}

static vs_status read_gap(vs_machine *m, vs_error *err) {
  const vs_node *map, *along;
  vs_status s = map_of(m, "gap", &map, err);
  if (!s) s = vs_field_map_keys(map, "gap", &GAP, err);
  if (s) return s;
  along = vs_tree_child(map, "along");
  m->where_along = along ? along->key_where : map ? map->where : (vs_where){m->tree.name, 1, 1};
  if (!is_map(along))
    return vs_fail_at(err, along ? along->where : m->where_along,
                      "gap: how the coordinates open it is wanted: gap: {along: {%s: 1}}",
                      m->coordinates[0].name);
  return read_by_coordinate(m, along, true, err);
}

/* ---- the load ---- */

static vs_status read_load_sum(vs_machine *m, const vs_node *node, vs_error *err) {
  for (int s = 0; s < VS_MACHINE_SUMS && node->kind == VS_NODE_TEXT; s++)
    if (!strcmp(node->text, vs_machine_sum_words[s])) {
      m->load.to[s] = true;
      return VS_OK;
    }
  return vs_fail_at(err, node->where, "load.to: there are: mass, damping, stiffness, forces");
}

static vs_status read_load(vs_machine *m, vs_error *err) {
  const vs_node *map;
  const char *names[VS_MACHINE_NAMES];
  vs_status s = map_of(m, "load", &map, err);
  if (s || !map) return s;
  const source ways = {.owner = "load", .kind = VS_EXPRESSION_MOTION, .goes_on = true};
  s = vs_field_map_keys(map, "load", &LOAD, err);
  if (!s) s = read_formulas(m, map, ways, LOAD.rows, m, err);
  const vs_node *adds = vs_tree_child(map, "adds"), *to = vs_tree_child(map, "to");
  if (s) return s;
  if (!adds || adds->kind != VS_NODE_TEXT || !to)
    return vs_fail_at(err, map->where, "load: wanted: {adds: PARAMETER, to: [mass]}");
  for (int k = 0; k < m->n_parameters; k++) {
    names[k] = m->names[k].name;
    if (!strcmp(names[k], adds->text)) m->load.adds = k;
  }
  if (m->load.adds < 0)
    return vs_fail_at(err, adds->where, "load.adds: no parameter '%s'%s", adds->text,
                      vs_text_hint(adds->text, names, (size_t)m->n_parameters, "").text);
  const vs_dimension mass = vs_dimension_of("kg");
  if (!vs_dimension_fits(&m->names[m->load.adds].dimension, &mass))
    return vs_fail_at(err, adds->where, "load.adds: %s is no mass, in kg, as the load is",
                      adds->text);
  if (to->kind == VS_NODE_TEXT) return read_load_sum(m, to, err);
  if (to->kind != VS_NODE_LIST || !to->child)
    return vs_fail_at(err, to->where, "load.to: what the load rides in is wanted: [mass]");
  for (const vs_node *n = to->child; n && !s; n = n->next)
    s = vs_error_keep(err, read_load_sum(m, n, err));
  return s;
}

/* ---- probes ---- */

static const vs_formula *the_probe(void *ctx, const char *name) {
  (void)name;
  return ctx;
}

/* Makes the formula give the probe in its unit, of which it gives the SI value. */
static vs_status scale_probe(vs_machine_probe *probe, vs_error *err) {
  const vs_formula_scope scope = {
      .ctx = &probe->of, .of_machine = true, .named_formula = the_probe};
  char text[64], why[200];
  const char *bad;
  vs_formula shown = {0};
  double factor = vs_units_factor(probe->unit);
  if (factor == 1) return VS_OK;
  snprintf(text, sizeof text, "itself/%.17g", factor);
  const char *end = vs_formula_read(text, &scope, &shown, &bad, why, sizeof why);
  vs_formula_free(&probe->of);
  probe->of = shown;
  return end ? VS_OK : vs_fail_at(err, probe->where, "probes.%s: %s", probe->name, why);
}

static vs_status read_probe(vs_machine *m, const vs_node *node, vs_error *err) {
  char what[VS_MACHINE_NAME + 16];
  vs_machine_probe probe = {.where = node->key_where};
  vs_expression of = {0};
  snprintf(what, sizeof what, "probes.%.*s", VS_MACHINE_NAME - 1, node->key);
  vs_status s = vs_declare_check(m, "probe", node->key, node->key_where, err);
  if (s) return s;
  const vs_node *formula = vs_tree_child(node, "of"), *unit = vs_tree_child(node, "unit");
  if (m->n_probes >= VS_MACHINE_PROBES)
    return vs_fail_at(err, node->key_where, "more than %d probes", VS_MACHINE_PROBES);
  if (node->kind != VS_NODE_MAP || !formula)
    return vs_fail_at(err, node->where, "%s: {of: FORMULA, unit: m, text: ...} is wanted", what);
  snprintf(probe.name, sizeof probe.name, "%s", node->key);
  s = vs_field_map_keys(node, what, &PROBE, err);
  if (!s) s = vs_declare_text(unit, what, probe.unit, sizeof probe.unit, err);
  if (!s)
    s = vs_declare_text(vs_tree_child(node, "text"), what, probe.text, sizeof probe.text, err);
  if (!s && !vs_units_known(probe.unit))
    s = vs_fail_at(err, unit->where, "%s: '%s' is no unit known here", what, probe.unit);
  const vs_dimension wanted = vs_dimension_of(probe.unit);
  const vs_expression_use use = {VS_EXPRESSION_PROBE, what, &wanted};
  if (!s) s = vs_expression_read(m, formula, &use, &of, err);
  if (s) return s;
  probe.of = of.of;
  s = scale_probe(&probe, err);
  if (s)
    vs_formula_free(&probe.of);
  else
    m->probes[m->n_probes++] = probe;
  return s;
}

/* ---- the actuator ---- */

/* Adds a field of a scene's section with the file's value for its default: words and numbers are
 * shown and read as any default. tried: room for what the section fills. */
static vs_status add_default(const vs_section *of, vs_field field, const vs_node *own,
                             vs_section *section, void *tried, vs_error *err) {
  vs_status s = own ? vs_error_keep(err, vs_field_read(of, &field, own, tried, err)) : VS_OK;
  if (own && own->kind == VS_NODE_TEXT) field.default_text = own->text;
  vs_machine_add_field(section, &field);
  return s;
}

/* The scene's section actuator with this file's defaults; of lists and maps they are read by
 * plant/build.c. */
static vs_status make_actuator(vs_machine *m, vs_error *err) {
  vs_status s = VS_OK;
  vs_actuator_values tried;
  bool has_formulas = false;
  for (int k = 0; k < VS_MACHINE_LAWS; k++) has_formulas |= m->law[k].text != NULL;
  for (size_t k = 0; k < vs_actuator_section.count && !s; k++) {
    vs_field field = vs_actuator_section.fields[k];
    if (has_formulas && !strcmp(field.key, "law")) field.default_text = "formula";
    s = add_default(&vs_actuator_section, field, vs_tree_child(m->own_actuator, field.key),
                    &m->actuator, &tried, err);
  }
  return s;
}

/* The same for the section supply or firing, which has words and numbers alone. */
static vs_status read_feed(vs_machine *m, const vs_section *of, const vs_node **own,
                           vs_section *section, vs_error *err) {
  union {
    vs_supply_values supply;
    vs_firing_values firing;
  } tried;
  vs_status s = map_of(m, of->name, own, err);
  if (!s) s = vs_field_section_keys(of, *own, err);
  for (size_t k = 0; k < of->count && !s; k++) {
    const vs_node *node = vs_tree_child(*own, of->fields[k].key);
    if (node && node->kind != VS_NODE_TEXT) {
      s = vs_error_keep(err, vs_fail_at(err, node->where,
                                        "%s.%s: one value is wanted in a machine's file", of->name,
                                        of->fields[k].key));
      node = NULL;
    }
    if (!s) s = add_default(of, of->fields[k], node, section, &tried, err);
  }
  return s;
}

/* Error: the file has a formula for the force, and neither for the current nor for the energy. */
static vs_status check_law(const vs_machine *m, vs_error *err) {
  const char *const *words = vs_machine_law_words;
  const vs_node *force = vs_tree_child(m->own_actuator, words[VS_MACHINE_FORCE]);
  if (!force || vs_tree_child(m->own_actuator, words[VS_MACHINE_CURRENT]) ||
      vs_tree_child(m->own_actuator, words[VS_MACHINE_ENERGY]))
    return VS_OK;
  return vs_fail_at(err, force->key_where,
                    "actuator.%s stands without actuator.%s, the current as a formula in lambda "
                    "and z, or actuator.%s; write one of these too",
                    words[VS_MACHINE_FORCE], words[VS_MACHINE_CURRENT], words[VS_MACHINE_ENERGY]);
}

static vs_status read_actuator(vs_machine *m, vs_error *err) {
  const source from = {.owner = "actuator", .kind = VS_EXPRESSION_LAW, .goes_on = true};
  vs_status s = map_of(m, "actuator", &m->own_actuator, err);
  if (!s) s = vs_field_map_keys(m->own_actuator, "actuator", &ACTUATOR, err);
  if (!s) s = read_formulas(m, m->own_actuator, from, ACTUATOR.rows, m, err);
  if (!s) s = vs_error_keep(err, check_law(m, err));
  return s ? s : make_actuator(m, err);
}

/* ---- the file ---- */

bool vs_machine_file_has_keys(const vs_tree *file) {
  static const char *const OWN[] = {"coordinates", "parameters", "let",    "mass",   "damping",
                                    "stiffness",   "gap",        "probes", "bodies", "springs"};
  for (size_t k = 0; k < sizeof OWN / sizeof *OWN; k++)
    if (vs_tree_child(file->root, OWN[k])) return true;
  return false;
}

static vs_status read_machine(vs_machine *m, vs_error *err) {
  const vs_node *root = m->tree.root;
  vs_status s = vs_field_map_keys(root, "a machine", &vs_machine_file_keys, err);
  if (!s)
    s = vs_error_keep(err, vs_declare_text(vs_tree_child(root, "title"), "title", m->title,
                                           sizeof m->title, err));
  size_t found = vs_error_count(err);
  if (!s) s = vs_declare_coordinates(m, vs_tree_child(root, "coordinates"), err);
  if (!s) s = vs_declare_parameters(m, vs_tree_child(root, "parameters"), err);
  if (!s && vs_error_count(err) == found) s = read_entries(m, "let", read_let, err);
  if (s || !m->dof || vs_error_count(err) > found) return s; /* a name may be one that was lost */
  s = read_bodies(m, err);
  if (s || vs_error_count(err) > found) return s;
  for (int sum = 0; sum < VS_MACHINE_FORCES && !s; sum++)
    s = vs_error_keep(err, read_matrix(m, sum, err));
  if (!s) s = vs_error_keep(err, read_forces(m, err));
  if (!s) s = vs_error_keep(err, read_gap(m, err));
  if (!s) s = vs_error_keep(err, read_load(m, err));
  if (!s) s = read_entries(m, "probes", read_probe, err);
  if (!s) s = read_feed(m, &vs_feed_supply, &m->own_supply, &m->supply, err);
  if (!s) s = read_feed(m, &vs_feed_firing, &m->own_firing, &m->firing, err);
  return s ? s : read_actuator(m, err);
}

vs_status vs_machine_file_read(const char *path, vs_machine *m, vs_error *err) {
  size_t found = vs_error_count(err);
  snprintf(m->path, sizeof m->path, "%s", path);
  vs_status s = vs_tree_read(path, &m->tree, err);
  if (!s) s = read_machine(m, err);
  m->lost = s || vs_error_count(err) > found;
  return s;
}
