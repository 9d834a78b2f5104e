/* SPDX-License-Identifier: GPL-3.0-or-later
 * Ideal tiers with laws, stops and machines that are not the conveyor's: the single shots, the
 * shaker and the solenoid of docs/machines_shipped.md. Laws and models are made here, so that the
 * tiers are tested alone. Reference numbers have nine to twelve digits; tolerances say which. */
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "plant/coil.h"
#include "engine/sim.h"
#include "suite.h"
#include "measure/energy.h"

/* ---- models ---- */

/* M^-1 of everything, modes and flags, from M, B, K, c, f0, coil and stops. */
static void finish(vs_model *m, vs_machine *machine) {
  double column[VS_MOST_DOF], l[VS_MOST_DOF * VS_MOST_DOF];
  size_t n = (size_t)m->dof;
  machine->dof = m->dof;
  m->machine = machine;
  for (int i = 0; i < m->dof; i++)
    for (int j = 0; j < m->dof; j++) l[i * m->dof + j] = m->mass[i][j];
  gsl_matrix_view lv = gsl_matrix_view_array(l, n, n);
  gsl_vector_view cv = gsl_vector_view_array(column, n);
  gsl_linalg_cholesky_decomp1(&lv.matrix);
  for (int j = 0; j < 2 * m->dof + 2; j++) {
    int k = j - m->dof, other = j - 2 * m->dof;
    for (int i = 0; i < m->dof; i++)
      column[i] = other == 1   ? m->constant[i]
                  : other == 0 ? -m->along[i]
                  : k >= 0     ? m->stiffness[i][k]
                               : m->damping[i][j];
    gsl_linalg_cholesky_svx(&lv.matrix, &cv.vector);
    memcpy(other == 1   ? m->m0
           : other == 0 ? m->mf
           : k >= 0     ? m->mk_column[k]
                        : m->mb_column[j],
           column, n * sizeof *column);
  }
  m->per_newton_m_s2 = m->fastest_rad_s = m->working_rad_s = 0;
  for (int i = 0; i < m->dof; i++) {
    m->per_newton_m_s2 += m->along[i] * m->mf[i];
    m->loaded = m->loaded || m->constant[i] != 0;
  }
  vs_mode modes[VS_MOST_STATES];
  CU_ASSERT(vs_mechanics_modes(m, modes));
  double drive = 0;
  for (int k = 0; k < 2 * m->dof; k++) {
    double size = hypot(modes[k].re_1_s, modes[k].im_rad_s);
    m->fastest_rad_s = fmax(m->fastest_rad_s, size);
    if (modes[k].drive > drive) drive = modes[k].drive, m->working_rad_s = size;
  }
  m->contact_rad_s = m->fastest_rad_s;
  m->plain = m->coil.square && m->stops.count <= 1;
}

static vs_coil coil_of(const vs_law *law, double a_hm, double gap_m, double r_ohm) {
  return (vs_coil){.law = law,
                   .resistance_ohm = r_ohm,
                   .gap_rest_m = gap_m,
                   .a_hm = a_hm,
                   .rest_h = 2 * a_hm / gap_m};
}

/* ---- what is seen of a run ---- */

enum { SAMPLES = 8, INSTANTS = 8 };
typedef struct peak {
  int channel, sense; /* 0: the largest magnitude */
  double after_s, value, at_s;
} peak;
typedef struct seen {
  vs_energy energy;
  int n_samples, n_events;
  double sample_s[SAMPLES], y[SAMPLES][VS_CH_MOST];
  vs_event event[INSTANTS];
  vs_knot at[INSTANTS];
  peak peaks[4];
  double first, first_s, second, second_s; /* of the travel, after the extinction */
  double extinct_s;
} seen;

/* The largest of sense*channel in a step, by golden section about the largest of 17 samples. */
static double largest(const vs_step *step, int channel, double sense, double *at) {
  double h = step->to->t_s - step->from->t_s, best = -INFINITY, t = 0;
  for (int k = 0; k <= 16; k++) {
    double s = step->from->t_s + h * k / 16, y = vs_step_channel(step, s, channel);
    y = sense == 0 ? fabs(y) : sense * y;
    if (y > best) best = y, t = s;
  }
  double lo = fmax(t - h / 16, step->from->t_s), hi = fmin(t + h / 16, step->to->t_s);
  for (int n = 0; n < 60; n++) {
    double a = lo + 0.382 * (hi - lo), b = lo + 0.618 * (hi - lo);
    double ya = vs_step_channel(step, a, channel), yb = vs_step_channel(step, b, channel);
    bool left = sense == 0 ? fabs(ya) > fabs(yb) : sense * ya > sense * yb;
    if (left)
      hi = b;
    else
      lo = a;
  }
  *at = (lo + hi) / 2;
  double y = vs_step_channel(step, *at, channel);
  return fmax(best, sense == 0 ? fabs(y) : sense * y);
}

