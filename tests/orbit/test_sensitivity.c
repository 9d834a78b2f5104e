/* SPDX-License-Identifier: GPL-3.0-or-later
 * Derivatives of measures with respect to keys: the published numbers, differences of runs and of
 * orbits on other machines, laws, stops and events, keys at the edge of their range, the command
 * and its files, the study's key, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/text.h"
#include "cli/sensitivity.h"
#include "orbit/sensitivity.h"
#include "orbit/tangent.h"
#include "program.h"
#include "report/tornado.h"

#define STOP "actuator.stop={stiffness: 1e6 N/m, damping: 50 N.s/m}"
#define IRON "actuator.saturation={law: series, flux: 1.5 Wb, current: 1 A, exponent: 7}"

enum { SETS = 8 };

/* Finds one derivative. */
static vs_sensitivity_entry find(const char *scene, const char *tier, int periods, const char *of,
                                 const char *to, const char *const *given) {
  const char *sets[SETS] = {NULL};
  for (size_t k = 0; given[k]; k++) sets[k] = given[k];
  const vs_asked measure = {of, {0}}, key = {to, {0}};
  const vs_sensitivity_order order = {&measure, &key, 1, 1, periods, NULL, 0};
  vs_sensitivity s = {0};
  vs_sensitivity_entry e = {NAN, NAN, false};
  vs_trial *t = vs_trial_read(scene, tier, sets);
  EXPECT(!t->status, "%s", t->err.text);
  vs_status status = vs_sensitivity_find(&t->scene, &order, &s, &t->err);
  EXPECT(!status, "%s of %s to %s: %s", scene, of, to, t->err.text);
  if (!status) e = s.entry[0];
  vs_sensitivity_free(&s);
  vs_trial_free(t);
  return e;
}

/* ---- published numbers ---- */

/* Of the orbit at 100 degrees: ten digits. With the frequency the firing stays at its angle. */
static void the_orbit_has_the_published_ones(void) {
  static const struct {
    const char *key;
    double value;
  } ROWS[] = {{"firing.angle", -5.363272537},
              {"supply.voltage", 2.227410008},
              {"actuator.gap", -1.132993853},
              {"actuator.resistance", -0.276037104}};
  const char *const every[] = {"firing.every=1", NULL};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_sensitivity_entry e = find("paper", "switched", 1, "p_min", ROWS[k].key, every);
    CLOSE_OF(e.value, ROWS[k].value, 1, 1e-9); /* the last digit printed, and half of it */
    EXPECT(e.exact && e.error < 1e-9, "%s: %g", ROWS[k].key, e.error);
  }
}

static void the_single_shot_has_the_published_ones(void) {
  static const struct {
    const char *key;
    double value;
  } ROWS[] = {{"firing.angle", -4.6252},        {"supply.frequency", -2.4247},
              {"supply.voltage", 2.0210},       {"actuator.gap", -0.9424},
              {"actuator.inductance", -0.6927}, {"machine.spring_stiffness", -0.6410},
              {"actuator.resistance", -0.3178}, {"machine.trough_mass", -0.3039}};
  const char *const none[] = {NULL};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_sensitivity_entry e = find("paper", "switched", 0, "p_first_peak", ROWS[k].key, none);
    CLOSE_OF(e.value, ROWS[k].value, 1, 5.1e-5); /* four decimals are printed */
  }
}

/* ---- differences of runs and of orbits ---- */

/* The derivative of each measure by differences of runs, each of which finds its own orbit. Their
 * steps are as short as the kin's, so that the same is compared. */
