/* SPDX-License-Identifier: GPL-3.0-or-later
 * The library for programs of others, over the built program: what a run through it comes to,
 * states and inputs, and what it says where it is misused. */
#include <dlfcn.h>
#include <errno.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "program.h"
#include "vibrospice/vibrospice.h"

static void expect_ok(vibrospice_status status, int line) {
  expect(status == VIBROSPICE_OK, line, "status %d: %s", (int)status, vibrospice_error());
}
#define OK(call) expect_ok(call, __LINE__)

/* The call fails with that status, and its text has those words. */
static void expect_fails(vibrospice_status status, vibrospice_status wanted, const char *words,
                         int line) {
  expect(status == wanted && strstr(vibrospice_error(), words), line, "status %d, not %d: %s",
         (int)status, (int)wanted, vibrospice_error());
}
#define FAILS(call, wanted, words) expect_fails(call, wanted, words, __LINE__)

static vibrospice *open_scene(const char *scene, const char *tier, const char *until) {
  vibrospice *run;
  OK(vibrospice_open(scene, strchr(scene, '\n') ? VIBROSPICE_TEXT : 0, &run));
  OK(vibrospice_set(run, "run.tier", tier));
  OK(vibrospice_set(run, "run.until", until));
  return run;
}

static double column(vibrospice *run, const char *name) {
  const vibrospice_column *c;
  const double *value;
  size_t count;
  OK(vibrospice_columns(run, &c, &count));
  OK(vibrospice_values(run, &value, &count));
  for (size_t k = 0; k < count; k++)
    if (!strcmp(c[k].name, name)) return value[k];
  return NAN;
}

static void expect_no_child(int line) {
  errno = 0;
  pid_t left = waitpid(-1, NULL, WNOHANG);
  expect(left < 0 && errno == ECHILD, line, "a child is left: %d", (int)left);
}

/* ---- what programs were built with ---- */

/* On machines with pointers and sizes of 64 bits. Another size, or another number, is another
 * interface: VIBROSPICE_MINOR goes up while MAJOR is 0. */
static void sizes(void) {
  if (sizeof(void *) != 8) return;
  EXPECT(sizeof(vibrospice_column) == 40, "column: %zu", sizeof(vibrospice_column));
  EXPECT(sizeof(vibrospice_input) == 48, "input: %zu", sizeof(vibrospice_input));
  EXPECT(sizeof(vibrospice_measure) == 64, "measure: %zu", sizeof(vibrospice_measure));
  EXPECT(sizeof(vibrospice_line) == 88, "line: %zu", sizeof(vibrospice_line));
  EXPECT(sizeof(vibrospice_happening) == 56, "happening: %zu", sizeof(vibrospice_happening));
  EXPECT(sizeof(vibrospice_status) == 4, "status: %zu", sizeof(vibrospice_status));
  EXPECT(!strcmp(vibrospice_version(), VS_VERSION), "%s", vibrospice_version());
}

static void symbols(void) {
  static const char NAMES[] =
      "columns error finish folder free free_state happened inputs measures not_judged open "
      "restore "
      "run_on run_to save set set_input summary time values verdict version ";
  FILE *nm =
      popen("nm -D --defined-only '" VS_LIBVIBROSPICE
            "' | sed -n 's/.* [A-Z] vibrospice_/ /p;t;s/.* [A-Z] \\(_[a-z]*\\|__.*\\)$//p;t;p'"
            " | grep . | tr -d ' ' | tr '\\n' ' '",
            "r");
  char names[1024] = "";
  const size_t size = fread(names, 1, sizeof names - 1, nm);
  pclose(nm);
  names[size] = '\0';
  EXPECT(!strcmp(names, NAMES), "the library exports: %s", names);
}

/* ---- the same as the command line's ---- */

typedef struct seen {
  int rows, stop_at;
  double last_s;
  vibrospice *run; /* to be misused */
} seen;

static int see_row(void *context, const double *value, size_t count) {
  seen *s = context;
  s->rows++;
  EXPECT(value[0] > s->last_s && count > 4, "row %d at %g s", s->rows, value[0]);
  s->last_s = value[0];
  return s->rows == s->stop_at;
}

/* Runs with pauses at instants that are no rows, and in rows; writes the folder "by". */
static void run_in_pieces(const char *scene, const char *tier, const char *until, int line) {
  seen s = {.last_s = -1, .stop_at = 300};
  vibrospice *by = open_scene(scene, tier, until);
  char words[256];
  const char *summary;
  double t_s, until_s;
  OK(vibrospice_folder(by, "by"));
  FAILS(vibrospice_run_on(by, see_row, &s), VIBROSPICE_STOPPED, "stopped by the callback");
  OK(vibrospice_time(by, &t_s, &until_s));
  expect(t_s == s.last_s && s.rows == 300 && fabs(t_s - 0.0299) < 1e-12, line, "stopped at %.12g",
         t_s);
  for (int k = 1; k < 40; k++) OK(vibrospice_run_to(by, 0.03 + k * 0.000777, see_row, &s));
  OK(vibrospice_run_on(by, see_row, &s));
  OK(vibrospice_finish(by));
  OK(vibrospice_summary(by, &summary));
  char *file = read_file("by/summary.json");
  EXPECT(!strcmp(file, summary), "another summary: %.200s", summary);
  free(file);
  snprintf(words, sizeof words,
           "run %s --set run.tier=%s --until %s --reproducible --quiet -o there", scene, tier,
           until);
  ran r = run("%s", words);
  expect(r.status == 0 || r.status == 3, line, "status %d: %s", r.status, r.err);
  free_ran(&r);
  expect(!system("diff -r by there >../differs 2>&1"), line, "%s: see differs", tier);
  char *csv = read_file("by/run.csv");
  expect(s.rows == count_lines(csv) - 1, line, "%d rows", s.rows);
  free(csv);
  OK(vibrospice_free(by));
  expect_no_child(line);
  EXPECT(!system("rm -r by there"), "still there");
}

static void same_files(void) {
  run_in_pieces("paper", "switched", "0.1s", __LINE__);
  run_in_pieces("paper", "circuit", "0.1s", __LINE__);
  run_in_pieces("control_setpoint", "switched", "0.1s", __LINE__);
}

