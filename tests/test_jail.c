/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a stranger's files may reach: in the jail nothing is read outside the folder of the file
 * that the command names, whatever key names it; the trial and the workers are refused the kernel's
 * calls that they do not need. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "program.h"
#include "solver/child.h"
#include "solver/confine.h"

/* A word that no message may show. */
#define SECRET "xyzzy"

/* A deck with a further line; the shipped one without its end. */
static void write_deck(const char *path, const char *more) {
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  vs_text deck = {0};
  vs_text_add(&deck, "%s\n%s", text, more);
  write_file(path, deck.text);
  vs_text_free(&deck);
  free(text);
}

/* The folder "in" has a stranger's files, and "out" what is none of theirs. */
static void make_folders(void) {
  CU_ASSERT(!mkdir("in", 0777) && !mkdir("in/below", 0777) && !mkdir("out", 0777));
  write_file("out/secret.inc", SECRET "\n");
  write_file("out/secret.yaml", SECRET ": 1\n");
  write_file("out/secret.csv", SECRET ",1\n");
  write_deck("out/deck.cir", SECRET "\n");
  CU_ASSERT(!symlink("../out/secret.inc", "in/link.inc") && !symlink("../out", "in/link"));
  CU_ASSERT(!symlink("../out/deck.cir", "in/link.cir"));
}

/* What each file says, and the place of the name that is refused. */
static const struct {
  const char *file, *text, *at;
} REFUSED[] = {
    {"in/s.yaml", "circuit: {deck: out/deck.cir}\n", "in/s.yaml:1:17: "},
    {"in/s.yaml", "circuit: {deck: in/../out/deck.cir}\n", "in/s.yaml:1:17: "},
    {"in/s.yaml", "circuit: {deck: in/link.cir}\n", "in/s.yaml:1:17: "},
    {"in/s.yaml", "circuit: {deck: halfwave_paper, thyristor: out/secret.inc}\n",
     "in/s.yaml:1:44: "},
    {"in/s.yaml", "machine: {model: out/secret.yaml}\n", "in/s.yaml:1:18: "},
    {"in/s.yaml", "instruments: {set: out/secret.yaml}\n", "in/s.yaml:1:20: "},
    {"in/s.yaml", "actuator: {law: ../out/secret.csv}\n", "in/s.yaml:1:17: "},
    {"in/s.yaml", "actuator: {law: out/secret.csv}\n", "in/s.yaml:1:17: "},
    {"in/st.yaml", "scene: ../out/secret.yaml\nvary: {firing.angle: [90 deg, 91 deg]}\n",
     "in/st.yaml:1:8: "},
    {"in/st.yaml", "vary: ../out/secret.csv\n", "in/st.yaml:1:7: "},
    {"in/f.yaml",
     "free: {actuator.resistance: 80 ohm..100 ohm}\n"
     "data: {file: ../out/secret.csv, columns: {i: 3 mA}}\n",
     "in/f.yaml:2:14: "},
};

static void expect_refused(const char *words, const char *at, int line) {
  ran r = run("%s", words);
  expect(r.status == 2, line, "%s: exit status %d", words, r.status);
  expect(strstr(r.err, at) && strstr(r.err, "lies at /"), line, "%s: %s", words, r.err);
  expect(!strstr(r.err, SECRET) && !strstr(r.out, SECRET), line, "%s: %s", words, r.err);
  free_ran(&r);
}

static void what_keys_name(void) {
  char words[128];
  make_folders();
  for (size_t k = 0; k < COUNT(REFUSED); k++) {
    const bool study = strstr(REFUSED[k].file, "st.yaml"), fit = strstr(REFUSED[k].file, "f.yaml");
    write_file(REFUSED[k].file, REFUSED[k].text);
    snprintf(words, sizeof words, "check %s", REFUSED[k].file);
    expect_refused(words, REFUSED[k].at, __LINE__);
    snprintf(words, sizeof words, "%s %s --jail",
             study ? "study"
             : fit ? "fit"
                   : "run",
             REFUSED[k].file);
    expect_refused(words, REFUSED[k].at, __LINE__);
    unlink(REFUSED[k].file);
  }
}

