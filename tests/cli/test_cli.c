/* SPDX-License-Identifier: GPL-3.0-or-later
 * The built program from outside: exit status, both streams, and which files are there afterwards.
 */
#include <errno.h>
#include <fcntl.h>
#include <libfyaml.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "age.h"

/* ---- helpers: checks that say what they saw, files, folders ---- */

static void write_bytes(const char *path, const char *bytes, size_t size) {
  FILE *f = fopen(path, "wb");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  CU_ASSERT_EQUAL(fwrite(bytes, 1, size, f), size);
  CU_ASSERT_EQUAL(fclose(f), 0);
}

static const char GOOD_RUN[] = "events.csv run.csv summary.json ",
                  WITH_PEAKS[] = "events.csv peaks.csv run.csv summary.json ",
                  BROKEN_RUN[] = "run.partial.csv ";

/* ---- verdict and audit ---- */

/* A violated rating: files, table and JSON as ever, status 3, one line that names it. An open book:
 * a warning. */
static void verdict_and_audit(void) {
  static const char DECK[] = "*$ port mains = Vm\n*$ probe v_b = v(b) V\n"
                             "*$ rating v_b -1..%s kV \"insulation\"\n"
                             "Vm a 0 external\nR1 a b 100\nXeva b 0 eva\n%s";
  char text[512];
  snprintf(text, sizeof text, DECK, "0.1", "*$ loss r1 = v(a,b)^2/100\n");
  write_file("d.cir", text);
  ran r = run("run paper --set circuit.deck=d.cir --set run.until=0.01s -o out");
  EXPECT(r.status == 3 && count_lines(r.err) == 1 &&
             strstr(r.err, "vibrospice: a rating is violated: v_b = 0.5") &&
             strstr(r.err, "allowed -1..0.1 kV"),
         "status %d: %s", r.status, r.err);
  EXPECT(strstr(r.out, "violated"), "the table says nothing: %s", r.out);
  EXPECT_FILES("out", GOOD_RUN);
  char *json = read_file("out/summary.json");
  EXPECT(strstr(json, "\"violated\": true") && strstr(json, "\"insulation\"") &&
             strstr(json, "\"audit\": \"the books close\""),
         "summary.json: %s", strstr(json, "\"energy\""));
  free(json);
  free_ran(&r);
  remove_tree("out");
  snprintf(text, sizeof text, DECK, "1", "*$ loss r1 = v(a,b)^2/200\n");
  write_file("d.cir", text);
  r = run("run paper --set circuit.deck=d.cir --set run.until=0.01s");
  EXPECT(r.status == 0 && count_lines(r.err) == 1 &&
             strstr(r.err, "warning: the energy books do not close (circuit)"),
         "status %d: %s", r.status, r.err);
  free_ran(&r);
  r = run("run paper --tier analytic");
  EXPECT(r.status == 0 && strstr(r.out, "did 0.0860 J of work that nothing supplied"),
         "the one-way force: %s", r.out);
  free_ran(&r);
}

/* A circuit that sends no current through the EVA told 1.8e-51 J of work and 1.9e-28 m of travel.
 * By the table as in JSON such numbers are 0. */
static void rounding_is_told_as_zero(void) {
  ran r = run("run paper --all --set circuit.deck=bridge_link --set run.until=4ms -o nil");
  EXPECT(strstr(r.out, "work_force") && !strstr(r.out, "e-51") && !strstr(r.out, "e-28"), "%s",
         r.out);
  free_ran(&r);
  char *json = read_file("nil/summary.json");
  int zeros = 0;
  for (const char *at = json; at && (at = strstr(at, "\": ")); at += 3) {
    char *end;
    const double value = strtod(at + 3, &end);
    EXPECT(value == 0 || fabs(value) > 1e-20, "%.60s", at);
    zeros += value == 0 && end > at + 3;
  }
  CU_ASSERT(zeros > 10);
  EXPECT(strstr(json, "\"work_force\": {\"value\": 0,"), "%s", json);
  free(json);
  remove_tree("nil");
  /* a varistor far below its voltage, whose current is 2e-16 A beside the coil's */
  r = run("run two_mass --tier circuit --json --set run.until=7ms");
  EXPECT(strstr(r.out, "\"varistor_3.i_peak\": {\"value\": 0,") &&
             strstr(r.out, "\"varistor_3.power\": {\"value\": 0,") &&
             !strstr(r.out, "\"r1.v_peak\": {\"value\": 0,"),
         "%s", r.out);
  free_ran(&r);
}

/* ---- bad input ---- */

