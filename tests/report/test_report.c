/* SPDX-License-Identifier: GPL-3.0-or-later
 * Studies looked at: what a report says, against closed forms; its pictures; which folders are
 * refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "program.h"
#include "report/plot/map.h"
#include "report/plot/spread.h"
#include "report/study_page.h"

/* ---- study folders ---- */

static void copy_file(const char *from, const char *to) {
  char *text = read_file(from);
  EXPECT(*text, "%s: not there", from);
  write_file(to, text);
  free(text);
}

/* The study of twelve cases that lies in tests/cases. */
static void copy_map(const char *folder) {
  static const char *const FILES[] = {"manifest.json", "study.csv", "failures.csv"};
  char from[VS_PATH_SIZE], to[VS_PATH_SIZE];
  CU_ASSERT_EQUAL(mkdir(folder, 0777), 0);
  for (size_t k = 0; k < COUNT(FILES); k++) {
    snprintf(from, sizeof from, "%s/cases/study_map/%s", VS_TEST_FOLDER, FILES[k]);
    snprintf(to, sizeof to, "%s/%s", folder, FILES[k]);
    copy_file(from, to);
  }
}

/* A study of one report column, peak_v, and of axes a and b that are numbers. */
typedef struct sample {
  double a, b, peak_v, margin; /* NAN: an empty cell */
} sample;

static void add_cell(vs_text *csv, double value) {
  if (isnan(value))
    vs_text_add(csv, ",");
  else
    vs_text_add(csv, ",%.12g", value);
}

static void write_study(const char *method, const char *more, long n, sample (*at)(long k)) {
  vs_text csv = {0}, manifest = {0};
  vs_text_add(&csv, "case,id,circuit.a_ohm,circuit.b,peak_v,margin_least,weakest,status\n");
  for (long k = 0; k < n; k++) {
    sample s = at(k);
    vs_text_add(&csv, "%ld,%016lx", k, 7919 * (k + 1));
    add_cell(&csv, s.a);
    add_cell(&csv, s.b);
    add_cell(&csv, s.peak_v);
    add_cell(&csv, s.margin);
    vs_text_add(&csv, ",%s,%d\n",
                isnan(s.margin) ? ""
                : k % 4         ? "peak"
                                : "other.part",
                s.margin < 0 ? 3 : 0);
  }
  vs_text_add(
      &manifest,
      "{\"study\": \"s.yaml\", \"method\": \"%s\", \"cases\": %ld, \"done\": %ld, "
      "\"failed\": 0, \"axes\": [{\"key\": \"circuit.a\", \"unit\": \"ohm\", \"from\": 1}, "
      "{\"key\": "
      "\"circuit.b\", \"unit\": \"\", \"from\": 1}], \"report\": [{\"name\": \"peak\", \"unit\": "
      "\"V\", \"rating\": 3000, \"text\": \"a peak\"}]%s}",
      method, n, n, more);
  remove_tree("s");
  CU_ASSERT_EQUAL(mkdir("s", 0777), 0);
  write_file("s/study.csv", csv.text);
  write_file("s/manifest.json", manifest.text);
  vs_text_free(&csv);
  vs_text_free(&manifest);
}

static void expect_words(const char *path, const char *const *words, size_t count, int line) {
  char *text = read_file(path);
  for (size_t k = 0; k < count; k++)
    expect(strstr(text, words[k]) != NULL, line, "%s does not say '%s'", path, words[k]);
  free(text);
}
#define EXPECT_REPORT(...)                                                                         \
  do {                                                                                             \
    static const char *const words[] = {__VA_ARGS__};                                              \
    expect_words("s/report.html", words, COUNT(words), __LINE__);                                  \
  } while (0)

/* ---- what is computed ---- */

static void percentiles(void) {
  const double v[] = {1, 2, 4, 8, 16};
  CLOSE(vs_spread_percentile(v, 5, 0), 1, 0);
  CLOSE(vs_spread_percentile(v, 5, 50), 4, 0);
  CLOSE(vs_spread_percentile(v, 5, 100), 16, 0);
  CLOSE(vs_spread_percentile(v, 5, 5), 1.2, 1e-15); /* a fifth of the way from 1 to 2 */
  CLOSE(vs_spread_percentile(v, 5, 90), 12.8, 1e-15);
  CLOSE(vs_spread_percentile(v, 1, 95), 1, 0);
  CU_ASSERT(isnan(vs_spread_percentile(v, 0, 50)));
}

static void shares(void) {
  double least, largest;
  vs_study_page_wilson(8, 10, &least,
                       &largest); /* by hand: (0.8 + z²/20 ∓ z√(0.016 + z²/400))/(1 + z²/10) */
  CLOSE(least, 0.4901624715, 1e-9);
  CLOSE(largest, 0.9433178485, 1e-9);
  vs_study_page_wilson(0, 4, &least, &largest);
  CLOSE_OF(least, 0, 1, 1e-15);
  CLOSE(largest, 3.841458820694124 / (4 + 3.841458820694124), 1e-12); /* z²/(n + z²) */
  CLOSE(vs_study_page_share(4095, 4096), 99.97, 0);
  CLOSE(vs_study_page_share(999999, 1000000), 99.99, 0); /* never 100 when one is missing */
  CLOSE(vs_study_page_share(7, 7), 100, 0);
}

typedef struct pieces {
  double worst, length;
  int count;
  double level;
  double (*field)(double x, double y);
} pieces;

static double plane(double x, double y) {
  return 2 * x - 3 * y;
}
static double bowl(double x, double y) {
  return x * x + y * y;
}
static double saddle(double x, double y) {
  return x * y;
}
static double logarithms(double x, double y) {
  return log(x) - 2 * log(y);
}