static void compare(vs_sensitivity_problem *subject, const char *key, double step, double allowed) {
  vs_stencil exact = {0}, runs = {0};
  vs_error err = {0};
  const vs_asked asked = {key, {0}};
  vs_status status = vs_tangent_find(&exact, subject, &asked, NULL, false, &err);
  if (!status)
    status = vs_stencil_begin(&runs, subject, key, (vs_where){0}, step,
                              subject->scene->tier->finest, NULL, &err);
  if (!status) status = vs_stencil_run(&runs, subject, subject->scene->tier->finest, false, &err);
  EXPECT(!status, "%s: %s", key, err.text);
  vs_measured_value m;
  for (int k = 0; !status && vs_measured_at(exact.measured[0], k, &m); k++) {
    vs_slope_of a = vs_stencil_slope(&exact, m.name), b = vs_stencil_slope(&runs, m.name);
    /* what is left of a balance is rounding, and has no derivative */
    if (!m.value.known || a.value == 0 || !strcmp(m.name, "energy_residual") ||
        !strcmp(m.name, "energy_stored"))
      continue;
    double size = fmax(fabs(b.slope), fabs(b.value));
    /* what is not resolved says so, and is looked for once more by vs_sensitivity_find */
    EXPECT(a.known && b.known && fabs(a.slope - b.slope) <= allowed * size + 2 * a.error,
           "%s to %s: %.12g, by runs %.12g", m.name, key, a.slope / a.value, b.slope / b.value);
  }
  if (!status) vs_stencil_end(&exact);
  vs_stencil_end(&runs);
}

typedef struct held {
  const char *scene, *key;
  int periods;
  double step, allowed;
  const char *sets[SETS];
} held;

/* A run is right to some 1e-11, so that a difference over a step of 1e-3 is to 1e-8; where a stop
 * is touched the motion bends over much shorter steps, and less is known by differences. Their
 * steps are short, as are the kin's, so that both have the same dense output. */
