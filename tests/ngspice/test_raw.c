/* SPDX-License-Identifier: GPL-3.0-or-later
 * run --raw: the rawfile against run.csv of the same run, and in ngspice itself. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "program.h"
#include "ngspice/rawfile.h"

static const char GOOD_RUN[] = "events.csv peaks.csv run.csv run.raw summary.json ",
                  BROKEN_RUN[] = "run.partial.csv run.partial.raw ";

/* ---- a rawfile, read ---- */

enum { MOST_VECTORS = 64 };

typedef struct raw {
  char *bytes;
  size_t size;
  int vectors;
  long points;  /* as its head says */
  double rest;  /* points that the bytes behind the head make */
  double *data; /* [points][vectors] */
  char names[MOST_VECTORS][64], types[MOST_VECTORS][16];
} raw;

static raw read_raw(const char *path) {
  raw r = {0};
  FILE *f = fopen(path, "rb");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  fseek(f, 0, SEEK_END);
  r.size = (size_t)ftell(f);
  rewind(f);
  r.bytes = vs_alloc(r.size + 1, 1);
  CU_ASSERT_EQUAL(fread(r.bytes, 1, r.size, f), r.size);
  fclose(f);
  const char *line = strstr(r.bytes, "Variables:\n"), *begin = strstr(r.bytes, "\nBinary:\n");
  CU_ASSERT_FATAL(line && begin);
  begin += strlen("\nBinary:\n");
  CU_ASSERT_PTR_NOT_NULL(strstr(r.bytes, "\nFlags: real\n"));
  sscanf(strstr(r.bytes, "No. Variables:"), "No. Variables: %d\nNo. Points: %ld", &r.vectors,
         &r.points);
  CU_ASSERT_FATAL(r.vectors > 1 && r.vectors <= MOST_VECTORS);
  for (int k = 0; k < r.vectors; k++) {
    int number = -1;
    line = strchr(line, '\n') + 1;
    CU_ASSERT_EQUAL(sscanf(line, "\t%d\t%63s\t%15s\n", &number, r.names[k], r.types[k]), 3);
    CU_ASSERT_EQUAL(number, k);
  }
  size_t left = r.size - (size_t)(begin - r.bytes);
  r.rest = (double)left / ((double)r.vectors * sizeof(double));
  r.data = vs_alloc(left + 1, 1);
  memcpy(r.data, begin, left);
  return r;
}

static void free_raw(raw *r) {
  free(r->bytes);
  free(r->data);
}

/* What every one of them is: its points are there and rise in time. */
static void expect_whole(const raw *r, const char *what, int line) {
  bool rises = r->rest == (double)r->points && r->points > 0 && r->data[0] > 0;
  for (long k = 1; rises && k < r->points; k++)
    rises = r->data[k * r->vectors] > r->data[(k - 1) * r->vectors];
  expect(rises, line, "%s: %ld points in the head, %.17g in the file", what, r->points, r->rest);
}
#define EXPECT_WHOLE(r, what) expect_whole(r, what, __LINE__)

/* Value at t on the straight line between two points; name: "v(a)"; "" for 0. */
static double raw_at(const raw *r, const char *name, double t) {
  if (!*name) return 0;
  long hi = 1;
  int vector = 0;
  while (vector < r->vectors && strcmp(r->names[vector], name)) vector++;
  CU_ASSERT_FATAL(vector < r->vectors);
  while (hi < r->points - 1 && r->data[hi * r->vectors] < t) hi++;
  const double *b = r->data + hi * r->vectors, *a = b - r->vectors;
  return a[vector] + (b[vector] - a[vector]) * (t - a[0]) / (b[0] - a[0]);
}

/* ---- the tests ---- */

/* The deck's probes are straight lines between steps (engine/step.h), so run.csv and the rawfile must
 * agree to rounding at each sample. Row 0 has no point before it. */
