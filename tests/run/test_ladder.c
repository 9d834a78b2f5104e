/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a run tries when ngspice gives up, and what it says of it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"
#include "run/ladder.h"

/* A thyristor that no method and no step gets past 3 ms: its current is no number then. */
#define GIVES_UP(node) "B1 " node " 0 I = 1u*ln(3m-time)\n"
static const char BAD[] =
    "*$ part thyristor \"gives up\"\n*$ limit v_drm = none\n"
    "*$ limit v_rrm = none\n.subckt bad a k g\nR1 a k 1meg\n" GIVES_UP("a") ".ends\n";

/* The device's model has no solution: every rung is tried, the last holds. The result is, to the
 * byte, that of the settings it names, and says where it stands and why. */
static void an_ideal_device_is_the_last(void) {
  write_file("bad.inc", BAD);
  ran r = run("run paper --set circuit.thyristor=bad.inc --set run.until=20ms "
              "--set run.ladder=ideal -o climbed");
  CU_ASSERT_EQUAL(r.status, 0);
  CU_ASSERT_EQUAL(count_words(r.err, "ngspice gave up"), 5);
  CU_ASSERT_EQUAL(count_words(r.err, "; trying "), 5);
  EXPECT(strstr(r.out, "rung   6: an ideal thyristor (latch), method gear; before, t = 0.00"), "%s",
         r.out);
  free_ran(&r);
  EXPECT_FILES("climbed", "events.csv peaks.csv run.csv summary.json ");
  RUN_GOOD("run paper --quiet --set circuit.thyristor=latch --set run.method=gear --set "
           "run.until=20ms -o asked");
  char *climbed = read_file("climbed/run.csv"), *asked = read_file("asked/run.csv"),
       *json = read_file("climbed/summary.json"), *plain = read_file("asked/summary.json");
  CU_ASSERT(count_lines(asked) == 202 && !strcmp(climbed, asked));
  EXPECT(strstr(json, "\"rung\": {\"number\": 6, \"text\": \"an ideal thyristor (latch), method "
                      "gear\", \"failed\": \"t = 0.00") &&
             strstr(json, "\"warnings\": [\"got on rung 6 of the ladder, an ideal thyristor") &&
             strstr(json, "\"thyristor\": \"latch\"") && strstr(json, "\"method\": \"gear\""),
         "%s", json);
  EXPECT(strstr(plain, "\"rung\": {\"number\": 0, \"text\": \"the scene as it is\", \"failed\": "
                       "\"\"}"),
         "%s", plain);
  free(climbed), free(asked), free(json), free(plain);
}

/* What the ideal one does is held against the limits of the part that the scene chose. A scene that
 * sets what only that part has cannot have another: the ladder ends before, and what was computed
 * is kept. */
static void the_part_that_was_chosen_counts(void) {
  static const char PART[] =
      "*$ part thyristor \"gives up\"\n*$ limit v_drm = 600 V\n*$ limit v_rrm "
      "= 600 V\n*$ limit i2t = 1e-3 A2.s assumed\n*$ param foo = 3 mA 0..10 \"f\"\n.subckt bad a k "
      "g\n"
      "R1 a k 1meg\n" GIVES_UP("a") ".ends\n";
  write_file("bad.inc", PART);
  ran r = run("run paper --set circuit.thyristor=bad.inc --set run.until=20ms "
              "--set run.ladder=ideal --quiet -o judged");
  EXPECT(r.status == 3 && strstr(r.err, "thyristor.i2t = 0.00") &&
             strstr(r.err, "allowed at most 0.001 A2.s"),
         "%s", r.err);
  free_ran(&r);
  char *json = read_file("judged/summary.json");
  EXPECT(strstr(json, "\"least\": -1048") && strstr(json, "\"min\": -600, \"max\": 600") &&
             strstr(json, "\"measure\": \"v_reverse\", \"unit\": \"V\"") &&
             strstr(json, "\"limit\": 600, ") &&
             strstr(json, "\"limit\": 0.001, \"assumed\": true"),
         "%s", json);
  free(json);
  r = run("run paper --set circuit.thyristor=bad.inc --set circuit.foo=4mA --set run.until=20ms "
          "--set run.ladder=ideal -o kept");
  EXPECT(r.status == 1 && count_words(r.err, "; trying ") == 4 &&
             !strstr(r.err, "trying an ideal") &&
             strstr(r.err, "what was computed is in kept/run.partial.csv"),
         "%s", r.err);
  EXPECT_FILES("kept", "run.partial.csv ");
  free_ran(&r);
}

