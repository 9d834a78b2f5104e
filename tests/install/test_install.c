/* SPDX-License-Identifier: GPL-3.0-or-later
 * The program as it is installed: run from another folder and in an empty environment, it lives on
 * what was installed with it. The source tree, which it was built from and would find last, is told
 * apart by altered copies: what they say must show. */
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

/* The installed program. Its environment holds what the sanitizers are told and nothing else. */
static ran run_installed(const char *words) {
  static const char *const KEPT[] = {"LSAN_OPTIONS", "ASAN_OPTIONS"};
  char copy[512], options[COUNT(KEPT)][VS_PATH_SIZE], *environment[COUNT(KEPT) + 1] = {NULL};
  const char *argv[MOST_WORDS];
  size_t n = 0;
  for (size_t k = 0; k < COUNT(KEPT); k++)
    if (getenv(KEPT[k])) {
      snprintf(options[n], sizeof options[n], "%s=%s", KEPT[k], getenv(KEPT[k]));
      environment[n] = options[n];
      n++;
    }
  snprintf(copy, sizeof copy, "%s", words);
  split(copy, argv);
  return collect(spawn_other("there/bin/vibrospice", argv, environment));
}

static void expect_says(const char *words, const char *says, int line) {
  ran r = run_installed(words);
  expect_good(&r, words, line);
  expect(strstr(r.out, says) != NULL, line, "%s: does not say '%s': %s", words, says, r.out);
  free_ran(&r);
}
#define EXPECT_SAYS(words, says) expect_says(words, says, __LINE__)