static void what_decks_include(void) {
  static const char *const WAYS[] = {".include ../out/secret.inc",
                                     ".include \"../out/secret.inc\"",
                                     ".inc below/../../out/secret.inc",
                                     ".lib ../out/secret.inc",
                                     ".include link.inc",
                                     ".include link/secret.inc",
                                     ".include /etc/shadow",
                                     ".include /etc/no/such/file"};
  for (size_t k = 0; k < COUNT(WAYS); k++) {
    write_deck("in/d.cir", WAYS[k]);
    expect_refused("check in/d.cir", "in/d.cir:", __LINE__);
    expect_refused("run paper --jail --set circuit.deck=in/d.cir", "in/d.cir:", __LINE__);
  }
  write_deck("in/d.cir", ".include ../out/secret.inc");
  ran r = run("check in/d.cir --no-jail");
  EXPECT(r.status == 2 && strstr(r.err, SECRET), "%d %s", r.status, r.err);
  free_ran(&r);
  expect_refused("check in/link.cir", "in/link.cir: ", __LINE__);
}

/* What lies below the folder is read, and so is what comes with the program, and what the command
 * line names. */
static void what_may_be_read(void) {
  write_file("in/below/r.inc", "* nothing\n");
  CU_ASSERT(!symlink("below/r.inc", "in/inner.inc"));
  write_deck("in/d.cir", ".include below/r.inc\n.include inner.inc\n");
  RUN_GOOD("check in/d.cir --quiet");
  write_file("in/s.yaml", "circuit: {deck: in/d.cir}\nrun: {until: 1 ms}\n");
  RUN_GOOD("check in/s.yaml --quiet");
  RUN_GOOD("run in/s.yaml --jail --quiet");
  write_file("in/s.yaml", "circuit: {deck: halfwave_paper, thyristor: TYN1212}\n");
  RUN_GOOD("check in/s.yaml --quiet");
  ran r = run("check /dev/stdin --quiet"); /* of the tests, whatever that is */
  EXPECT(!strstr(r.err, "lies at"), "%s", r.err);
  free_ran(&r);
  write_deck("out/deck.cir", "");
  RUN_GOOD("check paper --set circuit.deck=out/deck.cir --quiet");
}

/* ngspice executes what its .spiceinit and spinit say, before any jail could hold it. So they are
 * taken from the program's own folders alone, never from one of $VIBROSPICE_PATH. */
static void what_ngspice_executes(void) {
  static const char *const COMMANDS[] = {"run s.yaml", "run s.yaml --jail", "check s.yaml"};
  static const char *const FILES[] = {"shelf/ngspice/.spiceinit", "shelf/ngspice/spinit"};
  CU_ASSERT(!mkdir("shelf", 0777) && !mkdir("shelf/ngspice", 0777));
  for (size_t k = 0; k < COUNT(FILES); k++)
    write_file(FILES[k], "* a stranger's\nshell touch executed\nquit\n");
  write_file("s.yaml", "circuit: {deck: halfwave_snubbed}\nrun: {until: 12 ms}\n");
  setenv("VIBROSPICE_PATH", "shelf", 1);
  for (size_t k = 0; k < COUNT(COMMANDS); k++) {
    RUN_GOOD(COMMANDS[k]);
    EXPECT(access("executed", F_OK) != 0, "%s executes it", COMMANDS[k]);
  }
  unsetenv("VIBROSPICE_PATH");
}

static void words_that_clash(void) {
  refuse("run paper --jail --allow-code", "both", "", (const char *[]){"--allow-code", "--jail"},
         __LINE__);
  refuse("run paper --jail --no-jail", "both", "", (const char *[]){"--jail", "--no-jail"},
         __LINE__);
}

/* ---- calls ---- */

/* Returns whether a call is refused with EPERM, and ends what it has made. */
static bool is_refused(int result) {
  if (result < 0) return errno == EPERM;
  close(result);
  return false;
}

static bool cannot_start(void) {
  char *const words[] = {NULL};
  execv("/proc/self/exe", words);
  return errno == EPERM;
}

/* A bit for each call that is not refused as it should be. */
static int tried(vs_confine level) {
  int wrong = 0;
  wrong |= is_refused(socket(AF_INET, SOCK_STREAM, 0)) ? 0 : 1;
  wrong |= is_refused(socket(AF_UNIX, SOCK_STREAM, 0)) ? 0 : 2;
  char key = 'x'; /* without the filter there is no terminal, which is another error */
  wrong |= ioctl(STDIN_FILENO, TIOCSTI, &key) < 0 && errno == EPERM ? 0 : 4;
  int file = open("/dev/null", O_RDONLY);
  wrong |= file >= 0 ? 0 : 4;
  if (file >= 0) close(file);
  if (level >= VS_CONFINE_WORKER) wrong |= cannot_start() ? 0 : 8;
  file = open("written", O_WRONLY | O_CREAT, 0600);
  if (file >= 0) close(file);
  if (level < VS_CONFINE_TRIAL) return wrong | (file >= 0 ? 0 : 16);
  wrong |= file < 0 ? 0 : 32;
  pid_t child = fork();
  if (child == 0) _exit(0);
  wrong |= child < 0 && errno == EPERM ? 0 : 64;
  wrong |= kill(getppid(), 0) && errno == EPERM ? 0 : 128;
  return wrong;
}

