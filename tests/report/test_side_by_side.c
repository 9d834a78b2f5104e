/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command compare: two runs and two studies side by side. And the picture of a run's verdict.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "program.h"
#include "report/curve_difference.h"
#include "report/margin_bars.h"

static void write_run(const char *folder, const char *csv, const char *summary) {
  char path[64];
  mkdir(folder, 0777);
  snprintf(path, sizeof path, "%s/run.csv", folder);
  write_file(path, csv);
  snprintf(path, sizeof path, "%s/summary.json", folder);
  write_file(path, summary);
}

/* A straight line from 0 to 2 over 2 s and a bent one, whose rows have other times. B - A is 0 at 0
 * s, 1 at 0.5 s, -0.5 at 1.5 s: the integral of its square is 0.5 (1)/3 + 1 (1 - 0.5 + 0.25)/3. */
static void departure(void) {
  double left[] = {0, 0, 1, 1, 2, 2}, right[] = {0, 0, 0.5, 1.5, 1.5, 1};
  char *names[] = {"t_s", "y"};
  vs_traces a = {.name = names, .value = left, .columns = 2, .rows = 3},
            b = {.name = names, .value = right, .columns = 2, .rows = 3};
  vs_curve_difference d = vs_curve_difference_of(&a, 1, &b, 1);
  CLOSE(d.largest, 1, 1e-15);
  CLOSE(d.at_s, 0.5, 1e-15);
  CLOSE(d.peak, 1.5, 1e-15); /* A at 1.5 s, where both end being known */
  CLOSE(d.to_s, 1.5, 1e-15);
  CLOSE(d.rms, sqrt((0.5 + 0.75) / 3 / 1.5), 1e-14);
  d = vs_curve_difference_of(&b, 1, &a, 1);
  CLOSE(d.largest, -1, 1e-15);
  double late[] = {3, 0, 4, 1};
  vs_traces c = {.name = names, .value = late, .columns = 2, .rows = 2};
  CU_ASSERT(isnan(vs_curve_difference_of(&a, 1, &c, 1).largest));
}

static const char A[] =
    "{\"tier\": \"circuit\",\n"
    " \"scene\": {\"firing\": {\"angle\": {\"value\": 100, \"unit\": \"deg\"}},\n"
    "  \"circuit\": {\"r1\": {\"value\": 0.03, \"unit\": \"ohm\"}}},\n"
    " \"measures\": {\"i_peak\": {\"value\": 0.8, \"unit\": \"A\"},\n"
    "  \"x\": {\"value\": null, \"unit\": \"m\"}},\n"
    " \"verdict\": [{\"device\": \"t1\", \"measure\": \"di_dt\", \"margin\": 0.5,"
    " \"word\": \"held\", \"violated\": false}]}\n";
static const char B[] =
    "{\"tier\": \"switched\",\n"
    " \"scene\": {\"firing\": {\"angle\": {\"value\": 95, \"unit\": \"deg\"}},\n"
    "  \"circuit\": {\"r1\": {\"value\": 30, \"unit\": \"mohm\"}}},\n"
    " \"measures\": {\"i_peak\": {\"value\": 1.0, \"unit\": \"A\"},\n"
    "  \"x\": {\"value\": 0.002, \"unit\": \"m\"}},\n"
    " \"verdict\": [{\"device\": \"t1\", \"measure\": \"di_dt\", \"margin\": -0.1,"
    " \"word\": \"unverified\", \"violated\": true},\n"
    "  {\"device\": \"t2\", \"measure\": \"i_rms\", \"stress\": 1.5, \"limit\": 2, \"unit\": \"A\","
    " \"margin\": 0.25, \"word\": \"held\", \"violated\": false}]}\n";

static void make_runs(void) {
  write_run("a", "t_s,i_a,v_v,q_j\n0,0,1,0\n1,2,1,0\n2,0,,0\n", A);
  write_run("b", "t_s,i_a,w_v\n0,0,1\n0.5,2,1\n2,0,1\n", B);
}

