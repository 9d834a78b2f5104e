/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law of the user's own: the process that it runs in, by itself and as part of a run. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/leave.h"
#include "control/remote.h"
#include "program.h"

/* ---- the process by itself ---- */

static double wall_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Nothing that this process has started is left, not even a zombie. */
static void expect_alone(int line) {
  errno = 0;
  pid_t left = waitpid(-1, NULL, WNOHANG);
  expect(left < 0 && errno == ECHILD, line, "a child is left: %d", (int)left);
}

/* What the copy does with each byte that it is asked. */
static void answer_bytes(void *ctx, int in, int out) {
  const int *first = ctx;
  int number = *first;
  for (char c; read(in, &c, 1) == 1;) {
    const struct timespec long_s = {30, 0};
    if (c == 'n' && write(out, &number, sizeof number) != sizeof number) return;
    if (c == 'p') printf("not an answer\n"), fflush(stdout);
    if (c == 's') nanosleep(&long_s, NULL);
    if (c == 'c') raise(SIGSEGV);
    if (c == 'e') _exit(7);
    if (c == 'u' && write(out, "unasked", 7) != 7) return;
    number++;
  }
}

static vs_status ask_number(vs_remote *r, const char *question, int *number, vs_error *err) {
  vs_status status = vs_remote_ask(r, 0.5, question, strlen(question), err);
  if (!status) status = vs_remote_answer(r, sizeof *number, err);
  if (!status) memcpy(number, r->in, sizeof *number);
  return status;
}

static void a_copy_answers(void) {
  vs_remote r = {.name = "copy", .timeout_s = 20};
  vs_error err = {0};
  int first = 5, number = 0;
  CU_ASSERT(!vs_remote_fork(&r, answer_bytes, &first, &err));
  for (int k = 0; k < 100 && !err.text[0]; k++) {
    ask_number(&r, "n", &number, &err);
    EXPECT(number == 5 + k, "%d instead of %d", number, 5 + k);
  }
  EXPECT(!err.text[0], "%s", err.text);
  vs_remote_end(&r);
  vs_remote_end(&r); /* which does nothing */
  expect_alone(__LINE__);
}

/* Each way to give no answer has its line, and leaves nothing behind. */
static void a_copy_fails(void) {
  static const struct {
    const char *ask, *says;
  } WAYS[] = {{"c", "t = 0.5 s: control: copy ended by signal 11 (Segmentation fault)"},
              {"e", "t = 0.5 s: control: copy ended with status 7, without an answer"},
              {"s", "t = 0.5 s: control: copy gave no answer within control.timeout, 0.2 s"}};
  for (size_t k = 0; k < COUNT(WAYS); k++) {
    vs_remote r = {.name = "copy", .timeout_s = k == 2 ? 0.2 : 20};
    vs_error err = {0};
    int first = 0, number;
    double began_s = wall_s();
    CU_ASSERT(!vs_remote_fork(&r, answer_bytes, &first, &err));
    EXPECT(ask_number(&r, WAYS[k].ask, &number, &err) == VS_RUN, "%s: no error", WAYS[k].ask);
    EXPECT(!strcmp(err.text, WAYS[k].says), "%s", err.text);
    EXPECT(wall_s() - began_s < 10, "%s: took %g s", WAYS[k].ask, wall_s() - began_s);
    EXPECT(ask_number(&r, "n", &number, &err) == VS_RUN, "%s: it lives on", WAYS[k].ask);
    vs_remote_end(&r);
    expect_alone(__LINE__);
  }
}

/* An answer to no question could be taken for one to the next. */
static void unasked(void) {
  vs_remote r = {.name = "copy", .timeout_s = 20};
  vs_error err = {0};
  int first = 0, number;
  CU_ASSERT(!vs_remote_fork(&r, answer_bytes, &first, &err));
  ask_number(&r, "nu", &number, &err);
  usleep(300000); /* until it has said the rest */
  EXPECT(ask_number(&r, "n", &number, &err) == VS_RUN, "it was taken");
  EXPECT(!strcmp(err.text, "t = 0.5 s: control: copy said something unasked; wanted: one answer "
                           "for each question"),
         "%s", err.text);
  vs_remote_end(&r);
  expect_alone(__LINE__);
}

static vs_status ask_line(vs_remote *r, const char *question, vs_error *err) {
  vs_status status = vs_remote_ask(r, 0.5, question, strlen(question), err);
  return status ? status : vs_remote_answer(r, 0, err);
}

static void a_program_answers(void) {
  vs_remote r = {.name = "cat", .timeout_s = 20};
  vs_error err = {0};
  char *words[] = {"cat", NULL};
  CU_ASSERT(!vs_remote_exec(&r, words, "/", (vs_where){0}, &err));
  for (int k = 0; k < 3; k++) {
    ask_line(&r, "what is this?\n", &err);
    EXPECT(!strcmp(r.in, "what is this?"), "%s; %s", r.in, err.text);
  }
  EXPECT(ask_line(&r, "one\ntwo\n", &err) == VS_RUN, "two lines were taken");
  EXPECT(strstr(err.text, "more than one line") != NULL, "%s", err.text);
  vs_remote_end(&r);
  expect_alone(__LINE__);
}

