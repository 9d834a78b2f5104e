/* SPDX-License-Identifier: GPL-3.0-or-later
 * Fits of what instruments show: the prediction goes through the same range and low-pass, so that
 * the truth is found, and the 95 % intervals hold it as often as they say. With VS_LONG=1 the last
 * is tried with 500 seeds, which takes a quarter of an hour and writes fit_intervals.csv. Besides:
 * records of others' making, and measures of an orbit. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "fit/fit_result.h"
#include "program.h"

/* ---- fits ---- */

/* Fits what stands in f.yaml, with so many --set. */
static vs_fit_result *fit_with(char *const *sets, size_t n, vs_fit_problem *q) {
  vs_fit_result *o = vs_alloc(1, sizeof *o);
  vs_error err = {0};
  vs_status status = vs_fit_problem_read("f.yaml", sets, n, NULL, q, &err);
  if (!status) status = vs_fit_result_of(q, o, &err);
  EXPECT(!status, "%s", err.text);
  if (status) *o = (vs_fit_result){.estimate.n = 0, .inquiry = q};
  return o;
}

static void end_fit(vs_fit_result *o, vs_fit_problem *q) {
  vs_fit_result_free(o);
  vs_fit_problem_free(q);
  free(o);
  free(q);
}

/* Fits f.yaml and holds what is found against these, in the order of the unknowns. */
static void expect_found(const char *fit, const double *truth, size_t n, double tolerance) {
  vs_fit_problem *q = vs_alloc(1, sizeof *q);
  write_file("f.yaml", fit);
  vs_fit_result *o = fit_with(NULL, 0, q);
  CU_ASSERT_EQUAL(o->estimate.n, n);
  for (size_t k = 0; k < o->estimate.n; k++) CLOSE(o->estimate.value[k], truth[k], tolerance);
  end_fit(o, q);
}

/* Both ways to the slopes tell the same; `inexact`: the exact one gives way to differences. */
static void expect_same_slopes(const char *fit, bool inexact, double tolerance) {
  vs_fit_problem *q[2];
  vs_fit_result *o[2];
  write_file("f.yaml", fit);
  for (int k = 0; k < 2; k++) {
    char *const sets[] = {"starts=1", k ? "slopes=differences" : "slopes=auto"};
    q[k] = vs_alloc(1, sizeof *q[k]);
    o[k] = fit_with(sets, 2, q[k]);
  }
  CU_ASSERT_EQUAL(o[0]->prediction.inexact > 0, inexact);
  CU_ASSERT_EQUAL(o[0]->estimate.n_directions, o[1]->estimate.n_directions);
  for (size_t k = 0; k < o[0]->estimate.n_directions; k++)
    CLOSE(o[0]->estimate.directions[k].singular, o[1]->estimate.directions[k].singular, tolerance);
  for (int k = 0; k < 2; k++) end_fit(o[k], q[k]);
}

/* ---- the truth, through the instruments ---- */

#define FREE_FIVE                                                                                  \
  "free:\n"                                                                                        \
  "  machine.trough_mass: {from: 0.4 kg, to: 2 kg}\n"                                              \
  "  machine.spring_stiffness: {from: 20 kN/m, to: 80 kN/m}\n"                                     \
  "  machine.spring_damping: {from: 0.2 N.s/m, to: 6 N.s/m}\n"                                     \
  "  actuator.inductance: {from: 0.8 H, to: 3 H}\n"                                                \
  "  actuator.gap: {from: 3 mm, to: 12 mm}\n"
static const double FIVE[] = {0.88, 40900, 1.6, 1.53, 6.2};

#define TRUE_FIVE                                                                                  \
  "--set machine.trough_mass=0.88kg --set machine.spring_stiffness=40900N/m "                      \
  "--set machine.spring_damping=1.6N.s/m --set actuator.inductance=1.53H "                         \
  "--set actuator.gap=6.2mm "
/* The paper's sensors as ones that neither make noise nor have an A/D. */
#define QUIET                                                                                      \
  "instruments: {p: {noise: 0 m, bits: none}, i: {noise: 0 A, bits: none}, ap: {noise: 0 m/s2, "   \
  "bits: none}}"