static void expect_lines(const char *out, const char *const *lines, int line) {
  for (; *lines; lines++) expect(strstr(out, *lines) != NULL, line, "no '%s' in: %s", *lines, out);
}

static void runs(void) {
  static const char *const TABLE[] = {
      "A: a, tier circuit, from 0 s to 2 s\n",
      "  the whole                                      held     violated, unverified\n",
      "  t1.di_dt                                50.0 % held",
      "  t2.i_rms                                          -              25.0 % held\n",
      "-10.0 % violated, unverified\n",
      "  firing.angle                        100 deg           95 deg\n\n",
      "  i_peak                               800 mA              1 A           200 mA       +25 "
      "%\n",
      "  x                                         -             2 mm                -           "
      "-\n",
      "  i_a                                  2             1       500 ms        50 %      23.6 "
      "%\n",
      "  only A has v_v, q_j\n  only B has w_v\n",
      NULL};
  static const char JSON[] =
      "{\n  \"compared\": \"runs\",\n"
      "  \"a\": {\"folder\": \"a\", \"tier\": \"circuit\", \"until_s\": 2, \"verdict\": "
      "\"held\"},\n"
      "  \"b\": {\"folder\": \"b\", \"tier\": \"switched\", \"until_s\": 2, \"verdict\": "
      "\"violated, unverified\"},\n"
      "  \"keys\": [\n    {\"key\": \"firing.angle\", \"a\": \"100 deg\", \"b\": \"95 deg\"}\n  "
      "],\n"
      "  \"verdict\": [\n"
      "    {\"name\": \"t1.di_dt\", \"a\": {\"margin\": 0.5, \"unit\": \"\", \"word\": \"held\"}, "
      "\"b\": {\"margin\": -0.1, \"unit\": \"\", \"word\": \"unverified\"}},\n"
      "    {\"name\": \"t2.i_rms\", \"a\": null, \"b\": {\"stress\": 1.5, \"limit\": 2, "
      "\"margin\": 0.25, \"unit\": \"A\", \"word\": \"held\"}}\n  ],\n"
      "  \"measures\": {\n"
      "    \"i_peak\": {\"unit\": \"A\", \"a\": 0.8, \"b\": 1, \"difference\": 0.2, \"relative\": "
      "0.25},\n"
      "    \"x\": {\"unit\": \"m\", \"a\": null, \"b\": 0.002, \"difference\": null, \"relative\": "
      "null}\n  },\n"
      "  \"curves\": {\n"
      "    \"i_a\": {\"peak\": 2, \"largest\": 1, \"at_s\": 0.5, \"rms\": 0.471404520791, "
      "\"largest_relative\": 0.5, \"rms_relative\": 0.235702260396}\n  },\n"
      "  \"only_a\": [\"v_v\", \"q_j\"],\n  \"only_b\": [\"w_v\"]\n}\n";
  make_runs();
  ran r = run("compare a b");
  expect_good(&r, "compare", __LINE__);
  expect_lines(r.out, TABLE, __LINE__);
  free_ran(&r);
  r = run("compare a b --json");
  expect_good(&r, "compare --json", __LINE__);
  CU_ASSERT_STRING_EQUAL(r.out, JSON);
  free_ran(&r);
  r = run("compare a a");
  static const char *const SAME[] = {
      "keys that differ                            A                B\n"
      "  there is none\n",
      "  2 measures are the same in both\n", "  3 curves are the same in both\n", NULL};
  expect_lines(r.out, SAME, __LINE__);
  CU_ASSERT_EQUAL(count_lines(r.err), 0);
  free_ran(&r);
}