/* Measures, verdict, what happened and what is not judged, against summary.json. */
static void same_result(void) {
  const vibrospice_measure *m;
  const vibrospice_line *v;
  const vibrospice_happening *h;
  const char *const *n, *json, *breach;
  char text[256];
  size_t count, lines = 0, judged = 0;
  int held;
  vibrospice *run = open_scene("feeder", "auto", "0.1 s");
  OK(vibrospice_finish(run));
  OK(vibrospice_summary(run, &json));
  OK(vibrospice_measures(run, &m, &count));
  EXPECT(count > 60, "%zu measures", count);
  for (size_t k = 0; k < count; k++) {
    double told = measure_in(json, m[k].name);
    EXPECT(fabs(told - m[k].value) <= 1e-11 * fabs(told), "%s: %.15g, not %.15g", m[k].name,
           m[k].value, told); /* 12 digits are told */
    judged += *m[k].word != '\0' && m[k].margin <= 1;
  }
  EXPECT(judged > 5, "%zu measures are judged", judged);
  OK(vibrospice_verdict(run, &v, &count, &held, &breach));
  for (const char *at = json; (at = strstr(at, "\"failed_at_s\"")); at++) lines++;
  EXPECT(count == lines && count > 10, "%zu lines of %zu", count, lines);
  EXPECT(!held == (*breach != '\0'), "held %d: %s", held, breach);
  for (size_t k = 0; k < count; k++) {
    snprintf(text, sizeof text, "\"word\": \"%s\"", v[k].word);
    EXPECT(strstr(json, text) && *v[k].name && v[k].least < v[k].most, "%s %s %g..%g", v[k].name,
           v[k].word, v[k].least, v[k].most);
  }
  OK(vibrospice_happened(run, &h, &count));
  EXPECT(!count || strstr(json, h[0].what), "%zu happened", count);
  OK(vibrospice_not_judged(run, &n, &count));
  EXPECT(count && strstr(strstr(json, "\"not_judged\""), n[count - 1]), "%zu are not judged",
         count);
  OK(vibrospice_free(run));
}

/* ---- states ---- */

static void rolls_back(const char *tier, int line) {
  vibrospice_state *state, *later;
  const vibrospice_measure *m;
  vibrospice *run = open_scene("paper", tier, "0.12 s"), *other;
  size_t count;
  OK(vibrospice_folder(run, "first"));
  OK(vibrospice_run_to(run, 0.0437, NULL, NULL));
  OK(vibrospice_save(run, &state));
  OK(vibrospice_run_to(run, 0.08, NULL, NULL));
  const double p = column(run, "p_m"), i = column(run, "i_a");
  OK(vibrospice_save(run, &later));
  OK(vibrospice_finish(run));
  OK(vibrospice_measures(run, &m, &count));
  const double peak = m[0].value;
  OK(vibrospice_open("two_mass", 0, &other));
  for (int k = 0; k < 3; k++) { /* the finished run, then another scene's, then the same again */
    vibrospice *to = k == 1 ? other : run;
    OK(vibrospice_restore(to, state));
    OK(vibrospice_run_to(to, 0.08, NULL, NULL));
    expect(column(to, "p_m") == p && column(to, "i_a") == i, line, "%s: p = %.17g, not %.17g", tier,
           column(to, "p_m"), p);
  }
  OK(vibrospice_restore(run, later));
  FAILS(vibrospice_run_to(run, 0.05, NULL, NULL), VIBROSPICE_TIME, "only a saved state goes back");
  EXPECT(!system("mkdir second && cp first/*.* second && rm first/*.*"), "no first");
  OK(vibrospice_finish(run));
  OK(vibrospice_measures(run, &m, &count));
  expect(m[0].value == peak, line, "%s: %s = %.17g, not %.17g", tier, m[0].name, m[0].value, peak);
  expect(!system("for f in second/*; do cmp $f first/${f##*/} || exit 1; done"), line,
         "%s: other files", tier);
  OK(vibrospice_free(other));
  OK(vibrospice_free_state(state));
  FAILS(vibrospice_restore(run, state), VIBROSPICE_HANDLE, "no such state");
  OK(vibrospice_free(run));
  OK(vibrospice_free_state(later));
  expect_no_child(line);
  /* A copy is nobody's child: that it has ended shows in its files. */
  expect(!system("n=0; while ls -A first | grep -q ^[.]; do sleep 0.05; n=$((n + 1)); "
                 "test $n -lt 100 || exit 1; done"),
         line, "%s: files of a state are left", tier);
  EXPECT(!system("rm -r first second"), "no files");
}

static void states(void) {
  rolls_back("switched", __LINE__);
  rolls_back("circuit", __LINE__);
  rolls_back("compiled", __LINE__);
}

/* ---- inputs ---- */

#define LOADED                                                                                     \
  "supply: {voltage: 440 V}\nload: {density: 1.6 g/cm3, fraction: 0.3}\n"                          \
  "actuator: {stop: {stiffness: 1e7 N/m, damping: 300 N.s/m}}\n"

/* What is set during a run is what the scene's events and profile say of the same instants. */
static void as_events(const char *tier, int line) {
  static const char EVENTS[] =
      LOADED "firing: {angle: [[0 s, 120 deg], [73.3 ms, 120 deg], [73.3 ms, 110 deg]], every: 1}\n"
             "events: {s: {kind: sag, at: 73.3 ms, duration: 1000 s, level: 80 %}, "
             "l: {kind: load, at: 73.3 ms, volume: 500 cm3, fraction: 0.5}}\n";
  vibrospice *one = open_scene(EVENTS, tier, "0.16 s"),
             *two = open_scene(LOADED "firing: {angle: 90 deg, every: 1}\n", tier, "0.16 s");
  OK(vibrospice_set_input(two, "firing.angle", 120));
  OK(vibrospice_set_input(two, "supply.voltage", 440));
  OK(vibrospice_set_input(two, "load.volume", 380));
  OK(vibrospice_set_input(two, "load.fraction", 0.3));
  OK(vibrospice_run_to(two, 0.0733, NULL, NULL));
  OK(vibrospice_set_input(two, "firing.angle", 110));
  OK(vibrospice_set_input(two, "supply.voltage", 0.8 * 440));
  OK(vibrospice_set_input(two, "load.volume", 500));
  OK(vibrospice_set_input(two, "load.fraction", 0.5));
  OK(vibrospice_run_to(one, 0.15, NULL, NULL));
  OK(vibrospice_run_to(two, 0.15, NULL, NULL));
  const double p = column(one, "p_m"), other = column(two, "p_m");
  /* The ideal tiers are exact, to the rounding of other sums; a solver takes other steps, and keeps
   * run.tolerance, 1e-4 of the peak of 3.4 mm. */
  const double allowed = strcmp(tier, "switched") != 0 ? 3.4e-7 : 1e-9 * fabs(p);
  expect(fabs(p - other) <= allowed, line, "%s: p = %.17g, not %.17g", tier, other, p);
  expect(fabs(column(one, "v_mains_v") - column(two, "v_mains_v")) < 1e-9, line, "%s: other mains",
         tier);
  expect(fabs(column(two, "firing_angle_rad") - 110 * M_PI / 180) < 1e-12, line, "the angle is %g",
         column(two, "firing_angle_rad"));
  OK(vibrospice_finish(one));
  OK(vibrospice_finish(two)); /* whose second run has the same inputs, or its margins would break */
  OK(vibrospice_free(one));
  OK(vibrospice_free(two));
}

static void inputs(void) {
  as_events("switched", __LINE__);
  as_events("circuit", __LINE__);
  as_events("compiled", __LINE__);
}

