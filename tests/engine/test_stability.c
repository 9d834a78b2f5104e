/* SPDX-License-Identifier: GPL-3.0-or-later
 * Where loose coupling fails, how soon, and that the product's does not. The references are an
 * independent high-order solver's. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "plant/coil.h"
#include "floquet.h"
#include "suite.h"

/* The machines of the reference: Table 1 fired at 100 and at 90 degrees, and one with a small gap,
 * a large coil, a light trough and a stiff spring. */
enum { AT_100, AT_90, STIFF, MACHINES };
static const char *const MACHINE[MACHINES][7] = {
    {"firing.every=1", "firing.angle=100deg", NULL},
    {"firing.every=1", "firing.angle=90deg", NULL},
    {"firing.every=1", "firing.angle=90deg", "actuator.gap=1mm", "actuator.inductance=6H",
     "machine.trough_mass=0.05kg", "machine.spring_stiffness=2.2e5N/m", NULL}};
static const double P_MIN[MACHINES] = {-3.65770e-3, -5.75672e-3, -0.469869e-3}; /* in 1.5 s */

static vs_trial *machine(int which) {
  vs_trial *t = vs_trial_read("paper", "switched", MACHINE[which]);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  return t;
}

static cosim cosim_of(const char *name, const vs_trial *t, double step_s) {
  cosim c;
  const scheme *s = scheme_find(name);
  CU_ASSERT_PTR_NOT_NULL_FATAL(s);
  cosim_begin(&c, s, &t->scene.setup.model, &t->scene.setup.timeline, step_s);
  return c;
}

/* ---- runs from rest ---- */

/* Run loose, z <= 0 when the reference has it: to a step where it comes at once, to a firing period
 * where it takes hundreds of steps to grow. (The reference says 31 us for a 640th of the period.)
 */
static void loose_schemes_close_the_gap(void) {
  static const struct {
    int machine;
    const char *scheme;
    double step_s, at_s, within_s;
  } ROWS[] = {{AT_100, "7c_jacobi", 1e-3, 0.090, 1e-3},
              {AT_100, "7c_jacobi", 0.5e-3, 1.03, 0.02},
              {AT_90, "7c_jacobi", 0.25e-3, 0.0695, 0.5e-3},
              {STIFF, "i_jacobi", 0.02 / 640, 0.27, 0.02}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_trial *t = machine(ROWS[k].machine);
    cosim c = cosim_of(ROWS[k].scheme, t, ROWS[k].step_s);
    CU_ASSERT_FALSE(cosim_run(&c, 1.5));
    printf(" %.4g s", c.collapsed_s);
    CLOSE_OF(c.collapsed_s, ROWS[k].at_s, 1, ROWS[k].within_s);
    cosim_end(&c);
    vs_trial_free(t);
  }
}

/* In steps of 1 ms on the stiff machine the plain fixed point finds no end in the step to 9 ms,
 * while the current still rises; half of each correction, or Newton's, do. */
static void fixed_point_diverges(void) {
  vs_trial *t = machine(STIFF);
  cosim plain = cosim_of("i_iterated", t, 1e-3), relaxed = cosim_of("i_relaxed", t, 1e-3),
        condensed = cosim_of("i_condensed", t, 1e-3);
  CU_ASSERT_FALSE(cosim_run(&plain, 0.5));
  CLOSE(plain.diverged_s + plain.step_s, 9e-3, 1e-9);
  CU_ASSERT(cosim_run(&relaxed, 0.5));
  CLOSE(relaxed.p_min_m, P_MIN[STIFF], 0.02);
  CU_ASSERT(cosim_run(&condensed, 0.5));
  CLOSE(condensed.p_min_m, relaxed.p_min_m, 1e-6);
  CU_ASSERT(condensed.iterations < relaxed.iterations / 2);
  cosim_end(&plain);
  cosim_end(&relaxed);
  cosim_end(&condensed);
  vs_trial_free(t);
}

/* The product on the same scenes: the switched tier to the digits known, the circuit tier (ngspice,
 * a thyristor that is all but ideal, nothing else in the circuit) at its default tolerance. */
static void the_product_holds(void) {
  for (int k = 0; k < MACHINES; k++)
    for (int tier = 0; tier < 2; tier++) {
      const char *sets[20] = {"run.until=1.5s", tier ? "run.tolerance=1e-4" : "run.tolerance=1e-8"};
      static const char *const IDEAL[] = {"circuit.deck=halfwave_bare",
                                          "circuit.on_voltage=0 V",
                                          "circuit.on_resistance=1e-4 ohm",
                                          "circuit.off_resistance=1000 Mohm",
                                          "supply.resistance=0",
                                          "supply.inductance=0"};
      size_t n = 2;
      for (size_t i = 0; MACHINE[k][i]; i++) sets[n++] = MACHINE[k][i];
      for (size_t i = 0; tier && i < COUNT(IDEAL); i++) sets[n++] = IDEAL[i];
      vs_trial *t = vs_trial_run("paper", tier ? "circuit" : "switched", sets, NULL);
      CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
      printf(" %.1e", fabs(t->result.values[VS_M_GAP_MIN].value / P_MIN[k] - 1));
      CLOSE(t->result.values[VS_M_GAP_MIN].value, P_MIN[k], tier ? 1e-4 : 2e-6);
      vs_trial_free(t);
    }
}

