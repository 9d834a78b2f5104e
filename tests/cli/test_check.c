/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command check: all findings at once, in the order of the lines, each with its line and a
 * caret; nothing that is only the echo of another; and nothing written. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "program.h"
#include "random_scene.h"

/* ---- helpers ---- */

/* Runs check on a file of that text (NULL: none is made); nothing else may be there afterwards. */
static ran check(const char *file, const char *text, const char *options) {
  char files[64] = "";
  if (text) {
    write_file(file, text);
    snprintf(files, sizeof files, "%s ", file);
  }
  ran r = run("check %s %s", file, options);
  EXPECT_FILES(".", files);
  if (text) remove(file);
  return r;
}

/* What the findings are, word by word. */
static void expect_findings(const char *file, const char *text, const char *options,
                            const char *findings, int line) {
  ran r = check(file, text, options);
  expect(r.status == (*findings ? 2 : 0), line, "exit status %d", r.status);
  expect(!strcmp(r.err, findings), line, "says:\n%s\nand should:\n%s", r.err, findings);
  expect(*findings ? !*r.out : count_lines(r.out) == 1, line, "standard output: %s", r.out);
  free_ran(&r);
}
#define FINDINGS(file, text, options, findings)                                                    \
  expect_findings(file, text, options, findings, __LINE__)

/* The findings' places alone, for what is said in the solver's words: "d.cir:9:3 d.cir:10:3 ". Of
 * the program's own files the folders are left out. */
static void expect_places(const char *file, const char *text, const char *places, int line) {
  ran r = check(file, text, "--no-jail");
  vs_text seen = {0};
  char *rest = r.err;
  vs_text_add(&seen, "%s", "");
  for (char *row; (row = strsep(&rest, "\n"));)
    if (*row && *row != ' ') {
      const char *end = strstr(row, ": "), *place = end;
      while (place > row && place[-1] != '/') place--;
      if (*row != '/') place = row;
      vs_text_add(&seen, "%.*s ", (int)(end - place), place);
    }
  expect(r.status == (*places ? 2 : 0), line, "exit status %d", r.status);
  expect(!strcmp(seen.text, places), line, "points at %sand should at %s", seen.text, places);
  vs_text_free(&seen);
  free_ran(&r);
}
#define PLACES(file, text, places) expect_places(file, text, places, __LINE__)

/* ---- scenes ---- */

/* What a machine that cannot be read would have is not called unknown. */
static void names_of_a_broken_machine(void) {
  write_file("broken.yaml",
             "coordinates: {s: {unit: m}}\nmass: 1 kg\nstiffness: 1 kg\n"
             "gap: {along: {s: 1}}\nactuator: {gap: 1 mm, pole_cover: 1 mm, inductance: 1 H, "
             "resistance: 1 ohm, stop: {stiffness: 1e7 N/m}}\n");
  write_file("s.yaml",
             "machine: {model: broken.yaml}\nsupply: {kind: step}\nfiring: {valve: none}\n"
             "record: [s]\nratings: {release: .. 16 ms}\n");
  ran r = run("check s.yaml --no-jail");
  EXPECT(r.status == 2 &&
             !strcmp(r.err, "broken.yaml:3:12: stiffness of s, s: the formula is in kg; "
                            "wanted: N/m\n stiffness: 1 kg\n            ^\n"),
         "%d %s", r.status, r.err);
  free_ran(&r);
  remove("broken.yaml");
  remove("s.yaml");
}

