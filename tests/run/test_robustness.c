/* SPDX-License-Identifier: GPL-3.0-or-later
 * Scenes drawn at random from all that ships (random_scene.h). None may hang, and none may fail but
 * by a cause that the scene has. Of every tenth the told errors of the margins are held against a
 * run at a hundredth of the tolerance, and its exported deck is given to plain ngspice.
 *
 * A few here, all of them with tools/test --long, which writes robustness.csv and margins.csv
 * (committed in tests/long). Each scene is run by a process of its own, VS_JOBS at a time. A test
 * that was stopped goes on with the rows that it has in robustness.part.csv. VS_LONG=N takes N
 * scenes, VS_FROM=N begins at scene N. VS_ONLY=N takes scene N alone, prints it and its rows, and
 * leaves no file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "program.h"
#include "random_case.h"
#include "random_scene.h"

/* Some of those to be judged end before, by a cause that the scene has. So that JUDGED are left,
 * there are a hundred scenes more than ten thousand. */
#ifdef __SANITIZE_ADDRESS__
enum { CASES = 500, JUDGED = 0 };
#else
enum { CASES = 10100, JUDGED = 1000 };
#endif
/* That many of the cases a few of which are tried, and how far apart. Two are to be judged. */
enum { FEW = 11, APART = 7, FEW_JUDGED = 2 };

/* ---- several at a time ---- */

enum { MOST_JOBS = 64 };
typedef struct jobs {
  pid_t pid[MOST_JOBS];
  int number[MOST_JOBS], count, most;
} jobs;

static void wait_for_one(jobs *j) {
  int how, n = 0;
  pid_t ended = wait(&how);
  while (n < j->count && j->pid[n] != ended) n++;
  if (n == j->count) return;
  random_case_end(j->number[n], how);
  j->count--;
  j->pid[n] = j->pid[j->count];
  j->number[n] = j->number[j->count];
}

static void start_case(jobs *j, int number) {
  if (j->count == j->most) wait_for_one(j);
  j->pid[j->count] = random_case_begin(number);
  CU_ASSERT_FATAL(j->pid[j->count] > 0);
  j->number[j->count++] = number;
}

/* ---- tables ---- */

/* Lines of a table, in the order of their cases; those of one case as they stand. */
static int by_case(const void *a, const void *b) {
  const char *x = *(char *const *)a, *y = *(char *const *)b;
  int first = atoi(x), second = atoi(y);
  return first != second ? (first > second) - (first < second) : (x > y) - (x < y);
}

static size_t read_lines(const char *path, char **text, char ***lines) {
  *text = access(path, R_OK) ? vs_copy("") : read_file(path);
  size_t most = (size_t)count_lines(*text) + 1, n = 0;
  *lines = vs_alloc(most, sizeof **lines);
  char *rest = *text;
  for (char *line; (line = strsep(&rest, "\n"));)
    if (*line) (*lines)[n++] = line;
  return n;
}

