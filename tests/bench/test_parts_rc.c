/* SPDX-License-Identifier: GPL-3.0-or-later
 * The RC snubber against closed forms: a voltage E switched onto an inductance L with the snubber
 * across the open switch. zeta = R/2 sqrt(C/L), chi = I_RR/E sqrt(L/C), omega0 = 1/sqrt(LC). */
#include <math.h>
#include <stdio.h>

#include "bench.h"
#include "suite.h"

/* Peak of the voltage across the snubber and of its rate. */
typedef struct peaks {
  double t_s, v, peak_v, peak_v_per_s, at_s;
} peaks;

static void see_peaks(void *ctx, double t_s, const double *signals) {
  peaks *p = ctx;
  double v = signals[0];
  if (p->t_s > 0) {
    double rate = (v - p->v) / (t_s - p->t_s);
    if (fabs(rate) > fabs(p->peak_v_per_s)) *p = (peaks){p->t_s, p->v, p->peak_v, rate, t_s};
  }
  if (fabs(v) > fabs(p->peak_v)) p->peak_v = v;
  p->t_s = t_s;
  p->v = v;
}

typedef struct stage {
  double e_v, l_h, r_load_ohm, r_ohm, c_f, i0_a;
} stage;

/* Steps of 1/1000 radian: the peak and the rate then agree with the closed forms to the digits
 * these are given in (half a unit of the fourth decimal). */
static peaks switch_on(const stage *s) {
  char deck[512];
  double radian_s = sqrt(s->l_h * s->c_f);
  peaks p = {0};
  snprintf(deck, sizeof deck,
           "*$ param snubber = rc_snubber part \"across the switch\"\n"
           "Vs s 0 %.17g\nRl s x %.17g\nLl x a %.17g ic=%.17g\nXs a 0 snubber rs=%.17g cs=%.17g\n",
           s->e_v, s->r_load_ohm, s->l_h, s->i0_a, s->r_ohm, s->c_f);
  bench b = {.deck = deck,
             .signals = {"v(a)"},
             .until_s = 5 * radian_s,
             .max_step_s = radian_s / 1000,
             .relative_tolerance = 1e-6,
             .see = see_peaks,
             .ctx = &p};
  vs_error err = {0};
  vs_status status = bench_run(&b, &err);
  EXPECT(status == VS_OK, "%s", err.text);
  return p;
}

/* E 100 V, L 1 mH, C 100 nF, so 100 ohm to the unit of impedance. The load's resistance is a
 * nano-ohm. */
static stage normal(double zeta, double chi) {
  double z = sqrt(1e-3 / 100e-9);
  return (stage){100, 1e-3, 1e-9, 2 * zeta * z, 100e-9, chi * 100 / z};
}

static void six_damping_ratios(void) {
  static const struct {
    double zeta, peak, rate; /* V_pk/E, max dv/dt/(E omega0) */
  } ROWS[] = {{.05, 1.8588, .9313}, {.1, 1.7441, .8801}, {.2, 1.5717, .8209}, {.265, 1.4887, .8101},
              {.3, 1.4510, .8134},  {.5, 1.2984, 1.0},   {1, 1.1353, 2.0}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    stage s = normal(ROWS[k].zeta, 0);
    peaks p = switch_on(&s);
    CLOSE(p.peak_v / s.e_v, ROWS[k].peak, 1e-4);
    CLOSE(p.peak_v_per_s * sqrt(s.l_h * s.c_f) / s.e_v, ROWS[k].rate, 1e-4);
  }
}

/* The least peak that any damping gives at a recovered current (McMurray 1972): it is that value
 * there, and more on both sides. */
static void least_peaks(void) {
  static const struct {
    double chi, zeta, peak;
  } ROWS[] = {{.5, 1.096, 1.1773}, {.7, .834, 1.3005}, {1, .645, 1.5062},
              {1.5, .506, 1.8760}, {2, .440, 2.2610},  {3, .378, 3.0494}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    stage s = normal(ROWS[k].zeta, ROWS[k].chi), less = normal(ROWS[k].zeta * 0.85, ROWS[k].chi),
          more = normal(ROWS[k].zeta * 1.2, ROWS[k].chi);
    double peak = switch_on(&s).peak_v;
    CLOSE(peak / s.e_v, ROWS[k].peak, 1e-4);
    CU_ASSERT(switch_on(&less).peak_v > peak);
    CU_ASSERT(switch_on(&more).peak_v > peak);
  }
}

/* With all the resistance in the load: 1 + exp(-pi zeta/sqrt(1 - zeta^2)). */
static void resistance_in_the_load(void) {
  static const double ZETA[] = {.1, .3, .6};
  for (size_t k = 0; k < COUNT(ZETA); k++) {
    double z = ZETA[k];
    stage s = normal(z, 0);
    s.r_load_ohm = s.r_ohm;
    s.r_ohm = 1e-3;
    CLOSE(switch_on(&s).peak_v / s.e_v, 1 + exp(-M_PI * z / sqrt(1 - z * z)), 1e-3);
  }
}

/* The conveyor's own coil, 1.6 H and 92 ohm, at the mains of its extinction, kept constant: the
 * snubber's resistor is far from damping it, and reverse voltage, not its rate, is what sizes it.
 */
static void finding_for_this_load(void) {
  static const struct {
    double r_ohm, peak_v, rate_v_per_us, at_ms;
  } ROWS[] = {{100, -1104.5, 1.38, .61}, {2e3, -852.0, 1.15, .33}, {4e3, -736.4, 1.43, 0}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    stage s = {-573.0, 1.6, 92, ROWS[k].r_ohm, 100e-9, 0};
    peaks p = switch_on(&s);
    CLOSE(p.peak_v, ROWS[k].peak_v, 1e-4);
    CLOSE_OF(fabs(p.peak_v_per_s) * 1e-6, ROWS[k].rate_v_per_us, ROWS[k].rate_v_per_us, 5e-3);
    CLOSE_OF(p.at_s * 1e3, ROWS[k].at_ms, 1, 0.02); /* two digits are given, and the top is flat */
  }
}

/* The part's own values reach it: by default the ones of its *$ lines. */
static void defaults_are_the_parts(void) {
  bench b = {.deck = "*$ param snubber = rc_snubber part \"under test\"\n"
                     "Is 0 a 1\nXs a 0 snubber\n",
             .signals = {"v(a)"},
             .until_s = 1e-6,
             .max_step_s = 1e-8,
             .relative_tolerance = 1e-6};
  vs_error err = {0};
  EXPECT(bench_run(&b, &err) == VS_OK, "%s", err.text);
  CLOSE(b.last[0], 100 + 1e-6 / 100e-9, 1e-6); /* 1 A for 1 us */
}

static const vs_test TESTS[] = {
    {"damping ratios", six_damping_ratios},
    {"least peaks", least_peaks},
    {"resistance in the load", resistance_in_the_load},
    {"this load", finding_for_this_load},
    {"defaults", defaults_are_the_parts},
};
VS_SUITE_MAIN("RC snubber", TESTS)
