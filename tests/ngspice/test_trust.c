/* SPDX-License-Identifier: GPL-3.0-or-later
 * Can the library be relied on: the probe says so of the one that is here, and says what is wrong
 * with each of some solvers that are wrong on purpose; what is remembered of it is used, and is not
 * used where it is not whole. And what versions of ngspice do differently comes to the same. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ngspice/ngspice.h"
#include "ngspice/self_test.h"
#include "ngspice/versions.h"
#include "program.h"

/* ---- solvers that are wrong on purpose: ngspice, and between it and the host a liar ---- */

static struct {
  vs_circuit_host host, lying;
  vs_circuit_job job;
  double end_s;
} liar;

static vs_status tell(double t_s, const double *signals, vs_error *err) {
  return liar.host.accept(liar.host.ctx, t_s, signals, err);
}
static double honest_source(void *ctx, size_t port, double t_s) {
  (void)ctx;
  return liar.host.source(liar.host.ctx, port, t_s);
}
static double honest_edge(void *ctx, double t_s) {
  (void)ctx;
  return liar.host.edge(liar.host.ctx, t_s);
}
static double honest_longest(void *ctx, double t_s) {
  (void)ctx;
  return liar.host.longest(liar.host.ctx, t_s);
}
static vs_status honest_accept(void *ctx, double t_s, const double *signals, vs_error *err) {
  (void)ctx;
  return tell(t_s, signals, err);
}

static vs_status without_end(void *ctx, double t_s, const double *signals, vs_error *err) {
  (void)ctx;
  return t_s > liar.end_s - 1e-9 ? VS_OK : tell(t_s, signals, err);
}
static vs_status twice(void *ctx, double t_s, const double *signals, vs_error *err) {
  (void)ctx;
  tell(t_s, signals, err);
  return t_s > 1e-3 ? tell(t_s + 1e-15, signals, err) : VS_OK;
}
static vs_status with_more_current(void *ctx, double t_s, const double *signals, vs_error *err) {
  (void)ctx;
  const double more[] = {signals[0], 1.001 * signals[1], signals[2], signals[3]};
  return tell(t_s, more, err);
}
static vs_status with_a_lossy_latch(void *ctx, double t_s, const double *signals, vs_error *err) {
  (void)ctx;
  const double more[] = {signals[0], signals[1], signals[2] + 0.1, signals[3]};
  return tell(t_s, more, err);
}
static double no_edge(void *ctx, double t_s) {
  (void)ctx, (void)t_s;
  return INFINITY;
}
static double longer(void *ctx, double t_s) {
  (void)ctx;
  return 2 * liar.host.longest(liar.host.ctx, t_s);
}
static double elsewhere(void *ctx, size_t port, double t_s) {
  (void)ctx;
  return liar.host.source(liar.host.ctx, port, fmax(t_s - 1e-7, 0));
}

static const struct lie {
  vs_circuit_host host;
  bool gear;
  const char *says;
} LIES[] = {
    {{.accept = without_end}, false, "its last step ends"},
    {{.accept = twice}, false, "which have no length"},
    {{.accept = with_more_current}, false, "the current of a coil is off by 0.001 of its peak"},
    {{.accept = with_a_lossy_latch}, false, "the energy books of a coil behind a latch leave 0.00"},
    {{.edge = no_edge}, false, "it steps over instants where a step must end"},
    {{.longest = longer}, false, "it takes steps longer than allowed"},
    {{.source = elsewhere}, false, "it asks its sources for other instants"},
    {{0}, true, "do not obey the trapezoidal rule"},
};
static const struct lie *told;