static void bad_scenes_are_refused(void) {
  static const struct {
    const char *scene, *options, *at, *says[2];
  } ROWS[] = {
      {"machine: {trough_mas: 1 kg}\n", "", "s.yaml:1:11: ", {"'trough_mas'", "'trough_mass'"}},
      {"start: {p: -6 mm}\n", "", "s.yaml:1:12: ", {"start.p: -6 mm is beyond the pole", "-6 mm"}},
      {"start: {p: -7 mm}\nactuator: {stop: {}}\n", "", "s.yaml:1:12: ", {"iron", "-6.5 mm"}},
      {"start: {vq: 1 m/s}\n", "", "s.yaml:1:9: ", {"'vq'", NULL}},
      {"\n  \nfiring:\n  angel: 1 deg\n", "", "s.yaml:4:3: ", {"'angel'", "'angle'"}},
      {"machin: {trough_mass: 1 kg}\n", "", "s.yaml:1:1: ", {"'machin'", "'machine'"}},
      {"machine: {trough_mass: 1 m}\n", "", "s.yaml:1:24: ", {"machine.trough_mass", "write kg"}},
      {"machine: {trough_mass: 1}\n", "", "s.yaml:1:24: ", {"no unit", "'1 kg'"}},
      {"machine: {trough_mass: heavy}\n", "", "s.yaml:1:24: ", {"not a number", "kg"}},
      {"actuator:\n  gap: -1 mm\n", "", "s.yaml:2:8: ", {"out of range", "0..1000 mm"}},
      {"load: {fraction: 101 %}\n", "", "s.yaml:1:18: ", {"out of range", "0..1"}},
      {"load: {density: nan g/cm3}\n", "", "s.yaml:1:17: ", {"load.density", "not a finite"}},
      {"supply: {voltage: inf V}\n", "", "s.yaml:1:19: ", {"supply.voltage", "not a finite"}},
      {"supply: {voltage: 1e999 V}\n", "", "s.yaml:1:19: ", {"not a finite", NULL}},
      {"measured: {i_peak: 1e308 kA}\n", "", "s.yaml:1:20: ", {"1e308 kA", NULL}},
      {"machine: {base_com: 3 mm}\n", "", "s.yaml:1:21: ", {"[x, y]", NULL}},
      {"machine: {base_com: [3 mm]}\n", "", "s.yaml:1:22: ", {"[x, y]", NULL}},
      {"machine: {base_com: [3 mm, 4 kg]}\n", "", "s.yaml:1:28: ", {"wrong unit", "write mm"}},
      {"machine: {m14: zero}\n", "", "s.yaml:1:16: ", {"'zero'", "paper|derived"}},
      {"firing: {every: 1.5}\n", "", "s.yaml:1:17: ", {"not a whole number", NULL}},
      {"firing: {every: 1, pulse_width: 30 ms}\n", "", "s.yaml:1:33: ", {"20 ms", NULL}},
      {"machine: {trough_mass: 1 kg\n", "", "s.yaml:2:1: ", {"not YAML", NULL}},
      {"machine:\n\ttrough_mass: 1 kg\n", "", "s.yaml:2:1: ", {"not YAML", "tab"}},
      {"run: {until: 0,1 s}\n", "", "s.yaml:1:14: ", {"write 0.1 s", NULL}},
      {"run:\n  until: 0,1 s\n", "", "s.yaml:2:10: ", {"write '0.1 s'", NULL}},
      {"run: {until: 1 s}\nrun: {until: 2 s}\n",
       "",
       "s.yaml:2:1: ",
       {"duplicate key 'run', which stands in line 1, too", NULL}},
      {"run: {until: 1 s}\n---\nrun: {until: 2 s}\n", "", "s.yaml", {"second document", NULL}},
      {"run: &a {until: 1 s}\nload: *a\n", "", "s.yaml:2:", {"aliases", NULL}},
      {"machine: [1, 2]\n", "", "s.yaml:1:11: ", {"machine", "a map"}},
      {"machine: 3\n", "", "s.yaml:1:10: ", {"machine", "a map"}},
      {"machine: {trough_mass: [1 kg]}\n", "", "s.yaml:1:25: ", {"one value", "0.83 kg"}},
      {"[1, 2]\n", "", "s.yaml:1:2: ", {"key: value", NULL}},
      {"hello\n", "", "s.yaml:1:1: ", {"key: value", NULL}},
      {"\"a\\nb\": 1\n", "", "s.yaml:1:", {"no key", NULL}},
      {"circuit: {deck: halfwave_snubed}\n",
       "",
       "s.yaml:1:17: ",
       {"no deck", "'halfwave_snubbed'"}},
      {"circuit: {r3: 1 ohm}\n", "", "s.yaml:1:11: ", {"'r3'", "did you mean 'r"}},
      {"circuit: {r1: 0 ohm}\n", "", "s.yaml:1:15: ", {"out of range", "0.001..1e+06 ohm"}},
      {"firing: {angle: 0 deg}\n", "", "s.yaml:1:17: ", {"out of range", "0..180 deg"}},
      {"firing: {angle: 180 deg}\n", "", "s.yaml:1:17: ", {"out of range", "0..180 deg"}},
      {"firing: {angle: 181 deg}\n", "", "s.yaml:1:17: ", {"out of range", "0..180 deg"}},
      {"firing: {angle: -5 deg}\n", "", "s.yaml:1:17: ", {"out of range", "0..180 deg"}},
      {"run: {tier: swiched}\n", "", "s.yaml:1:13: ", {"'swiched'", "switched"}},
      {"run: {until: 0 s}\n", "", "s.yaml:1:14: ", {"out of range", NULL}},
      {"run: {max_step: 1e-9 us}\n", "", "", {"steps", "run.max_step"}},
      {"machine: {trough_mass: 1e-300 kg}\n", "", "s.yaml:1:24: ", {"1e-06..10000 kg", NULL}},
      {"run: {tolerance: 1e-11}\n", "", "s.yaml:1:18: ", {"1e-10..0.1", NULL}},
      {"run: {tolerance: 1e-9}\n", "--tier circuit", "s.yaml:1:18: ", {"circuit", "allowed"}},
      {"record: [p, forze]\n", "", "s.yaml:1:13: ", {"'forze'", "'force'"}},
      {"record: [p, v_al]\n", "--tier circuit", "s.yaml:1:13: ", {"'v_al'", "'v_ak'"}},
      {"record: [p, v_ak]\n", "--tier switched", "s.yaml:1:13: ", {"v_ak", "tier circuit"}},
      {"record: [p, u, p]\n", "", "s.yaml:1:16: ", {"probe p", "second time"}},
      {"record: []\n", "", "s.yaml:1:1: ", {"record", "'all'"}},
      {"measured: {i_peek: 1 A}\n", "", "s.yaml:1:12: ", {"'i_peek'", "'i_peak'"}},
      {"measured: {i_peak: 1 N}\n", "", "s.yaml:1:20: ", {"wrong unit", "write A"}},
      {"", "--tier swiched", "--tier swiched: ", {"switched", NULL}},
      {"", "--set run.until", "--set run.until: ", {"KEY=VALUE", NULL}},
      {"", "--set =1", "--set =1: ", {"KEY=VALUE", NULL}},
      {"", "--set a.b.c.d=1", "--set a.b.c.d=1: ", {"no key 'a'", NULL}},
      {"", "--set run.until.x.y=1", "--set run.until.x.y=1: ", {"run.until", "one value"}},
      {"", "--set run.untill=1s", "--set run.untill=1s: ", {"'untill'", "'until'"}},
      {"", "--set run.until=[1", "--set run.until=[1: ", {"cannot be read", NULL}},
      {"", "--set run.until=", "--set run.until=: ", {"run.until", "not a number"}},
      {"", "--set 'run.until=1 x\ny'", "--set run.until=1 x", {"run.until", NULL}},
      {"", "--set firing.angle=95kg", "--set firing.angle=95kg: ", {"wrong unit", "deg"}},
      {"", "--digits 0", "", {"--digits", "1 to 17"}},
      {"", "--digits 18", "", {"--digits", "1 to 17"}},
      {"", "--digits x", "", {"--digits", "1 to 17"}},
      {"", "--digits 9x", "", {"--digits", "1 to 17"}},
      {"", "--frobnicate", "", {"--frobnicate", NULL}},
      {"", "--set", "", {"--set", NULL}},
      {"", "t.yaml", "", {"'t.yaml'", "too many"}},
  };
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    char words[256], what[512];
    snprintf(words, sizeof words, "run s.yaml -o out %s", ROWS[k].options);
    snprintf(what, sizeof what, "%.200s with '%.200s'", words, ROWS[k].scene);
    write_file("s.yaml", ROWS[k].scene);
    refuse(words, what, ROWS[k].at, ROWS[k].says, __LINE__);
  }
}

static void bad_commands_are_refused(void) {
  static const struct {
    const char *words, *says[2];
  } ROWS[] = {
      {"rum paper", {"'rum'", "'run'"}},
      {"xyzzy", {"'xyzzy'", "--help"}},
      {"run", {"SCENE", "--help"}},
      {"run -o out", {"SCENE", "--help"}},
      {"run papr -o out", {"'papr'", "'paper'"}},
      {"run zzzzzzz -o out", {"'zzzzzzz'", "not a file"}},
      {"run '' -o out", {"''", "not a file"}},
      {"run folder -o out", {"'folder'", "not a file"}},
      {"run plain/s.yaml -o out", {"'plain/s.yaml'", "not a file"}},
      {"run socket -o out", {"socket: cannot be opened", NULL}},
      {"run /proc/self/mem -o out", {"/proc/self/mem", "cannot be read"}},
      {"run zero.yaml -o out", {"zero.yaml", "zero byte"}},
      {"run paper -o plain/out", {"plain/out", "Not a directory"}},
      {"run paper -o plain", {"plain", "not a directory"}},
      {"run paper -o /proc/x", {"/proc/x", "cannot be made"}},
      {"run paper -o ''", {"output directory", NULL}},
      {"list prob", {"'prob'", "'probes'"}},
      {"list frobnicate", {"'frobnicate'", "parameters"}},
      {"list probes tiers laws", {"'laws'", "too many"}},
      {"list probes --deck halfwave_snubed", {"no deck", "'halfwave_snubbed'"}},
      {"modes", {"SCENE", "--help"}},
      {"modes papr", {"'papr'", "'paper'"}},
      {"modes paper -o plain/out", {"plain/out", "Not a directory"}},
      {"modes paper --tier switched", {"--tier", NULL}},
      {"export -o x.cir", {"SCENE", "--help"}},
      {"export paper", {"-o FILE", "--help"}},
      {"export papr -o x.cir", {"'papr'", "'paper'"}},
      {"export paper -o folder", {"-o folder", "name of a file"}},
      {"export paper -o folder/", {"-o folder/", "name of a file"}},
      {"export paper -o ''", {"-o ", "name of a file"}},
      {"export paper -o nowhere/x.cir", {"nowhere/x.cir", "No such file"}},
      {"export paper -o pipe", {"pipe: is a device, a pipe", "name a file"}},
      {"export paper -o link", {"link: is a device, a pipe", "name a file"}},
      {"export paper -o stream", {"stream: is a device, a pipe", "name a file"}},
      {"export paper -o x.cir --set firing.angle=181deg", {"firing.angle", "out of range"}},
      {"plot", {"DIR", "--help"}},
      {"plot folder", {"run.csv", "No such file"}},
      {"plot nowhere", {"nowhere/run.csv", "No such file"}},
      {"plot folder -o sheet.pdf", {"sheet.pdf", ".png or .svg"}},
      {"plot folder -o sheet", {"sheet", ".png or .svg"}},
  };
  write_file("plain", "");
  CU_ASSERT_EQUAL(mknod("socket", S_IFSOCK | 0600, 0), 0); /* root may open all else */
  CU_ASSERT_EQUAL(mkfifo("pipe", 0600), 0);
  CU_ASSERT_EQUAL(symlink("pipe", "link"), 0);
  CU_ASSERT_EQUAL(symlink("/proc/self/fd/1", "stream"), 0);
  write_bytes("zero.yaml", "run: {until: 1 s}\0\n", 19);
  CU_ASSERT_EQUAL(mkdir("folder", 0777), 0);
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++)
    refuse(ROWS[k].words, ROWS[k].words, "", ROWS[k].says, __LINE__);
  EXPECT_FILES("folder", "");
  ran r = run("%s", "");
  CU_ASSERT_EQUAL(r.status, 2);
  CU_ASSERT_STRING_EQUAL(r.out, "");
  CU_ASSERT_PTR_NOT_NULL(strstr(r.err, "Usage: vibrospice"));
  free_ran(&r);
}