static void all_that_is_wrong_with_a_scene(void) {
  FINDINGS(
      "s.yaml",
      "# Ω µ\n"
      "measured: {i_peak: 1 N, i_peek: 2 A}\n"
      "machine: {trough_mas: 1 kg, base_mass: 3 m, base_com: [1 s, 2 kg]}\n"
      "firin:\t{angle: 95 deg}\n"
      "actuator:\n"
      "  gap: \"-1 mm\"\n"
      "  stop: {stifness: 2, damping: 1e99 N.s/m}\n"
      "load: 3\n"
      "supply: {voltage: 1 kΩ,\tfrequency: 50}\n"
      "circuit: {r1: 0 ohm, r99: 1 ohm}\n"
      "run: {tier: circus, tolerance: 1e-9}\n"
      "record: [p, forze, p, v_al, v_ak]\n",
      "--set run.until=soon --set bar --set firing.every=0.5",
      "--set bar: write KEY=VALUE, for example firing.angle=95deg\n"
      "s.yaml:2:20: measured.i_peak: '1 N' has the wrong unit; write A\n"
      " measured: {i_peak: 1 N, i_peek: 2 A}\n"
      "                    ^\n"
      "s.yaml:2:25: measured has no key 'i_peek'; did you mean 'i_peak'? "
      "it has: i_peak, t_fire, t_extinction, conduction_time, force_peak, gap_first_peak, "
      "gap_second_peak, gap_min, gap_max, stroke, p_min, p_max, u_min, u_max, w_min, w_max, "
      "phi_min, phi_max, ap_peak, au_peak, aw_peak, aphi_peak, ...\n"
      " measured: {i_peak: 1 N, i_peek: 2 A}\n"
      "                         ^\n"
      "s.yaml:3:11: machine has no key 'trough_mas'; did you mean 'trough_mass'? "
      "it has: model, trough_mass, base_mass, trough_inertia, base_inertia, spring_angle, "
      "base_com, trough_com, mount_3, mount_4, spring_stiffness, mount_stiffness_x, "
      "mount_stiffness_y, spring_damping, mount_damping_x, mount_damping_y, ...\n"
      " machine: {trough_mas: 1 kg, base_mass: 3 m, base_com: [1 s, 2 kg]}\n"
      "           ^\n"
      "s.yaml:3:40: machine.base_mass: '3 m' has the wrong unit; write kg\n"
      " machine: {trough_mas: 1 kg, base_mass: 3 m, base_com: [1 s, 2 kg]}\n"
      "                                        ^\n"
      "s.yaml:3:56: machine.base_com: '1 s' has the wrong unit; write mm\n"
      " machine: {trough_mas: 1 kg, base_mass: 3 m, base_com: [1 s, 2 kg]}\n"
      "                                                        ^\n"
      "s.yaml:3:61: machine.base_com: '2 kg' has the wrong unit; write mm\n"
      " machine: {trough_mas: 1 kg, base_mass: 3 m, base_com: [1 s, 2 kg]}\n"
      "                                                             ^\n"
      "s.yaml:4:1: a scene has no key 'firin'; did you mean 'firing'? "
      "it has: machine, actuator, load, supply, firing, pwm, circuit, events, instruments, "
      "control, run, start, record, measured, quality, expect, waive, spread, ratings, ambient, "
      "heatsink, "
      "measure, limits\n"
      " firin:\t{angle: 95 deg}\n"
      " ^\n"
      "s.yaml:6:9: actuator.gap: -1 mm is out of range; allowed: 0..1000 mm (ends excluded)\n"
      "   gap: \"-1 mm\"\n"
      "         ^\n"
      "s.yaml:7:10: actuator.stop has no key 'stifness'; did you mean 'stiffness'? "
      "it has: stiffness, damping, kind, at\n"
      "   stop: {stifness: 2, damping: 1e99 N.s/m}\n"
      "          ^\n"
      "s.yaml:7:32: actuator.stop.damping: 1e99 N.s/m is out of range; allowed: 0..1e+09 "
      "N.s/m\n"
      "   stop: {stifness: 2, damping: 1e99 N.s/m}\n"
      "                                ^\n"
      "s.yaml:8:7: load: a map of keys is wanted: {key: value, ...}\n"
      " load: 3\n"
      "       ^\n"
      "s.yaml:9:19: supply.voltage: '1 kΩ' has the wrong unit; write V\n"
      " supply: {voltage: 1 kΩ,\tfrequency: 50}\n"
      "                   ^\n"
      "s.yaml:9:36: supply.frequency: 50 has no unit; write for example '50 Hz'\n"
      " supply: {voltage: 1 kΩ,\tfrequency: 50}\n"
      "                        \t           ^\n"
      "s.yaml:10:15: circuit.r1: 0 ohm is out of range; allowed: 0.001..1e+06 ohm\n"
      " circuit: {r1: 0 ohm, r99: 1 ohm}\n"
      "               ^\n"
      "s.yaml:10:22: circuit has no key 'r99'; did you mean 'r1'? "
      "it has: deck, r1, c1, r2, c2, varistor_voltage, varistor_exponent, thyristor, "
      "on_voltage, on_resistance, off_resistance\n"
      " circuit: {r1: 0 ohm, r99: 1 ohm}\n"
      "                      ^\n"
      "s.yaml:11:13: run.tier: 'circus' is not one of: auto|analytic|switched|circuit|compiled\n"
      " run: {tier: circus, tolerance: 1e-9}\n"
      "             ^\n"
      "s.yaml:12:13: record: no probe 'forze'; did you mean 'force'?\n"
      " record: [p, forze, p, v_al, v_ak]\n"
      "             ^\n"
      "s.yaml:12:20: record: probe p stands here a second time; leave one out\n"
      " record: [p, forze, p, v_al, v_ak]\n"
      "                    ^\n"
      "s.yaml:12:23: record: no probe 'v_al'; did you mean 'v_ak'?\n"
      " record: [p, forze, p, v_al, v_ak]\n"
      "                       ^\n"
      "--set firing.every=0.5: firing.every: 0.5 is out of range; allowed: once or 1..1e+06\n"
      "--set run.until=soon: run.until: 'soon' is not a number; write a number with its unit, "
      "in s\n");
}

