/* SPDX-License-Identifier: GPL-3.0-or-later
 * The formats of a study's rows (`--format`): what numpy and zstd read of them is what study.csv
 * has, the bytes do not hang on how the study was run, and every command goes on with each of
 * them. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/compressed.h"
#include "program.h"
#include "study/format.h"

/* On tier switched, so that it is fast: 48 cases, of which some fail at the pole cover. Its axes
 * are numbers with a unit and without, words, and two whose files would have the same name. */
static const char PLAIN[] = "set:\n"
                            "  run: {until: 0.1 s, tier: switched}\n"
                            "  firing: {every: 1, angle: 80 deg}\n"
                            "  events: {a/b: {kind: sag, cycle: 1}, a_b: {kind: sag, cycle: 3}}\n"
                            "vary:\n"
                            "  supply.voltage: {lin: [300 V, 520 V], n: 6}\n"
                            "  load.fraction: [0, 0.25]\n"
                            "  machine.m14: [paper, derived]\n"
                            "  events.a/b.level: [40 %]\n"
                            "  events.a_b.level: [40 %, 80 %]\n"
                            "report: [p_min, i_peak]\n";
/* A rating and a weakest part. */
static const char RATED[] = "set: {circuit.deck: halfwave_paper, run.until: 12 ms}\n"
                            "vary:\n"
                            "  circuit.r1: [1 ohm, 4.7 kohm]\n"
                            "  circuit.thyristor: [latch, TYN1212]\n"
                            "report: [thyristor.v_reverse, v_ak_min]\n";

/* Runs a command of a shell; its output goes to the test's. */
static void holds(const char *command, int line) {
  int status = system(command);
  expect(status == 0, line, "%s: status %d", command, status);
}
#define HOLDS(command) holds(command, __LINE__)

/* The python that has numpy; NULL: none has. Debian's own comes first. */
static const char *numpy(void) {
  static const char *const PYTHONS[] = {"/usr/bin/python3", "python3", NULL};
  static int found = -1;
  char command[128];
  for (bool good = found >= 0; !good;) {
    const char *python = PYTHONS[++found];
    snprintf(command, sizeof command, "%s -c 'import numpy' 2>/dev/null", python ? python : "");
    good = !python || !system(command);
  }
  return PYTHONS[found];
}

/* numpy reads the folder's columns, and finds what study.csv has. */
static void numpy_agrees(const char *folder, int line) {
  char command[512];
  const char *python = numpy();
  if (!python) {
    fprintf(stderr, "no numpy (Debian: python3-numpy): the columns are not read back\n");
    return;
  }
  snprintf(command, sizeof command, "%s " VS_TEST_FOLDER "/study/columns_agree.py %s >agree.out",
           python, folder);
  int status = system(command);
  char *said = read_file("agree.out");
  expect(status == 0, line, "%s: %.600s", folder, said);
  free(said);
}
#define NUMPY_AGREES(folder) numpy_agrees(folder, __LINE__)

/* ---- what is read back ---- */

static void columns(void) {
  write_file("s.yaml", PLAIN);
  EXPECT_EXIT("study s.yaml -o s --quiet", 1);
  EXPECT_EXIT("study s.yaml -o n --quiet --format npy", 1);
  HOLDS("cmp s/study.csv n/study.csv && cmp s/failures.csv n/failures.csv && "
        "cmp s/manifest.json n/manifest.json");
  NUMPY_AGREES("n");
  char *list = read_file("n/columns/columns.json");
  static const char *const SAYS[] = {
      "\"load.fraction.npy\", \"type\": \"<f8\", \"unit\": \"\"}",
      "\"supply.voltage_v.npy\", \"type\": \"<f8\", \"unit\": \"V\"}",
      "\"machine.m14.npy\", \"type\": \"<i4\", \"unit\": \"\", \"words\": [\"paper\", "
      "\"derived\"]}",
      "\"column\": \"events.a/b.level__\", \"file\": \"events.a_b.level__.npy\"",
      "\"column\": \"events.a_b.level__\", \"file\": \"events.a_b.level__.6.npy\""};
  for (size_t k = 0; k < COUNT(SAYS); k++) EXPECT(strstr(list, SAYS[k]), "%s: %s", SAYS[k], list);
  free(list);
  remove_tree("s"), remove_tree("n");
}

