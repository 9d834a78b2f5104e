/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "oracle.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <string.h>

/* q, q', lambda, and of the snubbed circuit the source's current and both capacitors' voltages */
enum { VELOCITY = 4, FLUX = 8, I_SOURCE, V_C1, V_C2, STATES };
static const double TYPICAL[STATES] = {1e-3, 1e-3, 1e-3, 1e-2, 0.3, 0.3, 0.3, 3, 1, 1, 500, 500};

typedef struct solver {
  const oracle_scene *scene;
  double inverse[4][4], damping[4][4], stiffness[4][4]; /* M^-1, B, K */
  double gap_rest_m, a_hm;
  double omega, period_s, peak_v;
  bool on, touching, gate;
  double v_ak, v_b; /* the circuit's nodes, where Newton's iteration begins */
  gsl_odeiv2_system system;
  gsl_odeiv2_step *step;
  double t_s, y[STATES], h_s;
  oracle_events *events;
} solver;

/* ---- the machine: the mass matrix of Eq. 55 (m34 as derived), springs at their places ---- */

static void invert(double m[4][4], double out[4][4]) {
  memset(out, 0, sizeof(double[4][4]));
  for (int i = 0; i < 4; i++) out[i][i] = 1;
  for (int c = 0; c < 4; c++) { /* M is positive definite: no pivoting */
    double d = m[c][c];
    for (int j = 0; j < 4; j++) m[c][j] /= d, out[c][j] /= d;
    for (int r = 0; r < 4; r++) {
      double f = r == c ? 0 : m[r][c];
      for (int j = 0; j < 4; j++) m[r][j] -= f * m[c][j], out[r][j] -= f * out[c][j];
    }
  }
}

static void springs(const conveyor_values *m, double k, double kx, double ky, double out[4][4]) {
  const double *mount[2] = {m->mount_3_m, m->mount_4_m};
  memset(out, 0, sizeof(double[4][4]));
  out[0][0] = 2 * k;
  for (int n = 0; n < 2; n++) { /* the base moves by u + y phi, w + x phi where it is held */
    double y = m->base_com_m[1] - mount[n][1], x = mount[n][0] - m->base_com_m[0];
    out[1][1] += kx;
    out[1][3] += kx * y;
    out[2][2] += ky;
    out[2][3] += ky * x;
    out[3][3] += kx * y * y + ky * x * x;
  }
  out[3][1] = out[1][3];
  out[3][2] = out[2][3];
}

static void build_machine(solver *s) {
  const conveyor_values *m = &s->scene->machine;
  const vs_load_values *load = &s->scene->load;
  double mk = m->trough_mass_kg + load->fraction * load->density_kg_m3 * load->volume_m3;
  double x = m->trough_com_m[0] - m->base_com_m[0], y = m->trough_com_m[1] - m->base_com_m[1];
  double sine = sin(m->spring_angle_rad), cosine = cos(m->spring_angle_rad);
  double p_phi = m->m14 ? mk * (y * sine + x * cosine) : 0, both = mk + m->base_mass_kg;
  double inertia = m->trough_inertia_kgm2 + m->base_inertia_kgm2 + mk * (x * x + y * y);
  double mass[4][4] = {{mk, -mk * sine, mk * cosine, p_phi},
                       {-mk * sine, both, 0, -mk * y},
                       {mk * cosine, 0, both, mk * x},
                       {p_phi, -mk * y, mk * x, inertia}};
  invert(mass, s->inverse);
  springs(m, m->spring_damping_ns_m, m->mount_damping_x_ns_m, m->mount_damping_y_ns_m, s->damping);
  springs(m, m->spring_stiffness_n_m, m->mount_stiffness_x_n_m, m->mount_stiffness_y_n_m,
          s->stiffness);
}

