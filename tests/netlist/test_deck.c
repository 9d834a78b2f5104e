/* SPDX-License-Identifier: GPL-3.0-or-later
 * The netlist contract beyond ports and probes: formulas, losses and stores and what the energy
 * audit makes of them, ratings, parts by name, dialects, and the place of what ngspice refuses. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "measure/verdict.h"
#include "suite.h"

/* ---- formulas ---- */

/* v(n) is term 0, v(n,m) 1, i(Vx) 2; a is name 0, b_2 name 1 */
static int term_of(void *ctx, const char *at, const vs_formula_term *term) {
  (void)ctx;
  CU_ASSERT_EQUAL(tolower((unsigned char)*at), term->quantity);
  CU_ASSERT_STRING_EQUAL(term->first, term->quantity == 'i' ? "vx" : "n");
  return term->quantity == 'i' ? 2 : strcmp(term->second, "0") != 0;
}
static int name_of(void *ctx, const char *at, const char *name) {
  (void)ctx;
  CU_ASSERT_EQUAL(tolower((unsigned char)*at), *name);
  return strcmp(name, "a") ? strcmp(name, "b_2") ? -1 : 1 : 0;
}
static const vs_formula_scope SCOPE = {.term = term_of, .name = name_of};

static void formulas_give_their_values(void) {
  static const double TERMS[] = {3, -2, 0.5}, OTHERS[] = {-5, 7, 0.25}, NAMES[] = {10, 4};
  static const struct {
    const char *text;
    double value;
  } ROWS[] = {{"1+2*3", 7},
              {"(1+2)*3", 9},
              {"8/4/2", 1},
              {"10-3-2", 5},
              {"2^3^2", 512},
              {"-2^2", -4},
              {"2^-1", 0.5},
              {"2*-3", -6},
              {"--1", 1},
              {" v( n ) * V(n , m)", -6},
              {"i(Vx)^2*{a}", 2.5},
              {"{ 0.5*(A+b_2) }", 7},
              {"1.5k + 2meg/1k - 1m*1k", 3499},
              {"100n*1g", 100},
              {"4.7u", 4.7e-6},
              {"1e-3+.5", 0.501},
              {"abs(v(n,m))+sqrt(9)", 5},
              {"exp(ln(5))+log10(1000)", 8},
              {"pow(v(n,m),3)", -8},
              {"pow(4,0.5)", 2},
              {"pwr(v(n,m),2)", -4},
              {"pwr(v(n,m),2.5)", -5.6568542494923806},
              {"pow(1.1,30)", 17.449402268886407},
              {"min(v(n),{a})+max(1,2)", 5}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_formula f = {0};
    const char *bad = NULL;
    char why[200];
    const char *end = vs_formula_read(ROWS[k].text, &SCOPE, &f, &bad, why, sizeof why);
    EXPECT(end && end[strspn(end, " ")] == '\0', "'%s' is not read to its end", ROWS[k].text);
    if (end) {
      vs_formula_bind(&f, NAMES);
      CLOSE(vs_formula_value(&f, TERMS), ROWS[k].value, 1e-15 * 30); /* rounding, 30 factors */
      double pair[2];
      vs_formula_pair(&f, TERMS, OTHERS, pair);
      CU_ASSERT_EQUAL(pair[0], vs_formula_value(&f, TERMS));
      CU_ASSERT_EQUAL(pair[1], vs_formula_value(&f, OTHERS));
    }
    vs_formula_free(&f);
  }
}

static void bad_formulas_are_refused(void) {
  static const struct {
    const char *text;
    int at; /* where it is seen */
  } ROWS[] = {{"", 0},        {"1+", 2},      {"(1", 2},     {"{1)", 2},    {"v(n", 1},
              {"v()", 1},     {"1q", 1},      {"foo(1)", 3}, {"pow(1)", 5}, {"abs(1,2)", 5},
              {"unknown", 7}, {"i(Vx,n)", 1}, {"*2", 0},     {"1e999", 0},  {"v(a b)", 1}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_formula f = {0};
    const char *bad = NULL;
    char why[200] = "";
    const char *end = vs_formula_read(ROWS[k].text, &SCOPE, &f, &bad, why, sizeof why);
    EXPECT(!end && *why && bad - ROWS[k].text == ROWS[k].at, "'%s': %s at %d", ROWS[k].text,
           end ? "read" : why, end ? -1 : (int)(bad - ROWS[k].text));
    vs_formula_free(&f);
  }
  char deep[400];
  memset(deep, '(', sizeof deep - 1);
  deep[sizeof deep - 1] = '\0';
  vs_formula f = {0};
  const char *bad = NULL;
  char why[200];
  CU_ASSERT_PTR_NULL(vs_formula_read(deep, &SCOPE, &f, &bad, why, sizeof why));
  vs_formula_free(&f);
}

/* ---- decks written here ---- */

#define SUPPLY                                                                                     \
  "*$ port mains = Vm\n"                                                                           \
  "Vm src 0 external\n"                                                                            \
  "Rs src a {r_source}\n"
#define SUPPLY_LOSS "*$ loss r_source = {r_source}*i(Vm)^2\n"
#define EVA "Xeva b 0 eva\n"

/* 100 V, or the armature, which nothing switches off here, would meet its pole. */
static vs_trial *run_deck(const char *deck, const char *set, const char *also) {
  char circuit[128];
  snprintf(circuit, sizeof circuit, "circuit.deck=%s", deck);
  const char *sets[] = {circuit, "run.until=0.04s", "supply.voltage=100V", set, also, NULL};
  return vs_trial_run("paper", "circuit", sets, NULL);
}

static void refuse_deck(const char *text, const char *place, const char *word, int line) {
  write_file("bad.cir", text);
  vs_trial *t = run_deck("bad.cir", NULL, NULL);
  expect(t->status == VS_INPUT && !strncmp(t->err.text, place, strlen(place)) &&
             strstr(t->err.text, word),
         line, "status %d: %s", (int)t->status, t->err.text);
  vs_trial_free(t);
}
#define REFUSE(text, place, word) refuse_deck(text, place, word, __LINE__)

static void accept_deck(const char *text) {
  write_file("good.cir", text);
  vs_trial *t = run_deck("good.cir", NULL, NULL);
  EXPECT(t->status == VS_OK, "status %d: %s", (int)t->status, t->err.text);
  vs_trial_free(t);
}

