/* SPDX-License-Identifier: GPL-3.0-or-later
 * Formulas: functions, derivatives along a path and to a term, and what ngspice makes of them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plant/b_source.h"
#include "plant/derivative.h"
#include "program.h"

/* Names "a", "b.x" and "Big" are names 0, 1, 2; x, y and z are terms 0, 1 and 2; "twice" is a
 * formula. */
static const double VALUE[] = {2.5, -3, 7};
static const vs_formula *twice;

static int name_of(void *ctx, const char *at, const char *name) {
  static const char *const NAME[] = {"a", "b.x", "Big"};
  (void)ctx, (void)at;
  for (int k = 0; k < 3; k++)
    if (!strcmp(name, NAME[k])) return k;
  return -1;
}
static int term_of(void *ctx, const char *name) {
  (void)ctx;
  return strlen(name) == 1 && *name >= 'x' ? *name - 'x' : -1;
}
static const vs_formula *formula_of(void *ctx, const char *name) {
  (void)ctx;
  return strcmp(name, "twice") ? NULL : twice;
}
static const vs_formula_scope SCOPE = {
    .name = name_of, .of_machine = true, .named_term = term_of, .named_formula = formula_of};

static vs_formula formula(const char *text) {
  vs_formula f = {0};
  const char *bad = "";
  char why[200] = "";
  const char *end = vs_formula_read(text, &SCOPE, &f, &bad, why, sizeof why);
  EXPECT(end && !*end, "%s: %s at '%s'", text, why, end ? end : bad);
  vs_formula_bind(&f, VALUE);
  return f;
}

/* Each function at points where it is smooth. */
static const char *const SMOOTH[] = {
    "x+y*z-x/y",
    "-x^3+2^x",
    "x^2.5*y",
    "pwr(x-2,3)+pwr(y-3,2)",
    "abs(x-2)*abs(y)",
    "sqrt(x)/(1+y)",
    "exp(-x*y)",
    "ln(x)+log10(y)*z",
    "sin(x)*cos(y)*tan(z/9)",
    "asin(x/4)+acos(y/4)+atan(z)",
    "sinh(x)-cosh(y)+tanh(z)",
    "sgn(x-2)*y^2",
    "min(x*y,z)+max(x,y)",
    "x^y",
    "pow(z,a)+Big*b.x*pi",
    "(1+abs(x)^12.5)^-1",
    "1+(400-1+1200*abs(x))/(1+3*abs(x)+abs(x)^12.5)",
};

static double at_time(const vs_formula *f, double t) {
  const double terms[] = {1.3 + 0.7 * t - 0.4 * t * t, 0.8 - 0.5 * t + 0.3 * t * t,
                          2.1 + 0.2 * t + 0.6 * t * t};
  return vs_formula_value(f, terms);
}

/* Central differences of the fourth order. With this step their error is some 1e-12 times the fifth
 * and sixth derivatives, which reach 1e4 here, and rounding makes up to 1e-9 of the second rate. */
static void test_jets(void) {
  const vs_jet path[] = {{{1.3, 0.7, -0.8}}, {{0.8, -0.5, 0.6}}, {{2.1, 0.2, 1.2}}};
  const double h = 0.002;
  for (size_t k = 0; k < COUNT(SMOOTH); k++) {
    vs_formula f = formula(SMOOTH[k]);
    double v[5];
    for (int n = 0; n < 5; n++) v[n] = at_time(&f, (n - 2) * h);
    vs_jet jet = vs_derivative_along(&f, path);
    double rate = (8 * (v[3] - v[1]) - (v[4] - v[0])) / (12 * h);
    double rate2 = (16 * (v[3] + v[1]) - (v[4] + v[0]) - 30 * v[2]) / (12 * h * h);
    EXPECT(jet.d[0] == v[2], "%s: value %.17g, not %.17g", SMOOTH[k], jet.d[0], v[2]);
    EXPECT(fabs(jet.d[1] - rate) <= 1e-8 * (1 + fabs(rate)), "%s: rate %.12g, not %.12g", SMOOTH[k],
           jet.d[1], rate);
    EXPECT(fabs(jet.d[2] - rate2) <= 1e-7 * (1 + fabs(rate2)), "%s: second rate %.12g, not %.12g",
           SMOOTH[k], jet.d[2], rate2);
    vs_formula_free(&f);
  }
}

