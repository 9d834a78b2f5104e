/* SPDX-License-Identifier: GPL-3.0-or-later
 * Instruments: their low-pass against closed forms and against an integration of another kind,
 * their A/D to the bit, their noise, and that neither run.sample nor other instruments change them.
 */
#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_gamma.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure/meter.h"
#include "program.h"

/* ---- the low-pass by itself ---- */

/* u(t) = sum of u[k] (t/h)^k as it is from t = h/2 on, and its first half, by powers of t/(h/2). */
static void halve(const double u[VS_LOWPASS_TERMS], double first[VS_LOWPASS_TERMS],
                  double second[VS_LOWPASS_TERMS]) {
  for (int k = 0; k < VS_LOWPASS_TERMS; k++) {
    first[k] = u[k] * pow(0.5, k);
    second[k] = 0;
    for (int n = k; n < VS_LOWPASS_TERMS; n++)
      second[k] += u[n] * gsl_sf_choose((unsigned)n, (unsigned)k) * pow(0.5, n);
  }
}

/* A step at once, and in halves of halves: they differ by rounding alone, also where the low-pass
 * changes from a series to a recursion. */
static void steps_and_halves(void) {
  static const double DAMPING[] = {0.05, 0.3, 0.7071, 0.99999999, 1};
  const double u[VS_LOWPASS_TERMS] = {0.3, -1.2, 0.8, 0.4, -0.7, 0.2, 0.1};
  double first[VS_LOWPASS_TERMS], second[VS_LOWPASS_TERMS], worst = 0;
  halve(u, first, second);
  for (int order = 1; order <= 2; order++)
    for (size_t d = 0; d < COUNT(DAMPING); d++)
      for (double h = 1e-7; h < 1e3; h *= 1.7) {
        vs_lowpass one = vs_lowpass_make(1, order, DAMPING[d]);
        vs_lowpass_settle(&one, 0.5);
        vs_lowpass two = one;
        vs_lowpass_advance(&one, h, u);
        vs_lowpass_advance(&two, h / 2, first);
        vs_lowpass_advance(&two, h / 2, second);
        for (int k = 0; k < 2; k++) worst = fmax(worst, fabs(one.x[k] - two.x[k]));
      }
  EXPECT(worst < 2e-13, "a step and its halves differ by %g", worst);
}

/* y' = w (u - y) from y = 0: of u = 1 it is 1 - exp(-w t), of u = t it is t - (1 - exp(-w t))/w. */
static void closed_forms(void) {
  for (double w = 1e-3; w < 1e5; w *= 10) {
    const double constant[VS_LOWPASS_TERMS] = {1}, line[VS_LOWPASS_TERMS] = {0, 1};
    vs_lowpass p = vs_lowpass_make(w / (2 * M_PI), 1, 1), q = p;
    vs_lowpass_advance(&p, 1, constant);
    vs_lowpass_advance(&q, 1, line);
    CLOSE(p.x[0], -expm1(-w), 1e-13);
    double y =
        w < 0.1 ? w / 2 - w * w / 6 + w * w * w / 24 - w * w * w * w / 120 : 1 + expm1(-w) / w;
    CLOSE(q.x[0], y, 1e-9); /* the series is cut off at w^5/720 */
  }
}

/* ---- samples of a run ---- */

enum { MOST = 1 << 18 };
typedef struct record {
  vs_meter meter;
  const vs_scene *scene;
  int which;
  double *t_s, *value; /* of each sample */
  int count;
} record;

static vs_status take(void *ctx, const vs_step *step, vs_error *err) {
  record *r = ctx;
  (void)err;
  if (!r->meter.instrument)
    vs_meter_begin(&r->meter, &r->scene->instruments.item[r->which], r->scene->instruments.v.seed);
  if (step->to->t_s == step->from->t_s) return VS_OK;
  double last_s = step->to->t_s + 1e-9 / r->meter.instrument->v.rate_hz; /* but for rounding */
  for (double t; (t = vs_meter_next_s(&r->meter)) <= last_s && r->count < MOST;) {
    vs_meter_to(&r->meter, step, fmin(t, step->to->t_s));
    r->t_s[r->count] = t;
    r->value[r->count++] = r->meter.value;
  }
  vs_meter_accept(&r->meter, step);
  return VS_OK;
}

static void free_record(record *r) {
  free(r->t_s);
  free(r->value);
}

/* Runs the paper's scene with these keys and records what its first instrument shows. */
static record sampled(const char *tier, const char *const *sets) {
  record r = {.t_s = vs_alloc(MOST, sizeof(double)), .value = vs_alloc(MOST, sizeof(double))};
  const vs_observer observer = {&r, take};
  vs_trial *t = vs_trial_read("paper", tier, sets);
  EXPECT(!t->status, "%s", t->err.text);
  r.scene = &t->scene;
  vs_trial_go(t, &observer);
  EXPECT(!t->status && r.count > 0, "%d samples: %s", r.count, t->err.text);
  vs_trial_free(t);
  return r;
}

