/* SPDX-License-Identifier: GPL-3.0-or-later
 * Phase control of R-L, closed form: what the analytic tier must give of the current. */
#include <gsl/gsl_integration.h>
#include <gsl/gsl_roots.h>
#include <math.h>
#include <stdlib.h>

#include "validate/experiment.h"

/* i(x) = U sqrt2/Z (sin(x - theta) - sin(alpha - theta) exp(-(x - alpha)/tan theta)), x from alpha
 * to beta, where it is zero again (Eq. 91). */
typedef struct pulse {
  double alpha, theta; /* rad */
  double peak_a;       /* U sqrt2/Z */
} pulse;

static double current_of_rl(double x, void *ctx) {
  const pulse *p = ctx;
  double fade = exp(-(x - p->alpha) / tan(p->theta));
  return p->peak_a * (sin(x - p->theta) - sin(p->alpha - p->theta) * fade);
}

static double slope(double x, void *ctx) {
  const pulse *p = ctx;
  double tangent = tan(p->theta), fade = exp(-(x - p->alpha) / tangent);
  return p->peak_a * (cos(x - p->theta) + sin(p->alpha - p->theta) * fade / tangent);
}

static double square(double x, void *ctx) {
  return pow(current_of_rl(x, ctx), 2);
}

static double root_of(double (*function)(double, void *), pulse *p, double lo, double hi) {
  gsl_function f = {function, p};
  gsl_root_fsolver *solver = vs_checked(gsl_root_fsolver_alloc(gsl_root_fsolver_brent));
  double root = NAN;
  if (!gsl_root_fsolver_set(solver, &f, lo, hi)) {
    for (int n = 0; n < 100 && !gsl_root_fsolver_iterate(solver); n++)
      if (gsl_root_fsolver_x_upper(solver) - gsl_root_fsolver_x_lower(solver) < 1e-14) break;
    root = gsl_root_fsolver_root(solver);
  }
  gsl_root_fsolver_free(solver);
  return root;
}

static double integral_of(double (*function)(double, void *), pulse *p, double lo, double hi) {
  gsl_function f = {function, p};
  double sum = NAN, error;
  size_t calls;
  return gsl_integration_qng(&f, lo, hi, 0, 1e-12, &sum, &error, &calls) ? NAN : sum;
}

/* The closed form with the numbers of the experiment's scene, over one period. */
static vs_status perform_closed_form(const vs_experiment *e, const vs_observer *also,
                                     vs_numbers *out, vs_error *err) {
  (void)also;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_experiment_scene(e, NULL, scene, err);
  if (!status) {
    const vs_timeline *line = &scene->setup.timeline;
    const vs_actuator_values *coil = &scene->setup.model.actuator;
    double x_ohm = line->omega_rad_s * coil->inductance_h, r_ohm = coil->resistance_ohm;
    pulse p = {line->firing.angle.first, atan2(x_ohm, r_ohm), line->peak_v / hypot(x_ohm, r_ohm)};
    double beta = root_of(current_of_rl, &p, fmax(p.alpha, p.theta) + 0.1, 2 * M_PI);
    vs_experiment_add(out, beta / line->omega_rad_s, "t_extinction");
    vs_experiment_add(out, (beta - p.alpha) / line->omega_rad_s, "conduction_time");
    vs_experiment_add(out, current_of_rl(root_of(slope, &p, p.alpha, beta), &p), "i_peak");
    vs_experiment_add(out, integral_of(current_of_rl, &p, p.alpha, beta) / (2 * M_PI), "i_mean");
    vs_experiment_add(out, sqrt(integral_of(square, &p, p.alpha, beta) / (2 * M_PI)), "i_rms");
  }
  vs_scene_free(scene);
  free(scene);
  return status;
}

#define AT(degrees)                                                                                \
  static const vs_experiment closed_##degrees = {.perform = perform_closed_form,                   \
                                                 .sets = {"firing.angle=" #degrees "deg", NULL}},  \
                             analytic_##degrees = {.perform = vs_experiment_perform,               \
                                                   .wall_s = 0.01,                                 \
                                                   .tier = "analytic",                             \
                                                   .sets = {"firing.angle=" #degrees "deg",        \
                                                            "run.until=0.02s",                     \
                                                            "run.tolerance=1e-10", NULL}}
AT(80);
AT(100);
AT(120);
AT(150);

#define ONE_AT(degrees, text, unit, what)                                                          \
  {                                                                                                \
    "phase control of R-L at " #degrees " deg: " text, unit, &analytic_##degrees, what, 0,         \
        &closed_##degrees, 1e-9, 0, "closed form, Eq. 91", "ten times run.tolerance, 1e-10"        \
  }
#define ALL_AT(degrees)                                                                            \
  ONE_AT(degrees, "extinction", "s", "t_extinction"),                                              \
      ONE_AT(degrees, "conduction", "s", "conduction_time"),                                       \
      ONE_AT(degrees, "peak current", "A", "i_peak"),                                              \
      ONE_AT(degrees, "mean current", "A", "i_mean"), ONE_AT(degrees, "rms current", "A", "i_rms")

static const vs_comparison COMPARISONS[] = {ALL_AT(80), ALL_AT(100), ALL_AT(120), ALL_AT(150)};
const vs_comparisons vs_phase_control_comparisons = {COMPARISONS,
                                                     sizeof COMPARISONS / sizeof *COMPARISONS};
