/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the circuit tier remembers from edge to edge and computes for many steps at once is what it
 * would be if it were asked for anew: gates and modulated switches with events, and formulas. */
#include <math.h>
#include <stdlib.h>

#include "engine/batch.h"
#include "engine/signals.h"
#include "schedule.h"

/* ---- from edge to edge ---- */

static double random_share(void) {
  return rand() / (RAND_MAX + 1.0);
}

/* The next instant as a solver would ask: mostly a step on, at times back, and at times on an edge
 * or right beside one. */
static double next_s(const vs_timeline *t, const vs_signal *s, double now_s) {
  double edge_s = vs_signals_edge(t, s, now_s), share = random_share();
  if (share < 0.1) return now_s - 20e-6 * random_share();
  if (share < 0.2 && edge_s < now_s + 1e-3) return edge_s;
  if (share < 0.3 && edge_s < now_s + 1e-3)
    return edge_s + 4 * (random_share() - 0.5) * vs_scene_event_rounding(edge_s);
  if (share < 0.4) return now_s + 1e-15 * random_share();
  return now_s + 60e-6 * random_share();
}

static void remembered(void) {
  static const char EVENTS[] = "firing: {angle: 90 deg, every: 1, burst_frequency: 5 kHz}\n"
                               "pwm: {carrier: 2 kHz, duty: 0.5, depth: 0.8, dead_time: 3 us}\n"
                               "events:\n"
                               " a: {kind: missing_pulse, cycle: 2}\n"
                               " b: {kind: short_pulse, cycle: 3, duration: 1 ms}\n"
                               " c: {kind: weak_pulse, cycle: 4, level: 25 %}\n"
                               " d: {kind: spurious_pulse, at: 97 ms, duration: 0.5 ms}\n"
                               " cut: {kind: notch, cycle: 5, angle: 90 deg, duration: 1 ms, "
                               "depth: 50 %, count: 3}\n";
  const vs_timeline t = schedule(EVENTS);
  static const int DRIVES[] = {VS_PORT_MAINS, VS_PORT_GATE, VS_PORT_BURST, VS_PORT_PWM,
                               VS_PORT_PWM_LOW};
  srand(1);
  for (size_t k = 0; k < COUNT(DRIVES); k++) {
    const vs_signal s = {.drive = DRIVES[k], .shift_rad = k == 1 ? M_PI : 0};
    vs_signals_cache held = {0};
    long asked = 0, wrong = 0, known = 0;
    for (double now_s = 0; now_s < 0.2; now_s = fmax(next_s(&t, &s, now_s), 0)) {
      asked++;
      known += vs_signals_cache_holds(&held, now_s);
      wrong += vs_signals_voltage_cached(&held, &t, &s, now_s) != vs_signals_voltage(&t, &s, now_s);
    }
    EXPECT(wrong == 0, "drive %d: %ld of %ld answers are wrong", DRIVES[k], wrong, asked);
    EXPECT(!vs_signals_holds(&s) || known > asked / 2, "drive %d: %ld of %ld are from memory",
           DRIVES[k], known, asked);
  }
}

/* ---- many steps at once ---- */

static int term_of(void *ctx, const char *at, const vs_formula_term *term) {
  (void)ctx, (void)at;
  return *term->first - 'a';
}
static int name_of(void *ctx, const char *at, const char *name) {
  (void)ctx, (void)at;
  return *name == 'p' ? 0 : -1;
}
static const vs_formula_scope SCOPE = {.term = term_of, .name = name_of};

static void fill(vs_batch *b) {
  for (b->count = 0; b->count < VS_BATCH_STEPS; b->count++)
    for (int t = 0; t < 3; t++)
      b->term[t][b->count] = (vs_pair){20 * random_share() - 10, 20 * random_share() - 10};
  b->term[0][3] = (vs_pair){0, -0.0};
}

static void at_once(void) {
  static const char *const TEXT[] = {"v(a)",
                                     "-3*v(b)",
                                     "v(a)^2/p",
                                     "v(a)*v(b)+v(c)-p",
                                     "1m*abs(v(a))*pow(abs(v(a))/p,30)",
                                     "1m*pwr(v(a)/p,31)",
                                     "pow(abs(v(a)),2.5)",
                                     "pwr(v(b),-3)",
                                     "abs(v(a))^v(c)",
                                     "max(v(a),v(b))-min(v(b),v(c))*exp(-abs(v(c)))",
                                     "-sqrt(abs(v(a)))/(v(b)-v(c))",
                                     "2*p"};
  static vs_batch b;
  const double p = 7;
  fill(&b);
  for (size_t k = 0; k < COUNT(TEXT); k++) {
    vs_formula f = {0};
    const char *bad;
    char why[200] = "";
    const char *end = vs_formula_read(TEXT[k], &SCOPE, &f, &bad, why, sizeof why);
    EXPECT(end && !*end, "%s: %s", TEXT[k], why);
    vs_formula_bind(&f, &p);
    const vs_formula_prepared quick = vs_formula_prepare(&f);
    vs_pair value[VS_BATCH_STEPS];
    vs_batch_evaluate(&quick, &b, value);
    for (size_t n = 0; n < 2 * b.count; n++) {
      double terms[3];
      for (int t = 0; t < 3; t++) terms[t] = b.term[t][n / 2][n % 2];
      double one = vs_formula_prepared_value(&quick, terms), many = value[n / 2][n % 2];
      EXPECT(one == many || (isnan(one) && isnan(many)), "%s: %.17g, not %.17g", TEXT[k], many,
             one);
    }
    vs_formula_free(&f);
  }
}

static const vs_test TESTS[] = {{"what stays from edge to edge is remembered", remembered},
                                {"a formula over many steps is what it is in each", at_once}};
VS_SUITE_MAIN("held", TESTS)