/* ---- magnitude and phase ---- */

/* The sine of the mains at each frequency, through a low-pass; once its own swing has decayed to
 * 1e-11, 20 periods are compared with the closed form by Fourier's integrals. */
static void response(const char *keys, int order, double bandwidth_hz, double damping) {
  static const double HZ[] = {1, 4, 11, 25, 50, 90, 100, 170, 400, 1000};
  enum { A_PERIOD = 64, PERIODS = 20 };
  for (size_t k = 0; k < COUNT(HZ); k++) {
    char frequency[64], until[64], section[256];
    const char *const sets[] = {"supply.voltage=1V", frequency, until, section, NULL};
    snprintf(frequency, sizeof frequency, "supply.frequency=%g Hz", HZ[k]);
    const vs_lowpass p = vs_lowpass_make(bandwidth_hz, order, damping);
    double periods = PERIODS + 1 + ceil(vs_lowpass_settling(&p, 1e-11) * HZ[k]);
    snprintf(until, sizeof until, "run={until: %.17g s, sample: 1 s}", periods / HZ[k]);
    snprintf(section, sizeof section,
             "instruments={set: none, x: {channel: v_mains, range: [-2 V, 2 V], bits: none, rate: "
             "%.17g Hz, %s}}",
             A_PERIOD * HZ[k], keys);
    record r = sampled("switched", sets);
    double in_phase = 0, across = 0, gain, phase;
    for (int n = r.count - 1 - A_PERIOD * PERIODS; n < r.count - 1; n++) {
      in_phase += r.value[n] * sin(2 * M_PI * HZ[k] * r.t_s[n]);
      across += r.value[n] * cos(2 * M_PI * HZ[k] * r.t_s[n]);
    }
    double half = A_PERIOD * PERIODS / 2.0 * M_SQRT2;
    vs_lowpass_response(&p, HZ[k], &gain, &phase);
    EXPECT(fabs(hypot(in_phase, across) / half - gain) < 1e-6 * gain &&
               fabs(atan2(across, in_phase) - phase) < 1e-6,
           "%g Hz: gain %.12g, closed form %.12g; phase %.12g, %.12g", HZ[k],
           hypot(in_phase, across) / half, gain, atan2(across, in_phase), phase);
    free_record(&r);
  }
}

static void responses(void) {
  response("bandwidth: 100 Hz", 1, 100, 1);
  response("bandwidth: 200 Hz, order: 2", 2, 200, 0.7071);
  response("bandwidth: 50 Hz, order: 2, damping: 0.2", 2, 50, 0.2);
  response("bandwidth: 150 kHz, order: 2, damping: 1", 2, 150e3, 1);
}

/* 3 dB at the bandwidth, whatever the damping; of the first order 45 degrees. */
static void bandwidths(void) {
  double gain, phase;
  for (double zeta = 0.1; zeta <= 1; zeta += 0.1) {
    const vs_lowpass p = vs_lowpass_make(200, 2, zeta);
    vs_lowpass_response(&p, 200, &gain, &phase);
    CLOSE(gain, M_SQRT1_2, 1e-14);
  }
  const vs_lowpass p = vs_lowpass_make(100, 1, 1);
  vs_lowpass_response(&p, 100, &gain, &phase);
  CLOSE(gain, M_SQRT1_2, 1e-14);
  CLOSE(phase, -M_PI / 4, 1e-14);
}

/* ---- a range that is left, against Runge's and Kutta's integration ---- */

typedef struct reference {
  record r;
  double x[2], rate, most, worst;
  int compared;
} reference;

static void slope(const reference *f, const vs_step *step, double t_s, const double x[2],
                  double d[2]) {
  double u = vs_step_channel(step, t_s, f->r.meter.instrument->channel);
  u = u > f->most ? f->most : u < -f->most ? -f->most : u;
  d[0] = f->rate * x[1];
  d[1] = f->rate * (u - x[0] - 2 * f->r.meter.lowpass.damping * x[1]);
}

static void runge_kutta(reference *f, const vs_step *step, double t_s, double h) {
  static const double AT[] = {0, 0.5, 0.5, 1}, WEIGHT[] = {1, 2, 2, 1};
  double d[2] = {0, 0}, sum[2] = {0, 0};
  for (int k = 0; k < 4; k++) {
    const double x[] = {f->x[0] + AT[k] * h * d[0], f->x[1] + AT[k] * h * d[1]};
    slope(f, step, t_s + AT[k] * h, x, d);
    for (int i = 0; i < 2; i++) sum[i] += WEIGHT[k] * h / 6 * d[i];
  }
  for (int i = 0; i < 2; i++) f->x[i] += sum[i];
}

