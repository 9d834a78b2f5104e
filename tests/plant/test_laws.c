/* SPDX-License-Identifier: GPL-3.0-or-later
 * Laws of actuators: current, force and energy against the reference numbers, against each other,
 * and as ngspice computes what they write. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plant/coil.h"
#include "plant/law.h"
#include "plant/values.h"
#include "program.h"

/* ---- the laws of this test ---- */

/* Formulas in lambda and z over names with values or formulas; `force` is -dW/dz, as in a file. */
typedef struct named {
  const char *name, *text; /* text: NULL where it is a number */
  double value;
} named;

/* The solenoid of the Modelica Standard Library (docs/machines_shipped.md). */
#define MU0 (4 * M_PI * 1.00000000055e-7)
#define IRON(k)                                                                                    \
  {"b" #k, "abs(lambda)/(N*A" #k "*1.488)", 0}, {                                                  \
    "R" #k, "1/(mu0*(1+(400-1+1200*b" #k ")/(1+3*b" #k "+b" #k "^12.5))*g" #k ")", 0               \
  }
static const named SOLENOID[] = {
    {"N", NULL, 957},
    {"mu0", NULL, MU0},
    {"r", NULL, 5e-3},
    {"w", NULL, 2 * M_PI * 6.5e-3},
    {"rho", NULL, 3e-3},
    {"Gp", NULL, 3.0319757963e-7},
    {"A1", NULL, 1.343030859410e-4},
    {"A2", NULL, M_PI * 5e-3 * 5e-3},
    {"A3", NULL, M_PI * 5e-3 * 5e-3},
    {"A4", NULL, 2.105652476069e-4},
    {"A5", NULL, 2.034181243199e-4},
    {"g1", NULL, 4.263590029872e-3},
    {"g2", NULL, 3.510159389486e-3},
    {"g3", NULL, 1.208304866765e-2},
    {"g4", NULL, 2.524717179043e-2},
    {"g5", NULL, 2.214055808678e-2},
    IRON(1),
    IRON(2),
    IRON(3),
    IRON(4),
    IRON(5),
    {"G", "mu0*(pi*r^2/z + w/pi*ln(1 + pi*rho/z))", 0},
    {"dG", "-mu0/z^2*(pi*r^2 + w*rho/(1 + pi*rho/z))", 0},
    {NULL, NULL, 0},
};
#define SOLENOID_CURRENT "lambda/N^2*(1/G + 1/Gp + R1 + R2 + R3 + R4 + R5)"
#define SOLENOID_FORCE "(lambda/N/G)^2*dG/2"

/* A law with an energy of its own: saturation in another form, and a magnet of 0.3 A. */
static const named MAGNET[] = {{"L", NULL, 0.4}, {"d", NULL, 2e-3}, {NULL, NULL, 0}};
#define MAGNET_CURRENT "sinh(lambda/0.5)*z/(d*L)-0.3*z/d"
#define MAGNET_ENERGY "(0.5*(cosh(lambda/0.5)-1)/L-0.3*lambda)*z/d+2*z^2"
#define MAGNET_FORCE "-(0.5*(cosh(lambda/0.5)-1)/L-0.3*lambda)/d-4*z"

/* A product of 25 factors from the right: its derivative has two values waiting at each. */
#define DEEP8 "z*(z*(z*(z*(z*(z*(z*(z*("
#define DEEP DEEP8 DEEP8 DEEP8
#define ENDS8 "))))))))"
#define ENDS ENDS8 ENDS8 ENDS8

enum { MOST = 40 };
typedef struct scope {
  const named *names;
  vs_formula made[MOST];
  double values[MOST];
} scope;

