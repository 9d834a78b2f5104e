/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a verdict leaves open is called by its name, in a run's table and in a study's report; and a
 * run over an older one names what it replaces, the pictures drawn of that too. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

/* halfwave_bare with this rating in the place of its own. */
static void write_rated(const char *rating) {
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_bare.cir");
  vs_text deck = {0};
  for (char *rest = text, *line; (line = strsep(&rest, "\n"));)
    if (strncmp(line, "*$ rating", 9)) vs_text_add(&deck, "%s\n", line);
  vs_text_add(&deck, "%s", rating);
  write_file("near.cir", deck.text);
  vs_text_free(&deck);
  free(text);
}

/* The source's current peaks at 0.83957 A: its limit is met to less than the run's error of 3e-3.
 */
static void undecided_limits(void) {
  write_rated("*$ rating i_source -10..0.8396 A\n");
  ran r = run("run paper --set circuit.deck=near.cir --set run.until=0.02s "
              "--set run.tolerance=1e-3");
  EXPECT(r.status == 3 && strstr(r.out, "\nundecided: i_source\n"), "%d %s%s", r.status, r.out,
         r.err);
  free_ran(&r);
  if (!on_path("gnuplot")) return;
  write_file("n.yaml", "set: {circuit.deck: near.cir, run.until: 20 ms, run.tolerance: 1e-3, "
                       "run.verify: always}\nvary: {firing.angle: [100 deg, 130 deg]}\n"
                       "report: [i_peak]\n");
  r = run("study n.yaml -o n --quiet");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  free_ran(&r);
  RUN_GOOD("plot n --quiet");
  char *html = read_file("n/report.html");
  EXPECT(strstr(html,
                "1 case undecided: the sign of a margin is within its numerical error, that of "
                "i_source in 1.") != NULL,
         "the report names no limit");
  free(html);
}

static void a_run_over_another(void) {
  static const char WORDS[] = "run paper --tier switched --set run.until=20ms -o r";
  if (!on_path("gnuplot")) return;
  RUN_GOOD("run paper --tier switched --set run.until=20ms -o r --quiet");
  RUN_GOOD("plot r --quiet");
  write_file("r/mine.png", "mine");
  write_file("else.svg", "mine");
  unlink("r/pulse_50ms.svg");
  CU_ASSERT_EQUAL(symlink("../else.svg", "r/pulse_50ms.svg"), 0);
  ran r = run("%s", WORDS);
  EXPECT(r.status == 0 && strstr(r.err, "summary.json, motion_run.png, motion_run.svg, "
                                        "motion_100ms.png, motion_100ms.svg, pulse_50ms.png, "
                                        "report.html\n"),
         "%d %s", r.status, r.err);
  free_ran(&r);
  EXPECT_FILES("r", "events.csv mine.png pulse_50ms.svg run.csv summary.json ");
  char *text = read_file("else.svg");
  CU_ASSERT_STRING_EQUAL(text, "mine");
  free(text);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"undecided limits", undecided_limits},
      {"a run over another", a_run_over_another},
  };
  return program_suite("named", TESTS, COUNT(TESTS));
}
