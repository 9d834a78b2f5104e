/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command steady, and `start: steady`, on tiers switched and circuit: the numbers of an orbit
 * against references that were found by other programs, the cycles that a search takes, what is
 * written and printed, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "orbit/measured.h"
#include "program.h"

/* ---- numbers out of JSON ---- */

/* The k-th number of the array. */
static double entry(const char *json, const char *array, int k) {
  char name[64];
  snprintf(name, sizeof name, "\"%s\": [", array);
  const char *at = strstr(json, name);
  if (!at) return NAN;
  at += strlen(name);
  while (k-- > 0 && at) at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL;
  return at ? strtod(at, NULL) : NAN;
}

/* The size of the k-th multiplier. */
static double size_of(const char *json, int k) {
  const char *at = strstr(json, "\"multipliers\": [");
  while (at && k-- >= 0) at = strstr(at + 1, "{\"re\": ");
  const char *im = at ? strstr(at, "\"im\": ") : NULL;
  return im ? hypot(strtod(at + 7, NULL), strtod(im + 6, NULL)) : NAN;
}

static ran steady(const char *words) {
  ran r = run("steady %s --json --reproducible --quiet", words);
  EXPECT(r.status == 0 && !*r.err, "steady %s: %d %s", words, r.status, r.err);
  return r;
}

/* ---- numbers ---- */

/* The references have 10 to 12 digits; the dense output, on which extremes and integrals are taken,
 * is right to 5e-11 of the motion. Hence 1e-10 for what is printed with as many digits, and 1e-9 of
 * the current for its harmonics. */
static void the_conveyor_at_100_degrees(void) {
  static const double AMPERES[] = {0.17462090569,  0.20614993933,  0.1113614025,
                                   0.021725726497, 0.020383088883, 0.016292110618};
  ran r = steady("paper --set firing.every=1");
  CLOSE(number_in(r.out, "p_min"), -0.0021377328283, 1e-10);
  CLOSE(number_in(r.out, "power_in"), 8.49145448715, 1e-10);
  CLOSE(number_in(r.out, "i_rms"), 0.294464118668, 1e-10);
  CLOSE(number_in(r.out, "i_mean"), AMPERES[0], 1e-10);
  CLOSE(number_in(r.out, "power_factor"), 8.49145448715 / (440 * 0.294464118668), 1e-10);
  for (int n = 0; n < (int)COUNT(AMPERES); n++)
    CLOSE_OF(entry(r.out, "harmonics", n), AMPERES[n], AMPERES[0], 1e-9);
  int commas = 0;
  for (const char *c = strstr(r.out, "\"harmonics\": ["); *c != ']'; c++) commas += *c == ',';
  EXPECT(commas == 40, "%d harmonics and one", commas);
  CLOSE(size_of(r.out, 0), 0.999655306, 1e-8); /* 58 s of decay: exp(-T/58.01) */
  CU_ASSERT(number_in(r.out, "period") == 1 && number_in(r.out, "period_s") == 0.02);
  CU_ASSERT(number_in(r.out, "first_cycle") == 1);
  CU_ASSERT(number_in(r.out, "iterations") <= 6 && number_in(r.out, "correction") < 1e-12);
  CU_ASSERT(strstr(r.out, "\"stable\": true") && !strstr(r.out, "\"measured\""));
  /* what the books leave over is told as 0: a sum of 4e-14 J here */
  CU_ASSERT(number_in(r.out, "energy_stored") == 0);
  free_ran(&r);
  r = run("steady paper --set firing.every=1 --all"); /* the digits of the references */
  static const char *const LINES[] = {
      "\nmultiplier              re              im            size      decays in\n1    ",
      "     0.999655306        58.01 s\n2    ",
      "\nstable: the largest multiplier is below 1\n\n"
      "harmonic             A rms     limit A rms   part of limit\n"
      "0              0.174620906\n1              0.206149939\n2   ",
      "\n3             0.0217257265             2.3          0.94 %\n4   ",
      "harmonic 2 takes 10.3 % of its own\n"};
  for (size_t k = 0; k < COUNT(LINES); k++) EXPECT(strstr(r.out, LINES[k]), "%zu: %s", k, r.out);
  free_ran(&r);
}

static void other_machines(void) {
  ran r = steady("two_mass --set firing.every=1 --set firing.angle=130deg");
  CLOSE(number_in(r.out, "gap_min"), -0.00035404968735, 1e-10);
  CLOSE(number_in(r.out, "gap_max"), 0.00033816010455, 1e-10);
  CLOSE(number_in(r.out, "i_peak"), 0.63842439604, 1e-10);
  CLOSE(number_in(r.out, "force_peak"), 68.740115634, 1e-10);
  CLOSE(number_in(r.out, "power_in"), 0.8464749564, 1e-9);
  CLOSE(number_in(r.out, "i_rms"), 0.2427242011, 1e-9);
  CLOSE(size_of(r.out, 0), 0.987740250, 1e-8);
  CLOSE(size_of(r.out, 2), 0.939078381, 1e-8);
  free_ran(&r);
  r = steady("fixed_base --set firing.every=1 --set firing.angle=150deg");
  CLOSE(number_in(r.out, "p_min"), -0.00012196812378, 1e-10);
  CLOSE(number_in(r.out, "power_in"), 0.1870901158, 1e-9);
  CLOSE(number_in(r.out, "i_rms"), 0.04488328667, 1e-9);
  CLOSE(size_of(r.out, 0), 0.971444741, 1e-8);
  free_ran(&r);
}

/* A linear machine without a valve: 1 V of 20 Hz moves the shaker by what its transfer function
 * says, and its current is one harmonic. */