static int name_of(void *ctx, const char *at, const char *name) {
  const scope *s = ctx;
  (void)at;
  for (int k = 0; s->names[k].name; k++)
    if (!strcmp(s->names[k].name, name)) return k;
  EXPECT(false, "no %s", name);
  return -1;
}
static int term_of(void *ctx, const char *name) {
  (void)ctx;
  return !strcmp(name, "lambda") ? 0 : !strcmp(name, "z") ? 1 : -1;
}
static const vs_formula *formula_of(void *ctx, const char *name) {
  const scope *s = ctx;
  for (int k = 0; s->names[k].name; k++)
    if (!strcmp(s->names[k].name, name) && s->names[k].text) return &s->made[k];
  return NULL;
}

static vs_formula formula(scope *s, const char *text) {
  const vs_formula_scope known = {s, NULL, name_of, true, term_of, formula_of};
  vs_formula f = {0};
  const char *bad = "";
  char why[200] = "";
  const char *end = vs_formula_read(text, &known, &f, &bad, why, sizeof why);
  EXPECT(end && !*end, "%s: %s at '%s'", text, why, bad);
  vs_formula_bind(&f, s->values);
  return f;
}

/* Builds the law formula; text NULL: the file has no such formula. */
static vs_status build_formulas(const named *names, double gap_m, const char *const text[3],
                                vs_coil *coil, vs_error *err) {
  scope s = {names, {{0}}, {0}};
  int count = 0;
  for (; names[count].name; count++) {
    s.values[count] = names[count].value;
    if (names[count].text) s.made[count] = formula(&s, names[count].text);
  }
  vs_formula f[3] = {{0}};
  for (int k = 0; k < 3; k++)
    if (text[k]) f[k] = formula(&s, text[k]);
  const vs_law_formulas formulas = {text[0] ? &f[0] : NULL,
                                    text[1] ? &f[1] : NULL,
                                    text[2] ? &f[2] : NULL,
                                    {{"machine", 1, 1}, {"machine", 2, 1}, {"machine", 3, 1}}};
  const vs_actuator_values v = {.gap_m = gap_m};
  *coil = (vs_coil){.law = &vs_formulas_law, .gap_rest_m = gap_m};
  vs_status status = coil->law->build(&v, NULL, &formulas, coil, err);
  for (int k = 0; k < 3; k++) vs_formula_free(&f[k]);
  for (int k = 0; k < count; k++) vs_formula_free(&s.made[k]);
  return status;
}

/* The reluctance of Table 1, with saturation S (law 0), M (1) or none (-1), and leakage. */
static vs_coil reluctance(int law, double leakage_h) {
  vs_actuator_values v = {.gap_m = 6e-3,
                          .pole_cover_m = 0.5e-3,
                          .inductance_h = 1.6,
                          .resistance_ohm = 92,
                          .leakage_h = leakage_h};
  if (law == 0) v.saturation = (vs_saturation_values){1, 0, 1.2, 7, 0.2};
  if (law == 1) v.saturation = (vs_saturation_values){1, 1, 1.5, 6, 0};
  vs_coil coil = {.law = &vs_reluctance_law, .resistance_ohm = 92, .gap_rest_m = 6.5e-3};
  vs_error err = {0};
  CU_ASSERT_EQUAL(coil.law->build(&v, NULL, NULL, &coil, &err), VS_OK);
  return coil;
}

static vs_coil written(const named *names, double gap_m, const char *current, const char *energy,
                       const char *force) {
  const char *const text[] = {current, energy, force};
  vs_coil coil;
  vs_error err = {0};
  vs_status status = build_formulas(names, gap_m, text, &coil, &err);
  EXPECT(!status, "%s", err.text);
  return coil;
}

static void end(vs_coil *c) {
  if (c->law->end) c->law->end(c);
}

/* All laws, with the range in which they are tried. */
typedef struct tried {
  const char *name;
  vs_coil coil;
  double flux_wb, z_m;
} tried;
enum { LAWS = 13 };