/* The derivative as a formula is the partial derivative by jets, to rounding. */
static void test_slopes(void) {
  for (size_t k = 0; k < COUNT(SMOOTH); k++)
    for (int term = 0; term < 3; term++) {
      vs_formula f = formula(SMOOTH[k]), slope;
      vs_jet point[] = {{{1.3}}, {{0.8}}, {{2.1}}};
      const double terms[] = {1.3, 0.8, 2.1};
      point[term].d[1] = 1;
      double want = vs_derivative_along(&f, point).d[1];
      EXPECT(vs_derivative_to(&f, term, &slope), "%s: no derivative", SMOOTH[k]);
      double got = vs_formula_value(&slope, terms);
      EXPECT(fabs(got - want) <= 1e-13 * (1 + fabs(want)), "%s to %c: %.17g, not %.17g", SMOOTH[k],
             "xyz"[term], got, want);
      vs_formula_free(&slope);
      vs_formula_free(&f);
    }
}

/* At a base of 0 a power above 2 and its derivatives are 0, and what stands still has none. */
static void test_zero_base(void) {
  static const struct {
    const char *text;
    double want[3];
  } ROW[] = {{"abs(x)^12.5", {0, 0, 0}}, {"pow(x,2.5)", {0, 0, 0}}, {"pwr(x,7)", {0, 0, 0}},
             {"x^2", {0, 0, 2}},         {"x^1", {0, 1, 3}},        {"x^0", {1, 0, 0}},
             {"sqrt(y)*x", {0, 0, 0}},   {"y^0.5+x", {0, 1, 3}},    {"(abs(x)+y)^2.2", {0, 0, 0}},
             {"x^z", {0, 0, 0}}};
  const vs_jet terms[] = {{{0, 1, 3}}, {{0}}, {{2.5, 1, 0}}};
  for (size_t k = 0; k < COUNT(ROW); k++) {
    vs_formula f = formula(ROW[k].text);
    vs_jet jet = vs_derivative_along(&f, terms);
    for (int n = 0; n < 3; n++)
      EXPECT(jet.d[n] == ROW[k].want[n], "%s: derivative %d is %g, not %g", ROW[k].text, n,
             jet.d[n], ROW[k].want[n]);
    vs_formula_free(&f);
  }
}

/* What is folded has the same value to the bit, and fewer operations where it may. */
static void test_folded(void) {
  const double terms[] = {1.3, 0.8, 2.1};
  for (size_t k = 0; k < COUNT(SMOOTH); k++) {
    vs_formula f = formula(SMOOTH[k]);
    double before = vs_formula_value(&f, terms);
    vs_formula_fold(&f);
    CU_ASSERT_EQUAL(vs_formula_value(&f, terms), before);
    vs_formula_free(&f);
  }
  vs_formula f = formula("x*(2*pi/a)^2 + sqrt(Big - 3)*(-b.x)");
  double before = vs_formula_value(&f, terms);
  vs_formula_fold(&f);
  CU_ASSERT_EQUAL(f.count, 5);
  CU_ASSERT_EQUAL(vs_formula_value(&f, terms), before);
  vs_formula_free(&f);
}

