/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law of the user's own: the process that it runs in, by itself and as part of a run. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/shutdown.h"
#include "control/child_process.h"
#include "engine/budget.h"
#include "program.h"

/* ---- the process by itself ---- */

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

static vs_status ask_number(vs_child_process *r, const char *question, int *number, vs_error *err) {
  vs_status status = vs_child_process_ask(r, 0.5, question, strlen(question), err);
  if (!status) status = vs_child_process_answer(r, sizeof *number, err);
  if (!status) memcpy(number, r->in, sizeof *number);
  return status;
}

static void a_copy_answers(void) {
  vs_child_process r = {.name = "copy", .timeout_s = 20};
  vs_error err = {0};
  int first = 5, number = 0;
  CU_ASSERT(!vs_child_process_fork(&r, answer_bytes, &first, &err));
  for (int k = 0; k < 100 && !err.text[0]; k++) {
    ask_number(&r, "n", &number, &err);
    EXPECT(number == 5 + k, "%d instead of %d", number, 5 + k);
  }
  EXPECT(!err.text[0], "%s", err.text);
  vs_child_process_end(&r);
  vs_child_process_end(&r); /* which does nothing */
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
    vs_child_process r = {.name = "copy", .timeout_s = k == 2 ? 0.2 : 20};
    vs_error err = {0};
    int first = 0, number;
    double began_s = vs_budget_clock_s();
    CU_ASSERT(!vs_child_process_fork(&r, answer_bytes, &first, &err));
    EXPECT(ask_number(&r, WAYS[k].ask, &number, &err) == VS_RUN, "%s: no error", WAYS[k].ask);
    EXPECT(!strcmp(err.text, WAYS[k].says), "%s", err.text);
    EXPECT(vs_budget_clock_s() - began_s < 10, "%s: took %g s", WAYS[k].ask,
           vs_budget_clock_s() - began_s);
    EXPECT(ask_number(&r, "n", &number, &err) == VS_RUN, "%s: it lives on", WAYS[k].ask);
    vs_child_process_end(&r);
    expect_alone(__LINE__);
  }
}

/* An answer to no question could be taken for one to the next. */
static void unasked(void) {
  vs_child_process r = {.name = "copy", .timeout_s = 20};
  vs_error err = {0};
  int first = 0, number;
  CU_ASSERT(!vs_child_process_fork(&r, answer_bytes, &first, &err));
  ask_number(&r, "nu", &number, &err);
  usleep(300000); /* until it has said the rest */
  EXPECT(ask_number(&r, "n", &number, &err) == VS_RUN, "it was taken");
  EXPECT(!strcmp(err.text,
                 "t = 0.5 s: control: copy answered before it was asked; wanted: one answer "
                 "for each question"),
         "%s", err.text);
  vs_child_process_end(&r);
  expect_alone(__LINE__);
}

static vs_status ask_line(vs_child_process *r, const char *question, vs_error *err) {
  vs_status status = vs_child_process_ask(r, 0.5, question, strlen(question), err);
  return status ? status : vs_child_process_answer(r, 0, err);
}

static void a_program_answers(void) {
  vs_child_process r = {.name = "cat", .timeout_s = 20};
  vs_error err = {0};
  char *words[] = {"cat", NULL};
  CU_ASSERT(!vs_child_process_exec(&r, words, "/", (vs_where){0}, &err));
  for (int k = 0; k < 3; k++) {
    ask_line(&r, "what is this?\n", &err);
    EXPECT(!strcmp(r.in, "what is this?"), "%s; %s", r.in, err.text);
  }
  EXPECT(ask_line(&r, "one\ntwo\n", &err) == VS_RUN, "two lines were taken");
  EXPECT(strstr(err.text, "more than one line") != NULL, "%s", err.text);
  vs_child_process_end(&r);
  expect_alone(__LINE__);
}