/* A second run without the inputs would have other extremes, and so another error of the margin. */
static void second_run(void) {
  const vibrospice_line *v;
  size_t count;
  vibrospice *run = open_scene(LOADED "firing: {angle: 120 deg, every: 1}\n"
                                      "ratings: {p_max: .. 20 mm}\n",
                               "switched", "0.2 s");
  OK(vibrospice_set_input(run, "firing.angle", 120));
  OK(vibrospice_set_input(run, "supply.voltage", 440));
  OK(vibrospice_run_to(run, 0.05, NULL, NULL));
  OK(vibrospice_set_input(run, "firing.angle", NAN));
  OK(vibrospice_set_input(run, "supply.voltage", 200));
  OK(vibrospice_finish(run));
  OK(vibrospice_verdict(run, &v, &count, NULL, NULL));
  EXPECT(count == 1 && v[0].error < 0.01 && !strcmp(v[0].word, "held"), "%zu lines: %s +- %g",
         count, count ? v[0].word : "", count ? v[0].error : NAN);
  OK(vibrospice_free(run));
}

static void wrong_inputs(void) {
  const vibrospice_input *in;
  size_t count;
  vibrospice *run = open_scene("paper", "switched", "0.1 s");
  OK(vibrospice_inputs(run, &in, &count));
  EXPECT(count == 4 && !strcmp(in[0].name, "supply.voltage") && in[0].value == 440, "%zu inputs",
         count);
  FAILS(vibrospice_set_input(run, "firing.angle", 90), VIBROSPICE_INPUT, "firing.every");
  FAILS(vibrospice_set_input(run, "supply.voltag", 90), VIBROSPICE_INPUT, "did you mean");
  FAILS(vibrospice_set_input(run, "supply.voltage", NAN), VIBROSPICE_INPUT, "allowed: 0 to 1320");
  FAILS(vibrospice_set_input(run, NULL, 0), VIBROSPICE_INPUT, "NULL");
  OK(vibrospice_run_to(run, 0.01, NULL, NULL));
  FAILS(vibrospice_set_input(run, "supply.voltage", 90), VIBROSPICE_INPUT, "before the run began");
  OK(vibrospice_free(run));
  run = open_scene(LOADED "firing: {angle: 120 deg, every: 1}\n", "switched", "0.1 s");
  OK(vibrospice_set_input(run, "load.volume", 380));
  OK(vibrospice_set_input(run, "load.fraction", 0.3));
  OK(vibrospice_run_to(run, 0.01, NULL, NULL));
  FAILS(vibrospice_set_input(run, "load.volume", 1e9), VIBROSPICE_INPUT, "mass");
  OK(vibrospice_set_input(run, "load.fraction", 0.4)); /* with the volume before */
  FAILS(vibrospice_set(run, "load.volume", "100 cm3"), VIBROSPICE_ORDER, "begun");
  OK(vibrospice_free(run));
  run = open_scene(LOADED "firing: {angle: 175 deg, every: 1, pulse_width: 1 ms}\n", "switched",
                   "0.1 s");
  OK(vibrospice_set_input(run, "supply.voltage", 100));
  OK(vibrospice_set_input(run, "supply.voltage", 440)); /* as before: no 3 times 100 */
  FAILS(vibrospice_set(run, "supply.voltage", "400 V"), VIBROSPICE_INPUT, "set it so again");
  OK(vibrospice_set_input(run, "supply.frequency", 60));
  FAILS(vibrospice_set_input(run, "supply.frequency", 0), VIBROSPICE_INPUT, "allowed: 0.1 to");
  OK(vibrospice_set_input(run, "firing.angle", 175)); /* beyond the 170 deg of control.angle */
  OK(vibrospice_set_input(run, "load.fraction", 0.3));
  FAILS(vibrospice_set(run, "load.fraction", "auto"), VIBROSPICE_INPUT, "would be none");
  FAILS(vibrospice_set(run, "firing.angle", "90 deg"), VIBROSPICE_INPUT, "set it so again");
  OK(vibrospice_run_to(run, 0.05, NULL, NULL));
  const double p = column(run, "p_m");
  FAILS(vibrospice_set_input(run, "supply.frequency", 61), VIBROSPICE_INPUT, "cannot change");
  OK(vibrospice_free(run));
  run = open_scene(LOADED "firing: {angle: 175 deg, every: 1, pulse_width: 1 ms}\n", "switched",
                   "0.1 s");
  OK(vibrospice_set(run, "supply.frequency", "60 Hz"));
  OK(vibrospice_set(run, "supply.voltage", "440 V"));
  OK(vibrospice_set(run, "load.fraction", "0.3"));
  OK(vibrospice_run_to(run, 0.05, NULL, NULL));
  EXPECT(fabs(column(run, "p_m") - p) < 1e-9 * fabs(p), "p = %.17g, not %.17g", p,
         column(run, "p_m"));
  OK(vibrospice_free(run));
  run = open_scene(LOADED "firing: {angle: [[0 s, 160 deg], [1 s, 100 deg]], every: 1}\n",
                   "switched", "0.1 s");
  FAILS(vibrospice_set_input(run, "firing.angle", 90), VIBROSPICE_INPUT, "a list of angles");
  OK(vibrospice_free(run));
  run = open_scene("control_setpoint", "switched", "0.1 s");
  FAILS(vibrospice_set_input(run, "firing.angle", 90), VIBROSPICE_INPUT, "control decides it");
  OK(vibrospice_free(run));
}

/* ---- a functional mock-up unit ---- */

/* What the test uses of the standard, FMI 2.0. */
typedef struct callbacks {
  void (*logger)(void *, const char *, int, const char *, const char *, ...);
  void *(*allocate)(size_t, size_t);
  void (*release)(void *);
  void (*finished)(void *, int);
  void *environment;
} callbacks;

static char logged[1024];

static void take_log(void *environment, const char *instance, int status, const char *category,
                     const char *format, ...) {
  va_list list;
  (void)environment, (void)instance, (void)status, (void)category;
  va_start(list, format);
  vsnprintf(logged, sizeof logged, format, list);
  va_end(list);
}

typedef struct unit {
  void *library;
  void *(*instantiate)(const char *, int, const char *, const char *, const callbacks *, int, int);
  int (*setup)(void *, int, double, double, int, double);
  int (*exit_init)(void *), (*reset)(void *);
  int (*step)(void *, double, double, int);
  int (*get)(void *, const unsigned *, size_t, double *);
  int (*set)(void *, const unsigned *, size_t, const double *);
  int (*save)(void *, void **), (*restore)(void *, void *), (*forget)(void *, void **);
  void (*end)(void *);
} unit;

static void look_up(const unit *u, const char *name, void *function) {
  void *found = dlsym(u->library, name);
  EXPECT(found, "the unit has no %s", name);
  memcpy(function, &found, sizeof found);
}

