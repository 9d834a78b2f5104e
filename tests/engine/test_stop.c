/* SPDX-License-Identifier: GPL-3.0-or-later
 * The elastic stop at p = -D: F = k delta + c delta' while delta = -D - p > 0. */
#include <math.h>
#include <string.h>

#include "plant/coil.h"
#include "engine/gate.h"
#include "suite.h"

/* Fired in every cycle at 80 degrees, the start-up transient strikes the stop after 50 ms. */
#define STRIKE(until)                                                                              \
  "firing.angle=80deg", "firing.every=1",                                                          \
      "actuator.stop={stiffness: 2e7 N/m, damping: 500 N.s/m}", until

/* First contacts, and how deep. */
typedef struct impacts {
  double meets_s[8], leaves_s[8];
  int met, left;
} impacts;

static vs_status note(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  impacts *m = ctx;
  for (int k = 0; k < 2; k++) {
    if (step->event[k] == VS_EV_MEETS_STOP && m->met < 8) m->meets_s[m->met++] = step->event_s[k];
    if (step->event[k] == VS_EV_LEAVES_STOP && m->left < 8)
      m->leaves_s[m->left++] = step->event_s[k];
  }
  return VS_OK;
}

/* The same equations by the classical Runge-Kutta rule in steps of half a microsecond, thyristor
 * and stop switched at the step after the fact: a reference with no event location, no dense
 * output, no propagator. */
typedef struct plain {
  double meets_s, leaves_s, deepest_m;
} plain;

static void plain_rates(const vs_setup *s, double t, const double y[9], bool on, double rate[9]) {
  const vs_model *m = &s->model;
  double depth = -m->actuator.gap_m - y[P];
  double stop = depth > 0 ? 2e7 * depth - 500 * y[VS_DOF + P] : 0; /* pushes p up */
  double current = y[8] * (m->coil.gap_rest_m + y[P]) / (2 * m->coil.a_hm);
  double a[VS_MOST_DOF];
  vs_mechanics_accelerations(m, y, y + VS_DOF, y[8] * y[8] / (4 * m->coil.a_hm) - stop, a);
  memcpy(rate + 4, a, sizeof(double[4]));
  for (int i = 0; i < 4; i++) rate[i] = y[4 + i];
  rate[8] = on ? vs_timeline_voltage(&s->timeline, t) - m->actuator.resistance_ohm * current : 0;
}

static plain march(const vs_setup *s, double until) {
  const double h = 5e-7;
  double y[9] = {0}, k[4][9], z[9];
  plain out = {NAN, NAN, 0};
  bool on = false;
  for (int n = 0; n * h < until; n++) {
    double t = n * h, before = y[P];
    if (!on && vs_gate_is_on(&s->timeline, 0, t) && vs_timeline_voltage(&s->timeline, t) > 0)
      on = true;
    plain_rates(s, t, y, on, k[0]);
    for (int stage = 1; stage < 4; stage++) {
      double part = stage < 3 ? h / 2 : h;
      for (int i = 0; i < 9; i++) z[i] = y[i] + part * k[stage - 1][i];
      plain_rates(s, t + part, z, on, k[stage]);
    }
    for (int i = 0; i < 9; i++) y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    if (on && y[8] <= 0) {
      on = false;
      y[8] = 0;
    }
    double edge = -s->model.actuator.gap_m, when = t + h * (edge - before) / (y[P] - before);
    if (isnan(out.meets_s) && before >= edge && y[P] < edge) out.meets_s = when;
    if (isnan(out.leaves_s) && before < edge && y[P] >= edge) out.leaves_s = when;
    out.deepest_m = fmin(out.deepest_m, y[P]);
  }
  return out;
}

/* The plain march is late by up to half a microsecond at each switching: that is 1e-5 of what it
 * gives. */
static void switched_against_a_plain_march(void) {
  const char *sets[] = {STRIKE("run.until=0.06s"), "run.tolerance=1e-8", NULL};
  impacts m = {.met = 0};
  vs_observer observer = {&m, note};
  vs_trial *t = vs_trial_run("paper", "switched", sets, &observer);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  plain p = march(&t->scene.setup, 0.06);
  CU_ASSERT_FATAL(m.met == 1 && m.left == 1);
  CLOSE_OF(m.meets_s[0], p.meets_s, 1, 1e-6);
  CLOSE_OF(m.leaves_s[0], p.leaves_s, 1, 1e-6);
  CLOSE(t->result.values[VS_M_GAP_MIN].value, p.deepest_m, 1e-5);
  CU_ASSERT(p.deepest_m < -6.1e-3); /* it does go in */
  vs_trial_free(t);
}

