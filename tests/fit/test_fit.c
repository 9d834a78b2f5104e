/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command fit: the paper's nine numbers against reference values, parameters found again from
 * simulated records with noise, how often their intervals hold the truth, what the data cannot
 * tell, and what is refused. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "fit/fit_result.h"
#include "program.h"
#include "study/random.h"

/* ---- numbers out of JSON ---- */

/* Behind the first `after`, the number behind "key": ; NaN: there is none. */
static double number(const char *json, const char *after, const char *key) {
  char name[96];
  const char *at = after ? strstr(json, after) : json;
  snprintf(name, sizeof name, "\"%s\": ", key);
  at = at ? strstr(at, name) : NULL;
  return at ? strtod(at + strlen(name), NULL) : NAN;
}

/* The k-th number of the array behind `after`. */
static double entry(const char *json, const char *after, const char *key, int k) {
  char name[96];
  const char *at = after ? strstr(json, after) : json;
  snprintf(name, sizeof name, "\"%s\": [", key);
  at = at ? strstr(at, name) : NULL;
  if (at) at += strlen(name);
  while (at && k-- > 0) at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL;
  return at ? strtod(at, NULL) : NAN;
}

static ran fit(const char *words) {
  ran r = run("fit %s --json --quiet", words);
  EXPECT(r.status == 0 && !*r.err, "fit %s: %d %s", words, r.status, r.err);
  return r;
}

/* A fit that ends, and does not fit: all is printed, and the status is 3. */
static ran fit_badly(const char *words) {
  ran r = run("fit %s --json --quiet", words);
  EXPECT(r.status == 3 && strstr(r.err, "the model does not fit"), "fit %s: %d %s", words, r.status,
         r.err);
  return r;
}

/* The shipped fit, with another line in the place of the one that has this key. */
static void write_with_in(const char *name, const char *key, const char *line) {
  char path[VS_PATH_SIZE];
  snprintf(path, sizeof path, VS_TEST_FOLDER "/../spice/fits/%s.yaml", name);
  char *text = read_file(path), *at = strstr(text, key);
  vs_text altered = {0};
  CU_ASSERT_PTR_NOT_NULL_FATAL(at);
  vs_text_add(&altered, "%.*s%s%s", (int)(at - text), text, line, strchr(at, '\n') + 1);
  write_file("altered.yaml", altered.text);
  vs_text_free(&altered);
  free(text);
}

/* ---- the paper's nine numbers ---- */

static const char *const SIX[] = {"machine.trough_mass",      "machine.base_mass",
                                  "machine.spring_stiffness", "machine.spring_damping",
                                  "actuator.inductance",      "actuator.gap"};

/* The references were found by another program from the same formulas. Estimates have 9 digits
 * there; the search ends 1e-6 standard errors from the minimum, which is 1e-7 of a value. Standard
 * errors have 6 digits, singular values 8, and the slopes are good to some 1e-7. */
static void the_nine_numbers(void) {
  static const double VALUE[] = {0.916171976, 2.32551851, 35916.6322,
                                 0.717895041, 1.39781218, 7.0610822};
  static const double ERROR[] = {0.0652493, 0.0572817, 0.0557685, 0.074951, 0.0342377, 0.0563277};
  static const double SINGULAR[] = {124.3368, 64.207108, 25.588642, 22.540727, 19.3854, 8.4072855};
  ran r = fit("paper");
  CLOSE(number(r.out, NULL, "chi2_at_start"), 365.612201, 2e-9);
  CLOSE_OF(number(r.out, NULL, "chi2"), 0.605180015, 1, 2e-9);
  CU_ASSERT_EQUAL(number(r.out, NULL, "degrees_of_freedom"), 3);
  CLOSE(number(r.out, NULL, "probability"), gsl_cdf_chisq_Q(0.605180015, 3), 1e-8);
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "\"fits\": true"));
  for (int k = 0; k < 6; k++) {
    CLOSE(number(r.out, SIX[k], "value"), VALUE[k], 1e-7);
    CLOSE_OF(number(r.out, SIX[k], "standard_error_of_ln"), ERROR[k], 1, 1e-7);
    CLOSE(entry(r.out, NULL, "singular_values", k), SINGULAR[k], 1e-6);
  }
  double runs = number(r.out, "\"search\"", "runs");
  EXPECT(runs > 100 && runs < 5000, "%g runs", runs);
  free_ran(&r);
  r = fit("paper --set residual=difference --set starts=1");
  CLOSE_OF(number(r.out, NULL, "chi2"), 0.6132847, 1, 1e-7);
  free_ran(&r);
}

/* Both ways to the slopes tell the same to what the differences are good for, of measures and of
 * samples, where a slope's sampled motion turns by 60 rad. */
