/* SPDX-License-Identifier: GPL-3.0-or-later
 * A journal's rows are rows of its study: those whose sum is right, but that hold something else
 * than their header says, or a second answer for one case, are refused with their place. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/hash.h"
#include "program.h"

static void add_line(vs_text *journal, const char *line) {
  vs_text_add(journal, "%08x %s\n", vs_hash_crc32(line, strlen(line)), line);
}

/* The head of the study in "s", then these lines up to a NULL. */
static void write_journal(const char *head, const char *const *rows) {
  vs_text journal = {0};
  vs_text_add(&journal, "%s", head);
  for (; *rows; rows++) add_line(&journal, *rows);
  write_file("j/journal", journal.text);
  vs_text_free(&journal);
}

/* Of the study's own journal: its head; free() it. */
static char *head_of(const char *path) {
  char *text = read_file(path), *row = strstr(text, " = ");
  CU_ASSERT_PTR_NOT_NULL_FATAL(row);
  while (row > text && row[-1] != '\n') row--;
  *row = '\0';
  row[-1] = '\0'; /* the last line says on what the rows behind it were made */
  row = strrchr(text, '\n') + 1;
  EXPECT(strstr(row, " m ") && strstr(row, ", libm "), "%s", row);
  *row = '\0';
  return text;
}

static void make_study(void) {
  write_file("a.yaml", "set: {run.until: 20 ms, run.tier: switched}\n"
                       "vary: {firing.angle: [100 deg, 110 deg], circuit.deck: "
                       "[halfwave_snubbed]}\nreport: [i_peak]\n");
  RUN_GOOD("study a.yaml -o s --quiet");
  mkdir("j", 0777);
}

/* Goes on with the study whose journal is j/journal, which must be refused. */
static void refuse_to_go_on(const char *study, const char *what, const char *says, int line) {
  char words[64];
  snprintf(words, sizeof words, "study %s -o j --resume", study);
  refuse(words, what, "j/journal:1:1: ", (const char *[]){says, NULL}, line);
}

/* The line of s/journal that has this case's row, without its sum; free() it. */
static char *row_of(const char *path, int index) {
  char *text = read_file(path), begin[32];
  snprintf(begin, sizeof begin, " = %d,", index);
  char *row = strstr(text, begin);
  CU_ASSERT_PTR_NOT_NULL_FATAL(row);
  row[strcspn(row, "\n")] = '\0';
  char *copy = strdup(row + 1);
  free(text);
  return copy;
}

/* Runs the command, whose journals say on what their rows were made, and returns what it prints on
 * standard error; free() it. */
static char *warned(const char *words) {
  ran r = run("%s", words);
  EXPECT(r.status == 0, "%s: %s", words, r.err);
  char *err = strdup(r.err);
  free_ran(&r);
  return err;
}

/* A journal says on what its rows were made. Where cases are done on something else, a study that
 * goes on warns and says so in its manifest; merge does, too. */
static void rows_of_other_bits(void) {
  static const char OTHER[] = "m vax, libm 00000000, glibc 1.0, ngspice 39, GSL 2.7.1";
  char *head = head_of("s/journal"), *zero = row_of("s/journal", 0), *one = row_of("s/journal", 1);
  write_journal(head, (const char *[]){OTHER, zero, NULL});
  char *err = warned("study a.yaml -o j --resume");
  EXPECT(strstr(err, "j/journal: its rows are made on vax, libm 00000000") &&
             strstr(err, "Columns at risk: i_peak_a, margin_least, "),
         "%s", err);
  char *manifest = read_file("j/manifest.json"), *journal = read_file("j/journal");
  char *list = strstr(manifest, "\"computed_on\": [");
  EXPECT(list && strstr(list, "\"vax, libm"), "%s", manifest);
  char *added = strstr(journal, " = 0,");
  EXPECT(added && strstr(added, " m "), "no line before the new row: %s", journal);
  free(err), free(manifest), free(journal);

  err = warned("study a.yaml -o j --resume"); /* nothing is left to be done */
  EXPECT(!*err, "%s", err);
  free(err);
  write_journal(head, (const char *[]){OTHER, zero, one, NULL});
  err = warned("merge j -o joined"); /* all on one other machine */
  EXPECT(!*err, "%s", err);
  free(err);
  RUN_GOOD("study a.yaml -o one --shard 1/2 --quiet");
  RUN_GOOD("study a.yaml -o two --shard 2/2 --quiet");
  free(head), head = head_of("two/journal");
  char *row = row_of("two/journal", 1);
  write_journal(head, (const char *[]){OTHER, row, NULL});
  err = warned("merge one j -o joined --overwrite");
  EXPECT(strstr(err, "joined: its rows are made on "), "%s", err);
  manifest = read_file("joined/manifest.json");
  EXPECT(strstr(manifest, "\"computed_on\": ["), "%s", manifest);
  free(err), free(manifest), free(row), free(head), free(zero), free(one);
}