static void look_for_turns(seen *s, const vs_step *step) {
  const vs_model *m = step->frame->model;
  double v0 = vs_mechanics_travel(m, step->from->x + m->dof),
         v1 = vs_mechanics_travel(m, step->to->x + m->dof), at, turn;
  if (!(s->extinct_s > 0) || step->from->t_s < s->extinct_s || v0 * v1 > 0 || v0 == 0) return;
  turn = largest(step, VS_CH_TRAVEL, v0 > 0 ? 1 : -1, &at) * (v0 > 0 ? 1 : -1);
  if (s->first_s > 0 && s->second_s > 0) return;
  if (s->first_s > 0)
    s->second = turn, s->second_s = at;
  else
    s->first = turn, s->first_s = at;
}

static vs_status look(void *ctx, const vs_step *step, vs_error *err) {
  seen *s = ctx;
  (void)err;
  vs_energy_accept(&s->energy, step);
  for (int k = 0; k < s->n_samples; k++)
    if (s->sample_s[k] > step->from->t_s && s->sample_s[k] <= step->to->t_s)
      vs_step_at(step, s->sample_s[k], s->y[k]);
  for (size_t k = 0; k < COUNT(s->peaks) && step->to->t_s > step->from->t_s; k++) {
    peak *p = &s->peaks[k];
    double at, y;
    if (!p->channel || step->from->t_s < p->after_s) continue;
    y = largest(step, p->channel, p->sense, &at);
    if (y > p->value) p->value = y, p->at_s = at;
  }
  look_for_turns(s, step);
  if (step->event[0] != VS_EV_NONE && s->n_events < INSTANTS) {
    s->event[s->n_events] = step->event[0];
    s->at[s->n_events++] = *step->to;
  }
  if (step->event[0] == VS_EV_EXTINCT) s->extinct_s = step->to->t_s;
  return VS_OK;
}

static void run(vs_setup *setup, seen *s) {
  const vs_frame frame = vs_sim_frame(&vs_switched_tier, setup);
  const vs_observer observer = {s, look};
  vs_error own = {0};
  for (size_t k = 0; k < COUNT(s->peaks); k++) s->peaks[k].value = -INFINITY;
  s->energy = (vs_energy){.frame = &frame};
  vs_status status = vs_sim_run(&vs_switched_tier, setup, NULL, &observer, &own);
  EXPECT(status == VS_OK, "%s", own.text);
  vs_energy_finish(&s->energy);
}

/* Mains at 50 Hz, fired once at an angle, 0.1 s. */
static void fire(vs_setup *setup, double volt, double angle_deg) {
  vs_error err = {0};
  CU_ASSERT(vs_timeline_build(NULL, NULL, &setup->timeline, NULL, &err) == VS_OK);
  setup->timeline.supply.voltage_v = volt;
  setup->timeline.peak_v = volt * M_SQRT2;
  setup->timeline.firing.angle.first = angle_deg * M_PI / 180;
  setup->run = (vs_run_values){.until_s = 0.1, .sample_s = 1e-4, .tolerance = 1e-7};
}

/* The coil on direct voltage. */
static void step_voltage(vs_setup *setup, double volt, double until_s) {
  fire(setup, volt, 0);
  setup->timeline.supply.direct = 1;
  setup->timeline.peak_v = volt;
  setup->timeline.firing.no_valve = 1;
  setup->run.until_s = until_s;
}

/* ---- laws ---- */

/* Series of powers: i = lambda z/2a (1 + m (|lambda|/ls)^n) + I (|lambda|/ls)^n; here with m = 0 or
 * I = 0, in jets of three derivatives. */
typedef struct iron {
  double flux_wb, n, series_a, product, leakage_h;
} iron;

static void power_jet(const iron *p, const double x[3], double y[3]) {
  double r = fabs(x[0]) / p->flux_wb, n = p->n, s = x[0] < 0 ? -1 : 1;
  double value = pow(r, n), first = n * pow(r, n - 1) / p->flux_wb,
         second = n * (n - 1) * pow(r, n - 2) / (p->flux_wb * p->flux_wb);
  double x1 = s * x[1], x2 = s * x[2];
  y[0] = value, y[1] = first * x1, y[2] = second * x1 * x1 + first * x2;
}