/* ---- the periodic orbit ---- */

/* c without coupling error and <F/z>, as the reference has them. */
static const struct {
  double damping_ns_m, force_over_z_n_m;
  long fine; /* macro steps in a period that are as good as infinitely many: 1e-4 of c */
} ORBIT[MACHINES] = {{4.407, 4895, 1000}, {6.600, 11508, 1000}, {2.515, 43486, 4000}};

/* From rest by marching near it, then Newton's method. */
static orbit orbit_exactly(int which, const vs_trial *t) {
  orbit o = {.multiplier = NAN};
  cosim c = cosim_of("flux_seidel", t, t->scene.setup.timeline.period_s / 200);
  CU_ASSERT_FATAL(cosim_run(&c, 10));
  for (int i = 0; i < VS_STATES; i++) o.x[i] = c.now.x[i];
  cosim_end(&c);
  CU_ASSERT_FATAL(floquet_orbit(scheme_find("flux_condensed"), &t->scene.setup.model,
                                &t->scene.setup.timeline, ORBIT[which].fine, &o));
  return o;
}

static orbit orbit_of(const char *name, const vs_trial *t, const orbit *near, long n) {
  orbit o = *near;
  EXPECT(floquet_orbit(scheme_find(name), &t->scene.setup.model, &t->scene.setup.timeline, n, &o),
         "%s, %ld steps in a period: no orbit", name, n);
  return o;
}

/* Numerical damping c_num = kappa H <F/z>: kappa within 0.05 on the stiff machine, where the mains
 * are slow beside the working mode, and 0.4 on Table 1. */
static void numerical_damping(void) {
  static const long STEPS[MACHINES] = {200, 400, 4000}; /* in a period: a few of the limit's */
  for (int k = 0; k < MACHINES; k++) {
    vs_trial *t = machine(k);
    orbit exact = orbit_exactly(k, t);
    CLOSE(exact.damping_ns_m, ORBIT[k].damping_ns_m, 2e-4); /* their digits, and `fine` */
    CLOSE(exact.force_over_z_n_m, ORBIT[k].force_over_z_n_m, 1.1e-4);
    for (size_t s = 0; s < n_schemes; s++) {
      if (isnan(schemes[s].kappa)) continue;
      orbit o = orbit_of(schemes[s].name, t, &exact, STEPS[k]);
      double h = t->scene.setup.timeline.period_s / (double)STEPS[k];
      double kappa = (o.damping_ns_m - exact.damping_ns_m) / (h * exact.force_over_z_n_m);
      if (schemes[s].kappa != 0) printf(" %.3f", kappa);
      CLOSE_OF(kappa, schemes[s].kappa, 1, k == STIFF ? 0.05 : 0.4);
    }
    vs_trial_free(t);
  }
}

/* H where the working mode's multiplier passes 1, between the two numbers of macro steps in a
 * period that lie about it. */
static double limit_of(const char *name, const vs_trial *t, const orbit *near, double guess_s) {
  double period = t->scene.setup.timeline.period_s, h[2], log_mu[2];
  for (int side = 0; side < 2; side++) {
    long n = lround(period / guess_s * (side ? 0.93 : 1.07));
    h[side] = period / (double)n;
    log_mu[side] = log(orbit_of(name, t, near, n).multiplier);
  }
  return h[0] - log_mu[0] * (h[1] - h[0]) / (log_mu[1] - log_mu[0]);
}

/* Unstable beyond H* = c/(|kappa| <F/z>), which is the closed form, within 15 %. */
static void limits_of_the_step(void) {
  static const char *const SCHEMES[] = {"i_seidel", "7c_jacobi", "i_jacobi"};
  static const double PRINTED_US[MACHINES][3] = {{900, 450, 300}, {574, 287, 191}, {58, 29, 19}};
  for (int k = 0; k < MACHINES; k++) {
    vs_trial *t = machine(k);
    orbit exact = orbit_exactly(k, t);
    for (int s = 0; s < 3; s++) {
      double kappa = fabs(scheme_find(SCHEMES[s])->kappa);
      double closed = exact.damping_ns_m / (kappa * exact.force_over_z_n_m);
      CLOSE_OF(closed * 1e6, PRINTED_US[k][s], 1, 0.51);
      double found = limit_of(SCHEMES[s], t, &exact, closed);
      printf(" %.0f/%.0f", found * 1e6, closed * 1e6);
      CLOSE(found, closed, 0.15);
    }
    vs_trial_free(t);
  }
}

/* ---- energy ---- */