static void agrees_with_the_table(void) {
  static const struct {
    const char *column, *plus, *minus;
    double sign;
  } ROWS[] = {{"v_ak_v", "v(a)", "v(b)", 1},
              {"i_thyristor_a", "i(vthy)", "", 1},
              {"v_c1_v", "v(c1p)", "v(b)", 1},
              {"v_c2_v", "v(c2p)", "", 1},
              {"i_source_a", "i(vmains)", "", -1}};
  double worst[COUNT(ROWS)] = {0}, peak[COUNT(ROWS)] = {0};
  RUN_GOOD("run paper -o out --raw --digits 17 --quiet --set run.until=0.03s "
           "--set record=[v_ak,i_thyristor,v_c1,v_c2,i_source]");
  EXPECT_FILES("out", GOOD_RUN);
  raw r = read_raw("out/run.raw");
  EXPECT_WHOLE(&r, "run.raw");
  CU_ASSERT_STRING_EQUAL(r.names[0], "time");
  CU_ASSERT_STRING_EQUAL(r.types[0], "time");
  CLOSE(r.data[(r.points - 1) * r.vectors], 0.03, 1e-12); /* ngspice's sum of steps */
  for (int k = 1; k < r.vectors; k++)
    EXPECT(!strcmp(r.types[k], r.names[k][0] == 'i' ? "current" : "voltage"), "%s is a %s",
           r.names[k], r.types[k]);
  char *csv = read_file("out/run.csv"), *rest = csv, *header = strsep(&rest, "\n");
  CU_ASSERT_STRING_EQUAL(header, "t_s,v_ak_v,i_thyristor_a,v_c1_v,v_c2_v,i_source_a");
  strsep(&rest, "\n");
  int rows = 0;
  for (char *row; (row = strsep(&rest, "\n")) && *row; rows++) {
    double t = strtod(row, &row);
    for (size_t k = 0; k < COUNT(ROWS); k++) {
      double value = strtod(row + 1, &row);
      double other = ROWS[k].sign * (raw_at(&r, ROWS[k].plus, t) - raw_at(&r, ROWS[k].minus, t));
      worst[k] = fmax(worst[k], fabs(value - other));
      peak[k] = fmax(peak[k], fabs(value));
    }
  }
  CU_ASSERT_EQUAL(rows, 300);
  for (size_t k = 0; k < COUNT(ROWS); k++) /* the two lines are rounded in another order */
    EXPECT(peak[k] > 0 && worst[k] <= 1e-9 * peak[k], "%s: off by %.3g of %.3g", ROWS[k].column,
           worst[k], peak[k]);
  free(csv);
  free_raw(&r);
}

/* Points of a run are its steps. */
static long steps_of(const char *summary) {
  char *json = read_file(summary);
  const char *at = strstr(json, "\"steps\": ");
  long steps = at ? strtol(at + 9, NULL, 10) : -1;
  free(json);
  return steps;
}

static double value_of(const char *summary, const char *measure) {
  char *json = read_file(summary), name[64];
  snprintf(name, sizeof name, "\"%s\": {\"value\": ", measure);
  const char *at = strstr(json, name);
  double value = at ? strtod(at + strlen(name), NULL) : NAN;
  free(json);
  return value;
}

/* ngspice loads it and finds in it what summary.json says. */
static void ngspice_loads_it(void) {
  RUN_GOOD("run paper -o out --raw --quiet --set run.until=0.03s");
  write_file("load.cir", "* reads a rawfile\n.control\nload out/run.raw\nset numdgt=12\n"
                         "let v_ak = v(a)-v(b)\n"
                         "print minimum(v_ak) maximum(v_ak) maximum(i(vthy)) length(time)\n"
                         "quit 0\n.endc\n.end\n");
  FILE *ngspice = popen("ngspice -n -b load.cir 2>../ngspice_stderr", "r");
  CU_ASSERT_PTR_NOT_NULL_FATAL(ngspice);
  double least = NAN, most = NAN, current = NAN, length = NAN;
  for (char line[512]; fgets(line, sizeof line, ngspice);) {
    sscanf(line, "minimum(v_ak) = %lf", &least);
    sscanf(line, "maximum(v_ak) = %lf", &most);
    sscanf(line, "maximum(i(vthy)) = %lf", &current);
    sscanf(line, "length(time) = %lf", &length);
  }
  CU_ASSERT_EQUAL(pclose(ngspice), 0);
  CU_ASSERT_EQUAL(length, (double)steps_of("out/summary.json"));
  CLOSE(least, value_of("out/summary.json", "v_ak_min"), 1e-10); /* both print 12 digits */
  CLOSE(most, value_of("out/summary.json", "v_ak_max"), 1e-10);
  CLOSE(current, value_of("out/summary.json", "i_thyristor_max"), 1e-10);
}

