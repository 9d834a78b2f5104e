/* SPDX-License-Identifier: GPL-3.0-or-later
 * kill -9 of a study's first process, of a worker, or of all its processes, at instants of the
 * clock and at system calls. What was killed is begun again with --resume, and may be killed again.
 * In the end all files and the report have the bytes of an undisturbed study, and no row that the
 * journal had is lost. Some kills here; more than a thousand with VS_LONG, which writes kills.csv
 * (committed in tests/long). */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>

#include "age.h"
#include "seam.h"

/* ---- what is killed ---- */

/* Commands one after the other, each of which can be given again. All that they make is in "out";
 * --resume also begins a study. */
typedef struct workload {
  const char *name;
  const char *words[4];
  int status; /* with which the studies end */
} workload;

#define STUDY(file, more) "study " file " -o out/s --jobs 2 --resume --quiet" more
#define SHARD(k) "study ideal.yaml --shard " k "/3 -o out/" k " --jobs 2 --resume --quiet"
static const workload WORKLOADS[] = {
    {"ideal", {STUDY("ideal.yaml", ""), "plot out/s"}, 0},
    {"circuit", {STUDY("circuit.yaml", ""), "plot out/s"}, 0},
    {"failing cases", {STUDY("failing.yaml", "")}, 1},
    {"search", {STUDY("search.yaml", "")}, 0},
    {"kept runs", {STUDY("ideal.yaml", " --keep runs")}, 0},
    {"numpy", {STUDY("ideal.yaml", " --format npy")}, 0},
    {"three shards and merge",
     {SHARD("1"), SHARD("2"), SHARD("3"), "merge out -o out/s --quiet"},
     0}};

static void write_studies(void) {
  write_file("ideal.yaml", "set: {run.until: 0.6 s, firing.every: 1}\n"
                           "vary: {firing.angle: {from: 100 deg, to: 170 deg, step: 2 deg}}\n"
                           "report: [p_min, i_peak, energy_residual]\n");
  write_file("circuit.yaml", "scene: paper\nset: {run.until: 2 ms, run.tier: circuit}\n"
                             "vary: {circuit.r1: [100 ohm, 200 ohm, 300 ohm, 400 ohm, 500 ohm, 600 "
                             "ohm]}\nreport: [i_peak, v_ak_max]\n");
  write_file("failing.yaml",
             "set: {run.until: 0.1 s, firing.every: 1}\n" /* pole contacts */
             "vary: {supply.voltage: {lin: [300 V, 520 V], n: 6}, firing.angle: "
             "{from: 80 deg, to: 125 deg, step: 5 deg}}\nreport: [p_min, i_peak]\n");
  write_file("search.yaml", "set: {run.until: 0.2 s, firing.every: 1}\n"
                            "vary: {firing.angle: {lin: [90 deg, 120 deg], n: 4}}\n"
                            "find: {worst: max i_peak, n: 60}\n");
}

/* ---- how ---- */

static const char *const WHO[] = {"first process", "worker", "all processes"};
enum { FIRST, WORKER, ALL, N_WHO };

/* Ends the process, or all; true if it was there. */
static bool end_it(pid_t first, int who) {
  enum { MOST = 64 };
  pid_t children[MOST];
  const size_t n = who == FIRST ? 0 : children_of(first, children, MOST);
  if (who == WORKER) return n && !kill(children[(size_t)rand() % n], SIGKILL);
  bool there = !kill(first, SIGKILL);
  for (size_t k = 0; k < n; k++) kill(children[k], SIGKILL);
  return there;
}

/* Runs the command; the kill comes at that time. */
static ran kill_at_time(const char *words, int who, double at_s, bool *killed) {
  pid_t first = begin(words);
  wait_seconds(at_s);
  *killed = end_it(first, who);
  return collect(first);
}

/* Calls by which files and processes change. Their order is the same each time, as far as it is one
 * process's. */