static void gap_jets(const vs_coil *c, const double flux[3], const double z[3], double i[3],
                     double f[3]) {
  const iron *p = c->own;
  double per = 1 / (2 * c->a_hm), r[3], s = flux[0] < 0 ? -1 : 1;
  double w[3] = {flux[0] * z[0] * per, (flux[1] * z[0] + flux[0] * z[1]) * per,
                 (flux[2] * z[0] + 2 * flux[1] * z[1] + flux[0] * z[2]) * per};
  double sq[3] = {flux[0] * flux[0] * per, 2 * flux[0] * flux[1] * per,
                  2 * (flux[1] * flux[1] + flux[0] * flux[2]) * per};
  power_jet(p, flux, r);
  double u[3] = {1 + p->product * r[0], p->product * r[1], p->product * r[2]};
  double h[3] = {0.5 + p->product * r[0] / (p->n + 2), p->product * r[1] / (p->n + 2),
                 p->product * r[2] / (p->n + 2)};
  i[0] = w[0] * u[0] + s * p->series_a * r[0];
  i[1] = w[1] * u[0] + w[0] * u[1] + s * p->series_a * r[1];
  i[2] = w[2] * u[0] + 2 * w[1] * u[1] + w[0] * u[2] + s * p->series_a * r[2];
  f[0] = sq[0] * h[0];
  f[1] = sq[1] * h[0] + sq[0] * h[1];
  f[2] = sq[2] * h[0] + 2 * sq[1] * h[1] + sq[0] * h[2];
}

/* The gap's own flux linkage, lambda_g + L_k i(lambda_g, z) = lambda, by Newton's iteration. */
static double own_flux(const vs_coil *c, double flux, double z) {
  const iron *p = c->own;
  double g = flux, i[3], f[3];
  for (int n = 0; n < 60 && p->leakage_h > 0; n++) {
    const double x[3] = {g, 1, 0}, zz[3] = {z, 0, 0};
    gap_jets(c, x, zz, i, f);
    double off = g + p->leakage_h * i[0] - flux;
    g -= off / (1 + p->leakage_h * i[1]);
    if (fabs(off) <= 1e-16 * fabs(flux)) break;
  }
  return g;
}
static void iron_along(const vs_coil *c, const double flux[3], const double z[3], double i[3],
                       double f[3]) {
  const iron *p = c->own;
  double g[3] = {own_flux(c, flux[0], z[0]), 0, 0}, unit[3], none[3] = {z[0], 0, 0};
  gap_jets(c, (double[]){g[0], 1, 0}, none, unit, f);
  double slope = 1 + p->leakage_h * unit[1]; /* d lambda/d lambda_g */
  for (int k = 1; k < 3; k++) { /* order by order: the new term enters by the slope alone */
    gap_jets(c, g, z, i, f);
    g[k] = (flux[k] - p->leakage_h * i[k]) / slope;
  }
  gap_jets(c, g, z, i, f);
}
static double iron_current(const vs_coil *c, double flux, double z) {
  double i[3], f[3];
  gap_jets(c, (double[]){own_flux(c, flux, z), 0, 0}, (double[]){z, 0, 0}, i, f);
  return i[0];
}
static double iron_force(const vs_coil *c, double flux, double z) {
  double i[3], f[3];
  gap_jets(c, (double[]){own_flux(c, flux, z), 0, 0}, (double[]){z, 0, 0}, i, f);
  return f[0];
}
static double iron_energy(const vs_coil *c, double flux, double z) {
  const iron *p = c->own;
  double g = own_flux(c, flux, z), r = pow(fabs(g) / p->flux_wb, p->n),
         i = iron_current(c, flux, z);
  return g * g * z / (2 * c->a_hm) * (0.5 + p->product * r / (p->n + 2)) +
         p->series_a * fabs(g) * r / (p->n + 1) + p->leakage_h * i * i / 2;
}
static const vs_law IRON = {.name = "iron",
                            .poles = true,
                            .current = iron_current,
                            .force = iron_force,
                            .energy = iron_energy,
                            .along = iron_along};

/* ---- single shots of Table 1's conveyor with saturation and leakage ---- */

typedef struct shot {
  double i_peak, i_s, f_peak, t_ext, first, first_s, second, g_end, e_in, e_cu;
} shot;

