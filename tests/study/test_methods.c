/* SPDX-License-Identifier: GPL-3.0-or-later
 * The methods of a study that sample and search: their points, what they refuse, and what a search
 * finds of functions that stand in for cases. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "read_study.h"

/* ---- samples ---- */

#define TWO "spread: {actuator.inductance: 5 % normal, circuit.varistor_voltage: 10 % uniform}"

/* Of n points: standard errors are sd/sqrt(n) of a mean and sd/sqrt(2n) of a deviation for
 * independent points. Four of them are allowed, and to evenly laid ones a tenth of that. */
static void samples_have_their_spreads(void) {
  static const struct {
    const char *method;
    double part;
  } ROWS[] = {{"sobol", 0.1}, {"latin_hypercube", 0.1}, {"monte_carlo", 1}};
  enum { N = 4096 };
  for (size_t r = 0; r < COUNT(ROWS); r++) {
    char text[512];
    snprintf(text, sizeof text, "sample: {method: %s, n: %d, seed: 7, %s}\n", ROWS[r].method, N,
             TWO);
    study *s = good_study(text);
    int beyond = 0;
    double point[2], sum[2] = {0}, square[2] = {0}, both = 0;
    const double mean[] = {1.6, 910}, deviation[] = {0.08, 91 / sqrt(3)};
    CU_ASSERT_EQUAL(s->plan.count, N);
    CU_ASSERT_STRING_EQUAL(s->plan.axes[0].column, "actuator.inductance_h");
    for (uint64_t k = 0; k < N; k++) {
      vs_plan_point(&s->plan, k, point);
      beyond += fabs(point[1] - mean[1]) > 91;
      for (int d = 0; d < 2; d++) {
        sum[d] += (point[d] - mean[d]) / N;
        square[d] += pow(point[d] - mean[d], 2) / N;
      }
      both += (point[0] - mean[0]) * (point[1] - mean[1]) / N;
    }
    CU_ASSERT_EQUAL(beyond, 0);
    for (int d = 0; d < 2; d++) {
      CLOSE_OF(sum[d], 0, deviation[d], ROWS[r].part * 4 / 64);
      CLOSE(sqrt(square[d]), deviation[d], ROWS[r].part * 4 / 64 / sqrt(2));
    }
    CLOSE_OF(both / deviation[0] / deviation[1], 0, 1, 4.0 / 64);
    drop_study(s);
  }
}

/* A longer study begins as a shorter one of the same seed; another seed is another study. */
static void a_case_depends_on_seed_and_index(void) {
  const char *const METHODS[] = {"sobol", "monte_carlo"};
  for (size_t m = 0; m < COUNT(METHODS); m++) {
    const struct { int n, seed; } STUDIES[] = {{64, 7}, {1000, 7}, {64, 8}};
    double first[3][64][2];
    for (int k = 0; k < 3; k++) {
      char text[512];
      snprintf(text, sizeof text, "sample: {method: %s, n: %d, seed: %d, %s}\n", METHODS[m],
               STUDIES[k].n, STUDIES[k].seed, TWO);
      study *s = good_study(text);
      for (uint64_t i = 64; i-- > 0;) vs_plan_point(&s->plan, i, first[k][i]); /* backwards */
      drop_study(s);
    }
    CU_ASSERT(!memcmp(first[0], first[1], sizeof first[0]));
    CU_ASSERT(memcmp(first[0], first[2], sizeof first[0]));
  }
}

/* 100 mV about 1.2 V, cut at two of them; a range in the logarithm; a list; words. */
static void all_kinds_of_spread(void) {
  study *s = good_study("sample:\n"
                        "  method: latin_hypercube\n"
                        "  n: 600\n"
                        "  spread:\n"
                        "    circuit.on_voltage: 100 mV normal within 2 sigma\n"
                        "    circuit.c1: {log: [10 nF, 1 uF], n: 5}\n"
                        "    firing.angle: {from: 90 deg, to: 150 deg}\n"
                        "    firing.every: [1, 2, once]\n"
                        "    circuit.thyristor: [latch, thyristor_2t]\n"
                        "set: {circuit.deck: halfwave_paper, circuit.on_voltage: 1.2 V}\n");
  double point[5], logs = 0, most = 0;
  int every[3] = {0}, word[2] = {0}, below_120 = 0;
  for (uint64_t k = 0; k < 600; k++) {
    vs_plan_point(&s->plan, k, point);
    most = fmax(most, fabs(point[0] - 1.2));
    logs += log10(point[1] / 100) / 600;
    EXPECT(point[1] >= 10 && point[1] <= 1000, "%g nF", point[1]);
    below_120 += point[2] < 120;
    every[(int)point[3]]++;
    word[(int)point[4]]++;
  }
  EXPECT(most <= 0.2 && most > 0.19, "the cut is at 0.2 V, and the farthest is %g", most);
  CLOSE_OF(logs, 0, 1, 1e-3); /* the middle of its decades; a Latin hypercube's error is 2/600 of a
                                 part's 1/600 by 1/sqrt(12 600) */
  CU_ASSERT(below_120 == 300 && every[0] == 200 && every[1] == 200 && every[2] == 200 &&
            word[0] == 300 && word[1] == 300); /* parts of 600 that fit */
  drop_study(s);
}

