/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is seen of any machine: the names of its measures, their extremes where the law or the stop
 * is not the plain one, and the books of a coil whose two constants differ. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/step.h"
#include "suite.h"

/* ---- names ---- */

/* All names of the model's measures, each followed by a blank. */
static void expect_names(const vs_model *model, const char *names) {
  char all[4096] = "";
  vs_measure m;
  int count = 0;
  for (; vs_measure_at(model, count, &m); count++)
    snprintf(all + strlen(all), sizeof all - strlen(all), "%s ", m.name);
  EXPECT(!strcmp(all, names), "%s", all);
  CU_ASSERT_EQUAL(count, vs_measures_count(model));
}

#define DRIVE "i_peak t_fire t_extinction conduction_time force_peak "
#define GAP "gap_first_peak gap_second_peak gap_min gap_max stroke "
#define BOOKS "energy_in energy_copper work_force energy_residual "

/* Where one coordinate opens the gap, the gap's measures have its name too, before those that every
 * machine has; a second one takes that away. */
static void names(void) {
  vs_trial *t = vs_trial_read("paper", "switched", NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  expect_names(&t->scene.setup.model,
               DRIVE "p_first_peak p_second_peak p_min p_max " GAP
                     "u_min u_max w_min w_max phi_min phi_max ap_peak au_peak aw_peak aphi_peak "
                     "f_resonance tau_p tau_gap " BOOKS);
  vs_trial_free(t);
  t = vs_trial_read("two_mass", "switched", NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  expect_names(&t->scene.setup.model,
               DRIVE GAP "x_min x_max y_min y_max ax_peak ay_peak f_resonance tau_gap " BOOKS);
  vs_trial_free(t);
}

/* A coordinate that closes the gap by as much as it moves: the travel is its negative. */
static void closing(void) {
  write_file("closing.yaml", "title: a mass that closes the gap\n"
                             "coordinates: {x: {unit: m, text: towards the pole}}\n"
                             "mass: 0.83 kg\n"
                             "damping: 2.4 N.s/m\n"
                             "stiffness: 86000 N/m\n"
                             "gap: {along: {x: -1}}\n"
                             "supply: {voltage: 440 V}\nfiring: {angle: 100 deg}\n");
  static const char *const SETS[] = {"machine.model=closing.yaml", "run.until=0.1s",
                                     "run.tolerance=1e-10", NULL};
  vs_trial *t = vs_trial_run("/dev/null", "switched", SETS, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  const vs_value *v = t->result.values;
  CLOSE(v[VS_M_GAP_FIRST].value, -0.0013273743082, 1e-9); /* as the machine fixed_base */
  CU_ASSERT_EQUAL(v[VS_M_GAP_MIN].value, -v[VS_M_OF_COORDINATE(0, VS_LARGEST)].value);
  CU_ASSERT_EQUAL(v[VS_M_GAP_MAX].value, -v[VS_M_OF_COORDINATE(0, VS_LEAST)].value);
  vs_measure m;
  int k = 0;
  while (vs_measure_at(&t->scene.setup.model, k, &m) && strcmp(m.name, "x_first_peak")) k++;
  CU_ASSERT_EQUAL(m.slot, VS_M_GAP_FIRST);
  CU_ASSERT_EQUAL(m.factor, -1);
  vs_trial_free(t);
}

/* ---- extremes ---- */

/* The largest that a channel has at a hundred instants of every step, in the sense of its measure.
 */
typedef struct followed {
  int measure, channel, sense;
  double most, size;
} followed;
enum { MOST_FOLLOWED = 2 + 3 * 4 };
typedef struct all {
  followed item[MOST_FOLLOWED];
  int count;
} all;

static void follow(all *f, const vs_model *m) {
  const followed of_law[] = {{VS_M_I_PEAK, VS_CH_I, 0, -INFINITY, 0},
                             {VS_M_FORCE_PEAK, VS_CH_FORCE, 0, -INFINITY, 0}};
  for (size_t k = 0; k < COUNT(of_law); k++) f->item[f->count++] = of_law[k];
  for (int i = 0; i < m->dof; i++)
    for (int k = 0; k < VS_OF_COORDINATE; k++)
      f->item[f->count++] = (followed){VS_M_OF_COORDINATE(i, k),
                                       k == VS_PEAK ? vs_channel_rates2(m) + i : VS_CH_Q + i,
                                       k == VS_PEAK    ? 0
                                       : k == VS_LEAST ? -1
                                                       : 1,
                                       -INFINITY, 0};
}

static vs_status look(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  all *f = ctx;
  double y[VS_CH_MOST], from = step->from->t_s, h = step->to->t_s - from;
  if (!f->count) follow(f, step->frame->model);
  for (int n = 0; n <= 100 && h > 0; n++) {
    vs_step_at(step, n < 100 ? from + h * n / 100 : step->to->t_s, y);
    for (int k = 0; k < f->count; k++) {
      followed *one = &f->item[k];
      double now = y[one->channel];
      one->size = fmax(one->size, fabs(now));
      one->most = fmax(one->most, one->sense ? one->sense * now : fabs(now));
    }
  }
  return VS_OK;
}

/* No instant lies beyond an extreme by more than the 1e-10 of the largest to which they are right;
 * nor is an extreme further beyond all instants than a hundredth of a step can hide: a sine that
 * moves by one radian in a step is 1.3e-5 below its top 1/200 away from it. */
static void extremes_of(const char *scene, const char *const *sets, double hidden) {
  all f = {.count = 0};
  const vs_observer observer = {&f, look};
  vs_trial *t = vs_trial_run(scene, "switched", sets, &observer);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  for (int k = 0; k < f.count; k++) {
    const followed *one = &f.item[k];
    double value = t->result.values[one->measure].value;
    double beyond = one->most - (one->sense ? one->sense * value : fabs(value));
    EXPECT(beyond <= 1e-10 * one->size, "%s, measure %d: an instant is beyond %.12g by %.2g of it",
           scene, one->measure, value, beyond / one->size);
    EXPECT(beyond >= -hidden * one->size, "%s, measure %d: %.12g is beyond all instants by %.2g",
           scene, one->measure, value, -beyond / one->size);
  }
  vs_trial_free(t);
}

static void extremes(void) {
  static const char *const SERIES[] = {
      "actuator.saturation={law: series, flux: 1.2 Wb, exponent: 7, current: 0.2 A}",
      "actuator.leakage=0.15 H", "run.until=0.2s", NULL};
  static const char *const SHORT[] = {"run.until=20ms", NULL};
  extremes_of("paper", NULL, 2e-5);
  extremes_of("paper", SERIES, 2e-5);
  extremes_of("lds_v203", SHORT, 2e-5);
  extremes_of("solenoid", SHORT, 2e-5); /* with a stop that has corners */
}

/* A polynomial of degree 14 through values of a smooth function is that function to rounding. */
static void through_points(void) {
  double y[VS_CURVE_POINTS], worst = 0;
  for (int k = 0; k < VS_CURVE_POINTS; k++) y[k] = exp(2 * vs_step_curve_point(k));
  const vs_curve c = vs_step_curve_through(y);
  for (int n = 0; n <= 1000; n++)
    worst = fmax(worst, fabs(vs_step_curve_value(&c, n / 1000.0) / exp(2 * n / 1000.0) - 1));
  CU_ASSERT(worst <
            1e-13); /* 2^15/(2^29 15!), the error of Chebyshev's points, is below rounding */
}

/* ---- books ---- */

/* Where the voltage's constant is k_e and the force's k_f, int (k_e - k_f) i g' dt is k_e/k_f - 1
 * times the force's work. */
static void transducer(void) {
  static const char *const SETS[] = {"run.until=0.1s", "run.tolerance=1e-10", NULL};
  vs_trial *t = vs_trial_run("lds_v203", "switched", SETS, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  const vs_energy *e = &t->result.watchers.energy;
  const vs_actuator_values *v = &t->scene.setup.model.actuator;
  CU_ASSERT(vs_energy_has(&t->scene.setup.model, VS_E_TRANSDUCER));
  double part = v->emf_constant_vs_m / v->force_constant_n_a - 1;
  CU_ASSERT(part > 1e-4);
  CLOSE_OF(e->joule[VS_E_TRANSDUCER], part * e->joule[VS_E_WORK], e->joule[VS_E_WORK], 1e-12);
  CU_ASSERT(e->worst < 1e-9); /* ten times run.tolerance */
  vs_trial_free(t);
  t = vs_trial_read("paper", "switched", NULL);
  CU_ASSERT_FALSE(vs_energy_has(&t->scene.setup.model, VS_E_TRANSDUCER));
  vs_trial_free(t);
}

static const vs_test TESTS[] = {
    {"names", names},
    {"a coordinate that closes the gap", closing},
    {"extremes of laws and stops", extremes},
    {"a polynomial through points", through_points},
    {"a line for a transducer", transducer},
};
VS_SUITE_MAIN("measures of any machine", TESTS)