static vs_status integrate(void *ctx, const vs_step *step, vs_error *err) {
  reference *f = ctx;
  vs_status status = take(&f->r, step, err);
  double from_s = step->from->t_s, h_s = step->to->t_s - from_s;
  f->rate = f->r.meter.lowpass.rate;
  int pieces = (int)ceil(h_s / 1e-6);
  for (int k = 0; k < pieces; k++) runge_kutta(f, step, from_s + k * h_s / pieces, h_s / pieces);
  if (h_s > 0) f->worst = fmax(f->worst, fabs(f->x[0] - f->r.meter.lowpass.x[0]));
  f->compared += h_s > 0;
  return status;
}

static void beyond_the_range(void) {
  static const char *const SETS[] = {
      "instruments={set: none, x: {channel: ap, range: [-90 m/s2, 90 m/s2], bandwidth: 200 Hz, "
      "order: 2, damping: 0.5, bits: none}}",
      "run.until=80ms", NULL};
  static const char *const TIERS[] = {"switched", "circuit"};
  for (size_t k = 0; k < COUNT(TIERS); k++) {
    reference f = {.most = 90};
    f.r.t_s = vs_alloc(MOST, sizeof(double));
    f.r.value = vs_alloc(MOST, sizeof(double));
    const vs_observer observer = {&f, integrate};
    vs_trial *t = vs_trial_read("paper", TIERS[k], SETS);
    f.r.scene = &t->scene;
    vs_trial_go(t, &observer);
    EXPECT(!t->status && f.compared > 20, "%d: %s", f.compared, t->err.text);
    /* Runge's and Kutta's own error where the range is left: its slope of up to 6e4 m/s3 starts or
     * ends within a piece of 1e-6 s */
    EXPECT(f.worst < 90 * 1e-7, "%s: off by %g m/s2", TIERS[k], f.worst);
    EXPECT(f.r.meter.beyond > 100 && f.r.meter.beyond_s < 0.01, "beyond %ld times, from %g s",
           f.r.meter.beyond, f.r.meter.beyond_s);
    free_record(&f.r);
    vs_trial_free(t);
  }
}

/* ---- jumps, and ranges as narrow as rounding ---- */

/* What a first-order low-pass of rate w makes, from y, of amplitude sin(2 pi 50 t) between two
 * instants. */
static double along_sine(double y, double w, double amplitude, double from_s, double to_s) {
  const double om = 2 * M_PI * 50, ends[] = {from_s, to_s};
  double settled[2];
  for (int k = 0; k < 2; k++)
    settled[k] =
        amplitude * w * (w * sin(om * ends[k]) - om * cos(om * ends[k])) / (w * w + om * om);
  return settled[1] + (y - settled[0]) * exp(-w * (to_s - from_s));
}

/* The mains fall to 0 V where a step ends, and come back: closed form, to what 2^-24 of a step may
 * be off by, 1.5e-3 s 2^-24 w 300 V = 2e-6 V. */
static void a_jump_at_a_step(void) {
  static const char *const SETS[] = {
      "supply.voltage=230V",
      "firing={every: 1, angle: 120 deg}",
      "run.until=0.1s",
      "events={c: {kind: sag, at: 57.3 ms, duration: 20 ms, level: 0 %}}",
      "instruments={set: none, x: {channel: v_mains, range: [-900 V, 900 V], bits: none, rate: 100 "
      "kHz, bandwidth: 10 kHz}}",
      NULL};
  const double w = 2 * M_PI * 10e3, most = 230 * M_SQRT2, DOWN = 0.0573, UP = 0.0773;
  record r = sampled("switched", SETS);
  double worst = 0, fallen = along_sine(0, w, most, 0, DOWN), back = fallen * exp(-w * (UP - DOWN));
  for (int k = 0; k < r.count; k++) {
    double t = r.t_s[k], y = t < DOWN ? along_sine(0, w, most, 0, t)
                             : t < UP ? fallen * exp(-w * (t - DOWN))
                                      : along_sine(back, w, most, UP, t);
    worst = fmax(worst, fabs(r.value[k] - y));
  }
  EXPECT(r.count == 10001 && worst < 2e-6, "%d samples, off by %g V", r.count, worst);
  free_record(&r);
}

/* No halving of a step takes a channel's rounding away. This must end. */
static void a_range_of_rounding(void) {
  static const char *const SETS[] = {
      "firing={every: 1, angle: 110 deg}", "run.until=0.1s",
      "instruments={set: none, x: {channel: z, range: [6.5 mm, 6.50000001 mm], bandwidth: 100 Hz}}",
      NULL};
  record r = sampled("switched", SETS);
  EXPECT(r.count == 1001 && r.meter.beyond > 900, "%d samples, %ld beyond", r.count,
         r.meter.beyond);
  free_record(&r);
}

