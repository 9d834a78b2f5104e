/* SPDX-License-Identifier: GPL-3.0-or-later
 * A stranger's folder of results: whatever its files say, plot, compare and merge show it as text,
 * read nothing outside of the folder, and take no more memory than a table needs. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/compressed.h"
#include "program.h"

/* Gives every text of a file of JSON an end that a page, a terminal or gnuplot would obey. */
static void spoil_texts(const char *from, const char *to) {
  static const char ESCAPED[] =
      "<script>alert(1)</script>\\u001b[31m\\u009b\\u202e`id`'\\\" system(1)";
  char *text = read_file(from);
  vs_text out = {0};
  bool inside = false;
  for (const char *s = text; *s; s++) {
    const bool quote = *s == '"' && (s == text || s[-1] != '\\');
    const bool value = quote && inside && s[1] != ':';
    if (value) vs_text_add(&out, "%s", ESCAPED);
    if (quote) inside = !inside;
    vs_text_add(&out, "%c", *s);
  }
  write_file(to, out.text);
  vs_text_free(&out);
  free(text);
}

static void expect_harmless(const char *text, const char *what, int line) {
  expect(!strstr(text, "<script>alert"), line, "%s has a script", what);
  expect(!strchr(text, '\x1b') && !strstr(text, "\xc2\x9b") && !strstr(text, "\xe2\x80\xae"), line,
         "%s has a byte that is obeyed", what);
}

static void expect_page(const char *path, int line) {
  char *page = read_file(path);
  expect(strstr(page, "&lt;script&gt;") != NULL, line, "%s does not show the text", path);
  expect_harmless(page, path, line);
  free(page);
}

/* Every field of a run's files on its page, in its pictures and in what compare says. */
static void a_strangers_run(void) {
  RUN_GOOD("run paper --set run.until=60ms -o good --quiet");
  RUN_GOOD("run paper --set run.until=60ms -o bad --quiet");
  spoil_texts("good/summary.json", "bad/summary.json");
  write_file("bad/events.csv",
             "t_s,what\n0.02,<script>alert(1)</script>\x1b[31m`id`'' begins (x\n");
  ran r = run("plot bad --quiet");
  EXPECT(r.status == 0, "%d: %s", r.status, r.err);
  expect_harmless(r.err, "plot", __LINE__);
  free_ran(&r);
  expect_page("bad/report.html", __LINE__);
  r = run("compare good bad");
  EXPECT(r.status == 0 && strstr(r.out, "\\u001b"), "%d: %s", r.status, r.err);
  EXPECT(!strchr(r.out, '\x1b') && !strstr(r.out, "\xc2\x9b"), "%s", r.out);
  free_ran(&r);
  RUN_GOOD("compare good bad -o page --quiet");
  expect_page("page/report.html", __LINE__);
  write_file("bad/run.csv", "t_s,i_a\n0,0\n0.1,\x1b[31m\xc2\x9b\n");
  r = run("compare good bad");
  EXPECT(r.status == 2 && strstr(r.err, "bad/run.csv:3:5: ") && !strchr(r.err, '\x1b') &&
             !strstr(r.err, "\xc2\x9b"),
         "%d: %s", r.status, r.err);
  free_ran(&r);
  remove_tree("page");
  remove_tree("bad");
  remove_tree("good");
}

/* The class of a limit is a text of summary.json and names no data of gnuplot's. */
static void a_strangers_harmonics(void) {
  RUN_GOOD("run paper --set run.until=60ms -o h --quiet");
  write_file(
      "h/summary.json",
      "{\"quality\": {\"i\\n' x\": {\"harmonics_A\": [0, 1, 0.5], \"classes\": [{\"class\": \"A "
      "<< EOD\\nEOD\\nsystem('touch pwned')\\n\", \"limits_A\": [0, 1, 2]}, {\"limits_A\": [0, "
      "1]}]}}}\n");
  ran r = run("plot h --quiet");
  EXPECT(r.status == 0, "%d: %s", r.status, r.err);
  CU_ASSERT(access("pwned", F_OK) && !access("h/harmonics.png", F_OK));
  free_ran(&r);
  remove_tree("h");
}

/* gnuplot 5.4 takes two single quotes at a string's begin for an empty one, and in a file's name
 * for one. */
static void quotes_in_names(void) {
  if (is_for_memory_alone()) return;
  static const char *const NAMES[] = {"'90s", "a''b", "a`touch pwned`", "$(id)\\101", "\"x\"", "~"};
  char path[128];
  for (size_t k = 0; k < COUNT(NAMES); k++) {
    const char *const make[] = {VS_PROGRAM, "run",    "paper",   "--set", "run.until=60ms",
                                "-o",       NAMES[k], "--quiet", NULL};
    const char *const plot[] = {VS_PROGRAM, "plot", NAMES[k], "--quiet", NULL};
    ran made = collect(spawn(make)), drawn = collect(spawn(plot));
    EXPECT(!made.status && !drawn.status && !*drawn.err, "%s: %d %s", NAMES[k], drawn.status,
           drawn.err);
    snprintf(path, sizeof path, "%s/report.html", NAMES[k]);
    CU_ASSERT(!access(path, F_OK) && access("pwned", F_OK));
    free_ran(&made);
    free_ran(&drawn);
    remove_tree(NAMES[k]);
  }
}

