/* SPDX-License-Identifier: GPL-3.0-or-later
 * Part a of tools/bench/work_precision: GSL's steppers and the product's exact propagator on one
 * course of the force, the single pulse of tier analytic, over 2 s. GSL's driver chooses the steps
 * (they end where the force begins and ends, and every 10 ms); error: of p, u, w, phi every 10 ms,
 * in parts of each one's peak. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "race.h"

static const char *const SETS[] = {"run.until=2s", "run.sample=10ms", NULL};
enum { ROWS = 201 };
static const double SAMPLE_S = 0.01;

static const vs_scene *scene;
static comparison *reference;

/* Eq. 91: i = I [sin(w t - theta) - exp(-(t - t_f)/tau) sin(w t_f - theta)], F = k_i i^2 */
typedef struct pulse {
  double fires_s, ends_s, omega, theta, tau_s, amplitude_a, force_per_a2;
} pulse;
static pulse force;

static double current(double t_s, double *rate) {
  const pulse *f = &force;
  double decay = exp(-(t_s - f->fires_s) / f->tau_s) * sin(f->omega * f->fires_s - f->theta);
  *rate = f->amplitude_a * (f->omega * cos(f->omega * t_s - f->theta) + decay / f->tau_s);
  return f->amplitude_a * (sin(f->omega * t_s - f->theta) - decay);
}

static void build_force(const vs_setup *s) {
  const vs_actuator_values *coil = &s->model.actuator;
  double reactance = s->timeline.omega_rad_s * coil->inductance_h;
  force = (pulse){.fires_s = s->timeline.firing.angle.first / s->timeline.omega_rad_s,
                  .omega = s->timeline.omega_rad_s,
                  .theta = atan2(reactance, coil->resistance_ohm),
                  .tau_s = coil->inductance_h / coil->resistance_ohm,
                  .amplitude_a = s->timeline.peak_v / hypot(reactance, coil->resistance_ohm)};
  force.force_per_a2 = coil->inductance_h / (2 * s->model.coil.gap_rest_m); /* k_i = a/z(0)^2 */
  force.ends_s = force.fires_s + 0.008;
  for (int k = 0; k < 20; k++) {
    double rate, i = current(force.ends_s, &rate);
    force.ends_s -= i / rate;
  }
}

typedef struct ode {
  const vs_model *model;
  bool driven;
} ode;

static int rates(double t_s, const double x[], double rate[], void *ctx) {
  const ode *o = ctx;
  double slope, i = o->driven ? current(t_s, &slope) : 0;
  memcpy(rate, x + VS_DOF, sizeof(double[VS_DOF]));
  double a[VS_MOST_DOF];
  vs_mechanics_accelerations(o->model, x, x + VS_DOF, force.force_per_a2 * i * i, a);
  memcpy(rate + VS_DOF, a, sizeof(double[VS_DOF]));
  return GSL_SUCCESS;
}

static int jacobian(double t_s, const double x[], double *dfdx, double dfdt[], void *ctx) {
  (void)x;
  const ode *o = ctx;
  double slope = 0, i = o->driven ? current(t_s, &slope) : 0;
  memset(dfdx, 0, sizeof(double[VS_STATES * VS_STATES]));
  for (int r = 0; r < VS_DOF; r++) {
    dfdx[r * VS_STATES + VS_DOF + r] = 1;
    double *row = dfdx + (VS_DOF + r) * VS_STATES;
    for (int c = 0; c < VS_DOF; c++) {
      row[c] = -o->model->mk_column[c][r];
      row[VS_DOF + c] = -o->model->mb_column[c][r];
    }
    dfdt[r] = 0;
    dfdt[VS_DOF + r] = o->model->mf[r] * force.force_per_a2 * 2 * i * slope;
  }
  return GSL_SUCCESS;
}

static double error_at(int row, const double x[VS_STATES]) {
  double worst = 0;
  for (int k = 0; k < VS_DOF; k++) {
    double error = fabs(x[k] - reference->table[row * ORACLE_COLUMNS + k]) / reference->peak[k];
    worst = isnan(error) ? INFINITY : fmax(worst, error);
  }
  return worst;
}