/* A file that a scene or study names is read whole, so that a pipe would be waited for. */
static void pipes_in_files_are_refused(void) {
  static const struct {
    const char *text, *at;
  } ROWS[] = {
      {"actuator: {law: pipe.csv}\n", "s.yaml:1:17: "},
      {"instruments: {set: pipe.csv}\n", "s.yaml:1:20: "},
      {"machine: {model: pipe.csv}\n", "s.yaml:1:18: "},
      {"circuit: {deck: pipe.csv}\n", "s.yaml:1:17: "},
      {"scene: pipe.csv\nvary: {firing.angle: [90 deg]}\n", "s.yaml:1:8: "},
      {"scene: paper\nvary: pipe.csv\n", "s.yaml:2:7: "},
  };
  CU_ASSERT_EQUAL(mkfifo("pipe.csv", 0600), 0);
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    write_file("s.yaml", ROWS[k].text);
    ran r = run("check s.yaml");
    EXPECT(r.status == 2 && strstr(r.err, ROWS[k].at) && strstr(r.err, "a file is wanted"),
           "%s: %d %s", ROWS[k].text, r.status, r.err);
    free_ran(&r);
  }
}

/* A key below a list names one of its elements; it never throws the list away. */
static void lists_are_kept(void) {
  static const char STOPS[] =
      "firing: {angle: 115 deg, every: 1}\nrun: {until: 1 ms}\nactuator:\n  stop:\n"
      "    - {at: 1.9 mm, stiffness: 1e6 N/m}\n    - {at: 2.5 mm, stiffness: 1e6 N/m}\n";
  static const char *const KEYS[] = {"actuator.stop.stiffness=1e6N/m",
                                     "actuator.stop.3.stiffness=1e6N/m",
                                     "actuator.stop.0.stiffness=1e6N/m"},
                           *const SAYS[] = {"actuator.stop is a list of 2",
                                            "actuator.stop.1 to actuator.stop.2"};
  char words[128];
  write_file("stops.yaml", STOPS);
  for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS; k++) {
    snprintf(words, sizeof words, "run stops.yaml --set %s", KEYS[k]);
    refuse(words, KEYS[k], "", SAYS, __LINE__);
  }
  RUN_GOOD("run stops.yaml --quiet --set actuator.stop.2.stiffness=1e6N/m");
  RUN_GOOD("run paper --quiet --set run.until=1ms --set events=[] --set events.e.kind=sag --set "
           "events.e.at=0s");
  write_file("s.yaml", "scene: stops.yaml\nset: {actuator.stop.stiffness: 1e6 N/m}\n"
                       "vary: {firing.every: [1, 2]}\nreport: [p_min]\n");
  ran r = run("study s.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "s.yaml:2:7: ") && strstr(r.err, SAYS[0]), "%d %s",
         r.status, r.err);
  free_ran(&r);
  r = run("run stops.yaml --set firing.angle.x=1");
  EXPECT(r.status == 2 && strstr(r.err, "--set firing.angle.x=1: firing.angle: one value"), "%s",
         r.err);
  free_ran(&r);
}

/* A deck of which one line is the row's. */
static const char DECK_HEAD[] = "*$ port mains = Vmains\n"
                                "*$ port gate = Vgate\n"
                                "*$ param r1 = 1 ohm 0..2 \"first\"\n"
                                "*$ probe v_b = v(b) V\n"
                                "Vmains a 0 external\n"
                                "Vgate g 0 external\n"
                                "Rg g 0 1k\n"
                                "R1 a b {r1}\n";
static const char DECK_EVA[] = "Xeva b 0 eva\n";

static void write_deck(const char *line, const char *eva) {
  vs_text deck = {0};
  vs_text_add(&deck, "%s%s\n%s", DECK_HEAD, line, eva);
  write_file("d.cir", deck.text);
  vs_text_free(&deck);
}

static void bad_decks_are_refused(void) {
  static const struct {
    const char *line, *at, *says[2];
  } ROWS[] = {
      {"*$ prob x = v(a) V", "d.cir:9:4: ", {"'*$ prob'", "'probe'"}},
      {"  *$ frobnicate", "d.cir:9:6: ", {"title, param, port, line", NULL}},
      {"*$ port mians = Vx", "d.cir:9:9: ", {"'mians'", "mains, gate"}},
      {"*$ port gate+30kg = Vx", "d.cir:9:9: ", {"wrong unit", "deg"}},
      {"*$ port gate = R1", "d.cir:9:9: ", {"voltage source", "'r1'"}},
      {"*$ port gate+30deg = Vgate", "d.cir:9:9: ", {"vgate", "already"}},
      {"*$ port gate Vx", "d.cir:9:", {"port NAME = SOURCE", NULL}},
      {"Xfirst a 0 eva", "d.cir:10:1: ", {"second EVA", NULL}},
      {"*$ param r1 = 1 ohm 0..2 \"again\"", "d.cir:9:15: ", {"r1", "second time"}},
      {"*$ param deck = 1 ohm 0..2 \"own\"", "d.cir:9:17: ", {"deck", "the program's"}},
      {"*$ param r2 = 1 ohm 2..0 \"x\"", "d.cir:9:15: ", {"r2", "MIN..MAX"}},
      {"*$ param r2 = 1 ohm 0-2 \"x\"", "d.cir:9:15: ", {"r2", "MIN..MAX"}},
      {"*$ param r2 = 1 ohm", "d.cir:9:15: ", {"r2", "MIN..MAX"}},
      {"*$ param r2 = 3 ohm 0..2 \"x\"", "d.cir:9:15: ", {"r2", "outside its own range"}},
      {"*$ param r2 = 3 ohms 0..9 \"x\"", "d.cir:9:15: ", {"r2", "unit"}},
      {"*$ param r2 = 1 ohm 0..2 x", "d.cir:9:26: ", {"quotes", NULL}},
      {"*$ probe v_b = v(a) V", "d.cir:9:", {"v_b", "second time"}},
      {"*$ probe x = w(a) V", "d.cir:9:", {"v(n)", NULL}},
      {".control", "d.cir:9:1: ", {".control", "does not belong"}},
      {"  .STEP r1 1 2 1", "d.cir:9:3: ", {".step", "does not belong"}},
      {".controlx\nshell touch made_by_the_deck", "d.cir:9:1: ", {".control", NULL}},
      {"\f.control\nshell touch made_by_the_deck\n\f.endc",
       "d.cir:9:",
       {"control character", NULL}},
      {".optionsx reltol=1", "d.cir:9:1: ", {".options", NULL}},
      {".include script.inc", "script.inc:1:1: ", {".control", "does not belong"}},
      {"*$ probe x = v(nowhere) V", "", {"v(nowhere)", NULL}},
      {"*$ port gate+180deg = Vnowhere", "d.cir:9:", {"vnowhere", NULL}},
      {"Vfree free 0 external", "d.cir:9:1: ", {"vfree", NULL}},
      {"i(Vthy)",
       "d.cir:9:1: ",
       {"an element is wanted", NULL}}, /* libngspice never comes back from it */
      {"pwr(", "d.cir:9:1: ", {"an element is wanted", NULL}},
      {"x", "d.cir:9:1: ", {"an element is wanted", NULL}},
      {".include /dev/zero", "d.cir:9:1: /dev/zero ", {"a file is wanted", NULL}},
      {"Q1 a b", "", {"q1 a b", NULL}},
  };
  write_file("s.yaml", "circuit: {deck: d.cir}\nrun: {until: 2 ms}\n");
  write_file("script.inc", ".control\nshell touch made_by_the_deck\n.endc\n");
  write_deck("* nothing wrong", DECK_EVA);
  RUN_GOOD("run s.yaml -o out");
  remove_tree("out");
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    write_deck(ROWS[k].line, DECK_EVA);
    refuse("run s.yaml -o out", ROWS[k].line, ROWS[k].at, ROWS[k].says, __LINE__);
  }
  static const char *const NO_EVA[] = {"d.cir", "no EVA"}, *const NESTED[] = {"q1 a b", NULL};
  write_deck("", "");
  refuse("run s.yaml -o out", "a deck without an EVA", "", NO_EVA, __LINE__);
  write_deck("Q1 a b", DECK_EVA);
  refuse("run s.yaml -o new/folders/out", "a nested output folder", "", NESTED, __LINE__);
}

