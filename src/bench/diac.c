/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a diac, tried in both directions: V_BO, I_BO, the voltage that it loses
 * as it breaks over, its on-state. */
#include "diac.h"

#include <math.h>
#include <stdio.h>

/* One direction: how the part stands, what its rows say, and what was seen; NaN: it was not. */
typedef struct direction {
  const char *wiring, *way;
  double v_bo, i_bo, v_test; /* V and A where it breaks over; V at test_a behind that */
  double test_a;             /* the test current, or more where that does not break it over */
  vs_error why;              /* it does not break over */
} direction;

static const direction WAYS[] = {{.wiring = "Xdut t 0 %s", .way = ", positive"},
                                 {.wiring = "Xdut 0 t %s", .way = ", negative"}};

/* The place in the record where the voltage is highest before it falls by 3 %; 0: it does not. A
 * diac's loss is 10 % and more. The first volt is any junction's. */
static size_t breaks_over(const vs_stand_record *r) {
  static const double FALLS = 0.97, LEAST_V = 1;
  size_t highest = 0;
  for (size_t k = 1; k < r->points; k++) {
    if (r->v[k] > r->v[highest]) highest = k;
    if (r->v[highest] > LEAST_V && r->v[k] < FALLS * r->v[highest]) return highest;
  }
  return 0;
}

/* A supply rises within `rise_s` to twice `volt`, behind a resistance by which the test current
 * flows at `volt`. */
static vs_status rise(const vs_stand *s, direction *d, double volt, double test_a, double rise_s,
                      vs_stand_record *r, vs_error *err) {
  vs_stand_free(r);
  vs_status status =
      vs_test_circuit_run(s, (vs_test_circuit){d->wiring, rise_s, rise_s / 4000}, r, err,
                          "V1 s 0 pwl(0 0 %g %g)\nR1 s a %g\n", rise_s, 2 * volt, volt / test_a);
  size_t at = status ? 0 : breaks_over(r), k = at;
  d->v_bo = at ? r->v[at] : NAN;
  d->i_bo = at ? r->i[at] : NAN;
  d->test_a = test_a;
  while (at && k + 1 < r->points && !(r->i[k] >= test_a && r->v[k] < 0.97 * d->v_bo)) k++;
  d->v_test = at && r->i[k] >= test_a ? r->v[k] : NAN;
  return status;
}

/* Looks for V_BO from half of what is expected to 32 times of it, with a current that breaks it
 * over, up to 1 A, as a sidac wants more than a diac; and then measures with a supply made for what
 * was found. A model that is slow breaks over late, at a voltage that is the higher the faster the
 * supply rises: it rises more slowly until V_BO stays within half a per cent. */
static vs_status seek(const vs_stand *s, direction *d, double volt, double test_a,
                      vs_stand_record *r) {
  static const double STAYS = 0.005, MOST_A = 1, SLOWEST_S = 1;
  vs_status status = rise(s, d, volt, test_a, 20e-3, r, &d->why);
  for (int n = 0; !status && isnan(d->v_bo) && n < 5;) {
    const double end_v = r->v[r->points - 1];
    if (end_v > 1.9 * volt)
      volt *= 2, n++;
    else if (test_a < MOST_A)
      volt = fmax(end_v, 1), test_a *= 5;
    else
      return vs_fail(&d->why, VS_RUN,
                     "it conducts at %.3g V and does not break over, as a diode or a varistor does",
                     end_v);
    status = rise(s, d, volt, test_a, 20e-3, r, &d->why);
  }
  if (!status && isnan(d->v_bo))
    return vs_fail(&d->why, VS_RUN, "it does not break over up to %.3g V", volt);
  double before = INFINITY;
  for (double rise_s = 40e-3; !status && !(fabs(d->v_bo / before - 1) < STAYS); rise_s *= 2) {
    if (rise_s > SLOWEST_S || isnan(d->v_bo))
      return vs_fail(&d->why, VS_RUN,
                     "could not judge: the slower the voltage rises, the lower it breaks over");
    before = d->v_bo;
    status = rise(s, d, before, test_a, rise_s, r, &d->why);
  }
  return status;
}

static void fill(vs_figure *row, const direction *d, double got, const char *text) {
  if (!row) return;
  snprintf(row->text, sizeof row->text, "%s%s", text, d->way);
  row->got = got;
  if (isnan(got) && d->why.text[0])
    vs_test_circuit_fail(row, &d->why);
  else if (isnan(got))
    snprintf(row->why, sizeof row->why, "that current does not flow once it has broken over");
}

