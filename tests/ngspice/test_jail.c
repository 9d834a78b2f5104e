/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a stranger's files may reach: in the jail nothing is read outside the folder of the file
 * that the command names, whatever key names it; the trial and the workers are refused the kernel's
 * calls that they do not need. */
#include <errno.h>
#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pwd.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/jail.h"
#include "ngspice/child.h"
#include "ngspice/sandbox.h"
#include "program.h"

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

/* The folder ../in has a stranger's files, and ../out what is none of theirs. */
static void make_folders(void) {
  CU_ASSERT(!mkdir("../in", 0777) && !mkdir("../in/below", 0777) && !mkdir("../out", 0777));
  write_file("../out/secret.inc", SECRET "\n");
  write_file("../out/secret.yaml", SECRET ": 1\n");
  write_file("../out/secret.csv", SECRET ",1\n");
  write_deck("../out/deck.cir", SECRET "\n");
  CU_ASSERT(!symlink("../out/secret.inc", "../in/link.inc") && !symlink("../out", "../in/link"));
  CU_ASSERT(!symlink("../out/deck.cir", "../in/link.cir") && !mkdir("here", 0777));
  write_file("here/secret.csv", SECRET ",1\n");
}

/* A scene with a law of control, but for its end. */
#define CONTROL "firing: {every: 1}\ninstruments: {}\ncontrol: "

/* What each file says, and the place of the name that is refused. */
static const struct {
  const char *file, *text, *at;
} REFUSED[] = {
    {"../in/s.yaml", "circuit: {deck: ../out/deck.cir}\n", "../in/s.yaml:1:17: "},
    {"../in/s.yaml", "circuit: {deck: ../in/../out/deck.cir}\n", "../in/s.yaml:1:17: "},
    {"../in/s.yaml", "circuit: {deck: ../in/link.cir}\n", "../in/s.yaml:1:17: "},
    {"../in/s.yaml", "circuit: {deck: halfwave_paper, thyristor: ../out/secret.inc}\n",
     "../in/s.yaml:1:44: "},
    {"../in/s.yaml", "machine: {model: ../out/secret.yaml}\n", "../in/s.yaml:1:18: "},
    {"../in/s.yaml", "instruments: {set: ../out/secret.yaml}\n", "../in/s.yaml:1:20: "},
    {"../in/s.yaml", "actuator: {law: ../out/secret.csv}\n", "../in/s.yaml:1:17: "},
    {"../in/s.yaml", "actuator: {law: here/secret.csv}\n", "../in/s.yaml:1:17: "},
    {"../in/s.yaml", CONTROL "{law: object, file: ../out/secret.csv}\n", "../in/s.yaml:3:30: "},
    {"../in/s.yaml", CONTROL "{law: fmu, file: ../out/secret.csv}\n", "../in/s.yaml:3:27: "},
    {"../in/s.yaml", CONTROL "{law: pipe, command: python3 ../out/secret.csv}\n",
     "../in/s.yaml:3:31: "},
    {"../in/st.yaml", "scene: ../out/secret.yaml\nvary: {firing.angle: [90 deg, 91 deg]}\n",
     "../in/st.yaml:1:8: "},
    {"../in/st.yaml", "vary: ../out/secret.csv\n", "../in/st.yaml:1:7: "},
    {"../in/st.yaml",
     "catalogue: {prices: ../out/secret.csv, choose: {circuit.r1: {kind: resistor}}}\n",
     "../in/st.yaml:1:21: "},
    {"../in/f.yaml",
     "free: {actuator.resistance: 80 ohm..100 ohm}\n"
     "data: {file: ../out/secret.csv, columns: {i: 3 mA}}\n",
     "../in/f.yaml:2:14: "},
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
  remove_tree("here");
}

static void what_netlists_include(void) {
  static const char *const WAYS[] = {".lib ../out/secret.inc", ".include link.inc"};
  for (size_t k = 0; k < COUNT(WAYS); k++) {
    vs_text text = {0};
    vs_text_add(&text, "t\nV1 a 0 SIN(0 325 50)\nL1 a 0 1 Rser=9\n%s\n", WAYS[k]);
    write_file("../in/x.net", text.text);
    expect_refused("import ../in/x.net -o x.cir --jail", "../in/x.net:4:1: ", __LINE__);
    vs_text_free(&text);
  }
  /* a netlist that includes nothing from elsewhere */
  ran r = run("import halfwave_ltspice.net --jail -o x.cir --quiet");
  EXPECT(r.status == 0, "%d: %s", r.status, r.err);
  free_ran(&r);
  unlink("x.cir");
  unlink("../in/x.net");
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
    write_deck("../in/d.cir", WAYS[k]);
    expect_refused("check ../in/d.cir", "../in/d.cir:", __LINE__);
    expect_refused("run paper --jail --set circuit.deck=../in/d.cir", "../in/d.cir:", __LINE__);
  }
  write_deck("../in/d.cir", ".include ../out/secret.inc");
  ran r = run("check ../in/d.cir --no-jail");
  EXPECT(r.status == 2 && strstr(r.err, SECRET), "%d %s", r.status, r.err);
  free_ran(&r);
}

