/* SPDX-License-Identifier: GPL-3.0-or-later
 * Resistors and capacitors, tried: resistance at 1 V; capacitance, and the resistance in series
 * with it, also of a snubber; of an electrolytic capacitor these at 100 Hz, the resistance also at
 * 10 kHz, and the leakage. */
#include <math.h>
#include <stdio.h>

#include "test_circuit.h"

/* 1 V, after 1 s, when its inductance is long past. */
static void measure_resistor(const vs_stand *s, vs_figures *f) {
  vs_figure *row =
      vs_figures_add(f, "R", "ohm", vs_figures_own(s, "resistance"), 0.01, VS_HELD_NEAR);
  vs_stand_record r = {0};
  vs_error err = {0};
  snprintf(row->text, sizeof row->text, "at 1 V");
  vs_status status = vs_test_circuit_across(
      s, (vs_stand_circuit){"Vs m 0 pwl(0 0 1m 1)", 1, 1.0 / 200, 1e-6}, &r, &err);
  if (status)
    vs_test_circuit_fail(row, &err);
  else
    row->got = vs_stand_at(&r, r.v, 0.99) / vs_stand_at(&r, r.i, 0.99);
  vs_stand_free(&r);
}

/* The voltage rises by 10 V in 10 ms: i = C dv/dt, read over the second half, without leakage. */
static void measure_capacitance(const vs_stand *s, vs_figure *row) {
  vs_stand_record r = {0};
  vs_error err = {0};
  vs_status status = vs_test_circuit_across(
      s, (vs_stand_circuit){"Vs m 0 pwl(0 0 10m 10)", 10e-3, 10e-3 / 200, 1e-6}, &r, &err);
  snprintf(row->text, sizeof row->text, "at 1 V/ms");
  if (status)
    vs_test_circuit_fail(row, &err);
  else
    row->got = vs_stand_at(&r, r.i, 9e-3) / 1e3;
  vs_stand_free(&r);
}

/* A current that is switched on within a thousandth of the time: v = R i + i t/C. The line through
 * two instants says what stood there at once. */
static void series_resistance(const vs_stand *s, double c_f, vs_figure *row) {
  double guess = isfinite(row->asked) ? row->asked : 0.1, until_s = guess * c_f;
  vs_stand_record r = {0};
  vs_error err = {0};
  char source[128];
  snprintf(source, sizeof source, "Is 0 m pwl(0 0 %.9g 1)", until_s / 1000);
  vs_status status =
      vs_test_circuit_across(s, (vs_stand_circuit){source, until_s, until_s / 200, 1e-6}, &r, &err);
  snprintf(row->text, sizeof row->text, "in series, at 1 A");
  if (status)
    vs_test_circuit_fail(row, &err);
  else
    row->got =
        2 * vs_stand_at(&r, r.v, 0.5 * until_s + 0.25e-3 * until_s) - vs_stand_at(&r, r.v, until_s);
  vs_stand_free(&r);
}

static void measure_series(const vs_stand *s, vs_figures *f, vs_figures_asked c_f,
                           const char *const r_name_unit[2], vs_figures_asked r_ohm) {
  vs_figure *row = vs_figures_add(f, "C", "uF", c_f, 0.01, VS_HELD_NEAR),
            *resistor =
                vs_figures_add(f, r_name_unit[0], r_name_unit[1], r_ohm, 0.02, VS_HELD_NEAR);
  measure_capacitance(s, row);
  if (row->got > 0)
    series_resistance(s, row->got, resistor);
  else
    snprintf(resistor->why, sizeof resistor->why, "its capacitance is not known");
}

static void measure_capacitor(const vs_stand *s, vs_figures *f) {
  measure_series(s, f, vs_figures_own(s, "capacitance"), (const char *[]){"ESR", "mohm"},
                 vs_figures_own(s, "esr"));
}

static void measure_snubber(const vs_stand *s, vs_figures *f) {
  measure_series(s, f, vs_figures_any(s, "c"), (const char *[]){"R", "ohm"},
                 vs_figures_any(s, "r"));
}

/* ---- electrolytic capacitors ---- */

/* A sine of 1 A that begins at its zero, so that the voltage does not turn: capacitance and
 * resistance by the parts of the voltage at that frequency, over the last two of four periods. */