static void note_piece(void *ctx, const double from[2], const double to[2]) {
  pieces *p = ctx;
  p->worst = fmax(p->worst, fabs(p->field(from[0], from[1]) - p->level));
  p->worst = fmax(p->worst, fabs(p->field(to[0], to[1]) - p->level));
  p->length += hypot(to[0] - from[0], to[1] - from[1]);
  p->count++;
}

enum { SIDE = 21 };
static pieces trace(double (*field)(double, double), double low, double step, bool is_log,
                    double hole) {
  double x[SIDE], z[SIDE * SIDE];
  pieces p = {.level = 0.25, .field = field};
  for (int k = 0; k < SIDE; k++) x[k] = is_log ? low * pow(step, k) : low + step * k;
  for (int j = 0; j < SIDE; j++)
    for (int i = 0; i < SIDE; i++)
      z[j * SIDE + i] = x[i] == hole && x[j] == hole ? NAN : field(x[i], x[j]);
  const vs_field_grid grid = {SIDE, SIDE, x, x, z, is_log, is_log};
  vs_map_contour(&grid, p.level, note_piece, &p);
  return p;
}

static void contours(void) {
  pieces p = trace(plane, -1, 0.1, false, NAN); /* exact, to the bit's rounding */
  CLOSE_OF(p.worst, 0, 1, 1e-14);
  CLOSE(p.length, 2 / 3.0 * sqrt(13), 1e-12); /* y from -0.75 to 0.583 over all x: 2 wide */
  p = trace(logarithms, 1, 1.3, true, NAN);
  CLOSE_OF(p.worst, 0, 1, 1e-13);
  p = trace(bowl, -1, 0.1, false, NAN); /* a chord lies within h²/4 of the level */
  CLOSE_OF(p.worst, 0, 1, 0.1 * 0.1 / 4 + 1e-12);
  CLOSE(p.length, M_PI, 0.005); /* 2πr; inscribed in it but for that, about 40 chords */
  pieces whole = trace(saddle, -1, 0.1, false, NAN);
  CLOSE_OF(whole.worst, 0, 1, 0.1 * 0.1 / 4);
  pieces holed = trace(plane, -1, 0.1, false, -1 + 0.1 * 10); /* no line passes by a hole */
  CU_ASSERT(holed.count < trace(plane, -1, 0.1, false, NAN).count);
}

static void units(void) {
  static const struct {
    const char *unit, *label;
    double least, largest, factor;
  } ROWS[] = {{"ohm", "x / Ω", 1, 330, 1},
              {"ohm", "x / kΩ", 100, 3300, 1e-3},
              {"m", "x / mm", -0.0014, 0, 1e3},
              {"m/s2", "x / m/s²", 1, 1e5, 1},
              {"V/us", "x / V/µs", 1, 5, 1},
              {"nF", "x / nF", 1, 5e4, 1},
              {"N.s/m", "x / N·s/m", 1, 5, 1},
              {"", "x", 1e-6, 2e-6, 1},
              {"A", "x / A", 0, 0, 1},
              {"A", "x / A", NAN, NAN, 1},
              {"s", "x / µs", 1e-6, 2.5e-6, 1e6},
              {"deg", "x / °", 90, 150, 1},
              {"V", "x / kV", -1000, -500, 1e-3}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char name[] = "x", unit[16];
    snprintf(unit, sizeof unit, "%s", ROWS[k].unit);
    const vs_folder_column c = {.name = name, .unit = unit, .role = VS_ROLE_REPORT};
    vs_scale s = vs_scale_of(&c, (vs_extent){ROWS[k].least, ROWS[k].largest, NULL, 0});
    EXPECT(!strcmp(s.label, ROWS[k].label), "%s: '%s'", ROWS[k].label, s.label);
    CLOSE(s.factor, ROWS[k].factor, 1e-15);
  }
}

/* A range is drawn as the study has it, wherever a search put its cases. */
static void a_range_says_whether_it_is_logarithmic(void) {
  static const double PLACES[] = {1, 70, 74, 360}, DECADES[] = {1, 10, 100, 1000};
  char name[] = "x", unit[] = "deg", no[] = "false", yes[] = "true";
  vs_node said = {.kind = VS_NODE_TEXT, .key = "log", .text = no},
          axis = {.kind = VS_NODE_MAP, .child = &said};
  vs_folder_column c = {.name = name, .unit = unit, .node = &axis};
  CU_ASSERT_FALSE(vs_scale_of(&c, (vs_extent){1, 360, PLACES, 4}).log);
  CU_ASSERT_FALSE(vs_scale_of(&c, (vs_extent){1, 1000, DECADES, 4}).log);
  said.text = yes;
  CU_ASSERT_TRUE(vs_scale_of(&c, (vs_extent){1, 360, PLACES, 4}).log);
  c.node = NULL;
  CU_ASSERT_TRUE(vs_scale_of(&c, (vs_extent){1, 1000, DECADES, 4}).log);
}

/* ---- reports ---- */

