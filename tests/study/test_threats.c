/* SPDX-License-Identifier: GPL-3.0-or-later
 * Threats of a study: which cases they are, that each is the scene that `run` would make of its
 * keys, what a criterion allows, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "read_study.h"
#include "study/method/span.h"
#include "study/threats.h"
#include "study/workers/case.h"
#include "study/workers/identity.h"

#define SAYS(text, what) EXPECT(strstr(text, what), "%s is not in: %s", what, text)

#define SCENE                                                                                      \
  "scene: paper\nset: {circuit.deck: halfwave_paper, firing.every: 1, run.until: 60 ms}\n"

/* ---- which cases ---- */

static const char FIVE[] = SCENE
    "threats:\n"
    "  n: 3\n"
    "  seed: 5\n"
    "  surge: {kind: surge, angle: any, polarity: any, level: [0.5 kV, 1 kV, 2 kV]}\n"
    "  dip: {kind: sag, angle: 90 deg .. 180 deg, duration: [5 ms, 10 ms], n: 8}\n"
    "  lost: {kind: open, element: [C1, C2], from: start, criterion: B}\n"
    "  both: {kind: open, element: C1, from: start, with: surge, live: [thyristor]}\n"
    "  warm: {kind: phase_jump, at: 2 ms, jump: -60 deg .. 60 deg, start: steady, until: 45 ms}\n";

static size_t axis_of(const vs_plan *plan, const char *column) {
  size_t k = 0;
  while (k < plan->n_axes && strcmp(plan->axes[k].column, column) != 0) k++;
  EXPECT(k < plan->n_axes, "no column %s", column);
  return k < plan->n_axes ? k : 0;
}

/* Six combinations are more than n: 3; of eight points, each eighth of the range has one. */
static void listed_and_cut(void) {
  study *s = good_study(FIVE);
  const vs_plan *plan = &s->plan;
  const size_t angle = axis_of(plan, "threat.angle_deg"), level = axis_of(plan, "threat.level_kv"),
               with = axis_of(plan, "with.level_kv"),
               duration = axis_of(plan, "threat.duration_ms");
  double point[VS_PLAN_AXES];
  int eighths[8] = {0}, levels[3] = {0}, long_ones = 0;
  CU_ASSERT_EQUAL(plan->count, 6 + 8 + 2 + 6 + 3 + 1);
  CU_ASSERT_STRING_EQUAL(plan->axes[0].column, "threat");
  for (uint64_t k = 0; k < plan->count; k++) {
    vs_plan_point(plan, k, point);
    const char *threat = plan->axes[0].word[(size_t)point[0]];
    const bool surge = !strcmp(threat, "surge"), both = !strcmp(threat, "both"),
               dip = !strcmp(threat, "dip");
    CU_ASSERT_EQUAL(isnan(point[level]), !surge);
    CU_ASSERT_EQUAL(isnan(point[with]), !both);
    CU_ASSERT_EQUAL(isnan(point[angle]), !surge && !dip);
    if (surge) levels[point[level] == 2 ? 2 : point[level] == 1 ? 1 : 0]++;
    if (dip) eighths[(int)((point[angle] - 90) / 90 * 8)]++;
    if (dip) long_ones += point[duration] == 10;
    CU_ASSERT_EQUAL(!strcmp(threat, "none"), k == plan->count - 1);
  }
  for (int k = 0; k < 8; k++) CU_ASSERT_EQUAL(eighths[k], 1);
  for (int k = 0; k < 3; k++) CU_ASSERT_EQUAL(levels[k], 2);
  CU_ASSERT_EQUAL(long_ones, 4);
  drop_study(s);
}

/* Any part of the deck: what its parameters choose or give a value, and neither sources, nor the
 * mains' impedance, nor the EVA. A thyristor is shorted from anode to cathode, so that a
 * current of some 0.4 A flows backwards 1 ms behind its zero. */
