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
       "--set 'waive=[varistor_1.i_surge]' --all", "  waived\n", 0}};
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
  } ROWS[] = {
      {"waive: [varistor_9.power]", "did you mean 'varistor_1'?"},
      {"waive: [varistor_1.pover]", "is no limit of a varistor; there are: "},
      {"waive: [varistor_1.energy_total]", "is no limit of a varistor"},
      {"waive: [varistor_1.power, varistor_1.power]", "a second time"},
      {"waive: {varistor_1: power}", "a list is wanted"},
      {"spread: {supply.voltge: 10 %}", "did you mean 'supply.voltage'?"},
      {"spread: {supply.voltage: 10 ohm}", "a tolerance is '10 %' or in V"},
      {"spread: {supply.voltage: 0 %}", "a tolerance above 0 is wanted"},
      {"spread: {supply.phase: 3 %}", "no part of a value of 0"},
      {"spread: {firing.every: 1}", "has no number"},
      {"spread: 10 %", "a map is wanted"},
      {"spread: {circuit.varistor_9_scale: 10 %}", "did you mean 'circuit.varistor_1_scale'?"},
      {"spread: {circuit.varistor_1_scale: 60 %}", "its end 0.4 is out of range; allowed: 0.5..2"},
      {"spread: {circuit.varistor_1_scale: tolerance}", "vv states no tolerance"},
      {"spread: {circuit.varistor_1_scale: tolerance and ageing}", "vv states no tolerance"},
      {"spread: {supply.voltage: ageing}", "no device of which a part states its ageing"},
      {"spread: {actuator.winding.temperature: 90 K}\nactuator: {winding: {temperature: 20 degC}}",
       "its end -70 degC is out of range"},
      {"spread: {supply.voltage: 5 s}", "a tolerance is '10 %' or in V"},
      {"spread: {supply.voltage: 1 %, supply.frequency: 1 %, supply.resistance: 1 %, "
       "supply.inductance: 1 %, firing.angle: 1 %, firing.pulse_width: 1 %, "
       "circuit.varistor_1_scale: 1 %}",
       "more than 6 keys, which are 64 corners"}};
  write_deck(ALL);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[512];
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
    const char *word = ROWS[k].held < 4 ? "verdict: violated at a corner, held at nominal values\n"
                                        : "verdict: held\n";
    ran r = run(RUN "--corners --all");
    snprintf(held, sizeof held, "\ncorners: %d of 4 held", ROWS[k].held);
    EXPECT(r.status == (ROWS[k].held < 4 ? 3 : 0) && strstr(r.out, held) &&
               !strncmp(r.out, word, strlen(word)),
           "%d %s%s", r.status, r.out, r.err);
    free_ran(&r);
    r = run(RUN "--corners --json");
    const char *worst = strstr(r.out, "\"worst\": {\"at\": {\"supply.voltage\": {\"value\": 110, "
                                      "\"unit\": \"V\"}, \"circuit.varistor_1_scale\": {\"value\": "
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

/* All of summary.json but its scene and its measures. */
static void summary_has_all_keys(void) {
  static const char BEFORE[] =
      "\n  \"tier\": \"circuit\",\n"
      "  \"why\": \"auto: the scene names circuit.deck, which only this tier has\",\n"
      "  \"rung\": {\"number\": #, \"text\": \"the scene as it is\", \"failed\": \"\"},\n"
      "  \"quiet\": {\"times\": #, \"first_at_s\": null, \"total_s\": #, \"bound\": #},\n"
      "  \"warnings\": [],\n  \"measure\": {\"from_s\": #, \"to_s\": #},\n  \"measures\": {\n";
#define CORNER(word)                                                                               \
  "{\"at\": {\"supply.voltage\": {\"value\": #, \"unit\": \"V\"}, \"circuit.varistor_1_scale\": "  \
  "{\"value\": #, \"unit\": \"\"}}, \"line\": \"varistor_1.i_peak\", \"margin\": #, "              \
  "\"margin_error\": #, \"word\": \"" word "\"}"
#define LIMITED(name)                                                                              \
  "    {\"device\": \"varistor_1\", \"measure\": " name                                            \
  ", \"text\": \"\", \"stress\": #, \"at_s\": #, "                                                 \
  "\"limit\": #, \"assumed\": false, \"margin\": #, \"margin_error\": #, \"word\": \"held\", "     \
  "\"violated\": false, \"failed_at_s\": null}"
  static const char BEHIND[] =
      "\n  },\n  \"energy\": {\"source_J\": #, \"eva_J\": #, \"copper_J\": #, "
      "\"work_force_J\": #, "
      "\"damping_J\": #, \"stop_J\": #, \"magnetic_J\": #, \"mechanical_J\": #, \"losses_J\": "
      "{}, "
      "\"stores_J\": {}, \"eva_residual\": #, \"mechanical_residual\": #, "
      "\"circuit_residual\": "
      "null, "
      "\"residual\": #, \"audit\": \"the books close\"},\n"
      "  \"cost\": {\"wall_s\": #, \"second_run_s\": #, \"steps\": #},\n"
      "  \"second_run\": {\"tolerance\": #, \"decides\": null, \"failed\": \"\"},\n"
      "  \"verdict\": [\n"
      "    {\"rating\": \"v_r\", \"unit\": \"kV\", \"text\": \"\", \"min\": #, \"max\": #, "
      "\"least\": #, "
      "\"least_at_s\": #, \"largest\": #, \"largest_at_s\": #, \"assumed\": false, "
      "\"margin\": #, "
      "\"margin_error\": #, \"word\": \"held\", \"violated\": false, \"failed_at_s\": "
      "null},\n" LIMITED("\"i_peak\", \"unit\": \"A\"") ",\n" LIMITED(
          "\"energy\", \"unit\": \"J\"") "\n  ],\n"
                                         "  \"weakest\": \"varistor_1.i_peak\",\n  "
                                         "\"first_to_fail\": null,\n  \"happened\": [],\n"
                                         "  \"did_not_happen\": [],\n  \"not_judged\": "
                                         "[\"varistor_1.power\"],\n  \"waived\": [],\n"
                                         "  \"columns\": [\n    {\"name\": \"t_s\", "
                                         "\"quantity\": \"t\", \"unit\": \"s\", "
                                         "\"role\": \"time\", \"of\": \"\"},\n";
  static const char LAST[] =
      "\n    {\"name\": \"v_r_v\", \"quantity\": \"v_r\", \"unit\": \"V\", \"role\": \"probe\", "
      "\"of\": \"circuit\"}\n  ],\n"
      "  \"corners\": {\n    \"of\": #,\n    \"held\": #,\n    \"failed\": #,\n"
      "    \"worst\": " CORNER("violated") ",\n    \"each\": [\n      " CORNER(
          "held") ",\n      " CORNER("violated") ",\n      " CORNER("held") ",\n      " CORNER("hel"
                                                                                               "d") "\n    ]\n  }\n}\n";
  write_deck("*$ limit i_surge = 1.65 A\n*$ limit energy = 100 J\n*$ limit p_max = 200 W\n");
  write_file("v.cir", "*$ param varistor_1 = vv part\n*$ port mains = Vm\n*$ probe v_r = v(a) V\n"
                      "*$ rating v_r -0.2..0.2 kV\n*$ device varistor_1 = v(a), i(Vs)\n*$ line a\n"
                      "Vm a 0 external\nVs a b 0\nXv b 0 varistor_1\nRe a e 1meg\nXeva e 0 eva\n");
  static const char TABLE[] =
      "\n  rating                     min       least     largest         max       margin +- its "
      "numerical error\n"
      "  v_r                       -0.2     -0.1414      0.1414         0.2 kV       29.3 % +- ";
  static const char DEVICES[] =
      "\n  device                  stress       limit                at margin +- its numerical "
      "error\n"
      "  varistor_1.i_peak        1.414        1.65 A        5.005 ms    14.3 % +- ";
  static const char CORNERS[] =
      "\ncorners: 3 of 4 held; the worst line of each:\n"
      "  supply.voltage = 90 V, circuit.varistor_1_scale = 0.9: varistor_1.i_peak    14.3 % +- ";
  ran r = run(RUN "--corners --all");
  EXPECT(strstr(r.out, "\n  varistor_1.v_clamp                141.4 V   at ") &&
             strstr(r.out, "\n  varistor_1.energy_total               4 J\n"),
         "%s", r.out);
  EXPECT(strstr(r.out, TABLE) && strstr(r.out, DEVICES) && strstr(r.out, CORNERS), "%s", r.out);
  free_ran(&r);
  r = run(RUN "--corners --json");
  EXPECT(strstr(r.out, "    \"of\": 4,\n    \"held\": 3,\n    \"failed\": 0,\n"), "%s", r.out);
  make_shape(r.out);
  EXPECT(strstr(r.out, BEFORE) && strstr(r.out, BEHIND) && strstr(r.out, LAST), "%s", r.out);
  free_ran(&r);
}

/* Two varistors of one part across the mains, each with its own current's source. */
static void write_two(const char *limits) {
  write_deck(limits);
  write_file("v.cir", "*$ param varistor = vv part\n*$ port mains = Vm\n*$ probe v_r = v(a) V\n"
                      "*$ device varistor_1 varistor = v(a), i(Vs)\n"
                      "*$ device varistor_2 varistor = v(a), i(Vt)\n*$ line a\nVm a 0 external\n"
                      "Vs a b 0\nVt a c 0\nXw c 0 varistor\nXv b 0 varistor\nRe a e 1meg\n"
                      "Xeva e 0 eva\n");
}

/* 1e-3: run.tolerance is 1e-4 of the current's peak, and a peak may stand between two steps. */
static void expect_peaks(const char *more, double first, double second) {
  ran r = run(RUN "--json %s", more);
  CLOSE_OF(measure_in(r.out, "varistor_1.i_peak"), first, first, 1e-3);
  CLOSE_OF(measure_in(r.out, "varistor_2.i_peak"), second, second, 1e-3);
  EXPECT(!!strstr(r.out, "\"varistor_1_scale\": {") == !!strstr(more, "varistor_1_scale"), "%s",
         r.out);
  free_ran(&r);
}

/* The factor of one varistor is its own, and multiplies that of all. A key that the scene does not
 * give, or gives as 1, is not told. */
static void each_by_itself(void) {
  write_two(ALL);
  expect_peaks("", sqrt(2), sqrt(2));
  expect_peaks("--set circuit.varistor_1_scale=0.8", sqrt(2) / 0.8, sqrt(2));
  expect_peaks("--set circuit.varistor_2_scale=1.25", sqrt(2), sqrt(2) / 1.25);
  expect_peaks("--set circuit.varistor_scale=0.9 --set circuit.varistor_1_scale=0.8 --set "
               "circuit.varistor_2_scale=1.25",
               sqrt(2) / 0.72, sqrt(2) / 1.125);
  ran r = run(RUN "--set circuit.varistor_1_scale=3");
  EXPECT(r.status == 2 && strstr(r.err, "circuit.varistor_1_scale: 3 is out of range; allowed: "),
         "%d %s", r.status, r.err);
  free_ran(&r);
}

/* The part of JSON's text from `name` on, up to `end`; to be freed. */
static char *stretch(const char *json, const char *name, const char *end) {
  const char *at = strstr(json, name), *to = at ? strstr(at, end) : NULL;
  return to ? strndup(at, (size_t)(to - at)) : strdup("");
}

/* The factors of all three discs of a shipped deck are the factor for all, to the byte: one
 * netlist has 0.9 where the other has 1 times 0.9. */
static void all_alike(void) {
  static const char *const SETS[] = {
      "--set circuit.varistor_scale=0.9",
      "--set circuit.varistor_1_scale=0.9 --set circuit.varistor_2_scale=0.9 --set "
      "circuit.varistor_3_scale=0.9"};
  char *told[2];
  for (int k = 0; k < 2; k++) {
    ran r = run("run paper --set circuit.deck=fullwave_antiparallel --set circuit.varistor=S20K275 "
                "--set supply.voltage=230V --set run.until=20ms --set run.verify=never --json %s",
                SETS[k]);
    told[k] = stretch(r.out, "\"measures\": {", "\"energy\": {");
    EXPECT(*told[k], "%s%s", r.out, r.err);
    free_ran(&r);
  }
  EXPECT(!strcmp(told[0], told[1]), "%s%s", told[0], told[1]);
  for (int k = 0; k < 2; k++) free(told[k]);
}

#define SHEET "*$ limit energy = 100 J\n*$ limit p_max = 200 W\n"

/* Without a key spread: the mains by 10 %, and each of two varistors by what its sheet states, 5 %
 * and 10 %. 110 V are 1.556 A, and 1.819 A over 0.95 times 0.9 of the resistance. So three of eight
 * corners are above 1.65 A: those at 110 V where one of them is low. The same bytes each time. */
static void corners_of_each(void) {
  write_two(SHEET "*$ limit i_surge = 1.65 A\n*$ limit tolerance = 5 %\n*$ limit ageing = 10 %\n");
  ran r = run(RUN "--corners --all");
  EXPECT(r.status == 3 && strstr(r.out, "\ncorners: 5 of 8 held; ") &&
             strstr(r.out, "  supply.voltage = 110 V, circuit.varistor_1_scale = 1.155, "
                           "circuit.varistor_2_scale = 0.855: varistor_2.i_peak   -10.3 %"),
         "%d %s", r.status, r.out);
  EXPECT(strstr(r.err, "3 of 8 corners do not hold; the worst is supply.voltage = 110 V, "), "%s",
         r.err);
  free_ran(&r);
  r = run(RUN "--corners --json --reproducible");
  ran again = run(RUN "--corners --json --reproducible");
  EXPECT(!strcmp(r.out, again.out), "%s%s", r.out, again.out);
  EXPECT(strstr(r.out, "\"of\": 8") && strstr(r.out, "\"held\": 5") &&
             strstr(r.out, "\"failed\": 0"),
         "%s", r.out);
  int lines = 0;
  const char *each = strstr(r.out, "\"each\": [");
  while (each && (each = strstr(each, "{\"at\": {\"supply.voltage\""))) lines++, each++;
  EXPECT(lines == 8, "%d %s", lines, r.out);
  free_ran(&r);
  free_ran(&again);
}

/* Two keys that go together are one spread: both are at their lesser end, or both at the larger
 * one. So the mains of a deck with a transformer are, where the scene does not say. */
static void two_together(void) {
  write_two(ALL);
  ran r =
      run(RUN "--corners --all --set 'spread={supply.voltage with circuit.varistor_scale: 10 %%}'");
  EXPECT(strstr(r.out, "\ncorners: 2 of 2 held; ") &&
             strstr(r.out, "\n  supply.voltage = 90 V, circuit.varistor_scale = 0.9: ") &&
             strstr(r.out, "\n  supply.voltage = 110 V, circuit.varistor_scale = 1.1: "),
         "%s%s", r.out, r.err);
  free_ran(&r);
  r = run("run paper --set circuit.deck=halfwave_paper --set run.until=0.1ms --set "
          "run.verify=never --corners --json --reproducible");
  EXPECT(strstr(r.out, "\"of\": 16") &&
             strstr(r.out, "{\"at\": {\"supply.voltage\": {\"value\": 396, \"unit\": \"V\"}, "
                           "\"circuit.line_voltage\": {\"value\": 207, \"unit\": \"V\"}, "
                           "\"circuit.varistor_1_scale\": {\"value\": 0.81, \"unit\": \"\"}, "),
         "%s%s", r.out, r.err);
  free_ran(&r);
}

/* What a spread says in words: a part's tolerance alone, or its ageing, or both. 1.65 A is 1.414 A
 * over 0.857. */
static void tolerance_in_words(void) {
  static const struct {
    const char *way;
    double least;
  } ROWS[] = {{"tolerance", 0.95}, {"ageing", 0.9}, {"tolerance and ageing", 0.855}};
  write_two(SHEET "*$ limit i_surge = 1.65 A\n*$ limit tolerance = 5 %\n*$ limit ageing = 10 %\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char at[64];
    ran r = run(RUN "--corners --all --set 'spread={circuit.varistor_2_scale: %s}'", ROWS[k].way);
    snprintf(at, sizeof at, "\n  circuit.varistor_2_scale = %g: varistor_2.i_peak ", ROWS[k].least);
    EXPECT(r.status == (ROWS[k].least < 0.857 ? 3 : 0) && strstr(r.out, at), "%d %s", r.status,
           r.out);
    free_ran(&r);
  }
}

/* A corner whose run fails is told, the others go on, and the status is 1: at 936 V the armature
 * meets its pole cover, at 24 V it does not. */
static void a_corner_fails(void) {
#define FAILS                                                                                      \
  "run paper --set run.until=100ms --set 'ratings={i_peak: .. 2 A}' --set supply.voltage=480V "    \
  "--set 'spread={supply.voltage: 95 %%}' --corners "
  ran r = run(FAILS "--all");
  EXPECT(r.status == 1 && strstr(r.out, "\ncorners: 1 of 2 held, 1 failed; ") &&
             strstr(r.out, "  supply.voltage = 936 V: failed: t = "),
         "%d %s", r.status, r.out);
  EXPECT(strstr(r.err, "1 of 2 corners failed; the first is supply.voltage = 936 V: t = "), "%s",
         r.err);
  free_ran(&r);
  r = run(FAILS "--json");
  EXPECT(r.status == 1 && strstr(r.out, "\"held\": 1") && strstr(r.out, "\"failed\": \"t = "),
         "%d %s", r.status, r.out);
  free_ran(&r);
}

/* What cannot be read at one end is refused before anything is run: c1 <= c2 holds at 1 uF each,
 * but not 10 % above. */
static void a_corner_is_refused(void) {
  write_deck(ALL);
  char *deck = read_file("v.cir");
  vs_text text = {0};
  vs_text_add(&text,
              "*$ param c1 = 1 uF 1e-3..10 \"C1\"\n*$ param c2 = 1 uF 1e-3..10 \"C2\"\n"
              "*$ require c1 <= c2 \"C1 first\"\n%s",
              deck);
  write_file("v.cir", text.text);
  vs_text_free(&text);
  free(deck);
  ran r = run(RUN "--set 'spread={circuit.c1: 10 %%}' --corners");
  EXPECT(r.status == 2 && !*r.out && strstr(r.err, "the corner circuit.c1 = 1.1 uF: "), "%d %s%s",
         r.status, r.out, r.err);
  free_ran(&r);
}

/* Nothing is rated in the paper's scene: no corner holds or breaks. */
static void nothing_rated(void) {
  ran r =
      run("run paper --set run.until=20ms --set 'spread={supply.voltage: 1 V}' --corners --json");
  EXPECT(r.status == 0 && strstr(r.out, "\"of\": 2") && strstr(r.out, "\"held\": 0") &&
             strstr(r.out, "\"worst\": null"),
         "%d %s%s", r.status, r.out, r.err);
  free_ran(&r);
}

/* A varistor's factor is an axis of a study. 10 % less of it is 11.1 % more current. */
static void axis_of_a_study(void) {
  write_two(ALL);
  write_file("w.yaml", "scene: paper\nset: {circuit.deck: v.cir, supply.voltage: 100 V, "
                       "firing.every: 1, run.until: 40 ms}\nvary: {circuit.varistor_1_scale: [0.9, "
                       "1]}\nsample: {method: corners, spread: {circuit.varistor_2_scale: 10 % "
                       "uniform}}\nreport: [varistor_1.i_peak, varistor_2.i_peak]\n");
  ran r = run("study w.yaml -o w --quiet --overwrite");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  free_ran(&r);
  char *csv = read_file("w/study.csv");
  EXPECT(count_lines(csv) == 7 &&
             strstr(csv, "circuit.varistor_1_scale,circuit.varistor_2_scale") &&
             strstr(csv, "1.571") && strstr(csv, "1.285"),
         "%s", csv);
  free(csv);
}

static const vs_test TESTS[] = {
    {"a limit short", a_limit_short},
    {"a part without a device", a_part_without_a_device},
    {"JSON and study say it", json_and_study_say_it},
    {"what is wrong is refused", what_is_wrong_is_refused},
    {"corners", corners},
    {"summary has all keys", summary_has_all_keys},
    {"each varistor by itself", each_by_itself},
    {"all alike", all_alike},
    {"corners of each", corners_of_each},
    {"two keys together", two_together},
    {"a tolerance in words", tolerance_in_words},
    {"a corner fails", a_corner_fails},
    {"a corner is refused", a_corner_is_refused},
    {"nothing is rated", nothing_rated},
    {"an axis of a study", axis_of_a_study},
};
int main(void) {
  return program_suite("waive", TESTS, COUNT(TESTS));
}