static unit load_unit(const char *path) {
  unit u = {.library = dlopen(path, RTLD_NOW | RTLD_LOCAL)};
  EXPECT(u.library, "%s", dlerror());
  look_up(&u, "fmi2Instantiate", &u.instantiate);
  look_up(&u, "fmi2SetupExperiment", &u.setup);
  look_up(&u, "fmi2ExitInitializationMode", &u.exit_init);
  look_up(&u, "fmi2Reset", &u.reset);
  look_up(&u, "fmi2DoStep", &u.step);
  look_up(&u, "fmi2GetReal", &u.get);
  look_up(&u, "fmi2SetReal", &u.set);
  look_up(&u, "fmi2GetFMUstate", &u.save);
  look_up(&u, "fmi2SetFMUstate", &u.restore);
  look_up(&u, "fmi2FreeFMUstate", &u.forget);
  look_up(&u, "fmi2FreeInstance", &u.end);
  return u;
}

/* The unit that is exported, two instances at once, its inputs and states, against the library. */
/* By which the unit in the folder "a unit" is known. */
static char token[128];

static void read_token(void) {
  char *text = read_file("a unit/resources/token.txt");
  snprintf(token, sizeof token, "%.*s", (int)strcspn(text, "\n"), text);
  free(text);
}

static void mock_up_unit(void) {
  static const callbacks CALL = {take_log, calloc, free, NULL, NULL};
  static const unsigned ANGLE = 1, TRAVEL = 101; /* as modelDescription.xml has them */
  char uri[4200];
  void *state = NULL;
  double p, other, angle = 120;
  vibrospice *run;
  write_file("own.yaml", "firing: {every: 1, angle: 150 deg}\nrun: {tier: switched, until: 1 s}\n");
  RUN_GOOD("export own.yaml --set run.tolerance=1e-5 -o unit.fmu");
  EXPECT(!system("python3 -m zipfile -t unit.fmu >../zip 2>&1 && mkdir 'a unit' &&"
                 " python3 -m zipfile -e unit.fmu 'a unit'"),
         "the archive cannot be read");
  char *xml = read_file("a unit/modelDescription.xml");
  EXPECT(strstr(xml, "name=\"firing.angle\" valueReference=\"1\" causality=\"input\"") &&
             strstr(xml, "name=\"p_m\" valueReference=\"101\" causality=\"output\"") &&
             strstr(xml, "name=\"supply.frequency\" valueReference=\"5\" causality=\"parameter\" "
                         "variability=\"fixed\""),
         "another description: %s", xml);
  free(xml);
  read_token();
  char *here = get_current_dir_name();
  snprintf(uri, sizeof uri, "file://%s/a%%20unit/resources", here);
  free(here);
  setenv("VIBROSPICE_PROGRAM", VS_PROGRAM, 1);
  EXPECT(!system("mv 'a unit'/binaries/*/unit.so ."), "no shim");
  unit u = load_unit("./unit.so");
  void *one = u.instantiate("one", 1, token, uri, &CALL, 0, 0),
       *two = u.instantiate("two", 1, token, uri, &CALL, 0, 0);
  EXPECT(one && two && !u.setup(one, 0, 0, 0, 1, 0.2) && !u.setup(two, 0, 0, 0, 1, 0.2), "%s",
         logged);
  EXPECT(!u.exit_init(one) && !u.exit_init(two), "%s", logged);
  for (int k = 0; k < 50; k++) EXPECT(!u.step(one, k * 1e-3, 1e-3, 0), "%d: %s", k, logged);
  EXPECT(!u.save(one, &state) && !u.set(one, &ANGLE, 1, &angle) && !u.step(one, 0.05, 0.0333, 0) &&
             !u.get(one, &TRAVEL, 1, &p),
         "%s", logged);
  EXPECT(!u.restore(one, state) && !u.set(one, &ANGLE, 1, &angle) &&
             !u.step(one, 0.05, 0.0333, 0) && !u.get(one, &TRAVEL, 1, &other) && other == p,
         "not rolled back: %.17g, not %.17g; %s", other, p, logged);
  OK(vibrospice_open("own.yaml", 0, &run));
  OK(vibrospice_set(run, "run.tolerance", "1e-5"));
  OK(vibrospice_set_input(run, "firing.angle", 150));
  OK(vibrospice_run_to(run, 0.05, NULL, NULL));
  OK(vibrospice_set_input(run, "firing.angle", 120));
  OK(vibrospice_run_to(run, 0.0833, NULL, NULL));
  other = column(run, "p_m");
  /* The unit's steps end at its instants, as its mains may change: rounding. */
  EXPECT(fabs(p) > 1e-5 && fabs(p - other) < 1e-9 * fabs(p), "p = %.17g, not %.17g", p, other);
  OK(vibrospice_free(run));
  EXPECT(!u.step(two, 0, 0.2, 0), "%s", logged);
  EXPECT(u.step(two, 0.1, 0.01, 0) == 3 && strstr(logged, "does not begin at"), "%s", logged);
  EXPECT(u.step(two, 0.2, 0.01, 0) == 3 && strstr(logged, "after the run's end"), "%s", logged);
  EXPECT(u.set(two, &TRAVEL, 1, &p) == 3 && strstr(logged, "not an input"), "%s", logged);
  EXPECT(!u.reset(two) && !u.restore(two, state) && !u.set(two, &ANGLE, 1, &angle) &&
             !u.step(two, 0.05, 0.0333, 0) && !u.get(two, &TRAVEL, 1, &other) && other == p,
         "an instance that had not begun: %.17g, not %.17g; %s", other, p, logged);
  EXPECT(!u.reset(two) && !u.setup(two, 0, 0, 0, 1, 0.01) && !u.save(two, &state) &&
             !u.reset(two) && !u.restore(two, state) && !u.exit_init(two) &&
             !u.step(two, 0, 0.01, 0) && u.step(two, 0.01, 0.01, 0) == 3,
         "another end than the state's: %s", logged);
  EXPECT(!u.forget(one, &state) && !state, "%s", logged);
  int (*integers)(void *, const unsigned *, size_t, int *), none;
  look_up(&u, "fmi2GetInteger", &integers);
  EXPECT(!integers(one, &ANGLE, 0, &none) && integers(one, &ANGLE, 1, &none) == 3 &&
             strstr(logged, "does not support fmi2GetInteger"),
         "%s", logged);
  u.end(one);
  u.end(two);
  setenv("VIBROSPICE_PROGRAM", "/nowhere", 1);
  EXPECT(!u.instantiate("one", 1, token, uri, &CALL, 0, 0) && strstr(logged, "/nowhere"), "%s",
         logged);
  unsetenv("VIBROSPICE_PROGRAM");
  dlclose(u.library);
  expect_no_child(__LINE__);
  EXPECT(!system("rm -r 'a unit' unit.fmu unit.so"), "no unit");
}

static pid_t child_of_this(void);