/* ---- the A/D ---- */

static void steps_of_the_converter(void) {
  const double range[] = {-3e-3, 3e-3};
  for (int bits = 1; bits <= 24; bits += 11) {
    long last = (1L << bits) - 1, by = bits > 12 ? 65537 : 1;
    double step = (range[1] - range[0]) / (double)(last + 1);
    for (long code = 0; code <= last; code += by) {
      double y = range[0] + step * (double)code;
      EXPECT(vs_meter_quantised(range, bits, y) == y, "code %ld of %d bits", code, bits);
      EXPECT(vs_meter_quantised(range, bits, y + 0.499 * step) == y, "code %ld and less", code);
      EXPECT(vs_meter_quantised(range, bits, y - 0.499 * step) == y, "code %ld and more", code);
    }
    EXPECT(vs_meter_quantised(range, bits, 1) == range[0] + step * (double)last, "above");
    EXPECT(vs_meter_quantised(range, bits, -1) == range[0], "below");
  }
  EXPECT(vs_meter_quantised(range, 12, 0) == 0 && vs_meter_quantised(range, 0, 0.1) == 0.1, "0");
}

/* The middle of two steps is the upper one's, and the next number below it the lower one's, also
 * where y - range[0] rounds that away. Ranges and middles are sums of powers of two, so that these
 * numbers are exact. */
static void middles_of_the_converter(void) {
  static const double RANGES[][2] = {{-3, 5}, {-1536, 2560}, {-24, -8}, {0, 8}};
  for (size_t r = 0; r < COUNT(RANGES); r++)
    for (int bits = 1; bits <= 32; bits++) {
      const double *range = RANGES[r], step = ldexp(range[1] - range[0], -bits);
      for (int n = 0; n < 64; n++) {
        double code = fmin(floor(ldexp(n, bits - 6)), ldexp(1, bits) - 2);
        double low = range[0] + step * code, middle = low + step / 2;
        EXPECT(vs_meter_quantised(range, bits, middle) == low + step,
               "%d bits: the middle above %g", bits, low);
        EXPECT(vs_meter_quantised(range, bits, nextafter(middle, -INFINITY)) == low,
               "%d bits: just below the middle above %g", bits, low);
      }
    }
}

static void samples_are_codes(void) {
  static const char *const SETS[] = {"instruments={}", "run.until=0.1s", NULL};
  record r = sampled("switched", SETS);
  const double *range = r.meter.range, step = (range[1] - range[0]) / 4096;
  EXPECT(r.count == 1001, "%d samples", r.count);
  for (int k = 0; k < r.count; k++) {
    double code = round((r.value[k] - range[0]) / step);
    EXPECT(r.value[k] == range[0] + code * step, "sample %d is no code", k);
  }
  free_record(&r);
}

/* ---- noise ---- */

/* What an instrument of that name shows at rest, as nothing fires: noise alone, in units of its
 * root mean square. */
static record at_rest(const char *name, int seed) {
  char section[256];
  const char *const sets[] = {section, "firing.first_cycle=1000", "run={until: 1 s, sample: 1 s}",
                              NULL};
  snprintf(section, sizeof section,
           "instruments={set: none, seed: %d, %s: {channel: p, range: [-1 m, 1 m], bits: none, "
           "noise: 2 um, rate: 100 kHz}}",
           seed, name);
  record r = sampled("switched", sets);
  for (int k = 0; k < r.count; k++) r.value[k] /= 2e-6;
  return r;
}

/* The mean of a(k) b(k + later). */
static double correlation(const record *a, const record *b, int later) {
  double sum = 0;
  for (int k = later; k < a->count; k++) sum += a->value[k] * b->value[k - later];
  return sum / (a->count - later);
}

/* All limits are four standard deviations. */
static void noise(void) {
  record r = at_rest("x", 5), seeded = at_rest("x", 6), named = at_rest("y", 5);
  double n = r.count, mean = 0, fourth = 0;
  for (int k = 0; k < r.count; k++) {
    mean += r.value[k] / n;
    fourth += gsl_pow_4(r.value[k]) / n;
  }
  EXPECT(n == 100001 && fabs(mean) < 4 / sqrt(n), "mean %g of %g", mean, n);
  double square = correlation(&r, &r, 0);
  EXPECT(fabs(square - 1) < 4 * sqrt(2 / n), "square %g", square);
  EXPECT(fabs(fourth - 3) < 4 * sqrt(96 / n), "fourth moment %g", fourth);
  for (int later = 1; later < 4; later++)
    EXPECT(fabs(correlation(&r, &r, later)) < 4 / sqrt(n), "correlated %d samples later", later);
  EXPECT(fabs(correlation(&r, &seeded, 0)) < 4 / sqrt(n), "correlated with another seed");
  EXPECT(fabs(correlation(&r, &named, 0)) < 4 / sqrt(n), "correlated with another instrument");
  free_record(&r);
  free_record(&seeded);
  free_record(&named);
}

