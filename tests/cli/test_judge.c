/* SPDX-License-Identifier: GPL-3.0-or-later
 * The verdict's lines in a study's rows, and `judge`, which holds them against other limits. What
 * it says is compared with studies that are run with these limits: the same numbers, to the 12
 * digits that a row has of each. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/csv.h"
#include "base/text.h"
#include "program.h"
#include "suite.h"

/* Every margin has its error. Where one case shows as much as three do, it is run alone. */
static const char STUDY[] =
    "set: {circuit: {deck: halfwave_paper, thyristor: TYN1212}, run: {until: 24 ms, verify: "
    "always,\n"
    "  tolerance: 1e-3}%s}\n"
    "vary: {firing.angle: [%s]}\nreport: [thyristor.v_reverse]\n",
                  THREE[] = "60 deg, 100 deg, 140 deg", ONE[] = "100 deg";

enum { MOST = 256 };
typedef struct table {
  char *text, *name[MOST], *cell[8][MOST];
  size_t columns, rows;
} table;

static void near(double value, double want, double within) {
  EXPECT(fabs(value - want) <= within, "%.15g, want %.15g", value, want);
}

static table read_table(const char *path) {
  table t = {.text = read_file(path)};
  char *line = t.text, *end;
  for (; line && *line && t.rows < 8; line = end) {
    end = strchr(line, '\n');
    if (end) *end++ = '\0';
    char **into = t.columns ? t.cell[t.rows] : t.name;
    const size_t n = vs_csv_split(line, into, MOST, NULL);
    if (t.columns) t.rows++;
    if (!t.columns) t.columns = n;
    CU_ASSERT_EQUAL(n, t.columns);
  }
  return t;
}

static const char *cell_of(const table *t, size_t row, const char *name) {
  for (size_t k = 0; k < t->columns; k++)
    if (!strcmp(t->name[k], name)) return t->cell[row][k];
  EXPECT(false, "no column %s", name);
  return "";
}

static double number_of(const table *t, size_t row, const char *name) {
  return atof(cell_of(t, row, name));
}

static void run_study(const char *folder, const char *angles, const char *more) {
  char text[1024];
  snprintf(text, sizeof text, STUDY, more, angles);
  write_file("s.yaml", text);
  ran r = run("study s.yaml -o %s --quiet --overwrite", folder);
  EXPECT(r.status == 0 || r.status == 3, "%s: %d %s", more, r.status, r.err);
  free_ran(&r);
}

/* A row's margin is that of its stress; margin_least is that of the weakest line. */
static void lines_of_a_row(void) {
  run_study("plain", THREE, "");
  table t = read_table("plain/study.csv");
  CU_ASSERT_EQUAL_FATAL(t.rows, 3);
  for (size_t k = 0; k < t.rows; k++) {
    const double stress = number_of(&t, k, "thyristor.v_reverse_v");
    near(number_of(&t, k, "margin.thyristor.v_reverse"), 1 - stress / 1200, 1e-11);
    EXPECT(number_of(&t, k, "error.thyristor.v_reverse") > 0, "%zu", k);
    const double at_s = number_of(&t, k, "at.thyristor.v_reverse_s");
    EXPECT(at_s > 0 && at_s < 24e-3, "%g", at_s);
    /* of its limits the one over the time at which the current comes nearest to its curve */
    EXPECT(number_of(&t, k, "margin.fuse_1.i_overload") > 0.9, "%zu", k);
    EXPECT(!strstr(cell_of(&t, k, "warnings"), "has no column"), "%zu", k);
    char number[64];
    snprintf(number, sizeof number, "margin.%s", cell_of(&t, k, "weakest"));
    CU_ASSERT_STRING_EQUAL(cell_of(&t, k, number), cell_of(&t, k, "margin_least"));
  }
  free(t.text);
}

/* Limits of the scene's own are lines, too. What judge makes of 900 V is what a study with that
 * limit has, whether it is said as a limit or as a part of the part's 1200 V. */