#define QUIET_WIDE                                                                                 \
  "instruments: {p: {noise: 0 m, bits: none, range: [-30 mm, 30 mm]}, ap: {noise: 0 m/s2, bits: "  \
  "none}}"
#define QUIET_NARROW                                                                               \
  "instruments: {p: {noise: 0 m, bits: none, range: [-1 mm, 1 mm]}, i: {noise: 0 A, bits: none}}"
#define RUN_QUIET                                                                                  \
  "run paper --tier switched --quiet --digits 17 -o seen "                                         \
  "--set 'instruments={p: {noise: 0 m, bits: none}, i: {noise: 0 A, bits: none}, "                 \
  "ap: {noise: 0 m/s2, bits: none}}' "

/* Without noise and A/D the truth itself is found, though a sensor of 100 Hz shows a tenth less
 * than there is, and later. 1e-7: the search ends there, as in test_fit. */
static void a_clean_record(void) {
  RUN_GOOD(RUN_QUIET TRUE_FIVE "--set run.until=0.1s --set run.sample=1ms");
  expect_found("set: {run.tier: switched, " QUIET "}\n" FREE_FIVE "starts: 2\n"
               "data: {file: seen/run.csv, columns: {p_meas: 2 um, i_meas: 2 mA, ap_meas: 0.1 "
               "m/s2}}\n",
               FIVE, 5, 1e-7);
}

/* Slopes go through the low-passes. The bandwidth of a sensor may itself be unknown. Where a
 * low-pass begins on an orbit, differences tell. 1e-6: what those of fourth order are good for.
 *
 * Where p leaves the range, here of 1 mm, a key moves the instants at which it does. That is of
 * second order, but has a corner, over which differences of any order are off by about the share by
 * which they alter the motion: 1e-3 for both ways. */
static void slopes_through_instruments(void) {
  RUN_GOOD(RUN_QUIET "--set firing.every=1 --set 'instruments.p.range=[-30 mm, 30 mm]' "
                     "--set run.until=0.1s --set run.sample=1ms");
  expect_same_slopes(
      "set: {run.tier: switched, firing.every: 1, " QUIET_WIDE "}\n"
      "free: {machine.trough_mass: , supply.frequency: , instruments.p.bandwidth: }\n"
      "data: {file: seen/run.csv, columns: {p_meas: 2 um, ap_meas: 0.1 m/s2}}\n",
      false, 1e-6);
  RUN_GOOD(RUN_QUIET "--set firing.every=1 --set 'instruments.p.range=[-1 mm, 1 mm]' "
                     "--set run.until=60ms --set run.sample=1ms");
  expect_same_slopes("set: {run.tier: switched, firing.every: 1, " QUIET_NARROW "}\n"
                     "free: {machine.trough_mass: , actuator.gap: }\n"
                     "data: {file: seen/run.csv, columns: {p_meas: 2 um, i_meas: 2 mA}}\n",
                     false, 5e-3);
  RUN_GOOD(RUN_QUIET "--set 'firing={every: 1, angle: 120 deg}' --set start=steady "
                     "--set run.until=40ms --set run.sample=1ms");
  expect_same_slopes(
      "set: {run.tier: switched, firing: {every: 1, angle: 120 deg}, start: steady, " QUIET
      "}\nfree: {machine.trough_mass: , machine.spring_damping: }\n"
      "data: {file: seen/run.csv, columns: {p_meas: 2 um, i_meas: 2 mA}}\n",
      true, 1e-9);
}

/* ---- instants and ends ---- */

static ran fit_p(const char *data, const char *free) {
  vs_text text = {0};
  vs_text_add(&text, "set: {run.tier: switched, instruments: {}}\n%s\ndata: {%s}\nstarts: 1\n",
              free, data);
  write_file("f.yaml", text.text);
  vs_text_free(&text);
  return run("fit f.yaml");
}

#define MASS "free: {machine.trough_mass: {from: 0.4 kg, to: 2 kg}}"