/* What becomes of a program that is asked once. */
static void expect_line(char *const *words, double timeout_s, const char *says, int line) {
  vs_child_process r = {.name = "it", .timeout_s = timeout_s};
  vs_error err = {0};
  double began_s = vs_budget_clock_s();
  vs_status status = vs_child_process_exec(&r, words, "", (vs_where){.file = "s.yaml"}, &err);
  if (!status) {
    usleep(100000);
    status = ask_line(&r, "?\n", &err);
  }
  expect(status && strstr(err.text, says), line, "'%s' instead of '%s'", err.text, says);
  expect(vs_budget_clock_s() - began_s < 10, line, "took %g s", vs_budget_clock_s() - began_s);
  vs_child_process_end(&r);
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
  expect_line((char *[]){"sh", "-c", "read x; sleep 77 & exit 5", NULL}, 0.5,
              "ended with status 5, without an answer", __LINE__);
  expect_line((char *[]){"yes", NULL}, 20, "answered before it was asked", __LINE__);
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
  vs_child_process r = {.name = "it", .timeout_s = 20};
  vs_error err = {0};
  char *words[] = {"sh", "-c", "trap '' TERM; sleep 77 & echo $!; sleep 77", NULL};
  CU_ASSERT(!vs_child_process_exec(&r, words, "", (vs_where){0}, &err));
  CU_ASSERT(!vs_child_process_answer(&r, 0, &err));
  pid_t other = (pid_t)atol(r.in), own = r.pid;
  EXPECT(other > 0 && !is_gone(other), "it is not there: %s", r.in);
  vs_child_process_end(&r);
  EXPECT(is_gone(own), "it is still there");
  for (int k = 0; k < 100 && !is_gone(other); k++) usleep(10000);
  EXPECT(is_gone(other), "what it has started is still there");
  expect_alone(__LINE__);
}

/* All of it is ended where this process dies without a word. */
static void a_program_outlives_nobody(void) {
  int ends[2];
  char *words[] = {"sh", "-c", "sleep 77 & echo $!; sleep 77", NULL};
  CU_ASSERT(!pipe(ends));
  fflush(NULL);
  pid_t owner = fork();
  if (!owner) {
    vs_child_process r = {.name = "it", .timeout_s = 20};
    vs_error err = {0};
    pid_t told[2] = {0, 0};
    if (!vs_child_process_exec(&r, words, "", (vs_where){0}, &err) &&
        !vs_child_process_answer(&r, 0, &err))
      told[0] = r.pid, told[1] = (pid_t)atol(r.in);
    if (write(ends[1], told, sizeof told) < 0) _exit(1);
    pause();
  }
  pid_t told[2] = {0, 0};
  CU_ASSERT(read(ends[0], told, sizeof told) == sizeof told);
  CU_ASSERT(told[0] > 0 && told[1] > 0);
  kill(owner, SIGKILL);
  waitpid(owner, NULL, 0);
  for (int k = 0; k < 500 && !(is_gone(told[0]) && is_gone(told[1])); k++) usleep(10000);
  EXPECT(is_gone(told[0]), "it is still there");
  EXPECT(is_gone(told[1]), "what it has started is still there");
  close(ends[0]);
  close(ends[1]);
}

/* A signal that asks this process to end is heeded while it waits. */
static void a_signal_is_heeded(void) {
  vs_child_process r = {.name = "sleep", .timeout_s = 60};
  vs_error err = {0};
  char *words[] = {"sleep", "77", NULL};
  CU_ASSERT(!vs_child_process_exec(&r, words, "", (vs_where){0}, &err));
  vs_shutdown_requested = 1;
  EXPECT(ask_line(&r, "?\n", &err) == VS_SIGNAL, "%s", err.text);
  vs_shutdown_requested = 0;
  expect_alone(__LINE__);
}

/* A copy of the owner neither asks its process nor ends it. */
static void a_copy_of_the_owner(void) {
  vs_child_process r = {.name = "cat", .timeout_s = 20};
  vs_error err = {0};
  char *words[] = {"cat", NULL};
  int how = 0;
  CU_ASSERT(!vs_child_process_exec(&r, words, "", (vs_where){0}, &err));
  fflush(NULL);
  pid_t copy = fork();
  if (!copy) {
    bool refused = ask_line(&r, "?\n", &err) == VS_RUN;
    vs_child_process_end(&r);
    _exit(refused ? 0 : 1);
  }
  waitpid(copy, &how, 0);
  EXPECT(how == 0, "the copy asked");
  EXPECT(!ask_line(&r, "still there\n", &err) && !strcmp(r.in, "still there"), "%s", err.text);
  vs_child_process_end(&r);
  expect_alone(__LINE__);
}

/* ---- laws in a run ---- */

/* A command is refused at that place, with that word. */
#define REFUSE(words, what, at, says)                                                              \
  refuse(words, what, at, (const char *const[]){says, NULL}, __LINE__)

