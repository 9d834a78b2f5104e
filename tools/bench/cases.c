/* SPDX-License-Identifier: GPL-3.0-or-later
 * What tools/bench/study measures with.
 *
 *   bench_cases STUDY       all cases of a study in this process, one after the other, without
 *                           workers, journal and files; prints cases, s, s of processor time
 *   bench_cases COMMAND...  a program with its children: s, s of processor time, largest process in
 *                           MB. Its exit status may be 3 (a rating is violated). */
#include <gsl/gsl_errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/budget.h"
#include "study/methods.h"
#include "study/study_file.h"
#include "study/workers/case.h"

static double processor_s(int who) {
  struct rusage u;
  getrusage(who, &u);
  return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static int run_child(char **argv) {
  double began_s = vs_budget_clock_s();
  pid_t child = fork();
  int how;
  if (child == 0) {
    execvp(argv[0], argv);
    _exit(127);
  }
  waitpid(child, &how, 0);
  struct rusage u;
  getrusage(RUSAGE_CHILDREN, &u);
  printf("%.6f %.6f %.1f\n", vs_budget_clock_s() - began_s, processor_s(RUSAGE_CHILDREN),
         (double)u.ru_maxrss / 1024);
  return how && WEXITSTATUS(how) != 3;
}

int main(int argc, char **argv) {
  vs_error err = {0};
  vs_plan *plan = vs_alloc(1, sizeof *plan);
  gsl_set_error_handler_off();
  if (argc > 2) return run_child(argv + 1);
  if (argc != 2 || vs_study_file_read(argv[1], vs_methods_all, NULL, 0, plan, &err)) {
    fprintf(stderr, "bench_cases: %s\n", argc == 2 ? err.text : "wants a study or a command");
    return 1;
  }
  vs_case *c = vs_case_new(plan, NULL);
  vs_text row = {0};
  double point[VS_PLAN_AXES], began_s = vs_budget_clock_s(), spent_s = processor_s(RUSAGE_SELF);
  for (uint64_t k = 0; k < plan->count; k++) {
    bool circuit;
    row.length = 0;
    vs_plan_point(plan, k, point);
    if (vs_case_run(c, k, point, &row, &circuit) == VS_CASE_FAILED) puts(row.text);
  }
  spent_s = processor_s(RUSAGE_SELF) + processor_s(RUSAGE_CHILDREN) - spent_s;
  printf("%llu %.6f %.6f\n", (unsigned long long)plan->count, vs_budget_clock_s() - began_s,
         spent_s);
  vs_text_free(&row);
  vs_case_free(c);
  vs_plan_free(plan);
  free(plan);
  return 0;
}
