/* SPDX-License-Identifier: GPL-3.0-or-later
 * The README's examples, taken from it and run. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "program.h"

static char *readme;

/* Copy of the first fenced block of that kind behind a heading. */
static char *block(const char *heading, const char *kind) {
  char fence[32];
  snprintf(fence, sizeof fence, "\n```%s\n", kind);
  const char *section = strstr(readme, heading), *begin = section ? strstr(section, fence) : NULL;
  CU_ASSERT_PTR_NOT_NULL_FATAL(begin);
  begin += strlen(fence);
  const char *end = strstr(begin, "\n```");
  CU_ASSERT_PTR_NOT_NULL_FATAL(end);
  char *text = vs_copy(begin);
  text[end - begin + 1] = '\0';
  return text;
}

static bool gnuplot_is_here(void) {
  return system("command -v gnuplot >/dev/null 2>&1") == 0;
}

/* Runs the block's lines that call the program, up to a comment or a redirection; each must end
 * well. */
static void run_lines(char *lines) {
  int count = 0;
  for (char *line; (line = strsep(&lines, "\n"));) {
    if (strncmp(line, "vibrospice ", 11)) continue;
    line[strcspn(line, "#>")] = '\0';
    count++;
    if (strstr(line, " plot ") && !gnuplot_is_here()) continue;
    ran r = run("%s", line + 11);
    expect_good(&r, line, __LINE__); /* some go over an older run, and say so */
    free_ran(&r);
  }
  CU_ASSERT(count >= 3);
}

static void write_a_scene(void) {
  char *scene = block("## Write a scene", "yaml"), *lines = block("## Write a scene", "sh");
  write_file("my.yaml", scene);
  write_file("measured.csv", "t_ms,p_mm,i_ma\n0,0,0\n9.5,-0.4,950\n14,-1.5,0\n");
  run_lines(lines);
  free(scene);
  free(lines);
}

static void bring_your_own_machine(void) {
  char *lines = block("## Bring your own machine", "sh");
  run_lines(lines);
  free(lines);
}

static void bring_your_own_circuit(void) {
  char *deck = block("## Bring your own circuit", "spice"),
       *lines = block("## Bring your own circuit", "sh");
  write_file("freewheel.cir", deck);
  run_lines(lines);
  char *json = read_file("freewheel/summary.json");
  EXPECT(strstr(json, "\"audit\": \"the books close\"") && strstr(json, "\"diode\"") &&
             strstr(json, "\"violated\": false"),
         "summary.json: %s", json);
  free(json);
  free(deck);
  free(lines);
}

/* The study is checked; running it takes a minute, and tests/test_study.c runs others. */
static void studies(void) {
  char *study = block("## Studies", "yaml");
  write_file("snubbers.yaml", study);
  ran r = run("check snubbers.yaml");
  EXPECT(r.status == 0 && strstr(r.out, "grid, 108 cases of 3 axes, 4 columns"), "%s%s", r.out,
         r.err);
  free_ran(&r);
  free(study);
}

static const vs_test TESTS[] = {
    {"write a scene", write_a_scene},
    {"bring your own machine", bring_your_own_machine},
    {"bring your own circuit", bring_your_own_circuit},
    {"studies", studies},
};

int main(void) {
  readme = read_file(VS_TEST_FOLDER "/../README.md");
  int failed = program_suite("README", TESTS, COUNT(TESTS));
  free(readme);
  return failed;
}
