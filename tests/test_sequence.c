/* SPDX-License-Identifier: GPL-3.0-or-later
 * Where the second run of a scene fires another number of times than the first one, that is said:
 * on standard error, in summary.json, in the rows of studies. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "program.h"

/* Late, with small snubbers: what goes out in C2's ring and fires again hangs on the tolerance. The
 * deck with a rating of its own, for the sake of which a second run is made. */
#define CIRCUIT "circuit: {deck: own.cir, r1: 1.33 ohm, c1: 0.341 nF, r2: 27.7 ohm, c2: 0.263 nF}\n"
#define SCENE                                                                                      \
  CIRCUIT "supply: {voltage: 243 V, resistance: 1.79 ohm, inductance: 10.4 mH}\n"                  \
          "firing: {angle: 142.2 deg}\nrun: {until: 12 ms, verify: always}\n"
static const char WORDS[] = "the sequence of firings depends on the tolerance: ";

static void write_files(void) {
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  vs_text deck = {0};
  vs_text_add(&deck, "%s\n*$ rating v_c2 -2000..2000 V\n", text);
  write_file("own.cir", deck.text);
  write_file("s.yaml", SCENE);
  vs_text_free(&deck);
  free(text);
}

/* tolerance: of the run. The second one's is 10 times as large where that is small. */
static void says(const char *tolerance, const char *first, const char *second) {
  ran r = run("run s.yaml --json --reproducible --set run.tolerance=%s", tolerance);
  const char *list = strstr(r.out, "\"warnings\": ["), *end = list ? strchr(list, ']') : NULL;
  const char *said = list ? strstr(list, WORDS) : NULL;
  EXPECT(!strstr(r.err, WORDS) == !first, "%s: %s", tolerance, r.err);
  EXPECT(list && !(said && said < end) == !first, "%s: %s", tolerance, r.out);
  if (first) EXPECT(strstr(r.err, first) && strstr(r.err, second), "%s: %s", tolerance, r.err);
  free_ran(&r);
}

static void in_a_run(void) {
  write_files();
  says("1e-4", " at run.tolerance = 0.0001, ", " at 0.001; ");
  says("3e-5", " at run.tolerance = 3e-05, ", " at 0.0003; ");
  says("3e-4", " at run.tolerance = 0.0003, ", " at 3e-05; ");
  unlink("s.yaml");
  write_file("s.yaml",
             "circuit: {deck: halfwave_snubbed, thyristor: TYN1212}\nrun: {until: 25 ms}\n");
  says("1e-4", NULL, NULL);
  unlink("s.yaml"), unlink("own.cir");
}

static void in_a_study(void) {
  write_files();
  write_file("a.yaml", "scene: s.yaml\nvary: {run.tolerance: [3e-5]}\n");
  ran r = run("study a.yaml -o f");
  char *rows = read_file("f/study.csv");
  EXPECT((r.status == 0 || r.status == 3) && strstr(rows, WORDS), "%d %s: %s", r.status, r.err,
         rows);
  free(rows);
  free_ran(&r);
  remove_tree("f");
  unlink("s.yaml"), unlink("a.yaml"), unlink("own.cir");
}

static const vs_test TESTS[] = {{"in a run", in_a_run}, {"in a study", in_a_study}};
int main(void) {
  return program_suite("sequence", TESTS, COUNT(TESTS));
}
