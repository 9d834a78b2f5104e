/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tiers analytic and switched against independent high-order solutions of the paper's scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "suite.h"

/* Channel values at given instants. */
typedef struct probe_at {
  int channel;
  double at_s[3], value[3];
} probe_at;

static vs_status look(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  probe_at *p = ctx;
  for (int k = 0; k < 3; k++)
    if (p->at_s[k] > step->from->t_s && p->at_s[k] <= step->to->t_s)
      p->value[k] = vs_step_channel(step, p->at_s[k], p->channel);
  return VS_OK;
}

typedef struct reference {
  const char *tier;
  double i_peak, i_at, extinction, force, first, first_at, second, ap, au, aw, p[3], in, copper,
      work;
} reference;

/* Reference solutions of the paper's scene (Table 1, 100 degrees, one pulse) by integrators of
 * other projects and in quadruple precision, whose digits agree; energies over 2 s. */
static const reference T0 = {
    "analytic",      0.879912533701,   0.00958471858,
    0.0137254833604, 95.2918236264,    -0.00140183082248,
    0.01401833399,   0.00137071749387, 176.668876468,
    29.3636342559,   11.7806926833,    {-7.82689909e-4, -5.67661043e-5, 2.94302354e-5},
    0.2977374998,    0.2977374998,     0.0860134459591};
static const reference T2 = {
    "switched",      0.841947867587, 0.00934040817,
    0.0137708354356, 95.7553916336,  -0.00141639233706,
    0.01404143007,   0.001384941576, 178.503310326,
    29.6681429346,   11.9035858553,  {-7.83281597e-4, -5.53583399e-5, 2.94788565e-5},
    0.3522873295,    0.2644805688,   0.0878067607};

/* tolerance: of every number, relative to that quantity's peak; instants relative to themselves.
 * Where the reference prints ten digits or fewer, half a unit of its last is below 5e-10 of the
 * peak. */
static void check(const reference *r, const char *setting, double tolerance) {
  probe_at p = {VS_CH_P, {0.1, 1, 2}, {0}};
  vs_observer observer = {&p, look};
  const char *sets[] = {setting, NULL};
  vs_trial *t = vs_trial_run("paper", r->tier, sets, &observer);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  const vs_value *v = t->result.values;
  CLOSE(v[VS_M_I_PEAK].value, r->i_peak, tolerance);
  CLOSE(v[VS_M_T_EXTINCTION].value, r->extinction, tolerance);
  CLOSE(v[VS_M_FORCE_PEAK].value, r->force, tolerance);
  CLOSE(v[VS_M_GAP_FIRST].value, r->first, tolerance);
  CLOSE_OF(v[VS_M_GAP_SECOND].value, r->second, r->first, tolerance);
  CLOSE(v[VS_M_GAP_MIN].value, r->first, tolerance);
  CLOSE_OF(v[VS_M_GAP_MAX].value, r->second, r->first, tolerance);
  CLOSE(v[VS_M_OF_COORDINATE(P, VS_PEAK)].value, r->ap, tolerance);
  CLOSE(v[VS_M_OF_COORDINATE(U, VS_PEAK)].value, r->au, tolerance);
  CLOSE(v[VS_M_OF_COORDINATE(W, VS_PEAK)].value, r->aw, tolerance);
  CLOSE(v[VS_M_I_PEAK].at_s, r->i_at, tolerance);
  CLOSE(v[VS_M_GAP_FIRST].at_s, r->first_at, tolerance);
  for (int k = 0; k < 3; k++) CLOSE_OF(p.value[k], r->p[k], r->first, tolerance);
  CLOSE(t->result.watchers.energy.joule[VS_E_SOURCE], r->in, tolerance);
  CLOSE(t->result.watchers.energy.joule[VS_E_COPPER], r->copper, tolerance);
  CLOSE(t->result.watchers.energy.joule[VS_E_WORK], r->work, tolerance);
  CU_ASSERT(t->result.watchers.energy.balanced[VS_B_CIRCUIT]);
  CU_ASSERT(t->result.watchers.energy.worst <= 1e-9); /* whatever the tolerance */
  vs_trial_free(t);
}