static void any_part(void) {
  static const char *const WORDS[] = {"R1", "C1", "R2", "C2", "Xthy"};
  study *s =
      good_study("scene: paper\nset: {circuit.deck: halfwave_snubbed, circuit.thyristor: TYN1212, "
                 "run.until: 45 ms}\n"
                 "threats: {broken: {kind: short, element: any, from: start}}\n");
  const vs_axis *axis = &s->plan.axes[axis_of(&s->plan, "threat.element")];
  CU_ASSERT_EQUAL(axis->n_values, COUNT(WORDS));
  for (size_t k = 0; k < COUNT(WORDS); k++) {
    size_t n = 0;
    while (n < axis->n_values && strcmp(axis->word[n], WORDS[k]) != 0) n++;
    EXPECT(n < axis->n_values, "%s is not among them", WORDS[k]);
  }
  drop_study(s);
  ran r = run("run paper --set circuit.deck=halfwave_snubbed --set run.until=15ms --set "
              "run.verify=never --set 'events.e={kind: short, at: 9 ms, element: Xthy}' -o x");
  const char *current = strstr(r.out, "  i_thyristor ");
  EXPECT(current && strtod(current + strlen("  i_thyristor "), NULL) < -0.1, "%d %s%s", r.status,
         r.out, r.err);
  free_ran(&r);
  remove_tree("x");
}

/* Another threat leaves the numbers of this one alone, and another seed does not. */
static void keyed_by_names(void) {
  static const char *const TEXT[] = {
      SCENE "threats: {seed: 5, s: {kind: surge, angle: any}}\n",
      SCENE "threats: {seed: 5, a: {kind: sag, angle: any, n: 7}, s: {kind: surge, angle: any}}\n",
      SCENE "threats: {seed: 6, s: {kind: surge, angle: any}}\n"};
  double angle[3][16], point[VS_PLAN_AXES];
  for (int t = 0; t < 3; t++) {
    study *s = good_study(TEXT[t]);
    for (uint64_t k = 0; k < 16; k++) {
      vs_plan_point(&s->plan, k + (t == 1 ? 7 : 0), point);
      angle[t][k] = point[axis_of(&s->plan, "threat.angle_deg")];
    }
    drop_study(s);
  }
  CU_ASSERT(!memcmp(angle[0], angle[1], sizeof angle[0]));
  for (int k = 0; k < 16; k++) CU_ASSERT(angle[0][k] != angle[2][k]);
}

/* Fresh draws fill the range: of 400 even numbers the mean is off by less than five standard
 * errors, which are 0.29/20 of the range each. */
static void draws(void) {
  study *s = good_study(FIVE);
  vs_threats threats;
  vs_error err = {0};
  double value[VS_THREAT_NUMBERS], again[VS_THREAT_NUMBERS], sum = 0;
  CU_ASSERT(
      !vs_threats_read(vs_tree_child(s->plan.tree.root, "threats"), s->plan.base, &threats, &err));
  CU_ASSERT_EQUAL_FATAL(threats.count, 6);
  const vs_threat *surge = &threats.item[0];
  CU_ASSERT_EQUAL(vs_threat_combinations(surge), 6);
  CU_ASSERT(!vs_threat_is_closed(surge) && vs_threat_is_closed(&threats.item[2]));
  for (uint64_t k = 0; k < 400; k++) {
    vs_threat_draw(surge, 7, k, value);
    vs_threat_draw(surge, 7, k, again);
    CU_ASSERT(!memcmp(value, again, 3 * sizeof *value));
    CU_ASSERT(value[0] > 0 && value[0] < 360);
    sum += value[0] / 360;
  }
  CU_ASSERT_DOUBLE_EQUAL(sum / 400, 0.5, 5 * 0.29 / 20);
  vs_threats_free(&threats);
  drop_study(s);
}

/* ---- each case is a scene ---- */

enum { MOST = 32, SET = 512 };

typedef struct sets {
  char text[MOST][SET], *set[MOST];
  size_t n;
} sets;

static void add_set(sets *s, const char *text) {
  s->set[s->n] = s->text[s->n];
  snprintf(s->text[s->n++], SET, "%s", text);
}

