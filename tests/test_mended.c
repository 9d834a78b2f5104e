/* SPDX-License-Identifier: GPL-3.0-or-later
 * A journal whose head is damaged is mended from a copy of the head; one of another version is told
 * by name; cases that failed are run again where that is asked for. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/hash.h"
#include "program.h"

/* The journal of the study in "s" and what `merge` makes of it, as they were made. */
static char *journal, *study, *manifest;

static void make_study(void) {
  write_file("a.yaml", "set: {run.until: 20 ms, run.tier: switched}\n"
                       "vary: {firing.angle: [100 deg, 110 deg, 120 deg]}\nreport: [i_peak]\n");
  RUN_GOOD("study a.yaml -o s --quiet");
  journal = read_file("s/journal");
  study = read_file("s/study.csv");
  manifest = read_file("s/manifest.json");
  mkdir("j", 0777);
  int copies = 0;
  for (const char *s = journal; (s = strstr(s, " H identity=")); s++) copies++;
  EXPECT(copies >= 1, "%d", copies);
}

/* The line of the journal that begins behind its sum with these words. */
static char *line_of(char *text, const char *begin) {
  char words[64];
  snprintf(words, sizeof words, " %s", begin);
  char *at = strstr(text, words);
  CU_ASSERT_PTR_NOT_NULL_FATAL(at);
  while (at > text && at[-1] != '\n') at--;
  return at;
}

/* Damages a line in its middle, without changing its length. */
static void damage(char *text, const char *begin) {
  char *at = line_of(text, begin);
  at[strcspn(at, "\n") / 2] ^= 1;
}

static void expect_same(const char *folder, int line) {
  char path[64];
  snprintf(path, sizeof path, "%s/study.csv", folder);
  char *got = read_file(path);
  expect(!strcmp(got, study), line, "%s", got);
  free(got);
  snprintf(path, sizeof path, "%s/manifest.json", folder);
  got = read_file(path);
  expect(!strcmp(got, manifest), line, "%s", got);
  free(got);
}

/* Merges the journal as it is, then goes on with it: nothing is lost. */
static void expect_mended(const char *text, bool in_place, int line) {
  write_file("j/journal", text);
  run_good("merge j -o m --quiet", line);
  expect_same("m", line);
  ran r = run("study a.yaml -o j --resume");
  expect(r.status == 0, line, "%d %s", r.status, r.err);
  expect(strstr(r.err, "its head was damaged, and is taken from a copy") != NULL, line, "%s",
         r.err);
  free_ran(&r);
  expect_same("j", line);
  char *after = read_file("j/journal");
  const char *rows = strstr(journal, " = ");
  size_t head = (size_t)(rows - 8 - journal);
  if (in_place) expect(!strncmp(after, journal, head), line, "the head is not written again");
  free(after);
  remove_tree("j"), remove_tree("m");
  mkdir("j", 0777);
}

static void each_line_of_the_head(void) {
  static const char *const LINES[] = {"h identity=",       "h columns=",      "h failures=",
                                      "h manifest_begin=", "h manifest_end=", "h counts="};
  for (size_t k = 0; k < COUNT(LINES); k++) {
    char *text = strdup(journal);
    damage(text, LINES[k]);
    expect_mended(text, true, __LINE__);
    damage(text, "h vibrospice journal");
    expect_mended(text, true, __LINE__);
    free(text);
  }
  char *text = strdup(journal); /* all of them */
  for (size_t k = 0; k < COUNT(LINES); k++) damage(text, LINES[k]);
  expect_mended(text, true, __LINE__);
  free(text);
}

/* A head of which bytes are gone, or more than its bytes are there. */
static void a_head_that_has_moved(void) {
  vs_text text = {0};
  expect_mended(journal + 400, false, __LINE__);
  char *first = line_of(journal, "= "); /* of whichever case has ended first */
  expect_mended(first, false, __LINE__);
  vs_text_add(&text, "what\nis\nthis\n%s", journal + 60);
  expect_mended(text.text, false, __LINE__);
  vs_text_free(&text);
}

static void no_good_copy(void) {
  char *text = strdup(journal);
  damage(text, "h columns=");
  for (char *s = text; (s = strstr(s, " H columns=")); s++) s[20] ^= 1;
  write_file("j/journal", text);
  ran r = run("study a.yaml -o j --resume");
  EXPECT(r.status == 2 && strstr(r.err, "its head lacks a line"), "%d %s", r.status, r.err);
  free_ran(&r);
  free(text);
}

/* Puts a line with its sum in the place of one that has the same length. */
static void replace_line(char *text, const char *begin, const char *words) {
  char *at = line_of(text, begin), line[256];
  size_t length = strcspn(at, "\n");
  snprintf(line, sizeof line, "%08x %s", vs_hash_crc32(words, strlen(words)), words);
  CU_ASSERT_EQUAL_FATAL(strlen(line), length);
  memcpy(at, line, length);
}

