/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "branch_points.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "poincare_map.h"

enum { MOST = VS_BRANCH_POINT_NUMBERS };

/* n.(z - z0) in the path's units. */
static double offset_of(const vs_branch_points *p, const vs_branch_plane *plane, const double *z) {
  double offset = 0;
  for (int j = 0; j <= p->count; j++)
    offset += plane->normal[j] * (z[j] - plane->origin[j]) / p->unit[j];
  return offset;
}

static void forget_parameter(vs_branch_points *p) {
  if (p->by) vs_parameter_end(p->by);
  free(p->by);
  p->by = NULL;
}

static bool has_circuit(const vs_branch_points *p) {
  return p->along->scene->tier->has_circuit;
}

void vs_branch_points_end(vs_branch_points *p) {
  forget_parameter(p);
  vs_circuit_flight_free(&p->circuit);
}

/* ---- units ---- */

/* The length of a way along which every state changes by all its motion. The key's own unit is its
 * range, so that a step of a 50th of it may change the motion by a 12th. */
static const double WHOLE_MOTION = 4;
/* A state that hardly moves counts as moving by this part of the largest of its kind. Those of a
 * circuit have kinds of their own. */
static const double UNMOVED = 1e-6;

static void take_units(vs_branch_points *p, const double *size) {
  const vs_branch_parameter *along = p->along;
  double largest[3] = {0};
  int dof = along->scene->setup.model.dof;
  for (int j = 0; j < p->count; j++) {
    const int kind = j < 2 * dof ? j / dof : 2;
    largest[kind] = fmax(largest[kind], size[j]);
  }
  for (int j = 0; j < p->count; j++) {
    const int kind = j < 2 * dof ? j / dof : 2;
    double moves = kind == 2 && has_circuit(p) ? size[j] : fmax(size[j], UNMOVED * largest[kind]);
    p->unit[j] = (moves > 0 ? moves : 1) * WHOLE_MOTION * sqrt(p->count);
  }
  p->unit[p->count] = fabs(along->to - along->from);
}

static void normalise_way(const vs_branch_points *p, double *way) {
  double squared = 0;
  for (int j = 0; j <= p->count; j++) squared += way[j] * way[j];
  for (int j = 0; j <= p->count; j++) way[j] /= sqrt(squared);
}

void vs_branch_points_rescale(vs_branch_points *p, vs_branch_point *at) {
  double was[MOST];
  memcpy(was, p->unit, sizeof was);
  take_units(p, at->size);
  for (int j = 0; j <= p->count; j++) at->way[j] *= was[j] / p->unit[j];
  normalise_way(p, at->way);
}

/* ---- the run over a period, and its derivatives ---- */

/* P(z) and what is known of it. */
typedef struct image {
  vs_poincare_map flight;
  double by_key[VS_FLIGHT_STATES]; /* dP/dk */
} image;

static void begin_flight(vs_branch_points *p, vs_poincare_map *f) {
  vs_poincare_map_begin(f, p->along->scene);
  const int kind = has_circuit(p) ? VS_BUDGET_CIRCUIT : VS_BUDGET_IDEAL;
  f->budget = p->budget.most[kind] ? &p->budget : NULL;
  f->states = p->count;
}

static vs_status go(vs_branch_points *p, vs_poincare_map *f, const double *x, bool derives,
                    vs_error *err) {
  p->runs++;
  return has_circuit(p)
             ? vs_circuit_flight_go(&p->circuit, f, x, p->periods, !derives, derives, err)
             : vs_poincare_map_go(f, x, p->periods, derives, err);
}

static vs_status watch_turns(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  vs_orbit_extremes_accept(ctx, step);
  return VS_OK;
}

/* Moves the key and what the run's derivative with respect to it is made of. */
static vs_status move_to(vs_branch_points *p, double key, vs_error *err) {
  const vs_axis *axis = &p->along->axis;
  vs_error why = {0};
  vs_status status = vs_branch_parameter_move(p->along, key, err);
  if (status || has_circuit(p) || (p->by && !vs_parameter_again(p->by, &why))) return status;
  forget_parameter(p);
  vs_parameter *by = vs_alloc(1, sizeof *by);
  status = vs_parameter_begin(by, p->along->scene, axis->key, axis->where, 0, NULL, err);
  if (status)
    free(by);
  else
    p->by = by;
  return status;
}

/* The end of the run from the same state with another value of the key. */
static vs_status end_at(vs_branch_points *p, const double *x, double key, double *end,
                        vs_error *err) {
  vs_poincare_map f;
  vs_status status = vs_branch_parameter_move(p->along, key, err);
  if (status) return status;
  begin_flight(p, &f);
  status = go(p, &f, x, false, err);
  memcpy(end, f.end, (size_t)p->count * sizeof *end);
  vs_poincare_map_end(&f);
  return status;
}

