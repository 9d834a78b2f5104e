/* SPDX-License-Identifier: GPL-3.0-or-later
 * Scenes drawn at random from all that ships (random_scene.h). None may hang, and none may fail but
 * by a cause that the scene has. Of every tenth the told errors of the margins are held against a
 * run at a hundredth of the tolerance, and its exported deck is given to plain ngspice.
 *
 * A few here, 10,000 with tools/test --long, which writes robustness.csv and margins.csv (committed
 * in tests/long). Each scene is run by a process of its own, VS_JOBS at a time. A test that was
 * stopped goes on with the rows that it has in robustness.part.csv. VS_LONG=N takes N scenes,
 * VS_FROM=N begins at scene N, VS_ONLY=N takes scene N alone and prints it. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "command/export.h"
#include "program.h"
#include "random_scene.h"

#ifdef __SANITIZE_ADDRESS__
enum { CASES = 500, SLOWER = 20 }; /* a sanitizer costs that much */
#else
enum { CASES = 10000, SLOWER = 1 };
#endif
/* A case that takes longer hangs, s of CPU. The run beside it is at a hundredth of the tolerance,
 * so it may take longer. */
enum { HANGS_S = 60 * SLOWER, TIGHT_S = 900 * SLOWER, PLAIN_S = 20 };
/* That many of the cases a few of which are tried, and how far apart. */
enum { FEW = 11, APART = 7 };

static const char ROWS[] = "robustness.part.csv", LINES[] = "margins.part.csv";
static const char HEADER[] =
    "case,tier,deck,thyristor,machine,also,tolerance,until_ms,status,rung,steps,cpu_s,gap_min_mm,"
    "i_peak_a,open_books,lines,outside,wrong,plain,cause\n";
static const char LINES_HEADER[] =
    "case,line,margin,margin_error,word,tight_margin,tight_at,inside\n";

/* ---- causes ---- */

/* The last step before a run failed. */
typedef struct witness {
  double travel_m, change_m; /* of the armature: where it is, and by how much it moved last */
  double pole_m, gap_m;      /* what is left of its way to the pole cover, and to the core */
} witness;

static vs_status look(void *ctx, const vs_step *step, vs_error *err) {
  witness *w = ctx;
  const vs_model *m = step->frame->model;
  double from = vs_mechanics_travel(m, step->from->x);
  (void)err;
  w->travel_m = vs_mechanics_travel(m, step->to->x);
  if (w->travel_m != from) w->change_m = w->travel_m - from; /* a contact has a step of no length */
  w->pole_m = m->actuator.gap_m + w->travel_m;
  w->gap_m = vs_coil_gap(&m->coil, w->travel_m);
  return VS_OK;
}

/* Why a run failed, in a word, where the scene itself has the cause: its armature is on its way to
 * the pole cover, and a few steps away from it, without a stop; or to the core through its stop; or
 * its coil's table ends. NULL: the failure is the program's. */
static const char *cause_of(const random_scene *s, const char *text) {
  witness w = {.pole_m = INFINITY, .gap_m = INFINITY};
  const vs_observer observer = {&w, look};
  const char *short_steps[] = {s->ideal ? "run.max_step=5us" : NULL, NULL};
  vs_trial_free(vs_trial_run("scene.yaml", NULL, short_steps, &observer));
  double reach = 4 * fabs(w.change_m);
  bool closes = w.change_m < 0;
  if (strstr(text, "meets the pole cover"))
    return closes && w.pole_m <= reach && !s->has_stop ? "pole contact" : NULL;
  if (strstr(text, "the stop has given way"))
    return closes && w.gap_m <= reach && s->has_stop ? "stop given way" : NULL;
  if (strstr(text, "the law") && strstr(text, "is left")) return s->has_table ? "table ends" : NULL;
  return NULL;
}

/* ---- one case, in a process of its own ---- */