static void kin_are_as_runs_are(void) {
  static const char SHORT[] = "run.max_step=0.2ms";
  static const held ROWS[] = {
      {"paper", "firing.angle", 0, 1e-3, 1e-9, {SHORT}},
      {"paper", "supply.frequency", 0, 1e-3, 1e-9, {SHORT}},
      {"paper", "machine.spring_stiffness", 0, 3e-4, 2e-8, {SHORT}},
      {"paper", "supply.frequency", 1, 3e-4, 1e-8, {SHORT, "firing.every=1"}},
      {"paper", "actuator.gap", 1, 3e-4, 1e-8, {SHORT, "firing.every=2"}},
      {"paper", "actuator.saturation.exponent", 0, 1e-3, 1e-8, {SHORT, IRON}},
      {"paper", "load.fraction", 0, 1e-3, 5e-8, {"load.density=1.5g/cm3", SHORT}},
      {"paper",
       "firing.angle",
       1,
       1e-5,
       1e-6,
       {SHORT, "firing.every=1", "firing.angle=75deg", "firing.pulse_width=2ms", STOP}},
      {"paper",
       "actuator.stop.stiffness",
       1,
       1e-5,
       1e-6,
       {SHORT, "firing.every=1", "firing.angle=75deg", "firing.pulse_width=2ms", STOP}},
      {"two_mass", "machine.spring", 0, 1e-4, 5e-8, {SHORT}},
      {"lds_v203", "actuator.resistance", 0, 1e-3, 1e-8, {NULL}},
      /* the run ends while current flows, later or earlier */
      {"paper",
       "run.until",
       0,
       1e-4,
       1e-7,
       {SHORT, "firing.every=1", "firing.angle=90deg", "run.until=48ms"}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const char *sets[SETS] = {NULL};
    vs_sensitivity_problem subject = {0};
    memcpy(sets, ROWS[k].sets, sizeof ROWS[k].sets);
    vs_trial *t = vs_trial_read(ROWS[k].scene, "switched", sets);
    EXPECT(!t->status, "%s", t->err.text);
    vs_status status = vs_sensitivity_problem_begin(&subject, &t->scene, ROWS[k].periods, &t->err);
    EXPECT(!status, "%s: %s", ROWS[k].scene, t->err.text);
    if (!status) compare(&subject, ROWS[k].key, ROWS[k].step, ROWS[k].allowed);
    vs_sensitivity_problem_end(&subject);
    vs_trial_free(t);
  }
}

/* The mains drop for a cycle while the machine is at work: the run begins on an orbit that depends
 * on the key, and an edge of the mains moves. At 45.5 and 45.6 ms the edge is 0.1 % of its instant
 * before and behind a firing, so that a longer step of the key would change their order. */
static void events_move(void) {
  static const char *const KEYS[] = {"events.dip.at", "firing.angle", "supply.frequency"};
  static const char *const AT[] = {"48", "45.5", "45.6"};
  const char *const none[] = {NULL};
  for (size_t k = 0; k < COUNT(KEYS) * COUNT(AT); k++) {
    char text[256];
    vs_sensitivity_problem subject;
    snprintf(text, sizeof text,
             "start: steady\nfiring: {every: 1}\n"
             "run: {until: 0.08 s, tier: switched, max_step: 0.2 ms}\n"
             "events:\n  dip: {kind: sag, at: %s ms}\n",
             AT[k / COUNT(KEYS)]);
    write_file("dip.yaml", text);
    vs_trial *t = vs_trial_read("dip.yaml", NULL, none);
    EXPECT(!t->status && !vs_sensitivity_problem_begin(&subject, &t->scene, 0, &t->err), "%s",
           t->err.text);
    compare(&subject, KEYS[k % COUNT(KEYS)], 1e-4, 1e-8);
    vs_sensitivity_problem_end(&subject);
    vs_trial_free(t);
  }
}

/* A largest acceleration at a corner: where the clipping of a stop's damping ends, and in a table
 * whose end is nearer than the kin's first p. The first is known by differences of runs over 1e-3,
 * of which those over 2e-6 know 2e-4; the second is held against runs 1e-6 apart, which know 1e-5.
 */
static void corners_are_told(void) {
  const char *const none[] = {NULL}, *const hit[] = {"run.until=12.4ms", NULL};
  vs_sensitivity_entry e = find("solenoid", "switched", 0, "as_peak", "supply.voltage", hit);
  EXPECT(fabs(e.value - 0.9325) < 3e-4 && (!e.exact || e.error > 1e-5), "%.9g +- %g", e.value,
         e.error);
  e = find("solenoid", "switched", 0, "i_peak", "supply.voltage", hit);
  EXPECT(e.exact && e.error < 1e-8, "what has no corner stays exact: %g", e.error);
  e = find("solenoid_table", "switched", 0, "as_peak", "supply.voltage", none);
  CLOSE_OF(e.value, 10.27177, 1, 2e-5);
  EXPECT(e.error < 1e-5, "%g", e.error);
}

/* ---- keys at an edge, and without effect ---- */

static void zeros_are_told(void) {
  const vs_asked of[] = {{"p_first_peak", {0}}, {"p_min", {0}}};
  const vs_asked to[] = {{"load.fraction", {0}},
                         {"supply.resistance", {0}},
                         {"firing.pulse_width", {0}},
                         {"supply.phase", {0}},
                         {"actuator.leakage", {0}}};
  const vs_sensitivity_order order = {of, to, 1, COUNT(to), 0, NULL, 0};
  const char *const sets[] = {"load.density=1.5g/cm3", NULL};
  vs_sensitivity s;
  vs_trial *t = vs_trial_read("paper", "switched", sets);
  vs_status status = vs_sensitivity_find(&t->scene, &order, &s, &t->err);
  EXPECT(!status, "%s", t->err.text);
  EXPECT(s.entry[0].value < -0.1, "one side of 0: %g", s.entry[0].value);
  EXPECT(s.entry[1].value == 0 && s.entry[2].value == 0, "no effect");
  EXPECT(fabs(s.entry[3].value) < 1e-9, "another zero of the mains: %g", s.entry[3].value);
  EXPECT(strstr(s.notes.text, "supply.resistance enters no equation"), "%s", s.notes.text);
  EXPECT(strstr(s.notes.text, "load.fraction is 0: the derivatives are per 1"), "%s", s.notes.text);
  EXPECT(strstr(s.notes.text, "firing.pulse_width: no measure asked for depends"), "%s",
         s.notes.text);
  vs_sensitivity_free(&s);
  vs_trial_free(t);
}

/* 179.9 degrees: three steps further is no angle any more, so that all lie below. */
static void edges_are_taken_from_one_side(void) {
  const char *const late[] = {"firing.angle=179.9deg", NULL};
  vs_sensitivity_entry e = find("paper", "switched", 0, "t_fire", "firing.angle", late);
  CLOSE_OF(e.value, 1, 1, 1e-9);
}

/* ---- tier circuit ---- */

/* Differences of 7 runs at 1e-4 against those at 1e-6: -5.08770. */
static void a_circuit_is_differenced(void) {
  const char *const brief[] = {"run.until=0.02s", NULL};
  vs_sensitivity_entry e = find("paper", "circuit", 0, "p_first_peak", "firing.angle", brief);
  EXPECT(!e.exact && e.error > 0 && e.error < 0.01, "error %g", e.error);
  CLOSE_OF(e.value, -5.08770, 1, e.error);
}

/* Those of tier compiled along the steps of one run at 1e-4, against differences of ngspice's runs
 * at 1e-6 (sensitivity paper --tier circuit --set run.tolerance=1e-6), which tell 2e-3 and 1e-5. */
static void compiled_steps_are_differentiated(void) {
  static const struct {
    const char *of, *to;
    double value, known;
  } ROWS[] = {{"p_first_peak", "firing.angle", -5.08769949512, 2e-3},
              {"t_extinction", "circuit.c1", 0.00609859555163, 1e-5}};
  const char *const brief[] = {"circuit.deck=halfwave_snubbed", "run.until=24ms", NULL};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_sensitivity_entry e = find("paper", "compiled", 0, ROWS[k].of, ROWS[k].to, brief);
    EXPECT(e.exact && e.error > 0 && e.error < 1e-3, "%s: error %g", ROWS[k].of, e.error);
    CLOSE_OF(e.value, ROWS[k].value, 1, e.error + ROWS[k].known);
  }
}

