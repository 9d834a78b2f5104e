/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "latching.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

vs_latching_plan vs_latching_plan_of(const vs_stand *s) {
  static const char *const GATE[] = {"i_gt", "gate_current", NULL},
                           *const LATCH[] = {"i_l", "latching_current", NULL},
                           *const BLOCK[] = {"blocking_voltage", "v_drm", NULL},
                           *const TEST[] = {"i_test", "test_current", "i_tm", "i_t_rms", NULL},
                           *const FALL[] = {"di_test", "test_slope", NULL},
                           *const RISE[] = {"critical_dvdt", "dv_dt", NULL},
                           *const OFF[] = {"turn_off_time", "t_q", NULL};
  const double BACK_V_S = 20e6; /* where dv/dt is less than twice that, half of dv/dt is taken */
  double gate = vs_figures_first(s, GATE, 10e-3), rise_v_s = vs_figures_first(s, RISE, 200e6);
  return (vs_latching_plan){.wiring = VS_LATCHING_WIRING,
                            .way = "",
                            .gate_param = "gate_current",
                            .gate_limit = "i_gt",
                            .gate_a = gate,
                            .latching_a = vs_figures_first(s, LATCH, 4 * gate),
                            .block_v = vs_figures_first(s, BLOCK, 600),
                            .test_a = vs_figures_first(s, TEST, 10),
                            .test_a_s = vs_figures_first(s, FALL, 10e6),
                            .leak_s = NAN,
                            .slope_v_s = rise_v_s,
                            .back_v_s = fmin(BACK_V_S, rise_v_s / 2),
                            .turn_off_s = vs_figures_first(s, OFF, 50e-6)};
}

/* A voltage above the on-state voltage of any thyristor, V. */
static const double NOT_ON_V = 20;

/* The voltage at which a device has left its on-state at a small current, V. In models that hold by
 * the product of voltage and current, both go on below I_H, the voltage far above the on-state's.
 */
static const double AWAY_V = 5;

/* A device that never turned on has no such figure. */
vs_status vs_latching_not_on(vs_error *err) {
  return vs_fail(err, VS_RUN, "it does not conduct when its gate is driven");
}

/* ---- on-state ---- */

/* V_T0 + r_T i by the model's own parameters, or the limit v_t at i_tm. The current stands for 1
 * ms. 30 mV: the two junctions that the line leaves out add half of 60 mV a decade. */
void vs_latching_on_state(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  vs_figures_asked v0 = vs_figures_any(s, "on_voltage"), slope = vs_figures_any(s, "on_resistance"),
                   most = vs_figures_limit(s, "v_t");
  static const char *const AT[] = {"i_tm", NULL};
  double current[] = {p->test_a, p->test_a / 10, vs_figures_first(s, AT, p->test_a)};
  for (int n = 0; n < 3; n++) {
    vs_figures_asked asked = n < 2 ? v0 : most;
    if (n < 2) asked.value += slope.value * current[n];
    if (!isfinite(asked.value) && !(n == 0 && !isfinite(most.value))) continue;
    vs_figure *row =
        vs_figures_add(f, "V_T", "V", asked, 0, n < 2 ? VS_HELD_NEAR : VS_HELD_AT_MOST);
    vs_stand_record r = {0};
    vs_error err = {0};
    row->tolerance = n < 2 ? 0.03 : 0;
    if (n == 2 || isnan(most.value)) vs_figures_is(row, s, "v_t");
    snprintf(row->text, sizeof row->text, "at %.4g A%s%s", current[n], p->way,
             n == 2                  ? ""
             : isfinite(asked.value) ? ", of on_voltage and on_resistance"
                                     : "");
    vs_status status = vs_test_circuit_run(s, (vs_test_circuit){p->wiring, 1.1e-3, 1e-6}, &r, &err,
                                           "I1 0 a pwl(0 0 10u 0 110u %g 1.1m %g)\nIg 0 g %g\n",
                                           current[n], current[n], 3 * p->gate_a);
    if (!status && p->conducts) err = p->why, status = VS_RUN; /* a diode, or other pins */
    if (status)
      vs_test_circuit_fail(row, &err);
    else
      row->got = vs_stand_at(&r, r.v, 1.09e-3);
    vs_stand_free(&r);
  }
}

