/* SPDX-License-Identifier: GPL-3.0-or-later
 * Close-ups of runs: which stretch of time is shown, which columns are meant, spectra against
 * closed forms, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "program.h"
#include "report/margin_bars.h"
#include "report/members.h"
#include "report/plot/fourier.h"
#include "report/plot/time_window.h"

/* ---- the stretch of time ---- */

/* Adds what happens to events.csv at these instants, ms. */
static void window_of(const char *rows, double from_ms, double to_ms, const char *why, int line) {
  vs_moments m = {0};
  vs_error err = {0};
  double from, to;
  mkdir("happened", 0777);
  vs_text text = {0};
  vs_text_add(&text, "t_s,what\n%s", rows);
  write_file("happened/events.csv", text.text);
  vs_text_free(&text);
  CU_ASSERT_EQUAL(vs_time_window_read_moments("happened", &m, &err), VS_OK);
  const char *got = vs_time_window_choose(&m, 0.02, 1, &from, &to);
  vs_close(1e3 * from, from_ms, 1e3, 1e-12, rows, line);
  vs_close(1e3 * to, to_ms, 1e3, 1e-12, rows, line);
  expect(strstr(got, why) != NULL, line, "%s, not %s", got, why);
  vs_time_window_free_moments(&m);
}

static void windows(void) {
  static const char OFTEN[] = "0.1,fires\n0.12,fires\n0.14,fires\n0.16,fires\n";
  char rows[512];
  window_of("", 940, 1000, "last cycles", __LINE__);
  window_of("0.1,fires\n0.11,extinct\n", 80, 150, "what happens", __LINE__);
  window_of("0.01,fires\n0.99,extinct\n", 0, 1000, "what happens", __LINE__);
  snprintf(rows, sizeof rows, "%s0.3,\"f1 melts, and clears\"\n", OFTEN);
  window_of(rows, 280, 340, "once", __LINE__);
  snprintf(rows, sizeof rows, "0.05,x\n%s0.2,dip begins (sag)\n0.3,f1 melts\n", OFTEN);
  window_of(rows, 180, 240, "scene's events", __LINE__);
  snprintf(rows, sizeof rows, "%s%s%s", OFTEN, OFTEN, OFTEN);
  window_of(rows, 940, 1000, "last cycles", __LINE__);
}

/* ---- probes ---- */

static void probes(void) {
  char *names[] = {"t_s", "i_thyristor_a", "i_a", "p_m", "vp_m_s", "share", "v_ak_v"};
  double row[7] = {0};
  vs_traces t = {.path = "run.csv", .name = names, .value = row, .columns = 7, .rows = 1};
  t.column = vs_traces_columns(".", "t_s,i_thyristor_a,i_a,p_m,vp_m_s,share,v_ak_v", &t.columns);
  /* as summary.json tells of the rate */
  t.column[4] = vs_channel_column("vp", "m/s", VS_COLUMN_RATE, "p");
  vs_probes_shown p = {.count = 0};
  vs_probe_shown rate;
  vs_error err = {0};
  CU_ASSERT_EQUAL(vs_time_window_find_probes("i,p, v_ak_v,share", &t, &p, &err), VS_OK);
  CU_ASSERT_EQUAL_FATAL(p.count, 4);
  CU_ASSERT_STRING_EQUAL(p.item[0].column, "i_a"); /* not i_thyristor_a */
  CU_ASSERT_STRING_EQUAL(p.item[1].label, "p / mm");
  CLOSE(p.item[1].scale, 1e3, 0);
  CU_ASSERT_STRING_EQUAL(p.item[2].label, "v_ak / V");
  CU_ASSERT_STRING_EQUAL(p.item[3].label, "share");
  CU_ASSERT_TRUE_FATAL(vs_time_window_probe_rate(&p.item[1], &t, &rate));
  CU_ASSERT_STRING_EQUAL(rate.column, "vp_m_s");
  CU_ASSERT_STRING_EQUAL(rate.label, "vp / m/s");
  CU_ASSERT_FALSE(vs_time_window_probe_rate(&p.item[0], &t, &rate));
  p.count = 0;
  CU_ASSERT_EQUAL(vs_time_window_find_probes("v_ak_w", &t, &p, &err), VS_INPUT);
  CU_ASSERT_PTR_NOT_NULL(strstr(err.text, "did you mean 'v_ak_v'"));
  free(t.column);
}