static void bad_lines_are_refused(void) {
  REFUSE(SUPPLY "*$ loss r = v(a)*\n" EVA, "bad.cir:4:18: ", "wanted");
  REFUSE(SUPPLY "*$ loss r = v(a) v(b)\n" EVA, "bad.cir:4:18: ", "operator");
  REFUSE(SUPPLY "*$ loss r = v(a)\n*$ loss r = v(b)\n" EVA, "bad.cir:5:1: ", "second");
  REFUSE(SUPPLY "*$ store c = {r1}*v(a)^2\n" EVA, "bad.cir:4:15: ", "'r1'");
  REFUSE(SUPPLY "*$ store c = {r_sorce}*v(a)^2\n" EVA, "bad.cir:4:15: ", "did you mean 'r_source'");
  REFUSE(SUPPLY "*$ rating v_a 0..1 V\n" EVA, "bad.cir:4:11: ", "no probe 'v_a'");
  REFUSE(SUPPLY "*$ probe v_a = v(a) V\n*$ rating v_a 0..1 A\n" EVA, "bad.cir:5:20: ", "as V");
  REFUSE(SUPPLY "*$ probe v_a = v(a) V\n*$ rating v_a 1 V\n" EVA, "bad.cir:5:15: ", "MIN..MAX");
  REFUSE(SUPPLY "*$ compat lt\n" EVA, "bad.cir:4:11: ", "there is: ps");
  REFUSE(SUPPLY "*$ port mains = Vn\n" EVA, "bad.cir:4:9: ", "second port mains");
  REFUSE(SUPPLY "*$ port gate Vn\n" EVA, "bad.cir:4:14: ", "'port NAME = SOURCE' is wanted");
  REFUSE(SUPPLY "*$ probe p = v(a) V\n" EVA, "bad.cir:4:10: ", "taken by the machine");
  REFUSE(SUPPLY "*$ probe a = v(a) V\n*$ probe p = v(a) V\n" EVA, "bad.cir:5:10: ", "taken by the");
  REFUSE(SUPPLY "*$ probe v_a = v(a) V\n*$ probe V_A = v(a) V\n" EVA,
         "bad.cir:5:10: ", "probe V_A stands here a second time");
  accept_deck(SUPPLY "Rb a b 1\n" EVA "*$ probe x = v(a,GND) V\n*$ probe y = v(gnd,a) V\n");
  REFUSE(SUPPLY "*$ probe t = v(a) V\n" EVA, "bad.cir:4:10: ", "the program's");
  REFUSE("*$ rate x\n" EVA, "bad.cir:1:4: ", "did you mean");
  REFUSE(SUPPLY "*$ param x = y part 3\n" EVA, "bad.cir:4:21: ", "quotes");
}

