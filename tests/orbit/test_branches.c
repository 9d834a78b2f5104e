/* SPDX-License-Identifier: GPL-3.0-or-later
 * Branches of orbits over a key: their marks against orbits that are found at one value of the key
 * each, by bisection and by extrapolation, both branches of the hysteresis, files, and what is
 * refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "orbit/branch_output.h"
#include "orbit/continuation.h"
#include "orbit/measured.h"
#include "orbit/poincare_map.h"
#include "program.h"

#define STOP "actuator.stop={stiffness: 1e6 N/m, damping: 50 N.s/m}"
/* What is promised of a mark's key. */
static const double CLOSE_BY = 1e-9;

/* ---- the branch ---- */

/* A scene, and the walk along a key of it. Free with done. */
typedef struct tour {
  vs_trial *trial;
  vs_branch_parameter along;
  vs_continuation walk;
} tour;

static tour *go_on(const char *tier, const char *const *sets,
                   const vs_branch_parameter_words *words, int periods) {
  tour *t = vs_alloc(1, sizeof *t);
  t->trial = vs_trial_read("paper", tier, sets);
  vs_error *err = &t->trial->err;
  vs_status status = t->trial->status;
  if (!status) status = vs_branch_parameter_read(&t->along, &t->trial->scene, words, err);
  if (!status) status = vs_continuation_go(&t->walk, &t->along, periods, NULL, err);
  EXPECT(!status, "%s: %s", words->range, err->text);
  return t;
}

static tour *go(const char *const *sets, const vs_branch_parameter_words *words, int periods) {
  return go_on("switched", sets, words, periods);
}

static void done(tour *t) {
  vs_continuation_free(&t->walk);
  vs_branch_parameter_free(&t->along);
  vs_trial_free(t->trial);
  free(t);
}

/* The row of the n-th mark of that kind, from 0; NULL: there are not so many. */
static const vs_continuation_row *mark(tour *t, const char *kind, int n) {
  for (size_t r = 0; r < t->walk.count; r++) {
    const vs_continuation_row *row = &t->walk.row[r];
    if (row->mark.kind && !strcmp(row->mark.kind->name, kind) && n-- == 0) return row;
  }
  return NULL;
}

static int marks(tour *t, const char *kind) {
  int n = 0;
  while (mark(t, kind, n)) n++;
  return n;
}

/* The key of that mark; NaN: there is none. It must say that it is as near as promised. */
static double key_of(tour *t, const char *kind, int n) {
  const vs_continuation_row *row = mark(t, kind, n);
  double key = row ? row->at.z[t->walk.path.count] : NAN;
  EXPECT(row && row->mark.error <= CLOSE_BY * key, "%s %d: %g", kind, n,
         row ? row->mark.error : NAN);
  return key;
}

/* ---- orbits at one value of the key ---- */

/* Finds the orbit at this value, once the walk is over; from: a state near to it, or NULL. */
static vs_status orbit_at(tour *t, double key, const double *from, vs_orbit *o, vs_error *err) {
  const vs_shooting how = {
      .periods = t->walk.path.periods, .from = from, .unguarded = true, .quietly = true};
  vs_status status = vs_branch_parameter_move(&t->along, key, err);
  return status ? status : vs_shooting_seek(t->along.scene, &how, o, err);
}

/* Where the orbits found directly begin to have the property, between two values of the key. */
static double bisect(tour *t, double without, double with, bool (*has)(tour *t, double)) {
  EXPECT(!has(t, without) && has(t, with), "%g, %g", without, with);
  while (fabs(with - without) > 3e-10 * fabs(with)) {
    double middle = (without + with) / 2;
    if (has(t, middle))
      with = middle;
    else
      without = middle;
  }
  return (without + with) / 2;
}

/* ---- thresholds ---- */

/* Does the orbit go beyond the pole cover? The deepest travel of a run over a period tells. */
static bool goes_deep(tour *t, double key) {
  vs_orbit o = {0};
  vs_error err = {0};
  vs_poincare_map flight;
  const vs_scene *s = t->along.scene;
  vs_status status = orbit_at(t, key, t->walk.row[0].at.z, &o, &err);
  vs_poincare_map_begin(&flight, s);
  if (!status) status = vs_poincare_map_go(&flight, o.x, 1, false, &err);
  EXPECT(!status, "%g: %s", key, err.text);
  bool deep = flight.deepest_m < -s->setup.model.actuator.gap_m;
  vs_poincare_map_end(&flight);
  return deep;
}

