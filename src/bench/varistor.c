/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a varistor, a Zener diode or a TVS, tried: its voltage at some
 * currents.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "test_circuit.h"

/* The voltage at a constant current, once the capacitance is charged. The current rises within a
 * fifth of the run, as its leads' inductance, and formulas with powers of it, bear no step. The
 * first run charges 50 uC, which is 25 nF at 2 kV; where the voltage still changes by 0.01 % in its
 * last tenth, or ngspice gives up, longer ones follow, as a rise within nanoseconds makes the
 * model's leads ring. */
static vs_status voltage_at(const vs_stand *s, double i, double *v, vs_error *err) {
  vs_status status = VS_OK;
  bool settled = false, go_on = true;
  char source[96];
  for (double until_s = 50e-6 / i; go_on && !settled && until_s < 5 / i; until_s *= 10) {
    vs_stand_record r = {0};
    *err = (vs_error){.findings = err->findings};
    snprintf(source, sizeof source, "Is 0 m pwl(0 0 %.17g %.17g)", until_s / 5, i);
    status = vs_test_circuit_across(s, (vs_stand_circuit){source, until_s, until_s / 400, 1e-6}, &r,
                                    err);
    go_on = !status || err->gave_up;
    *v = status ? NAN : vs_stand_at(&r, r.v, until_s);
    settled = !status && fabs(*v - vs_stand_at(&r, r.v, 0.9 * until_s)) < 1e-4 * fabs(*v);
    vs_stand_free(&r);
  }
  if (!status && !settled)
    return vs_fail(err, VS_RUN, "the voltage still rises after 5 C: the model has none at %.4g A",
                   i);
  if (!status && *v < 0)
    return vs_fail(err, VS_RUN,
                   "could not judge: the voltage is %.4g V, against the current, as no such "
                   "part's is; a sign in the model is wrong",
                   *v);
  return status;
}

/* What the part's own law says, by its parameters: i = 1 mA (v/V)^exponent, or the maker's
 * polynomial log10 V = b1 + b2 x + b3 exp(-x) + b4 exp(x), x = log10 I. */
static vs_figures_asked by_law(const vs_stand *s, double i) {
  static const char *const B[] = {"siov_b1", "siov_b2", "siov_b3", "siov_b4"};
  vs_figures_asked v = vs_figures_param(s, "varistor_voltage"), law[4];
  double exponent = vs_figures_param(s, "varistor_exponent").value, x = log10(i);
  if (isfinite(v.value) && isfinite(exponent)) {
    v.value *= pow(i / 1e-3, 1 / exponent);
    return v;
  }
  for (int k = 0; k < 4; k++) law[k] = vs_figures_param(s, B[k]);
  law[0].value =
      pow(10, law[0].value + law[1].value * x + law[2].value * exp(-x) + law[3].value * exp(x));
  return law[0];
}

/* The current of the picture rises from 10 uA by `decades` within 1 s. */
static void draw_varistor(const vs_stand *s, double decades, vs_figures *f) {
  vs_stand_record r = {0};
  vs_error err = {0};
  char source[96];
  snprintf(source, sizeof source, "Bs 0 m I = 1e-5*exp(%.9g*time)", decades * log(10));
  vs_figures_curve *c = NULL;
  if (!vs_test_circuit_across(s, (vs_stand_circuit){source, 1, 1.0 / 400, 1e-6}, &r, &err))
    c = vs_figures_add_curve(f, r.points);
  if (c) {
    c->title = "voltage over current", c->x_label = "i / A", c->y_label = "v / V", c->log_x = true;
    memcpy(c->x, r.i, r.points * sizeof *c->x);
    memcpy(c->y, r.v, r.points * sizeof *c->y);
    c->x[0] = c->x[1]; /* at t = 0 its capacitance is empty */
    c->y[0] = c->y[1];
  }
  vs_stand_free(&r);
}

/* A limit is held as a buyer's test would: the voltage at 1 mA within the 10 % that makers allow,
 * and the one at the class current at most what is said. 0.1 % for what a
 * parameter asks: the inverse of the polynomial is off by 0.02 % up to 10 kA. */