static void test_names(void) {
  vs_formula inner = formula("x*a"), f;
  twice = &inner;
  f = formula("twice+twice^2+pi*0+b.x+Big");
  const double terms[] = {3, 0, 0};
  CLOSE(vs_formula_value(&f, terms), 7.5 + 56.25 + 4, 1e-15);
  vs_formula_free(&f);
  vs_formula_free(&inner);
  twice = NULL;
  static const char *const BAD[] = {"v(n)", "i(Vx)", "atan2(x,y)", "nobody", "sin", "sin(x", "x+"};
  for (size_t k = 0; k < COUNT(BAD); k++) {
    const char *bad = NULL;
    char why[200] = "";
    vs_formula g = {0};
    EXPECT(!vs_formula_read(BAD[k], &SCOPE, &g, &bad, why, sizeof why) && bad && *why,
           "%s was read", BAD[k]);
    vs_formula_free(&g);
  }
}

/* ngspice computes what it is written to the last digits, whatever the signs. */
static const char *const PRINTED[] = {
    "1.2566370614359173e-06*x*1e6",
    "-x^3",
    "(-x)^3+(-x)^2",
    "2^3^2*x",
    "x^-3+y^-2",
    "x-(y-z)-1",
    "x/(y/z)/2",
    "-(x-5)^2",
    "(x-5)^3",
    "pwr(x-5,2)",
    "pwr(x-5,2.5)",
    "sin(x)+cos(y)+tan(z)+asin(x/4)+acos(y/4)+atan(z)",
    "sinh(x)+cosh(y)+tanh(z)+exp(-x)+sqrt(z)",
    "ln(x)+log10(y)+abs(x-5)+sgn(x-5)+min(x,y)+max(x,y)",
    "x^y+b.x",
    "a*1+0*x+(1+(400-1+1200*abs(x))/(1+3*abs(x)+abs(x)^12.5))",
    "pi*x*b.x",
};

static void check_printed(const char *how) {
  static const char *const NODE[] = {"v(nx)", "v(ny)", "v(nz)"};
  const double terms[] = {1.3, 0.8, 2.1};
  vs_text deck = {0};
  vs_text_add(&deck, "printed\nVx nx 0 1.3\nVy ny 0 0.8\nVz nz 0 2.1\n");
  for (size_t k = 0; k < COUNT(PRINTED); k++) {
    vs_formula f = formula(PRINTED[k]);
    vs_text_add(&deck, "B%zu o%zu 0 V = ", k, k);
    vs_b_source_formula(&deck, &f, NODE);
    vs_text_add(&deck, "\n");
    vs_formula_free(&f);
  }
  vs_text_add(&deck, ".control\nset numdgt=16\nop\n");
  for (size_t k = 0; k < COUNT(PRINTED); k++) vs_text_add(&deck, "print o%zu\n", k);
  vs_text_add(&deck, ".endc\n.end\n");
  write_file("printed.cir", deck.text);
  char command[100];
  snprintf(command, sizeof command, "ngspice -b %s printed.cir >printed.out 2>&1", how);
  CU_ASSERT_NOT_EQUAL(system(command), -1);
  char *out = read_file("printed.out");
  for (size_t k = 0; k < COUNT(PRINTED); k++) {
    char key[20];
    snprintf(key, sizeof key, "\no%zu = ", k);
    const char *at = strstr(out, key);
    vs_formula f = formula(PRINTED[k]);
    double want = vs_formula_value(&f, terms), got = at ? strtod(at + strlen(key), NULL) : NAN;
    EXPECT(fabs(got - want) <= 4e-15 * fabs(want), "%s %s: ngspice says %.17g, not %.17g", how,
           PRINTED[k], got, want);
    vs_formula_free(&f);
  }
  free(out);
  vs_text_free(&deck);
}

/* As ngspice reads its own decks, and as PSpice's. */
static void test_printed(void) {
  if (!on_path("ngspice")) return;
  check_printed("");
  check_printed("-D ngbehavior=ps");
}

static const vs_test TESTS[] = {
    {"the value and two rates of each function", test_jets},
    {"the derivative to a term as a formula", test_slopes},
    {"powers of zero have no infinite rates", test_zero_base},
    {"constants are computed once", test_folded},
    {"names with dots, terms, formulas in formulas", test_names},
    {"what ngspice makes of a formula", test_printed},
};
VS_SUITE_MAIN("formula", TESTS)
