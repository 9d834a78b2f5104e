/* SPDX-License-Identifier: GPL-3.0-or-later
 * The n-th request for memory, the n-th write, fsync, rename and so on fails, in runs, a study, a
 * merge and a check. No signal ends the program, and one of two things comes of it. Either the
 * failure did not matter, and all bytes are as without it. Or the exit status says so and a line on
 * standard error why; every file is whole or not there; and a study goes on with --resume to the
 * same bytes. Some n here, of each kind; all of them with tools/test --long, which writes
 * faults.csv (committed in tests/long). */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "faults.h"

/* ---- what is run ---- */

/* Each writes to `out`, and prints no times. */
typedef struct workload {
  const char *name, *words;
  bool resumes;
} workload;

static const workload WORKLOADS[] = {
    {"run, ideal", "run paper --set run.until=20ms --reproducible --json -o out", false},
    {"run, circuit",
     "run paper --tier circuit --set run.until=1ms --raw --reproducible --json -o out", false},
    {"study, ideal", "study ideal.yaml --jobs 1 -o out", true},
    {"study, circuit", "study circuit.yaml --jobs 1 -o out", true},
    {"merge", "merge one two -o out", false},
    {"check", "check circuit.yaml", false}};

static void prepare(void) {
  static bool done;
  mkdir("../temporary", 0777);
  setenv("TMPDIR", "../temporary", 1);
  if (done) return;
  done = true;
  write_file("ideal.yaml", "scene: paper\nset: {run.until: 5 ms, run.tier: switched}\n"
                           "vary: {firing.angle: [90 deg, 100 deg, 110 deg]}\n");
  write_file("circuit.yaml", "scene: paper\nset: {run.until: 0.5 ms, run.tier: circuit}\n"
                             "vary: {circuit.r1: [100 ohm, 200 ohm]}\n");
  RUN_GOOD("study ideal.yaml --shard 1/2 -o one --quiet");
  RUN_GOOD("study ideal.yaml --shard 2/2 -o two --quiet");
}

/* ---- what it leaves behind ---- */

/* The files of a folder, each with its bytes, as one text; the journal aside, whose rows stand in
 * the order in which cases ended. */
static void add_files(vs_text *all, const char *folder) {
  char *names = listing(folder), *rest = names, path[512];
  for (char *name; (name = strsep(&rest, " "));) {
    if (!*name || *name == '(' || !strcmp(name, "journal") || !strcmp(name, "folder)")) continue;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    char *text = read_file(path);
    vs_text_add(all, "file %s\n%s\n", name, text);
    free(text);
  }
  free(names);
}

static char *files_of(const char *folder) {
  vs_text all = {0};
  vs_text_add(&all, "\n");
  add_files(&all, folder);
  return all.text;
}

/* True if each file of `out` is the one of the good run. What was recorded up to a failure is kept
 * as run.partial.csv. */
static bool is_whole(const char *good) {
  char *names = listing("out"), *rest = names, path[512];
  bool whole = true;
  for (char *name; (name = strsep(&rest, " "));) {
    if (!*name || *name == '(' || !strcmp(name, "journal") || strstr(name, "partial") ||
        !strcmp(name, "folder)"))
      continue;
    vs_text file = {0};
    snprintf(path, sizeof path, "out/%s", name);
    char *text = read_file(path);
    vs_text_add(&file, "\nfile %s\n%s\n", name, text);
    whole = whole && strstr(good, file.text);
    free(text);
    vs_text_free(&file);
  }
  free(names);
  return whole;
}

/* True if the journal has all lines that it had. */
static bool has_kept(const char *before) {
  char *now = read_file("out/journal"), *copy = vs_copy(before), *rest = copy;
  bool kept = true;
  for (char *line; (line = strsep(&rest, "\n")) && rest;) kept = kept && strstr(now, line);
  free(now);
  free(copy);
  return kept;
}

/* ---- one fault ---- */

/* How often each thing came of a fault. */
typedef struct tally {
  unsigned long calls;                       /* of that kind, without a fault */
  int tried, same, told;                     /* what is good */
  int cases;                                 /* of `told`: a study has come to its end, but for
                                                cases that failed, of which it says why */
  int crashed, silent, half, littered, lost; /* what is not */
} tally;

typedef struct reference {
  char *out, *files;
} reference;

static void clear(void) {
  remove_tree("out");
  remove_tree("../temporary");
  mkdir("../temporary", 0777);
}

/* Goes on with the study, or begins it where nothing was kept. */
static bool resumes(const workload *w, const reference *good) {
  char *journal = read_file("out/journal");
  ran r = run("%s%s", w->words, *journal ? " --resume" : " --overwrite");
  char *files = files_of("out");
  bool fine = r.status == 0 && !strcmp(files, good->files) && has_kept(journal);
  free(files);
  free(journal);
  free_ran(&r);
  return fine;
}

/* True if standard error says why. Of a write that is buffered the reason is lost by the time that
 * the stream is asked. A file whose lock is refused once may be taken for a stale one. `check`
 * reads a file once for each kind that it may be; where that fails once, it takes the file for a
 * scene. */
static bool tells(const fault *f, const ran *r) {
  return strstr(r->err, f->error ? strerror(f->error) : "out of memory") ||
         strstr(r->err, "a part of it was refused") ||
         strstr(r->err, "standard output cannot be written") ||
         (f->error == ENOLCK && strstr(r->err, "cannot be written")) ||
         (r->status == 2 && strstr(r->err, "a scene has no key 'scene'"));
}

/* True if a study has come to its end, and its failures.csv says what has failed. */
static bool tells_of_cases(const fault *f, const ran *r) {
  char *failures = read_file("out/failures.csv");
  bool tells = r->status == 1 && strstr(r->err, "cases failed") &&
               (strstr(failures, f->error ? strerror(f->error) : "out of memory") ||
                strstr(failures, "its process"));
  free(failures);
  return tells;
}