static void without_a_valve(void) {
  const double amperes = 0.505505110323, metres = 0.000741108559377; /* amplitudes */
  ran r = steady("lds_v203 --set supply.kind=sine --set supply.frequency=20Hz --set "
                 "supply.voltage=0.70710678118654752V --set start=steady");
  CLOSE(number_in(r.out, "gap_max"), metres, 1e-9);
  CLOSE(number_in(r.out, "gap_min"), -metres, 1e-9);
  CLOSE(number_in(r.out, "i_rms"), amperes / sqrt(2), 1e-9);
  for (int n = 0; n <= 40; n++)
    CLOSE_OF(entry(r.out, "harmonics", n), n == 1 ? amperes / sqrt(2) : 0, amperes, 1e-9);
  free_ran(&r);
}

/* In a period of 2 s nothing is left of a push, down to the smallest numbers there are, so that the
 * multipliers are 0. The current is the voltage over the impedance
 * R + s L + k_u k_f s / (M s^2 + C s + K), with s = i w. */
static void a_slow_supply(void) {
  const double w = acos(-1), mass = 0.031179581747282654, k_u = 3.7440944881889764;
  const double k_f = 3.743623311403237, re = 2896.597854976719 - mass * w * w,
               im = 6.845707989784762 * w, size = re * re + im * im;
  const double z_re = 1.6 + k_u * k_f * w * im / size,
               z_im = 764e-6 * w + k_u * k_f * w * re / size;
  ran r = steady("lds_v203 --set supply.kind=sine --set supply.frequency=0.5Hz --set "
                 "supply.voltage=1V");
  CLOSE(number_in(r.out, "i_rms"), 1 / hypot(z_re, z_im), 1e-9);
  CU_ASSERT(size_of(r.out, 0) < 1e-12 && number_in(r.out, "iterations") <= 6);
  free_ran(&r);
}

/* A period of two cycles has its harmonics from whole cycles, too; and the sum of the harmonics'
 * squares comes near to the square of the whole, and not beyond it. */
static void a_firing_in_every_second_cycle(void) {
  ran r = steady("paper --set firing.every=2 --set firing.angle=120deg");
  double sum = 0, rms = number_in(r.out, "i_rms");
  for (int n = 0; n <= 40; n++) sum += pow(entry(r.out, "harmonics", n), 2);
  CU_ASSERT(number_in(r.out, "period") == 1 && number_in(r.out, "period_s") == 0.04);
  EXPECT(sum < rms * rms && sum > 0.4 * rms * rms, "%g of %g", sum, rms * rms);
  free_ran(&r);
}

/* What the mounts do along u is what moves the masses there, as nothing else acts along it: row u
 * of M q", with the masses of Table 1. Rows of 5 us are within 2e-6 of the largest value, as half a
 * row's time is 1e-3 of the time in which it changes by as much as it is. */
static void forces_on_the_foundation(void) {
  const double pi = acos(-1), trough = 0.83, sin_a = sin(70 * pi / 180), cos_a = cos(70 * pi / 180);
  const double mass[2][4] = {{-trough * sin_a, trough + 4, 0, -trough * (0.129 - 0.089)},
                             {trough * cos_a, 0, trough + 4, trough * (0.092 - 0.194)}};
  double most[2] = {0};
  RUN_GOOD("steady paper --set firing.every=1 --set run.sample=5us --set "
           "record=[ap,au,aw,aphi] --digits 17 --quiet -o forces");
  char *csv = read_file("forces/run.csv"), *json = read_file("forces/summary.json"), *rest = csv;
  strsep(&rest, "\n");
  for (char *line; (line = strsep(&rest, "\n")) && *line;) {
    double a[4];
    for (int k = 0; k < 4; k++) a[k] = strtod(line = strchr(line, ',') + 1, NULL);
    for (int i = 0; i < 2; i++) {
      double sum = 0;
      for (int k = 0; k < 4; k++) sum += mass[i][k] * a[k];
      most[i] = fmax(most[i], fabs(sum));
    }
  }
  CLOSE(number_in(json, "reaction_u"), most[0], 2e-6);
  CLOSE(number_in(json, "reaction_w"), most[1], 2e-6);
  free(csv), free(json);
}

/* ---- what is written ---- */

static void files_of_one_period(void) {
  RUN_GOOD("steady paper --set firing.every=1 --quiet --digits 17 -o out");
  EXPECT_FILES("out", "events.csv run.csv summary.json ");
  char *csv = read_file("out/run.csv"), *json = read_file("out/summary.json");
  char *events = read_file("out/events.csv");
  CU_ASSERT(count_lines(csv) == 202 && strstr(json, "\"multipliers\""));
  CU_ASSERT(strstr(events, "thyristor fires") && strstr(events, "thyristor extinct"));
  double first = strtod(strstr(csv, "\n0,") + 3, NULL);
  double last = strtod(strchr(strstr(csv, "\n0.02"), ',') + 1, NULL);
  CLOSE_OF(last, first, 0.0021377, 1e-10); /* p returns */
  free(csv), free(json), free(events);
  RUN_GOOD("steady paper --set firing.every=1 --quiet -o out2 --reproducible");
  RUN_GOOD("steady paper --set firing.every=1 --quiet -o out3 --reproducible");
  char *one = read_file("out2/summary.json"), *other = read_file("out3/summary.json");
  CU_ASSERT_STRING_EQUAL(one, other);
  free(one), free(other);
}

/* ---- start: steady ---- */

