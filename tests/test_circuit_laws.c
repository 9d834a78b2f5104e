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
  vs_measure m;
  for (int k = 0; vs_measure_at(&t->scene.setup.model, k, &m); k++)
    if (!strcmp(m.name, name)) return m.factor * t->result.values[m.slot].value;
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
static const reference SERIES[] = {
    {"i_peak", 1.2884797007},           {"force_peak", 88.635095317},
    {"t_extinction", 0.013617686556},   {"p_first_peak", -0.001296558},
    {"p_second_peak", 0.0012677986356}, {NULL, 0}};

static void saturation_in_series(void) {
  const char *const sets[] = {IDEAL, NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", sets);
  take_law(t, &OWN);
  vs_trial_go(t, NULL);
  compare(t, SERIES, __LINE__);
  CU_ASSERT_PTR_NOT_NULL(vs_result_declined(&t->result));
  CU_ASSERT_EQUAL(t->result.watchers.absence.times, 0);
  vs_trial_free(t);
}

/* The same coil as an event's EVA has it, of which turns are shorted only when all is over. */
static void saturation_in_a_coil_with_shorted_turns(void) {
  const char *const sets[] = {IDEAL, "events={e: {kind: coil_short, at: 99 ms, fraction: 10 %}}",
                              NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", sets);
  take_law(t, &OWN);
  vs_trial_go(t, NULL);
  compare(t, SERIES, __LINE__);
  vs_trial_free(t);
}

/* ---- the shaker LDS V-203: a moving coil, linear, on a source of its own ---- */

/* Its mechanics in the place of the paper's: the armature's motion alone. */
static void take_shaker(vs_model *m) {
  const double lb = 4.4482216152605, in = 0.0254;
  const double mass = 178.04e-6 * lb / in, k = 16.54 * lb / in, c = 39.09e-3 * lb / in;
  for (int i = 0; i < m->dof; i++)
    for (int j = 0; j < m->dof; j++) m->mk_column[j][i] = m->mb_column[j][i] = 0;
  for (int i = 0; i < m->dof; i++) {
    m->mf[i] = 0;
    m->mk_column[i][i] = 1e4;
  }
  m->mk_column[0][0] = k / mass;
  m->mb_column[0][0] = c / mass;
  m->mf[0] = m->per_newton_m_s2 = -1 / mass;
  m->fastest_rad_s = m->contact_rad_s = m->working_rad_s = sqrt(k / mass);
}

#define SHAKER                                                                                     \
  "actuator={law: moving_coil, emf_constant: 3.7440944881889764 V.s/m, inductance: 764 uH, "       \
  "force_constant: 3.7436233114033258 N/A, resistance: 1.6 ohm}",                                  \
      "run.tolerance=1e-5", "run.until=0.03 s", "circuit.deck=direct.cir"

typedef struct samples {
  double t_s[4], x[4], v[4], i[4];
  int count;
} samples;

static vs_status sample(void *ctx, const vs_step *step, vs_error *err) {
  samples *s = ctx;
  (void)err;
  for (int k = 0; k < s->count; k++) {
    if (!(s->t_s[k] > step->from->t_s && s->t_s[k] <= step->to->t_s)) continue;
    s->x[k] = vs_step_channel(step, s->t_s[k], VS_CH_Q);
    s->v[k] = vs_step_channel(step, s->t_s[k], vs_channel_rates(step->frame->model));
    s->i[k] = vs_step_channel(step, s->t_s[k], VS_CH_I);
  }
  return VS_OK;
}

/* Reference: the closed form of the linear equations on a voltage step. */
static void moving_coil_on_a_step(void) {
  write_file("direct.cir", "Vd a 0 8.36501901140684\nXeva a 0 eva\n");
  const char *const sets[] = {SHAKER, NULL};
  samples s = {.t_s = {0.001, 0.005, 0.02}, .count = 3};
  static const double X[] = {0.000127862768692, 0.00314544357825, 0.00677011695283},
                      V[] = {0.319395303456, 0.823797149213, 0.0025854053243},
                      I[] = {4.20408662937, 3.23981706413, 5.2177005625};
  vs_trial *t = vs_trial_read("paper", "circuit", sets);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  take_shaker(&t->scene.setup.model);
  const vs_observer also = {&s, sample};
  vs_trial_go(t, &also);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  for (int k = 0; k < s.count; k++) {
    CLOSE_OF(s.x[k], X[k], 6.77e-3, THREE); /* of the largest x, v and i */
    CLOSE_OF(s.v[k], V[k], 0.98, THREE);
    CLOSE_OF(s.i[k], I[k], 5.22, THREE);
    printf("%g %g %g\n", s.x[k] / X[k] - 1, s.v[k] / V[k] - 1, s.i[k] / I[k] - 1);
  }
  vs_trial_free(t);
}

/* Let go from 1 mm on an open circuit: the flux linkage that the coil begins with is that of no
 * current, else some 5 A would begin to flow. */
static void moving_coil_begins_without_a_current(void) {
  write_file("direct.cir", "Rload a 0 1g\nXeva a 0 eva\n");
  const char *const sets[] = {SHAKER, "start={p: 1 mm}", NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", sets);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  CLOSE(t->scene.setup.deck.eva_flux_wb, 3.7440944881889764e-3, 1e-12);
  take_shaker(&t->scene.setup.model);
  samples s = {.t_s = {1e-5, 0.005}, .count = 2};
  const vs_observer also = {&s, sample};
  vs_trial_go(t, &also);
  for (int k = 0; k < s.count; k++) CLOSE_OF(s.i[k], 0, 4.9, 1e-7); /* 1e-7: the load takes 2 nA */
  vs_trial_free(t);
}

static const vs_test TESTS[] = {
    {"moving coil begins without a current", moving_coil_begins_without_a_current},
    {"moving coil on a step", moving_coil_on_a_step},
    {"saturation in series", saturation_in_series},
    {"saturation in a coil with shorted turns", saturation_in_a_coil_with_shorted_turns},
};
VS_SUITE_MAIN("circuit_laws", TESTS)