/* Rows come more often than samples, so that most show one again; those are counted once. Rows that
 * are none of the instants have to say what they show. */
static void rows_between_samples(void) {
  RUN_GOOD("run paper --tier switched --set instruments={} --set run.until=50ms "
           "--set run.sample=0.03ms --quiet -o seen");
  ran r = fit_p("file: seen/run.csv, columns: {p_meas: }", MASS);
  EXPECT(r.status == 2 && strstr(r.err, "seen/run.csv:3:") && strstr(r.err, "rows: held"), "%s",
         r.err);
  free_ran(&r);
  r = fit_p("file: seen/run.csv, columns: {p_meas: }, rows: held", MASS);
  EXPECT(r.status == 0 && strstr(r.err, "1167 cells show a sample that a row before has shown"),
         "%s", r.err);
  CU_ASSERT_PTR_NULL(strstr(r.err, "does not fit"));
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "from 500 numbers"));
  free_ran(&r);
  r = fit_p("file: seen/run.csv, columns: {p_meas: }, rows: taken", MASS); /* which is not true */
  CU_ASSERT_PTR_NOT_NULL(strstr(r.err, "does not fit"));
  free_ran(&r);
  r = fit_p("file: seen/run.csv, columns: {p_meas: }, rows: some", MASS);
  EXPECT(r.status == 2 && strstr(r.err, "f.yaml:3:") && strstr(r.err, "taken|held"), "%s", r.err);
  free_ran(&r);
}

/* Without a low-pass the sensor's ends are the A/D's. What lies there is left out, which is said.
 */
static void samples_at_an_end(void) {
  RUN_GOOD("run paper --tier switched --set instruments={} --set instruments.p.bandwidth=none "
           "--set 'instruments.p.range=[-1 mm, 1 mm]' --set run.until=50ms --quiet -o seen");
  write_file("f.yaml", "set: {run.tier: switched, instruments: {p: {bandwidth: none, range: "
                       "[-1 mm, 1 mm]}}}\n" MASS "\ndata: {file: seen/run.csv, columns: {p_meas: "
                       "}}\nstarts: 1\n");
  ran r = run("fit f.yaml");
  CU_ASSERT_EQUAL(r.status, 0);
  CU_ASSERT_PTR_NOT_NULL(strstr(r.err, "samples at an end of their A/D's range are left out"));
  CU_ASSERT_PTR_NULL(strstr(r.err, "does not fit"));
  free_ran(&r);
}

static void no_instruments(void) {
  static const char *const NONE[] = {"instruments: {}", NULL}, *const NEAREST[] = {
                                                                   "did you mean 'ap_meas'", NULL};
  write_file("d.csv", "t_s,p_meas_m\n0,0\n");
  write_file("f.yaml", MASS "\ndata: {file: d.csv, columns: {p_meas: }}\n");
  refuse("fit f.yaml", "none", "f.yaml:2:31", NONE, __LINE__);
  write_file("f.yaml",
             "set: {instruments: {}}\n" MASS "\ndata: {file: d.csv, columns: {ap_mes: }}\n");
  refuse("fit f.yaml", "nearest", "f.yaml:3:31", NEAREST, __LINE__);
}

/* ---- how often an interval holds the truth ---- */

typedef struct tally {
  int held[5], chi2;         /* of the 95 % intervals; chi2 with a probability above 5 % */
  double sum[5], squares[5]; /* of (estimate - truth)/standard error, of the logarithms */
} tally;

static void count_seed(int seed, tally *t) {
  char words[512];
  char *const sets[] = {"starts=1", "slopes=differences"};
  vs_fit_problem *q = vs_alloc(1, sizeof *q);
  snprintf(words, sizeof words,
           "run paper --tier switched --set instruments={} --set instruments.seed=%d " TRUE_FIVE
           "--set run.until=%s --quiet --digits 12 -o seen",
           seed, getenv("VS_LONG") ? "0.1s" : "50ms --set run.sample=0.5ms");
  run_good(words, __LINE__);
  vs_fit_result *o = fit_with(sets, 2, q);
  for (size_t k = 0; k < o->estimate.n; k++) {
    const vs_estimate *e = &o->estimate;
    double off = log(e->value[k] / FIVE[k]) / e->error[k];
    t->held[k] += e->least[k] <= FIVE[k] && FIVE[k] <= e->most[k];
    t->sum[k] += off;
    t->squares[k] += off * off;
  }
  t->chi2 += o->estimate.n && o->estimate.probability > 0.05;
  end_fit(o, q);
}

