/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a MOSFET or an IGBT, tried: on-state, threshold, transconductance,
 * breakdown, switching of an inductive load, the diode inside. */
#include <math.h>
#include <stdio.h>

#include "diode.h"
#include "test_circuit.h"

/* The part in a trial: drain or collector at t, gate at g, source or emitter at 0. In the mirror
 * the diode inside conducts, its gate at source or emitter. */
static const char WIRING[] = "Xdut t g 0 %s", MIRRORED[] = VS_TRYOUT_MIRROR "Xdut m 0 0 %s";

/* What the circuits are made for, SI. */
typedef struct plan {
  const char *threshold_name, *threshold_limit;
  double drive_v, block_v;
  double test_v, test_a;       /* of on-state and of switching */
  double threshold_a, slope_a; /* currents of V_GS(th) and g_fs */
} plan;

static plan plan_of(const vs_stand *s, const plan *usual) {
  static const char *const DRIVE[] = {"drive_voltage", NULL},
                           *const BLOCK[] = {"blocking_voltage", "v_dss", "v_ces", NULL},
                           *const AT_V[] = {"v_test", "test_voltage", NULL},
                           *const AT_A[] = {"i_test", "test_current", "i_d", "i_c", NULL},
                           *const LOW[] = {"i_th", "threshold_current", NULL},
                           *const SLOPE[] = {"transconductance_current", NULL};
  plan p = *usual;
  p.drive_v = vs_figures_first(s, DRIVE, p.drive_v);
  p.block_v = vs_figures_first(s, BLOCK, 500);
  p.test_v = vs_figures_first(s, AT_V, 0.6 * p.block_v);
  p.test_a = vs_figures_first(s, AT_A, 5);
  p.threshold_a = vs_figures_first(s, LOW, p.threshold_a);
  p.slope_a = vs_figures_first(s, SLOPE, p.test_a);
  return p;
}

/* ---- on-state ---- */

/* The voltage at a current that has stood for 0.8 ms; NaN, and the row says why. */
static double voltage_at(const vs_stand *s, const plan *p, double i, vs_figure *row) {
  vs_stand_record r = {0};
  vs_error err = {0};
  double v = NAN;
  vs_status status = vs_test_circuit_run(
      s, (vs_test_circuit){WIRING, 1.1e-3, 2e-6}, &r, &err,
      "I1 0 a pwl(0 0 0.2m 0 0.3m %g 1.1m %g)\nVg g 0 pwl(0 0 0.1m %g)\n", i, i, p->drive_v);
  if (!status) v = vs_stand_at(&r, r.v, 1.09e-3);
  if (!status && v > p->block_v / 2)
    v = NAN, status = vs_fail(&err, VS_RUN, "it does not conduct when its gate is driven");
  if (status) vs_test_circuit_fail(row, &err);
  vs_stand_free(&r);
  return v;
}

static void channel_resistance(const vs_stand *s, const plan *p, vs_figures *f) {
  vs_figure *row = vs_test_circuit_row(
      s, f, (const char *[]){"R_DS(on)", "mohm"},
      (vs_test_circuit_source){"r_ds_on", "on_resistance", VS_HELD_AT_MOST, 0.03, 0, false}, false);
  snprintf(row->text, sizeof row->text, "at %.4g A, gate at %.4g V", p->test_a, p->drive_v);
  row->got = voltage_at(s, p, p->test_a, row) / p->test_a;
}

/* The line by the model's own parameters, within 60 mV: what the junction and the channel add to
 * it. Or the limit. */
static void saturation(const vs_stand *s, const plan *p, vs_figures *f) {
  vs_figures_asked v0 = vs_figures_any(s, "on_voltage"), slope = vs_figures_any(s, "on_resistance"),
                   most = vs_figures_limit(s, "v_ce_sat");
  double own_a =
      vs_figures_condition(s, true, (const char *[]){"i_test", "test_current"}, p->test_a);
  const double at_a[] = {own_a, own_a / 10, p->test_a};
  for (int n = 0; n < 3; n++) {
    double i = at_a[n];
    vs_figures_asked asked = n < 2 ? v0 : most;
    if (n < 2) asked.value += slope.value * i;
    if (isnan(asked.value) && (n > 0 || isfinite(most.value))) continue;
    vs_figure *row =
        vs_figures_add(f, "V_CE(sat)", "V", asked, 0, n < 2 ? VS_HELD_NEAR : VS_HELD_AT_MOST);
    row->tolerance = n < 2 ? 0.06 : 0;
    if (n == 2 || isnan(most.value)) vs_figures_is(row, s, "v_ce_sat");
    snprintf(row->text, sizeof row->text, "at %.4g A, gate at %.4g V", i, p->drive_v);
    row->got = voltage_at(s, p, i, row);
  }
}