/* The on-state curve for the picture: the current rises within 2 ms to twice the test current. */
void vs_latching_draw_on_state(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  vs_stand_record r = {0};
  vs_error err = {0};
  if (!vs_test_circuit_run(s, (vs_test_circuit){p->wiring, 2.2e-3, 4e-6}, &r, &err,
                           "I1 0 a pwl(0 0 0.2m 0 2.2m %g)\nIg 0 g %g\n", 2 * p->test_a,
                           3 * p->gate_a))
    vs_test_circuit_draw(f, &r,
                         (vs_test_circuit_view){"on-state", "V_T / V", "I_T / A", 0.25e-3, 2.2e-3},
                         (const double *[]){r.v, r.i}, (const double[]){1, 1});
  vs_stand_free(&r);
}

/* ---- gate ---- */

/* At 12 V, as is the custom, behind a resistance by which `load_a` flows, the gate's current rises
 * within 20 ms to ramp_a and then goes: the device has to stay on. */
static vs_status rising_gate(const vs_stand *s, vs_latching_plan *p, double load_a, double *fires_s,
                             vs_error *err) {
  vs_stand_record *r = &p->seen;
  vs_stand_free(r);
  vs_status status =
      vs_test_circuit_run(s, (vs_test_circuit){p->wiring, 24e-3, 10e-6}, r, err,
                          "V1 s 0 pwl(0 0 1m 12)\nR1 s a %g\nIg 0 g pwl(0 0 2m 0 22m %g 22.1m 0)\n",
                          12 / load_a, p->ramp_a);
  *fires_s = status ? NAN : vs_stand_crosses(r, 2e-3, 6);
  if (status) return status;
  double open_v = vs_stand_at(r, r->v, 1.99e-3);
  p->leak_s = vs_stand_at(r, r->i, 1.99e-3) / open_v;
  p->conducts = open_v < 6;
  if (p->conducts)
    return vs_fail(err, VS_RUN,
                   "could not judge: it conducts with its gate open, and %.3g V of 12 V "
                   "are left",
                   open_v);
  return VS_OK;
}

/* A model of which nothing is asked is looked for from a tenth of a microampere to ten amperes.
 * What fires at next to no current fires by itself. One that does not stay on is given more
 * current, as the file's I_L may not be the model's. */
static vs_status fire(const vs_stand *s, vs_latching_plan *p, vs_error *err) {
  double fires_s = NAN, load_a = 10 * p->latching_a, part = NAN;
  p->ramp_a = 2 * p->gate_a;
  for (int tries = 0, loads = 0; tries < 6; tries++) {
    vs_status status = rising_gate(s, p, load_a, &fires_s, err);
    if (status) return status;
    part = (fires_s - 2e-3) / 20e-3;
    bool fires = part > 0.02 && part < 1;
    if (fires && p->seen.v[p->seen.points - 1] < 6) {
      p->fires_a = part * p->ramp_a;
      p->fires_v = vs_stand_at(&p->seen, p->seen.g, fires_s - 20e-6);
      return VS_OK;
    }
    if (!fires)
      p->ramp_a *= isnan(fires_s) ? 5 : 0.04;
    else if (loads++ < 3)
      load_a *= 5, tries--;
    else
      return vs_fail(err, VS_RUN,
                     "could not judge: it conducts while its gate is driven, and does "
                     "not stay on at %.3g A",
                     load_a);
  }
  return isnan(fires_s) ? vs_fail(err, VS_RUN, "it did not fire up to %.3g mA", 1e3 * p->ramp_a / 5)
                        : vs_fail(err, VS_RUN, "could not judge: it fires by itself at 12 V");
}

void vs_latching_fire(const vs_stand *s, vs_latching_plan *p) {
  static const double MARGIN = 1.2; /* the pulses of the other tests have 1.5 I_GT and more */
  p->fires_a = p->fires_v = NAN;
  p->why = (vs_error){0};
  fire(s, p, &p->why);
  if (p->fires_a > MARGIN * p->gate_a) p->gate_a = p->fires_a;
}