#define TRIM_PY VS_TEST_FOLDER "/../spice/control/trim.py"

/* Writes a scene of 0.1 s, on whose second line the control stands. */
static void write_scene(const char *path, const char *control) {
  char text[VS_PATH_SIZE + 512];
  snprintf(text, sizeof text,
           "firing: {every: 1}\ncontrol: {%s}\ninstruments: {}\n"
           "run: {until: 0.1 s, tier: switched}\n",
           control);
  write_file(path, text);
}

static void write_object_scene(const char *path, const char *object, const char *more) {
  char control[VS_PATH_SIZE + 256];
  snprintf(control, sizeof control, "law: object, file: %s/%s.so%s", VS_LAWS, object, more);
  write_scene(path, control);
}

/* Compares two files byte by byte. */
static void expect_same(const char *one, const char *other, int line) {
  char *a = read_file(one), *b = read_file(other);
  expect(*a && !strcmp(a, b), line, "%s and %s differ", one, other);
  free(a);
  free(b);
}

/* The shipped law in C and in Python sees the same numbers and gives the same angles. */
static void both_languages(void) {
  write_object_scene("c.yaml", "trim", "");
  write_scene("p.yaml", "law: pipe, command: python3 " TRIM_PY);
  RUN_GOOD("run c.yaml --allow-code --quiet -o c --set run.until=1.5s");
  char *csv = read_file("c/run.csv"), *last = strrchr(csv, ',');
  EXPECT(last && fabs(atof(last + 1) * 180 / M_PI - 110.7) < 0.3, "it ends at %s", last);
  free(csv);
  if (!on_path("python3")) return;
  RUN_GOOD("run p.yaml --allow-code --quiet -o p --set run.until=1.5s");
  expect_same("c/run.csv", "p/run.csv", __LINE__);
  RUN_GOOD("run p.yaml --allow-code --quiet -o q --set run.until=1.5s");
  expect_same("p/run.csv", "q/run.csv", __LINE__); /* each run begins with a process of its own */
}

/* Within ngspice, too, and where the run begins on its orbit. */
static void other_tiers(void) {
  write_object_scene("c.yaml", "trim", "");
  RUN_GOOD("run c.yaml --allow-code --quiet -o circuit --tier circuit --set run.until=0.06s");
  char *csv = read_file("circuit/run.csv"), *last = strrchr(csv, ',');
  EXPECT(last && fabs(atof(last + 1) * 180 / M_PI - 146.1) < 0.5, "it ends at %s", last);
  free(csv);
  RUN_GOOD("run c.yaml --allow-code --quiet --set start=steady");
}

/* A command ends with that status and with that one line behind all others. */
static void expect_end(const char *words, int status, const char *says, int line) {
  ran r = run("%s", words);
  char *last = r.err + strlen(r.err);
  if (last > r.err) *--last = '\0';
  while (last > r.err && last[-1] != '\n') last--;
  expect(r.status == status, line, "%s: exit status %d: %s", words, r.status, r.err);
  expect(strstr(last, says) != NULL, line, "%s: '%s' instead of '%s'", words, last, says);
  expect(!*r.out, line, "%s: a failed run prints %s", words, r.out);
  free_ran(&r);
}

/* Objects that do what they should not. */
static void bad_objects(void) {
  static const struct {
    const char *law;
    int status;
    const char *says;
  } LAWS[] = {
      {"crash", 1, "t = 0.04 s: control: broken.so ended by signal 11 (Segmentation fault)"},
      {"exit", 1, "t = 0.04 s: control: broken.so ended with status 3, without an answer"},
      {"hang", 1, "t = 0.04 s: control: broken.so gave no answer within control.timeout, 0.2 s"},
      {"error", 1, "t = 0.04 s: control: broken.so says: the feeder is empty"},
      {"error of bytes", 1, "t = 0.04 s: control: broken.so says: the belt"},
      {"floods its pipe at load", 2, "control.file: "},
      {"beyond", 1,
       "t = 0.04 s: control: broken.so answered an angle of 180 deg; allowed: 0..180 deg"},
      {"crash at load", 1, "t = 0 s: control: broken.so ended by signal 11"},
      {"hang at load", 1, "t = 0 s: control: broken.so gave no answer within control.timeout"}};
  write_object_scene("s.yaml", "broken", ", timeout: 0.2 s");
  for (size_t k = 0; k < COUNT(LAWS); k++) {
    setenv("LAW", LAWS[k].law, 1);
    expect_end("run s.yaml --allow-code --quiet", LAWS[k].status, LAWS[k].says, __LINE__);
  }
  unsetenv("LAW");
}