/* ---- run.csv ---- */

typedef struct table {
  char *text, *header;
  int rows;
  double first_s, last_s, p_min;
} table;

static table read_table(const char *path) {
  table t = {.text = read_file(path), .first_s = NAN, .last_s = NAN};
  char *rest = t.text;
  t.header = strsep(&rest, "\n");
  for (char *row; (row = strsep(&rest, "\n")) && *row; t.rows++) {
    char *end;
    t.last_s = strtod(row, &end);
    if (t.rows == 0) t.first_s = t.last_s;
    if (*end == ',') t.p_min = fmin(t.p_min, strtod(end + 1, NULL));
  }
  return t;
}

static const char ALL[] = "t_s,p_m,u_m,w_m,phi_rad,vp_m_s,vu_m_s,vw_m_s,vphi_rad_s,ap_m_s2,au_m_s2,"
                          "aw_m_s2,aphi_rad_s2,z_m,lambda_wb,i_a,force_n,v_eva_v,v_mains_v";

static void columns(void) {
  static const struct {
    const char *words, *header;
  } ROWS[] = {
      {"--tier analytic", ""},
      {"--tier switched", ""},
      {"--tier circuit", ",v_ak_v,i_thyristor_a,v_c1_v,v_c2_v,i_source_a"},
      {"--set record=[p,i]", "t_s,p_m,i_a"},
      {"--set record=[i,p]", "t_s,i_a,p_m"},
      {"--set record=force", "t_s,force_n"},
      {"--set record=[p,v_ak]", "t_s,p_m,v_ak_v"},
  };
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    char words[128], header[512];
    snprintf(words, sizeof words, "run paper -o out --set run.until=2ms %s", ROWS[k].words);
    bool whole = !strncmp(ROWS[k].header, "t_s", 3);
    snprintf(header, sizeof header, "%s%s", whole ? "" : ALL, ROWS[k].header);
    RUN_GOOD(words);
    EXPECT_FILES("out", strcmp(ROWS[k].words, "--tier circuit") ? GOOD_RUN : WITH_PEAKS);
    table t = read_table("out/run.csv");
    EXPECT(!strcmp(t.header, header), "%s: %s", words, t.header);
    free(t.text);
  }
  remove_tree("out");
}

static void rows(void) {
  static const struct {
    const char *tier, *until, *sample;
    int rows;
    double last_s;
  } ROWS[] = {
      {"switched", "0.05s", "0.1ms", 501, 0.05},
      {"circuit", "0.05s", "0.1ms", 501, 0.05},
      {"analytic", "0.05s", "0.1ms", 501, 0.05},
      {"switched", "0.03s", "0.3ms", 101, 0.03},
      {"circuit", "0.03s", "0.3ms", 101, 0.03},
      {"switched", "50.5ms", "1ms", 51, 0.05},
      {"circuit", "1ms", "1s", 1, 0},
      {"switched", "0.7s", "70ms", 11, 0.7},
  };
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    char words[128];
    snprintf(words, sizeof words,
             "run paper -o out --tier %s --set run.until=%s --set run.sample=%s", ROWS[k].tier,
             ROWS[k].until, ROWS[k].sample);
    RUN_GOOD(words);
    table t = read_table("out/run.csv");
    EXPECT(t.rows == ROWS[k].rows && t.first_s == 0 && t.last_s == ROWS[k].last_s,
           "%s: %d rows from %.17g to %.17g", words, t.rows, t.first_s, t.last_s);
    free(t.text);
  }
  remove_tree("out");
}

/* Every number of the file survives printf(digits) of what it is read as; the longest is that long.
 */
static void expect_digits(const char *path, int digits) {
  char *text = read_file(path), *rest = strchr(text, '\n');
  int differ = 0, numbers = 0;
  size_t longest = 0;
  CU_ASSERT_PTR_NOT_NULL_FATAL(rest);
  rest++;
  for (char *word; (word = strsep(&rest, ",\n")) && *word; numbers++) {
    char again[64];
    snprintf(again, sizeof again, "%.*g", digits, strtod(word, NULL));
    differ += strcmp(again, word) != 0;
    size_t mantissa = strspn(word, "-0.") + strspn(word + strspn(word, "-0."), "0123456789.");
    if (mantissa > longest) longest = mantissa;
  }
  EXPECT(numbers > 1000 && differ == 0, "--digits %d: %d of %d numbers differ", digits, differ,
         numbers);
  EXPECT(longest >= (size_t)digits, "--digits %d: longest number has %zu digits", digits, longest);
  free(text);
}

static void digits(void) {
  static const int DIGITS[] = {1, 9, 17};
  for (size_t k = 0; k < sizeof DIGITS / sizeof *DIGITS; k++) {
    char words[128];
    snprintf(words, sizeof words,
             "run paper -o out --tier switched --set run.until=0.02s --digits %d", DIGITS[k]);
    RUN_GOOD(words);
    expect_digits("out/run.csv", DIGITS[k]);
  }
  RUN_GOOD("run paper -o plain_run --tier switched --set run.until=0.02s");
  expect_digits("plain_run/run.csv", 9);
  remove_tree("out");
  remove_tree("plain_run");
}

/* ---- summary.json, events.csv ---- */

static const struct fy_parse_cfg STRICT = {.flags = FYPCF_QUIET | FYPCF_JSON_FORCE};

/* The document borrows the text. */
static struct fy_document *parse_json(const char *text) {
  struct fy_document *doc = fy_document_build_from_string(&STRICT, text, FY_NT);
  CU_ASSERT_PTR_NOT_NULL_FATAL(doc);
  return doc;
}

static struct fy_document *read_json(const char *path) {
  struct fy_document *doc = fy_document_build_from_file(&STRICT, path);
  CU_ASSERT_PTR_NOT_NULL_FATAL(doc);
  return doc;
}

static bool there(struct fy_document *doc, const char *path) {
  return fy_node_by_path(fy_document_root(doc), path, FY_NT, FYNWF_DONT_FOLLOW) != NULL;
}

/* Copy of a scalar as it is written; empty when it is not there. */
static const char *text_at(struct fy_document *doc, const char *path, char text[256]) {
  struct fy_node *node = fy_node_by_path(fy_document_root(doc), path, FY_NT, FYNWF_DONT_FOLLOW);
  size_t length = 0;
  const char *scalar = node && fy_node_is_scalar(node) ? fy_node_get_scalar(node, &length) : "";
  snprintf(text, 256, "%.*s", (int)length, scalar);
  return text;
}

static double number_at(struct fy_document *doc, const char *path) {
  char text[256], *end;
  double value = strtod(text_at(doc, path, text), &end);
  return end == text || *end ? NAN : value;
}

static double measure_of(struct fy_document *doc, const char *name, const char *what) {
  char path[128];
  snprintf(path, sizeof path, "/measures/%s/%s", name, what);
  return number_at(doc, path);
}