/* The same on an orbit: each neighbour's own, closed along the same steps. Against central
 * differences of fourth order of tier compiled's orbits at 1e-6, of keys 0.2 % apart. */
static void compiled_orbits_are_differentiated(void) {
  static const struct {
    const char *of, *to;
    double value, known;
  } ROWS[] = {{"p_min", "circuit.c1", 1.52695862, 1e-5},
              {"i_rms", "firing.angle", -0.89897844, 1e-5}};
  const char *const at_work[] = {"circuit.deck=halfwave_snubbed", "firing.every=1", NULL};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_sensitivity_entry e = find("paper", "compiled", 1, ROWS[k].of, ROWS[k].to, at_work);
    EXPECT(e.exact && e.error > 0 && e.error < 2e-3, "%s: error %g", ROWS[k].of, e.error);
    CLOSE_OF(e.value, ROWS[k].value, 1, e.error + ROWS[k].known);
  }
}

/* ---- the command and the study ---- */

static vs_status command(vs_sensitivity_options o, vs_error *err) {
  o.scene = "paper";
  o.period = 1;
  o.quiet = true;
  return vs_sensitivity_command(&o, err);
}

static void files_are_written(void) {
  vs_error err = {0};
  const vs_sensitivity_options o = {
      .of = "p_min,i_peak", .to = "firing.angle,actuator.gap", .folder = "out"};
  EXPECT(!command(o, &err), "%s", err.text);
  EXPECT_FILES("out", "sensitivity.csv summary.json ");
  EXPECT(vs_tornado_here("out"), "a table is there");
  if (on_path("gnuplot")) {
    EXPECT(!vs_tornado_draw("out", true, &err), "%s", err.text);
    EXPECT_FILES("out", "sensitivity.csv summary.json tornado.png tornado.svg ");
  }
  remove_tree("out");
}