/* Findings of single reading steps, with others before and behind them. */
static void a_scene_is_read_to_its_end(void) {
  const struct {
    const char *scene, *places;
  } ROWS[] = {
      {"machine: {base_mass: 0.01 kg, base_inertia: 1e-9 kg.m2, trough_inertia: 1e-9 "
       "kg.m2}\nmeasured: {x: 1}\n",
       "conveyor.yaml:47:44 s.yaml:2:12 "}, /* M, in the machine's file */
      {"x: 1\nmachine: {base_mass: 0.01 kg, base_inertia: 1e-9 kg.m2, trough_inertia: 1e-9 "
       "kg.m2}\n",
       "s.yaml:1:1 conveyor.yaml:47:44 "},
      {"firing: {every: 1, pulse_width: 30 ms}\nmeasured: {x: 1}\n", "s.yaml:1:33 s.yaml:2:12 "},
      {"load: 1\nfiring: {every: 1, pulse_width: 30 ms}\n", "s.yaml:1:7 s.yaml:2:33 "},
      {"circuit: {deck: nowhere}\nrun: {until: 1}\n", "s.yaml:1:17 s.yaml:2:14 "},
      {"circuit: {thyristor: nowhere, r1: 1 V}\nrun: {until: 1}\n",
       "s.yaml:1:22 s.yaml:1:35 s.yaml:2:14 "},
      {"run: {tier: circuit, tolerance: 1e-9}\nrecord: [x]\n", "s.yaml:1:33 s.yaml:2:10 "},
      {"load: {fractio,: 1}\n",
       is_newer_yaml() ? "s.yaml:1:8 s.yaml:1:15 " : "s.yaml:1:8 s.yaml:1:18 "},
      {"record: []\nmeasured: {x: 1}\n", "s.yaml:1:1 s.yaml:2:12 "},
      {"record: x\nmeasured: {x: 1}\n", "s.yaml:1:9 s.yaml:2:12 "},
      {"start: {p: -7 mm}\nmeasured: {x: 1}\n", "s.yaml:1:12 s.yaml:2:12 "},
      {"start: {p: -7 s, u: 1 s}\n", "s.yaml:1:12 s.yaml:1:21 "},
      {"run: {max_step: 1e-9 us}\n", "s.yaml "},
      {"run: {until: 5e5 s, sample: 0.4 ms}\nrecord: [x]\n", "s.yaml:1:29 s.yaml:2:10 "},
      {"run: {until: 5e5 s, sample: 0.5 ms}\nrecord: [x]\n", "s.yaml:2:10 "},
      {"run: {max_step: 1e-9 us, tier: circuit}\n", "s.yaml "},
      {"run: {until: 1 s\n", "s.yaml:2:1 "},
      {"run: {until: 1 s}\nrun: {until: 2 s}\n", "s.yaml:2:1 "},
      {"measured: {i_peak: 1, force_peak: 2}\n", "s.yaml:1:20 s.yaml:1:35 "},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++)
    expect_places("s.yaml", ROWS[k].scene, ROWS[k].places, __LINE__);
}

/* What would not be wrong if another thing were right is not said. */
static void no_echoes(void) {
  static const struct {
    const char *scene, *places;
  } ROWS[] = {
      {"machine: {base_mass: 0.01 kg, base_inertia: 1e-9 kg.m2, trough_inertia: 1e-9 kg.m2, m14: "
       "1}\n",
       "s.yaml:1:90 "},
      {"firing: {every: 1, pulse_width: 30 ms}\nsupply: {frequency: 10}\n", "s.yaml:2:21 "},
      {"circuit: {deck: nowhere, r77: 1 ohm}\nrecord: [p, v_ax]\n", "s.yaml:1:17 "},
      {"run: {tier: swiched, tolerance: 1e-10}\n", "s.yaml:1:13 "},
      {"actuator: {gap: 6}\nstart: {p: -7 mm}\n", "s.yaml:1:17 "},
      {"run: {until: 1}\nfiring: {angle: 70 deg}\n", "s.yaml:1:14 "},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++)
    expect_places("s.yaml", ROWS[k].scene, ROWS[k].places, __LINE__);
}

/* A value that cannot be read is as by default: the other values are judged against that. */
static void a_value_that_failed_leaves_its_default(void) {
  static const struct {
    const char *scene;
    size_t found;
  } ROWS[] = {{"machine: {trough_mass: 1e9 kg, base_com: [1 mm, 2 km], m14: x}\n", 3},
              {"firing: {every: 1e9}\nactuator: {stop: [1]}\nload: 1\n", 3}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_findings *all = vs_alloc(1, sizeof *all);
    vs_scene *s = vs_alloc(1, sizeof *s);
    vs_error err = {.findings = all};
    write_file("s.yaml", ROWS[k].scene);
    CU_ASSERT_EQUAL(vs_scene_read("s.yaml", NULL, 0, NULL, s, &err), VS_OK);
    remove("s.yaml");
    CU_ASSERT_EQUAL(vs_error_count(&err), ROWS[k].found);
    const conveyor_values values = conveyor_values_of(&s->setup.model), *m = &values;
    CLOSE(m->trough_mass_kg, 0.83, 1e-15);
    CLOSE(m->base_com_m[0], k ? 0.194 : 0.001, 1e-15);
    CLOSE(m->base_com_m[1], 0.089, 1e-15);
    CU_ASSERT_EQUAL(m->m14, 0);
    CU_ASSERT_EQUAL(s->setup.timeline.firing.every, 0);
    CU_ASSERT_EQUAL(s->setup.model.actuator.stop[0].present, 0);
    CLOSE(s->setup.model.load.volume_m3, 380e-6, 1e-15);
    vs_scene_free(s);
    free(s);
    free(all);
  }
}

/* What run.csv would not be done with; whichever of its two keys the scene has is to blame. */
static void too_many_rows_are_an_error(void) {
  FINDINGS("s.yaml", "run: {sample: 1e-9 ms}\n", "",
           "s.yaml:1:15: run.sample: 1e-09 ms makes 2e+12 rows up to run.until = 2 s; allowed "
           "there: at least 2e-06 ms, for 1000000000 rows\n"
           " run: {sample: 1e-9 ms}\n"
           "               ^\n");
  FINDINGS("s.yaml", "run: {until: 5e5 s}\n", "",
           "s.yaml:1:14: run.sample: 0.1 ms makes 5e+09 rows up to run.until = 500000 s; allowed "
           "there: at least 0.5 ms, for 1000000000 rows\n"
           " run: {until: 5e5 s}\n"
           "              ^\n");
}