static void alter(const char *path, const char *from, const char *to) {
  char *text = read_file(path), *at = strstr(text, from);
  vs_text altered = {0};
  EXPECT(at, "%s: no '%s'", path, from);
  if (at) {
    vs_text_add(&altered, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    write_file(path, altered.text);
  }
  vs_text_free(&altered);
  free(text);
}

/* ---- the tests, in this order ---- */

static void installing(void) {
  char command[3 * VS_PATH_SIZE];
  unsetenv("DESTDIR");
  snprintf(command, sizeof command,
           "'%s' --install '%s' --prefix \"$PWD/there\" >../install_says 2>&1", VS_CMAKE,
           VS_BUILD_TREE);
  int failed = system(command);
  char *says = read_file("../install_says");
  EXPECT(!failed && !access("there/bin/vibrospice", X_OK), "%s: %s", command, says);
  free(says);
}

/* Configures a build for another machine and expects that so many files are made by running the
 * program. */
static void expect_made(const char *emulator, int count, int line) {
  char command[4 * VS_PATH_SIZE];
  snprintf(
      command, sizeof command,
      "rm -rf ../other; '%s' -S '%s/..' -B ../other -G 'Unix Makefiles' -DCMAKE_SYSTEM_NAME=Linux "
      "-DBUILD_TESTING=OFF %s >../other_says 2>&1",
      VS_CMAKE, VS_TEST_FOLDER, emulator);
  int failed = system(command);
  char *says = read_file("../other_says"),
       *rules = read_file("../other/CMakeFiles/made.dir/build.make");
  int made = 0;
  for (char *at = rules; (at = strstr(at, "VIBROSPICE_PATH=")); at++) made++;
  expect(!failed && made == count, line, "%d instead of %d: %s", made, count, says);
  free(says), free(rules);
}

/* A build for another machine cannot run the program here without an emulator. */
static void for_another_machine(void) {
  expect_made("", 0, __LINE__);
  expect_made("-DCMAKE_CROSSCOMPILING_EMULATOR=/usr/bin/env", 7, __LINE__);
}

static int compared;

static int compare_file(const char *path, const struct stat *s, int kind, struct FTW *at) {
  (void)s, (void)at;
  char installed[2 * VS_PATH_SIZE];
  if (kind != FTW_F) return 0;
  snprintf(installed, sizeof installed, "there/share/vibrospice%s",
           path + strlen(VS_TEST_FOLDER "/../spice"));
  char *one = read_file(path), *other = read_file(installed);
  EXPECT(*one && !strcmp(one, other), "%s is not installed as it is", path);
  compared++;
  free(one);
  free(other);
  return 0;
}

static void all_of_spice_is_there(void) {
  CU_ASSERT_EQUAL(nftw(VS_TEST_FOLDER "/../spice", compare_file, 16, FTW_PHYS), 0);
  CU_ASSERT(compared >= 5); /* decks, subcircuit, part, scene at least */
  static const char *const MADE[] = {"include/vibrospice/law.h",
                                     "share/bash-completion/completions/vibrospice",
                                     "share/fish/vendor_completions.d/vibrospice.fish",
                                     "share/zsh/site-functions/_vibrospice",
                                     "share/man/man1/vibrospice.1",
                                     "lib/python3/dist-packages/vibrospice/__init__.py",
                                     "lib/python3/dist-packages/vibrospice/calls.py",
                                     "lib/python3/dist-packages/vibrospice/engine.py",
                                     "lib/python3/dist-packages/vibrospice/results.py",
                                     "lib/python3/dist-packages/vibrospice/tables.py",
                                     "share/vibrospice/schema/scene.schema.json",
                                     "share/vibrospice/schema/study.schema.json",
                                     "share/vibrospice/schema/machine.schema.json"};
  for (size_t k = 0; k < COUNT(MADE); k++) {
    char path[128];
    struct stat s;
    snprintf(path, sizeof path, "there/%s", MADE[k]);
    EXPECT(!stat(path, &s) && s.st_size > 100, "%s is not installed", MADE[k]);
  }
}

static void shipped_scenes_and_decks_run(void) {
  EXPECT_SAYS("--version", "vibrospice " VS_VERSION);
  EXPECT_SAYS("list scenes", "there/bin/../share/vibrospice/scenes/paper.yaml");
  EXPECT_SAYS("list decks", "there/bin/../share/vibrospice/halfwave_snubbed.cir");
  EXPECT_SAYS("list parts", "there/bin/../share/vibrospice/parts/latch.inc");
  EXPECT_SAYS("run paper --tier circuit --set run.until=5ms",
              "there/bin/../share/vibrospice/scenes/paper.yaml");
  EXPECT_SAYS("run paper --set circuit.deck=halfwave_bare --set run.until=5ms", "circuit");
}

/* A new scene names the installed schema, and so do the shipped files, by where they lie. */
static void schemas_are_named(void) {
  EXPECT_SAYS("new fresh.yaml", "written");
  char *fresh = read_file("fresh.yaml"),
       *shipped = read_file("there/share/vibrospice/scenes/paper.yaml");
  char path[256] = "";
  sscanf(fresh, "# yaml-language-server: $schema=%255s", path);
  EXPECT(strstr(path, "/share/vibrospice/schema/scene.schema.json") && !access(path, R_OK),
         "%.200s", fresh);
  sscanf(shipped, "# yaml-language-server: $schema=%255s", path);
  EXPECT(!strcmp(path, "../schema/scene.schema.json"), "%.200s", shipped);
  free(fresh);
  free(shipped);
}

static void added_files_are_found(void) {
  write_file("there/share/vibrospice/scenes/marker.yaml", "circuit: {deck: marked}\n"
                                                          "run: {until: 2 ms}\n");
  write_file("there/share/vibrospice/marked.cir", "*$ port mains = Vm\n*$ probe v_b = v(b) V\n"
                                                  "Vm a 0 external\nR1 a b 100\nXeva b 0 eva\n");
  EXPECT_SAYS("list scenes", "share/vibrospice/scenes/marker.yaml");
  EXPECT_SAYS("list decks", "share/vibrospice/marked.cir");
  EXPECT_SAYS("run marker --all", "\n  v_b ");
}

/* Nothing is off as installed; what is wrong in an installed file is. */
static void validation(void) {
  static const struct {
    const char *word, *file, *from, *to;
  } ROWS[] = {
      {"half sine", "validate/half_sine.cir", "peak = 100 A", "peak = 101 A"},
      {"circuit as switched, bare: peak current", "eva.inc", "lam x neg 1\n", "lam x neg 1.001\n"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char words[100], path[100];
    snprintf(words, sizeof words, "validate '%s'", ROWS[k].word);
    snprintf(path, sizeof path, "there/share/vibrospice/%s", ROWS[k].file);
    EXPECT_SAYS(words, "1 check, 0 off");
    alter(path, ROWS[k].from, ROWS[k].to);
    ran r = run_installed(words);
    EXPECT(r.status == 1 && strstr(r.out, "OFF ") && strstr(r.err, "1 of 1 off"),
           "%s: status %d: %s%s", words, r.status, r.out, r.err);
    free_ran(&r);
    alter(path, ROWS[k].to, ROWS[k].from);
  }
}

/* A deck's default, a part's default, the EVA's subcircuit: each alone shows. */
static void the_installed_copies_are_used(void) {
  alter("there/share/vibrospice/halfwave_snubbed.cir", "r1 = 100 ohm", "r1 = 123 ohm");
  EXPECT_SAYS("run paper --tier circuit --set run.until=2ms --json",
              "\"r1\": {\"value\": 123, \"unit\": \"ohm\"}");
  alter("there/share/vibrospice/parts/latch.inc", "on_voltage = 1 V", "on_voltage = 1.5 V");
  EXPECT_SAYS("run paper --tier circuit --set run.until=2ms --json",
              "\"on_voltage\": {\"value\": 1.5, \"unit\": \"V\"}");
  alter("there/share/vibrospice/eva.inc", "lam x neg 1\n", "lam x neg 2\n");
  ran r = run_installed(
      "run paper --tier circuit --set run.until=10ms"); /* as if of half the inductance */
  EXPECT(r.status == 1 && strstr(r.err, "the energy books (eva) leave"), "%s", r.err);
  free_ran(&r);
}

/* The files are looked up beside the program itself, not beside the name it is called by. */
static void by_another_name(void) {
  static const char *const ARGV[] = {"vs", "list", "scenes", NULL};
  char *const environment[] = {NULL};
  CU_ASSERT_EQUAL(symlink("there/bin/vibrospice", "vs"), 0);
  ran r = collect(spawn_other("./vs", ARGV, environment));
  EXPECT(r.status == 0 && strstr(r.out, "marker"), "status %d: %s%s", r.status, r.out, r.err);
  free_ran(&r);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"installing", installing},
      {"for another machine", for_another_machine},
      {"all of spice/ is there", all_of_spice_is_there},
      {"schemas are named", schemas_are_named},
      {"shipped scenes and decks run", shipped_scenes_and_decks_run},
      {"added files are found", added_files_are_found},
      {"by another name", by_another_name},
      {"validation", validation},
      {"the installed copies are used", the_installed_copies_are_used},
  };
  return program_suite("install", TESTS, COUNT(TESTS));
}