/* 3 %: the steps are 0.1 %, and what the model leaves out of its sum is 2.5 % at most. */
void vs_latching_gate(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  vs_figure *row = vs_test_circuit_row(
      s, f, (const char *[]){"I_GT", "mA"},
      (vs_test_circuit_source){p->gate_limit, p->gate_param, VS_HELD_AT_MOST, 0.03, 0, false},
      false);
  vs_figure *volt = vs_figures_add(f, "V_GT", "V", vs_figures_limit(s, "v_gt"), 0, VS_HELD_AT_MOST);
  snprintf(row->text, sizeof row->text, "at 12 V%s", p->way);
  snprintf(volt->text, sizeof volt->text, "at 12 V, when it fires%s", p->way);
  row->got = p->fires_a;
  volt->got = p->fires_v;
  if (isfinite(p->fires_a))
    vs_test_circuit_draw(
        f, &p->seen,
        (vs_test_circuit_view){"gate: it fires at 12 V", "i_G / mA", "v_AK / V", 2e-3, 22e-3},
        (const double *[]){p->seen.t_s, p->seen.v}, (const double[]){20e-3 / (1e3 * p->ramp_a), 1});
  else
    vs_test_circuit_fail(row, &p->why), vs_test_circuit_fail(volt, &p->why);
}

/* ---- latching and holding ---- */

/* True where the device is still on long after a gate pulse of 0.2 ms, at this anode current: its
 * voltage has fallen to an on-state's. What leaks through it at 100 V may be as much as the current
 * that is tried; then the voltage is low before the pulse. */
static vs_status latches(const vs_stand *s, const void *ctx, double i, bool *yes, vs_error *err) {
  const vs_latching_plan *p = ctx;
  double gate = 1.5 * p->gate_a;
  vs_stand_record r = {0};
  vs_status status = vs_test_circuit_run(s, (vs_test_circuit){p->wiring, 1e-3, 2e-6}, &r, err,
                                         "V1 s 0 pwl(0 0 100u 100)\nR1 s a %g\n"
                                         "Ig 0 g pwl(0 0 200u 0 201u %g 400u %g 401u 0)\n",
                                         99 / i, gate, gate);
  double before_v = status ? NAN : vs_stand_at(&r, r.v, 199e-6);
  *yes = !status && r.points > 0 && r.v[r.points - 1] < AWAY_V;
  if (before_v < 2 * NOT_ON_V)
    status = vs_fail(err, VS_RUN,
                     "could not judge: at %.3g mA it conducts before its gate is driven", 1e3 * i);
  vs_stand_free(&r);
  return status;
}

void vs_latching_current(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  vs_figure *row = vs_test_circuit_row(
      s, f, (const char *[]){"I_L", "mA"},
      (vs_test_circuit_source){"i_l", "latching_current", VS_HELD_AT_MOST, 0.05, 0, false}, true);
  if (!row) return;
  snprintf(row->text, sizeof row->text, "0.6 ms after a gate pulse of 0.2 ms and 1.5 I_GT%s",
           p->way);
  vs_figures_find(s, latches, p, p->latching_a, row);
}

/* The supply falls slowly from four times the latching current. */
static vs_status falling_supply(const vs_stand *s, const vs_latching_plan *p, vs_stand_record *r,
                                vs_error *err) {
  const double gate = 3 * p->gate_a;
  return vs_test_circuit_run(s, (vs_test_circuit){p->wiring, 41e-3, 5e-6}, r, err,
                             "V1 s 0 pwl(0 100 1m 100 41m 0)\nR1 s a %g\n"
                             "Ig 0 g pwl(0 %g 0.2m %g 0.201m 0)\n",
                             25 / p->latching_a, gate, gate);
}

/* The time in which the current falls by a decade: by 1 % in 35 us, or slowly beside the charge
 * that is left of a higher current, as a device with a long t_q is slow to go off. */
static double decade_s(const vs_latching_plan *p) {
  return fmax(8e-3, 200 * p->turn_off_s);
}