static void a_hundred_are_enough(void) {
  vs_text scene = {0};
  for (int k = 0; k < 150; k++) vs_text_add(&scene, "key%d: 1\n", k);
  ran r = check("s.yaml", scene.text, "");
  CU_ASSERT_EQUAL(r.status, 2);
  CU_ASSERT_EQUAL(count_lines(r.err), 301);
  CU_ASSERT_PTR_NOT_NULL(strstr(r.err, "s.yaml:100:1: a scene has no key 'key99'"));
  CU_ASSERT_PTR_NULL(strstr(r.err, "key100"));
  CU_ASSERT_PTR_NOT_NULL(strstr(r.err, "vibrospice: s.yaml: and more than these\n"));
  free_ran(&r);
  vs_text_free(&scene);
}

/* ---- decks ---- */

static const char GOOD_DECK[] = "*$ title a coil\n"
                                "*$ port mains = Vmains\n"
                                "*$ port gate = Vgate\n"
                                "*$ param r1 = 1 ohm 0..2 \"first\"\n"
                                "*$ probe i_thyristor = -i(Vmains) A\n"
                                "Vmains a 0 external\n"
                                "Vgate g 0 external\n"
                                "Rg g 0 1k\n"
                                "R1 a b {r1}\n"
                                "Xeva b 0 eva\n";

static void all_that_is_wrong_with_a_deck(void) {
  FINDINGS(
      "d.cir",
      "*$ title  Ω\n"
      "*$ prt    mains = Vmains\n"
      "*$ port   gat = Vgate\n"
      "*$ param  r1 = 1 ohm 2..3 \"out\"\n"
      "*$ param  r2 = 1 kΩ 0..2 \"µ\" x\n"
      "*$ probe  v_b = v(b W\n"
      "*$ loss   r1 = v(a,b)^2/{r1\n"
      "*$ rating v_c 0..1 V\n"
      "*$ compat lt\n"
      "Vmains a 0 external\n"
      "  .step r1 1 2 1\n"
      ".include nowhere\n"
      "\tR1 a\n"
      "Xeva b 0 eva\n"
      "Xtwo b 0 eva\n",
      "",
      "d.cir:2:4: '*$ prt' is not known; there are: title, param, port, line, earth, probe, loss, "
      "store, part, limit, rating, require, device, time_current, derate, zth, pulse, surge, at, "
      "model, start, compat; did you mean "
      "'port'?\n"
      " *$ prt    mains = Vmains\n"
      "    ^\n"
      "d.cir:3:11: no port 'gat'; there are: mains, gate, gate+ANGLE, burst, burst+ANGLE, pwm, "
      "pwm+ANGLE, pwm_low, pwm_low+ANGLE\n"
      " *$ port   gat = Vgate\n"
      "           ^\n"
      "d.cir:4:16: param r1: 1 ohm is outside its own range\n"
      " *$ param  r1 = 1 ohm 2..3 \"out\"\n"
      "                ^\n"
      "d.cir:5:30: nothing may follow the description\n"
      " *$ param  r2 = 1 kΩ 0..2 \"µ\" x\n"
      "                              ^\n"
      "d.cir:6:18: 'probe NAME = v(n) | v(n,m) | i(Vx)  UNIT' is wanted here\n"
      " *$ probe  v_b = v(b W\n"
      "                  ^\n"
      "d.cir:7:28: '}' is wanted\n"
      " *$ loss   r1 = v(a,b)^2/{r1\n"
      "                            ^\n"
      "d.cir:9:11: compat: there is: ps (PSpice)\n"
      " *$ compat lt\n"
      "           ^\n"
      "d.cir:11:3: .step does not belong in a deck: of many circuits a study asks; with a line "
      "'*$ param NAME = ...' its axis is circuit.NAME\n"
      "   .step r1 1 2 1\n"
      "   ^\n"
      "d.cir:12:1: no include file 'nowhere': not beside the file that includes it, and not an "
      "include file that comes with the program\n"
      " .include nowhere\n"
      " ^\n"
      "d.cir:13:2: an element is wanted here: 'NAME node node ...', or a statement, or a "
      "comment\n"
      " \tR1 a\n"
      " \t^\n"
      "d.cir:15:1: a second EVA; a deck has one line 'Xeva n m eva'\n"
      " Xtwo b 0 eva\n"
      " ^\n");
}

/* Whole, the deck is judged as a whole. */
static void what_does_not_fit_together(void) {
  static const struct {
    const char *more, *places; /* behind the ten good lines */
  } ROWS[] = {
      {"", ""},
      {"*$ port gate+180deg = Vtwo\nVfree f 0 external\nVother o 0 external\n",
       "d.cir:11:9 d.cir:12:1 d.cir:13:1 "},
      {"*$ port gate+10deg = V2\n*$ port gate+20deg = V3\n", "d.cir:11:9 d.cir:12:9 "},
      {"*$ loss x = v(a)^2/{rx}\n*$ loss y = v(a)^2/(1 + ry)\n", "d.cir:11:21 d.cir:12:25 "},
      {"*$ param p = none part\n*$ param q = nothing part\n", "d.cir:11:14 d.cir:12:14 "},
      {"*$ rating v_x 0..1 V\n*$ rating v_y 0..1 V\n", "d.cir:11:11 d.cir:12:11 "},
      {".include d.cir\n", "d.cir:11:1 "},
      /* and no echo of it */
      {"*$ port gaet = Vtwo\nVtwo f 0 external\n", "d.cir:11:9 "},
      {"*$ port gate+180deg = Vtwo\nVtwo f external\nVtwo f\n", "d.cir:13:1 "},
      {"*$ param rx = 1 ohms 0..1\n*$ loss x = v(a)^2/{rx}\n", "d.cir:11:15 "},
      {"*$ probe v_x = v[a] V\n*$ rating v_x 0..1 V\n", "d.cir:11:17 "},
      {"*$ param p = ../p.inc part\n", "../p.inc:1:1 "},
      {"$ param rx = 1 ohm 0..1\n*$ loss x = v(a)^2/{rx}\n", "d.cir:11:1 "},
      {"*$ loss x = v(q)^2/{rx}} + 1\n", "d.cir:11:24 "},
  };
  write_file("../p.inc", "R1\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text deck = {0};
    vs_text_add(&deck, "%s%s", GOOD_DECK, ROWS[k].more);
    expect_places("d.cir", deck.text, ROWS[k].places, __LINE__);
    vs_text_free(&deck);
  }
  PLACES("d.cir", "*$ port mains = Vm\nVm a 0 external\nVn b 0 external\n", "d.cir:1:1 d.cir:3:1 ");
  PLACES("d.cir", "*$ port mains = Vm\nVm a 0 external\nXeva b\n", "d.cir:3:1 ");
}

