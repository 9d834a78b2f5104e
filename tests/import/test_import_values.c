/* SPDX-License-Identifier: GPL-3.0-or-later
 * `vibrospice import`: what resistors, capacitors and inductors are worth with m=, scale=, a .model
 * or a temperature, in the lines of losses and stores. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"
#include "suite.h"

static void write_netlist(const char *line) {
  vs_text text = {0};
  vs_text_add(&text,
              "t\nV1 line 0 SIN(0 325 50)\nR9 line s 100\n%s\nR2 s 0 1k\nL1 line m 1.6\n"
              "R4 m 0 92\n.param n=2\n.model rm r(tc1=0.01 tnom=17)\n.model cm c(tc1=0.01)\n"
              ".tran 10u 20m uic\n.end\n",
              line);
  write_file("x.net", text.text);
  vs_text_free(&text);
}

static double residual(void) {
  ran r = run("run x.yaml -o out --quiet --json");
  const char *at = strstr(r.out, "\"energy_residual\": {\"value\": ");
  EXPECT(r.status == 0 && at, "%s%s", r.err, r.out);
  double value = at ? strtod(strchr(at, '{') + strlen("{\"value\": "), NULL) : (double)NAN;
  free_ran(&r);
  return value;
}

/* The energy audit closes where every loss and store is right. */
static void what_elements_are_worth(void) {
  static const struct {
    const char *line, *has, *left; /* lines of the deck; what is left to decide, NULL: nothing */
  } ROWS[] = {
      {"R1 line s 10 m=2", "*$ loss   r1 = v(line,s)^2/({r1}/2)\n", NULL},
      {"R1 line s 10 m=2 scale=3", "*$ device r1 resistor = v(line,s), v(line,s)/({r1}*3/2)\n",
       NULL},
      {"R1 line s 10 m={n+1}", "*$ loss   r1 = v(line,s)^2/({r1}/((n+1)))\n", NULL},
      {"R1 line s {n*5} m=n", "*$ loss   r1 = v(line,s)^2/(((n*5))/(n))\n", NULL},
      {"R1 line s 10 tc1=0.01 dtemp=50", "*$ loss   r1 = v(line,s)*i(Vi_r1)\n", NULL},
      {"R1 line s 10 temp=77 tc=0.01", "*$ device r1 resistor = v(line,s), i(Vi_r1)\n", NULL},
      {"R1 line s 10 tc1=0.01", "*$ loss   r1 = v(line,s)^2/{r1}\n", NULL},
      {"R1 line s 10 rm", "*$ loss   r1 = v(line,s)*i(Vi_r1)\n", NULL},
      {"R1 line s rm 10 m=3", "*$ loss   r1 = v(line,s)*i(Vi_r1)\n", NULL},
      {"C1 s 0 20u m=2 scale=3 ic=0", "*$ store  c1 = ({c1}*3*2)*v(s)^2/2\n", NULL},
      {"C1 s 0 20u tc1=0.01 dtemp=20 ic=0", "*$ device c1 capacitor = v(s), i(Vi_c1)\n",
       "C1: its value is not known before a run"},
      {"C1 s 0 cm 20u", "\nC1 c1_in 0 cm 20u\n", "C1: its value is not known before a run"},
      {"L2 s 0 1 m=4 scale=2 ic=0", "*$ store  l2 = ({l2}*2/4)*i(L2)^2/2\n", NULL},
      {"L2 s 0 1 m=4\nL3 s3 0 1\nR3 s3 0 1k\nK1 L2 L3 0.4", "*$ store  l2 = ({l2}/4)*i(L2)^2/2\n",
       "K1: the energy of the coupling is not counted"},
  };
  double worst = 0;
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_netlist(ROWS[k].line);
    ran r = run("import x.net --coil L1+R4 -o x.cir --scene x.yaml");
    EXPECT(r.status == 0, "case %zu: %s", k, r.err);
    EXPECT(ROWS[k].left ? strstr(r.err, ROWS[k].left) != NULL : !strstr(r.err, "left to decide"),
           "case %zu: %s", k, r.err);
    free_ran(&r);
    char *deck = read_file("x.cir");
    EXPECT(strstr(deck, ROWS[k].has), "case %zu: no '%s' in %s", k, ROWS[k].has, deck);
    free(deck);
    double error = residual();
    if (!ROWS[k].left) worst = fmax(worst, error);
    EXPECT(ROWS[k].left || error < 1e-3, "case %zu: the energy books are off by %g", k, error);
  }
  printf(" worst %.1e", worst);
}

static const vs_test TESTS[] = {
    {"what elements are worth", what_elements_are_worth},
};

int main(void) {
  return program_suite("import_values", TESTS, COUNT(TESTS));
}