static void expect_shot(vs_setup *setup, const shot *want) {
  seen s = {.peaks = {{VS_CH_I, 0, 0, 0, 0}, {VS_CH_FORCE, 0, 0, 0, 0}},
            .n_samples = 1,
            .sample_s = {0.1}};
  run(setup, &s);
  CLOSE(s.peaks[0].value, want->i_peak, 1e-9);
  CLOSE(s.peaks[0].at_s, want->i_s, 1e-8); /* a top is found to the root of rounding */
  CLOSE(s.peaks[1].value, want->f_peak, 1e-9);
  CLOSE(s.extinct_s, want->t_ext, 1e-10);
  CLOSE(s.first, want->first, 1e-9);
  CLOSE(s.first_s, want->first_s, 1e-7);
  CLOSE(s.second, want->second, 1e-9);
  CLOSE(s.y[0][VS_CH_TRAVEL], want->g_end, 1e-9);
  CLOSE(s.energy.joule[VS_E_SOURCE], want->e_in, 1e-9);
  CLOSE(s.energy.joule[VS_E_COPPER], want->e_cu, 1e-9);
  CLOSE_OF(s.energy.worst, 0, 1, 1e-8);
}

/* The conveyor of Table 1 as scenes build it, with another law. */
static void conveyor_shot(const iron *own, const shot *want) {
  vs_error err = {0};
  vs_setup setup = {0};
  CU_ASSERT(vs_setup_build(NULL, &setup, &err) == VS_OK);
  setup.run.until_s = 0.1;
  setup.means = (vs_span_s){0, 0.1};
  setup.run.tolerance = 1e-7;
  iron law = *own;
  setup.model.coil.law = &IRON;
  setup.model.coil.own = &law;
  setup.model.coil.square = setup.model.plain = false;
  expect_shot(&setup, want);
  vs_setup_free(&setup);
}

static void saturation_and_leakage(void) {
  conveyor_shot(&(iron){1.2, 7, 0.2, 0, 0},
                &(shot){1.2884797007, 0.00934100892, 88.635095317, 0.013617686556, -0.001296558,
                        0.0139218354, 0.0012677986356, -0.00075217313145, 0.5157028251,
                        0.4421181214});
  conveyor_shot(&(iron){1.5, 6, 0, 1, 0},
                &(shot){1.264466234, 0.00931648797, 101.21092622, 0.013629717245, -0.0014123810503,
                        0.0139257756, 0.0013810970804, -0.00081816469135, 0.5154860345,
                        0.4281561778});
  conveyor_shot(&(iron){1.2, 7, 0.2, 0, 0.15},
                &(shot){1.0125937925, 0.00946408396, 74.847781157, 0.013727115868, -0.0011285110331,
                        0.0140128642, 0.0011034412318, -0.00063148180291, 0.3722316814,
                        0.3164929452});
}

/* ---- two masses, and one: the plain law, by series and by steps ---- */

static void two_masses(vs_setup *setup) {
  vs_model *m = &setup->model;
  *m = (vs_model){.dof = 2, .along = {1, -1}};
  m->mass[0][0] = 6, m->mass[1][1] = 10;
  m->damping[0][0] = 20, m->damping[0][1] = m->damping[1][0] = -20, m->damping[1][1] = 40;
  m->stiffness[0][0] = 4.2e5, m->stiffness[0][1] = m->stiffness[1][0] = -4.2e5;
  m->stiffness[1][1] = 4.4e5;
  m->coil = coil_of(&IRON, 4.6e-4, 2e-3, 12);
  m->actuator.resistance_ohm = 12, m->actuator.gap_m = 2e-3;
  fire(setup, 230, 110);
}
static void one_mass(vs_setup *setup) {
  vs_model *m = &setup->model;
  *m = (vs_model){.dof = 1, .along = {1}};
  m->mass[0][0] = 0.83, m->damping[0][0] = 2.4, m->stiffness[0][0] = 86000;
  m->coil = coil_of(&IRON, 5.2e-3, 6.5e-3, 92);
  m->actuator.resistance_ohm = 92, m->actuator.gap_m = 6e-3;
  fire(setup, 440, 100);
}

static void other_machines(void) {
  static const shot TWO = {1.317153444,       0.00955441597, 222.73355935,     0.013640301681,
                           -0.00060634592841, 0.0145155118,  0.00058891881562, 0.00042644571322,
                           0.1561023054,      0.07687320797},
                    ONE = {0.84755834705,    0.00937555595, 95.678944449,    0.01376446144,
                           -0.0013273743082, 0.0144932696,  0.0013087757128, 0.00085414580034,
                           0.3456225057,     0.2691431102};
  iron none = {1, 2, 0, 0, 0};
  for (int square = 0; square < 2; square++)
    for (int one = 0; one < 2; one++) {
      vs_setup setup = {0};
      vs_machine machine = {.dof = 0};
      if (one)
        one_mass(&setup);
      else
        two_masses(&setup);
      setup.model.coil.own = &none;
      setup.model.coil.square = square;
      finish(&setup.model, &machine);
      expect_shot(&setup, one ? &ONE : &TWO);
    }
}

