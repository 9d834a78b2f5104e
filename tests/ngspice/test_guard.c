/* SPDX-License-Identifier: GPL-3.0-or-later
 * Netlists that crash ngspice, end the process, or both. `run` takes a netlist under guard and
 * begins anew where that goes wrong; a scene that comes through a pipe is tried in a child process
 * first. The user is told the same. */
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
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

/* A line of which ngspice 39 dies, and which newer ones refuse; and what is said of it. */
static const char CRASH[] = "Badded added 0 V=pwl(time)";

static const char *says_of_crash(void) {
  return is_newer_ngspice() ? "PWL(expr, points...)" : "ngspice died of it (signal 11)";
}

static void it_is_a_message(void) {
  const struct {
    const char *name, *lines, *says[2];
  } ROWS[] = {
      {"crash", CRASH, {says_of_crash(), NULL}},
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

/* A sum is a tree as deep as it has terms, through which ngspice goes down by calls of itself. A
 * crash for want of stack is told on a stack of its own. */
static void for_want_of_stack(void) {
#ifdef __SANITIZE_ADDRESS__
  return; /* the program wants more stack itself then */
#endif
  static const char *const SAYS[] = {"ngspice died of it", NULL};
  struct rlimit before, small;
  vs_text sum = {0};
  vs_text_add(&sum, "Badded added 0 V=time");
  for (int k = 0; k < 9000; k++) vs_text_add(&sum, "+time");
  write_scene("stack", sum.text);
  vs_text_free(&sum);
  getrlimit(RLIMIT_STACK, &before);
  small = before;
  small.rlim_cur = 512 * 1024;
  setrlimit(RLIMIT_STACK, &small);
  refuse("run stack.yaml -o out", "stack", "", SAYS, __LINE__);
  setrlimit(RLIMIT_STACK, &before);
}

/* A pipe is read once, so that a process that began anew would find an empty scene, which is
 * another one. */
static void a_pipe_is_tried_first(void) {
  char command[2 * VS_PATH_SIZE];
  write_scene("crash", CRASH);
  snprintf(command, sizeof command,
           "cat crash.yaml | '%s' run /dev/stdin >out 2>err; echo $? >status", VS_PROGRAM);
  EXPECT(system(command) == 0, "%s", command);
  char *status = read_file("status"), *err = read_file("err");
  EXPECT(!strcmp(status, "2\n") && strstr(err, says_of_crash()), "%s: %s", status, err);
  free(status);
  free(err);
}

/* A process that inherits the word by which one that begins anew knows it is none. */
static void the_word_is_not_inherited(void) {
  write_scene("good", "");
  write_scene("crash", CRASH);
  setenv("VIBROSPICE_BEGUN_ANEW", "1", 1);
  ran good = run("run good.yaml --quiet"), crash = run("run crash.yaml --quiet");
  unsetenv("VIBROSPICE_BEGUN_ANEW");
  EXPECT(good.status == 0 && !*good.err, "%d %s", good.status, good.err);
  EXPECT(crash.status == 2 && strstr(crash.err, says_of_crash()), "%d %s", crash.status, crash.err);
  free_ran(&good);
  free_ran(&crash);
}

/* Warnings are told once, by the process that the other one follows. */
static void warnings_are_told_once(void) {
  write_scene("warned", "Badded added 0 V=if(time>1,pwl(time),1)");
  ran a = run("run warned.yaml"), b = run("steady warned.yaml --set firing.every=1");
  EXPECT(a.status == 2 && count_lines(a.err) == 3 && strstr(a.err, "warning: "), "%s", a.err);
  EXPECT(b.status == 2 && !strcmp(a.err, b.err), "%s", b.err);
  free_ran(&a);
  free_ran(&b);
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
      {"a crash for want of stack", for_want_of_stack},
      {"a scene from a pipe is tried first", a_pipe_is_tried_first},
      {"the word is not inherited", the_word_is_not_inherited},
      {"warnings are told once", warnings_are_told_once},
      {"the numbers are those of a trial", the_numbers_are_those_of_a_trial},
  };
  return program_suite("guard", TESTS, COUNT(TESTS));
}
