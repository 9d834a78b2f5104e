/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plane.h"

#include <math.h>
#include <string.h>

#include "expression.h"

enum { X, Y, TURN, MOTIONS, DOF = VS_MACHINE_COORDINATES };

/* How a body moves, per coordinate: its centre of mass along x and y, and its turn. */
typedef struct motion {
  double at[2];
  double by[MOTIONS][DOF];
} motion;

static vs_status expression_value(vs_expression *e, const double *values, const char *what,
                                  double *value, vs_error *err) {
  if (vs_expression_value(e, values, value)) return VS_OK;
  return vs_fail_at(err, e->where, "%s: the value is not finite (%g) with these parameters", what,
                    *value);
}

/* ---- bodies ---- */

/* A motion is linear in the coordinates to this part of itself; what is more is no rounding. */
static const double LINEAR_TO = 1e-12;

vs_status vs_plane_slopes(vs_expression *e, const double values[VS_MACHINE_NAMES], int dof,
                          double out[DOF], vs_error *err) {
  double q[DOF] = {0}, sum = 0, scale = 0;
  memset(out, 0, DOF * sizeof *out);
  if (!e->text) return VS_OK;
  vs_formula_bind(&e->of, values);
  double rest = vs_formula_value(&e->of, q);
  for (int k = 0; k < dof; k++) {
    q[k] = 1;
    out[k] = vs_formula_value(&e->of, q) - rest;
    q[k] = 0;
  }
  for (int k = 0; k < dof; k++) {
    q[k] = (k % 2 ? 1 : -1) * (0.75 + k % 3); /* any other place */
    sum += q[k] * out[k];
    scale += fabs(q[k] * out[k]);
  }
  double off = fabs(vs_formula_value(&e->of, q) - sum);
  if (rest == 0 && off <= LINEAR_TO * scale) return VS_OK;
  return vs_fail_at(err, e->where,
                    "'%s' is not linear in the coordinates; motion is small here, and 0 at rest",
                    e->text);
}

/* Adds to a row what a motion of the body gives to a point (x, y) in that direction:
 *   x' = x'_c - (y - y_c) turn',  y' = y'_c + (x - x_c) turn' */
static void add_point(const motion *body, const double point[2], const double direction[2],
                      double sign, double row[DOF]) {
  double lever = direction[Y] * (point[X] - body->at[X]) - direction[X] * (point[Y] - body->at[Y]);
  for (int k = 0; k < DOF; k++)
    row[k] += sign * (direction[X] * body->by[X][k] + direction[Y] * body->by[Y][k] +
                      lever * body->by[TURN][k]);
}

/* What is summed up, and of what. */
typedef struct plane {
  vs_machine *machine;
  const double *values; /* of the machine's names */
  motion body[VS_MACHINE_BODIES];
  double (*out)[DOF];
} plane;

/* The motion of a body: that of the one it stands on, and its own. */
static vs_status find_motion(plane *p, int index, vs_error *err) {
  static const double AXIS[2][2] = {{1, 0}, {0, 1}};
  vs_body *b = &p->machine->bodies[index];
  motion *own = &p->body[index];
  vs_status s = VS_OK;
  for (int d = 0; d < MOTIONS && !s; d++) {
    s = vs_plane_slopes(&b->moves[d], p->values, p->machine->dof, own->by[d], err);
    if (!s && d < 2) s = expression_value(&b->at[d], p->values, b->name, &own->at[d], err);
  }
  if (s || b->on < 0) return s;
  const motion *below = &p->body[b->on];
  for (int d = 0; d < 2; d++) add_point(below, own->at, AXIS[d], 1, own->by[d]);
  for (int k = 0; k < DOF; k++) own->by[TURN][k] += below->by[TURN][k];
  return VS_OK;
}

static void add_product(plane *p, double factor, const double row[DOF]) {
  for (int i = 0; i < p->machine->dof; i++)
    for (int j = 0; j < p->machine->dof; j++) p->out[i][j] += factor * row[i] * row[j];
}

/* The kinetic energy is the sum of m (x'^2 + y'^2)/2 + J turn'^2/2. */
static vs_status add_body(plane *p, int index, vs_error *err) {
  vs_body *b = &p->machine->bodies[index];
  double mass = 0, inertia = 0;
  vs_status s = expression_value(&b->mass, p->values, b->name, &mass, err);
  if (!s) s = expression_value(&b->inertia, p->values, b->name, &inertia, err);
  for (int d = 0; d < MOTIONS && !s; d++)
    add_product(p, d == TURN ? inertia : mass, p->body[index].by[d]);
  return s;
}

/* ---- springs ---- */

typedef double points[2][2];

/* The direction of a spring that has one, of length 1. */
static vs_status find_direction(const plane *p, vs_spring *s, points point, double direction[2],
                                vs_error *err) {
  vs_status status = VS_OK;
  for (int d = 0; d < 2 && !status; d++) {
    direction[d] = point[1][d] - point[0][d];
    if (s->directed)
      status = expression_value(&s->along[d], p->values, s->name, &direction[d], err);
  }
  if (status) return status;
  double length = hypot(direction[X], direction[Y]);
  if (!(length > 0))
    return vs_fail_at(err, s->where,
                      "spring %s: its points are one, so that it has no direction; give it one by "
                      "`along`, or stiffness: [x, y]",
                      s->name);
  direction[X] /= length;
  direction[Y] /= length;
  return VS_OK;
}

/* Adds what a spring or damper of that strength c does by its extension e along a direction, of
 * which the energy or half the power is c e^2/2. */
static void add_extension(plane *p, const vs_spring *s, points point, const double direction[2],
                          double strength) {
  double row[DOF] = {0};
  for (int end = 0; end < 2; end++)
    if (s->body[end] >= 0)
      add_point(&p->body[s->body[end]], point[end], direction, end ? 1 : -1, row);
  add_product(p, strength, row);
}

static vs_status add_spring(plane *p, int sum, vs_spring *s, vs_error *err) {
  vs_expression *of = sum == VS_MACHINE_DAMPING ? s->damping : s->stiffness;
  points point;
  double strength[2] = {0}, direction[2] = {1, 0};
  vs_status status = VS_OK;
  for (int d = 0; d < 2 && !status; d++) {
    status = expression_value(&s->point[1][d], p->values, s->name, &point[1][d], err);
    point[0][d] = point[1][d];
    if (!status && s->point[0][d].text)
      status = expression_value(&s->point[0][d], p->values, s->name, &point[0][d], err);
    if (!status) status = expression_value(&of[d], p->values, s->name, &strength[d], err);
  }
  if (!status && !s->apart) status = find_direction(p, s, point, direction, err);
  if (status) return status;
  add_extension(p, s, point, direction, strength[0]);
  if (s->apart) add_extension(p, s, point, (const double[2]){0, 1}, strength[1]);
  return VS_OK;
}

vs_status vs_plane_matrix(vs_machine *m, int sum, const double values[VS_MACHINE_NAMES],
                          double out[DOF][DOF], vs_error *err) {
  plane p = {.machine = m, .values = values, .out = out};
  vs_status s = VS_OK;
  for (int k = 0; k < m->n_bodies && !s; k++) s = find_motion(&p, k, err);
  for (int k = 0; k < m->n_bodies && sum == VS_MACHINE_MASS && !s; k++) s = add_body(&p, k, err);
  for (int k = 0; k < m->n_springs && sum != VS_MACHINE_MASS && !s; k++)
    s = add_spring(&p, sum, &m->springs[k], err);
  return s;
}