static void a_map(void) {
  copy_map("s");
  ran r = run("plot s");
  expect_good(&r, "plot s", __LINE__);
  CU_ASSERT_STRING_EQUAL(r.out, "s/margin_least.png\ns/thyristor.v_reverse_v.png\ns/p_min_m.png\n"
                                "s/report.html\n");
  free_ran(&r);
  EXPECT_FILES("s", "failures.csv manifest.json margin_least.png p_min_m.png report.html study.csv "
                    "thyristor.v_reverse_v.png ");
  EXPECT_REPORT(
      "<title>Study studies/snubber &lt;map&gt;.yaml</title>", "id=\"verdict\"",
      "Worst margin -25 %: thyristor.v_reverse, case 0", "8 of 11 cases keep every rating",
      "<td>thyristor.v_reverse</td><td class=\"n\">8</td><td class=\"n\">72.72 %</td>",
      "<td>varistor_1.clamp</td><td class=\"n\">3</td>", "1 of 12 cases",
      "ngspice gave up at 0.0123 s, &quot;timestep too small&quot;", "id=\"pictures\"",
      "The line: margin 0 %", "Grey: no case, or one that failed", "The line: limit 1.2 kV",
      "circuit.r1 / Ω", "circuit.c1 / nF", "margin_least / %", "p_min / mm", "id=\"cases\"",
      "id=\"axes\"", "100, 330, 1000, 3300", "id=\"columns\"", "largest reverse voltage",
      "id=\"manifest\"", "circuit.deck: halfwave_paper", "ngspice: 39", "sha256: 5c1f0a37",
      "vibrospice study studies/snubber.yaml -o map");
  char *html = read_file("s/report.html");
  EXPECT(strstr(html, "grid, 12 cases") && !strstr(html, "Not complete"),
         "a case that failed is taken for one that was not run");
  CU_ASSERT_EQUAL(count_words(html, "<iframe "), 3);
  CU_ASSERT_EQUAL(count_words(html, "gnuplot_svg.plot_xmin = "), 3); /* each can be moused */
  CU_ASSERT(strstr(html, "id=\"verdict\"") < strstr(html, "id=\"pictures\""));
  CU_ASSERT(strstr(html, "id=\"pictures\"") < strstr(html, "id=\"parameters\""));
  /* nothing from elsewhere: the names of SVG's own spaces alone look like addresses */
  int spaces = count_words(html, "http://www.w3.org/2000/svg") +
               count_words(html, "http://www.w3.org/1999/xlink");
  CU_ASSERT_EQUAL(count_words(html, "http"), spaces);
  CU_ASSERT_EQUAL(count_words(html, "file:") + count_words(html, "src=\"") +
                      count_words(html, "@import") + count_words(html, "<link"),
                  0);
  free(html);
}

static void the_same_bytes(void) {
  static const char *const FILES[] = {"report.html", "margin_least.png", "p_min_m.png"};
  copy_map("other");
  setenv("TZ", "Asia/Tokyo", 1);
  setenv("LC_ALL", "de_DE.UTF-8", 1);
  RUN_GOOD("plot other --quiet");
  unsetenv("TZ");
  unsetenv("LC_ALL");
  for (size_t k = 0; k < COUNT(FILES); k++) {
    char path[2][64];
    snprintf(path[0], sizeof path[0], "s/%s", FILES[k]);
    snprintf(path[1], sizeof path[1], "other/%s", FILES[k]);
    FILE *one = fopen(path[0], "rb"), *other = fopen(path[1], "rb");
    CU_ASSERT_PTR_NOT_NULL_FATAL(one);
    CU_ASSERT_PTR_NOT_NULL_FATAL(other);
    int a, b;
    do {
      a = getc(one);
      b = getc(other);
    } while (a == b && a != EOF);
    EXPECT(a == b, "%s: not the same bytes", FILES[k]);
    fclose(one);
    fclose(other);
  }
  remove_tree("other");
}

static void one_picture(void) {
  ran r = run("plot s -o one.svg");
  expect_good(&r, "plot s -o one.svg", __LINE__);
  CU_ASSERT_STRING_EQUAL(r.out, "one.svg\n");
  free_ran(&r);
  RUN_GOOD("plot s --quiet -o one.png");
  char *svg = read_file("one.svg"), *png = read_file("one.png");
  CU_ASSERT(strstr(svg, "<svg") != NULL && strstr(svg, "margin_least / %") != NULL);
  CU_ASSERT_EQUAL(strncmp(png, "\x89PNG\r\n", 6), 0);
  free(svg);
  free(png);
  char *path = vs_copy(getenv("PATH"));
  unlink("s/report.html");
  setenv("PATH", "nowhere", 1);
  r = run("plot s");
  setenv("PATH", path, 1);
  free(path);
  EXPECT(r.status == 1 && count_lines(r.err) == 1 && strstr(r.err, "gnuplot is not installed"),
         "without gnuplot: exit status %d: %s", r.status, r.err);
  CU_ASSERT_EQUAL(access("s/report.html", F_OK), -1);
  free_ran(&r);
}

/* 4001 cases in no order; peak_v is 0, 1, ..., 4000 V, and the margin is below 0 for 400 of them.
 */
static sample shuffled(long k) {
  long n = k * 1777 % 4001;
  return (sample){100 + (double)(n % 7), 0.5, (double)n, ((double)n - 400) / 1000};
}

/* Cases by the names of their parts, with two measures: a named point for each case. A margin far
 * below the others lies at the picture's edge with its number. */
static void named_cases(void) {
  remove_tree("s");
  CU_ASSERT_EQUAL(mkdir("s", 0777), 0);
  write_file("s/study.csv",
             "case,id,circuit.across_coil,stroke_m,release_s,peak_v,margin_least,weakest,status\n"
             "0,a0,freewheel,0.001,0.02,13,0.9,peak,0\n"
             "1,a1,S05K130,0.001000000001,0.003,120,-2.2,peak,3\n"
             "2,a2,SMBJ24CA,0.001,0.006,36,0.5,peak,0\n");
  write_file(
      "s/manifest.json",
      "{\"study\": \"s.yaml\", \"method\": \"list\", \"cases\": 3, \"done\": 3, \"failed\": 0, "
      "\"axes\": [{\"key\": \"circuit.across_coil\", \"unit\": \"\"}], \"report\": [{\"name\": "
      "\"stroke\", \"unit\": \"m\", \"text\": \"\"}, {\"name\": "
      "\"release\", \"unit\": \"s\", \"text\": \"\"}, {\"name\": \"peak\", \"unit\": \"V\", "
      "\"text\": \"\"}]}");
  RUN_GOOD("plot s --quiet");
  EXPECT(!access("s/pair_release_s.png", F_OK), "no picture of the pair");
  EXPECT_REPORT("release over peak", ">-220<", "It goes on below the picture, to -220 %",
                "> 1.04<"); /* an axis shows no difference below a thousandth */
}