/* What ngspice takes without a word, and makes another circuit of; and what it takes rightly. */
static void slips_are_refused(void) {
  static const char TWO[] = SUPPLY "Rb a b 1\n" EVA ".subckt two p q r=1\n.param x=1\n"
                                   "R1 p q {r*x}\n.ends\n";
  char deck[2048];
  snprintf(deck, sizeof deck, "%sX9 a 0 two rr=5\n", TWO);
  REFUSE(deck, "bad.cir:10:12: ", "did you mean 'r'");
  snprintf(deck, sizeof deck, "%sX9 a 0 two r=1\n+ other=5\n", TWO);
  REFUSE(deck, "bad.cir:11:3: ", "it has r, x");
  snprintf(deck, sizeof deck, "%sX9 a 0 two\n+ r=\n+ x=5\n", TWO);
  REFUSE(deck, "bad.cir:11:3: ", "r has no value");
  snprintf(deck, sizeof deck, "%sX9 a 0 two r=5 x = \n", TWO);
  REFUSE(deck, "bad.cir:10:16: ", "x has no value");
  snprintf(deck, sizeof deck, "%sX9 a 0 two r=50 d\n", TWO);
  REFUSE(deck, "bad.cir:10:17: ", "leaves out 'd'");
#define WINDINGS SUPPLY EVA "L8 a 0 1\nL9 p 0 1\n"
  REFUSE(WINDINGS "K9 L8 L9\n", "bad.cir:7:1: ", "K9 has no coupling");
  REFUSE(WINDINGS "K9 (L8, l8) 0.9\n", "bad.cir:7:9: ", "l8 is coupled with itself");
  REFUSE(WINDINGS "K9 L8 L9 1.9\n", "bad.cir:7:10: ", "-1 to 1 is wanted");
  REFUSE(WINDINGS "K9 L8 L9 k=-1.1\n", "bad.cir:7:12: ", "-1 to 1 is wanted");
  REFUSE(WINDINGS "K9 L8 Rs 0.9\n", "bad.cir:7:7: ", "Rs is no inductor");
#define THIRD WINDINGS "L7 q 0 1\nK9 L8 L9 0.99\nK8 L9 L7 0.99\n"
  REFUSE(THIRD, "bad.cir:8:10: ", "the couplings of L7, L8, L9 do not fit together");
  REFUSE(THIRD "K7 L8 L7 -0.99\n", "bad.cir:8:10: ", "not positive definite");
  REFUSE(THIRD "K7 L8 L7 0.96\n", "bad.cir:8:10: ", "not positive definite");
  REFUSE(WINDINGS "K9 L8 L9 0.6\nK8 L9 L8 k=0.5\n", "bad.cir:7:10: ", "do not fit together");
  REFUSE(WINDINGS "L7 q 0 1\nK9 L7 L8 L9 -0.6\n", "bad.cir:8:13: ", "do not fit together");
#define LINE SUPPLY EVA "Rb a b 1\n.model um urc(rperl=1k cperl=1p)\n"
  REFUSE(LINE "U9 b 0 0 um l=1 n=10000\n", "bad.cir:7:19: ", "n=10000: a line U has 1 to 1000");
  REFUSE(LINE "U9 b 0 0 um l=1 n=1\n+ N 1001\n", "bad.cir:8:5: ", "a plain number in that range");
  REFUSE(LINE "U9 b 0 0 um n = {1e4} l=1\n", "bad.cir:7:17: ", "n={1e4}: ");
  REFUSE(LINE "U9 b 0 0 um n=0 l=1\n", "bad.cir:7:15: ", "n=0: ");
  REFUSE(LINE ".model un URC ( fmax=1e12 k = 1.001)\n", "bad.cir:7:31: ", "k=1.001: ngspice makes");
  accept_deck(LINE "U9 b 0 0 um l=1 n=20\nU8 b 0 0 un l=1\n.model un urc(k=2)\n");
  REFUSE(SUPPLY EVA "E9 q 0 POLY(2) a 0 b\n", "bad.cir:5:1: ", "wants 4 nodes");
  REFUSE(SUPPLY EVA "E9 q 0 POLY(2) (a,0) 0 1 1\n", "bad.cir:5:22: ", "and has 2");
  REFUSE(SUPPLY EVA "G9 q 0 POLY(2) a 0 0 1.5 1\n", "bad.cir:5:22: ", "and has 3");
  REFUSE(SUPPLY EVA "F9 q 0 POLY(2) Vm 0 1 1\n", "bad.cir:5:19: ", "wants 2 sources V");
  REFUSE(SUPPLY EVA "H9 q 0 POLY(1) Vm\n", "bad.cir:5:1: ", "no coefficient");
  REFUSE(SUPPLY EVA "E9 q 0 POLY(1) a 0 3\n", "bad.cir:5:20: ", "a single coefficient");
  REFUSE(SUPPLY EVA "E9 q 0 POLY(1.5) a 0 0 1\n", "bad.cir:5:13: ", "whole number of pairs");
  REFUSE(SUPPLY EVA "Rt b TIME 1k\n", "bad.cir:5:6: ", "cannot be called time");
  REFUSE(SUPPLY EVA "Ct temper 0 1n\n", "bad.cir:5:4: ", "cannot be called temper");
  REFUSE(SUPPLY EVA "*$ probe x = v(a) mV\n",
         "bad.cir:5:19: ", "it is measured in V, and 'mV' would");
  REFUSE(SUPPLY EVA "*$ probe x = i(Vm) kA\n", "bad.cir:5:20: ", "write A");
  REFUSE(SUPPLY EVA "*$ probe x = v(a,b) A\n", "bad.cir:5:21: ", "this is a voltage");
  REFUSE(SUPPLY EVA "*$ probe y = -i(Vm) V\n", "bad.cir:5:21: ", "this is a current");
  REFUSE(SUPPLY EVA "Rb a b 1\nCb b c 1n\n*$ probe x = v(C) A\n",
         "bad.cir:7:19: ", "V is wanted here");
  REFUSE(SUPPLY EVA "T9 a 0 q 0 Z0=50 NL=0.25\n", "bad.cir:5:1: ", "would take 0.25 ns");
  REFUSE(SUPPLY EVA "T9 a 0 q 0 Z0=50 TD=0\n", "bad.cir:5:21: ", "a delay above 0");
  REFUSE(SUPPLY EVA "T9 a 0 q 0 Z0=50 F -1meg\n", "bad.cir:5:20: ", "a frequency above 0");
  REFUSE(SUPPLY "Xeva a A eva\n", "bad.cir:4:1: ", "both ends of the EVA are on node a");
  REFUSE(SUPPLY "Xeva 0 gnd eva\n", "bad.cir:4:1: ", "both ends of the EVA");
  REFUSE(SUPPLY EVA "R9 a 0 1e400\n", "bad.cir:5:8: ", "takes it for infinity");
  REFUSE(SUPPLY EVA ".param big={2*1e306k}\n", "bad.cir:5:15: ", "takes it for infinity");
  REFUSE(SUPPLY EVA "R9 a 0\n", "bad.cir:5:1: ", "resistance in ohm");
  REFUSE(SUPPLY EVA "C9 (a, 0)\n", "bad.cir:5:1: ", "capacitance in F");
  REFUSE(SUPPLY EVA "L9 a 0\n", "bad.cir:5:1: ", "inductance in H");
  REFUSE(SUPPLY EVA "B9 q 0 V=v(a))\n", "bad.cir:5:14: ", "one too many");
  REFUSE(SUPPLY EVA "B9 q 0 V=v(a\n", "bad.cir:5:11: ", "is not closed");
  REFUSE(SUPPLY EVA "B9 q 0 V='v(a'\n", "bad.cir:5:12: ", "is not closed");
  REFUSE(SUPPLY EVA "V9 q 0\n+ PULSE(0 1 2 3\n", "bad.cir:6:8: ", "is not closed");
  REFUSE(SUPPLY EVA "R9 a 0 {(1}\n", "bad.cir:5:9: ", "is not closed");
  REFUSE(SUPPLY EVA ".if (1)\nR9 a 0 1k\n", "bad.cir:5:1: ", "no .endif");
  REFUSE(SUPPLY EVA "V9 q 0 PWL(1 0 0 1)\n", "bad.cir:5:16: ", "times that rise");
  REFUSE(SUPPLY EVA "V9 q 0 PWL 0 0 1m 1 200us 2\n", "bad.cir:5:21: ", "times that rise");
  REFUSE(SUPPLY EVA "E9 q 0 a 0 gain\n", "bad.cir:5:12: ", "no .param defines it");
  REFUSE(SUPPLY EVA "F9 q 0 Vm\n+ gain m=2\n", "bad.cir:6:3: ", "no .param defines it");
  REFUSE(SUPPLY EVA ".param gain=2\nG9 q 0 (a,0) gain\n", "bad.cir:6:14: ", "write {gain}");
  REFUSE(SUPPLY EVA ".param gain=2\nH9 q 0 Vm (gain)\n", "bad.cir:6:12: ", "write {gain}");
  snprintf(deck, sizeof deck,
           "%sX9 a 0 two R = 5 x=2 m=2\nX8 a 0 two params: r={2*(1+1)}\nR9 a 0 dr\n"
           ".model dr r(r=1k\n.if (1)\nR8 a 0 r='(1k)'\n.endif\n"
           ".func f7(x) {f8(f8(x,1),0)}\n.func f8(x,y) {x+x+x+x+x+x+x+x+y}\n"
           "B7 q7 0 V=f7(v(a)/1k)+f7(f7(2))\n"
           ".if (1)\n.if (0)\n.elseif (1)\n.else\n.endif\n.endif\n"
           ".subckt s5 p q\nX1 p q s6\n.subckt s6 p q\nR1 p q 1k\n.ends\n.ends\nX5 a 0 s5\n"
           ".subckt s4 p q\nX1 p q s5\nX2 p q s5\n.ends\nX4 a 0 s4\n"
           ".param p1={f1(p2)}\n.subckt s1 p q p1={p1}\n.param p2={p2}\n.func f1(x) {f2(x)}\n"
           "R1 p q {f1(p1)}\n.ends\n.func f2(x) {f1(x)}\n.func f1(f2) {2*f2}\n.param p2=1k\n"
           "X7 a 0 s1 p1={p1}\n"
           "V9 q 0 PWL(0 0 1m 1 1m 2 2000us 0)\nR7 q 0 1k\n"
           ".param gain=2\nE6 e 0 (q 0) gain\nE5 d 0 e 0 r_source\nF4 0 d V9 gain m=2\n",
           TWO);
  accept_deck(deck);
  accept_deck(WINDINGS "Rb a b 1k\nR9 p 0 1k\nK9 l8 L9 k=0.9\n.param kk=1\nL7 o 0 1\nR8 o 0 1k\n"
                       "K8 L8 L7 {kk/4}\n");
  accept_deck(THIRD "K7 L8 L7 0.98\nRb a b 1k\nR9 p 0 1k\nR7 q 0 1k\n");
  accept_deck(WINDINGS "L7 q 0 1\nK9 L7 L8 L9 1\nRb a b 1k\nR9 p 0 1k\nR7 q 0 1k\n");
  accept_deck(SUPPLY EVA
              "Rb a b 1k\nE9 e 0 POLY(2) (a,0) (b,0) 0 1 1\nE8 f 0 poly( 1 ) a 0 {0} {2}\n"
              "F7 0 sum poly(1) Vm 0 1\nR7 sum 0 1\nE6 g 0 POLY 1 a b 0 1\n"
              "*$ probe i_sum = v(sum) A\n*$ probe i_in = -i(Vm) A\n");
  accept_deck(SUPPLY EVA
              "Rb a b 1k\nV9 q 0 1\nR8 q r 50\nT9 r 0 s 0 Z0=50 F=1k NL=0.25\nT8 s 0 u 0 zo=50 "
              "td={1m}\nR9 u 0 50\n");
}

