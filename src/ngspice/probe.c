/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "probe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The circuit. Its source gives U sin(w t). The gate opens the latch at FIRES_S and closes at
 * GATED_S; the latch goes out where its current would reverse. */
static char *const NETLIST[] = {"a coil behind a latch, and a capacitor behind a resistor",
                                "Vs s 0 external",
                                "Vg g 0 external",
                                "Vi s a 0",
                                "Rl a b 10",
                                "Ll b c 10m ic=0",
                                "Bset set 0 V = v(c,0) < 0 ? -0.1 : 0.1*v(g)",
                                "Slatch c 0 set 0 state off",
                                ".model state sw(ron=1e-3 roff=1e18 vt=0 vh=0.09)",
                                "Roff c 0 1e9",
                                "Rc s d 1k",
                                "Cc d 0 1u ic=0"};
static const char *const PORTS[] = {"vs", "vg"};
enum { VOLTAGE, CURRENT, LATCH, CHARGED, SIGNALS };
static const char *const NAMES[SIGNALS] = {"v(s)", "i(vi)", "v(c)", "v(d)"};
static const double U = 100, W = 100 * M_PI;                    /* V, rad/s */
static const double R = 10, R_ON = 1e-3, L = 10e-3, TAU = 1e-3; /* ohm, ohm, H, R C in s */
static const double FIRES_S = 2e-3, GATED_S = 4e-3, UNTIL_S = 19e-3, STEP_S = 50e-6;

/* What is allowed: of the first two, some ten times what ngspice 39 to 47 leave. They obey the rule
 * to 1e-15; Gear's is 1e-7 off. */
static const double OFF = 2.5e-4; /* of currents and voltages, in parts of their peaks */
static const double BOOKS = 5e-5; /* of energy, in parts of what was drawn */
static const double RULE = 1e-9;  /* of the trapezoidal rule, in parts of the source's peak */
static const double NONE = 1e-5;  /* a step of no length, in parts of the largest */
static const double THERE = 1e-9; /* an instant, in parts of the largest step */

typedef struct watch {
  double out_s;              /* when the latch goes out */
  double t_s, at[SIGNALS];   /* of the last step */
  double allowed_s, asked_s; /* the next step's longest; when the source was last asked for */
  double drawn_j, lost_j;    /* what the coil's branch drew; what its resistor and the latch took */
  double shortest_s, most_a, off_a, off_v;     /* least step; peak current; largest errors */
  bool fired_there, too_long, asked_elsewhere; /* a step ended where the latch fires; one was longer
                                                  than allowed; the source was not asked for the
                                                  instant that was then accepted */
  long whole, otherwise; /* steps as long as allowed behind one such; those by another rule */
  bool was_whole;
} watch;

/* ---- closed forms ---- */

/* The current of R and L from FIRES_S on, until it would reverse. */
static double current_at(double t_s) {
  double r = R + R_ON, z = hypot(r, W * L), phi = atan2(W * L, r);
  double left = exp(-(t_s - FIRES_S) * r / L);
  return U / z * (sin(W * t_s - phi) - sin(W * FIRES_S - phi) * left);
}

/* Where it would reverse, by bisection. */
static double goes_out_s(void) {
  double from = M_PI / W, to = 1.5 * M_PI / W;
  for (int k = 0; k < 60; k++) {
    double middle = (from + to) / 2;
    *(current_at(middle) > 0 ? &from : &to) = middle;
  }
  return from;
}

static double charged_at(double t_s) {
  double z = hypot(1, W * TAU), phi = atan(W * TAU);
  return U / z * (sin(W * t_s - phi) + sin(phi) * exp(-t_s / TAU));
}

/* ---- the solver's host ---- */

static double probe_source(void *ctx, size_t port, double t_s) {
  watch *w = ctx;
  w->asked_s = t_s;
  if (port == 0) return U * sin(W * t_s);
  return t_s > FIRES_S && t_s <= GATED_S ? 1 : 0;
}

static double probe_edge(void *ctx, double t_s) {
  const watch *w = ctx;
  if (t_s < FIRES_S) return FIRES_S;
  return t_s < GATED_S ? GATED_S : t_s < w->out_s ? w->out_s : INFINITY;
}

static double probe_longest(void *ctx, double t_s) {
  watch *w = ctx;
  return w->allowed_s = t_s < FIRES_S ? STEP_S : STEP_S / 2;
}

/* True if the step obeys the trapezoidal rule: v1 - v0 = h (f0 + f1)/2, f = (u - v)/(R C). */
static bool is_trapezoidal(const watch *w, double h, const double *to) {
  double f0 = (w->at[VOLTAGE] - w->at[CHARGED]) / TAU, f1 = (to[VOLTAGE] - to[CHARGED]) / TAU;
  return fabs(to[CHARGED] - w->at[CHARGED] - h * (f0 + f1) / 2) < RULE * U;
}