static void samples(void) {
  static const char *const METHODS[] = {"sobol", "lhs", "monte_carlo"};
  for (size_t m = 0; m < COUNT(METHODS); m++) {
    write_study(METHODS[m], "", 4001, shuffled);
    RUN_GOOD("plot s --quiet");
    EXPECT_REPORT("Yield 90 %", "3601 of 4001 cases keep every rating", "Worst margin -40 %",
                  "5 % of them lie below 0.2 kV, 50 % of them lie below 2 kV, 95 % of them lie "
                  "below 3.8 kV",
                  "5 % of them lie below -20 %, 50 % of them lie below 160 %, 95 % of them lie "
                  "below 340 %",
                  "a rating is violated", "share of cases / %", "No case failed",
                  "<td>peak</td><td class=\"n\">3000</td><td class=\"n\">74.98 %</td>");
    char *html = read_file("s/report.html");
    CU_ASSERT_EQUAL(strstr(html, "with 95 %, the true share") != NULL, m == 2);
    free(html);
  }
}

/* Every value is in one bar, and no bar stands on both sides of the joint. Values spread evenly
 * over 1 have quartiles 0.5 apart, so that 2 IQR / 1000^(1/3) is 0.1. */
static void bars_add_up(void) {
  enum { N = 1000 };
  static const double JOINTS[] = {NAN, -5, 0.1, 0.7, 0.999, 17};
  static double v[N];
  for (int shape = 1; shape < 5; shape++)
    for (size_t j = 0; j < COUNT(JOINTS); j++) {
      for (int k = 0; k < N; k++) v[k] = pow(k / (N - 1.0), shape);
      const vs_bins b = vs_spread_bins(v, N, JOINTS[j]);
      size_t all = 0;
      for (size_t k = 0; k < b.count; k++) {
        double left = b.item[k].middle - b.width / 2, right = b.item[k].middle + b.width / 2;
        size_t in = 0; /* to the rounding of the ends, which are no one's value here */
        for (int n = 0; n < N; n++) in += v[n] > left - 1e-12 && v[n] < right - 1e-12;
        in += k == b.count - 1 && fabs(v[N - 1] - right) < 1e-12;
        EXPECT(in == b.item[k].cases, "bar %zu of shape %d: %zu, not %zu", k, shape,
               b.item[k].cases, in);
        bool both = left < JOINTS[j] - 1e-9 && right > JOINTS[j] + 1e-9;
        EXPECT(!both || JOINTS[j] < 0 || JOINTS[j] > 1, "bar %zu lies across %g", k, JOINTS[j]);
        all += b.item[k].cases;
      }
      CU_ASSERT_EQUAL(all, N);
      CU_ASSERT(b.count >= 8 && b.count < VS_BINS);
      if (shape == 1 && isnan(JOINTS[j])) CLOSE(b.width, 0.1, 1e-3);
    }
  for (int k = 0; k < N; k++) v[k] = 573 + k * 1e-16; /* but for rounding, alike */
  const vs_bins one = vs_spread_bins(v, N, 1200);
  CU_ASSERT_EQUAL(one.count, 1);
  CU_ASSERT_EQUAL(one.item[0].cases, N);
}

static sample alike(long k) {
  return (sample){(double)k, 1, 10, 0.5};
}

static void all_alike(void) {
  write_study("sobol", "", 400, alike);
  RUN_GOOD("plot s --quiet");
  EXPECT_REPORT("Yield 100 %", "5 % of them lie below 10 V, 50 % of them lie below 10 V");
}

/* What failed is not known to hold: 400 of 500 do. */
static void a_yield_with_failures(void) {
  vs_text changed = {0};
  write_study("sobol", "", 400, alike);
  char *manifest = read_file("s/manifest.json"), *count = strstr(manifest, "\"failed\": 0,");
  CU_ASSERT_PTR_NOT_NULL_FATAL(count);
  vs_text_add(&changed, "%.*s\"failed\": 100,%s", (int)(count - manifest), manifest,
              count + strlen("\"failed\": 0,"));
  write_file("s/manifest.json", changed.text);
  vs_text_free(&changed);
  free(manifest);
  RUN_GOOD("plot s --quiet");
  EXPECT_REPORT("class=\"verdict bad\"", "Yield 80 %",
                "400 of 500 cases keep every rating, the failed counted as not holding");
}

static sample along(long k) {
  return (sample){pow(10, 1 + (double)k / 10), 1, 2500 + 20 * (double)k, 0.1 - 0.005 * (double)k};
}
static sample in_words(long k) {
  return (sample){10 + (double)(k / 3), (double)(k % 3), 100 * (double)k, NAN};
}
static sample searched(long k) {
  return (sample){(double)(k * 37 % 101), (double)(k * 53 % 103), (double)(k * 29 % 97), 0.2};
}
static sample cornered(long k) {
  return (sample){k & 1 ? 110 : 90, k & 2 ? 4 : 2, 1000 + 100 * (double)k, 0.3 - 0.2 * (double)k};
}

