/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier circuit with coils whose law is not i = lambda z/(2a): the law's own text stands in the
 * netlist, and the run agrees with references that were computed otherwise. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "actuator/coil.h"
#include "deck/eva.h"
#include "suite.h"

/* ---- a law of the test's own: iron in series with the gap, so that
 * i = lambda z/(2a) + I (lambda/l)^7, W = lambda^2 z/(4a) + I l/8 (lambda/l)^8 ---- */

static const double IRON_A = 0.2, IRON_WB = 1.2;

static double own_current(const vs_coil *c, double flux_wb, double z_m) {
  return flux_wb * z_m / (2 * c->a_hm) + IRON_A * pow(flux_wb / IRON_WB, 7);
}
static double own_force(const vs_coil *c, double flux_wb, double z_m) {
  (void)z_m;
  return flux_wb * flux_wb / (4 * c->a_hm);
}
static double own_energy(const vs_coil *c, double flux_wb, double z_m) {
  return flux_wb * flux_wb * z_m / (4 * c->a_hm) + IRON_A * IRON_WB / 8 * pow(flux_wb / IRON_WB, 8);
}
static void own_along(const vs_coil *c, const double f[3], const double z[3], double i[3],
                      double force[3]) {
  double per_2a = 1 / (2 * c->a_hm), r = f[0] / IRON_WB;
  double slope = 7 * IRON_A / IRON_WB * pow(r, 6), bend = 42 * IRON_A / pow(IRON_WB, 2) * pow(r, 5);
  i[0] = own_current(c, f[0], z[0]);
  i[1] = (f[1] * z[0] + f[0] * z[1]) * per_2a + slope * f[1];
  i[2] = (f[2] * z[0] + 2 * f[1] * z[1] + f[0] * z[2]) * per_2a + slope * f[2] + bend * f[1] * f[1];
  force[0] = f[0] * f[0] * per_2a / 2;
  force[1] = f[0] * f[1] * per_2a;
  force[2] = (f[1] * f[1] + f[0] * f[2]) * per_2a;
}
static void own_netlist(const vs_coil *c, const char *flux, const char *gap, vs_text *lines,
                        vs_text *current, vs_text *force) {
  (void)lines;
  vs_text_add(current, "%s*%s/(%.17g)+(%.17g)*(%s/(%.17g))^7", flux, gap, 2 * c->a_hm, IRON_A, flux,
              IRON_WB);
  vs_text_add(force, "%s*%s/(%.17g)", flux, flux, 4 * c->a_hm);
}
static const vs_law OWN = {.name = "own",
                           .text = "iron in series",
                           .poles = true,
                           .current = own_current,
                           .force = own_force,
                           .energy = own_energy,
                           .along = own_along,
                           .netlist = own_netlist};

static void take_law(vs_trial *t, const vs_law *law) {
  vs_model *m = &t->scene.setup.model;
  m->coil.law = law;
  m->coil.square = m->plain = false;
  vs_eva_take_law(&t->scene.setup.deck, &m->coil);
}

/* ---- what a run gives ---- */

static double value(const vs_trial *t, const char *name) {
  const vs_measure *m = vs_measures_standard;
  for (size_t k = 0; k < VS_MEASURES; k++)
    if (!strcmp(m[k].name, name)) return t->result.values[k].value;
  EXPECT(false, "no measure %s", name);
  return NAN;
}

#define IDEAL                                                                                      \
  "circuit.deck=halfwave_bare", "circuit.on_voltage=0 V", "circuit.on_resistance=1e-4 ohm",        \
      "circuit.off_resistance=1000 Mohm", "supply.resistance=0", "supply.inductance=0",            \
      "run.tolerance=1e-5", "run.until=0.1 s"

/* Three times run.tolerance, as between the tiers in validate/tiers.c. */
static const double THREE = 3e-5;

typedef struct reference {
  const char *name;
  double value;
} reference;

static void compare(const vs_trial *t, const reference *rows, int line) {
  expect(t->status == VS_OK, line, "%s", t->err.text);
  for (; t->status == VS_OK && rows->name; rows++)
    vs_close(value(t, rows->name), rows->value, rows->value, THREE, rows->name, line);
}

/* Reference: two or three unlike integrators of the same equations with an ideal thyristor. */
static void saturation_in_series(void) {
  const char *const sets[] = {IDEAL, NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", sets);
  take_law(t, &OWN);
  vs_trial_go(t, NULL);
  static const reference ROWS[] = {
      {"i_peak", 1.2884797007},           {"force_peak", 88.635095317},
      {"t_extinction", 0.013617686556},   {"p_first_peak", -0.001296558},
      {"p_second_peak", 0.0012677986356}, {NULL, 0}};
  compare(t, ROWS, __LINE__);
  CU_ASSERT_PTR_NOT_NULL(vs_result_declined(&t->result));
  CU_ASSERT_EQUAL(t->result.watchers.absence.times, 0);
  vs_trial_free(t);
}

static const vs_test TESTS[] = {
    {"saturation in series", saturation_in_series},
};
VS_SUITE_MAIN("circuit_laws", TESTS)