/* What a link of the command line leads to is read, and nothing else there. */
static void what_a_named_link_says(void) {
  ran r = run("check ../in/link.cir");
  EXPECT(r.status == 2 && strstr(r.err, SECRET) && !strstr(r.err, "lies at"), "%s", r.err);
  free_ran(&r);
  write_deck("../out/deck.cir", ".include ../out/secret.inc");
  expect_refused("check ../in/link.cir", "../in/link.cir:", __LINE__);
}

/* A check that goes well, with a warning that a file is of the working folder. */
static void good_from_here(const char *words, int line) {
  ran r = run("%s", words);
  expect(r.status == 0 && strstr(r.err, "is taken from the folder where the program runs"), line,
         "%s: %d: %s", words, r.status, r.err);
  free_ran(&r);
}

/* A project has its files in folders side by side. Whoever works in it checks them as a run reads
 * them. Who works in the home folder, above it, or with none, does not let a stranger's file read
 * all that is there. */
static void what_lies_below_the_working_folder(void) {
  static const char CHECK[] = "check scenes/s.yaml";
  char here[4096], *home = getenv("HOME") ? vs_copy(getenv("HOME")) : NULL;
  CU_ASSERT(getcwd(here, sizeof here - 16) && !mkdir("scenes", 0777) && !mkdir("decks", 0777));
  write_deck("decks/d.cir", "");
  write_file("scenes/s.yaml", "circuit: {deck: decks/d.cir}\nrun: {until: 12 ms}\n");
  setenv("HOME", "/", 1);
  RUN_GOOD("run scenes/s.yaml --quiet");
  good_from_here(CHECK, __LINE__);
  RUN_GOOD("run scenes/s.yaml --jail --quiet");
  char scene[sizeof here + 16];
  snprintf(scene, sizeof scene, "%s/scenes/s.yaml", here);
  CU_ASSERT(!symlink(scene, "../in/s_link.yaml"));
  good_from_here("check ../in/s_link.yaml", __LINE__);
  write_file("../in/s.yaml", "circuit: {deck: decks/d.cir}\n"); /* it lies not below */
  expect_refused("check ../in/s.yaml", "../in/s.yaml:1:17: ", __LINE__);
  setenv("HOME", here, 1);
  expect_refused(CHECK, "scenes/s.yaml:1:17: ", __LINE__);
  strcat(here, "/scenes");
  setenv("HOME", here, 1);
  expect_refused(CHECK, "scenes/s.yaml:1:17: ", __LINE__);
  unsetenv("HOME");
  expect_refused(CHECK, "scenes/s.yaml:1:17: ", __LINE__);
  RUN_GOOD("check scenes/s.yaml --set circuit.deck=decks/d.cir");
  if (home) setenv("HOME", home, 1);
  free(home);
  remove_tree("scenes");
  remove_tree("decks");
  remove("../in/s_link.yaml");
}

/* In the home folder lies what belongs to no project, and whoever downloads a deck checks it there.
 * The deck's folder is allowed for what lies directly in it. $HOME tells of the home folder; what
 * begins with a dot is not read below any folder. */