static const long CALLS[] = {SYS_write,     SYS_pwrite64,   SYS_fsync,  SYS_fdatasync,
                             SYS_ftruncate, SYS_open,       SYS_openat, SYS_rename,
                             SYS_renameat,  SYS_renameat2,  SYS_unlink, SYS_unlinkat,
                             SYS_mkdir,     SYS_flock,      SYS_clone,  SYS_fork,
                             SYS_pipe2,     SYS_getdents64, -1};

typedef struct turn {
  int who;
  unsigned long at, calls; /* before which call; 0: none */
  bool killed;
} turn;

static int end_at(void *ctx, const seam_call *call) {
  turn *t = ctx;
  const bool first = call->process == call->first;
  if (seam_is_library(call) || first != (t->who != WORKER) || ++t->calls != t->at) return 0;
  t->killed = t->who == WORKER ? !kill(call->process, SIGKILL) : end_it(call->first, t->who);
  return 0;
}

static ran kill_at_call(const char *words, turn *t) {
  const seam s = {CALLS, end_at, t};
  return seam_run(&s, words);
}

/* ---- one end ---- */

typedef struct tally {
  int kills, ends, equal, lost;
} tally;

/* An undisturbed command. */
typedef struct length {
  double seconds;
  unsigned long calls[N_WHO];
} length;

static double chance(void) {
  return (double)rand() / RAND_MAX;
}

/* Runs the command until it ends: the first time with a kill, and with one every other time later
 * on. */
static void go_through(const workload *w, const char *words, const length *l, int who, bool by_call,
                       tally *sum) {
  enum { MOST = 40 };
  const int good = strncmp(words, "study", 5) ? 0 : w->status;
  int status = -1;
  for (int n = 0; n < MOST && status != good; n++) {
    bool killed = false;
    char *before = rows_of("out");
    ran r;
    if (n && rand() % 2)
      r = run("%s", words);
    else if (by_call) {
      turn t = {who, 1 + (unsigned long)(chance() * (double)l->calls[who]), 0, false};
      r = kill_at_call(words, &t);
      killed = t.killed;
    } else
      r = kill_at_time(words, who, chance() * 1.1 * l->seconds, &killed);
    status = r.status;
    char *after = rows_of("out");
    sum->kills += killed;
    sum->lost += lines_lost(before, after);
    /* gnuplot may be what was killed */
    const bool told = !strncmp(words, "plot", 4) && status == 1;
    EXPECT(status == good || (killed && (told || status == 1000 + SIGKILL)),
           "%s: %s: status %d: %s", w->name, words, status, r.err);
    free(before), free(after);
    free_ran(&r);
  }
  EXPECT(status == good, "%s has no end", words);
}

static void try_one(const workload *w, const length *lengths, const char *good, int who,
                    bool by_call, tally *sum) {
  remove_tree("out");
  for (size_t k = 0; k < COUNT(w->words) && w->words[k]; k++)
    go_through(w, w->words[k], &lengths[k], who, by_call, sum);
  char *tree = tree_of("out");
  const bool same = !strcmp(tree, good);
  sum->ends++;
  sum->equal += same;
  EXPECT(same, "%s, %s: is\n%sand was\n%s", w->name, WHO[who], tree, good);
  free(tree);
}

/* ---- all ---- */

static char *run_undisturbed(const workload *w, length *lengths) {
  remove_tree("out");
  for (size_t k = 0; k < COUNT(w->words) && w->words[k]; k++) {
    const double began = vs_budget_clock_s();
    ran r = run("%s", w->words[k]);
    lengths[k].seconds = vs_budget_clock_s() - began;
    const int good = strncmp(w->words[k], "study", 5) ? 0 : w->status;
    EXPECT(r.status == good, "%s: %d %s", w->words[k], r.status, r.err);
    free_ran(&r);
  }
  return tree_of("out");
}