/* q" under what pushes p, N */
static void accelerate(const solver *s, const double y[], double push_n, double a[4]) {
  double force[4] = {push_n, 0, 0, 0};
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++)
      force[i] -= s->stiffness[i][j] * y[j] + s->damping[i][j] * y[VELOCITY + j];
  for (int i = 0; i < 4; i++) {
    a[i] = 0;
    for (int j = 0; j < 4; j++) a[i] += s->inverse[i][j] * force[j];
  }
}

/* ---- the circuit ---- */

static double mains(const solver *s, double t_s) {
  return s->peak_v * sin(s->omega * t_s + s->scene->supply.phase_rad);
}

static double coil_current(const solver *s, const double y[]) {
  double p = s->scene->kind == ORACLE_ANALYTIC ? 0 : y[0];
  return y[FLUX] * (s->gap_rest_m + p) / (2 * s->a_hm);
}

static double power(double x, double exponent) {
  if (exponent != 30) return pow(x, exponent);
  double x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
  return x8 * x8 * x8 * x4 * x2;
}

/* i = 1 mA sgn(v) (|v|/V)^exponent and its slope */
static double varistor(const oracle_circuit *c, double v, double *slope) {
  double i = 1e-3 * power(fabs(v) / c->varistor_v, c->varistor_exponent);
  *slope = v == 0 ? 0 : c->varistor_exponent * i / fabs(v);
  return copysign(i, v);
}

static double thyristor(const solver *s, double v, double *slope) {
  const oracle_circuit *c = &s->scene->circuit;
  double leak = s->on && !c->leaks_on ? 0 : 1 / c->off_ohm, forward = s->on ? 1 / c->on_ohm : 0;
  *slope = leak + forward;
  return leak * v + forward * (v - c->on_v);
}

/* Kirchhoff at A and B for v_ak and v_b, by Newton's iteration. */
static void solve_nodes(solver *s, const double y[]) {
  const oracle_circuit *c = &s->scene->circuit;
  double i = coil_current(s, y), change = INFINITY;
  for (int n = 0; n < 200 && change > 1e-11; n++) {
    double g_t, g_1, g_2, g_3, v = s->v_ak, b = s->v_b;
    double i_t = thyristor(s, v, &g_t), i_1 = varistor(c, v, &g_1);
    double i_2 = varistor(c, v + b, &g_2), i_3 = varistor(c, b, &g_3);
    double across = i_t + i_1 + (v - y[V_C1]) / c->r1_ohm, g = g_t + g_1 + 1 / c->r1_ohm;
    double at_a = y[I_SOURCE] - across - i_2, at_b = across - i - (b - y[V_C2]) / c->r2_ohm - i_3;
    double g_b = g_3 + 1 / c->r2_ohm; /* [g + g_2, g_2; -g, g_b] (dv, db) = (at_a, at_b) */
    double determinant = (g + g_2) * g_b + g_2 * g;
    double dv = (at_a * g_b - g_2 * at_b) / determinant;
    double db = ((g + g_2) * at_b + g * at_a) / determinant;
    s->v_ak += dv;
    s->v_b += db;
    change = fabs(dv) + fabs(db);
  }
}

static void snubbed_rates(solver *s, double t_s, const double y[], double rate[]) {
  const oracle_scene *o = s->scene;
  const oracle_circuit *c = &o->circuit;
  solve_nodes(s, y);
  double a = s->v_ak + s->v_b;
  rate[FLUX] = s->v_b - o->actuator.resistance_ohm * coil_current(s, y);
  rate[I_SOURCE] =
      (mains(s, t_s) - o->supply.resistance_ohm * y[I_SOURCE] - a) / o->supply.inductance_h;
  rate[V_C1] = (s->v_ak - y[V_C1]) / (c->r1_ohm * c->c1_f);
  rate[V_C2] = (s->v_b - y[V_C2]) / (c->r2_ohm * c->c2_f);
}