static void exact_as_by_differences(void) {
  static const char *const FITS[] = {"paper --set starts=1", "f.yaml --set starts=1"};
  write_file("f.yaml", "set: {run: {tier: switched, until: 0.1 s, sample: 1 ms}}\n"
                       "free: {supply.frequency: , machine.trough_mass: , firing.angle: }\n"
                       "data: {file: seen/run.csv, columns: {p: 4 um, i: 3 mA}, to: 99 ms}\n");
  RUN_GOOD("run paper --tier switched --set run.until=0.1s --set run.sample=1ms --quiet -o seen");
  for (size_t n = 0; n < COUNT(FITS); n++) {
    char words[96];
    snprintf(words, sizeof words, "%s --set slopes=exact", FITS[n]);
    ran a = fit(words);
    snprintf(words, sizeof words, "%s --set slopes=differences", FITS[n]);
    ran b = fit(words);
    CU_ASSERT_PTR_NOT_NULL(strstr(a.out, "\"slopes\": \"exact"));
    CU_ASSERT_PTR_NOT_NULL(strstr(b.out, "\"slopes\": \"differences"));
    for (int k = 0; k < (n ? 3 : 6); k++)
      CLOSE(entry(a.out, NULL, "singular_values", k), entry(b.out, NULL, "singular_values", k),
            1e-7);
    free_ran(&a), free_ran(&b);
  }
}

/* All starts lead to one minimum, and that is far off. With the mounts' upright stiffness free,
 * too, which of all single keys helps most, it still is. */
static void a_base_of_4_kg_fits_nothing(void) {
  ran r = fit_badly("paper_base_4kg --set starts=3");
  double chi2 = number(r.out, NULL, "chi2");
  EXPECT(chi2 > 50, "chi2 %g", chi2);
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "\"fits\": false"));
  CU_ASSERT_EQUAL(number(r.out, "\"search\"", "reached_least"),
                  number(r.out, "\"search\"", "converged"));
  free_ran(&r);
  write_with_in("paper_base_4kg", "  actuator.gap:",
                "  actuator.gap: {from: 2 mm, to: 12 mm}\n"
                "  machine.mount_stiffness_y: {from: 4 kN/m, to: 400 kN/m}\n");
  r = fit_badly("altered.yaml --set starts=4 --set slopes=differences");
  EXPECT(number(r.out, NULL, "chi2") > 50, "chi2 %g", number(r.out, NULL, "chi2"));
  free_ran(&r);
  r = run("fit paper_base_4kg --set starts=1");
  CU_ASSERT_EQUAL(r.status, 3);
  /* sqrt(82.8/4) */
  CU_ASSERT_PTR_NOT_NULL(strstr(r.err, "the model does not fit: no values within the bounds come "
                                       "nearer than 4.55 times the stated errors"));
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "THE MODEL DOES NOT FIT"));
  free_ran(&r);
}

/* ---- simulated records ---- */

/* Who makes the noise of sample `index` of a column, with that standard deviation. */
typedef double (*noise)(uint64_t seed, uint64_t index, uint64_t column, double error);

static double white(uint64_t seed, uint64_t index, uint64_t column, double error) {
  return error * gsl_cdf_ugaussian_Pinv(vs_random_uniform(seed, index, column));
}

static double none(uint64_t seed, uint64_t index, uint64_t column, double error) {
  (void)seed, (void)index, (void)column, (void)error;
  return 0;
}

static const double P_ERROR = 4e-6, I_ERROR = 4e-3;

static const char *const FIVE[] = {"machine.trough_mass", "machine.spring_stiffness",
                                   "machine.spring_damping", "actuator.inductance", "actuator.gap"};
static const double TRUTH[] = {0.88, 40900, 1.6, 1.53, 6.2};

/* Runs the true machine and writes what instruments would record of it to data.csv: t in ms, p in
 * mm, i in mA with its error beside it, and a column that nobody wants. */
static void record(noise of, uint64_t seed) {
  RUN_GOOD("run paper --tier switched --set machine.trough_mass=0.88kg "
           "--set machine.spring_stiffness=40900N/m --set machine.spring_damping=1.6N.s/m "
           "--set actuator.inductance=1.53H --set actuator.gap=6.2mm --set run.until=0.2s "
           "--set run.sample=1ms --digits 17 --quiet -o truth");
  FILE *in = fopen("truth/run.csv", "r"), *out = fopen("data.csv", "w");
  vs_csv csv = {.file = "truth/run.csv", .stream = in};
  vs_error err = {0};
  size_t p = 0, i = 0;
  fputs("t_ms,p_mm,i_ma,i_error_ma,temperature\n", out);
  for (uint64_t row = 0; !vs_csv_next(&csv, &err) && csv.count; row++) {
    for (size_t k = 0; row == 0 && k < csv.count; k++) {
      if (!strcmp(csv.cell[k], "p_m")) p = k;
      if (!strcmp(csv.cell[k], "i_a")) i = k;
    }
    if (row == 0) continue;
    double t = 1e3 * strtod(csv.cell[0], NULL);
    double a = strtod(csv.cell[p], NULL) + of(seed, row, 0, P_ERROR);
    double b = strtod(csv.cell[i], NULL) + of(seed, row, 1, I_ERROR);
    fprintf(out, "%.17g,%.17g,%.17g,4,20\n", t, 1e3 * a, 1e3 * b);
  }
  vs_csv_free(&csv);
  fclose(in);
  fclose(out);
}

