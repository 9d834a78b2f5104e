/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a verdict leaves out: limits that decide and that a real part does not state, the scene's
 * key waive, and the corners of its key spread. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

/* A varistor of 100 ohm across the mains of 100 V rms, with the limits given. It draws 1.414 A. */
static void write_deck(const char *limits) {
  vs_text part = {0};
  vs_text_add(&part,
              "*$ part varistor \"V\"\n%s.subckt vv a b\nR1 a b {100*varistor_scale}\n.ends\n"
              ".include varistor_scale.inc\n",
              limits);
  write_file("vv.inc", part.text);
  vs_text_free(&part);
  write_file("v.cir", "*$ param varistor_1 = vv part\n*$ port mains = Vm\n*$ probe v_r = v(a) V\n"
                      "*$ device varistor_1 = v(a), i(Vs)\n*$ line a\nVm a 0 external\nVs a b 0\n"
                      "Xv b 0 varistor_1\nRe a e 1meg\nXeva e 0 eva\n");
}

#define RUN                                                                                        \
  "run paper --set circuit.deck=v.cir --set supply.voltage=100V --set firing.every=1 --set "       \
  "run.until=40ms "

#define ALL "*$ limit i_surge = 2 A\n*$ limit energy = 100 J\n*$ limit p_max = 200 W\n"

/* One limit short: undecided, and the line says which. A part that says none, states it. A part
 * that states nothing is an ideal one, and a waived limit is left out. */
static void a_limit_short(void) {
  static const struct {
    const char *limits, *more, *says;
    int status;
  } ROWS[] = {
      {ALL, "", "verdict: held", 0},
      {"*$ limit i_surge = 2 A\n*$ limit energy = 100 J\n", "",
       "\nundecided: varistor_1.power: vv states no p_max; waive: [varistor_1.power] leaves it out",
       3},
      {"*$ limit i_surge = 2 A\n*$ limit energy = 100 J\n", "--set waive=varistor_1.power",
       "\nwaived: varistor_1.power\n", 0},
      {"*$ limit i_surge = 2 A\n*$ limit energy = 100 J\n", "--set waive=varistor_1.p_max",
       "\nwaived: varistor_1.p_max\n", 0},
      {"*$ limit i_surge = 2 A\n*$ limit energy = 100 J\n*$ limit p_max = none\n", "",
       "verdict: held", 0},
      {"*$ limit p_max = none\n", "", "verdict: none", 0},
      {"*$ limit i_surge = 1 A\n*$ limit energy = 100 J\n*$ limit p_max = 200 W\n", "",
       "verdict: violated", 3},
      {"*$ limit i_surge = 1 A\n*$ limit energy = 100 J\n*$ limit p_max = 200 W\n",
       "--set 'waive=[varistor_1.i_surge]'", "  waived\n", 0}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_deck(ROWS[k].limits);
    ran r = run(RUN "%s", ROWS[k].more);
    EXPECT(r.status == ROWS[k].status && strstr(r.out, ROWS[k].says), "%zu: %d %s%s", k, r.status,
           r.out, r.err);
    EXPECT(!strstr(r.err, "its line is undecided") == !strstr(r.out, "\nundecided: "), "%zu: %s", k,
           r.err);
    free_ran(&r);
  }
}

/* A part that states limits and with which no device goes: nothing is held to them, whatever the
 * deck rates besides. An ideal part needs no device. */
static void a_part_without_a_device(void) {
  static const struct {
    const char *limits, *verdict;
    int status;
  } ROWS[] = {{ALL, "verdict: undecided\n", 3}, {"*$ limit p_max = none\n", "verdict: held\n", 0}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_deck(ROWS[k].limits);
    write_file("v.cir", "*$ param varistor_1 = vv part\n*$ port mains = Vm\n*$ probe v_r = v(a) V\n"
                        "*$ rating v_r -200..200 V\n*$ line a\nVm a 0 external\nXv a 0 varistor_1\n"
                        "Re a e 1meg\nXeva e 0 eva\n");
    ran r = run(RUN);
    EXPECT(r.status == ROWS[k].status && strstr(r.out, ROWS[k].verdict), "%zu: %d %s%s", k,
           r.status, r.out, r.err);
    EXPECT(!k == !!strstr(r.err, "the limits of varistor_1 are held to nothing, as no line '*$ "
                                 "device' of the deck watches this part"),
           "%zu: %s", k, r.err);
    free_ran(&r);
  }
}

