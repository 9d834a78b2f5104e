/* SPDX-License-Identifier: GPL-3.0-or-later
 * The corpora of tests/fuzz, and what has fallen once, given to the fuzzers' targets without
 * libFuzzer. Then some texts more, which the grammars make of them: a little of what tools/fuzz
 * does, where clang is missing. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/text.h"
#include "target.h"
#include "suite.h"

enum { MOST = 4096, CHANGES = 30 };

static const double PATIENCE_S = 5; /* as of tools/fuzz: for one text */

static double processor_s(void) {
  return (double)clock() / CLOCKS_PER_SEC;
}

/* A death is to tell by which file. */
static void give(const fuzz_target *target, const char *path, const char *text, size_t size) {
  char now[VS_PATH_SIZE];
  snprintf(now, sizeof now, "%s_text", target->name);
  FILE *f = fopen(now, "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  fwrite(text, 1, size, f);
  fclose(f);
  double begin_s = processor_s();
  fuzz_take(target, (const uint8_t *)text, size);
  double took_s = processor_s() - begin_s;
  if (getenv("VS_FUZZ_TIMES")) printf("%s: %s: %.2f s\n", target->name, path, took_s);
  EXPECT(took_s < PATIENCE_S, "%s: %s: %.1f s", target->name, path, took_s);
  unlink(now);
}

/* Each byte that is changed is another one at random, in the place of one of the text's. */
static size_t change(const fuzz_target *target, char *text, size_t size, unsigned seed) {
  if (target->grammar && seed % 3)
    size = fuzz_grammar_change(target->grammar, text, size, MOST, seed);
  else
    for (unsigned k = 0; k < 3 && size; k++)
      text[(seed * 2654435761u + k * 40503u) % size] ^= (char)(1u << (seed + k) % 8);
  return target->mend ? target->mend(text, size, MOST) : size;
}

static void take_file(const fuzz_target *target, const char *path, unsigned changes) {
  char text[MOST];
  FILE *f = fopen(path, "r");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  size_t whole = fread(text, 1, sizeof text, f);
  fclose(f);
  give(target, path, text, whole);
  for (unsigned seed = 1; seed <= changes; seed++) {
    f = fopen(path, "r");
    size_t size = fread(text, 1, sizeof text, f);
    fclose(f);
    size = change(target, text, size, seed);
    give(target, path, text, size);
  }
}

/* Returns how many files the folder has. */
static int take_folder(const fuzz_target *target, const char *what, unsigned changes) {
  char folder[VS_PATH_SIZE], path[2 * VS_PATH_SIZE];
  int count = 0;
  snprintf(folder, sizeof folder, "%s/fuzz/%s/%s", VS_TEST_FOLDER, what, target->name);
  DIR *all = opendir(folder);
  for (struct dirent *e; all && (e = readdir(all));) {
    if (*e->d_name == '.') continue;
    snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
    take_file(target, path, changes);
    count++;
  }
  if (all) closedir(all);
  return count;
}

static void corpora(void) {
  for (const fuzz_target *const *t = fuzz_targets; *t; t++)
    EXPECT(take_folder(*t, "corpus", CHANGES) > 0, "no corpus of %s", (*t)->name);
}

static void what_fell(void) {
  int count = 0;
  for (const fuzz_target *const *t = fuzz_targets; *t; t++) count += take_folder(*t, "found", 0);
  CU_ASSERT(count > 0);
}

static const fuzz_target *target_called(const char *name) {
  const fuzz_target *const *t = fuzz_targets;
  while (*t && strcmp((*t)->name, name)) t++;
  CU_ASSERT_PTR_NOT_NULL_FATAL(*t);
  return *t;
}

/* Much of the same kind, each with a name or two of its own: the piece's first number counts them,
 * its second is one more. What compares each with all others takes minutes. */
static void many_names(void) {
  static const struct {
    const char *target, *before, *piece, *behind;
    int times;
  } MANY[] = {
      {"netlist", "V1 n0 0 SINE(0 311 50)\n", "R%1$d n%1$d n%2$d 1\n", "L1 n30000 0 1m\n", 30000},
      {"netlist", "V1 a 0 SINE(0 311 50)\nL1 a 0 1m\n", "L_%1$d a%1$d 0 1\nK%1$d L_%1$d L1 1\n", "",
       10000},
      {"netlist", ".param p0=1 q0=1\n", /* each needs two that need two */
       ".param p%2$d=(p%1$d+q%1$d)/2 q%2$d=(p%1$d-q%1$d)/2\n", "R1 a 0 {p60}\n", 60},
      {"netlist", "R1 a 0 {p0}\n", ".param p%1$d=(p%2$d)\n", ".param p20000=1\n", 20000},
      {"scene", "machine: machines/conveyor.yaml\ninstruments:\n",
       "  s%1$d: {channel: p, range: [-1 mm, 1 mm], bandwidth: 1 kHz}\n", "", 20000},
      {"deck", "*$ port mains = V1\nV1 a 0 external\nXeva a 0 eva\n",
       ".subckt s%1$d a b\nR1 a b 1\n.ends\nX%1$d a n%1$d s%1$d\n", "", 20000},
      {"deck", "*$ port mains = V1\nV1 a 0 external\nXeva a 0 eva\n",
       ".global g%1$d\nR%1$d a g%1$d 1\n", "", 20000},
  };
  for (size_t k = 0; k < COUNT(MANY); k++) {
    vs_text text = {0};
    vs_text_add(&text, "%s", MANY[k].before);
    for (int n = 0; n < MANY[k].times; n++) vs_text_add(&text, MANY[k].piece, n, n + 1);
    vs_text_add(&text, "%s", MANY[k].behind);
    give(target_called(MANY[k].target), MANY[k].piece, text.text, text.length);
    vs_text_free(&text);
  }
}

/* A coil's table of 300 gaps and 300 currents. */
static void a_large_table(void) {
  vs_text text = {0};
  vs_text_add(&text, "machine: {model: conveyor}\nactuator: {law: table.csv, gap: 2 mm}\n"
                     "%%%%%% table.csv\nz_m,i_a,lambda_wb,force_n\n");
  for (int k = 0; k < 300; k++)
    for (int n = 0; n < 300; n++)
      vs_text_add(&text, "%.9g,%.9g,%.9g,0\n", 1e-4 * (k + 1), 0.1 * n, 0.1 * n / (k + 100));
  give(target_called("scene"), "table.csv", text.text, text.length);
  vs_text_free(&text);
}

/* What is long rather than odd: a text, and a piece that stands in it so many times. */
static void long_texts(void) {
  static const char BASE[] = "*$ port mains = V1\nV1 a 0 external\nXeva a 0 eva\n";
  static const struct {
    const char *target, *before, *piece;
    int times;
  } LONG[] = {
      {"formula", "1", "sqrt(", 100000},
      {"formula", "0", "(", 100000},
      {"formula", "0", "-", 100000},
      {"formula", "0", "2^", 100000},
      {"units", "m\n1 ", "m*", 100000},
      {"scene", "a: ", "[", 20000},
      {"scene", "a: ", "{a: ", 20000},
      {"deck", "B1 a 0 V=", "if(1,", 20000},
      {"overlay", "t_s,p_m\n0,\"1\n", "1,2\n", 800000},
      {"deck", "*$ loss x = ", "(", 20000},
      {"deck", ".subckt s a b\n", "X1 a b s\n", 2000},
  };
  for (size_t k = 0; k < COUNT(LONG); k++) {
    const fuzz_target *t = target_called(LONG[k].target);
    vs_text text = {0};
    vs_text_add(&text, "%s%s", strcmp(t->name, "deck") ? "" : BASE, LONG[k].before);
    for (int n = 0; n < LONG[k].times; n++) vs_text_add(&text, "%s", LONG[k].piece);
    give(t, LONG[k].piece, text.text, text.length);
    vs_text_free(&text);
  }
}

int main(void) {
  static const vs_test TESTS[] = {{"what fell once", what_fell},
                                  {"many names", many_names},
                                  {"a large table", a_large_table},
                                  {"long texts", long_texts},
                                  {"the corpora, changed", corpora}};
  fuzz_begin();
  return vs_suite("fuzz_corpus", TESTS, COUNT(TESTS));
}