/* ---- the same, whoever looks ---- */

/* The column of that name of a run.csv, only rows whose number is a multiple of `every`. */
static char *column(const char *path, const char *name, int every) {
  char *text = read_file(path), *rest = text, *line = strsep(&rest, "\n"), *cell;
  int which = 0, row = 0;
  vs_text cells = {0};
  vs_text_add(&cells, "%s", "");
  while ((cell = strsep(&line, ",")) && strcmp(cell, name)) which++;
  EXPECT(cell != NULL, "%s: no column %s", path, name);
  for (; cell && (line = strsep(&rest, "\n")) && *line; row++) {
    for (int k = 0; k <= which; k++) cell = strsep(&line, ",");
    if (row % every == 0) vs_text_add(&cells, "%s\n", cell);
  }
  free(text);
  return cells.text;
}

static void same_column(const char *one, int every, const char *other, const char *name,
                        bool wanted) {
  char *a = column(one, name, every), *b = column(other, name, 1);
  EXPECT(strlen(a) > 100 && !strcmp(a, b) == wanted, "%s: %s and %s %s", name, one, other,
         wanted ? "differ" : "are the same");
  free(a);
  free(b);
}

#define PAIR(first, second)                                                                        \
  "--set 'instruments={set: none, " first ", " second "}'"                                         \
  " --tier switched --set run.until=40ms --quiet "
#define P "p: {range: [-3 mm, 3 mm], bandwidth: 100 Hz, noise: 5 um}"
#define A "ap: {range: [-200 m/s2, 200 m/s2], bandwidth: 200 Hz, order: 2, noise: 1 m/s2}"

static void same_bytes(void) {
  RUN_GOOD("run paper " PAIR(P, A) "-o one");
  RUN_GOOD("run paper " PAIR(P, A) "-o again");
  RUN_GOOD("run paper " PAIR(A, P) "-o turned");
  RUN_GOOD("run paper " PAIR("seed: 2", P) "-o seeded");
  RUN_GOOD("run paper " PAIR(P, A) "-o coarse --set run.sample=0.7ms");
  RUN_GOOD("run paper " PAIR("q: {channel: p, range: [-3 mm, 3 mm], noise: 5 um}", P) "-o more");
  same_column("one/run.csv", 1, "again/run.csv", "ap_meas_m_s2", true);
  same_column("one/run.csv", 1, "turned/run.csv", "p_meas_m", true);
  same_column("one/run.csv", 1, "turned/run.csv", "ap_meas_m_s2", true);
  same_column("one/run.csv", 1, "more/run.csv", "p_meas_m", true);
  same_column("one/run.csv", 7, "coarse/run.csv", "p_meas_m", true);
  same_column("one/run.csv", 7, "coarse/run.csv", "ap_meas_m_s2", true);
  same_column("one/run.csv", 1, "seeded/run.csv", "p_meas_m", false);
  same_column("one/run.csv", 1, "seeded/run.csv", "p_m", true);
}

/* A copy made in the middle of a run goes on as the original does. */
typedef struct copied {
  const vs_scene *scene;
  vs_meter meter, copy;
} copied;

static vs_status go_on(void *ctx, const vs_step *step, vs_error *err) {
  copied *c = ctx;
  (void)err;
  if (!c->meter.instrument)
    vs_meter_begin(&c->meter, &c->scene->instruments.item[1], c->scene->instruments.v.seed);
  vs_meter_accept(&c->meter, step);
  if (step->to->t_s > 0.01 && !c->copy.instrument)
    c->copy = c->meter;
  else if (c->copy.instrument)
    vs_meter_accept(&c->copy, step);
  return VS_OK;
}

static void copies(void) {
  static const char *const SETS[] = {"instruments={}", "run.until=60ms", NULL};
  copied c = {.scene = NULL};
  const vs_observer observer = {&c, go_on};
  vs_trial *t = vs_trial_read("paper", "switched", SETS);
  c.scene = &t->scene;
  vs_trial_go(t, &observer);
  EXPECT(!t->status && c.meter.samples == 601, "%ld samples", c.meter.samples);
  EXPECT(c.meter.samples == c.copy.samples && c.meter.value == c.copy.value &&
             c.meter.lowpass.x[0] == c.copy.lowpass.x[0] &&
             !memcmp(c.meter.random, c.copy.random, sizeof c.copy.random),
         "a copy is another");
  EXPECT(!memcmp(c.meter.random, t->result.meters[1].random, sizeof c.meter.random) &&
             c.meter.value == t->result.meters[1].value,
         "the run's own meter is another");
  vs_trial_free(t);
}