/* Each of a study's texts. */
static void a_strangers_study(void) {
  write_file("a.yaml",
             "set: {run.until: 20 ms}\nvary: {firing.angle: [90 deg, 95 deg, 100 deg]}\n");
  RUN_GOOD("study a.yaml -o s --quiet");
  RUN_GOOD("study a.yaml -o good --quiet");
  spoil_texts("good/manifest.json", "s/manifest.json");
  char *manifest = read_file("s/manifest.json");
  vs_text mended = {0}; /* what names columns stays as it is */
  for (const char *s = manifest; *s;) {
    static const char *const KEPT[] = {"\"column\": \"", "\"method\": \"", "\"key\": \"",
                                       "\"name\": \""};
    size_t n = 0;
    for (size_t k = 0; k < COUNT(KEPT); k++)
      if (!strncmp(s, KEPT[k], strlen(KEPT[k]))) n = strlen(KEPT[k]);
    if (n) {
      const size_t word = strcspn(s + n, "<");
      vs_text_add(&mended, "%.*s\"", (int)(n + word), s);
      s = strstr(s, "system(1)") + strlen("system(1)\"");
    } else
      vs_text_add(&mended, "%c", *s++);
  }
  write_file("s/manifest.json", mended.text);
  ran r = run("plot s --quiet");
  EXPECT(r.status == 0, "%d: %s", r.status, r.err);
  expect_harmless(r.err, "plot", __LINE__);
  free_ran(&r);
  expect_page("s/report.html", __LINE__);
  r = run("compare good s");
  expect_harmless(r.out, "compare", __LINE__);
  expect_harmless(r.err, "compare", __LINE__);
  free_ran(&r);
  vs_text_free(&mended);
  free(manifest);
  remove_tree("s");
  remove_tree("good");
  unlink("a.yaml");
}

/* Thirty kilobytes that say a gigabyte: as one line, and to whoever reads on. */
static void too_much(void) {
  static char block[1 << 20], read[1 << 16];
  write_file("a.yaml", "set: {run.until: 20 ms}\nvary: {firing.angle: [90 deg, 95 deg]}\n");
  RUN_GOOD("study a.yaml -o s --quiet");
  CU_ASSERT(!unlink("s/study.csv"));
  FILE *f = fopen("s/study.csv.zst", "w"), *packed = vs_compressed_write(f, "study.csv.zst");
  vs_error err = {0};
  memset(block, 'x', sizeof block);
  for (int k = 0; k < 1 << 10; k++) fwrite(block, 1, sizeof block, packed);
  CU_ASSERT(!vs_compressed_end(packed, f, "x", &err));
  fclose(f);
  ran r = run("plot s --quiet");
  EXPECT(r.status == 2 && strstr(r.err, "s/study.csv.zst:1:1: a row of more than 1048576 bytes"),
         "%d %s", r.status, r.err);
  free_ran(&r);
  f = vs_compressed_read(fopen("s/study.csv.zst", "r"), "study.csv.zst");
  size_t n = 0, all = 0;
  while ((n = fread(read, 1, sizeof read, f)) > 0) all += n;
  EXPECT(ferror(f) && strstr(vs_compressed_strerror(errno), "256 times") && all < 40u << 20,
         "%zu: %s", all, vs_compressed_strerror(errno));
  fclose(f);
  remove_tree("s");
  unlink("a.yaml");
}

/* Links of both kinds out of a folder of results, and what would keep its reader waiting. */
static void ways_out_of_results(void) {
  static const char *const FILES[] = {"run.csv", "events.csv", "summary.json"};
  static const char *const COMMANDS[] = {"plot r --quiet", "compare r r --quiet"};
  static const char *const SAYS[] = {"lies at /", "is a hard link", "a pipe"};
  write_file("secret", "xyzzy,1\n");
  RUN_GOOD("run paper --set run.until=60ms -o r --quiet");
  for (size_t k = 0; k < COUNT(FILES) * 3 * COUNT(COMMANDS); k++) {
    const char *file = FILES[k % 3], *command = COMMANDS[k / 9];
    const size_t kind = k / 3 % 3;
    char path[64];
    snprintf(path, sizeof path, "r/%s", file);
    if (k % 3 == 1 && k / 9) continue; /* compare reads no events */
    CU_ASSERT(!rename(path, "kept"));
    CU_ASSERT(!(kind == 0   ? symlink("../secret", path)
                : kind == 1 ? link("secret", path)
                            : mkfifo(path, 0666)));
    ran r = run("%s", command);
    EXPECT(r.status == 2 && strstr(r.err, path) && strstr(r.err, SAYS[kind]) &&
               !strstr(r.err, "xyzzy"),
           "%s %s: %d %s", command, path, r.status, r.err);
    free_ran(&r);
    CU_ASSERT(!rename("kept", path));
  }
  remove_tree("r");
  unlink("secret");
}

/* A netlist's line that includes a pipe has its place in the message, in the jail and out of it. */
static void a_pipe_in_a_netlist(void) {
  static const char *const WORDS[] = {"check d.cir", "check d.cir --no-jail"};
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  vs_text deck = {0};
  vs_text_add(&deck, "t\n.include f.inc\n%s", text);
  write_file("d.cir", deck.text);
  CU_ASSERT(!mkfifo("f.inc", 0666));
  for (size_t k = 0; k < COUNT(WORDS); k++) {
    ran r = run("%s", WORDS[k]);
    EXPECT(r.status == 2 && strstr(r.err, "d.cir:2:") && strstr(r.err, "a pipe"), "%d %s", r.status,
           r.err);
    free_ran(&r);
  }
  vs_text_free(&deck);
  free(text);
  unlink("f.inc");
  unlink("d.cir");
}

int main(void) {
  static const vs_test TESTS[] = {
      {"a stranger's run", a_strangers_run},
      {"a stranger's harmonics", a_strangers_harmonics},
      {"quotes in names", quotes_in_names},
      {"a stranger's study", a_strangers_study},
      {"more than there is", too_much},
      {"ways out of results", ways_out_of_results},
      {"a pipe in a netlist", a_pipe_in_a_netlist},
  };
  return program_suite("results", TESTS, COUNT(TESTS));
}