/* validation.md, section 2: where the orbit without a stop begins to touch the pole cover. The
 * digits given there, and orbits by bisection. */
static void the_pole_cover_is_touched(void) {
  static const char *const BY_ANGLE[] = {"firing.every=1", NULL};
  static const char *const BY_FREQUENCY[] = {"firing.every=1", "firing.angle=90deg", NULL};
  const vs_branch_parameter_words angles = {"firing.angle=85deg..75deg", NULL, NULL},
                                  frequencies = {"supply.frequency=50Hz..62Hz", NULL, NULL};
  tour *a = go(BY_ANGLE, &angles, 1), *f = go(BY_FREQUENCY, &frequencies, 1);
  EXPECT(a->walk.end == VS_CONTINUATION_REACHED && f->walk.end == VS_CONTINUATION_REACHED, "%d",
         a->walk.end);
  EXPECT(marks(a, "pole_cover") == 1 && marks(f, "pole_cover") == 2, "%d", marks(f, "pole_cover"));
  double keys[] = {key_of(a, "pole_cover", 0), key_of(f, "pole_cover", 0),
                   key_of(f, "pole_cover", 1)};
  CLOSE_OF(keys[0], 78.993, 1, 5e-4);
  CLOSE_OF(keys[1], 52.823, 1, 5e-4);
  CLOSE_OF(keys[2], 58.385, 1, 5e-4);
  CLOSE(keys[0], bisect(a, 80, 78, goes_deep), CLOSE_BY);
  CLOSE(keys[1], bisect(f, 52, 53, goes_deep), CLOSE_BY);
  CLOSE(keys[2], bisect(f, 59, 58, goes_deep), CLOSE_BY);
  done(a);
  done(f);
}

/* The bound may move with the key: the cover is where the gap at rest says. */
static void the_bound_moves(void) {
  static const char *const SETS[] = {"firing.every=1", "firing.angle=85deg", NULL};
  const vs_branch_parameter_words words = {"actuator.gap=6mm..5mm", NULL, NULL};
  tour *t = go(SETS, &words, 1);
  double gap = key_of(t, "pole_cover", 0), iron = key_of(t, "iron", 0);
  if (mark(t, "iron", 0)) {
    CLOSE(mark(t, "pole_cover", 0)->at.turns.least.best.value, -1e-3 * gap, CLOSE_BY);
    CLOSE(mark(t, "iron", 0)->at.turns.least.best.value, -1e-3 * iron - 0.5e-3, CLOSE_BY);
  }
  done(t);
}

/* ---- the hysteresis ---- */

/* The row of the last point before the mark, or of the first behind it. */
static const vs_continuation_row *neighbour(const vs_continuation_row *of, int side) {
  do of += side;
  while (of->mark.kind);
  return of;
}

/* The key of a fold from orbits at four values of the key beside it. With h^2 the key's distance
 * from the fold, a state of the orbits on either side is x0 +- c h + d h^2 ..., so that the square
 * of their difference is a power series in the key, and 0 at the fold. A polynomial of degree three
 * through four of them finds that. */
static double fold_by_extrapolation(tour *t, const vs_continuation_row *fold, double step) {
  enum { N = 4 };
  double key = fold->at.z[t->walk.path.count], square[N], zero = key;
  vs_orbit o[2];
  vs_error err = {0};
  for (int side = 0; side < 2; side++)
    memcpy(o[side].x, neighbour(fold, side ? 1 : -1)->at.z, sizeof o[side].x);
  for (int n = 0; n < N; n++) {
    for (int side = 0; side < 2; side++) {
      double from[VS_ORBIT_STATES];
      memcpy(from, o[side].x, sizeof from);
      vs_status status = orbit_at(t, key + (N - n) * step, from, &o[side], &err);
      EXPECT(!status, "%s", err.text);
    }
    double apart = o[1].x[0] - o[0].x[0];
    square[n] = apart * apart;
  }
  for (int k = 0; k < 40; k++) { /* secants of Lagrange's polynomial */
    double value[2] = {0};
    for (int at = 0; at < 2; at++)
      for (int n = 0; n < N; n++) {
        double term = square[n], x = zero + at * step / 100;
        for (int m = 0; m < N; m++)
          if (m != n) term *= (x - key - (N - m) * step) / ((m - n) * step);
        value[at] += term;
      }
    zero -= value[0] / (value[1] - value[0]) * step / 100;
  }
  return zero;
}