/* Table 1 of the paper, and the rest of an empty scene. */
static void check_table_1(struct fy_document *doc) {
  static const struct {
    const char *key;
    double value;
    const char *unit;
  } ROWS[] = {
      {"machine/trough_mass", 0.83, "kg"},
      {"machine/base_mass", 4, "kg"},
      {"machine/trough_inertia", 3.86e-3, "kg.m2"},
      {"machine/base_inertia", 0.017, "kg.m2"},
      {"machine/spring_angle", 70, "deg"},
      {"machine/spring_stiffness", 43000, "N/m"},
      {"machine/mount_stiffness_x", 8000, "N/m"},
      {"machine/mount_stiffness_y", 40000, "N/m"},
      {"machine/spring_damping", 1.2, "N.s/m"},
      {"machine/mount_damping_x", 0.1, "N.s/m"},
      {"machine/mount_damping_y", 0.5, "N.s/m"},
      {"actuator/gap", 6, "mm"},
      {"actuator/pole_cover", 0.5, "mm"},
      {"actuator/inductance", 1.6, "H"},
      {"actuator/resistance", 92, "ohm"},
      {"load/density", 0, "g/cm3"},
      {"load/volume", 380, "cm3"},
      {"supply/voltage", 440, "V"},
      {"supply/frequency", 50, "Hz"},
      {"supply/phase", 0, "deg"},
      {"supply/resistance", 0.5, "ohm"},
      {"supply/inductance", 0.5, "mH"},
      {"firing/angle", 100, "deg"},
      {"firing/pulse_width", 8, "ms"},
      {"run/until", 2, "s"},
      {"run/sample", 0.1, "ms"},
      {"run/tolerance", 1e-4, ""},
  };
  static const struct {
    const char *key;
    double x, y;
  } PAIRS[] = {
      {"base_com", 194, 89}, {"trough_com", 92, 129}, {"mount_3", 33, 15}, {"mount_4", 211.83, 15}};
  char path[128], unit[256];
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    snprintf(path, sizeof path, "/scene/%s/value", ROWS[k].key);
    EXPECT(number_at(doc, path) == ROWS[k].value, "%s = %.17g", path, number_at(doc, path));
    snprintf(path, sizeof path, "/scene/%s/unit", ROWS[k].key);
    EXPECT(!strcmp(text_at(doc, path, unit), ROWS[k].unit), "%s = %s", path, unit);
  }
  for (size_t k = 0; k < sizeof PAIRS / sizeof *PAIRS; k++) {
    snprintf(path, sizeof path, "/scene/machine/%s/value/0", PAIRS[k].key);
    EXPECT(number_at(doc, path) == PAIRS[k].x, "%s = %.17g", path, number_at(doc, path));
    snprintf(path, sizeof path, "/scene/machine/%s/value/1", PAIRS[k].key);
    EXPECT(number_at(doc, path) == PAIRS[k].y, "%s = %.17g", path, number_at(doc, path));
  }
  CU_ASSERT_STRING_EQUAL(text_at(doc, "/scene/firing/every", unit), "once");
  CU_ASSERT_STRING_EQUAL(text_at(doc, "/scene/actuator/stop", unit), "none");
  CU_ASSERT_STRING_EQUAL(text_at(doc, "/scene/circuit/deck", unit), "halfwave_snubbed");
}

static void an_empty_scene_is_the_paper(void) {
  write_file("empty.yaml", "");
  RUN_GOOD("run empty.yaml -o empty");
  RUN_GOOD("run paper -o paper");
  struct fy_document *empty = read_json("empty/summary.json"),
                     *paper = read_json("paper/summary.json");
  check_table_1(empty);
  vs_trial *t = vs_trial_read("paper", NULL, (const char *[]){NULL});
  vs_measure m;
  CU_ASSERT_EQUAL(t->status, VS_OK);
  for (int k = 0; vs_measure_at(&t->scene.setup.model, k, &m); k++) {
    const char *name = m.name;
    double value = measure_of(empty, name, "value");
    EXPECT(isfinite(value) && value == measure_of(paper, name, "value"), "%s = %.17g and %.17g",
           name, value, measure_of(paper, name, "value"));
  }
  vs_trial_free(t);
  CLOSE(measure_of(paper, "i_peak", "measured"), 0.95, 0);
  CLOSE(measure_of(paper, "p_first_peak", "measured"), -1.5e-3, 0);
  CU_ASSERT_FALSE(there(empty, "/measures/i_peak/measured"));
  char *a = read_file("empty/run.csv"), *b = read_file("paper/run.csv");
  CU_ASSERT_STRING_EQUAL(a, b);
  free(a);
  free(b);
  fy_document_destroy(empty);
  fy_document_destroy(paper);
  remove_tree("empty");
  remove_tree("paper");
}

static void check_events(struct fy_document *doc) {
  char *text = read_file("out/events.csv");
  double fires = 0, extinct = 0;
  int end = 0;
  int n = sscanf(text, "t_s,what\n%lf,thyristor fires\n%lf,thyristor extinct\n%n", &fires, &extinct,
                 &end);
  EXPECT(n == 2 && end > 0 && !text[end], "events.csv: %s", text);
  CLOSE_OF(fires, 1 / 180.0, 1, 1e-9); /* 100 degrees of 50 Hz */
  CLOSE_OF(fires, measure_of(doc, "t_fire", "value"), 1, 1e-9);
  CLOSE_OF(extinct, measure_of(doc, "t_extinction", "value"), 1, 1e-9);
  CU_ASSERT(extinct > 0.0135 && extinct < 0.014);
  free(text);
}

static void summary_and_events(void) {
  static const char *const TIERS[] = {"analytic", "switched", "circuit"};
  static const char *const MUST[] = {"/program/version",
                                     "/program/ngspice",
                                     "/program/gsl",
                                     "/scene/firing/angle/unit",
                                     "/tier",
                                     "/why",
                                     "/measures",
                                     "/measures/force_peak/unit",
                                     "/energy/residual",
                                     "/measures/i_peak/at_s",
                                     "/cost/wall_s",
                                     "/cost/steps",
                                     "/verdict"};
  for (size_t k = 0; k < sizeof TIERS / sizeof *TIERS; k++) {
    char text[256];
    ran r = run("run paper -o out --json --tier %s --set run.until=0.05s", TIERS[k]);
    expect_good(&r, TIERS[k], __LINE__);
    EXPECT_FILES("out", strcmp(TIERS[k], "circuit") ? GOOD_RUN : WITH_PEAKS);
    char *file = read_file("out/summary.json");
    CU_ASSERT_STRING_EQUAL(r.out, file);
    struct fy_document *doc = parse_json(r.out);
    for (size_t m = 0; m < sizeof MUST / sizeof *MUST; m++)
      EXPECT(there(doc, MUST[m]), "%s: no %s", TIERS[k], MUST[m]);
    CU_ASSERT_STRING_EQUAL(text_at(doc, "/tier", text), TIERS[k]);
    CU_ASSERT_STRING_EQUAL(text_at(doc, "/program/version", text), VS_VERSION);
    CU_ASSERT(number_at(doc, "/scene/run/until/value") == 0.05);
    CU_ASSERT(number_at(doc, "/cost/steps") > 10);
    check_events(doc);
    fy_document_destroy(doc);
    free(file);
    free_ran(&r);
  }
  remove_tree("out");
}

static void a_reproducible_run_gives_the_same_bytes(void) {
  static const char *const TIERS[] = {"analytic", "switched", "circuit"};
  static const char *const FILES[] = {"run.csv", "events.csv", "summary.json"};
  for (size_t k = 0; k < sizeof TIERS / sizeof *TIERS; k++) {
    char words[160];
    for (int n = 1; n <= 2; n++) {
      snprintf(words, sizeof words,
               "run paper -o out%d --reproducible --digits 17 --tier %s --set run.until=0.05s", n,
               TIERS[k]);
      RUN_GOOD(words);
    }
    struct fy_document *doc = read_json("out1/summary.json");
    CU_ASSERT_FALSE(there(doc, "/cost"));
    CU_ASSERT_TRUE(there(doc, "/measures/i_peak/value"));
    fy_document_destroy(doc);
    for (size_t f = 0; f < sizeof FILES / sizeof *FILES; f++) {
      char path[64];
      snprintf(path, sizeof path, "out1/%s", FILES[f]);
      char *a = read_file(path);
      path[3] = '2';
      char *b = read_file(path);
      EXPECT(*a && !strcmp(a, b), "tier %s: two different %s", TIERS[k], FILES[f]);
      free(a);
      free(b);
    }
  }
  remove_tree("out1");
  remove_tree("out2");
}