/* A table of the seeds so far: in fit_intervals.csv, which goes with the test's folder, and on
 * standard output at the end. */
static void write_tally(const tally *t, int seeds, FILE *table) {
  static const char *const NAME[] = {"machine.trough_mass", "machine.spring_stiffness",
                                     "machine.spring_damping", "actuator.inductance",
                                     "actuator.gap"};
  fputs("unknown,truth,seeds,held,mean_in_errors,rms_in_errors\n", table);
  for (int k = 0; k < 5; k++)
    fprintf(table, "%s,%g,%d,%d,%.3f,%.3f\n", NAME[k], FIVE[k], seeds, t->held[k],
            t->sum[k] / seeds, sqrt(t->squares[k] / seeds));
  fprintf(table, "chi2,,%d,%d,,\n", seeds, t->chi2);
}

static void count_seeds(int seeds, tally *t) {
  for (int seed = 1; seed <= seeds; seed++) {
    count_seed(seed, t);
    FILE *table = fopen("fit_intervals.csv", "w");
    write_tally(t, seed, table);
    fclose(table);
  }
}

/* The paper's sensors and A/Ds. 459 of 500 is the fewest that the issue allows, 3.3 standard
 * deviations below the 475 of a true interval. Of 6 seeds fewer than 3 are less likely than one in
 * ten thousand, for each unknown. */
static void intervals_hold_the_truth(void) {
  bool all = getenv("VS_LONG");
  int seeds = all ? 500 : 6, least = all ? 459 : 3;
  tally t = {0};
  write_file("f.yaml", "set: {run.tier: switched, instruments: {}}\n" FREE_FIVE
                       "data: {file: seen/run.csv, columns: {p_meas: , i_meas: , ap_meas: }}\n");
  count_seeds(seeds, &t);
  for (int k = 0; k < 5; k++) EXPECT(t.held[k] >= least, "%d: %d of %d", k, t.held[k], seeds);
  EXPECT(t.chi2 >= least, "chi2: %d of %d", t.chi2, seeds);
  if (all) write_tally(&t, seeds, stdout);
}

/* ---- records of others' making ---- */

/* Writes a record of two columns with the given header, cells and line ends; t in ms, p in mm. */
static void write_record(const char *header, const char *row, const char *end, bool commas) {
  double p_mm[] = {0, -0.4, -1.1, -1.4, -0.9, 0.1, 1, 1.3};
  FILE *f = fopen("d.csv", "w");
  fprintf(f, "%s%s", header, end);
  for (int k = 0; k < (int)COUNT(p_mm); k++) {
    char line[64];
    snprintf(line, sizeof line, row, 10. + k, p_mm[k]);
    for (char *s = line; commas && *s; s++)
      if (*s == '.') *s = ',';
    fprintf(f, "%s%s", line, end);
  }
  fclose(f);
}