/* ---- scenes ---- */

/* Every tier has them, and a probe of the deck asks for a deck. */
static void on_every_tier(void) {
  RUN_GOOD("run paper --tier analytic --set instruments={} --set run.until=30ms --quiet -o a");
  RUN_GOOD("run paper --tier circuit --set instruments={} --set run.until=30ms --quiet -o c");
  char *a = column("a/run.csv", "p_meas_m", 1), *c = column("c/run.csv", "p_meas_m", 1);
  EXPECT(count_lines(a) == 301 && count_lines(c) == 301, "%d, %d rows", count_lines(a),
         count_lines(c));
  free(a);
  free(c);
  ran r = run("run paper --set 'instruments={v_ak: {range: [-2 kV, 2 kV]}}' --set run.until=10ms "
              "-o v");
  char *v = column("v/run.csv", "v_ak_meas_v", 1);
  EXPECT(r.status == 0 && strstr(r.out, "circuit") && count_lines(v) == 101, "%s%s", r.out, r.err);
  free(v);
  free_ran(&r);
}

/* Without the key there is neither column nor line. */
static void without_the_key(void) {
  RUN_GOOD("run paper --tier switched --set run.until=30ms --quiet -o none");
  char *csv = read_file("none/run.csv"), *json = read_file("none/summary.json");
  EXPECT(!strstr(csv, "_meas") && !strstr(json, "instruments"), "an instrument by itself");
  free(csv);
  free(json);
}

/* A probe of the machine whose unit is not SI's: the column has that unit, and the range any. */
static void units_of_a_probe(void) {
  char *text = read_file(VS_TEST_FOLDER "/../spice/machines/fixed_base.yaml");
  vs_text machine = {0};
  vs_text_add(&machine, "%s\nprobes: {stroke: {of: p, unit: mm}}\n", text);
  vs_text_add(&machine, "instruments: {s: {channel: stroke, range: [-0.002 m, 2 mm], bits: 8}}\n");
  write_file("own.yaml", machine.text);
  RUN_GOOD("check own.yaml --quiet");
  RUN_GOOD("run fixed_base --set machine.model=own.yaml --set instruments={} --set run.until=50ms "
           "--tier switched --quiet -o own");
  char *shown = column("own/run.csv", "s_meas_mm", 1), *is = column("own/run.csv", "stroke_mm", 1);
  double worst = 0, most = 0;
  for (char *a = shown, *b = is; *a && *b;) {
    double x = strtod(a, &a), y = strtod(b, &b);
    worst = fmax(worst, fabs(x - y));
    most = fmax(most, fabs(x));
    a += *a == '\n', b += *b == '\n';
  }
  EXPECT(most > 0.5 && worst <= 4.0 / 256 / 2 * (1 + 1e-9), "off by %g mm of %g mm", worst, most);
  free(shown);
  free(is);
  free(text);
  vs_text_free(&machine);
}

static void what_is_warned_of(void) {
  ran r = run("run paper --tier switched --set run.until=60ms --set instruments.p.range=[-1mm,1mm] "
              "--set instruments.i=none --set instruments.v_eva.rate=20kHz -o w");
  EXPECT(r.status == 0 && strstr(r.err, "instruments.p: ") && strstr(r.err, "beyond its range") &&
             !strstr(r.err, "aliasing"),
         "%s", r.err);
  char *json = read_file("w/summary.json"), *csv = read_file("w/run.csv");
  EXPECT(strstr(json, "beyond its range") && !strstr(csv, "i_meas"), "%.200s", csv);
  free(json);
  free(csv);
  free_ran(&r);
  r = run("check paper --set instruments={}");
  EXPECT(r.status == 0 && strstr(r.err, "aliasing): i (150000 Hz, 5000 Hz), v_eva (10000 Hz"), "%s",
         r.err);
  free_ran(&r);
}

/* On an orbit an instrument begins as the orbit has it: after a period it shows the same again. A
 * 5 Hz low-pass would otherwise need half a second to come there. */