/* One run over the frequency shows all orbits at 60 Hz: -6.793 mm when swept up, -3.433 mm when
 * swept down (validation.md, section 2), and the unstable one between them. */
static void one_walk_has_both_branches(void) {
  static const char *const SETS[] = {"firing.every=1", "firing.angle=90deg", STOP, NULL};
  const vs_branch_parameter_words words = {"supply.frequency=50Hz..72Hz", NULL, "60Hz"};
  static const double P_MIN[] = {-6.793e-3, -6.3146e-3, -3.433e-3};
  tour *t = go(SETS, &words, 1);
  EXPECT(t->walk.end == VS_CONTINUATION_REACHED && marks(t, "at") == 3, "%d", marks(t, "at"));
  for (int n = 0; n < 3 && mark(t, "at", n); n++) {
    const vs_continuation_row *row = mark(t, "at", n);
    vs_orbit o;
    vs_error err = {0};
    CLOSE(row->at.turns.least.best.value, P_MIN[n], 5e-4);
    EXPECT((row->at.unstable > 0) == (n == 1), "%d", row->at.unstable);
    vs_status status = orbit_at(t, 60, row->at.z, &o, &err);
    EXPECT(!status && o.correction[0] < 1e-9, "%s: %g", err.text, o.correction[0]);
  }
  EXPECT(marks(t, "fold") == 2 && marks(t, "grazing") == 2 && marks(t, "flip") == 4, "%d",
         marks(t, "flip"));
  /* the armature meets the stop where it would meet the pole cover */
  CLOSE(key_of(t, "grazing", 0), 52.8229462197, CLOSE_BY);
  CLOSE(key_of(t, "grazing", 1), 58.3852965931, CLOSE_BY);
  double fold = key_of(t, "fold", 0);
  if (mark(t, "fold", 0))
    CLOSE(fold, fold_by_extrapolation(t, mark(t, "fold", 0), -0.01), CLOSE_BY);
  done(t);
}

/* The lower fold lies 4e-5 Hz beside the grazing, so near that no extrapolation has room: there are
 * orbits 1e-8 of the key above it, and none nearby as far below. */
static void a_fold_beside_its_grazing(void) {
  static const char *const SETS[] = {"firing.every=1", "firing.angle=90deg", STOP, NULL};
  const vs_branch_parameter_words words = {"supply.frequency=60Hz..57Hz", NULL, NULL};
  tour *t = go(SETS, &words, 1);
  const vs_continuation_row *row = mark(t, "fold", 0);
  double fold = key_of(t, "fold", 0), graze = key_of(t, "grazing", 0);
  vs_orbit o;
  vs_error err = {0};
  EXPECT(t->walk.end == VS_CONTINUATION_BACK && graze > fold && graze < fold + 1e-4, "%.12g, %.12g",
         fold, graze);
  if (row) {
    vs_status above = orbit_at(t, fold * (1 + 1e-8), row->at.z, &o, &err);
    double off = above ? INFINITY : fabs(o.x[0] - row->at.z[0]) / o.scale[0];
    EXPECT(!above && off < 1e-3, "%s: %g", err.text, off);
    vs_status below = orbit_at(t, fold * (1 - 1e-8), row->at.z, &o, &err);
    off = below ? INFINITY : fabs(o.x[0] - row->at.z[0]) / o.scale[0];
    EXPECT(off > 0.1, "%g", off);
  }
  done(t);
}

/* ---- flips and beats ---- */