/* What `run` is given for the case, by the manifest's `set` and the row's cells. */
static void sets_of(const vs_threats *threats, const vs_plan *plan, const double *point, sets *s) {
  const vs_threat *t = &threats->item[(size_t)point[0]];
  vs_text text = {0};
  char value[VS_NAME_SIZE], line[SET];
  s->n = 0;
  add_set(s, "circuit.deck=halfwave_paper");
  add_set(s, "firing.every=1");
  add_set(s, "run.until=60 ms");
  for (size_t k = 0; text.length = 0, vs_threats_setting(threats, t, k, &text); k++)
    add_set(s, text.text);
  vs_text_free(&text);
  for (size_t k = 0; k < vs_threat_numbers(t); k++) {
    const vs_axis *range = vs_threat_range(t, k);
    char column[VS_KEY_SIZE], suffix[64];
    vs_units_suffix(range->unit, suffix, sizeof suffix);
    snprintf(column, sizeof column, "%s.%s%s%s", k < t->n_ranges ? "threat" : "with",
             range->field->key, *suffix ? "_" : "", suffix);
    const size_t at = axis_of(plan, column);
    vs_axis_print(&plan->axes[at], point[at], value, sizeof value);
    snprintf(line, sizeof line, "%s=%.200s%s%s", range->key, value, *range->unit ? " " : "",
             range->unit);
    add_set(s, line);
  }
}

/* The study's cases, one after the other in one process, have the ids of scenes read afresh. */
static void ids_of_runs(void) {
  study *s = good_study(FIVE);
  vs_threats threats;
  vs_error err = {0};
  sets *w = vs_alloc(1, sizeof *w);
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_case *c = vs_case_new(&s->plan, NULL);
  char id[2][VS_ID_SIZE];
  double point[VS_PLAN_AXES];
  CU_ASSERT(
      !vs_threats_read(vs_tree_child(s->plan.tree.root, "threats"), s->plan.base, &threats, &err));
  for (uint64_t n = 0; n < s->plan.count; n++) {
    const uint64_t k =
        n * 7 % s->plan.count; /* each once, in another order: 26 and 7 share nothing */
    vs_identity *one = vs_identity_new(&s->plan), *other = vs_identity_new(&s->plan);
    vs_plan_point(&s->plan, k, point);
    vs_status begun = vs_case_begin(c, k, point, &err);
    EXPECT(!begun, "case %d: %s", (int)k, err.text);
    CU_ASSERT_FATAL(!begun);
    CU_ASSERT(!vs_identity_of(one, vs_case_scene(c), id[0], &err));
    sets_of(&threats, &s->plan, point, w);
    begun = vs_scene_read("paper", w->set, w->n, NULL, scene, &err);
    EXPECT(!begun, "case %d: %s", (int)k, err.text);
    CU_ASSERT_FATAL(!begun);
    CU_ASSERT(!vs_identity_of(other, scene, id[1], &err));
    EXPECT(!strcmp(id[0], id[1]), "case %d: %s and %s, %s", (int)k, id[0], id[1], w->set[3]);
    vs_scene_free(scene);
    vs_identity_free(one);
    vs_identity_free(other);
  }
  vs_case_free(c);
  vs_threats_free(&threats);
  free(scene);
  free(w);
  drop_study(s);
}

/* ---- through all readers ---- */

static const char RUNS[] =
    "scene: paper\n"
    "set: {circuit.deck: halfwave_paper, run.until: 45 ms}\n"
    "threats:\n"
    "  n: 2\n"
    "  shorted: {kind: coil_short, angle: 100 deg, fraction: [100 %], criterion: C}\n"
    "  hard: {kind: coil_short, angle: 100 deg, fraction: [100 %], criterion: B}\n"
    "  jump: {kind: phase_jump, angle: 100 deg .. 110 deg, jump: [20 deg, 30 deg]}\n"
    "  surge: {kind: surge, angle: [270 deg], polarity: any, level: 0.5 kV}\n"
    "report: [i_peak]\n";

static char *line_of(char *rows, const char *threat) {
  char wanted[64];
  snprintf(wanted, sizeof wanted, ",%s,", threat);
  char *at = strstr(rows, wanted);
  while (at > rows && at[-1] != '\n') at--;
  return at;
}

