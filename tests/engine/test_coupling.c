/* SPDX-License-Identifier: GPL-3.0-or-later
 * The coupling alone, against a circuit that obeys a formula behind the same seam as ngspice: the
 * R-L of the EVA behind an ideal latch, in steps of one fixed length. What it should give is the
 * switched tier. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "suite.h"

/* The coil's numbers, which a netlist would carry as parameters. */
static const double A_HM = 1.6 * 6.5e-3 / 2, R_OHM = 92;

typedef struct fake {
  const vs_circuit_job *job;
  const vs_circuit_host *host;
  size_t mains, gate, gap; /* ports */
  double flux_wb;
  bool on;
  double taken_j, copper_j; /* at the port, and in the resistance: by the rule that steps lambda */
} fake;
static double poison_s = INFINITY; /* from here on the fake's flux linkage is not a number */
static fake last;                  /* what the last run left behind, for the books */

static size_t port(const vs_circuit_job *job, const char *name) {
  for (size_t k = 0; k < job->n_ports; k++)
    if (!strcmp(job->ports[k], name)) return k;
  CU_FAIL_FATAL("a port is missing");
  return 0;
}

static vs_status load(const vs_circuit_job *job, const vs_circuit_host *host, void **circuit,
                      vs_error *err) {
  (void)err;
  fake *f = vs_alloc(1, sizeof *f);
  *f = (fake){.job = job,
              .host = host,
              .mains = port(job, "vmains"),
              .gate = port(job, "vgate"),
              .gap = port(job, "v.xeva.vgap")};
  *circuit = f;
  return VS_OK;
}

/* One step of dlambda/dt = u - R lambda z/(2a) by the trapezoidal rule, with z asked for at both
 * ends. */
static double stepped(const fake *f, const vs_circuit_host *h, double t0, double t1, double z0) {
  double u = h->source(h->ctx, f->mains, t0) + h->source(h->ctx, f->mains, t1);
  double z1 = h->source(h->ctx, f->gap, t1), half = (t1 - t0) / 2, g = R_OHM / (2 * A_HM);
  return (f->flux_wb * (1 - half * g * z0) + half * u) / (1 + half * g * z1);
}

static vs_status show(fake *f, const vs_circuit_host *h, double t, double z, vs_error *err) {
  double values[5 + 2 * VS_DECK_MOST] = {0}, i = f->flux_wb * z / (2 * A_HM);
  for (size_t k = 0; k < f->job->n_signals; k++) {
    const char *s = f->job->signals[k];
    if (!strcmp(s, "v(xeva.lam)")) values[k] = t < poison_s ? f->flux_wb : NAN;
    if (!strcmp(s, "v(xeva.x)")) values[k] = f->on ? h->source(h->ctx, f->mains, t) - R_OHM * i : 0;
    if (!strcmp(s, "i(vmains)")) values[k] = -i;
    if (!strcmp(s, "i(vthy)")) values[k] = i;
  }
  return h->accept(h->ctx, t, values, err);
}

static vs_status run(void *circuit, vs_error *err) {
  fake *f = circuit;
  const vs_circuit_host *h = f->host;
  vs_status status = VS_OK;
  double t = 0, until = f->job->until_s, z0 = h->source(h->ctx, f->gap, 0);
  while (!status && t < until) {
    double t1 = fmin(fmin(t + f->job->max_step_s, h->edge(h->ctx, t)), until), flux = 0;
    if (!f->on && h->source(h->ctx, f->gate, t1) > 0 && h->source(h->ctx, f->mains, t1) > 0)
      f->on = true;
    if (f->on) {
      flux = stepped(f, h, t, t1, z0);
      if (flux <= 0 &&
          f->flux_wb > 0) { /* the step ends where lambda is zero: regula falsi on its length */
        double lo = t, hi = t1, at_lo = f->flux_wb, at_hi = flux;
        for (int n = 0; n < 60 && hi - lo > 1e-15; n++) {
          t1 = lo + (hi - lo) * (n % 3 ? at_lo / (at_lo - at_hi) : 0.5);
          flux = stepped(f, h, t, t1, z0);
          if (flux > 0)
            lo = t1, at_lo = flux;
          else
            hi = t1, at_hi = flux;
        }
        flux = 0;
      }
    }
    double z1 = h->source(h->ctx, f->gap, t1);
    double i0 = f->flux_wb * z0 / (2 * A_HM), i1 = flux * z1 / (2 * A_HM), i = (i0 + i1) / 2;
    f->taken_j += i * (flux - f->flux_wb) + (t1 - t) * R_OHM * i * i;
    f->copper_j += (t1 - t) * R_OHM * i * i;
    f->flux_wb = flux;
    status = show(f, h, t1, z1, err);
    if (f->on && flux == 0) f->on = false;
    t = t1;
    z0 = h->source(h->ctx, f->gap, t);
  }
  last = *f;
  return status;
}

static const vs_circuit_kind FAKE = {.name = "fake", .load = load, .run = run, .free = free};

/* A circuit whose flux linkage is given: 1 Wb sin^2(pi t/10 ms), whatever the gap. */
static vs_status run_given(void *circuit, vs_error *err) {
  fake *f = circuit;
  const vs_circuit_host *h = f->host;
  vs_status status = VS_OK;
  double n = ceil(f->job->until_s / f->job->max_step_s), w = M_PI / 0.01;
  for (double k = 1; k <= n && !status; k++) {
    double t = k * f->job->until_s / n, values[5 + 2 * VS_DECK_MOST] = {0};
    h->source(h->ctx, f->gap, t);
    for (size_t s = 0; s < f->job->n_signals; s++) {
      if (!strcmp(f->job->signals[s], "v(xeva.lam)")) values[s] = sin(w * t) * sin(w * t);
      if (!strcmp(f->job->signals[s], "v(xeva.x)")) values[s] = w * sin(2 * w * t);
    }
    status = h->accept(h->ctx, t, values, err);
  }
  return status;
}
static const vs_circuit_kind GIVEN = {
    .name = "given flux", .load = load, .run = run_given, .free = free};