/* All of these are the same record. */
static void other_ways_to_write_it(void) {
  static const struct {
    const char *header, *row, *end;
    bool commas;
  } ALL[] = {
      {"t_ms,p_mm", "%.3f,%.3f", "\n", false},
      {"\xEF\xBB\xBF"
       "\"t [ms]\";\"p [mm]\"",
       "%.3f;%.3f", "\r\n", true},
      {"t [ms]\tp [mm]", "%.3f\t%.3f", "\n", true},
      {"t_ms ; p_mm", " %.3f ; \"%.3f\"", "\r\n", false},
      {"# of 5 June, 14:30\nt [ms]\tu [mm]\tp [mm]", "%.3f\t\t%.3f", "\n", false},
  };
  double first = NAN;
  for (size_t k = 0; k < COUNT(ALL); k++) {
    vs_fit_problem *q = vs_alloc(1, sizeof *q);
    vs_error err = {0};
    write_record(ALL[k].header, ALL[k].row, ALL[k].end, ALL[k].commas);
    write_file("f.yaml",
               "free: {machine.trough_mass: }\ndata: {file: d.csv, columns: {p: 5 um}}\n");
    vs_status status = vs_fit_problem_read("f.yaml", NULL, 0, NULL, q, &err);
    EXPECT(!status && q->n_data == 8, "%zu: %s", k, err.text);
    for (size_t n = 0; n < q->n_data && !status; n++) {
      if (!k) first = q->data[3].value;
      CLOSE_OF(q->data[n].value, n == 3 ? first : q->data[n].value, 1e-3, 1e-15);
    }
    CLOSE(q->n_data > 3 ? q->data[3].value : NAN, -1.4e-3, 1e-12);
    vs_fit_problem_free(q);
    free(q);
  }
}

/* A comma is either between cells or in numbers; a cell with both signs is no number. */
static void commas_in_numbers(void) {
  static const char *const HINT[] = {"a decimal comma", "semicolons"}, *const NONE[] = {
                                                                           "not a finite number",
                                                                           NULL};
  write_file("f.yaml", "free: {machine.trough_mass: }\ndata: {file: d.csv, columns: {p: 5 um}}\n");
  write_file("d.csv", "t_ms,p_mm\n\"10,5\",1\n");
  refuse("fit f.yaml", "quoted", "d.csv:2:1", HINT, __LINE__);
  write_file("d.csv", "t_ms;p_mm\n10;1.000,5\n");
  refuse("fit f.yaml", "both", "d.csv:2:4", NONE, __LINE__);
}

/* A column whose unit has a prefix, as a machine's own probe may: compared in SI, told in it. */
static void a_probe_in_mm(void) {
  write_file("m.yaml",
             "title: one mass\ncoordinates: {x: {unit: m, text: travel}}\n"
             "parameters:\n"
             "  mass:   {default: 1 kg, range: 0.1 kg .. 100 kg, text: all of it}\n"
             "  spring: {default: 100 kN/m, range: 0 N/m .. 1e9 N/m, text: to the ground}\n"
             "  damper: {default: 4 N.s/m, range: 0 N.s/m .. 1e9 N.s/m, text: beside it}\n"
             "mass: [[mass]]\ndamping: [[damper]]\nstiffness: [[spring]]\n"
             "gap: {along: {x: 1}}\n"
             "probes: {far: {of: 1000*x, unit: mm, text: travel}}\n"
             "actuator: {gap: 6 mm, pole_cover: 0.2 mm, inductance: 0.8 H, resistance: 20 ohm}\n");
  write_file("s.yaml",
             "machine: {model: m.yaml}\nsupply: {voltage: 440 V}\nfiring: {angle: 100 deg}\n");
  RUN_GOOD("run s.yaml --tier switched --quiet -o seen --set machine.mass=1.1kg "
           "--set run.until=50ms --set run.sample=1ms");
  write_file("f.yaml", "scene: s.yaml\nset: {run.tier: switched}\n"
                       "free: {machine.mass: {from: 0.5 kg, to: 2 kg}}\n"
                       "data: {file: seen/run.csv, columns: {far: 5 um}}\nstarts: 2\n");
  ran r = run("fit f.yaml -o out --quiet");
  EXPECT(r.status == 0, "%s", r.err);
  char *rows = read_file("out/residuals.csv");
  EXPECT(strstr(rows, "1,far,mm,0.001,"), "%.200s", rows);
  free(rows), free_ran(&r);
  const double truth[] = {1.1};
  char *fit = read_file("f.yaml");
  expect_found(fit, truth, 1, 1e-6);
  free(fit);
}

/* ---- measures of an orbit ---- */

static double measure_of(const char *json, const char *name) {
  char key[64];
  snprintf(key, sizeof key, "\"%s\": {\"value\": ", name);
  const char *at = strstr(json, key);
  return at ? strtod(at + strlen(key), NULL) : NAN;
}