/* Exports own.yaml with these words, and loads the unit from the folder "a unit". */
static unit open_unit(const char *words, char uri[4200]) {
  char *here = get_current_dir_name();
  snprintf(uri, 4200, "%s/a unit/resources/", here);
  free(here);
  RUN_GOOD(words);
  EXPECT(!system("rm -rf 'a unit' unit.so && mkdir 'a unit' && python3 -m zipfile -e unit.fmu "
                 "'a unit' && cp 'a unit'/binaries/*/unit.so ."),
         "the archive cannot be read");
  read_token();
  unit u = {.library = dlopen("./unit.so", RTLD_NOW | RTLD_LOCAL)};
  EXPECT(u.library, "%s", dlerror());
  return u;
}

static int (*set_stop)(void *, int, double, double, int, double);

/* An instance of FMI 2.0 that runs to 0.05 s in steps of 1 ms. */
static void *run_to_50_ms(const unit *u, const char *uri) {
  static const callbacks CALL = {take_log, calloc, free, NULL, NULL};
  void *one = u->instantiate("one", 1, token, uri, &CALL, 0, 0);
  EXPECT(one && !set_stop(one, 0, 0, 0, 1, 0.2) && !u->exit_init(one), "%s", logged);
  for (int k = 0; k < 50; k++) EXPECT(!u->step(one, k * 1e-3, 1e-3, 0), "%d: %s", k, logged);
  return one;
}

/* A state as bytes makes another instance go on to the bit, when all others are gone. */
static void states_as_bytes(void) {
  static const callbacks CALL = {take_log, calloc, free, NULL, NULL};
  static const unsigned INPUT[] = {1, 2}, TRAVEL = 101;
  char uri[4200];
  double p = NAN, other = NAN, angle[] = {120, 300};
  void *state = NULL;
  size_t size = 0;
  int (*size_of)(void *, void *, size_t *), (*write_to)(void *, void *, char *, size_t),
      (*read_from)(void *, const char *, size_t, void **);
  write_file("own.yaml", "firing: {every: 1, angle: 150 deg}\nrun: {tier: switched, until: 1 s}\n");
  setenv("VIBROSPICE_PROGRAM", VS_PROGRAM, 1);
  unit u = open_unit("export own.yaml -o unit.fmu", uri);
  dlclose(u.library);
  u = load_unit("./unit.so");
  set_stop = u.setup;
  look_up(&u, "fmi2SerializedFMUstateSize", &size_of);
  look_up(&u, "fmi2SerializeFMUstate", &write_to);
  look_up(&u, "fmi2DeSerializeFMUstate", &read_from);
  void *one = run_to_50_ms(&u, uri);
  EXPECT(!u.set(one, INPUT, 2, angle) && !u.step(one, 0.05, 0.0111, 0) && !u.save(one, &state) &&
             !size_of(one, state, &size),
         "%s", logged);
  char *bytes = calloc(size, 1);
  EXPECT(write_to(one, state, bytes, size - 1) == 3 && !write_to(one, state, bytes, size), "%s",
         logged);
  angle[0] = 100;
  EXPECT(!u.set(one, INPUT, 1, angle) && !u.step(one, 0.0611, 0.05, 0) &&
             !u.get(one, &TRAVEL, 1, &p) && !u.forget(one, &state),
         "%s", logged);
  u.end(one);
  EXPECT(u.step(one, 0.1111, 0.01, 0) == 3 && u.get(one, &TRAVEL, 1, &other) == 3 &&
             u.save(one, &state) == 3 && u.reset(one) == 3,
         "an instance that was freed is used");
  u.end(one); /* which does nothing */
  void *two = u.instantiate("two", 1, token, uri, &CALL, 0, 0);
  EXPECT(!u.instantiate("two", 1, "{2}", uri, &CALL, 0, 0) &&
             strstr(logged, "the token '{2}' is of another unit: the one of these resources is"),
         "%s", logged);
  EXPECT(!read_from(two, bytes, size, &state) && !u.restore(two, state) &&
             !u.set(two, INPUT, 1, angle) && !u.step(two, 0.0611, 0.05, 0) &&
             !u.get(two, &TRAVEL, 1, &other) && p == other,
         "p = %.17g, not %.17g: %s", other, p, logged);
  EXPECT(!u.forget(two, &state), "%s", logged);
  bytes[20] ^= 1; /* the token */
  EXPECT(read_from(two, bytes, size, &state) == 3 && strstr(logged, "another unit's"), "%s",
         logged);
  bytes[20] ^= 1;
  EXPECT(read_from(two, bytes, size - 8, &state) == 3 && strstr(logged, "not whole"), "%s", logged);
  EXPECT(read_from(two, bytes, 10, &state) == 3 && strstr(logged, "no state"), "%s", logged);
  bytes[size - 1] ^= 1; /* a column of its instant */
  EXPECT(read_from(two, bytes, size, &state) == 3 && strstr(logged, "comes to other values"), "%s",
         logged);
  bytes[0] ^= 1;
  EXPECT(read_from(two, bytes, size, &state) == 3 && strstr(logged, "no state") && !state, "%s",
         logged);
  free(bytes);
  u.end(two);
  dlclose(u.library);
  unsetenv("VIBROSPICE_PROGRAM");
  expect_no_child(__LINE__);
}

/* The program in the unit is the one that runs, though who unpacked it forgot that it is one. */
static void packed_program(void) {
  static const unsigned TRAVEL = 101;
  char uri[4200], own[8192];
  double p = NAN;
  setenv("VIBROSPICE_PROGRAM", "/nowhere", 1);
  unit u = open_unit("export own.yaml --set run.tier=circuit --with-program -o unit.fmu", uri);
  dlclose(u.library);
  u = load_unit("./unit.so");
  set_stop = u.setup;
  void *one = run_to_50_ms(&u, uri);
  EXPECT(!u.get(one, &TRAVEL, 1, &p) && fabs(p) > 1e-6, "p = %g: %s", p, logged);
  const pid_t child = child_of_this();
  snprintf(
      own, sizeof own,
      "test \"$(readlink /proc/%d/exe)\" = \"$PWD/a unit/resources/program/bin/vibrospice\" && "
      "grep -q \"a unit/resources/program/lib/libngspice\" /proc/%d/maps",
      (int)child, (int)child);
  EXPECT(!child || !system(own), "another program or another ngspice");
  u.end(one);
  dlclose(u.library);
  unsetenv("VIBROSPICE_PROGRAM");
  expect_no_child(__LINE__);
}

/* What the test uses of FMI 3.0. */
typedef struct unit_3 {
  void *(*instantiate)(const char *, const char *, const char *, bool, bool, bool, bool,
                       const unsigned *, size_t, void *, void *, void *);
  int (*begin)(void *, bool, double, double, bool, double), (*exit_init)(void *),
      (*step)(void *, double, double, bool, bool *, bool *, bool *, double *);
  void (*end)(void *);
} unit_3;