static void all_laws(tried t[LAWS]) {
  int n = 0;
  t[n++] = (tried){"plain", reluctance(-1, 0), 1.5, 6e-3};
  t[n++] = (tried){"plain + leakage", reluctance(-1, 0.15), 1.5, 6e-3};
  t[n++] = (tried){"S", reluctance(0, 0), 1.5, 6e-3};
  t[n++] = (tried){"M", reluctance(1, 0), 1.5, 6e-3};
  t[n++] = (tried){"S + leakage", reluctance(0, 0.15), 1.5, 6e-3};
  t[n++] = (tried){"M + leakage", reluctance(1, 0.15), 1.5, 6e-3};
  t[n++] = (tried){"solenoid", written(SOLENOID, 5e-3, SOLENOID_CURRENT, NULL, SOLENOID_FORCE), 0.1,
                   3e-3};
  t[n++] = (tried){"solenoid, current alone", written(SOLENOID, 5e-3, SOLENOID_CURRENT, NULL, NULL),
                   0.1, 3e-3};
  t[n++] = (tried){"magnet", written(MAGNET, 2e-3, MAGNET_CURRENT, MAGNET_ENERGY, MAGNET_FORCE),
                   0.6, 2e-3};
  t[n++] = (tried){"magnet, current and energy",
                   written(MAGNET, 2e-3, MAGNET_CURRENT, MAGNET_ENERGY, NULL), 0.6, 2e-3};
  t[n++] = (tried){"magnet, energy", written(MAGNET, 2e-3, NULL, MAGNET_ENERGY, NULL), 0.6, 2e-3};
  t[n++] = (tried){"magnet, energy and force",
                   written(MAGNET, 2e-3, NULL, MAGNET_ENERGY, MAGNET_FORCE), 0.6, 2e-3};
  t[n++] = (tried){"magnet, current and force",
                   written(MAGNET, 2e-3, MAGNET_CURRENT, NULL, MAGNET_FORCE), 0.6, 2e-3};
}

/* ---- tests ---- */

/* lambda = 1 Wb, z = 6 mm: i, F, W of the formulas in docs/theory.md, to their last digit. */
static void test_reluctance_values(void) {
  static const struct {
    int law;
    double leakage_h, i, f, w;
  } ROW[] = {{0, 0, 0.63273940637, 48.0769230769, 0.295438579642},
             {1, 0, 0.627572016461, 49.1321093173, 0.294792655904},
             {0, 0.15, 0.558807605759, 40.3549856696, 0.269013345372}};
  for (size_t k = 0; k < COUNT(ROW); k++) {
    vs_coil c = reluctance(ROW[k].law, ROW[k].leakage_h);
    CLOSE(vs_coil_current(&c, 1, 6e-3), ROW[k].i, 1e-11);
    CLOSE(vs_coil_force(&c, 1, 6e-3), ROW[k].f, 1e-11);
    CLOSE(vs_coil_energy(&c, 1, 6e-3), ROW[k].w, 1e-11);
    CLOSE(vs_coil_current(&c, -1, 6e-3), -ROW[k].i, 1e-11);
    CLOSE(c.rest_h, 1.6 + ROW[k].leakage_h, 1e-14);
    end(&c);
  }
}

static void test_solenoid_values(void) {
  static const double ROW[][4] = {/* z, i, lambda, the size of F */
                                  {0.25e-3, 1.2, 0.133083219405, 76.894487208},
                                  {1e-3, 1.2, 0.091737072159, 27.7787508419},
                                  {5e-3, 1.2, 0.034717862614, 2.91620922713},
                                  {0.33e-3, 0.72, 0.08797816227, 32.1006993168},
                                  {0.61e-3, 0.415, 0.0400858219696, 5.91416664057},
                                  {0.003746295142, 0.9936220385, 0.0350100584, 3.090742444}};
  vs_coil c[] = {written(SOLENOID, 5e-3, SOLENOID_CURRENT, NULL, SOLENOID_FORCE),
                 written(SOLENOID, 5e-3, SOLENOID_CURRENT, NULL, NULL)};
  for (size_t n = 0; n < COUNT(c); n++) {
    /* the numbers have 9 to 12 digits, and the current grows up to six times as fast as lambda */
    for (size_t k = 0; k < COUNT(ROW); k++) {
      double digits = k < 3 ? 1e-10 : 1e-9;
      CLOSE(vs_coil_current(&c[n], ROW[k][2], ROW[k][0]), ROW[k][1], digits);
      CLOSE(vs_coil_force(&c[n], ROW[k][2], ROW[k][0]), ROW[k][3], digits);
    }
    end(&c[n]);
  }
}

