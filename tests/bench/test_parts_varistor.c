/* SPDX-License-Identifier: GPL-3.0-or-later
 * Varistors as parts: the voltage at given currents against the formula each claims, and the
 * terminal capacitance. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/path.h"
#include "bench.h"
#include "suite.h"

/* Voltage that a current drives across a varistor, once its capacitance c_f is charged to v_v.
 * device: what stands behind the nodes of the instance, and part the part that "varistor" means. */
static double voltage_at(const char *part, const char *device, double i_a, double charge_s) {
  char deck[512];
  snprintf(deck, sizeof deck,
           "*$ param varistor = %s part \"under test\"\nIs 0 a %.17g\nXv a 0 varistor %s\n", part,
           i_a, device);
  bench b = {.deck = deck,
             .signals = {"v(a)"},
             .until_s = 10 * charge_s,
             .max_step_s = charge_s / 20,
             .relative_tolerance = 1e-7};
  vs_error err = {0};
  EXPECT(bench_run(&b, &err) == VS_OK, "%s at %g A: %s", part, i_a, err.text);
  return b.last[0];
}

/* i = 1 mA (v/V)^exponent, in both directions. */
static void power_law(void) {
  static const double I_A[] = {1e-5, 1e-3, 1, 100, 5e3};
  for (size_t k = 0; k < COUNT(I_A); k++) {
    double v = 910 * pow(I_A[k] / 1e-3, 1 / 30.), charge_s = 500e-12 * v / I_A[k];
    CLOSE(voltage_at("varistor_power", "", I_A[k], charge_s), v, 1e-6);
    CLOSE(voltage_at("varistor_power", "", -I_A[k], charge_s), -v, 1e-6);
    v = 750 * pow(I_A[k] / 1e-3, 1 / 40.); /* an instance with values of its own */
    CLOSE(voltage_at("varistor_power", "v_1ma=750 alpha=40", I_A[k], charge_s), v, 1e-6);
  }
}

typedef struct disc {
  const char *part;
  double b[4], c_f;
  double v_1ma, class_a, class_v; /* from the maker's table: at 1 mA; the class current, and the
                                     most that 10 % tolerance allows there */
} disc;

static double siov(const disc *d, double i_a) {
  double x = log10(i_a);
  return pow(10, d->b[0] + d->b[1] * x + d->b[2] * exp(-x) + d->b[3] * exp(x));
}

static const disc DISCS[] = {
    {"varistor_siov", {2.9645747, .0260556, -.0005738, .0046503}, 380e-12, 750, 100, 1240},
    {"s20k460", {2.9645747, .0260556, -.0005738, .0046503}, 380e-12, 750, 100, 1240},
    {"s20k510", {3.0062556, .0273565, -.0005380, .0039692}, 340e-12, 820, 100, 1355},
    {"s14k460", {2.9766991, .0305633, -.0005033, .0039128}, 200e-12, 750, 50, 1240},
    {"s14k510", {3.0149757, .0300827, -.0005012, .0040162}, 180e-12, 820, 50, 1355},
};

/* The inverse against the polynomial, on knots of its table and between them: the bounds are those
 * that spice/siov.inc states. */
static void inverted_polynomial(void) {
  static const struct {
    double i_a, bound;
  } ROWS[] = {{1.5e-7, 6e-4}, {1.8e-6, 2e-4}, {2e-5, 5e-5}, {1e-4, 1e-6}, {1.8e-4, 1e-5},
              {1e-3, 1e-6},   {1.8e-3, 1e-6}, {.018, 1e-6}, {.18, 1e-6},  {1, 1e-6},
              {1.8, 1e-6},    {18, 1e-5},     {100, 1e-6},  {180, 5e-5},  {1.8e3, 2e-4},
              {6.5e3, 2e-4},  {1e4, 1e-6},    {1.8e4, 5e-4}};
  for (size_t d = 0; d < COUNT(DISCS); d += 2) /* three discs, to be quick */
    for (size_t k = 0; k < COUNT(ROWS); k++) {
      double v = siov(&DISCS[d], ROWS[k].i_a), charge_s = DISCS[d].c_f * v / ROWS[k].i_a;
      CLOSE(voltage_at(DISCS[d].part, "", ROWS[k].i_a, charge_s), v, ROWS[k].bound);
      CLOSE(voltage_at(DISCS[d].part, "", -ROWS[k].i_a, charge_s), -v, ROWS[k].bound);
    }
}

