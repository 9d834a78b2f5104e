/* SPDX-License-Identifier: GPL-3.0-or-later
 * ngspice is left where that saves more steps than the looks cost that it takes, and is not looked
 * at otherwise. */
#include "suite.h"

static vs_status note_leaving(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  int *times = ctx;
  *times += step->event[1] == VS_EV_QUIET;
  return VS_OK;
}

/* Leaving takes two looks, each of which costs as much as 200 steps. Of 0.1 s two cycles are left
 * then, of 750 steps at 1e-4. A loose truncation leaves a cycle with 200 steps. */
static void left_where_it_pays(void) {
  static const struct {
    const char *trtol, *tolerance, *until;
    bool leaves;
  } CASES[] = {{"run.trtol=1000", "run.tolerance=1e-1", "run.until=95ms", false},
               {"run.trtol=1000", "run.tolerance=1e-1", "run.until=300ms", true},
               {"run.trtol=7", "run.tolerance=1e-4", "run.until=100ms", true}};
  for (size_t k = 0; k < COUNT(CASES); k++) {
    const char *const sets[] = {CASES[k].trtol, CASES[k].tolerance, CASES[k].until, NULL};
    int times = 0;
    const vs_observer observer = {&times, note_leaving};
    vs_trial *t = vs_trial_run("paper", "circuit", sets, &observer);
    EXPECT(t->status == VS_OK, "%s", t->err.text);
    EXPECT((times > 0) == CASES[k].leaves, "%s, %s: left %d times", CASES[k].tolerance,
           CASES[k].until, times);
    vs_trial_free(t);
  }
}

static const vs_test TESTS[] = {{"left where it pays", left_where_it_pays}};

VS_SUITE_MAIN("looks", TESTS)