static void json_and_study_say_it(void) {
  write_deck("*$ limit i_surge = 2 A\n");
  ran r = run(RUN "--json --set 'waive=[varistor_1.energy]'");
  EXPECT(r.status == 3 && strstr(r.out, "\"unknown\": \"vv states no p_max\"") &&
             strstr(r.out, "\"waived\": [\"varistor_1.energy\"]") &&
             strstr(r.out, "\"word\": \"waived\"") && strstr(r.out, "\"corners\": null"),
         "%s%s", r.out, r.err);
  EXPECT(strstr(r.err, "undecided: varistor_1.power: vv states no p_max"), "%s", r.err);
  free_ran(&r);
  write_file("w.yaml", "scene: paper\nset: {circuit.deck: v.cir, supply.voltage: 100 V, "
                       "firing.every: 1, run.until: 40 ms, waive: [varistor_1.energy, "
                       "varistor_1.power]}\nvary: {supply.phase: [0 deg]}\nreport: [i_peak]\n");
  r = run("study w.yaml -o w --quiet --overwrite");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  free_ran(&r);
  char *csv = read_file("w/study.csv");
  EXPECT(strstr(csv, "varistor_1.energy, varistor_1.power (waived)"), "%s", csv);
  free(csv);
}

static void what_is_wrong_is_refused(void) {
  static const struct {
    const char *text, *says;
  } ROWS[] = {{"waive: [varistor_9.power]", "did you mean 'varistor_1'?"},
              {"waive: [varistor_1.pover]", "is no limit of a varistor; there are: "},
              {"waive: [varistor_1.energy_total]", "is no limit of a varistor"},
              {"waive: [varistor_1]", "a device and its measure or limit are wanted"},
              {"waive: [varistor_1.power, varistor_1.power]", "a second time"},
              {"waive: {varistor_1: power}", "a list is wanted"},
              {"spread: {supply.voltge: 10 %}", "did you mean 'supply.voltage'?"},
              {"spread: {supply.voltage: 10 ohm}", "a tolerance is '10 %' or in V"},
              {"spread: {supply.voltage: 0 %}", "a tolerance above 0 is wanted"},
              {"spread: {supply.phase: 3 %}", "no part of a value of 0"},
              {"spread: {firing.every: 1}", "has no number"},
              {"spread: 10 %", "a map is wanted"}};
  write_deck(ALL);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[256];
    snprintf(text, sizeof text, "circuit: {deck: v.cir}\nfiring: {every: 1}\n%s\n", ROWS[k].text);
    write_file("bad.yaml", text);
    ran r = run("check bad.yaml");
    EXPECT(r.status == 2 && !strncmp(r.err, "bad.yaml:3:", 11) && strstr(r.err, ROWS[k].says),
           "%s: status %d, %s", ROWS[k].text, r.status, r.err);
    free_ran(&r);
  }
}

/* 1.414 A at the nominal mains; 1.556 A at 10 % more, and 1.728 A where the resistance is 10 % less
 * besides. A limit between these breaks at one of four corners, one above it at none. */
static void corners(void) {
  static const struct {
    const char *limit;
    int held;
  } ROWS[] = {{"1.75 A", 4}, {"1.65 A", 3}};
  char limits[256], held[64];
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    snprintf(limits, sizeof limits,
             "*$ limit i_surge = %s\n*$ limit energy = 100 J\n*$ limit p_max = 200 W\n",
             ROWS[k].limit);
    write_deck(limits);
    ran r = run(RUN "--corners");
    snprintf(held, sizeof held, "\ncorners: %d of 4 held", ROWS[k].held);
    EXPECT(r.status == (ROWS[k].held < 4 ? 3 : 0) && strstr(r.out, held) &&
               !strncmp(r.out, "verdict: held", 13),
           "%d %s%s", r.status, r.out, r.err);
    free_ran(&r);
    r = run(RUN "--corners --json");
    const char *worst = strstr(r.out, "\"worst\": {\"at\": {\"supply.voltage\": {\"value\": 110, "
                                      "\"unit\": \"V\"}, \"circuit.varistor_scale\": {\"value\": "
                                      "0.9, \"unit\": \"\"}}, \"line\": \"varistor_1.i_peak\"");
    EXPECT(worst, "%s%s", r.out, r.err);
    const char *margin = worst ? strstr(worst, "\"margin\": ") : NULL;
    const double limit = strtod(ROWS[k].limit, NULL); /* 1e-3: run.tolerance is 1e-4 */
    CLOSE_OF(margin ? strtod(margin + strlen("\"margin\": "), NULL) : NAN,
             1 - sqrt(2) * 1.1 / 0.9 / limit, 1, 1e-3);
    free_ran(&r);
  }
  ran r = run(RUN "--set 'spread={supply.voltage: 1 V}' --corners");
  EXPECT(r.status == 0 && strstr(r.out, "\ncorners: 2 of 2 held"), "%d %s%s", r.status, r.out,
         r.err);
  free_ran(&r);
  r = run(RUN);
  EXPECT(strstr(r.out, "\nnominal values; corners not judged\n"), "%s", r.out);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"a limit short", a_limit_short},
    {"a part without a device", a_part_without_a_device},
    {"JSON and study say it", json_and_study_say_it},
    {"what is wrong is refused", what_is_wrong_is_refused},
    {"corners", corners},
};
int main(void) {
  return program_suite("waive", TESTS, COUNT(TESTS));
}
