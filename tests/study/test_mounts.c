/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study on a disk that is slow, full, or gone: it loses no row, names the file, ends with status
 * 1 and goes on with --resume to the same bytes, once the disk is there again. Mounts are made in a
 * namespace of this process' own, where that is allowed. */
#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "age.h"
#include "seam.h"

static const char SOME[] = "set: {run.until: 0.1 s, firing.every: 1}\n"
                           "vary: {firing.angle: {lin: [100 deg, 170 deg], n: 24}}\n"
                           "report: [p_min, i_peak, energy_residual]\n";
/* Of some seconds, so that something can happen meanwhile. */
static const char LONGER[] = "set: {run.until: 4 s, firing.every: 1}\n"
                             "vary: {firing.angle: {lin: [100 deg, 170 deg], n: 400}}\n"
                             "report: [p_min, i_peak]\n";
/* 1.5 MB of rows. */
static const char MANY[] = "set: {run.until: 20 ms, run.tier: switched}\n"
                           "vary: {firing.angle: {lin: [90 deg, 120 deg], n: 20000}}\n"
                           "report: [i_peak]\n";

/* The study as it is when nothing happens. free() it. */
static char *undisturbed(const char *file) {
  remove_tree("good");
  ran r = run("study %s -o good --quiet", file);
  expect_good(&r, file, __LINE__);
  free_ran(&r);
  char *tree = tree_of("good");
  remove_tree("good");
  return tree;
}

/* Goes on with the study in the folder: it has the good one's bytes then, and all rows it had. */
static void expect_resumed(const char *file, const char *folder, const char *good, int line) {
  char *before = rows_of(folder);
  ran r = run("study %s -o %s --quiet %s", file, folder, *before ? "--resume" : "--overwrite");
  expect(r.status == 0, line, "%d %s", r.status, r.err);
  free_ran(&r);
  char *after = rows_of(folder), *tree = tree_of(folder);
  expect(!lines_lost(before, after), line, "rows are lost");
  expect(!strcmp(tree, good), line, "%s is\n%sand was\n%s", folder, tree, good);
  free(before), free(after), free(tree);
}

/* ---- slow ---- */

/* Calls by which a disk is reached. */
static const long DISK[] = {SYS_write,
                            SYS_pwrite64,
                            SYS_fsync,
                            SYS_fdatasync,
                            SYS_ftruncate,
                            SYS_open,
                            SYS_openat,
                            SYS_rename,
                            SYS_renameat,
                            SYS_renameat2,
                            SYS_read,
                            SYS_pread64,
                            SYS_newfstatat,
                            SYS_unlink,
                            SYS_unlinkat,
                            SYS_flock,
                            -1};

/* What the disk does at calls for files in the folder "disk". */
typedef struct disk {
  double least_s, most_s;    /* each takes a time between these */
  unsigned long from, until; /* from that call on, up to before the other one; 0: to the end ... */
  int error;                 /* ... this is what comes of it; 0: it is only slow */
  const char *file;          /* only calls for files whose name ends so; NULL: all */
  unsigned long calls, syncs;
  long peak_kb; /* of the first process, as far as it was looked at, at every 64th call */
} disk;

static long peak_of(pid_t process) {
  char path[64], line[256];
  long kb = 0;
  snprintf(path, sizeof path, "/proc/%d/status", (int)process);
  FILE *f = fopen(path, "r");
  while (f && fgets(line, sizeof line, f))
    if (!strncmp(line, "VmHWM:", 6)) kb = atol(line + 6);
  if (f) fclose(f);
  return kb;
}

/* True for the folder "disk" of the work folder, and for what is in it. */
static bool is_on_disk(const char *name) {
  char here[VS_PATH_SIZE];
  const size_t n = getcwd(here, sizeof here) ? strlen(here) : 0;
  if (n && !strncmp(name, here, n) && name[n] == '/') name += n + 1;
  return !strncmp(name, "disk", 4) && (!name[4] || name[4] == '/');
}