/* ---- the shaker: i = (lambda - k1 g)/L, F = -k2 i along x ---- */

static const double K1 = 95.10e-3 / 0.0254, K2 = 0.8416 * 4.4482216152605, L_COIL = 764e-6;

static double shaker_current(const vs_coil *c, double flux, double z) {
  return (flux - K1 * (z - c->gap_rest_m)) / L_COIL;
}
static double shaker_force(const vs_coil *c, double flux, double z) {
  return -K2 * shaker_current(c, flux, z);
}
static double shaker_energy(const vs_coil *c, double flux, double z) {
  double i = shaker_current(c, flux, z);
  return L_COIL * i * i / 2;
}
static void shaker_along(const vs_coil *c, const double flux[3], const double z[3], double i[3],
                         double f[3]) {
  for (int k = 0; k < 3; k++) {
    i[k] = (flux[k] - K1 * (z[k] - (k ? 0 : c->gap_rest_m))) / L_COIL;
    f[k] = -K2 * i[k];
  }
}
static const vs_law SHAKER = {.name = "shaker",
                              .current = shaker_current,
                              .force = shaker_force,
                              .energy = shaker_energy,
                              .along = shaker_along};

static void shaker(vs_setup *setup, vs_machine *machine, bool piece) {
  const double lb = 4.4482216152605, in = 0.0254;
  vs_model *m = &setup->model;
  *m = (vs_model){.dof = piece ? 2 : 1, .along = {1}};
  double k = 16.54 * lb / in;
  m->mass[0][0] = 178.04e-6 * lb / in;
  m->damping[0][0] = 39.09e-3 * lb / in;
  m->stiffness[0][0] = k;
  if (piece) {
    m->mass[1][1] = 0.7;
    m->stiffness[0][0] += 5000;
    m->stiffness[0][1] = m->stiffness[1][0] = -5000;
    m->stiffness[1][1] = 5000 + 0.7 * pow(40 * M_PI, 2);
  }
  m->coil = (vs_coil){.law = &SHAKER, .resistance_ohm = 1.6, .gap_rest_m = 0.01, .rest_h = L_COIL};
  m->actuator.resistance_ohm = 1.6, m->actuator.gap_m = 0.01;
  finish(m, machine);
}

static void shaker_on_a_step(void) {
  static const double WANT[3][4] = {{0.001, 0.000127862768692, 0.319395303456, 4.20408662937},
                                    {0.005, 0.00314544357825, 0.823797149213, 3.23981706413},
                                    {0.02, 0.00677011695283, 0.0025854053243, 5.2177005625}};
  vs_setup setup = {0};
  vs_machine machine = {.dof = 0};
  shaker(&setup, &machine, false);
  step_voltage(&setup, 8.36501901140684, 0.05);
  seen s = {.n_samples = 3, .sample_s = {0.001, 0.005, 0.02}, .peaks = {{VS_CH_Q, 1, 0, 0, 0}}};
  run(&setup, &s);
  for (int k = 0; k < 3; k++) {
    CLOSE(s.y[k][VS_CH_Q], WANT[k][1], 1e-9);
    CLOSE_OF(s.y[k][VS_CH_Q + 1], WANT[k][2], 1, 1e-9);
    CLOSE(s.y[k][VS_CH_I], WANT[k][3], 1e-9);
  }
  CLOSE(s.peaks[0].value, 0.0067714270409, 1e-9);
  CLOSE(s.peaks[0].at_s, 0.021128094382, 1e-7);
  shaker(&setup, &machine, true);
  step_voltage(&setup, 8.36501901140684, 0.02);
  s = (seen){.n_samples = 1, .sample_s = {0.02}, .peaks = {{VS_CH_Q, 1, 0, 0, 0}}};
  setup.run.until_s = 0.021;
  run(&setup, &s);
  CLOSE(s.y[0][VS_CH_Q], 0.00337987581161, 1e-9);
  CLOSE(s.y[0][VS_CH_Q + 1], 0.00159611819105, 1e-9);
  CLOSE(s.y[0][VS_CH_I], 5.05053281949, 1e-9);
}

/* ---- the solenoid ---- */