static bool has_flipped(tour *t, double key) {
  vs_orbit o;
  vs_error err = {0};
  double product = 1;
  vs_status status = orbit_at(t, key, mark(t, "flip", 0)->at.z, &o, &err);
  EXPECT(!status, "%s", err.text);
  for (int k = 0; k < o.count; k++)
    if (o.multiplier[k].im == 0) product *= 1 + o.multiplier[k].re;
  return product < 0;
}

static bool beats(tour *t, double key) {
  vs_orbit o;
  vs_error err = {0};
  vs_status status = orbit_at(t, key, mark(t, "torus", 1)->at.z, &o, &err);
  EXPECT(!status, "%s", err.text);
  return !o.stable;
}

/* Where an orbit of period 1 flips, a branch of period 2 ends: found as a flip of the one map, and
 * as the end of the other's branch, and by bisection. */
static void a_branch_of_twice_the_period_ends_at_a_flip(void) {
  static const char *const SETS[] = {"firing.every=1", "firing.angle=60deg", "actuator.stop={}",
                                     NULL};
  const vs_branch_parameter_words all = {"supply.frequency=44Hz..57Hz", NULL, NULL},
                                  up = {"supply.frequency=48Hz..56Hz", NULL, NULL};
  tour *one = go(SETS, &all, 1), *two = go(SETS, &up, 2);
  EXPECT(marks(one, "flip") == 2 && marks(one, "torus") == 2, "%d", marks(one, "torus"));
  EXPECT(two->walk.end == VS_CONTINUATION_MERGED, "%d", two->walk.end);
  CLOSE(key_of(two, "merging", 0), key_of(one, "flip", 1), CLOSE_BY);
  if (marks(one, "flip") == 2 && marks(one, "torus") == 2) {
    CLOSE(key_of(one, "flip", 0), bisect(one, 45.6, 45.8, has_flipped), CLOSE_BY);
    CLOSE(key_of(one, "torus", 1), bisect(one, 55.9, 55.7, beats), CLOSE_BY);
  }
  done(one);
  done(two);
}

/* A long gate pulse that reaches into the next cycle fires again there: no orbit goes on beyond the
 * frequency at which the firing at 120 degrees and 8 ms make up a cycle. */
static void a_walk_ends_where_orbits_end(void) {
  static const char *const SETS[] = {"firing.every=3", "firing.angle=120deg", NULL};
  const vs_branch_parameter_words words = {"supply.frequency=75Hz..90Hz", NULL, NULL};
  tour *t = go(SETS, &words, 1);
  const vs_continuation_row *last = &t->walk.row[t->walk.count - 1];
  EXPECT(t->walk.end == VS_CONTINUATION_STUCK && *t->walk.why && !marks(t, "fold"), "%d",
         t->walk.end);
  CLOSE(last->at.z[t->walk.path.count], (2.0 / 3) / 8e-3, 1e-7);
  done(t);
  static const char *const FIRED[] = {"firing.every=1", NULL};
  const vs_branch_parameter_words longer = {"firing.pulse_width=8ms..16ms", NULL, NULL};
  t = go(FIRED, &longer, 1);
  last = &t->walk.row[t->walk.count - 1];
  EXPECT(t->walk.end == VS_CONTINUATION_STUCK && strstr(t->walk.why, "fires in another cycle"),
         "%s", t->walk.why);
  CLOSE(last->at.z[t->walk.path.count], 20 - 20 / 3.6, 1e-6);
  done(t);
}

/* A walk that has spent its budget is told up to where it came, and by that reason. */
static void a_budget_is_kept(void) {
  const char *const sets[] = {"firing.every=1", NULL};
  const vs_branch_parameter_words words = {.range = "firing.angle=130deg..100deg"};
  tour *t = vs_alloc(1, sizeof *t);
  vs_budget budget = {.what = "test", .most = {150, 1}};
  t->trial = vs_trial_read("paper", "switched", sets);
  vs_status status = vs_branch_parameter_read(&t->along, &t->trial->scene, &words, &t->trial->err);
  t->trial->scene.order.budget = &budget;
  if (!status) status = vs_continuation_go(&t->walk, &t->along, 1, NULL, &t->trial->err);
  EXPECT(!status && t->walk.end == VS_CONTINUATION_SPENT && t->walk.count > 2, "%d %d %zu %s",
         status, t->walk.end, t->walk.count, t->trial->err.text);
  EXPECT(strstr(t->walk.why, "budget of 150 cycles of the mains is spent, after "), "%s",
         t->walk.why);
  CU_ASSERT(budget.spent[VS_BUDGET_IDEAL] <= 150);
  done(t);
}

