/* SPDX-License-Identifier: GPL-3.0-or-later
 * Netlists that crash ngspice, end the process, or both. `run` takes a netlist under guard and
 * begins anew where that goes wrong; a scene that comes through a pipe is tried in a child process
 * first. The user is told the same. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

/* Writes NAME.cir, a shipped deck with lines added, and NAME.yaml, which also makes the program
 * warn: nothing is rated, and it fires once. */
static void write_scene(const char *name, const char *lines) {
  char path[64];
  char *deck = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  vs_text text = {0};
  vs_text_add(&text, "%s\nRadded added 0 1k\n%s\n", deck, lines);
  snprintf(path, sizeof path, "%s.cir", name);
  write_file(path, text.text);
  vs_text_free(&text);
  free(deck);
  vs_text_add(&text, "circuit: {deck: %s.cir}\nrun: {tier: circuit, until: 0.5 ms}\n", name);
  snprintf(path, sizeof path, "%s.yaml", name);
  write_file(path, text.text);
  vs_text_free(&text);
}

static void it_is_a_message(void) {
  static const struct {
    const char *name, *lines, *says[2];
  } ROWS[] = {
      {"crash", "Badded added 0 V=pwl(time)", {"ngspice died of it (signal 11)", NULL}},
      {"stack", ".func f(x) {f(x)}\nBadded added 0 V=f(time)", {"ngspice died of it", NULL}},
      {"end", "Rmore added 0 {undefined}", {"end.cir", "Undefined parameter [undefined]"}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char words[128];
    write_scene(ROWS[k].name, ROWS[k].lines);
    snprintf(words, sizeof words, "run %s.yaml -o out", ROWS[k].name);
    refuse(words, ROWS[k].name, "", ROWS[k].says, __LINE__);
    EXPECT(access("out", F_OK) != 0, "%s: a folder stays behind", ROWS[k].name);
  }
}

/* A pipe is read once, so that a process that began anew would find an empty scene, which is
 * another one. */
static void a_pipe_is_tried_first(void) {
  char command[2 * VS_PATH_SIZE];
  write_scene("crash", "Badded added 0 V=pwl(time)");
  snprintf(command, sizeof command,
           "cat crash.yaml | '%s' run /dev/stdin >out 2>err; echo $? >status", VS_PROGRAM);
  EXPECT(system(command) == 0, "%s", command);
  char *status = read_file("status"), *err = read_file("err");
  EXPECT(!strcmp(status, "2\n") && strstr(err, "ngspice died of it"), "%s: %s", status, err);
  free(status);
  free(err);
}

/* The guard ends with the first step: a run that it was on for does not end as one that was
 * guarded, and gives the numbers of a case of a study, which is tried in a child process. */
static void the_numbers_are_those_of_a_trial(void) {
  write_scene("good", "");
  write_file("one.yaml",
             "scene: good.yaml\nvary: {firing.angle: [100 deg]}\nreport: [p_min, v_ak_max]\n");
  RUN_GOOD("run good.yaml -o good");
  RUN_GOOD("study one.yaml -o one --keep runs --jobs 1");
  char *alone = read_file("good/run.csv"), *kept = read_file("one/runs/0/run.csv");
  EXPECT(*alone && !strcmp(alone, kept), "run.csv: %.80s and %.80s", alone, kept);
  free(alone);
  free(kept);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"a netlist that ngspice dies of is a message", it_is_a_message},
      {"a scene from a pipe is tried first", a_pipe_is_tried_first},
      {"the numbers are those of a trial", the_numbers_are_those_of_a_trial},
  };
  return program_suite("guard", TESTS, COUNT(TESTS));
}