static void try_one(const workload *w, const fault *f, unsigned long n, const reference *good,
                    tally *sum) {
  unsigned long calls;
  clear();
  ran r = fault_run(f, n, w->words, &calls);
  char *files = files_of("out"), *litter = listing("../temporary");
  const bool unharmed = r.status == 0, crashed = r.status >= 1000,
             same = !strcmp(files, good->files) && !strcmp(r.out, good->out),
             cases = w->resumes && tells_of_cases(f, &r), told = cases || tells(f, &r),
             whole = unharmed || cases || is_whole(good->files);
  const bool littered = *litter, lost = w->resumes && !unharmed && !cases && !resumes(w, good),
             silent = unharmed ? !same : !crashed && !told;
  sum->tried++;
  sum->same += unharmed && same;
  sum->told += !unharmed && told;
  sum->cases += cases;
  sum->crashed += crashed;
  sum->silent += silent;
  sum->half += !whole;
  sum->littered += littered;
  sum->lost += lost;
  EXPECT(!crashed && !silent && whole && !littered && !lost,
         "%s: %s %lu (%s): status %d%s%s%s%s: %s", w->name, f->name, n,
         f->error ? strerror(f->error) : "no memory", r.status, silent ? ", silent" : "",
         whole ? "" : ", half a file", littered ? ", litter" : "", lost ? ", lost" : "", r.err);
  free(files);
  free(litter);
  free_ran(&r);
}

static reference run_good_one(const workload *w, const fault *f, unsigned long *calls) {
  clear();
  ran r = fault_run(f, 0, w->words, calls);
  EXPECT(r.status == 0, "%s, %s: status %d: %s", w->name, f->name, r.status, r.err);
  free(r.err);
  return (reference){r.out, files_of("out")};
}

/* So many n at equal distances, the first one included; 0: all n. */
static void try_all(const workload *w, const fault *f, unsigned long some, FILE *table) {
  tally t = {0};
  reference good = run_good_one(w, f, &t.calls);
  const unsigned long stride = some && t.calls > some ? (t.calls + some - 1) / some : 1;
  for (unsigned long n = 1; n <= t.calls; n += stride) try_one(w, f, n, &good, &t);
  if (table)
    fprintf(table, "\"%s\",%s,%s,%lu,%d,%d,%d,%d,%d,%d,%d,%d,%d\n", w->name, f->name,
            f->error ? strerrorname_np(f->error) : "ENOMEM", t.calls, t.tried, t.same, t.told,
            t.cases, t.crashed, t.silent, t.half, t.littered, t.lost);
  if (table) fflush(table);
  free(good.out);
  free(good.files);
}

static void try_everything(unsigned long some, FILE *table) {
  prepare();
  for (const fault *f = fault_all; f->name; f++) {
    if (!fault_is_possible(f)) {
      printf("(left out: %s) ", f->name);
      continue;
    }
    for (const workload *w = WORKLOADS; w < WORKLOADS + COUNT(WORKLOADS); w++)
      try_all(w, f, some, table);
  }
  unsetenv("TMPDIR");
}

static void some(void) {
#ifdef __SANITIZE_ADDRESS__
  const unsigned long few = 3; /* all takes ten times as long */
#else
  const unsigned long few = 7;
#endif
  if (!getenv("VS_LONG")) try_everything(few, NULL);
}

static void all_of_them(void) {
  if (!getenv("VS_LONG")) return;
  FILE *table = fopen(VS_BUILD_TREE "/tests/run/test_faults/faults.csv", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(table);
  fputs("what,fails,error,calls,tried,same,told,cases,crashed,silent,half,littered,lost\n", table);
  try_everything(0, table);
  fclose(table);
}

/* ---- no memory while ngspice begins ---- */

/* ngspice begins in another folder than the run's, whose files are then removed by paths that lead
 * from the run's. That is in the first half of all calls. */
static void beginning(void) {
  enum { TRIED = 40 };
  const workload *circuit = &WORKLOADS[1];
  const fault *memory = &fault_all[0];
  tally t = {0};
  if (!fault_is_possible(memory) || getenv("VS_LONG")) return;
  prepare();
  reference good = run_good_one(circuit, memory, &t.calls);
  for (unsigned long k = 1; k <= TRIED; k++)
    try_one(circuit, memory, k * t.calls / (2 * TRIED), &good, &t);
  free(good.out);
  free(good.files);
  unsetenv("TMPDIR");
}

/* ---- a worker without memory ---- */

/* Its cases fail with that cause, one by one, and the study comes to its end. */
static void workers(void) {
  unsigned long calls;
  if (!fault_is_possible(&fault_of_workers)) return;
  prepare();
  clear();
  ran r = fault_run(&fault_of_workers, 1, "study ideal.yaml --jobs 1 -o out", &calls);
  char *failures = read_file("out/failures.csv");
  int rows = 0;
  for (const char *s = failures; (s = strstr(s, "its process ran out of memory")); s++) rows++;
  CU_ASSERT_EQUAL(r.status, 1);
  EXPECT(strstr(r.err, "3 of 3 cases failed") != NULL, "%s", r.err);
  EXPECT(rows == 3, "%s", failures);
  free(failures);
  free_ran(&r);
  unsetenv("TMPDIR");
}

static const vs_test TESTS[] = {{"some calls fail", some},
                                {"every call fails", all_of_them},
                                {"there is no memory while ngspice begins", beginning},
                                {"workers have no memory", workers}};

int main(void) {
  return program_suite("faults", TESTS, COUNT(TESTS));
}