static void on_an_orbit(void) {
#define SLOW                                                                                       \
  "--set firing.every=1 --set supply.voltage=300V --digits 17 --quiet --set 'instruments={set: "   \
  "none, p: {range: [-3 mm, 3 mm], bandwidth: 5 Hz, bits: none}, ap: {range: [-99 m/s2, 99 "       \
  "m/s2], bandwidth: 8 Hz, order: 2, damping: 0.3, bits: none}}' "
  static const char *const NAMES[] = {"p_meas_m", "ap_meas_m_s2"};
  RUN_GOOD("steady paper " SLOW "-o period");
  ran r = run("run paper " SLOW "--tier switched --set start=steady --set run.until=0.1s -o five");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  free_ran(&r);
  for (size_t n = 0; n < COUNT(NAMES); n++) {
    char *one = column("period/run.csv", NAMES[n], 1), *five = column("five/run.csv", NAMES[n], 1);
    double first[201], most = 0, worst = 0;
    char *a = one, *b = five;
    for (int k = 0; k <= 1000; k++) {
      double x = k <= 200 ? (first[k] = strtod(a, &a)) : first[(k - 1) % 200 + 1];
      most = fmax(most, fabs(x));
      worst = fmax(worst, fabs(strtod(b, &b) - x));
    }
    /* what five periods differ by from five times one: rounding, and how well the orbit is met */
    EXPECT(worst < 1e-6 * most && fabs(first[200] - first[0]) < 1e-9 * most,
           "%s: off by %g of %g; over a period by %g", NAMES[n], worst, most,
           fabs(first[200] - first[0]));
    free(one);
    free(five);
  }
}

/* Keys of instruments are axes of studies; their runs keep the columns. */
static void in_a_study(void) {
  write_file("s.yaml", "set: {instruments.set: paper, run: {until: 20 ms, tier: switched}}\n"
                       "vary: {instruments.p.bandwidth: [20 Hz, 200 Hz], instruments.seed: [1, 2]}"
                       "\nreport: [p_max]\n");
  RUN_GOOD("study s.yaml -o s --keep runs --jobs 1 --quiet");
  same_column("s/runs/0/run.csv", 1, "s/runs/1/run.csv", "p_meas_m", false);
  same_column("s/runs/0/run.csv", 1, "s/runs/2/run.csv", "p_meas_m", false);
  same_column("s/runs/0/run.csv", 1, "s/runs/2/run.csv", "aw_meas_m_s2", true);
  write_file("none.yaml", "vary: {instruments.p.bandwidth: [20 Hz, 200 Hz]}\nreport: [p_max]\n");
  static const char *const SAYS[] = {"no section instruments", "set: {instruments.set: own}"};
  refuse("study none.yaml -o out", "no section", "none.yaml:1:8: ", SAYS, __LINE__);
}

static void pictures(void) {
  if (!on_path("gnuplot")) return;
  RUN_GOOD("run paper --tier switched --set run.until=0.12s --quiet -o r --set "
           "'instruments={trough: {channel: p, range: [-3 mm, 3 mm]}, a_meas: {channel: u, range: "
           "[-3 mm, 3 mm]}, as_measured: {channel: w, range: [-3 mm, 3 mm]}}'");
  RUN_GOOD("plot r --quiet");
  char *svg = read_file("r/measured_100ms.svg"), *other = read_file("r/motion_run.svg");
  EXPECT(strstr(svg, "instrument trough") && strstr(svg, "Fig. 14"), "no curve in measured_100ms");
  EXPECT(strstr(other, "instrument trough") != NULL, "no curve in motion_run");
  EXPECT(!strstr(other, "p_meas") && !strstr(other, "_meas /"), "an instrument is a coordinate");
  EXPECT(strstr(svg, "instrument a_meas") && strstr(svg, "instrument as_measured"),
         "names with _meas in them are lost");
  free(svg);
  free(other);
  RUN_GOOD("run paper --tier switched --set run.until=20ms --quiet -o few --set record=[i] --set "
           "'instruments={trough: {channel: p, range: [-3 mm, 3 mm]}}'");
  RUN_GOOD("plot few --quiet");
  EXPECT_FILES("few",
               "events.csv measured_100ms.png measured_100ms.svg measured_run.png "
               "measured_run.svg pulse_50ms.png pulse_50ms.svg report.html run.csv summary.json ");
  ran r = run("run paper --tier switched --set run.until=20ms -o r");
  EXPECT(r.status == 0 && strstr(r.err, "measured_run.png"), "%s", r.err);
  EXPECT_FILES("r", "events.csv run.csv summary.json ");
  free_ran(&r);
}

/* ---- bad input ---- */