static void corners_are_the_ends(void) {
  study *s = good_study("sample: {method: corners, sigmas: 2, spread: {actuator.inductance: 5 % "
                        "normal, actuator.resistance: 2 ohm uniform, firing.every: [1, 2, 3]}}\n");
  const double EXPECTED[][3] = {{1.6, 92, 0},  {1.44, 90, 1}, {1.76, 90, 1}, {1.44, 94, 1},
                                {1.76, 94, 1}, {1.44, 90, 2}, {1.76, 90, 2}, {1.44, 94, 2},
                                {1.76, 94, 2}, {1.44, 90, 3}, {1.76, 90, 3}, {1.44, 94, 3},
                                {1.76, 94, 3}};
  CU_ASSERT_EQUAL_FATAL(s->plan.count, COUNT(EXPECTED));
  for (uint64_t k = 0; k < COUNT(EXPECTED); k++) {
    double point[3];
    vs_plan_point(&s->plan, k, point);
    for (int d = 0; d < 3; d++) CLOSE_OF(point[d], EXPECTED[k][d], 1, 1e-12); /* rounding */
  }
  drop_study(s);
}

static void correlated_axes(void) {
  study *s = good_study("sample: {method: monte_carlo, n: 4096, spread: {circuit.r1: 10 % normal, "
                        "circuit.c1: 5 % normal, circuit.r2: 10 % uniform}, correlation: "
                        "[[circuit.c1, circuit.r1, -0.6]]}\n");
  double point[3], xx = 0, yy = 0, xy = 0;
  for (uint64_t k = 0; k < 4096; k++) {
    vs_plan_point(&s->plan, k, point);
    double x = point[0] / s->plan.axes[0].nominal - 1, y = point[1] / s->plan.axes[1].nominal - 1;
    xx += x * x, yy += y * y, xy += x * y;
  }
  CLOSE_OF(xy / sqrt(xx * yy), -0.6, 1, 4 * 0.64 / 64); /* four standard errors: (1 - rho^2)/64 */
  drop_study(s);
}

static void crossed_with_a_grid(void) {
  study *s = good_study("vary: {firing.angle: [90 deg, 100 deg, 110 deg]}\n"
                        "sample: {n: 8, spread: {actuator.inductance: 5 % normal}}\n");
  double a[2], b[2];
  CU_ASSERT_EQUAL_FATAL(s->plan.count, 24);
  vs_plan_point(&s->plan, 5, a);
  vs_plan_point(&s->plan, 21, b);
  CU_ASSERT(a[0] == 90 && b[0] == 110 && a[1] == b[1]); /* the same sample at every angle */
  drop_study(s);
}

/* ---- stand-ins for cases ---- */

/* What a search ran: points and values, as the program keeps them. */
typedef struct history {
  double *points, *values;
  int *status;
  uint64_t count;
  int generations;
} history;

/* Gives the value of that column; NaN: the case fails. */
typedef double fake(const vs_plan *plan, const double *point, const char *column);

static int column_of(const vs_plan *plan, const char *name) {
  for (size_t c = 0; c < plan->n_columns; c++)
    if (!strcmp(plan->columns[c].name, name)) return (int)c;
  return VS_COLUMN_MARGIN;
}

static void run_case(const vs_plan *plan, fake *f, history *r) {
  double *value = &r->values[r->count * (1 + plan->n_columns)];
  const double *point = &r->points[r->count * plan->n_axes];
  value[0] = f(plan, point, "margin_least");
  for (size_t c = 0; c < plan->n_columns; c++) value[c + 1] = f(plan, point, plan->columns[c].name);
  r->status[r->count++] = isnan(value[1]) ? 1 : 0;
}

/* Runs all a search asks for. */
static history pursue(const vs_plan *plan, fake *f) {
  const vs_plan_stage *stage = plan->adaptive;
  const size_t most = (size_t)plan->count;
  history r = {vs_alloc(most * plan->n_axes, sizeof(double)),
               vs_alloc(most * (1 + plan->n_columns), sizeof(double)), vs_alloc(most, sizeof(int)),
               0, 0};
  for (;; r.generations++) {
    vs_generation g = {.n_axes = plan->n_axes};
    vs_error err = {0};
    const vs_results results = {plan, r.count, r.points, r.values, r.status, NULL};
    CU_ASSERT_EQUAL(stage->method->next(plan, stage, &results, &g, &err), VS_OK);
    EXPECT(r.count + g.count <= most, "%llu cases, at most %zu were said",
           (unsigned long long)(r.count + g.count), most);
    if (!g.count || r.count + g.count > most) {
      free(g.points);
      return r;
    }
    memcpy(&r.points[r.count * plan->n_axes], g.points, g.count * plan->n_axes * sizeof(double));
    for (size_t k = 0; k < g.count; k++) run_case(plan, f, &r);
    free(g.points);
  }
}

static void forget(history *r) {
  free(r->points);
  free(r->values);
  free(r->status);
}