static int reach(void *ctx, const seam_call *call) {
  disk *d = ctx;
  const size_t n = strlen(call->name), end = d->file ? strlen(d->file) : 0;
  if (!is_on_disk(call->name) || n < end || strcmp(call->name + n - end, d->file ? d->file : ""))
    return 0;
  d->calls++;
  d->syncs += call->number == SYS_fsync || call->number == SYS_fdatasync;
  if (d->calls % 64 == 1) d->peak_kb = peak_of(call->first);
  if (d->calls < d->from || (d->until && d->calls >= d->until)) return 0;
  if (d->most_s > 0)
    wait_seconds(d->least_s + (d->most_s - d->least_s) * (double)rand() / RAND_MAX);
  return d->error;
}

static ran run_on(disk *d, const char *words) {
  const seam s = {DISK, reach, d};
  return seam_run(&s, words);
}

/* Each call takes 50 to 200 ms, as on a network that is far away. */
static void slow(void) {
  write_file("some.yaml", SOME);
  char *good = undisturbed("some.yaml");
  disk d = {.least_s = 0.05, .most_s = 0.2};
  ran r = run_on(&d, "study some.yaml -o disk --jobs 2 --quiet");
  char *tree = tree_of("disk");
  EXPECT(r.status == 0 && !*r.err && !strcmp(tree, good), "%d %s%s", r.status, r.err, tree);
  EXPECT(d.calls < 120, "%lu calls", d.calls);
  printf("%lu calls ", d.calls);
  free(tree), free(good);
  free_ran(&r);
  remove_tree("disk");
}

/* A disk that takes longer for a row than a case may take costs no case its time. */
static void slower_than_a_case(void) {
  write_file("many.yaml", MANY);
  char *good = undisturbed("many.yaml");
  /* a few calls, some of which come as answers are taken, while the other worker is at its case */
  disk d = {.least_s = 3, .most_s = 3, .from = 8, .until = 12, .file = "disk/journal"};
  ran r = run_on(&d, "study many.yaml -o disk --jobs 2 --case-timeout 2s --quiet");
  char *tree = tree_of("disk");
  EXPECT(r.status == 0 && !strcmp(tree, good), "%d %s", r.status, r.err);
  free(tree), free(good);
  free_ran(&r);
  remove_tree("disk");
}

/* ---- stale ---- */

/* From the n-th call on, nothing on that disk is to be had. */
static void stale_from(unsigned long n, int error, const char *good) {
  disk d = {.from = n, .error = error};
  remove_tree("disk");
  ran r = run_on(&d, "study some.yaml -o disk --jobs 2 --quiet");
  const bool told = (r.status == 1 || r.status == 2) && strstr(r.err, "disk") &&
                    (strstr(r.err, strerror(error)) || strstr(r.err, "is gone"));
  char *tree = tree_of("disk"); /* the last calls tidy up */
  EXPECT(told || (r.status == 0 && !strcmp(tree, good)), "%lu: %d %s", n, r.status, r.err);
  free(tree);
  free_ran(&r);
  expect_resumed("some.yaml", "disk", good, __LINE__);
}

static void stale(void) {
  write_file("some.yaml", SOME);
  char *good = undisturbed("some.yaml");
  disk d = {0};
  ran r = run_on(&d, "study some.yaml -o disk --jobs 2 --quiet");
  const unsigned long each = getenv("VS_LONG") ? 1 : 1 + d.calls / 8;
  free_ran(&r);
  for (unsigned long n = 1; n <= d.calls; n += each) stale_from(n, n % 2 ? ESTALE : EIO, good);
  free(good);
  remove_tree("disk");
}

/* ---- gone ---- */

/* Begins the study and waits for its first row. */
static pid_t begin_with_a_row(const char *folder) {
  char words[256], journal[64];
  snprintf(words, sizeof words, "study longer.yaml -o %s --jobs 2 --quiet", folder);
  snprintf(journal, sizeof journal, "%s/journal", folder);
  pid_t first = begin(words);
  WAIT_UNTIL(file_says(journal, " = "));
  return first;
}

static void expect_gone(pid_t first, const char *says, int line) {
  const double began = vs_budget_clock_s();
  ran r = collect(first);
  expect(r.status == 1 && strstr(r.err, says), line, "%d %s", r.status, r.err);
  expect(vs_budget_clock_s() - began < 60, line, "%g s", vs_budget_clock_s() - began);
  free_ran(&r);
}