static void other_methods(void) {
  write_study("grid", "", 31, along);
  RUN_GOOD("plot s --quiet");
  EXPECT_REPORT("Worst margin -5 %: peak, case 30", "21 of 31 cases", "limit 3 kV", "peak / kV",
                "circuit.a / Ω");
  write_study("grid", "", 30, in_words);
  RUN_GOOD("plot s --quiet");
  EXPECT_REPORT("No rating was judged", "peak / kV", "circuit.b");
  write_study(
      "worst",
      ", \"find\": {\"worst\": \"max peak\", \"says\": \"of 8 restarts 3 came to its place\"}", 97,
      searched);
  RUN_GOOD("plot s --quiet"); /* 29·k mod 97 is 96 where k is the inverse of -29: 10 */
  EXPECT_REPORT("Worst found: peak 96 V, case 10", "of 8 restarts 3 came to its place",
                "search for the largest", "evaluation", "worst so far",
                "The worst found, 96 V, at evaluation 10 of 97", "peak of each case",
                "Worst margin 20 %");
  write_study("worst", ", \"find\": {\"worst\": \"min margin_least\"}", 4, cornered);
  RUN_GOOD("plot s --quiet");
  EXPECT_REPORT("Worst found: margin_least -30 %, case 3", "search for the least");
  write_study("corners", "", 4, cornered);
  RUN_GOOD("plot s --quiet");
  EXPECT_REPORT(
      "The best case: circuit.a = 90 Ω, circuit.b = 2; its least margin is 30 %, of other.part",
      "Worst margin -30 %: peak, case 3", "case 3  ++", "case 2  −+", "case 0  −−",
      "in the order circuit.a, circuit.b");
  write_study("snubber",
              ", \"snubber\": {\"candidates\": [{\"case\": 0, \"holds\": true}, {\"case\": 1, "
              "\"holds\": true}, {\"case\": 3, \"holds\": false}], \"found\": {\"case\": 1}}",
              4, cornered);
  RUN_GOOD("plot s --quiet");
  EXPECT_REPORT("Cheapest that holds: circuit.a = 110 Ω, circuit.b = 2; case 1",
                "What was tried, and what holds over the spread", "does not hold", "cheapest",
                "The worst case: circuit.a = 110 Ω, circuit.b = 4.");
  write_study("snubber", ", \"snubber\": {\"candidates\": [], \"found\": null}", 4, cornered);
  RUN_GOOD("plot s --quiet");
  EXPECT_REPORT("None found that holds over the spread");
  write_study("list", "", 97, searched);
  RUN_GOOD("plot s --quiet");
  EXPECT_REPORT("peak, case by case", "97 of 97 cases keep every rating");
}

/* Words beside numbers on an axis are names, each with a line of its own. */
static void axes_of_words(void) {
  copy_map("words");
  vs_text csv = {0};
  vs_text_add(&csv, "case,id,circuit.thyristor,circuit.c1_nf,thyristor.v_reverse_v,p_min_m,"
                    "margin_least,weakest,status\n");
  for (int k = 0; k < 11; k++)
    vs_text_add(&csv, "%d,%016x,\"%s\",%d,%d,,0.1,x,0\n", k, k, k % 2 ? "12TTS08S" : "it's, <b>",
                k / 2 + 1, 100 + k);
  write_file("words/study.csv", csv.text);
  vs_text_free(&csv);
  char *manifest = read_file("words/manifest.json");
  char *key = strstr(manifest, "\"circuit.r1\", \"unit\": \"ohm\"");
  CU_ASSERT_PTR_NOT_NULL_FATAL(key);
  memcpy(key, "\"circuit.thyristor\", \"unit\":\"\"", strlen("\"circuit.r1\", \"unit\": \"ohm\""));
  free(manifest);
  manifest = read_file("words/manifest.json");
  vs_text changed = {0};
  key = strstr(manifest, "\"circuit.r1\", \"unit\": \"ohm\"");
  vs_text_add(&changed, "%.*s\"circuit.thyristor\", \"unit\": \"\"%s", (int)(key - manifest),
              manifest, key + strlen("\"circuit.r1\", \"unit\": \"ohm\""));
  write_file("words/manifest.json", changed.text);
  vs_text_free(&changed);
  free(manifest);
  RUN_GOOD("plot words --quiet");
  char *html = read_file("words/report.html");
  EXPECT(strstr(html, "A line for each circuit.thyristor"), "no line for each");
  EXPECT(strstr(html, "12TTS08S") && !strstr(html, "<b>"), "words are not as they are");
  free(html);
  remove_tree("words");
}

/* ---- what gnuplot is told ---- */

/* Runs the program with a gnuplot before the other that keeps what it is told; returns that. */
static char *told_by(const char *words) {
  static const char KEEPS[] = "#!/bin/sh\ntee -a told | PATH=$VS_TEST_PATH exec gnuplot \"$@\"\n";
  char *path = vs_copy(getenv("PATH")), here[VS_PATH_SIZE];
  vs_text with = {0};
  mkdir("keeps", 0777);
  write_file("keeps/gnuplot", KEEPS);
  CU_ASSERT_EQUAL(chmod("keeps/gnuplot", 0777), 0);
  CU_ASSERT_PTR_NOT_NULL_FATAL(getcwd(here, sizeof here));
  vs_text_add(&with, "%s/keeps:%s", here, path);
  setenv("VS_TEST_PATH", path, 1);
  setenv("PATH", with.text, 1);
  run_good(words, __LINE__);
  setenv("PATH", path, 1);
  char *told = read_file("told");
  unlink("told");
  remove_tree("keeps");
  vs_text_free(&with);
  free(path);
  return told;
}

