/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study that overwrites another one leaves nothing of it in the folder, neither the report and
 * its pictures nor the runs that were kept; and nothing that is the user's own is touched. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "program.h"

#define RESULT "failures.csv journal manifest.json study.csv "
#define SET "set: {run.until: 20 ms, run.tier: switched}\n"

/* Of each way to choose cases, for each names its pictures in its own way. */
static const char *const STUDIES[] = {
    SET "vary: {firing.angle: [100 deg, 110 deg]}\nreport: [i_peak, p_min]\n",
    SET "vary: {firing.angle: [100 deg, 110 deg], load.fraction: [0, 0.5], supply.voltage: "
        "[430 V, 440 V]}\nreport: [i_peak]\n",
    SET "sample: {method: sobol, n: 16, spread: {actuator.inductance: 5 % normal, "
        "actuator.resistance: 5 % normal}}\nreport: [i_peak]\n",
    SET
    "vary: {firing.angle: {lin: [90 deg, 120 deg], n: 4}, supply.voltage: {lin: [400 V, 440 V], "
    "n: 4}}\nfind: {worst: max i_peak}\n",
    "set: {run.until: 20 ms, run.tier: switched, events: {'a/b': {kind: sag, cycle: 1}}}\n"
    "vary: {events.a/b.level: [40 %, 80 %]}\nreport: [i_peak]\n"};

static void nothing_is_left(void) {
  if (!on_path("gnuplot")) return;
  write_file("new.yaml", SET "vary: {load.fraction: [0, 0.5]}\nreport: [p_max]\n");
  for (size_t k = 0; k < COUNT(STUDIES); k++) {
    write_file("old.yaml", STUDIES[k]);
    ran r = run("study old.yaml -o s --quiet --keep runs");
    EXPECT(r.status == 0, "%zu: %d %s", k, r.status, r.err);
    free_ran(&r);
    RUN_GOOD("plot s --quiet");
    char *files = listing("s");
    EXPECT(strstr(files, ".png ") && strstr(files, "report.html runs ") &&
               strstr(files, " study.csv "),
           "%s", files);
    free(files);
    RUN_GOOD("study new.yaml -o s --overwrite --quiet");
    EXPECT_FILES("s", RESULT);
    remove_tree("s");
  }
}

/* Files of other names, and links whatever their names are. */
static void the_users_own(void) {
  write_file("old.yaml", STUDIES[0]);
  RUN_GOOD("study old.yaml -o s --quiet --keep runs");
  write_file("s/notes.html", "mine");
  write_file("s/i_peak.png", "mine");
  write_file("s/id.png", "mine"); /* named after columns of which the report draws no picture */
  write_file("s/status.png", "mine");
  write_file("s/firing.angle_deg.png", "mine");
  write_file("s/cloud_firing.angle_deg.png", "mine");
  write_file("s/over_i_peak_a.png", "mine");
  mkdir("s/runs/77", 0777); /* the study has no such case */
  write_file("s/runs/77/run.csv", "mine");
  mkdir("s/runs/01", 0777);
  write_file("s/runs/01/run.csv", "mine");
  write_file("s/runs/0/notes.txt", "mine");
  write_file("else.png", "mine");
  write_file("report", "mine");
  mkdir("other", 0777);
  write_file("other/run.csv", "mine");
  CU_ASSERT_EQUAL(symlink("../else.png", "s/i_peak_a.png"), 0);
  CU_ASSERT_EQUAL(symlink("../report", "s/report.html"), 0);
  CU_ASSERT_EQUAL(symlink("../../other", "s/runs/7"), 0);
  RUN_GOOD("study old.yaml -o s --overwrite --quiet");
  EXPECT_FILES("s", "cloud_firing.angle_deg.png failures.csv firing.angle_deg.png i_peak.png "
                    "i_peak_a.png id.png journal manifest.json notes.html over_i_peak_a.png "
                    "report.html runs status.png study.csv ");
  EXPECT_FILES("s/runs", "0 01 7 77 ");
  EXPECT_FILES("s/runs/77", "run.csv ");
  EXPECT_FILES("s/runs/0", "notes.txt ");
  EXPECT_FILES("other", "run.csv ");
  char *text = read_file("else.png");
  CU_ASSERT_STRING_EQUAL(text, "mine");
  free(text);
  remove_tree("s");
}