#if defined __x86_64__ && defined __GLIBC__
/* glibc takes other functions where the processor seems to have no fused multiply-add: what names
 * them differs. A processor that has none always takes these. */
static void other_functions(void) {
  if (!__builtin_cpu_supports("fma")) return;
  setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable", 1);
  RUN_GOOD("study a.yaml -o without --quiet");
  unsetenv("GLIBC_TUNABLES");
  char *with = read_file("s/journal"), *without = read_file("without/journal");
  char *one = strstr(with, ", libm "), *other = strstr(without, ", libm ");
  CU_ASSERT_FATAL(one && other);
  EXPECT(strncmp(one, other, 15), "%.15s is %.15s", one, other);
  free(with), free(without);
}
#endif

/* The program has the plan where it goes on: a row whose id or axes are those of another case is
 * none of this one's. */
static void rows_of_other_cases(void) {
  char *head = head_of("s/journal"), *zero = row_of("s/journal", 0), *one = row_of("s/journal", 1);
  char *moved = strdup(zero), *measures = strstr(one, ",110,");
  CU_ASSERT_PTR_NOT_NULL_FATAL(measures);
  moved[2] = '1'; /* case 0 under the index 1 */
  write_journal(head, (const char *[]){zero, moved, NULL});
  refuse_to_go_on("a.yaml", "moved", "case 1: its firing.angle_deg is 110; its row has '100'",
                  __LINE__);
  vs_text other = {0};
  vs_text_add(&other, "= 1,%.16s%s", zero + 4, measures); /* case 0's id */
  write_journal(head, (const char *[]){zero, other.text, NULL});
  refuse_to_go_on("a.yaml", "id", "case 1: its id is '", __LINE__);
  other.length = 0; /* another machine may round the last digit otherwise, and has another id */
  vs_text_add(&other, "= 1,0123456789abcdee,110.000000001%s", measures + 4);
  write_journal(head, (const char *[]){zero, other.text, NULL});
  RUN_GOOD("study a.yaml -o j --resume --quiet");
  write_journal(head, (const char *[]){zero, one, NULL});
  RUN_GOOD("study a.yaml -o j --resume --quiet");
  remove_tree("j");
  mkdir("j", 0777);
  vs_text_free(&other);
  free(head), free(zero), free(one), free(moved);
}

/* A search asks for its cases by the results so far, and so do the rows of the journal. */
static void rows_of_a_search(void) {
  write_file("w.yaml", "set: {run.until: 20 ms, run.tier: switched}\n"
                       "vary: {firing.angle: {lin: [90 deg, 120 deg], n: 4}, supply.voltage: "
                       "{lin: [400 V, 440 V], n: 4}}\nfind: {worst: max i_peak}\n");
  RUN_GOOD("study w.yaml -o w --quiet");
  char *text = read_file("w/journal"), *row = strstr(text, " = 1,"), *end = strchr(row, '\n');
  CU_ASSERT_PTR_NOT_NULL_FATAL(row);
  vs_text journal = {0};
  char line[1024], *second = strchr(strchr(row, ',') + 1, ',') + 1;
  vs_text_add(&journal, "%.*s", (int)(row - 8 - text), text);
  snprintf(line, sizeof line, "= 1,0123456789abcdef,95.5%.*s", (int)(end - strchr(second, ',')),
           strchr(second, ','));
  add_line(&journal, line);
  vs_text_add(&journal, "%s", end + 1);
  write_file("j/journal", journal.text);
  refuse_to_go_on("w.yaml", "search", "case 1: its firing.angle_deg is ", __LINE__);
  journal.length = 0; /* a case behind the last one */
  vs_text_add(&journal, "%s", text);
  snprintf(line, sizeof line, "= 5000,%.*s", (int)(end - strchr(row, ',') - 1),
           strchr(row, ',') + 1);
  add_line(&journal, line);
  write_file("j/journal", journal.text);
  refuse_to_go_on("w.yaml", "search", "and the study ", __LINE__);
  write_file("j/journal", text);
  RUN_GOOD("study w.yaml -o j --resume --quiet");
  remove_tree("j");
  mkdir("j", 0777);
  remove_tree("w");
  vs_text_free(&journal);
  free(text);
}