typedef struct row {
  const random_scene *s;
  int status, rung;
  long steps;
  double cpu_s, gap_min_m, i_peak_a;
  bool open_books;
  int lines, outside, wrong;
  const char *plain, *cause;
} row;

/* In one write, as other processes write to the same file. */
static void append(const char *path, const char *text) {
  FILE *f = fopen(path, "a");
  if (!f || fputs(text, f) < 0 || fclose(f)) perror(path);
}

static void append_row(const char *folder, const row *r) {
  const random_scene *s = r->s;
  vs_text out = {0};
  char path[64], cause[64];
  snprintf(cause, sizeof cause, "%.60s", r->cause);
  for (char *c = cause; *c; c++)
    if (strchr(",\"\n", *c)) *c = ' ';
  vs_text_add(&out, "%d,%s,%s,%s,%s,%s,%.0e,%.3g,%d,%d,%ld,%.2f,%.3g,%.3g,%d,%d,%d,%d,%s,%s\n",
              s->number, s->tier, s->deck, s->part, s->machine, s->extra, s->tolerance,
              1e3 * s->until_s, r->status, r->rung, r->steps, r->cpu_s, 1e3 * r->gap_min_m,
              r->i_peak_a, r->open_books, r->lines, r->outside, r->wrong, r->plain, cause);
  snprintf(path, sizeof path, "%s%s", folder, ROWS);
  append(path, out.text);
  vs_text_free(&out);
}

static double cpu_s(void) {
  struct timespec own;
  struct rusage children;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &own);
  getrusage(RUSAGE_CHILDREN, &children);
  return (double)own.tv_sec + 1e-9 * (double)own.tv_nsec + (double)children.ru_utime.tv_sec +
         1e-6 * (double)children.ru_utime.tv_usec;
}

static void may_take(rlim_t seconds) {
  struct rlimit limit;
  getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_cur = (rlim_t)cpu_s() + seconds;
  setrlimit(RLIMIT_CPU, &limit);
}

/* The run that the bars are held against: at a hundredth of the tolerance, or at a tenth where
 * ngspice gives up there. */
static vs_trial *tight_run(const random_scene *s, char key[32]) {
  vs_trial *t = NULL;
  for (int finer = 100; finer >= 10 && (!t || t->status); finer /= 10) {
    if (t) vs_trial_free(t);
    snprintf(key, 32, "run.tolerance=%.0e", s->tolerance / finer);
    const char *sets[] = {key, "run.verify=never", NULL};
    t = vs_trial_run("scene.yaml", NULL, sets, NULL);
  }
  return t;
}

/* Every line of the verdict against the tight run's. A word is wrong if it is sure of another sign
 * than the tight run's. */
static void compare(row *r, const vs_verdict *v, const vs_verdict *tight, const char *tight_at) {
  vs_text out = {0};
  for (size_t k = 0; k < v->count && k < tight->count; k++) {
    const vs_judgement *j = &v->item[k], *t = &tight->item[k];
    char name[VS_JUDGED_NAME], other[VS_JUDGED_NAME];
    vs_verdict_name(j, name);
    if (strcmp(name, vs_verdict_name(t, other))) continue; /* only one of the runs has the line */
    vs_word word = vs_verdict_word(j);
    bool inside = j->margin == t->margin || fabs(j->margin - t->margin) <= j->margin_error;
    r->lines++;
    r->outside += !inside;
    r->wrong += (word == VS_HELD && t->margin < 0) || (word == VS_VIOLATED && t->margin > 0);
    vs_text_add(&out, "%d,%s,%.7g,%.2g,%s,%.7g,%s,%d\n", r->s->number, name, j->margin,
                j->margin_error, vs_verdict_words[word], t->margin, tight_at, inside);
  }
  if (out.length) {
    char path[64];
    snprintf(path, sizeof path, "../%s", LINES);
    append(path, out.text);
  }
  vs_text_free(&out);
}