/* ---- transfer ---- */

/* The gate's voltage at which the current passes a level; NaN: it does not. */
static double gate_at(const vs_stand_record *r, double i) {
  for (size_t k = 1; k < r->points; k++)
    if (r->t_s[k] > 2e-3 && r->i[k - 1] < i && r->i[k] >= i)
      return r->g[k - 1] + (r->g[k] - r->g[k - 1]) * (i - r->i[k - 1]) / (r->i[k] - r->i[k - 1]);
  return NAN;
}

/* The gate rises within 20 ms to its drive at 20 V or 0.4 V_DSS. */
static void transfer(const vs_stand *s, const plan *p, vs_figures *f) {
  vs_figure *row = vs_test_circuit_row(s, f, (const char *[]){p->threshold_name, "V"},
                                       (vs_test_circuit_source){p->threshold_limit, "threshold",
                                                                VS_HELD_AT_MOST, 0.02, 0, false},
                                       false),
            *slope = vs_figures_add(f, "g_fs", "A/V", vs_figures_any(s, "transconductance"), 0.05,
                                    VS_HELD_AT_LEAST);
  double v = fmin(20, 0.4 * p->block_v), near = 0.05 * p->slope_a;
  vs_stand_record r = {0};
  vs_error err = {0};
  vs_status status =
      vs_test_circuit_run(s, (vs_test_circuit){WIRING, 22e-3, 10e-6}, &r, &err,
                          "V1 a 0 pwl(0 0 1m %g)\nVg g 0 pwl(0 0 2m 0 22m %g)\n", v, p->drive_v);
  snprintf(row->text, sizeof row->text, "at %.4g mA and %.4g V", p->threshold_a * 1e3, v);
  snprintf(slope->text, sizeof slope->text, "at %.4g A and %.4g V", p->slope_a, v);
  if (!status) {
    row->got = gate_at(&r, p->threshold_a);
    slope->got = 2 * near / (gate_at(&r, p->slope_a + near) - gate_at(&r, p->slope_a - near));
    vs_test_circuit_draw(f, &r,
                         (vs_test_circuit_view){"transfer", "gate / V", "i / A", 2e-3, 22e-3},
                         (const double *[]){r.g, r.i}, (const double[]){1, 1});
  }
  if (!status && isnan(row->got))
    status = vs_fail(&err, VS_RUN, "its current stays below that up to %.4g V", p->drive_v);
  if (status) vs_test_circuit_fail(row, &err);
  if (status) vs_test_circuit_fail(slope, &err);
  vs_stand_free(&r);
}

/* ---- switching ---- */

/* The first instant after from_s at which a column has fallen below a level; the record's end where
 * it does not. */
static double falls_below(const vs_stand_record *r, const double *column, double from_s,
                          double level) {
  for (size_t k = 0; k < r->points; k++)
    if (r->t_s[k] > from_s && column[k] < level) return r->t_s[k];
  return r->points ? r->t_s[r->points - 1] : NAN;
}

/* A constant current through a diode without recovery: on at 50 us, off at 150 us. E_on counts
 * until 5 % of the voltage are left, E_off until 2 % of the current are. A sixth for the model's
 * own, as the gate's part of E_off is an estimate. */