/* Which cases the old study had is told by its journal, or else by its files. */
static void kept_runs(void) {
  for (int journal = 0; journal < 2; journal++) {
    write_file("old.yaml", STUDIES[0]);
    RUN_GOOD("study old.yaml -o s --quiet --keep runs");
    mkdir("s/runs/2", 0777);
    write_file("s/runs/2/run.csv", "mine");
    EXPECT_FILES("s/runs", "0 1 2 ");
    if (journal) { /* it was broken off */
      unlink("s/study.csv"), unlink("s/failures.csv"), unlink("s/manifest.json");
    } else
      unlink("s/journal");
    RUN_GOOD("study old.yaml -o s --overwrite --quiet");
    EXPECT_FILES("s/runs", "2 ");
    remove_tree("s");
  }
}

/* merge over another study's result; over its own the report stays what it was. */
static void merged(void) {
  write_file("old.yaml", STUDIES[0]);
  write_file("new.yaml", SET "vary: {load.fraction: [0, 0.5]}\nreport: [p_max]\n");
  RUN_GOOD("study old.yaml -o s --quiet");
  RUN_GOOD("study new.yaml -o n --quiet");
  write_file("s/report.html", "of s");
  write_file("s/i_peak_a.png", "of s");
  RUN_GOOD("merge s --quiet");
  EXPECT_FILES("s", "failures.csv i_peak_a.png journal manifest.json report.html study.csv ");
  RUN_GOOD("merge n -o s --overwrite --quiet");
  EXPECT_FILES("s", "failures.csv manifest.json study.csv ");
  RUN_GOOD("merge n -o s --quiet");
  remove_tree("s");
  remove_tree("n");
}

/* What merge does not replace unasked: all that `study` does not, with a manifest or without. */
static void merged_over_others(void) {
  static const char *const LEFT[] = {"study.csv", "failures.csv", "manifest.json", "journal"};
  write_file("old.yaml", STUDIES[0]);
  write_file("new.yaml", SET "vary: {load.fraction: [0, 0.5]}\nreport: [p_max]\n");
  RUN_GOOD("study old.yaml -o s --quiet");
  RUN_GOOD("study new.yaml -o n --quiet");
  char *journal = read_file("s/journal");
  for (size_t k = 0; k < COUNT(LEFT); k++) {
    char path[64], at[72];
    mkdir("d", 0777);
    snprintf(path, sizeof path, "d/%s", LEFT[k]);
    snprintf(at, sizeof at, "%s: ", path);
    write_file(path, k == 3 ? journal : "mine\n");
    refuse("merge n -o d", LEFT[k], at,
           (const char *[]){"another study", "--overwrite replaces it"}, __LINE__);
    char *text = read_file(path);
    CU_ASSERT_STRING_EQUAL(text, k == 3 ? journal : "mine\n");
    free(text);
    RUN_GOOD("merge n -o d --overwrite --quiet");
    EXPECT_FILES("d", "failures.csv manifest.json study.csv ");
    RUN_GOOD("merge n -o d --quiet");
    remove_tree("d");
  }
  /* a study's own folder: its journal is the shards' */
  unlink("n/manifest.json");
  RUN_GOOD("merge n --quiet");
  EXPECT_FILES("n", RESULT);
  RUN_GOOD("merge n --quiet");
  /* not from under a process that is at its study */
  int folder = open("s", O_RDONLY | O_CLOEXEC);
  CU_ASSERT_EQUAL(flock(folder, LOCK_EX), 0);
  refuse("merge n -o s --overwrite", "locked",
         "s/journal: ", (const char *[]){"another process", NULL}, __LINE__);
  close(folder);
  EXPECT_FILES("s", RESULT);
  free(journal);
  remove_tree("s");
  remove_tree("n");
}

int main(void) {
  static const vs_test TESTS[] = {
      {"nothing of it is left", nothing_is_left},
      {"the user's own stays", the_users_own},
      {"kept runs", kept_runs},
      {"merged", merged},
      {"merged over others", merged_over_others},
  };
  return program_suite("stale", TESTS, COUNT(TESTS));
}