static void what_the_home_folder_holds(void) {
  static const char *const BELOW[] = {".include .ssh/id_rsa", ".include sub/secret.inc",
                                      ".include .netrc", ".lib proj/../sub/secret.inc",
                                      ".include sub/no_such_file"};
  char here[4096], home[4096 + 16], *before = getenv("HOME") ? vs_copy(getenv("HOME")) : NULL;
  CU_ASSERT(getcwd(here, sizeof here) && !mkdir("home", 0777) && !mkdir("home/.ssh", 0777));
  CU_ASSERT(!mkdir("home/sub", 0777) && !mkdir("home/proj", 0777));
  CU_ASSERT(!mkdir("home/proj/.git", 0777) && !mkdir("home/proj/.dir", 0777));
  write_file("home/.ssh/id_rsa", SECRET "\n");
  write_file("home/.netrc", SECRET "\n");
  write_file("home/sub/secret.inc", SECRET "\n");
  write_file("home/proj/.git/config", SECRET "\n");
  write_file("home/beside.inc", "* nothing\n");
  snprintf(home, sizeof home, "%s/home", here);
  setenv("HOME", home, 1);
  for (size_t k = 0; k < COUNT(BELOW); k++) {
    write_deck("home/d.cir", BELOW[k]);
    expect_refused("check home/d.cir", "home/d.cir:", __LINE__);
    CU_ASSERT(!chdir("home"));
    expect_refused("check d.cir", "d.cir:", __LINE__);
    CU_ASSERT(!chdir("proj"));
    expect_refused("check ../d.cir", "../d.cir:", __LINE__);
    CU_ASSERT(!chdir(here));
  }
  ran r = run("check home/d.cir");
  EXPECT(strstr(r.err, "directly in (a home folder or one above it, so not below) "), "%s", r.err);
  free_ran(&r);
  setenv("HOME", "home/proj", 1); /* a folder above the home folder is no project's either */
  expect_refused("check home/d.cir", "home/d.cir:", __LINE__);
  write_deck("home/d.cir", ".include beside.inc");
  RUN_GOOD("check home/d.cir --quiet");
  setenv("HOME", home, 1);
  write_deck("home/proj/d.cir", ".include .git/config"); /* a project's folder */
  expect_refused("check home/proj/d.cir", "home/proj/d.cir:", __LINE__);
  r = run("check home/proj/d.cir");
  EXPECT(strstr(r.err, "(a name on the way to it begins with a dot), and is not read"), "%s",
         r.err);
  free_ran(&r);
  write_deck("home/proj/d.cir", ".include none/../../../x.inc");
  r = run("check home/proj/d.cir");
  EXPECT(strstr(r.err, "('..' behind a folder that is not there leads out"), "%s", r.err);
  free_ran(&r);
  write_deck("home/proj/.dir/.d.cir", ".include own.inc"); /* such a folder is named here */
  write_file("home/proj/.dir/own.inc", "* nothing\n");
  RUN_GOOD("check home/proj/.dir/.d.cir --quiet");
  if (before) setenv("HOME", before, 1);
  free(before);
  remove_tree("home");
}

/* Returns 0 where a file named in that folder lets be read what lies directly in it alone. */
static int wrong_of_folder(const char *folder) {
  char path[4096 + 32];
  const char *slash = strcmp(folder, "/") ? "/" : "";
  vs_error err = {0};
  snprintf(path, sizeof path, "%s%s.", folder, slash);
  if (access(path, F_OK)) return 0; /* it is not there, or not to be read */
  vs_jail_allow_named(path);
  snprintf(path, sizeof path, "%s%sno_such.cir", folder, slash);
  int wrong = vs_jail_check(path, (vs_where){0}, &err) ? 1 : 0;
  snprintf(path, sizeof path, "%s%sno_folder/no_such.cir", folder, slash);
  wrong |= vs_jail_check(path, (vs_where){0}, &err) ? 0 : 2;
  snprintf(path, sizeof path, "%s%s.no_such", folder, slash);
  return wrong | (vs_jail_check(path, (vs_where){0}, &err) ? 0 : 4);
}

/* The system's entry of the user tells of the home folder, too, where $HOME does not. The root and
 * where homes lie hold no project, either. */
static void what_homes_the_system_knows(void) {
  const struct passwd *user = getpwuid(geteuid());
  char *own = user ? realpath(user->pw_dir, NULL) : NULL;
  const char *const FOLDERS[] = {own ? own : "/", "/", "/home", "/root"};
  for (size_t k = 0; k < COUNT(FOLDERS); k++) {
    int how = 0;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
      setenv("HOME", "/no/such/home", 1);
      vs_jail_begin("");
      _exit(wrong_of_folder(FOLDERS[k]));
    }
    CU_ASSERT_EQUAL(waitpid(child, &how, 0), child);
    EXPECT(WIFEXITED(how) && WEXITSTATUS(how) == 0, "%s: %d", FOLDERS[k], how);
  }
  free(own);
}

/* A value that happens to name a file lets nothing be read beside it, nor does a file that is
 * called as a value of the command line. */
static void what_values_name(void) {
  write_file("../in/s.yaml", "machine: {model: ../out/secret.yaml}\n");
  expect_refused("check ../in/s.yaml --set title=../out/secret.inc",
                 "../in/s.yaml:1:18: ", __LINE__);
  write_deck("--set run.until=1s", ".include ../out/secret.inc");
  write_file("s.yaml", "circuit: {deck: '--set run.until=1s'}\n");
  expect_refused("check s.yaml --set run.until=1s", "--set run.until=1s:", __LINE__);
  remove("--set run.until=1s");
  remove("s.yaml");
  write_file("../in/table.csv", "# a table\n");
  ran r = run("check paper --set actuator.law=../in/table.csv");
  EXPECT(r.status == 2 && !strstr(r.err, "lies at") && strstr(r.err, "table.csv"), "%s", r.err);
  free_ran(&r);
}