static void a_copy_of_another_study(void) {
  char *text = strdup(journal);
  replace_line(text, "H counts=", "H counts=4 1 1");
  write_file("j/journal", text);
  ran r = run("study a.yaml -o j --resume");
  EXPECT(r.status == 2 && strstr(r.err, "has two heads"), "%d %s", r.status, r.err);
  free_ran(&r);
  free(text);
}

static void versions(void) {
  char *text = strdup(journal);
  replace_line(text, "h vibrospice journal", "h vibrospice journal 3");
  write_file("j/journal", text);
  ran r = run("study a.yaml -o j --resume");
  EXPECT(r.status == 2 && strstr(r.err, "is of another version of the journal"), "%d %s", r.status,
         r.err);
  free_ran(&r);
  r = run("merge j -o m");
  EXPECT(r.status == 2 && strstr(r.err, "is of another version of the journal"), "%d %s", r.status,
         r.err);
  free_ran(&r);
  replace_line(text, "h vibrospice journal", "h vibrospice journal 1");
  for (char *s; (s = strstr(text, " H "));) { /* it had no copies */
    char *line = line_of(text, "H "), *next = strchr(line, '\n') + 1;
    memmove(line, next, strlen(next) + 1);
  }
  write_file("j/journal", text);
  RUN_GOOD("merge j -o m --quiet");
  expect_same("m", __LINE__);
  RUN_GOOD("study a.yaml -o j --resume --quiet");
  expect_same("j", __LINE__);
  remove_tree("j"), remove_tree("m");
  free(text);
}

/* ---- again ---- */

static int count_rows(const char *path) {
  char *text = read_file(path);
  int rows = count_lines(text) - 1;
  free(text);
  return rows;
}

/* Cases of tenths of a second that were given a hundredth. */
static void failed_cases_again(void) {
  write_file("f.yaml", "set: {run.sample: 1 ms, run.until: 600 s, run.tier: switched}\n"
                       "vary: {firing.angle: [100 deg, 110 deg]}\n"
                       "report: [p_min, energy_residual]\n");
  ran r = run("study f.yaml -o f --case-timeout 0.01s --quiet");
  EXPECT(r.status == 1, "%d %s", r.status, r.err);
  free_ran(&r);
  CU_ASSERT_EQUAL(count_rows("f/failures.csv"), 2);
  r = run("study f.yaml -o f --resume --quiet"); /* they stay failed */
  CU_ASSERT_EQUAL(r.status, 1);
  free_ran(&r);
  CU_ASSERT_EQUAL(count_rows("f/failures.csv"), 2);
  r = run("study f.yaml -o f --resume --again failed");
  EXPECT(r.status == 0 && strstr(r.err, "2 cases that failed run again"), "%d %s", r.status, r.err);
  free_ran(&r);
  CU_ASSERT_EQUAL(count_rows("f/failures.csv"), 0);
  RUN_GOOD("study f.yaml -o clean --quiet");
  char *again = read_file("f/study.csv"), *clean = read_file("clean/study.csv");
  CU_ASSERT_STRING_EQUAL(again, clean);
  RUN_GOOD("merge f -o g --quiet"); /* of two rows of a case the later one counts */
  free(again);
  again = read_file("g/study.csv");
  CU_ASSERT_STRING_EQUAL(again, clean);
  RUN_GOOD("study f.yaml -o f --resume --again failed --quiet"); /* none failed */
  free(again), free(clean);
}

static void words_of_again(void) {
  refuse("study a.yaml -o x --again failed", "alone", "", (const char *[]){"--again", "--resume"},
         __LINE__);
  refuse("study a.yaml -o x --resume --again all", "all", "",
         (const char *[]){"there is: failed", NULL}, __LINE__);
  write_file("w.yaml", "set: {run.until: 20 ms, run.tier: switched}\n"
                       "vary: {firing.angle: {lin: [90 deg, 120 deg], n: 4}}\n"
                       "find: {worst: max i_peak}\n");
  refuse("study w.yaml -o x --resume --again failed", "search", "",
         (const char *[]){"--again", "worst"}, __LINE__);
  free(journal), free(study), free(manifest);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"a study to damage", make_study},
      {"each line of the head", each_line_of_the_head},
      {"a head that has moved", a_head_that_has_moved},
      {"no good copy", no_good_copy},
      {"a copy of another study", a_copy_of_another_study},
      {"versions", versions},
      {"failed cases again", failed_cases_again},
      {"words of --again", words_of_again},
  };
  return program_suite("mended", TESTS, COUNT(TESTS));
}
