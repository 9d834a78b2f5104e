/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a thyristor, tried: V_T, I_GT, V_GT, I_L, I_H, dv/dt, t_q, Q_rr, and
 * how fast the model turns on. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "latching.h"

/* The test current falls to zero at the test slope, then -25 V, and so long after the zero the
 * forward voltage passes zero at 20 V/us or less: does it stay off? */
static vs_status stays_off_after(const vs_stand *s, const void *ctx, double t_q, bool *yes,
                                 vs_error *err) {
  const vs_latching_plan *p = ctx;
  double i = p->test_a, zero = 300e-6 + i / p->test_a_s, gate = 3 * p->gate_a;
  double back = zero + fmax(t_q, 1.4e-6), v = 0.67 * p->block_v, up = back + v / p->back_v_s;
  vs_stand_record r = {0};
  vs_status status = vs_test_circuit_run(
      s, (vs_test_circuit){p->wiring, up + 50e-6 + p->wait_s, fmax(0.2e-6, p->wait_s / 2000)}, &r,
      err,
      "I1 0 a pwl(0 0 20u 0 70u %g 300u %g %.9g 0)\nIg 0 g pwl(0 %g 100u %g 101u 0)\n"
      "S1 a w ct 0 joined\n.model joined sw(ron=1 roff=1g vt=0.5 vh=0.1)\n"
      "Vct ct 0 pwl(0 0 %.9g 0 %.9g 1)\nVw w 0 pwl(0 -25 %.9g -25 %.9g %g)\n",
      i, i, zero, gate, gate, zero, zero + 1e-7, back - 25 / p->back_v_s, up, v);
  if (!status && vs_stand_at(&r, r.v, 299e-6) > 20) status = vs_latching_not_on(err);
  *yes = !status && r.points > 0 && r.v[r.points - 1] > v / 2;
  vs_stand_free(&r);
  return status;
}

static void turn_off_thyristor(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  vs_figure *row = vs_test_circuit_row(
      s, f, (const char *[]){"t_q", "us"},
      (vs_test_circuit_source){"t_q", "turn_off_time", VS_HELD_AT_MOST, 0.1, 0, true}, true);
  if (!row) return;
  snprintf(row->text, sizeof row->text, "%.4g A falling at %.4g A/us, -25 V, back at %.4g V/us",
           p->test_a, p->test_a_s * 1e-6, p->back_v_s * 1e-6);
  vs_figures_find(s, stays_off_after, p, p->turn_off_s, row);
  if (isnan(row->got) && strstr(row->why, "below")) row->got = 0; /* the model is off at once */
  vs_latching_plan late = *p;
  late.wait_s = VS_LATCHING_WAIT_S;
  vs_latching_late(s, stays_off_after, &late, false, row);
}

/* The test current falls at the test slope through zero, until the device takes no more and a diode
 * at -25 V does, with a snubber beside: what flowed back. */
static void recovery(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  vs_figure *row = vs_test_circuit_row(
      s, f, (const char *[]){"Q_rr", "A*us"},
      (vs_test_circuit_source){"q_rr", "recovered_charge", VS_HELD_AT_MOST, 0.03, 0, true}, false);
  double i = p->test_a, fall = i / p->test_a_s, gate = 3 * p->gate_a, zero = 300e-6 + fall, q = 0;
  vs_stand_record r = {0};
  vs_error err = {0};
  snprintf(row->text, sizeof row->text, "%.4g A falling at %.4g A/us", i, p->test_a_s * 1e-6);
  vs_status status =
      vs_test_circuit_run(s, (vs_test_circuit){p->wiring, 300e-6 + 10 * fall, fall / 200}, &r, &err,
                          "I1 0 a pwl(0 0 20u 0 70u %g 300u %g %.9g %g)\n"
                          "Ig 0 g pwl(0 %g 100u %g 101u 0)\nRs a c 10\nCs c 0 20n\n"
                          "Dc vc a clamp\nVc vc 0 -25\n.model clamp d(is=1n rs=10m)\n",
                          i, i, 300e-6 + 10 * fall, -9 * i, gate, gate);
  if (!status && vs_stand_at(&r, r.v, 299e-6) > 20) status = vs_latching_not_on(&err);
  for (size_t k = 1; k < r.points && !status; k++)
    if (r.t_s[k] > 300e-6)
      q -= (fmin(r.i[k], 0) + fmin(r.i[k - 1], 0)) / 2 * (r.t_s[k] - r.t_s[k - 1]);
  if (status) {
    vs_test_circuit_fail(row, &err);
  } else {
    row->got = q;
    vs_test_circuit_draw(
        f, &r,
        (vs_test_circuit_view){"recovery", "t / us", "i / A", zero - 0.5 * fall, zero + 3 * fall},
        (const double *[]){r.t_s, r.i}, (const double[]){1e-6, 1});
  }
  vs_stand_free(&r);
}

/* Fired by 3 I_GT from 0.67 V_DRM into 100 ohm and no inductance: how fast the current rises from
 * 10 to 90 %. Nothing is asked; it says what the model can do to a snubber. */
static void turn_on(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  vs_figure *row = vs_figures_add(f, "di/dt", "A/us", (vs_figures_asked){NAN, {0}}, 0, VS_HELD_NOT);
  double v = 0.67 * p->block_v, gate = 3 * p->gate_a, peak = 0, from = NAN, to = NAN;
  vs_stand_record r = {0};
  vs_error err = {0};
  snprintf(row->text, sizeof row->text, "what the model does, fired at %.4g V into 100 ohm", v);
  vs_status status = vs_test_circuit_run(s, (vs_test_circuit){p->wiring, 1e-3, 1e-6}, &r, &err,
                                         "V1 s 0 pwl(0 0 0.8m %g)\nR1 s a 100\n"
                                         "Ig 0 g pwl(0 0 0.9m 0 0.901m %g)\n",
                                         v, gate);
  for (size_t k = 0; k < r.points && !status; k++) peak = fmax(peak, r.i[k]);
  if (!status && peak < 0.5 * v / 100) status = vs_latching_not_on(&err);
  for (size_t k = 1; k < r.points && !status; k++) {
    double t[2], level[] = {0.1 * peak, 0.9 * peak};
    for (int n = 0; n < 2; n++)
      t[n] = r.i[k - 1] < level[n] && r.i[k] >= level[n]
                 ? r.t_s[k - 1] +
                       (level[n] - r.i[k - 1]) / (r.i[k] - r.i[k - 1]) * (r.t_s[k] - r.t_s[k - 1])
                 : NAN;
    if (isfinite(t[0]) && isnan(from)) from = t[0];
    if (isfinite(t[1]) && isnan(to)) to = t[1];
  }
  if (!status && to > from) row->got = 0.8 * peak / (to - from);
  if (status) vs_test_circuit_fail(row, &err);
  vs_stand_free(&r);
}

/* ---- all ---- */

static void measure_thyristor(const vs_stand *s, vs_figures *f) {
  vs_latching_plan p = vs_latching_plan_of(s);
  vs_latching_fire(s, &p);
  vs_latching_on_state(s, &p, f);
  vs_latching_draw_on_state(s, &p, f);
  vs_latching_gate(s, &p, f);
  vs_latching_current(s, &p, f);
  vs_latching_holding(s, &p, f);
  vs_latching_rise(s, &p, f);
  turn_off_thyristor(s, &p, f);
  recovery(s, &p, f);
  turn_on(s, &p, f);
  vs_stand_free(&p.seen);
}

const vs_figures_kind vs_thyristor_kind = {"thyristor", measure_thyristor};
