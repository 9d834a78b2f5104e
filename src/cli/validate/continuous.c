/* SPDX-License-Identifier: GPL-3.0-or-later
 * Continuous firing on the switched tier: periodic orbits, start-up, the pole cover, the stop; and
 * what one pulse's first peak depends on. */
#include <gsl/gsl_roots.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "validate/experiment.h"
#include "validate/orbit.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* ---- periodic orbits ---- */

#define ORBIT(name, angle, cycles)                                                                 \
  static const vs_experiment name = {.perform = vs_orbit_perform,                                  \
                                     .wall_s = 0.01,                                               \
                                     .tier = "switched",                                           \
                                     .sets = {"firing.angle=" angle, "firing.every=" cycles,       \
                                              "run.until=2s", "run.tolerance=1e-10", NULL}}
ORBIT(orbit_90, "90deg", "1");
ORBIT(orbit_100, "100deg", "1");
ORBIT(orbit_120, "120deg", "1");
ORBIT(orbit_90_2, "90deg", "2");
ORBIT(orbit_100_2, "100deg", "2");
ORBIT(orbit_120_2, "120deg", "2");

#define STEADY(text, unit, experiment, what, value, tolerance)                                     \
  {                                                                                                \
    "periodic orbit, " text, unit, &experiment, what, value, NULL, tolerance, 0,                   \
        "independent solution of the same map", "the digits given; run.tolerance is 1e-10"         \
  }
#define STEADY_AT(text, experiment, p_min, p_max, i_peak, force, power)                            \
  STEADY(text ": p_min", "m", experiment, "p_min", p_min, 1e-8),                                   \
      STEADY(text ": p_max", "m", experiment, "p_max", p_max, 1e-8),                               \
      STEADY(text ": peak current", "A", experiment, "i_peak", i_peak, 2e-8),                      \
      STEADY(text ": peak force", "N", experiment, "force_peak", force, 2e-8),                     \
      STEADY(text ": power", "W", experiment, "power", power, 1e-8)

/* ---- start-up ---- */

#define START_UP(name, tier_name, seconds, ...)                                                    \
  static const vs_experiment name = {                                                              \
      .perform = vs_experiment_perform,                                                            \
      .wall_s = seconds,                                                                           \
      .tier = tier_name,                                                                           \
      .sets = {__VA_ARGS__, "firing.every=1", "run.until=1.5s", NULL}}
START_UP(start_100, "switched", 0.03, "firing.angle=100deg", "run.tolerance=1e-8");
START_UP(start_90, "switched", 0.03, "firing.angle=90deg", "run.tolerance=1e-8");
#define STIFF                                                                                      \
  "firing.angle=90deg", "actuator.gap=1mm", "actuator.inductance=6H", "machine.trough_mass=50g",   \
      "machine.spring_stiffness=2.2e5 N/m"
START_UP(start_stiff, "switched", 0.1, STIFF, "run.tolerance=1e-8");

/* The circuit tier with parts that are all but ideal. */
#define IDEAL                                                                                      \
  "circuit.deck=halfwave_bare", "circuit.on_voltage=0 V", "circuit.on_resistance=1e-4 ohm",        \
      "circuit.off_resistance=1000 Mohm", "supply.resistance=0", "supply.inductance=0"
START_UP(circuit_100, "circuit", 0.4, "firing.angle=100deg", IDEAL);
START_UP(circuit_90, "circuit", 0.4, "firing.angle=90deg", IDEAL);
START_UP(circuit_stiff, "circuit", 0.4, STIFF, IDEAL);

#define FROM_REST(text, experiment, value, tolerance, why)                                         \
  {                                                                                                \
    "from rest, 1.5 s, " text ": p_min", "m", &experiment, "p_min", value, NULL, tolerance, 0,     \
        "independent high-order solution", why                                                     \
  }
#define SIX_DIGITS "half a unit of the sixth digit, which is given"
#define LOOSE "where loose coupling gains energy without end; run.tolerance, 1e-4"

/* ---- where the armature comes to the pole cover ---- */

typedef struct contact {
  const vs_experiment *experiment;
  const vs_observer *also;
  const char *format; /* "firing.angle=%.12g deg" */
  bool in_orbit;
  vs_status status;
  vs_error *err;
} contact;

