/* SPDX-License-Identifier: GPL-3.0-or-later
 * A run in which nothing fires, and a deck without the port mains, are said: on standard error and
 * among summary.json's warnings. */
#include <string.h>

#include "program.h"

static const char *const WORDS[] = {"nothing fires", "no port mains"};

/* word: which of them is said; -1: neither. */
static void says(const char *words, int word) {
  ran r = run("run paper --json --reproducible %s", words);
  CU_ASSERT_EQUAL(r.status, 0);
  for (int k = 0; k < 2; k++) {
    const char *list = strstr(r.out, "\"warnings\": [");
    const char *end = list ? strchr(list, ']') : NULL, *said = list ? strstr(list, WORDS[k]) : NULL;
    EXPECT(!strstr(r.err, WORDS[k]) == (k != word), "%s: %s", words, r.err);
    EXPECT(list && !(said && said < end) == (k != word), "%s: warnings of summary.json", words);
  }
  free_ran(&r);
  if (word < 0) return;
  r = run("run paper --quiet %s", words);
  EXPECT(r.status == 0 && !*r.err, "%s --quiet: %s", words, r.err);
  free_ran(&r);
}

static void nothing_fires(void) {
  says("--tier switched --set run.until=0.05s", -1);
  says("--tier switched --set run.until=0.05s --set firing.first_cycle=4", 0);
  says("--tier analytic --set run.until=0.05s --set firing.angle=179deg "
       "--set firing.pulse_width=0.01ms",
       -1);
  says("--set circuit.deck=halfwave_snubbed --set run.until=0.03s", -1);
  says("--set circuit.deck=halfwave_snubbed --set run.until=0.03s --set firing.first_cycle=3", 0);
  says("--set circuit.deck=halfwave_bare --set run.until=0.03s --set firing.angle=179.99deg "
       "--set firing.pulse_width=0.001ms",
       0);
  says("--set circuit.deck=fullwave_antiparallel --set run.until=0.02s", -1);
}

/* A deck that fires nothing, as it has no gate, is asked for no firing. */
static void no_port_mains(void) {
  write_file("own.cir", "*$ probe v_a = v(a) V\nVm a 0 SIN(0 100 50)\nR1 a b 100\nXeva b 0 eva\n");
  write_file("mains.cir", "*$ port mains = Vm\n*$ probe v_a = v(a) V\nVm a 0 external\n"
                          "R1 a b 100\nXeva b 0 eva\n");
  says("--set circuit.deck=own.cir --set run.until=0.02s", 1);
  says("--set circuit.deck=mains.cir --set run.until=0.02s --set supply.voltage=100V", -1);
  ran r = run("check own.cir");
  EXPECT(strstr(r.err, "own.cir: warning: no port mains") || strstr(r.out, "no port mains"), "%s%s",
         r.out, r.err);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"nothing fires", nothing_fires},
    {"no port mains", no_port_mains},
};
int main(void) {
  return program_suite("nothing_fires", TESTS, COUNT(TESTS));
}