static double noise(unsigned *seed) { /* from -1 to 1 */
  *seed = *seed * 1664525u + 1013904223u;
  return (double)*seed / 2147483648.0 - 1;
}

/* The fourth-order central difference of the energy to lambda (0) or z (1). */
static double slope(const vs_coil *c, double flux_wb, double z_m, int to, double h) {
  double w[4];
  for (int k = 0; k < 4; k++) {
    double by = h * (k < 2 ? k - 2 : k - 1);
    w[k] = vs_coil_energy(c, flux_wb + (to ? 0 : by), z_m + (to ? by : 0));
  }
  return (8 * (w[2] - w[1]) - (w[3] - w[0])) / (12 * h);
}

/* i = dW/dlambda and F = dW/dz at random points. The step of a five-hundredth leaves a difference
 * of some 1e-9 of the derivatives, and 1e-8 where the iron's knee is. */
static void test_consistency(void) {
  tried t[LAWS];
  unsigned seed = 3;
  all_laws(t);
  for (int n = 0; n < LAWS; n++) {
    const vs_coil *c = &t[n].coil;
    for (int k = 0; k < 60; k++) {
      double flux = t[n].flux_wb * noise(&seed), z = t[n].z_m * (1 + 0.7 * noise(&seed));
      double i = vs_coil_current(c, flux, z), f = vs_coil_force(c, flux, z);
      double w_flux = slope(c, flux, z, 0, t[n].flux_wb / 1000);
      double w_z = slope(c, flux, z, 1, z / 500);
      double most_i = fabs(vs_coil_current(c, t[n].flux_wb, z));
      double most_f = fabs(vs_coil_force(c, t[n].flux_wb, z));
      EXPECT(fabs(i - w_flux) <= 1e-8 * most_i, "%s: i(%g, %g) = %.12g, dW/dlambda %.12g",
             t[n].name, flux, z, i, w_flux);
      EXPECT(fabs(f - w_z) <= 1e-8 * most_f, "%s: F(%g, %g) = %.12g, dW/dz %.12g", t[n].name, flux,
             z, f, w_z);
    }
    end(&t[n].coil);
  }
}

/* i and F at a time on a path of second order. */
static void at_time(const tried *t, const double flux[3], const double z[3], double time,
                    double out[2]) {
  double l = flux[0] + time * (flux[1] + time * flux[2] / 2),
         x = z[0] + time * (z[1] + time * z[2] / 2);
  out[0] = vs_coil_current(&t->coil, l, x);
  out[1] = vs_coil_force(&t->coil, l, x);
}

/* The rates of i and F are those of differences of the fourth order. In a time of 1 the path goes
 * through the range, so the step is 1/500 of it. */