static void add_energy(watch *w, double h, const double *x) {
  double i = x[CURRENT];
  w->drawn_j += h / 2 * x[VOLTAGE] * i;
  w->lost_j += h / 2 * (R * i + x[LATCH]) * i;
}

static vs_status accept_probe_step(void *ctx, double t_s, const double *signals, vs_error *err) {
  (void)err;
  watch *w = ctx;
  double h = t_s - w->t_s, i = signals[CURRENT];
  bool whole = h > w->allowed_s * (1 - THERE);
  w->shortest_s = fmin(w->shortest_s, h);
  w->too_long = w->too_long || h > w->allowed_s * (1 + THERE);
  w->asked_elsewhere = w->asked_elsewhere || fabs(w->asked_s - t_s) > THERE * STEP_S;
  w->fired_there = w->fired_there || fabs(t_s - FIRES_S) < THERE * STEP_S;
  w->whole += whole && w->was_whole;
  w->otherwise += whole && w->was_whole && !is_trapezoidal(w, h, signals);
  w->was_whole = whole;
  add_energy(w, h, w->at);
  add_energy(w, h, signals);
  double expected = t_s > FIRES_S && t_s < w->out_s ? current_at(t_s) : 0;
  w->most_a = fmax(w->most_a, expected);
  w->off_a = fmax(w->off_a, fabs(i - expected));
  w->off_v = fmax(w->off_v, fabs(signals[CHARGED] - charged_at(t_s)));
  w->t_s = t_s;
  memcpy(w->at, signals, sizeof w->at);
  return VS_OK;
}

/* ---- what came of it ---- */

static void judge_probe(const watch *w, char wrong[VS_PROBE_TEXT]) {
  double stored_j = L * w->at[CURRENT] * w->at[CURRENT] / 2;
  double left = fabs(w->drawn_j - w->lost_j - stored_j) / w->drawn_j;
  *wrong = '\0';
  if (UNTIL_S - w->t_s > THERE * STEP_S)
    snprintf(wrong, VS_PROBE_TEXT, "its last step ends %.2g s before the run's end",
             UNTIL_S - w->t_s);
  else if (!w->fired_there)
    snprintf(wrong, VS_PROBE_TEXT, "it steps over instants where a step must end");
  else if (w->too_long)
    snprintf(wrong, VS_PROBE_TEXT, "it takes steps longer than allowed");
  else if (w->asked_elsewhere)
    snprintf(wrong, VS_PROBE_TEXT, "it asks its sources for other instants than its steps end at");
  else if (w->shortest_s < NONE * STEP_S)
    snprintf(wrong, VS_PROBE_TEXT, "it takes steps of %.2g s, which have no length", w->shortest_s);
  else if (w->whole < 100 || w->otherwise > w->whole / 10)
    snprintf(wrong, VS_PROBE_TEXT, "%ld of its %ld longest steps do not obey the trapezoidal rule",
             w->otherwise, w->whole);
  else if (w->off_a > OFF * w->most_a || w->off_v > OFF * U || isnan(w->off_a + w->off_v))
    snprintf(wrong, VS_PROBE_TEXT,
             "the current of a coil is off by %.2g of its peak, the voltage of a capacitor by %.2g",
             w->off_a / w->most_a, w->off_v / U);
  else if (!(left < BOOKS))
    snprintf(wrong, VS_PROBE_TEXT,
             "the energy books of a coil behind a latch leave %.2g of what was drawn", left);
}

void vs_probe_run(const vs_circuit_kind *solver, char wrong[VS_PROBE_TEXT]) {
  watch w = {.out_s = goes_out_s(), .shortest_s = INFINITY, .allowed_s = STEP_S};
  const vs_circuit_job job = {.netlist = NETLIST,
                              .lines = sizeof NETLIST / sizeof *NETLIST,
                              .ports = PORTS,
                              .n_ports = 2,
                              .signals = NAMES,
                              .n_signals = SIGNALS,
                              .until_s = UNTIL_S,
                              .max_step_s = STEP_S,
                              .dialect = "",
                              .relative_tolerance = 1e-4,
                              .current_tolerance_a = 1e-6,
                              .tried = true};
  const vs_circuit_host host = {&w,   probe_source, probe_edge, probe_longest, accept_probe_step,
                                NULL, NULL,         NULL};
  void *circuit = NULL;
  vs_error err = {0};
  vs_status status = solver->load(&job, &host, &circuit, &err);
  if (!status) status = solver->run(circuit, &err);
  solver->free(circuit);
  if (status)
    snprintf(wrong, VS_PROBE_TEXT, "a small circuit fails: %.150s", err.text);
  else
    judge_probe(&w, wrong);
}
