/* SPDX-License-Identifier: GPL-3.0-or-later
 * The README's examples, taken from it and run. */
#include <math.h>
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
 * with status 0, or 3 where its comment says so. A line that says which device takes how much is
 * held to that: the verdict's weakest line has the number. The line of `steady` without one takes
 * as long, and is run with VS_LONG. */
static void run_lines(char *lines) {
  int count = 0;
  for (char *line; (line = strsep(&lines, "\n"));) {
    if (strncmp(line, "vibrospice ", 11)) continue;
    char *comment = strchr(line, '#'), *takes = comment ? strstr(comment, " takes ") : NULL;
    const int status = comment && strstr(comment, "exit status 3") ? 3 : 0;
    line[strcspn(line, "#>")] = '\0';
    count++;
    if (strstr(line, " plot ") && !gnuplot_is_here()) continue;
    if (strstr(line, " steady ") && !takes && !getenv("VS_LONG")) continue;
    ran r = run("%s", line + 11);
    EXPECT(r.status == status, "%s: status %d: %s", line, r.status, r.err);
    char device[64] = "", weakest[64] = "";
    double said = NAN, told = NAN;
    if (takes) {
      while (takes[-1] != ' ') takes--;
      const char *at = strstr(r.out, "\nweakest: ");
      EXPECT(sscanf(takes, "%63s takes %lf", device, &said) == 2 && at &&
                 sscanf(at, "\nweakest: %63[^,], %lf", weakest, &told) == 2 &&
                 !strncmp(device, weakest, strlen(device)),
             "%s: %s", takes, r.out);
      CLOSE(told, said, 5e-3); /* three digits are said */
    }
    free_ran(&r);
  }
  CU_ASSERT(count >= 3);
}

static void try_section(const char *heading, const char *file) {
  char *lines = block(heading, "sh");
  if (file) {
    char *text = block(heading, "yaml");
    write_file(file, text);
    free(text);
  }
  run_lines(lines);
  free(lines);
}

static void write_a_scene(void) {
  try_section("## Write a scene", "my.yaml");
}

/* The study is checked; running it takes a minute, and tests/study/test_study.c runs others. */
static void ask_many_at_once(void) {
  char *study = block("## Ask many at once", "yaml");
  write_file("snubbers.yaml", study);
  ran r = run("check snubbers.yaml");
  EXPECT(r.status == 0 && strstr(r.out, "grid, 450 cases of 2 axes, 3 columns"), "%s%s", r.out,
         r.err);
  free_ran(&r);
  free(study);
}

/* A newcomer reads it in one go. */
static void in_one_go(void) {
  int lines = 0, words = 0;
  for (const char *at = readme; (at = strchr(at, '\n')); at++) lines++;
  for (const char *at = readme; *(at += strspn(at, " \n")); at += strcspn(at, " \n")) words++;
  EXPECT(lines <= 90 && words <= 900, "README.md has %d lines, %d words", lines, words);
}

static const vs_test TESTS[] = {
    {"write a scene", write_a_scene},
    {"ask many at once", ask_many_at_once},
    {"in one go", in_one_go},
};

int main(void) {
  readme = read_file(VS_TEST_FOLDER "/../README.md");
  int failed = program_suite("README", TESTS, COUNT(TESTS));
  free(readme);
  return failed;
}