static void analytic_exactly(void) {
  check(&T0, "run.tolerance=1e-10", 1e-9);
}
static void analytic_by_default(void) {
  check(&T0, "run.tolerance=1e-4", 1e-4);
}
static void switched_exactly(void) {
  check(&T2, "run.tolerance=1e-10", 1e-9);
}
static void switched_by_default(void) {
  check(&T2, "run.tolerance=1e-4", 1e-4);
}

/* Resonance and decay as they are read off a record (T2, extinction to 1 s): the frequency from
 * rising zero crossings has nine reference digits, the decay is the working mode's to what slower
 * modes let one see. */
static void resonance_and_decay(void) {
  const char *sets[] = {"run.tolerance=1e-10", NULL};
  vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  CLOSE(t->result.values[VS_M_F_RESONANCE].value, 56.5762892, 1e-9);
  CLOSE(t->result.values[VS_M_TAU_GAP].value, 0.57104797, 5e-4);
  vs_trial_free(t);
}

/* The sample grid and the end of the run never change the steps' result. */
static void result_does_not_depend_on_the_step(void) {
  const char *sets[] = {"run.tolerance=1e-10", "run.max_step=37us", NULL};
  vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  CLOSE(t->result.values[VS_M_GAP_FIRST].value, T2.first, 1e-9);
  CLOSE(t->result.values[VS_M_T_EXTINCTION].value, T2.extinction, 1e-9);
  vs_trial_free(t);
}

/* Phase control of R-L (Eq. 91 with L(0)): extinction angle, conduction, peak; closed form. */
static void phase_control_closed_form(void) {
  static const struct {
    const char *angle;
    double beta_deg, conduction_ms, i_peak;
  } ROWS[] = {{"firing.angle=80deg", 259.4184, 9.9677, 1.21177},
              {"firing.angle=100deg", 247.0587, 8.1699, 0.87991},
              {"firing.angle=120deg", 232.7680, 6.2649, 0.55070},
              {"firing.angle=150deg", 208.1680, 3.2316, 0.15600}};
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    const char *sets[] = {ROWS[k].angle, "run.until=0.02s", "run.tolerance=1e-10", NULL};
    vs_trial *t = vs_trial_run("paper", "analytic", sets, NULL);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    CLOSE_OF(t->result.values[VS_M_T_EXTINCTION].value * 18000, ROWS[k].beta_deg, 1,
             5.1e-5); /* printed digits */
    CLOSE_OF(t->result.values[VS_M_CONDUCTION].value * 1e3, ROWS[k].conduction_ms, 1, 5.1e-5);
    CLOSE_OF(t->result.values[VS_M_I_PEAK].value, ROWS[k].i_peak, 1, 5.1e-6);
    vs_trial_free(t);
  }
}

/* Start-up transient of continuous firing, 1.5 s from rest: p_min to the six digits it is known to.
 */
static void continuous_firing_from_rest(void) {
  static const struct {
    const char *angle;
    double p_min;
  } ROWS[] = {{"firing.angle=100deg", -3.65770e-3}, {"firing.angle=90deg", -5.75672e-3}};
  for (size_t k = 0; k < 2; k++) {
    const char *sets[] = {ROWS[k].angle, "firing.every=1", "run.until=1.5s", "run.tolerance=1e-8",
                          NULL};
    vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    CLOSE(t->result.values[VS_M_GAP_MIN].value, ROWS[k].p_min, 2e-6);
    vs_trial_free(t);
  }
}

/* Firing just after and just before the zero crossings, and below theta (a wide gap keeps clear of
 * the pole). */