/* Words: the parts of an axis, the weakest, warnings. Numbers that are missing. */
static void rated(void) {
  write_file("s.yaml", RATED);
  EXPECT_EXIT("study s.yaml -o n --quiet --format npy", 3);
  NUMPY_AGREES("n");
  char *list = read_file("n/columns/columns.json");
  EXPECT(strstr(list, "\"words\": [\"latch\", \"TYN1212\"]"), "%s", list);
  free(list);
  remove_tree("n");
}

/* Without any row the vectors are empty. */
static void no_rows(void) {
  write_file("s.yaml",
             "set: {run: {until: 0.1 s, tier: switched}, firing: {every: 1, angle: 80 deg}}\n"
             "vary: {supply.voltage: [520 V], load.fraction: [0]}\nreport: [p_min]\n");
  EXPECT_EXIT("study s.yaml -o n --quiet --format npy", 1);
  NUMPY_AGREES("n");
  remove_tree("n");
}

static void packed(void) {
  write_file("s.yaml", PLAIN);
  EXPECT_EXIT("study s.yaml -o s --quiet", 1);
  EXPECT_EXIT("study s.yaml -o z --quiet --format csv.zst", 1);
  EXPECT_FILES("z", "failures.csv journal manifest.json study.csv.zst ");
  if (on_path("zstd")) HOLDS("zstd -qdc z/study.csv.zst | cmp - s/study.csv");
  struct stat plain, small;
  EXPECT(!stat("s/study.csv", &plain) && !stat("z/study.csv.zst", &small) &&
             small.st_size < plain.st_size,
         "%lld bytes of %lld", (long long)small.st_size, (long long)plain.st_size);
  /* who reads study.csv reads it, too */
  ran r = run("compare s z");
  EXPECT(r.status == 0 && strstr(r.out, "0 of the joined rows have another word") &&
             strstr(r.out, "0 in A alone, 0 in B alone"),
         "%s%s", r.out, r.err);
  free_ran(&r);
  if (on_path("gnuplot")) {
    RUN_GOOD("plot s --quiet");
    RUN_GOOD("plot z --quiet");
    HOLDS("cmp s/p_min_m.png z/p_min_m.png");
    write_file("new.yaml", "set: {run.until: 20 ms}\nvary: {load.fraction: [0, 0.5]}\n");
    RUN_GOOD("study new.yaml -o z --overwrite --quiet"); /* removes the pictures by its header */
    EXPECT_FILES("z", "failures.csv journal manifest.json study.csv ");
  }
  remove_tree("s"), remove_tree("z");
}

/* A stream of many frames and of several buffers' lengths comes back whole, byte by byte too. */
static void streams(void) {
  vs_error err = {0};
  for (int part = 0; part < 2; part++) {
    FILE *file = fopen("x.zst", part ? "a" : "w"), *to = vs_compressed_write(file, "x.zst");
    for (int k = 0; k < 300000; k++) fprintf(to, "%d\n", (int)((unsigned)k * 2654435761u));
    EXPECT(!vs_compressed_end(to, file, "x.zst", &err), "%s", err.text);
    fclose(file);
  }
  FILE *from = vs_compressed_read(fopen("x.zst", "r"), "x.zst");
  long rows = 0, wrong = 0;
  for (int number; fscanf(from, "%d", &number) == 1; rows++)
    wrong += number != (int)((unsigned)(rows % 300000) * 2654435761u);
  EXPECT(rows == 600000 && !wrong && feof(from) && !ferror(from), "%ld rows, %ld wrong", rows,
         wrong);
  fclose(from);
  unlink("x.zst");
}

/* Writes the bytes to study.csv.zst, and expects what `compare` says of that. */
static void refuses(const char *bytes, size_t size, const char *says, int line) {
  FILE *f = fopen("z/study.csv.zst", "w");
  EXPECT(fwrite(bytes, 1, size, f) == size && !fclose(f), "it cannot be written");
  ran r = run("compare z z");
  expect(r.status == 2 && strstr(r.err, says), line, "%d %s", r.status, r.err);
  free_ran(&r);
}

/* A file that is torn, damaged or no zstd at all is refused, whatever of it could be read. */
static void damaged(void) {
  char good[8192];
  write_file("s.yaml", PLAIN);
  EXPECT_EXIT("study s.yaml -o z --quiet --format csv.zst", 1);
  FILE *f = fopen("z/study.csv.zst", "r");
  const size_t n = fread(good, 1, sizeof good, f);
  EXPECT(n > 100 && n < sizeof good, "%zu bytes", n);
  fclose(f);
  refuses(good, 0, "empty", __LINE__);
  refuses(good, 3, "torn or damaged", __LINE__);
  refuses(good, n / 2, "torn or damaged", __LINE__);
  refuses(good, n - 1, "torn or damaged", __LINE__);
  good[n - 1] ^= 1; /* the checksum of the content */
  refuses(good, n, "torn or damaged", __LINE__);
  good[0] ^= 1; /* what tells a frame */
  refuses(good, n, "torn or damaged", __LINE__);
  remove_tree("z");
}