static vs_text manifest(const vs_plan *plan, const history *r) {
  vs_text text = {0};
  vs_json json = vs_json_inside(&text);
  const vs_results results = {plan, r->count, r->points, r->values, r->status, NULL};
  vs_json_same_row(&json);
  plan->adaptive->method->json(plan, plan->adaptive, &results, &json);
  return text;
}

/* ---- worst case ---- */

/* 5 at 137.5 degrees and 62.5 ohm, with the foot of the other hill 5.0282; 4.8 in a wider hill at
 * 100 degrees and 800 ohm; no value between. In the logarithm of the resistance, as the axis is. */
static double two_hills(const vs_plan *plan, const double *p, const char *column) {
  (void)plan;
  if (strcmp(column, "thyristor.v_reverse")) return 1;
  double a = (p[0] - 137.5) / 8, b = log(p[1] / 62.5) / 0.6, c = (p[0] - 100) / 20,
         d = log(p[1] / 800) / 2;
  if (p[0] > 118 && p[0] < 119) return NAN;
  return 5 * exp(-a * a - b * b) + 4.8 * exp(-c * c - d * d);
}

/* What it asks for depends on the results alone: with the first 50 of them, a part of a start of
 * 200, it asks for all of that; with none, the same. */
static void ask_again(const vs_plan *plan, const history *r) {
  for (uint64_t known = 0; known <= 50; known += 50) {
    vs_generation g = {.n_axes = plan->n_axes};
    vs_error err = {0};
    const vs_results results = {plan, known, r->points, r->values, r->status, NULL};
    plan->adaptive->method->next(plan, plan->adaptive, &results, &g, &err);
    EXPECT(g.count == 200 && !memcmp(g.points, r->points, 200 * plan->n_axes * sizeof *g.points),
           "%zu points", g.count);
    free(g.points);
  }
}

#define HILLS                                                                                      \
  "vary: {firing.angle: {from: 90 deg, to: 150 deg}, circuit.r1: {log: [10 ohm, 10 kohm], n: "     \
  "4}}\n"

static void the_worst_case_is_found(void) {
  int found = 0;
  for (int seed = 0; seed < 10; seed++) {
    char text[512];
    snprintf(text, sizeof text,
             HILLS "find: {worst: max thyristor.v_reverse, n: 400, seed: %d, finest: 1e-4}\n",
             seed);
    study *s = good_study(text);
    CU_ASSERT_EQUAL(s->plan.count, 400);
    history r = pursue(&s->plan, two_hills);
    double most = 0, at[2] = {0};
    int column = column_of(&s->plan, "thyristor.v_reverse");
    for (uint64_t k = 0; k < r.count; k++) {
      double v = r.values[k * (1 + s->plan.n_columns) + (size_t)column + 1];
      if (v > most) most = v, memcpy(at, &r.points[2 * k], sizeof at);
    }
    if (at[0] > 120) { /* the higher hill; the foot of the other lifts and shifts it a little */
      found++;
      CLOSE(most, 5.02821, 2e-3); /* steps of 1e-4 of an axis; 400 cases may end before them */
      CLOSE_OF(at[0], 137.5, 60, 5e-3);
      CLOSE_OF(log(at[1] / 62.5), 0, log(1000), 5e-3);
    } else
      CLOSE(most, 4.8, 1e-2);
    ask_again(&s->plan, &r);
    vs_text json = manifest(&s->plan, &r);
    EXPECT(strstr(json.text, "\"phase\": \"restarts\"") &&
               strstr(json.text, "\"restarts\": 8, \"found\"") &&
               strstr(json.text, "this is no bound") && strstr(json.text, "\"found\": {\"case\": "),
           "%s", json.text);
    vs_text_free(&json);
    forget(&r);
    drop_study(s);
  }
  EXPECT(found >= 9, "the higher hill was found %d times of 10", found);
}

/* Stands for a surge that fires a thyristor only between the sub-pulses of its gate, whose period
 * is 3.6 degrees: in each it rises towards a jump, whose place drifts, and a wide hill lies over
 * all. */
static double comb(const vs_plan *plan, const double *p, const char *column) {
  const double turns = p[0] / 3.6 - 0.004 * p[0], in = turns - floor(turns);
  (void)plan, (void)column;
  return (200 - 0.02 * pow(p[0] - 163, 2)) * (in < 0.3 ? 0.5 : 0.6 + 0.4 * in);
}

/* The study itself says no period: the scene's gate drive does. The manifest tells how many
 * restarts agree. 1 % of what a fine grid has. */
static void a_comb_is_searched_by_its_period(void) {
  double most = 0;
  int found = 0;
  for (double deg = 100; deg <= 260; deg += 1e-4) most = fmax(most, comb(NULL, &deg, NULL));
  for (int seed = 0; seed < 10; seed++) {
    char text[512];
    snprintf(text, sizeof text,
             "set: {circuit.deck: halfwave_paper, events: {e: {kind: surge, cycle: 1}}}\n"
             "vary: {events.e.angle: {from: 100 deg, to: 260 deg}}\n"
             "find: {worst: max thyristor.di_dt, n: 400, restarts: 8, seed: %d}\n",
             seed);
    study *s = good_study(text);
    history r = pursue(&s->plan, comb);
    const char *const KEYS[] = {"\"n\": 400, \"restarts\": ", "\"agree_place\": ",
                                "\"agree_value\": ", "\"agree_within\": 0.01"};
    vs_text json = manifest(&s->plan, &r);
    double value = NAN;
    const char *at = strstr(json.text, "\"value\": ");
    if (at) sscanf(at, "\"value\": %lf", &value);
    found += value >= 0.99 * most;
    for (size_t k = 0; k < COUNT(KEYS); k++) EXPECT(strstr(json.text, KEYS[k]), "%s", json.text);
    vs_text_free(&json);
    forget(&r);
    drop_study(s);
  }
  EXPECT(found == 10, "found by %d of 10", found);
}