/* By default the thyristor stays the scene's: the run fails, and so does a study's case, and both
 * say how an ideal one is had. A study that asks for it tells the rung in its row. */
static void no_other_device_unasked(void) {
  static const char WHY[] = "run.ladder: ideal would put an ideal thyristor in the place";
  write_file("bad.inc", BAD);
  ran r = run("run paper --set circuit.thyristor=bad.inc --set run.until=20ms -o failed");
  EXPECT(r.status == 1 && strstr(r.err, WHY) && count_words(r.err, "; trying ") == 4, "%s", r.err);
  EXPECT_FILES("failed", "run.partial.csv ");
  free_ran(&r);
  write_file("bad.yaml", "scene: paper\nset: {run.until: 20 ms}\n"
                         "vary: {circuit.thyristor: [latch, bad.inc]}\nreport: [p_min]\n");
  r = run("study bad.yaml --quiet -o stays");
  char *rows = read_file("stays/study.csv"), *failures = read_file("stays/failures.csv");
  EXPECT(r.status == 1 && count_lines(rows) == 2 && strstr(rows, ",,0,0,,,,0\n") &&
             strstr(failures, WHY),
         "%s\n%s", rows, failures);
  free(rows), free(failures), free_ran(&r);
  r = run("study bad.yaml --quiet --set run.ladder=ideal -o asked");
  rows = read_file("asked/study.csv");
  EXPECT(r.status == 0 && count_lines(rows) == 3 &&
             strstr(rows, ",margin_least,margin_error,weakest,rung,leaving_bound,happened,not_"
                          "judged,warnings,status\n") &&
             strstr(rows,
                    ",6,0,,,\"got on rung 6 of the ladder, an ideal thyristor (latch), method "
                    "gear; before, t = 0.00"),
         "%s", rows);
  free(rows), free_ran(&r);
}