#define GOOD_0 "= 0,0123456789abcdef,100,halfwave_snubbed,0.84,,,,0,0,,,,0"
#define GOOD_1 "= 1,0123456789abcdee,110,halfwave_snubbed,0.70,,,,0,0,,,,0"

/* The head has 7 lines, so that the first row is line 8. */
static void rows_of_another_shape(void) {
  static const struct {
    const char *row, *at, *says;
  } BAD[] = {
      {"= 1,x,110,halfwave_snubbed,0.70,,,,0,0,,,0", ":9:12: ", "cells in this row: 13"},
      {"= 1,x,110,halfwave_snubbed,0.70,,,,0,0,,,,0,0", ":9:12: ", "columns in its header: 14"},
      {"= 1", ":9:12: ", "cells in this row: 1;"},
      {"= 1,x,110,halfwave_snubbed,lots,,,,0,0,,,,0", ":9:37: ", "'lots'; a number or nothing"},
      {"= 1,x,110,halfwave_snubbed,nan,,,,0,0,,,,0", ":9:37: ", "'nan'"},
      {"= 1,x,110,halfwave_snubbed,0x1p3,,,,0,0,,,,0", ":9:37: ", "'0x1p3'"},
      {"= 1,x,110,halfwave_snubbed,1e999,,,,0,0,,,,0", ":9:37: ", "'1e999'"},
      {"= 1,x,wide,halfwave_snubbed,0.70,,,,0,0,,,,0", ":9:16: ", "'wide'; a number"},
      {"= 1,x,,halfwave_snubbed,0.70,,,,0,0,,,,0", ":9:16: ", "firing.angle_deg"},
      {"= 1,x,110,,0.70,,,,0,0,,,,0", ":9:20: ", "circuit.deck holds ''; a word"},
      {"= 1,x,110,halfwave_snubbed,0.70,,,,-1,0,,,,0", ":9:45: ", "rung holds '-1'"},
      {"= 1,x,110,halfwave_snubbed,0.70,,,,0,0,,,,2", ":9:52: ", "status 0 or 3"},
      {"= 1,x,110,halfwave_snubbed,0.70,,,,0,0,,,,held", ":9:52: ", "'held'"},
      {"= 1,x,110,halfwave_snubbed,0.70,,,,0,0,,,,1", ":9:52: ", "status 0 or 3"},
      {"! 1,x,110,halfwave_snubbed,0,it did not", ":9:37: ", "status 1"},
      {"! 1,x,110,halfwave_snubbed,1", ":9:12: ", "cells in this row: 5"},
      {"= one,x,110,halfwave_snubbed,0.70,,,,0,0,,,,0", ":9:12: ", "'one'; a whole number"},
      {"= 01,x,110,halfwave_snubbed,0.70,,,,0,0,,,,0", ":9:12: ", "'01'"},
      {"= -1,x,110,halfwave_snubbed,0.70,,,,0,0,,,,0", ":9:12: ", "'-1'"},
      /* what another reader of study.csv would cut otherwise */
      {"= 1,x,110,halfwave_snubbed,0.70,,,,0,0,,,,\"0", ":9:52: ", "no closing quote"},
      {"= 1,x,110,halfwave_snubbed,0.70,,,,0,0,,,\",0", ":9:51: ", "no closing quote"},
      {"= 1,x,110,halfwave_snubbed,0.70,,,,0,0,,,,\"0\"0", ":9:52: ", "a comma is wanted"},
      {"= 1,x,110,halfwave_snubbed,0.70,,,,0,0,,,a\rb,0", ":9:52: ", "a line end"},
      /* cases that the study, of two cases, does not have */
      {"= 2,x,110,halfwave_snubbed,0.70,,,,0,0,,,,0", ":9:12: ", "its case is none"},
      {"= 18446744073709551617,x,110,halfwave_snubbed,0.70,,,,0,0,,,,0", ":9:12: ", "its case is"},
      {"! 4294967296,x,110,halfwave_snubbed,1,it did not", ":9:12: ", "its case is none"},
  };
  char *head = head_of("s/journal");
  for (size_t k = 0; k < COUNT(BAD); k++) {
    char at[64];
    snprintf(at, sizeof at, "j/journal%s", BAD[k].at);
    write_journal(head, (const char *[]){GOOD_0, BAD[k].row, NULL});
    refuse("merge j -o m", BAD[k].row, at, (const char *[]){BAD[k].says, NULL}, __LINE__);
  }
  /* what goes on with it does not take it either */
  write_journal(head, (const char *[]){GOOD_0, BAD[0].row, NULL});
  refuse("study a.yaml -o j --resume", "resume",
         "j/journal:9:12: ", (const char *[]){"cells in this row", NULL}, __LINE__);
  free(head);
}