/* Of words and levels each combination gets as many cases of the start as any other: 8 of 200. */
static double level(const vs_plan *plan, const double *p, const char *column) {
  (void)plan, (void)column;
  return p[0] + 10 * p[1] + p[2];
}

static void combinations_are_strata(void) {
  study *s =
      good_study("set: {circuit.deck: halfwave_paper, events: {e: {kind: surge, cycle: 1}}}\n"
                 "vary:\n"
                 "  events.e.angle: {from: 0 deg, to: 360 deg}\n"
                 "  events.e.polarity: [\"+\", \"-\"]\n"
                 "  events.e.level: [0.5 kV, 1 kV, 2 kV, 4 kV]\n"
                 "find: {worst: max i_peak, n: 400}\n");
  history r = pursue(&s->plan, level);
  int times[2][5] = {{0}};
  CU_ASSERT_FATAL(r.count >= 200);
  for (uint64_t k = 0; k < 200; k++) times[(int)r.points[3 * k + 1]][(int)r.points[3 * k + 2]]++;
  for (int word = 0; word < 2; word++)
    for (int kv = 1; kv <= 4; kv++)
      EXPECT(kv == 3 || abs(times[word][kv] - 200 / 8) <= 1, "%d %d: %d", word, kv,
             times[word][kv]);
  forget(&r);
  drop_study(s);
}

/* The least one of words and whole numbers: what a list lists, and no more. */
static double words(const vs_plan *plan, const double *p, const char *column) {
  (void)column;
  return fabs(p[0] - 7) + (strcmp(plan->axes[1].word[(size_t)p[1]], "latch") ? 0 : 10);
}

static void lists_are_searched_too(void) {
  study *s = good_study("set: {circuit.deck: halfwave_paper}\n"
                        "vary: {firing.every: [1, 2, 3, 5, 7, 9], circuit.thyristor: [latch, "
                        "TYN1212]}\n"
                        "find: {worst: min p_max, n: 60}\n");
  history r = pursue(&s->plan, words);
  double least = INFINITY;
  for (uint64_t k = 0; k < r.count; k++)
    least = fmin(least, r.values[k * (1 + s->plan.n_columns) + 1]);
  CU_ASSERT(least == 0);
  forget(&r);
  drop_study(s);
}

/* ---- snubber ---- */

/* v = 500 + 30000/c + r/10 V, nF and ohm, more by 0.7 of what the voltage of the varistor is less:
 * 1200 V with a margin of 20 % are 960 V. di/dt = 30000/r A/us, at most 80. r1's loss in W: c*3e-3;
 * at most 0.5*0.8, so c <= 133 nF. c1.v_peak = 800 V. Cost: c*1e-9*800^2/2 + 3e-3*c/50 J, which
 * rises with c alone. So r = 375 ohm, and c = 30000/(960 - 500 - 37.5 - spread). */
static double snubbed(const vs_plan *plan, const double *p, const char *column) {
  const bool tolerant = plan->n_axes > 2 && plan->axes[2].about == 2; /* C1 with its tolerance */
  const double r = p[0], c = tolerant ? p[2] : p[1],
               more = plan->n_axes > 2 && !tolerant ? 0.7 * (910 - p[2]) : 0;
  if (!strcmp(column, "thyristor.v_reverse")) return 500 + 30000 / c + r / 10 + more;
  if (!strcmp(column, "thyristor.di_dt")) return 30000 / r;
  if (!strcmp(column, "r1.power")) return 3e-3 * c;
  if (!strcmp(column, "c1.v_peak")) return 800;
  if (!strcmp(column, "thyristor.t_off")) return 1e-6 * (20 + c);
  return 0.1;
}

#define SNUBBER                                                                                    \
  "vary: {circuit.r1: {log: [100 ohm, 10 kohm]}, circuit.c1: {log: [10 nF, 1 uF]}}\n"              \
  "snubber: {ratings: {thyristor.v_reverse: 1.2 kV, thyristor.di_dt: 100 A/us, r1.power: 0.5 W}, " \
  "n: 300, finest: 1e-4}\n"

/* Cases of the manifest's best candidate, and its energy. */
static double found_snubber(const vs_plan *plan, const history *r, double point[2]) {
  vs_text json = manifest(plan, r);
  const char *at = strstr(json.text, "\"found\": {\"case\": ");
  unsigned long long index = 0;
  double cost_j = NAN;
  EXPECT(at && sscanf(at, "\"found\": {\"case\": %llu, \"cost_j\": %lf", &index, &cost_j) == 2,
         "%s", json.text);
  memcpy(point, &r->points[index * plan->n_axes], 2 * sizeof *point);
  vs_text_free(&json);
  return cost_j;
}

