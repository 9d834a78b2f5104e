/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/shooting.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/firing.h"
#include "plant/coil.h"
#include "poincare_map.h"

enum { MOST = VS_ORBIT_STATES };

vs_setup vs_shooting_setup(const vs_scene *scene, const vs_run_values *run, const vs_orbit *orbit) {
  return vs_poincare_map_setup(scene, run, orbit->x);
}

/* ---- Newton's iteration ---- */

/* A state that hardly moves is told from one that does not move at all to this part of the largest
 * of its kind. */
static const double UNMOVED = 1e-9;

static void find_scales(const vs_poincare_map *f, int dof, vs_orbit *o) {
  double largest[3] = {0};
  for (int j = 0; j < o->count; j++) {
    const int kind = j < 2 * dof ? j / dof : 2;
    largest[kind] = fmax(largest[kind], f->size[j]);
  }
  for (int j = 0; j < o->count; j++) {
    const int kind = j < 2 * dof ? j / dof : 2;
    double least = largest[kind] > 0 ? UNMOVED * largest[kind] : 1;
    o->scale[j] = fmax(f->size[j], least);
  }
}

/* Solves (I - P) d = x(T) - x, in parts of each state's scale. Returns false where the matrix is
 * singular to rounding. */
static bool solve_shooting_step(const vs_orbit *o, const double *end, double *d) {
  size_t n = (size_t)o->count, order[MOST];
  double matrix[MOST * MOST], missing[MOST], most = 0, least = INFINITY;
  int sign;
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < n; j++)
      matrix[i * n + j] = (i == j) - o->monodromy[i][j] * o->scale[j] / o->scale[i];
    missing[i] = (end[i] - o->x[i]) / o->scale[i];
  }
  gsl_matrix_view a = gsl_matrix_view_array(matrix, n, n);
  gsl_vector_view b = gsl_vector_view_array(missing, n), by = gsl_vector_view_array(d, n);
  gsl_permutation p = {n, order};
  if (gsl_linalg_LU_decomp(&a.matrix, &p, &sign)) return false;
  for (size_t i = 0; i < n; i++) {
    most = fmax(most, fabs(matrix[i * n + i]));
    least = fmin(least, fabs(matrix[i * n + i]));
  }
  return least > 1e-13 * most && !gsl_linalg_LU_solve(&a.matrix, &p, &b.vector, &by.vector);
}

/* One iteration: runs the periods from x with derivatives, and corrects x by Newton's step; *change
 * is the correction relative to scale. */
static vs_status improve_start(vs_poincare_map *f, vs_orbit *o, double *change, vs_error *err) {
  double d[MOST];
  vs_status status = vs_poincare_map_go(f, o->x, o->n, true, err);
  for (int i = 0; i < o->count && !status; i++)
    for (int j = 0; j < o->count; j++) o->monodromy[i][j] = vs_variation_get(&f->variation, i, j);
  if (status) return status;
  find_scales(f, f->given->setup.model.dof, o);
  if (!solve_shooting_step(o, f->end, d))
    return vs_fail(err, VS_RUN,
                   "the orbit's equations have no single solution: an orbit turns back here, or a "
                   "coordinate has no spring");
  *change = 0;
  for (int j = 0; j < o->count; j++) {
    o->x[j] += d[j] * o->scale[j];
    *change = fmax(*change, fabs(d[j]));
  }
  return VS_OK;
}

/* Below this, relative to each state's scale, Newton's correction is rounding. The iteration may
 * also end where the corrections have stopped falling, and are as small as the tier's own error. */
static const double CLOSED = 1e-12, STALLED = 1e-9;
enum { MOST_ITERATIONS = VS_ORBIT_ITERATIONS / 2 };