/* Functions that call each other `deep` deep, or parameters that need each other so. */
static char *chain(bool function, int deep) {
  vs_text text = {0};
  vs_text_add(&text, "%s", SUPPLY EVA);
  vs_text_add(&text, function ? ".func c1(x) {x}\n" : ".param c1=2\n");
  for (int k = 2; k <= deep; k++)
    vs_text_add(&text, function ? ".func c%d(x) {c%d(x)}\n" : ".param c%d={c%d}\n", k, k - 1);
  vs_text_add(&text, function ? "Rb a b {c%d(1k)}\n" : "Rb a b {c%d}\n", deep);
  return text.text;
}

/* ngspice hangs, or loses a bracket, where they are deeper. */
static void chains_end_somewhere(void) {
  static const int DEEPEST[] = {1000, 200}; /* parameters, functions */
  for (int function = 0; function < 2; function++) {
    char place[32], *deck = chain(function, DEEPEST[function]);
    accept_deck(deck);
    free(deck);
    deck = chain(function, DEEPEST[function] + 1);
    snprintf(place, sizeof place, "bad.cir:%d:%d: ", 5 + DEEPEST[function], function ? 7 : 8);
    REFUSE(deck, place, "deep");
    free(deck);
  }
}

/* What would write or read a file, take what is the program's, or hide from the rules: refused as
 * the seventh line of a good deck, with or without a continuation. */
