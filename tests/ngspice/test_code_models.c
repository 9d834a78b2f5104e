/* SPDX-License-Identifier: GPL-3.0-or-later
 * ngspice's code models, which are loaded for the first circuit that needs one: such circuits run
 * in a process that began without any, and a circuit that needs none gives the same before and
 * after. */
#include <string.h>

#include "bench.h"
#include "ngspice/ngspice.h"
#include "suite.h"

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
      {"they are loaded on demand", on_demand},
  };
  return vs_suite("code models", TESTS, COUNT(TESTS));
}
