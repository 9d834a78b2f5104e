/* SPDX-License-Identifier: GPL-3.0-or-later
 * The same case says the same through every door: a run, a study's case and a trial in memory tell
 * one rung, one set of warnings, one verdict; and books that are open beyond all sense are no
 * result through any of them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "program.h"
#include "study/workers/case.h"

/* The shipped deck with one line more. */
static void write_deck_with(const char *name, const char *more) {
  char path[512], *line = NULL;
  size_t size = 0;
  snprintf(path, sizeof path, "%s/../spice/halfwave_snubbed.cir", VS_TEST_FOLDER);
  FILE *in = fopen(path, "r"), *out = fopen(name, "w");
  CU_ASSERT_FATAL(in && out);
  while (getline(&line, &size, in) >= 0) fputs(line, out);
  fputs(more, out);
  free(line);
  fclose(in);
  fclose(out);
}

/* A store line that is wrong by far: more is left over than there ever was. */
static void books_beyond_sense_are_no_result(void) {
  static const char WHY[] = "the energy books (circuit) leave ";
  write_deck_with("wrong.cir", "*$ store c2x = 9999*{c2}*v(c2p)^2/2\n");
  ran r = run("run paper --set circuit.deck=wrong.cir --set run.until=30ms -o out");
  EXPECT(r.status == 1 && strstr(r.err, "t = 0.0") && strstr(r.err, WHY) &&
             strstr(r.err, "out/run.partial.csv"),
         "%d %s", r.status, r.err);
  EXPECT_FILES("out", "run.partial.csv ");
  free_ran(&r);
  write_file("s.yaml", "set: {circuit.deck: wrong.cir, run.until: 30 ms}\n"
                       "vary: {circuit.r1: [100 ohm]}\nreport: [p_min]\n");
  r = run("study s.yaml --quiet -o all");
  char *failures = read_file("all/failures.csv");
  EXPECT(r.status == 1 && strstr(failures, WHY), "%d %s", r.status, failures);
  free(failures), free_ran(&r);
}

/* Books that are open as far as a missing line may leave them are warned of in a run, in its
 * summary and in a row. */
static void open_books_are_told_everywhere(void) {
  static const char WHY[] = "the energy books do not close (circuit)";
  write_deck_with("open.cir", "*$ loss more = v(b,c2p)^2/{r2}\n");
  ran r = run("run paper --set circuit.deck=open.cir --set run.until=30ms --json");
  EXPECT(r.status == 0 && strstr(r.err, WHY), "%d %s", r.status, r.err);
  const char *warnings = strstr(r.out, "\"warnings\": [");
  EXPECT(warnings && strstr(warnings, WHY) && strstr(warnings, WHY) < strstr(warnings, "]"), "%s",
         r.out);
  free_ran(&r);
  write_file("s.yaml", "set: {circuit.deck: open.cir, run.until: 30 ms}\n"
                       "vary: {circuit.r1: [100 ohm]}\nreport: [p_min]\n");
  r = run("study s.yaml --quiet");
  EXPECT(r.status == 0 && strstr(r.out, WHY), "%d %s", r.status, r.out);
  free_ran(&r);
}

/* run and a study that asks for run.verify tell the same margin, error, rung and status. */
static void one_verdict_through_both_doors(void) {
  write_file("s.yaml", "set: {circuit.thyristor: TYN1212, run.until: 30 ms, run.verify: always}\n"
                       "vary: {circuit.r1: [330 ohm]}\nreport: [p_min]\n");
  ran study = run("study s.yaml --quiet"), one = run("run paper --set circuit.thyristor=TYN1212 "
                                                     "--set run.until=30ms --set "
                                                     "circuit.r1=330ohm --json --quiet");
  char *row = strchr(study.out, '\n'), *cell[256], want[128];
  CU_ASSERT_PTR_NOT_NULL_FATAL(row);
  const size_t n = vs_csv_split(row + 1, cell, 256, NULL);
  CU_ASSERT_FATAL(n > 9); /* from margin_least to status */
  snprintf(want, sizeof want, "\"margin\": %s, \"margin_error\": %s", cell[n - 9], cell[n - 8]);
  EXPECT(strstr(one.out, want), "%s in %s", want, one.out);
  snprintf(want, sizeof want, "\"rung\": {\"number\": %s,", cell[n - 6]);
  EXPECT(strstr(one.out, want), "%s in %s", want, one.out);
  EXPECT(one.status == study.status && one.status == atoi(cell[n - 1]), "%d, %d, %s", one.status,
         study.status, cell[n - 1]);
  free_ran(&study), free_ran(&one);
}

/* A loss that is wrong by far does not raise the bar that it is judged by. */
static void a_wrong_loss_is_no_result(void) {
  write_deck_with("loss.cir", "*$ loss more = 1e6*v(b,c2p)^2/{r2}\n");
  ran r = run("run paper --set circuit.deck=loss.cir --set run.until=20ms");
  EXPECT(r.status == 1 && strstr(r.err, "the energy books (circuit) leave -"), "%d %s", r.status,
         r.err);
  free_ran(&r);
}

/* What a pair of transistors has stored flows on behind its conduction, at some volts: that is no
 * misfire, and the turn-off behind it is judged. */
static void a_turn_off_behind_a_tail_is_judged(void) {
  ran r = run("run paper --set circuit.deck=halfwave_paper --set run.until=25ms --set "
              "run.verify=never --json --quiet");
  EXPECT(r.status == 0 && strstr(r.out, "\"thyristor.misfires\": {\"value\": 0,") &&
             strstr(r.out, "\"measure\": \"t_off\""),
         "%d %s", r.status, r.out);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"books beyond sense are no result", books_beyond_sense_are_no_result},
    {"open books are told everywhere", open_books_are_told_everywhere},
    {"a wrong loss is no result", a_wrong_loss_is_no_result},
    {"a turn-off behind a tail is judged", a_turn_off_behind_a_tail_is_judged},
    {"one verdict through both doors", one_verdict_through_both_doors},
};

int main(void) {
  return program_suite("session", TESTS, COUNT(TESTS));
}