/* The whole is as its worst line, whichever that is; without a line there is no limit. */
static void the_whole(void) {
  static const struct {
    const char *words[3], *whole; /* with a '-' before it: its margin is below 0 */
  } ROWS[] = {{{NULL}, "no limit stated"},
              {{"waived"}, "waived"},
              {{"held", "waived"}, "held"},
              {{"waived", "unverified", "held"}, "unverified"},
              {{"undecided", "unverified"}, "undecided"},
              {{"undecided", "-unverified", "held"}, "violated, unverified"},
              {{"-violated", "-unverified"}, "violated"},
              {{"held", "-violated"}, "violated"}};
  make_runs();
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text summary = {0};
    char says[96];
    vs_text_add(&summary,
                "{\"tier\": \"circuit\", \"scene\": {}, \"measures\": {}, \"verdict\": [");
    for (int n = 0; n < 3 && ROWS[k].words[n]; n++) {
      const char *word = ROWS[k].words[n];
      const bool below = *word == '-';
      vs_text_add(&summary, "%s{\"rating\": \"r%d\", \"word\": \"%s\", \"violated\": %s}",
                  n ? ", " : "", n, word + below, below ? "true" : "false");
    }
    vs_text_add(&summary, "]}\n");
    write_run("whole", "t_s,i_a\n0,0\n1,2\n", summary.text);
    vs_text_free(&summary);
    ran r = run("compare whole b");
    snprintf(says, sizeof says, "  the whole                  %24s     violated, unverified\n",
             ROWS[k].whole);
    EXPECT(r.status == 0 && strstr(r.out, says), "%s: %d %s%s", ROWS[k].whole, r.status, r.out,
           r.err);
    free_ran(&r);
  }
}

/* Folders that are no runs, and broken files, each with its place. */
static void refused(void) {
  static const struct {
    const char *csv, *at, *says[3];
  } BROKEN[] = {{"i_a,t_s\n0,0\n", "vibrospice: broken/run.csv:1:1: ", {"first column"}},
                {"t_s,i_a\n0,0\n1,x\n", "vibrospice: broken/run.csv:3:3: ", {"'x'", "number"}},
                {"t_s,i_a\n0,0\n1\n", "vibrospice: broken/run.csv:3:1: ", {"2 cells"}},
                {"t_s,i_a\n0,0\n1,2,3\n", "vibrospice: broken/run.csv:3:3: ", {"2 cells"}},
                {"t_s,i_a\n1,0\n0,0\n", "vibrospice: broken/run.csv:3:1: ", {"time"}},
                {"t_s,i_a\n", "vibrospice: broken/run.csv:2:1: ", {"no rows"}}};
  make_runs();
  mkdir("empty", 0777);
  for (size_t k = 0; k < COUNT(BROKEN); k++) {
    write_run("broken", BROKEN[k].csv, A);
    ran r = run("compare a broken");
    EXPECT(r.status == 2 && !*r.out && count_lines(r.err) == 1, "%zu: %d, %s", k, r.status, r.err);
    EXPECT(!strncmp(r.err, BROKEN[k].at, strlen(BROKEN[k].at)), "%zu: %s", k, r.err);
    expect_lines(r.err, BROKEN[k].says, __LINE__);
    free_ran(&r);
  }
  write_run("broken", "t_s,i_a\n0,0\n", "{\"what\": 1}\n");
  static const char *const CASES[][2] = {{"compare a broken", "measures"},
                                         {"compare a empty", "neither a run nor a study"},
                                         {"compare a nowhere", "neither a run nor a study"},
                                         {"compare a", "two folders"},
                                         {"compare a b a", "two folders"}};
  for (size_t k = 0; k < COUNT(CASES); k++) {
    ran r = run("%s", CASES[k][0]);
    EXPECT(r.status == 2 && !*r.out && count_lines(r.err) == 1 && strstr(r.err, CASES[k][1]),
           "%s: %d, %s", CASES[k][0], r.status, r.err);
    free_ran(&r);
  }
}

/* A run that ends before the gate's pulse has no time of firing. Such a row is in no difference,
 * and is counted. */
