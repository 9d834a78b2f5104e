/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "diode.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "diac.h"

/* ---- forward ---- */

static double forward_at(const vs_stand *s, const vs_diode_plan *p, double i, vs_figure *row) {
  vs_stand_record r = {0};
  vs_error err = {0};
  double v = NAN;
  vs_status status = vs_test_circuit_run(s, (vs_test_circuit){p->wiring, 1.1e-3, 2e-6}, &r, &err,
                                         "I1 0 a pwl(0 0 10u 0 110u %g 1.1m %g)\nVg g 0 0\n", i, i);
  if (status)
    vs_test_circuit_fail(row, &err);
  else
    v = vs_stand_at(&r, r.v, 1.09e-3);
  vs_stand_free(&r);
  return v;
}

/* The line by the model's own parameters at their test current and at a tenth of it, within 40 mV:
 * the junction that the line leaves out has 30 mV a decade. Or the limit v_f at the test current.
 */
void vs_diode_forward(const vs_stand *s, const vs_diode_plan *p, vs_figures *f) {
  vs_figures_asked v0 = vs_figures_any(s, p->v_param), slope = vs_figures_any(s, p->r_param),
                   most = vs_figures_limit(s, "v_f");
  bool limited = isfinite(most.value);
  double own_a =
      vs_figures_condition(s, true, (const char *[]){"i_test", "test_current"}, p->test_a);
  const double at_a[] = {own_a, own_a / 10, p->test_a};
  for (int n = 0; n < 3; n++) {
    double i = at_a[n];
    vs_figures_asked asked = n < 2 ? v0 : most;
    if (n < 2) asked.value += slope.value * i;
    if (isnan(asked.value) && (n > 0 || limited)) continue;
    vs_figure *row =
        vs_figures_add(f, "V_F", "V", asked, 0, n < 2 ? VS_HELD_NEAR : VS_HELD_AT_MOST);
    row->tolerance = n < 2 ? 0.04 : 0;
    if (n == 2 || !limited) vs_figures_is(row, s, "v_f");
    snprintf(row->text, sizeof row->text, "at %.4g A%s", i, p->way);
    row->got = forward_at(s, p, i, row);
  }
}

static void draw_forward(const vs_stand *s, const vs_diode_plan *p, vs_figures *f) {
  vs_stand_record r = {0};
  vs_error err = {0};
  if (!vs_test_circuit_run(s, (vs_test_circuit){p->wiring, 2.2e-3, 4e-6}, &r, &err,
                           "I1 0 a pwl(0 0 0.2m 0 2.2m %g)\n", 2 * p->test_a))
    vs_test_circuit_draw(f, &r,
                         (vs_test_circuit_view){"forward", "V_F / V", "I_F / A", 0.21e-3, 2.2e-3},
                         (const double *[]){r.v, r.i}, (const double[]){1, 1});
  vs_stand_free(&r);
}

/* ---- recovery ---- */

/* Charge, time and peak of what flows back: until a quarter of the peak is left, or for the charge
 * to the end. */
static void read_recovery(const vs_stand_record *r, double from_s, double out[3]) {
  size_t peak = 0, last;
  double zero_s = NAN, q = 0;
  for (size_t k = 1; k < r->points; k++) {
    if (r->t_s[k] <= from_s) continue;
    if (isnan(zero_s) && r->i[k] < 0) zero_s = r->t_s[k];
    if (!peak || r->i[k] < r->i[peak]) peak = k;
    q -= (fmin(r->i[k], 0) + fmin(r->i[k - 1], 0)) / 2 * (r->t_s[k] - r->t_s[k - 1]);
  }
  for (last = peak; last + 1 < r->points && r->i[last] < r->i[peak] / 4;) last++;
  out[0] = q, out[1] = r->t_s[last] - zero_s, out[2] = -r->i[peak];
}

/* The test current, which has stood for long enough to store its charge, falls at the test slope
 * through zero, until the diode takes no more and a clamp
 * at -25 V does, with a snubber beside. A tenth for the charge, as the clamp's and the
 * capacitance's part counts with it. */
