/* SPDX-License-Identifier: GPL-3.0-or-later
 * Netlists as LTspice, PSpice, KiCad and data sheets write them: files in any encoding, statements
 * that are skipped, constructs that are rewritten against the same circuit written by hand, LIMIT
 * of PSpice's, numbers and names that ngspice would misread, and the places of what ngspice says.
 */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "netlist/reserved.h"
#include "program.h"

/* ---- files as they come ---- */

/* A capacitor in microfarad behind the mains, its sign a micro sign where that can be written. */
#define DECK(sign)                                                                                 \
  "*$ port mains = Vmains\n*$ port gate = Vgate\n*$ probe i_thyristor = i(Vt) A\n"                 \
  "*$ probe v_b = v(b) V\nVmains a 0 external\nVgate g 0 external\nRg g 0 1k\nVt a b1 0\n"         \
  "R1 b1 b 10\nC1 b 0 1" sign "\nXeva b 0 eva\n"

#define RUN                                                                                        \
  "run paper --set circuit.deck=%s --set run.until=3ms --set run.verify=never --quiet --json"

static void write_bytes(const char *path, const char *bytes, size_t n) {
  FILE *f = fopen(path, "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  CU_ASSERT_EQUAL(fwrite(bytes, 1, n, f), n);
  fclose(f);
}

/* Writes a text of characters below 256, given as UTF-8, with two bytes each. */
static void write_utf16(const char *path, const char *text, bool big_end_first, bool mark) {
  char bytes[4096];
  size_t n = 0;
  if (mark) {
    memcpy(bytes, big_end_first ? "\xfe\xff" : "\xff\xfe", 2);
    n = 2;
  }
  for (const unsigned char *s = (const unsigned char *)text; *s; s++) {
    int c = *s < 0x80 ? *s : (*s & 0x1f) << 6 | (s[1] & 0x3f);
    if (*s >= 0x80) s++;
    bytes[n + big_end_first] = (char)c;
    bytes[n + !big_end_first] = '\0';
    n += 2;
  }
  write_bytes(path, bytes, n);
}

/* Replaces each end of a line. */
static char *with_ends(const char *text, const char *end, const char *last) {
  vs_text out = {0};
  for (const char *s = text; *s; s++) {
    if (*s == '\n')
      vs_text_add(&out, "%s", end);
    else
      vs_text_add(&out, "%c", *s);
  }
  vs_text_add(&out, "%s", last);
  return out.text;
}

static double number(const char *json, const char *name) {
  char wanted[64];
  snprintf(wanted, sizeof wanted, "\"%s\": {\"value\": ", name);
  const char *found = strstr(json, wanted);
  return found ? strtod(found + strlen(wanted), NULL) : NAN;
}

/* The same circuit gives the same numbers to the bit, whatever its file is written in. */
static void encodings(void) {
  static const char PLAIN[] = DECK("u"), MICRO[] = DECK("\xc2\xb5"), LATIN[] = DECK("\xb5");
  static const char GREEK[] = DECK("\xce\xbc"), MARK[] = "\xef\xbb\xbf" DECK("u");
  write_file("d.cir", PLAIN);
  ran first = run(RUN, "d.cir");
  EXPECT(first.status == 0 && strstr(first.out, "v_b_max"), "%s", first.err);
  for (int k = 0; k < 13; k++) {
    char *text = NULL;
    if (k < 4) write_utf16("d.cir", MICRO, k & 1, k & 2);
    if (k == 4) write_file("d.cir", MICRO);
    if (k == 5) write_file("d.cir", LATIN);
    if (k == 6) write_file("d.cir", GREEK);
    if (k == 7) write_file("d.cir", MARK);
    if (k == 8) text = with_ends(PLAIN, "\r\n", "");
    if (k == 9) text = with_ends(PLAIN, "\r", "");
    if (k == 10) text = with_ends(PLAIN, "\r\n", "\x1a");
    if (k == 11) text = with_ends(PLAIN, "\n", "\x1a\x1a\r\n");
    if (k == 12) text = with_ends(PLAIN, "\r\r\n", "");
    if (text) write_file("d.cir", text);
    free(text);
    ran r = run(RUN, "d.cir");
    EXPECT(r.status == 0 && !*r.err, "%d: %d %s", k, r.status, r.err);
    CU_ASSERT_EQUAL(number(r.out, "v_b_max"), number(first.out, "v_b_max"));
    CU_ASSERT_EQUAL(number(r.out, "v_b_min"), number(first.out, "v_b_min"));
    free_ran(&r);
  }
  free_ran(&first);
}

/* Runs d.cir, which must be refused at that place and with these words. */
static void refused_there(const char *at, const char *says, int line) {
  ran r = run(RUN, "d.cir");
  char begin[64];
  snprintf(begin, sizeof begin, "vibrospice: %s: ", at);
  const char *own = strstr(r.err, begin);
  expect(r.status == 2 && own && strstr(own, says), line, "%s: %d %s", says, r.status, r.err);
  free_ran(&r);
}

static void refused(const char *deck, const char *at, const char *says, int line) {
  write_file("d.cir", deck);
  refused_there(at, says, line);
}

/* Places count lines and characters as an editor shows them. */
static void places_in_encodings(void) {
  static const char BAD[] = DECK("u") "* \xc2\xb5\xc2\xb5\nR2 b 0 \xc2\xb5 4k7\n";
  write_utf16("u.cir", DECK("u") "* \xc2\xb5\nR2 b 0 4k7\n", false, true);
  ran r = run("check u.cir");
  EXPECT(r.status == 2 && strstr(r.err, "u.cir:13:8: ") &&
             strstr(r.err, "\n R2 b 0 4k7\n        ^\n"),
         "%s", r.err);
  free_ran(&r);
  refused(BAD, "d.cir:13:10", "4k7", __LINE__);
  char *text = with_ends(BAD, "\r", "");
  refused(text, "d.cir:13:10", "4k7", __LINE__);
  free(text);
  refused(DECK("u") "R2 b 0 1k\x1aR3\n", "d.cir:12:10", "control character", __LINE__);
  write_bytes("d.cir", "R1 a b 1\nR2\0 a b\n", 17);
  r = run("check d.cir");
  EXPECT(r.status == 2 && strstr(r.err, "d.cir:2:1: a zero byte"), "%s", r.err);
  free_ran(&r);
  write_bytes("d.cir",
              "\xff\xfeR\0\0\xd8"
              "1\0",
              8);
  r = run("check d.cir");
  EXPECT(r.status == 2 && strstr(r.err, "d.cir:1:1: half of a pair"), "%s", r.err);
  free_ran(&r);
}

static void warns(const char *words, int status, const char *says, int line) {
  ran r = run("%s", words);
  expect(r.status == status && strstr(r.err, says), line, "%s: %d %s\n(%s)", words, r.status, r.err,
         says);
  free_ran(&r);
}

static void skipped_statements(void) {
  write_file("d.cir",
             "A rectifier, as drawn\n" DECK(
                 "u") ".tran 0 20m 0 1u\n.options reltol=1e-4 temp=27\n.probe v(b)\n.save all\n"
                      ".meas tran m1 max v(b)\n.backanno\n.op\n.temp 27\n.end\nRubbish\n");
  warns("check d.cir", 0, "d.cir:1:1: warning: taken for the title", __LINE__);
  warns("check d.cir", 0,
        "d.cir:13:1: warning: skipped: '.tran', '.options' (line 14), '.probe' (line 15), '.save' "
        "(line 16), '.meas' (line 17), '.backanno' (line 18), '.op' (line 19), '.temp' (line 20), "
        "'.end' (line 21), all that stands behind '.end' (line 22), ...",
        __LINE__);
  ran r = run("check d.cir");
  EXPECT(strstr(r.out, "a good deck: A rectifier, as drawn; "), "%s", r.out);
  free_ran(&r);
  r = run(
      "run paper --set circuit.deck=d.cir --set run.until=2ms --set run.verify=never --json -o o");
  EXPECT(r.status == 0 && strstr(r.err, "warning: d.cir:13:1: skipped: '.tran'"), "%s", r.err);
  EXPECT(strstr(r.out, "d.cir:13:1: skipped: '.tran'"), "%s", r.out); /* in "warnings" */
  free_ran(&r);
  remove_tree("o");
  write_file("d.cir", DECK("u") ".title KiCad schematic\n.end\n");
  warns("check d.cir", 0, "skipped: '.end': ", __LINE__);
  r = run("check d.cir");
  EXPECT(strstr(r.out, "a good deck: KiCad schematic; "), "%s", r.out);
  free_ran(&r);
}

static void refused_statements(void) {
  refused(DECK("u") ".step param x 1 2 1\n", "d.cir:12:1", "circuit.NAME", __LINE__);
  refused(DECK("u") ".temp 50\n", "d.cir:12:1", "27 degC", __LINE__);
  refused(DECK("u") ".options tnom=25\n", "d.cir:12:1", "tnom", __LINE__);
  refused(DECK("u") ".option rshunt = 1e9\n", "d.cir:12:1", "rshunt", __LINE__);
  refused(DECK("u") ".wave x.wav 16 44.1k v(b)\n", "d.cir:12:1", "does not belong", __LINE__);
  refused(DECK("u") ".savebias x tran\n", "d.cir:12:1", "does not belong", __LINE__);
  refused(DECK("u") ".ends\n", "d.cir:12:1", "none is open", __LINE__);
  refused(DECK("u") ".subckt s a b\nR1 a b 1\n", "d.cir:12:1", "no .ends", __LINE__);
  /* the commands themselves are no findings of their own, and are not obeyed */
  write_file("d.cir", DECK("u") ".control\nshell touch made\nrun\n.endc\nR2 a\n");
  ran r = run("check d.cir");
  EXPECT(r.status == 2 && strstr(r.err, "d.cir:12:1: .control") && strstr(r.err, "d.cir:16:1: ") &&
             !strstr(r.err, "d.cir:13:") && !strstr(r.err, "d.cir:14:"),
         "%s", r.err);
  EXPECT(access("made", F_OK), "the command was obeyed");
  free_ran(&r);
}

#define LIBRARY                                                                                    \
  "* a vendor's\n*$\n.SUBCKT LOAD 1 2 PARAMS: R=3, S=1k\nR1 1 2 {R+S}\n.ENDS\n*$\n*$ note 1\n"     \
  "*$ note 2\n*$\n.END\n\x1a"

static void libraries(void) {
  static const char *const ENDINGS[] = {"net", "sp", "ckt", "spice"};
  write_file("v.lib", LIBRARY);
  write_file("d.cir", "*$\n" DECK("u") ".lib v.lib\nX1 b 0 LOAD\n");
  warns("check d.cir", 0,
        "v.lib:7:1: warning: '*$ note' is none of the contract's lines and taken for a comment (2 "
        "such lines in this file)",
        __LINE__);
  ran r = run("check v.lib");
  EXPECT(r.status == 0 && strstr(r.out, "a good library: 1 subcircuit, 0 models") &&
             strstr(r.err, "v.lib:7:1: warning: '*$ note' is none of the contract's lines"),
         "%s%s", r.out, r.err);
  free_ran(&r);
  write_file(
      "v.lib",
      "* LTspice's\n* Begin:\n 5D DD 2F E9 DF 8B 6B E1 49 4F\n 47 8A 1E 19 0C AA 0A F3 B0\n");
  warns("check v.lib", 2, "v.lib:2:1: is encrypted for LTspice", __LINE__);
  write_file("v.lib", LIBRARY);
  refused(DECK("u") "*$ note 1\n", "d.cir:12:4", "'*$ note' is not known", __LINE__);
  for (size_t k = 0; k < COUNT(ENDINGS); k++) {
    char name[32], words[64];
    snprintf(name, sizeof name, "d.%s", ENDINGS[k]);
    snprintf(words, sizeof words, "check %s", name);
    write_file(name, DECK("u"));
    r = run("%s", words);
    EXPECT(r.status == 0 && strstr(r.out, "a good deck"), "%s: %s", name, r.err);
    free_ran(&r);
  }
  write_file("deck.lib", DECK("u"));
  r = run("check deck.lib");
  EXPECT(r.status == 0 && strstr(r.out, "a good deck"), "%s", r.err);
  free_ran(&r);
  /* a path of Windows': the file beside the deck, or none, which is told */
  write_file("d.cir", DECK("u") ".lib C:\\Users\\me\\lib\\v.lib\nX1 b 0 LOAD\n"
                                ".lib C:\\Users\\me\\lib\\standard.dio\n");
  warns("check d.cir", 0, "d.cir:14:1: warning: C:\\Users\\me\\lib\\standard.dio is not on this",
        __LINE__);
}

/* Of a library only what is called is read. What is wrong elsewhere is one warning of each kind:
 * lines outside of subcircuits that are none, and slips in what nothing calls. What is called is
 * held to the rules at its own place. Shapes: a disclaimer without a star, a bracket too few, a
 * subcircuit that calls itself, one that is not closed, one that is closed twice
 * (github.com/vgreff/LTSpiceLibraries: EPCGaNLibrary.lib, Triac.txt, IGBT_ST.lib). */
#define MAKERS                                                                                     \
  "A maker's models, EPC20, as they are\nNo warranty is given\n"                                   \
  ".subckt SLIP 1 2\nR1 1 2 4k7\nB1 1 2 2*V(1)\n.ends\n"                                           \
  ".subckt SELF 1 2\nX1 1 2 SELF\n.ends\n.subckt LOAD 1 2\nX1 1 2 INNER R=1k\n.ends\n.ends\n"      \
  ".subckt INNER 1 2 R=1\nR1 1 2 {R} %s\n.ends\n.model dead d(is=4k7)\n.subckt OPEN 1 2\nR1 1 2 "  \
  "1k\n"

static void what_is_called(void) {
  static const struct {
    const char *calls, *inner, *says;
    int status;
  } ROWS[] = {
      {"X1 b 0 LOAD\n", "", "v.lib:1:1: warning: 3 lines outside of this library's subcircuits", 0},
      {"X1 b 0 LOAD\n", "",
       "v.lib:4:8: warning: passed by, as nothing calls what this stands in (3 subcircuits", 0},
      {"X1 b 0 LOAD\n", "4k7", "v.lib:15:12: '{R} 4k7'", 2},
      {"X1 b 0 SLIP\n", "", "v.lib:4:8: '4k7'", 2},
      {"X1 b 0 SELF\n", "", "v.lib:8:1: subcircuit SELF calls itself", 2},
      {"X1 b 0 OPEN\n", "", "v.lib:18:1: this .subckt has no .ends that closes it", 2},
      {"D9 b 0 dead\n", "", "v.lib:17:", 2},
      {"X1 b 0 LOAD\n.include w.lib\nX2 b 0 ELSEWHERE\n", "", "v.lib:1:1: warning", 0},
  };
  write_file("w.lib", ".subckt ELSEWHERE 1 2\nX1 1 2 LOAD\n.ends\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[1024];
    snprintf(text, sizeof text, MAKERS, ROWS[k].inner);
    write_file("v.lib", text);
    snprintf(text, sizeof text, "%s.include v.lib\n%s", DECK("u"), ROWS[k].calls);
    write_file("d.cir", text);
    warns("check d.cir", ROWS[k].status, ROWS[k].says, __LINE__);
  }
  ran r = run(RUN, "d.cir");
  EXPECT(r.status == 0 && !strstr(r.err, "passed by, as nothing"), "%s", r.err);
  free_ran(&r);
  /* what a part's file includes, and what stands behind an open subcircuit of the deck's own */
  refused(DECK("u") ".subckt mine 1 2\nR1 1 2 1k\n.include w.lib\n", "d.cir:12:1",
          "this .subckt has no .ends", __LINE__);
}

/* ---- constructs ---- */

/* A circuit for expressions: v(ss) is 2 V, v(ww) 3 V times the sine of 500 Hz. */
#define BENCH                                                                                      \
  "*$ port mains = Vmains\n*$ port gate = Vgate\n*$ probe i_thyristor = i(Vt) A\n"                 \
  "*$ probe y_v = v(yy) V\nVmains a 0 external\nVgate g 0 external\nRg g 0 1k\nVt a b1 0\n"        \
  "R1 b1 b 10\nXeva b 0 eva\nVss ss 0 2\nRss ss 0 1k\nVww ww 0 sin(0 3 500)\nRww ww 0 1k\n"        \
  "Ryy yy 0 1k\n" /* 15 lines */

static void write_bench(const char *lines) {
  vs_text deck = {0};
  vs_text_add(&deck, BENCH "%s\n", lines);
  write_file("d.cir", deck.text);
  vs_text_free(&deck);
}

/* Runs the bench with these lines: the least and the largest v(yy). */
static void run_bench(const char *lines, double ends[2], int line) {
  write_bench(lines);
  ran r = run("run paper --set circuit.deck=d.cir --set run.until=2ms --set run.verify=never "
              "--json --quiet");
  expect(r.status == 0, line, "%s: %s", lines, r.err);
  ends[0] = number(r.out, "y_v_min");
  ends[1] = number(r.out, "y_v_max");
  free_ran(&r);
}

static void bench_gives(const char *lines, double least, double most, double tolerance, int line) {
  double ends[2], scale = fmax(fabs(least), fabs(most));
  run_bench(lines, ends, line);
  vs_close(ends[0], least, scale, tolerance, lines, line);
  vs_close(ends[1], most, scale, tolerance, lines, line);
}

/* Each expression's value is a number: no step enters, and ngspice's tolerance of 1e-6 is met by
 * far, as the circuit of the bench is linear but for the source. */
static void functions(void) {
  static const struct {
    const char *lines;
    double value;
  } ROWS[] = {
      {"B1 yy 0 V=IF(V(ss)>1 & V(ss)<3,5,6)", 5},
      {"B1 yy 0 V=if( v(ss)>3 | ~(v(ss)<3) , 5 , 6 )", 6},
      {"B1 yy 0 V=IF(V(ss)>1 && V(ss)<3,5,6)", 5},
      {"E1 yy 0 VALUE={IF(V(ss)>1, IF(V(ss)>5,1,7), 6)}", 7},
      {"E1 yy 0 VALUE = { IF ( V(ss)>1,\n+ IF(V(ss)>5,1,7), 6) }", 7},
      {".param q={IF(2>1,7,8)}\nB1 yy 0 V={q}", 7},
      {".func f(x) {IF(x>1,7,8)}\nB1 yy 0 V=f(V(ss))", 7},
      {"B1 yy 0 V=IF(V(ss)/5,5,6)", 6}, /* 0.4 is no condition of LTspice's */
      {"B1 yy 0 V=IF(V(ss)/2,5,6)", 5},
      {".param q={IF(0.4,7,8)}\nB1 yy 0 V={q}", 8},
      {"B1 yy 0 V=int(-2.5)+int(2.5)+int(V(ss)+0.9)", 2},
      {"B1 yy 0 V=arctan(V(ss)/2)", M_PI / 4},
      {"*$ compat ps\nE1 yy 0 VALUE={INT(2.5)+ARCTAN(1)}", 2 + M_PI / 4},
      {".param q={table(1.5,0,1,1,3,2,7,4,1)}\nB1 yy 0 V={q}", 5},
      {".param q={table(9,0,1,1,3)+table(-9,0,1,1,3)}\nB1 yy 0 V={q}", 4},
      {"R9 ss yy {tbl(2,0,1k,4,3k)}\nR8 yy 0 1k", 0.4},
      {"B1 yy 0 V=PWRS(-2,3)+STP(V(ss))", -7},
      {"B1 yy 0 V=PWRS(-2*V(ss),0.5)", -2},
      {"B1 yy 0 V=1+PWRS(V(ss)-2,0.04)", 1},
      {".param q={PWRS(-2,3)+STP(2)}\nB1 yy 0 V={q}", -7},
      {"B1 yy 0 V=hypot(3,4)+round(2.6)+buf(1)-inv(0)", 8},
      {"B1 yy 0 V=arcsin(1)+arccos(1)", M_PI / 2},
      {"B1 yy 0 V=2^3+2**3", 16},
      {"E1 yy 0 TABLE {V(ss)} = (0,0) (1,4) (3,8)", 6},
      {"E1 yy 0 TABLE {V(ss)} (0,0) (2,4)", 4}, /* ngspice's own TABLE gives 3.9 here */
      {"E1 yy 0 TABLE {V(ss)*5} = ( (0,0) , (1,4) )", 4},
      {"G1 0 yy TABLE {V(ss)} = (0,0) (1,4m) (3,8m)", 6},
      {"E1 yy 0 ss 0 table=(0,0,1,4,3,8)", 6},
      {"B1 yy 0 V=table(V(ss),0,0,1,4,3,8)", 6},
      /* points in any brackets; ON Semiconductor's triacs lack one:
         github.com/vgreff/LTSpiceLibraries */
      {"E1 yy 0 TABLE {V(ss)} (0 0 (1 4) (3 8)", 6},
      {"E1 yy 0 TABLE {V(ss)} [0,0] <1,4> {3,8}", 6},
      {".param k=9\nE1 yy 0 TABLE {2*V(ss)} = (0,0) (3,{k})", 9},
      /* braces in braces, as Fairchild's FQPF22P10 has them, in the same repository */
      {".param k={2*{1+{2}}}\nB1 yy 0 V={k}", 6},
      /* IsSpice's heads and instances; names that end in a sign */
      {"X1 yy 0 s {A=2}\n.subckt s p q {A=1 B=3}\nB1 p q V={A*B}\n.ends", 6},
      {"R9+ ss yy 1k\nR8- yy 0 1k", 2. / 3},
      /* LTspice's blocks: parameters that the head lacks */
      {"X\u00a71 yy 0 s params: A=2 B={3}\n.subckt s p q\nX\u00a72 p q t C={A*B}\n.ends\n.subckt t "
       "p q\nB1 p q "
       "V={C}\n.ends",
       6},
      /* LTspice's current into a pin; its traces are Ix(u1:A) in public .raw files */
      {"XU1 yy ss s\n.subckt s p q\nR1 p q 1k\n.ends\nB1 w 0 V=1k*Ix(U1:q)-3k*Ix(XU1:p)\nR2 w 0 "
       "1k\nB2 0 yy I=0*V(w)",
       1},
      {"XU1 vv ss s\n.subckt s p q\nR1 p q 1k\n.ends\nR9 vv 0 1k\nB1 yy 0 "
       "V=1k*Ix(U1:q)-3k*Ix(XU1:p)",
       4},
      /* PSpice's optional nodes, as of its 74xx parts */
      {"X1 yy ss s\n.subckt s p q OPTIONAL: u=0 PARAMS: k=3\nB1 p u V=k*V(q,u)\n.ends", 6},
      {"X1 yy ss ss s\n.subckt s p q optional: u=0 w=0\nB1 p w V=6+V(q,u)\n.ends", 6},
      {"B1 yy 0 V=tbl(-V(ss),0,1,1,4)", 1},
      {".param k=9\nB1 yy 0 V=table(2*V(ss),0,0,3,{k})", 9},
      {"X1 yy 0 s PARAMS: A=2, B=3\n.subckt s p q PARAMS: A=1, B=1\nB1 p q V={A*B}\n.ends", 6},
      {"X1 yy 0 a-1+ PARAMS: A=2\n.subckt a-1+ p q PARAMS: A=1\nB1 p q V={3*A}\n.ends a-1+", 6},
      {"X1 yy 0 o/2\n.subckt o/2 p q\nX1 p q b-2 A = 4\n.ends\n.subckt b-2 p q\n+ A=1\n"
       ".param c={A/2}\nB1 p q V={c}\n.ends",
       2},
      {"X1 yy 0 b-2\n.subckt b-2 p q\n.param c=3\nB1 p q V={c}\n.ends b-2", 3},
      {".param a1=1, b1=2\nB1 yy 0 V={a1+b1}", 3},
      {"R9 ss yy 1k TC=0.001,0.002", 1},
      {"R9 ss yy 1k tol=5 pwr=0.25", 1},
      {"R9 ss yy 1k\nC9 ss 0 1p TC=0.1,0.2\nL9 ss zz 1u TC=0\nR8 zz 0 1k", 1},
      {".param x=100\nR9 ss yy 5*{x}\nR8 yy ss r={x}*2*5", 1.5},
      {".param x=100\nR9 ss yy 5*{x} tc1=0*{x}", 4. / 3},
      {"V9 yy 0 5 Rser=1k", 2.5},
      {"B1 yy 0 V=V(ss)*3 tripdv=1 tripdt=1u", 6},
      {"B1 0 yy I=1m Rpar=1k", 0.5},
      {"X1 yy 0 lg\n.subckt lg p q {k=2}\nB1 p q V=LOG(1000)-{k}\n.ends", 1},
      {"*$ compat ps\n.model n D(is=1n)\n.model m AKO: n D(rs=1)\nD9 yy 0 m\nB1 yy 0 V=-1", -1},
      {"*$ compat ps\nB1 yy 0 V=IF(V(ss)>1 & V(ss)<3,5,6)+PWRS(-2,3)+STP(2)", -2},
      {"*$ compat ps\nR_R1 $N_0001 yy 1k\nR_R2 $N_0001 ss 1k\nR_R3 yy 0 1k", 2. / 5},
      {"*$ compat ps\nS1 ss yy ss 0 sw1\n.model sw1 VSWITCH(Ron=1k Roff=1G Von=1 Voff=0)", 1},
      {"*$ compat ps\nS1 ss yy ss 0 sw1\n.model sw1 VSWITCH (Ron=1k,Voff=0.5)", 1}, /* no Von */
      {"*$ compat ps\nS1 ss yy ss 0 sw1\n.model sw1 VSWITCH Ron=1k Roff=1G Von=1", 1},
      {"*$ compat ps\nS1 ss yy ss 0 sw1\n.model sw1 VSWITCH", 2000. / 1001},
      {"*$ compat ps\nS1 ss yy ss 0 sw1\n.model sw1 VSWITCH(Ron=1k Roff=3k VT=3 VH=0)", 0.5},
      {"*$ compat ps\nR9 ss yy rm 1k\n.model rm RES(R=1 TC1=0.01 T_ABS=77)", 0.8},
      {"*$ compat ps\nR9 ss yy rm 1k\n.model rm RES (TC1=0.01 T_REL_GLOBAL=50)", 0.8},
      {"*$ compat ps\nE1 yy 0 TABLE {LIMIT(V(ss),0,1)} = (0,0) (1,4) (3,8)", 4},
      {".func hypot(x,y) {x+y}\nB1 yy 0 V=hypot(3,4)", 7}, /* the deck's own */
      {"B1 yy 0 V=hypot(3,4)\n.func hypot(x,y) {x+y}", 7},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++)
    bench_gives(ROWS[k].lines, ROWS[k].value, ROWS[k].value, 1e-8, __LINE__);
}

/* A value goes to its end: ngspice alone reads b, or 2, of each sum, and of others what the row
 * says. */
static void values_with_blanks(void) {
#define INNER(param) "X1 yy 0 s\n.subckt s p q\n.param b=2\n.param " param "\nB1 p q V={a}\n.ends"
#define CALLED(given, head) "X1 yy 0 s " given "\n.subckt s p q " head "\nB1 p q V={a+c}\n.ends"
#define DIVIDER ".param b=2\nR9 ss yy 1\n"
#define SWITCH(model) ".param b=2\nR9 ss yy 1\nS9 yy 0 ss 0 sm\n.model sm sw" model
#define DIVIDED (2 / (1 + 1. / 3 + 1e-3)) /* by 3 ohm, and the bench's 1 kohm */
  static const struct {
    const char *lines;
    double value;
  } ROWS[] = {
      {INNER("a = b + 1"), 3},
      {INNER("a = b +1 c = 3"), 3},
      {INNER("c=7 a=b - -3\n+ d=8"), 5},
      {INNER("a = {b} + 'b'"), 4},
      {INNER("a = b * (1 + b)"), 6},
      {INNER("a = max (b, 5) + 1"), 6},
      {INNER("a = b >= 1 ? 7 : 8"), 7},
      {INNER("a = - b"), -2},                             /* an error in ngspice */
      {".param b=2\n.param a = b + 1\nB1 yy 0 V={a}", 3}, /* an error, and in a subcircuit b */
      {".param b=2 a = b\t+ 1 c = 3\nB1 yy 0 V={a}", 3},
      {".param b=2\n" CALLED("a = b + 1 c=1", "a=9 c=9"), 4},
      {".param b=2\n" CALLED("PARAMS: c = 1 a = 2*b - 3", "PARAMS: a=9 c=9"), 2},
      {".param b=2\n" CALLED("c=1", "a = b + 1 c=9"), 4},
      {".param b=2\n" CALLED("c=1", "PARAMS: c=9 a = (b + 1)"), 4}, /* an error in ngspice */
      {"X1 yy ss s\n.subckt s p q OPTIONAL: u=0 PARAMS: k=3 - 1\nB1 p u V=k*V(q,u)\n.ends", 4},
      {SWITCH("(ron = b + 1 vt=1)"), DIVIDED},
      {SWITCH("(vt=1 ron=2+1)"), DIVIDED},
      {SWITCH(" vt=1 ron = b +1 roff=1g"), DIVIDED},
      {DIVIDER "R8 yy 0 2+1", DIVIDED},      /* 1 in ngspice */
      {DIVIDER "R8 yy 0 b + 1", DIVIDED},    /* an error in ngspice */
      {DIVIDER "R8 yy 0 R = b +1", DIVIDED}, /* 1 in ngspice */
      {DIVIDER "R8 yy 0 R = 2+1 tc1=0", DIVIDED},
      {"B1 0 yy I=1m Rpar=500 +500", 0.5}, /* 501 A in ngspice */
      {"V9 yy 0 5 Rser=2 + 1\nR9 yy 0 3", 5. / (2 + 3e-3)},
      {".param b=2\nE1 yy 0 value = b * 3 + 1", 7},
      {".param b=2\nE1 yy 0 value = 2 * b", 4},
      {".param b=2\nE1 yy 0 ss 0 b + 1", 6}, /* an error in ngspice */
      {".param b=2\nV9 vv 0 1\nR9 vv 0 1k\nF9 0 yy V9 -500 * b\nR8 yy 0 1", 1 / (1 + 1e-3)},
      {"V9 yy 0 pulse(2+1 2+1 0 1u 1u 1 2)", 3},
      {"V9 yy 0 pwl(0 1*3 1 3)", 3},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++)
    bench_gives(ROWS[k].lines, ROWS[k].value, ROWS[k].value, 1e-8, __LINE__);
}

/* idt(3 sin(w t)) is 3 (1 - cos(w t))/w, at its most 6/w after half of the 2 ms; and 1 V s more.
 * The trapezoidal rule at the tier's steps is good to 1e-5 of that. */
static void integrals(void) {
  const double most = 6 / (2 * M_PI * 500);
  bench_gives("B1 yy 0 V=1e3*idt(V(ww))", 0, 1e3 * most, 1e-3, __LINE__);
  bench_gives("B1 yy 0 V=1e3*sdt(V(ww),1m)", 1, 1 + 1e3 * most, 1e-3, __LINE__);
  bench_gives("X1 yy s\n.subckt s p\nB1 p 0 V={idt(idt(1e6))+0}\n.ends", 0, 2, 1e-3, __LINE__);
}

/* An element with parasitic parts against the same by hand. The lines differ in names and order, so
 * that rounding does; the step's tolerance bounds what that makes of the courses. */
static void parasitic_parts(void) {
  static const struct {
    const char *short_form, *by_hand;
  } ROWS[] = {
      {"L9 ww yy 10m Rser=50 ic=1m", "L9 ww x 10m ic=1m\nR9 x yy 50"},
      {"L9 ww yy 10m Rser=50 Cpar=10n Rpar=10k",
       "L9 ww x 10m\nR9 x yy 50\nC8 ww yy 10n\nR8 ww yy 10k"},
      {"C9 ww yy 1u Rser=100 V=50 Irms=1 mfg=\"A maker\" pn=\"C 1\" type=\"film\" ic=2",
       "C9 ww x 1u ic=2\nR9 x yy 100"},
      {"C9 ww yy 1u Rser=100 Lser=1u RLshunt=1k Rpar=100k Cpar=1n",
       "C9 ww x 1u\nR9 x y 100\nL9 y yy 1u\nR7 y yy 1k\nR8 ww yy 100k\nC8 ww yy 1n"},
      {"C9 ww yy Q=0.4u*x+0.1u*x*x*x",
       "C9 ww yy Q={0.4u*v(ww,yy)+0.1u*v(ww,yy)*v(ww,yy)*v(ww,yy)}"},
      {"C9 ww yy Q={ 1u*x } Rser=100", "C9 ww x 1u\nR9 x yy 100"},
      {"V9 yy 0 sin(1 2 1k) Rser=2k Cpar=10n", "V9 yy x sin(1 2 1k)\nR9 x 0 2k\nC9 yy 0 10n"},
      {"L9 ww yy 10m Rser=0 Rpar=0 Cpar=0 Ipk=2", "L9 ww yy 10m"}, /* no short across it */
      {"L9 ww yy 10m Rser=50 Rpar=0 Cpar=0.0", "L9 ww x 10m\nR9 x yy 50"},
      {"D9 ww y\xe2\x80\x8by d9 2.5\n.model d9 D(is=1n rs=0.1)",
       ".model d9 D(is=1n rs=0.1)\nD9 ww yy d9 area=2.5"},
      {"D9 ww yy d9 {5/2}\n.model d9 D(is=1n rs=0.1)",
       ".model d9 D(is=1n rs=0.1)\nD9 ww yy d9 area=2.5"},
      {"L9 ww x 10m\nR9 x yy 50\nL8 s8 0 1m\nL7 s7 0 2m\nR8 s8 0 100\nR7 s7 0 9\nK1 L9 L8 L7 0.9",
       "L9 ww x 10m\nR9 x yy 50\nL8 s8 0 1m\nL7 s7 0 2m\nR8 s8 0 100\nR7 s7 0 9\nK1 L9 L8 0.9\n"
       "K2 L9 L7 0.9\nK3 L8 L7 0.9"},
      {"V9 v9 0 PWL REPEAT FOREVER (0 0 10u 1 50u 1 60u 0 100u 0) ENDREPEAT\nR9 v9 yy 1k",
       "V9 v9 0 PULSE(0 1 0 10u 10u 40u 100u)\nR9 v9 yy 1k"},
      {"V9 v9 0 pwl repeat forever (0 0, 5u 0, 10u 1, 50u 1, 60u 0, 100u 0) endrepeat\n"
       "R9 v9 yy 1k",
       "V9 v9 0 PULSE(0 1 5u 5u 10u 40u 100u)\nR9 v9 yy 1k"},
      {"V9 v9 0 PWL REPEAT FOREVER (0 0 400u 1 500u 0) ENDREPEAT\nR9 v9 yy 1k",
       "V9 v9 0 PWL(0 0 400u 1 500u 0) r=0\nR9 v9 yy 1k"},
      {".model d9 D(is=1n rs=0.1 mfg=Somebody type=silicon Vpk=400 Iave=1)\nD9 ww yy d9",
       ".model d9 D(is=1n rs=0.1)\nD9 ww yy d9"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double ends[2];
    run_bench(ROWS[k].by_hand, ends, __LINE__);
    bench_gives(ROWS[k].short_form, ends[0], ends[1], 1e-5, __LINE__);
  }
}

/* What is said of what was changed; and what cannot be. Lines count from 16 on. */
static void constructs_are_told(void) {
  static const struct {
    const char *lines, *says;
  } TOLD[] = {
      {"B1 yy 0 V=IF(V(ss)>1,\n+ 5, IF(V(ss)>0,6,7))",
       "d.cir:17:6: warning: IF(a, b, c), PSpice's and LTspice's, is read as a > 0.5 ? b : c (2 "
       "times"},
      {"L9 ss yy 1m Rser=1", "d.cir:16:1: warning: Rser, Lser, Rpar, Cpar and RLshunt, LTspice's"},
      {"S1 ss yy ss 0 sd\n.model sd SW(Ron=1 Roff=1Meg Vt=1 Vh=-0.5)",
       "d.cir:17:35: warning: Vh below 0"},
      {"B1 yy 0 V=1 tripdv=1", "d.cir:16:13: warning: tripdv and tripdt"},
      {"B1 yy 0 V=-V(ss)**3", "d.cir:16:12: warning: x^y, x**y and pow(x, y) are powers of |x|"},
      {"B1 yy 0 V=1+(2*V(ss)-5) ^ 2.5", "are powers of |x|"},
      {"B1 yy 0 V=pow(V(ss),3)", "d.cir:16:15: warning: x^y, x**y"},
      {"B1 yy 0 I=I(Vt)^{2.5+1}", "are powers of |x|"},
      {"X1 ss yy a-b\n.subckt a-b p q R=1\nR1 p q {R}\n.ends",
       "d.cir:17:1: warning: a subcircuit with parameters is found by ngspice if its name"},
      {"R9 ss yy 1M", "d.cir:16:10: warning: a resistance in M is one in milliohm"},
      {".param y=1 x=1M\nR9 ss yy {x}",
       "d.cir:16:14: warning: a number in M of a .param is one in milli"},
      {".param y=1Meg z=2m x = {2.2MOhm}\nR9 ss yy {x}",
       "d.cir:16:25: warning: a number in M of a .param is one in milli, as SPICE knows no "
       "capitals; write Meg for mega, or m\n"},
      {".model m9 d\n.subckt x9 p q\n.model m9 d(n=2)\n.model M9 d(n=3)\nD1 p q m9\n.ends\nX9 ss "
       "yy x9",
       "d.cir:19:1: warning: a second .model M9: ngspice takes the first, of line 18"},
      {".subckt x9 p q\nR1 p q 1\n.ends\n.subckt X9 p q\nR1 p q 2\n.ends\nX9 ss yy x9",
       "d.cir:19:1: warning: a second .subckt X9: ngspice takes the first, of line 16"},
      {".subckt x9 p q\nR1 p q 1\n.ends x8\nX9 ss yy x9",
       "d.cir:18:7: warning: this .ends closes subcircuit x9 of line 16, and not x8"},
      {"R9 ss yy -5k", "d.cir:16:10: warning: a resistance below 0 is a source of energy"},
      {"C9 ss yy -1n", "d.cir:16:10: warning: a capacitance below 0 is a source of energy"},
      {"L9 ss yy -1m", "d.cir:16:10: warning: an inductance below 0 is a source of energy"},
      {"R9 ss yy 0", "d.cir:16:10: warning: ngspice has no resistance of 0 ohm"},
      {"C9 ss yy 47", "d.cir:16:10: warning: a capacitance above 1 F"},
      {"C9 ss yy 1F", "d.cir:16:10: warning: a capacitance in F is one in femtofarad"},
      {"V9 ss yy pulse(0 5 1m 0 0 1m 5m)",
       "d.cir:16:10: warning: an edge of PULSE that is 0 or left out lasts as long as the run's"},
      {"I9 ss yy DC 0\n+ PULSE (0, 1m, {1m+0}, 1n, 0.0s, 1m)", "d.cir:17:3: warning: an edge of"},
      {"V9 ss yy PULSE 0 1", "d.cir:16:10: warning: an edge of PULSE"},
      {"B1 yy 0 V=IF(1>0,1,2)*pwr(2,3)", "d.cir:16:23: warning: pwr(x, y) is sgn(x)*|x|^y"},
      {"R9 ss yy 1k\n.model m res(r=2)", "d.cir:17:14: warning: R= of a model RES multiplies"},
      {"*$ compat ps\nS1 ss yy ss 0 sw1\n.model sw1 VSWITCH(Ron=1k)",
       "d.cir:18:1: warning: a switch of PSpice's without Ron"},
      {"*$ compat ps\nC9 ss yy cm 1n\n.model cm CAP(C=1 VC1=0.1)",
       "d.cir:18:19: warning: ngspice has no such parameter in a model of this type"},
      {"L9 ss yy lm 1u\n.model lm IND(L=1 IL1=0.1)",
       "d.cir:17:19: warning: ngspice has no such parameter in a model of this type"},
      {".model m d(is=1n\n+ foo=3)\nD9 ss yy m",
       "d.cir:17:3: warning: ngspice has no such parameter in a model of this type"},
  };
  static const struct {
    const char *lines, *at, *says;
  } REFUSED[] = {
      {"B1 yy 0 V=dnlim(V(ss),1,0.1)", "d.cir:16:11", "max(x, least)"},
      {"B1 yy 0 V=1+uplim(V(ss),1,0.1)", "d.cir:16:13", "min(x, most)"},
      {"B1 yy 0 V=delay(V(ss),1u)", "d.cir:16:11", "T1 a 0 b 0"},
      {"B1 yy 0 V=rand(time)", "d.cir:16:11", "random anew"},
      {"B1 yy 0 V=IF(V(ss)>1,2)", "d.cir:16:11", "it has 2"},
      {"B1 yy 0 V=table(V(ss),1,2,3)", "d.cir:16:11", "pairs of numbers"},
      {"R9 ss yy {idt(1)}", "d.cir:16:11", "belongs into a B source"},
      {"V9 yy 0 PWL(0 0 +1u 5)", "d.cir:16:17", "time from the point before"},
      {"V9 yy 0 PWL REPEAT FOR 5 (0 0 1u 1) ENDREPEAT", "d.cir:16:13", "REPEAT FOREVER"},
      {"V9 yy 0 PWL(0 0 1 5) TIME_SCALE_FACTOR=1u", "d.cir:16:22", "as they come out"},
      {"K1 L1 L2 0.9 core", "d.cir:16:10", "a core's model"},
      {"B1 yy 0 2*V(ss)", "d.cir:16:1", "V=... or I=..."},
      {"B1 yy 0 R=5", "d.cir:16:1", "R1 a b R={...}"},
      {"L9 ss yy Flux=1m*tanh(5*x)", "d.cir:16:10", "B source"},
      {"L9 ss yy 1m Rser=1 m=2", "d.cir:16:20", "one by one"},
      {"E1 yy 0 LAPLACE {V(ss)} = {1/(1+s)}", "d.cir:16:9", "R, L"},
      {"E1 yy 0 TABLE V(ss) (0,0) (1,1)", "d.cir:16:9", "TABLE {x}"},
      {".model m D(Ron=1m Roff=1Meg Vfwd=0.7)", "d.cir:16:12", "ideal diode"},
      {".model n D(is=1n)\n.model m AKO:n D(is=2n)", "d.cir:17:10", "'*$ compat ps'"},
      {".model n D(is=1n)\n.model m AKO: n D(is=2n)", "d.cir:17:10", "'*$ compat ps'"},
      {".model n D(is=1n)\n.model m AKO: n NUMD", "d.cir:17:1", "'numd'"},
      {".model m VSWITCH(Von=1 Voff=0)", "d.cir:16:10", "'*$ compat ps'"},
      {".model m d(is=1n T_ABS=30)", "d.cir:16:18", "'*$ compat ps'"},
      {"*$ compat ps\n.model m RES(R=2 TC1=0.01 T_ABS=77)", "d.cir:17:14", "multiplies what"},
      {"*$ compat ps\n.model m CAP (TC1=0.01\n+ c=1k)", "d.cir:18:3", "multiplies what"},
      {".model m ind(L={k})\n.param k=2", "d.cir:16:14", "multiplies what"},
      {"*$ compat ps\n.model m d(is=1n T_REL_LOCAL=30)", "d.cir:17:18", "T_REL_GLOBAL"},
      {"L9 ss yy 1m\n.ic V(ss)=0 i(L9)=0.1", "d.cir:17:1", "by IC=... in the line of L9"},
      {"L9 ss yy 1m\n.ic\n+ I ( L9 ) = 0.1", "d.cir:17:1", "by IC=... in the line of L9"},
      {"V9 yy 0 sin(0 1 50 0 0 0 3)", "d.cir:16:9", "cycles"},
      {"V9 yy 0 PWL(0 0 1m 0 +1u 5)", "d.cir:16:22", "times from t = 0"},
      {"A1 ss 0 0 0 0 yy 0 0 DFLOP td=1m", "d.cir:16:22", "LTspice's own"},
      {"R_R1 $N_0001 yy 1k", "d.cir:16:6", "'*$ compat ps'"},
  };
  for (size_t k = 0; k < COUNT(TOLD); k++) {
    write_bench(TOLD[k].lines);
    warns("check d.cir", 0, TOLD[k].says, __LINE__);
  }
  for (size_t k = 0; k < COUNT(REFUSED); k++) {
    write_bench(REFUSED[k].lines);
    refused_there(REFUSED[k].at, REFUSED[k].says, __LINE__);
  }
}

/* Edges that are given, or are formulas, or never come are not told of. */
static void pulses_with_edges(void) {
  write_file("d.cir", BENCH ".param edge=1u\nV9 p1 0 pulse(0 5 1m 1u 1u 1m 5m)\nR9 p1 yy 1k\n"
                            "V8 p2 0 PULSE 0 5 1m {edge} '2*edge' 1m\nR8 p2 yy 1k\n"
                            "V7 pulse 0 pulse(0 5 0 1u)\nR7 pulse yy 1k\n");
  ran r = run("check d.cir");
  EXPECT(r.status == 0 && !strstr(r.err, "PULSE"), "%d %s", r.status, r.err);
  free_ran(&r);
}

/* A switch with one threshold and its hysteresis has no Von and Voff, and none are taken for it. */
static void switches_with_a_threshold(void) {
  write_file("d.cir", BENCH "*$ compat ps\nS1 ss yy ss 0 sw1\n"
                            ".model sw1 VSWITCH(Ron=1k Roff=3k VT=3 VH=0)\n");
  ran r = run("check d.cir");
  EXPECT(r.status == 0 && !strstr(r.err, "a switch of PSpice's"), "%d %s", r.status, r.err);
  free_ran(&r);
}

/* ---- numbers, and messages ---- */

static void numbers_that_are_misread(void) {
  static const struct {
    const char *lines, *at, *says;
  } ROWS[] = {
      {"R9 ss yy 4k7", "d.cir:16:10", "write 4.7k"},
      {"R9 ss yy 4R7", "d.cir:16:10", "reads 4 and leaves the rest out; write 4.7"},
      {"C9 ss yy 2n2 ic=0", "d.cir:16:10", "write 2.2n"},
      {"L9 ss yy\n+ 1Meg5", "d.cir:17:3", "write 1.5Meg"},
      {"R9 ss yy 4,7k", "d.cir:16:10", "a point"},
      {"V9 ss yy 2,5", "d.cir:16:10", "a point"},
      {".model m SW(Vt=1,5 Vh=0,1)", "d.cir:16:16", "'1,5': a decimal point is wanted"},
      {".model m D(n=1\n+ , rs = 0,5)", "d.cir:17:10", "'0,5': a decimal point"},
      {".model m D(n=1,is=2,5n,rs=1)", "d.cir:16:19", "'2,5n': a decimal point"},
      {".param y=1 x=4,7k", "d.cir:16:14", "'4,7k': a decimal point"},
      {".param x=-2,5", "d.cir:16:10", "'-2,5': a decimal point"},
      {".model m SW(ron=2,5e3 vt=1)", "d.cir:16:17", "'2,5e3': a decimal point is wanted"},
      {".ic v(b)=1,5", "d.cir:16:10", "a decimal point"},
      {".nodeset v(b)=1 v(yy)=1,5", "d.cir:16:23", "a decimal point"},
      {"C9 ss yy 1n ic=1,5", "d.cir:16:16", "a decimal point"},
      {"X1 ss yy s R=4,7k\n.subckt s a b R=1\nR1 a b {R}\n.ends", "d.cir:16:14", "a decimal point"},
      {"R9 ss yy 1.2.3", "d.cir:16:10", "one point"},
      {"R9 ss yy 1,000.5", "d.cir:16:10", "a point"},
      {"R9 ss yy 0x10", "d.cir:16:10", "ngspice reads 0x and leaves"}, /* none of an ohm */
      {"R9 ss yy 4k7ohm", "d.cir:16:10", "ngspice reads 4k and leaves"},
      {"R9 ss yy 1e3e3", "d.cir:16:10", "leaves the rest out"},
      {"B1 yy 0 V=V(ss)*1_000", "d.cir:16:17", "ngspice reads 1 and leaves"},
      {"C9 ss yy 100n 50V", "d.cir:16:15", "second number"}, /* 50 F in ngspice */
      {"R9 ss yy 5k 1%", "d.cir:16:13", "second number"},
      {"L9 ss yy 10u 5A", "d.cir:16:14", "second number"},
      {"R9 ss yy 10 k", "d.cir:16:13", "10k"},
      {"R9 ss yy 10 kOhm", "d.cir:16:13", "10kOhm"},
      {"C9 ss yy 10 uF", "d.cir:16:13", "10uF"},
      {"R9 ss yy 10 \xce\xa9", "d.cir:16:13", "without a blank"},
      {".param q={2*4k7}", "d.cir:16:13", "write 4.7k"},
      {"V9 yy 0 sin(0 4k7 50)", "d.cir:16:15", "write 4.7k"},
      {"B1 yy 0 V=V(ss)*1k5", "d.cir:16:17", "write 1.5k"},
      {".model m d(is=1n5)", "d.cir:16:15", "write 1.5n"},
      {"X1 ss yy s R=4k7\n.subckt s a b R=1\nR1 a b {R}\n.ends", "d.cir:16:14", "write 4.7k"},
      {".param a = 5 V c=1", "d.cir:16:14", "leaves out 'V' behind this value; one expression"},
      {".param b=1\n.param a = b +\n+ c=1", "d.cir:17:14", "leaves out '+'"},
      {".subckt s p q a=1\n+ k 2 b=2\nR1 p q 1\n.ends", "d.cir:17:3", "leaves out 'k 2'"},
      {".model m sw(ron=1 + vt=1)", "d.cir:16:19", "leaves out '+'"},
      {".param b=1\nR9 ss yy b +1", "d.cir:17:12", "'b +1' may be a sum or two values"},
      {".param b=1\nE9 yy 0 ss 0 b -1", "d.cir:17:16", "write {b -1} for a sum"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_bench(ROWS[k].lines);
    refused_there(ROWS[k].at, ROWS[k].says, __LINE__);
  }
  /* names that look like such numbers, and numbers that are well */
  write_file("d.cir", BENCH "D9 yy 0 1N4148\n.model 1N4148 D(is=2n)\nR9 ss yy 1kOhm\n"
                            "Q9 yy 0 0 2N2222\n.model 2N2222 NPN(bf=1e2)\nR8 yy 4k7 1e3k\n"
                            "R7 4k7 0 2.2MEG\nB1 1k5 0 V=V(4k7)\nR6 1k5 0 1u\n");
  ran r = run("check d.cir");
  EXPECT(r.status == 0 && !strstr(r.err, "1n4148"), "%s", r.err);
  free_ran(&r);
  /* commas between parameters and in lists */
  write_file("d.cir",
             BENCH ".param x=1,y={max(1,2)} z=2\n.model m D(IS=1n,N=1, RS=1)\nD9 yy 0 m\n"
                   ".model p pwl(x_array=[0,1,2,5] y_array=[0,1,2,3])\nA9 ss zz p\n"
                   "R9 zz 0 1k tc=1,2\nR8 zz 0 1k TC = 1,2\nQ9 yy 0 0 q\n.model q NPN(bf=1e2)\n");
  r = run("check d.cir");
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
}

/* The place of what ngspice says. */
static void messages_have_places(void) {
  static const struct {
    const char *lines, *at, *says;
  } ROWS[] = {
      {"B1 yy 0 V=foo(V(ss))", "d.cir:16:11", "'foo'"},
      {"B1 yy 0 V=IF(V(ss)>1,foo(1),2)", "d.cir:16:22", "'foo'"},
      {"B1 yy 0 V=V(ss)+*2", "d.cir:16:1", "parsing stopped at"},
      {"B1 yy 0 V=V(nowhere)", "d.cir:16:13", "nowhere"},
      {"X1 ss yy s\n.subckt s a b c\nR1 a b 1\n.ends", "d.cir:16:1", "Too few parameters"},
      {"X1 ss yy nosub", "d.cir:16:1", "nosub"},
      {"R9 ss yy nomodel", "d.cir:16:10", "nomodel"},
      {"B1 yy 0 V=ln(-v(ss))", "d.cir:16:11", "out of range"},
      {"B1 yy 0 V=V(ss)**-2", "d.cir:16:16", "max(abs(x), 1u)"},
      {"B1 yy 0 V=abs(V(ss)) ^ 0.5", "d.cir:16:22", "max(abs(x), 1u)"},
      {".if (x>1)\nR9 ss yy 1\n.endif", "d.cir:16:6", "[x]"},
      {"R9 ss yy {unk}\n+ tc1=0", "d.cir:16:11", "[unk]"},
      {".param x=2\nV9 zz 0 PULSE(0 {x}*2 1u 1u 1u 1 2)\nR9 zz 0 1k", "d.cir:17:1",
       "parameter (*)"},
      {"R9 ss yy\n+ {unk}", "d.cir:17:4", "[unk]"},
      {"V9 ss 0 1", "d.cir:11:1", "singular"},
      {"F1 yy 0 Vnone 2", "d.cir:16:1", "vnone"},
      {"L9 ss yy 1m Rser={unk}", "d.cir:16:19", "[unk]"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_bench(ROWS[k].lines);
    refused_there(ROWS[k].at, ROWS[k].says, __LINE__);
  }
}

/* ---- LIMIT, of PSpice's dialect a cut-off and no chance ---- */

/* halfwave_snubbed with its second line, and lines before the EVA's and at its end. */
static void make_deck(const char *second, const char *lines, const char *last) {
  char *text = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  char *eva = strstr(text, "Xeva "), *rest = strchr(text, '\n') + 1;
  CU_ASSERT_PTR_NOT_NULL_FATAL(eva);
  vs_text deck = {0};
  vs_text_add(&deck, "%.*s%s%.*s%s\n%s%s", (int)(rest - text), text, second, (int)(eva - rest),
              rest, lines, eva, last);
  write_file("d.cir", deck.text);
  vs_text_free(&deck);
  free(text);
}

#define PROBE "*$ probe y_v = v(yy) V \"of the test\"\nR99 yy 0 1k\nVss ss 0 sin(0 300 1k)\n"

/* v(ss) is 300 V either way, so that both ends are met. */
static void limit_of_three(void) {
  static const char *const FORMS[] = {"E9 yy 0 VALUE={LIMIT(V(ss),-10,12)}",
                                      "B9 yy 0 V=limit(V(ss),-10,12)",
                                      "B9 yy 0 V={Limit(max(V(ss),-1e6),{-5-5},min(12,13))}",
                                      "E9 yy 0 VALUE={\n+ LIMIT(V(ss),\n+ -10,12)}",
                                      ".param q9={limit(120,-10,12)} q8={limit(-120,-10,12)}\n"
                                      "B9 yy 0 V=V(ss)>0?{q9}:{q8}"};
  static const char DIALECT[] = "*$ compat ps\n";
  for (size_t k = 0; k < COUNT(FORMS); k++)
    for (int late = 0; late < 2; late++) {
      vs_text lines = {0};
      vs_text_add(&lines, PROBE "%s", FORMS[k]);
      make_deck(late ? "" : DIALECT, lines.text, late ? DIALECT : "");
      ran r = run(RUN, "d.cir");
      EXPECT(r.status == 0, "%s: %d %s", FORMS[k], r.status, r.err);
      /* one step of ngspice may cross the corner: nothing is between 10 and 12 but its rounding */
      vs_close(number(r.out, "y_v_max"), 12, 12, 1e-6, FORMS[k], __LINE__);
      vs_close(number(r.out, "y_v_min"), -10, 10, 1e-6, FORMS[k], __LINE__);
      free_ran(&r);
      vs_text_free(&lines);
    }
}

static void check_refuses(const char *second, const char *line, const char *says) {
  vs_text lines = {0};
  vs_text_add(&lines, PROBE "%s", line);
  make_deck(second, lines.text, "");
  ran r = run("check paper --set circuit.deck=d.cir");
  const char *at = strstr(r.err, "d.cir:");
  int number = at ? atoi(at + 6) : 0;
  EXPECT(r.status == 2 && number > 0 && strstr(r.err, says), "%s: %d %s", line, r.status, r.err);
  free_ran(&r);
  vs_text_free(&lines);
}

/* With two it is ngspice's own, which is drawn; PSpice's has three, right behind its name. */
static void other_limits(void) {
  static const char DIALECT[] = "*$ compat ps\n", THREE[] = "LIMIT(x, least, most)";
  check_refuses("", "B9 yy 0 V=limit(V(ss),-10,12)", "'*$ compat ps'");
  check_refuses("", "V9 yy 0 {limit(10,1)}", "random");
  check_refuses(DIALECT, "V9 yy 0 {limit(10,1)}", THREE);
  check_refuses(DIALECT, "B9 yy 0 V=limit(V(ss),10)", THREE);
  check_refuses(DIALECT, "B9 yy 0 V=limit (V(ss),-10,12)", THREE);
  check_refuses(DIALECT, "V9 yy 0 {gauss(10,1,3)}", "random");
}

/* ---- names that ngspice keeps for itself, and the user gives ---- */

/* Adds a form to the text: %N is a name, %V a value, %K a number. */
static void add_form(vs_text *text, const char *form, const char *name, size_t k) {
  for (const char *s = form; *s; s++)
    if (s[0] == '%' && s[1] == 'N')
      vs_text_add(text, "%s", name), s++;
    else if (s[0] == '%' && s[1] == 'V')
      vs_text_add(text, "%zu", 1000 + k), s++;
    else if (s[0] == '%' && s[1] == 'K')
      vs_text_add(text, "%zu", k), s++;
    else
      vs_text_add(text, "%c", *s);
}

/* Names that ngspice's manual has in one of its readers of expressions: numparam's, the B source's,
 * that of commands and .measure; and others that a user's parameter may have. */
static const char *const CANDIDATES[] = {
    "e",      "pi",      "c",           "i",           "v",       "kelvin",  "echarge", "boltz",
    "planck", "true",    "false",       "yes",         "no",      "time",    "temper",  "hertz",
    "temp",   "vt",      "gmin",        "tnom",        "defl",    "defw",    "reltol",  "m",
    "r",      "l",       "q",           "d",           "w",       "x",       "abs",     "acos",
    "acosh",  "asin",    "asinh",       "atan",        "atanh",   "ceil",    "cos",     "cosh",
    "exp",    "floor",   "ln",          "log",         "log10",   "max",     "min",     "nint",
    "pow",    "pwr",     "pwl",         "sgn",         "sin",     "sinh",    "sqr",     "sqrt",
    "tan",    "tanh",    "u",           "u2",          "uramp",   "ddt",     "gauss",   "agauss",
    "unif",   "aunif",   "limit",       "ternary_fcn", "int",     "arctan",  "and",     "or",
    "not",    "div",     "mod",         "if",          "else",    "end",     "while",   "macro",
    "funct",  "defined", "include",     "for",         "to",      "downto",  "is",      "var",
    "ac",     "dc",      "tran",        "op",          "all",     "mag",     "ph",      "re",
    "im",     "real",    "imag",        "db",          "j",       "length",  "mean",    "rnd",
    "sunif",  "poisson", "exponential", "vector",      "unitvec", "deriv",   "integ",   "norm",
    "round",  "atan2",   "hypot",       "table",       "freq",    "poly",    "value",   "vol",
    "cur",    "tol",     "off",         "ic",          "stp",     "pwrs",    "idt",     "sdt",
    "inv",    "buf",     "nan",         "inf",         "minimum", "maximum", "avg",     "rms",
    "vm",     "vp",      "params",      "tc1",         "tc2"};

/* What plain ngspice makes of a parameter of that name: true where each place that has expressions
 * gives the parameter's value. */
static bool is_free(const char *name, const char *options) {
  static const char DECK[] =
      "t\n.param %N=1000 q9={%N+0}\nIr 0 r 1\nR1 r 0 {%N}\nB2 b 0 V=%N\nRb b 0 1\nE3 c 0 "
      "value={%N}\nRc c 0 1\nV4 d 0 {q9}\nRd d 0 1\nIm 0 n 1\n.model rm r(r={%N})\nR5 n 0 rm\nXs f "
      "s %N=1000\nRf f 0 1\n.subckt s p %N=3\nB1 p 0 V=2*%N-%N\n.ends\nE6 g 0 r 0 {%N/1k}\nRg g 0 "
      "1\nG7 0 h r 0 {%N/1k}\nRh h 0 1\n.control\nop\nprint "
      "v(r)+v(b)+v(c)+v(d)+v(n)+v(g)+v(h)+v(f)\n.endc\n.end\n";
  vs_text deck = {0};
  char command[128];
  add_form(&deck, DECK, name, 0);
  write_file("plain.cir", deck.text);
  vs_text_free(&deck);
  snprintf(command, sizeof command, "timeout 60 ngspice %s -b plain.cir >plain.log 2>&1", options);
  const int status = system(command);
  char *log = read_file("plain.log");
  const char *found = status == -1 ? NULL : strstr(log, "+v(f) = ");
  const bool free_name = found && fabs(strtod(found + 8, NULL) - 8000) < 0.01;
  free(log);
  return free_name;
}

/* The list has those names that plain ngspice misreads, and no others but `var`, which is free in
 * ngspice 39. */
static void list_of_names(void) {
  if (is_for_memory_alone()) return;
  if (system("ngspice --version >plain.log 2>&1")) {
    puts("ngspice is not on the PATH: the list of its names is not tried");
    return;
  }
  size_t listed = 0;
  for (int pspice = 0; pspice < 2; pspice++)
    for (size_t k = 0; k < COUNT(CANDIDATES); k++) {
      const bool is = vs_reserved_is(CANDIDATES[k], pspice);
      listed += pspice && is;
      const bool free_name = is_free(CANDIDATES[k], pspice ? "-D ngbehavior=psa" : "");
      EXPECT(is == !free_name || (is && !strcmp(CANDIDATES[k], "var")), "%s%s: the list has it: %d",
             CANDIDATES[k], pspice ? " in PSpice's dialect" : "", is);
    }
  size_t all = 0;
  bool pspice;
  while (vs_reserved_at(all, &pspice)) all++;
  CU_ASSERT_EQUAL(listed, all); /* each was tried */
}

/* Each name in turn has a value of its own in each place; y is how far off all of them are. */
static const char *const PLACES[] = {
    ".param %N=%V\nB%K y%K 0 V=exp(0)*%N",
    ".param %N=%V\nB%K y%K 0 V={max(%N,min(%N,2))}",
    ".param %N=%V\nV%K y%K 0 {%N}",
    ".param %N=%V w%K={2*%N}\nV%K y%K 0 {w%K/2}",
    "*$ param %N = %V 1..1e6 \"of the test\"\nE%K y%K 0 value={%N}",
    ".param %N=%V\nV%K r%K 0 2\nE%K y%K 0 r%K 0 {%N/2}",
    ".param %N=%V\nV%K r%K 0 2\nG%K 0 y%K r%K 0 {%N/2}\nRy%K y%K 0 1",
    ".param %N=%V\nI%K 0 y%K 1\nRy%K y%K 0 %N",
    ".param %N=%V\nI%K 0 y%K 1\nRy%K y%K 0 r='%N'",
    ".param %N=%V\nV%K y%K 0 sin({%N} 0 1k)",
    ".param %N=%V\nI%K 0 y%K 1\n.model m%K r(r={%N})\nRy%K y%K 0 m%K",
    ".param %N=%V\n.func f%K(a) {a*%N}\nB%K y%K 0 V=f%K(1)",
    ".func f%K(%N) {%N*2}\nB%K y%K 0 V=f%K(%V)/2",
    ".param %N=%V\n.if (%N > 5)\nV%K y%K 0 {%N}\n.else\nV%K y%K 0 7\n.endif",
    "X%K y%K s%K %N=%V\n.subckt s%K p params: %N=3\nB1 p 0 V=%N\n.ends",
    ".param %N=%V\nX%K y%K s%K %N = {%N}\n.subckt s%K p %N=3\nX1 p t%K q=%N\n.ends\n.subckt t%K p "
    "q=1\nB1 p 0 V=q\n.ends",
    ".param %N=7\n.subckt u%K p\n.param %N=%V\n.subckt i%K p\nB1 p 0 V={%N}\n.ends\nX1 p "
    "i%K\n.ends\nX%K y%K u%K"};

static void write_places(const char *form, const char *dialect, bool capitals) {
  vs_text lines = {0}, sum = {0};
  bool pspice;
  const char *at;
  vs_text_add(&lines, PROBE);
  for (size_t k = 0; (at = vs_reserved_at(k, &pspice)); k++) {
    char name[32];
    snprintf(name, sizeof name, "%s", at);
    if (capitals) *name = (char)toupper((unsigned char)*name);
    if (pspice && !*dialect) continue;
    add_form(&lines, form, name, k);
    add_form(&lines, "\nRload%K y%K 0 1Meg\n", name, k);
    add_form(&sum, "+abs(v(y%K)-%V)", name, k);
  }
  vs_text_add(&lines, "Btotal yy 0 V=1%s", sum.text);
  make_deck(dialect, lines.text, "");
  vs_text_free(&lines);
  vs_text_free(&sum);
}

static void names_of_ngspice(void) {
  for (size_t f = 0; f < COUNT(PLACES); f++)
    for (int pspice = 0; pspice < 2; pspice++) {
      write_places(PLACES[f], pspice ? "*$ compat ps\n" : "", f % 2);
      ran r = run("run paper --set circuit.deck=d.cir --tier circuit --until 1ms --set "
                  "run.verify=never --json --quiet");
      EXPECT(r.status == 0, "%s: %d %s", PLACES[f], r.status, r.err);
      /* a current into a resistor beside 1 Mohm: 0.1 % of each of 45, which are 1000 */
      const bool beside = strstr(PLACES[f], "Ry%K") != NULL;
      vs_close(number(r.out, "y_v_max"), 1, 1, beside ? 50 : 1e-6, PLACES[f], __LINE__);
      free_ran(&r);
    }
}

/* pi and e are numbers where nobody defines them, and only there. */
static void constants_of_ngspice(void) {
  make_deck("",
            PROBE "*$ param limits = 1000 1..1e6 \"x\"\n.param expo=2 timer=3 w={pi*expo}\n"
                  "V8 yz 0 {w+e}\nR98 yz 0 1k\n.subckt s9 p pi=10\nB1 p 0 V=pi\n.ends\nX9 yx 0 s8\n"
                  ".subckt s8 p n\nX1 p s9\nR2 p n {limits*timer*pi}\n.ends\n"
                  "B9 yy 0 V=v(yz)-2*pi-e+v(yx)",
            "");
  ran r = run(RUN, "d.cir");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  vs_close(number(r.out, "y_v_max"), 10, 10, 1e-9, "constants", __LINE__);
  free_ran(&r);
}

/* A message has the user's name, and so has the list of keys. */
static void names_are_told(void) {
  make_deck("", PROBE "*$ param e = 1000 1..1e6 \"of the test\"\nR98 yy 0 {e*missing}", "");
  ran r = run("check paper --set circuit.deck=d.cir");
  EXPECT(r.status == 2 && strstr(r.err, "missing") && !strstr(r.err, "__own"), "%s", r.err);
  free_ran(&r);
  make_deck("", PROBE "*$ param e = 1000 1..1e6 \"of the test\"\nR98 yy 0 {e}", "");
  r = run("list parameters --deck d.cir");
  EXPECT(r.status == 0 && strstr(r.out, "circuit.e "), "%s%s", r.out, r.err);
  free_ran(&r);
  check_refuses("", ".param e__own=3", "the program makes such names");
}

/* The exported netlist is right in plain ngspice. */
static void names_in_an_export(void) {
  if (system("ngspice --version >plain.log 2>&1")) return;
  make_deck("", PROBE ".param E=50 pi=3\nB9 yy 0 V=E*pi", "");
  run_good("export paper --set circuit.deck=d.cir --set run.until=1ms -o x.cir", __LINE__);
  EXPECT(!system("timeout 120 ngspice -b x.cir >plain.log 2>&1"), "%s", "ngspice fails");
  char *table = read_file("x.txt"), *name = strstr(table, "y_v_v"), *row = strchr(table, '\n');
  double value = 0;
  for (char *s = table + strspn(table, " "); name && s <= name;
       s += strcspn(s, " "), s += strspn(s, " "))
    value = strtod(row, &row);
  vs_close(value, 150, 150, 1e-6, "y_v of the export", __LINE__);
  free(table);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"encodings", encodings},
      {"places in encodings", places_in_encodings},
      {"skipped statements", skipped_statements},
      {"refused statements", refused_statements},
      {"libraries", libraries},
      {"of a library only what is called is read", what_is_called},
      {"functions", functions},
      {"values with blanks", values_with_blanks},
      {"integrals", integrals},
      {"parasitic parts", parasitic_parts},
      {"constructs are told", constructs_are_told},
      {"pulses with edges", pulses_with_edges},
      {"switches with a threshold", switches_with_a_threshold},
      {"numbers that are misread", numbers_that_are_misread},
      {"messages have places", messages_have_places},
      {"LIMIT of three cuts off", limit_of_three},
      {"other limits are refused", other_limits},
      {"the list of ngspice's names", list_of_names},
      {"names of ngspice's own", names_of_ngspice},
      {"constants of ngspice's own", constants_of_ngspice},
      {"names are told", names_are_told},
      {"names in an export", names_in_an_export},
  };
  return program_suite("dialects", TESTS, COUNT(TESTS));
}