/* What --json prints is what the folder gets. */
static void json_has_all_keys(void) {
  static const char SHAPE[] =
      "\n  \"scene\": \"paper\",\n  \"tier\": \"switched\",\n  \"steady\": false,\n"
      "  \"of\": {\n    \"p_min\": {\"value\": #, \"unit\": \"m\"},\n"
      "    \"i_peak\": {\"value\": #, \"unit\": \"A\"}\n  },\n"
      "  \"to\": {\n    \"firing.angle\": {\"value\": #, \"unit\": \"deg\"}\n  },\n"
      "  \"derivatives\": {\n    \"p_min\": {\n      \"firing.angle\": #\n    },\n"
      "    \"i_peak\": {\n      \"firing.angle\": #\n    }\n  },\n"
      "  \"errors\": {\n    \"p_min\": {\n      \"firing.angle\": #\n    },\n"
      "    \"i_peak\": {\n      \"firing.angle\": #\n    }\n  },\n"
      "  \"how\": {\n    \"p_min\": {\n      \"firing.angle\": \"exact\"\n    },\n"
      "    \"i_peak\": {\n      \"firing.angle\": \"exact\"\n    }\n  },\n"
      "  \"notes\": [\n  ],\n  \"warnings\": []\n}\n";
  ran r = run("sensitivity paper --of p_min,i_peak --to firing.angle --json --quiet -o out "
              "--set run.tier=switched --set run.until=20ms");
  char *file = read_file("out/summary.json");
  CU_ASSERT_STRING_EQUAL(r.out, file);
  make_shape(r.out);
  EXPECT(strstr(r.out, SHAPE), "%s", r.out);
  free(file), free_ran(&r);
  static const char HEAD[] = "measure,key,derivative,error,how,measure_value,measure_unit,"
                             "key_value,key_unit,warnings\np_min,firing.angle,";
  char *rows = read_file("out/sensitivity.csv");
  EXPECT(!strncmp(rows, HEAD, sizeof HEAD - 1) && strstr(rows, ",exact,-0.0") &&
             strstr(rows, ",m,100,deg,\ni_peak,firing.angle,"),
         "%s", rows);
  free(rows);
  remove_tree("out");
  mkdir("out", 0777); /* one of the files cannot be written: none is */
  mkdir("out/summary.json", 0777);
  r = run("sensitivity paper --of p_min --to firing.angle -o out --set run.tier=switched "
          "--set run.until=20ms");
  EXPECT(r.status == 2 && strstr(r.err, "out/summary.json: cannot be written"), "%d %s", r.status,
         r.err);
  EXPECT_FILES("out", "summary.json ");
  free_ran(&r);
  remove_tree("out");
}

/* One bar alone, to the right and to the left. */
static void one_bar_is_drawn(void) {
  static const char *const TO[] = {"supply.voltage", "firing.angle"};
  if (!on_path("gnuplot")) return;
  for (size_t k = 0; k < COUNT(TO); k++) {
    vs_error err = {0};
    const vs_sensitivity_options o = {.of = "i_peak", .to = TO[k], .folder = "out"};
    EXPECT(!command(o, &err), "%s", err.text);
    EXPECT(!vs_tornado_draw("out", true, &err), "%s: %s", TO[k], err.text);
    remove_tree("out");
  }
}

/* ---- docs/sensitivity.md ---- */

/* Copy of the n-th fenced block of that kind, from 0. */
static char *block(const char *page, const char *kind, int n) {
  char fence[32];
  snprintf(fence, sizeof fence, "\n```%s\n", kind);
  const char *begin = strstr(page, fence);
  for (; begin && n > 0; n--) begin = strstr(begin + 1, fence);
  CU_ASSERT_PTR_NOT_NULL_FATAL(begin);
  char *text = vs_copy(begin + strlen(fence));
  *strstr(text, "\n```") = '\0';
  return text;
}

