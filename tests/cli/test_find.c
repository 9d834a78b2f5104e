/* SPDX-License-Identifier: GPL-3.0-or-later
 * Finding things: lists with a filter and as JSON, shortcuts of --set, a new scene, help by topic,
 * the keys of a section, and the schema, which must agree with check. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "base/json.h"
#include "program.h"

/* ---- list ---- */

/* How often the word stands in the text. */
static int times(const char *text, const char *word) {
  int n = 0;
  for (; (text = strstr(text, word)); text += strlen(word)) n++;
  return n;
}

/* What `list words` prints has the words in `has` and not `lacks`; NULL: whatever. */
static void expect_list(const char *words, const char *has, const char *lacks, int line) {
  ran r = run("list %s", words);
  expect_good(&r, words, line);
  expect(strstr(r.out, has), line, "list %s: no '%s' in %s", words, has, r.out);
  expect(!lacks || !strstr(r.out, lacks), line, "list %s: '%s' in %s", words, lacks, r.out);
  free_ran(&r);
}
#define LIST(words, has, lacks) expect_list(words, has, lacks, __LINE__)

static void lists_are_filtered(void) {
  LIST("tiers circuit", "circuit ", "analytic ");
  LIST("parameters ANGLE", "firing.angle ", "run.until");
  LIST("parameters carrier", "pwm.", "firing.angle");
  LIST("events voltage", "sag ", "missing_pulse");
  LIST("measures v_ak_max", "v_ak_min, v_ak_max", "i_peak");
  LIST("all snubber", "decks that come with", "tiers, from");
  LIST("parts BT151", "    limit v_drm", "    limit v_ces"); /* with the lines below it */
}

static void nothing_found_is_said(void) {
  ran of_path = run("list scenes scenes"); /* the folder of a file is none of its words */
  EXPECT(!*of_path.out && *of_path.err, "%s", of_path.out);
  free_ran(&of_path);
  ran r = run("list probes nonesuch");
  EXPECT(r.status == 0 && !*r.out && strstr(r.err, "nothing of probes has 'nonesuch'"), "%d %s %s",
         r.status, r.out, r.err);
  free_ran(&r);
  r = run("list all nonesuch --json");
  EXPECT(r.status == 0 && vs_json_is_whole(r.out) && strstr(r.err, "nothing of all"), "%d %s %s",
         r.status, r.out, r.err);
  EXPECT(times(r.out, ": []") == 15, "%s", r.out);
  free_ran(&r);
}

static void lists_as_json(void) {
  ran r = run("list --json"), lines = run("list parameters"), one;
  EXPECT(r.status == 0 && vs_json_is_whole(r.out), "%d %s", r.status, r.err);
  EXPECT(strstr(r.out, "{\"name\": \"firing.angle\", \"default\": \"100 deg\"") != NULL, "%s",
         r.out);
  free_ran(&r);
  one = run("list parameters --json");
  EXPECT(vs_json_is_whole(one.out), "%s", one.out);
  EXPECT(times(one.out, "{\"name\": ") == count_lines(lines.out), "%d entries, %d lines",
         times(one.out, "{\"name\": "), count_lines(lines.out));
  free_ran(&one);
  free_ran(&lines);
  LIST("probes v_ak --json",
       "{\"name\": \"v_ak\", \"unit\": \"V\", \"text\": \"anode-cathode voltage\", \"tier\": "
       "\"circuit\"}",
       "lambda");
  LIST("events sag --json", "\"keys\": [{\"key\": \"off\"", "swell");
  LIST("parts BT151-800R --json", "\"limits\": [{\"name\": \"v_drm\", \"value\": \"800 V\"", NULL);
}

/* ---- shortcuts ---- */

static void shortcuts_are_sets(void) {
  static const char *const PAIRS[][2] = {
      {"run paper --until 30ms --angle 95deg --tolerance 1e-3",
       "run paper --set run.until=30ms --set firing.angle=95deg --set run.tolerance=1e-3"},
      {"run paper --set run.until=9s --until 30ms", "run paper --until 30ms"}, /* the later one */
      {"steady paper --set firing.every=1 --angle 120deg --tolerance 1e-3",
       "steady paper --set firing.every=1 --set firing.angle=120deg --set run.tolerance=1e-3"}};
  for (size_t k = 0; k < COUNT(PAIRS); k++) {
    ran a = run("%s --json --quiet --reproducible", PAIRS[k][0]);
    ran b = run("%s --json --quiet --reproducible", PAIRS[k][1]);
    EXPECT(a.status == 0 && !strcmp(a.out, b.out), "%s: %d %s", PAIRS[k][0], a.status, a.err);
    free_ran(&a);
    free_ran(&b);
  }
  refuse("run paper --until 5", "until", "--set run.until=5", (const char *const[]){"'5 s'", NULL},
         __LINE__);
  refuse("run paper --angle 5s", "angle", "--set firing.angle=5s",
         (const char *const[]){"wrong unit", "deg"}, __LINE__);
}

/* ---- new ---- */