/* What becomes of a program that is asked once. */
static void expect_line(char *const *words, double timeout_s, const char *says, int line) {
  vs_remote r = {.name = "it", .timeout_s = timeout_s};
  vs_error err = {0};
  double began_s = wall_s();
  vs_status status = vs_remote_exec(&r, words, "", (vs_where){.file = "s.yaml"}, &err);
  if (!status) {
    usleep(100000);
    status = ask_line(&r, "?\n", &err);
  }
  expect(status && strstr(err.text, says), line, "'%s' instead of '%s'", err.text, says);
  expect(wall_s() - began_s < 10, line, "took %g s", wall_s() - began_s);
  vs_remote_end(&r);
  expect_alone(line);
}

static void a_program_fails(void) {
  expect_line((char *[]){"no/such/program", NULL}, 20,
              "s.yaml: control: the program no/such/program cannot be started: No such file",
              __LINE__);
  expect_line((char *[]){"true", NULL}, 20, "it ended with status 0, without an answer", __LINE__);
  expect_line((char *[]){"sh", "-c", "kill -9 $$", NULL}, 20, "ended by signal 9 (Killed)",
              __LINE__);
  expect_line((char *[]){"sleep", "30", NULL}, 0.2, "no answer within control.timeout, 0.2 s",
              __LINE__);
  expect_line((char *[]){"yes", NULL}, 20, "said something unasked", __LINE__);
  expect_line((char *[]){"sh", "-c", "exec 1>&-; sleep 30", NULL}, 20, "closed its pipe", __LINE__);
  expect_line((char *[]){"sh", "-c", "read x; head -c 9999 /dev/zero", NULL}, 20,
              "longer than 4096 bytes", __LINE__);
}

/* Is the process gone? One that has ended is, also where nobody has waited for it yet. */
static bool is_gone(pid_t process) {
  char path[64], state = 'Z';
  snprintf(path, sizeof path, "/proc/%d/stat", (int)process);
  FILE *f = fopen(path, "r");
  if (f && fscanf(f, "%*d (%*[^)]) %c", &state) != 1) state = '?';
  if (f) fclose(f);
  return state == 'Z' || state == 'X';
}

/* A program that heeds nothing, with one more that it has started, is ended with it. */
static void a_program_is_ended(void) {
  vs_remote r = {.name = "it", .timeout_s = 20};
  vs_error err = {0};
  char *words[] = {"sh", "-c", "trap '' TERM; sleep 77 & echo $!; sleep 77", NULL};
  CU_ASSERT(!vs_remote_exec(&r, words, "", (vs_where){0}, &err));
  CU_ASSERT(!vs_remote_answer(&r, 0, &err));
  pid_t other = (pid_t)atol(r.in), own = r.pid;
  EXPECT(other > 0 && !is_gone(other), "it is not there: %s", r.in);
  vs_remote_end(&r);
  EXPECT(is_gone(own), "it is still there");
  for (int k = 0; k < 100 && !is_gone(other); k++) usleep(10000);
  EXPECT(is_gone(other), "what it has started is still there");
  expect_alone(__LINE__);
}

/* A signal that asks this process to end is heeded while it waits. */
static void a_signal_is_heeded(void) {
  vs_remote r = {.name = "sleep", .timeout_s = 60};
  vs_error err = {0};
  char *words[] = {"sleep", "77", NULL};
  CU_ASSERT(!vs_remote_exec(&r, words, "", (vs_where){0}, &err));
  vs_leave_requested = 1;
  EXPECT(ask_line(&r, "?\n", &err) == VS_SIGNAL, "%s", err.text);
  vs_leave_requested = 0;
  expect_alone(__LINE__);
}

/* A copy of the owner neither asks its process nor ends it. */
static void a_copy_of_the_owner(void) {
  vs_remote r = {.name = "cat", .timeout_s = 20};
  vs_error err = {0};
  char *words[] = {"cat", NULL};
  int how = 0;
  CU_ASSERT(!vs_remote_exec(&r, words, "", (vs_where){0}, &err));
  fflush(NULL);
  pid_t copy = fork();
  if (!copy) {
    bool refused = ask_line(&r, "?\n", &err) == VS_RUN;
    vs_remote_end(&r);
    _exit(refused ? 0 : 1);
  }
  waitpid(copy, &how, 0);
  EXPECT(how == 0, "the copy asked");
  EXPECT(!ask_line(&r, "still there\n", &err) && !strcmp(r.in, "still there"), "%s", err.text);
  vs_remote_end(&r);
  expect_alone(__LINE__);
}

static const vs_test TESTS[] = {
    {"a copy answers", a_copy_answers},           {"a copy fails", a_copy_fails},
    {"an answer that nobody asked for", unasked}, {"a program answers", a_program_answers},
    {"a program fails", a_program_fails},         {"a program is ended", a_program_is_ended},
    {"a signal is heeded", a_signal_is_heeded},   {"a copy of the owner", a_copy_of_the_owner}};

int main(void) {
  return program_suite("own law", TESTS, COUNT(TESTS));
}