static void copy(const char *from, const char *to) {
  char words[2 * VS_PATH_SIZE];
  snprintf(words, sizeof words, "cp %s %s", from, to);
  CU_ASSERT(!system(words));
}

/* A study's failures.csv has one row, of case 1, which says that this file has changed. */
static void expect_changed(const char *study, const char *file, int line) {
  char words[256], says[64];
  snprintf(words, sizeof words, "study %s --allow-code --quiet --jobs 1 -o %s.out", study, study);
  snprintf(says, sizeof says, "%s has changed since this study began", file);
  ran r = run("%s", words);
  expect(r.status == 1, line, "%s: exit status %d: %s", words, r.status, r.err);
  free_ran(&r);
  snprintf(words, sizeof words, "%s.out/failures.csv", study);
  char *failures = read_file(words), *row = strstr(failures, "\n1,");
  expect(row && strstr(row, says), line, "no '%s' in %s", says, failures);
  expect(count_lines(failures) == 2, line, "other rows: %s", failures);
  free(failures);
}

/* The law of case 0 changes a file that case 1 is made of: another law's object, another law's
 * script, another deck. */
static void changed_files(void) {
  static const char AXIS[] = "scene: s.yaml\nvary: {%s: [%s]}\nreport: [i_peak]\n";
  char text[256];
  copy(VS_LAWS "/broken.so", "one.so");
  copy(VS_LAWS "/broken.so", "two.so");
  write_scene("s.yaml", "law: object, file: one.so");
  snprintf(text, sizeof text, AXIS, "control.file", "one.so, two.so");
  write_file("objects.yaml", text);
  setenv("LAW_FILE", "two.so", 1);
  expect_changed("objects.yaml", "two.so", __LINE__);
  unsetenv("LAW_FILE");

  write_file("two.sh", "while read -r line; do echo '{\"angle_deg\": 95}'; done\n");
  write_file("one.sh", "echo '# other' >>two.sh\n"
                       "while read -r line; do echo '{\"angle_deg\": 95}'; done\n");
  write_scene("s.yaml", "law: pipe, command: sh one.sh");
  snprintf(text, sizeof text, AXIS, "control.command", "sh one.sh, sh two.sh");
  write_file("scripts.yaml", text);
  expect_changed("scripts.yaml", "two.sh", __LINE__);

  write_gated_deck();
  copy("gated.cir", "two.cir");
  write_file("one.sh", "echo '* other' >>two.cir\n"
                       "while read -r line; do echo '{\"angle_deg\": 95}'; done\n");
  write_file("s.yaml", "firing: {every: 1}\ncontrol: {law: pipe, command: sh one.sh}\n"
                       "instruments: {}\nrun: {until: 50 ms, tier: circuit}\n");
  snprintf(text, sizeof text, AXIS, "circuit.deck", "gated.cir, two.cir");
  write_file("decks.yaml", text);
  expect_changed("decks.yaml", "two.cir", __LINE__);
}

/* What a law prints gets into no file, not even where the standard streams are closed. */
static void closed_streams(void) {
  write_object_scene("s.yaml", "broken", "");
  setenv("LAW", "print", 1);
  int how = system(VS_PROGRAM " run s.yaml --allow-code -o closed <&- >&- 2>&-");
  unsetenv("LAW");
  EXPECT(WIFEXITED(how) && WEXITSTATUS(how) == 1, "%d", how); /* it cannot print its table */
  static const char *const FILES[] = {"run.csv", "events.csv", "summary.json"};
  for (size_t k = 0; k < COUNT(FILES); k++) {
    char path[64];
    snprintf(path, sizeof path, "closed/%s", FILES[k]);
    char *text = read_file(path);
    EXPECT(*text && !strstr(text, "not an answer"), "%s: %.99s", path, text);
    free(text);
  }
}