static void a_run_begins_on_the_orbit(void) {
  ran r = run("run paper --set firing.every=1 --set start=steady --set run.until=0.5s --json "
              "--reproducible");
  ran orbit = steady("paper --set firing.every=1");
  CU_ASSERT(r.status == 0 && strstr(r.out, "\"steady\": true") && !*r.err);
  CLOSE(number_in(r.out, "p_min"), number_in(orbit.out, "p_min"), 1e-9);
  CLOSE(number_in(r.out, "p_max"), number_in(orbit.out, "p_max"), 1e-9);
  CLOSE(number_in(r.out, "energy_in"), 25 * number_in(orbit.out, "energy_in"), 1e-9);
  CLOSE(number_in(strstr(r.out, "\"start\""), "p"), number_in(strstr(orbit.out, "\"start\""), "p"),
        1e-9);
  free_ran(&r), free_ran(&orbit);
  r = run(
      "run lds_v203 --set supply.kind=sine --set supply.frequency=20Hz --set start=steady --set "
      "run.until=0.5s --json");
  CLOSE(number_in(r.out, "gap_max"), -number_in(r.out, "gap_min"), 1e-9); /* nothing settles */
  free_ran(&r);
}

/* The rows of a period come again in the next one, with a stop in reach, too. They are read off
 * steps that lie elsewhere: 1e-9 of the largest value is what the dense output may differ by. */
static void periods_are_alike(void) {
  static const struct {
    const char *sets, *period;
    int rows;
  } CASES[] = {{"firing.angle=79.5deg", "0.04s --set run.sample=100us", 200},
               {"firing.every=2 --set firing.angle=120deg", "0.08s --set run.sample=200us", 200},
               {"supply.frequency=62.5Hz --set firing.angle=80deg --set 'actuator.stop={at: 4 mm}'",
                "0.032s --set run.sample=80us", 200}};
  for (size_t k = 0; k < COUNT(CASES); k++) {
    double value[2][256][4] = {0}, most[4] = {0}, off[4] = {0};
    ran r = run("run paper --set firing.every=1 --set start=steady --set run.tier=switched --set "
                "record=[p,phi,i,force] --digits 17 --quiet -o alike --set %s --set run.until=%s",
                CASES[k].sets, CASES[k].period);
    EXPECT(r.status == 0 && !*r.err, "%s: %s", CASES[k].sets, r.err);
    char *csv = read_file("alike/run.csv"), *rest = csv;
    strsep(&rest, "\n");
    for (int n = 0; n < 2 * CASES[k].rows && rest; n++) {
      char *cell = strsep(&rest, "\n");
      for (int c = 0; c < 4 && cell && (cell = strchr(cell, ',')); c++)
        value[n / CASES[k].rows][n % CASES[k].rows][c] = strtod(++cell, NULL);
    }
    for (int n = 0; n < CASES[k].rows; n++)
      for (int c = 0; c < 4; c++) {
        most[c] = fmax(most[c], fabs(value[0][n][c]));
        off[c] = fmax(off[c], fabs(value[1][n][c] - value[0][n][c]));
      }
    for (int c = 0; c < 4; c++)
      EXPECT(most[c] > 0 && off[c] < 1e-9 * most[c], "%s: column %d: %g of %g", CASES[k].sets, c,
             off[c], most[c]);
    free(csv), free_ran(&r);
  }
}

/* The same door: a case of a study begins there too, with an id of its own. */
static void a_case_begins_on_the_orbit(void) {
  write_file("on.yaml", "set: {firing.every: 1, start: steady, run.until: 20 ms}\n"
                        "vary: {firing.angle: [100 deg, 110 deg]}\nreport: [p_min]\n");
  write_file("off.yaml", "set: {firing.every: 1, run.until: 20 ms}\n"
                         "vary: {firing.angle: [100 deg, 110 deg]}\nreport: [p_min]\n");
  ran on = run("study on.yaml --jobs 1 --quiet"), off = run("study off.yaml --jobs 1 --quiet"),
      two = run("study on.yaml --jobs 2 --quiet");
  char on_id[17] = "", off_id[17] = "", *row = strstr(on.out, "\n0,"),
       *of = strstr(off.out, "\n0,");
  CU_ASSERT_FATAL(row && of);
  snprintf(on_id, sizeof on_id, "%s", row + 3);
  snprintf(off_id, sizeof off_id, "%s", of + 3);
  CU_ASSERT_STRING_NOT_EQUAL(on_id, off_id);
  CLOSE(strtod(strstr(row, ",100,") + 5, NULL), -0.0021377328283, 1e-10);
  CU_ASSERT_STRING_EQUAL(on.out, two.out);
  free_ran(&on), free_ran(&off), free_ran(&two);
}

/* An event strikes a machine at work: until then nothing is another. */
static void an_event_at_work(void) {
  write_file("work.yaml", "start: steady\nfiring: {every: 1}\nrun: {until: 0.1 s, tier: switched}\n"
                          "events: {dip: {kind: sag, at: 40 ms}}\nrecord: [p, i]\n");
  RUN_GOOD("run work.yaml --quiet -o struck");
  RUN_GOOD("run paper --set start=steady --set firing.every=1 --set run.until=0.1s --set "
           "record=[p,i] --quiet -o calm");
  char *struck = read_file("struck/run.csv"), *calm = read_file("calm/run.csv");
  char *a = struck, *b = calm, *line_a, *line_b;
  double before = 0, after = 0;
  strsep(&a, "\n"), strsep(&b, "\n");
  while ((line_a = strsep(&a, "\n")) && (line_b = strsep(&b, "\n")) && *line_a) {
    double t = strtod(line_a, NULL);
    double off =
        fabs(strtod(strchr(line_a, ',') + 1, NULL) - strtod(strchr(line_b, ',') + 1, NULL));
    double *most = t <= 0.0455 ? &before : &after;
    *most = fmax(*most, off);
  }
  EXPECT(before < 1e-11 && after > 1e-4, "before %g, after %g", before, after);
  free(struck), free(calm);
}

/* ---- what is refused ---- */