static void values_that_are_gone(void) {
  write_file("fires.yaml", "scene: paper\nset: {run: {tier: switched, until: 9.9 ms}}\n"
                           "vary: {firing.angle: [90 deg, 150 deg]}\nreport: [t_fire, tau_p]\n");
  free_ran((ran[]){run("study fires.yaml -o fires --quiet")});
  free_ran((ran[]){run("study fires.yaml -o ends --set run.until=8ms --quiet")});
  static const char *const TABLE[] = {"0  case 0; 1 in A alone\n", "-            -            -\n",
                                      NULL};
  ran r = run("compare fires ends");
  expect_good(&r, "compare", __LINE__);
  expect_lines(r.out, TABLE, __LINE__);
  free_ran(&r);
  static const char *const JSON[] = {"\"only_a\": 0, \"only_b\": 1, \"at_case_a\": 0", NULL};
  r = run("compare ends fires --json");
  expect_lines(r.out, JSON, __LINE__);
  free_ran(&r);
  /* columns are found by their names; what only one reports is left out */
  write_file("wider.yaml", "scene: paper\nset: {run: {tier: switched, until: 9.9 ms}}\n"
                           "vary: {firing.angle: [90 deg, 150 deg]}\n"
                           "report: [i_peak, t_fire, p_min]\n");
  free_ran((ran[]){run("study wider.yaml -o wider --quiet")});
  static const char COLUMNS[] =
      "  \"columns\": {\n    \"t_fire_s\": {\"least_a\": 0.005, \"largest_a\": 0.00833333333333, "
      "\"least_b\": 0.005, \"largest_b\": 0.00833333333333, \"mean_difference\": 0, "
      "\"largest_difference\": 0, \"only_a\": 0, \"only_b\": 0, \"at_case_a\": 0, \"at_case_b\": "
      "0},\n"
      "    \"margin_least\": {";
  r = run("compare fires wider --json");
  EXPECT(strstr(r.out, COLUMNS), "%s", r.out);
  free_ran(&r);
}

/* Studies: rows are joined by their axes, in whatever order they come, else by their number. */
static void studies(void) {
  static const char FILE_OF[] =
      "scene: paper\n"
      "set: {run: {tier: circuit, until: 12 ms}, circuit.thyristor: TYN1212}\n"
      "vary:\n  %s\n  %s\n"
      "report: [thyristor.di_dt]\n";
  static const char R1[] = "circuit.r1: [10 ohm, 100 ohm]", C1[] = "circuit.c1: [10 nF, 100 nF]";
  char text[512];
  snprintf(text, sizeof text, FILE_OF, R1, C1);
  write_file("one.yaml", text);
  snprintf(text, sizeof text, FILE_OF, C1, R1);
  write_file("turned.yaml", text);
  snprintf(text, sizeof text, FILE_OF, R1, "circuit.c2: [10 nF, 100 nF]");
  write_file("other.yaml", text);
  free_ran((ran[]){run("study one.yaml -o one --set firing.angle=95deg --quiet")});
  free_ran((ran[]){run("study turned.yaml -o turned --set firing.angle=160deg --quiet")});
  free_ran((ran[]){run("study other.yaml -o other --quiet")});
  /* 10 ohm and 100 nF are case 1 of the one and, their axes being turned, case 2 of the other. */
  static const char *const JOINED[] = {
      "one, 4 cases with a result, 0 failed; 3 of 4 judged are held",
      "4 rows joined by the values of their axes; 0 in A alone",
      "verdict: 1 of the joined rows has another word\n"
      "  case 1: violated, B's case 2: held\n",
      "-157  case 2\n", NULL};
  ran r = run("compare one turned");
  expect_good(&r, "compare", __LINE__);
  expect_lines(r.out, JOINED, __LINE__);
  free_ran(&r);
  static const char *const NUMBERED[] = {"4 rows joined by the number of the case", NULL};
  r = run("compare one other");
  expect_lines(r.out, NUMBERED, __LINE__);
  free_ran(&r);
  static const char *const JSON[] = {
      "{\n  \"compared\": \"studies\",\n"
      "  \"a\": {\"folder\": \"one\", \"rows\": 4, \"failed\": 0, \"judged\": 4, \"held\": 3},\n"
      "  \"b\": {\"folder\": \"turned\", \"rows\": 4, \"failed\": 0, \"judged\": 4, \"held\": 4},\n"
      "  \"joined_by\": \"axes\",\n  \"joined\": 4,\n  \"changed\": 1,\n  \"changes\": [\n"
      "    {\"case_a\": 1, \"word_a\": \"violated\", \"case_b\": 2, \"word_b\": \"held\"}\n  ],\n"
      "  \"columns\": {\n    \"thyristor.di_dt_a_us\": {\"least_a\": ",
      "\"only_a\": 0, \"only_b\": 0, \"at_case_a\": 1, \"at_case_b\": 2}", NULL};
  r = run("compare one turned --json");
  expect_lines(r.out, JSON, __LINE__);
  free_ran(&r);
  make_runs();
  r = run("compare a one");
  EXPECT(r.status == 2 && strstr(r.err, "a holds a run and one a study"), "%s", r.err);
  free_ran(&r);
}