static vs_status load(const vs_circuit_job *job, const vs_circuit_host *host, void **circuit,
                      vs_error *err) {
  liar.host = *host;
  liar.job = *job;
  liar.end_s = job->until_s;
  liar.job.gear = told->gear;
  liar.job.max_step_s = told->host.longest ? 2 * job->max_step_s : job->max_step_s;
  liar.lying = told->host;
  if (!liar.lying.source) liar.lying.source = honest_source;
  if (!liar.lying.edge) liar.lying.edge = honest_edge;
  if (!liar.lying.longest) liar.lying.longest = honest_longest;
  if (!liar.lying.accept) liar.lying.accept = honest_accept;
  return vs_ngspice_kind.load(&liar.job, &liar.lying, circuit, err);
}
static vs_status go(void *circuit, vs_error *err) {
  return vs_ngspice_kind.run(circuit, err);
}
static void release(void *circuit) {
  vs_ngspice_kind.free(circuit);
}

static vs_status fails(void *circuit, vs_error *err) {
  (void)circuit;
  return vs_fail(err, VS_RUN, "t = 0.01 s: the solver gave up");
}

static void each_lie_is_told(void) {
  static const vs_circuit_kind LIAR = {.name = "a liar", .load = load, .run = go, .free = release};
  char wrong[VS_SELF_TEST_TEXT];
  for (size_t k = 0; k < COUNT(LIES); k++) {
    told = &LIES[k];
    vs_self_test_probe(&LIAR, wrong);
    EXPECT(strstr(wrong, LIES[k].says), "'%s' is not '%s'", wrong, LIES[k].says);
  }
  static const vs_circuit_kind FAILS = {
      .name = "one that fails", .load = load, .run = fails, .free = release};
  told = &LIES[0];
  vs_self_test_probe(&FAILS, wrong);
  EXPECT(!strcmp(wrong, "a small circuit fails: t = 0.01 s: the solver gave up"), "%s", wrong);
}

static void this_one_is_right(void) {
  char wrong[VS_SELF_TEST_TEXT];
  vs_self_test_probe(&vs_ngspice_kind, wrong);
  EXPECT(!*wrong, "ngspice %s: %s", vs_ngspice_running(), wrong);
}

/* ---- how a run ends ---- */

/* What ngspice 46 would do of itself: half of what is left, and again. */
static void halves_become_a_whole(void) {
  vs_last_steps e = {0};
  CU_ASSERT_EQUAL(vs_versions_step(&e, 8e-5, 4e-5), 4e-5);
  CU_ASSERT_EQUAL(vs_versions_step(&e, 4e-5, 2e-5), 4e-5);
  CU_ASSERT_EQUAL(vs_versions_step(&e, 3e-5, 1e-5), 1e-5); /* a third is no half */
  CU_ASSERT_EQUAL(vs_versions_step(&e, 2e-5, 1e-5), 1e-5);
  CU_ASSERT_EQUAL(vs_versions_step(&e, 1e-5, 1e-5), 1e-5);
  CU_ASSERT(!vs_versions_at_end(1e-14, 2.5e-5));
  CU_ASSERT(vs_versions_at_end(1.1e-11 * 2.5e-5, 2.5e-5));
  CU_ASSERT(vs_versions_at_end(-1e-20, 2.5e-5));
}

/* ---- what a line leaves out ---- */