/* What plain ngspice makes of the exported deck. */
static const char *plain_run(void) {
  vs_error err = {0};
  char command[96];
  if (vs_export_command("scene.yaml", NULL, 0, "x.cir", &err)) return "refused";
  snprintf(command, sizeof command, "ulimit -t %d; ngspice -b x.cir >x.log 2>&1", PLAIN_S);
  int how = system(command);
  if (WIFEXITED(how) && WEXITSTATUS(how) == 0) return "done";
  bool late = WIFSIGNALED(how) || (WIFEXITED(how) && WEXITSTATUS(how) > 128);
  return late ? "killed" : "failed";
}

static void judge(row *r, const vs_trial *t) {
  char key[32];
  may_take(TIGHT_S);
  r->plain = plain_run();
  if (t->status) return;
  vs_trial *tight = tight_run(r->s, key);
  if (!tight->status)
    compare(r, &t->result.verdict, &tight->result.verdict, key + strlen("run.tolerance="));
  vs_trial_free(tight);
}

static void run_scene(const random_scene *s) {
  row r = {.s = s, .plain = "", .cause = ""};
  char unknown[sizeof((vs_error *)0)->text];
  may_take(HANGS_S);
  vs_trial *t = vs_trial_run("scene.yaml", NULL, NULL, NULL);
  r.cpu_s = cpu_s();
  r.status = (int)t->status;
  r.rung = t->result.ladder.rung;
  r.steps = t->result.steps;
  r.gap_min_m = t->status ? NAN : t->result.values[VS_M_GAP_MIN].value;
  r.i_peak_a = t->status ? NAN : t->result.values[VS_M_I_PEAK].value;
  r.open_books = t->result.books[0] != '\0';
  if (t->status) {
    snprintf(unknown, sizeof unknown, "? %.1000s", t->err.text);
    r.cause = cause_of(s, t->err.text);
    if (!r.cause) r.cause = unknown;
  } else if (r.rung) {
    r.cause = "ngspice gave up at first";
  }
  if (s->judged) judge(&r, t);
  vs_trial_free(t);
  append_row("../", &r);
}

static pid_t begin_case(int number) {
  char folder[32];
  fflush(NULL);
  pid_t child = fork();
  if (child) return child;
  random_scene s = random_scene_at(number);
  snprintf(folder, sizeof folder, "case_%d", number);
  if ((mkdir(folder, 0777) && errno != EEXIST) || chdir(folder)) _exit(1);
  if (!freopen("said.txt", "w", stdout) || !freopen("warned.txt", "w", stderr)) _exit(1);
  FILE *f = fopen("scene.yaml", "w");
  if (!f || fputs(s.text.text, f) < 0 || fclose(f)) _exit(1);
  run_scene(&s);
  fflush(NULL);
  _exit(0);
}

/* The process of a case has ended. One that did not come to its own end has no row yet. */
static void end_case(int number, int how) {
  char folder[32], cause[64];
  snprintf(folder, sizeof folder, "case_%d", number);
  remove_tree(folder);
  if (how == 0) return;
  random_scene s = random_scene_at(number);
  bool hangs = WIFSIGNALED(how) && WTERMSIG(how) == SIGXCPU;
  snprintf(cause, sizeof cause, hangs ? "? hangs" : "? ends with %x", (unsigned)how);
  append_row("", &(row){.s = &s, .status = 1, .plain = "", .cause = cause});
  random_scene_free(&s);
}

/* ---- all of them ---- */

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
  end_case(j->number[n], how);
  j->count--;
  j->pid[n] = j->pid[j->count];
  j->number[n] = j->number[j->count];
}

static void start_case(jobs *j, int number) {
  if (j->count == j->most) wait_for_one(j);
  j->pid[j->count] = begin_case(number);
  CU_ASSERT_FATAL(j->pid[j->count] > 0);
  j->number[j->count++] = number;
}

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
  int cases, failed, left_model, climbed, open_books, judged, whole, wrong, plain, plain_failed;
  double cpu_s, longest_s;
} tally;