static void expect_page(const char *name, const char *const *says, int line) {
  char *html = read_file(name);
  expect_lines(html, says, line);
  EXPECT(!strstr(html, "src=\"http") && !strstr(html, "href=\"http"), "%s needs other files", name);
  free(html);
}

/* The page says what the table says, whatever the folders are called; it takes no run's place. */
static void pages(void) {
  static const char *const STUDIES[] = {
      "<h1>Compare one and turned</h1>",
      "class=\"verdict bad\">\n<p>A: one</p>\n<p class=\"big\">3 of 4 judged are held</p>",
      "<p>4 rows joined by the values of their axes; 0 in A alone, 0 in B alone. 1 of the joined",
      "<tr><td class=\"n\">1</td><td>violated</td><td class=\"n\">2</td><td>held</td></tr>",
      "<tr><td>thyristor.di_dt_a_us</td>",
      "</html>\n",
      NULL};
  static const char *const RUNS[] = {
      "<h1>Compare a and b&lt;</h1>",
      "class=\"verdict good\">\n<p>A: a</p>\n<p class=\"big\">held</p>\n<p>tier circuit, until 2 s",
      "class=\"verdict bad\">\n<p>B: b&lt;</p>\n<p class=\"big\">violated, unverified</p>",
      "<tr><td>firing.angle</td><td>100 deg</td><td>95 deg</td></tr>\n</table>",
      "<td>t1.di_dt</td><td class=\"n\">50.0 %</td><td>held</td><td class=\"n\">-10.0 %</td>"
      "<td>violated, unverified</td>",
      "<td>i_peak</td><td class=\"n\">800 mA</td><td class=\"n\">1 A</td><td class=\"n\">200 "
      "mA</td>"
      "<td class=\"n\">+25 %</td>",
      "<td>x</td><td class=\"n\">-</td><td class=\"n\">2 mm</td><td class=\"n\">-</td>",
      "<figcaption>i_a <output></output></figcaption>",
      "<td>i_a</td><td class=\"n\">2</td><td class=\"n\">1</td><td class=\"n\">500 ms</td>",
      "<p>Only A has v_v, q_j.</p>",
      "</html>\n",
      NULL};
  RUN_GOOD("compare one turned -o new/page --quiet");
  expect_page("new/page/report.html", STUDIES, __LINE__);
  EXPECT_FILES("new/page", "report.html ");
  ran r = run("compare a b -o one");
  EXPECT(r.status == 2 && !*r.out && strstr(r.err, "-o one: holds a study"), "%s", r.err);
  free_ran(&r);
  make_runs();
  if (!on_path("gnuplot")) return;
  write_run("b<", "t_s,i_a,w_v\n0,0,1\n0.5,2,1\n2,0,1\n", B);
  r = run("compare a 'b<' -o both");
  expect_good(&r, "compare -o", __LINE__);
  EXPECT(!strncmp(r.out, "A: a, tier circuit", 18) && strstr(r.out, "\nboth/report.html\n"), "%s",
         r.out);
  free_ran(&r);
  expect_page("both/report.html", RUNS, __LINE__);
}