/* One loop: u = (R + R_s) i + L_s di/dt + v_ak(i) + dlambda/dt with i = lambda z/(2a). */
static void bare_rates(solver *s, double t_s, const double y[], double rate[]) {
  const oracle_scene *o = s->scene;
  double i = coil_current(s, y), slope, current = thyristor(s, 0, &slope);
  double per_flux = (s->gap_rest_m + y[0]) / (2 * s->a_hm), ls = o->supply.inductance_h;
  s->v_ak = (i - current) / slope; /* a straight line */
  double moves = ls * y[FLUX] * y[VELOCITY] / (2 * s->a_hm);
  double left = mains(s, t_s) - (o->actuator.resistance_ohm + o->supply.resistance_ohm) * i;
  rate[FLUX] = (left - s->v_ak - moves) / (1 + ls * per_flux);
  s->v_b = o->actuator.resistance_ohm * i + rate[FLUX];
}

static int rates(double t_s, const double y[], double rate[], void *ctx) {
  solver *s = ctx;
  memset(rate, 0, sizeof(double[STATES]));
  double push = -y[FLUX] * y[FLUX] / (4 * s->a_hm);
  const vs_actuator_values *coil = &s->scene->actuator;
  if (s->touching)
    push +=
        coil->stop[0].stiffness * (-coil->gap_m - y[0]) - coil->stop[0].damping_ns_m * y[VELOCITY];
  memcpy(rate, y + VELOCITY, sizeof(double[4]));
  accelerate(s, y, push, rate + VELOCITY);
  if (s->scene->kind == ORACLE_SNUBBED)
    snubbed_rates(s, t_s, y, rate);
  else if (s->scene->kind == ORACLE_BARE)
    bare_rates(s, t_s, y, rate);
  else if (s->on)
    rate[FLUX] = mains(s, t_s) - coil->resistance_ohm * coil_current(s, y);
  return GSL_SUCCESS;
}

/* ---- events: each a quantity that falls through zero ---- */

/* What must fall for the thyristor to fire, or to go out; NaN: it cannot. */
static double thyristor_margin(solver *s, double t_s, const double y[]) {
  bool circuit = s->scene->kind == ORACLE_BARE || s->scene->kind == ORACLE_SNUBBED;
  double rate[STATES];
  if (!s->on && !s->gate) return NAN;
  if (circuit) rates(t_s, y, rate, s);
  if (s->on) return circuit ? s->v_ak - s->scene->circuit.on_v : y[FLUX];
  return circuit ? s->scene->circuit.on_v - s->v_ak : -mains(s, t_s);
}

static double stop_margin(solver *s, double t_s, const double y[]) {
  (void)t_s;
  if (!s->scene->actuator.stop[0].present) return NAN;
  double left = y[0] + s->scene->actuator.gap_m;
  return s->touching ? -left : left;
}

typedef double margin(solver *s, double t_s, const double y[]);

static bool try_step(solver *s, double h_s, double y[STATES], double error[STATES]) {
  memcpy(y, s->y, sizeof s->y);
  return !gsl_odeiv2_step_apply(s->step, s->t_s, h_s, y, error, NULL, NULL, &s->system);
}

/* The least length of a step, found to rounding, behind which the margin is below zero; y: the
 * state there. */
static double locate(solver *s, margin *of, double h_s, double y[STATES]) {
  double low = 0, high = h_s, error[STATES], at_low = of(s, s->t_s, s->y),
         at_high = of(s, s->t_s + h_s, y);
  for (int n = 0; n < 100 && high - low > 4e-17 * (1 + s->t_s); n++) {
    double weight = n % 3 == 2 || !(at_low > 0) ? 0.5 : at_low / (at_low - at_high);
    double middle = low + (high - low) * fmin(fmax(weight, 1e-3), 1 - 1e-3), z[STATES];
    if (!try_step(s, middle, z, error)) return NAN;
    double at = of(s, s->t_s + middle, z);
    if (at < 0)
      high = middle, at_high = at, memcpy(y, z, sizeof(double[STATES]));
    else
      low = middle, at_low = at;
  }
  return high;
}