static void streams_and_files(void) {
  char *before = listing(".");
  ran shown = run("run paper --set run.until=0.03s");
  expect_good(&shown, "table", __LINE__);
  CU_ASSERT_PTR_NOT_NULL(strstr(shown.out, "i_peak"));
  CU_ASSERT_PTR_NOT_NULL(strstr(shown.out, "computed is")); /* beside the paper's value */
  ran json = run("run paper --set run.until=0.03s --json --quiet --reproducible");
  expect_good(&json, "json", __LINE__);
  struct fy_document *doc = parse_json(json.out);
  char line[64], *at = strstr(shown.out, "i_peak");
  snprintf(line, sizeof line, "%.4g mA", 1e3 * measure_of(doc, "i_peak", "value"));
  EXPECT(at && strstr(at, line), "table without '%s': %s", line, shown.out);
  ran quiet = run("run paper --set run.until=0.03s --quiet");
  expect_good(&quiet, "quiet", __LINE__);
  CU_ASSERT_STRING_EQUAL(quiet.out, "");
  expect_files(".", before, __LINE__);
  fy_document_destroy(doc);
  free_ran(&shown);
  free_ran(&json);
  free_ran(&quiet);
  free(before);
}

static void auto_says_which_tier_and_why(void) {
  static const struct {
    const char *scene, *options, *tier, *why[2];
  } ROWS[] = {
      {"", "", "switched", {"auto", "nothing"}},
      {"circuit:\n", "", "switched", {"auto", "nothing"}},
      {"record: [p, i]\n", "", "switched", {"auto", "nothing"}},
      {"circuit: {r1: 220 ohm}\n", "", "circuit", {"auto", "circuit.r1"}},
      {"", "--set circuit.r1=220ohm", "circuit", {"auto", "circuit.r1"}},
      {"supply: {inductance: 1 mH}\n", "", "circuit", {"auto", "supply.inductance"}},
      {"supply: {resistance: 1 ohm}\n", "", "circuit", {"auto", "supply.resistance"}},
      {"run: {method: gear}\n", "", "circuit", {"auto", "run.method"}},
      {"supply: {voltage: 400 V}\n", "", "switched", {"auto", "nothing"}},
      {"record: [v_ak]\n", "", "circuit", {"auto", "v_ak"}},
      {"record: [p, v_ak]\n", "", "circuit", {"auto", "v_ak"}},
      {"run: {tier: analytic}\n", "", "analytic", {"run.tier", NULL}},
      {"run: {tier: analytic}\n", "--tier circuit", "circuit", {"--tier", NULL}},
      {"run: {tier: analytic}\n", "--tier auto", "switched", {"auto", "nothing"}},
      {"circuit: {deck: halfwave_bare}\n", "--tier switched", "switched", {"--tier", NULL}},
  };
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    char tier[256], why[256];
    write_file("s.yaml", ROWS[k].scene);
    ran r = run("run s.yaml --json --set run.until=8ms %s", ROWS[k].options);
    expect_good(&r, ROWS[k].scene, __LINE__);
    struct fy_document *doc = parse_json(r.out);
    text_at(doc, "/tier", tier);
    text_at(doc, "/why", why);
    EXPECT(!strcmp(tier, ROWS[k].tier), "%s %s: tier %s", ROWS[k].scene, ROWS[k].options, tier);
    for (int w = 0; w < 2 && ROWS[k].why[w]; w++)
      EXPECT(strstr(why, ROWS[k].why[w]), "%s %s: why: %s", ROWS[k].scene, ROWS[k].options, why);
    fy_document_destroy(doc);
    free_ran(&r);
  }
}

/* ---- runs that warn, fail or are stopped ---- */

static void below_theta_there_is_a_warning(void) {
  static const struct {
    const char *angle;
    bool warned;
  } ROWS[] = {{"70deg", true}, {"79.62deg", true}, {"79.64deg", false}, {"100deg", false}};
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    ran r = run("run paper --set run.until=0.02s --set firing.angle=%s", ROWS[k].angle);
    CU_ASSERT_EQUAL(r.status, 0);
    CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "i_peak"));
    EXPECT(count_lines(r.err) == ROWS[k].warned, "%s: %s", ROWS[k].angle, r.err);
    if (ROWS[k].warned)
      EXPECT(strstr(r.err, "warning") && strstr(r.err, "theta = 79.628"), "%s", r.err);
    free_ran(&r);
    ran quiet = run("run paper --quiet --set run.until=0.02s --set firing.angle=%s", ROWS[k].angle);
    expect_good(&quiet, ROWS[k].angle, __LINE__);
    free_ran(&quiet);
  }
}

static void a_run_that_leaves_validity_is_kept_in_part(void) {
  static const char *const TIERS[] = {"analytic", "switched", "circuit"};
  write_file("s.yaml", "actuator: {gap: 1 mm}\nrun: {until: 0.1 s}\n");
  for (size_t k = 0; k < sizeof TIERS / sizeof *TIERS; k++) {
    char words[128];
    snprintf(words, sizeof words, "run paper -o out --tier %s --set run.until=0.02s", TIERS[k]);
    RUN_GOOD(words); /* leaves a result that the next run's would contradict */
    ran r = run("run s.yaml -o out --tier %s", TIERS[k]);
    EXPECT(r.status == 1, "tier %s: exit status %d", TIERS[k], r.status);
    EXPECT(!*r.out, "tier %s: %s", TIERS[k], r.out);
    EXPECT(count_lines(r.err) == 1 && strstr(r.err, "p = -D"), "tier %s: %s", TIERS[k], r.err);
    double t = NAN;
    sscanf(r.err, "vibrospice: t = %lf s: ", &t);
    EXPECT(t > 0.0085 && t < 0.0095, "tier %s: %s", TIERS[k], r.err);
    EXPECT_FILES("out", BROKEN_RUN);
    table partial = read_table("out/run.partial.csv");
    EXPECT(partial.rows > 50 && partial.last_s < t && partial.p_min > -1e-3,
           "tier %s: %d rows to %g s, p down to %g m", TIERS[k], partial.rows, partial.last_s,
           partial.p_min);
    free(partial.text);
    free_ran(&r);
    RUN_GOOD(words);
    EXPECT_FILES("out", strcmp(TIERS[k], "circuit") ? GOOD_RUN : WITH_PEAKS);
  }
  remove_tree("out");
}

/* The program handles signals before it makes its folder. */
static bool wait_for(const char *path) {
  const struct timespec nap = {0, 5000000};
  for (int n = 0; n < 4000; n++) {
    if (!access(path, F_OK)) return true;
    nanosleep(&nap, NULL);
  }
  return false;
}

/* True once a file in the folder has so many bytes, which are rows of a run. */
static bool has_bytes(const char *folder, long bytes) {
  char *names = listing(folder), *rest = names, path[VS_PATH_SIZE];
  bool has = false;
  for (char *name; (name = strsep(&rest, " ")) && *name;) {
    struct stat s;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    has = has || (!stat(path, &s) && S_ISREG(s.st_mode) && s.st_size >= bytes);
  }
  free(names);
  return has;
}

static void a_signal_keeps_what_there_is(void) {
  static const struct {
    int number;
    const char *words;
  } ROWS[] = {
      {SIGTERM, "run paper -o out --tier circuit --set run.until=200s"},
      {SIGINT, "run paper -o out --tier circuit --set run.until=200s --json"},
      {SIGHUP, "run paper -o out --tier circuit --set run.until=200s"},
      {SIGTERM, "run paper -o out --tier switched --set run.until=9e5s --set run.sample=10ms "
                "--set limits.csv=1e12"},
  };
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    char words[128];
    const char *argv[MOST_WORDS];
    snprintf(words, sizeof words, "%s", ROWS[k].words);
    split(words, argv);
    pid_t child = spawn(argv);
    EXPECT(wait_for("out"), "%s: did not begin", ROWS[k].words);
    WAIT_UNTIL(has_bytes("out", 16384)); /* at least twenty rows of each file */
    kill(child, ROWS[k].number);
    ran r = collect(child);
    EXPECT(r.status == 75, "%s: exit status %d", ROWS[k].words, r.status);
    EXPECT(!*r.out, "%s: %s", ROWS[k].words, r.out);
    EXPECT(count_lines(r.err) == 1 && strstr(r.err, "signal"), "%s: %s", ROWS[k].words, r.err);
    EXPECT_FILES("out", BROKEN_RUN);
    table partial = read_table("out/run.partial.csv");
    EXPECT(partial.rows > 10 && partial.last_s > 0, "%s: %d rows", ROWS[k].words, partial.rows);
    free(partial.text);
    free_ran(&r);
    remove_tree("out");
  }
}