static void measure_varistor(const vs_stand *s, vs_figures *f) {
  static const char *const CLASS[] = {"i_clamp", NULL}, *const SURGE[] = {"i_surge", NULL},
                           *const WORDS[] = {"v_1ma", "v_clamp", NULL};
  const struct {
    double i_a;
    const char *limit, *text;
    double tolerance;
    vs_held held;
  } ROWS[] = {
      {1e-3, "v_varistor", "the varistor voltage", 0.1, VS_HELD_NEAR},
      {vs_figures_first(s, CLASS, 100), "v_clamp", "the clamping voltage", 0, VS_HELD_AT_MOST},
      {vs_figures_first(s, SURGE, 1000), NULL, "the largest surge", 0, VS_HELD_NOT}};
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    bool clamp_without_current = k == 1 && isnan(vs_figures_first(s, CLASS, NAN));
    vs_figures_asked law = by_law(s, ROWS[k].i_a), limit = {NAN, {0}};
    if (ROWS[k].limit && !clamp_without_current) limit = vs_figures_limit(s, ROWS[k].limit);
    bool own = isnan(limit.value) && WORDS[k];
    if (own) limit = vs_figures_own(s, WORDS[k]);
    bool limited = isfinite(limit.value);
    vs_figure *row =
        vs_figures_add(f, "V", "V", limited ? limit : law, limited ? ROWS[k].tolerance : 1e-3,
                       limited ? ROWS[k].held : VS_HELD_NEAR);
    vs_error err = {0};
    if (ROWS[k].limit && !clamp_without_current) vs_figures_is(row, s, ROWS[k].limit);
    if (own && limited && k == 0) row->tolerance = 1e-3 * limit.value;
    snprintf(row->text, sizeof row->text, "at %.4g A%s%s", ROWS[k].i_a,
             limited || k == 2 ? ", " : "", limited || k == 2 ? ROWS[k].text : "");
    if (voltage_at(s, ROWS[k].i_a, &row->got, &err)) {
      row->got = NAN;
      vs_test_circuit_fail(row, &err);
    }
  }
  draw_varistor(s, log10(ROWS[2].i_a / 1e-5), f);
}

/* ---- Zener diode and TVS ---- */

/* One voltage of the sheet, at the current that it is given for. */
typedef struct clamp {
  const char *name, *limit, *current;
  double tolerance;
  vs_held held;
} clamp;

static void measure_clamp(const vs_stand *s, const clamp *c, vs_figures *f) {
  const double i_a = vs_figures_limit(s, c->current).value;
  vs_figure *row =
      vs_figures_add(f, c->name, "V", vs_figures_limit(s, c->limit), c->tolerance, c->held);
  vs_error err = {0};
  vs_figures_is(row, s, c->limit);
  snprintf(row->text, sizeof row->text, "at %.4g A, %s", i_a, c->current);
  vs_status status = isnan(i_a) ? vs_fail(&err, VS_RUN, "the file has no limit %s", c->current)
                                : voltage_at(s, i_a, &row->got, &err);
  if (!status) return;
  row->got = NAN;
  vs_test_circuit_fail(row, &err);
}

/* Makers allow 5 % of the voltage at the test current. */
static void measure_zener(const vs_stand *s, vs_figures *f) {
  measure_clamp(s, &(clamp){"V_Z", "v_z", "i_zt", 0.05, VS_HELD_NEAR}, f);
}

static void measure_tvs(const vs_stand *s, vs_figures *f) {
  measure_clamp(s, &(clamp){"V_BR", "v_br", "i_t", 0.05, VS_HELD_NEAR}, f);
  measure_clamp(s, &(clamp){"V_C", "v_c", "i_pp", 0, VS_HELD_AT_MOST}, f);
}

const vs_figures_kind vs_varistor_kind = {"varistor", measure_varistor},
                      vs_varistor_zener = {"zener", measure_zener},
                      vs_varistor_tvs = {"tvs", measure_tvs};
