/* SPDX-License-Identifier: GPL-3.0-or-later
 * ngspice's code models, which are loaded for the first circuit that needs one: which circuits do,
 * that they run in a process that began without any, and that a circuit without any gives the same
 * before and after. */
#include <string.h>

#include "bench.h"
#include "solver/code_models.h"
#include "suite.h"

static void which_lines(void) {
  static const struct {
    const char *line, *dialect;
    bool needed;
  } ROWS[] = {
      {"R1 a 0 1k", "", false},
      {"Rpoly a 0 1k", "", false},
      {"B1 a 0 V = v(b)*v(polygon)", "", false},
      {"E1 a 0 b 0 2", "", false},
      {"G1 a 0 b 0 {gain}", "", false},
      {"* a comment", "", false},
      {"", "", false},
      {"R1 a 0 1k", "ps", true},
      {"A1 a b model", "", true},
      {"  a1 a b model", "", true},
      {"u1 nand(2) $g_dpwr", "", true},
      {"E1 a 0 POLY(1) b 0 0 1", "", true},
      {"F1 a 0 poly(1) V1 0 1", "", true},
      {"+ POLY(1) b 0 0 1", "", true},
      {"G1 a 0 TABLE {v(b)} = (0,0) (1,1)", "", true},
      {"E1 a 0 nand(2) b 0 c 0 (0,0) (1,1)", "", true},
  };
  char title[] = "a title, which is no code model", line[64];
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char *netlist[] = {title, line};
    strcpy(line, ROWS[k].line);
    EXPECT(vs_code_models_needed(netlist, 2, ROWS[k].dialect) == ROWS[k].needed, "%s", line);
  }
}

/* v(a) at the end of a run of 1 ms. */
static double at_the_end(const char *deck) {
  bench b = {.deck = deck,
             .signals = {"v(a)"},
             .until_s = 1e-3,
             .max_step_s = 1e-5,
             .relative_tolerance = 1e-6};
  vs_error err = {0};
  EXPECT(bench_run(&b, &err) == VS_OK, "%s: %s", deck, err.text);
  return b.last[0];
}

static void on_demand(void) {
  static const char PLAIN[] = "I1 0 a 1m\nR1 a 0 1k\nC1 a 0 1u\n";
  double before = at_the_end(PLAIN);
  CLOSE(at_the_end("V1 b 0 3\nE1 a 0 POLY(1) b 0 1 2 3\nR1 a 0 1k\n"), 1 + 2 * 3 + 3 * 9, 1e-9);
  CLOSE(at_the_end("V1 b 0 3\nA1 b a twice\n.model twice gain(gain=2)\nR1 a 0 1k\n"), 6, 1e-9);
  double after = at_the_end(PLAIN);
  EXPECT(!memcmp(&before, &after, sizeof before), "%.17g and %.17g", before, after);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"which lines need code models", which_lines},
      {"they are loaded on demand", on_demand},
  };
  return vs_suite("code models", TESTS, COUNT(TESTS));
}