/* What cannot be a law is refused at its place in the scene. */
static void no_objects(void) {
  write_object_scene("s.yaml", "other_version", "");
  expect_end("run s.yaml --allow-code --quiet", 2,
             "other_version.so was compiled with version 2 of vibrospice/law.h; this program has "
             "version 1: compile it anew",
             __LINE__);
  write_object_scene("s.yaml", "no_function", "");
  expect_end("run s.yaml --allow-code --quiet", 2, "has no function vibrospice_law", __LINE__);
  write_object_scene("s.yaml", "not_there", "");
  REFUSE("run s.yaml", "no file", "s.yaml:2:30: control.file: ", "not_there.so cannot be read");
  REFUSE("run s.yaml --allow-code", "no file", "s.yaml:2:30: control.file: ", "No such file");
  write_scene("s.yaml", "law: object, file: s.yaml");
  REFUSE("run s.yaml --allow-code --quiet", "no object", "s.yaml:2:30: control.file: s.yaml cannot",
         "s.yaml");
  write_scene("s.yaml", "law: object, file: /bin/cat");
  REFUSE("run s.yaml --allow-code --quiet", "a program", "s.yaml:2:30: control.file: /bin/cat ",
         "cannot be loaded");
  write_scene("s.yaml", "law: object");
  REFUSE("run s.yaml", "no key", "s.yaml:2:11: control: ", "wants the key file");
  write_scene("s.yaml", "law: object, file: s.yaml, timeout: 0 s");
  REFUSE("run s.yaml", "no time", "s.yaml:2:47: control.timeout: ", "out of range");
}

/* A pipe that answers, line by line, what the script says. */
static void write_pipe_scene(const char *script) {
  write_file("law.sh", script);
  write_scene("s.yaml", "law: pipe, command: sh law.sh, timeout: 0.2 s");
}

static void bad_pipes(void) {
  static const struct {
    const char *script, *says;
  } LAWS[] = {
      {"read x; sleep 77", "t = 0 s: control: sh law.sh gave no answer within control.timeout"},
      {"read x; echo '{\"angle_deg\": 100}'; exit 4",
       "t = 0.02 s: control: sh law.sh ended with status 4, without an answer"},
      {"read x; echo good morning",
       "t = 0 s: control: sh law.sh answered 'good morning'; wanted: "},
      {"read x; echo 95", "answered '95'; wanted: one line of JSON, {\"angle_deg\": 95}, "},
      {"read x; echo '[95]'", "answered '[95]'; wanted"},
      {"read x; echo '{}'", "answered '{}'; wanted"},
      {"read x; echo", "answered ''; wanted"},
      {"read x; echo '{\"angle_deg\": NaN}'", "answered '{\"angle_deg\": NaN}'; wanted"},
      {"read x; echo '{\"angle_deg\": \"wide\"}'", "\"wide\"}'; wanted"},
      {"read x; echo '{\"angle_deg\": \"nan\"}'", "\"nan\"}'; wanted"},
      {"read x; echo '{\"angle_deg\": \"95\"}'", "\"95\"}'; wanted"},
      {"read x; echo '{\"error\": null}'", "answered '{\"error\": null}'; wanted"},
      {"read x; echo '{\"angle_deg\": [95]}'", "[95]}'; wanted"},
      {"read x; echo '{\"angel_deg\": 95}'", "answered '{\"angel_deg\": 95}'; wanted"},
      {"read x; echo '{\"angle_deg\": 95, \"error\": \"x\"}'", "\"x\"}'; wanted"},
      {"read x; echo '{\"angle_deg\": 95, \"angle_deg\": 96}'", "wanted"},
      {"read x; echo '{\"angle_deg\": 181}'",
       "answered an angle of 181 deg; allowed: 0..180 deg (ends excluded)"},
      {"read x; echo '{\"angle_deg\": 1e999}'", "answered an angle of inf deg; allowed"},
      {"read x; echo '{\"error\": \"no \\\"belt\\\"\"}'", "sh law.sh says: no \"belt\""},
      {"read x; printf '{\"angle_deg\": 95}\\n{\"angle_deg\": 95}\\n'", "more than one line"},
      {"read x; printf '\\377\\001\\n'", "answered '...'; wanted"},
      {"read x; printf '{\"angle_deg\": 95}\\000\\n'", "wanted"}};
  for (size_t k = 0; k < COUNT(LAWS); k++) {
    write_pipe_scene(LAWS[k].script);
    expect_end("run s.yaml --allow-code --quiet", 1, LAWS[k].says, __LINE__);
  }
  write_scene("s.yaml", "law: pipe, command: no_such_program x");
  REFUSE("run s.yaml --allow-code --quiet", "no program",
         "s.yaml:2:31: control: the program no_such", "cannot be started: No such file");
  write_scene("s.yaml", "law: pipe, command: \"python3 'my law.py\"");
  REFUSE("run s.yaml", "a quote",
         "s.yaml:2:32: control.command: ", "a quotation in it is not closed");
  write_scene("s.yaml", "law: pipe, command: ' '");
  REFUSE("run s.yaml", "no word", "s.yaml:2:32: control.command: ", "it is empty");
}