static void count_calls(const workload *w, length *lengths) {
  for (int who = 0; who < N_WHO; who++) {
    remove_tree("out");
    for (size_t k = 0; k < COUNT(w->words) && w->words[k]; k++) {
      turn t = {who, 0, 0, false};
      ran r = kill_at_call(w->words[k], &t);
      lengths[k].calls[who] = t.calls;
      free_ran(&r);
    }
  }
}

/* Tries until there were so many kills. */
static void try_kind(const workload *w, int who, bool by_call, int kills, FILE *table) {
  length lengths[COUNT(w->words)] = {{0}};
  tally t = {0};
  char *good = run_undisturbed(w, lengths);
  if (by_call) count_calls(w, lengths);
  for (int n = 0; t.kills < kills && n < 20 * kills; n++)
    try_one(w, lengths, good, who, by_call, &t);
  EXPECT(t.kills >= kills && t.lost == 0 && t.equal == t.ends,
         "%s, %s: %d kills, %d of %d ends equal, %d rows lost", w->name, WHO[who], t.kills, t.equal,
         t.ends, t.lost);
  if (table)
    fprintf(table, "%s,%s,%s,%d,%d,%d,%d\n", w->name, WHO[who], by_call ? "call" : "time", t.kills,
            t.ends, t.equal, t.lost);
  if (table) fflush(table);
  free(good);
}

static void try_all(int kills, FILE *table) {
  const bool calls = seam_is_possible();
  if (!calls) printf("(left out: kills at system calls) ");
  /* what is killed has no end at which leaks are looked for */
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
  write_studies();
  srand(21);
  for (const workload *w = WORKLOADS; w < WORKLOADS + COUNT(WORKLOADS); w++)
    for (int who = 0; who < N_WHO; who++)
      for (int by_call = 0; by_call <= calls; by_call++)
        if (table || (w - WORKLOADS + who + by_call) % 4 == 0)
          try_kind(w, who, by_call, kills, table);
}

static void some(void) {
  if (!getenv("VS_LONG")) try_all(1, NULL);
}

static void a_thousand(void) {
  if (!getenv("VS_LONG")) return;
  FILE *table = fopen(VS_BUILD_TREE "/tests/run/test_kills/kills.csv", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(table);
  fputs("what,who,at,kills,ends,ends_equal,rows_lost\n", table);
  try_all(24, table); /* 24 of each of 42 kinds: 1008 at least */
  fclose(table);
}

/* A worker that has outlived its parent has left a part of a run. */
static void litter(void) {
  write_studies();
  remove_tree("out");
  RUN_GOOD("study search.yaml -o out --quiet --keep runs");
  char *good = tree_of("out");
  write_file("out/runs/2/.vibrospice-tmp.a1B2c3", "t_s\n");
  RUN_GOOD("study search.yaml -o out --quiet --keep runs --resume");
  char *tree = tree_of("out");
  EXPECT(!strcmp(tree, good), "is\n%sand was\n%s", tree, good);
  free(tree), free(good);
}

/* What the others count lost lines by. */
static void lost_lines(void) {
  static const struct {
    const char *before, *after;
    int lost;
  } ROWS[] = {{"", "", 0},          {"a\n", "b\na\n", 0},    {"b\na\n", "a\nb\n", 0},
              {"a\n", "ab\n", 1},   {"ab\na\n", "ab\n", 1},  {"a\na\n", "a\n", 1},
              {"a\n", "a\na\n", 0}, {"a\nb\nc\n", "b\n", 2}, {"a\n", "", 1}};
  for (size_t k = 0; k < COUNT(ROWS); k++)
    EXPECT(lines_lost(ROWS[k].before, ROWS[k].after) == ROWS[k].lost, "%zu: %d", k,
           lines_lost(ROWS[k].before, ROWS[k].after));
}

static const vs_test TESTS[] = {{"lost lines", lost_lines},
                                {"a part of a run", litter},
                                {"some kills", some},
                                {"a thousand kills", a_thousand}};

int main(void) {
  return program_suite("kills", TESTS, COUNT(TESTS));
}