/* What only ngspice knows: the first step is tried. */
static void what_ngspice_refuses(void) {
  static const struct {
    const char *more, *places;
  } ROWS[] = {
      {"*$ probe v_x = v(x) V\n*$ probe v_y = v(a,y) V\n*$ loss z = 2*v(zz)\n",
       "d.cir:11:16 d.cir:12:16 d.cir:13:15 "},
      {"R2 a b {r7+1}\nR3 a b {1+r9}\n", "d.cir:11:9 d.cir:12:11 "},
      {"Q1 a b\n  D3 a b nodiode\n", "d.cir:11:6 d.cir:12:10 "},
      {"X1 a b nosuch\n", "d.cir:11:1 "},
      {"R2 a b c2p {r1}\n", "d.cir:11:8 "},
      {"L1 a b xx=1\n", "d.cir:11:1 "},
      {"R8 a b {1+}\n", "d.cir:11:9 "},
      {"B1 a b I = v(a)\nB2 a b I = foo(v(a))\n", "d.cir:12:12 "},
      {"V8 a 0 1\n", "d.cir:6:1 d.cir:11:1 "}, /* in a loop with the mains */
      {"K1 L1 L2 0.5\n", "d.cir:11:1 "},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text deck = {0};
    vs_text_add(&deck, "%s%s", GOOD_DECK, ROWS[k].more);
    expect_places("d.cir", deck.text, ROWS[k].places, __LINE__);
    vs_text_free(&deck);
  }
}

/* A scene is checked with its own deck, and that with the solver when the tier asks for it. */
static void a_scene_with_its_deck(void) {
  static const struct {
    const char *scene, *more, *says;
  } ROWS[] = {
      {"circuit: {deck: ../d.cir, r1: 2 ohm}\n", "", ""},
      {"circuit: {deck: ../d.cir}\n", "Q1 a b\n", "../d.cir:11:6: "},
      {"circuit: {deck: ../d.cir}\nrun: {tier: switched}\n", "Q1 a b\n", ""},
      {"circuit: {deck: ../d.cir}\nrun: {tier: switched}\n", "Q1\n", "../d.cir:11:1: "},
      {"record: [x, y]\ncircuit: {deck: ../d.cir, r1: 1 ohm}\n", "*$ probe x\n",
       "../d.cir:11:10: "},
      {"circuit: {deck: ../d.cir, r2: 1 ohm}\n", "*$ param r2\n", "../d.cir:11:10: "},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text deck = {0};
    vs_text_add(&deck, "%s%s", GOOD_DECK, ROWS[k].more);
    write_file("../d.cir", deck.text);
    vs_text_free(&deck);
    ran r = check("s.yaml", ROWS[k].scene, "--no-jail");
    EXPECT(r.status == (*ROWS[k].says ? 2 : 0), "%s: exit status %d", ROWS[k].scene, r.status);
    EXPECT(!strncmp(r.err, ROWS[k].says, strlen(ROWS[k].says)), "%s: %s", ROWS[k].scene, r.err);
    EXPECT(count_lines(r.err) == (*ROWS[k].says ? 3 : 0), "%s: %s", ROWS[k].scene, r.err);
    free_ran(&r);
  }
}

/* ---- what can be read but once ---- */

/* check with a file as its standard input. */
static ran check_input(const char *file) {
  int kept = dup(STDIN_FILENO), input = open(file, O_RDONLY);
  CU_ASSERT_FATAL(kept >= 0 && input >= 0 && dup2(input, STDIN_FILENO) >= 0);
  close(input);
  ran r = run("check /dev/stdin");
  dup2(kept, STDIN_FILENO);
  close(kept);
  return r;
}

/* A pipe was read to find its kind, and was an empty scene then, which is a good one. */
static void no_pipe_is_a_good_scene(void) {
  CU_ASSERT_EQUAL(mkfifo("pipe.yaml", 0600), 0);
  static const char *const NAMES[] = {"pipe.yaml", "/dev/null"};
  for (size_t k = 0; k < COUNT(NAMES); k++) {
    ran r = run("check %s", NAMES[k]);
    EXPECT(r.status == 2 && !*r.out && strstr(r.err, "is a pipe or a device"), "%s: %d: %s%s",
           NAMES[k], r.status, r.out, r.err);
    CU_ASSERT_EQUAL(count_lines(r.err), 1);
    free_ran(&r);
  }
  int ends[2];
  char name[32];
  CU_ASSERT_EQUAL_FATAL(pipe(ends), 0);
  snprintf(name, sizeof name, "/dev/fd/%d", ends[0]);
  ran r = run("check %s", name);
  EXPECT(r.status == 2 && !*r.out && strstr(r.err, "is a pipe or a device"), "%s%s", r.out, r.err);
  free_ran(&r);
  close(ends[0]);
  close(ends[1]);
  remove("pipe.yaml");
  r = check_input(VS_TEST_FOLDER "/../spice/halfwave_bare.cir");
  EXPECT(r.status == 0 && strstr(r.out, "halfwave_bare.cir: a good deck"), "%s%s", r.out, r.err);
  free_ran(&r);
}