/* ---- the same bytes ---- */

#define SAME(a, b)                                                                                 \
  HOLDS("cmp " a "/study.csv.zst " b "/study.csv.zst"), NUMPY_AGREES(b "n"),                       \
      HOLDS("diff -r " a "n/columns " b "n/columns")

/* Whatever the number of workers, in shards, and gone on with; a folder aN has the columns. */
static void same_bytes(void) {
  if (is_for_memory_alone()) return;
  write_file("s.yaml", PLAIN);
  EXPECT_EXIT("study s.yaml -o a --quiet --jobs 1 --format csv.zst", 1);
  EXPECT_EXIT("study s.yaml -o an --quiet --jobs 1 --format npy", 1);
  EXPECT_EXIT("study s.yaml -o b --quiet --jobs 2 --format csv.zst", 1);
  EXPECT_EXIT("study s.yaml -o bn --quiet --jobs 2 --format npy", 1);
  SAME("a", "b");
  for (int k = 1; k <= 3; k++) { /* a shard's own format is no matter */
    static const char *const FORMATS[] = {"csv", "csv.zst", "npy"};
    ran r = run("study s.yaml -o parts/%d --shard %d/3 --quiet --format %s", k, k, FORMATS[k - 1]);
    EXPECT(r.status == 0 || r.status == 1, "%s", r.err);
    free_ran(&r);
  }
  NUMPY_AGREES("parts/3");
  EXPECT_EXIT("merge parts -o m --quiet --format csv.zst", 1);
  EXPECT_EXIT("merge parts -o mn --quiet --format npy", 1);
  SAME("a", "m");
  EXPECT_FILES("m", "failures.csv manifest.json study.csv.zst ");
  /* the same study again in other formats: each time only the last one's files are left */
  EXPECT_EXIT("study s.yaml -o b --resume --quiet --format npy", 1);
  EXPECT_FILES("b", "columns failures.csv journal manifest.json study.csv ");
  HOLDS("diff -r an/columns b/columns");
  EXPECT_EXIT("study s.yaml -o b --resume --quiet", 1);
  EXPECT_FILES("b", "failures.csv journal manifest.json study.csv ");
  EXPECT_EXIT("merge b --quiet --format csv.zst", 1);
  EXPECT_FILES("b", "failures.csv journal manifest.json study.csv.zst ");
  HOLDS("cmp a/study.csv.zst b/study.csv.zst");
  static const char *const MADE[] = {"a", "an", "b", "bn", "m", "mn", "parts"};
  for (size_t k = 0; k < COUNT(MADE); k++) remove_tree(MADE[k]);
}

/* True if what the killed process left of columns is whole: each file there is as it ends up. */
static bool is_whole(void) {
  return !system("for f in k/columns/*; do test ! -e \"$f\" || cmp \"$f\" n/columns/${f##*/} || "
                 "exit 1; done; test ! -e k/columns/columns.json || diff -r n/columns k/columns");
}

/* Killed at any time, and gone on with. The delays are a matter of chance; what is wanted is not.
 */
static void killed(void) {
  const char *const words[] = {"study",    "s.yaml",   "-o",  "k", "--quiet",
                               "--resume", "--format", "npy", NULL};
  write_file("s.yaml", PLAIN);
  EXPECT_EXIT("study s.yaml -o n --quiet --format npy", 1);
  for (int k = 1; k <= 8; k++) {
    pid_t child = spawn(words);
    nanosleep(&(struct timespec){0, k * 15000000L}, NULL);
    kill(child, k % 3 ? SIGKILL : SIGTERM);
    ran r = collect(child);
    EXPECT(is_whole(), "killed after %d ms", 15 * k);
    free_ran(&r);
  }
  EXPECT_EXIT("study s.yaml -o k --quiet --resume --format npy", 1);
  HOLDS("cmp n/study.csv k/study.csv && diff -r n/columns k/columns");
  char *files = listing("k");
  EXPECT(!strstr(files, "tmp"), "%s", files);
  free(files);
  remove_tree("n"), remove_tree("k");
}

/* ---- what is in the way ---- */