static void note(double *times, size_t *count, double t_s) {
  if (*count < ORACLE_EVENTS) times[*count] = t_s;
  ++*count;
}

static void switch_thyristor(solver *s) {
  s->on = !s->on;
  if (s->on)
    note(s->events->fires_s, &s->events->fired, s->t_s);
  else
    note(s->events->extinct_s, &s->events->ended, s->t_s);
  if (!s->on && (s->scene->kind == ORACLE_SWITCHED || s->scene->kind == ORACLE_ANALYTIC))
    s->y[FLUX] = 0;
  s->h_s = 1e-7;
}

static void switch_stop(solver *s) {
  s->touching = !s->touching;
  if (s->touching) note(s->events->meets_s, &s->events->met, s->t_s);
  s->h_s = 1e-6;
}

/* ---- time ---- */

/* One step, not beyond `to`; it ends at the first event in it. */
static bool advance(solver *s, double to_s) {
  double y[STATES], error[STATES], worst, tolerance = s->scene->tolerance, h;
  for (;;) {
    h = fmin(s->h_s, to_s - s->t_s);
    if (!try_step(s, h, y, error)) return false;
    worst = 0;
    for (int i = 0; i < STATES; i++) worst = fmax(worst, fabs(error[i]) / TYPICAL[i]);
    if (!(worst <= tolerance) && h > 1e-12) {
      s->h_s = h * (worst > 0 ? fmax(0.2, 0.9 * pow(tolerance / worst, 1.0 / 8)) : 0.2);
      continue;
    }
    break;
  }
  bool switches[2] = {thyristor_margin(s, s->t_s + h, y) < 0, stop_margin(s, s->t_s + h, y) < 0};
  if (switches[1]) h = locate(s, stop_margin, h, y);
  if (thyristor_margin(s, s->t_s + h, y) < 0) {
    h = locate(s, thyristor_margin, h, y);
    switches[0] = true;
    switches[1] = stop_margin(s, s->t_s + h, y) < 0;
  } else {
    switches[0] = false;
  }
  if (isnan(h)) return false;
  if (!switches[0] && !switches[1] && h >= s->h_s)
    s->h_s = fmin(h * (worst > 0 ? fmin(4, 0.9 * pow(tolerance / worst, 1.0 / 8)) : 4), 1e-3);
  s->t_s = to_s - s->t_s <= h ? to_s : s->t_s + h;
  memcpy(s->y, y, sizeof s->y);
  s->events->steps++;
  if (switches[0]) switch_thyristor(s);
  if (switches[1]) switch_stop(s);
  return s->gap_rest_m + s->y[0] > 0;
}

/* Leading edge of the gate's pulse number k, s; INFINITY: it has none. */
static double leading_edge(const solver *s, long k) {
  const vs_firing_values *f = &s->scene->firing;
  if (f->every == 0 && k > 0) return INFINITY;
  double turns = 2 * M_PI, zero = fmod(turns - fmod(s->scene->supply.phase_rad, turns), turns);
  double cycles = (double)(f->first_cycle - 1) + (double)k * f->every;
  return (zero + f->angle.first) / s->omega + cycles * s->period_s;
}

static void record(solver *s, double *row) {
  double rate[STATES], slope;
  rates(s->t_s, s->y, rate, s);
  memcpy(row, s->y, sizeof(double[4]));
  row[ORACLE_LAMBDA] = s->y[FLUX];
  row[ORACLE_I] = coil_current(s, s->y);
  row[ORACLE_FORCE] = s->y[FLUX] * s->y[FLUX] / (4 * s->a_hm);
  row[ORACLE_V_AK] = s->v_ak;
  row[ORACLE_V_EVA] = s->v_b;
  row[ORACLE_I_THYRISTOR] = thyristor(s, s->v_ak, &slope);
  row[ORACLE_V_C1] = s->y[V_C1];
  row[ORACLE_V_C2] = s->y[V_C2];
  row[ORACLE_I_SOURCE] = s->y[I_SOURCE];
}