static vs_status iterate_newton(vs_poincare_map *f, vs_orbit *o, vs_error *err) {
  double change = INFINITY, before = INFINITY;
  for (int k = 0; k < MOST_ITERATIONS; k++) {
    vs_error why = {0};
    before = change;
    vs_status status = improve_start(f, o, &change, &why);
    if (status == VS_BUDGET && isfinite(before))
      return vs_fail(err, status,
                     "no periodic orbit is found: in iteration %d, where the last correction was "
                     "%.2g of the motion, %s",
                     o->iterations + 1, before, why.text);
    if (status)
      return vs_fail(err, status == VS_BUDGET ? status : VS_RUN,
                     "no periodic orbit is found: in iteration %d, %s", o->iterations + 1,
                     why.text);
    o->correction[o->iterations++] = o->residual = change;
    if (change <= CLOSED || (change < STALLED && change > before / 4)) return VS_OK;
  }
  return vs_fail(err, VS_RUN,
                 "no periodic orbit is found: after %d iterations the last correction is %.2g of "
                 "the motion, the one before was %.2g",
                 o->iterations, change, before);
}

/* ---- its period ---- */

/* By how much, relative to scale, a state may be off where it repeats. */
static const double REPEATS = 1e-8;

/* The least number of firing periods after which the state repeats: a divisor of n. */
static int least_period(const vs_poincare_map *f, const vs_orbit *o) {
  for (int k = 1; k < o->n; k++) {
    double off = 0;
    if (o->n % k) continue;
    for (int j = 0; j < o->count; j++)
      off = fmax(off, fabs(f->passed[(size_t)(k - 1) * VS_VARIATION_MOST + (size_t)j] - o->x[j]) /
                          o->scale[j]);
    if (off <= REPEATS) return k;
  }
  return o->n;
}

/* ---- what is refused ---- */

/* The place of the scene's key. */
static vs_where place_of_key(const vs_scene *s, const char *key) {
  return vs_tree_place(s->tree.root, key);
}

vs_status vs_shooting_check(const vs_scene *s, int periods, vs_error *err) {
  const vs_timeline *line = &s->setup.timeline;
  if (periods < 1) return vs_fail(err, VS_INPUT, "--period %d: allowed: 1 and more", periods);
  if (vs_deck_has_port(&s->setup.deck, vs_port_is_modulated))
    return vs_fail_at(
        err, place_of_key(s, "circuit.deck"),
        "circuit.deck: the deck has a port pwm, for which no periodic orbit is sought; "
        "run it until it repeats, with means over its end as measure: {from: ..., "
        "to: ...} says");
  if (line->supply.direct)
    return vs_fail_at(err, place_of_key(s, "supply.kind"),
                      "supply.kind: step has no period, and so no periodic orbit; sine has one");
  if (line->events.count)
    return vs_fail_at(err, line->events.item[0].where,
                      "events.%s: a periodic orbit has no events; they strike a machine that runs "
                      "on it",
                      line->events.item[0].name);
  if (!line->firing.no_valve && !line->firing.every)
    return vs_fail_at(err, place_of_key(s, "firing.every"),
                      "firing.every: a periodic orbit needs continuous firing, not 'once'; write "
                      "firing.every: 1");
  if (!vs_firing_is_even(line))
    return vs_fail_at(err, place_of_key(s, "firing.angle"),
                      "firing.angle: a periodic orbit has one angle, and this is a table over "
                      "time; write one angle");
  return VS_OK;
}

const char *vs_shooting_weakens(const vs_scene *s) {
  return s->setup.timeline.firing.no_valve ? "a lower supply.voltage"
                                           : "a larger firing.angle or a lower supply.voltage";
}

/* Refuses what was found where it is no orbit of the machine, or none of this period. */
static vs_status judge_orbit_found(const vs_poincare_map *f, const vs_shooting *how, vs_orbit *o,
                                   vs_error *err) {
  const vs_model *m = &f->given->setup.model;
  if (!how->unguarded && vs_mechanics_closed(m, f->deepest_m))
    return vs_fail(
        err, VS_RUN,
        "the orbit goes beyond the pole cover: %s = %.6g mm at t = %.9g s, the cover is at "
        "-D = %g mm, and the scene has no actuator.stop; actuator.stop={} gives it one, %s keeps "
        "it off",
        vs_mechanics_travel_name(m), 1e3 * f->deepest_m, f->deepest_s, -1e3 * m->actuator.gap_m,
        vs_shooting_weakens(f->given));
  if (!how->unguarded && f->left[0])
    return vs_fail(err, VS_RUN, "the orbit leaves the law %s at t = %.9g s: %s", m->coil.law->name,
                   f->left_s, f->left);
  if (!f->given->setup.timeline.firing.no_valve && f->flux_wb != 0)
    return vs_fail(err, VS_RUN,
                   "current still flows where the mains rise through zero: the thyristor does not "
                   "go out in a cycle, and the orbit's state is not the machine's alone");
  if (how->quietly || o->n == how->periods) return VS_OK;
  o->runs_on = o->n;
  return vs_fail(err, VS_RUN,
                 "--period %d: the orbit that is found repeats after %d already; write --period %d",
                 how->periods, o->n, o->n);
}