/* No rung repeats what the scene has, and none makes it stricter. */
static void rungs_go_by_the_scene(void) {
  static const char *const SETS[] = {"run.pivrel=1e-3", "run.trtol=500", "run.max_step=80us", NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", SETS);
  vs_ladder ladder = {0};
  CU_ASSERT_FATAL(vs_ladder_climb(&ladder, &t->scene));
  CU_ASSERT_STRING_EQUAL(ladder.keys[0], "run.method=gear");
  CU_ASSERT(vs_ladder_climb(&ladder, &t->scene) && vs_ladder_climb(&ladder, &t->scene));
  CU_ASSERT_STRING_EQUAL(ladder.keys[1], "run.max_step=20us");
  CU_ASSERT_STRING_EQUAL(ladder.keys[2], "run.trtol=500");
  CU_ASSERT_FALSE(vs_ladder_climb(&ladder, &t->scene)); /* the deck's thyristor is ideal */
  vs_trial_free(t);
}

/* Tier compiled has one rung, and none for who stays, as a run of libvibrospice that was shown. */
static void the_rung_of_tier_compiled(void) {
  vs_trial *t = vs_trial_read("paper", "compiled", NULL);
  vs_ladder ladder = {0};
  CU_ASSERT_FATAL(vs_ladder_climb(&ladder, &t->scene));
  CU_ASSERT_EQUAL(ladder.n_keys, 1);
  CU_ASSERT_STRING_EQUAL(ladder.keys[0], "run.tier=circuit");
  CU_ASSERT_FALSE(vs_ladder_climb(&ladder, &t->scene));
  ladder = (vs_ladder){0};
  t->scene.setup.run.ladder = VS_LADDER_STAY;
  CU_ASSERT_FALSE(vs_ladder_climb(&ladder, &t->scene));
  vs_trial_free(t);
}

/* A scene that asks for more than 1e-4 has a rung at that tolerance, with its own steps. */
static void a_coarser_tolerance_with_the_same_steps(void) {
  static const char *const SETS[] = {"run.tolerance=1e-6", NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", SETS);
  vs_ladder ladder = {0};
  for (int rung = 1; rung <= 5; rung++) CU_ASSERT_FATAL(vs_ladder_climb(&ladder, &t->scene));
  CU_ASSERT_EQUAL(ladder.n_keys, 2);
  CU_ASSERT_STRING_EQUAL(ladder.keys[0], "run.tolerance=0.0001");
  CU_ASSERT_STRING_EQUAL(ladder.keys[1], "run.max_step=2.5us"); /* a tenth of that at 1e-4 */
  CU_ASSERT_FALSE(vs_ladder_climb(&ladder, &t->scene));
  vs_trial_free(t);
}

/* The mains jump at t = 0, and behind the source's inductance lies a thyristor alone: ngspice finds
 * no step of picoseconds that is good enough, some time after the first one or in the first one.
 * The rungs begin with a longer one. `check` and `run` say the same of the scene. */
static void a_longer_first_step(void) {
  static const char *const SCENES[] = {
      "circuit: {deck: halfwave_bare, thyristor: TYN1012}\n"
      "supply: {voltage: 207 V, frequency: 60 Hz, phase: -101 deg}\n"
      "firing: {angle: 107.4 deg, every: 2, pulse_width: 0.518 ms}\n"
      "run: {until: 3 ms, tolerance: 1e-3, verify: never}\n",
      "circuit: {deck: halfwave_bare, thyristor: TYN1212}\n"
      "supply: {voltage: 362.3 V, frequency: 60.93 Hz, phase: -44.6 deg, resistance: 0.0559 ohm, "
      "inductance: 4.51 mH}\n"
      "run: {until: 3 ms, verify: never}\n"};
  for (size_t k = 0; k < COUNT(SCENES); k++) {
    write_file("jump.yaml", SCENES[k]);
    vs_trial *t = vs_trial_run("jump.yaml", NULL, NULL, NULL);
    const vs_ladder *ladder = &t->result.ladder;
    EXPECT(t->status == VS_OK && ladder->rung <= 1, "rung %d: %s", ladder->rung, t->err.text);
    if (ladder->rung) CU_ASSERT_STRING_EQUAL(ladder->keys[1], "run.first_step=0.0001");
    vs_trial_free(t);
    ran r = run("check jump.yaml"); /* it warns that nothing fires */
    EXPECT(r.status == 0, "%s", r.err);
    free_ran(&r);
  }
}

/* The control of one rung is ended before its scene goes. */
static void with_a_control(void) {
  write_file("bad.inc", BAD);
  write_file("s.yaml", "circuit: {thyristor: bad.inc}\nfiring: {every: 1, angle: 140 deg}\n"
                       "instruments: {}\n"
                       "control: {law: phase, sensor: p, angle: [90 deg, 175 deg]}\n"
                       "run: {until: 20 ms, tier: circuit}\n");
  ran r = run("run s.yaml -o o");
  EXPECT(r.status == 1 && count_words(r.err, "; trying ") == 4, "%d %s", r.status, r.err);
  free_ran(&r);
}

/* Behind the source's inductance alone, without a snubber, ngspice finds no step short enough at
 * this tolerance where a thyristor of two transistors fires. */
static void a_thyristor_without_a_snubber(void) {
  static const char *const PARTS[] = {"BT151-800R", "12TTS08S"};
  for (size_t k = 0; k < COUNT(PARTS); k++) {
    char part[64];
    snprintf(part, sizeof part, "circuit.thyristor=%s", PARTS[k]);
    const char *sets[] = {"circuit.deck=halfwave_bare", part, "run.until=8ms", "run.tolerance=1e-6",
                          NULL};
    vs_trial *fine = vs_trial_run("paper", "circuit", sets, NULL);
    sets[3] = "run.tolerance=1e-4";
    vs_trial *coarse = vs_trial_run("paper", "circuit", sets, NULL);
    EXPECT(fine->status == VS_OK, "%s: %s", PARTS[k], fine->err.text);
    CLOSE(fine->result.values[VS_M_I_PEAK].value, coarse->result.values[VS_M_I_PEAK].value, 2e-4);
    vs_trial_free(fine);
    vs_trial_free(coarse);
  }
}

/* Nor one where its current ends: the steps towards that zero stay long enough. */
static void the_end_of_a_current_without_a_snubber(void) {
  static const char *const SETS[] = {"circuit.deck=halfwave_bare", "circuit.thyristor=12TTS08S",
                                     "firing.angle=121.2deg",      "supply.voltage=446.7V",
                                     "supply.frequency=60Hz",      "supply.resistance=0.269ohm",
                                     "supply.inductance=3.29mH",   "actuator.resistance=62.45ohm",
                                     "actuator.inductance=1.061H", "actuator.leakage=0.162H",
                                     "run.until=11.5ms",           NULL};
  vs_trial *t = vs_trial_run("paper", "circuit", SETS, NULL);
  EXPECT(t->status == VS_OK && t->result.ladder.rung == 0, "%d: %s %s", t->result.ladder.rung,
         t->err.text, t->result.ladder.failed);
  vs_trial_free(t);
}

/* Nor one whose coil is shorted: it rings with the source's inductance as it blocks, with hardly a
 * loss, and that ring dies away. */
static void a_short_behind_a_blocked_thyristor(void) {
  static const char *const SETS[] = {"circuit.deck=halfwave_bare",
                                     "circuit.thyristor=TYN1012",
                                     "supply.voltage=101.3V",
                                     "supply.frequency=60Hz",
                                     "supply.resistance=0.0596ohm",
                                     "supply.inductance=0.0175mH",
                                     "firing.angle=106.8deg",
                                     "events.e0.kind=coil_short",
                                     "events.e0.cycle=1",
                                     "events.e0.angle=93.98deg",
                                     "events.e0.fraction=94.43%",
                                     "run.tolerance=1e-3",
                                     "run.until=8.5ms",
                                     "run.verify=never",
                                     NULL};
  vs_trial *t = vs_trial_run("paper", "circuit", SETS, NULL);
  EXPECT(t->status == VS_OK && t->result.steps < 5000, "%ld steps: %s", t->result.steps,
         t->err.text);
  vs_trial_free(t);
}

/* The pulse of this gate drive dies away while the anode's voltage passes the latch's threshold. */
static void a_latch_as_its_gate_pulse_dies_away(void) {
  write_file(
      "s.yaml",
      "machine: {model: fixed_base}\n"
      "actuator: {resistance: 77.89 ohm, gap: 4.563 mm}\n"
      "load: {density: 2.17 g/cm3, fraction: 0.29}\n"
      "supply: {voltage: 429.9 V, frequency: 60 Hz, resistance: 1.11 ohm, inductance: 3.16 mH}\n"
      "circuit: {deck: halfwave_paper, thyristor: latch, r1: 135.9 ohm, c1: 2.092 nF,\n"
      "  r2: 4096 ohm, c2: 7.405 nF, varistor_2: varistor_siov}\n"
      "firing: {angle: 122 deg, every: 1, first_cycle: 0, burst_frequency: 14.7 kHz,\n"
      "  burst_duty: 29.6 %}\n"
      "run: {until: 7 ms, tolerance: 1e-4, verify: never, tier: circuit, ladder: stay}\n");
  ran r = run("run s.yaml -o o --quiet");
  EXPECT(!r.status && !strstr(r.err, "gave up"), "%d %s", r.status, r.err);
  free_ran(&r);
}

/* run.ladder: stay. What was computed is kept, as of any run that fails. */
static void one_may_stay(void) {
  write_file("bad.inc", BAD);
  ran r = run("run paper --set circuit.thyristor=bad.inc --set run.until=20ms "
              "--set run.ladder=stay -o stayed");
  CU_ASSERT_EQUAL(r.status, 1);
  EXPECT(count_words(r.err, "\n") == 1 && strstr(r.err, "ngspice gave up") &&
             strstr(r.err, "run.partial.csv"),
         "%s", r.err);
  EXPECT_FILES("stayed", "run.partial.csv ");
  free_ran(&r);
}

/* It is the deck's own: no rung helps, and the error names the first and the last. With gear asked
 * for, the rung that is gear alone is left out; a deck without a thyristor has no last one. */
static void nothing_helps(void) {
  write_file("bad.cir", "*$ port mains = Vm\n*$ probe v_a = v(a) V\nVm s 0 external\nRs s a 1\n"
                        "Xeva a 0 eva\nR1 x 0 1meg\n" GIVES_UP("x"));
  ran r =
      run("run paper --set circuit.deck=bad.cir --set run.until=5ms --set run.method=gear -o o");
  CU_ASSERT_EQUAL(r.status, 1);
  CU_ASSERT_EQUAL(count_words(r.err, "; trying "), 3);
  const char *last = strstr(r.err, "vibrospice: t = 0.00");
  EXPECT(last &&
             strstr(last, "(method gear, a quarter of the step, trtol 100; before, the scene "
                          "as it is: t = 0.00") &&
             strstr(last, "what was computed is in o/run.partial.csv") &&
             count_words(last, "\n") == 1,
         "%s", r.err);
  EXPECT_FILES("o", "run.partial.csv ");
  free_ran(&r);
}

/* A run that ngspice did not end is not tried again: this one meets the pole. */
static void only_when_ngspice_gives_up(void) {
  ran r = run("run paper --tier circuit --set firing.every=1 --set firing.angle=80deg "
              "--set run.until=0.1s --quiet");
  CU_ASSERT_EQUAL(r.status, 1);
  EXPECT(count_words(r.err, "\n") == 1 && strstr(r.err, "meets the pole cover"), "%s", r.err);
  free_ran(&r);
  vs_trial *t = vs_trial_read("paper", "switched", NULL);
  vs_ladder ladder = {0};
  CU_ASSERT_FALSE(vs_ladder_climb(&ladder, &t->scene));
  vs_trial_free(t);
}

static const vs_test TESTS[] = {
    {"an ideal device is the last", an_ideal_device_is_the_last},
    {"no other device unasked", no_other_device_unasked},
    {"the part that was chosen counts", the_part_that_was_chosen_counts},
    {"rungs go by the scene", rungs_go_by_the_scene},
    {"the rung of tier compiled", the_rung_of_tier_compiled},
    {"a longer first step", a_longer_first_step},
    {"a coarser tolerance with the same steps", a_coarser_tolerance_with_the_same_steps},
    {"with a control", with_a_control},
    {"a thyristor without a snubber", a_thyristor_without_a_snubber},
    {"the end of a current without a snubber", the_end_of_a_current_without_a_snubber},
    {"a short behind a blocked thyristor", a_short_behind_a_blocked_thyristor},
    {"a latch as its gate pulse dies away", a_latch_as_its_gate_pulse_dies_away},
    {"one may stay", one_may_stay},
    {"nothing helps", nothing_helps},
    {"only when ngspice gives up", only_when_ngspice_gives_up},
};

int main(void) {
  return program_suite("ladder", TESTS, COUNT(TESTS));
}