#define FREE_FIVE                                                                                  \
  "free:\n"                                                                                        \
  "  machine.trough_mass: {from: 0.4 kg, to: 2 kg}\n"                                              \
  "  machine.spring_stiffness: {from: 20 kN/m, to: 80 kN/m}\n"                                     \
  "  machine.spring_damping: {from: 0.2 N.s/m, to: 6 N.s/m}\n"                                     \
  "  actuator.inductance: {from: 0.8 H, to: 3 H}\n"                                                \
  "  actuator.gap: {from: 3 mm, to: 12 mm}\n"
static const char RECORD_FIT[] =
    "set: {run.tier: switched}\n" FREE_FIVE "data: {file: data.csv, columns: {p: 4 um, i: }}\n";

/* Without noise the truth itself is found. All starts lead there, though the recording has ten
 * swings and the starts are off by half the stiffness. 1e-7: as above. */
static void the_truth_from_a_clean_record(void) {
  record(none, 0);
  write_file("f.yaml", RECORD_FIT);
  ran r = fit("f.yaml");
  for (size_t k = 0; k < 5; k++) CLOSE(number(r.out, FIVE[k], "value"), TRUTH[k], 1e-7);
  CU_ASSERT_EQUAL(number(r.out, "\"search\"", "reached_least"), 8);
  EXPECT(number(r.out, NULL, "chi2") < 1e-6, "chi2 %g", number(r.out, NULL, "chi2"));
  free_ran(&r);
}

/* Within 4 standard errors; chi2 within what chance allows; no pattern. One is found where the
 * model lacks something: here damping and inductance are held where they are not. */
static void a_record_with_noise(void) {
  record(white, 7);
  write_file("f.yaml", RECORD_FIT);
  ran r = run("fit f.yaml --json -o out");
  CU_ASSERT_EQUAL(r.status, 0);
  CU_ASSERT_PTR_NOT_NULL(strstr(r.err, "not used: temperature"));
  for (size_t k = 0; k < 5; k++) {
    double off = log(number(r.out, FIVE[k], "value") / TRUTH[k]) /
                 number(r.out, FIVE[k], "standard_error_of_ln");
    EXPECT(fabs(off) < 4, "%s is off by %g standard errors", FIVE[k], off);
  }
  double probability = number(r.out, NULL, "probability");
  EXPECT(probability > 1e-3 && probability < 0.999, "probability %g", probability);
  CU_ASSERT_EQUAL(number(r.out, NULL, "data"), 402);
  CU_ASSERT_PTR_NULL(strstr(r.out, "\"pattern\": true"));
  char *rows = read_file("out/residuals.csv"), *json = read_file("out/fit.json");
  CU_ASSERT_EQUAL(count_lines(rows), 403);
  CU_ASSERT_STRING_EQUAL(json, r.out);
  if (on_path("gnuplot")) EXPECT_FILES("out", "fit.json fit.png fit.svg residuals.csv ");
  free(rows), free(json), free_ran(&r);

  write_file("f.yaml", "set: {run.tier: switched}\n"
                       "free: {machine.trough_mass: , machine.spring_stiffness: , actuator.gap: }\n"
                       "data: {file: data.csv, columns: {p: 4 um, i: }}\n");
  r = run("fit f.yaml --json --set starts=1");
  CU_ASSERT_EQUAL(r.status, 3); /* it does not fit, too */
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "\"pattern\": true"));
  CU_ASSERT_PTR_NOT_NULL(strstr(r.err, "follow a pattern"));
  free_ran(&r);
}

/* ---- how often an interval holds the truth ---- */

/* Counts, for each unknown, the seeds whose 95 % interval holds the truth. */
static void count_held(vs_fit_problem *q, noise of, uint64_t seeds, int held[]) {
  double *clean = vs_alloc(q->n_data, sizeof *clean);
  for (size_t n = 0; n < q->n_data; n++) clean[n] = q->data[n].value;
  for (uint64_t seed = 1; seed <= seeds; seed++) {
    vs_fit_result *o = vs_alloc(1, sizeof *o);
    vs_error err = {0};
    for (size_t n = 0; n < q->n_data; n++)
      q->data[n].value = clean[n] + of(seed, n, 0, q->data[n].error);
    vs_status status = vs_fit_result_of(q, o, &err);
    EXPECT(!status, "seed %llu: %s", (unsigned long long)seed, err.text);
    for (size_t k = 0; k < q->n_unknowns && !status; k++)
      held[k] += o->estimate.least[k] <= TRUTH[k] && TRUTH[k] <= o->estimate.most[k];
    vs_fit_result_free(o);
    free(o);
  }
  free(clean);
}

/* 500 seeds: 459 is the fewest that the issue allows, 3.3 standard deviations below the 475 of a
 * true interval. 8 seeds: fewer than 5 are as unlikely. */