static void the_same_bytes_each_time(void) {
  RUN_GOOD("run paper -o out --raw --quiet --set run.until=0.01s");
  RUN_GOOD("run paper -o again --raw --quiet --set run.until=0.01s");
  raw a = read_raw("out/run.raw"), b = read_raw("again/run.raw");
  CU_ASSERT(a.size == b.size && !memcmp(a.bytes, b.bytes, a.size));
  CU_ASSERT_EQUAL(a.points, steps_of("out/summary.json"));
  free_raw(&a);
  free_raw(&b);
  remove_tree("again");
}

static void auto_takes_the_circuit_tier(void) {
  ran r = run("run paper -o out --raw --set run.until=0.01s");
  expect_good(&r, "--raw", __LINE__);
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "circuit (auto: --raw asks for it)"));
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "run.raw in out"));
  char *csv = read_file("out/run.csv"); /* with the deck's probes */
  CU_ASSERT(strstr(csv, ",v_ak_v,") && strstr(csv, ",v_ak_v,") < strchr(csv, '\n'));
  free(csv);
  free_ran(&r);
  r = run("run paper -o out --raw --set run.until=0.01s --set circuit.r1=220ohm --tier auto");
  expect_good(&r, "--raw, and a scene that asks", __LINE__);
  CU_ASSERT_PTR_NOT_NULL(strstr(r.out, "auto: the scene names circuit.r1"));
  free_ran(&r);
  remove_tree("out");
}

static void bad_commands_are_refused(void) {
  static const struct {
    const char *words, *at, *says[2];
  } ROWS[] = {
      {"run s.yaml --raw", "--raw: ", {"-o DIR", NULL}},
      {"run s.yaml --raw -o out --tier switched", "--raw: ", {"tier switched", "by --tier"}},
      {"run s.yaml --raw -o out --tier analytic", "--raw: ", {"tier analytic", "by --tier"}},
      {"run s.yaml --raw -o out --set run.tier=switched",
       "--set run.tier=switched: --raw: ",
       {"switched", "by run.tier"}},
      {"run s.yaml --raw -o out", "s.yaml:1:18: ", {"1e-09", "tier circuit"}},
      {"run s.yaml --raw=x -o out", "", {"--raw", NULL}},
      {"modes s.yaml --raw", "", {"--raw", NULL}},
  };
  write_file("s.yaml", "run: {tolerance: 1e-9}\n");
  for (size_t k = 0; k < COUNT(ROWS); k++)
    refuse(ROWS[k].words, ROWS[k].words, ROWS[k].at, ROWS[k].says, __LINE__);
}

/* A run that fails leaves what it has, with its true number of points. */
static void a_failed_run_leaves_its_part(void) {
  write_file("s.yaml", "actuator: {gap: 1 mm}\nrun: {until: 0.1 s}\n");
  ran r = run("run s.yaml -o out --raw");
  double t = NAN;
  sscanf(r.err, "vibrospice: t = %lf s: ", &t);
  EXPECT(r.status == 1 && count_lines(r.err) == 1 &&
             strstr(r.err, "what was computed is in out/run.partial.csv and run.partial.raw"),
         "status %d: %s", r.status, r.err);
  free_ran(&r);
  EXPECT_FILES("out", BROKEN_RUN);
  raw part = read_raw("out/run.partial.raw");
  EXPECT_WHOLE(&part, "run.partial.raw");
  double last = part.data[(part.points - 1) * part.vectors];
  EXPECT(last > t - 1e-4 && last < t, "%.9g s of %.9g s", last, t); /* within a step of 25 us */
  free_raw(&part);
  remove_tree("out");
}

/* What an older run left that the new one's files would contradict is gone. */
static void older_files_go(void) {
  static const struct {
    const char *first, *second, *left;
  } ROWS[] = {{"s.yaml --raw", "paper", "events.csv run.csv summary.json "},
              {"s.yaml --raw", "paper --raw", GOOD_RUN},
              {"s.yaml --raw", "s.yaml", "run.partial.csv "},
              {"paper --raw", "paper", "events.csv run.csv summary.json "},
              {"paper --raw", "s.yaml", "run.partial.csv "},
              {"paper --raw", "s.yaml --raw", BROKEN_RUN}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran first = run("run %s -o out --set run.until=0.01s", ROWS[k].first),
        second = run("run %s -o out --set run.until=0.01s", ROWS[k].second);
    EXPECT(first.status == (*ROWS[k].first == 's') && second.status == (*ROWS[k].second == 's'),
           "%s, %s: %d, %d", ROWS[k].first, ROWS[k].second, first.status, second.status);
    EXPECT_FILES("out", ROWS[k].left);
    free_ran(&first);
    free_ran(&second);
    remove_tree("out");
  }
}