static void another_limit(void) {
  run_study("rated", THREE, ", ratings: {thyristor.v_reverse: '.. 900 V'}");
  table rated = read_table("rated/study.csv");
  static const char *const SETS[] = {"limits.thyristor.v_reverse=900V",
                                     "hold.thyristor.v_reverse=0.75"};
  for (size_t s = 0; s < COUNT(SETS); s++) {
    ran r = run("judge plain -o judged --set %s", SETS[s]);
    EXPECT(r.status == 0 || r.status == 3, "%d %s", r.status, r.err);
    table judged = read_table("judged/judged.csv");
    CU_ASSERT_EQUAL_FATAL(judged.rows, 3);
    for (size_t k = 0; k < 3; k++) {
      near(number_of(&judged, k, "margin_least"), number_of(&rated, k, "margin_least"), 1e-11);
      /* which part of the error grows with 1 / 0.75 a row does not say */
      const double error = number_of(&judged, k, "margin_error"),
                   want = number_of(&rated, k, "margin_error");
      EXPECT(error >= want && error < want / 0.75, "%g, %g", error, want);
      CU_ASSERT_STRING_EQUAL(cell_of(&judged, k, "status"), cell_of(&rated, k, "status"));
    }
    free(judged.text);
    free_ran(&r);
  }
  free(rated.text);
}

/* Without a word it says what the study said. */
static void as_it_was(void) {
  ran r = run("judge plain -o judged --json");
  table plain = read_table("plain/study.csv"), judged = read_table("judged/judged.csv");
  for (size_t k = 0; k < 3; k++)
    for (size_t c = 0; c < 2; c++) {
      static const char *const SAME[] = {"status", "margin_least"};
      CU_ASSERT_STRING_EQUAL(cell_of(&plain, k, SAME[c]), cell_of(&judged, k, SAME[c]));
    }
  EXPECT(strstr(r.out, "\"changed\": 0"), "%s", r.out);
  free_ran(&r);
  free(plain.text), free(judged.text);
}

/* A margin of the house is wanted of every line; a line that is waived breaks nothing. */
static void house_and_waivers(void) {
  ran r = run("judge plain --set hold.margin=99.9%%");
  EXPECT(r.status == 3 && strstr(r.out, "violated              0          3"), "%d %s", r.status,
         r.out);
  free_ran(&r);
  r = run("judge plain --set hold.thyristor.v_reverse=0.1");
  CU_ASSERT_EQUAL(r.status, 3);
  free_ran(&r);
  r = run("judge plain --set hold.thyristor.v_reverse=0.1 --set waive=[thyristor]");
  CU_ASSERT_EQUAL(r.status, 0);
  free_ran(&r);
  r = run("judge plain --set hold.thyristor.v_reverse=0.1 --set waive=[thyristor.v_reverse]");
  EXPECT(r.status == 0, "%d %s %s", r.status, r.out, r.err);
  free_ran(&r);
}

/* Writes the folder `edited`: the first row of `plain`, with another cell and another status. */
static void edit(const char *column, const char *cell, const char *status) {
  table plain = read_table("plain/study.csv");
  vs_text text = {0};
  for (size_t c = 0; c < plain.columns; c++)
    vs_text_add(&text, "%s%s", c ? "," : "", plain.name[c]);
  for (size_t c = 0; c < plain.columns; c++) {
    vs_text_add(&text, "%s", c ? "," : "\n");
    vs_csv_cell(&text, !strcmp(plain.name[c], column)     ? cell
                       : !strcmp(plain.name[c], "status") ? status
                                                          : plain.cell[0][c]);
  }
  vs_text_add(&text, "\n");
  char *manifest = read_file("plain/manifest.json");
  mkdir("edited", 0777);
  write_file("edited/manifest.json", manifest);
  write_file("edited/study.csv", text.text);
  vs_text_free(&text);
  free(manifest);
  free(plain.text);
}

/* The other limit of a rating of the scene, as of a study that is run with it. A stress of -0.3 mm
 * is nearer to -0.31 mm than to -1 mm. */
static void limits_below_zero(void) {
  static const struct {
    const char *before, *set, *now;
  } ROWS[] = {{"p: '-1 mm ..'", "limits.p=-0.31mm", "p: '-0.31 mm ..'"},
              {"p: '-1 mm ..'", "limits.p=-2mm", "p: '-2 mm ..'"},
              {"p: '.. -1 mm'", "limits.p=-2mm", "p: '.. -2 mm'"},
              {"i: '-10 A .. 10 A'", "hold.i=0.2", "i: '-2 A .. 2 A'"}};
  for (size_t n = 0; n < COUNT(ROWS); n++) {
    char more[64];
    snprintf(more, sizeof more, ", ratings: {%s}", ROWS[n].before);
    if (!n || strcmp(ROWS[n].before, ROWS[n - 1].before)) run_study("before", ONE, more);
    snprintf(more, sizeof more, ", ratings: {%s}", ROWS[n].now);
    run_study("now", ONE, more);
    ran r = run("judge before -o judged --quiet --set %s", ROWS[n].set);
    table now = read_table("now/study.csv"), judged = read_table("judged/judged.csv");
    CU_ASSERT_EQUAL_FATAL(judged.rows, 1);
    near(number_of(&judged, 0, "margin_least"), number_of(&now, 0, "margin_least"), 1e-10);
    CU_ASSERT_STRING_EQUAL(cell_of(&judged, 0, "weakest"), cell_of(&now, 0, "weakest"));
    CU_ASSERT_STRING_EQUAL(cell_of(&judged, 0, "status"), cell_of(&now, 0, "status"));
    free_ran(&r);
    free(now.text), free(judged.text);
  }
}

