/* SPDX-License-Identifier: GPL-3.0-or-later
 * Units of formulas by dimensional analysis. */
#include <string.h>

#include "suite.h"
#include "plant/dimension.h"

static const char *const NAMES[] = {"mass",  "spring", "damping",  "torsion", "arm",
                                    "angle", "zeta",   "exponent", "flux",    "inductance"};
static const char *const UNITS[] = {"kg",  "kN/m", "N.s/m", "N.m/rad", "mm",
                                    "deg", "",     "",      "Wb",      "H"};

static int name_of(void *ctx, const char *at, const char *name) {
  (void)ctx, (void)at;
  for (size_t k = 0; k < COUNT(NAMES); k++)
    if (!strcmp(name, NAMES[k])) return (int)k;
  return -1;
}

static bool find(const char *text, vs_dimension *found, vs_dimension_fault *fault) {
  const vs_formula_scope scope = {.name = name_of, .of_machine = true};
  vs_formula f = {0};
  vs_dimension units[COUNT(UNITS)];
  const char *bad = "";
  char why[200] = "";
  const char *end = vs_formula_read(text, &scope, &f, &bad, why, sizeof why);
  EXPECT(end && !*end, "%s: %s at '%s'", text, why, bad);
  for (size_t k = 0; k < COUNT(UNITS); k++) units[k] = vs_dimension_of(UNITS[k]);
  bool good = vs_dimension_find(&f, NULL, units, found, fault);
  vs_formula_free(&f);
  return good;
}

static void test_found(void) {
  static const struct {
    const char *text, *unit;
  } ROW[] = {
      {"2*zeta*sqrt(spring*mass)", "N.s/m"},
      {"spring + 3*spring - spring/2", "N/m"},
      {"torsion + spring*arm^2", "N.m"},
      {"mass*sin(angle)^2 + mass*(arm/arm)", "kg"},
      {"mass*9.81", "an unknown unit"},
      {"mass*9.81 + arm", "an unknown unit"},
      {"0 + mass", "kg"},
      {"mass - 0", "kg"},
      {"max(0, spring)", "N/m"},
      {"spring^0.5/mass^0.5", "1/s"},
      {"abs(flux)/inductance", "A"},
      {"zeta^exponent", "a pure number"},
      {"arm^exponent", "an unknown unit"},
      {"(flux/flux)^12.5*arm", "m"},
      {"zeta^1.3*arm", "m"},
      {"pi*arm^2/arm", "m"},
      {"sgn(arm)*spring", "N/m"},
      {"atan(zeta)*torsion", "N.m"},
      {"mass*arm^5", "kg.m^5"},
      {"sqrt(flux)", "kg^0.5.m.s^-1.A^-0.5"},
  };
  for (size_t k = 0; k < COUNT(ROW); k++) {
    vs_dimension found = {0};
    vs_dimension_fault fault = {0};
    char text[VS_DIMENSION_TEXT];
    bool good = find(ROW[k].text, &found, &fault);
    vs_dimension_text(&found, text);
    EXPECT(good && !strcmp(text, ROW[k].unit), "%s: %s, not %s (%s)", ROW[k].text, text,
           ROW[k].unit, fault.why);
  }
}

static void test_faults(void) {
  static const struct {
    const char *text;
    int at;
    const char *why;
  } ROW[] = {
      {"mass + spring", 5, "N/m is added to kg"},
      {"2*(spring - damping)", 10, "N.s/m is subtracted from N/m"},
      {"mass + 1", 5, "a pure number is added to kg"},
      {"max(mass, arm)", 0, "max is of kg and m"},
      {"1 + sin(arm)", 4, "sin wants a pure number, not m"},
      {"exp(mass)", 0, "exp wants a pure number, not kg"},
      {"zeta^arm", 4, "the exponent is in m"},
  };
  for (size_t k = 0; k < COUNT(ROW); k++) {
    vs_dimension found = {0};
    vs_dimension_fault fault = {0};
    bool good = find(ROW[k].text, &found, &fault);
    EXPECT(!good && fault.at == ROW[k].at && !strcmp(fault.why, ROW[k].why), "%s: %d: %s",
           ROW[k].text, fault.at, good ? "taken" : fault.why);
  }
}

static void test_fits(void) {
  vs_dimension newton = vs_dimension_of("N"), metre = vs_dimension_of("m"), zero = {.any = true},
               nothing = vs_dimension_of(NULL), pure = vs_dimension_of(""),
               angle = vs_dimension_of("rad");
  vs_dimension joule = vs_dimension_product(&newton, 1, &metre, 1), of_joule = vs_dimension_of("J");
  CU_ASSERT_TRUE(vs_dimension_fits(&joule, &of_joule));
  CU_ASSERT_FALSE(vs_dimension_fits(&newton, &metre));
  CU_ASSERT_TRUE(vs_dimension_fits(&zero, &metre) && vs_dimension_fits(&nothing, &metre));
  CU_ASSERT_TRUE(vs_dimension_fits(&pure, &angle));
  CU_ASSERT_FALSE(vs_dimension_fits(&pure, &metre));
}

static const vs_test TESTS[] = {
    {"units of formulas", test_found},
    {"units that do not fit, and where", test_faults},
    {"comparison", test_fits},
};
VS_SUITE_MAIN("dimension", TESTS)
