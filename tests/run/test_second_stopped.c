/* SPDX-License-Identifier: GPL-3.0-or-later
 * Ctrl-C in the second run of a scene, which only tells the errors of the margins: what the first
 * one came to is there, whole, and says that it is unverified. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "engine/budget.h"
#include "program.h"

/* At this tolerance the second run is the finer one and takes more than twice as long. */
#define SCENE                                                                                      \
  "run paper --set circuit.thyristor=TYN1212 --set run.tolerance=1e-3 --set run.until=0.4s "       \
  "--set firing.every=1 --set run.leave_circuit=never --reproducible "

/* SIGINT after so long. */
static ran stopped_after(double s) {
  const struct timespec pause = {(time_t)s, (long)(1e9 * (s - (double)(time_t)s))};
  char words[512];
  const char *argv[MOST_WORDS];
  snprintf(words, sizeof words, "%s", SCENE "-o r");
  split(words, argv);
  pid_t child = spawn_ready(argv);
  nanosleep(&pause, NULL);
  kill(child, SIGINT);
  return collect(child);
}

static void first_is_whole(void) {
  double before = vs_budget_clock_s();
  ran alone = run(SCENE "--set run.verify=never -o a");
  double took = vs_budget_clock_s() - before;
  EXPECT(alone.status == 0 || alone.status == 3, "%d %s", alone.status, alone.err);
  ran r = stopped_after(2 * took);
  for (int k = 0; k < 4 && !strstr(r.err, "second run"); k++) { /* a busy machine: another time */
    free_ran(&r);
    remove_tree("r");
    r = stopped_after((1.3 + 0.4 * k) * took);
  }
  EXPECT(r.status == 75 && strstr(r.err, "the first run's result is whole"), "%d %s", r.status,
         r.err);
  EXPECT(strstr(r.err, "warning: no margin's error is known"), "%s", r.err);
  EXPECT_FILES("r", "events.csv peaks.csv run.csv summary.json ");
  EXPECT(strstr(r.out, "unverified") && strstr(r.out, "stopped by a signal"), "%s", r.out);
  static const char *const SAME[] = {"run.csv", "events.csv"};
  for (size_t k = 0; k < COUNT(SAME); k++) {
    char path[2][32];
    snprintf(path[0], sizeof path[0], "a/%s", SAME[k]);
    snprintf(path[1], sizeof path[1], "r/%s", SAME[k]);
    char *one = read_file(path[0]), *other = read_file(path[1]);
    EXPECT(*one && !strcmp(one, other), "%s differs", SAME[k]);
    free(one), free(other);
  }
  char *json = read_file("r/summary.json");
  EXPECT(strstr(json, "\"word\": \"unverified\"") && strstr(json, "\"margin_error\": null") &&
             strstr(json, "stopped by a signal"),
         "%s", json);
  free(json);
  free_ran(&alone);
  free_ran(&r);
}

int main(void) {
  static const vs_test TESTS[] = {{"the first run's result is whole", first_is_whole}};
  return program_suite("second_stopped", TESTS, COUNT(TESTS));
}