static void intervals_hold_the_truth(void) {
  bool all = getenv("VS_LONG");
  uint64_t seeds = all ? 500 : 8;
  int held[VS_INQUIRY_UNKNOWNS] = {0}, least = all ? 459 : 5;
  char *const sets[] = {"starts=1", "slopes=differences"};
  vs_fit_problem *q = vs_alloc(1, sizeof *q);
  vs_error err = {0};
  record(none, 0);
  write_file("f.yaml", RECORD_FIT);
  vs_status status = vs_fit_problem_read("f.yaml", sets, 2, NULL, q, &err);
  EXPECT(!status, "%s", err.text);
  if (!status) count_held(q, white, seeds, held);
  for (int k = 0; k < 5; k++) {
    EXPECT(held[k] >= least, "%s: %d of %d", FIVE[k], held[k], (int)seeds);
    if (all) printf("%s: %d of %d\n", FIVE[k], held[k], (int)seeds);
  }
  vs_fit_problem_free(q);
  free(q);
}

/* ---- what the data cannot tell apart ---- */

/* A frequency that is known to 0.1 % gives a stiffness over a mass to 0.2 %, as f^2 = k/m; the mass
 * alone is what was known before. The base moves with it, so that the power of the mass is not
 * quite 1. */
static void known_together_only(void) {
  static const char SHAPE[] =
      "\n  \"fit\": \"f.yaml\",\n"
      "  \"search\": {\"starts\": #, \"converged\": #, \"reached_least\": #, \"next_chi2\": null, "
      "\"runs\": #, \"failed_runs\": #, \"slopes\": \"exact derivatives\", \"slopes_not_exact\": "
      "#},\n"
      "  \"data\": #,\n  \"priors\": #,\n  \"residual\": \"logarithm\",\n  \"chi2_at_start\": #,\n"
      "  \"chi2\": #,\n  \"degrees_of_freedom\": #,\n  \"probability\": null,\n  \"fits\": true,\n"
      "  \"unknowns\": {\n"
      "    \"machine.trough_mass\": {\"value\": #, \"unit\": \"kg\", \"standard_error\": #, "
      "\"standard_error_of_ln\": #, \"interval_95\": [#], \"start\": #, \"bounds\": [null, null], "
      "\"on_bound\": false},\n"
      "    \"machine.spring_stiffness\": {\"value\": #, \"unit\": \"N/m\", \"standard_error\": #, "
      "\"standard_error_of_ln\": #, \"interval_95\": [#], \"start\": #, \"bounds\": [null, null], "
      "\"on_bound\": false}\n  },\n"
      "  \"correlation\": [\n    [#],\n    [#]\n  ],\n"
      "  \"singular_values\": [#],\n"
      "  \"directions\": [\n"
      "    {\n      \"combination\": \"machine.trough_mass^-0.82 * machine.spring_stiffness\",\n"
      "      \"standard_error\": #,\n      \"of_logarithm\": true,\n"
      "      \"exponents\": {\"machine.trough_mass\": #, \"machine.spring_stiffness\": #},\n"
      "      \"singular_value\": #,\n"
      "      \"direction\": {\"machine.trough_mass\": #, \"machine.spring_stiffness\": #}\n    },\n"
      "    {\n      \"combination\": \"machine.trough_mass * machine.spring_stiffness\",\n"
      "      \"standard_error\": #,\n      \"of_logarithm\": true,\n"
      "      \"exponents\": {\"machine.trough_mass\": #, \"machine.spring_stiffness\": #},\n"
      "      \"singular_value\": #,\n"
      "      \"direction\": {\"machine.trough_mass\": #, \"machine.spring_stiffness\": #}\n    }\n "
      " ],\n"
      "  \"pairs\": [\n"
      "    {\n      \"combination\": \"machine.trough_mass^-0.82 * machine.spring_stiffness\",\n"
      "      \"standard_error\": #,\n      \"of_logarithm\": true,\n"
      "      \"exponents\": {\"machine.trough_mass\": #, \"machine.spring_stiffness\": #}\n    }\n "
      " ],\n"
      "  \"measures\": [\n    {\"run\": #, \"name\": \"working_frequency\", \"unit\": \"Hz\", "
      "\"measured\": #, \"fitted\": #, \"residual\": #}\n  ],\n"
      "  \"columns\": [\n  ],\n  \"warnings\": [\n  ]\n}\n";
  write_file("f.yaml", "set: {run: {until: 20 ms, tier: switched}}\n"
                       "free:\n"
                       "  machine.trough_mass: {prior: {value: 0.83 kg, error: 10 %}}\n"
                       "  machine.spring_stiffness: {}\n"
                       "measures: {working_frequency: {value: 53.5 Hz, error: 0.1 %}}\n");
  ran r = fit("f.yaml -o out");
  CLOSE(number(r.out, "\"pairs\"", "standard_error"), 0.002, 0.1);
  CLOSE(number(r.out, "machine.trough_mass", "standard_error_of_ln"), 0.1, 1e-6);
  CLOSE(number(r.out, "machine.trough_mass", "value"), 0.83, 1e-6);
  CU_ASSERT_EQUAL(number(r.out, NULL, "priors"), 1);
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "machine.spring_stiffness"));
  double power = number(r.out, "\"pairs\"", "machine.trough_mass");
  EXPECT(power < -0.75 && power > -0.9, "power %g", power);
  make_shape(r.out);
  EXPECT(strstr(r.out, SHAPE), "%s", r.out);
  free_ran(&r);
  char *rows = read_file("out/residuals.csv");
  static const char ROWS[] = "run,name,unit,t_s,measured,computed,error,residual\n"
                             "1,working_frequency,Hz,,53.5,53.5,0.0535,";
  EXPECT(!strncmp(rows, ROWS, sizeof ROWS - 1), "%s", rows);
  free(rows);
  r = run("fit f.yaml --quiet --json --set measures.working_frequency.value=20Hz");
  CU_ASSERT_EQUAL(r.status, 0);
  free_ran(&r);
}