/* ---- all of it ---- */

/* How many firing periods are run, from the scene's start at first, before each attempt at Newton's
 * iteration. After the first 30 the fast transients are gone, and without a stop in reach six
 * iterations are enough; the longer ones are for machines that hit their stops, and for
 * subharmonics, beside which the orbit of a smaller period is unstable. */
static const int MARCHES[] = {30, 300, 3000};
/* A search ends at so many cycles of the mains, which take some 16 s. That of a short period ends
 * before, for a reason of its own: one of a single cycle has 4300 at most. */
enum { MOST_CYCLES = 400000 };
enum { ATTEMPTS = sizeof MARCHES / sizeof *MARCHES };

static void put_start(const vs_scene *s, double x[MOST]) {
  const vs_model *m = &s->setup.model;
  memcpy(x, s->setup.start.x, 2 * (size_t)m->dof * sizeof *x);
  if (!s->setup.timeline.firing.no_valve && !m->coil.eddies) return;
  const double idle_wb = vs_coil_idle_flux(&m->coil, vs_mechanics_gap(m, x));
  x[2 * m->dof] = idle_wb;
  for (int n = 0; n < m->coil.rungs; n++) x[2 * m->dof + 1 + n] = m->coil.rung[n].share * idle_wb;
}

/* Runs on from o->x for so many firing periods, without derivatives. */
static vs_status march_to_orbit(vs_poincare_map *f, int periods, vs_orbit *o, vs_error *err) {
  const vs_model *m = &f->given->setup.model;
  vs_error why = {0};
  vs_status status = vs_poincare_map_go(f, o->x, periods, false, &why);
  if (!status) memcpy(o->x, f->end, (size_t)o->count * sizeof *o->x);
  if (!status) return VS_OK;
  if (!isnan(f->beyond_s))
    return vs_fail(err, VS_RUN,
                   "no periodic orbit is found: on the way from the start the armature goes beyond "
                   "the pole cover (%s = -D = %g mm) at t = %.9g s, and the scene has no "
                   "actuator.stop; actuator.stop={} gives it one, %s keeps it off",
                   vs_mechanics_travel_name(m), -1e3 * m->actuator.gap_m, f->beyond_s,
                   vs_shooting_weakens(f->given));
  return vs_fail(err, status == VS_BUDGET ? status : VS_RUN,
                 "no periodic orbit is found: on the way from the start, %s", why.text);
}

/* Newton's iteration from o->x, and once more where the orbit repeats earlier, as its own map is
 * another one. */
static vs_status close_in(vs_poincare_map *f, vs_orbit *o, vs_error *err) {
  o->iterations = 0;
  vs_status status = iterate_newton(f, o, err);
  int least = status ? o->n : least_period(f, o);
  if (!status && least < o->n) {
    o->n = least;
    status = iterate_newton(f, o, err);
  }
  if (status) return status;
  if (!vs_multipliers_find(o->count, o->monodromy, o->scale, o->multiplier))
    return vs_fail(err, VS_RUN, "the orbit's multipliers cannot be found");
  o->stable = hypot(o->multiplier[0].re, o->multiplier[0].im) < 1;
  return VS_OK;
}

/* Where the orbit found is unstable, the machine may have been marched to one of a longer period;
 * where none is found, to one of any other. That is looked for from the state x, where the march
 * ended. `missing` says why none is found; it is NULL where one is. */