static void pulses_are_completed(void) {
  static const struct {
    const char *line, *becomes; /* NULL: the line itself */
  } ROWS[] = {
      {"the title has a PULSE(0 1)", NULL},
      {"V1 a 0 PULSE(0 1 1m 1u 1u 1m 2m)", NULL},
      {"V1 a 0 PULSE(0 1 1m 1u 1u 1m)", "V1 a 0 PULSE( 0 1 1m 1u 1u 1m 0.25)"},
      {"v1 a 0 dc 0 pulse (0,{a*(b+1)} 1m) ac 1",
       "v1 a 0 dc 0 pulse ( 0 {a*(b+1)} 1m 0 0 0.25 0.25) ac 1"},
      {"I1 a 0 PULSE 0 1 0 0 0 0s 0.0 AC 1", "I1 a 0 PULSE ( 0 1 0 0 0 0.25 0.25) AC 1"},
      {"V1 a 0 PULSE(0 'x y' 0 1u 1u {w} 2m)", NULL},
      {"V1 a 0 PULSE(0 1 0 0 0 w0 p0)", NULL}, /* names */
      {"V1 pulse 0 5", NULL},
      {"V1 pulse 0 PULSE(0 1 0 1u 1u 0.5 10)", NULL},
      {"V1 a 0 PULSE(0)", NULL},
      {"B1 a 0 V=pulse(0 1)", NULL},
      {"V1 a 0 PULSE(0 1", "V1 a 0 PULSE( 0 1 0 0 0 0.25 0.25)"},
      {"V1", NULL},
      {"", NULL},
  };
  char *netlist[COUNT(ROWS)], *lines[COUNT(ROWS)];
  for (size_t k = 0; k < COUNT(ROWS); k++) netlist[k] = lines[k] = vs_copy(ROWS[k].line);
  vs_versions_complete(lines, COUNT(ROWS), 0.25);
  for (size_t k = 0; k < COUNT(ROWS); k++)
    EXPECT(!strcmp(lines[k], ROWS[k].becomes ? ROWS[k].becomes : ROWS[k].line), "'%s' became '%s'",
           ROWS[k].line, lines[k]);
  vs_versions_free(lines, netlist, COUNT(ROWS));
  for (size_t k = 0; k < COUNT(ROWS); k++) free(netlist[k]);
}

/* Which powers ngspice 47 takes for other numbers. */
static void powers_that_differ(void) {
  static const struct {
    const char *line;
    bool plain, pspice;
  } ROWS[] = {{"B1 a 0 V=pow(v(x),3)", true, true},
              {"B1 a 0 V=pow(abs(v(x)),3)", false, false},
              {"b1 a 0 i=V(x)**3", true, true},
              {"B1 a 0 V=v(x)**2+v(y)^4", false, false},
              {"B1 a 0 V=v(x)^2.5", true, true},
              {"B1 a 0 V={2**3}*v(x)", false, false},
              {"E1 a 0 vol='pwr(v(x),3)'", false, true},
              {"R1 a 0 {pow(-2,3)}", false, false},
              {"B1 a 0 V=1+pow( max(v(x),0),3)", false, false},
              {"", false, false}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    EXPECT(vs_versions_differ(ROWS[k].line, false) == ROWS[k].plain, "%s", ROWS[k].line);
    EXPECT(vs_versions_differ(ROWS[k].line, true) == ROWS[k].pspice, "%s, PSpice's", ROWS[k].line);
  }
}

/* A pulse without a period comes once, whichever version runs: the capacitor keeps what it got. */
static void a_pulse_comes_once(void) {
  write_file("once.cir",
             "*$ probe v_c = v(c) V\n*$ probe v_d = v(d) V\n"
             "V1 p 0 PULSE(0 5 0.1m 1u 1u 0.2m)\nR1 p c 1k\nC1 c 0 10n ic=0\n"
             "V2 q 0 PULSE(0 5 0.1m 1u)\nR2 q d 1k\nC2 d 0 10n ic=0\nRe e 0 1\nXeva e 0 eva\n");
  write_file("once.yaml", "circuit: {deck: once.cir}\nrun: {until: 1 ms, sample: 0.5 ms}\n"
                          "record: [v_c, v_d]\n");
  ran r = run("run once.yaml -o once --quiet");
  CU_ASSERT_EQUAL(r.status, 0);
  char *rows = read_file("once/run.csv"), *last = strstr(rows, "\n0.001,");
  double at_end[2] = {NAN, NAN};
  EXPECT(last && sscanf(last, "\n0.001,%lf,%lf", &at_end[0], &at_end[1]) == 2, "%s%s", r.err, rows);
  CLOSE_OF(at_end[0], 0, 5, 1e-6);
  CLOSE_OF(at_end[1], 5, 5, 1e-6);
  free(rows);
  free_ran(&r);
  remove_tree("once");
  remove("once.cir");
  remove("once.yaml");
}

/* ---- what is remembered ---- */

static const char RUN[] = "run short.yaml --json --reproducible";

/* The one file of the memory, read; "" where there is none. */
static char *memory(char path[512]) {
  char *names = listing("cache/vibrospice");
  snprintf(path, 512, "cache/vibrospice/%.*s", (int)strcspn(names, " "), names);
  free(names);
  return read_file(path);
}