static int tried_in_child(vs_confine level) {
  int how = 0;
  pid_t child = fork();
  if (child == 0) {
    vs_confine_process(level);
    _exit(tried(level));
  }
  CU_ASSERT_EQUAL(waitpid(child, &how, 0), child);
  return WIFEXITED(how) ? WEXITSTATUS(how) : 1000;
}

static void calls_are_refused(void) {
  if (!vs_confine_works()) {
    puts("this kernel has no seccomp: nothing to be seen");
    return;
  }
  CU_ASSERT_EQUAL(tried_in_child(VS_CONFINE_NETWORK), 0);
  CU_ASSERT_EQUAL(tried_in_child(VS_CONFINE_WORKER), 0);
  unlink("written");
  CU_ASSERT_EQUAL(tried_in_child(VS_CONFINE_TRIAL), 0);
  CU_ASSERT(access("written", F_OK));
}

static vs_child_end attempt(void *ctx) {
  (void)ctx;
  return tried(VS_CONFINE_TRIAL) ? VS_CHILD_BAD_RUN : VS_CHILD_GOOD;
}

static void a_trial_is_confined(void) {
  vs_complaints complaints = {0};
  vs_child_end end = VS_CHILD_BAD_LOAD;
  vs_error err = {0};
  if (!vs_confine_works()) return;
  CU_ASSERT_EQUAL(vs_child_try(attempt, NULL, &complaints, &end, &err), VS_OK);
  CU_ASSERT_EQUAL(end, VS_CHILD_GOOD);
}

/* How the calls of a process are filtered, as the system tells: 0, they are not; 2, by a filter. */
static int filters_of(int pid) {
  char path[64], *text, *found;
  snprintf(path, sizeof path, "/proc/%d/status", pid);
  text = read_file(path);
  found = strstr(text, "\nSeccomp:");
  int mode = found ? atoi(found + strlen("\nSeccomp:")) : -1;
  free(text);
  return mode;
}

/* A study's workers are under way while the first of its long cases runs. */
static void workers_are_confined(void) {
  char words[] = "study long.yaml -o long --jobs 2 --quiet", path[64];
  const char *argv[MOST_WORDS];
  int pid[2] = {0}, count = 0;
  if (!vs_confine_works()) return;
  write_file("long.yaml", "set: {run.sample: 1 ms, run.tier: switched, run.until: 9e5 s}\n"
                          "vary: {firing.angle: [90 deg, 91 deg]}\n");
  split(words, argv);
  const int before = filters_of(getpid());
  pid_t master = spawn(argv);
  for (int tries = 0; tries < 400 && count < 2; tries++) {
    usleep(20000);
    snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)master, (int)master);
    FILE *f = fopen(path, "r");
    count = f ? fscanf(f, "%d %d", &pid[0], &pid[1]) : 0;
    if (f) fclose(f);
  }
  usleep(100000);
  EXPECT(filters_of(master) == before, "%d", filters_of(master));
  for (int k = 0; k < count; k++) EXPECT(filters_of(pid[k]) == 2, "%d", filters_of(pid[k]));
  CU_ASSERT_EQUAL(count, 2);
  kill(master, SIGTERM);
  ran r = collect(master);
  CU_ASSERT_EQUAL(r.status, 75);
  free_ran(&r);
  remove_tree("long");
}

int main(void) {
  static const vs_test TESTS[] = {
      {"what keys name", what_keys_name},
      {"what decks include", what_decks_include},
      {"what may be read", what_may_be_read},
      {"what ngspice executes", what_ngspice_executes},
      {"words that clash", words_that_clash},
      {"calls are refused", calls_are_refused},
      {"a trial is confined", a_trial_is_confined},
      {"workers are confined", workers_are_confined},
  };
  return program_suite("jail", TESTS, COUNT(TESTS));
}
