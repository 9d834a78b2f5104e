/* SPDX-License-Identifier: GPL-3.0-or-later
 * What would become too large is told before it does any harm, through every command, with its
 * place and the key that allows more. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "netlist/limits.h"
#include "program.h"

#ifdef __SANITIZE_ADDRESS__
static const bool SANITIZED = true; /* its own memory counts */
#else
static const bool SANITIZED = false;
#endif

/* ---- run.csv ---- */

/* 1 ms and 19 columns of 14 bytes: 3759 s make a gigabyte, by the rule of run/table.c. */
static void tables(void) {
  static const char *const SAYS[] = {"run.csv would have about ", "limits.csv = 1e+09 bytes"};
  write_file("s.yaml", "run: {until: 5000 s,\n  sample: 1 ms}\n");
  refuse("run s.yaml -o out", "run", "s.yaml:2:11: ", SAYS, __LINE__);
  write_file("st.yaml", "scene: s.yaml\nvary: {firing.angle: [90 deg, 91 deg]}\n");
  refuse("study st.yaml -o out --keep runs", "study", "s.yaml:2:11: ", SAYS, __LINE__);
  ran r = run("check s.yaml");
  EXPECT(r.status == 0 && strstr(r.err, "s.yaml:2:11: warning: run.csv would have"), "%d %s",
         r.status, r.err);
  free_ran(&r);
  r = run("check s.yaml --set limits.csv=2e9");
  EXPECT(r.status == 0 && !*r.err, "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("check s.yaml --set record=[p]"); /* fewer columns */
  EXPECT(r.status == 0 && !*r.err, "%d %s", r.status, r.err);
  free_ran(&r);
  write_file("s.yaml", "run: {until: 50 ms}\nlimits: {csv: 2e3}\n");
  refuse("run s.yaml -o out", "limit",
         "s.yaml:1:14: ", (const char *[]){"run.csv would have", "limits.csv = 2000 bytes"},
         __LINE__);
  RUN_GOOD("run s.yaml --quiet"); /* without -o there is no table */
  RUN_GOOD("run s.yaml -o out --quiet --set limits.csv=1e6");
}

/* Kilobytes are not "0.0 GB". */
static void units(void) {
  static const struct {
    double bytes;
    const char *text;
  } ROWS[] = {{800, "800 bytes"}, {2345, "2.3 kB"}, {123456, "123 kB"}, {999.6e3, "1 MB"},
              {5.32e9, "5.3 GB"}, {2e13, "20 TB"},  {7e20, "700 EB"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[VS_LIMITS_SIZE];
    vs_limits_write(ROWS[k].bytes, text);
    EXPECT(!strcmp(text, ROWS[k].text), "%g: %s", ROWS[k].bytes, text);
  }
  write_file("s.yaml", "run: {until: 50 ms}\nlimits: {csv: 2e3}\n");
  refuse("run s.yaml -o out", "kB",
         "s.yaml:1:14: ", (const char *[]){"run.csv would have about 133 kB, in 501 rows", NULL},
         __LINE__);
}

/* ---- what a study keeps ---- */

/* 501 rows of 19 columns of 14 bytes, a hundred times. */
static void kept_runs(void) {
  write_file("s.yaml", "run: {until: 50 ms}\n");
  write_file("st.yaml", "scene: s.yaml\nset: {limits.kept: 1e7}\n"
                        "vary: {firing.angle: {from: 90 deg, to: 109.8 deg, step: 0.2 deg}}\n");
  refuse("study st.yaml -o out --keep runs", "kept", "s.yaml:1:14: ",
         (const char *[]){"--keep runs: 100 run.csv of about 133 kB each would have 13 MB",
                          "limits.kept = 10000000 bytes"},
         __LINE__);
  RUN_GOOD("study st.yaml -o out --keep runs --quiet --set limits.kept=14e6");
  remove_tree("out");
}

/* ---- run.raw ---- */

/* A run whose longest steps would write too much is refused before it begins; one that takes
 * shorter steps ends where the file is full, and keeps it. */
static void rawfiles(void) {
  write_file("s.yaml", "circuit: {deck: halfwave_bare}\nrun: {until: 50 ms}\n");
  refuse("run s.yaml -o out --raw --set limits.raw=2e3", "raw", "s.yaml:2:14: ",
         (const char *[]){"run.raw would have at least ", "limits.raw = 2000 bytes"}, __LINE__);
  RUN_GOOD("run s.yaml -o out --raw --quiet");
  struct stat s;
  CU_ASSERT_EQUAL_FATAL(stat("out/run.raw", &s), 0);
  remove_tree("out");
  ran r = run("run s.yaml -o out --raw --quiet --set limits.raw=%lld", (long long)s.st_size - 2000);
  EXPECT(r.status == 1 && strstr(r.err, "run.raw has the limits.raw"), "%d %s", r.status, r.err);
  CU_ASSERT_EQUAL(count_lines(r.err), 1);
  free_ran(&r);
  r = run("run s.yaml -o out --raw --quiet --set limits.raw=%lld", (long long)s.st_size);
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  remove_tree("out");
}

/* What the rule says of a table is not below what the table has. */
static void estimates(void) {
  static const char *const WAYS[] = {"", "--digits 17", "--digits 3",
                                     "--tier circuit --set circuit.deck=halfwave_paper"};
  for (size_t k = 0; k < COUNT(WAYS); k++) {
    ran r = run("run paper --set run.until=0.2s --quiet -o e %s", WAYS[k]);
    EXPECT(r.status == 0, "%s", r.err);
    free_ran(&r);
    struct stat s;
    CU_ASSERT_EQUAL_FATAL(stat("e/run.csv", &s), 0);
    r = run("run paper --set run.until=0.2s --quiet -o e --set limits.csv=%lld %s",
            (long long)s.st_size - 1, WAYS[k]);
    EXPECT(r.status == 2, "%s: %lld bytes were allowed for as many", WAYS[k], (long long)s.st_size);
    free_ran(&r);
    r = run("run paper --set run.until=0.2s --quiet -o e --set limits.csv=%lld %s",
            3 * (long long)s.st_size, WAYS[k]);
    EXPECT(r.status == 0, "%s: %s", WAYS[k], r.err);
    free_ran(&r);
    remove_tree("e");
  }
}

/* ---- devices ---- */

/* The shipped deck with a subcircuit in a subcircuit ...: so many levels of ten instances each. */
static void write_bomb(const char *path, int levels) {
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  vs_text deck = {0};
  vs_text_add(&deck, "%s\n.subckt bomb0 a b\nR1 a b 1k\n.ends\n", text);
  for (int k = 1; k <= levels; k++) {
    vs_text_add(&deck, ".subckt bomb%d a b\n", k);
    for (int i = 0; i < 10; i++) vs_text_add(&deck, "X%d a b bomb%d\n", i, k - 1);
    vs_text_add(&deck, ".ends\n");
  }
  vs_text_add(&deck, "Xlast k 0 bomb%d\n", levels);
  write_file(path, deck.text);
  vs_text_free(&deck);
  free(text);
}

/* The most memory that a child of this process has had so far, MB. */
static double most_mb(void) {
  struct rusage use;
  getrusage(RUSAGE_CHILDREN, &use);
  return (double)use.ru_maxrss / 1024;
}

static void bombs(void) {
  static const char *const COMMANDS[] = {"run s.yaml",
                                         "run s.yaml -o out",
                                         "steady s.yaml",
                                         "modes s.yaml",
                                         "sensitivity s.yaml --of p_min --to firing.angle",
                                         "export s.yaml -o x.cir",
                                         "study st.yaml -o out"};
  static const char *const SAYS[] = {"the circuit comes to 1e+09 devices",
                                     "limits.devices = 100000"};
  write_bomb("bomb.cir", 9);
  write_file("s.yaml", "circuit: {deck: bomb.cir}\nrun: {until: 1 ms}\n");
  write_file("st.yaml", "scene: s.yaml\nvary: {firing.angle: [90 deg, 91 deg]}\n");
  for (size_t k = 0; k < COUNT(COMMANDS); k++)
    refuse(COMMANDS[k], COMMANDS[k], "bomb.cir:", SAYS, __LINE__);
  static const char *const CHECKS[] = {"check bomb.cir", "check s.yaml", "check st.yaml"};
  for (size_t k = 0; k < COUNT(CHECKS); k++) {
    ran r = run("%s", CHECKS[k]);
    EXPECT(r.status == 2 && strstr(r.err, SAYS[0]) && strstr(r.err, "Xlast k 0 bomb9"), "%d %s",
           r.status, r.err);
    free_ran(&r);
  }
  EXPECT(SANITIZED || most_mb() < 100, "%g MB", most_mb());
}

static void devices_are_counted(void) {
  write_bomb("small.cir", 2);
  write_file("s.yaml", "circuit: {deck: small.cir}\n");
  RUN_GOOD("check s.yaml --quiet");
  ran r = run("check s.yaml --set limits.devices=100");
  EXPECT(r.status == 2 && strstr(r.err, "100 of them by this line"), "%d %s", r.status, r.err);
  free_ran(&r);
  /* a line of segments, each of which is two devices */
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  vs_text deck = {0};
  vs_text_add(&deck, "%s\n.model um urc(rperl=1k cperl=1p)\nU9 k 0 0 um l=1 n=200\n", text);
  write_file("small.cir", deck.text);
  r = run("check s.yaml --set limits.devices=300");
  EXPECT(r.status == 2 && strstr(r.err, "401 of them by this line"), "%d %s", r.status, r.err);
  free_ran(&r);
  vs_text_free(&deck);
  free(text);
}

/* ---- studies ---- */

static void cases(void) {
  static const char *const SAYS[] = {"more than 10000000 cases", "a larger most_cases"};
  write_file("st.yaml", "vary: {firing.angle: {lin: [1 deg, 90 deg], n: 100000},\n"
                        "  supply.voltage: {lin: [100 V, 200 V], n: 1000}}\n");
  refuse("study st.yaml -o out", "study", "st.yaml:1:8: ", SAYS, __LINE__);
  ran r = run("check st.yaml");
  EXPECT(r.status == 2 && strstr(r.err, SAYS[0]), "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("check st.yaml --set most_cases=1e8");
  EXPECT(r.status == 0 && strstr(r.out, "100000000 cases"), "%d %s%s", r.status, r.out, r.err);
  free_ran(&r);
  refuse("study st.yaml --set most_cases=1e9 -o out", "most", "--set most_cases=1e9: ",
         (const char *[]){"most_cases: a whole number from 1 to 100000000", NULL}, __LINE__);
  write_file("st.yaml", "most_cases: 3\nvary: {firing.angle: {lin: [1 deg, 90 deg], n: 4}}\n");
  refuse("study st.yaml -o out", "study",
         "st.yaml:1:13: ", (const char *[]){"more than 3 cases", NULL}, __LINE__);
}

/* ---- files ---- */

/* Writes a deck that includes a file of so many lines. */
static void write_long(int lines) {
  FILE *f = fopen("long.inc", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  fputs(".subckt long a b\n", f);
  for (int k = 0; k < lines; k++) fprintf(f, "R%d a b 1k ; a resistor of a thousand ohm\n", k);
  fputs(".ends\n", f);
  fclose(f);
}

static void files(void) {
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  vs_text deck = {0};
  vs_text_add(&deck, "%s\n.include long.inc\n", text);
  write_file("d.cir", deck.text);
  write_long(300000);
  ran r = run("check d.cir");
  EXPECT(r.status == 2 && strstr(r.err, "long.inc: with it the deck has more than 250000 lines"),
         "%d %s", r.status, r.err);
  free_ran(&r);
  write_long(500000);
  r = run("check d.cir");
  EXPECT(r.status == 2 && strstr(r.err, "long.inc: more than 16777216 bytes"), "%d %s", r.status,
         r.err);
  free_ran(&r);
  write_file("long.inc", ".subckt a b c\n.include again.inc\n.ends\n");
  write_file("again.inc", ".include long.inc\n");
  r = run("check d.cir");
  /* which of the two is the one too many hangs on how many files the deck has besides */
  bool placed = strstr(r.err, "long.inc:2:1: more than 32 files") ||
                strstr(r.err, "again.inc:1:1: more than 32 files");
  EXPECT(r.status == 2 && placed, "%d %s", r.status, r.err);
  free_ran(&r);
  vs_text_free(&deck);
  free(text);
}

/* Last, as it takes the most memory: some hundred MB. */
static void scenes(void) {
  FILE *f = fopen("long.yaml", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  for (int k = 0; k < 200000; k++) fprintf(f, "# a line of a scene that says nothing at all\n");
  fclose(f);
  refuse("run long.yaml", "long",
         "long.yaml: ", (const char *[]){"longer than 8388608 bytes", NULL}, __LINE__);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"bombs", bombs},         {"devices are counted", devices_are_counted},
      {"tables", tables},       {"units", units},
      {"kept runs", kept_runs}, {"rawfiles", rawfiles},
      {"estimates", estimates}, {"cases", cases},
      {"files", files},         {"scenes", scenes},
  };
  return program_suite("sizes", TESTS, COUNT(TESTS));
}