/* What happened, as cells have it, and what each criterion makes of that: A nothing may happen, B
 * it may fire or misfire, C a fuse may open besides; without one only what was expected may. */
static void criteria(void) {
  static const struct {
    const char *happened, *words[4]; /* without a criterion, by A, B, C */
  } ROWS[] = {
      {"misfire of thyristor at 0.01 s (x), as expected", {"held", "violated", "held", "held"}},
      {"unintended_firing of thyristor at 0.01 s (dv/dt)",
       {"violated", "violated", "held", "held"}},
      {"fuse_opens of fuse_2 at 0.01 s (x), in one of two runs",
       {"undecided", "undecided", "undecided", "held"}},
      {"misfire of thyristor at 0.01 s (x) | fuse_arcs_again of fuse_2 at 0.02 s (x)",
       {"violated", "violated", "violated", "violated"}},
      {"fuse_opens of fuse_2 did not happen, though expected",
       {"violated", "held", "held", "held"}},
      {"misfire of thyristor at 0.01 s (x), as expected, in one of two runs",
       {"undecided", "undecided", "held", "held"}},
      {"misfire of thyristor did not happen, though expected, in one of two runs",
       {"undecided", "held", "held", "held"}}};
  static const char *const SETS[] = {"", "--set criterion=A", "--set criterion=B",
                                     "--set criterion=C"};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    edit("happened", ROWS[k].happened, strcmp(ROWS[k].words[0], "held") ? "3" : "0");
    for (size_t s = 0; s < COUNT(SETS); s++) {
      ran r = run("judge edited -o judged --quiet %s", SETS[s]);
      table judged = read_table("judged/judged.csv");
      CU_ASSERT_EQUAL_FATAL(judged.rows, 1);
      EXPECT(!strcmp(cell_of(&judged, 0, "verdict"), ROWS[k].words[s]), "%s, %s: %s",
             ROWS[k].happened, SETS[s], cell_of(&judged, 0, "verdict"));
      CU_ASSERT_EQUAL(r.status, strcmp(ROWS[k].words[s], "held") ? 3 : 0);
      free(judged.text);
      free_ran(&r);
    }
  }
}

/* A row whose status says more than its lines, as of a part that nothing watches, does not hold. A
 * line without a column has no margin that could be the house's. What is no number is refused. */