static void expect_told(const char *words, const char *const *says, int line) {
  char *told = told_by(words);
  for (; *says; says++) expect(strstr(told, *says) != NULL, line, "no '%s' in %s", *says, told);
  free(told);
}

static sample stepped(long k) {
  return (sample){10 + 10 * (double)(k / 2), 1 + (double)(k % 2), 1000 + 1000 * (double)k,
                  (double)(2 - k) / 4};
}

static sample lines(long k) {
  return (sample){10 * (double)(1 + k), 1, 1000 * (double)(1 + k * k), (double)(2 - k) / 4};
}

/* Cells and the line of the limit of a map; bars and points of a sample; a curve; the panels of a
 * run; a diode's curve, which ends at 20 A, and those of a fuse that clears. */
static void pictures_are_of_the_numbers(void) {
  static const char *const MAP[] = {
      "set title \"peak\" offset 0,0.7\nset xlabel \"circuit.a / Ω\"\nset ylabel \"circuit.b\"\n"
      "set xrange [5:35]\nset yrange [0.5:2.5]\n",
      "set cbrange [1:6]\nset cblabel \"peak / kV\"",
      "$cells << EOD\n10 1 5 17 0.5 1.7 1\n20 1 15 27 0.5 1.7 3\n30 1 25 35 0.5 1.7 5\n"
      "10 2 5 17 1.5 2.5 2\n20 2 15 27 1.5 2.5 4\n30 2 25 35 1.5 2.5 6\nEOD\n"
      "$limit << EOD\n20 1\n15 2\n\nEOD\n",
      "$limit using 1:2 with lines lw 3 lc rgb \"#d55e00\" title \"limit 3 kV\"\n",
      "set cbrange [-75:50]\nset cblabel \"margin_least / \\045\"",
      NULL};
  static const char *const BARS[] = {
      "width = 0.625\n$bins << EOD\n0.8125 16.6666667\n1.4375 0\n2.0625 16.6666667\n2.6875 0\n"
      "3.3125 16.6666667\n3.9375 16.6666667\n4.5625 0\n5.1875 16.6666667\n5.8125 16.6666667\nEOD\n"
      "set ylabel 'share of cases / %'\nset yrange [0:*]\nset style fill solid 0.8 border lc rgb "
      "'white'\n"
      "bad(x) = 0 && x < 0 ? 0xd55e00 : 0x0072b2\n"
      "plot $bins using 1:2:(width):(bad($1)) with boxes lc rgb variable\n",
      "set label '5 %: -68.75' at first -68.75, graph 1 right", /* a twentieth of -75 .. 50 */
      "bad(x) = 1 && x < 0 ? 0xd55e00 : 0x0072b2\n",
      "$bars << EOD\n0 -0.956182887\n1 -0.292770022\nEOD\n", NULL};
  static const char *const CURVE[] = {
      "set ylabel \"peak / kV\"\nset arrow from graph 0, first 3 to graph 1, first 3 nohead",
      "set yrange [0.04:17.96]\n$line << EOD\n10 1\n20 2\n30 5\n40 10\n50 17\nEOD\nplot $line "
      "using 1:2 "
      "with linespoints",
      NULL};
  static const char *const PANELS[] = {
      "set multiplot layout 3,3 title \"Displacements, accelerations and force (as Fig. 9 of the "
      "paper)\" font 'sans,13'\nset xrange [0:20]\nset xlabel 't / ms'\nset ylabel \"p / mm\"\n"
      "plot \"./r/run.csv\" using ($1*1000):($2*1000) skip 1 with lines lc rgb '#1f4e79' lw 1.2 "
      "notitle\nset ylabel \"u / mm\"\n",
      "set terminal svg noenhanced dynamic size 1260,840 font",
      "set ylabel \"F / N\"\nplot \"./r/run.csv\" using ($1*1000):($17*1) skip 1 with lines lc rgb "
      "'#1f4e79' lw 1.2 notitle\nunset multiplot\n",
      NULL};
  write_study("grid", "", 6, stepped);
  expect_told("plot s --quiet", MAP, __LINE__);
  write_study("sobol", "", 6, stepped);
  expect_told("plot s --quiet", BARS, __LINE__);
  static const char *const CLOUD[] = {"$points << EOD\n10 1 50\n", NULL};
  write_study("worst", "", 6, stepped);
  expect_told("plot s --quiet", CLOUD, __LINE__);
  write_study("grid", "", 5, lines);
  expect_told("plot s --quiet", CURVE, __LINE__);
  RUN_GOOD("run paper --set run.tier=switched --set run.until=20ms -o r --quiet");
  expect_told("plot r --quiet", PANELS, __LINE__);
  static const char *const OTHERS[] = {
      "title \"Displacement, force, EVA current and voltage, first "
      "50 ms\" font",
      NULL};
  RUN_GOOD(
      "run paper --set run.tier=switched --set run.until=20ms --set firing.every=1 -o o --quiet");
  expect_told("plot o --quiet", OTHERS, __LINE__); /* fired otherwise it is in no figure */
  static const char *const FORWARD[] = {" 20\nEOD\n$curve1 << EOD\n", NULL};
  RUN_GOOD("part diode -o d.inc");
  expect_told("check d.inc -o seen --quiet", FORWARD, __LINE__);
  static const char *const CLEARS[] = {"clearing: current", "clearing: voltage", NULL};
  RUN_GOOD("part fuse -o f.inc");
  expect_told("check f.inc -o melted --quiet", CLEARS, __LINE__);
  remove_tree("r");
}

/* ---- what is refused ---- */

