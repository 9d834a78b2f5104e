/* SPDX-License-Identifier: GPL-3.0-or-later
 * LIMIT of PSpice's dialect is a cut-off and no chance, wherever the deck says which dialect it is
 * in; and names that ngspice has for itself are refused where they are given. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

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

/* {limit} cannot be read; {time} is 0, {temper} 27 whatever the parameter's value is. */
static void names_of_ngspice(void) {
  static const char *const NAMES[] = {"limit", "gauss", "agauss", "unif",   "aunif", "exp",
                                      "Sqrt",  "min",   "time",   "temper", "hertz"};
  static const char *const FORMS[] = {"*$ param %s = 1000 1..1e6 \"x\"\nR98 yy 0 {%s}",
                                      ".param %s=1000\nR98 yy 0 {%s}",
                                      ".subckt s9 p n %s=1000\nR98 p n {%s}\n.ends\nX9 yy 0 s9"};
  for (size_t k = 0; k < COUNT(NAMES); k++)
    for (size_t f = 0; f < COUNT(FORMS); f++) {
      char line[256];
      vs_text lines = {0};
      for (const char *s = FORMS[f]; *s; s++)
        if (s[0] == '%' && s[1] == 's')
          vs_text_add(&lines, "%s", NAMES[k]), s++;
        else
          vs_text_add(&lines, "%c", *s);
      snprintf(line, sizeof line, "%s", lines.text);
      refused("", line, "ngspice has that name for itself");
      vs_text_free(&lines);
    }
  make_deck("",
            PROBE "*$ param limits = 1000 1..1e6 \"x\"\n.param expo=2 timer=3\n"
                  "R98 yy 0 {limits*expo*timer}",
            "");
  ran r = run("check paper --set circuit.deck=d.cir");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  free_ran(&r);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"LIMIT of three cuts off", limit_of_three},
      {"other limits are refused", other_limits},
      {"names of ngspice's own", names_of_ngspice},
  };
  return program_suite("dialect", TESTS, COUNT(TESTS));
}