static void test_rates(void) {
  tried t[LAWS];
  unsigned seed = 4;
  const double h = 0.002;
  all_laws(t);
  for (int n = 0; n < LAWS; n++) {
    for (int k = 0; k < 30; k++) {
      double flux[3], z[3], v[5][2], got[2][3];
      for (int m = 0; m < 3; m++) flux[m] = t[n].flux_wb * noise(&seed) * 0.8;
      for (int m = 0; m < 3; m++) z[m] = t[n].z_m * (!m + 0.6 * noise(&seed));
      for (int m = 0; m < 5; m++) at_time(&t[n], flux, z, (m - 2) * h, v[m]);
      t[n].coil.law->along(&t[n].coil, flux, z, got[0], got[1]);
      for (int q = 0; q < 2; q++) {
        double most[2] = {fabs(vs_coil_current(&t[n].coil, t[n].flux_wb, z[0])),
                          fabs(vs_coil_force(&t[n].coil, t[n].flux_wb, z[0]))};
        double rate = (8 * (v[3][q] - v[1][q]) - (v[4][q] - v[0][q])) / (12 * h);
        double rate2 =
            (16 * (v[3][q] + v[1][q]) - (v[4][q] + v[0][q]) - 30 * v[2][q]) / (12 * h * h);
        EXPECT(fabs(got[q][0] - v[2][q]) <= 1e-13 * most[q], "%s: %.17g, not %.17g", t[n].name,
               got[q][0], v[2][q]);
        EXPECT(fabs(got[q][1] - rate) <= 1e-7 * most[q], "%s: rate of %s %.12g, not %.12g",
               t[n].name, q ? "F" : "i", got[q][1], rate);
        EXPECT(fabs(got[q][2] - rate2) <= 1e-5 * most[q], "%s: second rate of %s %.12g, not %.12g",
               t[n].name, q ? "F" : "i", got[q][2], rate2);
      }
    }
    end(&t[n].coil);
  }
}

/* lambda = 0 has no rates that are not numbers, whatever the law. */
static void test_at_zero(void) {
  tried t[LAWS];
  all_laws(t);
  for (int n = 0; n < LAWS; n++) {
    const double flux[3] = {0, 30, 500}, z[3] = {t[n].z_m, 0.1, 2};
    double current[3], force[3];
    t[n].coil.law->along(&t[n].coil, flux, z, current, force);
    for (int k = 0; k < 3; k++)
      EXPECT(isfinite(current[k]) && isfinite(force[k]), "%s: rate %d is %g A, %g N", t[n].name, k,
             current[k], force[k]);
    end(&t[n].coil);
  }
}

/* Leakage far in saturation, where Newton's steps are many: the equation holds to rounding. */
static void test_deep_leakage(void) {
  vs_coil c = reluctance(0, 0.15), inner = reluctance(0, 0);
  for (double flux = 1e-9; flux < 1e4; flux *= 3) {
    double i = vs_coil_current(&c, flux, 4e-3), gap = flux - 0.15 * i;
    double scale = fmax(flux, 1e-300);
    /* of lambda_g little may be left: then it is known to the digits of lambda */
    double per =
        (vs_coil_current(&inner, gap * (1 + 1e-7), 4e-3) - vs_coil_current(&inner, gap, 4e-3)) /
        (gap * 1e-7);
    CLOSE_OF(vs_coil_current(&inner, gap, 4e-3), i, i + per * scale, 1e-14);
  }
  end(&c);
  end(&inner);
}

/* Inductance where no current flows, at the gap at rest: sinh(lambda/0.5)/0.4 = 0.3 for the magnet;
 * of the solenoid a difference of the current, which is odd in lambda. */
static void test_rest(void) {
  vs_coil magnet = written(MAGNET, 2e-3, MAGNET_CURRENT, NULL, NULL);
  vs_coil solenoid = written(SOLENOID, 5e-3, SOLENOID_CURRENT, NULL, SOLENOID_FORCE);
  CLOSE(magnet.rest_h, 0.2 / sqrt(1 + 0.12 * 0.12), 1e-13);
  CLOSE(solenoid.rest_h, 1e-7 / vs_coil_current(&solenoid, 1e-7, 5e-3), 1e-5);
  end(&magnet);
  end(&solenoid);
}

/* A formula that ends at 1 Wb says so. */
static void test_beyond(void) {
  vs_coil c = written(MAGNET, 2e-3, "lambda/sqrt(1-lambda^2)", NULL, NULL);
  char text[200] = "";
  CU_ASSERT_PTR_NULL(c.law->beyond(&c, 0.99, 2e-3, text, sizeof text));
  CU_ASSERT_PTR_NOT_NULL(c.law->beyond(&c, 1.01, 2e-3, text, sizeof text));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, "lambda = 1.01 Wb, z = 2 mm"));
  end(&c);
}