static void bad_folders(void) {
  static const char HEAD[] = "case,id,circuit.r1_ohm,circuit.c1_nf,thyristor.v_reverse_v,p_min_m,"
                             "margin_least,weakest,status\n";
  static const struct {
    const char *file, *text; /* text NULL: the file is not there; "+...": behind the good header */
    const char *at, *says[2];
  } ROWS[] = {
      {"manifest.json", NULL, "bad/manifest.json: ", {"cannot be opened", NULL}},
      {"study.csv", NULL, "bad/study.csv: ", {"cannot be opened", NULL}},
      {"manifest.json", "", "bad/manifest.json:1:1: ", {"\"method\" is missing", NULL}},
      {"manifest.json", "{\"method\": \"grid\",", "bad/manifest.json:2:", {"not YAML", NULL}},
      {"manifest.json", "[1, 2]", "bad/manifest.json:1:2: ", {"no manifest", NULL}},
      {"manifest.json", "{\"method\": \"grid\"}", "bad/manifest.json:1:1: ", {"\"cases\"", NULL}},
      {"manifest.json",
       "{\"method\": \"grid\", \"cases\": \"many\"}",
       "bad/manifest.json:1:30: ",
       {"\"cases\"", NULL}},
      {"manifest.json",
       "{\"method\": \"grid\", \"cases\": 1, \"done\": 1, \"failed\": 0, \"axes\": 3}",
       "bad/manifest.json:1:64: ",
       {"\"axes\" must be a list", NULL}},
      {"manifest.json",
       "{\"method\": \"grid\", \"cases\": 1, \"done\": 1, \"failed\": 0, \"axes\": [], \"report\": "
       "[]}",
       "bad/study.csv:1:1: ",
       {"says nothing of column 'circuit.r1_ohm'", NULL}},
      {"manifest.json",
       "{\"method\": \"grid\", \"cases\": 1, \"done\": 1, \"failed\": 0, \"axes\": [{\"key\": "
       "\"run.until\", \"unit\": \"s\"}], \"report\": []}",
       "bad/study.csv:1:1: ",
       {"no column 'run.until_s'", "manifest.json"}},
      {"study.csv", "", "bad/study.csv:1:1: ", {"empty", NULL}},
      {"study.csv", "t_s,p_m\n0,1\n", "bad/study.csv:1:1: ", {"'case'", "'status'"}},
      {"study.csv", "case,a,a,status\n", "bad/study.csv:1:1: ", {"'a'", "twice"}},
      {"study.csv", "+0,f00,1,1,1,1,1,x\n", "bad/study.csv:2:1: ", {"cells in this row: 8", "9"}},
      {"study.csv", "+0,f00,1,1,1,1,1,x,0\n1,f00,1\n", "bad/study.csv:3:1: ", {"row: 3", NULL}},
      {"study.csv", "+first,f00,1,1,1,1,1,x,0\n", "bad/study.csv:2:1: ", {"'first'", NULL}},
      {"study.csv",
       "+1,f00,1,1,1,1,1,x,0\n1,f00,1,1,1,1,1,x,0\n",
       "bad/study.csv:3:1: ",
       {"order", NULL}},
      {"study.csv",
       "+0,f00,wide,1,1,1,1,x,0\n",
       "bad/study.csv:2:1: ",
       {"'wide'", "circuit.r1_ohm"}},
      {"study.csv", "+0,f00,1,1,high,1,1,x,0\n", "bad/study.csv:2:1: ", {"'high'", "no number"}},
      {"study.csv", "+0,f00,1,1,1,1,1,x,0\n", "bad/study.csv:1:1: ", {"rows: 1", "done"}},
      {"failures.csv", "case,why\n5,no\n", "bad/failures.csv:2:1: ", {"cells in this row: 2", "6"}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char path[64];
    vs_text text = {0};
    copy_map("bad");
    snprintf(path, sizeof path, "bad/%s", ROWS[k].file);
    unlink(path);
    bool behind = ROWS[k].text && *ROWS[k].text == '+';
    if (ROWS[k].text) vs_text_add(&text, "%s%s", behind ? HEAD : "", ROWS[k].text + behind);
    if (ROWS[k].text) write_file(path, text.text);
    char *before = listing("bad");
    refuse("plot bad", ROWS[k].text ? ROWS[k].text : ROWS[k].file, ROWS[k].at, ROWS[k].says,
           __LINE__);
    EXPECT_FILES("bad", before);
    free(before);
    vs_text_free(&text);
    remove_tree("bad");
  }
}

/* Whatever the names of a study hold, they are names. Its cases have no ids, as before there were
 * any. */
static void hostile_names(void) {
  static const char MANIFEST[] =
      "{\"study\": \"</script><script>alert(1)</script>\", \"method\": \"grid\", \"cases\": 2, "
      "\"done\": 2, \"failed\": 0, \"axes\": [{\"key\": \"a'\\nsystem 'touch made'\\n\", "
      "\"column\": \"a\", \"unit\": \"V\\n!touch made\\n\"}], \"report\": [{\"name\": "
      "\"`touch made`\", \"column\": \"../b\", \"unit\": \"\", \"rating\": 1, \"text\": "
      "\"<img src=x>\\n'\\nsystem 'touch made'\"}]}";
  remove_tree("s");
  CU_ASSERT_EQUAL(mkdir("s", 0777), 0);
  write_file("s/manifest.json", MANIFEST);
  write_file("s/study.csv", "case,a,../b,status\n0,1,1,0\n1,2,2,0\n");
  RUN_GOOD("plot s --quiet");
  EXPECT_FILES("s", ".._b.png manifest.json report.html study.csv ");
  CU_ASSERT_EQUAL(access("made", F_OK), -1);
  char *html = read_file("s/report.html");
  EXPECT(!strstr(html, "<script>alert") && !strstr(html, "<img"), "names are read as HTML");
  free(html);
}

static void no_rows(void) {
  copy_map("none");
  write_file("none/study.csv", "case,id,circuit.r1_ohm,circuit.c1_nf,thyristor.v_reverse_v,p_min_m,"
                               "margin_least,weakest,status\n");
  vs_text failures = {0};
  vs_text_add(&failures, "case,id,circuit.r1_ohm,circuit.c1_nf,status,why\n");
  for (int k = 0; k < 12; k++)
    vs_text_add(&failures, "%d,%016x,1,1,1,%s\n", k, k, k % 3 ? "jam" : "time");
  write_file("none/failures.csv", failures.text);
  vs_text_free(&failures);
  static const char ONE[] = "\"done\": 11,\n  \"failed\": 1,";
  char *manifest = read_file("none/manifest.json"), *count = strstr(manifest, ONE);
  CU_ASSERT_PTR_NOT_NULL_FATAL(count);
  vs_text changed = {0};
  vs_text_add(&changed, "%.*s\"done\": 0, \"failed\": 12,%s", (int)(count - manifest), manifest,
              count + strlen(ONE));
  write_file("none/manifest.json", changed.text);
  vs_text_free(&changed);
  free(manifest);
  RUN_GOOD("plot none --quiet");
  char *html = read_file("none/report.html");
  EXPECT(strstr(html, "No case has a result") && strstr(html, "12 of 12 cases") &&
             strstr(html, "<td class=\"n\">8</td><td>jam</td>") &&
             strstr(html, "There is nothing to draw"),
         "without rows the report says something else");
  free(html);
  static const char *const NOTHING[] = {"nothing to draw", NULL};
  refuse("plot none -o one.png", "no rows", "none/study.csv:1:1: ", NOTHING, __LINE__);
  remove_tree("none");
}

/* A run that is shorter than a sample has the row of t = 0. */
static void one_row(void) {
  RUN_GOOD("run paper --tier switched --set run.until=1e-9s -o tiny --quiet");
  static const char *const ONE[] = {"the only one", "a picture wants two", NULL};
  refuse("plot tiny", "one row", "tiny/run.csv:2:1: ", ONE, __LINE__);
  remove_tree("tiny");
}

static void bad_words(void) {
  copy_map("bad");
  static const char *const OVERLAY[] = {"--overlay", "bad holds a study"}, *const ENDING[] = {
                                                                               ".png or .svg",
                                                                               NULL};
  refuse("plot bad --overlay m.csv", "an overlay", "", OVERLAY, __LINE__);
  refuse("plot bad -o one.pdf", "an ending", "", ENDING, __LINE__);
  remove_tree("bad");
}

/* ---- in a browser ---- */

/* The page as a browser shows it is more than an empty one, and no script of it complains. */
static void in_a_browser(void) {
  static const char *const PAGES[] = {"empty.html", "s/report.html"};
  off_t size[2] = {0, 0};
  if (!on_path("chromium")) {
    puts("chromium is not installed: no screenshot");
    return;
  }
  remove_tree("s");
  copy_map("s");
  RUN_GOOD("plot s --quiet");
  write_file("empty.html", "<!DOCTYPE html><title>x</title>");
  char folder[VS_PATH_SIZE];
  CU_ASSERT_PTR_NOT_NULL_FATAL(getcwd(folder, sizeof folder));
  for (int k = 0; k < 2; k++) {
    char page[VS_PATH_SIZE + 64];
    snprintf(page, sizeof page, "file://%s/%s", folder, PAGES[k]);
    const char *const words[] = {"env",
                                 "chromium",
                                 "--headless",
                                 "--no-sandbox",
                                 "--disable-gpu",
                                 "--user-data-dir=browser",
                                 "--enable-logging=stderr",
                                 "--virtual-time-budget=3000",
                                 "--window-size=1200,1600",
                                 "--screenshot=shot.png",
                                 page,
                                 NULL};
    unlink("shot.png");
    ran r = collect(spawn_other("/usr/bin/env", words, environ));
    EXPECT(r.status == 0 && !strstr(r.err, "CONSOLE"), "%s: exit status %d: %s", page, r.status,
           r.err);
    free_ran(&r);
    struct stat st = {0};
    CU_ASSERT_EQUAL(stat("shot.png", &st), 0);
    size[k] = st.st_size;
  }
  EXPECT(size[1] > 6 * size[0], "the screenshot has %ld bytes, an empty page's %ld", (long)size[1],
         (long)size[0]);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"percentiles", percentiles},
      {"shares", shares},
      {"contours", contours},
      {"units", units},
      {"a range says whether it is logarithmic", a_range_says_whether_it_is_logarithmic},
      {"bars add up", bars_add_up},
      {"bad folders", bad_folders},
      {"bad words", bad_words},
      /* from here on gnuplot draws */
      {"a map", a_map},
      {"the same bytes", the_same_bytes},
      {"one picture", one_picture},
      {"named cases", named_cases},
      {"samples", samples},
      {"all alike", all_alike},
      {"a yield with failures", a_yield_with_failures},
      {"other methods", other_methods},
      {"axes of words", axes_of_words},
      {"pictures are of the numbers", pictures_are_of_the_numbers},
      {"hostile names", hostile_names},
      {"no rows", no_rows},
      {"one row", one_row},
      {"in a browser", in_a_browser},
  };
  return program_suite("report", TESTS, on_path("gnuplot") ? COUNT(TESTS) : 7);
}