/* lambda exchanged, z held, Gauss-Seidel: the books close to the integrators' rounding whatever the
 * step; by Jacobi's order they are out by 1 % of the work at 42 us. The first peak is off by the
 * square of the step: 1 % at 1.37 ms, 0.1 % at 436 us. */
static void exact_in_energy(void) {
  static const char *const ONCE[] = {"firing.angle=100deg", NULL};
  static const double STEP_S[] = {10e-6, 42e-6, 436e-6, 1.37e-3, 5e-3};
  static const double OFF[] = {1e-4, 1e-4, 1e-3, 1e-2, NAN}; /* p_min at substeps: to 5e-5 */
  vs_trial *t = vs_trial_read("paper", "switched", ONCE);
  for (size_t k = 0; k < COUNT(STEP_S); k++) {
    cosim c = cosim_of("flux_seidel", t, STEP_S[k]);
    CU_ASSERT(cosim_run(&c, 0.1));
    CU_ASSERT(fabs(cosim_left(&c)) < 1e-7 * c.now.book_j[BOOK_WORK]);
    double off = fabs(c.p_min_m / -0.00141639233706 - 1);
    if (OFF[k] >= 1e-3) CLOSE(off, OFF[k], 0.15);
    if (OFF[k] < 1e-3) CU_ASSERT(off < OFF[k]);
    cosim_end(&c);
  }
  cosim jacobi = cosim_of("flux_jacobi", t, 42e-6);
  cosim_run(&jacobi, 0.1);
  CLOSE(fabs(cosim_left(&jacobi)) / jacobi.now.book_j[BOOK_WORK], 0.01, 0.05);
  cosim_end(&jacobi);
  vs_trial_free(t);
}

/* The product's own watcher, shown a scheme's run. */
typedef struct audit {
  vs_frame frame;
  vs_energy energy;
} audit;

static void watch(void *ctx, const vs_knot *from, const vs_knot *to) {
  audit *a = ctx;
  vs_step step = {.frame = &a->frame, .from = from, .to = to, .cubic_flux = true};
  vs_energy_accept(&a->energy, &step);
}

/* One shot, 0.1 s. Gives p_min; what the books of the EVA leave over, as a part of the work. */
static double audited(const char *name, double step_s, double *residual, bool *caught) {
  static const char *const ONCE[] = {"firing.angle=100deg", NULL};
  vs_trial *t = vs_trial_read("paper", "switched", ONCE);
  cosim c = cosim_of(name, t, step_s);
  audit *a = vs_alloc(1, sizeof *a);
  a->frame = (vs_frame){.model = &t->scene.setup.model, .timeline = &t->scene.setup.timeline};
  a->energy.frame = &a->frame;
  c.show = watch;
  c.ctx = a;
  CU_ASSERT(cosim_run(&c, 0.1));
  vs_energy_finish(&a->energy);
  char text[256];
  *residual = a->energy.residual[VS_B_EVA];
  *caught = vs_energy_open(&a->energy, t->scene.setup.run.tolerance, text, sizeof text) != NULL;
  double p_min = c.p_min_m;
  free(a);
  cosim_end(&c);
  vs_trial_free(t);
  return p_min;
}

/* Without the back-EMF the scheme converges, to 17.8 % too much, and no refinement shows it; the
 * audit of energy does, at any step, by the same limit that the program holds its own runs to (ten
 * times the default tolerance, 1e-4). The schemes that go to the truth pass it in small steps. */
static void a_wrong_answer_is_caught(void) {
  double residual, before = NAN;
  bool caught;
  for (double h = 40e-6; h > 2e-6; h /= 4) {
    double p = audited("7c_no_emf", h, &residual, &caught);
    printf(" %.4f/%.3f", p / -0.00141639233706 - 1, residual);
    CLOSE_OF(p / -0.00141639233706 - 1, 0.178, 1, 5e-4);
    CU_ASSERT(isnan(before) || fabs(p / before - 1) < 1e-4);
    CU_ASSERT(fabs(residual) > 0.5);
    CU_ASSERT(caught);
    before = p;
  }
  static const char *const TRUE_ONES[] = {"flux_seidel", "flux_condensed", "i_condensed",
                                          "i_seidel_extrapolated"};
  for (size_t k = 0; k < COUNT(TRUE_ONES); k++) {
    audited(TRUE_ONES[k], 10e-6, &residual, &caught);
    EXPECT(!caught, "%s: %.3g of the work is left over", TRUE_ONES[k], residual);
  }
  audited("7c_jacobi", 100e-6, &residual, &caught); /* one of first order, in too large a step */
  CU_ASSERT(caught);
}

static const vs_test TESTS[] = {
    {"loose schemes close the gap", loose_schemes_close_the_gap},
    {"fixed point", fixed_point_diverges},
    {"the product holds", the_product_holds},
    {"numerical damping", numerical_damping},
    {"limits of the step", limits_of_the_step},
    {"energy-exact", exact_in_energy},
    {"a wrong answer is caught", a_wrong_answer_is_caught},
};
VS_SUITE_MAIN("stability of coupling", TESTS)