/* The program handles signals before it makes its folder. */
static void a_signal_leaves_its_part(void) {
  const struct timespec while_it_runs = {0, 300000000}, nap = {0, 5000000};
  char words[] = "run paper -o out --raw --set run.until=200s --set limits.raw=1e10";
  const char *argv[MOST_WORDS];
  split(words, argv);
  pid_t child = spawn(argv);
  for (int n = 0; n < 4000 && access("out", F_OK); n++) nanosleep(&nap, NULL);
  nanosleep(&while_it_runs, NULL);
  kill(child, SIGTERM);
  ran r = collect(child);
  EXPECT(r.status == 75, "status %d: %s", r.status, r.err);
  free_ran(&r);
  EXPECT_FILES("out", BROKEN_RUN);
  raw part = read_raw("out/run.partial.raw");
  EXPECT_WHOLE(&part, "run.partial.raw");
  free_raw(&part);
  remove_tree("out");
}

/* The rawfile is the first that fills it; what fits is kept. */
static void a_full_disk_is_an_error(void) {
  struct rlimit before, small;
  getrlimit(RLIMIT_FSIZE, &before);
  small = before;
  small.rlim_cur = 200000;
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  ran r = run("run paper -o out --raw --set run.until=0.2s --set record=p");
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT(r.status == 1 && count_lines(r.err) == 1 && !strncmp(r.err, "vibrospice: t = 0.0", 19) &&
             strstr(r.err, "the rawfile cannot be written: File too large"),
         "status %d: %s", r.status, r.err);
  free_ran(&r);
  EXPECT_FILES("out", "run.partial.csv ");
  remove_tree("out");
}

/* The writer by itself: every byte, and a device that takes none. */
static void the_writer(void) {
  static const char *const NAMES[] = {"time", "a", "vthy#branch"};
  static const char HEAD[] = "Title: one line\nPlotname: Transient Analysis\nFlags: real\n"
                             "No. Variables: 3\nNo. Points: 2           \nVariables:\n"
                             "\t0\ttime\ttime\n\t1\tv(a)\tvoltage\n\t2\ti(vthy)\tcurrent\n"
                             "Binary:\n";
  static const double POINTS[] = {0.25, -1, 3, 0.5, 1e-300, -0.0};
  char expected[sizeof HEAD - 1 + sizeof POINTS];
  vs_error err = {0};
  memcpy(expected, HEAD, sizeof HEAD - 1);
  memcpy(expected + sizeof HEAD - 1, POINTS, sizeof POINTS);
  FILE *f = fopen("two.raw", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  vs_rawfile w = vs_rawfile_begin(f, "one line\nCommand: shell x", NAMES, COUNT(NAMES));
  CU_ASSERT_EQUAL(vs_rawfile_point(&w, POINTS, &err), VS_OK);
  CU_ASSERT_EQUAL(vs_rawfile_point(&w, POINTS + 3, &err), VS_OK);
  CU_ASSERT_EQUAL(vs_rawfile_end(&w, &err), VS_OK);
  CU_ASSERT_EQUAL(fclose(f), 0);
  raw r = read_raw("two.raw");
  CU_ASSERT(r.size == sizeof expected && !memcmp(r.bytes, expected, sizeof expected));
  free_raw(&r);
  f = fopen("/dev/full", "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  w = vs_rawfile_begin(f, "", NAMES, COUNT(NAMES));
  CU_ASSERT_EQUAL(vs_rawfile_end(&w, &err), VS_RUN);
  CU_ASSERT_PTR_NOT_NULL(strstr(err.text, "the rawfile cannot be written: No space left"));
  fclose(f);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"the writer", the_writer},
      {"agrees with run.csv", agrees_with_the_table},
      {"the same bytes each time", the_same_bytes_each_time},
      {"auto takes the circuit tier", auto_takes_the_circuit_tier},
      {"bad commands are refused", bad_commands_are_refused},
      {"a failed run leaves its part", a_failed_run_leaves_its_part},
      {"older files go", older_files_go},
      {"a signal leaves its part", a_signal_leaves_its_part},
      {"a full disk is an error", a_full_disk_is_an_error},
      {"ngspice loads it", ngspice_loads_it}, /* where there is one */
  };
  return program_suite("rawfile", TESTS, COUNT(TESTS) - !on_path("ngspice"));
}