/* A signal ends the walk behind the next point, and what was found is there. */
static void a_signal_ends_a_walk(void) {
  static const char *const SETS[] = {"firing.every=1", NULL};
  const vs_branch_parameter_words words = {"firing.angle=120deg..100deg", NULL, NULL};
  const volatile sig_atomic_t stop = 1;
  tour *t = vs_alloc(1, sizeof *t);
  t->trial = vs_trial_read("paper", "switched", SETS);
  vs_status status = vs_branch_parameter_read(&t->along, &t->trial->scene, &words, &t->trial->err);
  if (!status) status = vs_continuation_go(&t->walk, &t->along, 1, &stop, &t->trial->err);
  EXPECT(!status && t->walk.end == VS_CONTINUATION_STOPPED && t->walk.count == 2, "%d %s", status,
         t->trial->err.text);
  vs_text json = {0};
  vs_branch_output_json(&t->walk, &json);
  EXPECT(strstr(json.text, "where a signal stopped it"), "%s", json.text);
  vs_text_free(&json);
  done(t);
}

/* ---- with a circuit ---- */

/* The orbit at the row's value of the key, as `steady` finds it on tier compiled: each of the two
 * is known to run.tolerance. */
static void is_as_steady_has_it(tour *t, const vs_continuation_row *row, double tolerance) {
  const vs_session session = {.stop = NULL};
  vs_measured m = {.period = false};
  vs_measured_value least = {.unit = ""};
  vs_error err = {0};
  vs_scene *own = vs_alloc(1, sizeof *own);
  vs_status status =
      vs_branch_parameter_move(&t->along, row ? row->at.z[t->walk.path.count] : NAN, &err);
  *own = *t->along.scene;
  if (!status) status = vs_measured_run(&m, own, 1, &session, &err);
  EXPECT(row && !status && vs_measured_at(&m, vs_measured_find(&m, "p_min"), &least), "%s",
         err.text);
  if (row && !status) {
    const vs_multiplier *a = row->at.multiplier, *b = m.steady.orbit.multiplier;
    CLOSE(row->at.turns.least.best.value, least.value.value, tolerance);
    for (int k = 0; k < 2; k++)
      CLOSE_OF(hypot(a[k].re, a[k].im), hypot(b[k].re, b[k].im), 1, tolerance);
  }
  vs_measured_free(&m);
  free(own);
}

/* The row's multipliers by central differences of periods along one run's steps, without the
 * monodromy matrix; returns how many of them are within `near` of 1. Each state is moved by 1e-5 of
 * its size, so that their error is some 1e-9; the row's are of the run before the last correction,
 * of 1e-7 of the motion. */
static int multipliers_by_differences(tour *t, const vs_continuation_row *row, double near) {
  enum { N = VS_FLIGHT_STATES };
  const int n = t->walk.path.count;
  double x[N], end[2][N], matrix[N * N];
  vs_multiplier of[N];
  vs_error err = {0};
  vs_poincare_map f;
  int count = 0;
  vs_status status = vs_branch_parameter_move(&t->along, row->at.z[n], &err);
  vs_poincare_map_begin(&f, t->along.scene);
  f.states = n;
  for (int j = -1; j < n && !status; j++)
    for (int side = 0; side < (j < 0 ? 1 : 2) && !status; side++) {
      const double push = j < 0 ? 0 : 1e-5 * row->at.size[j];
      memcpy(x, row->at.z, sizeof x);
      if (j >= 0) x[j] += side ? -push : push;
      status = vs_circuit_flight_go(&t->walk.path.circuit, &f, x, 1, j >= 0, false, &err);
      memcpy(end[side], f.end, sizeof f.end);
      for (int i = 0; i < n && side; i++)
        matrix[i * n + j] =
            (end[0][i] - end[1][i]) / (2 * push) * row->at.size[j] / row->at.size[i];
    }
  vs_poincare_map_end(&f);
  EXPECT(!status && vs_multipliers_of(n, matrix, of), "%s", err.text);
  for (int k = 0; k < n && !status; k++) {
    const vs_multiplier *m = &row->at.multiplier[k];
    EXPECT(hypot(m->re - of[k].re, m->im - of[k].im) < 1e-5, "%d: %.9g %.9g, not %.9g %.9g", k,
           m->re, m->im, of[k].re, of[k].im);
    count += hypot(of[k].re - 1, of[k].im) < near;
  }
  return count;
}

