/* SPDX-License-Identifier: GPL-3.0-or-later
 * Studies: their files and what is wrong with them, the order and the bytes of their rows, and what
 * they survive. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "age.h"
#include "base/csv.h"
#include "base/hash.h"
#include "study/methods.h"
#include "study/study_file.h"
#include "study/workers/case.h"
#include "study/workers/identity.h"
#include "study/workers/journal.h"

/* Fast: switched, 12 x 10 cases of 0.1 s; the last angle of each voltage is below theta, and some
 * of them meet the pole cover. */
static const char GRID[] = "set: {run.until: 0.1 s, firing.every: 1}\n"
                           "vary:\n"
                           "  supply.voltage: {lin: [300 V, 520 V], n: 12}\n"
                           "  firing.angle: {from: 80 deg, to: 125 deg, step: 5 deg}\n"
                           "report: [p_min, i_peak]\n";
static const char CIRCUIT[] = "set: {circuit.deck: halfwave_paper, run.until: 12 ms}\n"
                              "vary:\n"
                              "  circuit.r1: [100 ohm, 4.7 kohm]\n"
                              "  circuit.thyristor: [latch, TYN1212]\n"
                              "report: [thyristor.v_reverse, v_ak_min]\n";

/* Takes the second cell, the id, out of each row. */
static char *without_ids(char *csv) {
  char *to = csv;
  int cell = 0;
  for (const char *s = csv; *s; s++) {
    cell = *s == '\n' ? 0 : cell + (*s == ',');
    if (cell != 1) *to++ = *s;
  }
  *to = '\0';
  return csv;
}

/* ---- the parts ---- */

/* Known values: CRC-32 of "123456789" (its check value), SHA-256 of "abc" (FIPS 180-4, example) and
 * of nothing. */