/* From t to `to`, by way of the force's ends. */
static bool march(gsl_odeiv2_driver *d, ode *o, double *t_s, double to_s, double x[VS_STATES]) {
  while (*t_s < to_s) {
    double edge = *t_s < force.fires_s ? force.fires_s : *t_s < force.ends_s ? force.ends_s : 1e9;
    o->driven = *t_s >= force.fires_s && *t_s < force.ends_s;
    if (gsl_odeiv2_driver_apply(d, t_s, fmin(edge, to_s), x)) return false;
    if (*t_s == edge) gsl_odeiv2_driver_reset(d);
  }
  return true;
}

static void run_gsl(attempt *self) {
  static const double TYPICAL[VS_STATES] = {1e-3, 1e-3, 1e-3, 1e-2, 0.3, 0.3, 0.3, 3};
  const gsl_odeiv2_step_type *const *type = self->with;
  ode o = {&scene->setup.model, false};
  gsl_odeiv2_system system = {rates, jacobian, VS_STATES, &o};
  gsl_odeiv2_driver *d = gsl_odeiv2_driver_alloc_scaled_new(&system, *type, 1e-5, self->value,
                                                            self->value, 1, 0, TYPICAL);
  double t = 0, x[VS_STATES] = {0};
  self->error = 0;
  self->steps = 0;
  for (int row = 1; row < ROWS; row++) {
    if (!march(d, &o, &t, row * SAMPLE_S, x)) self->error = INFINITY;
    self->error = fmax(self->error, error_at(row, x));
    if (isinf(self->error)) break;
  }
  self->steps = (long)d->e->count;
  gsl_odeiv2_driver_free(d);
}

static void run_product(attempt *self) {
  vs_scene copy = *scene;
  copy.setup.run.tolerance = self->value;
  race_compare(&copy, reference, &self->steps);
  self->error = 0;
  for (int k = 0; k < VS_DOF; k++) /* p, u, w, phi come first */
    self->error = fmax(self->error, reference->worst[k] / reference->peak[k]);
}

int main(void) {
  static const struct {
    const char *name;
    const gsl_odeiv2_step_type *const *type;
  } TYPES[] = {{"rk4", &gsl_odeiv2_step_rk4},       {"rkf45", &gsl_odeiv2_step_rkf45},
               {"rkck", &gsl_odeiv2_step_rkck},     {"rk8pd", &gsl_odeiv2_step_rk8pd},
               {"rk2imp", &gsl_odeiv2_step_rk2imp}, {"rk4imp", &gsl_odeiv2_step_rk4imp},
               {"bsimp", &gsl_odeiv2_step_bsimp},   {"msadams", &gsl_odeiv2_step_msadams},
               {"msbdf", &gsl_odeiv2_step_msbdf}};
  enum { N_TYPES = sizeof TYPES / sizeof *TYPES, DECADES = 12 };
  gsl_set_error_handler_off();
  vs_scene *own = race_scene("analytic", SETS);
  scene = own;
  build_force(&own->setup);
  oracle_scene o = oracle_of(&own->setup, ORACLE_ANALYTIC);
  reference = compare_with(&o);
  if (!reference) race_give_up("the reference has no solution");
  static attempt list[(N_TYPES + 1) * DECADES];
  size_t n = 0;
  for (size_t k = 0; k < N_TYPES; k++)
    for (int decade = -2; decade > -2 - DECADES; decade--)
      list[n++] = (attempt){TYPES[k].name, pow(10, decade), "tolerance", 0, 0,
                            run_gsl,       TYPES[k].type,   0,           0};
  for (int decade = -2; decade >= -10; decade--)
    list[n++] = (attempt){"product exact propagator",
                          pow(10, decade),
                          "run.tolerance",
                          0,
                          0,
                          run_product,
                          NULL,
                          0,
                          0};
  race r = {"a", list, n, 15, 0.3, 1};
  race_run(&r);
  race_print(&r);
  compare_free(reference);
  vs_scene_free(own);
  free(own);
  return 0;
}