/* The supply stays at 100 V, and the current falls by its series conductance, down to a ten
 * thousandth of the file's I_L or of 1 mA: whatever the model's I_H is, all of the 100 V come back
 * to a device that goes off. */
static vs_status falling_conductance(const vs_stand *s, const vs_latching_plan *p, double from_a,
                                     vs_stand_record *r, vs_error *err) {
  const double gate = 3 * p->gate_a, least_a = 1e-4 * fmin(p->latching_a, 1e-3),
               decade = decade_s(p);
  vs_status status = vs_test_circuit_run(
      s, (vs_test_circuit){p->wiring, 1e-3 + decade * log10(from_a / least_a), decade / 1600}, r,
      err,
      "V1 s 0 pwl(0 0 50u 100)\nIg 0 g pwl(0 %g 0.5m %g 0.501m 0)\n"
      "B1 s a I = v(s,a)*%g*exp(%g*(time > 1m ? time-1m : 0))\n",
      gate, gate, from_a / 100, -log(10) / decade);
  if (!status && vs_stand_at(r, r->v, 0.9e-3) > NOT_ON_V) status = vs_latching_not_on(err);
  return status;
}

/* The current so long before the anode's voltage is back at 5 V; NaN: it does not come back. What
 * leaks at 5 V never brings it back: it falls with the current. */
static double held_current(const vs_stand_record *r, double before_s) {
  double back_s = vs_stand_crosses(r, 1e-3, AWAY_V);
  return isfinite(back_s) ? vs_stand_at(r, r->i, back_s - before_s) : NAN;
}

/* The current below which what leaks at 12 V, in proportion to the voltage, is a third of all. */
static double hidden_below(const vs_latching_plan *p, const vs_stand_record *r) {
  for (size_t k = 0; k < r->points; k++)
    if (r->t_s[k] > 1e-3 && r->i[k] < 3 * p->leak_s * r->v[k]) return r->i[k];
  return 0;
}

/* What that test has to say: where the supply is below twice AWAY_V as the device goes off, only if
 * that was still in its on-state. Else the test hangs on the file's I_L. */
static double held_under_supply(const vs_stand_record *r) {
  static const double READ_S = 30e-6, ON = 1.5; /* times the least on-state voltage */
  const double back_s = vs_stand_crosses(r, 1e-3, AWAY_V),
               supply_v = 100 * (1 - (back_s - 1e-3) / 40e-3);
  double least_v = INFINITY;
  for (size_t k = 0; k < r->points && r->t_s[k] < back_s; k++)
    if (r->t_s[k] > 1e-3) least_v = fmin(least_v, r->v[k]);
  bool was_on = vs_stand_at(r, r->v, back_s - READ_S) < ON * least_v;
  return supply_v > 2 * AWAY_V || was_on ? held_current(r, READ_S) : NAN;
}

/* The first test; NaN: it does not tell. */
static vs_status holds_under_supply(const vs_stand *s, const vs_latching_plan *p, double *got,
                                    vs_error *err) {
  vs_stand_record r = {0};
  vs_status status = falling_supply(s, p, &r, err);
  bool on = !status && vs_stand_at(&r, r.v, 0.9e-3) <= NOT_ON_V;
  *got = on ? held_under_supply(&r) : NAN;
  vs_stand_free(&r);
  return status;
}

/* The second test. A device that is still on at its end, or as far down as a hundredth of I_L and
 * of the I_H that is asked, has no I_H. */
static vs_status holds_under_conductance(const vs_stand *s, const vs_latching_plan *p,
                                         double from_a, double *got, vs_error *err) {
  const double least_a = fmin(p->latching_a, vs_figures_limit(s, "i_h").value) / 100;
  vs_stand_record r = {0};
  vs_status status = falling_conductance(s, p, from_a, &r, err);
  if (!status) *got = held_current(&r, decade_s(p) / 800);
  if (!status && isnan(*got) && hidden_below(p, &r) > least_a)
    status =
        vs_fail(err, VS_RUN, "could not judge: below %.3g mA what leaks hides when it goes off",
                1e3 * hidden_below(p, &r));
  if (!status && isnan(*got)) *got = 0;
  vs_stand_free(&r);
  return status;
}

