/* SPDX-License-Identifier: GPL-3.0-or-later
 * Gate drives as parts: pulse height, current, flux, saturation, reset, rise time and direction
 * against what the elements of the drive give by themselves; thyristors fired by them. Everything
 * by both rules of integration. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "suite.h"

/* The transformers on the bench; the last is no part, but an instance of what the parts rest on. */
typedef struct drive {
  const char *part;
  double turns, main_h, leak_h, area_vs, primary_ohm, secondary_ohm;
} drive;
static const drive DRIVES[] = {{"gate_pulse_transformer", 2, 10e-3, 100e-6, 1500e-6, 2, 1},
                               {"gate_pt20_104", 1, 2e-3, 13e-6, 1853e-6, 12, 12},
                               {"gate_pt20_105", 1, 5e-3, 15e-6, 2850e-6, 18, 18},
                               {NULL, 3, 6e-3, 200e-6, 1500e-6, 5, 30}};
#define EACH(d) for (const drive *d = DRIVES; d < DRIVES + COUNT(DRIVES); d++)

/* The circuit around them, the same for all: spice/gate_drive.inc. */
static const double SUPPLY_V = 24, RESET_V = 36, DRIVER_OHM = 33, DAMPING_OHM = 1000, R3_OHM = 47,
                    RGK_OHM = 100;

/* A sub-pulse of 50 us in 100 us between the middles of its edges; the window round them all. */
#define SUB_PULSES(edge)                                                                           \
  "Vw w 0 pulse(0 1 1u 1u 1u 1 2)\nVb b 0 pulse(0 1 10u " edge " " edge " {50u-" edge "} 100u)\n"

/* ---- the bench ---- */

enum { POINTS = 100000 };
typedef struct trace {
  size_t points;
  double t_s[POINTS], y[BENCH_SIGNALS][POINTS];
} trace;

static void note(void *ctx, double t_s, const double *signals) {
  trace *r = ctx;
  if (r->points >= POINTS) return;
  r->t_s[r->points] = t_s;
  for (int k = 0; k < BENCH_SIGNALS; k++) r->y[k][r->points] = signals[k];
  r->points++;
}

typedef struct course {
  bool gear;
  double until_s, step_s, tolerance;
} course;
#define EACH_METHOD(gear) for (int gear = 0; gear < 2; gear++)

/* Signals of every trial, in this order: of the gate (g to k), its current through Vg where there
 * is one, the main inductance, the part of the core's volt-seconds. */
enum { GATE, CATHODE, MAIN, FLUX };