/* ---- the picture of a run's verdict ---- */

typedef struct judged {
  const char *device, *measure, *unit;
  double stress, limit, margin, error; /* NAN: null */
  const char *word;
} judged;

/* Lines of each word, in another order than that of the picture; two more than it has room for. */
static const judged JUDGED[] = {
    {"t1", "dv_dt", "V/us", 175, 200, 0.125, 0.01, "held"},
    {"t1", "t_q", "us", 5500, 50, 109, 1, "held"},
    {"t1", "di_dt", "A/us", 101, 100, -0.01, 0.02, "undecided"},
    {"t1", "i_h", "mA", 9, 10, 0.1, NAN, "undecided"},
    {"t2", "v_rrm", "V", 3, NAN, NAN, NAN, "undecided\", \"unknown\": \"PART states no v_rrm"},
    {"m1", "i_peak", "A", 300, 200, -0.5, 0.01, "violated"},
    {"f`1\\\"", "opens", "", 3, 0, -1, 0, "violated"},
    {"w", "power", "W", 3, 2, -0.5, 0.01, "waived"},
    {"a1", "x", "V", 1, 10, 0.9, 0, "held"},
    {"a2", "x", "V", 1, 20, 0.95, 0, "held"},
    {"a3", "x", "V", 3, 10, 0.7, NAN, "unverified"},
    {"a4", "x", "V", 4, 10, 0.6, 0, "held"},
    {"a5", "x", "V", 5, 10, 0.5, 0, "held"}};

static void add_member(vs_text *json, const char *key, double value) {
  vs_text_add(json, isnan(value) ? ", \"%s\": null" : ", \"%s\": %.9g", key, value);
}

static void add_judged(vs_text *json, const judged *j) {
  vs_text_add(json, "{\"device\": \"%s\", \"measure\": \"%s\", \"unit\": \"%s\", \"word\": \"%s\"",
              j->device, j->measure, j->unit, j->word);
  add_member(json, "stress", j->stress);
  add_member(json, "limit", j->limit);
  add_member(json, "margin", j->margin);
  add_member(json, "margin_error", j->error);
  vs_text_add(json, ", \"violated\": %s},\n", j->margin < 0 ? "true" : "false");
}

/* A run whose verdict has these lines, and before them one of a probe's rating. */
static void write_verdict(void) {
  vs_text json = {0};
  vs_text_add(&json, "{\"verdict\": [\n");
  for (size_t k = 0; k < COUNT(JUDGED); k++) add_judged(&json, &JUDGED[k]);
  vs_text_add(&json, "{\"rating\": \"v_ak\", \"unit\": \"V\", \"min\": -1200, \"max\": 2000, "
                     "\"least\": -923.8, \"largest\": 936.2, \"margin\": 0.230167, "
                     "\"margin_error\": 0.001, \"word\": \"held\", \"violated\": false}],\n"
                     "\"columns\": [{\"name\": \"p_m\", \"quantity\": \"p\", \"unit\": \"m\", "
                     "\"role\": \"coordinate\", \"of\": \"machine\"}],\n"
                     "\"happened\": [{\"what\": \"fuse_opens\", \"device\": \"f`1\", \"at_s\": "
                     "0.022, \"times\": 3, \"cause\": \"a short\", \"expected\": false}]}\n");
  write_run("v", "t_s,p_m,i_a\n0,0,1\n1,2,1\n2,0,1\n", json.text);
  vs_text_free(&json);
}