/* Words are equal, or as numbers to 1e-8; the errors in the table's last line are of rounding. */
static void the_page_is_right(void) {
  char *page = read_file(VS_TEST_FOLDER "/../docs/sensitivity.md"), *word, *other;
  char *line = block(page, "sh", 0), *text = block(page, "text", 0), *rest = text, *printed;
  ran r = run("%s", line + strlen("vibrospice "));
  expect_good(&r, line, __LINE__);
  for (printed = r.out; (word = strsep(&rest, " \n"));) {
    if (!*word) continue;
    do other = strsep(&printed, " \n");
    while (other && !*other);
    char *end;
    double number = strtod(word, &end);
    bool same = other && (!strcmp(word, other) ||
                          (!*end && fabs(number - atof(other)) <= 1e-8 + 1e-8 * fabs(number)));
    EXPECT(same, "the page says %s, the program %s", word, other ? other : "nothing");
    if (!same) break;
  }
  free_ran(&r), free(line), free(text);
  text = block(page, "yaml", 0), line = block(page, "sh", 1);
  write_file("angles.yaml", text);
  r = run("%s", line + strlen("vibrospice "));
  expect_good(&r, line, __LINE__);
  free_ran(&r), free(line), free(text);
  char *table = read_file("angles/study.csv");
  EXPECT(strstr(table, ",p_min_to_firing.angle,p_min_to_firing.angle_error,") != NULL, "%s", table);
  EXPECT(strstr(table, ",100,-5.36327253") != NULL, "%s", table);
  free(table), free(page);
}

/* ---- what is said, and refused ---- */

/* At 78.9932590 degrees the orbit touches the stop (branch's own number). */
static void grazing_is_told(void) {
  const vs_asked of = {"p_min", {0}}, to = {"firing.angle", {0}};
  const vs_sensitivity_order order = {&of, &to, 1, 1, 1, NULL, 0};
  const char *const near[] = {"firing.every=1", "firing.angle=78.99327deg", STOP, NULL};
  const char *const off[] = {"firing.every=1", "firing.angle=78.995deg", STOP, NULL};
  for (int k = 0; k < 2; k++) {
    vs_sensitivity s;
    vs_trial *t = vs_trial_read("paper", "switched", k ? off : near);
    vs_status status = vs_sensitivity_find(&t->scene, &order, &s, &t->err);
    EXPECT(!status, "%s", t->err.text);
    EXPECT((strstr(s.notes.text, "a contact with a stop comes or goes") != NULL) == !k, "%d: %s", k,
           s.notes.text);
    vs_sensitivity_free(&s);
    vs_trial_free(t);
  }
}

/* At 78.2 degrees the orbit of period 2 has a multiplier -3.16. */
static void an_unstable_orbit_is_told(void) {
  const vs_asked of = {"p_min", {0}}, to = {"firing.angle", {0}};
  const vs_sensitivity_order order = {&of, &to, 1, 1, 2, NULL, 0};
  const char *const sets[] = {"firing.every=1", "firing.angle=78.2deg",
                              "actuator.stop={stiffness: 3e6 N/m, damping: 1000 N.s/m}", NULL};
  vs_sensitivity s;
  vs_trial *t = vs_trial_read("paper", "switched", sets);
  vs_status status = vs_sensitivity_find(&t->scene, &order, &s, &t->err);
  EXPECT(!status && strstr(s.notes.text, "the orbit is unstable"), "%s%s", t->err.text,
         status ? "" : s.notes.text);
  vs_sensitivity_free(&s);
  vs_trial_free(t);
}

/* The exact derivatives to one key take at most 3 runs of 10 cycles and the fan's, twice; those to
 * a further one are beyond 50 cycles. Fired in each of them, no run ends early. What is told stays,
 * what is not is no number, and the error says how far it came. */