enum { COLUMNS = 20 };

/* Counts a row; says it where the case failed without a cause of its own. */
static void count_row(const char *line, tally *sum) {
  char *copy = vs_copy(line), *rest = copy, *cell[COLUMNS];
  for (int k = 0; k < COLUMNS; k++) cell[k] = rest ? strsep(&rest, ",") : (char *)(size_t) "";
  bool unknown = cell[19][0] == '?', judged = atoi(cell[15]) > 0;
  sum->cases++;
  sum->failed += unknown;
  sum->left_model += atoi(cell[8]) != 0 && !unknown;
  sum->climbed += atoi(cell[9]) > 0;
  sum->open_books += atoi(cell[14]) > 0;
  sum->judged += judged;
  sum->whole += judged && !atoi(cell[16]);
  sum->wrong += atoi(cell[17]);
  sum->plain +=
      !strcmp(cell[18], "done") || !strcmp(cell[18], "failed") || !strcmp(cell[18], "killed");
  sum->plain_failed += !strcmp(cell[18], "failed") || !strcmp(cell[18], "killed");
  sum->cpu_s += atof(cell[11]);
  sum->longest_s = fmax(sum->longest_s, atof(cell[11]));
  EXPECT(!unknown, "scene %s: %s", cell[0], cell[19]);
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

static void a_few(void) {
  jobs j = {.most = 1};
  if (getenv("VS_LONG") || getenv("VS_ONLY")) return;
  remove(ROWS);
  remove(LINES);
  for (int k = 0; k < FEW; k++) start_case(&j, APART * k);
  while (j.count) wait_for_one(&j);
  tally sum = count_rows(ROWS);
  CU_ASSERT_EQUAL(sum.cases, FEW);
  CU_ASSERT_EQUAL(sum.whole, sum.judged);
  CU_ASSERT_EQUAL(sum.wrong, 0);
}

static void all_of_them(void) {
  if (!getenv("VS_LONG") || getenv("VS_ONLY")) return;
  int most = number_of("VS_LONG", 1) > 1 ? number_of("VS_LONG", 1) : CASES;
  jobs j = {.most = (int)fmin(fmax(number_of("VS_JOBS", 1), 1), MOST_JOBS)};
  bool *done = vs_alloc((size_t)most, sizeof *done);
  char *text, **lines;
  size_t n = read_lines(ROWS, &text, &lines);
  for (size_t k = 0; k < n; k++)
    if (atoi(lines[k]) < most) done[atoi(lines[k])] = true;
  for (int number = number_of("VS_FROM", 0); number < most; number++)
    if (!done[number]) start_case(&j, number);
  while (j.count) wait_for_one(&j);
  free(lines);
  free(text);
  free(done);
  finish_table(ROWS, "robustness.csv", HEADER);
  finish_table(LINES, "margins.csv", LINES_HEADER);
  tally sum = count_rows("robustness.csv");
  CU_ASSERT(sum.whole >= 0.99 * sum.judged);
  CU_ASSERT_EQUAL(sum.wrong, 0);
}

static void one_alone(void) {
  if (!getenv("VS_ONLY")) return;
  random_scene s = random_scene_at(number_of("VS_ONLY", 0));
  jobs j = {.most = 1};
  printf("\n%s", s.text.text);
  start_case(&j, s.number);
  wait_for_one(&j);
  char *rows = read_file(ROWS);
  printf("%s%s", HEADER, rows);
  free(rows);
  random_scene_free(&s);
}

static const vs_test TESTS[] = {
    {"a few scenes", a_few},
    {"all scenes (long)", all_of_them},
    {"one scene (VS_ONLY)", one_alone},
};
VS_SUITE_MAIN("robustness", TESTS)