/* Two answers for one case are none; the same one twice is one. */
static void two_rows_of_a_case(void) {
  static const char *const OTHER[] = {"= 0,0123456789abcdef,100,halfwave_snubbed,0.85,,,,0,0,,,,0",
                                      "= 0,0123456789abcdef,100,halfwave_snubbed,0.84,,,,0,0,,,,3",
                                      "! 0,0123456789abcdef,100,halfwave_snubbed,1,it did not"};
  char *head = head_of("s/journal");
  for (size_t k = 0; k < COUNT(OTHER); k++) {
    write_journal(head, (const char *[]){GOOD_0, GOOD_1, OTHER[k], NULL});
    refuse("merge j -o m", OTHER[k],
           "j/journal:10:12: ", (const char *[]){"case 0 has another row", NULL}, __LINE__);
  }
  write_journal(head, (const char *[]){GOOD_0, GOOD_1, GOOD_0, NULL});
  RUN_GOOD("merge j -o m --quiet");
  char *csv = read_file("m/study.csv");
  EXPECT(count_lines(csv) == 3, "%s", csv);
  free(csv);
  remove_tree("m");
  free(head);
}

/* The head with `from` in the place of `to` in one of its lines, whose sum is made again; free()
 * it.
 */
static char *changed_head(const char *head, const char *from, const char *to) {
  vs_text all = {0}, line = {0};
  for (const char *s = head; *s; s += strcspn(s, "\n") + 1) {
    const char *end = s + strcspn(s, "\n"), *at = strstr(s, from);
    line.length = 0;
    if (at && at < end)
      vs_text_add(&line, "%.*s%s%.*s", (int)(at - s - 9), s + 9, to,
                  (int)(end - at - (ptrdiff_t)strlen(from)), at + strlen(from));
    else
      vs_text_add(&line, "%.*s", (int)(end - s - 9), s + 9);
    add_line(&all, line.text);
  }
  vs_text_free(&line);
  CU_ASSERT_STRING_NOT_EQUAL(all.text, head);
  return all.text;
}

/* Right sums over a head that is not the study's. */
static void heads_of_others(void) {
  static const struct {
    const char *from, *to, *says;
  } BAD[] = {{"columns=case,id,firing.angle_deg,circuit.deck,i_peak_a",
              "columns=case,id,firing.angle_deg,circuit.deck,i_rms_a", "line columns= of its head"},
             {"status,why", "status,when", "line failures= of its head"},
             {"counts=2 1 1", "counts=3 1 1", "line counts= of its head"},
             {"counts=2 1 1", "counts=0 1 1", "line counts= of its head"},
             {"counts=2 1 1", "counts=2 1 2", "is of shard 1/2"},
             {"\"unit\": \"A\"", "\"unit\": \"V\"", "line manifest_end= of its head"},
             {"\"seed\": 0", "\"seed\": 7", "line manifest_begin= of its head"}};
  static const char *const NO_JSON[][2] = {
      {"\"unit\": \"A\"", "\"unit\": \"A"}, {"\"unit\": \"A\"", "\"unit\": A"},
      {"\"axes\": [", "\"axes\": "},        {"\"seed\": 0", "\"seed\": 0}"},
      {"\"seed\": 0", "\"seed\": 01"},      {"\"seed\": 0", "\"seed\": 0,"}};
  char *head = head_of("s/journal");
  for (size_t k = 0; k < COUNT(BAD); k++) {
    char *changed = changed_head(head, BAD[k].from, BAD[k].to);
    write_journal(changed, (const char *[]){NULL});
    refuse_to_go_on("a.yaml", BAD[k].to, BAD[k].says, __LINE__);
    free(changed);
  }
  for (size_t k = 0; k < COUNT(NO_JSON); k++) {
    char *changed = changed_head(head, NO_JSON[k][0], NO_JSON[k][1]);
    write_journal(changed, (const char *[]){GOOD_0, GOOD_1, NULL});
    refuse("merge j -o m", NO_JSON[k][1],
           "j/journal:1:1: ", (const char *[]){"manifest.json", NULL}, __LINE__);
    free(changed);
  }
  free(head);
}