static unit_3 look_up_3(const unit *u) {
  unit_3 v;
  look_up(u, "fmi3InstantiateCoSimulation", &v.instantiate);
  look_up(u, "fmi3EnterInitializationMode", &v.begin);
  look_up(u, "fmi3ExitInitializationMode", &v.exit_init);
  look_up(u, "fmi3DoStep", &v.step);
  look_up(u, "fmi3FreeInstance", &v.end);
  return v;
}

/* Steps a new instance from 0 to 18 ms; writes the first 8 instants at which a step ended early,
 * and returns how many there were. */
static int early_ends(const unit_3 *v, const char *uri, bool allowed, double step_s,
                      double at_s[8]) {
  bool events, ends, early;
  double last_s = 0;
  int n = 0;
  void *one =
      v->instantiate("one", token, uri, false, false, false, allowed, NULL, 0, NULL, NULL, NULL);
  EXPECT(one && !v->begin(one, false, 0, 0, true, 0.03) && !v->exit_init(one), "no instance");
  for (double t_s = 0; t_s < 0.018 - 1e-9 && n < 8; t_s = last_s) {
    const double to_s = step_s * floor(t_s / step_s + 1 + 1e-6);
    EXPECT(!v->step(one, t_s, to_s - t_s, true, &events, &ends, &early, &last_s), "at %g", t_s);
    EXPECT(early == (last_s < to_s - 1e-9) && last_s > t_s && !ends && !events, "%d at %g", early,
           last_s);
    if (early) at_s[n++] = last_s;
  }
  EXPECT(v->step(one, 0, 0.01, true, &events, &ends, &early, &last_s) == 3 && last_s > 0.0179,
         "back to %g", last_s);
  v->end(one);
  EXPECT(v->step(one, 0.018, 0.01, true, &events, &ends, &early, &last_s) == 3, "freed, and used");
  return n;
}

/* FMI 3.0: a step ends where the thyristor fires and is extinct, if the master allows that. */
static void early_returns(void) {
  double at_s[8] = {0}, fine_s[8] = {0};
  char uri[4200];
  setenv("VIBROSPICE_PROGRAM", VS_PROGRAM, 1);
  unit u = open_unit("export own.yaml --set firing.angle=90deg --fmi 3 -o unit.fmu", uri);
  unit_3 v = look_up_3(&u);
  char *xml = read_file("a unit/modelDescription.xml"),
       *terminals = read_file("a unit/terminalsAndIcons/terminalsAndIcons.xml");
  EXPECT(strstr(xml, "fmiVersion=\"3.0\"") && strstr(xml, "mightReturnEarlyFromDoStep=\"true\"") &&
             strstr(xml, "<Float64 name=\"p_m\" valueReference=\"101\"") &&
             strstr(terminals, "variableName=\"firing.angle\""),
         "another description: %s", xml);
  free(xml);
  free(terminals);
  EXPECT(!early_ends(&v, uri, false, 0.001, at_s), "early at %.9g", at_s[0]);
  /* It fires at 5 ms, where the master stands anyway. */
  int n = early_ends(&v, uri, true, 0.001, at_s);
  EXPECT(n == 1 && at_s[0] > 0.009, "%d, at %.9g", n, at_s[0]);
  dlclose(u.library);
  /* A circuit's solver tells of the second firing some steps late; each ends within 30 us. */
  u = open_unit("export own.yaml --set run.tier=compiled --fmi 3 -o unit.fmu", uri);
  v = look_up_3(&u);
  n = early_ends(&v, uri, true, 0.0009, at_s);
  EXPECT(n == 4 && fabs(at_s[2] - 0.0085045) < 1e-6, "%d, at %.9g", n, at_s[2]);
  n = early_ends(&v, uri, true, 0.00003, fine_s);
  EXPECT(n == 4 && fabs(fine_s[2] - at_s[2]) < 1e-4 && fabs(fine_s[3] - at_s[3]) < 1e-6,
         "%d, at %.9g and %.9g", n, fine_s[2], fine_s[3]);
  dlclose(u.library);
  unsetenv("VIBROSPICE_PROGRAM");
  expect_no_child(__LINE__);
  EXPECT(!system("rm -r 'a unit' unit.fmu unit.so"), "no unit");
}

static void wrong_units(void) {
  static const char *const NETLIST[] = {"--with-program", "FILE.fmu"};
  static const char *const CODE[] = {"code of its own", "unit"}, *const DECK[] = {
                                                                     "own.cir",
                                                                     "the scene in the unit"};
  write_file("coded.yaml", "firing: {every: 1}\ninstruments: {}\n"
                           "control: {law: pipe, command: cat}\n");
  refuse("export coded.yaml -o unit.fmu", "a law of its own", "", CODE, __LINE__);
  EXPECT(!system("vibrospice='" VS_PROGRAM "'; cp '" VS_TEST_FOLDER
                 "/../spice/halfwave_bare.cir' own.cir"),
         "no deck");
  static const char *const NAME[] = {"no name", "FILE.fmu"};
  refuse("export own.yaml -o ./.fmu", "a unit without a name", "", NAME, __LINE__);
  write_file("decked.yaml", "circuit: {deck: own.cir}\n");
  refuse("export decked.yaml -o unit.fmu", "a deck of its own", "", DECK, __LINE__);
  refuse("export paper --with-program -o x.cir", "a netlist with a program", "", NETLIST, __LINE__);
}

/* ---- misuse ---- */

static void wrong_scenes(void) {
  vibrospice *run = (vibrospice *)&run;
  FAILS(vibrospice_open("papr", 0, &run), VIBROSPICE_INPUT, "did you mean 'paper'?");
  EXPECT(!run, "a handle in spite of the error");
  FAILS(vibrospice_open("run:\n  until: 1 V\n", VIBROSPICE_TEXT, &run), VIBROSPICE_INPUT,
        "the scene's text:2:10: ");
  FAILS(vibrospice_open(NULL, 0, &run), VIBROSPICE_INPUT, "NULL");
  FAILS(vibrospice_open("paper", 64, &run), VIBROSPICE_INPUT, "flags");
  FAILS(vibrospice_open("control: {law: pipe, command: cat}\nfiring: {every: 1}\n", VIBROSPICE_TEXT,
                        &run),
        VIBROSPICE_INPUT, "--allow-code");
  OK(vibrospice_open("paper", 0, &run));
  FAILS(vibrospice_set(run, "run.till", "1 s"), VIBROSPICE_INPUT, "no key 'till'");
  FAILS(vibrospice_set(run, "run.until=", "1 s"), VIBROSPICE_INPUT, "'='");
  FAILS(vibrospice_folder(run, "/dev/null/x"), VIBROSPICE_INPUT, "/dev/null");
  OK(vibrospice_finish(run));
  OK(vibrospice_free(run));
  expect_no_child(__LINE__);
}

static int use_own_handle(void *context, const double *value, size_t count) {
  seen *s = context;
  (void)value, (void)count;
  FAILS(vibrospice_run_on(s->run, NULL, NULL), VIBROSPICE_BUSY, "callback");
  FAILS(vibrospice_free(s->run), VIBROSPICE_BUSY, "callback");
  return ++s->rows == 3;
}