/* Below 100 nA it is a resistor. */
static void linear_below(void) {
  const disc *d = &DISCS[0];
  double v = siov(d, 1e-7) / 10;
  CLOSE(voltage_at(d->part, "", 1e-8, d->c_f * v / 1e-8), v, 1e-4);
}

/* What a buyer's test finds: the varistor voltage at 1 mA is the nominal one, to the polynomial's
 * own 0.5 %; 1.1 times the voltage at the class current is what the table allows at most there. */
static void acceptance(void) {
  for (size_t k = 0; k < COUNT(DISCS); k++) {
    const disc *d = &DISCS[k];
    double v[3], i_a[3] = {1e-3, 1, d->class_a};
    for (int n = 0; n < 3; n++)
      v[n] = voltage_at(d->part, "", i_a[n], d->c_f * siov(d, i_a[n]) / i_a[n]);
    printf(" %s %.2f %.2f %.2f V\n", d->part, v[0], v[1], v[2]);
    CLOSE(v[0], d->v_1ma, 5e-3);
    CLOSE(v[1], siov(d, 1), 1e-6);
    CLOSE(1.1 * v[2], d->class_v, 0.01);
  }
}

/* The power-law devices, by their table: nominal at 1 mA, and from the most that is allowed there
 * (825 and 902 V) to the most at 200 A. */
static void acceptance_by_power_law(void) {
  static const struct {
    const char *part;
    double v_1ma, most_1ma, most_200a;
  } ROWS[] = {{"v481da40", 750, 825, 1240}, {"v511da40", 820, 902, 1350}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double v[3], i_a[3] = {1e-3, 1, 200};
    for (int n = 0; n < 3; n++) v[n] = voltage_at(ROWS[k].part, "", i_a[n], 3e-9 * 1e3 / i_a[n]);
    printf(" %s %.2f %.2f %.2f V\n", ROWS[k].part, v[0], v[1], v[2]);
    CLOSE(v[0], ROWS[k].v_1ma, 1e-6);
    CLOSE(v[2] / v[0], ROWS[k].most_200a / ROWS[k].most_1ma, 1e-3);
  }
}

/* Three varistors in one deck, three parts that rest on the same file, and two instances of one
 * part with values of their own: each carries its own current. */
static void several_in_one_deck(void) {
  bench b = {.deck = "*$ param first = s20k460 part \"V1\"\n*$ param second = s14k510 part \"V2\"\n"
                     "*$ param third = varistor_siov part \"V3\"\n"
                     "I1 0 a 1\nX1 a 0 first\nI2 0 b 1\nX2 b 0 second\nI3 0 c3 1\nX3 c3 0 third\n"
                     "I4 0 d 1\nX4 d 0 third b1=3.0062556 b2=0.0273565 b3=-0.000538 b4=0.0039692\n",
             .signals = {"v(a)", "v(b)", "v(c3)", "v(d)"},
             .until_s = 5e-6,
             .max_step_s = 2e-8,
             .relative_tolerance = 1e-7};
  static const int DISC_OF[] = {1, 4, 0, 2};
  vs_error err = {0};
  EXPECT(bench_run(&b, &err) == VS_OK, "%s", err.text);
  for (int k = 0; k < 4; k++) CLOSE(b.last[k], siov(&DISCS[DISC_OF[k]], 1), 1e-6);
}

/* Makers' tolerance: one factor for the voltage of all varistors by name, whichever their law. */
static void scaled(void) {
  const bench_value scale[] = {{"varistor_scale", 0.9}, {NULL, 0}};
  bench b = {.deck =
                 "*$ param first = s20k460 part \"V1\"\n*$ param second = v511da40 part \"V2\"\n"
                 "I1 0 a 1\nX1 a 0 first\nI2 0 b 1m\nX2 b 0 second\n",
             .signals = {"v(a)", "v(b)"},
             .until_s = 0.03, /* 820 V at 1 mA need 2 ms for 2.5 nF */
             .max_step_s = 1e-4,
             .relative_tolerance = 1e-7,
             .set = scale};
  vs_error err = {0};
  EXPECT(bench_run(&b, &err) == VS_OK, "%s", err.text);
  CLOSE(b.last[0], 0.9 * siov(&DISCS[1], 1), 1e-6);
  CLOSE(b.last[1], 0.9 * 820, 1e-6);
}

