/* SPDX-License-Identifier: GPL-3.0-or-later
 * The clock of the day jumps, files are from the future, processes are stopped for a while: no byte
 * of a result changes, no time is negative, and no case fails by --case-timeout that has an end. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "age.h"

/* ---- a clock that jumps ---- */

static const char STUDY[] = "set: {run.until: 1 s, firing.every: 1}\n"
                            "vary: {firing.angle: {lin: [100 deg, 170 deg], n: 400}}\n"
                            "report: [p_min, i_peak]\n";

/* Each makes something in "out". */
static const char *const COMMANDS[] = {
    "study a.yaml -o out/s --jobs 2 --progress json", "merge out/s -o out/m --quiet", "plot out/s",
    "run paper --reproducible --json -o out/r",
    "run paper --tier circuit --set run.until=2ms --reproducible --json -o out/c"};

/* No number of a line of progress is negative. */
static void expect_progress(const char *lines) {
  int seen = 0;
  for (const char *line = lines; (line = strstr(line, "\"done\"")); line++, seen++) {
    const char *end = strchr(line, '\n'), *minus = strstr(line, ": -");
    EXPECT(end && (!minus || minus > end), "%.*s", end ? (int)(end - line) : 0, line);
  }
  EXPECT(seen >= 1, "%s", lines);
}

static char *make_all(void) {
  remove_tree("out");
  for (size_t k = 0; k < COUNT(COMMANDS); k++) {
    ran r = run("%s", COMMANDS[k]);
    EXPECT(r.status == 0, "%s: %d %s", COMMANDS[k], r.status, r.err);
    if (!k) expect_progress(r.out);
    free_ran(&r);
  }
  return tree_of("out");
}

static void jumps(void) {
#ifdef __SANITIZE_ADDRESS__
  printf("(left out: a sanitizer wants to be loaded first) ");
  return;
#endif
  write_file("a.yaml", STUDY);
  char *good = make_all();
  setenv("LD_PRELOAD", VS_CLOCK, 1);
  char *tree = make_all();
  EXPECT(!strcmp(tree, good), "is\n%sand was\n%s", tree, good);
  free(tree), free(good);
  /* what has no end is ended in its time, and nothing else is */
  write_file("h.yaml", "set: {run.sample: 1 ms}\nvary: {run.until: [10 ms, 9e5 s, 20 ms]}\nreport: "
                       "[p_min, energy_residual]\n");
  const double began = vs_budget_clock_s();
  ran r = run("study h.yaml -o h --case-timeout 2s --jobs 2 --quiet");
  const double took_s = vs_budget_clock_s() - began;
  unsetenv("LD_PRELOAD");
  EXPECT(r.status == 1 && strstr(r.err, "1 of 3 cases failed"), "%d %s", r.status, r.err);
  EXPECT(took_s > 2 && took_s < 60, "%g s", took_s);
  free_ran(&r);
}

/* The clocks that ngspice asks in each step are the program's own, whichever of them it was built
 * to ask. */
static void stand_still(void) {
#ifdef __SANITIZE_ADDRESS__
  printf("(left out: a sanitizer wants to be loaded first) ");
  return;
#endif
  setenv("LD_PRELOAD", VS_CLOCK, 1);
  setenv("VS_ASK_CLOCKS", "1", 1);
  ran r = run("--version");
  unsetenv("VS_ASK_CLOCKS");
  unsetenv("LD_PRELOAD");
  EXPECT(strstr(r.err, "stand still: clock 1, ftime 1, getrusage 1\n"), "%s", r.err);
  free_ran(&r);
}

/* ---- files from the future ---- */

static void future(void) {
  static const char *const FILES[] = {"a.yaml", "f/journal", "f"};
  const struct timespec in_2100[2] = {{4102444800, 0}, {4102444800, 0}};
  write_file("a.yaml", STUDY);
  RUN_GOOD("study a.yaml -o f --quiet");
  char *good = tree_of("f");
  char *journal = read_file("f/journal");
  CU_ASSERT_EQUAL(truncate("f/journal", (off_t)strlen(journal) / 2), 0);
  CU_ASSERT_EQUAL(remove("f/manifest.json"), 0);
  for (size_t k = 0; k < COUNT(FILES); k++)
    CU_ASSERT_EQUAL(utimensat(AT_FDCWD, FILES[k], in_2100, 0), 0);
  ran r = run("study a.yaml -o f --quiet --resume");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  free_ran(&r);
  char *tree = tree_of("f");
  EXPECT(!strcmp(tree, good), "is\n%sand was\n%s", tree, good);
  free(tree), free(good), free(journal);
}

/* ---- processes that are stopped ---- */

/* Runs the command, all of whose processes are stopped for a while in the midst of it, as a batch
 * system does with a job. The first one goes on first. Its `children` are waited for. */
static void stop_for(double pause_s, const char *words, size_t children) {
  enum { MOST = 8 };
  pid_t found[MOST];
  size_t n = 0;
  pid_t first = begin(words);
  WAIT_UNTIL((n = children_of(first, found, MOST)) >= children);
  EXPECT(n >= children, "%s: %zu processes", words, n);
  wait_seconds(0.3);
  kill(first, SIGSTOP);
  for (size_t k = 0; k < n; k++) kill(found[k], SIGSTOP);
  wait_seconds(pause_s);
  kill(first, SIGCONT);
  wait_seconds(0.3);
  for (size_t k = 0; k < n; k++) kill(found[k], SIGCONT);
  ran r = collect(first);
  EXPECT(r.status == 0, "%s: %d %s", words, r.status, r.err);
  free_ran(&r);
}

static void stopped(void) {
  write_file("p.yaml", "set: {run.until: 400 s, run.sample: 1 ms, firing.every: 1}\n"
                       "vary: {firing.angle: {lin: [100 deg, 170 deg], n: 4}}\n"
                       "report: [p_min, energy_residual]\n");
  stop_for(12, "study p.yaml -o p --case-timeout 10s --jobs 2 --quiet", 2);
}

/* A law of the user's own that is stopped together with the run. */
static void stopped_law(void) {
  write_file("law.sh", "while read line; do sleep 1; echo '{\"angle_deg\": 110}'; done\n");
  write_file("l.yaml", "firing: {every: 1}\ninstruments: {}\nrun: {tier: switched, until: 0.05 s}\n"
                       "control: {law: pipe, timeout: 4 s, command: sh law.sh}\n");
  stop_for(6, "run l.yaml --allow-code --quiet -o l", 2);
}

static const vs_test TESTS[] = {{"the clock of the day jumps", jumps},
                                {"ngspice's clocks stand still", stand_still},
                                {"files from the future", future},
                                {"a job that is stopped", stopped},
                                {"a law that is stopped", stopped_law}};

int main(void) {
  return program_suite("clocks", TESTS, COUNT(TESTS));
}