static void sharp_firing_angles_run(void) {
  static const char *const ANGLES[] = {"firing.angle=0.1deg", "firing.angle=60deg",
                                       "firing.angle=179.9deg"};
  for (size_t k = 0; k < 3; k++) {
    const char *sets[] = {ANGLES[k], "firing.every=1", "run.until=0.1s", "actuator.gap=60mm", NULL};
    vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
    CU_ASSERT_EQUAL(t->status, VS_OK);
    const double *joule =
        t->result.watchers.energy.joule; /* at 179.9 degrees the work itself is lost in rounding */
    CU_ASSERT(fabs(t->result.watchers.energy.left_j[VS_B_EVA]) < 1e-7 * joule[VS_E_SOURCE]);
    CU_ASSERT_TRUE(t->result.values[VS_M_T_EXTINCTION].known);
    vs_trial_free(t);
  }
}

/* What moves little or fast is as right as the rest: conductions of half a millisecond and of ten
 * microseconds, and a coil that follows the mains within one millisecond. The coarse run is as good
 * as its books of energy ask, to 1e-8. */
static void late_and_quick_coils(void) {
  static const char *const COILS[][3] = {
      {"firing.angle=175deg", "actuator.gap=6mm", "actuator.resistance=92 ohm"},
      {"firing.angle=179.9deg", "actuator.gap=6mm", "actuator.resistance=92 ohm"},
      {"actuator.inductance=0.05H", "actuator.gap=30mm", "actuator.resistance=200 ohm"}};
  for (size_t k = 0; k < COUNT(COILS); k++) {
    double p_min[2], i_peak[2];
    for (int fine = 0; fine < 2; fine++) {
      const char *sets[] = {COILS[k][0],
                            COILS[k][1],
                            COILS[k][2],
                            "firing.every=1",
                            "run.until=0.1s",
                            fine ? "run.tolerance=1e-10" : "run.tolerance=1e-4",
                            NULL};
      vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
      CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
      p_min[fine] = t->result.values[VS_M_GAP_MIN].value;
      i_peak[fine] = t->result.values[VS_M_I_PEAK].value;
      vs_trial_free(t);
    }
    CLOSE(p_min[0], p_min[1], 1e-8);
    CLOSE(i_peak[0], i_peak[1], 1e-8);
    CU_ASSERT(i_peak[1] > 1e-6);
  }
}

/* A gate pulse that is still there when the mains turns forward again fires then, like a diode. */
static void long_pulse_fires_again(void) {
  const char *sets[] = {"firing.pulse_width=18ms", "actuator.gap=60mm", "run.until=0.05s", NULL};
  vs_trial *once = vs_trial_run("paper", "switched", sets, NULL);
  CU_ASSERT_EQUAL_FATAL(once->status, VS_OK);
  CLOSE_OF(once->result.watchers.measures->refired_s, 0.02, 1, 1e-12);
  vs_trial_free(once);
}

/* Steps after an instant go to measures of their own. */
typedef struct late {
  double after_s;
  vs_measures *measures;
} late;

static vs_status watch_late(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  late *l = ctx;
  if (!l->measures) l->measures = vs_measures_new(step->frame, NULL);
  if (step->from->t_s >= l->after_s) vs_measures_accept(l->measures, step);
  return VS_OK;
}

/* Continuous firing after 1500 s, when the slowest mode (58 s) has died to 6e-12: the periodic
 * orbit, as found by Newton on the Poincare map elsewhere; ten digits are printed. */