/* Held at an end of the profile's interval, chi2 is 3.841 higher. */
static void profiles(void) {
  ran r = fit("paper --profile actuator.gap,machine.base_mass -o out --set starts=1");
  char words[96];
  double least = number(r.out, NULL, "chi2"), rise = gsl_cdf_chisq_Pinv(0.95, 1);
  for (int k = 0; k < 2; k++) {
    double end = entry(r.out, "actuator.gap", "profile_95", k);
    write_with_in("paper", "  actuator.gap:", "");
    snprintf(words, sizeof words, "altered.yaml --set starts=1 --set actuator.gap=%.9gmm", end);
    ran held = fit(words);
    CLOSE(number(held.out, NULL, "chi2") - least, rise, 1e-3);
    free_ran(&held);
  }
  char *rows = read_file("out/profile.csv");
  EXPECT(count_lines(rows) > 10, "%s", rows);
  free(rows), free_ran(&r);
}

/* ---- several runs ---- */

/* Two pulses of one machine, at two angles, and a third with another load: the mass of the machine
 * is common, each has a voltage of its own. The numbers are those that the runs themselves gave. */
static void several_runs(void) {
  static const char *const SETS[] = {"firing.angle=100deg --set supply.voltage=440V",
                                     "firing.angle=115deg --set supply.voltage=425V"};
  vs_text text = {0};
  vs_text_add(&text, "set: {run: {until: 0.1 s, tier: switched}}\n"
                     "free:\n  machine.trough_mass:\n  machine.spring_stiffness:\nruns:\n");
  for (int k = 0; k < 2; k++) {
    ran r = run("run paper --tier switched --json --quiet --set run.until=0.1s --set "
                "machine.trough_mass=0.9kg --set machine.spring_stiffness=41kN/m --set %s",
                SETS[k]);
    vs_text_add(&text,
                "  - set: {firing.angle: %d deg}\n    free: {supply.voltage: {from: 300 V, "
                "to: 600 V}}\n    measures:\n",
                k ? 115 : 100);
    vs_text_add(&text, "      i_peak: {value: %.12g A, error: 1 %%}\n",
                number(r.out, "\"i_peak\"", "value"));
    vs_text_add(&text, "      p_first_peak: {value: %.12g m, error: 5 um}\n",
                number(r.out, "\"p_first_peak\"", "value"));
    vs_text_add(&text, "      f_resonance: {value: %.12g Hz, error: 0.1 %%}\n",
                number(r.out, "\"f_resonance\"", "value"));
    free_ran(&r);
  }
  write_file("f.yaml", text.text);
  vs_text_free(&text);
  ran r = fit("f.yaml --set starts=2");
  CLOSE(number(r.out, "machine.trough_mass", "value"), 0.9, 1e-6);
  CLOSE(number(r.out, "machine.spring_stiffness", "value"), 41000, 1e-6);
  CLOSE(number(r.out, "1.supply.voltage", "value"), 440, 1e-6);
  CLOSE(number(r.out, "2.supply.voltage", "value"), 425, 1e-6);
  free_ran(&r);
}

/* ---- bounds ---- */

/* The free fit wants a base of 2.33 kg. With 3 kg for its least it comes to rest there, and the
 * others are those of a fit with 3 kg held. 1e-6: the way to the bound is cut where chi2 would fall
 * by 1e-12. */
static void a_bound_stops(void) {
  write_with_in("paper", "  machine.base_mass:", "  machine.base_mass: {from: 3 kg, to: 20 kg}\n");
  static const char LINE[] =
      "\nmachine.base_mass                           3 kg       on its bound            -"
      "            -            4\n";
  ran r = run("fit altered.yaml --set starts=2 --set slopes=differences -o bound");
  CU_ASSERT_EQUAL(r.status, 3); /* with 3 kg it does not fit */
  CU_ASSERT_PTR_NOT_NULL(strstr(r.err, "machine.base_mass is on its bound"));
  EXPECT(strstr(r.out, LINE), "%s", r.out);
  free(r.out);
  r.out = read_file("bound/fit.json");
  ran held = fit_badly("paper_base_4kg --set machine.base_mass=3kg --set starts=1");
  CLOSE(number(r.out, "machine.base_mass", "value"), 3, 1e-6);
  CLOSE(number(r.out, NULL, "chi2"), number(held.out, NULL, "chi2"), 1e-6);
  CLOSE(number(r.out, "actuator.gap", "value"), number(held.out, "actuator.gap", "value"), 1e-5);
  CLOSE(number(r.out, "actuator.gap", "standard_error_of_ln"),
        number(held.out, "actuator.gap", "standard_error_of_ln"), 1e-4);
  free_ran(&r), free_ran(&held);
}