/* A quantity with its first two derivatives in time. */
typedef struct jet {
  double d[3];
} jet;
static jet sum(jet a, jet b) {
  return (jet){{a.d[0] + b.d[0], a.d[1] + b.d[1], a.d[2] + b.d[2]}};
}
static jet times(double x, jet a) {
  return (jet){{x * a.d[0], x * a.d[1], x * a.d[2]}};
}
static jet product(jet a, jet b) {
  return (jet){{a.d[0] * b.d[0], a.d[1] * b.d[0] + a.d[0] * b.d[1],
                a.d[2] * b.d[0] + 2 * a.d[1] * b.d[1] + a.d[0] * b.d[2]}};
}
static jet number(double x) {
  return (jet){{x, 0, 0}};
}
/* A function of a, of value f and derivatives f1, f2 there. */
static jet chain(jet a, double f, double f1, double f2) {
  return (jet){{f, f1 * a.d[1], f2 * a.d[1] * a.d[1] + f1 * a.d[2]}};
}
static jet over(jet a, jet b) {
  double x = b.d[0];
  return product(a, chain(b, 1 / x, -1 / (x * x), 2 / (x * x * x)));
}
static jet logarithm(jet a) {
  double x = a.d[0];
  return chain(a, log(x), 1 / x, -1 / (x * x));
}
static jet power(jet a, double n) {
  double x = a.d[0];
  return chain(a, pow(x, n), n * pow(x, n - 1), n * (n - 1) * pow(x, n - 2));
}

static const double MU0 = 4e-7 * M_PI * 1.00000000055, TURNS = 957;
static const double RADIUS = 5e-3, WIDTH = 2 * M_PI * 6.5e-3, DEPTH = 3e-3;

/* H l of the iron over Phi. */
static jet iron_drop(jet phi) {
  static const double PART[5][2] = {{1.343030859410e-4, 4.263590029872e-3},
                                    {25e-6 * M_PI, 3.510159389486e-3},
                                    {25e-6 * M_PI, 1.208304866765e-2},
                                    {2.105652476069e-4, 2.524717179043e-2},
                                    {2.034181243199e-4, 2.214055808678e-2}};
  jet all = number(0), size = times(phi.d[0] < 0 ? -1 : 1, phi);
  for (int j = 0; j < 5; j++) {
    jet b = times(1 / (1.488 * PART[j][0]), size);
    jet top = sum(number(399), times(1200, b));
    jet under = sum(number(1), sum(times(3, b), power(b, 12.5)));
    jet mu = sum(number(1), over(top, under));
    all = sum(all, times(1 / (MU0 * PART[j][1]), over(phi, mu)));
  }
  return all;
}

static jet gap_permeance(jet z) {
  jet fringe = logarithm(sum(number(1), over(number(M_PI * DEPTH), z)));
  return times(MU0, sum(over(number(M_PI * RADIUS * RADIUS), z), times(WIDTH / M_PI, fringe)));
}
/* dG/dz = -mu0 (pi r^2/z^2 + w rho/(z (z + pi rho))) */
static jet permeance_slope(jet z) {
  jet zz = product(z, z), far = product(z, sum(z, number(M_PI * DEPTH)));
  return times(-MU0,
               sum(over(number(M_PI * RADIUS * RADIUS), zz), over(number(WIDTH * DEPTH), far)));
}

static jet solenoid_i(jet flux, jet z) {
  jet phi = times(1 / TURNS, flux);
  jet air = sum(over(phi, gap_permeance(z)), times(1 / 3.0319757963e-7, phi));
  return times(1 / TURNS, sum(air, iron_drop(phi)));
}
static jet solenoid_f(jet flux, jet z) {
  jet drop = over(times(1 / TURNS, flux), gap_permeance(z));
  return times(-0.5, product(product(drop, drop), permeance_slope(z)));
}
static void solenoid_along(const vs_coil *c, const double flux[3], const double z[3], double i[3],
                           double f[3]) {
  jet l = {{flux[0], flux[1], flux[2]}}, zz = {{z[0], z[1], z[2]}};
  (void)c;
  memcpy(i, solenoid_i(l, zz).d, sizeof l.d);
  memcpy(f, solenoid_f(l, zz).d, sizeof l.d);
}
static double solenoid_current(const vs_coil *c, double flux, double z) {
  (void)c;
  return solenoid_i(number(flux), number(z)).d[0];
}
static double solenoid_force(const vs_coil *c, double flux, double z) {
  (void)c;
  return solenoid_f(number(flux), number(z)).d[0];
}
/* The integral of i, by Simpson's rule in 400 parts. */
static double solenoid_energy(const vs_coil *c, double flux, double z) {
  double w = 0;
  enum { PARTS = 400 };
  for (int k = 0; k <= PARTS; k++)
    w += (k == 0 || k == PARTS ? 1 : k % 2 ? 4 : 2) * solenoid_current(c, flux * k / PARTS, z);
  return w * flux / PARTS / 3;
}
static const vs_law SOLENOID = {.name = "solenoid",
                                .current = solenoid_current,
                                .force = solenoid_force,
                                .energy = solenoid_energy,
                                .along = solenoid_along};

