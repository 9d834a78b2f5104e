/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a case of a study leaves out: the rest of a free swing that cannot change what is read of
 * it, and the keys of its scene that have not changed. Its numbers must be those of `run`, to the
 * last digit. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "study/random.h"
#include "suite.h"

enum { MOST_SETS = 12, SET = 96 };

/* The words of --set of one scene. */
typedef struct words {
  char text[MOST_SETS][SET];
  char *set[MOST_SETS];
  size_t count;
} words;

static void add(words *w, const char *format, double value) {
  snprintf(w->text[w->count], SET, format, value);
  w->set[w->count] = w->text[w->count];
  w->count++;
}

/* A number of the scene's own, between 0 and 1. */
static double draw(uint64_t scene, uint64_t axis) {
  return vs_random_uniform(20, scene, axis);
}

static double between(uint64_t scene, uint64_t axis, double from, double to) {
  return from + (to - from) * draw(scene, axis);
}

static bool chance(uint64_t scene, uint64_t axis, double of) {
  return draw(scene, axis) < of;
}

/* Keys that every machine with a coil of the paper's kind obeys. */
static void add_drive(words *w, uint64_t n) {
  add(w, "firing.angle=%.3f deg", between(n, 1, 60, 178));
  add(w, "supply.voltage=%.3f V", between(n, 2, 150, 460));
  add(w, "run.until=%.4f s", between(n, 3, 0.05, 1.4));
  if (chance(n, 4, 0.2)) add(w, "firing.every=%.0f", between(n, 5, 1, 20));
  if (chance(n, 6, 0.2)) add(w, "run.tolerance=%.3g", pow(10, between(n, 7, -8, -2)));
  if (chance(n, 8, 0.15))
    add(w, "events.e.kind=sag", 0), add(w, "events.e.at=%.3f ms", between(n, 9, 0, 30));
}

/* Of the conveyor: its masses and dampers, a stop, a load, a start that is not at rest. */
static void add_conveyor(words *w, uint64_t n) {
  if (chance(n, 10, 0.3)) add(w, "machine.trough_mass=%.4f kg", between(n, 11, 0.5, 1.5));
  if (chance(n, 12, 0.3)) add(w, "machine.spring_damping=%.4f N.s/m", between(n, 13, 0, 40));
  if (chance(n, 14, 0.2)) add(w, "start.u=%.4f mm", between(n, 15, -2, 2));
  if (chance(n, 16, 0.2))
    add(w, "actuator.stop={stiffness: 1e6 N/m, damping: %.2f N.s/m}", between(n, 17, 0, 200));
  if (chance(n, 18, 0.2)) add(w, "load.density=%.3f g/cm3", between(n, 19, 0.5, 2));
}

static const char *const MACHINES[] = {"conveyor", "conveyor",   "conveyor",
                                       "two_mass", "fixed_base", "hanging.yaml"};

/* Three coordinates, one of them without a damper, and constant forces on two. */
static void write_hanging(void) {
  write_file("hanging.yaml",
             "title: two masses that hang, and one beside them\n"
             "coordinates: {a: {unit: m, text: armature}, b: {unit: m, text: base},\n"
             "  c: {unit: m, text: beside}}\n"
             "mass: [[0.8 kg, 0, 0], [0, 3 kg, 0], [0, 0, 0.3 kg]]\n"
             "damping: [[2.4 N.s/m, -2.4 N.s/m, 0], [-2.4 N.s/m, 5.4 N.s/m, 0],"
             " [0, 0, 0]]\n"
             "stiffness: [[86000 N/m, -86000 N/m, 0],"
             " [-86000 N/m, 95000 N/m, -400 N/m], [0, -400 N/m, 3000 N/m]]\n"
             "forces: {a: -7.8 N, c: 3 N}\n"
             "gap: {along: {a: 1, b: -1}}\n");
}

