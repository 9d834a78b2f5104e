/* SPDX-License-Identifier: GPL-3.0-or-later
 * The rate of a rise of forward voltage does not hang on the step in which a current counts as
 * gone. A thyristor that goes out slowly has 20 V of forward voltage before it is reversed. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

/* The measure's value in the unit it is shown in; NaN: it is not there. */
static double value_of(const char *words, const char *tolerance, const char *measure) {
  char key[64];
  ran r = run("run paper --json --reproducible --set run.verify=never --set run.tolerance=%s %s",
              tolerance, words);
  snprintf(key, sizeof key, "\"%s\": {\"value\": ", measure);
  const char *at = strstr(r.out, key);
  double value = at ? strtod(at + strlen(key), NULL) : (double)NAN;
  free_ran(&r);
  return value;
}

static void same_at_all_tolerances(void) {
  static const struct {
    const char *words, *measure;
    double v_per_us; /* at a tolerance of 1e-7 */
  } ROWS[] = {
      {"--set circuit.deck=fullwave_antiparallel --set run.until=15ms", "t1.dv_dt", 8.122},
      {"--set circuit.deck=fullwave_antiparallel --set run.until=25ms --set firing.angle=97.2deg "
       "--set supply.voltage=341V",
       "t2.dv_dt", 8.133},
      {"--set circuit.deck=halfwave_paper --set run.until=15ms", "thyristor.dv_dt", 2.42},
      {"--set circuit.deck=halfwave_snubbed --set run.until=25ms", "thyristor.dv_dt", 0.6669},
  };
  static const char *const TOLERANCES[] = {"1e-3", "1e-4", "1e-6"};
  /* The solver's own steps at the knee make up to 5 %; the rise's beginning made a factor of 10. */
  for (size_t k = 0; k < COUNT(ROWS); k++)
    for (size_t t = 0; t < COUNT(TOLERANCES); t++) {
      double found = value_of(ROWS[k].words, TOLERANCES[t], ROWS[k].measure);
      EXPECT(fabs(found / ROWS[k].v_per_us - 1) < 0.06, "%s at %s: %g V/us, not %g", ROWS[k].words,
             TOLERANCES[t], found, ROWS[k].v_per_us);
    }
}

static const vs_test TESTS[] = {{"same at all tolerances", same_at_all_tolerances}};
int main(void) {
  return program_suite("rises", TESTS, COUNT(TESTS));
}