static vs_stop stop_of(int kind, int side, double at_m, double stiffness, double damping_ns_m) {
  return (vs_stop){.kind = vs_stop_kinds[kind],
                   .side = side,
                   .at_m = at_m,
                   .stiffness = stiffness,
                   .damping_ns_m = damping_ns_m,
                   .scale_m = fabs(at_m),
                   .deepest_m = 0.25e-3};
}

static void solenoid(vs_setup *setup, vs_machine *machine, const vs_stop *stop) {
  vs_model *m = &setup->model;
  *m = (vs_model){.dof = 1, .along = {1}};
  m->mass[0][0] = 0.0260361026206;
  m->coil = (vs_coil){.law = &SOLENOID, .resistance_ohm = 10, .gap_rest_m = 5e-3, .rest_h = 0.035};
  m->actuator.resistance_ohm = 10, m->actuator.gap_m = 4.75e-3;
  m->stops.count = 1;
  m->stops.item[0] = *stop;
  finish(m, machine);
  step_voltage(setup, 12, 0.0205);
}

static void solenoid_pulls_in(void) {
  static const double WANT[3][5] = {
      {0.008, 0.003746295142, 0.0350100584, 0.9936220385, 3.090742444},
      {0.012, 0.0006067959254, 0.04930137236, 0.5092345686, 8.955993363},
      {0.02, 0.0002294630206, 0.09839182456, 0.7239651584, 42.58175755}};
  const vs_stop stop = stop_of(1, 1, -4.75e-3, 1e11, 400);
  vs_setup setup = {0};
  vs_machine machine = {.dof = 0};
  solenoid(&setup, &machine, &stop);
  CLOSE(solenoid_current(NULL, 0.133083219405, 0.25e-3), 1.2, 1e-11);
  CLOSE(solenoid_force(NULL, 0.034717862614, 5e-3), 2.91620922713, 1e-11);
  seen s = {.n_samples = 3, .sample_s = {0.008, 0.012, 0.02}};
  run(&setup, &s);
  for (int k = 0; k < 3; k++) {
    CLOSE(s.y[k][VS_CH_Z], WANT[k][1], 1e-9);
    CLOSE(s.y[k][VS_CH_LAMBDA], WANT[k][2], 1e-9);
    CLOSE(s.y[k][VS_CH_I], WANT[k][3], 1e-9);
    CLOSE(s.y[k][VS_CH_FORCE], WANT[k][4], 1e-9);
  }
  EXPECT(s.n_events >= 2 && s.event[0] == VS_EV_MEETS_STOP && s.event[1] == VS_EV_LEAVES_STOP,
         "%d events", s.n_events);
  CLOSE(s.at[0].t_s, 0.012281796804, 1e-10);
  CLOSE(s.at[0].x[1], -1.322846269, 1e-9);
  CLOSE(s.at[0].flux_wb, 0.05141216523, 1e-9);
  CLOSE(s.at[1].t_s, 0.01251481158, 1e-9);
  CLOSE(s.at[1].x[1], 0.5431756923, 1e-8);
  CLOSE(s.at[1].flux_wb, 0.05334013467, 1e-9);
  CLOSE_OF(s.energy.worst, 0, 1, 1e-7);
  s = (seen){.peaks = {{VS_CH_I, 1, 0, 0, 0}}};
  run(&setup, &s);
  CLOSE(s.peaks[0].at_s, 0.0069357041473, 1e-7);
}

static void solenoid_on_springs(void) {
  const vs_stop stop = stop_of(0, 1, -4.75e-3, 1e6, 200);
  vs_setup setup = {0};
  vs_machine machine = {.dof = 0};
  solenoid(&setup, &machine, &stop);
  setup.run.until_s = 0.013;
  seen s = {.n_samples = 2, .sample_s = {0.0124, 0.0128}};
  run(&setup, &s);
  CLOSE(s.y[0][VS_CH_Z], 0.00015374624399, 1e-9);
  CLOSE(s.y[1][VS_CH_Z], 0.00021442815682, 1e-9);
}

/* ---- the shaker at 20 Hz, and a free mass between two stops ---- */

/* Behind 2 s, 60 of the slowest time constants, amplitude and phase are those of the closed form:
 * a, b of a cos + b sin by three samples of the last cycles. */