/* What it reads is one line, with null for what is not known; no firing is null, too. */
static void lines(void) {
  write_file("law.sh", "while read x; do echo \"$x\" >>told; echo '{\"angle_deg\": null}'; done\n");
  write_scene("s.yaml", "law: pipe, command: \"sh 'law.sh'\"");
  RUN_GOOD("run s.yaml --allow-code --quiet -o out --set run.until=0.05s");
  char *told = read_file("told");
  EXPECT(count_lines(told) == 3, "%s", told);
  EXPECT(!strncmp(
             told,
             "{\"t_s\": 0, \"firing\": 1, \"last_angle_deg\": null, \"now\": {\"p_meas_m\": null, ",
             72),
         "%s", told);
  const char *third = strstr(told, "{\"t_s\": 0.04, \"firing\": 3, \"last_angle_deg\": null, ");
  EXPECT(third && strstr(third, "\"least\": {\"p_meas_m\": -4.39453125") &&
             strstr(third, "\"i_meas_a\": ") && strstr(third, "\"largest\": {"),
         "%s", told);
  free(told);
  char *events = read_file("out/events.csv");
  EXPECT(!strstr(events, "fires"), "%s", events);
  free(events);
}

/* What the scene's observer estimates stands behind what the instruments show. */
static void estimates(void) {
  write_file("law.sh", "while read x; do echo \"$x\" >>more; echo '{\"angle_deg\": 100}'; done\n");
  write_scene("s.yaml", "law: pipe, command: sh law.sh, observer: {}");
  RUN_GOOD("run s.yaml --allow-code --quiet");
  char *told = read_file("more"), *last = strstr(told, "\"t_s\": 0.1,");
  const char *seen = last ? strstr(last, "\"v_eva_meas_v\": ") : NULL,
             *est = seen ? strstr(seen, ", \"p_est_m\": ") : NULL;
  EXPECT(est && strncmp(est + 13, "null", 4) && strstr(est, ", \"vp_est_m_s\": "), "%s",
         last ? last : "no last line");
  free(told);
}

/* The command runs in the scene's folder, and an object's path starts there; from the command line
 * both start where it stands. */
static void folders(void) {
  mkdir("sub", 0777);
  write_file("sub/law.sh", "while read x; do echo '{\"angle_deg\": 100}'; done\n");
  write_scene("sub/s.yaml", "law: pipe, command: sh ./law.sh");
  RUN_GOOD("run sub/s.yaml --allow-code --quiet");
  RUN_GOOD("run sub/s.yaml --allow-code --quiet --set 'control.command=sh sub/law.sh'");
  unlink("law.sh");
  expect_end("run sub/s.yaml --allow-code --quiet --set 'control.command=sh law.sh'", 1,
             "ended with status", __LINE__);
  CU_ASSERT(!symlink(VS_LAWS "/trim.so", "sub/law.so"));
  write_scene("sub/s.yaml", "law: object, file: law.so");
  RUN_GOOD("run sub/s.yaml --allow-code --quiet");
  RUN_GOOD("run sub/s.yaml --allow-code --quiet --set control.file=sub/law.so");
}

/* ---- what is allowed ---- */

static void write_study(const char *path) {
  write_file(path, "scene: s.yaml\nvary: {supply.voltage: [430 V, 440 V]}\nreport: [p_max]\n");
}

