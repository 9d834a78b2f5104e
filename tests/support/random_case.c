/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "random_case.h"

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

#include "cli/export.h"
#include "random_scene.h"
#include "suite.h"

#ifdef __SANITIZE_ADDRESS__
enum { SLOWER = 20 }; /* a sanitizer costs that much */
#else
enum { SLOWER = 1 };
#endif
/* A run that takes longer hangs, s of CPU; plain ngspice has the same. The run that the bars are
 * held against is at a hundredth of the tolerance, so it may take longer. */
enum { HANGS_S = 60 * SLOWER, PLAIN_S = 60, TIGHT_S = 900 * SLOWER };

const char random_case_head[] =
    "case,tier,deck,thyristor,machine,also,tolerance,until_ms,status,rung,steps,cpu_s,gap_min_mm,"
    "i_peak_a,open_books,lines,outside,wrong,plain,cause\n";
const char random_case_lines_head[] =
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
  const char *tight_at, *plain, *cause;
  vs_text told; /* rows of the table of lines; owned */
} row;

/* In one write, as other processes write to the same file. */
static void append(const char *path, const char *text) {
  FILE *f = fopen(path, "a");
  if (!f || fputs(text, f) < 0 || fclose(f)) perror(path);
}

/* Into the tables of the working folder. */
static void append_row(row *r) {
  const random_scene *s = r->s;
  vs_text out = {0};
  char cause[64];
  snprintf(cause, sizeof cause, "%.60s", r->cause);
  for (char *c = cause; *c; c++)
    if (strchr(",\"\n", *c)) *c = ' ';
  vs_text_add(&out, "%d,%s,%s,%s,%s,%s,%.0e,%.3g,%d,%d,%ld,%.2f,%.3g,%.3g,%d,%d,%d,%d,%s,%s\n",
              s->number, s->tier, s->deck, s->part, s->machine, s->extra, s->tolerance,
              1e3 * s->until_s, r->status, r->rung, r->steps, r->cpu_s, 1e3 * r->gap_min_m,
              r->i_peak_a, r->open_books, r->lines, r->outside, r->wrong, r->plain, cause);
  append(RANDOM_CASE_ROWS, out.text);
  if (r->told.length) append(RANDOM_CASE_LINES, r->told.text);
  vs_text_free(&out);
  vs_text_free(&r->told);
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

/* A line of the run's verdict against the tight run's. A word is wrong if it is sure of another
 * sign than the tight run's. */
static void compare_line(row *r, const vs_judgement *j, const vs_judgement *t) {
  char name[VS_JUDGED_NAME];
  vs_finding word = vs_verdict_word(j);
  bool inside = j->margin == t->margin || fabs(j->margin - t->margin) <= j->margin_error;
  r->lines++;
  r->outside += !inside;
  r->wrong += (word == VS_HELD && t->margin < 0) || (word == VS_VIOLATED && t->margin > 0);
  vs_text_add(&r->told, "%d,%s,%.7g,%.2g,%s,%.7g,%s,%d\n", r->s->number, vs_verdict_name(j, name),
              j->margin, j->margin_error, vs_verdict_words[word], t->margin, r->tight_at, inside);
}

/* All lines that both runs have. */
static void compare(row *r, const vs_verdict *v, const vs_verdict *tight) {
  char name[VS_JUDGED_NAME];
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *t = judged_line(tight, vs_verdict_name(&v->item[k], name));
    if (t) compare_line(r, &v->item[k], t);
  }
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
  r->tight_at = key + strlen("run.tolerance=");
  if (!tight->status) compare(r, &t->result.verdict, &tight->result.verdict);
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
  if (chdir("..")) _exit(1);
  append_row(&r);
}

pid_t random_case_begin(int number) {
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

void random_case_end(int number, int how) {
  char folder[32], cause[64];
  snprintf(folder, sizeof folder, "case_%d", number);
  remove_tree(folder);
  if (how == 0) return;
  random_scene s = random_scene_at(number);
  bool hangs = WIFSIGNALED(how) && WTERMSIG(how) == SIGXCPU;
  snprintf(cause, sizeof cause, hangs ? "? hangs" : "? ends with %x", (unsigned)how);
  append_row(&(row){.s = &s, .status = 1, .plain = "", .cause = cause});
  random_scene_free(&s);
}
