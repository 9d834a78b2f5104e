/* SPDX-License-Identifier: GPL-3.0-or-later
 * A coil behind an ideal latch and nothing else: a current that is chopped off before its zero, or
 * behind it, is a voltage of off_resistance times that. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "suite.h"

static double extreme(const vs_trial *t, int sense) {
  const vs_measures *m = t->result.watchers.measures;
  for (int k = 0; k < m->n_extremes; k++) {
    const vs_extreme *e = &m->extremes[k];
    const char *name = vs_channel_at(&t->result.scene->frame, e->channel).name;
    if (e->sense == sense && !strcmp(name, "v_ak")) return e->best.value;
  }
  return NAN;
}

/* Once the thyristor has gone out, its voltage is the mains' and no more, either way. Of the
 * mains' amplitude, 5e-4 is what steps of 1/200 of a cycle miss of it, and what leaks. */
static void no_overvoltage(void) {
  static const char *const OFF[] = {"circuit.off_resistance=10 Mohm",
                                    "circuit.off_resistance=1 Gohm"},
                           *const ANGLES[] = {"firing.angle=100 deg", "firing.angle=135 deg"},
                           *const TOLERANCES[] = {"run.tolerance=1e-3", "run.tolerance=1e-4",
                                                  "run.tolerance=1e-5", "run.tolerance=1e-6"};
  for (int k = 0; k < 16; k++) {
    const char *sets[] = {"circuit.deck=halfwave_bare",
                          "run.until=50 ms",
                          OFF[k % 2],
                          ANGLES[k / 2 % 2],
                          TOLERANCES[k / 4],
                          NULL};
    vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    double peak_v = t->scene.setup.timeline.peak_v;
    for (int sense = -1; sense <= 1; sense += 2) {
      double v = extreme(t, sense);
      EXPECT(fabs(v - sense * peak_v) <= 5e-4 * peak_v, "%s, %s, %s: v_ak of %.6g V", sets[2],
             sets[3], sets[4], v);
    }
    vs_trial_free(t);
  }
}

static const vs_test TESTS[] = {
    {"no overvoltage", no_overvoltage},
};
VS_SUITE_MAIN("chopped", TESTS)