/* Five strikes in half a second: the books close at every tolerance, and the depth converges. */
static void books_close_with_the_stop(void) {
  static const char *const TOLERANCES[] = {"run.tolerance=1e-4", "run.tolerance=1e-6",
                                           "run.tolerance=1e-10"};
  double depth[3];
  for (int k = 0; k < 3; k++) {
    const char *sets[] = {STRIKE("run.until=0.5s"), TOLERANCES[k], NULL};
    impacts m = {.met = 0};
    vs_observer observer = {&m, note};
    vs_trial *t = vs_trial_run("paper", "switched", sets, &observer);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    CU_ASSERT(m.met == 5 && m.left == 5);
    CU_ASSERT(t->result.watchers.energy.joule[VS_E_STOP] > 0.3);
    CU_ASSERT(fabs(t->result.watchers.energy.residual[VS_B_EVA]) < (k < 2 ? 1e-6 : 1e-9));
    CU_ASSERT(fabs(t->result.watchers.energy.residual[VS_B_MECHANICAL]) < (k < 2 ? 1e-6 : 1e-9));
    depth[k] = t->result.values[VS_M_GAP_MIN].value;
    vs_trial_free(t);
  }
  CLOSE(depth[0], depth[2], 1e-4);
  CLOSE(depth[1], depth[2], 1e-6);
}

/* The circuit tier with an all but ideal bare deck strikes when the switched tier does. */
static void circuit_against_switched(void) {
  const char *alone[] = {STRIKE("run.until=0.2s"), NULL};
  const char *sets[] = {STRIKE("run.until=0.2s"),
                        "circuit.deck=halfwave_bare",
                        "circuit.on_voltage=0 V",
                        "circuit.on_resistance=1e-4 ohm",
                        "circuit.off_resistance=1000 Mohm",
                        "supply.resistance=0",
                        "supply.inductance=0",
                        NULL};
  impacts circuit = {.met = 0}, switched = {.met = 0};
  vs_observer of_circuit = {&circuit, note}, of_switched = {&switched, note};
  vs_trial *c = vs_trial_run("paper", "circuit", sets, &of_circuit);
  vs_trial *s = vs_trial_run("paper", "switched", alone, &of_switched);
  CU_ASSERT_EQUAL_FATAL(c->status, VS_OK);
  CU_ASSERT_EQUAL_FATAL(s->status, VS_OK);
  CU_ASSERT_EQUAL_FATAL(circuit.met, switched.met);
  CU_ASSERT_EQUAL_FATAL(circuit.left, switched.left);
  for (int k = 0; k < switched.met;
       k++) { /* the default tolerance, 1e-4, of a 50 Hz period: 2 us */
    CLOSE_OF(circuit.meets_s[k], switched.meets_s[k], 1, 2e-6);
    CLOSE_OF(circuit.leaves_s[k], switched.leaves_s[k], 1, 2e-6);
  }
  CLOSE(c->result.values[VS_M_GAP_MIN].value, s->result.values[VS_M_GAP_MIN].value, 1e-4);
  CU_ASSERT(fabs(c->result.watchers.energy.residual[VS_B_MECHANICAL]) < 1e-3);
  CU_ASSERT(fabs(c->result.watchers.energy.residual[VS_B_EVA]) < 1e-3);
  vs_trial_free(c);
  vs_trial_free(s);
}

/* A stop so soft that the gap itself closes: no result, an error with the time. */
static void a_soft_stop_gives_way(void) {
  const char *sets[] = {STRIKE("run.until=0.2s"), "actuator.stop.stiffness=1e5 N/m", NULL};
  for (int k = 0; k < 2; k++) {
    vs_trial *t = vs_trial_run("paper", k ? "circuit" : "switched", sets, NULL);
    CU_ASSERT_EQUAL(t->status, VS_RUN);
    CU_ASSERT_PTR_NOT_NULL(strstr(t->err.text, "the gap is closed"));
    vs_trial_free(t);
  }
}

/* A stop that is never met changes nothing, to the last bit. */
static void an_unmet_stop_changes_nothing(void) {
  static const char *const TIERS[] = {"switched", "circuit"};
  for (int k = 0; k < 2; k++) {
    const char *with[] = {"actuator.stop={}", "run.until=0.05s", NULL};
    const char *without[] = {"actuator.stop=none", "run.until=0.05s", NULL};
    vs_trial *a = vs_trial_run("paper", TIERS[k], with, NULL),
             *b = vs_trial_run("paper", TIERS[k], without, NULL);
    CU_ASSERT_EQUAL_FATAL(a->status, VS_OK);
    CU_ASSERT_EQUAL(a->result.values[VS_M_GAP_FIRST].value, b->result.values[VS_M_GAP_FIRST].value);
    CU_ASSERT_EQUAL(a->result.steps, b->result.steps);
    vs_trial_free(a);
    vs_trial_free(b);
  }
}

/* Least p of the last second, and how often the stop was met in it. */
typedef struct orbit {
  double from_s, p_min_m;
  int met;
} orbit;