/* The circuit tier on a scene of its own, with the fake for a solver. */
typedef struct outcome {
  vs_status status;
  double first, p_min, extinction, work, residual;
} outcome;

static outcome couple(const vs_circuit_kind *solver, const char *const *sets) {
  vs_trial *t = vs_trial_read("paper", "circuit", sets);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  t->scene.order.solver = solver;
  vs_trial_go(t, NULL);
  /* The fakes show no voltages, so that the session's books are open; this test keeps its own. */
  if (strstr(t->err.text, "energy books")) t->status = VS_OK;
  double work = t->result.watchers.energy.joule[VS_E_WORK];
  outcome o = {
      t->status,
      t->result.values[VS_M_GAP_FIRST].value,
      t->result.values[VS_M_GAP_MIN].value,
      t->result.values[VS_M_T_EXTINCTION].value,
      work,
      (last.taken_j - last.copper_j - work - t->result.watchers.energy.joule[VS_E_MAGNETIC]) /
          work};
  vs_trial_free(t);
  return o;
}

/* Single shot: first peak and extinction go to the switched tier's (T2) with the square of the
 * step. */
static void second_order(void) {
  static const char *const STEPS[] = {"run.max_step=200us", "run.max_step=100us",
                                      "run.max_step=50us", "run.max_step=25us"};
  double peak[4], residual[4];
  for (int k = 0; k < 4; k++) {
    const char *sets[] = {STEPS[k], "run.until=0.05s", NULL};
    outcome o = couple(&FAKE, sets);
    CU_ASSERT_EQUAL_FATAL(o.status, VS_OK);
    peak[k] = fabs(o.first + 0.00141639233706);
    residual[k] = fabs(o.residual);
  }
  for (int k = 0; k < 3; k++) {
    printf(" %.2f/%.2f", log2(peak[k] / peak[k + 1]), log2(residual[k] / residual[k + 1]));
    CU_ASSERT(log2(peak[k] / peak[k + 1]) >= 1.8);
    CU_ASSERT(log2(residual[k] / residual[k + 1]) >= 1.8);
  }
  CU_ASSERT(peak[3] < 1e-4 * 1.4e-3);
}

/* The accepted step is integrated under the flux found, not under the one extrapolated: with the
 * flux given, only the mechanics is left, of fourth order in the step. Measured: 1.0e-5 and 6.5e-7
 * of p_min at 500 and 250 us; under the extrapolated flux it would be 8.6e-4 and 5.4e-5. */
static void corrected_by_the_flux_found(void) {
  static const char *const STEPS[] = {"run.max_step=10us", "run.max_step=500us",
                                      "run.max_step=250us"};
  double p_min[3];
  for (int k = 0; k < 3; k++) {
    const char *sets[] = {STEPS[k], "run.until=0.05s", NULL};
    outcome o = couple(&GIVEN, sets);
    CU_ASSERT_EQUAL_FATAL(o.status, VS_OK);
    p_min[k] = o.p_min;
  }
  double coarse = fabs(p_min[1] / p_min[0] - 1), fine = fabs(p_min[2] / p_min[0] - 1);
  CU_ASSERT(coarse < 2e-5);
  CU_ASSERT(fine < 2e-6);
  CU_ASSERT(log2(coarse / fine) > 3.5);
}

/* Continuous firing, where loose schemes grow without bound: exchanging i with z held is unstable
 * beyond H* = 287 us (Gauss-Seidel 574 us) at 90 degrees and 450 us (900 us) at 100. This coupling
 * at H = 1 ms and 0.5 ms stays bounded, and its books close. */
static void no_false_growth(void) {
  static const struct {
    const char *angle, *step;
    double p_min, tolerance,
        residual; /* both of second order in the step; measured: 1.3e-2, 0.11 at 1 ms */
  } ROWS[] = {{"firing.angle=100deg", "run.max_step=1ms", -3.65770e-3, 0.02, 0.15},
              {"firing.angle=100deg", "run.max_step=500us", -3.65770e-3, 0.005, 0.0375},
              {"firing.angle=100deg", "run.max_step=50us", -3.65770e-3, 5e-5, 3.75e-4},
              {"firing.angle=90deg", "run.max_step=250us", -5.75672e-3, 0.002, 0.01}};
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    const char *sets[] = {ROWS[k].angle, ROWS[k].step, "firing.every=1", "run.until=1.5s", NULL};
    outcome o = couple(&FAKE, sets);
    printf(" %.3g/%.1e", o.p_min / ROWS[k].p_min - 1, o.residual);
    CU_ASSERT_EQUAL(o.status, VS_OK);
    CLOSE(o.p_min, ROWS[k].p_min, ROWS[k].tolerance);
    CU_ASSERT(fabs(o.residual) <= ROWS[k].residual);
  }
}

/* A circuit that gives nonsense ends the run with the time, and is no result. */
static void nonsense_is_an_error(void) {
  const char *sets[] = {"run.max_step=50us", "run.until=0.05s", NULL};
  poison_s = 0.01;
  outcome o = couple(&FAKE, sets);
  poison_s = INFINITY;
  CU_ASSERT_EQUAL(o.status, VS_RUN);
}

static const vs_test TESTS[] = {
    {"order", second_order},
    {"corrector", corrected_by_the_flux_found},
    {"nonsense", nonsense_is_an_error},
    {"no false growth of energy", no_false_growth},
};
VS_SUITE_MAIN("coupling against a fake circuit", TESTS)
