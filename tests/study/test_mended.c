/* SPDX-License-Identifier: GPL-3.0-or-later
 * A journal whose head is damaged is mended from a copy of the head; one of another version is told
 * by name, and so is one of another program; cases that failed are run again where that is asked
 * for. A row that is changed between its writing and its reading is told. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/hash.h"
#include "seam.h"

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
  EXPECT(r.status == 2 && strstr(r.err, "its head lacks a line") &&
             strstr(r.err, "put the file back"),
         "%d %s", r.status, r.err);
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

/* A block that stands there twice is no second study: its lines are told, and not counted. */
static void a_block_twice(void) {
  vs_text twice = {0};
  vs_text_add(&twice, "%s%s", journal, journal);
  write_file("j/journal", twice.text);
  ran r = run("study a.yaml -o j --resume --quiet");
  EXPECT(r.status == 0 && !strstr(r.err, "two heads"), "%d %s", r.status, r.err);
  expect_same("j", __LINE__);
  free_ran(&r);
  vs_text_free(&twice);
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

/* A journal that a program wrote before the format was numbered 2, as it was. */
static void an_old_journal(void) {
  ran r = run("merge %s/cases/journal_1 -o m --quiet", VS_TEST_FOLDER);
  expect_good(&r, "merge of an old journal", __LINE__);
  free_ran(&r);
  char *was = read_file(VS_TEST_FOLDER "/cases/journal_1/study.csv"),
       *is = read_file("m/study.csv");
  CU_ASSERT_STRING_EQUAL(is, was);
  free(was), free(is);
  was = read_file(VS_TEST_FOLDER "/cases/journal_1/manifest.json"),
  is = read_file("m/manifest.json");
  CU_ASSERT_STRING_EQUAL(is, was);
  free(was), free(is);
  remove_tree("m");
}

/* ---- two programs ---- */

/* Gives all lines the sum of what stands in them. */
static void sum_again(char *text) {
  for (char *line = text, *end; (end = strchr(line, '\n')); line = end + 1) {
    char sum[9];
    snprintf(sum, sizeof sum, "%08x", vs_hash_crc32(line + 9, (size_t)(end - line) - 9));
    memcpy(line, sum, 8);
  }
}

/* Changes the character behind these words wherever they stand. */
static void change_behind(char *text, const char *words) {
  for (char *s = text; (s = strstr(s, words)); s++) s[strlen(words)] ^= 1;
}

/* Neither goes on with the other's rows, nor are they merged. */
static void expect_two_programs(const char *text, const char *says, int line) {
  write_file("j/journal", text);
  ran r = run("study a.yaml -o j --resume");
  expect(r.status == 2 && strstr(r.err, says) &&
             strstr(r.err, "and this is vibrospice " VS_VERSION),
         line, "%d %s", r.status, r.err);
  free_ran(&r);
  char *now = read_file("j/journal");
  expect(!strcmp(now, text), line, "the journal has changed");
  free(now);
  r = run("merge j s -o m");
  expect(r.status == 2 && strstr(r.err, says) &&
             strstr(r.err, "rows of two programs are not mixed"),
         line, "%d %s", r.status, r.err);
  free_ran(&r);
}

static void two_programs(void) {
  mkdir("j", 0777);
  char *text = strdup(journal);
  change_behind(text, " identity=");
  sum_again(text);
  expect_two_programs(text, " by another build of vibrospice " VS_VERSION, __LINE__);
  change_behind(text, "\"program\": {\"version\": \"");
  sum_again(text);
  char says[64];
  snprintf(says, sizeof says, " by vibrospice %c%s ", VS_VERSION[0] ^ 1, VS_VERSION + 1);
  expect_two_programs(text, says, __LINE__);
  change_behind(text, "\"seed\": "); /* another study, of the same program */
  change_behind(text, "\"program\": {\"version\": \"");
  sum_again(text);
  write_file("j/journal", text);
  ran r = run("study a.yaml -o j --resume");
  EXPECT(r.status == 2 && strstr(r.err, "is of another study"), "%d %s", r.status, r.err);
  free_ran(&r);
  remove_tree("j");
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

/* ---- changed meanwhile ---- */

typedef struct change {
  const char *what;
  void (*make)(char *text, size_t *size);
  bool head; /* it leaves the head as it is, so that --resume goes on */
} change;

static void empty(char *text, size_t *size) {
  (void)text;
  *size = 0;
}
static void zeros(char *text, size_t *size) { /* what a file has that was emptied, and goes on */
  memset(text, 0, *size - 64);
}
static void line_ends(char *text, size_t *size) {
  memset(text, '\n', *size);
}
static void cut_in_the_rows(char *text, size_t *size) {
  *size = (size_t)(line_of(text, "= ") + 20 - text);
}
static void digits_in_a_row(char *text, size_t *size) {
  (void)size;
  char *row = line_of(text, "= ");
  memset(row + (strcspn(row, "\n") - 8) / 2, '9', 8);
}
static void digits_in_a_sum(char *text, size_t *size) {
  (void)size;
  memset(line_of(text, "= "), '9', 8);
}
static char *next_row(char *line) {
  char *next = strstr(line + 9, " = ");
  return next ? next - 8 : NULL;
}
/* Its sum is right, and it stands where another row of its length stood. */
static void row_of_another_case(char *text, size_t *size) {
  (void)size;
  char *row = line_of(text, "= "), *other = NULL;
  for (; row; row = next_row(row)) {
    const size_t length = strcspn(row, "\n");
    for (other = next_row(row); other && strcspn(other, "\n") != length;) other = next_row(other);
    if (other) break;
  }
  CU_ASSERT_PTR_NOT_NULL_FATAL(other);
  memcpy(row, other, strcspn(other, "\n"));
}

static const change CHANGES[] = {{"emptied", empty, false},
                                 {"zeros", zeros, false},
                                 {"line ends", line_ends, false},
                                 {"cut", cut_in_the_rows, true},
                                 {"digits in a row", digits_in_a_row, true},
                                 {"digits in a sum", digits_in_a_sum, true},
                                 {"another case's row", row_of_another_case, true}};

/* Somebody who changes v/journal, once, at a call of the program's. */
typedef struct meddler {
  const change *change;
  bool at_sync; /* as it waits for the rows; else as it begins the files of its result */
  char *left;   /* the journal as it is then; NULL: it was not changed */
  size_t size;
} meddler;

/* A new journal is a temporary file, too; it has no name yet. */
static int meddle(void *ctx, const seam_call *call) {
  meddler *m = ctx;
  const bool now = m->at_sync ? call->number == SYS_fdatasync && strstr(call->name, "v/journal")
                              : call->creates && strstr(call->name, "/.vibrospice-tmp.") != NULL;
  if (m->left || !now || access("v/journal", F_OK)) return 0;
  m->left = read_file("v/journal");
  m->size = strlen(m->left);
  m->change->make(m->left, &m->size);
  FILE *f = fopen("v/journal", "r+");
  if (!f || fwrite(m->left, 1, m->size, f) != m->size || ftruncate(fileno(f), (off_t)m->size))
    m->size = 0;
  if (f) fclose(f);
  return 0;
}

/* One line, and no trace but the journal as the meddler left it. */
static void expect_told(meddler m, const char *words, int line) {
  static const long CALLS[] = {SYS_open, SYS_openat, SYS_fdatasync, -1};
  const seam s = {CALLS, meddle, &m};
  ran r = seam_run(&s, words);
  const char *what = m.change->what;
  expect(r.status == 1 && strstr(r.err, "v/journal: row of case ") &&
             strstr(r.err, " was changed while the study ran") && count_lines(r.err) == 1 &&
             !*r.out,
         line, "%s, %s: %d %s", what, words, r.status, r.err);
  free_ran(&r);
  expect_files("v", "journal ", line);
  FILE *f = fopen("v/journal", "r");
  char *now = vs_alloc(1, m.size + 2);
  const size_t n = f ? fread(now, 1, m.size + 1, f) : 0;
  if (f) fclose(f);
  expect(m.left && n == m.size && !memcmp(now, m.left, n), line, "%s: the journal", what);
  free(now);
  free(m.left);
}

/* Where no head is left, nothing can be gone on with, and the message says what can be done. */
static void expect_gone_on(const change *c, const char *good, int line) {
  ran r = run("study v.yaml -o v --resume --quiet");
  expect(r.status == (c->head ? 0 : 2) && (c->head || strstr(r.err, "--overwrite")), line,
         "%s: %d %s", c->what, r.status, r.err);
  free_ran(&r);
  if (!c->head) RUN_GOOD("study v.yaml -o v --overwrite --quiet");
  char *now = read_file("v/study.csv");
  expect(!strcmp(now, good), line, "%s: %s", c->what, now);
  free(now);
}

static void changed_while_it_ran(void) {
  if (!seam_is_possible()) {
    printf("(left out: no filter of system calls here) ");
    return;
  }
  write_file("v.yaml", "set: {run.until: 20 ms, run.tier: switched}\nvary: {firing.angle: {lin: "
                       "[100 deg, 120 deg], n: 40}}\nreport: [i_peak]\n");
  RUN_GOOD("study v.yaml -o v --quiet");
  char *good = read_file("v/study.csv"), *rows = read_file("v/journal");
  for (size_t k = 0; k < COUNT(CHANGES); k++) {
    static const char *const FORMATS[] = {"csv", "csv.zst", "npy"};
    char words[96];
    remove_tree("v");
    snprintf(words, sizeof words, "study v.yaml -o v --jobs 2 --quiet --format %s",
             FORMATS[k % COUNT(FORMATS)]);
    expect_told((meddler){.change = &CHANGES[k]}, words, __LINE__);
    expect_gone_on(&CHANGES[k], good, __LINE__);
    remove_tree("v");
    mkdir("v", 0777);
    write_file("v/journal", rows);
    expect_told((meddler){.change = &CHANGES[k]}, "merge v -o m --quiet", __LINE__);
    CU_ASSERT_NOT_EQUAL(access("m", F_OK), 0);
  }
  free(good), free(rows);
}

/* A search reads its rows after each generation. */
static void changed_under_a_search(void) {
  if (!seam_is_possible()) return;
  write_file("w.yaml", "set: {run.until: 20 ms, run.tier: switched}\n"
                       "vary: {firing.angle: {lin: [90 deg, 120 deg], n: 4}}\n"
                       "find: {worst: max i_peak}\n");
  for (size_t k = 0; k < COUNT(CHANGES); k++) {
    remove_tree("v");
    expect_told((meddler){.change = &CHANGES[k], .at_sync = true},
                "study w.yaml -o v --jobs 2 --quiet", __LINE__);
  }
}

/* The journal of a study that is done. */
static void emptied_when_done(void) {
  remove_tree("v");
  RUN_GOOD("study v.yaml -o v --quiet");
  write_file("v/journal", "");
  static const char *const WORDS[] = {"study v.yaml -o v", "study v.yaml -o v --resume"};
  for (size_t k = 0; k < COUNT(WORDS); k++) {
    ran r = run("%s", WORDS[k]);
    EXPECT(r.status == 2 && strstr(r.err, "--overwrite") && count_lines(r.err) == 1, "%d %s",
           r.status, r.err);
    free_ran(&r);
  }
  RUN_GOOD("study v.yaml -o v --overwrite --quiet");
}

int main(void) {
  static const vs_test TESTS[] = {
      {"a study to damage", make_study},
      {"each line of the head", each_line_of_the_head},
      {"a head that has moved", a_head_that_has_moved},
      {"no good copy", no_good_copy},
      {"a copy of another study", a_copy_of_another_study},
      {"a block twice", a_block_twice},
      {"versions", versions},
      {"an old journal", an_old_journal},
      {"two programs", two_programs},
      {"failed cases again", failed_cases_again},
      {"words of --again", words_of_again},
      {"changed while it ran", changed_while_it_ran},
      {"changed under a search", changed_under_a_search},
      {"emptied when done", emptied_when_done},
  };
  return program_suite("mended", TESTS, COUNT(TESTS));
}