/* Runs check on the scene with the one '#' taken away that stands at `off`. */
static void check_with_key(char *scene, char *off) {
  memmove(off, off + 1, strlen(off));
  write_file("one.yaml", scene);
  ran r = run("check one.yaml --quiet");
  EXPECT(r.status == 0, "%.60s: %s", off, r.err);
  free_ran(&r);
  memmove(off + 1, off, strlen(off) + 1);
  *off = '#';
}

static void a_new_scene_runs(void) {
  ran r = run("new my.yaml");
  EXPECT(r.status == 0 && strstr(r.out, "my.yaml"), "%s", r.err);
  free_ran(&r);
  ran a = run("run my.yaml --until 20ms --json --quiet --reproducible");
  ran b = run("run paper --set measured={} --until 20ms --json --quiet --reproducible");
  const char *of_a = strstr(a.out, "\"tier\""), *of_b = strstr(b.out, "\"tier\"");
  EXPECT(a.status == 0 && of_a && of_b, "%s%s", a.err, b.err);
  free_ran(&a);
  free_ran(&b);
  r = run("new my.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "there already"), "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("new my");
  EXPECT(r.status == 2 && strstr(r.err, ".yaml"), "%d %s", r.status, r.err);
  free_ran(&r);
}

/* Each key on its own, at its default, is one that check takes; but for those of another
 * law, and those of the section measure, where 0 stands for nothing. */
static void its_keys_are_good(void) {
  ran r = run("new keys.yaml --quiet");
  char *scene = read_file("keys.yaml");
  int keys = 0;
  EXPECT(!*r.out && !*r.err, "%s%s", r.out, r.err);
  free_ran(&r);
  for (char *s = scene; (s = strstr(s, "\n  #")); s += 4) {
    char *end = strchr(s + 1, '\n'), *other = strstr(s, "law moving_coil"),
         *window = strstr(s, "\nmeasure:");
    if (!window || (other && other < end)) continue;
    check_with_key(scene, s + 3);
    keys++;
  }
  EXPECT(keys > 70, "%d keys", keys);
  free(scene);
}

static void a_new_scene_of_a_machine(void) {
  ran r = run("new other.yaml --machine two_mass --deck chopper");
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  r = run("check other.yaml");
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  char *scene = read_file("other.yaml");
  EXPECT(strstr(scene, "\n  model: two_mass ") && strstr(scene, "\n  deck: chopper "), "%s", scene);
  free(scene);
  r = run(
      "new coil.yaml --machine lds_v203"); /* whose coil no thyristor drives, as its file says */
  EXPECT(r.status == 0 && !strstr(r.out, "mend this"), "%d %s", r.status, r.out);
  free_ran(&r);
  write_file("own.yaml", "title: own\ncoordinates: {x: {unit: m}}\nmass: 3 kg\n"
                         "stiffness: 3e5 N/m\ngap: {along: {x: 1}}\n");
  r = run("new own_scene.yaml --machine own.yaml"); /* which does not say what feeds it */
  EXPECT(r.status == 0 && strstr(r.out, "before it runs, mend this: own_scene.yaml:") &&
             strstr(r.out, "supply: {voltage: ... V}"),
         "%d %s", r.status, r.out);
  free_ran(&r);
  refuse("new third.yaml --deck nonesuch", "deck", "", (const char *const[]){"nonesuch", NULL},
         __LINE__);
}

/* ---- keys ---- */

static void a_misspelt_key_names_all(void) {
  refuse("run paper --set firing.angel=3deg", "key", "--set firing.angel=3deg",
         (const char *const[]){"did you mean 'angle'? it has: valve, angle, pulse_width", NULL},
         __LINE__);
  refuse("run paper --set load.xyz=3", "key", "--set load.xyz=3",
         (const char *const[]){"'xyz'; it has: density, volume", NULL}, __LINE__);
}

/* ---- help ---- */

static void every_topic_has_help(void) {
  ran all = run("help"), one;
  char *at = strstr(all.out, "Topics of"), *rest = at ? strchr(at, '\n') + 1 : NULL, name[32];
  int topics = 0;
  CU_ASSERT_PTR_NOT_NULL_FATAL(rest);
  for (char *line; (line = strsep(&rest, "\n"));) {
    if (sscanf(line, "%31s", name) != 1) continue;
    one = run("help %s", name);
    EXPECT(one.status == 0 && *one.out && !*one.err, "help %s: %d %s", name, one.status, one.err);
    free_ran(&one);
    topics++;
  }
  EXPECT(topics > 30, "%d topics", topics);
  free_ran(&all);
}

static void help_says_what_the_tables_say(void) {
  static const char *const ROWS[][2] = {
      {"firing", "firing.angle "},
      {"exit", " 75  stopped by a signal"},
      {"check", "Usage: vibrospice check"},
      {"run", "\nrun.until "}, /* command and section */
      {"control", "control.rate "},
      {"tiers", "switched "},
      {"steady", "\nOver one period it reports, besides the measures of every run:\n  power_in "},
      {"control", "control.observer.kind "},
      {"control.observer", "control.observer.kind "}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("help %s", ROWS[k][0]);
    EXPECT(strstr(r.out, ROWS[k][1]), "help %s: %s", ROWS[k][0], r.out);
    free_ran(&r);
  }
  refuse("help fireng", "topic", "", (const char *const[]){"'fireng'", "'firing'"}, __LINE__);
}

/* ---- schema ---- */

/* The script holds the schemas against check, file by file. Packages of Debian's are Debian's
 * python's, which need not be the first on the path. 77: python or its packages are missing. */
static void schema_and_check_agree(void) {
  static const char *const PYTHONS[] = {"python3", "/usr/bin/python3"};
  char command[512];
  int status = is_for_memory_alone() ? 0 : 77; /* 300 calls of check that others make, too */
  ran r;
  for (size_t k = 0; k < COUNT(PYTHONS) && status == 77; k++) {
    snprintf(
        command, sizeof command,
        "command -v %s >/dev/null || exit 77; %s %s/cli/schema_agrees.py %s %s/../spice >../agrees "
        "2>&1",
        PYTHONS[k], PYTHONS[k], VS_TEST_FOLDER, VS_PROGRAM, VS_TEST_FOLDER);
    status = system(command);
    status = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  }
  char *said = status && status != 77 ? read_file("../agrees") : vs_copy("");
  EXPECT(status == 0 || status == 77, "%s", said);
  if (status == 77) puts("    left out: python3-jsonschema or python3-yaml is missing");
  free(said);
  r = run("schema study");
  EXPECT(r.status == 0 && vs_json_is_whole(r.out) && strstr(r.out, "\"firing.angle\""), "%s",
         r.err);
  free_ran(&r);
  r = run("schema machine");
  EXPECT(r.status == 0 && vs_json_is_whole(r.out) && strstr(r.out, "\"coordinates\""), "%s", r.out);
  free_ran(&r);
  r = run("schema scene --deck chopper");
  EXPECT(r.status == 0 && strstr(r.out, "\"deck\""), "%s", r.err);
  free_ran(&r);
  refuse("schema deck", "kind", "", (const char *const[]){"'deck'", "machine"}, __LINE__);
}

static void shells_complete(void) {
  ran r = run("completion bash");
  write_file("vibrospice.bash", r.out);
  EXPECT(strstr(r.out, " sensitivity ") && strstr(r.out, "--until"), "%s", r.out);
  free_ran(&r);
  EXPECT(!on_path("bash") || !system("bash -n vibrospice.bash"), "bash refuses it");
  EXPECT(!on_path("bash") ||
             !system("bash -c '. ./vibrospice.bash; COMP_WORDS=(vibrospice study --format n); "
                     "COMP_CWORD=3; _vibrospice; [ \"${COMPREPLY[*]}\" = npy ]'"),
         "bash does not complete the words of --format");
  r = run("completion fish");
  EXPECT(strstr(r.out, "from run' -l until -r -d ") &&
             strstr(r.out, "from merge' -l format -r -f -a 'csv csv.zst npy' -d "),
         "%s", r.out);
  free_ran(&r);
  r = run("completion zsh");
  write_file("_vibrospice", r.out);
  EXPECT(!strncmp(r.out, "#compdef vibrospice\n", 20) &&
             strstr(r.out, "    run) _arguments '--set[") &&
             strstr(r.out, "]:format:(csv csv.zst npy)'"),
         "%s", r.out);
  free_ran(&r);
  EXPECT(!on_path("zsh") || !system("zsh -n _vibrospice"), "zsh refuses it");
  refuse("completion csh", "shell", "", (const char *const[]){"'csh'", "bash"}, __LINE__);
}

/* The manual page has every command, and groff, where it is, has no complaint. */
static void the_manual_page(void) {
  ran r = run("help man");
  EXPECT(r.status == 0 && strstr(r.out, "\n.SS vibrospice sensitivity SCENE\n") &&
             strstr(r.out, "\\fB\\-\\-until\\fR=\\fIT\\fR") &&
             strstr(r.out, "\n.PP\nExamples:\n.PP\n.nf\n  vibrospice run paper "),
         "%s", r.out);
  write_file("vibrospice.1", r.out);
  free_ran(&r);
  EXPECT(!on_path("groff") ||
             !system("groff -man -Tutf8 -ww vibrospice.1 2>said >/dev/null && ! grep -q . said"),
         "groff complains");
}

static const vs_test TESTS[] = {
    {"the manual page", the_manual_page},
    {"shells complete", shells_complete},
    {"schema and check agree", schema_and_check_agree},
    {"every topic has help", every_topic_has_help},
    {"help says what the tables say", help_says_what_the_tables_say},
    {"a new scene runs", a_new_scene_runs},
    {"its keys are good", its_keys_are_good},
    {"a new scene of a machine", a_new_scene_of_a_machine},
    {"a misspelt key names all", a_misspelt_key_names_all},
    {"lists are filtered", lists_are_filtered},
    {"nothing found is said", nothing_found_is_said},
    {"lists as JSON", lists_as_json},
    {"shortcuts are --set", shortcuts_are_sets},
};

int main(void) {
  return program_suite("find", TESTS, COUNT(TESTS));
}