static bool march(solver *s, double *table) {
  const oracle_scene *o = s->scene;
  long pulse = 0;
  for (size_t row = 0; row < o->rows; row++) {
    double sample = (double)row * o->sample_s;
    while (s->t_s < sample) {
      double edge = leading_edge(s, pulse) + (s->gate ? o->firing.pulse_width_s : 0);
      if (!advance(s, fmin(edge, sample))) return false;
      if (s->t_s < edge) continue;
      if (s->gate) pulse++;
      s->gate = !s->gate;
      if (s->gate && !s->on && thyristor_margin(s, s->t_s, s->y) < 0) switch_thyristor(s);
    }
    record(s, table + row * ORACLE_COLUMNS);
  }
  return true;
}

bool oracle_run(const oracle_scene *scene, double *table, oracle_events *events) {
  oracle_scene o = *scene;
  oracle_events own = {.steps = 0};
  if (o.tolerance == 0) o.tolerance = 1e-13;
  solver s = {.scene = &o, .h_s = 1e-7, .events = events ? events : &own};
  *s.events = own;
  build_machine(&s);
  s.gap_rest_m = o.actuator.gap_m + o.actuator.pole_cover_m;
  s.a_hm = o.actuator.inductance_h * s.gap_rest_m / 2;
  s.omega = 2 * M_PI * o.supply.frequency_hz;
  s.period_s = 1 / o.supply.frequency_hz;
  s.peak_v = sqrt(2) * o.supply.voltage_v;
  memcpy(s.y, o.start.x, sizeof(double[VS_STATES]));
  s.touching = o.actuator.stop[0].present && s.y[0] < -o.actuator.gap_m;
  s.system = (gsl_odeiv2_system){rates, NULL, STATES, &s};
  s.step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, STATES);
  bool good = march(&s, table);
  gsl_odeiv2_step_free(s.step);
  return good;
}

/* A value of the deck, by its key in the scene, in SI; NaN: it has none. */
static double deck_value(const vs_setup *setup, const char *key) {
  const vs_section *section = &setup->deck.section;
  for (size_t k = 0; k < section->count; k++)
    if (!strcmp(section->fields[k].key, key))
      return *(const double *)(const void *)((const char *)&setup->circuit_values +
                                             section->fields[k].offset);
  return NAN;
}

oracle_scene oracle_of(const vs_setup *setup, oracle_kind kind) {
  oracle_scene o = {.kind = kind,
                    .machine = conveyor_values_of(&setup->model),
                    .actuator = setup->model.actuator,
                    .load = setup->model.load,
                    .supply = setup->timeline.supply,
                    .firing = setup->timeline.firing,
                    .start = setup->start,
                    .sample_s = setup->run.sample_s,
                    .rows = 1 + (size_t)floor(setup->run.until_s / setup->run.sample_s + 1e-9)};
  if (kind == ORACLE_ANALYTIC || kind == ORACLE_SWITCHED) return o;
  o.circuit = (oracle_circuit){.r1_ohm = deck_value(setup, "r1"),
                               .c1_f = deck_value(setup, "c1"),
                               .r2_ohm = deck_value(setup, "r2"),
                               .c2_f = deck_value(setup, "c2"),
                               .varistor_v = deck_value(setup, "varistor_voltage"),
                               .varistor_exponent = deck_value(setup, "varistor_exponent"),
                               .on_v = deck_value(setup, "on_voltage"),
                               .on_ohm = deck_value(setup, "on_resistance"),
                               .off_ohm = deck_value(setup, "off_resistance"),
                               .leaks_on = true};
  return o;
}