/* How far p_min is from -D where the key has that value, m. */
static double clearance(double value, void *ctx) {
  contact *c = ctx;
  char set[64];
  vs_numbers numbers = {0};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  snprintf(set, sizeof set, c->format, value);
  if (!c->status) c->status = vs_experiment_scene(c->experiment, set, scene, c->err);
  if (!c->status && c->in_orbit) c->status = vs_orbit_find(scene, c->also, &numbers, c->err);
  if (!c->status && !c->in_orbit) {
    const vs_session session = {.unguarded = true};
    vs_result *r = vs_alloc(1, sizeof *r);
    c->status = vs_session_run(&session, scene, r, c->err);
    vs_experiment_add(&numbers, r->values[VS_M_GAP_MIN].value, "p_min");
    vs_result_free(r);
    free(r);
  }
  double p_min = vs_experiment_get(&numbers, "p_min");
  vs_experiment_numbers_free(&numbers);
  double gap_m = scene->setup.model.actuator.gap_m;
  vs_scene_free(scene);
  free(scene);
  return c->status ? 0 : p_min + gap_m;
}

static double solve_contact(contact *c, double lo, double hi) {
  gsl_function f = {clearance, c};
  gsl_root_fsolver *solver = vs_checked(gsl_root_fsolver_alloc(gsl_root_fsolver_brent));
  double root = NAN;
  if (!gsl_root_fsolver_set(solver, &f, lo, hi)) {
    for (int n = 0; n < 50 && !gsl_root_fsolver_iterate(solver); n++)
      if (gsl_root_fsolver_x_upper(solver) - gsl_root_fsolver_x_lower(solver) < 1e-5) break;
    root = gsl_root_fsolver_root(solver);
  }
  gsl_root_fsolver_free(solver);
  return root;
}

static vs_status perform_contact(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                                 vs_error *err) {
  static const struct {
    const char *name, *format;
    double lo, hi;
    bool in_orbit;
  } ROWS[] = {{"start_up_angle", "firing.angle=%.12g deg", 88, 90, false},
              {"orbit_angle", "firing.angle=%.12g deg", 78, 80, true},
              {"orbit_least_frequency", "supply.frequency=%.12g Hz", 52.5, 53, true},
              {"orbit_most_frequency", "supply.frequency=%.12g Hz", 58.2, 58.6, true}};
  vs_status status = VS_OK;
  for (size_t k = 0; k < COUNT(ROWS) && !status; k++) {
    contact c = {e, also, ROWS[k].format, ROWS[k].in_orbit, VS_OK, err};
    vs_experiment_add(out, solve_contact(&c, ROWS[k].lo, ROWS[k].hi), "%s", ROWS[k].name);
    status = c.status;
  }
  return status;
}
static const vs_experiment contacts = {
    .perform = perform_contact,
    .wall_s = 0.2,
    .tier = "switched",
    .sets = {"firing.angle=90deg", "firing.every=1", "run.until=1.5s", "run.tolerance=1e-8", NULL}};

#define CONTACT(text, unit, what, value)                                                           \
  {                                                                                                \
    "pole cover is met " text, unit, &contacts, what, value, NULL, 6e-4, 1,                        \
        "independent high-order solution", "half a unit of the last digit given"                   \
  }

/* ---- the stop: two orbits side by side ---- */

#define STOP(name, kick)                                                                           \
  static const vs_experiment name = {                                                              \
      .perform = vs_orbit_perform,                                                                 \
      .wall_s = 0.1,                                                                               \
      .tier = "switched",                                                                          \
      .sets = {"firing.angle=90deg", "firing.every=1", "supply.frequency=60Hz", kick,              \
               "actuator.stop={stiffness: 1e6 N/m, damping: 50 N.s/m}", "run.until=20s",           \
               "run.tolerance=1e-8", NULL}}
STOP(stop_rest, "start.vp=0");
STOP(stop_kick, "start.vp=-1 m/s");

#define HYSTERESIS(text, experiment, value)                                                        \
  {                                                                                                \
    "stop at 60 Hz, " text ": p_min", "m", &experiment, "p_min", value, NULL, 5e-4, 0,             \
        "independent solution, frequency swept",                                                   \
        "four digits; after 600 cycles slow modes are left"                                        \
  }

/* ---- what the first peak depends on ---- */

enum { KEY_SIZE = 96 };

static vs_status first_peak(const vs_experiment *e, const char *set, double *p_m, vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_experiment_scene(e, set, scene, err);
  if (!status) {
    const vs_session session = {.verify = false};
    vs_result *r = vs_alloc(1, sizeof *r);
    status = vs_session_run(&session, scene, r, err);
    *p_m = r->values[VS_M_GAP_FIRST].value;
    vs_result_free(r);
    free(r);
  }
  vs_scene_free(scene);
  free(scene);
  return status;
}