/* The far end, where nothing is a varistor any more: no value overflows in a Newton trial. 100 kA
 * thrust at once into an empty one, and an exponent of 100. */
static void far_out(void) {
  CLOSE(voltage_at("varistor_siov", "", 1e5, 1e-9), siov(&DISCS[0], 1e5), 1e-4);
  CLOSE(voltage_at("varistor_power", "alpha=100", 1e5, 1e-9), 910 * pow(1e8, 1 / 100.), 1e-6);
  CLOSE(voltage_at("varistor_power", "", 1e7, 1e-9), 910 * pow(1e9, 1 / 30.) * (1 + 9 / 30.), 1e-6);
  EXPECT(voltage_at("varistor_siov", "", 1e7, 1e-8) > siov(&DISCS[0], 1e5), "as a ramp");
}

typedef struct chop {
  double peak_v, taken_j, t_s, p_w;
} chop;

static void see_chop(void *ctx, double t_s, const double *signals) {
  chop *c = ctx;
  double p = signals[0] * signals[1];
  c->peak_v = fmax(c->peak_v, fabs(signals[0]));
  c->taken_j += (t_s - c->t_s) * (p + c->p_w) / 2;
  c->t_s = t_s;
  c->p_w = p;
}

/* A switch opens on a coil's current, 10 A in 1 mH or 1 A in 1.6 H: the varistor takes it over at
 * the voltage that it has there, and takes the coil's energy. This is where a model that gives V
 * of I, or one without capacitance, makes ngspice give up; here under both rules and from a loose
 * to a tight tolerance. */
static void a_chopped_current(void) {
  static const char *const PARTS[] = {"s20k460", "varistor_power"};
  static const struct { double i_a, l_h; } COILS[] = {{10, 1e-3}, {1, 1.6}, {100, 1e-4}};
  static const double TOLERANCE[] = {1e-3, 1e-5, 1e-6};
  for (int n = 0; n < 72; n++) {
    const char *part = PARTS[n % 2];
    bool gear = n / 2 % 2;
    int coil = n / 4 % 3, tight = n / 12 % 3;
    double sign = n < 36 ? 1 : -1, i = COILS[coil].i_a, l = COILS[coil].l_h, fall_s = l * i / 900;
    char deck[400];
    chop c = {0};
    snprintf(deck, sizeof deck,
             "*$ param varistor = %s part \"under test\"\nL1 0 a %g ic=%g\n"
             "S1 a 0 0 ctl opening\nVctl ctl 0 pulse(-1 1 1u 10n 10n 1 2)\n"
             ".model opening sw(ron=1m roff=1e9 vt=0 vh=0.1)\nVv a v 0\nXv v 0 varistor\n",
             part, l, sign * i);
    bench b = {.deck = deck,
               .signals = {"v(a)", "i(vv)"},
               .until_s = 1e-6 + 2 * fall_s,
               .max_step_s = fall_s / 100,
               .relative_tolerance = TOLERANCE[tight],
               .gear = gear,
               .see = see_chop,
               .ctx = &c};
    vs_error err = {0};
    vs_status status = bench_run(&b, &err);
    double v = n % 2 ? 910 * pow(i / 1e-3, 1 / 30.) : siov(&DISCS[1], i);
    EXPECT(status == VS_OK, "%s, %g A, tolerance %g%s: %s", part, i, TOLERANCE[tight],
           gear ? ", gear" : "", err.text);
    CLOSE(c.peak_v, v, tight ? 1e-3 : 0.02); /* measured: 2e-4, 0.0175 */
    CLOSE(c.taken_j, l * i * i / 2, 5e-3);   /* measured: 2e-3, the capacitance's part */
  }
}

static const vs_test TESTS[] = {
    {"power law", power_law},
    {"inverted polynomial", inverted_polynomial},
    {"linear below 100 nA", linear_below},
    {"acceptance", acceptance},
    {"acceptance by power law", acceptance_by_power_law},
    {"several in one deck", several_in_one_deck},
    {"scaled", scaled},
    {"far out", far_out},
    {"a chopped current", a_chopped_current},
};
VS_SUITE_MAIN("varistors", TESTS)