/* By this part of its range the key is moved for differences. Runs are known to some 1e-12 of the
 * motion, and a millionth of the slope slows the iteration by nothing that is seen. */
static const double NUDGE = 1e-6;

/* dP/dk by differences, where the run has no derivative of its own: a thyristor that fires in
 * another cycle at a key a thousandth beside this one has none (orbit/parameter.h). They are
 * one-sided where the key may not go farther. */
static vs_status differ_by_key(vs_branch_points *p, const double *z, double *by_key,
                               vs_error *err) {
  double h = NUDGE * p->unit[p->count], key = z[p->count], lower[MOST], upper[MOST];
  double lo = key - h, hi = key + h;
  vs_error why = {0};
  vs_status status = end_at(p, z, lo, lower, &why);
  if (status) status = end_at(p, z, lo = key, lower, err);
  if (!status && end_at(p, z, hi, upper, &why)) status = end_at(p, z, hi = key, upper, err);
  if (status || lo == hi) return status ? status : vs_fail(err, VS_INPUT, "%s", why.text);
  for (int i = 0; i < p->count; i++) by_key[i] = (upper[i] - lower[i]) / (hi - lo);
  return vs_branch_parameter_move(p->along, key, err);
}

/* dP/dk with a circuit: by a run along the steps of the one from the same state, and the key moved
 * by such a part of its range. A shorter one serves where a device switches in another of the
 * steps; instants are known to 1e-11 s. */
static const double NUDGES[] = {1e-4, -1e-4, 1e-5, -1e-5, 1e-6, -1e-6};
enum { N_NUDGES = sizeof NUDGES / sizeof *NUDGES };

static vs_status differ_along_steps(vs_branch_points *p, const double *z, image *of,
                                    vs_error *err) {
  double end[MOST];
  vs_status status = VS_RUN;
  for (int n = 0; n < N_NUDGES && status && status != VS_BUDGET; n++) {
    const double by = NUDGES[n] * p->unit[p->count];
    *err = (vs_error){0};
    status = end_at(p, z, z[p->count] + by, end, err);
    for (int i = 0; i < p->count && !status; i++) of->by_key[i] = (end[i] - of->flight.end[i]) / by;
  }
  return status ? status : vs_branch_parameter_move(p->along, z[p->count], err);
}

/* Runs over a period from at->z, with all derivatives but dP/dk. */
static vs_status fly_one_period(vs_branch_points *p, vs_branch_point *at, image *to,
                                vs_error *err) {
  vs_orbit_extremes_begin(&at->turns, &p->along->scene->setup.model);
  const vs_observer also = {&at->turns, watch_turns};
  to->flight.also = &also;
  vs_status status = go(p, &to->flight, at->z, true, err);
  to->flight.also = NULL;
  return status;
}

static vs_status fly_with_parameter(vs_branch_points *p, vs_branch_point *at, image *to,
                                    vs_error *err) {
  vs_error why = {0};
  vs_status status = VS_OK;
  to->flight.parameter = p->by;
  bool known = !fly_one_period(p, at, to, &why);
  if (!known) snprintf(p->kinked, sizeof p->kinked, "%.255s", why.text);
  to->flight.parameter = NULL;
  if (!known) status = differ_by_key(p, at->z, to->by_key, err);
  if (!known && !status) status = fly_one_period(p, at, to, err);
  double unit = vs_units_factor(p->along->axis.unit) / p->by->size;
  for (int i = 0; i < p->count && known; i++)
    to->by_key[i] = unit * vs_variation_get(&to->flight.variation, i, p->count);
  return status;
}

/* Makes the image of the point; vs_poincare_map_end it where it has a scene. */
static vs_status map_point(vs_branch_points *p, vs_branch_point *at, image *to, vs_error *err) {
  *to = (image){0};
  vs_status status = move_to(p, at->z[p->count], err);
  if (status) return status;
  begin_flight(p, &to->flight);
  if (has_circuit(p)) {
    status = fly_one_period(p, at, to, err);
    if (!status) status = differ_along_steps(p, at->z, to, err);
  } else {
    status = fly_with_parameter(p, at, to, err);
  }
  at->period_s = p->periods * to->flight.cycle_s;
  memcpy(at->size, to->flight.size, sizeof at->size);
  return status;
}

/* ---- Newton's iteration ---- */