/* A branch over a resistor of the deck, and one over a key of the scene, with the snubbers there.
 */
static void with_snubbers(void) {
  static const char *const SETS[] = {"circuit.deck=halfwave_snubbed", "firing.every=1",
                                     "firing.angle=110deg", "run.tolerance=1e-5", NULL};
  const vs_branch_parameter_words words[] = {{"circuit.r1=50ohm..200ohm", "75ohm", NULL},
                                             {"firing.angle=110deg..107deg", "1.5deg", NULL}};
  for (size_t k = 0; k < COUNT(words); k++) {
    tour *t = go_on("compiled", SETS, &words[k], 1);
    EXPECT(t->walk.end == VS_CONTINUATION_REACHED && t->walk.path.count > 8, "%d", t->walk.end);
    is_as_steady_has_it(t, &t->walk.row[t->walk.count / 2], 1e-5);
    is_as_steady_has_it(t, &t->walk.row[t->walk.count - 1], 1e-5);
    if (!k) multipliers_by_differences(t, &t->walk.row[t->walk.count / 2], 0);
    done(t);
  }
}

/* A capacitor in series with the coil: as the armature is drawn nearer, the two come to resonate,
 * and the branch over the capacitance turns back twice. No tier without a circuit has that. On a
 * fold a multiplier is 1; it goes with the root of the key's distance, which is known to 1e-7. */
static void folds_over_a_capacitance(void) {
  static const char *const SETS[] = {"circuit.deck=series.cir", "supply.voltage=90V",
                                     "run.tolerance=1e-5", "firing.every=1", NULL};
  const vs_branch_parameter_words words = {"circuit.c1=4.4uF..5uF", "0.1uF", "4.8uF"};
  write_file("series.cir", "*$ title series capacitor\n"
                           "*$ param c1 = 5 uF 1e-6..1e6\n"
                           "*$ port mains = Vmains\n"
                           "*$ line a\n"
                           "Vmains a 0 external\n"
                           "R1 a b 1\n"
                           "C1 b c {c1} ic=0\n"
                           "Xeva c 0 eva\n");
  tour *t = go_on("compiled", SETS, &words, 1);
  EXPECT(t->walk.end == VS_CONTINUATION_REACHED && marks(t, "fold") == 2 && marks(t, "at") == 3,
         "%d %d %d: %s", t->walk.end, marks(t, "fold"), marks(t, "at"), t->walk.why);
  is_as_steady_has_it(t, mark(t, "at", 0), 1e-5);
  for (int k = 0; k < 2; k++) {
    const vs_continuation_row *fold = mark(t, "fold", k);
    if (!fold) continue;
    const double key = fold->at.z[t->walk.path.count], side = k ? 1 : -1;
    for (int to = -1; to <= 1; to += 2)
      EXPECT((neighbour(fold, to)->at.z[t->walk.path.count] - key) * side > 0, "%d: %g", k, key);
    EXPECT(multipliers_by_differences(t, fold, 1e-2) == 1, "%d: %g", k, key);
  }
  done(t);
}

/* ---- the program ---- */