/* The message says what is allowed, and how to read more. */
static void what_a_refusal_says(void) {
  char in[4096 + 8];
  write_file("../in/s.yaml", "machine: {model: ../out/secret.yaml}\n");
  char *real = realpath("../in", NULL);
  snprintf(in, sizeof in, "below %s, and what comes", real);
  refuse("run ../in/s.yaml --jail", "folders",
         "../in/s.yaml:1:18: ", (const char *[]){in, "leave out --jail"}, __LINE__);
  ran r = run("check ../in/s.yaml");
  EXPECT(strstr(r.err, in) && strstr(r.err, "give --no-jail"), "%s", r.err);
  free_ran(&r);
  free(real);
  write_file("../in/s.yaml", "machine: {model: conveyor}\n");
  write_file("conveyor", "mass: 1 kg\n"); /* a run would take it */
  r = run("check ../in/s.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "the file conveyor hides the machine"), "%s", r.err);
  free_ran(&r);
  remove("conveyor");
  r = run("check ../in/no.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "no scene '../in/no.yaml'"), "%s", r.err);
  free_ran(&r);
}

/* What lies below the folder is read, and so is what comes with the program, and what the command
 * line names. */
static void what_may_be_read(void) {
  write_file("../in/below/r.inc", "* nothing\n");
  CU_ASSERT(!symlink("below/r.inc", "../in/inner.inc"));
  write_deck("../in/d.cir", ".include below/r.inc\n.include inner.inc\n");
  RUN_GOOD("check ../in/d.cir --quiet");
  write_file("../in/s.yaml", "circuit: {deck: ../in/d.cir}\nrun: {until: 1 ms}\n");
  RUN_GOOD("check ../in/s.yaml --quiet");
  RUN_GOOD("run ../in/s.yaml --jail --quiet");
  write_file("../in/s.yaml", "circuit: {deck: halfwave_paper, thyristor: TYN1212}\n");
  RUN_GOOD("check ../in/s.yaml --quiet");
  ran r = run("run /dev/stdin --jail --quiet"); /* of the tests, whatever that is */
  EXPECT(!strstr(r.err, "lies at"), "%s", r.err);
  free_ran(&r);
  write_deck("../out/deck.cir", "");
  RUN_GOOD("check paper --set circuit.deck=../out/deck.cir --quiet");
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
static int tried(vs_sandbox level) {
  int wrong = 0;
  wrong |= is_refused(socket(AF_INET, SOCK_STREAM, 0)) ? 0 : 1;
  wrong |= is_refused(socket(AF_UNIX, SOCK_STREAM, 0)) ? 0 : 2;
  char key = 'x'; /* without the filter there is no terminal, which is another error */
  wrong |= ioctl(STDIN_FILENO, TIOCSTI, &key) < 0 && errno == EPERM ? 0 : 4;
  int file = open("/dev/null", O_RDONLY);
  wrong |= file >= 0 ? 0 : 4;
  if (file >= 0) close(file);
  if (level >= VS_SANDBOX_WORKER) wrong |= cannot_start() ? 0 : 8;
  file = open("written", O_WRONLY | O_CREAT, 0600);
  if (file >= 0) close(file);
  if (level < VS_SANDBOX_TRIAL) return wrong | (file >= 0 ? 0 : 16);
  wrong |= file < 0 ? 0 : 32;
  pid_t child = fork();
  if (child == 0) _exit(0);
  wrong |= child < 0 && errno == EPERM ? 0 : 64;
  wrong |= kill(getppid(), 0) && errno == EPERM ? 0 : 128;
  return wrong;
}

static int tried_in_child(vs_sandbox level) {
  int how = 0;
  pid_t child = fork();
  if (child == 0) {
    vs_sandbox_process(level);
    _exit(tried(level));
  }
  CU_ASSERT_EQUAL(waitpid(child, &how, 0), child);
  return WIFEXITED(how) ? WEXITSTATUS(how) : 1000;
}

static void calls_are_refused(void) {
  if (!vs_sandbox_works()) {
    puts("this kernel has no seccomp: nothing to be seen");
    return;
  }
  CU_ASSERT_EQUAL(tried_in_child(VS_SANDBOX_NETWORK), 0);
  CU_ASSERT_EQUAL(tried_in_child(VS_SANDBOX_WORKER), 0);
  unlink("written");
  CU_ASSERT_EQUAL(tried_in_child(VS_SANDBOX_TRIAL), 0);
  CU_ASSERT(access("written", F_OK));
}

static vs_child_end attempt(void *ctx) {
  (void)ctx;
  return tried(VS_SANDBOX_TRIAL) ? VS_CHILD_BAD_RUN : VS_CHILD_GOOD;
}

static void a_trial_is_confined(void) {
  vs_solver_errors complaints = {0};
  vs_child_end end = VS_CHILD_BAD_LOAD;
  vs_error err = {0};
  if (!vs_sandbox_works()) return;
  CU_ASSERT_EQUAL(vs_child_try(attempt, NULL, &complaints, &end, &err), VS_OK);
  CU_ASSERT_EQUAL(end, VS_CHILD_GOOD);
}

static vs_child_end stays(void *ctx) {
  const volatile bool *here = ctx;
  while (*here) {
  }
  return VS_CHILD_GOOD;
}

static void nothing(int signal) {
  (void)signal;
}

/* A signal that this process handles ends the trial, and the program with 75. */
static void a_trial_is_stopped(void) {
  vs_solver_errors complaints = {0};
  vs_child_end end;
  vs_error err = {0};
  const struct sigaction act = {.sa_handler = nothing};
  const struct itimerval often = {{0, 50000}, {0, 50000}}, off = {{0, 0}, {0, 0}};
  sigaction(SIGALRM, &act, NULL);
  setitimer(ITIMER_REAL, &often, NULL);
  bool here = true;
  vs_status status = vs_child_try(stays, &here, &complaints, &end, &err);
  setitimer(ITIMER_REAL, &off, NULL);
  signal(SIGALRM, SIG_DFL);
  EXPECT(status == VS_SIGNAL && strstr(err.text, "stopped by a signal"), "%d: %s", (int)status,
         err.text);
}

/* Kills whatever sets a filter of calls of its own, as the filter of a container may. */
static bool kill_who_filters(void) {
  struct sock_filter code[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_seccomp, 0, 3),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, args)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SECCOMP_SET_MODE_FILTER, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const struct sock_fprog filter = {COUNT(code), code};
  return !prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) &&
         !prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter);
}