/* ---- what is good, and how it is said ---- */

/* Nothing is said against it, but how far a table's forces are from the slope of its energy. */
static void is_good(void *ctx, const char *path) {
  (void)ctx;
  ran r = check(path, NULL, "");
  bool silent = !*r.err || (count_lines(r.err) == 3 && strstr(r.err, ".csv: force_n differs"));
  EXPECT(r.status == 0 && silent && count_lines(r.out) == 1 && strstr(r.out, ": a good "),
         "%s: exit status %d: %s%s", path, r.status, r.out, r.err);
  free_ran(&r);
  r = check(path, NULL, "--quiet");
  EXPECT(r.status == 0 && !*r.err && !*r.out, "%s: %s%s", path, r.out, r.err);
  free_ran(&r);
}

static void all_that_ships_is_good(void) {
  vs_path_list(&vs_scene_shelf, is_good, NULL);
  vs_path_list(&vs_deck_shelf, is_good, NULL);
}

static void verdicts(void) {
  static const struct {
    const char *words, *out, *err;
    int status;
  } ROWS[] = {
      {"paper",
       "paper: a good scene: tier switched (auto: nothing in the scene needs the circuit tier)\n",
       "", 0},
      {"paper --set circuit.r1=1ohm",
       "paper: a good scene: tier circuit (auto: the scene names circuit.r1, which only this tier "
       "has)\n",
       "", 0},
      {"../good.cir",
       "../good.cir: a good deck: a coil; EVA between b and 0, 1 parameter, 2 ports, 1 probe\n", "",
       0},
      {"../good.cir --set r1=1ohm", "",
       "../good.cir: --set r1=1ohm: a deck has no keys to set; check a scene with it\n", 2},
      {"paper --json", "[]\n", "", 0},
      {"../bad.yaml --json",
       "[\n"
       "  {\"file\": \"../bad.yaml\", \"line\": 1, \"column\": 7, \"message\": \"load: a map of "
       "keys is "
       "wanted: {key: value, ...}\"},\n"
       "  {\"file\": \"../bad.yaml\", \"line\": 2, \"column\": 2, \"message\": \"a scene has no "
       "key "
       "'\\\"'; it has: machine, actuator, load, supply, firing, pwm, circuit, events, "
       "instruments, "
       "control, run, start, record, measured, quality, expect, waive, spread, ratings, ambient, "
       "heatsink, measure, limits\"}\n"
       "]\n",
       "", 2},
      {"paper --json --set run.max_step=1e-9us",
       "[\n  {\"file\": \"paper\", \"line\": null, \"column\": null, \"message\": \"run: 2e+15 "
       "steps of "
       "1e-15 s would be needed to run.until; look at run.max_step and at masses, stiffness and "
       "damping\"}\n]\n",
       "", 2},
      {"papr", "",
       "papr: no scene 'papr': not a file, and not a scene that comes with the program; did you "
       "mean 'paper'?\n"
       "papr: no deck 'papr': not a file, and not a deck that comes with the program\n",
       2},
      {"halfwave_snubed", "",
       "halfwave_snubed: no scene 'halfwave_snubed': not a file, and not a scene that comes with "
       "the program\n"
       "halfwave_snubed: no deck 'halfwave_snubed': not a file, and not a deck that comes with the "
       "program; did you mean 'halfwave_snubbed'?\n",
       2},
      {"nowhere.cir", "",
       "nowhere.cir: no deck 'nowhere.cir': not a file, and not a deck that comes with the "
       "program\n",
       2},
  };
  write_file("../good.cir", GOOD_DECK);
  write_file("../bad.yaml", "load: 3\n'\"': 3\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = check(ROWS[k].words, NULL, "");
    EXPECT(r.status == ROWS[k].status, "%s: exit status %d", ROWS[k].words, r.status);
    EXPECT(!strcmp(r.out, ROWS[k].out), "%s: %s", ROWS[k].words, r.out);
    EXPECT(!strcmp(r.err, ROWS[k].err), "%s: %s", ROWS[k].words, r.err);
    free_ran(&r);
  }
}