/* ---- patterns ---- */

static void patterns(void) {
  enum { N = 400 };
  double residual[N];
  for (int k = 0; k < N; k++) residual[k] = k % 2 ? 1 : -1;
  vs_residual_tests p = vs_residual_tests_of(residual, N);
  CU_ASSERT_EQUAL(p.runs, N);
  CLOSE(p.runs_expected, 1 + N / 2., 1e-15);
  CLOSE(p.durbin_watson, 4. * (N - 1) / N, 1e-14);
  CU_ASSERT_TRUE(p.found);
  for (int k = 0; k < N; k++) residual[k] = sin(0.1 * k);
  CU_ASSERT_TRUE(vs_residual_tests_of(residual, N).found);

  /* Of four numbers by hand: r1 = (0.75*-0.25 + -0.25*-1.25 + -1.25*0.75)/2.75, and so on. */
  const double four[] = {1, 0, -1, 1};
  p = vs_residual_tests_of(four, 4);
  CU_ASSERT_TRUE(isnan(p.runs_probability) && isnan(p.ljung_box));
  CLOSE(p.durbin_watson, 6. / 3, 1e-15);
  CLOSE(p.rms, sqrt(0.75), 1e-15);

  /* Chance: each test says "pattern" in one of a thousand cases; of 500, in half a case on average
   * each. */
  int found = 0, low = 0;
  for (uint64_t seed = 0; seed < 500; seed++) {
    for (uint64_t k = 0; k < N; k++) residual[k] = white(seed, k, 0, 1);
    p = vs_residual_tests_of(residual, N);
    found += p.found;
    low += p.ljung_box_probability < 0.05;
  }
  EXPECT(found < 6, "%d of 500", found);
  EXPECT(low > 8 && low < 45, "%d of 500 below 5 %%", low);
}

/* ---- refused ---- */

#define MASS "free: {machine.trough_mass: }\n"
#define PEAK "measures: {i_peak: {value: 0.95 A, error: 3 %}}\n"
#define DATA(columns) "data: {file: d.csv, columns: " columns "}\n"