/* Each text stands behind the one before it. */
static void expect_order(const char *text, const char *const *says, int line) {
  for (const char *at = text; *says; says++) {
    const char *found = strstr(at, *says);
    expect(found != NULL, line, "no '%s' where it belongs in: %s", *says, text);
    if (found) at = found + strlen(*says);
  }
}

/* What is not held for certain comes first, then the tightest; every word has its colour, and what
 * has no room is counted. */
static void bars_in_order(void) {
  static const char *const SAYS[] = {
      "\"verdict: violated, nominal values\"",
      "\"happened: fuse_opens of f\\1401 at 22 ms (a short)\"",
      "\"f\\1401\\042.opens happened, 3 times, violated\"",
      "\"m1.i_peak 300 of 200 A, violated\"",
      "\"t2.v_rrm: PART states no v_rrm, undecided\"",
      "\"t1.di_dt 101 of 100 A/us, undecided\"",
      "\"t1.i_h 9 of 10 mA, undecided\"",
      "\"t1.dv_dt 175 of 200 V/us, held\"",
      "\"v_ak -923.8 of -1200 V, held\"",
      "\"a5.x 5 of 10 V, held\"",
      "\"a4.x 4 of 10 V, held\"",
      "\"a3.x 3 of 10 V, unverified\"",
      "\"a1.x 1 of 10 V, held\"",
      "\"a2.x 1 of 20 V, held\"",
      "\"2 more: 1 waived, the rest above 100 \\045\"",
      "first -100, first -0.34 to first 0, first 0.34 fillstyle solid 0.9 noborder fillcolor rgb "
      "\"#d55e00\"",
      "from first -51, first 1 to first -49, first 1 heads",
      "\"-50 \\045\" at first 0, first 1 left",
      "first -1, first 2.66 to first 0, first 3.34 fillstyle solid 0.9 noborder fillcolor rgb "
      "\"#e69f00\"",
      "from first -100, first 4 to first 100, first 4 heads", /* its error is not known */
      "first 0, first 4.66 to first 12.5, first 5.34 fillstyle solid 0.9 noborder fillcolor rgb "
      "\"#0072b2\"",
      "from first 11.5, first 5 to first 13.5, first 5 heads",
      "\"12.5 \\045\" at first 13.5, first 5 left",
      "fillcolor rgb \"#999999\"", /* unverified */
      NULL};
  vs_tree tree = {0};
  vs_error err = {0};
  vs_script script = {0};
  int size[2];
  write_verdict();
  CU_ASSERT_EQUAL(vs_tree_read("v/summary.json", &tree, &err), VS_OK);
  CU_ASSERT(vs_margin_bars_script(tree.root, false, &script, size));
  expect_order(script.text.text, SAYS, __LINE__);
  EXPECT(!strchr(script.text.text, '`'), "%s", script.text.text);
  vs_gnuplot_free(&script);
  vs_tree_free(&tree);
}

/* A margin beyond the axis is drawn to its end; a lower limit says so; corners stand in the title.
 */
static void bars_beyond(void) {
  static const char *const SAYS[] = {"\"verdict: held, 7 of 8 corners held\"",
                                     "\"t1.t_q 5500 of at least 50 us, held\"",
                                     "first 0, first -0.34 to first 100, first 0.34",
                                     "\"above 100 \\045\" at first 100, first 0 left", NULL};
  static const char TEXT[] =
      "{\"verdict\": [{\"device\": \"t1\", \"measure\": \"t_q\", \"unit\": \"us\", \"stress\": "
      "5500, "
      "\"limit\": 50, \"margin\": 109, \"margin_error\": 1, \"word\": \"held\", \"violated\": "
      "false}], \"corners\": {\"of\": 8, \"held\": 7}}";
  vs_tree tree = {0};
  vs_error err = {0};
  vs_script script = {0};
  int size[2];
  CU_ASSERT_EQUAL(vs_tree_parse(TEXT, "text", &tree, &err), VS_OK);
  CU_ASSERT(vs_margin_bars_script(tree.root, true, &script, size));
  expect_order(script.text.text, SAYS, __LINE__);
  vs_gnuplot_free(&script);
  vs_tree_free(&tree);
}

