/* SPDX-License-Identifier: GPL-3.0-or-later
 * Limits of memory that belong to a batch system or a control group. Where the kernel grants more
 * than there is, it ends the process that has most of it. That is done here by the test itself, and
 * by the kernel where the test may make a control group. A case that wants too much costs itself;
 * the study goes on, and says what has happened to it. */
#include <limits.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "age.h"

/* A chain of so many resistors and capacitors before the coil. */
static void write_deck(const char *path, int links) {
  FILE *f = fopen(path, "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  fputs("* SPDX-License-Identifier: GPL-3.0-or-later\n*$ port mains = Vm\n*$ probe v_b = v(b) V\n"
        "Vm a 0 external\nRs a b 50\nXeva b 0 eva\nR0 b n0 1k\n",
        f);
  for (int k = 0; k < links; k++)
    fprintf(f, "R%d n%d n%d 1k\nC%d n%d 0 1p\n", k + 1, k, k + 1, k, k);
  fclose(f);
}

/* The small circuit's process has some 10 MB, the large one's 50 MB. */
static void write_study(void) {
  write_deck("small.cir", 10);
  write_deck("large.cir", 12000);
  write_file("m.yaml", "scene: paper\nset: {run.until: 0.02 ms, run.tier: circuit}\n"
                       "vary: {circuit.deck: [small.cir, large.cir, small.cir], firing.angle: [90 "
                       "deg, 100 deg]}\nreport: [i_peak]\n");
}

/* The rows of the small circuits are there, those of the large ones have failed, and why. */
static void expect_large_failed(const ran *r, const char *good, const char *why, int line) {
  char *rows = read_file("m/study.csv"), *failures = read_file("m/failures.csv");
  int failed = 0;
  expect(r->status == 1 && strstr(r->err, "2 of 6 cases failed"), line, "%d %s", r->status, r->err);
  expect(count_lines(rows) == 5 && !lines_lost(rows, good), line, "%s", rows);
  for (const char *s = failures; (s = strstr(s, why)); s++) failed++;
  for (const char *s = failures; (s = strstr(s, "died: signal 9 (Killed)")); s++) failed++;
  expect(failed == 2, line, "%s", failures);
  free(rows), free(failures);
}

/* ---- who has most is ended ---- */

/* What a process and its descendants have of the machine's memory, in bytes; *largest is who has
 * most of it, as far as it has more than *most. */
static double memory_below(pid_t process, pid_t *largest, double *most) {
  enum { MOST = 32 };
  pid_t children[MOST];
  char path[64];
  long pages = 0;
  snprintf(path, sizeof path, "/proc/%d/statm", (int)process);
  FILE *f = fopen(path, "r");
  if (f && fscanf(f, "%*d %ld", &pages) != 1) pages = 0;
  if (f) fclose(f);
  double sum = (double)pages * (double)sysconf(_SC_PAGESIZE);
  if (sum > *most) *most = sum, *largest = process;
  const size_t n = children_of(process, children, MOST);
  for (size_t k = 0; k < n; k++) sum += memory_below(children[k], largest, most);
  return sum;
}

static ran run_within(const char *words, double bytes, int *ended) {
  pid_t first = begin(words);
  siginfo_t over = {0};
  while (!waitid(P_PID, (id_t)first, &over, WEXITED | WNOHANG | WNOWAIT) && !over.si_pid) {
    pid_t largest = 0;
    double most = 0;
    if (memory_below(first, &largest, &most) > bytes) *ended += !kill(largest, SIGKILL);
    wait_seconds(1e-3);
  }
  return collect(first);
}

static void who_has_most(void) {
#ifdef __SANITIZE_ADDRESS__
  printf("(left out: a sanitizer's own memory counts) ");
  return;
#endif
  write_study();
  RUN_GOOD("study m.yaml -o m --jobs 1 --quiet");
  char *good = read_file("m/study.csv");
  remove_tree("m");
  int ended = 0;
  ran r = run_within("study m.yaml -o m --jobs 1 --quiet", 60e6, &ended);
  /* which comes first, the trial of the circuit or the run of it, a machine decides; each of two
   * cases is begun again once */
  EXPECT(ended >= 4, "%d processes were ended", ended);
  expect_large_failed(&r, good, "killed (signal 9)", __LINE__);
  free_ran(&r);
  r = run("study m.yaml -o m --quiet --resume --again failed"); /* on a larger machine */
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  free_ran(&r);
  char *rows = read_file("m/study.csv");
  CU_ASSERT_STRING_EQUAL(rows, good);
  free(rows), free(good);
  remove_tree("m");
}