static void wrong_order(void) {
  const vibrospice_measure *m = (const vibrospice_measure *)&m;
  const vibrospice_line *line = (const vibrospice_line *)&line;
  const char *text = "no summary";
  vibrospice_state *state;
  seen s = {0};
  size_t count = 7;
  vibrospice *run = open_scene("paper", "switched", "0.1 s");
  FAILS(vibrospice_measures(run, &m, &count), VIBROSPICE_ORDER, "not finished");
  EXPECT(!m && !count, "something in spite of the error");
  FAILS(vibrospice_summary(run, &text), VIBROSPICE_ORDER, "not finished");
  EXPECT(!text, "a summary in spite of the error");
  text = "no verdict";
  FAILS(vibrospice_verdict(run, &line, &count, NULL, &text), VIBROSPICE_ORDER, "not finished");
  EXPECT(!line && !text, "a verdict in spite of the error");
  FAILS(vibrospice_run_to(run, 0, NULL, NULL), VIBROSPICE_TIME, "not after");
  FAILS(vibrospice_run_to(run, NAN, NULL, NULL), VIBROSPICE_TIME, "not after");
  FAILS(vibrospice_run_to(run, 0.11, NULL, NULL), VIBROSPICE_TIME, "run.until = 0.1 s");
  s.run = run;
  FAILS(vibrospice_run_on(run, use_own_handle, &s), VIBROSPICE_STOPPED, "stopped");
  FAILS(vibrospice_set(run, "run.until", "1 s"), VIBROSPICE_ORDER, "has begun");
  FAILS(vibrospice_folder(run, "late"), VIBROSPICE_ORDER, "has begun");
  OK(vibrospice_finish(run));
  FAILS(vibrospice_finish(run), VIBROSPICE_ORDER, "finished");
  FAILS(vibrospice_run_on(run, NULL, NULL), VIBROSPICE_ORDER, "over");
  FAILS(vibrospice_save(run, &state), VIBROSPICE_ORDER, "nothing to save");
  FAILS(vibrospice_free_state((vibrospice_state *)run), VIBROSPICE_HANDLE, "no such state");
  OK(vibrospice_free(run));
  FAILS(vibrospice_free(run), VIBROSPICE_HANDLE, "was freed");
  vibrospice *next = open_scene("paper", "switched", "0.1 s"); /* which has the other's place */
  FAILS(vibrospice_finish(run), VIBROSPICE_HANDLE, "was freed");
  FAILS(vibrospice_finish((vibrospice *)&count), VIBROSPICE_HANDLE, "never was one");
  OK(vibrospice_free(next));
  OK(vibrospice_free(NULL));
}

/* A run that fails is over, but for a state. */
static void failed_run(void) {
  vibrospice_state *state;
  vibrospice *run =
      open_scene("load: {density: 1.6 g/cm3, fraction: 0.3}\nfiring: {angle: 100 deg, every: 1}\n"
                 "supply: {voltage: 440 V}\n",
                 "switched", "0.3 s");
  OK(vibrospice_run_to(run, 0.05, NULL, NULL));
  OK(vibrospice_save(run, &state));
  FAILS(vibrospice_finish(run), VIBROSPICE_FAILED, "the armature meets the pole cover");
  FAILS(vibrospice_run_on(run, NULL, NULL), VIBROSPICE_ORDER, "over");
  OK(vibrospice_restore(run, state));
  OK(vibrospice_run_to(run, 0.06, NULL, NULL));
  OK(vibrospice_free_state(state));
  OK(vibrospice_free(run));
}

/* In a program whose numbers have decimal commas the numbers are the same. The locale is made here:
 * decimal point, separator of thousands, their grouping, both as wide characters, and the code. */
static void decimal_commas(void) {
#ifdef __GLIBC__
  static const uint32_t HEAD[] = {0x20031114, 6, 32, 34, 36, 40, 44, 48};
  static const char DATA[] = ",\0.\0\3\3\0\0,\0\0\0.\0\0\0UTF-8";
  const vibrospice_measure *m;
  const vibrospice_input *in;
  double peak[2], until_s = 0;
  size_t count;
  EXPECT(!system("mkdir -p locale/commas"), "no folder");
  FILE *f = fopen("locale/commas/LC_NUMERIC", "wb");
  EXPECT(f && fwrite(HEAD, sizeof HEAD, 1, f) == 1 && fwrite(DATA, sizeof DATA, 1, f) == 1 &&
             !fclose(f),
         "no locale");
  setenv("LOCPATH", "locale", 1);
  for (int k = 0; k < 2; k++) {
    EXPECT(setlocale(LC_NUMERIC, k ? "commas" : "C") && *localeconv()->decimal_point == ".,"[k],
           "another locale");
    vibrospice *run = open_scene("paper", "switched", "0.05 s");
    OK(vibrospice_set(run, "supply.voltage", "440.5 V"));
    OK(vibrospice_time(run, NULL, &until_s));
    OK(vibrospice_inputs(run, &in, &count));
    EXPECT(until_s == 0.05 && in[0].value == 440.5, "%g s, %s = %g", until_s, in[0].name,
           in[0].value);
    OK(vibrospice_finish(run));
    OK(vibrospice_measures(run, &m, &count));
    peak[k] = m[0].value;
    OK(vibrospice_free(run));
  }
  EXPECT(peak[0] == peak[1], "%.17g, not %.17g", peak[1], peak[0]);
  setlocale(LC_NUMERIC, "C");
  unsetenv("LOCPATH");
  EXPECT(!system("rm -r locale"), "no locale");
#endif
}

/* The first child of this process. */
static pid_t child_of_this(void) {
  char path[64];
  long pid = 0;
  snprintf(path, sizeof path, "/proc/self/task/%d/children", (int)getpid());
  FILE *f = fopen(path, "r");
  if (f && fscanf(f, "%ld", &pid) != 1) pid = 0;
  if (f) fclose(f);
  return (pid_t)pid;
}

static void dead_engines(void) {
  vibrospice *run = open_scene("paper", "switched", "0.1 s");
  OK(vibrospice_run_to(run, 0.01, NULL, NULL));
  const pid_t child = child_of_this();
  if (child) {
    kill(child, SIGKILL);
    FAILS(vibrospice_run_on(run, NULL, NULL), VIBROSPICE_ENGINE, "ended by signal 9");
    FAILS(vibrospice_run_on(run, NULL, NULL), VIBROSPICE_ORDER, "over");
  }
  OK(vibrospice_free(run));
  setenv("VIBROSPICE_PROGRAM", "/nowhere/vibrospice", 1);
  FAILS(vibrospice_open("paper", 0, &run), VIBROSPICE_ENGINE, "/nowhere/vibrospice");
  setenv("VIBROSPICE_PROGRAM", "/bin/true", 1);
  FAILS(vibrospice_open("paper", 0, &run), VIBROSPICE_ENGINE, "the engine has ended");
  write_file("other", "#!/bin/sh\nprintf '\\0\\0\\0\\0\\5\\0\\0\\0other' >&0\nexec sleep 20\n");
  EXPECT(!system("chmod +x other"), "no program");
  setenv("VIBROSPICE_PROGRAM", "./other", 1);
  const time_t begun = time(NULL);
  FAILS(vibrospice_open("paper", 0, &run), VIBROSPICE_ENGINE, "it says 'other'");
  EXPECT(time(NULL) < begun + 15, "another program is waited for");
  unsetenv("VIBROSPICE_PROGRAM");
  EXPECT(!unlink("other"), "no program");
  expect_no_child(__LINE__);
}