/* most: how many times what was chosen C1 may be. */
static void check_tolerant(const char *text, double c_nf, double most) {
  study *s = good_study(text);
  history r = pursue(&s->plan, snubbed);
  double point[2], cost_j = found_snubber(&s->plan, &r, point);
  /* Within 3 % of the cheapest there is, of which 300 candidates may fall short; never cheaper. */
  double least_j = c_nf * 1e-9 * 800 * 800 / 2 + 3e-3 * c_nf * most / 50;
  EXPECT(cost_j >= least_j * (1 - 1e-9) && cost_j < 1.03 * least_j,
         "%g J at %g ohm, %g nF; the least is %g J", cost_j, point[0], point[1], least_j);
  EXPECT(point[0] >= 375 * (1 - 1e-9), "%g ohm let more than 80 A/us through", point[0]);
  forget(&r);
  drop_study(s);
}

static void check_snubber(const char *text, double c_nf) {
  check_tolerant(text, c_nf, 1);
}

static void the_cheapest_snubber_is_found(void) {
  check_snubber(SNUBBER, 30000 / (960 - 500 - 37.5));
}

/* A rating of which more is better, 100 us: 120 us with the margin, which 100 nF give. */
static void a_least_allowed(void) {
  check_snubber("vary: {circuit.r1: {log: [100 ohm, 10 kohm]}, circuit.c1: {log: [10 nF, 1 uF]}}\n"
                "snubber: {ratings: {thyristor.v_reverse: 1.2 kV, thyristor.di_dt: 100 A/us, "
                "r1.power: 0.5 W, thyristor.t_off: 100 us}, n: 300, finest: 1e-4}\n",
                100);
}

static double unknown_below(const vs_plan *plan, const double *p, const char *column) {
  return !strcmp(column, "thyristor.t_off") && p[1] < 100 ? NAN : snubbed(plan, p, column);
}

/* A rating whose measure is not known is not held: below 100 nF none is. */
static void an_unknown_rating_is_not_held(void) {
  study *s =
      good_study("vary: {circuit.r1: {log: [100 ohm, 10 kohm]}, circuit.c1: {log: [10 nF, 1 uF]}}\n"
                 "snubber: {ratings: {thyristor.v_reverse: 1.2 kV, thyristor.di_dt: 100 A/us, "
                 "r1.power: 0.5 W, thyristor.t_off: 10 us}, n: 300, finest: 1e-4}\n");
  history r = pursue(&s->plan, unknown_below);
  double point[2];
  found_snubber(&s->plan, &r, point);
  EXPECT(point[1] >= 100 && point[1] < 133.4, "%g nF", point[1]);
  forget(&r);
  drop_study(s);
}

/* Its 10 % downwards are 91 V, 63.7 V of the thyristor's; that corner is not the last one. */
static void over_its_spread(void) {
  check_snubber(SNUBBER "sample: {method: corners, spread: {circuit.varistor_voltage: 10 % "
                        "uniform}}\n",
                30000 / (960 - 500 - 37.5 - 63.7));
}

/* C1 may be 10 % less than what was chosen, whatever was chosen, and has to hold the voltage then.
 * Where it is 10 % more R1 burns more. */
static void over_its_own_tolerance(void) {
  check_tolerant(SNUBBER "sample: {method: corners, spread: {circuit.c1: 10 % uniform}}\n",
                 30000 / (960 - 500 - 37.5) / 0.9, 1.1);
  study *s = good_study(SNUBBER "sample: {method: corners, spread: {circuit.c1: 10 % uniform}}\n");
  CU_ASSERT_STRING_EQUAL(s->plan.axes[1].column, "circuit.c1_nf");
  CU_ASSERT_STRING_EQUAL(s->plan.axes[2].column, "circuit.c1_spread_nf");
  history r = pursue(&s->plan, snubbed);
  for (uint64_t k = 0; k < r.count; k++) {
    const double *p = &r.points[3 * k], off = p[2] / p[1] - 1;
    EXPECT(fabs(off) < 1e-9 || fabs(fabs(off) - 0.1) < 1e-9, "%g of %g nF", p[2], p[1]);
  }
  forget(&r);
  drop_study(s);
}

/* Only what holds as it is costs runs over the spread. */
static void spreads_are_run_for_what_holds(void) {
  study *s = good_study(SNUBBER "sample: {method: corners, spread: {circuit.varistor_voltage: 10 % "
                                "uniform}}\n");
  history r = pursue(&s->plan, snubbed);
  uint64_t off = 0, nominal = 0;
  for (uint64_t k = 0; k < r.count; k++) {
    const double *p = &r.points[3 * k];
    bool nominal_run = p[2] == 910;
    nominal += nominal_run;
    bool good = snubbed(&s->plan, (double[]){p[0], p[1], 910}, "thyristor.v_reverse") <= 960 &&
                p[0] >= 375 && p[1] <= 0.4 / 3e-3;
    off += !nominal_run && !good;
  }
  EXPECT(!off, "%llu runs over the spread of what does not hold", (unsigned long long)off);
  EXPECT(nominal < r.count, "no run over the spread");
  forget(&r);
  drop_study(s);
}