static void set_up(void) {
  char folder[4096 - 16], cache[4096];
  remove_tree("cache");
  CU_ASSERT_PTR_NOT_NULL_FATAL(getcwd(folder, sizeof folder));
  snprintf(cache, sizeof cache, "%s/cache", folder);
  setenv("XDG_CACHE_HOME", cache, 1);
  write_file("short.yaml", "circuit: {deck: halfwave_bare}\nrun: {until: 1 ms}\n");
}

/* Probed once; a second start finds what came of it, and gives the same. */
static void a_verdict_is_remembered(void) {
  char path[512];
  set_up();
  ran first = run("%s", RUN);
  expect_good(&first, RUN, __LINE__);
  char *text = memory(path);
  EXPECT(strstr(text, "libngspice") && strstr(text, "\n\nend\n"), "%s", text);
  struct stat before, after;
  CU_ASSERT_EQUAL(stat(path, &before), 0);
  ran second = run("%s", RUN);
  expect_good(&second, RUN, __LINE__);
  CU_ASSERT_STRING_EQUAL(first.out, second.out);
  CU_ASSERT_EQUAL(stat(path, &after), 0);
  CU_ASSERT_EQUAL(before.st_ino, after.st_ino); /* it was not written again */
  free(text);
  free_ran(&first);
  free_ran(&second);
}

#define TOLD "not to be relied on: its twos are threes"

/* A command that prints results, or writes them to files. */
static const struct door {
  const char *words, *files[2];
} DOORS[] = {
    {"run short.yaml --json", {NULL}},
    {"run short.yaml -o out --quiet", {"out/summary.json", NULL}},
    {"sensitivity short.yaml --of i_peak --to supply.voltage", {NULL}},
    {"sensitivity short.yaml --of i_peak --to supply.voltage --json", {NULL}},
    {"sensitivity short.yaml --of i_peak --to supply.voltage -o out --quiet",
     {"out/sensitivity.csv", "out/summary.json"}},
    {"check short.yaml --json", {NULL}},
    {"check three.yaml --json", {NULL}},
    {"check " VS_TEST_FOLDER "/../spice/halfwave_bare.cir --json", {NULL}},
    {"check " VS_TEST_FOLDER "/../spice/parts/TYN1212.inc --json", {NULL}},
    {"check " VS_TEST_FOLDER "/../spice/parts/TYN1212.inc -o out --quiet",
     {"out/bench.csv", "out/bench.json"}},
    {"fit fit.yaml --json", {NULL}},
    {"fit fit.yaml -o out --quiet", {"out/fit.json", NULL}},
};

static void each_door_tells(void) {
  write_file("fit.yaml", "scene: short.yaml\nmeasures: {i_peak: {value: 0.2 mA, error: 5 %}}\n"
                         "free: {supply.voltage: {from: 300 V, to: 480 V}}\n");
  for (size_t k = 0; k < COUNT(DOORS); k++) {
    const struct door *d = &DOORS[k];
    ran r = run("%s", d->words);
    EXPECT(r.status == 0 && strstr(r.err, TOLD), "%s: %d: %s", d->words, r.status, r.err);
    EXPECT(*d->files || strstr(r.out, TOLD), "%s: %s", d->words, r.out);
    for (int f = 0; f < 2 && d->files[f]; f++) {
      char *text = read_file(d->files[f]);
      EXPECT(strstr(text, TOLD), "%s: %s: %s", d->words, d->files[f], text);
      free(text);
    }
    free_ran(&r);
    remove_tree("out");
  }
  remove("fit.yaml");
}