/* Where the first test hangs on the file's I_L, by which the device may not latch at all, the
 * second one follows; and then the first again, as what the second has got is the I_L that it
 * wants. */
static vs_status holds(const vs_stand *s, const vs_latching_plan *p, double *got, vs_error *err) {
  holds_under_supply(s, p, got, err);
  if (isfinite(*got)) return VS_OK;
  *err = (vs_error){0};
  vs_status status = holds_under_conductance(s, p, 4 * p->latching_a, got, err);
  if (status && p->test_a > 4 * p->latching_a) {
    *err = (vs_error){0};
    status = holds_under_conductance(s, p, p->test_a, got, err);
  }
  if (status || !(*got > 0)) return status;
  vs_latching_plan again = *p;
  vs_error other = {0};
  double better = NAN;
  again.latching_a = *got;
  holds_under_supply(s, &again, &better, &other);
  if (isfinite(better)) *got = better;
  return VS_OK;
}

void vs_latching_holding(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  vs_figure *row = vs_test_circuit_row(
      s, f, (const char *[]){"I_H", "mA"},
      (vs_test_circuit_source){"i_h", "holding_current", VS_HELD_AT_MOST, 0.03, 0, false}, false);
  vs_error err = {0};
  snprintf(row->text, sizeof row->text, "gate open, the current falling slowly%s", p->way);
  if (holds(s, p, &row->got, &err)) vs_test_circuit_fail(row, &err);
}

/* ---- switching ---- */

/* A linear rise to 0.67 V_DRM with the gate open; true where the device is on 60 us later. Steps of
 * 2 ns are short enough, as ngspice ends one where the rise ends. */
static vs_status fires_at(const vs_stand *s, const void *ctx, double slope, bool *yes,
                          vs_error *err) {
  const vs_latching_plan *p = ctx;
  double v = 0.67 * p->block_v, t = v / slope;
  vs_stand_record r = {0};
  vs_status status = vs_test_circuit_run(
      s,
      (vs_test_circuit){p->wiring, 65e-6 + t + p->wait_s,
                        fmax(fmax(fmin(t / 100, 50e-9), 2e-9), p->wait_s / 2000)},
      &r, err, "V1 s 0 pwl(0 0 5u 0 %g %g)\nR1 s a 10\n", 5e-6 + t, v);
  *yes = !status && r.points > 0 && r.v[r.points - 1] < v / 2;
  vs_stand_free(&r);
  return status;
}

void vs_latching_late(const vs_stand *s, vs_figures_test test, const void *ctx, bool fires,
                      vs_figure *row) {
  const bool held = (row->held == VS_HELD_AT_MOST && row->got <= row->asked) ||
                    (row->held == VS_HELD_AT_LEAST && row->got >= row->asked);
  bool yes = !fires;
  vs_error err = {0};
  vs_status status = held ? test(s, ctx, row->asked, &yes, &err) : VS_OK;
  if (!status && yes == fires)
    status = vs_fail(&err, VS_RUN, "could not judge: at what is asked it fires, but late");
  if (!status) return;
  row->got = NAN;
  vs_test_circuit_fail(row, &err);
}

/* Two rows: the model's own figure, to a tenth, and what the maker guarantees, of which the model
 * must reach at least nine tenths. */
void vs_latching_rise(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  vs_figure *row = vs_test_circuit_row(
      s, f, (const char *[]){"dv/dt", "V/us"},
      (vs_test_circuit_source){"dv_dt", "critical_dvdt", VS_HELD_AT_LEAST, 0.12, 0.12, true}, true);
  if (!row) return;
  snprintf(row->text, sizeof row->text, "straight to %.4g V, gate open%s", 0.67 * p->block_v,
           p->way);
  vs_figures_find(s, fires_at, p, p->slope_v_s, row);
  if (isnan(row->got) && strstr(row->why, "not reached"))
    row->got = INFINITY; /* the model fires at no rise at all */
  vs_latching_plan late = *p;
  late.wait_s = VS_LATCHING_WAIT_S;
  vs_latching_late(s, fires_at, &late, true, row);
}