static void files_and_tables(void) {
  ran r =
      run("steady paper --set firing.every=1 --along firing.angle=90deg..75deg --at 80deg -o b");
  EXPECT(!r.status && strstr(r.out, "pole_cover +- ") &&
             strstr(r.out, "leaves the range at 75 deg"),
         "%s%s", r.out, r.err);
  free_ran(&r);
  char *csv = read_file("b/branch.csv"), *json = read_file("b/branch.json");
  EXPECT(!strncmp(csv, "firing.angle_deg,p_min_m,p_max_m,u_min_m,", 41), "%.60s", csv);
  EXPECT(strstr(csv, ",stable,pole_cover,,\n") && strstr(csv, ",stable,iron,,\n"), "%s", csv);
  EXPECT(strstr(json, "\"program\": {\"version\": \"") && strstr(json, "\"end\": \"reached\"") &&
             strstr(json, "{\"kind\": \"at\", \"key\": 80, "),
         "%s", json);
  free(csv);
  free(json);
  r = run("steady paper --set firing.every=1 --along firing.angle=70deg..50deg --json -o b");
  EXPECT(r.status == 1 && strstr(r.err, "cannot be followed beyond firing.angle = 57.9") &&
             strstr(r.out, "\"end\": \"stuck\""),
         "%d: %s", r.status, r.err);
  free_ran(&r);
}

