/* SPDX-License-Identifier: GPL-3.0-or-later
 * Measured curves over computed ones: what the pictures show of them, and which files are refused.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

/* A run to lay curves over; it stays for all tests. */
static void compute(void) {
  RUN_GOOD("run paper -o run --tier circuit --set run.until=0.06s --quiet");
}

/* ---- curves in an SVG ---- */

enum { MOST_CURVES = 32, MOST_COORDINATES = 2048, LEAST_COORDINATES = 40 };
static const char COMPUTED[] = "rgb( 31,  78, 121)", MEASURED[] = "rgb(209,  73,  91)";

typedef struct curves {
  int count, length[MOST_CURVES];
  double at[MOST_CURVES][MOST_COORDINATES]; /* x, y, x, y, ... in pixels */
} curves;

/* The curves of one colour. The stroke in the legend, which may come first in the same path, is
 * shorter. */
static curves *read_curves(const char *svg, const char *colour) {
  curves *c = vs_alloc(1, sizeof *c);
  char start[64];
  snprintf(start, sizeof start, "<path stroke='%s'  d='", colour);
  for (const char *s = svg; (s = strstr(s, start)) && c->count < MOST_CURVES;) {
    s += strlen(start);
    int n = 0;
    while (*s && *s != '\'' && n < MOST_COORDINATES) {
      char *end;
      const char *sign = s;
      s += strspn(s, "ML, \t\n");
      if (memchr(sign, 'M', (size_t)(s - sign)) && n < LEAST_COORDINATES) n = 0;
      double value = strtod(s, &end);
      if (end == s) break;
      c->at[c->count][n++] = value;
      s = end;
    }
    c->length[c->count] = n;
    c->count += n >= LEAST_COORDINATES;
  }
  return c;
}

/* How many measured curves lie on a computed one: within what an SVG rounds to, 0.01 pixel. */
static int count_coinciding(const curves *computed, const curves *measured) {
  int coincide = 0;
  for (int m = 0; m < measured->count; m++)
    for (int c = 0; c < computed->count; c++) {
      double worst = computed->length[c] == measured->length[m] ? 0 : INFINITY;
      for (int k = 0; worst < INFINITY && k < measured->length[m]; k++)
        worst = fmax(worst, fabs(computed->at[c][k] - measured->at[m][k]));
      coincide += worst < 0.015;
    }
  return coincide;
}

static void expect_picture(const char *path, int panels, int with_measured, int coinciding,
                           int line) {
  char *svg = read_file(path);
  curves *computed = read_curves(svg, COMPUTED), *measured = read_curves(svg, MEASURED);
  int coincide = count_coinciding(computed, measured);
  expect(computed->count == panels && measured->count == with_measured && coincide == coinciding,
         line, "%s: %d computed and %d measured curves, %d coincide", path, computed->count,
         measured->count, coincide);
  expect(count_words(svg, ">measured<") == with_measured &&
             count_words(svg, ">computed<") == with_measured,
         line, "%s: legends: %d measured, %d computed", path, count_words(svg, ">measured<"),
         count_words(svg, ">computed<"));
  free(computed);
  free(measured);
  free(svg);
}
#define EXPECT_PICTURE(...) expect_picture(__VA_ARGS__, __LINE__)

/* ---- files ---- */

/* Columns of run.csv, under other names and times their factors, as a file of its own. */
typedef struct column {
  const char *name, *as;
  double factor;
} column;