static void refused(void) {
  static const struct {
    const char *words, *at, *says[2];
  } CASES[] = {
      {"steady paper -o out", "", {"firing.every", "once"}},
      {"steady paper --tier circuit -o out", "", {"firing.every", "once"}},
      {"steady paper --set firing.every=1 --tier analytic", "", {"tier switched", "analytic"}},
      {"steady lds_v203", "", {"supply.kind", "step"}},
      {"steady paper --set firing.every=1 --period 0", "", {"--period", "allowed"}},
      {"steady paper --set firing.every=1 --period x", "", {"--period", "allowed"}},
      {"steady e.yaml", "", {"e.yaml:2:", "events.dip"}},
      {"run paper --set start=steady -o out", "--set start=steady: ", {"firing.every", "once"}},
      {"run paper --set start=still", "--set start=still: ", {"'steady'", "{p: "}},
      {"run paper --set start=steady --set firing.every=1 --tier analytic -o out",
       "--set start=steady: ",
       {"analytic", "--tier switched"}},
      {"run paper --set start=steady --set firing.every=1 --set supply.phase=10deg",
       "--set supply.phase=10deg: ",
       {"supply.phase", "0 deg"}},
      {"run paper --set start=steady --set firing.every=1 --set firing.first_cycle=2",
       "--set firing.first_cycle=2: ",
       {"firing.first_cycle", "leave"}},
      {"run lds_v203 --set start=steady", "", {"supply.kind", "direct"}},
  };
  write_file("e.yaml", "{firing: {every: 1}, run: {tier: switched},\n"
                       "events: {dip: {kind: sag, at: 40 ms}}}\n");
  for (size_t k = 0; k < COUNT(CASES); k++)
    refuse(CASES[k].words, CASES[k].words, CASES[k].at, CASES[k].says, __LINE__);
  ran r = run("check paper --set start=steady --quiet");
  EXPECT(r.status == 2 && strstr(r.err, "firing.every: start is steady"), "%d %s", r.status, r.err);
  free_ran(&r);
}

/* What a search that ends nowhere says; no folder is left, and no orbit printed. What only a search
 * finds is a run that failed, and no bad input. */
static void nothing_is_found(void) {
  ran other = run("steady paper --set firing.every=1 --period 2 --quiet -o out");
  EXPECT(other.status == 1 && !*other.out && strstr(other.err, "write --period 1"), "%d %s",
         other.status, other.err);
  free_ran(&other);
  ran r = run("steady paper --set firing.every=1 --set firing.angle=70deg --quiet -o out");
  EXPECT(r.status == 1 && !*r.out && count_lines(r.err) == 1 && strstr(r.err, "pole cover") &&
             strstr(r.err, "stop"),
         "%d %s%s", r.status, r.out, r.err);
  EXPECT_FILES(".", "");
  free_ran(&r);
}

/* Where the machine settles on a subharmonic, no orbit of period 1 is told; what is told instead
 * can be typed. */