static char status_of(char *rows, const char *threat) {
  char *at = line_of(rows, threat);
  const char *end = at ? strchr(at, '\n') : NULL;
  return end ? end[-1] : '?';
}

/* C lets the fuse open, and what it has to pass to do so counts no more; B does not. The cell of a
 * range that the threat has not is empty, and every reader takes that. */
static void runs_and_readers(void) {
  write_file("runs.yaml", RUNS);
  ran r = run("study runs.yaml -o a --jobs 2");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  free_ran(&r);
  char *rows = read_file("a/study.csv");
  CU_ASSERT_EQUAL(status_of(rows, "shorted"), '0');
  CU_ASSERT_EQUAL(status_of(rows, "hard"), '3');
  CU_ASSERT_EQUAL(status_of(rows, "none"), '0');
  SAYS(rows, "A), as expected");
  SAYS(rows, ",none,,,,,"); /* fraction, angle, jump, polarity; then its i_peak */
  r = run("study runs.yaml -o alone --jobs 1 --no-sharing --quiet --format npy");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  free_ran(&r);
  char *other = read_file("alone/study.csv");
  EXPECT(!strcmp(rows, other), "with shared pasts: %s\nalone: %s", rows, other);
  free(other);
  for (int k = 1; k < 3; k++) {
    r = run("study runs.yaml -o p%d --shard %d/2 --quiet", k, k);
    free_ran(&r);
  }
  r = run("merge p1 p2 -o m --quiet");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  free_ran(&r);
  other = read_file("m/study.csv");
  CU_ASSERT_STRING_EQUAL(rows, other);
  free(other);
  r = run("study runs.yaml -o a --resume --quiet");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("plot a");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  char *page = read_file("a/report.html");
  SAYS(page, "The worst case: threat = hard, threat.fraction = 100 %");
  EXPECT(!strstr(page, " = ,"), "an axis without a value");
  free(page);
  free_ran(&r);
  r = run("compare a m");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  SAYS(r.out, "7 rows joined");
  free_ran(&r);
  r = run("judge a --set criterion=C");
  SAYS(r.out, "7 cases judged anew");
  free_ran(&r);
  char *manifest = read_file("a/manifest.json");
  SAYS(manifest, "\"name\": \"shorted\"");
  SAYS(manifest, "\"events.shorted.kind=coil_short\"");
  SAYS(manifest, "\"threat.fraction__\": \"events.shorted.fraction\"");
  free(manifest);
  free(rows);
}

