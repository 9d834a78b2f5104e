/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/harmonic_classes.h"

#include <math.h>

static const char SOURCE_2014[] =
    "state of 2014, from a test laboratory's report; assumed for later editions";

/* Class A: spectrum.c. The others are read in two places that agree: A Test Lab Techno Corp., test
 * report 1402CE13-01, section 4.3.1; California Instruments, Compliance Test System 3.0, user
 * manual, table 2-1. That is the state of 2014; of later editions they could not be read. */

static double class_a(const vs_drawn_current *d, int n) {
  (void)d;
  return vs_spectrum_limit(n);
}

static double class_b(const vs_drawn_current *d, int n) {
  (void)d;
  return 1.5 * vs_spectrum_limit(n);
}

/* The odd harmonics have a number each up to 11. */
enum { ODD = 5 };
static int odd_row(int n) {
  return n >= 3 && n % 2 && n < 2 * ODD + 3 ? (n - 3) / 2 : -1;
}

/* Parts of the current at the mains' frequency; that of harmonic 3 times the power factor. */
static double class_c(const vs_drawn_current *d, int n) {
  static const double PART[ODD] = {0.30, 0.10, 0.07, 0.05, 0.03};
  double first_a = vs_spectrum_harmonic(d->spectrum, 1);
  if (n == 2) return 0.02 * first_a;
  if (n < 3 || n % 2 == 0) return NAN;
  double part = odd_row(n) < 0 ? PART[ODD - 1] : PART[odd_row(n)];
  return part * first_a * (n == 3 ? d->power_factor : 1);
}

/* Amperes for each watt, and not more than class A allows. */
static double class_d(const vs_drawn_current *d, int n) {
  static const double A_PER_W[ODD] = {3.4e-3, 1.9e-3, 1.0e-3, 0.5e-3, 0.35e-3};
  if (n < 3 || n % 2 == 0) return NAN;
  double each = odd_row(n) < 0 ? 3.85e-3 / n : A_PER_W[odd_row(n)];
  return fmin(each * d->power_w, vs_spectrum_limit(n));
}

const vs_harmonic_class vs_harmonic_classes_all[] = {
    {"A", "all apparatus that no other class names", "IEC 61000-3-2:2018, table 1", class_a},
    {"B", "portable tools", SOURCE_2014, class_b},
    {"C", "lighting, above 25 W", SOURCE_2014, class_c},
    {"D", "computers, screens and television sets, 75 W to 600 W", SOURCE_2014, class_d},
    {0}};

int vs_harmonic_classes_worst(const vs_harmonic_class *of, const vs_drawn_current *drawn,
                              double *part) {
  int worst = 2;
  *part = isnan(vs_spectrum_judged(drawn->spectrum, worst)) ? NAN : 0;
  for (int n = worst; n < VS_SPECTRUM_LINES; n++) {
    double each = vs_spectrum_judged(drawn->spectrum, n) / of->limit(drawn, n);
    if (!(each > *part)) continue;
    worst = n;
    *part = each;
  }
  return worst;
}