static void checksums(void) {
  vs_hash h;
  char text[VS_HASH_TEXT];
  CU_ASSERT_EQUAL(vs_hash_crc32("123456789", 9), 0xcbf43926);
  vs_hash_begin(&h);
  vs_hash_add(&h, "abc", 3);
  vs_hash_end(&h, text);
  CU_ASSERT_STRING_EQUAL(text, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  vs_hash_begin(&h);
  vs_hash_end(&h, text);
  CU_ASSERT_STRING_EQUAL(text, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

static void cells(void) {
  vs_text row = {0};
  char *cell[8];
  vs_csv_cell(&row, "a,b");
  vs_text_add(&row, ",");
  vs_csv_cell(&row, "say \"x\"");
  vs_text_add(&row, ",,");
  vs_csv_cell(&row, "plain");
  CU_ASSERT_STRING_EQUAL(row.text, "\"a,b\",\"say \"\"x\"\"\",,plain");
  CU_ASSERT_EQUAL_FATAL(vs_csv_split(row.text, cell, 8, NULL), 4);
  CU_ASSERT_STRING_EQUAL(cell[0], "a,b");
  CU_ASSERT_STRING_EQUAL(cell[1], "say \"x\"");
  CU_ASSERT_STRING_EQUAL(cell[2], "");
  CU_ASSERT_STRING_EQUAL(cell[3], "plain");
  vs_text_free(&row);
}

/* ---- what a study is made of ---- */

/* Nested, the last axis fastest; numbers in the unit of the key's default, to 12 digits; a range
 * ends at its last step, a logarithmic one on its end. */
static void a_grid(void) {
  write_file("g.yaml", "set: {run.until: 10 ms}\n"
                       "vary: {supply.voltage: [0.44 kV, 400 V], firing.every: [once, 2], "
                       "load.density: {log: [0.01 g/cm3, 1 g/cm3], n: 3}, firing.angle: {from: 100 "
                       "deg, to: 109 deg, step: 5 deg}, machine.m14: [paper, derived]}\n");
  ran r = run("study g.yaml");
  CU_ASSERT_EQUAL(r.status, 0);
  CU_ASSERT_EQUAL(count_lines(r.out), 1 + 2 * 2 * 3 * 2 * 2);
  CU_ASSERT_EQUAL(strncmp(r.out, "case,id,supply.voltage_v,", 25), 0);
  without_ids(r.out);
  static const char *const HAS[] = {"case,supply.voltage_v,firing.every,load.density_g_cm3,firing."
                                    "angle_deg,machine.m14,i_peak_a,",
                                    ",energy_residual,margin_least,margin_error,weakest,rung,"
                                    "leaving_bound,happened,not_judged,warnings,status\n",
                                    "\n0,440,once,0.01,100,paper,",
                                    "\n1,440,once,0.01,100,derived,",
                                    "\n2,440,once,0.01,105,paper,",
                                    "\n4,440,once,0.1,100,paper,",
                                    "\n8,440,once,1,100,paper,",
                                    "\n12,440,2,0.01,100,paper,",
                                    "\n24,400,once,0.01,100,paper,",
                                    "\n47,400,2,1,105,derived,"};
  for (size_t k = 0; k < COUNT(HAS); k++)
    EXPECT(strstr(r.out, HAS[k]), "no %s in %s", HAS[k], r.out);
  free_ran(&r);
}

/* A case is what `run` does with its keys. */
static void a_case_is_a_run(void) {
  write_file("g.yaml", "set: {circuit.deck: halfwave_paper, run.until: 12 ms}\n"
                       "vary: {circuit.r1: [100 ohm], firing.angle: [100 deg, 110 deg]}\n"
                       "report: [thyristor.v_reverse, p_min]\n");
  ran r = run("study g.yaml");
  char *cell[256], *row = strstr(r.out, "\n1,");
  CU_ASSERT_PTR_NOT_NULL_FATAL(row);
  const size_t n = vs_csv_split(row + 1, cell, 256, NULL);
  CU_ASSERT_FATAL(n > 6 + 9); /* the verdict's lines between measures and margin_least */
  ran one = run("run paper --set circuit.deck=halfwave_paper --set run.until=12ms --set "
                "circuit.r1=100ohm --set firing.angle=110deg --json --quiet --reproducible");
  char want[128];
  snprintf(want, sizeof want, "\"thyristor.v_reverse\": {\"value\": %s, ", cell[4]);
  EXPECT(strstr(one.out, want), "%s not in %s", want, one.out);
  snprintf(want, sizeof want, "\"p_min\": {\"value\": %s, ", cell[5]);
  EXPECT(strstr(one.out, want), "%s not in %s", want, one.out);
  snprintf(want, sizeof want, "\"weakest\": \"%s\"", cell[n - 7]);
  EXPECT(strstr(one.out, want), "%s not in %s", want, one.out);
  free_ran(&r), free_ran(&one);
}

/* The manifest says of each limit whether it is the most or the least allowed. */
static void sides_of_ratings(void) {
  static const char *const SIDES[] = {"max", "min", "min", "max", "null"};
  write_file("g.yaml",
             "set: {circuit.deck: halfwave_paper, circuit.thyristor: TYN1212, run.until: "
             "2 ms}\nvary: {circuit.r1: [100 ohm]}\n"
             "report: [thyristor.v_reverse, thyristor.t_off, v_ak_min, v_ak_max, p_min]\n");
  RUN_GOOD("study g.yaml -o sides --quiet");
  vs_tree tree;
  vs_error err = {0};
  CU_ASSERT_EQUAL_FATAL(vs_tree_read("sides/manifest.json", &tree, &err), VS_OK);
  const vs_node *list = vs_tree_child(tree.root, "report"), *n = list ? list->child : NULL;
  for (size_t k = 0; k < COUNT(SIDES); k++, n = n ? n->next : NULL) {
    const vs_node *side = vs_tree_child(n, "side"), *rating = vs_tree_child(n, "rating");
    EXPECT(side && !strcmp(side->text, SIDES[k]), "side %zu: %s", k, side ? side->text : "-");
    EXPECT(rating && !strcmp(rating->text, "null") == (k == 4), "rating %zu", k);
    if (k == 2 && rating) CU_ASSERT(atof(rating->text) < 0);
  }
  vs_tree_free(&tree);
}

/* A list's cells carry units, or its header does, as study.csv's. Another deck, other parts. */
static void a_list(void) {
  write_file("cases.csv", "\xef\xbb\xbf# mine\ncircuit.deck,circuit.r1_ohm, circuit.c1\n"
                          "halfwave_snubbed,100,100 nF\nhalfwave_paper, 200 ,\"0.2 uF\"\n");
  write_file("l.yaml", "set: {run.until: 11 ms}\nvary: cases.csv\nreport: [fuse_2.i2t, p_min]\n");
  ran r = run("check l.yaml"); /* the first case has no fuse */
  EXPECT(r.status == 2 && strstr(r.err, "l.yaml:3:10: no measure 'fuse_2.i2t' on tier circuit"),
         "%s", r.err);
  free_ran(&r);
  write_file("l.yaml", "set: {run.until: 11 ms}\nvary: cases.csv\nreport: [p_min]\n");
  r = run("study l.yaml");
  CU_ASSERT_EQUAL(r.status, 0);
  without_ids(r.out);
  EXPECT(strstr(r.out, "\n0,halfwave_snubbed,100,100,-") &&
             strstr(r.out, "\n1,halfwave_paper,200,200,-"),
         "%s%s", r.out, r.err);
  free_ran(&r);
}

/* Without -o a study is on standard output or nowhere, so quietly too. */
static void on_standard_output(void) {
  write_file("out.yaml", "set: {run.until: 20 ms}\nvary: {firing.angle: [100 deg, 110 deg]}\n");
  ran r = run("study out.yaml --quiet");
  expect_good(&r, "study --quiet", __LINE__);
  EXPECT(count_lines(r.out) == 3 && !strncmp(r.out, "case,id,", 8), "%s", r.out);
  free_ran(&r);
}

/* The files are there though nobody reads the progress any more. */
static void unheard(void) {
  int ends[2];
  write_file("out.yaml", "set: {run.until: 20 ms}\nvary: {firing.angle: [100 deg, 110 deg]}\n");
  CU_ASSERT_EQUAL_FATAL(pipe(ends), 0);
  close(ends[0]);
  fflush(NULL);
  pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(open("../stderr", O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    signal(SIGPIPE, SIG_DFL);
    execl(VS_PROGRAM, "vibrospice", "study", "out.yaml", "-o", "unheard", "--progress", "json",
          (char *)NULL);
    _exit(127);
  }
  close(ends[1]);
  waitpid(child, NULL, 0);
  EXPECT_FILES("unheard", "failures.csv journal manifest.json study.csv ");
  remove_tree("unheard");
}

/* An event's name may hold commas and quotes: the header is cut up as its rows are, and drawn. */
static void hostile_names(void) {
  write_file("h.yaml", "set: {run.until: 50 ms, events: {'a,\"b': {kind: sag, cycle: 1}}}\n"
                       "vary: {'events.a,\"b.cycle': [1, 2]}\n"
                       "report: [p_min]\n");
  RUN_GOOD("study h.yaml -o hostile --quiet");
  char *csv = read_file("hostile/study.csv"), *failures = read_file("hostile/failures.csv");
  EXPECT(!strncmp(csv, "case,id,\"events.a,\"\"b.cycle\",p_min_m,", 37), "%s", csv);
  EXPECT(!strcmp(failures, "case,id,\"events.a,\"\"b.cycle\",status,why\n"), "%s", failures);
  RUN_GOOD("plot hostile --quiet");
  char *html = read_file("hostile/report.html");
  EXPECT(strstr(html, "No rating was judged") && strstr(html, "The first cases") &&
             !strstr(html, "The worst case"),
         "without a rating and a search the report calls a case the worst");
  free(html);
  free(csv), free(failures);
  remove_tree("hostile");
}

/* A range of whole numbers needs no step, whoever asks: it is all of them. */
static void whole_numbers(void) {
  static const char *const ASK[] = {
      "sample: {method: lhs, n: 9, spread: {firing.every: {from: 3, to: 1}}}\n",
      "sample: {method: sobol, n: 9, spread: {firing.every: {from: 3, to: 1}}}\n",
      "sample: {method: corners, spread: {firing.every: {from: 3, to: 1}}}\n",
      "vary: {firing.every: {from: 3, to: 1}}\n",
      "vary: {firing.every: {from: 3, to: 1}}\nfind: {worst: max i_peak, n: 20}\n"};
  for (size_t k = 0; k < COUNT(ASK); k++) {
    vs_text study = {0};
    vs_text_add(&study, "set: {run.until: 0.1 s}\nreport: [i_peak]\n%s", ASK[k]);
    write_file("whole.yaml", study.text);
    vs_text_free(&study);
    ran r = run("study whole.yaml");
    expect_good(&r, ASK[k], __LINE__);
    int seen[4] = {0};
    for (const char *line = strchr(r.out, '\n'); line && line[1]; line = strchr(line + 1, '\n')) {
      int every = 0;
      if (sscanf(line + 1, "%*d,%*[0-9a-f],%d,", &every) == 1 && every >= 1 && every <= 3)
        seen[every]++;
    }
    EXPECT(seen[1] && seen[2] && seen[3], "%s: 1 %d times, 2 %d times, 3 %d times", ASK[k], seen[1],
           seen[2], seen[3]);
    free_ran(&r);
  }
}

/* Every mistake at once, each with its place; nothing is written. */
static void mistakes(void) {
  write_file("bad.yaml", "scene: paper\n"
                         "set: {run.untill: 2 s}\n"
                         "vary:\n"
                         "  firing.angel: {from: 90 deg, to: 150 deg, step: 10 deg}\n"
                         "  supply.voltage: {lin: [300 V, 460 A], n: 30}\n"
                         "  load.fraction: [2, 0.1, x]\n"
                         "  actuator.gap: {from: 5 mm, to: 6 mm, step: -1 mm}\n"
                         "  actuator.stop: none\n"
                         "  machine.mount_3: [[1 mm, 2 mm]]\n"
                         "  load.density: {log: [0 g/cm3, 1 g/cm3], n: 3}\n"
                         "  firing.every: {from: 1, to: 2, step: 0.5}\n"
                         "  run.tier: {from: 1, to: 2}\n"
                         "report: [p_min, i_peek]\n"
                         "vari: 1\n");
  static const char *const SAYS[] = {
      "bad.yaml:2:7: run has no key 'untill'; did you mean 'until'?",
      "bad.yaml:4:3: a scene has no key 'firing.angel'; did you mean 'firing.angle'?",
      "bad.yaml:5:33: supply.voltage: '460 A' has the wrong unit; write V",
      "bad.yaml:6:19: load.fraction: 2 is out of range; allowed: auto or 0..1",
      "bad.yaml:6:27: load.fraction: 'x' is not a number",
      "bad.yaml:7:46: actuator.gap: steps of -1 mm lead from 5 mm to 6 mm never",
      "bad.yaml:8:3: actuator.stop has keys of its own, such as actuator.stop.stiffness",
      "bad.yaml:9:3: machine.mount_3 is a pair [x, y]",
      "bad.yaml:10:24: load.density: log: both ends must be of one sign, and not 0",
      "bad.yaml:11:18: firing.every: 1.5 among its values is not a whole number",
      "bad.yaml:12:14: run.tier has words for values: a list of them is wanted",
      "bad.yaml:13:17: no measure 'i_peek' on tier circuit; did you mean 'i_peak'?",
      "bad.yaml:14:1: a study has no key 'vari'; did you mean 'vary'?"};
  ran r = run("check bad.yaml");
  CU_ASSERT_EQUAL(r.status, 2);
  for (size_t k = 0; k < COUNT(SAYS); k++)
    EXPECT(strstr(r.err, SAYS[k]), "does not say '%s': %s", SAYS[k], r.err);
  free_ran(&r);
  refuse("study bad.yaml -o out", "mistakes", "bad.yaml:", (const char *[]){NULL, NULL}, __LINE__);
}

static void refused(const char *study, const char *words, const char *at, const char *what,
                    int line) {
  write_file("r.yaml", study);
  refuse(words, study, at, (const char *[]){what, NULL}, line);
}
#define REFUSED(study, at, what) refused(study, "study r.yaml -o out", at, what, __LINE__)

static void refusals(void) {
  static const char ONE[] = "vary: {firing.angle: [100 deg]}\n";
  REFUSED("scene: paper\n", "r.yaml:1:1: ", "nothing is varied");
  REFUSED("vary: {firing.angle: []}\n", "r.yaml:1:", "the list is empty");
  REFUSED("vary: {firing.angle: {from: 90 deg, to: 91 deg}}\n",
          "r.yaml:1:8: ", "a range alone has no values; add step or n");
  REFUSED("vary: {circuit.thyristor: [latch, lach]}\n", "r.yaml:1:35: ", "did you mean 'latch'?");
  REFUSED("scene: papper\nvary: {firing.angle: [100 deg]}\n",
          "r.yaml:1:8: ", "did you mean 'paper'?");
  REFUSED("vary: nosuch.csv\n", "r.yaml:1:7: ", "nosuch.csv");
  REFUSED("vary: {run.sample: {lin: [1 ms, 2 ms], n: 1000000}, run.until: {lin: [1 s, 2 s], n: "
          "1000000}}\n",
          "r.yaml:1:8: ", "more than 10000000 cases");
  write_file("c.csv", "firing.angle,circuit.r1\n100 deg,1 ohm\n101 deg\n");
  REFUSED("vary: c.csv\n", "c.csv:3:1: ", "1 cells, and the header has 2");
  write_file("c.csv", "firing.angle_rad\n1\n");
  REFUSED("vary: c.csv\n", "c.csv:1:1: ", "column firing.angle_rad: firing.angle_deg is wanted");
  write_file("r.yaml", ONE);
  refused(ONE, "study r.yaml --set firing.angle=90deg -o out", "r.yaml:1:8: ", "--set", __LINE__);
  refused(ONE, "study r.yaml --shard 3/2 -o out", "--shard 3/2", "I/N is wanted", __LINE__);
  refused(ONE, "study r.yaml --shard auto -o out", "--shard auto", "SLURM_ARRAY_TASK_ID", __LINE__);
  refused(ONE, "study r.yaml --resume", "--resume", "-o DIR", __LINE__);
  refused(ONE, "study r.yaml --progress json", "--progress json", "-o DIR", __LINE__);
  refused(ONE, "study r.yaml --jobs 0", "--jobs", "1 to 4096", __LINE__);
  refused(ONE, "merge nosuch", "nosuch", "journal", __LINE__);
}

/* ---- bytes ---- */

/* The same for any number of workers, for one shard and for three, and on another day. */
static void one_result(void) {
  write_file("g.yaml", GRID);
  EXPECT_EXIT("study g.yaml -o one --jobs 1 --quiet", 1); /* some meet the pole */
  EXPECT_EXIT("study g.yaml -o two --jobs 2 --quiet", 1);
  EXPECT_EXIT("study g.yaml -o three --jobs 3 --quiet", 1);
  SAME_STUDY("one", "two");
  SAME_STUDY("one", "three");
  ran r = run("study g.yaml -o shards/1 --shard 1/3 --quiet");
  CU_ASSERT(r.status == 0 || r.status == 1);
  free_ran(&r);
  r = run("merge shards/1 -o short");
  EXPECT(r.status == 2 && strstr(r.err, "shard 2 of 3 is missing"), "%s", r.err);
  free_ran(&r);
  setenv("SLURM_ARRAY_TASK_ID", "12", 1), setenv("SLURM_ARRAY_TASK_MIN", "10", 1);
  setenv("SLURM_ARRAY_TASK_COUNT", "3", 1), setenv("SLURM_ARRAY_TASK_STEP", "1", 1);
  r = run("study g.yaml -o shards/3 --shard auto --quiet");
  CU_ASSERT(r.status == 0 || r.status == 1);
  free_ran(&r);
  r = run("study g.yaml -o shards/2 --shard 2/3 --quiet");
  CU_ASSERT(r.status == 0 || r.status == 1);
  free_ran(&r);
  EXPECT_EXIT("merge shards --quiet", 1);
  SAME_STUDY("one", "shards");
  r = run("merge shards/1 shards/2 shards/3 shards/2 -o twice");
  EXPECT(r.status == 2 && strstr(r.err, "is shard 2, as "), "%s", r.err);
  free_ran(&r);
  r = run("study g.yaml --set load.fraction=0.5 -o other/2 --shard 2/3 --quiet");
  free_ran(&r);
  r = run("merge shards/1 other/2 shards/3 -o strange");
  EXPECT(r.status == 2 && strstr(r.err, "is of another study than"), "%s", r.err);
  free_ran(&r);
  CU_ASSERT(access("short", F_OK) && access("twice", F_OK) && access("strange", F_OK));
  char *csv = read_file("one/study.csv"), *failures = read_file("one/failures.csv");
  CU_ASSERT_EQUAL(count_lines(csv) + count_lines(failures), 122);
  EXPECT(strstr(failures, ",1,") && strstr(failures, "the armature meets the pole cover"), "%s",
         failures);
  free(csv), free(failures);
}

/* In one process and in several: the order in which ngspice runs circuits does not matter. */
static void one_result_of_circuits(void) {
  if (is_for_memory_alone()) return;
  write_file("c.yaml", CIRCUIT);
  RUN_GOOD("study c.yaml -o c1 --jobs 1 --quiet --keep runs");
  RUN_GOOD("study c.yaml -o c2 --jobs 4 --quiet");
  SAME_STUDY("c1", "c2");
  RUN_GOOD("run paper --set circuit.deck=halfwave_paper --set run.until=12ms --set "
           "circuit.r1=4.7kohm --set circuit.thyristor=TYN1212 --quiet -o alone");
  same_content("c1/runs/3/run.csv", "alone/run.csv", __LINE__);
}

/* Cases that differ in nothing but what the program drives are run by one circuit, loaded once:
 * each as if it were the first, also behind one that has melted a fuse. */
static void one_circuit_for_many(void) {
  static const char *const ORDERS[] = {"26 ms, 44.9 ms", "44.9 ms, 26 ms"};
  char row[2][2][2048];
  for (int o = 0; o < 2; o++) {
    char text[2048], *cell[16];
    snprintf(text, sizeof text,
             "set: {circuit: {deck: halfwave_paper, transformer: autotransformer_ideal}, "
             "firing.every: 1, run: {until: 45 ms, tolerance: 1e-3}, events: {short1: {kind: "
             "coil_short, at: 10 ms}}}\nvary: {events.short1.at: [%s]}\n"
             "report: [p_min, v_ak_min, fuse_2.let_through, thyristor.di_dt, energy_residual]\n",
             ORDERS[o]);
    write_file("g.yaml", text);
    ran r = run("study g.yaml --jobs 1");
    char *line = strchr(r.out, '\n');
    for (int k = 0; k < 2 && line; k++, line = strchr(line, '\n')) {
      line++;
      snprintf(row[o][k], sizeof row[o][k], "%s", strchr(line, ',') + 1); /* but for the number */
      row[o][k][strcspn(row[o][k], "\n")] = '\0';
    }
    CU_ASSERT_PTR_NOT_NULL_FATAL(line);
    free_ran(&r);
    snprintf(text, sizeof text, "%s", row[o][o]);
    CU_ASSERT_EQUAL_FATAL(vs_csv_split(text, cell, COUNT(cell), NULL), 16);
    CU_ASSERT(atof(cell[4]) > 5); /* A2s: it did melt */
  }
  CU_ASSERT_STRING_EQUAL(row[0][0], row[1][1]);
  CU_ASSERT_STRING_EQUAL(row[0][1], row[1][0]);
}

/* ---- what it survives ---- */

/* A case that has no end costs itself. What a balance leaves over wants all steps of it. */
static void a_hanging_case(void) {
  write_file("h.yaml", "set: {run.sample: 1 ms}\nvary: {run.until: [10 ms, 9e5 s, 20 ms]}\nreport: "
                       "[p_min, energy_residual]\n");
  ran r = run("study h.yaml -o h --case-timeout 0.5s --jobs 2");
  EXPECT(r.status == 1 && strstr(r.out, "2 done, 1 failed") && strstr(r.err, "1 of 3 cases failed"),
         "%s%s", r.out, r.err);
  free_ran(&r);
  char *csv = without_ids(read_file("h/study.csv"));
  char *failures = without_ids(read_file("h/failures.csv"));
  EXPECT(strstr(csv, "\n0,0.01,") && strstr(csv, "\n2,0.02,") && count_lines(csv) == 3, "%s", csv);
  EXPECT(!strcmp(failures, "case,run.until_s,status,why\n1,900000,1,no end after 0.5 s "
                           "(--case-timeout)\n"),
         "%s", failures);
  free(csv), free(failures);
}

/* A worker that is ended is replaced, and its case run again; one that ends worker after worker
 * fails, and says how. */
static void a_case_that_kills(void) {
  write_file("k.yaml", "set: {run.sample: 1 ms}\nvary: {run.until: [9e5 s]}\n");
  pid_t master = begin("study k.yaml -o k");
  pid_t last = 0;
  for (int killed = 0; killed < 2; killed++) {
    pid_t worker = 0;
    WAIT_UNTIL(children_of(master, &worker, 1) && worker != last);
    CU_ASSERT_FATAL(worker && worker != last);
    wait_seconds(0.1); /* so that it is one, and no longer the fork */
    kill(worker, SIGKILL);
    last = worker;
  }
  ran r = collect(master);
  CU_ASSERT_EQUAL(r.status, 1);
  free_ran(&r);
  char *failures = read_file("k/failures.csv"), id[32] = "";
  vs_plan *plan = vs_alloc(1, sizeof *plan);
  vs_error err = {0};
  CU_ASSERT_EQUAL_FATAL(vs_study_file_read("k.yaml", vs_methods_all, NULL, 0, plan, &err), VS_OK);
  vs_identity *identity = vs_identity_new(plan);
  vs_error why = {0};
  CU_ASSERT(!vs_identity_of(identity, plan->first, id, &why));
  EXPECT(strlen(id) == 16 && strstr(failures, id), "no %s in %s", id, failures);
  vs_identity_free(identity);
  vs_plan_free(plan);
  free(plan);
  without_ids(failures);
  EXPECT(strstr(failures, "\n0,900000,1,its process died: signal 9 (Killed)"), "%s", failures);
  free(failures);
}

/* Ended by a signal it can be gone on with, and loses nothing. */
static void a_signal(void) {
  write_file("g.yaml", GRID);
  EXPECT_EXIT("study g.yaml -o whole --quiet", 1);
  write_file(
      "s.yaml",
      "set: {run.sample: 1 ms}\nvary: {run.until: [10 ms, 9e5 s]}\nreport: [energy_residual]\n");
  pid_t master = begin("study s.yaml -o stopped --jobs 2");
  WAIT_UNTIL(file_says("stopped/journal", " = 0,"));
  kill(master, SIGTERM);
  ran r = collect(master);
  EXPECT(r.status == 75 && strstr(r.err, "--resume goes on: 1 of 2 cases are done (rows: "),
         "%d %s", r.status, r.err);
  free_ran(&r);
  EXPECT_FILES("stopped", "journal ");
  r = run("plot stopped");
  EXPECT(r.status == 2 && strstr(r.err, "stopped: this study is not finished"), "%s", r.err);
  free_ran(&r);
  r = run("study s.yaml -o stopped");
  EXPECT(r.status == 2 && strstr(r.err, "a study was broken off here; --resume goes on with it"),
         "%s", r.err);
  free_ran(&r);
  r = run("study s.yaml -o stopped --resume --case-timeout 0.2s --progress json");
  EXPECT(r.status == 1 && strstr(r.out, "{\"done\": 1, \"failed\": 1, \"total\": 2, \"per_s\": "),
         "%s%s", r.out, r.err);
  free_ran(&r);
}

/* Cases whose lines are torn or damaged are run again. Of a damaged copy of the head its one line
 * is counted, wherever the copy stands. A changed study is refused. */
static void a_torn_journal(void) {
  write_file("g.yaml", GRID);
  EXPECT_EXIT("study g.yaml -o whole --quiet --overwrite", 1);
  EXPECT_EXIT("study g.yaml -o torn --quiet", 1);
  char *journal = read_file("torn/journal");
  char *row = strstr(journal, " = 65,"), *copy = strstr(journal, " H columns=");
  CU_ASSERT_FATAL(row && copy);
  row[6] = copy[6] = '#';
  journal[strlen(journal) - 7] = '\0';
  write_file("torn/journal", journal);
  free(journal);
  CU_ASSERT_EQUAL(remove("torn/manifest.json"), 0);
  ran r = run("study g.yaml -o torn --resume");
  EXPECT(r.status == 1 && strstr(r.err, "3 torn or damaged lines do not count"), "%s", r.err);
  free_ran(&r);
  SAME_STUDY("whole", "torn");
  /* nothing is left to do; the torn one was cut off. A warning is no table and no progress */
  r = run("study g.yaml -o torn --resume --quiet");
  EXPECT(r.status == 1 && strstr(r.err, "2 torn or damaged lines do not count"), "%s", r.err);
  free_ran(&r);
  SAME_STUDY("whole", "torn");
  r = run("study g.yaml -o torn --resume --set load.fraction=0.1");
  EXPECT(r.status == 2 && strstr(r.err, "torn/journal:1:1: is of another study"), "%s", r.err);
  free_ran(&r);
  char changed[sizeof GRID + 16];
  snprintf(changed, sizeof changed, "%s# more\n", GRID);
  write_file("g.yaml", changed);
  r = run("study g.yaml -o torn --resume");
  EXPECT(r.status == 2 && strstr(r.err, "torn/journal:1:1: is of another study"), "%s", r.err);
  free_ran(&r);
  SAME_STUDY("whole", "torn");
}

/* One process at a time: another one neither begins in its folder nor reads a journal that may
 * still grow, which it would cut off at where it read it to. */
static void one_process(void) {
  write_file("g.yaml", GRID);
  CU_ASSERT_EQUAL(mkdir("busy", 0777), 0);
  int folder = open("busy", O_RDONLY | O_CLOEXEC);
  CU_ASSERT_EQUAL(flock(folder, LOCK_EX), 0);
  ran r = run("study g.yaml -o busy");
  EXPECT(r.status == 2 && strstr(r.err, "busy/journal: another process"), "%d %s", r.status, r.err);
  free_ran(&r);
  EXPECT_FILES("busy", "");
  write_file("busy/journal", "half of a line");
  r = run("study g.yaml -o busy --resume");
  EXPECT(r.status == 2 && strstr(r.err, "busy/journal: another process"), "%d %s", r.status, r.err);
  free_ran(&r);
  close(folder);
  /* where folders have no locks */
  int file = open("busy/journal", O_RDWR | O_CLOEXEC);
  struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  CU_ASSERT_EQUAL(fcntl(file, F_SETLK, &whole), 0);
  r = run("study g.yaml -o busy --resume");
  EXPECT(r.status == 2 && strstr(r.err, "busy/journal: another process"), "%d %s", r.status, r.err);
  free_ran(&r);
  close(file);
  remove_tree("busy");
}

/* A file that may not grow any more is what a full disk is: the study ends, and goes on later. */
static void a_full_disk(void) {
  struct stat whole;
  struct rlimit before, small;
  write_file("g.yaml", GRID);
  EXPECT_EXIT("study g.yaml -o whole --quiet --overwrite", 1);
  CU_ASSERT_EQUAL(stat("whole/journal", &whole), 0);
  getrlimit(RLIMIT_FSIZE, &before);
  small = before;
  small.rlim_cur = (rlim_t)whole.st_size * 4 / 5;
  setrlimit(RLIMIT_FSIZE, &small);
  ran r = run("study g.yaml -o full --quiet");
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT(r.status == 1 && strstr(r.err, "full/journal: cannot be written: ") &&
             strstr(r.err, "--resume goes on with it"),
         "%d %s", r.status, r.err);
  EXPECT_FILES("full", "journal ");
  free_ran(&r);
  EXPECT_EXIT("study g.yaml -o full --resume --quiet", 1);
  SAME_STUDY("whole", "full");
}

/* A scene whose cases take some milliseconds, so that there are instants to choose from. */
static const char SLOW[] = "set: {run.until: 4 s, firing.every: 1}\n"
                           "vary:\n"
                           "  firing.angle: {from: 100 deg, to: 175 deg, step: 1 deg}\n"
                           "report: [p_min, i_peak]\n";

/* Waits for its end after ending its master, or a worker of it, at that instant. */
static int disturb(const char *words, double at_s, bool worker) {
  pid_t master = begin(words);
  wait_seconds(at_s);
  pid_t child;
  kill(worker && children_of(master, &child, 1) ? child : master, SIGKILL);
  ran r = collect(master);
  int status = r.status;
  free_ran(&r);
  return status;
}

/* kill -9 of the master or of a worker, again and again; each time --resume ends with the bytes of
 * an undisturbed study. 20 instants, with sanitizers 5; 200 with VS_LONG. */
static void killed_at_any_instant(void) {
  int instants = getenv("VS_LONG") ? 200 : is_for_memory_alone() ? 5 : 20, broken = 0;
  /* what is killed has no end at which leaks are looked for; and beside a child that was just
   * killed LeakSanitizer was once seen not to come to its end (200 instants without it: none) */
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
  write_file("slow.yaml", SLOW);
  double began = vs_budget_clock_s();
  EXPECT_EXIT("study slow.yaml -o whole --quiet --overwrite", 0);
  double length = vs_budget_clock_s() - began; /* another load makes it another one */
  srand(7);
  for (int k = 0; k < instants || (broken < instants / 3 && k < 5 * instants); k++) {
    remove_tree("killed");
    int status = 1137;
    for (int n = 0; n < 50 && status; n++) {
      const bool worker = (k + n) % 3 == 2;
      double at_s = length * (double)rand() / RAND_MAX * (n + 1);
      status = disturb("study slow.yaml -o killed --resume --quiet", at_s, worker);
      broken += status == 1000 + SIGKILL;
      if (!n && !worker && !status) length = at_s; /* it had ended before */
      EXPECT(status == 0 || status == 1000 + SIGKILL, "exit status %d", status);
    }
    SAME_STUDY("whole", "killed");
  }
  EXPECT(broken >= instants / 3, "only %d of %d were broken off", broken, instants);
}

static const vs_test TESTS[] = {
    {"checksums", checksums},
    {"cells", cells},
    {"a grid", a_grid},
    {"a case is a run", a_case_is_a_run},
    {"sides of ratings", sides_of_ratings},
    {"a list", a_list},
    {"on standard output", on_standard_output},
    {"unheard", unheard},
    {"hostile names", hostile_names},
    {"whole numbers", whole_numbers},
    {"mistakes", mistakes},
    {"refusals", refusals},
    {"one result", one_result},
    {"one result of circuits", one_result_of_circuits},
    {"one circuit for many cases", one_circuit_for_many},
    {"a hanging case", a_hanging_case},
    {"a case that kills", a_case_that_kills},
    {"a signal", a_signal},
    {"a torn journal", a_torn_journal},
    {"one process", one_process},
    {"a full disk", a_full_disk},
    {"killed at any instant", killed_at_any_instant},
};

int main(void) {
  return program_suite("study", TESTS, COUNT(TESTS));
}