static void refused(void) {
  write_file("s.yaml", PLAIN);
  refuse("study s.yaml -o s --format parquet", "no format", "",
         (const char *const[]){"--format parquet", "csv, csv.zst, npy"}, __LINE__);
  refuse("merge s --format zst", "no format", "", (const char *const[]){"--format zst", "npy"},
         __LINE__);
  refuse("study s.yaml --format npy", "no folder", "", (const char *const[]){"--format", "-o DIR"},
         __LINE__);
  /* the words of the option are the table's */
  char words[128] = "";
  for (const vs_format *f = vs_format_all; f->name; f++)
    snprintf(words + strlen(words), sizeof words - strlen(words), "%s%s", *words ? "|" : "",
             f->name);
  CU_ASSERT_STRING_EQUAL(words, VS_FORMAT_WORDS);
}

/* A link where the folder belongs is not followed; a folder where a file belongs stops all. */
static void in_the_way(void) {
  write_file("s.yaml", PLAIN);
  mkdir("s", 0777), mkdir("victim", 0777);
  CU_ASSERT_EQUAL(symlink("../victim", "s/columns"), 0);
  refuse("study s.yaml -o s --format npy", "a link", "",
         (const char *const[]){"s/columns", "folder"}, __LINE__);
  EXPECT_EXIT("study s.yaml -o s --quiet", 1);
  refuse("merge s --format npy", "a link", "", (const char *const[]){"s/columns", "folder"},
         __LINE__);
  EXPECT_FILES("victim", "");
  unlink("s/columns");
  mkdir("s/columns", 0777), mkdir("s/columns/p_min_m.npy", 0777);
  write_file("s/columns/mine.npy", "mine");
  EXPECT_EXIT("study s.yaml -o s --quiet --resume --format csv.zst", 1);
  EXPECT_EXIT("study s.yaml -o s --quiet --resume --format npy", 2);
  EXPECT_FILES("s/columns", "mine.npy p_min_m.npy ");
  EXPECT_FILES("s", "columns failures.csv journal manifest.json study.csv.zst ");
  rmdir("s/columns/p_min_m.npy");
  EXPECT_EXIT("study s.yaml -o s --quiet --resume --format npy", 1);
  unlink("s/columns/mine.npy");
  NUMPY_AGREES("s");
  remove_tree("s"), remove_tree("victim");
}

/* Of an older study no columns stay, whoever tells which they were; the user's own do. */
static void older(void) {
  write_file("old.yaml", PLAIN);
  write_file("new.yaml", "set: {run: {until: 20 ms, tier: switched}}\n"
                         "vary: {firing.angle: [100 deg, 110 deg]}\nreport: [i_peak]\n");
  for (int k = 0; k < 3; k++) {
    EXPECT_EXIT("study old.yaml -o s --quiet --format npy", 1);
    write_file("s/columns/mine.npy", "mine");
    if (k == 1) unlink("s/study.csv");
    if (k == 2) unlink("s/journal");
    EXPECT_EXIT("study new.yaml -o s --quiet", 2);
    RUN_GOOD("study new.yaml -o s --quiet --overwrite");
    EXPECT_FILES("s", "columns failures.csv journal manifest.json study.csv ");
    EXPECT_FILES("s/columns", "mine.npy ");
    remove_tree("s");
  }
  EXPECT_EXIT("study old.yaml -o s --quiet --format npy", 1);
  RUN_GOOD("study new.yaml -o n --quiet");
  EXPECT_EXIT("merge n -o s --quiet", 2);
  RUN_GOOD("merge n -o s --quiet --overwrite --format csv.zst");
  EXPECT_FILES("s", "failures.csv manifest.json study.csv.zst ");
  remove_tree("s"), remove_tree("n");
  /* what is left of columns alone is a result, too */
  EXPECT_EXIT("study old.yaml -o s --quiet --format npy", 1);
  unlink("s/study.csv"), unlink("s/failures.csv"), unlink("s/manifest.json"), unlink("s/journal");
  refuse("study new.yaml -o s --quiet", "columns alone",
         "s/columns/columns.json: ", (const char *const[]){"--overwrite", NULL}, __LINE__);
  remove_tree("s");
}

int main(void) {
  static const vs_test TESTS[] = {
      {"columns", columns},       {"rated", rated},     {"no rows", no_rows},
      {"packed", packed},         {"streams", streams}, {"damaged", damaged},
      {"same bytes", same_bytes}, {"killed", killed},   {"refused", refused},
      {"in the way", in_the_way}, {"older", older}};
  return program_suite("format", TESTS, COUNT(TESTS));
}