/* Power and travel of the machine at work give its mass and its damping, beside a pulse's peak. The
 * numbers are those of `steady` and `run` themselves, of 12 digits. */
static void measures_of_an_orbit(void) {
  ran s = run("steady paper --tier switched --set firing.every=1 --set machine.trough_mass=0.9kg "
              "--set machine.spring_damping=2N.s/m --json --quiet");
  vs_text text = {0};
  vs_text_add(&text,
              "set: {run: {tier: switched, until: 50 ms}}\n"
              "free: {machine.trough_mass: {from: 0.85 kg, to: 1 kg, start: 0.91 kg}, "
              "machine.spring_damping: {from: 0.8 N.s/m, to: 4 N.s/m}}\nstarts: 1\nruns:\n"
              "  - {steady: true, set: {firing.every: 1}, measures: {power_in: {value: %.12g W, "
              "error: 1 %%}, p_max: {value: %.12g m, error: 10 um}, reaction_p_rms: {value: %.12g "
              "N, error: 1 %%}}}\n"
              "  - {set: {machine.spring_damping: 2 N.s/m}, measures: {working_frequency: {value: "
              "55.2 Hz, error: 100 %%}}}\n",
              measure_of(s.out, "power_in"), measure_of(s.out, "p_max"),
              measure_of(s.out, "reaction_p_rms"));
  const double truth[] = {0.9, 2};
  expect_found(text.text, truth, 2, 1e-6);
  expect_same_slopes(text.text, false, 1e-7);
  ran r = run("fit f.yaml");
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "run it  vibrospice steady paper --set run.tier=switched"));
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, " --set firing.every=1 "));
  free_ran(&r), free_ran(&s);
  vs_text_free(&text);
}

static void orbits_refused(void) {
  static const struct {
    const char *fit, *at, *says[2];
  } BAD[] = {
      {"steady: true\nmeasures: {power_in: {value: 8 W, error: 3 %}}\n" MASS,
       "f.yaml:1:9",
       {"continuous firing", "once"}},
      {"set: {firing.every: 1}\nsteady: yes\nmeasures: {p_max: {value: 1 m, error: 3 %}}\n" MASS,
       "f.yaml:2:9",
       {"true is wanted", "period"}},
      {"set: {firing.every: 1}\nsteady: {period: 0}\nmeasures: {p_max: {value: 1 m, error: 3 "
       "%}}\n" MASS,
       "f.yaml:2:18",
       {"whole number", "from 1"}},
      {"set: {firing.every: 1}\nsteady: true\ndata: {file: d.csv, columns: {p: 1 um}}\n" MASS,
       "f.yaml:3:1",
       {"beside steady", "start: steady"}},
      {"set: {firing.every: 1}\nmeasures: {power_in: {value: 8 W, error: 3 %}}\n" MASS,
       "f.yaml:2:12",
       {"no measure 'power_in'", "tier"}},
      {"steady: true\nruns: [{measures: {p_max: {value: 1 m, error: 3 %}}}]\n" MASS,
       "f.yaml:1:1",
       {"beside runs", "move it"}},
  };
  for (size_t k = 0; k < COUNT(BAD); k++) {
    char what[16];
    snprintf(what, sizeof what, "case %zu", k);
    write_file("f.yaml", BAD[k].fit);
    refuse("fit f.yaml", what, BAD[k].at, BAD[k].says, __LINE__);
  }
}

static const vs_test TESTS[] = {
    {"a clean record", a_clean_record},
    {"slopes through instruments", slopes_through_instruments},
    {"rows between samples", rows_between_samples},
    {"samples at an end", samples_at_an_end},
    {"no instruments", no_instruments},
    {"intervals hold the truth", intervals_hold_the_truth},
    {"other ways to write it", other_ways_to_write_it},
    {"commas in numbers", commas_in_numbers},
    {"a probe in mm", a_probe_in_mm},
    {"measures of an orbit", measures_of_an_orbit},
    {"orbits refused", orbits_refused},
};

int main(void) {
  return program_suite("fit_instruments", TESTS, COUNT(TESTS));
}