static double nothing_holds(const vs_plan *plan, const double *p, const char *column) {
  return strcmp(column, "thyristor.v_reverse") ? snubbed(plan, p, column) : 2000 + p[0] / 100;
}

/* It says so, and has gone where it is over by least: 100 ohm. */
static void no_snubber_holds(void) {
  study *s = good_study(SNUBBER);
  history r = pursue(&s->plan, nothing_holds);
  vs_text json = manifest(&s->plan, &r);
  EXPECT(strstr(json.text, "\"found\": null"), "%s", json.text);
  vs_text_free(&json);
  forget(&r);
  drop_study(s);
}

/* ---- what is refused ---- */

static void refused(void) {
  static const struct {
    const char *text, *says;
  } ROWS[] = {
      {"sample: {method: sobel, spread: {actuator.gap: 1 % normal}}",
       "study.yaml:1:18: sample: no method 'sobel'; there are: sobol, lhs, monte_carlo, corners"},
      {SNUBBER "sample: {method: corners, spread: {circuit.c1: 5 nF uniform}}",
       "a tolerance of what that has is wanted here, in %, as '5 % uniform'"},
      {"vary: {circuit.c1: [1 nF]}\nsample: {spread: {circuit.c1: 5 % uniform}}",
       "circuit.c1 is an axis already, under vary"},
      {"sample: {n: 8}", "sample.spread: a map is wanted"},
      {"sample: {n: 0, spread: {actuator.gap: 1 % normal}}",
       "study.yaml:1:13: n: a whole number from 1"},
      {"sample: {spread: {actuator.gab: 1 % normal}}", "did you mean 'actuator.gap'?"},
      {"sample: {spread: {actuator.gap: 1 % norml}}",
       "study.yaml:1:33: actuator.gap: '1 % norml' is no spread; write '5 % normal'"},
      {"sample: {spread: {actuator.gap: 1 normal}}",
       "1 has no unit; write for example '1 m' or '1 mm'"},
      {"sample: {spread: {actuator.gap: 1 ohm normal}}", "has the wrong unit; write mm"},
      {"sample: {spread: {actuator.gap: 0 % normal}}", "a spread is more than 0"},
      {"sample: {spread: {actuator.gap: 5 % uniform within 2 sigma}}", "is no spread"},
      {"sample: {spread: {actuator.gap: 5 % normal within 0 sigma}}", "is no spread"},
      {"sample: {spread: {actuator.gap: 40 % normal}}",
       "'40 % normal' about 6 mm goes from -1.2 to 13.2; allowed: 0..1000 mm"},
      {"sample: {spread: {load.density: 5 % normal}}",
       "it is 0 in the scene, and any per cent of that are 0"},
      {"sample: {spread: {firing.first_cycle: 5 % normal}}", "it has no values in between"},
      {"sample: {spread: {machine.m14: 5 % normal}}", "it has no values in between"},
      {"sample: {method: corners, n: 4, spread: {actuator.gap: 1 % normal}}",
       "study.yaml:1:27: sample.n: there are as many corners as there are"},
      {"sample: {spread: {circuit.r1: 1 % normal, circuit.c1: 1 % normal}, correlation: "
       "[[circuit.r1, circuit.c2, 0.5]]}",
       "sample.correlation: 'circuit.c2' is not under spread"},
      {"sample: {spread: {circuit.r1: 1 % normal, circuit.c1: 1 % normal}, correlation: "
       "[[circuit.r1, circuit.c1, 1]]}",
       "between -1 and 1"},
      {"sample: {spread: {circuit.r1: 1 % normal, circuit.c1: 1 % normal, circuit.r2: 1 % normal}, "
       "correlation: [[circuit.r1, circuit.c1, 0.9], [circuit.r1, circuit.r2, 0.9], [circuit.r2, "
       "circuit.c1, -0.9]]}",
       "not positive definite"},
      {"find: {worst: max p_max}", "find: nowhere to look"},
      {HILLS "find: {worst: thyristor.v_reverse}",
       "study.yaml:2:15: find.worst: 'max MEASURE' or 'min MEASURE' is wanted"},
      {HILLS "find: {worst: max thyristor.v_revers}", "did you mean 'thyristor.v_reverse'?"},
      {HILLS "find: {worst: max p_max, restarts: 0}", "restarts: a whole number from 1 to 1000"},
      {HILLS "find: {worst: max p_max, finest: 2}", "find.finest: a part of each axis"},
      {"snubber: {ratings: {thyristor.v_reverse: 1 kV}}", "snubber: vary is wanted"},
      {"vary: {firing.angle: [90 deg]}\nsnubber: {ratings: {thyristor.v_reverse: 1 kV}}",
       "study.yaml:1:8: snubber: vary holds its resistors and capacitors"},
      {"vary: {circuit.r1: {from: 1 ohm, to: 2 ohm}}\nsnubber: {}", "snubber.ratings: a map"},
      {"vary: {circuit.r1: {from: 1 ohm, to: 2 ohm}}\nsnubber: {ratings: {r1.power: part}}",
       "study.yaml:2:31: snubber.ratings: no part's file has a limit for r1.power; write one, in "
       "W"},
      {"vary: {circuit.r1: {from: 1 ohm, to: 2 ohm}}\nsnubber: {ratings: {r1.power: 2 V}}",
       "snubber.ratings: r1.power: '2 V' has the wrong unit; write W"},
      {"vary: {circuit.r1: {from: 1 ohm, to: 2 ohm}}\nsnubber: {ratings: {r1.power: 2 W}, margin: "
       "1}",
       "snubber.margin: 0 or more and less than 100 %"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    study *s = read_study(ROWS[k].text);
    EXPECT(s->status == VS_INPUT && strstr(s->err.text, ROWS[k].says),
           "%s\n    says: %s\n    wanted: %s", ROWS[k].text, s->err.text, ROWS[k].says);
    drop_study(s);
  }
}

/* ---- with the program ---- */

/* The bytes of a study's results, all in one; free() it. */
static char *results_of(const char *folder) {
  static const char *const FILES[] = {"study.csv", "failures.csv", "manifest.json"};
  vs_text all = {0};
  for (size_t k = 0; k < COUNT(FILES); k++) {
    char path[64];
    snprintf(path, sizeof path, "%s/%s", folder, FILES[k]);
    char *text = read_file(path);
    EXPECT(*text, "%s is not there", path);
    vs_text_add(&all, "%s", text);
    free(text);
  }
  return all.text;
}

/* An event at the end of the range begins behind the run's end: the worst of it was not looked at,
 * which the study says once. Its own errors are not asked for, which it says, too. */
static void a_search_tells_what_was_not_built(void) {
  static const char TEXT[] = "set: {run: {until: 30 ms, tier: compiled%s}, events: {dip: {kind: "
                             "sag, at: 10 ms, duration: 5 ms}}}\n"
                             "vary: {events.dip.at: {from: 10 ms, to: %d ms}}\n"
                             "find: {worst: max i_peak, n: 4, restarts: 1}\n";
  static const char LACKS[] = "its row may lack the error of the margin";
  for (int late = 0; late < 2; late++) {
    char text[512];
    snprintf(text, sizeof text, TEXT, late ? ", verify: always" : "", late ? 40 : 20);
    write_file("s.yaml", text);
    ran r = run("study s.yaml --jobs 1 --overwrite -o late");
    EXPECT(late == (strstr(r.err, " of 4 cases ran without something of their scene, as case ") &&
                    strstr(r.err, ": events.dip: it would begin at ") &&
                    strstr(r.err, " is the one without it (column warnings)\n")),
           "%s", r.err);
    EXPECT(late == !strstr(r.out, LACKS), "%s", r.out);
    free_ran(&r);
  }
  remove_tree("late");
}

/* A current rated at what it is in the first case: its margin is less than its error. At the second
 * angle it is larger, at the third smaller. */
static void violated_and_undecided_are_told_apart(void) {
  static const char TEXT[] =
      "set: {run: {until: 15 ms, tier: compiled, verify: always}, ratings: {i_peak: .. %.12g A}}\n"
      "vary: {firing.angle: [100 deg, 90 deg, 110 deg]}\n"
      "report: [i_peak]\n";
  double peak_a = 10;
  for (int rated = 0; rated < 2; rated++) {
    char text[512];
    snprintf(text, sizeof text, TEXT, peak_a);
    write_file("s.yaml", text);
    ran r = run("study s.yaml --quiet --jobs 1 --overwrite -o rated");
    CU_ASSERT_EQUAL(r.status, rated ? VS_RATING : VS_OK);
    EXPECT(!rated || strstr(r.err, ": a rating is violated in 1, undecided in 1 of 3 cases\n"),
           "%s", r.err);
    free_ran(&r);
    char *rows = read_file("rated/study.csv"), *first = strchr(rows, '\n');
    EXPECT(first && sscanf(first, "\n0,%*[^,],100,%lf,", &peak_a) == 1, "%s", rows);
    free(rows);
  }
  remove_tree("rated");
}

/* One process or two, at once or in two goes: the same bytes. The largest force is where it fires
 * earliest, at the most voltage, with the least inductance, as Eq. 91 has it. */
static void a_search_does_not_depend_on_who_runs_it(void) {
  write_file("s.yaml",
             "set: {run.until: 20 ms, run.tier: switched}\n"
             "vary: {firing.angle: {from: 95 deg, to: 150 deg}, supply.voltage: {from: 400 "
             "V, to: 480 V}}\n"
             "sample: {spread: {actuator.inductance: 5 % normal}}\n"
             "find: {worst: max force_peak, n: 150, seed: 3}\nreport: [i_peak]\n");
  EXPECT_EXIT("study s.yaml --quiet --jobs 1 -o one", 0);
  ran two_workers = run("study s.yaml --jobs 2 -o two");
  EXPECT(strstr(two_workers.out, "\nfound  the worst found in ") &&
             strstr(two_workers.out, " cases is force_peak ") &&
             strstr(two_workers.out, " restarts ") &&
             !strstr(two_workers.out, "error of the margin") &&
             strstr(two_workers.out, "this is no bound\n"),
         "%s", two_workers.out);
  free_ran(&two_workers);
  EXPECT_EXIT("study s.yaml --quiet --jobs 1 -o broken", 0);
  CU_ASSERT_EQUAL(remove("broken/manifest.json"), 0);
  char *journal = read_file("broken/journal");
  write_file("broken/journal", (journal[strlen(journal) * 2 / 3] = '\0', journal));
  free(journal);
  EXPECT_EXIT("study s.yaml --quiet --resume --jobs 2 -o broken", 0);
  char *one = results_of("one"), *two = results_of("two"), *broken = results_of("broken");
  CU_ASSERT_STRING_EQUAL(one, two);
  CU_ASSERT_STRING_EQUAL(one, broken);
  unsigned long long index = 0;
  const char *at = strstr(one, "\"found\": {\"case\": ");
  EXPECT(at && sscanf(at, "\"found\": {\"case\": %llu", &index) == 1, "%s", one);
  char row[64];
  double angle, voltage, inductance;
  snprintf(row, sizeof row, "\n%llu,", index);
  at = strstr(one, row);
  EXPECT(at && sscanf(at + strlen(row), "%*[^,],%lf,%lf,%lf", &angle, &voltage, &inductance) == 3,
         "%s", one);
  CLOSE_OF(angle, 95, 55, 2e-3); /* two steps of the finest, 0.1 % of each axis */
  CLOSE_OF(voltage, 480, 80, 2e-3);
  CLOSE_OF(inductance, 1.6 - 3 * 0.08, 6 * 0.08, 2e-3);
  free(one), free(two), free(broken);
}

/* --set reaches what the study says of itself; a shorter sample is the beginning of a longer one.
 */
static void n_from_the_command_line(void) {
  write_file("s.yaml", "set: {run.until: 20 ms, run.tier: switched}\n"
                       "sample: {n: 32, seed: 3, spread: {actuator.inductance: 5 % normal}}\n"
                       "report: [i_peak]\n");
  EXPECT_EXIT("study s.yaml --quiet -o all", 0);
  EXPECT_EXIT("study s.yaml --quiet --set sample.n=8 -o some", 0);
  char *all = read_file("all/study.csv"), *some = read_file("some/study.csv");
  CU_ASSERT_EQUAL(count_lines(all), 33);
  CU_ASSERT_EQUAL(count_lines(some), 9);
  EXPECT(!strncmp(all, some, strlen(some)), "%s\n%s", all, some);
  free(all), free(some);
  /* the manifest is YAML too, which takes no key twice */
  vs_tree tree;
  vs_error err = {0};
  EXPECT(!vs_tree_read("some/manifest.json", &tree, &err), "%s", err.text);
  const vs_node *axes = vs_tree_child(tree.root, "axes");
  const vs_node *spread = axes ? vs_tree_child(axes->child, "spread") : NULL;
  const vs_node *sigma = vs_tree_child(spread, "sigma");
  EXPECT(sigma && !strcmp(sigma->text, "0.08"), "sigma is %s", sigma ? sigma->text : "not there");
  vs_tree_free(&tree);
}

static void shipped_studies_are_good(void) {
  static const char *const NAMES[] = {"surge_worst",  "surge_at_work",          "yield",
                                      "amplitude",    "false_firing",           "snubber",
                                      "snubber_map",  "control_characteristic", "resonance",
                                      "design_paper", "design_triac",           "suppression"};
  for (size_t k = 0; k < COUNT(NAMES); k++) {
    ran r = run("check %s", NAMES[k]);
    EXPECT(!r.status && strstr(r.out, "a good study"), "%s: %s%s", NAMES[k], r.out, r.err);
    free_ran(&r);
  }
}

static const vs_test TESTS[] = {
    {"samples have the spreads asked for", samples_have_their_spreads},
    {"a case depends on seed and index alone", a_case_depends_on_seed_and_index},
    {"normal, cut, range, list and words", all_kinds_of_spread},
    {"corners: as it is, then all ends", corners_are_the_ends},
    {"correlated axes", correlated_axes},
    {"the same samples at each point of a grid", crossed_with_a_grid},
    {"the worst case: two hills and a gap", the_worst_case_is_found},
    {"the worst case: a comb", a_comb_is_searched_by_its_period},
    {"the worst case: combinations", combinations_are_strata},
    {"the worst case: lists", lists_are_searched_too},
    {"the cheapest snubber", the_cheapest_snubber_is_found},
    {"a rating that is the least allowed", a_least_allowed},
    {"an unknown rating is not held", an_unknown_rating_is_not_held},
    {"the cheapest snubber over a spread", over_its_spread},
    {"over its own tolerance", over_its_own_tolerance},
    {"only what holds is run over the spread", spreads_are_run_for_what_holds},
    {"no snubber holds", no_snubber_holds},
    {"what is refused", refused},
    {"violated and undecided are told apart", violated_and_undecided_are_told_apart},
    {"the worst case: what was not built", a_search_tells_what_was_not_built},
    {"a search: one process, two, and in two goes", a_search_does_not_depend_on_who_runs_it},
    {"--set sample.n", n_from_the_command_line},
    {"shipped studies are good ones", shipped_studies_are_good},
};
int main(void) {
  return program_suite("methods", TESTS, COUNT(TESTS));
}