/* Warnings are no findings. */
static void warnings(void) {
  ran r = check("s.yaml", "firing:\n  angle: 70 deg\n", "");
  CU_ASSERT_EQUAL(r.status, 0);
  EXPECT(!strncmp(r.err, "s.yaml:2:10: warning: firing.angle = 70 deg is below theta", 58) &&
             strstr(r.err, "\n   angle: 70 deg\n          ^\n"),
         "%s", r.err);
  CU_ASSERT_EQUAL(count_lines(r.out), 1);
  free_ran(&r);
  r = check("s.yaml", "firing: {angle: 70 deg}\n", "--quiet");
  CU_ASSERT_EQUAL(r.status, 0);
  EXPECT(!*r.err && !*r.out, "%s%s", r.err, r.out);
  free_ran(&r);
  r = check("s.yaml", "firing: {angle: 70 deg}\n", "--json");
  static const char ROW[] = "[\n  {\"file\": \"s.yaml\", \"line\": 1, \"column\": 17, \"message\": "
                            "\"firing.angle = 70 deg is below theta";
  EXPECT(!strncmp(r.out, ROW, strlen(ROW)) && strstr(r.out, "\", \"level\": \"warning\"}\n]\n"),
         "%s", r.out);
  EXPECT(strstr(r.err, "warning"), "%s", r.err);
  free_ran(&r);
  r = check("s.yaml", "supply: {kind: step, frequency: 60 Hz}\nfiring: {valve: none}\n", "");
  CU_ASSERT_EQUAL(r.status, 0);
  EXPECT(strstr(r.err, "s.yaml:1:22: warning: supply.frequency: with supply.kind: step"), "%s",
         r.err);
  free_ran(&r);
  vs_text deck = {0};
  vs_text_add(&deck, "%s", GOOD_DECK);
  memcpy(strstr(deck.text, "i_thyristor"), "i_something", 11);
  r = check("d.cir", deck.text, "");
  CU_ASSERT_EQUAL(r.status, 0);
  EXPECT(!strncmp(r.err, "d.cir: warning: no probe i_thyristor", 36), "%s", r.err);
  free_ran(&r);
  vs_text_free(&deck);
}

/* ---- check and run ---- */

/* What a scene has besides, so that a run has searches before it, and what decides between a run
 * and another rung: the words of --set. */
static const char *const BESIDES[] = {
    "--set run.until=30ms", "--set run.until=30ms --set start=steady --set firing.every=1",
    "--set run.until=30ms --set firing.every=1 --set load.density=0.5g/cm3 --set "
    "load.fraction=auto",
    "--set run.until=30ms --set start=steady --set firing.every=1 --set actuator.stop={} --set "
    "firing.angle=70deg"};

/* A scene that check calls good is no bad input: its run may fail (1) and break a rating (3), but
 * does not end with 2; and one that check refuses is refused by run. Scenes drawn at random. */
static void run_agrees(void) {
  const char *range = getenv("VS_CHECKED"); /* "100..200" */
  int from = 0, to = 16, refused = 0, good = 0;
  if (range) sscanf(range, "%d..%d", &from, &to);
  for (int k = from; k < to; k++) {
    random_scene s = random_scene_at(k);
    const char *besides = BESIDES[(size_t)k % COUNT(BESIDES)];
    write_file("s.yaml", s.text.text);
    ran c = run("check s.yaml %s --no-jail --quiet", besides);
    ran r = run("run s.yaml %s --set run.verify=never --quiet", besides);
    bool says_bad = c.status == 2;
    refused += says_bad;
    good += !says_bad;
    EXPECT(says_bad == (r.status == 2), "scene %d %s: check %d, run %d: %s", k, besides, c.status,
           r.status, r.err);
    free_ran(&c);
    free_ran(&r);
    random_scene_free(&s);
  }
  static const char SUBHARMONIC[] = "paper --set start=steady --set firing.every=1 --set "
                                    "actuator.stop={} --set firing.angle=60deg --quiet";
  ran c = run("check %s", SUBHARMONIC), r = run("run %s", SUBHARMONIC);
  EXPECT(c.status == 0 && r.status == 1, "check %d, run %d: %s", c.status, r.status, r.err);
  free_ran(&c), free_ran(&r);
  EXPECT(range || (good >= 10 && refused >= 1), "%d are good, %d are refused", good, refused);
}

/* ---- numbers that a double cannot hold ---- */