static void test_refused(void) {
  static const struct {
    const char *text[3], *says;
    int line;
  } ROW[] = {
      {{NULL, NULL, SOLENOID_FORCE}, "wants the machine file's", 3},
      {{"-lambda", NULL, NULL}, "must grow with lambda", 1},
      {{MAGNET_CURRENT, MAGNET_ENERGY "+1e-5*lambda^2", NULL},
       "but dW/dlambda of the energy is",
       1},
      {{MAGNET_CURRENT, MAGNET_ENERGY, "-(" MAGNET_FORCE ")"}, "but -dW/dz of the energy is", 3},
      {{MAGNET_CURRENT, NULL, "1.1*(" MAGNET_FORCE ")"}, "but -di/dz of the current is", 3},
      {{"ln(lambda)", NULL, NULL}, "is no finite number at lambda = 0 Wb", 1},
      {{NULL, "lambda^2+" DEEP "z" ENDS, NULL}, "grows too long", 2}};
  for (size_t k = 0; k < COUNT(ROW); k++) {
    vs_coil c;
    vs_error err = {0};
    const named *names = ROW[k].line == 3 && !ROW[k].text[0] ? SOLENOID : MAGNET;
    vs_status status = build_formulas(names, 2e-3, ROW[k].text, &c, &err);
    EXPECT(status == VS_INPUT && strstr(err.text, ROW[k].says) && err.line == ROW[k].line,
           "row %zu: %d: %s", k, status, err.text);
    end(&c);
  }
}

/* ngspice's current and force, at nodes lam and z that are sources, for leakage by its own solution
 * of the inner node. */
static void test_netlist(void) {
  if (!on_path("ngspice")) return;
  tried t[LAWS];
  all_laws(t);
  for (int n = 0; n < LAWS; n++) {
    double flux = -0.7 * t[n].flux_wb, z = 0.8 * t[n].z_m, got[2] = {NAN, NAN};
    vs_text deck = {0}, lines = {0}, current = {0}, force = {0};
    if (!t[n].coil.law->netlist) {
      end(&t[n].coil);
      continue;
    }
    t[n].coil.law->netlist(&t[n].coil, "v(lam)", "v(z)", &lines, &current, &force);
    vs_text_add(&deck, "law\nVl lam 0 %.17g\nVz z 0 %.17g\n%s", flux, z,
                lines.text ? lines.text : "");
    vs_text_add(&deck, "Bi i 0 V = %s\nBf f 0 V = %s\n", current.text, force.text);
    vs_text_add(&deck, ".options reltol=1e-10 abstol=1e-15 vntol=1e-12\n.control\n"
                       "set numdgt=16\nop\nprint i f\n.endc\n.end\n");
    write_file("law.cir", deck.text);
    CU_ASSERT_NOT_EQUAL(system("ngspice -b law.cir >law.out 2>&1"), -1);
    char *out = read_file("law.out");
    for (int q = 0; q < 2; q++) {
      const char *at = strstr(out, q ? "\nf = " : "\ni = ");
      if (at) got[q] = strtod(at + 5, NULL);
    }
    /* a source's value keeps 11 digits or so */
    CLOSE(got[0], vs_coil_current(&t[n].coil, flux, z), 1e-9);
    CLOSE(got[1], vs_coil_force(&t[n].coil, flux, z), 1e-9);
    free(out);
    vs_text_free(&deck);
    vs_text_free(&lines);
    vs_text_free(&current);
    vs_text_free(&force);
    end(&t[n].coil);
  }
}

static const vs_test TESTS[] = {
    {"saturation and leakage against the reference", test_reluctance_values},
    {"the solenoid against the reference", test_solenoid_values},
    {"current and force are slopes of the energy", test_consistency},
    {"rates of current and force", test_rates},
    {"rates without flux", test_at_zero},
    {"leakage far in saturation", test_deep_leakage},
    {"inductance at rest", test_rest},
    {"formulas that end", test_beyond},
    {"formulas that are refused", test_refused},
    {"what ngspice makes of the laws", test_netlist},
};
VS_SUITE_MAIN("laws", TESTS)