/* A library that was found wrong is told with its version and its file wherever warnings are. */
static void a_wrong_one_is_told(void) {
  char path[512], wanted[64];
  set_up();
  RUN_GOOD(RUN);
  char *text = memory(path), *end = strstr(text, "\n\nend\n");
  CU_ASSERT_PTR_NOT_NULL_FATAL(end);
  char *altered = vs_alloc(strlen(text) + 64, 1);
  sprintf(altered, "%.*s\nits twos\033are\nthrees\nend\n", (int)(end - text), text);
  write_file(path, altered);
  snprintf(wanted, sizeof wanted, "ngspice %s (", vs_ngspice_running());
  ran r = run("%s", RUN);
  EXPECT(r.status == 0 && strstr(r.err, "warning: ngspice") && strstr(r.err, wanted) &&
             strstr(r.err, "not to be relied on: its twos are threes"),
         "%d: %s", r.status, r.err);
  EXPECT(strstr(r.out, "not to be relied on: its twos are threes"), "%s", r.out);
  CU_ASSERT_EQUAL(count_lines(r.err), 1);
  free_ran(&r);
  r = run("%s --tier switched", "run paper --json --reproducible"); /* no ngspice, no warning */
  EXPECT(r.status == 0 && !*r.err && !strstr(r.out, "relied"), "%s%s", r.err, r.out);
  free_ran(&r);
  write_file("three.yaml", "scene: short.yaml\n"
                           "vary:\n  firing.angle: [90 deg, 100 deg, 110 deg]\n");
  r = run("study three.yaml -o out --jobs 1 --quiet");
  char *rows = read_file("out/study.csv");
  EXPECT(r.status == 0 && strstr(rows, "its twos are threes"), "%d: %s%s", r.status, r.err, rows);
  free_ran(&r);
  remove_tree("out");
  each_door_tells();
  remove("three.yaml");
  free(rows);
  free(altered);
  free(text);
}

/* What is not whole is not believed: the library is probed again, and found right. */
static void a_torn_memory_is_not_believed(void) {
  static const char *const TEXTS[] = {"", "vibrospice 0.0.1\nits twos are threes\nend\n",
                                      "its twos are threes\nend\n"};
  char path[512];
  set_up();
  RUN_GOOD(RUN);
  char *whole = memory(path);
  for (size_t k = 0; k < COUNT(TEXTS); k++) {
    write_file(path, TEXTS[k]);
    RUN_GOOD(RUN);
    char *again = read_file(path);
    CU_ASSERT_STRING_EQUAL(again, whole);
    free(again);
  }
  char *torn = vs_copy(whole);
  torn[strlen(torn) - 3] = '\0';
  write_file(path, torn);
  RUN_GOOD(RUN);
  free(torn);
  free(whole);
}

/* Where nothing can be remembered, runs go well nevertheless, and nothing is left anywhere. */
static void without_a_memory(void) {
  static const char *const HOMES[] = {"/nowhere/at/all", "relative", "", NULL};
  char *kept = getenv("HOME") ? vs_copy(getenv("HOME")) : NULL;
  set_up();
  setenv("XDG_CACHE_HOME", "/dev/null", 1);
  RUN_GOOD(RUN);
  unsetenv("XDG_CACHE_HOME");
  for (size_t k = 0; k < COUNT(HOMES); k++) {
    if (HOMES[k])
      setenv("HOME", HOMES[k], 1);
    else
      unsetenv("HOME");
    RUN_GOOD(RUN);
  }
  EXPECT_FILES(".", "short.yaml ");
  CU_ASSERT(access("/nowhere", F_OK));
  if (kept) setenv("HOME", kept, 1);
  free(kept);
}

int main(void) {
  static const vs_test TESTS[] = {{"this one is right", this_one_is_right},
                                  {"each lie is told", each_lie_is_told},
                                  {"halves become a whole", halves_become_a_whole},
                                  {"pulses are completed", pulses_are_completed},
                                  {"powers that differ", powers_that_differ},
                                  {"a pulse comes once", a_pulse_comes_once},
                                  {"a verdict is remembered", a_verdict_is_remembered},
                                  {"a wrong one is told", a_wrong_one_is_told},
                                  {"a torn memory is not believed", a_torn_memory_is_not_believed},
                                  {"without a memory", without_a_memory}};
  return program_suite("trust", TESTS, COUNT(TESTS));
}
