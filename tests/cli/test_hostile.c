/* SPDX-License-Identifier: GPL-3.0-or-later
 * Input that is made to do harm, or might as well be: bytes that hang a parser, journals that lie,
 * links where files are wanted, an environment that is not ours, signals at any time. */
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
#include "base/hash.h"
#include "netlist/deck.h"
#include "netlist/netlist.h"
#include "study/workers/journal.h"

/* AT_WORK_S: by then a command that has begun is in the midst of its work. */
#ifdef __SANITIZE_ADDRESS__
static const double SLOWER = 10, AT_WORK_S = 1;
#else
static const double SLOWER = 1, AT_WORK_S = 0.4;
#endif

static double children_cpu_s(void) {
  struct rusage u;
  getrusage(RUSAGE_CHILDREN, &u);
  return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

#define REFUSED(words, at, what) refuse(words, words, at, (const char *[]){what, NULL}, __LINE__)

/* ---- bytes ---- */

/* The byte 0xc3 begins a character of two, and '(' does not go on with it. */
static void no_utf8(void) {
  write_file("b.yaml", "%\xc3(");
  REFUSED("run b.yaml", "b.yaml:1:2: ", "0xc3 is not UTF8");
  write_file("b.yaml", "run:\n  until: \xc3\xa9\xff s\n");
  REFUSED("run b.yaml", "b.yaml:2:11: ", "0xff is not UTF8");
  write_file("b.yaml", "run: {until: 1 s} # cut off: \xe2\x82");
  REFUSED("study b.yaml -o out", "b.yaml:1:30: ", "0xe2 is not UTF8");
  REFUSED("run paper --set run.until=%\xc3(", "--set run.until=%\\xc3(: ", "0xc3 is not UTF8");
  CU_ASSERT_EQUAL(mkdir("d", 0777), 0);
  write_file("d/study.csv", "case\n");
  write_file("d/manifest.json", "%\xed\xa0\x80"); /* half of a surrogate pair */
  REFUSED("plot d", "d/manifest.json:1:2: ", "0xed is not UTF8");
  remove_tree("d");
  unlink("b.yaml");
}

/* All texts of one and two of these; in a child, as one that hangs shall end with it. */
static void short_texts(void) {
  static const char *const PARTS[] = {"%",
                                      "&",
                                      "*",
                                      "!",
                                      "|",
                                      ">",
                                      "'",
                                      "\"",
                                      "{",
                                      "}",
                                      "[",
                                      "]",
                                      ",",
                                      "#",
                                      ":",
                                      "-",
                                      "?",
                                      "@",
                                      "`",
                                      "\\",
                                      "\n",
                                      "\r",
                                      "\t",
                                      " ",
                                      "a",
                                      "0",
                                      "~",
                                      "<<",
                                      "---",
                                      "...",
                                      "\x01",
                                      "\x7f",
                                      "\xc2\x85",
                                      "\xe2\x80\xa8",
                                      "\xef\xbb\xbf",
                                      "\xc3",
                                      "\x80",
                                      "\xff",
                                      "(",
                                      "=",
                                      "a: ",
                                      "- ",
                                      "%YAML 1.1"};
  fflush(NULL);
  pid_t child = fork();
  if (child == 0) {
    alarm(20);
    for (size_t a = 0; a < COUNT(PARTS); a++)
      for (size_t b = 0; b < COUNT(PARTS); b++) {
        vs_tree tree = {.root = vs_alloc(1, sizeof(vs_node))};
        vs_error err = {0};
        char text[64];
        tree.root->kind = VS_NODE_MAP;
        snprintf(text, sizeof text, "k=%s%s", PARTS[a], PARTS[b]);
        vs_tree_set(&tree, text, &err);
        vs_tree_free(&tree);
      }
    _exit(0);
  }
  int how = 0;
  waitpid(child, &how, 0);
  EXPECT(how == 0, "ended by %d", WTERMSIG(how));
}

static void write_many(const char *path, const char *begin, const char *format, int count,
                       const char *end) {
  vs_text text = {0};
  vs_text_add(&text, "%s", begin);
  for (int k = 0; k < count; k++) {
    char line[64];
    snprintf(line, sizeof line, format, k);
    vs_text_add(&text, "%s", line);
  }
  vs_text_add(&text, "%s", end);
  write_file(path, text.text);
  vs_text_free(&text);
}

static double cpu_of(const char *words, int status, int line) {
  double before = children_cpu_s();
  ran r = run("%s", words);
  double took = children_cpu_s() - before;
  expect(r.status == status, line, "%s: exit status %d: %.200s", words, r.status, r.err);
  free_ran(&r);
  return took;
}

/* A file of many lines, as write_many writes it. */
typedef struct many {
  const char *path, *begin, *format;
  int count;
  const char *end;
} many;

/* Writes the file and runs the command, which must not take a time that grows with the square of
 * the count. Less than a second does not. On a slow or a busy machine a quarter of the lines tells:
 * these take a quarter of the time, or else a sixteenth. */
static void grows_evenly(many m, const char *words, int status, int line) {
  write_many(m.path, m.begin, m.format, m.count, m.end);
  const double took = cpu_of(words, status, line);
  if (took < SLOWER) return;
  write_many(m.path, m.begin, m.format, m.count / 4, m.end);
  const double quarter = cpu_of(words, status, line);
  expect(took < 8 * quarter, line, "%s: %.2f s, and %.2f s for a quarter", words, took, quarter);
  write_many(m.path, m.begin, m.format, m.count, m.end);
}

/* Work that grows with the square of their number took 4 s for 10,000 keys, and would have taken 36
 * times that for 60,000. Now it is 0.2 s of processor time. */
static void many_keys(void) {
  static const char CHECK[] = "check m.yaml";
  grows_evenly((many){"m.yaml", "", "key%d: 1\n", 60000, ""}, CHECK, 2, __LINE__);
  grows_evenly((many){"m.yaml", "", "key%d: 1\n", 10000, "key77: 1\n"}, CHECK, 2, __LINE__);
  REFUSED("run m.yaml", "m.yaml:10001:1: ", "duplicate key");
  /* a minute before */
  grows_evenly((many){"m.yaml", "", "k%d: &a v\n", 30000, ""}, CHECK, 2, __LINE__);
  REFUSED("run m.yaml", "m.yaml:1001:1: ", "anchors");
  write_many("m.yaml", "measured: |\n", "\n", 60000, "");
  REFUSED("run m.yaml", "m.yaml:", "empty lines");
  unlink("m.yaml");
}

/* 5 s before, and 0.1 s now. */
static void many_continued_lines(void) {
  char *deck = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  vs_text begin = {0};
  vs_text_add(&begin, "%s\nRlong a b\n", deck);
  grows_evenly((many){"m.cir", begin.text, "+ \n", 60000, "+ 1Meg\n"}, "check m.cir", 0, __LINE__);
  begin.length = 0;
  vs_text_add(&begin, "%s\nVlong nowhere 0 pwl(\n", deck);
  vs_text_add(&begin, "%s", "");
  write_many("m.cir", begin.text, "+ %d 0\n", 60000, "+ )\nRlong nowhere 0 1k\n");
  vs_deck *d = vs_alloc(1, sizeof *d);
  vs_error err = {0};
  clock_t before = clock();
  EXPECT(vs_netlist_read("m.cir", d, &err) == VS_OK, "%s", err.text);
  double took = (double)(clock() - before) / CLOCKS_PER_SEC;
  EXPECT(took < SLOWER, "%.2f s", took); /* 100 s before, 0.05 s now */
  vs_deck_free(d);
  free(d);
  vs_text_free(&begin);
  free(deck);
  unlink("m.cir");
}

/* ---- signals ---- */

/* Each command waits for ever for a file that nobody writes, or is at long work. */
static void signals_end_all(void) {
  static const char *const COMMANDS[] = {"run pipe.yaml",
                                         "modes pipe.yaml",
                                         "export pipe.yaml -o x.cir",
                                         "plot run --no-jail",
                                         "merge parts --no-jail",
                                         "study pipe.yaml -o out",
                                         "validate",
                                         "run paper --set run.until=9e5s --set run.sample=1ms",
                                         "check paper --set circuit.deck=big.cir"};
  CU_ASSERT_EQUAL(mkfifo("pipe.yaml", 0600) || mkdir("run", 0777) || mkdir("parts", 0777), 0);
  CU_ASSERT_EQUAL(mkfifo("run/run.csv", 0600) || mkfifo("parts/journal", 0600), 0);
  char *deck = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  vs_text begin = {0}; /* of so many parameters ngspice makes what takes it minutes */
  vs_text_add(&begin, "%s\n.param q=1\n", deck);
  write_many("big.cir", begin.text, "+ q%d=1\n", 30000, "");
  char *files = listing(".");
  for (size_t k = 0; k < COUNT(COMMANDS); k++)
    for (int s = 0; s < 2; s++) {
      char words[128];
      const char *argv[MOST_WORDS];
      snprintf(words, sizeof words, "%s", COMMANDS[k]);
      split(words, argv);
      pid_t child = spawn_ready(argv);
      wait_seconds(AT_WORK_S);
      double before = vs_budget_clock_s();
      kill(child, s ? SIGINT : SIGTERM);
      ran r = collect(child);
      double took = vs_budget_clock_s() - before;
      EXPECT(r.status == 75, "%s: exit status %d: %s", COMMANDS[k], r.status, r.err);
      EXPECT(took < 2 * SLOWER, "%s: %.1f s", COMMANDS[k], took);
      EXPECT(strstr(r.err, "stopped by a signal"), "%s: %s", COMMANDS[k], r.err);
      free_ran(&r);
    }
  EXPECT_FILES(".", files);
  free(files);
  free(deck);
  vs_text_free(&begin);
  unlink("pipe.yaml"), unlink("big.cir");
  remove_tree("run"), remove_tree("parts");
}

/* ---- journals ---- */

static void add_line(vs_text *journal, const char *line) {
  vs_text_add(journal, "%08x %s\n", vs_hash_crc32(line, strlen(line)), line);
}

static void add_head(vs_text *journal, const char *identity, const char *counts) {
  char line[128];
  add_line(journal, "h vibrospice journal 1");
  snprintf(line, sizeof line, "h identity=%s", identity);
  add_line(journal, line);
  add_line(journal, "h columns=case,id,x,margin_least,weakest,status");
  add_line(journal, "h failures=case,id,x,why");
  add_line(journal, "h manifest_begin={\"study\": \"x\"");
  add_line(journal, "h manifest_end=");
  snprintf(line, sizeof line, "h counts=%s", counts);
  add_line(journal, line);
}

static void write_journal(const char *folder, vs_text *journal) {
  char path[64];
  mkdir(folder, 0777);
  snprintf(path, sizeof path, "%s/journal", folder);
  write_file(path, journal->text);
  journal->length = 0;
}

static void journals_that_lie(void) {
  static const char *const COUNTS[] = {"18446744073709551615 1 1",
                                       "18446744073709551614 1 18446744073709551615",
                                       "100000001 1 1",
                                       "2000000000 1 1",
                                       "-1 1 1",
                                       "4 2 1",
                                       "4 0 1",
                                       "4 1 0",
                                       "4 1 10001",
                                       "4 1 1 1",
                                       "4 1",
                                       "x 1 1"};
  vs_text journal = {0};
  for (size_t k = 0; k < COUNT(COUNTS); k++) {
    add_head(&journal, "abc", COUNTS[k]);
    add_line(&journal, "= 0,id,1,,,0");
    write_journal("j", &journal);
    REFUSED("merge j", "j/journal:1:1: ", "is no journal of a study");
  }
  add_head(&journal, "abc", "4 1 2");
  add_line(&journal, "= 0,id,1,,,0");
  add_head(&journal, "abc", "4 2 2"); /* what follows would be the other shard's */
  add_line(&journal, "= 1,id,1,,,0");
  write_journal("j", &journal);
  REFUSED("merge j", "j/journal:", "has two heads");
  add_head(&journal, "abc", "2 1 1");
  add_line(&journal, "= 0,id,1,,,0");
  add_line(&journal, "h counts=3 1 1");
  add_line(&journal, "= 1,id,1,,,0");
  write_journal("j", &journal);
  REFUSED("merge j", "j/journal:", "has two heads");
  /* one that is well, and a row too far ahead for its length: 800 MB for 300 bytes */
  add_head(&journal, "abc", "100000000 1 1");
  add_line(&journal, "= 0,id,1,,,0");
  add_line(&journal, "= 99999999,id,1,,,0");
  write_journal("j", &journal);
  REFUSED("merge j", "j/journal:9:12: ", "its case is none of this journal's");
  vs_journal j;
  vs_error err = {0};
  CU_ASSERT_EQUAL(vs_journal_open(&j, "j", false, &err), VS_INPUT);
  EXPECT(j.room < 2000 && j.done == 1, "%llu %llu", (unsigned long long)j.room,
         (unsigned long long)j.done);
  vs_journal_close(&j);
  vs_text_free(&journal);
  remove_tree("j");
}

/* ---- links ---- */

static void link_to_victim(const char *folder, const char *const *names) {
  char path[128];
  mkdir(folder, 0777);
  for (; *names; names++) {
    snprintf(path, sizeof path, "%s/%s", folder, *names);
    unlink(path);
    CU_ASSERT_EQUAL(symlink("../../victim", path), 0);
  }
}

static void victim_lives(const char *what, int line) {
  char *text = read_file("../victim");
  expect(!strcmp(text, "precious"), line, "%s: the victim holds %.60s", what, text);
  free(text);
}

/* No file is written through a link that stands where it belongs. */
static void links(void) {
  static const char *const RUN[] = {"run.csv", "events.csv", "summary.json", NULL};
  static const char *const STUDY[] = {"study.csv", "failures.csv", "manifest.json", "journal",
                                      NULL};
  static const char *const MODES[] = {"modes.csv", "A.csv", "B.csv", "C.csv", "D.csv", NULL};
  static const char *const PLOTS[] = {"motion_run.png",
                                      "motion_run.svg",
                                      "motion_100ms.png",
                                      "motion_100ms.svg",
                                      "pulse_50ms.png",
                                      "pulse_50ms.svg",
                                      "report.html",
                                      "motion_run.tmp.png",
                                      "motion_run.tmp.svg",
                                      "motion_100ms.tmp.png",
                                      NULL};
  write_file("../victim", "precious");
  write_file("s.yaml", "set: {run.until: 20 ms}\nvary: {firing.angle: [90 deg, 100 deg]}\n");
  link_to_victim("run", RUN);
  RUN_GOOD("run paper --tier switched --set run.until=60ms -o run --quiet");
  victim_lives("run", __LINE__);
  link_to_victim("study", STUDY);
  RUN_GOOD("study s.yaml -o study --quiet --overwrite");
  victim_lives("study", __LINE__);
  link_to_victim("study", (const char *[]){"study.csv", "manifest.json", NULL});
  RUN_GOOD("study s.yaml -o study --quiet --resume");
  victim_lives("study --resume", __LINE__);
  link_to_victim("study", (const char *[]){"study.csv", "manifest.json", NULL});
  RUN_GOOD("merge study --quiet --overwrite");
  victim_lives("merge", __LINE__);
  link_to_victim("modes", MODES);
  run_good("modes paper -o modes", __LINE__);
  victim_lives("modes", __LINE__);
  link_to_victim("export", (const char *[]){"x.cir", NULL});
  run_good("export paper -o export/x.cir", __LINE__);
  victim_lives("export", __LINE__);
  if (on_path("gnuplot")) {
    link_to_victim("run", PLOTS);
    RUN_GOOD("plot run --quiet");
    victim_lives("plot", __LINE__);
    link_to_victim("study", PLOTS);
    RUN_GOOD("plot study --quiet");
    victim_lives("plot of a study", __LINE__);
    link_to_victim("run", (const char *[]){"x.svg", "x.tmp.svg", NULL});
    RUN_GOOD("plot run --quiet -o run/x.svg");
    victim_lives("plot -o", __LINE__);
    struct stat s;
    EXPECT(!lstat("run/x.svg", &s) && S_ISREG(s.st_mode) && s.st_size > 1000, "no picture");
  }
  remove_tree("run"), remove_tree("study"), remove_tree("modes"), remove_tree("export");
  unlink("s.yaml"), unlink("../victim");
}

/* ---- the environment ---- */

static void foreign_spinit(void) {
  char here[VS_PATH_SIZE], folder[VS_PATH_SIZE + 32];
  CU_ASSERT_PTR_NOT_NULL(getcwd(here, sizeof here));
  CU_ASSERT_EQUAL(mkdir("ng", 0777) || mkdir("ng/scripts", 0777), 0);
  snprintf(folder, sizeof folder, "shell touch %s/ng/ran\n", here);
  write_file("ng/scripts/spinit", folder);
  snprintf(folder, sizeof folder, "%s/ng", here);
  setenv("SPICE_LIB_DIR", folder, 1);
  snprintf(folder, sizeof folder, "%s/ng/scripts", here);
  setenv("SPICE_SCRIPTS", folder, 1);
  /* "core" is a code model, which the packaged spinit loads */
  RUN_GOOD("run paper --set circuit.deck=halfwave_paper --set run.until=2ms --quiet");
  unsetenv("SPICE_LIB_DIR"), unsetenv("SPICE_SCRIPTS");
  EXPECT(access("ng/ran", F_OK), "a foreign spinit was run");
  remove_tree("ng");
}

/* A run does without $TMPDIR, as ngspice begins in a folder that comes with the program. Nothing
 * stays there, nor when the reader of a pipe has gone. */
static void temporary_folder(void) {
  const char *before = getenv("TMPDIR");
  char here[VS_PATH_SIZE], *kept = before ? vs_copy(before) : NULL, command[VS_PATH_SIZE + 256];
  CU_ASSERT_PTR_NOT_NULL(getcwd(here, sizeof here));
  strncat(here, "/tmp", sizeof here - strlen(here) - 1);
  setenv("TMPDIR", here, 1);
  RUN_GOOD("run paper --tier circuit --set run.until=2ms --quiet");
  CU_ASSERT_EQUAL(mkdir("tmp", 0777), 0);
  RUN_GOOD("run paper --tier circuit --set run.until=2ms --quiet");
  EXPECT_FILES("tmp", "");
  write_file("s.yaml",
             "set: {run.until: 1 ms}\nvary: {firing.angle: {lin: [90 deg, 100 deg], n: 200}}\n");
  snprintf(command, sizeof command, "%s study s.yaml --quiet 2>../stderr | true", VS_PROGRAM);
  EXPECT(system(command) == 0, "%s", command);
  EXPECT_FILES("tmp", "");
  if (kept)
    setenv("TMPDIR", kept, 1);
  else
    unsetenv("TMPDIR");
  free(kept);
  unlink("s.yaml");
  remove_tree("tmp");
}

/* ---- what stays of a process that was killed ---- */

/* How many of the folder's temporary files are not in that listing of it. */
static int temporaries_besides(const char *before, const char *folder) {
  char *names = listing(folder), *rest = names;
  int n = 0;
  for (char *name; (name = strsep(&rest, " "));)
    n += !strncmp(name, ".vibrospice-tmp.", 16) && !strstr(before, name);
  free(names);
  return n;
}

static int temporaries(const char *folder) {
  return temporaries_besides("", folder);
}

/* Begins a run and waits until it has begun its files: run.csv, peaks.csv, events.csv,
 * summary.json. */
static pid_t start_long_run(const char *folder) {
  char words[128];
  snprintf(words, sizeof words,
           "run paper --set run.until=9e5s --set run.sample=1ms --set limits.csv=1e12 -o %s",
           folder);
  char *before = listing(folder);
  pid_t child = begin(words);
  WAIT_UNTIL(temporaries_besides(before, folder) == 4);
  free(before);
  return child;
}

static void after_kill(void) {
  pid_t dead = start_long_run("k");
  kill(dead, SIGKILL);
  ran r = collect(dead);
  free_ran(&r);
  EXPECT(temporaries("k") == 4, "%d", temporaries("k"));
  write_file("k/run.csv.backup", "mine");
  write_file("k/.vibrospice-tmp.notes.txt", "mine, too");
  pid_t alive = start_long_run("k");
  EXPECT(temporaries("k") == 5, "%d: the dead one's are to go", temporaries("k"));
  RUN_GOOD("run paper --tier switched --set run.until=20ms -o k --quiet");
  EXPECT(temporaries("k") == 5, "%d: the live one's are to stay", temporaries("k"));
  kill(alive, SIGTERM);
  r = collect(alive);
  EXPECT(r.status == 75 && strstr(r.err, "run.partial.csv"), "%d %s", r.status, r.err);
  free_ran(&r);
  RUN_GOOD("run paper --tier switched --set run.until=20ms -o k --quiet");
  EXPECT_FILES("k", ".vibrospice-tmp.notes.txt events.csv run.csv run.csv.backup summary.json ");
  remove_tree("k");
}

/* ---- work that is there ---- */

static void same_file(const char *path, const char *text, int line) {
  char *now = read_file(path);
  expect(!strcmp(now, text), line, "%s has changed", path);
  free(now);
}

static void a_second_study(void) {
  write_file("a.yaml", "set: {run.until: 20 ms}\nvary: {firing.angle: [90 deg, 100 deg]}\n");
  write_file("b.yaml", "set: {run.until: 20 ms}\nvary: {firing.angle: [95 deg]}\n");
  RUN_GOOD("study a.yaml -o s --quiet");
  char *csv = read_file("s/study.csv"), *journal = read_file("s/journal"), *files = listing("s");
  REFUSED("study b.yaml -o s --quiet", "s/manifest.json: ", "--overwrite");
  REFUSED("study a.yaml -o s", "s/manifest.json: ", "--resume");
  REFUSED("study b.yaml -o s --resume", "s/journal:1:1: ", "another study");
  REFUSED("study b.yaml -o s --resume --overwrite", "--resume", "one of them");
  RUN_GOOD("study a.yaml -o s --resume --quiet");
  same_file("s/study.csv", csv, __LINE__);
  same_file("s/journal", journal, __LINE__);
  EXPECT_FILES("s", files);
  RUN_GOOD("study b.yaml -o s --overwrite --quiet");
  char *other = read_file("s/study.csv");
  EXPECT(strstr(other, ",95,") && !strstr(other, ",90,"), "%s", other);
  free(other);
  CU_ASSERT_EQUAL(unlink("s/journal"), 0); /* as merge leaves it */
  REFUSED("study a.yaml -o s", "s/manifest.json: ", "without a journal");
  REFUSED("study a.yaml -o s --resume", "s/manifest.json: ", "without a journal");
  RUN_GOOD("study a.yaml -o s --overwrite --quiet");
  same_file("s/study.csv", csv, __LINE__);
  RUN_GOOD("study b.yaml -o b --quiet");
  CU_ASSERT_EQUAL(unlink("b/journal"), 0);
  REFUSED("merge s -o b", "b/manifest.json: ", "--overwrite");
  RUN_GOOD("merge s -o b --overwrite --quiet");
  RUN_GOOD("merge s -o b --quiet"); /* its own */
  same_file("b/study.csv", csv, __LINE__);
  CU_ASSERT_EQUAL(symlink("../b", "s/runs"), 0);
  REFUSED("study a.yaml -o s --overwrite --keep runs", "s/runs: ", "link");
  remove_tree("b");
  free(csv), free(journal), free(files);
  remove_tree("s");
  unlink("a.yaml"), unlink("b.yaml");
}

static void a_second_run(void) {
  static const char WORDS[] = "run paper --tier switched --set run.until=20ms -o r";
  ran r = run("%s", WORDS);
  EXPECT(r.status == 0 && !*r.err, "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("%s", WORDS);
  EXPECT(r.status == 0 &&
             strstr(r.err, "replaced in r, of an older run: run.csv, events.csv, summary.json"),
         "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("%s --set machine.trough_mass=0.2kg --set actuator.gap=0.6mm", WORDS);
  EXPECT(r.status == 1 && count_lines(r.err) == 1 && strstr(r.err, "in the place of run.csv, "),
         "%d %s", r.status, r.err);
  free_ran(&r);
  RUN_GOOD("run paper --tier switched --set run.until=20ms -o r --quiet");
  r = run("%s --quiet", WORDS);
  EXPECT(r.status == 0 && !*r.err, "%d %s", r.status, r.err);
  free_ran(&r);
  remove_tree("r");
}

/* A folder where a file of the result belongs is seen before any other file is replaced. */
static void a_folder_in_the_way(void) {
  static const char *const RUN[] = {"run.csv", "events.csv", "summary.json"};
  static const char *const STUDY[] = {"study.csv", "failures.csv", "manifest.json"};
  char path[64];
  for (size_t k = 0; k < COUNT(RUN); k++) {
    RUN_GOOD("run paper --tier switched --set run.until=20ms -o r --quiet");
    char *was[COUNT(RUN)];
    for (size_t n = 0; n < COUNT(RUN); n++) {
      snprintf(path, sizeof path, "r/%s", RUN[n]);
      was[n] = read_file(path);
      if (n == k) CU_ASSERT_EQUAL(unlink(path) || mkdir(path, 0777), 0);
    }
    char at[80];
    snprintf(path, sizeof path, "r/%s", RUN[k]);
    snprintf(at, sizeof at, "%s: ", path);
    REFUSED("run paper --tier switched --set run.until=30ms -o r", at, "cannot be written");
    for (size_t n = 0; n < COUNT(RUN); n++) {
      snprintf(path, sizeof path, "r/%s", RUN[n]);
      if (n != k) same_file(path, was[n], __LINE__);
      free(was[n]);
    }
    remove_tree("r");
  }
  write_file("a.yaml", "set: {run.until: 20 ms}\nvary: {firing.angle: [90 deg, 100 deg]}\n");
  RUN_GOOD("study a.yaml -o s --quiet");
  for (size_t k = 0; k < COUNT(STUDY); k++) {
    mkdir("d", 0777);
    snprintf(path, sizeof path, "d/%s", STUDY[k]);
    mkdir(path, 0777);
    ran r = run("merge s -o d --overwrite --quiet");
    EXPECT(r.status == 2 && strstr(r.err, "cannot be written"), "%d %s", r.status, r.err);
    free_ran(&r);
    snprintf(path, sizeof path, "%s ", STUDY[k]);
    EXPECT_FILES("d", path);
    remove_tree("d");
  }
  remove_tree("s");
  unlink("a.yaml");
}

int main(void) {
  static const vs_test TESTS[] = {
      {"bytes that are no UTF-8", no_utf8},
      {"short texts", short_texts},
      {"60,000 keys", many_keys},
      {"60,000 lines that go on", many_continued_lines},
      {"signals end every command", signals_end_all},
      {"journals that lie", journals_that_lie},
      {"links", links},
      {"a foreign spinit", foreign_spinit},
      {"TMPDIR, and a reader that goes", temporary_folder},
      {"after kill -9", after_kill},
      {"a second study in a folder", a_second_study},
      {"a second run in a folder", a_second_run},
      {"a folder in the way", a_folder_in_the_way},
  };
  return program_suite("hostile", TESTS, COUNT(TESTS));
}
