/* SPDX-License-Identifier: GPL-3.0-or-later
 * Decks that are another circuit in each run: what ngspice draws anew is refused where it stands,
 * in every file of a deck, and nothing else of a like name is. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

/* halfwave_snubbed with lines before the EVA's; gives the number of the first of them. */
static int make_deck(const char *lines) {
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  char *eva = strstr(text, "Xeva ");
  CU_ASSERT_PTR_NOT_NULL_FATAL(eva);
  vs_text deck = {0};
  vs_text_add(&deck, "%.*s%s\n%s", (int)(eva - text), text, lines, eva);
  write_file("d.cir", deck.text);
  *eva = '\0';
  int first = count_lines(text) + 1;
  vs_text_free(&deck);
  free(text);
  return first;
}

/* Refused by check and by run, at that place, and nothing is written. */
static void expect_refused(const char *place, const char *word, const char *what) {
  static const char *const COMMANDS[] = {
      "check paper --set circuit.deck=d.cir",
      "run paper --set circuit.deck=d.cir --set run.until=1ms -o out"};
  for (size_t k = 0; k < COUNT(COMMANDS); k++) {
    ran r = run("%s", COMMANDS[k]);
    EXPECT(r.status == 2, "%s: exit status %d of %s", what, r.status, COMMANDS[k]);
    char *at = strstr(r.err, place);
    EXPECT(at && strstr(r.err, word), "%s: says %s, should of %s %s", what, r.err, place, word);
    free_ran(&r);
  }
}

static void each_form(void) {
  static const struct {
    const char *lines;
    int line, column; /* of the lines, from 0 */
    const char *word;
  } ROWS[] = {
      {"R9 y 0 {gauss(1k,0.1,3)}", 0, 9, "gauss"},
      {"R9 y 0 {1 + aGauss (1k, 100, 3)}", 0, 13, "agauss"},
      {"R9 y 0 'unif(1k,0.1)'", 0, 9, "unif"},
      {".param q9 = {AUNIF(1k,100)}\nR9 y 0 {q9}", 0, 14, "aunif"},
      {".param q9=limit(1k,100)\nR9 y 0 {q9}", 0, 11, "limit"},
      {".func twice(x) {2*gauss(x,0.1,3)}\nR9 y 0 {twice(1k)}", 0, 19, "gauss"},
      {"B9 y 0 I = 1m*v(y)+aunif(1,2)", 0, 20, "aunif"},
      {"R9 y 0 1k\nC9 y 0\n+ {1n *\n+ 2*limit\t(1, 2)}", 3, 5, "limit"},
      {".model sometimes sw(ron={unif(1,0.5)} roff=1g)\nR9 y 0 1k", 0, 26, "unif"},
      {".subckt some a b\nR9 a b {limit(1k,100)}\n.ends some\nX9 y 0 some", 1, 9, "limit"},
      {".func limit(x) {min(x,1)}\nR9 y 0 1k", 0, 7, "limit"},
      {"V9 y 0 dc 0 trnoise(20n 0.5n 0 0)\nR9 y 0 1k", 0, 13, "trnoise"},
      {"I9 y 0 TRRANDOM (2 10m 0 1)\nR9 y 0 1k", 0, 8, "trrandom"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char place[64];
    int first = make_deck(ROWS[k].lines);
    snprintf(place, sizeof place, "d.cir:%d:%d: %s", first + ROWS[k].line, ROWS[k].column,
             ROWS[k].word);
    expect_refused(place, "random", ROWS[k].lines);
  }
}

static void every_file(void) {
  make_deck(".include more.inc\nX9 y 0 some");
  write_file("more.inc",
             "* a part of the deck\n.subckt some a b\nR9 a b {gauss(1k,0.1,3)}\n.ends\n");
  expect_refused("more.inc:3:9: gauss", "random", "an include");
  char *part = read_file(VS_TEST_FOLDER "/../spice/parts/latch.inc");
  vs_text own = {0};
  char *ends = strstr(part, ".ends");
  CU_ASSERT_PTR_NOT_NULL_FATAL(ends);
  vs_text_add(&own, "%.*sR9 a k {unif(1g,0.1)}\n.ends\n", (int)(ends - part), part);
  char *name = strstr(own.text, ".subckt latch");
  CU_ASSERT_PTR_NOT_NULL_FATAL(name);
  memcpy(name, ".subckt lotch", 13);
  write_file("lotch.inc", own.text);
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  write_file("d.cir", text);
  ran r = run("check paper --set circuit.deck=d.cir --set circuit.thyristor=lotch");
  EXPECT(r.status == 2 && strstr(r.err, "lotch.inc:") && strstr(r.err, ":9: unif"), "a part: %s",
         r.err);
  free_ran(&r);
  free(text);
  free(part);
  vs_text_free(&own);
}

/* Names that contain the words, or are them but call nothing. */
static void others_are_fine(void) {
  make_deck(".param limit1 = 1k\n.param gauss_of = {limit1*2}\n"
            "R9 limit 0 {limit1}\nR10 limit unif 1k\nR11 unif 0 {gauss_of}\n"
            "B9 limits 0 I = 1u*(v(limits)+1)\nR16 limits 0 1k\n"
            ".func my_limit(x) {min(x,1)}\nR12 unif 0 {my_limit(1)}\n"
            ".model x limit(gain=1 out_lower_limit=-1 out_upper_limit=1)\n"
            "A9 limit z x\nR13 z 0 1k\nV9 trnoise 0 1\nR14 trnoise 0 1k\n"
            "* gauss(1,2,3)\nR15 trnoise 0 1k ; aunif(1,2)");
  ran r = run("check paper --set circuit.deck=d.cir");
  EXPECT(r.status == 0, "exit status %d: %s", r.status, r.err);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"each form", each_form}, {"every file", every_file}, {"others are fine", others_are_fine}};
int main(void) {
  return program_suite("random decks", TESTS, COUNT(TESTS));
}