/* nohup has a program begin with SIGHUP ignored; that is then no end of a run. */
static void nohup_is_obeyed(void) {
  char words[] = "run paper -o out --tier circuit --quiet";
  const char *argv[MOST_WORDS];
  split(words, argv);
  signal(SIGHUP, SIG_IGN);
  pid_t child = spawn(argv);
  signal(SIGHUP, SIG_DFL);
  EXPECT(wait_for("out"), "did not begin");
  kill(child, SIGHUP);
  ran r = collect(child);
  expect_good(&r, "with SIGHUP ignored", __LINE__);
  EXPECT_FILES("out", WITH_PEAKS);
  free_ran(&r);
  remove_tree("out");
}

/* ---- the other commands ---- */

static void check_matrix(const char *path, int expected_rows, int expected_columns) {
  char *text = read_file(path), *rest = text;
  int n = 0;
  bool numbers = true;
  for (char *row; (row = strsep(&rest, "\n")) && *row; n++) {
    int columns = 0;
    for (char *word; (word = strsep(&row, ",")); columns++) {
      char *end;
      numbers = isfinite(strtod(word, &end)) && end != word && !*end && numbers;
    }
    EXPECT(columns == expected_columns, "%s: %d columns in row %d", path, columns, n + 1);
  }
  EXPECT(n == expected_rows && numbers, "%s: %d rows", path, n);
  free(text);
}

static void modes(void) {
  ran r = run("modes paper");
  expect_good(&r, "modes paper", __LINE__);
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "56.57710805"));
  free_ran(&r);
  RUN_GOOD("modes paper -o state_space");
  EXPECT_FILES("state_space", "A.csv B.csv C.csv D.csv modes.csv ");
  check_matrix("state_space/A.csv", 8, 8);
  check_matrix("state_space/B.csv", 8, 4);
  check_matrix("state_space/C.csv", 4, 8);
  check_matrix("state_space/D.csv", 4, 4);
  char *csv = read_file("state_space/modes.csv");
  CU_ASSERT_EQUAL(count_lines(csv), 9);
  CU_ASSERT_PTR_NOT_NULL(strstr(csv, ",56.577108"));
  free(csv);
  r = run("modes paper --quiet -o state_space");
  EXPECT(r.status == 0 && !*r.out && !*r.err, "%d %s%s", r.status, r.out, r.err);
  free_ran(&r);
  r = run("modes paper --json --quiet --set machine.trough_mass=1kg");
  expect_good(&r, "modes --json", __LINE__);
  struct fy_document *doc = parse_json(r.out);
  CU_ASSERT(number_at(doc, "/modes/0/frequency_hz") > 0);
  CU_ASSERT_PTR_NULL(strstr(r.out, "56.57710805"));
  fy_document_destroy(doc);
  free_ran(&r);
  remove_tree("state_space");
}