/* A criterion of a scene allows, and does not demand; A allows nothing. */
static void criterion_of_a_scene(void) {
#define FIRES                                                                                      \
  "run paper --set circuit.deck=halfwave_paper --set firing.every=1 --set run.until=60ms "         \
  "--set 'events.s={kind: surge, cycle: 2, angle: 355 deg, level: 1 kV}' "
  static const struct {
    const char *set;
    int status;
    const char *says;
  } ROWS[] = {{"", 3, "happened: thyristor fires without a gate pulse"},
              {"--set expect=A", 3, "happened: thyristor fires without a gate pulse"},
              {"--set expect=B", 0, "as expected"},
              {"--set expect=[C]", 0, "waived: thyristor.dv_dt, thyristor.t_off"},
              {"--set events.s.off=true --set expect=B", 0, "held"},
              {"--set waive=[thyristor] --set expect=B", 0, "waived: thyristor\n"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run(FIRES "%s", ROWS[k].set);
    EXPECT(r.status == ROWS[k].status, "%s: %d %s%s", ROWS[k].set, r.status, r.out, r.err);
    SAYS(r.out, ROWS[k].says);
    free_ran(&r);
  }
  ran r = run("check paper --set circuit.deck=halfwave_snubbed --set expect=[C]");
  EXPECT(r.status == 2, "%d %s", r.status, r.err);
  SAYS(r.err, "criterion C lets a fuse open, and the deck has no device fuse");
  free_ran(&r);
}

/* ---- spread ---- */

/* Each varistor has its own factor, whose ends are 0.9 x 0.9 and 1.1 x 1.1; the ends of C1 are its
 * 95 nF less 20 % and 5 % more. */
static void each_part_by_itself(void) {
  study *s = good_study(SCENE "threats: {n: 40, s: {kind: phase_jump, at: 5 ms}}\n"
                              "spread:\n"
                              "  varistor: tolerance and ageing\n"
                              "  circuit.c1: -20 % .. 5 %\n"
                              "  supply.voltage: 396 V .. 484 V\n");
  static const char *const COLUMNS[] = {"circuit.varistor_1_scale", "circuit.varistor_2_scale",
                                        "circuit.varistor_3_scale", "circuit.c1_nf",
                                        "supply.voltage_v"};
  double c1 = s->plan.axes[axis_of(&s->plan, "circuit.c1_nf")].nominal;
  const double from[] = {0.81, 0.81, 0.81, 0.8 * c1, 396},
               to[] = {1.21, 1.21, 1.21, 1.05 * c1, 484};
  double least[5], largest[5], point[VS_PLAN_AXES];
  int alike = 0;
  CU_ASSERT_EQUAL(s->plan.count, 80); /* the scene itself is spread, too */
  for (uint64_t k = 0; k < 40; k++) {
    vs_plan_point(&s->plan, k, point);
    for (size_t n = 0; n < COUNT(COLUMNS); n++) {
      const double x = point[axis_of(&s->plan, COLUMNS[n])];
      least[n] = k ? fmin(least[n], x) : x;
      largest[n] = k ? fmax(largest[n], x) : x;
    }
    alike += point[axis_of(&s->plan, COLUMNS[0])] == point[axis_of(&s->plan, COLUMNS[1])];
  }
  CU_ASSERT_EQUAL(alike, 0);
  for (size_t n = 0; n < COUNT(COLUMNS); n++) { /* of 40 pieces the first and the last have one */
    const double piece = (to[n] - from[n]) / 40;
    EXPECT(least[n] >= from[n] && least[n] <= from[n] + piece, "%s: from %g", COLUMNS[n], least[n]);
    EXPECT(largest[n] <= to[n] && largest[n] >= to[n] - piece, "%s: to %g", COLUMNS[n], largest[n]);
  }
  drop_study(s);
}

/* ---- refused ---- */

static void refused(void) {
  static const struct {
    const char *threats, *at, *says[2];
  } ROWS[] = {
      {"  a: {kind: surj}", "4:13", {"no kind 'surj'; there are: surge", "did you mean 'surge'?"}},
      {"  a: {angle: any}", "4:3", {"there is no kind ''", NULL}},
      {"  a: {kind: surge, angel: any}", "4:20", {"'angel'", "did you mean 'angle'?"}},
      {"  a: {kind: surge, angle: any, criterion: D}",
       "4:43",
       {"no criterion; there are: A (nothing happens)", "C ("}},
      {"  a: {kind: surge, angle: 0 deg .. 400 deg}",
       "4:27",
       {"400 deg is out of range", "0..360"}},
      {"  a: {kind: sag, angle: 300 deg .. 60 deg}",
       "4:25",
       {"from 300 to 60 deg; the lesser end first", "past 360 deg another threat"}},
      {"  a: {kind: sag, angle: any, level: [40 V]}", "4:38", {"wrong unit", "%"}},
      {"  a: {kind: surge, every: any, at: 1 ms}",
       "4:27",
       {"needs a key with two ends", "'A .. B'"}},
      {"  a: {kind: open, element: R99, from: start}", "4:3", {"no element 'R99'", "'R1'"}},
      {"  a: {kind: open, element: [R1, R99], from: start}", "4:3", {"no element 'R99'", "'R1'"}},
      {"  a: {kind: open, element: R1, from: strike}", "4:38", {"has no generator", "15 ms"}},
      {"  a: {kind: surge, angle: any, with: b}", "4:38", {"'b' is no other threat", NULL}},
      {"  a: {kind: surge, at: 1 ms, with: a}", "4:36", {"'a' is no other threat", NULL}},
      {"  a: {kind: surge, at: 1 ms, with: b}\n  b: {kind: eft, at: 1 ms, with: c}\n"
       "  c: {kind: sag, at: 1 ms}",
       "4:36",
       {"b comes with c itself", "at most two"}},
      {"  a: {kind: surge, cycle: 3, angle: any}", "4:3", {"begins at 0.06 s", "until: 0.08 s"}},
      {"  a: {kind: sag, cycle: 1, angle: 0 deg, duration: 5 ms .. 50 ms}",
       "4:3",
       {"before what it does is over", "until: 0.07 s"}},
      {"  a: {kind: overvoltage}", "4:3", {"until: 5.02 s", NULL}},
      {"  a: {kind: surge, at: 1 ms, live: [thyristr]}",
       "4:37",
       {"no device 'thyristr'", "'thyristor'"}},
      {"  a: {kind: surge, at: 1 ms, start: warm}", "4:37", {"rest, or steady", NULL}},
      {"  a: {kind: surge, at: 1 ms, until: soon}", "4:37", {"a time is wanted", NULL}},
      {"  a: 5 kV", "4:6", {"a map is wanted", NULL}},
      {"  none: {kind: surge}", "4:3", {"the scene itself", NULL}},
      {"  a: {kind: surge, at: 1 ms}\nspread: {diode: 5 % uniform}",
       "5:10",
       {"no device of that kind", "circuit.r1"}},
      {"  a: {kind: surge, at: 1 ms}\nspread: {circuit.c1: 5 % .. -20 %}",
       "5:22",
       {"two different ends are wanted, the lesser first", NULL}},
      {"  a: {kind: surge, at: 1 ms}\nfind: {worst: min margin_least}",
       "3:1",
       {"find chooses the cases itself", NULL}}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text text = {0};
    char at[64];
    vs_text_add(&text, SCENE "threats:\n%s\n", ROWS[k].threats);
    write_file("bad.yaml", text.text);
    snprintf(at, sizeof at, "bad.yaml:%s", ROWS[k].at);
    ran r = run("check bad.yaml");
    EXPECT(r.status == 2, "%s: %d %s", ROWS[k].threats, r.status, r.err);
    SAYS(r.err, at);
    for (int n = 0; n < 2 && ROWS[k].says[n]; n++) SAYS(r.err, ROWS[k].says[n]);
    free_ran(&r);
    vs_text_free(&text);
  }
}

/* What would hold whatever the parts are. */
static void would_lie(void) {
  static const struct {
    const char *text, *says;
  } ROWS[] = {
      {"set: {circuit.deck: halfwave_snubbed, run.until: 60 ms}\n"
       "threats: {a: {kind: coil_short, at: 1 ms, criterion: C}}\n",
       "C lets a fuse open, and the deck has no device"},
      {"set: {circuit.deck: halfwave_paper, run.until: 90 ms}\n"
       "threats: {a: {kind: coil_short, cycle: 2, angle: any}}\n",
       "only shot, in cycle 1, is over"},
      {"threats: {a: {kind: sag, angle: any}}\n", "judges no part"},
      {"set: {run.tier: circuit, run.until: 60 ms}\nthreats: {a: {kind: sag, angle: any}}\n",
       "no part of the deck states a limit"},
      {"set: {circuit.deck: halfwave_paper, run.until: 60 ms,\n"
       "  events: {a: {kind: sag, at: 5 ms}}}\n"
       "threats: {a: {kind: surge, angle: any}}\n",
       "the scene has an event of that name"},
      {"spread: {circuit.r1: 5 % uniform}\nvary: {firing.angle: [90 deg]}\n",
       "goes along with threats"},
      {"set: {circuit.deck: halfwave_paper, run.until: 60 ms}\n"
       "vary: {firing.first_cycle: [1, 2]}\n"
       "threats: {a: {kind: surge, angle: [0 deg]}}\n",
       "it comes in cycle 1, that of the scene's first firing, which is in cycle 2 here"},
      /* the first case is good, and another one is not: its row must not be held */
      {"set: {circuit.deck: halfwave_paper, run.until: 60 ms}\n"
       "vary: {run.until: [60 ms, 15 ms]}\n"
       "threats: {a: {kind: surge, at: 10 ms}}\n",
       "before what it does is over"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_file("lie.yaml", ROWS[k].text);
    ran r = run("study lie.yaml -o lie --overwrite");
    EXPECT(r.status == (k + 2 >= COUNT(ROWS) ? 1 : 2), "%d %d %s", (int)k, r.status, r.err);
    char *why = r.status == 1 ? read_file("lie/failures.csv") : vs_copy(r.err);
    SAYS(why, ROWS[k].says);
    free(why);
    free_ran(&r);
  }
}

/* A pair runs to the later end of the two, with which `run` makes it again. */
static void a_pair_runs_on(void) {
  study *s =
      good_study(SCENE "threats:\n  late: {kind: sag, at: 65 ms, duration: 5 ms, until: 0.1 s}\n"
                       "  both: {kind: open, element: C1, from: start, with: late}\n");
  vs_threats threats = {0};
  vs_text text = {0};
  bool told = false;
  CU_ASSERT_EQUAL(
      vs_threats_read(vs_tree_child(s->plan.tree.root, "threats"), s->plan.base, &threats, &s->err),
      VS_OK);
  for (size_t k = 0; text.length = 0, vs_threats_setting(&threats, &threats.item[1], k, &text); k++)
    told = told || !strncmp(text.text, "run.until=0.1", 13);
  EXPECT(told, "no run.until of %s", threats.item[1].name);
  vs_text_free(&text);
  vs_threats_free(&threats);
  drop_study(s);
}

/* Devices that a threat does not judge join those that the scene leaves out; none stands twice. */
static void waivers_of_a_scene_stay(void) {
  study *s = good_study("scene: paper\nset: {circuit.deck: halfwave_paper, run.until: 60 ms,\n"
                        "  waive: [varistor_1, r1.power]}\n"
                        "threats: {a: {kind: surge, at: 1 ms, live: [thyristor]}}\n");
  vs_threats threats = {0};
  vs_text text = {0};
  bool told = false;
  CU_ASSERT_EQUAL(
      vs_threats_read(vs_tree_child(s->plan.tree.root, "threats"), s->plan.base, &threats, &s->err),
      VS_OK);
  for (size_t k = 0; text.length = 0, vs_threats_setting(&threats, &threats.item[0], k, &text); k++)
    if (!strncmp(text.text, "waive=[varistor_1, r1.power, ", 29)) {
      const char *rest = text.text + 29;
      told = strstr(rest, "varistor_2") && strstr(rest, "r1") && !strstr(rest, "varistor_1") &&
             !strstr(rest, "thyristor");
    }
  EXPECT(told, "no such waivers of %s", threats.item[0].name);
  vs_text_free(&text);
  vs_threats_free(&threats);
  drop_study(s);
}

/* An opened element whose value the deck reckons with makes lines untrue, also where no second run
 * tells their errors. */
static void untrue_lines_are_undecided(void) {
  ran r = run("run paper --set circuit.deck=halfwave_paper --set run.until=30ms --set "
              "run.verify=never --set 'events.a={kind: open, element: R1, at: 0 ms}'");
  EXPECT(r.status == 3, "%d %s", r.status, r.out);
  SAYS(r.out, "undecided");
  free_ran(&r);
}

int main(void) {
  static const vs_test TESTS[] = {{"listed and cut", listed_and_cut},
                                  {"keyed by names", keyed_by_names},
                                  {"draws", draws},
                                  {"ids of runs", ids_of_runs},
                                  {"runs and readers", runs_and_readers},
                                  {"criterion of a scene", criterion_of_a_scene},
                                  {"each part by itself", each_part_by_itself},
                                  {"any part", any_part},
                                  {"refused", refused},
                                  {"would lie", would_lie},
                                  {"a pair runs on", a_pair_runs_on},
                                  {"waivers of a scene stay", waivers_of_a_scene_stay},
                                  {"untrue lines are undecided", untrue_lines_are_undecided}};
  return program_suite("threats", TESTS, COUNT(TESTS));
}