static vs_status refuse_subharmonic(vs_poincare_map *f, const vs_shooting *how,
                                    const double x[MOST], vs_orbit *o, const char *missing,
                                    vs_error *err) {
  enum { LONGEST = 6 };
  vs_orbit other = *o;
  int least = missing ? 0 : o->n;
  char found[64] = "none is found";
  if (!missing) snprintf(found, sizeof found, "the one found, of period %d, is unstable", o->n);
  for (int n = least + 1; n <= LONGEST; n++) {
    if (n == how->periods) continue;
    vs_error why = {0};
    other.n = n;
    memcpy(other.x, x, sizeof other.x);
    vs_status status = close_in(f, &other, &why);
    if (status == VS_BUDGET)
      return vs_fail(err, status, "%s: while one of period %d was looked for, %s",
                     missing ? missing : found, n, why.text);
    if (status || other.n <= least || !other.stable) continue;
    o->runs_on = other.n;
    return vs_fail(err, VS_RUN,
                   "--period %d: of the orbits %s, and the machine runs on %s of period %d, which "
                   "`steady --period %d` reports",
                   how->periods, found, other.n > how->periods ? "a subharmonic" : "one", other.n,
                   other.n);
  }
  if (!missing) return VS_OK;
  if (!f->given->setup.model.stops.count)
    return vs_fail(err, VS_RUN, "%s; nor is a stable one of another period up to %d", missing,
                   LONGEST);
  return vs_fail(err, VS_RUN,
                 "%s; nor is a stable one of another period up to %d: with a stop in reach the "
                 "motion may never repeat; %s keeps off it",
                 missing, LONGEST, vs_shooting_weakens(f->given));
}

/* Alternates runs that let fast transients decay with Newton's iteration, until that converges. */
static vs_status seek_orbit(vs_poincare_map *f, const vs_shooting *how, vs_orbit *o,
                            vs_error *err) {
  double x[MOST] = {0};
  vs_status status = VS_RUN;
  vs_error why = {0};
  if (how->from)
    memcpy(o->x, how->from, (size_t)o->count * sizeof *x);
  else
    put_start(f->given, o->x);
  /* Each attempt runs on for longer before it iterates (MARCHES): the iteration converges from near
   * the orbit alone, and with stops or subharmonics from very near. */
  for (int k = 0; k < ATTEMPTS; k++) {
    o->n = how->periods;
    if (!how->from && (status = march_to_orbit(f, MARCHES[k] * how->periods, o, err)))
      return status;
    memcpy(x, o->x, sizeof x);
    why = (vs_error){0};
    status = close_in(f, o, &why);
    if (how->from || (!status && (o->n == how->periods || o->stable))) break;
    if (k + 1 < ATTEMPTS) memcpy(o->x, x, sizeof x);
  }
  if (status && (how->from || how->quietly || status == VS_BUDGET))
    return vs_fail(err, status, "%s", why.text);
  /* An unstable orbit is not what the machine does: say which orbit that is. */
  if (!how->from && !how->quietly && (status || !o->stable))
    status = refuse_subharmonic(f, how, x, o, status ? why.text : NULL, err);
  if (status) return status;
  o->period_s = o->n * f->cycle_s;
  return judge_orbit_found(f, how, o, err);
}

vs_status vs_shooting_seek(const vs_scene *scene, const vs_shooting *how, vs_orbit *o,
                           vs_error *err) {
  vs_status status = vs_shooting_check(scene, how->periods, err);
  if (!status)
    status = vs_setup_require_fraction(&scene->setup, place_of_key(scene, "load.fraction"),
                                       "an orbit", err);
  *o = (vs_orbit){.n = how->periods};
  if (!status && scene->tier->has_circuit)
    status =
        vs_fail_at(err, place_of_key(scene, "run.tier"),
                   "tier %s: an orbit is shot for on an ideal tier, as the circuit's own state "
                   "is not known",
                   scene->tier->name);
  if (status) return status;
  vs_poincare_map flight;
  vs_budget own = {.what = "periodic orbit",
                   .of = scene->order.budget,
                   .most = {MOST_CYCLES, 1},
                   .shows = scene->order.shows && !scene->order.budget};
  vs_poincare_map_begin(&flight, scene);
  flight.budget = &own;
  o->count = flight.states;
  status = seek_orbit(&flight, how, o, err);
  vs_poincare_map_end(&flight);
  vs_budget_end(&own);
  return status;
}

vs_status vs_shooting_find(const vs_scene *scene, int periods_n, vs_orbit *orbit, vs_error *err) {
  const vs_shooting how = {.periods = periods_n};
  return vs_shooting_seek(scene, &how, orbit, err);
}