static void edited_rows(void) {
  static const char UNWATCHED[] = "u has no column: its margin is 0.05";
  static const struct {
    const char *column, *cell, *status, *set;
    int ends;
    const char *says;
  } ROWS[] = {{"why", "", "3", "", 3, "undecided             1          1"},
              {"warnings", UNWATCHED, "0", "", 0, "held                  1          1"},
              {"warnings", UNWATCHED, "0", "--set hold.margin=1e-6", 3,
               "undecided             0          1"},
              {"margin.thyristor.v_reverse", "-0.1", "0", "", 2,
               "edited/study.csv:2:1: the row's status is 0, and its lines are violated"},
              {"margin.thyristor.v_reverse", "0.1 V", "0", "", 2,
               "edited/study.csv:2:1: margin.thyristor.v_reverse: '0.1 V' is no number"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    edit(ROWS[k].column, ROWS[k].cell, ROWS[k].status);
    ran r = run("judge edited %s", ROWS[k].set);
    EXPECT(r.status == ROWS[k].ends && strstr(r.status == 2 ? r.err : r.out, ROWS[k].says),
           "%zu: %d %s %s", k, r.status, r.out, r.err);
    free_ran(&r);
  }
}

/* The scene rates what it waives of the part: the rating counts, with what the house wants. */
static void a_rating_beside_a_waiver(void) {
  run_study("own", ONE,
            ", ratings: {thyristor.v_reverse: '.. 1100 V'}, waive: [thyristor.v_reverse]");
  ran r = run("judge own --set hold.margin=50%% --json");
  EXPECT(strstr(r.out, "{\"name\": \"thyristor.v_reverse\", \"part_of_limit\": 1, \"waived\": "
                       "false, \"broken_as_run\": 0, \"broken_now\": 1}"),
         "%s%s", r.out, r.err);
  free_ran(&r);
}

/* Rows of criterion B have the limits of dv/dt waived. Criterion A asks for them, and a row does
 * not say whether the scene waived them besides: what would break is undecided. */
static void what_a_criterion_waived(void) {
  run_study("b", ONE, ", expect: [B]");
  static const char *const ROWS[][2] = {{"b", "\"held\": 1"},
                                        {"b --set criterion=B", "\"held\": 1"},
                                        {"b --set criterion=A", "\"undecided\": 1"},
                                        {"plain", "\"undecided\": 3"},
                                        {"plain --set criterion=B", "\"held\": 3"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("judge %s --json --set hold.thyristor.dv_dt=1e-9", ROWS[k][0]);
    const char *now = strstr(r.out, "\"now\"");
    EXPECT(now && strstr(now, ROWS[k][1]), "%s: %s%s", ROWS[k][0], r.out, r.err);
    free_ran(&r);
  }
}

/* What a fuse has to pass to open counts no more where it opened in both runs and may. Else it is
 * undecided here, as errors grow with the limit's smaller part. */
static void a_fuse_that_may_open(void) {
  static const char *const ROWS[][2] = {
      {"fuse_opens of fuse_2 at 0.01 s (x)", "held"},
      {"fuse_opens of fuse_2 at 0.01 s (x), in one of two runs", "undecided"},
      {"fuse_opens of fuse_1 at 0.01 s (x)", "undecided"},
      {"", "undecided"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    edit("happened", ROWS[k][0], *ROWS[k][0] ? "3" : "0");
    ran r = run("judge edited -o judged --quiet --set criterion=C --set "
                "hold.fuse_2.i2t_surge=1e-9");
    table judged = read_table("judged/judged.csv");
    CU_ASSERT_EQUAL_FATAL(judged.rows, 1);
    EXPECT(!strcmp(cell_of(&judged, 0, "verdict"), ROWS[k][1]), "%s: %s", ROWS[k][0],
           cell_of(&judged, 0, "verdict"));
    free(judged.text);
    free_ran(&r);
  }
}

/* What judge makes of rows run under A is what a study under the criterion has: what its criterion
 * left out breaks nothing and is not the weakest line. Of the two threats the surge fires the
 * thyristor, and the coil's short circuit opens a fuse. */
static void as_under_that_criterion(void) {
  for (const char *c = "ABC"; *c; c++) {
    char text[512];
    snprintf(text, sizeof text,
             "set: {circuit.deck: halfwave_paper, firing.every: 1, run.until: 40 ms}\n"
             "threats:\n"
             "  s: {kind: surge, cycle: 1, angle: [355 deg], level: 1 kV, criterion: %c}\n"
             "  c: {kind: coil_short, angle: [100 deg], fraction: [100 %%], criterion: %c}\n"
             "report: [p_min]\n",
             *c, *c);
    write_file("c.yaml", text);
    ran r = run("study c.yaml -o c%c --quiet", *c);
    EXPECT(r.status == (*c == 'C' ? 0 : 3), "%c: %d %s", *c, r.status, r.err);
    free_ran(&r);
    r = run("judge cA -o judged --quiet --set criterion=%c", *c);
    free_ran(&r);
    char study[32];
    snprintf(study, sizeof study, "c%c/study.csv", *c);
    table own = read_table(study), judged = read_table("judged/judged.csv");
    CU_ASSERT_EQUAL_FATAL(judged.rows, 3);
    for (size_t k = 0; k < 3; k++) {
      CU_ASSERT_STRING_EQUAL(cell_of(&judged, k, "status"), cell_of(&own, k, "status"));
      if (*cell_of(&own, k, "status") == '3') continue; /* what happened may be the weakest */
      CU_ASSERT_STRING_EQUAL(cell_of(&judged, k, "weakest"), cell_of(&own, k, "weakest"));
      CU_ASSERT_STRING_EQUAL(cell_of(&judged, k, "margin_least"), cell_of(&own, k, "margin_least"));
    }
    free(own.text), free(judged.text);
  }
}

/* A margin without an error holds by its sign alone, which is told. */
static void margins_without_errors(void) {
  write_file("n.yaml", "set: {circuit: {deck: halfwave_paper, thyristor: TYN1212},\n"
                       "  run: {until: 12 ms, verify: never}}\n"
                       "vary: {firing.angle: [100 deg]}\nreport: [p_min]\n");
  RUN_GOOD("study n.yaml -o never --quiet");
  ran r = run("judge never --json"), all = run("judge plain --json");
  EXPECT(r.status == 0 && strstr(r.out, "\"unverified\": 1,"), "%s%s", r.out, r.err);
  EXPECT(strstr(all.out, "\"unverified\": 0,"), "%s", all.out);
  free_ran(&r), free_ran(&all);
}

static void refused(void) {
  static const char *const ROWS[][2] = {
      {"judge plain --set circuit.thyristor=TYN1012", "as another part has another model"},
      {"judge plain --set supply.voltage=400V", "supply changes the run itself"},
      {"judge plain --set hold.thyristor.v_rev=0.8", "have no line 'thyristor.v_rev'"},
      {"judge plain --set hold.margin=2", "a part of the limit is wanted, 0 to 1"},
      {"judge plain --set limits.thyristor.v_reverse=900A", "one limit is wanted, in V"},
      {"judge plain --set limits.v_ak=900V", "the line has two ends"},
      {"judge plain --set limits.fuse_1.i_overload=5A", "another limit from case to case"},
      {"judge rated_0 --set limits.i=5A", "a limit of 0"},
      {"judge rated_0 --set hold.i=2", "a limit of 0"},
      {"judge rated_0 --set hold.thyristor.v_reverse=0.9", "two ends on one side of 0"},
      {"judge plain --set hold=10%", "hold: a line is wanted"},
      {"judge plain --set limits=[1]", "limits: a line is wanted"},
      {"judge plain --set hold.margin=[1]", "a number is wanted"},
      {"judge plain --set criterion=D", "criterion: A (nothing happens)"},
      {"judge plain --set waive=[p_min]", "have no line 'p_min'"},
      {"judge nowhere", "manifest.json"}};
  run_study("rated_0", ONE, ", ratings: {i: '.. 0 A', thyristor.v_reverse: '1 V .. 5 kV'}");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("%s", ROWS[k][0]);
    EXPECT(r.status == 2 && strstr(r.err, ROWS[k][1]) && !*r.out, "%s: %d %s", ROWS[k][0], r.status,
           r.err);
    free_ran(&r);
  }
}

/* d ln margin / d ln voltage from two runs, against `sensitivity`, which tells its own error. */
static void sensitivity_of_a_margin(void) {
  static const char LINE[] = "margin.thyristor.v_reverse";
  write_file("v.yaml",
             "set: {circuit: {deck: halfwave_paper, thyristor: TYN1212}, run.until: 24 ms}\n"
             "vary: {supply.voltage: [438 V, 440 V, 442 V]}\nreport: [p_min]\n");
  ran r = run("study v.yaml -o v --quiet");
  free_ran(&r);
  table t = read_table("v/study.csv");
  CU_ASSERT_EQUAL_FATAL(t.rows, 3);
  const double by_runs =
      (number_of(&t, 2, LINE) - number_of(&t, 0, LINE)) / (4. / 440) / number_of(&t, 1, LINE);
  r = run("sensitivity paper --set circuit.deck=halfwave_paper --set circuit.thyristor=TYN1212 "
          "--set run.until=24ms --of %s,margin_least --to supply.voltage --json",
          LINE);
  const char *of = strstr(r.out, "\"derivatives\""), *found = of ? strstr(of, LINE) : NULL;
  const char *value = found ? strstr(found, "\"supply.voltage\": ") : NULL;
  EXPECT(r.status == 0 && value, "%d %s %s", r.status, r.out, r.err);
  /* the middle of three runs is off by the square of 0.5 %, and each margin by 1e-3 of the limit */
  if (value) near(atof(value + strlen("\"supply.voltage\": ")), by_runs, 0.1 * fabs(by_runs));
  free_ran(&r);
  free(t.text);
}

int main(void) {
  static const vs_test TESTS[] = {{"lines of a row", lines_of_a_row},
                                  {"as it was", as_it_was},
                                  {"another limit", another_limit},
                                  {"limits below zero", limits_below_zero},
                                  {"house and waivers", house_and_waivers},
                                  {"criteria", criteria},
                                  {"edited rows", edited_rows},
                                  {"a rating beside a waiver", a_rating_beside_a_waiver},
                                  {"what a criterion waived", what_a_criterion_waived},
                                  {"a fuse that may open", a_fuse_that_may_open},
                                  {"as under that criterion", as_under_that_criterion},
                                  {"margins without errors", margins_without_errors},
                                  {"refused", refused},
                                  {"sensitivity of a margin", sensitivity_of_a_margin}};
  return program_suite("judge", TESTS, COUNT(TESTS));
}