static void bad_input(void) {
  static const struct {
    const char *line, *at, *says[2];
  } BAD[] = {
      {"instruments: p", "bad.yaml:1:14: ", {"a map is wanted", NULL}},
      {"instruments: [p, i]", "bad.yaml:1:15: ", {"a map is wanted", NULL}},
      {"instruments: {q: {range: [-1 m, 1 m]}}", "bad.yaml:1:15: ", {"no channel 'q'", NULL}},
      {"instruments: {x: {channel: apu, range: [0 m, 1 m]}}",
       "bad.yaml:1:28: ",
       {"no channel 'apu'", "did you mean 'ap'"}},
      {"run: {tier: switched}\ninstruments: {x: {channel: v_ak, range: [0 V, 1 V]}}",
       "bad.yaml:2:28: ",
       {"only where a deck is run", "circuit"}},
      {"instruments: {x: {channel: p}}", "bad.yaml:1:15: ", {"'range' is wanted", NULL}},
      {"instruments: {p: {range: [1 mm, 1 mm]}}", "bad.yaml:1:27: ", {"is empty", NULL}},
      {"instruments: {p: {range: [1 A, 2 A]}}", "bad.yaml:1:27: ", {"instruments.p.range", NULL}},
      {"instruments: {p: {bits: 0}}", "bad.yaml:1:25: ", {"out of range", "1..32"}},
      {"instruments: {p: {bits: 33}}", "bad.yaml:1:25: ", {"out of range", "1..32"}},
      {"instruments: {p: {rate: 0 Hz}}", "bad.yaml:1:25: ", {"instruments.p.rate", "out of range"}},
      {"instruments: {p: {rate: 900 MHz}}", "bad.yaml:1:25: ", {"samples", "at most"}},
      {"instruments: {p: {bandwidth: 0 Hz}}", "bad.yaml:1:30: ", {"out of range", NULL}},
      {"instruments: {p: {order: 3}}", "bad.yaml:1:26: ", {"out of range", NULL}},
      {"instruments: {ap: {damping: 0}}", "bad.yaml:1:29: ", {"out of range", NULL}},
      {"instruments: {p: {damping: 0.5}}", "bad.yaml:1:28: ", {"order 1 has none", NULL}},
      {"instruments: {set: none, p: {range: [0 m, 1 m], order: 2}}",
       "bad.yaml:1:56: ",
       {"p.order: without a bandwidth", NULL}},
      {"instruments: {set: damped.yaml}", "damped.yaml:1:64: ", {"order 1 has none", NULL}},
      {"instruments: {set: named.yaml}", "named.yaml:1:15: ", {"'seed' is a key", NULL}},
      {"instruments: {p: {noise: -1 um}}", "bad.yaml:1:26: ", {"out of range", NULL}},
      {"instruments: {p: {bandwith: 1 Hz}}", "bad.yaml:1:19: ", {"bandwith", "'bandwidth'"}},
      {"instruments: {p: 3}", "bad.yaml:1:18: ", {"a map of keys is wanted", "none"}},
      {"instruments: {set: papr}", "bad.yaml:1:20: ", {"set of instruments", "'paper'"}},
      {"instruments: {set: none}", "bad.yaml:1:15: ", {"there are none", NULL}},
      {"instruments: {set: not.yaml}", "not.yaml:1:1: ", {"a map instruments", NULL}},
      {"instruments: {seed: -1}", "bad.yaml:1:21: ", {"out of range", NULL}},
      {"instruments: {a-b: {channel: p, range: [0 m, 1 m]}}",
       "bad.yaml:1:15: ",
       {"is no name", NULL}},
      {"machine: {model: two_mass}\ninstruments: {}", "bad.yaml", {"there are none", NULL}},
      {"machine: {model: two_mass}\ninstruments: {set: paper}", "", {"no channel 'p'", NULL}},
      {"instruments: {}\nrecord: [p_meas]", "bad.yaml:2:10: ", {"by itself", NULL}},
  };
  write_file("not.yaml", "title: nothing\n");
  write_file("named.yaml", "instruments: {seed: {channel: p, range: [0 m, 1 m]}}\n");
  write_file("damped.yaml",
             "instruments: {p: {range: [0 m, 1 m], bandwidth: 1 Hz, damping: 0.4}}\n");
  for (size_t k = 0; k < COUNT(BAD); k++) {
    write_file("bad.yaml", BAD[k].line);
    refuse("run bad.yaml -o out", BAD[k].line, BAD[k].at, BAD[k].says, __LINE__);
  }
}

static const vs_test TESTS[] = {
    {"a step of the low-pass and its halves", steps_and_halves},
    {"the low-pass has its closed forms", closed_forms},
    {"magnitude and phase at ten frequencies", responses},
    {"3 dB at the bandwidth", bandwidths},
    {"a range that is left", beyond_the_range},
    {"a jump where a step ends", a_jump_at_a_step},
    {"a range as narrow as rounding", a_range_of_rounding},
    {"steps of the A/D, to the bit", steps_of_the_converter},
    {"the middle of two steps, to the bit", middles_of_the_converter},
    {"every sample is one of its codes", samples_are_codes},
    {"noise", noise},
    {"the same bytes, whoever looks", same_bytes},
    {"a copy goes on by itself", copies},
    {"on every tier", on_every_tier},
    {"nothing without the key", without_the_key},
    {"units of a machine's probe", units_of_a_probe},
    {"what is warned of", what_is_warned_of},
    {"on an orbit", on_an_orbit},
    {"keys of a study", in_a_study},
    {"pictures", pictures},
    {"bad input", bad_input},
};

int main(void) {
  return program_suite("instruments", TESTS, COUNT(TESTS));
}