static vs_status follow(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  orbit *o = ctx;
  if (step->to->t_s < o->from_s) return VS_OK;
  double h = step->to->t_s - step->from->t_s;
  for (int k = 1; k <= 8; k++) /* between knots too */
    o->p_min_m = fmin(o->p_min_m, vs_step_channel(step, step->from->t_s + h * k / 8, VS_CH_P));
  o->met += step->event[0] == VS_EV_MEETS_STOP;
  return VS_OK;
}

/* 90 degrees, 60 Hz, every cycle. guarded: as a user's run, which ends where z <= 0. */
static orbit orbit_of(const char *stop, const char *kick, double until_s, bool guarded) {
  char until[64];
  snprintf(until, sizeof until, "run.until=%g s", until_s);
  char *sets[] = {(char *)(size_t) "firing.angle=90deg",
                  (char *)(size_t) "firing.every=1",
                  (char *)(size_t) "supply.frequency=60Hz",
                  (char *)(size_t)stop,
                  (char *)(size_t)kick,
                  until};
  orbit o = {until_s - 1, 0, 0};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_error err = {0};
  vs_observer observer = {&o, follow};
  CU_ASSERT_EQUAL_FATAL(vs_scene_read("paper", sets, COUNT(sets), "switched", scene, &err), VS_OK);
  vs_status status = guarded
                         ? vs_sim_run(scene->tier, &scene->setup, &scene->order, &observer, &err)
                         : scene->tier->run(&scene->setup, &scene->order, &observer, &err);
  EXPECT(status == VS_OK, "%s, %s: %s", stop, kick, err.text);
  vs_scene_free(scene);
  free(scene);
  return o;
}

/* At 60 Hz two orbits live side by side: from rest the armature never gets to its stop, after a
 * kick it strikes it in every cycle for ever. A stop of 1e7 N/m, 300 N s/m, with which z > 0. */
static void hysteresis(void) {
  static const char STOP[] = "actuator.stop={stiffness: 1e7 N/m, damping: 300 N.s/m}";
  orbit rest = orbit_of(STOP, "start.vp=0", 30, true);
  orbit kick = orbit_of(STOP, "start.vp=-1 m/s", 30, true);
  CU_ASSERT_EQUAL(rest.met, 0);
  CU_ASSERT_EQUAL(kick.met, 60);
  /* the low branch knows nothing of the stop: the reference's -3.433 mm, approached with a time
   * constant of many seconds */
  CLOSE(rest.p_min_m, -3.433e-3, 1e-3);
  CU_ASSERT(kick.p_min_m < -6e-3 && kick.p_min_m > -6.5e-3);
}

/* The reference's soft stop (1e6 N/m, 50 N s/m) lets the armature 0.29 mm beyond z = 0, which a
 * user's run refuses; the equations go on, and so does the tier without its guard. Its figures have
 * four digits, and 50 s leave 4e-4 of the transient. */
static void hysteresis_of_the_reference(void) {
  static const char STOP[] = "actuator.stop={stiffness: 1e6 N/m, damping: 50 N.s/m}";
  CLOSE(orbit_of(STOP, "start.vp=0", 50, false).p_min_m, -3.433e-3, 5e-4);
  CLOSE(orbit_of(STOP, "start.vp=-1 m/s", 50, false).p_min_m, -6.793e-3, 2e-4);
}

/* Released from a bent spring, nothing fired: p never gets as far again, and the books count what
 * was there at the beginning. */
static void starts_in_motion(void) {
  for (int k = 0; k < 2; k++) {
    const char *sets[] = {"firing.first_cycle=1000", "start.p=2 mm", "start.vw=0.1 m/s",
                          "run.until=0.1 s", NULL};
    vs_trial *t = vs_trial_run("paper", k ? "circuit" : "switched", sets, NULL);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    CLOSE(t->result.values[VS_M_GAP_MAX].value, 2e-3, 1e-12);
    CU_ASSERT(vs_mechanics_elastic_energy(&t->scene.setup.model,
                                          t->result.watchers.energy.first.x) > 0.1);
    CU_ASSERT(fabs(t->result.watchers.energy.left_j[VS_B_MECHANICAL]) < 1e-8);
    CU_ASSERT(t->result.watchers.energy.joule[VS_E_MECHANICAL] < 0);
    vs_trial_free(t);
  }
}

static const vs_test TESTS[] = {
    {"switched against a plain march", switched_against_a_plain_march},
    {"the books close", books_close_with_the_stop},
    {"circuit against switched", circuit_against_switched},
    {"a soft stop gives way", a_soft_stop_gives_way},
    {"an unmet stop changes nothing", an_unmet_stop_changes_nothing},
    {"hysteresis", hysteresis},
    {"hysteresis of the reference", hysteresis_of_the_reference},
    {"starts in motion", starts_in_motion},
};
VS_SUITE_MAIN("stop", TESTS)