/* The same study under another name, and with names that hold what a journal writes otherwise. */
static void its_own_head(void) {
  write_file("b.yaml",
             "set: {run.until: 20 ms, run.tier: switched, events: {'a\\n\"b': {kind: sag, "
             "cycle: 1}}}\nvary: {'events.a\\n\"b.level': [40 %, 80 %]}\n"
             "report: [i_peak]\n");
  RUN_GOOD("study b.yaml -o b --quiet");
  char *csv = read_file("b/study.csv"), *manifest = read_file("b/manifest.json");
  RUN_GOOD("study ./b.yaml -o b --resume --quiet");
  char *again = read_file("b/study.csv"), *manifest_again = read_file("b/manifest.json");
  CU_ASSERT_STRING_EQUAL(csv, again);
  CU_ASSERT_STRING_EQUAL(manifest, manifest_again);
  RUN_GOOD("merge b -o m --quiet");
  free(again);
  again = read_file("m/study.csv");
  CU_ASSERT_STRING_EQUAL(csv, again);
  remove_tree("b"), remove_tree("m");
  free(csv), free(manifest), free(again), free(manifest_again);
}

/* A row is counted by what its cells say, with quotes around them or without. */
static void cells_in_quotes(void) {
  char *head = head_of("s/journal");
  write_journal(
      head, (const char *[]){GOOD_0, "= \"1\",x,110,halfwave_snubbed,0.7,,,,0,0,,,,\"3\"", NULL});
  ran r = run("merge j -o m --quiet");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  free_ran(&r);
  char *manifest = read_file("m/manifest.json");
  EXPECT(strstr(manifest, "\"violated\": 1"), "%s", manifest);
  free(manifest);
  remove_tree("m");
  free(head);
}

/* The rows that the program writes fit, whatever they hold: a failed case, a name with commas,
 * a verdict with its margins and errors. */
static void own_rows(void) {
  write_file("o.yaml", "set: {run.until: 40 ms, events: {'a,\"b': {kind: sag, cycle: 1}}}\n"
                       "vary: {'events.a,\"b.cycle': [1, 2], machine.trough_mass: [0.83 kg, 2 g]}\n"
                       "report: [p_min]\n");
  ran r = run("study o.yaml -o o --quiet");
  EXPECT(r.status == 1 || r.status == 0, "%d %s", r.status, r.err);
  free_ran(&r);
  char *csv = read_file("o/study.csv"), *failures = read_file("o/failures.csv");
  r = run("merge o -o n --quiet");
  EXPECT(r.status == 1 || r.status == 0, "%d %s", r.status, r.err);
  free_ran(&r);
  char *merged = read_file("n/study.csv"), *failed = read_file("n/failures.csv");
  CU_ASSERT_STRING_EQUAL(csv, merged);
  CU_ASSERT_STRING_EQUAL(failures, failed);
  EXPECT(count_lines(csv) + count_lines(failures) == 6, "%s%s", csv, failures);
  free(csv), free(failures), free(merged), free(failed);
}

int main(void) {
  static const vs_test TESTS[] = {
    {"a study to take a head from", make_study},
    {"rows of other bits", rows_of_other_bits},
#if defined __x86_64__ && defined __GLIBC__
    {"other functions", other_functions},
#endif
    {"rows of another shape", rows_of_another_shape},
    {"two rows of one case", two_rows_of_a_case},
    {"cells in quotes", cells_in_quotes},
    {"rows of other cases", rows_of_other_cases},
    {"rows of a search", rows_of_a_search},
    {"heads of others", heads_of_others},
    {"its own head", its_own_head},
    {"rows of the program's own", own_rows},
  };
  return program_suite("journal_rows", TESTS, COUNT(TESTS));
}