/* The table of docs/scenes.md has a row for each, and no other. */
static void exit_statuses_are_documented(void) {
  char *text = read_file(VS_TEST_FOLDER "/../docs/scenes.md");
  const char *row = strstr(text, "| exit status | meaning |\n|---|---|\n");
  CU_ASSERT_PTR_NOT_NULL_FATAL(row);
  row = strchr(strchr(row, '\n') + 1, '\n') + 1;
  ran r = run("help exit");
#define IS_THERE(name, status, says)                                                               \
  EXPECT(atoi(row + 2) == status, "%s: docs/scenes.md: %.40s", #name, row);                        \
  EXPECT(strstr(r.out, says), "%s: %s", #name, r.out);                                             \
  row = strchr(row, '\n') + 1;
  VS_STATUS_LIST(IS_THERE)
#undef IS_THERE
  EXPECT(*row != '|', "%.40s", row);
  free_ran(&r);
  free(text);
}

static void what_the_program_says_about_itself(void) {
  static const struct {
    const char *words, *says[3];
  } ROWS[] = {
      {"--help", {"Usage: vibrospice", "modes", "Exit status: 0 done."}},
      {"help", {"Usage: vibrospice", "plot", NULL}},
      {"run --help", {"--reproducible", "--digits", "Examples:"}},
      {"check --help", {"FILE", "--set", "JSON array"}},
      {"list --help", {"--deck", "KIND", NULL}},
      {"modes --help", {"--output", "--set", NULL}},
      {"export --help", {"--output", "ngspice -b", NULL}},
      {"plot --help", {"--output", "DIR", NULL}},
      {"validate --help", {"--list", "WORD", NULL}},
      {"--version", {"vibrospice " VS_VERSION, "ngspice ", "GSL "}},
      {"list", {"paper", "halfwave_snubbed", "machine.trough_mass"}},
      {"list scenes", {"paper", NULL, NULL}},
      {"list decks", {"halfwave_snubbed", NULL, NULL}},
      {"list tiers", {"analytic", "switched", "circuit"}},
      {"list probes", {"v_mains", "v_ak", "force"}},
      {"list measures", {"i_peak", "tau_p", "v_ak_min"}},
      {"list measures throw_number", {"throw_number", "(command steady)", NULL}},
      {"list parameters", {"machine.trough_mass", "circuit.r1_part", "1e-06..10000 kg"}},
  };
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++) {
    ran r = run("%s", ROWS[k].words);
    expect_good(&r, ROWS[k].words, __LINE__);
    for (int w = 0; w < 3 && ROWS[k].says[w]; w++)
      EXPECT(strstr(r.out, ROWS[k].says[w]), "%s: no '%s' in: %.900s", ROWS[k].words,
             ROWS[k].says[w], r.out);
    free_ran(&r);
  }
}

/* The first bytes of a PNG; an <svg> in the first hundreds of an SVG. */
static void check_picture(const char *path) {
  char head[512] = "";
  FILE *f = fopen(path, "rb");
  size_t n = f ? fread(head, 1, sizeof head - 1, f) : 0;
  if (f) fclose(f);
  bool good = strstr(path, ".png") ? n > 8 && !memcmp(head, "\x89PNG\r\n\x1a\n", 8)
                                   : strstr(head, "<svg") != NULL;
  EXPECT(good, "%s is no picture", path);
}

static void plot_draws(void) {
  static const char *const PICTURES[] = {"motion_100ms.png", "motion_100ms.svg", "motion_run.png",
                                         "motion_run.svg",   "pulse_50ms.png",   "pulse_50ms.svg"};
  vs_text files = {0};
  vs_text_add(&files, "events.csv ");
  ran r = run("plot out");
  expect_good(&r, "plot out", __LINE__);
  CU_ASSERT_EQUAL(count_lines(r.out), 7);
  free_ran(&r);
  for (size_t k = 0; k < sizeof PICTURES / sizeof *PICTURES; k++) {
    char path[64];
    snprintf(path, sizeof path, "out/%s", PICTURES[k]);
    check_picture(path);
    vs_text_add(&files, "%s ", PICTURES[k]);
  }
  vs_text_add(&files, "report.html run.csv summary.json ");
  EXPECT_FILES("out", files.text);
  vs_text_free(&files);
  r = run("plot out -o 'one sheet.svg' --quiet");
  expect_good(&r, "plot out -o", __LINE__);
  CU_ASSERT_STRING_EQUAL(r.out, "");
  check_picture("one sheet.svg");
  free_ran(&r);
  CU_ASSERT_EQUAL(unlink("one sheet.svg"), 0);
  static const char *const NOWHERE[] = {"nowhere", NULL};
  refuse("plot out -o nowhere/sheet.png", "a picture in a folder that is not there", "", NOWHERE,
         __LINE__);
}

static void plot(void) {
  RUN_GOOD("run paper -o out --set run.until=0.05s");
  char *path = vs_copy(getenv("PATH"));
  setenv("PATH", "nowhere", 1);
  ran r = run("plot out");
  setenv("PATH", path, 1);
  free(path);
  EXPECT(r.status == 1 && count_lines(r.err) == 1 && strstr(r.err, "gnuplot is not installed"),
         "without gnuplot: exit status %d: %s", r.status, r.err);
  EXPECT_FILES("out", GOOD_RUN);
  free_ran(&r);
  if (on_path("gnuplot")) plot_draws();
  remove_tree("out");
  write_file("s.yaml", "actuator: {gap: 1 mm}\nrun: {until: 0.1 s}\n");
  r = run("run s.yaml -o out");
  CU_ASSERT_EQUAL(r.status, 1);
  free_ran(&r);
  static const char *const PARTIAL[] = {"run.partial.csv", NULL};
  refuse("plot out", "a run that failed", "", PARTIAL, __LINE__);
  remove_tree("out");
}

/* Neither a .spiceinit of the user's nor a locale with a decimal comma changes a byte of the
 * result. */
static void surroundings_change_nothing(void) {
  static const char SCENE[] =
      "run paper --tier circuit --set run.until=0.02s --json --quiet --reproducible";
  ran plain = run("%s", SCENE);
  expect_good(&plain, "plain", __LINE__);
  write_file(".spiceinit", "set ngbehavior=ps\noption reltol=0.1\noption method=gear\n");
  setenv("LC_ALL", "de_DE.UTF-8", 1);
  setenv("LC_NUMERIC", "de_DE.UTF-8", 1);
  ran other = run("%s", SCENE);
  unsetenv("LC_ALL");
  unsetenv("LC_NUMERIC");
  remove(".spiceinit");
  expect_good(&other, "with surroundings", __LINE__);
  CU_ASSERT_STRING_EQUAL(plain.out, other.out);
  free_ran(&plain);
  free_ran(&other);
}

/* A file that cannot grow, as on a full disk: an error with the time, no file that is not whole,
 * and no folder for nothing; one that was there before stays. */
static void a_full_disk_is_an_error(void) {
  struct rlimit before, small;
  getrlimit(RLIMIT_FSIZE, &before);
  small = before;
  small.rlim_cur = 60000;
  signal(SIGXFSZ, SIG_IGN);
  for (int there = 0; there < 2; there++) {
    if (there) CU_ASSERT_EQUAL(mkdir("old", 0777), 0);
    setrlimit(RLIMIT_FSIZE, &small);
    ran r = run("run paper -o %s --set run.until=0.5s", there ? "old" : "new/out");
    setrlimit(RLIMIT_FSIZE, &before);
    CU_ASSERT_EQUAL(r.status, 1);
    EXPECT(strstr(r.err, "run.csv") && strstr(r.err, "written"), "%s", r.err);
    CU_ASSERT_EQUAL(count_lines(r.err), 1);
    if (there) EXPECT_FILES("old", "");
    EXPECT(access("new", F_OK), "the new folder was left");
    free_ran(&r);
  }
  remove_tree("old");
}

/* What is printed, and did not go out, is an error of every command. */
static void a_full_standard_output_is_an_error(void) {
  static const char *const WORDS[] = {"--help", "-?", "--version", "help", "run --help", "list"};
  for (size_t k = 0; k < COUNT(WORDS); k++) {
    vs_text command = {0};
    vs_text_add(&command, "'%s' %s >/dev/full 2>said.txt", VS_PROGRAM, WORDS[k]);
    int how = system(command.text);
    char *said = read_file("said.txt");
    EXPECT(WIFEXITED(how) && WEXITSTATUS(how) == VS_RUN &&
               !strcmp(said, "vibrospice: standard output cannot be written\n"),
           "%s: %d %s", WORDS[k], how, said);
    free(said);
    vs_text_free(&command);
  }
  remove("said.txt");
}

/* A deck, a machine and a study's scene are looked for beside the file that names them, and then
 * where the program runs, with a warning. */
static void files_beside(void) {
  mkdir("sub", 0777);
  write_gated_deck();
  CU_ASSERT(!system("cp gated.cir gated.inc sub; echo '* a deck that is none' >gated.cir"));
  write_file("sub/s.yaml", "circuit: {deck: gated.cir}\nrun: {until: 5 ms, tier: circuit}\n");
  ran r = run("run sub/s.yaml --quiet"); /* the deck in sub, not the one here */
  EXPECT(r.status != 2 && !strstr(r.err, "gated.cir"), "%d: %s", r.status, r.err);
  free_ran(&r);
  write_file("sub/g.yaml", "scene: s.yaml\nvary: {firing.angle: [90 deg]}\nreport: [i_peak]\n");
  write_file("s.yaml", "no scene\n");
  r = run("study sub/g.yaml --quiet");
  EXPECT(r.status != 2 && count_lines(r.out) == 2, "%d: %s", r.status, r.err);
  free_ran(&r);
  CU_ASSERT(!system("mv sub/gated.cir ."));
  r = run("run sub/s.yaml");
  EXPECT(r.status != 2 &&
             strstr(r.err, "gated.cir is taken from the folder where the program runs"),
         "%d: %s", r.status, r.err);
  free_ran(&r);
}

/* What the paper measured and what the scene records is told first, and once. The digits shown are
 * those of exact propagation. */
static void what_is_asked_for_is_told_first(void) {
  static const char BEGINS[] =
      "\nasked for\n"
      "  i_peak                           841.9 mA   at 9.34 ms   measured 950 mA: computed is "
      "-11.4 "
      "%\n"
      "  conduction_time                  8.215 ms   measured 8 ms: computed is +2.7 %\n";
  static const char COURSE[] =
      "\n  p                  -1.416 mm .. 0.7162 mm   at 14.04 ms, 20 ms\n";
  static const char *const RECORD[] = {"", "--set 'record=[p]'", "--set record=all"};
  for (size_t k = 0; k < COUNT(RECORD); k++) {
    ran r = run("run paper --all --set run.tier=switched --set run.until=20ms %s", RECORD[k]);
    const char *p = strstr(r.out, COURSE), *motion = strstr(r.out, "\n\nmotion\n");
    EXPECT(strstr(r.out, BEGINS) && p && motion && (p < motion) == (k == 1), "%s: %s", RECORD[k],
           r.out);
    EXPECT(p && !strstr(p + 1, COURSE), "%s: twice: %s", RECORD[k], r.out);
    free_ran(&r);
  }
}

static const vs_test TESTS[] = {
    {"rounding is told as zero", rounding_is_told_as_zero},
    {"files beside", files_beside},
    {"what is asked for is told first", what_is_asked_for_is_told_first},
    {"bad scenes are refused", bad_scenes_are_refused},
    {"bad commands are refused", bad_commands_are_refused},
    {"pipes in files are refused", pipes_in_files_are_refused},
    {"lists are kept", lists_are_kept},
    {"bad decks are refused", bad_decks_are_refused},
    {"run.csv: columns", columns},
    {"run.csv: rows", rows},
    {"run.csv: digits", digits},
    {"an empty scene is the paper's", an_empty_scene_is_the_paper},
    {"summary.json and events.csv", summary_and_events},
    {"a reproducible run gives the same bytes", a_reproducible_run_gives_the_same_bytes},
    {"what goes to the screen and what to files", streams_and_files},
    {"auto says which tier and why", auto_says_which_tier_and_why},
    {"below theta there is a warning", below_theta_there_is_a_warning},
    {"a run that leaves validity is kept in part", a_run_that_leaves_validity_is_kept_in_part},
    {"a signal keeps what there is", a_signal_keeps_what_there_is},
    {"nohup is obeyed", nohup_is_obeyed},
    {"surroundings change nothing", surroundings_change_nothing},
    {"a full disk is an error", a_full_disk_is_an_error},
    {"a full standard output is an error", a_full_standard_output_is_an_error},
    {"verdict and audit", verdict_and_audit},
    {"modes", modes},
    {"exit statuses are documented", exit_statuses_are_documented},
    {"help, version, list", what_the_program_says_about_itself},
    {"plot", plot},
};

int main(void) {
  return program_suite("command line", TESTS, COUNT(TESTS));
}