/* The n-th random scene. */
static const char *make_scene(uint64_t n, words *w) {
  size_t machine = (size_t)(draw(n, 0) * COUNT(MACHINES));
  char model[SET];
  w->count = 0;
  snprintf(model, sizeof model, "machine.model=%s%%.0s", MACHINES[machine]);
  add(w, model, 0);
  add_drive(w, n);
  if (!strcmp(MACHINES[machine], "conveyor")) add_conveyor(w, n);
  return chance(n, 20, 0.2) ? "analytic" : "switched";
}

/* ---- the rest of a swing ---- */

static bool is_same(const vs_value *a, const vs_value *b) {
  if (a->known != b->known) return false;
  return !a->known || (!memcmp(&a->value, &b->value, sizeof a->value) &&
                       (isnan(a->at_s) ? isnan(b->at_s) : a->at_s == b->at_s));
}

/* Random values of the machine's are wanted, few or many of them. */
static vs_measure_set draw_wants(uint64_t n) {
  vs_measure_set wants = {.has = {[VS_M_T_FIRE] = true}};
  for (int k = 0; k < VS_MEASURES; k++)
    wants.has[k] = wants.has[k] || chance(n, 100 + (uint64_t)k, draw(n, 99) / 5);
  return wants;
}

/* Runs the scene as `run` does and as a study does. What is wanted must be the same; what is not
 * may be unknown, but not another number. Returns whether a rest was left out. */
static bool run_both(uint64_t n) {
  words w;
  vs_error err = {0};
  vs_scene scene = {0};
  const vs_measure_set wants = draw_wants(n);
  const char *tier = make_scene(n, &w);
  vs_result *whole = vs_alloc(1, sizeof *whole), *part = vs_alloc(1, sizeof *part);
  vs_status read = vs_scene_read("/dev/null", w.set, w.count, tier, &scene, &err);
  EXPECT(read == VS_OK, "scene %d: %s", (int)n, err.text);
  const vs_session full = {0}, study = {.wants = &wants};
  vs_status one = read ? read : vs_session_run(&full, &scene, whole, &err);
  vs_status other = read ? read : vs_session_run(&study, &scene, part, &err);
  EXPECT(one == other, "scene %d ends as %d and %d: %s", (int)n, one, other, err.text);
  for (int k = 0; !one && k < VS_MEASURES; k++) {
    const vs_value *a = &whole->values[k], *b = &part->values[k];
    const bool free = !b->known && !wants.has[k];
    bool audit = k == VS_M_ENERGY_RESIDUAL;
    EXPECT(free || is_same(a, b) || (audit && fabs(a->value - b->value) < 1e-8),
           "scene %d, value %d: %.17g at %.17g and %.17g at %.17g", (int)n, k, a->value, a->at_s,
           b->value, b->at_s);
  }
  /* the balance holds the propagator against the modes; rounding grows with the steps */
  if (!one && part->watchers.left) {
    const vs_energy *e = &part->watchers.energy;
    EXPECT(fabs(e->left_j[VS_B_MECHANICAL]) <= 1e-9 * vs_energy_whole(e), "scene %d: %g of %g J",
           (int)n, e->left_j[VS_B_MECHANICAL], vs_energy_whole(e));
    CLOSE_OF(e->joule[VS_E_DAMPING], whole->watchers.energy.joule[VS_E_DAMPING], vs_energy_whole(e),
             1e-9);
    CU_ASSERT_STRING_EQUAL(part->books, whole->books);
  }
  bool left = !one && part->watchers.left;
  if (!read) {
    vs_result_free(whole);
    vs_result_free(part);
  }
  vs_scene_free(&scene);
  free(whole);
  free(part);
  return left;
}

static void swings(void) {
  enum { SCENES = 400 };
  int left = 0;
  write_hanging();
  for (uint64_t n = 0; n < SCENES; n++) left += run_both(n);
  EXPECT(left > SCENES / 8, "a rest was left out in %d of %d scenes", left, SCENES);
}

/* ---- keys ---- */