static void a_subharmonic_is_named(void) {
  static const struct {
    const char *angle, *asked, *say;
  } ROWS[] = {{"60", "", "--period 2"},
              {"60", "--period 3", "--period 2"},
              {"70", "", "--period 3"},
              {"78", "", "--period 4"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char words[160];
    snprintf(words, sizeof words,
             "paper --set firing.every=1 --set actuator.stop={} --set firing.angle=%sdeg",
             ROWS[k].angle);
    ran r = run("steady %s %s --quiet -o out", words, ROWS[k].asked);
    EXPECT(r.status == 1 && !*r.out && count_lines(r.err) == 1 && strstr(r.err, ROWS[k].say),
           "%s: %d %s%s", words, r.status, r.out, r.err);
    EXPECT_FILES(".", "");
    free_ran(&r);
    r = run("steady %s --quiet --json %s", words, ROWS[k].say);
    CU_ASSERT(r.status == 0 &&
              number_in(r.out, "period") == atoi(ROWS[k].say + strlen("--period ")));
    EXPECT(strstr(r.out, "\"stable\": true"), "%s: %s", words, r.err);
    free_ran(&r);
  }
}

/* ---- the studies that ship ---- */

/* The cell behind the value `at` of the study's axis. */
static double cell(const char *csv, const char *at) {
  char middle[32];
  snprintf(middle, sizeof middle, ",%s,", at);
  const char *found = strstr(csv, middle);
  return found ? strtod(found + strlen(middle), NULL) : NAN;
}

static void studies_that_ship(void) {
  ran control = run("study control_characteristic --quiet"), curve = run("study resonance --quiet");
  EXPECT(control.status == 0 && !*control.err && count_lines(control.out) == 38, "%s", control.err);
  EXPECT(curve.status == 0 && !*curve.err && count_lines(curve.out) == 62, "%s", curve.err);
  ran orbit = steady("paper --set firing.every=1 --set firing.angle=120deg");
  CLOSE(cell(control.out, "120"), number_in(orbit.out, "p_max"), 1e-10);
  free_ran(&orbit);
  orbit = steady("paper --set firing.every=1 --set supply.voltage=110V --set "
                 "supply.frequency=56.5Hz");
  CLOSE(cell(curve.out, "56.5"), number_in(orbit.out, "p_max"), 1e-9);
  free_ran(&orbit);
  /* the page's tables, in mm to three digits behind the point */
  CLOSE_OF(cell(control.out, "80"), 4.892e-3, 1, 5e-7);
  CLOSE_OF(cell(control.out, "100"), 1.922e-3, 1, 5e-7);
  CLOSE_OF(cell(control.out, "120"), 0.579e-3, 1, 5e-7);
  CLOSE_OF(cell(control.out, "150"), 0.025e-3, 1, 5e-7);
  CLOSE_OF(cell(curve.out, "50"), 0.110e-3, 1, 5e-7);
  CLOSE_OF(cell(curve.out, "56.5"), 2.009e-3, 1, 5e-7);
  CLOSE_OF(cell(curve.out, "60"), 0.143e-3, 1, 5e-7);
  free_ran(&control), free_ran(&curve);
}

/* On the orbit a case has the same row whoever computes it: one process, two, or shards; a case
 * without an orbit fails alone. */
static void who_computes_does_not_matter(void) {
  write_file("work.yaml",
             "set: {firing.every: 1, start: steady, run.until: 60 ms, run.tier: switched, events: "
             "{dip: {kind: sag, at: 20 ms}}}\n"
             "vary: {firing.angle: [70 deg, 90 deg, 120 deg], events.dip.at: [0 ms, 11 ms, 30 ms]}"
             "\nreport: [p_min, p_max]\n");
  static const char *const LINES[] = {
      "study work.yaml --jobs 1 --quiet -o one", "study work.yaml --jobs 2 --quiet -o two",
      "study work.yaml --shard 1/2 --quiet -o parts/1",
      "study work.yaml --shard 2/2 --quiet -o parts/2", "merge parts --quiet -o merged"};
  for (size_t k = 0; k < COUNT(LINES); k++) {
    ran r = run("%s", LINES[k]);
    EXPECT(r.status == 1, "%s: %d %s", LINES[k], r.status, r.err);
    free_ran(&r);
  }
  char *one = read_file("one/study.csv"), *two = read_file("two/study.csv");
  char *merged = read_file("merged/study.csv"), *failures = read_file("one/failures.csv");
  CU_ASSERT(count_lines(one) == 7 && count_lines(failures) == 4 && strstr(failures, "pole cover"));
  CU_ASSERT_STRING_EQUAL(one, two);
  CU_ASSERT_STRING_EQUAL(one, merged);
  free(one), free(two), free(merged), free(failures);
}

/* ---- the page's examples ---- */

/* Copy of the first fenced block that begins with this text. */
static char *block(const char *page, const char *kind, const char *begins) {
  char fence[64];
  snprintf(fence, sizeof fence, "\n```%s\n%s", kind, begins);
  const char *begin = strstr(page, fence);
  CU_ASSERT_PTR_NOT_NULL_FATAL(begin);
  char *text = vs_copy(strchr(begin + 1, '\n') + 1);
  *strstr(text, "\n```") = '\0';
  return text;
}

/* Runs the page's command that has this option, which must end well. */
static void run_command(const char *page, const char *option) {
  const char *at = strstr(page, option);
  CU_ASSERT_PTR_NOT_NULL_FATAL(at);
  while (at[-1] != '\n') at--;
  char *line = strndup(at, strcspn(at, "\n"));
  ran r = run("%s", line + strlen("vibrospice "));
  expect_good(&r, line, __LINE__);
  free_ran(&r), free(line);
}

/* Two words say the same: as numbers to 1e-6 or 1e-9 in all, as what is rounding differs between
 * machines; else letter by letter. */
static bool agree(const char *a, const char *b) {
  char *end_a, *end_b;
  double x = strtod(a, &end_a), y = strtod(b, &end_b);
  if (*end_a || *end_b) return !strcmp(a, b);
  return fabs(x - y) <= 1e-9 + 1e-6 * fabs(y);
}

static void the_page(void) {
  char *page = read_file(VS_TEST_FOLDER "/../docs/operation.md");
  char *line = block(page, "sh", ""), *text = block(page, "text", ""), *rest = text, *word;
  bool cut = false; /* "..." stands for words that the page leaves out */
  ran r = run("%s", line + strlen("vibrospice "));
  EXPECT(r.status == 0, "%s: %d %s", line, r.status,
         r.err); /* it warns of the speed of conveying */
  char *printed = r.out, *other = NULL;
  while ((word = strsep(&rest, " \n"))) {
    if (!*word) continue;
    if (!strcmp(word, "...")) {
      cut = true;
      continue;
    }
    do other = strsep(&printed, " \n");
    while (other && (!*other || (cut && !agree(word, other))));
    cut = false;
    EXPECT(other && agree(word, other), "the page says %s, the program %s", word,
           other ? other : "nothing");
    if (!other) break;
  }
  free_ran(&r), free(line), free(text);
  text = block(page, "yaml", "# atwork.yaml");
  write_file("atwork.yaml", text);
  free(text);
  run_command(page, "-o dipped");
  EXPECT_FILES("dipped", "events.csv run.csv summary.json ");
  text = block(page, "yaml", "# power.yaml");
  write_file("power.yaml", text);
  free(text);
  static const char *const FOLDERS[] = {"power", "control", "resonance"};
  for (int k = 0; k < (int)COUNT(FOLDERS); k++) {
    char folder[32];
    snprintf(folder, sizeof folder, "-o %s ", FOLDERS[k]);
    run_command(page, folder);
    EXPECT_FILES(FOLDERS[k], "failures.csv journal manifest.json study.csv ");
  }
  free(page);
}

/* ---- on tier circuit ---- */

static ran steady_on(const char *tier, const char *words) {
  ran r = run("steady paper --tier %s --set firing.every=1 %s --json --reproducible --quiet", tier,
              words);
  EXPECT(r.status == 0 && !*r.err, "steady %s: %d %s", words, r.status, r.err);
  return r;
}

static ran steady_circuit(const char *words) {
  return steady_on("circuit", words);
}

/* A column of run.csv, in the order of its rows; to be freed. *count: how many there are. */
static double *column(const char *path, const char *name, size_t *count) {
  char *text = read_file(path), *rest = text, *line = strsep(&rest, "\n");
  double *values = vs_alloc((size_t)count_lines(rest) + 1, sizeof *values);
  size_t at = 0, n = 0;
  for (char *word; (word = strsep(&line, ",")) && strcmp(word, name); at++) {
  }
  while ((line = strsep(&rest, "\n")) && *line) {
    for (size_t k = 0; k < at; k++) strsep(&line, ",");
    values[n++] = strtod(line, NULL);
  }
  free(text);
  *count = n;
  return values;
}

static bool contains(const char *path, const char *what) {
  char *text = read_file(path);
  bool found = strstr(text, what) != NULL;
  free(text);
  return found;
}

/* T3A at 100 degrees, found by shooting on the circuit's equations in another program. */
static void close_to_reference(const ran *r, double tolerance) {
  CLOSE(number_in(r->out, "p_min"), -0.0020778927946, tolerance);
  CLOSE(number_in(r->out, "p_max"), 0.001856145811, tolerance);
  CLOSE(number_in(r->out, "i_peak"), 0.61837671812, tolerance);
  CLOSE(number_in(r->out, "force_peak"), 101.40731321, tolerance);
  CLOSE(number_in(r->out, "power_in"), 13.677377413, tolerance);
  CLOSE(number_in(r->out, "t_extinction"), 0.013868338866, tolerance);
  CLOSE(number_in(r->out, "energy_copper"), 8.3001785 * 0.02, tolerance);
  CLOSE(number_in(r->out, "damping_J"), 0.48301747 * 0.02, 2 * tolerance); /* as p squared */
}
static const double SIZE[] = {0.99948987, 0.99860011, 0.99439091, 0.97083055};

/* A run is right to its run.tolerance, and the orbit to a hundredth of that; the finest, which
 * takes three times as long, with VS_LONG. The losses have more: what the varistors and snubbers
 * take is a small part of power_in. */
static void at_100_degrees(void) {
  const double TOLERANCE[] = {1e-4, getenv("VS_LONG") ? 1e-6 : 1e-5};
  for (size_t k = 0; k < COUNT(TOLERANCE); k++) {
    double tolerance = TOLERANCE[k];
    char words[64];
    snprintf(words, sizeof words, "--set run.tolerance=%g", tolerance);
    ran r = steady_circuit(words);
    close_to_reference(&r, tolerance);
    EXPECT(number_in(r.out, "cycles") <= (k ? 20 : 15), "%g cycles", number_in(r.out, "cycles"));
    EXPECT(number_in(r.out, "correction") <= 0.01 * tolerance, "%g",
           number_in(r.out, "correction"));
    EXPECT(strstr(r.out, "\"stable\": true") != NULL, "stable");
    for (int i = 0; i < 4; i++) /* the differences' error */
      CLOSE(size_of(r.out, 2 * i), SIZE[i], k ? 3e-5 : 2e-4);
    free_ran(&r);
  }
}

/* The same on tier compiled, whose multipliers come of the monodromy matrix of machine and circuit:
 * they are told to half of the tolerance, held to a tenth, and the reference has eight digits. That
 * of the circuit's slowest state is this tier's own at 1e-7. In the first two of the six or seven
 * cycles the circuit settles. */
static void at_100_degrees_on_tier_compiled(void) {
  static const double TOLERANCE[] = {1e-4, 1e-6};
  for (size_t k = 0; k < COUNT(TOLERANCE); k++) {
    const double tolerance = TOLERANCE[k];
    char words[64];
    snprintf(words, sizeof words, "--set run.tolerance=%g", tolerance);
    ran r = steady_on("compiled", words);
    close_to_reference(&r, tolerance);
    EXPECT(number_in(r.out, "cycles") <= 7, "%g cycles", number_in(r.out, "cycles"));
    EXPECT(number_in(r.out, "correction") <= 0.01 * tolerance, "%g",
           number_in(r.out, "correction"));
    CLOSE(number_in(r.out, "multipliers_error"), 0.5 * tolerance, 1e-9);
    for (int i = 0; i < 4; i++) CLOSE(size_of(r.out, 2 * i), SIZE[i], fmax(0.1 * tolerance, 1e-8));
    CLOSE_OF(size_of(r.out, 8), 0.22854471, 1, fmax(0.1 * tolerance, 1e-8));
    free_ran(&r);
  }
}

/* At 90 degrees the thyristor fires once in a cycle; at 110 it goes out 49 us after it has fired,
 * and fires again 261 us later. The finer run tells the error of the coarser one, which is to hold
 * its tolerance; both searches are to end within the cycles that were seen at first. 90 and 120
 * degrees with VS_LONG. */
static void at_other_angles(void) {
  static const struct {
    const char *angle;
    int cycles[2]; /* at most, at 1e-3 and at 1e-4 */
  } ROWS[] = {{"110deg", {10, 12}}, {"90deg", {13, 15}}, {"120deg", {16, 20}}};
  for (size_t k = 0; k < (getenv("VS_LONG") ? COUNT(ROWS) : 1); k++) {
    char words[128];
    snprintf(words, sizeof words, "--set firing.angle=%s --set run.tolerance=1e-3", ROWS[k].angle);
    ran coarse = steady_circuit(words);
    snprintf(words, sizeof words, "--set firing.angle=%s", ROWS[k].angle);
    ran fine = steady_circuit(words);
    static const char *const NAMES[] = {"p_min", "p_max", "i_peak", "power_in", "i_rms"};
    for (size_t n = 0; n < COUNT(NAMES); n++)
      CLOSE(number_in(coarse.out, NAMES[n]), number_in(fine.out, NAMES[n]), 1.1e-3);
    EXPECT(number_in(coarse.out, "cycles") <= ROWS[k].cycles[0], "%s: %g", ROWS[k].angle,
           number_in(coarse.out, "cycles"));
    EXPECT(number_in(fine.out, "cycles") <= ROWS[k].cycles[1], "%s: %g", ROWS[k].angle,
           number_in(fine.out, "cycles"));
    free_ran(&coarse), free_ran(&fine);
  }
}

/* The transformer's flux linkage creeps by 6 mWb a cycle to -1.268 Wb, for 60 cycles if it is left
 * alone. On the orbit it is where it was a period before. Tier compiled's first correction takes it
 * to where the transformer saturates and the fuse melts, and is taken back; 150 cycles from rest
 * lead it to -1.26842 Wb. */
static void a_flux_that_creeps(void) {
  static const struct {
    const char *tier;
    double cycles, wb, off_wb;
  } ROWS[] = {{"circuit", 30, -1.268, 2e-3}, {"compiled", 16, -1.26842, 1e-5}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("steady paper --tier %s --set circuit.deck=halfwave_paper --set firing.every=1 "
                "--set run.tolerance=1e-3 --set run.verify=never --json --quiet -o flux%zu",
                ROWS[k].tier, k);
    EXPECT(r.status == 0, "%s: %d %s", ROWS[k].tier, r.status, r.err);
    EXPECT(number_in(r.out, "cycles") <= ROWS[k].cycles, "%g cycles", number_in(r.out, "cycles"));
    size_t n;
    double *flux = column(k ? "flux1/run.csv" : "flux0/run.csv", "flux_wb", &n);
    const double first = flux[0], last = flux[n - 1];
    EXPECT(fabs(first - ROWS[k].wb) < ROWS[k].off_wb && fabs(last - first) < 1e-4, "%s: %g, %g",
           ROWS[k].tier, first, last);
    free(flux);
    free_ran(&r);
  }
}

/* The line warms up with a time constant of 0.2 s, which no probe shows. What the search says that
 * it is off by is no less than what the run goes on to move; multipliers, which the copies would
 * have wrong, are not told, and a warning says so. */
static void what_no_probe_shows(void) {
  write_file("slow.cir",
             "*$ title  a line that warms up\n*$ param  thyristor = latch part thyristor\n"
             "*$ port   mains = Vmains\n*$ port   gate = Vgate\n*$ line   a\n"
             "Vmains src 0 external\nRsource src s1 {r_source}\nLsource s1 a2 {l_source} ic=0\n"
             "Bwarm a2 a V = 5*i(Vmains)*v(warm)\nBheat 0 warm I = i(Vmains)^2\n"
             "Rwarm warm 0 10\nCwarm warm 0 20m ic=0\nVgate g b external\nVthy a t 0\n"
             "Xthy t b g thyristor\nRsnub a c1p 100\nCsnub c1p b 100n ic=0\n"
             "Reva b c2p 220\nCeva c2p 0 47n ic=0\nXeva b 0 eva\n");
#define SLOW                                                                                       \
  "--tier circuit --set circuit.deck=slow.cir --set firing.every=1 --set run.tolerance=1e-3 "      \
  "--set run.verify=never --quiet "
  ran r = run("steady paper " SLOW "--json");
  EXPECT(r.status == 0 && strstr(r.out, "\"stable\": null") &&
             strstr(r.out, "whether the orbit is stable is not known"),
         "%d %s", r.status, r.err);
  RUN_GOOD("run paper " SLOW "--digits 17 --set start=steady --set run.until=0.6s "
           "--set run.sample=20ms -o slow");
  size_t n;
  double *p = column("slow/run.csv", "p_m", &n), off = 0;
  for (size_t k = 0; k < n; k++) off = fmax(off, fabs(p[k] - p[0]) / 2.08e-3);
  EXPECT(off < number_in(r.out, "correction") && off < 1e-4, "%g, told %g", off,
         number_in(r.out, "correction"));
  free(p);
  free_ran(&r);
  write_file("judged.yaml",
             "set: {circuit.deck: slow.cir, firing.every: 1, run: {tier: circuit, tolerance: 1e-3, "
             "verify: never}}\nsteady: true\nvary: {firing.angle: [100 deg]}\nreport: [stable]\n");
  RUN_GOOD("study judged.yaml --quiet -o judged");
  EXPECT(contains("judged/study.csv", ",100,,"), "the column stable is empty");
  EXPECT(contains("judged/study.csv", "stable is not known"), "its warning");
}

/* A run from the orbit goes on as it, cycle by cycle, until an event comes, which counts its time
 * from the run's beginning. */
static void a_run_begins_there(void) {
  write_file("dip.yaml", "start: steady\nfiring: {every: 1}\nrun: {until: 0.1 s, tier: circuit}\n"
                         "events: {dip: {kind: sag, at: 70 ms}}\n");
  RUN_GOOD("run dip.yaml --quiet -o dip");
  double off[2] = {0}, scale = 2.078e-3;
  size_t n;
  double *p = column("dip/run.csv", "p_m", &n);
  EXPECT(n == 1001, "%zu rows", n);
  for (size_t k = 0; k < n; k++) off[k > 700] = fmax(off[k > 700], fabs(p[k] - p[k % 200]) / scale);
  free(p);
  /* 5 times what the orbit is known to at 1e-4 */
  EXPECT(off[0] < 5e-6 && off[1] > 1e-3, "off by %g, then by %g", off[0], off[1]);
  EXPECT(contains("dip/events.csv", "0.07,dip begins"), "the event's time");
  EXPECT(contains("dip/summary.json", "\"steady\": true"), "summary.json");
}

/* Who looks for an orbit while a run settles ends with that run: the scene, as that of the next
 * case of a study, has nothing of it left. */
static void no_search_is_left(void) {
  char *sets[] = {"firing.every=1"};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_measured *measured = vs_alloc(1, sizeof *measured);
  vs_error err = {0};
  const vs_session session = {0};
  vs_status status = vs_scene_read("paper", sets, 1, "circuit", scene, &err);
  if (!status) status = vs_measured_run(measured, scene, 1, &session, &err);
  EXPECT(!status && measured->steady.picard && !scene->order.pilot, "%s", err.text);
  vs_measured_free(measured);
  vs_scene_free(scene);
  free(measured);
  free(scene);
}

/* With a stop, and the orbits of period 1 and 3 that are stable there. At 80 degrees tier switched
 * keeps off the stop; the circuit does not, and the machine, marched on for 200 cycles, comes back
 * after 5. At 60 degrees the swing's own Phi would drive the armature through its stop. At 1e-3
 * four of nine such orbits have multipliers that are not known well enough to tell. */
static void with_a_stop(void) {
  static const struct {
    const char *words;
    int status;
    const char *says;
  } ROWS[] = {
      {"1e-4 --set firing.angle=82deg", 0, "\"stable\": true"},
      {"1e-4 --set firing.angle=66deg --period 3", 0, "\"stable\": true"},
      {"1e-3 --set firing.angle=80deg", 1, "after 5 periods; try --period 5"},
      {"1e-3 --set firing.angle=60deg", 1, "`steady --period 2` reports"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("steady paper --tier circuit --set firing.every=1 --set actuator.stop={} --set "
                "run.verify=never --json --quiet --set run.tolerance=%s",
                ROWS[k].words);
    EXPECT(r.status == ROWS[k].status && strstr(r.status ? r.err : r.out, ROWS[k].says),
           "%s: %d %s", ROWS[k].words, r.status, r.err);
    EXPECT(r.status || number_in(r.out, "correction") <= 1e-5, "%s", ROWS[k].words);
    free_ran(&r);
  }
}

/* A copy that is pushed aside may meet the stop otherwise than the orbit does. At a coarse
 * tolerance pushes to one side alone gave largest multipliers of 1.0026 to 1.82 in these scenes,
 * known to 0.001. At 1e-4 they are below 1. */
static void not_unstable(void) {
  static const char *const ANGLES[] = {"82", "95", "95.5"};
  for (size_t k = 0; k < COUNT(ANGLES); k++) {
    ran r = run("steady paper --tier circuit --set firing.every=1 --set actuator.stop={} --set "
                "run.tolerance=1e-2 --set run.verify=never --set firing.angle=%sdeg --json --quiet",
                ANGLES[k]);
    EXPECT(!r.status && !strstr(r.out, "\"stable\": false"), "%s: %d %s", ANGLES[k], r.status,
           r.err);
    free_ran(&r);
  }
}

/* The same bytes again, and for an orbit of a machine that is another. */
static void the_same_again(void) {
  static const char WORDS[] =
      "steady two_mass --tier circuit --set firing.every=1 --set "
      "firing.angle=130deg --set run.tolerance=1e-3 --reproducible --quiet --json";
  ran one = run("%s", WORDS), other = run("%s", WORDS);
  EXPECT(one.status == 0 && !strcmp(one.out, other.out), "%d %s", one.status, one.err);
  free_ran(&one), free_ran(&other);
}

static void circuit_refused(void) {
  static const struct {
    const char *words;
    int status;
    const char *says[2];
  } ROWS[] = {
      {"--set firing.every=1 --period 2", 1, {"period 2", "--period 1"}},
      {"--set firing.every=1 --period 0", 2, {"--period", "allowed"}},
      {"", 2, {"firing.every", "once"}},
      {"--set firing.every=1 --set firing.angle=75deg", 1, {"in cycle", "pole cover"}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("steady paper --tier circuit %s --quiet -o out", ROWS[k].words);
    EXPECT(r.status == ROWS[k].status && !*r.out && count_lines(r.err) == 1 &&
               strstr(r.err, ROWS[k].says[0]) && strstr(r.err, ROWS[k].says[1]),
           "%s: %d %s%s", ROWS[k].words, r.status, r.out, r.err);
    free_ran(&r);
  }
}

static const vs_test TESTS[] = {
    {"the conveyor at 100 degrees", the_conveyor_at_100_degrees},
    {"other machines", other_machines},
    {"without a valve", without_a_valve},
    {"a slow supply", a_slow_supply},
    {"a firing in every second cycle", a_firing_in_every_second_cycle},
    {"nothing is found", nothing_is_found},
    {"a subharmonic is named", a_subharmonic_is_named},
    {"refused", refused},
    {"forces on the foundation", forces_on_the_foundation},
    {"files of one period", files_of_one_period},
    {"a run begins on the orbit", a_run_begins_on_the_orbit},
    {"periods are alike", periods_are_alike},
    {"a case begins on the orbit", a_case_begins_on_the_orbit},
    {"an event at work", an_event_at_work},
    {"studies that ship", studies_that_ship},
    {"who computes does not matter", who_computes_does_not_matter},
    {"the page", the_page},
    {"circuit: at 100 degrees", at_100_degrees},
    {"compiled: at 100 degrees", at_100_degrees_on_tier_compiled},
    {"circuit: at other angles", at_other_angles},
    {"circuit: a flux that creeps", a_flux_that_creeps},
    {"circuit: a run begins there", a_run_begins_there},
    {"circuit: no search is left", no_search_is_left},
    {"circuit: with a stop", with_a_stop},
    {"circuit: not unstable", not_unstable},
    {"circuit: what no probe shows", what_no_probe_shows},
    {"circuit: the same again", the_same_again},
    {"circuit: refused", circuit_refused},
};

/* Those on tier circuit are the last ones. */
int main(void) {
  enum { ON_CIRCUIT = 10 };
  return program_suite("steady", TESTS, COUNT(TESTS) - (is_for_memory_alone() ? ON_CIRCUIT : 0));
}