/* The n-th request for memory of the engine fails: where the engine ends by it, that is an error of
 * the handle's, with the engine's own last line. */
static void no_memory(void) {
#if !defined __SANITIZE_ADDRESS__ /* which has a malloc of its own */
  int failed = 0;
  for (int n = 1; n < 4000; n = 3 * n + 1) {
    char text[1024];
    vibrospice *run = NULL;
    char *here = get_current_dir_name();
    snprintf(text, sizeof text,
             "#!/bin/sh\nVS_FAULT_COUNT='%s/count' VS_FAULT_AT=%d VS_FAULT_LASTS=1 "
             "LD_PRELOAD='" VS_FAULTS "' exec '" VS_PROGRAM "' \"$@\"\n",
             here, n);
    free(here);
    write_file("small", text);
    write_file("count", "\1\1\1\1\1\1\1\1");
    EXPECT(!system("chmod +x small && truncate -s 0 count && truncate -s 8 count"), "no program");
    setenv("VIBROSPICE_PROGRAM", "./small", 1);
    vibrospice_status status = vibrospice_open("paper", 0, &run);
    if (!status) status = vibrospice_set(run, "run.until", "20 ms");
    if (!status) status = vibrospice_finish(run);
    failed += status != 0;
    EXPECT(!status || (status == VIBROSPICE_ENGINE && strstr(vibrospice_error(), "memory")),
           "request %d: status %d: %s", n, (int)status, vibrospice_error());
    OK(vibrospice_free(run));
  }
  EXPECT(failed > 3, "%d have failed", failed);
  EXPECT(!unlink("small") && !unlink("count"), "no program");
  unsetenv("VIBROSPICE_PROGRAM");
  expect_no_child(__LINE__);
#endif
}

/* ---- threads ---- */

static void *run_whole(void *context) {
  double *peak = context;
  const vibrospice_measure *m;
  size_t count;
  vibrospice *run;
  *peak = NAN;
  if (vibrospice_open("paper", 0, &run)) return NULL;
  if (!vibrospice_set(run, "run.until", "0.1 s") && !vibrospice_finish(run) &&
      !vibrospice_measures(run, &m, &count))
    *peak = m[0].value;
  vibrospice_free(run);
  return NULL;
}

typedef struct meeting {
  pthread_mutex_t lock;
  pthread_cond_t met;
  int inside, leave;
  vibrospice *run;
} meeting;

static int wait_inside(void *context, const double *value, size_t count) {
  meeting *m = context;
  (void)value, (void)count;
  pthread_mutex_lock(&m->lock);
  m->inside = 1;
  pthread_cond_broadcast(&m->met);
  while (!m->leave) pthread_cond_wait(&m->met, &m->lock);
  pthread_mutex_unlock(&m->lock);
  return 0;
}

static void *run_and_wait(void *context) {
  meeting *m = context;
  return vibrospice_run_on(m->run, wait_inside, m) ? NULL : m;
}

static void threads(void) {
  enum { THREADS = 4 };
  pthread_t thread[THREADS], other;
  double peak[THREADS], t_s;
  void *good;
  meeting m = {.lock = PTHREAD_MUTEX_INITIALIZER, .met = PTHREAD_COND_INITIALIZER};
  for (int k = 0; k < THREADS; k++) pthread_create(&thread[k], NULL, run_whole, &peak[k]);
  for (int k = 0; k < THREADS; k++) pthread_join(thread[k], NULL);
  for (int k = 0; k < THREADS; k++)
    EXPECT(peak[k] == peak[0] && peak[k] > 0, "%.17g, not %.17g", peak[k], peak[0]);
  m.run = open_scene("paper", "switched", "0.02 s");
  pthread_create(&other, NULL, run_and_wait, &m);
  pthread_mutex_lock(&m.lock);
  while (!m.inside) pthread_cond_wait(&m.met, &m.lock);
  pthread_mutex_unlock(&m.lock);
  FAILS(vibrospice_time(m.run, &t_s, NULL), VIBROSPICE_BUSY, "another thread");
  FAILS(vibrospice_free(m.run), VIBROSPICE_BUSY, "another thread");
  pthread_mutex_lock(&m.lock);
  m.leave = 1;
  pthread_cond_broadcast(&m.met);
  pthread_mutex_unlock(&m.lock);
  pthread_join(other, &good);
  EXPECT(good, "the run of the other thread failed");
  OK(vibrospice_finish(m.run));
  OK(vibrospice_free(m.run));
}

/* A copy of this process has no handles, and keeps no engine from its end. */
static void other_process(void) {
  vibrospice *run = open_scene("paper", "switched", "0.02 s");
  const pid_t child = fork();
  if (!child) _exit(vibrospice_run_on(run, NULL, NULL) == VIBROSPICE_HANDLE ? 0 : 1);
  int how = 1;
  waitpid(child, &how, 0);
  EXPECT(how == 0, "a copy of the process may use the handle");
  OK(vibrospice_finish(run));
  const pid_t idle = fork();
  if (!idle) {
    sleep(10);
    _exit(0);
  }
  OK(vibrospice_free(run));
  kill(idle, SIGKILL);
  waitpid(idle, &how, 0);
  EXPECT(WIFSIGNALED(how), "the engine ended with a copy of the process");
}

int main(void) {
  static const vs_test TESTS[] = {{"sizes", sizes},
                                  {"symbols", symbols},
                                  {"the same files", same_files},
                                  {"the same result", same_result},
                                  {"states", states},
                                  {"inputs", inputs},
                                  {"a second run", second_run},
                                  {"wrong inputs", wrong_inputs},
                                  {"a unit", mock_up_unit},
                                  {"states as bytes", states_as_bytes},
                                  {"a packed program", packed_program},
                                  {"early returns", early_returns},
                                  {"wrong units", wrong_units},
                                  {"wrong scenes", wrong_scenes},
                                  {"wrong order", wrong_order},
                                  {"a failed run", failed_run},
                                  {"decimal commas", decimal_commas},
                                  {"dead engines", dead_engines},
                                  {"no memory", no_memory},
                                  {"threads", threads},
                                  {"another process", other_process}};
  return program_suite("vibrospice", TESTS, COUNT(TESTS));
}