/* The numbers of the setup that a run is made of. */
static void expect_same_setup(const vs_setup *a, const vs_setup *b, uint64_t n) {
  const vs_model *one = &a->model, *other = &b->model;
#define SAME(member)                                                                               \
  EXPECT(!memcmp(&one->member, &other->member, sizeof one->member), "scene %d: " #member, (int)n)
  SAME(mass);
  SAME(damping);
  SAME(stiffness);
  SAME(mk_column);
  SAME(mf);
  SAME(m0);
  SAME(mode);
  SAME(riding);
  SAME(plain);
  SAME(actuator);
  SAME(load);
#undef SAME
  CU_ASSERT_EQUAL(one->stops.count, other->stops.count);
  CU_ASSERT_EQUAL(one->coil.a_hm, other->coil.a_hm);
  EXPECT(!memcmp(&a->run, &b->run, sizeof a->run), "scene %d: run", (int)n);
  EXPECT(!memcmp(&a->start, &b->start, sizeof a->start), "scene %d: start", (int)n);
  EXPECT(!memcmp(&a->timeline.supply, &b->timeline.supply, sizeof a->timeline.supply),
         "scene %d: supply", (int)n);
  EXPECT(!memcmp(&a->timeline.firing, &b->timeline.firing, sizeof a->timeline.firing),
         "scene %d: firing", (int)n);
  EXPECT(!memcmp(&a->circuit_values.params, &b->circuit_values.params,
                 sizeof a->circuit_values.params),
         "scene %d: circuit", (int)n);
}

/* A key of every section at a time, some of them back and forth, one with a map, one refused. */
static const char *const CHANGES[] = {"firing.angle=95 deg",
                                      "machine.trough_mass=0.9 kg",
                                      "machine.base_com=[190 mm, 90 mm]",
                                      "firing.angle=[[0 s, 160 deg], [1 s, 100 deg]]",
                                      "firing.angle=100 deg",
                                      "actuator.stop={stiffness: 1e6 N/m, damping: 20 N.s/m}",
                                      "run.until=0.2 s",
                                      "circuit.r1=330 ohm",
                                      "actuator.saturation={law: series, flux: 2 Wb}",
                                      "firing.angle=100 furlong",
                                      "firing.angle=100 deg",
                                      "load.density=2 g/cm3",
                                      "start.p=1 mm",
                                      "machine.model=two_mass",
                                      "machine={model: conveyor}",
                                      "supply.voltage=300 V",
                                      "start.p=0 mm",
                                      "actuator.stop=none",
                                      "circuit.deck=halfwave_paper",
                                      "circuit={deck: halfwave_snubbed}",
                                      "load.fraction=0.5",
                                      "machine.colour=red",
                                      "machine={}",
                                      "measure.last=2 cycles",
                                      "pwm.frequency=3 kHz"};

/* A scene that is settled again after each change is the one that is read at once. */
static void keys(void) {
  vs_scene *again = vs_alloc(1, sizeof *again), *fresh = vs_alloc(1, sizeof *fresh);
  vs_error err = {0};
  const char *set[COUNT(CHANGES)];
  CU_ASSERT_EQUAL_FATAL(vs_scene_read("/dev/null", NULL, 0, NULL, again, &err), VS_OK);
  for (size_t n = 0; n < COUNT(CHANGES); n++) {
    vs_error one = {0}, other = {0};
    set[n] = CHANGES[n];
    CU_ASSERT_EQUAL_FATAL(vs_tree_set(&again->tree, CHANGES[n], &err), VS_OK);
    vs_status a = vs_scene_reread(again, &one);
    vs_status b =
        vs_scene_read("/dev/null", (char *const *)(size_t)set, n + 1, NULL, fresh, &other);
    EXPECT(a == b, "%s: %s / %s", CHANGES[n], one.text, other.text);
    CU_ASSERT_STRING_EQUAL(one.text, other.text);
    if (!a && !b) expect_same_setup(&again->setup, &fresh->setup, n);
    vs_scene_free(fresh);
  }
  vs_scene_free(again);
  free(again);
  free(fresh);
}

static const vs_test TESTS[] = {{"the rest of a swing that is left out changes no number", swings},
                                {"a scene that is read again is the same", keys}};

VS_SUITE_MAIN("left out", TESTS)