static void copy_columns(const char *path, const column *columns, size_t count) {
  char *text = read_file("run/peaks.csv"), *rest = text, *header = strsep(&rest, "\n");
  FILE *out = fopen(path, "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(out);
  for (size_t k = 0; k < count; k++) fprintf(out, "%s%s", k ? "," : "", columns[k].as);
  fputc('\n', out);
  for (char *row; (row = strsep(&rest, "\n")) && *row;)
    for (size_t k = 0; k < count; k++) {
      const char *name = header, *cell = row;
      size_t n = strlen(columns[k].name);
      while (strncmp(name, columns[k].name, n) || (name[n] && name[n] != ',')) {
        CU_ASSERT_PTR_NOT_NULL_FATAL(name = strchr(name, ','));
        cell = strchr(cell, ',') + 1;
        name++;
      }
      fprintf(out, "%s%.12g%s", k ? "," : "", strtod(cell, NULL) * columns[k].factor,
              k + 1 < count ? "" : "\n");
    }
  CU_ASSERT_EQUAL(fclose(out), 0);
  free(text);
}

/* ---- the tests ---- */

/* The run's own columns in other units lie exactly on the computed curves: on every sheet, each in
 * the panel of its probe; the deck's v_ak, of which no sheet has a panel, on the last. */
static void other_units_make_the_same_curve(void) {
  static const column COLUMNS[] = {{"t_s", "t_us", 1e6},
                                   {"p_m", "p_mm", 1e3},
                                   {"i_a", "i_ma", 1e3},
                                   {"ap_m_s2", "ap_mm_s2", 1e3},
                                   {"v_eva_v", "v_eva_kV", 1e-3},
                                   {"v_ak_v", "v_ak_mv", 1e3},
                                   {"phi_rad", "phi_deg", 57.29577951308232}};
  copy_columns("m.csv", COLUMNS, COUNT(COLUMNS));
  RUN_GOOD("plot run --quiet --overlay m.csv");
  EXPECT_PICTURE("run/motion_run.svg", 9, 3, 3);   /* p, phi, ap */
  EXPECT_PICTURE("run/motion_100ms.svg", 9, 3, 3); /* the same */
  EXPECT_PICTURE("run/pulse_50ms.svg", 5, 4, 4);   /* p, i, v_eva, v_ak */
  RUN_GOOD("plot run --quiet --overlay m.csv -o one.svg");
  EXPECT_PICTURE("one.svg", 8, 6, 6); /* p, ap, i, v_eva; v_ak and phi have panels more */
  RUN_GOOD("plot run --quiet --overlay m.csv -o one.png");
  char *png = read_file("one.png");
  CU_ASSERT_EQUAL(strncmp(png, "\x89PNG\r\n", 6), 0);
  free(png);
}

/* The same with another height: the curve is there and is another. */
static void another_curve_is_another(void) {
  static const column COLUMNS[] = {{"t_s", "t_s", 1}, {"p_m", "p_m", 1.01}};
  copy_columns("m.csv", COLUMNS, COUNT(COLUMNS));
  RUN_GOOD("plot run --quiet --overlay m.csv -o one.svg");
  EXPECT_PICTURE("one.svg", 6, 1, 0);
}

/* Sheets without a measured curve are the same bytes as without an overlay. */
static void other_sheets_stay_as_they_are(void) {
  static const column COLUMNS[] = {{"t_s", "t_s", 1}, {"i_a", "i_a", 1}};
  copy_columns("m.csv", COLUMNS, COUNT(COLUMNS));
  RUN_GOOD("plot run --quiet");
  char *motion = read_file("run/motion_run.svg"), *pulse = read_file("run/pulse_50ms.svg");
  EXPECT_PICTURE("run/pulse_50ms.svg", 4, 0, 0);
  RUN_GOOD("plot run --quiet --overlay m.csv");
  char *motion_again = read_file("run/motion_run.svg"),
       *pulse_again = read_file("run/pulse_50ms.svg");
  EXPECT(!strcmp(motion, motion_again), "motion_run.svg is not what it was");
  EXPECT(strcmp(pulse, pulse_again), "pulse_50ms.svg is what it was");
  free(motion);
  free(motion_again);
  free(pulse);
  free(pulse_again);
}

/* A few rows are drawn with their points; marks, blanks, CRLF and blank lines at the end are no
 * mistakes, nor are a name that gnuplot would run as a command and rows before the run. */
static void what_files_may_look_like(void) {
  vs_text text = {0};
  vs_text_add(&text, "\xEF\xBB\xBFt_ms, force_n ,i_mA\r\n-1,0,0\r\n");
  for (int k = 0; k < 50; k++) vs_text_add(&text, " %d ,%d.5e1,\t+.5\r\n", k, k % 9);
  vs_text_add(&text, "\r\n  \n\n");
  write_file("<touch made_by_gnuplot", text.text);
  RUN_GOOD("plot run --quiet -o '|touch made_by_gnuplot.svg' --overlay '<touch made_by_gnuplot'");
  vs_text_free(&text);
  CU_ASSERT_EQUAL(access("made_by_gnuplot", F_OK), -1);
  CU_ASSERT_EQUAL(access("made_by_gnuplot.svg", F_OK), -1);
}

/* Without summary.json the end of a name tells the unit. */
static void without_a_summary(void) {
  write_file("same.csv", "t_s,v_ak_v,p_mm\n0,1,1\n0.01,2,2\n");
  write_file("scaled.csv", "t_s,v_ak_kv\n0,1\n0.01,2\n");
  RUN_GOOD("plot run --quiet -o one.svg --overlay scaled.csv");
  CU_ASSERT_EQUAL(rename("run/summary.json", "summary.json"), 0);
  RUN_GOOD("plot run --quiet -o one.svg --overlay same.csv");
  RUN_GOOD("plot run --quiet -o one.svg --overlay scaled.csv");
  CU_ASSERT_EQUAL(rename("summary.json", "run/summary.json"), 0);
}

static void bad_files_are_refused(void) {
  static const struct {
    const char *text, *at, *says[2];
  } ROWS[] = {
      {"t_s,pp_m\n0,1\n", "m.csv:1:5: ", {"run/run.csv has no column 'pp_m'", "'p_m'"}},
      {"t_s,p_m, forze_n\n0,1,1\n", "m.csv:1:10: ", {"'forze_n'", "'force_n'"}},
      {"t_s,v_ka_v\n0,1\n", "m.csv:1:5: ", {"'v_ka_v'", "'v_ak_v'"}},
      {"t_s,frobnicate\n0,1\n", "m.csv:1:5: ", {"'frobnicate'", NULL}},
      {"t_s,p_kg\n0,1\n", "m.csv:1:5: ", {"'kg' is no unit of p", "'p_m'"}},
      {"t_s,p\n0,1\n", "m.csv:1:5: ", {"'' is no unit of p", "'p_m'"}},
      {"t_s,p_m2\n0,1\n", "m.csv:1:5: ", {"'m2' is no unit of p", "'p_m'"}},
      {"t_s,ap_m_s\n0,1\n", "m.csv:1:5: ", {"'m_s' is no unit of ap", "'ap_m_s2'"}},
      {"t_s,i_ma,p_m,i_a\n0,1,1,1\n", "m.csv:1:14: ", {"i_a", "second time"}},
      {"t_s,,p_m\n0,1,1\n", "m.csv:1:5: ", {"no column ''", NULL}},
      {"t_s\n0\n", "m.csv:1:1: ", {"no column follows the time", "'p_mm'"}},
      {"p_m,t_s\n0,1\n", "m.csv:1:1: ", {"t_ms", "'p_m'"}},
      {"t_m,p_m\n0,1\n", "m.csv:1:1: ", {"t_ms", "'t_m'"}},
      {"t_ms;i_ma;p_um\n0;1;2\n", "m.csv:1:1: ", {"cut at commas", "has ';'"}},
      {"t_s\tp_m\n0\t1\n", "m.csv:1:1: ", {"cut at commas", "has tabs"}},
      {"", "m.csv:1:1: ", {"the file is empty", NULL}},
      {"t_s,p_m", "m.csv:1:1: ", {"no row of numbers", NULL}},
      {"t_s,p_m\n\n \n", "m.csv:3:1: ", {"no row of numbers", NULL}},
      {"t_s,p_m\n-1,1\n", "m.csv:2:1: ", {"no row lies within the run", "0 to 0.06 s"}},
      {"t_ms,p_m\n60.1,1\n70,1\n", "m.csv:3:1: ", {"no row lies within the run", NULL}},
      {"t_s,p_m\n0,1\n1,1,1\n",
       "m.csv:3:1: ",
       {"cells in this row: 3", "columns in the header: 2"}},
      {"t_s,p_m\n0\n", "m.csv:2:1: ", {"cells in this row: 1", NULL}},
      {"t_s,p_m\n0,one\n", "m.csv:2:3: ", {"'one'", "number"}},
      {"t_s,p_m\n0,1\n1, 2 m\n", "m.csv:3:4: ", {"'2 m'", "number"}},
      {"t_s,p_m\n0,\n", "m.csv:2:3: ", {"''", "number"}},
      {"t_s,p_m\n0,nan\n", "m.csv:2:3: ", {"'nan'", "number"}},
      {"t_s,p_m\n0,1e999\n", "m.csv:2:3: ", {"'1e999'", "finite"}},
      {"t_s,p_m\n0,1e-400\n", "m.csv:2:3: ", {"'1e-400'", "too small"}},
      {"t_s,p_m\n0,0x1p3\n", "m.csv:2:3: ", {"'0x1p3'", "number"}},
      {"t_s,p_m\n0,1\r1,2\r", "m.csv:2:", {"cells in this row: 3", NULL}},
      {"# from the rig\nt_s,p_m\n0,1\n", "m.csv:1:1: ", {"t_ms", "'# from the rig'"}},
      {"t_s,p_m\n0,1\n0,2\n", "m.csv:3:1: ", {"does not rise", "0 after 0"}},
      {"t_s,p_m\n0,1\n1,2\n0.5,2\n", "m.csv:4:1: ", {"does not rise", "0.5 after 1"}},
      {"t_s,p_m\n0,1\n\n\n1,2\n", "m.csv:3:1: ", {"blank line", NULL}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_file("m.csv", ROWS[k].text);
    refuse("plot run --overlay m.csv -o new.svg", ROWS[k].text, ROWS[k].at, ROWS[k].says, __LINE__);
  }
  static const struct {
    const char *words, *says[2];
  } FILES[] = {
      {"plot run --overlay nowhere.csv", {"nowhere.csv: cannot be opened", "No such file"}},
      {"plot run --overlay run", {"run: cannot be opened", "not a plain file"}},
      {"plot run --overlay /dev/null", {"/dev/null", "not a plain file"}},
      {"plot run --overlay", {"--overlay", NULL}},
      {"plot run --overlay 'm\n.csv'", {"line break", NULL}},
      {"run paper --overlay m.csv", {"--overlay", NULL}}};
  for (size_t k = 0; k < COUNT(FILES); k++)
    refuse(FILES[k].words, FILES[k].words, "", FILES[k].says, __LINE__);
  FILE *f = fopen("m.csv", "wb");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  static const char *const ZERO[] = {"zero byte", NULL};
  CU_ASSERT_EQUAL(fwrite("t_s,p_m\n0,1\0002\n", 1, 15, f), 15);
  CU_ASSERT_EQUAL(fclose(f), 0);
  refuse("plot run --overlay m.csv", "a zero byte", "m.csv:2:1: ", ZERO, __LINE__);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"a run", compute},
      {"bad files are refused", bad_files_are_refused},
      /* from here on gnuplot draws */
      {"other units make the same curve", other_units_make_the_same_curve},
      {"another curve is another", another_curve_is_another},
      {"other sheets stay as they are", other_sheets_stay_as_they_are},
      {"what files may look like", what_files_may_look_like},
      {"without a summary", without_a_summary},
  };
  return program_suite("overlay", TESTS, on_path("gnuplot") ? COUNT(TESTS) : 2);
}