/* Who dies of a filter outside of the program says so, not that the circuit is bad. */
static void a_filter_outside_is_named(void) {
  static const char SAYS[] = "ended by signal SIGSYS: a filter of system calls outside of the";
  int how = 0;
  if (!vs_sandbox_works()) return;
  write_file("s.yaml", "circuit: {deck: halfwave_bare}\nrun: {until: 12 ms}\n");
  write_file("st.yaml", "scene: s.yaml\nvary: {firing.angle: [90 deg, 91 deg]}\n");
  pid_t child = fork();
  if (child == 0) {
    if (!kill_who_filters()) _exit(1);
    ran trial = run("check s.yaml --no-jail");
    ran study = run("study st.yaml -o out --jobs 1 --quiet");
    char *rows = read_file("out/failures.csv");
    bool named = trial.status == 1 && strstr(trial.err, "trial of the circuit was") &&
                 strstr(trial.err, SAYS) && strstr(rows, SAYS);
    if (!named)
      printf("%d: %s; %d: %s%s\n", trial.status, trial.err, study.status, study.err, rows);
    fflush(stdout);
    _exit(named ? 0 : 2);
  }
  CU_ASSERT_EQUAL(waitpid(child, &how, 0), child);
  EXPECT(WIFEXITED(how) && WEXITSTATUS(how) == 0, "%d", how);
  remove_tree("out");
  remove("s.yaml");
  remove("st.yaml");
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
  if (!vs_sandbox_works()) return;
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
      {"what netlists include", what_netlists_include},
      {"what a named link says", what_a_named_link_says},
      {"what lies below the working folder", what_lies_below_the_working_folder},
      {"what the home folder holds", what_the_home_folder_holds},
      {"what homes the system knows", what_homes_the_system_knows},
      {"what values name", what_values_name},
      {"what a refusal says", what_a_refusal_says},
      {"what may be read", what_may_be_read},
      {"what ngspice executes", what_ngspice_executes},
      {"words that clash", words_that_clash},
      {"calls are refused", calls_are_refused},
      {"a trial is confined", a_trial_is_confined},
      {"a trial is stopped", a_trial_is_stopped},
      {"workers are confined", workers_are_confined},
      {"a filter outside is named", a_filter_outside_is_named},
  };
  return program_suite("jail", TESTS, COUNT(TESTS));
}