static void refused(void) {
  static const struct {
    const char *fit, *csv, *at, *says[3];
  } BAD[] = {
      {"free: {machine.trough_mass: , actuator.gap: }\n" PEAK,
       NULL,
       "f.yaml:1:31",
       {"free keys: 2", "numbers to find them from: 1"}},
      {"free: {actuator.pole_cover: {from: 0.3 mm, to: 1 mm}, actuator.gap: }\n"
       "measures: {i_peak: {value: 0.95 A, error: 3 %}, force_peak: {value: 90 N, error: 5 %}, "
       "p_first_peak: {value: -1.5 mm, error: 3 %}}\n",
       NULL,
       "f.yaml:1:",
       {"cannot tell so many unknowns apart", "actuator.gap"}},
      {"free: {machine.trough_mas: }\n" PEAK, NULL, "f.yaml:1:8", {"did you mean"}},
      {"free: {machine.trough_mass: {from: 1 kg}}\n" PEAK,
       NULL,
       "f.yaml:1:8",
       {"exclude 0.83", "start"}},
      {"free: {machine.trough_mass: {from: 1 kg, to: 0.5 kg}}\n" PEAK,
       NULL,
       "f.yaml:1:46",
       {"hold nothing"}},
      {"free: {machine.trough_mass: {from: 1 m}}\n" PEAK, NULL, "f.yaml:1:36", {"wrong unit"}},
      {"free: {machine.trough_mass: {form: 1 kg}}\n" PEAK, NULL, "f.yaml:1:30", {"from"}},
      {"free: {machine.trough_mass: {prior: 3}}\n" PEAK, NULL, "f.yaml:1:37", {"error: 5 %"}},
      {"free: {firing.every: }\n" PEAK, NULL, "f.yaml:1:8", {"not a real number"}},
      {"free: {supply.phase: }\n" PEAK, NULL, "f.yaml:1:8", {"from and to"}},
      {MASS "measures: {i_peek: {value: 1 A, error: 3 %}}\n", NULL, "f.yaml:2:12", {"i_peak"}},
      {MASS "measures: {i_peak: {value: 1, error: 3 %}}\n", NULL, "f.yaml:2:28", {"no unit"}},
      {MASS "measures: {i_peak: {value: 1 A, error: 0 %}}\n", NULL, "f.yaml:2:40", {"not above 0"}},
      {MASS "measures: {i_peak: {value: 1 A}}\n", NULL, "f.yaml:2:21", {"error: 3 %"}},
      {MASS "measures: {p_first_peak: {value: 1.5 mm, error: 3 %}}\n",
       NULL,
       "f.yaml:2:12",
       {"unlike", "sign"}},
      {"free: {run.until: }\n" PEAK, NULL, "f.yaml:1:8", {"changes when run.until changes"}},
      {MASS, NULL, "f.yaml", {"nothing was measured"}},
      {PEAK, NULL, "f.yaml", {"nothing is free"}},
      {MASS PEAK "starts: 0\n", NULL, "f.yaml:3:9", {"from 1"}},
      {MASS PEAK "residual: log\n", NULL, "f.yaml:3:11", {"logarithm|difference"}},
      {MASS PEAK "profile: [actuator.gap]\n", NULL, "f.yaml:3:11", {"not free"}},
      {MASS PEAK "fre: 1\n", NULL, "f.yaml:3:1", {"did you mean 'free'"}},
      {MASS PEAK "runs: []\n", NULL, "f.yaml:2:1", {"beside runs"}},
      {MASS "runs: [{set: {}}]\n", NULL, "f.yaml:2:9", {"nothing was measured"}},
      {MASS "runs: [{"
            "measures: {i_peak: {value: 1 A, error: 3 %}}, free: {machine.trough_mass: }}]",
       NULL,
       "f.yaml:2:",
       {"free already"}},
      {MASS DATA("{p: 4 um}"), NULL, "f.yaml:2:14", {"d.csv", "cannot be opened"}},
      {MASS DATA("{q: 4 um}"), "t_s,p_m\n0,0\n", "f.yaml:2:31", {"did you mean 'p'"}},
      {MASS DATA("{u: 4 um}"), "t_s,p_m\n0,0\n", "f.yaml:2:31", {"has no column u"}},
      {MASS DATA("{p: 4 s}"), "t_s,p_m\n0,0\n", "f.yaml:2:34", {"wrong unit"}},
      {MASS DATA("{p: 4 %}"), "t_s,p_m\n0,0\n", "f.yaml:2:34", {"amount"}},
      {MASS DATA("{p: 0 m}"), "t_s,p_m\n0,0\n", "f.yaml:2:34", {"not above 0"}},
      {MASS DATA("{p: }"), "t_s,p_m\n0,0\n", "f.yaml:2:31", {"p_error"}},
      {MASS DATA("{p: 4 um}"), "t,p_m\n0,0\n", "d.csv:1:1", {"t_s, t_ms"}},
      {MASS DATA("{p: 4 um}"), "t_s,p\n0,0\n", "d.csv:1:5", {"no unit", "p_m"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_kg\n0,0\n", "d.csv:1:5", {"kg", "no unit of m"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_m,p_mm\n0,0,0\n", "d.csv:1:9", {"second time"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_m\n0,x\n", "d.csv:2:3", {"not a finite number"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_m\n0,inf\n", "d.csv:2:3", {"not a finite number"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_m\n0,nan\n", "d.csv:", {"no sample"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_m\n0,0,1\n", "d.csv:2:1", {"cells"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_m\n0.1,0\n0.05,0\n", "d.csv:3:1", {"does not rise"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_m\n1,0\n3,0\n", "d.csv:3:1", {"outside of the run"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_m\n-1,0\n", "d.csv:2:1", {"outside of the run"}},
      {MASS DATA("{p: 4 um}"), "t_s,p_m\n0,\n", "d.csv:", {"no sample"}},
      {MASS DATA("{p: 4 um}"), "", "d.csv:1:1", {"empty"}},
      {MASS DATA("{p: }"), "t_s,p_m,p_error_m\n0,0,0\n", "d.csv:2:5", {"not above 0"}},
  };
  remove_tree("d.csv");
  for (size_t k = 0; k < COUNT(BAD); k++) {
    char what[32];
    if (BAD[k].csv) write_file("d.csv", BAD[k].csv);
    write_file("f.yaml", BAD[k].fit);
    snprintf(what, sizeof what, "case %zu", k);
    refuse("fit f.yaml -o out", what, BAD[k].at, BAD[k].says, __LINE__);
  }
  static const char *const SET[] = {"is free, and --set", NULL};
  write_file("f.yaml", MASS PEAK);
  refuse("fit f.yaml --set machine.trough_mass=1kg", "set", "f.yaml:1:8", SET, __LINE__);
  static const char *const PROFILE[] = {"not free", NULL};
  refuse("fit f.yaml --profile actuator.gap", "profile", "--profile", PROFILE, __LINE__);
}

/* Status 1, one line, nothing printed as a result and nothing written. */
static void does_not_converge(void) {
  static const char *const SETS[] = {"--set actuator.gap=0.2mm", "--set firing.first_cycle=40"};
  static const char *const SAYS[] = {"pole cover", "no conduction_time"};
  write_file("f.yaml", "set: {run: {until: 0.1 s, tier: switched}}\n" MASS
                       "measures: {conduction_time: {value: 8 ms, error: 3 %}}\n");
  char *before = listing(".");
  for (size_t k = 0; k < COUNT(SETS); k++) {
    ran r = run("fit f.yaml %s -o out --quiet", SETS[k]);
    EXPECT(r.status == 1 && strstr(r.err, "does not converge") && strstr(r.err, SAYS[k]), "%d %s",
           r.status, r.err);
    CU_ASSERT_STRING_EQUAL(r.out, "");
    EXPECT_FILES(".", before);
    free_ran(&r);
  }
  free(before);
}

/* ---- its budget ---- */

/* How many cycles of the mains a fit of two measures to a mass and a gap takes, and what it says
 * where it has one less in its search, or while it follows profiles. */
static vs_status fit_within(long cycles, const char *profile, vs_fit_result *o, vs_error *err) {
  char *const sets[] = {"starts=2"};
  vs_fit_problem *q = vs_alloc(1, sizeof *q);
  write_file("f.yaml", "set: {run: {until: 0.1 s, tier: switched}}\n"
                       "free: {machine.trough_mass: {}, actuator.gap: {}}\n"
                       "measures: {i_peak: {value: 0.85 A, error: 3 %}, p_min: {value: -1.4 mm, "
                       "error: 2 %}, f_resonance: {value: 56 Hz, error: 1 %}}\n");
  vs_status status = vs_fit_problem_read("f.yaml", sets, 1, profile, q, err);
  q->most_cycles = cycles;
  if (!status) status = vs_fit_result_of(q, o, err);
  CU_ASSERT(!q->runs[0].scene->order.budget);
  vs_fit_problem_free(q);
  free(q);
  return status;
}

static void a_budget_is_kept(void) {
  vs_fit_result *o = vs_alloc(1, sizeof *o);
  vs_error err = {0};
  vs_status status = fit_within(0, NULL, o, &err);
  const long whole = o->prediction.budget.spent[VS_BUDGET_IDEAL];
  EXPECT(!status && o->told && whole > 100, "%d %ld %s", status, whole, err.text);
  /* a fit that ends well keeps far from its end */
  EXPECT(whole < o->prediction.budget.most[VS_BUDGET_IDEAL] / 3, "%ld of %ld", whole,
         o->prediction.budget.most[VS_BUDGET_IDEAL]);
  vs_fit_result_free(o);
  err = (vs_error){0};
  status = fit_within(whole / 4, NULL, o, &err);
  EXPECT(status == VS_BUDGET && !o->told && strstr(err.text, "in the circuit") == NULL &&
             strstr(err.text, "runs, start 1 of 2; so far the least chi2 is") &&
             strstr(err.text, "machine.trough_mass = "),
         "%d %s", status, err.text);
  CU_ASSERT(o->prediction.budget.spent[VS_BUDGET_IDEAL] <= whole / 4);
  vs_fit_result_free(o);
  err = (vs_error){0};
  status = fit_within(whole + 20, "all", o, &err);
  EXPECT(status == VS_BUDGET && o->told && !o->n_profiles &&
             strstr(err.text, "profile of machine.trough_mass; so far the least chi2 is") &&
             strstr(err.text, "which converged"),
         "%d %s", status, err.text);
  vs_fit_result_free(o);
  free(o);
}

/* ---- the rest ---- */

static void check_and_list(void) {
  write_file("f.yaml", MASS PEAK);
  ran r = run("check f.yaml");
  EXPECT(r.status == 0 && strstr(r.out, "a good fit: 1 unknowns from 1 numbers"), "%s%s", r.out,
         r.err);
  free_ran(&r);
  write_file("f.yaml", MASS "measures: {i_peek: {value: 1 A, error: 3 %}}\n");
  r = run("check f.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "f.yaml:2:12: measures"), "%s%s", r.out, r.err);
  free_ran(&r);
  r = run("list fits");
  EXPECT(strstr(r.out, "paper_base_4kg"), "%s", r.out);
  free_ran(&r);
}

static void the_same_bytes(void) {
  ran a = fit("paper --set starts=1"), b = fit("paper --set starts=1");
  CU_ASSERT_STRING_EQUAL(a.out, b.out);
  free_ran(&a), free_ran(&b);
}

static const vs_test TESTS[] = {
    {"the paper's nine numbers", the_nine_numbers},
    {"exact as by differences", exact_as_by_differences},
    {"a base of 4 kg fits nothing", a_base_of_4_kg_fits_nothing},
    {"the truth from a clean record", the_truth_from_a_clean_record},
    {"a record with noise", a_record_with_noise},
    {"intervals hold the truth", intervals_hold_the_truth},
    {"known together only", known_together_only},
    {"profiles", profiles},
    {"several runs", several_runs},
    {"a bound stops", a_bound_stops},
    {"patterns", patterns},
    {"refused", refused},
    {"does not converge", does_not_converge},
    {"a budget is kept", a_budget_is_kept},
    {"check and list", check_and_list},
    {"the same bytes", the_same_bytes},
};

int main(void) {
  return program_suite("fit", TESTS, COUNT(TESTS));
}
