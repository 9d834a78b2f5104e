/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a triac, tried in both directions: as a thyristor either way, the gate
 * in four quadrants, and the rise behind a commutation. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "latching.h"

/* The quadrants: the part's main terminal 2 at t and its gate at g, or in the mirror. In the first,
 * MT2 and the gate are positive; in the second the gate is negative; in the third both are. */
static const struct quadrant {
  const char *wiring, *way, *param, *limit;
} QUADRANTS[] = {{VS_TRYOUT_MIRROR "Xdut t 0 g %s", ", MT2+, gate +", "gate_current", "i_gt"},
                 {VS_TRYOUT_MIRROR "Xdut t 0 n %s", ", MT2+, gate -", "gate_current_2", "i_gt"},
                 {VS_TRYOUT_MIRROR "Xdut m 0 n %s", ", MT2-, gate -", "gate_current_3", "i_gt"},
                 {VS_TRYOUT_MIRROR "Xdut m 0 g %s", ", MT2-, gate +", "gate_current_4", "i_gt_4"}};
enum { FIRST, SECOND, THIRD, FOURTH };

static vs_latching_plan plan_of(const vs_stand *s, int quadrant, const char *way) {
  const struct quadrant *q = &QUADRANTS[quadrant];
  const char *const gate[] = {q->param, q->limit, "gate_current", NULL};
  vs_latching_plan p = vs_latching_plan_of(s);
  p.wiring = q->wiring;
  p.way = way ? way : q->way;
  p.gate_param = q->param;
  p.gate_limit = q->limit;
  p.gate_a = vs_figures_first(s, gate, p.gate_a);
  return p;
}

/* A device that is specified in three quadrants says so by a parameter of 1 kA or more, or by no
 * limit. */
static bool is_asked(const vs_stand *s, int quadrant) {
  double own = vs_figures_any(s, QUADRANTS[quadrant].param).value;
  return isfinite(own) ? own < 1e3 : isfinite(vs_figures_limit(s, QUADRANTS[quadrant].limit).value);
}

/* A current falls at (dI/dt)c to zero; then the voltage the other way rises by dv/dt to 0.67 V_DRM:
 * does it conduct? */
typedef struct commutation {
  const vs_latching_plan *p;
  double a_s;
  double fall_s; /* how long the current falls: longer than anything of it is remembered */
} commutation;

static vs_status conducts_again(const vs_stand *s, const void *ctx, double v_s, bool *yes,
                                vs_error *err) {
  const commutation *c = ctx;
  double i = c->a_s * c->fall_s, begin = 0.3e-3, zero = begin + c->fall_s, v = 0.67 * c->p->block_v,
         end = zero + v / v_s, gate = 3 * c->p->gate_a;
  vs_stand_record r = {0};
  vs_status status = vs_test_circuit_run(
      s,
      (vs_test_circuit){c->p->wiring, end + 60e-6 + c->p->wait_s,
                        fmin(2e-6, fmax(v / v_s / 50, end / 4000))},
      &r, err,
      "I1 0 a pwl(0 0 20u 0 70u %g %g %g %.9g 0)\nIg 0 g pwl(0 %g 0.2m %g 0.201m 0)\n"
      "S1 a w ct 0 joined\n.model joined sw(ron=10 roff=1meg vt=0.5 vh=0.1)\n"
      "Vct ct 0 pwl(0 0 %.9g 0 %.9g 1)\nVw w 0 pwl(0 0 %.9g 0 %.9g %g)\n",
      i, begin, i, zero, gate, gate, zero, zero + 1e-7, zero, end, -v);
  if (!status && vs_stand_at(&r, r.v, 0.99 * begin) > 20) status = vs_latching_not_on(err);
  *yes = !status && r.points > 0 && r.v[r.points - 1] > -v / 2;
  vs_stand_free(&r);
  return status;
}

static void commutating_rise(const vs_stand *s, const vs_latching_plan *p, vs_figures *f) {
  static const char *const RISE[] = {"dv_dt_c", NULL}, *const FALL[] = {"commutating_didt",
                                                                        "di_dt_c", NULL};
  vs_figure *row = vs_test_circuit_row(
      s, f, (const char *[]){"(dv/dt)c", "V/us"},
      (vs_test_circuit_source){"dv_dt_c", NULL, VS_HELD_AT_LEAST, 0, 0.1, false}, true);
  if (!row) return;
  double rise = vs_figures_first(s, RISE, 10e6), fall = vs_figures_first(s, FALL, 5e3);
  const commutation c = {p, fall,
                         fmin(p->test_a / 2 / fall, fmax(0.3e-3, 5 * 0.67 * p->block_v / rise))};
  snprintf(row->text, sizeof row->text, "behind a current that falls at %.4g A/ms%s", c.a_s * 1e-3,
           p->way);
  vs_figures_find(s, conducts_again, &c, rise, row);
  if (isnan(row->got) && strstr(row->why, "not reached")) row->got = INFINITY;
  vs_latching_plan late = *p;
  late.wait_s = VS_LATCHING_WAIT_S;
  commutation again = c;
  again.p = &late;
  vs_latching_late(s, conducts_again, &again, true, row);
}

static void measure_triac(const vs_stand *s, vs_figures *f) {
  vs_latching_plan way[] = {plan_of(s, FIRST, ", MT2+"), plan_of(s, THIRD, ", MT2-")};
  for (int n = 0; n < 2; n++) vs_latching_fire(s, &way[n]);
  for (int n = 0; n < 2; n++) vs_latching_on_state(s, &way[n], f);
  vs_latching_draw_on_state(s, &way[0], f);
  for (int q = FIRST; q <= FOURTH; q++) {
    vs_latching_plan p = plan_of(s, q, NULL);
    if (q != FIRST && !is_asked(s, q)) continue;
    vs_latching_fire(s, &p);
    vs_latching_gate(s, &p, f);
    vs_stand_free(&p.seen);
  }
  for (int n = 0; n < 2; n++) {
    vs_latching_current(s, &way[n], f);
    vs_latching_holding(s, &way[n], f);
    vs_latching_rise(s, &way[n], f);
    commutating_rise(s, &way[n], f);
    vs_stand_free(&way[n].seen);
  }
}

const vs_figures_kind vs_triac_kind = {"triac", measure_triac};
