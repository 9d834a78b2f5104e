/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is reported of a machine at work besides its motion: what devices bear where a period comes
 * again for ever, against closed forms; and studies of orbits, against the command steady. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "engine/sim.h"
#include "orbit/heat.h"
#include "program.h"

/* ---- devices ---- */

/* A part with the lines given bears 10 V and 10 A from 1 ms to 11 ms of each period. */
static vs_trial *bear(const char *lines, const char *until, bool at_work) {
  char part[400];
  snprintf(part, sizeof part,
           "*$ part thyristor \"P\"\n%s.subckt p a k g\nR1 a k 1meg\nR2 g k 1k\n.ends\n", lines);
  write_file("p.inc", part);
  write_file("d.cir",
             "*$ param t = p part\n*$ device t = v(x), i(Vs)\n*$ device r resistor = v(x), "
             "i(Vs)\n*$ device c capacitor = v(x), i(Vs)\nIs 0 y PWL(0 0 1m 0 1.0001m 10 11m 10 "
             "11.0001m 0)\nVs y x 0\n"
             "Rx x 0 1\nRe e 0 1\nXeva e 0 eva\n");
  const char *sets[] = {"circuit.deck=d.cir", until, "run.max_step=20us", NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", sets);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  t->scene.setup.at_work = at_work;
  t->scene.frame = vs_sim_frame(t->scene.tier, &t->scene.setup);
  vs_trial_go(t, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  return t;
}

static const vs_reduced *measure(const vs_trial *t, const char *what) {
  const vs_watched *w = &t->result.watchers.devices->item[0];
  for (size_t n = 0; n < w->count; n++)
    if (!strcmp(w->reduced[n].measure->name, what)) return &w->reduced[n];
  CU_FAIL_FATAL("no such measure");
  return NULL;
}

/* Once warm, a term that 100 W heat for 10 ms of every T reaches, as the pulse ends,
 * 100 W R (1 - e^(-10 ms/tau))/(1 - e^(-T/tau)). 2e-5: the edges of 0.1 us. */
static double warm_k(double k_per_w, double tau_s, double period_s) {
  return 100 * k_per_w * expm1(-10e-3 / tau_s) / expm1(-period_s / tau_s);
}

static const char ZTH[] = "*$ zth 0.5 K/W 1 ms\n*$ zth 1 K/W 20 ms\n*$ zth 2 K/W 30 s\n"
                          "*$ limit t_j_max = 125 degC\n*$ limit i_t_rms = 6 A\n";

static void a_junction_at_work(void) {
  const double period_s = 20e-3;
  const double most =
      warm_k(0.5, 1e-3, period_s) + warm_k(1, 20e-3, period_s) + warm_k(2, 30, period_s);
  vs_trial *t = bear(ZTH, "run.until=20ms", true);
  CLOSE(measure(t, "t_j_rise")->value.value, most, 2e-5);
  CLOSE(measure(t, "t_j_rise")->value.at_s, 11e-3, 2e-4);
  static const char *const NAMES[] = {"t.power", "t.t_j_rise_mean", "t.t_case_max"};
  const double values[] = {50, 50 * 3.5, 125 - most};
  vs_heat heat;
  int k = 0;
  for (; vs_heat_at(t->result.watchers.devices, period_s, k, &heat) && k < (int)COUNT(NAMES); k++) {
    CU_ASSERT_STRING_EQUAL(heat.name, NAMES[k]);
    CLOSE(heat.value.value, values[k], 2e-5);
  }
  CU_ASSERT_EQUAL(
      k, COUNT(NAMES)); /* the resistor has a measure power of its own, the capacitor no heat */
  vs_trial_free(t);
  t = bear(ZTH, "run.until=20ms", false); /* from cold */
  double cold = 100 * (0.5 * -expm1(-10) - expm1(-0.5) + 2 * -expm1(-10e-3 / 30));
  CLOSE(measure(t, "t_j_rise")->value.value, cold, 2e-5);
  vs_trial_free(t);
}

/* A rise that is over the limit in the periodic state alone is told so, at its time; a continuous
 * rating is judged though the run is short and has one shot. */
static void limits_at_work(void) {
  char lines[400];
  snprintf(lines, sizeof lines, "%s*$ limit t_j_rise = 100 K\n", ZTH);
  vs_trial *t = bear(lines, "run.until=20ms", true);
  CU_ASSERT(measure(t, "t_j_rise")->value.value > 100 && measure(t, "t_j_rise")->failed_s < 11e-3);
  CLOSE(measure(t, "i_rms")->value.value, sqrt(50), 2e-5);
  CU_ASSERT(!measure(t, "i_rms")->unjudged && measure(t, "i_rms")->failed_s > 0);
  vs_trial_free(t);
  t = bear(lines, "run.until=20ms", false);
  CU_ASSERT(isnan(measure(t, "t_j_rise")->failed_s) && measure(t, "i_rms")->unjudged);
  vs_trial_free(t);
}

/* Without t_j_max nothing is said of the case, without zth nothing of the junction. */
static void what_is_not_known(void) {
  vs_heat heat;
  vs_trial *t = bear("*$ zth 0.5 K/W 1 ms\n", "run.until=20ms", true);
  int k = 0;
  while (vs_heat_at(t->result.watchers.devices, 20e-3, k, &heat)) k++;
  CU_ASSERT_EQUAL(k, 2);
  vs_trial_free(t);
  t = bear("*$ limit t_j_max = 125 degC\n", "run.until=20ms", true);
  CU_ASSERT(vs_heat_at(t->result.watchers.devices, 20e-3, 0, &heat) &&
            !vs_heat_at(t->result.watchers.devices, 20e-3, 1, &heat));
  vs_trial_free(t);
  CU_ASSERT_FALSE(vs_heat_at(NULL, 20e-3, 0, &heat));
}

/* 125 degC are no 125 K. */
static void a_temperature_is_no_difference(void) {
  write_file("p.inc",
             "*$ part thyristor \"P\"\n*$ limit t_j_rise = 50 degC\n.subckt p a k g\nR1 a k "
             "1meg\nR2 g k 1k\n.ends\n");
  const char *sets[] = {"circuit.deck=d.cir", NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", sets);
  EXPECT(t->status == VS_INPUT && strstr(t->err.text, "a unit as K is wanted"), "%s", t->err.text);
  vs_trial_free(t);
}

/* ---- studies of orbits ---- */

/* The cell of that row and column; "": there is none. */
static void cell_of(const char *csv, const char *begins, const char *column, char out[64]) {
  *out = '\0';
  char *copy = vs_copy(csv), *rest = copy, *head = strsep(&rest, "\n"), *row = NULL, *name, *value;
  while (rest && (row = strsep(&rest, "\n")) && strncmp(row, begins, strlen(begins)) != 0) {
  }
  while (row && (name = strsep(&head, ",")) && (value = strsep(&row, ",")))
    if (!strcmp(name, column)) snprintf(out, 64, "%s", value);
  free(copy);
}

static double cell(const char *csv, const char *begins, const char *column) {
  char text[64];
  cell_of(csv, begins, column, text);
  return *text ? strtod(text, NULL) : NAN;
}

/* A row has what the command prints, to the 12 digits of both. */
static void rows_are_orbits(void) {
  static const struct {
    const char *key, *column;
  } ROWS[] = {{"p_min", "p_min_m"},
              {"power_in", "power_in_w"},
              {"i_rms", "i_rms_a"},
              {"i_mean", "i_mean_a"},
              {"power_factor", "power_factor"},
              {"energy_in", "energy_in_j"},
              {"reaction_u_rms", "reaction_u_rms_n"},
              {"reaction_phi", "reaction_phi_n_m"},
              {"worst_part", "harmonic_part"}};
  write_file("s.yaml", "set: {firing.every: 1, run.tier: switched, run.until: 3 s}\nsteady: true\n"
                       "vary: {firing.angle: [100 deg, 120 deg]}\n");
  ran r = run("study s.yaml --quiet"),
      orbit = run("steady paper --set firing.every=1 --set firing.angle=120deg --json --quiet");
  CU_ASSERT(r.status == 0 && orbit.status == 0);
  for (size_t k = 0; k < COUNT(ROWS); k++)
    CLOSE(cell(r.out, "1,", ROWS[k].column), number_in(orbit.out, ROWS[k].key), 1e-11);
  double re = number_in(orbit.out, "re"), im = number_in(orbit.out, "im");
  CLOSE(cell(r.out, "1,", "multiplier_max"), hypot(re, im), 1e-11);
  CU_ASSERT_EQUAL(cell(r.out, "0,", "stable"), 1);
  CLOSE(cell(r.out, "0,", "p_min_m"), -0.0021377328283, 1e-10);
  free_ran(&orbit);
  /* a list of columns, harmonics among them, machines.md's numbers; and an id of their own */
  ran one = run("study s.yaml --quiet --set report=[harmonic_0,harmonic_2]"),
      plain = run("study s.yaml --quiet --set steady=false --set run.until=20ms");
  CLOSE(cell(one.out, "0,", "harmonic_0_a"), 0.17462090569, 1e-9);
  CLOSE(cell(one.out, "0,", "harmonic_2_a"), 0.1113614025, 1e-9);
  char here[64], there[64];
  cell_of(one.out, "0,", "id", here), cell_of(plain.out, "0,", "id", there);
  CU_ASSERT_STRING_NOT_EQUAL(here, there);
  CU_ASSERT_PTR_NULL(strstr(plain.out, "power_in"));
  free_ran(&r), free_ran(&one), free_ran(&plain);
}

/* Who computes does not matter; --keep runs stores one period; what fails leaves the next alone. */
static void by_anyone(void) {
  write_file("w.yaml", "set: {firing.every: 1, run.tier: switched}\nsteady: {period: 1}\n"
                       "vary: {firing.angle: [70 deg, 90 deg, 100 deg, 110 deg, 120 deg]}\n");
  static const char *const LINES[] = {
      "study w.yaml --jobs 1 --quiet -o one --keep runs", "study w.yaml --jobs 2 --quiet -o two",
      "study w.yaml --shard 1/2 --quiet -o parts/1", "study w.yaml --shard 2/2 --quiet -o parts/2",
      "merge parts --quiet -o merged"};
  for (size_t k = 0; k < COUNT(LINES); k++) {
    ran r = run("%s", LINES[k]);
    EXPECT(r.status == (k == 3 ? 0 : 1), "%s: %d %s", LINES[k], r.status, r.err);
    free_ran(&r);
  }
  char *one = read_file("one/study.csv"), *two = read_file("two/study.csv"),
       *merged = read_file("merged/study.csv"), *failures = read_file("one/failures.csv"),
       *kept = read_file("one/runs/2/run.csv");
  CU_ASSERT_EQUAL(count_lines(one), 5);
  CU_ASSERT_EQUAL(count_lines(failures), 2);
  CU_ASSERT(strstr(failures, "pole cover") && strstr(failures, "actuator.stop={}"));
  CU_ASSERT_STRING_EQUAL(one, two);
  CU_ASSERT_STRING_EQUAL(one, merged);
  CU_ASSERT(strstr(kept, "\n0.02,") && !strstr(kept, "\n0.0201,"));
  free(one), free(two), free(merged), free(failures), free(kept);
}

/* A machine that feeds itself stays on no orbit: that is no plain row. Whoever asks for the column
 * `stable` reads it there. Of another period than was asked for there is none. */
static void no_plain_row(void) {
  write_file("fed.yaml", "title: a mass that feeds itself\ncoordinates: {x: {unit: m}}\n"
                         "parameters: {m: {default: 1 kg}, k: {default: 100 kN/m}}\n"
                         "let: {c: 2 N.s/m}\nmass: m\ndamping: -c\nstiffness: k\n"
                         "gap: {along: {x: 1}}\n");
  write_file(
      "f.yaml",
      "machine: {model: fed.yaml}\nsupply: {voltage: 440 V}\nfiring: {every: 1, angle: 120 deg}\n"
      "run: {tier: switched}\n");
  write_file("fs.yaml", "scene: f.yaml\nsteady: true\nvary: {firing.angle: [160 deg, 165 deg]}\n");
  ran r = run("study fs.yaml --quiet");
  EXPECT(r.status == 1 && count_lines(r.out) == 1 && count_lines(r.err) == 1, "%d %s%s", r.status,
         r.out, r.err);
  free_ran(&r);
  r = run("study fs.yaml -o fs --quiet");
  char *failures = read_file("fs/failures.csv");
  EXPECT(strstr(failures, "unstable") && strstr(failures, "1.020"), "%s", failures);
  free(failures), free_ran(&r);
  r = run("study fs.yaml --quiet --set report=[stable,multiplier_max]");
  CU_ASSERT_EQUAL(r.status, 0);
  CU_ASSERT_EQUAL(cell(r.out, "0,", "stable"), 0);
  CLOSE(cell(r.out, "0,", "multiplier_max"), exp(0.02),
        1e-4); /* c/(2 m) = 1/s; the coil's own force is a weak spring */
  free_ran(&r);
  r = run("study s.yaml --set steady.period=2 -o none --quiet");
  failures = read_file("none/failures.csv");
  EXPECT(r.status == 1 && strstr(failures, "period 2"), "%d %s", r.status, failures);
  free(failures), free_ran(&r);
}

static void a_search_over_orbits(void) {
  write_file("b.yaml", "set: {firing.every: 1, run.tier: switched}\nsteady: true\n"
                       "vary: {firing.angle: {from: 90 deg, to: 140 deg}}\n"
                       "find: {worst: max power_in, n: 12}\nreport: [power_in]\n");
  ran r = run("study b.yaml --quiet");
  CU_ASSERT(r.status == 0 && count_lines(r.out) == 13);
  free_ran(&r);
}

/* ---- what is refused ---- */

static void refused(void) {
  static const struct {
    const char *lines, *at, *says[2];
  } CASES[] = {
      {"steady: yes\n", "r.yaml:2:9: ", {"true", "{period: N}"}},
      {"steady: [1]\n", "r.yaml:2:10: ", {"true", "{period: N}"}},
      {"steady: {periods: 2}\n", "r.yaml:2:10: ", {"periods", "'period'"}},
      {"steady: {period: 0}\n", "r.yaml:2:18: ", {"period", "from 1"}},
      {"steady: {}\nset: {firing.every: once}\n", "r.yaml:2:1: ", {"firing.every", "once"}},
      {"steady: {}\nset: {firing.every: 1, run.tier: analytic}\n",
       "r.yaml:2:1: ",
       {"analytic", "tier"}},
      {"steady: {}\nset: {firing.every: 1}\nreport: [powr_in]\n",
       "r.yaml:4:10: ",
       {"powr_in", "'power_in'"}},
      {"set: {firing.every: 1}\nreport: [power_in]\n", "r.yaml:3:10: ", {"power_in", "measure"}},
      {"vary: {start: [steady]}\n", "r.yaml:2:8: ", {"start.p", "set: {start: steady}"}},
      {"vary: {firing: [1]}\n", "r.yaml:2:8: ", {"firing has keys of its own", "firing."}},
      {"set: {start: steady, firing.every: 1, run.tier: switched}\nvary: {start.p: [0 mm, 1 mm]}\n",
       "r.yaml:3:8: ",
       {"start.p", "start: steady"}},
  };
  for (size_t k = 0; k < COUNT(CASES); k++) {
    char text[300];
    bool varied = strstr(CASES[k].lines, "vary");
    snprintf(text, sizeof text, "scene: paper\n%s%s", CASES[k].lines,
             varied ? "" : "vary: {firing.angle: [100 deg, 110 deg]}\n");
    write_file("r.yaml", text);
    refuse("study r.yaml", CASES[k].lines, CASES[k].at, CASES[k].says, __LINE__);
  }
}

/* ---- across the period's end ---- */

static double member(const char *json, const char *name, const char *key) {
  char text[64];
  snprintf(text, sizeof text, "\"%s\": {", name);
  const char *at = strstr(json, text);
  snprintf(text, sizeof text, "\"%s\": ", key);
  at = at ? strstr(at, text) : NULL;
  return at ? strtod(at + strlen(text), NULL) : NAN;
}

/* In a bridge at 110 degrees the second thyristor carries the coil's current across the period's
 * end, as the first one does across its middle: what the one does, so does the other. Both half
 * waves are alike but for the steps of the solver: 1e-4 is run.tolerance; t_off, which the ringing
 * behind the conduction decides, agrees less well. */
static void two_thyristors_alike(void) {
  static const char *const SAME[] = {"i2t", "i_surge", "t_off", "i_rms", "loss"};
  ran r = run("steady paper --set firing.every=1 --set firing.angle=110deg --set "
              "supply.voltage=100V --set circuit.deck=bridge_halfcontrolled --json --quiet");
  EXPECT(r.status == 0, "%s", r.err);
  for (size_t k = 0; k < COUNT(SAME); k++) {
    char first[32], second[32];
    snprintf(first, sizeof first, "t1.%s", SAME[k]);
    snprintf(second, sizeof second, "t2.%s", SAME[k]);
    CLOSE(member(r.out, second, "value"), member(r.out, first, "value"), 2e-4);
  }
  CU_ASSERT(member(r.out, "t1.unintended_firings", "value") == 0);
  CU_ASSERT(member(r.out, "t2.unintended_firings", "value") == 0);
  CU_ASSERT(member(r.out, "t2.i2t", "at_s") < 1e-3);
  /* of t2's, too, which goes out in the next period */
  CU_ASSERT(member(r.out, "conduction_time", "value") > 0);
  CU_ASSERT(member(r.out, "t_extinction", "value") > member(r.out, "t_fire", "value"));
  free_ran(&r);
}

/* Without a snubber forward voltage is back where the mains rise through zero, at the period's end:
 * the time offered is what is left of the period behind the extinction, within a step. */
static void rest_at_the_end(void) {
  ran r = run("steady paper --set firing.every=1 --set firing.angle=100deg --set "
              "circuit.deck=halfwave_bare --json --quiet");
  EXPECT(r.status == 0, "%s", r.err);
  double out_s = member(r.out, "t_extinction", "value");
  CLOSE(member(r.out, "thyristor.t_off", "value"), 20e-3 - out_s, 1e-3);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"a junction at work", a_junction_at_work},
    {"limits at work", limits_at_work},
    {"what is not known", what_is_not_known},
    {"a temperature is no difference", a_temperature_is_no_difference},
    {"rows are orbits", rows_are_orbits},
    {"by anyone", by_anyone},
    {"no plain row", no_plain_row},
    {"a search over orbits", a_search_over_orbits},
    {"refused", refused},
    {"two thyristors alike", two_thyristors_alike},
    {"a rest at the period's end", rest_at_the_end},
};

int main(void) {
  return program_suite("at_work", TESTS, COUNT(TESTS));
}