static void periodic_orbits(void) {
  static const struct {
    const char *angle, *every;
    double p_min, p_max, i_peak, force; /* 0: not known */
  } ROWS[] = {{"firing.angle=90deg", "firing.every=1", -3.557126323e-3, 3.123037779e-3, 0.51250361,
               156.546237},
              {"firing.angle=100deg", "firing.every=1", -2.137732828e-3, 1.922138543e-3, 0.61590926,
               103.472962},
              {"firing.angle=120deg", "firing.every=1", -6.158917571e-4, 5.789630775e-4, 0.50357049,
               38.063948},
              {"firing.angle=90deg", "firing.every=2", -1.718621245e-3, 0, 0, 0},
              {"firing.angle=100deg", "firing.every=2", -1.067308339e-3, 0, 0, 0},
              {"firing.angle=120deg", "firing.every=2", -3.251320325e-4, 0, 0, 0}};
  if (!getenv("VS_LONG")) return;
  FILE *table = fopen("periodic_orbits.csv", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(table);
  fputs("firing,p_min_m,p_max_m,i_peak_a,force_peak_n,error_of_p_min\n", table);
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    late l = {1499.9, NULL};
    vs_observer observer = {&l, watch_late};
    const char *sets[] = {ROWS[k].angle, ROWS[k].every, "run.until=1500s", "run.tolerance=1e-10",
                          NULL};
    vs_trial *t = vs_trial_run("paper", "switched", sets, &observer);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    vs_value v[VS_MEASURES];
    vs_measures_finish(l.measures, v);
    CLOSE(v[VS_M_GAP_MIN].value, ROWS[k].p_min, 1e-9);
    if (ROWS[k].p_max > 0) {
      CLOSE(v[VS_M_GAP_MAX].value, ROWS[k].p_max, 1e-9);
      CLOSE(v[VS_M_I_PEAK].value, ROWS[k].i_peak, 1.1e-8);
      CLOSE(v[VS_M_FORCE_PEAK].value, ROWS[k].force, 1.4e-8); /* eight digits */
    }
    fprintf(table, "%s %s,%.10g,%.10g,%.9g,%.9g,%.1e\n", ROWS[k].angle, ROWS[k].every,
            v[VS_M_GAP_MIN].value, v[VS_M_GAP_MAX].value, v[VS_M_I_PEAK].value,
            v[VS_M_FORCE_PEAK].value, v[VS_M_GAP_MIN].value / ROWS[k].p_min - 1);
    vs_measures_free(l.measures);
    vs_trial_free(t);
  }
  fclose(table);
}

/* Each channel alone, from the parts it says it needs and with nothing else there, is what it is
 * among all. */
static vs_status take_apart(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  double all[VS_CH_MOST], one[VS_CH_MOST], t = (step->from->t_s + 2 * step->to->t_s) / 3;
  long *different = ctx;
  vs_step_at(step, t, all);
  for (int c = 0; c < vs_channel_count(step->frame); c++) {
    for (int k = 0; k < VS_CH_MOST; k++) one[k] = NAN;
    vs_step_groups_at(step, t, vs_channel_groups(step->frame->model, &c, 1), one);
    *different += !(one[c] == all[c]) || !(vs_step_channel(step, t, c) == all[c]);
  }
  return VS_OK;
}
static void parts_make_the_whole(void) {
  for (int k = 0; k < VS_TIERS; k++) {
    long different = 0;
    vs_observer observer = {&different, take_apart};
    const char *sets[] = {"run.until=0.03s", "actuator.stop.stiffness=2e7 N/m",
                          "firing.angle=80deg", NULL};
    vs_trial *t = vs_trial_run("paper", vs_tiers_all[k]->name, sets, &observer);
    EXPECT(t->status == VS_OK, "%s: %s", vs_tiers_all[k]->name, t->err.text);
    EXPECT(different == 0, "%s: %ld values differ", vs_tiers_all[k]->name, different);
    vs_trial_free(t);
  }
}

static const vs_test TESTS[] = {
    {"T0 at 1e-10", analytic_exactly},
    {"T0 at 1e-4", analytic_by_default},
    {"T2 at 1e-10", switched_exactly},
    {"T2 at 1e-4", switched_by_default},
    {"resonance and decay", resonance_and_decay},
    {"independence of the step", result_does_not_depend_on_the_step},
    {"phase control, closed form", phase_control_closed_form},
    {"continuous firing from rest", continuous_firing_from_rest},
    {"periodic orbits (long)", periodic_orbits},
    {"sharp angles", sharp_firing_angles_run},
    {"late firing, quick coils", late_and_quick_coils},
    {"long gate pulse", long_pulse_fires_again},
    {"parts of a step", parts_make_the_whole},
};
VS_SUITE_MAIN("tiers analytic and switched", TESTS)