static void strangers_lines_are_refused(void) {
  static const struct {
    const char *lines, *word;
  } ROWS[] = {{".model m numd level=1", "'numd'"},
              {".model m\n+ NUMD level=1", "'numd'"},
              {".model m\n* a comment between\n+ nbjt", "'nbjt'"},
              {".model m nmos level=54", "'54'"},
              {".model m nmos (vto=1 LEVEL = 8)", "'8'"},
              {".model m nmos level=4", "'4'"},
              {".model m filesource(file=\"x\")", "'filesource'"},
              {".model m d_source(input_file=\"x\")", "'d_source'"},
              {".model m table2d(file=\"x\")", "'table2d'"},
              {".model m gain(gain=1 file=\"x\")", "(file=)"},
              {".model m square", "'square'"},
              {"Xq a\n+ 0 eva", "second EVA"},
              {"Xq a 0\n* between\n+ EVA", "second EVA"},
              {".subckt foo m\nXq m 0 eva\n.ends", "second EVA"},
              {"Vq a 0\n+ external", "no line '*$ port"},
              {"Iq a 0\n+ external", "no line '*$ port"},
              {"Vq a 0 dc 0 external", "no more"},
              {"Vq a 0 external 3", "no more"},
              {".param u_rms=3", "u_rms"},
              {".param x=2 eva_a = {1e-3}", "eva_a"},
              {".param two=2\n+ phase=1", "phase"},
              {"*$ param eva_resistance = 1 ohm 0..2", "eva_resistance"},
              {"*$ param r1 = 1 ohm 0..2\n.param r1=3", "'*$ param' line already"},
              {".subckt EVA pos neg\nR1 pos neg 1\n.ends", "eva is the program's"},
              {"Xq a 0 foo 5=3\n.subckt foo m n\nR1 m n 1\n.ends", "'5' stands before a '='"},
              {"\v.control", "control character"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[512], place[32];
    snprintf(text, sizeof text, "%s" SUPPLY_LOSS "R1 a b 100\n" EVA "%s\n", SUPPLY, ROWS[k].lines);
    int line =
        !strncmp(ROWS[k].lines, ".subckt foo", 11) || strstr(ROWS[k].word, "already") ? 8 : 7;
    snprintf(place, sizeof place, "bad.cir:%d:", line);
    REFUSE(text, place, ROWS[k].word);
  }
  REFUSE("+ R1 a b 1\n" SUPPLY EVA, "bad.cir:1:1: ", "'+'");
  REFUSE(SUPPLY "R1 a b 1\n.subckt foo m\nXeva m 0 eva\n.ends\nX1 b foo\n",
         "bad.cir:6:1: ", "in no subcircuit");
  CU_ASSERT(!mkfifo("pipe.inc", 0600));
  REFUSE(SUPPLY ".include pipe.inc\n" EVA, "bad.cir:4:1: ", "pipe.inc is a folder, a pipe");
  unlink("pipe.inc");
  /* a subcircuit's own names are its own, and comments and continuations do no harm */
  write_file("good.cir", SUPPLY SUPPLY_LOSS "*$ loss r1 = v(a,b)^2/100\n"
                                            ".subckt half p q u_rms=50\n.param phase=2\n"
                                            "Ra p ; half of it\n* between\n+ m {u_rms} $ and\n"
                                            "+ tc1=0 // so on\n"
                                            "Rb m q {25*phase}\n.ends\nX1 a b half\n" EVA);
  vs_trial *t = run_deck("good.cir", NULL, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  CU_ASSERT(fabs(t->result.watchers.energy.residual[VS_B_CIRCUIT]) < 1e-3);
  vs_trial_free(t);
}

/* What ngspice refuses is found in the text of the deck. */
static void refusals_are_located(void) {
  REFUSE(SUPPLY "  R1 a b {2*nix}\n" EVA, "bad.cir:4:13: ", "[nix]");
  REFUSE(SUPPLY ".param two = {2*nix}\nR1 a b {two}\n" EVA, "bad.cir:4:17: ", "[nix]");
  REFUSE(SUPPLY "R1 a b 1\nR2 b 0 sub='nix'\n" EVA, "bad.cir:5:13: ", "[nix]");
  REFUSE(SUPPLY "R1 a b 1\n D1 a b nomodel\n" EVA, "bad.cir:5:9: ", "nomodel");
  REFUSE(SUPPLY "R1 a b 1\n*$ probe v_x = v(a,nowhere) V\n" EVA, "bad.cir:5:16: ", "v(nowhere)");
  REFUSE(SUPPLY "R1 a b 1\n*$ loss x = 2*i(Vnix)\n" EVA, "bad.cir:5:15: ", "i(vnix)");
}

/* ---- losses and stores ---- */

/* Reference T3A over 2 s, printed to four places at most; the run's own 2e-4 and half the last
 * digit. */
static void losses_of_the_paper(void) {
  static const struct {
    const char *name;
    double joule, digit;
  } ROWS[] = {{"r_source", 0.00161, 5e-6},
              {"r1", 0.0655, 5e-5},
              {"r2", 0.0124, 5e-5},
              {"thyristor", 0.40386, 5e-6},
              {"varistor_1", 0.03168, 6e-5}};
  const char *sets[] = {"run.until=2s", NULL};
  vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  const vs_accounts *losses = &t->scene.setup.deck.losses;
  for (size_t r = 0; r < COUNT(ROWS); r++) {
    double found = NAN;
    for (size_t k = 0; k < losses->count; k++)
      if (!strcmp(losses->item[k].name, ROWS[r].name)) found = t->result.watchers.energy.loss_j[k];
    EXPECT(fabs(found - ROWS[r].joule) <= ROWS[r].digit + 1e-5, "%s: %.6g J", ROWS[r].name, found);
  }
  vs_trial_free(t);
}

/* The books over the circuit close to 1e-3 of the work of the force by default, and better with a
 * finer tolerance. */
static void books_close_over_the_circuit(void) {
  static const char *const TOLERANCES[] = {"run.tolerance=1e-3", "run.tolerance=1e-4",
                                           "run.tolerance=1e-5"};
  static const double LIMIT[] = {1e-2, 1e-3, 1e-4};
  static const char *const DECKS[] = {"circuit.deck=halfwave_snubbed",
                                      "circuit.deck=halfwave_bare"};
  char text[512];
  for (size_t d = 0; d < COUNT(DECKS); d++)
    for (size_t k = 0; k < COUNT(TOLERANCES); k++) {
      const char *sets[] = {"run.until=0.1s", TOLERANCES[k], DECKS[d], NULL};
      vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
      CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
      for (int b = 0; b < VS_BALANCES; b++) {
        CU_ASSERT(t->result.watchers.energy.balanced[b]);
        EXPECT(fabs(t->result.watchers.energy.residual[b]) <= LIMIT[k], "%s, %s: %s leaves %g",
               DECKS[d], TOLERANCES[k], vs_energy_balance_names[b],
               t->result.watchers.energy.residual[b]);
      }
      CU_ASSERT_PTR_NULL(vs_energy_open(&t->result.watchers.energy, t->scene.setup.run.tolerance,
                                        text, sizeof text));
      vs_trial_free(t);
    }
}

/* The shipped deck less the lines that begin so. */
static void write_deck_without(const char *name, const char *begin) {
  char path[512], *line = NULL;
  size_t size = 0;
  snprintf(path, sizeof path, "%s/../spice/halfwave_snubbed.cir", VS_TEST_FOLDER);
  FILE *in = fopen(path, "r"), *out = fopen(name, "w");
  CU_ASSERT_FATAL(in && out);
  while (getline(&line, &size, in) >= 0)
    if (strncmp(line, begin, strlen(begin))) fputs(line, out);
  free(line);
  fclose(in);
  fclose(out);
}

/* Which balance the audit says is open; -1: none. */
static int open_balance(const vs_trial *t) {
  char text[512], name[64];
  /* so far open that the run is none */
  CU_ASSERT_FATAL(t->status == VS_OK || strstr(t->err.text, "the energy books ("));
  if (!vs_energy_open(&t->result.watchers.energy, t->scene.setup.run.tolerance, text, sizeof text))
    return -1;
  for (int b = 0; b < VS_BALANCES; b++) {
    snprintf(name, sizeof name, "(%s)", vs_energy_balance_names[b]);
    if (strstr(text, name)) return b;
  }
  return VS_BALANCES;
}

/* A loss line that is missing leaves just that loss over. The smallest, of the source's resistance,
 * is 0.2 % of what is drawn. */
static void a_missing_loss_is_seen(void) {
  static const char *const LINES[] = {"*$ loss   r_source", "*$ loss   r1", "*$ loss   thyristor",
                                      "*$ loss   varistor_1"};
  const char *sets[] = {"run.until=0.1s", NULL};
  vs_trial *whole = vs_trial_run("paper", "circuit", sets, NULL);
  CU_ASSERT_EQUAL(open_balance(whole), -1);
  const vs_accounts *losses = &whole->scene.setup.deck.losses;
  for (size_t k = 0; k < COUNT(LINES); k++) {
    write_deck_without("less.cir", LINES[k]);
    vs_trial *t = run_deck("less.cir", "run.until=0.1s", "supply.voltage=440V");
    CU_ASSERT_EQUAL(open_balance(t), VS_B_CIRCUIT);
    for (size_t n = 0; n < losses->count; n++)
      if (!strcmp(losses->item[n].name, LINES[k] + strlen("*$ loss   ")))
        CLOSE_OF(t->result.watchers.energy.left_j[VS_B_CIRCUIT] -
                     whole->result.watchers.energy.left_j[VS_B_CIRCUIT],
                 whole->result.watchers.energy.loss_j[n],
                 whole->result.watchers.energy.joule[VS_E_SOURCE], 1e-9);
    vs_trial_free(t);
  }
  vs_trial_free(whole);
}

/* A store that is missing matters while it holds something: a capacitor of 10 uF kept charged. */
static void a_missing_store_is_seen(void) {
#define CHARGED                                                                                    \
  SUPPLY SUPPLY_LOSS "*$ loss d1 = v(a,c)*i(Vd)\n*$ loss r2 = v(a,b)^2/10k\n"                      \
                     "Vd a d 0\nD1 d c dm\n.model dm d\nC1 c 0 10u ic=0\nR2 a b 10k\n" EVA
  write_file("with.cir", "*$ store c1 = 0.5*10u*v(c)^2\n" CHARGED);
  write_file("without.cir", CHARGED);
  vs_trial *with = run_deck("with.cir", NULL, NULL), *without = run_deck("without.cir", NULL, NULL);
  CU_ASSERT_EQUAL(open_balance(with), -1);
  CU_ASSERT_EQUAL(open_balance(without), VS_B_CIRCUIT);
  CLOSE(without->result.watchers.energy.left_j[VS_B_CIRCUIT], 0.5 * 10e-6 * 141 * 141,
        0.1); /* near the peak */
  vs_trial_free(with);
  vs_trial_free(without);
}

/* A wrong store that ends empty is seen on the way. */
static void a_wrong_store_is_seen(void) {
  static const char *const STORES[] = {"*$ store c2x = 99*{c2}*v(c2p)^2/2\n",
                                       "*$ store lx = 19*{l_source}*i(Vmains)^2/2\n"};
  for (size_t k = 0; k < COUNT(STORES); k++) {
    write_deck_without("wrong.cir", "nothing");
    FILE *f = fopen("wrong.cir", "a");
    fputs(STORES[k], f);
    fclose(f);
    vs_trial *t = run_deck("wrong.cir", "run.until=0.1s", "supply.voltage=440V");
    CU_ASSERT_EQUAL(open_balance(t), VS_B_CIRCUIT);
    vs_trial_free(t);
  }
}

/* A deck that declares neither has no books to close, and none are claimed. */
static void no_accounts_no_books(void) {
  write_file("silent.cir", SUPPLY "R1 a b 100\n" EVA);
  vs_trial *t = run_deck("silent.cir", NULL, NULL);
  CU_ASSERT_EQUAL(open_balance(t), -1);
  CU_ASSERT_FALSE(t->result.watchers.energy.balanced[VS_B_CIRCUIT]);
  CU_ASSERT(fabs(t->result.watchers.energy.left_j[VS_B_CIRCUIT]) > 0.01);
  vs_trial_free(t);
}

/* The force with the wrong sign in the mechanics: what it does there is not what the books say. */
static void a_wrong_force_sign_is_seen(void) {
  static const char *const TIERS[] = {"switched", "circuit"};
  const char *sets[] = {"run.until=0.1s", NULL};
  for (size_t k = 0; k < COUNT(TIERS); k++) {
    vs_trial *t = vs_trial_read("paper", TIERS[k], sets);
    for (int i = 0; i < VS_DOF; i++) t->scene.setup.model.mf[i] *= -1;
    vs_trial_go(t, NULL);
    CU_ASSERT_EQUAL(open_balance(t), VS_B_MECHANICAL);
    vs_trial_free(t);
  }
}

/* The back-EMF left out, as an EVA netlist with L = 2a/z under di/dt has it: v = R_c i + L di/dt.
 * An eva.inc of the user's own stands before the program's on the path. */
static void a_missing_back_emf_is_seen(void) {
  CU_ASSERT(!mkdir("lib", 0777));
  write_file("lib/eva.inc", ".subckt eva pos neg\n"
                            "Rcoil pos x {eva_resistance}\n"
                            "Bcoil x neg I = v(cur)\n"
                            "Bcur 0 cur I = v(x,neg)*v(z)/(2*{eva_a})\n"
                            "Ccur cur 0 1 ic=0\n"
                            "Blam lam 0 V = 2*{eva_a}*v(cur)/v(z)\n"
                            "Vgap z 0 external\n"
                            ".ends eva\n");
  setenv("VIBROSPICE_PATH", "lib", 1);
  const char *sets[] = {"run.until=0.1s", NULL};
  vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
  unsetenv("VIBROSPICE_PATH");
  CU_ASSERT_EQUAL(open_balance(t), VS_B_EVA);
  vs_trial_free(t);
  remove_tree("lib");
}

/* ---- parts ---- */

#define PART(name, ohm)                                                                            \
  "*$ param " name "_r = " ohm " ohm 1..1e6 \"its resistance\"\n"                                  \
  ".subckt " name " p q\nRpart p q {" name "_r}\n.ends\n"
#define PART_DECK                                                                                  \
  "*$ param element = small part \"what stands in series\"\n" SUPPLY SUPPLY_LOSS                   \
  "*$ probe v_part = v(a,b) V\n*$ probe i_part = -i(Vm) A\n"                                       \
  "Xone a b element\n" EVA

static double ratio(const vs_trial *t) {
  const vs_extreme *e = vs_measures_of_probe(t->result.watchers.measures, 0);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  return e[1].best.value / e[3].best.value;
}

static void parts_by_name(void) {
  CU_ASSERT(!mkdir("decks", 0777) && !mkdir("decks/parts", 0777));
  write_file("decks/d.cir", PART_DECK);
  write_file("decks/small.inc", PART("small", "100"));
  write_file("decks/parts/big.inc", PART("BIG", "500"));
  vs_trial *t = run_deck("decks/d.cir", NULL, NULL); /* the default, beside the deck */
  CLOSE(ratio(t), 100, 1e-6);
  vs_trial_free(t);
  t = run_deck("decks/d.cir", "circuit.small_r=200 ohm", NULL); /* a parameter of the part's */
  CLOSE(ratio(t), 200, 1e-6);
  vs_trial_free(t);
  t = run_deck("decks/d.cir", "circuit.element=parts/big.inc", NULL); /* a file */
  CLOSE(ratio(t), 500, 1e-6);
  vs_trial_free(t);
  setenv("VIBROSPICE_PATH", "decks", 1);
  t = run_deck("decks/d.cir", "circuit.element=big", NULL); /* from the shelf of parts */
  CLOSE(ratio(t), 500, 1e-6);
  vs_trial_free(t);
  t = run_deck("decks/d.cir", "circuit.element=big", "circuit.small_r=200 ohm");
  EXPECT(t->status == VS_INPUT && strstr(t->err.text, "no key 'small_r'"), "%s", t->err.text);
  vs_trial_free(t);
  t = run_deck("decks/d.cir", "circuit.element=bigg", NULL);
  EXPECT(t->status == VS_INPUT && strstr(t->err.text, "did you mean 'big'"), "%s", t->err.text);
  vs_trial_free(t);
  write_file("decks/big.inc", PART("BIG", "300")); /* hides that of the shelf */
  t = run_deck("decks/d.cir", "circuit.element=big", NULL);
  CLOSE(ratio(t), 300, 1e-6);
  const vs_findings *remarks = t->scene.setup.deck.remarks;
  CU_ASSERT(remarks && remarks->count == 1 &&
            strstr(remarks->item[0].text, "part big is taken from decks/big.inc; "));
  vs_trial_free(t);
  unsetenv("VIBROSPICE_PATH");
  write_file("decks/wrong.inc", ".subckt right p q\nR p q 1\n.ends\n");
  t = run_deck("decks/d.cir", "circuit.element=wrong", NULL);
  EXPECT(t->status == VS_INPUT && strstr(t->err.text, "no subcircuit 'wrong'"), "%s", t->err.text);
  vs_trial_free(t);
  write_file("decks/evil.inc", ".subckt evil p q\nR p q 1\n.ends\n.control\nshell ls\n.endc\n");
  t = run_deck("decks/d.cir", "circuit.element=evil", NULL);
  EXPECT(t->status == VS_INPUT && strstr(t->err.text, "evil.inc:4:1: "), "%s", t->err.text);
  vs_trial_free(t);
  remove_tree("decks");
}

/* ---- includes ---- */

#define CLAMPED                                                                                    \
  "*$ param varistor = s20k510 part varistor \"across the coil\"\n" SUPPLY SUPPLY_LOSS "R1 a b "   \
  "10\n"

/* True if the deck has read a file whose path ends so. */
static bool has_read(const vs_deck *deck, const char *end) {
  for (size_t k = 0; k < deck->n_files; k++) {
    size_t n = strlen(deck->files[k]), m = strlen(end);
    if (n >= m && !strcmp(deck->files[k] + n - m, end)) return true;
  }
  return false;
}

/* The working directory has files of the names that shipped files and decks elsewhere include. None
 * of them is read: each says what no deck may say. */
static void includes_are_found_beside_their_files(void) {
  static const char *const NAMES[] = {"siov.inc", "varistor_scale.inc", "mine.inc", "eva"};
  for (size_t k = 0; k < COUNT(NAMES); k++) write_file(NAMES[k], ".control\nshell ls\n.endc\n");
  CU_ASSERT_EQUAL(mkdir("decks", 0777), 0);
  write_file("decks/d.cir", CLAMPED EVA "Xv b 0 varistor\n");
  vs_trial *t = run_deck("decks/d.cir", "run.until=1ms", NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  CU_ASSERT(has_read(&t->scene.setup.deck, "spice/siov.inc"));
  vs_trial_free(t);
  /* nor a file beside the deck, where the part that includes it lies elsewhere */
  write_file("decks/siov.inc", "Rubbish\n");
  t = run_deck("decks/d.cir", "run.until=1ms", NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  vs_trial_free(t);
  write_file("decks/d.cir", SUPPLY ".include mine.inc\nR1 a b {mine}\n" EVA);
  t = run_deck("decks/d.cir", NULL, NULL);
  EXPECT(t->status == VS_INPUT && strstr(t->err.text, "decks/d.cir:4:1: no include file "
                                                      "'mine.inc': not beside the file"),
         "%s", t->err.text);
  vs_trial_free(t);
  write_file("decks/mine.inc", ".param mine=10\n");
  write_file("decks/own.inc", ".include latch.inc\n.subckt own p q\nR1 p q 1\n.ends\n");
  write_file("decks/d.cir", "*$ param own = own part\n" SUPPLY
                            ".include mine.inc\nR1 a c {mine}\nXo c b own\n" EVA);
  t = run_deck("decks/d.cir", "run.until=1ms", NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  CU_ASSERT(has_read(&t->scene.setup.deck, "decks/mine.inc"));
  CU_ASSERT(has_read(&t->scene.setup.deck, "spice/parts/latch.inc"));
  vs_trial_free(t);
  for (size_t k = 0; k < COUNT(NAMES); k++) unlink(NAMES[k]);
  remove_tree("decks");
}

/* ---- names in several files ---- */

#define TWO                                                                                        \
  "*$ param one = aa part\n*$ param two = bb part\n" SUPPLY                                        \
  "R1 a c 100\nX1 c d one\nX2 d b two\n" EVA
#define USES(part, model) ".subckt " part " p q\nX1 p e core\nD1 e q m\n" model ".ends\n"
#define CORE(value) ".subckt core p q\nR1 p q " value "\n.ends\n"

/* ngspice takes the first of two definitions for both, so a part would be judged by its own limits
 * and simulated with the other's helper. */
static void one_name_in_two_files(void) {
  static const struct {
    const char *deck, *aa, *bb, *at, *says; /* at: NULL: it is fine */
  } ROWS[] = {
      {TWO, USES("aa", ".model m d(n=1)\n") CORE("1"), USES("bb", ".model m d(n=2)\n") CORE("2"),
       "bb.inc:6:1: ",
       "a second .subckt core, which says other things than the first, of aa.inc, line 6"},
      {TWO, USES("aa", "") CORE("1") ".model m d(n=1)\n", USES("bb", "") ".model M d(n=2)\n",
       "bb.inc:5:1: ", "a second .model M, which says other things than the first, of aa.inc"},
      {TWO CORE("3"), USES("aa", ".model m d(n=1)\n"), USES("bb", ".model m d(n=2)\n") CORE("2"),
       "bb.inc:6:1: ", "than the first, of bad.cir, line 10"},
      {"*$ param v = s20k510 part\n" TWO CORE("1") ".subckt siov a b\nR1 a b 1\n.ends\nX9 b 0 v\n",
       USES("aa", ".model m d(n=1)\n"), USES("bb", ".model m d(n=1)\n"),
       "bad.cir:1:14: ", "a second .subckt siov, "},
      /* the same in other words, models of the subcircuits' own, and a file that both include */
      {TWO, USES("aa", ".model m d(n=1)\n") CORE("1"),
       USES("bb", ".model m d(n=2)\n") ".SUBCKT  Core p\tq\nr1 p q   1 \n.ends\n", NULL, NULL},
      {TWO, ".include core.inc\n" USES("aa", ""), USES("bb", "") ".include core.inc\n", NULL, NULL},
      {TWO, USES("aa", ".model m d(n=1)\n") CORE("1") ".model d1 d(is=1n n=2)\n",
       USES("bb", ".model m d(n=1)\n") ".subckt core p q\nR1 p q 1\n.ends core\n.model d1 D ( is = "
                                       "1n, N=2 )\n",
       NULL, NULL},
  };
  write_file("core.inc", CORE("5") ".model m d(n=1)\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_file("aa.inc", ROWS[k].aa);
    write_file("bb.inc", ROWS[k].bb);
    if (ROWS[k].at)
      REFUSE(ROWS[k].deck, ROWS[k].at, ROWS[k].says);
    else
      accept_deck(ROWS[k].deck);
  }
}

/* A part's file declares a parameter behind the deck's lines. */
static void parameters_of_parts(void) {
  static const char FIRED[] = "*$ port gate = Vg\nVg g b external\nX1 a b g thyristor\n";
  char deck[1024];
  snprintf(deck, sizeof deck, "*$ param thyristor = latch part thyristor\n" SUPPLY "%s%s" EVA,
           FIRED,
           ".param own=1\n+ on_voltage=50\n.subckt s p q\n.param on_voltage=2\nR1 p q 1\n.ends\n");
  REFUSE(deck, "bad.cir:8:1: ", "parameter on_voltage stands in a '*$ param' line already");
  snprintf(deck, sizeof deck, "*$ param thyristor = latch part thyristor\n" SUPPLY "%s%s" EVA,
           FIRED, ".if (0)\n.param on_voltage=50\n.endif\n");
  accept_deck(deck);
  write_file("aa.inc", ".param bb_r=5\n.subckt aa p q\nR1 p q 1\n.ends\n");
  write_file("bb.inc", "*$ param bb_r = 5 ohm 1..10\n.subckt bb p q\nR1 p q {bb_r}\n.ends\n");
  REFUSE(TWO, "aa.inc:1:1: ", "parameter bb_r stands in");
}

/* ---- a vendor's dialect ---- */

/* In ngspice's own dialect pwr() keeps the sign and pow() is of the magnitude; in PSpice's pwr() is
 * of the magnitude too, and IF(), VALUE={} and LIMIT() are known. */
static void dialects(void) {
  static const char *const DIALECT[] = {"", "*$ compat ps\n"};
  static const double EXPECTED[2][2] = {{8, -8}, {8, 8}}; /* of pow(-2,3), pwr(-2,3) */
  for (int k = 0; k < 2; k++) {
    char text[1024];
    snprintf(text, sizeof text,
             "%s" SUPPLY "*$ probe v_pow = v(q) V\n*$ probe v_pwr = v(r) V\n"
             "Bq q 0 V=pow(-2,3)\nBr r 0 V=pwr(-2,3)\nR1 a b 100\n" EVA,
             DIALECT[k]);
    write_file("dialect.cir", text);
    vs_trial *t = run_deck("dialect.cir", "run.until=1ms", NULL);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    const vs_extreme *e = vs_measures_of_probe(t->result.watchers.measures, 0);
    CLOSE(e[0].best.value, EXPECTED[k][0], 1e-9);
    CLOSE(e[2].best.value, EXPECTED[k][1], 1e-9);
    vs_trial_free(t);
  }
  /* a part in PSpice's dialect leaves the deck its own pwr() */
  write_file("psr.inc",
             "*$ part resistor \"P\"\n*$ compat ps\n.subckt psr p q\nR1 p q 1k\n.ends\n");
  write_file("dialect.cir", "*$ param one = psr part\n" SUPPLY
                            "*$ probe v_pwr = v(r) V\nBr r 0 V=1+pwr(-2*2,{1+2})\nR1 a b 100\n"
                            "X1 r 0 one\n" EVA);
  vs_trial *own = run_deck("dialect.cir", "run.until=1ms", NULL);
  CU_ASSERT_EQUAL_FATAL(own->status, VS_OK);
  CLOSE(vs_measures_of_probe(own->result.watchers.measures, 0)->best.value, -63, 1e-9);
  vs_trial_free(own);
  write_file("vendor.lib", "* a vendor's\n.SUBCKT LIMITER in out PARAMS: TOP=5\n"
                           "E1 out 0 VALUE={IF(V(in)>0, LIMIT(V(in),0,TOP), -1)}\n.ENDS\n");
#define VENDOR                                                                                     \
  SUPPLY                                                                                           \
  ".lib \"vendor.lib\"\n*$ probe v_out = v(o) V\nX1 a o LIMITER PARAMS: TOP=7\nR1 a b 100\n"       \
  "R2 o 0 1k\n" EVA
  write_file("user.cir", "*$ compat ps\n" VENDOR);
  vs_trial *t = run_deck("user.cir", NULL, NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  CLOSE(vs_measures_of_probe(t->result.watchers.measures, 0)->best.value, -1, 1e-9);
  CLOSE(vs_measures_of_probe(t->result.watchers.measures, 0)[1].best.value, 7, 1e-9);
  vs_trial_free(t);
  write_file("user.cir", VENDOR); /* and without asking for it, it is not understood */
  t = run_deck("user.cir", NULL, NULL);
  CU_ASSERT_EQUAL(t->status, VS_INPUT);
  vs_trial_free(t);
  t = vs_trial_run("paper", "circuit", (const char *[]){"run.until=0.02s", NULL}, NULL);
  CU_ASSERT_EQUAL(t->status, VS_OK); /* the dialect does not stay behind */
  vs_trial_free(t);
}

/* ---- ratings ---- */

static void ratings_are_judged(void) {
  write_file("rated.cir",
             "*$ probe v_a = v(a) V\n*$ probe i_a = -i(Vm) A\n"
             "*$ rating v_a -0.5..0.2 kV \"insulation\"\n*$ rating i_a -1000..1000 mA\n" SUPPLY
             "R1 a b 100\n" EVA);
  vs_trial *t = run_deck("rated.cir", "supply.resistance=0", NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  vs_verdict *v = vs_alloc(1, sizeof *v);
  vs_verdict_make(t->result.watchers.measures, NULL, NULL, v);
  const vs_judgement *j = v->item;
  CU_ASSERT_EQUAL_FATAL(v->count, 2);
  double peak = 100 * sqrt(2),
         current = vs_measures_of_probe(t->result.watchers.measures, 1)[1].best.value;
  CLOSE(j[0].least.value, -peak, 1e-4); /* the peak lies between knots 25 us apart */
  CLOSE(j[0].stress.value, peak, 1e-4);
  CLOSE(j[0].margin, (200 - peak) / 200, 1e-3);
  CLOSE(j[0].rating->max, 200, 1e-15);
  CLOSE(j[1].margin, 1 - current, 1e-12);
  CU_ASSERT(current > 0.1);
  CU_ASSERT_PTR_EQUAL(v->weakest, &j[1 - current < j[0].margin]);
  CU_ASSERT_PTR_NULL(v->first_to_fail);
  vs_verdict_free(v);
  free(v);
  vs_trial_free(t);
}

static const vs_test TESTS[] = {
    {"formulas", formulas_give_their_values},
    {"bad formulas", bad_formulas_are_refused},
    {"bad lines", bad_lines_are_refused},
    {"strangers' lines", strangers_lines_are_refused},
    {"refusals are located", refusals_are_located},
    {"losses of the paper's circuit", losses_of_the_paper},
    {"books close over the circuit", books_close_over_the_circuit},
    {"a missing loss", a_missing_loss_is_seen},
    {"a missing store", a_missing_store_is_seen},
    {"a wrong store", a_wrong_store_is_seen},
    {"no accounts, no books", no_accounts_no_books},
    {"a wrong force sign", a_wrong_force_sign_is_seen},
    {"a missing back-EMF", a_missing_back_emf_is_seen},
    {"parts by name", parts_by_name},
    {"includes are found beside their files", includes_are_found_beside_their_files},
    {"one name in two files", one_name_in_two_files},
    {"parameters of parts", parameters_of_parts},
    {"dialects", dialects},
    {"ratings", ratings_are_judged},
    {"slips are refused", slips_are_refused},
    {"chains end somewhere", chains_end_somewhere},
};
VS_SUITE_MAIN("deck", TESTS)