/* Nothing of it runs without --allow-code, nor ever in a check. */
static void not_allowed(void) {
  static const char *const COMMANDS[] = {"run s.yaml", "run s.yaml -o out", "study v.yaml -o out",
                                         "sensitivity s.yaml --of p_max --to supply.voltage",
                                         "fit f.yaml"};
  static const char *const CHECKS[] = {"check s.yaml --no-jail", "check v.yaml --no-jail"};
  setenv("LAW_FILE", "touched", 1);
  write_object_scene("s.yaml", "broken", "");
  write_study("v.yaml");
  write_file("f.yaml", "scene: s.yaml\nmeasures: {p_max: {value: 1 mm, error: 1 %}}\n"
                       "free: {supply.voltage: {from: 400 V, to: 450 V}}\n");
  for (size_t k = 0; k < COUNT(COMMANDS); k++) {
    char words[128];
    snprintf(words, sizeof words, "%s --quiet", COMMANDS[k]);
    REFUSE(words, COMMANDS[k], "s.yaml:2:30: control.file: ", "--allow-code");
  }
  for (size_t k = 0; k < COUNT(CHECKS); k++) {
    ran r = run("%s", CHECKS[k]);
    EXPECT(r.status == 0 && strstr(r.out, "control.file was not tried"), "%s: %d: %s%s", CHECKS[k],
           r.status, r.out, r.err);
    free_ran(&r);
  }
  EXPECT(access("touched", F_OK), "it was loaded");
  RUN_GOOD("run s.yaml --allow-code --quiet");
  EXPECT(!access("touched", F_OK), "it was not loaded, though that is allowed");
  RUN_GOOD("sensitivity s.yaml --of p_max --to supply.voltage --allow-code --quiet");
  unsetenv("LAW_FILE");
}

/* ---- what is left ---- */

/* The processes whose numbers the file has are gone. count: how many they are. */
static void expect_gone(const char *path, int count, int line) {
  char *text = read_file(path), *rest = text;
  expect(count_lines(text) == count, line, "%d processes instead of %d", count_lines(text), count);
  for (char *word; (word = strsep(&rest, "\n"));) {
    pid_t process = (pid_t)atol(word);
    for (int k = 0; k < 500 && process && !is_gone(process); k++) usleep(10000);
    expect(!process || is_gone(process), line, "%s is left", word);
  }
  free(text);
  unlink(path);
}

/* Waits until the file is there. */
static void wait_for_file(const char *path) {
  for (int k = 0; k < 2000 && access(path, F_OK); k++) usleep(10000);
}

/* A worker that is killed, as its case takes too long, takes the law with it. */
static void run_study_in_time(void) {
  ran r = run("study v.yaml --allow-code --quiet -o late --jobs 1 --case-timeout 0.5s "
              "--set control.timeout=60s");
  EXPECT(r.status == 1, "%d: %s", r.status, r.err);
  free_ran(&r);
  char *why = read_file("late/failures.csv"), *cases = read_file("processes");
  EXPECT(count_lines(why) == 3 && count_lines(cases) >= 2, "%s", why);
  expect_gone("processes", count_lines(cases), __LINE__); /* one that was late is tried again */
  free(why);
  free(cases);
}

/* However the program ends, its law ends with it. */
static void nothing_is_left(void) {
  static const int SIGNALS[] = {SIGTERM, SIGINT, SIGKILL};
  setenv("LAW_FILE", "processes", 1);
  write_object_scene("s.yaml", "broken", "");
  RUN_GOOD("run s.yaml --allow-code --quiet");
  expect_gone("processes", 1, __LINE__);
  setenv("LAW", "hang", 1);
  for (size_t k = 0; k < COUNT(SIGNALS); k++) {
    char words[] = "run s.yaml --allow-code --quiet --set control.timeout=60s";
    const char *argv[MOST_WORDS];
    split(words, argv);
    pid_t program = spawn_ready(argv);
    wait_for_file("processes");
    usleep(200000);
    kill(program, SIGNALS[k]);
    ran r = collect(program);
    int wanted = SIGNALS[k] == SIGKILL ? 1000 + SIGKILL : 75;
    EXPECT(r.status == wanted, "signal %d: status %d: %s", SIGNALS[k], r.status, r.err);
    free_ran(&r);
    expect_gone("processes", 1, __LINE__);
  }
  write_study("v.yaml");
  run_study_in_time();
  unsetenv("LAW");
  char piped[VS_PATH_SIZE]; /* SIGPIPE, as it has something to print */
  snprintf(piped, sizeof piped, "%s run s.yaml --allow-code --json 2>/dev/null | true", VS_PROGRAM);
  CU_ASSERT(!system(piped));
  expect_gone("processes", 1, __LINE__);
  unsetenv("LAW_FILE");
  write_file("law.sh", "echo $$ >>processes\nwhile read x; do echo '{\"angle_deg\": 100}'; done\n");
  write_scene("s.yaml", "law: pipe, command: sh law.sh");
  RUN_GOOD("run s.yaml --allow-code --quiet");
  expect_gone("processes", 1, __LINE__);
  write_file("law.sh",
             "echo $$ >>processes\ntrap '' TERM INT HUP PIPE\nread x\nsleep 77\nsleep 77\n");
  write_scene("s.yaml", "law: pipe, command: sh law.sh, timeout: 0.2 s");
  expect_end("run s.yaml --allow-code --quiet", 1, "gave no answer", __LINE__);
  expect_gone("processes", 1, __LINE__);
}

