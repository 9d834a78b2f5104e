/* SPDX-License-Identifier: GPL-3.0-or-later
 * LIMIT of PSpice's dialect is a cut-off and no chance, wherever the deck says which dialect it is
 * in; and names that ngspice has for itself are the user's where he gives them. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"
#include "netlist/reserved.h"

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

static double largest(const char *json, const char *name) {
  char wanted[64];
  snprintf(wanted, sizeof wanted, "\"%s\": {\"value\": ", name);
  const char *found = strstr(json, wanted);
  return found ? strtod(found + strlen(wanted), NULL) : -1e9;
}

#define PROBE "*$ probe y_v = v(yy) V \"of the test\"\nR99 yy 0 1k\nVss ss 0 sin(0 300 1k)\n"
#define RUN                                                                                        \
  "run paper --set circuit.deck=d.cir --set run.until=3ms --set run.verify=never --json --quiet"

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
      ran r = run(RUN);
      EXPECT(r.status == 0, "%s: %d %s", FORMS[k], r.status, r.err);
      /* one step of ngspice may cross the corner: nothing is between 10 and 12 but its rounding */
      vs_close(largest(r.out, "y_v_max"), 12, 12, 1e-6, FORMS[k], __LINE__);
      vs_close(largest(r.out, "y_v_min"), -10, 10, 1e-6, FORMS[k], __LINE__);
      free_ran(&r);
      vs_text_free(&lines);
    }
}

static void refused(const char *second, const char *line, const char *says) {
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
  refused("", "B9 yy 0 V=limit(V(ss),-10,12)", "'*$ compat ps'");
  refused("", "V9 yy 0 {limit(10,1)}", "random");
  refused(DIALECT, "V9 yy 0 {limit(10,1)}", THREE);
  refused(DIALECT, "B9 yy 0 V=limit(V(ss),10)", THREE);
  refused(DIALECT, "B9 yy 0 V=limit (V(ss),-10,12)", THREE);
  refused(DIALECT, "V9 yy 0 {gauss(10,1,3)}", "random");
}

/* ---- names that ngspice keeps for itself ---- */

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
      "s %N=1000\nRf f 0 1\n.subckt s p %N=3\nB1 p 0 V=2*%N-%N\n.ends\n.control\nop\nprint "
      "v(r)+v(b)+v(c)+v(d)+v(n)+v(f)\n.endc\n.end\n";
  vs_text deck = {0};
  char command[128];
  add_form(&deck, DECK, name, 0);
  write_file("plain.cir", deck.text);
  vs_text_free(&deck);
  snprintf(command, sizeof command, "timeout 60 ngspice %s -b plain.cir >plain.log 2>&1", options);
  const int status = system(command);
  char *log = read_file("plain.log");
  const char *found = status == -1 ? NULL : strstr(log, "+v(f) = ");
  const bool free_name = found && fabs(strtod(found + 8, NULL) - 6000) < 0.01;
  free(log);
  return free_name;
}

/* The list has those names that plain ngspice misreads, and no others. */
static void list_of_names(void) {
  if (system("ngspice --version >plain.log 2>&1")) {
    puts("ngspice is not on the PATH: the list of its names is not tried");
    return;
  }
  size_t listed = 0;
  for (int pspice = 0; pspice < 2; pspice++)
    for (size_t k = 0; k < COUNT(CANDIDATES); k++) {
      const bool is = vs_reserved_is(CANDIDATES[k], pspice);
      listed += pspice && is;
      EXPECT(is == !is_free(CANDIDATES[k], pspice ? "-D ngbehavior=psa" : ""),
             "%s%s: the list has it: %d", CANDIDATES[k], pspice ? " in PSpice's dialect" : "", is);
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
      /* a current of 1 A into some 1 kohm beside 1 Mohm: 0.1 % of each of 43, which are 1000 */
      const bool beside = strstr(PLACES[f], "I%K") != NULL;
      vs_close(largest(r.out, "y_v_max"), 1, 1, beside ? 50 : 1e-6, PLACES[f], __LINE__);
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
  ran r = run(RUN);
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  vs_close(largest(r.out, "y_v_max"), 10, 10, 1e-9, "constants", __LINE__);
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
  refused("", ".param e__own=3", "the program makes such names");
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
      {"LIMIT of three cuts off", limit_of_three},
      {"other limits are refused", other_limits},
      {"the list of ngspice's names", list_of_names},
      {"names of ngspice's own", names_of_ngspice},
      {"constants of ngspice's own", constants_of_ngspice},
      {"names are told", names_are_told},
      {"names in an export", names_in_an_export},
  };
  return program_suite("dialect", TESTS, COUNT(TESTS));
}