/* ---- spectra ---- */

/* y = 1 + 3 sin(2 pi 50 t) + 0.2 cos(2 pi 350 t) over the rows' times; rows at equal distances make
 * the lines exact to rounding. */
static void fill(double *value, size_t rows, const double *at) {
  for (size_t r = 0; r < rows; r++) {
    value[2 * r] = at[r];
    value[2 * r + 1] = 1 + 3 * sin(2 * M_PI * 50 * at[r]) + 0.2 * cos(2 * M_PI * 350 * at[r]);
  }
}

enum { ROWS = 701 };

static void expect_lines(const double *at, double tolerance, int line) {
  char *names[] = {"t_s", "y"};
  double value[2 * ROWS];
  vs_traces t = {.path = "run.csv", .name = names, .value = value, .columns = 2, .rows = ROWS};
  vs_fourier f;
  vs_error err = {0};
  fill(value, ROWS, at);
  CU_ASSERT_EQUAL_FATAL(vs_fourier_take(&t, 1, (double[]){0.005, 0.0695}, 0.02, &f, &err), VS_OK);
  vs_close(f.span_s, 0.06, 1, 1e-12, "span", line); /* three cycles, up to 69.5 ms */
  vs_close(f.from_s, 0.0095, 1, 1e-12, "from", line);
  vs_close(f.rms[0], 1, 3, tolerance, "mean", line);
  vs_close(f.rms[3], 3 * M_SQRT1_2, 3, tolerance, "50 Hz", line);
  vs_close(f.rms[21], 0.2 * M_SQRT1_2, 3, tolerance, "350 Hz", line);
  vs_close(f.rms[4], 0, 3, tolerance, "66.7 Hz", line);
  vs_close(f.rms[6], 0, 3, tolerance, "100 Hz", line);
  free(f.rms);
}

static void spectra(void) {
  double at[ROWS];
  for (size_t r = 0; r < ROWS; r++) at[r] = 1e-4 * (double)r;
  expect_lines(at, 1e-12, __LINE__);
  /* Rows at unequal distances of at most h = 0.15 ms: a straight line between is off by at most
   * h^2/8 of the second derivative, (3 + 0.2 49) (2 pi 50)^2 h^2/8 = 3.5e-3, and its rms is less.
   */
  for (size_t r = 1; r + 1 < ROWS; r++) at[r] += r % 2 ? 0.25e-4 : -0.25e-4;
  expect_lines(at, 1.3e-3, __LINE__);
}

/* ---- the program ---- */

static void refused(void) {
  RUN_GOOD("run paper --set run.until=30ms -o one --quiet");
  RUN_GOOD("run paper --set run.until=30ms --set record=[i] -o poor --quiet");
  static const char *const CASES[][2] = {{"plot one --probe v_a", "no column 'v_a'"},
                                         {"plot one poor", "poor/run.csv has no column"},
                                         {"plot one --probe i --orbit", "no column of the rate"},
                                         {"plot one --orbit --fft", "two pictures"},
                                         {"plot one --from 5", "--from 5: a time is wanted"},
                                         {"plot one --to 0ms", "nothing is between"},
                                         {"plot one --from 40ms", "nothing is between"},
                                         {"plot one --from 10.02ms --to 10.05ms", "no row of"},
                                         {"plot one --fft --to 19ms", "no whole cycle"},
                                         {"plot one nowhere", "nowhere/run.csv"},
                                         {"plot one --probe i --overlay x.csv", "--overlay"},
                                         {"plot one --probe i -o x.pdf", ".png or .svg"}};
  for (size_t k = 0; k < COUNT(CASES); k++) {
    ran r = run("%s", CASES[k][0]);
    EXPECT(r.status == 2 && !*r.out && count_lines(r.err) == 1 && strstr(r.err, CASES[k][1]),
           "%s: %d, %s", CASES[k][0], r.status, r.err);
    free_ran(&r);
  }
  EXPECT_FILES("one", "events.csv run.csv summary.json ");
}