/* The second run, which finds the errors of margins, has a process of its own. */
static void second_run(void) {
  setenv("LAW_FILE", "processes", 1);
  write_gated_deck();
  char *gated = read_file("gated.cir");
  vs_text deck = {0};
  vs_text_add(&deck, "%s*$ rating v_ak -2..2 kV\n", gated);
  write_file("rated.cir", deck.text);
  vs_text_free(&deck);
  free(gated);
  write_object_scene("s.yaml", "broken", "");
  vs_text waived = {0};
  waive_the_rest("thyristor", "thyristor", "limit i_t_rms ", &waived);
  ran r = run("run s.yaml --allow-code --quiet --tier circuit --set circuit.deck=rated.cir --set "
              "run.until=0.05s --set run.verify=always --set waive=[%s]",
              waived.text);
  expect_good(&r, "a second run", __LINE__);
  free_ran(&r);
  vs_text_free(&waived);
  expect_gone("processes", 2, __LINE__);
  unsetenv("LAW_FILE");
}

/* ---- studies ---- */

/* Each case has a process of its own. A law that was changed makes other cases. */
static void studies(void) {
  static const char LAW[] =
      "echo $$ >>processes\nwhile read x; do echo '{\"angle_deg\": %d}'; done\n";
  char law[128];
  write_scene("s.yaml", "law: pipe, command: sh law.sh");
  write_study("v.yaml");
  snprintf(law, sizeof law, LAW, 100);
  write_file("law.sh", law);
  RUN_GOOD("study v.yaml --allow-code --quiet -o one");
  expect_gone("processes", 2, __LINE__);
  RUN_GOOD("study v.yaml --allow-code --quiet -o one --resume");
  EXPECT(access("processes", F_OK), "what was done is done again");
  snprintf(law, sizeof law, LAW, 130);
  write_file("law.sh", law);
  ran r = run("study v.yaml --allow-code --quiet -o one --resume");
  EXPECT(r.status == 2, "%d: %s", r.status, r.err);
  free_ran(&r);
  RUN_GOOD("study v.yaml --allow-code --quiet -o two");
  char *one = read_file("one/study.csv"), *two = read_file("two/study.csv");
  const char *id_one = strstr(one, "\n0,"), *id_two = strstr(two, "\n0,");
  EXPECT(id_one && id_two && strncmp(id_one, id_two, 3 + 16), "the same id: %s", two);
  free(one);
  free(two);
}

static const vs_test TESTS[] = {{"a copy answers", a_copy_answers},
                                {"a copy fails", a_copy_fails},
                                {"an answer that nobody asked for", unasked},
                                {"a program answers", a_program_answers},
                                {"a program fails", a_program_fails},
                                {"a program is ended", a_program_is_ended},
                                {"its whole group ends with its owner", a_program_outlives_nobody},
                                {"a signal is heeded", a_signal_is_heeded},
                                {"a copy of the owner", a_copy_of_the_owner},
                                {"one law in two languages", both_languages},
                                {"other tiers", other_tiers},
                                {"bad objects", bad_objects},
                                {"closed streams", closed_streams},
                                {"no objects", no_objects},
                                {"changed files", changed_files},
                                {"bad pipes", bad_pipes},
                                {"lines", lines},
                                {"estimates", estimates},
                                {"folders", folders},
                                {"not allowed", not_allowed},
                                {"nothing is left", nothing_is_left},
                                {"second run", second_run},
                                {"studies", studies}};

int main(void) {
  return program_suite("own law", TESTS, COUNT(TESTS));
}