static void renamed(void) {
  write_file("longer.yaml", LONGER);
  char *good = undisturbed("longer.yaml");
  pid_t first = begin_with_a_row("v");
  CU_ASSERT_EQUAL(rename("v", "away"), 0);
  expect_gone(first, "v/journal: is gone, or is another file", __LINE__);
  EXPECT_FILES("away", "journal ");
  CU_ASSERT_EQUAL(rename("away", "v"), 0);
  expect_resumed("longer.yaml", "v", good, __LINE__);
  free(good);
}

/* ---- mounts ---- */

static bool is_mountable;

/* Puts this process into a namespace of mounts of its own. */
static void get_mounts(void) {
  char map[64];
  const uid_t user = getuid();
  const gid_t group = getgid();
  bool own = !unshare(CLONE_NEWNS);
  if (!own && !unshare(CLONE_NEWUSER | CLONE_NEWNS)) {
    write_file("/proc/self/setgroups", "deny");
    snprintf(map, sizeof map, "0 %u 1", user);
    write_file("/proc/self/uid_map", map);
    snprintf(map, sizeof map, "0 %u 1", group);
    write_file("/proc/self/gid_map", map);
    own = true;
  }
  mkdir("mounted", 0777);
  is_mountable = own && !mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL) &&
                 !mount("none", "mounted", "tmpfs", 0, "size=1m") && !umount("mounted");
  if (!is_mountable) printf("(left out: this machine does not let a test mount) ");
}

static void mount_size(const char *folder, const char *size, unsigned long flags) {
  mkdir(folder, 0777);
  EXPECT(!mount("none", folder, "tmpfs", flags, size), "%s", strerror(errno));
}

/* First the journal does not fit, and then the result. */
static void full(void) {
  static const char *const SIZES[] = {"size=1m", "size=2m"}, *const AT[] = {"journal", "study.csv"};
  if (!is_mountable) return;
  write_file("many.yaml", MANY);
  char *good = undisturbed("many.yaml");
  for (size_t k = 0; k < COUNT(SIZES); k++) {
    char says[64];
    mount_size("small", SIZES[k], 0);
    ran r = run("study many.yaml -o small/s --quiet");
    snprintf(says, sizeof says, "small/s/%s: cannot be written: %s", AT[k], strerror(ENOSPC));
    EXPECT(r.status == 1 && strstr(r.err, says), "%d %s", r.status, r.err);
    EXPECT_FILES("small/s", "journal ");
    free_ran(&r);
    mount_size("small", "size=16m", MS_REMOUNT);
    expect_resumed("many.yaml", "small/s", good, __LINE__);
    CU_ASSERT_EQUAL(umount("small"), 0);
  }
  free(good);
}

/* The study's folder is where something was mounted, or lies below it. */
static void unmounted(void) {
  static const char *const FOLDERS[] = {"mounted", "mounted/s"};
  if (!is_mountable) return;
  write_file("longer.yaml", LONGER);
  char *good = undisturbed("longer.yaml");
  mkdir("kept", 0777);
  for (size_t k = 0; k < COUNT(FOLDERS); k++) {
    mount_size("mounted", "size=16m", 0);
    CU_ASSERT_EQUAL(mount("mounted", "kept", NULL, MS_BIND, NULL), 0);
    pid_t first = begin_with_a_row(FOLDERS[k]);
    EXPECT(!umount2("mounted", MNT_DETACH), "%s", strerror(errno));
    expect_gone(first, "/journal: is gone, or is another file", __LINE__);
    EXPECT_FILES("mounted", "");
    CU_ASSERT_EQUAL(mount("kept", "mounted", NULL, MS_BIND, NULL), 0);
    expect_resumed("longer.yaml", FOLDERS[k], good, __LINE__);
    CU_ASSERT_EQUAL(umount("mounted"), 0);
    CU_ASSERT_EQUAL(umount("kept"), 0);
  }
  free(good);
}

/* ---- many rows ---- */