static void what_is_refused(void) {
  static const struct {
    const char *words, *says[2];
  } ROWS[] = {
      {"--along firing.angle", {"KEY=FROM..TO", NULL}},
      {"--along firing.angel=90deg..80deg", {"did you mean 'firing.angle'?", NULL}},
      {"--along firing.valve=none..thyristor", {"has words for values", NULL}},
      {"--along firing.every=1..2", {"whole numbers", NULL}},
      {"--along machine.base_com=1mm..2mm", {"a pair", NULL}},
      {"--along firing.angle=90deg..90deg", {"ends where it begins", NULL}},
      {"--along firing.angle=90..80deg", {"90 has no unit", NULL}},
      {"--along firing.angle=90deg..190deg", {"190deg is out of range", "0..180 deg"}},
      {"--along run.tolerance=1e-4..1e-5", {"no orbit depends on it", NULL}},
      {"--along circuit.r1=100ohm..80ohm", {"circuit.r1", NULL}},
      {"--along firing.angle=90deg..80deg --step 0deg", {"--step 0deg", "more than 0"}},
      {"--along firing.angle=90deg..80deg --at 100deg", {"--at 100deg", "in the range"}},
      {"--along firing.angle=90deg..80deg --period 2", {"repeats after 1", "--period 1"}},
      {"--along firing.angle=90deg..80deg --set firing.every=once", {"not 'once'", NULL}},
      {"--along firing.angle=90deg..80deg --tier circuit", {"run.tier: compiled", NULL}},
      {"--along firing.angle=90deg..80deg --tier analytic", {"run.tier: switched", NULL}},
      {"--step 1deg", {"--step: it goes with --along", NULL}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("steady paper --set firing.every=1 %s -o none", ROWS[k].words);
    bool one_line = count_lines(r.err) == 1;
    EXPECT(r.status == (strstr(ROWS[k].words, "--period") ? 1 : 2) && one_line &&
               strstr(r.err, ROWS[k].says[0]) &&
               (!ROWS[k].says[1] || strstr(r.err, ROWS[k].says[1])),
           "%s: %d %s", ROWS[k].words, r.status, r.err);
    free_ran(&r);
  }
}

/* The text between two marks, which must be there; free() it. */
static char *between(const char *text, const char *begin, const char *end) {
  const char *from = strstr(text, begin), *to = from ? strstr(from + strlen(begin), end) : NULL;
  EXPECT(to, "%s", begin);
  if (!to) return vs_copy("");
  char *part = vs_copy(from);
  part[to - from] = '\0';
  return part;
}

/* Is there a line with the same key, least travel and mark, to 1e-6? */
static bool is_printed(const char *line, const char *printed) {
  double key, least, other_key, other_least;
  if (sscanf(line, "%lf %lf", &key, &least) != 2) return false;
  const char *kind = strstr(line, "+-");
  while (kind && kind > line && kind[-2] != ' ') kind--;
  for (const char *at = printed; at && *at; at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL) {
    if (sscanf(at, "%lf %lf", &other_key, &other_least) != 2) continue;
    const char *end = strchr(at, '\n'), *found = strstr(at, "+-");
    if (!found || !end || found > end || fabs(other_key - key) > 1e-6 * key) continue;
    while (found > at && found[-2] != ' ') found--;
    if (fabs(other_least - least) <= 1e-6 * fabs(least) &&
        !strncmp(found, kind, strcspn(kind, "+")))
      return true;
  }
  return false;
}

/* The example of docs/operation.md prints the marks that the page shows. */
static void the_page(void) {
  char *page = read_file(VS_TEST_FOLDER "/../docs/operation.md");
  char *scene = between(page, "# jump.yaml", "\n```");
  char *rest = between(page, "vibrospice steady jump.yaml", "![");
  char *line = between(rest, "vibrospice steady", "\n"),
       *text = between(rest, "```text\n", "\n```");
  int lines = 0;
  write_file("jump.yaml", scene);
  ran r = run("%s", line + strlen("vibrospice "));
  EXPECT(!r.status, "%s%s", r.out, r.err);
  char *left = strchr(text, '\n'), *one;
  while ((one = strsep(&left, "\n"))) {
    if (!*one) continue;
    lines++;
    EXPECT(is_printed(one, r.out), "not printed: %s", one);
  }
  EXPECT(lines >= 7, "%d", lines);
  EXPECT_FILES("jump", on_path("gnuplot") ? "branch.csv branch.json branch.png "
                                          : "branch.csv branch.json ");
  free_ran(&r);
  free(text), free(line), free(rest), free(scene), free(page);
}

/* Before a value at which the mass is singular a walk ends, and says what is behind it. */
static void before_a_singular_mass(void) {
  write_file("pair.yaml", "title: pair\n"
                          "coordinates: {p: {unit: m, text: travel}, r: {unit: rad, text: turn}}\n"
                          "parameters:\n"
                          "  s: {default: 0.05 kg.m, range: 0 kg.m .., text: coupling}\n"
                          "mass: [[1 kg, s], [s, 0.01 kg.m2]]\n"
                          "damping: [[20 N.s/m, 0], [0, 0.1 N.m.s/rad]]\n"
                          "stiffness: [[1e5 N/m, 0], [0, 500 N.m/rad]]\n"
                          "gap: {along: {p: 1}}\n"
                          "actuator: {gap: 5 mm, pole_cover: 0.5 mm, inductance: 0.46 H, "
                          "resistance: 12 ohm}\n");
  write_file("pair_scene.yaml", "machine: {model: pair.yaml}\nsupply: {voltage: 100 V}\n"
                                "firing: {every: 1, angle: 120 deg}\n");
  ran r = run("steady pair_scene.yaml --tier switched --along machine.s=0.09kg.m..0.11kg.m");
  const char *at = strstr(r.err, "cannot be followed beyond machine.s = ");
  EXPECT(r.status == 1 && at && strstr(at, "behind it the scene is refused: pair.yaml:") &&
             strstr(at, "mass is not positive definite"),
         "%d: %s", r.status, r.err);
  double key = at ? strtod(strchr(at, '=') + 1, NULL) : NAN;
  EXPECT(key < 0.1 && key > 0.1 - 2e-5, "it ends at %.9g", key); /* a thousandth of the range */
  EXPECT(strstr(r.out, "cannot be followed beyond") != NULL, "%s", r.out);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"the pole cover is touched", the_pole_cover_is_touched},
    {"the bound moves", the_bound_moves},
    {"one walk has both branches", one_walk_has_both_branches},
    {"a fold beside its grazing", a_fold_beside_its_grazing},
    {"a branch of twice the period ends at a flip", a_branch_of_twice_the_period_ends_at_a_flip},
    {"a walk ends where orbits end", a_walk_ends_where_orbits_end},
    {"before a singular mass", before_a_singular_mass},
    {"with snubbers", with_snubbers},
    {"folds over a capacitance", folds_over_a_capacitance},
    {"a budget is kept", a_budget_is_kept},
    {"a signal ends a walk", a_signal_ends_a_walk},
    {"files and tables", files_and_tables},
    {"the page", the_page},
    {"what is refused", what_is_refused},
};

int main(void) {
  return program_suite("branches", TESTS, COUNT(TESTS));
}