/* Writes a table in order under its own name, and removes the rows as they came. */
static void finish_table(const char *from, const char *to, const char *header) {
  char *text, **lines;
  size_t n = read_lines(from, &text, &lines);
  qsort(lines, n, sizeof *lines, by_case);
  FILE *f = fopen(to, "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  fputs(header, f);
  for (size_t k = 0; k < n; k++) fprintf(f, "%s\n", lines[k]);
  CU_ASSERT_EQUAL(fclose(f), 0);
  remove(from);
  free(lines);
  free(text);
}

typedef struct tally {
  int cases, failed, left_model, climbed, open_books, judged, compared, whole, wrong, plain,
      plain_failed;
  double cpu_s, longest_s;
} tally;

/* Counts a row; says it where the case failed without a cause of its own. Plain ngspice is counted
 * where the program has come to the end of the scene. */
static void count_row(const char *line, tally *sum) {
  char *copy = vs_copy(line), *rest = copy, *cell[RANDOM_CASE_COLUMNS], empty[] = "";
  for (int k = 0; k < RANDOM_CASE_COLUMNS; k++) cell[k] = rest ? strsep(&rest, ",") : empty;
  const char *cause = cell[RANDOM_CASE_CAUSE], *plain = cell[RANDOM_CASE_PLAIN];
  bool unknown = *cause == '?', judged = atoi(cell[RANDOM_CASE_COMPARED]) > 0;
  bool ended = !atoi(cell[RANDOM_CASE_STATUS]), tried = *plain && strcmp(plain, "refused") != 0;
  double cpu_s = atof(cell[RANDOM_CASE_CPU]);
  sum->cases++;
  sum->failed += unknown;
  sum->left_model += !ended && !unknown;
  sum->climbed += atoi(cell[RANDOM_CASE_RUNG]) > 0;
  sum->open_books += atoi(cell[RANDOM_CASE_BOOKS]) > 0;
  sum->judged += judged;
  sum->compared += atoi(cell[RANDOM_CASE_COMPARED]);
  sum->whole += judged && !atoi(cell[RANDOM_CASE_OUTSIDE]);
  sum->wrong += atoi(cell[RANDOM_CASE_WRONG]);
  sum->plain += ended && tried;
  sum->plain_failed += ended && tried && strcmp(plain, "done") != 0;
  sum->cpu_s += cpu_s;
  sum->longest_s = fmax(sum->longest_s, cpu_s);
  EXPECT(!unknown, "scene %s: %s", cell[0], cause);
  free(copy);
}

static tally count_rows(const char *path) {
  tally sum = {0};
  char *text, **lines;
  size_t n = read_lines(path, &text, &lines);
  for (size_t k = 0; k < n; k++)
    if (strncmp(lines[k], "case,", 5)) count_row(lines[k], &sum);
  free(lines);
  free(text);
  printf(" %d cases: %d failed, %d left the model, %d on a higher rung, %d with open books; %.3g s "
         "of CPU in the mean, %.3g s at most; judged %d: %d within their bars, %d wrong words; "
         "plain ngspice failed with %d of %d ",
         sum.cases, sum.failed, sum.left_model, sum.climbed, sum.open_books, sum.cpu_s / sum.cases,
         sum.longest_s, sum.judged, sum.whole, sum.wrong, sum.plain_failed, sum.plain);
  return sum;
}

static int number_of(const char *variable, int otherwise) {
  const char *word = getenv(variable);
  return word ? atoi(word) : otherwise;
}

/* ---- which ones ---- */

/* A few cases work in a folder of their own, as a long test may go on in this one. */
static void enter(void) {
  remove_tree("few");
  CU_ASSERT_FATAL(!mkdir("few", 0777) && !chdir("few"));
}
static void leave(void) {
  CU_ASSERT_FATAL(!chdir(".."));
  remove_tree("few");
}

static void a_few(void) {
  jobs j = {.most = 1};
  if (getenv("VS_LONG") || getenv("VS_ONLY")) return;
  enter();
  for (int k = 0; k < FEW; k++) start_case(&j, APART * k);
  while (j.count) wait_for_one(&j);
  tally sum = count_rows(RANDOM_CASE_ROWS);
  leave();
  CU_ASSERT_EQUAL(sum.cases, FEW);
  CU_ASSERT_EQUAL(sum.judged, FEW_JUDGED);
  CU_ASSERT_EQUAL(sum.whole, sum.judged);
  CU_ASSERT_EQUAL(sum.wrong, 0);
}

/* The run of this scene and the finer one do not have the same lines: the rise of a current is in
 * one verdict alone, as the fifth of some twenty lines. Those behind it are compared, too. */
static void not_the_same_lines(void) {
  enum { CASE = 2820, BEHIND = 10 };
  jobs j = {.most = 1};
  if (getenv("VS_LONG") || getenv("VS_ONLY")) return;
  enter();
  start_case(&j, CASE);
  wait_for_one(&j);
  tally sum = count_rows(RANDOM_CASE_ROWS);
  leave();
  EXPECT(sum.compared > BEHIND && sum.judged == 1, "%d lines", sum.compared);
}

static void all_of_them(void) {
  if (!getenv("VS_LONG") || getenv("VS_ONLY")) return;
  int most = number_of("VS_LONG", 1) > 1 ? number_of("VS_LONG", 1) : CASES;
  jobs j = {.most = (int)fmin(fmax(number_of("VS_JOBS", 1), 1), MOST_JOBS)};
  bool *done = vs_alloc((size_t)most, sizeof *done);
  char *text, **lines;
  size_t n = read_lines(RANDOM_CASE_ROWS, &text, &lines);
  for (size_t k = 0; k < n; k++)
    if (atoi(lines[k]) < most) done[atoi(lines[k])] = true;
  for (int number = number_of("VS_FROM", 0); number < most; number++)
    if (!done[number]) start_case(&j, number);
  while (j.count) wait_for_one(&j);
  free(lines);
  free(text);
  free(done);
  finish_table(RANDOM_CASE_ROWS, "robustness.csv", random_case_head);
  finish_table(RANDOM_CASE_LINES, "margins.csv", random_case_lines_head);
  tally sum = count_rows("robustness.csv");
  if (most == CASES && !getenv("VS_FROM")) CU_ASSERT(sum.judged >= JUDGED);
  CU_ASSERT(sum.whole >= 0.99 * sum.judged);
  CU_ASSERT_EQUAL(sum.wrong, 0);
}

static void print_table(const char *head, const char *path) {
  char *rows = read_file(path);
  printf("%s%s", head, rows);
  free(rows);
}

static void one_alone(void) {
  if (!getenv("VS_ONLY")) return;
  random_scene s = random_scene_at(number_of("VS_ONLY", 0));
  jobs j = {.most = 1};
  printf("\n%s", s.text.text);
  enter();
  start_case(&j, s.number);
  wait_for_one(&j);
  print_table(random_case_head, RANDOM_CASE_ROWS);
  if (s.judged) print_table(random_case_lines_head, RANDOM_CASE_LINES);
  leave();
  random_scene_free(&s);
}

static const vs_test TESTS[] = {
    {"a few scenes", a_few},
    {"not the same lines", not_the_same_lines},
    {"all scenes (long)", all_of_them},
    {"one scene (VS_ONLY)", one_alone},
};
VS_SUITE_MAIN("robustness", TESTS)