static void shaker_at_20_hz(void) {
  static const double WANT[3][2] = {{0.000741108559377, -41.8256602464},
                                    {0.0931304482261, 48.1743397536},
                                    {0.505505110323, -22.1379507081}};
  vs_setup setup = {0};
  vs_machine machine = {.dof = 0};
  shaker(&setup, &machine, false);
  fire(&setup, M_SQRT1_2, 90);
  setup.timeline.firing.no_valve = 1;
  setup.timeline.supply.frequency_hz = 20;
  setup.timeline.omega_rad_s = 40 * M_PI;
  setup.timeline.period_s = 0.05;
  setup.run.until_s = 2.01;
  seen s = {.n_samples = 2, .sample_s = {2, 2 - 0.0125}};
  run(&setup, &s);
  const int channel[3] = {VS_CH_Q, VS_CH_Q + 1, VS_CH_I};
  for (int k = 0; k < 3; k++) { /* u = sin: y = A sin(wt + phase); wt = 0 and -90 degrees */
    double sine = s.y[0][channel[k]], minus_cosine = s.y[1][channel[k]];
    CLOSE(hypot(sine, minus_cosine), WANT[k][0], 1e-9);
    CLOSE_OF(atan2(sine, -minus_cosine) * 180 / M_PI, WANT[k][1], 57.3, 1e-9);
  }
}

/* A mass between an undamped stop on either side, without springs and without current, thrown at
 * them: half a period in each stop, pi sqrt(m/k), and flights of equal length between. A third stop
 * deeper in the first one is never reached. */
static void between_two_stops(void) {
  vs_setup setup = {0};
  vs_machine machine = {.dof = 0};
  vs_model *m = &setup.model;
  iron none = {1, 2, 0, 0, 0};
  *m = (vs_model){.dof = 1, .along = {1}};
  m->mass[0][0] = 0.02;
  m->coil = coil_of(&IRON, 5e-3, 5e-3, 10);
  m->coil.own = &none;
  m->coil.square = true;
  m->actuator.resistance_ohm = 10, m->actuator.gap_m = 4e-3;
  m->stops.count = 3;
  m->stops.item[0] = stop_of(0, 1, -2e-3, 2e5, 0);
  m->stops.item[1] = stop_of(0, -1, 1e-3, 2e5, 0);
  m->stops.item[2] = stop_of(0, 1, -3e-3, 2e5, 0);
  finish(m, &machine);
  step_voltage(&setup, 0, 0.02);
  setup.start.x[1] = -1;
  seen s = {.n_samples = 1, .sample_s = {0.02}};
  run(&setup, &s);
  double inside = M_PI * sqrt(0.02 / 2e5), t = 0.002;
  CU_ASSERT(s.n_events == INSTANTS || s.n_events == 7);
  for (int k = 0; k < 7; k++) {
    EXPECT(s.event[k] == (k % 2 ? VS_EV_LEAVES_STOP : VS_EV_MEETS_STOP), "event %d", k);
    CLOSE(s.at[k].t_s, t, 1e-12);
    CLOSE(fabs(s.at[k].x[1]), 1, 1e-9);
    t += k % 2 ? 0.003 : inside;
  }
}

/* A chain of as many masses as there may be, of which the first has the coil: the books close. */
static void sixteen_masses(void) {
  vs_setup setup = {0};
  vs_machine machine = {.dof = 0};
  vs_model *m = &setup.model;
  iron own = {1.2, 7, 0.2, 0, 0};
  *m = (vs_model){.dof = VS_MOST_DOF, .along = {1}};
  for (int i = 0; i < VS_MOST_DOF; i++) {
    m->mass[i][i] = 0.83;
    for (int j = i > 0 ? i - 1 : 0; j <= i + 1 && j < VS_MOST_DOF; j++) {
      m->stiffness[i][j] = (i == j ? 2.1 : -1) * 86000;
      m->damping[i][j] = (i == j ? 2.1 : -1) * 2.4;
    }
  }
  m->coil = coil_of(&IRON, 5.2e-3, 6.5e-3, 92);
  m->coil.own = &own;
  m->actuator.resistance_ohm = 92, m->actuator.gap_m = 6e-3;
  finish(m, &machine);
  fire(&setup, 440, 100);
  seen s = {.n_samples = 0};
  run(&setup, &s);
  CLOSE_OF(s.energy.worst, 0, 1, 1e-9);
  CU_ASSERT(s.extinct_s > 0.013);
}

static const vs_test TESTS[] = {{"saturation and leakage", saturation_and_leakage},
                                {"two masses and one", other_machines},
                                {"shaker", shaker_on_a_step},
                                {"solenoid", solenoid_pulls_in},
                                {"solenoid, linear stop", solenoid_on_springs},
                                {"shaker at 20 Hz", shaker_at_20_hz},
                                {"between two stops", between_two_stops},
                                {"sixteen masses", sixteen_masses}};
VS_SUITE_MAIN("laws on ideal tiers", TESTS)