/* Reads a CSV file of numbers: its header, then rows. */
static double *read_numbers(const char *name, const char *header, size_t columns, size_t *rows) {
  char *text = read_file(name), *rest = text, *line = strsep(&rest, "\n");
  double *value = vs_alloc(strlen(rest) + 1, sizeof *value);
  EXPECT(!strcmp(line, header), "%s: %s", name, line);
  for (*rows = 0; (line = strsep(&rest, "\n")) && *line; ++*rows)
    for (size_t c = 0; c < columns; c++) {
      value[*rows * columns + c] = strtod(line, &line);
      CU_ASSERT_EQUAL_FATAL(*line, c + 1 < columns ? ',' : '\0');
      line++;
    }
  free(text);
  return value;
}

/* The rms of the line of that frequency, as the sum that defines it, over rows from..to. */
static double line_of(const double *row, size_t columns, size_t column, size_t from, size_t to,
                      double hertz) {
  double re = 0, im = 0, n = (double)(to - from);
  for (size_t r = from; r < to; r++) {
    double angle = 2 * M_PI * hertz * row[r * columns];
    re += row[r * columns + column] * cos(angle) / n;
    im += row[r * columns + column] * sin(angle) / n;
  }
  return (hertz > 0 ? M_SQRT2 : 1) * hypot(re, im);
}

/* spectrum.csv holds the lines of the rows of run.csv from 20 ms to 80 ms, 600 of them: each as the
 * sum that defines it. That of the mains is 440 V. Both files
 * have nine digits, so that a number in them is wrong by 5e-9 of itself at most: once in the rows,
 * whose mean is not more wrong, and once in the lines. */
static void numbers(void) {
  if (!on_path("gnuplot")) return;
  size_t rows, lines;
  RUN_GOOD("run paper --set firing.every=1 --set run.until=80ms --set record=[p,i,v_mains] -o n "
           "--quiet");
  ran r = run("plot n --probe p,i,v_mains --fft --from 15ms --to 80ms");
  expect_good(&r, "plot --fft", __LINE__);
  EXPECT(
      strstr(r.out, "n/spectrum.csv\nspectrum of n: from 20 ms to 80 ms, lines 16.67 Hz apart\n"),
      "%s", r.out);
  free_ran(&r);
  double *row = read_numbers("n/run.csv", "t_s,p_m,i_a,v_mains_v", 4, &rows),
         *line = read_numbers("n/spectrum.csv", "frequency_hz,p_rms_m,i_rms_a,v_mains_rms_v", 4,
                              &lines);
  CU_ASSERT_EQUAL_FATAL(rows, 801);
  CU_ASSERT_EQUAL_FATAL(lines, 300);
  for (size_t k = 0; k < lines; k++) {
    double hertz = (double)k / 0.06;
    vs_close(line[4 * k], hertz, 1 + hertz, 5e-9, "frequency", __LINE__);
    for (size_t c = 1; c < 4; c++)
      vs_close(line[4 * k + c], line_of(row, 4, c, 200, 800, hertz), c < 3 ? line[4 * 3 + c] : 440,
               1e-8, "line", __LINE__);
  }
  vs_close(line[4 * 3 + 3], 440, 440, 1e-8, "mains", __LINE__);
  free(row);
  free(line);
  RUN_GOOD("plot n n --probe i --fft -o two.svg --quiet");
  char *two = read_file("two_spectrum.csv");
  EXPECT(!strncmp(two, "run,frequency_hz,i_rms_a\nn,0,", 29) && count_lines(two) == 801, "%.60s",
         two);
  free(two);
  ran again = run("run paper --set run.until=10ms -o n --quiet");
  free_ran(&again);
  EXPECT_FILES("n", "events.csv run.csv summary.json ");
}

/* Each run's spectrum is taken over whole cycles of its own mains: 62.5 Hz has its 220 V in one
 * line, although 40 ms are no whole number of its cycles. */
static void two_mains(void) {
  if (!on_path("gnuplot")) return;
  const char *const record = "--set run.until=40ms --set record=[v_mains] --quiet";
  ran a = run("run paper %s -o f50", record),
      b = run("run paper --set supply.frequency=62.5Hz --set supply.voltage=220V %s -o f62",
              record);
  RUN_GOOD("plot f50 f62 --probe v_mains --fft -o f.svg --from 0ms --to 40ms --quiet");
  char *csv = read_file("f_spectrum.csv"), *row = strstr(csv, "\nf62,62.5,");
  CU_ASSERT_PTR_NOT_NULL_FATAL(row);
  vs_close(strtod(row + 10, NULL), 220, 220, 1e-8, "62.5 Hz", __LINE__);
  free(csv);
  free_ran(&a);
  free_ran(&b);
}

