/* SPDX-License-Identifier: GPL-3.0-or-later
 * Periodic orbits by shooting: the derivatives of a run against differences of runs, the published
 * numbers, how fast the iteration converges, and what is refused. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "orbit/shooting.h"
#include "orbit/variation.h"
#include "plant/coil.h"
#include "suite.h"

enum { MOST = VS_VARIATION_MOST };
#define STOP "actuator.stop={stiffness: 1e6 N/m, damping: 50 N.s/m}"

/* ---- the derivatives of a run ----
 *
 * Rows that end in no clipped stop agree to 1e-10 and better. There the run itself, whose steps go
 * over the kinks of the clipped force, is known to some 1e-11 only, which a difference over 1e-3 of
 * the motion shows as some 1e-8. */

/* What one run is looked at by. */
typedef struct looker {
  vs_variation *variation; /* NULL: only the end is wanted */
  double end[MOST], size[MOST];
  int met, left, fired, out; /* how often */
} looker;

static vs_status look(void *ctx, const vs_step *step, const vs_result *result, vs_error *err) {
  looker *l = ctx;
  int dof = step->frame->model->dof;
  (void)result;
  memcpy(l->end, step->to->x, 2 * (size_t)dof * sizeof *l->end);
  l->end[2 * dof] = step->to->flux_wb;
  for (int i = 0; i <= 2 * dof; i++) l->size[i] = fmax(l->size[i], fabs(l->end[i]));
  l->met += step->event[0] == VS_EV_MEETS_STOP;
  l->left += step->event[0] == VS_EV_LEAVES_STOP;
  l->fired += step->event[0] == VS_EV_FIRES;
  l->out += step->event[0] == VS_EV_EXTINCT;
  return l->variation ? vs_variation_accept(l->variation, step, err) : VS_OK;
}

/* Runs the setup on the scene's tier. */
static void go(const vs_scene *s, const vs_setup *setup, looker *l) {
  vs_scene *other = vs_alloc(1, sizeof *other);
  vs_result *r = vs_alloc(1, sizeof *r);
  vs_error err = {0};
  const vs_session_listener guest = {.ctx = l, .accept = look};
  const vs_session session = {.guest = &guest, .bare = true, .unguarded = true};
  *other = *s;
  other->setup = *setup;
  other->frame = vs_sim_frame(s->tier, &other->setup);
  if (l->variation) vs_variation_begin(l->variation, setup);
  vs_status status = vs_session_run(&session, other, r, &err);
  EXPECT(!status, "%s", err.text);
  free(r);
  free(other);
}

/* One column of the derivative by central differences over a step and over half of it, extrapolated
 * (Richardson). */
static void difference(const vs_scene *s, const vs_setup *setup, int j, double step,
                       double column[MOST]) {
  int dof = s->setup.model.dof;
  double quotient[2][MOST];
  for (int fine = 0; fine < 2; fine++) {
    double by = fine ? step / 2 : step;
    looker l[2] = {{0}};
    for (int up = 0; up < 2; up++) {
      vs_setup moved = *setup;
      double *x = j < 2 * dof ? &moved.start.x[j] : &moved.start.flux_wb;
      /* lambda stays, where x moves the gap at which the coil has none without a current */
      const vs_model *m = &moved.model;
      double idle = vs_coil_idle_flux(&m->coil, vs_mechanics_gap(m, moved.start.x));
      *x += up ? by : -by;
      moved.start.flux_wb += idle - vs_coil_idle_flux(&m->coil, vs_mechanics_gap(m, moved.start.x));
      if (j == 2 * dof) moved.start.flux_wb = *x;
      go(s, &moved, &l[up]);
    }
    for (int i = 0; i <= 2 * dof; i++) quotient[fine][i] = (l[1].end[i] - l[0].end[i]) / (2 * by);
  }
  for (int i = 0; i <= 2 * dof; i++) column[i] = (4 * quotient[1][i] - quotient[0][i]) / 3;
}

/* Returns the largest difference between the two, in parts of each state's scale, relative to the
 * largest entry. part: the differences' step, in parts of the scale. */
static double worst(const vs_scene *s, const vs_setup *setup, double part, looker *seen) {
  vs_variation variation;
  looker l = {.variation = &variation};
  int states = 2 * s->setup.model.dof;
  double off = 0, largest = 0, column[MOST] = {0};
  go(s, setup, &l);
  for (int j = 0; j < variation.columns; j++) {
    difference(s, setup, j, part * l.size[j], column);
    for (int i = 0; i < variation.columns; i++) {
      double own = vs_variation_get(&variation, i, j), unit = l.size[j] / l.size[i];
      off = fmax(off, fabs(own - column[i]) * unit);
      largest = fmax(largest, fabs(own) * unit);
    }
  }
  EXPECT(variation.columns == states || l.fired == 0, "%d columns", variation.columns);
  vs_variation_end(&variation);
  *seen = l;
  return off / largest;
}