/* d ln(first peak)/d ln(key), by changing each key by 1e-4 up and down. */
static vs_status perform_sensitivity(const vs_experiment *e, const vs_observer *also,
                                     vs_numbers *out, vs_error *err) {
  static const struct {
    const char *key, *unit;
    double value;
  } ROWS[] = {{"firing.angle", "deg", 100},       {"supply.frequency", "Hz", 50},
              {"supply.voltage", "V", 440},       {"actuator.gap", "mm", 6},
              {"actuator.inductance", "H", 1.6},  {"machine.spring_stiffness", "N/m", 0.43e5},
              {"actuator.resistance", "ohm", 92}, {"machine.trough_mass", "kg", 0.83}};
  const double part = 1e-4;
  vs_status status = VS_OK;
  (void)also;
  for (size_t k = 0; k < COUNT(ROWS) && !status; k++) {
    double p_m[2] = {NAN, NAN};
    for (int up = 0; up < 2 && !status; up++) {
      char set[KEY_SIZE];
      snprintf(set, sizeof set, "%s=%.17g %s", ROWS[k].key,
               ROWS[k].value * (1 + (up ? part : -part)), ROWS[k].unit);
      status = first_peak(e, set, &p_m[up], err);
    }
    vs_experiment_add(out, log(p_m[1] / p_m[0]) / log((1 + part) / (1 - part)), "%s", ROWS[k].key);
  }
  return status;
}
static const vs_experiment sensitivity = {.perform = perform_sensitivity,
                                          .wall_s = 0.01,
                                          .tier = "switched",
                                          .sets = {"run.until=0.03s", "run.tolerance=1e-10", NULL}};

#define SENSITIVE(key, value)                                                                      \
  {                                                                                                \
    "first peak of p against " key, "", &sensitivity, key, value, NULL, 6e-5, 1,                   \
        "independent solution, d ln/d ln", "half a unit of the last digit given"                   \
  }

static const vs_comparison COMPARISONS[] = {
    STEADY_AT("90 deg", orbit_90, -3.557126323e-3, 3.123037779e-3, 0.51250361, 156.546237,
              8.62049699),
    STEADY_AT("100 deg", orbit_100, -2.137732828e-3, 1.922138543e-3, 0.61590926, 103.472962,
              8.49145449),
    STEADY_AT("120 deg", orbit_120, -6.158917571e-4, 5.789630775e-4, 0.50357049, 38.063948,
              3.89399068),
    STEADY("90 deg, every second cycle: p_min", "m", orbit_90_2, "p_min", -1.718621245e-3, 1e-8),
    STEADY("100 deg, every second cycle: p_min", "m", orbit_100_2, "p_min", -1.067308339e-3, 1e-8),
    STEADY("120 deg, every second cycle: p_min", "m", orbit_120_2, "p_min", -3.251320325e-4, 1e-8),

    FROM_REST("100 deg, switched", start_100, -3.65770e-3, 2e-6, SIX_DIGITS),
    FROM_REST("90 deg, switched", start_90, -5.75672e-3, 2e-6, SIX_DIGITS),
    FROM_REST("stiff set, switched", start_stiff, -0.469869e-3, 2e-6, SIX_DIGITS),
    FROM_REST("100 deg, circuit", circuit_100, -3.65770e-3, 1e-4, LOOSE),
    FROM_REST("90 deg, circuit", circuit_90, -5.75672e-3, 1e-4, LOOSE),
    FROM_REST("stiff set, circuit", circuit_stiff, -0.469869e-3, 1e-4, LOOSE),

    CONTACT("in the start-up, below", "deg", "start_up_angle", 88.998),
    CONTACT("in the orbit, below", "deg", "orbit_angle", 78.993),
    CONTACT("in the orbit at 90 deg, above", "Hz", "orbit_least_frequency", 52.823),
    CONTACT("in the orbit at 90 deg, below", "Hz", "orbit_most_frequency", 58.385),
    HYSTERESIS("from rest", stop_rest, -3.433e-3),
    HYSTERESIS("after a kick", stop_kick, -6.793e-3),

    SENSITIVE("firing.angle", -4.6252),
    SENSITIVE("supply.frequency", -2.4247),
    SENSITIVE("supply.voltage", 2.0210),
    SENSITIVE("actuator.gap", -0.9424),
    SENSITIVE("actuator.inductance", -0.6927),
    SENSITIVE("machine.spring_stiffness", -0.6410),
    SENSITIVE("actuator.resistance", -0.3178),
    SENSITIVE("machine.trough_mass", -0.3039),
};
const vs_comparisons vs_continuous_comparisons = {COMPARISONS, COUNT(COMPARISONS)};