/* gnuplot complains of each curve that is constant; who asked for a picture does not read that. */
static void constant(void) {
  if (!on_path("gnuplot")) return;
  RUN_GOOD("run paper --set run.until=4ms -o still --quiet");
  RUN_GOOD("plot still --quiet");
  RUN_GOOD("plot still --probe p,i --quiet");
}

/* A fault is found by itself and its word stands in the picture; the next run removes pictures. */
static void drawn(void) {
  if (!on_path("gnuplot")) return;
  static const char SCENE[] = "firing: {every: 1, angle: 120 deg}\nrun: {until: 260 ms}\n"
                              "events: {dip: {kind: sag, at: 200 ms}}\n";
  write_file("dip.yaml", SCENE);
  RUN_GOOD("run dip.yaml -o dip --quiet");
  RUN_GOOD("run dip.yaml --set events.dip.level=90% -o mild --quiet");
  ran r = run("plot dip mild --probe i,p");
  expect_good(&r, "plot dip mild", __LINE__);
  EXPECT(strstr(r.out, "shown: 180 ms to 240 ms, around the scene's events"), "%s", r.out);
  free_ran(&r);
  char *svg = read_file("dip/closeup.svg");
  EXPECT(count_words(svg, ">dip begins (sag)<") == 1 && count_words(svg, ">mild<") == 1 &&
             count_words(svg, ">p / mm<") == 1 && count_words(svg, ">thyristor fires<") == 3,
         "%d, %d", count_words(svg, ">dip begins (sag)<"), count_words(svg, ">thyristor fires<"));
  free(svg);
  RUN_GOOD("plot dip -o late.svg --quiet");
  svg = read_file("late.svg");
  EXPECT(count_words(svg, "converter, from 190 ms on") == 1, "an event is not shown");
  free(svg);
  RUN_GOOD("plot dip --probe i --fft --quiet");
  RUN_GOOD("plot dip --orbit -o orbit.svg --quiet");
  EXPECT_FILES("dip",
               "closeup.png closeup.svg events.csv peaks.csv run.csv spectrum.csv spectrum.png "
               "spectrum.svg summary.json ");
  ran again = run("run dip.yaml -o dip --quiet");
  CU_ASSERT_EQUAL(again.status, 0);
  free_ran(&again);
  EXPECT_FILES("dip", "events.csv peaks.csv run.csv summary.json ");
}

/* The page of a run has its sections, what the scene is called is escaped, and it is alone. */
static void page(void) {
  if (!on_path("gnuplot")) return;
  write_file("page.yaml", "circuit: {deck: halfwave_paper}\nrun: {until: 30 ms}\n");
  RUN_GOOD("run page.yaml -o 'a<b' --quiet");
  RUN_GOOD("plot 'a<b' --quiet");
  static const char *const SAYS[] = {"<h1>Run a&lt;b</h1>",
                                     "class=\"verdict good\">\n<p class=\"big\">held</p>",
                                     "<th>what</th><th>stress</th><th>limit</th><th>margin</th>",
                                     "<td>thyristor.v_reverse</td><td class=\"n\">",
                                     " V</td><td class=\"n\">1.2 kV</td>",
                                     "<p class=\"of\">The rating of v_ak is judged by the same "
                                     "values: held.</p>",
                                     ">from the source</td>",
                                     ">heat in the winding</td>",
                                     "lost in thyristor</td>",
                                     "The audit: the books close.",
                                     "<figcaption>v_ak_v <output></output></figcaption>",
                                     "var t='ms';addEventListener('load',",
                                     "<tr class=\"group\"><th colspan=\"3\">thyristor</th></tr>",
                                     "<tr><td>i_peak</td><td class=\"n\">",
                                     "<tr><td>firing.angle</td><td>100 deg</td></tr>",
                                     "</html>\n"};
  char *html = read_file("a<b/report.html");
  for (size_t k = 0; k < COUNT(SAYS); k++) EXPECT(strstr(html, SAYS[k]) != NULL, "no %s", SAYS[k]);
  EXPECT(count_words(html, "<iframe ") >= 6, "%d pictures", count_words(html, "<iframe "));
  EXPECT(!strstr(html, "<td>v_ak"), "v_ak stands beside v_forward and v_reverse");
  EXPECT(!strstr(html, "src=\"http") && !strstr(html, "href=\"http"), "it needs other files");
  free(html);
  ran again = run("run page.yaml -o 'a<b' --quiet");
  free_ran(&again);
  EXPECT_FILES("a<b", "events.csv peaks.csv run.csv summary.json ");
}