/* Runs the drive d with the circuit (as for printf) at its pins w b g k. Free what comes back. */
static trace *try_out(const drive *d, course c, const char *second, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
static trace *try_out(const drive *d, course c, const char *second, const char *format, ...) {
  char deck[2048];
  int n = d->part ? snprintf(deck, sizeof deck, "*$ param gate_drive = %s part\n", d->part)
                  : snprintf(deck, sizeof deck,
                             ".include gate_drive.inc\n.subckt gate_drive window burst g k\n"
                             "X1 window burst g k flux pulse_gate_drive turns=%g main=%g leak=%g "
                             "area=%g r_primary=%g r_secondary=%g\n.ends\n",
                             d->turns, d->main_h, d->leak_h, d->area_vs, d->primary_ohm,
                             d->secondary_ohm);
  n += snprintf(deck + n, sizeof deck - (size_t)n, "Xd w b g k gate_drive\n");
  va_list args;
  va_start(args, format);
  vsnprintf(deck + n, sizeof deck - (size_t)n, format, args);
  va_end(args);
  trace *r = calloc(1, sizeof *r);
  bench b = {.deck = deck,
             .signals = {"v(g)", second, "v(xd.x1.p)", "v(xd.x1.flux)"},
             .until_s = c.until_s,
             .max_step_s = c.step_s,
             .relative_tolerance = c.tolerance,
             .gear = c.gear,
             .see = note,
             .ctx = r};
  vs_error err = {0};
  vs_status s = bench_run(&b, &err);
  EXPECT(!s && r->points < POINTS, "%s: %s", d->part ? d->part : "instance", err.text);
  return r;
}

static double at(const trace *r, int signal, double t_s) {
  size_t k = 1;
  while (k + 1 < r->points && r->t_s[k] < t_s) k++;
  double part = (t_s - r->t_s[k - 1]) / (r->t_s[k] - r->t_s[k - 1]);
  return r->y[signal][k - 1] + (r->y[signal][k] - r->y[signal][k - 1]) * part;
}

static double extreme(const trace *r, int signal, double from_s, double to_s, double sign) {
  double most = -INFINITY;
  for (size_t k = 0; k < r->points; k++)
    if (r->t_s[k] >= from_s && r->t_s[k] <= to_s) most = fmax(most, sign * r->y[signal][k]);
  return sign * most;
}

/* ---- what the drive's elements give ---- */

static double primary_ohm(const drive *d) {
  return DRIVER_OHM + d->primary_ohm;
}
static double secondary_ohm(const drive *d) {
  return R3_OHM + d->secondary_ohm;
}

/* Gate current into load_ohm at a main current of main_a, leakage apart: the driver's resistance
 * and the damping resistor on the one side, the diode's law on the other. *main_v: of the main
 * inductance. */
static double gate_current(const drive *d, double load_ohm, double main_a, double *main_v) {
  double drives = 1 / primary_ohm(d) + 1 / DAMPING_OHM, i = 0;
  for (int n = 0; n < 200; n++) {
    *main_v = (SUPPLY_V / primary_ohm(d) - main_a - i / d->turns) / drives;
    double diode_v = 1.8 * 0.025865 * log(1 + i / 10e-9);
    double next = (*main_v / d->turns - diode_v) / (secondary_ohm(d) + load_ohm);
    i += 0.3 * (fmax(next, 0) - i);
  }
  return i;
}

/* The gate current so long into a sub-pulse: meanwhile the main voltage falls nearly straight. */
static double current_after(const drive *d, double load_ohm, double t_s) {
  double first_v, main_v, main_a = 0;
  gate_current(d, load_ohm, 0, &first_v);
  for (int n = 0; n < 20; n++) {
    gate_current(d, load_ohm, main_a, &main_v);
    main_a = (first_v + main_v) / 2 * t_s / d->main_h;
  }
  return gate_current(d, load_ohm, main_a, &main_v);
}

/* 8 us into the sub-pulse, when leakage is over and the main current has hardly begun; the gate
 * open but for R_gk, and short. What the current lags behind the sagging pulse, and that the pulse
 * does not sag straight: 0.7 %. */
static void height_and_current(void) {
  EACH(d) EACH_METHOD(gear) {
    course c = {gear, 30e-6, 0.2e-6, 1e-6};
    trace *r = try_out(d, c, "v(k)", SUB_PULSES("1u") "Vk k 0 0\n");
    CLOSE(at(r, GATE, 18e-6), RGK_OHM * current_after(d, RGK_OHM, 8e-6), 7e-3);
    free(r);
    r = try_out(d, c, "i(vg)", SUB_PULSES("1u") "Vk k 0 0\nVg g k 0\n");
    CLOSE(at(r, CATHODE, 18e-6), current_after(d, 0, 8e-6), 7e-3);
    free(r);
  }
}

/* The voltage of the main inductance, driven through all the resistances in parallel, falls as
 * exp(-t R/L); its integral over the 50 us is the flux. The diode's drop is not constant: 1 %. And
 * the flux is the integral of the voltage that stands there: 0.1 %. */
static void volt_seconds(void) {
  EACH(d) EACH_METHOD(gear) {
    trace *r = try_out(d, (course){gear, 70e-6, 0.1e-6, 1e-6}, "i(vg)",
                       SUB_PULSES("1u") "Vk k 0 0\nVg g k 0\n");
    double main_v, area = 0;
    gate_current(d, 0, 0, &main_v);
    double ohm =
        1 / (1 / primary_ohm(d) + 1 / DAMPING_OHM + 1 / (d->turns * d->turns * secondary_ohm(d)));
    double decay_s = d->main_h / ohm, t_s = 61e-6;
    CLOSE(extreme(r, FLUX, 0, t_s, 1) * d->area_vs, main_v * decay_s * -expm1(-50e-6 / decay_s),
          0.01);
    for (size_t k = 1; k < r->points && r->t_s[k] < 55e-6; k++)
      area += (r->t_s[k] - r->t_s[k - 1]) * (r->y[MAIN][k] + r->y[MAIN][k - 1]) / 2;
    CLOSE(at(r, FLUX, 55e-6) * d->area_vs, area, 2e-3 + 0.1e-6 / 45e-6);
    free(r);
  }
}

/* One long pulse: when the voltage is at half its height, the core has had its volt-seconds, within
 * 10 %; then the gate has nothing, and the driver its short-circuit current. Of those whose driver
 * can do it: the others' main current ends below saturation. */
static void saturation(void) {
  EACH(d) EACH_METHOD(gear) {
    bool can = d->area_vs / d->main_h < 0.5 * SUPPLY_V / primary_ohm(d);
    trace *r =
        try_out(d, (course){gear, 500e-6, 0.2e-6, 1e-5}, "v(k)",
                "Vw w 0 pulse(0 1 1u 1u 1u 1 2)\nVb b 0 pulse(0 1 10u 1u 1u 1 2)\nVk k 0 0\n");
    double area = 0, height = at(r, MAIN, 20e-6), gate = at(r, GATE, 20e-6),
           end = r->t_s[r->points - 1];
    size_t k = 1;
    for (; k < r->points && (r->t_s[k] < 20e-6 || r->y[MAIN][k] > height / 2); k++)
      area += (r->t_s[k] - r->t_s[k - 1]) * (r->y[MAIN][k] + r->y[MAIN][k - 1]) / 2;
    if (can) {
      CLOSE(area, d->area_vs, 0.1);
      EXPECT(at(r, GATE, end) < 0.01 * gate, "%g V at the gate of a saturated core",
             at(r, GATE, end));
      CLOSE((SUPPLY_V - at(r, MAIN, end)) / primary_ohm(d), SUPPLY_V / primary_ohm(d), 0.02);
    } else
      EXPECT(at(r, FLUX, end) < 1, "%s saturates", d->part);
    free(r);
  }
}

/* 80 sub-pulses: each pause demagnetises the core, but for exp(-3.4) of what the damping resistor
 * is left with (1.3 %), so that the first pulse has more room than the others, and these are alike.
 */
static void reset(void) {
  EACH(d) EACH_METHOD(gear) {
    trace *r = try_out(d, (course){gear, 8.02e-3, 20e-6, 1e-6}, "v(k)",
                       SUB_PULSES("1u") "Vk k 0 0\nRg g k 5\n");
    double second = extreme(r, FLUX, 110e-6, 210e-6, 1);
    CLOSE(extreme(r, FLUX, 0, 110e-6, 1), second, 0.02);
    double most = 0.3 * d->primary_ohm; /* 0.3 A in it, or less */
    CLOSE_OF(extreme(r, MAIN, 0, 1, -1), -(RESET_V + 0.9 + most / 2), 1, 0.3 + most / 2);
    CLOSE(extreme(r, FLUX, 7.91e-3, 8.009e-3, 1), second, 1e-3);
    for (int n = 1; n <= 80; n++) CLOSE_OF(at(r, FLUX, n * 100e-6 + 9e-6), 0, second, 0.02);
    free(r);
  }
}

/* The gate current never flows back, and between sub-pulses it is gone: a thousandth of it 20 us
 * behind the pulse. */
static void direction(void) {
  EACH(d) EACH_METHOD(gear) {
    trace *r = try_out(d, (course){gear, 1.01e-3, 1e-6, 1e-5}, "i(vg)",
                       SUB_PULSES("1u") "Vk k 0 0\nVg g k 0\n");
    double height = extreme(r, CATHODE, 0, 1e-3, 1), back = extreme(r, CATHODE, 0, 1e-3, -1);
    EXPECT(back > -1e-9, "%g A back into the gate", back);
    for (int n = 0; n < 10; n++) CLOSE_OF(at(r, CATHODE, n * 100e-6 + 80e-6), 0, height, 1e-3);
    free(r);
  }
}

/* What 80 sub-pulses cost: 5 steps of 20 us in each, and at each of their 4 corners not many more
 * until the step has grown from nothing to 20 us again; 8 for 1, 2, 4, ... Behind them nothing. */
static void steps(void) {
  EACH(d) EACH_METHOD(gear) {
    trace *r = try_out(d, (course){gear, 20.01e-3, 20e-6, 1e-5}, "v(k)",
                       "Vw w 0 pulse(0 1 1u 1u 1u 8.01m 1)\nVk k 0 0\nRg g k 5\n"
                       "Vb b 0 pulse(0 1 10u 1u 1u 49u 100u 80)\n");
    size_t k = 0, pulses;
    while (r->t_s[k] < 8.01e-3) k++;
    pulses = k;
    while (r->t_s[k] < 9e-3) k++;
    printf(" %s, %s: %.1f steps a sub-pulse\n", d->part ? d->part : "instance",
           gear ? "gear" : "trap", (double)pulses / 80);
    EXPECT(pulses < 80 * 50, "%zu steps for 80 sub-pulses", pulses);
    EXPECT(r->points - k < 600, "%zu steps in 11 ms of quiet", r->points - k);
    free(r);
  }
}

/* From 10 to 90 % in ln 9 time constants leakage over resistance, the driver's seen from the
 * secondary; the second sub-pulse, as the first begins at nothing. The diode's drop grows
 * meanwhile: 3 %. */
static void rise_time(void) {
  EACH(d) EACH_METHOD(gear) {
    double n2 = d->turns * d->turns,
           ohm = secondary_ohm(d) + 1 / (1 / primary_ohm(d) + 1 / DAMPING_OHM) / n2,
           tau_s = d->leak_h / n2 / ohm, reached_s[2] = {0};
    trace *r = try_out(d, (course){gear, 112e-6 + 20 * tau_s, tau_s / 20, 1e-6}, "i(vg)",
                       SUB_PULSES("1n") "Vk k 0 0\nVg g k 0\n");
    double height = extreme(r, CATHODE, 109e-6, 1, 1);
    for (size_t k = 1; k < r->points; k++)
      for (int e = 0; e < 2; e++)
        if (r->t_s[k] > 110e-6 && !reached_s[e] && r->y[CATHODE][k] > (e ? 0.9 : 0.1) * height)
          reached_s[e] = r->t_s[k];
    CLOSE(reached_s[1] - reached_s[0], log(9) * tau_s, 0.05);
    free(r);
  }
}

/* The cathode at 1500 V and thrown to -1500 V at 1000 V/us, in a pause and in a sub-pulse: the gate
 * goes with it, within what 1e-6 of 1500 V leaves. */
static void isolation(void) {
  EACH(d) EACH_METHOD(gear) {
    course c = {gear, 150e-6, 0.2e-6, 1e-6};
    trace *still = try_out(d, c, "v(k)", SUB_PULSES("1u") "Vk k 0 0\n");
    trace *thrown = try_out(d, c, "v(k)",
                            SUB_PULSES("1u") "Vk k 0 pwl(0 0 2u 1500 70u 1500 73u -1500 "
                                             "120u -1500 123u 1500)\n");
    static const double T_S[] = {8e-6, 30e-6, 68e-6, 71e-6, 74e-6, 100e-6, 118e-6, 121e-6, 124e-6};
    for (size_t k = 0; k < COUNT(T_S); k++)
      CLOSE_OF(at(thrown, GATE, T_S[k]) - at(thrown, CATHODE, T_S[k]), at(still, GATE, T_S[k]), 10,
               1e-3);
    free(still);
    free(thrown);
  }
}

/* ---- with a thyristor ---- */

static const char *const THYRISTORS[] = {"latch", "thyristor_2t", "BT151-800R", "TYN1212"};

/* The thyristor's voltage 20 us behind a sub-pulse, with 2 A at v_v in a load at its cathode; the
 * window is there all the time. */
static double left_over(const char *thyristor, const drive *d, bool gear, double v_v, bool burst) {
  trace *r = try_out(d, (course){gear, 180e-6, 2e-6, 1e-5}, "v(k)",
                     "*$ param thyristor = %s part\nXt a k g thyristor\nV1 a 0 pwl(0 0 50u %g)\n"
                     "Ra a c 100\nCa c k 100n ic=0\nLl k l 500u ic=0\nRl l 0 %g\n"
                     "Vw w 0 pulse(0 1 1u 1u 1u 1 2)\nVb b 0 pulse(0 %d 110u 1u 1u 49u 1)\n",
                     thyristor, v_v, v_v / 2, burst);
  double left = v_v - at(r, CATHODE, 180e-6);
  free(r);
  return left;
}

/* From 3, 10 and 600 V, the cathode at 0 before and at nearly all of the voltage behind. Without
 * sub-pulses it stays off, but for leakage. */
static void fires(void) {
  static const double V_V[] = {3, 10, 600};
  EACH(d)
  for (size_t t = 0; t < COUNT(THYRISTORS); t++) EACH_METHOD(gear) {
      for (size_t k = 0; k < COUNT(V_V); k++) {
        double left = left_over(THYRISTORS[t], d, gear, V_V[k], true);
        EXPECT(left < 1.3, "%s from %g V: %g V left", THYRISTORS[t], V_V[k], left);
      }
      double left = left_over(THYRISTORS[t], d, gear, 600, false);
      EXPECT(left > 590, "%s fires without a sub-pulse: %g V left", THYRISTORS[t], left);
    }
}

/* ---- the ideal one ---- */

/* 1 V during the window, whatever the sub-pulses and the cathode do. */
static void ideal(void) {
  EACH_METHOD(gear) {
    bench b = {.deck = "*$ param gate_drive = gate_ideal part\nXd w b g k gate_drive\n"
                       "Vw w 0 pulse(0 1 50u 1u 1u 1 2)\nVb b 0 0\nRb g k 5\n"
                       "Vk k 0 pwl(0 0 1u 1500 100u 1500 103u -1500)\n",
               .signals = {"v(g)", "v(k)", "v(w)"},
               .max_step_s = 1e-6,
               .relative_tolerance = 1e-6,
               .gear = gear};
    for (b.until_s = 40e-6; b.until_s < 130e-6; b.until_s += 40e-6) {
      vs_error err = {0};
      EXPECT(!bench_run(&b, &err), "%s", err.text);
      CLOSE_OF(b.last[0] - b.last[1], b.until_s > 50e-6, 1, 1e-9);
    }
  }
}

static const vs_test TESTS[] = {{"height and current of a sub-pulse", height_and_current},
                                {"volt-seconds of a sub-pulse", volt_seconds},
                                {"saturation", saturation},
                                {"reset", reset},
                                {"direction", direction},
                                {"rise time", rise_time},
                                {"steps", steps},
                                {"isolation", isolation},
                                {"fires thyristors", fires},
                                {"ideal", ideal}};
VS_SUITE_MAIN("gate drives", TESTS)