/* Rows are written, waited for, and read many at a time. */
static void many_rows(void) {
  write_file("many.yaml", MANY);
  const double began = vs_budget_clock_s();
  disk d = {.file = "disk/journal"};
  ran r = run_on(&d, "study many.yaml -o disk --jobs 2 --quiet");
  const double took_s = vs_budget_clock_s() - began;
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  EXPECT((double)d.syncs < 8 + took_s, "%lu fsyncs in %g s", d.syncs, took_s);
  EXPECT(d.calls < 20000 / 10, "%lu calls", d.calls);
  printf("20000 rows: %lu calls, %lu fsyncs ", d.calls, d.syncs);
  free_ran(&r);
  static const char *const AGAIN[] = {"study many.yaml -o disk --resume --quiet",
                                      "merge disk -o merged --quiet"};
  for (size_t k = 0; k < COUNT(AGAIN); k++) {
    disk e = {.file = "disk/journal"};
    r = run_on(&e, AGAIN[k]);
    EXPECT(r.status == 0 && e.calls < 20000 / 15, "%d, %lu calls: %s", r.status, e.calls, r.err);
    printf("%lu calls ", e.calls);
    free_ran(&r);
  }
  remove_tree("disk");
}

/* ---- a year ---- */

/* Writes a row of the table: what the command costs at a journal of so many rows, each of whose
 * calls takes that time. */
static void measure(FILE *table, const char *what, unsigned long rows, double each_s,
                    const char *words) {
  disk d = {.least_s = each_s, .most_s = each_s, .file = "disk/journal"};
  const double began = vs_budget_clock_s();
  ran r = run_on(&d, words);
  const double took_s = vs_budget_clock_s() - began;
  struct stat s = {0};
  stat("disk/journal", &s);
  EXPECT(r.status == 0, "%s: %d %s", words, r.status, r.err);
  /* a part of the whole file each time, and 8 bytes of memory for each row */
  EXPECT((double)d.calls < 100 + 4 * (double)s.st_size / 4096, "%s: %lu calls", words, d.calls);
  EXPECT((double)d.peak_kb < 4e4 + 8e-3 * 1.5 * (double)rows, "%s: %ld kB", words, d.peak_kb);
  fprintf(table, "%s,%lu,%.1f,%g,%lu,%lu,%.1f,%.1f\n", what, rows, (double)s.st_size / 1e6,
          1e3 * each_s, d.calls, d.syncs, (double)d.peak_kb / 1e3, took_s);
  fflush(table);
  free_ran(&r);
}

/* Ten million rows are those of a year in which a case ends every three seconds. */
static void a_year(void) {
  static const unsigned long ROWS[] = {1000000, 10000000};
  if (!getenv("VS_LONG")) return;
  FILE *table = fopen(VS_BUILD_TREE "/tests/run/test_mounts/journal.csv", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(table);
  fputs("what,rows,journal_mb,each_call_ms,calls,fsyncs,peak_mb,wall_s\n", table);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[256];
    snprintf(text, sizeof text,
             "set: {run.until: 20 ms, run.tier: switched}\nvary: {firing.angle: {lin: [90 deg, 120 "
             "deg], n: %lu}}\nreport: [i_peak]\n",
             ROWS[k]);
    write_file("year.yaml", text);
    measure(table, "study", ROWS[k], 0, "study year.yaml -o disk --quiet");
    for (int late = 0; late < 2; late++) {
      measure(table, "resume", ROWS[k], 1e-3 * late, "study year.yaml -o disk --resume --quiet");
      measure(table, "merge", ROWS[k], 1e-3 * late, "merge disk -o merged --quiet");
    }
    remove_tree("disk"), remove_tree("merged");
  }
  fclose(table);
}

/* ---- all ---- */

static void at_the_seam(void (*test)(void)) {
  if (seam_is_possible())
    test();
  else
    printf("(left out: no filter of system calls here) ");
}
static void slow_disk(void) {
  at_the_seam(slow);
}
static void slower_disk(void) {
  at_the_seam(slower_than_a_case);
}
static void stale_disk(void) {
  at_the_seam(stale);
}
static void rows_of_many(void) {
  at_the_seam(many_rows);
}

static void year(void) {
  at_the_seam(a_year);
}

static const vs_test TESTS[] = {{"a slow disk", slow_disk},
                                {"a disk that is slower than a case", slower_disk},
                                {"a disk that is gone from some call on", stale_disk},
                                {"a folder that is renamed", renamed},
                                {"many rows", rows_of_many},
                                {"a year's rows", year},
                                {"mounts", get_mounts},
                                {"a full disk", full},
                                {"a disk that is unmounted", unmounted}};

int main(void) {
  return program_suite("mounts", TESTS, COUNT(TESTS));
}