/* A door each. What cannot be held stands where %s does, once as 1e999 and once as 1e-400. */
static void numbers_beyond(void) {
#define DECK(line) "* d\n*$ probe v = v(a) V \"x\"\nVmains a 0 external\nXeva a 0 eva\n" line "\n"
#define PART(line)                                                                                 \
  "*$ part thyristor \"p\"\n" line "\n.subckt p a k g\nR1 a k 1meg\nR2 g k 1k\n.ends\n"
#define STUDY(values) "scene: paper\nvary: {supply.voltage: " values "}\nreport: [i_peak]\n"
  static const struct {
    const char *file, *text, *command, *place;
  } ROWS[] = {
      {"s.yaml", "supply: {voltage: %s V}\n", "check s.yaml", "s.yaml:1:19: "},
      {"s.yaml", "ratings: {i_peak: 0 .. %s A}\n", "check s.yaml", "s.yaml:1:19: "},
      {"s.yaml", "spread: {supply.voltage: %s %% uniform}\n", "check s.yaml", "s.yaml:1:26: "},
      {"s.yaml", "instruments: {p: {noise: %s um}}\n", "check s.yaml", "s.yaml:1:26: "},
      {NULL, NULL, "check paper --set supply.voltage=%sV", "--set supply.voltage="},
      {NULL, NULL, "run paper --until %ss", "--set run.until="},
      {NULL, NULL, "run paper --tolerance %s", "--set run.tolerance="},
      {NULL, NULL, "run paper --angle %sdeg", "--set firing.angle="},
      {NULL, NULL, "steady paper --along supply.voltage=%sV..240V", "--along supply.voltage="},
      {NULL, NULL, "steady paper --along supply.voltage=9V..240V --at %sV",
       "--at: supply.voltage: "},
      {"t.yaml", STUDY("[%s V, 3 V]"), "check t.yaml", "t.yaml:2:25: "},
      {"t.yaml", STUDY("{from: %s V, to: 3 V, step: 1 V}"), "check t.yaml", "t.yaml:2:31: "},
      {"t.yaml", STUDY("{from: 1 V, to: %s V, step: 1 V}"), "check t.yaml", "t.yaml:2:40: "},
      {"t.yaml", STUDY("{from: 1 V, to: 3 V, step: %s V}"), "check t.yaml", "t.yaml:2:51: "},
      {"t.yaml", STUDY("{log: [%s V, 3 V], n: 3}"), "check t.yaml", "t.yaml:2:31: "},
      {"t.yaml", STUDY("{lin: [1 V, 3 V], n: %s}"), "check t.yaml", "t.yaml:2:45: "},
      {"f.yaml",
       "scene: paper\nfree:\n  machine.trough_mass: {from: %s kg, to: 4 kg}\nmeasures:\n"
       "  i_peak: {value: 1 A, error: 3 %%}\n",
       "check f.yaml", "f.yaml:3:31: "},
      {"f.yaml",
       "scene: paper\nfree:\n  machine.trough_mass: {from: 1 kg, to: 4 kg}\nmeasures:\n"
       "  i_peak: {value: %s A, error: 3 %%}\n",
       "check f.yaml", "f.yaml:5:19: "},
      {"d.cir", DECK("*$ param r = %s ohm 0..3 \"x\""), "check d.cir", "d.cir:5:14: "},
      {"d.cir", DECK("*$ param r = 1 ohm %s..3 \"x\""), "check d.cir", "d.cir:5:14: "},
      {"d.cir", DECK("*$ param r = 1 ohm 0..%s \"x\""), "check d.cir", "d.cir:5:14: "},
      {"d.cir", DECK("*$ rating v -5..%s V \"x\""), "check d.cir", "d.cir:5:13: "},
      {"d.cir", DECK(".param zz=%s"), "check d.cir", "d.cir:5:11: "},
      {"d.cir", DECK("R9 a 0 {3*%s}"), "check d.cir", "d.cir:5:11: "},
      {"d.cir", DECK("B9 b 0 V=v(a)*%s"), "check d.cir", "d.cir:5:15: "},
      {"d.cir", DECK("R9 a 0 .%s"), "check d.cir", "d.cir:5:8: "},
      {"p.inc", PART("*$ limit v_drm = %s V \"x\""), "check p.inc", "p.inc:2:18: "},
      {"p.inc", PART("*$ zth %s K/W 1 ms \"x\""), "check p.inc", "p.inc:2:8: "},
      {"p.inc", PART("*$ pulse 20 us %s 30 A \"x\""), "check p.inc", "p.inc:2:10: "},
      {"p.inc", PART("*$ surge %s 30 A \"x\""), "check p.inc", "p.inc:2:10: "},
      {"p.inc", PART("*$ model dv_dt = %s %% \"x\""), "check p.inc", "p.inc:2:18: "},
      {"p.inc", PART("*$ derate i_t_rms %s degC 100 %% \"x\""), "check p.inc", "p.inc:2:11: "},
      {"p.inc", PART("*$ at 25 degC t_q = %s us \"x\""), "check p.inc", "p.inc:2:21: "},
  };
  static const char *const NUMBERS[] = {"1e999", "1e-400"};
  for (size_t k = 0; k < COUNT(ROWS); k++)
    for (size_t n = 0; n < COUNT(NUMBERS); n++) {
      char text[600], command[200];
      if (ROWS[k].file) {
        snprintf(text, sizeof text, ROWS[k].text, NUMBERS[n]);
        write_file(ROWS[k].file, text);
      }
      snprintf(command, sizeof command, ROWS[k].command, NUMBERS[n]);
      ran r = run("%s", command);
      const char *line = strstr(r.err, ROWS[k].place), *end = line ? strchr(line, '\n') : NULL;
      vs_text said = {0};
      vs_text_add(&said, "%.*s", line && end ? (int)(end - line) : 0, line ? line : "");
      EXPECT(r.status == 2 && line && (strstr(said.text, "write ") || strstr(said.text, " wanted")),
             "%s with %s: status %d: %s", ROWS[k].text ? ROWS[k].text : command, NUMBERS[n],
             r.status, r.err);
      vs_text_free(&said);
      free_ran(&r);
      if (ROWS[k].file) remove(ROWS[k].file);
    }
}

static const vs_test TESTS[] = {
    {"numbers beyond", numbers_beyond},
    {"all that is wrong with a scene", all_that_is_wrong_with_a_scene},
    {"a scene is read to its end", a_scene_is_read_to_its_end},
    {"no echoes", no_echoes},
    {"a value that failed leaves its default", a_value_that_failed_leaves_its_default},
    {"too many rows are an error", too_many_rows_are_an_error},
    {"a hundred are enough", a_hundred_are_enough},
    {"all that is wrong with a deck", all_that_is_wrong_with_a_deck},
    {"names of a broken machine", names_of_a_broken_machine},
    {"what does not fit together", what_does_not_fit_together},
    {"what ngspice refuses", what_ngspice_refuses},
    {"a scene with its deck", a_scene_with_its_deck},
    {"all that ships is good", all_that_ships_is_good},
    {"no pipe is a good scene", no_pipe_is_a_good_scene},
    {"verdicts", verdicts},
    {"warnings", warnings},
    {"run agrees", run_agrees},
};

int main(void) {
  return program_suite("check", TESTS, COUNT(TESTS));
}