static vs_status impedance(const vs_stand *s, double hz, double *c_f, double *r_ohm,
                           vs_error *err) {
  const double omega = 2 * M_PI * hz, from = 2 / hz;
  vs_stand_record r = {0};
  char source[96];
  double re = 0, im = 0;
  snprintf(source, sizeof source, "Is 0 m sin(0 1 %g)", hz);
  vs_status status =
      vs_test_circuit_across(s, (vs_stand_circuit){source, 4 / hz, 4 / hz / 200, 1e-6}, &r, err);
  double mean = status ? NAN : vs_stand_at(&r, r.v, from);
  for (size_t k = 1; k < r.points && !status; k++) {
    if (r.t_s[k - 1] < from) continue;
    double t = (r.t_s[k] + r.t_s[k - 1]) / 2, h = r.t_s[k] - r.t_s[k - 1],
           v = (r.v[k] + r.v[k - 1]) / 2 - mean;
    re += v * sin(omega * t) * h;
    im -= v * cos(omega * t) * h;
  }
  *r_ohm = status ? NAN : re * hz;
  *c_f = status ? NAN : 1 / (omega * im * hz);
  vs_stand_free(&r);
  return status;
}

/* The rated voltage through so much resistance that it is there after a twentieth of a second. */
static void measure_leakage(const vs_stand *s, double c_f, vs_figures *f) {
  static const char *const RATED[] = {"v_rated", "rated_voltage", NULL};
  vs_figures_asked own = vs_figures_any(s, "leakage"), most = vs_figures_limit(s, "i_leakage");
  bool limited = isfinite(most.value);
  double v = vs_figures_first(s, RATED, NAN), ohm = 0.05 / c_f;
  vs_figure *row = vs_figures_add(f, "leakage", "mA", limited ? most : own, limited ? 0 : 0.02,
                                  limited ? VS_HELD_AT_MOST : VS_HELD_NEAR);
  vs_stand_record r = {0};
  vs_error err = {0};
  char source[128];
  snprintf(source, sizeof source, "Vs w 0 pwl(0 0 0.1 %g)\nRs w m %g", v, ohm);
  snprintf(row->text, sizeof row->text, "at %.4g V", v);
  vs_status status =
      isnan(v)
          ? vs_fail(&err, VS_RUN, "its rated voltage is not known")
          : vs_test_circuit_across(s, (vs_stand_circuit){source, 2, 2.0 / 200, 1e-6}, &r, &err);
  if (status)
    vs_test_circuit_fail(row, &err);
  else
    row->got = vs_stand_at(&r, r.i, 1.99);
  vs_stand_free(&r);
}

static void measure_electrolytic(const vs_stand *s, vs_figures *f) {
  vs_figures_asked c = vs_figures_any(s, "capacitance"), esr = vs_figures_any(s, "esr"),
                   rated = vs_figures_limit(s, "c_rated"), most = vs_figures_limit(s, "esr");
  bool c_own = isfinite(c.value), esr_own = isfinite(esr.value);
  vs_figure *row[] = {
      vs_figures_add(f, "C", "uF", c_own ? c : rated, c_own ? 0.01 : 0.2, VS_HELD_NEAR),
      vs_figures_add(f, "ESR", "mohm", esr_own ? esr : most, esr_own ? 0.03 : 0,
                     esr_own ? VS_HELD_NEAR : VS_HELD_AT_MOST),
      vs_figures_add(f, "ESR", "mohm", vs_figures_any(s, "esr_high"), 0.05, VS_HELD_NEAR)};
  vs_error err = {0};
  double ignored;
  if (impedance(s, 100, &row[0]->got, &row[1]->got, &err))
    vs_test_circuit_fail(row[0], &err), vs_test_circuit_fail(row[1], &err);
  if (impedance(s, 10e3, &ignored, &row[2]->got, &err)) vs_test_circuit_fail(row[2], &err);
  for (int n = 0; n < 3; n++)
    snprintf(row[n]->text, sizeof row[n]->text, "at %s", n < 2 ? "100 Hz" : "10 kHz");
  measure_leakage(s, row[0]->got > 0 ? row[0]->got : 100e-6, f);
}

const vs_figures_kind vs_passive_resistor = {"resistor", measure_resistor},
                      vs_passive_capacitor = {"capacitor", measure_capacitor},
                      vs_passive_snubber = {"snubber", measure_snubber},
                      vs_passive_electrolytic = {"electrolytic", measure_electrolytic};