/* ---- ulimit -v ---- */

static void address_space(void) {
#ifdef __SANITIZE_ADDRESS__
  return;
#endif
  struct rlimit before, small;
  write_study();
  RUN_GOOD("study m.yaml -o m --jobs 1 --quiet");
  char *good = read_file("m/study.csv");
  remove_tree("m");
  getrlimit(RLIMIT_AS, &before);
  small = before;
  small.rlim_cur = 40000 * 1024;
  setrlimit(RLIMIT_AS, &small);
  ran r = run("study m.yaml -o m --jobs 1 --quiet");
  setrlimit(RLIMIT_AS, &before);
  expect_large_failed(&r, good, "ran out of memory", __LINE__);
  free_ran(&r);
  free(good);
}

/* ---- a control group ---- */

/* A group for processes whose memory is limited. */
typedef struct group {
  char folder[PATH_MAX];
  char before[PATH_MAX]; /* the group that the test belongs to otherwise */
} group;

/* Returns false where the file cannot be written so. */
static bool tell_group(const char *folder, const char *file, long number) {
  char path[PATH_MAX + 64];
  snprintf(path, sizeof path, "%s/%s", folder, file);
  FILE *f = fopen(path, "w");
  if (!f) return false;
  fprintf(f, "%ld\n", number);
  return !fclose(f);
}

/* Finds this process's own group, "N:memory:/GROUP" of version 1 or "0::/GROUP" of version 2. */
static void find_group(const char *root, const char *controller, group *g) {
  char line[PATH_MAX / 2];
  FILE *f = fopen("/proc/self/cgroup", "r");
  snprintf(g->before, sizeof g->before, "%s", root);
  while (f && fgets(line, sizeof line, f)) {
    char *name = strchr(line, ':'), *path = name ? strchr(name + 1, ':') : NULL;
    if (!path) continue;
    *path = '\0';
    path[1 + strcspn(path + 1, "\n")] = '\0';
    if (!strcmp(name + 1, controller))
      snprintf(g->before, sizeof g->before, "%s%s", root, path + 1);
  }
  if (f) fclose(f);
}

/* Makes a group of 30 MB of either version of control groups; false: this process may not. */
static bool make_group(group *g) {
  static const struct {
    const char *root, *controller, *limit;
  } VERSIONS[] = {{"/sys/fs/cgroup/memory", "memory", "memory.limit_in_bytes"},
                  {"/sys/fs/cgroup", "", "memory.max"}};
  for (size_t k = 0; k < COUNT(VERSIONS); k++) {
    snprintf(g->folder, sizeof g->folder, "%s/vs_test_%ld", VERSIONS[k].root, (long)getpid());
    if (mkdir(g->folder, 0755)) continue;
    find_group(VERSIONS[k].root, VERSIONS[k].controller, g);
    if (tell_group(g->folder, VERSIONS[k].limit, 30000000)) return true;
    rmdir(g->folder);
  }
  return false;
}

/* The kernel has several processes of this test to choose from, of which the circuit's is by far
 * the largest. The program that is begun belongs to the group of whoever begins it. */
static void a_control_group(void) {
  group g;
#ifdef __SANITIZE_ADDRESS__
  printf("(left out: a sanitizer's own memory counts) ");
  return;
#endif
  if (!make_group(&g)) {
    printf("(left out: no control group may be made here) ");
    return;
  }
  write_study();
  RUN_GOOD("study m.yaml -o m --jobs 1 --quiet");
  char *good = read_file("m/study.csv");
  remove_tree("m");
  CU_ASSERT(tell_group(g.folder, "cgroup.procs", (long)getpid()));
  ran r = run("study m.yaml -o m --jobs 1 --quiet");
  CU_ASSERT(tell_group(g.before, "cgroup.procs", (long)getpid()));
  CU_ASSERT_EQUAL(rmdir(g.folder), 0);
  expect_large_failed(&r, good, "killed (signal 9)", __LINE__);
  free_ran(&r);
  free(good);
  remove_tree("m");
}

static const vs_test TESTS[] = {{"who has most is ended", who_has_most},
                                {"a control group", a_control_group},
                                {"a limit of the address space", address_space}};

int main(void) {
  return program_suite("memory_limits", TESTS, COUNT(TESTS));
}