/* The equations at a point, solved. */
typedef struct linear {
  double step[MOST]; /* to the solution, in parts of the units */
  double way[MOST];  /* the branch's direction there */
} linear;

static bool solve_newton_step(const vs_branch_points *p, const vs_branch_plane *plane,
                              const double *z, image *im, linear *out) {
  size_t n = (size_t)p->count + 1, order[MOST];
  double matrix[MOST * MOST], missing[MOST], along[MOST] = {0};
  int sign;
  for (size_t i = 0; i + 1 < n; i++) {
    for (size_t j = 0; j + 1 < n; j++)
      matrix[i * n + j] =
          ((i == j) - vs_poincare_map_slope(&im->flight, (int)i, (int)j)) * p->unit[j] / p->unit[i];
    matrix[i * n + n - 1] = -im->by_key[i] * p->unit[n - 1] / p->unit[i];
    missing[i] = (im->flight.end[i] - z[i]) / p->unit[i];
  }
  memcpy(matrix + (n - 1) * n, plane->normal, n * sizeof *matrix);
  missing[n - 1] = plane->offset - offset_of(p, plane, z);
  along[n - 1] = 1;
  gsl_matrix_view a = gsl_matrix_view_array(matrix, n, n);
  gsl_vector_view b = gsl_vector_view_array(missing, n), c = gsl_vector_view_array(along, n);
  gsl_vector_view step = gsl_vector_view_array(out->step, n),
                  way = gsl_vector_view_array(out->way, n);
  gsl_permutation order_of = {n, order};
  if (gsl_linalg_LU_decomp(&a.matrix, &order_of, &sign)) return false;
  if (gsl_linalg_LU_solve(&a.matrix, &order_of, &b.vector, &step.vector)) return false;
  if (gsl_linalg_LU_solve(&a.matrix, &order_of, &c.vector, &way.vector)) return false;
  normalise_way(p, out->way);
  for (size_t j = 0; j < n; j++)
    if (!isfinite(out->step[j]) || !isfinite(out->way[j])) return false;
  return true;
}

/* How near the orbit comes to the ends of the gap, of the machine at this value of the key. */
static void measure_room(vs_branch_point *at, const vs_model *m) {
  double least = at->turns.least.best.value;
  bool stop = m->stops.count && m->stops.item[0].side > 0;
  at->pole_m = m->coil.law->poles && !stop ? least + m->actuator.gap_m : NAN;
  at->iron_m = m->coil.law->poles ? vs_coil_gap(&m->coil, least) : NAN;
}

/* What the last run of the iteration tells of the orbit. */
static vs_status conclude_point(const vs_branch_points *p, vs_branch_point *at, image *im,
                                vs_error *err) {
  const vs_poincare_map *f = &im->flight;
  double monodromy[VS_FLIGHT_STATES * VS_FLIGHT_STATES];
  const int seen = has_circuit(p) ? 2 * f->given->setup.model.dof : p->count;
  if (!has_circuit(p) && !f->given->setup.timeline.firing.no_valve && f->flux_wb != 0)
    return vs_fail(err, VS_RUN,
                   "current flows where the mains rise through zero, and the orbit's state is not "
                   "the machine's alone");
  if (f->left[0])
    return vs_fail(err, VS_RUN, "the orbit leaves the law %s at t = %.9g s: %s",
                   f->given->setup.model.coil.law->name, f->left_s, f->left);
  for (int i = 0; i < p->count; i++)
    for (int j = 0; j < p->count; j++)
      monodromy[i * p->count + j] =
          vs_poincare_map_slope(&im->flight, i, j) * p->unit[j] / p->unit[i];
  if (!vs_multipliers_of(p->count, monodromy, at->multiplier))
    return vs_fail(err, VS_RUN, "the orbit's multipliers cannot be found");
  measure_room(at, &f->given->setup.model);
  at->unstable = 0;
  for (int k = 0; k < p->count; k++)
    at->unstable += hypot(at->multiplier[k].re, at->multiplier[k].im) >= 1;
  at->repeats = INFINITY;
  for (int k = 1; k < p->periods; k++) {
    double off = 0;
    if (p->periods % k) continue;
    for (int j = 0; j < seen; j++)
      off = fmax(off, fabs(f->passed[(size_t)(k - 1) * VS_VARIATION_MOST + (size_t)j] - at->z[j]) /
                          p->unit[j]);
    at->repeats = fmin(at->repeats, off * WHOLE_MOTION * sqrt(p->count));
  }
  return VS_OK;
}

/* Below this, in parts of the motion, a correction is rounding; or below the map's noise. The
 * iteration may also end where the corrections have stopped falling and are as small as the tier's
 * own error. */