/* A value takes the prefix that leaves one to three digits before the point, whatever its unit has.
 */
static void amounts(void) {
  static const struct {
    double value;
    const char *unit, *text;
  } AMOUNTS[] = {{0.004072, "kA", "4.072 A"},
                 {2.422e-7, "J", "242.2 nJ"},
                 {1200, "V", "1.2 kV"},
                 {0.5, "mm", "500 um"},
                 {47000, "nF", "47 uF"},
                 {175.1, "V/us", "175.1 V/us"},
                 {0.00297, "A2.s", "0.00297 A2.s"},
                 {12, "min", "12 min"},
                 {3, "", "3"},
                 {0.02, "kohm", "20 ohm"},
                 {40, "degC", "40 degC"}};
  char text[VS_ENGINEERING_SIZE];
  for (size_t k = 0; k < COUNT(AMOUNTS); k++)
    CU_ASSERT_STRING_EQUAL(vs_member_amount(AMOUNTS[k].value, AMOUNTS[k].unit, text),
                           AMOUNTS[k].text);
}

/* A rating is left out where devices have both of its ends, and only then. */
static void repeated(void) {
  static const struct {
    const char *devices;
    bool repeats;
  } BESIDE[] = {
#define D(name, stress, limit, margin, word)                                                       \
  "{\"device\": \"t\", \"measure\": \"" name "\", \"unit\": \"V\", \"stress\": " stress            \
  ", \"limit\": " limit ", \"margin\": " margin ", \"word\": \"" word "\"}"
      {D("v_forward", "900", "1000", "0.1", "held") ", " D("v_reverse", "800", "1000", "0.2",
                                                           "held"),
       true},
      {D("v_forward", "900", "1000", "0.1", "held"), false},
      {D("v_forward", "900", "1000", "0.1", "held") ", " D("v_reverse", "800", "1200", "0.3",
                                                           "held"),
       false},
      {D("v_forward", "900", "1000", "0.1", "waived") ", " D("v_reverse", "800", "1000", "0.2",
                                                             "held"),
       false},
      {D("v_forward", "901", "1000", "0.1", "held") ", " D("v_reverse", "800", "1000", "0.2",
                                                           "held"),
       false}};
  for (size_t k = 0; k < COUNT(BESIDE); k++) {
    vs_text text = {0};
    vs_tree tree = {0};
    vs_error err = {0};
    vs_text_add(
        &text,
        "{\"verdict\": [{\"rating\": \"v_ak\", \"unit\": \"V\", \"min\": -1000, \"max\": 1000, "
        "\"least\": -800, \"largest\": 900, \"margin\": 0.1, \"word\": \"held\"}, %s]}",
        BESIDE[k].devices);
    CU_ASSERT_EQUAL(vs_tree_parse(text.text, "text", &tree, &err), VS_OK);
    const vs_node *verdict = vs_tree_child(tree.root, "verdict");
    EXPECT(vs_margin_bars_repeats(verdict, verdict->child) == BESIDE[k].repeats, "row %zu", k);
    double stress, limit;
    vs_margin_bars_stress(verdict->child, &stress, &limit);
    CU_ASSERT(stress == 900 && limit == 1000);
    vs_tree_free(&tree);
    vs_text_free(&text);
  }
}

static const vs_test TESTS[] = {
    {"amounts", amounts},     {"repeated", repeated}, {"windows", windows}, {"probes", probes},
    {"spectra", spectra},     {"refused", refused},   {"drawn", drawn},     {"numbers", numbers},
    {"two mains", two_mains}, {"constant", constant}, {"page", page}};

int main(void) {
  return program_suite("closeup", TESTS, COUNT(TESTS));
}