/* A relay lies on its far stop as the run begins, which is no event; its page has when it pulled
 * in; where it does not, the warning says what would judge it. */
static void a_relay_is_told(void) {
  RUN_GOOD("run relay --set run.until=12ms --set run.verify=never -o v --quiet");
  char *events = read_file("v/events.csv");
  EXPECT(!strncmp(events, "t_s,what\n0,switched on\n0.003", 28) &&
             strstr(events, ",armature meets the stop on the pole's side\n"),
         "%s", events);
  free(events);
  if (on_path("gnuplot")) {
    RUN_GOOD("plot v --quiet");
    char *html = read_file("v/report.html");
    EXPECT(strstr(html, "<p>pull_in 9.05") && !strstr(html, "&lt;p&gt;"), "its page lacks pull_in");
    free(html);
  }
  for (int rated = 0; rated < 2; rated++) {
    ran r = run("run /dev/null --set machine.model=relay --set supply.voltage=3V --set "
                "run.until=8ms%s",
                rated ? " --set 'ratings={pull_in: .. 20 ms}'" : "");
    EXPECT(strstr(r.err, "warning: pull_in did not occur before 8 ms: ") &&
               (strstr(r.err, "; the verdict judges it by a rating, as ratings: {pull_in: .. 20 ms}"
                              "\n") == NULL) == rated,
           "%s", r.err);
    free_ran(&r);
  }
  remove_tree("v");
}

/* It stands first in what `plot` lists, and below the table of the page. A run without a verdict
 * has none, and the next run removes it. */
static void bars_drawn(void) {
  static const char *const PAGE[] = {"<h1>Run v</h1>", "<section id=\"verdict\"",
                                     "<iframe title=\"verdict\"",
                                     "m1.i_peak 300 of 200 A, violated", NULL};
  if (!on_path("gnuplot")) return;
  write_verdict();
  ran r = run("plot v");
  EXPECT(r.status == 0 && !*r.err && !strncmp(r.out, "v/verdict.png\nv/verdict.svg\nv/motion", 36),
         "%d %s%s", r.status, r.out, r.err);
  free_ran(&r);
  char *html = read_file("v/report.html"), *svg = read_file("v/verdict.svg");
  expect_order(html, PAGE, __LINE__);
  EXPECT(strstr(svg, "2 more: 1 waived, the rest above 100 %") != NULL, "%s", svg);
  free(html), free(svg);
  RUN_GOOD("run paper --set run.until=20ms -o v --quiet");
  EXPECT_FILES("v", "events.csv run.csv summary.json ");
  RUN_GOOD("plot v --quiet");
  CU_ASSERT_NOT_EQUAL(access("v/verdict.png", F_OK), 0);
  html = read_file("v/report.html");
  EXPECT(!strstr(html, "<iframe title=\"verdict\""), "a picture of no verdict");
  free(html);
  remove_tree("v");
}

static const vs_test TESTS[] = {{"departure", departure},
                                {"runs", runs},
                                {"the whole", the_whole},
                                {"refused", refused},
                                {"studies", studies},
                                {"values that are gone", values_that_are_gone},
                                {"pages", pages},
                                {"bars in order", bars_in_order},
                                {"bars beyond", bars_beyond},
                                {"bars drawn", bars_drawn},
                                {"a relay is told", a_relay_is_told}};

int main(void) {
  return program_suite("side_by_side", TESTS, COUNT(TESTS));
}