/* A maker gives the least V_BO, the most, or both. */
static vs_figure *add_breakover(const vs_stand *s, vs_figures *f) {
  vs_figures_asked least = vs_figures_limit(s, "v_bo_min"), most = vs_figures_limit(s, "v_bo_max"),
                   middle = {(least.value + most.value) / 2, least.where};
  if (isfinite(middle.value))
    return vs_figures_add(f, "V_BO", "V", middle, (most.value - middle.value) / middle.value,
                          VS_HELD_NEAR);
  return isfinite(most.value) ? vs_figures_add(f, "V_BO", "V", most, 0, VS_HELD_AT_MOST)
                              : vs_figures_add(f, "V_BO", "V", least, 0, VS_HELD_AT_LEAST);
}

static vs_figure *add(const vs_stand *s, vs_figures *f, const char *const name_unit[2],
                      const char *limit, vs_held held) {
  return vs_test_circuit_row(s, f, name_unit, (vs_test_circuit_source){limit, NULL, held, 0, 0, 0},
                             true);
}

/* As near to none as the sheet says. */
static void add_symmetry(const vs_stand *s, vs_figures *f, const direction way[2]) {
  vs_figures_asked most = vs_figures_limit(s, "v_bo_symmetry");
  if (isnan(most.value)) return;
  vs_figure *row =
      vs_figures_add(f, "V_BO", "V", (vs_figures_asked){0, most.where}, 0, VS_HELD_NEAR);
  row->tolerance = most.value;
  snprintf(row->text, sizeof row->text, "difference of the two directions");
  row->got = way[0].v_bo - way[1].v_bo;
  if (isnan(row->got)) snprintf(row->why, sizeof row->why, "it does not break over both ways");
}

static double test_current(const vs_stand *s) {
  return vs_figures_first(s, (const char *[]){"i_test", NULL}, 10e-3);
}

static void measure_diac(const vs_stand *s, vs_figures *f) {
  static const char *const EXPECTED[] = {"v_bo_max", "v_bo_min", NULL};
  const double test_a = test_current(s);
  direction way[] = {WAYS[0], WAYS[1]};
  for (int n = 0; n < 2; n++) {
    vs_stand_record r = {0};
    if (!seek(s, &way[n], vs_figures_first(s, EXPECTED, 32), test_a, &r))
      vs_test_circuit_draw(f, &r,
                           (vs_test_circuit_view){n ? "breakover, negative" : "breakover", "v / V",
                                                  "i / mA", 0, r.t_s[r.points - 1]},
                           (const double *[]){r.v, r.i}, (const double[]){1, 1e-3});
    else
      way[n].v_bo = way[n].i_bo = way[n].v_test = NAN;
    vs_stand_free(&r);
    char lost[64], at[64];
    snprintf(lost, sizeof lost, "from breakover to %.4g mA", 1e3 * way[n].test_a);
    snprintf(at, sizeof at, "at %.4g mA, once it has broken over", 1e3 * way[n].test_a);
    fill(add_breakover(s, f), &way[n], way[n].v_bo, "breakover, the voltage rising slowly");
    fill(add(s, f, (const char *[]){"I_BO", "uA"}, "i_bo", VS_HELD_AT_MOST), &way[n], way[n].i_bo,
         "at breakover");
    fill(add(s, f, (const char *[]){"dV", "V"}, "dv_bo", VS_HELD_AT_LEAST), &way[n],
         way[n].v_bo - way[n].v_test, lost);
    fill(add(s, f, (const char *[]){"V_T", "V"}, "v_t", VS_HELD_AT_MOST), &way[n], way[n].v_test,
         at);
  }
  add_symmetry(s, f, way);
}

void vs_diac_suspect(const vs_stand *s, vs_figures *f) {
  direction way[] = {WAYS[0], WAYS[1]};
  for (int n = 0; n < 2; n++) {
    vs_stand_record r = {0};
    vs_status status = seek(s, &way[n], 32, 10e-3, &r);
    vs_stand_free(&r);
    if (status) return;
  }
  snprintf(f->shows, sizeof f->shows,
           "it blocks either way and breaks over at %.3g V and at %.3g V, as a diac does and no "
           "diode: vibrospice part diac --wrap FILE:NAME makes it one",
           way[0].v_bo, -way[1].v_bo);
}

const vs_figures_kind vs_diac_kind = {"diac", measure_diac};