static void a_budget_is_kept(void) {
  const vs_asked of = {"p_min", {0}};
  const vs_asked to[] = {
      {"supply.voltage", {0}}, {"actuator.gap", {0}}, {"actuator.resistance", {0}}};
  const char *const sets[] = {"run.until=0.2s", "firing.every=1", NULL};
  const vs_sensitivity_order order = {.of = &of, .to = to, .n_of = 1, .n_to = 3, .most_cycles = 50};
  vs_sensitivity s;
  vs_trial *t = vs_trial_read("paper", "switched", sets);
  vs_status status = vs_sensitivity_find(&t->scene, &order, &s, &t->err);
  EXPECT(status == VS_BUDGET && s.told == 1, "%d %zu %s", status, s.told, t->err.text);
  EXPECT(strstr(t->err.text, "budget of 50 cycles of the mains on the ideal tiers is spent: the "
                             "derivatives to 1 of 3 keys are told, and those from actuator.gap on"),
         "%s", t->err.text);
  CU_ASSERT(s.entry[0].value > 0 && isnan(s.entry[1].value) && isnan(s.entry[2].value));
  CU_ASSERT(!t->scene.order.budget);
  vs_sensitivity_free(&s);
  vs_trial_free(t);
}

/* A case without the measure fails by itself; bad names are the study's own mistakes. */
static void studies_refuse(void) {
  static const struct {
    const char *section, *why;
  } ROWS[] = {{"{of: [p_minn], to: [firing.angle]}", "no measure 'p_minn'"},
              {"{of: [p_min], to: [firing.angel]}", "no key 'firing.angel'"},
              {"{of: [p_min]}", "{of: [MEASURE, ...], to: [KEY, ...]} is wanted"},
              {"{of: [p_min], too: [firing.angle]}", "did you mean 'to'"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[256];
    snprintf(text, sizeof text, "scene: paper\nsensitivity: %s\n", ROWS[k].section);
    write_file("wrong.yaml", text);
    ran r = run("check wrong.yaml");
    EXPECT(r.status == VS_INPUT && strstr(r.err, ROWS[k].why) && strstr(r.err, "wrong.yaml:2:"),
           "%d %s", r.status, r.err);
    free_ran(&r);
  }
}

static void what_is_refused(void) {
  static char late[] = "firing.angle=180deg", brief[] = "run.until=12ms";
  static const struct {
    const char *of, *to;
    bool steady;
    char *set;
    const char *why;
  } ROWS[] = {
      {"p_minn", "firing.angle", false, NULL, "no measure 'p_minn' on tier switched; did you mean"},
      {"p_min", "firing.angel", false, NULL, "no key 'firing.angel'; did you mean 'firing.angle'"},
      {"p_min", "firing.every", false, NULL, "is a whole number"},
      {"p_min", "supply.kind", false, NULL, "is a word"},
      {"p_min", "machine.base_com", false, NULL, "is a pair"},
      {"p_min", "actuator.stop", false, NULL, "has keys of its own"},
      {"p_min", "actuator.stop.stiffness", false, NULL, "is no number in this scene"},
      {"p_min", "firing.angle", true, NULL, "needs continuous firing, not 'once'"},
      {"p_min", "firing.angle", false, late, "out of range"},
      {"power_in", "firing.angle", false, NULL, "no measure 'power_in'"},
      {"p_min", NULL, false, NULL, "--to KEY,... is wanted"},
      {NULL, "firing.angle", false, NULL, "--of MEASURE,... is wanted"},
      {"p_min,", "firing.angle", false, NULL, "a name is missing"},
      {"p_min,p_min", "firing.angle", false, NULL, "a second time"},
      {"p_min,t_extinction", "firing.angle", false, brief, "t_extinction: this run has none"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char *sets[] = {ROWS[k].set};
    vs_error err = {0};
    vs_status status = command((vs_sensitivity_options){.of = ROWS[k].of,
                                                        .to = ROWS[k].to,
                                                        .steady = ROWS[k].steady,
                                                        .sets = sets,
                                                        .n_sets = ROWS[k].set ? 1 : 0},
                               &err);
    EXPECT(status == VS_INPUT && strstr(err.text, ROWS[k].why), "%zu: %d %s", k, status, err.text);
  }
  ran r = run("sensitivity paper --of p_min --to firing.angle --period 2");
  EXPECT(r.status == VS_INPUT && strstr(r.err, "write --steady, too"), "%d %s", r.status, r.err);
  free_ran(&r);
}

/* ---- early ends ---- */

/* Finds the derivatives of one or two measures in half a second of the single shot. */
static vs_status find_both(const char *const *of, size_t n_of, const char *to, long most_cycles,
                           vs_sensitivity *s) {
  const char *const sets[SETS] = {"run.until=0.5s"};
  const vs_asked measures[] = {{of[0], {0}}, {n_of > 1 ? of[1] : NULL, {0}}}, key = {to, {0}};
  const vs_sensitivity_order order = {measures, &key, n_of, 1, 0, NULL, most_cycles};
  vs_trial *t = vs_trial_read("paper", "switched", sets);
  vs_status status = vs_sensitivity_find(&t->scene, &order, s, &t->err);
  vs_trial_free(t);
  return status;
}

/* f_resonance is settled after a second. So it makes the other's runs go on to their end, which is
 * more than the budget allows. That they end before it changes nothing. */
static void runs_end_where_all_is_settled(void) {
  static const char *const OF[] = {"p_first_peak", "p_second_peak", "i_peak",      "energy_in",
                                   "p_min",        "p_max",         "ap_peak",     "u_max",
                                   "aphi_peak",    "stroke",        "t_extinction"},
                           *const TO[] = {"firing.angle", "machine.trough_mass",
                                          "supply.frequency"};
  for (size_t k = 0; k < COUNT(OF); k++)
    for (size_t j = 0; j < COUNT(TO); j++) {
      const char *const both[] = {OF[k], "f_resonance"};
      vs_sensitivity alone = {0}, whole = {0};
      CU_ASSERT_EQUAL(find_both(both, 1, TO[j], 0, &alone), VS_OK);
      CU_ASSERT_EQUAL(find_both(both, 2, TO[j], 0, &whole), VS_OK);
      const vs_sensitivity_entry a = alone.entry[0], b = whole.entry[0];
      EXPECT(a.exact == b.exact && fabs(a.value - b.value) <= a.error + b.error, /* their own */
             "%s to %s: %.12g, and %.12g", OF[k], TO[j], a.value, b.value);
      vs_sensitivity_free(&alone);
      vs_sensitivity_free(&whole);
      CU_ASSERT_EQUAL(find_both(both, 2, TO[j], 20, &whole), VS_BUDGET);
      vs_sensitivity_free(&whole);
    }
  vs_sensitivity s = {0};
  CU_ASSERT_EQUAL(find_both(OF, 1, TO[0], 20, &s), VS_OK);
  vs_sensitivity_free(&s);
}

static const vs_test TESTS[] = {
    {"the orbit has the published ones", the_orbit_has_the_published_ones},
    {"the single shot has the published ones", the_single_shot_has_the_published_ones},
    {"kin are as runs are", kin_are_as_runs_are},
    {"events move", events_move},
    {"corners are told", corners_are_told},
    {"JSON has all keys", json_has_all_keys},
    {"zeros are told", zeros_are_told},
    {"edges are taken from one side", edges_are_taken_from_one_side},
    {"a circuit is differenced", a_circuit_is_differenced},
    {"compiled steps are differentiated", compiled_steps_are_differentiated},
    {"compiled orbits are differentiated", compiled_orbits_are_differentiated},
    {"files are written", files_are_written},
    {"one bar is drawn", one_bar_is_drawn},
    {"the page is right", the_page_is_right},
    {"grazing is told", grazing_is_told},
    {"runs end where all is settled", runs_end_where_all_is_settled},
    {"an unstable orbit is told", an_unstable_orbit_is_told},
    {"a budget is kept", a_budget_is_kept},
    {"studies refuse", studies_refuse},
    {"what is refused", what_is_refused},
};

int main(void) {
  return program_suite("sensitivity", TESTS, COUNT(TESTS));
}