static void switching(const vs_stand *s, const plan *p, vs_figures *f) {
  vs_figure *on = vs_test_circuit_row(
                s, f, (const char *[]){"E_on", "mJ"},
                (vs_test_circuit_source){"e_on", NULL, VS_HELD_AT_MOST, 0, 0, false}, false),
            *off = vs_test_circuit_row(s, f, (const char *[]){"E_off", "mJ"},
                                       (vs_test_circuit_source){"e_off", "turn_off_energy",
                                                                VS_HELD_AT_MOST, 1.0 / 6, 0, true},
                                       false);
  const double ON = 50e-6, OFF = 150e-6;
  bool own = isfinite(vs_figures_any(s, "turn_off_energy").value);
  double v = vs_figures_condition(s, own, (const char *[]){"v_test", "test_voltage"}, p->test_v),
         i = vs_figures_condition(s, own, (const char *[]){"i_test", "test_current"}, p->test_a),
         ohm = vs_figures_condition(s, own, (const char *[]){"r_test", "test_resistance"}, 10);
  vs_stand_record r = {0};
  vs_error err = {0};
  vs_status status = vs_test_circuit_run(
      s, (vs_test_circuit){WIRING, 250e-6, 0.5e-6}, &r, &err,
      "Vdd p 0 pwl(0 0 10u %g)\nIl p a pwl(0 0 10u 0 20u %g)\nDf a p free\n"
      ".model free d(is=1n rs=5m)\nVs gs 0 pwl(0 0 50u 0 50.02u %g 150u %g 150.02u 0)\n"
      "Rgs gs g %g\n",
      v, i, p->drive_v, p->drive_v, ohm);
  if (!status && !(vs_stand_at(&r, r.i, OFF - 1e-6) > 0.9 * i))
    status = vs_fail(&err, VS_RUN, "it does not conduct when its gate is driven");
  if (!status && !(vs_stand_at(&r, r.v, ON) > 0.9 * v))
    status = vs_fail(&err, VS_RUN, "could not judge: it conducts before its gate is driven");
  if (!status && !(r.i[r.points - 1] < 0.02 * i))
    status =
        vs_fail(&err, VS_RUN, "could not judge: it still conducts 100 us after its gate is off");
  for (int n = 0; n < 2; n++) {
    vs_figure *row = n ? off : on;
    snprintf(row->text, sizeof row->text, "%.4g V, %.4g A, gate %.4g ohm, diode without recovery",
             v, i, ohm);
    if (status) vs_test_circuit_fail(row, &err);
  }
  if (!status) {
    double on_s = falls_below(&r, r.v, ON, 0.05 * v),
           off_s = falls_below(&r, r.i, falls_below(&r, r.i, OFF, 0.5 * i), 0.02 * i);
    on->got = vs_test_circuit_energy(&r, ON, on_s);
    off->got = vs_test_circuit_energy(&r, OFF, off_s);
    vs_test_circuit_draw(
        f, &r, (vs_test_circuit_view){"turn-off", "t / us", "v / V", OFF, OFF + 2 * (off_s - OFF)},
        (const double *[]){r.t_s, r.v}, (const double[]){1e-6, 1});
    vs_test_circuit_draw(
        f, &r, (vs_test_circuit_view){"turn-off", "t / us", "i / A", OFF, OFF + 2 * (off_s - OFF)},
        (const double *[]){r.t_s, r.i}, (const double[]){1e-6, 1});
  }
  vs_stand_free(&r);
}

/* ---- the diode inside ---- */

static void diode_inside(const vs_stand *s, const plan *p, vs_figures *f) {
  static const char *const FALL[] = {"di_test", "test_slope", NULL};
  const vs_diode_plan diode = {.wiring = MIRRORED,
                               .way = ", the diode inside",
                               .v_param = "diode_voltage",
                               .r_param = "diode_resistance",
                               .q_param = "recovered_charge",
                               .test_a = p->test_a,
                               .test_a_s = vs_figures_first(s, FALL, 100e6),
                               .least_v = 10};
  bool asked = isfinite(vs_figures_any(s, "diode_voltage").value) ||
               isfinite(vs_figures_limit(s, "v_f").value) ||
               isfinite(vs_figures_limit(s, "q_rr").value);
  if (!asked) return;
  vs_diode_forward(s, &diode, f);
  vs_diode_recovery(s, &diode, f);
}

/* ---- all ---- */

static void measure_mosfet(const vs_stand *s, vs_figures *f) {
  const plan usual = {"V_GS(th)", "v_gs_th", .drive_v = 10, .threshold_a = 0.25e-3},
             p = plan_of(s, &usual);
  channel_resistance(s, &p, f);
  transfer(s, &p, f);
  vs_diode_breakdown(s, WIRING, (const char *[]){"V_DS", "v_dss"}, 1, f);
  switching(s, &p, f);
  diode_inside(s, &p, f);
}

static void measure_igbt(const vs_stand *s, vs_figures *f) {
  const plan usual = {"V_GE(th)", "v_ge_th", .drive_v = 15, .threshold_a = 0.5e-3},
             p = plan_of(s, &usual);
  saturation(s, &p, f);
  transfer(s, &p, f);
  vs_diode_breakdown(s, WIRING, (const char *[]){"V_CE", "v_ces"}, 1, f);
  switching(s, &p, f);
  diode_inside(s, &p, f);
}

const vs_figures_kind vs_transistor_mosfet = {"mosfet", measure_mosfet},
                      vs_transistor_igbt = {"igbt", measure_igbt};