typedef struct derived {
  const char *scene;
  double until_s, part;
  bool contact, firing;
  const char *sets[6];
} derived;

static void derivatives_are_those_of_runs(void) {
  static const derived ROWS[] = {
      {"paper", 0.02, 1e-3, false, true, {"firing.every=1", NULL}},
      {"paper", 0.05, 1e-3, false, true, {"firing.every=1", "firing.angle=80deg", NULL}},
      {"paper",
       0.02,
       1e-4,
       true,
       true,
       {"firing.every=1", "firing.angle=90deg", STOP, "start.vp=-4 m/s", NULL}},
      {"paper",
       0.02,
       1e-3,
       true,
       true,
       {"firing.every=1", "start.vp=-4 m/s",
        "actuator.stop={kind: quadratic_clipped, stiffness: "
        "1e10 N/m2, damping: 50 N.s/m}",
        NULL}},
      {"paper",
       0.02,
       1e-3,
       false,
       true,
       {"firing.every=1",
        "actuator.saturation={law: series, flux: 1.2 Wb, exponent: 7, current: "
        "0.2 A}",
        NULL}},
      {"paper",
       0.02,
       1e-3,
       false,
       true,
       {"firing.every=1",
        "actuator.saturation={law: series, flux: 1.2 Wb, exponent: 7, current: "
        "0.2 A}",
        "actuator.leakage=0.15H", NULL}},
      {"two_mass", 0.02, 1e-3, false, true, {"firing.every=1", "firing.angle=130deg", NULL}},
      {"fixed_base", 0.02, 1e-3, false, true, {"firing.every=1", "firing.angle=150deg", NULL}},
      {"lds_v203", 0.01, 1e-3, false, false, {"supply.kind=sine", "supply.frequency=20Hz", NULL}},
      {"solenoid", 0.0122, 1e-4, false, false, {NULL}},
      {"solenoid", 0.014, 1e-3, true, false, {NULL}},
      {"solenoid",
       0.014,
       1e-5,
       true,
       false,
       {"actuator.stop={kind: linear, stiffness: 1e6 N/m, damping: 200 N.s/m, at: 0.25 mm}", NULL}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const derived *row = &ROWS[k];
    looker seen;
    vs_trial *t = vs_trial_read(row->scene, "switched", row->sets);
    EXPECT(!t->status, "%zu: %s", k, t->err.text);
    if (!t->status) {
      vs_run_values run = t->scene.setup.run;
      run.until_s = row->until_s;
      run.tolerance = t->scene.tier->finest;
      const vs_setup setup = vs_setup_varied(&t->scene.setup, &run, NULL);
      double off = worst(&t->scene, &setup, row->part, &seen);
      EXPECT(off < 1e-7, "%zu, %s: off by %.3g", k, row->scene, off);
      EXPECT((seen.met > 0) == row->contact && (seen.out > 0) == row->firing, "%zu: %d %d", k,
             seen.met, seen.out);
    }
    vs_trial_free(t);
  }
}

/* ---- orbits ---- */

/* Looks for the orbit, which must be there. Free the trial. */
static vs_trial *find(const char *scene, int periods, const char *const *sets, vs_orbit *orbit) {
  vs_trial *t = vs_trial_read(scene, "switched", sets);
  EXPECT(!t->status, "%s", t->err.text);
  if (!t->status) t->status = vs_shooting_find(&t->scene, periods, orbit, &t->err);
  EXPECT(!t->status, "%s", t->err.text);
  return t;
}

static double size_of(vs_multiplier m) {
  return hypot(m.re, m.im);
}

/* Runs the scene over one period of the orbit, with all its watchers. Free the result. */
static vs_result *over_a_period(const vs_trial *t, const vs_orbit *orbit, vs_scene *scene) {
  vs_result *r = vs_alloc(1, sizeof *r);
  vs_error err = {0};
  const vs_session session = {.unguarded = true}; /* the stop at 60 Hz gives way */
  vs_run_values run = t->scene.setup.run;
  run.until_s = orbit->period_s;
  *scene = t->scene;
  scene->setup = vs_shooting_setup(&t->scene, &run, orbit);
  scene->frame = vs_sim_frame(scene->tier, &scene->setup);
  vs_status status = vs_session_run(&session, scene, r, &err);
  EXPECT(!status, "%s", err.text);
  return r;
}

typedef struct known {
  const char *scene, *sets[4];
  double gap_min_m, power_w, i_rms_a, multiplier[2]; /* 0: not known; of pairs, their sizes */
} known;

/* machines.md, sections 3, 4 and 6, to the digits given there. run.tolerance is 1e-10, and what is
 * asked 1e-9. */
static void orbits_have_the_published_numbers(void) {
  static const known ROWS[] = {
      {"paper",
       {"firing.every=1", "run.tolerance=1e-10", NULL},
       -0.0021377328283,
       8.49145448715,
       0.294464118668,
       {0}},
      {"fixed_base",
       {"firing.every=1", "firing.angle=150deg", "run.tolerance=1e-10", NULL},
       -0.00012196812378,
       0.1870901158,
       0.04488328667,
       {0.971444741, 0}},
      {"two_mass",
       {"firing.every=1", "firing.angle=130deg", "run.tolerance=1e-10", NULL},
       -0.00035404968735,
       0.8464749564,
       0.2427242011,
       {0.987740250, 0.939078381}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const known *row = &ROWS[k];
    vs_orbit o;
    vs_scene *scene = vs_alloc(1, sizeof *scene);
    vs_trial *t = find(row->scene, 1, row->sets, &o);
    vs_result *r = over_a_period(t, &o, scene);
    const double *joule = r->watchers.energy.joule;
    double copper_w = joule[VS_E_COPPER] / o.period_s;
    CLOSE(r->values[VS_M_GAP_MIN].value, row->gap_min_m, 1e-9);
    CLOSE(joule[VS_E_SOURCE] / o.period_s, row->power_w, 1e-9);
    CLOSE(sqrt(copper_w / t->scene.setup.model.actuator.resistance_ohm), row->i_rms_a, 1e-9);
    for (int n = 0; n < 2 && row->multiplier[n] > 0; n++) {
      CLOSE(size_of(o.multiplier[2 * n]), row->multiplier[n], 1e-9);
      CLOSE(size_of(o.multiplier[2 * n + 1]), row->multiplier[n], 1e-9);
    }
    EXPECT(o.stable && o.n == 1 && o.count == 2 * t->scene.setup.model.dof, "%d", o.n);
    vs_result_free(r);
    free(r);
    free(scene);
    vs_trial_free(t);
  }
}

/* Without a stop in reach six iterations are enough, each of which squares the last correction but
 * for a factor of order 1. */
static void corrections_are_squared(void) {
  static const char *const ANGLES[] = {"80deg", "90deg", "100deg", "120deg", "150deg", "175deg"};
  static const char *const FREQUENCIES[] = {"45Hz", "50Hz", "52.8Hz", "58.4Hz", "65Hz"};
  for (size_t k = 0; k < COUNT(ANGLES) * COUNT(FREQUENCIES); k++) {
    char angle[64], frequency[64];
    vs_orbit o;
    snprintf(angle, sizeof angle, "firing.angle=%s", ANGLES[k % COUNT(ANGLES)]);
    snprintf(frequency, sizeof frequency, "supply.frequency=%s", FREQUENCIES[k / COUNT(ANGLES)]);
    const char *sets[] = {"firing.every=1", angle, frequency, NULL};
    vs_trial *t = vs_trial_read("paper", "switched", sets);
    const vs_shooting how = {.periods = 1, .unguarded = true};
    t->status = vs_shooting_seek(&t->scene, &how, &o, &t->err);
    EXPECT(!t->status, "%s, %s: %s", angle, frequency, t->err.text);
    EXPECT(o.iterations <= 6 && o.residual <= 1e-12, "%s, %s: %d iterations to %.2g", angle,
           frequency, o.iterations, o.residual);
    for (int n = 0; n + 1 < o.iterations; n++) {
      double last = o.correction[n], next = o.correction[n + 1];
      EXPECT(last > 0.1 || next <= fmax(last * last, 1e-12), "%s, %s: %.3g after %.3g", angle,
             frequency, next, last);
    }
    vs_trial_free(t);
  }
}

/* A coil without a valve has its flux linkage for a state: the linear shaker's orbit is there after
 * one iteration from anywhere, and its amplitude is the published one (machines.md, section 2). */
static void a_coil_without_a_valve_has_an_orbit(void) {
  static const char *const SETS[] = {"supply.kind=sine", "supply.frequency=20Hz",
                                     "supply.voltage=0.70710678118654752440 V", NULL};
  vs_orbit o;
  vs_trial *t = find("lds_v203", 1, SETS, &o);
  double angle = -41.8256602464 * M_PI / 180, rate = 48.1743397536 * M_PI / 180;
  EXPECT(o.count == 3 && o.iterations <= 2, "%d states, %d iterations", o.count, o.iterations);
  CLOSE_OF(o.x[0], 0.000741108559377 * sin(angle), 0.000741108559377, 1e-9);
  CLOSE_OF(o.x[1], 0.0931304482261 * sin(rate), 0.0931304482261, 1e-9);
  vs_trial_free(t);
}

/* ---- periods ---- */

/* How far the state is from x after so many periods, in parts of each state's scale. */
static double way_back(const vs_trial *t, const vs_orbit *o, int periods) {
  looker l = {.variation = NULL};
  double off = 0;
  vs_run_values run = t->scene.setup.run;
  run.until_s = periods * o->period_s / o->n;
  run.tolerance = t->scene.tier->finest;
  const vs_setup setup = vs_shooting_setup(&t->scene, &run, o);
  go(&t->scene, &setup, &l);
  for (int j = 0; j < o->count; j++) off = fmax(off, fabs(l.end[j] - o->x[j]) / o->scale[j]);
  return off;
}

/* With a stop there are orbits of period 2 and 3, beside which that of period 1 is unstable. */
static void periods_are_told_apart(void) {
  static const struct {
    const char *angle, *frequency;
    int n;
  } ROWS[] = {{"firing.angle=60deg", "supply.frequency=48Hz", 2},
              {"firing.angle=70deg", "supply.frequency=52Hz", 3}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const char *sets[] = {"firing.every=1", ROWS[k].angle, ROWS[k].frequency, STOP, NULL};
    vs_orbit o, single;
    vs_trial *t = find("paper", ROWS[k].n, sets, &o);
    EXPECT(o.n == ROWS[k].n && o.stable && o.residual <= 1e-12, "%d", o.n);
    EXPECT(way_back(t, &o, o.n) < 1e-10, "%g", way_back(t, &o, o.n));
    for (int n = 1; n < o.n; n++) EXPECT(way_back(t, &o, n) > 1e-2, "%g", way_back(t, &o, n));
    const vs_shooting how = {.periods = 1, .quietly = true};
    vs_status status = vs_shooting_seek(&t->scene, &how, &single, &t->err);
    EXPECT(!status && single.n == 1 && !single.stable, "%s", t->err.text);
    EXPECT(way_back(t, &single, 1) < 1e-10, "%g", way_back(t, &single, 1));
    status = vs_shooting_find(&t->scene, 1, &single, &t->err);
    EXPECT(status == VS_RUN && strstr(t->err.text, "a subharmonic of period"), "%s", t->err.text);
    vs_trial_free(t);
  }
}

/* The two orbits that live side by side at 60 Hz: the start decides (validation.md, section 2). */
static void the_start_decides(void) {
  static const double P_MIN[] = {-3.433e-3, -6.793e-3};
  for (int kicked = 0; kicked < 2; kicked++) {
    const char *sets[] = {"firing.every=1",
                          "firing.angle=90deg",
                          "supply.frequency=60Hz",
                          STOP,
                          kicked ? "start.vp=-1 m/s" : NULL,
                          NULL};
    vs_orbit o;
    vs_scene *scene = vs_alloc(1, sizeof *scene);
    vs_trial *t = find("paper", 1, sets, &o);
    vs_result *r = over_a_period(t, &o, scene);
    CLOSE(r->values[VS_M_GAP_MIN].value, P_MIN[kicked], 5e-4);
    vs_result_free(r);
    free(r);
    free(scene);
    vs_trial_free(t);
  }
}

/* t = 0 is the mains' rise through zero, whatever phase and first cycle the scene has. */
static void phase_and_first_cycle_do_not_matter(void) {
  static const char *const PLAIN[] = {"firing.every=2", NULL};
  static const char *const SHIFTED[] = {"firing.every=2", "supply.phase=70deg",
                                        "firing.first_cycle=4", NULL};
  vs_orbit a, b;
  vs_trial *one = find("paper", 1, PLAIN, &a), *other = find("paper", 1, SHIFTED, &b);
  for (int j = 0; j < a.count; j++) CLOSE_OF(b.x[j], a.x[j], a.scale[j], 1e-11);
  vs_trial_free(one);
  vs_trial_free(other);
}

/* ---- bad input ---- */

static void what_is_refused(void) {
  static const struct {
    const char *scene, *tier;
    int periods;
    vs_status status;
    const char *why, *sets[4];
  } ROWS[] = {
      {"paper", "switched", 1, VS_INPUT, "firing.every", {NULL}},
      {"paper", "switched", 0, VS_INPUT, "allowed: 1 and more", {"firing.every=1", NULL}},
      {"paper", "switched", 2, VS_RUN, "repeats after 1 already", {"firing.every=1", NULL}},
      {"paper", "circuit", 1, VS_INPUT, "tier circuit", {"firing.every=1", NULL}},
      {"solenoid", "switched", 1, VS_INPUT, "has no period", {NULL}},
      {"paper",
       "switched",
       1,
       VS_INPUT,
       "events.dip: a periodic orbit has no events",
       {"firing.every=1", "events.dip={kind: sag, at: 20 ms}", NULL}},
      {"paper",
       "switched",
       1,
       VS_RUN,
       "goes beyond the pole cover: p = -6.0",
       {"firing.every=1", "firing.angle=78.9deg", NULL}},
      {"paper",
       "switched",
       1,
       VS_RUN,
       "from the start the armature goes beyond the pole cover",
       {"firing.every=1", "firing.angle=30deg", NULL}},
      {"two_mass",
       "switched",
       1,
       VS_RUN,
       "goes beyond the pole cover: travel = -6.2",
       {"firing.every=1", "firing.angle=90deg", NULL}},
      {"two_mass",
       "switched",
       1,
       VS_RUN,
       "(travel = -D = -2 mm)",
       {"firing.every=1", "firing.angle=60deg", NULL}},
      {"paper",
       "switched",
       3,
       VS_RUN,
       "none is found, and the machine runs on one of period 2",
       {"firing.every=1", "firing.angle=60deg", "supply.frequency=48Hz", STOP}},
      {"paper",
       "switched",
       1,
       VS_RUN,
       "no periodic orbit is found: after 20 iterations",
       {"firing.every=1", "firing.angle=90deg", "supply.frequency=53Hz", "actuator.stop={}"}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const char *sets[5] = {NULL};
    memcpy(sets, ROWS[k].sets, sizeof ROWS[k].sets);
    vs_orbit o;
    vs_trial *t = vs_trial_read(ROWS[k].scene, ROWS[k].tier, sets);
    EXPECT(!t->status, "%s", t->err.text);
    vs_status status = vs_shooting_find(&t->scene, ROWS[k].periods, &o, &t->err);
    EXPECT(status == ROWS[k].status && strstr(t->err.text, ROWS[k].why), "%zu: %d %s", k, status,
           t->err.text);
    vs_trial_free(t);
  }
}

/* A search takes no more cycles than its order's budget has, and says which it was. One that ends
 * well takes the same ones as without a budget, and finds the same. */
static void a_budget_is_kept(void) {
  const char *sets[] = {"firing.every=2", "firing.angle=130deg", NULL};
  vs_orbit o, same;
  vs_trial *t = find("paper", 1, sets, &o);
  vs_budget budget = {.what = "test", .most = {100000, 1}};
  t->scene.order.budget = &budget;
  CU_ASSERT(!vs_shooting_find(&t->scene, 1, &same, &t->err));
  CU_ASSERT(!memcmp(o.x, same.x, sizeof o.x));
  EXPECT(budget.spent[VS_BUDGET_IDEAL] == 2 * (30 + same.iterations) && !budget.out[0], "%ld",
         budget.spent[VS_BUDGET_IDEAL]);
  budget = (vs_budget){.what = "test", .most = {65, 1}};
  vs_status status = vs_shooting_find(&t->scene, 1, &same, &t->err);
  EXPECT(status == VS_BUDGET && strstr(t->err.text, "budget of 65 cycles"), "%s", t->err.text);
  CU_ASSERT(budget.out[VS_BUDGET_IDEAL] && budget.spent[VS_BUDGET_IDEAL] <= 65);
  vs_trial_free(t);
}

static const vs_test TESTS[] = {
    {"derivatives are those of runs", derivatives_are_those_of_runs},
    {"orbits have the published numbers", orbits_have_the_published_numbers},
    {"corrections are squared", corrections_are_squared},
    {"a coil without a valve has an orbit", a_coil_without_a_valve_has_an_orbit},
    {"periods are told apart", periods_are_told_apart},
    {"the start decides", the_start_decides},
    {"phase and first cycle do not matter", phase_and_first_cycle_do_not_matter},
    {"what is refused", what_is_refused},
    {"a budget is kept", a_budget_is_kept},
};
VS_SUITE_MAIN("shooting", TESTS)