void vs_diode_recovery(const vs_stand *s, const vs_diode_plan *p, vs_figures *f) {
  vs_figure *row[] = {
      vs_test_circuit_row(
          s, f, (const char *[]){"Q_rr", "A*us"},
          (vs_test_circuit_source){"q_rr", p->q_param, VS_HELD_AT_MOST, 0.1, 0, true}, false),
      vs_test_circuit_row(s, f, (const char *[]){"t_rr", "ns"},
                          (vs_test_circuit_source){"t_rr", NULL, VS_HELD_AT_MOST, 0, 0, false},
                          false),
      vs_test_circuit_row(s, f, (const char *[]){"I_RM", "A"},
                          (vs_test_circuit_source){"i_rm", NULL, VS_HELD_AT_MOST, 0, 0, false},
                          false)};
  bool own = isfinite(vs_figures_any(s, p->q_param).value);
  double i = vs_figures_condition(s, own, (const char *[]){"i_test", "test_current"}, p->test_a),
         slope =
             vs_figures_condition(s, own, (const char *[]){"di_test", "test_slope"}, p->test_a_s);
  double fall = i / slope, out[3] = {NAN, NAN, NAN},
         before = fmax(40 * fall, isfinite(row[0]->asked) ? 20 * row[0]->asked / i : 0),
         zero = before + fall, end = before + 10 * fall;
  vs_stand_record r = {0};
  vs_error err = {0};
  vs_status status = vs_test_circuit_run(s, (vs_test_circuit){p->wiring, end, fall / 100}, &r, &err,
                                         "I1 0 a pwl(0 0 %.9g %g %.9g %g %.9g %g)\nVg g 0 0\n"
                                         "Rs a c 10\nCs c 0 1n\nDc vc a clamp\nVc vc 0 -25\n"
                                         ".model clamp d(is=1n rs=10m)\n",
                                         before / 4, i, before, i, end, -9 * i);
  if (!status && !(vs_stand_at(&r, r.v, 0.99 * before) < p->least_v))
    status = vs_fail(&err, VS_RUN, "it does not conduct");
  if (!status) read_recovery(&r, before, out);
  if (!status)
    vs_test_circuit_draw(
        f, &r,
        (vs_test_circuit_view){"recovery", "t / us", "i / A", zero - 0.5 * fall, zero + 3 * fall},
        (const double *[]){r.t_s, r.i}, (const double[]){1e-6, 1});
  for (int n = 0; n < 3; n++) {
    row[n]->got = out[n];
    snprintf(row[n]->text, sizeof row[n]->text, "%.4g A falling at %.4g A/us%s%s", i, slope * 1e-6,
             n == 1 ? ", to a quarter of I_RM" : "", p->way);
    if (status) vs_test_circuit_fail(row[n], &err);
  }
  vs_stand_free(&r);
}

/* ---- breakdown ---- */

void vs_diode_breakdown(const vs_stand *s, const char *wiring, const char *const name_limit[2],
                        int up, vs_figures *f) {
  vs_figures_asked limit = vs_figures_limit(s, name_limit[1]),
                   own = vs_figures_any(s, "blocking_voltage");
  vs_figure *row = vs_figures_add(f, name_limit[0], "V", isfinite(limit.value) ? limit : own, 0,
                                  VS_HELD_AT_LEAST);
  vs_stand_record r = {0};
  vs_error err = {0};
  snprintf(row->text, sizeof row->text, "breakdown, at 1 mA");
  vs_status status = vs_test_circuit_run(s, (vs_test_circuit){wiring, 20e-3, 20e-6}, &r, &err,
                                         "I1 0 a pwl(0 0 10m %g)\nVg g 0 0\n", up * 1e-3);
  if (status)
    vs_test_circuit_fail(row, &err);
  else
    row->got = up * vs_stand_at(&r, r.v, 19e-3);
  vs_stand_free(&r);
}

/* ---- all ---- */

/* A diode that is not what is asked may be no diode. */
static void suspect(const vs_stand *s, vs_figures *f) {
  bool good = true;
  for (size_t k = 0; k < f->count && good; k++)
    good = f->row[k].held == VS_HELD_NOT || !strcmp(vs_figures_word(&f->row[k]), "held");
  if (!good) vs_diac_suspect(s, f);
}

static void measure_diode(const vs_stand *s, vs_figures *f) {
  static const char *const TEST[] = {"i_test", "test_current", "i_f_av", NULL}, *const FALL[] = {
                                                                                    "di_test",
                                                                                    "test_slope",
                                                                                    NULL};
  const vs_diode_plan p = {.wiring = "Xdut t 0 %s",
                           .way = "",
                           .v_param = "on_voltage",
                           .r_param = "on_resistance",
                           .q_param = "recovered_charge",
                           .test_a = vs_figures_first(s, TEST, 1),
                           .test_a_s = vs_figures_first(s, FALL, 50e6),
                           .least_v = 20};
  vs_diode_forward(s, &p, f);
  draw_forward(s, &p, f);
  vs_diode_breakdown(s, p.wiring, (const char *[]){"V_R", "v_rrm"}, -1, f);
  vs_diode_recovery(s, &p, f);
  suspect(s, f);
}

const vs_figures_kind vs_diode_kind = {"diode", measure_diode};
