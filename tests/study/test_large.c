/* SPDX-License-Identifier: GPL-3.0-or-later
 * Large studies: neither memory nor open files grow with the number of cases. Small ones here; a
 * million switched cases and 10,000 circuits with tools/test --long, which writes
 * large_studies.csv, committed in tests/long. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>

#include "program.h"

#ifdef __SANITIZE_ADDRESS__
static const bool SANITIZED = true; /* its own memory grows, and all takes ten times as long */
#else
static const bool SANITIZED = false;
#endif

enum { MOST_LOOKS = 100000 };

/* Of the program and its workers at one instant. */
typedef struct look {
  double all_mb, master_mb, worker_mb; /* resident; of the largest worker */
  int files;                           /* open, of the process that has most */
} look;

static double resident_mb(pid_t pid) {
  char path[64];
  long pages = 0;
  snprintf(path, sizeof path, "/proc/%d/statm", (int)pid);
  FILE *f = fopen(path, "r");
  if (f && fscanf(f, "%*d %ld", &pages) != 1) pages = 0;
  if (f) fclose(f);
  return (double)pages * 4096 / 1e6;
}

static int open_files(pid_t pid) {
  char path[64];
  int n = 0;
  snprintf(path, sizeof path, "/proc/%d/fd", (int)pid);
  DIR *d = opendir(path);
  while (d && readdir(d)) n++;
  if (d) closedir(d);
  return n > 2 ? n - 2 : 0; /* but for . and .. */
}

static look look_at(pid_t master) {
  char path[64];
  int child;
  look l = {.master_mb = resident_mb(master), .files = open_files(master)};
  l.all_mb = l.master_mb;
  snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)master, (int)master);
  FILE *f = fopen(path, "r");
  while (f && fscanf(f, "%d", &child) == 1) {
    double mb = resident_mb(child);
    int files = open_files(child);
    l.all_mb += mb;
    if (mb > l.worker_mb) l.worker_mb = mb;
    if (files > l.files) l.files = files;
  }
  if (f) fclose(f);
  return l;
}

static look largest(const look *looks, int from, int to) {
  look most = {0};
  for (int k = from; k < to; k++) {
    const look *l = &looks[k];
    if (l->all_mb > most.all_mb) most.all_mb = l->all_mb;
    if (l->master_mb > most.master_mb) most.master_mb = l->master_mb;
    if (l->worker_mb > most.worker_mb) most.worker_mb = l->worker_mb;
    if (l->files > most.files) most.files = l->files;
  }
  return most;
}

/* Runs it and looks at it fifty times a second from its first worker on. What is largest in the
 * last quarter of the looks is held against the second quarter. A worker is replaced after 500
 * circuits, by which it has grown by 0.5 MB (libngspice's leak, a kilobyte a run); the program
 * itself keeps 8 bytes of a case. */
static void watch(const char *name, const char *study, long cases, FILE *table) {
  static look looks[MOST_LOOKS];
  const char *argv[MOST_WORDS];
  char words[64] = "study large.yaml -o large --quiet --overwrite";
  const struct timespec pause = {0, 20000000};
  siginfo_t end = {0};
  int n = 0;
  time_t began = time(NULL);
  write_file("large.yaml", study);
  split(words, argv);
  pid_t master = spawn(argv);
  while (n < MOST_LOOKS && !waitid(P_PID, (id_t)master, &end, WEXITED | WNOHANG | WNOWAIT) &&
         !end.si_pid) {
    looks[n] = look_at(master);
    n += n || looks[n].worker_mb > 0;
    nanosleep(&pause, NULL);
  }
  ran r = collect(master);
  double minutes = difftime(time(NULL), began) / 60;
  EXPECT(r.status == 0, "exit status %d: %s", r.status, r.err);
  free_ran(&r);
  char *csv = read_file("large/study.csv");
  CU_ASSERT_EQUAL(count_lines(csv), cases + 1);
  free(csv);
  look all = largest(looks, 0, n), early = largest(looks, n / 4, n / 2),
       late = largest(looks, 3 * n / 4, n);
  EXPECT(SANITIZED || all.all_mb < 200, "%g MB", all.all_mb);
  EXPECT(SANITIZED || late.worker_mb < early.worker_mb + 1, "worker: %g MB, then %g MB",
         early.worker_mb, late.worker_mb);
  EXPECT(SANITIZED || late.master_mb < early.master_mb + 1 + 8e-6 * (double)cases,
         "master: %g MB, then %g MB", early.master_mb, late.master_mb);
  EXPECT(late.files <= early.files, "%d open files, then %d", early.files, late.files);
  if (table)
    fprintf(table, "%s,%ld,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%d,%d\n", name, cases, minutes, all.all_mb,
            early.master_mb, late.master_mb, early.worker_mb, late.worker_mb, early.files,
            late.files);
}

static const char SWITCHED[] =
    "vary: {firing.angle: {lin: [90 deg, 150 deg], n: %d}, supply.voltage: {lin: [300 V, 460 V], "
    "n: %d}}\nreport: [p_min, i_peak]\n";
static const char CIRCUIT[] =
    "set: {run.until: 30 ms, run.tolerance: 1e-3}\n"
    "vary: {circuit.r1: {log: [10 ohm, 10 kohm], n: %d}, firing.angle: {lin: [90 deg, 150 deg], "
    "n: %d}}\nreport: [v_ak_min, p_min]\n";

static void grid(const char *name, const char *study, int n, int m, FILE *table) {
  char text[512];
  snprintf(text, sizeof text, study, n, m);
  watch(name, text, (long)n * m, table);
}

static void small_ones(void) {
  if (getenv("VS_LONG")) return;
  grid("switched", SWITCHED, 50, SANITIZED ? 20 : 80, NULL);
  grid("circuit", CIRCUIT, 10, SANITIZED ? 2 : 15, NULL);
}

static void large_ones(void) {
  if (!getenv("VS_LONG") || SANITIZED) return;
  FILE *table = fopen(VS_BUILD_TREE "/tests/run/test_large/large_studies.csv", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(table);
  fputs("study,cases,time_min,all_mb,master_early_mb,master_late_mb,worker_early_mb,"
        "worker_late_mb,files_early,files_late\n",
        table);
  grid("switched", SWITCHED, 1000, 1000, table);
  fflush(table);
  grid("circuit", CIRCUIT, 100, 100, table);
  fclose(table);
}

static const vs_test TESTS[] = {{"small ones", small_ones}, {"large ones (long)", large_ones}};

int main(void) {
  return program_suite("large", TESTS, COUNT(TESTS));
}