static const double CLOSED = 1e-12, STALLED = 1e-9, LARGER = 100;
enum { MOST_ITERATIONS = 12 };

/* One step of the iteration; *done: it was the last. */
static vs_status improve_point(vs_branch_points *p, const vs_branch_plane *plane,
                               vs_branch_point *at, bool *done, vs_error *err) {
  image im;
  linear l;
  double before = at->change, change = 0;
  vs_status status = map_point(p, at, &im, err);
  if (!status && !solve_newton_step(p, plane, at->z, &im, &l))
    status = vs_fail(err, VS_RUN, "the equations of the branch have no single solution");
  if (!status) {
    memcpy(at->way, l.way, sizeof at->way);
    for (int j = 0; j <= p->count; j++) change = fmax(change, fabs(l.step[j]));
    at->change = change * WHOLE_MOTION * sqrt(p->count);
    *done = at->change <= fmax(CLOSED, p->noise) ||
            (at->change < fmax(STALLED, LARGER * p->noise) && at->change > before / 4);
    for (int j = 0; j <= p->count; j++) at->z[j] += l.step[j] * p->unit[j];
    at->iterations++;
  }
  if (!status && *done) status = conclude_point(p, at, &im, err);
  if (im.flight.scene) vs_poincare_map_end(&im.flight);
  return status;
}

vs_status vs_branch_points_solve(vs_branch_points *p, const vs_branch_plane *plane,
                                 vs_branch_point *at, vs_error *err) {
  bool done = false;
  at->iterations = 0;
  at->change = INFINITY;
  p->kinked[0] = '\0';
  for (int k = 0; k < MOST_ITERATIONS && !done; k++) {
    double before = at->change;
    vs_status status = improve_point(p, plane, at, &done, err);
    if (status) return status;
    if (!done && k >= 2 && at->change > 4 * before) break;
  }
  if (!done && *p->kinked) return vs_fail(err, VS_RUN, "%s", p->kinked);
  return done
             ? VS_OK
             : vs_fail(err, VS_RUN, "after %d iterations the last correction is %.2g of the motion",
                       at->iterations, at->change);
}

/* ---- the beginning ---- */

static vs_status seek_alone(vs_branch_points *p, vs_branch_point *first, double *size,
                            vs_error *err) {
  const vs_branch_parameter *along = p->along;
  const vs_shooting how = {.periods = p->periods, .unguarded = true, .quietly = true};
  vs_orbit orbit;
  vs_status status = vs_shooting_seek(along->scene, &how, &orbit, err);
  if (status) return status;
  if (orbit.n < p->periods)
    return vs_fail(err, VS_RUN,
                   "--period %d: the orbit that is found at %s = %.9g%s%s repeats after %d "
                   "already; write --period %d",
                   p->periods, along->axis.key, along->from, *along->axis.unit ? " " : "",
                   along->axis.unit, orbit.n, orbit.n);
  p->count = orbit.count;
  memcpy(first->z, orbit.x, (size_t)p->count * sizeof *first->z);
  memcpy(size, orbit.scale, (size_t)p->count * sizeof *size);
  return VS_OK;
}

/* As the search for an orbit with a circuit does, the iteration ends at this part of run.tolerance
 * (picard.c). */
static const double NOISE = 0.01;

static vs_status seek_with_circuit(vs_branch_points *p, vs_branch_point *first, double *size,
                                   vs_error *err) {
  vs_circuit_flight *c = &p->circuit;
  vs_status status = vs_circuit_flight_seek(c, p->along->scene, p->periods, err);
  p->noise = NOISE * p->along->scene->setup.run.tolerance;
  p->count = c->states;
  memcpy(first->z, c->x, (size_t)p->count * sizeof *first->z);
  memcpy(size, c->size, (size_t)p->count * sizeof *size);
  return status;
}

vs_status vs_branch_points_begin(vs_branch_points *p, vs_branch_parameter *along, int periods,
                                 vs_branch_point *first, vs_error *err) {
  double normal[MOST] = {0}, origin[MOST], size[VS_FLIGHT_STATES];
  *p = (vs_branch_points){.along = along, .periods = periods};
  *first = (vs_branch_point){0};
  vs_status status =
      has_circuit(p) ? seek_with_circuit(p, first, size, err) : seek_alone(p, first, size, err);
  if (status) return status;
  take_units(p, size);
  first->z[p->count] = along->from;
  normal[p->count] = along->to > along->from ? 1 : -1;
  memcpy(origin, first->z, sizeof origin);
  const vs_branch_plane here = {normal, origin, 0};
  return vs_branch_points_solve(p, &here, first, err);
}
